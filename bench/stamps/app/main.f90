! SPDX-License-Identifier: MIT
!> Simulates stamps of samples some of which are lost, and compares what the audit finds with what was lost.
program stamps_audit
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_io_audit, only : audit_stamps, gap_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)

   !> Samples of a case
   integer, parameter :: n = 30000
   !> A gap that was found counts as that loss within so many samples
   integer, parameter :: near = 40
   real(dp), parameter :: rates(*) = [10.0_dp, 99.3_dp, 100.0_dp, 990.0_dp, 1000.0_dp, 1010.0_dp, 8000.0_dp]
   real(dp), parameter :: clocks(*) = [1.0e-6_dp, 1.0e-3_dp, 1.0e-2_dp, 0.0_dp]
   character(8), parameter :: clock_name(*) = [character(8) :: "1 us", "1 ms", "10 ms", "1/rate"]
   real(dp), parameter :: jitters(*) = [0.0_dp, 0.05_dp, 0.3_dp, 1.0_dp]
   integer, parameter :: deliveries(*) = [1, 10]
   real(dp), parameter :: drifts(*) = [0.0_dp, 50.0e-6_dp]
   character(8), parameter :: loss_name(*) = [character(8) :: "none", "single", "runs", "long"]
   integer :: loss, clock, rate, jitter, delivery, drift, cases, bad_rate, found_false, missed, true_gaps, resolvable, cases_missed
   integer(int64) :: tick, tock, ticks
   real(dp) :: worst
   logical :: detail
   character(8) :: word

   call get_command_argument(1, word)
   detail = word == "all"
   print "(a)", "losses    clock     cases  losses  found  false  missed at resolvable  rate off > 1e-4 or bound  worst ppm"
   ticks = 0
   do loss = 1, size(loss_name)
      do clock = 1, size(clocks)
         cases = 0
         bad_rate = 0
         found_false = 0
         missed = 0
         true_gaps = 0
         resolvable = 0
         cases_missed = 0
         worst = 0.0_dp
         do rate = 1, size(rates)
            do jitter = 1, size(jitters)
               do delivery = 1, size(deliveries)
                  do drift = 1, size(drifts)
                     call one_case(loss, clock, rates(rate), jitters(jitter), deliveries(delivery), drifts(drift))
                  end do
               end do
            end do
         end do
         print "(a8,2x,a8,2i7,i8,i7,i10,i19,f17.1)", loss_name(loss), clock_name(clock), cases, true_gaps, true_gaps - missed, &
            found_false, cases_missed, bad_rate, worst
      end do
   end do
   call system_clock(tick, tock)
   print "(a,f6.1,a)", "audit: ", real(ticks, dp)/real(tock, dp)*1.0e9_dp/(real(n, dp)*4*4*7*4*2*2), " ns a sample"

contains

   !> Simulates, audits, counts.
   subroutine one_case(loss, clock, rate_hz, jitter, delivery, drift)
      integer, intent(in) :: loss, clock, delivery
      real(dp), intent(in) :: rate_hz, jitter, drift
      real(dp) :: t(n), u, tick_s, when, bound, off, true_rate, spread
      type(audit_type) :: audit
      type(gap_type) :: gaps
      type(error_type), allocatable :: error
      integer(int64) :: from, to, grid, lost_at(n), lost(n), inserted
      integer :: i, count_lost, k, j, wrong, hit, length

      true_rate = rate_hz*(1.0_dp + drift)
      tick_s = clocks(clock)
      if (tick_s <= 0.0_dp) tick_s = 1.0_dp/rate_hz
      call seed(loss + 7*clock + int(rate_hz) + int(100*jitter) + 1000*delivery)
      grid = 0
      count_lost = 0
      do i = 1, n
         length = 0
         call random_number(u)
         select case (loss)
         case (2); if (u < 1.0e-3_dp) length = 1
         case (3); if (u < 1.0e-4_dp) length = 20
         case (4); if (i == n/3) length = 500
         case default; continue
         end select
         if (i < 100) length = 0
         if (length > 0) then
            count_lost = count_lost + 1
            lost_at(count_lost) = i
            lost(count_lost) = length
         end if
         grid = grid + 1 + length
         when = real(grid, dp)
         if (delivery > 1) when = real(delivery*((grid + delivery - 1)/delivery), dp) + &
            0.02_dp*real(mod(grid - 1, int(delivery, int64)), dp)
         call random_number(u)
         t(i) = (when + jitter*u)/true_rate
         if (delivery > 1) t(i) = (when + jitter*noise(grid/delivery))/true_rate
         t(i) = real(floor(t(i)/tick_s + 0.3_dp, int64), dp)*tick_s
         if (i > 1) t(i) = max(t(i), t(i - 1))
      end do
      call system_clock(from)
      call audit_stamps(t, audit, gaps, error)
      call system_clock(to)
      if (allocated(error)) error stop error%message
      ticks = ticks + (to - from)
      wrong = 0
      hit = 0
      inserted = sum(gaps%length(:gaps%count))
      do k = 1, gaps%count
         if (.not. any(abs(lost_at(:count_lost) - gaps%before(k)) <= near)) wrong = wrong + 1
      end do
      do j = 1, count_lost
         if (any(abs(gaps%before(:gaps%count) - lost_at(j)) <= near)) hit = hit + 1
      end do
      spread = (jitter + tick_s*true_rate + merge(0.0_dp, real(delivery, dp), delivery == 1))
      off = (audit%stamp_rate/true_rate - 1.0_dp)*1.0e6_dp
      bound = max(100.0_dp, 1.0e6_dp*spread/n)
      if (hit < count_lost) bound = bound + 1.0e6_dp*(count_lost - hit)*sum(lost(:count_lost))/real(count_lost, dp)/n
      cases = cases + 1
      true_gaps = true_gaps + count_lost
      missed = missed + count_lost - hit
      found_false = found_false + wrong
      worst = max(worst, abs(off))
      if (abs(off) > bound) bad_rate = bad_rate + 1
      if (hit < count_lost .and. spread < 0.45_dp .and. delivery == 1) cases_missed = cases_missed + 1
      if (detail .and. (wrong > 0 .or. abs(off) > bound .or. (hit < count_lost .and. spread < 0.45_dp))) then
         print "(4a,f8.1,a,f5.2,a,i3,a,f5.0,a,i4,a,i4,a,i4,a,i5,a,i5,a,f9.1)", loss_name(loss), " ", clock_name(clock), " rate", &
         rate_hz, " jitter", jitter, " at once", delivery, " drift", drift*1e6_dp, ": lost", count_lost, " found", hit, " false", &
         wrong, " samples", sum(lost(:count_lost)), " inserted", inserted, " ppm", off
      end if
      if (detail .and. wrong > 0) then
         print "(a,*(i7,'+',i0))", "   lost    ", (lost_at(k), lost(k), k=1, count_lost)
         print "(a,*(i7,'+',i0))", "   inserted", (gaps%before(k), gaps%length(k), k=1, gaps%count)
      end if
   end subroutine one_case

   !> The same for all samples of a delivery, 0 to 1.
   pure real(dp) function noise(i)
      integer(int64), intent(in) :: i

      noise = modulo(real(i, dp)*0.6180339887498949_dp + real(mod(i, 10007_int64), dp)**2*0.3819660112501051_dp, 1.0_dp)
   end function noise

   !> The same numbers in every run.
   subroutine seed(k)
      integer, intent(in) :: k
      integer :: length, i
      integer, allocatable :: s(:)

      call random_seed(size=length)
      allocate (s(length))
      do i = 1, length
         s(i) = 1000003*i + 7919*k
      end do
      call random_seed(put=s)
   end subroutine seed

end program stamps_audit
