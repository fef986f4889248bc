! SPDX-License-Identifier: MIT
!> Where a C caller wants results: arrays that begin at a possible address and share no memory, and
!> values into them.
module gyroakf_c_api_c_places
   use, intrinsic :: iso_c_binding, only : c_ptr, c_double, c_intptr_t, c_associated, c_f_pointer
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: check_aligned, check_apart, copy_out

contains

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
      !> Any
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

end module gyroakf_c_api_c_places
