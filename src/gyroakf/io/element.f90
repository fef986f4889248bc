! SPDX-License-Identifier: MIT
!> Numbers as machines store them: integers and IEEE floating point, 1 to 8 bytes, any byte order.
!>
!> Conversion looks at bits only: a NaN or an infinity of the file becomes a quiet NaN (missing)
!> without a floating-point operation, so that no trap is sprung, not even by a signaling NaN.
module gyroakf_io_element
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_ptr
   use, intrinsic :: iso_fortran_env, only : real32
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int16, int32, int64, int8
   implicit none (type, external)
   private
   public :: element_type, field_type, parse_element, element_word, element_name, is_native, &
      host_big_endian
   public :: swap_elements, convert_elements, drop_infinite

   !> How a number is stored
   type :: element_type
      !> "f" floating point, "i" signed, "u" unsigned integer, "b" logical, "V" a row of fields
      character(1) :: kind = "f"
      !> 1, 2, 4 or 8; those of all fields
      integer :: bytes = 8
      !> Order of the bytes; of no meaning for one byte
      logical :: big_endian = .false.
   end type element_type

   !> A number within a row of fields
   type, extends(element_type) :: field_type
      !> Bytes of the row before it
      integer :: offset = 0
   end type field_type

   !> Integers beyond it are not all doubles
   integer(int64), parameter :: exact = 9007199254740992_int64
   integer(int32), parameter :: infinite_32 = int(z"7F800000", int32)
   integer(int64), parameter :: infinite_64 = int(z"7FF0000000000000", int64)

contains

   !> Takes a word such as "f64", "i16be", "u8le" apart.
   pure subroutine parse_element(word, element, known)
      !> Without le or be: little endian
      character(*), intent(in) :: word
      type(element_type), intent(out) :: element
      logical, intent(out) :: known
      character(:), allocatable :: base

      base = word
      if (len(word) > 3) then
         element%big_endian = word(len(word) - 1:) == "be"
         if (element%big_endian .or. word(len(word) - 1:) == "le") base = word(:len(word) - 2)
      end if
      known = .true.
      select case (base)
      case ("f16", "f32", "f64", "i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64")
         element%kind = base(1:1)
         read (base(2:), "(i2)") element%bytes
         element%bytes = element%bytes/8
      case default
         known = .false.
      end select
   end subroutine parse_element

   !> The word for it, filled with blanks: "i16le"; without an order where it is one byte.
   pure function element_word(element) result(word)
      type(element_type), intent(in) :: element
      character(5) :: word
      character(2) :: bits

      write (bits, "(i0)") 8*element%bytes
      word = element%kind//trim(bits)
      if (element%bytes > 1) word(4:) = merge("be", "le", element%big_endian)
   end function element_word

   !> Its name, filled with blanks: "float32", "uint8", "bool", "structured"; big endian is said.
   pure function element_name(element) result(name)
      type(element_type), intent(in) :: element
      character(18) :: name
      character(12) :: bits

      write (bits, "(i0)") 8*element%bytes
      select case (element%kind)
      case ("f"); name = "float"//bits
      case ("i"); name = "int"//bits
      case ("u"); name = "uint"//bits
      case ("V"); name = "structured"
      case default; name = "bool"
      end select
      if (element%big_endian .and. element%bytes > 1) name = trim(name)//" big endian"
   end function element_name

   !> True on machines that store the most significant byte first.
   pure logical function host_big_endian()
      host_big_endian = transfer(1_int16, 1_int8) == 0_int8
   end function host_big_endian

   !> True for what this machine computes with: double precision in its own byte order.
   pure logical function is_native(element)
      type(element_type), intent(in) :: element

      is_native = element%kind == "f" .and. element%bytes == 8 .and. &
         (element%big_endian .eqv. host_big_endian())
   end function is_native

   !> Brings the bytes into this machine's order.
   subroutine swap_elements(address, count, element)
      !> Of the first number, aligned for it
      type(c_ptr), intent(in) :: address
      integer(int64), intent(in) :: count
      type(element_type), intent(in) :: element
      integer(int8), pointer, contiguous :: bytes(:, :)
      integer(int8) :: byte
      integer(int64) :: i
      integer :: j, n

      if (element%big_endian .eqv. host_big_endian()) return
      n = element%bytes
      call c_f_pointer(address, bytes, [int(n, int64), count])
      do i = 1, count
         do j = 1, n/2
            byte = bytes(j, i)
            bytes(j, i) = bytes(n + 1 - j, i)
            bytes(n + 1 - j, i) = byte
         end do
      end do
   end subroutine swap_elements

   !> Converts every step-th number; the bytes are in this machine's order.
   subroutine convert_elements(address, element, first, step, value, rounded)
      !> Of the first number, aligned for it
      type(c_ptr), intent(in) :: address
      type(element_type), intent(in) :: element
      !> The number that goes into value(1), from 1, and the distance to the next
      integer(int64), intent(in) :: first, step
      !> Filled; NaN where the file has a NaN or an infinity
      real(dp), intent(inout), contiguous :: value(:)
      !> Grows by the integers whose last digits are lost, being beyond 2^53
      integer(int64), intent(inout) :: rounded
      integer(int8), pointer, contiguous :: one(:)
      integer(int16), pointer, contiguous :: two(:)
      integer(int32), pointer, contiguous :: four(:)
      integer(int64), pointer, contiguous :: eight(:)
      integer(int64) :: last

      last = first + (size(value, kind=int64) - 1)*step
      if (size(value) == 0) return
      call c_f_pointer(address, one, [last])
      call c_f_pointer(address, two, [last])
      call c_f_pointer(address, four, [last])
      call c_f_pointer(address, eight, [last])
      select case (element%kind//achar(48 + element%bytes))
      case ("i1"); value(:) = real(one(first::step), dp)
      case ("u1"); value(:) = real(iand(int(one(first::step), int32), 255_int32), dp)
      case ("b1"); value(:) = merge(0.0_dp, 1.0_dp, one(first::step) == 0_int8)
      case ("i2"); value(:) = real(two(first::step), dp)
      case ("u2"); value(:) = real(iand(int(two(first::step), int32), 65535_int32), dp)
      case ("f2"); value(:) = half(int(two(first::step), int32))
      case ("i4"); value(:) = real(four(first::step), dp)
      case ("u4"); value(:) = real(iand(int(four(first::step), int64), int(z"FFFFFFFF", int64)), dp)
      case ("f4"); value(:) = single(four(first::step))
      case ("i8"); value(:) = real(eight(first::step), dp)
         rounded = rounded + count(eight(first::step) > exact .or. eight(first::step) < -exact, &
            kind=int64)
      case ("u8"); value(:) = unsigned(eight(first::step))
         rounded = rounded + count(eight(first::step) > exact .or. eight(first::step) < 0, &
            kind=int64)
      case default; value(:) = double(eight(first::step))
      end select
   end subroutine convert_elements

   !> Half precision: 1 bit for the sign, 5 for the exponent, 10 for the fraction.
   elemental real(dp) function half(bits)
      integer(int32), intent(in) :: bits
      integer(int32) :: exponent, fraction

      exponent = iand(shiftr(bits, 10), 31_int32)
      fraction = iand(bits, 1023_int32)
      if (exponent == 31) then
         half = ieee_value(half, ieee_quiet_nan)
         return
      end if
      if (exponent > 0) fraction = fraction + 1024
      half = scale(real(fraction, dp), max(exponent, 1) - 25)
      if (btest(bits, 15)) half = -half
   end function half

   elemental real(dp) function single(bits)
      integer(int32), intent(in) :: bits

      if (iand(bits, infinite_32) == infinite_32) then
         single = ieee_value(single, ieee_quiet_nan)
      else
         single = real(transfer(bits, 1.0_real32), dp)
      end if
   end function single

   elemental real(dp) function double(bits)
      integer(int64), intent(in) :: bits

      if (iand(bits, infinite_64) == infinite_64) then
         double = ieee_value(double, ieee_quiet_nan)
      else
         double = transfer(bits, double)
      end if
   end function double

   !> An unsigned integer of 64 bits; the last bit of a large one makes it odd, for the rounding.
   elemental real(dp) function unsigned(bits)
      integer(int64), intent(in) :: bits

      unsigned = real(bits, dp)
      if (bits < 0) unsigned = 2.0_dp*real(ior(shiftr(bits, 1), iand(bits, 1_int64)), dp)
   end function unsigned

   !> What was read in place: infinities and NaN of any kind become a quiet NaN.
   pure subroutine drop_infinite(value)
      real(dp), intent(inout), contiguous :: value(:)
      integer(int64) :: i

      do i = 1, size(value, kind=int64)
         value(i) = double(transfer(value(i), i))
      end do
   end subroutine drop_infinite

end module gyroakf_io_element
