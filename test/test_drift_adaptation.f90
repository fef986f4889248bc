! SPDX-License-Identifier: MIT
!> Tests of what the drift filter adapts (gate, variance of the measurement noise, burn-in) and of
!> its steady gains.
module test_drift_adaptation
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp
   use gyroakf_filter_components, only : component_model_type, component_state_type, &
      & most_components, start_components, predict_components, correct_components
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, step_filter, run_filter, &
      & freeze_filter
   use filter_library, only : adaptive, make_data, make_series, not_made, some_model
   use expectations, only : test, error, check, failed => problem, went_wrong
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_drift_steady, only : steady_drift_gain
   implicit none (type, external)
   private
   public :: suite_drift_adaptation, suite_drift_steady

contains

   subroutine suite_drift_adaptation()
      call test("outlier", test_outlier)
      call test("gate_is_consistent", test_consistency)
      call test("level_shift", test_shift)
      call test("frozen", test_frozen)
      call test("bounds", test_bounds)
      call test("wrong_start_of_R", test_wrong_start)
      call test("burn_in", test_burn_in)
   end subroutine suite_drift_adaptation

   subroutine suite_drift_steady()
      call test("recursion", test_recursion)
      call test("no white noise", test_no_white_noise)
   end subroutine suite_drift_steady

   !> One outlier moves the drift by no more than the gate lets it
   subroutine test_outlier()
      type(component_model_type) :: model
      type(drift_filter_type) :: filter, other
      real(dp) :: z(2000), x(2000), y, without, r
      integer :: processes

      do processes = 1, 3
         model = some_model(processes)
         call make_data(80, model, z)
         if (not_made(filter, model, spread(.true., 1, processes), adaptive())) return
         call run_filter(filter, z, x)
         other = filter
         call step_filter(other, ieee_value(y, ieee_quiet_nan), without)
         r = filter%r
         call step_filter(filter, without + 1.0e6_dp, y)
         call check(error, abs(y - without) <= 2.5_dp*sqrt(filter%innovation_variance), "an outlier gets through")
         call check(error, filter%p(1, 1) > 0.99_dp*other%p(1, 1), "an outlier makes the filter sure")
         call check(error, filter%r < 1.1_dp*r .and. filter%r > r, "R follows an outlier")
      end do
   end subroutine test_outlier

   !> On normal data the gate does not bias R
   subroutine test_consistency()
      integer, parameter :: n = 100000
      type(component_model_type) :: model
      type(filter_options) :: options
      type(drift_filter_type) :: filter
      real(dp), allocatable :: z(:), x(:)

      allocate (z(n), x(n))
      model = some_model(2)
      call make_data(90, model, z)
      options = adaptive()
      options%forgetting = 1
      options%huber = 1.5_dp
      if (not_made(filter, model, [.true., .true.], options)) return
      call run_filter(filter, z, x)
      call check(error, filter%r, model%r, thr=0.02_dp, rel=.true.)
      call check(error, real(filter%gated, dp)/n, 0.13361_dp, thr=0.004_dp)     ! 2 Phi(-1.5), five standard deviations
   end subroutine test_consistency

   !> A level that has shifted is followed after ten gated innovations of one sign
   subroutine test_shift()
      integer, parameter :: n = 1000
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: z(n), x(n), drift(n), r
      integer :: processes

      do processes = 1, 3
         model = some_model(processes)
         if (processes == 1) model%phi(1) = 1
         if (processes == 1) model%q(1) = 1.0e-3_dp
         call make_data(100, model, z, drift)
         z(501:) = z(501:) + 200
         if (not_made(filter, model, spread(.true., 1, processes), adaptive())) return
         call run_filter(filter, z(:500), x(:500))
         r = filter%r
         call run_filter(filter, z(501:510), x(501:510))
         call check(error, x(510) - drift(510) < 100, "a shift is believed at once")
         call run_filter(filter, z(511:515), x(511:515))
         call check(error, abs(x(515) - drift(515) - 200) < 6, "a shift is not believed")
         call check(error, filter%r < 2*r, "R follows a shift")
      end do
   end subroutine test_shift

   !> Frozen, R stays and the state goes on
   subroutine test_frozen()
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: z(2000), x(2000), r
      integer :: processes

      do processes = 1, 3
         model = some_model(processes)
         call make_data(110, model, z)
         if (not_made(filter, model, spread(.true., 1, processes), adaptive())) return
         call run_filter(filter, z(:1000), x(:1000))
         r = filter%r
         call freeze_filter(filter, .true.)
         call run_filter(filter, z(1001:1500), x(1001:1500))
         call check(error, abs(filter%r - r) <= 0 .and. filter%steps == 1500 .and. abs(x(1500) - x(1000)) > 0, "not frozen")
         call freeze_filter(filter, .false.)
         call run_filter(filter, z(1501:), x(1501:))
         call check(error, abs(filter%r - r) > 0, "still frozen")
      end do
   end subroutine test_frozen

   !> R within its bounds, which hang on the scale
   subroutine test_bounds()
      type(component_model_type) :: model
      type(filter_options) :: options
      type(drift_filter_type) :: filter
      real(dp) :: z(2000), x(2000)
      integer :: processes

      options = adaptive()
      options%huber = 0
      options%r_scale = 3
      options%r_lower = 0.5_dp
      options%r_upper = 2
      do processes = 1, 3
         model = some_model(processes)
         model%r = 1.0e4_dp
         call make_data(120, some_model(processes), z)
         if (not_made(filter, model, spread(.true., 1, processes), options)) return
         call check(error, filter%r, 6.0_dp)
         call run_filter(filter, 1000*z, x)
         call check(error, filter%r, 6.0_dp)
         call check(error, filter%clamped > 1900 .and. filter%r_at_floor == 0, "the upper bound is not counted")
         call run_filter(filter, 0*z, x)
         call check(error, filter%r, 1.5_dp)
         call check(error, filter%r_at_floor > 0, "the lower bound is not counted")
      end do
   end subroutine test_bounds

   !> R from 10^(-3) to 10^3 times the true one: within 1.05 of the filter that knows it (AR(1) 0.98 of 1e-4, white 4.2e-4)
   subroutine test_wrong_start()
      integer, parameter :: n = 12000
      type(component_model_type) :: model, wrong
      type(filter_options) :: options
      type(drift_filter_type) :: filter
      real(dp), allocatable :: z(:), x(:), drift(:)
      real(dp) :: oracle
      integer :: i, seed

      allocate (z(n), x(n), drift(n))
      model%count = 1
      model%phi(1) = 0.98_dp
      model%q(1) = 1.0e-4_dp*(1 - 0.98_dp**2)
      model%r = 4.2e-4_dp
      do seed = 1, 3
         call make_series(seed, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z, drift)
         if (not_made(filter, model, [.true.], filter_options())) return
         call run_filter(filter, z, x)
         oracle = norm2(x - drift)
         options = adaptive()
         options%forgetting = 0.995_dp
         options%burn_in = -1
         options%r_scale = 0.5_dp*sum((z(2:) - z(:n - 1))**2)/(n - 1)
         do i = -3, 3, 3
            wrong = model
            wrong%r = model%r*10.0_dp**i
            if (not_made(filter, wrong, [.true.], options)) return
            call run_filter(filter, z, x)
            call check(error, norm2(x - drift) <= 1.05_dp*oracle, "a wrong R is not forgotten")
            call check(error, filter%r, model%r, thr=0.3_dp, rel=.true.)
         end do
      end do
   end subroutine test_wrong_start

   !> Automatic burn-in: until the gain is the steady one, 20 at least
   subroutine test_burn_in()
      type(component_model_type) :: model
      type(filter_options) :: never, options
      type(drift_filter_type) :: filter, other
      real(dp) :: expected, x(5000), z(5000)

      never%huber = 1.0e6_dp
      options = adaptive()
      options%burn_in = -1
      model%count = 1
      model%phi(1) = 1
      model%q(1) = 1.0e-3_dp
      model%r = 1
      if (not_made(filter, model, [.true.], options)) return
      expected = log(1.0e-6_dp)/(2*log(1 - filter%steady_gain(1)))           ! K - K_inf falls as (1 - K)^2k
      call check(error, real(filter%wait, dp), expected, thr=0.15_dp, rel=.true.)
      model%q(1) = 10
      if (not_made(filter, model, [.true.], options)) return
      call check(error, filter%wait, 20)
      if (not_made(filter, some_model(3), [.true., .true., .false.], options)) return
      model = some_model(3)
      model%r = filter%options%r_scale                                       ! the R that the bounds suggest
      if (not_made(other, model, [.true., .true., .false.], never)) return
      z = 0
      call run_filter(other, z(:filter%wait - 100), x(:filter%wait - 100))
      call check(error, distance(other) > 1.0e-6_dp, "the burn-in is longer than the gain needs")
      call run_filter(other, z(:100), x(:100))
      call check(error, distance(other) <= 1.0e-6_dp, "the burn-in ends before the gain has settled")
   end subroutine test_burn_in

   !> How far the gains are from the steady ones, in units of the largest
   pure real(dp) function distance(filter)
      type(drift_filter_type), intent(in) :: filter

      distance = maxval(abs(filter%state%gain - filter%steady_gains))/maxval(filter%steady_gains)
   end function distance

   !> An AR(1) process and a random walk.
   pure type(component_model_type) function pair(phi, q1, q2, r) result(model)
      real(dp), intent(in) :: phi, q1, q2, r

      model%count = 2
      model%phi(:2) = [phi, 1.0_dp]
      model%q(:2) = [q1, q2]
      model%r = r
   end function pair

   !> 20000 steps of the filter itself: the slowest mode has 300 samples.
   subroutine test_recursion()
      type(component_model_type) :: model
      type(component_state_type) :: state
      real(dp) :: gain(most_components)
      integer :: k

      model = pair(0.95_dp, 1.2e-6_dp, 2.5e-8_dp, 4.2e-4_dp)
      call steady_drift_gain(model, gain, failed)
      if (went_wrong(failed)) return
      call start_components(model, state)
      do k = 1, 20000
         if (state%started) call predict_components(model, state)
         call correct_components(2, model%r, 0.0_dp, state)
      end do
      call check(error, maxval(abs(gain - state%gain)) <= 1.0e-12_dp*maxval(gain))
   end subroutine test_recursion

   !> The likelihood of the paper's own record may leave white noise of e^-60 beside an AR(1) and a walk: the filter is that
   !> without it.
   subroutine test_no_white_noise()
      type(drift_filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: z(2000), x(2000, 2)
      integer :: i

      call make_series(4, 0.41_dp, 5.2e-4_dp, 0.0_dp, z)
      do i = 1, 2
         call new_drift_filter(filter, pair(0.406_dp, 4.32e-4_dp, 3.84e-9_dp, merge(4.58e-30_dp, 0.0_dp, i == 1)), &
                               [.false., .true.], options, failed)
         if (went_wrong(failed)) return
         call run_filter(filter, z, x(:, i))
      end do
      call check(error, maxval(abs(x(:, 1) - x(:, 2))) <= 1.0e-9_dp*sqrt(5.2e-4_dp))
      options%estimate_measurement_variance = .true.
      options%burn_in = -1
      options%r_scale = 3.0e-4_dp
      call new_drift_filter(filter, pair(0.406_dp, 4.32e-4_dp, 3.84e-9_dp, 4.58e-30_dp), [.false., .true.], options, failed)
      call check(error, .not. allocated(failed))
   end subroutine test_no_white_noise

end module test_drift_adaptation
