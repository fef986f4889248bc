! SPDX-License-Identifier: MIT
!> The main job from a record to results: the example of the paper, presets, gaps, outliers, what is kept.
module test_pipeline
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, paper_seed
   use gyroakf_stats_differences, only : difference_variance
   use gyroakf_allan_deviations, only : allan_curve_type, compute_allan
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_filter_design, only : design_kf, design_akf
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_pipeline_coefficients, only : compare_coefficients
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, channel_result_type, stage, apply_preset, &
      & run_pipeline
   use pipeline_runs, only : paper_record, run, says, variance
   implicit none (type, external)
   private
   public :: suite_pipeline

contains

   subroutine suite_pipeline()
      call test("example", test_example)
      call test("example-coefficients", test_example_coefficients)
      call test("paper-preset", test_paper_preset)
      call test("paper-chain", test_paper_chain)
      call test("misfit", test_misfit)
      call test("threads", test_threads)
      call test("missing", test_missing)
      call test("reduction", test_reduction)
      call test("channels", test_channels)
      call test("outlier-times", test_outlier_times)
      call test("changed-noise", test_changed_noise)
      call test("raw", test_raw)
      call test("tested", test_tested)
      call test("single-stages", test_single_stages)
      call test("series", test_series)
      call test("differences", test_differences)
   end subroutine suite_pipeline

   !> What the example record must give: Table I and II of the paper.
   subroutine test_example()
      type(record_type) :: record
      type(pipeline_result_type) :: result

      call paper_record(record)
      call check(error, run(record, result))
      associate (c => result%channel(1))
         call check(error, c%clean%removed == 12 .and. c%ar%order == 1 .and. c%adf%stationary)
         call check(error, minloc(c%ar%table%bic, 1) == 2, "order by BIC")
         call check(error, abs(c%ar%coefficient(1) - 0.41_dp) < 3*c%ar%std_error(1))
         call check(error, c%kf_figures%variance_ratio, 0.28447912860740027_dp, thr=0.06_dp, rel=.true.)
         call check(error, c%kf%dc_gain, 0.6072_dp, thr=0.01_dp)
         call check(error, c%akf%variance < c%kf%variance .and. c%akf%variance > 0)
         call check(error, c%predictable_percent, 100*c%ar%coefficient(1)**2, thr=1.0e-9_dp)
         ! the cubic of the record passes for a slow random walk, its AR(1) is too fast to be drift
         if (unmet(c%available%drift .and. c%drift%found .and. .not. allocated(c%unavailable))) return
         call check(error, c%drift%name == "walk+ar1" .and. .not. c%drift%slow(1) .and. c%drift%slow(2), "its drift")
      end associate
   end subroutine test_example

   !> No coefficient is negative or NaN; N is that of the AR(1), sqrt(var t0 (1 + phi)/(1 - phi)) = 0.95 deg/sqrt(h).
   subroutine test_example_coefficients()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: which, term

      call paper_record(record)
      call check(error, run(record, result))
      do which = stage%input, stage%akf
         associate (allan => result%channel(1)%allan(which))
            call check(error, allan%available .and. allan%fitted)
            do term = 1, 5
               call check(error, ieee_is_finite(allan%stated%term(term)%value))
               call check(error, allan%stated%term(term)%value >= 0 .and. allan%stated%term(term)%std_error >= 0)
            end do
         end associate
      end do
      associate (n => result%channel(1)%allan(stage%input)%stated%term(2))
         call check(error, n%unit, "deg/sqrt(h)")
         call check(error, n%detected .and. abs(n%value - 0.951_dp) < 0.4_dp)
      end associate
      call check(error, result%channel(1)%allan(stage%input)%stated%density(1)%value, &
                 result%channel(1)%allan(stage%input)%stated%term(2)%value/60, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_example_coefficients

   !> Pauta's 3 sigma removes good samples too: 39 of 12000 in the mean, and the order is never 0.
   subroutine test_paper_preset()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result

      call apply_preset("paper", options, failed)
      if (unmet(.not. allocated(failed) .and. options%design%forgetting == 0.98_dp)) return
      call paper_record(record)
      call check(error, run(record, result, options))
      associate (c => result%channel(1))
         call check(error, c%clean%removed > 20 .and. c%clean%removed < 90 .and. c%clean%threshold == 3.0_dp)
         if (unmet(c%ar%order >= 1 .and. size(c%ar%table) == 4)) return
      end associate
      call apply_preset("papier", options, failed)
      call check(error, allocated(failed))
   end subroutine test_paper_preset

   !> Every setting of the paper by its name, whatever the options were before
   subroutine test_paper_chain()
      type(pipeline_options) :: o

      o%clean%method = "mad"
      o%clean%threshold = 9.0_dp
      o%clean%degree = 1
      o%clean%max_passes = 1
      o%ar%method = "burg"
      o%ar%criterion = "bic"
      o%ar%max_order = 7
      o%ar%order = 5
      o%design%akf = "robust"
      o%design%r_factor = 9.84_dp
      o%design%forgetting = 0.9_dp
      o%design%estimate = "R"
      o%design%huber = 2.5_dp
      call apply_preset("paper", o, failed)
      call check(error, o%clean%method, "pauta", "rule of the outliers")
      if (.not. allocated(error)) call check(error, o%clean%threshold, 3.0_dp, "3 sigma")
      if (.not. allocated(error)) call check(error, o%clean%max_passes, 20, "rounds")
      if (.not. allocated(error)) call check(error, o%clean%degree, 3, "cubic trend")
      if (.not. allocated(error)) call check(error, o%ar%method, "yw", "method of the AR model")
      if (.not. allocated(error)) call check(error, o%ar%criterion, "aic", "criterion of the order")
      if (.not. allocated(error)) call check(error, o%ar%max_order, 3, "largest order")
      if (.not. allocated(error)) call check(error, o%ar%order, -1, "the order is chosen")
      if (.not. allocated(error)) call check(error, o%design%r_factor, 1.0_dp, "R = Var(z)")
      if (.not. allocated(error)) call check(error, o%design%akf, "paper", "form of the adaptive filter")
      if (.not. allocated(error)) call check(error, o%design%estimate, " ", "the form's own: Q and R are adapted")
      if (.not. allocated(error)) call check(error, o%design%forgetting, 0.98_dp, "b")
      if (.not. allocated(error)) call check(error, o%design%huber, 0.0_dp, "no gate")
      if (.not. allocated(error)) call check_paper_start(o)
   end subroutine test_paper_chain

   !> The filters that these options give start from Q = sigma_a^2, R = P = Var(z), x = 0
   subroutine check_paper_start(o)
      type(pipeline_options), intent(in) :: o
      type(ar_model_type) :: model
      type(filter_type) :: kf, akf
      real(dp), parameter :: phi = 0.409975_dp, variance = 5.24e-4_dp

      model%order = 1
      model%coefficient = [phi]
      model%variance = variance
      model%noise_variance = variance*(1 - phi**2)
      call design_kf(model, o%design, kf, failed)
      if (.not. allocated(failed)) call design_akf(model, 2*variance*(1 - phi), o%design, akf, failed)
      call check(error, .not. allocated(failed), "the filters are not made")
      if (.not. allocated(error)) call check(error, kf%q, model%noise_variance, "Q of the fixed filter")
      if (.not. allocated(error)) call check(error, kf%r, variance, "R of the fixed filter")
      if (.not. allocated(error)) call check(error, kf%p(1, 1), variance, "P of the fixed filter", thr=1.0e-14_dp, rel=.true.)
      if (.not. allocated(error)) call check(error, akf%q, model%noise_variance, "Q0")
      if (.not. allocated(error)) call check(error, akf%r, variance, "R0")
      if (.not. allocated(error)) call check(error, akf%p(1, 1), variance, "P0")
      if (.not. allocated(error)) call check(error, abs(akf%x(1)) + abs(kf%x(1)), 0.0_dp, "x0")
      if (.not. allocated(error)) call check(error, abs(akf%q_mean) + abs(akf%r_mean), 0.0_dp, "q and r")
      if (.not. allocated(error)) call check(error, akf%wait, 0, "no burn-in")
      if (.not. allocated(error)) call check(error, akf%options%measurement_form, "paper", "the posterior of (22)")
   end subroutine check_paper_start

   !> Two threads give the same numbers as one.
   subroutine test_threads()
      type(record_type) :: record
      type(pipeline_result_type) :: result(2)
      type(simulate_options) :: options
      logical :: done(2)
      integer :: threads, before, which

      before = thread_count()
      options = paper_preset(paper_seed)
      options%samples = 150000_int64                ! more than two blocks of every loop: it is divided among threads
      options%coefficient(2) = 0.01_dp
      call simulate_record(options, record, failed)
      do threads = 1, 2
         call set_thread_count(threads)
         done(threads) = run(record, result(threads))
      end do
      call set_thread_count(before)
      call check(error, all(done))
      associate (a => result(1)%channel(1), b => result(2)%channel(1))
         call check(error, all(abs(figures(a) - figures(b)) <= 1.0e-12_dp*abs(figures(a))))
         do which = stage%input, stage%akf
            call check(error, all(abs(a%allan(which)%curve%deviation - b%allan(which)%curve%deviation) <= &
                                  1.0e-12_dp*a%allan(which)%curve%deviation))
            call check(error, all(abs(a%allan(which)%stated%term%value - b%allan(which)%stated%term%value) <= &
                                  1.0e-12_dp*maxval(a%allan(which)%stated%term%value)))
         end do
      end associate
   end subroutine test_threads

   !> One number of every stage.
   function figures(c) result(x)
      type(channel_result_type), intent(in) :: c
      real(dp) :: x(12)

      x = [c%raw%variance, c%cleaned%variance, c%adf%statistic, c%jarque_bera%statistic, c%ljung_box%statistic, &
           c%ar%noise_variance, c%ar%coefficient(1), c%kf%variance, c%kf%nis_mean, c%akf%variance, c%akf%r, &
           c%clean%trend%power(lbound(c%clean%trend%power, 1) + 3)]
   end function figures

   !> Coefficients with samples lost against those of the whole record: within one standard error.
   subroutine compare_missing(share)
      real(dp), intent(in) :: share
      type(simulate_options) :: options
      type(record_type) :: whole, holes
      type(pipeline_result_type) :: a, b
      type(pipeline_options) :: only_allan
      integer :: term

      options%samples = 20000
      options%rate_hz = 10
      options%coefficient(2:4) = [0.01_dp, 0.003_dp, 3.0e-4_dp]
      call simulate_record(options, whole, failed)
      options%missing = share
      call simulate_record(options, holes, failed)
      call check(error, count(holes%present(:, 1) == 0) > share*10000)
      only_allan%do_tests = .false.
      only_allan%do_filter = .false.
      call check(error, run(whole, a, only_allan) .and. run(holes, b, only_allan))
      do term = 2, 4
         associate (x => a%channel(1)%allan(stage%input)%noise%coefficient(term), &
                    y => b%channel(1)%allan(stage%input)%noise%coefficient(term))
            call check(error, abs(x%value - y%value) <= max(x%std_error, y%std_error))
         end associate
      end do
   end subroutine compare_missing

   subroutine test_missing()
      call compare_missing(0.003_dp)
      call compare_missing(0.05_dp)
   end subroutine test_missing

   !> What the adaptive filter leaves of a coefficient: of 10, 4 is 60 % less; an upper limit of 2 at least 80 %; 11 says nothing.
   subroutine test_reduction()
      type(channel_result_type) :: channel

      allocate (channel%allan(6))
      channel%allan%fitted = .true.
      channel%allan(stage%cleaned)%stated%term%detected = .true.
      channel%allan(stage%cleaned)%stated%term%value = 10
      channel%allan(stage%cleaned)%stated%term(5)%detected = .false.
      channel%allan(stage%akf)%stated%term%fitted = .true.
      channel%allan(stage%akf)%stated%term%value = 4
      channel%allan(stage%akf)%stated%term%detected = [.true., .true., .false., .false., .true.]
      channel%allan(stage%akf)%stated%term%upper_limit = [6.0_dp, 6.0_dp, 2.0_dp, 11.0_dp, 6.0_dp]
      call compare_coefficients(channel)
      call check(error, all(channel%reduction_known .eqv. [.true., .true., .false., .false., .false.]), "known")
      call check(error, maxval(abs(channel%reduction_percent(:2) - 60)) < 1.0e-12_dp, "60 %")
      call check(error, abs(channel%reduction_at_least(3) - 80) < 1.0e-12_dp .and. channel%reduction_at_least(4) <= 0.0_dp, "80 %")
   end subroutine test_reduction

   !> Two channels give what each of them gives alone.
   subroutine test_channels()
      type(record_type) :: record, one
      type(pipeline_result_type) :: both, alone
      real(dp), allocatable :: x(:, :)

      call paper_record(one)
      record = one
      allocate (x(2000, 2))
      x(:, 1) = one%value(:2000, 1)
      x(:, 2) = -3*one%value(4001:6000, 1)
      record%value = x
      record%channel = [one%channel(1), one%channel(1)]
      record%channel(2)%text = "gy"
      one%value = x(:, 2:2)
      call check(error, run(record, both) .and. run(one, alone))
      if (unmet(both%channel(2)%name == "gy" .and. size(both%channel) == 2)) return
      call check(error, all(abs(figures(both%channel(2)) - figures(alone%channel(1))) <= 0))
   end subroutine test_channels

   !> The curve named input is that of all samples that the file has; the cleaned one is that without the outliers, with a trend
   !> removed or not.
   subroutine test_raw()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      type(allan_curve_type) :: curve
      type(gyro_error), allocatable :: failure
      integer(int8) :: without(2000)
      integer :: degree

      call paper_record(record)
      record%value = record%value(1001:3000, :)
      record%value(50::50, 1) = 2.0_dp
      allocate (record%present(2000, 1), source=1_int8)
      record%present(101:110, 1) = 0_int8
      without = record%present(:, 1)
      do degree = -1, 1, 2
         options%clean%degree = degree
         call run_pipeline(record, options, result, failure)
         if (went_wrong(failure)) return
         associate (c => result%channel(1))
            call check(error, c%clean%removed >= 40 .and. c%available%cleaned, "outliers")
            call compute_allan(record%value(:, 1), record%sample_interval, options%allan, curve, failure, record%present(:, 1))
            call check(error, all(abs(c%allan(stage%input)%curve%deviation - curve%deviation) <= 1.0e-12_dp), "as read")
            if (degree < 0) then
               without(c%clean%outlier) = 0_int8
               call compute_allan(record%value(:, 1), record%sample_interval, options%allan, curve, failure, without)
               call check(error, all(abs(c%allan(stage%cleaned)%curve%deviation - curve%deviation) <= 1.0e-12_dp), "without")
            end if
            call check(error, 3*c%allan(stage%cleaned)%curve%deviation(1) < c%allan(stage%input)%curve%deviation(1), "the outliers")
         end associate
      end do
   end subroutine test_raw

   !> 2 % of outliers: the warning names the first times.
   subroutine test_outlier_times()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: i

      call paper_record(record)
      record%value = record%value(1001:3000, :)
      do i = 1, 40
         record%value(50*i, 1) = 2.0_dp*(-1)**i
      end do
      call check(error, run(record, result))
      if (unmet(allocated(result%channel(1)%warnings))) return
      call check(error, index(result%channel(1)%warnings(1)%text, "% of the samples") > 0 .and. &
                 index(result%channel(1)%warnings(1)%text, "at 9.8, 19.8, 29.8") > 0)
   end subroutine test_outlier_times

   !> The second half has twice the noise of the first: a warning; none for the record as it is.
   subroutine test_changed_noise()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: i, half

      do half = 1, 2
         call paper_record(record)
         if (half == 2) record%value(6001:, :) = 2*record%value(6001:, :)
         call check(error, run(record, result))
         associate (list => result%channel(1)%warnings)
            i = findloc([(index(list(i)%text, "the noise changed during the record: at tau = ") == 1 .and. &
                          .not. list(i)%note, i=1, size(list))], .true., dim=1)
            call check(error, i > 0 .eqv. half == 2)
         end associate
         if (half == 1) cycle
         associate (halves => result%channel(1)%halves)
            i = maxloc(abs(halves%score), dim=1)
            call check(error, halves%lower(i) < 2 .and. 2 < halves%upper(i), "limits of the ratio")
         end associate
      end do
   end subroutine test_changed_noise

   !> AR noise is no sum of the five terms, and there is a warning; white noise is, and there is none.
   subroutine test_misfit()
      type(record_type) :: record
      type(simulate_options) :: options
      type(pipeline_options) :: analysis
      type(pipeline_result_type) :: result

      call paper_record(record)
      call check(error, run(record, result))
      call check(error, says(result%channel(1), "bends the Allan curve"), "AR(1) noise")
      analysis%noise%terms = "QNBKR"
      call check(error, run(record, result, analysis))
      call check(error, says(result%channel(1), "is not a sum of the fitted terms"), "AR(1) noise, five terms")
      options%coefficient(2) = 0.01_dp
      call simulate_record(options, record, failed)
      call check(error, run(record, result))
      call check(error, .not. (says(result%channel(1), "is not a sum") .or. says(result%channel(1), "bends")), "white noise")
   end subroutine test_misfit

   !> The stages that a single command switches off have no result.
   subroutine test_single_stages()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result

      options%do_tests = .false.
      options%do_ar = .false.
      options%do_filter = .false.
      options%clean%degree = -1
      options%clean%method = "none"
      call paper_record(record)
      call check(error, run(record, result, options))
      associate (c => result%channel(1))
         call check(error, .not. (c%available%preprocess .or. c%available%adf .or. c%available%ar .or. c%available%kf))
         call check(error, c%allan(stage%input)%fitted .and. .not. c%allan(stage%kf)%available)
      end associate
      options%do_allan = .false.
      options%do_filter = .true.
      call check(error, run(record, result, options))
      call check(error, result%channel(1)%available%akf .and. .not. result%channel(1)%allan(stage%input)%available)
   end subroutine test_single_stages

   !> The series that are kept have the variances that are reported; outliers are marked in the mask.
   subroutine test_series()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      logical, allocatable :: there(:)
      integer(int64) :: n

      options%keep_series = .true.
      options%do_allan = .false.
      call paper_record(record)
      call check(error, run(record, result, options))
      associate (c => result%channel(1))
         there = c%series_present /= 0
         n = count(there)
         if (unmet(size(there) == 12000 .and. n == 12000 - c%clean%removed)) return
         call check(error, .not. any(there(c%clean%outlier)))
         call check(error, variance(pack(c%series_cleaned, there)), c%cleaned%variance, thr=1.0e-10_dp, rel=.true.)
         call check(error, variance(pack(c%series_kf, there)), c%kf%variance, thr=1.0e-10_dp, rel=.true.)
         call check(error, variance(pack(c%series_akf, there)), c%akf%variance, thr=1.0e-10_dp, rel=.true.)
      end associate
   end subroutine test_series

   !> By hand: differences 1, 2, 3, their variance 1; without the pair at a gap; too few.
   subroutine test_differences()
      real(dp), parameter :: x(5) = [0.0_dp, 1.0_dp, 3.0_dp, 6.0_dp, 100.0_dp]
      real(dp) :: long(200001)
      integer :: i

      call check(error, difference_variance(x(:4)), 1.0_dp, thr=1.0e-14_dp)
      call check(error, difference_variance(x, valid=[1_int8, 1_int8, 1_int8, 1_int8, 0_int8]), 1.0_dp, thr=1.0e-14_dp)
      call check(error, difference_variance(x, valid=[1_int8, 0_int8, 1_int8, 1_int8, 0_int8]), 0.0_dp)
      do i = 1, size(long)
         long(i) = real(mod(i, 2), dp)
      end do
      ! 200000 differences of +1 and -1, as many of each, over several blocks
      call check(error, difference_variance(long), 200000.0_dp/199999, thr=1.0e-13_dp)
   end subroutine test_differences

   !> The record is tested with its trend, whatever the AR model and the filters take; the paper tests the cleaned series.
   subroutine test_tested()
      type(record_type) :: record
      type(pipeline_result_type) :: level, plain, paper
      type(pipeline_options) :: options
      integer :: i

      call paper_record(record)
      record%value(:, 1) = record%value(:, 1) + [(1.0e-5_dp*i, i=1, 12000)]
      options%do_allan = .false.
      options%do_filter = .false.
      options%clean%method = "none"
      options%clean%degree = 3
      call check(error, run(record, level, options))
      options%test_cleaned = .true.
      call check(error, run(record, paper, options))
      options%clean%degree = -1
      call check(error, run(record, plain, options))
      associate (a => level%channel(1), b => plain%channel(1), c => paper%channel(1))
         call check(error, trim(a%tested)//", "//trim(b%tested)//", "//trim(c%tested), &
                    "record as read, record as read, cleaned series")
         call check(error, a%ljung_box%largest_rho > 0.6_dp .and. c%ljung_box%largest_rho < 0.5_dp)
         call check(error, abs(a%adf%statistic - b%adf%statistic) <= 0 .and. &
                    abs(a%jarque_bera%statistic - b%jarque_bera%statistic) <= 0 .and. abs(a%adf%statistic - c%adf%statistic) > 1)
         call check(error, abs(a%ar%noise_variance - c%ar%noise_variance), 0.0_dp, thr=1.0e-12_dp)
      end associate
   end subroutine test_tested

end module test_pipeline
