! SPDX-License-Identifier: MIT
!> Allan curve and noise coefficients of one series of a channel, stated in the units of the report
!> and in SI, N as a density in both conventions, and compared.
module gyroakf_pipeline_coefficients
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : error_type, status
   use gyroakf_record, only : add_text, record_type
   use gyroakf_coefficient_units, only : coefficient_definition, coefficient_unit, &
      coefficient_unit_type, density_unit
   use gyroakf_units, only : quantity, unit_type
   use gyroakf_allan_deviations, only : allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : coefficient_type, noise_options, noise_type, fit_noise
   use gyroakf_allan_read_off, only : read_off_type, read_off
   use gyroakf_progress, only : progress_type
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, &
      stated_coefficient_type, stated_noise_type, stated_read_off_type, stage, stage_names
   use gyroakf_pipeline_verdict, only : octaves_without_trend, options_beside
   use gyroakf_pipeline_warnings, only : job_ends, note_failure
   implicit none (type, external)
   private
   public :: run_allan, state_noise, state_one, state_read_off, compare_coefficients

contains

   !> Computes the curve of one series, fits the coefficients and states them. A failure is noted in
   !> the channel.
   subroutine run_allan(x, record, options, which, channel, error, valid, progress)
      !> The series, in the unit of the record: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval and unit
      type(record_type), intent(in) :: record
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> Component of [[gyroakf_pipeline_allan_result:stage]]
      integer, intent(in) :: which
      !> `allan(which)` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, internal; everything else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call compute_allan(x, record%sample_interval, options%allan, channel%allan(which)%curve, &
                         error, valid, progress)
      channel%allan(which)%available = .not. allocated(error)
      call note_failure(channel, "Allan deviation ("//trim(stage_names(which))//")", error)
      if (.not. channel%allan(which)%available) return
      if (allocated(options%other_kinds) .and. which <= stage%cleaned) then
         call run_other_kinds(x, record%sample_interval, options, which, channel, error, valid, &
                              progress)
         if (allocated(error)) return
      end if
      if (which <= stage%outliers_removed) call octaves_without_trend( &
         x, options, channel%verdict, channel%allan(which)%curve, error, valid, progress)
      if (.not. allocated(error)) call fit_curve(record, options, which, channel, error)
   end subroutine run_allan

   !> Fits the coefficients of a curve and states them. A failure is noted in the channel.
   subroutine fit_curve(record, options, which, channel, error)
      type(record_type), intent(in) :: record
      type(pipeline_options), intent(in) :: options
      integer, intent(in) :: which
      !> The rest of `allan(which)` is filled
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      type(noise_options) :: noise_of_stage

      noise_of_stage = options%noise
      if (which <= stage%cleaned) noise_of_stage%lsb = channel%quantisation%step
      if (which <= stage%outliers_removed) noise_of_stage = options_beside(noise_of_stage, &
                                                                           channel%verdict)
      if (which == stage%compensated) call end_before_smoother(channel, noise_of_stage)
      associate (allan => channel%allan(which))
         call fit_noise(allan%curve, noise_of_stage, allan%noise, error)
         allan%fitted = .not. allocated(error)
         if (allan%fitted) then
            call state_noise(allan%noise, record%rate_known, record%unit, allan%stated)
            call read_off(allan%curve, allan%read, error)
            if (.not. allocated(error)) call state_read_off(allan%read, record%rate_known, &
                                                            record%unit, allan%read_off)
            return
         end if
      end associate
      call note_failure(channel, "noise coefficients ("//trim(stage_names(which))//")", error)
   end subroutine fit_curve

   !> Beyond a quarter of its time constant, the interval over the gain, the smoother takes more
   !> than 1 % of the white noise's variance along with the drift: the curve falls below that of the
   !> noise, and is not fitted there. Q and N are what is left.
   pure subroutine end_before_smoother(channel, noise)
      !> Its drift filter is done
      type(channel_result_type), intent(in) :: channel
      !> Its longest averaging time is set
      type(noise_options), intent(inout) :: noise
      real(dp) :: longest

      if (.not. channel%drift_kf%gain > 0.0_dp) return
      longest = channel%allan(stage%compensated)%curve%sample_interval/ &
         (4.0_dp*channel%drift_kf%gain)
      noise%tau_max = min(longest, noise%tau_max)
      if (noise%terms == "auto") noise%terms = "QN"
   end subroutine end_before_smoother

   !> Computes the curves of the further kinds. A failure is noted in the channel.
   subroutine run_other_kinds(x, step, options, which, channel, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      type(pipeline_options), intent(in) :: options
      integer, intent(in) :: which
      !> `allan(which)%other` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, internal; everything else is a warning of the channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(allan_options) :: one
      character(:), allocatable :: kinds
      integer :: i, from, to

      kinds = options%other_kinds//","
      one = options%allan
      allocate (channel%allan(which)%other(count([(kinds(i:i) == ",", i=1, len(kinds))])))
      from = 1
      do i = 1, size(channel%allan(which)%other)
         to = from + index(kinds(from:), ",") - 2
         one%kind = kinds(from:to)
         call compute_allan(x, step, one, channel%allan(which)%other(i), error, valid, progress)
         if (allocated(error)) then
            if (any(error%code == job_ends) .and. error%code /= status%not_supported) return
            call add_text(channel%warnings, trim(stage_names(which))//": "//error%message)
            deallocate (error)
         end if
         from = to + 2
      end do
   end subroutine run_other_kinds

   !> States coefficients in the units of the report: Q arcsec, N deg/sqrt(h), B deg/h, K deg/h^1.5,
   !> R deg/h^2 for a rate; in SI; and which convention each number has.
   !>
   !> Without a rate they stay per sample, without a unit in input units, and the unit's name says
   !> so; there is no SI and no density then. A two-sided density S of the rate gives
   !> \( \sigma^2 = S/\tau \): its root is N. The one-sided density is 2 S, its root
   !> \( \sqrt 2 N \).
   subroutine state_noise(noise, rate_known, unit, stated)
      !> In units of the series and s (samples)
      type(noise_type), intent(in) :: noise
      !> The time unit is the second
      logical, intent(in) :: rate_known
      !> Unit of the series
      type(unit_type), intent(in) :: unit
      !> Value, error and limit of each term
      type(stated_noise_type), intent(out) :: stated
      character(20), parameter :: conventions(2) = [character(20) :: "two-sided: N", &
                                                    "one-sided: sqrt(2) N"]
      real(dp), parameter :: sides(2) = [1.0_dp, sqrt(2.0_dp)]
      type(coefficient_unit_type) :: of_density
      integer :: i

      stated%in_units = rate_known .and. unit%quantity /= quantity%unknown
      do i = 1, 5
         call state_one(noise%coefficient(i), i, rate_known, unit, stated%term(i))
         call state_si(noise%coefficient(i), i, stated%in_units, unit, stated%term(i))
         stated%term(i)%definition = coefficient_definition(i)
      end do
      call state_one(noise%unquantized, 2, rate_known, unit, stated%unquantized)
      call state_si(noise%unquantized, 2, stated%in_units, unit, stated%unquantized)
      stated%unquantized%definition = "N without the variance of rounding, step^2/12"
      stated%lsb_ratio = noise%lsb_ratio
      if (.not. stated%in_units) return
      of_density = density_unit(unit)
      do i = 1, 2
         associate (density => stated%density(i), n => noise%coefficient(2))
            call state_scaled(n, sides(i)*unit%to_si*of_density%from_si, density)
            density%unit = of_density%name
            density%definition = trim(conventions(i))
            density%value_si = sides(i)*unit%to_si*n%value
            density%std_error_si = sides(i)*unit%to_si*n%std_error
            density%upper_limit_si = sides(i)*unit%to_si*n%upper_limit
            density%unit_si = of_density%si_name
         end associate
      end do
   end subroutine state_noise

   !> One coefficient in the unit of a term.
   subroutine state_one(from, term, rate_known, unit, to)
      !> In units of the series and s (samples)
      type(coefficient_type), intent(in) :: from
      !> 1 .. 5 for the unit of Q N B K R
      integer, intent(in) :: term
      !> The time unit is the second
      logical, intent(in) :: rate_known
      !> Unit of the series
      type(unit_type), intent(in) :: unit
      !> As stated
      type(stated_coefficient_type), intent(inout) :: to
      type(coefficient_unit_type) :: of_term

      of_term = coefficient_unit(unit, term, per_sample=.not. rate_known)
      call state_scaled(from, unit%to_si*of_term%from_si, to)
      to%unit = of_term%name
      to%state = from%state
   end subroutine state_one

   !> The numbers of a coefficient times a factor.
   pure subroutine state_scaled(from, factor, to)
      type(coefficient_type), intent(in) :: from
      real(dp), intent(in) :: factor
      type(stated_coefficient_type), intent(inout) :: to

      to%value = factor*from%value
      to%std_error = factor*from%std_error
      to%upper_limit = factor*from%upper_limit
      to%detected = from%detected
      to%fitted = from%fitted
   end subroutine state_scaled

   !> The numbers of a coefficient in SI, where unit and rate are known.
   subroutine state_si(from, term, in_units, unit, to)
      type(coefficient_type), intent(in) :: from
      integer, intent(in) :: term
      logical, intent(in) :: in_units
      type(unit_type), intent(in) :: unit
      type(stated_coefficient_type), intent(inout) :: to
      type(coefficient_unit_type) :: of_term

      to%unit_si = ""
      if (.not. in_units) return
      of_term = coefficient_unit(unit, term)
      to%value_si = unit%to_si*from%value
      to%std_error_si = unit%to_si*from%std_error
      to%upper_limit_si = unit%to_si*from%upper_limit
      to%unit_si = of_term%si_name
   end subroutine state_si

   !> States what was read off the curve in the units of the coefficients, the minimum in that of B.
   subroutine state_read_off(read, rate_known, unit, stated)
      !> In units of the series and s (samples)
      type(read_off_type), intent(in) :: read
      !> The time unit is the second
      logical, intent(in) :: rate_known
      !> Unit of the series
      type(unit_type), intent(in) :: unit
      !> Values where there are any
      type(stated_read_off_type), intent(out) :: stated
      type(coefficient_unit_type) :: of_term
      integer :: term

      do term = 1, 5
         of_term = coefficient_unit(unit, term, per_sample=.not. rate_known)
         stated%value(term) = unit%to_si*of_term%from_si*read%value(term)
         if (term == 3) stated%minimum = unit%to_si*of_term%from_si*read%minimum
      end do
      stated%found = read%found
      stated%minimum_tau = read%minimum_tau
      stated%known = read%minimum > 0.0_dp
      stated%falling = read%falling
   end subroutine state_read_off

   !> Reduction of each coefficient from the cleaned series to the adaptive filter's output (Table
   !> III of the paper).
   !>
   !> A percentage only where the coefficient is detected in both; where it is detected before and
   !> not after, the upper limit gives the least reduction that the record proves.
   pure subroutine compare_coefficients(channel)
      !> `reduction_percent`, `reduction_known`, `reduction_at_least` are filled
      type(channel_result_type), intent(inout) :: channel
      integer :: term

      if (.not. (channel%allan(stage%cleaned)%fitted .and. channel%allan(stage%akf)%fitted)) return
      do term = 1, 5
         associate (before => channel%allan(stage%cleaned)%stated%term(term), &
                    after => channel%allan(stage%akf)%stated%term(term))
            if (.not. before%detected .or. before%value <= 0.0_dp) cycle
            if (after%detected) then
               channel%reduction_percent(term) = 100.0_dp*(1.0_dp - after%value/before%value)
               channel%reduction_known(term) = .true.
            else if (after%fitted .and. after%upper_limit < before%value) then
               channel%reduction_at_least(term) = &
                  100.0_dp*(1.0_dp - after%upper_limit/before%value)
            end if
         end associate
      end do
   end subroutine compare_coefficients

end module gyroakf_pipeline_coefficients
