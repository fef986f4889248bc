! SPDX-License-Identifier: MIT
!> The fixed-interval smoother of a drift model: each sample's drift from the whole record, before and after it.
!>
!> The recursions are those of [[gyroakf_filter_smoother_step]]. The filter's states are kept at the beginnings of about sqrt(n)
!> blocks and recomputed within a block: two forward passes and one backward, exact, memory O(sqrt n).
!>
!> Source: Bryson & Frazier (1963); de Jong, J. Amer. Stat. Assoc. 84 (1989) 408-409; Durbin & Koopman, Time Series Analysis by
!> State Space Methods, 2nd ed. (2012), 4.4.
module gyroakf_filter_smoother
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_filter_components, only : component_model_type, component_state_type, check_components, settling_type, &
      start_components
   use gyroakf_filter_smoother_step, only : advance_smoother, smooth_back, smoother_back_type, smoother_step_type
   implicit none (type, external)
   private
   public :: smooth_drift

   !> Samples of a block, at least
   integer(int64), parameter :: shortest_block = 1024

contains

   !> Smooths the drift out of a series.
   subroutine smooth_drift(model, slow, z, drift, error, valid, variance, white, progress)
      !> Checked here
      type(component_model_type), intent(in) :: model
      !> Which processes are the drift: [count]; the others are noise
      logical, intent(in) :: slow(:)
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Its drift, also where samples are missing: [n]; not the same array as z
      real(dp), intent(out), contiguous :: drift(:)
      !> invalid_argument (sizes, model), non_finite, unstable, too_few_samples (none is present), no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Variance of its error: [n]
      real(dp), intent(inout), optional :: variance(:)
      !> Variance of the white noise at each sample instead of that of the model: [n], >= 0
      real(dp), intent(in), optional :: white(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(component_state_type), allocatable :: start(:)
      type(smoother_step_type), allocatable :: step(:)
      type(component_state_type) :: state
      type(settling_type) :: settling
      type(smoother_back_type) :: back
      integer(int64) :: n, length, blocks, b, from, to, seen
      integer :: stat

      n = size(z, kind=int64)
      call check_components(model, error)
      if (allocated(error)) return
      call check_sizes(n, size(drift, kind=int64), size(slow) == model%count, error, valid, variance, white)
      if (allocated(error)) return
      length = block_of(n)
      blocks = (n + length - 1)/length
      allocate (start(blocks), stat=stat)
      if (stat == 0) allocate (step(length), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the states of the smoother")
         return
      end if
      call start_components(model, state)
      seen = 0
      do b = 1, blocks
         start(b) = state
         from = (b - 1)*length + 1
         to = min(n, b*length)
         call advance_smoother(model, z, from, to, state, settling, step, seen, valid, white)
         call tell_progress("smoothing", to, 2*n, error, progress)
         if (allocated(error)) return
      end do
      if (seen == 0) then
         call fatal_error(error, status%too_few_samples, "a drift is smoothed out of measurements, and there is none")
         return
      end if
      do b = blocks, 1, -1
         from = (b - 1)*length + 1
         to = min(n, b*length)
         settling = settling_type()
         if (b < blocks) call advance_smoother(model, z, from, to, start(b), settling, step, seen, valid, white)
         call smooth_back(model, slow, step, from, to, back, drift, variance)
         call tell_progress("smoothing", 2*n - from, 2*n, error, progress)
         if (allocated(error)) return
      end do
   end subroutine smooth_drift

   !> Samples of a block.
   pure integer(int64) function block_of(n) result(length)
      !> Samples of the series
      integer(int64), intent(in) :: n

      length = max(shortest_block, int(sqrt(real(n, dp)), int64))
   end function block_of

   !> Refuses arrays that do not fit.
   subroutine check_sizes(n, output, named, error, valid, variance, white)
      !> Of the series, of the output; whether there is a word for each process
      integer(int64), intent(in) :: n, output
      logical, intent(in) :: named
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), intent(in), optional :: variance(:), white(:)
      logical :: same

      same = named .and. output == n
      if (present(valid)) same = same .and. size(valid, kind=int64) == n
      if (present(variance)) same = same .and. size(variance, kind=int64) == n
      if (present(white)) same = same .and. size(white, kind=int64) == n
      if (.not. same) call fatal_error(error, status%invalid_argument, "a smoother needs a series, an output and masks of one "// &
                                       "length, and a word for each process")
   end subroutine check_sizes

end module gyroakf_filter_smoother
