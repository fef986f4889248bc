! SPDX-License-Identifier: MIT
!> The main job where little is known, or little is there: units, huge and tiny numbers, constants, short records, failing channels.
module test_pipeline_limits
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_record, only : record_type
   use gyroakf_units, only : parse_unit
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, stage, apply_preset, run_pipeline
   use pipeline_runs, only : paper_record, run
   implicit none (type, external)
   private
   public :: suite_pipeline_limits

contains

   subroutine suite_pipeline_limits()
      call test("one-channel-fails", test_one_channel_fails)
      call test("nothing-known", test_nothing_known)
      call test("units", test_units)
      call test("offset", test_offset)
      call test("tiny-huge", test_tiny_huge)
      call test("constant", test_constant)
      call test("white", test_white)
      call test("too-short", test_too_short)
      call test("short", test_short)
      call test("few-orders", test_few_orders)
   end subroutine suite_pipeline_limits

   !> A channel whose squares vanish cannot be filtered: the others are done all the same. What fails everywhere is a wrong option.
   subroutine test_one_channel_fails()
      type(record_type) :: record
      type(simulate_options) :: simulated
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
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
         call check(error, all(result%channel%available%drift_smoother .eqv. [1, 2, 3] /= broken), "the others are whole")
         associate (c => result%channel(broken))
            if (unmet(allocated(c%unavailable) .and. allocated(c%series_cleaned) .and. .not. c%available%akf, "it says why")) return
            if (unmet(index(c%unavailable(size(c%unavailable))%text, "the rest of the analysis: ") == 1)) return
         end associate
      end do
      record%value = spread(x, 2, 3)
      options%adf%regression = "zz"
      call check(error, .not. run(record, result, options), "a wrong option is refused")
   end subroutine test_one_channel_fails

   !> Values as small and as large as they may be: everything scales with them.
   subroutine test_tiny_huge()
      integer, parameter :: powers(*) = [-460, -330, 190]
      type(record_type) :: record
      type(simulate_options) :: options
      type(pipeline_result_type) :: result, expected
      real(dp) :: x(3000, 1)
      integer :: k

      options%samples = 3000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%ar = [0.98_dp]
      options%ar_variance = 1.0e-3_dp
      call simulate_record(options, record, failed)
      x = record%value
      if (unmet(run(record, expected))) return
      do k = 1, size(powers)
         record%value = scale(x, powers(k))
         if (unmet(run(record, result))) return
         associate (a => result%channel(1), b => expected%channel(1), back => 0.5_dp**powers(k))
            if (unmet(allocated(a%unavailable) .eqv. allocated(b%unavailable), "what cannot be done")) return
            call check(error, near(a%adf%statistic, b%adf%statistic) .and. near(a%cleaned%kurtosis, b%cleaned%kurtosis) .and. &
                       near(a%ar%coefficient(1), b%ar%coefficient(1)) .and. near(a%akf%nis_mean, b%akf%nis_mean), "numbers")
            call check(error, near(a%halves%statistic, b%halves%statistic) .and. near(a%drift%model%phi(1), b%drift%model%phi(1)) &
                       .and. near(a%kpss%statistic, b%kpss%statistic), "numbers of the halves, the drift")
            call check(error, near(a%kf%variance*back*back, b%kf%variance) .and. near(a%drift%white_std*back, b%drift%white_std) &
                       .and. near(a%drift_smoother%variance*back*back, b%drift_smoother%variance), "filters")
            call check(error, near(a%allan(stage%input)%stated%term(2)%value*back, b%allan(stage%input)%stated%term(2)%value) &
                       .and. near(a%allan(stage%input)%stated%term(2)%std_error*back, &
                                  b%allan(stage%input)%stated%term(2)%std_error), "coefficients")
         end associate
      end do

   contains

      pure logical function near(x, y)
         real(dp), intent(in) :: x, y

         near = abs(x - y) <= 1.0e-6_dp*abs(y)
      end function near

   end subroutine test_tiny_huge

   !> Neither rate nor unit: the whole job, per sample and in input units.
   subroutine test_nothing_known()
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
      associate (x => a%channel(1)%allan(stage%input), y => b%channel(1)%allan(stage%input))
         call check(error, .not. x%stated%in_units .and. y%stated%in_units)
         call check(error, x%stated%term(2)%unit, "input unit*sqrt(sample)")
         ! N per root of a sample is that per root of a second over the root of 0.2 s
         call check(error, x%stated%term(2)%value*sqrt(0.2_dp)*60, y%stated%term(2)%value, thr=1.0e-6_dp, rel=.true.)
      end associate
   end subroutine test_nothing_known

   !> rad/s instead of deg/s: the same coefficients.
   subroutine test_units()
      type(record_type) :: degrees, radians
      type(pipeline_result_type) :: a, b

      call paper_record(degrees)
      radians = degrees
      radians%value = degrees%value*degrees%unit%to_si
      call parse_unit("rad/s", radians%unit, failed)
      call check(error, run(degrees, a) .and. run(radians, b))
      associate (x => a%channel(1)%allan(stage%cleaned)%stated, y => b%channel(1)%allan(stage%cleaned)%stated)
         call check(error, x%term(2)%value, y%term(2)%value, thr=1.0e-6_dp, rel=.true.)
         call check(error, x%term(2)%unit == y%term(2)%unit .and. x%density(1)%unit == "deg/s/sqrt(Hz)")
      end associate
      call check(error, a%channel(1)%kf_figures%variance_ratio, b%channel(1)%kf_figures%variance_ratio, thr=1.0e-9_dp, rel=.true.)
   end subroutine test_units

   !> A record taken as it is, with a mean of thousands of standard deviations: the filters see it without the mean.
   subroutine test_offset()
      type(record_type) :: record
      type(pipeline_options) :: as_is
      type(pipeline_result_type) :: a, b

      as_is%clean%degree = -1
      as_is%clean%method = "none"
      as_is%do_allan = .false.
      call paper_record(record)
      call check(error, run(record, a, as_is))
      record%value = record%value + 100.0_dp
      call check(error, run(record, b, as_is))
      call check(error, a%channel(1)%kf%variance, b%channel(1)%kf%variance, thr=1.0e-8_dp, rel=.true.)
      call check(error, abs(b%channel(1)%kf%mean) < 1.0e-3_dp .and. abs(b%channel(1)%raw%mean - 100) < 1.0e-2_dp)
   end subroutine test_offset

   !> A channel without variance: its stages are named, the other channel is analyzed.
   subroutine test_constant()
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
      if (unmet(allocated(result%channel(1)%unavailable) .and. .not. result%channel(1)%available%ar)) return
      call check(error, result%channel(2)%available%akf .and. .not. allocated(result%channel(2)%unavailable))
   end subroutine test_constant

   !> White noise: AIC may take order 0, the paper's preset not; either way there is a filter, and no drift.
   subroutine test_white()
      type(simulate_options) :: options
      type(pipeline_options) :: paper
      type(record_type) :: record
      type(pipeline_result_type) :: a, b

      options%coefficient(2) = 0.01_dp
      options%samples = 4000
      options%seed = 2
      call simulate_record(options, record, failed)
      call apply_preset("paper", paper, failed)
      call check(error, run(record, a) .and. run(record, b, paper))
      call check(error, a%channel(1)%available%kf .and. .not. a%channel(1)%drift%found)
      call check(error, b%channel(1)%ar%order >= 1 .and. b%channel(1)%available%akf)
      call check(error, minloc(a%channel(1)%ar%table%aic, 1) == a%channel(1)%ar%order + 1)
   end subroutine test_white

   subroutine test_too_short()
      type(record_type) :: record
      type(pipeline_result_type) :: result

      call run_pipeline(record, pipeline_options(), result, failed)
      if (unmet(allocated(failed))) return
      call paper_record(record)
      record%value = record%value(:9, :)
      call run_pipeline(record, pipeline_options(), result, failed)
      if (unmet(allocated(failed))) return
      call check(error, failed%code == status%too_few_samples .and. index(failed%message, "record: 9;") > 0)
   end subroutine test_too_short

   !> 10 to 60 samples: no error, and every stage that failed is named.
   subroutine test_short()
      type(record_type) :: whole, record
      type(pipeline_result_type) :: result
      integer :: n

      call paper_record(whole)
      record = whole
      do n = 10, 60, 5
         record%value = whole%value(:n, :)
         call check(error, run(record, result))
         associate (c => result%channel(1))
            if (unmet(allocated(c%unavailable) .or. (c%available%akf .and. c%available%adf .and. c%available%drift))) return
         end associate
      end do
   end subroutine test_short

   !> A short record has an AR model of the orders that it can show, and says so.
   subroutine test_few_orders()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      integer :: i

      call paper_record(record)
      record%value = record%value(:14, :)
      options%ar%max_order = 12
      options%do_allan = .false.
      options%do_filter = .false.
      call run_pipeline(record, options, result, failed)
      if (went_wrong(failed)) return
      associate (c => result%channel(1))
         call check(error, c%available%ar)
         if (unmet(size(c%ar%table), 4)) return
         call check(error, any([(index(c%warnings(i)%text, "AR orders up to 3 ") > 0, i=1, size(c%warnings))]))
      end associate
   end subroutine test_few_orders

end module test_pipeline_limits
