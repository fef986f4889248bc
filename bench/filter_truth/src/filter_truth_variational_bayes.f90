! SPDX-License-Identifier: MIT
!> The filter of a drift model whose white noise R is estimated together with the state by variational Bayes.
!>
!> The state is normal, R inverse gamma with alpha and beta. A measurement makes, from the prediction,
!> $$ \alpha \leftarrow \rho \alpha + \tfrac12, \quad \beta^- = \rho \beta, \quad R = \beta/\alpha, \quad
!>    \beta \leftarrow \beta^- + \tfrac12 (z - \hat x)^2 + \tfrac12 P $$
!> with the state corrected by R in between; this is repeated a few times. The memory is 1/(1 - rho) measurements. Nothing can turn
!> negative, and an outlier raises the R that it is weighed with. Without a measurement alpha and beta stay.
!>
!> Source: Sarkka & Nummenmaa, Recursive noise adaptive Kalman filtering by variational Bayesian approximations, IEEE Trans.
!> Automatic Control 54 (2009) 596-600.
module filter_truth_variational_bayes
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_components, only : check_components, component_model_type, &
      component_state_type, correct_components, predict_components, start_components, is_sample
   implicit none (type, external)
   private
   public :: variational_options, filter_variational_bayes

   !> How R is estimated
   type :: variational_options
      !> Forgetting rho, 0 < rho < 1
      real(dp) :: forgetting = 0.98_dp
      !> Repetitions at each measurement, >= 1
      integer :: repetitions = 5
      !> Measurements that the R of the model counts for at the start; 0: the memory 1/(1 - rho)
      real(dp) :: prior_measurements = 0.0_dp
   end type variational_options

   !> R of a series without any noise never becomes 0: a gain could not be told
   real(dp), parameter :: smallest = 1.0e-250_dp

contains

   !> Filters a series.
   subroutine filter_variational_bayes(model, slow, options, z, drift, error, valid, white)
      !> Checked here; its R, > 0, begins
      type(component_model_type), intent(in) :: model
      !> Which processes are the drift: [count]
      logical, intent(in) :: slow(:)
      type(variational_options), intent(in) :: options
      !> Series: [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Its drift, predicted where a sample is missing: [n]; not the same array as z
      real(dp), intent(out), contiguous :: drift(:)
      !> invalid_argument (sizes, options, model), non_finite, unstable
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> R at each sample: [n]
      real(dp), intent(out), optional :: white(:)
      type(component_state_type) :: state
      real(dp) :: alpha, beta
      integer(int64) :: k
      integer :: n
      logical :: here

      call check_components(model, error)
      if (.not. allocated(error)) call check_arguments(model, slow, options, z, drift, error, valid, white)
      if (allocated(error)) return
      n = model%count
      alpha = 0.5_dp*options%prior_measurements
      if (.not. alpha > 0.0_dp) alpha = 0.5_dp/(1.0_dp - options%forgetting)
      beta = alpha*model%r
      call start_components(model, state)
      do k = 1, size(z, kind=int64)
         call predict_components(model, state)
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         if (here .and. state%started) then
            call correct_variational(n, options, z(k), alpha, beta, state)
         else if (here) then
            call correct_components(n, beta/alpha, z(k), state)
         end if
         drift(k) = sum(state%x(:n), mask=slow)
         if (present(white)) white(k) = beta/alpha
      end do
   end subroutine filter_variational_bayes

   !> Refuses what is no filter.
   subroutine check_arguments(model, slow, options, z, drift, error, valid, white)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(variational_options), intent(in) :: options
      real(dp), intent(in) :: z(:), drift(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), intent(in), optional :: white(:)
      logical :: good

      good = size(slow) == model%count .and. size(drift, kind=int64) == size(z, kind=int64)
      if (present(valid)) good = good .and. size(valid, kind=int64) == size(z, kind=int64)
      if (present(white)) good = good .and. size(white, kind=int64) == size(z, kind=int64)
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, "a filter needs a series, an output and masks of one length, and a "// &
                          "word for each process")
         return
      end if
      good = is_sample(options%forgetting) .and. is_sample(options%prior_measurements) .and. options%repetitions >= 1
      if (good) good = options%forgetting > 0.0_dp .and. options%forgetting < 1.0_dp .and. &
                       options%prior_measurements >= 0.0_dp .and. model%r > 0.0_dp
      if (.not. good) call fatal_error(error, status%invalid_argument, "variational Bayes needs 0 < rho < 1, at least one "// &
                                       "repetition, a prior of >= 0 measurements, and a model with R > 0")
   end subroutine check_arguments

   !> Correction of the state and of the distribution of R by a measurement.
   pure subroutine correct_variational(n, options, z, alpha, beta, state)
      !> Processes
      integer, intent(in) :: n
      type(variational_options), intent(in) :: options
      !> The measurement
      real(dp), intent(in) :: z
      !> Of R
      real(dp), intent(inout) :: alpha, beta
      !> Predicted; goes on
      type(component_state_type), intent(inout) :: state
      type(component_state_type) :: corrected
      real(dp) :: prior
      integer :: i

      alpha = options%forgetting*alpha + 0.5_dp
      prior = options%forgetting*beta
      beta = max(smallest, prior)
      do i = 1, options%repetitions
         corrected = state
         call correct_components(n, beta/alpha, z, corrected)
         beta = max(smallest, prior + 0.5_dp*(z - sum(corrected%x(:n)))**2 + 0.5_dp*sum(corrected%p(:n, :n)))
      end do
      state = corrected
   end subroutine correct_variational

end module filter_truth_variational_bayes
