! SPDX-License-Identifier: MIT
!> The fixed-interval smoother of a drift model: each sample's drift from the whole record, before
!> and after it.
!>
!> With filtered estimates x_k, P_k, gains K, innovations e and their variances S, backwards from
!> rho = 0, N = 0:
!> $$ \hat x_k = x_k + P_k \rho_k, \quad V_k = P_k - P_k N_k P_k $$
!> $$ \rho_{k-1} = \Phi^T \big[ (I - K \mathbf 1^T)^T \rho_k + \mathbf 1\, e_k/S_k \big], \quad
!>    N_{k-1} = \Phi^T \big[ (I - K \mathbf 1^T)^T N_k (I - K \mathbf 1^T)
!>    + \mathbf 1 \mathbf 1^T/S_k \big] \Phi $$
!> without an inverse of a covariance. The filter's states are kept at the beginnings of about
!> sqrt(n) blocks and recomputed within a block: two forward passes and one backward, exact, memory
!> O(sqrt n).
!>
!> Source: Bryson & Frazier (1963); de Jong, J. Amer. Stat. Assoc. 84 (1989) 408-409; Durbin &
!> Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 4.4.
module gyroakf_filter_smoother
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_filter_components, only : component_model_type, component_state_type, &
      most_components, check_components, correct_components, predict_components, &
      settle_distance, start_components, is_sample
   use gyroakf_filter_drift_steady, only : steady_drift_gain
   implicit none (type, external)
   private
   public :: smooth_drift, check_sizes

   !> Samples of a block, at least
   integer(int64), parameter :: shortest_block = 1024

   !> What the way back needs of a sample: the state behind it
   type :: smoother_step_type
      type(component_state_type) :: state
      !> There is a measurement that has an innovation; it is the first of a random walk
      logical :: counts = .false., begins = .false.
   end type smoother_step_type

   !> What is carried back
   type :: smoother_back_type
      real(dp) :: rho(most_components) = 0.0_dp, n(most_components, most_components) = 0.0_dp
      !> Before the first measurement of a random walk: estimates and their covariance
      logical :: before = .false.
      type(component_state_type) :: state
   end type smoother_back_type

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
      !> invalid_argument (sizes, model), non_finite, unstable, too_few_samples (none is present),
      !> no_memory, cancelled
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
      real(dp) :: steady(most_components)
      logical :: settled
      type(smoother_back_type) :: back
      type(error_type), allocatable :: failed
      integer(int64) :: n, length, blocks, b, from, to, seen
      integer :: stat

      n = size(z, kind=int64)
      call check_components(model, error)
      if (allocated(error)) return
      call check_sizes(n, size(drift, kind=int64), size(slow) == model%count, error, valid, &
         variance, white)
      if (allocated(error)) return
      length = max(shortest_block, int(sqrt(real(n, dp)), int64))
      blocks = (n + length - 1)/length
      allocate (start(blocks), stat=stat)
      if (stat == 0) allocate (step(length), stat=stat)
      call check_memory(stat, "the states of the smoother", error)
      if (allocated(error)) return
      call steady_drift_gain(model, steady, failed)
      if (allocated(failed)) steady = 0.0_dp
      call start_components(model, state)
      settled = .false.
      seen = 0
      do b = 1, blocks
         start(b) = state
         from = (b - 1)*length + 1
         to = min(n, b*length)
         call advance_smoother(model, z, from, to, state, steady, settled, step, seen, valid, white)
         call report_progress("smoothing", to, 2*n, error, progress)
         if (allocated(error)) return
      end do
      if (seen == 0) then
         call fatal_error(error, status%too_few_samples, &
            "a drift is smoothed out of measurements, and there is none")
         return
      end if
      do b = blocks, 1, -1
         from = (b - 1)*length + 1
         to = min(n, b*length)
         settled = .false.
         if (b < blocks) call advance_smoother(model, z, from, to, start(b), steady, settled, &
                                              step, seen, valid, white)
         call smooth_back(model, slow, step, from, to, back, drift, variance)
         call report_progress("smoothing", 2*n - from, 2*n, error, progress)
         if (allocated(error)) return
      end do
   end subroutine smooth_drift

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
      if (.not. same) call fatal_error(error, status%invalid_argument, &
         "a smoother needs a series, an output and masks of one "// &
                                       "length, and a word for each process")
   end subroutine check_sizes

   !> The filter over a block; keeps every step.
   pure subroutine advance_smoother(model, z, from, to, state, steady, settled, step, seen, &
                                    valid, white)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in), contiguous :: z(:)
      integer(int64), intent(in) :: from, to
      !> Before the block, behind it afterwards
      type(component_state_type), intent(inout) :: state
      !> Gains that it settles to, and whether it has
      real(dp), intent(in) :: steady(:)
      logical, intent(inout) :: settled
      type(smoother_step_type), intent(inout), contiguous :: step(:)
      integer(int64), intent(inout) :: seen
      integer(int8), intent(in), optional :: valid(:)
      real(dp), intent(in), optional :: white(:)
      integer(int64) :: k
      integer :: n
      real(dp) :: r
      logical :: here

      n = model%count
      r = model%r
      do k = from, to
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         if (present(white)) r = white(k)
         associate (now => step(k - from + 1))
            now%counts = here .and. state%started
            now%begins = here .and. .not. state%started
            if (here) seen = seen + 1
            if (settled .and. here) then
               state%x(:n) = model%phi(:n)*state%x(:n)
               state%innovation = z(k) - sum(state%x(:n))
               state%x(:n) = state%x(:n) + state%gain(:n)*state%innovation
            else
               call predict_components(model, state)
               if (here) call correct_components(n, r, z(k), state)
               settled = now%counts .and. .not. present(white)
               if (settled) settled = maxval(abs(state%gain(:n) - steady(:n))) <= &
                                      settle_distance(maxval(steady(:n)))
            end if
            now%state = state
         end associate
      end do
   end subroutine advance_smoother

   !> The way back through a block; covariances only where the variance is wanted.
   pure subroutine smooth_back(model, slow, step, from, to, back, drift, variance)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(smoother_step_type), intent(in), contiguous :: step(:)
      integer(int64), intent(in) :: from, to
      type(smoother_back_type), intent(inout) :: back
      real(dp), intent(inout), contiguous :: drift(:)
      real(dp), intent(inout), optional :: variance(:)
      integer(int64) :: k
      integer :: n

      n = model%count
      do k = to, from, -1
         associate (now => step(k - from + 1))
            if (back%before) then       ! the processes are the same in both directions of time
               call predict_components(model, back%state)
            else
               associate (p => now%state%p(:n, :n))
                  back%state%x(:n) = now%state%x(:n) + matmul(p, back%rho(:n))
                  if (present(variance)) back%state%p(:n, :n) = p &
                     - matmul(matmul(p, back%n(:n, :n)), p)
               end associate
            end if
            drift(k) = sum(back%state%x(:n), mask=slow)
            if (present(variance)) variance(k) = sum(back%state%p(:n, :n), mask=spread(slow, 1, n) &
               .and. spread(slow, 2, n))
            back%before = back%before .or. now%begins
            if (back%before) cycle
            if (present(variance)) call carry_covariance(model, now, back)
            call carry_back(model, now, back)
         end associate
      end do
   end subroutine smooth_back

   !> Rho back by one sample and its measurement.
   pure subroutine carry_back(model, now, back)
      type(component_model_type), intent(in) :: model
      type(smoother_step_type), intent(in) :: now
      type(smoother_back_type), intent(inout) :: back
      real(dp) :: change
      integer :: n

      n = model%count
      if (now%counts) then
         change = now%state%innovation/now%state%variance &
            - dot_product(now%state%gain(:n), back%rho(:n))
         back%rho(:n) = back%rho(:n) + change
      end if
      back%rho(:n) = model%phi(:n)*back%rho(:n)
   end subroutine carry_back

   !> N back by one sample and its measurement.
   pure subroutine carry_covariance(model, now, back)
      type(component_model_type), intent(in) :: model
      type(smoother_step_type), intent(in) :: now
      type(smoother_back_type), intent(inout) :: back
      real(dp) :: kn(most_components), change
      integer :: i, j, n

      n = model%count
      kn = 0.0_dp
      change = 0.0_dp
      if (now%counts) then
         associate (gain => now%state%gain(:n))
            do j = 1, n
               kn(j) = dot_product(gain, back%n(:n, j))
            end do
            change = dot_product(gain, kn(:n)) + 1.0_dp/now%state%variance
         end associate
      end if
      do j = 1, n
         do i = 1, n
            back%n(i, j) = model%phi(i)*model%phi(j)*(back%n(i, j) - kn(i) - kn(j) + change)
         end do
      end do
   end subroutine carry_covariance

end module gyroakf_filter_smoother
