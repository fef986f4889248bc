! SPDX-License-Identifier: MIT
!> The model of drift and white noise by maximum likelihood: bias, stated errors, coverage; and how often the true model is chosen.
!>
!>     ./run.sh drift [RECORDS]
!>
!> Record i of every model has the seed i.
program drift
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : component_model_type, drift_fit_type, dp, error_type, fill_normal, fit_drift, int64, random_type, seed_random
   use monte_carlo_table, only : argument_or, estimate_head, estimate_row, first_order, fixed, percent
   implicit none (type, external)

   integer(int64), parameter :: samples = 4000
   character(8), parameter :: names(3) = [character(8) :: "walk", "ar1", "walk+ar1"]
   !> phi, q of each of two processes, r
   integer, parameter :: parameters = 5
   character(8), parameter :: title(parameters) = [character(8) :: "phi", "phi_2", "q", "q_2", "r"]

   integer :: records

   records = argument_or(5000)
   call study(1, component_model_type(1, [1.0_dp, 0.0_dp, 0.0_dp], [1.0e-6_dp, 0.0_dp, 0.0_dp], 4.2e-4_dp))
   call study(2, component_model_type(1, [0.98_dp, 0.0_dp, 0.0_dp], [4.0e-6_dp, 0.0_dp, 0.0_dp], 4.2e-4_dp))
   call study(3, component_model_type(2, [0.9_dp, 1.0_dp, 0.0_dp], [2.0e-5_dp, 1.0e-6_dp, 0.0_dp], 1.0e-4_dp))

contains

   !> The records of a model, fitted by the candidate of the same kind.
   subroutine study(kind, model)
      !> Which of the candidates
      integer, intent(in) :: kind
      type(component_model_type), intent(in) :: model
      real(dp), allocatable :: value(:, :), error(:, :)
      real(dp) :: truth(parameters)
      logical, allocatable :: fitted(:)
      integer, allocatable :: best(:)
      integer :: i, j

      allocate (value(records, parameters), error(records, parameters), fitted(records), best(records))
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(model, names(kind), i, value(i, :), error(i, :), fitted(i), best(i))
      end do
      !$omp end parallel do
      truth = parameters_of(model)
      write (output_unit, "(/, 2a, i0, a, i0, a)") trim(names(kind)), ": ", records, " records of ", samples, " samples"
      call estimate_head("")
      do j = 1, parameters
         if (truth(j) <= 0.0_dp .or. truth(j) >= 1.0_dp) cycle
         call estimate_row(title(j), truth(j), pack(value(:, j), fitted), pack(error(:, j), fitted), "")
      end do
      write (output_unit, "(/, 2a, *(a, a, a))") "With errors ", fixed(percent(fitted), 1), " %; chosen by AIC (%):", &
         & (" ", trim(names(j)), fixed(percent(best == j), 1), j=1, size(names))
   end subroutine study

   !> phi and q of two processes, r.
   pure function parameters_of(model) result(values)
      type(component_model_type), intent(in) :: model
      real(dp) :: values(parameters)

      values = [model%phi(1:2), model%q(1:2), model%r]
   end function parameters_of

   !> A record, fitted.
   subroutine one_record(model, name, number, value, error, fitted, best)
      type(component_model_type), intent(in) :: model
      !> Of the candidate
      character(*), intent(in) :: name
      !> Its number, which is its seed
      integer, intent(in) :: number
      !> The candidate's parameters and their stated errors: [parameters]
      real(dp), intent(out) :: value(:), error(:)
      !> The candidate is there, its errors are known
      logical, intent(out) :: fitted
      !> The candidate of the smallest AIC
      integer, intent(out) :: best
      type(random_type) :: random
      type(drift_fit_type) :: fit
      type(error_type), allocatable :: failure
      real(dp), dimension(samples) :: z, part
      integer :: k

      call seed_random(random, int(number, int64))
      call fill_normal(random, z)
      z = sqrt(model%r)*z
      do k = 1, model%count
         call first_order(random, model%phi(k), model%q(k), part)
         z = z + part
      end do
      call fit_drift(z, fit, failure)
      if (allocated(failure)) then
         write (error_unit, "(a, i0, 2a)") "record ", number, ": ", failure%message
         error stop
      end if
      value = 0.0_dp
      error = 0.0_dp
      fitted = .false.
      do k = 1, size(fit%candidate)
         if (fit%candidate(k)%name /= name) cycle
         value = parameters_of(fit%candidate(k)%model)
         error = parameters_of(fit%candidate(k)%std_error)
         fitted = fit%candidate(k)%errors_known
      end do
      best = findloc(names, fit%candidate(fit%best)%name, dim=1)
   end subroutine one_record

end program drift
