! SPDX-License-Identifier: MIT
!> The drift of a record whose white noise changes: its variance from both sides, then the
!> fixed-interval smoother.
!>
!> The adaptive drift filter runs over the record and over the reversed record. Each gives the
!> variance $ R_k $ that the samples before (behind) sample k let expect, times the factor by which
!> the gate inflates it where the measurement does not fit. The smoother weighs the samples by their
!> geometric mean
!> $$ \ln R_k = \frac{w_k \ln R_k^+ + v_k \ln R_k^-}{w_k + v_k} $$
!> with the numbers of samples that stand behind the two, $ (1 - b^m)/(1 - b) $ after m adaptations.
module gyroakf_filter_two_pass
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_filter_components, only : component_model_type, is_sample
   use gyroakf_filter_creation, only : shorten_burn_in
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, step_filter
   use gyroakf_filter_sage_husa, only : gate_inflation
   use gyroakf_filter_smoother, only : check_sizes, smooth_drift
   implicit none (type, external)
   private
   public :: smooth_adaptive

   !> Samples between two reports of progress
   integer(int64), parameter :: report_samples = 262144
   !> No sample
   real(dp), parameter :: missing = huge(1.0_dp)

contains

   !> Smooths the drift out of a series whose white noise changes its variance.
   subroutine smooth_adaptive(model, slow, options, z, drift, error, valid, variance, white, &
      progress)
      !> As new_drift_filter
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      !> Of the adaptive filter; `estimate_measurement_variance` is taken as set; a burn-in that is
      !> found (-1) is n/10 at most
      type(filter_options), intent(in) :: options
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Its drift, also where samples are missing: [n]; not the same array as z
      real(dp), intent(out), contiguous :: drift(:)
      !> Those of new_drift_filter and smooth_drift; no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Variance of the drift's error: [n]
      real(dp), intent(inout), optional :: variance(:)
      !> Variance of the white noise of each sample, inflated where the gate acted: [n]
      real(dp), intent(inout), optional :: white(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(drift_filter_type) :: filter
      type(filter_options) :: adaptive
      real(dp), allocatable :: r(:)
      integer(int64) :: n
      integer :: stat

      n = size(z, kind=int64)
      adaptive = options
      adaptive%estimate_measurement_variance = .true.
      call new_drift_filter(filter, model, slow, adaptive, error)
      if (.not. allocated(error)) call check_sizes(n, size(drift, kind=int64), .true., error, &
         valid, variance, white)
      if (allocated(error)) return
      if (options%burn_in < 0) call shorten_burn_in(filter%filter_type, n)
      allocate (r(n), stat=stat)
      call check_memory(stat, "the white noise of a series", error)
      if (allocated(error)) return
      call weigh_both_ways(filter, z, r, drift, error, valid, progress)
      if (allocated(error)) return
      call join_ways(filter, z, r, drift, valid)
      call smooth_drift(model, slow, z, drift, error, valid, variance, r, progress)
      if (present(white)) white(:) = r
   end subroutine smooth_adaptive

   !> The variance of the white noise that the samples before, and those behind, let expect: one
   !> thread each.
   subroutine weigh_both_ways(fresh, z, before, behind, error, valid, progress)
      type(drift_filter_type), intent(in) :: fresh
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(inout), contiguous :: before(:), behind(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(drift_filter_type) :: filter(2)
      integer(int64) :: done, k, last, n
      integer :: way

      n = size(z, kind=int64)
      filter(1) = fresh
      filter(2) = fresh
      do done = 0, n - 1, report_samples
         call report_progress("weighing the samples", done, n, error, progress)
         if (allocated(error)) return
         last = min(n, done + report_samples)
         !$omp parallel do private(k) schedule(static, 1)
         do way = 1, 2
            do k = done + 1, last
               if (way == 1) call weigh_sample(filter(1), z(k), is_here(z, k, valid), before(k))
               if (way == 2) call weigh_sample(filter(2), z(n + 1 - k), &
                  is_here(z, n + 1 - k, valid), behind(n + 1 - k))
            end do
         end do
         !$omp end parallel do
      end do
   end subroutine weigh_both_ways

   !> Whether sample k of a series is there.
   pure logical function is_here(z, k, valid)
      real(dp), intent(in), contiguous :: z(:)
      integer(int64), intent(in) :: k
      integer(int8), intent(in), optional :: valid(:)

      is_here = is_sample(z(k))
      if (present(valid)) is_here = is_here .and. valid(k) /= 0_int8
   end function is_here

   !> A step of the filter, and the variance of the white noise that it expected.
   pure subroutine weigh_sample(filter, z, here, r)
      type(drift_filter_type), intent(inout) :: filter
      real(dp), intent(in) :: z
      logical, intent(in) :: here
      !> Variance, times the factor of the gate
      real(dp), intent(out) :: r
      real(dp) :: x
      logical :: first

      r = filter%r
      first = .not. filter%state%started
      call step_filter(filter, merge(z, missing, here), x)
      if (.not. here .or. first) return
      r = r*gate_inflation(filter%options%huber, filter%innovation, filter%innovation_variance)
   end subroutine weigh_sample

   !> The geometric mean of the two variances of each sample.
   subroutine join_ways(fresh, z, before, behind, valid)
      type(drift_filter_type), intent(in) :: fresh
      real(dp), intent(in), contiguous :: z(:)
      !> Variance from before, [n]; from both sides afterwards
      real(dp), intent(inout), contiguous :: before(:)
      real(dp), intent(in), contiguous :: behind(:)
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: share, weight
      integer(int64) :: k, left, seen

      left = 0
      do k = 1, size(z, kind=int64)
         if (is_here(z, k, valid)) left = left + 1
      end do
      seen = 0
      do k = 1, size(z, kind=int64)
         if (is_here(z, k, valid)) left = left - 1
         share = memory_of(fresh, seen)
         weight = memory_of(fresh, left)
         if (share + weight > 0.0_dp) then
            share = share/(share + weight)
         else
            share = 0.5_dp
         end if
         before(k) = exp(share*log(before(k)) + (1.0_dp - share)*log(behind(k)))
         if (is_here(z, k, valid)) seen = seen + 1
      end do
   end subroutine join_ways

   !> Measurements that R remembers after so many.
   pure real(dp) function memory_of(fresh, measurements) result(memory)
      type(drift_filter_type), intent(in) :: fresh
      integer(int64), intent(in) :: measurements
      integer(int64) :: adapted

      adapted = measurements - fresh%wait - merge(0, 1, fresh%state%started)
      memory = 0.0_dp
      if (adapted <= 0) return
      memory = real(adapted, dp)
      associate (b => fresh%options%forgetting)
         if (b < 1.0_dp) memory = &
            (1.0_dp - b**min(adapted, int(fresh%weight_updates, int64)))/(1.0_dp - b)
      end associate
   end function memory_of

end module gyroakf_filter_two_pass
