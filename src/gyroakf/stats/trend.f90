! SPDX-License-Identifier: MIT
!> Polynomial trend of a series: its value, and what is left without it ([[fit_trend]] fits it).
module gyroakf_stats_trend
   use gyroakf_kinds, only : dp, int64
   use gyroakf_chunks, only : threads_from, block_length, chunk_count, chunk_first, chunk_last
   implicit none (type, external)
   private
   public :: trend_type, remove_trend, subtract_trend, evaluate_trend, set_level, set_powers

   !> Largest degree
   integer, parameter, public :: largest_degree = 9

   !> A polynomial over the samples 0 .. samples - 1
   type :: trend_type
      !> Degree; -1: no trend, 0 everywhere
      integer :: degree = -1
      !> Samples of the record that it was fitted to
      integer(int64) :: samples = 0
      !> Coefficients of the Legendre polynomials in 2 i/(n-1) - 1, i = 0 .. n-1: [0:degree]
      real(dp), allocatable :: legendre(:)
      !> Coefficients of the powers of the sample index i: [0:degree]
      real(dp), allocatable :: power(:)
      !> What the constant lost when it was rounded to legendre(0): a large offset costs no digits
      real(dp) :: remainder = 0.0_dp
   end type trend_type

contains

   !> The trend that is a constant.
   pure subroutine set_level(trend, mean, remainder)
      !> Degree 0
      type(trend_type), intent(out) :: trend
      !> The constant, in two parts that are subtracted in turn
      real(dp), intent(in) :: mean, remainder

      trend%degree = 0
      allocate (trend%legendre(0:0), trend%power(0:0))
      trend%legendre = mean
      trend%power = mean
      trend%remainder = remainder
   end subroutine set_level

   !> Coefficients of the powers of the sample index i, by $$P_j(2s - 1) = \sum_l (-1)^{j+l}
   !> \binom{j}{l} \binom{j+l}{l} s^l, \quad s = i/(n-1)$$
   pure subroutine set_powers(trend)
      !> Degree, samples and Legendre coefficients are set; the powers are filled
      type(trend_type), intent(inout) :: trend
      real(dp) :: term, width
      integer :: j, l

      width = real(max(trend%samples - 1, 1_int64), dp)
      trend%power = 0.0_dp
      do j = trend%degree, 0, -1
         term = merge(1.0_dp, -1.0_dp, mod(j, 2) == 0)*trend%legendre(j)
         do l = 0, j
            trend%power(l) = trend%power(l) + term
            term = -term*real((j - l)*(j + l + 1), dp)/real((l + 1)*(l + 1), dp)/width
         end do
      end do
   end subroutine set_powers

   !> Value of the trend at a sample.
   elemental real(dp) function evaluate_trend(trend, index)
      !> The polynomial
      type(trend_type), intent(in) :: trend
      !> Index of the sample, 0-based; any value, beyond the record it is an extrapolation
      integer(int64), intent(in) :: index
      real(dp) :: value(1)

      value = 0.0_dp
      call subtract_trend(trend, index, value)
      evaluate_trend = 0.0_dp - value(1)
   end function evaluate_trend

   !> Subtracts the trend from the whole series, in place; threaded.
   subroutine remove_trend(trend, x)
      !> The polynomial; its degree -1 leaves x as it is
      type(trend_type), intent(in) :: trend
      !> Series that begins at sample 0: [n]
      real(dp), intent(inout), contiguous :: x(:)
      integer(int64) :: n, first, last
      integer :: chunk

      n = size(x, kind=int64)
      if (trend%degree < 0) return
      !$omp parallel do if (n >= threads_from) default(shared) private(first, last) schedule(static)
      do chunk = 1, chunk_count(n)
         do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
            last = min(first + block_length - 1, chunk_last(n, chunk))
            call subtract_trend(trend, first - 1, x(first:last))
         end do
      end do
      !$omp end parallel do
   end subroutine remove_trend

   !> Subtracts the trend from successive samples: the constant, then the rest, by Clenshaw.
   pure subroutine subtract_trend(trend, first, y)
      !> The polynomial
      type(trend_type), intent(in) :: trend
      !> 0-based index of the first of the samples
      integer(int64), intent(in) :: first
      !> The samples: [any number; short stretches are best]
      real(dp), intent(inout), contiguous :: y(:)
      real(dp) :: t, b, b1, b2, scale, up(largest_degree), down(largest_degree)
      integer :: i, k

      if (trend%degree < 0) return
      if (trend%degree == 0) then
         y(:) = (y - trend%legendre(0)) - trend%remainder
         return
      end if
      scale = 1.0_dp/real(max(trend%samples - 1, 1_int64), dp)
      do k = 1, trend%degree
         up(k) = real(2*k + 1, dp)/real(k + 1, dp)
         down(k) = real(k + 1, dp)/real(k + 2, dp)
      end do
      !$omp simd private(t, b, b1, b2, k)
      do i = 1, size(y)
         t = real(2*(first + i - 1) - (trend%samples - 1), dp)*scale
         b1 = 0.0_dp
         b2 = 0.0_dp
         do k = trend%degree, 1, -1
            b = trend%legendre(k) + up(k)*t*b1 - down(k)*b2
            b2 = b1
            b1 = b
         end do
         y(i) = (y(i) - trend%legendre(0)) - (t*b1 - 0.5_dp*b2 + trend%remainder)
      end do
   end subroutine subtract_trend

end module gyroakf_stats_trend
