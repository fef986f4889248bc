! SPDX-License-Identifier: MIT
!> What the rows of a table look like, and how they are read fast; [[gyroakf_io_row]] is the careful
!> way through other lines.
!>
!> Both work on a block of whole lines and know nothing of files: blocks go to several threads.
module gyroakf_io_rows
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_date, only : scan_stamp, stamp_kind
   use gyroakf_io_number, only : is_missing_field, number, scan_any
   use gyroakf_io_quick_number, only : quick_number, quick_type, skip_digits
   implicit none (type, external)
   private
   public :: layout_type, problem_type, parse_rows

   !> Which columns a file has, and which of them are kept
   type :: layout_type
      !> Columns of every row
      integer :: columns = 0
      !> Columns that are kept
      integer :: stored = 0
      !> Where a column is kept, 0 where it is not: [column]
      integer, allocatable :: slot(:)
      !> The last column may be left away: the first row ended with a separator
      logical :: last_optional = .false.
      !> Columns of dates and times of day: one of the components of stamp_kind, negative where it
      !> is added to what another column of the same slot gave: [column]
      integer, allocatable :: kind(:)
      !> Stamps are counted from this day or whole number
      integer(int64) :: origin = 0
      !> The column that is a date and a time of day with blanks between them, 0 where there is none
      integer :: joined = 0
      !> What commas are, see [[gyroakf_io_commas]]: 0 where they part columns
      integer :: commas = 0
      !> The line of the names: where it is met again it is no row; unallocated where there is none
      integer(int8), allocatable :: heading(:)
      !> Only rows are read that hold this in this column, 0 for all rows
      integer :: where_column = 0
      integer(int8), allocatable :: where_value(:)
      !> The value as a number, NaN where it is none
      real(dp) :: where_number = 0.0_dp
      !> Other rows are wrong: a column of words distinguishes records of several kinds
      logical :: strict = .false.
      !> Rows hold labels or brackets, see [[gyroakf_io_marks]]; only those of the first row are
      !> read, others are wrong, or left out
      logical :: marked = .false., where_label = .false.
      integer(int64) :: skeleton = 0
      !> Lines that cannot be read count as missing samples instead of being an error
      logical :: bad_lines_missing = .false.
      !> Semicolons part the columns: a line that begins with one may be a row
      logical :: semicolons = .false.
   end type layout_type

   !> What is wrong with a row
   type :: problem_type
      !> False where nothing is
      logical :: found = .false.
      !> The byte
      integer(int64) :: at = 0
      !> What is wrong, and what to do; unallocated where texts are not requested
      character(:), allocatable :: what, advice
   end type problem_type

   !> Bytes of a word that may stand for a missing number, and the bytes behind a field
   integer(int64), parameter :: longest_word = 11
   integer(int8), parameter :: ends(6) = [9_int8, 10_int8, 13_int8, 32_int8, 44_int8, 59_int8]
   integer(int8), parameter :: tab = 9, line_feed = 10, carriage_return = 13, blank = 32, &
      comma = 44, semicolon = 59

contains

   !> Reads rows until one is not made of plain numbers, the lines end, or `value` is full.
   pure subroutine parse_rows(bytes, at, last, layout, value, rows, odd)
      !> Holds whole lines up to `last`, a line feed, and more bytes behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte of a line; afterwards that of the first line that was not read
      integer(int64), intent(inout) :: at
      integer(int64), intent(in) :: last
      type(layout_type), intent(in) :: layout
      !> [row, stored column]
      real(dp), intent(inout), contiguous :: value(:, :)
      !> Rows of `value` that are filled
      integer(int64), intent(inout) :: rows
      !> True where the line at `at` needs [[gyroakf_io_row:read_row]]
      logical, intent(out) :: odd
      integer(int64) :: p, capacity
      integer :: j, slot
      logical :: stamped
      type(quick_type) :: quick

      odd = .false.
      stamped = any(layout%kind /= stamp_kind%number)
      if (layout%columns == 1 .and. layout%stored == 1 .and. .not. stamped) then
         call parse_column(bytes, at, last, value(:, 1), rows)
      end if
      capacity = size(value, 1, kind=int64)
      do while (at <= last .and. rows < capacity)
         p = at
         do j = 1, layout%columns
            do while (bytes(p) == blank .or. bytes(p) == tab)
               p = p + 1
            end do
            slot = layout%slot(j)
            if (stamped) then
               if (layout%kind(j) /= stamp_kind%number) then
                  call scan_time(bytes, p, layout, j, value(rows + 1, :), odd)
                  slot = -1
               end if
            end if
            if (slot == 0) then
               call skip_field(bytes, p, odd)
            else if (slot > 0) then
               quick = quick_number(bytes, p)
               if (quick%next > 0) then
                  value(rows + 1, slot) = quick%value
                  p = quick%next
               else
                  call scan_other(bytes, p, value(rows + 1, slot), odd)
               end if
            end if
            if (odd) return
            if (bytes(p) == line_feed .and. j == layout%columns) then
               exit
            else if (bytes(p) == blank .or. bytes(p) == tab .or. bytes(p) == carriage_return) then
               do while (bytes(p) == blank .or. bytes(p) == tab .or. bytes(p) == carriage_return)
                  p = p + 1
               end do
               if (bytes(p) == comma .or. bytes(p) == semicolon) p = p + 1
            else if (bytes(p) == comma .or. bytes(p) == semicolon) then
               p = p + 1
            else
               odd = .true.
               return
            end if
         end do
         odd = bytes(p) /= line_feed
         if (odd) return
         rows = rows + 1
         at = p + 1
      end do
   end subroutine parse_rows

   !> The same for files of one column, as far as lines are a usual number and nothing else.
   pure subroutine parse_column(bytes, at, last, value, rows)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: at
      integer(int64), intent(in) :: last
      real(dp), intent(inout), contiguous :: value(:)
      integer(int64), intent(inout) :: rows
      type(quick_type) :: quick
      integer(int64) :: p, row

      p = at
      do row = rows + 1, size(value, kind=int64)
         if (p > last) exit
         quick = quick_number(bytes, p)
         if (quick%next == 0) exit
         if (bytes(quick%next) == carriage_return) quick%next = quick%next + 1
         if (bytes(quick%next) /= line_feed) exit
         value(row) = quick%value
         p = quick%next + 1
      end do
      rows = row - 1
      at = p
   end subroutine parse_column

   !> Reads a number that is not usual; NaN for a field before a comma that is empty, and for a word
   !> that stands for a missing number; odd where it is none of these.
   pure subroutine scan_other(bytes, p, value, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      real(dp), intent(inout) :: value
      logical, intent(out) :: odd
      integer(int64) :: first
      integer :: found

      call scan_any(bytes, p, value, found)
      odd = found == number%overflow
      if (found /= number%none) return
      value = ieee_value(1.0_dp, ieee_quiet_nan)
      first = p
      odd = bytes(p) == line_feed
      if (odd .or. bytes(p) == comma) return
      do while (p < first + longest_word .and. .not. any(bytes(p) == ends))
         p = p + 1
      end do
      odd = .not. is_nan(bytes, first, p)
      if (odd) odd = .not. is_missing_field(bytes, first, p - 1)
      if (odd) p = first
   end subroutine scan_other

   !> Reads a field of a date or a time of day, wanted or not.
   pure subroutine scan_time(bytes, p, layout, column, row, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      real(dp), intent(inout) :: row(:)
      logical, intent(out) :: odd
      real(dp) :: x
      integer :: slot
      logical :: found

      call scan_stamp(bytes, p, abs(layout%kind(column)), layout%origin, x, found)
      odd = .not. found
      slot = layout%slot(column)
      if (odd .or. slot == 0) return
      if (layout%kind(column) < 0) x = x + row(slot)
      row(slot) = x
   end subroutine scan_time

   !> True for the word that is met most, in any case, before a byte.
   pure logical function is_nan(bytes, first, behind)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, behind

      is_nan = behind == first + 3
      if (is_nan) is_nan = ior(int(bytes(first)), 32) == 110 .and. &
         ior(int(bytes(first + 1)), 32) == 97 .and. ior(int(bytes(first + 2)), 32) == 110
   end function is_nan

   !> Moves behind an unwanted field; odd where it is empty, quoted or the start of a comment.
   pure subroutine skip_field(bytes, p, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      logical, intent(out) :: odd
      integer(int64) :: first

      first = p
      odd = .true.
      if (any(bytes(p) == [34_int8, 35_int8, 37_int8, 39_int8, 47_int8])) return
      do
         call skip_digits(bytes, p)
         select case (bytes(p))
         case (tab, line_feed, carriage_return, blank, comma, semicolon); exit
         case default; p = p + 1
         end select
      end do
      odd = p == first .and. bytes(p) /= comma
   end subroutine skip_field

end module gyroakf_io_rows
