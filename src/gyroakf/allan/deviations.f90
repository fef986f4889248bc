! SPDX-License-Identifier: MIT
!> Deviations of the Allan family, of a record of rates or of phases (angles).
!>
!>     type(allan_options) :: options
!>     type(allan_curve_type) :: curve
!>     options%kind = "mdev"
!>     call compute_allan(rate, sample_interval, options, curve, error)
!>     call compute_allan_from_phase(angle, sample_interval, options, curve, error)
!>
!> With x_0 = 0, x_k the sum of the first k rates less their mean (n rates: n + 1 phases),
!> and T terms, m the averaging factor, tau = m t0:
!>
!> $$ \mathrm{oadev}^2 = \frac{1}{2 m^2 T} \sum_{k=0}^{n-2m} (x_{k+2m} - 2 x_{k+m} + x_k)^2, \quad
!>    \mathrm{ohdev}^2 =
!>    \frac{1}{6 m^2 T} \sum_{k=0}^{n-3m} (x_{k+3m} - 3 x_{k+2m} + 3 x_{k+m} - x_k)^2 $$
!>
!> adev and hdev are the same with k = 0, m, 2m ... (the Hadamard deviations do not see a steady
!> drift of the rate);
!>
!> $$ \mathrm{mdev}^2 = \frac{1}{2 m^4 T} \sum_{j=0}^{n-3m+1}
!>    \Bigl( \sum_{i=j}^{j+m-1} (x_{i+2m} - 2 x_{i+m} + x_i) \Bigr)^2,
!>    \quad \mathrm{tdev} = \frac{\tau}{\sqrt 3} \mathrm{mdev} $$
!>
!> (tdev in the unit of the rate times seconds), and the total deviation over the phase x* continued
!> by odd reflection
!>
!> $$ \mathrm{totdev}^2 =
!>    \frac{1}{2 m^2 (n - 1)} \sum_{k=1}^{n-1} (x^*_{k+m} - 2 x^*_k + x^*_{k-m})^2 $$
!>
!> as it is, without correction of its bias: the expectation is that of oadev^2 times
!> 1 - a tau/(n t0), a = 0, 1/(3 ln 2) and 0.750 for white, flicker and random-walk rate noise.
!>
!> The kernels: oadev, ohdev, totdev [[sum_phase_differences]]; mdev, tdev [[sum_phase_averages]];
!> adev, hdev and records with gaps [[sum_windows]]; [[allan_variances]] chooses.
!>
!> Source: W. J. Riley, D. A. Howe, "Handbook of frequency stability analysis", NIST SP 1065 (2008),
!> section 5.2. Missing samples: [[allan_variances]].
module gyroakf_allan_deviations
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_error, only : check_memory, check_sample_interval, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_allan_block_sums, only : block_sums_type, sum_blocks
   use gyroakf_allan_curve, only : allan_curve_type, fill_curve, fill_limits, fill_octaves
   use gyroakf_allan_variances, only : allan_variances
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_noise_identification, only : identify_noise
   use gyroakf_allan_phase, only : integrate_blocks, level_phase
   use gyroakf_allan_statistic, only : check_statistic, difference_order, longest_factor
   use gyroakf_allan_thin_phase, only : thinning_index, fill_from_few_phases
   implicit none (type, external)
   private
   public :: allan_options, allan_curve_type, compute_allan, compute_allan_from_phase

   !> What to compute
   type :: allan_options
      !> The kind, "adev", "oadev" (overlapping Allan deviation), "mdev", "tdev", "hdev", "ohdev"
      !> or "totdev"
      character(8) :: kind = "oadev"
      !> Averaging times: "octave" (also when unallocated), "decade", "log:N", "all", or seconds
      !> separated by commas
      character(:), allocatable :: taus
      !> Probability between the limits, > 0, < 1
      real(dp) :: confidence = 0.683_dp
      !> Share of a window that must be present, > 0, <= 1, but for scattered losses
      !> ([[window_coverage]]); 1 demands complete windows
      real(dp) :: min_coverage = 0.9_dp
   end type allan_options

contains

   !> Deviation curve of a rate record with chi-square confidence limits.
   !>
   !> The degrees of freedom are those of the power-law noise identified at each averaging time
   !> (Greenhall & Riley 2003), reduced by the share of terms lost to gaps; [[fit_noise]] replaces
   !> those of the overlapping Allan deviation by those of the fitted mixture. Cost: three passes
   !> and O(n) per averaging time; memory 8 bytes a sample, 12 where some are missing.
   subroutine compute_allan(rate, sample_interval, options, curve, error, valid, progress)
      !> Rate samples, evenly spaced: [n], n >= 2 (3 for the Hadamard deviations); NaN and infinity
      !> count as missing
      real(dp), intent(in), contiguous :: rate(:)
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> Statistic, grid, confidence, coverage
      type(allan_options), intent(in) :: options
      !> The curve; averaging times at which no term is left are not in it but in its `left_out`
      type(allan_curve_type), intent(out) :: curve
      !> invalid_argument, not_supported (unknown kind), too_few_samples, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]; all present if absent
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(block_sums_type) :: blocks
      real(dp), allocatable :: phase(:)
      integer(int32), allocatable :: missing(:)
      integer(int64), allocatable :: m(:)
      integer :: place

      call check_arguments(sample_interval, options, error)
      if (.not. allocated(error)) call choose_factors(options, size(rate, kind=int64), &
         & sample_interval, m, error)
      if (.not. allocated(error)) call report_progress("Allan deviation", 0_int64, 0_int64, error, &
         & progress)
      if (.not. allocated(error)) call sum_blocks(rate, blocks, error, valid)
      if (allocated(error)) return
      call begin_curve(options, size(rate, kind=int64), sample_interval, curve)
      place = 0
      if (any(options%kind == ["adev", "hdev"]) .and. all(blocks%absent == 0)) then
         place = thinning_index(size(rate, kind=int64), m)
      end if
      if (place > 0) then
         call fill_from_few_phases(rate, blocks, m, place, options%min_coverage, curve, error, &
            & progress)
      else
         call integrate_blocks(rate, blocks, phase, missing, error, valid, progress)
         if (.not. allocated(error)) call curve_of_phase(phase, missing, m, options, curve, error, &
            & progress)
      end if
   end subroutine compute_allan

   !> The same from phases (angles of a rate gyroscope): the integral of the rate at the ends of the
   !> sample intervals.
   !>
   !> The straight line through the first and the last phase is taken out before anything else.
   !> Memory 8 bytes a phase.
   subroutine compute_allan_from_phase(phase, sample_interval, options, curve, error)
      !> Phases, evenly spaced: [n + 1], n >= 2, all finite, in the unit of the rate times seconds
      real(dp), intent(in), contiguous :: phase(:)
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> Statistic, grid, confidence
      type(allan_options), intent(in) :: options
      !> The curve
      type(allan_curve_type), intent(out) :: curve
      !> invalid_argument, non_finite, not_supported (unknown kind), too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error

      real(dp), allocatable :: level(:)
      integer(int32), allocatable :: missing(:)
      integer(int64), allocatable :: m(:)

      call check_arguments(sample_interval, options, error)
      if (.not. allocated(error)) call choose_factors(options, max(size(phase, kind=int64) - 1, &
         & 0_int64), sample_interval, m, error)
      if (.not. allocated(error)) call level_phase(phase, sample_interval, level, error)
      if (allocated(error)) return
      call begin_curve(options, size(phase, kind=int64) - 1, sample_interval, curve)
      call curve_of_phase(level, missing, m, options, curve, error)
   end subroutine compute_allan_from_phase

   !> Averaging factors that the statistic can have.
   subroutine choose_factors(options, samples, sample_interval, m, error)
      type(allan_options), intent(in) :: options
      integer(int64), intent(in) :: samples
      real(dp), intent(in) :: sample_interval
      integer(int64), allocatable, intent(out) :: m(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), allocatable :: grid(:)
      character(:), allocatable :: taus
      integer :: points, stat

      taus = "octave"
      if (allocated(options%taus)) taus = options%taus
      call averaging_factors(taus, samples, sample_interval, grid, error)
      if (allocated(error)) return
      points = count(grid <= longest_factor(options%kind, samples))
      if (points == size(grid)) then
         call move_alloc(grid, m)
      else if (points > 0) then
         allocate (m(points), stat=stat)
         if (stat == 0) m(:) = grid(:points)
         call check_memory(stat, "the averaging factors", error)
      else
         call fatal_error(error, status%too_few_samples, &
            & "no averaging time is short enough for the "//trim(options%kind)//" of this record")
      end if
   end subroutine choose_factors

   !> What the arguments say of the curve.
   pure subroutine begin_curve(options, samples, sample_interval, curve)
      type(allan_options), intent(in) :: options
      integer(int64), intent(in) :: samples
      real(dp), intent(in) :: sample_interval
      type(allan_curve_type), intent(inout) :: curve

      curve%kind = options%kind
      curve%samples = samples
      curve%sample_interval = sample_interval
      curve%confidence = options%confidence
   end subroutine begin_curve

   !> The curve from the integral of the record.
   subroutine curve_of_phase(phase, missing, m, options, curve, error, progress)
      !> Phase in units of rate times sample: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n], unallocated when every sample is there
      integer(int32), allocatable, intent(in) :: missing(:)
      integer(int64), intent(in) :: m(:)
      type(allan_options), intent(in) :: options
      type(allan_curve_type), intent(inout) :: curve
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      real(dp), allocatable :: variance(:), share(:)
      integer(int64), allocatable :: terms(:), all_m(:)
      logical, allocatable :: shown(:)
      integer :: stat

      call add_octaves(options%kind, ubound(phase, 1, kind=int64), m, all_m, shown)
      allocate (variance(size(all_m)), stat=stat)
      if (stat == 0) allocate (terms(size(all_m)), stat=stat)
      if (stat == 0) allocate (share(size(all_m)), stat=stat)
      call check_memory(stat, "the Allan variances", error)
      if (allocated(error)) return
      call allan_variances(options%kind, phase, all_m, options%min_coverage, variance, terms, &
         & share, error, missing, progress)
      if (allocated(error)) return
      if (options%kind == "oadev") call fill_octaves(phase, missing, all_m, variance, share, &
         & curve%octaves)
      call fill_curve(pack(all_m, shown), pack(variance, shown), pack(terms, shown), &
         & pack(share, shown), curve, error)
      if (allocated(error)) return
      call identify_noise(phase, curve%m, options%min_coverage, curve%alpha, error, missing, &
         & difference_order(curve%kind))
      call fill_limits(curve)
   end subroutine curve_of_phase

   !> The averaging factors to be computed: those that are shown, and for the overlapping Allan
   !> deviation the octaves.
   pure subroutine add_octaves(kind, samples, m, all_m, shown)
      character(*), intent(in) :: kind
      integer(int64), intent(in) :: samples, m(:)
      integer(int64), allocatable, intent(out) :: all_m(:)
      logical, allocatable, intent(out) :: shown(:)
      integer(int64) :: octave
      integer :: below

      all_m = m
      shown = spread(.true., 1, size(m))
      octave = 1
      do while (kind == "oadev" .and. octave <= max(1_int64, samples/4))
         if (.not. any(all_m == octave)) then
            below = count(all_m < octave)
            all_m = [all_m(:below), octave, all_m(below + 1:)]
            shown = [shown(:below), .false., shown(below + 1:)]
         end if
         octave = 2*octave
      end do
   end subroutine add_octaves

   !> Rejects what is out of range.
   subroutine check_arguments(sample_interval, options, error)
      real(dp), intent(in) :: sample_interval
      type(allan_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error

      call check_statistic(options%kind, error)
      if (.not. allocated(error)) call check_sample_interval(sample_interval, error)
      if (allocated(error)) return
      if (.not. (options%confidence > 0 .and. options%confidence < 1)) then
         call fatal_error(error, status%invalid_argument, "the confidence must lie between 0 and 1")
      else if (.not. (options%min_coverage > 0 .and. options%min_coverage <= 1)) then
         call fatal_error(error, status%invalid_argument, &
            & "the coverage of a window must be above 0 and at most 1")
      end if
   end subroutine check_arguments

end module gyroakf_allan_deviations
