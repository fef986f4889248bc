! SPDX-License-Identifier: MIT
!> Median time of five writings of a record: `write_speed PATH-OF-NUMBERS TARGET DIGITS`; prints seconds.
program write_speed
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use gyroakf, only : dp, error_type, record_type, text_type, write_record
   implicit none (type, external)

   call main()

contains

   subroutine main()
      type(record_type) :: record
      type(text_type) :: header(0)
      type(error_type), allocatable :: error
      character(1024) :: path, target, digits
      integer(int64) :: start, finish, per_second, bytes
      real(dp) :: seconds(5)
      integer :: k, unit, wanted

      call get_command_argument(1, path)
      call get_command_argument(2, target)
      call get_command_argument(3, digits)
      read (digits, *) wanted
      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", action="read")
      inquire (unit=unit, size=bytes)
      allocate (record%value(bytes/8, 1))
      read (unit) record%value
      close (unit)
      do k = 1, size(seconds)
         call system_clock(start, per_second)
         call write_record(trim(target), record, header, wanted, error)
         call system_clock(finish)
         if (allocated(error)) then
            write (error_unit, "(a)") error%message
            error stop
         end if
         seconds(k) = real(finish - start, dp)/real(per_second, dp)
      end do
      write (*, "(f12.6)") middle(seconds)
   end subroutine main

   !> The median of five.
   pure real(dp) function middle(x)
      real(dp), intent(in) :: x(5)
      integer :: k

      do k = 1, 5
         middle = x(k)
         if (count(x < middle) <= 2 .and. count(x > middle) <= 2) return
      end do
   end function middle

end program write_speed
