! SPDX-License-Identifier: MIT
!> Dynamic Allan deviation: the deviation in a window that slides over the record, to see where the noise changes.
!>
!>     type(dynamic_options) :: options
!>     options%segments = 20                               ! overlapping by half
!>     call dynamic_allan(rate, sample_interval, options, dynamic, error)
!>     dynamic%deviation(i, j)                             ! at dynamic%tau(i), from dynamic%start(j) on
!>
!> Source: L. Galleani, P. Tavella, "The dynamic Allan variance", IEEE Trans. UFFC 56 (2009), with overlapping Allan variances of
!> segments. The record is integrated once; the segments are differences of that integral, which do not see where it began.
module gyroakf_allan_dynamic
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_noise_identification, only : identify_noise
   use gyroakf_allan_phase, only : integrate_rate
   use gyroakf_allan_segment, only : segment_variances
   use gyroakf_allan_statistic, only : statistic_edf, term_count
   implicit none (type, external)
   private
   public :: dynamic_options, dynamic_type, dynamic_allan

   !> Segments and averaging times
   type :: dynamic_options
      !> Number of segments, overlapping by half, that fill the record; 0: by `segment` and `step`
      integer :: segments = 0
      !> Length of a segment in s, 0: a tenth of the record; from one to the next in s, 0: half a segment
      real(dp) :: segment = 0.0_dp, step = 0.0_dp
      !> Averaging times, as in [[allan_options]], up to half a segment; "octave" also when unallocated
      character(:), allocatable :: taus
      !> Probability between the limits, > 0, < 1
      real(dp) :: confidence = 0.683_dp
      !> Share of a window that must be present, > 0, <= 1
      real(dp) :: min_coverage = 0.9_dp
   end type dynamic_options

   !> The deviation over averaging time and time; where a segment has no term, `terms` and all else are 0
   type :: dynamic_type
      !> Samples of a segment, and from one to the next
      integer(int64) :: segment_samples = 0, step_samples = 0
      !> Length of a segment, s
      real(dp) :: segment = 0.0_dp
      !> Probability between the limits
      real(dp) :: confidence = 0.683_dp
      !> Averaging factors, and times in s: [k]
      integer(int64), allocatable :: m(:)
      real(dp), allocatable :: tau(:)
      !> Beginnings of the segments, s from the first sample: [segments]
      real(dp), allocatable :: start(:)
      !> Deviation and its limits in the unit of the rate, degrees of freedom: [k, segments]
      real(dp), allocatable :: deviation(:, :), lower(:, :), upper(:, :), edf(:, :)
      !> Terms that were averaged: [k, segments]
      integer(int64), allocatable :: terms(:, :)
   end type dynamic_type

   !> Shortest segment in samples
   integer(int64), parameter :: shortest = 4
   !> With as many segments each thread takes whole ones; fewer are worked on one by one, by all threads
   integer, parameter :: parallel_from = 8

contains

   !> Overlapping Allan deviations of segments of a record.
   !>
   !> The degrees of freedom are those of the noise identified at each averaging time in the whole record, reduced by the share of
   !> terms lost to gaps. Cost: three passes, and for segments that overlap by half twice the work of one Allan deviation; memory
   !> 8 bytes a sample, 12 where some are missing.
   subroutine dynamic_allan(rate, sample_interval, options, dynamic, error, valid)
      !> Rate samples, evenly spaced: [n], n >= 4; NaN and infinity count as missing
      real(dp), intent(in), contiguous :: rate(:)
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> Segments, averaging times, confidence
      type(dynamic_options), intent(in) :: options
      !> The result
      type(dynamic_type), intent(out) :: dynamic
      !> invalid_argument, too_few_samples (segments of fewer than 4 samples), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]; all present if absent
      integer(int8), intent(in), optional :: valid(:)

      real(dp), allocatable :: phase(:)
      integer(int32), allocatable :: missing(:)
      integer, allocatable :: alpha(:)
      integer(int64) :: segments

      call check_arguments(sample_interval, options, error)
      if (.not. allocated(error)) call divide(size(rate, kind=int64), sample_interval, options, dynamic, segments, error)
      if (.not. allocated(error)) call allocate_result(segments, sample_interval, options, dynamic, error)
      if (.not. allocated(error)) call integrate_rate(rate, phase, missing, error, valid)
      if (.not. allocated(error)) call compute_segments(phase, missing, options%min_coverage, dynamic, error)
      if (allocated(error)) return
      allocate (alpha(size(dynamic%m)))
      call identify_noise(phase, dynamic%m, options%min_coverage, alpha, missing)
      call set_limits(alpha, dynamic)
   end subroutine dynamic_allan

   !> Rejects what is out of range.
   subroutine check_arguments(sample_interval, options, error)
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> Options
      type(dynamic_options), intent(in) :: options
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      if (.not. within(sample_interval, tiny(1.0_dp), huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, "the sample interval must be positive and finite")
      else if (.not. within(options%confidence, tiny(1.0_dp), 1 - epsilon(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, "the confidence must lie between 0 and 1")
      else if (.not. within(options%min_coverage, tiny(1.0_dp), 1.0_dp)) then
         call fatal_error(error, status%invalid_argument, "the coverage of a window must be above 0 and at most 1")
      else if (options%segments < 0) then
         call fatal_error(error, status%invalid_argument, "the number of segments must not be negative")
      else if (.not. (within(options%segment, 0.0_dp, huge(1.0_dp)) .and. within(options%step, 0.0_dp, huge(1.0_dp)))) then
         call fatal_error(error, status%invalid_argument, "length and step of the segments must be finite and not negative")
      end if
   end subroutine check_arguments

   !> In a closed interval.
   pure logical function within(x, low, high)
      !> Any number, and the interval
      real(dp), intent(in) :: x, low, high

      within = .false.
      if (ieee_is_finite(x)) within = x >= low .and. x <= high
   end function within

   !> Lengths in samples and the number of the segments.
   subroutine divide(n, sample_interval, options, dynamic, segments, error)
      !> Samples of the record
      integer(int64), intent(in) :: n
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> What is wished
      type(dynamic_options), intent(in) :: options
      !> Its lengths are set
      type(dynamic_type), intent(inout) :: dynamic
      !> How many
      integer(int64), intent(out) :: segments
      !> too_few_samples
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      segments = options%segments
      if (segments > 0) then
         dynamic%segment_samples = 2*n/(segments + 1)
      else if (options%segment > 0) then
         dynamic%segment_samples = nint(min(options%segment/sample_interval, real(n, dp)), int64)
      else
         dynamic%segment_samples = n/10
      end if
      dynamic%step_samples = max(1_int64, dynamic%segment_samples/2)
      if (options%segments == 0 .and. options%step > 0) then
         dynamic%step_samples = max(1_int64, nint(min(options%step/sample_interval, real(n, dp)), int64))
      end if
      if (dynamic%segment_samples < shortest) then
         write (text, "(3(a, i0))") "a segment of ", dynamic%segment_samples, " of ", n, " samples is too short, it needs ", &
            & shortest
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      if (options%segments == 0) segments = 1 + (n - dynamic%segment_samples)/dynamic%step_samples
      dynamic%segment = real(dynamic%segment_samples, dp)*sample_interval
   end subroutine divide

   !> Averaging times, beginnings of the segments, and room for what is computed.
   subroutine allocate_result(segments, sample_interval, options, dynamic, error)
      !> How many
      integer(int64), intent(in) :: segments
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> For the averaging times
      type(dynamic_options), intent(in) :: options
      !> The result
      type(dynamic_type), intent(inout) :: dynamic
      !> invalid_argument, too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64) :: i, k
      integer :: stat

      if (allocated(options%taus)) then
         call averaging_factors(options%taus, dynamic%segment_samples, sample_interval, dynamic%m, error)
      else
         call averaging_factors("octave", dynamic%segment_samples, sample_interval, dynamic%m, error)
      end if
      if (allocated(error)) return
      dynamic%confidence = options%confidence
      dynamic%tau = real(dynamic%m, dp)*sample_interval
      k = size(dynamic%m, kind=int64)
      stat = merge(0, 1, segments <= huge(1_int64)/(64*k))
      if (stat == 0) allocate (dynamic%start(segments), stat=stat)
      if (stat == 0) allocate (dynamic%deviation(k, segments), stat=stat)
      if (stat == 0) allocate (dynamic%lower(k, segments), stat=stat)
      if (stat == 0) allocate (dynamic%upper(k, segments), stat=stat)
      if (stat == 0) allocate (dynamic%edf(k, segments), stat=stat)
      if (stat == 0) allocate (dynamic%terms(k, segments), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the deviations of so many segments and averaging times")
         return
      end if
      do i = 1, segments
         dynamic%start(i) = real((i - 1)*dynamic%step_samples, dp)*sample_interval
      end do
   end subroutine allocate_result

   !> Deviations and terms of all segments.
   subroutine compute_segments(phase, missing, min_coverage, dynamic, error)
      !> Integral of the record: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n], unallocated when every sample is there
      integer(int32), allocatable, intent(in) :: missing(:)
      !> Share of a window that must be present
      real(dp), intent(in) :: min_coverage
      !> Its deviations and terms are set
      type(dynamic_type), intent(inout) :: dynamic
      !> no_memory
      type(error_type), allocatable, intent(out) :: error

      type(error_type), allocatable :: trouble
      integer(int64) :: j, first
      integer :: failed

      failed = 0
      !$omp parallel do schedule(dynamic) private(first, trouble) reduction(+:failed) if (size(dynamic%start) >= parallel_from)
      do j = 1, size(dynamic%start, kind=int64)
         first = 1 + (j - 1)*dynamic%step_samples
         call segment_variances(phase, missing, first, first + dynamic%segment_samples - 1, dynamic%m, min_coverage, &
            & dynamic%deviation(:, j), dynamic%terms(:, j), trouble)
         if (allocated(trouble)) failed = failed + 1
         dynamic%deviation(:, j) = sqrt(max(dynamic%deviation(:, j), 0.0_dp))
      end do
      !$omp end parallel do
      if (failed > 0) call fatal_error(error, status%no_memory, "no memory for the Allan variances of a segment")
   end subroutine compute_segments

   !> Degrees of freedom and limits.
   subroutine set_limits(alpha, dynamic)
      !> Noise exponent at each averaging time
      integer, intent(in) :: alpha(:)
      !> Its limits are set
      type(dynamic_type), intent(inout) :: dynamic

      real(dp) :: edf
      integer(int64) :: complete
      integer :: i

      dynamic%lower = 0
      dynamic%upper = 0
      do i = 1, size(alpha)
         edf = statistic_edf("oadev", dynamic%segment_samples + 1, dynamic%m(i), alpha(i))
         complete = term_count("oadev", dynamic%segment_samples, dynamic%m(i))
         dynamic%edf(i, :) = edf*real(dynamic%terms(i, :), dp)/real(complete, dp)
         where (dynamic%terms(i, :) == 0) dynamic%deviation(i, :) = 0
      end do
      call chi_square_limits(dynamic%deviation, dynamic%edf, dynamic%confidence, dynamic%lower, dynamic%upper)
   end subroutine set_limits

end module gyroakf_allan_dynamic
