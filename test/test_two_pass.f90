! SPDX-License-Identifier: MIT
!> Tests of the smoother whose white noise is found from both sides.
module test_two_pass
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use progress_watch, only : watch_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_kalman, only : filter_options
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_two_pass, only : smooth_adaptive
   use filter_library, only : fill_noise, make_series
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_two_pass

   !> Samples of the series
   integer, parameter :: n = 12000

contains

   subroutine suite_two_pass()
      call test("louder_in_the_middle", test_louder)
      call test("constant_noise", test_constant)
      call test("outliers_do_not_leak", test_outliers)
      call test("missing_samples", test_missing)
      call test("short_record", test_short)
      call test("both_directions_alike", test_reversed)
      call test("random_walk_with_steps", test_steps)
      call test("progress", test_progress)
      call test("refused", test_refused)
   end subroutine suite_two_pass

   !> AR(1) 0.98 of 1e-4, white 4.2e-4.
   pure function usual_model() result(model)
      type(component_model_type) :: model

      model%count = 1
      model%phi(1) = 0.98_dp
      model%q(1) = 1.0e-4_dp*(1 - 0.98_dp**2)
      model%r = 4.2e-4_dp
   end function usual_model

   !> Forgetting, gate, burn-in as the adaptive drift filter has them.
   pure function usual_options(z) result(options)
      real(dp), intent(in) :: z(:)
      type(filter_options) :: options

      options%forgetting = 0.995_dp
      options%huber = 2.5_dp
      options%burn_in = -1
      options%r_scale = 0.5_dp*sum((z(2:) - z(:size(z) - 1))**2)/(size(z) - 1)
   end function usual_options

   !> The usual series, its noise loud by this factor (in variance) in the middle third.
   subroutine make_loud(seed, factor, z, drift, white)
      integer, intent(in) :: seed
      real(dp), intent(in) :: factor
      real(dp), intent(out), contiguous :: z(:), drift(:), white(:)

      call make_series(seed, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z, drift)
      white = 4.2e-4_dp
      white(n/3 + 1:2*n/3) = factor*4.2e-4_dp
      z = drift + (z - drift)*sqrt(white/4.2e-4_dp)
   end subroutine make_loud

   !> Of a record of 200 samples a burn-in of 20 at most: a slow walk whose gain settles after thousands of samples leaves the rest
   !> to the adaptation, which sees that the white noise is a tenth of what the model says.
   subroutine test_short()
      type(component_model_type) :: model
      type(filter_options) :: asked
      real(dp) :: z(200), drift(200), white(200)

      model%count = 1
      model%phi(1) = 1.0_dp
      model%q(1) = 1.0e-8_dp
      model%r = 10.0_dp
      call fill_noise(5, z)
      call smooth_adaptive(model, [.true.], usual_options(z), z, drift, failure, white=white)
      if (went_wrong(failure, "refused")) return
      call check(error, all(white < 3.0_dp), "the white noise is not adapted")
      asked = usual_options(z)
      asked%burn_in = 500
      call smooth_adaptive(model, [.true.], asked, z, drift, failure, white=white)
      call check(error, any(white > 9.0_dp), "a burn-in that was asked for is not kept")
   end subroutine test_short

   !> White noise nine times as strong in the middle third: within 1.03 of the smoother that knows it, the median of five series
   subroutine test_louder()
      real(dp), allocatable :: z(:), drift(:), white(:), x(:), y(:), v(:), r(:)
      real(dp) :: ratio(5), plain(5)
      integer :: seed

      allocate (z(n), drift(n), white(n), x(n), y(n), v(n), r(n))
      do seed = 1, 5
         call make_loud(seed, 9.0_dp, z, drift, white)
         call smooth_drift(usual_model(), [.true.], z, y, failure, white=white)
         call smooth_drift(usual_model(), [.true.], z, x, failure)
         plain(seed) = norm2(x - drift)/norm2(y - drift)
         call smooth_adaptive(usual_model(), [.true.], usual_options(z), z, x, failure, variance=v, white=r)
         if (went_wrong(failure, "the smoother failed")) return
         ratio(seed) = norm2(x - drift)/norm2(y - drift)
         call check(error, sum((x - drift)**2/v)/n, 1.0_dp, thr=0.15_dp)      ! its variance is that of its errors
         call check(error, sum(log(r/white))/n, 0.0_dp, thr=0.15_dp)
      end do
      call check(error, count(ratio <= 1.03_dp) >= 3, "the noise is not found")
      call check(error, all(plain > 1.1_dp), "the noise does not matter in this test")
   end subroutine test_louder

   !> Where the noise does not change little is lost
   subroutine test_constant()
      real(dp), allocatable :: z(:), drift(:), x(:), y(:)

      allocate (z(n), drift(n), x(n), y(n))
      call make_series(7, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z, drift)
      call smooth_drift(usual_model(), [.true.], z, y, failure)
      call smooth_adaptive(usual_model(), [.true.], usual_options(z), z, x, failure)
      call check(error, norm2(x - drift) <= 1.01_dp*norm2(y - drift), "a constant noise is spoilt")
   end subroutine test_constant

   !> One sample in a hundred 4 to 20 standard deviations off, one very far
   subroutine test_outliers()
      real(dp), allocatable :: z(:), drift(:), clean(:), x(:), y(:), r(:), u(:)
      integer :: k

      allocate (z(n), drift(n), x(n), y(n), r(n), u(n))
      call make_series(8, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z, drift)
      clean = z
      call fill_noise(9, u)
      do k = 50, n, 100
         z(k) = z(k) + sign(4 + 16*modulo(abs(u(k)), 1.0_dp), u(k))*sqrt(4.2e-4_dp)
      end do
      call smooth_drift(usual_model(), [.true.], clean, y, failure)
      call smooth_adaptive(usual_model(), [.true.], usual_options(z), z, x, failure, white=r)
      call check(error, norm2(x - drift) <= 1.03_dp*norm2(y - drift), "outliers leak into the drift")
      z(6000) = 1.0e3_dp
      call smooth_adaptive(usual_model(), [.true.], usual_options(clean), z, x, failure, white=r)
      call check(error, norm2(x - drift) <= 1.04_dp*norm2(y - drift), "one sample spoils everything")
      call check(error, r(6000) > 1000*r(5999), "the sample still weighs")
   end subroutine test_outliers

   !> Missing samples as NaN or masked; the drift is there too
   subroutine test_missing()
      real(dp), allocatable :: z(:), drift(:), white(:), gaps(:), x(:), y(:), r(:)
      integer(int8), allocatable :: valid(:)

      allocate (z(n), drift(n), white(n), x(n), y(n), r(n), valid(n))
      call make_loud(10, 9.0_dp, z, drift, white)
      valid = 1
      valid(1:7) = 0
      valid(3000:3200) = 0
      valid(5000::3) = 0
      valid(n) = 0
      gaps = z
      where (valid == 0) gaps = ieee_value(gaps, ieee_quiet_nan)
      call smooth_adaptive(usual_model(), [.true.], usual_options(z), z, x, failure, valid)
      call smooth_adaptive(usual_model(), [.true.], usual_options(z), gaps, y, failure, white=r)
      call check(error, all(abs(x - y) <= 0), "a mask and NaN differ")
      call smooth_drift(usual_model(), [.true.], gaps, y, failure, white=white)
      call check(error, norm2(x - drift) <= 1.03_dp*norm2(y - drift), "missing samples spoil the noise")
      call check(error, all(r > 0) .and. all(abs(x) < 1), "a gap has no noise")
   end subroutine test_missing

   !> The reversed series gives the reversed drift
   subroutine test_reversed()
      type(component_model_type) :: model
      real(dp), allocatable :: z(:), drift(:), white(:), back(:), x(:), y(:), r(:), s(:)

      allocate (z(n), drift(n), white(n), x(n), y(n), r(n), s(n))
      call make_loud(11, 9.0_dp, z, drift, white)
      model = usual_model()
      model%count = 2
      model%phi(2) = 1
      model%q(2) = 1.0e-9_dp
      z(100) = 5
      z(n - 3) = -5
      back = z(n:1:-1)
      call smooth_adaptive(model, [.true., .true.], usual_options(z), z, x, failure, white=r)
      call smooth_adaptive(model, [.true., .true.], usual_options(z), back, y, failure, white=s)
      call check(error, maxval(abs(r - s(n:1:-1))/r) <= 1.0e-10_dp, "the noise depends on the direction of time")
      call check(error, maxval(abs(x - y(n:1:-1))) <= 1.0e-9_dp, "the drift depends on the direction of time")
   end subroutine test_reversed

   !> A walk with steps is not taken for outliers
   subroutine test_steps()
      type(component_model_type) :: model
      real(dp), allocatable :: z(:), drift(:), x(:), y(:), w(:)
      integer :: k

      allocate (z(n), drift(n), x(n), y(n), w(n))
      model%count = 1
      model%phi(1) = 1
      model%q(1) = 1.0e-6_dp
      model%r = 4.2e-4_dp
      call fill_noise(12, z)
      call fill_noise(13, w)
      drift(1) = 0
      do k = 2, n
         drift(k) = drift(k - 1) + 1.0e-3_dp*w(k)
         if (mod(k, 2000) == 1000) drift(k) = drift(k) + sign(0.03_dp, w(k))
      end do
      z = drift + sqrt(4.2e-4_dp)*z
      call smooth_drift(model, [.true.], z, y, failure)
      call smooth_adaptive(model, [.true.], usual_options(z), z, x, failure)
      call check(error, norm2(x - drift) <= 1.03_dp*norm2(y - drift), "steps are gated away")
   end subroutine test_steps

   !> Progress is reported in order, and the call can be cancelled
   subroutine test_progress()
      type(watch_type) :: watch
      real(dp), allocatable :: z(:), x(:)
      integer(int64) :: i

      allocate (z(800000), x(800000))
      call fill_noise(14, z)
      z = 0.02_dp*z
      call smooth_adaptive(usual_model(), [.true.], usual_options(z), z, x, failure, progress=watch)
      if (unmet(.not. allocated(failure) .and. watch%done > 0, "no progress was reported")) return
      do i = 1, 3
         watch = watch_type(last_done=i*250000)
         call smooth_adaptive(usual_model(), [.true.], usual_options(z), z, x, failure, &
                              progress=watch)
         if (unmet(allocated(failure) .and. watch%ordered, "the call is not ended")) return
         call check(error, failure%code, status%cancelled)
      end do
   end subroutine test_progress

   !> What the filter and the smoother refuse
   subroutine test_refused()
      type(filter_options) :: options
      real(dp) :: z(10), x(10), nothing(0), y(0)

      z = 1
      call smooth_adaptive(usual_model(), [.true., .true.], options, z, x, failure)
      if (unmet(allocated(failure), "two words for one process")) return
      call smooth_adaptive(usual_model(), [.true.], options, z, x(:9), failure)
      if (unmet(allocated(failure), "a short output")) return
      call smooth_adaptive(usual_model(), [.true.], options, nothing, y, failure)
      if (unmet(allocated(failure), "no samples at all")) return
      z = ieee_value(z, ieee_quiet_nan)
      call smooth_adaptive(usual_model(), [.true.], options, z, x, failure)
      call check_refused(failure, status%too_few_samples)
   end subroutine test_refused
end module test_two_pass
