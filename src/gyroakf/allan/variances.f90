! SPDX-License-Identifier: MIT
!> Allan-family variances, of complete records and of records with missing samples.
!>
!> With missing samples the mean of a window is taken over those that are there, and a term counts
!> when each of its windows is complete enough ([[window_coverage]]). The mean of c out of m samples
!> is uncertain by the sampling variance S^2 (1/c - 1/m), S^2 the variance of the samples within a
!> window (sampling without replacement; for white noise it is its variance). What that adds to the
!> variance is subtracted. Two windows (Allan):
!>
!> $$ \hat\sigma^2 = \frac{1}{2T} \sum (\bar w_2 - \bar w_1)^2 -
!>    \frac{S_m^2}{2T} \sum \left(\frac{1}{c_1} + \frac{1}{c_2} - \frac{2}{m}\right) $$
!>
!> and three (Hadamard), with 6 instead of 2 and 1/c_1 + 4/c_2 + 1/c_3 - 6/m. In general the bracket
!> is the variance of a term in white noise of variance 1, less that of a complete record: for the
!> modified variance see [[gyroakf_allan_averaged_difference]], for the total variance
!> [[gyroakf_allan_reflection]]. White noise stays unbiased; drift hardly varies within a window and
!> is not touched. The total variance alone loses some of a random walk to a gap, whose terms weigh
!> more than those near the ends: 2 % of the variance at T/16, 17 % at T/5 where a gap of a tenth
!> takes half of the terms. An averaging time is left out of it where less than half of the weight
!> remains. S_m^2 follows from the overlapping Allan variances of the octaves below m: for m = 2^J
!> it is the sum over j < J of sigma^2(2^j) times m/(2(m - 1)).
module gyroakf_allan_variances
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_allan_averaged_difference, only : sum_phase_averages
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_phase_difference, only : sum_phase_differences
   use gyroakf_allan_reflection, only : add_reflections, complete_weight
   use gyroakf_allan_statistic, only : difference_order, term_count, variance_divisor
   use gyroakf_allan_window_difference, only : window_sums_type, sum_windows
   implicit none (type, external)
   private
   public :: allan_variances, window_coverage

   !> Share of a gapped variance that the correction leaves at least
   real(dp), parameter :: correction_floor = 0.1_dp
   !> Share of the weight of a total variance that must be left: the terms near an end hold little
   !> of a random walk
   real(dp), parameter :: weight_least = 0.5_dp
   !> Gaps of at most this share of a window, or of one sample, are scattered
   integer(int64), parameter :: scattered_part = 8

contains

   !> Share of a window of m samples that must be present.
   !>
   !> It is `min_coverage` of what scattered losses leave of the record, rounded to whole samples:
   !> these are a random sample of the window, whose mean is corrected for, whatever the noise.
   !> Scattered are gaps of at most m/8 samples, and single samples. A `min_coverage` of 1 demands
   !> complete windows.
   pure subroutine window_coverage(missing, m, min_coverage, coverage)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> Share of a window without scattered losses, > 0, <= 1
      real(dp), intent(in) :: min_coverage
      !> At most `min_coverage`: [size(m)]
      real(dp), intent(out) :: coverage(:)
      integer(int64) :: lost(0:bit_size(0_int64)), i, gap, n
      real(dp) :: scattered
      integer :: j, shortest

      n = ubound(missing, 1, kind=int64)
      ! samples in gaps of more than 2**(j - 1), up to 2**j samples
      lost = 0
      gap = 0
      do i = 1, n
         if (missing(i) > missing(i - 1)) then
            gap = gap + 1
         else if (gap > 0) then
            j = int(bit_size(gap)) - leadz(gap - 1)
            lost(j) = lost(j) + gap
            gap = 0
         end if
      end do
      if (gap > 0) lost(bit_size(gap)) = gap
      coverage = min_coverage
      if (min_coverage >= 1) return
      do j = 1, size(m)
         shortest = int(bit_size(gap)) - leadz(max(1_int64, m(j)/scattered_part)) - 1
         scattered = real(sum(lost(:shortest)), dp)
         scattered = scattered/max(1.0_dp, real(n - sum(lost), dp) + scattered)
         coverage(j) = min(min_coverage, &
            & max(1.0_dp, anint(min_coverage*(1 - scattered)*real(m(j), dp)))/real(m(j), dp))
      end do
   end subroutine window_coverage

   !> Variances of a record; with missing samples the inflation by those that are not there removed.
   subroutine allan_variances(kind, phase, m, min_coverage, variance, terms, share, error, &
      & missing, progress)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present, but for scattered losses
      real(dp), intent(in) :: min_coverage
      !> Variances: [size(m)]; tdev: those of mdev
      real(dp), intent(out) :: variance(:)
      !> Terms used: [size(m)]
      integer(int64), intent(out) :: terms(:)
      !> Degrees of freedom of the variances as a share of those of a complete record: the share of
      !> the terms, times the square of what the correction leaves of the variance: [size(m)]
      real(dp), intent(out) :: share(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Missing samples so far: [0:n]; none are missing if absent
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(window_sums_type), allocatable :: sums(:)
      integer :: stat

      if (present(missing)) then
         call gapped_variances(kind, phase, missing, m, min_coverage, variance, terms, share, &
            & error, progress)
         return
      end if
      allocate (sums(size(m)), stat=stat)
      call check_memory(stat, "the Allan variances", error)
      if (allocated(error)) return
      share = 1
      terms = term_count(kind, ubound(phase, 1, kind=int64), m)
      select case (kind)
      case ("adev", "hdev")
         call sum_windows(phase, m, difference_order(kind), .false., sums, error, progress=progress)
      case ("mdev", "tdev")
         call sum_phase_averages(phase, m, sums, error, progress=progress)
      case default
         call sum_phase_differences(phase, m, difference_order(kind), variance, error, progress)
         sums%squares = variance
         if (kind == "totdev" .and. .not. allocated(error)) then
            call add_reflections(phase, m, sums, error, progress=progress)
         end if
      end select
      if (allocated(error)) return
      variance = sums%squares/(variance_divisor(kind, m)*real(terms, dp))
   end subroutine allan_variances

   !> Variances of a record with missing samples; arguments as of `allan_variances`.
   subroutine gapped_variances(kind, phase, missing, m, min_coverage, variance, terms, share, &
      & error, progress)
      character(*), intent(in) :: kind
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), intent(in), contiguous :: missing(0:)
      integer(int64), intent(in) :: m(:)
      real(dp), intent(in) :: min_coverage
      real(dp), intent(out) :: variance(:), share(:)
      integer(int64), intent(out) :: terms(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      type(window_sums_type), allocatable :: sums(:)
      integer(int64), allocatable :: octave(:), factor(:)
      real(dp), allocatable :: within(:), coverage(:)
      real(dp) :: divisor, raw
      integer :: i, octaves, stat
      logical :: same

      call averaging_factors("octave", ubound(phase, 1, kind=int64), 1.0_dp, octave, error)
      if (allocated(error)) return
      octaves = size(octave)
      allocate (sums(octaves), stat=stat)
      if (stat == 0) allocate (within(octaves), stat=stat)
      if (stat == 0) allocate (factor(octaves + size(m)), stat=stat)
      if (stat == 0) allocate (coverage(octaves + size(m)), stat=stat)
      call check_memory(stat, "the Allan variances", error)
      if (allocated(error)) return
      factor(:octaves) = octave
      factor(octaves + 1:) = m
      call window_coverage(missing, factor, min_coverage, coverage)
      call sum_windows(phase, octave, 2, .true., sums, error, missing, coverage(:octaves), progress)
      if (allocated(error)) return
      call variance_within_windows(sums, octave, within)
      same = kind == "oadev" .and. size(m) == octaves
      if (same) same = all(m == octave)
      if (.not. same) then
         deallocate (sums)
         allocate (sums(size(m)), stat=stat)
         call check_memory(stat, "the Allan variances", error)
         if (allocated(error)) return
         associate (coverage => coverage(octaves + 1:))
            if (any(kind == ["mdev", "tdev"])) then
               call sum_phase_averages(phase, m, sums, error, missing, coverage, progress)
            else
               call sum_windows(phase, m, difference_order(kind), all(kind /= ["adev", "hdev"]), &
                  & sums, error, missing, coverage, progress)
               if (kind == "totdev" .and. .not. allocated(error)) then
                  call add_reflections(phase, m, sums, error, missing, coverage, progress)
               end if
            end if
         end associate
         if (allocated(error)) return
      end if
      do i = 1, size(m)
         if (kind == "totdev") call divide_by_weight(ubound(phase, 1, kind=int64), m(i), sums(i))
         terms(i) = sums(i)%terms
         divisor = merge(6.0_dp, 2.0_dp, difference_order(kind) == 3)
         variance(i) = corrected(sums(i), interpolated(within, real(m(i), dp)), divisor)
         raw = sums(i)%squares/(divisor*real(max(terms(i), 1_int64), dp))
         share(i) = real(terms(i), dp)/real(term_count(kind, ubound(phase, 1, kind=int64), m(i)), &
            & dp)
         if (raw > 0) share(i) = share(i)*(variance(i)/raw)**2
      end do
   end subroutine gapped_variances

   !> Scales the sums of a total variance to be divided by the number of terms; without terms where
   !> too many are lost.
   pure subroutine divide_by_weight(samples, m, sums)
      integer(int64), intent(in) :: samples, m
      type(window_sums_type), intent(inout) :: sums
      real(dp) :: share

      share = sums%weight/complete_weight(samples, m)
      if (share < weight_least) then
         sums%terms = 0
      else
         share = real(sums%terms, dp)/(share*real(samples - 1, dp))
         sums%squares = sums%squares*share
         sums%inflation = sums%inflation*share
      end if
   end subroutine divide_by_weight

   !> Variance of the samples within windows of 1, 2, 4 ... samples, from the variances of the
   !> octaves.
   pure subroutine variance_within_windows(sums, octave, within)
      type(window_sums_type), intent(in) :: sums(:)
      integer(int64), intent(in) :: octave(:)
      !> S^2 of windows of that length; of the first, of two samples
      real(dp), intent(out) :: within(:)

      real(dp) :: total
      integer :: j

      total = 0
      within = 0
      do j = 1, size(octave)
         if (j > 1) within(j) = total*real(octave(j), dp)/(2*real(octave(j) - 1, dp))
         if (sums(j)%terms > 0) total = total + corrected(sums(j), within(j), 2.0_dp)
      end do
   end subroutine variance_within_windows

   !> Variance from the sums, less what the missing samples add.
   pure real(dp) function corrected(sums, within, divisor)
      type(window_sums_type), intent(in) :: sums
      real(dp), intent(in) :: within
      !> 2 (Allan) or 6 (Hadamard)
      real(dp), intent(in) :: divisor

      real(dp) :: raw

      corrected = 0
      if (sums%terms == 0) return
      raw = sums%squares/(divisor*real(sums%terms, dp))
      corrected = max(raw - within*sums%inflation/(divisor*real(sums%terms, dp)), &
         & correction_floor*raw)
   end function corrected

   !> Value at m between those at 1, 2, 4 ..., linear in the logarithm of m.
   pure real(dp) function interpolated(values, m)
      real(dp), intent(in) :: values(:), m
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

end module gyroakf_allan_variances
