! SPDX-License-Identifier: MIT
!> What the user must know about a filter's result, in sentences: warnings, and notes.
!>
!> A verdict goes by the size of the effect, with the numbers in it.
module gyroakf_filter_filter_warnings
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : text_type, add_text
   use gyroakf_filter_filter_types, only : filter_type
   implicit none (type, external)
   private
   public :: colored, filter_facts, filter_warnings, significant

   !> Share of the measurements with Q or R at a bound, or gated, that is worth a word
   real(dp), parameter :: often = 0.05_dp
   !> Gain below which an adaptive filter has lost the measurements
   real(dp), parameter :: collapsed = 1.0e-3_dp
   !> Gain above which a filter that adapts R only passes the series through
   real(dp), parameter :: passing = 0.9_dp
   !> Autocorrelation of the innovations that a good model does not leave
   real(dp), parameter :: colored = 0.1_dp
   !> Significance that is asked for beside it: a short series has such autocorrelations by chance
   real(dp), parameter :: significant = 0.01_dp
   !> DC gain below which a true rotation is visibly attenuated
   real(dp), parameter :: attenuated = 0.95_dp
   !> Mean NIS within these is called consistent
   real(dp), parameter :: lowest_nis = 0.8_dp, highest_nis = 1.25_dp

   !> The numbers that are judged
   type :: filter_facts
      !> Measurements, those with Q or R at a bound, those gated
      integer(int64) :: measurements = 0, clamped = 0, gated = 0
      !> As in filter_result_type
      real(dp) :: gain = 0, dc_gain = 0, nis_mean = 0, largest_rho = 0, p_value = 1
   end type filter_facts

contains

   !> The warnings that apply, the gravest first.
   pure subroutine filter_warnings(filter, facts, warnings)
      !> The filter after the series
      type(filter_type), intent(in) :: filter
      !> Its diagnostics
      type(filter_facts), intent(in) :: facts
      !> Sentences, [0 ...]
      type(text_type), allocatable, intent(out) :: warnings(:)
      logical :: paper

      allocate (warnings(0))
      paper = filter%drift_model%count == 0         ! its variances are not meant to be those of the series
      call judge_adaptation(filter, facts, warnings)
      if (facts%dc_gain < attenuated .and. paper) then     ! a drift filter's output is not the rotation
         call add_text(warnings, "of a constant true rotation the output keeps "//trim(percent(facts%dc_gain)) &
                       //": do not navigate with it", note=.true.)
      end if
      if (facts%largest_rho > colored .and. facts%p_value < significant) then
         call add_text(warnings, "the innovations are not white: an autocorrelation of "//trim(decimal(facts%largest_rho)) &
                       //" within 20 lags (p "//trim(probability(facts%p_value)) &
                       //", a good model leaves less than 0.10); the model does not describe the series", note=paper)
      end if
      if (facts%nis_mean < lowest_nis .or. facts%nis_mean > highest_nis) then
         call add_text(warnings, "the mean normalized innovation squared is "//trim(decimal(facts%nis_mean)) &
                       //" (1 is consistent): the variances that the filter states are not those of the series", note=paper)
      end if
      if (.not. any(abs(filter%phi) > 0.0_dp)) then
         call add_text(warnings, "the model is white noise: there is nothing to predict, " &
                       //"and the output is the series times the gain", note=.true.)
      end if
   end subroutine filter_warnings

   !> Warnings of the adaptation and the gate.
   pure subroutine judge_adaptation(filter, facts, warnings)
      !> As in filter_warnings
      type(filter_type), intent(in) :: filter
      type(filter_facts), intent(in) :: facts
      !> The list so far
      type(text_type), allocatable, intent(inout) :: warnings(:)
      real(dp) :: all_of_them

      all_of_them = real(max(1_int64, facts%measurements), dp)
      associate (options => filter%options)
         if (options%estimate_process_variance .and. options%estimate_measurement_variance) then
            call add_text(warnings, "Q and R are both adapted but not identifiable together: their sum follows the data, " &
                          //"their ratio, and with it the gain, does not", note=.true.)
         end if
         if (options%estimate_process_mean .and. options%estimate_measurement_mean) then
            call add_text(warnings, "q and r are both adapted but not identifiable together: " &
                          //"a constant offset may be in either", note=.true.)
         end if
         if (filter%adaptive .and. facts%gain < min(collapsed, 0.01_dp*filter%steady_gain(1))) then
            call add_text(warnings, "the gain has collapsed to "//trim(decimal(facts%gain)) &
                          //": the output no longer follows the measurements")
         end if
         if (options%estimate_measurement_variance .and. facts%gain > passing) then
            call add_text(warnings, "R has fallen towards zero: the series holds hardly any white measurement noise beside " &
                          //"the model, and the filter passes it through (gain "//trim(decimal(facts%gain))//")")
         else if (real(facts%clamped, dp) > often*all_of_them) then
            call add_text(warnings, "Q or R was held at a bound at "//trim(percent(real(facts%clamped, dp)/all_of_them)) &
                          //" of the measurements")
         end if
         if (real(facts%gated, dp) > often*all_of_them) then
            call add_text(warnings, "the gate acted at "//trim(percent(real(facts%gated, dp)/all_of_them)) &
                          //" of the measurements: outliers, or variances that are too small")
         end if
      end associate
   end subroutine judge_adaptation

   !> A probability below 0.01, "= 0.004" or "< 0.001".
   pure function probability(p) result(text)
      !> 0 ... 0.01
      real(dp), intent(in) :: p
      character(24) :: text

      text = "< 0.001"
      if (p >= 0.001_dp) write (text, "(a, f5.3)") "= ", p
   end function probability

   !> A share as percent, "60.7 %". (Of fixed length, as below: gfortran 12 keeps the length of a deferred-length
   !> result in static memory, which two threads would share.)
   pure function percent(share) result(text)
      !> 1 is everything
      real(dp), intent(in) :: share
      character(24) :: text

      write (text, "(f20.1)") 100.0_dp*share
      text = trim(adjustl(text))//" %"
   end function percent

   !> Two decimals, or three significant digits where the number is small.
   pure function decimal(value) result(text)
      !> The number
      real(dp), intent(in) :: value
      character(24) :: text

      if (abs(value) >= 0.01_dp .and. abs(value) < 1.0e6_dp) then
         write (text, "(f20.2)") value
      else
         write (text, "(es10.2)") value
      end if
      text = adjustl(text)
   end function decimal
end module gyroakf_filter_filter_warnings
