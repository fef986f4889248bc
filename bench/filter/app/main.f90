! SPDX-License-Identifier: MIT
!> Processor time of a filter step over a series, medians of 15 runs over a million samples; the lines are read by run.sh.
program bench_filter
   use, intrinsic :: iso_fortran_env, only : int64
   use gyroakf, only : component_model_type, dp, drift_filter_type, error_type, filter_options, filter_type, new_drift_filter, &
      new_filter, run_filter
   use gyroakf_random, only : random_type, seed_random, fill_normal
   implicit none (type, external)
   integer, parameter :: samples = 1000000, runs = 15

   print "(a, t31, 2a9, a8)", "Fortran, over a series", "median", "fastest", "goal"
   call report("Kalman", 1, "", 0.0_dp, 8.0_dp)
   call report("Sage-Husa Q R", 1, "QR", 0.0_dp, 15.0_dp)
   call report("Sage-Husa R, Huber", 1, "R", 2.5_dp, 20.0_dp)
   call report("Sage-Husa Q R, Huber", 1, "QR", 2.5_dp, 20.0_dp)
   call report("Sage-Husa q r Q R", 1, "qrQR", 0.0_dp, 20.0_dp)
   call report("Kalman, AR(4)", 4, "", 0.0_dp, 120.0_dp)
   call report("Sage-Husa Q R, AR(4)", 4, "QR", 0.0_dp, 120.0_dp)
   call report_drift("drift, walk", 1, .false.)
   call report_drift("drift, walk, adaptive", 1, .true.)
   call report_drift("drift, walk and AR(1)", 2, .false.)
   call report_drift("drift, walk and AR(1), adapt.", 2, .true.)

contains

   !> The AR filter
   subroutine report(name, order, letters, huber, goal)
      character(*), intent(in) :: name, letters
      integer, intent(in) :: order
      real(dp), intent(in) :: huber, goal
      real(dp), parameter :: phi(4) = [0.4_dp, 0.2_dp, -0.1_dp, 0.05_dp]
      type(filter_options) :: options
      type(filter_type) :: filter
      type(error_type), allocatable :: error
      real(dp), allocatable :: z(:)
      integer :: k

      call white(z)
      do k = order + 1, samples
         z(k) = z(k) + dot_product(phi(:order), z(k - 1:k - order:-1))
      end do
      options%estimate_process_mean = index(letters, "q") > 0
      options%estimate_measurement_mean = index(letters, "r") > 0
      options%estimate_process_variance = index(letters, "Q") > 0
      options%estimate_measurement_variance = index(letters, "R") > 0
      options%allow_unobservable = .true.
      if (letters /= "R") options%measurement_form = "paper"
      options%huber = huber
      call new_filter(filter, phi(:order), 1.0_dp, 1.2_dp, options, error)
      if (allocated(error)) error stop error%message
      call measure(name, filter, z, goal)
   end subroutine report

   !> The drift filter of so many processes; adaptive: R, with burn-in and gate, as drift_akf has it
   subroutine report_drift(name, processes, adaptive)
      character(*), intent(in) :: name
      integer, intent(in) :: processes
      logical, intent(in) :: adaptive
      type(filter_options) :: options
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      type(error_type), allocatable :: error
      real(dp), allocatable :: z(:)
      real(dp) :: level
      integer :: k

      model%count = processes
      model%phi(:2) = [1.0_dp, 0.98_dp]
      model%q(:2) = [1.0e-4_dp, 1.0e-2_dp]
      model%r = 1.0_dp
      call white(z)
      level = 0.0_dp
      do k = 1, samples
         level = level + 0.01_dp*z(1 + mod(7*k, samples))
         z(k) = z(k) + level
      end do
      options%estimate_measurement_variance = adaptive
      if (adaptive) then
         options%forgetting = 0.995_dp
         options%huber = 2.5_dp
         options%burn_in = -1
      end if
      call new_drift_filter(filter, model, [(.true., k=1, processes)], options, error)
      if (allocated(error)) error stop error%message
      call measure(name, filter, z, 0.0_dp)
   end subroutine report_drift

   !> White noise
   subroutine white(z)
      real(dp), allocatable, intent(out) :: z(:)
      type(random_type) :: random

      allocate (z(samples))
      call seed_random(random, 1_int64)
      call fill_normal(random, z)
   end subroutine white

   !> One line: name, median and fastest nanoseconds a step, the figure to reach (0: none)
   subroutine measure(name, fresh, z, goal)
      character(*), intent(in) :: name
      class(filter_type), intent(in) :: fresh
      real(dp), intent(in) :: z(:), goal
      class(filter_type), allocatable :: filter
      real(dp), allocatable :: x(:)
      real(dp) :: time(runs), least, start, finish
      integer :: i, k

      allocate (x(size(z)))
      do i = 1, runs
         if (allocated(filter)) deallocate (filter)
         allocate (filter, source=fresh)
         call cpu_time(start)
         call run_filter(filter, z, x)
         call cpu_time(finish)
         time(i) = 1.0e9_dp*(finish - start)/size(z)
      end do
      do i = 1, runs
         k = minloc(time(i:), 1) + i - 1
         least = time(k)
         time(k) = time(i)
         time(i) = least
      end do
      if (goal > 0) then
         print "(a, t31, 2f9.1, f8.0)", name, time((runs + 1)/2), time(1), goal
      else
         print "(a, t31, 2f9.1)", name, time((runs + 1)/2), time(1)
      end if
   end subroutine measure
end program bench_filter
