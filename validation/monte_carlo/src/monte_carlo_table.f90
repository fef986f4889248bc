! SPDX-License-Identifier: MIT
!> Tables of estimates beside their truth: bias, scatter, stated errors, coverage of the intervals; and series to estimate from.
module monte_carlo_table
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf, only : dp, fill_normal, int64, next_normal, random_type
   implicit none (type, external)
   private
   public :: argument_or, percent, estimate_head, estimate_row, fixed, first_order

   !> Half widths of the intervals in standard errors: 68.3 % and 95 % of a normal distribution
   real(dp), parameter :: half_width(2) = [1.0006418_dp, 1.959963984540054_dp]

contains

   !> The number of records that the caller asked for, or this one.
   integer function argument_or(default) result(number)
      integer, intent(in) :: default
      character(20) :: word

      number = default
      if (command_argument_count() == 0) return
      call get_command_argument(1, word)
      read (word, *) number
   end function argument_or

   !> Share of true values in percent; 0 of none.
   pure real(dp) function percent(flags)
      logical, intent(in) :: flags(:)

      percent = 100*count(flags)/real(max(1, size(flags)), dp)
   end function percent

   !> Digits behind the point, right-justified.
   pure function fixed(value, digits) result(text)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      character(8) :: text
      character(12) :: form

      write (form, '("(f8.", i0, ")")') digits
      write (text, form) value
   end function fixed

   !> Head of the rows of [[estimate_row]]; `further` are titles of columns behind them, "" or "a | b |".
   subroutine estimate_head(further)
      character(*), intent(in) :: further
      integer :: k

      write (output_unit, "(/, a)") trim("| of | truth | bias % | +- | scatter % | stated/true error | in 68.3 % | in 95 % | " &
         & //further)
      write (output_unit, "(*(a))") "|---|", ("--:|", k=2, 8 + count([(further(k:k) == "|", k=1, len(further))]))
   end subroutine estimate_head

   !> A row: bias and its standard error, scatter, root mean square of the stated errors over it, coverage of value +- z errors.
   subroutine estimate_row(name, truth, value, error, further)
      character(*), intent(in) :: name
      real(dp), intent(in) :: truth
      !> Estimates and their stated standard errors: [records]
      real(dp), intent(in) :: value(:), error(:)
      !> Cells behind them
      character(*), intent(in) :: further
      real(dp) :: mean, scatter, unit, n
      character(8) :: cover(2)
      integer :: k

      n = size(value)
      if (size(value) < 2) then
         write (output_unit, "(a, es10.3, a)") "| "//name//" | ", truth, trim(" | - | - | - | - | - | - | "//further)
         return
      end if
      unit = abs(truth)/100
      mean = sum(value)/n
      scatter = sqrt(sum((value - mean)**2)/(n - 1))
      do k = 1, 2
         cover(k) = fixed(percent(abs(value - truth) <= half_width(k)*error), 1)
      end do
      write (output_unit, "(a, es10.3, *(a))") "| "//name//" | ", truth, " |", fixed((mean - truth)/unit, 2), " |", &
         & fixed(scatter/unit/sqrt(n), 2), " |", fixed(scatter/unit, 2), " |", fixed(sqrt(sum(error**2)/n)/scatter, 3), " |", &
         & cover(1), " |", cover(2), trim(" | "//further)
   end subroutine estimate_row

   !> A series x_k = phi x_(k-1) + w_k: stationary from the start, or from 0 where phi is 1.
   subroutine first_order(random, phi, q, x)
      !> The generator
      type(random_type), intent(inout) :: random
      !> Coefficient, variance of w
      real(dp), intent(in) :: phi, q
      !> The series: [n]
      real(dp), intent(out), contiguous :: x(:)
      real(dp) :: start
      integer(int64) :: k

      call next_normal(random, start)
      call fill_normal(random, x)
      x = sqrt(q)*x
      if (phi < 1.0_dp) x(1) = start*sqrt(q/(1 - phi**2))
      do k = 2, size(x, kind=int64)
         x(k) = x(k) + phi*x(k - 1)
      end do
   end subroutine first_order

end module monte_carlo_table
