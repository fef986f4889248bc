! SPDX-License-Identifier: MIT
!> What was removed from a channel, and the members of "tests" that tell the distribution of its
!> samples and what is periodic, described.
module gyroakf_report_document_distribution
   use gyroakf_kinds, only : dp, int64
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_verdicts, only : level, periodicity_text, rejection_text
   implicit none (type, external)
   private
   public :: put_preprocess, put_distribution, put_fisher, put_welch

contains

   !> "preprocess": null where the record was taken as it is.
   subroutine put_preprocess(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      integer(int64) :: k

      if (.not. out%opens("preprocess", channel%available%preprocess, "Removed")) return
      call out%open("outliers", "Outliers")
      call out%put("method", trim(channel%clean%method))
      call out%put("threshold", channel%clean%threshold, unit="sigma")
      call out%put("passes", channel%clean%passes)
      call out%put("removed", channel%clean%removed)
      call out%put("fraction", channel%clean%fraction)
      call out%put("expected", channel%clean%expected, title="expected in normal noise")
      call out%put("half_width", channel%clean%half_width, channel%clean%half_width > 0)
      call out%put("converged", channel%clean%converged)
      call out%close()
      call out%open("motion", "Motion", list=.true.)
      if (allocated(channel%clean%motion)) then
         do k = 1, size(channel%clean%motion, 2, kind=int64)
            call out%open("")
            call out%put("first", channel%clean%motion(1, k), title="from sample")
            call out%put("last", channel%clean%motion(2, k), title="to")
            call out%close()
         end do
      end if
      call out%close()
      call out%open("trend", "Trend")
      call out%put("degree", channel%clean%trend%degree)
      if (allocated(channel%clean%trend%power)) then
         call out%put("coefficients", channel%clean%trend%power, &
                      title="coefficients of i^0, i^1, ...")
      else
         call out%put("coefficients")
      end if
      call out%close()
      call out%put("mean", channel%clean%mean, shown=.false.)
      call out%put("variance", channel%clean%variance)
      call out%put("corrected_variance", channel%clean%corrected_variance, &
                   channel%clean%corrected_variance > 0)
      call out%close()
   end subroutine put_preprocess

   !> "normality", "anderson_darling", "quantisation"; null where one is not available.
   subroutine put_distribution(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      call out%put("normality", trim(channel%normality), channel%available%jarque_bera, &
                   shown=.false.)
      associate (is => channel%available, test => channel%anderson_darling, &
                 steps => channel%quantization)
         if (out%opens("anderson_darling", is%anderson_darling, "Anderson-Darling")) then
            call out%remark(rejection_text("normality", test%p_value < level))
            call out%put("statistic", test%statistic)
            call out%put("modified", test%modified)
            call out%put("p_value", test%p_value)
            call out%put("distance", test%distance)
            call out%put("samples", test%samples)
            call out%put("stride", test%stride)
            call out%close()
         end if
         if (out%opens("quantisation", is%quantization, "Quantization", steps%quantized)) then
            call out%put("quantised", steps%quantized, title="quantized")
            call out%put("step", steps%step)
            call out%put("step_over_std", steps%ratio)
            call out%put("variance_share", steps%variance_share)
            call out%put("levels", steps%levels)
            call out%put("corrected_std", steps%corrected_std)
            call out%close()
         end if
      end associate
   end subroutine put_distribution

   !> "fisher_g".
   subroutine put_fisher(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      if (.not. out%opens("fisher_g", channel%available%periodicity, "Fisher's g")) return
      call out%remark(periodicity_text(channel))
      call out%put("statistic", channel%periodicity%fisher%statistic)
      call out%put("p_value", channel%periodicity%fisher%p_value)
      call out%put("frequency_hz", channel%fisher_frequency, unit=trim(channel%frequency_unit))
      call out%put("log_p_value", channel%periodicity%fisher%log_p_value, shown=.false.)
      call out%put("applied_to", trim(channel%whitened))
      call out%put("samples", channel%periodicity%samples)
      call out%put("frequency_unit", trim(channel%frequency_unit), shown=.false.)
      call out%put("of_samples", channel%periodicity%total)
      call out%put("first_sample", channel%periodicity%first, shown=.false.)
      call out%close()
   end subroutine put_fisher

   !> "welch": what spectrum.csv holds.
   subroutine put_welch(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      if (.not. out%opens("welch", channel%available%spectrum, "Spectrum (Welch)")) return
      call out%put("window", trim(channel%spectrum%window))
      call out%put("segment_samples", channel%spectrum%segment)
      call out%put("segments", channel%spectrum%used)
      call out%put("segments_left_out", channel%spectrum%segments - channel%spectrum%used)
      call out%put("overlap", channel%spectrum%overlap)
      call out%put("resolution_hz", channel%spectrum%resolution, unit=trim(channel%frequency_unit))
      call out%put("noise_bandwidth_hz", channel%spectrum%noise_bandwidth, &
                   unit=trim(channel%frequency_unit))
      call out%put("degrees_of_freedom", channel%spectrum%degrees_of_freedom)
      call out%put("confidence", channel%spectrum%confidence)
      call out%put("frequencies", size(channel%spectrum%frequency, kind=int64))
      call out%close()
   end subroutine put_welch

end module gyroakf_report_document_distribution
