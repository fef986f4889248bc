! SPDX-License-Identifier: MIT
!> One recording on a page: warnings, what was read, and of each channel what to make of it, its figures, its tables.
module gyroakf_report_html_recording
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type, text_type, view_channel
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage
   use gyroakf_report_advice, only : put_advice
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_figures, only : build_figure, figure_kinds
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_element, put_escaped
   use gyroakf_report_input, only : put_input, unit_name
   use gyroakf_report_svg, only : figure_type, has_points, write_svg
   use gyroakf_report_text_answer, only : put_answer
   use gyroakf_report_text_layout, only : count_text, put_point
   use gyroakf_report_text_noise, only : put_curves_of
   use gyroakf_report_text_report, only : put_sections
   implicit none (type, external)
   private
   public :: put_recording

contains

   !> The section of a recording.
   subroutine put_recording(writer, number, command, record, result)
      !> The page
      type(writer_type), intent(inout) :: writer
      !> Of the recording on the page, from 1: part of every name
      integer, intent(in) :: number
      !> run, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      character(:), allocatable :: id
      integer :: c

      id = "r"//count_text(int(number, int64))
      call put(writer, "<section id="""//id//"""")
      call put_attribute(writer, "data-path", path_of(record))
      call put_line(writer, ">")
      call put_element(writer, "h2", path_of(record))
      writer%markup%level = 3
      call put_all_warnings(writer, record, result)
      if (command == "run" .or. command == "allan") call put_answer(writer, record, result)
      call close_list(writer)
      do c = 1, size(result%channel)
         call put_figure(writer, "overlay", c, record, result)
      end do
      if (size(result%channel) > 1) call put_channel_list(writer, id, result)
      call put_input(writer, record)
      call close_list(writer)
      do c = 1, size(result%channel)
         call put_channel(writer, id, c, command, record, result)
      end do
      call put_line(writer, "</section>")
   end subroutine put_recording

   !> What was read, as it was named.
   pure function path_of(record) result(path)
      type(record_type), intent(in) :: record
      character(:), allocatable :: path

      path = "(in memory)"
      if (allocated(record%path)) path = record%path
      if (path == "-") path = "standard input"
   end function path_of

   !> All warnings, above everything else.
   subroutine put_all_warnings(writer, record, result)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(text_type), allocatable :: warnings(:)
      integer :: i

      call gather_warnings(record, warnings, result)
      if (size(warnings) == 0) return
      call put_line(writer, "<div class=""warnings"">")
      call put_element(writer, "h3", "Warnings")
      do i = 1, size(warnings)
         call put_point(writer, warnings(i)%text)
      end do
      call close_list(writer)
      call put_line(writer, "</div>")
   end subroutine put_all_warnings

   !> Ways to the channels.
   subroutine put_channel_list(writer, id, result)
      type(writer_type), intent(inout) :: writer
      !> Of the recording
      character(*), intent(in) :: id
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_line(writer, "<nav aria-label=""Channels""><ul>")
      do c = 1, size(result%channel)
         call put(writer, "<li><a href=""#"//id//"c"//count_text(int(c, int64))//""">")
         call put_escaped(writer, "Channel "//result%channel(c)%name)
         call put_line(writer, "</a></li>")
      end do
      call put_line(writer, "</ul></nav>")
   end subroutine put_channel_list

   !> One channel.
   subroutine put_channel(writer, id, c, command, record, result)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: id
      !> Number of the channel
      integer, intent(in) :: c
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      character(:), allocatable :: own
      type(record_type) :: view
      integer :: i

      call view_channel(record, c, view)
      own = id//"c"//count_text(int(c, int64))
      call put_line(writer, "<section id="""//own//""" data-channel="""//count_text(int(c - 1, int64))//""">")
      call put_element(writer, "h3", "Channel "//result%channel(c)%name)
      writer%markup%level = 3
      associate (channel => result%channel(c))
         do i = 2, size(figure_kinds)
            call put_figure(writer, trim(figure_kinds(i)), c, record, result)
         end do
         if (command == "run") call put_advice(writer, view, channel)
         call put_sections(writer, command, view, channel)
         if (command == "run" .and. channel%allan(stage%input)%available) then
            call close_list(writer)
            call put_line(writer, "<details><summary>The Allan deviation in numbers</summary>")
            call put_curves_of(writer, view, channel%allan(stage%input), "As read", "input")
            call put_curves_of(writer, view, channel%allan(stage%cleaned), "Cleaned", "cleaned")
            call close_list(writer)
            call put_line(writer, "</details>")
         end if
      end associate
      call close_list(writer)
      call put_line(writer, "</section>")
   end subroutine put_channel

   !> A figure with its caption; nothing where there is none of the kind.
   subroutine put_figure(writer, kind, c, record, result)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: kind
      !> Number of the channel
      integer, intent(in) :: c
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(figure_type) :: figure
      type(record_type) :: view
      character(:), allocatable :: attributes

      call build_figure(kind, record, result, c, figure)
      if (.not. has_points(figure)) return
      attributes = ""
      call view_channel(record, c, view)
      if (kind == "allan") call curve_attributes(view, attributes)
      call close_list(writer)
      call put(writer, "<figure"//attributes//"><div class=""plot"" tabindex=""0"" role=""group""")
      call put_attribute(writer, "aria-label", figure%title)
      call put_line(writer, ">")
      call write_svg(writer, figure, .false.)
      call put_line(writer, "</div>")
      call put_element(writer, "figcaption", figure%caption)
      call put_line(writer, "</figure>")
   end subroutine put_figure

   !> What the script needs to read a curve aloud.
   pure subroutine curve_attributes(record, attributes)
      type(record_type), intent(in) :: record
      character(:), allocatable, intent(out) :: attributes
      character(*), parameter :: plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/^()* "
      character(:), allocatable :: unit

      unit = unit_name(record)
      if (verify(unit, plain) > 0) unit = ""
      attributes = " data-curve=""input"" data-unit="""//unit//""" data-time="""// &
                   trim(merge("s      ", "samples", record%rate_known))//""""
   end subroutine curve_attributes

end module gyroakf_report_html_recording
