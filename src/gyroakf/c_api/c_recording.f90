! SPDX-License-Identifier: MIT
!> What stands behind a `gyroakf_record *` of C: the recording and its texts, as C expects them; and
!> recordings of arrays of the caller, see c_api/include/gyroakf.h.
module gyroakf_c_api_c_recording
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, &
      & c_double, c_loc, c_null_char, c_null_ptr, c_null_funptr, c_associated, c_f_pointer
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, fatal_error, status
   use gyroakf_progress, only : report_progress
   use gyroakf_io_reader, only : finish_record
   use gyroakf_record, only : record_type, text_type, unit_of
   use gyroakf_units, only : unit_type
   use gyroakf_utf8, only : make_readable
   use gyroakf_c_api_c_host, only : check_aligned
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, copy_c_text, max_samples
   implicit none (type, external)
   private
   public :: record_handle, new_handle, hand_over
   public :: gyroakf_record_new, gyroakf_record_new_watched

   !> What `gyroakf_record *` points at; its texts end with NUL, its missing values are NaN
   type :: record_handle
      type(record_type) :: record
      character(:), allocatable :: rate_source, format
      type(text_type), allocatable :: name(:), unit(:), warning(:)
   end type record_handle

   !> More channels than any recorder has
   integer(c_int32_t), parameter :: most_channels = 100000
   !> Samples that are copied between two reports of progress
   integer(int64), parameter :: report_samples = 1048576_int64

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
      call check_memory(stat, "a recording", c%error)
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
      if (associated(handle)) call export_record(handle)
      if (present(out)) out = c_null_ptr
      if (associated(handle)) out = c_loc(handle)
   end subroutine hand_over

   !> Makes of a record what C expects: texts that end with NUL, NaN where a sample is missing.
   subroutine export_record(handle)
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
            unit = unit_of(record, j)
            handle%name(j)%text = record%channel(j)%text//c_null_char
            handle%unit(j)%text = c_null_char
            if (allocated(unit%name)) handle%unit(j)%text = unit%name//c_null_char
            do i = 1, size(record%value, 1, kind=int64)
               if (.not. allocated(record%present)) exit
               if (record%present(i, j) == 0_int8) then
                  record%value(i, j) = ieee_value(1.0_dp, ieee_quiet_nan)
               end if
            end do
         end do
      end associate
   end subroutine export_record

   integer(c_int) function gyroakf_record_new(values, channels, n, dt, names, unit, out, &
      & err) bind(C)
      type(c_ptr), intent(in), value :: values, names, unit
      integer(c_int32_t), intent(in), value :: channels
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_record_new = gyroakf_record_new_watched(values, channels, n, dt, names, unit, out, &
         & c_null_funptr, c_null_ptr, err)
   end function gyroakf_record_new

   integer(c_int) function gyroakf_record_new_watched(values, channels, n, dt, names, unit, out, &
      & progress, progress_user, err) bind(C)
      type(c_ptr), intent(in), value :: values, names, unit, progress_user
      integer(c_int32_t), intent(in), value :: channels
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(c_ptr), intent(out), optional :: out
      type(c_funptr), intent(in), value :: progress
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(record_handle), pointer :: handle
      character(:), allocatable :: unit_text

      call enter_library(c, progress, progress_user)
      call new_handle(handle, c_associated(values), "the channels (values) must not be NULL", c, &
         & out)
      if (ok(c)) call copy_values(values, channels, n, handle%record, c)
      if (ok(c)) call copy_names(names, channels, handle%record)
      call copy_c_text(unit, "", unit_text)
      if (ok(c)) call finish_record(dt, unit_text, handle%record, c%error, c%callback)
      call hand_over(handle, c, out)
      gyroakf_record_new_watched = leave_library(c, err)
   end function gyroakf_record_new_watched

   subroutine copy_values(values, channels, n, record, c)
      type(c_ptr), intent(in) :: values
      integer(c_int32_t), intent(in) :: channels
      integer(c_int64_t), intent(in) :: n
      type(record_type), intent(inout) :: record
      !> Its errors are invalid_argument (numbers out of range, an array NULL or at an odd address),
      !> no_memory, cancelled
      type(call_type), intent(inout) :: c
      type(c_ptr), pointer :: given(:)
      real(c_double), pointer, contiguous :: x(:)
      integer(int64) :: i, first
      integer :: j, stat

      if (channels < 1 .or. channels > most_channels .or. n < 1 .or. n > max_samples) then
         call fatal_error(c%error, status%invalid_argument, &
            & "a recording has 1 .. 100000 channels of 1 .. 2**44 samples")
         return
      end if
      call c_f_pointer(values, given, [channels])
      do j = 1, channels
         if (.not. c_associated(given(j))) then
            call fatal_error(c%error, status%invalid_argument, "the array of a channel is NULL")
         end if
         call check_aligned(given(j), c%error)
         if (allocated(c%error)) return
      end do
      stat = merge(1, 0, n > max_samples/channels)
      if (stat == 0) allocate (record%value(n, channels), stat=stat)
      call check_memory(stat, "a copy of the samples", c%error)
      if (allocated(c%error)) return
      do j = 1, channels
         call c_f_pointer(given(j), x, [n])
         do first = 1, n, report_samples
            if (n > report_samples) call report_progress("copying the samples", &
               & (j - 1)*n + first - 1, channels*n, c%error, c%callback)
            if (allocated(c%error)) return
            do i = first, min(first + report_samples - 1, n)
               record%value(i, j) = x(i)
            end do
         end do
      end do
   end subroutine copy_values

   !> The names of the channels, without what cannot be shown, as those of files.
   subroutine copy_names(names, channels, record)
      type(c_ptr), intent(in) :: names
      integer(c_int32_t), intent(in) :: channels
      type(record_type), intent(inout) :: record
      type(c_ptr), pointer :: given(:)
      type(c_ptr) :: name
      character(16) :: usual
      integer :: j

      nullify (given)
      if (c_associated(names)) call c_f_pointer(names, given, [channels])
      allocate (record%channel(channels))
      do j = 1, channels
         name = c_null_ptr
         if (associated(given)) name = given(j)
         write (usual, '("column", i0)') j
         call copy_c_text(name, trim(usual), record%channel(j)%text)
         call make_readable(record%channel(j)%text)
      end do
   end subroutine copy_names

end module gyroakf_c_api_c_recording
