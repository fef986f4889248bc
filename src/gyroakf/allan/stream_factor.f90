! SPDX-License-Identifier: MIT
!> One averaging factor of a streamed record: the terms of the overlapping Allan variance every `stride` samples.
!>
!> The phase is needed at j s, j s + m and j s + 2m. Where s > 1 the first two wait in rings of about 2m/s and m/s elements until
!> the third comes by; where s = 1 the block and the last 2m samples before it hold all three, and every term counts.
module gyroakf_allan_stream_factor
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_phase, only : add_compensated
   use gyroakf_allan_second_difference, only : gap_sums_type
   use gyroakf_allan_stream_lags, only : add_window, break_windows, lag_sums_type
   implicit none (type, external)
   private
   public :: factor_type, block_type, begin_factor, add_all_terms, add_sampled_terms, add_means, skip_means, tilt_factor

   !> One block of the record as the phase
   type :: block_type
      !> Samples before the block, and in it
      integer(int64) :: begin = 0, length = 0
      !> Samples of history before the block, at most as many as `near` has room for
      integer(int64) :: history = 0
      !> Nothing is missing in the block and its history
      logical :: complete = .true.
      !> Phase at begin + 1 .. begin + length about the mean so far, and samples missing up to there
      real(dp), allocatable :: phase(:)
      integer(int64), allocatable :: missing(:)
      !> Phase about the block's own mean and missing samples, from history to end: [-history:length]; index 0 is `begin`
      real(dp), allocatable :: near(:)
      integer(int64), allocatable :: near_missing(:)
      !> Mean that was taken off, less the first one that was
      real(dp) :: shift = 0.0_dp
   end type block_type

   !> State of one averaging factor
   type :: factor_type
      !> Averaging factor, and samples from term to term
      integer(int64) :: m = 1, stride = 1
      !> Missing samples that a window may have
      integer(int64) :: allowed = 0
      !> Sums in units of window means, and what the sum of squares lost by rounding
      type(gap_sums_type) :: sums
      real(dp) :: lost = 0.0_dp
      !> Terms so far: the next to be finished; phases at j s and j s + m that were met
      integer(int64) :: next = 0, met(0:1) = 0
      !> Waiting phases, and missing samples up to there: [j modulo size, a power of two]
      real(dp), allocatable :: start(:), middle(:)
      integer(int64), allocatable :: start_missing(:), middle_missing(:)
      !> Means of adjacent windows: sums, windows so far, phase and missing samples at the end of the last
      type(lag_sums_type) :: lags
      integer(int64) :: windows = 0, mark_missing = 0
      real(dp) :: mark = 0.0_dp
      logical :: marked = .true.
   end type factor_type

contains

   !> Makes room for what waits. The first phase (0, nothing missing) waits already.
   pure subroutine begin_factor(factor, error)
      !> `m` and `stride` are set
      type(factor_type), intent(inout) :: factor
      !> no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64) :: n
      integer :: stat

      if (factor%stride == 1) return
      n = 4                                             ! a power of two: j modulo n is quick
      do while (n < factor%m/factor%stride + 2)
         n = 2*n
      end do
      allocate (factor%start(0:2*n - 1), stat=stat)
      if (stat == 0) allocate (factor%start_missing(0:2*n - 1), stat=stat)
      if (stat == 0) allocate (factor%middle(0:n - 1), stat=stat)
      if (stat == 0) allocate (factor%middle_missing(0:n - 1), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the waiting phases of an averaging time")
         return
      end if
      factor%start(0) = 0
      factor%start_missing(0) = 0
      factor%met(0) = 1
   end subroutine begin_factor

   !> Adds every term that ends in the block.
   pure subroutine add_all_terms(factor, block)
      !> With stride 1; at most half the room for history
      type(factor_type), intent(inout) :: factor
      !> The block
      type(block_type), intent(in) :: block

      type(gap_sums_type) :: part
      integer(int64) :: a, m, terms

      m = factor%m
      a = max(1_int64 - 2*m, -block%begin)              ! where the first term starts
      terms = block%length - 2*m - a + 1
      if (terms < 1) return
      if (block%complete) then
         part%squares = squares(block%near(a:a + terms - 1), block%near(a + m:a + m + terms - 1), &
            & block%near(a + 2*m:a + 2*m + terms - 1))/real(m, dp)**2
         part%terms = terms
      else
         call gapped_squares(m, factor%allowed, block%near(a:a + terms - 1), block%near(a + m:a + m + terms - 1), &
            & block%near(a + 2*m:a + 2*m + terms - 1), block%near_missing(a:a + terms - 1), &
            & block%near_missing(a + m:a + m + terms - 1), block%near_missing(a + 2*m:a + 2*m + terms - 1), part)
      end if
      call add_part(factor, part)
   end subroutine add_all_terms

   !> Adds every sampled term that ends in the block, and keeps the phases that wait.
   pure subroutine add_sampled_terms(factor, block)
      !> With stride > 1
      type(factor_type), intent(inout) :: factor
      !> The block
      type(block_type), intent(in) :: block

      type(gap_sums_type) :: part
      real(dp) :: x0, x1
      integer(int64) :: j, at, last, g0, g1, wrap0, wrap1

      last = block%begin + block%length
      wrap0 = size(factor%start, kind=int64) - 1
      wrap1 = size(factor%middle, kind=int64) - 1
      do j = factor%next, (last - 2*factor%m)/factor%stride
         at = j*factor%stride + 2*factor%m - block%begin
         if (at > block%length) exit
         if (j < factor%met(0)) then
            x0 = factor%start(iand(j, wrap0))
            g0 = factor%start_missing(iand(j, wrap0))
         else
            x0 = block%phase(at - 2*factor%m)
            g0 = block%missing(at - 2*factor%m)
         end if
         if (j < factor%met(1)) then
            x1 = factor%middle(iand(j, wrap1))
            g1 = factor%middle_missing(iand(j, wrap1))
         else
            x1 = block%phase(at - factor%m)
            g1 = block%missing(at - factor%m)
         end if
         call add_term(factor%m, factor%allowed, x0, x1, block%phase(at), g0, g1, block%missing(at), part)
         factor%next = j + 1
      end do
      call add_part(factor, part)
      do j = max(factor%met(0), factor%next), last/factor%stride
         at = j*factor%stride - block%begin
         factor%start(iand(j, wrap0)) = block%phase(at)
         factor%start_missing(iand(j, wrap0)) = block%missing(at)
      end do
      factor%met(0) = last/factor%stride + 1
      if (last < factor%m) return
      do j = max(factor%met(1), factor%next), (last - factor%m)/factor%stride
         at = j*factor%stride + factor%m - block%begin
         factor%middle(iand(j, wrap1)) = block%phase(at)
         factor%middle_missing(iand(j, wrap1)) = block%missing(at)
      end do
      factor%met(1) = (last - factor%m)/factor%stride + 1
   end subroutine add_sampled_terms

   !> Adds the means of the adjacent windows that end in the block.
   pure subroutine add_means(factor, block, min_coverage)
      !> Any stride
      type(factor_type), intent(inout) :: factor
      !> The block
      type(block_type), intent(in) :: block
      !> Share of a window that must be present
      real(dp), intent(in) :: min_coverage

      integer(int64) :: j, at, there
      real(dp) :: mean
      logical :: complete

      do j = factor%windows + 1, (block%begin + block%length)/factor%m
         at = j*factor%m - block%begin
         if (factor%marked) then
            there = factor%m - (block%missing(at) - factor%mark_missing)
            complete = there > 0 .and. real(there, dp) >= min_coverage*real(factor%m, dp) - 1e-9_dp
            mean = 0
            if (complete) mean = (block%phase(at) - factor%mark)/real(there, dp) + block%shift
            call add_window(factor%lags, j, mean, complete)
         end if
         factor%mark = block%phase(at)
         factor%mark_missing = block%missing(at)
         factor%marked = .true.
         factor%windows = j
      end do
   end subroutine add_means

   !> Leaves out the windows of the block.
   pure subroutine skip_means(factor, block)
      !> Any stride
      type(factor_type), intent(inout) :: factor
      !> The block
      type(block_type), intent(in) :: block

      factor%windows = (block%begin + block%length)/factor%m
      factor%marked = .false.
      call break_windows(factor%lags)
   end subroutine skip_means

   !> Takes a straight line out of the phases that are kept: slope times the samples present so far.
   pure subroutine tilt_factor(factor, slope)
      !> Any stride
      type(factor_type), intent(inout) :: factor
      !> By which the mean has changed
      real(dp), intent(in) :: slope

      integer(int64) :: j, at

      if (factor%marked) factor%mark = factor%mark - slope*real(factor%windows*factor%m - factor%mark_missing, dp)
      if (factor%stride == 1) return
      do j = factor%next, factor%met(0) - 1
         at = iand(j, size(factor%start, kind=int64) - 1)
         factor%start(at) = factor%start(at) - slope*real(j*factor%stride - factor%start_missing(at), dp)
      end do
      do j = factor%next, factor%met(1) - 1
         at = iand(j, size(factor%middle, kind=int64) - 1)
         factor%middle(at) = factor%middle(at) - slope*real(j*factor%stride + factor%m - factor%middle_missing(at), dp)
      end do
   end subroutine tilt_factor

   !> Adds the sums of one block.
   pure subroutine add_part(factor, part)
      !> What is added to
      type(factor_type), intent(inout) :: factor
      !> Sums of the block
      type(gap_sums_type), intent(in) :: part

      call add_compensated(factor%sums%squares, factor%lost, part%squares)
      factor%sums%inflation = factor%sums%inflation + part%inflation
      factor%sums%terms = factor%sums%terms + part%terms
   end subroutine add_part

   !> One term, where its windows lack at most `allowed` samples each.
   pure subroutine add_term(m, allowed, a, b, c, ga, gb, gc, sums)
      !> Averaging factor, missing samples that a window may have
      integer(int64), intent(in) :: m, allowed
      !> Phase at k, k + m, k + 2m
      real(dp), intent(in) :: a, b, c
      !> Missing samples up to there
      integer(int64), intent(in) :: ga, gb, gc
      !> Sums to add to
      type(gap_sums_type), intent(inout) :: sums

      real(dp) :: n1, n2

      if (max(gb - ga, gc - gb) > allowed) return
      sums%terms = sums%terms + 1
      if (gc == ga) then
         sums%squares = sums%squares + (((c - b) - (b - a))/real(m, dp))**2
      else
         n1 = real(m - (gb - ga), dp)
         n2 = real(m - (gc - gb), dp)
         sums%squares = sums%squares + ((c - b)/n2 - (b - a)/n1)**2
         sums%inflation = sums%inflation + (1/n1 + 1/n2 - 2/real(m, dp))
      end if
   end subroutine add_term

   !> The terms of a stretch, one by one.
   pure subroutine gapped_squares(m, allowed, a, b, c, ga, gb, gc, sums)
      !> Averaging factor, missing samples that a window may have
      integer(int64), intent(in) :: m, allowed
      !> Phase at k, k + m, k + 2m: [terms]
      real(dp), intent(in), contiguous :: a(:), b(:), c(:)
      !> Missing samples up to there: [terms]
      integer(int64), intent(in), contiguous :: ga(:), gb(:), gc(:)
      !> Sums to add to
      type(gap_sums_type), intent(inout) :: sums

      integer(int64) :: i

      do i = 1, size(a, kind=int64)
         call add_term(m, allowed, a(i), b(i), c(i), ga(i), gb(i), gc(i), sums)
      end do
   end subroutine gapped_squares

   !> Sum of (c - 2 b + a)**2 in four chains.
   pure real(dp) function squares(a, b, c)
      !> Phase at k, k + m, k + 2m: [terms]
      real(dp), intent(in), contiguous :: a(:), b(:), c(:)

      integer(int64) :: i, n, q
      real(dp) :: s1, s2, s3, s4

      n = size(a, kind=int64)
      q = n/4
      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      !$omp simd reduction(+:s1, s2, s3, s4)
      do i = 1, q
         s1 = s1 + ((c(i) - b(i)) - (b(i) - a(i)))**2
         s2 = s2 + ((c(i + q) - b(i + q)) - (b(i + q) - a(i + q)))**2
         s3 = s3 + ((c(i + 2*q) - b(i + 2*q)) - (b(i + 2*q) - a(i + 2*q)))**2
         s4 = s4 + ((c(i + 3*q) - b(i + 3*q)) - (b(i + 3*q) - a(i + 3*q)))**2
      end do
      do i = 4*q + 1, n
         s1 = s1 + ((c(i) - b(i)) - (b(i) - a(i)))**2
      end do
      squares = (s1 + s2) + (s3 + s4)
   end function squares

end module gyroakf_allan_stream_factor
