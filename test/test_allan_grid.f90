! SPDX-License-Identifier: MIT
!> Tests of the averaging factors.
module test_allan_grid
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_allan_grid, only : averaging_factors
   use expectations, only : check
   use testdrive, only : error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_grid

contains

   subroutine collect_allan_grid(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("octave", test_octave), &
         & new_unittest("decade", test_decade), &
         & new_unittest("logarithmic", test_logarithmic), &
         & new_unittest("all", test_all), &
         & new_unittest("seconds", test_seconds), &
         & new_unittest("huge_record", test_huge_record), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_allan_grid

   !> Fails unless the factors are the expected ones.
   subroutine expect(error, taus, samples, interval, expected)
      type(error_type), allocatable, intent(inout) :: error
      !> What is asked
      character(*), intent(in) :: taus
      integer, intent(in) :: samples
      real(dp), intent(in) :: interval
      !> The answer
      integer, intent(in) :: expected(:)

      type(gyro_error), allocatable :: failure
      integer(int64), allocatable :: m(:)

      call averaging_factors(taus, int(samples, int64), interval, m, failure)
      call check(error, .not. allocated(failure), taus//" failed")
      if (allocated(error)) return
      call check(error, size(m), size(expected), taus//": number of factors")
      if (allocated(error)) return
      call check(error, all(m == expected), taus//": a factor differs")
   end subroutine expect

   subroutine test_octave(error)
      type(error_type), allocatable, intent(out) :: error

      call expect(error, "octave", 2, 1.0_dp, [1])
      call expect(error, "octave", 15, 1.0_dp, [1, 2, 4])
      call expect(error, "octave", 16, 1.0_dp, [1, 2, 4, 8])
   end subroutine test_octave

   subroutine test_decade(error)
      type(error_type), allocatable, intent(out) :: error

      call expect(error, "decade", 199, 1.0_dp, [1, 2, 5, 10, 20, 50])
      call expect(error, "decade", 200, 1.0_dp, [1, 2, 5, 10, 20, 50, 100])
   end subroutine test_decade

   subroutine test_logarithmic(error)
      type(error_type), allocatable, intent(out) :: error

      call expect(error, "log:1", 2000, 1.0_dp, [1, 10, 100, 1000])
      call expect(error, "log:5", 100, 1.0_dp, [1, 2, 3, 4, 6, 10, 16, 25, 40])
   end subroutine test_logarithmic

   subroutine test_all(error)
      type(error_type), allocatable, intent(out) :: error

      call expect(error, "all", 9, 1.0_dp, [1, 2, 3, 4])
   end subroutine test_all

   subroutine test_seconds(error)
      type(error_type), allocatable, intent(out) :: error

      call expect(error, "1,0.1, 10,1,0.14,1e3", 1000, 0.1_dp, [1, 10, 100])
      call expect(error, "0.2", 4, 0.1_dp, [2])
   end subroutine test_seconds

   subroutine test_huge_record(error)
      type(error_type), allocatable, intent(out) :: error

      type(gyro_error), allocatable :: failure
      integer(int64), allocatable :: m(:)

      call averaging_factors("octave", huge(0_int64), 1.0_dp, m, failure)
      call check(error, size(m), 62)
      if (allocated(error)) return
      call averaging_factors("decade", huge(0_int64), 1.0_dp, m, failure)
      call check(error, m(size(m)) == 2_int64*10_int64**18)
      if (allocated(error)) return
      call averaging_factors("log:10", huge(0_int64), 1.0_dp, m, failure)
      call check(error, all(m(2:) > m(:size(m) - 1)))
   end subroutine test_huge_record

   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error

      character(*), parameter :: bad(*) = [character(8) :: "octaves", "log:", "log:0", "log:-3", "log:1001", "1,,2", "1;2", &
         & "", "1,nan", "0.01", "-1", "1e999", "1-2", "1e", ".", "+", "2e+-3"]
      type(gyro_error), allocatable :: failure
      integer(int64), allocatable :: m(:)
      integer :: i

      do i = 1, size(bad)
         call averaging_factors(trim(bad(i)), 100_int64, 0.1_dp, m, failure)
         call check(error, allocated(failure), bad(i)//" was accepted")
         if (allocated(error)) return
         call check(error, failure%code, status%invalid_argument, bad(i))
      end do
      call averaging_factors("octave", 1_int64, 0.1_dp, m, failure)
      call check(error, failure%code, status%too_few_samples)
      call averaging_factors("100,200", 100_int64, 0.1_dp, m, failure)
      call check(error, failure%code, status%too_few_samples)
   end subroutine test_failures

end module test_allan_grid
