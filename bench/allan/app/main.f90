! SPDX-License-Identifier: MIT
!> Time of the Allan statistics at octave averaging times, one and two threads, median of five.
!>
!> Reads raw doubles from a file, so that others can be given the same numbers:
!>
!>     allan_speed FILE KIND...    prints for each kind and number of threads: kind, threads, seconds, seconds of one read
!>                                 pass, deviations at 1, 2, 4 samples; then the peak memory in bytes (Linux, else 0)
program allan_speed
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use omp_lib, only : omp_get_wtime, omp_set_num_threads
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, int64
   implicit none (type, external)

   integer, parameter :: repeats = 5
   type(allan_options) :: options
   type(allan_curve_type) :: curve
   type(error_type), allocatable :: error
   real(dp), allocatable :: rate(:)
   real(dp) :: seconds(repeats), pass(repeats), start, total
   character(1000) :: path
   character(8) :: kind
   integer :: unit, threads, i, k
   integer(int64) :: bytes

   call get_command_argument(1, path)
   open (newunit=unit, file=trim(path), access="stream", form="unformatted", action="read", status="old")
   inquire (unit=unit, size=bytes)
   allocate (rate(bytes/8))
   read (unit) rate
   close (unit)
   total = 0
   do k = 2, command_argument_count()
      call get_command_argument(k, kind)
      options%kind = kind
      do threads = 1, 2
         call omp_set_num_threads(threads)
         do i = 1, repeats
            start = omp_get_wtime()
            call compute_allan(rate, 1.0_dp, options, curve, error)
            seconds(i) = omp_get_wtime() - start
            if (allocated(error)) then
               write (error_unit, "(a)") error%message
               stop 1, quiet=.true.
            end if
            start = omp_get_wtime()
            total = total + read_pass(rate)
            pass(i) = omp_get_wtime() - start
         end do
         write (output_unit, "(a, 1x, i0, 2f10.5, 3es24.16)") trim(kind), threads, median(seconds), median(pass), &
            & curve%deviation(:3)
      end do
   end do
   call peak_memory(bytes)
   write (output_unit, "(i0)") bytes
   if (total < -huge(total)) write (output_unit, "(a)") "the sum is needed"

contains

   !> Sum of all values in four chains: what it costs to read them once.
   pure real(dp) function read_pass(x)
      !> The values
      real(dp), intent(in) :: x(:)

      integer(int64) :: i, q
      real(dp) :: s(4)

      q = size(x, kind=int64)/4
      s = 0
      do i = 1, q
         s(1) = s(1) + x(i)
         s(2) = s(2) + x(i + q)
         s(3) = s(3) + x(i + 2*q)
         s(4) = s(4) + x(i + 3*q)
      end do
      read_pass = sum(s)
   end function read_pass

   !> Largest resident memory of this process so far.
   subroutine peak_memory(peak)
      !> Bytes, 0 where it is not told
      integer(int64), intent(out) :: peak

      character(200) :: line
      integer :: status_unit, stat

      peak = 0
      open (newunit=status_unit, file="/proc/self/status", action="read", status="old", iostat=stat)
      if (stat /= 0) return
      do
         read (status_unit, "(a)", iostat=stat) line
         if (stat /= 0) exit
         if (line(:6) == "VmHWM:") read (line(7:index(line, "kB") - 1), *) peak
      end do
      close (status_unit)
      peak = 1024*peak
   end subroutine peak_memory

   !> The middle one of five.
   pure real(dp) function median(x)
      !> Times
      real(dp), intent(in) :: x(repeats)

      integer :: j

      median = x(1)
      do j = 1, repeats
         if (count(x < x(j)) <= repeats/2 .and. count(x <= x(j)) > repeats/2) median = x(j)
      end do
   end function median

end program allan_speed
