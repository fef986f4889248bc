! SPDX-License-Identifier: MIT
!> Tests of sorting.
module test_sort
   use gyroakf_kinds, only : dp
   use gyroakf_sort, only : sort_values
   use series_library, only : reference_series
   use expectations, only : unmet, problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_sort

contains

   subroutine suite_sort()
      call test("lengths", test_lengths)
      call test("orders", test_orders)
      call test("long", test_long)
   end subroutine suite_sort

   !> Sorts, and looks whether the result ascends and holds the same numbers (integers: their sums of powers are exact).
   subroutine sort_and_check(x, name)
      !> Integers of at most 1e5
      real(dp), intent(inout), contiguous :: x(:)
      character(*), intent(in) :: name
      real(dp) :: sums(2)

      sums = [sum(x), sum(x*x)]
      call sort_values(x, problem)
      if (went_wrong(problem, name//" failed")) return
      if (unmet(all(x(2:) >= x(:size(x) - 1)), name//" is not sorted")) return
      call check(error, maxval(abs([sum(x), sum(x*x)] - sums)) <= 0.0_dp, name//" has lost numbers")
   end subroutine sort_and_check

   !> 0 to 200 numbers, odd remainders at every level.
   subroutine test_lengths()
      real(dp), allocatable :: x(:)
      integer :: n, i
      character(16) :: name

      do n = 1, 200
         x = [(real(mod(i*i*17, 31), dp), i=1, n)]
         write (name, '("length ", i0)') n
         call sort_and_check(x, trim(name))
         if (allocated(error)) return
      end do
      x = x(:0)
      call sort_and_check(x, "nothing")
   end subroutine test_lengths

   !> Ascending, descending, equal numbers.
   subroutine test_orders()
      real(dp) :: x(1000)
      integer :: i

      x = [(real(i, dp), i=1, 1000)]
      call sort_and_check(x, "ascending")
      x = [(real(-i, dp), i=1, 1000)]
      call sort_and_check(x, "descending")
      x = 3.0_dp
      call sort_and_check(x, "equal")
   end subroutine test_orders

   !> 100,003 numbers, by all threads.
   subroutine test_long()
      real(dp), allocatable :: x(:)

      x = aint(1.0e5_dp*reference_series("unif", 100003))
      call sort_and_check(x, "long")
   end subroutine test_long

end module test_sort
