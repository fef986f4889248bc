! SPDX-License-Identifier: MIT
!> The moving average of a series, causal or centred: what every filter of the drift has to beat.
!>
!> $$ x_k = \frac{\sum_{i = k-a}^{k+b} v_i z_i}{\sum_{i = k-a}^{k+b} v_i}, \quad v_i = 1 \text{ where the sample is present} $$
!> The sums are O(n) and nothing is ever subtracted from them, so they cannot drift: the series is cut into blocks of the window's
!> length, and every window is the end of one block and the beginning of the next.
!>
!> Source of the blocks: van Herk, Pattern Recognition Letters 13 (1992) 517-521 (for maxima).
module gyroakf_filter_moving_average
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_measurement, only : is_sample
   implicit none (type, external)
   private
   public :: moving_average

   !> Sum and number of present samples
   type :: sum_type
      real(dp) :: total = 0.0_dp
      integer(int64) :: count = 0
   end type sum_type

contains

   !> Averages over a moving window; at the ends over the part of it that lies in the series.
   subroutine moving_average(z, length, centred, x, error, valid)
      !> Series: [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Samples of the window, >= 1; a centred one has the next odd number
      integer(int64), intent(in) :: length
      !> As many samples behind as before; else the sample and those before it
      logical, intent(in) :: centred
      !> Averages: [n], not the same array as z; where nothing is present in a window the average before it, 0 where there is none
      real(dp), intent(out), contiguous :: x(:)
      !> invalid_argument (sizes, length), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(sum_type), allocatable :: tail(:)
      integer(int64) :: n, before, behind
      integer :: stat
      logical :: good

      n = size(z, kind=int64)
      good = size(x, kind=int64) == n .and. length >= 1
      if (present(valid)) good = good .and. size(valid, kind=int64) == n
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, "a moving average needs a series, an output and a mask of one "// &
                          "length, and a window of at least one sample")
         return
      else if (n == 0) then
         return
      end if
      before = min(length - 1, n - 1)
      if (centred) before = min(length/2, n - 1)
      behind = 0
      if (centred) behind = before
      allocate (tail(before + behind + 2), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the window of a moving average")
         return
      end if
      call average_blocks(z, before, tail, x, valid)
   end subroutine moving_average

   !> The averages, block by block.
   pure subroutine average_blocks(z, before, tail, x, valid)
      real(dp), intent(in), contiguous :: z(:)
      !> Samples of a window before its own
      integer(int64), intent(in) :: before
      !> Work space for the sums of the ends of a block: [window + 1]
      type(sum_type), intent(inout), contiguous :: tail(:)
      real(dp), intent(out), contiguous :: x(:)
      integer(int8), intent(in), optional :: valid(:)
      type(sum_type) :: head
      integer(int64) :: n, width, block, from, k, j, count
      real(dp) :: reference, average

      n = size(z, kind=int64)
      width = size(tail, kind=int64) - 1
      reference = first_sample(z, valid)
      average = 0.0_dp
      do block = 0, (n - 1)/width
         from = block*width + 1 - before
         tail(width + 1) = sum_type()
         do j = width, 1, -1
            tail(j) = tail(j + 1)
            call add(z, from + j - 1, reference, tail(j), valid)
         end do
         head = sum_type()
         do j = 1, min(width, n - block*width)
            if (j > 1) call add(z, from + width + j - 2, reference, head, valid)
            k = block*width + j
            count = tail(j)%count + head%count
            if (count > 0) average = reference + (tail(j)%total + head%total)/real(count, dp)
            x(k) = average
         end do
      end do
   end subroutine average_blocks

   !> Adds a sample, where it is in the series and present.
   pure subroutine add(z, i, reference, sums, valid)
      real(dp), intent(in), contiguous :: z(:)
      !> May lie outside
      integer(int64), intent(in) :: i
      !> What is taken off it
      real(dp), intent(in) :: reference
      type(sum_type), intent(inout) :: sums
      integer(int8), intent(in), optional :: valid(:)

      if (i < 1 .or. i > size(z, kind=int64)) return
      if (.not. is_sample(z(i))) return
      if (present(valid)) then
         if (valid(i) == 0_int8) return
      end if
      sums%total = sums%total + (z(i) - reference)
      sums%count = sums%count + 1
   end subroutine add

   !> The first present sample, 0 where there is none.
   pure real(dp) function first_sample(z, valid)
      real(dp), intent(in), contiguous :: z(:)
      integer(int8), intent(in), optional :: valid(:)
      type(sum_type) :: sums
      integer(int64) :: i

      do i = 1, size(z, kind=int64)
         call add(z, i, 0.0_dp, sums, valid)
         if (sums%count > 0) exit
      end do
      first_sample = sums%total
   end function first_sample

end module gyroakf_filter_moving_average
