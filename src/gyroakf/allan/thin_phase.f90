! SPDX-License-Identifier: MIT
!> The integral of a long record at every step-th sample only, with the sums that need all of it.
!>
!> The windows of adev and hdev begin at multiples of m. Where the factors beyond the shortest ones
!> are multiples of one step, as in octaves and decades, the phases that they need are a small part
!> of all. Those of the shortest ones are made in stretches that stay in the cache, and no array of
!> the length of the record is written.
module gyroakf_allan_thin_phase
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_threads, only : thread_count
   use gyroakf_allan_block_sums, only : block_length, block_sums_type
   use gyroakf_allan_curve, only : allan_curve_type, fill_curve, fill_limits
   use gyroakf_allan_noise_identification, only : identify_noise, means_max
   use gyroakf_allan_phase, only : integrate_rate, integrate_stretch
   use gyroakf_allan_statistic, only : difference_order, term_count, variance_divisor
   use gyroakf_allan_window_difference, only : add_sums, add_windows, window_sums_type, sum_windows
   implicit none (type, external)
   private
   public :: thinning_index, fill_from_few_phases

   !> Length of record that is worth it, least step, longest factor that is no multiple of it
   integer(int64), parameter :: samples_min = 1000000, step_min = 16, factor_max = 64
   !> Samples of a stretch, and stretches that follow each other on one thread
   integer(int64), parameter :: stretch_length = 16*block_length, row = 8

contains

   !> Place of the factor that serves as the step: all after it are multiples of it; 0 where none is
   !> worth it.
   pure integer function thinning_index(n, m) result(place)
      !> Samples
      integer(int64), intent(in) :: n
      !> Averaging factors, ascending
      integer(int64), intent(in) :: m(:)

      do place = 1 + count(m < step_min), min(size(m), 1 + count(m <= factor_max))
         if (n < max(samples_min, 1024*m(place))) exit
         if (all(modulo(m(place:), m(place)) == 0)) return
      end do
      place = 0
   end function thinning_index

   !> The curve of a long record of which few phases are needed.
   subroutine fill_from_few_phases(rate, blocks, m, place, min_coverage, curve, error, progress)
      !> Rate samples, none missing: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> From [[sum_blocks]]
      type(block_sums_type), intent(in) :: blocks
      !> Averaging factors, and the place of the step among them, from [[thinning_index]]
      integer(int64), intent(in) :: m(:)
      integer, intent(in) :: place
      !> As of [[identify_noise]]
      real(dp), intent(in) :: min_coverage
      !> Of kind adev or hdev, without averaging times
      type(allan_curve_type), intent(inout) :: curve
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(window_sums_type) :: sums(size(m))
      real(dp), allocatable :: phase(:)
      integer(int32), allocatable :: missing(:)
      integer(int64) :: n, terms(size(m)), first, seen
      integer :: order

      n = size(rate, kind=int64)
      order = difference_order(curve%kind)
      call integrate_thin(rate, blocks, m(:place - 1), order, m(place), phase, sums(:place - 1), &
         & error, progress)
      if (.not. allocated(error)) call sum_windows(phase, m(place:)/m(place), order, .false., &
         & sums(place:), error, progress=progress)
      if (allocated(error)) return
      terms = term_count(curve%kind, n, m)
      call fill_curve(m, sums%squares/(variance_divisor(curve%kind, m)*real(terms, dp)), &
         & terms, spread(1.0_dp, 1, size(m)), curve, error)
      if (.not. allocated(error)) call identify_noise(phase, m(place:)/m(place), &
         & min_coverage, curve%alpha(place:), error, differences=order)
      if (allocated(error)) return
      ! the others look at the middle of the record
      if (place > 1) then
         seen = min(n, means_max*m(place - 1) + modulo(n, 2_int64))
         first = (n - seen)/2
         call integrate_rate(rate(first + 1:first + seen), phase, missing, error)
         if (.not. allocated(error)) call identify_noise(phase, m(:place - 1), &
            & min_coverage, curve%alpha(:place - 1), error, differences=order)
         if (allocated(error)) return
      end if
      call fill_limits(curve)
   end subroutine fill_from_few_phases

   !> Integrates a record without gaps, and sums the windows of the factors that do not go without
   !> the rest of the phases.
   subroutine integrate_thin(rate, blocks, m, order, step, phase, sums, error, progress)
      real(dp), intent(in), contiguous :: rate(:)
      type(block_sums_type), intent(in) :: blocks
      !> Factors before the step
      integer(int64), intent(in) :: m(:)
      !> Windows, 2 or 3
      integer, intent(in) :: order
      !> Every which phase is kept
      integer(int64), intent(in) :: step
      !> Phases 0, step, 2 step ...: [0:n/step]
      real(dp), allocatable, intent(out) :: phase(:)
      !> As of [[sum_windows]]: [size(m)]
      type(window_sums_type), intent(out) :: sums(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      real(dp), allocatable :: x(:, :)
      type(window_sums_type), allocatable :: part(:, :)
      integer(int64) :: n, from, begin, group, s
      integer :: stat

      n = size(rate, kind=int64)
      group = 2*thread_count()
      allocate (phase(0:n/step), stat=stat)
      if (stat == 0) allocate (x(0:stretch_length + order*factor_max, group), stat=stat)
      if (stat == 0) allocate (part(size(m), group), stat=stat)
      call check_memory(stat, "the integral of the record", error)
      if (allocated(error)) return
      phase(0) = 0
      do from = 0, n - 1, group*row*stretch_length
         call report_progress("Allan deviation", from, n, error, progress)
         if (allocated(error)) return
         part = window_sums_type()
         !$omp parallel do schedule(dynamic) private(begin)
         do s = 1, group
            do begin = from + (s - 1)*row*stretch_length, min(n, from + s*row*stretch_length) - 1, &
               & stretch_length
               call add_stretch(rate, blocks, begin, m, order, step, x(:, s), phase, part(:, s))
            end do
         end do
         !$omp end parallel do
         do s = 1, group
            call add_sums(part(:, s), sums)
         end do
      end do
   end subroutine integrate_thin

   !> One stretch: its phases at the steps, and the terms that begin in it.
   subroutine add_stretch(rate, blocks, begin, m, order, step, x, phase, sums)
      real(dp), intent(in), contiguous :: rate(:)
      type(block_sums_type), intent(in) :: blocks
      !> Samples before it, whole blocks
      integer(int64), intent(in) :: begin, m(:), step
      integer, intent(in) :: order
      !> Place for its phases, and those of the windows that reach beyond it
      real(dp), intent(inout), contiguous :: x(0:), phase(0:)
      type(window_sums_type), intent(inout) :: sums(:)

      type(window_sums_type) :: part
      integer(int64) :: length, block, first, last
      integer :: i

      length = min(ubound(x, 1, kind=int64), size(rate, kind=int64) - begin)
      block = begin/block_length + 1
      x(0) = blocks%offset(block)
      call integrate_stretch(rate(begin + 1:begin + length), blocks%mean, blocks%offset(block:), &
         & x(1:length))
      do i = 1, size(m)
         first = modulo(-begin, m(i))
         last = min(stretch_length - 1, length - order*m(i))
         call add_windows(x(:length), m(i), order, m(i), first, last, part)
         call add_sums(part, sums(i))
      end do
      first = begin/step + 1
      last = (begin + min(stretch_length, length))/step
      phase(first:last) = x(first*step - begin:last*step - begin:step)
   end subroutine add_stretch

end module gyroakf_allan_thin_phase
