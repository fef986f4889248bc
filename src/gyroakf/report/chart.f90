! SPDX-License-Identifier: MIT
!> Allan deviations drawn in characters: both axes logarithmic, points with their limits, the fitted model, and how steep the
!> slopes -1/2 (white noise), 0 (bias instability) and +1/2 (random walk) are in this picture.
module gyroakf_report_chart
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : text_type
   use gyroakf_report_axis, only : axis_type, find_ticks, is_shown, position, set_range, tick_type
   use gyroakf_report_text_layout, only : pad_left
   implicit none (type, external)
   private
   public :: draw_chart, chart_columns, chart_rows

   !> Characters of the area inside the axes, rows where no number is given
   integer, parameter :: chart_columns = 62, chart_rows = 16
   !> Characters before the axis
   integer, parameter :: label_width = 9
   !> Dots between labels, four times as many across
   real(dp), parameter :: spacing = 4.0_dp
   !> Dots of a character, as Braille has them: two beside each other, four below
   integer, parameter :: dots_across = 2, dots_down = 4
   !> What a cell shows beside dots (1 to 255) and letters (their number more than `letter`)
   integer, parameter :: nothing = 0, bar = 256, point = 257, letter = 1000

   !> The axes in dots from the upper left corner, and rows of characters
   type :: frame_type
      type(axis_type) :: x, y
      integer :: rows = chart_rows
   end type frame_type

contains

   !> Draws a curve; what is not a positive number is left out. No lines where nothing is left.
   pure subroutine draw_chart(tau, deviation, lower, upper, unicode, lines, model, rows, mark)
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
      !> [n] what marks the points (default o): of several curves, one behind the other, a letter each
      character(1), intent(in), optional :: mark(:)
      integer, allocatable :: cell(:, :)
      type(frame_type) :: frame
      logical :: usable(size(tau))
      integer :: column, row, i

      if (present(rows)) frame%rows = rows
      frame%x = axis_type(.true., from=0.0_dp, to=real(dots_across*chart_columns - 1, dp))
      frame%y = axis_type(.true., from=real(dots_down*frame%rows - 1, dp), to=0.0_dp)
      usable = is_shown(frame%x, tau) .and. is_shown(frame%y, deviation)
      if (.not. any(usable)) then
         allocate (lines(0))
         return
      end if
      call set_range(frame%x, minval(tau, usable), maxval(tau, usable), 0.0_dp)
      call set_range(frame%y, minval(deviation, usable), maxval(deviation, usable), 0.025_dp)
      allocate (cell(0:chart_columns - 1, 0:frame%rows - 1), source=nothing)
      if (present(model)) call draw_model(cell, frame, tau, model)
      do i = 1, size(tau)
         if (usable(i)) call draw_limits(cell, frame, tau(i), lower(i), upper(i))
      end do
      do i = 1, size(tau)
         if (.not. usable(i)) cycle
         column = dot_of(frame%x, tau(i))/dots_across
         row = dot_of(frame%y, deviation(i))/dots_down
         cell(column, row) = point
         if (present(mark)) cell(column, row) = letter + iachar(mark(i))
      end do
      call draw_slopes(cell, frame)
      call frame_lines(cell, frame, unicode, lines)
   end subroutine draw_chart

   !> Sets a dot where nothing but dots is.
   pure subroutine set_dot(cell, column, row)
      integer, intent(inout) :: cell(0:, 0:)
      !> Dots from the left and from the top
      integer, intent(in) :: column, row
      integer, parameter :: bits(0:dots_across - 1, 0:dots_down - 1) = reshape([0, 3, 1, 4, 2, 5, 6, 7], [dots_across, dots_down])

      associate (here => cell(column/dots_across, row/dots_down))
         if (here < bar) here = ibset(here, bits(modulo(column, dots_across), modulo(row, dots_down)))
      end associate
   end subroutine set_dot

   !> The dot of a value, at the border where it is beyond.
   pure integer function dot_of(axis, value)
      type(axis_type), intent(in) :: axis
      !> One that can be shown
      real(dp), intent(in) :: value

      dot_of = nint(max(min(axis%from, axis%to), min(max(axis%from, axis%to), position(axis, value))))
   end function dot_of

   !> The model, straight between its points, where it is inside the frame.
   pure subroutine draw_model(cell, frame, tau, model)
      integer, intent(inout) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      real(dp), intent(in) :: tau(:), model(:)
      integer :: i, column
      real(dp) :: x(2), y(2), height

      do i = 1, size(tau) - 1
         if (.not. all(is_shown(frame%x, tau(i:i + 1)) .and. is_shown(frame%y, model(i:i + 1)))) cycle
         x = position(frame%x, tau(i:i + 1))
         y = position(frame%y, model(i:i + 1))
         if (.not. x(2) > x(1)) cycle
         do column = dot_of(frame%x, tau(i)), dot_of(frame%x, tau(i + 1))
            height = y(1) + (y(2) - y(1))*max(0.0_dp, min(1.0_dp, (real(column, dp) - x(1))/(x(2) - x(1))))
            if (height > frame%y%to .and. height < frame%y%from) call set_dot(cell, column, nint(height))
         end do
      end do
   end subroutine draw_model

   !> A bar between the limits.
   pure subroutine draw_limits(cell, frame, tau, lower, upper)
      integer, intent(inout) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      real(dp), intent(in) :: tau, lower, upper
      integer :: row

      if (.not. (is_shown(frame%y, lower) .and. is_shown(frame%y, upper))) return
      do row = dot_of(frame%y, upper)/dots_down, dot_of(frame%y, lower)/dots_down
         cell(dot_of(frame%x, tau)/dots_across, row) = bar
      end do
   end subroutine draw_limits

   !> Three lines of the slopes -1/2, 0 and +1/2 from one point, in the first corner without points.
   pure subroutine draw_slopes(cell, frame)
      integer, intent(inout) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      character(4), parameter :: names(-1:1) = ["-1/2", "0   ", "+1/2"]
      integer :: length, rise, across, down, corner, i, k, slope
      real(dp) :: steepness

      steepness = 0.5_dp*(frame%x%last - frame%x%first)/real(chart_columns, dp)*real(frame%rows, dp)/(frame%y%last - frame%y%first)
      length = int(min(12.0_dp, real(chart_columns, dp)/(frame%x%last - frame%x%first), 3.49_dp/steepness))
      rise = nint(real(length, dp)*steepness)
      if (rise < 1 .or. length < 3 .or. 2*rise >= frame%rows) return
      do corner = 1, 4                                    ! top right, bottom left, top left, bottom right
         across = merge(chart_columns - length - 6, 1, corner == 1 .or. corner == 4)
         down = merge(rise, frame%rows - 1 - rise, corner == 1 .or. corner == 3)
         if (all(cell(across:across + length + 4, down - rise:down + rise) == nothing)) exit
      end do
      if (corner > 4) return
      do slope = -1, 1
         do i = 0, dots_across*length - 1
            call set_dot(cell, dots_across*across + i, dots_down*down + dots_down/2 - &
                         nint(real(slope*rise*dots_down*i, dp)/real(dots_across*length, dp)))
         end do
         do k = 1, len_trim(names(slope))
            cell(across + length + k - 1, down - slope*rise) = letter + iachar(names(slope) (k:k))
         end do
      end do
   end subroutine draw_slopes

   !> The cells with the axes and their numbers.
   pure subroutine frame_lines(cell, frame, unicode, lines)
      integer, intent(in) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      logical, intent(in) :: unicode
      type(text_type), allocatable, intent(out) :: lines(:)
      character(:), allocatable :: label, below, text
      type(tick_type), allocatable :: tick(:)
      logical :: is_tick(0:chart_columns - 1)
      integer :: row, column, i

      allocate (lines(frame%rows + 2))
      call find_ticks(frame%y, spacing, tick)
      do row = 0, frame%rows - 1
         label = ""
         do i = 1, size(tick)
            if (tick(i)%label /= "" .and. dot_of(frame%y, tick(i)%value)/dots_down == row) label = trim(tick(i)%label)
         end do
         text = "  "//pad_left(label, label_width - 1)//" "
         if (unicode) text = text//trim(merge("┤", "│", label /= ""))
         if (.not. unicode) text = text//merge("+", "|", label /= "")
         do column = 0, chart_columns - 1
            text = text//shown(cell(column, row), unicode)
         end do
         lines(row + 1)%text = trim(text)
      end do
      is_tick = .false.
      below = repeat(" ", 2 + label_width + 1 + chart_columns)
      call find_ticks(frame%x, 4*spacing, tick)
      do i = 1, size(tick)
         if (tick(i)%label == "") cycle
         column = dot_of(frame%x, tick(i)%value)/dots_across
         is_tick(column) = .true.
         call put_centred(below, 2 + label_width + 2 + column, trim(tick(i)%label))
      end do
      text = repeat(" ", 2 + label_width)//trim(merge("└", "+  ", unicode))
      do column = 0, chart_columns - 1
         if (unicode) text = text//trim(merge("┴", "─", is_tick(column)))
         if (.not. unicode) text = text//merge("+", "-", is_tick(column))
      end do
      lines(frame%rows + 1)%text = text
      lines(frame%rows + 2)%text = trim(below)
   end subroutine frame_lines

   !> Writes a label below its tick, where no other one is in its way.
   pure subroutine put_centred(line, middle, text)
      character(*), intent(inout) :: line
      integer, intent(in) :: middle
      character(*), intent(in) :: text
      integer :: first, last

      first = max(1, min(len(line) - len(text) + 1, middle - len(text)/2))
      last = first + len(text) - 1
      if (line(max(1, first - 1):min(len(line), last + 1)) == "") line(first:last) = text
   end subroutine put_centred

   !> One character.
   pure function shown(cell, unicode) result(text)
      integer, intent(in) :: cell
      logical, intent(in) :: unicode
      character(:), allocatable :: text

      if (cell > letter) then
         text = achar(cell - letter)
      else if (cell == point) then
         text = "o"
      else if (cell == bar) then
         text = "|"
         if (unicode) text = "│"
      else if (cell == nothing) then
         text = " "
      else if (unicode) then
         text = char(226)//char(160 + cell/64)//char(128 + modulo(cell, 64))
      else
         text = "."
      end if
   end function shown

end module gyroakf_report_chart
