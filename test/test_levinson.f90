! SPDX-License-Identifier: MIT
!> Tests of the Levinson-Durbin recursion. The reference values were computed in exact arithmetic from
!> the doubles of the series (series_library, 1000 samples each) and rounded once.
module test_levinson
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_lapack, only : dpotrf, dpotrs
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
   !> Variances of the orders 0 .. 6
   real(dp), parameter :: variance_of(7,11) = reshape([ &
      & 0.9453760778900991_dp, 0.945244636123189_dp, 0.9450158236391153_dp, 0.944478203414682_dp, &
      & 0.939759314616287_dp, 0.9393622941243179_dp, 0.9377301611960575_dp, 1.0397301975483946_dp, &
      & 1.0392926652698529_dp, 1.0378505975164332_dp, 1.03667864573457_dp, 1.0365767244744093_dp, &
      & 1.034028053082314_dp, 1.0317804097456036_dp, 0.08312963072716309_dp, 0.08307055413824795_dp, &
      & 0.08304455538292896_dp, 0.08304409365642461_dp, 0.08296569259471666_dp, 0.08277518592203167_dp, &
      & 0.08275687491786672_dp, 72.61159628555379_dp, 1.2775035381702189_dp, 1.2773534191448062_dp, &
      & 1.2770001156141526_dp, 1.2761701508862233_dp, 1.2737233645860389_dp, 1.2737232701031835_dp, &
      & 1.7894086048059512_dp, 0.9450270570293021_dp, 0.9438591163364932_dp, 0.9436130100109444_dp, &
      & 0.9386184919194541_dp, 0.9382112364427528_dp, 0.933613636336088_dp, 16.21891332408116_dp, &
      & 0.9415475005872656_dp, 0.940962288264314_dp, 0.9409475830562254_dp, 0.939383606282617_dp, &
      & 0.9365212239247913_dp, 0.9356550577996617_dp, 3.6503114641352807_dp, 1.312883891051368_dp, &
      & 0.9453833872548769_dp, 0.9447518276542854_dp, 0.9412534512728729_dp, 0.9412518832222766_dp, &
      & 0.9340045493398246_dp, 1.2764492630401685_dp, 1.1856430713860915_dp, 1.1437260499991837_dp, &
      & 1.1024345279583685_dp, 1.0955046832298097_dp, 1.0685857258539657_dp, 1.0620099244617214_dp, &
      & 1.8860128228558422_dp, 0.9542965217479485_dp, 0.953676508062988_dp, 0.9536392644717196_dp, &
      & 0.9499314747608804_dp, 0.9489919156859964_dp, 0.9455660665304475_dp, 1.7894086047159458e-6_dp, &
      & 9.450270569747811e-7_dp, 9.438591162795538e-7_dp, 9.436130099541682e-7_dp, 9.386184918705444e-7_dp, &
      & 9.382112363936212e-7_dp, 9.336136362832361e-7_dp, 0.9827258362879051_dp, 0.9805170688875565_dp, &
      & 0.9803370250237071_dp, 0.9784905970578951_dp, 0.9749540252584518_dp, 0.9744952051155858_dp, &
      & 0.9719771092344424_dp], [7, 11])

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
         call check(error, maxval(abs(variance/variance_of(:, i) - 1.0_dp)), 0.0_dp, reference_names(i), thr=tolerance)
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
