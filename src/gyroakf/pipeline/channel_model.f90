! SPDX-License-Identifier: MIT
!> The AR model of one channel, and the one that the paper's filters take.
module gyroakf_pipeline_channel_model
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, status
   use gyroakf_record, only : add_text
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_ar_model, only : ar_options, fit_ar
   use gyroakf_stats_autocovariance, only : autocovariance_type
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_pipeline_warnings, only : note_failure, warn_model, warn_order
   implicit none (type, external)
   private
   public :: run_ar

   !> An AR order is compared where there are so many samples for each
   integer(int64), parameter :: fewest_for_order = 4

contains

   !> Fits the model. The paper compares the orders from 1 on: the best of them, where order 0 would
   !> win.
   subroutine run_ar(job, channel, shared, error)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> `ar` and `filter_ar` are filled, or the failure noted
      type(channel_result_type), intent(inout) :: channel
      !> Of the cleaned series, as far as the orders need them
      type(autocovariance_type), intent(in) :: shared
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      type(ar_options) :: asked, fixed
      integer :: first

      asked = job%options%ar
      if (asked%order < 0) asked%max_order = int(min(int(asked%max_order, int64), &
                                                     channel%cleaned%count/fewest_for_order))
      call fit_ar(job%z, asked, channel%ar, error, job%valid, shared, job%progress)
      if (.not. allocated(error) .and. job%options%preset == "paper" .and. &
          channel%ar%order == 0) then
         fixed = asked
         fixed%order = 1
         first = lbound(channel%ar%table, 1) + 1
         associate (others => channel%ar%table(first:))
            if (size(others) > 0) fixed%order = others(minloc(others%aic, dim=1))%order
         end associate
         call fit_ar(job%z, fixed, channel%ar, error, job%valid, progress=job%progress)
      end if
      channel%available%ar = .not. allocated(error)
      call note_failure(channel, "AR model", error)
      if (.not. channel%available%ar) return
      if (channel%ar%variance > 0.0_dp) channel%predictable_percent = &
         100.0_dp*(1.0_dp - channel%ar%noise_variance/channel%ar%variance)
      call warn_order(channel, asked%max_order < job%options%ar%max_order, asked%max_order)
      call choose_filter_model(job, asked, channel, error)
      if (.not. allocated(error)) call warn_model(channel)
   end subroutine run_ar

   !> Sets the filters' model. Least squares can give a model that is not stationary; a filter of it
   !> would diverge, and takes the Yule-Walker model of the same order instead, with a warning.
   subroutine choose_filter_model(job, options, channel, error)
      type(job_type), intent(in) :: job
      type(ar_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled; after any other failure the model stays the one that was chosen
      type(error_type), allocatable, intent(out) :: error
      type(ar_options) :: stable

      channel%filter_ar = channel%ar
      if (channel%ar%stationary) return
      stable = options
      stable%method = "yw"
      stable%order = channel%ar%order
      call fit_ar(job%z, stable, channel%filter_ar, error, job%valid, progress=job%progress)
      call add_text(channel%warnings, "AR("//integer_text(int(channel%ar%order, int64))//") by "// &
         trim(channel%ar%method)//" is not stationary, its largest root has the modulus "// &
         format_real(channel%ar%root(1)%modulus, 6)//": the series drifts or grows, the model "// &
         "predicts but does not describe it; the paper's filters take the Yule-Walker model of "// &
         "the same order")
      if (.not. allocated(error)) return
      if (any(error%code == [status%no_memory, status%cancelled])) return
      channel%filter_ar = channel%ar
      deallocate (error)
   end subroutine choose_filter_model

end module gyroakf_pipeline_channel_model
