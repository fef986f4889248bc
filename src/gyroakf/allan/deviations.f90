! SPDX-License-Identifier: MIT
!> Allan deviation of a rate record.
!>
!>     type(allan_options) :: options
!>     type(allan_curve_type) :: curve
!>     call compute_allan(rate, sample_interval, options, curve, error)
!>
!> Overlapping estimate (NIST SP 1065, equation 11) from n rates, that is n + 1 phases:
!>
!> $$ \sigma^2(m t_0) = \frac{1}{2 m^2 (n - 2m + 1)} \sum_{k=0}^{n-2m} (x_{k+2m} - 2 x_{k+m} + x_k)^2,
!>    \quad x_k = \sum_{i \le k} (w_i - \bar w) $$
!>
!> With missing samples the mean of a window is taken over those that are there, and a term counts when both
!> of its windows are complete to the share `min_coverage`. The mean of c out of m samples is uncertain by
!> the sampling variance S^2 (1/c - 1/m), S^2 the variance of the samples within a window (sampling without
!> replacement; for white noise it is its variance). What that adds to the variance is subtracted:
!>
!> $$ \hat\sigma^2 = \frac{1}{2T} \sum (\bar w_2 - \bar w_1)^2 -
!>    \frac{S_m^2}{2T} \sum \left(\frac{1}{c_1} + \frac{1}{c_2} - \frac{2}{m}\right) $$
!>
!> so that white noise stays unbiased; drift hardly varies within a window and is not touched. S_m^2 follows from the
!> variances of the octaves below m: for m = 2^J it is the sum over j < J of sigma^2(2^j) times m/(2(m - 1)).
module gyroakf_allan_deviations
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_phase, only : integrate_rate
   use gyroakf_allan_second_difference, only : sum_second_differences, sum_gapped_differences, gap_sums_type
   use gyroakf_allan_noise_identification, only : identify_noise
   use gyroakf_allan_degrees_of_freedom, only : greenhall_edf, chi_square_limits
   implicit none (type, external)
   private
   public :: allan_options, allan_curve_type, compute_allan

   !> What to compute
   type :: allan_options
      !> Statistic; only "oadev", the overlapping Allan deviation
      character(8) :: kind = "oadev"
      !> Averaging times: "octave" (also when unallocated), "decade", "log:N", "all", or seconds separated by commas
      character(:), allocatable :: taus
      !> Probability between the limits, > 0, < 1
      real(dp) :: confidence = 0.683_dp
      !> Share of a window that must be present, > 0, <= 1; 1 demands complete windows
      real(dp) :: min_coverage = 0.9_dp
   end type allan_options

   !> A deviation curve; arrays have one element per averaging time, ascending
   type :: allan_curve_type
      !> Statistic
      character(8) :: kind = "oadev"
      !> Seconds
      real(dp) :: sample_interval = 1.0_dp
      !> Samples of the record, missing ones included
      integer(int64) :: samples = 0
      !> Probability between the limits
      real(dp) :: confidence = 0.683_dp
      !> Averaging factors, and terms that were averaged
      integer(int64), allocatable :: m(:), terms(:)
      !> Averaging times in seconds; deviation and its limits in the unit of the rate; equivalent degrees of freedom
      real(dp), allocatable :: tau(:), deviation(:), lower(:), upper(:), edf(:)
      !> Exponent of the power-law noise that dominates (2 quantisation, 0 white, -1 flicker, -2 random walk)
      integer, allocatable :: alpha(:)
   end type allan_curve_type

   !> Share of a gapped variance that the correction leaves at least
   real(dp), parameter :: correction_floor = 0.1_dp

contains

   !> Overlapping Allan deviation with chi-square confidence limits.
   !>
   !> The degrees of freedom are those of the power-law noise identified at each averaging time (Greenhall &
   !> Riley 2003), reduced by the share of terms lost to gaps; [[fit_noise]] replaces them by those of the fitted mixture.
   !> Cost: three passes and O(n) per averaging time; memory 8 bytes a sample, 12 where some are missing.
   subroutine compute_allan(rate, sample_interval, options, curve, error, valid)
      !> Rate samples, evenly spaced: [n], n >= 2; NaN and infinity count as missing
      real(dp), intent(in), contiguous :: rate(:)
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> Grid, confidence, coverage
      type(allan_options), intent(in) :: options
      !> The curve; averaging times at which no term is left are not in it
      type(allan_curve_type), intent(out) :: curve
      !> invalid_argument, not_supported (kind), too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]; all present if absent
      integer(int8), intent(in), optional :: valid(:)

      real(dp), allocatable :: phase(:), variance(:)
      integer(int32), allocatable :: missing(:)
      integer(int64), allocatable :: m(:), terms(:)
      integer :: stat

      call check_arguments(sample_interval, options, error)
      if (allocated(error)) return
      if (allocated(options%taus)) then
         call averaging_factors(options%taus, size(rate, kind=int64), sample_interval, m, error)
      else
         call averaging_factors("octave", size(rate, kind=int64), sample_interval, m, error)
      end if
      if (allocated(error)) return
      allocate (variance(size(m)), stat=stat)
      if (stat == 0) allocate (terms(size(m)), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the Allan variances")
         return
      end if
      call integrate_rate(rate, phase, missing, error, valid)
      if (allocated(error)) return
      if (allocated(missing)) then
         call gapped_variances(phase, missing, m, options%min_coverage, variance, terms, error)
         if (allocated(error)) return
      else
         call sum_second_differences(phase, m, variance)
         terms = size(rate, kind=int64) - 2*m + 1
         variance = variance/(2*real(m, dp)**2*real(terms, dp))
      end if
      call fill_curve(size(rate, kind=int64), sample_interval, options%confidence, m, variance, terms, curve, error)
      if (allocated(error)) return
      call identify_noise(phase, curve%m, options%min_coverage, curve%alpha, missing)
      call fill_limits(curve)
   end subroutine compute_allan

   !> Rejects what is out of range.
   subroutine check_arguments(sample_interval, options, error)
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> Options
      type(allan_options), intent(in) :: options
      !> invalid_argument, not_supported
      type(error_type), allocatable, intent(out) :: error

      if (options%kind /= "oadev") then
         call fatal_error(error, status%not_supported, "deviation kind '"//trim(options%kind)//"' is not known; there is oadev")
      else if (.not. positive(sample_interval)) then
         call fatal_error(error, status%invalid_argument, "the sample interval must be positive and finite")
      else if (.not. (positive(options%confidence) .and. positive(1 - options%confidence))) then
         call fatal_error(error, status%invalid_argument, "the confidence must lie between 0 and 1")
      else if (.not. positive(options%min_coverage) .or. positive(options%min_coverage - 1)) then
         call fatal_error(error, status%invalid_argument, "the coverage of a window must be above 0 and at most 1")
      end if
   end subroutine check_arguments

   !> Finite and above zero.
   pure logical function positive(x)
      !> Any number
      real(dp), intent(in) :: x

      positive = .false.
      if (ieee_is_finite(x)) positive = x > 0
   end function positive

   !> Variances of a record with missing samples, the inflation by the samples that are not there removed.
   subroutine gapped_variances(phase, missing, m, min_coverage, variance, terms, error)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present
      real(dp), intent(in) :: min_coverage
      !> Variances: [size(m)]
      real(dp), intent(out) :: variance(:)
      !> Terms used: [size(m)]
      integer(int64), intent(out) :: terms(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error

      type(gap_sums_type), allocatable :: sums(:)
      integer(int64), allocatable :: octave(:)
      real(dp), allocatable :: within(:)
      integer :: i, stat

      call averaging_factors("octave", ubound(phase, 1, kind=int64), 1.0_dp, octave, error)
      if (allocated(error)) return
      allocate (sums(size(octave)), within(size(octave)))
      call sum_gapped_differences(phase, missing, octave, min_coverage, sums)
      call variance_within_windows(sums, octave, within)
      if (.not. same(m, octave)) then
         deallocate (sums)
         allocate (sums(size(m)), stat=stat)
         if (stat /= 0) then
            call fatal_error(error, status%no_memory, "no memory for the Allan variances")
            return
         end if
         call sum_gapped_differences(phase, missing, m, min_coverage, sums)
      end if
      do i = 1, size(m)
         terms(i) = sums(i)%terms
         variance(i) = corrected(sums(i), interpolated(within, real(m(i), dp)))
      end do
   end subroutine gapped_variances

   !> Whether two lists are equal.
   pure logical function same(a, b)
      !> The lists
      integer(int64), intent(in) :: a(:), b(:)

      same = size(a) == size(b)
      if (same) same = all(a == b)
   end function same

   !> Variance of the samples within windows of 1, 2, 4 ... samples, from the variances of the octaves.
   pure subroutine variance_within_windows(sums, octave, within)
      !> Sums of each octave
      type(gap_sums_type), intent(in) :: sums(:)
      !> 1, 2, 4 ...
      integer(int64), intent(in) :: octave(:)
      !> S^2 of windows of that length; of the first, of two samples
      real(dp), intent(out) :: within(:)

      real(dp) :: total
      integer :: j

      total = 0
      within = 0
      do j = 1, size(octave)
         if (j > 1) within(j) = total*real(octave(j), dp)/(2*real(octave(j) - 1, dp))
         if (sums(j)%terms > 0) total = total + corrected(sums(j), within(j))
      end do
   end subroutine variance_within_windows

   !> Variance from the sums, less what the missing samples add.
   pure real(dp) function corrected(sums, within)
      !> Sums of one averaging factor
      type(gap_sums_type), intent(in) :: sums
      !> Variance of the samples within a window
      real(dp), intent(in) :: within

      real(dp) :: raw

      corrected = 0
      if (sums%terms == 0) return
      raw = sums%squares/(2*real(sums%terms, dp))
      corrected = max(raw - within*sums%inflation/(2*real(sums%terms, dp)), correction_floor*raw)
   end function corrected

   !> Value at m between those at 1, 2, 4 ..., linear in the logarithm of m.
   pure real(dp) function interpolated(values, m)
      !> Values at the octaves
      real(dp), intent(in) :: values(:)
      !> Where, >= 1
      real(dp), intent(in) :: m

      real(dp) :: place
      integer :: j

      place = 1 + log(m)/log(2.0_dp)
      j = min(int(place), size(values) - 1)
      if (j < 1) then
         interpolated = values(1)
      else
         interpolated = values(j) + (place - j)*(values(j + 1) - values(j))
      end if
   end function interpolated

   !> Puts the averaging times that have terms into the curve.
   subroutine fill_curve(n, sample_interval, confidence, m, variance, terms, curve, error)
      !> Samples
      integer(int64), intent(in) :: n
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> Probability between the limits
      real(dp), intent(in) :: confidence
      !> Averaging factors, their variances and terms
      integer(int64), intent(in) :: m(:)
      real(dp), intent(in) :: variance(:)
      integer(int64), intent(in) :: terms(:)
      !> The curve, without limits
      type(allan_curve_type), intent(inout) :: curve
      !> too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error

      integer :: points, stat

      curve%sample_interval = sample_interval
      curve%samples = n
      curve%confidence = confidence
      points = count(terms > 0)
      if (points == 0) then
         call fatal_error(error, status%too_few_samples, "too many samples are missing: no averaging time has a complete window")
         return
      end if
      allocate (curve%lower(points), stat=stat)
      if (stat == 0) allocate (curve%upper(points), stat=stat)
      if (stat == 0) allocate (curve%edf(points), stat=stat)
      if (stat == 0) allocate (curve%alpha(points), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the Allan curve")
         return
      end if
      curve%m = pack(m, terms > 0)
      curve%terms = pack(terms, terms > 0)
      curve%tau = real(curve%m, dp)*sample_interval
      curve%deviation = sqrt(pack(variance, terms > 0))
   end subroutine fill_curve

   !> Degrees of freedom and limits from the identified noise.
   subroutine fill_limits(curve)
      !> The curve
      type(allan_curve_type), intent(inout) :: curve

      real(dp) :: complete
      integer :: i

      do i = 1, size(curve%m)
         complete = real(curve%samples - 2*curve%m(i) + 1, dp)
         curve%edf(i) = greenhall_edf(curve%samples + 1, curve%m(i), curve%alpha(i), 2, .false., .true.) &
            & *real(curve%terms(i), dp)/complete
      end do
      call chi_square_limits(curve%deviation, curve%edf, curve%confidence, curve%lower, curve%upper)
   end subroutine fill_limits

end module gyroakf_allan_deviations
