! SPDX-License-Identifier: MIT
!> A curve of the Allan family, and what fills it.
module gyroakf_allan_curve
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_difference_kurtosis, only : find_kurtosis
   use gyroakf_allan_statistic, only : statistic_edf
   implicit none (type, external)
   private
   public :: allan_curve_type, fill_curve, fill_limits, fill_octaves

   !> What a noise fit needs of a record: its overlapping Allan variances at m = 1, 2, 4, ... up to
   !> a quarter of it
   type :: octaves_type
      !> Averaging factors
      integer(int64), allocatable :: m(:)
      !> Variances; excess kurtosis of the white noise per sample as seen at each factor; degrees of
      !> freedom as a share of those of a complete record
      real(dp), allocatable :: variance(:), kurtosis(:), share(:)
   end type octaves_type

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
      !> Averaging factors that are not in the curve: missing samples leave no term
      integer(int64), allocatable :: left_out(:)
      !> Averaging times in seconds; deviation and its limits in the unit of the rate; equivalent
      !> degrees of freedom
      real(dp), allocatable :: tau(:), deviation(:), lower(:), upper(:), edf(:)
      !> Exponent of the power-law noise that dominates (2 quantization, 0 white, -1 flicker, -2
      !> random walk)
      integer, allocatable :: alpha(:)
      !> Degrees of freedom that the terms have of those of a complete record, below 1 where samples
      !> are missing or terms left out
      real(dp), allocatable :: share(:)
      !> For [[fit_noise]], whatever the averaging times are; filled where kind is "oadev"
      type(octaves_type) :: octaves
   end type allan_curve_type

contains

   !> Puts the averaging times that have terms into the curve.
   subroutine fill_curve(m, variance, terms, share, curve, error)
      !> Averaging factors, and how many terms each has
      integer(int64), intent(in) :: m(:), terms(:)
      !> Their variances (tdev: those of mdev); degrees of freedom as a share of those of a complete
      !> record
      real(dp), intent(in) :: variance(:), share(:)
      !> The curve, of which kind and sample interval are known; without exponents and limits
      type(allan_curve_type), intent(inout) :: curve
      !> too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error

      logical :: there(size(m))
      integer :: points, stat

      there = terms > 0
      points = count(there)
      curve%left_out = pack(m, .not. there)
      if (points == 0) then
         call fatal_error(error, status%too_few_samples, &
            & "too many samples are missing: no averaging time has a complete window")
         return
      end if
      allocate (curve%m(points), stat=stat)
      if (stat == 0) allocate (curve%terms(points), stat=stat)
      if (stat == 0) allocate (curve%tau(points), stat=stat)
      if (stat == 0) allocate (curve%deviation(points), stat=stat)
      if (stat == 0) allocate (curve%lower(points), stat=stat)
      if (stat == 0) allocate (curve%upper(points), stat=stat)
      if (stat == 0) allocate (curve%edf(points), stat=stat)
      if (stat == 0) allocate (curve%alpha(points), stat=stat)
      if (stat == 0) allocate (curve%share(points), stat=stat)
      call check_memory(stat, "the Allan curve", error)
      if (allocated(error)) return
      curve%m(:) = pack(m, there)
      curve%terms(:) = pack(terms, there)
      curve%share(:) = pack(share, there)
      curve%tau(:) = real(curve%m, dp)*curve%sample_interval
      curve%deviation(:) = sqrt(pack(variance, there))
      if (curve%kind == "tdev") curve%deviation(:) = curve%tau*curve%deviation/sqrt(3.0_dp)
   end subroutine fill_curve

   !> Degrees of freedom and limits from the identified noise.
   subroutine fill_limits(curve)
      !> A curve with exponents
      type(allan_curve_type), intent(inout) :: curve
      integer :: i

      do i = 1, size(curve%m)
         curve%edf(i) = curve%share(i)*statistic_edf(curve%kind, curve%samples + 1, curve%m(i), &
            & curve%alpha(i))
      end do
      call chi_square_limits(curve%deviation, curve%edf, curve%confidence, curve%lower, curve%upper)
   end subroutine fill_limits

   !> What a fit needs of a record.
   subroutine fill_octaves(phase, missing, m, variance, share, octaves)
      !> Phase, and missing samples so far where there are any: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), allocatable, intent(in) :: missing(:)
      !> Averaging factors, the octaves among them
      integer(int64), intent(in) :: m(:)
      !> Their variances; degrees of freedom as a share of those of a complete record
      real(dp), intent(in) :: variance(:), share(:)
      type(octaves_type), intent(out) :: octaves
      logical :: mask(size(m))
      integer(int64) :: n

      n = ubound(phase, 1, kind=int64)
      mask = popcnt(m) == 1 .and. m <= max(1_int64, n/4) .and. share > 0
      octaves%m = pack(m, mask)
      octaves%variance = pack(variance, mask)
      octaves%share = pack(share, mask)
      allocate (octaves%kurtosis(size(octaves%m)))
      call find_kurtosis(phase, octaves%m, octaves%variance, octaves%kurtosis, missing)
   end subroutine fill_octaves

end module gyroakf_allan_curve
