! SPDX-License-Identifier: MIT
!> Order and coefficients of an AR model of a simulated series.
program example_ar_model
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, ar_options, ar_model_type, fit_ar
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(simulate_options) :: noise
   type(record_type) :: record
   type(ar_model_type) :: model
   integer :: i

   noise%ar = [0.6_dp, -0.2_dp]
   noise%ar_variance = 1.0_dp
   call simulate_record(noise, record, error)
   if (.not. allocated(error)) call fit_ar(record%value(:, 1), ar_options(criterion="bic", max_order=6), model, error)
   if (allocated(error)) error stop error%message
   print "(i3, f12.2)", (model%table(i)%order, model%table(i)%bic, i=lbound(model%table, 1), ubound(model%table, 1))
   print "(a, i0)", "order ", model%order
   print "(a, i0, a, f0.4, a, f0.4)", ("phi_", i, " = ", model%coefficient(i), " +/- ", model%std_error(i), i=1, model%order)
end program example_ar_model
