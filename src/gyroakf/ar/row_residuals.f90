! SPDX-License-Identifier: MIT
!> Products of an AR model's residuals with the lags, over the complete rows: what the normal equations lose in digits they
!> give back, for a residual is small where its prediction is good.
module gyroakf_ar_row_residuals
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last, chunk_group
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_stats_autocovariance, only : add_lagged_products
   use gyroakf_ar_complete_rows, only : load_rows
   implicit none (type, external)
   private
   public :: residual_sums_type, sum_residuals

   !> Sums of the residuals e_t = x_t - sum phi_j x_(t-j)
   type :: residual_sums_type
      !> sum e^2, sum e
      real(dp) :: square = 0.0_dp, total = 0.0_dp
      !> sum e_t x_(t-j): [0:p]
      real(dp), allocatable :: product(:)
   end type residual_sums_type

contains

   !> Sums of the residuals of given coefficients over the complete rows of their order.
   subroutine sum_residuals(x, shift, rest, phi, constant, sums, error, valid, progress)
      !> Series: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted in turn; constant of the regression of what is left
      real(dp), intent(in) :: shift, rest, constant
      !> Coefficients: [p]
      real(dp), intent(in) :: phi(:)
      !> The sums
      type(residual_sums_type), intent(out) :: sums
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: partial(:, :)
      integer :: p, stat

      p = size(phi)
      allocate (sums%product(0:p), stat=stat)
      if (stat == 0) allocate (partial(0:p + 2, chunk_count(size(x, kind=int64))), stat=stat)
      if (stat == 0) call sum_products(x, shift, rest, phi, constant, partial, stat, error, valid, progress)
      if (allocated(error)) return
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the sums of the AR regression")
         return
      end if
      sums%product = sum(partial(0:p, :), 2)
      sums%square = sum(partial(p + 1, :))
      sums%total = sum(partial(p + 2, :))
   end subroutine sum_residuals

   !> The pass of [[sum_residuals]].
   subroutine sum_products(x, shift, rest, phi, constant, partial, stat, error, valid, progress)
      !> Series, subtracted in turn, coefficients, constant
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest, phi(:), constant
      !> sum e_t x_(t-k): [0:p]; squares, sum: [0:p+2, chunk]
      real(dp), intent(out) :: partial(0:, :)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: y(:), weight(:), e(:)
      integer(int64) :: n, first, step
      integer :: chunk, bad, m, p, from, group

      n = size(x, kind=int64)
      p = size(phi)
      step = max(block_length, 4*int(p, int64))
      stat = 0
      group = chunk_group(size(partial, 2), present(progress))
      do from = 1, size(partial, 2), group
         call tell_progress("rows of the AR model", chunk_first(n, from) - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel if (n >= threads_from) default(shared) private(y, weight, e, first, bad, m)
         allocate (y(1 - p:step), stat=bad)
         if (bad == 0) allocate (weight(step), stat=bad)
         if (bad == 0) allocate (e(step), stat=bad)
         !$omp atomic
         stat = stat + bad
         !$omp do schedule(dynamic)
         do chunk = from, min(from + group - 1, size(partial, 2))
            partial(:, chunk) = 0.0_dp
            if (bad /= 0) cycle
            do first = max(chunk_first(n, chunk), int(p, int64) + 1), chunk_last(n, chunk), step
               m = int(min(step, chunk_last(n, chunk) - first + 1))
               call load_rows(x, shift, rest, p, first, m, y, weight, valid)
               call predict(y, weight, phi, constant, m, e)
               call add_lagged_products(e, y, m, p, partial(0:p, chunk))
               partial(p + 1, chunk) = partial(p + 1, chunk) + dot_product(e(:m), e(:m))
               partial(p + 2, chunk) = partial(p + 2, chunk) + sum(e(:m))
            end do
         end do
         !$omp end do
         if (allocated(y)) deallocate (y)
         if (allocated(weight)) deallocate (weight)
         if (allocated(e)) deallocate (e)
         !$omp end parallel
      end do
   end subroutine sum_products

   !> Residuals of a block, 0 where no row ends.
   pure subroutine predict(y, weight, phi, constant, m, e)
      !> Samples with their past: [1-p:m]; marks: [m]
      real(dp), intent(in) :: phi(:)
      real(dp), intent(in) :: y(1 - size(phi):), weight(:), constant
      integer, intent(in) :: m
      !> The residuals: [m]
      real(dp), intent(inout) :: e(:)
      integer :: i, j, p

      p = size(phi)
      e(:m) = y(1:m) - constant
      do j = 1, p
         do i = 1, m
            e(i) = e(i) - phi(j)*y(i - j)
         end do
      end do
      e(:m) = e(:m)*weight(:m)
   end subroutine predict

end module gyroakf_ar_row_residuals
