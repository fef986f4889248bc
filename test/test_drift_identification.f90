! SPDX-License-Identifier: MIT
!> The drift of a record: what is found, what is not, and how well.
module test_drift_identification
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_filter_drift_identification, only : drift_identification_options, drift_identification_type, identify_drift_model
   use filter_library, only : fill_noise, make_series
   implicit none (type, external)
   private
   public :: collect_drift_identification

contains

   subroutine collect_drift_identification(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("ar1", test_ar1), &
         new_unittest("white", test_white)]
   end subroutine collect_drift_identification

   !> Case C1 of the comparison.
   subroutine test_ar1(error)
      type(error_type), allocatable, intent(out) :: error
      type(drift_identification_type) :: found
      type(gyro_error), allocatable :: failed
      real(dp) :: z(12000)

      call make_series(31, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z)
      call identify_drift_model(z, drift_identification_options(), found, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, found%found .and. found%slow(1) .and. found%name == "ar1" .and. found%errors_known)
      if (allocated(error)) return
      call check(error, abs(found%model%phi(1) - 0.98_dp) <= 4*found%std_error%phi(1))
      if (allocated(error)) return
      call check(error, found%white_std**2, 4.2e-4_dp, thr=4*found%std_error%r)
      if (allocated(error)) return
      call check(error, found%drift_std**2, found%model%q(1)/(1 - found%model%phi(1)**2), thr=1.0e-12_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, found%samples == 12000_int64 .and. found%of_samples == 12000_int64)
   end subroutine test_ar1

   subroutine test_white(error)
      type(error_type), allocatable, intent(out) :: error
      type(drift_identification_type) :: found
      type(gyro_error), allocatable :: failed
      real(dp) :: z(3000)

      call fill_noise(5, z)
      call identify_drift_model(z, drift_identification_options(), found, failed)
      call check(error, .not. allocated(failed) .and. .not. found%found)
      if (allocated(error)) return
      call identify_drift_model(z(:40), drift_identification_options(), found, failed)
      call check(error, failed%code, status%too_few_samples)
   end subroutine test_white

end module test_drift_identification
