! SPDX-License-Identifier: MIT
!> What a simulated record is made of.
module gyroakf_simulate_options
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_simulate_sensor_filter, only : section_type, make_section, settling_samples
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: simulate_options, check_options, filters_of, paper_preset, paper_seed

   !> The seed of the example record example/data/mems_gyro_x.txt. It was chosen so that the record
   !> is typical: without its outliers and its cubic, phi is 0.4089 +- 0.0083, the variance
   !> 5.233e-4, the order 1 by AIC and BIC
   integer(int64), parameter :: paper_seed = 1140_int64

   !> What to simulate; the defaults give a record of zeros
   type :: simulate_options
      !> Number of samples, >= 1, and the seed of every random draw (any number)
      integer(int64) :: samples = 12000, seed = paper_seed
      !> Samples per second, > 0
      real(dp) :: rate_hz = 5.0_dp
      !> Unit u of the rates, as [[parse_unit]] knows it; "deg/s" if unallocated
      character(:), allocatable :: unit
      !> Q N B K R, see [[gyroakf_simulate_noise]]: u s, u sqrt(s), u, u/sqrt(s), u/s; R may be < 0
      real(dp) :: coefficient(5) = 0.0_dp
      !> Distribution of the white noise N, of the same variance: normal, laplace, t5 (Student's t,
      !> 5 degrees of freedom), mixture (of two normal distributions, see [[add_white]])
      character(7) :: tails = "normal"
      !> Coefficients of an autoregressive process: [p]; none if unallocated or empty
      real(dp), allocatable :: ar(:)
      !> Its stationary variance, u^2, >= 0
      real(dp) :: ar_variance = 0.0_dp
      !> Polynomial trend: coefficients of the powers of the index 0 .. n-1; none if unallocated
      real(dp), allocatable :: trend(:)
      !> Constant, u
      real(dp) :: offset = 0.0_dp
      !> Number of outliers, 0 .. samples
      integer(int64) :: outliers = 0
      !> Their mean size in standard deviations of the noise, >= 0; 0.75 .. 1.25 times that, +-
      real(dp) :: outlier_size = 0.0_dp
      !> Share of the samples that are contaminated, 0 .. 1, and largest size of these outliers in
      !> standard deviations of the noise; they are uniform from 4 to that size, of random sign
      real(dp) :: contamination(2) = 0.0_dp
      !> Warm-up A exp(-t/T): A in u, of either sign, and T in s, > 0; none if A is 0
      real(dp) :: warm_up(2) = 0.0_dp
      !> Half sines of motion: number, height in u, length in s, > 0, end of their part in s, 0: all
      real(dp) :: motion(4) = 0.0_dp
      !> Gauss-Markov processes: deviation in u, correlation time in s of each, > 0; or unallocated
      real(dp), allocatable :: markov(:)
      !> Vibration lines: amplitude in u (of the sine of the same power), frequency in Hz and its
      !> width at half the power in Hz of each in turn, all > 0; none if unallocated
      real(dp), allocatable :: vibration(:)
      !> Cutoff frequency of a Butterworth low-pass filter, Hz, below rate_hz/2; 0 none
      real(dp) :: lowpass_hz = 0.0_dp
      !> Its order, 1 or 2
      integer :: lowpass_order = 1
      !> Frequency of a resonance, a low-pass section of second order, Hz, below rate_hz/2; 0 none
      real(dp) :: resonance_hz = 0.0_dp
      !> Its quality factor, 0.5 .. 100
      real(dp) :: resonance_q = 1.0_dp
      !> Step that the output is rounded to, u; 0 none
      real(dp) :: lsb = 0.0_dp
      !> Share of samples lost at random, 0 <= missing < 1
      real(dp) :: missing = 0.0_dp
   end type simulate_options

   !> No value may become larger: squares and sums of them still fit
   real(dp), parameter :: largest = 1.0e140_dp, least = 1/largest

   !> Samples that the filters may take ahead of the record to settle
   real(dp), parameter :: most_ahead = 1.0e8_dp

contains

   !> The record of the paper: 12,000 samples at 5 Hz in deg/s.
   !>
   !> AR(1) noise with phi = 0.409975 and variance 5.24e-4 (deg/s)^2, 12 outliers of 6 to 10
   !> standard deviations, and a cubic with the features of the paper's eq. (10): its extremes are
   !> at the sample indices 2221 and 7999, and they are a few thousandths of a deg/s, far below the
   !> noise,
   !> $$ T'(i) = c (i - 2221)(i - 7999), \quad c = 1.26 \cdot 10^{-13}\ \mathrm{deg/s}, $$
   !> with the mean zero over the record. (The paper's own digits of eq. (10) are not known to us.)
   pure function paper_preset(seed) result(options)
      !> Seed; [[gyroakf_simulate_options:paper_seed]] gives the example record
      integer(int64), intent(in) :: seed
      !> The options, free to be changed
      type(simulate_options) :: options
      real(dp), parameter :: c = 1.26e-13_dp, n = 12000.0_dp

      options%samples = 12000
      options%seed = seed
      options%rate_hz = 5.0_dp
      options%unit = "deg/s"
      allocate (options%ar(1), options%trend(0:3))
      options%ar(1) = 0.409975_dp
      options%ar_variance = 5.24e-4_dp
      options%trend(1) = c*17765779
      options%trend(2) = -c*5110
      options%trend(3) = c/3
      ! minus the means of i, i**2 and i**3 over 0 .. n-1
      options%trend(0) = -(options%trend(1)*(n - 1)/2 + options%trend(2)*(n - 1)*(2*n - 1)/6 &
         & + options%trend(3)*n*(n - 1)**2/4)
      options%outliers = 12
      options%outlier_size = 8.0_dp
   end function paper_preset

   !> Low-pass filter and resonance, if they are switched on.
   pure function filters_of(options) result(sections)
      !> Within their ranges
      type(simulate_options), intent(in) :: options
      !> In the order in which they are applied
      type(section_type), allocatable :: sections(:)
      real(dp) :: hz(2), q(2)

      hz = [options%lowpass_hz, options%resonance_hz]
      q = [merge(sqrt(0.5_dp), 0.0_dp, options%lowpass_order == 2), options%resonance_q]
      allocate (sections, source=pack(make_section(hz, options%rate_hz, q), hz > 0))
   end function filters_of

   !> Names the first option that is not within its range.
   subroutine check_options(options, error)
      !> Any
      type(simulate_options), intent(in) :: options
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: n
      logical :: has_ar

      n = real(max(options%samples, 1_int64), dp)
      has_ar = .false.
      if (allocated(options%ar)) has_ar = size(options%ar) > 0
      associate (o => options)
         call demand(error, o%samples >= 1, "number of samples must be at least 1")
         call demand(error, within(o%rate_hz, least, largest), "rate must be 1e-140 to 1e140 Hz")
         call demand(error, all(within(o%coefficient(:4), 0.0_dp, largest/n)), &
            "coefficients Q, N, B and K must be >= 0")
         call demand(error, within(o%coefficient(5), -largest/n, largest/n), &
            "coefficient R must be a finite number")
         call demand(error, within(o%ar_variance, 0.0_dp, largest), "AR variance must be >= 0")
         call demand(error, within(o%offset, -largest, largest), "offset must be a finite number")
         call demand(error, o%outliers >= 0 .and. o%outliers <= o%samples, &
            "number of outliers must be 0 .. number of samples")
         call demand(error, within(o%outlier_size, 0.0_dp, largest), &
            "size of the outliers must be >= 0 standard deviations")
         call demand(error, within(o%lsb, 0.0_dp, largest), "LSB must be >= 0")
         call demand(error, within(o%missing, 0.0_dp, 1 - epsilon(n)), &
            "share of missing samples must be >= 0 and < 1")
         call demand(error, all_within(o%ar, -largest, largest), "AR coefficients must be finite")
         if (.not. allocated(error)) call demand(error, has_ar .or. .not. o%ar_variance > 0, &
            "a variance of the AR process needs its coefficients")
         call demand(error, all_within(o%trend, -largest, largest), &
            "trend coefficients must be finite numbers")
         if (allocated(o%trend)) call demand(error, (size(o%trend) - 1)*log10(n) <= 140, &
            "the trend has too many coefficients")
      end associate
      call check_disturbances(options, error)
      call check_sensor(options, error)
   end subroutine check_options

   !> Contamination, warm-up, motion, Gauss-Markov processes, vibration.
   subroutine check_disturbances(o, error)
      type(simulate_options), intent(in) :: o
      type(error_type), allocatable, intent(inout) :: error

      call demand(error, all(within(o%contamination, 0.0_dp, [1.0_dp, largest])), &
         "contamination must be a share of 0 .. 1 and a size >= 0")
      call demand(error, within(o%warm_up(1), -largest, largest), "warm-up must have finite size")
      if (.not. allocated(error)) call demand(error, .not. abs(o%warm_up(1)) > 0 &
         .or. within(o%warm_up(2), least, largest), "the time constant of a warm-up must be > 0 s")
      call demand(error, all(within(o%motion, 0.0_dp, [1.0e9_dp, largest, largest, largest])), &
         "motion must be 0 to 1e9 bursts, a height and a length > 0, and an end")
      if (.not. allocated(error)) call demand(error, .not. (abs(modulo(o%motion(1), 1.0_dp)) > 0 &
         .or. (o%motion(1) > 0 .and. .not. o%motion(3) > 0)), &
         "motion must be a whole number of bursts of a length > 0")
      call demand(error, all_within(o%markov, least, largest, 2), &
         "the numbers of a Gauss-Markov process must be complete and > 0")
      call demand(error, all_within(o%vibration, least, largest, 3), &
         "the numbers of a vibration line must be complete and > 0")
   end subroutine check_disturbances

   !> Filters and the distribution of the white noise.
   subroutine check_sensor(o, error)
      type(simulate_options), intent(in) :: o
      type(error_type), allocatable, intent(inout) :: error
      real(dp) :: below_half

      if (allocated(error)) return
      below_half = o%rate_hz*(0.5_dp - epsilon(0.5_dp))
      call demand(error, within(o%lowpass_hz, 0.0_dp, below_half), &
         "frequency of the low-pass filter must be > 0 Hz and below half the rate")
      call demand(error, any(o%lowpass_order == [1, 2]), &
         "order of the low-pass filter must be 1 or 2")
      call demand(error, within(o%resonance_hz, 0.0_dp, below_half), &
         "frequency of the resonance must be > 0 Hz and below half the rate")
      call demand(error, within(o%resonance_q, 0.5_dp, 100.0_dp), &
         "Q of the resonance must be 0.5 .. 100")
      call demand(error, any(o%tails == [character(7) :: "normal", "laplace", "t5", "mixture"]), &
         "distribution of the white noise must be normal, laplace, t5 or mixture")
      if (allocated(error)) return
      call demand(error, sum(settling_samples(filters_of(o))) <= most_ahead, &
         "a filter takes more than 1e8 samples to settle: its frequency is too near 0 or half "// &
         "the rate")
   end subroutine check_sensor

   !> The error, unless a condition holds or an earlier one did not.
   subroutine demand(error, condition, message)
      type(error_type), allocatable, intent(inout) :: error
      logical, intent(in) :: condition
      character(*), intent(in) :: message

      if (condition .or. allocated(error)) return
      call fatal_error(error, status%invalid_argument, "simulation: "//message)
   end subroutine demand

   !> True for a list of complete groups of numbers of the range, or none.
   pure logical function all_within(list, low, high, group)
      real(dp), allocatable, intent(in) :: list(:)
      real(dp), intent(in) :: low, high
      integer, intent(in), optional :: group

      all_within = .true.
      if (.not. allocated(list)) return
      all_within = all(within(list, low, high))
      if (present(group)) all_within = all_within .and. mod(size(list), group) == 0
   end function all_within

   !> True for a number of the range; false for NaN.
   elemental logical function within(value, low, high)
      real(dp), intent(in) :: value, low, high

      within = .false.
      if (ieee_is_finite(value)) within = value >= low .and. value <= high
   end function within

end module gyroakf_simulate_options
