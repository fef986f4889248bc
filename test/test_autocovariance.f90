! SPDX-License-Identifier: MIT
!> Tests of the lagged sums and of the Levinson-Durbin recursion. The reference values were computed
!> in exact arithmetic from the doubles of the series (series_library, 1000 samples each) and
!> rounded once.
module test_autocovariance
   use expectations, only : unmet, problem, test, error, check, check_refused, went_wrong
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use series_library, only : reference_series, reference_names
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_lapack, only : dpotrf, dpotrs
   use ar_reference, only : levinson_variance
   implicit none (type, external)
   private
   public :: suite_autocovariance, suite_levinson

   !> Relative to r(0)
   real(dp), parameter :: tolerance = 1.0e-13_dp
   !> Lags 0, 1, 2, 7, 20 in the order of reference_names
   integer, parameter :: lag_of(5) = [0, 1, 2, 7, 20]
   real(dp), parameter :: covariance_of(5,11) = reshape([ &
      & 0.9453760778900991_dp, 0.011147282272936418_dp, -0.014575147683015075_dp, -0.07245939813446818_dp, &
      & 0.03464869293241769_dp, 1.0397301975483946_dp, -0.021328748730344068_dp, 0.03915097230847313_dp, &
      & 0.022901100360988_dp, 0.0002183044829195672_dp, 0.08312963072716309_dp, -0.002216081005093361_dp, &
      & 0.001528678919906072_dp, -0.004977028841316011_dp, 0.001983978658242227_dp, 72.61159628555379_dp, &
      & 71.97001003174356_dp, 71.32024436891852_dp, 68.35426827617242_dp, 61.962886770579466_dp, &
      & 1.7894086048059512_dp, 1.2292044611580708_dp, 0.8111590319822368_dp, -0.0927351787863671_dp, &
      & -0.07592490564948848_dp, 16.21891332408116_dp, 15.741101362723237_dp, 15.25389232354208_dp, &
      & 13.03057414911966_dp, 9.203304633151626_dp, 3.6503114641352807_dp, 2.921016717962106_dp, &
      & 1.6428158172176048_dp, -0.8331176759080113_dp, -0.14527636735927965_dp, 1.2764492630401685_dp, &
      & 0.34045483755754_dp, 0.31373807806903087_dp, 0.24856229284595469_dp, 0.340056705101512_dp, &
      & 1.8860128228558422_dp, 1.3256051037746128_dp, 0.9073918914954496_dp, -0.0032677875918178524_dp, &
      & 0.0013689978190547806_dp, 1.7894086047159458e-6_dp, 1.2292044611013289e-6_dp, 8.111590319133136e-7_dp, &
      & -9.2735178768007e-8_dp, -7.592490566753704e-8_dp, 0.9827258362879051_dp, 0.04658983570128766_dp, &
      & 0.015495455537458338_dp, -0.09425301906752617_dp, 0.07265591961360557_dp], [5, 11])
   real(dp), parameter :: rounding = 1.0e-12_dp
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

   subroutine suite_autocovariance()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("direct_sum", test_direct_sum)
      call test("offset_scale", test_offset_scale)
      call test("threads", test_threads)
      call test("missing", test_missing)
      call test("failures", test_failures)
   end subroutine suite_autocovariance

   subroutine suite_levinson()
      call test("closed_form", test_closed_form)
      call test("reference", test_reference_levinson)
      call test("direct_solution", test_direct_solution)
      call test("scale", test_scale)
      call test("failures", test_failures_levinson)
   end subroutine suite_levinson

   !> 1 2 3 4: mean 5/2, r = 5/4, 5/16, -3/8, -9/16.
   subroutine test_by_hand()
      real(dp), allocatable :: r(:)
      real(dp) :: mean

      call compute_autocovariance([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], 3, mean, r, problem)
      if (went_wrong(problem)) return
      call check(error, mean, 2.5_dp, thr=tolerance)
      call check(error, maxval(abs(r - [1.25_dp, 0.3125_dp, -0.375_dp, -0.5625_dp])), 0.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> The eleven series.
   subroutine test_reference()
      real(dp), allocatable :: r(:)
      real(dp) :: mean
      integer :: i

      do i = 1, size(reference_names)
         call compute_autocovariance(reference_series(trim(reference_names(i)), 1000), 20, mean, r, problem)
         if (went_wrong(problem)) return
         call check(error, maxval(abs(r(lag_of) - covariance_of(:, i)))/r(0), 0.0_dp, reference_names(i), thr=tolerance)
      end do
   end subroutine test_reference

   !> Every lag against the plain double loop, lengths around the block, lags beyond a block.
   subroutine test_direct_sum()
      integer, parameter :: length(6) = [9, 300, 4095, 4097, 5000, 12289], lags(6) = [8, 299, 7, 40, 4990, 12]
      real(dp), allocatable :: x(:), r(:)
      real(dp) :: mean, worst
      integer :: i, k

      do i = 1, size(length)
         x = reference_series("ar1_99", length(i))
         call compute_autocovariance(x, lags(i), mean, r, problem)
         if (went_wrong(problem)) return
         x = x - mean
         worst = 0.0_dp
         do k = 0, lags(i), max(1, lags(i)/50)
            worst = max(worst, abs(r(k) - dot_product(x(1 + k:), x(:size(x) - k))/real(size(x), dp)))
         end do
         call check(error, worst/r(0), 0.0_dp, thr=tolerance)
      end do
   end subroutine test_direct_sum

   !> An offset of 2^40 and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024.
   subroutine test_offset_scale()
      real(dp), allocatable :: x(:), r(:), s(:)
      real(dp) :: mean

      x = anint(1024.0_dp*reference_series("ar2", 9000))/1024.0_dp
      call compute_autocovariance(x, 33, mean, r, problem)
      call compute_autocovariance((x + 2.0_dp**40)*2.0_dp**(-50), 33, mean, s, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(s*2.0_dp**100 - r))/r(0), 0.0_dp, thr=tolerance)
   end subroutine test_offset_scale

   !> One and two threads give the same bits.
   subroutine test_threads()
      real(dp), allocatable :: x(:), r(:), s(:)
      real(dp) :: mean
      integer :: before

      x = reference_series("ar1", 70000)
      before = thread_count()
      call set_thread_count(1)
      call compute_autocovariance(x, 20, mean, r, problem)
      call set_thread_count(2)
      call compute_autocovariance(x, 20, mean, s, problem)
      call set_thread_count(before)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(r - s)), 0.0_dp, thr=tiny(mean))
   end subroutine test_threads

   !> Missing samples: the definition by the double loop; their values do not matter; an all-present
   !> mask changes nothing.
   subroutine test_missing()
      real(dp), allocatable :: x(:), r(:), s(:)
      integer(int8), allocatable :: valid(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean, worst
      integer :: k

      x = reference_series("ar1", 9001)
      allocate (valid(size(x)), source=1_int8)
      call compute_autocovariance(x, 11, mean, r, problem)
      call compute_autocovariance(x, 11, mean, s, problem, valid)
      call check(error, maxval(abs(r - s)), 0.0_dp, thr=tolerance)
      valid(1:9001:13) = 0_int8
      valid(4090:4110) = 0_int8
      where (valid == 0_int8) x = 1.0e6_dp
      call compute_autocovariance(x, 11, mean, r, problem, valid, pairs)
      call check(error, mean, sum(x, mask=valid == 1_int8)/real(count(valid == 1_int8), dp), thr=tolerance)
      x = merge(x - mean, 0.0_dp, valid == 1_int8)
      worst = 0.0_dp
      do k = 0, 11
         worst = max(worst, abs(r(k) - direct(x, valid, k)))
         if (unmet(int(pairs(k)), count(valid(1 + k:) == 1_int8 .and. valid(:size(x) - k) == 1_int8))) return
      end do
      call check(error, worst/r(0), 0.0_dp, thr=tolerance)
   end subroutine test_missing

   !> The definition with gaps.
   pure real(dp) function direct(x, valid, k)
      !> Series, its mean removed
      real(dp), intent(in) :: x(:)
      integer(int8), intent(in) :: valid(:)
      integer, intent(in) :: k
      real(dp) :: n, m

      n = real(size(x), dp)
      m = real(count(valid(1 + k:) == 1_int8 .and. valid(:size(x) - k) == 1_int8), dp)
      direct = dot_product(x(1 + k:), x(:size(x) - k))/m*((n - real(k, dp))/n)
   end function direct

   !> Each error.
   subroutine test_failures()
      real(dp), allocatable :: r(:)
      integer(int8) :: valid(4)
      real(dp) :: x(4), mean

      x = [1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp]
      valid = 0_int8
      call compute_autocovariance(x, -1, mean, r, problem)
      call check_refused(problem, status%invalid_argument)
      call compute_autocovariance(x, 4, mean, r, problem)
      call check_refused(problem, status%too_few_samples)
      call compute_autocovariance(x, 1, mean, r, problem, valid(:3))
      call check_refused(problem, status%invalid_argument)
      call compute_autocovariance(x, 1, mean, r, problem, valid)
      call check_refused(problem, status%too_few_samples)
   end subroutine test_failures

   !> The autocovariances phi^k/(1 - phi^2) of AR(1) give back phi, 0, 0 and the variance 1.
   subroutine test_closed_form()
      real(dp), allocatable :: phi(:, :), variance(:)
      integer :: k

      call solve_levinson([(0.6_dp**k/0.64_dp, k = 0, 3)], phi, variance, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(phi(:, 3) - [0.6_dp, 0.0_dp, 0.0_dp])), 0.0_dp, thr=rounding)
      call check(error, maxval(abs(phi(:, 1) - [0.6_dp, 0.0_dp, 0.0_dp])), 0.0_dp, thr=rounding)
      call check(error, maxval(abs(variance - [1.5625_dp, 1.0_dp, 1.0_dp, 1.0_dp])), 0.0_dp, &
         & thr=rounding)
   end subroutine test_closed_form

   !> The eleven series. The random walk's matrix has a condition of 1e3.
   subroutine test_reference_levinson()
      real(dp), allocatable :: r(:), phi(:, :), variance(:)
      real(dp) :: mean
      integer :: i

      do i = 1, size(reference_names)
         call compute_autocovariance(reference_series(trim(reference_names(i)), 1000), 6, mean, r, problem)
         call solve_levinson(r, phi, variance, problem)
         if (went_wrong(problem)) return
         call check(error, maxval(abs(phi(:3, 3) - phi_of(:, i))), 0.0_dp, reference_names(i), &
            & thr=rounding)
         call check(error, maxval(abs(variance/levinson_variance(:, i) - 1.0_dp)), 0.0_dp, &
            & reference_names(i), thr=rounding)
      end do
   end subroutine test_reference_levinson

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
      call check(error, maxval(abs(phi(:, 25) - right(:, 1))), 0.0_dp, thr=rounding)
      call check(error, variance(25), r(0) - dot_product(r(1:25), right(:, 1)), thr=rounding)
   end subroutine test_direct_solution

   !> Coefficients do not feel the scale, variances do.
   subroutine test_scale()
      real(dp), parameter :: r(0:3) = [2.0_dp, 1.2_dp, 0.9_dp, 0.1_dp]
      real(dp), allocatable :: phi(:, :), variance(:), phi2(:, :), variance2(:)

      call solve_levinson(r, phi, variance, problem)
      call solve_levinson(1.0e-12_dp*r, phi2, variance2, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(phi - phi2)), 0.0_dp, thr=rounding)
      call check(error, maxval(abs(1.0e12_dp*variance2 - variance)), 0.0_dp, thr=rounding)
   end subroutine test_scale

   !> No variance; a sequence that is no autocovariance; a perfect sine; order 0 is no failure.
   subroutine test_failures_levinson()
      real(dp), allocatable :: phi(:, :), variance(:)

      call solve_levinson([0.0_dp, 0.0_dp], phi, variance, problem)
      call check_refused(problem, status%constant_input)
      call solve_levinson([1.0_dp, 0.5_dp, -0.9_dp], phi, variance, problem)
      call check_refused(problem, status%singular)
      call solve_levinson([1.0_dp, cos(1.0_dp), cos(2.0_dp), cos(3.0_dp)], phi, variance, problem)
      if (unmet(allocated(problem), "a perfect sine was accepted")) return
      call solve_levinson([1.0_dp], phi, variance, problem)
      call check(error, .not. allocated(problem), "order 0 was refused")
   end subroutine test_failures_levinson

end module test_autocovariance
