! SPDX-License-Identifier: MIT
!> Tests of the analytic covariance of Allan variances, against the sum over every lag in quadruple
!> precision, and of the five noise terms, against numbers from the literature.
module test_allan_covariance
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: iso_fortran_env, only : qp => real128
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_fit_covariance, only : covariance_basis, mixture_covariances, mixture_freedom
   use expectations, only : test, error, check
   use gyroakf_allan_noise_model, only : model_variance
   implicit none (type, external)
   private
   public :: suite_allan_covariance, suite_allan_noise_model

   !> Samples, factors
   integer(int64), parameter :: samples = 200, factors(5) = [1, 3, 16, 60, 100]
   !> What the quadrature may miss, of the product of the standard deviations
   real(dp), parameter :: quadrature = 0.005_dp

contains

   subroutine suite_allan_covariance()
      call test("full_sums", test_full_sums)
      call test("known_freedom", test_known_freedom)
      call test("huge_record", test_huge_record)
   end subroutine suite_allan_covariance

   subroutine suite_allan_noise_model()
      call test("terms", test_terms)
   end subroutine suite_allan_noise_model

   !> Fails unless the matrix agrees with the full sums.
   subroutine compare(squares, allowed)
      !> Q^2 N^2 B^2 K^2 R^2
      real(dp), intent(in) :: squares(5)
      !> Largest difference of a correlation
      real(dp), intent(in) :: allowed

      real(dp) :: found(5, 5), full(5, 5), difference
      integer :: i, j
      character(80) :: text

      found = mixture_covariances(covariance_basis(samples, factors), squares)
      do j = 1, 5
         do i = 1, 5
            if (i <= j) full(i, j) = full_sum(factors(i), factors(j), squares)
            if (i > j) full(i, j) = found(j, i)
         end do
      end do
      do j = 1, 5
         do i = 1, 5
            difference = (found(i, j) - full(i, j))/sqrt(full(i, i)*full(j, j))
            write (text, '("factors ", i0, " and ", i0, " differ by ", es10.2)') factors(i), factors(j), difference
            call check(error, abs(difference) <= allowed, trim(text))
         end do
      end do
   end subroutine compare

   !> The covariance as the sum over all pairs of terms.
   pure real(dp) function full_sum(m, n, squares)
      integer(int64), intent(in) :: m, n
      real(dp), intent(in) :: squares(5)
      integer, parameter :: c(0:2) = [1, -2, 1]
      integer(int64) :: lag, terms_m, terms_n, pairs
      integer :: a, b
      real(qp) :: r, total

      terms_m = samples - 2*m + 1
      terms_n = samples - 2*n + 1
      total = 0
      do lag = 1 - terms_m, terms_n - 1
         pairs = min(terms_m, terms_n - lag) - max(0_int64, -lag)
         r = 0
         do b = 0, 2
            do a = 0, 2
               r = r + c(a)*c(b)*autocovariance(abs(lag + b*n - a*m), squares)
            end do
         end do
         total = total + pairs*(2*r**2 + 4*squares(5)*real(m*n, qp)**2*r)
      end do
      full_sum = real(total/(4*real(m*n, qp)**2*terms_m*terms_n), dp)
   end function full_sum

   !> Generalised autocovariance of the phase.
   pure real(qp) function autocovariance(lag, squares)
      integer(int64), intent(in) :: lag
      real(dp), intent(in) :: squares(5)
      real(qp), parameter :: two_pi = 6.28318530717958647692528676655900577_qp
      real(qp) :: t

      t = real(lag, qp)
      autocovariance = -squares(2)*t/2 + squares(4)*t**3/12
      if (lag == 0) autocovariance = squares(1)
      if (lag > 0 .and. squares(3) > 0) autocovariance = autocovariance + squares(3)/two_pi*t**2*log(t)
   end function autocovariance

   !> Each term alone, but for the ramp, and mixtures.
   subroutine test_full_sums()
      call compare([2.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 1.0e-13_dp)
      call compare([0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], quadrature)
      call compare([0.0_dp, 0.0_dp, 3.0_dp, 0.0_dp, 0.0_dp], quadrature)
      call compare([0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp], quadrature)
      call compare([1.0_dp, 1.0_dp, 0.1_dp, 0.01_dp, 0.0_dp], quadrature)
      ! the ramp's own mean meets the noise: terms of both kinds weigh about the same
      call compare([0.5_dp, 1.0_dp, 0.01_dp, 1.0e-4_dp, 1.0e-4_dp], quadrature)
   end subroutine test_full_sums

   subroutine test_known_freedom()
      ! white rate noise: edf = (3 n/(2 m) - 2 (n - 1)/(n + 1)) 4 m^2/(4 m^2 + 5), NIST SP 1065, table 5, an approximation
      ! to about 1 %; a single term has one degree of freedom
      integer(int64), parameter :: n = 100000, m(3) = [1_int64, 10_int64, 1000_int64]
      real(dp), parameter :: white(5) = [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      real(dp) :: edf(1), expected
      integer :: i

      do i = 1, 3
         edf = mixture_freedom(n, m(i:i), white)
         expected = (1.5_dp*n/m(i) - 2*real(n - 1, dp)/(n + 1))*4*m(i)**2/(4*m(i)**2 + 5.0_dp)
         call check(error, edf(1), expected, thr=0.01_dp, rel=.true.)
      end do
      edf = mixture_freedom(100_int64, [50_int64], white)
      call check(error, edf(1), 1.0_dp, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_known_freedom

   subroutine test_huge_record()
      ! no cancellation between factors that are far apart
      integer(int64), parameter :: n = 10_int64**15, m(3) = [1_int64, 10_int64**7, 10_int64**14]
      real(dp), parameter :: mixture(5) = [1.0_dp, 1.0_dp, 1.0e-3_dp, 1.0e-9_dp, 1.0e-20_dp]
      real(dp) :: found(3, 3), correlation
      integer :: i, j

      found = mixture_covariances(covariance_basis(n, m), mixture)
      do j = 1, 3
         do i = 1, 3
            call check(error, ieee_is_finite(found(i, j)))
            correlation = found(i, j)/sqrt(found(i, i)*found(j, j))
            call check(error, abs(correlation) < merge(1.0000001_dp, 0.5_dp, i == j), "a correlation is too large")
         end do
      end do
   end subroutine test_huge_record

   subroutine test_terms()
      ! IEEE Std 952, annex C, at tau = 4: 3 Q^2/tau^2, N^2/tau, (2 ln 2/pi) B^2 with sqrt(2 ln 2/pi) = 0.664282...,
      ! K^2 tau/3, R^2 tau^2/2
      real(dp), parameter :: expected(5) = [0.1875_dp, 0.25_dp, 0.44127120030530298_dp, 4.0_dp/3, 8.0_dp]
      real(dp) :: squares(5)
      integer :: i

      do i = 1, 5
         squares = 0
         squares(i) = 1
         call check(error, model_variance(squares, 4.0_dp), expected(i), thr=1.0e-14_dp, rel=.true.)
      end do
   end subroutine test_terms

end module test_allan_covariance
