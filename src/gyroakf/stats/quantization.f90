! SPDX-License-Identifier: MIT
!> Whether the samples of a series stand on a grid, as those of a converter do.
module gyroakf_stats_quantization
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from, block_length, chunk_count, chunk_first, chunk_last
   use gyroakf_stats_extremes, only : scan_extremes
   implicit none (type, external)
   private
   public :: quantization_type, find_quantization, coarse_ratio

   !> Levels are counted where no more than these fit between the extremes
   integer(int64), parameter :: most_levels = 65536
   !> From this step over standard deviation on, rounding changes the distribution's shape
   real(dp), parameter :: coarse_ratio = 1.0_dp

   !> A sample is on the grid within this share of a step: numbers are printed with few digits
   real(dp), parameter :: off_grid = 0.05_dp

   !> The grid of a series in its unit u
   type :: quantization_type
      !> All present samples are whole steps apart, within rounding
      logical :: quantized = .false.
      !> Step, u; 0 where the samples are not quantized
      real(dp) :: step = 0.0_dp
      !> Step over standard deviation
      real(dp) :: ratio = 0.0_dp
      !> step^2/12 over the variance: the share of rounding in it
      real(dp) :: variance_share = 0.0_dp
      !> Distinct values that occur; 0: not counted, more than 65536 fit between the extremes
      integer(int64) :: levels = 0
      !> Sheppard's correction: sqrt(variance - step^2/12), the standard deviation before rounding,
      !> u; 0 where rounding is all. Good for steps up to about two standard deviations
      real(dp) :: corrected_std = 0.0_dp
   end type quantization_type

contains

   !> Finds the step that the samples are multiples of, if any.
   !>
   !> The smallest non-zero difference of neighbors is tried: the distance of the extremes makes it
   !> exact, then every sample has to stand on the grid. A series whose neighbors never differ by a
   !> single step, or of which some samples were interpolated, is not recognized. Source of
   !> the correction: Sheppard, Proc. London Math. Soc. 29 (1898) 353-380.
   subroutine find_quantization(x, std, result, error, valid)
      !> Series as it was recorded, before a trend is removed: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Standard deviation to compare with, usually of the series without trend; u, >= 0
      real(dp), intent(in) :: std
      !> The grid; nothing found is no error
      type(quantization_type), intent(out) :: result
      !> invalid_argument (std negative), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: step, largest, low, high, steps

      if (.not. std >= 0.0_dp) call fatal_error(error, status%invalid_argument, &
         & "the standard deviation to compare a step with is negative")
      if (allocated(error)) return
      call scan_extremes(x, low, high, step, valid)
      largest = max(abs(low), abs(high))
      if (step <= 64.0_dp*epsilon(step)*largest) return
      steps = anint((high - low)/step)
      if (steps < 1.0_dp .or. steps > 2.0_dp**40) return
      step = (high - low)/steps
      call check_grid(x, low, step, nint(steps, int64), 16.0_dp*epsilon(step)*largest/step, &
         & result, error, valid)
      if (allocated(error) .or. .not. result%quantized) return
      result%step = step
      if (.not. std > 0.0_dp) return
      result%ratio = step/std
      result%variance_share = result%ratio*result%ratio/12.0_dp
      result%corrected_std = std*sqrt(max(0.0_dp, 1.0_dp - result%variance_share))
   end subroutine find_quantization

   !> Whether all samples stand on the grid, and how many levels occur.
   subroutine check_grid(x, low, step, steps, rounding, result, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      !> The lowest level, the step, rounding of a sample in steps
      real(dp), intent(in) :: low, step, rounding
      integer(int64), intent(in) :: steps
      type(quantization_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer(int8), allocatable :: seen(:), mine(:)
      integer(int64) :: n, counted
      integer :: chunk, bad, stat
      logical :: fits

      n = size(x, kind=int64)
      counted = merge(steps, 0_int64, steps < most_levels)
      fits = rounding <= off_grid
      stat = 0
      allocate (seen(0:counted), stat=bad)
      if (bad == 0) then
         seen = 0
         !$omp parallel if (n >= threads_from) default(shared) private(mine, bad)
         allocate (mine(0:counted), stat=bad)
         if (bad == 0) mine = 0
         !$omp do schedule(dynamic) reduction(.and.:fits)
         do chunk = 1, chunk_count(n)
            if (bad == 0 .and. fits) call check_chunk(x, low, step, chunk, mine, fits, valid)
         end do
         !$omp end do
         !$omp critical (gyroakf_quantization_levels)
         if (bad == 0) seen = max(seen, mine)
         stat = stat + abs(bad)
         !$omp end critical (gyroakf_quantization_levels)
         !$omp end parallel
      end if
      call check_memory(bad + stat, "the levels of the series", error)
      if (allocated(error)) return
      result%quantized = fits
      if (fits .and. counted > 0) result%levels = count(seen /= 0_int8, kind=int64)
   end subroutine check_grid

   !> The same for a chunk; ends with the block that does not fit.
   pure subroutine check_chunk(x, low, step, chunk, seen, fits, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: low, step
      integer, intent(in) :: chunk
      !> Levels that occur: [0:steps], or [0:0] where they are not counted
      integer(int8), intent(inout) :: seen(0:)
      logical, intent(inout) :: fits
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, level, last
      real(dp) :: place

      last = ubound(seen, 1, kind=int64)
      do i = chunk_first(size(x, kind=int64), chunk), chunk_last(size(x, kind=int64), chunk)
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         place = (x(i) - low)/step
         level = nint(place, int64)
         if (abs(place - real(level, dp)) > off_grid) fits = .false.
         if (last > 0) seen(min(max(level, 0_int64), last)) = 1_int8
         if (mod(i, block_length) == 0 .and. .not. fits) return
      end do
   end subroutine check_chunk

end module gyroakf_stats_quantization
