! SPDX-License-Identifier: MIT
!> Residuals of an AR model over a stretch of its series, which may begin before it; without coefficients the centred series.
module gyroakf_stats_residual_block
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: residual_block

contains

   !> Residuals of a stretch of the series; 0 where there is none.
   !>
   !> $$e_t = (x_t - m) - c - \sum_j \phi_j (x_{t-j} - m)$$ for the t whose p predecessors exist and are present.
   pure subroutine residual_block(x, mean, phi, constant, first, e, flag, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean, coefficients, subtracted last
      real(dp), intent(in) :: mean, phi(:), constant
      !> Place of the first one, which may lie before the series
      integer(int64), intent(in) :: first
      !> Residuals, 1 where there is one and 0 elsewhere: [m]
      real(dp), intent(out), contiguous :: e(:), flag(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, start, last, shift
      integer :: j

      start = max(first, 1_int64 + size(phi))
      last = first + size(e) - 1
      shift = 1 - first
      e(:min(start, last + 1) - first) = 0.0_dp
      flag(:min(start, last + 1) - first) = 0.0_dp
      do i = start, last
         e(i + shift) = x(i) - mean - constant
         flag(i + shift) = 1.0_dp
      end do
      do j = 1, size(phi)
         do i = start, last
            e(i + shift) = e(i + shift) - phi(j)*(x(i - j) - mean)
         end do
      end do
      if (.not. present(valid)) return
      do j = 0, size(phi)
         do i = start, last
            flag(i + shift) = flag(i + shift)*real(valid(i - j), dp)
         end do
      end do
      do i = start, last
         e(i + shift) = merge(e(i + shift), 0.0_dp, flag(i + shift) > 0.5_dp)
      end do
   end subroutine residual_block

end module gyroakf_stats_residual_block
