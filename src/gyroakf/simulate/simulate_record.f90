! SPDX-License-Identifier: MIT
!> A record with known noise.
!>
!>     options = paper_preset(paper_seed)              ! or: options%coefficient(2) = 0.01_dp, ...
!>     call simulate_record(options, record, error)
!>
!> Every term draws from a stream of its own: switching one on or off does not change the others' numbers.
module gyroakf_simulate_simulate_record
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_extremes, only : all_sound
   use gyroakf_units, only : parse_unit
   use gyroakf_record, only : record_type, add_text
   use gyroakf_random, only : random_type, seed_random
   use gyroakf_simulate_noise, only : add_quantisation_noise, add_white, add_flicker, add_random_walk, add_ramp, &
      & add_autoregressive
   use gyroakf_simulate_disturbance, only : add_polynomial, add_warm_up, add_motion, add_outliers, round_to_step, lose_samples
   use gyroakf_simulate_sensor_filter, only : section_type, make_section, settling_samples, &
      & apply_section
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: simulate_options, simulate_record, paper_preset, paper_seed

   !> The seed of the example record example/data/mems_gyro_x.txt. It was chosen so that the record is typical: without
   !> its outliers and its cubic, phi is 0.4089 +- 0.0083, the variance 5.233e-4, the order 1 by AIC and BIC
   integer(int64), parameter :: paper_seed = 1140_int64

   !> What to simulate; the defaults give a record of zeros
   type :: simulate_options
      !> Number of samples, >= 1, and the seed of every random draw (any number)
      integer(int64) :: samples = 12000, seed = paper_seed
      !> Samples per second, > 0
      real(dp) :: rate_hz = 5.0_dp
      !> Unit u of the rates, as [[parse_unit]] knows it; "deg/s" if unallocated
      character(:), allocatable :: unit
      !> Q N B K R, see [[gyroakf_simulate_noise]]: u s, u sqrt(s), u, u/sqrt(s), u/s; >= 0, R of either sign
      real(dp) :: coefficient(5) = 0.0_dp
      !> Distribution of the white noise N, of the same variance: normal, laplace, t5 (Student's t,
      !> 5 degrees of freedom), mixture (of two normal distributions, see [[add_white]])
      character(7) :: tails = "normal"
      !> Coefficients of an autoregressive process: [p]; none if unallocated or empty
      real(dp), allocatable :: ar(:)
      !> Its stationary variance, u^2, >= 0
      real(dp) :: ar_variance = 0.0_dp
      !> Polynomial trend: coefficients of the powers 0, 1, ... of the sample index 0 .. n-1; none if unallocated
      real(dp), allocatable :: trend(:)
      !> Constant, u
      real(dp) :: offset = 0.0_dp
      !> Number of outliers, 0 .. samples
      integer(int64) :: outliers = 0
      !> Their mean size in standard deviations of the noise, >= 0; each is 0.75 .. 1.25 times that, of random sign
      real(dp) :: outlier_size = 0.0_dp
      !> Share of the samples that are contaminated, 0 .. 1, and largest size of these outliers in standard deviations of the
      !> noise; they are uniform from 4 to that size, of random sign
      real(dp) :: contamination(2) = 0.0_dp
      !> Warm-up A exp(-t/T): A in u, of either sign, and T in s, > 0; none if A is 0
      real(dp) :: warm_up(2) = 0.0_dp
      !> Number of half sines of a motion, their height in u and length in s, > 0, and the end in s of the part of the
      !> record that they lie in, 0: its end
      real(dp) :: motion(4) = 0.0_dp
      !> Gauss-Markov processes of first order: standard deviation in u and correlation time in s of each in turn,
      !> all > 0; none if unallocated
      real(dp), allocatable :: markov(:)
      !> Vibration lines: amplitude in u (of the sine of the same power), frequency in Hz and its width at half the
      !> power in Hz of each in turn, all > 0; none if unallocated
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

   !> The streams of the terms; numbers are never changed, new ones at the end
   integer, parameter :: stream_q = 1, stream_n = 2, stream_b = 3, stream_k = 4, stream_ar = 5, stream_outliers = 6, &
      & stream_missing = 7, stream_markov = 8, stream_vibration = 9, stream_motion = 10, stream_contamination = 11

   !> No value may become larger: squares and sums of them still fit
   real(dp), parameter :: largest = 1.0e140_dp

   !> Least size of the outliers of a contamination, standard deviations
   real(dp), parameter :: least_size = 4.0_dp

   !> What the filters may take ahead of the record to settle
   real(dp), parameter :: most_ahead = 1.0e8_dp

   !> Parts of the signal: all noise, the noise that is drift, what is deterministic
   integer, parameter :: all_noise = 1, drift_noise = 2, deterministic = 3

contains

   !> The record of the paper: 12,000 samples at 5 Hz in deg/s.
   !>
   !> AR(1) noise with phi = 0.409975 and variance 5.24e-4 (deg/s)^2, 12 outliers of 6 to 10 standard deviations, and a
   !> cubic with the features of the paper's eq. (10): its extremes are at the sample indices 2221 and 7999, and they are a
   !> few thousandths of a deg/s, far below the noise,
   !> $$ T'(i) = c (i - 2221)(i - 7999), \quad c = 1.26 \cdot 10^{-13}\ \mathrm{deg/s}, $$
   !> with the mean zero over the record. (The paper's own digits of eq. (10) are not known to us.)
   pure function paper_preset(seed) result(options)
      !> Seed; [[gyroakf_simulate_simulate_record:paper_seed]] gives the example record
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

   !> Makes a record of one channel, "gx".
   !>
   !> Its true drift is what moves slowly or stays: 1/f noise B, random walk K, ramp R, the AR process, Gauss-Markov
   !> processes, warm-up, trend and offset; not quantisation noise Q and white noise N, vibration, motion, outliers and
   !> rounding. It is known where samples are lost, too.
   !>
   !> Noise, trend and offset pass the filters of the sensor, settled at the first sample; they
   !> begin as early as that takes, the random walk at 0 there.
   subroutine simulate_record(options, record, error, truth, progress)
      !> What to simulate
      type(simulate_options), intent(in) :: options
      !> The record; `format` is "simulated", `present` is allocated where samples were lost
      type(record_type), intent(out) :: record
      !> `invalid_argument`: an option out of its range or an unknown unit; `unstable`: the AR model is not stationary;
      !> `non_finite`: its values are too large for double precision; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> The true drift, on the same grid
      type(record_type), intent(out), optional :: truth
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call check_options(options, error)
      if (allocated(error)) return
      call begin_record(options, record, error)
      if (allocated(error)) return
      call add_signal(options, all_noise, record%value(:, 1), error, progress)
      if (.not. allocated(error)) call add_disturbances(options, record, error)
      if (.not. allocated(error)) call report_progress("simulating", options%samples, options%samples, error, progress)
      if (.not. allocated(error)) call check_size(record, error)
      if (allocated(error)) return
      call audit_record(record)
      if (.not. present(truth)) return
      call begin_record(options, truth, error)
      if (allocated(error)) return
      call add_signal(options, drift_noise, truth%value(:, 1), error, progress)
      if (.not. allocated(error)) call add_signal(options, deterministic, truth%value(:, 1), error)
      if (.not. allocated(error)) call check_size(truth, error)
      if (allocated(error)) return
      call audit_record(truth)
   end subroutine simulate_record

   !> Refuses a record with values that overflowed: each option is within its range, but outliers are measured in the noise.
   subroutine check_size(record, error)
      type(record_type), intent(in) :: record
      type(error_type), allocatable, intent(out) :: error

      if (all_sound(record%value(:, 1), huge(1.0_dp))) return
      call fatal_error(error, status%non_finite, "the simulated values are too large for double precision: take smaller "// &
                       "coefficients or outliers")
   end subroutine check_size

   !> A record of zeros.
   subroutine begin_record(options, record, error)
      type(simulate_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(error_type), allocatable, intent(out) :: error
      integer :: stat

      if (allocated(options%unit)) then
         call parse_unit(options%unit, record%unit, error)
      else
         call parse_unit("deg/s", record%unit, error)
      end if
      if (allocated(error)) return
      allocate (record%value(options%samples, 1), source=0.0_dp, stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the simulated record")
         return
      end if
      record%path = "simulated"
      record%format = "simulated"
      record%sample_interval = 1/options%rate_hz
      record%rate_known = .true.
      record%rate_source = "option"
      record%unit_source = "option"
      call add_text(record%channel, "gx")
   end subroutine begin_record

   !> Adds a part of the signal as it leaves the filters of the sensor.
   subroutine add_signal(options, part, x, error, progress)
      type(simulate_options), intent(in) :: options
      !> all_noise, drift_noise, deterministic
      integer, intent(in) :: part
      real(dp), intent(inout), contiguous :: x(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(section_type), allocatable :: sections(:)
      real(dp), allocatable :: y(:)
      integer(int64) :: ahead
      integer :: k, stat

      allocate (sections, source=filters_of(options))
      if (size(sections) == 0) then
         call add_part(options, part, 0_int64, x, error, progress)
         return
      end if
      ahead = ceiling(sum(settling_samples(sections)), int64)
      allocate (y(ahead + size(x, kind=int64)), source=0.0_dp, stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the filters of the record")
         return
      end if
      call add_part(options, part, ahead, y, error, progress)
      if (allocated(error)) return
      do k = 1, size(sections)
         call apply_section(sections(k), y)
      end do
      x(:) = x + y(ahead + 1:)
   end subroutine add_signal

   !> Low-pass filter and resonance, if they are switched on.
   pure function filters_of(options) result(sections)
      type(simulate_options), intent(in) :: options
      type(section_type), allocatable :: sections(:)
      real(dp) :: hz(2), q(2)

      hz = [options%lowpass_hz, options%resonance_hz]
      q = [merge(sqrt(0.5_dp), 0.0_dp, options%lowpass_order == 2), options%resonance_q]
      allocate (sections, source=pack(make_section(hz, options%rate_hz, q), hz > 0))
   end function filters_of

   !> Adds a part of the signal that begins some samples ahead of the record.
   subroutine add_part(options, part, ahead, x, error, progress)
      type(simulate_options), intent(in) :: options
      integer, intent(in) :: part
      integer(int64), intent(in) :: ahead
      real(dp), intent(inout), contiguous :: x(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      if (part == deterministic) then
         call add_deterministic(options, -ahead, x)
      else
         call add_noise(options, part == all_noise, x, error, progress)
         if (.not. allocated(error)) call add_processes(options, part == all_noise, x, error, progress)
         if (part == all_noise .and. options%motion(1) > 0) call move(options, x(ahead + 1:))
      end if
   end subroutine add_part

   !> Gauss-Markov processes of first order, and vibration lines as autoregressive processes of second order.
   subroutine add_processes(options, fast, x, error, progress)
      type(simulate_options), intent(in) :: options
      !> With what is no drift: vibration
      logical, intent(in) :: fast
      real(dp), intent(inout), contiguous :: x(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp), parameter :: pi = 3.14159265358979323846_dp
      type(random_type) :: random
      integer :: k
      real(dp) :: t0, r

      t0 = 1/options%rate_hz
      if (allocated(options%markov)) then
         call seed_random(random, options%seed, stream_markov)
         do k = 1, size(options%markov), 2
            associate (p => options%markov(k:k + 1))
               call add_autoregressive(x, [exp(-t0/p(2))], p(1)**2, random, error, progress)
            end associate
            if (allocated(error)) return
         end do
      end if
      if (.not. (fast .and. allocated(options%vibration))) return
      call seed_random(random, options%seed, stream_vibration)
      do k = 1, size(options%vibration), 3
         associate (p => options%vibration(k:k + 2))
            r = exp(-pi*p(3)*t0)                       ! its spectrum falls to half at +- p(3)/2
            call add_autoregressive(x, [2*r*cos(2*pi*p(2)*t0), -r**2], p(1)**2/2, random, error, progress)
         end associate
         if (allocated(error)) return
      end do
   end subroutine add_processes

   !> Bursts of motion in the first part of a record.
   subroutine move(options, x)
      type(simulate_options), intent(in) :: options
      real(dp), intent(inout), contiguous :: x(:)
      type(random_type) :: random
      integer(int64) :: last

      call seed_random(random, options%seed, stream_motion)
      last = size(x, kind=int64)
      associate (m => options%motion)
         if (m(4) > 0) last = ceiling(min(m(4)*options%rate_hz, real(last, dp)), int64)
         call add_motion(x(:last), int(m(1), int64), m(2), m(3)*options%rate_hz, random)
      end associate
   end subroutine move

   !> The noise terms that are switched on, each from its stream.
   subroutine add_noise(options, fast, x, error, progress)
      type(simulate_options), intent(in) :: options
      !> With what is no drift: Q and N
      logical, intent(in) :: fast
      real(dp), intent(inout), contiguous :: x(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(random_type) :: random
      real(dp) :: t0

      t0 = 1/options%rate_hz
      associate (c => options%coefficient)
         if (fast .and. c(1) > 0) then
            call seed_random(random, options%seed, stream_q)
            call add_quantisation_noise(x, c(1), t0, random, error, progress)
            if (allocated(error)) return
         end if
         if (fast .and. c(2) > 0) then
            call seed_random(random, options%seed, stream_n)
            call add_white(x, c(2), t0, options%tails, random, error, progress)
            if (allocated(error)) return
         end if
         if (c(3) > 0) then
            call seed_random(random, options%seed, stream_b)
            call add_flicker(x, c(3), random, error, progress)
            if (allocated(error)) return
         end if
         if (c(4) > 0) then
            call seed_random(random, options%seed, stream_k)
            call add_random_walk(x, c(4), t0, random, error, progress)
            if (allocated(error)) return
         end if
      end associate
      if (allocated(options%ar)) then
         if (size(options%ar) > 0) then
            call seed_random(random, options%seed, stream_ar)
            call add_autoregressive(x, options%ar, options%ar_variance, random, error, progress)
         end if
      end if
   end subroutine add_noise

   !> Outliers and contamination on the noise, then what is deterministic, then rounding and losses.
   subroutine add_disturbances(options, record, error)
      type(simulate_options), intent(in) :: options
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      type(random_type) :: random
      integer :: stat

      associate (x => record%value(:, 1))
         if (options%outliers > 0) then
            call seed_random(random, options%seed, stream_outliers)
            call add_outliers(x, options%outliers, options%outlier_size, 0.25_dp, random, error)
            if (allocated(error)) return
         end if
         associate (share => options%contamination(1), largest_size => options%contamination(2))
            if (share > 0) then
               call seed_random(random, options%seed, stream_contamination)
               call add_outliers(x, nint(share*options%samples, int64), (largest_size + least_size)/2, &
                                 (largest_size - least_size)/(largest_size + least_size), random, error)
               if (allocated(error)) return
            end if
         end associate
         call add_signal(options, deterministic, x, error)
         if (allocated(error)) return
         if (options%lsb > 0) call round_to_step(x, options%lsb)
         if (options%missing > 0) then
            allocate (record%present(options%samples, 1), stat=stat)
            if (stat /= 0) then
               call fatal_error(error, status%no_memory, "no memory for the marks of missing samples")
               return
            end if
            call seed_random(random, options%seed, stream_missing)
            call lose_samples(x, options%missing, random, record%present(:, 1), record%audit%missing)
            if (record%audit%missing == 0) deallocate (record%present)
         end if
      end associate
   end subroutine add_disturbances

   !> Ramp, trend, offset, warm-up.
   pure subroutine add_deterministic(options, first, x)
      type(simulate_options), intent(in) :: options
      !> Sample index of x(1)
      integer(int64), intent(in) :: first
      real(dp), intent(inout), contiguous :: x(:)

      associate (r => options%coefficient(5))
         if (abs(r) > 0) call add_ramp(x, r, 1/options%rate_hz, first)
      end associate
      if (allocated(options%trend)) call add_polynomial(x, options%trend, first)
      if (abs(options%offset) > 0) call add_polynomial(x, [options%offset], first)
      associate (w => options%warm_up)
         if (abs(w(1)) > 0) call add_warm_up(x, w(1), w(2)*options%rate_hz, first)
      end associate
   end subroutine add_deterministic

   !> Counts, range and smallest step, as a reader would find them.
   pure subroutine audit_record(record)
      type(record_type), intent(inout) :: record
      integer(int64) :: i
      logical :: here, before
      real(dp) :: low, high, step, change

      record%audit%samples = size(record%value, 1, kind=int64)
      low = huge(low)
      high = -huge(high)
      step = huge(step)
      before = .false.
      do i = 1, record%audit%samples
         here = .true.
         if (allocated(record%present)) here = record%present(i, 1) == 1
         if (here) then
            low = min(low, record%value(i, 1))
            high = max(high, record%value(i, 1))
            if (before) then
               change = abs(record%value(i, 1) - record%value(i - 1, 1))
               if (change > 0) step = min(step, change)
            end if
         end if
         before = here
      end do
      allocate (record%audit%line_of_first(3), source=0_int64)
      allocate (record%audit%minimum(1), record%audit%maximum(1), record%audit%quantisation(1), source=0.0_dp)
      if (high >= low) then
         record%audit%minimum(1) = low
         record%audit%maximum(1) = high
      end if
      if (step < huge(step)) record%audit%quantisation(1) = step
   end subroutine audit_record

   !> Every option in its range, the first that is not is named.
   subroutine check_options(options, error)
      type(simulate_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: n

      n = real(options%samples, dp)
      if (options%samples < 1) then
         call complain(error, "number of samples must be at least 1")
      else if (.not. within(options%rate_hz, 1.0_dp/largest, largest)) then
         call complain(error, "rate must be > 0 Hz, 1e-140 to 1e140")
      else if (.not. all(within(options%coefficient(:4), 0.0_dp, largest/n))) then
         call complain(error, "coefficients Q, N, B and K must be >= 0")
      else if (.not. within(options%coefficient(5), -largest/n, largest/n)) then
         call complain(error, "coefficient R must be a finite number")
      else if (.not. within(options%ar_variance, 0.0_dp, largest)) then
         call complain(error, "variance of the AR process must be >= 0")
      else if (.not. within(options%offset, -largest, largest)) then
         call complain(error, "offset must be a finite number")
      else if (options%outliers < 0 .or. options%outliers > options%samples) then
         call complain(error, "number of outliers must be 0 .. number of samples")
      else if (.not. within(options%outlier_size, 0.0_dp, largest)) then
         call complain(error, "size of the outliers must be >= 0 standard deviations")
      else if (.not. within(options%lsb, 0.0_dp, largest)) then
         call complain(error, "LSB must be >= 0")
      else if (.not. within(options%missing, 0.0_dp, 1 - epsilon(n))) then
         call complain(error, "share of missing samples must be >= 0 and < 1")
      else
         call check_series(options, error)
         if (.not. allocated(error)) call check_disturbances(options, error)
         if (.not. allocated(error)) call check_sensor(options, error)
      end if
   end subroutine check_options

   !> Contamination, warm-up, motion, Gauss-Markov processes, vibration.
   subroutine check_disturbances(options, error)
      type(simulate_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: least = 1.0_dp/largest

      if (.not. all(within(options%contamination, 0.0_dp, [1.0_dp, largest]))) then
         call complain(error, "contamination must be a share of 0 .. 1 and a size >= 0")
      else if (.not. within(options%warm_up(1), -largest, largest)) then
         call complain(error, "the amplitude of a warm-up must be finite")
      else if (abs(options%warm_up(1)) > 0 .and. .not. within(options%warm_up(2), least, largest)) then
         call complain(error, "the time constant of a warm-up must be > 0 s")
      else if (.not. all(within(options%motion, 0.0_dp, [1.0e9_dp, largest, largest, largest]))) then
         call complain(error, "motion must be 0 to 1e9 bursts, a height and a length > 0, and an end")
      else if (abs(modulo(options%motion(1), 1.0_dp)) > 0 .or. &
               (options%motion(1) > 0 .and. .not. options%motion(3) > 0)) then
         call complain(error, "motion must be a whole number of bursts of a length > 0")
      end if
      if (.not. allocated(error)) call check_processes(options%markov, 2, "Gauss-Markov process", error)
      if (.not. allocated(error)) call check_processes(options%vibration, 3, "vibration line", error)
   end subroutine check_disturbances

   !> Groups of positive numbers
   subroutine check_processes(list, group, name, error)
      real(dp), allocatable, intent(in) :: list(:)
      integer, intent(in) :: group
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error

      if (.not. allocated(list)) return
      if (mod(size(list), group) == 0 .and. all(within(list, 1.0_dp/largest, largest))) return
      call complain(error, "the numbers of a "//name//" must be complete and > 0")
   end subroutine check_processes

   !> Filters and the distribution of the white noise.
   subroutine check_sensor(options, error)
      type(simulate_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: below_half

      below_half = options%rate_hz*(0.5_dp - epsilon(0.5_dp))
      if (.not. within(options%lowpass_hz, 0.0_dp, below_half)) then
         call complain(error, "frequency of the low-pass filter must be > 0 Hz and "// &
                       "below half the rate")
      else if (options%lowpass_order < 1 .or. options%lowpass_order > 2) then
         call complain(error, "order of the low-pass filter must be 1 or 2")
      else if (.not. within(options%resonance_hz, 0.0_dp, below_half)) then
         call complain(error, "frequency of the resonance must be > 0 Hz and below half the rate")
      else if (.not. within(options%resonance_q, 0.5_dp, 100.0_dp)) then
         call complain(error, "Q of the resonance must be 0.5 .. 100")
      else if (.not. any(options%tails == [character(7) :: "normal", "laplace", "t5", "mixture"])) then
         call complain(error, "distribution of the white noise must be normal, laplace, t5 or mixture")
      else if (sum(settling_samples(filters_of(options))) > most_ahead) then
         call complain(error, "a filter takes more than 1e8 samples to settle: its "// &
                       "frequency is too near 0 or half the rate")
      end if
   end subroutine check_sensor

   !> The options that are lists.
   subroutine check_series(options, error)
      type(simulate_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      integer :: k
      logical :: has_ar

      has_ar = .false.
      if (allocated(options%ar)) then
         has_ar = size(options%ar) > 0
         if (.not. all(within(options%ar, -largest, largest))) call complain(error, "AR coefficients must be finite numbers")
      end if
      if (options%ar_variance > 0 .and. .not. has_ar) call complain(error, "a variance of the AR process needs its coefficients")
      if (allocated(options%trend)) then
         do k = 0, size(options%trend) - 1
            if (.not. within(options%trend(lbound(options%trend, 1) + k), -largest, largest)) then
               call complain(error, "trend coefficients must be finite numbers")
            else if (k*log10(real(options%samples, dp)) > 140) then
               call complain(error, "the trend has too many coefficients")
            end if
         end do
      end if
   end subroutine check_series

   !> True for a number of the range; false for NaN
   elemental logical function within(value, low, high)
      real(dp), intent(in) :: value, low, high

      within = .false.
      if (ieee_is_finite(value)) within = value >= low .and. value <= high
   end function within

   subroutine complain(error, message)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: message

      call fatal_error(error, status%invalid_argument, "simulation: "//message)
   end subroutine complain

end module gyroakf_simulate_simulate_record
