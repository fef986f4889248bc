! SPDX-License-Identifier: MIT
!> Tests of the outlier rule `auto`: of noise of many kinds with and without outliers, and of motion.
module test_auto_outliers
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_preprocess_auto_outliers, only : auto_threshold, find_auto_outliers
   use gyroakf_preprocess_running_residual, only : block_residuals, block_size, find_coarse_step
   use gyroakf_select, only : find_median
   use allan_series, only : normal_series, uniform_series
   use expectations, only : unmet, failure => problem, test, error, check
   use, intrinsic :: ieee_arithmetic, only : ieee_get_halting_mode, ieee_is_finite, ieee_set_flag, &
      & ieee_set_halting_mode, ieee_usual
   implicit none (type, external)
   private
   public :: suite_auto_outliers

contains

   subroutine suite_auto_outliers()
      call test("residuals", test_residuals)
      call test("step", test_step)
      call test("nothing_to_find", test_nothing)
      call test("contamination", test_contamination)
      call test("spikes_on_drift", test_drift)
      call test("coarse_spikes", test_coarse)
      call test("motion", test_motion)
      call test("long_motion", test_long_motion)
      call test("missing", test_missing)
      call test("low_threshold", test_low_threshold)
      call test("huge_values", test_huge_values)
   end subroutine suite_auto_outliers

   !> A threshold that most of the noise exceeds ends the search, too, and is the one that was asked for.
   subroutine test_low_threshold()
      real(dp), parameter :: wanted(6) = [1.0_dp, 0.5_dp, 0.1_dp, 1.0e-3_dp, 1.0e-9_dp, 1.0e-300_dp]
      integer(int64), parameter :: n = 3000
      real(dp) :: x(n), used
      integer(int8) :: inlier(n)
      integer(int64), allocatable :: motion(:, :)
      integer :: i

      x = normal_series(n, 77_int64)
      do i = 1, size(wanted)
         call find_auto_outliers(x, wanted(i), inlier, used, motion, failure)
         call check(error, used, wanted(i), thr=0.05_dp*wanted(i))
      end do
   end subroutine test_low_threshold

   !> Values near the largest number, whose differences overflow, end the search with a finite threshold.
   subroutine test_huge_values()
      integer(int64), parameter :: n = 3000
      real(dp), parameter :: thresholds(4) = [1.0e-300_dp, 1.0_dp, 5.0_dp, 1.0e300_dp]
      real(dp) :: x(n), used
      integer(int8) :: inlier(n)
      integer(int64), allocatable :: motion(:, :)
      logical :: halting(size(ieee_usual))
      integer :: i, sign_change

      call ieee_get_halting_mode(ieee_usual, halting)
      call ieee_set_halting_mode(ieee_usual, .false.)          ! as for callers from C
      do sign_change = 0, 1
         x = 1.0e307_dp*normal_series(n, 78_int64)
         if (sign_change == 1) x = sign(huge(x), x)
         do i = 1, size(thresholds)
            call find_auto_outliers(x, thresholds(i), inlier, used, motion, failure)
            call check(error, .not. allocated(failure))
            call check(error, ieee_is_finite(used) .and. used > 0.0_dp)
         end do
      end do
      call ieee_set_flag(ieee_usual, .false.)
      call ieee_set_halting_mode(ieee_usual, halting)
   end subroutine test_huge_values

   !> Residuals of a record of 600, some of it missing, against sorted windows of the mirrored and bridged record.
   subroutine test_residuals()
      integer, parameter :: n = 600
      real(dp) :: x(n), y(-4:n + 5), residual(block_size), share, middle
      integer(int8) :: valid(n)
      logical :: there(block_size)
      integer :: i, k, before, after

      x = normal_series(int(n, int64), 3_int64)
      valid = 1
      valid([1, 2, 40, 41, 42, 256, 257, 300, 598]) = 0
      do i = 1, n
         before = i
         after = i
         do while (before > 1 .and. valid(before) == 0)
            before = before - 1
         end do
         do while (valid(after) == 0)
            after = after + 1
         end do
         if (valid(before) == 0) before = after
         share = real(i - before, dp)/max(1, after - before)
         y(i) = x(before) + (x(after) - x(before))*share
      end do
      y(-4:0) = y(5:1:-1)
      y(n + 1:) = y(n:n - 4:-1)
      do k = 1, 3
         call block_residuals(x, int(k, int64), 0.0_dp, valid, residual, there)
         do i = 1, min(block_size, n - (k - 1)*block_size)
            associate (at => (k - 1)*block_size + i)
               call check(error, there(i) .eqv. valid(at) == 1_int8, "what is present")
               call find_median(y(at - 5:at + 5), middle, failure)
               call check(error, residual(i), merge(abs(y(at) - middle), 0.0_dp, there(i)), thr=1.0e-14_dp)
            end associate
         end do
         call check(error, .not. any(there(i:)), "beyond the end")
      end do
   end subroutine test_residuals

   !> The step of rounded samples, and none of normal ones.
   subroutine test_step()
      real(dp) :: x(5000), step(3)

      x = normal_series(5000_int64, 5_int64)
      call find_coarse_step(x, step(1), failure)
      call find_coarse_step(0.05_dp*anint(20*x), step(2), failure)
      call find_coarse_step(spread(7.0_dp, 1, 5000), step(3), failure)
      call check(error, all(abs(step - [0.0_dp, 0.05_dp, 0.0_dp]) < 1.0e-12_dp))
   end subroutine test_step

   !> Places of outliers, and first and last samples of motion.
   subroutine search(x, marks, motion, valid)
      real(dp), intent(in), contiguous :: x(:)
      logical, allocatable, intent(out) :: marks(:)
      integer(int64), allocatable, intent(out) :: motion(:, :)
      integer(int8), intent(in), optional :: valid(:)
      integer(int8) :: inlier(size(x))
      real(dp) :: used

      call find_auto_outliers(x, auto_threshold(size(x, kind=int64)), inlier, used, motion, failure, valid)
      marks = inlier == 0_int8
      if (present(valid)) marks = marks .and. valid /= 0_int8
      if (allocated(failure)) marks = .true.
   end subroutine search

   !> White, Laplace, AR(1) of 0.95, a walk, rounded samples, a warm-up and a step of 20 standard deviations: two marks of 20,000 at
   !> most, no motion.
   subroutine test_nothing()
      integer, parameter :: n = 20000
      character(12), parameter :: name(9) = [character(12) :: "white", "laplace", "ar", "walk", "lsb 0.1", "lsb 1", "lsb 2", &
         & "warm-up", "step"]
      real(dp) :: w(n), x(n), u(n)
      logical, allocatable :: marks(:)
      integer(int64), allocatable :: motion(:, :)
      integer :: i, k

      w = normal_series(int(n, int64), 11_int64)
      do k = 1, size(name)
         x = w
         select case (k)
         case (2)
            u = uniform_series(int(n, int64), 551782903_int64) - 0.5_dp
            x = -sign(log(max(1 - 2*abs(u), 1.0e-9_dp)), u)
         case (3)
            do i = 2, n
               x(i) = 0.95_dp*x(i - 1) + w(i)
            end do
         case (4)
            do i = 2, n
               x(i) = x(i - 1) + 0.3_dp*w(i)
            end do
         case (5); x = 0.1_dp*anint(10*w)
         case (6); x = anint(w)
         case (7); x = 2*anint(w/2)
         case (8); x = w + [(100*exp(-i/3000.0_dp), i=1, n)]
         case (9); x(n/3:) = x(n/3:) + 20
         case default
         end select
         call search(x, marks, motion)
         if (unmet(count(marks) <= 2 .and. size(motion, 2) == 0, trim(name(k)))) return
      end do
   end subroutine test_nothing

   !> Adds to one sample in `every` between `low` and `high` of random sign.
   subroutine contaminate(x, share, low, high, added)
      real(dp), intent(inout) :: x(:)
      real(dp), intent(in) :: share, low, high
      real(dp), intent(out) :: added(:)
      real(dp), dimension(size(x)) :: u, v

      u = uniform_series(size(x, kind=int64), 21_int64)
      v = uniform_series(size(x, kind=int64), 764532117_int64) - 0.5_dp
      added = merge(sign(low + (high - low)*2*abs(v), v), 0.0_dp, u < share)
      x = x + added
   end subroutine contaminate

   !> 5.4 and 10 % of 4 to 50 standard deviations in white noise: 99 % of those beyond 6 are found, two others at most.
   subroutine test_contamination()
      integer, parameter :: n = 50000
      real(dp), parameter :: share(2) = [0.054_dp, 0.1_dp]
      real(dp) :: x(n), added(n)
      logical, allocatable :: marks(:)
      integer(int64), allocatable :: motion(:, :)
      integer :: k

      do k = 1, 2
         x = normal_series(int(n, int64), 31_int64)
         call contaminate(x, share(k), 4.0_dp, 50.0_dp, added)
         call search(x, marks, motion)
         call check(error, real(count(marks .and. abs(added) > 6), dp) >= 0.99_dp*count(abs(added) > 6), "not found")
         call check(error, count(marks .and. .not. abs(added) > 0) <= 2, "false marks")
      end do
   end subroutine test_contamination

   !> Spikes of 8 to 20 standard deviations on a walk of 0.3 a sample: all are found, no other sample is marked.
   subroutine test_drift()
      integer, parameter :: n = 20000
      real(dp) :: w(n), x(n), added(n)
      logical, allocatable :: marks(:)
      integer(int64), allocatable :: motion(:, :)
      integer :: i

      w = normal_series(int(n, int64), 41_int64)
      x(1) = 0
      do i = 2, n
         x(i) = x(i - 1) + 0.3_dp*w(i)
      end do
      call contaminate(x, 0.003_dp, 8.0_dp, 20.0_dp, added)
      call search(x, marks, motion)
      call check(error, all(marks .eqv. abs(added) > 0) .and. size(motion, 2) == 0)
   end subroutine test_drift

   !> Spikes of 12 to 20 standard deviations in samples rounded to one: all are found.
   subroutine test_coarse()
      integer, parameter :: n = 20000
      real(dp) :: x(n), added(n)
      logical, allocatable :: marks(:)
      integer(int64), allocatable :: motion(:, :)

      x = normal_series(int(n, int64), 51_int64)
      call contaminate(x, 0.01_dp, 12.0_dp, 20.0_dp, added)
      call search(anint(x), marks, motion)
      call check(error, all(marks .or. .not. abs(added) > 0) .and. count(marks) <= count(abs(added) > 0) + 1)
   end subroutine test_coarse

   !> Three seconds of motion at 100 Hz, a turn to and fro and a shaking: none of it is marked, and its time is reported.
   subroutine test_motion()
      integer, parameter :: n = 20000
      real(dp) :: x(n)
      logical, allocatable :: marks(:)
      integer(int64), allocatable :: motion(:, :)
      integer :: i

      x = normal_series(int(n, int64), 61_int64)
      x(5001:5300) = x(5001:5300) + [(20*sin(i*0.0104719755_dp), i=1, 300)]
      x(9001:9300) = x(9001:9300) + 20*normal_series(300_int64, 391745527_int64)
      x(15000) = 30
      call search(x, marks, motion)
      call check(error, count(marks(4900:5400)) == 0 .and. count(marks(8990:9311)) == 0 .and. marks(15000), "marks")
      if (unmet(size(motion, 2), 2)) return
      call check(error, abs(motion(1, 1) - 5001) < 150 .and. abs(motion(2, 1) - 5300) < 150 .and. abs(motion(1, 2) - 9001) < 520 &
         & .and. abs(motion(2, 2) - 9300) < 520, "times of the motion")
   end subroutine test_motion

   !> An excursion of 1.5 standard deviations for 4,000 samples: motion, without a mark; a step of as much that stays is none.
   subroutine test_long_motion()
      integer, parameter :: n = 200000
      real(dp) :: x(n)
      logical, allocatable :: marks(:)
      integer(int64), allocatable :: motion(:, :)

      x = normal_series(int(n, int64), 71_int64)
      x(90000:93999) = x(90000:93999) + 1.5_dp
      call search(x, marks, motion)
      if (unmet(count(marks) <= 2 .and. size(motion, 2) == 1, "an excursion")) return
      call check(error, abs(motion(1, 1) - 90000) < 1500 .and. abs(motion(2, 1) - 93999) < 1500, "its time")
      x(94000:) = x(94000:) + 1.5_dp
      call search(x, marks, motion)
      call check(error, count(marks) <= 2 .and. size(motion, 2) == 0, "a step")
   end subroutine test_long_motion

   !> What missing samples hold does not matter, nor that 20 % are missing and a stretch of five hundred.
   subroutine test_missing()
      integer, parameter :: n = 20000
      real(dp) :: x(n)
      integer(int8) :: valid(n)
      logical, allocatable :: marks(:), again(:)
      integer(int64), allocatable :: motion(:, :)

      x = normal_series(int(n, int64), 81_int64)
      x(3000::700) = x(3000::700) + 20
      valid = 1
      where (uniform_series(int(n, int64), 908172345_int64) < 0.2_dp) valid = 0
      valid(8001:8500) = 0
      valid(3000::700) = 1
      x = merge(x, 1.0e6_dp, valid == 1)
      call search(x, marks, motion, valid)
      if (unmet(all(marks(3000::700)) .and. count(marks) <= size(marks(3000::700)) + 1, "marks")) return
      if (unmet(size(motion, 2), 0)) return
      x = merge(x, -3.0_dp, valid == 1)
      call search(x, again, motion, valid)
      call check(error, all(marks .eqv. again))
   end subroutine test_missing

end module test_auto_outliers
