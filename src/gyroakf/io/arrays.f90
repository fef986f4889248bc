! SPDX-License-Identifier: MIT
!> A recording of samples that are in memory already.
module gyroakf_io_arrays
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_io_audit, only : audit_values
   use gyroakf_io_channel_units, only : set_units
   use gyroakf_io_shape, only : mark_missing, largest_value, refuse_tiny
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : record_type
   implicit none (type, external)
   private
   public :: finish_record

contains

   !> Makes a recording of values and names: marks what is missing, sets rate and units, counts what a reader counts.
   subroutine finish_record(sample_interval, unit, record, error, progress)
      !> s, > 0, finite
      real(dp), intent(in) :: sample_interval
      !> "deg/s" for all channels, or one for each, separated by commas; "": unknown
      character(*), intent(in) :: unit
      !> Its `value` is there, NaN where missing, and the names of its `channel`; the rest is filled
      type(record_type), intent(inout) :: record
      !> invalid_argument (the interval, a unit that is unknown or none of a rate), non_finite (a value beyond 1e60), no_memory,
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(table_type) :: nothing
      logical :: good

      good = ieee_is_finite(sample_interval)
      if (good) good = sample_interval > 0.0_dp
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, "the sample interval must be a finite number above 0")
         return
      end if
      record%path = "<memory>"
      record%format = "array"
      record%stored_type = "float64"
      record%sample_interval = sample_interval
      record%rate_known = .true.
      record%rate_source = "option"
      record%unit%name = ""
      record%unit_source = "none"
      if (unit /= "") call set_units(unit, "rate", nothing, record, error)
      if (.not. allocated(error)) call mark_missing(record, largest_value, error, progress=progress)
      if (.not. allocated(error)) call audit_values(record%value, record%present, record%audit, error, progress)
      if (.not. allocated(error)) call refuse_tiny(record, error)
      if (allocated(error)) return
      allocate (record%audit%line_of_first(3), source=0_int64)
   end subroutine finish_record

end module gyroakf_io_arrays
