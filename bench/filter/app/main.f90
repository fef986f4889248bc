! SPDX-License-Identifier: MIT
!> Time of a filter step, medians of seven runs over a million samples; the lines are read by run.sh.
program bench_filter
   use, intrinsic :: iso_fortran_env, only : int64
   use gyroakf, only : dp, error_type, filter_options, filter_type, new_filter, run_filter, step_filter
   use gyroakf_simulate_random, only : random_type, seed_random, fill_normal
   implicit none (type, external)

   call report("Kalman, scalar", 1, "", 0.0_dp, 8.0_dp)
   call report("Sage-Husa Q R, scalar", 1, "QR", 0.0_dp, 15.0_dp)
   call report("Sage-Husa R, Huber, scalar", 1, "R", 2.5_dp, 20.0_dp)
   call report("Sage-Husa q r Q R, scalar", 1, "qrQR", 0.0_dp, 0.0_dp)
   call report("Kalman, AR(4)", 4, "", 0.0_dp, 0.0_dp)
   call report("Sage-Husa Q R, AR(4)", 4, "QR", 0.0_dp, 120.0_dp)
   call report_steps("Kalman, step by step", "", 25.0_dp)
   call report_steps("Sage-Husa, step by step", "QR", 25.0_dp)

contains

   !> A filter, and a series of its model
   subroutine prepare(order, letters, huber, filter, z)
      integer, intent(in) :: order
      character(*), intent(in) :: letters
      real(dp), intent(in) :: huber
      type(filter_type), intent(out) :: filter
      real(dp), intent(out) :: z(:)
      real(dp), parameter :: phi(4) = [0.4_dp, 0.2_dp, -0.1_dp, 0.05_dp]
      type(filter_options) :: options
      type(error_type), allocatable :: error
      type(random_type) :: random
      integer :: k

      call seed_random(random, 1_int64)
      call fill_normal(random, z)
      do k = order + 1, size(z)
         z(k) = z(k) + dot_product(phi(:order), z(k - 1:k - order:-1))
      end do
      options%estimate_process_mean = index(letters, "q") > 0
      options%estimate_measurement_mean = index(letters, "r") > 0
      options%estimate_process_variance = index(letters, "Q") > 0
      options%estimate_measurement_variance = index(letters, "R") > 0
      if (letters /= "R") options%measurement_form = "paper"
      options%huber = huber
      call new_filter(filter, phi(:order), 1.0_dp, 1.2_dp, options, error)
      if (allocated(error)) error stop "the filter is not made"
   end subroutine prepare

   !> One line: name, nanoseconds, the figure to reach (0: none)
   subroutine report(name, order, letters, huber, goal)
      character(*), intent(in) :: name, letters
      integer, intent(in) :: order
      real(dp), intent(in) :: huber, goal
      type(filter_type) :: filter, fresh
      real(dp), allocatable :: z(:), x(:)
      real(dp) :: time(7)
      integer(int64) :: start, finish, rate
      integer :: i

      allocate (z(1000000), x(1000000))
      call prepare(order, letters, huber, fresh, z)
      do i = 1, size(time)
         filter = fresh
         call system_clock(start)
         call run_filter(filter, z, x)
         call system_clock(finish, rate)
         time(i) = 1.0e9_dp*real(finish - start, dp)/real(rate, dp)/size(z)
      end do
      call line(name, time, goal)
   end subroutine report

   !> The same through step_filter
   subroutine report_steps(name, letters, goal)
      character(*), intent(in) :: name, letters
      real(dp), intent(in) :: goal
      type(filter_type) :: filter, fresh
      real(dp), allocatable :: z(:), x(:)
      real(dp) :: time(7)
      integer(int64) :: start, finish, rate
      integer :: i, k

      allocate (z(1000000), x(1000000))
      call prepare(1, letters, 0.0_dp, fresh, z)
      do i = 1, size(time)
         filter = fresh
         call system_clock(start)
         do k = 1, size(z)
            call step_filter(filter, z(k), x(k))
         end do
         call system_clock(finish, rate)
         time(i) = 1.0e9_dp*real(finish - start, dp)/real(rate, dp)/size(z)
      end do
      call line(name, time, goal)
   end subroutine report_steps

   !> Median and fastest run
   subroutine line(name, time, goal)
      character(*), intent(in) :: name
      real(dp), intent(inout) :: time(:)
      real(dp), intent(in) :: goal
      real(dp) :: least
      integer :: i, k

      do i = 1, size(time)
         k = minloc(time(i:), 1) + i - 1
         least = time(k)
         time(k) = time(i)
         time(i) = least
      end do
      if (goal > 0) then
         print "(a28, f9.1, f9.1, a, f5.0, a)", name, time(size(time)/2 + 1), time(1), "   goal", goal, " ns"
      else
         print "(a28, f9.1, f9.1)", name, time(size(time)/2 + 1), time(1)
      end if
   end subroutine line
end program bench_filter
