! SPDX-License-Identifier: MIT
!> The variance of the white noise at each sample, from both sides.
!>
!> The adaptive drift filter runs over the record and over the reversed record. Each gives the variance $ R_k $ that the samples
!> before (behind) sample k let expect, times the factor by which the gate inflates it where the measurement does not fit. The
!> smoother weighs the samples by their geometric mean
!> $$ \ln R_k = \frac{w_k \ln R_k^+ + v_k \ln R_k^-}{w_k + v_k} $$
!> with the numbers of samples that stand behind the two, $ (1 - b^m)/(1 - b) $ after m adaptations.
module gyroakf_filter_weighing
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_creation, only : shorten_burn_in
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_kalman, only : filter_options, filter_type, step_filter
   use gyroakf_filter_sage_husa, only : gate_inflation
   implicit none (type, external)
   private
   public :: start_weighing, weigh_sample, weigh_behind

   !> No sample
   real(dp), parameter :: missing = huge(1.0_dp)

contains

   !> Makes the filter that weighs the samples.
   subroutine start_weighing(filter, model, slow, options, n, error)
      !> Ready for the first sample, and for the last
      type(filter_type), intent(out) :: filter
      !> As new_drift_filter
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      !> `estimate_measurement_variance` is taken as set; a burn-in that is found (-1) is n/10 at most
      type(filter_options), intent(in) :: options
      !> Samples of the series
      integer(int64), intent(in) :: n
      !> Those of new_drift_filter
      type(error_type), allocatable, intent(out) :: error
      type(filter_options) :: adaptive

      adaptive = options
      adaptive%estimate_measurement_variance = .true.
      call new_drift_filter(filter, model, slow, adaptive, error)
      if (allocated(error)) return
      if (options%burn_in < 0) call shorten_burn_in(filter, n)
   end subroutine start_weighing

   !> A step of the filter, and the variance of the white noise that it expected.
   pure subroutine weigh_sample(filter, z, here, r)
      !> Its state goes on
      type(filter_type), intent(inout) :: filter
      !> The sample
      real(dp), intent(in) :: z
      !> Whether it is there
      logical, intent(in) :: here
      !> Variance, times the factor of the gate
      real(dp), intent(out) :: r
      real(dp) :: x
      logical :: first

      r = filter%r
      first = .not. filter%drift_state%started
      call step_filter(filter, merge(z, missing, here), x)
      if (.not. here .or. first) return
      r = r*gate_inflation(filter%options%huber, filter%innovation, filter%innovation_variance)
   end subroutine weigh_sample

   !> The same on the way back, joined with what the way there found.
   pure subroutine weigh_behind(fresh, filter, seen, z, here, r)
      !> The filter as made
      type(filter_type), intent(in) :: fresh
      !> Its state goes on, back in time
      type(filter_type), intent(inout) :: filter
      !> Measurements of the series up to this sample, afterwards those before it
      integer(int64), intent(inout) :: seen
      !> The sample
      real(dp), intent(in) :: z
      !> Whether it is there
      logical, intent(in) :: here
      !> That from before; afterwards from both sides
      real(dp), intent(inout) :: r
      real(dp) :: share, weight

      if (here) seen = seen - 1
      share = memory_of(fresh, seen)
      weight = memory_of(fresh, filter%measurements)
      if (share + weight > 0.0_dp) then
         share = share/(share + weight)
      else
         share = 0.5_dp
      end if
      call weigh_sample(filter, z, here, weight)
      r = exp(share*log(r) + (1.0_dp - share)*log(weight))
   end subroutine weigh_behind

   !> Measurements that R remembers after so many.
   pure real(dp) function memory_of(fresh, measurements) result(memory)
      !> The filter as made
      type(filter_type), intent(in) :: fresh
      !> So many
      integer(int64), intent(in) :: measurements
      integer(int64) :: adapted

      adapted = measurements - fresh%wait - merge(0, 1, fresh%drift_state%started)
      memory = 0.0_dp
      if (adapted <= 0) return
      memory = real(adapted, dp)
      associate (b => fresh%options%forgetting)
         if (b < 1.0_dp) memory = (1.0_dp - b**min(adapted, int(fresh%weight_updates, int64)))/(1.0_dp - b)
      end associate
   end function memory_of

end module gyroakf_filter_weighing
