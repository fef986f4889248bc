! SPDX-License-Identifier: MIT
!> Median time of five readings of a file: `read_speed FILE`; prints seconds, samples, the sum of the first channel.
program read_speed
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use gyroakf, only : dp, error_type, read_record, reader_options, record_type
   implicit none (type, external)

   call main()

contains

   subroutine main()
      type(record_type) :: record
      type(error_type), allocatable :: error
      character(1024) :: path
      integer(int64) :: start, finish, per_second
      real(dp) :: seconds(5), held
      integer :: k, j

      call get_command_argument(1, path)
      do k = 1, size(seconds)
         call system_clock(start, per_second)
         call read_record(trim(path), reader_options(), record, error)
         call system_clock(finish)
         if (allocated(error)) then
            write (error_unit, "(a)") error%message
            error stop
         end if
         seconds(k) = real(finish - start, dp)/real(per_second, dp)
      end do
      do k = 2, size(seconds)
         do j = k, 2, -1
            if (seconds(j) >= seconds(j - 1)) exit
            held = seconds(j)
            seconds(j) = seconds(j - 1)
            seconds(j - 1) = held
         end do
      end do
      write (*, "(f12.6, 1x, i0, 1x, es24.16)") seconds(3), record%audit%samples, sum(record%value(:, 1))
   end subroutine main

end program read_speed
