! SPDX-License-Identifier: MIT
!> Excess kurtosis of the white noise in a record, from differences of adjacent means.
module gyroakf_allan_difference_kurtosis
   use gyroakf_kinds, only : dp, int32, int64
   implicit none (type, external)
   private
   public :: find_kurtosis

   !> Phases of a block, a multiple of the averaging factors that are summed in it together
   integer(int64), parameter :: block_length = 32768
   !> From which length on threads are worth it
   integer(int64), parameter :: parallel_from = 200000

contains

   !> Excess kurtosis per sample as the differences d of adjacent means of m samples have it,
   !>
   !> $$ \kappa = 2 m \left( \frac{\mathrm{E}(d - \bar d)^4}{(\mathrm{E}(d - \bar d)^2)^2} - 3 \right), $$
   !>
   !> which for white noise does not depend on m. Two passes over the phase, for all factors together.
   subroutine find_kurtosis(phase, m, variance, kurtosis, missing)
      !> Integral of the record: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, powers of two: [k]
      integer(int64), intent(in) :: m(:)
      !> Allan variances there, which keep fourth powers in range: [k]
      real(dp), intent(in) :: variance(:)
      !> 0 where nothing varies or fewer than two differences are complete: [k]
      real(dp), intent(out) :: kurtosis(:)
      !> Missing samples so far: [0:n]; absent: none
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      real(dp), allocatable :: sums(:, :, :)
      real(dp) :: total(0:4), scale(size(m)), mean, second
      integer(int64) :: blocks, b, n
      integer :: i

      n = ubound(phase, 1, kind=int64)
      blocks = n/block_length + 1
      scale = 1/(real(m, dp)*sqrt(max(variance, tiny(1.0_dp))))
      allocate (sums(0:4, size(m), blocks), source=0.0_dp)
      !$omp parallel do schedule(static) private(i) if (n > parallel_from)
      do b = 1, blocks
         do i = 1, size(m)
            if (m(i) > block_length .and. b > 1) cycle
            call add_powers(phase, m(i), (b - 1)*block_length, merge(n, b*block_length, m(i) > block_length), scale(i), &
               & sums(:, i, b), missing)
         end do
      end do
      !$omp end parallel do
      kurtosis = 0
      do i = 1, size(m)
         if (variance(i) <= tiny(1.0_dp)) cycle
         total = sum(sums(:, i, :), dim=2)
         if (total(0) < 2) cycle
         total = total/total(0)
         mean = total(1)
         second = total(2) - mean**2
         if (second > 0) kurtosis(i) = 2*real(m(i), dp)*((total(4) - 4*mean*total(3) + 6*mean**2*total(2) - 3*mean**4) &
            & /second**2 - 3)
      end do
   end subroutine find_kurtosis

   !> Number and power sums of the differences that begin at first, first + m, ... before `before`.
   pure subroutine add_powers(phase, m, first, before, scale, sums, missing)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, first, before
      real(dp), intent(in) :: scale
      real(dp), intent(inout) :: sums(0:4)
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      real(dp) :: u, s1, s2, s3, s4
      integer(int64) :: k, last, counted

      last = min(before - 1, ubound(phase, 1, kind=int64) - 2*m)
      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      counted = 0
      if (present(missing)) then
         do k = first, last, m
            if (missing(k + 2*m) > missing(k)) cycle
            u = scale*((phase(k + 2*m) - phase(k + m)) - (phase(k + m) - phase(k)))
            counted = counted + 1
            s1 = s1 + u
            s2 = s2 + u**2
            s3 = s3 + u**3
            s4 = s4 + u**4
         end do
      else
         if (last >= first) counted = (last - first)/m + 1
         !$omp simd reduction(+:s1, s2, s3, s4) private(u)
         do k = first, last, m
            u = scale*((phase(k + 2*m) - phase(k + m)) - (phase(k + m) - phase(k)))
            s1 = s1 + u
            s2 = s2 + u**2
            s3 = s3 + u**3
            s4 = s4 + u**4
         end do
      end if
      sums = sums + [real(counted, dp), s1, s2, s3, s4]
   end subroutine add_powers

end module gyroakf_allan_difference_kurtosis
