! SPDX-License-Identifier: MIT
!> Signs of a report: its texts are written in ASCII, and shown with the signs of a terminal in UTF-8 or of LaTeX.
!>
!> "0.41 +/- 0.01 deg/sqrt(h)", "sigma^2", "tau <= 3", "|rho|" become "0.41 ± 0.01 deg/√h", "σ²", "τ ≤ 3", "|ρ|". A word counts
!> where it stands alone: the name of an option or a file keeps its letters.
module gyroakf_report_sign
   implicit none (type, external)
   private
   public :: sign_type, signs, find_sign, find_root, find_power, to_unicode

   !> A sign in its three forms
   type :: sign_type
      !> As the report's texts have it
      character(10) :: ascii = ""
      !> UTF-8
      character(4) :: unicode = ""
      !> In LaTeX's mathematics
      character(8) :: latex = ""
      !> A word, which counts where no letter stands beside it
      logical :: word = .false.
   end type sign_type

   !> All signs but roots and powers
   type(sign_type), parameter :: signs(*) = [ &
      sign_type("+/-", "±", "\pm"), sign_type("+-", "±", "\pm"), &
      sign_type("<=", "≤", "\le"), sign_type(">=", "≥", "\ge"), &
      sign_type("chi-square", "χ²", "\chi^2", .true.), sign_type("sigma", "σ", "\sigma", .true.), &
      sign_type("tau", "τ", "\tau", .true.), sign_type("rho", "ρ", "\rho", .true.), sign_type("pi", "π", "\pi", .true.)]

   character(*), parameter :: digits = "0123456789"
   character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

contains

   !> The row of the sign that begins at a byte, 0 where none does.
   pure integer function find_sign(text, i) result(row)
      !> ASCII or UTF-8
      character(*), intent(in) :: text
      !> 1 to its length
      integer, intent(in) :: i
      integer :: last

      do row = 1, size(signs)
         last = i + len_trim(signs(row)%ascii) - 1
         if (text(i:min(last, len(text))) /= signs(row)%ascii) cycle
         if (.not. signs(row)%word) return
         if (stands_alone(text, i, last)) return
      end do
      row = 0
   end function find_sign

   !> No letter, digit, hyphen or dot that belongs to a longer name is beside a word.
   pure logical function stands_alone(text, first, last)
      character(*), intent(in) :: text
      integer, intent(in) :: first, last
      character(len(text) + 3) :: padded

      padded = " "//text
      stands_alone = scan(padded(first:first), letters//digits//"_-.") == 0 .and. &
         scan(padded(last + 2:last + 2), letters//digits//"_-") == 0 .and. &
         .not. (padded(last + 2:last + 2) == "." .and. scan(padded(last + 3:last + 3), letters//digits) > 0)
   end function stands_alone

   !> The closing bracket of "sqrt(...)" that begins at a byte and has only letters and digits inside, 0 where none does.
   pure integer function find_root(text, i) result(last)
      !> ASCII or UTF-8
      character(*), intent(in) :: text
      !> 1 to its length
      integer, intent(in) :: i
      integer :: length

      last = 0
      if (text(i:min(i + 4, len(text))) /= "sqrt(") return
      if (.not. stands_alone(text, i, i + 3)) return
      length = verify(text(i + 5:), letters//digits)
      if (length < 2) return
      if (text(i + 4 + length:i + 4 + length) == ")") last = i + 4 + length
   end function find_root

   !> The last byte of a power, as "^2" or "^1.5", that begins at a byte, 0 where none does.
   pure integer function find_power(text, i) result(last)
      !> ASCII or UTF-8
      character(*), intent(in) :: text
      !> 1 to its length
      integer, intent(in) :: i

      last = 0
      if (i >= len(text) .or. i == 1) return
      if (text(i:i) /= "^" .or. scan(text(i + 1:i + 1), digits) == 0) return
      last = i + verify(text(i + 1:)//" ", digits//".") - 1
      do while (text(last:last) == ".")
         last = last - 1
      end do
   end function find_power

   !> The text with its signs in UTF-8.
   pure function to_unicode(text) result(shown)
      !> As the report's texts have it
      character(*), intent(in) :: text
      character(:), allocatable :: shown
      integer :: i, row, last

      shown = ""
      i = 1
      do while (i <= len(text))
         row = find_sign(text, i)
         last = find_root(text, i)
         if (row > 0) then
            shown = shown//trim(signs(row)%unicode)
            i = i + len_trim(signs(row)%ascii)
            cycle
         else if (last > 0) then
            shown = shown//"√"//text(i + 5:last - 1)
            i = last + 1
            cycle
         end if
         last = find_power(text, i)
         if (last == i + 1 .and. text(i + 1:i + 1) == "2") then
            shown = shown//"²"
            i = last + 1
         else
            shown = shown//text(i:i)
            i = i + 1
         end if
      end do
   end function to_unicode

end module gyroakf_report_sign
