! SPDX-License-Identifier: MIT
!> Numbers of a report as texts: rounded to their errors, in plain words where they are counts; and
!> its signs.
!>
!> Texts are written in ASCII, and shown with the signs of UTF-8: "0.41 +/- 0.01 deg/sqrt(h)",
!> "sigma^2", "tau <= 3", "|rho|" become "0.41 ± 0.01 deg/√h", "σ²", "τ ≤ 3", "|ρ|". A word counts
!> where it stands alone: the name of an option or a file keeps its letters.
module gyroakf_report_number_text
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : count_text => integer_text
   implicit none (type, external)
   private
   public :: number, rounded, scientific, fixed, count_text, p_value_text, plural, percent, &
      if_known, to_unicode

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

   !> A number at so many significant digits, "-" where it is not finite.
   pure function number(value, digits) result(text)
      !> Any
      real(dp), intent(in) :: value
      !> 1 to 17
      integer, intent(in) :: digits
      character(:), allocatable :: text

      text = "-"
      if (ieee_is_finite(value)) text = format_real(value, digits)
   end function number

   !> 1.4883e-04: so many digits and an exponent.
   pure function scientific(value, digits) result(text)
      !> Any
      real(dp), intent(in) :: value
      !> 2 to 17
      integer, intent(in) :: digits
      character(:), allocatable :: text
      character(40) :: buffer
      character(16) :: layout
      logical :: long

      text = "-"
      if (.not. ieee_is_finite(value)) return
      long = abs(value) > 0.0_dp .and. (abs(value) < 1.0e-99_dp .or. abs(value) > 9.9e99_dp)
      write (layout, "(a, i0, a, i0, a)") "(es40.", digits - 1, "e", merge(3, 2, long), ")"
      write (buffer, layout) value
      text = trim(adjustl(buffer))
      text(index(text, "E"):index(text, "E")) = "e"
   end function scientific

   !> A number with so many decimals, "-" where it is not finite.
   pure function fixed(value, decimals) result(text)
      !> Any
      real(dp), intent(in) :: value
      !> 0 to 17
      integer, intent(in) :: decimals
      character(:), allocatable :: text
      character(64) :: buffer
      character(16) :: layout

      text = scientific(value, 6)
      if (.not. abs(value) < 1.0e15_dp) return
      write (layout, "(a, i0, a)") "(f64.", decimals, ")"
      write (buffer, layout) value
      text = trim(adjustl(buffer))
      if (decimals == 0) text = text(:len(text) - 1)
   end function fixed

   !> A number rounded to two digits of its standard error, "2.484 +/- 0.017"; four digits where
   !> there is none.
   pure function rounded(value, std_error) result(text)
      !> Any
      real(dp), intent(in) :: value
      !> 0: not known
      real(dp), intent(in) :: std_error
      character(:), allocatable :: text
      real(dp) :: unit
      integer :: decimals

      text = number(value, 4)
      if (.not. (ieee_is_finite(std_error) .and. std_error > 0.0_dp)) return
      decimals = 1 - floor(log10(std_error))
      if (abs(decimals) > 7 .or. .not. abs(value) < 1.0e6_dp) then
         text = text//" +/- "//number(std_error, 2)
         return
      end if
      if (anint(std_error*10.0_dp**decimals) > 99.0_dp) decimals = decimals - 1
      unit = 10.0_dp**(-decimals)
      text = fixed(unit*anint(value/unit), max(0, decimals))//" +/- "// &
             fixed(unit*anint(std_error/unit), max(0, decimals))
   end function rounded

   !> "1 gap", "2 gaps".
   pure function plural(value, noun) result(text)
      !> How many
      integer(int64), intent(in) :: value
      !> Takes an s
      character(*), intent(in) :: noun
      character(:), allocatable :: text

      text = count_text(value)//" "//noun
      if (value /= 1) text = text//"s"
   end function plural

   !> "61.2 %".
   pure function percent(share) result(text)
      !> 1 is all
      real(dp), intent(in) :: share
      character(:), allocatable :: text

      text = number(100*share, 3)//" %"
   end function percent

   !> A text where it is known, else another one.
   pure function if_known(known, text, other) result(shown)
      logical, intent(in) :: known
      character(*), intent(in) :: text
      !> Default: ""
      character(*), intent(in), optional :: other
      character(:), allocatable :: shown

      shown = ""
      if (present(other)) shown = other
      if (known) shown = text
   end function if_known

   !> "p = 0.031", "p < 1e-20".
   pure function p_value_text(p) result(text)
      !> 0 to 1
      real(dp), intent(in) :: p
      character(:), allocatable :: text

      text = "p = "//number(p, 2)
      if (p < 1.0e-20_dp) text = "p < 1e-20"
      if (.not. ieee_is_finite(p)) text = "p not known"
   end function p_value_text

end module gyroakf_report_number_text
