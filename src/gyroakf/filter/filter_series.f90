! SPDX-License-Identifier: MIT
!> A filter over a whole series, with the measures of its quality.
!>
!> In blocks: no temporaries of the record's length. What a result means is said in sentences, by
!> the size of the effect: in a long record every deviation is significant.
module gyroakf_filter_filter_series
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : add_text
   use gyroakf_special, only : chi_square_quantile
   use gyroakf_stats_lagged_products, only : add_pair_sums, covariances_of_pairs
   use gyroakf_stats_moments, only : compute_moments, join_moments, moments_type
   use gyroakf_stats_whiteness, only : ljung_box_of
   use gyroakf_filter_kalman, only : drift_filter_type, filter_type, run_filter
   use gyroakf_filter_drift_steady, only : drift_dc_gain
   use gyroakf_filter_state_space, only : dc_gain
   use gyroakf_filter_components, only : is_sample
   use gyroakf_filter_filter_warnings, only : filter_result_type, list_warnings
   implicit none (type, external)
   private
   public :: filter_result_type, filter_series

   !> Samples a block
   integer, parameter :: block_size = 4096
   !> Samples between two reports of progress
   integer(int64), parameter :: report_samples = 256*block_size
   character(*), parameter :: wrong_series = &
      "a filter needs a series, an output and a mask of one length, and must be made before it runs"
   !> Fewest measurements that the diagnostics make sense for
   integer, parameter :: fewest_measurements = 30
   !> Lags of the autocovariances of the innovations
   integer, parameter :: longest_lag = 20

contains

   !> Runs the filter over a series and measures what it did.
   subroutine filter_series(filter, z, x, result, error, valid, progress)
      !> The filter, made by new_filter or a design procedure; its state goes on
      class(filter_type), intent(inout) :: filter
      !> Series, [n], at least 30 present samples; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Output, [n]: the estimate of the state; the prediction where a sample is missing; not the
      !> same array as z
      real(dp), intent(out), contiguous :: x(:)
      !> Its diagnostics
      type(filter_result_type), intent(out) :: result
      !> invalid_argument: lengths differ, filter not made; too_few_samples; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 where a sample is present, 0 where it is missing, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(moments_type) :: output, block
      real(dp), allocatable :: nu(:), flag(:)
      integer(int8), allocatable :: here(:)
      real(dp) :: sums(0:longest_lag, 4)
      integer(int64) :: n, first, last, third, next_report
      integer :: m, k, stat
      logical :: begins

      n = size(z, kind=int64)
      call check_series(filter, z, size(x, kind=int64), error, valid)
      if (allocated(error)) return
      allocate (nu(1 - longest_lag:block_size), stat=stat)
      if (stat == 0) allocate (flag(1 - longest_lag:block_size), stat=stat)
      if (stat == 0) allocate (here(block_size), stat=stat)
      call check_memory(stat, "the blocks of a filter's innovations", error)
      if (allocated(error)) return
      result%clamped = -filter%clamped
      result%gated = -filter%gated
      nu = 0.0_dp
      flag = 0.0_dp
      sums = 0.0_dp
      third = n - n/3
      next_report = 0
      last = 0
      do while (last < n)
         if (last == 0 .or. last == third) then               ! a new mean of the gain
            filter%gain_sum = 0.0_dp
            filter%gain_measurements = 0
         end if
         if (last >= next_report) then
            next_report = last + report_samples
            call report_progress("filtering", last, n, error, progress)
            if (allocated(error)) return
         end if
         first = last + 1
         last = min(last + block_size, merge(third, n, last < third))
         m = int(last - first + 1)
         here(:m) = merge(1_int8, 0_int8, is_sample(z(first:last)))
         if (present(valid)) here(:m) = merge(here(:m), 0_int8, valid(first:last) /= 0_int8)
         begins = starts_unknown(filter)
         call run_filter(filter, z(first:last), x(first:last), here(:m), nu(1:m))
         call compute_moments(x(first:last), block, here(:m))
         call join_moments(output, block)
         k = 0
         if (begins) k = findloc(here(:m), 1_int8, 1)
         if (k > 0) here(k) = 0_int8                 ! the first of a random walk has no innovation
         flag(1:m) = here(:m)
         call add_pair_sums(nu(:m), flag(:m), m, longest_lag, sums)
         nu(1 - longest_lag:0) = nu(m + 1 - longest_lag:m)
         flag(1 - longest_lag:0) = flag(m + 1 - longest_lag:m)
      end do
      result%steps = n
      result%clamped = result%clamped + filter%clamped
      result%gated = result%gated + filter%gated
      result%mean = output%mean
      result%variance = output%variance
      call conclude(filter, sums, result, error)
   end subroutine filter_series

   !> Whether the state is a random walk that has not met its first measurement.
   pure logical function starts_unknown(filter)
      class(filter_type), intent(in) :: filter

      starts_unknown = .false.
      select type (filter)
      type is (drift_filter_type)
         starts_unknown = .not. filter%state%started
      end select
   end function starts_unknown

   !> Refuses arrays that do not fit, a filter that was not made, and a series that is too short.
   subroutine check_series(filter, z, output, error, valid)
      class(filter_type), intent(in) :: filter
      real(dp), intent(in), contiguous :: z(:)
      integer(int64), intent(in) :: output
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text
      integer(int64) :: k
      integer :: measurements
      logical :: same

      same = output == size(z, kind=int64) .and. filter%order > 0
      if (present(valid)) same = same .and. size(valid, kind=int64) == size(z, kind=int64)
      if (.not. same) then
         call fatal_error(error, status%invalid_argument, wrong_series)
         return
      end if
      measurements = 0
      do k = 1, size(z, kind=int64)
         if (present(valid)) then
            if (valid(k) == 0_int8) cycle
         end if
         if (is_sample(z(k))) measurements = measurements + 1
         if (measurements >= fewest_measurements) return
      end do
      write (text, "(2(a, i0))") "a filter's diagnostics need at least ", fewest_measurements, &
         " present samples, got ", measurements
      call fatal_error(error, status%too_few_samples, trim(text))
   end subroutine check_series

   !> Everything that is known at the end.
   subroutine conclude(filter, sums, result, error)
      class(filter_type), intent(in) :: filter
      !> Sums over pairs of its normalized innovations
      real(dp), intent(in) :: sums(0:longest_lag, 4)
      type(filter_result_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: autocovariance(0:longest_lag), count
      integer(int64) :: pairs(0:longest_lag)

      call conclude_gains(filter, result)
      result%q = filter%q
      result%r = filter%r
      result%q_mean = filter%q_mean
      result%r_mean = filter%r_mean
      count = sums(0, 2)
      result%nis_mean = sums(0, 1)/count
      result%nis_low = chi_square_quantile(0.025_dp, count)/count
      result%nis_high = chi_square_quantile(0.975_dp, count)/count
      if (filter%adaptive) result%forgetting = filter%options%forgetting
      allocate (result%estimate(0))
      associate (options => filter%options)
         if (options%estimate_process_mean) call add_text(result%estimate, "q")
         if (options%estimate_measurement_mean) call add_text(result%estimate, "r")
         if (options%estimate_process_variance) call add_text(result%estimate, "Q")
         if (options%estimate_measurement_variance) call add_text(result%estimate, "R")
      end associate
      call covariances_of_pairs(sums, sums(0, 3)/count, result%steps, autocovariance, pairs)
      if (autocovariance(0) > 0.0_dp) then
         call ljung_box_of(autocovariance, result%steps, 0, result%ljung_box, error, pairs)
         if (allocated(error)) return
      end if
      call list_warnings(filter, pairs(0), result)
   end subroutine conclude

   !> Mean gain of the last third, and the DC gain with it.
   pure subroutine conclude_gains(filter, result)
      class(filter_type), intent(in) :: filter
      type(filter_result_type), intent(inout) :: result
      real(dp) :: gain(size(filter%gain_sum))

      gain = filter%gain_sum/real(max(1_int64, filter%gain_measurements), dp)
      select type (filter)
      type is (drift_filter_type)
         if (filter%gain_measurements == 0) gain = filter%state%gain(:size(gain))
         result%gain = sum(gain, mask=filter%slow(:size(gain)))
         result%dc_gain = drift_dc_gain(filter%model, filter%slow, gain)
      class default
         if (filter%gain_measurements == 0) gain = filter%gain
         result%gain = gain(1)
         result%dc_gain = lasting_gain(filter, gain)
      end select
   end subroutine conclude_gains

   !> DC gain in the end: an adapted mean takes up a part of a constant rate, or all of it.
   pure real(dp) function lasting_gain(filter, gain)
      class(filter_type), intent(in) :: filter
      real(dp), intent(in) :: gain(:)

      associate (by_q => filter%options%estimate_process_mean, &
         by_r => filter%options%estimate_measurement_mean)
         if (by_q .and. by_r) then                      ! q = K r: one innovation drives both
            lasting_gain = gain(1)/(gain(1) + 1.0_dp - sum(filter%phi))
         else if (by_r) then
            lasting_gain = 0.0_dp
         else if (by_q) then
            lasting_gain = 1.0_dp
         else
            lasting_gain = dc_gain(filter%phi, gain)
         end if
      end associate
   end function lasting_gain

end module gyroakf_filter_filter_series
