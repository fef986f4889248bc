! SPDX-License-Identifier: MIT
!> Tests of the AR(p) state space: closed forms, dense matrices, failures.
module test_state_space
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_filter_state_space, only : predict_covariance, correct_covariance, &
      stationary_covariance, dc_gain, output_variance_ratio
   use gyroakf_filter_steady_gain, only : steady_state
   use filter_library, only : companion_matrix, paper_phi
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_state_space

   !> Closed forms to their last digits
   real(dp), parameter :: exact = 1.0e-12_dp
   !> A stationary AR(3) with a pair of complex roots
   real(dp), parameter :: phi3(3) = [0.9_dp, -0.5_dp, 0.2_dp]

contains

   subroutine suite_state_space()
      call test("closed_form_equal_noise", test_equal_noise)
      call test("closed_form_small_gain", test_small_gain)
      call test("slow_drift_keeps_its_digits", test_slow_drift)
      call test("padded_orders_agree", test_padded)
      call test("many_coefficients", test_many)
      call test("steady_state_is_a_fixed_point", test_fixed_point)
      call test("no_measurement_noise", test_no_noise)
      call test("lost_noise", test_lost_noise)
      call test("stationary_covariance", test_lyapunov)
      call test("shift_structure", test_shift)
      call test("dc_gain_of_a_step", test_step_response)
      call test("variance_ratio_iterated", test_ratio_iterated)
      call test("not_stationary", test_unstable)
   end subroutine suite_state_space

   !> R = Var(z): values of the closed forms at phi = 0.409975, computed with 50 digits
   subroutine test_equal_noise()
      real(dp) :: phi(1), gain(1), prior(1, 1), ratio

      phi = paper_phi
      call steady_state(phi, 1 - phi(1)**2, 1.0_dp, gain, prior, failure)
      call check(error, gain(1), 0.4770139142617331_dp, thr=exact)
      call check(error, dc_gain(phi, gain), 0.607205610250273_dp, thr=exact)
      call output_variance_ratio(phi, gain, ratio, failure)
      call check(error, ratio, 0.28447912860740027_dp, thr=exact)
   end subroutine test_equal_noise

   !> R = 9.839 Var(z), the gain that gives the paper's Table II; its R is known to nine digits, the gain to all:
   !> the R that gives this gain exactly is found from the Riccati equation
   subroutine test_small_gain()
      real(dp), parameter :: k = 0.09074925663875474_dp
      real(dp) :: phi(1), gain(1), prior(1, 1), ratio, q, r

      phi = paper_phi
      q = 1 - phi(1)**2
      r = q*(1 - k)/(k*(1 - phi(1)**2*(1 - k)))
      call check(error, r, 9.83897838_dp, thr=5.0e-9_dp)
      call steady_state(phi, q, r, gain, prior, failure)
      call check(error, gain(1), k, thr=exact)
      call check(error, dc_gain(phi, gain), 0.14468260012165263_dp, thr=exact)
      call output_variance_ratio(phi, gain, ratio, failure)
      call check(error, ratio, 0.013015267175572514_dp, thr=exact)
   end subroutine test_small_gain

   !> P- (P- + r)^-1 solves its quadratic equation also where q is 1e-12 of r
   subroutine test_slow_drift()
      real(dp) :: phi(1), gain(1), prior(1, 1), p

      phi = 1
      call steady_state(phi, 1.0e-12_dp, 1.0_dp, gain, prior, failure)
      p = prior(1, 1)
      call check(error, p*p/(p + 1), 1.0e-12_dp, thr=1.0e-14_dp, rel=.true.)
      call check(error, gain(1), 0.5e-6_dp*(sqrt(4 + 1.0e-12_dp) - 1.0e-6_dp), thr=1.0e-14_dp, rel=.true.)
   end subroutine test_slow_drift

   !> The doubling iteration against the closed form: zero coefficients change nothing
   subroutine test_padded()
      real(dp) :: one(1), gain1(1), prior1(1, 1), ratio1, four(4), gain4(4), prior4(4, 4), ratio4
      integer :: i

      one = 0.98_dp
      four = [0.98_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      do i = -6, 6, 2
         call steady_state(one, 10.0_dp**i, 1.0_dp, gain1, prior1, failure)
         call steady_state(four, 10.0_dp**i, 1.0_dp, gain4, prior4, failure)
         if (went_wrong(failure, "the doubling iteration fails")) return
         call check(error, gain4(1), gain1(1), thr=exact, rel=.true.)
         call check(error, dc_gain(four, gain4), dc_gain(one, gain1), thr=exact, rel=.true.)
         call output_variance_ratio(one, gain1, ratio1, failure)
         call output_variance_ratio(four, gain4, ratio4, failure)
         call check(error, ratio4, ratio1, thr=1.0e-11_dp, rel=.true.)
      end do
   end subroutine test_padded

   !> The recursion for many coefficients against the closed form of one and the doubling of three; poles
   !> near the unit circle and beyond it
   subroutine test_many()
      real(dp), parameter :: pole(4) = [0.4_dp, -0.98_dp, 0.9999999_dp, 1.01_dp]
      real(dp) :: one(1), gain1(1), prior1(1, 1), gain3(3), prior3(3, 3), many(60), gain(60), prior(60, 60)
      integer :: i, k

      do i = -6, 6, 2
         do k = 1, size(pole)
            one = pole(k)
            many = 0
            many(1) = pole(k)
            call steady_state(one, 10.0_dp**i, 1.0_dp, gain1, prior1, failure)
            call steady_state(many, 10.0_dp**i, 1.0_dp, gain, prior, failure)
            if (went_wrong(failure, "the gain of many coefficients is not found")) return
            call check(error, gain(1), gain1(1), thr=1.0e-12_dp, rel=.true.)
         end do
         many = 0
         many(:3) = phi3
         call steady_state(phi3, 10.0_dp**i, 1.0_dp, gain3, prior3, failure)
         call steady_state(many, 10.0_dp**i, 1.0_dp, gain, prior, failure)
         call check(error, maxval(abs(gain(:3) - gain3)) <= 1.0e-12_dp*maxval(abs(gain3)), "gain as of three coefficients")
         call check(error, maxval(abs(prior(:3, :3) - prior3)) <= 1.0e-12_dp*maxval(abs(prior3)), "covariance as of three")
      end do
   end subroutine test_many

   !> One step of the recursion leaves the solution where it is; order 3, r over nine decades
   subroutine test_fixed_point()
      real(dp) :: gain(3), prior(3, 3), p(3, 3), work(3), s, r
      integer :: i

      do i = -3, 6
         r = 10.0_dp**i
         call steady_state(phi3, 1.0_dp, r, gain, prior, failure)
         if (went_wrong(failure, "the Riccati equation is not solved")) return
         p = prior
         call correct_covariance(r, p, gain, s)
         call predict_covariance(phi3, 1.0_dp, p, work)
         call check(error, maxval(abs(p - prior)) <= 1.0e-13_dp*maxval(abs(prior)), "not a fixed point")
      end do
   end subroutine test_fixed_point

   !> A variance r that is lost beside q is as none, of any order, and at once; from one that is not the solution goes over to it.
   subroutine test_lost_noise()
      real(dp), parameter :: r(4) = [tiny(1.0_dp)*epsilon(1.0_dp), 1.0e-300_dp, 1.0e-20_dp, 1.0e-16_dp]
      real(dp) :: gain3(3), prior3(3, 3)
      real(dp), allocatable :: many(:), gain(:), prior(:, :)
      integer :: k

      do k = 1, size(r)
         call steady_state(phi3, 2.0_dp, r(k), gain3, prior3, failure)
         if (went_wrong(failure, "three coefficients")) return
         call check(error, prior3(1, 1), 2.0_dp, thr=1.0e-14_dp)
         call check(error, abs(gain3(1) - 1.0_dp) + sum(abs(gain3(2:))) <= 1.0e-15_dp, "the gain is not 1")
      end do
      allocate (many(900), source=0.0_dp)
      allocate (gain(900), prior(900, 900))
      many(1) = 0.5_dp
      many(900) = 0.4999_dp
      call steady_state(many, 2.0_dp, r(1), gain, prior, failure)
      if (went_wrong(failure, "900 coefficients")) return
      call check(error, gain(1), 1.0_dp, thr=1.0e-15_dp)
   end subroutine test_lost_noise

   !> r = 0: the state is measured, the gain is 1, only the last driving noise is unknown
   subroutine test_no_noise()
      real(dp) :: gain(3), prior(3, 3), ratio

      call steady_state(phi3, 2.0_dp, 0.0_dp, gain, prior, failure)
      call check(error, gain(1), 1.0_dp)
      call check(error, sum(abs(prior)), 2.0_dp)
      call output_variance_ratio(phi3, gain, ratio, failure)
      call check(error, ratio, 1.0_dp, thr=exact)
   end subroutine test_no_noise

   !> P = Phi P Phi' + q e1 e1', in dense matrices
   subroutine test_lyapunov()
      real(dp), parameter :: phi(4) = [1.2_dp, -0.5_dp, 0.3_dp, -0.1_dp]
      real(dp) :: p(4, 4), a(4, 4), again(4, 4), one(1, 1)

      call stationary_covariance(phi, 0.7_dp, p, failure)
      a = companion_matrix(phi)
      again = matmul(a, matmul(p, transpose(a)))
      again(1, 1) = again(1, 1) + 0.7_dp
      call check(error, maxval(abs(again - p)) <= 1.0e-14_dp*p(1, 1), "the Lyapunov equation is not met")
      call stationary_covariance([0.6_dp], 1.0_dp, one, failure)
      call check(error, one(1, 1), 1/0.64_dp, thr=exact)
   end subroutine test_lyapunov

   !> Prediction and correction in O(p^2) against matrix products
   subroutine test_shift()
      real(dp), parameter :: phi(4) = [1.2_dp, -0.5_dp, 0.3_dp, -0.1_dp]
      real(dp) :: p(4, 4), a(4, 4), dense(4, 4), work(4), gain(4), s
      integer :: i, j

      do j = 1, 4
         do i = 1, 4
            p(i, j) = 1/real(i + j - 1, dp)
         end do
      end do
      a = companion_matrix(phi)
      dense = matmul(a, matmul(p, transpose(a)))
      dense(1, 1) = dense(1, 1) + 0.3_dp
      call predict_covariance(phi, 0.3_dp, p, work)
      call check(error, maxval(abs(p - dense)) <= 1.0e-15_dp, "prediction differs from the matrices")
      dense = dense - matmul(dense(:, 1:1), dense(1:1, :))/(dense(1, 1) + 0.4_dp)
      call correct_covariance(0.4_dp, p, gain, s)
      call check(error, maxval(abs(p - dense)) <= 1.0e-15_dp, "correction differs from the matrices")
      call check(error,.not. any(abs(p - transpose(p)) > 0), "not symmetric")
   end subroutine test_shift

   !> The estimate of a constant series settles at the DC gain
   subroutine test_step_response()
      real(dp) :: gain(3), prior(3, 3), x(3), first
      integer :: k

      call steady_state(phi3, 1.0_dp, 5.0_dp, gain, prior, failure)
      x = 0
      do k = 1, 1000
         first = dot_product(phi3, x)
         x(2:3) = x(1:2)
         x(1) = first
         x = x + gain*(1 - first)
      end do
      call check(error, dc_gain(phi3, gain), x(1), thr=exact)
   end subroutine test_step_response

   !> The doubling of the Lyapunov equation against its plain sum over 2000 steps
   subroutine test_ratio_iterated()
      real(dp) :: gain(3), prior(3, 3), ratio, a(6, 6), step(6), output, input
      integer :: i, k

      call steady_state(phi3, 1.0_dp, 5.0_dp, gain, prior, failure)
      call output_variance_ratio(phi3, gain, ratio, failure)
      a = 0
      a(:3, :3) = companion_matrix(phi3)
      a(4:, 4:) = companion_matrix(phi3)
      do i = 1, 3
         a(3 + i, :3) = gain(i)*phi3
         a(3 + i, 4:) = a(3 + i, 4:) - gain(i)*phi3
      end do
      step = [1.0_dp, 0.0_dp, 0.0_dp, gain]
      output = 0
      input = 0
      do k = 1, 2000
         input = input + step(1)**2
         output = output + step(4)**2
         step = matmul(a, step)
      end do
      call check(error, ratio, output/input, thr=exact)
   end subroutine test_ratio_iterated

   subroutine test_unstable()
      real(dp) :: p1(1, 1), p2(2, 2), ratio

      call stationary_covariance([1.0_dp], 1.0_dp, p1, failure)
      call check_refused(failure, status%unstable)
      call stationary_covariance([0.6_dp, 0.5_dp], 1.0_dp, p2, failure)
      if (unmet(allocated(failure), "phi_1 + phi_2 > 1 is not stationary")) return
      call output_variance_ratio([1.5_dp, 0.1_dp], [0.1_dp, 0.0_dp], ratio, failure)
      call check(error, allocated(failure), "an exploding series has no variance")
   end subroutine test_unstable
end module test_state_space
