! SPDX-License-Identifier: MIT
!> Tests of the number of threads, with and without OpenMP.
module test_threads
   use gyroakf_threads, only : set_thread_count, thread_count
   use expectations, only : test, error, check
   implicit none (type, external)
   private
   public :: suite_threads

contains

   subroutine suite_threads()
      call test("count", test_count)
   end subroutine suite_threads

   !> A parallel region has as many threads as are told; what cannot be is not set.
   subroutine test_count()
      integer :: before, threads, told

      before = thread_count()
      call check(error, before >= 1, "no thread")
      call set_thread_count(3)
      told = thread_count()
      threads = 0
      !$omp parallel reduction(+:threads)
      threads = threads + 1
      !$omp end parallel
      call set_thread_count(0)
      call check(error, thread_count(), told)
      call set_thread_count(before)
      if (allocated(error)) return
      call check(error, threads, told, "threads of a parallel region")
      !$ call check(error, told, 3, "threads that were asked for")
   end subroutine test_count

end module test_threads
