! SPDX-License-Identifier: MIT
!> Random decimal numbers of every usual length, read by the library and by the C library's strtod: `number_check [COUNT]`.
!> Prints how many were compared and how many differ in a bit; ends with an error where any does.
program number_check
   use, intrinsic :: iso_c_binding, only : c_char, c_double, c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use gyroakf, only : dp
   use gyroakf_io_number, only : digits_ahead, scan_number
   implicit none (type, external)

   interface
      function c_strtod(text, end) result(value) bind(C, name="strtod")
         import :: c_char, c_double, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: text(*)
         type(c_ptr), intent(in), value :: end
         real(c_double) :: value
      end function c_strtod
   end interface

   call main()

contains

   subroutine main()
      character(20) :: argument
      integer(int64) :: count_wanted, i, wrong, chunk, done
      integer, parameter :: chunks = 64

      count_wanted = 20000000
      call get_command_argument(1, argument)
      if (len_trim(argument) > 0) read (argument, *) count_wanted
      wrong = 0
      done = 0
      !$omp parallel do schedule(dynamic) reduction(+:wrong, done)
      do chunk = 1, chunks
         call compare_some(chunk, count_wanted/chunks + 1, wrong)
         done = done + count_wanted/chunks + 1
      end do
      !$omp end parallel do
      i = done
      write (*, "(i0, a, i0, a)") i, " numbers compared with strtod, ", wrong, " differ"
      if (wrong > 0) error stop
   end subroutine main

   !> Compares numbers drawn from a seed.
   subroutine compare_some(seed, wanted, wrong)
      integer(int64), intent(in) :: seed, wanted
      integer(int64), intent(inout) :: wrong
      character(kind=c_char) :: text(100)
      integer(int8) :: bytes(100 + digits_ahead)
      integer(int64) :: state, i, at
      real(dp) :: x, y
      integer :: length, found, k

      state = 1 + 1000003*seed
      do i = 1, wanted
         call draw_number(state, text, length)
         bytes = 10_int8
         do k = 1, length
            bytes(k) = int(iachar(text(k)), int8)
         end do
         text(length + 1) = c_null_char
         at = 1
         call scan_number(bytes, at, x, found)
         y = c_strtod(text, c_null_ptr)
         if (abs(y) > huge(y)) y = sign(huge(y), y)
         if (transfer(x, i) == transfer(y, i) .and. at == length + 1) cycle
         wrong = wrong + 1
         !$omp critical
         if (wrong < 4) write (*, *) text(:length), x, y
         !$omp end critical
      end do
   end subroutine compare_some

   !> A number of a drawn form: [-] 0 to 20 digits . 0 to 25 digits [e+-dd].
   subroutine draw_number(state, text, length)
      integer(int64), intent(inout) :: state
      character(kind=c_char), intent(inout) :: text(:)
      integer, intent(out) :: length
      integer :: whole, part, k, exponent

      length = 0
      if (draw(state, 2) == 0) call add(text, length, "-")
      whole = max(draw(state, 4), draw(state, 24) - 3)
      part = draw(state, 26)
      if (draw(state, 3) == 0) then
         whole = 1
         part = 15 + draw(state, 6)
      end if
      if (whole + part == 0) whole = 1
      do k = 1, whole
         call add(text, length, achar(48 + draw(state, 10)))
      end do
      if (part > 0) call add(text, length, ".")
      do k = 1, part
         call add(text, length, achar(48 + merge(0, draw(state, 10), k <= 3 .and. whole == 0)))
      end do
      if (draw(state, 2) == 0) return
      call add(text, length, "e")
      if (draw(state, 2) == 0) call add(text, length, "-")
      exponent = draw(state, 40)
      if (draw(state, 8) == 0) exponent = draw(state, 320)
      if (exponent >= 100) call add(text, length, achar(48 + exponent/100))
      call add(text, length, achar(48 + mod(exponent/10, 10)))
      call add(text, length, achar(48 + mod(exponent, 10)))
   end subroutine draw_number

   !> Appends a character.
   subroutine add(text, length, c)
      character(kind=c_char), intent(inout) :: text(:)
      integer, intent(inout) :: length
      character(1), intent(in) :: c

      length = length + 1
      text(length) = c
   end subroutine add

   !> 0 to n - 1.
   integer function draw(state, n)
      integer(int64), intent(inout) :: state
      integer, intent(in) :: n

      state = mod(state*48271_int64, 2147483647_int64)
      draw = int(mod(state/256, int(n, int64)))
   end function draw

end program number_check
