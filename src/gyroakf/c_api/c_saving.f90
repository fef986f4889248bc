! SPDX-License-Identifier: MIT
!> The C interface to filters put away and taken up again. What each function promises is said in
!> c_api/include/gyroakf.h.
module gyroakf_c_api_c_saving
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int8_t, c_int64_t, c_associated, &
      & c_f_pointer
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_place, only : integer_text
   use gyroakf_filter_saving, only : save_filter, restore_filter, reset_filter
   use gyroakf_c_api_c_filter, only : handle_type, new_handle, hand_over
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & max_samples
   implicit none (type, external)
   private
   public :: gyroakf_filter_reset, gyroakf_filter_save, gyroakf_filter_restore

   !> Bytes a word
   integer(int64), parameter :: word_bytes = 8

contains

   integer(c_int) function gyroakf_filter_reset(f, err) bind(C)
      type(c_ptr), intent(in), value :: f
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(handle_type), pointer :: handle

      call enter_library(c)
      if (c_associated(f)) then
         call c_f_pointer(f, handle)
         call reset_filter(handle%filter, c%error)
      else
         call fatal_error(c%error, status%invalid_argument, "the filter must not be NULL")
      end if
      gyroakf_filter_reset = leave_library(c, err)
   end function gyroakf_filter_reset

   integer(c_int) function gyroakf_filter_save(f, bytes, capacity, size_out, err) bind(C)
      type(c_ptr), intent(in), value :: f, bytes
      integer(c_int64_t), intent(in), value :: capacity
      integer(c_int64_t), intent(inout), optional :: size_out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(handle_type), pointer :: handle
      integer(int64), allocatable :: word(:)

      call enter_library(c)
      if (.not. c_associated(f) .or. .not. present(size_out)) then
         call fatal_error(c%error, status%invalid_argument, &
            & "the filter and the pointer to the size must not be NULL")
      else
         call c_f_pointer(f, handle)
         call save_filter(handle%filter, word, c%error)
         if (ok(c)) then
            size_out = word_bytes*size(word, kind=int64)
            if (c_associated(bytes)) call write_bytes(word, bytes, capacity, c%error)
         end if
      end if
      gyroakf_filter_save = leave_library(c, err)
   end function gyroakf_filter_save

   integer(c_int) function gyroakf_filter_restore(bytes, length, out, err) bind(C)
      type(c_ptr), intent(in), value :: bytes
      integer(c_int64_t), intent(in), value :: length
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(handle_type), pointer :: handle
      integer(int64), allocatable :: word(:)

      call enter_library(c)
      call new_handle(handle, c%error, out)
      if (ok(c)) call read_bytes(bytes, length, word, c%error)
      if (ok(c)) call restore_filter(word, handle%filter, c%error)
      call hand_over(handle, c%error, out)
      gyroakf_filter_restore = leave_library(c, err)
   end function gyroakf_filter_restore

   !> Words into the caller's bytes, at any address.
   subroutine write_bytes(word, bytes, capacity, error)
      integer(int64), intent(in) :: word(:)
      type(c_ptr), intent(in) :: bytes
      integer(c_int64_t), intent(in) :: capacity
      !> invalid_argument: too few
      type(error_type), allocatable, intent(out) :: error
      integer(c_int8_t), pointer :: place(:)
      integer(int64) :: needed

      needed = word_bytes*size(word, kind=int64)
      if (capacity < needed) then
         call fatal_error(error, status%invalid_argument, "the state of this filter takes "// &
            & integer_text(needed)//" bytes, there are "//integer_text(capacity))
         return
      end if
      call c_f_pointer(bytes, place, [needed])
      place(:) = transfer(word, place)
   end subroutine write_bytes

   subroutine read_bytes(bytes, length, word, error)
      type(c_ptr), intent(in) :: bytes
      integer(c_int64_t), intent(in) :: length
      integer(int64), allocatable, intent(out) :: word(:)
      !> invalid_argument, parse (no whole number of words), no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(c_int8_t), pointer, contiguous :: place(:)
      integer :: stat

      if (.not. c_associated(bytes) .or. length < 1 .or. length > max_samples) then
         call fatal_error(error, status%invalid_argument, &
            & "the bytes of a filter must not be NULL, their number must be 1 .. 2**44")
      else if (modulo(length, word_bytes) /= 0) then
         call fatal_error(error, status%parse, &
            & "the state of a filter is cut short or has something behind it")
      else
         allocate (word(length/word_bytes), stat=stat)
         call check_memory(stat, "the state of a filter", error)
      end if
      if (allocated(error)) return
      call c_f_pointer(bytes, place, [length])
      word(:) = transfer(place, word)
   end subroutine read_bytes

end module gyroakf_c_api_c_saving
