! SPDX-License-Identifier: MIT
!> Tests of sorting.
module test_sort
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_sort, only : sort_values
   use series_library, only : reference_series
   use expectations, only : check
   use testdrive, only : error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_sort

contains

   subroutine collect_sort(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [new_unittest("lengths", test_lengths), new_unittest("orders", test_orders), new_unittest("long", test_long)]
   end subroutine collect_sort

   !> Sorts, and looks whether the result ascends and holds the same numbers (integers: their sums of powers are exact).
   subroutine sort_and_check(x, name, error)
      !> Integers of at most 1e5
      real(dp), intent(inout), contiguous :: x(:)
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: problem
      real(dp) :: sums(2)

      sums = [sum(x), sum(x*x)]
      call sort_values(x, problem)
      call check(error, .not. allocated(problem), name//" failed")
      if (allocated(error)) return
      call check(error, all(x(2:) >= x(:size(x) - 1)), name//" is not sorted")
      if (allocated(error)) return
      call check(error, maxval(abs([sum(x), sum(x*x)] - sums)) <= 0.0_dp, name//" has lost numbers")
   end subroutine sort_and_check

   !> 0 to 200 numbers, odd remainders at every level.
   subroutine test_lengths(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: x(:)
      integer :: n, i
      character(16) :: name

      do n = 1, 200
         x = [(real(mod(i*i*17, 31), dp), i=1, n)]
         write (name, '("length ", i0)') n
         call sort_and_check(x, trim(name), error)
         if (allocated(error)) return
      end do
      x = x(:0)
      call sort_and_check(x, "nothing", error)
   end subroutine test_lengths

   !> Ascending, descending, equal numbers.
   subroutine test_orders(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x(1000)
      integer :: i

      x = [(real(i, dp), i=1, 1000)]
      call sort_and_check(x, "ascending", error)
      if (allocated(error)) return
      x = [(real(-i, dp), i=1, 1000)]
      call sort_and_check(x, "descending", error)
      if (allocated(error)) return
      x = 3.0_dp
      call sort_and_check(x, "equal", error)
   end subroutine test_orders

   !> 100,003 numbers, by all threads.
   subroutine test_long(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: x(:)

      x = aint(1.0e5_dp*reference_series("unif", 100003))
      call sort_and_check(x, "long", error)
   end subroutine test_long

end module test_sort
