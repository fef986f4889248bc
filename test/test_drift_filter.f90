! SPDX-License-Identifier: MIT
!> Tests of the drift filter of random walk and AR(1) processes: its estimates, gains and states.
module test_drift_filter
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_drift_steady, only : drift_dc_gain, steady_drift_gain
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, step_filter, run_filter, freeze_filter
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use filter_library, only : adaptive, dense_drift, fill_noise, make_data, not_made, rounding, &
      & some_model
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_drift_filter

contains

   subroutine suite_drift_filter()
      call test("steady_gain_of_a_walk", test_steady_walk)
      call test("steady_gain_of_more", test_steady_more)
      call test("conditional_mean", test_dense)
      call test("steps_run_and_parts", test_parts)
      call test("two_are_as_three", test_pair)
      call test("one_is_as_three", test_single)
      call test("settled_is_as_unsettled", test_settled)
      call test("gap", test_gap)
      call test("diffuse_start", test_start)
      call test("given_start", test_given_start)
      call test("units_and_offset", test_invariance)
      call test("extreme_units", test_extremes)
      call test("dc_gain", test_dc_gain)
      call test("diagnostics", test_diagnostics)
      call test("refused", test_refused)
   end subroutine suite_drift_filter

   !> Local level: K from q/r in closed form
   subroutine test_steady_walk()
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: z(20000), x(20000), expected
      integer :: i

      call fill_noise(3, z)
      model%count = 1
      model%phi = 1
      model%r = 3
      do i = -6, 3
         model%q(1) = 3*10.0_dp**i
         expected = 0.5_dp*(sqrt(model%q(1)/3*(4 + model%q(1)/3)) - model%q(1)/3)
         if (not_made(filter, model, [.true.], filter_options())) return
         call check(error, filter%steady_gain(1), expected, thr=rounding, rel=.true.)
         call run_filter(filter, z, x)
         call check(error, filter%gain(1), expected, thr=merge(rounding, 1.0e-9_dp, i > -6), rel=.true.)
         call check(error, filter%p(1, 1), 3*expected, thr=1.0e-9_dp, rel=.true.)
      end do
   end subroutine test_steady_walk

   !> Riccati solution of two and three processes against the recursion, and processes without driving noise
   subroutine test_steady_more()
      type(component_model_type) :: model
      type(filter_options) :: never
      type(drift_filter_type) :: filter
      real(dp) :: z(30000), x(30000), gain(3), alone(3)
      integer :: processes

      call fill_noise(4, z)
      never%huber = 1.0e6_dp                    ! a gate that does not act: the filter cannot know that its gain is constant
      do processes = 2, 3
         model = some_model(processes)
         if (not_made(filter, model, spread(.true., 1, processes), never)) return
         call run_filter(filter, z, x)
         call check(error, maxval(abs(filter%state%gain - filter%steady_gains)) <= rounding, "not the steady gain")
      end do
      model%q(2) = 0
      call steady_drift_gain(model, gain, failure)
      model%count = 2
      model%phi(2) = model%phi(3)
      model%q(2) = model%q(3)
      call steady_drift_gain(model, alone, failure)
      call check(error, all(abs(gain - [alone(1), 0.0_dp, alone(2)]) <= rounding), "an idle process has a gain")
      model%r = 0
      call steady_drift_gain(model, gain, failure)
      call check(error, .not. allocated(failure) .and. all(abs(gain) <= 0), "r = 0 is not left open")
   end subroutine test_steady_more

   !> Estimate and variance at every sample against the Gaussian vector of the samples up to it
   subroutine test_dense()
      integer, parameter :: n = 50
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: z(n), x, mean(n), variance(n)
      logical :: here(n), slow(3)
      integer :: k, case

      slow = [.true., .true., .false.]
      do case = 1, 5
         model = some_model(min(case, 3))
         if (case == 4) model%phi(2) = 0.3_dp   ! no walk
         if (case == 5) then                    ! a walk alone
            model%count = 1
            model%phi(1) = 1
         end if
         call make_data(10 + case, model, z)
         z = z + 5
         here = [(mod(k, 7) /= 3 .and. k > 2, k=1, n)]
         where (.not. here) z = ieee_value(z(1), ieee_quiet_nan)
         if (not_made(filter, model, slow(:model%count), filter_options())) return
         do k = 1, n
            call step_filter(filter, z(k), x)
            if (count(here(:k)) < 1) cycle
            call dense_drift(model, slow(:model%count), z(:k), here(:k), spread(model%r, 1, k), &
               & mean(:k), variance(:k))
            call check(error, x, mean(k), thr=1.0e-10_dp)
            call check(error, filter%p(1, 1), variance(k), thr=1.0e-10_dp, rel=.true.)
         end do
      end do
   end subroutine test_dense

   !> Bit for bit: sample by sample, at once, in parts, with a mask or with NaN
   subroutine test_parts()
      integer, parameter :: n = 3000
      type(component_model_type) :: model
      type(filter_options) :: options
      type(drift_filter_type) :: fresh, filter
      real(dp) :: z(n), gaps(n), x(n), y(n), v(n), w(n)
      integer(int8) :: valid(n)
      integer :: first, k, last, processes, round

      do processes = 1, 3
         model = some_model(processes)
         call make_data(20, model, z)
         z(500:510) = z(500:510) + 40
         z(700) = 1000
         valid = 1
         valid(1:3) = 0
         valid(100:130) = 0
         valid(1000::17) = 0
         gaps = z
         where (valid == 0) gaps = ieee_value(z(1), ieee_quiet_nan)
         do round = 1, 2
            options = filter_options()
            if (round == 1) options = adaptive()
            if (not_made(fresh, model, spread(.true., 1, processes), options)) return
            filter = fresh
            call run_filter(filter, z, x, valid, v)
            filter = fresh
            do k = 1, n
               call step_filter(filter, gaps(k), y(k))
            end do
            call check(error, all(abs(x - y) <= 0), "steps differ from the run")
            filter = fresh
            last = 0
            do while (last < n)
               first = last + 1
               last = min(n, first + mod(13*first, 101))
               call run_filter(filter, gaps(first:last), y(first:last), normalized_innovation=w(first:last))
            end do
            call check(error, all(abs(x - y) <= 0) .and. all(abs(v - w) <= 0), "parts differ from the run")
            call check(error, filter%steps == n .and. filter%measurements == count(valid /= 0), "the counts are wrong")
            call check(error, abs(filter%x(1) - y(n)) <= 0 .and. filter%p(1, 1) > 0 .and. filter%gain(1) > 0, "no state is shown")
         end do
      end do
   end subroutine test_parts

   !> Runs two filters over a series with everything in it; they must do the same.
   subroutine compare(model, other, slow, options)
      type(component_model_type), intent(in) :: model, other
      logical, intent(in) :: slow(:)
      type(filter_options), intent(in) :: options
      integer, parameter :: n = 4000
      type(drift_filter_type) :: filter, three
      real(dp) :: z(n), x(n), y(n)

      call make_data(30, model, z)
      z(:4) = ieee_value(z(1), ieee_quiet_nan)
      z(500:530) = z(500:530) + 40
      z(700:720:3) = 1000
      z(1500:1900) = ieee_value(z(1), ieee_quiet_nan)
      if (not_made(filter, model, slow(:model%count), options)) return
      if (not_made(three, other, slow(:other%count), options)) return
      call run_filter(filter, z, x)
      call run_filter(three, z, y)
      call check(error, maxval(abs(x - y)) <= rounding*maxval(abs(y)), "the estimates differ")
      call check(error, filter%p(1, 1), three%p(1, 1), thr=rounding, rel=.true.)
      call check(error, filter%gain(1), three%gain(1), thr=rounding, rel=.true.)
      call check(error, filter%gain_sum(1), three%gain_sum(1), thr=rounding, rel=.true.)
      call check(error, filter%r, three%r, thr=rounding, rel=.true.)
      call check(error, filter%innovation_variance, three%innovation_variance, thr=rounding, rel=.true.)
      call check(error, filter%gated == three%gated .and. filter%clamped == three%clamped .and. filter%wait == three%wait &
                 .and. filter%r_at_floor == three%r_at_floor, "the counts differ")
   end subroutine compare

   !> Two processes in registers against the form of any number, in all its ways
   subroutine test_pair()
      type(component_model_type) :: model, other
      type(filter_options) :: options
      character(8), parameter :: forms(3) = [character(8) :: "residual", "exact", "biased"]
      integer :: i, order

      do order = 1, 2
         model = some_model(2)
         if (order == 2) model%phi(:2) = model%phi([2, 1])       ! the walk first
         other = model
         other%count = 3
         other%phi(3) = 0
         other%q(3) = 0
         call compare(model, other, [.true., .true., .false.], filter_options())
         call compare(model, other, [.true., .false., .false.], filter_options())
         call compare(model, other, [.false., .true., .false.], filter_options())
         do i = 1, 3
               options = adaptive()
            options%measurement_form = forms(i)
            options%burn_in = merge(-1, 50, i == 1)
            options%r_upper = 2
            call compare(model, other, [.true., .true., .false.], options)
         end do
         options%initial_variance = 4
         call compare(model, other, [.true., .true., .false.], options)
      end do
   end subroutine test_pair

   !> One process against the form of any number
   subroutine test_single()
      type(component_model_type) :: model, other
      type(filter_options) :: options
      integer :: i

      do i = 1, 2
         model = some_model(1)
         if (i == 2) model%phi(1) = 1
         other = model
         other%count = 3
         other%phi(2:) = 0
         other%q(2:) = 0
         call compare(model, other, [.true., .false., .false.], filter_options())
         call compare(model, other, [.true., .false., .false.], adaptive())
         options = adaptive()
         options%measurement_form = "exact"
         options%burn_in = -1
         call compare(model, other, [.true., .false., .false.], options)
      end do
   end subroutine test_single

   !> The settled gain is used where nothing is adapted, and changes no result
   subroutine test_settled()
      integer, parameter :: n = 20000
      type(component_model_type) :: model
      type(filter_options) :: never
      type(drift_filter_type) :: filter, other
      real(dp) :: z(n), x(n), y(n)
      integer :: processes

      never%huber = 1.0e6_dp
      do processes = 1, 3
         model = some_model(processes)
         call make_data(40, model, z)
         z(15000:15100) = ieee_value(z(1), ieee_quiet_nan)
         if (not_made(filter, model, spread(.true., 1, processes), filter_options())) return
         if (not_made(other, model, spread(.true., 1, processes), never)) return
         call run_filter(filter, z, x)
         call run_filter(other, z, y)
         call check(error, filter%settled .and. .not. other%settled, "the gain has not settled")
         call check(error, maxval(abs(x - y)) <= rounding*maxval(abs(y)), "the settled filter does something else")
         call step_filter(filter, ieee_value(x(1), ieee_quiet_nan), x(1))
         call step_filter(other, ieee_value(x(1), ieee_quiet_nan), y(1))
         call check(error, filter%p(1, 1), other%p(1, 1), thr=rounding, rel=.true.)
      end do
   end subroutine test_settled

   !> In a gap the drift is predicted, its variance grows as the model says, R stays
   subroutine test_gap()
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: z(2000), x(2000), before(2), p(2), r, expected
      integer :: k

      model = some_model(2)
      call make_data(50, model, z)
      if (not_made(filter, model, [.true., .true.], adaptive())) return
      call run_filter(filter, z, x)
      before = filter%state%x(:2)
      p = [filter%state%p(1, 1), filter%state%p(2, 2)]
      expected = filter%state%p(1, 2)
      r = filter%r
      do k = 1, 200
         call step_filter(filter, ieee_value(r, ieee_quiet_nan), x(k))
         p = model%phi(:2)**2*p + model%q(:2)
      end do
      call check(error, x(200), before(1)*0.98_dp**200 + before(2), thr=rounding)
      call check(error, filter%p(1, 1), sum(p) + 2*0.98_dp**200*expected, thr=rounding, rel=.true.)
      call check(error, abs(filter%r - r) <= 0, "R changed in a gap")
      do k = 1, 100000                                           ! without subnormal numbers
         call step_filter(filter, ieee_value(r, ieee_quiet_nan), x(1))
      end do
      call check(error, abs(x(1) - before(2)) <= 0 .and. abs(filter%state%p(1, 2)) <= 0, "the AR(1) part is not gone")
   end subroutine test_gap

   !> A walk begins with its first measurement, which has no innovation
   subroutine test_start()
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: x(4), v(4)
      integer :: processes

      do processes = 1, 3
         model = some_model(processes)
         if (processes == 1) model%phi(1) = 1
         if (not_made(filter, model, spread(.true., 1, processes), adaptive())) return
         call run_filter(filter, [ieee_value(x(1), ieee_quiet_nan), 7.0_dp], x(:2), normalized_innovation=v(:2))
         call check(error, abs(x(1)) <= 0 .and. abs(v(1)) <= 0 .and. abs(v(2)) <= 0, "there is an innovation at the start")
         call check(error, x(2), 7.0_dp, thr=rounding)
         call check(error, filter%wait == 20 .and. filter%measurements == 1, "the adaptation counts the first measurement")
         if (processes < 3) call check(error, filter%p(1, 1), 2.0_dp, thr=rounding)
         call run_filter(filter, [8.0_dp, 9.0_dp], x(:2), normalized_innovation=v(:2))
         call check(error, v(1) > 0 .and. filter%wait == 18, "the second measurement has no innovation")
      end do
      if (not_made(filter, some_model(2), [.true., .true.], filter_options())) return
      call check(error, filter%p(1, 1) >= huge(1.0_dp), "what is not known has a variance")
   end subroutine test_start

   !> With a variance at the start nothing is diffuse
   subroutine test_given_start()
      type(component_model_type) :: model
      type(filter_options) :: options
      type(drift_filter_type) :: filter
      real(dp) :: x

      model = some_model(1)
      model%phi(1) = 1
      options%initial_variance = 5
      if (not_made(filter, model, [.true.], options)) return
      call step_filter(filter, 1.0_dp, x)
      call check(error, x, 5.04_dp/7.04_dp, thr=rounding)
      if (not_made(filter, some_model(2), [.true., .true.], options)) return
      call step_filter(filter, 1.0_dp, x)
      call check(error, x, (5*0.98_dp**2 + 5.041_dp)/(5*0.98_dp**2 + 7.041_dp), thr=rounding)
   end subroutine test_given_start

   !> Another unit changes nothing but the unit; an offset only the walk's level
   subroutine test_invariance()
      integer, parameter :: n = 3000
      type(component_model_type) :: model, scaled
      type(drift_filter_type) :: filter, other
      real(dp) :: z(n), x(n), y(n)
      integer :: processes

      do processes = 2, 3
         model = some_model(processes)
         call make_data(60, model, z)
         z(1000) = 500
         scaled = model
         scaled%q = model%q*2.0_dp**(-40)
         scaled%r = model%r*2.0_dp**(-40)
         if (not_made(filter, model, spread(.true., 1, processes), adaptive())) return
         if (not_made(other, scaled, spread(.true., 1, processes), adaptive())) return
         call run_filter(filter, z, x)
         call run_filter(other, z*2.0_dp**(-20), y)
         call check(error, all(abs(x - y*2.0_dp**20) <= 0), "the unit matters")
         if (not_made(other, model, spread(.true., 1, processes), adaptive())) return
         call run_filter(other, z + 1024, y)
         call check(error, maxval(abs(x + 1024 - y)) <= 1.0e-9_dp, "the offset matters")
      end do
   end subroutine test_invariance

   !> Variances whose products neither overflow nor vanish
   subroutine test_extremes()
      integer, parameter :: n = 500
      type(component_model_type) :: model, scaled
      type(drift_filter_type) :: filter
      real(dp) :: z(n), x(n), y(n), scale
      integer :: i, processes

      do processes = 1, 3
         model = some_model(processes)
         call make_data(70, model, z)
         if (not_made(filter, model, spread(.true., 1, processes), adaptive())) return
         call run_filter(filter, z, x)
         do i = -1, 1, 2
            scale = 2.0_dp**(240*i)
            scaled = model
            scaled%q = model%q*scale**2
            scaled%r = model%r*scale**2
            if (not_made(filter, scaled, spread(.true., 1, processes), adaptive())) return
            call run_filter(filter, z*scale, y)
            call check(error, maxval(abs(y/scale - x)) <= rounding, "an extreme unit spoils the estimates")
         end do
      end do
   end subroutine test_extremes

   !> A constant through the frozen filter
   subroutine test_dc_gain()
      integer, parameter :: n = 20000
      type(component_model_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: one(n), x(n), expected
      logical :: slow(3)
      integer :: case

      one = 1
      do case = 1, 6
         slow = [.true., .true., .false.]
         model = some_model(min(case, 3))
         if (case == 4) model%phi(2) = 0.9_dp                                ! no walk
         if (case == 5) slow = [.true., .false., .false.]                    ! a walk that is no drift
         if (case == 6) then
            model%phi(2) = 0.9_dp
            slow = [.false., .true., .false.]
         end if
         if (not_made(filter, model, slow(:model%count), filter_options())) return
         call run_filter(filter, one, x)
         call freeze_filter(filter, .true.)
         call run_filter(filter, one, x)
         expected = drift_dc_gain(model, slow(:model%count), filter%steady_gains(:model%count))
         call check(error, x(n), expected, thr=1.0e-10_dp)
         if (case == 2 .or. case == 3) call check(error, expected, 1.0_dp, thr=rounding)
         if (case == 5) call check(error, expected, 0.0_dp, thr=rounding)
         if (case == 6) call check(error, expected > 0 .and. expected < 0.9_dp, "an AR(1) process takes everything")
      end do
   end subroutine test_dc_gain

   !> Numbers and warnings of a series of the model
   subroutine test_diagnostics()
      integer, parameter :: n = 10000
      type(component_model_type) :: model
      type(filter_result_type) :: result
      type(drift_filter_type) :: filter
      real(dp) :: z(n), x(n), v(n)
      integer :: processes

      do processes = 1, 3
         model = some_model(processes)
         if (processes == 1) model%phi(1) = 1
         call make_data(130, model, z)
         if (not_made(filter, model, spread(.true., 1, processes), filter_options())) return
         call run_filter(filter, z, x, normalized_innovation=v)
         if (not_made(filter, model, spread(.true., 1, processes), filter_options())) return
         call filter_series(filter, z, x, result, failure)
         if (went_wrong(failure, "the series is not filtered")) return
         call check(error, result%nis_mean, sum(v**2)/(n - 1), thr=rounding, rel=.true.)
         call check(error, result%nis_low, 1 - 1.96_dp*sqrt(2.0_dp/n), thr=1.0e-3_dp)
         call check(error, result%nis_high, 1 + 1.96_dp*sqrt(2.0_dp/n), thr=1.0e-3_dp)
         call check(error, result%nis_low < result%nis_mean .and. result%nis_mean < result%nis_high, "the right model is wrong")
         call check(error, result%dc_gain, 1.0_dp, thr=rounding)
         call check(error, result%gain, filter%steady_gain(1), thr=1.0e-9_dp, rel=.true.)
         call check(error, result%q, sum(model%q(:processes)), thr=rounding, rel=.true.)
         if (unmet(size(result%warnings) == 0 .and. size(result%estimate) == 0, "the right model is warned of")) return
      end do
      if (not_made(filter, model, [.true., .true., .true.], adaptive())) return
      call filter_series(filter, z, x, result, failure)
      call check(error, size(result%estimate) == 1 .and. result%forgetting > 0, &
         "the adaptation is not named")
      ! no measurement in the last third: the last gain stands for its mean
      z(n - n/3 + 1:) = ieee_value(1.0_dp, ieee_quiet_nan)
      if (not_made(filter, model, [.true., .true., .true.], filter_options())) return
      call filter_series(filter, z, x, result, failure)
      call check(error, result%dc_gain, 1.0_dp, thr=rounding)
      call check(error, result%gain, filter%steady_gain(1), thr=1.0e-9_dp, rel=.true.)
   end subroutine test_diagnostics

   !> What a drift filter is not made of
   subroutine test_refused()
      type(component_model_type) :: model
      type(filter_options) :: options(7)
      logical, allocatable :: none(:)
      integer :: i

      call expect([.true.], some_model(2), filter_options(), status%invalid_argument)
      if (.not. allocated(error)) call expect([.false., .false.], some_model(2), filter_options(), status%invalid_argument)
      allocate (none(0))
      model = some_model(0)
      call expect(none, model, filter_options(), status%invalid_argument)
      model = some_model(2)
      model%phi(1) = 1
      call expect([.true., .true.], model, filter_options(), status%invalid_argument)
      model%phi(1) = 1.5_dp
      call expect([.true., .true.], model, filter_options(), status%unstable)
      model%phi(1) = ieee_value(1.0_dp, ieee_quiet_nan)
      call expect([.true., .true.], model, filter_options(), status%non_finite)
      options(1)%estimate_process_variance = .true.
      options(2)%estimate_process_mean = .true.
      options(3)%estimate_measurement_mean = .true.
      options(4)%measurement_form = "paper"
      options(5)%forgetting = 0
      options(6)%huber = -1
      options(7)%r_lower = 0
      do i = 1, 7
         call expect([.true., .true.], some_model(2), options(i), status%invalid_argument)
      end do
   end subroutine test_refused

   !> A filter that must not come about.
   subroutine expect(slow, model, options, code)
      logical, intent(in) :: slow(:)
      type(component_model_type), intent(in) :: model
      type(filter_options), intent(in) :: options
      integer, intent(in) :: code
      type(drift_filter_type) :: filter

      call new_drift_filter(filter, model, slow, options, failure)
      if (unmet(allocated(failure), "bad input was accepted")) return
      call check(error, failure%code == code .and. len_trim(failure%message) > 0, "the error is another one: "//failure%message)
   end subroutine expect

end module test_drift_filter
