! SPDX-License-Identifier: MIT
!> C: recordings. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_record
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_char, c_null_ptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_record, only : record_type, text_type
   use gyroakf_units, only : unit_type
   use gyroakf_c_api_c_host, only : progress_c, callback_type
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_struct_size, check_place, copy_c_text, max_samples
   implicit none (type, external)
   private
   public :: record_handle, new_handle, hand_over
   public :: gyroakf_reader_options_init, gyroakf_record_read, gyroakf_record_parse, gyroakf_record_samples, &
      & gyroakf_record_channels, gyroakf_record_values, gyroakf_record_present, gyroakf_record_name, gyroakf_record_unit, &
      & gyroakf_record_to_si, gyroakf_record_sample_interval, gyroakf_record_rate_source, gyroakf_record_format, &
      & gyroakf_record_warnings, gyroakf_record_warning, gyroakf_record_audit, gyroakf_record_free

   !> `gyroakf_reader_options`
   type, bind(C) :: reader_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: format = c_null_ptr, columns = c_null_ptr, time_column = c_null_ptr
      integer(c_int64_t) :: skip = 0
      integer(c_int32_t) :: bad_lines_missing = 0
      type(c_ptr) :: input = c_null_ptr, unit = c_null_ptr
      real(c_double) :: scale, rate_hz, from, to
      integer(c_int64_t) :: memory
      type(c_ptr) :: resample = c_null_ptr, wrap = c_null_ptr
      integer(c_int64_t) :: channels = 0
      integer(c_int32_t) :: decimal_comma = 0
      type(progress_c) :: progress
   end type reader_options_c

   !> `gyroakf_audit`
   type, bind(C) :: audit_c
      integer(c_size_t) :: struct_size
      integer(c_int64_t) :: samples, missing, bad_lines
      integer(c_int32_t) :: has_stamps
      real(c_double) :: stamp_rate, jitter_max
      integer(c_int64_t) :: gaps, jumps, beats, duplicates, backward_steps
      integer(c_int64_t) :: first_duplicate, first_backward_step, first_gap
   end type audit_c

   !> What `gyroakf_record *` points at; its texts end with NUL, its missing values are NaN
   type :: record_handle
      type(record_type) :: record
      character(:), allocatable :: rate_source, format
      type(text_type), allocatable :: name(:), unit(:), warning(:)
   end type record_handle

contains

   !> `gyroakf_reader_options_init`
   subroutine gyroakf_reader_options_init(opt) bind(C, name="gyroakf_reader_options_init")
      type(reader_options_c), intent(out), optional :: opt
      type(reader_options) :: defaults

      if (present(opt)) opt = reader_options_c(c_sizeof(opt), scale=defaults%scale, rate_hz=defaults%rate_hz, &
         & from=defaults%from, to=defaults%to, memory=defaults%memory)
   end subroutine gyroakf_reader_options_init

   !> `gyroakf_record_read`
   integer(c_int) function gyroakf_record_read(path, opt, out, err) bind(C, name="gyroakf_record_read")
      type(c_ptr), intent(in), value :: path
      type(reader_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(record_handle), pointer :: handle
      type(reader_options) :: options
      type(error_type), allocatable :: error
      character(:), allocatable :: name

      call enter_library(c)
      call new_handle(handle, c_associated(path), "the path must not be NULL", error, out)
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      call copy_c_text(path, "", name)
      if (.not. allocated(error)) call read_record(name, options, handle%record, error, c%callback)
      call hand_over(handle, error, out)
      gyroakf_record_read = leave_library(c, error, err)
   end function gyroakf_record_read

   !> `gyroakf_record_parse`
   integer(c_int) function gyroakf_record_parse(bytes, n, opt, out, err) bind(C, name="gyroakf_record_parse")
      type(c_ptr), intent(in), value :: bytes
      integer(c_int64_t), intent(in), value :: n
      type(reader_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(record_handle), pointer :: handle
      type(reader_options) :: options
      type(error_type), allocatable :: error

      call enter_library(c)
      call new_handle(handle, c_associated(bytes) .and. n > 0 .and. n <= 8*max_samples, &
         & "the bytes must not be NULL, and there must be 1 .. 2**47 of them (n)", error, out)
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      if (.not. allocated(error)) then
         call c_f_pointer(bytes, options%bytes, [n])
         call read_record("<memory>", options, handle%record, error, c%callback)
      end if
      call hand_over(handle, error, out)
      gyroakf_record_parse = leave_library(c, error, err)
   end function gyroakf_record_parse

   !> `gyroakf_record_samples`
   integer(c_int64_t) function gyroakf_record_samples(r) bind(C, name="gyroakf_record_samples")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      gyroakf_record_samples = 0
      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_samples = size(handle%record%value, 1, kind=c_int64_t)
   end function gyroakf_record_samples

   !> `gyroakf_record_channels`
   integer(c_int32_t) function gyroakf_record_channels(r) bind(C, name="gyroakf_record_channels")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      gyroakf_record_channels = 0
      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_channels = size(handle%record%value, 2)
   end function gyroakf_record_channels

   !> `gyroakf_record_values`
   type(c_ptr) function gyroakf_record_values(r, channel) bind(C, name="gyroakf_record_values")
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel
      type(record_handle), pointer :: handle

      gyroakf_record_values = c_null_ptr
      if (channel < 0 .or. channel >= gyroakf_record_channels(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_values = c_loc(handle%record%value(1, channel + 1))
   end function gyroakf_record_values

   !> `gyroakf_record_present`
   type(c_ptr) function gyroakf_record_present(r, channel) bind(C, name="gyroakf_record_present")
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel
      type(record_handle), pointer :: handle

      gyroakf_record_present = c_null_ptr
      if (channel < 0 .or. channel >= gyroakf_record_channels(r)) return
      call c_f_pointer(r, handle)
      if (allocated(handle%record%present)) gyroakf_record_present = c_loc(handle%record%present(1, channel + 1))
   end function gyroakf_record_present

   !> `gyroakf_record_name`
   type(c_ptr) function gyroakf_record_name(r, channel) bind(C, name="gyroakf_record_name")
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel
      type(record_handle), pointer :: handle

      gyroakf_record_name = c_null_ptr
      if (channel < 0 .or. channel >= gyroakf_record_channels(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_name = c_loc(handle%name(channel + 1)%text)
   end function gyroakf_record_name

   !> `gyroakf_record_unit`
   type(c_ptr) function gyroakf_record_unit(r, channel) bind(C, name="gyroakf_record_unit")
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel
      type(record_handle), pointer :: handle

      gyroakf_record_unit = c_null_ptr
      if (channel < 0 .or. channel >= gyroakf_record_channels(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_unit = c_loc(handle%unit(channel + 1)%text)
   end function gyroakf_record_unit

   !> `gyroakf_record_to_si`
   real(c_double) function gyroakf_record_to_si(r, channel) bind(C, name="gyroakf_record_to_si")
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel
      type(record_handle), pointer :: handle
      type(unit_type) :: unit

      gyroakf_record_to_si = 0
      if (channel < 0 .or. channel >= gyroakf_record_channels(r)) return
      call c_f_pointer(r, handle)
      call unit_of(handle%record, channel + 1, unit)
      if (len(unit%name) > 0) gyroakf_record_to_si = unit%to_si
   end function gyroakf_record_to_si

   !> `gyroakf_record_sample_interval`
   real(c_double) function gyroakf_record_sample_interval(r) bind(C, name="gyroakf_record_sample_interval")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      gyroakf_record_sample_interval = 0
      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_sample_interval = handle%record%sample_interval
   end function gyroakf_record_sample_interval

   !> `gyroakf_record_rate_source`
   type(c_ptr) function gyroakf_record_rate_source(r) bind(C, name="gyroakf_record_rate_source")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      gyroakf_record_rate_source = c_null_ptr
      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_rate_source = c_loc(handle%rate_source)
   end function gyroakf_record_rate_source

   !> `gyroakf_record_format`
   type(c_ptr) function gyroakf_record_format(r) bind(C, name="gyroakf_record_format")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      gyroakf_record_format = c_null_ptr
      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_format = c_loc(handle%format)
   end function gyroakf_record_format

   !> `gyroakf_record_warnings`
   integer(c_int32_t) function gyroakf_record_warnings(r) bind(C, name="gyroakf_record_warnings")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      gyroakf_record_warnings = 0
      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_warnings = size(handle%warning)
   end function gyroakf_record_warnings

   !> `gyroakf_record_warning`
   type(c_ptr) function gyroakf_record_warning(r, i) bind(C, name="gyroakf_record_warning")
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: i
      type(record_handle), pointer :: handle

      gyroakf_record_warning = c_null_ptr
      if (i < 0 .or. i >= gyroakf_record_warnings(r)) return
      call c_f_pointer(r, handle)
      gyroakf_record_warning = c_loc(handle%warning(i + 1)%text)
   end function gyroakf_record_warning

   !> `gyroakf_record_audit`
   integer(c_int) function gyroakf_record_audit(r, out) bind(C, name="gyroakf_record_audit")
      type(c_ptr), intent(in), value :: r
      type(audit_c), intent(inout), optional :: out
      type(record_handle), pointer :: handle

      gyroakf_record_audit = status%invalid_argument
      if (.not. c_associated(r) .or. .not. present(out)) return
      if (out%struct_size /= c_sizeof(out)) return
      call c_f_pointer(r, handle)
      associate (audit => handle%record%audit)
         out = audit_c(out%struct_size, audit%samples, audit%missing, audit%bad_lines, &
            merge(1_c_int32_t, 0_c_int32_t, audit%has_stamps), audit%stamp_rate, audit%jitter_max, audit%gaps, audit%jumps, &
            audit%beats, audit%duplicates, audit%backward_steps, audit%line_of_first(1), audit%line_of_first(2), &
            audit%line_of_first(3))
      end associate
      gyroakf_record_audit = status%ok
   end function gyroakf_record_audit

   !> `gyroakf_record_free`
   subroutine gyroakf_record_free(r) bind(C, name="gyroakf_record_free")
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      if (.not. c_associated(r)) return
      call c_f_pointer(r, handle)
      deallocate (handle)
   end subroutine gyroakf_record_free

   !> An empty handle; the caller's input and `out` must be there.
   subroutine new_handle(handle, good, needed, error, out)
      type(record_handle), pointer, intent(out) :: handle
      logical, intent(in) :: good
      character(*), intent(in) :: needed
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr), intent(in), optional :: out
      integer :: stat

      nullify (handle)
      call check_place(present(out), "result (out)", error)
      if (.not. (allocated(error) .or. good)) then
         call fatal_error(error, status%invalid_argument, needed)
      end if
      stat = 0
      if (.not. allocated(error)) allocate (handle, stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for a recording")
   end subroutine new_handle

   !> The handle to the caller; nothing after an error.
   subroutine hand_over(handle, error, out)
      type(record_handle), pointer, intent(inout) :: handle
      type(error_type), allocatable, intent(in) :: error
      type(c_ptr), intent(inout), optional :: out

      if (allocated(error) .and. associated(handle)) deallocate (handle)
      if (.not. present(out)) return
      out = c_null_ptr
      if (.not. associated(handle)) return
      call dress(handle)
      out = c_loc(handle)
   end subroutine hand_over

   !> Makes of a record what C expects: texts that end with NUL, NaN where a sample is missing.
   subroutine dress(handle)
      type(record_handle), intent(inout) :: handle
      type(unit_type) :: unit
      integer(int64) :: i
      integer :: j

      associate (record => handle%record)
         if (.not. allocated(record%audit%line_of_first)) allocate (record%audit%line_of_first(3), source=0_int64)
         handle%rate_source = record%rate_source//c_null_char
         handle%format = record%format//c_null_char
         allocate (handle%name(size(record%channel)), handle%unit(size(record%channel)))
         do j = 1, size(record%channel)
            call unit_of(record, j, unit)
            handle%name(j)%text = record%channel(j)%text//c_null_char
            handle%unit(j)%text = unit%name//c_null_char
         end do
         call end_texts(record%warnings, handle%warning)
         if (.not. allocated(record%present)) return
         do j = 1, size(record%channel)
            do i = 1, size(record%value, 1, kind=int64)
               if (record%present(i, j) == 0_int8) record%value(i, j) = ieee_value(1.0_dp, ieee_quiet_nan)
            end do
         end do
      end associate
   end subroutine dress

   !> Copies of texts that end with NUL; none where there are none.
   subroutine end_texts(texts, ended)
      type(text_type), allocatable, intent(in) :: texts(:)
      type(text_type), allocatable, intent(out) :: ended(:)
      integer :: i, n

      n = 0
      if (allocated(texts)) n = size(texts)
      allocate (ended(n))
      do i = 1, n
         ended(i)%text = texts(i)%text//c_null_char
      end do
   end subroutine end_texts

   !> The unit of a channel; its name is "" where it is unknown.
   subroutine unit_of(record, channel, unit)
      type(record_type), intent(in) :: record
      integer, intent(in) :: channel
      type(unit_type), intent(out) :: unit

      unit = record%unit
      if (allocated(record%channel_unit)) unit = record%channel_unit(channel)
      if (.not. allocated(unit%name)) unit%name = ""
   end subroutine unit_of

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, callback, error, opt)
      type(reader_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(reader_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error)
      if (allocated(error)) return
      if (c_associated(opt%format)) call copy_c_text(opt%format, "", options%format)
      if (c_associated(opt%columns)) call copy_c_text(opt%columns, "", options%columns)
      if (c_associated(opt%time_column)) call copy_c_text(opt%time_column, "", options%time_column)
      if (c_associated(opt%input)) call copy_c_text(opt%input, "", options%input)
      if (c_associated(opt%unit)) call copy_c_text(opt%unit, "", options%unit)
      options%skip = opt%skip
      options%bad_lines_missing = opt%bad_lines_missing /= 0
      options%scale = opt%scale
      options%rate_hz = opt%rate_hz
      options%from = opt%from
      options%to = opt%to
      options%memory = opt%memory
      if (c_associated(opt%resample)) call copy_c_text(opt%resample, "", options%resample)
      if (c_associated(opt%wrap)) call copy_c_text(opt%wrap, "", options%wrap)
      options%channels = opt%channels
      options%decimal_comma = opt%decimal_comma /= 0
      callback = callback_type(opt%progress)
   end subroutine read_options

end module gyroakf_c_api_c_record
