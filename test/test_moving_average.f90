! SPDX-License-Identifier: MIT
!> The moving average against the sums written out.
module test_moving_average
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check, test_failed
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_filter_moving_average, only : moving_average
   use filter_library, only : fill_noise
   implicit none (type, external)
   private
   public :: collect_moving_average

   !> Rounding of a mean of some hundred numbers of size one
   real(dp), parameter :: rounding = 1.0e-14_dp

contains

   subroutine collect_moving_average(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("written-out", test_written_out), &
         new_unittest("missing", test_missing), &
         new_unittest("nothing-yet", test_nothing), &
         new_unittest("ramp", test_ramp), &
         new_unittest("spike", test_spike), &
         new_unittest("refused", test_refused)]
   end subroutine collect_moving_average

   !> Every sum made anew.
   subroutine literal(z, here, length, centred, x)
      real(dp), intent(in) :: z(:)
      logical, intent(in) :: here(:), centred
      integer, intent(in) :: length
      real(dp), intent(out) :: x(:)
      integer :: k, from, to

      do k = 1, size(z)
         from = max(1, k - length + 1)
         to = k
         if (centred) from = max(1, k - length/2)
         if (centred) to = min(size(z), k + length/2)
         x(k) = 0
         if (k > 1) x(k) = x(k - 1)
         if (any(here(from:to))) x(k) = sum(z(from:to), mask=here(from:to))/count(here(from:to))
      end do
   end subroutine literal

   !> Windows shorter and longer than the series, even and odd.
   subroutine test_written_out(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: lengths(9) = [1, 2, 3, 7, 50, 99, 100, 101, 1000]
      real(dp) :: z(100), x(100), expected(100)
      type(gyro_error), allocatable :: gyro
      logical :: centred
      integer :: i, j
      character(40) :: name

      call fill_noise(1, z)
      do i = 1, size(lengths)
         do j = 0, 1
            centred = j == 1
            call moving_average(z, int(lengths(i), int64), centred, x, gyro)
            call literal(z, spread(.true., 1, 100), lengths(i), centred, expected)
            write (name, '("length ", i0, ", centred: ", l1)') lengths(i), centred
            if (allocated(gyro)) then
               call test_failed(error, trim(name))
               return
            end if
            call check(error, maxval(abs(x - expected)) < rounding, trim(name))
            if (allocated(error)) return
         end do
      end do
      call moving_average(z(:1), 5_int64, .true., x(:1), gyro)
      call check(error, .not. allocated(gyro) .and. abs(x(1) - z(1)) < rounding)
      if (allocated(error)) return
      call moving_average(z(:0), 5_int64, .true., x(:0), gyro)
      call check(error, .not. allocated(gyro))
   end subroutine test_written_out

   !> Missing samples do not count, by the mask and by NaN; an empty window keeps the average before it.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: z(500), y(500), x(500), expected(500)
      integer(int8) :: valid(500)
      type(gyro_error), allocatable :: gyro
      integer :: j

      call fill_noise(2, z)
      valid = 1_int8
      valid(3::7) = 0_int8
      valid(200:240) = 0_int8
      valid(1) = 1_int8
      y = merge(z, ieee_value(0.0_dp, ieee_quiet_nan), valid == 1_int8)
      z = merge(z, 1.0e30_dp, valid == 1_int8)
      do j = 0, 1
         call moving_average(z, 12_int64, j == 1, x, gyro, valid)
         call check(error, .not. allocated(gyro))
         if (allocated(error)) return
         call literal(z, valid == 1_int8, 12, j == 1, expected)
         call check(error, maxval(abs(x - expected)) < rounding)
         if (allocated(error)) return
         call moving_average(y, 12_int64, j == 1, expected, gyro)
         call check(error, maxval(abs(x - expected)) <= 0)
         if (allocated(error)) return
      end do
   end subroutine test_missing

   !> 0 before the first measurement, and where there is none at all.
   subroutine test_nothing(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: z(40), x(40)
      integer(int8) :: valid(40)
      type(gyro_error), allocatable :: gyro

      z = 5
      valid = 0_int8
      call moving_average(z, 4_int64, .false., x, gyro, valid)
      call check(error, .not. allocated(gyro) .and. all(abs(x) <= 0))
      if (allocated(error)) return
      valid(11:) = 1_int8
      call moving_average(z, 4_int64, .false., x, gyro, valid)
      call check(error, all(abs(x(:10)) <= 0) .and. all(abs(x(11:) - 5) <= 0))
   end subroutine test_nothing

   !> A centred window reproduces a ramp, a causal one lags by half its length.
   subroutine test_ramp(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: z(300), x(300)
      type(gyro_error), allocatable :: gyro
      integer :: k

      z = [(real(k, dp), k=1, 300)]
      call moving_average(z, 21_int64, .true., x, gyro)
      call check(error, .not. allocated(gyro) .and. maxval(abs(x(11:290) - z(11:290))) < 1.0e-12_dp)
      if (allocated(error)) return
      call moving_average(z, 21_int64, .false., x, gyro)
      call check(error, .not. allocated(gyro) .and. maxval(abs(x(21:) - (z(21:) - 10))) < 1.0e-12_dp)
   end subroutine test_ramp

   !> A sample of 1e17 leaves nothing behind: a sum that subtracts it would.
   subroutine test_spike(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: z(2000), x(2000), without(2000)
      type(gyro_error), allocatable :: gyro

      call fill_noise(3, z)
      call moving_average(z, 30_int64, .false., without, gyro)
      z(777) = 1.0e17_dp
      call moving_average(z, 30_int64, .false., x, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, maxval(abs(x(:776) - without(:776))) < rounding .and. maxval(abs(x(807:) - without(807:))) < rounding)
      if (allocated(error)) return
      call check(error, minval(x(777:806)) > 3.3e15_dp)
   end subroutine test_spike

   !> What is no average.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: z(10), x(10)
      integer(int8) :: valid(9)
      type(gyro_error), allocatable :: gyro

      z = 0
      valid = 1_int8
      call moving_average(z, 0_int64, .false., x, gyro)
      call expect()
      if (.not. allocated(error)) call moving_average(z, 3_int64, .false., x(:9), gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call moving_average(z, 3_int64, .false., x, gyro, valid)
      if (.not. allocated(error)) call expect()

   contains

      subroutine expect()
         call check_refused(error, gyro, status%invalid_argument)
      end subroutine expect
   end subroutine test_refused

end module test_moving_average
