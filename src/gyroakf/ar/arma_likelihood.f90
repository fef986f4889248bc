! SPDX-License-Identifier: MIT
!> The exact Gaussian likelihood of an ARMA(p, q) series with a mean, p, q <= 3.
!>
!> With the innovations v_t of variance sigma^2 F_t, n of them,
!> $$\ln L = -\frac12 \Big(n \ln 2\pi\sigma^2 + \sum \ln F_t + \frac{1}{\sigma^2} \sum \frac{v_t^2}{F_t}\Big),$$
!> largest for sigma^2 = (sum of v^2/F)/n, which is put in (concentrated out). Minimised is -ln L/n without constants. The
!> information about coefficients and mean is
!> $$I_{ij} = \frac{1}{\sigma^2} \sum \frac{v_i' v_j'}{F} + \frac12 \sum \frac{F_i' F_j'}{F^2} - \frac{1}{2n} \sum \frac{F_i'}{F}
!>   \sum \frac{F_j'}{F},$$
!> the expected Hessian of -ln L given the innovations, never indefinite. Source: A. C. Harvey (1989), 3.4.
module gyroakf_ar_arma_likelihood
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_quasi_newton, only : objective_type
   use gyroakf_filter_progress_share, only : progress_share_type
   use gyroakf_ar_arma_transform, only : coefficients_of, farthest
   use gyroakf_ar_arma_state, only : arma_sums_type, most, mean_lane
   use gyroakf_ar_arma_filter, only : arma_series_type, sum_innovations
   implicit none (type, external)
   private
   public :: arma_objective_type, arma_log_likelihood, log_likelihood_of, split_free, information_of, start_inverse

   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
   !> Evaluations after which half of the work is said to be done
   integer, parameter :: usual_evaluations = 30

   !> -ln L/n of a series as a function of free parameters: p of the AR, q of the MA polynomial, the mean
   type, extends(objective_type) :: arma_objective_type
      !> The series
      type(arma_series_type) :: series
      !> Orders
      integer :: p = 0, q = 0
      !> Who is told; evaluations begun; allocated where no more are wanted
      type(progress_share_type) :: share
      integer :: begun = 0
      type(error_type), allocatable :: cancelled
   contains
      procedure :: evaluate => evaluate_arma
   end type arma_objective_type

contains

   !> Log-likelihood of a series under given coefficients, sigma^2 at its best.
   subroutine arma_log_likelihood(x, phi, theta, mean, log_likelihood, noise_variance, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> AR coefficients of a stationary model: [p], p <= 3
      real(dp), intent(in) :: phi(:)
      !> MA coefficients, x_t = ... + e_t + theta_1 e_(t-1) + ...: [q], q <= 3; they need not be invertible
      real(dp), intent(in) :: theta(:)
      !> Mean
      real(dp), intent(in) :: mean
      !> ln L
      real(dp), intent(out) :: log_likelihood
      !> sigma^2
      real(dp), intent(out) :: noise_variance
      !> invalid_argument (orders, size of valid), too_few_samples (none), unstable, singular (all innovations 0), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(arma_series_type) :: series
      type(arma_sums_type) :: sums
      logical :: stationary
      integer :: failed

      log_likelihood = 0.0_dp
      noise_variance = 0.0_dp
      if (size(phi) > most .or. size(theta) > most) then
         call fatal_error(error, status%invalid_argument, "the orders of an ARMA model are at most 3")
         return
      end if
      if (present(valid)) then
         if (size(valid, kind=int64) /= size(x, kind=int64)) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
            return
         end if
      end if
      allocate (series%y(size(x, kind=int64)), stat=failed)
      if (failed == 0 .and. present(valid)) allocate (series%valid(size(x, kind=int64)), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for a copy of the series")
         return
      end if
      series%y(:) = x - mean
      if (present(valid)) series%valid(:) = valid
      call sum_innovations(series, phi, theta, 0.0_dp, sums, stationary, .false.)
      if (.not. stationary) then
         call fatal_error(error, status%unstable, "the ARMA model is not stationary")
      else if (sums%count < 1) then
         call fatal_error(error, status%too_few_samples, "the series has no sample")
      else if (sums%square <= 0.0_dp) then
         call fatal_error(error, status%singular, "the ARMA model predicts every sample exactly")
      else
         noise_variance = sums%square/real(sums%count, dp)
         log_likelihood = log_likelihood_of(sums)
      end if
   end subroutine arma_log_likelihood

   !> ln L, sigma^2 at its best.
   pure real(dp) function log_likelihood_of(sums) result(log_likelihood)
      !> With samples that are not all predicted
      type(arma_sums_type), intent(in) :: sums
      real(dp) :: n

      n = real(sums%count, dp)
      log_likelihood = -0.5_dp*(n*(log_two_pi + 1.0_dp + log(sums%square/n)) + sums%log_f)
   end function log_likelihood_of

   !> -ln L/n without constants, and its gradient by the free parameters.
   subroutine evaluate_arma(self, parameter, value, gradient, feasible)
      class(arma_objective_type), intent(inout) :: self
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: value, gradient(:)
      logical, intent(out) :: feasible
      type(arma_sums_type) :: sums
      real(dp) :: phi(self%p), theta(self%q), jacobian(self%p + self%q + 1, self%p + self%q + 1), natural(self%p + self%q + 1), n

      value = 0.0_dp
      gradient(:) = 0.0_dp
      feasible = all(abs(parameter(:self%p + self%q)) <= farthest) .and. .not. allocated(self%cancelled)
      if (.not. feasible) return
      call begin_evaluation(self)
      call split_free(parameter, phi, theta, jacobian)
      call sum_innovations(self%series, phi, theta, parameter(size(parameter)), sums, feasible, .false., progress=self%share, &
         & cancelled=self%cancelled)
      if (feasible) feasible = sums%square > 0.0_dp
      if (.not. feasible) return
      n = real(sums%count, dp)
      value = 0.5_dp*(log(sums%square/n) + sums%log_f/n)
      natural(:) = pick(sums%square_slope, self%p, self%q)/sums%square + 0.5_dp*pick(sums%log_f_slope, self%p, self%q)/n
      gradient(:) = matmul(natural, jacobian)
   end subroutine evaluate_arma

   !> The share of the work that the next pass of the series is: that of what is left gets smaller and smaller.
   pure subroutine begin_evaluation(objective)
      class(arma_objective_type), intent(inout) :: objective

      objective%share%total = size(objective%series%y, kind=int64)
      objective%share%before = real(objective%begun, dp)/real(objective%begun + usual_evaluations, dp)
      objective%begun = objective%begun + 1
      objective%share%share = real(objective%begun, dp)/real(objective%begun + usual_evaluations, dp) - objective%share%before
   end subroutine begin_evaluation

   !> Coefficients of free parameters.
   pure subroutine split_free(parameter, phi, theta, jacobian)
      !> Free parameters, those of the AR polynomial first, the mean last: [p + q + 1]
      real(dp), intent(in) :: parameter(:)
      !> Coefficients: [p], [q]
      real(dp), intent(out) :: phi(:), theta(:)
      !> Derivatives of (phi, theta, mean): [p + q + 1, p + q + 1]
      real(dp), intent(out) :: jacobian(:, :)
      integer :: p, q

      p = size(phi)
      q = size(theta)
      jacobian(:, :) = 0.0_dp
      call coefficients_of(parameter(:p), phi, jacobian(:p, :p))
      call coefficients_of(parameter(p + 1:p + q), theta, jacobian(p + 1:p + q, p + 1:p + q))
      theta(:) = -theta
      jacobian(p + 1:p + q, p + 1:p + q) = -jacobian(p + 1:p + q, p + 1:p + q)
      jacobian(p + q + 1, p + q + 1) = 1.0_dp
   end subroutine split_free

   !> The derivatives that a model has, in the order of its parameters.
   pure function pick(lane, p, q) result(natural)
      real(dp), intent(in) :: lane(:)
      integer, intent(in) :: p, q
      real(dp) :: natural(p + q + 1)

      natural(:p) = lane(:p)
      natural(p + 1:p + q) = lane(most + 1:most + q)
      natural(p + q + 1) = lane(mean_lane)
   end function pick

   !> Information about (phi, theta, mean), of the whole series.
   pure subroutine information_of(sums, p, q, information)
      !> Sums with information
      type(arma_sums_type), intent(in) :: sums
      !> Orders
      integer, intent(in) :: p, q
      !> The matrix: [p + q + 1, p + q + 1]
      real(dp), intent(out) :: information(:, :)
      real(dp) :: n
      integer :: lane(p + q + 1), i, j

      n = real(sums%count, dp)
      do i = 1, p
         lane(i) = i
      end do
      do i = 1, q
         lane(p + i) = most + i
      end do
      lane(p + q + 1) = mean_lane
      do j = 1, size(lane)
         do i = 1, size(lane)
            information(i, j) = sums%information(lane(i), lane(j))*(n/sums%square) &
               + 0.5_dp*sums%f_information(lane(i), lane(j)) &
               - 0.5_dp*sums%log_f_slope(lane(i))*sums%log_f_slope(lane(j))/n
         end do
      end do
   end subroutine information_of

   !> Inverse Hessian of the objective, from the information at a point.
   subroutine start_inverse(objective, parameter, inverse, known)
      !> The objective
      type(arma_objective_type), intent(inout) :: objective
      !> Free parameters
      real(dp), intent(in) :: parameter(:)
      !> The matrix
      real(dp), intent(out) :: inverse(:, :)
      !> It is regular
      logical, intent(out) :: known
      type(arma_sums_type) :: sums
      real(dp) :: phi(objective%p), theta(objective%q), jacobian(size(parameter), size(parameter))
      integer :: i, j, k, info

      k = size(parameter)
      known = .not. allocated(objective%cancelled)
      if (.not. known) return
      call begin_evaluation(objective)
      call split_free(parameter, phi, theta, jacobian)
      call sum_innovations(objective%series, phi, theta, parameter(k), sums, known, .true., progress=objective%share, &
         & cancelled=objective%cancelled)
      if (known) known = sums%square > 0.0_dp
      if (.not. known) return
      call information_of(sums, objective%p, objective%q, inverse)
      inverse(:, :) = matmul(transpose(jacobian), matmul(inverse, jacobian))/real(sums%count, dp)
      do i = 1, k
         inverse(i, i) = inverse(i, i)*(1.0_dp + 1.0e-6_dp) + 1.0e-9_dp
      end do
      call dpotrf("U", k, inverse, k, info)
      if (info == 0) call dpotri("U", k, inverse, k, info)
      known = info == 0
      if (.not. known) return
      do j = 1, k
         do i = j + 1, k
            inverse(i, j) = inverse(j, i)
         end do
      end do
   end subroutine start_inverse

end module gyroakf_ar_arma_likelihood
