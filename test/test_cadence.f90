! SPDX-License-Identifier: MIT
!> The sample interval from stamps of which some are lost: every k-th, at random, in runs, with
!> jitter; rates that explain the stamps equally well; clocks that start again.
module test_cadence
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_io_audit, only : audit_stamps, gap_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: suite_cadence

   !> s
   real(dp), parameter :: interval = 0.001_dp
   !> Of the interval
   real(dp), parameter :: jitters(*) = [0.0_dp, 1.0e-5_dp, 0.004_dp, 0.05_dp, 0.12_dp, 0.2_dp, 0.24_dp]

   !> Of the last audit, which then found nothing
   type(gyro_error), allocatable :: failed

contains

   subroutine suite_cadence()
      call test("every-kth-lost", test_every_kth)
      call test("random-losses", test_random)
      call test("losses-in-runs", test_runs)
      call test("two-rates", test_two_rates)
      call test("late-stamps", test_late)
      call test("rollovers", test_rollovers)
   end subroutine suite_cadence

   !> A number in 0 to 1, the same in every run.
   pure real(dp) function uniform(i)
      integer, intent(in) :: i

      uniform = modulo(43758.5453_dp*sin(12.9898_dp*real(i, dp) + 78.233_dp*real(modulo(i, 1009), dp)), 1.0_dp)
   end function uniform

   !> The rate and the number of lost samples have to be right.
   subroutine expect(place, jitter, what)
      !> On the grid, rising: [n]
      integer, intent(in) :: place(:)
      !> In intervals
      real(dp), intent(in) :: jitter
      character(*), intent(in) :: what
      type(audit_type) :: audit
      type(gap_type) :: gaps
      real(dp) :: t(size(place)), tolerance
      integer :: i, n, lost

      n = size(place)
      do i = 1, n
         t(i) = interval*(real(place(i), dp) + jitter*(2.0_dp*uniform(i) - 1.0_dp))
      end do
      call audit_stamps(t, audit, gaps, failed)
      lost = place(n) - place(1) + 1 - n
      call check(error, int(sum(gaps%length(:gaps%count))), lost, more=what//", jitter "//format_real(jitter, 3))
      tolerance = 1.0e-9_dp + 2.0_dp*jitter/real(n, dp)
      call check(error, audit%stamp_rate*interval, 1.0_dp, thr=tolerance, more=what//": rate")
   end subroutine expect

   !> Every k-th sample lost, whichever is the first, at any length and jitter.
   subroutine test_every_kth()
      integer, parameter :: lengths(*) = [300, 1000, 4001, 17990, 18001, 40000]
      integer, allocatable :: place(:)
      integer :: k, l, j, i

      do k = 3, 20
         do l = 1, size(lengths)
            place = [(i - 1 + (i - 1 + modulo(l, k - 1))/(k - 1), i=1, lengths(l))]
            do j = 1, size(jitters)
               call expect(place, jitters(j), "every "//format_real(real(k, dp), 2)//"th of "// &
                           format_real(real(lengths(l), dp), 5))
            end do
         end do
      end do
   end subroutine test_every_kth

   !> One sample in ten lost at random, and one in three.
   subroutine test_random()
      integer :: i, j

      do j = 1, size(jitters)
         call expect(pack([(i, i=1, 20000)], [(uniform(7*i + j) > 0.1_dp, i=1, 20000)]), jitters(j), "10 %")
         call expect(pack([(i, i=1, 20000)], [(uniform(7*i + j) > 0.33_dp, i=1, 20000)]), jitters(j), "33 %")
      end do
   end subroutine test_random

   !> Twenty samples lost now and then, alone and beside every tenth.
   subroutine test_runs()
      integer :: i, j

      do j = 1, size(jitters)
         call expect(pack([(i, i=1, 20000)], [(modulo(i, 1700) > 19, i=1, 20000)]), jitters(j), "runs")
         call expect(pack([(i, i=1, 20000)], [(modulo(i, 1700) > 19 .and. modulo(i, 10) > 0, i=1, 20000)]), jitters(j), &
                     "runs and every tenth")
      end do
   end subroutine test_runs

   !> Every eighth sample lost and 875 Hz in ms are the same stamps: both are known, and a rate that
   !> is given decides. Those of 833.1 Hz in ms are not at exactly even distances, and no losses.
   subroutine test_two_rates()
      type(audit_type) :: audit, decided, same
      type(gap_type) :: gaps
      real(dp) :: t(7000)
      integer :: i

      t(:) = [(interval*(i - 1 + (i - 1)/7), i=1, 7000)]
      call audit_stamps(t, audit, gaps, failed)
      call check(error, audit%stamp_rate, 1000.0_dp, thr=1.0e-6_dp, more="taken")
      call check(error, audit%other_rate, 875.0_dp, thr=1.0e-6_dp, more="other")
      call audit_stamps(t, decided, gaps, failed, 875.0_dp)
      call check(error, gaps%count == 0 .and. abs(decided%stamp_rate - 875.0_dp) < 0.1_dp, "875 Hz was given")
      call audit_stamps(t, same, gaps, failed, 1000.0_dp)
      call check(error, gaps%count == 999 .and. same%other_rate <= 0.0_dp, "1000 Hz was given")
      t(:) = [(interval*aint((i - 1)/0.8331_dp), i=1, 7000)]
      deallocate (audit%line_of_first)
      audit = audit_type()
      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count == 0 .and. audit%beats > 0 .and. abs(audit%other_rate - 1000.0_dp) < 1.0e-6_dp, &
                 "833.1 Hz: "//format_real(real(gaps%count, dp), 5)//", other "//format_real(audit%other_rate, 9))
      t(:) = [(interval*(i - 1 + (i - 1)/59), i=1, 7000)]
      audit = audit_type()
      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count == 118 .and. abs(audit%stamp_rate - 1000.0_dp) < 1.0e-6_dp .and. audit%other_rate > 983.0_dp, &
                 "every 60th lost")
      t(:) = [(interval*(i + count(i >= [1750, 3500, 5250])), i=1, 7000)]
      audit = audit_type()
      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count == 3 .and. audit%other_rate > 999.0_dp .and. audit%other_rate < 999.9_dp, &
                 "three at even distances: both rates are known")
      t(:) = [(interval*(i + count(i >= [1750, 1800, 1850])), i=1, 7000)]
      audit = audit_type()
      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count == 3 .and. audit%other_rate <= 0.0_dp, "three near each other: lost")
   end subroutine test_two_rates

   !> Lost samples among stamps that are up to an interval late are found where they were lost.
   subroutine test_late()
      integer, parameter :: lost = 20
      type(audit_type) :: audit
      type(gap_type) :: gaps
      real(dp) :: t(20000)
      integer :: i

      t(:) = [(interval*(i + (i + 500)/1000 + uniform(i)), i=1, size(t))]
      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count, lost)
      call check(error, all(gaps%length(:lost) == 1), "one each")
      call check(error, int(maxval(abs(gaps%before(:lost) - [(1000*i - 500, i=1, lost)]))) <= 4, "place")
   end subroutine test_late

   !> A GPS week, 32 bits of us, 16 bits of ms again and again.
   subroutine test_rollovers()
      real(dp), parameter :: period(*) = [604800.0_dp, 4294.967296_dp, 65.536_dp], start(*) = [604795.0_dp, 4290.0_dp, 60.0_dp]
      integer, parameter :: times(*) = [1, 1, 2]
      type(audit_type) :: audit
      type(gap_type) :: gaps
      real(dp) :: t(10000)
      integer :: k, i

      t(:) = [(modulo(604795.0_dp + 0.01_dp*(i + merge(30, 0, i > 480)), 604800.0_dp), i=1, size(t))]
      call audit_stamps(t, audit, gaps, failed)
      call check(error, int(audit%rollovers), 1, more="beside a gap")
      call check(error, int(gaps%length(1)), 30, more="the gap")
      do k = 1, size(period)
         t(:) = [(modulo(start(k) + 0.01_dp*i, period(k)), i=1, size(t))]
         audit = audit_type()
         call audit_stamps(t, audit, gaps, failed)
         call check(error, int(audit%rollovers), times(k), more=format_real(period(k), 9))
         call check(error, gaps%count == 0 .and. audit%backward_steps == 0 .and. abs(audit%rollover_period - period(k)) <= 0.0_dp, &
                    "counts")
         call check(error, audit%stamp_rate, 100.0_dp, thr=1.0e-6_dp, more="rate")
      end do
   end subroutine test_rollovers

end module test_cadence
