! SPDX-License-Identifier: MIT
!> The least-squares problem of [[gyroakf_allan_noise_fit]] and its solution.
!>
!> Everything is relative to the model of the last step, so that rows are free of units: with the design
!> X_it = phi_t(tau_i)/sigma^2_model,i a step of Gauss and Newton for the logarithms solves, for theta >= 0,
!>
!> $$ \min \sum_i w_i \left( \sum_t X_{it} \theta_t - 1 - \ln\frac{\hat\sigma^2_i}{\sigma^2_{model,i}} + b_i \right)^2 $$
module gyroakf_allan_fit_problem
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_special, only : digamma
   use gyroakf_allan_covariance, only : allan_covariance
   use gyroakf_allan_noise_model, only : model_variance, term_count, term_shape
   use gyroakf_allan_nonnegative, only : solve_nonnegative
   implicit none (type, external)
   private
   public :: problem_type, minimise, model_at, scatter_of_model, mixture_edf, relative_design, trigamma

   !> Everything the fit works on; times in samples, squares for a sample interval of 1
   type :: problem_type
      !> Samples of the record
      integer(int64) :: samples = 0
      !> Averaging factors of the points
      integer(int64), allocatable :: m(:)
      !> Variances in units of `scale`, their degrees of freedom as known before, the share of their terms that gaps left
      real(dp), allocatable :: variance(:), edf(:), complete(:)
      !> Unit of the variances
      real(dp) :: scale = 1.0_dp
      !> Which terms are offered: their numbers
      integer, allocatable :: term(:)
      !> Relative variance by which the points miss the model beyond their own scatter
      real(dp) :: misfit = 0.0_dp
   end type problem_type

   !> Steps of the fit at most, and how many of them renew the weights
   integer, parameter :: steps_max = 200, steps_renewing = 20
   !> Relative change at which the fit has converged
   real(dp), parameter :: precision_goal = 1e-11_dp
   !> Least degrees of freedom of a weight
   real(dp), parameter :: edf_least = 0.5_dp

contains

   !> Finds the squares that fit best.
   subroutine minimise(problem, linear, squares, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Fit the variances instead of their logarithms
      logical, intent(in) :: linear
      !> Squared coefficients, 0 for terms that are not offered
      real(dp), intent(out) :: squares(term_count)
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      real(dp), dimension(size(problem%m)) :: half, weight, bias, target, model
      real(dp) :: change
      logical :: converged
      integer :: step

      squares = 0
      half = max(problem%edf, edf_least)/2
      weight = 1/(1/half + problem%misfit)
      target = 1
      call weighted_step(problem, problem%variance, weight, target, squares, change, converged)
      do step = 1, steps_max
         if (.not. converged) exit
         model = model_at(problem, squares)
         if (step <= steps_renewing) call scatter_of_model(problem, squares, half, bias)
         weight = 1/(1/half + problem%misfit)
         target = problem%variance/model
         if (linear) then
            call weighted_step(problem, model, weight, target, squares, change, converged)
         else
            target = 1 + log(target) - bias
            call weighted_step(problem, model, weight, target, squares, change, converged, bias)
         end if
         if (change < precision_goal .and. step > steps_renewing) return
      end do
      call fatal_error(error, status%not_converged, "the fit of the noise coefficients did not converge")
   end subroutine minimise

   !> Fitted variances at the points.
   pure function model_at(problem, squares) result(model)
      !> Points
      type(problem_type), intent(in) :: problem
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      real(dp) :: model(size(problem%m))

      integer :: i

      do i = 1, size(model)
         model(i) = max(model_variance(squares, real(problem%m(i), dp)), tiny(1.0_dp))
      end do
   end function model_at

   !> Half the degrees of freedom, and biases of the logarithms, from the model.
   pure subroutine scatter_of_model(problem, squares, half, bias)
      !> Points
      type(problem_type), intent(in) :: problem
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      !> nu/2: [points]
      real(dp), intent(out) :: half(:)
      !> psi(nu/2) - ln(nu/2): [points]
      real(dp), intent(out) :: bias(:)

      integer :: i

      do i = 1, size(half)
         half(i) = max(mixture_edf(problem%samples, problem%m(i), squares, problem%complete(i)), edf_least)/2
         bias(i) = digamma(half(i)) - log(half(i))
      end do
   end subroutine scatter_of_model

   !> Derivative of digamma (Abramowitz & Stegun 6.4.6 and 6.4.12, to 1e-8).
   elemental real(dp) function trigamma(x)
      !> Argument, > 0
      real(dp), intent(in) :: x

      real(dp) :: y, q

      trigamma = 0
      y = x
      do while (y < 8)
         trigamma = trigamma + 1/y**2
         y = y + 1
      end do
      q = 1/y**2
      trigamma = trigamma + 1/y + q/2 + q/y*(1/6.0_dp - q*(1/30.0_dp - q*(1/42.0_dp - q/30)))
   end function trigamma

   !> Degrees of freedom of a variance of the mixture.
   pure real(dp) function mixture_edf(samples, m, squares, complete) result(edf)
      !> Samples of the record
      integer(int64), intent(in) :: samples
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      !> Share of the terms that gaps left
      real(dp), intent(in) :: complete

      real(dp) :: variance

      variance = allan_covariance(samples, m, m, squares)
      edf = huge(1.0_dp)
      if (variance > 0) edf = complete*2*model_variance(squares, real(m, dp))**2/variance
      edf = min(edf, 1e15_dp)
   end function mixture_edf

   !> One non-negative step; with biases (logarithms) it is shortened until the sum of squares falls.
   subroutine weighted_step(problem, model, weight, target, squares, change, converged, bias)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Variances to which everything is relative
      real(dp), intent(in) :: model(:)
      !> Weights
      real(dp), intent(in) :: weight(:)
      !> What the relative model should be
      real(dp), intent(in) :: target(:)
      !> Squared coefficients, renewed
      real(dp), intent(inout) :: squares(term_count)
      !> Largest relative change of the model
      real(dp), intent(out) :: change
      !> False if a matrix was singular
      logical, intent(out) :: converged
      !> Biases of the logarithms
      real(dp), intent(in), optional :: bias(:)

      real(dp) :: design(size(model), size(problem%term)), length(size(problem%term)), x(size(problem%term))
      real(dp) :: before(term_count), full(term_count), merit
      integer :: halving

      call relative_design(problem, model, sqrt(weight), design, length)
      call solve_nonnegative(design, sqrt(weight)*target, x, converged)
      before = squares
      full = 0
      full(problem%term) = x/length
      squares = full
      if (present(bias)) then
         merit = sum(weight*(log(problem%variance/model) - bias)**2)
         do halving = 1, 30
            if (sum(weight*(log(problem%variance/model_at(problem, squares)) - bias)**2) <= merit*(1 + 1e-12_dp)) exit
            squares = before + (full - before)*0.5_dp**halving
         end do
      end if
      change = maxval(abs(squares(problem%term) - before(problem%term))*length)/norm2(sqrt(weight))
   end subroutine weighted_step

   !> Shapes of the terms relative to the model, columns of length 1.
   pure subroutine relative_design(problem, model, factor, design, length)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Variances to which everything is relative
      real(dp), intent(in) :: model(:)
      !> Multiplies each row
      real(dp), intent(in) :: factor(:)
      !> The matrix: [points, terms]
      real(dp), intent(out) :: design(:, :)
      !> By what each column was divided
      real(dp), intent(out) :: length(:)

      integer :: j

      do j = 1, size(problem%term)
         design(:, j) = factor*term_shape(problem%term(j), real(problem%m, dp))/model
         length(j) = norm2(design(:, j))
         design(:, j) = design(:, j)/length(j)
      end do
   end subroutine relative_design

end module gyroakf_allan_fit_problem
