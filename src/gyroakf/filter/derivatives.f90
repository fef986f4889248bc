! SPDX-License-Identifier: MIT
!> Numbers that stand with their derivatives by the parameters of a drift model, the value first,
!> and small matrices of them: (0:last_lane, row, column).
module gyroakf_filter_derivatives
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_components, only : most_components
   implicit none (type, external)
   private
   public :: last_lane, product_of, quotient, logarithm, multiply, raise, solve

   !> Of the value and its derivatives by phi and q of each of n processes and by r:
   !> 0, 1 .. n, n + 1 .. 2 n, 2 n + 1
   integer, parameter :: last_lane = 2*most_components + 1

contains

   !> a b
   pure function product_of(a, b) result(c)
      real(dp), intent(in) :: a(0:last_lane), b(0:last_lane)
      real(dp) :: c(0:last_lane)

      c = a(0)*b + b(0)*a
      c(0) = a(0)*b(0)
   end function product_of

   !> a/b
   pure function quotient(a, b) result(c)
      real(dp), intent(in) :: a(0:last_lane), b(0:last_lane)
      real(dp) :: c(0:last_lane)

      c = (a - (a(0)/b(0))*b)/b(0)
      c(0) = a(0)/b(0)
   end function quotient

   !> ln |a|
   pure function logarithm(a) result(c)
      real(dp), intent(in) :: a(0:last_lane)
      real(dp) :: c(0:last_lane)

      c = a/a(0)
      c(0) = log(abs(a(0)))
   end function logarithm

   !> c = a b, of n rows and columns
   pure subroutine multiply(n, a, b, c)
      integer, intent(in) :: n
      real(dp), dimension(0:last_lane, most_components, most_components), intent(in) :: a, b
      real(dp), dimension(0:last_lane, most_components, most_components), intent(out) :: c
      integer :: i, j, k

      c = 0.0_dp
      do j = 1, n
         do k = 1, n
            do i = 1, n
               c(:, i, j) = c(:, i, j) + product_of(a(:, i, k), b(:, k, j))
            end do
         end do
      end do
   end subroutine multiply

   !> A power of a matrix of n rows and columns.
   pure recursive subroutine raise(n, a, exponent, power)
      integer, intent(in) :: n
      real(dp), intent(in) :: a(0:last_lane, most_components, most_components)
      !> >= 1
      integer(int64), intent(in) :: exponent
      real(dp), intent(out) :: power(0:last_lane, most_components, most_components)
      real(dp), dimension(0:last_lane, most_components, most_components) :: root, square

      power = a
      if (exponent == 1) return
      call raise(n, a, exponent/2, root)
      call multiply(n, root, root, power)
      if (mod(exponent, 2_int64) == 0) return
      square = power
      call multiply(n, square, a, power)
   end subroutine raise

   !> Solves a x = b of n rows by elimination, and adds ln |det a|.
   pure subroutine solve(n, a, b, log_determinant)
      integer, intent(in) :: n
      !> Spent afterwards
      real(dp), intent(inout) :: a(0:last_lane, most_components, most_components)
      !> The solution afterwards
      real(dp), intent(inout) :: b(0:last_lane, most_components, most_components)
      real(dp), intent(inout) :: log_determinant(0:last_lane)
      real(dp) :: factor(0:last_lane), pivot(0:last_lane)
      integer :: i, j, k

      do k = 1, n
         i = k - 1 + maxloc(abs(a(0, k:n, k)), 1)
         a(:, [i, k], :) = a(:, [k, i], :)
         b(:, [i, k], :) = b(:, [k, i], :)
         log_determinant = log_determinant + logarithm(a(:, k, k))
         pivot = a(:, k, k)
         do j = 1, n
            a(:, k, j) = quotient(a(:, k, j), pivot)
            b(:, k, j) = quotient(b(:, k, j), pivot)
         end do
         do i = 1, n
            if (i == k) cycle
            factor = a(:, i, k)
            do j = 1, n
               a(:, i, j) = a(:, i, j) - product_of(factor, a(:, k, j))
               b(:, i, j) = b(:, i, j) - product_of(factor, b(:, k, j))
            end do
         end do
      end do
   end subroutine solve

end module gyroakf_filter_derivatives
