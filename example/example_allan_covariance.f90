! SPDX-License-Identifier: MIT
!> Correlation of Allan variances at neighboring averaging times: why a fit must not take them for independent.
program example_allan_covariance
   use gyroakf, only : dp, int64
   use gyroakf_allan_fit_covariance, only : covariance_basis, mixture_covariances
   implicit none (type, external)
   integer(int64), parameter :: m(5) = [100_int64, 120_int64, 144_int64, 200_int64, 400_int64]
   real(dp), parameter :: squares(5) = [0.0_dp, 1.0_dp, 0.01_dp, 0.0_dp, 0.0_dp]   ! Q^2 N^2 B^2 K^2 R^2, sample interval 1
   real(dp) :: c(5, 5)
   integer :: i, j

   c = mixture_covariances(covariance_basis(100000_int64, m), squares)
   do i = 1, 5
      print "(i4, a, 5f8.4)", m(i), ":", (c(i, j)/sqrt(c(i, i)*c(j, j)), j=1, 5)
   end do
end program example_allan_covariance
