! SPDX-License-Identifier: MIT
!> Tests of the filter with constant variances: closed forms, dense references, missing samples, failures.
module test_kalman
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan, ieee_positive_inf, ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter, step_filter, run_filter, freeze_filter
   use gyroakf_filter_state_space, only : stationary_covariance
   use filter_library, only : fill_noise, make_series, dense_drift, dense_filter, &
      & dense_likelihood, paper_phi
   use expectations, only : failure => problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_kalman

   !> Two orders of summation of the same numbers
   real(dp), parameter :: rounding = 1.0e-13_dp
   !> A stationary AR(3)
   real(dp), parameter :: phi3(3) = [0.9_dp, -0.5_dp, 0.2_dp]

contains

   subroutine suite_kalman()
      call test("settles_at_closed_form", test_settles)
      call test("steady_gain_same_result", test_steady_switch)
      call test("variance_of_the_output", test_output_variance)
      call test("scalar_and_vector_agree", test_scalar_vector)
      call test("dense_reference", test_dense_reference)
      call test("step_and_run_agree", test_step_run)
      call test("missing_in_every_form", test_missing_forms)
      call test("likelihood_and_mean_dense", test_dense_gaussian)
      call test("scale_invariance", test_scale)
      call test("random_walk", test_random_walk)
      call test("white_model", test_white_model)
      call test("long_gap", test_long_gap)
      call test("million_steps", test_million)
      call test("wrong_arguments", test_wrong_arguments)
      call test("gates", test_gates)
      call test("burn_in_of_many", test_burn_in)
      call test("unstable_model", test_unstable_model)
   end subroutine suite_kalman

   !> A filter with these numbers and default options; fails the test if there is none
   logical function not_made(phi, q, r, filter)
      real(dp), intent(in) :: phi(:), q, r
      type(filter_type), intent(out) :: filter

      call new_filter(filter, phi, q, r, filter_options(), failure)
      not_made = went_wrong(failure, "the filter is not made")
   end function not_made

   subroutine test_settles()
      type(filter_type) :: filter
      real(dp) :: x
      integer :: k

      if (not_made([paper_phi], 1 - paper_phi**2, 1.0_dp, filter)) return
      do k = 1, 50
         call step_filter(filter, 1.0_dp, x)
      end do
      call check(error, filter%settled, "the gain has not settled after 50 steps")
      call check(error, filter%gain(1), 0.4770139142617331_dp, thr=1.0e-12_dp)
      call check(error, x, 0.607205610250273_dp, thr=1.0e-12_dp)
      call check(error, filter%steps, 50_int64)
   end subroutine test_settles

   !> q/r = 1e-6: the gain settles after thousands of steps; the switch to the constant gain may not be seen
   subroutine test_steady_switch()
      type(filter_type) :: filter
      real(dp), parameter :: phi = 0.9999_dp, q = 1.0e-6_dp
      real(dp), allocatable :: z(:), x(:)
      real(dp) :: p, state, k, worst
      integer :: i

      allocate (z(60000), x(60000))
      call make_series(1, phi, q/(1 - phi**2), 1.0_dp, z)
      if (not_made([phi], q, 1.0_dp, filter)) return
      call run_filter(filter, z, x)
      call check(error, filter%settled, "the gain has not settled")
      p = q/(1 - phi**2)
      state = 0
      worst = 0
      do i = 1, size(z)
         p = phi**2*p + q
         k = p/(p + 1)
         p = k
         state = phi*state + k*(z(i) - phi*state)
         worst = max(worst, abs(x(i) - state))
      end do
      call check(error, worst <= 1.0e-12_dp, "the constant gain shows")
   end subroutine test_steady_switch

   !> Table II of the paper: 0.2845 of the variance is left; 200,000 samples give it to 1 % (three sigma)
   subroutine test_output_variance()
      type(filter_type) :: filter
      real(dp), allocatable :: z(:), x(:)

      allocate (z(200000), x(200000))
      call make_series(2, paper_phi, 5.24e-4_dp, 0.0_dp, z)
      if (not_made([paper_phi], 5.24e-4_dp*(1 - paper_phi**2), 5.24e-4_dp, filter)) return
      call run_filter(filter, z, x)
      call check(error, sum(x**2)/sum(z**2), 0.28447912860740027_dp, thr=0.01_dp, rel=.true.)
   end subroutine test_output_variance

   !> The path for one coefficient against the general one: zero coefficients change nothing, with missing samples
   subroutine test_scalar_vector()
      type(filter_type) :: one, three
      real(dp) :: z(2000), x1(2000), x3(2000), nu1(2000), nu3(2000)
      integer(int8) :: valid(2000)
      integer :: k

      call make_series(3, 0.98_dp, 1.0_dp, 4.0_dp, z)
      valid = [(int(merge(0, 1, mod(k*k, 7) == 2 .or. abs(k - 1500) < 100), int8), k=1, 2000)]
      if (not_made([0.98_dp], 0.0396_dp, 4.0_dp, one)) return
      if (not_made([0.98_dp, 0.0_dp, 0.0_dp], 0.0396_dp, 4.0_dp, three)) return
      call run_filter(one, z, x1, valid, nu1)
      call run_filter(three, z, x3, valid, nu3)
      call check(error, maxval(abs(x1 - x3)) <= rounding, "the estimates differ")
      call check(error, maxval(abs(nu1 - nu3)) <= rounding, "the innovations differ")
      call check(error, one%measurements, sum(int(valid, int64)))
      call check(error, three%gain_sum(1), one%gain_sum(1), thr=1.0e-12_dp, rel=.true.)
   end subroutine test_scalar_vector

   !> Order 3 with missing samples against the filter in matrices, Joseph form
   subroutine test_dense_reference()
      type(filter_type) :: filter
      real(dp) :: z(400), x(400), expected(400), gain(3), p0(3, 3)
      integer(int8) :: valid(400)
      integer :: k

      call fill_noise(4, z)
      valid = [(int(merge(0, 1, mod(k, 5) == 0 .or. abs(k - 200) < 20), int8), k=1, 400)]
      if (not_made(phi3, 0.5_dp, 2.0_dp, filter)) return
      call stationary_covariance(phi3, 0.5_dp, p0, failure)
      call dense_filter(phi3, 0.5_dp, 2.0_dp, p0, z, valid == 1_int8, expected, gain)
      call run_filter(filter, z, x, valid)
      call check(error, maxval(abs(x - expected)) <= rounding, "differs from the matrices")
      call check(error, maxval(abs(filter%gain - gain)) <= rounding, "the gain differs from the matrices")
      call check(error,.not. any(abs(filter%p - transpose(filter%p)) > 0), "the covariance is not symmetric")
   end subroutine test_dense_reference

   !> Step by step, and a series in parts, give the numbers of the whole series, to the last bit
   subroutine test_step_run()
      type(filter_type) :: whole, parts, steps
      real(dp) :: z(300), x(300), y(300), s
      integer :: k, order

      call fill_noise(5, z)
      do order = 1, 3, 2
         if (not_made(phi3(:order)/2, 0.5_dp, 2.0_dp, whole)) return
         parts = whole
         steps = whole
         call run_filter(whole, z, x)
         call run_filter(parts, z(:123), y(:123))
         call run_filter(parts, z(124:), y(124:))
         call check(error,.not. any(abs(x - y) > 0), "parts differ from the whole")
         do k = 1, 300
            call step_filter(steps, z(k), s)
            call check(error, s, x(k))
         end do
      end do
   end subroutine test_step_run

   !> NaN, infinite, beyond 1e149 and valid = 0 are one thing: prediction only
   subroutine test_missing_forms()
      type(filter_type) :: filter, other
      real(dp) :: z(60), x(60), y(60), bad(4)
      integer(int8) :: valid(60)
      integer :: i, order

      bad = [ieee_value(1.0_dp, ieee_quiet_nan), ieee_value(1.0_dp, ieee_positive_inf), -1.0e200_dp, 1.0e150_dp]
      do order = 1, 3, 2
         call fill_noise(6, z)
         valid = 1_int8
         valid([7, 20, 21, 50]) = 0_int8
         if (not_made(phi3(:order), 0.5_dp, 2.0_dp, filter)) return
         call run_filter(filter, z, x, valid)
         do i = 1, 4
            z([7, 20, 21, 50]) = bad(i)
            if (not_made(phi3(:order), 0.5_dp, 2.0_dp, other)) return
            call run_filter(other, z, y)
            call check(error,.not. any(abs(x - y) > 0), "a bad value is not a missing one")
         end do
         call check(error, filter%measurements, 56_int64)
      end do
   end subroutine test_missing_forms

   !> N = 50 with samples lost: the likelihood from the innovations, and the last estimate, against the Gaussian
   !> vector of the samples that are there
   subroutine test_dense_gaussian()
      type(component_model_type) :: model
      type(filter_type) :: filter
      real(dp), parameter :: phi = 0.95_dp, d = 2.0_dp, r = 3.0_dp
      real(dp), dimension(50) :: z, mean, variance
      real(dp) :: x, likelihood
      integer :: k
      logical :: here(50)

      call make_series(7, phi, d, r, z)
      here = [(mod(k, 6) /= 0 .and. abs(k - 30) > 3, k=1, 50)]
      model = component_model_type(1, [phi, 0.0_dp, 0.0_dp], [d*(1 - phi**2), 0.0_dp, 0.0_dp], r)
      call dense_drift(model, [.true.], z, here, spread(r, 1, 50), mean, variance)
      if (not_made([phi], d*(1 - phi**2), r, filter)) return
      likelihood = -0.5_dp*count(here)*log(6.283185307179586_dp)
      do k = 1, 50
         call step_filter(filter, merge(z(k), ieee_value(1.0_dp, ieee_quiet_nan), here(k)), x)
         if (here(k)) likelihood = likelihood - 0.5_dp*(log(filter%innovation_variance) &
                                                        + filter%innovation**2/filter%innovation_variance)
      end do
      call check(error, likelihood, dense_likelihood(model, z, here), thr=1.0e-12_dp, rel=.true.)
      call check(error, x, mean(50), thr=1.0e-12_dp)
   end subroutine test_dense_gaussian

   !> A series a thousand times larger, variances a million times: the output a thousand times larger
   subroutine test_scale()
      type(filter_type) :: small, large
      real(dp) :: z(500), x(500), y(500)

      call make_series(8, 0.9_dp, 1.0_dp, 1.0_dp, z)
      if (not_made([0.9_dp], 0.19_dp, 1.0_dp, small)) return
      if (not_made([0.9_dp], 0.19e6_dp, 1.0e6_dp, large)) return
      call run_filter(small, z, x)
      z = 1000*z
      call run_filter(large, z, y)
      call check(error, maxval(abs(y - 1000*x)) <= 1.0e-10_dp, "not proportional")
   end subroutine test_scale

   !> phi = 1 with a diffuse start: the first estimate is the first measurement; the gain of the local level model
   subroutine test_random_walk()
      type(filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: x
      integer :: k

      options%initial_variance = 1.0e8_dp
      call new_filter(filter, [1.0_dp], 0.01_dp, 1.0_dp, options, failure)
      if (went_wrong(failure, "a random walk with a start is a model")) return
      call step_filter(filter, 5.0_dp, x)
      call check(error, x, 5.0_dp, thr=1.0e-7_dp)
      do k = 1, 500
         call step_filter(filter, 5.0_dp, x)
      end do
      call check(error, filter%gain(1), 0.5_dp*(sqrt(0.0401_dp) - 0.01_dp), thr=1.0e-12_dp)
   end subroutine test_random_walk

   !> No coefficients: the series times Q/(Q + R)
   subroutine test_white_model()
      type(filter_type) :: filter
      real(dp) :: z(40), x(40), none(0)

      call fill_noise(9, z)
      if (not_made(none, 3.0_dp, 1.0_dp, filter)) return
      call run_filter(filter, z, x)
      call check(error, maxval(abs(x - 0.75_dp*z)) <= 1.0e-15_dp, "not the scaled series")
   end subroutine test_white_model

   !> A million samples without a measurement: the estimate returns to the mean, its variance to the stationary one
   subroutine test_long_gap()
      type(filter_type) :: filter
      real(dp), allocatable :: z(:), x(:)
      integer(int8), allocatable :: valid(:)

      allocate (z(1000000), x(1000000), valid(1000000))
      z = 1
      valid = 0_int8
      valid(:10) = 1_int8
      if (not_made([0.99_dp], 0.0199_dp, 1.0_dp, filter)) return
      call run_filter(filter, z, x, valid)
      call check(error, x(1000000), 0.0_dp)
      call check(error, filter%p(1, 1), 1.0_dp, thr=1.0e-12_dp)
   end subroutine test_long_gap

   subroutine test_million()
      type(filter_type) :: filter
      real(dp) :: z(1000), x(1000)
      integer :: k

      call fill_noise(10, z)
      if (not_made(phi3, 1.0_dp, 1.0e3_dp, filter)) return
      do k = 1, 1000
         call run_filter(filter, z, x)
      end do
      call check(error, all(ieee_is_finite(x)) .and. filter%settled, "not finite, or never settled")
      call check(error, filter%steps, 1000000_int64)
      call freeze_filter(filter, .true.)
      call check(error, filter%frozen, "not frozen")
   end subroutine test_million

   subroutine test_wrong_arguments()
      call refuse([0.5_dp], -1.0_dp, 1.0_dp, "exact", 0.98_dp, status%invalid_argument)
      call refuse([0.5_dp], 0.0_dp, 0.0_dp, "exact", 0.98_dp, status%invalid_argument)
      call refuse([0.5_dp], 1.0_dp, 1.0_dp, "other", 0.98_dp, status%invalid_argument)
      call refuse([0.5_dp], 1.0_dp, 1.0_dp, "exact", 1.01_dp, status%invalid_argument)
      call refuse([0.5_dp], 1.0_dp, 1.0_dp, "exact", 0.0_dp, status%invalid_argument)
      call refuse([0.5_dp], ieee_value(1.0_dp, ieee_quiet_nan), 1.0_dp, "exact", 0.98_dp, status%non_finite)
      call refuse([ieee_value(1.0_dp, ieee_positive_inf)], 1.0_dp, 1.0_dp, "exact", 0.98_dp, status%non_finite)
   end subroutine test_wrong_arguments

   !> Gates that see nothing, or nothing else
   subroutine test_gates()
      real(dp), parameter :: gate(4) = [-1.0_dp, 1.0e-290_dp, 0.9e-3_dp, 1.1e6_dp]
      type(filter_options) :: options
      type(filter_type) :: filter
      integer :: i

      do i = 1, size(gate)
         options%huber = gate(i)
         call new_filter(filter, phi3, 1.0_dp, 1.0_dp, options, failure)
         call check_refused(failure, status%invalid_argument)
      end do
   end subroutine test_gates

   !> The automatic burn-in of a filter is the same with many coefficients that are zero
   subroutine test_burn_in()
      type(filter_options) :: options
      type(filter_type) :: few, many
      real(dp) :: phi(80)
      integer :: i

      options%burn_in = -1
      do i = 0, 6, 2
         phi = 0
         phi(:3) = [0.9_dp, 0.06_dp, 0.03_dp]
         call new_filter(few, phi(:3), 1.0_dp, 10.0_dp**i, options, failure)
         if (.not. allocated(failure)) call new_filter(many, phi, 1.0_dp, 10.0_dp**i, options, failure)
         if (went_wrong(failure, "a filter is not made")) return
         call check(error, many%wait, few%wait)
      end do
      call check(error, few%wait > 20, "nothing to wait for")
   end subroutine test_burn_in

   subroutine test_unstable_model()
      call refuse([1.0_dp], 1.0_dp, 1.0_dp, "exact", 0.98_dp, status%unstable)
      call refuse([0.5_dp, 0.6_dp], 1.0_dp, 1.0_dp, "exact", 0.98_dp, status%unstable)
   end subroutine test_unstable_model

   !> Fails unless a filter with these numbers is refused with this code
   subroutine refuse(phi, q, r, form, forgetting, code)
      real(dp), intent(in) :: phi(:), q, r, forgetting
      character(*), intent(in) :: form
      integer, intent(in) :: code
      type(filter_options) :: options
      type(filter_type) :: filter

      options%measurement_form = form
      options%forgetting = forgetting
      call new_filter(filter, phi, q, r, options, failure)
      call check_refused(failure, code)
   end subroutine refuse
end module test_kalman
