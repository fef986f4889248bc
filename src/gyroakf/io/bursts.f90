! SPDX-License-Identifier: MIT
!> Bursts: samples that were delivered late, several at once.
module gyroakf_io_bursts
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: count_bursts

contains

   !> Counts bursts: three samples or more at once, with less than 0.3 of the usual step between them, behind a long step; more
   !> of them than a tick of the clock holds.
   subroutine count_bursts(t, cadence, audit)
      !> Stamps, s
      real(dp), intent(in), contiguous :: t(:)
      !> Of the stamps
      type(cadence_type), intent(in) :: cadence
      !> Its bursts; `line_of_burst` is a row
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i, n, run, first, least
      logical :: late
      real(dp) :: short, long, step

      if (cadence%step <= 0.0_dp) return
      short = 0.3_dp*cadence%step
      long = 1.5_dp*cadence%step
      least = max(2_int64, ceiling(1.5_dp*min(cadence%resolution/cadence%step, 1.0e6_dp), int64))
      n = size(t, kind=int64)
      run = 0
      late = .false.
      first = 0
      do i = 2, n + 1
         step = huge(step)
         if (i <= n) step = t(i) - t(i - 1)
         if (abs(step) < short) then
            run = run + 1
            cycle
         end if
         if (late .and. run >= least) then
            audit%bursts = audit%bursts + 1
            audit%longest_burst = max(audit%longest_burst, run + 1)
            if (audit%line_of_burst == 0) audit%line_of_burst = first
         end if
         late = step >= long
         first = i
         run = 0
      end do
   end subroutine count_bursts

end module gyroakf_io_bursts
