! SPDX-License-Identifier: MIT
!> Lost samples: where the lag, elapsed time / step - count, rises and does not fall back.
!>
!> The lag is followed from stamp to stamp where they are regular, and from block to block by the mean stamps where they are not
!> ([[gyroakf_io_lag_levels]]). Every rise above a threshold begins a gap; where stamps come sooner than the grid lets them, as
!> after a late one, the last gap is given back.
module gyroakf_io_losses
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_io_lag_levels, only : find_levels
   implicit none (type, external)
   private
   public :: gap_type, add_gap, find_losses, find_gaps

   !> Samples that were lost, and rows that are no samples
   type :: gap_type
      !> The sample after the gap: [gap]
      integer(int64), allocatable :: before(:)
      !> How many were lost; -1: the row `before` repeats the one above and is left out: [gap]
      integer(int64), allocatable :: length(:)
      !> How many gaps and repeated rows
      integer :: count = 0
      !> Jumps of the clock that are too long to be filled
      integer(int64) :: jumps = 0
      !> The sample after the first of them, 0 where there is none
      integer(int64) :: first_jump = 0
   end type gap_type

   !> How the phase follows the stamps, and the longest gap over which it is kept, intervals
   real(dp), parameter :: phase_gain = 1.0_dp/32.0_dp, longest_kept = 50.0_dp
   !> A rise has to last so many samples, or four times as many as are lost; what is late for less is not lost
   integer(int64), parameter :: lasting = 2048

contains

   !> Finds the losses among stamps that are not regular: a step of the stamps has to be long enough for each.
   subroutine find_losses(t, cadence, gaps)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> Of the stamps
      type(cadence_type), intent(in) :: cadence
      !> Appended to, in order; none where there are fewer than 192 samples
      type(gap_type), intent(inout) :: gaps
      real(dp), allocatable :: level(:)
      type(gap_type) :: found
      real(dp) :: step, rise, usual, length, across, long
      integer(int64) :: i, b
      integer :: rows, k

      call find_levels(t, cadence, level, rows, step, rise, usual)
      if (size(level) == 0) return
      allocate (found%before(16), found%length(16))
      call find_gaps(t, level, rows, step, rise, found)
      do k = 1, found%count
         i = found%before(k)
         b = (i - 1)/rows + 1
         if (b == 1 .or. b >= size(level)) cycle
         length = real(found%length(k), dp)
         across = (level(b + 1) - level(b - 1))/step - 2*rows
         if (abs(across - length) < max(rise, 0.5_dp*across)) length = anint(across)
         long = 0.75_dp*length + 0.5_dp
         if (usual > 3.0_dp) long = max(long, usual + 0.5_dp*length - 0.5_dp)
         if (length >= rise .and. t(i) - t(i - 1) >= long*step) call add_gap(gaps, i, int(length, int64))
      end do
   end subroutine find_losses

   !> Finds where the lag rises.
   pure subroutine find_gaps(t, level, rows, interval, rise, gaps)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> s, of blocks; the stamps themselves where a block is one sample: [block]
      real(dp), intent(in), contiguous :: level(:)
      !> Samples of a block
      integer, intent(in) :: rows
      !> s from sample to sample
      real(dp), intent(in) :: interval
      !> Least rise at a loss, samples, from 0.5
      real(dp), intent(in) :: rise
      !> Appended to, in order
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: b, i, lost, early, early_at
      real(dp) :: rate, phase, x

      rate = 1.0_dp/interval
      phase = 0.0_dp
      early = 0
      early_at = 0
      do b = 2, size(level, kind=int64)
         x = (level(b) - level(b - 1))*rate - rows + phase
         if (x >= -rise .and. x < rise) then
            phase = (1.0_dp - phase_gain)*x
            cycle
         end if
         lost = nint(min(x, 1.0e15_dp), int64)
         phase = 0.0_dp
         if (x < longest_kept) phase = (1.0_dp - phase_gain)*(x - real(lost, dp))
         i = longest_step(t, (b - 2)*rows + 1, b*rows)
         if (i - early_at > lasting) early = 0
         if (lost > 0) then
            x = real(lost, dp)
            lost = max(0_int64, lost - early)
            early = max(0_int64, early - int(x, int64))
            if (lost > 0) call add_gap(gaps, i, lost)
         else
            call give_back(i, -lost, gaps, early)
            early_at = i
         end if
      end do
   end subroutine find_gaps

   !> Shortens the last gaps by places that are taken after all.
   pure subroutine give_back(i, places, gaps, early)
      integer(int64), intent(in) :: i, places
      type(gap_type), intent(inout) :: gaps
      integer(int64), intent(inout) :: early
      integer(int64) :: left, taken

      left = places
      do while (left > 0 .and. gaps%count > 0)
         associate (before => gaps%before(gaps%count), length => gaps%length(gaps%count))
            if (i - before > max(lasting, 4*length)) exit
            taken = min(left, length)
            length = length - taken
            left = left - taken
            if (length == 0) gaps%count = gaps%count - 1
         end associate
      end do
      early = early + left
   end subroutine give_back

   !> The sample behind the longest step in a stretch.
   pure integer(int64) function longest_step(t, first, last)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: first, last

      longest_step = first + maxloc(t(first + 1:last) - t(first:last - 1), dim=1, kind=int64)
   end function longest_step

   !> Appends a gap; one behind the last lengthens it.
   pure subroutine add_gap(gaps, before, length)
      !> Grows by one
      type(gap_type), intent(inout) :: gaps
      !> Where, and how many samples
      integer(int64), intent(in) :: before, length

      if (gaps%count == size(gaps%before)) then
         gaps%before = [gaps%before, gaps%before]
         gaps%length = [gaps%length, gaps%length]
      end if
      if (gaps%count > 0) then
         if (gaps%before(gaps%count) == before) then
            gaps%length(gaps%count) = gaps%length(gaps%count) + length
            return
         end if
      end if
      gaps%count = gaps%count + 1
      gaps%before(gaps%count) = before
      gaps%length(gaps%count) = length
   end subroutine add_gap

end module gyroakf_io_losses
