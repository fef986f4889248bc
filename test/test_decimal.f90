! SPDX-License-Identifier: MIT
!> Numbers as text: the layout, and the digits against the Fortran library's.
module test_decimal
   use, intrinsic :: ieee_arithmetic, only : ieee_negative_inf, ieee_quiet_nan, ieee_value
   use expectations, only : unmet, test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_number, only : number, parse_number
   use gyroakf_io_decimal, only : format_real, shortest_digits
   use gyroakf_io_wide_power, only : int128, least_power, most_power, power_scale, wide_power
   implicit none (type, external)
   private
   public :: suite_decimal

   !> Limbs of 30 bits, the lowest first
   integer, parameter :: limbs = 48

contains

   subroutine suite_decimal()
      call test("written-numbers", test_numbers)
      call test("not-finite", test_not_finite)
      call test("random-against-library", test_library)
      call test("shortest-reads-back", test_shortest)
      call test("shortest-is-nearest", test_nearest)
      call test("known-shortest", test_known_shortest)
      call test("wide-powers", test_wide_powers)
   end subroutine suite_decimal

   subroutine test_numbers()
      real(dp), parameter :: value(13) = [0.0_dp, -0.0_dp, 1.0_dp, -0.25_dp, 0.1_dp, 0.1_dp, 12000.0_dp, 123456.0_dp, 1.0e-5_dp, &
         0.00012345_dp, 9.9996_dp, 1.0e100_dp, -2.5e-308_dp]
      integer, parameter :: digits(13) = [5, 5, 17, 9, 17, 9, 6, 3, 9, 9, 4, 3, 9]
      character(24), parameter :: expected(13) = [character(24) :: "0", "-0", "1", "-0.25", "0.10000000000000001", "0.1", "12000", &
         "1.23e+05", "1e-05", "0.00012345", "10", "1e+100", "-2.5e-308"]
      integer :: i

      do i = 1, size(value)
         call check(error, format_real(value(i), digits(i)), trim(expected(i)))
      end do
   end subroutine test_numbers

   subroutine test_not_finite()
      call check(error, format_real(ieee_value(1.0_dp, ieee_quiet_nan), 17), "nan")
      call check(error, format_real(ieee_value(1.0_dp, ieee_negative_inf), 0), "-inf")
   end subroutine test_not_finite

   !> A random number: any bits, or a short decimal, whose neighbors are ties.
   real(dp) function draw(state, i)
      integer(int64), intent(inout) :: state
      integer, intent(in) :: i
      integer(int64) :: bits
      integer :: k

      bits = 0
      do k = 1, 3
         state = mod(state*48271_int64, 2147483647_int64)
         bits = ior(shiftl(iand(bits, shiftl(1_int64, 32) - 1), 31), state)
      end do
      bits = ior(iand(bits, shiftl(1_int64, 52) - 1), shiftl(mod(state, 2047_int64), 52))
      draw = transfer(bits, draw)
      if (mod(i, 3) == 0) draw = real(state, dp)/2.0_dp**mod(i, 40)
      if (mod(i, 3) == 1) draw = real(mod(state, 100000_int64), dp)*1.0e-4_dp
   end function draw

   !> The Fortran library rounds correctly, too.
   subroutine test_library()
      character(40) :: text
      character(12) :: form
      integer(int64) :: state
      integer :: i
      real(dp) :: x

      state = 11
      do i = 1, 60000
         x = draw(state, i)
         write (form, "(a, i0, a)") "(es32.", mod(i, 17), "e4)"
         write (text, form) x
         if (normal_form(format_real(x, 1 + mod(i, 17))) == normal_form(trim(adjustl(text)))) cycle
         call check(error, .false., format_real(x, 1 + mod(i, 17))//" should be "//text)
         return
      end do
   end subroutine test_library

   !> "-0.0123", "-1.2300E-002" as "-123 -2": the digits without zeros around them and the exponent of the first.
   function normal_form(text) result(form)
      character(*), intent(in) :: text
      character(:), allocatable :: form
      character(20) :: exponent
      integer :: i, e, mark, point

      mark = scan(text//"e", "eE")
      e = 0
      if (mark < len(text)) read (text(mark + 1:), *) e
      point = scan(text(:mark - 1)//".", ".")
      form = ""
      do i = 1, mark - 1
         if (index("0123456789", text(i:i)) == 0 .or. (len(form) == 0 .and. text(i:i) == "0")) cycle
         if (len(form) == 0) e = e + point - i - merge(1, 0, i < point)
         form = form//text(i:i)
      end do
      form = form(:verify(form, "0", back=.true.))
      write (exponent, "(i0)") merge(e, 0, len(form) > 0)
      form = form//" "//trim(exponent)
      if (text(1:1) == "-") form = "-"//form
   end function normal_form

   subroutine test_shortest()
      integer(int64) :: state
      integer :: i, found
      real(dp) :: x, back

      if (unmet(format_real(0.1_dp, 0)//" "//format_real(-2.5e-7_dp, 0), "0.1 -2.5e-07")) return
      state = 7
      do i = 1, 20000
         x = draw(state, i)
         call parse_number(format_real(x, 0), back, found)
         if (found == number%ok .and. transfer(x, state) == transfer(back, state)) cycle
         call check(error, .false., format_real(x, 17)//" becomes "//format_real(x, 0))
         return
      end do
   end subroutine test_shortest

   !> No number of fewer digits reads back, and of those with as many none is nearer.
   subroutine test_nearest()
      integer(int64) :: state, whole
      integer :: i, exponent, found, used
      real(dp) :: x, back
      character(24) :: digit
      character(40) :: text
      character(12) :: form

      state = 5
      do i = 1, 20000
         x = abs(draw(state, i))
         if (x <= 0.0_dp) cycle
         call shortest_digits(x, whole, exponent)
         write (digit, "(i0)") whole
         used = max(1, verify(trim(digit), "0", back=.true.))
         write (form, "(a, i0, a)") "(es32.", used - 1, "e4)"
         write (text, form) x
         text = adjustl(text)
         call check(error, text(1:1)//trim(text(3:index(text, "E") - 1)), digit(:used))
         if (used == 1) cycle
         write (form, "(a, i0, a)") "(es32.", used - 2, "e4)"
         write (text, form) x
         call parse_number(trim(adjustl(text)), back, found)
         call check(error, abs(back - x) > 0.0_dp, "fewer digits read back: "//text)
      end do
   end subroutine test_nearest

   !> The smallest and the largest, powers of two with a narrow step below, a halfway case.
   subroutine test_known_shortest()
      real(dp), parameter :: value(7) = [2.2250738585072014e-308_dp, huge(1.0_dp), 9007199254740992.0_dp, 1.0e23_dp, &
         9.5367431640625e-7_dp, 123456789012345680.0_dp, 2.0_dp**(-44)]
      character(24), parameter :: expected(7) = [character(24) :: "2.2250738585072014e-308", "1.7976931348623157e+308", &
         "9007199254740992", "1e+23", "9.5367431640625e-07", "1.2345678901234568e+17", "5.684341886080802e-14"]
      integer :: i

      do i = 1, size(value)
         call check(error, format_real(value(i), 0), trim(expected(i)))
      end do
      call check(error, format_real(transfer(1_int64, 1.0_dp), 0), "5e-324")
   end subroutine test_known_shortest

   !> power * 2^scale <= 10^k < (power + 1) * 2^scale for every k, in integers of any length.
   subroutine test_wide_powers()
      integer(int128) :: power
      integer(int64) :: below(limbs), above(limbs), exact(limbs)
      integer :: k

      do k = least_power, most_power
         call wide_power(k, power)
         call check(error, shiftr(power, 125) == 1, "not 126 bits")
         call expand(power, max(0, -k), max(0, power_scale(k)), below)
         call expand(power + 1, max(0, -k), max(0, power_scale(k)), above)
         call expand(1_int128, max(0, k), max(0, -power_scale(k)), exact)
         call check(error, .not. less(exact, below) .and. less(exact, above), "a power of ten is wrong")
      end do
   end subroutine test_wide_powers

   !> number * 10^tens * 2^twos
   subroutine expand(number, tens, twos, big)
      integer(int128), intent(in) :: number
      integer, intent(in) :: tens, twos
      integer(int64), intent(out) :: big(:)
      integer :: i

      big = 0
      do i = 1, 5
         big(i) = int(iand(shiftr(number, 30*(i - 1)), 2_int128**30 - 1), int64)
      end do
      do i = 1, tens
         call multiply(big, 10_int64)
      end do
      do i = 1, twos/30
         big = eoshift(big, -1)
      end do
      call multiply(big, 2_int64**mod(twos, 30))
   end subroutine expand

   !> Times a small factor
   subroutine multiply(big, factor)
      integer(int64), intent(inout) :: big(:)
      integer(int64), intent(in) :: factor
      integer(int64) :: carry
      integer :: i

      carry = 0
      do i = 1, size(big)
         carry = carry + big(i)*factor
         big(i) = iand(carry, 2_int64**30 - 1)
         carry = shiftr(carry, 30)
      end do
   end subroutine multiply

   !> a < b
   pure logical function less(a, b)
      integer(int64), intent(in) :: a(:), b(:)
      integer :: i

      less = .false.
      do i = size(a), 1, -1
         less = a(i) < b(i)
         if (a(i) /= b(i)) return
      end do
   end function less

end module test_decimal
