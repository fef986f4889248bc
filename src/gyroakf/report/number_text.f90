! SPDX-License-Identifier: MIT
!> Numbers of a report as texts: rounded to their errors, in plain words where they are counts.
module gyroakf_report_number_text
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : count_text => integer_text
   implicit none (type, external)
   private
   public :: number, rounded, scientific, fixed, count_text, p_value_text, plural, percent, if_known

contains

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
