! SPDX-License-Identifier: MIT
!> Degrees of freedom and limits of any statistic from a noise mixture, here a known one; that of a fit is `noise` from `fit_noise`:
!> `call give_mixture_limits(curve, noise)`.
!>
!> White noise and a random walk that meet at 17 samples: the degrees of freedom belong to neither of the two.
program example_mixture_limits
   use gyroakf, only : dp, int64, error_type, random_type, seed_random, fill_normal, allan_options, allan_curve_type, &
      compute_allan, noise_model_type, mixture_degrees_of_freedom, give_mixture_limits, statistic_names
   implicit none (type, external)
   integer(int64), parameter :: m(4) = [1_int64, 10_int64, 100_int64, 300_int64]
   type(noise_model_type) :: model
   type(error_type), allocatable :: error
   type(random_type) :: random
   type(allan_curve_type) :: curve
   real(dp) :: rate(1000)
   integer :: i, j

   model%squares(2) = 1.0_dp                                     ! N^2, per sample
   model%squares(4) = 0.01_dp                                    ! K^2
   print "(a, 4i9)", "m     ", m
   do i = 1, size(statistic_names)
      print "(a, 4f9.2)", statistic_names(i), (mixture_degrees_of_freedom(statistic_names(i), 1000_int64, m(j), model), j=1, 4)
   end do
   call seed_random(random, 1_int64)
   call fill_normal(random, rate)
   call compute_allan(rate, 1.0_dp, allan_options(kind="totdev", taus="1,10,100"), curve, error)
   if (allocated(error)) error stop error%message
   model%squares(4) = 0
   print "(a)", "totdev and its limits in white noise: the published formula, which is for long times, and the mixture"
   print "(f7.4, 2f9.4)", (curve%deviation(i), curve%lower(i), curve%upper(i), i=1, 3)
   call give_mixture_limits(curve, model)
   print "(f7.4, 2f9.4)", (curve%deviation(i), curve%lower(i), curve%upper(i), i=1, 3)
end program example_mixture_limits
