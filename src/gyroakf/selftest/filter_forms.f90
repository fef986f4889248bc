! SPDX-License-Identifier: MIT
!> What the Kalman filter, its likelihood and its smoother come to by a formula.
module gyroakf_selftest_filter_forms
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter, run_filter
   use gyroakf_filter_likelihood, only : component_likelihood
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_state_space, only : dc_gain
   use gyroakf_selftest_types, only : selftest_type, begin_group, add_check, add_failure
   implicit none (type, external)
   private
   public :: check_filter_forms

   !> Rounding
   real(dp), parameter :: exact = 1.0e-12_dp

contains

   !> All of them.
   subroutine check_filter_forms(result)
      !> The checks are added
      type(selftest_type), intent(inout) :: result

      call begin_group(result, "closed forms of the filters")
      call check_gain(result)
      call check_level(result)
      call check_likelihood(result)
      call check_smoother(result)
      call check_adaptation(result)
   end subroutine check_filter_forms

   !> The gain that the recursion settles to is that of the Riccati equation, and the share of a constant that passes is
   !> $$ K/(1 - \phi(1 - K)) $$
   subroutine check_gain(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: phi = 0.41_dp, q = 0.8_dp, r = 1.3_dp
      type(filter_type) :: filter
      type(error_type), allocatable :: error
      real(dp) :: z(400), x(400), c, prior, gain

      call new_filter(filter, [phi], q, r, filter_options(), error)
      if (allocated(error)) then
         call add_failure(result, "gain of AR(1)", error)
         return
      end if
      z = 1.0_dp
      call run_filter(filter, z, x)
      c = q - r*(1.0_dp - phi**2)
      prior = 0.5_dp*(c + sqrt(c**2 + 4.0_dp*q*r))
      gain = prior/(prior + r)
      call add_check(result, "gain of AR(1), Riccati", gain, filter%gain(1), exact)
      call add_check(result, "variance of its estimate, K R", gain*r, filter%p(1, 1), exact)
      call add_check(result, "constant that passes", gain/(1.0_dp - phi*(1.0_dp - gain)), x(size(x)), exact)
      call add_check(result, "constant that passes, stated", x(size(x)), dc_gain([phi], filter%gain), exact)
   end subroutine check_gain

   !> A random walk in white noise: with s = q/r the gain settles to $$ (\sqrt{s^2 + 4 s} - s)/2 $$
   subroutine check_level(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: q = 0.01_dp, r = 1.0_dp
      type(filter_options) :: options
      type(filter_type) :: filter
      type(error_type), allocatable :: error
      real(dp) :: z(1000), x(1000)

      options%initial_variance = 1.0_dp
      call new_filter(filter, [1.0_dp], q, r, options, error)
      if (allocated(error)) then
         call add_failure(result, "gain of a random walk", error)
         return
      end if
      z = 0.0_dp
      call run_filter(filter, z, x)
      call add_check(result, "gain of a random walk", (sqrt((q/r)**2 + 4.0_dp*q/r) - q/r)/2.0_dp, filter%gain(1), exact)
   end subroutine check_level

   !> The likelihood of two samples of AR(1) in white noise is that of two correlated normal variates.
   subroutine check_likelihood(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: phi = 0.9_dp, q = 0.19_dp, r = 0.5_dp, log_two_pi = 1.83787706640934548_dp
      real(dp), parameter :: z(2) = [0.7_dp, -0.4_dp]
      type(component_model_type) :: model
      type(error_type), allocatable :: error
      real(dp) :: value, a, b, determinant

      model%count = 1
      model%phi(1) = phi
      model%q(1) = q
      model%r = r
      call component_likelihood(model, z, value, error)
      if (allocated(error)) then
         call add_failure(result, "log-likelihood of two samples", error)
         return
      end if
      a = q/(1.0_dp - phi**2) + r
      b = phi*q/(1.0_dp - phi**2)
      determinant = a**2 - b**2
      call add_check(result, "log-likelihood of two samples", -log_two_pi - 0.5_dp*log(determinant) &
                     - 0.5_dp*(a*(z(1)**2 + z(2)**2) - 2.0_dp*b*z(1)*z(2))/determinant, value, exact)
   end subroutine check_likelihood

   !> The smoother of a random walk weighs the samples on either side by $$ \frac{1 - l}{1 + l} l^{|j|}, \quad l = 1 - K $$
   subroutine check_smoother(result)
      type(selftest_type), intent(inout) :: result
      integer, parameter :: n = 801, middle = 401
      real(dp), parameter :: q = 0.09_dp, r = 1.0_dp
      type(component_model_type) :: model
      type(error_type), allocatable :: error
      real(dp) :: z(n), drift(n), variance(n), l

      model%count = 1
      model%phi(1) = 1.0_dp
      model%q(1) = q
      model%r = r
      z = 0.0_dp
      z(middle) = 1.0_dp
      call smooth_drift(model, [.true.], z, drift, error, variance=variance)
      if (allocated(error)) then
         call add_failure(result, "weights of the smoother", error)
         return
      end if
      l = 1.0_dp - (sqrt((q/r)**2 + 4.0_dp*q/r) - q/r)/2.0_dp
      call add_check(result, "weight of the sample itself", (1.0_dp - l)/(1.0_dp + l), drift(middle), exact)
      call add_check(result, "weight of one five later", (1.0_dp - l)/(1.0_dp + l)*l**5, drift(middle - 5), exact)
      call add_check(result, "variance of a smoothed drift", r*(1.0_dp - l)/(1.0_dp + l), variance(middle), exact)
   end subroutine check_smoother

   !> The paper's recursion on Q and R holds for one step by hand: a state without variance, d = 1 - b over 1 - b^(k+1).
   subroutine check_adaptation(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: phi = 0.5_dp, q = 0.3_dp, r = 0.7_dp, p = 0.4_dp, b = 0.98_dp, z = 1.1_dp
      type(filter_options) :: options
      type(filter_type) :: filter
      type(error_type), allocatable :: error
      real(dp) :: x(1), prior, gain, posterior, d

      options%estimate_process_variance = .true.
      options%estimate_measurement_variance = .true.
      options%measurement_form = "paper"
      options%forgetting = b
      options%initial_variance = p
      call new_filter(filter, [phi], q, r, options, error)
      if (allocated(error)) then
         call add_failure(result, "Sage-Husa, one step", error)
         return
      end if
      call run_filter(filter, [z], x)
      prior = phi**2*p + q
      gain = prior/(prior + r)
      posterior = (1.0_dp - gain)*prior
      d = (1.0_dp - b)/(1.0_dp - b**2)
      call add_check(result, "Sage-Husa, one step: state", gain*z, x(1), exact)
      call add_check(result, "Sage-Husa, one step: R", (1.0_dp - d)*r + d*(z**2 - posterior), filter%r, exact)
      call add_check(result, "Sage-Husa, one step: Q", (1.0_dp - d)*q + d*((gain*z)**2 + posterior - phi**2*p), filter%q, exact)
   end subroutine check_adaptation

end module gyroakf_selftest_filter_forms
