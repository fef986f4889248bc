! SPDX-License-Identifier: MIT
!> HDF5 in a build without the HDF5 library: it is refused with what to do.
!>
!> `hdf5/` holds the module of the same name that a build with the library takes instead of this one.
module gyroakf_io_hdf5
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_element, only : element_type
   implicit none (type, external)
   private
   public :: hdf5_built, hdf5_type, open_hdf5, read_hdf5, close_hdf5

   !> Whether this build reads HDF5
   logical, parameter :: hdf5_built = .false.

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

contains

   !> Opens a dataset.
   subroutine open_hdf5(path, dataset, hdf5, error)
      !> Of the file
      character(*), intent(in) :: path
      !> Path in the file; "": the only one of numbers
      character(*), intent(in) :: dataset
      !> To be closed by [[close_hdf5]], after a failure too
      type(hdf5_type), intent(out) :: hdf5
      !> Always not_supported
      type(error_type), allocatable, intent(out) :: error

      hdf5%path = dataset
      call fatal_error(error, status%not_supported, path//": this build reads no HDF5"//new_line("a")// &
                       "build it with the library (GYROAKF_HDF5=1 ci/hdf5.sh), or turn the dataset into .npy: "// &
                       "numpy.save('x.npy', h5py.File('"//path//"')['DATASET'][:])")
   end subroutine open_hdf5

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
      real(dp), intent(inout), contiguous :: value(:)
      !> Always not_supported
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%not_supported, "this build reads no HDF5")
      if (hdf5%file + first + count + from + to + side < 0) value = 0.0_dp
   end subroutine read_hdf5

   !> Closes the file; harmless where it is closed.
   subroutine close_hdf5(hdf5)
      !> Closed afterwards
      type(hdf5_type), intent(inout) :: hdf5

      hdf5%file = -1
   end subroutine close_hdf5

end module gyroakf_io_hdf5
