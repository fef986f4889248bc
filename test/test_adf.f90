! SPDX-License-Identifier: MIT
!> Tests of the augmented Dickey-Fuller test. The statistics and lags were computed in exact arithmetic
!> (integer cross products of the doubles of the series, 60 digits) and rounded once; series of
!> series_library, 1000 samples each, at most 22 lags: adf_reference.
module test_adf
   use expectations, only : agree, unmet, problem, test, error, check, check_refused, went_wrong
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_lapack, only : dgels
   use gyroakf_series_mackinnon, only : critical_values, p_value
   use gyroakf_series_adf, only : adf_options, adf_type, default_max_lags, run_adf => test_adf
   use series_library, only : reference_series, reference_names
   use adf_reference, only : chosen_lag, exact_criterion, exact_regression, exact_value
   implicit none (type, external)
   private
   public :: suite_adf

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> Of p-values: in the tail a change of the statistic changes p by a hundred times as much, both relative
   real(dp), parameter :: tail_tolerance = 1.0e-10_dp
   !> Of the t of the last lag: what is left of products that all but cancel, a twentieth of them and less
   real(dp), parameter :: small_difference = 1.0e-11_dp
   character(3), parameter :: regressions(4) = [character(3) :: "n", "c", "ct", "ctt"]
   character(3), parameter :: criteria(3) = [character(3) :: "aic", "bic", "t"]
   character(8), parameter :: long_names(3) = [character(8) :: "rw", "ar1_99", "trend"]
   !> Lags by AIC, statistics and p-values of 12,000 samples: [regression, series]
   integer, parameter :: long_lag(4, 3) = reshape([2, 2, 1, 2, 2, 2, 2, 2, 40, 40, 0, 0], [4, 3])
   real(dp), parameter :: long_statistic(4, 3) = reshape([ &
      & -0.5087716301394399_dp, -0.4836641556402628_dp, -0.7021677144119857_dp, -2.636258203316543_dp, -7.824790992619408_dp, &
      & -7.866962327996292_dp, -8.017845518216818_dp, -8.150280354408803_dp, 3.927275352146026_dp, -0.3575630234642604_dp, &
      & -112.51321508426417_dp, -112.52562638049449_dp], [4, 3])
   real(dp), parameter :: long_p(4, 3) = reshape([ &
      & 0.49251512262011493_dp, 0.8951650972850305_dp, 0.9730050685801898_dp, 0.49084440038053273_dp, 8.23679293666082e-13_dp, &
      & 5.104230070734512e-12_dp, 6.497500626038628e-11_dp, 1.4387896076766925e-10_dp, 0.9999998086166174_dp, &
      & 0.9169467680468175_dp, 0.0_dp, 0.0_dp], [4, 3])

contains

   subroutine suite_adf()
      call test("mackinnon", test_mackinnon)
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("long", test_long)
      call test("dense", test_dense)
      call test("missing", test_missing)
      call test("offset_scale", test_offset_scale)
      call test("large_offset", test_large_offset)
      call test("threads", test_threads)
      call test("verdict", test_verdict)
      call test("most_lags", test_most_lags)
      call test("short", test_short)
      call test("degenerate", test_degenerate)
      call test("failures", test_failures)
   end subroutine suite_adf

   !> Spot values of both response surfaces; the p-value on both sides of its seam and beyond its ends.
   subroutine test_mackinnon()
      real(dp) :: p(7)

      p = [p_value(-2.86_dp, 2), p_value(-3.5_dp, 3), p_value(-6.0_dp, 4), p_value(3.0_dp, 1), p_value(-25.0_dp, 2), &
         & p_value(3.0_dp, 2), p_value(0.5_dp, 3)]
      call check(error, maxval(abs(p - [0.05020109988200309_dp, 0.03939102799324626_dp, 1.2806340167779076e-5_dp, &
         & 0.9998068584192428_dp, 0.0_dp, 1.0_dp, 0.996851911498776_dp])), 0.0_dp, thr=1.0e-15_dp)
      call check(error, p_value(-1.61_dp, 2), 0.47798_dp, thr=5.0e-6_dp)
      call check(error, p_value(-1.61_dp + epsilon(p), 2), 0.47857_dp, thr=5.0e-6_dp)
      call check(error, maxval(abs(critical_values(2, 100_int64) - [-3.497501033_dp, -2.89090644_dp, -2.5824349_dp])), &
         & 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(critical_values(4, 994_int64) - [-4.382824741753722_dp, -3.8383441097672435_dp, &
         & -3.5569471119500258_dp])), 0.0_dp, thr=tolerance)
   end subroutine test_mackinnon

   !> 1 2 1 3 1, no constant, no lag: levels 1 2 1 3, differences 1 -1 2 -2; rho = -5/15,
   !> RSS = 10 - 25/15, t = rho sqrt(15)/sqrt(RSS/3).
   subroutine test_by_hand()
      type(adf_type) :: adf

      call run_adf([1.0_dp, 2.0_dp, 1.0_dp, 3.0_dp, 1.0_dp], adf_options(regression="n", lags=0), adf, problem)
      if (went_wrong(problem)) return
      call check(error, adf%statistic, -sqrt(15.0_dp)/3.0_dp/sqrt((10.0_dp - 5.0_dp/3.0_dp)/3.0_dp), thr=tolerance)
      call check(error, adf%noise_variance, (10.0_dp - 5.0_dp/3.0_dp)/3.0_dp, thr=tolerance)
      call check(error, adf%observations == 4_int64 .and. adf%lag == 0, "rows or lag")
   end subroutine test_by_hand

   !> Eleven series, four regressions: the lags that three criteria choose, and statistic and
   !> coefficient of the level at these and at given lags.
   subroutine test_reference()
      type(adf_type) :: adf
      character(40) :: what
      integer :: i, j, k

      do k = 1, size(exact_regression, 2)
         i = exact_regression(1, k)
         j = exact_regression(2, k)
         write (what, '(a, 1x, a, " lag ", i0)') trim(reference_names(i)), regressions(j), &
            & exact_regression(3, k)
         call run_adf(reference_series(trim(reference_names(i)), 1000), &
                      adf_options(regressions(j), exact_regression(3, k)), adf, problem)
         if (went_wrong(problem, what)) return
         call check(error, adf%lag == exact_regression(3, k) .and. &
            & adf%observations == 999 - adf%lag, what)
         call close_to(adf%statistic, exact_value(1, k), tolerance, what)
         call agree([adf%level], exact_value(2:2, k), tolerance, what)
      end do
      do i = 1, size(reference_names)
         do j = 1, 4
            do k = 1, 3
               what = trim(reference_names(i))//" "//trim(regressions(j))//" "//criteria(k)
               call run_adf(reference_series(trim(reference_names(i)), 1000), &
                            adf_options(regression=regressions(j), criterion=criteria(k)), adf, &
                               & problem)
               if (went_wrong(problem, what)) return
               call check(error, adf%lag == chosen_lag(k, j, i) .and. &
                  & adf%observations == 999 - adf%lag, what)
               call close_to(adf%statistic, exact_statistic(i, j, adf%lag), tolerance, what)
               call agree([adf%criterion_value], [exact_criterion(k, j, i)], &
                          merge(small_difference, tolerance, k == 3), "criterion of "//what)
            end do
         end do
      end do
   end subroutine test_reference

   !> The statistic of a series, regression and lag in the table.
   pure real(dp) function exact_statistic(series, regression, lag)
      integer, intent(in) :: series, regression, lag

      exact_statistic = exact_value(1, findloc(exact_regression(1, :) == series .and. &
         & exact_regression(2, :) == regression .and. exact_regression(3, :) == lag, .true., 1))
   end function exact_statistic

   !> 12,000 samples, AIC.
   subroutine test_long()
      type(adf_type) :: adf
      integer :: i, j

      do i = 1, 3
         do j = 1, 4
            call run_adf(reference_series(trim(long_names(i)), 12000), adf_options(regression=regressions(j)), adf, problem)
            if (went_wrong(problem, long_names(i))) return
            call check(error, adf%lag, long_lag(j, i), long_names(i))
            call close_to(adf%statistic, long_statistic(j, i), tolerance, long_names(i))
            call agree([adf%p_value], [long_p(j, i)], tail_tolerance, long_names(i))
         end do
      end do
   end subroutine test_long

   !> Relative to the larger of 1 and the value.
   subroutine close_to(actual, expected, allowed, what)
      real(dp), intent(in) :: actual, expected, allowed
      character(*), intent(in) :: what

      call check(error, actual, expected, what, thr=allowed*max(1.0_dp, abs(expected)))
   end subroutine close_to

   !> The statistic from the full regression matrix by Householder reflections.
   function dense_statistic(x, terms, lags, valid) result(statistic)
      real(dp), intent(in) :: x(0:)
      integer, intent(in) :: terms, lags
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
   subroutine test_dense()
      integer, parameter :: length(4) = [60, 4097, 8200, 5001], lags(4) = [20, 3, 9, 60]
      type(adf_type) :: adf
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, j

      do i = 1, 4
         x = reference_series("quad", length(i))
         valid = [(1_int8, j=1, length(i))]
         do j = 1, 4
            call run_adf(x, adf_options(regression=regressions(j), lags=lags(i)), adf, problem)
            if (went_wrong(problem)) return
            call close_to(adf%statistic, dense_statistic(x, j - 1, lags(i), valid), 1.0e-11_dp, regressions(j))
         end do
      end do
   end subroutine test_dense

   !> With gaps: complete rows only, against the dense regression; what a gap holds does not matter;
   !> the lag is chosen so that rows are left.
   subroutine test_missing()
      type(adf_type) :: adf
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
            if (went_wrong(problem)) return
            call close_to(adf%statistic, dense_statistic(x, j - 1, 7, valid), 1.0e-11_dp, regressions(j))
         end do
         call run_adf(x, adf_options(), adf, problem, valid)
         if (went_wrong(problem, "the lag was not chosen")) return
         call close_to(adf%statistic, dense_statistic(x, 1, adf%lag, valid), 1.0e-11_dp, "chosen lag")
      end do
      valid = 1_int8
      x = reference_series("ar1", 1000)
      call run_adf(x, adf_options(), adf, problem, valid(:1000))
      call close_to(adf%statistic, -11.23935537241675_dp, tolerance, "all present")
   end subroutine test_missing

   !> Offset 2^40 and scale 2^-50, exact for multiples of 1/1024: the same lag and statistic.
   subroutine test_offset_scale()
      type(adf_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: j

      x = anint(1024.0_dp*reference_series("ar1_99", 6000))/1024.0_dp
      do j = 2, 4
         call run_adf(x, adf_options(regression=regressions(j)), a, problem)
         call run_adf((x + 2.0_dp**40)*2.0_dp**(-50), adf_options(regression=regressions(j)), b, problem)
         if (went_wrong(problem)) return
         call check(error, a%lag, b%lag)
         call close_to(b%statistic, a%statistic, 1.0e-11_dp, regressions(j))
         call check(error, b%noise_variance*2.0_dp**100, a%noise_variance, thr=1.0e-11_dp, &
            & rel=.true.)
      end do
      call run_adf(x, adf_options(regression="n"), a, problem)
      call run_adf(-x*2.0_dp**100, adf_options(regression="n"), b, problem)
      call close_to(b%statistic, a%statistic, tolerance, "n")
   end subroutine test_offset_scale

   !> 1e6 + 1e-3 ar1: the doubles hold 7 digits of the signal, and so does the statistic.
   subroutine test_large_offset()
      type(adf_type) :: adf
      integer :: j

      do j = 2, 4
         call run_adf(1.0e6_dp + 1.0e-3_dp*reference_series("ar1", 1000), adf_options(regression=regressions(j)), adf, problem)
         if (went_wrong(problem)) return
         call check(error, adf%lag, 5)
         call close_to(adf%statistic, exact_statistic(5, j, 5), 1.0e-7_dp, regressions(j))
      end do
   end subroutine test_large_offset

   !> One and two threads give the same bits.
   subroutine test_threads()
      type(adf_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: before

      x = reference_series("ar1", 70000)
      before = thread_count()
      call set_thread_count(1)
      call run_adf(x, adf_options(max_lags=10), a, problem)
      call set_thread_count(2)
      call run_adf(x, adf_options(max_lags=10), b, problem)
      call set_thread_count(before)
      if (went_wrong(problem)) return
      call check(error, a%statistic, b%statistic, thr=tiny(x))
   end subroutine test_threads

   !> The verdict is the right way round.
   subroutine test_verdict()
      type(adf_type) :: adf

      call run_adf(reference_series("ar1", 1000), adf_options(), adf, problem)
      call check(error, adf%stationary .and. adf%p_value < 0.01_dp, "AR(1) is stationary")
      call run_adf(reference_series("rw", 1000), adf_options(), adf, problem)
      call check(error, .not. adf%stationary .and. adf%p_value > 0.1_dp, "a random walk is not")
   end subroutine test_verdict

   !> ceiling(12 (n/100)^(1/4)), less for short series and for gaps.
   subroutine test_most_lags()
      integer(int64), parameter :: length(6) = [1000_int64, 12000_int64, 100000000_int64, 20_int64, 4_int64, 100_int64]
      integer, parameter :: terms(6) = [1, 1, 1, 1, 3, 1], asked(6) = [-1, -1, -1, -1, -1, 70]
      integer(int8) :: valid(1000)
      integer :: most(6), wanted(6), i

      do i = 1, 6
         call default_max_lags(length(i), terms(i), asked(i), most(i), wanted(i))
      end do
      call check(error, all(most == [22, 40, 380, 8, 0, 48]) .and. all(wanted == [22, 40, 380, 9, 6, 70]), "most lags")
      valid = 1_int8
      valid(10::10) = 0_int8
      call default_max_lags(1000_int64, 1, -1, most(1), wanted(1), valid)
      call check(error, most(1) == 7 .and. wanted(1) == 22, "most lags with gaps")
   end subroutine test_most_lags

   !> The lag is chosen for every series that lag 0 can be tested of: the most lags leave more rows than regressors.
   subroutine test_short()
      real(dp) :: x(30)
      integer(int8) :: valid(30)
      type(adf_type) :: adf
      integer :: n, i

      x = reference_series("wn", 30)
      valid = [(int(merge(0, 1, mod(i, 7) == 4), int8), i=1, 30)]
      do n = 6, 30
         call run_adf(x(:n), adf_options(regression="n"), adf, problem)
         if (.not. allocated(problem) .and. n >= 9) call run_adf(x(:n), adf_options(), adf, problem, valid(:n))
         if (went_wrong(problem, "a short series, or one with gaps, is tested with fewer lags")) return
      end do
      call run_adf(x(:8), adf_options(regression="n", lags=3), adf, problem)
      if (unmet(allocated(problem), "4 rows are too few for 4 regressors")) return
      call check(error, index(problem%message, "there are 4") > 0, "the number of rows is reported: "//problem%message)
   end subroutine test_short

   !> Constant, perfect line, perfect prediction: a status, no number.
   subroutine test_degenerate()
      real(dp) :: x(200)
      integer :: i

      x = 1234.1_dp
      call refused(x, adf_options(), status%constant_input)
      x = [(1.1_dp + 0.1_dp*real(i, dp), i=1, 200)]
      call refused(x, adf_options(regression="ct"), status%constant_input)
      call refused(x, adf_options(), status%singular)
      x = [(sin(real(i, dp)), i=1, 200)]
      call refused(x, adf_options(lags=4), status%singular)
      x = [(real(2*mod(i, 2) - 1, dp), i=1, 200)]
      call refused(x, adf_options(lags=0), status%singular)
   end subroutine test_degenerate

   !> Each other error.
   subroutine test_failures()
      real(dp) :: x(30)
      integer(int8) :: valid(30)

      x = reference_series("wn", 30)
      valid = 1_int8
      valid(3::4) = 0_int8
      call refused(x, adf_options(regression="tc"), status%invalid_argument)
      call refused(x, adf_options(criterion="fpe"), status%invalid_argument)
      call refused(x, adf_options(lags=-2), status%invalid_argument)
      call refused(x, adf_options(lags=14), status%too_few_samples)
      call refused(x, adf_options(lags=29), status%too_few_samples)
      call refused(x, adf_options(lags=huge(1)), status%too_few_samples)
      call refused(x(:4), adf_options(), status%too_few_samples)
      call refused(x, adf_options(lags=4), status%too_few_samples, valid)
      call refused(x, adf_options(), status%invalid_argument, valid(:7))
      valid = 0_int8
      call refused(x, adf_options(), status%too_few_samples, valid)
   end subroutine test_failures

   !> Fails unless the test is refused with the code.
   subroutine refused(x, options, code, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(adf_options), intent(in) :: options
      integer, intent(in) :: code
      integer(int8), intent(in), optional :: valid(:)
      type(adf_type) :: adf

      call run_adf(x, options, adf, problem, valid)
      call check_refused(problem, code)
   end subroutine refused

end module test_adf
