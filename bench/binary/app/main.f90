! SPDX-License-Identifier: MIT
!> Median times of five readings of a file of binary numbers: `binary_speed FILE FORMAT CHANNELS [COLUMN]`; prints the seconds
!> until the rows are in memory, those until the record is made and looked at, samples, and the sum of the first channel.
program binary_speed
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use gyroakf, only : dp, error_type, reader_options, record_type
   use gyroakf_io_reader, only : complete_record
   use gyroakf_io_recording, only : close_recording, hold_rows, open_recording, recording_type
   implicit none (type, external)

   call main()

contains

   subroutine main()
      type(recording_type) :: recording
      type(record_type) :: record
      type(reader_options) :: options
      type(error_type), allocatable :: error
      character(1024) :: word(4)
      integer(int64) :: time(3), per_second
      real(dp) :: rows(5), whole(5)
      integer :: k

      do k = 1, 4
         call get_command_argument(k, word(k))
      end do
      options%format = trim(word(2))
      if (word(3) /= "0") read (word(3), *) options%channels
      if (len_trim(word(4)) > 0) options%columns = trim(word(4))
      do k = 1, size(rows)
         if (allocated(record%value)) deallocate (record%value)
         call system_clock(time(1), per_second)
         call open_recording(trim(word(1)), options, recording, error)
         if (.not. allocated(error)) call hold_rows(recording, error)
         call system_clock(time(2))
         if (.not. allocated(error)) call complete_record(recording, record, error)
         call system_clock(time(3))
         call close_recording(recording)
         if (allocated(error)) then
            write (error_unit, "(a)") error%message
            error stop
         end if
         rows(k) = real(time(2) - time(1), dp)/real(per_second, dp)
         whole(k) = real(time(3) - time(1), dp)/real(per_second, dp)
      end do
      write (*, "(2(f12.6, 1x), i0, 1x, es24.16)") median(rows), median(whole), record%audit%samples, sum(record%value(:, 1))
   end subroutine main

   !> The third of five.
   pure real(dp) function median(values)
      real(dp), intent(in) :: values(5)
      integer :: i

      median = values(1)
      do i = 1, 5
         if (count(values < values(i)) <= 2 .and. count(values <= values(i)) >= 3) median = values(i)
      end do
   end function median

end program binary_speed
