! SPDX-License-Identifier: MIT
!> Allan deviations drawn in characters: both axes logarithmic, points with their limits, the fitted model, and how steep the
!> slopes -1/2 (white noise), 0 (bias instability) and +1/2 (random walk) are in this picture.
module gyroakf_report_chart
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : text_type
   use gyroakf_report_text_layout, only : number, pad_left
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: draw_chart, chart_columns, chart_rows

   !> Characters of the area inside the axes, rows where no number is given
   integer, parameter :: chart_columns = 62, chart_rows = 16
   !> Characters before the axis, and the least range of an axis in decades
   integer, parameter :: label_width = 9
   real(dp), parameter :: least_range = 1.0_dp
   !> Dots of a character, as Braille has them: two beside each other, four below
   integer, parameter :: dots_across = 2, dots_down = 4
   !> What a cell shows beside dots (1 to 255) and letters (their number more than `letter`)
   integer, parameter :: nothing = 0, bar = 256, point = 257, letter = 1000

   !> The axes: logarithms at the borders, and rows of characters
   type :: frame_type
      real(dp) :: left = 0.0_dp, right = 1.0_dp, bottom = 0.0_dp, top = 1.0_dp
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
      do i = 1, size(tau)
         usable(i) = is_drawn(tau(i)) .and. is_drawn(deviation(i))
      end do
      if (.not. any(usable)) then
         allocate (lines(0))
         return
      end if
      call set_range(log10(pack(tau, usable)), 0.0_dp, frame%left, frame%right)
      call set_range(log10(pack(deviation, usable)), 0.05_dp, frame%bottom, frame%top)
      allocate (cell(0:chart_columns - 1, 0:frame%rows - 1), source=nothing)
      if (present(model)) call draw_model(cell, frame, tau, model)
      do i = 1, size(tau)
         if (usable(i)) call draw_limits(cell, frame, log10(tau(i)), lower(i), upper(i))
      end do
      do i = 1, size(tau)
         if (.not. usable(i)) cycle
         column = column_of(frame, log10(tau(i)))/dots_across
         row = row_of(frame, log10(deviation(i)))/dots_down
         cell(column, row) = point
         if (present(mark)) cell(column, row) = letter + iachar(mark(i))
      end do
      call draw_slopes(cell, frame)
      call frame_lines(cell, frame, unicode, lines)
   end subroutine draw_chart

   !> A logarithm can be drawn.
   pure logical function is_drawn(x)
      real(dp), intent(in) :: x

      is_drawn = .false.
      if (ieee_is_finite(x)) is_drawn = x > 0.0_dp
   end function is_drawn

   !> Borders of an axis: those of the values with a margin, a decade apart at least.
   pure subroutine set_range(values, margin, first, last)
      real(dp), intent(in) :: values(:), margin
      real(dp), intent(out) :: first, last
      real(dp) :: missing

      first = minval(values) - margin
      last = maxval(values) + margin
      missing = least_range - (last - first)
      if (missing <= 0.0_dp) return
      first = first - missing/2
      last = last + missing/2
   end subroutine set_range

   !> Dot across of a logarithm, 0 at the left border.
   pure integer function column_of(frame, x)
      type(frame_type), intent(in) :: frame
      real(dp), intent(in) :: x
      integer, parameter :: last = dots_across*chart_columns - 1

      column_of = nint(real(last, dp)*max(0.0_dp, min(1.0_dp, (x - frame%left)/(frame%right - frame%left))))
   end function column_of

   !> Dot down of a logarithm, 0 at the top.
   pure integer function row_of(frame, y)
      type(frame_type), intent(in) :: frame
      real(dp), intent(in) :: y

      row_of = nint(real(dots_down*frame%rows - 1, dp)*max(0.0_dp, min(1.0_dp, (frame%top - y)/(frame%top - frame%bottom))))
   end function row_of

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

   !> The model, straight between its points, where it is inside the frame.
   pure subroutine draw_model(cell, frame, tau, model)
      integer, intent(inout) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      real(dp), intent(in) :: tau(:), model(:)
      integer :: i, column, first, last
      real(dp) :: x, y, share

      do i = 1, size(tau) - 1
         if (.not. (is_drawn(tau(i)) .and. is_drawn(tau(i + 1)) .and. is_drawn(model(i)) .and. is_drawn(model(i + 1)))) cycle
         if (.not. tau(i + 1) > tau(i)) cycle
         first = column_of(frame, log10(tau(i)))
         last = column_of(frame, log10(tau(i + 1)))
         do column = first, last
            x = frame%left + (frame%right - frame%left)*real(column, dp)/real(dots_across*chart_columns - 1, dp)
            share = max(0.0_dp, min(1.0_dp, (x - log10(tau(i)))/(log10(tau(i + 1)) - log10(tau(i)))))
            y = (1.0_dp - share)*log10(model(i)) + share*log10(model(i + 1))
            if (y > frame%bottom .and. y < frame%top) call set_dot(cell, column, row_of(frame, y))
         end do
      end do
   end subroutine draw_model

   !> A bar between the limits.
   pure subroutine draw_limits(cell, frame, x, lower, upper)
      integer, intent(inout) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      !> Logarithm of the averaging time
      real(dp), intent(in) :: x
      real(dp), intent(in) :: lower, upper
      integer :: row

      if (.not. (is_drawn(lower) .and. is_drawn(upper))) return
      do row = row_of(frame, log10(upper))/dots_down, row_of(frame, log10(lower))/dots_down
         cell(column_of(frame, x)/dots_across, row) = bar
      end do
   end subroutine draw_limits

   !> Three lines of the slopes -1/2, 0 and +1/2 from one point, in the first corner without points.
   pure subroutine draw_slopes(cell, frame)
      integer, intent(inout) :: cell(0:, 0:)
      type(frame_type), intent(in) :: frame
      character(4), parameter :: names(-1:1) = ["-1/2", "0   ", "+1/2"]
      integer :: length, rise, across, down, corner, i, k, slope
      real(dp) :: steepness

      steepness = 0.5_dp*(frame%right - frame%left)/real(chart_columns, dp)*real(frame%rows, dp)/(frame%top - frame%bottom)
      length = int(min(12.0_dp, real(chart_columns, dp)/(frame%right - frame%left), 3.49_dp/steepness))
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
      real(dp), allocatable :: tick(:)
      logical :: is_tick(0:chart_columns - 1)
      integer :: row, column, i

      allocate (lines(frame%rows + 2))
      call find_ticks(frame%bottom, frame%top, tick)
      do row = 0, frame%rows - 1
         label = ""
         do i = 1, size(tick)
            if (row_of(frame, log10(tick(i)))/dots_down == row) label = tick_text(tick(i))
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
      call find_ticks(frame%left, frame%right, tick)
      do i = 1, size(tick)
         column = column_of(frame, log10(tick(i)))/dots_across
         is_tick(column) = .true.
         call put_centred(below, 2 + label_width + 2 + column, tick_text(tick(i)))
      end do
      text = repeat(" ", 2 + label_width)//trim(merge("└", "+  ", unicode))
      do column = 0, chart_columns - 1
         if (unicode) text = text//trim(merge("┴", "─", is_tick(column)))
         if (.not. unicode) text = text//merge("+", "-", is_tick(column))
      end do
      lines(frame%rows + 1)%text = text
      lines(frame%rows + 2)%text = trim(below)
   end subroutine frame_lines

   !> The decades of an axis, and twice and five times these where it has less than two.
   pure subroutine find_ticks(first, last, tick)
      !> Logarithms
      real(dp), intent(in) :: first, last
      real(dp), allocatable, intent(out) :: tick(:)
      real(dp), parameter :: steps(3) = [1.0_dp, 2.0_dp, 5.0_dp]
      integer :: decade, i, n, most

      n = floor(last) - ceiling(first) + 1
      most = merge(1, 3, n >= 2)
      allocate (tick(most*(n + 2)))
      n = 0
      do decade = floor(first), floor(last)
         do i = 1, most
            if (decade + log10(steps(i)) < first .or. decade + log10(steps(i)) > last) cycle
            n = n + 1
            tick(n) = steps(i)*10.0_dp**decade
         end do
      end do
      tick = tick(:n)
   end subroutine find_ticks

   !> "0.02", "500", "1e+06".
   pure function tick_text(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text

      text = number(value, 1)
      if (value >= 1.0_dp .and. value < 99999.0_dp) text = number(value, 5)
   end function tick_text

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
