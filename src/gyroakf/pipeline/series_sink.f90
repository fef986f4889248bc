! SPDX-License-Identifier: MIT
!> Who takes the series of a recording that goes by in blocks: filtered samples are not kept, they are handed on.
module gyroakf_pipeline_series_sink
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   implicit none (type, external)
   private
   public :: series_sink_type

   !> Somebody who wants the series
   type, abstract :: series_sink_type
   contains
      procedure(take_interface), deferred :: take
   end type series_sink_type

   abstract interface
      !> Called with the next samples, in order.
      subroutine take_interface(self, block, part, before, samples, error)
         import :: error_type, int64, pipeline_result_type, record_type, series_sink_type
         implicit none (type, external)
         !> Keeps what it likes from call to call
         class(series_sink_type), intent(inout) :: self
         !> As read: samples, marks, names, interval
         type(record_type), intent(in) :: block
         !> Of every channel its name, `available%kf` and `%akf`, `series_cleaned`, `series_kf`, `series_akf`,
         !> `series_drift_kf`, `series_drift_akf`, `series_present`; where there is a smoother `series_drift`, `series_compensated`
         type(pipeline_result_type), intent(in) :: part
         !> Samples before these, and all that there will be
         integer(int64), intent(in) :: before, samples
         !> Allocated where it can take no more: the work ends with this error
         type(error_type), allocatable, intent(out) :: error
      end subroutine take_interface
   end interface

end module gyroakf_pipeline_series_sink
