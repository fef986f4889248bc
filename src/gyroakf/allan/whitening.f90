! SPDX-License-Identifier: MIT
!> Independent combinations of correlated points.
module gyroakf_allan_whitening
   use gyroakf_kinds, only : dp
   use gyroakf_lapack, only : dpotrf, dsyev, dtrtri
   implicit none (type, external)
   private
   public :: whitening

   !> Eigenvalues of the correlation matrix below this share of the largest one carry no
   !> information: neighboring averaging times say almost the same, and what differs is below the
   !> accuracy of the covariance
   real(dp), parameter :: eigenvalue_share = 1e-3_dp

contains

   !> Combinations of the points that are independent and of variance 1.
   !>
   !> Where every eigenvalue of the correlation matrix R = U'U is above the share of the largest
   !> one, any root serves, and U'^(-1) is had at once. That is so where 1/trace(R^(-1)), a lower
   !> bound of the least one, is above the share of the largest sum of a row.
   subroutine whitening(covariance, axes)
      !> Covariance of the points, positive diagonal
      real(dp), intent(in) :: covariance(:, :)
      !> One in each row: [kept, points]
      real(dp), allocatable, intent(out) :: axes(:, :)

      real(dp), dimension(size(covariance, 1)) :: deviation, value
      real(dp), dimension(size(covariance, 1), size(covariance, 1)) :: correlation, vector
      real(dp) :: work(64*size(covariance, 1) + 64)
      integer :: i, n, kept, info

      n = size(deviation)
      do i = 1, n
         deviation(i) = sqrt(covariance(i, i))
      end do
      do i = 1, n
         correlation(:, i) = covariance(:, i)/(deviation*deviation(i))
      end do
      vector = correlation
      call dpotrf("U", n, vector, n, info)
      if (info == 0) call dtrtri("U", "N", n, vector, n, info)
      if (info == 0) then
         do i = 1, n
            vector(i + 1:, i) = 0
         end do
         if (sum(vector**2)*maxval(sum(abs(correlation), dim=1))*eigenvalue_share < 1) then
            allocate (axes(n, n))
            do i = 1, n
               axes(:, i) = vector(i, :)/deviation(i)
            end do
            return
         end if
      end if
      vector = correlation
      call dsyev("V", "U", n, vector, n, value, work, size(work), info)
      kept = 0
      if (info == 0) kept = count(value > eigenvalue_share*value(n))
      allocate (axes(kept, n))
      do i = 1, kept                                        ! the last ones: dsyev sorts upwards
         axes(i, :) = vector(:, n - kept + i)/(deviation*sqrt(value(n - kept + i)))
      end do
   end subroutine whitening

end module gyroakf_allan_whitening
