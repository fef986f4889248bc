! SPDX-License-Identifier: MIT
!> R alone adapted, from an R that is wrong by a factor of a thousand, Q right: RMSE over the oracle's on C1.
!>
!>     ./run.sh start [SEEDS]
program start
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf, only : component_model_type, dp, drift_filter_type, error_type, filter_options, filter_type, &
      & new_drift_filter, new_filter, run_filter
   use gyroakf_stats_differences, only : difference_variance
   use filter_truth_cases, only : make_world, samples, world_type
   use filter_truth_figures, only : median, quantile, root_mean_square, table_head, table_row
   use filter_truth_oracle, only : ask_oracle
   implicit none (type, external)

   real(dp), parameter :: wrong(5) = [1.0e-3_dp, 0.1_dp, 1.0_dp, 10.0_dp, 1.0e3_dp], memory(3) = [0.98_dp, 0.99_dp, 0.995_dp]
   character(8), parameter :: forms(2) = [character(8) :: "residual", "exact"]
   type(world_type), allocatable :: world(:)
   real(dp), allocatable :: oracle(:), x(:), y(:)
   character(20) :: word
   integer :: seeds, s, f, b, gate

   seeds = 100
   if (command_argument_count() > 0) call get_command_argument(1, word)
   if (command_argument_count() > 0) read (word, *) seeds
   allocate (world(seeds), oracle(seeds), x(samples), y(samples))
   do s = 1, seeds
      call make_world("C1", s, samples, world(s))
      call ask_oracle(world(s), x, y)
      oracle(s) = root_mean_square(x, world(s)%truth)
   end do
   write (output_unit, "(a, i0, 2a, /)") "C1, ", seeds, " records; RMSE over the oracle's, median [95 % of the records are ", &
      & "below], where R starts at so many times the right one:"
   call table_head("form, b, gate", [character(6) :: "0.001", "0.1", "1", "10", "1000"])
   do f = 1, size(forms)
      do b = 1, size(memory)
         do gate = 1, 2
            call show(forms(f), memory(b), merge(2.5_dp, 0.0_dp, gate == 2), .true.)
         end do
      end do
   end do
   call show("residual", 0.995_dp, 2.5_dp, .false.)

contains

   !> A row.
   subroutine show(form, forgetting, huber, drift)
      character(*), intent(in) :: form
      real(dp), intent(in) :: forgetting, huber
      !> new_drift_filter, otherwise new_filter
      logical, intent(in) :: drift
      character(24) :: cells(size(wrong))
      character(60) :: name
      real(dp) :: ratio(seeds)
      integer :: k, s

      do k = 1, size(wrong)
         do s = 1, seeds
            call run(world(s), wrong(k), form, forgetting, huber, drift, x)
            ratio(s) = root_mean_square(x, world(s)%truth)/oracle(s)
         end do
         write (cells(k), "(f8.3, a, f5.3, a)") median(ratio), " [", quantile(ratio, 0.95_dp), "]"
      end do
      write (name, "(3a, f5.3, a, f3.1)") trim(form), trim(merge("          ", ", AR state", drift)), ", ", forgetting, ", ", huber
      call table_row(name, cells)
   end subroutine show

   !> A filter on a record without its cubic.
   subroutine run(world, factor, form, forgetting, huber, drift, x)
      type(world_type), intent(in) :: world
      real(dp), intent(in) :: factor, forgetting, huber
      character(*), intent(in) :: form
      logical, intent(in) :: drift
      real(dp), intent(out), contiguous :: x(:)
      type(filter_options) :: options
      type(component_model_type) :: model
      type(filter_type) :: of_series
      type(drift_filter_type) :: of_drift
      type(error_type), allocatable :: error
      real(dp), allocatable :: z(:)

      allocate (z, source=world%z - world%trend)
      options%estimate_measurement_variance = .true.
      options%measurement_form = form
      options%forgetting = forgetting
      options%huber = huber
      options%burn_in = -1
      options%r_scale = 0.5_dp*difference_variance(z)
      model%count = 1
      model%phi(1) = world%transition(1, 1)
      model%q(1) = world%q(1)
      model%r = factor*world%r(1)
      if (drift) then
         call new_drift_filter(of_drift, model, [.true.], options, error)
      else
         call new_filter(of_series, model%phi(:1), model%q(1), model%r, options, error)
      end if
      if (allocated(error)) error stop error%message
      if (drift) call run_filter(of_drift, z, x)
      if (.not. drift) call run_filter(of_series, z, x)
      x = x + world%trend
   end subroutine run
end program start
