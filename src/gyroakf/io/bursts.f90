! SPDX-License-Identifier: MIT
!> Bursts: samples that were delivered late, several at once.
module gyroakf_io_bursts
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: burst_type, count_bursts, end_bursts

   !> What is remembered of the last steps while bursts are counted
   type :: burst_type
      !> Short steps so far, behind a long one
      integer(int64) :: run = 0
      logical :: late = .false.
      !> The row of the first sample of the run
      integer(int64) :: first = 0
      !> Short steps that the clock explains
      integer(int64) :: least = 2
   end type burst_type

contains

   !> Counts bursts: three samples or more at once, with less than 0.3 of the usual step between them, behind a long step; more
   !> of them than a tick of the clock holds.
   subroutine count_bursts(t, cadence, burst, audit, number)
      !> The last stamp of the part before, if there is one, and those of this part, s
      real(dp), intent(in), contiguous :: t(:)
      !> Of the stamps
      type(cadence_type), intent(in) :: cadence
      !> From part to part
      type(burst_type), intent(inout) :: burst
      !> Its bursts; `line_of_burst` is a row
      type(audit_type), intent(inout) :: audit
      !> Which rows they are, counted from 1 if absent
      integer(int64), intent(in), contiguous, optional :: number(:)
      integer(int64) :: i
      real(dp) :: short, long, step

      if (cadence%step <= 0.0_dp) return
      short = 0.3_dp*cadence%step
      long = 1.5_dp*cadence%step
      burst%least = max(2_int64, ceiling(1.5_dp*min(cadence%resolution/cadence%step, 1.0e6_dp), int64))
      do i = 2, size(t, kind=int64)
         step = t(i) - t(i - 1)
         if (abs(step) < short) then
            burst%run = burst%run + 1
            cycle
         end if
         if (burst%run >= burst%least) call end_bursts(burst, audit)
         burst%late = step >= long
         burst%first = i
         if (present(number)) burst%first = number(i)
         burst%run = 0
      end do
   end subroutine count_bursts

   !> Counts the burst that goes on, if there is one.
   pure subroutine end_bursts(burst, audit)
      !> None goes on afterwards
      type(burst_type), intent(inout) :: burst
      !> Its bursts
      type(audit_type), intent(inout) :: audit

      if (burst%late .and. burst%run >= burst%least) then
         audit%bursts = audit%bursts + 1
         audit%longest_burst = max(audit%longest_burst, burst%run + 1)
         if (audit%line_of_burst == 0) audit%line_of_burst = burst%first
      end if
      burst%run = 0
      burst%late = .false.
   end subroutine end_bursts

end module gyroakf_io_bursts
