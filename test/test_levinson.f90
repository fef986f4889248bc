! SPDX-License-Identifier: MIT
!> Tests of the Levinson-Durbin recursion. The reference values were computed in exact arithmetic from
!> the doubles of the series (series_library, 1000 samples each) and rounded once.
module test_levinson
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_lapack, only : dpotrf, dpotrs
   use ar_reference, only : levinson_variance
   use series_library, only : reference_series, reference_names
   use expectations, only : unmet, problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_levinson

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> AR(3) coefficients in the order of reference_names
   real(dp), parameter :: phi_of(3,11) = reshape([ &
      & 0.012345925194632974_dp, -0.01584412015283734_dp, 0.02385164070655572_dp, -0.0184978696160034_dp, &
      & 0.03658613602699694_dp, -0.033603727324382965_dp, -0.02614481184593783_dp, 0.017629267099495832_dp, &
      & -0.0023579621001782593_dp, 1.002088823835466_dp, -0.027502932260171677_dp, 0.01663100336096282_dp, &
      & 0.7105148948294008_dp, -0.02367282280284332_dp, -0.01614759323210208_dp, 0.9948346862638848_dp, &
      & -0.02886316263709849_dp, 0.0039532062938505905_dp, 1.2099053842920002_dp, -0.4974478877526872_dp, &
      & -0.025846586058176486_dp, 0.18084358443280416_dp, 0.14687636405840052_dp, 0.19000692929305024_dp, &
      & 0.7206173233936202_dp, -0.02098507652224861_dp, -0.0062492116470988755_dp, 0.7105148948576095_dp, &
      & -0.023672822843255236_dp, -0.016147593227233116_dp, 0.04617827585169228_dp, 0.01152108790736282_dp, &
      & 0.04339887602981557_dp], [3, 11])

contains

   subroutine suite_levinson()
      call test("closed_form", test_closed_form)
      call test("reference", test_reference)
      call test("direct_solution", test_direct_solution)
      call test("scale", test_scale)
      call test("failures", test_failures)
   end subroutine suite_levinson

   !> The autocovariances phi^k/(1 - phi^2) of AR(1) give back phi, 0, 0 and the variance 1.
   subroutine test_closed_form()
      real(dp), allocatable :: phi(:, :), variance(:)
      integer :: k

      call solve_levinson([(0.6_dp**k/0.64_dp, k = 0, 3)], phi, variance, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(phi(:, 3) - [0.6_dp, 0.0_dp, 0.0_dp])), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(phi(:, 1) - [0.6_dp, 0.0_dp, 0.0_dp])), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(variance - [1.5625_dp, 1.0_dp, 1.0_dp, 1.0_dp])), 0.0_dp, thr=tolerance)
   end subroutine test_closed_form

   !> The eleven series. The random walk's matrix has a condition of 1e3.
   subroutine test_reference()
      real(dp), allocatable :: r(:), phi(:, :), variance(:)
      real(dp) :: mean
      integer :: i

      do i = 1, size(reference_names)
         call compute_autocovariance(reference_series(trim(reference_names(i)), 1000), 6, mean, r, problem)
         call solve_levinson(r, phi, variance, problem)
         if (went_wrong(problem)) return
         call check(error, maxval(abs(phi(:3, 3) - phi_of(:, i))), 0.0_dp, reference_names(i), thr=tolerance)
         call check(error, maxval(abs(variance/levinson_variance(:, i) - 1.0_dp)), 0.0_dp, reference_names(i), thr=tolerance)
      end do
   end subroutine test_reference

   !> The same equations solved as a dense symmetric system.
   subroutine test_direct_solution()
      real(dp), allocatable :: r(:), phi(:, :), variance(:), matrix(:, :), right(:, :)
      real(dp) :: mean
      integer :: i, j, info

      call compute_autocovariance(reference_series("sine", 3000), 25, mean, r, problem)
      call solve_levinson(r, phi, variance, problem)
      if (went_wrong(problem)) return
      matrix = reshape([((r(abs(i - j)), i = 1, 25), j = 1, 25)], [25, 25])
      right = reshape(r(1:25), [25, 1])
      call dpotrf("U", 25, matrix, 25, info)
      if (info == 0) call dpotrs("U", 25, 1, matrix, 25, right, 25, info)
      call check(error, info, 0)
      call check(error, maxval(abs(phi(:, 25) - right(:, 1))), 0.0_dp, thr=tolerance)
      call check(error, variance(25), r(0) - dot_product(r(1:25), right(:, 1)), thr=tolerance)
   end subroutine test_direct_solution

   !> Coefficients do not feel the scale, variances do.
   subroutine test_scale()
      real(dp), parameter :: r(0:3) = [2.0_dp, 1.2_dp, 0.9_dp, 0.1_dp]
      real(dp), allocatable :: phi(:, :), variance(:), phi2(:, :), variance2(:)

      call solve_levinson(r, phi, variance, problem)
      call solve_levinson(1.0e-12_dp*r, phi2, variance2, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(phi - phi2)), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(1.0e12_dp*variance2 - variance)), 0.0_dp, thr=tolerance)
   end subroutine test_scale

   !> No variance; a sequence that is no autocovariance; a perfect sine; order 0 is no failure.
   subroutine test_failures()
      real(dp), allocatable :: phi(:, :), variance(:)

      call solve_levinson([0.0_dp, 0.0_dp], phi, variance, problem)
      call check_refused(problem, status%constant_input)
      call solve_levinson([1.0_dp, 0.5_dp, -0.9_dp], phi, variance, problem)
      call check_refused(problem, status%singular)
      call solve_levinson([1.0_dp, cos(1.0_dp), cos(2.0_dp), cos(3.0_dp)], phi, variance, problem)
      if (unmet(allocated(problem), "a perfect sine was accepted")) return
      call solve_levinson([1.0_dp], phi, variance, problem)
      call check(error, .not. allocated(problem), "order 0 was refused")
   end subroutine test_failures

end module test_levinson
