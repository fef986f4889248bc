! SPDX-License-Identifier: MIT
!> Time and memory of the statistics of a series: `bench_series FILE PART THREADS`, FILE of 8-byte reals. One line a PART:
!>
!>     wall seconds, processor seconds, kB that the call added to the largest memory of the program, figures
!>
!> A part is a case in `run_part`; compare.py has the same name for the peer's call and for how the figures compare.
program bench_series
   use, intrinsic :: iso_fortran_env, only : int64
   use omp_lib, only : omp_set_num_threads, omp_get_wtime
   use gyroakf, only : dp, error_type, adf_options, adf_type, test_adf, ar_options, ar_model_type, fit_ar, &
      & ljung_box_type, test_ljung_box, kpss_options, kpss_type, test_kpss
   implicit none (type, external)

   call run()

contains

   !> Reads the series, runs the part up to seven times or about three seconds.
   subroutine run()
      character(256) :: path, part, threads
      real(dp), allocatable :: x(:)
      integer(int64) :: bytes
      integer :: unit, number

      call get_command_argument(1, path)
      call get_command_argument(2, part)
      call get_command_argument(3, threads)
      read (threads, *) number
      call omp_set_num_threads(number)
      open (newunit=unit, file=trim(path), access="stream", form="unformatted", status="old", action="read")
      inquire (unit, size=bytes)
      allocate (x(bytes/8))
      read (unit) x
      close (unit)
      call measure(trim(part), x)
   end subroutine run

   !> Medians of the runs.
   subroutine measure(part, x)
      !> What to run
      character(*), intent(in) :: part
      !> The series
      real(dp), intent(in), contiguous :: x(:)
      real(dp) :: wall(7), used(7), begin, cpu0, cpu1, total, figure(4)
      integer(int64) :: before, after
      integer :: i, runs

      total = 0.0_dp
      runs = 0
      call run_part(part, x(:min(20000, size(x))), figure)       ! brings in the code and the linear algebra's own buffers
      before = peak_memory()
      do i = 1, size(wall)
         call cpu_time(cpu0)
         begin = omp_get_wtime()
         call run_part(part, x, figure)
         wall(i) = omp_get_wtime() - begin
         call cpu_time(cpu1)
         used(i) = cpu1 - cpu0
         runs = i
         total = total + wall(i)
         if (i == 1) after = peak_memory()
         if (total > 3.0_dp .and. mod(i, 2) == 1) exit
      end do
      print "(2es14.5, i10, 4es24.16)", median(wall(:runs)), median(used(:runs)), after - before, figure
   end subroutine measure

   !> One call, and figures to compare.
   subroutine run_part(part, x, figure)
      !> What to run
      character(*), intent(in) :: part
      !> The series
      real(dp), intent(in), contiguous :: x(:)
      !> Figures, 0 where there are fewer
      real(dp), intent(out) :: figure(4)
      type(error_type), allocatable :: error
      type(adf_type) :: adf
      type(ar_model_type) :: model
      type(ljung_box_type) :: test
      type(kpss_type) :: kpss

      figure = 0.0_dp
      select case (part)
      case ("adf")
         call test_adf(x, adf_options(), adf, error)
         figure(:3) = [adf%statistic, real(adf%lag, dp), adf%p_value]
      case ("ar")
         call fit_ar(x, ar_options(max_order=12), model, error)
         if (.not. allocated(error)) figure(:2) = [real(model%order, dp), model%coefficient(1)]
      case ("burg")
         call fit_ar(x, ar_options(method="burg", order=10), model, error)
         if (.not. allocated(error)) figure = [model%coefficient(1), model%coefficient(2), model%coefficient(10), &
                                               & model%noise_variance]
      case ("kpss")
         call test_kpss(x, kpss_options(), kpss, error)
         figure(:3) = [kpss%statistic, real(kpss%lags, dp), kpss%p_value]
      case ("ljung_box")
         call test_ljung_box(x, 20, 0, test, error)
         figure(:2) = [test%statistic, test%p_value]
      case default
         error stop "unknown part"
      end select
      if (allocated(error)) then
         print "(a)", error%message
         error stop 1
      end if
   end subroutine run_part

   !> Largest resident memory so far, kB; 0 where the system does not tell.
   integer(int64) function peak_memory()
      character(128) :: line
      integer :: unit, stat

      peak_memory = 0
      open (newunit=unit, file="/proc/self/status", action="read", status="old", iostat=stat)
      if (stat /= 0) return
      do
         read (unit, "(a)", iostat=stat) line
         if (stat /= 0) exit
         if (line(:6) == "VmHWM:") read (line(7:), *) peak_memory
      end do
      close (unit)
   end function peak_memory

   !> Median of an odd number of values.
   real(dp) function median(values)
      !> At most seven
      real(dp), intent(in) :: values(:)
      integer :: i

      median = values(1)
      do i = 1, size(values)
         if (count(values < values(i)) <= size(values)/2 .and. count(values > values(i)) <= size(values)/2) median = values(i)
      end do
   end function median

end program bench_series
