! SPDX-License-Identifier: MIT
!> The ARMA model of a channel, where it was asked for.
module gyroakf_pipeline_arma
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_ar_arma_model, only : fit_arma
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: run_arma

contains

   !> Fits it, and states the time of the drift that it is in seconds.
   subroutine run_arma(record, z, options, channel, error, valid, progress)
      !> Sample interval
      type(record_type), intent(in) :: record
      !> Cleaned series: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> `do_arma`: asked for; `arma`: orders and criterion
      type(pipeline_options), intent(in) :: options
      !> Gets the model, or why there is none
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress

      if (.not. options%do_arma) return
      call fit_arma(z, options%arma, channel%arma, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%arma = .not. allocated(error)
      call note_failure(channel, "ARMA model", error)
      if (.not. channel%available%arma) return
      channel%arma_time = channel%arma%drift%time_constant
      channel%arma_time_error = channel%arma%drift%time_error
      if (.not. record%rate_known) return
      channel%arma_time = channel%arma_time*record%sample_interval
      channel%arma_time_error = channel%arma_time_error*record%sample_interval
   end subroutine run_arma

end module gyroakf_pipeline_arma
