! SPDX-License-Identifier: MIT
!> Total deviation: at long averaging times it has more degrees of freedom than the overlapping Allan deviation.
program example_totdev
   use gyroakf, only : dp, int64, error_type, random_type, seed_random, fill_normal, allan_options, allan_curve_type, compute_allan
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(random_type) :: random
   type(allan_curve_type) :: allan, total
   real(dp) :: rate(1024)
   integer :: i

   call seed_random(random, 1_int64)
   call fill_normal(random, rate)
   call compute_allan(rate, 1.0_dp, allan_options(taus="64,128,256,512"), allan, error)
   if (.not. allocated(error)) call compute_allan(rate, 1.0_dp, allan_options(kind="totdev", taus="64,128,256,512"), total, error)
   if (allocated(error)) error stop error%message
   print "(a)", "   tau     oadev   edf    totdev   edf"
   print "(f6.0, f10.5, f6.1, f10.5, f6.1)", (allan%tau(i), allan%deviation(i), allan%edf(i), total%deviation(i), &
                                                total%edf(i), i=1, 4)
end program example_totdev
