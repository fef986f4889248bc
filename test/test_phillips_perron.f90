! SPDX-License-Identifier: MIT
!> Tests of the Phillips-Perron test. The statistics were computed with 60 digits from the doubles of the series
!> (series_library, 1000 samples each, 22 lags) and rounded once; arch 8.0 agrees to 1e-11 where the mean is small.
module test_phillips_perron
   use expectations, only : check_refused
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_series_phillips_perron, only : phillips_perron_options, phillips_perron_type, pp_of => test_phillips_perron
   use gyroakf_series_mackinnon, only : p_value
   use series_library, only : reference_series, reference_names
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_phillips_perron

   real(dp), parameter :: tolerance = 1.0e-12_dp
   character(2), parameter :: regression(3) = ["n ", "c ", "ct"]
   !> Z_tau by series and regression n, c, ct
   real(dp), parameter :: tau_of(11, 3) = reshape([ &
      & -31.505612231950717_dp, -32.255761156432015_dp, -18.433438372346753_dp, -0.010220046699390709_dp, &
      & -12.655872040737195_dp, -3.1255425775150294_dp, -7.834770451925841_dp, -4.27152431273781_dp, &
      & -11.209301983923122_dp, 0.035129907924649977_dp, -30.426148588582542_dp, -31.554637678298924_dp, &
      & -32.251749824100095_dp, -32.49247488193833_dp, -1.5242732879586296_dp, -12.628039528472215_dp, &
      & -3.8268400691055344_dp, -7.818527573846078_dp, -33.71378185441382_dp, -12.795128445587_dp, -12.628039528370314_dp, &
      & -30.474978102027393_dp, -31.538832441041112_dp, -32.36032509182861_dp, -32.47749663904538_dp, &
      & -3.002242456372138_dp, -12.617407692776_dp, -3.8773033512082278_dp, -7.808794022488778_dp, -31.538832441041112_dp, &
      & -12.677184532112456_dp, -12.617407692678874_dp, -30.462230448977916_dp], [11, 3])
   !> Z_rho
   real(dp), parameter :: rho_of(11, 3) = reshape([ &
      & -857.0996663613168_dp, -984.751837775543_dp, -643.3256389199009_dp, -0.018119799686745573_dp, &
      & -260.8582532478872_dp, -19.392303090901247_dp, -98.63227266153416_dp, -35.62041533474044_dp, &
      & -233.84772696758492_dp, 4.478313360506314e-08_dp, -787.767127552381_dp, -850.9517141420839_dp, &
      & -982.7641533774098_dp, -981.3361713387976_dp, -4.973146499785338_dp, -259.1535594445641_dp, -28.840573646750556_dp, &
      & -98.18903189213131_dp, -1962.5741719561208_dp, -275.40868779528574_dp, -259.15355944009644_dp, &
      & -782.252957294485_dp, -850.6237169734202_dp, -965.2654295030746_dp, -981.2143618152157_dp, -17.975488817558386_dp, &
      & -258.9791137992743_dp, -29.813239230358594_dp, -98.11918468324203_dp, -850.6237169734202_dp, -263.7780926362123_dp, &
      & -258.97911379512317_dp, -781.7198659960184_dp], [11, 3])

contains

   !> The tests of this suite.
   subroutine collect_phillips_perron(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("by_hand", test_by_hand), &
         & new_unittest("reference", test_reference), &
         & new_unittest("verdicts", test_verdicts), &
         & new_unittest("offset_scale", test_offset_scale), &
         & new_unittest("small_signal", test_small_signal), &
         & new_unittest("dense", test_dense), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_phillips_perron

   !> 1 2 1 3 without a constant and without lags: the t statistic itself.
   subroutine test_by_hand(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(phillips_perron_type) :: pp
      type(gyro_error), allocatable :: problem
      real(dp) :: slope, rss

      ! levels 1 2 1, differences 1 -1 2: sum y d = 1 - 2 + 2 = 1, sum y^2 = 6, sum d^2 = 6
      slope = 1.0_dp/6.0_dp
      rss = 6.0_dp - 1.0_dp/6.0_dp
      call pp_of([1.0_dp, 2.0_dp, 1.0_dp, 3.0_dp], phillips_perron_options(regression="n", lags=0_int64), pp, problem)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, pp%statistic, slope/sqrt(rss/2.0_dp/6.0_dp), thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%rho_statistic, 3.0_dp*slope, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%coefficient, 1.0_dp + slope, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%long_run_variance, rss/3.0_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%observations == 3 .and. pp%lags == 0, "what was used")
   end subroutine test_by_hand

   !> Eleven series, three regressions. Without a constant the offset of 1e4 stays in the level: the statistic comes from the
   !> difference of sums that agree in seven digits.
   subroutine test_reference(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(phillips_perron_type) :: pp
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      real(dp) :: allowed
      integer :: i, k

      do i = 1, size(reference_names)
         x = reference_series(trim(reference_names(i)), 1000)
         do k = 1, 3
            call pp_of(x, phillips_perron_options(regression=regression(k)), pp, problem)
            call check(error, .not. allocated(problem), "it failed")
            if (allocated(error)) return
            allowed = tolerance
            if (k == 1 .and. reference_names(i) == "offset") allowed = 1.0e-10_dp
            call check(error, pp%statistic, tau_of(i, k), reference_names(i), thr=allowed, rel=.true.)
            if (allocated(error)) return
            call check(error, pp%rho_statistic, rho_of(i, k), reference_names(i), thr=allowed, rel=.true.)
            if (allocated(error)) return
            call check(error, pp%p_value, p_value(pp%statistic, k))
            if (allocated(error)) return
            call check(error, pp%lags == 22 .and. pp%observations == 999, "bandwidth and rows")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_reference

   !> A random walk has a unit root, the others have none.
   subroutine test_verdicts(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(phillips_perron_type) :: pp
      type(gyro_error), allocatable :: problem

      call pp_of(reference_series("rw", 1000), phillips_perron_options(), pp, problem)
      call check(error, pp%p_value, 0.5214713510087473_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, .not. pp%stationary, "random walk")
      if (allocated(error)) return
      call check(error, pp%critical(2), -2.864437475834273_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call pp_of(reference_series("ar1_99", 1000), phillips_perron_options(regression="ct", lags=22_int64), pp, problem)
      call check(error, pp%p_value, 0.013032954011543382_dp, thr=1.0e-10_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%stationary, "ar1_99")
   end subroutine test_verdicts

   !> An offset of 2^30 (where there is a constant) and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024.
   subroutine test_offset_scale(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(phillips_perron_type) :: a, b
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      real(dp), parameter :: offset(3) = [0.0_dp, 2.0_dp**30, 2.0_dp**30]
      integer :: k

      x = anint(1024.0_dp*reference_series("ar1", 1000))/1024.0_dp
      do k = 1, 3
         call pp_of(x, phillips_perron_options(regression=regression(k)), a, problem)
         call pp_of(-2.0_dp**(-50)*(x + offset(k)), phillips_perron_options(regression=regression(k)), b, problem)
         call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
         if (allocated(error)) return
         call check(error, b%rho_statistic, a%rho_statistic, thr=tolerance, rel=.true.)
         if (allocated(error)) return
      end do
   end subroutine test_offset_scale

   !> A signal of 1e-3 on 1e6 keeps seven digits: its samples have no more.
   subroutine test_small_signal(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(phillips_perron_type) :: a, b
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      integer :: k

      x = reference_series("ar1", 1000)
      do k = 2, 3
         call pp_of(x, phillips_perron_options(regression=regression(k)), a, problem)
         call pp_of(1.0e6_dp + 1.0e-3_dp*x, phillips_perron_options(regression=regression(k)), b, problem)
         call check(error, b%statistic, a%statistic, thr=1.0e-7_dp, rel=.true.)
         if (allocated(error)) return
      end do
   end subroutine test_small_signal

   !> Gaps, blocks and threads: the plain regression on the complete rows, the products of present pairs of residuals.
   subroutine test_dense(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(phillips_perron_type) :: pp
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      real(dp) :: tau, rho
      integer(int8), allocatable :: valid(:)
      integer :: i

      x = reference_series("ar1_99", 70000)
      allocate (valid(size(x)))
      valid = 1_int8
      call pp_of(x, phillips_perron_options(lags=30_int64), pp, problem)
      call plain(x, 30, valid, tau, rho)
      call check(error, pp%statistic, tau, thr=1.0e-11_dp, rel=.true.)
      if (allocated(error)) return
      do i = 1, size(x)
         if (mod(int(i, int64)**2, 11_int64) < 3 .or. i < 200) valid(i) = 0_int8
      end do
      where (valid == 0_int8) x = -1.0e9_dp
      call pp_of(x, phillips_perron_options(lags=30_int64), pp, problem, valid)
      call plain(x, 30, valid, tau, rho)
      call check(error, pp%statistic, tau, thr=1.0e-11_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%rho_statistic, rho, thr=1.0e-11_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, pp%observations, count(valid(2:) + valid(:size(x) - 1) == 2, kind=int64))
   end subroutine test_dense

   !> The statistics with a constant as their definition says, with arrays.
   pure subroutine plain(x, lags, valid, tau, rho)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: lags
      integer(int8), intent(in) :: valid(:)
      real(dp), intent(out) :: tau, rho
      real(dp) :: level(size(x) - 1), d(size(x) - 1), u(size(x) - 1), n, slope, rss, se2, long
      logical :: row(size(x) - 1)
      integer :: i

      row = valid(2:) + valid(:size(x) - 1) == 2
      n = real(count(row), dp)
      d = x(2:) - x(:size(x) - 1)
      d = merge(d - sum(d, mask=row)/n, 0.0_dp, row)
      level = merge(x(:size(x) - 1) - sum(x(:size(x) - 1), mask=row)/n, 0.0_dp, row)
      slope = dot_product(level, d)/dot_product(level, level)
      u = d - slope*level
      rss = dot_product(u, u)
      se2 = rss/(n - 2.0_dp)/dot_product(level, level)
      long = rss/n
      do i = 1, lags
         long = long + 2.0_dp*(1.0_dp - real(i, dp)/real(lags + 1, dp))*dot_product(u(i + 1:), u(:size(u) - i))/n
      end do
      tau = sqrt(rss/n/long)*slope/sqrt(se2) - 0.5_dp*(long - rss/n)/sqrt(long)*n*sqrt(se2*(n - 2.0_dp)/rss)
      rho = n*slope - 0.5_dp*(long - rss/n)*n*n*se2*(n - 2.0_dp)/rss
   end subroutine plain

   !> What cannot be tested.
   subroutine test_failures(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x(30)
      integer(int8) :: valid(30)
      integer :: i

      x = 5.3_dp
      call expect(x, phillips_perron_options(), status%constant_input, error)
      if (allocated(error)) return
      x = [(1.0e6_dp + 0.1_dp*real(i, dp), i = 1, 30)]
      call expect(x, phillips_perron_options(regression="ct"), status%constant_input, error)
      if (allocated(error)) return
      call expect(x(:4), phillips_perron_options(), status%too_few_samples, error)
      if (allocated(error)) return
      call expect(x, phillips_perron_options(lags=29_int64), status%too_few_samples, error)
      if (allocated(error)) return
      call expect(x, phillips_perron_options(regression="cc"), status%invalid_argument, error)
      if (allocated(error)) return
      call expect(x, phillips_perron_options(lags=-2_int64), status%invalid_argument, error)
      if (allocated(error)) return
      x = [(0.5_dp**i, i = 1, 30)]
      call expect(x, phillips_perron_options(regression="n"), status%singular, error)
      if (allocated(error)) return
      valid = [(int(mod(i, 2), int8), i = 1, 30)]
      call expect(x, phillips_perron_options(), status%too_few_samples, error, valid)
      if (allocated(error)) return
      call expect(x, phillips_perron_options(), status%invalid_argument, error, valid(:29))
   end subroutine test_failures

   !> The call fails with this code.
   subroutine expect(x, options, code, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(phillips_perron_options), intent(in) :: options
      integer, intent(in) :: code
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(phillips_perron_type) :: pp
      type(gyro_error), allocatable :: problem

      call pp_of(x, options, pp, problem, valid)
      call check_refused(error, problem, code)
   end subroutine expect

end module test_phillips_perron
