! SPDX-License-Identifier: MIT
!> How often samples come: the step of the stamps, the resolution of their clock, where the rate changes.
!>
!> Everything here is told by medians, so that lost samples, late ones and bursts do not move it.
module gyroakf_io_cadence
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: cadence_type, find_cadence, find_changes, sort, median_of

   !> How samples come
   type :: cadence_type
      !> s from sample to sample where none is lost; 0 where the stamps do not rise
      real(dp) :: step = 0.0_dp
      !> Smallest difference between two steps, s: the stamps count in it; 0 where it is below 1e-4 of the step
      real(dp) :: resolution = 0.0_dp
      !> Almost all steps are near their median, or whole multiples of it: one lost sample is seen at its place
      logical :: regular = .false.
   end type cadence_type

   !> Steps looked at
   integer, parameter :: looked_at = 4001
   !> Parts of a record that are compared with each other, and samples of the shortest
   integer(int64), parameter :: most_parts = 128, shortest_part = 64

contains

   !> The cadence of a series of stamps.
   subroutine find_cadence(t, cadence)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> The cadence
      type(cadence_type), intent(out) :: cadence
      real(dp) :: step(looked_at), median, total
      integer(int64) :: i, n, near, forward
      integer :: k, m

      n = size(t, kind=int64)
      if (n < 2) return
      m = int(min(int(looked_at, int64), n - 1))
      do k = 1, m
         i = 2 + (int(k - 1, int64)*(n - 2))/max(m - 1, 1)
         step(k) = t(i) - t(i - 1)
      end do
      call sort(step(:m))
      median = step((m + 1)/2)
      total = 0.0_dp
      forward = 0
      do i = 2, n
         if (t(i) < t(i - 1)) cycle
         total = total + (t(i) - t(i - 1))
         forward = forward + 1
      end do
      if (total <= 0.0_dp) return
      cadence%step = total/real(forward, dp)
      cadence%resolution = smallest_difference(step(:m), 1.0e-4_dp*max(median, 0.1_dp*cadence%step))
      cadence%regular = is_regular(step(:m), median, cadence%resolution)
      if (.not. cadence%regular) return
      total = 0.0_dp
      near = 0
      do i = 2, n
         if (t(i) - t(i - 1) < 0.5_dp*median .or. t(i) - t(i - 1) > 1.5_dp*median) cycle
         total = total + (t(i) - t(i - 1))
         near = near + 1
      end do
      if (near > 0) cadence%step = total/real(near, dp)
   end subroutine find_cadence

   !> The smallest difference between values, or between them and 0, that is more than rounding; the value itself where all are
   !> the same.
   pure real(dp) function smallest_difference(step, rounding)
      !> In order
      real(dp), intent(in) :: step(:)
      real(dp), intent(in) :: rounding
      real(dp) :: last
      integer :: k

      smallest_difference = huge(1.0_dp)
      last = 0.0_dp
      do k = 1, size(step)
         if (step(k) <= 0.0_dp) cycle
         if (step(k) - last > rounding) smallest_difference = min(smallest_difference, step(k) - last)
         last = step(k)
      end do
      if (smallest_difference >= huge(1.0_dp)) smallest_difference = 0.0_dp
   end function smallest_difference

   !> True where almost all steps are near the median, or most are, none is far below it and almost all are whole multiples of
   !> it: samples of an even grid, some of them lost. (Short steps as well are those of late samples and a coarse clock: where
   !> the clock counts in more than 0.3 of the step, short and long ones must not be more than 0.2 %. Where most of the time
   !> passes in long steps, samples come in bursts.)
   pure logical function is_regular(step, median, resolution)
      real(dp), intent(in) :: step(:), median, resolution
      integer :: k, near, whole, short, long
      real(dp) :: near_time, other_time

      is_regular = .false.
      if (median <= 0.0_dp) return
      near = 0
      whole = 0
      short = count(step <= 0.5_dp*median)
      long = count(step >= 1.5_dp*median)
      near_time = 0.0_dp
      other_time = 0.0_dp
      do k = 1, size(step)
         if (step(k) <= 0.5_dp*median) cycle
         if (step(k) < 1.5_dp*median) then
            near = near + 1
            near_time = near_time + step(k)
         else
            other_time = other_time + min(step(k), 100.0_dp*median)
         end if
         if (abs(step(k)/median - anint(step(k)/median)) <= 0.25_dp) whole = whole + 1
      end do
      is_regular = 100*near >= 97*size(step) .or. &
                   (100*near >= 80*size(step) .and. 100*whole >= 97*size(step) .and. short == 0)
      if (other_time > near_time) is_regular = .false.
      if (500*min(short, long) > size(step) .and. resolution > 0.3_dp*median) is_regular = .false.
   end function is_regular

   !> Where the rate changes for good: by more than 0.5 % and than the rates of the parts of the record scatter.
   subroutine find_changes(t, change, steps, count_changes)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> The first sample of each new rate: [at most]
      integer(int64), intent(out) :: change(:)
      !> s from sample to sample before the first change, and behind each: [at most + 1]
      real(dp), intent(out) :: steps(:)
      !> How many
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
         part(k) = step_of_part(t((k - 1)*length + 1:k*length))
      end do
      if (minval(part(:parts)) <= 0.0_dp) return
      ends(0) = 0
      ends(1) = parts
      call divide(part(:parts), ends, count_changes, size(change))
      do k = 0, count_changes
         steps(k + 1) = median_of(part(ends(k) + 1:ends(k + 1)))
      end do
      do k = 1, count_changes
         change(k) = corner(t, max(1_int64, (ends(k) - 2)*length), min(n, (ends(k) + 2)*length), 0.5_dp*(steps(k) + steps(k + 1)), &
                            steps(k + 1) < steps(k))
      end do
   end subroutine find_changes

   !> The step within a part: the mean of those near their median where most are, else the median of eight slopes.
   real(dp) function step_of_part(t) result(step)
      real(dp), intent(in), contiguous :: t(:)
      real(dp) :: change(257), slope(8), median, total, mean(9)
      integer(int64) :: n, i, piece
      integer :: k, m, near

      n = size(t, kind=int64)
      m = int(min(257_int64, n - 1))
      do k = 1, m
         i = 2 + (int(k - 1, int64)*(n - 2))/max(m - 1, 1)
         change(k) = t(i) - t(i - 1)
      end do
      call sort(change(:m))
      median = change((m + 1)/2)
      if (median > 0.0_dp) then
         total = 0.0_dp
         near = 0
         do k = 1, m
            if (abs(change(k) - median) > 0.3_dp*median) cycle
            total = total + change(k)
            near = near + 1
         end do
         step = total/near
         if (100*near >= 85*m) return
      end if
      piece = n/9
      do k = 1, 9
         mean(k) = sum(t((k - 1)*piece + 1:k*piece) - t(1))/real(piece, dp)
      end do
      slope = (mean(2:) - mean(:8))/real(piece, dp)
      call sort(slope)
      step = 0.5_dp*(slope(4) + slope(5))
   end function step_of_part

   !> Divides the parts where their medians differ most, again and again.
   subroutine divide(part, ends, changes, most)
      real(dp), intent(in) :: part(:)
      !> The last part of each stretch: [0:]
      integer, intent(inout) :: ends(0:)
      integer, intent(inout) :: changes
      integer, intent(in) :: most
      integer :: stretch, at, k
      logical :: found

      do while (changes < most)
         found = .false.
         do stretch = 0, changes
            call best_division(part(ends(stretch) + 1:ends(stretch + 1)), at)
            if (at == 0) cycle
            found = .true.
            do k = changes + 1, stretch + 1, -1
               ends(k + 1) = ends(k)
            end do
            ends(stretch + 1) = ends(stretch) + at
            changes = changes + 1
            exit
         end do
         if (.not. found) exit
      end do
   end subroutine divide

   !> The last part before the change, 0 where there is none: both sides' medians differ by more than 0.5 % and six times the
   !> scatter of either side, and the sides overlap in no more than an eighth of their parts.
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
         wrong = count((part(:k) > middle) .neqv. (left > middle)) + count((part(k + 1:) > middle) .neqv. (right > middle))
         if (wrong > n/8) cycle
         score = 2.0_dp + abs(right - left)/middle - real(wrong, dp)
         if (at > 0 .and. score <= best) cycle
         best = score
         at = k
      end do
   end subroutine best_division

   !> The first sample behind a bend of the stamps between two samples: where their distance from the mean slope is extreme.
   pure integer(int64) function corner(t, first, last, step, faster)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: first, last
      real(dp), intent(in) :: step
      !> The step falls there
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

   !> The middle value of a short list.
   real(dp) function median_of(x)
      !> At least one
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x))

      y = x
      call sort(y)
      median_of = 0.5_dp*(y((size(x) + 1)/2) + y(size(x)/2 + 1))
   end function median_of

   !> Sorts a short list.
   pure subroutine sort(x)
      !> Ascending afterwards
      real(dp), intent(inout) :: x(:)
      integer :: gap, i, j
      real(dp) :: held

      gap = size(x)/2
      do while (gap > 0)
         do i = gap + 1, size(x)
            held = x(i)
            j = i
            do while (j > gap)
               if (x(j - gap) <= held) exit
               x(j) = x(j - gap)
               j = j - gap
            end do
            x(j) = held
         end do
         gap = gap/2
      end do
   end subroutine sort

end module gyroakf_io_cadence
