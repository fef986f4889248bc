! SPDX-License-Identifier: MIT
!> Allan curve and noise coefficients of one series of a channel, stated in the units of the report
!> and in SI, N as a density in both conventions, and compared.
module gyroakf_pipeline_coefficients
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : error_type, status
   use gyroakf_record, only : add_text
   use gyroakf_coefficient_units, only : coefficient_definition, coefficient_unit, &
      coefficient_unit_type, density_unit
   use gyroakf_units, only : quantity, unit_type
   use gyroakf_allan_deviations, only : allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : coefficient_type, noise_options, noise_type, fit_noise
   use gyroakf_allan_noise_model, only : term_ramp, term_walk
   use gyroakf_allan_read_off, only : read_off_type, read_off
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type, stated_coefficient_type, &
      stated_noise_type, stated_read_off_type, stage, stage_names
   use gyroakf_pipeline_verdict, only : octaves_without_trend, options_beside
   use gyroakf_pipeline_warnings, only : job_ends, note_failure
   implicit none (type, external)
   private
   public :: run_allan, state_noise, state_one, state_read_off, withhold, compare_coefficients

contains

   !> Computes the curve of one series, fits the coefficients and states them. A failure is noted in
   !> the channel.
   subroutine run_allan(job, x, which, channel, error)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> The series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Component of [[gyroakf_pipeline_allan_result:stage]]
      integer, intent(in) :: which
      !> `allan(which)` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, internal; everything else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), pointer, contiguous :: valid(:)

      valid => job%valid
      if (which == stage%input) valid => job%recorded
      call compute_allan(x, job%step, job%options%allan, channel%allan(which)%curve, error, valid, &
                         job%progress)
      call note_failure(channel%unavailable, "Allan deviation ("//trim(stage_names(which))//")", &
                        error, channel%allan(which)%available)
      if (.not. channel%allan(which)%available) return
      if (allocated(job%options%other_kinds) .and. which <= stage%cleaned) then
         call run_other_kinds(job, x, valid, which, channel, error)
         if (allocated(error)) return
      end if
      if (which <= stage%outliers_removed) call octaves_without_trend(job, valid, channel%verdict, &
         channel%allan(which)%curve, error)
      if (.not. allocated(error)) call fit_curve(job, which, channel, error)
   end subroutine run_allan

   !> Fits the coefficients of a curve and states them. A failure is noted in the channel.
   subroutine fit_curve(job, which, channel, error)
      type(job_type), intent(in) :: job
      integer, intent(in) :: which
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      type(noise_options) :: noise_of_stage

      noise_of_stage = job%options%noise
      if (which <= stage%cleaned) noise_of_stage%lsb = channel%quantization%step
      if (which <= stage%outliers_removed) noise_of_stage = options_beside(noise_of_stage, &
                                                                           channel%verdict)
      if (which == stage%compensated) call end_before_smoother(channel, noise_of_stage)
      associate (allan => channel%allan(which))
         call fit_noise(allan%curve, noise_of_stage, allan%noise, error)
         allan%fitted = .not. allocated(error)
         if (allan%fitted) then
            call state_noise(allan%noise, job%rate_known, job%unit, allan%stated)
            call read_off(allan%curve, allan%read, error)
            if (.not. allocated(error)) call state_read_off(allan%read, job%rate_known, job%unit, &
                                                            allan%read_off)
            return
         end if
      end associate
      call note_failure(channel%unavailable, &
                        "noise coefficients ("//trim(stage_names(which))//")", error)
   end subroutine fit_curve

   !> Beyond a quarter of its time constant, the interval over the gain, the smoother takes more
   !> than 1 % of the white noise's variance along with the drift: the curve falls below that of the
   !> noise, and is not fitted there. Q and N are what is left.
   pure subroutine end_before_smoother(channel, noise)
      type(channel_result_type), intent(in) :: channel
      type(noise_options), intent(inout) :: noise
      real(dp) :: longest

      if (.not. channel%drift_kf%gain > 0.0_dp) return
      longest = channel%allan(stage%compensated)%curve%sample_interval/ &
         (4.0_dp*channel%drift_kf%gain)
      noise%tau_max = min(longest, noise%tau_max)
      if (noise%terms == "auto") noise%terms = "QN"
   end subroutine end_before_smoother

   !> Computes the curves of the further kinds. A failure is noted in the channel.
   subroutine run_other_kinds(job, x, valid, which, channel, error)
      type(job_type), intent(in) :: job
      real(dp), intent(in), contiguous :: x(:)
      integer(int8), pointer, contiguous, intent(in) :: valid(:)
      integer, intent(in) :: which
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, internal; everything else is a warning of the channel
      type(error_type), allocatable, intent(out) :: error
      type(allan_options) :: one
      character(:), allocatable :: kinds
      integer :: i, from, to

      kinds = job%options%other_kinds//","
      one = job%options%allan
      allocate (channel%allan(which)%other(count([(kinds(i:i) == ",", i=1, len(kinds))])))
      from = 1
      do i = 1, size(channel%allan(which)%other)
         to = from + index(kinds(from:), ",") - 2
         one%kind = kinds(from:to)
         call compute_allan(x, job%step, one, channel%allan(which)%other(i), error, valid, &
                            job%progress)
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
      integer :: i

      stated%in_units = rate_known .and. unit%quantity /= quantity%unknown
      do i = 1, 5
         call state_one(noise%coefficient(i), i, rate_known, unit, stated%term(i))
         stated%term(i)%definition = coefficient_definition(i)
      end do
      call state_one(noise%unquantized, 2, rate_known, unit, stated%unquantized)
      stated%unquantized%definition = "N without the variance of rounding, step^2/12"
      stated%lsb_ratio = noise%lsb_ratio
      if (.not. stated%in_units) return
      do i = 1, 2
         call state_in(noise%coefficient(2), sides(i)*unit%to_si, density_unit(unit), .true., &
                       stated%density(i))
         stated%density(i)%state = ""
         stated%density(i)%definition = trim(conventions(i))
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

      call state_in(from, unit%to_si, coefficient_unit(unit, term, per_sample=.not. rate_known), &
                    rate_known .and. unit%quantity /= quantity%unknown, to)
   end subroutine state_one

   !> The numbers of a coefficient in a unit, and in SI where that is known.
   pure subroutine state_in(from, to_si, of, in_si, to)
      type(coefficient_type), intent(in) :: from
      !> From the unit of the series to SI
      real(dp), intent(in) :: to_si
      type(coefficient_unit_type), intent(in) :: of
      logical, intent(in) :: in_si
      type(stated_coefficient_type), intent(inout) :: to

      to%coefficient_type = from
      to%value = to_si*of%from_si*from%value
      to%std_error = to_si*of%from_si*from%std_error
      to%upper_limit = to_si*of%from_si*from%upper_limit
      to%unit = of%name
      to%unit_si = ""
      if (.not. in_si) return
      to%value_si = to_si*from%value
      to%std_error_si = to_si*from%std_error
      to%upper_limit_si = to_si*from%upper_limit
      to%unit_si = of%si_name
   end subroutine state_in

   !> No coefficient of the record as read says what the verdict excludes: K without a random walk,
   !> R beside a trend or none.
   subroutine withhold(job, channel)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> With the verdict; what its curves state is changed
      type(channel_result_type), intent(inout) :: channel
      integer :: which

      if (.not. channel%verdict%known) return
      do which = stage%input, merge(stage%cleaned, stage%outliers_removed, &
                                    channel%clean%trend%degree < 0)
         associate (verdict => channel%verdict, allan => channel%allan(which), &
                    walk => channel%allan(which)%noise%coefficient(term_walk), &
                    ramp => channel%allan(which)%noise%coefficient(term_ramp))
            if (.not. allan%fitted) cycle
            if (walk%detected .and. .not. verdict%walks) then
               walk = coefficient_type(state="withheld")
            end if
            if (verdict%trend%shape /= "" .or. (verdict%drift /= "random_walk_or_trend" .and. &
                                                ramp%detected)) then
               ramp = coefficient_type(state="withheld")
            end if
            call state_noise(allan%noise, job%rate_known, job%unit, allan%stated)
         end associate
      end do
   end subroutine withhold

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

      stated%read_off_type = read
      do term = 1, 5
         of_term = coefficient_unit(unit, term, per_sample=.not. rate_known)
         stated%value(term) = unit%to_si*of_term%from_si*read%value(term)
         if (term == 3) stated%minimum = unit%to_si*of_term%from_si*read%minimum
      end do
      stated%known = read%minimum > 0.0_dp
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
               channel%reduction_at_least(term) = 100.0_dp*(1.0_dp - after%upper_limit/before%value)
            end if
         end associate
      end do
   end subroutine compare_coefficients

end module gyroakf_pipeline_coefficients
