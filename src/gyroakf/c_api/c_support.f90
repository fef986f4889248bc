! SPDX-License-Identifier: MIT
!> What every C wrapper needs: the caller's error struct, its strings, its floating-point
!> environment, its arrays.
!>
!> A wrapper is
!>
!>     call enter_library(c)
!>     ... check the pointers; if (ok(c)), call one procedure of the library with `c%error` ...
!>     code = leave_library(c, err)
!>
!> and holds no numerics. The rules that C callers rely on are at the top of
!> c_api/include/gyroakf.h.
module gyroakf_c_api_c_support
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, c_char, &
      & c_size_t, c_null_char, c_associated, c_f_pointer
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_utf8, only : make_readable
   use gyroakf_allan_block_sums, only : count_non_finite
   use gyroakf_c_api_c_host, only : check_aligned, progress_c, callback_type, set_aside, restore
   implicit none (type, external)
   private
   public :: error_c, call_type, enter_library, leave_library, ok, open_options, open_series
   public :: check_struct_size, check_place, check_finite, copy_c_text, take_text, max_samples

   !> More samples than any machine can hold: counts beyond it are mistakes
   integer(int64), parameter :: max_samples = 2_int64**44

   !> Longest string that is accepted
   integer(c_size_t), parameter :: longest_text = 65536

   !> `gyroakf_error`
   type, bind(C) :: error_c
      integer(c_int32_t) :: code
      character(kind=c_char) :: message(256)
   end type error_c

   !> A call of a C function
   type :: call_type
      !> The caller's floating-point environment: space for the C library's fenv_t
      integer(c_int64_t) :: environment(64)
      !> What went wrong, if anything
      type(error_type), allocatable :: error
      !> The caller's progress function
      type(callback_type) :: callback
      !> The caller's series, as the library takes it: its own array, or a copy with 0 for NaN
      real(dp), pointer, contiguous :: x(:) => null()
      !> 1 present, 0 missing: [n]; allocated only where something is missing
      integer(int8), allocatable :: valid(:)
      !> The samples are a copy
      logical :: owned = .false.
   end type call_type

   interface
      !> Length of a C string
      integer(c_size_t) function strnlen(text, longest) bind(C)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), intent(in), value :: text
         integer(c_size_t), intent(in), value :: longest
      end function strnlen
   end interface

contains

   !> Keeps the caller's floating-point environment and sets the default one.
   subroutine enter_library(c, progress, user)
      !> What [[leave_library]] ends
      type(call_type), intent(out) :: c
      !> The caller's progress function, where it is no part of the options, and its pointer
      type(c_funptr), intent(in), optional :: progress
      type(c_ptr), intent(in), optional :: user

      call set_aside(c%environment)
      if (present(progress)) c%callback%program = progress_c(progress, user)
   end subroutine enter_library

   !> Whether nothing went wrong so far.
   pure logical function ok(c)
      !> From [[enter_library]]
      type(call_type), intent(in) :: c

      ok = .not. allocated(c%error)
   end function ok

   !> Closes the series, fills the caller's error struct, restores the caller's floating-point
   !> environment and returns the status.
   integer(c_int) function leave_library(c, err)
      !> From [[enter_library]]
      type(call_type), intent(inout) :: c
      !> The caller's struct; absent for NULL
      type(error_c), intent(out), optional :: err

      if (c%owned) deallocate (c%x)
      leave_library = status%ok
      if (allocated(c%error)) leave_library = c%error%code
      if (present(err)) then
         err%code = leave_library
         err%message(:) = c_null_char
         if (allocated(c%error)) then
            call make_readable(c%error%message, lines=.true.)
            call copy_text(c%error%message, err%message)
         end if
      end if
      call restore(c%environment)
   end function leave_library

   !> Copies a text of UTF-8, cut at a whole character where it is too long for the array and its
   !> final NUL.
   pure subroutine copy_text(text, array)
      character(*), intent(in) :: text
      character(kind=c_char), intent(inout) :: array(:)
      integer :: i, n

      n = min(len(text), size(array) - 1)
      if (n < len(text)) then
         do while (n > 0)
            if (iand(ichar(text(n + 1:n + 1)), 192) /= 128) exit   ! the next begins a character
            n = n - 1
         end do
      end if
      do i = 1, n
         array(i) = text(i:i)
      end do
   end subroutine copy_text

   !> The first member of an options struct must be what its _init wrote.
   subroutine check_struct_size(given, known, error)
      !> `struct_size` of the caller, and of this library
      integer(c_size_t), intent(in) :: given, known
      !> An earlier error stays; invalid_argument: of no version, not_supported: of a later one
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error) .or. given == known) return
      if (given > known) then
         call fatal_error(error, status%not_supported, &
            "struct_size of the options is that of a later version of the library")
      else
         call fatal_error(error, status%invalid_argument, &
            "the options are not initialized: call their _init function first")
      end if
   end subroutine check_struct_size

   !> Checks an options struct as [[check_struct_size]] and takes its progress function.
   subroutine open_options(given, known, progress, c)
      !> `struct_size` of the caller, and of this library
      integer(c_size_t), intent(in) :: given, known
      !> Not there where the struct is that of another version
      type(progress_c), intent(in) :: progress
      !> After an error nothing is done
      type(call_type), intent(inout) :: c

      call check_struct_size(given, known, c%error)
      if (.not. allocated(c%error)) c%callback%program = progress
   end subroutine open_options

   !> A place that the caller must give.
   pure subroutine check_place(there, what, error)
      !> It is not NULL
      logical, intent(in) :: there
      !> "result", "marks"
      character(*), intent(in) :: what
      !> An earlier error stays; invalid_argument
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error) .or. there) return
      call fatal_error(error, status%invalid_argument, &
         "the pointer to the "//what//" must not be NULL")
   end subroutine check_place

   !> Results are finite; those of values near the largest number may overflow.
   subroutine check_finite(results, error)
      !> Numbers that the caller is to get
      real(dp), intent(in) :: results(:)
      !> An earlier error stays; non_finite
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (.not. all(ieee_is_finite(results))) call fatal_error(error, status%non_finite, &
         "a result overflows: the values are too large; divide them by a constant first")
   end subroutine check_finite

   !> A C string; the default where it is NULL.
   !>
   !> (A subroutine: gfortran 12 keeps the length of a function's deferred-length text in static
   !> memory, which two threads would share.)
   subroutine copy_c_text(string, default, text)
      !> NUL-terminated, or NULL
      type(c_ptr), intent(in) :: string
      !> What NULL means
      character(*), intent(in) :: default
      !> The text
      character(:), allocatable, intent(out) :: text
      character(kind=c_char), pointer :: letters(:)
      integer(c_size_t) :: i, n

      text = default
      if (.not. c_associated(string)) return
      n = strnlen(string, longest_text)
      call c_f_pointer(string, letters, [n])
      deallocate (text)
      allocate (character(n) :: text)
      do i = 1, n
         text(i:i) = letters(i)
      end do
   end subroutine copy_c_text

   !> A C string into a variable of fixed length, which keeps its default where the string is NULL.
   subroutine take_text(string, value, error)
      !> NUL-terminated, or NULL
      type(c_ptr), intent(in) :: string
      !> The default in, the text out
      character(*), intent(inout) :: value
      !> An earlier error stays and nothing is done; invalid_argument: a text longer than any that
      !> is known
      type(error_type), allocatable, intent(inout) :: error
      character(:), allocatable :: text

      if (allocated(error)) return
      call copy_c_text(string, value, text)
      if (len(text) > len(value)) then
         call fatal_error(error, status%invalid_argument, "unknown option '"//text//"'")
      else
         value = text
      end if
   end subroutine take_text

   !> Takes a series of the caller: its own array where nothing is missing, else a copy with marks.
   subroutine open_series(array, n, c)
      !> const double *
      type(c_ptr), intent(in) :: array
      !> Its length
      integer(c_int64_t), intent(in) :: n
      !> Gets the series; nothing after an earlier error. invalid_argument: NULL, or a length out of
      !> range; non_finite: an infinite value; no_memory
      type(call_type), intent(inout) :: c
      real(dp), pointer, contiguous :: x(:)

      if (allocated(c%error)) return
      if (.not. c_associated(array) .or. n < 1 .or. n > max_samples) then
         call fatal_error(c%error, status%invalid_argument, &
            "a series must not be NULL and its length must be 1 .. 2**44")
      end if
      call check_aligned(array, c%error)
      if (allocated(c%error)) return
      call c_f_pointer(array, x, [n])
      c%x => x
      if (count_non_finite(x) == 0) return
      if (any(.not. (ieee_is_finite(x) .or. ieee_is_nan(x)))) then
         call fatal_error(c%error, status%non_finite, &
            "a value of the series is infinite (a missing one is NaN)")
      else
         call copy_series(x, c)
      end if
   end subroutine open_series

   !> The copy with 0 for NaN, and the marks.
   subroutine copy_series(x, c)
      real(dp), intent(in), contiguous :: x(:)
      type(call_type), intent(inout) :: c
      integer(int64) :: i, n
      integer :: stat

      n = size(x, kind=int64)
      nullify (c%x)
      allocate (c%valid(n), stat=stat)
      if (stat == 0) allocate (c%x(n), stat=stat)
      c%owned = stat == 0
      call check_memory(stat, "a copy of the series", c%error)
      do i = 1, merge(n, 0_int64, c%owned)
         c%valid(i) = merge(0_int8, 1_int8, ieee_is_nan(x(i)))
         c%x(i) = 0
         if (c%valid(i) == 1) c%x(i) = x(i)
      end do
   end subroutine copy_series

end module gyroakf_c_api_c_support
