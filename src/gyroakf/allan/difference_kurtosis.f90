! SPDX-License-Identifier: MIT
!> Excess kurtosis of the white noise in a record, from differences of adjacent means.
module gyroakf_allan_difference_kurtosis
   use gyroakf_kinds, only : dp, int32, int64
   implicit none (type, external)
   private
   public :: find_kurtosis, kurtosis_samples

   !> Phases of a block, a multiple of the averaging factors that are summed in it together
   integer(int64), parameter :: block_length = 32768
   !> Blocks that are looked at beyond m = 1, at most, evenly over the record, and their samples:
   !> they give the kurtosis of white noise to 0.01
   integer(int64), parameter :: blocks_max = 32, kurtosis_samples = blocks_max*block_length
   !> From which length on threads are worth it
   integer(int64), parameter :: parallel_from = 200000

contains

   !> Excess kurtosis per sample as the differences d of adjacent means of m samples have it,
   !>
   !> $$ \kappa = 2 m \left(
   !>    \frac{\mathrm{E}(d - \bar d)^4}{(\mathrm{E}(d - \bar d)^2)^2} - 3 \right), $$
   !>
   !> which for white noise does not depend on m. A pass over the phase for m = 1; for longer
   !> factors 2**20 samples are looked at.
   recursive subroutine find_kurtosis(phase, m, variance, kurtosis, missing)
      !> Integral of the record: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, powers of two, at most n/2: [k]
      integer(int64), intent(in) :: m(:)
      !> Allan variances there, which keep fourth powers in range: [k]
      real(dp), intent(in) :: variance(:)
      !> 0 where nothing varies or fewer than two differences are complete: [k]
      real(dp), intent(out) :: kurtosis(:)
      !> Missing samples so far: [0:n]; absent or of size 1: none
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      real(dp), allocatable :: sums(:, :, :)
      real(dp) :: total(3), scale(size(m)), mean(size(m))
      integer(int64) :: blocks, b, n, stride, before
      integer :: i

      if (.not. present(missing)) then
         call find_kurtosis(phase, m, variance, kurtosis, [0_int32])
         return
      end if
      n = ubound(phase, 1, kind=int64)
      stride = n/block_length/blocks_max + 1
      blocks = n/block_length/stride + 1
      scale = 1/(real(m, dp)*sqrt(max(variance, tiny(1.0_dp))))
      do i = 1, size(m)
         mean(i) = mean_difference(phase, m(i), missing)
      end do
      allocate (sums(3, size(m), blocks), source=0.0_dp)
      !$omp parallel do schedule(static) private(i, before) if (n > parallel_from)
      do b = 1, blocks
         do i = 1, size(m)
            if (m(i) > block_length .and. b > 1) cycle
            before = ((b - 1)*stride + 1)*block_length
            if (m(i) == 1) before = b*stride*block_length
            if (m(i) > block_length) before = n
            call add_powers(phase, m(i), (b - 1)*stride*block_length, before, mean(i), scale(i), &
               & sums(:, i, b), missing)
         end do
      end do
      !$omp end parallel do
      kurtosis = 0
      do i = 1, size(m)
         total = sum(sums(:, i, :), dim=2)
         if (variance(i) > tiny(1.0_dp) .and. total(1) > 1 .and. total(2) > 0) then
            kurtosis(i) = 2*real(m(i), dp)*(total(1)*total(3)/total(2)**2 - 3)
         end if
      end do
   end subroutine find_kurtosis

   !> Mean of the differences of step m: known from the ends of a complete record.
   pure real(dp) function mean_difference(phase, m, missing) result(mean)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m
      integer(int32), intent(in), contiguous :: missing(0:)
      integer(int64) :: k, n, counted

      n = ubound(phase, 1, kind=int64)
      mean = 0
      if (size(missing) > 1) then
         counted = 0
         do k = 0, n - 2*m, m
            if (missing(k + 2*m) > missing(k)) cycle
            counted = counted + 1
            mean = mean + ((phase(k + 2*m) - phase(k + m)) - (phase(k + m) - phase(k)))
         end do
      else
         counted = (n/m)*m
         mean = (phase(counted) - phase(counted - m)) - (phase(m) - phase(0))
         counted = n/m - 1
      end if
      mean = mean/real(max(counted, 1_int64), dp)
   end function mean_difference

   !> Number, squares and fourth powers of the differences that begin at first, first + m, ...
   !> before `before`.
   pure subroutine add_powers(phase, m, first, before, mean, scale, sums, missing)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, first, before
      real(dp), intent(in) :: mean, scale
      real(dp), intent(inout) :: sums(3)
      integer(int32), intent(in), contiguous :: missing(0:)
      real(dp) :: u, squares, fourths
      integer(int64) :: k, last, counted

      last = min(before - 1, ubound(phase, 1, kind=int64) - 2*m)
      squares = 0
      fourths = 0
      counted = 0
      if (m == 1 .and. size(missing) == 1) then
         counted = max(0_int64, last - first + 1)
         !$omp simd reduction(+:squares, fourths) private(u)
         do k = first, last
            u = (scale*(((phase(k + 2) - phase(k + 1)) - (phase(k + 1) - phase(k))) - mean))**2
            squares = squares + u
            fourths = fourths + u**2
         end do
      else
         do k = first, last, m
            if (size(missing) > 1) then
               if (missing(k + 2*m) > missing(k)) cycle
            end if
            counted = counted + 1
            u = (scale*(((phase(k + 2*m) - phase(k + m)) - (phase(k + m) - phase(k))) - mean))**2
            squares = squares + u
            fourths = fourths + u**2
         end do
      end if
      sums = sums + [real(counted, dp), squares, fourths]
   end subroutine add_powers

end module gyroakf_allan_difference_kurtosis
