! SPDX-License-Identifier: MIT
!> Tests of gyroakf_filter_block_stream: means of the parts of a series against those of the whole, over every change of the width.
module test_block_stream
   use testdrive, only : check, error_type, new_unittest, unittest_type
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_filter_block_stream, only : block_means_type, block_stream_type, feed_block_stream, finish_block_stream, most_means
   use gyroakf_filter_identification, only : block_means
   implicit none (type, external)
   private
   public :: collect_block_stream

   !> A series lies about this, with a standard deviation near 1
   real(dp), parameter :: level = 1.0e3_dp
   !> A sum of 64 numbers near the level, rounded
   real(dp), parameter :: close = 64*level*epsilon(1.0_dp)

contains

   !> Names the tests.
   subroutine collect_block_stream(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("widths", test_widths), &
         new_unittest("missing", test_missing), &
         new_unittest("half-missing", test_half), &
         new_unittest("units", test_units), &
         new_unittest("nothing", test_nothing)]
   end subroutine collect_block_stream

   !> n samples, no two blocks of which have the same mean.
   pure function series(n) result(x)
      integer(int64), intent(in) :: n
      real(dp) :: x(n)
      integer(int64) :: k

      do k = 1, n
         x(k) = level + sin(0.37_dp*real(k, dp)) + 1.0e-6_dp*real(k, dp)
      end do
   end function series

   !> Means of a series fed in parts of growing length.
   subroutine stream_means(x, factor, offset, means, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: factor, offset
      type(block_means_type), intent(out) :: means
      integer(int8), intent(in), contiguous, optional :: valid(:)
      type(block_stream_type) :: stream
      type(gyro_error), allocatable :: failed
      integer(int64) :: from, to, step

      from = 1
      step = 1
      do while (from <= size(x, kind=int64))
         to = min(from + step - 1, size(x, kind=int64))
         if (present(valid)) then
            call feed_block_stream(stream, x(from:to), failed, valid(from:to))
         else
            call feed_block_stream(stream, x(from:to), failed)
         end if
         from = to + 1
         step = 3*step
      end do
      call finish_block_stream(stream, factor, offset, means, failed)
   end subroutine stream_means

   !> The narrowest blocks of 4, 16, 64, ... samples of which there are no more than are wanted; also where the room for sums
   !> of blocks of 4 is full (524,288 samples) and after it.
   subroutine test_widths(error)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), parameter :: length(9) = [3_int64, 4_int64, 4*most_means, 4*most_means + 3, 4*most_means + 4, &
                                                16*most_means, 16*most_means + 1, 16*most_means + 16, 20*most_means]
      integer(int64), parameter :: width(9) = [4, 4, 4, 4, 16, 16, 16, 64, 64]
      type(block_means_type) :: means
      type(gyro_error), allocatable :: failed
      real(dp), allocatable :: x(:), expected(:)
      integer(int8), allocatable :: present_means(:)
      character(24) :: what
      integer :: i

      do i = 1, size(length)
         write (what, "(i0, a)") length(i), " samples"
         x = series(length(i))
         call stream_means(x, 1.0_dp, 0.0_dp, means)
         call check(error, means%width == width(i) .and. means%of_samples == length(i), trim(what)//": width")
         if (allocated(error)) return
         call block_means(x, width(i), expected, present_means, failed)
         call check(error, size(means%value) == size(expected) .and. .not. allocated(means%present), trim(what)//": blocks")
         if (allocated(error)) return
         call check(error, all(abs(means%value - expected) <= close), trim(what)//": means")
         if (allocated(error)) return
      end do
   end subroutine test_widths

   !> Gaps shorter and longer than a block, and none of the first samples: as of the whole, narrow and after the width has grown.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), parameter :: length(2) = [10000_int64, 20*most_means]
      type(block_means_type) :: means
      type(gyro_error), allocatable :: failed
      real(dp), allocatable :: x(:), expected(:)
      integer(int8), allocatable :: valid(:), present_means(:)
      integer :: i

      do i = 1, size(length)
         x = series(length(i))
         allocate (valid(length(i)), source=1_int8)
         valid(:70) = 0_int8
         valid(500:5000) = 0_int8
         valid(6001::3) = 0_int8
         where (valid == 0_int8) x = huge(x)                   ! is not looked at
         call stream_means(x, 1.0_dp, 0.0_dp, means, valid)
         call block_means(x, means%width, expected, present_means, failed, valid)
         call check(error, allocated(means%present), "no block is missing")
         if (allocated(error)) return
         call check(error, all(means%present == present_means), "other blocks are missing")
         if (allocated(error)) return
         call check(error, all(abs(means%value - expected) <= close), "means")
         if (allocated(error)) return
         deallocate (valid)
      end do
   end subroutine test_missing

   !> A block counts with half of its samples, and is the mean of these; with fewer it is 0.
   subroutine test_half(error)
      type(error_type), allocatable, intent(out) :: error
      type(block_means_type) :: means
      real(dp), parameter :: x(12) = [1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 1, 1]
      integer(int8), parameter :: valid(12) = [0_int8, 1_int8, 0_int8, 1_int8, 0_int8, 0_int8, 1_int8, 0_int8, 1_int8, 1_int8, &
                                               1_int8, 1_int8]

      call stream_means(x, 1.0_dp, 0.0_dp, means, valid)
      call check(error, allocated(means%present), "no block is missing")
      if (allocated(error)) return
      call check(error, all(means%present == [1_int8, 0_int8, 1_int8]), "which blocks are there")
      if (allocated(error)) return
      call check(error, all(abs(means%value - [3.0_dp, 0.0_dp, 3.0_dp]) <= 0.0_dp), "means of what is there")
   end subroutine test_half

   !> factor x - offset, whatever the first sample is.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      type(block_means_type) :: means, plain
      real(dp), allocatable :: x(:)

      x = series(1000_int64)
      call stream_means(x, 1.0_dp, 0.0_dp, plain)
      call stream_means(x, -2.5_dp, 7.0_dp, means)
      call check(error, all(abs(means%value - (-2.5_dp*plain%value - 7.0_dp)) <= close), "factor x - offset")
   end subroutine test_units

   !> Without a sample there is no block; without a present one every block is missing.
   subroutine test_nothing(error)
      type(error_type), allocatable, intent(out) :: error
      type(block_means_type) :: means
      real(dp) :: x(8)
      integer(int8) :: valid(8)

      call stream_means(x(:0), 1.0_dp, 0.0_dp, means)
      call check(error, means%width == 0 .and. .not. allocated(means%value), "blocks of nothing")
      if (allocated(error)) return
      x = 1.0_dp
      valid = 0_int8
      call stream_means(x, 1.0_dp, 0.0_dp, means, valid)
      call check(error, size(means%value) == 2 .and. all(means%present == 0_int8), "blocks of which nothing is present")
   end subroutine test_nothing

end module test_block_stream
