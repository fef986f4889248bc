! SPDX-License-Identifier: MIT
!> Tests of the noise coefficients and of the nonnegative least squares beneath them.
module test_allan_noise_fit
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_fit_covariance, only : mixture_freedom
   use gyroakf_allan_fit_solver, only : solve_nonnegative
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : model_variance
   use allan_series, only : nbs14_long, normal_series, uniform_series, walk_of, not_fitted, &
      & mixed_record
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_allan_noise_fit

contains

   subroutine suite_allan_noise_fit()
      call test("nonnegative_small", test_nonnegative_small)
      call test("nonnegative_search", test_nonnegative_search)
      call test("reference", test_reference)
      call test("noise_free", test_noise_free)
      call test("single_point", test_single_point)
      call test("white_records", test_white_records)
      call test("heavy_tails", test_heavy_tails)
      call test("scale", test_scale)
      call test("covariance", test_covariance)
      call test("correlation_of_records", test_correlation_of_records)
      call test("chosen_alone", test_chosen_alone)
      call test("walk_alone", test_walk_alone)
      call test("coverage", test_coverage)
      call test("grids", test_grids)
      call test("limits_of_curve", test_limits_of_curve)
      call test("failures", test_failures)
   end subroutine suite_allan_noise_fit

   subroutine test_nonnegative_small()
      ! the free solution is (2, -1); with x2 = 0 the best x1 is 1.5
      real(dp), parameter :: a(2, 2) = reshape([1.0_dp, 0.0_dp, 0.5_dp, 1.0_dp], [2, 2])
      real(dp), parameter :: b(2) = [1.5_dp, -1.0_dp]
      real(dp) :: x(2)

      call solve_nonnegative(a, b, x, [.false., .false.])
      call check(error, norm2(x - [1.5_dp, 0.0_dp]), 0.0_dp, thr=1.0e-14_dp)
      call solve_nonnegative(a, b, x, [.false., .true.])
      call check(error, norm2(x - [2.0_dp, -1.0_dp]), 0.0_dp, thr=1.0e-14_dp)
   end subroutine test_nonnegative_small

   subroutine test_nonnegative_search()
      ! against the best of all 2**5 sets of free unknowns; in every other problem the first unknown may be negative
      integer, parameter :: rows = 8, columns = 5, problems = 100
      real(dp) :: a(rows, columns), b(rows), x(columns), u(rows*(columns + 1)), best
      real(dp), allocatable :: y(:)
      integer, allocatable :: place(:)
      logical :: signed(columns)
      integer :: problem, set, j

      do problem = 1, problems
         u = uniform_series(size(u, kind=int64), int(problem*1000003, int64))
         a = reshape(u(:rows*columns), [rows, columns])
         b = u(rows*columns + 1:) - 0.3_dp
         signed = [(j == 1 .and. mod(problem, 2) == 0, j=1, columns)]
         call solve_nonnegative(a, b, x, signed)
         call check(error, all(x >= 0 .or. signed))
         best = norm2(b)
         do set = 1, 2**columns - 1
            place = pack([(j, j=1, columns)], [(btest(set, j), j=0, columns - 1)])
            allocate (y(size(place)))
            call solve_nonnegative(a(:, place), b, y, spread(.true., 1, size(place)))
            if (all(y >= 0 .or. signed(place))) best = min(best, norm2(b - matmul(a(:, place), y)))
            deallocate (y)
         end do
         call check(error, norm2(b - matmul(a, x)), best, thr=1.0e-12_dp)
      end do
   end subroutine test_nonnegative_search

   subroutine test_reference()
      ! an independent implementation agrees on 20 records: white, Laplace, flicker, walk, quantization, low-pass, ramp
      integer, parameter :: records = 20
      character(8), parameter :: states(0:2) = [character(8) :: "withheld", "limit", "value"]
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: floor, kurtosis, chi_square, value(5), std_error(5), limit(5)
      integer :: unit, record, points, first, last, terms, state(5), i

      open (newunit=unit, file="validation/noise_fit.txt", status="old", action="read")
      do i = 1, 3
         read (unit, *)
      end do
      do record = 1, records
         read (unit, *) curve%samples, points, first, last, floor, kurtosis, chi_square, terms
         curve%m = [(2_int64**i, i=0, points - 1)]
         curve%octaves%m = curve%m
         curve%terms = curve%samples - 2*curve%m + 1
         curve%tau = real(curve%m, dp)
         curve%octaves%variance = curve%tau
         curve%octaves%kurtosis = curve%tau
         curve%octaves%share = 0*curve%tau + 1
         read (unit, *) curve%octaves%variance
         read (unit, *) curve%octaves%kurtosis
         read (unit, *) state
         read (unit, *) value
         read (unit, *) std_error
         read (unit, *) limit
         curve%share = curve%octaves%share
         curve%deviation = sqrt(curve%octaves%variance)
         curve%edf = 0*curve%tau + 1
         curve%lower = curve%deviation
         curve%upper = curve%deviation
         call fit_noise(curve, noise_options(stated_margin=2.0_dp), noise, failure)
         call check(error, .not. allocated(failure), "the fit failed")
         if (allocated(error)) exit
         call check(error, noise%left_out == first - 1 .and. noise%points == last - first + 1 .and. &
            & noise%chi2_freedom == noise%points - terms .and. abs(noise%floor - floor) <= 0 .and. &
            & all(noise%coefficient%state == states(state)), "the choice of points, floor and terms")
         if (allocated(error)) exit
         associate (c => noise%coefficient)
            call check(error, near(noise%kurtosis, kurtosis) .and. near(noise%chi2_reduced*noise%chi2_freedom, chi_square) &
               & .and. all(near(c%value, value) .or. state == 0) .and. all(near(c%std_error, std_error) .or. state == 0) &
               & .and. all(near(c%upper_limit, limit) .or. state /= 1), "the numbers")
         end associate
         if (allocated(error)) exit
      end do
      close (unit)

   contains

      !> Equal to 1e-8 of the second.
      elemental logical function near(a, b)
         real(dp), intent(in) :: a, b

         near = abs(a - b) <= 1.0e-8_dp*abs(b)
      end function near

   end subroutine test_reference

   !> A curve that is the model itself, at 1, 2, 4 ... samples of 0.01 s.
   subroutine synthetic_curve(coefficient, points, samples, curve)
      real(dp), intent(in) :: coefficient(5)
      integer, intent(in) :: points
      integer(int64), intent(in) :: samples
      type(allan_curve_type), intent(out) :: curve

      integer :: i

      curve%sample_interval = 0.01_dp
      curve%samples = samples
      curve%m = [(2_int64**i, i=0, points - 1)]
      curve%terms = samples - 2*curve%m + 1
      curve%tau = curve%sample_interval*curve%m
      curve%deviation = [(sqrt(model_variance(coefficient**2, curve%tau(i))), i=1, points)]
      curve%edf = real(samples, dp)/curve%m
      curve%share = 0*curve%tau + 1
      curve%octaves%m = curve%m
      curve%octaves%variance = curve%deviation**2
      curve%octaves%kurtosis = 0*curve%tau
      curve%octaves%share = curve%share
      curve%lower = curve%deviation
      curve%upper = curve%deviation
   end subroutine synthetic_curve

   subroutine test_white_records()
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
         if (not_fitted(3*normal_series(4000_int64, int(i*7777, int64)), 0.01_dp, options, curve, noise)) return
         value(i) = noise%coefficient(2)%value/0.3_dp
         stated(i) = noise%coefficient(2)%std_error/0.3_dp
         chi2(i) = noise%chi2_reduced
         if (any(noise%coefficient([1, 3, 4, 5])%detected)) false_alarms = false_alarms + 1
      end do
      spread = sqrt(sum((value - sum(value)/records)**2)/(records - 1))
      call check(error, sum(value)/records, 1.0_dp, thr=0.02_dp)
      call check(error, sqrt(sum(stated**2)/records)/spread, 1.05_dp, thr=0.25_dp)
      call check(error, sum(chi2)/records, 1.0_dp, thr=0.25_dp)
      call check(error, false_alarms <= 10, "too many terms that are not there")
   end subroutine test_white_records

   subroutine test_scale()
      ! rates in another unit and seconds of another length: every number moves as its unit says
      real(dp), parameter :: power(5) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp], unit = 1.0e-12_dp, second = 0.002_dp
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: plain, scaled
      integer :: j

      if (not_fitted(mixed_record(5000), 1.0_dp, options, curve, plain)) return
      if (not_fitted(unit*mixed_record(5000), second, options, curve, scaled)) return
      do j = 1, 5
         call check(error, scaled%coefficient(j)%value, plain%coefficient(j)%value*unit*second**power(j), thr=1.0e-6_dp, rel=.true.)
         call check(error, scaled%coefficient(j)%std_error, plain%coefficient(j)%std_error*unit*second**power(j), &
            & thr=1.0e-6_dp, rel=.true.)
      end do
      call check(error, scaled%chi2_reduced, plain%chi2_reduced, thr=1.0e-6_dp, rel=.true.)
   end subroutine test_scale

   subroutine test_correlation_of_records()
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
            if (not_fitted(rate, 1.0_dp, options, curve, noise)) return
            x(i, :) = noise%coefficient(pair(:, k))%value
            stated = stated + noise%covariance(pair(1, k), pair(2, k))/ &
               & product(noise%coefficient(pair(:, k))%std_error)/records
         end do
         d = x - spread(sum(x, dim=1)/records, 1, records)
         measured = dot_product(d(:, 1), d(:, 2))/(norm2(d(:, 1))*norm2(d(:, 2)))
         call check(error, stated < -0.1_dp, "they pull at each other")
         ! standard error of a correlation of normal pairs: (1 - rho**2)/sqrt(records)
         call check(error, abs(measured - stated) < 4*(1 - stated**2)/sqrt(real(records, dp)), &
            & "the correlation of records is another")
      end do
   end subroutine test_correlation_of_records

   subroutine test_walk_alone()
      ! 100 random walks: K in all of them, hardly anything else
      integer, parameter :: records = 100, samples = 2000
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: g(2*samples)
      integer :: i, claimed(5)

      claimed = 0
      do i = 1, records
         g = normal_series(size(g, kind=int64), int(6007*i, int64))
         if (not_fitted(walk_of(g(:samples), g(samples + 1:)), 1.0_dp, noise_options(), curve, noise)) return
         claimed = claimed + merge(1, 0, noise%coefficient%detected)
      end do
      call check(error, claimed(4) >= records - 2, "K is not found")
      call check(error, sum(claimed) - claimed(4) <= 5, "terms that are not there")
   end subroutine test_walk_alone

   subroutine test_noise_free()
      ! a record so long that its variances are their expectations
      real(dp), parameter :: truth(5) = [0.02_dp, 1.5_dp, 0.4_dp, 0.03_dp, 2.0e-4_dp]
      character(5), parameter :: terms(2) = ["auto ", "QNBKR"]
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      integer :: i

      do i = 1, 2
         call synthetic_curve(truth, 21, 1000000000000000_int64, curve)
         call fit_noise(curve, noise_options(terms(i)), noise, failure)
         if (unmet(.not. allocated(failure) .and. all(noise%coefficient%detected), "all terms are there")) return
         call check(error, maxval(abs(noise%coefficient%value/truth - 1)) < 1.0e-6_dp, "a value")
         call check(error, maxval(abs(noise%model/curve%deviation - 1)) < 1.0e-6_dp, "the model is not the curve")
      end do
   end subroutine test_noise_free

   subroutine test_single_point()
      ! one variance of white noise, one unknown: N^2 has the variance's own relative error sqrt(2/edf), N half of it; chi-square
      ! over its degrees of freedom is below 1 by the bias of its cube root, 2/(9 edf)
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      real(dp), parameter :: white(5) = [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      real(dp) :: edf(1)

      options = noise_options("N", tau_min=0.05_dp, tau_max=0.1_dp)
      call synthetic_curve([0.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 10, 100000_int64, curve)
      call fit_noise(curve, options, noise, failure)
      if (went_wrong(failure, "the fit failed")) return
      edf = mixture_freedom(100000_int64, [8_int64], white)
      call check(error, noise%points, 1)
      call check(error, noise%coefficient(2)%value, 2*(1 - 2/(9*edf(1)))**(-1.5_dp), thr=1.0e-9_dp)
      call check(error, noise%coefficient(2)%std_error, noise%coefficient(2)%value*sqrt(2/edf(1))/2, thr=1.0e-10_dp)
      call check(error, .not. any(noise%coefficient([1, 3, 4, 5])%fitted), "only N was fitted")
   end subroutine test_single_point

   subroutine test_heavy_tails()
      ! 100 records of Laplace noise, excess kurtosis 3: the stated error of N is that of the records; without the kurtosis it
      ! would be sqrt(1 + 2/3) times too small, at one sample
      integer, parameter :: records = 100
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: u(8000), value(records), stated, kurtosis, spread
      integer :: i

      stated = 0
      kurtosis = 0
      do i = 1, records
         u = 2*uniform_series(size(u, kind=int64), int(i*7777, int64)) - 1
         if (not_fitted(-sign(log(1 - abs(u)), u), 1.0_dp, noise_options(), curve, noise)) return
         value(i) = noise%coefficient(2)%value
         stated = stated + noise%coefficient(2)%std_error/records
         kurtosis = kurtosis + noise%kurtosis/records
      end do
      spread = sqrt(sum((value - sum(value)/records)**2)/(records - 1))
      call check(error, kurtosis, 3.0_dp, thr=0.3_dp)
      call check(error, stated/spread, 1.0_dp, thr=0.25_dp)
      call check(error, sum(value)/records, sqrt(2.0_dp), thr=0.01_dp)
   end subroutine test_heavy_tails

   subroutine test_covariance()
      ! symmetric, the squares of the stated errors on its diagonal, nothing beside terms that are not in the fit
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      integer :: j

      if (not_fitted(mixed_record(5000), 1.0_dp, noise_options("NK"), curve, noise)) return
      associate (c => noise%covariance, s => noise%coefficient%std_error)
         call check(error, all(abs(c - transpose(c)) <= 0) .and. count(abs(c) > 0) == 4, "four numbers")
         call check(error, all(abs([(c(j, j), j=1, 5)] - s**2) <= 1.0e-14_dp*s**2) .and. abs(c(2, 4)) < s(2)*s(4), "errors")
      end associate
   end subroutine test_covariance

   subroutine test_chosen_alone()
      ! terms that are not there change neither value nor error of the one that is; the curve is the sum of the values
      type(allan_curve_type) :: curve
      type(noise_type) :: all_terms, alone
      real(dp) :: rate(3000)

      rate = normal_series(size(rate, kind=int64), 4711_int64)
      if (not_fitted(rate, 0.5_dp, noise_options(), curve, all_terms)) return
      if (not_fitted(rate, 0.5_dp, noise_options("N"), curve, alone)) return
      if (unmet(count(all_terms%coefficient%detected) == 1 .and. all(all_terms%coefficient%fitted), "N alone is there")) return
      associate (n => all_terms%coefficient(2), hidden => all_terms%coefficient([1, 3, 4, 5]))
         call check(error, n%value, alone%coefficient(2)%value, thr=1.0e-6_dp, rel=.true.)
         call check(error, n%std_error, alone%coefficient(2)%std_error, thr=1.0e-6_dp, rel=.true.)
         call check(error, all(hidden%value <= 0 .and. hidden%upper_limit > 0 .and. hidden%state == "limit"), "a limit, no value")
         call check(error, maxval(abs(all_terms%model*sqrt(curve%tau)/n%value - 1)) < 1e-9_dp, "the curve is another")
      end associate
   end subroutine test_chosen_alone

   subroutine test_coverage()
      ! N and K of 300 records: biases within 4 of their standard errors, intervals and limits cover what they say within 4 standard
      ! deviations of such a share (bench/allan_fit has more records)
      integer, parameter :: records = 300, samples = 2000, term(2) = [2, 4]
      real(dp), parameter :: truth(2) = [1.0_dp, 0.05_dp], normal_68 = 0.6827_dp, normal_95 = 0.95_dp
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: g(3*samples), size_of_error(records), limit(records)
      integer :: i, k
      real(dp) :: outcome(3, 2, records)

      do i = 1, records
         g = normal_series(size(g, kind=int64), int(7919*i, int64))
         if (not_fitted(truth(1)*g(:samples) + truth(2)*walk_of(g(samples + 1:2*samples), g(2*samples + 1:)), 1.0_dp, &
            & noise_options("NK"), curve, noise)) return
         outcome(1, :, i) = noise%coefficient(term)%value
         outcome(2, :, i) = noise%coefficient(term)%std_error
         outcome(3, :, i) = noise%coefficient(term)%upper_limit
      end do
      do k = 1, 2
         size_of_error = (outcome(1, k, :) - truth(k))/outcome(2, k, :)
         limit = outcome(3, k, :)
         call check(error, abs(sum(size_of_error)/records) < 4/sqrt(real(records, dp)), "a bias")
         call check(error, abs(share(abs(size_of_error) < 1) - normal_68) < tolerance(normal_68), "one standard error")
         call check(error, abs(share(abs(size_of_error) < 1.96_dp) - normal_95) < tolerance(normal_95), "two standard errors")
         call check(error, abs(share(limit > truth(k)) - normal_95) < tolerance(normal_95), "the limit")
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

   subroutine test_grids()
      ! the fit does not depend on the averaging times that are shown
      character(8), parameter :: taus(3) = [character(8) :: "all", "log:7", "300,900"]
      type(allan_options) :: grid
      type(allan_curve_type) :: curve
      type(noise_type) :: octave, noise
      integer :: i

      if (not_fitted(mixed_record(5000), 1.0_dp, noise_options(), curve, octave)) return
      do i = 1, 3
         grid%taus = trim(taus(i))
         call compute_allan(mixed_record(5000), 1.0_dp, grid, curve, failure)
         if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
         if (went_wrong(failure)) return
         if (unmet(size(noise%model) == size(curve%m) .and. noise%points == octave%points, trim(taus(i)))) return
         call check(error, maxval(abs([noise%coefficient%value - octave%coefficient%value, &
            & noise%coefficient%upper_limit - octave%coefficient%upper_limit])) < 1.0e-9_dp, trim(taus(i)))
      end do
   end subroutine test_grids

   subroutine test_limits_of_curve()
      ! white noise: from m = 32 on the mixture's degrees of freedom are those of Greenhall & Riley; at m = 1 they are
      ! exactly (n - 1)/1.5, as the differences of neighbors have the correlation -1/2 (and the samples are uniform: kurtosis
      ! -1.2, not significant)
      type(allan_curve_type) :: before, after
      type(noise_type) :: noise
      integer :: i

      call compute_allan(nbs14_long(), 1.0_dp, allan_options(), before, failure)
      after = before
      call fit_noise(after, noise_options("N"), noise, failure)
      if (went_wrong(failure, "the fit failed")) return
      do i = 6, 8
         call check(error, after%edf(i), before%edf(i), thr=0.05_dp, rel=.true.)
         call check(error, after%upper(i), before%upper(i), thr=0.02_dp, rel=.true.)
      end do
      call check(error, after%edf(1), 999/1.5_dp, thr=0.01_dp, rel=.true.)
      call check(error, all(after%lower < after%deviation .and. after%deviation < after%upper))
      call check(error, abs(noise%coefficient(2)%value - 0.2884664_dp) < 3*noise%coefficient(2)%std_error, "N")
   end subroutine test_limits_of_curve

   subroutine test_failures()
      type(allan_curve_type) :: curve, empty
      type(noise_type) :: noise
      integer :: codes(6)

      call fit_noise(empty, noise_options(), noise, failure)
      codes(1) = failure%code
      call compute_allan([1.0_dp, 2.0_dp, 3.0_dp, 5.0_dp], 1.0_dp, allan_options(), curve, failure)
      call fit_noise(curve, noise_options("QNX"), noise, failure)
      codes(2) = failure%code
      call fit_noise(curve, noise_options(" "), noise, failure)
      codes(3) = failure%code
      curve%kind = "mdev"
      call fit_noise(curve, noise_options(), noise, failure)
      codes(4) = failure%code
      curve%kind = "oadev"
      call fit_noise(curve, noise_options("QNBKR"), noise, failure)
      codes(5) = failure%code
      curve%octaves%variance = 0
      call fit_noise(curve, noise_options("N"), noise, failure)
      codes(6) = failure%code
      call check(error, all(codes(:4) == status%invalid_argument), "invalid arguments")
      call check(error, codes(5), status%too_few_samples, "one octave for five terms")
      call check(error, codes(6), status%constant_input, "no variance")
   end subroutine test_failures

end module test_allan_noise_fit
