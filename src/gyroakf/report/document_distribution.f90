! SPDX-License-Identifier: MIT
!> The members of "tests" in the JSON document that tell the distribution of the samples.
module gyroakf_report_document_distribution
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_json, only : json_type, open_object, close_object, put_member, put_null
   implicit none (type, external)
   private
   public :: put_distribution

contains

   !> "normality", "anderson_darling", "histogram", "quantisation"; null where one is not available.
   subroutine put_distribution(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (channel%available%jarque_bera) then
         call put_member(json, "normality", trim(channel%normality))
      else
         call put_null(json, "normality")
      end if
      if (channel%available%anderson_darling) then
         call put_anderson_darling(json, channel)
      else
         call put_null(json, "anderson_darling")
      end if
      if (channel%available%histogram) then
         call put_histogram(json, channel)
      else
         call put_null(json, "histogram")
      end if
      if (channel%available%quantisation) then
         call put_quantisation(json, channel)
      else
         call put_null(json, "quantisation")
      end if
   end subroutine put_distribution

   subroutine put_anderson_darling(json, channel)
      type(json_type), intent(inout) :: json
      type(channel_result_type), intent(in) :: channel

      call open_object(json, "anderson_darling")
      call put_member(json, "statistic", channel%anderson_darling%statistic)
      call put_member(json, "modified", channel%anderson_darling%modified)
      call put_member(json, "p_value", channel%anderson_darling%p_value)
      call put_member(json, "distance", channel%anderson_darling%distance)
      call put_member(json, "samples", channel%anderson_darling%samples)
      call put_member(json, "stride", channel%anderson_darling%stride)
      call close_object(json)
   end subroutine put_anderson_darling

   subroutine put_histogram(json, channel)
      type(json_type), intent(inout) :: json
      type(channel_result_type), intent(in) :: channel

      associate (histogram => channel%histogram)
         call open_object(json, "histogram")
         call put_member(json, "samples", histogram%samples)
         call put_member(json, "mean", histogram%mean)
         call put_member(json, "std", histogram%std)
         call put_member(json, "bin_width", histogram%width)
         call put_member(json, "bin_steps", histogram%steps)
         call put_member(json, "bins_limited", histogram%limited)
         call put_member(json, "below", histogram%below)
         call put_member(json, "above", histogram%above)
         call put_member(json, "expected_below", histogram%expected_below)
         call put_member(json, "expected_above", histogram%expected_above)
         call put_member(json, "edges", histogram%edge)
         call put_member(json, "counts", histogram%count)
         call put_member(json, "expected", histogram%expected)
         call close_object(json)
      end associate
   end subroutine put_histogram

   subroutine put_quantisation(json, channel)
      type(json_type), intent(inout) :: json
      type(channel_result_type), intent(in) :: channel

      associate (grid => channel%quantisation)
         call open_object(json, "quantisation")
         call put_member(json, "quantised", grid%quantised)
         call put_member(json, "step", grid%step)
         call put_member(json, "step_over_std", grid%ratio)
         call put_member(json, "variance_share", grid%variance_share)
         call put_member(json, "levels", grid%levels)
         call put_member(json, "corrected_std", grid%corrected_std)
         call close_object(json)
      end associate
   end subroutine put_quantisation

end module gyroakf_report_document_distribution
