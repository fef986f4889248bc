! SPDX-License-Identifier: MIT
!> Tests of the augmented Dickey-Fuller test. The statistics and lags were computed in exact arithmetic
!> (integer cross products of the doubles of the series, 60 digits) and rounded once; series of
!> series_library, 1000 samples each, at most 22 lags.
module test_adf
   use omp_lib, only : omp_get_max_threads, omp_set_num_threads
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_lapack, only : dgels
   use gyroakf_series_mackinnon, only : critical_values, p_value
   use gyroakf_series_stationarity, only : adf_options, adf_type, default_max_lags, run_adf => test_adf
   use series_library, only : reference_series, reference_names
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_adf

   real(dp), parameter :: tolerance = 1.0e-12_dp
   character(3), parameter :: regressions(4) = [character(3) :: "n", "c", "ct", "ctt"]
   character(3), parameter :: criteria(3) = [character(3) :: "aic", "bic", "t"]
   !> [criterion, regression, series in the order of reference_names]
   integer, parameter :: lag_of(3, 4, 11) = reshape([ &
      & 6, 0, 6, 6, 0, 6, 6, 0, 6, 6, 0, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 21, 18, 21, 0, 0, 18, 0, 0, &
      & 18, 0, 0, 18, 0, 0, 7, 0, 0, 7, 0, 0, 12, 0, 0, 12, 5, 0, 5, 5, 0, 20, 5, 0, 20, 5, 0, 20, 0, 0, &
      & 12, 0, 0, 12, 0, 0, 12, 0, 0, 12, 5, 1, 5, 5, 1, 5, 5, 1, 5, 5, 1, 5, 22, 14, 22, 19, 11, 22, 6, 0, &
      & 6, 6, 0, 6, 13, 0, 18, 0, 0, 5, 5, 0, 5, 5, 0, 20, 19, 8, 22, 5, 0, 20, 5, 0, 20, 5, 0, 20, 7, 0, &
      & 19, 7, 0, 19, 7, 0, 19, 7, 0, 19], [3, 4, 11])
   !> The statistics: same order
   real(dp), parameter :: statistic_of(3,4,11) = reshape([ &
      & -13.503685644697077_dp, -31.21082317559141_dp, -13.503685644697077_dp, -13.530028194388949_dp, &
      & -31.217087539311493_dp, -13.530028194388949_dp, -13.525128365327285_dp, -31.201773758784864_dp, &
      & -13.525128365327285_dp, -13.51753321305635_dp, -31.186634141983603_dp, -13.51753321305635_dp, &
      & -32.21405665281934_dp, -32.21405665281934_dp, -32.21405665281934_dp, -32.20606944356337_dp, &
      & -32.20606944356337_dp, -32.20606944356337_dp, -32.2637894883013_dp, -32.2637894883013_dp, &
      & -32.2637894883013_dp, -32.33120620157684_dp, -32.33120620157684_dp, -32.33120620157684_dp, &
      & -0.6762228070164024_dp, -0.7750074460331344_dp, -0.6762228070164024_dp, -32.419627015235314_dp, &
      & -32.419627015235314_dp, -6.626035022558605_dp, -32.40492488005898_dp, -32.40492488005898_dp, &
      & -6.6225399465138315_dp, -32.40511931947814_dp, -32.40511931947814_dp, -6.6433682013885464_dp, &
      & -0.2405064848646229_dp, -0.2405064848646229_dp, -0.00789238781374564_dp, -1.7073900452671886_dp, &
      & -1.7073900452671886_dp, -1.3040210352053596_dp, -3.108646539822347_dp, -3.108646539822347_dp, &
      & -2.795259174040319_dp, -3.755968166135889_dp, -3.755968166135889_dp, -3.2525734633187238_dp, &
      & -11.192494657033876_dp, -13.578159314306356_dp, -11.192494657033876_dp, -11.23935537241675_dp, &
      & -13.604944824363486_dp, -7.082226397649558_dp, -11.23486614424041_dp, -13.598534213981742_dp, &
      & -7.082771788311943_dp, -11.230047019610712_dp, -13.592578246070516_dp, -7.076886945211085_dp, &
      & -3.2616420748251578_dp, -3.2616420748251578_dp, -2.911814033159316_dp, -3.8635057790858425_dp, &
      & -3.8635057790858425_dp, -3.4273607577220635_dp, -3.9049659846470086_dp, -3.9049659846470086_dp, &
      & -3.5199249550112293_dp, -3.9586675149661144_dp, -3.9586675149661144_dp, -3.495339014246583_dp, &
      & -13.609655383680431_dp, -17.94360443549642_dp, -13.609655383680431_dp, -13.645662355556125_dp, &
      & -17.961247703397838_dp, -13.645662355556125_dp, -13.639460501738416_dp, -17.952490904818994_dp, &
      & -13.639460501738416_dp, -13.633188562769744_dp, -17.944061059438305_dp, -13.633188562769744_dp, &
      & 0.5358947169381874_dp, 0.15733591003776157_dp, 0.5358947169381874_dp, -2.2222516314164067_dp, &
      & -3.9125988880771625_dp, -1.8723258783959142_dp, -13.525128365327285_dp, -31.201773758784864_dp, &
      & -13.525128365327285_dp, -13.51753321305635_dp, -31.186634141983603_dp, -13.51753321305635_dp, &
      & -3.586852638502781_dp, -10.026733263469678_dp, -2.9399357272168727_dp, -13.192206838927754_dp, &
      & -13.192206838927754_dp, -10.6086572797242_dp, -11.105115724659345_dp, -13.518672492979697_dp, &
      & -11.105115724659345_dp, -11.230047019610712_dp, -13.592578246070516_dp, -7.076886945211085_dp, &
      & 0.09241489986434338_dp, 0.16426468915534173_dp, 0.05364525820480959_dp, -11.239355372410483_dp, &
      & -13.604944824297498_dp, -7.082226397644991_dp, -11.234866144230933_dp, -13.59853421391378_dp, &
      & -7.082771788296283_dp, -11.230047019602823_dp, -13.592578246004518_dp, -7.076886945200048_dp, &
      & -13.015377082624447_dp, -30.11837019838759_dp, -7.541028131947736_dp, -13.041538531624377_dp, &
      & -30.12288508092526_dp, -7.59947084132884_dp, -13.03845370963706_dp, -30.109079727138667_dp, &
      & -7.606014475364985_dp, -13.031704347141917_dp, -30.094425423877023_dp, -7.599333827348185_dp], [3, 4, 11])
   !> Statistics with 1 and 4 lags: [lag, regression, series]
   real(dp), parameter :: fixed_of(2,4,11) = reshape([ &
      & -22.514895567817494_dp, -14.380951239663277_dp, -22.527224056916083_dp, -14.406379166095185_dp, &
      & -22.516339474528852_dp, -14.39932707390261_dp, -22.505547517999776_dp, -14.393163983543333_dp, &
      & -21.707620194302194_dp, -15.04851074983351_dp, -21.705842069848565_dp, -15.055511061505005_dp, &
      & -21.763711046560527_dp, -15.13917607182346_dp, -21.843569509833678_dp, -15.275661745808028_dp, &
      & -7.04011324339811_dp, -3.296323161496968_dp, -22.20431184843765_dp, -14.379967678786947_dp, &
      & -22.19406701742782_dp, -14.373827953316386_dp, -22.19626961132067_dp, -14.384132593551568_dp, &
      & -0.262604394303434_dp, -0.16015524806925754_dp, -1.7267867366991634_dp, -1.6618417395305216_dp, &
      & -3.15828435846067_dp, -3.003527444969214_dp, -3.8181058776519023_dp, -3.7104621019454873_dp, &
      & -12.89893370588239_dp, -11.066104924947927_dp, -12.929366182570755_dp, -11.110045388039778_dp, &
      & -12.923368887921525_dp, -11.104754194288176_dp, -12.917729541907_dp, -11.101287154121565_dp, &
      & -3.310707453286771_dp, -3.133583883755116_dp, -3.9266755868514864_dp, -3.7593493124050466_dp, &
      & -3.9720088166395726_dp, -3.7935838002756936_dp, -4.027098434080101_dp, -3.8613785517307733_dp, &
      & -17.94360443549642_dp, -13.586483152451853_dp, -17.961247703397838_dp, -13.618690203788121_dp, &
      & -17.952490904818994_dp, -13.611994692288071_dp, -17.944061059438305_dp, -13.606377457830432_dp, &
      & -3.0493773868822442_dp, -1.2789913568276834_dp, -15.80998176961804_dp, -8.16927250165569_dp, &
      & -22.516339474528852_dp, -14.39932707390261_dp, -22.505547517999776_dp, -14.393163983543333_dp, &
      & -9.180909768461875_dp, -7.092197052304933_dp, -12.475280963981339_dp, -10.54023881353623_dp, &
      & -12.834113088478933_dp, -11.00316749249702_dp, -12.917729541907_dp, -11.101287154121565_dp, &
      & 0.011941182737802288_dp, -0.02051802859161354_dp, -12.929366183005975_dp, -11.110045387626872_dp, &
      & -12.923368888354306_dp, -11.104754193874092_dp, -12.917729542341537_dp, -11.101287153710743_dp, &
      & -21.46947813522262_dp, -13.805535788050062_dp, -21.479134223714873_dp, -13.827060695580425_dp, &
      & -21.469731690334896_dp, -13.820682929252818_dp, -21.4594462825893_dp, -13.8148241315219_dp], [2, 4, 11])
   !> p-values with the lag of AIC: [regression, series]
   real(dp), parameter :: p_value_of(4,11) = reshape([ &
      & 1.5767658858018695e-24_dp, 2.6326189606320623e-25_dp, 3.2524871565970503e-21_dp, 4.472735899081274e-22_dp, &
      & 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.42262471785813255_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.5987762669846273_dp, &
      & 0.42730898192132594_dp, 0.10418821592107214_dp, 0.061066525964443605_dp, 2.87759312408698e-20_dp, &
      & 1.8233706501752382e-20_dp, 8.096848067118358e-18_dp, 7.36006175494375e-18_dp, 0.0011172320479200702_dp, &
      & 0.0023204586500150818_dp, 0.011943451769307_dp, 0.03542426115308345_dp, 1.0694461204471283e-24_dp, &
      & 1.6214881409764936e-25_dp, 2.4584919775418303e-21_dp, 3.029383351599386e-22_dp, 0.8329919017243121_dp, &
      & 0.19826874024720487_dp, 3.2524871565970503e-21_dp, 4.472735899081274e-22_dp, 0.0003528841038937901_dp, &
      & 1.1380521737156049e-24_dp, 1.409754917927281e-17_dp, 7.36006175494375e-18_dp, 0.7141633811869261_dp, &
      & 1.8233706502370172e-20_dp, 8.096848067443402e-18_dp, 7.36006175523163e-18_dp, 1.0186571551400019e-23_dp, &
      & 2.2358522599816487e-24_dp, 1.2143799978256102e-20_dp, 2.583247116846844e-21_dp], [4, 11])

contains

   !> The tests of this suite.
   subroutine collect_adf(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("mackinnon", test_mackinnon), &
         & new_unittest("by_hand", test_by_hand), &
         & new_unittest("reference", test_reference), &
         & new_unittest("fixed_lags", test_fixed_lags), &
         & new_unittest("dense", test_dense), &
         & new_unittest("missing", test_missing), &
         & new_unittest("offset_scale", test_offset_scale), &
         & new_unittest("large_offset", test_large_offset), &
         & new_unittest("threads", test_threads), &
         & new_unittest("verdict", test_verdict), &
         & new_unittest("most_lags", test_most_lags), &
         & new_unittest("degenerate", test_degenerate), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_adf

   !> Spot values of both response surfaces; the p-value on both sides of its seam and beyond its ends.
   subroutine test_mackinnon(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: p(7)

      p = [p_value(-2.86_dp, 2), p_value(-3.5_dp, 3), p_value(-6.0_dp, 4), p_value(3.0_dp, 1), p_value(-25.0_dp, 2), &
         & p_value(3.0_dp, 2), p_value(0.5_dp, 3)]
      call check(error, maxval(abs(p - [0.05020109988200309_dp, 0.03939102799324626_dp, 1.2806340167779076e-5_dp, &
         & 0.9998068584192428_dp, 0.0_dp, 1.0_dp, 0.996851911498776_dp])), 0.0_dp, thr=1.0e-15_dp)
      if (allocated(error)) return
      call check(error, p_value(-1.61_dp, 2), 0.47798_dp, thr=5.0e-6_dp)
      if (allocated(error)) return
      call check(error, p_value(-1.61_dp + epsilon(p), 2), 0.47857_dp, thr=5.0e-6_dp)
      if (allocated(error)) return
      call check(error, maxval(abs(critical_values(2, 100_int64) - [-3.497501033_dp, -2.89090644_dp, -2.5824349_dp])), &
         & 0.0_dp, thr=tolerance)
      if (allocated(error)) return
      call check(error, maxval(abs(critical_values(4, 994_int64) - [-4.382824741753722_dp, -3.8383441097672435_dp, &
         & -3.5569471119500258_dp])), 0.0_dp, thr=tolerance)
   end subroutine test_mackinnon

   !> 1 2 1 3 1, no constant, no lag: levels 1 2 1 3, differences 1 -1 2 -2; rho = -5/15,
   !> RSS = 10 - 25/15, t = rho sqrt(15)/sqrt(RSS/3).
   subroutine test_by_hand(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem

      call run_adf([1.0_dp, 2.0_dp, 1.0_dp, 3.0_dp, 1.0_dp], adf_options(regression="n", lags=0), adf, problem)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, adf%statistic, -sqrt(15.0_dp)/3.0_dp/sqrt((10.0_dp - 5.0_dp/3.0_dp)/3.0_dp), thr=tolerance)
      if (allocated(error)) return
      call check(error, adf%observations == 4_int64 .and. adf%lag == 0, "rows or lag")
   end subroutine test_by_hand

   !> Eleven series, four regressions, three criteria: the lag, the statistic to 1e-12, the p-value.
   subroutine test_reference(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem
      character(40) :: what
      integer :: i, j, k

      do i = 1, size(reference_names)
         do j = 1, 4
            do k = 1, 3
               what = trim(reference_names(i))//" "//trim(regressions(j))//" "//criteria(k)
               call run_adf(reference_series(trim(reference_names(i)), 1000), &
                  & adf_options(regression=regressions(j), criterion=criteria(k)), adf, problem)
               call check(error, .not. allocated(problem), what)
               if (allocated(error)) return
               call check(error, adf%lag, lag_of(k, j, i), what)
               if (allocated(error)) return
               call close_to(error, adf%statistic, statistic_of(k, j, i), tolerance, what)
               if (allocated(error)) return
               if (k > 1) cycle
               call check(error, abs(adf%p_value - p_value_of(j, i)) <= 1.0e-10_dp*p_value_of(j, i), "p-value of "//what)
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_reference

   !> Relative to the larger of 1 and the value.
   subroutine close_to(error, actual, expected, allowed, what)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> What came out, what should, how far off it may be
      real(dp), intent(in) :: actual, expected, allowed
      !> Which
      character(*), intent(in) :: what
      character(160) :: text

      write (text, '(a, ": ", es24.16, " is not ", es24.16)') trim(what), actual, expected
      call check(error, abs(actual - expected) <= allowed*max(1.0_dp, abs(expected)), trim(text))
   end subroutine close_to

   !> One and four lags.
   subroutine test_fixed_lags(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem
      integer :: i, j, k

      do i = 1, size(reference_names)
         do j = 1, 4
            do k = 1, 2
               call run_adf(reference_series(trim(reference_names(i)), 1000), &
                  & adf_options(regression=regressions(j), lags=3*k - 2), adf, problem)
               call check(error, .not. allocated(problem), reference_names(i))
               if (allocated(error)) return
               call close_to(error, adf%statistic, fixed_of(k, j, i), tolerance, reference_names(i))
               if (allocated(error)) return
               call check(error, int(adf%observations), 999 - adf%lag)
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_fixed_lags

   !> The statistic from the full regression matrix by Householder reflections.
   function dense_statistic(x, terms, lags, valid) result(statistic)
      !> Series
      real(dp), intent(in) :: x(0:)
      !> Deterministic terms, lags
      integer, intent(in) :: terms, lags
      !> 1 present, 0 missing
      integer(int8), intent(in) :: valid(0:)
      real(dp) :: statistic
      real(dp), allocatable :: a(:, :), b(:, :), work(:)
      integer :: t, j, m, k, n, info

      n = size(x)
      k = terms + lags + 1
      allocate (a(n, k), b(n, 1), work(200*k))
      m = 0
      do t = lags + 1, n - 1
         if (any(valid(t - lags - 1:t) == 0_int8)) cycle
         m = m + 1
         b(m, 1) = x(t) - x(t - 1)
         do j = 1, terms
            a(m, j) = (2.0_dp*real(t, dp)/real(n, dp) - 1.0_dp)**(j - 1)
         end do
         do j = 1, lags
            a(m, terms + j) = x(t - j) - x(t - j - 1)
         end do
         a(m, k) = x(t - 1)
      end do
      call dgels("N", m, k, 1, a, n, b, n, work, size(work), info)
      statistic = b(k, 1)*abs(a(k, k))/sqrt(sum(b(k + 1:m, 1)**2)/real(m - k, dp))
   end function dense_statistic

   !> Against the dense regression, lengths around the blocks.
   subroutine test_dense(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: length(4) = [60, 4097, 8200, 5001], lags(4) = [20, 3, 9, 60]
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, j

      do i = 1, 4
         x = reference_series("quad", length(i))
         valid = [(1_int8, j=1, length(i))]
         do j = 1, 4
            call run_adf(x, adf_options(regression=regressions(j), lags=lags(i)), adf, problem)
            call check(error, .not. allocated(problem), "it failed")
            if (allocated(error)) return
            call close_to(error, adf%statistic, dense_statistic(x, j - 1, lags(i), valid), 1.0e-11_dp, regressions(j))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_dense

   !> With gaps: complete rows only, against the dense regression; what a gap holds does not matter;
   !> the lag is chosen so that rows are left.
   subroutine test_missing(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, j

      x = reference_series("ar2", 9000)
      do i = 1, 2
         valid = merge(0_int8, 1_int8, reference_series("unif", 9000) < merge(0.003_dp, 0.05_dp, i == 1))
         valid(4000:4100) = 0_int8
         valid(9000) = 0_int8
         where (valid == 0_int8) x = -1.0e4_dp
         do j = 1, 4
            call run_adf(x, adf_options(regression=regressions(j), lags=7), adf, problem, valid)
            call check(error, .not. allocated(problem), "it failed")
            if (allocated(error)) return
            call close_to(error, adf%statistic, dense_statistic(x, j - 1, 7, valid), 1.0e-11_dp, regressions(j))
            if (allocated(error)) return
         end do
         call run_adf(x, adf_options(), adf, problem, valid)
         call check(error, .not. allocated(problem), "the lag was not chosen")
         if (allocated(error)) return
         call close_to(error, adf%statistic, dense_statistic(x, 1, adf%lag, valid), 1.0e-11_dp, "chosen lag")
         if (allocated(error)) return
      end do
      valid = 1_int8
      x = reference_series("ar1", 1000)
      call run_adf(x, adf_options(), adf, problem, valid(:1000))
      call close_to(error, adf%statistic, -11.23935537241675_dp, tolerance, "all present")
   end subroutine test_missing

   !> Offset 2^40 and scale 2^-50, exact for multiples of 1/1024: the same lag and statistic.
   subroutine test_offset_scale(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: a, b
      real(dp), allocatable :: x(:)
      type(gyro_error), allocatable :: problem
      integer :: j

      x = anint(1024.0_dp*reference_series("ar1_99", 6000))/1024.0_dp
      do j = 2, 4
         call run_adf(x, adf_options(regression=regressions(j)), a, problem)
         call run_adf((x + 2.0_dp**40)*2.0_dp**(-50), adf_options(regression=regressions(j)), b, problem)
         call check(error, .not. allocated(problem), "it failed")
         if (allocated(error)) return
         call check(error, a%lag, b%lag)
         if (allocated(error)) return
         call close_to(error, b%statistic, a%statistic, 1.0e-11_dp, regressions(j))
         if (allocated(error)) return
      end do
      call run_adf(x, adf_options(regression="n"), a, problem)
      call run_adf(-x*2.0_dp**100, adf_options(regression="n"), b, problem)
      call close_to(error, b%statistic, a%statistic, tolerance, "n")
   end subroutine test_offset_scale

   !> 1e6 + 1e-3 ar1: the doubles hold 7 digits of the signal, and so does the statistic.
   subroutine test_large_offset(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem
      integer :: j

      do j = 2, 4
         call run_adf(1.0e6_dp + 1.0e-3_dp*reference_series("ar1", 1000), adf_options(regression=regressions(j)), adf, problem)
         call check(error, .not. allocated(problem), "it failed")
         if (allocated(error)) return
         call check(error, adf%lag, 5)
         if (allocated(error)) return
         call close_to(error, adf%statistic, statistic_of(1, j, 5), 1.0e-7_dp, regressions(j))
         if (allocated(error)) return
      end do
   end subroutine test_large_offset

   !> One and two threads give the same bits.
   subroutine test_threads(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: before
      type(gyro_error), allocatable :: problem

      x = reference_series("ar1", 70000)
      before = omp_get_max_threads()
      call omp_set_num_threads(1)
      call run_adf(x, adf_options(max_lags=10), a, problem)
      call omp_set_num_threads(2)
      call run_adf(x, adf_options(max_lags=10), b, problem)
      call omp_set_num_threads(before)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, a%statistic, b%statistic, thr=tiny(x))
   end subroutine test_threads

   !> The verdict is the right way round.
   subroutine test_verdict(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem

      call run_adf(reference_series("ar1", 1000), adf_options(), adf, problem)
      call check(error, adf%stationary .and. adf%p_value < 0.01_dp, "AR(1) is stationary")
      if (allocated(error)) return
      call run_adf(reference_series("rw", 1000), adf_options(), adf, problem)
      call check(error, .not. adf%stationary .and. adf%p_value > 0.1_dp, "a random walk is not")
   end subroutine test_verdict

   !> ceiling(12 (n/100)^(1/4)), less for short series and for gaps.
   subroutine test_most_lags(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      integer(int8) :: valid(1000)

      call check(error, all([default_max_lags(1000_int64, 1), default_max_lags(12000_int64, 1), &
         & default_max_lags(100000000_int64, 1), default_max_lags(20_int64, 1), default_max_lags(4_int64, 3)] &
         & == [22, 40, 380, 8, 0]), "most lags")
      if (allocated(error)) return
      valid = 1_int8
      valid(10::10) = 0_int8
      call check(error, default_max_lags(1000_int64, 1, valid), 7)
   end subroutine test_most_lags

   !> Constant, perfect line, perfect prediction: a status, no number.
   subroutine test_degenerate(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x(200)
      integer :: i

      x = 1234.1_dp
      call refused(error, x, adf_options(), status%constant_input)
      if (allocated(error)) return
      x = [(1.1_dp + 0.1_dp*real(i, dp), i=1, 200)]
      call refused(error, x, adf_options(regression="ct"), status%constant_input)
      if (allocated(error)) return
      call refused(error, x, adf_options(), status%singular)
      if (allocated(error)) return
      x = [(sin(real(i, dp)), i=1, 200)]
      call refused(error, x, adf_options(lags=4), status%singular)
      if (allocated(error)) return
      x = [(real(2*mod(i, 2) - 1, dp), i=1, 200)]
      call refused(error, x, adf_options(lags=0), status%singular)
   end subroutine test_degenerate

   !> Each other error.
   subroutine test_failures(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x(30)
      integer(int8) :: valid(30)

      x = reference_series("wn", 30)
      valid = 1_int8
      valid(3::4) = 0_int8
      call refused(error, x, adf_options(regression="tc"), status%invalid_argument)
      if (allocated(error)) return
      call refused(error, x, adf_options(criterion="fpe"), status%invalid_argument)
      if (allocated(error)) return
      call refused(error, x, adf_options(lags=-2), status%invalid_argument)
      if (allocated(error)) return
      call refused(error, x, adf_options(lags=14), status%too_few_samples)
      if (allocated(error)) return
      call refused(error, x, adf_options(lags=29), status%too_few_samples)
      if (allocated(error)) return
      call refused(error, x, adf_options(lags=huge(1)), status%too_few_samples)
      if (allocated(error)) return
      call refused(error, x, adf_options(max_lags=huge(1)), status%too_few_samples)
      if (allocated(error)) return
      call refused(error, x(:4), adf_options(), status%too_few_samples)
      if (allocated(error)) return
      call refused(error, x, adf_options(lags=4), status%too_few_samples, valid)
      if (allocated(error)) return
      call refused(error, x, adf_options(), status%invalid_argument, valid(:7))
      if (allocated(error)) return
      valid = 0_int8
      call refused(error, x, adf_options(), status%too_few_samples, valid)
   end subroutine test_failures

   !> Fails unless the test is refused with the code.
   subroutine refused(error, x, options, code, valid)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Options
      type(adf_options), intent(in) :: options
      !> Expected
      integer, intent(in) :: code
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      type(adf_type) :: adf
      type(gyro_error), allocatable :: problem

      call run_adf(x, options, adf, problem, valid)
      call check(error, allocated(problem), "bad input was accepted")
      if (allocated(error)) return
      call check(error, problem%code, code, problem%message)
   end subroutine refused

end module test_adf
