! SPDX-License-Identifier: MIT
!> Verifies this build against published test vectors and exact reference values.
!>
!> NBS14: W. J. Riley and D. A. Howe, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008),
!> section 12.4: nine rates, and a thousand of the minimal standard generator n_0 = 1234567890,
!> n_(i+1) = 16807 n_i mod 2147483647. Sums of twelve of its numbers less six are nearly normal
!> noise e_t; y_t = e_t + a y_(t-1) is an AR(1) process (a = 0.7) or a random walk (a = 1). Their
!> exact statistics were computed in rational arithmetic from the doubles of the series and rounded
!> once.
module gyroakf_selftest
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use gyroakf_stats_fisher, only : fisher_type, test_fisher_g
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_stats_moments, only : compute_moments, moments_type
   use gyroakf_stats_normality, only : jarque_bera_type, test_jarque_bera
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   implicit none (type, external)
   private
   public :: selftest_check_type, selftest_type, run_selftest, add_check

   !> One comparison of one or more values
   type :: selftest_check_type
      character(32) :: group = "", name = ""
      !> The pair that differs most for its tolerance, which is absolute
      real(dp) :: expected = 0.0_dp, got = 0.0_dp, tolerance = 0.0_dp
      logical :: passed = .false.
      !> Reason where no value was computed; empty otherwise
      character(160) :: problem = ""
   end type selftest_check_type

   !> All comparisons
   type :: selftest_type
      type(selftest_check_type), allocatable :: check(:)
      integer :: failed = 0
   end type selftest_type

   !> Relative: rounding of the sums of a thousand terms
   real(dp), parameter :: exact = 1.0e-11_dp
   character(6), parameter :: kinds(7) = [character(6) :: "adev", "oadev", "mdev", "tdev", "hdev", &
      "ohdev", "totdev"]
   real(dp), parameter :: nine(9) = [892.0_dp, 809.0_dp, 823.0_dp, 798.0_dp, 671.0_dp, 644.0_dp, &
      883.0_dp, 903.0_dp, 677.0_dp]
   !> At 1 and 2 s. hdev at 1 s is printed as 70.80608; exactly it is 70.806073, as ohdev
   real(dp), parameter :: of_nine(2, 7) = reshape([91.22945_dp, 115.8082_dp, 91.22945_dp, &
      85.95287_dp, 91.22945_dp, 74.78849_dp, 52.67135_dp, 86.35831_dp, 70.80607_dp, 116.7980_dp, &
      70.80607_dp, 85.61487_dp, 91.22945_dp, 93.90379_dp], [2, 7])
   !> At 1, 10 and 100 s. hdev at 100 s is printed as 3.910860e-02; exactly it is 3.91086056e-02
   real(dp), parameter :: of_thousand(3, 7) = reshape([2.922319e-1_dp, 9.965736e-2_dp, &
      3.897804e-2_dp, 2.922319e-1_dp, 9.159953e-2_dp, 3.241343e-2_dp, 2.922319e-1_dp, &
      6.172376e-2_dp, 2.170921e-2_dp, 1.687202e-1_dp, 3.563623e-1_dp, 1.253382e+0_dp, &
      2.943883e-1_dp, 1.052754e-1_dp, 3.910861e-2_dp, 2.943883e-1_dp, 9.581083e-2_dp, &
      3.237638e-2_dp, 2.922319e-1_dp, 9.134743e-2_dp, 3.406530e-2_dp], [3, 7])
   !> oadev at 2, 4, 8, 16, 32, 64, 100, 128, 256, 333, 499 and 500 s
   real(dp), parameter :: exact_oadev(12) = [0.2010160421709385_dp, 0.1447913072184378_dp, &
      0.1057038500787000_dp, 0.06191477841874487_dp, 0.04808214262128163_dp, &
      0.03623721298570472_dp, 0.03241343026056984_dp, 0.02767385582069448_dp, &
      0.01028221763903273_dp, 0.008244123626136666_dp, 0.002832505364418703_dp, &
      0.002158165703661819_dp]
   !> Of the noise: four moments; statistic and p-value of Jarque-Bera, Ljung-Box, Fisher's g
   real(dp), parameter :: of_white(10) = [-0.026799447876307864_dp, 0.9463224002903896_dp, &
      0.06991219991707069_dp, 3.0055072631266455_dp, 0.8158830306718312_dp, 0.6650177710260406_dp, &
      14.79311288288673_dp, 0.1397886119827444_dp, 0.013809472937182887_dp, 0.39489632455981305_dp]

contains

   !> Runs all checks. A check that fails is no error: see `result%failed`.
   subroutine run_selftest(result)
      !> The checks, in groups
      type(selftest_type), intent(out) :: result
      real(dp) :: rate(1000), white(1000), ar1(1000), walk(1000)
      integer :: k

      allocate (result%check(0))
      call generate(1, rate)
      do k = 1, size(kinds)
         call check_curve(result, "NBS14, 9 rates", kinds(k), nine, "1,2", of_nine(:, k), .true.)
         call check_curve(result, "NBS14, 1000 rates", kinds(k), rate, "1,10,100", &
            of_thousand(:, k), .true.)
      end do
      call check_curve(result, "NBS14, exact values", "oadev", rate, &
         "2,4,8,16,32,64,100,128,256,333,499,500", exact_oadev, .false.)
      call generate(12, white)
      ar1 = white
      walk = white
      do k = 2, size(white)
         ar1(k) = white(k) + 0.7_dp*ar1(k - 1)
         walk(k) = white(k) + walk(k - 1)
      end do
      call check_white(result, white)
      call check_model(result, ar1, "yw", [0.7110825650005402_dp, -0.035155094816911835_dp, &
         0.9438591163364932_dp])
      call check_model(result, ar1, "burg", [0.7111670023214032_dp, -0.03506192739963276_dp, &
         0.9435131374995934_dp])
      call check_model(result, ar1, "ols", [0.7110045660283869_dp, -0.03505678703123156_dp, &
         0.9450511784482113_dp])
      call check_root(result, "white noise", white, "c", [-13.530028194388949_dp, 6.0_dp, &
         0.02874116848154657_dp, 7.0_dp])
      call check_root(result, "AR(1)", ar1, "c", [-11.23935537241675_dp, 5.0_dp, &
         0.03995536733960086_dp, 14.0_dp])
      call check_root(result, "AR(1)", ar1, "ct", [-11.23486614424041_dp, 5.0_dp, &
         0.03781483941823974_dp, 14.0_dp])
      call check_root(result, "random walk", walk, "c", [-1.7073900452671886_dp, 0.0_dp, &
         3.6749962525187274_dp, 19.0_dp])
      call check_root(result, "random walk", walk, "ct", [-3.108646539822347_dp, 0.0_dp, &
         0.5739503971100055_dp, 19.0_dp])
   end subroutine run_selftest

   !> Compares values with expected ones and records the pair that differs most for its tolerance.
   subroutine add_check(result, group, name, expected, got, printed, error)
      !> Gets one check
      type(selftest_type), intent(inout) :: result
      !> At most 32 characters
      character(*), intent(in) :: group, name
      !> [n]; another number of computed values fails the check
      real(dp), intent(in) :: expected(:), got(:)
      !> Expected to seven significant digits, else to rounding
      logical, intent(in) :: printed
      !> Allocated where nothing was computed: the check fails with this reason
      type(error_type), allocatable, intent(in), optional :: error
      type(selftest_check_type) :: check
      real(dp) :: excess, largest, tolerance
      integer :: i

      check%group = group
      check%name = name
      if (size(got) /= size(expected)) check%problem = "wrong number of values"
      if (present(error)) then
         if (allocated(error)) check%problem = error%message
      end if
      largest = -1.0_dp
      do i = 1, merge(size(expected), 0, check%problem == "")
         tolerance = exact*abs(expected(i))
         if (printed) tolerance = 0.5e-6_dp*10.0_dp**floor(log10(expected(i)))
         excess = huge(excess)
         if (ieee_is_finite(got(i))) excess = abs(got(i) - expected(i))/max(tolerance, tiny(excess))
         if (excess <= largest) cycle
         largest = excess
         check%expected = expected(i)
         check%got = got(i)
         check%tolerance = tolerance
      end do
      check%passed = check%problem == "" .and. largest <= 1.0_dp
      result%check = [result%check, check]
      if (.not. check%passed) result%failed = result%failed + 1
   end subroutine add_check

   !> One statistic at some averaging times.
   subroutine check_curve(result, group, kind, rate, taus, expected, printed)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: group, kind, taus
      real(dp), intent(in), contiguous :: rate(:)
      real(dp), intent(in) :: expected(:)
      logical, intent(in) :: printed
      type(allan_curve_type) :: curve
      type(error_type), allocatable :: error

      call compute_allan(rate, 1.0_dp, allan_options(kind=kind, taus=taus), curve, error)
      if (allocated(error)) curve%deviation = expected(1:0)
      call add_check(result, group, kind, expected, curve%deviation, printed, error)
   end subroutine check_curve

   !> Moments, normality, whiteness, periodicity.
   subroutine check_white(result, x)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)
      character(*), parameter :: group = "exact values, white noise"
      type(moments_type) :: of
      type(jarque_bera_type) :: normal
      type(ljung_box_type) :: white
      type(fisher_type) :: fisher
      type(error_type), allocatable :: error

      call compute_moments(x, of)
      call add_check(result, group, "moments", of_white(:4), &
         [of%mean, of%variance, of%skewness, of%kurtosis], .false.)
      call test_jarque_bera(of, normal, error)
      call add_check(result, group, "Jarque-Bera", of_white(5:6), &
         [normal%statistic, normal%p_value], .false., error)
      call test_ljung_box(x, 10, 0, white, error)
      call add_check(result, group, "Ljung-Box, 10 lags", of_white(7:8), &
         [white%statistic, white%p_value], .false., error)
      call test_fisher_g(x, fisher, error)
      call add_check(result, group, "Fisher's g", of_white(9:), &
         [fisher%statistic, fisher%p_value], .false., error)
   end subroutine check_white

   !> Coefficients and noise variance of an AR(2) model.
   subroutine check_model(result, x, method, expected)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)
      character(*), intent(in) :: method
      real(dp), intent(in) :: expected(3)
      type(ar_model_type) :: model
      type(error_type), allocatable :: error

      call fit_ar(x, ar_options(method=method, order=2), model, error)
      if (allocated(error)) model%coefficient = expected(1:0)
      call add_check(result, "exact values, AR(1)", "AR(2) by "//method, expected, &
                     [model%coefficient, model%noise_variance], .false., error)
   end subroutine check_model

   !> Statistic and lag of the ADF test (lag by AIC), statistic and bandwidth of the KPSS test.
   subroutine check_root(result, name, x, regression, expected)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: name, regression
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: expected(4)
      type(adf_type) :: adf
      type(kpss_type) :: kpss
      type(error_type), allocatable :: error

      call test_adf(x, adf_options(regression=regression), adf, error)
      call add_check(result, "exact values, "//name, "ADF, "//regression, expected(:2), &
                     [adf%statistic, real(adf%lag, dp)], .false., error)
      call test_kpss(x, kpss_options(regression=regression), kpss, error)
      call add_check(result, "exact values, "//name, "KPSS, "//regression, expected(3:), &
                     [kpss%statistic, real(kpss%lags, dp)], .false., error)
   end subroutine check_root

   !> Sums of some numbers of the minimal standard generator: one as it is, twelve less six.
   pure subroutine generate(summands, x)
      integer, intent(in) :: summands
      real(dp), intent(out) :: x(:)
      integer(int64), parameter :: multiplier = 16807, modulus = 2147483647
      integer(int64) :: state, total
      integer :: i, j

      state = 1234567890
      do i = 1, size(x)
         total = 0
         do j = 1, summands
            total = total + state
            state = mod(multiplier*state, modulus)
         end do
         x(i) = real(total, dp)/real(modulus, dp) - real(summands/2, dp)
      end do
   end subroutine generate

end module gyroakf_selftest
