! SPDX-License-Identifier: MIT
!> The filter of a drift model whose white noise R is estimated from the innovations of a window (innovation-based adaptive
!> estimation).
!>
!> With the innovations e of the last W measurements, the newest included, and the variance P- that the model predicts for the sum
!> of its processes:
!> $$ R_k = \frac1W \sum_{j=k-W+1}^{k} e_j^2 - P_k^- $$
!> within bounds that follow the series (see `r_scale`), not the R of the model. Until W measurements have been seen R is that of
!> the model.
!>
!> Source: Mohamed & Schwarz, Adaptive Kalman filtering for INS/GPS, Journal of Geodesy 73 (1999) 193-203, R alone.
module filter_truth_innovation_window
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_components, only : check_components, component_model_type, &
      component_state_type, correct_components, predict_components, start_components, is_sample
   use gyroakf_filter_filter_types, only : filter_options
   implicit none (type, external)
   private
   public :: innovation_window_options, filter_innovation_window

   !> How R follows the innovations
   type :: innovation_window_options
      !> Measurements in the window, >= 2
      integer :: window = 100
      !> What the bounds of R are multiples of, u^2: half the variance of the differences of the series; 0: the R of the model
      real(dp) :: r_scale = 0.0_dp
   end type innovation_window_options

   !> The squared innovations of the window
   type :: window_type
      real(dp), allocatable :: square(:)
      !> Their sum; the next place, measurements so far
      real(dp) :: total = 0.0_dp
      integer :: next = 1
      integer(int64) :: seen = 0
   end type window_type

contains

   !> Filters a series.
   subroutine filter_innovation_window(model, slow, options, z, drift, error, valid, white)
      !> Checked here
      type(component_model_type), intent(in) :: model
      !> Which processes are the drift: [count]
      logical, intent(in) :: slow(:)
      type(innovation_window_options), intent(in) :: options
      !> Series: [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Its drift, predicted where a sample is missing: [n]; not the same array as z
      real(dp), intent(out), contiguous :: drift(:)
      !> invalid_argument (sizes, window, scale, model), non_finite, unstable, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> R at each sample: [n]
      real(dp), intent(out), optional :: white(:)
      type(component_state_type) :: state
      type(window_type) :: window
      real(dp) :: bounds(2), r
      integer(int64) :: k
      integer :: n
      logical :: here

      call check_components(model, error)
      if (.not. allocated(error)) call prepare(model, slow, options, z, drift, window, bounds, error, valid, white)
      if (allocated(error)) return
      n = model%count
      r = model%r
      call start_components(model, state)
      do k = 1, size(z, kind=int64)
         call predict_components(model, state)
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         if (here) then
            if (state%started) then
               call remember((z(k) - sum(state%x(:n)))**2, window)
               if (window%seen >= options%window) then
                  r = window%total/real(options%window, dp) - sum(state%p(:n, :n))
                  r = min(max(r, bounds(1)), bounds(2))
               end if
            end if
            call correct_components(n, r, z(k), state)
         end if
         drift(k) = sum(state%x(:n), mask=slow)
         if (present(white)) white(k) = r
      end do
   end subroutine filter_innovation_window

   !> Checks the arguments, makes the window and the bounds.
   subroutine prepare(model, slow, options, z, drift, window, bounds, error, valid, white)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(innovation_window_options), intent(in) :: options
      real(dp), intent(in) :: z(:), drift(:)
      type(window_type), intent(out) :: window
      real(dp), intent(out) :: bounds(2)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), intent(in), optional :: white(:)
      type(filter_options) :: limits
      real(dp) :: scale
      integer :: stat
      logical :: good

      bounds = 0.0_dp
      good = size(slow) == model%count .and. size(drift, kind=int64) == size(z, kind=int64)
      if (present(valid)) good = good .and. size(valid, kind=int64) == size(z, kind=int64)
      if (present(white)) good = good .and. size(white, kind=int64) == size(z, kind=int64)
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, "a filter needs a series, an output and masks of one length, and a "// &
                          "word for each process")
         return
      end if
      good = options%window >= 2 .and. is_sample(options%r_scale)
      if (good) good = options%r_scale >= 0.0_dp
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, "a window has at least two innovations, and the scale of R is >= 0")
         return
      end if
      scale = options%r_scale
      if (.not. scale > 0.0_dp) scale = model%r
      bounds = scale*[limits%r_lower, limits%r_upper]
      if (.not. bounds(1) > 0.0_dp) then
         call fatal_error(error, status%invalid_argument, "R is estimated within bounds: give its scale, or a model with R > 0")
         return
      end if
      allocate (window%square(options%window), source=0.0_dp, stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for a window of innovations")
   end subroutine prepare

   !> Takes in a squared innovation; the sum is made anew each time the window is full, so that it does not drift.
   pure subroutine remember(square, window)
      real(dp), intent(in) :: square
      type(window_type), intent(inout) :: window

      window%total = max(0.0_dp, window%total - window%square(window%next)) + square
      window%square(window%next) = square
      window%seen = window%seen + 1
      window%next = window%next + 1
      if (window%next > size(window%square)) then
         window%next = 1
         window%total = sum(window%square)
      end if
   end subroutine remember

end module filter_truth_innovation_window
