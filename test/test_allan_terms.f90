! SPDX-License-Identifier: MIT
!> Tests of the choice of noise terms: what white noise must not show, what must be kept, Markov process, sinusoid, first
!> points left out, limits, record length.
module test_allan_terms
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : model_shape, model_variance, noise_model_type
   use gyroakf_allan_record_length, only : never, record_to_see
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use allan_series, only : normal_series
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_terms

contains

   !> The tests of this suite.
   subroutine collect_allan_terms(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("white_noise_alone", test_white), &
         & new_unittest("true_terms_kept", test_kept), &
         & new_unittest("markov_curve", test_markov_curve), &
         & new_unittest("sinusoid_curve", test_sinusoid_curve), &
         & new_unittest("markov_record", test_markov_record), &
         & new_unittest("markov_alone", test_markov_alone), &
         & new_unittest("sinusoid_record", test_sinusoid_record), &
         & new_unittest("filtered_record", test_filtered), &
         & new_unittest("limit_is_a_quantile", test_limit), &
         & new_unittest("limit_above_value", test_limit_above_value), &
         & new_unittest("record_length", test_record_length), &
         & new_unittest("terms_that_miss", test_terms_that_miss), &
         & new_unittest("oscillating_steps", test_oscillating), &
         & new_unittest("chance_low_at_the_end", test_chance_low), &
         & new_unittest("limits_of_a_misfit", test_misfit_limits), &
         & new_unittest("letters", test_letters)]
   end subroutine collect_allan_terms

   !> Curve and fit of a record.
   subroutine fit_record(rate, options, curve, noise, failure)
      real(dp), intent(in) :: rate(:)
      type(noise_options), intent(in) :: options
      type(allan_curve_type), intent(out) :: curve
      type(noise_type), intent(out) :: noise
      type(gyro_error), allocatable, intent(out) :: failure

      call compute_allan(rate, 1.0_dp, allan_options(), curve, failure)
      if (.not. allocated(failure)) call fit_noise(curve, options, noise, failure)
   end subroutine fit_record

   !> A curve that is the expectation itself, octaves.
   subroutine exact_curve(model, samples, curve)
      type(noise_model_type), intent(in) :: model
      integer(int64), intent(in) :: samples
      type(allan_curve_type), intent(out) :: curve
      integer :: i, octaves

      octaves = int(log(real(samples, dp)/2)/log(2.0_dp))
      curve%samples = samples
      curve%m = [(2_int64**i, i=0, octaves)]
      curve%terms = samples - 2*curve%m + 1
      curve%tau = real(curve%m, dp)
      curve%deviation = [(sqrt(model_variance(model, curve%tau(i))), i=1, size(curve%m))]
      curve%edf = samples/curve%tau
      curve%lower = curve%deviation
      curve%upper = curve%deviation
   end subroutine exact_curve

   subroutine test_white(error)
      type(error_type), allocatable, intent(out) :: error

      ! 2 % of white records show another term: of 60 seldom more than 4 (P < 0.01)
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: i, spurious

      spurious = 0
      do i = 1, 60
         call fit_record(normal_series(3000_int64, int(40 + i, int64)), noise_options(), curve, noise, failure)
         call check(error, .not. allocated(failure) .and. noise%coefficient(2)%detected, "N")
         if (allocated(error)) return
         if (any(noise%coefficient([1, 3, 4, 5])%detected)) spurious = spurious + 1
      end do
      call check(error, spurious <= 4, "spurious terms")
   end subroutine test_white

   subroutine test_kept(error)
      type(error_type), allocatable, intent(out) :: error

      ! N, B and K all far above their errors; neither Q nor R
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      type(simulate_options) :: options
      type(record_type) :: record

      options%samples = 65536
      options%rate_hz = 1
      options%seed = 5
      options%coefficient = [0.0_dp, 1.0_dp, 0.1_dp, 0.01_dp, 0.0_dp]
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) call fit_record(record%value(:, 1), noise_options(), curve, noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      call check(error, all(noise%coefficient%detected .eqv. [.false., .true., .true., .true., .false.]), "the terms")
      if (allocated(error)) return
      call check(error, all(abs(noise%coefficient(2:4)%value - [1.0_dp, 0.1_dp, 0.01_dp]) < 3*noise%coefficient(2:4)%std_error), &
         & "the values")
      if (allocated(error)) return
      call check(error, noise%left_out == 0 .and. .not. noise%markov%fitted .and. .not. noise%sinusoid%fitted, "nothing else")
   end subroutine test_kept

   subroutine test_markov_curve(error)
      type(error_type), allocatable, intent(out) :: error

      ! without noise the parameters come back: q_c = sqrt(2 s^2/T)
      type(noise_model_type) :: model
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure

      model%squares(2) = 1
      model%squares(6) = 0.04_dp
      model%correlation_time = 150
      call exact_curve(model, 200000_int64, curve)
      call fit_noise(curve, noise_options(terms="NM", method="linear"), noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      call check(error, noise%correlation_time, 150.0_dp, thr=1.0e-3_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, noise%markov%value, sqrt(0.08_dp/150), thr=1.0e-3_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, noise%coefficient(2)%value, 1.0_dp, thr=1.0e-4_dp)
   end subroutine test_markov_curve

   subroutine test_sinusoid_curve(error)
      type(error_type), allocatable, intent(out) :: error

      type(noise_model_type) :: model
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure

      model%squares(2) = 1
      model%squares(7) = 0.25_dp
      model%frequency = 0.0123_dp
      call exact_curve(model, 200000_int64, curve)
      call fit_noise(curve, noise_options(terms="NS", method="linear"), noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      call check(error, noise%frequency, 0.0123_dp, thr=1.0e-4_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, noise%sinusoid%value, 0.5_dp, thr=1.0e-4_dp)
      if (allocated(error)) return
      call check(error, noise%coefficient(2)%value, 1.0_dp, thr=1.0e-4_dp)
   end subroutine test_sinusoid_curve

   subroutine test_markov_record(error)
      type(error_type), allocatable, intent(out) :: error

      ! found without being asked for
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      real(dp) :: rate(100000), drive(100000), phi
      integer :: i

      phi = exp(-1/100.0_dp)
      drive = 0.3_dp*sqrt(1 - phi**2)*normal_series(100000_int64, 21_int64)
      do i = 2, size(drive)
         drive(i) = phi*drive(i - 1) + drive(i)
      end do
      rate = drive + normal_series(100000_int64, 22_int64)
      call fit_record(rate, noise_options(), curve, noise, failure)
      call check(error, .not. allocated(failure) .and. noise%markov%detected .and. noise%left_out == 0, "the Markov process")
      if (allocated(error)) return
      call check(error, abs(noise%correlation_time - 100) < 3*noise%correlation_time_error, "its time")
      if (allocated(error)) return
      call check(error, abs(noise%markov%value - 0.3_dp*sqrt(0.02_dp)) < 3*noise%markov%std_error, "its strength")
      if (allocated(error)) return
      call check(error, noise%misfit <= 0 .and. .not. noise%coefficient(4)%detected, "and no random walk")
   end subroutine test_markov_record

   subroutine test_markov_alone(error)
      type(error_type), allocatable, intent(out) :: error

      ! without other terms the start is scanned too: a time of 200 is found from 0.5 on, and the curve is described
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      real(dp) :: rate(100000), phi
      integer :: i

      phi = exp(-1/200.0_dp)
      rate = sqrt(1 - phi**2)*normal_series(100000_int64, 23_int64)
      do i = 2, size(rate)
         rate(i) = phi*rate(i - 1) + rate(i)
      end do
      call fit_record(rate, noise_options(terms="M"), curve, noise, failure)
      call check(error, .not. allocated(failure) .and. noise%markov%detected, "the Markov process")
      if (allocated(error)) return
      call check(error, abs(noise%correlation_time - 200) < 3*noise%correlation_time_error, "its time")
      if (allocated(error)) return
      call check(error, noise%misfit <= 0 .and. noise%chi2_probability > 1e-3_dp, "the description")
   end subroutine test_markov_alone

   subroutine test_sinusoid_record(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      real(dp) :: rate(50000)
      integer :: i

      rate = normal_series(50000_int64, 31_int64) + [(0.4_dp*sin(6.283185307179586_dp*0.021_dp*i), i=1, 50000)]
      call fit_record(rate, noise_options(), curve, noise, failure)
      call check(error, .not. allocated(failure) .and. noise%sinusoid%detected, "the sinusoid")
      if (allocated(error)) return
      call check(error, abs(noise%frequency - 0.021_dp) < 3*noise%frequency_error, "its frequency")
      if (allocated(error)) return
      call check(error, abs(noise%sinusoid%value - 0.4_dp) < 3*noise%sinusoid%std_error, "its amplitude")
   end subroutine test_sinusoid_record

   subroutine test_filtered(error)
      type(error_type), allocatable, intent(out) :: error

      ! an AR(1) with phi = 0.5 is white of N = 1/(1 - phi) = 2 to long times; the first points are bent down
      type(allan_curve_type) :: before, curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      real(dp) :: rate(50000)
      integer :: i

      rate = normal_series(50000_int64, 8_int64)
      do i = 2, size(rate)
         rate(i) = 0.5_dp*rate(i - 1) + rate(i)
      end do
      call compute_allan(rate, 1.0_dp, allan_options(), before, failure)
      call check(error, .not. allocated(failure), "the curve")
      if (allocated(error)) return
      curve = before
      call fit_noise(curve, noise_options(), noise, failure)
      call check(error, .not. allocated(failure) .and. noise%left_out > 0 .and. .not. noise%markov%fitted, "points left out")
      if (allocated(error)) return
      call check(error, all(curve%edf(:noise%left_out) <= before%edf(:noise%left_out)), "no narrower limits where left out")
      if (allocated(error)) return
      call check(error, noise%tau_first, real(2**noise%left_out, dp), thr=1.0e-12_dp)
      if (allocated(error)) return
      call check(error, abs(noise%coefficient(2)%value - 2) < 3*noise%coefficient(2)%std_error, "N of long times")
      if (allocated(error)) return
      call check(error, .not. any(noise%coefficient([1, 3, 4, 5])%detected), "no other term")
   end subroutine test_filtered

   subroutine test_limit(error)
      type(error_type), allocatable, intent(out) :: error

      ! a single averaging time, one term: the limit is the variance over the 5 % quantile of chi-square(nu)/nu, of which the
      ! cube-root transform knows the quantile to 1 % at nu = 10
      type(noise_model_type) :: model
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      real(dp), parameter :: quantile_10 = 3.9402991361190605_dp, nu = 10

      model%squares(2) = 1
      call exact_curve(model, 1000_int64, curve)
      options%terms = "N"
      options%tau_min = 128
      options%tau_max = 128
      call fit_noise(curve, options, noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      ! 1000 samples at m = 128 have nu = 9.8 (Greenhall & Riley): compared through the ratio for nu of the curve
      call check(error, abs(curve%edf(8) - 9.8_dp) < 0.4_dp, "degrees of freedom")
      if (allocated(error)) return
      call check(error, (noise%coefficient(2)%upper_limit)**2, nu/quantile_10, thr=0.03_dp, rel=.true.)
   end subroutine test_limit

   subroutine test_limit_above_value(error)
      type(error_type), allocatable, intent(out) :: error

      ! a disturbed ring laser, of which the test that sets the limit holds a smaller Q for likely than the fit
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: i

      curve%samples = 184718
      curve%m = [(2_int64**i, i=10, 16)]
      curve%terms = curve%samples - 2*curve%m + 1
      curve%tau = real(curve%m, dp)
      curve%deviation = [1.4596_dp, 0.888301_dp, 0.545549_dp, 0.294351_dp, 0.163158_dp, 0.0688543_dp, 0.0341439_dp]
      curve%edf = curve%samples/curve%tau
      curve%lower = curve%deviation
      curve%upper = curve%deviation
      call fit_noise(curve, noise_options(terms="QN"), noise, failure)
      call check(error, .not. allocated(failure) .and. noise%coefficient(1)%detected, "Q")
      if (allocated(error)) return
      call check(error, noise%coefficient(1)%upper_limit >= noise%coefficient(1)%value, "the limit")
   end subroutine test_limit_above_value

   subroutine test_record_length(error)
      type(error_type), allocatable, intent(out) :: error

      ! Q^2 over white noise has the standard error sqrt(10/n) N^2/10 ... of the Cramer-Rao bound, 1/sqrt(n): seen at 3.88 of them
      type(noise_model_type) :: model
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      real(dp) :: times, longer

      model%squares(2) = 1
      call exact_curve(model, 10000_int64, curve)
      call fit_noise(curve, noise_options(method="linear"), noise, failure)
      call check(error, .not. allocated(failure), "the fit failed")
      if (allocated(error)) return
      call record_to_see(noise, 10000_int64, 1, 0.003_dp, times)
      call check(error, times, (3.881_dp/0.003_dp)**2*1.0e-4_dp, thr=0.05_dp, rel=.true.)
      if (allocated(error)) return
      noise%share = 0.5_dp                                   ! half the terms lost: twice as long
      call record_to_see(noise, 10000_int64, 1, 0.003_dp, longer)
      call check(error, longer, 2*times, thr=0.05_dp, rel=.true.)
      if (allocated(error)) return
      noise%share = 1
      call record_to_see(noise, 10000_int64, 4, 1.0e-9_dp, times)
      call record_to_see(noise, 10000_int64, 4, 1.0e-10_dp, longer)
      call check(error, times > 1 .and. longer > times .and. longer < never, "a smaller walk needs a longer record")
      if (allocated(error)) return
      call record_to_see(noise, 10000_int64, 1, 1.0e-6_dp, times)
      call check(error, times, never)
      if (allocated(error)) return
      noise%misfit = 0.3_dp                                 ! points that miss the mixture do so in a longer record too
      call record_to_see(noise, 10000_int64, 1, 0.1_dp, times)
      call check(error, times, never)
      if (allocated(error)) return
      noise%misfit = 0
      noise%tau_first = 8                                   ! only one averaging time: nu is about 2 in 20 samples
      call record_to_see(noise, 20_int64, 2, 1.0_dp, times)
      call check(error, times > 2 .and. times < never, "one averaging time")
   end subroutine test_record_length

   subroutine test_terms_that_miss(error)
      type(error_type), allocatable, intent(out) :: error

      ! each power of tau by each other term alone: a result or an error, no trap, and never a better one than the truth
      character(1), parameter :: letter(7) = ["Q", "N", "B", "K", "R", "M", "S"]
      type(noise_model_type) :: model
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: truth, term

      do truth = 1, 5
         model%squares = 0
         model%squares(truth) = 1
         do term = 1, 7
            call exact_curve(model, 20000_int64, curve)
            call fit_noise(curve, noise_options(terms=letter(term)), noise, failure)
            if (term == truth) then
               call check(error, .not. allocated(failure) .and. noise%coefficient(term)%detected, "the truth: "//letter(term))
            else if (allocated(failure)) then
               call check(error, failure%code, status%not_converged)
            else if (term <= 5) then
               call check(error, noise%misfit > 0, letter(term)//" for "//letter(truth))
            end if
            if (allocated(error)) return
         end do
         call exact_curve(model, 20000_int64, curve)
         call fit_noise(curve, noise_options(terms="KM"), noise, failure)
      end do
   end subroutine test_terms_that_miss

   subroutine test_oscillating(error)
      type(error_type), allocatable, intent(out) :: error

      ! records with large residuals at long times, where full steps of Gauss and Newton swing about the minimum for ever
      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer, parameter :: seed(4) = [65, 311, 618, 630]
      integer :: i

      options%samples = 20000
      options%rate_hz = 10
      options%unit = "deg/h"
      options%coefficient = [0.0_dp, 18.0_dp, 6.0_dp, 0.3_dp, 0.0_dp]
      options%missing = 0.1_dp
      do i = 1, size(seed)
         options%seed = seed(i)
         call simulate_record(options, record, failure)
         if (.not. allocated(failure)) call compute_allan(record%value(:, 1), 0.1_dp, allan_options(), curve, failure, &
            & record%present(:, 1))
         if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
         call check(error, .not. allocated(failure), "the fit converges")
         if (allocated(error)) return
         call check(error, abs(noise%coefficient(2)%value - 18) < 4*noise%coefficient(2)%std_error, "N")
         if (allocated(error)) return
      end do
   end subroutine test_oscillating

   subroutine test_chance_low(error)
      type(error_type), allocatable, intent(out) :: error

      ! the last variance, of one degree of freedom, is by chance 1e-4 of what is expected: it must not forbid the random walk
      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      character(4), parameter :: terms(2) = ["NK  ", "auto"]
      real(dp), parameter :: truth(2) = [1.0_dp, 0.01_dp]
      integer :: i

      options%samples = 32768
      options%rate_hz = 1
      options%seed = 1272
      options%coefficient = [0.0_dp, truth(1), 0.0_dp, truth(2), 0.0_dp]
      do i = 1, size(terms)
         call simulate_record(options, record, failure)
         if (.not. allocated(failure)) call fit_record(record%value(:, 1), noise_options(terms=terms(i)), curve, noise, failure)
         call check(error, .not. allocated(failure), "the fit failed")
         if (allocated(error)) return
         call check(error, curve%deviation(size(curve%m)) < 0.02_dp*noise%model(size(curve%m)), "the record is the unlucky one")
         if (allocated(error)) return
         call check(error, noise%acceptable .and. .not. noise%markov%fitted, "described by "//terms(i))
         if (allocated(error)) return
         call check(error, all(noise%coefficient%detected .eqv. [.false., .true., .false., .true., .false.]), "N and K")
         if (allocated(error)) return
         associate (found => noise%coefficient([2, 4]))
            call check(error, all(abs(found%value - truth) < 3*found%std_error .and. found%std_error < 0.2_dp*truth), "values")
         end associate
         if (allocated(error)) return
      end do
   end subroutine test_chance_low

   subroutine test_misfit_limits(error)
      type(error_type), allocatable, intent(out) :: error

      ! slopes between those of Q and N under a hump, and a low last point: no sum of the terms. The fit stays at the curve, and no
      ! limit is a term that would lie far above the whole curve
      type(noise_model_type) :: unused
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure
      integer :: hump, term

      unused%squares(2) = 1
      do hump = 1, 5
         call exact_curve(unused, 36000_int64, curve)
         curve%deviation = 45*curve%tau**(-0.8_dp)*(1 + hump*exp(-(log(curve%tau/12)/log(2.0_dp))**2))
         curve%deviation(size(curve%m)) = curve%deviation(size(curve%m))/3
         call fit_noise(curve, noise_options(), noise, failure)
         call check(error, .not. allocated(failure) .and. .not. noise%acceptable .and. noise%misfit > 0, "a misfit")
         if (allocated(error)) return
         call check(error, abs(sum(log(noise%model/curve%deviation)))/size(curve%m) < log(2.0_dp), "the fit is at the curve")
         if (allocated(error)) return
         call check(error, noise%misfit < 2, "the misfit does not run away")
         if (allocated(error)) return
         do term = 1, 5
            call check(error, minval(noise%coefficient(term)%upper_limit*sqrt(model_shape(noise%mixture, term, &
               & curve%tau))/curve%deviation) < 3, "a limit above the whole curve")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_misfit_limits

   subroutine test_letters(error)
      type(error_type), allocatable, intent(out) :: error

      type(noise_model_type) :: model
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(gyro_error), allocatable :: failure

      model%squares(2) = 1
      call exact_curve(model, 10000_int64, curve)
      call fit_noise(curve, noise_options(terms="NX"), noise, failure)
      call check(error, allocated(failure), "NX")
      if (allocated(error)) return
      call check(error, failure%code, status%invalid_argument)
      if (allocated(error)) return
      call fit_noise(curve, noise_options(terms="autoN"), noise, failure)
      call check(error, allocated(failure), "autoN")
   end subroutine test_letters

end module test_allan_terms
