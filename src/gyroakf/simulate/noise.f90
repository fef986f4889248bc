! SPDX-License-Identifier: MIT
!> The noise terms of a gyroscope, each added to a series of rates.
!>
!> A rate is the mean over its sample interval t0 (the angle gained, divided by t0), as a gyroscope
!> gives it and as the Allan variance takes it: with this the random walk has the variance K^2 tau/3
!> at every tau, the first included. Coefficients are in the unit u of the rate and seconds; PSDs
!> are two-sided. Source of the model: IEEE Std 952-1997, annex C.
!>
!> | term | PSD of the rate | Allan variance |
!> |---|---|---|
!> | Q, u s: quantization of the angle | Q^2 (2 pi f)^2 | 3 Q^2/tau^2 |
!> | N, u sqrt(s): angle random walk | N^2 | N^2/tau |
!> | B, u: bias instability, 1/f | B^2/(2 pi f) | (2 ln 2/pi) B^2 |
!> | K, u/sqrt(s): rate random walk | K^2/(2 pi f)^2 | K^2 tau/3 |
!> | R, u/s: ramp | | R^2 tau^2/2 |
!>
!> A new term: a procedure here, its coefficient in [[simulate_options]], one call with a stream of
!> its own in [[simulate_record]], its expected Allan variance in test/test_simulate.f90.
module gyroakf_simulate_noise
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_fft_convolution, only : convolve
   use gyroakf_random, only : random_type, next_normal, next_uniform, next_laplace, next_t5
   implicit none (type, external)
   private
   public :: add_quantization_noise, add_white, add_flicker, add_random_walk, &
      add_autoregressive

   !> Variates less one between two calls of the progress: a power of two less one
   integer(int64), parameter :: report_mask = 1048575_int64
   character(*), parameter :: stage = "simulating"

contains

   !> Adds the quantization noise of the angle: differences of independent errors of the angle.
   !>
   !> $$ x_i \mathrel{+}= Q (g_{i+1} - g_i)/t_0 $$
   subroutine add_quantization_noise(x, q, t0, random, error, progress)
      !> Rates: [n]
      real(dp), intent(inout), contiguous :: x(:)
      !> Standard deviation of the angle's error, u s, >= 0 (a step of the angle / sqrt(12))
      real(dp), intent(in) :: q
      !> Sample interval, s, > 0
      real(dp), intent(in) :: t0
      !> Where the n + 1 variates come from
      type(random_type), intent(inout) :: random
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: before, after
      integer(int64) :: i

      call next_normal(random, before)
      do i = 1, size(x, kind=int64)
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, &
            size(x, kind=int64), error, progress)
         if (allocated(error)) return
         call next_normal(random, after)
         x(i) = x(i) + q*(after - before)/t0
         before = after
      end do
   end subroutine add_quantization_noise

   !> Adds white noise, the derivative of the angle's random walk.
   !>
   !> $$ x_i \mathrel{+}= N g_i/\sqrt{t_0} $$
   subroutine add_white(x, n, t0, tails, random, error, progress)
      !> Rates: [samples]
      real(dp), intent(inout), contiguous :: x(:)
      !> Angle random walk, u sqrt(s), >= 0
      real(dp), intent(in) :: n
      !> Sample interval, s, > 0
      real(dp), intent(in) :: t0
      !> Distribution of the g, of variance 1: laplace, t5 ([[gyroakf_random:next_t5]]), mixture (of
      !> two normal distributions with the ratio 8 of their standard deviations in equal shares),
      !> else normal
      character(*), intent(in) :: tails
      !> Where the variates come from
      type(random_type), intent(inout) :: random
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), parameter :: narrow = 1/sqrt(32.5_dp), wide = 8*narrow
      real(dp) :: g, u, scale
      integer(int64) :: i

      scale = n/sqrt(t0)
      do i = 1, size(x, kind=int64)
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, &
            size(x, kind=int64), error, progress)
         if (allocated(error)) return
         select case (tails)
         case ("laplace"); call next_laplace(random, g)
         case ("t5"); call next_t5(random, g)
         case ("mixture"); call next_normal(random, g)
            call next_uniform(random, u)
            g = g*merge(wide, narrow, u < 0.5_dp)
         case default; call next_normal(random, g)
         end select
         x(i) = x(i) + scale*g
      end do
   end subroutine add_white

   !> Adds 1/f noise: white noise through the half integrator of the record's whole length.
   !>
   !> $$ x_i \mathrel{+}= B \sum_{k=0}^{i} h_k g_{i-k}, \quad
   !>    h_0 = 1,\ h_k = h_{k-1} (k - 1/2)/k; $$
   !> the filter's squared gain is 1/(2 sin(pi f t0)), hence the PSD B^2/(2 pi f) below the sampling
   !> frequency and a floor of the Allan deviation at 0.664 B. Being sampled it has more at the
   !> shortest times: the Allan variance is 1.44, 1.15, 1.05, 1.015 times the floor's at 1, 2, 4, 8
   !> samples. It begins with the record: its variance grows as ln i. Source: N. Kasdin, Discrete
   !> simulation of colored noise, Proc. IEEE 83 (1995) 802.
   subroutine add_flicker(x, b, random, error, progress)
      !> Rates: [n], n >= 1
      real(dp), intent(inout), contiguous :: x(:)
      !> Bias instability, u, >= 0
      real(dp), intent(in) :: b
      !> Where the n variates come from
      type(random_type), intent(inout) :: random
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: h(:), g(:), noise(:)
      integer(int64) :: i, n
      integer :: stat

      n = size(x, kind=int64)
      allocate (h(n), stat=stat)
      if (stat == 0) allocate (g(n), stat=stat)
      if (stat == 0) allocate (noise(n), stat=stat)
      call check_memory(stat, "the flicker noise", error)
      if (allocated(error)) return
      do i = 1, n
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, n, error, progress)
         if (allocated(error)) return
         call next_normal(random, g(i))
      end do
      h(1) = 1
      do i = 1, n - 1
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, n, error, progress)
         if (allocated(error)) return
         h(i + 1) = h(i)*((i - 0.5_dp)/i)
      end do
      call convolve(h, g, noise, error, progress)
      if (allocated(error)) return
      do i = 1, n
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, n, error, progress)
         if (allocated(error)) return
         x(i) = x(i) + b*noise(i)
      end do
   end subroutine add_flicker

   !> Adds the random walk of the rate, as its means over the sample intervals.
   !>
   !> $$ x_i \mathrel{+}= w_i + K\sqrt{t_0} \left(\frac{g_i}{2} + \frac{g'_i}{2\sqrt 3}\right),
   !>    \quad w_{i+1} = w_i + K\sqrt{t_0}\, g_i, \quad w_1 = 0 $$
   !> (mean of a Brownian motion over an interval, given its ends: increments g, bridges g').
   subroutine add_random_walk(x, k, t0, random, error, progress)
      !> Rates: [n]
      real(dp), intent(inout), contiguous :: x(:)
      !> Rate random walk, u/sqrt(s), >= 0
      real(dp), intent(in) :: k
      !> Sample interval, s, > 0
      real(dp), intent(in) :: t0
      !> Where the 2 n variates come from
      type(random_type), intent(inout) :: random
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), parameter :: bridge = 0.28867513459481288225_dp        ! 1/(2 sqrt(3))
      real(dp) :: w, step, g1, g2
      integer(int64) :: i

      step = k*sqrt(t0)
      w = 0
      do i = 1, size(x, kind=int64)
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, &
            size(x, kind=int64), error, progress)
         if (allocated(error)) return
         call next_normal(random, g1)
         call next_normal(random, g2)
         x(i) = x(i) + (w + step*(0.5_dp*g1 + bridge*g2))
         w = w + step*g1
      end do
   end subroutine add_random_walk

   !> Adds an autoregressive process that is stationary from its first sample.
   !>
   !> $$ z_i = \sum_{j=1}^{p} \phi_j z_{i-j} + a_i $$
   !> The first p values are drawn from the stationary distribution, value k given the k - 1 before
   !> it: the predictors of the orders 0 .. p-1 and their error variances follow from the model by
   !> Levinson's recursion run downwards. Source: P. Brockwell, R. Davis, Time Series: Theory and
   !> Methods (1991), sec. 5.2 and 8.2.
   subroutine add_autoregressive(x, phi, variance, random, error, progress)
      !> Series: [n]
      real(dp), intent(inout), contiguous :: x(:)
      !> Coefficients: [p], p >= 1, of a stationary model
      real(dp), intent(in) :: phi(:)
      !> Stationary variance of the process, u^2, >= 0
      real(dp), intent(in) :: variance
      !> Where the n variates come from
      type(random_type), intent(inout) :: random
      !> unstable: the model is not stationary; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: predictor(:, :), deviation(:), past(:)
      real(dp) :: g, z
      integer(int64) :: i
      integer :: p, order

      p = size(phi)
      call step_down(phi, variance, predictor, deviation, error)
      if (allocated(error)) return
      allocate (past(p), source=0.0_dp)                ! past(j) is the value j samples ago
      do i = 1, size(x, kind=int64)
         if (iand(i - 1, report_mask) == 0) call report_progress(stage, i - 1, &
            size(x, kind=int64), error, progress)
         if (allocated(error)) return
         order = int(min(i - 1, int(p, int64)))
         call next_normal(random, g)
         z = dot_product(predictor(:order, order), past(:order)) + deviation(order)*g
         x(i) = x(i) + z
         past(2:) = past(:p - 1)
         past(1) = z
      end do
   end subroutine add_autoregressive

   !> The best predictors of the orders 0 .. p of an AR(p) process; deviations of their errors.
   !>
   !> $$ \phi^{(m-1)}_j = \frac{\phi^{(m)}_j + \kappa_m \phi^{(m)}_{m-j}}{1 - \kappa_m^2},
   !>    \quad \kappa_m = \phi^{(m)}_m, \quad \sigma_m^2 = \sigma_{m-1}^2 (1 - \kappa_m^2),
   !>    \quad \sigma_0^2 = \mathrm{variance} $$
   !> The process is stationary exactly if every |kappa| < 1.
   pure subroutine step_down(phi, variance, predictor, deviation, error)
      real(dp), intent(in) :: phi(:), variance
      real(dp), allocatable, intent(out) :: predictor(:, :), deviation(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: m, j, p

      p = size(phi)
      allocate (predictor(p, 0:p), deviation(0:p), source=0.0_dp)
      predictor(:, p) = phi(:)
      do m = p, 1, -1
         if (abs(predictor(m, m)) >= 1) then
            call fatal_error(error, status%unstable, &
               "the AR model of the simulation is not stationary")
            return
         end if
         do j = 1, m - 1
            predictor(j, m - 1) = (predictor(j, m) + predictor(m, m)*predictor(m - j, m))/ &
               (1 - predictor(m, m)**2)
         end do
      end do
      deviation(0) = sqrt(variance)
      do m = 1, p
         deviation(m) = deviation(m - 1)*sqrt(1 - predictor(m, m)**2)
      end do
   end subroutine step_down

end module gyroakf_simulate_noise
