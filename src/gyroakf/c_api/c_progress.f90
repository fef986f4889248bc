! SPDX-License-Identifier: MIT
!> C: progress callback, a function of the program that may cancel a long call. See c_api/include/gyroakf.h.
module gyroakf_c_api_c_progress
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int32_t, c_int64_t, c_char, c_null_char, c_null_ptr, c_null_funptr, &
      & c_associated, c_f_procpointer
   use gyroakf_kinds, only : int64
   use gyroakf_progress, only : progress_type
   use gyroakf_c_api_c_support, only : host_type, enter_library
   implicit none (type, external)
   private
   public :: callback_type

   !> Longest name of a stage
   integer, parameter :: longest_stage = 80

   !> `gyroakf_progress_fn` with its user pointer
   type, extends(progress_type) :: callback_type
      !> NULL: no callback
      type(c_funptr) :: function = c_null_funptr
      !> Handed on
      type(c_ptr) :: user = c_null_ptr
   contains
      procedure :: advance => call_back
   end type callback_type

   abstract interface
      integer(c_int32_t) function progress_interface(user, stage, done, total) bind(C)
         import :: c_ptr, c_int32_t, c_int64_t, c_char
         implicit none (type, external)
         type(c_ptr), intent(in), value :: user
         character(kind=c_char), intent(in) :: stage(*)
         integer(c_int64_t), intent(in), value :: done, total
      end function progress_interface
   end interface

contains

   !> Calls the function of the program, which may leave a floating-point environment of its own behind.
   subroutine call_back(self, stage, done, total, cancel)
      !> The function
      class(callback_type), intent(inout) :: self
      !> As those of [[gyroakf_progress(module)]]
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel
      procedure(progress_interface), pointer :: callback
      character(kind=c_char) :: name(longest_stage + 1)
      type(host_type) :: left
      integer :: i

      cancel = .false.
      if (.not. c_associated(self%function)) return
      name(:) = c_null_char
      do i = 1, min(len(stage), longest_stage)
         name(i) = stage(i:i)
      end do
      call c_f_procpointer(self%function, callback)
      cancel = callback(self%user, name, done, total) /= 0
      call enter_library(left)
   end subroutine call_back

end module gyroakf_c_api_c_progress
