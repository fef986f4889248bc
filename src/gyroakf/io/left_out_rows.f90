! SPDX-License-Identifier: MIT
!> Rows that are no samples: without a time, or with the stamp and the values of the row above.
!>
!> A row without a time stays where it fills exactly the places that are free between its neighbors;
!> its stamp is not invented anywhere else. Where neighbors of different stamps are as often alike
!> as those of equal ones, equal rows are chance (a coarse clock and coarse values), and they stay.
module gyroakf_io_left_out_rows
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_io_cadence, only : cadence_type, find_sample_interval, new_steps, steps_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: leave_rows_out, place_with

contains

   !> Takes rows out that are no samples of their own.
   subroutine leave_rows_out(t, value, audit, dropped, error)
      !> s; NaN, where missing, is gone afterwards; of size 0 where fewer than half have a time
      real(dp), allocatable, intent(inout) :: t(:)
      !> [row, channel]
      real(dp), allocatable, intent(inout) :: value(:, :)
      !> `untimed`, `repeated` and the rows of the first of them are set
      type(audit_type), intent(inout) :: audit
      !> The rows that were taken out, in order; of size 0 where there are none
      integer(int64), allocatable, intent(out) :: dropped(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: keep(:)
      real(dp), allocatable :: kept(:, :)
      integer(int64) :: i, n, without
      integer :: j, failed

      n = size(t, kind=int64)
      without = count(ieee_is_nan(t), kind=int64)
      allocate (dropped(0))
      if (without == 0 .and. .not. any_repeats(t, value)) return
      allocate (keep(n), stat=failed)
      call check_memory(failed, "leaving out rows", error)
      if (allocated(error)) return
      keep(:) = .true.
      if (without > 0) call place_untimed(t, value, keep, audit, error)
      if (allocated(error) .or. size(t) == 0) return
      if (any_repeats(t, value)) call find_repeats(t, value, keep, audit)
      if (all(keep)) return
      dropped = pack([(i, i=1, n)], .not. keep)
      allocate (kept(count(keep), size(value, 2)), stat=failed)
      call check_memory(failed, "a part of the rows", error)
      if (allocated(error)) return
      do j = 1, size(value, 2)
         kept(:, j) = pack(value(:, j), keep)
      end do
      call move_alloc(kept, value)
      t = pack(t, keep)
   end subroutine leave_rows_out

   !> Lets rows without a time fill the places between their neighbors where they are as many.
   subroutine place_untimed(t, value, keep, audit, error)
      real(dp), allocatable, intent(inout) :: t(:)
      real(dp), intent(in), contiguous :: value(:, :)
      logical, intent(inout) :: keep(:)
      type(audit_type), intent(inout) :: audit
      type(error_type), allocatable, intent(out) :: error
      type(cadence_type) :: cadence
      type(steps_type) :: work
      integer(int64) :: i, j, last, between, only_values
      real(dp) :: steps
      logical :: fits

      only_values = 0
      do i = 1, size(t, kind=int64)
         keep(i) = .not. ieee_is_nan(t(i))
         if (.not. keep(i) .and. .not. all(ieee_is_nan(value(i, :)))) only_values = only_values + 1
      end do
      audit%untimed = count(.not. keep, kind=int64)
      audit%line_of_untimed = findloc(keep, .false., dim=1, kind=int64)
      if (only_values >= count(keep, kind=int64)) then
         t = t(:0)
         return
      end if
      call new_steps(work, error)
      if (allocated(error)) return
      call find_sample_interval(pack(t, keep), work, cadence)
      last = 0
      do i = 1, size(t, kind=int64)
         if (.not. keep(i)) cycle
         between = i - last - 1
         if (last > 0 .and. between > 0 .and. cadence%step > 0.0_dp) then
            steps = (t(i) - t(last))/cadence%step
            fits = abs(steps - real(between + 1, dp)) < 0.5_dp
            do j = last + 1, merge(i - 1, last, fits)
               t(j) = t(last) + (t(i) - t(last))*real(j - last, dp)/real(between + 1, dp)
            end do
         end if
         last = i
      end do
      keep(:) = .not. ieee_is_nan(t)
      audit%untimed = count(.not. keep, kind=int64)
      audit%line_of_untimed = findloc(keep, .false., dim=1, kind=int64)
   end subroutine place_untimed

   !> True where a row has the stamp and the values of the one above.
   pure logical function any_repeats(t, value)
      real(dp), intent(in), contiguous :: t(:), value(:, :)
      integer(int64) :: i

      any_repeats = .true.
      do i = 2, size(t, kind=int64)
         if (ieee_is_nan(t(i)) .or. ieee_is_nan(t(i - 1))) cycle
         if (abs(t(i) - t(i - 1)) > 0.0_dp) cycle
         if (same_row(value, i, i - 1)) return
      end do
      any_repeats = .false.
   end function any_repeats

   !> Rows that repeat the one above are not kept, unless it is chance: rows of equal stamps are
   !> alike less than ten times as often as neighbors of different stamps.
   pure subroutine find_repeats(t, value, keep, audit)
      real(dp), intent(in), contiguous :: t(:), value(:, :)
      logical, intent(inout) :: keep(:)
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i, n, last, met(2), alike(2)      ! of equal stamps, of different ones
      integer :: k

      n = size(t, kind=int64)
      met(:) = 0
      alike(:) = 0
      last = 0
      do i = 1, n
         if (.not. keep(i)) cycle
         if (last > 0) then
            k = merge(2, 1, abs(t(i) - t(last)) > 0.0_dp)
            met(k) = met(k) + 1
            if (same_row(value, i, last)) alike(k) = alike(k) + 1
         end if
         last = i
      end do
      if (real(alike(1), dp)*real(max(met(2), 1_int64), dp) <= 10.0_dp*real(met(1), &
         dp)*real(alike(2), dp)) return
      last = 0
      do i = 1, n
         if (.not. keep(i)) cycle
         if (last > 0) then
            if (abs(t(i) - t(last)) <= 0.0_dp) keep(i) = .not. same_row(value, i, last)
         end if
         if (keep(i)) then
            last = i
         else
            audit%repeated = audit%repeated + 1
            if (audit%line_of_repeat == 0) audit%line_of_repeat = i
         end if
      end do
   end subroutine find_repeats

   pure logical function same_row(value, i, k)
      real(dp), intent(in), contiguous :: value(:, :)
      integer(int64), intent(in) :: i, k
      integer :: j

      same_row = .false.
      do j = 1, size(value, 2)
         if (ieee_is_nan(value(i, j)) .or. ieee_is_nan(value(k, j))) return
         if (abs(value(i, j) - value(k, j)) > 0.0_dp) return
      end do
      same_row = .true.
   end function same_row

   !> The index of a row among all rows; 0 stays 0.
   pure integer(int64) function place_with(dropped, i, first) result(place)
      !> Rows that were left out, in order
      integer(int64), intent(in) :: dropped(:)
      !> Counted from 1, the row `first` of those that stayed
      integer(int64), intent(in) :: i, first
      integer(int64) :: k

      place = i
      if (i == 0) return
      place = i + first - 1
      do k = 1, size(dropped, kind=int64)
         if (dropped(k) > place) exit
         place = place + 1
      end do
   end function place_with

end module gyroakf_io_left_out_rows
