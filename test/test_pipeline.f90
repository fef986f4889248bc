! SPDX-License-Identifier: MIT
!> The main job from a record to results: the example of the paper, gaps, what cannot be done, presets.
module test_pipeline
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_record, only : record_type
   use gyroakf_units, only : parse_unit
   use gyroakf_simulate_record, only : simulate_options, simulate_record, paper_preset, paper_seed
   use gyroakf_series_differences, only : difference_variance
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_filter_design, only : design_kf, design_akf
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_pipeline_coefficients, only : compare_coefficients
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, channel_result_type, stage, apply_preset, run_pipeline
   implicit none (type, external)
   private
   public :: collect_pipeline

contains

   !> Names the tests.
   subroutine collect_pipeline(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("example", test_example), &
         new_unittest("example-coefficients", test_example_coefficients), &
         new_unittest("paper-preset", test_paper_preset), &
         new_unittest("paper-chain", test_paper_chain), &
         new_unittest("misfit", test_misfit), &
         new_unittest("threads", test_threads), &
         new_unittest("missing-few", test_missing_few), &
         new_unittest("missing-many", test_missing_many), &
         new_unittest("drift", test_drift), &
         new_unittest("compensated", test_compensated), &
         new_unittest("stated-figures", test_stated_figures), &
         new_unittest("reduction", test_reduction), &
         new_unittest("drift-options", test_drift_options), &
         new_unittest("channels", test_channels), &
         new_unittest("one-channel-fails", test_one_channel_fails), &
         new_unittest("nothing-known", test_nothing_known), &
         new_unittest("units", test_units), &
         new_unittest("offset", test_offset), &
         new_unittest("tiny-huge", test_tiny_huge), &
         new_unittest("constant", test_constant), &
         new_unittest("white", test_white), &
         new_unittest("too-short", test_too_short), &
         new_unittest("short", test_short), &
         new_unittest("few-orders", test_few_orders), &
         new_unittest("outlier-times", test_outlier_times), &
         new_unittest("single-rooms", test_single_rooms), &
         new_unittest("series", test_series), &
         new_unittest("differences", test_differences)]
   end subroutine collect_pipeline

   !> The record of the paper.
   subroutine paper_record(record)
      type(record_type), intent(out) :: record
      type(gyro_error), allocatable :: failed

      call simulate_record(paper_preset(paper_seed), record, failed)
   end subroutine paper_record

   !> Runs with the defaults of the program; false where that failed.
   logical function run(record, result, options)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(out) :: result
      type(pipeline_options), intent(in), optional :: options
      type(gyro_error), allocatable :: failed
      type(pipeline_options) :: defaults

      if (present(options)) defaults = options
      call run_pipeline(record, defaults, result, failed)
      run = .not. allocated(failed)
   end function run

   !> What the example record must give: Table I and II of the paper.
   subroutine test_example(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result

      call paper_record(record)
      call check(error, run(record, result))
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%clean%removed == 12 .and. c%ar%order == 1 .and. c%adf%stationary)
         if (allocated(error)) return
         call check(error, minloc(c%ar%table%bic, 1) == 2, "order by BIC")
         if (allocated(error)) return
         call check(error, abs(c%ar%coefficient(1) - 0.41_dp) < 3*c%ar%std_error(1))
         if (allocated(error)) return
         call check(error, c%kf_figures%variance_ratio, 0.28447912860740027_dp, thr=0.06_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, c%kf%dc_gain, 0.6072_dp, thr=0.01_dp)
         if (allocated(error)) return
         call check(error, c%akf%variance < c%kf%variance .and. c%akf%variance > 0)
         if (allocated(error)) return
         call check(error, c%predictable_percent, 100*c%ar%coefficient(1)**2, thr=1.0e-9_dp)
         if (allocated(error)) return
         ! the cubic of the record passes for a slow random walk, its AR(1) is too fast to be drift
         call check(error, c%available%drift .and. c%drift%found .and. .not. allocated(c%unavailable))
         if (allocated(error)) return
         call check(error, c%drift%name == "walk+ar1" .and. .not. c%drift%slow(1) .and. c%drift%slow(2), "its drift")
      end associate
   end subroutine test_example

   !> No coefficient is negative or NaN; N is that of the AR(1), sqrt(var t0 (1 + phi)/(1 - phi)) = 0.95 deg/sqrt(h).
   subroutine test_example_coefficients(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: which, term

      call paper_record(record)
      call check(error, run(record, result))
      if (allocated(error)) return
      do which = stage%input, stage%akf
         associate (allan => result%channel(1)%allan(which))
            call check(error, allan%available .and. allan%fitted)
            if (allocated(error)) return
            do term = 1, 5
               call check(error, ieee_is_finite(allan%stated%term(term)%value))
               if (allocated(error)) return
               call check(error, allan%stated%term(term)%value >= 0 .and. allan%stated%term(term)%std_error >= 0)
               if (allocated(error)) return
            end do
         end associate
      end do
      associate (n => result%channel(1)%allan(stage%input)%stated%term(2))
         call check(error, n%unit, "deg/sqrt(h)")
         if (allocated(error)) return
         call check(error, n%detected .and. abs(n%value - 0.951_dp) < 0.4_dp)
         if (allocated(error)) return
      end associate
      call check(error, result%channel(1)%allan(stage%input)%stated%density_two_sided, &
                 result%channel(1)%allan(stage%input)%stated%term(2)%value/60, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_example_coefficients

   !> Pauta's 3 sigma removes good samples too: 39 of 12000 in the mean, and the order is never 0.
   subroutine test_paper_preset(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed

      call apply_preset("paper", options, failed)
      call check(error, .not. allocated(failed) .and. options%design%forgetting == 0.98_dp)
      if (allocated(error)) return
      call paper_record(record)
      call check(error, run(record, result, options))
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%clean%removed > 20 .and. c%clean%removed < 90 .and. c%clean%threshold == 3.0_dp)
         if (allocated(error)) return
         call check(error, c%ar%order >= 1 .and. size(c%ar%table) == 4)
         if (allocated(error)) return
      end associate
      call apply_preset("papier", options, failed)
      call check(error, allocated(failed))
   end subroutine test_paper_preset

   !> Every setting of the paper by its name, whatever the options were before
   subroutine test_paper_chain(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_options) :: o
      type(gyro_error), allocatable :: failed

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
      if (.not. allocated(error)) call check_paper_start(o, error)
   end subroutine test_paper_chain

   !> The filters that these options give start from Q = sigma_a^2, R = P = Var(z), x = 0
   subroutine check_paper_start(o, error)
      type(pipeline_options), intent(in) :: o
      type(error_type), allocatable, intent(out) :: error
      type(ar_model_type) :: model
      type(filter_type) :: kf, akf
      type(gyro_error), allocatable :: failed
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
   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result(2)
      type(simulate_options) :: options
      type(gyro_error), allocatable :: failed
      logical :: done(2)
      integer :: threads, before, which

      before = thread_count()
      options = paper_preset(paper_seed)
      options%samples = 300000_int64                ! enough for every loop to be divided among threads
      options%coefficient(2) = 0.01_dp
      call simulate_record(options, record, failed)
      do threads = 1, 2
         call set_thread_count(threads)
         done(threads) = run(record, result(threads))
      end do
      call set_thread_count(before)
      call check(error, all(done))
      if (allocated(error)) return
      associate (a => result(1)%channel(1), b => result(2)%channel(1))
         call check(error, all(abs(figures(a) - figures(b)) <= 1.0e-12_dp*abs(figures(a))))
         if (allocated(error)) return
         do which = stage%input, stage%akf
            call check(error, all(abs(a%allan(which)%curve%deviation - b%allan(which)%curve%deviation) <= &
                                  1.0e-12_dp*a%allan(which)%curve%deviation))
            if (allocated(error)) return
            call check(error, all(abs(a%allan(which)%stated%term%value - b%allan(which)%stated%term%value) <= &
                                  1.0e-12_dp*maxval(a%allan(which)%stated%term%value)))
            if (allocated(error)) return
         end do
      end associate
   end subroutine test_threads

   !> One number of every room.
   function figures(c) result(x)
      type(channel_result_type), intent(in) :: c
      real(dp) :: x(12)

      x = [c%raw%variance, c%cleaned%variance, c%adf%statistic, c%jarque_bera%statistic, c%ljung_box%statistic, &
           c%ar%noise_variance, c%ar%coefficient(1), c%kf%variance, c%kf%nis_mean, c%akf%variance, c%akf%r, &
           c%clean%trend%power(lbound(c%clean%trend%power, 1) + 3)]
   end function figures

   !> Coefficients with samples lost against those of the whole record: within one standard error.
   subroutine compare_missing(share, error)
      real(dp), intent(in) :: share
      type(error_type), allocatable, intent(out) :: error
      type(simulate_options) :: options
      type(record_type) :: whole, holes
      type(pipeline_result_type) :: a, b
      type(pipeline_options) :: only_allan
      type(gyro_error), allocatable :: failed
      integer :: term

      options%samples = 20000
      options%rate_hz = 10
      options%coefficient(2:4) = [0.01_dp, 0.003_dp, 3.0e-4_dp]
      call simulate_record(options, whole, failed)
      options%missing = share
      call simulate_record(options, holes, failed)
      call check(error, count(holes%present(:, 1) == 0) > share*10000)
      if (allocated(error)) return
      only_allan%do_tests = .false.
      only_allan%do_filter = .false.
      call check(error, run(whole, a, only_allan) .and. run(holes, b, only_allan))
      if (allocated(error)) return
      do term = 2, 4
         associate (x => a%channel(1)%allan(stage%input)%noise%coefficient(term), &
                    y => b%channel(1)%allan(stage%input)%noise%coefficient(term))
            call check(error, abs(x%value - y%value) <= max(x%std_error, y%std_error))
            if (allocated(error)) return
         end associate
      end do
   end subroutine compare_missing

   subroutine test_missing_few(error)
      type(error_type), allocatable, intent(out) :: error

      call compare_missing(0.003_dp, error)
   end subroutine test_missing_few

   subroutine test_missing_many(error)
      type(error_type), allocatable, intent(out) :: error

      call compare_missing(0.05_dp, error)
   end subroutine test_missing_many

   !> A drift under white noise is found, with its correlation time: AR(1) of 0.99 at 10 Hz is 9.95 s.
   subroutine test_drift(error)
      type(error_type), allocatable, intent(out) :: error
      type(simulate_options) :: options
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed

      options%samples = 20000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%ar = [0.99_dp]
      options%ar_variance = 4.0e-4_dp
      call simulate_record(options, record, failed)
      call check(error, run(record, result))
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%drift%found .and. c%available%drift_kf .and. c%available%drift_akf)
         if (allocated(error)) return
         call check(error, c%drift_tau, 1.0_dp)
         if (allocated(error)) return
         call check(error, c%drift_time, 9.95_dp, thr=4.0_dp)
         if (allocated(error)) return
         call check(error, abs(c%drift%white_std - 0.01_dp*sqrt(10.0_dp)) < 4*c%white_std_error .and. c%white_std_error < 1.0e-3_dp)
         if (allocated(error)) return
         call check(error, c%drift_process(1)%slow .and. .not. c%drift_process(1)%walk .and. &
                    abs(c%drift_process(1)%time - 9.95_dp) < 4*c%drift_process(1)%time_error, "the process as stated")
         if (allocated(error)) return
         call check(error, c%drift_process(1)%time_error > 0.1_dp .and. c%drift_process(1)%time_error < 4.0_dp, "its error")
         if (allocated(error)) return
         call check(error, abs(c%drift_process(1)%std - 0.02_dp) < 0.006_dp, "its standard deviation")
         if (allocated(error)) return
         associate (model => c%drift%model)
            call check(error, c%drift%name == "ar1" .and. abs(c%drift_smoother%dc_gain - model%q(1)/(model%q(1) &
                       + model%r*(1 - model%phi(1))**2)) < 1.0e-12_dp, "the share of the spectrum at frequency 0")
         end associate
         if (allocated(error)) return
         call check(error, c%drift_kf%nis_mean > c%drift_kf%nis_low .and. c%drift_kf%nis_mean < c%drift_kf%nis_high)
      end associate
   end subroutine test_drift

   !> A record of a random walk and white noise, on a level of 3, with lost samples.
   subroutine walking_record(record)
      type(record_type), intent(out) :: record
      type(simulate_options) :: options
      type(gyro_error), allocatable :: failed

      options%samples = 20000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%coefficient(4) = 2.0e-3_dp
      options%offset = 3.0_dp
      options%missing = 0.01_dp
      call simulate_record(options, record, failed)
   end subroutine walking_record

   !> Shares of variances, and the correlation time of a process.
   subroutine test_stated_figures(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(simulate_options) :: options
      type(gyro_error), allocatable :: failed

      options%samples = 6000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%ar = [0.98_dp]
      options%ar_variance = 1.0e-4_dp
      call simulate_record(options, record, failed)
      call check(error, run(record, result), "the job fails")
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%kf_figures%variance_ratio, c%kf%variance/c%cleaned%variance, thr=1.0e-14_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, c%akf_figures%raw_variance_ratio, c%akf%variance/c%raw%variance, thr=1.0e-14_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, c%drift%found .and. size(c%drift_process) == 1, "one process")
         if (allocated(error)) return
         call check(error, .not. c%drift_process(1)%walk, "a correlated process")
         if (allocated(error)) return
         call check(error, c%drift_process(1)%time, -0.1_dp/log(c%drift%model%phi(1)), thr=1.0e-14_dp, rel=.true.)
      end associate
   end subroutine test_stated_figures

   !> What the adaptive filter leaves of a coefficient: of 10, 4 is 60 % less; an upper limit of 2 at least 80 %; 11 says nothing.
   subroutine test_reduction(error)
      type(error_type), allocatable, intent(out) :: error
      type(channel_result_type) :: channel

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
      if (allocated(error)) return
      call check(error, maxval(abs(channel%reduction_percent(:2) - 60)) < 1.0e-12_dp, "60 %")
      if (allocated(error)) return
      call check(error, abs(channel%reduction_at_least(3) - 80) < 1.0e-12_dp .and. channel%reduction_at_least(4) <= 0.0_dp, "80 %")
   end subroutine test_reduction

   !> A channel whose squares vanish cannot be filtered: the others are done all the same. What fails everywhere is a wrong option.
   subroutine test_one_channel_fails(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(simulate_options) :: simulated
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      type(gyro_error), allocatable :: failed
      real(dp) :: x(2000)
      integer :: broken

      simulated%samples = size(x)
      simulated%rate_hz = 10
      simulated%coefficient(2) = 0.01_dp
      simulated%ar = [0.98_dp]
      simulated%ar_variance = 1.0e-3_dp
      call simulate_record(simulated, record, failed)
      x = record%value(:, 1)
      deallocate (record%value)
      if (allocated(record%channel)) deallocate (record%channel)
      allocate (record%value(size(x), 3))
      options%keep_series = .true.
      do broken = 1, 3
         record%value = spread(x, 2, 3)
         record%value(:, broken) = 1.0e-153_dp*x
         call check(error, run(record, result, options), "a channel ends all of them")
         if (allocated(error)) return
         call check(error, all(result%channel%available%drift_smoother .eqv. [1, 2, 3] /= broken), "the others are whole")
         if (allocated(error)) return
         associate (c => result%channel(broken))
            call check(error, allocated(c%unavailable) .and. allocated(c%series_cleaned) .and. .not. c%available%akf, "it says why")
            if (allocated(error)) return
            call check(error, index(c%unavailable(size(c%unavailable))%text, "the rest of the analysis: ") == 1)
            if (allocated(error)) return
         end associate
      end do
      record%value = spread(x, 2, 3)
      options%adf%regression = "zz"
      call check(error, .not. run(record, result, options), "a wrong option is refused")
   end subroutine test_one_channel_fails

   !> Values as small and as large as they may be: everything scales with them.
   subroutine test_tiny_huge(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: powers(*) = [-460, -330, 190]
      type(record_type) :: record
      type(simulate_options) :: options
      type(pipeline_result_type) :: result, expected
      type(gyro_error), allocatable :: failed
      real(dp) :: x(3000, 1)
      integer :: k

      options%samples = 3000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%ar = [0.98_dp]
      options%ar_variance = 1.0e-3_dp
      call simulate_record(options, record, failed)
      x = record%value
      call check(error, run(record, expected))
      if (allocated(error)) return
      do k = 1, size(powers)
         record%value = scale(x, powers(k))
         call check(error, run(record, result))
         if (allocated(error)) return
         associate (a => result%channel(1), b => expected%channel(1), back => 0.5_dp**powers(k))
            call check(error, allocated(a%unavailable) .eqv. allocated(b%unavailable), "what cannot be done")
            if (allocated(error)) return
            call check(error, near(a%adf%statistic, b%adf%statistic) .and. near(a%cleaned%kurtosis, b%cleaned%kurtosis) .and. &
                       near(a%ar%coefficient(1), b%ar%coefficient(1)) .and. near(a%akf%nis_mean, b%akf%nis_mean), "numbers")
            if (allocated(error)) return
            call check(error, near(a%halves%statistic, b%halves%statistic) .and. near(a%drift%model%phi(1), b%drift%model%phi(1)) &
                       .and. near(a%kpss%statistic, b%kpss%statistic), "numbers of the halves, the drift")
            if (allocated(error)) return
            call check(error, near(a%kf%variance*back*back, b%kf%variance) .and. near(a%drift%white_std*back, b%drift%white_std) &
                       .and. near(a%drift_smoother%variance*back*back, b%drift_smoother%variance), "filters")
            if (allocated(error)) return
            call check(error, near(a%allan(stage%input)%stated%term(2)%value*back, b%allan(stage%input)%stated%term(2)%value) &
                       .and. near(a%allan(stage%input)%stated%term(2)%std_error*back, &
                                  b%allan(stage%input)%stated%term(2)%std_error), "coefficients")
            if (allocated(error)) return
         end associate
      end do

   contains

      pure logical function near(x, y)
         real(dp), intent(in) :: x, y

         near = abs(x - y) <= 1.0e-6_dp*abs(y)
      end function near
   end subroutine test_tiny_huge

   !> What is left without the smoothed drift: raw is drift and compensated; the white noise of 0.0316; no random walk any more.
   subroutine test_compensated(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options

      call walking_record(record)
      options%keep_series = .true.
      options%clean%degree = 3
      call check(error, run(record, result, options))
      if (allocated(error)) return
      associate (c => result%channel(1), raw => record%value(:, 1))
         call check(error, c%available%drift_smoother .and. any(c%drift_process%walk .and. c%drift_process%slow))
         if (allocated(error)) return
         call check(error, maxval(abs(c%series_drift + c%series_compensated - raw), mask=c%series_present /= 0) < 1.0e-13_dp)
         if (allocated(error)) return
         call check(error, c%compensated%std, 0.0316_dp, thr=0.0008_dp)
         if (allocated(error)) return
         call check(error, variance(pack(c%series_compensated, c%series_present /= 0)), c%compensated%variance, thr=1.0e-10_dp, &
                    rel=.true.)
         if (allocated(error)) return
         call check(error, variance(pack(c%series_drift, c%series_present /= 0)), c%drift_smoother%variance, thr=1.0e-10_dp, &
                    rel=.true.)
         if (allocated(error)) return
         call check(error, variance(pack(c%series_drift_akf, c%series_present /= 0)), c%drift_akf%variance, thr=1.0e-8_dp, &
                    rel=.true.)
         if (allocated(error)) return
         call check(error, abs(c%compensated%mean) < 1.0e-4_dp .and. abs(c%drift_kf%mean - c%level%mean) < 0.01_dp, "the level")
         if (allocated(error)) return
         call check(error, c%drift%allan_known .and. c%drift%allan_log_likelihood < c%drift%log_likelihood, "that of the curve")
         if (allocated(error)) return
         call check(error, c%drift_smoother%dc_gain, 1.0_dp)
         if (allocated(error)) return
         associate (before => c%allan(stage%input), after => c%allan(stage%compensated), n => size(c%allan(stage%input)%curve%tau))
            call check(error, after%stated%term(2)%value, before%stated%term(2)%value, thr=0.03_dp, rel=.true.)
            if (allocated(error)) return
            call check(error, after%curve%deviation(n - 2) < 0.05_dp*before%curve%deviation(n - 2), "long averaging times")
            if (allocated(error)) return
         end associate
         associate (before => c%allan(stage%input)%stated%term(4), after => c%allan(stage%compensated)%stated%term(4))
            call check(error, before%detected .and. .not. after%detected, "the random walk")
            if (allocated(error)) return
            associate (walk => c%drift_process(size(c%drift_process)))
               call check(error, abs(walk%k%value - before%value) < 4*(walk%k%std_error + before%std_error), "K of the two")
               if (allocated(error)) return
               call check(error, walk%k%unit, before%unit)
            end associate
         end associate
      end associate
   end subroutine test_compensated

   !> The model of the Allan deviation in its place, also where no curve is asked for; and the limit of what is drift.
   subroutine test_drift_options(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options

      call walking_record(record)
      options%do_allan = .false.
      options%identification%source = "allan"
      call check(error, run(record, result, options))
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%drift%source == "allan" .and. c%drift%found .and. c%available%drift_smoother)
         if (allocated(error)) return
         call check(error, c%drift_process(size(c%drift_process))%k%value, c%allan(stage%input)%stated%term(4)%value, &
                    thr=1.0e-12_dp, rel=.true.)
      end associate
      if (allocated(error)) return
      call paper_record(record)
      options = pipeline_options()
      options%drift_tau = 0.1_dp
      call check(error, run(record, result, options))
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%drift%found .and. c%drift_time < 1.0_dp .and. c%drift_time > 0.1_dp, "0.22 s is drift where asked for")
      end associate
      if (allocated(error)) return
      options%drift_tau = 1.0e300_dp
      record%sample_interval = 1.0e-10_dp
      call check(error, run(record, result, options))
      if (allocated(error)) return
      call check(error, any(result%channel(1)%drift%slow) .eqv. any(result%channel(1)%drift_process%walk), "only a walk is as slow")
   end subroutine test_drift_options

   !> Two channels give what each of them gives alone.
   subroutine test_channels(error)
      type(error_type), allocatable, intent(out) :: error
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
      if (allocated(error)) return
      call check(error, both%channel(2)%name == "gy" .and. size(both%channel) == 2)
      if (allocated(error)) return
      call check(error, all(abs(figures(both%channel(2)) - figures(alone%channel(1))) <= 0))
   end subroutine test_channels

   !> Neither rate nor unit: the whole job, per sample and in input units.
   subroutine test_nothing_known(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, known
      type(pipeline_result_type) :: a, b

      call paper_record(known)
      record = known
      record%rate_known = .false.
      record%sample_interval = 1
      record%unit%quantity = 0
      record%unit%to_si = 1
      deallocate (record%unit%name)
      call check(error, run(record, a) .and. run(known, b))
      if (allocated(error)) return
      associate (x => a%channel(1)%allan(stage%input), y => b%channel(1)%allan(stage%input))
         call check(error, .not. x%stated%in_units .and. y%stated%in_units)
         if (allocated(error)) return
         call check(error, x%stated%term(2)%unit, "input unit*sqrt(sample)")
         if (allocated(error)) return
         ! N per root of a sample is that per root of a second over the root of 0.2 s
         call check(error, x%stated%term(2)%value*sqrt(0.2_dp)*60, y%stated%term(2)%value, thr=1.0e-6_dp, rel=.true.)
      end associate
   end subroutine test_nothing_known

   !> rad/s instead of deg/s: the same coefficients.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: degrees, radians
      type(pipeline_result_type) :: a, b
      type(gyro_error), allocatable :: failed

      call paper_record(degrees)
      radians = degrees
      radians%value = degrees%value*degrees%unit%to_si
      call parse_unit("rad/s", radians%unit, failed)
      call check(error, run(degrees, a) .and. run(radians, b))
      if (allocated(error)) return
      associate (x => a%channel(1)%allan(stage%cleaned)%stated, y => b%channel(1)%allan(stage%cleaned)%stated)
         call check(error, x%term(2)%value, y%term(2)%value, thr=1.0e-6_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, x%term(2)%unit == y%term(2)%unit .and. x%density_unit == "deg/s/sqrt(Hz)")
         if (allocated(error)) return
      end associate
      call check(error, a%channel(1)%kf_figures%variance_ratio, b%channel(1)%kf_figures%variance_ratio, thr=1.0e-9_dp, rel=.true.)
   end subroutine test_units

   !> A record taken as it is, with a mean of thousands of standard deviations: the filters see it without the mean.
   subroutine test_offset(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: as_is
      type(pipeline_result_type) :: a, b

      as_is%clean%degree = -1
      as_is%clean%method = "none"
      as_is%do_allan = .false.
      call paper_record(record)
      call check(error, run(record, a, as_is))
      if (allocated(error)) return
      record%value = record%value + 100.0_dp
      call check(error, run(record, b, as_is))
      if (allocated(error)) return
      call check(error, a%channel(1)%kf%variance, b%channel(1)%kf%variance, thr=1.0e-8_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, abs(b%channel(1)%kf%mean) < 1.0e-3_dp .and. abs(b%channel(1)%raw%mean - 100) < 1.0e-2_dp)
   end subroutine test_offset

   !> A channel without variance: its rooms are named, the other channel goes on.
   subroutine test_constant(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      real(dp), allocatable :: x(:, :)

      call paper_record(record)
      allocate (x(12000, 2))
      x(:, 1) = 4.25_dp
      x(:, 2) = record%value(:, 1)
      record%value = x
      record%channel = [record%channel(1), record%channel(1)]
      call check(error, run(record, result))
      if (allocated(error)) return
      call check(error, allocated(result%channel(1)%unavailable) .and. .not. result%channel(1)%available%ar)
      if (allocated(error)) return
      call check(error, result%channel(2)%available%akf .and. .not. allocated(result%channel(2)%unavailable))
   end subroutine test_constant

   !> White noise: AIC may take order 0, the paper's preset not; either way there is a filter, and no drift.
   subroutine test_white(error)
      type(error_type), allocatable, intent(out) :: error
      type(simulate_options) :: options
      type(pipeline_options) :: paper
      type(record_type) :: record
      type(pipeline_result_type) :: a, b
      type(gyro_error), allocatable :: failed

      options%coefficient(2) = 0.01_dp
      options%samples = 4000
      options%seed = 2
      call simulate_record(options, record, failed)
      call apply_preset("paper", paper, failed)
      call check(error, run(record, a) .and. run(record, b, paper))
      if (allocated(error)) return
      call check(error, a%channel(1)%available%kf .and. .not. a%channel(1)%drift%found)
      if (allocated(error)) return
      call check(error, b%channel(1)%ar%order >= 1 .and. b%channel(1)%available%akf)
      if (allocated(error)) return
      call check(error, minloc(a%channel(1)%ar%table%aic, 1) == a%channel(1)%ar%order + 1)
   end subroutine test_white

   subroutine test_too_short(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed

      call run_pipeline(record, pipeline_options(), result, failed)
      call check(error, allocated(failed))
      if (allocated(error)) return
      call paper_record(record)
      record%value = record%value(:9, :)
      call run_pipeline(record, pipeline_options(), result, failed)
      call check(error, allocated(failed))
      if (allocated(error)) return
      call check(error, failed%code == status%too_few_samples .and. index(failed%message, "record: 9;") > 0)
   end subroutine test_too_short

   !> 10 to 60 samples: no error, and every room that failed is named.
   subroutine test_short(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, record
      type(pipeline_result_type) :: result
      integer :: n

      call paper_record(whole)
      record = whole
      do n = 10, 60, 5
         record%value = whole%value(:n, :)
         call check(error, run(record, result))
         if (allocated(error)) return
         associate (c => result%channel(1))
            call check(error, allocated(c%unavailable) .or. (c%available%akf .and. c%available%adf .and. c%available%drift))
            if (allocated(error)) return
         end associate
      end do
   end subroutine test_short

   !> A short record has an AR model of the orders that it can show, and says so.
   subroutine test_few_orders(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      type(gyro_error), allocatable :: failed
      integer :: i

      call paper_record(record)
      record%value = record%value(:14, :)
      options%ar%max_order = 12
      options%do_allan = .false.
      options%do_filter = .false.
      call run_pipeline(record, options, result, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, c%available%ar)
         if (allocated(error)) return
         call check(error, size(c%ar%table), 4)
         if (allocated(error)) return
         call check(error, any([(index(c%warnings(i)%text, "AR orders up to 3 ") > 0, i=1, size(c%warnings))]))
      end associate
   end subroutine test_few_orders

   !> 2 % of outliers: the warning names the first times.
   subroutine test_outlier_times(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: i

      call paper_record(record)
      record%value = record%value(1001:3000, :)
      do i = 1, 40
         record%value(50*i, 1) = 2.0_dp*(-1)**i
      end do
      call check(error, run(record, result))
      if (allocated(error)) return
      call check(error, allocated(result%channel(1)%warnings))
      if (allocated(error)) return
      call check(error, index(result%channel(1)%warnings(1)%text, "% of the samples") > 0 .and. &
                 index(result%channel(1)%warnings(1)%text, "at 9.8, 19.8, 29.8") > 0)
   end subroutine test_outlier_times

   !> AR noise is no sum of the five terms, and the result says so; white noise is, and nothing is said.
   subroutine test_misfit(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(simulate_options) :: options
      type(pipeline_options) :: analysis
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed

      call paper_record(record)
      call check(error, run(record, result))
      if (allocated(error)) return
      call check(error, says(result%channel(1), "bends the Allan curve"), "AR(1) noise")
      if (allocated(error)) return
      analysis%noise%terms = "QNBKR"
      call check(error, run(record, result, analysis))
      if (allocated(error)) return
      call check(error, says(result%channel(1), "is not a sum of Q, N, B, K and R"), "AR(1) noise, five terms")
      if (allocated(error)) return
      options%coefficient(2) = 0.01_dp
      call simulate_record(options, record, failed)
      call check(error, run(record, result))
      if (allocated(error)) return
      call check(error, .not. (says(result%channel(1), "is not a sum") .or. says(result%channel(1), "bends")), "white noise")
   end subroutine test_misfit

   !> Whether one of the warnings holds a text.
   logical function says(channel, text)
      type(channel_result_type), intent(in) :: channel
      character(*), intent(in) :: text
      integer :: i

      says = .false.
      if (.not. allocated(channel%warnings)) return
      do i = 1, size(channel%warnings)
         says = says .or. index(channel%warnings(i)%text, text) > 0
      end do
   end function says

   !> The rooms that a single command switches off have no result.
   subroutine test_single_rooms(error)
      type(error_type), allocatable, intent(out) :: error
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
      if (allocated(error)) return
      associate (c => result%channel(1))
         call check(error, .not. (c%available%preprocess .or. c%available%adf .or. c%available%ar .or. c%available%kf))
         if (allocated(error)) return
         call check(error, c%allan(stage%input)%fitted .and. .not. c%allan(stage%kf)%available)
         if (allocated(error)) return
      end associate
      options%do_allan = .false.
      options%do_filter = .true.
      call check(error, run(record, result, options))
      if (allocated(error)) return
      call check(error, result%channel(1)%available%akf .and. .not. result%channel(1)%allan(stage%input)%available)
   end subroutine test_single_rooms

   !> The series that are kept have the variances that are reported; outliers are marked in the mask.
   subroutine test_series(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      logical, allocatable :: there(:)
      integer(int64) :: n

      options%keep_series = .true.
      options%do_allan = .false.
      call paper_record(record)
      call check(error, run(record, result, options))
      if (allocated(error)) return
      associate (c => result%channel(1))
         there = c%series_present /= 0
         n = count(there)
         call check(error, size(there) == 12000 .and. n == 12000 - c%clean%removed)
         if (allocated(error)) return
         call check(error, .not. any(there(c%clean%outlier)))
         if (allocated(error)) return
         call check(error, variance(pack(c%series_cleaned, there)), c%cleaned%variance, thr=1.0e-10_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, variance(pack(c%series_kf, there)), c%kf%variance, thr=1.0e-10_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, variance(pack(c%series_akf, there)), c%akf%variance, thr=1.0e-10_dp, rel=.true.)
      end associate
   end subroutine test_series

   pure real(dp) function variance(x)
      real(dp), intent(in) :: x(:)

      variance = sum((x - sum(x)/size(x))**2)/(size(x) - 1)
   end function variance

   !> By hand: differences 1, 2, 3, their variance 1; without the pair at a gap; too few.
   subroutine test_differences(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: x(5) = [0.0_dp, 1.0_dp, 3.0_dp, 6.0_dp, 100.0_dp]
      real(dp) :: long(200001)
      integer :: i

      call check(error, difference_variance(x(:4)), 1.0_dp, thr=1.0e-14_dp)
      if (allocated(error)) return
      call check(error, difference_variance(x, valid=[1_int8, 1_int8, 1_int8, 1_int8, 0_int8]), 1.0_dp, thr=1.0e-14_dp)
      if (allocated(error)) return
      call check(error, difference_variance(x, valid=[1_int8, 0_int8, 1_int8, 1_int8, 0_int8]), 0.0_dp)
      if (allocated(error)) return
      do i = 1, size(long)
         long(i) = real(mod(i, 2), dp)
      end do
      ! 200000 differences of +1 and -1, as many of each, over several blocks
      call check(error, difference_variance(long), 200000.0_dp/199999, thr=1.0e-13_dp)
   end subroutine test_differences

end module test_pipeline
