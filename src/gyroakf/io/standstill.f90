! SPDX-License-Identifier: MIT
!> A sensor that hung, or a file that was filled up: rows that stay the same for too long.
module gyroakf_io_standstill
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: find_still

   !> Fewest samples of a stretch; its length over that of the next longest one, and over that which
   !> chance explains
   integer(int64), parameter :: least_still = 20, next_factor = 2
   real(dp), parameter :: chance_factor = 5.0_dp
   !> Rows of a block
   integer(int64), parameter :: block = 2048

contains

   !> The longest stretch in which no channel changes, where neither chance nor slow changes explain
   !> it.
   !>
   !> Where a row equals the one before it with the probability p, the longest run of n rows is
   !> log(n (1 - p))/log(1/p) about (Feller, An Introduction to Probability Theory, vol. 1, XIII.7):
   !> a coarse sensor repeats its values, too; one whose rate is slow does so in other places as
   !> long.
   subroutine find_still(value, present_mask, still)
      !> [sample, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> [sample, channel] 1 present, 0 missing; unallocated where nothing is missing
      integer(int8), allocatable, intent(in) :: present_mask(:, :)
      !> Its first and last sample, 0 where there is none
      integer(int64), intent(out) :: still(2)
      real(dp) :: share
      integer(int64) :: i, first, n, equal, run, longest, next, last

      still = 0
      n = size(value, 1, kind=int64)
      equal = 0
      run = 1
      longest = 0
      next = 0
      last = 0
      do first = 2, n, block
         if (changes(first, min(n, first + block - 1))) then
            call end_run(first - 1)
            cycle
         end if
         do i = first, min(n, first + block - 1)
            if (is_repeated(i)) then
               equal = equal + 1
               run = run + 1
            else
               call end_run(i - 1)
            end if
         end do
      end do
      call end_run(n)
      if (longest < max(least_still, next_factor*next) .or. longest == n) return
      share = max(1.0_dp, real(equal - longest + 1, dp))/real(n - longest, dp)
      if (share >= 1.0_dp) return
      if (longest < chance_factor*log(real(n, dp)*(1.0_dp - share))/(-log(share))) return
      still = [last - longest + 1, last]

   contains

      !> A stretch of equal rows ends.
      subroutine end_run(at)
         integer(int64), intent(in) :: at

         next = max(next, min(run, longest))
         if (run > longest) last = at
         longest = max(longest, run)
         run = 1
      end subroutine end_run

      !> Whether a channel changes from each row to the next.
      pure logical function changes(from, to)
         integer(int64), intent(in) :: from, to
         integer :: j

         changes = .false.
         do j = 1, size(value, 2)
            changes = minval(abs(value(from:to, j) - value(from - 1:to - 1, j))) > 0.0_dp
            if (changes) return
         end do
      end function changes

      !> Whether a row is there and equals the one before.
      pure logical function is_repeated(i)
         integer(int64), intent(in) :: i
         integer :: j

         is_repeated = .true.
         do j = 1, size(value, 2)
            is_repeated = .not. abs(value(i, j) - value(i - 1, j)) > 0.0_dp
            if (.not. is_repeated) return
         end do
         if (allocated(present_mask)) is_repeated = &
            any(present_mask(i, :) == 1_int8) .and. any(present_mask(i - 1, :) == 1_int8)
      end function is_repeated

   end subroutine find_still

end module gyroakf_io_standstill
