! SPDX-License-Identifier: MIT
!> One recording on a page: warnings, what was read, and of each channel what to make of it, its figures, its tables.
module gyroakf_report_html_recording
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type, text_type, view_channel
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage
   use gyroakf_report_advice, only : put_advice
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_figures, only : figure_name, figure_kinds
   use gyroakf_report_html_figure, only : drawn_by, html_figure
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_element, put_escaped
   use gyroakf_report_input, only : put_input, unit_name
   use gyroakf_report_text_answer, only : put_answer
   use gyroakf_report_text_layout, only : count_text, put_point
   use gyroakf_report_text_noise, only : put_curves_of
   use gyroakf_report_text_report, only : put_sections
   implicit none (type, external)
   private
   public :: drawings_type, put_recording, read_whole_file

   !> Bytes; what is larger is no text that a page takes in
   integer(int64), parameter :: most_bytes = 100000000_int64

   !> Where the figures are
   type :: drawings_type
      !> Folder of NAME.svg; unallocated: there are none
      character(:), allocatable :: folder
      !> Said in their place
      character(:), allocatable :: missing
      !> The program that drew them, filled while they are taken in
      character(:), allocatable :: program
   end type drawings_type

contains

   !> The section of a recording.
   subroutine put_recording(writer, number, command, record, result, drawings)
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
      !> Its figures
      type(drawings_type), intent(inout) :: drawings
      type(record_type) :: view
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
      if (size(result%channel) > 1) call put_channel_list(writer, id, result)
      call put_input(writer, record)
      call close_list(writer)
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         call put_channel(writer, id, c, command, view, result, drawings)
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
   subroutine put_channel(writer, id, c, command, record, result, drawings)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: id
      !> Number of the channel
      integer, intent(in) :: c
      character(*), intent(in) :: command
      !> Of this channel
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(drawings_type), intent(inout) :: drawings
      character(:), allocatable :: own

      own = id//"c"//count_text(int(c, int64))
      call put_line(writer, "<section id="""//own//""" data-channel="""//count_text(int(c - 1, int64))//""">")
      call put_element(writer, "h3", "Channel "//result%channel(c)%name)
      writer%markup%level = 3
      associate (channel => result%channel(c))
         if (command == "run") call put_advice(writer, record, channel)
         call put_figures(writer, own, c, record, result, drawings)
         call put_sections(writer, command, record, channel, .false.)
         if (command == "run" .and. channel%allan(stage%input)%available) then
            call close_list(writer)
            call put_line(writer, "<details><summary>The Allan deviation in numbers</summary>")
            call put_curves_of(writer, record, channel%allan(stage%input), "As read", "input")
            call put_curves_of(writer, record, channel%allan(stage%cleaned), "Cleaned", "cleaned")
            call close_list(writer)
            call put_line(writer, "</details>")
         end if
      end associate
      call close_list(writer)
      call put_line(writer, "</section>")
   end subroutine put_channel

   !> The figures of a channel, or what to do to have them.
   subroutine put_figures(writer, id, c, record, result, drawings)
      type(writer_type), intent(inout) :: writer
      !> Of the channel
      character(*), intent(in) :: id
      integer, intent(in) :: c
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(drawings_type), intent(inout) :: drawings
      type(error_type), allocatable :: error
      character(:), allocatable :: svg, attributes, kind
      integer :: i

      call close_list(writer)
      call put_element(writer, "h4", "Figures")
      if (.not. allocated(drawings%folder)) then
         call put_element(writer, "p", drawings%missing)
         return
      end if
      do i = 1, size(figure_kinds)
         kind = trim(figure_kinds(i))
         call read_whole_file(drawings%folder//"/"//figure_name(kind, result, c)//".svg", svg, error)
         if (allocated(error)) cycle                       ! the channel has no such figure
         if (.not. allocated(drawings%program)) drawings%program = drawn_by(svg)
         attributes = ""
         if (kind == "allan") call curve_attributes(record, attributes)
         call html_figure(writer, svg, id//kind//"-", caption_of(kind, result%channel(c)), attributes)
      end do
   end subroutine put_figures

   !> Reads all bytes of a file.
   subroutine read_whole_file(path, text, error)
      !> A regular file, 100 MB at most
      character(*), intent(in) :: path
      !> Its bytes
      character(:), allocatable, intent(out) :: text
      !> io, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: bytes
      integer :: unit, failed

      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", action="read", iostat=failed)
      if (failed == 0) then
         inquire (unit=unit, size=bytes)
         if (bytes < 0 .or. bytes > most_bytes) failed = 1
         if (failed == 0) then
            allocate (character(bytes) :: text, stat=failed)
            if (failed /= 0) then
               close (unit)
               call fatal_error(error, status%no_memory, "no memory to read "//path)
               return
            end if
            read (unit, iostat=failed) text
         end if
         close (unit)
      end if
      if (failed /= 0) call fatal_error(error, status%io, path//": cannot be read")
   end subroutine read_whole_file

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

   !> What a figure shows.
   pure function caption_of(kind, channel) result(text)
      character(*), intent(in) :: kind
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      select case (kind)
      case ("series"); text = "The series as read, with its trend and its outliers, and cleaned"
      case ("allan"); text = "Overlapping Allan deviation as read, with its limits, the fitted model, its terms, and the "// &
                             "points where the classical rules read the coefficients off"
      case ("before_after"); text = "Allan deviation as read, cleaned, and after each filter"
      case ("filters"); text = "The cleaned series and what the paper's filters make of it; the drift and the record without it"
      case ("innovations"); text = "Normalised innovations of the adaptive filters, and the variance R that these estimate"
      case ("histogram"); text = "Histogram of the tested series and the normal distribution of its mean and variance"
      case ("correlation"); text = "Autocorrelation of the tested series, with the limits of white noise"
      case ("residuals"); text = "Autocorrelation of the AR model's residuals, with the limits of white noise"
      case default; text = "Power spectral density of the cleaned series, with its limits, and that of the AR model"
      end select
      text = channel%name//": "//text//"."
   end function caption_of

end module gyroakf_report_html_recording
