! SPDX-License-Identifier: MIT
!> Tests of what the Dickey-Fuller test gives beside its statistic: coefficients, shared autocovariances, the factor of the rows
!> where the sums of products have lost their digits, lags that are capped, progress.
module test_adf_table
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_lapack, only : dgels, dtrtrs
   use progress_watch, only : watch_type
   use gyroakf_stats_autocovariance, only : autocovariance_type, compute_autocovariance, &
      & plan_autocovariance, need_autocovariance
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_series_adf, only : adf_options, adf_type, run_adf => test_adf
   use series_library, only : reference_series
   use expectations, only : unmet, problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_adf_table

   character(3), parameter :: regressions(4) = [character(3) :: "n", "c", "ct", "ctt"]

contains

   subroutine suite_adf_table()
      call test("by_hand", test_by_hand)
      call test("dense", test_dense)
      call test("offset", test_offset)
      call test("only_when_asked", test_only_when_asked)
      call test("shared", test_shared)
      call test("shared_alone", test_shared_alone)
      call test("rows", test_rows)
      call test("perfect", test_perfect)
      call test("many_gaps", test_many_gaps)
      call test("capped", test_capped)
      call test("non_finite", test_non_finite)
      call test("cancel", test_cancel)
   end subroutine suite_adf_table

   !> x = 0 1 0 2 1 3, no lags, constant: d = 1 -1 2 -1 2 on levels 0 1 0 2 1: slope (sum dl - 5 mean mean)/(sum ll - ...)
   !> = (-2 - 2.4)... level mean 0.8, d mean 0.6; Sll = 6 - 3.2 = 2.8, Sld = -1 - 2.4 + 2 = -1.4 => -0.5, constant 1.
   subroutine test_by_hand()
      type(adf_type) :: adf
      real(dp), parameter :: x(6) = [0.0_dp, 1.0_dp, 0.0_dp, 2.0_dp, 1.0_dp, 3.0_dp]
      real(dp) :: d(5), l(5), slope, constant, rss

      d = x(2:) - x(:5)
      l = x(:5)
      slope = (dot_product(d, l) - sum(d)*sum(l)/5.0_dp)/(dot_product(l, l) - sum(l)**2/5.0_dp)
      constant = (sum(d) - slope*sum(l))/5.0_dp
      rss = sum((d - constant - slope*l)**2)/3.0_dp
      call run_adf(x, adf_options(lags=0, table=.true.), adf, problem)
      if (went_wrong(problem)) return
      call check(error, adf%table(1)%name == "constant" .and. adf%table(2)%name == "level", "names")
      call check(error, maxval(abs(adf%table(:)%value - [constant, slope])), 0.0_dp, thr=1.0e-14_dp)
      call check(error, adf%table(2)%std_error, sqrt(rss/(dot_product(l, l) - sum(l)**2/5.0_dp)), thr=1.0e-14_dp)
      call check(error, adf%table(1)%std_error, sqrt(rss*(0.2_dp + (sum(l)/5.0_dp)**2 &
         & /(dot_product(l, l) - sum(l)**2/5.0_dp))), thr=1.0e-14_dp)
   end subroutine test_by_hand

   !> Coefficients and standard errors of the regression in the user's own columns: 1, s, s^2 with s = 1, 2, ..., level, lags.
   subroutine solve_dense(x, terms, lags, valid, value, std_error)
      real(dp), intent(in) :: x(0:)
      integer, intent(in) :: terms, lags
      integer(int8), intent(in) :: valid(0:)
      real(dp), allocatable, intent(out) :: value(:), std_error(:)
      real(dp), allocatable :: a(:, :), b(:, :), inverse(:, :), work(:)
      integer :: t, j, m, k, info

      k = terms + lags + 1
      allocate (a(size(x), k), b(size(x), 1), work(200*k), value(k), std_error(k))
      m = 0
      do t = lags + 1, size(x) - 1
         if (any(valid(t - lags - 1:t) == 0_int8)) cycle
         m = m + 1
         b(m, 1) = x(t) - x(t - 1)
         a(m, :terms) = [(real(t - lags, dp)**(j - 1), j=1, terms)]
         a(m, terms + 1:) = [x(t - 1), (x(t - j) - x(t - j - 1), j=1, lags)]
      end do
      call dgels("N", m, k, 1, a, size(x), b, size(x), work, size(work), info)
      value = b(:k, 1)
      allocate (inverse(k, k), source=0.0_dp)
      do j = 1, k
         inverse(j, j) = 1
      end do
      call dtrtrs("U", "T", "N", k, k, a, size(x), inverse, k, info)
      do j = 1, k
         std_error(j) = norm2(inverse(:, j))*sqrt(sum(b(k + 1:m, 1)**2)/real(m - k, dp))
      end do
   end subroutine solve_dense

   !> Against the dense regression: a slope, a length where the trend is looked at roughly, gaps. 1e-9: the columns 1, s, s^2
   !> of the dense one cost it digits.
   subroutine test_dense()
      integer, parameter :: length(3) = [300, 4500, 9001], lags(3) = [4, 9, 2]
      real(dp), parameter :: allowed = 1.0e-9_dp
      type(adf_type) :: adf
      real(dp), allocatable :: x(:), value(:), std_error(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, j

      do i = 1, 3
         x = reference_series("quad", length(i))
         valid = [(1_int8, j=1, length(i))]
         if (i > 1) valid(100:200:7) = 0_int8
         where (valid == 0_int8) x = 0.0_dp
         do j = 1, 4
            call solve_dense(x, j - 1, lags(i), valid, value, std_error)
            if (i == 1) call run_adf(x, adf_options(regressions(j), lags(i), table=.true.), adf, problem)
            if (i > 1) call run_adf(x, adf_options(regressions(j), lags(i), table=.true.), adf, problem, valid)
            if (went_wrong(problem)) return
            call check(error, maxval(abs(adf%table%value - value)/std_error), 0.0_dp, thr=allowed)
            call check(error, maxval(abs(adf%table%std_error/std_error - 1.0_dp)), 0.0_dp, thr=allowed)
            call check(error, maxval(abs(adf%table%t - value/std_error)), 0.0_dp, thr=1.0e-7_dp)
         end do
         call check(error, adf%table(4)%t, adf%statistic, thr=1.0e-10_dp)
         call check(error, adf%table(3)%name == "time^2" .and. adf%table(4)%name == "level" .and. adf%table(6)%name == "lag 2")
      end do
   end subroutine test_dense

   !> x + c: the constant is less by rho c, all else stays.
   subroutine test_offset()
      type(adf_type) :: a, b
      real(dp), parameter :: c = 1048576.0_dp
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar1", 2000))/1024.0_dp
      call run_adf(x, adf_options("ct", 3, table=.true.), a, problem)
      call run_adf(x + c, adf_options("ct", 3, table=.true.), b, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(a%table(2:)%value - b%table(2:)%value)), 0.0_dp, thr=1.0e-12_dp)
      call check(error, b%table(1)%value, a%table(1)%value - c*a%level, thr=1.0e-7_dp)
      call check(error, maxval(abs(a%table(2:)%std_error/b%table(2:)%std_error - 1.0_dp)), 0.0_dp, thr=1.0e-11_dp)
   end subroutine test_offset

   !> Without the option there is no table.
   subroutine test_only_when_asked()
      type(adf_type) :: adf

      call run_adf(reference_series("ar1", 500), adf_options(), adf, problem)
      call check(error, .not. (allocated(problem) .or. allocated(adf%table)), &
         & "an unrequested table")
   end subroutine test_only_when_asked

   !> The autocovariances made on the way are those of a pass of their own: lengths around chunks, gaps, an offset; also where the
   !> test itself is refused.
   subroutine test_shared()
      integer, parameter :: length(4) = [60, 4097, 12289, 70001]
      type(autocovariance_type) :: shared
      type(moments_type) :: moments
      type(adf_type) :: adf
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, j

      do i = 1, 4
         x = 1.0e6_dp + 1.0e-3_dp*reference_series("ar1", length(i))
         valid = [(1_int8, j=1, length(i))]
         valid(5::23) = 0_int8
         call compute_moments(x, moments)
         call plan_autocovariance(shared, 20, moments%mean, moments%remainder)
         call run_adf(x, adf_options(), adf, problem, shared=shared)
         if (went_wrong(problem)) return
         call agree(x, shared)
         call compute_moments(x, moments, valid)
         call plan_autocovariance(shared, 20, moments%mean, moments%remainder)
         call run_adf(x, adf_options("n", 1), adf, problem, valid, shared)
         call agree(x, shared, valid)
      end do
      x = [(real(2*mod(i, 2) - 1, dp), i=1, 200)]
      call plan_autocovariance(shared, 3, 0.0_dp, 0.0_dp)
      call run_adf(x, adf_options(lags=0), adf, problem, shared=shared)
      if (unmet(allocated(problem), "a perfect fit was accepted")) return
      call agree(x, shared)
   end subroutine test_shared

   !> Fails unless both give the same.
   subroutine agree(x, shared, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(autocovariance_type), intent(in) :: shared
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean

      if (unmet(allocated(shared%r), "nothing is filled")) return
      call compute_autocovariance(x, shared%max_lag, mean, r, problem, valid, pairs)
      call check(error, maxval(abs(shared%r - r))/r(0), 0.0_dp, thr=1.0e-13_dp)
      call check(error, all(shared%pairs == pairs) .and. shared%samples == size(x, kind=int64), "pairs")
   end subroutine agree

   !> A pass of its own, its failures, and none where it is filled.
   subroutine test_shared_alone()
      type(autocovariance_type) :: shared
      type(moments_type) :: moments
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(3)

      x = reference_series("ar2", 70001)
      call compute_moments(x, moments)
      call need_autocovariance(x, shared, problem)
      call check(error, problem%code, status%invalid_argument)
      call plan_autocovariance(shared, 20, moments%mean, moments%remainder)
      call need_autocovariance(x(:20), shared, problem)
      call check(error, problem%code, status%too_few_samples)
      call need_autocovariance(x, shared, problem, valid)
      call check(error, problem%code, status%invalid_argument)
      call need_autocovariance(x, shared, problem)
      call agree(x, shared)
      call need_autocovariance(x(:1), shared, problem)
      call check(error, .not. allocated(problem) .and. shared%samples == 70001, "filled again")
   end subroutine test_shared_alone

   !> A ramp with noise of 1e-9 of its slope: the sums of products cannot see it, the rows can.
   subroutine test_rows()
      type(adf_type) :: adf
      real(dp), allocatable :: x(:), value(:), std_error(:)
      integer(int8), allocatable :: valid(:)
      integer :: i

      allocate (valid(900))
      valid = 1_int8
      x = [(real(2*i - 1, dp), i=1, 900)] + anint(reference_series("ar1", 900)*2.0_dp**10)*2.0_dp**(-40)
      call run_adf(x, adf_options("c", 2, table=.true.), adf, problem)
      if (went_wrong(problem, "the ramp was refused")) return
      ! from orthogonal columns in quadruple precision
      call check(error, adf%statistic, -0.128027682050915147_dp, thr=1.0e-12_dp)
      call solve_dense(x, 1, 2, valid, value, std_error)
      call check(error, adf%statistic, value(2)/std_error(2), thr=1.0e-4_dp)
      valid(300:310) = 0_int8
      call run_adf(x, adf_options("c", 2, table=.true.), adf, problem, valid)
      if (went_wrong(problem, "the ramp with a gap was refused")) return
      call solve_dense(x, 1, 2, valid, value, std_error)
      call check(error, adf%statistic, value(2)/std_error(2), thr=1.0e-4_dp)
   end subroutine test_rows

   !> 1, 3, 5, ...; the same with 1e-15 on it; a sinusoid without noise: refused, whatever the rounding.
   subroutine test_perfect()
      type(adf_type) :: adf
      real(dp), allocatable :: x(:)
      integer :: i, j

      do j = 1, 3
         x = [(real(2*i - 1, dp), i=1, 500)]
         if (j == 2) x = x*(1.0_dp + 1.0e-15_dp*reference_series("unif", 500))
         if (j == 3) x = 7.0_dp + sin(0.3_dp*x)
         call run_adf(x, adf_options(), adf, problem)
         call check_refused(problem, status%singular)
      end do
   end subroutine test_perfect

   !> So many gaps that the rows of the shorter regression take another pass (few lags less), or none.
   subroutine test_many_gaps()
      type(adf_type) :: adf
      real(dp), allocatable :: x(:), value(:), std_error(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, k, shorter

      x = reference_series("ar2", 9000)
      valid = [(1_int8, i=1, 9000)]
      valid(63::63) = 0_int8
      shorter = 0
      do k = 30, 52
         call run_adf(x, adf_options(max_lags=k, criterion="t"), adf, problem, valid)
         if (went_wrong(problem)) return
         if (adf%lag > 20 .and. adf%lag < k) shorter = shorter + 1
         call solve_dense(x, 1, adf%lag, valid, value, std_error)
         call check(error, adf%statistic, value(2)/std_error(2), thr=1.0e-11_dp)
      end do
      call check(error, shorter > 0, "no lag tests this")
   end subroutine test_many_gaps

   !> More lags are asked for than a short series has.
   subroutine test_capped()
      type(adf_type) :: adf

      call run_adf(reference_series("ar1", 100), adf_options("ctt", max_lags=huge(1)), adf, problem)
      if (went_wrong(problem)) return
      call check(error, adf%max_lags == 46 .and. adf%wanted_lags == huge(1) .and. adf%lag_chosen, "most lags")
      call run_adf(reference_series("ar1", 100), adf_options(lags=2), adf, problem)
      call check(error, adf%max_lags == 2 .and. adf%wanted_lags == 2 .and. .not. adf%lag_chosen, "given lags")
   end subroutine test_capped

   !> A value that is not finite is found wherever it stands.
   subroutine test_non_finite()
      type(adf_type) :: adf
      real(dp), allocatable :: x(:)

      x = reference_series("ar1", 9000)
      x(4321) = 1.0e200_dp
      call run_adf(x, adf_options(), adf, problem)
      call check_refused(problem, status%non_finite)
   end subroutine test_non_finite

   !> A long test can be cancelled.
   subroutine test_cancel()
      type(watch_type) :: watch
      type(adf_type) :: adf

      watch%last_call = 2
      call run_adf(reference_series("ar1", 140000), adf_options(), adf, problem, progress=watch)
      call check_refused(problem, status%cancelled)
   end subroutine test_cancel

end module test_adf_table
