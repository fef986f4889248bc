! SPDX-License-Identifier: MIT
!> How many threads parallel regions use. Without OpenMP it is one, whatever is asked for.
module gyroakf_threads
   !$ use omp_lib, only : omp_get_max_threads, omp_set_num_threads
   implicit none (type, external)
   private
   public :: thread_count, set_thread_count, use_one_thread

contains

   !> Threads of the next parallel region that the calling thread comes to; 1 without OpenMP.
   integer function thread_count()
      thread_count = 1
      !$ thread_count = omp_get_max_threads()
   end function thread_count

   !> Sets them, for the parallel regions of the calling thread; without OpenMP it does nothing.
   subroutine set_thread_count(threads)
      !> At least 1
      integer, intent(in) :: threads

      if (threads < 1) return
      !$ call omp_set_num_threads(threads)
   end subroutine set_thread_count

   !> One thread, for a forked child: called by host.c.
   subroutine use_one_thread() bind(C, name="one_thread_of_gyroakf")
      call set_thread_count(1)
   end subroutine use_one_thread

end module gyroakf_threads
