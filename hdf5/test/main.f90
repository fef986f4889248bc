! SPDX-License-Identifier: MIT
!> Tests of the build with the HDF5 library; `ci/hdf5.sh` runs them.
program test_hdf5_main
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use testdrive, only : run_testsuite, unittest_type
   use test_hdf5, only : collect_hdf5
   implicit none (type, external)
   integer :: failures

   call run(failures)
   if (failures > 0) error stop 1

contains

   !> Runs them and prints the line that `.ci/run` adds up.
   subroutine run(failures)
      integer, intent(out) :: failures
      type(unittest_type), allocatable :: tests(:)

      failures = 0
      call run_testsuite(collect_hdf5, error_unit, failures, parallel=.false.)
      call collect_hdf5(tests)
      write (output_unit, "(i0, a, i0, a)") size(tests) - failures, " passed, ", failures, " failed"
   end subroutine run

end program test_hdf5_main
