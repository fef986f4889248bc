! SPDX-License-Identifier: MIT
!> Residuals of a series about its constant or line, block by block, for the KPSS test and the
!> autocovariances at many lags. Nothing of the record's length is stored.
module gyroakf_stats_trend_residuals
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_autocovariance, only : series_mean
   use gyroakf_stats_trend, only : trend_type, fit_trend
   implicit none (type, external)
   private
   public :: residual_type, fit_residuals, load_residuals, rounding_variance

   !> How a residual follows from the series
   type :: residual_type
      !> Samples of the series
      integer(int64) :: samples = 0
      !> Subtracted in this order: constant, what it lost when it was rounded, slope times P_1(i), i.e. -1 .. 1 over the samples
      real(dp) :: shift = 0.0_dp, rest = 0.0_dp, slope = 0.0_dp
   end type residual_type

contains

   !> Least-squares constant (terms = 1) or line (terms = 2) of the present samples.
   subroutine fit_residuals(x, terms, residual, error, valid)
      !> Series: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> 1 constant, 2 line
      integer, intent(in) :: terms
      !> The fit
      type(residual_type), intent(out) :: residual
      !> too_few_samples, non_finite, singular, invalid_argument (length of the mask)
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(trend_type) :: trend
      integer(int64) :: found

      residual%samples = size(x, kind=int64)
      if (present(valid)) then
         if (size(valid, kind=int64) /= residual%samples) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
            return
         end if
      end if
      select case (terms)
      case (1)
         call series_mean(x, residual%shift, residual%rest, found, valid)
         if (.not. ieee_is_finite(residual%shift + residual%rest)) then
            call fatal_error(error, status%non_finite, "the series has a value that is not finite")
         else if (found < 1) then
            call fatal_error(error, status%too_few_samples, "every sample of the series is missing")
         end if
      case default
         call fit_trend(x, 1, trend, error, valid)
         if (allocated(error)) return
         residual%shift = trend%legendre(0)
         residual%rest = trend%remainder
         residual%slope = trend%legendre(1)
      end select
   end subroutine fit_residuals

   !> Variance that the rounding of the samples alone leaves about a perfect constant or line.
   pure real(dp) function rounding_variance(residual)
      !> The fit
      type(residual_type), intent(in) :: residual

      rounding_variance = (epsilon(1.0_dp)*(abs(residual%shift) + abs(residual%rest) + abs(residual%slope)))**2
   end function rounding_variance

   !> Residuals first .. last; 0 where one is missing or lies outside.
   pure subroutine load_residuals(residual, x, first, e, valid, flag)
      !> The fit
      type(residual_type), intent(in) :: residual
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Number of the first, 1-based; may lie before or behind the series
      integer(int64), intent(in) :: first
      !> The residuals: [any number]
      real(dp), intent(out), contiguous :: e(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> 1 where there is a residual, 0 elsewhere: as e
      real(dp), intent(out), optional, contiguous :: flag(:)
      integer(int64) :: from, to, i

      from = min(max(first, 1_int64), first + size(e, kind=int64))
      to = max(min(first + size(e, kind=int64) - 1, residual%samples), from - 1)
      e(:from - first) = 0.0_dp
      e(to - first + 2:) = 0.0_dp
      call load_samples(residual, x, from, to, e(from - first + 1:to - first + 1))
      if (present(flag)) then
         flag(:) = 0.0_dp
         flag(from - first + 1:to - first + 1) = 1.0_dp
      end if
      if (.not. present(valid)) return
      do i = from, to
         if (valid(i) /= 0_int8) cycle
         e(i - first + 1) = 0.0_dp
         if (present(flag)) flag(i - first + 1) = 0.0_dp
      end do
   end subroutine load_residuals

   !> Samples about the constant or the line.
   pure subroutine load_samples(residual, x, from, to, e)
      type(residual_type), intent(in) :: residual
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: from, to
      real(dp), intent(out) :: e(from:)
      real(dp) :: t, width
      integer(int64) :: i

      if (abs(residual%slope) > 0.0_dp) then
         width = 1.0_dp/real(max(residual%samples - 1, 1_int64), dp)
         !$omp simd private(t)
         do i = from, to
            t = real(2*(i - 1) - (residual%samples - 1), dp)*width
            e(i) = ((x(i) - residual%shift) - residual%rest) - residual%slope*t
         end do
      else
         !$omp simd
         do i = from, to
            e(i) = (x(i) - residual%shift) - residual%rest
         end do
      end if
   end subroutine load_samples

end module gyroakf_stats_trend_residuals
