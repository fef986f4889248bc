! SPDX-License-Identifier: MIT
!> Decimal numbers: bit for bit what the C library's strtod reads, whatever their length and exponent.
module test_number
   use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_double, c_int, c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: ieee_exceptions, only : ieee_flag_type, ieee_get_halting_mode, ieee_overflow, ieee_set_flag, &
      ieee_set_halting_mode, ieee_underflow
   use expectations, only : unmet, test, error, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_quick_number, only : quick_number, quick_type
   use gyroakf_io_wide_power, only : int128, least_power, power, wide_power
   use gyroakf_io_number, only : scan_number, parse_number, is_missing_word, number, digits_ahead
   implicit none (type, external)
   private
   public :: suite_number

   !> Characters of the longest number
   integer, parameter :: longest = 900

   !> The text of a number under construction
   type :: builder_type
      character(longest) :: text
      integer :: length
      !> State of the generator (multiplicative congruential, modulus 2^31 - 1)
      integer(int64) :: state
   end type builder_type

   interface
      function c_strtod(text, end) result(value) bind(C, name="strtod")
         import :: c_char, c_double, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: text(*)
         type(c_ptr), intent(in), value :: end
         real(c_double) :: value
      end function c_strtod

      function c_setlocale(category, name) result(set) bind(C, name="setlocale")
         import :: c_char, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), intent(in), value :: category
         character(kind=c_char), intent(in) :: name(*)
         type(c_ptr) :: set
      end function c_setlocale

   end interface

contains

   subroutine suite_number()
      call test("written-numbers", test_written)
      call test("refused-texts", test_refused)
      call test("place-after", test_place)
      call test("overflow-underflow", test_overflow)
      call test("missing-words", test_missing)
      call test("locale", test_locale)
      call test("powers", test_powers)
      call test("usual-forms", test_usual)
      call test("random", test_random)
   end subroutine suite_number

   !> A random integer from 0 to n - 1, n <= 2^30.
   integer function draw(b, n)
      type(builder_type), intent(inout) :: b
      integer, intent(in) :: n

      b%state = mod(b%state*48271_int64, 2147483647_int64)
      draw = int(b%state*int(n, int64)/2147483647_int64)
   end function draw

   !> Empties the text but for a sign in one of four.
   subroutine begin(b)
      type(builder_type), intent(inout) :: b

      b%length = 0
      if (draw(b, 4) == 0) call add(b, "-")
      if (draw(b, 16) == 0 .and. b%length == 0) call add(b, "+")
   end subroutine begin

   !> Appends a text.
   subroutine add(b, text)
      type(builder_type), intent(inout) :: b
      character(*), intent(in) :: text

      b%text(b%length + 1:b%length + len(text)) = text
      b%length = b%length + len(text)
   end subroutine add

   !> Appends n random digits, in one of eight texts nines or zeros only.
   subroutine add_digits(b, n)
      type(builder_type), intent(inout) :: b
      integer, intent(in) :: n
      integer :: i, what

      what = draw(b, 16)
      do i = b%length + 1, b%length + n
         b%text(i:i) = achar(48 + draw(b, 10))
         if (what == 0) b%text(i:i) = "9"
         if (what == 1) b%text(i:i) = "0"
      end do
      b%length = b%length + n
   end subroutine add_digits

   !> Appends an exponent from `low` to `high`.
   subroutine add_exponent(b, low, high)
      type(builder_type), intent(inout) :: b
      integer, intent(in) :: low, high
      integer :: e
      character(8) :: text

      e = low + draw(b, high - low + 1)
      write (text, "(i0)") abs(e)
      call add(b, merge("e", "E", draw(b, 2) == 0))
      if (e < 0) call add(b, "-")
      if (e >= 0 .and. draw(b, 2) == 0) call add(b, "+")
      call add(b, trim(text))
   end subroutine add_exponent

   !> Reads the text by both readers; false where a bit differs.
   logical function same(b)
      type(builder_type), intent(inout) :: b
      integer(int8) :: bytes(b%length + digits_ahead + 1)
      character(kind=c_char) :: text(b%length + 1)
      real(dp) :: value, expected
      integer(int64) :: at
      integer :: i, found

      bytes = 10_int8
      do i = 1, b%length
         bytes(i) = int(iachar(b%text(i:i)), int8)
         text(i) = b%text(i:i)
      end do
      text(b%length + 1) = c_null_char
      expected = reference(text)
      at = 1
      call scan_number(bytes, at, value, found)
      same = at == b%length + 1
      if (abs(expected) > huge(expected)) then
         same = same .and. found == number%overflow .and. abs(value) >= huge(value)
      else
         same = same .and. found == number%ok .and. transfer(value, at) == transfer(expected, at)
      end if
   end function same

   !> The 63 bits that the compiler computes are the first of the 126 that are checked against integers of any length.
   subroutine test_powers()
      integer(int128) :: wide
      integer :: k

      do k = least_power, ubound(power, 1)
         call wide_power(k, wide)
         call check(error, power(k) == int(shiftr(wide, 63), int64))
      end do
   end subroutine test_powers

   !> Numbers of usual forms are read right, and nearly all of them without the careful path, though not all.
   subroutine test_usual()
      type(builder_type) :: b
      integer(int8) :: bytes(40 + digits_ahead)
      type(quick_type) :: quick
      character(16), parameter :: usual(7) = [character(16) :: &
         ".5", "-.25", "1e5", "9.765625E-4", "+2.5d-100", ".125e+007", "00012.5"]
      character(16), parameter :: unusual(7) = [character(16) :: &
         ".", "-", "+.e5", "1e", "1e+", "1e1234", "1234567890123456"]
      integer :: i, j, careful

      do i = 1, size(usual)
         call check(error, is_quick(usual(i)), "careful: "//usual(i))
         if (unmet(.not. is_quick(unusual(i)), "quick: "//unusual(i))) return
      end do
      b%state = 77
      careful = 0
      do i = 1, 40000
         call begin(b)
         if (mod(i, 2) == 0) call add_digits(b, 1 + draw(b, 7))
         if (mod(i, 2) == 0) call add(b, ".")
         if (mod(i, 2) == 0) call add_digits(b, draw(b, 9))
         if (mod(i, 2) == 1) call add(b, achar(48 + draw(b, 10))//".")
         if (mod(i, 2) == 1) call add_digits(b, 18)
         if (mod(i, 2) == 1) call add(b, "e"//merge("-", "+", draw(b, 2) == 0)//achar(48 + draw(b, 10))//achar(48 + draw(b, 10)))
         if (.not. same(b)) then
            call check(error, .false., b%text(:b%length))
            return
         end if
         bytes = 10_int8
         bytes(:b%length) = [(int(iachar(b%text(j:j)), int8), j=1, b%length)]
         quick = quick_number(bytes, 1_int64)
         if (quick%next == 0) careful = careful + 1
      end do
      call check(error, careful > 0 .and. careful < 1500)
   end subroutine test_usual

   !> Whether the text is a number of a usual form that ends where the text does.
   pure logical function is_quick(text)
      character(*), intent(in) :: text
      integer(int8) :: bytes(len(text) + digits_ahead + 1)
      type(quick_type) :: quick
      integer :: i

      bytes = 10_int8
      bytes(:len_trim(text)) = [(int(iachar(text(i:i)), int8), i=1, len_trim(text))]
      quick = quick_number(bytes, 1_int64)
      is_quick = quick%next == len_trim(text) + 1
   end function is_quick

   !> What the C library reads, also where overflow and underflow trap.
   real(dp) function reference(text)
      character(kind=c_char), intent(in) :: text(*)
      type(ieee_flag_type), parameter :: flags(2) = [ieee_overflow, ieee_underflow]
      logical :: halting(2)

      call ieee_get_halting_mode(flags, halting)
      call ieee_set_halting_mode(flags, .false.)
      reference = c_strtod(text, c_null_ptr)
      call ieee_set_flag(flags, .false.)
      call ieee_set_halting_mode(flags, halting)
   end function reference

   subroutine test_written()
      character(24), parameter :: text(20) = [character(24) :: "0", "-0", "1", "+1", ".5", "5.", "1.5D-3", "1.5d3", "1e0", "1E+2", &
         "0.1", "123456789012345678", "9007199254740993", "1.7976931348623157e308", "2.2250738585072014e-308", "4.9e-324", &
         "0.00000001", "00012.5", "  7.25 ", "1e-5"]
      real(dp), parameter :: expected(20) = [0.0_dp, -0.0_dp, 1.0_dp, 1.0_dp, 0.5_dp, 5.0_dp, 1.5e-3_dp, 1.5e3_dp, 1.0_dp, &
         100.0_dp, 0.1_dp, 123456789012345678.0_dp, 9007199254740992.0_dp, huge(1.0_dp), tiny(1.0_dp), 0.0_dp, &
         1.0e-8_dp, 12.5_dp, 7.25_dp, 1.0e-5_dp]
      real(dp) :: value, right
      integer :: i, found

      do i = 1, size(text)
         call parse_number(text(i), value, found)
         right = expected(i)
         if (i == 16) right = transfer(1_int64, right)
         call check(error, found == number%ok .and. transfer(value, 1_int64) == transfer(right, 1_int64), text(i))
      end do
   end subroutine test_written

   subroutine test_refused()
      character(8), parameter :: text(17) = [character(8) :: "", "-", "+", ".", "-.", "e5", "1e", "1e+", "1d-", "0x10", "1,5", &
         "1.5.2", "1 2", "--1", "abc", "nan", "1.5f"]
      real(dp) :: value
      integer :: i, found

      do i = 1, size(text)
         call parse_number(text(i), value, found)
         call check(error, found, number%none, more=text(i))
      end do
   end subroutine test_refused

   subroutine test_place()
      character(*), parameter :: text = "12.5;-3e2x7e"
      integer(int8) :: bytes(len(text) + digits_ahead + 1)
      integer(int64) :: at
      integer :: i, found
      real(dp) :: value

      bytes = 10_int8
      bytes(:len(text)) = [(int(iachar(text(i:i)), int8), i=1, len(text))]
      at = 1
      call scan_number(bytes, at, value, found)
      call check(error, at == 5 .and. value == 12.5_dp, "first")
      at = 6
      call scan_number(bytes, at, value, found)
      call check(error, at == 10 .and. value == -300.0_dp, "second")
      at = 11
      call scan_number(bytes, at, value, found)
      call check(error, at == 11 .and. found == number%none, "an exponent without digits")
   end subroutine test_place

   subroutine test_overflow()
      real(dp) :: value
      integer :: found

      call parse_number("-1e999", value, found)
      call check(error, found == number%overflow .and. value <= -huge(value), "-1e999")
      call parse_number("1e99999999999999999999", value, found)
      call check(error, found, number%overflow)
      call parse_number("1.7976931348623159e308", value, found)
      call check(error, found, number%overflow)
      call parse_number("1e-99999999999999999999", value, found)
      call check(error, found == number%ok .and. value == 0.0_dp, "to zero")
      call parse_number("0e999", value, found)
      call check(error, found == number%ok .and. value == 0.0_dp, "zero stays zero")
   end subroutine test_overflow

   subroutine test_missing()
      character(9), parameter :: yes(10) = [character(9) :: &
         "nan", "NaN", "-nan", "NA", "n/a", "inf", "-Inf", "+INFINITY", "null", "None"]
      character(9), parameter :: no(7) = [character(9) :: "", "-", "n", "nano", "in", "1", "infinit"]
      integer :: i

      do i = 1, size(yes)
         call check(error, is_missing_word(trim(yes(i))), yes(i))
      end do
      do i = 1, size(no)
         call check(error, .not. is_missing_word(trim(no(i))), "taken: "//no(i))
      end do
   end subroutine test_missing

   !> Where the German locale is installed strtod wants a comma; this reader does not care. (1 is LC_NUMERIC of Linux.)
   subroutine test_locale()
      character(*), parameter :: tie = "9007199254740993.0000000000000000000000"
      logical :: german
      real(dp) :: value, plain
      integer :: found

      german = c_associated(c_setlocale(1_c_int, "de_DE.UTF-8"//c_null_char))
      plain = c_strtod("1.5"//c_null_char, c_null_ptr)
      call parse_number(tie, value, found)
      if (unmet(c_associated(c_setlocale(1_c_int, "C"//c_null_char)), "locale C")) return
      call check(error, (plain < 1.25_dp) .eqv. german, "strtod does not heed the locale")
      call check(error, found == number%ok .and. transfer(value, 1_int64) == transfer(9007199254740992.0_dp, 1_int64), tie)
   end subroutine test_locale

   !> Random numbers of six kinds.
   subroutine test_random()
      integer, parameter :: texts(6) = [450000, 300000, 100000, 60000, 40000, 1500]
      type(builder_type) :: b
      integer :: i, kind

      do kind = 1, size(texts)
         b%state = kind
         do i = 1, texts(kind)
            call draw_number(b, kind)
            ! a little beside halfway
            if (same(b) .and. kind == 4) call add(b, repeat("0", draw(b, 9))//"1")
            if (same(b)) cycle
            call check(error, .false., b%text(:b%length))
            return
         end do
      end do
   end subroutine test_random

   !> A number of one of the kinds.
   subroutine draw_number(b, kind)
      type(builder_type), intent(inout) :: b
      integer, intent(in) :: kind
      real(dp) :: value
      integer(int64) :: bits

      if (kind /= 5) call begin(b)
      select case (kind)
      case (1)   ! as files have them: up to 20 digits before and 25 after the point
         call add_digits(b, 1 + draw(b, merge(3, 20, draw(b, 2) == 0)))
         if (draw(b, 8) > 0) call add(b, ".")
         if (b%text(b%length:b%length) == ".") call add_digits(b, draw(b, 26))
      case (2)   ! 1 to 25 digits and an exponent anywhere in the range and beyond
         call add_digits(b, 1)
         call add(b, ".")
         call add_digits(b, draw(b, 25))
         if (draw(b, 2) == 0) call add_exponent(b, -30, 30)
         if (b%text(b%length:b%length) == "." .or. draw(b, 2) == 0) call add_digits(b, 1)
         if (scan(b%text(:b%length), "eE") == 0) call add_exponent(b, -345, 312)
      case (3)   ! around the smallest normal number and below
         call add_digits(b, 1)
         call add(b, ".")
         call add_digits(b, draw(b, 22))
         call add_exponent(b, -326, -305)
      case (4)   ! exactly between two numbers: (2 m + 1)/2^k with a mantissa m of 53 bits
         bits = 2_int64**53 + 2*(int(draw(b, 2**26), int64)*2_int64**26 + draw(b, 2**26)) + 1
         if (draw(b, 8) == 0) bits = 2_int64**54 - 1
         call add_halved(b, bits, draw(b, 70))
      case (5)   ! random bits printed with 17 digits, which have to come back
         bits = int(draw(b, 2**26), int64)*2_int64**26 + draw(b, 2**26)
         value = transfer(shiftl(int(1 + draw(b, 2045), int64), 52) + bits, value)
         write (b%text(:24), "(es24.16e3)") value
         b%text(:24) = adjustl(b%text(:24))
         b%length = len_trim(b%text(:24))
      case default   ! hundreds of digits
         call add_digits(b, 1 + draw(b, 400))
         call add(b, ".")
         call add_digits(b, draw(b, 400))
         if (draw(b, 2) == 0) call add_exponent(b, -700, 300)
      end select
   end subroutine draw_number

   !> Appends whole/2^k with all of its decimal places.
   subroutine add_halved(b, whole, k)
      type(builder_type), intent(inout) :: b
      integer(int64), intent(in) :: whole
      integer, intent(in) :: k
      integer :: digit(0:100), places, i, j, rest
      character(20) :: text

      write (text, "(i0)") whole
      digit = 0
      places = len_trim(text)
      read (text, "(*(i1))") digit(1:places)
      do i = 1, k
         rest = 0
         do j = 1, len_trim(text) + i
            rest = 10*rest + digit(j)
            digit(j) = rest/2
            rest = mod(rest, 2)
         end do
      end do
      do i = 1, places + k
         if (i == places + 1) call add(b, ".")
         call add(b, achar(48 + digit(i)))
      end do
      if (k == 0) call add(b, ".")
   end subroutine add_halved

end module test_number
