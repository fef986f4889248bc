! SPDX-License-Identifier: MIT
!> The prediction of an ARMA(p, q) series, p, q <= 3, one sample at a time, with its derivatives.
!>
!> With r = max(p, q + 1), phi and theta filled up with zeros and theta_0 = 1 the state a (Harvey's form) obeys
!> $$a_{t+1,i} = \phi_i y_t + a_{t,i+1} + \kappa_i v_t, \quad v_t = y_t - a_{t,1}, \quad \kappa_i = P_{1,i+1}/F, \quad F = P_{1,1}$$
!> and its covariance in units of the innovation variance
!> $$P_{i,j} \leftarrow P_{i+1,j+1} - P_{1,i+1} P_{1,j+1}/F + \theta_{i-1}\theta_{j-1}.$$
!> This is the Kalman filter after what cancels for a measurement without noise is left out; a missing sample leaves out the
!> correction. P starts from the stationary covariance, the solution of the linear equations P = T P T' + theta theta', and falls
!> to theta theta', where F = 1 and kappa_i = theta_i: then predictions are those of [[gyroakf_ar_arma_filter]]. All derivatives by
!> the coefficients and the mean are carried along. Source: A. C. Harvey, Forecasting, Structural Time Series Models and the
!> Kalman Filter (1989), 3.3, 3.4; G. Gardner, A. C. Harvey, G. D. A. Phillips, Appl. Stat. 29 (1980) 311-322 (AS 154).
module gyroakf_ar_arma_state
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dgesv
   implicit none (type, external)
   private
   public :: arma_sums_type, arma_state_type, begin_state, observe, skip, restore_state, most, lanes, mean_lane

   !> Largest p and q; numbers that are differentiated by: phi_1 .. 3, theta_1 .. 3, the mean, one to fill up
   integer, parameter :: most = 3, lanes = 8, mean_lane = 7
   !> Largest dimension of the state
   integer, parameter :: largest = most + 1
   !> P, and its derivatives, are steady when they differ by no more than this from their limit
   real(dp), parameter :: steady = 8.0_dp*epsilon(1.0_dp), steady_derivative = 1.0e-13_dp

   !> What the likelihood is made of; derivatives are by phi_1 .. 3, theta_1 .. 3 and the mean
   type :: arma_sums_type
      !> Present samples
      integer(int64) :: count = 0
      !> Sums of v^2/F and of ln F
      real(dp) :: square = 0.0_dp, log_f = 0.0_dp
      !> Half the derivatives of `square`, and those of `log_f`: [lanes]
      real(dp) :: square_slope(lanes) = 0.0_dp, log_f_slope(lanes) = 0.0_dp
      !> Sums of v' v'/F and of F' F'/F^2: [lanes, lanes]
      real(dp) :: information(lanes, lanes) = 0.0_dp, f_information(lanes, lanes) = 0.0_dp
   end type arma_sums_type

   !> State of the prediction
   type :: arma_state_type
      !> Dimension; steps since P has been steady without a missing sample
      integer :: r = 1, settled = 0
      !> Coefficients, filled up with 0; moving average with its leading 1
      real(dp) :: phi(largest) = 0.0_dp, ma(largest) = 0.0_dp
      !> Prediction and covariance
      real(dp) :: a(largest + 1) = 0.0_dp, p(largest + 1, largest + 1) = 0.0_dp
      !> Derivatives, those of theta theta' among them: [lanes, ...]; of symmetric matrices the upper triangle
      real(dp) :: dmm(lanes, largest, largest) = 0.0_dp
      real(dp) :: dphi(lanes, largest) = 0.0_dp, dma(lanes, largest) = 0.0_dp, da(lanes, largest + 1) = 0.0_dp
      real(dp) :: dp(lanes, largest + 1, largest + 1) = 0.0_dp
      !> The last values of the series, of the innovations and of their derivatives, the newest first
      real(dp) :: y_past(most) = 0.0_dp, e_past(most) = 0.0_dp, de_past(lanes, most) = 0.0_dp
   end type arma_state_type

contains

   !> The state before the first sample.
   subroutine begin_state(phi, theta, state, stationary)
      !> Coefficients: [p], p <= 3
      real(dp), intent(in) :: phi(:)
      !> Coefficients: [q], q <= 3
      real(dp), intent(in) :: theta(:)
      !> The state
      type(arma_state_type), intent(out) :: state
      !> The covariance could be solved for, and is one
      logical, intent(out) :: stationary
      integer :: i, j

      state%r = max(size(phi), size(theta) + 1)
      state%phi(:size(phi)) = phi
      state%ma(1) = 1.0_dp
      state%ma(2:size(theta) + 1) = theta
      do i = 1, size(phi)
         state%dphi(i, i) = 1.0_dp
      end do
      do i = 1, size(theta)
         state%dma(most + i, i + 1) = 1.0_dp
      end do
      do j = 1, state%r
         do i = 1, j
            state%dmm(:, i, j) = state%dma(:, i)*state%ma(j) + state%ma(i)*state%dma(:, j)
         end do
      end do
      call start_covariance(state, stationary)
   end subroutine begin_state

   !> Stationary covariance and its derivatives: linear equations in the entries on and above the diagonal.
   subroutine start_covariance(state, stationary)
      type(arma_state_type), intent(inout) :: state
      logical, intent(out) :: stationary
      integer, parameter :: entries = largest*(largest + 1)/2
      real(dp) :: matrix(entries, entries), copy(entries, entries), right(entries, lanes)
      integer :: at(largest + 1, largest + 1), pivot(entries), i, j, l, n, info

      n = 0
      at = 0
      do j = 1, state%r
         do i = 1, j
            n = n + 1
            at(i, j) = n
            at(j, i) = n
         end do
      end do
      matrix = 0.0_dp
      do j = 1, state%r
         do i = 1, j
            matrix(at(i, j), at(i, j)) = matrix(at(i, j), at(i, j)) + 1.0_dp
            call add(at(i, j), 1, 1, -state%phi(i)*state%phi(j))
            call add(at(i, j), 1, j + 1, -state%phi(i))
            call add(at(i, j), 1, i + 1, -state%phi(j))
            call add(at(i, j), i + 1, j + 1, -1.0_dp)
            right(at(i, j), 1) = state%ma(i)*state%ma(j)
         end do
      end do
      copy(:, :) = matrix
      call dgesv(n, 1, copy, entries, pivot, right, entries, info)
      stationary = info == 0
      if (.not. stationary) return
      call spread_out(right(:, 1), state%p)
      stationary = state%p(1, 1) > 0.0_dp
      if (.not. stationary) return
      do j = 1, state%r
         do i = 1, j
            right(at(i, j), :) = state%p(1, 1)*(state%dphi(:, i)*state%phi(j) + state%phi(i)*state%dphi(:, j)) &
               + state%dphi(:, i)*state%p(1, j + 1) + state%dphi(:, j)*state%p(1, i + 1) &
               + state%dma(:, i)*state%ma(j) + state%ma(i)*state%dma(:, j)
         end do
      end do
      copy(:, :) = matrix
      call dgesv(n, lanes, copy, entries, pivot, right, entries, info)
      do l = 1, lanes
         call spread_out(right(:, l), state%dp(l, :, :))
      end do

   contains

      !> Adds to the coefficient of P(i, j) in a row; entries beyond the state are 0.
      subroutine add(row, i, j, value)
         integer, intent(in) :: row, i, j
         real(dp), intent(in) :: value

         if (at(i, j) > 0) matrix(row, at(i, j)) = matrix(row, at(i, j)) + value
      end subroutine add

      !> The symmetric matrix of its entries.
      subroutine spread_out(entry, p)
         real(dp), intent(in) :: entry(:)
         real(dp), intent(inout) :: p(:, :)
         integer :: row, column

         do column = 1, state%r
            do row = 1, state%r
               p(row, column) = entry(at(row, column))
            end do
         end do
      end subroutine spread_out

   end subroutine start_covariance

   !> A sample: adds to the sums and goes on to the next.
   pure subroutine observe(state, y, sums, with_information, innovation, variance)
      !> The state
      type(arma_state_type), intent(inout) :: state
      !> The sample without the mean
      real(dp), intent(in) :: y
      !> Added to
      type(arma_sums_type), intent(inout) :: sums
      !> The information too
      logical, intent(in) :: with_information
      !> v and F; F <= 0, by rounding where the model is hardly stationary: nothing is done
      real(dp), intent(out) :: innovation, variance
      real(dp) :: v, f, dv(lanes), df(lanes)
      integer :: m

      f = state%p(1, 1)
      v = y - state%a(1)
      innovation = v
      variance = f
      if (f <= 0.0_dp) return
      df(:) = state%dp(:, 1, 1)
      dv(:) = -state%da(:, 1)
      dv(mean_lane) = dv(mean_lane) - 1.0_dp
      sums%count = sums%count + 1
      sums%square = sums%square + v*v/f
      sums%log_f = sums%log_f + log(f)
      sums%square_slope(:) = sums%square_slope + (v/f)*(dv - (0.5_dp*v/f)*df)
      sums%log_f_slope(:) = sums%log_f_slope + df/f
      if (with_information) then
         do m = 1, lanes
            sums%information(:, m) = sums%information(:, m) + dv*(dv(m)/f)
            sums%f_information(:, m) = sums%f_information(:, m) + df*(df(m)/f**2)
         end do
      end if
      do m = most, 2, -1
         state%y_past(m) = state%y_past(m - 1)
         state%e_past(m) = state%e_past(m - 1)
         state%de_past(:, m) = state%de_past(:, m - 1)
      end do
      state%y_past(1) = y
      state%e_past(1) = v
      state%de_past(:, 1) = dv
      call advance(state, y, v, dv)
   end subroutine observe

   !> The state of the next sample after one that is present.
   pure subroutine advance(state, y, v, dv)
      type(arma_state_type), intent(inout) :: state
      real(dp), intent(in) :: y, v, dv(lanes)
      real(dp) :: kappa(largest), dkappa(lanes, largest), distance, spread(lanes), over, change
      integer :: i, j, l

      over = 1.0_dp/state%p(1, 1)
      do i = 1, state%r
         kappa(i) = state%p(1, i + 1)*over
         state%a(i) = state%phi(i)*y + state%a(i + 1) + kappa(i)*v
         !$omp simd
         do l = 1, lanes
            dkappa(l, i) = (state%dp(l, 1, i + 1) - kappa(i)*state%dp(l, 1, 1))*over
            state%da(l, i) = state%dphi(l, i)*y + state%da(l, i + 1) + dkappa(l, i)*v + kappa(i)*dv(l)
         end do
         state%da(mean_lane, i) = state%da(mean_lane, i) - state%phi(i)
      end do
      distance = 0.0_dp
      spread(:) = 0.0_dp
      do j = 1, state%r
         do i = 1, j
            !$omp simd private(change)
            do l = 1, lanes
               change = state%dp(l, i + 1, j + 1) - kappa(i)*state%dp(l, 1, j + 1) - dkappa(l, i)*state%p(1, j + 1)
               spread(l) = spread(l) + change**2
               state%dp(l, i, j) = change + state%dmm(l, i, j)
            end do
            state%p(i, j) = state%p(i + 1, j + 1) - kappa(i)*state%p(1, j + 1)
            distance = max(distance, abs(state%p(i, j)))
            state%p(i, j) = state%p(i, j) + state%ma(i)*state%ma(j)
         end do
      end do
      if (distance <= steady*sum(state%ma**2) .and. sum(spread) <= steady_derivative**2) then
         state%settled = state%settled + 1
      else
         state%settled = 0
      end if
   end subroutine advance

   !> A missing sample: the state of the next one without a correction.
   pure subroutine skip(state)
      !> The state
      type(arma_state_type), intent(inout) :: state
      real(dp) :: a1, da1(lanes), row(largest + 1), drow(lanes, largest + 1)
      integer :: i, j

      a1 = state%a(1)
      da1(:) = state%da(:, 1)
      row(:) = state%p(1, :)
      drow(:, :) = state%dp(:, 1, :)
      do i = 1, state%r
         state%a(i) = state%phi(i)*a1 + state%a(i + 1)
         state%da(:, i) = state%dphi(:, i)*a1 + state%phi(i)*da1 + state%da(:, i + 1)
      end do
      do j = 1, state%r
         do i = 1, j
            associate (fi => state%phi(i), fj => state%phi(j), dfi => state%dphi(:, i), dfj => state%dphi(:, j))
               state%dp(:, i, j) = state%dp(:, i + 1, j + 1) + row(1)*(dfi*fj + fi*dfj) + fi*fj*drow(:, 1) &
                  + dfi*row(j + 1) + fi*drow(:, j + 1) + dfj*row(i + 1) + fj*drow(:, i + 1) &
                  + state%dmm(:, i, j)
               state%p(i, j) = state%p(i + 1, j + 1) + fi*fj*row(1) + fi*row(j + 1) + fj*row(i + 1) + state%ma(i)*state%ma(j)
            end associate
         end do
      end do
      state%settled = 0
   end subroutine skip

   !> The state from the last values, innovations and derivatives, while P is steady.
   pure subroutine restore_state(state)
      !> P and its derivatives stay
      type(arma_state_type), intent(inout) :: state
      integer :: i, j, back

      state%a(:) = 0.0_dp
      state%da(:, :) = 0.0_dp
      do i = 1, state%r
         do j = i, min(state%r, most)
            back = j - i + 1
            state%a(i) = state%a(i) + state%phi(j)*state%y_past(back) + state%ma(j + 1)*state%e_past(back)
            state%da(:, i) = state%da(:, i) + state%dphi(:, j)*state%y_past(back) + state%dma(:, j + 1)*state%e_past(back) &
               + state%ma(j + 1)*state%de_past(:, back)
            state%da(mean_lane, i) = state%da(mean_lane, i) - state%phi(j)
         end do
      end do
   end subroutine restore_state

end module gyroakf_ar_arma_state
