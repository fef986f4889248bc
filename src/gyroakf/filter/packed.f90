! SPDX-License-Identifier: MIT
!> The filter of an AR(p) state in one array of numbers, which the caller keeps: for programs that
!> have arrays only, write their state to a file, or hold many filters side by side. Steps allocate
!> nothing.
!>
!> The recursion is that of [[gyroakf_filter_kalman(module)]]; for p > 1 the numbers are the same to
!> the last bit.
module gyroakf_filter_packed
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_filter_types, only : filter_type
   use gyroakf_filter_components, only : is_sample
   use gyroakf_filter_kalman, only : step_vector
   implicit none (type, external)
   private
   public :: packed_length, pack_filter, is_packed, step_packed, freeze_packed, packed_numbers

   !> Numbers before the arrays phi, x, gain, steady gain, work [p] and P [p, p]
   integer, parameter :: head = 40

   !> What the first number is
   real(dp), parameter :: mark = 20250617.0_dp

contains

   !> Numbers that a filter of order p takes: 40 + 5 p + p^2.
   pure integer function packed_length(p)
      !> Its order, 1 .. 1000
      integer, intent(in) :: p

      packed_length = head + 5*p + p*p
   end function packed_length

   !> Whether an array holds a filter.
   pure logical function is_packed(state)
      !> Any
      real(dp), intent(in) :: state(2)

      is_packed = .false.
      if (.not. all(is_sample(state))) return
      is_packed = abs(state(1) - mark) < 0.5_dp .and. state(2) > 0.5_dp .and. state(2) < 1000.5_dp
   end function is_packed

   !> Puts a filter into an array.
   pure subroutine pack_filter(filter, state)
      !> Made by `new_filter`
      type(filter_type), intent(in) :: filter
      !> [packed_length(filter%order)]
      real(dp), intent(out) :: state(:)
      integer :: n

      n = filter%order
      state = 0.0_dp
      state(1) = mark
      state(2) = real(n, dp)
      call put_numbers(filter, state)
      state(head + 1:head + n) = filter%phi
      state(head + n + 1:head + 2*n) = filter%x
      state(head + 2*n + 1:head + 3*n) = filter%gain
      state(head + 3*n + 1:head + 4*n) = filter%steady_gain
      state(head + 5*n + 1:) = reshape(filter%p, [n*n])
   end subroutine pack_filter

   !> All numbers of a filter that are no arrays and change from step to step, or do not.
   pure subroutine put_numbers(filter, state)
      type(filter_type), intent(in) :: filter
      real(dp), intent(inout) :: state(:)

      state(3:8) = [filter%q, filter%r, filter%q_mean, filter%r_mean, filter%innovation, &
         filter%innovation_variance]
      state(9:14) = real([filter%steps, filter%clamped, filter%gated, filter%measurements, &
         filter%q_at_floor, filter%r_at_floor], dp)
      state(15:17) = real([filter%wait, filter%weight_updates, filter%run], dp)
      state(18) = filter%weight
      state(19:22) = [filter%q_bounds, filter%r_bounds]
      state(23) = filter%consistency
      state(24:25) = [filter%options%forgetting, filter%options%huber]
      state(26:35) = merge(1.0_dp, 0.0_dp, [filter%frozen, filter%settled, filter%adaptive, &
         filter%varying, filter%by_residual, filter%by_posterior, &
         filter%options%estimate_process_mean, filter%options%estimate_measurement_mean, &
         filter%options%estimate_process_variance, filter%options%estimate_measurement_variance])
   end subroutine put_numbers

   !> The same numbers taken out; the arrays of the filter stay unallocated.
   pure subroutine take_numbers(state, filter)
      real(dp), intent(in) :: state(:)
      type(filter_type), intent(out) :: filter

      filter%order = nint(state(2))
      filter%q = state(3)
      filter%r = state(4)
      filter%q_mean = state(5)
      filter%r_mean = state(6)
      filter%innovation = state(7)
      filter%innovation_variance = state(8)
      filter%steps = nint(state(9), int64)
      filter%clamped = nint(state(10), int64)
      filter%gated = nint(state(11), int64)
      filter%measurements = nint(state(12), int64)
      filter%q_at_floor = nint(state(13), int64)
      filter%r_at_floor = nint(state(14), int64)
      filter%wait = nint(state(15))
      filter%weight_updates = nint(state(16))
      filter%run = nint(state(17))
      filter%weight = state(18)
      filter%q_bounds = state(19:20)
      filter%r_bounds = state(21:22)
      filter%consistency = state(23)
      filter%options%forgetting = state(24)
      filter%options%huber = state(25)
      filter%frozen = state(26) > 0.5_dp
      filter%settled = state(27) > 0.5_dp
      filter%adaptive = state(28) > 0.5_dp
      filter%varying = state(29) > 0.5_dp
      filter%by_residual = state(30) > 0.5_dp
      filter%by_posterior = state(31) > 0.5_dp
      filter%options%estimate_process_mean = state(32) > 0.5_dp
      filter%options%estimate_measurement_mean = state(33) > 0.5_dp
      filter%options%estimate_process_variance = state(34) > 0.5_dp
      filter%options%estimate_measurement_variance = state(35) > 0.5_dp
   end subroutine take_numbers

   !> One step, as `step_filter`.
   pure subroutine step_packed(state, z, estimate)
      !> Holds a filter; it goes on: [packed_length]
      real(dp), intent(inout), contiguous :: state(:)
      !> Measurement; NaN, infinite or beyond 1e149: missing
      real(dp), intent(in) :: z
      !> Estimate of the state
      real(dp), intent(out) :: estimate
      type(filter_type) :: filter
      integer :: n

      call take_numbers(state, filter)
      n = filter%order
      call step_vector(filter, n, state(head + 1:head + n), state(head + 3*n + 1:head + 4*n), &
         & state(head + n + 1:head + 2*n), state(head + 2*n + 1:head + 3*n), &
         & state(head + 4*n + 1:head + 5*n), state(head + 5*n + 1:), z, is_sample(z))
      call put_numbers(filter, state)
      estimate = state(head + n + 1)
   end subroutine step_packed

   !> No adaptation from here on, or again, as `freeze_filter`.
   pure subroutine freeze_packed(state, frozen)
      !> Holds a filter
      real(dp), intent(inout) :: state(:)
      !> Whether it is frozen
      logical, intent(in) :: frozen

      state(26) = merge(1.0_dp, 0.0_dp, frozen)
   end subroutine freeze_packed

   !> x, its variance, gain, innovation, its variance, q, r, Q, R after the last step.
   pure subroutine packed_numbers(state, numbers)
      !> Holds a filter
      real(dp), intent(in) :: state(:)
      !> In that order
      real(dp), intent(out) :: numbers(9)
      integer :: n

      n = nint(state(2))
      numbers = [state(head + n + 1), state(head + 5*n + 1), state(head + 2*n + 1), state(7), &
         state(8), state(5), state(6), state(3), state(4)]
   end subroutine packed_numbers

end module gyroakf_filter_packed
