! SPDX-License-Identifier: MIT
!> C interface, recordings. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_record
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_ptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_error, only : status
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_record, only : unit_of
   use gyroakf_units, only : unit_type
   use gyroakf_c_api_c_host, only : progress_c
   use gyroakf_c_api_c_recording, only : record_handle, new_handle, hand_over
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & copy_c_text, max_samples, open_options
   implicit none (type, external)
   private
   public :: gyroakf_reader_options_init, gyroakf_record_read, gyroakf_record_parse, &
      & gyroakf_record_samples, gyroakf_record_channels, gyroakf_record_values, &
      & gyroakf_record_present, gyroakf_record_name, gyroakf_record_unit, gyroakf_record_to_si, &
      & gyroakf_record_sample_interval, gyroakf_record_rate_source, gyroakf_record_format, &
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

contains

   subroutine gyroakf_reader_options_init(opt) bind(C)
      type(reader_options_c), intent(out), optional :: opt
      type(reader_options) :: defaults

      if (present(opt)) opt = reader_options_c(c_sizeof(opt), scale=defaults%scale, &
         & rate_hz=defaults%rate_hz, from=defaults%from, to=defaults%to, memory=defaults%memory)
   end subroutine gyroakf_reader_options_init

   integer(c_int) function gyroakf_record_read(path, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: path
      type(reader_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(record_handle), pointer :: handle
      type(reader_options) :: options
      character(:), allocatable :: name

      call enter_library(c)
      call new_handle(handle, c_associated(path), "the path must not be NULL", c, out)
      if (ok(c)) call read_options(options, c, opt)
      call copy_c_text(path, "", name)
      if (ok(c)) call read_record(name, options, handle%record, c%error, c%callback)
      call hand_over(handle, c, out)
      gyroakf_record_read = leave_library(c, err)
   end function gyroakf_record_read

   integer(c_int) function gyroakf_record_parse(bytes, n, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: bytes
      integer(c_int64_t), intent(in), value :: n
      type(reader_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(record_handle), pointer :: handle
      type(reader_options) :: options

      call enter_library(c)
      call new_handle(handle, c_associated(bytes) .and. n > 0 .and. n <= 8*max_samples, &
         & "the bytes must not be NULL, and there must be 1 .. 2**47 of them (n)", c, out)
      if (ok(c)) call read_options(options, c, opt)
      if (ok(c)) then
         call c_f_pointer(bytes, options%bytes, [n])
         call read_record("<memory>", options, handle%record, c%error, c%callback)
      end if
      call hand_over(handle, c, out)
      gyroakf_record_parse = leave_library(c, err)
   end function gyroakf_record_parse

   integer(c_int64_t) function gyroakf_record_samples(r) bind(C)
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      call open_handle(r, handle)
      gyroakf_record_samples = 0
      if (associated(handle)) gyroakf_record_samples = size(handle%record%value, 1, c_int64_t)
   end function gyroakf_record_samples

   integer(c_int32_t) function gyroakf_record_channels(r) bind(C)
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      call open_handle(r, handle)
      gyroakf_record_channels = 0
      if (associated(handle)) gyroakf_record_channels = size(handle%name)
   end function gyroakf_record_channels

   type(c_ptr) function gyroakf_record_values(r, channel) bind(C)
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel

      gyroakf_record_values = part_of(r, "values", channel)
   end function gyroakf_record_values

   type(c_ptr) function gyroakf_record_present(r, channel) bind(C)
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel

      gyroakf_record_present = part_of(r, "present", channel)
   end function gyroakf_record_present

   type(c_ptr) function gyroakf_record_name(r, channel) bind(C)
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel

      gyroakf_record_name = part_of(r, "name", channel)
   end function gyroakf_record_name

   type(c_ptr) function gyroakf_record_unit(r, channel) bind(C)
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel

      gyroakf_record_unit = part_of(r, "unit", channel)
   end function gyroakf_record_unit

   real(c_double) function gyroakf_record_to_si(r, channel) bind(C)
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: channel
      type(record_handle), pointer :: handle
      type(unit_type) :: unit

      gyroakf_record_to_si = 0
      if (channel < 0 .or. channel >= gyroakf_record_channels(r)) return
      call open_handle(r, handle)
      unit = unit_of(handle%record, channel + 1)
      if (len(handle%unit(channel + 1)%text) > 1) gyroakf_record_to_si = unit%to_si
   end function gyroakf_record_to_si

   real(c_double) function gyroakf_record_sample_interval(r) bind(C)
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      call open_handle(r, handle)
      gyroakf_record_sample_interval = 0
      if (associated(handle)) gyroakf_record_sample_interval = handle%record%sample_interval
   end function gyroakf_record_sample_interval

   type(c_ptr) function gyroakf_record_rate_source(r) bind(C)
      type(c_ptr), intent(in), value :: r

      gyroakf_record_rate_source = part_of(r, "rate_source")
   end function gyroakf_record_rate_source

   type(c_ptr) function gyroakf_record_format(r) bind(C)
      type(c_ptr), intent(in), value :: r

      gyroakf_record_format = part_of(r, "format")
   end function gyroakf_record_format

   integer(c_int32_t) function gyroakf_record_warnings(r) bind(C)
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      call open_handle(r, handle)
      gyroakf_record_warnings = 0
      if (associated(handle)) gyroakf_record_warnings = size(handle%warning)
   end function gyroakf_record_warnings

   type(c_ptr) function gyroakf_record_warning(r, i) bind(C)
      type(c_ptr), intent(in), value :: r
      integer(c_int32_t), intent(in), value :: i

      gyroakf_record_warning = part_of(r, "warning", i)
   end function gyroakf_record_warning

   integer(c_int) function gyroakf_record_audit(r, out) bind(C)
      type(c_ptr), intent(in), value :: r
      type(audit_c), intent(inout), optional :: out
      type(record_handle), pointer :: handle

      gyroakf_record_audit = status%invalid_argument
      call open_handle(r, handle)
      if (.not. (associated(handle) .and. present(out))) return
      if (out%struct_size /= c_sizeof(out)) return
      associate (audit => handle%record%audit)
         out = audit_c(out%struct_size, audit%samples, audit%missing, audit%bad_lines, &
            & merge(1_c_int32_t, 0_c_int32_t, audit%has_stamps), audit%stamp_rate, &
            & audit%jitter_max, audit%gaps, audit%jumps, audit%beats, audit%duplicates, &
            & audit%backward_steps, audit%line_of_first(1), audit%line_of_first(2), &
            & audit%line_of_first(3))
      end associate
      gyroakf_record_audit = status%ok
   end function gyroakf_record_audit

   subroutine gyroakf_record_free(r) bind(C)
      type(c_ptr), intent(in), value :: r
      type(record_handle), pointer :: handle

      call open_handle(r, handle)
      if (associated(handle)) deallocate (handle)
   end subroutine gyroakf_record_free

   !> What a pointer of the caller leads to; nothing where it is NULL.
   subroutine open_handle(r, handle)
      type(c_ptr), intent(in) :: r
      type(record_handle), pointer, intent(out) :: handle

      nullify (handle)
      if (c_associated(r)) call c_f_pointer(r, handle)
   end subroutine open_handle

   !> An array or a text of a recording; NULL where there is none.
   type(c_ptr) function part_of(r, name, number) result(part)
      type(c_ptr), intent(in) :: r
      character(*), intent(in) :: name
      !> Of the channel or the warning, from 0 on
      integer(c_int32_t), intent(in), optional :: number
      type(record_handle), pointer :: handle
      integer :: i

      part = c_null_ptr
      call open_handle(r, handle)
      if (.not. associated(handle)) return
      i = 1
      if (present(number)) i = merge(number + 1, 0, number >= 0 .and. number < &
         merge(size(handle%warning), size(handle%name), name == "warning"))
      if (i == 0) return
      select case (name)
      case ("values"); part = c_loc(handle%record%value(1, i))
      case ("name"); part = c_loc(handle%name(i)%text)
      case ("unit"); part = c_loc(handle%unit(i)%text)
      case ("warning"); part = c_loc(handle%warning(i)%text)
      case ("rate_source"); part = c_loc(handle%rate_source)
      case ("format"); part = c_loc(handle%format)
      case default
         if (allocated(handle%record%present)) part = c_loc(handle%record%present(1, i))
      end select
   end function part_of

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, c, opt)
      type(reader_options), intent(out) :: options
      type(call_type), intent(inout) :: c
      type(reader_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (allocated(c%error)) return
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
   end subroutine read_options

end module gyroakf_c_api_c_record
