! SPDX-License-Identifier: MIT
!> A recording with dates and decimal commas, held in memory, becomes a record; what was found on the way is in it too.
program example_read_text
   use gyroakf, only : int8, error_type, reader_options, read_record, record_type, sample_count
   implicit none (type, external)
   character(1), parameter :: nl = new_line("a")
   character(*), parameter :: text = "date;time;gx [deg/s];label"//nl// &
      "2026-05-01;23:59:59,980;0,12;ok"//nl// &
      "2026-05-01;23:59:59,990;0,15;ok"//nl// &
      "2026-05-02;00:00:00,000;;late"//nl// &
      "2026-05-02;00:00:00,010;-0,03;ok"//nl
   type(error_type), allocatable :: error
   type(reader_options) :: options
   type(record_type) :: record
   integer(int8), target :: bytes(len(text))
   integer :: i

   bytes = transfer(text, bytes)
   options%bytes => bytes                                        ! without this the name is that of a file
   call read_record("log.csv", options, record, error)
   if (allocated(error)) error stop error%message
   print "(i0, 3a, f0.3, 2a)", sample_count(record), " samples of ", record%channel(1)%text, " at ", &
      1/record%sample_interval, " Hz in ", record%unit%name
   do i = 1, int(sample_count(record))
      print "(f6.2, a)", record%value(i, 1), trim(merge("         ", "  missing", record%present(i, 1) == 1))
   end do
   do i = 1, size(record%warnings)
      print "(a)", record%warnings(i)%text
   end do
end program example_read_text
