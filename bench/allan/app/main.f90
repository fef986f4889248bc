! SPDX-License-Identifier: MIT
!> Time of the Allan statistics at octave averaging times, one and two threads, median of five.
!>
!> Reads raw doubles from a file, so that others can be given the same numbers:
!>
!>     allan_speed FILE KIND...    prints for each kind and number of threads: kind, threads, seconds, seconds of one read
!>                                 pass of one thread and of two, deviations at 1, 2, 4 samples; then the peak memory in
!>                                 bytes (Linux, else 0)
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
   real(dp) :: seconds(repeats), pass(repeats, 2), start, total
   character(1000) :: path
   character(8) :: kind
   integer :: unit, threads, readers, i, k
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
            do readers = 1, 2
               start = omp_get_wtime()
               total = total + read_pass(rate, readers)
               pass(i, readers) = omp_get_wtime() - start
            end do
         end do
         write (output_unit, "(a, 1x, i0, 3f10.5, 3es24.16)") trim(kind), threads, median(seconds), median(pass(:, 1)), &
            & median(pass(:, 2)), curve%deviation(:3)
      end do
   end do
   call peak_memory(bytes)
   write (output_unit, "(i0)") bytes
   if (total < -huge(total)) write (output_unit, "(a)") "the sum is needed"

contains

   !> Sum of all values: what it costs to read them once.
   real(dp) function read_pass(x, threads)
      !> The values
      real(dp), intent(in), contiguous :: x(:)
      !> Threads that share them
      integer, intent(in) :: threads

      integer(int64) :: i, quarter
      real(dp) :: s1, s2, s3, s4

      quarter = size(x, kind=int64)/4
      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      !$omp parallel do simd num_threads(threads) reduction(+:s1, s2, s3, s4)
      do i = 1, quarter                                     ! four chains: one alone waits for its additions
         s1 = s1 + x(i)
         s2 = s2 + x(i + quarter)
         s3 = s3 + x(i + 2*quarter)
         s4 = s4 + x(i + 3*quarter)
      end do
      !$omp end parallel do simd
      read_pass = (s1 + s2) + (s3 + s4)
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
