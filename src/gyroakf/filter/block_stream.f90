! SPDX-License-Identifier: MIT
!> Means of blocks of a series that arrives in parts and whose length is not known before: but for rounding what `block_means` of
!> [[gyroakf_filter_identification]] makes of the whole.
!>
!>     call feed_block_stream(stream, x, valid)                        ! the parts of the series, in order
!>     call finish_block_stream(stream, factor, offset, means)
!>
!> A block has a power of four samples. Sums are kept of blocks of four, later of 16, 64, ...: when the room is full four neighbours
!> become one. Samples are summed less the first one, so that an offset costs no digits.
module gyroakf_filter_block_stream
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: block_stream_type, block_means_type, most_means, widening, feed_block_stream, finish_block_stream

   !> Block means at most, and how their length grows
   integer(int64), parameter :: most_means = 32768, widening = 4
   !> Blocks that are kept while the length is not known
   integer, parameter :: room = int(most_means*widening)

   !> Sums so far
   type :: block_stream_type
      private
      !> Samples a block, and so far in all
      integer(int64) :: width = widening, samples = 0
      !> The first sample that was present, once it is known
      real(dp) :: shift = 0.0_dp
      logical :: shift_known = .false.
      !> Sums of the samples that are present, less the first, and their number: [room]
      real(dp), allocatable :: total(:)
      integer, allocatable :: count(:)
   end type block_stream_type

   !> Means of a whole record
   type :: block_means_type
      !> Samples a mean, samples of the record
      integer(int64) :: width = 0, of_samples = 0
      !> [of_samples/width]
      real(dp), allocatable :: value(:)
      !> 1 present, 0 where more than half of the samples are missing; not allocated where all are present
      integer(int8), allocatable :: present(:)
   end type block_means_type

contains

   !> Adds the next samples.
   pure subroutine feed_block_stream(stream, x, error, valid)
      !> Fresh, or fed before
      type(block_stream_type), intent(inout) :: stream
      !> [any number], finite where present
      real(dp), intent(in), contiguous :: x(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: as x
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: k, block, left
      integer :: stat

      if (.not. allocated(stream%total)) then
         allocate (stream%total(room), stat=stat)
         if (stat == 0) allocate (stream%count(room), stat=stat)
         if (stat /= 0) then
            call fatal_error(error, status%no_memory, "no memory for the block means of a series")
            return
         end if
         stream%total = 0.0_dp
         stream%count = 0
      end if
      block = 0
      left = 0
      do k = 1, size(x, kind=int64)
         if (left == 0) then
            if (stream%samples == room*stream%width) call widen(stream)
            block = stream%samples/stream%width + 1
            left = block*stream%width - stream%samples
         end if
         left = left - 1
         stream%samples = stream%samples + 1
         if (present(valid)) then
            if (valid(k) == 0_int8) cycle
         end if
         if (.not. stream%shift_known) stream%shift = x(k)
         stream%shift_known = .true.
         stream%total(block) = stream%total(block) + (x(k) - stream%shift)
         stream%count(block) = stream%count(block) + 1
      end do
   end subroutine feed_block_stream

   !> Makes one block of four.
   pure subroutine widen(stream)
      !> Its room is full, or it has more blocks than are wanted
      type(block_stream_type), intent(inout) :: stream
      integer :: i, first

      do i = 1, room/int(widening)                     ! what is written lies before what is still to be read
         first = (i - 1)*int(widening) + 1
         stream%total(i) = sum(stream%total(first:first + int(widening) - 1))
         stream%count(i) = sum(stream%count(first:first + int(widening) - 1))
      end do
      stream%total(room/int(widening) + 1:) = 0.0_dp
      stream%count(room/int(widening) + 1:) = 0
      stream%width = widening*stream%width
   end subroutine widen

   !> The means, at most 32,768.
   pure subroutine finish_block_stream(stream, factor, offset, means, error)
      !> After the last sample; nothing more can be fed
      type(block_stream_type), intent(inout) :: stream
      !> A sample of the series is factor times one that was fed, less offset
      real(dp), intent(in) :: factor, offset
      !> Of width 0 where nothing was fed
      type(block_means_type), intent(out) :: means
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: i, n
      integer :: stat

      if (.not. allocated(stream%total)) return
      do while (stream%samples/stream%width > most_means)
         call widen(stream)
      end do
      n = stream%samples/stream%width
      means%width = stream%width
      means%of_samples = stream%samples
      allocate (means%value(n), stat=stat)
      if (stat == 0) allocate (means%present(n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the block means of a series")
         return
      end if
      do i = 1, n
         means%present(i) = merge(1_int8, 0_int8, 2*stream%count(i) >= stream%width)
         means%value(i) = 0.0_dp
         if (means%present(i) == 0_int8) cycle
         means%value(i) = (factor*stream%shift - offset) + factor*(stream%total(i)/real(stream%count(i), dp))
      end do
      if (all(means%present /= 0_int8)) deallocate (means%present)
      deallocate (stream%total, stream%count)
   end subroutine finish_block_stream

end module gyroakf_filter_block_stream
