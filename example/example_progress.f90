! SPDX-License-Identifier: MIT
!> How far a long call is: an extension of progress_type is told, and may end the call.
module example_progress_counter
   use gyroakf, only : int64, progress_type, progress_line
   implicit none (type, external)
   private
   public :: counter_type

   !> Prints the last state of every stage, ends the call at a sample
   type, extends(progress_type) :: counter_type
      integer(int64) :: limit = huge(1_int64)
      character(40) :: stage = ""
   contains
      procedure :: advance
   end type counter_type

contains

   !> Called several times a second.
   subroutine advance(self, stage, done, total, cancel)
      class(counter_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      cancel = done > self%limit
      if (stage /= self%stage) print "(a)", progress_line(stage, 0_int64, total, 0.0d0, 60)
      self%stage = stage
   end subroutine advance

end module example_progress_counter

!> Reads with somebody who is told, then with somebody who cancels.
program example_progress
   use gyroakf, only : error_type, reader_options, read_record, record_type
   use example_progress_counter, only : counter_type
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(counter_type) :: counter

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error, counter)
   if (allocated(error)) error stop error%message
   print "(i0, a)", size(record%value, 1), " samples"
   counter = counter_type(limit=-1)
   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error, counter)
   if (allocated(error)) print "(a)", error%message
end program example_progress
