! SPDX-License-Identifier: MIT
!> The result of a filter over a series, and what the user must know about it, in sentences:
!> warnings, and notes.
!>
!> A verdict goes by the size of the effect, with the numbers in it.
module gyroakf_filter_filter_warnings
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : text_type, add_text
   use gyroakf_stats_whiteness, only : ljung_box_type
   use gyroakf_filter_filter_types, only : drift_filter_type, filter_type
   implicit none (type, external)
   private
   public :: colored, filter_result_type, list_warnings, significant

   !> Share of the measurements with Q or R at a bound, or gated, that is worth a word
   real(dp), parameter :: notable_share = 0.05_dp
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

   !> What a filter did to a series
   type :: filter_result_type
      !> Mean and variance (ddof 1) of the output, over the present samples
      real(dp) :: mean = 0, variance = 0
      !> Mean of the first gain over the last third of the series
      real(dp) :: gain = 0
      !> Share of a constant true rotation that passes, from the mean gain; with q or r adapted, the
      !> share left after the memory 1/(1 - b)
      real(dp) :: dc_gain = 0
      !> Variances Q, R and means q, r at the end
      real(dp) :: q = 0, r = 0, q_mean = 0, r_mean = 0
      !> Mean of the squared normalized innovations; 1 where the stated variances are those of the
      !> series
      real(dp) :: nis_mean = 0
      !> Where it lies in 95 of 100 series of the model: quantiles of chi-square over the
      !> innovations' count
      real(dp) :: nis_low = 0, nis_high = 0
      !> Whiteness of the normalized innovations, 20 lags, no fitted parameters subtracted
      type(ljung_box_type) :: ljung_box
      !> Forgetting factor b; 0: nothing is adapted
      real(dp) :: forgetting = 0
      !> What is adapted: "q", "r", "Q", "R"; [0 ... 4]
      type(text_type), allocatable :: estimate(:)
      !> Measurements with Q or R at a bound, measurements at which the gate acted, samples
      integer(int64) :: clamped = 0, gated = 0, steps = 0
      !> What the user must know, in sentences
      type(text_type), allocatable :: warnings(:)
   end type filter_result_type

contains

   !> The warnings that apply, the gravest first.
   pure subroutine list_warnings(filter, measurements, result)
      !> The filter after the series
      class(filter_type), intent(in) :: filter
      !> Measurements that have an innovation
      integer(int64), intent(in) :: measurements
      !> Its diagnostics; gets the warnings
      type(filter_result_type), intent(inout) :: result
      logical :: of_drift
      character(24) :: p_value

      allocate (result%warnings(0))
      of_drift = .false.
      select type (filter)
      type is (drift_filter_type)
         of_drift = .true.
      end select
      call judge_adaptation(filter, measurements, result)
      ! a drift filter's output is not the rotation
      if (result%dc_gain < attenuated .and. .not. of_drift) then
         call add_text(result%warnings, "of a constant true rotation the output keeps " &
            //trim(percent(result%dc_gain))//": do not navigate with it", note=.true.)
      end if
      ! the variances of a filter of the AR state are not meant to be those of the series: a note
      p_value = "< 0.001"
      if (result%ljung_box%p_value >= 0.001_dp) write (p_value, "(a, f5.3)") "= ", &
         result%ljung_box%p_value
      if (result%ljung_box%largest_rho > colored .and. result%ljung_box%p_value < significant) then
         call add_text(result%warnings, "the innovations are not white: an autocorrelation of " &
                       //trim(decimal(result%ljung_box%largest_rho))//" within 20 lags (p " &
                       //trim(p_value) &
                       //", a good model leaves less than 0.10); the model does not describe " &
                       //"the series", note=.not. of_drift)
      end if
      if (result%nis_mean < lowest_nis .or. result%nis_mean > highest_nis) then
         call add_text(result%warnings, "the mean normalized innovation squared is "// &
                       trim(decimal(result%nis_mean))//" (1 is consistent): the variances that " &
                       //"the filter states are not those of the series", note=.not. of_drift)
      end if
      if (.not. any(abs(filter%phi) > 0.0_dp)) then
         call add_text(result%warnings, "the model is white noise: there is nothing to predict, " &
                       //"and the output is the series times the gain", note=.true.)
      end if
   end subroutine list_warnings

   !> Warnings of the adaptation and the gate.
   pure subroutine judge_adaptation(filter, measurements, result)
      class(filter_type), intent(in) :: filter
      integer(int64), intent(in) :: measurements
      type(filter_result_type), intent(inout) :: result
      real(dp) :: all_of_them

      all_of_them = real(max(1_int64, measurements), dp)
      associate (options => filter%options)
         if (options%estimate_process_variance .and. options%estimate_measurement_variance) then
            call add_text(result%warnings, &
               "Q and R are both adapted but not identifiable together: their sum follows the " &
               //"data, their ratio, and with it the gain, does not; adapt R alone", note=.true.)
         end if
         if (options%estimate_process_mean .and. options%estimate_measurement_mean) then
            call add_text(result%warnings, &
               "q and r are both adapted but not identifiable together: " &
                          //"a constant offset may be in either", note=.true.)
         end if
         if (filter%adaptive .and. result%gain < min(collapsed, 0.01_dp*filter%steady_gain(1))) then
            call add_text(result%warnings, "the gain has collapsed to " &
               //trim(decimal(result%gain))//": the output no longer follows the measurements")
         end if
         if (options%estimate_measurement_variance .and. result%gain > passing) then
            call add_text(result%warnings, &
               "R has fallen towards zero: the series holds hardly any white measurement noise " &
                          //"beside the model, and the filter passes it through (gain "// &
                          trim(decimal(result%gain))//")")
         else if (real(result%clamped, dp) > notable_share*all_of_them) then
            call add_text(result%warnings, "Q or R was held at a bound at " &
               //trim(percent(real(result%clamped, dp)/all_of_them))//" of the measurements")
         end if
         if (real(result%gated, dp) > notable_share*all_of_them) then
            call add_text(result%warnings, "the gate acted at "//trim(percent(real(result%gated, &
               dp)/all_of_them))//" of the measurements: outliers, or variances that are too small")
         end if
      end associate
   end subroutine judge_adaptation

   !> A share as percent, "60.7 %". (Of fixed length, as below: gfortran 12 keeps the length of a
   !> deferred-length result in static memory, which two threads would share.)
   pure function percent(share) result(text)
      !> 1 is everything
      real(dp), intent(in) :: share
      character(24) :: text

      write (text, "(f20.1)") 100.0_dp*share
      text = trim(adjustl(text))//" %"
   end function percent

   !> Two decimals, or three significant digits where the number is small.
   pure function decimal(value) result(text)
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
