! SPDX-License-Identifier: MIT
!> Verdicts in words: whether a channel drifts, and what its tests and its fit say. Texts are of one
!> length and padded: gfortran keeps others in static memory, which threads share.
module gyroakf_report_verdicts
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_pipeline_warnings, only : certain, negligible_rho
   use gyroakf_stats_whiteness, only : ljung_box_type
   implicit none (type, external)
   private
   public :: verdict_text, level, rejection_text, whiteness_word, whiteness_text, normality_text
   public :: correlation_caution, periodicity_text, drift_source_text, slopes_text

   !> Tests reject at this significance
   real(dp), parameter :: level = 0.05_dp
   !> No verdict is longer
   integer, parameter :: remark_length = 500
   !> A change of the noise from the first to the second half is a part of the verdict where the
   !> logarithm of the ratio of the deviations is larger
   real(dp), parameter :: large_change = 0.2_dp
   !> Fewer periods in a record are drift
   integer(int64), parameter :: fewest_periods = 5_int64

contains

   !> "stationary, flicker", "stationary, variance changes", "drifts: random walk".
   pure function verdict_text(channel) result(text)
      !> With its verdict
      type(channel_result_type), intent(in) :: channel
      character(remark_length) :: text

      associate (verdict => channel%verdict)
         select case (verdict%drift)
         case ("none"); text = "stationary"
         case ("flicker"); text = "stationary, flicker"
         case ("colored"); text = "stationary, colored"
         case ("random_walk"); text = "drifts: random walk"
         case ("trend"); text = "drifts: "//trim(verdict%trend%shape)
         case ("trend_and_random_walk")
            text = "drifts: "//trim(verdict%trend%shape)//" and random walk"
         case ("random_walk_or_trend"); text = "drifts: random walk or ramp"
         case ("unit_root"); text = "drifts: unit root not rejected"
         case default
            text = merge("not described", "constant     ", channel%raw%variance > 0.0_dp)
         end select
         if (verdict%stationary .and. variance_changes(channel)) text = &
            trim(text)//", variance changes"
      end associate
   end function verdict_text

   !> Whether the noise of the second half is clearly larger or smaller than that of the first.
   pure logical function variance_changes(channel)
      type(channel_result_type), intent(in) :: channel

      variance_changes = channel%available%halves .and. channel%halves%p_value < certain
      if (variance_changes) variance_changes = abs(log(channel%halves%ratio( &
         maxloc(abs(channel%halves%score), dim=1)))) > large_change
   end function variance_changes

   !> "unit root rejected at 5 %".
   pure function rejection_text(hypothesis, rejected) result(text)
      !> What the test takes for granted
      character(*), intent(in) :: hypothesis
      logical, intent(in) :: rejected
      character(remark_length) :: text

      text = hypothesis//" not rejected at 5 %"
      if (rejected) text = hypothesis//" rejected at 5 %"
   end function rejection_text

   !> Whiteness in a word: significance alone would call every long record colored.
   pure function whiteness_word(test) result(text)
      !> Of residuals or innovations
      type(ljung_box_type), intent(in) :: test
      character(8) :: text

      text = "colored"
      if (test%largest_rho < negligible_rho) text = "nearly"
      if (.not. test%p_value < level) text = "white"
   end function whiteness_word

   !> The same in words.
   pure function whiteness_text(test) result(text)
      !> Of samples, residuals or innovations
      type(ljung_box_type), intent(in) :: test
      character(remark_length) :: text

      text = "not white"
      if (whiteness_word(test) == "white") text = "white"
      if (whiteness_word(test) == "nearly") text = "nearly white, a small correlation is seen "// &
         "because the record is long"
   end function whiteness_text

   !> What the tests of normality say together.
   pure function normality_text(channel) result(text)
      !> With its tests
      type(channel_result_type), intent(in) :: channel
      character(remark_length) :: text

      select case (channel%normality)
      case ("normal"); text = "normality not rejected"
      case ("nearly")
         text = "nearly normal, a small departure is seen because the record is long"
      case ("undecided"); text = "too few samples to tell"
      case default; text = "not normal"
      end select
   end function normality_text

   !> What correlation does to tests of normality, "" where there is little of it.
   pure function correlation_caution(channel) result(text)
      !> With its tests
      type(channel_result_type), intent(in) :: channel
      character(remark_length) :: text

      text = ""
      if (.not. channel%available%ljung_box) return
      if (whiteness_word(channel%ljung_box) == "colored") text = "the samples are correlated: "// &
         "the p-value is too small"
   end function correlation_caution

   !> What Fisher's test says.
   pure function periodicity_text(channel) result(text)
      !> With its periodogram
      type(channel_result_type), intent(in) :: channel
      character(remark_length) :: text

      associate (fisher => channel%periodicity%fisher)
         if (.not. fisher%p_value < level) then
            text = "no single period stands out"
         else if (fisher%ordinate < fewest_periods) then
            write (text, "(a, i0, a)") "slow changes stand out, less than ", fewest_periods, &
               " periods in the record: drift, not a period"
         else
            text = "a period stands out, or correlation that the AR model does not describe"
         end if
      end associate
   end function periodicity_text

   !> How the model of the drift was found.
   pure function drift_source_text(channel) result(text)
      !> With its drift model
      type(channel_result_type), intent(in) :: channel
      character(remark_length) :: text

      associate (drift => channel%drift)
         write (text, "(a, i0, a)") "maximum likelihood from ", drift%samples, " samples"
         if (drift%samples < drift%of_samples) write (text, "(2(a, i0), a)") &
            "maximum likelihood from the middle ", drift%samples, " of ", drift%of_samples, &
            " samples"
         if (drift%block > 1) write (text(len_trim(text) + 1:), "(a, i0, a)") &
            ", the slowest processes from means of ", drift%block, " samples over the whole record"
         if (.not. drift%errors_known .and. drift%model%count > 0) text = trim(text)// &
            "; standard errors are not known"
      end associate
   end function drift_source_text

   !> Slopes of a curve that the terms do not describe, over factors of 8 in averaging time.
   pure function slopes_text(curve) result(text)
      !> With two points or more
      type(allan_curve_type), intent(in) :: curve
      character(remark_length) :: text
      character(5) :: slope
      integer :: i, k

      text = "slope"
      i = 1
      do k = 2, size(curve%tau)
         if (curve%tau(k) < 7.9_dp*curve%tau(i)) cycle
         write (slope, "(sp, f5.2)") &
            log(curve%deviation(k)/curve%deviation(i))/log(curve%tau(k)/curve%tau(i))
         text = trim(text)//" "//slope//" from tau = "//format_real(curve%tau(i), 3)//" to "// &
            format_real(curve%tau(k), 3)//","
         i = k
      end do
      text = trim(text)//" where -1 is quantization, -1/2 white noise, 0 bias instability, "// &
         "+1/2 random walk"
   end function slopes_text

end module gyroakf_report_verdicts
