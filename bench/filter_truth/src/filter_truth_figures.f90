! SPDX-License-Identifier: MIT
!> Medians, errors, moving averages, and lines of Markdown tables.
module filter_truth_figures
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf, only : dp
   use gyroakf_kinds, only : int8
   implicit none (type, external)
   private
   public :: median, quantile, root_mean_square, moving_averages, table_head, table_row

contains

   !> The median of some numbers, not one of which is NaN.
   pure real(dp) function median(values)
      real(dp), intent(in) :: values(:)
      real(dp) :: sorted(size(values))
      integer :: n

      n = size(values)
      sorted = in_order(values)
      median = 0.5_dp*(sorted((n + 1)/2) + sorted(n/2 + 1))
   end function median

   !> The number that this share of them does not exceed.
   pure real(dp) function quantile(values, share)
      real(dp), intent(in) :: values(:), share
      real(dp) :: sorted(size(values))

      sorted = in_order(values)
      quantile = sorted(min(size(values), max(1, ceiling(share*size(values)))))
   end function quantile

   !> Sorted by insertion.
   pure function in_order(values) result(sorted)
      real(dp), intent(in) :: values(:)
      real(dp) :: sorted(size(values)), now
      integer :: i, j

      sorted = values
      do i = 2, size(values)
         now = sorted(i)
         do j = i - 1, 1, -1
            if (sorted(j) <= now) exit
            sorted(j + 1) = sorted(j)
         end do
         sorted(j + 1) = now
      end do
   end function in_order

   !> Root of the mean squared difference.
   pure real(dp) function root_mean_square(x, truth)
      real(dp), intent(in) :: x(:), truth(:)

      root_mean_square = sqrt(sum((x - truth)**2)/size(x))
   end function root_mean_square

   !> Means of the samples present in windows that end at, or lie about, each sample; cut off at the ends of the record.
   subroutine moving_averages(z, here, length, causal, centered)
      real(dp), intent(in), contiguous :: z(:)
      !> 1 present, 0 missing
      integer(int8), intent(in), contiguous :: here(:)
      integer, intent(in) :: length
      real(dp), intent(out), contiguous :: causal(:), centered(:)
      real(dp), allocatable :: total(:)
      real(dp) :: last_mean
      integer, allocatable :: count(:)
      integer :: k, n, first, last

      n = size(z)
      allocate (total(0:n), count(0:n))
      total(0) = 0.0_dp
      count(0) = 0
      do k = 1, n
         total(k) = total(k - 1) + merge(z(k), 0.0_dp, here(k) /= 0_int8)
         count(k) = count(k - 1) + here(k)
      end do
      last_mean = 0.0_dp
      do k = 1, n
         first = max(0, k - length)
         if (count(k) > count(first)) last_mean = (total(k) - total(first))/(count(k) - count(first))
         causal(k) = last_mean
         first = max(0, k - (length + 1)/2)
         last = min(n, first + length)
         if (k - (length + 1)/2 < 0) last = min(n, k + length/2)
         if (count(last) > count(first)) then
            centered(k) = (total(last) - total(first))/(count(last) - count(first))
         else
            centered(k) = causal(k)
         end if
      end do
   end subroutine moving_averages

   !> Head of a table.
   subroutine table_head(corner, columns)
      character(*), intent(in) :: corner, columns(:)
      integer :: i

      write (output_unit, "(*(a))") "| ", trim(corner), (" | ", trim(columns(i)), i=1, size(columns)), " |"
      write (output_unit, "(*(a))") "|---", ("|---:", i=1, size(columns)), "|"
   end subroutine table_head

   !> A row of it.
   subroutine table_row(name, cells)
      character(*), intent(in) :: name, cells(:)
      integer :: i

      write (output_unit, "(*(a))") "| ", trim(name), (" | ", trim(adjustl(cells(i))), i=1, size(cells)), " |"
      flush (output_unit)
   end subroutine table_row
end module filter_truth_figures
