! SPDX-License-Identifier: MIT
!> The paragraph of a report on the distribution of a channel's samples.
module gyroakf_report_text_normality
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_stats_anderson_darling, only : rounding_statistic
   use gyroakf_report_text_layout, only : put_item, number, count_text, p_value_text, plural
   implicit none (type, external)
   private
   public :: put_normality

   !> A test decides at this level
   real(dp), parameter :: level = 0.05_dp
   !> The samples are called dependent where whiteness is rejected and an autocorrelation is as large as this
   real(dp), parameter :: colored = 0.05_dp
   !> A step is spoken of from this share of the standard deviation on, or where it adds so much to A2
   real(dp), parameter :: visible_step = 0.1_dp, visible_rounding = 0.1_dp

contains

   !> Verdict by skewness and kurtosis, the tests beside it, what they take for granted, and the step of the samples.
   subroutine put_normality(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%jarque_bera) then
         call put_item(writer, "Normality", "not tested (see below)")
         return
      end if
      call put_item(writer, "Normality", verdict_text(channel)//effect_text(channel)//"; "//tests_text(channel))
      if (channel%available%anderson_darling .and. channel%anderson_darling%stride > 1) then
         call put_item(writer, "", "Anderson-Darling of every "//count_text(channel%anderson_darling%stride)//ordinal( &
            channel%anderson_darling%stride)//" sample, "//count_text(channel%anderson_darling%samples)//" of them")
      end if
      if (channel%available%ljung_box .and. channel%ljung_box%p_value < level .and. &
          channel%ljung_box%largest_rho > colored) then
         call put_item(writer, "", "these tests take the samples as independent; with an autocorrelation of "// &
                       number(channel%ljung_box%largest_rho, 2)//" the errors are larger, the p-values too small")
      end if
      call put_quantisation(writer, channel)
   end subroutine put_normality

   !> The verdict in words.
   pure function verdict_text(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      select case (channel%normality)
      case ("normal"); text = "nothing speaks against a normal distribution: "
      case ("nearly"); text = "nearly normal, a small departure is seen because the record is long: "
      case ("undecided"); text = "too few samples to tell: "
      case default; text = "not normal: "
      end select
   end function verdict_text

   !> "skewness 0.01 +/- 0.02, excess kurtosis -0.1 +/- 0.04".
   pure function effect_text(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (test => channel%jarque_bera)
         text = "skewness "//number(test%skewness, 3)//" +/- "//number(test%skewness_error, 2)// &
                ", excess kurtosis "//number(test%kurtosis - 3, 3)// &
                " +/- "//number(test%kurtosis_error, 2)
      end associate
   end function effect_text

   !> "Jarque-Bera 3.2, p = 0.2; Anderson-Darling ...".
   pure function tests_text(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      text = "Jarque-Bera "//number(channel%jarque_bera%statistic, 4)//", "//p_value_text(channel%jarque_bera%p_value)
      if (channel%available%anderson_darling) text = text//"; Anderson-Darling "// &
         number(channel%anderson_darling%modified, 4)//", "//p_value_text(channel%anderson_darling%p_value)
   end function tests_text

   !> The step, where it counts.
   subroutine put_quantisation(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      real(dp) :: rounding

      rounding = 0.0_dp
      if (channel%available%anderson_darling) rounding = rounding_statistic(channel%quantisation%ratio, &
         channel%anderson_darling%samples)
      associate (grid => channel%quantisation)
         if (.not. grid%quantised) return
         if (grid%ratio < visible_step .and. rounding < visible_rounding) return
         text = "in steps of "//number(grid%step, 4)//", "//number(grid%ratio, 2)//" standard deviations"
         if (grid%levels > 0) text = text//", on "//plural(grid%levels, "level")
         if (grid%variance_share < 1.0_dp) then
            text = text//"; rounding is "//number(100*grid%variance_share, 2)//" % of the variance"
         else
            text = text//"; rounding hides the noise"
         end if
         if (grid%corrected_std > 0.0_dp .and. grid%ratio >= visible_step) text = text// &
            " (without it a standard deviation of "//number(grid%corrected_std, 5)//")"
         if (rounding >= visible_rounding) text = text//" and alone gives an Anderson-Darling statistic of about "// &
            number(rounding, 2)
         call put_item(writer, "Quantisation", text)
      end associate
   end subroutine put_quantisation

   !> "2nd", "3rd", "4th".
   pure function ordinal(value) result(ending)
      integer(int64), intent(in) :: value
      character(2) :: ending

      ending = "th"
      if (mod(value, 100_int64) >= 11 .and. mod(value, 100_int64) <= 13) return
      select case (mod(value, 10_int64))
      case (1); ending = "st"
      case (2); ending = "nd"
      case (3); ending = "rd"
      case default; ending = "th"
      end select
   end function ordinal

end module gyroakf_report_text_normality
