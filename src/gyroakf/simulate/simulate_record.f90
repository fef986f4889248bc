! SPDX-License-Identifier: MIT
!> A record with known noise.
!>
!>     options = paper_preset(paper_seed)              ! or: options%coefficient(2) = 0.01_dp, ...
!>     call simulate_record(options, record, error)
!>
!> Every term draws from a stream of its own: switching one on or off does not change the others.
module gyroakf_simulate_simulate_record
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_values
   use gyroakf_stats_extremes, only : all_sound
   use gyroakf_units, only : parse_unit
   use gyroakf_record, only : record_type, add_text
   use gyroakf_random, only : random_type, seed_random
   use gyroakf_simulate_noise, only : add_quantization_noise, add_white, add_flicker, &
      add_random_walk, add_autoregressive
   use gyroakf_simulate_disturbance, only : add_polynomial, add_warm_up, add_motion, add_outliers, &
      lose_samples
   use gyroakf_simulate_options, only : check_options, filters_of, paper_preset, paper_seed, &
      simulate_options
   use gyroakf_simulate_sensor_filter, only : section_type, settling_samples, apply_section
   implicit none (type, external)
   private
   public :: simulate_options, simulate_record, paper_preset, paper_seed

   !> The streams of the terms; numbers are never changed, new ones at the end
   integer, parameter :: stream_q = 1, stream_n = 2, stream_b = 3, stream_k = 4, stream_ar = 5, &
      stream_outliers = 6, stream_missing = 7, stream_markov = 8, stream_vibration = 9, &
      stream_motion = 10, stream_contamination = 11, streams = 11

   !> Least size of the outliers of a contamination, standard deviations
   real(dp), parameter :: least_size = 4.0_dp

   !> Parts of the signal: all noise, the noise that is drift, what is deterministic
   integer, parameter :: all_noise = 1, drift_noise = 2, deterministic = 3

contains

   !> Makes a record of one channel, "gx".
   !>
   !> Its true drift is what moves slowly or stays: 1/f noise B, random walk K, ramp R, the AR
   !> process, Gauss-Markov processes, warm-up, trend and offset; not quantization noise Q and white
   !> noise N, vibration, motion, outliers and rounding. It is known where samples are lost, too.
   !>
   !> Noise, trend and offset pass the filters of the sensor, settled at the first sample; they
   !> begin as early as that takes, the random walk at 0 there.
   subroutine simulate_record(options, record, error, truth, progress)
      !> What to simulate
      type(simulate_options), intent(in) :: options
      !> The record; `format` is "simulated", `present` is allocated where samples were lost
      type(record_type), intent(out) :: record
      !> `invalid_argument`: an option out of its range or an unknown unit; `unstable`: the AR model
      !> is not stationary; `non_finite`: its values are too large for double precision; no_memory;
      !> cancelled
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
      if (.not. allocated(error)) call report_progress("simulating", options%samples, &
         options%samples, error, progress)
      if (.not. allocated(error)) call audit_record(record, error)
      if (allocated(error) .or. .not. present(truth)) return
      call begin_record(options, truth, error)
      if (allocated(error)) return
      call add_signal(options, drift_noise, truth%value(:, 1), error, progress)
      if (.not. allocated(error)) call add_signal(options, deterministic, truth%value(:, 1), error)
      if (.not. allocated(error)) call audit_record(truth, error)
   end subroutine simulate_record

   !> Counts and extremes. Outliers, measured in the noise, may overflow in spite of valid options.
   subroutine audit_record(record, error)
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error

      if (.not. all_sound(record%value(:, 1), huge(1.0_dp))) then
         call fatal_error(error, status%non_finite, "the simulated values are too large for "// &
            "double precision: take smaller coefficients or outliers")
         return
      end if
      allocate (record%audit%line_of_first(3), source=0_int64)
      call audit_values(record%value, record%present, record%audit, error)
   end subroutine audit_record

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
      call check_memory(stat, "the simulated record", error)
      if (allocated(error)) return
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
      call check_memory(stat, "the filters of the record", error)
      if (allocated(error)) return
      call add_part(options, part, ahead, y, error, progress)
      if (allocated(error)) return
      do k = 1, size(sections)
         call apply_section(sections(k), y)
      end do
      x(:) = x + y(ahead + 1:)
   end subroutine add_signal

   !> Adds a part of the signal that begins some samples ahead of the record.
   subroutine add_part(options, part, ahead, x, error, progress)
      type(simulate_options), intent(in) :: options
      integer, intent(in) :: part
      integer(int64), intent(in) :: ahead
      real(dp), intent(inout), contiguous :: x(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(random_type) :: random(streams)
      integer(int64) :: last

      if (part == deterministic) then
         call add_deterministic(options, -ahead, x)
         return
      end if
      call seed_streams(options%seed, random)
      call add_noise(options, part == all_noise, x, random, error, progress)
      if (.not. allocated(error)) call add_processes(options, part == all_noise, x, random, error, &
         progress)
      associate (m => options%motion)
         if (part /= all_noise .or. m(1) <= 0) return
         last = size(x, kind=int64)
         if (m(4) > 0) last = ahead + ceiling(min(m(4)*options%rate_hz, real(last - ahead, dp)), &
            int64)
         call add_motion(x(ahead + 1:last), int(m(1), int64), m(2), m(3)*options%rate_hz, &
            random(stream_motion))
      end associate
   end subroutine add_part

   !> Gauss-Markov processes of first order, and vibration lines as AR processes of second order.
   subroutine add_processes(options, fast, x, random, error, progress)
      type(simulate_options), intent(in) :: options
      !> With what is no drift: vibration
      logical, intent(in) :: fast
      real(dp), intent(inout), contiguous :: x(:)
      type(random_type), intent(inout) :: random(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp), parameter :: pi = 3.14159265358979323846_dp
      integer :: k
      real(dp) :: t0, r

      t0 = 1/options%rate_hz
      if (allocated(options%markov)) then
         do k = 1, size(options%markov), 2
            associate (p => options%markov(k:k + 1))
               call add_autoregressive(x, [exp(-t0/p(2))], p(1)**2, random(stream_markov), error, &
                  progress)
            end associate
            if (allocated(error)) return
         end do
      end if
      if (.not. (fast .and. allocated(options%vibration))) return
      do k = 1, size(options%vibration), 3
         associate (p => options%vibration(k:k + 2))
            r = exp(-pi*p(3)*t0)                       ! its spectrum falls to half at +- p(3)/2
            call add_autoregressive(x, [2*r*cos(2*pi*p(2)*t0), -r**2], p(1)**2/2, &
               random(stream_vibration), error, progress)
         end associate
         if (allocated(error)) return
      end do
   end subroutine add_processes

   !> The noise terms that are switched on.
   subroutine add_noise(options, fast, x, random, error, progress)
      type(simulate_options), intent(in) :: options
      !> With what is no drift: Q and N
      logical, intent(in) :: fast
      real(dp), intent(inout), contiguous :: x(:)
      type(random_type), intent(inout) :: random(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: t0

      t0 = 1/options%rate_hz
      associate (c => options%coefficient)
         if (fast .and. c(1) > 0) call add_quantization_noise(x, c(1), t0, random(stream_q), &
            error, progress)
         if (allocated(error)) return
         if (fast .and. c(2) > 0) call add_white(x, c(2), t0, options%tails, random(stream_n), &
            error, progress)
         if (allocated(error)) return
         if (c(3) > 0) call add_flicker(x, c(3), random(stream_b), error, progress)
         if (allocated(error)) return
         if (c(4) > 0) call add_random_walk(x, c(4), t0, random(stream_k), error, progress)
         if (allocated(error) .or. .not. allocated(options%ar)) return
      end associate
      if (size(options%ar) > 0) call add_autoregressive(x, options%ar, options%ar_variance, &
         random(stream_ar), error, progress)
   end subroutine add_noise

   !> Outliers and contamination on the noise, then what is deterministic, then rounding and losses.
   subroutine add_disturbances(options, record, error)
      type(simulate_options), intent(in) :: options
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      type(random_type) :: random(streams)
      integer :: stat

      call seed_streams(options%seed, random)
      associate (x => record%value(:, 1), share => options%contamination(1), &
         largest_size => options%contamination(2))
         if (options%outliers > 0) call add_outliers(x, options%outliers, options%outlier_size, &
            0.25_dp, random(stream_outliers), error)
         if (allocated(error)) return
         if (share > 0) call add_outliers(x, nint(share*options%samples, int64), &
            (largest_size + least_size)/2, (largest_size - least_size)/(largest_size + &
            least_size), random(stream_contamination), error)
         if (.not. allocated(error)) call add_signal(options, deterministic, x, error)
         if (allocated(error)) return
         if (options%lsb > 0) x(:) = options%lsb*anint(x/options%lsb)
         if (options%missing <= 0) return
         allocate (record%present(options%samples, 1), stat=stat)
         call check_memory(stat, "the marks of missing samples", error)
         if (allocated(error)) return
         call lose_samples(x, options%missing, random(stream_missing), record%present(:, 1))
         if (all(record%present == 1)) deallocate (record%present)
      end associate
   end subroutine add_disturbances

   !> Ramp, trend, offset, warm-up.
   pure subroutine add_deterministic(options, first, x)
      type(simulate_options), intent(in) :: options
      integer(int64), intent(in) :: first
      real(dp), intent(inout), contiguous :: x(:)

      ! means over the sample intervals: the ramp is R t0 (i + 1/2) at sample i
      associate (step => options%coefficient(5)/options%rate_hz)
         if (abs(step) > 0) call add_polynomial(x, [step/2, step], first)
      end associate
      if (allocated(options%trend)) call add_polynomial(x, options%trend, first)
      if (abs(options%offset) > 0) call add_polynomial(x, [options%offset], first)
      associate (w => options%warm_up)
         if (abs(w(1)) > 0) call add_warm_up(x, w(1), w(2)*options%rate_hz, first)
      end associate
   end subroutine add_deterministic

   !> The generators of all terms.
   pure subroutine seed_streams(seed, random)
      integer(int64), intent(in) :: seed
      type(random_type), intent(out) :: random(:)
      integer :: k

      do k = 1, size(random)
         call seed_random(random(k), seed, k)
      end do
   end subroutine seed_streams

end module gyroakf_simulate_simulate_record
