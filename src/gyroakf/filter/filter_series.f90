! SPDX-License-Identifier: MIT
!> A filter over a whole series, with the measures of its quality.
!>
!> In blocks: no temporaries of the record's length. What a result means is said in sentences, by
!> the size of the effect: in a long record every deviation is significant.
module gyroakf_filter_filter_series
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : text_type
   use gyroakf_special, only : chi_square_quantile
   use gyroakf_stats_moments, only : compute_moments, join_moments, moments_type
   use gyroakf_stats_whiteness, only : ljung_box_of
   use gyroakf_filter_kalman, only : filter_type, run_filter
   use gyroakf_filter_drift_steady, only : drift_dc_gain
   use gyroakf_filter_drift_step, only : begins_here
   use gyroakf_filter_state_space, only : dc_gain
   use gyroakf_filter_lag_sums, only : lag_sums_type, start_lag_sums, add_block, &
      autocovariance_of, longest_lag
   use gyroakf_filter_measurement, only : is_sample
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

   !> State of the diagnostics along a series
   type :: filter_run_type
      type(lag_sums_type) :: innovations
      type(moments_type) :: output, block
      !> Innovations over their standard deviations, presence: of a block
      real(dp), allocatable :: normalised(:)
      integer(int8), allocatable :: here(:)
      !> Samples of the series, those before its last third, those done, those done at the next
      !> report of progress
      integer(int64) :: samples = 0, third = 0, done = 0, next_report = 0
      !> Counts of the filter at the beginning: clamped, gated
      integer(int64) :: before(2) = 0
   end type filter_run_type

contains

   !> Runs the filter over a series and measures what it did.
   subroutine filter_series(filter, z, x, result, error, valid, progress)
      !> The filter, made by new_filter or a design procedure; its state goes on
      type(filter_type), intent(inout) :: filter
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
      type(filter_run_type) :: run
      integer(int64) :: measurements
      logical :: same

      same = size(x, kind=int64) == size(z, kind=int64)
      if (present(valid)) same = same .and. size(valid, kind=int64) == size(z, kind=int64)
      if (.not. same) then
         call fatal_error(error, status%invalid_argument, wrong_series)
         return
      end if
      if (present(valid)) then
         measurements = enough_measurements(z, valid)
      else
         measurements = enough_measurements(z)
      end if
      call begin_run(filter, size(z, kind=int64), measurements, run, error)
      if (allocated(error)) return
      if (present(valid)) then
         call run_blocks(filter, run, z, x, error, valid, progress)
      else
         call run_blocks(filter, run, z, x, error, progress=progress)
      end if
      if (.not. allocated(error)) call end_run(filter, run, result, error)
   end subroutine filter_series

   !> Prepares the diagnostics of a series.
   subroutine begin_run(filter, samples, measurements, run, error)
      !> The filter, made by new_filter or a design procedure
      type(filter_type), intent(in) :: filter
      !> Samples of the whole series, and how many of them are present (30 are enough to know)
      integer(int64), intent(in) :: samples, measurements
      !> Fresh afterwards
      type(filter_run_type), intent(out) :: run
      !> invalid_argument: filter not made; too_few_samples; no_memory
      type(error_type), allocatable, intent(out) :: error
      character(120) :: buffer
      integer :: stat

      if (filter%order < 1) then
         call fatal_error(error, status%invalid_argument, wrong_series)
      else if (measurements < fewest_measurements) then
         write (buffer, "(a, i0, a, i0)") "a filter's diagnostics need at least ", &
            fewest_measurements, &
            " present samples, got ", measurements
         call fatal_error(error, status%too_few_samples, trim(buffer))
      end if
      if (allocated(error)) return
      allocate (run%normalised(block_size), stat=stat)
      if (stat == 0) allocate (run%here(block_size), stat=stat)
      if (stat == 0) call start_lag_sums(run%innovations, block_size, stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, &
            "no memory for the blocks of a filter's innovations")
         return
      end if
      run%before = [filter%clamped, filter%gated]
      run%samples = samples
      run%third = samples - samples/3
   end subroutine begin_run

   !> Filters the series block by block.
   subroutine run_blocks(filter, run, z, x, error, valid, progress)
      !> Of the beginning; its state goes on
      type(filter_type), intent(inout) :: filter
      !> Of the beginning
      type(filter_run_type), intent(inout) :: run
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Output, of that length; not the same array as z
      real(dp), intent(out), contiguous :: x(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 where a sample is present, 0 where it is missing
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: first, last
      integer :: n
      logical :: begins

      last = 0
      do while (last < size(z, kind=int64))
         if (run%done == 0 .or. run%done == run%third) call restart_gain(filter)
         if (run%done >= run%next_report) then
            run%next_report = run%done + report_samples
            call report_progress("filtering", run%done, run%samples, error, progress)
            if (allocated(error)) return
         end if
         first = last + 1
         last = min(first + block_size - 1, size(z, kind=int64))
         if (run%done < run%third) last = min(last, first - 1 + run%third - run%done)
         n = int(last - first + 1)
         if (present(valid)) then
            run%here(:n) = merge(1_int8, 0_int8, valid(first:last) /= 0_int8 &
               .and. is_sample(z(first:last)))
         else
            run%here(:n) = merge(1_int8, 0_int8, is_sample(z(first:last)))
         end if
         begins = begins_here(filter)
         call run_filter(filter, z(first:last), x(first:last), run%here(:n), run%normalised(:n))
         call compute_moments(x(first:last), run%block, run%here(:n))
         call join_moments(run%output, run%block)
         if (begins) run%here(:n) = after_first(run%here(:n))
         call add_block(run%innovations, run%normalised(:n), run%here(:n))
         run%done = run%done + n
      end do
   end subroutine run_blocks

   !> Measures what the filter did to the series.
   subroutine end_run(filter, run, result, error)
      !> After the last sample
      type(filter_type), intent(in) :: filter
      !> All samples are done
      type(filter_run_type), intent(in) :: run
      !> Its diagnostics
      type(filter_result_type), intent(out) :: result
      !> As ljung_box_of
      type(error_type), allocatable, intent(out) :: error

      result%steps = run%done
      result%clamped = filter%clamped - run%before(1)
      result%gated = filter%gated - run%before(2)
      result%mean = run%output%mean
      result%variance = run%output%variance
      call conclude(filter, run%innovations, result, error)
   end subroutine end_run

   !> Present samples of a series, counted until they are enough.
   pure integer(int64) function enough_measurements(z, valid) result(measurements)
      real(dp), intent(in), contiguous :: z(:)
      !> 1 where a sample is present, [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: k
      logical :: here

      measurements = 0
      do k = 1, size(z, kind=int64)
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         if (here) measurements = measurements + 1
         if (measurements >= fewest_measurements) return
      end do
   end function enough_measurements

   !> Presence of the innovations: the first measurement of a random walk has none.
   pure function after_first(here) result(later)
      !> Presence of the measurements, [n]
      integer(int8), intent(in), contiguous :: here(:)
      integer(int8) :: later(size(here))
      integer :: first

      later = here
      first = findloc(here, 1_int8, 1)
      if (first > 0) later(first) = 0_int8
   end function after_first

   !> Begins a new mean of the gain.
   pure subroutine restart_gain(filter)
      type(filter_type), intent(inout) :: filter

      filter%drift_gain_sum = 0.0_dp
      filter%gain_sum = 0.0_dp
      filter%gain_measurements = 0
   end subroutine restart_gain

   !> Everything that is known at the end.
   subroutine conclude(filter, innovations, result, error)
      !> The filter after the series
      type(filter_type), intent(in) :: filter
      !> Sums of its normalised innovations
      type(lag_sums_type), intent(in) :: innovations
      !> The result, the moments and counts set
      type(filter_result_type), intent(inout) :: result
      !> As ljung_box_of
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: gain(size(filter%gain)), autocovariance(0:longest_lag), count

      gain = filter%gain
      if (filter%gain_measurements > 0) gain = filter%gain_sum/real(filter%gain_measurements, dp)
      result%gain = gain(1)
      result%dc_gain = lasting_gain(filter, gain)
      result%q = filter%q
      result%r = filter%r
      result%q_mean = filter%q_mean
      result%r_mean = filter%r_mean
      count = real(innovations%present, dp)
      result%nis_mean = innovations%squares/count
      result%nis_low = chi_square_quantile(0.025_dp, count)/count
      result%nis_high = chi_square_quantile(0.975_dp, count)/count
      if (filter%adaptive) result%forgetting = filter%options%forgetting
      call list_estimates(filter, result%estimate)
      call autocovariance_of(innovations, autocovariance)
      if (autocovariance(0) > 0.0_dp) then
         call ljung_box_of(autocovariance, innovations%samples, 0, result%ljung_box, error, &
            nint(innovations%pairs, int64))
         if (allocated(error)) return
      end if
      call list_warnings(filter, innovations%present, result)
   end subroutine conclude

   !> DC gain in the end: an adapted mean takes up a part of a constant rate, or all of it.
   pure real(dp) function lasting_gain(filter, gain)
      type(filter_type), intent(in) :: filter
      !> Its mean gain, [order]
      real(dp), intent(in) :: gain(:)

      associate (by_q => filter%options%estimate_process_mean, &
         by_r => filter%options%estimate_measurement_mean)
         if (filter%drift_model%count == 1) then
            lasting_gain = drift_dc_gain(filter%drift_model, filter%slow, gain)
         else if (filter%drift_model%count > 1) then
            lasting_gain = drift_dc_gain(filter%drift_model, filter%slow, &
                                         filter%drift_gain_sum/real(max(1_int64, &
                                         filter%gain_measurements), dp))
         else if (by_q .and. by_r) then                 ! q = K r: one innovation drives both
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

   !> The names of what is adapted, in the paper's order.
   pure subroutine list_estimates(filter, list)
      type(filter_type), intent(in) :: filter
      !> "q", "r", "Q", "R" as they apply
      type(text_type), allocatable, intent(out) :: list(:)
      logical :: adapted(4)
      integer :: i, k

      associate (options => filter%options)
         adapted(1) = options%estimate_process_mean
         adapted(2) = options%estimate_measurement_mean
         adapted(3) = options%estimate_process_variance
         adapted(4) = options%estimate_measurement_variance
      end associate
      allocate (list(count(adapted)))
      k = 0
      do i = 1, 4
         if (.not. adapted(i)) cycle
         k = k + 1
         list(k)%text = "qrQR"(i:i)
      end do
   end subroutine list_estimates
end module gyroakf_filter_filter_series
