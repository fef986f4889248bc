! SPDX-License-Identifier: MIT
!> Tests of the noise coefficients and of the non-negative least squares beneath them.
module test_allan_noise_fit
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_fit_uncertainty, only : draw_estimates
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : model_variance
   use gyroakf_lapack, only : dsyev
   use gyroakf_allan_nonnegative, only : solve_columns, solve_nonnegative
   use allan_series, only : flicker_of, nbs14_long, normal_series, uniform_series, walk_of
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_noise_fit

contains

   !> The tests of this suite.
   subroutine collect_allan_noise_fit(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("nonnegative_small", test_nonnegative_small), &
         & new_unittest("nonnegative_search", test_nonnegative_search), &
         & new_unittest("noise_free_linear", test_noise_free_linear), &
         & new_unittest("noise_free_log", test_noise_free_log), &
         & new_unittest("single_point", test_single_point), &
         & new_unittest("white_records", test_white_records), &
         & new_unittest("mixture", test_mixture), &
         & new_unittest("gaps", test_gaps), &
         & new_unittest("log_and_linear", test_log_and_linear), &
         & new_unittest("scale", test_scale), &
         & new_unittest("covariance", test_covariance), &
         & new_unittest("correlation_of_records", test_correlation_of_records), &
         & new_unittest("chosen_alone", test_chosen_alone), &
         & new_unittest("walk_alone", test_walk_alone), &
         & new_unittest("coverage", test_coverage), &
         & new_unittest("bad_fit", test_bad_fit), &
         & new_unittest("dense_curve", test_dense_curve), &
         & new_unittest("limits_of_curve", test_limits_of_curve), &
         & new_unittest("held_at_zero", test_held_at_zero), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_allan_noise_fit

   subroutine test_nonnegative_small(error)
      type(error_type), allocatable, intent(out) :: error

      ! the free solution is (2, -1); with x2 = 0 the best x1 is 1.5
      real(dp), parameter :: a(2, 2) = reshape([1.0_dp, 0.0_dp, 0.5_dp, 1.0_dp], [2, 2])
      real(dp), parameter :: b(2) = [1.5_dp, -1.0_dp]
      real(dp) :: x(2)
      logical :: converged

      call solve_nonnegative(a, b, x, converged)
      call check(error, converged)
      if (allocated(error)) return
      call check(error, norm2(x - [1.5_dp, 0.0_dp]), 0.0_dp, thr=1.0e-14_dp)
   end subroutine test_nonnegative_small

   subroutine test_nonnegative_search(error)
      type(error_type), allocatable, intent(out) :: error

      ! against the best of all 2**5 sets of free unknowns
      integer, parameter :: rows = 8, columns = 5, problems = 100
      real(dp) :: a(rows, columns), b(rows), x(columns), y(columns), u(rows*(columns + 1)), best
      logical :: converged, fine
      integer :: problem, set, j

      do problem = 1, problems
         u = uniform_series(size(u, kind=int64), int(problem*1000003, int64))
         a = reshape(u(:rows*columns), [rows, columns])
         b = u(rows*columns + 1:) - 0.3_dp
         call solve_nonnegative(a, b, x, converged)
         call check(error, converged .and. all(x >= 0))
         if (allocated(error)) return
         best = norm2(b)
         do set = 1, 2**columns - 1
            call solve_columns(a, b, [(btest(set, j), j=0, columns - 1)], y, fine)
            if (fine .and. all(y >= 0)) best = min(best, norm2(b - matmul(a, y)))
         end do
         call check(error, norm2(b - matmul(a, x)), best, thr=1.0e-12_dp)
         if (allocated(error)) return
      end do
   end subroutine test_nonnegative_search

   !> A curve that is the model itself, at 1, 2, 4 ... samples of 0.01 s.
   subroutine synthetic_curve(coefficient, points, samples, curve)
      !> Q N B K R
      real(dp), intent(in) :: coefficient(5)
      integer, intent(in) :: points
      integer(int64), intent(in) :: samples
      !> The curve, edf as if by rule of thumb
      type(allan_curve_type), intent(out) :: curve

      integer :: i

      curve%sample_interval = 0.01_dp
      curve%samples = samples
      curve%m = [(2_int64**i, i=0, points - 1)]
      curve%terms = samples - 2*curve%m + 1
      curve%tau = curve%sample_interval*curve%m
      curve%deviation = [(sqrt(model_variance(coefficient**2, curve%tau(i))), i=1, points)]
      curve%edf = real(samples, dp)/curve%m
      curve%lower = curve%deviation
      curve%upper = curve%deviation
   end subroutine synthetic_curve

   !> Fails unless the coefficients come back from a synthetic curve.
   subroutine expect_recovery(error, method, samples)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> Method of the fit
      character(*), intent(in) :: method
      integer(int64), intent(in) :: samples

      real(dp), parameter :: truth(5) = [0.02_dp, 1.5_dp, 0.4_dp, 0.03_dp, 2.0e-4_dp]
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: i

      options%method = method
      call synthetic_curve(truth, 21, samples, curve)
      call fit_noise(curve, options, noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      do i = 1, 5
         call check(error, noise%coefficient(i)%value, truth(i), thr=1.0e-6_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, noise%coefficient(i)%detected .and. noise%coefficient(i)%fitted, "a term was not detected")
         if (allocated(error)) return
      end do
      call check(error, maxval(abs(noise%model/curve%deviation - 1)) < 1.0e-6_dp, "the model is not the curve")
   end subroutine expect_recovery

   subroutine test_noise_free_linear(error)
      type(error_type), allocatable, intent(out) :: error

      call expect_recovery(error, "linear", 10000000000_int64)
   end subroutine test_noise_free_linear

   subroutine test_noise_free_log(error)
      type(error_type), allocatable, intent(out) :: error

      ! so long that the logarithms have no bias worth mentioning (1/edf)
      call expect_recovery(error, "log", 1000000000000000_int64)
   end subroutine test_noise_free_log

   subroutine test_single_point(error)
      type(error_type), allocatable, intent(out) :: error

      ! one variance of white noise, one unknown: N^2 has the variance's own relative error sqrt(2/edf), N half of it
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure

      options%terms = "N"
      options%method = "linear"
      options%tau_min = 0.05_dp
      options%tau_max = 0.1_dp
      call synthetic_curve([0.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 10, 100000_int64, curve)
      call fit_noise(curve, options, noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      call check(error, noise%points, 1)
      if (allocated(error)) return
      call check(error, noise%coefficient(2)%value, 2.0_dp, thr=1.0e-12_dp)
      if (allocated(error)) return
      call check(error, noise%coefficient(2)%std_error, sqrt(2/curve%edf(4))*2/2, thr=1.0e-10_dp)
      if (allocated(error)) return
      call check(error, all([noise%coefficient([1, 3, 4, 5])%fitted] .eqv. .false.), "only N was fitted")
   end subroutine test_single_point

   !> Fits a record; on failure of the library the test fails.
   subroutine fit_record(error, rate, interval, options, curve, noise, valid)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> The record
      real(dp), intent(in), contiguous :: rate(:)
      real(dp), intent(in) :: interval
      type(noise_options), intent(in) :: options
      !> Results
      type(allan_curve_type), intent(out) :: curve
      type(noise_type), intent(out) :: noise
      !> Missing samples
      integer(int8), intent(in), optional :: valid(:)

      type(allan_options) :: grid
      type(gyro_error), allocatable :: failure

      if (present(valid)) then
         call compute_allan(rate, interval, grid, curve, failure, valid)
      else
         call compute_allan(rate, interval, grid, curve, failure)
      end if
      if (.not. allocated(failure)) call fit_noise(curve, options, noise, failure)
      if (allocated(failure)) call check(error, .false., failure%message)
   end subroutine fit_record

   subroutine test_white_records(error)
      type(error_type), allocatable, intent(out) :: error

      ! 100 records: N right on the average, its stated error right within the 20 % that 100 records can show,
      ! other terms detected in a few records only, chi-square as it should be
      integer, parameter :: records = 100
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp) :: value(records), stated(records), chi2(records), spread
      integer :: i, false_alarms

      false_alarms = 0
      do i = 1, records
         call fit_record(error, 3*normal_series(4000_int64, int(i*7777, int64)), 0.01_dp, options, curve, noise)
         if (allocated(error)) return
         value(i) = noise%coefficient(2)%value/0.3_dp
         stated(i) = noise%coefficient(2)%std_error/0.3_dp
         chi2(i) = noise%chi2_reduced
         if (any(noise%coefficient([1, 3, 4, 5])%detected)) false_alarms = false_alarms + 1
      end do
      spread = sqrt(sum((value - sum(value)/records)**2)/(records - 1))
      call check(error, sum(value)/records, 1.0_dp, thr=0.02_dp)
      if (allocated(error)) return
      call check(error, sqrt(sum(stated**2)/records)/spread, 1.05_dp, thr=0.25_dp)
      if (allocated(error)) return
      call check(error, sum(chi2)/records, 1.0_dp, thr=0.25_dp)
      if (allocated(error)) return
      call check(error, false_alarms <= 10, "too many terms that are not there")
   end subroutine test_white_records

   !> N = 1, B = 0.1, K = 0.01 at unit interval.
   function mixed_record(n) result(rate)
      !> Samples
      integer, intent(in) :: n
      real(dp) :: rate(n)

      rate = normal_series(int(n, int64), 582047321_int64) + 0.1_dp*flicker_of(normal_series(int(n, int64), 1190275313_int64)) &
         & + 0.01_dp*walk_of(normal_series(int(n, int64), 90721183_int64), normal_series(int(n, int64), 1733921041_int64))
   end function mixed_record

   subroutine test_mixture(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp), parameter :: truth(3) = [1.0_dp, 0.1_dp, 0.01_dp]
      integer :: i

      options%terms = "KBN"
      call fit_record(error, mixed_record(20000), 1.0_dp, options, curve, noise)
      if (allocated(error)) return
      do i = 1, 3
         associate (c => noise%coefficient(i + 1))
            call check(error, abs(c%value - truth(i)) < 3*c%std_error, "a coefficient is off by three standard errors")
            if (allocated(error)) return
            call check(error, c%upper_limit > c%value, "limit")
         end associate
         if (allocated(error)) return
      end do
      call check(error, noise%coefficient(2)%detected .and. noise%coefficient(4)%detected, "N and K are there")
      if (allocated(error)) return
      call check(error, noise%coefficient(2)%std_error < 0.01_dp, "N is known to 1 %")
   end subroutine test_mixture

   subroutine test_gaps(error)
      type(error_type), allocatable, intent(out) :: error

      ! 0.3 % and 5 % of the samples lost at random leave every coefficient within one standard error
      integer, parameter :: n = 20000
      real(dp), parameter :: share(2) = [0.003_dp, 0.05_dp]
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: whole, part
      integer(int8) :: valid(n)
      real(dp) :: rate(n)
      integer :: i, j

      options%terms = "NBK"
      rate = mixed_record(n)
      call fit_record(error, rate, 1.0_dp, options, curve, whole)
      if (allocated(error)) return
      do i = 1, 2
         valid = merge(0_int8, 1_int8, uniform_series(int(n, int64), 271828_int64) < share(i))
         call fit_record(error, merge(rate, 1.0e9_dp, valid == 1), 1.0_dp, options, curve, part, valid)
         if (allocated(error)) return
         do j = 2, 4
            call check(error, abs(part%coefficient(j)%value - whole%coefficient(j)%value) < whole%coefficient(j)%std_error, &
               & "a coefficient moved")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_gaps

   subroutine test_log_and_linear(error)
      type(error_type), allocatable, intent(out) :: error

      ! where the degrees of freedom are many the two methods agree within a tenth of a standard error
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: logarithmic, linear
      real(dp) :: rate(100000)
      integer :: j

      options%terms = "NK"
      options%tau_max = 256
      rate = normal_series(100000_int64, 582047321_int64) &
         & + 0.05_dp*walk_of(normal_series(100000_int64, 90721183_int64), normal_series(100000_int64, 1733921041_int64))
      call fit_record(error, rate, 1.0_dp, options, curve, logarithmic)
      if (allocated(error)) return
      options%method = "linear"
      call fit_record(error, rate, 1.0_dp, options, curve, linear)
      if (allocated(error)) return
      do j = 2, 4, 2
         call check(error, logarithmic%coefficient(j)%value, linear%coefficient(j)%value, &
            & thr=0.1_dp*linear%coefficient(j)%std_error)
         if (allocated(error)) return
      end do
   end subroutine test_log_and_linear

   subroutine test_scale(error)
      type(error_type), allocatable, intent(out) :: error

      ! rates in another unit and seconds of another length: every number moves as its unit says
      real(dp), parameter :: power(5) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp], unit = 1.0e-12_dp, second = 0.002_dp
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: plain, scaled
      integer :: j

      call fit_record(error, mixed_record(5000), 1.0_dp, options, curve, plain)
      if (allocated(error)) return
      call fit_record(error, unit*mixed_record(5000), second, options, curve, scaled)
      if (allocated(error)) return
      do j = 1, 5
         call check(error, scaled%coefficient(j)%value, plain%coefficient(j)%value*unit*second**power(j), thr=1.0e-6_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, scaled%coefficient(j)%std_error, plain%coefficient(j)%std_error*unit*second**power(j), &
            & thr=1.0e-6_dp, rel=.true.)
         if (allocated(error)) return
      end do
      call check(error, scaled%chi2_reduced, plain%chi2_reduced, thr=1.0e-6_dp, rel=.true.)
   end subroutine test_scale

   subroutine test_covariance(error)
      type(error_type), allocatable, intent(out) :: error

      ! a covariance it is, of what was fitted, and moves with the units
      real(dp), parameter :: power(5) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp], unit = 1.0e-3_dp, second = 0.01_dp
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: plain, scaled
      real(dp) :: correlation(5, 5), value(5), work(100)
      integer :: i, j, info

      call fit_record(error, mixed_record(5000), 1.0_dp, options, curve, plain)
      if (allocated(error)) return
      call fit_record(error, unit*mixed_record(5000), second, options, curve, scaled)
      if (allocated(error)) return
      associate (c => plain%covariance, s => plain%coefficient%std_error)
         call check(error, all(abs(c - transpose(c)) <= 0) .and. all(s > 0), "it is symmetric")
         if (allocated(error)) return
         do j = 1, 5
            call check(error, c(j, j), s(j)**2, thr=1.0e-14_dp, rel=.true.)
            if (allocated(error)) return
            correlation(:, j) = c(:, j)/(s*s(j))
            do i = 1, 5
               call check(error, scaled%covariance(i, j)/(unit**2*second**(power(i) + power(j))*s(i)*s(j)), correlation(i, j), &
                  & thr=1.0e-6_dp)
               if (allocated(error)) return
            end do
         end do
      end associate
      call dsyev("N", "U", 5, correlation, 5, value, work, size(work), info)
      call check(error, info == 0 .and. value(1) > -1.0e-12_dp .and. value(5) > 1.2_dp, "no direction has a negative variance")
      if (allocated(error)) return
      options%terms = "NK"
      call fit_record(error, mixed_record(5000), 1.0_dp, options, curve, plain)
      if (allocated(error)) return
      call check(error, count(abs(plain%covariance) > 0) == 4 .and. abs(plain%covariance(2, 4)) > 0, "terms that were not fitted")
   end subroutine test_covariance

   subroutine test_correlation_of_records(error)
      type(error_type), allocatable, intent(out) :: error

      ! estimates of many records correlate as each of them says: Q with N, and N with K
      integer, parameter :: records = 200, samples = 2000, pair(2, 2) = reshape([1, 2, 2, 4], [2, 2])
      character(2), parameter :: terms(2) = ["QN", "NK"]
      real(dp), parameter :: walk = 0.05_dp
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp) :: g(3*samples), rate(samples), x(records, 2), stated, measured, d(records, 2)
      integer :: i, k

      do k = 1, 2
         options%terms = terms(k)
         stated = 0
         do i = 1, records
            g = normal_series(size(g, kind=int64), int(7919*i + k, int64))
            rate = g(:samples)
            if (k == 1) rate = rate + g(samples + 2:2*samples + 1) - g(samples + 1:2*samples)
            if (k == 2) rate = rate + walk*walk_of(g(samples + 1:2*samples), g(2*samples + 1:))
            call fit_record(error, rate, 1.0_dp, options, curve, noise)
            if (allocated(error)) return
            x(i, :) = noise%coefficient(pair(:, k))%value
            stated = stated + noise%covariance(pair(1, k), pair(2, k))/ &
               & product(noise%coefficient(pair(:, k))%std_error)/records
         end do
         d = x - spread(sum(x, dim=1)/records, 1, records)
         measured = dot_product(d(:, 1), d(:, 2))/(norm2(d(:, 1))*norm2(d(:, 2)))
         call check(error, stated < -0.1_dp, "they pull at each other")
         if (allocated(error)) return
         ! standard error of a correlation of normal pairs: (1 - rho**2)/sqrt(records)
         call check(error, abs(measured - stated) < 4*(1 - stated**2)/sqrt(real(records, dp)), &
            & "the correlation of records is another")
         if (allocated(error)) return
      end do
   end subroutine test_correlation_of_records

   subroutine test_chosen_alone(error)
      type(error_type), allocatable, intent(out) :: error

      ! terms that are not there change neither value nor error of the one that is; the curve is the sum of the values
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: all_terms, two, alone
      real(dp) :: rate(3000)

      rate = normal_series(size(rate, kind=int64), 4711_int64)
      call fit_record(error, rate, 0.5_dp, options, curve, all_terms)
      options%terms = "NB"
      if (.not. allocated(error)) call fit_record(error, rate, 0.5_dp, options, curve, two)
      options%terms = "N"
      if (.not. allocated(error)) call fit_record(error, rate, 0.5_dp, options, curve, alone)
      if (allocated(error)) return
      call check(error, count(all_terms%coefficient%detected) == 1 .and. all(all_terms%coefficient%fitted), "N alone is there")
      if (allocated(error)) return
      associate (n => all_terms%coefficient(2), hidden => all_terms%coefficient([1, 3, 4, 5]), b => all_terms%coefficient(3))
         call check(error, abs(n%value/alone%coefficient(2)%value - 1) < 1e-9_dp, "the value is another")
         if (allocated(error)) return
         call check(error, abs(n%std_error/alone%coefficient(2)%std_error - 1) < 1e-9_dp, "the error is another")
         if (allocated(error)) return
         call check(error, all(hidden%value <= 0 .and. hidden%std_error > 0 .and. hidden%upper_limit > 0), "a limit, no value")
         if (allocated(error)) return
         call check(error, maxval(abs(all_terms%model*sqrt(curve%tau)/n%value - 1)) < 1e-9_dp, "the curve is another")
         if (allocated(error)) return
         call check(error, b%upper_limit >= two%coefficient(3)%upper_limit*(1 - 1e-9_dp), &
            & "a limit that further terms make lower")
      end associate
   end subroutine test_chosen_alone

   subroutine test_walk_alone(error)
      type(error_type), allocatable, intent(out) :: error

      ! 100 random walks: the curve is steep at its short end, where Q and N are chosen in two of three records; the fit of all
      ! terms has too little of them for a claim
      integer, parameter :: records = 100
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp) :: g(2000)
      integer :: i, claimed(5)

      claimed = 0
      do i = 1, records
         g = normal_series(size(g, kind=int64), int(6007*i, int64))
         call fit_record(error, running_sum(g), 1.0_dp, options, curve, noise)
         if (allocated(error)) return
         claimed = claimed + merge(1, 0, noise%coefficient%detected)
      end do
      call check(error, claimed(4), records, "K is not found")
      if (allocated(error)) return
      call check(error, sum(claimed(:2)) <= 2, "Q and N are claimed, and are not there")

   contains

      !> A random walk.
      pure function running_sum(steps) result(x)
         real(dp), intent(in) :: steps(:)
         real(dp) :: x(size(steps))
         integer :: k

         x(1) = steps(1)
         do k = 2, size(x)
            x(k) = x(k - 1) + steps(k)
         end do
      end function running_sum

   end subroutine test_walk_alone

   subroutine test_coverage(error)
      type(error_type), allocatable, intent(out) :: error

      ! N and K of 300 records, all terms on offer: biases within 4 of their standard errors, intervals and limits cover what they
      ! say within 4 standard deviations of such a share (validation/monte_carlo has more records)
      integer, parameter :: records = 300, samples = 2000, term(2) = [2, 4]
      real(dp), parameter :: truth(2) = [1.0_dp, 0.05_dp], normal_68 = 0.6827_dp, normal_95 = 0.95_dp
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp) :: g(3*samples), size_of_error(records), limit(records)
      integer :: i, k
      real(dp) :: outcome(3, 2, records)

      do i = 1, records
         g = normal_series(size(g, kind=int64), int(7919*i, int64))
         call fit_record(error, truth(1)*g(:samples) + truth(2)*walk_of(g(samples + 1:2*samples), g(2*samples + 1:)), 1.0_dp, &
            & options, curve, noise)
         if (allocated(error)) return
         outcome(1, :, i) = noise%coefficient(term)%value
         outcome(2, :, i) = noise%coefficient(term)%std_error
         outcome(3, :, i) = noise%coefficient(term)%upper_limit
      end do
      do k = 1, 2
         size_of_error = (outcome(1, k, :) - truth(k))/outcome(2, k, :)
         limit = outcome(3, k, :)
         call check(error, abs(sum(size_of_error)/records) < 4/sqrt(real(records, dp)), "a bias")
         if (allocated(error)) return
         call check(error, abs(share(abs(size_of_error) < 1) - normal_68) < tolerance(normal_68), "one standard error")
         if (allocated(error)) return
         call check(error, abs(share(abs(size_of_error) < 1.96_dp) - normal_95) < tolerance(normal_95), "two standard errors")
         if (allocated(error)) return
         call check(error, abs(share(limit > truth(k)) - normal_95) < tolerance(normal_95), "the limit")
         if (allocated(error)) return
      end do

   contains

      !> Share of records.
      pure real(dp) function share(these)
         logical, intent(in) :: these(:)

         share = real(count(these), dp)/size(these)
      end function share

      !> Four standard deviations of a share.
      pure real(dp) function tolerance(probability)
         real(dp), intent(in) :: probability

         tolerance = 4*sqrt(probability*(1 - probability)/records)
      end function tolerance

   end subroutine test_coverage

   subroutine test_bad_fit(error)
      type(error_type), allocatable, intent(out) :: error

      ! an AR(1) bends the curve as no mixture of the five terms does; N of its long times is 1/(1 - phi) = 2
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp) :: rate(50000)
      integer :: i

      rate = normal_series(50000_int64, 8_int64)
      do i = 2, size(rate)
         rate(i) = 0.5_dp*rate(i - 1) + rate(i)
      end do
      options%terms = "QNBKR"
      call fit_record(error, rate, 1.0_dp, options, curve, noise)
      if (allocated(error)) return
      call check(error, noise%chi2_reduced > 10 .and. noise%misfit > 0.1_dp, "the bad fit shows")
      if (allocated(error)) return
      call check(error, noise%left_out == 0 .and. any(noise%conspicuous), &
         & "the points that spoil it")
      if (allocated(error)) return
      associate (n => noise%coefficient(2))
         call check(error, abs(n%value - 2) < 3*n%std_error .and. n%std_error > 0.05_dp, "N is stated as if it were known")
      end associate
   end subroutine test_bad_fit

   subroutine test_dense_curve(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_options) :: grid
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure

      grid%taus = "all"
      call compute_allan(nbs14_long(), 1.0_dp, grid, curve, failure)
      call fit_noise(curve, options, noise, failure)
      call check(error, .not. allocated(failure))
      if (allocated(error)) return
      call check(error, noise%points > 30 .and. noise%points <= 40, "a dense curve is thinned")
      if (allocated(error)) return
      call check(error, size(noise%model), 500)
      if (allocated(error)) return
      call check(error, all(curve%edf > 0.9_dp .and. curve%edf < 1000), "degrees of freedom")
      if (allocated(error)) return
      call check(error, abs(noise%coefficient(2)%value - 0.2884664_dp) < 3*noise%coefficient(2)%std_error, "N")
   end subroutine test_dense_curve

   subroutine test_limits_of_curve(error)
      type(error_type), allocatable, intent(out) :: error

      ! white noise: from m = 32 on the mixture's degrees of freedom are those of Greenhall & Riley; at m = 1 they are
      ! exactly (n - 1)/1.5, as the differences of neighbours have the correlation -1/2
      type(allan_curve_type) :: before, after
      type(allan_options) :: grid
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: i

      options%terms = "N"
      call compute_allan(nbs14_long(), 1.0_dp, grid, before, failure)
      after = before
      call fit_noise(after, options, noise, failure)
      do i = 6, 8
         call check(error, after%edf(i), before%edf(i), thr=0.05_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, after%upper(i), before%upper(i), thr=0.02_dp, rel=.true.)
         if (allocated(error)) return
      end do
      call check(error, after%edf(1), 999/1.5_dp, thr=0.01_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, all(after%lower < after%deviation .and. after%deviation < after%upper))
   end subroutine test_limits_of_curve

   !> Draws of unknowns that are held at zero are zero and not rounding, whose root would be seen in the standard errors.
   subroutine test_held_at_zero(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: rounding = 1e-12_dp
      real(dp) :: design(8, 3), covariance(8, 8), tau
      real(dp), allocatable :: estimates(:, :), unbounded(:, :)
      integer :: i

      covariance = 0
      do i = 1, 8
         tau = 2.0_dp**(i - 1)
         design(i, :) = [1/tau**2, 1/tau, tau]/(0.3_dp/tau**2 + 1/tau + 0.01_dp*tau)
         covariance(i, i) = 0.01_dp*tau
      end do
      do i = 1, 3
         design(:, i) = design(:, i)/norm2(design(:, i))
      end do
      call draw_estimates(design, [(1/covariance(i, i), i=1, 8)], covariance, [0.0_dp, 1.0_dp, 0.0_dp], 0, &
         & estimates, unbounded)
      call check(error, count(estimates <= 0) > 300, "few unknowns are held")
      if (allocated(error)) return
      call check(error, .not. any(estimates < 0), "a negative unknown")
      if (allocated(error)) return
      call check(error, .not. any(estimates > 0 .and. estimates < rounding), "rounding instead of zero")
   end subroutine test_held_at_zero

   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve, empty
      type(allan_options) :: grid
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: codes(6)

      call fit_noise(empty, options, noise, failure)
      codes(1) = failure%code
      call compute_allan([1.0_dp, 2.0_dp, 3.0_dp, 5.0_dp], 1.0_dp, grid, curve, failure)
      options%terms = "QNX"
      call fit_noise(curve, options, noise, failure)
      codes(2) = failure%code
      options%terms = " "
      call fit_noise(curve, options, noise, failure)
      codes(3) = failure%code
      options%terms = "N"
      options%method = "cubic"
      call fit_noise(curve, options, noise, failure)
      codes(4) = failure%code
      options%method = "log"
      options%terms = "QNBKR"
      call fit_noise(curve, options, noise, failure)
      codes(5) = failure%code
      curve%deviation = 0
      options%terms = "N"
      call fit_noise(curve, options, noise, failure)
      codes(6) = failure%code
      call check(error, all(codes(:4) == status%invalid_argument), "invalid arguments")
      if (allocated(error)) return
      call check(error, codes(5), status%too_few_samples, "two averaging times for five terms")
      if (allocated(error)) return
      call check(error, codes(6), status%constant_input, "no variance")
   end subroutine test_failures

end module test_allan_noise_fit
