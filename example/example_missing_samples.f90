! SPDX-License-Identifier: MIT
!> Missing samples keep their place: they are marked, not deleted, and the curve stays where it is.
program example_missing_samples
   use gyroakf, only : dp, int8, int64, error_type, random_type, seed_random, fill_normal, allan_options, allan_curve_type, &
      compute_allan
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(random_type) :: random
   type(allan_curve_type) :: whole, gaps
   real(dp) :: rate(20000)
   integer(int8) :: present(20000)
   integer :: i

   call seed_random(random, 3_int64)
   call fill_normal(random, rate)
   present = 1
   present(7000:7400) = 0                                        ! a gap, and every 50th sample
   present(::50) = 0
   call compute_allan(rate, 0.01_dp, allan_options(taus="0.01,0.1,1,10"), whole, error)
   if (.not. allocated(error)) call compute_allan(rate, 0.01_dp, allan_options(taus="0.01,0.1,1,10"), gaps, error, present)
   if (allocated(error)) error stop error%message
   print "(a)", "    tau     whole    marked  terms  share of the freedom"
   print "(f7.2, 2f10.5, i7, f9.3)", (whole%tau(i), whole%deviation(i), gaps%deviation(i), gaps%terms(i), gaps%share(i), i=1, 4)
end program example_missing_samples
