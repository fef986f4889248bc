! SPDX-License-Identifier: MIT
!> Signs of a report: its texts are written in ASCII, and shown with the signs of UTF-8.
!>
!> "0.41 +/- 0.01 deg/sqrt(h)", "sigma^2", "tau <= 3", "|rho|" become "0.41 ± 0.01 deg/√h", "σ²",
!> "τ ≤ 3", "|ρ|". A word counts where it stands alone: the name of an option or a file keeps its
!> letters.
module gyroakf_report_sign
   implicit none (type, external)
   private
   public :: to_unicode

   !> All signs but roots and squares
   character(10), parameter :: ascii(*) = [character(10) :: "+/-", "+-", "<=", ">=", "chi-square", &
                                           "sigma", "tau", "rho", "pi"]
   character(4), parameter :: unicode(*) = [character(4) :: "±", "±", "≤", "≥", "χ²", &
                                            "σ", "τ", "ρ", "π"]

   character(*), parameter :: digits = "0123456789"
   character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

contains

   !> The text with its signs in UTF-8.
   pure function to_unicode(text) result(shown)
      !> As the report's texts have it
      character(*), intent(in) :: text
      character(:), allocatable :: shown
      integer :: i, last, row

      shown = ""
      i = 1
      do while (i <= len(text))
         do row = 1, size(ascii)
            last = i + len_trim(ascii(row)) - 1
            if (text(i:min(last, len(text))) /= ascii(row)) cycle
            if (scan(ascii(row)(:1), letters) == 0 .or. stands_alone(text, i, last)) exit
         end do
         if (row <= size(ascii)) then
            shown = shown//trim(unicode(row))
         else if (root_length(text, i) > 0) then
            last = i + 5 + root_length(text, i)
            shown = shown//"√"//text(i + 5:last - 1)
         else if (is_square(text, i)) then
            last = i + 1
            shown = shown//"²"
         else
            last = i
            shown = shown//text(i:i)
         end if
         i = last + 1
      end do
   end function to_unicode

   !> No letter, digit, hyphen or dot that belongs to a longer name is beside a word.
   pure logical function stands_alone(text, first, last)
      character(*), intent(in) :: text
      integer, intent(in) :: first, last
      character(len(text) + 3) :: padded

      padded = " "//text
      stands_alone = scan(padded(first:first), letters//digits//"_-.") == 0 .and. &
         scan(padded(last + 2:last + 2), letters//digits//"_-") == 0 .and. &
         .not. (padded(last + 2:last + 2) == "." .and. &
                scan(padded(last + 3:last + 3), letters//digits) > 0)
   end function stands_alone

   !> Letters and digits inside the "sqrt(...)" that begins at a byte, 0 where none does.
   pure integer function root_length(text, i)
      character(*), intent(in) :: text
      integer, intent(in) :: i

      root_length = 0
      if (text(i:min(i + 4, len(text))) /= "sqrt(") return
      if (.not. stands_alone(text, i, i + 3)) return
      root_length = verify(text(i + 5:), letters//digits) - 1
      if (root_length < 1) root_length = 0
      if (text(i + 5 + root_length:min(i + 5 + root_length, len(text))) /= ")") root_length = 0
   end function root_length

   !> Whether "^2", and no longer number, is behind a byte.
   pure logical function is_square(text, i)
      character(*), intent(in) :: text
      integer, intent(in) :: i
      integer :: next

      is_square = .false.
      if (i == 1 .or. text(i:min(i + 1, len(text))) /= "^2") return
      next = i + 1 + verify(text(i + 2:)//" ", ".")
      is_square = scan(text(next:min(next, len(text))), digits) == 0
   end function is_square

end module gyroakf_report_sign
