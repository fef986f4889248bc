! SPDX-License-Identifier: MIT
!> What a file looks like before it is read: text or something else, decimal points or commas.
module gyroakf_io_format
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_text, only : bytes_text, first_visible, last_visible
   implicit none (type, external)
   private
   public :: decimal_comma, comma_found, comma_advice, foreign_content

   !> The message for a decimal comma
   character(*), parameter :: comma_found = "this looks like a decimal comma, and a comma separates columns"
   character(*), parameter :: comma_advice = "write decimal points, as with tr , . < FILE, or say --decimal-comma"

   integer(int8), parameter :: tab = 9, blank = 32, quote = 34, apostrophe = 39, comma = 44, point = 46, semicolon = 59

contains

   !> The byte of a comma that is a decimal comma, 0 where none is recognised.
   !>
   !> It is recognised in a line without decimal points where each comma stands between two digits and either other separators
   !> part fields of one comma at most (`1,5;2,3`), or the line has one comma with a leading zero behind it (`1,05`) or `-0`
   !> before it. A comma behind a time of day (`12:00:00,5`) is none.
   pure integer(int64) function decimal_comma(bytes, first, last) result(at)
      !> Holds a line of data at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p, from, to
      integer :: commas, in_field
      logical :: others, clock

      at = 0
      clock = .false.
      commas = 0
      in_field = 0
      others = .false.
      from = first_visible(bytes, first, last)
      to = last_visible(bytes, first, last)
      do p = from, to
         select case (bytes(p))
         case (point, quote, apostrophe); return
         case (iachar(":"))
            clock = .true.
         case (comma)
            if (clock) return
            if (.not. (is_digit(bytes, p - 1, from, to) .and. is_digit(bytes, p + 1, from, to)) .or. in_field == 1) return
            in_field = 1
            commas = commas + 1
         case (blank, tab, semicolon)
            others = .true.
            in_field = 0
            clock = .false.
         case default
            continue
         end select
      end do
      if (commas == 0) return
      do p = from, to
         if (bytes(p) == comma) exit
      end do
      if (others) at = p
      if (others) return
      if (bytes(p + 1) == 48 .and. is_digit(bytes, p + 2, from, to)) at = p
      if (p == from + 2 .and. bytes(from) == 45 .and. bytes(from + 1) == 48) at = p
   end function decimal_comma

   !> True for a digit within from:to.
   pure logical function is_digit(bytes, p, from, to)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, from, to

      is_digit = .false.
      if (p < from .or. p > to) return
      is_digit = bytes(p) >= 48 .and. bytes(p) <= 57
   end function is_digit

   !> What a first block holds that is no text.
   pure subroutine foreign_content(bytes, count, what, at)
      !> The first bytes of a file
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: count
      !> "" for text
      character(:), allocatable, intent(out) :: what
      !> Where it was seen
      integer(int64), intent(out) :: at
      integer(int64) :: i, controls
      character(:), allocatable :: head

      what = ""
      at = 1
      head = bytes_text(bytes, 1_int64, min(count, 8_int64))//repeat(" ", 8)
      if (head(:2) == char(31)//char(139)) what = "compressed by gzip"
      if (head(:2) == "PK") what = "a zip archive or a spreadsheet"
      if (head(:4) == char(137)//"HDF") what = "an HDF5 file"
      if (head(2:6) == "NUMPY") what = "a NumPy file"
      if (head(:2) == char(255)//char(254) .or. head(:2) == char(254)//char(255)) what = "text in UTF-16"
      if (len(what) > 0) return
      controls = 0
      do i = 1, count
         if (bytes(i) < 0 .or. bytes(i) > 31) cycle
         if (bytes(i) >= 9 .and. bytes(i) <= 13) cycle
         controls = controls + 1
         if (bytes(i) == 0 .or. 20*controls > count) then
            what = "binary"
            at = i
            return
         end if
      end do
   end subroutine foreign_content

end module gyroakf_io_format
