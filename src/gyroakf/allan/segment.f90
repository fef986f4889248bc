! SPDX-License-Identifier: MIT
!> Overlapping Allan variances of a part of a record, from the integral of the whole.
!>
!> A second difference does not see where the integral began nor which mean was taken out: a part of
!> the record needs no integral and no copy of its own.
module gyroakf_allan_segment
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : error_type
   use gyroakf_allan_gaps, only : gapped_variances
   use gyroakf_allan_phase_difference, only : sum_phase_differences
   use gyroakf_allan_statistic, only : term_count, variance_divisor
   implicit none (type, external)
   private
   public :: segment_variances

contains

   !> Variances of the samples `first` .. `last`.
   subroutine segment_variances(phase, missing, first, last, m, min_coverage, variance, share, &
      & error, progress)
      !> Integral of the whole record, from [[integrate_rate]]: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n], unallocated when every sample is there
      integer(int32), allocatable, intent(in) :: missing(:)
      !> The part: 1 <= first, last <= n, at least two samples
      integer(int64), intent(in) :: first, last
      !> Averaging factors, ascending, 1 <= m <= half the samples of the part
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present
      real(dp), intent(in) :: min_coverage
      !> Variances, 0 without terms: [size(m)]
      real(dp), intent(out) :: variance(:)
      !> Degrees of freedom as a share of those of a complete part: [size(m)]
      real(dp), intent(out) :: share(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      integer(int64) :: terms(size(m))

      if (allocated(missing)) then
         if (missing(last) > missing(first - 1)) then
            call gapped_variances("oadev", phase(first - 1:last), missing(first - 1:last), m, &
               & min_coverage, variance, terms, share, error, progress)
            return
         end if
      end if
      share = 1
      terms = term_count("oadev", last - first + 1, m)
      call sum_phase_differences(phase(first - 1:last), m, 2, variance, error, progress)
      if (allocated(error)) return
      variance = variance/(variance_divisor("oadev", m)*real(terms, dp))
   end subroutine segment_variances

end module gyroakf_allan_segment
