! SPDX-License-Identifier: MIT
!> Tests of the five terms against numbers from the literature: what the fit and its tests take for granted.
module test_allan_noise_model
   use gyroakf_kinds, only : dp
   use gyroakf_allan_noise_model, only : model_variance
   use expectations, only : test, error, check
   implicit none (type, external)
   private
   public :: suite_allan_noise_model

contains

   subroutine suite_allan_noise_model()
      call test("terms", test_terms)
   end subroutine suite_allan_noise_model

   subroutine test_terms()
      ! IEEE Std 952, annex C, at tau = 4: 3 Q^2/tau^2, N^2/tau, (2 ln 2/pi) B^2 with sqrt(2 ln 2/pi) = 0.664282...,
      ! K^2 tau/3, R^2 tau^2/2
      real(dp), parameter :: expected(5) = [0.1875_dp, 0.25_dp, 0.44127120030530298_dp, 4.0_dp/3, 8.0_dp]
      real(dp) :: squares(5)
      integer :: i

      do i = 1, 5
         squares = 0
         squares(i) = 1
         call check(error, model_variance(squares, 4.0_dp), expected(i), thr=1.0e-14_dp, rel=.true.)
      end do
   end subroutine test_terms

end module test_allan_noise_model
