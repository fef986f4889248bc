! SPDX-License-Identifier: MIT
!> Mean, variance, extremes, skewness and kurtosis of a series in one pass.
module gyroakf_stats_moments
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last
   implicit none (type, external)
   private
   public :: moments_type, compute_moments, join_moments, first_present

   !> Moments of a series in its unit u
   type :: moments_type
      !> Present samples
      integer(int64) :: count = 0
      !> Mean, u
      real(dp) :: mean = 0.0_dp
      !> Variance with divisor count - 1, u^2, and its square root, u; 0 below two samples
      real(dp) :: variance = 0.0_dp, std = 0.0_dp
      !> Extremes, u
      real(dp) :: minimum = 0.0_dp, maximum = 0.0_dp
      !> Skewness m3/m2^(3/2), biased moments; 0 where the variance is no normal number
      real(dp) :: skewness = 0.0_dp
      !> Kurtosis m4/m2^2, biased, 3 for a normal distribution; 0 as the skewness
      real(dp) :: kurtosis = 0.0_dp
      !> What the mean lost when it was rounded, u: the series less both in turn has the mean 0
      real(dp) :: remainder = 0.0_dp
   end type moments_type

   !> Sums of powers of the deviations from the mean, in a unit that keeps them in range
   type :: sums_type
      real(dp) :: count = 0.0_dp, mean = 0.0_dp, m2 = 0.0_dp, m3 = 0.0_dp, m4 = 0.0_dp
      real(dp) :: low = 0.0_dp, high = 0.0_dp
   end type sums_type

   !> Deviations between are their own unit: their fourth powers are numbers with all digits
   real(dp), parameter :: smallest = 1.0e-60_dp, largest = 1.0e+60_dp

contains

   !> Moments of the present samples.
   !>
   !> Each block is reduced about its own mean while it is in the cache, then blocks are merged, all
   !> relative to the first present sample, so that an offset costs no digits; a second pass is made
   !> only where fourth powers would overflow or vanish. Threaded; the result does not depend on the
   !> threads. Source: Pebay, Formulas for robust, one-pass parallel computation of covariances and
   !> arbitrary-order statistical moments, Sandia report SAND2008-6212 (2008).
   subroutine compute_moments(x, moments, valid)
      !> Series: [n], n >= 0, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> The moments; all 0 where nothing is present
      type(moments_type), intent(out) :: moments
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(sums_type) :: sums
      real(dp) :: shift, per_unit

      shift = first_present(x, valid)
      call sum_blocks(x, shift, 1.0_dp, sums, valid)
      per_unit = units_for(half_spread(sums, shift, 1.0_dp))
      if (per_unit < 1.0_dp .or. per_unit > 1.0_dp) call sum_blocks(x, shift, per_unit, sums, valid)
      call finish(sums, shift, per_unit, moments)
   end subroutine compute_moments

   !> Sums of a series in a unit; only the extremes are good where its spread is too large.
   subroutine sum_blocks(x, shift, per_unit, sums, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, per_unit
      type(sums_type), intent(out) :: sums
      integer(int8), intent(in), optional :: valid(:)
      type(sums_type) :: part(chunk_count(size(x, kind=int64))), block_sums
      integer(int64) :: n, first, last
      integer :: chunk

      n = size(x, kind=int64)
      !$omp parallel do if (n >= threads_from) default(shared) private(first, last, block_sums) &
      !$omp& schedule(dynamic)
      do chunk = 1, chunk_count(n)
         part(chunk) = sums_type()
         do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
            last = min(first + block_length - 1, chunk_last(n, chunk))
            if (present(valid)) then
               block_sums = reduce_masked(x(first:last), shift, per_unit, valid(first:last))
            else
               block_sums = reduce(x(first:last), shift, per_unit)
            end if
            part(chunk) = merged(part(chunk), block_sums)
         end do
      end do
      !$omp end parallel do
      do chunk = 1, chunk_count(n)
         sums = merged(sums, part(chunk))
      end do
   end subroutine sum_blocks

   !> Half the largest deviation from the shift, in the unit of the sums; 0 without samples.
   pure real(dp) function half_spread(sums, shift, per_unit) result(spread)
      type(sums_type), intent(in) :: sums
      real(dp), intent(in) :: shift, per_unit
      real(dp) :: half

      spread = 0.0_dp
      half = 0.5_dp*per_unit
      if (sums%count > 0.5_dp) spread = max(half*sums%high - half*shift, half*shift - half*sums%low)
   end function half_spread

   !> 1 over the unit of deviations, a power of two; 1 wherever they need none.
   pure real(dp) function units_for(spread) result(per_unit)
      real(dp), intent(in) :: spread

      per_unit = 1.0_dp
      if (spread <= 0.0_dp .or. (spread >= smallest .and. spread <= largest)) return
      per_unit = scale(1.0_dp, max(-1000, min(1000, -exponent(spread))))
   end function units_for

   !> First present sample, 0 where there is none.
   pure real(dp) function first_present(x, valid) result(first)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i

      first = 0.0_dp
      do i = 1, size(x, kind=int64)
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         first = x(i)
         return
      end do
   end function first_present

   !> Moments of two series one behind the other, from those of each.
   pure subroutine join_moments(moments, next)
      !> Those of the first; afterwards of both
      type(moments_type), intent(inout) :: moments
      !> Those of the second
      type(moments_type), intent(in) :: next
      type(sums_type) :: both
      real(dp) :: per_unit

      if (next%count == 0) return
      per_unit = units_for(max(moments%std, next%std, abs(next%mean - moments%mean)))
      both = sums_of(next, per_unit)
      if (moments%count > 0) both = merged(sums_of(moments, per_unit), both)
      call finish(both, 0.0_dp, per_unit, moments)
   end subroutine join_moments

   !> The sums that moments come from.
   pure type(sums_type) function sums_of(moments, per_unit) result(s)
      type(moments_type), intent(in) :: moments
      real(dp), intent(in) :: per_unit
      real(dp) :: m2

      s%count = real(moments%count, dp)
      s%mean = per_unit*moments%mean
      s%m2 = per_unit*(per_unit*moments%variance)*(s%count - 1.0_dp)
      m2 = s%m2/s%count
      s%m3 = moments%skewness*m2*sqrt(m2)*s%count
      s%m4 = moments%kurtosis*m2*m2*s%count
      s%low = moments%minimum
      s%high = moments%maximum
   end function sums_of

   !> Moments from the sums.
   pure subroutine finish(s, shift, per_unit, moments)
      type(sums_type), intent(in) :: s
      !> Subtracted from every sample before, u; units of the sums in u
      real(dp), intent(in) :: shift, per_unit
      type(moments_type), intent(out) :: moments
      real(dp) :: m2, mean

      moments%count = nint(s%count, int64)
      if (moments%count < 1) return
      mean = s%mean/per_unit
      moments%mean = shift + mean
      m2 = moments%mean - shift
      moments%remainder = (shift - (moments%mean - m2)) + (mean - m2)
      moments%minimum = s%low
      moments%maximum = s%high
      if (s%count < 1.5_dp) return
      moments%variance = s%m2/(s%count - 1.0_dp)
      moments%std = sqrt(moments%variance)/per_unit
      moments%variance = moments%variance/per_unit/per_unit
      if (moments%variance < tiny(1.0_dp)) return
      m2 = s%m2/s%count
      moments%skewness = s%m3/s%count/(m2*sqrt(m2))
      moments%kurtosis = s%m4/s%count/(m2*m2)
   end subroutine finish

   !> Sums of a block without gaps; only count and extremes where its spread is beyond `largest`.
   pure type(sums_type) function reduce(x, shift, per_unit) result(s)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, per_unit
      real(dp) :: total, m1, m2, m3, m4, low, high, d, d2, center, in_units
      integer :: i, n

      n = size(x)
      total = 0.0_dp
      low = x(1)
      high = x(1)
      !$omp simd reduction(min:low) reduction(max:high)
      do i = 1, n
         low = min(low, x(i))
         high = max(high, x(i))
      end do
      s = sums_type(count=real(n, dp), low=low, high=high)
      if (half_spread(s, shift, per_unit) > largest) return
      in_units = shift*per_unit
      !$omp simd reduction(+:total)
      do i = 1, n
         total = total + (x(i)*per_unit - in_units)
      end do
      center = total/real(n, dp)
      m1 = 0.0_dp; m2 = 0.0_dp; m3 = 0.0_dp; m4 = 0.0_dp
      !$omp simd reduction(+:m1, m2, m3, m4)
      do i = 1, n
         d = (x(i)*per_unit - in_units) - center
         d2 = d*d
         m1 = m1 + d
         m2 = m2 + d2
         m3 = m3 + d2*d
         m4 = m4 + d2*d2
      end do
      d = m1/real(n, dp)                        ! from a center near the mean to the mean
      s%mean = center + d
      s%m2 = max(m2 - d*m1, 0.0_dp)
      s%m3 = m3 - 3.0_dp*d*m2 + 2.0_dp*d*d*m1
      s%m4 = m4 - 4.0_dp*d*m3 + 6.0_dp*d*d*m2 - 3.0_dp*d*d*d*m1
   end function reduce

   !> Sums of a block with gaps.
   pure type(sums_type) function reduce_masked(x, shift, per_unit, valid) result(s)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, per_unit
      integer(int8), intent(in) :: valid(:)
      real(dp) :: packed(size(x))
      integer :: i, n

      n = 0
      do i = 1, size(x)
         if (valid(i) == 0_int8) cycle
         n = n + 1
         packed(n) = x(i)
      end do
      s = sums_type()
      if (n > 0) s = reduce(packed(:n), shift, per_unit)
   end function reduce_masked

   !> Sums of two parts together.
   pure type(sums_type) function merged(a, b) result(s)
      type(sums_type), intent(in) :: a, b
      real(dp) :: n, d, dn

      s = a
      if (b%count < 0.5_dp) return
      s = b
      if (a%count < 0.5_dp) return
      n = a%count + b%count
      d = b%mean - a%mean
      dn = d/n
      s%count = n
      s%mean = a%mean + b%count*dn
      s%m2 = a%m2 + b%m2 + d*dn*a%count*b%count
      s%m3 = a%m3 + b%m3 + d*dn*dn*a%count*b%count*(a%count - b%count) &
         & + 3.0_dp*dn*(a%count*b%m2 - b%count*a%m2)
      s%m4 = a%m4 + b%m4 + d*dn*dn*dn*a%count*b%count*(a%count*a%count - a%count*b%count &
         & + b%count*b%count) &
         & + 6.0_dp*dn*dn*(a%count*a%count*b%m2 + b%count*b%count*a%m2) &
         & + 4.0_dp*dn*(a%count*b%m3 - b%count*a%m3)
      s%low = min(a%low, b%low)
      s%high = max(a%high, b%high)
   end function merged

end module gyroakf_stats_moments
