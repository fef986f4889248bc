! SPDX-License-Identifier: MIT
!> Tests of the adaptation: the literal recursion, the gate, guards over priors, recovery from a wrong start.
module test_sage_husa
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter, step_filter, run_filter, freeze_filter
   use gyroakf_filter_sage_husa, only : consistency_factor
   use gyroakf_filter_packed, only : is_packed, pack_filter, packed_length, packed_numbers, step_packed
   use filter_library, only : companion_matrix, fill_noise, make_series, paper_phi
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_sage_husa

   !> The four forms of the adaptation of R
   character(8), parameter :: forms(4) = ["exact   ", "residual", "paper   ", "biased  "]
   !> A stationary AR(3)
   real(dp), parameter :: phi3(3) = [0.9_dp, -0.5_dp, 0.2_dp]

contains

   subroutine suite_sage_husa()
      call test("increments_are_the_recursion", test_increments)
      call test("scalar_and_vector_agree", test_scalar_vector)
      call test("step_and_run_agree", test_step_run)
      call test("weights", test_weights)
      call test("consistency_factor", test_consistency)
      call test("guards_over_priors", test_guards)
      call test("vector_guards", test_vector_guards)
      call test("wrong_r_is_forgotten", test_wrong_r)
      call test("pure_ar_has_no_noise", test_pure_ar)
      call test("printed_posterior_holds_back", test_paper_form)
      call test("gate_and_outliers", test_gate)
      call test("level_shift_is_accepted", test_level_shift)
      call test("burn_in", test_burn_in)
      call test("missing_does_not_adapt", test_missing)
      call test("freeze", test_freeze)
      call test("offset_goes_into_r", test_offset)
      call test("packed", test_packed)
      call test("million_steps", test_million)
   end subroutine suite_sage_husa

   !> Options that adapt these letters
   pure type(filter_options) function adapting(letters, form, forgetting) result(options)
      character(*), intent(in) :: letters, form
      real(dp), intent(in) :: forgetting

      options%estimate_process_mean = index(letters, "q") > 0
      options%estimate_measurement_mean = index(letters, "r") > 0
      options%estimate_process_variance = index(letters, "Q") > 0
      options%estimate_measurement_variance = index(letters, "R") > 0
      options%allow_unobservable = .true.
      options%measurement_form = form
      options%forgetting = forgetting
   end function adapting

   !> q, r, Q, R after a step as equations (19)-(22) say it, corrected, in matrices, from the filter before it
   pure function literal(before, form, d, z) result(noise)
      type(filter_type), intent(in) :: before
      character(*), intent(in) :: form
      real(dp), intent(in) :: d, z
      real(dp) :: noise(4)
      real(dp), dimension(before%order, before%order) :: a, predicted, p
      real(dp), dimension(before%order) :: x_predicted, x, k
      real(dp) :: e, s, eta, q_term(before%order, before%order), r_term

      a = companion_matrix(before%phi)
      x_predicted = matmul(a, before%x)
      x_predicted(1) = x_predicted(1) + before%q_mean
      predicted = matmul(a, matmul(before%p, transpose(a)))
      q_term = -predicted
      predicted(1, 1) = predicted(1, 1) + before%q
      e = z - x_predicted(1) - before%r_mean
      s = predicted(1, 1) + before%r
      k = predicted(:, 1)/s
      x = x_predicted + k*e
      p = predicted - s*spread(k, 2, size(k))*spread(k, 1, size(k))
      q_term = q_term + p + e*e*spread(k, 2, size(k))*spread(k, 1, size(k))
      eta = z - x(1) - before%r_mean
      select case (form)
      case ("exact"); r_term = e*e - predicted(1, 1)
      case ("paper"); r_term = e*e - p(1, 1)
      case ("residual"); r_term = eta*eta + p(1, 1)
      case default; r_term = eta*eta + predicted(1, 1)
      end select
      noise(1) = (1 - d)*before%q_mean + d*(x(1) - dot_product(before%phi, before%x))
      noise(2) = (1 - d)*before%r_mean + d*(z - x_predicted(1))
      noise(3) = (1 - d)*before%q + d*q_term(1, 1)
      noise(4) = (1 - d)*before%r + d*r_term
   end function literal

   !> Compares 200 steps of a filter with the literal recursion
   subroutine compare(phi, form)
      real(dp), intent(in) :: phi(:)
      character(*), intent(in) :: form
      real(dp), parameter :: b = 0.98_dp
      type(filter_type) :: filter, before
      type(filter_options) :: options
      real(dp) :: z(200), x, expected(4)
      integer :: k

      call fill_noise(11, z)
      options = adapting("qrQR", form, b)
      options%q_lower = 1.0e-300_dp
      options%r_lower = 1.0e-300_dp
      call new_filter(filter, phi, 0.5_dp, 0.6_dp, options, failure)
      do k = 1, size(z)
         before = filter
         call step_filter(filter, z(k), x)
         if (filter%clamped > before%clamped) cycle
         expected = literal(before, form, (1 - b)/(1 - b**(k + 1)), z(k))
         call check(error, maxval(abs([filter%q_mean, filter%r_mean, filter%q, filter%r] - expected)) <= 1.0e-14_dp, &
                    "the increments are not the recursion: "//form)
      end do
      call check(error, filter%clamped < 100, "nearly every step was held at a bound: nothing was compared")
   end subroutine compare

   subroutine test_increments()
      integer :: i

      do i = 1, size(forms)
         call compare([0.6_dp], trim(forms(i)))
         call compare(phi3, trim(forms(i)))
      end do
   end subroutine test_increments

   !> The path for one coefficient against the general one, for every form, with gate, burn-in and missing samples
   subroutine test_scalar_vector()
      type(filter_type) :: one, two
      type(filter_options) :: options
      real(dp) :: z(3000), x1(3000), x2(3000)
      integer :: i

      call make_series(12, 0.9_dp, 1.0_dp, 2.0_dp, z)
      z([500, 777]) = ieee_value(1.0_dp, ieee_quiet_nan)
      z(1000) = 30
      z(2000:) = z(2000:) + 40
      do i = 1, 2*size(forms)
         options = adapting(merge("qrQR", "QR  ", i > size(forms)), forms(mod(i - 1, 4) + 1), 0.97_dp)
         options%huber = merge(2.5_dp, 0.0_dp, mod(i, 2) == 0)
         options%burn_in = 30
         call new_filter(one, [0.9_dp], 0.19_dp, 2.0_dp, options, failure)
         call new_filter(two, [0.9_dp, 0.0_dp], 0.19_dp, 2.0_dp, options, failure)
         call run_filter(one, z, x1)
         call run_filter(two, z, x2)
         call check(error, maxval(abs(x1 - x2)) <= 1.0e-9_dp, "the estimates differ: "//forms(mod(i - 1, 4) + 1))
         call check(error, one%clamped == two%clamped .and. one%gated == two%gated, "the counts differ")
         call check(error, two%r, one%r, thr=1.0e-9_dp, rel=.true.)
      end do
   end subroutine test_scalar_vector

   !> A filter held as numbers, as FORTRAN 77 has it, gives what the filter gives, at its bounds too.
   subroutine test_packed()
      type(filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: z(3000), state(packed_length(3)), numbers(9), x, estimate
      integer :: i, k

      call make_series(13, 0.9_dp, 1.0_dp, 2.0_dp, z)
      z(500) = ieee_value(1.0_dp, ieee_quiet_nan)
      z(1000) = 300
      do i = 1, size(forms)
         options = adapting("qrQR", forms(i), 0.95_dp)
         options%huber = merge(2.5_dp, 0.0_dp, mod(i, 2) == 0)
         options%q_lower = 0.7_dp
         options%q_upper = 1.5_dp
         options%r_lower = 0.3_dp
         options%r_upper = 3.0_dp
         options%burn_in = 30
         call new_filter(filter, phi3, 0.5_dp, 2.0_dp, options, failure)
         call pack_filter(filter, state)
         if (unmet(is_packed(state) .and. .not. allocated(failure), "it is one")) return
         do k = 1, size(z)
            call step_filter(filter, z(k), x)
            call step_packed(state, z(k), estimate)
            call check(error, estimate, x, thr=1.0e-12_dp, rel=.true.)
         end do
         call packed_numbers(state, numbers)
         call check(error, filter%clamped > 0 .and. maxval(abs(numbers(8:9)/[filter%q, filter%r] - 1)) < 1.0e-12_dp, "Q, R")
      end do
   end subroutine test_packed

   !> d_k = (1 - b)/(1 - b^(k+1)); 1/(k + 1) where b = 1; 1 - b in the end
   subroutine test_weights()
      type(filter_type) :: filter
      real(dp) :: b, x, expected
      integer :: i, k

      do i = 1, 3
         b = merge(1.0_dp, 1 - 0.1_dp**i, i == 3)
         call new_filter(filter, [0.5_dp], 1.0_dp, 1.0_dp, adapting("R", "exact", b), failure)
         do k = 1, 5000
            call step_filter(filter, sin(real(k, dp)), x)
            expected = 1/real(k + 1, dp)
            if (b < 1) expected = (1 - b)/(1 - b**(k + 1))
            call check(error, filter%weight, expected, thr=1.0e-13_dp, rel=.true.)
         end do
      end do
   end subroutine test_weights

   !> E min(u^2, c^2): values of reference, and the integral by the midpoint rule
   subroutine test_consistency()
      real(dp) :: u, total
      integer :: i

      call check(error, consistency_factor(2.0_dp), 0.92054_dp, thr=5.0e-6_dp)
      call check(error, consistency_factor(2.5_dp), 0.97756_dp, thr=5.0e-6_dp)
      call check(error, consistency_factor(3.0_dp), 0.99501_dp, thr=5.0e-6_dp)
      total = 0
      do i = 1, 20000
         u = (i - 0.5_dp)*5.0e-4_dp
         total = total + min(u*u, 6.25_dp)*exp(-0.5_dp*u*u)*5.0e-4_dp
      end do
      call check(error, consistency_factor(2.5_dp), 2*total*0.39894228040143268_dp, thr=1.0e-7_dp)
   end subroutine test_consistency

   !> Priors of Q and R wrong by 1e-3 ... 1e3, three b, every subset and form: never S <= 0, never NaN, never diverging
   subroutine test_guards()
      character(4), parameter :: subsets(6) = ["QR  ", "qrQR", "R   ", "Q   ", "rR  ", "qQ  "]
      type(filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: z(2000), x(2000), b(3)
      integer :: i, iq, ir

      b = [0.95_dp, 0.98_dp, 0.999_dp]
      call make_series(13, paper_phi, 1.0_dp, 0.0_dp, z)
      do i = 1, size(forms)*size(subsets)*size(b)
         options = adapting(subsets(mod(i - 1, 6) + 1), forms(mod((i - 1)/6, 4) + 1), b((i - 1)/24 + 1))
         options%r_scale = 0.59_dp
         do iq = -3, 3, 3
            do ir = -3, 3, 3
               call new_filter(filter, [paper_phi], 0.83_dp*10.0_dp**iq, 10.0_dp**ir, options, failure)
               call run_filter(filter, z, x)
               call check(error, all(ieee_is_finite(x)) .and. filter%innovation_variance > 0 .and. filter%q > 0 &
                          .and. filter%r > 0, "broken: "//subsets(mod(i - 1, 6) + 1)//forms(mod((i - 1)/6, 4) + 1))
               call check(error, sum(x**2) <= 2*sum(z**2), "diverged: " &
                          //subsets(mod(i - 1, 6) + 1)//forms(mod((i - 1)/6, 4) + 1))
            end do
         end do
      end do
   end subroutine test_guards

   !> The same for order 3, where the unguarded recursion breaks in every run
   subroutine test_vector_guards()
      type(filter_type) :: filter
      real(dp) :: z(3000), x(3000)
      integer :: i, iq, ir, k

      call fill_noise(14, z)
      do k = 4, size(z)
         z(k) = z(k) + dot_product(phi3, z(k - 1:k - 3:-1))
      end do
      do i = 1, size(forms)
         do iq = -3, 3, 3
            do ir = -3, 3, 3
               call new_filter(filter, phi3, 10.0_dp**iq, 10.0_dp**ir, adapting("QR", forms(i), 0.97_dp), failure)
               call run_filter(filter, z, x)
               call check(error, all(ieee_is_finite(x)) .and. filter%innovation_variance > 0, "broken: "//forms(i))
               call check(error, minval([(filter%p(k, k), k=1, 3)]) >= 0, "a negative variance: "//forms(i))
               call check(error, sum(x**2) <= 2*sum(z**2), "diverged: "//forms(i))
            end do
         end do
      end do
   end subroutine test_vector_guards

   !> R only, by residuals, Q right, R from 1e-3 to 1e3 of the truth, bounds hanging on the differences: error within
   !> 1.07 of the filter that knows R (drift 0.98 with variance 1e-4, white 4.2e-4, as in a cheap gyroscope)
   subroutine test_wrong_r()
      type(filter_type) :: filter, oracle
      type(filter_options) :: options
      real(dp), parameter :: phi = 0.98_dp, d = 1.0e-4_dp, r = 4.2e-4_dp
      real(dp) :: z(12000), drift(12000), x(12000), best
      integer :: power, seed

      do seed = 1, 3
         call make_series(20 + seed, phi, d, r, z, drift)
         call new_filter(oracle, [phi], d*(1 - phi**2), r, filter_options(), failure)
         call run_filter(oracle, z, x)
         best = norm2(x - drift)
         options = adapting("R", "residual", 0.99_dp)
         options%r_scale = 0.5_dp*sum((z(2:) - z(:11999))**2)/11999
         options%burn_in = -1
         do power = -3, 3, 3
            call new_filter(filter, [phi], d*(1 - phi**2), r*10.0_dp**power, options, failure)
            call run_filter(filter, z, x)
            call check(error, norm2(x - drift) <= 1.07_dp*best, "a wrong R is not forgotten")
         end do
      end do
   end subroutine test_wrong_r

   !> Data that are exactly AR(1) hold no white noise: R falls to its bound, the filter passes the series
   subroutine test_pure_ar()
      type(filter_type) :: filter
      real(dp), allocatable :: z(:), x(:)

      allocate (z(50000), x(50000))
      call make_series(15, paper_phi, 1.0_dp, 0.0_dp, z)
      call new_filter(filter, [paper_phi], 1 - paper_phi**2, 1.0_dp, adapting("R", "residual", 0.98_dp), failure)
      call run_filter(filter, z, x)
      call check(error, filter%gain_sum(1)/filter%gain_measurements > 0.93_dp, "the gain is not near 1")
      call check(error, sum(x**2) > 0.9_dp*sum(z**2), "the series does not pass")
      call check(error, filter%r < 0.04_dp, "R is not near 0")
   end subroutine test_pure_ar

   !> The printed posterior in (22) biases R upwards: on the same data R alone rests near a gain of 0.63
   subroutine test_paper_form()
      type(filter_type) :: filter
      real(dp), allocatable :: z(:), x(:)

      allocate (z(50000), x(50000))
      call make_series(16, paper_phi, 1.0_dp, 0.0_dp, z)
      call new_filter(filter, [paper_phi], 1 - paper_phi**2, 1.0_dp, adapting("R", "paper", 0.995_dp), failure)
      call run_filter(filter, z, x)
      call check(error, filter%gain_sum(1)/filter%gain_measurements, 0.63_dp, thr=0.02_dp)
   end subroutine test_paper_form

   !> One outlier of 50 sigma: with the gate the estimate moves by a twentieth; R does not jump
   subroutine test_gate()
      type(filter_type) :: gated, open_filter
      type(filter_options) :: options
      real(dp) :: z(1001), x(1001), y(1001), moved(2)

      call make_series(17, 0.98_dp, 1.0_dp, 1.0_dp, z)
      options = adapting("R", "residual", 0.98_dp)
      call new_filter(open_filter, [0.98_dp], 0.0396_dp, 1.0_dp, options, failure)
      options%huber = 2.5_dp
      call new_filter(gated, [0.98_dp], 0.0396_dp, 1.0_dp, options, failure)
      z(1001) = z(1000) + 50
      call run_filter(gated, z, x)
      call run_filter(open_filter, z, y)
      moved = abs([x(1001) - x(1000), y(1001) - y(1000)])
      call check(error, moved(1) < 0.15_dp*moved(2), "the gate does not hold the estimate")
      call check(error, open_filter%r > 10*gated%r, "the gate does not hold R")
      call check(error, real(gated%gated, dp)/1001, 0.0124_dp, thr=0.012_dp)
   end subroutine test_gate

   !> A step of 100 sigma that stays: accepted after eleven gated samples, without one the filter would crawl
   subroutine test_level_shift()
      type(filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: z(600), x(600)

      call fill_noise(18, z)
      z(301:) = z(301:) + 100
      options%huber = 2.5_dp
      options%initial_variance = 1.0_dp
      call new_filter(filter, [1.0_dp], 1.0e-4_dp, 1.0_dp, options, failure)
      call run_filter(filter, z, x)
      call check(error, abs(x(311)) < 10.0_dp, "accepted too early")
      call check(error, x(330), 100.0_dp, thr=1.5_dp)
      call check(error, x(600), 100.0_dp, thr=0.5_dp)
   end subroutine test_level_shift

   !> R stays as given for so many measurements; automatic: at least 20
   subroutine test_burn_in()
      type(filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: z(400), x(400)
      integer :: k

      call fill_noise(19, z)
      options = adapting("QR", "exact", 0.98_dp)
      options%burn_in = 50
      call new_filter(filter, [0.5_dp], 1.0_dp, 1.0_dp, options, failure)
      call run_filter(filter, z(:50), x(:50))
      call check(error, filter%r + filter%q, 2.0_dp)
      call run_filter(filter, z(51:51), x(51:51))
      call check(error, abs(filter%r - 1.0_dp) > 0, "no adaptation after the burn-in")
      options%burn_in = -1
      call new_filter(filter, [0.999_dp], 1.0e-4_dp, 1.0_dp, options, failure)
      call check(error, filter%wait > 300 .and. filter%wait < 2000, "a slow filter has a long burn-in")
      call new_filter(filter, [0.1_dp], 1.0_dp, 1.0_dp, options, failure)
      call check(error, filter%wait, 20)
      options%r_scale = 1.0_dp
      call new_filter(filter, [0.9_dp], 0.1_dp, 1.0_dp, options, failure)
      k = filter%wait
      call new_filter(filter, [0.9_dp], 0.1_dp, 50.0_dp, options, failure)
      call check(error, filter%wait, k, "a wrong R prolongs the burn-in")
   end subroutine test_burn_in

   !> A missing sample moves the state, not the noise
   subroutine test_missing()
      type(filter_type) :: filter, before
      real(dp) :: x
      integer :: order

      do order = 1, 3, 2
         call new_filter(filter, phi3(:order), 1.0_dp, 1.0_dp, adapting("qrQR", "exact", 0.98_dp), failure)
         call step_filter(filter, 1.0_dp, x)
         before = filter
         call step_filter(filter, ieee_value(1.0_dp, ieee_quiet_nan), x)
         call check(error, sum(abs([filter%q - before%q, filter%r - before%r, filter%q_mean - before%q_mean, &
                                    filter%r_mean - before%r_mean, filter%weight - before%weight])), 0.0_dp)
         call check(error, x, dot_product(phi3(:order), before%x) + before%q_mean, thr=1.0e-15_dp)
      end do
   end subroutine test_missing

   !> Frozen, the noise stays and the state goes on; afterwards adaptation resumes
   subroutine test_freeze()
      type(filter_type) :: filter
      real(dp) :: z(100), x(100), r, q
      integer :: order

      call fill_noise(23, z)
      do order = 1, 3, 2
         call new_filter(filter, phi3(:order), 1.0_dp, 1.0_dp, adapting("QR", "exact", 0.98_dp), failure)
         call run_filter(filter, z, x)
         r = filter%r
         q = filter%q
         call freeze_filter(filter, .true.)
         call run_filter(filter, 100 + z, x)
         call check(error, abs(filter%r - r) + abs(filter%q - q), 0.0_dp)
         call check(error, x(100) > 10, "the state stands still")
         call freeze_filter(filter, .false.)
         call run_filter(filter, z, x)
         call check(error, abs(filter%r - r) > 0, "adaptation does not resume")
      end do
   end subroutine test_freeze

   !> r adapted alone takes up a constant offset whole
   subroutine test_offset()
      type(filter_type) :: filter
      real(dp) :: z(5000), x(5000)

      call make_series(24, 0.5_dp, 1.0_dp, 1.0_dp, z)
      z = z + 10
      call new_filter(filter, [0.5_dp], 0.75_dp, 1.0_dp, adapting("r", "exact", 0.999_dp), failure)
      call run_filter(filter, z, x)
      call check(error, filter%r_mean, 10.0_dp, thr=0.2_dp)
      call check(error, sum(x(2501:))/2500, 0.0_dp, thr=0.1_dp)
   end subroutine test_offset

   !> Step by step and in one run the object goes the same way, to the last bit: whatever is adapted, with gate, burn-in, missing
   !> samples, outliers, bounds that act, and frozen
   subroutine test_step_run()
      type(filter_options) :: options
      type(filter_type) :: run, step
      real(dp) :: z(600), x(600), y
      character(4), parameter :: letters(5) = ["    ", "R   ", "QR  ", "qrQR", "qR  "]
      integer :: i, k, part

      call make_series(26, 0.5_dp, 1.0_dp, 1.0_dp, z)
      z(77) = ieee_value(1.0_dp, ieee_quiet_nan)
      z(90:500:41) = 20
      do i = 1, 4*size(letters)
         options = adapting(letters(1 + (i - 1)/4), forms(1 + mod(i - 1, 4)), 0.97_dp)
         if (mod(i, 2) == 0) options%huber = 2.0_dp
         options%burn_in = 25
         options%r_upper = 2.0_dp
         options%q_lower = 0.5_dp
         call new_filter(run, [0.5_dp], 0.75_dp, 1.0_dp, options, failure)
         if (went_wrong(failure, "the filter is not made")) return
         step = run
         do part = 0, 400, 200
            call freeze_filter(run, part == 200)
            call freeze_filter(step, part == 200)
            call run_filter(run, z(part + 1:part + 200), x(part + 1:part + 200))
            do k = part + 1, part + 200
               call step_filter(step, z(k), y)
               call check(error, abs(y - x(k)), 0.0_dp)
            end do
            call check(error,.not. any(abs(numbers(run) - numbers(step)) > 0), "the objects differ")
         end do
         call check(error, run%gain_sum(1), step%gain_sum(1), thr=1.0e-12_dp, rel=.true.)
      end do
   end subroutine test_step_run

   !> What changes in a filter of order 1, but for the sum of the gains, which a run adds up before
   pure function numbers(filter)
      type(filter_type), intent(in) :: filter
      real(dp) :: numbers(21)

      numbers = [filter%x(1), filter%p(1, 1), filter%gain(1), filter%q, filter%r, filter%q_mean, filter%r_mean, &
         & filter%innovation, filter%innovation_variance, filter%weight, &
         & real([filter%steps, filter%clamped, filter%gated, filter%measurements, filter%q_at_floor, filter%r_at_floor, &
         & filter%gain_measurements], dp), real([filter%wait, filter%weight_updates, filter%run, merge(1, 0, filter%settled)], dp)]
   end function numbers

   !> A million steps of the paper's form: finite, within the bounds
   subroutine test_million()
      type(filter_type) :: filter
      real(dp), allocatable :: z(:), x(:)

      allocate (z(1000000), x(1000000))
      call make_series(25, paper_phi, 1.0_dp, 0.0_dp, z)
      call new_filter(filter, [paper_phi], 1 - paper_phi**2, 1.0_dp, adapting("QR", "paper", 0.98_dp), failure)
      call run_filter(filter, z, x)
      call check(error, all(ieee_is_finite(x)), "not finite")
      call check(error, sum(x**2)/sum(z**2), 0.043_dp, thr=0.004_dp)
   end subroutine test_million
end module test_sage_husa
