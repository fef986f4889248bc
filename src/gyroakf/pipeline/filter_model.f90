! SPDX-License-Identifier: MIT
!> The AR model that the paper's filters take: the one that was chosen, unless it is not stationary.
module gyroakf_pipeline_filter_model
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : error_type, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : add_text
   use gyroakf_io_writer, only : format_real
   use gyroakf_ar_model, only : ar_options, fit_ar
   use gyroakf_pipeline_result, only : channel_result_type
   implicit none (type, external)
   private
   public :: choose_filter_model

contains

   !> Sets the filters' model. Least squares can give a model that is not stationary; a filter of it would diverge, and takes
   !> the Yule-Walker model of the same order instead, with a warning.
   subroutine choose_filter_model(z, options, channel, error, valid, progress)
      !> The series that was modelled: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> How it was modelled
      type(ar_options), intent(in) :: options
      !> `ar` is filled; `filter_ar` is set, gets a warning
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled; after any other failure the model stays the one that was chosen
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(ar_options) :: stable
      character(12) :: digits

      channel%filter_ar = channel%ar
      if (channel%ar%stationary) return
      write (digits, "(i0)") channel%ar%order
      stable = options
      stable%method = "yw"
      stable%order = channel%ar%order
      call fit_ar(z, stable, channel%filter_ar, error, valid, progress=progress)
      call add_text(channel%warnings, "AR("//trim(digits)//") by "//trim(channel%ar%method)// &
                       " is not stationary, its largest root has the modulus "// &
                       format_real(channel%ar%root(1)%modulus, 6)//": the series drifts or grows, the model predicts but does "// &
                       "not describe it; the paper's filters take the Yule-Walker model of the same order")
      if (.not. allocated(error)) return
      if (any(error%code == [status%no_memory, status%cancelled])) return
      channel%filter_ar = channel%ar
      deallocate (error)
   end subroutine choose_filter_model

end module gyroakf_pipeline_filter_model
