! SPDX-License-Identifier: MIT
!> The fixed partition of a series that every threaded sum uses.
!>
!> A sum is taken chunk by chunk, the chunks' sums are added in order. The chunks follow from the
!> length alone, not from the number of threads, and so does the result. Within a chunk the work
!> goes in blocks that stay in the cache.
module gyroakf_chunks
   use gyroakf_kinds, only : int64
   use gyroakf_threads, only : thread_count
   implicit none (type, external)
   private
   public :: block_length, threads_from, chunk_count, chunk_first, chunk_last, chunk_group

   !> Samples of a block: 8 kB of real numbers, which also a small stack holds
   integer(int64), parameter :: block_length = 1024
   !> Chunks begin at multiples of so many samples
   integer(int64), parameter :: chunk_unit = 4096
   !> Length from which it pays to start threads
   integer(int64), parameter :: threads_from = 60000
   integer(int64), parameter :: most_chunks = 256

contains

   !> Number of chunks of a series, 1 .. 256.
   pure integer function chunk_count(n)
      !> Length of the series; less than a block is one chunk
      integer(int64), intent(in) :: n

      chunk_count = int(min(max((n + chunk_unit - 1)/chunk_unit, 1_int64), most_chunks))
   end function chunk_count

   !> First sample of a chunk, 1-based.
   pure integer(int64) function chunk_first(n, chunk)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Number of the chunk, 1 .. chunk_count(n); chunk_count(n) + 1 gives n + 1
      integer, intent(in) :: chunk
      integer(int64) :: blocks, chunks

      blocks = (n + chunk_unit - 1)/chunk_unit
      chunks = int(chunk_count(n), int64)
      chunk_first = min((blocks*int(chunk - 1, int64))/chunks*chunk_unit, n) + 1
   end function chunk_first

   !> Last sample of a chunk, 1-based.
   pure integer(int64) function chunk_last(n, chunk)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Number of the chunk, 1 .. chunk_count(n)
      integer, intent(in) :: chunk

      chunk_last = chunk_first(n, chunk + 1) - 1
   end function chunk_last

   !> Chunks between two reports of progress; all of them without a progress callback.
   integer function chunk_group(chunks, reported)
      !> How many there are
      integer, intent(in) :: chunks
      !> There is a progress callback
      logical, intent(in) :: reported

      chunk_group = chunks
      if (reported) chunk_group = min(chunks, 2*thread_count())
   end function chunk_group

end module gyroakf_chunks
