! SPDX-License-Identifier: MIT
!> AR coefficients: bias, stated errors, coverage of their intervals, by every method.
!>
!>     ./run.sh ar [RECORDS]
!>
!> Series i has the seed i; the order is the true one.
program ar
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : ar_model_type, ar_options, dp, error_type, fit_ar, int64, record_type, simulate_options, simulate_record
   use monte_carlo_table, only : argument_or, estimate_head, estimate_row
   implicit none (type, external)

   !> A process of variance 1; the second coefficient 0: of the first order
   type :: process_type
      integer(int64) :: samples
      real(dp) :: phi(2)
   end type process_type

   type(process_type), parameter :: processes(*) = [ &
      & process_type(1000_int64, [0.41_dp, 0.0_dp]), &
      & process_type(12000_int64, [0.41_dp, 0.0_dp]), &
      & process_type(1000_int64, [0.98_dp, 0.0_dp]), &
      & process_type(1000_int64, [1.2_dp, -0.5_dp])]
   character(4), parameter :: methods(3) = ["yw  ", "burg", "ols "]

   integer :: records, i

   records = argument_or(5000)
   do i = 1, size(processes)
      call study(processes(i), records)
   end do

contains

   !> All methods on the series of a process.
   subroutine study(process, records)
      type(process_type), intent(in) :: process
      integer, intent(in) :: records
      real(dp) :: value(records, 2, size(methods)), error(records, 2, size(methods))
      character(12) :: name
      integer :: i, j, k, p

      p = count(abs(process%phi) > 0)
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_series(process, p, i, value(i, :p, :), error(i, :p, :))
      end do
      !$omp end parallel do
      write (output_unit, "(/, a, i0, a, i0, a, i0, a)") "AR(", p, "): ", records, " series of ", process%samples, " samples"
      call estimate_head("")
      do k = 1, size(methods)
         do j = 1, p
            write (name, "(2a, i0)") methods(k), " phi_", j
            call estimate_row(name, process%phi(j), value(:, j, k), error(:, j, k), "")
         end do
      end do
   end subroutine study

   !> A series, fitted by every method.
   subroutine one_series(process, p, number, value, error)
      type(process_type), intent(in) :: process
      !> Order
      integer, intent(in) :: p
      !> Its number, which is its seed
      integer, intent(in) :: number
      !> Coefficients and stated errors: [p, methods]
      real(dp), intent(out) :: value(:, :), error(:, :)
      type(simulate_options) :: options
      type(record_type) :: record
      type(ar_options) :: how
      type(ar_model_type) :: model
      type(error_type), allocatable :: failure
      integer :: k

      options%samples = process%samples
      options%ar = process%phi(:p)
      options%ar_variance = 1
      options%seed = number
      call simulate_record(options, record, failure)
      do k = 1, size(methods)
         if (allocated(failure)) exit
         how%method = methods(k)
         how%max_order = p
         how%order = p
         call fit_ar(record%value(:, 1), how, model, failure)
         if (allocated(failure)) exit
         value(:, k) = model%coefficient
         error(:, k) = model%std_error
      end do
      if (.not. allocated(failure)) return
      write (error_unit, "(a, i0, 2a)") "series ", number, ": ", failure%message
      error stop
   end subroutine one_series

end program ar
