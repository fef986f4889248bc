! SPDX-License-Identifier: MIT
!> Time of three readings of a file, the median: `read_speed FILE COLUMN`; prints seconds, samples, their sum, and the bytes of the
!> largest memory that the process had.
program read_speed
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use gyroakf, only : dp, error_type, read_record, reader_options, record_type
   implicit none (type, external)

   call main()

contains

   subroutine main()
      type(record_type) :: record
      type(reader_options) :: options
      type(error_type), allocatable :: error
      character(1024) :: path, column
      integer(int64) :: start, finish, per_second
      real(dp) :: seconds(3)
      integer :: k

      call get_command_argument(1, path)
      call get_command_argument(2, column)
      options%columns = "1"
      if (len_trim(column) > 0) options%columns = trim(column)
      do k = 1, size(seconds)
         call system_clock(start, per_second)
         call read_record(trim(path), options, record, error)
         call system_clock(finish)
         if (allocated(error)) then
            write (error_unit, "(a)") error%message
            error stop
         end if
         seconds(k) = real(finish - start, dp)/real(per_second, dp)
      end do
      write (*, "(f12.6, 1x, i0, 1x, es24.16, 1x, i0)") sum(seconds) - minval(seconds) - maxval(seconds), record%audit%samples, &
         sum(record%value(:, 1)), peak_bytes()
   end subroutine main

   !> The largest memory of this process, 0 where the system does not tell.
   integer(int64) function peak_bytes() result(peak)
      character(256) :: line
      integer :: unit, failed

      peak = 0
      open (newunit=unit, file="/proc/self/status", action="read", status="old", iostat=failed)
      do while (failed == 0)
         read (unit, "(a)", iostat=failed) line
         if (failed /= 0) exit
         if (line(:6) == "VmHWM:") read (line(7:index(line, "kB") - 1), *) peak
      end do
      close (unit)
      peak = 1024*peak
   end function peak_bytes

end program read_speed
