! SPDX-License-Identifier: MIT
!> Tests of the five terms against numbers from the literature: what the fit and its tests take for granted.
module test_allan_noise_model
   use, intrinsic :: iso_fortran_env, only : real128
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : model_variance, noise_model_type, term_markov
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_noise_model

contains

   !> The tests of this suite.
   subroutine collect_allan_noise_model(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      allocate (testsuite(3))
      testsuite(1) = new_unittest("terms", test_terms)
      testsuite(2) = new_unittest("bias_of_logarithm", test_bias_of_logarithm)
      testsuite(3) = new_unittest("markov", test_markov)
   end subroutine collect_allan_noise_model

   subroutine test_terms(error)
      type(error_type), allocatable, intent(out) :: error

      ! IEEE Std 952, annex C, at tau = 4: 3 Q^2/tau^2, N^2/tau, (2 ln 2/pi) B^2 with sqrt(2 ln 2/pi) = 0.664282...,
      ! K^2 tau/3, R^2 tau^2/2
      real(dp), parameter :: expected(5) = [0.1875_dp, 0.25_dp, 0.44127120030530298_dp, 4.0_dp/3, 8.0_dp]
      real(dp) :: squares(5)
      integer :: i

      do i = 1, 5
         squares = 0
         squares(i) = 1
         call check(error, model_variance(squares, 4.0_dp), expected(i), thr=1.0e-14_dp, rel=.true.)
         if (allocated(error)) return
      end do
   end subroutine test_terms

   !> The sampled Markov process by Zhang's formula in quadruple precision, whose terms cancel for long correlation times; on both
   !> sides of the places where the library changes to series.
   subroutine test_markov(error)
      type(error_type), allocatable, intent(out) :: error

      integer, parameter :: qp = real128
      real(dp), parameter :: times(5) = [0.7_dp, 30.0_dp, 49.0_dp, 51.0_dp, 1000.0_dp]
      real(dp), parameter :: m(5) = [1.0_dp, 7.0_dp, 24.0_dp, 26.0_dp, 5000.0_dp]
      real(dp), parameter :: tolerance = 2.0e-12_dp         ! roundings of terms 2000 times as large as what is left of them
      type(noise_model_type) :: model
      real(qp) :: p, n, expected
      integer :: i, j

      model%squares(term_markov) = 1
      do i = 1, size(times)
         model%correlation_time = times(i)
         p = exp(-1/real(times(i), qp))
         do j = 1, size(m)
            n = real(m(j), qp)
            expected = (n*(1 - p**2) - p*(3 - 4*p**nint(m(j)) + p**nint(2*m(j))))/(n**2*(1 - p)**2)
            call check(error, model_variance(model, m(j)), real(expected, dp), thr=tolerance, rel=.true.)
            if (allocated(error)) return
         end do
      end do
   end subroutine test_markov

   subroutine test_bias_of_logarithm(error)
      type(error_type), allocatable, intent(out) :: error

      ! n = 2m leaves one term, chi-square of one degree of freedom, whose logarithm is psi(1/2) - ln(1/2) =
      ! -gamma - ln 2 = -1.27036... on the average: the fit of logarithms gives N^2 = sigma^2 tau exp(1.27036...)
      real(dp), parameter :: bias = -1.2703628454614782_dp
      integer(int64), parameter :: m = 512
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure

      curve%samples = 2*m
      curve%sample_interval = 1
      curve%m = [m]
      curve%terms = [1_int64]
      curve%tau = [real(m, dp)]
      curve%deviation = [0.1_dp]
      curve%edf = [1.0_dp]
      curve%lower = curve%deviation
      curve%upper = curve%deviation
      options%terms = "N"
      call fit_noise(curve, options, noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      call check(error, noise%coefficient(2)%value, sqrt(0.01_dp*m*exp(-bias)), thr=1.0e-9_dp, rel=.true.)
   end subroutine test_bias_of_logarithm

end module test_allan_noise_model
