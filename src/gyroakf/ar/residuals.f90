! SPDX-License-Identifier: MIT
!> Residuals of an AR model in one pass, not stored: their autocovariances and moments.
module gyroakf_ar_residuals
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_chunks, only : block_length, chunk_count, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_stats_moments, only : moments_type, compute_moments, join_moments
   use gyroakf_stats_lagged_products, only : add_pair_sums, covariances_of_pairs, residual_block
   use gyroakf_stats_trend, only : trend_type, set_level
   implicit none (type, external)
   private
   public :: analyze_residuals

   !> Sums over pairs, of `add_pair_sums`: [4 (max_lag + 1)]
   type, extends(chunk_sums_type) :: pair_sums_type
      !> Mean of the series
      type(trend_type) :: level
      real(dp), allocatable :: phi(:)
      real(dp) :: constant = 0.0_dp
      !> Moments of the residuals of every chunk
      type(moments_type), allocatable :: part(:)
   contains
      procedure :: add => add_pairs
   end type pair_sums_type

contains

   !> Autocovariances and moments of the residuals.
   !>
   !> $$e_t = (x_t - m) - \sum_j \phi_j (x_{t-j} - m)$$ for the t whose p predecessors exist and are
   !> present. r_k is biased, of n - p residuals about their mean; the sums are about `constant`.
   subroutine analyze_residuals(x, mean, phi, constant, max_lag, r, pairs, moments, error, valid, &
      & progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Mean m that the model was fitted with
      real(dp), intent(in) :: mean
      !> AR coefficients: [p], p >= 0
      real(dp), intent(in) :: phi(:)
      !> Near the mean of the residuals: 0, or the constant of the regression
      real(dp), intent(in) :: constant
      !> Largest lag, 0 .. n-p-1
      integer, intent(in) :: max_lag
      !> Autocovariances: [0:max_lag], 0 at a lag without pairs; pairs: [0:max_lag]
      real(dp), allocatable, intent(out) :: r(:)
      integer(int64), allocatable, intent(out) :: pairs(:)
      !> Moments of the residuals less `constant`
      type(moments_type), intent(out) :: moments
      !> invalid_argument, too_few_samples, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(pair_sums_type) :: sums
      real(dp), allocatable :: total(:), s(:, :)
      integer :: chunk, stat

      if (max_lag < 0) then
         call fatal_error(error, status%invalid_argument, "the largest lag must not be negative")
         return
      else if (size(x, kind=int64) <= int(max_lag, int64) + size(phi)) then
         call fatal_error(error, status%too_few_samples, &
            & "the series has too few residuals for so many lags")
         return
      end if
      allocate (r(0:max_lag), stat=stat)
      if (stat == 0) allocate (pairs(0:max_lag), stat=stat)
      if (stat == 0) allocate (s(0:max_lag, 4), stat=stat)
      if (stat == 0) allocate (total(4*(max_lag + 1)), stat=stat)
      if (stat == 0) allocate (sums%part(chunk_count(size(x, kind=int64))), stat=stat)
      call check_memory(stat, "the sums of the residuals", error)
      if (allocated(error)) return
      call set_level(sums%level, mean, 0.0_dp)
      sums%phi = phi
      sums%constant = constant
      call sum_chunks(sums, x, size(x, kind=int64), "residuals of the AR model", total, error, &
         & valid, progress)
      if (allocated(error)) return
      s(:, :) = reshape(total, [max_lag + 1, 4])
      do chunk = 1, size(sums%part)
         call join_moments(moments, sums%part(chunk))
      end do
      call covariances_of_pairs(s, moments%mean, size(x, kind=int64) - size(phi), r, pairs)
      if (moments%count < 1) call fatal_error(error, status%too_few_samples, &
         & "the gaps leave no residual of the AR model")
   end subroutine analyze_residuals

   !> The sums over the residuals of a chunk.
   subroutine add_pairs(self, x, n, chunk, total, stat, valid)
      class(pair_sums_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      type(moments_type) :: moments
      real(dp), allocatable :: e(:), flag(:)
      integer(int64) :: begin
      integer :: m, lags

      lags = size(total)/4 - 1
      allocate (e(1 - lags:block_length), stat=stat)
      if (stat == 0) allocate (flag(1 - lags:block_length), stat=stat)
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         if (stat == 0) call residual_block(x, self%level, self%phi, self%constant, begin - lags, &
            & e(:m), flag(:m), stat, valid)
         if (stat /= 0) return
         call add_pair_sums(e(:m), flag(:m), m, lags, total)
         if (minval(flag(1:m)) > 0.5_dp) then
            call compute_moments(e(1:m), moments)
         else
            call compute_moments(e(1:m), moments, nint(flag(1:m), int8))
         end if
         call join_moments(self%part(chunk), moments)
      end do
   end subroutine add_pairs

end module gyroakf_ar_residuals
