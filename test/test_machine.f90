! SPDX-License-Identifier: MIT
!> The number of threads, with and without OpenMP, and the memory of the machine.
module test_machine
   use gyroakf_threads, only : set_thread_count, thread_count
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_machine_memory, only : free_memory, least_limit, memory_of, no_limit
   use scratch_file, only : remove_file, scratch_path
   implicit none (type, external)
   private
   public :: suite_threads, suite_machine_memory

contains

   subroutine suite_threads()
      call test("count", test_count)
   end subroutine suite_threads

   subroutine suite_machine_memory()
      call test("line", test_line)
      call test("limits", test_limits)
      call test("here", test_here)
   end subroutine suite_machine_memory

   !> A parallel region has as many threads as were set; an impossible number is not set.
   subroutine test_count()
      integer :: before, threads, set

      before = thread_count()
      call check(error, before >= 1, "no thread")
      call set_thread_count(3)
      set = thread_count()
      threads = 0
      !$omp parallel reduction(+:threads)
      threads = threads + 1
      !$omp end parallel
      call set_thread_count(0)
      call check(error, thread_count(), set)
      call set_thread_count(before)
      if (allocated(error)) return
      call check(error, threads, set, "threads of a parallel region")
      !$ call check(error, set, 3, "threads that were asked for")
   end subroutine test_count

   !> Writes a file of one text.
   subroutine write_text(name, text)
      character(*), intent(in) :: name, text
      integer :: unit

      open (newunit=unit, file=scratch_path(name), status="replace", action="write")
      write (unit, "(a)") text
      close (unit)
   end subroutine write_text

   subroutine test_line()
      character(1), parameter :: feed = new_line("a")

      call write_text("meminfo", "MemTotal:       24684116 kB"//feed//"MemAvailable:   1000 kB"//feed//"Odd: max")
      call check(error, abs(memory_of(scratch_path("meminfo"), "MemAvailable:") - 1024000.0_dp) < 0.5_dp)
      if (.not. allocated(error)) call check(error, memory_of(scratch_path("meminfo"), "Odd:") >= no_limit, "no number")
      if (.not. allocated(error)) call check(error, memory_of(scratch_path("meminfo"), "MemFree:") >= no_limit, "no line")
      call remove_file(scratch_path("meminfo"))
      if (.not. allocated(error)) call check(error, memory_of(scratch_path("meminfo"), "MemTotal:") >= no_limit, "no file")
   end subroutine test_line

   subroutine test_limits()
      character(:), allocatable :: path
      integer :: cut

      ! the nearest directory sets no limit, the one above it does; a missing one says nothing
      call write_text("memory.max", "2000000")
      path = scratch_path("memory.max")
      cut = index(path, "/", back=.true.)
      call check(error, abs(least_limit(path(:max(0, cut - 1)), "/none/such", path(cut + 1:)) - 2000000.0_dp) < 0.5_dp)
      call write_text("memory.max", "max")
      if (.not. allocated(error)) call check(error, least_limit(path(:max(0, cut - 1)), "/", path(cut + 1:)) >= no_limit)
      call remove_file(path)
   end subroutine test_limits

   subroutine test_here()
      integer(int64) :: bytes

      ! nothing is known (0), or more than a megabyte and less than an exabyte
      bytes = free_memory()
      call check(error, bytes == 0 .or. (bytes > 1000000_int64 .and. bytes < 10_int64**18))
   end subroutine test_here

end module test_machine
