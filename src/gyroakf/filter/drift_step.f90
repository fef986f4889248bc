! SPDX-License-Identifier: MIT
!> The drift filter of any number of processes, sample by sample.
module gyroakf_filter_drift_step
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_components, only : predict_components, correct_components, &
      settle_distance, vanished, is_sample
   use gyroakf_filter_sage_husa, only : adapt_noise, gate_inflation, watch_level
   use gyroakf_filter_filter_types, only : drift_filter_type
   implicit none (type, external)
   private
   public :: run_processes, show_drift

contains

   !> The filter over a series, or the next part of one.
   pure subroutine run_processes(filter, z, x, valid, normalized_innovation)
      !> A drift filter; its state goes on
      type(drift_filter_type), intent(inout) :: filter
      !> Measurements, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Estimates, [n]
      real(dp), intent(out), contiguous :: x(:)
      !> 1 where the measurement is present, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Innovations over their standard deviations, [n], 0 where there is none
      real(dp), intent(out), optional :: normalized_innovation(:)
      integer(int64) :: k
      integer :: n
      logical :: here, first

      n = filter%model%count
      do k = 1, size(z, kind=int64)
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         first = .not. filter%state%started     ! of a random walk: there is no innovation
         if (here) then
            call step_measured(filter, z(k))
         else if (.not. first) then
            call step_missing(filter)
         end if
         x(k) = sum(filter%state%x(:n), mask=filter%slow(:n))
         if (present(normalized_innovation)) then
            normalized_innovation(k) = 0.0_dp
            if (here .and. .not. first) normalized_innovation(k) = &
               filter%innovation/sqrt(filter%innovation_variance)
         end if
      end do
      filter%steps = filter%steps + size(z, kind=int64)
      call show_drift(filter)
   end subroutine run_processes

   !> A step without a measurement.
   pure subroutine step_missing(filter)
      type(drift_filter_type), intent(inout) :: filter

      call predict_components(filter%model, filter%state)
      where (abs(filter%state%x) < vanished) filter%state%x = 0.0_dp
      where (abs(filter%state%p) < vanished) filter%state%p = 0.0_dp
      filter%settled = .false.
   end subroutine step_missing

   !> A step with one.
   pure subroutine step_measured(filter, z)
      type(drift_filter_type), intent(inout) :: filter
      real(dp), intent(in) :: z
      real(dp) :: inflation, prior, variance
      integer :: i, n

      n = filter%model%count
      associate (state => filter%state)
         if (.not. state%started) then
            call correct_components(n, filter%r, z, state)
         else if (filter%settled) then
            state%x(:n) = filter%model%phi(:n)*state%x(:n)
            filter%innovation = z - sum(state%x(:n))
            state%x(:n) = state%x(:n) + filter%steady_gains(:n)*filter%innovation
         else
            call predict_components(filter%model, state)
            prior = sum(state%p(:n, :n))
            filter%innovation = z - sum(state%x(:n))
            filter%innovation_variance = prior + filter%r
            inflation = gate_inflation(filter%options%huber, filter%innovation, &
               filter%innovation_variance)
            call correct_components(n, filter%r*inflation, z, state)
            i = filter%shifted
            variance = state%p(i, i)
            call watch_level(filter%filter_type, inflation, variance)
            state%p(i, i) = variance
            if (filter%adaptive .and. .not. filter%frozen) then
               call adapt_noise(filter%filter_type, filter%innovation, &
                  filter%innovation_variance, prior)
            end if
            if (.not. filter%varying) then
               filter%settled = maxval(abs(state%gain(:n) - filter%steady_gains(:n))) &
                                <= settle_distance(maxval(abs(filter%steady_gains(:n))))
               if (filter%settled) state%gain(:n) = filter%steady_gains(:n)
            end if
         end if
         filter%gain_sum(:n) = filter%gain_sum(:n) + state%gain(:n)
      end associate
      filter%gain_measurements = filter%gain_measurements + 1
      filter%measurements = filter%measurements + 1
   end subroutine step_measured

   !> The drift out of its processes: x(1), p(1,1), gain(1).
   pure subroutine show_drift(filter)
      !> The filter
      type(drift_filter_type), intent(inout) :: filter
      integer :: i, n

      n = filter%model%count
      filter%x(1) = sum(filter%state%x(:n), mask=filter%slow(:n))
      filter%gain(1) = sum(filter%state%gain(:n), mask=filter%slow(:n))
      filter%p(1, 1) = 0.0_dp
      do i = 1, n
         if (filter%slow(i)) filter%p(1, 1) = filter%p(1, 1) &
            + sum(filter%state%p(:n, i), mask=filter%slow(:n))
      end do
      if (.not. filter%state%started) filter%p(1, 1) = huge(1.0_dp)
   end subroutine show_drift
end module gyroakf_filter_drift_step
