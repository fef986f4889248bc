! SPDX-License-Identifier: MIT
!> Tests of the dynamic Allan deviation.
module test_allan_dynamic
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_dynamic, only : dynamic_allan, dynamic_options, dynamic_type
   use allan_series, only : nbs14_long, normal_series
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_dynamic

contains

   !> The tests of this suite.
   subroutine collect_allan_dynamic(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("by_hand", test_by_hand), &
         & new_unittest("one_segment_is_the_record", test_one_segment), &
         & new_unittest("segments_by_themselves", test_segments), &
         & new_unittest("lengths", test_lengths), &
         & new_unittest("step_of_the_noise", test_step), &
         & new_unittest("gaps", test_gaps), &
         & new_unittest("lost_segment", test_lost_segment), &
         & new_unittest("threads", test_threads), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_allan_dynamic

   !> 1 2 4 8 16 32 in two segments of 4 that overlap by half; at one sample, the mean square of the differences over 2.
   subroutine test_by_hand(error)
      type(error_type), allocatable, intent(out) :: error

      real(dp), parameter :: x(6) = [1.0_dp, 2.0_dp, 4.0_dp, 8.0_dp, 16.0_dp, 32.0_dp]
      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(gyro_error), allocatable :: failed

      options%segments = 2
      call dynamic_allan(x, 0.5_dp, options, dynamic, failed)
      call check(error, .not. allocated(failed) .and. dynamic%segment_samples == 4 .and. dynamic%step_samples == 2)
      if (allocated(error)) return
      call check(error, all(shape(dynamic%deviation) == [2, 2]) .and. all(dynamic%m == [1, 2]))
      if (allocated(error)) return
      call check(error, norm2(dynamic%start - [0.0_dp, 1.0_dp]) + norm2(dynamic%tau - [0.5_dp, 1.0_dp]), 0.0_dp, thr=1e-15_dp)
      if (allocated(error)) return
      call check(error, norm2(dynamic%deviation(1, :) - sqrt([21/6.0_dp, 336/6.0_dp])), 0.0_dp, thr=1e-13_dp)
      if (allocated(error)) return
      call check(error, norm2(dynamic%deviation(2, :) - [4.5_dp, 18.0_dp]/sqrt(2.0_dp)), 0.0_dp, thr=1e-13_dp)
   end subroutine test_by_hand

   !> One segment: the published deviations of the whole NBS14 series.
   subroutine test_one_segment(error)
      type(error_type), allocatable, intent(out) :: error

      real(dp), parameter :: exact(3) = [0.2922318781067592_dp, 0.09159953420118654_dp, 0.03241343026056984_dp]
      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(gyro_error), allocatable :: failed

      options%segments = 1
      options%taus = "1,10,100"
      call dynamic_allan(nbs14_long(), 1.0_dp, options, dynamic, failed)
      call check(error, .not. allocated(failed) .and. size(dynamic%start) == 1)
      if (allocated(error)) return
      call check(error, maxval(abs(dynamic%deviation(:, 1)/exact - 1)), 0.0_dp, thr=1e-12_dp)
   end subroutine test_one_segment

   !> Each segment is the curve of its own samples; of white noise the limits are too.
   subroutine test_segments(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(allan_curve_type) :: curve
      type(gyro_error), allocatable :: failed
      real(dp), allocatable :: x(:)
      integer(int64) :: j, first

      x = normal_series(50000_int64, 71_int64) + 1e3_dp
      options%segments = 24
      options%confidence = 0.95_dp
      call dynamic_allan(x, 0.01_dp, options, dynamic, failed)
      call check(error, size(dynamic%start) == 24 .and. dynamic%segment_samples == 4000)
      if (allocated(error)) return
      do j = 1, 24
         first = 1 + (j - 1)*dynamic%step_samples
         call compute_allan(x(first:first + 3999), 0.01_dp, allan_options(confidence=0.95_dp), curve, failed)
         call check(error, maxval(abs(dynamic%deviation(:, j)/curve%deviation - 1)), 0.0_dp, thr=1e-9_dp)
         if (allocated(error)) return
         call check(error, all(dynamic%terms(:, j) == curve%terms))
         if (allocated(error)) return
      end do
      call check(error, maxval(abs(dynamic%upper(:6, 24)/curve%upper(:6) - 1)), 0.0_dp, thr=1e-6_dp)
   end subroutine test_segments

   !> A segment of 100 s every 25 s in 1000 s; the default is a tenth, overlapping by half; one that is too long is the record.
   subroutine test_lengths(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(gyro_error), allocatable :: failed
      real(dp) :: x(2000)

      x = normal_series(2000_int64, 81_int64)
      call dynamic_allan(x, 0.5_dp, options, dynamic, failed)
      call check(error, size(dynamic%start) == 19 .and. dynamic%segment_samples == 200 .and. dynamic%step_samples == 100)
      if (allocated(error)) return
      options%segment = 100
      options%step = 25
      call dynamic_allan(x, 0.5_dp, options, dynamic, failed)
      call check(error, size(dynamic%start) == 37 .and. dynamic%segment_samples == 200 .and. dynamic%step_samples == 50)
      if (allocated(error)) return
      call check(error, dynamic%start(37), 900.0_dp, thr=1e-9_dp)
      if (allocated(error)) return
      options%segment = 1e6_dp
      call dynamic_allan(x, 0.5_dp, options, dynamic, failed)
      call check(error, size(dynamic%start) == 1 .and. dynamic%segment_samples == 2000)
   end subroutine test_lengths

   !> Noise that doubles in the middle is seen there and nowhere else.
   subroutine test_step(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(gyro_error), allocatable :: failed
      real(dp) :: x(20000)

      x = normal_series(20000_int64, 91_int64)
      x(10001:) = 2*x(10001:)
      options%segments = 19
      call dynamic_allan(x, 1.0_dp, options, dynamic, failed)
      call check(error, maxval(abs(dynamic%deviation(1, :9) - 1)) < 0.1_dp .and. &
         & maxval(abs(dynamic%deviation(1, 11:) - 2)) < 0.2_dp)
      if (allocated(error)) return
      call check(error, dynamic%deviation(1, 10), sqrt(2.5_dp), thr=0.15_dp)
   end subroutine test_step

   !> What is missing does not count: segments with gaps are the gapped curves of their samples.
   subroutine test_gaps(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(allan_curve_type) :: curve
      type(gyro_error), allocatable :: failed
      real(dp) :: x(8000)
      integer(int8) :: valid(8000)
      integer(int64) :: j, first

      x = normal_series(8000_int64, 95_int64)
      valid = 1
      valid(3100:3400:9) = 0
      valid(5000:5100) = 0
      x = merge(x, 1e9_dp, valid == 1)
      options%segments = 7
      options%min_coverage = 0.8_dp
      call dynamic_allan(x, 1.0_dp, options, dynamic, failed, valid)
      do j = 1, 7
         first = 1 + (j - 1)*dynamic%step_samples
         call compute_allan(x(first:first + 1999), 1.0_dp, allan_options(min_coverage=0.8_dp), curve, failed, &
            & valid(first:first + 1999))
         call check(error, all(pack(dynamic%terms(:, j), dynamic%terms(:, j) > 0) == curve%terms))
         if (allocated(error)) return
         call check(error, maxval(abs(pack(dynamic%deviation(:, j), dynamic%terms(:, j) > 0)/curve%deviation - 1)), 0.0_dp, &
            & thr=1e-9_dp)
         if (allocated(error)) return
      end do
   end subroutine test_gaps

   !> A segment of which nothing is left has no terms, and zeros.
   subroutine test_lost_segment(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_options) :: options
      type(dynamic_type) :: dynamic
      type(gyro_error), allocatable :: failed
      real(dp) :: x(4000)

      x = normal_series(4000_int64, 97_int64)
      x(1001:2000) = ieee_value(1.0_dp, ieee_quiet_nan)
      options%segments = 7
      call dynamic_allan(x, 1.0_dp, options, dynamic, failed)
      call check(error, .not. allocated(failed) .and. all(dynamic%terms(:, 3) == 0) .and. all(dynamic%terms(:5, [1, 5]) > 0))
      if (allocated(error)) return
      call check(error, sum(abs(dynamic%deviation(:, 3))) + sum(abs(dynamic%upper(:, 3))), 0.0_dp, thr=0.0_dp)
   end subroutine test_lost_segment

   !> The same bits with one thread and with two.
   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_options) :: options
      type(dynamic_type) :: one, two
      type(gyro_error), allocatable :: failed
      real(dp), allocatable :: x(:)
      integer :: threads

      x = normal_series(300000_int64, 99_int64)
      options%segments = 19
      threads = thread_count()
      call set_thread_count(1)
      call dynamic_allan(x, 1.0_dp, options, one, failed)
      call set_thread_count(2)
      call dynamic_allan(x, 1.0_dp, options, two, failed)
      call set_thread_count(threads)
      call check(error, maxval(abs(one%deviation - two%deviation)), 0.0_dp, thr=0.0_dp)
   end subroutine test_threads

   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error

      type(dynamic_type) :: dynamic
      type(gyro_error), allocatable :: failed
      real(dp) :: x(30)

      x = normal_series(30_int64, 5_int64)
      call dynamic_allan(x, 1.0_dp, dynamic_options(), dynamic, failed)
      call check(error, failed%code, status%too_few_samples)
      if (allocated(error)) return
      call dynamic_allan(x, 0.0_dp, dynamic_options(segments=2), dynamic, failed)
      call check(error, failed%code, status%invalid_argument)
      if (allocated(error)) return
      call dynamic_allan(x, 1.0_dp, dynamic_options(segments=-1), dynamic, failed)
      call check(error, failed%code, status%invalid_argument)
      if (allocated(error)) return
      call dynamic_allan(x, 1.0_dp, dynamic_options(segment=-1.0_dp), dynamic, failed)
      call check(error, failed%code, status%invalid_argument)
      if (allocated(error)) return
      call dynamic_allan(x, 1.0_dp, dynamic_options(segments=2, confidence=1.0_dp), dynamic, failed)
      call check(error, failed%code, status%invalid_argument)
      if (allocated(error)) return
      call dynamic_allan(x, 1.0_dp, dynamic_options(segments=2, min_coverage=0.0_dp), dynamic, failed)
      call check(error, failed%code, status%invalid_argument)
   end subroutine test_failures

end module test_allan_dynamic
