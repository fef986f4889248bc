! SPDX-License-Identifier: MIT
!> Where the time of `gyroakf run` goes: `profile FILE [THREADS]` reads a recording and does the whole job, and takes the time
!> between the calls of the progress interface. What a stage does after its last call counts as its own; what is told under the same
!> name in several places (the four Allan deviations, the filters) is added up.
!>
!> The lines: seconds, share in percent, stage; then the seconds until the drift is identified (reading not included), which is
!> the paper's family of filters with all tests, models and deviations, and those of all.
module profile_clock
   use omp_lib, only : omp_get_wtime
   use gyroakf, only : dp, int64, progress_type
   implicit none (type, external)
   private
   public :: clock_type, change_stage

   !> Takes the time of every stage
   type, extends(progress_type) :: clock_type
      integer :: stages = 0, now = 0
      character(40) :: name(40) = ""
      real(dp) :: seconds(40) = 0.0_dp, last = 0.0_dp, drift_begins = 0.0_dp
   contains
      procedure :: advance => take_time
   end type clock_type

contains

   !> The time so far belongs to the stage before.
   subroutine change_stage(clock, name)
      class(clock_type), intent(inout) :: clock
      !> The one that begins
      character(*), intent(in) :: name

      real(dp) :: now
      integer :: i

      now = omp_get_wtime()
      if (clock%now > 0) clock%seconds(clock%now) = clock%seconds(clock%now) + (now - clock%last)
      clock%last = now
      if (name == "identifying" .and. clock%drift_begins <= 0.0_dp) clock%drift_begins = now
      do i = 1, clock%stages
         if (clock%name(i) == name) exit
      end do
      clock%stages = max(clock%stages, i)
      clock%name(i) = name
      clock%now = i
   end subroutine change_stage

   !> As `progress_type` has it.
   subroutine take_time(self, stage, done, total, cancel)
      class(clock_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      cancel = .false.
      if (done < 0 .or. total < 0) return
      call change_stage(self, stage)
   end subroutine take_time

end module profile_clock

program profile
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use omp_lib, only : omp_get_wtime, omp_set_num_threads
   use gyroakf, only : dp, error_type, pipeline_options, pipeline_result_type, read_record, reader_options, record_type, &
      & run_pipeline
   use profile_clock, only : change_stage, clock_type
   implicit none (type, external)

   call main()

contains

   !> Reads, works, prints.
   subroutine main()
      type(clock_type) :: clock
      type(reader_options) :: reading
      type(pipeline_options) :: options
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(error_type), allocatable :: error
      character(1024) :: path, word
      integer :: threads, i
      real(dp) :: read_until, begun

      call get_command_argument(1, path)
      if (command_argument_count() > 1) then
         call get_command_argument(2, word)
         read (word, *) threads
         call omp_set_num_threads(threads)
      end if
      begun = omp_get_wtime()
      clock%last = begun
      call change_stage(clock, "reading")
      call read_record(trim(path), reading, record, error, clock)
      if (.not. allocated(error)) then
         call change_stage(clock, "moments")
         read_until = clock%last
         call run_pipeline(record, options, result, error, clock)
      end if
      if (allocated(error)) then
         write (error_unit, "(a)") error%message
         stop 1, quiet=.true.
      end if
      call change_stage(clock, "end")
      do i = 1, clock%stages - 1
         write (output_unit, "(f10.4, f8.1, 2x, a)") clock%seconds(i), 100*clock%seconds(i)/(clock%last - begun), &
            & trim(clock%name(i))
      end do
      if (clock%drift_begins > 0.0_dp) write (output_unit, "(f10.4, 10x, a)") clock%drift_begins - read_until, "until the drift"
      write (output_unit, "(f10.4, 10x, a)") clock%last - begun, "all"
   end subroutine main

end program profile
