! SPDX-License-Identifier: MIT
!> The members of "tests" in the JSON document that tell the distribution of the samples.
module gyroakf_report_document_distribution
   use gyroakf_kinds, only : dp
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_description, only : description_type
   implicit none (type, external)
   private
   public :: put_distribution

contains

   !> "normality", "anderson_darling", "histogram", "quantisation"; null where one is not available.
   subroutine put_distribution(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel

      call out%put("normality", trim(channel%normality), channel%available%jarque_bera, shown=.false.)
      if (channel%available%anderson_darling) then
         call put_anderson_darling(out, channel)
      else
         call out%absent("anderson_darling")
      end if
      if (channel%available%histogram) then
         call put_histogram(out, channel)
      else
         call out%absent("histogram")
      end if
      if (channel%available%quantisation) then
         call put_quantisation(out, channel)
      else
         call out%absent("quantisation")
      end if
   end subroutine put_distribution

   subroutine put_anderson_darling(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      call out%open("anderson_darling", "Anderson-Darling")
      call out%put("statistic", channel%anderson_darling%statistic)
      call out%put("modified", channel%anderson_darling%modified)
      call out%put("p_value", channel%anderson_darling%p_value)
      call out%put("distance", channel%anderson_darling%distance)
      call out%put("samples", channel%anderson_darling%samples)
      call out%put("stride", channel%anderson_darling%stride)
      call out%close()
   end subroutine put_anderson_darling

   subroutine put_histogram(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      associate (histogram => channel%histogram)
         call out%open("histogram", shown=.false.)
         call out%put("samples", histogram%samples)
         call out%put("mean", histogram%mean)
         call out%put("std", histogram%std)
         call out%put("bin_width", histogram%width)
         call out%put("bin_steps", histogram%steps)
         call out%put("bins_limited", histogram%limited)
         call out%put("below", histogram%below)
         call out%put("above", histogram%above)
         call out%put("expected_below", histogram%expected_below)
         call out%put("expected_above", histogram%expected_above)
         call out%put("edges", histogram%edge)
         call out%put("counts", real(histogram%count, dp))
         call out%put("expected", histogram%expected)
         call out%close()
      end associate
   end subroutine put_histogram

   subroutine put_quantisation(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      associate (grid => channel%quantisation)
         call out%open("quantisation", "Quantization", grid%quantised)
         call out%put("quantised", grid%quantised, title="quantized")
         call out%put("step", grid%step)
         call out%put("step_over_std", grid%ratio)
         call out%put("variance_share", grid%variance_share)
         call out%put("levels", grid%levels)
         call out%put("corrected_std", grid%corrected_std)
         call out%close()
      end associate
   end subroutine put_quantisation

end module gyroakf_report_document_distribution
