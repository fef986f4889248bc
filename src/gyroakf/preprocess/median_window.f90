! SPDX-License-Identifier: MIT
!> A window of values kept in order: its median, and the median distance from it, exactly.
!>
!> A value that leaves and one that enters cost two binary searches and one shift of what lies
!> between them; the shift moves eight bytes a value at the speed of memory, which up to some
!> thousand values is cheaper than any tree.
module gyroakf_preprocess_median_window
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: window_type, insert_value, remove_value, replace_value, window_median, window_deviation

   !> The values, ascending
   type :: window_type
      !> How many there are
      integer :: count = 0
      !> The values, then unused elements: [capacity]; allocated by the caller
      real(dp), allocatable :: value(:)
   end type window_type

contains

   !> Inserts a value; the window must not be full.
   pure subroutine insert_value(window, x)
      type(window_type), intent(inout) :: window
      real(dp), intent(in) :: x
      integer :: i, place

      place = count_below(window, x)
      do i = window%count, place + 1, -1
         window%value(i + 1) = window%value(i)
      end do
      window%value(place + 1) = x
      window%count = window%count + 1
   end subroutine insert_value

   !> Takes a value out.
   pure subroutine remove_value(window, x)
      type(window_type), intent(inout) :: window
      real(dp), intent(in) :: x
      integer :: i

      do i = count_below(window, x) + 1, window%count - 1
         window%value(i) = window%value(i + 1)
      end do
      window%count = window%count - 1
   end subroutine remove_value

   !> Takes a value out and puts another one in.
   pure subroutine replace_value(window, old, new)
      type(window_type), intent(inout) :: window
      real(dp), intent(in) :: old, new
      integer :: i, from, to

      from = count_below(window, old) + 1
      to = count_below(window, new)
      if (to >= from) then
         do i = from, to - 1
            window%value(i) = window%value(i + 1)
         end do
         window%value(to) = new
      else
         do i = from, to + 2, -1
            window%value(i) = window%value(i - 1)
         end do
         window%value(to + 1) = new
      end if
   end subroutine replace_value

   !> How many values are smaller.
   pure integer function count_below(window, x)
      type(window_type), intent(in) :: window
      real(dp), intent(in) :: x
      integer :: rest, half

      count_below = 0
      rest = window%count
      do while (rest > 0)
         half = (rest + 1)/2
         if (window%value(count_below + half) < x) then
            count_below = count_below + half
            rest = rest - half
         else
            rest = half - 1
         end if
      end do
   end function count_below

   !> Median; the mean of the two middle values for an even number.
   pure real(dp) function window_median(window)
      type(window_type), intent(in) :: window
      integer :: middle

      middle = (window%count + 1)/2
      window_median = window%value(middle)
      if (mod(window%count, 2) == 0) window_median = 0.5_dp*window_median &
         & + 0.5_dp*window%value(middle + 1)
   end function window_median

   !> Median of the distances from the median.
   !>
   !> The distances of the lower half, from the middle outwards, and those of the upper half are two
   !> ascending lists; how many of the smaller half of all distances come from the lower list is
   !> found by bisection.
   pure real(dp) function window_deviation(window, median)
      type(window_type), intent(in) :: window
      real(dp), intent(in) :: median
      integer :: lower, wanted, least, most, taken
      real(dp) :: next

      lower = (window%count + 1)/2
      wanted = lower
      least = max(0, wanted - (window%count - lower))
      most = wanted
      do while (least < most)
         taken = (least + most)/2
         if (median - window%value(lower - taken) < window%value(lower + wanted - taken) - median) &
            & then
            least = taken + 1
         else
            most = taken
         end if
      end do
      window_deviation = 0.0_dp
      if (least > 0) window_deviation = median - window%value(lower + 1 - least)
      if (wanted > least) window_deviation = max(window_deviation, &
         & window%value(lower + wanted - least) - median)
      if (mod(window%count, 2) == 1) return
      next = huge(next)
      if (least < lower) next = median - window%value(lower - least)
      if (wanted - least < window%count - lower) &
         & next = min(next, window%value(lower + wanted - least + 1) - median)
      window_deviation = 0.5_dp*window_deviation + 0.5_dp*next
   end function window_deviation

end module gyroakf_preprocess_median_window
