! SPDX-License-Identifier: MIT
!> Tasks in processes of their own, some of them at a time.
!>
!> A task that crashes is a task without an answer, not the end of the program. The processes are forked before this one has run
!> anything in parallel, so each of them may; what a task has to say comes through a pipe.
module gyroakf_app_pool
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_long, c_size_t
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_app_interrupt, only : enter_child, interrupted
   use gyroakf_app_progress_bar, only : bar_type
   use gyroakf_app_system, only : c_close, c_exit, c_fork, c_kill, c_pipe, c_poll, c_read, c_waitpid, poll_in, poll_type, &
      & signal_kill, signal_terminate, write_bytes
   implicit none (type, external)
   private
   public :: task_type, answer_type, run_pool

   !> What is done, for each number
   type, abstract :: task_type
   contains
      procedure(perform_interface), deferred :: perform
   end type task_type

   abstract interface
      !> Does one task, in a process of its own
      subroutine perform_interface(self, number, text)
         import :: task_type
         implicit none (type, external)
         !> All tasks; a copy, changes are lost
         class(task_type), intent(inout) :: self
         !> Which one
         integer, intent(in) :: number
         !> What comes back
         character(:), allocatable, intent(out) :: text
      end subroutine perform_interface
   end interface

   !> What came of a task
   type :: answer_type
      !> What it said; unallocated where it did not end well
      character(:), allocatable :: text
      !> Signal that ended its process, 0: none; exit code of a process that ended without an answer
      integer :: signal = 0, code = 0
   end type answer_type

   !> A process at work
   type :: worker_type
      integer(c_int) :: process = 0
      !> Its pipe, to be read
      integer(c_int) :: descriptor = -1
      !> Task it works on, 0: idle
      integer :: number = 0
      !> What came so far
      character(:, kind=c_char), allocatable :: buffer
      integer :: used = 0
   end type worker_type

   !> Milliseconds between two looks at the clock and at interrupts
   integer(c_int), parameter :: patience = 100
   !> Looks after which a process that does not end itself is killed: 5 s
   integer, parameter :: most_looks = 50
   !> Digits of the length that stands before an answer
   integer, parameter :: head = 12

contains

   !> Works on tasks; ends when all are done, or the user wants to end.
   subroutine run_pool(task, numbers, processes, answers, bar, done, total, error)
      !> What is done
      class(task_type), intent(inout) :: task
      !> The tasks, in the order in which they are begun
      integer, intent(in) :: numbers(:)
      !> At a time, >= 1
      integer, intent(in) :: processes
      !> Filled at the numbers
      type(answer_type), intent(inout) :: answers(:)
      !> Told how many are done
      type(bar_type), intent(inout) :: bar
      !> Done before and counted on, of so many
      integer(int64), intent(inout) :: done
      integer(int64), intent(in) :: total
      !> cancelled; no_memory where no process can be made
      type(error_type), allocatable, intent(out) :: error
      type(worker_type) :: worker(processes)
      integer :: next, looks
      logical :: cancel

      next = 1
      looks = 0
      do
         call bar%advance("files", done, total, cancel)
         if (cancel .and. looks == 0) call end_all(worker, signal_terminate)
         if (cancel) looks = looks + 1
         if (looks == most_looks) call end_all(worker, signal_kill)
         do while (looks == 0 .and. next <= size(numbers) .and. any(worker%number == 0))
            call begin(task, numbers(next), worker, error)
            if (allocated(error)) exit
            next = next + 1
         end do
         if (all(worker%number == 0)) exit
         if (allocated(error)) deallocate (error)         ! another process may be made when one has ended
         call listen(worker, answers, done)
      end do
      if (interrupted() .and. .not. allocated(error)) call fatal_error(error, status%cancelled, "cancelled")
   end subroutine run_pool

   !> Makes a process for a task.
   subroutine begin(task, number, worker, error)
      class(task_type), intent(inout) :: task
      integer, intent(in) :: number
      type(worker_type), intent(inout) :: worker(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: ends(2), process, ignored
      integer :: i

      process = -1
      if (c_pipe(ends) == 0) then
         process = c_fork()
         if (process < 0) ignored = c_close(ends(1))
         if (process < 0) ignored = c_close(ends(2))
      end if
      if (process < 0) then
         call fatal_error(error, status%no_memory, "the system makes no further process; fewer --threads need fewer")
         return
      end if
      if (process == 0) then
         ignored = c_close(ends(1))
         do i = 1, size(worker)
            if (worker(i)%descriptor >= 0) ignored = c_close(worker(i)%descriptor)
         end do
         call work(task, number, ends(2))
      end if
      ignored = c_close(ends(2))
      i = findloc(worker%number, 0, dim=1)
      worker(i)%process = process
      worker(i)%descriptor = ends(1)
      worker(i)%number = number
      worker(i)%used = 0
   end subroutine begin

   !> The whole life of a process.
   subroutine work(task, number, descriptor)
      class(task_type), intent(inout) :: task
      integer, intent(in) :: number
      integer(c_int), intent(in) :: descriptor
      character(:), allocatable :: text
      character(head) :: length

      call enter_child()
      call task%perform(number, text)
      write (length, "(i12)") len(text)
      call write_bytes(descriptor, length//text)
      call c_exit(0_c_int)
   end subroutine work

   !> Waits for what the processes say, a tenth of a second at most.
   subroutine listen(worker, answers, done)
      type(worker_type), intent(inout) :: worker(:)
      type(answer_type), intent(inout) :: answers(:)
      integer(int64), intent(inout) :: done
      type(poll_type) :: waiting(size(worker))
      integer :: i

      do i = 1, size(worker)
         waiting(i)%descriptor = worker(i)%descriptor      ! -1 is passed over
         waiting(i)%events = poll_in
         waiting(i)%happened = 0
      end do
      if (c_poll(waiting, int(size(waiting), c_long), patience) <= 0) return
      do i = 1, size(worker)
         if (waiting(i)%happened == 0 .or. worker(i)%number == 0) cycle
         call receive(worker(i), answers(worker(i)%number))
         if (worker(i)%number == 0) done = done + 1
      end do
   end subroutine listen

   !> Takes what there is; at its end the process is gone and the worker idle.
   subroutine receive(worker, answer)
      type(worker_type), intent(inout) :: worker
      type(answer_type), intent(inout) :: answer
      character(65536, kind=c_char), target :: piece
      character(:, kind=c_char), allocatable :: longer
      integer(c_long) :: got
      integer(c_int) :: ignored, ended, state

      got = c_read(worker%descriptor, c_loc(piece), len(piece, c_size_t))
      if (got < 0) return                                  ! interrupted by a signal
      if (got > 0) then
         if (.not. allocated(worker%buffer)) allocate (character(131072, kind=c_char) :: worker%buffer)
         if (worker%used + got > len(worker%buffer)) then
            allocate (character(2*(worker%used + int(got)), kind=c_char) :: longer)
            longer(:worker%used) = worker%buffer(:worker%used)
            call move_alloc(longer, worker%buffer)
         end if
         worker%buffer(worker%used + 1:worker%used + int(got)) = piece(:int(got))
         worker%used = worker%used + int(got)
         return
      end if
      ignored = c_close(worker%descriptor)
      do
         ended = c_waitpid(worker%process, state, 0_c_int)
         if (ended == worker%process) exit
         if (.not. interrupted()) exit
      end do
      call take_answer(worker, int(state), answer)
      worker%descriptor = -1
      worker%number = 0
   end subroutine receive

   !> What it said where that is whole, or how it ended.
   subroutine take_answer(worker, state, answer)
      type(worker_type), intent(in) :: worker
      !> As waitpid gives it
      integer, intent(in) :: state
      type(answer_type), intent(inout) :: answer
      integer :: length, stat

      answer%signal = iand(state, 127)
      answer%code = iand(ishft(state, -8), 255)
      if (answer%signal /= 0 .or. answer%code /= 0 .or. worker%used < head) return
      read (worker%buffer(:head), "(i12)", iostat=stat) length
      if (stat /= 0) return
      if (length == worker%used - head) answer%text = worker%buffer(head + 1:worker%used)
   end subroutine take_answer

   !> Sends a signal to every process at work.
   subroutine end_all(worker, signal)
      type(worker_type), intent(in) :: worker(:)
      integer(c_int), intent(in) :: signal
      integer(c_int) :: ignored
      integer :: i

      do i = 1, size(worker)
         if (worker(i)%number > 0) ignored = c_kill(worker(i)%process, signal)
      end do
   end subroutine end_all

end module gyroakf_app_pool
