! SPDX-License-Identifier: MIT
!> Power spectral density by Welch's method: mean periodogram of overlapping segments.
!>
!>     call welch_spectrum(x, dt, welch_options(), spectrum, error)
!>     ! spectrum%density(k) at spectrum%frequency(k), two-sided, unit^2/Hz for dt in s
module gyroakf_stats_welch
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, check_sample_interval, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_special, only : chi_square_quantile
   use gyroakf_fft_real, only : real_fft_plan_type, new_real_fft_plan
   use gyroakf_stats_welch_segment, only : make_window, add_segments, segment_type
   implicit none (type, external)
   private
   public :: welch_options, welch_type, welch_spectrum, default_segment

   !> Longest segment and fewest segments' lengths in the record that are chosen by default
   integer(int64), parameter :: longest_default = 16384_int64, lengths_default = 8_int64
   !> Parts in which the segments are added: the sums do not depend on the threads
   integer(int64), parameter :: most_parts = 64_int64
   !> Longer segments are reported one by one, and processed by one thread
   integer(int64), parameter :: long_segment = 2097152_int64
   !> Samples of the segments between two reports of progress
   integer(int64), parameter :: report_samples = 4194304_int64

   !> How the spectrum is estimated
   type :: welch_options
      !> Samples of a segment, 2 .. n; 0: the largest power of two that fits 8 times, at most 16384
      integer(int64) :: segment = 0
      !> hann, hamming, blackman or none (rectangular); periodic forms
      character(8) :: window = "hann"
      !> Share of a segment that the next one repeats, 0 .. 0.95
      real(dp) :: overlap = 0.5_dp
      !> Each segment loses its mean
      logical :: detrend = .true.
      !> Probability between the limits, 0 < P < 1
      real(dp) :: confidence = 0.683_dp
      !> A segment counts when this share of its squared window is present: > 0 .. 1
      real(dp) :: min_coverage = 0.5_dp
   end type welch_options

   !> Power spectral density of a series in the unit u
   type :: welch_type
      !> 0 .. half the sample rate: [L/2 + 1] for segments of L samples
      real(dp), allocatable :: frequency(:)
      !> Two-sided density and its limits, u^2/Hz; its integral is the variance
      real(dp), allocatable :: density(:), lower(:), upper(:)
      !> One-sided density: twice the two-sided one but at 0 and at half the sample rate
      real(dp), allocatable :: one_sided(:)
      !> Degrees of freedom of each density
      real(dp), allocatable :: edf(:)
      !> Samples of a segment, and from one to the next
      integer(int64) :: segment = 0, step = 0
      !> Segments that fit the series, and those that count
      integer(int64) :: segments = 0, used = 0
      !> Distance of two frequencies, and noise bandwidth of the window, Hz
      real(dp) :: resolution = 0.0_dp, noise_bandwidth = 0.0_dp
      !> Degrees of freedom between 0 and half the sample rate
      real(dp) :: degrees_of_freedom = 0.0_dp
      !> What was used
      real(dp) :: confidence = 0.0_dp, overlap = 0.0_dp
      character(8) :: window = "hann"
   end type welch_type

contains

   !> Welch's estimate of the power spectral density.
   !>
   !> $$S(f_k) = \frac{\Delta t}{\sum_i c_i} \sum_i \frac{c_i}{\sum_t w_t^2 v_{it}} \left| \sum_t
   !> w_t v_{it} (x_{it} - \bar x_i) e^{-2\pi i kt/L} \right|^2, \quad c_i = \frac{\sum_t w_t^2
   !> v_{it}}{\sum_t w_t^2},$$ v being 1 for present samples and 0 for missing ones, i the segments
   !> with c_i >= min_coverage. Segments that miss samples see strong parts of the spectrum through
   !> the gaps; raise min_coverage where that matters. The degrees of freedom are those of the
   !> weighted mean of overlapping segments in Gaussian noise, $$\nu = 2 (\sum c_i)^2/\sum_{ij} c_i
   !> c_j \rho_{|i-j|}^2, \quad \rho_j = \sum_t w_t w_{t+jD}/\sum_t w_t^2,$$ D the step; at
   !> frequency 0 and at half the sample rate half as many. Source: P. D. Welch, The use of fast
   !> Fourier transform for the estimation of power spectra, IEEE Trans. Audio Electroacoust. 15
   !> (1967) 70-73; windows: F. J. Harris, Proc. IEEE 66 (1978) 51-83.
   subroutine welch_spectrum(x, dt, options, spectrum, error, valid, progress)
      !> Series: [n], n >= 2; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval > 0; 1: frequencies in cycles per sample
      real(dp), intent(in) :: dt
      !> How
      type(welch_options), intent(in) :: options
      !> The spectrum
      type(welch_type), intent(out) :: spectrum
      !> invalid_argument, too_few_samples (no segment counts), no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(segment_type) :: part
      type(real_fft_plan_type) :: plan
      real(dp), allocatable :: share(:)
      integer :: stat

      call lay_out(size(x, kind=int64), dt, options, spectrum, error)
      if (allocated(error)) return
      part%length = spectrum%segment
      part%step = spectrum%step
      part%detrend = options%detrend
      part%min_coverage = options%min_coverage
      allocate (part%window(0:part%length - 1), stat=stat)
      if (stat == 0) allocate (spectrum%density(0:part%length/2), stat=stat)
      if (stat == 0) allocate (share(spectrum%segments), stat=stat)
      call check_memory(stat, "the segments of the spectrum", error)
      if (allocated(error)) return
      call report_progress("spectrum", 0_int64, spectrum%segments, error, progress)
      if (allocated(error)) return
      call make_window(trim(options%window), part%window, error, progress)
      if (.not. allocated(error)) call new_real_fft_plan(plan, part%length, error, progress)
      if (allocated(error)) return
      spectrum%density = 0.0_dp
      call add_all(x, part, plan, spectrum%density, share, error, valid, progress)
      if (allocated(error)) return
      spectrum%used = count(share > 0.0_dp, kind=int64)
      if (spectrum%used == 0) then
         call fatal_error(error, status%too_few_samples, "too much is missing in every segment " &
            & //"of the spectrum: take shorter segments, or a smaller share that must be present")
         return
      end if
      call report_progress("spectrum", spectrum%segments, spectrum%segments, error, progress)
      if (allocated(error)) return
      spectrum%density = spectrum%density*(dt/sum(share))
      call state(part, share, dt, spectrum, error, progress)
   end subroutine welch_spectrum

   !> Length, step and number of the segments.
   subroutine lay_out(n, dt, options, spectrum, error)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: dt
      type(welch_options), intent(in) :: options
      type(welch_type), intent(inout) :: spectrum
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      call check_sample_interval(dt, error)
      if (allocated(error)) return
      if (n < 2) then
         call fatal_error(error, status%too_few_samples, "a spectrum needs at least 2 samples")
      else if (all(options%window /= [character(8) :: "hann", "hamming", "blackman", "none"])) then
         call fatal_error(error, status%invalid_argument, "unknown window '" &
            & //trim(options%window)//"'; there are hann, hamming, blackman and none")
      else if (.not. (options%overlap >= 0.0_dp .and. options%overlap <= 0.95_dp)) then
         call fatal_error(error, status%invalid_argument, &
            & "the overlap of the segments must be 0 .. 0.95")
      else if (.not. (options%confidence > 0.0_dp .and. options%confidence < 1.0_dp)) then
         call fatal_error(error, status%invalid_argument, "the confidence must lie between 0 and 1")
      else if (.not. (options%min_coverage > 0.0_dp .and. options%min_coverage <= 1.0_dp)) then
         call fatal_error(error, status%invalid_argument, &
            & "the coverage must be larger than 0 and at most 1")
      else if (options%segment /= 0 .and. (options%segment < 2 .or. options%segment > n)) then
         write (text, "(2(a, i0))") "a segment of the spectrum must have 2 to ", n, &
            & " samples (0: chosen), not ", options%segment
         call fatal_error(error, status%invalid_argument, trim(text))
      end if
      if (allocated(error)) return
      spectrum%segment = options%segment
      if (options%segment == 0) spectrum%segment = default_segment(n)
      spectrum%step = max(1_int64, spectrum%segment &
         & - int(options%overlap*real(spectrum%segment, dp), int64))
      spectrum%segments = (n - spectrum%segment)/spectrum%step + 1
      spectrum%overlap = options%overlap
      spectrum%confidence = options%confidence
      spectrum%window = options%window
   end subroutine lay_out

   !> Default samples of a segment: the largest power of two that fits 8 times, 2 .. 16384.
   !>
   !> With half overlap that is the mean of 15 segments or more (about 28 degrees of freedom, a
   !> density within 27 % either way); a long record gets more of them, not narrower ones.
   pure integer(int64) function default_segment(n) result(length)
      !> Samples of the series, >= 2
      integer(int64), intent(in) :: n

      length = 2
      do while (2*length <= min(n/lengths_default, longest_default))
         length = 2*length
      end do
   end function default_segment

   !> Adds all segments, by parts that do not depend on the number of threads.
   subroutine add_all(x, part, plan, density, share, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(segment_type), intent(in) :: part
      type(real_fft_plan_type), intent(in) :: plan
      real(dp), intent(inout), contiguous :: density(0:)
      real(dp), intent(out) :: share(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(error_type), allocatable :: failed
      real(dp), allocatable :: sums(:, :)
      integer(int64) :: first, segments, parts, group, from, to, p
      integer :: stat

      segments = size(share, kind=int64)
      parts = min(most_parts, segments, max(4_int64, 1048576_int64/part%length))
      allocate (sums(0:part%length/2, parts), stat=stat)
      call check_memory(stat, "the segments of the spectrum", error)
      if (allocated(error)) return
      if (present(progress) .and. part%length > long_segment) then
         call add_segments(x, part, plan, 1_int64, segments, density, share, error, valid, progress)
         return
      end if
      group = max(report_samples/part%length, 1_int64)
      do first = 0, segments - 1, group
         call report_progress("spectrum", first, segments, error, progress)
         if (allocated(error)) return
         associate (number => min(group, segments - first))
            !$omp parallel do default(shared) private(from, to, failed) schedule(dynamic) &
            !$omp& if (number*part%length > 60000)
            do p = 1, parts
               from = first + ((p - 1)*number)/parts + 1
               to = first + (p*number)/parts
               sums(:, p) = 0.0_dp
               if (from > to) cycle
               call add_segments(x, part, plan, from, to, sums(:, p), share(from:to), failed, valid)
               !$omp critical (gyroakf_welch_failure)
               if (allocated(failed) .and. .not. allocated(error)) call move_alloc(failed, error)
               !$omp end critical (gyroakf_welch_failure)
            end do
         end associate
         if (allocated(error)) return
         do p = 1, parts
            density = density + sums(:, p)
         end do
      end do
   end subroutine add_all

   !> Frequencies, degrees of freedom, limits.
   subroutine state(part, share, dt, spectrum, error, progress)
      type(segment_type), intent(in) :: part
      real(dp), intent(in) :: share(:), dt
      type(welch_type), intent(inout) :: spectrum
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: tail
      integer(int64) :: k, last

      last = part%length/2
      spectrum%resolution = 1.0_dp/(real(part%length, dp)*dt)
      spectrum%noise_bandwidth = sum(part%window**2)/sum(part%window)**2/dt
      allocate (spectrum%frequency(0:last), spectrum%edf(0:last), spectrum%one_sided(0:last), &
         & spectrum%lower(0:last), spectrum%upper(0:last))
      tail = 0.5_dp*(1.0_dp - spectrum%confidence)
      do k = 0, last
         spectrum%frequency(k) = real(k, dp)/(real(part%length, dp)*dt)
      end do
      call report_progress("spectrum", spectrum%segments, spectrum%segments, error, progress)
      if (allocated(error)) return
      associate (nu => spectrum%degrees_of_freedom)
         nu = freedom(part, share)
         spectrum%edf = nu
         spectrum%one_sided = 2.0_dp*spectrum%density
         spectrum%lower = spectrum%density*(nu/chi_square_quantile(1.0_dp - tail, nu))
         spectrum%upper = spectrum%density*(nu/chi_square_quantile(tail, nu))
         do k = 0, last
            if (k > 0 .and. 2*k < part%length) cycle
            spectrum%edf(k) = 0.5_dp*nu
            spectrum%one_sided(k) = spectrum%density(k)
            spectrum%lower(k) = spectrum%density(k) &
               & *(0.5_dp*nu/chi_square_quantile(1.0_dp - tail, 0.5_dp*nu))
            spectrum%upper(k) = spectrum%density(k) &
               & *(0.5_dp*nu/chi_square_quantile(tail, 0.5_dp*nu))
         end do
      end associate
   end subroutine state

   !> Degrees of freedom of the weighted mean of overlapping segments.
   pure real(dp) function freedom(part, share)
      type(segment_type), intent(in) :: part
      real(dp), intent(in) :: share(:)
      real(dp) :: correlation, total
      integer(int64) :: j, lag, i, n

      n = size(share, kind=int64)
      total = sum(share**2)
      do j = 1, n - 1
         lag = j*part%step
         if (lag >= part%length) exit
         correlation = sum(part%window(:part%length - 1 - lag)*part%window(lag:)) &
            & /sum(part%window**2)
         do i = 1, n - j
            total = total + 2.0_dp*share(i)*share(i + j)*correlation**2
         end do
      end do
      freedom = 2.0_dp*sum(share)**2/total
   end function freedom

end module gyroakf_stats_welch
