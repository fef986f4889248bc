! SPDX-License-Identifier: MIT
!> Samples counted in bins of equal width, and the quartiles found by counting.
module gyroakf_stats_bin_counts
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_last
   implicit none (type, external)
   private
   public :: count_bins, find_quartiles

   !> Cells in which quartiles are looked for: 32 kB of counts
   integer, parameter :: cells = 4096
   !> The quartiles are known well enough when so many cells lie between them
   integer, parameter :: enough = 64
   integer, parameter :: most_rounds = 5

contains

   !> Counts the present samples in bins.
   subroutine count_bins(x, low, width, counts, below, above, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> First edge, and width of a bin, > 0
      real(dp), intent(in) :: low, width
      !> Samples in each bin: [bins]
      integer(int64), intent(out), contiguous :: counts(:)
      !> Samples below the first edge, and not below the last
      integer(int64), intent(out) :: below, above
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64), allocatable :: all(:), mine(:)
      integer(int64) :: n
      integer :: bins, chunk, stat, bad

      n = size(x, kind=int64)
      bins = size(counts)
      stat = 0
      allocate (all(0:bins + 1), stat=bad)
      if (bad == 0) then
         all = 0
         !$omp parallel if (n >= threads_from) default(shared) private(mine, bad)
         allocate (mine(0:bins + 1), stat=bad)
         if (bad == 0) mine = 0
         !$omp do schedule(static)
         do chunk = 1, chunk_count(n)
            if (bad == 0) call count_chunk(x, low, width, bins, chunk, mine, valid)
         end do
         !$omp end do
         !$omp critical (gyroakf_bin_counts)
         if (bad == 0) all = all + mine
         stat = stat + abs(bad)
         !$omp end critical (gyroakf_bin_counts)
         !$omp end parallel
      end if
      if (bad + stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the counts of the histogram")
         return
      end if
      counts(:) = all(1:bins)
      below = all(0)
      above = all(bins + 1)
   end subroutine count_bins

   !> Counts within a chunk.
   pure subroutine count_chunk(x, low, width, bins, chunk, counts, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: low, width
      integer, intent(in) :: bins, chunk
      !> Added to: [0:bins + 1], the first and the last for what is outside
      integer(int64), intent(inout) :: counts(0:)
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i
      integer :: bin
      real(dp) :: last

      last = real(bins + 1, dp)
      do i = chunk_first(size(x, kind=int64), chunk), chunk_last(size(x, kind=int64), chunk)
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         bin = int(min(max((x(i) - low)/width + 1.0_dp, 0.0_dp), last))
         counts(bin) = counts(bin) + 1
      end do
   end subroutine count_chunk

   !> First and third quartile, to a 64th of their distance or better.
   !>
   !> The range is divided into 4096 cells, the samples are counted, and within a cell the quartile is interpolated. Where
   !> outliers stretch the range so that few cells lie between the quartiles, the cells about them are divided again.
   subroutine find_quartiles(x, lowest, highest, resolution, quartile, error, valid)
      !> Series: [n], at least one present sample; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Its extremes
      real(dp), intent(in) :: lowest, highest
      !> Quartiles closer than this are equal, >= 0
      real(dp), intent(in) :: resolution
      !> The two; equal where rounding or the resolution does not part them
      real(dp), intent(out) :: quartile(2)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64), allocatable :: counts(:)
      integer(int64) :: below, above
      real(dp) :: low, width
      integer :: round, place(2), stat

      low = lowest
      width = (highest - lowest)/real(cells - 1, dp)
      quartile(:) = lowest
      place(:) = 1
      allocate (counts(cells), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the cells of a histogram")
         return
      end if
      do round = 1, most_rounds
         if (.not. width > 4.0_dp*epsilon(width)*max(abs(lowest), abs(highest))) exit
         call count_bins(x, low, width, counts, below, above, error, valid)
         if (allocated(error)) return
         call place_quartiles(counts, below, above, low, width, quartile, place)
         if (place(2) - place(1) >= enough) return
         if (place(2) == place(1) .and. width <= resolution) exit
         low = low + width*real(place(1) - 2, dp)
         width = width*real(place(2) - place(1) + 3, dp)/real(cells, dp)
      end do
      if (quartile(2) - quartile(1) <= resolution .or. place(2) - place(1) < 2) quartile(:) = quartile(1)
   end subroutine find_quartiles

   !> The cells of the quartiles, and the quartiles within them.
   pure subroutine place_quartiles(counts, below, above, low, width, quartile, place)
      !> Samples in each cell, and outside
      integer(int64), intent(in) :: counts(:), below, above
      !> First edge and width of the cells
      real(dp), intent(in) :: low, width
      real(dp), intent(out) :: quartile(2)
      !> Numbers of the cells
      integer, intent(out) :: place(2)
      real(dp) :: rank, found
      integer :: q, i

      do q = 1, 2
         rank = (0.5_dp*real(q, dp) - 0.25_dp)*real(sum(counts) + below + above, dp)
         found = real(below, dp)
         do i = 1, size(counts) - 1
            if (found + real(counts(i), dp) >= rank) exit
            found = found + real(counts(i), dp)
         end do
         place(q) = i
         quartile(q) = low + width*(real(i - 1, dp) + min(1.0_dp, max(0.0_dp, rank - found)/real(max(counts(i), 1_int64), dp)))
      end do
   end subroutine place_quartiles

end module gyroakf_stats_bin_counts
