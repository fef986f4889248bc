! SPDX-License-Identifier: MIT
!> Sums over a series, chunk by chunk: the one loop under every pass that adds up products.
!>
!>     type, extends(chunk_sums_type) :: square_sums_type     ! what is summed
!>     contains
!>        procedure :: add => add_squares                     ! over one chunk
!>     end type
!>     call sum_chunks(squares, x, n, "sum of squares", total, error, valid, progress)
!>
!> The sums of the chunks are added in order: the result does not depend on the threads.
module gyroakf_chunk_sums
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_group
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_threads, only : thread_count
   implicit none (type, external)
   private
   public :: chunk_sums_type, sum_chunks

   !> What is summed: parameters, and what else a chunk leaves behind
   type, abstract :: chunk_sums_type
   contains
      procedure(add_chunk), deferred :: add
   end type chunk_sums_type

   abstract interface
      !> Adds the sums over a chunk; called by several threads at once.
      subroutine add_chunk(self, x, n, chunk, total, stat, valid)
         import :: chunk_sums_type, dp, int8, int64
         implicit none (type, external)
         !> Shared by the threads: a chunk writes to its own places only
         class(chunk_sums_type), intent(inout) :: self
         !> Series: [n]
         real(dp), intent(in), contiguous :: x(:)
         !> Places that the chunks divide, number of the chunk
         integer(int64), intent(in) :: n
         integer, intent(in) :: chunk
         !> The sums, zero before
         real(dp), intent(inout), contiguous :: total(:)
         !> Not 0 where memory is short
         integer, intent(out) :: stat
         !> 1 present, 0 missing: [n]
         integer(int8), intent(in), optional :: valid(:)
      end subroutine add_chunk
   end interface

   !> Without a progress callback the sums of this many chunks are held at a time, at least
   integer, parameter :: fewest_held = 16

contains

   !> The pass over a series; progress is reported between some chunks.
   subroutine sum_chunks(sums, x, n, stage, total, error, valid, progress, pass)
      !> What is summed
      class(chunk_sums_type), intent(inout) :: sums
      !> Series; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Places that the chunks divide: the length of the series, or another number
      integer(int64), intent(in) :: n
      !> What is being done
      character(*), intent(in) :: stage
      !> The sums
      real(dp), intent(out) :: total(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: as x
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      !> Which of how many passes this is for the progress callback; the only one if absent
      integer, intent(in), optional :: pass(2)
      real(dp), allocatable :: part(:, :)
      integer(int64) :: done, passes
      integer :: chunk, from, to, held, stat, bad

      done = 0
      passes = 1
      if (present(pass)) done = (pass(1) - 1)*n
      if (present(pass)) passes = pass(2)
      total = 0.0_dp
      held = min(chunk_group(chunk_count(n), present(progress)), max(fewest_held, 2*thread_count()))
      allocate (part(size(total), held), stat=stat)
      do from = 1, chunk_count(n), held
         if (stat /= 0) exit
         call report_progress(stage, done + chunk_first(n, from) - 1, passes*n, error, progress)
         if (allocated(error)) return
         to = min(from + held - 1, chunk_count(n))
         part = 0.0_dp
         !$omp parallel do if (n >= threads_from) default(shared) private(bad) &
         !$omp& schedule(dynamic) reduction(+:stat)
         do chunk = from, to
            call sums%add(x, n, chunk, part(:, chunk - from + 1), bad, valid)
            stat = stat + bad
         end do
         !$omp end parallel do
         do chunk = from, to
            total = total + part(:, chunk - from + 1)
         end do
      end do
      call check_memory(stat, "a pass over the series: "//stage, error)
   end subroutine sum_chunks

end module gyroakf_chunk_sums
