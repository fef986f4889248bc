! SPDX-License-Identifier: MIT
!> HDF5 by the HDF5 library: a dataset of one or two dimensions, read in parts as double precision.
!>
!> A build with the library takes this module instead of the one in `src/gyroakf/io/`. The library is not thread-safe as a
!> rule: one thread at a time is in it.
module gyroakf_io_hdf5
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_f_pointer, c_loc, c_null_char, c_ptr
   use hdf5, only : h5aclose_f, h5aexists_f, h5aget_space_f, h5aget_type_f, h5aopen_f, h5aread_f, h5dclose_f, h5dget_space_f, &
      h5dget_type_f, h5dopen_f, h5dread_f, h5dvlen_reclaim_f, h5eset_auto_f, h5f_acc_rdonly_f, h5fclose_f, h5fopen_f, &
         h5g_dataset_f, &
      h5g_group_f, h5gget_obj_info_idx_f, h5gn_members_f, h5open_f, h5p_default_f, h5s_select_set_f, h5sclose_f, &
      h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5t_float_f, &
      h5t_integer_f, h5t_native_double, h5t_order_be_f, h5t_sgn_none_f, h5t_string_f, h5tclose_f, h5tget_class_f, &
         h5tget_order_f, &
      h5tget_sign_f, h5tget_size_f, h5tis_variable_str_f, hid_t, hsize_t, size_t
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_element, only : element_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : add_text, text_type
   implicit none (type, external)
   private
   public :: hdf5_built, hdf5_type, open_hdf5, read_hdf5, close_hdf5

   !> Whether this build reads HDF5
   logical, parameter :: hdf5_built = .true.

   !> An open dataset
   type :: hdf5_type
      !> The library's handles, -1 where it is closed
      integer(int64) :: file = -1, dataset = -1
      !> How the numbers are stored
      type(element_type) :: element
      !> 1 or 2, and the lengths in the order of C
      integer :: rank = 0
      integer(int64) :: shape(2) = 1
      !> Of its attributes `rate_hz` and `unit`; 0 and unallocated where it has none
      real(dp) :: rate_hz = 0.0_dp
      character(:), allocatable :: unit
      !> Its path in the file
      character(:), allocatable :: path
   end type hdf5_type

   !> Groups within groups, and datasets, that are looked at
   integer, parameter :: most_depth = 16, most_datasets = 1000

contains

   !> Opens a dataset.
   subroutine open_hdf5(path, dataset, hdf5, error)
      !> Of the file
      character(*), intent(in) :: path
      !> Path in the file; "": the only one of numbers
      character(*), intent(in) :: dataset
      !> To be closed by [[close_hdf5]], after a failure too
      type(hdf5_type), intent(out) :: hdf5
      !> Allocated: io, parse, invalid_argument, not_supported
      type(error_type), allocatable, intent(out) :: error

      !$omp critical (gyroakf_hdf5)
      call open_file(path, dataset, hdf5, error)
      !$omp end critical (gyroakf_hdf5)
   end subroutine open_hdf5

   !> The same by one thread.
   subroutine open_file(path, dataset, hdf5, error)
      character(*), intent(in) :: path, dataset
      type(hdf5_type), intent(inout) :: hdf5
      type(error_type), allocatable, intent(out) :: error
      integer(hid_t) :: file, opened
      integer :: failed
      logical :: suits
      character(:), allocatable :: list

      call h5open_f(failed)
      call h5eset_auto_f(0, failed)
      call h5fopen_f(path, h5f_acc_rdonly_f, file, failed)
      if (failed /= 0) then
         call fatal_error(error, status%parse, path//": the HDF5 library cannot open it: cut off, broken, or being written"// &
                          new_line("a")//"h5ls and h5clear look into such files")
         return
      end if
      hdf5%file = file
      hdf5%path = dataset
      if (len(dataset) == 0) call find_only(path, hdf5, error)
      if (allocated(error)) return
      call h5dopen_f(file, hdf5%path, opened, failed)
      if (failed /= 0) then
         call list_datasets(hdf5, list)
         call fatal_error(error, status%invalid_argument, path//": there is no dataset '"//hdf5%path//"'; "//list)
         return
      end if
      hdf5%dataset = opened
      call describe(opened, hdf5%element, hdf5%rank, hdf5%shape, suits)
      if (.not. suits) then
         call list_datasets(hdf5, list)
         call fatal_error(error, status%not_supported, path//": the dataset '"//hdf5%path// &
                          "' holds no numbers in one or two dimensions; "//list)
         return
      end if
      call read_attributes(opened, hdf5)
      call read_attributes(file, hdf5)
   end subroutine open_file

   !> The only dataset of numbers.
   subroutine find_only(path, hdf5, error)
      character(*), intent(in) :: path
      type(hdf5_type), intent(inout) :: hdf5
      type(error_type), allocatable, intent(out) :: error
      type(text_type), allocatable :: found(:)
      character(:), allocatable :: list

      allocate (found(0))
      call list_group(int(hdf5%file, hid_t), "", 1, found)
      if (size(found) == 1) then
         hdf5%path = found(1)%text
      else if (size(found) == 0) then
         call fatal_error(error, status%parse, path//": it holds no dataset of numbers in one or two dimensions")
      else
         call list_datasets(hdf5, list)
         call fatal_error(error, status%invalid_argument, path//": it holds "//integer_text(size(found, kind=int64))// &
                          " datasets of numbers"//new_line("a")//"choose one with --dataset; "//list)
      end if
   end subroutine find_only

   !> "the file has /gyro (1000, 3), /accel (1000, 3)".
   subroutine list_datasets(hdf5, text)
      type(hdf5_type), intent(in) :: hdf5
      character(:), allocatable, intent(out) :: text
      type(text_type), allocatable :: found(:)
      type(element_type) :: element
      integer(int64) :: shape(2)
      integer(hid_t) :: dataset
      integer :: i, rank, failed
      logical :: suits

      allocate (found(0))
      call list_group(int(hdf5%file, hid_t), "", 1, found)
      text = "the file has"
      if (size(found) == 0) text = text//" none"
      do i = 1, min(size(found), 20)
         call h5dopen_f(int(hdf5%file, hid_t), found(i)%text, dataset, failed)
         if (failed /= 0) cycle
         call describe(dataset, element, rank, shape, suits)
         call h5dclose_f(dataset, failed)
         text = text//trim(merge(", ", "  ", i > 1))//" "//found(i)%text//" ("//integer_text(shape(1))
         if (rank == 2) text = text//", "//integer_text(shape(2))
         text = text//")"
      end do
      if (size(found) > 20) text = text//", ..."
   end subroutine list_datasets

   !> Datasets of numbers below a group.
   recursive subroutine list_group(file, group, depth, found)
      integer(hid_t), intent(in) :: file
      character(*), intent(in) :: group
      integer, intent(in) :: depth
      type(text_type), allocatable, intent(inout) :: found(:)
      type(element_type) :: element
      character(1024) :: name
      character(:), allocatable :: path
      integer(int64) :: shape(2)
      integer(hid_t) :: dataset
      integer :: i, members, kind, failed, rank
      logical :: suits

      call h5gn_members_f(file, group//"/", members, failed)
      if (failed /= 0) return
      do i = 0, members - 1
         if (size(found) >= most_datasets) return
         name = ""
         call h5gget_obj_info_idx_f(file, group//"/", i, name, kind, failed)
         if (failed /= 0) cycle
         path = group//"/"//trim(name)
         if (kind == h5g_group_f .and. depth < most_depth) call list_group(file, path, depth + 1, found)
         if (kind /= h5g_dataset_f) cycle
         call h5dopen_f(file, path, dataset, failed)
         if (failed /= 0) cycle
         call describe(dataset, element, rank, shape, suits)
         call h5dclose_f(dataset, failed)
         if (suits) call add_text(found, path)
      end do
   end subroutine list_group

   !> Type and shape of a dataset, and whether it holds numbers in one or two dimensions.
   subroutine describe(dataset, element, rank, shape, suits)
      integer(hid_t), intent(in) :: dataset
      type(element_type), intent(out) :: element
      integer, intent(out) :: rank
      integer(int64), intent(out) :: shape(2)
      logical, intent(out) :: suits
      integer(hid_t) :: kind, space
      integer(hsize_t) :: dims(32), most(32)
      integer(size_t) :: bytes
      integer :: class, order, sign, failed

      shape = 1
      rank = 0
      call h5dget_type_f(dataset, kind, failed)
      call h5tget_class_f(kind, class, failed)
      suits = failed == 0 .and. (class == h5t_integer_f .or. class == h5t_float_f)
      if (suits) then
         call h5tget_size_f(kind, bytes, failed)
         call h5tget_order_f(kind, order, failed)
         element%bytes = int(bytes)
         element%big_endian = order == h5t_order_be_f
         element%kind = "f"
         if (class == h5t_integer_f) then
            call h5tget_sign_f(kind, sign, failed)
            element%kind = merge("u", "i", sign == h5t_sgn_none_f)
         end if
      end if
      call h5tclose_f(kind, failed)
      call h5dget_space_f(dataset, space, failed)
      call h5sget_simple_extent_ndims_f(space, rank, failed)
      suits = suits .and. failed == 0 .and. (rank == 1 .or. rank == 2)
      if (suits) then
         call h5sget_simple_extent_dims_f(space, dims, most, failed)
         shape(1) = dims(rank)
         if (rank == 2) shape(2) = dims(1)
      end if
      call h5sclose_f(space, failed)
   end subroutine describe

   !> Rate and unit, where the object has them and nothing was found before.
   subroutine read_attributes(object, hdf5)
      integer(hid_t), intent(in) :: object
      type(hdf5_type), intent(inout) :: hdf5
      integer(hid_t) :: attribute, kind
      integer(hsize_t) :: one(1)
      integer :: failed, class
      logical :: there
      real(dp), target :: rate(1)

      call h5aexists_f(object, "rate_hz", there, failed)
      if (failed == 0 .and. there .and. hdf5%rate_hz <= 0.0_dp .and. holds_one(object, "rate_hz")) then
         call h5aopen_f(object, "rate_hz", attribute, failed)
         call h5aget_type_f(attribute, kind, failed)
         call h5tget_class_f(kind, class, failed)
         one = 1
         rate = 0.0_dp
         if (class == h5t_float_f .or. class == h5t_integer_f) call h5aread_f(attribute, h5t_native_double, rate, one, failed)
         if (failed == 0 .and. ieee_is_finite(rate(1))) hdf5%rate_hz = max(rate(1), 0.0_dp)
         call h5tclose_f(kind, failed)
         call h5aclose_f(attribute, failed)
      end if
      call h5aexists_f(object, "unit", there, failed)
      if (failed /= 0 .or. .not. there .or. allocated(hdf5%unit)) return
      if (.not. holds_one(object, "unit")) return
      call h5aopen_f(object, "unit", attribute, failed)
      call h5aget_type_f(attribute, kind, failed)
      call h5tget_class_f(kind, class, failed)
      if (class == h5t_string_f) call read_text(attribute, kind, hdf5%unit)
      call h5tclose_f(kind, failed)
      call h5aclose_f(attribute, failed)
   end subroutine read_attributes

   !> True for an attribute of a single value.
   logical function holds_one(object, name)
      integer(hid_t), intent(in) :: object
      character(*), intent(in) :: name
      integer(hid_t) :: attribute, space
      integer(hsize_t) :: dims(32), most(32)
      integer :: failed, rank

      call h5aopen_f(object, name, attribute, failed)
      call h5aget_space_f(attribute, space, failed)
      call h5sget_simple_extent_ndims_f(space, rank, failed)
      holds_one = failed == 0 .and. rank <= 1
      if (holds_one .and. rank == 1) then
         call h5sget_simple_extent_dims_f(space, dims, most, failed)
         holds_one = dims(1) == 1
      end if
      call h5sclose_f(space, failed)
      call h5aclose_f(attribute, failed)
   end function holds_one

   !> A text of fixed or variable length.
   subroutine read_text(attribute, kind, text)
      integer(hid_t), intent(in) :: attribute, kind
      character(:), allocatable, intent(inout) :: text
      integer(hid_t) :: space
      integer(size_t) :: bytes
      integer :: failed, i
      logical :: variable
      type(c_ptr), target :: address(1)
      type(c_ptr) :: place
      character(kind=c_char), target :: room(256)
      character(kind=c_char), pointer :: letters(:)

      room = c_null_char
      call h5tis_variable_str_f(kind, variable, failed)
      if (variable) then
         place = c_loc(address)
         call h5aread_f(attribute, kind, place, failed)
         if (failed /= 0 .or. .not. c_associated(address(1))) return
         call c_f_pointer(address(1), letters, [size(room)])
         do i = 1, size(room) - 1
            if (letters(i) == c_null_char) exit
            room(i) = letters(i)
         end do
         call h5aget_space_f(attribute, space, failed)
         call h5dvlen_reclaim_f(kind, space, h5p_default_f, place, failed)
         call h5sclose_f(space, failed)
      else
         call h5tget_size_f(kind, bytes, failed)
         if (failed /= 0 .or. bytes >= size(room, kind=size_t)) return
         place = c_loc(room)
         call h5aread_f(attribute, kind, place, failed)
         if (failed /= 0) return
      end if
      text = ""
      do i = 1, size(room)
         if (room(i) == c_null_char) exit
         text = text//room(i)
      end do
      text = trim(adjustl(text))
   end subroutine read_text

   !> Reads a part: entries first to first + count - 1 of one side, and from:to of the other; the last side in the order of C
   !> runs fastest.
   subroutine read_hdf5(hdf5, side, first, count, from, to, value, error)
      !> Open
      type(hdf5_type), intent(in) :: hdf5
      !> The side that the entries are counted along, 1 or 2
      integer, intent(in) :: side
      !> From 1
      integer(int64), intent(in) :: first, count, from, to
      !> [count*(to - from + 1)] filled
      real(dp), intent(inout), contiguous, target :: value(:)
      !> Allocated: io
      type(error_type), allocatable, intent(out) :: error
      integer(hid_t) :: space, memory
      integer(hsize_t) :: start(2), extent(2)
      integer :: failed, also
      type(c_ptr) :: place

      place = c_loc(value)
      start(1) = merge(from, first, side == 1 .and. hdf5%rank == 2) - 1
      start(2) = merge(first, from, side == 1) - 1
      extent(1) = merge(to - from + 1, count, side == 1 .and. hdf5%rank == 2)
      extent(2) = merge(count, to - from + 1, side == 1)
      !$omp critical (gyroakf_hdf5)
      call h5dget_space_f(int(hdf5%dataset, hid_t), space, failed)
      if (failed == 0) call h5sselect_hyperslab_f(space, h5s_select_set_f, start(:hdf5%rank), extent(:hdf5%rank), failed)
      if (failed == 0) call h5screate_simple_f(hdf5%rank, extent(:hdf5%rank), memory, failed)
      if (failed == 0) then
         call h5dread_f(int(hdf5%dataset, hid_t), h5t_native_double, place, failed, memory, space)
         call h5sclose_f(memory, also)
      end if
      call h5sclose_f(space, also)
      !$omp end critical (gyroakf_hdf5)
      if (failed /= 0) call fatal_error(error, status%io, "the HDF5 library cannot read entries "//integer_text(first)// &
         " to "// &
         integer_text(first + count - 1)//" of "//hdf5%path//new_line("a")// &
            "the file may be broken, or a filter of it missing "// &
         "(h5dump -p -H FILE names them)")
   end subroutine read_hdf5

   !> Closes the file; harmless where it is closed.
   subroutine close_hdf5(hdf5)
      !> Closed afterwards
      type(hdf5_type), intent(inout) :: hdf5
      integer :: failed

      !$omp critical (gyroakf_hdf5)
      if (hdf5%dataset >= 0) call h5dclose_f(int(hdf5%dataset, hid_t), failed)
      if (hdf5%file >= 0) call h5fclose_f(int(hdf5%file, hid_t), failed)
      !$omp end critical (gyroakf_hdf5)
      hdf5%dataset = -1
      hdf5%file = -1
   end subroutine close_hdf5

end module gyroakf_io_hdf5
