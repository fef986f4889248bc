! SPDX-License-Identifier: MIT
!> Innovations of an ARMA(p, q) series, p, q <= 3, and the sums that its likelihood is made of.
!>
!> At the beginning, and after a missing sample, the samples pass [[gyroakf_ar_arma_state]] one by one. Once its covariance is
!> steady (to rounding) and r samples have forgotten what was before, the same innovations come from the difference equation
!> $$e_t = z_t - \sum_i \phi_i z_{t-i} - \sum_j \theta_j e_{t-j}, \quad z_t = y_t - \mu$$
!> with variance ratio 1, and their derivatives from equations of the same kind, in O(p + q) a sample.
module gyroakf_ar_arma_filter
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_ar_arma_state, only : arma_sums_type, arma_state_type, begin_state, observe, skip, restore_state, most, lanes, &
      mean_lane
   implicit none (type, external)
   private
   public :: arma_series_type, sum_innovations

   !> Samples that are worked on together
   integer, parameter :: block = 128
   !> Samples between two reports of progress, a multiple of it
   integer(int64), parameter :: told_samples = 65536

   !> A series, centred and scaled
   type :: arma_series_type
      !> Values: [n]
      real(dp), allocatable :: y(:)
      !> 1 present, 0 missing: [n]; only where something is missing
      integer(int8), allocatable :: valid(:)
   end type arma_series_type

contains

   !> Sums over the innovations of a model.
   subroutine sum_innovations(series, phi, theta, mean, sums, stationary, with_information, switch, residual, progress, &
      & cancelled)
      !> The series
      type(arma_series_type), intent(in) :: series
      !> AR coefficients, MA coefficients, mean: [p], [q]; p, q <= 3
      real(dp), intent(in) :: phi(:), theta(:), mean
      !> The sums
      type(arma_sums_type), intent(out) :: sums
      !> The model is stationary; otherwise there are no sums
      logical, intent(out) :: stationary
      !> The information too, which doubles the time
      logical, intent(in) :: with_information
      !> False: one by one to the end, for tests; true if absent
      logical, intent(in), optional :: switch
      !> Innovations over the root of their variance ratio, 0 where missing: [n]
      real(dp), intent(inout), contiguous, optional :: residual(:)
      !> Told how far it is; may cancel: the model is then called not stationary
      class(progress_type), intent(inout), optional :: progress
      !> Goes with `progress`
      type(error_type), allocatable, intent(out), optional :: cancelled
      type(arma_state_type) :: state
      real(dp) :: v, f
      integer(int64) :: t, last, n, told
      logical :: may_switch, observed

      n = size(series%y, kind=int64)
      may_switch = .true.
      if (present(switch)) may_switch = switch
      call begin_state(phi, theta, state, stationary)
      if (.not. stationary) return
      t = 1
      told = 1
      do while (t <= n)
         if (present(progress) .and. t >= told) then
            call tell_progress("ARMA model", t - 1, n, cancelled, progress)
            stationary = .not. allocated(cancelled)
            if (.not. stationary) return
            told = t + told_samples
         end if
         observed = .true.
         if (allocated(series%valid)) observed = series%valid(t) /= 0_int8
         if (.not. observed) then
            call skip(state)
            if (present(residual)) residual(t) = 0.0_dp
         else if (may_switch .and. state%settled >= state%r) then
            last = end_of_run(series, t, told_samples)
            if (present(residual)) then
               call sum_steady(series%y(t:last), mean, state, sums, with_information, residual(t:last))
            else
               call sum_steady(series%y(t:last), mean, state, sums, with_information)
            end if
            call restore_state(state)
            t = last
         else
            call observe(state, series%y(t) - mean, sums, with_information, v, f)
            stationary = f > 0.0_dp
            if (.not. stationary) return
            if (present(residual)) residual(t) = v/sqrt(f)
         end if
         t = t + 1
      end do
   end subroutine sum_innovations

   !> The last of some samples that none is missing before.
   pure integer(int64) function end_of_run(series, first, longest) result(last)
      type(arma_series_type), intent(in) :: series
      !> The first of them, and how many at most
      integer(int64), intent(in) :: first, longest
      integer(int64) :: end

      end = min(size(series%y, kind=int64), first + longest - 1)
      last = end
      if (.not. allocated(series%valid)) return
      do last = first, end - 1
         if (series%valid(last + 1) == 0_int8) return
      end do
      last = end
   end function end_of_run

   !> A run of present samples while the covariance is steady.
   pure subroutine sum_steady(y, mean, state, sums, with_information, residual)
      !> Samples
      real(dp), intent(in), contiguous :: y(:)
      !> Their mean
      real(dp), intent(in) :: mean
      !> Its last values, innovations and derivatives are used and replaced
      type(arma_state_type), intent(inout) :: state
      !> Added to
      type(arma_sums_type), intent(inout) :: sums
      logical, intent(in) :: with_information
      !> Innovations: as many
      real(dp), intent(inout), contiguous, optional :: residual(:)
      real(dp) :: z(1 - most:block), e(1 - most:block), de(lanes, 1 - most:block)
      integer(int64) :: first
      integer :: n, j

      do j = 1, most
         z(1 - j) = state%y_past(j)
         e(1 - j) = state%e_past(j)
         de(:, 1 - j) = state%de_past(:, j)
      end do
      do first = 1, size(y, kind=int64), block
         n = int(min(int(block, int64), size(y, kind=int64) - first + 1))
         do j = 1, n
            z(j) = y(first + j - 1) - mean
         end do
         call predict_block(state, n, z, e, de)
         call add_block(n, e, de, sums, with_information)
         if (present(residual)) residual(first:first + n - 1) = e(1:n)
         do j = 1, most                    ! forwards would overwrite where n < most
            z(j - most) = z(n + j - most)
            e(j - most) = e(n + j - most)
            de(:, j - most) = de(:, n + j - most)
         end do
      end do
      do j = 1, most
         state%y_past(j) = z(1 - j)
         state%e_past(j) = e(1 - j)
         state%de_past(:, j) = de(:, 1 - j)
      end do
   end subroutine sum_steady

   !> Innovations and derivatives of a block.
   pure subroutine predict_block(state, n, z, e, de)
      type(arma_state_type), intent(in) :: state
      integer, intent(in) :: n
      !> Samples, three before
      real(dp), intent(in) :: z(1 - most:block)
      !> Innovations and derivatives; those of three before are known
      real(dp), intent(inout) :: e(1 - most:block), de(lanes, 1 - most:block)
      real(dp) :: f1, f2, f3, m1, m2, m3, level
      integer :: t, l

      f1 = state%phi(1)
      f2 = state%phi(2)
      f3 = state%phi(3)
      m1 = state%ma(2)
      m2 = state%ma(3)
      m3 = state%ma(4)
      level = 1.0_dp - f1 - f2 - f3
      do t = 1, n
         e(t) = z(t) - f1*z(t - 1) - f2*z(t - 2) - f3*z(t - 3)
      end do
      do t = 1, n
         e(t) = ((e(t) - m3*e(t - 3)) - m2*e(t - 2)) - m1*e(t - 1)
      end do
      do t = 1, n
         de(1, t) = -z(t - 1)
         de(2, t) = -z(t - 2)
         de(3, t) = -z(t - 3)
         de(4, t) = -e(t - 1)
         de(5, t) = -e(t - 2)
         de(6, t) = -e(t - 3)
         de(mean_lane, t) = -level
         de(lanes, t) = 0.0_dp
      end do
      do t = 1, n
         do l = 1, lanes
            de(l, t) = ((de(l, t) - m3*de(l, t - 3)) - m2*de(l, t - 2)) - m1*de(l, t - 1)
         end do
      end do
   end subroutine predict_block

   !> Adds a block to the sums.
   pure subroutine add_block(n, e, de, sums, with_information)
      integer, intent(in) :: n
      real(dp), intent(in) :: e(1 - most:block), de(lanes, 1 - most:block)
      type(arma_sums_type), intent(inout) :: sums
      logical, intent(in) :: with_information
      real(dp) :: slope(lanes), products(lanes, lanes), square
      integer :: t, l, m

      square = 0.0_dp
      slope = 0.0_dp
      products = 0.0_dp
      do t = 1, n
         square = square + e(t)*e(t)
         do l = 1, lanes
            slope(l) = slope(l) + e(t)*de(l, t)
         end do
      end do
      sums%count = sums%count + n
      sums%square = sums%square + square
      sums%square_slope(:) = sums%square_slope + slope
      if (.not. with_information) return
      do t = 1, n
         do m = 1, lanes
            do l = 1, lanes
               products(l, m) = products(l, m) + de(l, t)*de(m, t)
            end do
         end do
      end do
      sums%information(:, :) = sums%information + products
   end subroutine add_block

end module gyroakf_ar_arma_filter
