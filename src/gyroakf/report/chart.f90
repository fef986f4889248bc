! SPDX-License-Identifier: MIT
!> The Allan deviations of a result in characters: both axes logarithmic, points with their limits,
!> the fitted model, and how steep the slopes -1/2 (white noise), 0 (bias instability) and +1/2
!> (random walk) are in this picture.
module gyroakf_report_chart
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_record, only : record_type, text_type, view_channel
   use gyroakf_report_axis, only : axis_type, find_ticks, is_shown, position, set_range, tick_type
   use gyroakf_report_figure_allan, only : alike_channels
   use gyroakf_report_input, only : unit_name, time_unit
   use gyroakf_report_text_layout, only : if_known, pad_left, put_heading
   implicit none (type, external)
   private
   public :: put_chart, draw_chart, chart_columns, chart_rows

   !> Characters of the area inside the axes, rows where no number is given, rows in a report
   integer, parameter :: chart_columns = 62, chart_rows = 16, report_rows = 9
   !> Characters before the axis
   integer, parameter :: label_width = 9
   !> Dots between labels, four times as many across
   real(dp), parameter :: spacing = 4.0_dp
   !> Dots of a character, as Braille has them: two beside each other, four below
   integer, parameter :: dots_across = 2, dots_down = 4
   !> What a cell shows beside dots (1 to 255) and letters (their number more than `letter`)
   integer, parameter :: nothing = 0, bar = 256, letter = 1000

contains

   !> The Allan deviation of a single channel with its limits and the fit; of several those that
   !> have the unit of the first, a letter each.
   subroutine put_chart(writer, record, result)
      type(writer_type), intent(inout) :: writer
      !> For units and rate
      type(record_type), intent(in) :: record
      !> Nothing is drawn where it has no Allan deviation
      type(pipeline_result_type), intent(in) :: result
      type(text_type), allocatable :: lines(:)
      type(record_type) :: first
      character(:), allocatable :: legend
      real(dp), allocatable :: tau(:), deviation(:), lower(:), upper(:), model(:)
      character(1), allocatable :: mark(:)
      character(1) :: letters(size(result%channel))
      logical :: drawn(size(result%channel))
      integer :: c, i

      drawn = alike_channels(record, result, 1)
      call choose_letters(result, drawn, letters)
      allocate (tau(0), deviation(0), mark(0))
      legend = ""
      do c = 1, size(drawn)
         if (.not. drawn(c)) cycle
         legend = legend//", "//letters(c)//" "//result%channel(c)%name
         associate (curve => result%channel(c)%allan(stage%input)%curve)
            tau = [tau, curve%tau]
            deviation = [deviation, curve%deviation]
            mark = [character(1) :: mark, (letters(c), i=1, size(curve%tau))]
         end associate
      end do
      lower = deviation
      upper = deviation
      model = 0*tau
      if (size(drawn) == 1 .and. all(drawn)) then
         associate (allan => result%channel(1)%allan(stage%input))
            legend = ", o measured, | limits"//if_known(allan%fitted, ", . fitted")
            lower = allan%curve%lower
            upper = allan%curve%upper
            if (allan%fitted) model = allan%noise%model
         end associate
      end if
      call draw_chart(tau, deviation, lower, upper, writer%unicode, lines, model, report_rows, mark)
      if (size(lines) == 0) return
      call view_channel(record, 1, first)
      call put_heading(writer, "Allan deviation in "//unit_name(first)//" against tau in "// &
                       time_unit(record)//": "//legend(3:))
      do i = 1, size(lines)
         call put_line(writer, lines(i)%text)
      end do
   end subroutine put_chart

   !> The last letter of each channel's name, where these differ; else a, b, c, ...; o of a single
   !> channel.
   pure subroutine choose_letters(result, drawn, letters)
      type(pipeline_result_type), intent(in) :: result
      !> The channels in the chart: [channel]
      logical, intent(in) :: drawn(:)
      character(1), intent(out) :: letters(:)
      integer :: i
      logical :: usable

      letters = " "
      usable = .true.
      do i = 1, size(drawn)
         if (.not. drawn(i)) cycle
         associate (name => result%channel(i)%name)
            if (len(name) > 0) letters(i) = name(len(name):)
         end associate
         usable = usable .and. letters(i) > " " .and. letters(i) < achar(127) .and. &
            count(letters(:i) == letters(i)) == 1
      end do
      do i = 1, size(drawn)
         if (.not. usable) letters(i) = achar(iachar("a") + modulo(count(drawn(:i)) - 1, 26))
      end do
      if (size(drawn) == 1) letters = "o"
   end subroutine choose_letters

   !> Draws a curve; what is not a positive number is left out. No lines where nothing is left.
   subroutine draw_chart(tau, deviation, lower, upper, unicode, lines, model, rows, mark)
      !> [n] averaging times
      real(dp), intent(in) :: tau(:)
      !> [n] deviations and their limits
      real(dp), intent(in) :: deviation(:), lower(:), upper(:)
      !> Lines and dots of UTF-8, else ASCII
      logical, intent(in) :: unicode
      !> Of at most `2 + label_width + 1 + chart_columns` characters, the axes included
      type(text_type), allocatable, intent(out) :: lines(:)
      !> [n] fitted deviations
      real(dp), intent(in), optional :: model(:)
      !> Rows inside the axes, 1 or more (default 16)
      integer, intent(in), optional :: rows
      !> [n] what marks the points (default o): of several curves, one behind the other, a letter
      !> each
      character(1), intent(in), optional :: mark(:)
      !> What each character shows: [column, row] from the upper left corner
      integer, allocatable :: cell(:, :)
      type(axis_type) :: x, y
      logical :: usable(size(tau))
      character(1) :: sign(size(tau))
      integer :: height, column, i

      height = chart_rows
      if (present(rows)) height = rows
      x = axis_type(.true., from=0.0_dp, to=real(dots_across*chart_columns - 1, dp))
      y = axis_type(.true., from=real(dots_down*height - 1, dp), to=0.0_dp)
      usable = is_shown(x, tau) .and. is_shown(y, deviation)
      if (.not. any(usable)) then
         allocate (lines(0))
         return
      end if
      call set_range(x, minval(tau, usable), maxval(tau, usable), 0.0_dp)
      call set_range(y, minval(deviation, usable), maxval(deviation, usable), 0.025_dp)
      allocate (cell(0:chart_columns - 1, 0:height - 1), source=nothing)
      if (present(model)) call draw_model()
      do i = 1, size(tau)
         if (.not. (usable(i) .and. is_shown(y, lower(i)) .and. is_shown(y, upper(i)))) cycle
         column = dot_of(x, tau(i))/dots_across
         cell(column, dot_of(y, upper(i))/dots_down:dot_of(y, lower(i))/dots_down) = bar
      end do
      sign = "o"
      if (present(mark)) sign = mark
      do i = 1, size(tau)
         if (.not. usable(i)) cycle
         column = dot_of(x, tau(i))/dots_across
         cell(column, dot_of(y, deviation(i))/dots_down) = letter + iachar(sign(i))
      end do
      call draw_slopes()
      call frame_lines()

   contains

      !> Sets a dot, counted from the left and from the top, where nothing but dots is.
      subroutine set_dot(across, down)
         integer, intent(in) :: across, down
         integer, parameter :: bits(0:dots_across - 1, 0:dots_down - 1) = &
            reshape([0, 3, 1, 4, 2, 5, 6, 7], [dots_across, dots_down])

         associate (here => cell(across/dots_across, down/dots_down))
            if (here < bar) then
               here = ibset(here, bits(modulo(across, dots_across), modulo(down, dots_down)))
            end if
         end associate
      end subroutine set_dot

      !> The model, straight between its points, where it is inside the frame.
      subroutine draw_model()
         integer :: i, column
         real(dp) :: across(2), down(2), at

         do i = 1, size(tau) - 1
            if (.not. all(is_shown(x, tau(i:i + 1)) .and. is_shown(y, model(i:i + 1)))) cycle
            across = position(x, tau(i:i + 1))
            down = position(y, model(i:i + 1))
            if (.not. across(2) > across(1)) cycle
            do column = dot_of(x, tau(i)), dot_of(x, tau(i + 1))
               at = max(0.0_dp, min(1.0_dp, (real(column, dp) - across(1))/(across(2) - across(1))))
               at = down(1) + (down(2) - down(1))*at
               if (at > y%to .and. at < y%from) call set_dot(column, nint(at))
            end do
         end do
      end subroutine draw_model

      !> Three lines of the slopes -1/2, 0 and +1/2 from one point, in the first corner without
      !> points.
      subroutine draw_slopes()
         character(4), parameter :: names(-1:1) = ["-1/2", "0   ", "+1/2"]
         integer :: length, rise, across, down, corner, i, k, slope
         real(dp) :: steepness

         steepness = 0.5_dp*(x%last - x%first)/real(chart_columns, dp)* &
            real(height, dp)/(y%last - y%first)
         length = int(min(12.0_dp, real(chart_columns, dp)/(x%last - x%first), 3.49_dp/steepness))
         rise = nint(real(length, dp)*steepness)
         if (rise < 1 .or. length < 3 .or. 2*rise >= height) return
         do corner = 1, 4                ! top right, bottom left, top left, bottom right
            across = merge(chart_columns - length - 6, 1, corner == 1 .or. corner == 4)
            down = merge(rise, height - 1 - rise, corner == 1 .or. corner == 3)
            if (all(cell(across:across + length + 4, down - rise:down + rise) == nothing)) exit
         end do
         if (corner > 4) return
         do slope = -1, 1
            do i = 0, dots_across*length - 1
               call set_dot(dots_across*across + i, dots_down*down + dots_down/2 - &
                            nint(real(slope*rise*dots_down*i, dp)/real(dots_across*length, dp)))
            end do
            do k = 1, len_trim(names(slope))
               cell(across + length + k - 1, down - slope*rise) = &
                  letter + iachar(names(slope) (k:k))
            end do
         end do
      end subroutine draw_slopes

      !> The cells with the axes and their numbers.
      subroutine frame_lines()
         character(:), allocatable :: label, below, text
         character(16) :: labels(0:height - 1)
         type(tick_type), allocatable :: tick(:)
         logical :: is_tick(0:chart_columns - 1)
         integer :: row, column, i, first, last

         allocate (lines(height + 2))
         labels = ""
         call find_ticks(y, spacing, tick)
         do i = 1, size(tick)
            if (tick(i)%label /= "") labels(dot_of(y, tick(i)%value)/dots_down) = tick(i)%label
         end do
         do row = 0, height - 1
            text = "  "//pad_left(trim(labels(row)), label_width - 1)//" "// &
               if_known(unicode, merge("┤", "│", labels(row) /= ""), &
                        merge("+", "|", labels(row) /= ""))
            do column = 0, chart_columns - 1
               text = text//shown(cell(column, row), unicode)
            end do
            lines(row + 1)%text = trim(text)
         end do
         is_tick = .false.
         below = repeat(" ", 2 + label_width + 1 + chart_columns)
         call find_ticks(x, 4*spacing, tick)
         do i = 1, size(tick)
            if (tick(i)%label == "") cycle
            column = dot_of(x, tick(i)%value)/dots_across
            is_tick(column) = .true.
            label = trim(tick(i)%label)                    ! where no other one is in its way
            first = 2 + label_width + 2 + column - len(label)/2
            first = max(1, min(len(below) - len(label) + 1, first))
            last = first + len(label) - 1
            if (below(max(1, first - 1):min(len(below), last + 1)) == "") below(first:last) = label
         end do
         text = repeat(" ", 2 + label_width)//if_known(unicode, "└", "+")
         do column = 0, chart_columns - 1
            text = text//if_known(unicode, merge("┴", "─", is_tick(column)), &
                                  merge("+", "-", is_tick(column)))
         end do
         lines(height + 1)%text = text
         lines(height + 2)%text = trim(below)
      end subroutine frame_lines

   end subroutine draw_chart

   !> The dot of a value, at the border where it is beyond.
   pure integer function dot_of(axis, value)
      type(axis_type), intent(in) :: axis
      real(dp), intent(in) :: value

      dot_of = nint(max(min(axis%from, axis%to), &
                        min(max(axis%from, axis%to), position(axis, value))))
   end function dot_of

   !> One character.
   pure function shown(cell, unicode) result(text)
      integer, intent(in) :: cell
      logical, intent(in) :: unicode
      character(:), allocatable :: text

      select case (cell)
      case (letter:); text = achar(cell - letter)
      case (bar); text = if_known(unicode, "│", "|")
      case (nothing); text = " "
      case default
         text = if_known(unicode, char(226)//char(160 + cell/64)//char(128 + modulo(cell, 64)), ".")
      end select
   end function shown

end module gyroakf_report_chart
