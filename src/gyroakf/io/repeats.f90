! SPDX-License-Identifier: MIT
!> Rows that repeat the one above: the same stamp and the same values.
!>
!> Where neighbours of different stamps are as often alike, it is chance (a coarse clock and coarse values), and they stay.
module gyroakf_io_repeats
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_losses, only : add_gap, gap_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: drop_repeats, merge_repeats

contains

   !> Takes the stamps of rows out that repeat the one above, unless it is chance.
   subroutine drop_repeats(t, value, repeated)
      !> Afterwards the remaining ones stand first
      real(dp), intent(inout), contiguous :: t(:)
      !> [n, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> The rows that were taken out, in order; unallocated where there are none
      integer(int64), allocatable, intent(out) :: repeated(:)
      integer(int64) :: i, n, equal, alike, chance, others, stride, kept

      n = size(t, kind=int64)
      equal = 0
      alike = 0
      do i = 2, n
         if (abs(t(i) - t(i - 1)) > 0.0_dp) cycle
         equal = equal + 1
         if (same_row(value, i)) alike = alike + 1
      end do
      if (alike == 0) return
      chance = 0
      others = 0
      stride = 1 + n/100000
      do i = 2, n, stride
         if (abs(t(i) - t(i - 1)) <= 0.0_dp) cycle
         others = others + 1
         if (same_row(value, i)) chance = chance + 1
      end do
      if (are_chance(equal, alike, others, chance)) return
      allocate (repeated(alike))
      kept = 1
      alike = 0
      do i = 2, n
         if (abs(t(i) - t(kept)) <= 0.0_dp) then
            if (same_row(value, i)) then
               alike = alike + 1
               repeated(alike) = i
               cycle
            end if
         end if
         kept = kept + 1
         t(kept) = t(i)
      end do
      t(kept + 1:) = t(kept)
   end subroutine drop_repeats

   !> True where rows of equal stamps are alike less than ten times as often as neighbours of different stamps.
   pure logical function are_chance(equal, alike, others, chance)
      !> Neighbours of equal stamps, and those of them that have equal values
      integer(int64), intent(in) :: equal, alike
      !> Other neighbours, and those of them that do
      integer(int64), intent(in) :: others, chance

      are_chance = real(alike, dp)*real(max(others, 1_int64), dp) <= 10.0_dp*real(equal, dp)*real(chance, dp)
   end function are_chance

   !> True where a row has the values of the one above.
   pure logical function same_row(value, i)
      !> [row, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> Not the first
      integer(int64), intent(in) :: i
      integer :: j

      same_row = .false.
      do j = 1, size(value, 2)
         if (ieee_is_nan(value(i, j)) .or. ieee_is_nan(value(i - 1, j))) return
         if (abs(value(i, j) - value(i - 1, j)) > 0.0_dp) return
      end do
      same_row = .true.
   end function same_row

   !> Puts the rows that were taken out among the gaps, and lets all indices count them.
   subroutine merge_repeats(repeated, audit, gaps)
      integer(int64), intent(in) :: repeated(:)
      type(audit_type), intent(inout) :: audit
      type(gap_type), intent(inout) :: gaps
      type(gap_type) :: all
      integer(int64) :: next, at
      integer :: k

      allocate (all%before(gaps%count + size(repeated)), all%length(gaps%count + size(repeated)))
      next = 1
      do k = 1, gaps%count
         at = gaps%before(k) + next - 1
         do while (next <= size(repeated))
            if (repeated(next) > at) exit
            call add_gap(all, repeated(next), -1_int64)
            next = next + 1
            at = at + 1
         end do
         call add_gap(all, at, gaps%length(k))
      end do
      do next = next, size(repeated)
         call add_gap(all, repeated(next), -1_int64)
      end do
      call move_alloc(all%before, gaps%before)
      call move_alloc(all%length, gaps%length)
      gaps%count = all%count
      gaps%first_jump = place_with(repeated, gaps%first_jump)
      do k = 1, 3
         audit%line_of_first(k) = place_with(repeated, audit%line_of_first(k))
      end do
      audit%line_of_burst = place_with(repeated, audit%line_of_burst)
      audit%line_of_change = place_with(repeated, audit%line_of_change)
      audit%repeated = size(repeated, kind=int64)
      audit%line_of_repeat = repeated(1)
   end subroutine merge_repeats

   !> The index of a sample among all rows; 0 stays 0.
   pure integer(int64) function place_with(repeated, i) result(place)
      integer(int64), intent(in) :: repeated(:), i
      integer(int64) :: k

      place = i
      if (i == 0) return
      do k = 1, size(repeated, kind=int64)
         if (repeated(k) > place) exit
         place = place + 1
      end do
   end function place_with

end module gyroakf_io_repeats
