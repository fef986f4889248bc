! SPDX-License-Identifier: MIT
!> HDF5: files that the library itself writes here, against exact values.
module test_hdf5
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use hdf5, only : h5aclose_f, h5acreate_f, h5awrite_f, h5dclose_f, h5dcreate_f, h5dwrite_f, h5f_acc_trunc_f, h5fclose_f, &
      h5fcreate_f, h5gclose_f, h5gcreate_f, h5open_f, h5p_dataset_create_f, h5pclose_f, h5pcreate_f, h5pset_chunk_f, &
      h5pset_deflate_f, h5s_scalar_f, h5sclose_f, h5screate_f, h5screate_simple_f, h5t_fortran_s1, h5t_ieee_f32be, &
         h5t_ieee_f32le, &
      h5t_ieee_f64le, h5t_native_double, h5t_std_i16be, h5t_std_i32le, h5t_std_u8le, h5tclose_f, h5tcopy_f, h5tset_size_f, &
         hid_t, &
      hsize_t, size_t
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_io_recording, only : close_recording, next_rows, open_recording, recording_type
   use gyroakf_record, only : record_type
   use scratch_file, only : read_bytes, remove_file, scratch_path, write_bytes
   implicit none (type, external)
   private
   public :: collect_hdf5

   !> Rows: more than are read at once
   integer, parameter :: rows = 400001

contains

   !> Names the tests.
   subroutine collect_hdf5(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("types", test_types), &
         new_unittest("rows", test_rows), &
         new_unittest("turned", test_turned), &
         new_unittest("choice", test_choice), &
         new_unittest("attributes", test_attributes), &
         new_unittest("missing", test_missing), &
         new_unittest("parts", test_parts), &
         new_unittest("broken", test_broken)]
   end subroutine collect_hdf5

   !> A whole number that every type holds.
   elemental real(dp) function made_up(i, j)
      integer, intent(in) :: i, j

      made_up = real(modulo(i*(2*j + 1), 251), dp)
   end function made_up

   !> Opens a new file.
   subroutine create(file)
      integer(hid_t), intent(out) :: file
      integer :: failed

      call h5open_f(failed)
      call h5fcreate_f(scratch_path("x.h5"), h5f_acc_trunc_f, file, failed)
   end subroutine create

   !> Adds a dataset; `value` is in the order of Fortran.
   subroutine add_dataset(file, name, kind, value, packed)
      integer(hid_t), intent(in) :: file, kind
      character(*), intent(in) :: name
      real(dp), intent(in) :: value(:, :)
      !> In compressed parts
      logical, intent(in) :: packed
      integer(hid_t) :: space, dataset, list
      integer(hsize_t) :: dims(2)
      integer :: failed, rank

      rank = merge(1, 2, size(value, 1) == 1)
      dims = shape(value)
      if (rank == 1) dims(1) = dims(2)
      call h5screate_simple_f(rank, dims(:rank), space, failed)
      call h5pcreate_f(h5p_dataset_create_f, list, failed)
      if (packed) then
         call h5pset_chunk_f(list, rank, min(dims(:rank), 1000_hsize_t), failed)
         call h5pset_deflate_f(list, 1, failed)
      end if
      call h5dcreate_f(file, name, kind, space, dataset, failed, list)
      call h5dwrite_f(dataset, h5t_native_double, value, dims, failed)
      call h5dclose_f(dataset, failed)
      call h5pclose_f(list, failed)
      call h5sclose_f(space, failed)
   end subroutine add_dataset

   !> Rate and unit of the file.
   subroutine add_attributes(file)
      integer(hid_t), intent(in) :: file
      integer(hid_t) :: space, attribute, text
      integer(hsize_t) :: one(1)
      integer :: failed

      one = 1
      call h5screate_f(h5s_scalar_f, space, failed)
      call h5acreate_f(file, "rate_hz", h5t_std_i32le, space, attribute, failed)
      call h5awrite_f(attribute, h5t_native_double, 250.0_dp, one, failed)
      call h5aclose_f(attribute, failed)
      call h5tcopy_f(h5t_fortran_s1, text, failed)
      call h5tset_size_f(text, 8_size_t, failed)
      call h5acreate_f(file, "unit", text, space, attribute, failed)
      call h5awrite_f(attribute, text, "deg/h   ", one, failed)
      call h5aclose_f(attribute, failed)
      call h5tclose_f(text, failed)
      call h5sclose_f(space, failed)
   end subroutine add_attributes

   !> Closes the file and reads it.
   subroutine read_back(file, options, record, failed)
      integer(hid_t), intent(in) :: file
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(gyro_error), allocatable, intent(out) :: failed
      integer :: ignored

      call h5fclose_f(file, ignored)
      call read_record(scratch_path("x.h5"), options, record, failed)
      call remove_file(scratch_path("x.h5"))
   end subroutine read_back

   !> Every kind of number; the only dataset is found, in a group too.
   subroutine test_types(error)
      type(error_type), allocatable, intent(out) :: error
      character(18), parameter :: name(6) = [character(18) :: "float64", "float32", "float32 big endian", "int16 big endian", &
                                            "int32", "uint8"]
      integer(hid_t) :: file, group, kind(6)
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      real(dp) :: value(1, 100)
      integer :: i, k, ignored

      value(1, :) = [(made_up(i, 1), i=1, 100)]
      call create(file)
      kind = [h5t_ieee_f64le, h5t_ieee_f32le, h5t_ieee_f32be, h5t_std_i16be, h5t_std_i32le, h5t_std_u8le]
      do k = 1, 6
         if (k > 1) call create(file)
         call h5gcreate_f(file, "imu", group, ignored)
         call h5gclose_f(group, ignored)
         call add_dataset(file, "/imu/gyro", kind(k), value, .false.)
         call read_back(file, reader_options(), record, failed)
         call check(error, .not. allocated(failed), name(k))
         if (allocated(error)) return
         call check(error, record%format//", "//record%stored_type, "hdf5, "//trim(name(k)))
         if (allocated(error)) return
         call check(error, all(abs(record%value(:, 1) - value(1, :)) <= 0.0_dp), name(k))
         if (allocated(error)) return
      end do
   end subroutine test_types

   !> Samples in rows, in one piece and in compressed parts; columns by number, the time among them.
   subroutine test_rows(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: value(:, :)
      type(reader_options) :: options
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      integer(hid_t) :: file
      integer :: i, j, k

      allocate (value(4, rows))
      do i = 1, rows
         value(:, i) = [real(i, dp), (made_up(i, j), j=1, 3)]
      end do
      options%columns = "4,2"
      options%time_column = "1"
      do k = 0, 1
         call create(file)
         call add_dataset(file, "gyro", h5t_ieee_f64le, value, k == 1)
         call read_back(file, options, record, failed)
         call check(error, .not. allocated(failed))
         if (allocated(error)) return
         call check(error, size(record%value, 1), rows)
         if (allocated(error)) return
         call check(error, all(abs(record%value(:, 1) - value(4, :)) <= 0.0_dp) .and. &
                    all(abs(record%value(:, 2) - value(2, :)) <= 0.0_dp))
         if (allocated(error)) return
         call check(error, record%rate_source, "timestamps")
         if (allocated(error)) return
      end do
   end subroutine test_rows

   !> Channels in rows: the longer side is the time.
   subroutine test_turned(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: value(:, :)
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      integer(hid_t) :: file
      integer :: i, j

      allocate (value(rows, 2))
      do j = 1, 2
         value(:, j) = [(made_up(i, j), i=1, rows)]
      end do
      call create(file)
      call add_dataset(file, "gyro", h5t_ieee_f32le, value, .true.)
      call read_back(file, reader_options(), record, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, all(abs(record%value - value) <= 0.0_dp))
      if (allocated(error)) return
      call check(error, index(record%warnings(1)%text, "the longer side") > 0)
   end subroutine test_turned

   !> Of several datasets one has to be chosen.
   subroutine test_choice(error)
      type(error_type), allocatable, intent(out) :: error
      type(reader_options) :: options
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      real(dp) :: value(1, 9)
      integer(hid_t) :: file
      integer :: k

      do k = 1, 3
         value = real(k, dp)
         call create(file)
         call add_dataset(file, "a", h5t_std_u8le, value, .false.)
         call add_dataset(file, "b", h5t_std_u8le, value + 1, .false.)
         if (k == 2) options%dataset = "/b"
         if (k == 3) options%dataset = "/c"
         call read_back(file, options, record, failed)
         if (k == 2) then
            call check(error, .not. allocated(failed))
            if (allocated(error)) return
            call check(error, all(nint(record%value) == 3))
         else
            call check(error, allocated(failed))
            if (allocated(error)) return
            call check(error, index(failed%message, "the file has /a (9), /b (9)") > 0, failed%message)
         end if
         if (allocated(error)) return
      end do
   end subroutine test_choice

   !> Rate and unit.
   subroutine test_attributes(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      real(dp) :: value(1, 9)
      integer(hid_t) :: file

      value = 1.0_dp
      call create(file)
      call add_dataset(file, "gyro", h5t_ieee_f64le, value, .false.)
      call add_attributes(file)
      call read_back(file, reader_options(), record, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, record%rate_source//", "//record%unit%name, "header, deg/h")
      if (allocated(error)) return
      call check(error, record%sample_interval, 0.004_dp)
   end subroutine test_attributes

   !> NaN is missing; an empty dataset is refused.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      real(dp) :: value(1, 9), none(3, 0)
      integer(hid_t) :: file

      value = 1.0_dp
      value(1, 4) = ieee_value(1.0_dp, ieee_quiet_nan)
      value(1, 5) = huge(1.0_dp)
      call create(file)
      call add_dataset(file, "gyro", h5t_ieee_f32le, value, .false.)
      call read_back(file, reader_options(), record, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, record%audit%missing, 2_int64)
      if (allocated(error)) return
      call create(file)
      call add_dataset(file, "gyro", h5t_ieee_f32le, none, .false.)
      call read_back(file, reader_options(), record, failed)
      call check(error, allocated(failed))
      if (allocated(error)) return
      call check(error, failed%code, status%too_few_samples)
   end subroutine test_missing

   !> Rows as far as they are wanted.
   subroutine test_parts(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: value(:, :)
      type(recording_type) :: recording
      type(gyro_error), allocatable :: failed
      integer(hid_t) :: file
      integer :: i, ignored

      allocate (value(1, rows))
      value(1, :) = [(made_up(i, 1), i=1, rows)]
      call create(file)
      call add_dataset(file, "gyro", h5t_std_u8le, value, .false.)
      call h5fclose_f(file, ignored)
      call open_recording(scratch_path("x.h5"), reader_options(), recording, failed)
      call check(error, .not. allocated(failed) .and. recording%expected_rows == rows)
      if (allocated(error)) return
      call next_rows(recording, 1_int64, failed)
      call check(error, recording%table%rows > 0 .and. recording%table%rows < rows .and. .not. recording%table%whole)
      if (allocated(error)) return
      call next_rows(recording, huge(1_int64), failed)
      call check(error, recording%table%rows == rows .and. recording%table%whole)
      call close_recording(recording)
      call remove_file(scratch_path("x.h5"))
   end subroutine test_parts

   !> Cut off anywhere, a file is refused.
   subroutine test_broken(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: content
      real(dp) :: value(1, 100)
      integer(hid_t) :: file
      integer :: k, ignored

      value = 1.0_dp
      call create(file)
      call add_dataset(file, "gyro", h5t_ieee_f64le, value, .false.)
      call h5fclose_f(file, ignored)
      content = read_bytes(scratch_path("x.h5"))
      do k = 1, 19
         call write_bytes(scratch_path("x.h5"), content(:len(content)*k/20))
         call read_record(scratch_path("x.h5"), reader_options(), record, failed)
         call check(error, allocated(failed), "not refused")
         if (allocated(error)) return
      end do
      call remove_file(scratch_path("x.h5"))
   end subroutine test_broken

end module test_hdf5
