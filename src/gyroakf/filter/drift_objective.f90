! SPDX-License-Identifier: MIT
!> The exact likelihood of a drift model as a function to be minimized, and the standard errors from
!> its curvature.
!>
!> The parameters are artanh(phi) and ln D of the AR(1) process (its own variance, not that of its
!> driving noise), ln q of the random walk, ln r, for a series of variance 1. The value is minus the
!> log-likelihood of a sample on average.
module gyroakf_filter_drift_objective
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_progress, only : progress_type
   use gyroakf_quasi_newton, only : objective_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   implicit none (type, external)
   private
   public :: progress_share_type, likelihood_objective
   public :: parameters_of, value_at, model_of, starting_point, invert_curvature, give_errors

   !> Parameters of a model with all processes
   integer, parameter :: most_parameters = 4

   !> Forwards the progress of a part of a job
   type, extends(progress_type) :: progress_share_type
      !> Progress callback of the whole; none where not associated
      class(progress_type), pointer :: whole => null()
      !> Size of the whole, its share that is done before this part, the share of this part
      integer(int64) :: total = 0
      real(dp) :: before = 0.0_dp, share = 1.0_dp
   contains
      procedure :: advance => advance_share
   end type progress_share_type

   !> Likelihood of the scaled series by transformed parameters
   type, extends(objective_type) :: likelihood_objective
      !> Less its mean, over its standard deviation
      real(dp), allocatable :: z(:)
      !> Which samples there are; not allocated where all are
      integer(int8), allocatable :: here(:)
      !> The processes of the model
      logical :: walk = .false., ar = .false.
      !> Parameters of processes that are not there and of variances that are 0
      logical :: zero(most_parameters) = .false.
      integer(int64) :: measurements = 0
      !> Progress of the fit; its `whole` is valid while the fit is made
      type(progress_share_type) :: progress
      !> Candidates done and all of them, evaluations for this one; cancelled where the caller wants
      !> no more
      integer :: done = 0, candidates = 1, evaluations = 0
      type(error_type), allocatable :: cancelled
   contains
      procedure :: evaluate => evaluate_likelihood
   end type likelihood_objective

   !> Logarithms of variances beyond it stand for 0 or infinity; artanh(phi) beyond which phi is 1
   real(dp), parameter :: widest = 60.0_dp, steepest = 9.0_dp
   !> Step of the differences of the gradient to both sides: what they leave out is a few 1e-5 of
   !> the curvature (the next term of the series, difference^2/6), and the gradient's rounding grows
   !> by 1/difference at most
   real(dp), parameter :: difference = 1.0e-2_dp
   !> Evaluations after which half of a candidate's work is said to be done
   integer, parameter :: usual_evaluations = 20

contains

   !> Fitted parameters.
   pure integer function parameters_of(objective) result(n)
      type(likelihood_objective), intent(in) :: objective

      n = 1 + merge(2, 0, objective%ar) + merge(1, 0, objective%walk)
   end function parameters_of

   !> Transformed parameters of a model of variance 1.
   pure function starting_point(objective, phi, share, step, white) result(parameter)
      type(likelihood_objective), intent(in) :: objective
      !> Of the AR(1) process: coefficient, variance
      real(dp), intent(in) :: phi, share
      !> q of the random walk, r
      real(dp), intent(in) :: step, white
      real(dp) :: parameter(1 + merge(2, 0, objective%ar) + merge(1, 0, objective%walk))

      if (objective%ar) parameter(1) = sign(atanh(min(abs(phi), tanh(0.9_dp*steepest))), phi)
      if (objective%ar) parameter(2) = log(share)
      if (objective%walk) parameter(size(parameter) - 1) = log(step)
      parameter(size(parameter)) = log(white)
   end function starting_point

   !> The model of transformed parameters: artanh phi and ln D of the AR(1) process, ln q of the
   !> random walk, ln r. The gradient by the parameter of a variance that is held at 0 is 0 too.
   pure subroutine model_of(objective, parameter, model)
      type(likelihood_objective), intent(in) :: objective
      real(dp), intent(in) :: parameter(:)
      type(component_model_type), intent(out) :: model
      integer :: next

      next = 1
      if (objective%ar) then
         model%count = 1
         if (.not. objective%zero(1)) model%phi(1) = tanh(parameter(1))
         if (.not. objective%zero(2)) model%q(1) = exp(parameter(2))/cosh(parameter(1))**2
         next = 3
      end if
      if (objective%walk) then
         model%count = model%count + 1
         model%phi(model%count) = 1.0_dp
         if (.not. objective%zero(next)) model%q(model%count) = exp(parameter(next))
         next = next + 1
      end if
      if (.not. objective%zero(next)) model%r = exp(parameter(next))
   end subroutine model_of

   !> Minus the log-likelihood of a sample on average.
   subroutine evaluate_likelihood(self, parameter, value, gradient, feasible)
      class(likelihood_objective), intent(inout) :: self
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: value, gradient(:)
      logical, intent(out) :: feasible
      type(component_model_type) :: model
      type(error_type), allocatable :: failed
      real(dp) :: slope(7), share
      integer :: n, next

      value = 0.0_dp
      gradient = 0.0_dp
      feasible = all(abs(parameter) < widest) .and. .not. allocated(self%cancelled)
      if (feasible .and. self%ar) feasible = abs(parameter(1)) < steepest
      if (.not. feasible) return
      call begin_evaluation(self)
      call model_of(self, parameter, model)
      n = model%count
      call component_likelihood(model, self%z, value, failed, self%here, slope(:2*n + 1), &
         self%progress)
      feasible = .not. allocated(failed)
      if (.not. feasible) then
         if (failed%code == status%cancelled) call move_alloc(failed, self%cancelled)
         return
      end if
      share = -1.0_dp/real(self%measurements, dp)
      value = share*value
      next = 1
      if (self%ar) then
         gradient(1) = &
            share*(slope(1)/cosh(parameter(1))**2 - 2.0_dp*model%phi(1)*model%q(1)*slope(n + 1))
         gradient(2) = share*slope(n + 1)*model%q(1)
         next = 3
      end if
      if (self%walk) then
         gradient(next) = share*slope(2*n)*model%q(n)
         next = next + 1
      end if
      gradient(next) = share*slope(2*n + 1)*model%r
   end subroutine evaluate_likelihood

   !> The share of the fit that the next pass of the series is: half of what is left of a candidate
   !> is done after some evaluations.
   pure subroutine begin_evaluation(self)
      class(likelihood_objective), intent(inout) :: self
      real(dp) :: before, behind

      before = real(self%evaluations, dp)/real(self%evaluations + usual_evaluations, dp)
      self%evaluations = self%evaluations + 1
      behind = real(self%evaluations, dp)/real(self%evaluations + usual_evaluations, dp)
      self%progress%total = self%candidates*size(self%z, kind=int64)
      self%progress%before = (real(self%done, dp) + before)/real(self%candidates, dp)
      self%progress%share = (behind - before)/real(self%candidates, dp)
   end subroutine begin_evaluation

   !> Minus the log-likelihood without its gradient, huge where there is none.
   real(dp) function value_at(objective, parameter) result(value)
      type(likelihood_objective), intent(inout) :: objective
      real(dp), intent(in) :: parameter(:)
      type(component_model_type) :: model
      type(error_type), allocatable :: failed

      value = huge(1.0_dp)
      if (allocated(objective%cancelled)) return
      call begin_evaluation(objective)
      call model_of(objective, parameter, model)
      call component_likelihood(model, objective%z, value, failed, objective%here, &
         progress=objective%progress)
      value = -value/real(objective%measurements, dp)
      if (.not. allocated(failed)) return
      value = huge(1.0_dp)
      if (failed%code == status%cancelled) call move_alloc(failed, objective%cancelled)
   end function value_at

   !> Covariance of the transformed parameters: inverse of the curvature of the log-likelihood. The
   !> parameters held at 0 are not varied: the others have the errors that they have without them.
   subroutine invert_curvature(objective, parameter, inverse, known)
      type(likelihood_objective), intent(inout) :: objective
      !> Where it is wanted
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: inverse(:, :)
      !> False where it is not that of a maximum
      logical, intent(out) :: known
      real(dp), dimension(size(parameter)) :: near, below, above
      real(dp) :: value
      integer :: i, k, n, info

      n = size(parameter)
      inverse = 0.0_dp
      known = .true.
      do k = 1, n
         if (objective%zero(k)) then
            inverse(k, k) = 1.0_dp
            cycle
         end if
         near = parameter
         near(k) = parameter(k) - difference
         call objective%evaluate(near, value, below, known)
         if (.not. known) return
         near(k) = parameter(k) + difference
         call objective%evaluate(near, value, above, known)
         if (.not. known) return
         inverse(:, k) = (above - below)/(2.0_dp*difference)*real(objective%measurements, dp)
      end do
      inverse = 0.5_dp*(inverse + transpose(inverse))
      call dpotrf("L", n, inverse, n, info)
      if (info == 0) call dpotri("L", n, inverse, n, info)
      known = info == 0
      do k = 2, n
         do i = 1, k - 1
            inverse(i, k) = inverse(k, i)
         end do
      end do
   end subroutine invert_curvature

   !> Standard errors of phi, q and r; 0 for what is held at 0.
   pure subroutine give_errors(objective, parameter, inverse, scale, model, std_error)
      type(likelihood_objective), intent(in) :: objective
      real(dp), intent(in) :: parameter(:)
      !> Lower triangle
      real(dp), intent(in) :: inverse(:, :)
      real(dp), intent(in) :: scale
      !> That of the scaled series
      type(component_model_type), intent(in) :: model
      !> Of the series itself
      type(component_model_type), intent(out) :: std_error
      real(dp) :: tangent
      integer :: next, n

      n = model%count
      std_error%count = n
      next = 1
      if (objective%ar) then
         tangent = -2.0_dp*model%phi(1)
         if (.not. objective%zero(1)) std_error%phi(1) = sqrt(inverse(1, 1))/cosh(parameter(1))**2
         std_error%q(1) = scale**2*model%q(1)*sqrt(max(0.0_dp, tangent**2*inverse(1, 1) &
            + inverse(2, 2) + 2.0_dp*tangent*inverse(2, 1)))
         next = 3
      end if
      if (objective%walk) then
         std_error%q(n) = scale**2*model%q(n)*sqrt(inverse(next, next))
         next = next + 1
      end if
      std_error%r = scale**2*model%r*sqrt(inverse(next, next))
   end subroutine give_errors

   !> Reports the progress of the whole.
   subroutine advance_share(self, stage, done, total, cancel)
      class(progress_share_type), intent(inout) :: self
      !> Of this part, as [[gyroakf_progress(module)]]
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel
      real(dp) :: reached

      cancel = .false.
      if (.not. associated(self%whole)) return
      reached = self%before
      if (total > 0) reached = reached + self%share*real(done, dp)/real(total, dp)
      call self%whole%advance(stage, min(self%total, int(reached*real(self%total, dp), int64)), &
         self%total, cancel)
   end subroutine advance_share

end module gyroakf_filter_drift_objective
