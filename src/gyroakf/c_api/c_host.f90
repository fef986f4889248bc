! SPDX-License-Identifier: MIT
!> What belongs to the calling program: its floating-point environment; its progress function, which
!> may cancel a long call; its arrays, which begin at a possible address and share no memory. See
!> c_api/include/gyroakf.h.
module gyroakf_c_api_c_host
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, c_char, &
      & c_double, c_intptr_t, c_null_char, c_null_ptr, c_null_funptr, c_associated, c_f_pointer, &
      & c_f_procpointer
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   implicit none (type, external)
   private
   public :: progress_c, callback_type, set_aside, restore, begin_step, end_step
   public :: check_aligned, check_apart, copy_out

   !> Longest name of a stage
   integer, parameter :: longest_stage = 80

   !> `gyroakf_progress_fn` with its user pointer, as the options hold them
   type, bind(C) :: progress_c
      !> NULL: no callback
      type(c_funptr) :: function = c_null_funptr
      !> Handed on
      type(c_ptr) :: user = c_null_ptr
   end type progress_c

   !> The same for the library
   type, extends(progress_type) :: callback_type
      type(progress_c) :: program
   contains
      procedure :: advance => call_back
   end type callback_type

   abstract interface
      subroutine environment_interface(environment) bind(C)
         import :: c_int64_t
         implicit none (type, external)
         integer(c_int64_t), intent(inout) :: environment(64)
      end subroutine environment_interface

      integer(c_int32_t) function progress_interface(user, stage, done, total) bind(C)
         import :: c_ptr, c_int32_t, c_int64_t, c_char
         implicit none (type, external)
         type(c_ptr), intent(in), value :: user
         character(kind=c_char), intent(in) :: stage(*)
         integer(c_int64_t), intent(in), value :: done, total
      end function progress_interface
   end interface

   !> Keeps the environment of the program and sets the default one (host.c)
   procedure(environment_interface), bind(C, name="gyroakf_host_set_aside") :: set_aside
   !> The kept environment again
   procedure(environment_interface), bind(C, name="gyroakf_host_restore") :: restore
   !> Ends a step of a filter where begin_step was not 0
   procedure(environment_interface), bind(C, name="gyroakf_host_end_step") :: end_step

   interface
      !> As set_aside, for a step of a filter; 0 where nothing had to be done
      integer(c_int) function begin_step(environment) bind(C, name="gyroakf_host_begin_step")
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), intent(inout) :: environment(64)
      end function begin_step
   end interface

contains

   !> Calls the function of the program, which may leave a floating-point environment of its own
   !> behind.
   subroutine call_back(self, stage, done, total, cancel)
      class(callback_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel
      procedure(progress_interface), pointer :: callback
      character(kind=c_char) :: name(longest_stage + 1)
      integer(c_int64_t) :: left(64)
      integer :: i

      cancel = .false.
      if (.not. c_associated(self%program%function)) return
      name(:) = c_null_char
      do i = 1, min(len(stage), longest_stage)
         name(i) = stage(i:i)
      end do
      call c_f_procpointer(self%program%function, callback)
      cancel = callback(self%program%user, name, done, total) /= 0
      call set_aside(left)
   end subroutine call_back

   !> An array of doubles begins at a multiple of 8 bytes: loops are compiled for that, and end the
   !> program where it is not so.
   subroutine check_aligned(array, error)
      !> double *, a struct that holds doubles *, or NULL
      type(c_ptr), intent(in) :: array
      !> An earlier error stays; invalid_argument
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (modulo(address(array), 8_c_intptr_t) == 0) return
      call fatal_error(error, status%invalid_argument, &
         & "an array of doubles must begin at an address that is a multiple of 8")
   end subroutine check_aligned

   !> A result shares no memory with the series or another result: procedures may read the one after
   !> they have written the other.
   subroutine check_apart(array, bytes, error)
      !> The series and the results; NULL where one is not wanted: [m]
      type(c_ptr), intent(in) :: array(:)
      !> Their lengths, < 2**48: [m]
      integer(int64), intent(in) :: bytes(:)
      !> An earlier error stays; invalid_argument
      type(error_type), allocatable, intent(inout) :: error
      integer :: i, j

      if (allocated(error)) return
      do i = 1, size(array)
         do j = 1, i - 1
            if (.not. (c_associated(array(i)) .and. c_associated(array(j)))) cycle
            if (address(array(i)) >= address(array(j)) + bytes(j)) cycle
            if (address(array(j)) >= address(array(i)) + bytes(i)) cycle
            call fatal_error(error, status%invalid_argument, "arrays overlap: a result must "// &
               & "not share memory with the series or with another result")
            return
         end do
      end do
   end subroutine check_apart

   pure integer(c_intptr_t) function address(array)
      type(c_ptr), intent(in) :: array

      address = transfer(array, address)
   end function address

   !> Values into an array of the caller; nowhere where it is NULL.
   subroutine copy_out(values, array)
      !> [m]
      real(dp), intent(in) :: values(:)
      !> double * to m places, or NULL
      type(c_ptr), intent(in) :: array
      real(c_double), pointer, contiguous :: place(:)

      if (.not. c_associated(array)) return
      call c_f_pointer(array, place, [size(values)])
      place(:) = values
   end subroutine copy_out

end module gyroakf_c_api_c_host
