! SPDX-License-Identifier: MIT
!> Where the true drift is known: what the filters are compared with. No filter, the trend alone, moving averages, and other ways to
!> adapt R.
module gyroakf_pipeline_alternatives
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_roots, only : ar_root_type, find_ar_roots, largest_modulus
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_read_off, only : read_off, read_off_options, read_off_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_innovation_window, only : filter_innovation_window, innovation_window_options
   use gyroakf_filter_moving_average, only : moving_average
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_variational_bayes, only : filter_variational_bayes, variational_options
   use gyroakf_series_differences, only : difference_variance
   use gyroakf_pipeline_truth, only : score_output
   use gyroakf_pipeline_truth_result, only : score_of, truth_result_type
   use gyroakf_pipeline_warnings, only : is_fatal
   implicit none (type, external)
   private
   public :: score_unfiltered, score_averages, score_adaptive, model_decay, paper_decay

contains

   !> The series as it is, and nothing but the trend and the mean that were removed from it.
   subroutine score_unfiltered(z, interval, truth, error, valid)
      !> What the filters get: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> s
      real(dp), intent(in) :: interval
      !> Gets "none" and "trend"
      type(truth_result_type), intent(inout) :: truth
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: x(:)

      if (.not. truth%known) return
      call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) return
      call score_output("none", z, interval, truth, error, valid)
      if (allocated(error)) return
      x(:) = 0.0_dp
      call score_output("trend", x, interval, truth, error, valid, offline=.true.)
   end subroutine score_unfiltered

   !> Moving averages as long as the averaging time at which the Allan deviation is lowest.
   subroutine score_averages(z, interval, truth, error, valid)
      !> What the filters get: [n]
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: interval
      !> Gets "moving_average" and "centred_average"
      type(truth_result_type), intent(inout) :: truth
      !> no_memory; an average that cannot be computed is left out
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(allan_curve_type) :: curve
      type(read_off_type) :: lowest
      real(dp), allocatable :: x(:)
      integer :: i

      if (.not. truth%known) return
      call compute_allan(z, interval, allan_options(), curve, error, valid)
      if (.not. allocated(error)) call read_off(curve, read_off_options(), lowest, error)
      if (.not. allocated(error)) call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) then
         if (.not. is_fatal(error)) deallocate (error)
         return
      end if
      if (.not. lowest%minimum_tau > 0.0_dp) return
      truth%average_samples = max(1_int64, nint(lowest%minimum_tau/interval, int64))
      do i = 1, 2
         call moving_average(z, truth%average_samples, i == 2, x, error, valid)
         if (.not. allocated(error)) then
            if (i == 1) call score_output("moving_average", x, interval, truth, error, valid)
            if (i == 2) call score_output("centred_average", x, interval, truth, error, valid, offline=.true.)
         end if
         if (allocated(error)) return
      end do
   end subroutine score_averages

   !> Other filters of the drift model that was identified.
   subroutine score_adaptive(z, interval, model, slow, truth, error, valid)
      !> What the filters get: [n]
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: interval
      !> Drift and noise; which of its processes are drift: [count]
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      !> Gets "innovation_window" and "variational_bayes", and "drift_smoother" where it has none yet
      type(truth_result_type), intent(inout) :: truth
      !> no_memory; a filter that cannot be made is left out
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(innovation_window_options) :: window
      real(dp), allocatable :: x(:)
      real(dp) :: decay

      if (.not. truth%known) return
      call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) return
      decay = model_decay(model, slow)
      window%r_scale = 0.5_dp*difference_variance(z, valid)
      call filter_innovation_window(model, slow, window, z, x, error, valid)
      if (.not. allocated(error)) call score_output("innovation_window", x, interval, truth, error, valid, decay)
      call leave_out(error)
      if (allocated(error)) return
      call filter_variational_bayes(model, slow, variational_options(), z, x, error, valid)
      if (.not. allocated(error)) call score_output("variational_bayes", x, interval, truth, error, valid, decay)
      call leave_out(error)
      if (allocated(error)) return
      if (score_of(truth, "drift_smoother") == 0) then
         call smooth_drift(model, slow, z, x, error, valid)
         if (.not. allocated(error)) call score_output("drift_smoother", x, interval, truth, error, valid, decay, .true.)
         call leave_out(error)
      end if
   end subroutine score_adaptive

   !> A filter that cannot be made (of a model without white noise, for one) is left out; only a lack of memory stays an error.
   subroutine leave_out(error)
      type(error_type), allocatable, intent(inout) :: error

      if (.not. allocated(error)) return
      if (error%code /= status%no_memory) deallocate (error)
   end subroutine leave_out

   !> phi by which the output of a paper's filter is carried on: the largest root of its AR model, 0 where that is not known.
   real(dp) function paper_decay(phi)
      !> Coefficients: [p]
      real(dp), intent(in) :: phi(:)
      type(ar_root_type), allocatable :: root(:)
      type(error_type), allocatable :: error

      paper_decay = 0.0_dp
      call find_ar_roots(phi, root, error)
      if (.not. allocated(error)) paper_decay = min(1.0_dp, largest_modulus(root))
   end function paper_decay

   !> phi by which a drift is carried on: that of its slowest process.
   pure real(dp) function model_decay(model, slow)
      !> The model
      type(component_model_type), intent(in) :: model
      !> Which processes are the drift: [count]
      logical, intent(in) :: slow(:)

      model_decay = max(0.0_dp, maxval(model%phi(:model%count), mask=slow))
   end function model_decay

   !> Memory for one series.
   subroutine reserve(x, n, error)
      real(dp), allocatable, intent(out) :: x(:)
      integer(int64), intent(in) :: n
      type(error_type), allocatable, intent(out) :: error
      integer :: failed

      allocate (x(n), stat=failed)
      if (failed /= 0) call fatal_error(error, status%no_memory, "no memory for a series to compare with")
   end subroutine reserve

end module gyroakf_pipeline_alternatives
