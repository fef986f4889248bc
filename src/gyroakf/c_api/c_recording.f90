! SPDX-License-Identifier: MIT
!> What stands behind a `gyroakf_record *` of C: the recording and its texts, as C expects them.
module gyroakf_c_api_c_recording
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only : c_ptr, c_loc, c_null_char, c_null_ptr
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : fatal_error, status
   use gyroakf_record, only : record_type, text_type
   use gyroakf_units, only : unit_type
   use gyroakf_c_api_c_support, only : call_type, check_place
   implicit none (type, external)
   private
   public :: record_handle, new_handle, hand_over, unit_of

   !> What `gyroakf_record *` points at; its texts end with NUL, its missing values are NaN
   type :: record_handle
      type(record_type) :: record
      character(:), allocatable :: rate_source, format
      type(text_type), allocatable :: name(:), unit(:), warning(:)
   end type record_handle

contains

   !> An empty handle; the caller's input and `out` must be there.
   subroutine new_handle(handle, good, needed, c, out)
      !> None after an error
      type(record_handle), pointer, intent(out) :: handle
      !> The input is there, and what is said where it is not
      logical, intent(in) :: good
      character(*), intent(in) :: needed
      !> Gets the error
      type(call_type), intent(inout) :: c
      !> The place of the result
      type(c_ptr), intent(in), optional :: out
      integer :: stat

      nullify (handle)
      call check_place(present(out), "result (out)", c%error)
      if (allocated(c%error)) return
      stat = 0
      if (good) allocate (handle, stat=stat)
      if (stat /= 0) call fatal_error(c%error, status%no_memory, "no memory for a recording")
      if (.not. good) call fatal_error(c%error, status%invalid_argument, needed)
   end subroutine new_handle

   !> The handle to the caller; nothing after an error.
   subroutine hand_over(handle, c, out)
      !> From [[new_handle]], with its recording
      type(record_handle), pointer, intent(inout) :: handle
      !> May hold an error
      type(call_type), intent(in) :: c
      !> The place of the result
      type(c_ptr), intent(inout), optional :: out

      if (allocated(c%error) .and. associated(handle)) deallocate (handle)
      if (associated(handle)) call dress(handle)
      if (present(out)) out = c_null_ptr
      if (associated(handle)) out = c_loc(handle)
   end subroutine hand_over

   !> Makes of a record what C expects: texts that end with NUL, NaN where a sample is missing.
   subroutine dress(handle)
      type(record_handle), intent(inout) :: handle
      type(unit_type) :: unit
      integer(int64) :: i
      integer :: j

      associate (record => handle%record)
         if (.not. allocated(record%audit%line_of_first)) then
            allocate (record%audit%line_of_first(3), source=0_int64)
         end if
         if (.not. allocated(record%warnings)) allocate (record%warnings(0))
         handle%rate_source = record%rate_source//c_null_char
         handle%format = record%format//c_null_char
         allocate (handle%name(size(record%channel)), handle%unit(size(record%channel)))
         allocate (handle%warning(size(record%warnings)))
         do j = 1, size(record%warnings)
            handle%warning(j)%text = record%warnings(j)%text//c_null_char
         end do
         do j = 1, size(record%channel)
            call unit_of(record, j, unit)
            handle%name(j)%text = record%channel(j)%text//c_null_char
            handle%unit(j)%text = unit%name//c_null_char
            do i = 1, size(record%value, 1, kind=int64)
               if (.not. allocated(record%present)) exit
               if (record%present(i, j) == 0_int8) then
                  record%value(i, j) = ieee_value(1.0_dp, ieee_quiet_nan)
               end if
            end do
         end do
      end associate
   end subroutine dress

   !> The unit of a channel; its name is "" where it is unknown.
   subroutine unit_of(record, channel, unit)
      !> A recording and the number of a channel, from 1 on
      type(record_type), intent(in) :: record
      integer, intent(in) :: channel
      !> Its unit
      type(unit_type), intent(out) :: unit

      unit = record%unit
      if (allocated(record%channel_unit)) unit = record%channel_unit(channel)
      if (.not. allocated(unit%name)) unit%name = ""
   end subroutine unit_of

end module gyroakf_c_api_c_recording
