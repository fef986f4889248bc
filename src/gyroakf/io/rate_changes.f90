! SPDX-License-Identifier: MIT
!> Where the sample rate changes for good: by 0.5 % and more than the rates of the parts scatter.
module gyroakf_io_rate_changes
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type, find_sample_interval, steps_type
   use gyroakf_sort, only : median_of
   implicit none (type, external)
   private
   public :: find_changes

   !> Parts of a record that are compared with each other, and samples of the shortest
   integer(int64), parameter :: most_parts = 128, shortest_part = 64
   !> Samples of a part that are looked at
   integer(int64), parameter :: longest_look = 1024

contains

   !> Where the rate changes for good: by more than 0.5 % and more than its parts scatter.
   subroutine find_changes(t, work, change, steps, count_changes)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      type(steps_type), intent(inout) :: work
      !> The first sample of each new rate: [at most]
      integer(int64), intent(out) :: change(:)
      !> s from sample to sample before the first change, and behind each: [at most + 1]
      real(dp), intent(out) :: steps(:)
      integer, intent(out) :: count_changes
      real(dp) :: part(most_parts)
      integer :: ends(0:size(change) + 1), parts, k
      integer(int64) :: n, length

      n = size(t, kind=int64)
      change = 0
      steps = 0.0_dp
      count_changes = 0
      parts = int(min(most_parts, n/shortest_part))
      if (parts < 8) return
      length = n/parts
      do k = 1, parts
         call find_part_step(t((k - 1)*length + 1:k*length), work, part(k))
      end do
      if (minval(part(:parts)) <= 0.0_dp) return
      ends(0) = 0
      ends(1) = parts
      call divide(part(:parts), ends, count_changes, size(change))
      do k = 0, count_changes
         steps(k + 1) = median_of(part(ends(k) + 1:ends(k + 1)))
      end do
      do k = 1, count_changes
         change(k) = corner(t, max(1_int64, (ends(k) - 2)*length), min(n, (ends(k) + 2)*length), &
            0.5_dp*(steps(k) + steps(k + 1)), steps(k + 1) < steps(k))
      end do
   end subroutine find_changes

   !> The step within a part: that of its cadence, looked for in some of its samples that follow one
   !> another; where they are not regular, the median of eight slopes.
   subroutine find_part_step(t, work, step)
      real(dp), intent(in), contiguous :: t(:)
      type(steps_type), intent(inout) :: work
      real(dp), intent(out) :: step
      real(dp) :: slope(8), mean(9)
      type(cadence_type) :: cadence
      integer(int64) :: n, first, piece
      integer :: k

      n = size(t, kind=int64)
      first = 1 + max(0_int64, (n - longest_look)/2)
      call find_sample_interval(t(first:min(n, first + longest_look - 1)), work, cadence)
      step = cadence%step
      if (cadence%regular) return
      piece = n/9
      do k = 1, 9
         mean(k) = sum(t((k - 1)*piece + 1:k*piece) - t(1))/real(piece, dp)
      end do
      slope = (mean(2:) - mean(:8))/real(piece, dp)
      step = median_of(slope)
   end subroutine find_part_step

   !> Divides the parts where their medians differ most, again and again.
   subroutine divide(part, ends, changes, most)
      real(dp), intent(in) :: part(:)
      integer, intent(inout) :: ends(0:), changes
      integer, intent(in) :: most
      integer :: stretch, at

      do while (changes < most)
         do stretch = 0, changes
            call best_division(part(ends(stretch) + 1:ends(stretch + 1)), at)
            if (at > 0) exit
         end do
         if (at == 0) exit
         ends(stretch + 2:changes + 2) = ends(stretch + 1:changes + 1)
         ends(stretch + 1) = ends(stretch) + at
         changes = changes + 1
      end do
   end subroutine divide

   !> The last part before the change, 0 where there is none: both sides' medians differ by more
   !> than 0.5 % and six times the scatter of either side, and the sides overlap in no more than an
   !> eighth of their parts.
   subroutine best_division(part, at)
      real(dp), intent(in) :: part(:)
      integer, intent(out) :: at
      integer, parameter :: least = 3
      real(dp) :: left, right, spread, best, score, middle
      integer :: k, n, wrong

      at = 0
      n = size(part)
      if (n < 2*least) return
      if (maxval(part) - minval(part) <= 0.005_dp*minval(part)) return
      best = 1.0_dp
      do k = least, n - least
         left = median_of(part(:k))
         right = median_of(part(k + 1:))
         if (abs(right - left) <= 0.005_dp*min(left, right)) cycle
         spread = 1.5_dp*max(median_of(abs(part(:k) - left)), median_of(abs(part(k + 1:) - right)))
         if (abs(right - left) <= 6.0_dp*spread) cycle
         middle = 0.5_dp*(left + right)
         wrong = count((part(:k) > middle) .neqv. (left > middle)) + &
            count((part(k + 1:) > middle) .neqv. (right > middle))
         if (wrong > n/8) cycle
         score = 2.0_dp + abs(right - left)/middle - real(wrong, dp)
         if (at > 0 .and. score <= best) cycle
         best = score
         at = k
      end do
   end subroutine best_division

   !> The first sample behind a bend of the stamps: where they are farthest from the mean slope.
   pure integer(int64) function corner(t, first, last, step, faster)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: first, last
      real(dp), intent(in) :: step
      logical, intent(in) :: faster
      integer(int64) :: i
      real(dp) :: distance, extreme

      corner = first
      extreme = -huge(1.0_dp)
      do i = first, last
         distance = (t(i) - t(first)) - real(i - first, dp)*step
         if (.not. faster) distance = -distance
         if (distance <= extreme) cycle
         extreme = distance
         corner = i
      end do
      corner = min(corner + 1, last)
   end function corner

end module gyroakf_io_rate_changes
