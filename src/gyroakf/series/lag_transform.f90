! SPDX-License-Identifier: MIT
!> Autocovariances at very many lags: blocks of the series through the Fourier transform, the products added up as spectra.
module gyroakf_series_lag_transform
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : chunk_count, chunk_first, chunk_last
   use gyroakf_fft, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward, real_fft_backward, smooth_length
   use gyroakf_ar_autocovariance, only : compute_autocovariance, series_mean
   use gyroakf_series_residuals, only : residual_type, load_residuals
   implicit none (type, external)
   private
   public :: many_autocovariances, transform_from, autocovariances_by_transform

   !> Number of lags from which the transform is faster than the products
   integer, parameter :: transform_from = 256
   !> Points of a transform at least, and at least so many times the lags
   integer(int64), parameter :: least_points = 16384, points_a_lag = 4
   !> Points that are transformed before somebody is told how far it is
   integer(int64), parameter :: told_points = 1048576_int64

contains

   !> As [[compute_autocovariance]], by whichever way is faster for this number of lags; the same to 1e-14 of r(0).
   subroutine many_autocovariances(x, max_lag, mean, r, error, valid, pairs, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Largest lag, 0 .. n-1
      integer, intent(in) :: max_lag
      !> Mean of the present samples
      real(dp), intent(out) :: mean
      !> Autocovariances: [0:max_lag]
      real(dp), allocatable, intent(out) :: r(:)
      !> invalid_argument, too_few_samples, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Number of present pairs at each lag: [0:max_lag]
      integer(int64), allocatable, intent(out), optional :: pairs(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress

      if (max_lag < transform_from) then
         call compute_autocovariance(x, max_lag, mean, r, error, valid, pairs, progress)
      else
         call autocovariances_by_transform(x, max_lag, mean, r, error, valid, pairs, progress)
      end if
   end subroutine many_autocovariances

   !> The same by the transform, for any number of lags.
   subroutine autocovariances_by_transform(x, max_lag, mean, r, error, valid, pairs, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Largest lag, 0 .. n-1
      integer, intent(in) :: max_lag
      !> Mean of the present samples
      real(dp), intent(out) :: mean
      !> Autocovariances: [0:max_lag]
      real(dp), allocatable, intent(out) :: r(:)
      !> invalid_argument, too_few_samples, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Number of present pairs at each lag: [0:max_lag]
      integer(int64), allocatable, intent(out), optional :: pairs(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(residual_type) :: residual
      real(dp), allocatable :: products(:), number(:)
      integer(int64) :: found, n
      integer :: k

      ! lag 0 by the plain way: checks, mean, and the variance to the last digit
      call compute_autocovariance(x, min(max_lag, 0), mean, r, error, valid, progress=progress)
      if (allocated(error)) return
      n = size(x, kind=int64)
      if (int(max_lag, int64) >= n) call fatal_error(error, status%too_few_samples, "more lags than samples")
      if (allocated(error)) return
      residual%samples = n
      call series_mean(x, residual%shift, residual%rest, found, valid)
      call lagged_sums(residual, x, max_lag, .false., products, error, valid, progress)
      if (.not. allocated(error) .and. present(valid)) then
         call lagged_sums(residual, x, max_lag, .true., number, error, valid, progress)
      end if
      if (allocated(error)) return
      products(0) = r(0)
      do k = 1, max_lag
         if (present(valid)) then
            number(k) = anint(number(k))
            products(k) = products(k)/max(number(k), 1.0_dp)*(real(n - k, dp)/real(n, dp))
            if (number(k) < 0.5_dp) products(k) = 0.0_dp
         else
            products(k) = products(k)/real(n, dp)
         end if
      end do
      call move_alloc(products, r)
      if (.not. present(pairs)) return
      allocate (pairs(0:max_lag))
      do k = 0, max_lag
         pairs(k) = n - int(k, int64)
         if (present(valid)) pairs(k) = nint(number(k), int64)
      end do
   end subroutine autocovariances_by_transform

   !> Sums of products (or, of flags, of pairs) at all lags: with a block a of the series and b the same block with the
   !> max_lag samples before it, the sum over a(t) b(t - k) is the correlation of both, whose spectrum is conj(A) B.
   subroutine lagged_sums(residual, x, max_lag, count_pairs, sums, error, valid, progress)
      type(residual_type), intent(in) :: residual
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: max_lag
      !> Sums of flags instead of values
      logical, intent(in) :: count_pairs
      !> [0:max_lag]
      real(dp), allocatable, intent(out) :: sums(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(real_fft_plan_type) :: plan
      complex(dp), allocatable :: part(:, :)
      real(dp), allocatable :: line(:)
      integer(int64) :: points, n, first, round
      integer :: parts, i, k, stat, failed

      n = residual%samples
      points = 2*smooth_length((max(least_points, points_a_lag*int(max_lag, int64)) + 1)/2)
      points = min(points, 2*smooth_length((n + int(max_lag, int64) + 2)/2))
      parts = part_count(n, points - max_lag)
      allocate (sums(0:max_lag), stat=stat)
      if (stat == 0) allocate (line(points), stat=stat)
      if (stat == 0) allocate (part(points/2 + 1, parts), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the spectra of the lagged sums")
         return
      end if
      call new_real_fft_plan(plan, points, error)
      if (allocated(error)) return
      failed = 0
      part(:, :) = (0.0_dp, 0.0_dp)
      round = (points - max_lag)*int(parts, int64)
      round = round*max(1_int64, told_points/(points*int(parts, int64)))
      do first = 1, n, round
         call tell_progress("autocovariances", first - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel do default(shared) private(stat) schedule(dynamic) reduction(+:failed)
         do i = 1, parts
            call add_spectra(residual, x, max_lag, count_pairs, plan, points - max_lag, first + (points - max_lag)*(i - 1), &
               & min(n, first + round - 1), parts, part(:, i), stat, valid)
            failed = failed + stat
         end do
         !$omp end parallel do
      end do
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the buffers of the lagged sums")
         return
      end if
      do i = 2, parts
         part(:, 1) = part(:, 1) + part(:, i)
      end do
      call real_fft_backward(plan, part(:, 1), line, error)
      if (allocated(error)) return
      do k = 0, max_lag
         sums(k) = line(max_lag - k + 1)
      end do
      if (.not. all(ieee_is_finite(sums))) call fatal_error(error, status%non_finite, "the series has a value that is not finite")
   end subroutine lagged_sums

   !> Spectra that are kept apart, so that the result does not depend on the threads: a few, as each is as long as a transform.
   pure integer function part_count(n, block)
      integer(int64), intent(in) :: n, block

      part_count = int(min(8_int64, (n + block - 1)/block))
   end function part_count

   !> Adds the spectra of every parts-th block of a stretch.
   subroutine add_spectra(residual, x, max_lag, count_pairs, plan, block, first, last, parts, total, stat, valid)
      type(residual_type), intent(in) :: residual
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: max_lag
      logical, intent(in) :: count_pairs
      type(real_fft_plan_type), intent(in) :: plan
      !> Samples of a block; where the first block begins, where the last may; blocks to the next
      integer(int64), intent(in) :: block, first, last
      integer, intent(in) :: parts
      !> Gets them: [points/2 + 1]
      complex(dp), intent(inout), contiguous :: total(:)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: a(:), b(:), flag(:)
      complex(dp), allocatable :: a_spectrum(:), b_spectrum(:)
      type(error_type), allocatable :: error
      integer(int64) :: i, start

      stat = 0
      if (first > last) return
      allocate (a(plan%length), stat=stat)
      if (stat == 0) allocate (b(plan%length), stat=stat)
      if (stat == 0) allocate (flag(plan%length), stat=stat)
      if (stat == 0) allocate (a_spectrum(size(total)), stat=stat)
      if (stat == 0) allocate (b_spectrum(size(total)), stat=stat)
      if (stat /= 0) return
      do start = first, last, block*int(parts, int64)
         call load_residuals(residual, x, start - max_lag, b, valid, flag)
         if (count_pairs) b(:) = flag
         a(:block) = b(max_lag + 1:)
         a(block + 1:) = 0.0_dp
         call real_fft_forward(plan, a, a_spectrum, error)
         if (.not. allocated(error)) call real_fft_forward(plan, b, b_spectrum, error)
         if (allocated(error)) then
            stat = 1
            return
         end if
         do i = 1, size(total, kind=int64)
            total(i) = total(i) + conjg(a_spectrum(i))*b_spectrum(i)
         end do
      end do
   end subroutine add_spectra

end module gyroakf_series_lag_transform
