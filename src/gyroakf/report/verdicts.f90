! SPDX-License-Identifier: MIT
!> The verdict on the drift of a channel in words: the only sentences of a report that say whether it drifts.
module gyroakf_report_verdicts
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_text_layout, only : put_item
   implicit none (type, external)
   private
   public :: put_verdict, verdict_text

contains

   !> The verdict and its reasons.
   subroutine put_verdict(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> With its verdict; nothing is written where none was looked for
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%verdict%wanted) return
      call put_item(writer, "Noise", verdict_text(channel))
      if (.not. allocated(channel%verdict%reasons)) return
      do i = 1, size(channel%verdict%reasons)
         call put_item(writer, "", channel%verdict%reasons(i)%text)
      end do
   end subroutine put_verdict

   !> "stationary, flicker", "drifts: random walk".
   pure function verdict_text(channel) result(text)
      !> With its verdict
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (verdict => channel%verdict)
         select case (verdict%drift)
         case ("none"); text = "stationary"
         case ("flicker"); text = "stationary, flicker"
         case ("colored"); text = "stationary, colored"
         case ("random_walk"); text = "drifts: random walk"
         case ("trend"); text = "drifts: "//trim(verdict%trend%shape)
         case ("trend_and_random_walk"); text = "drifts: "//trim(verdict%trend%shape)//" and random walk"
         case ("random_walk_or_trend"); text = "drifts: random walk or ramp"
         case ("unit_root"); text = "drifts: unit root not rejected"
         case default; text = "not described"
         end select
      end associate
   end function verdict_text

end module gyroakf_report_verdicts
