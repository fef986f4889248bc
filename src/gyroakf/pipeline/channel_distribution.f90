! SPDX-License-Identifier: MIT
!> The distribution of one channel's samples: quantization and normality.
module gyroakf_pipeline_channel_distribution
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : add_text
   use gyroakf_io_writer, only : format_real
   use gyroakf_stats_normality, only : judge_normality
   use gyroakf_stats_anderson_darling, only : test_anderson_darling, rounding_statistic
   use gyroakf_stats_quantization, only : find_quantisation, coarse_ratio
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: run_distribution, find_step

   !> Where rounding alone adds as much as this to A2, the Anderson-Darling test does not decide
   real(dp), parameter :: negligible_rounding = 0.1_dp

contains

   !> Quantisation of the record as read.
   subroutine find_step(x, channel, error, valid, progress)
      !> As read: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> `cleaned` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing or an outlier: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call report_progress("steps of the samples", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call find_quantisation(x, channel%cleaned%std, channel%quantisation, error, valid)
      if (is_fatal(error)) return
      channel%available%quantisation = .not. allocated(error)
      call note_failure(channel, "quantisation", error)
   end subroutine find_step

   !> Anderson-Darling test and verdict on normality.
   subroutine run_distribution(z, options, channel, error, valid, progress)
      !> The series that is tested: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Samples of the Anderson-Darling test
      type(pipeline_options), intent(in) :: options
      !> `quantisation` and `jarque_bera` are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing or an outlier: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call warn_coarse(channel)
      call test_anderson_darling(z, options%anderson_darling, channel%anderson_darling, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%anderson_darling = .not. allocated(error)
      call note_failure(channel, "Anderson-Darling test", error)
      call judge_distribution(channel)
   end subroutine run_distribution

   !> The verdict on normality: by the Anderson-Darling test where all samples were tested and
   !> rounding is negligible, otherwise by Jarque-Bera.
   subroutine judge_distribution(channel)
      type(channel_result_type), intent(inout) :: channel
      real(dp) :: p_value, rounding

      if (.not. channel%available%jarque_bera) return
      p_value = channel%jarque_bera%p_value
      associate (test => channel%anderson_darling)
         rounding = rounding_statistic(channel%quantisation%ratio, test%samples)
         if (channel%available%anderson_darling .and. test%stride == 1 .and. &
             rounding < negligible_rounding) p_value = test%p_value
      end associate
      channel%normality = judge_normality(channel%jarque_bera%skewness, channel%jarque_bera%kurtosis, p_value)
   end subroutine judge_distribution

   !> The step is as large as what is measured.
   subroutine warn_coarse(channel)
      type(channel_result_type), intent(inout) :: channel
      character(:), allocatable :: share

      associate (grid => channel%quantisation)
         if (grid%ratio < coarse_ratio) return
         share = format_real(100.0_dp*grid%variance_share, 2)//" % of the variance are rounding"
         if (grid%variance_share >= 1.0_dp) share = "rounding hides the noise"
         call add_text(channel%warnings, "the step of the samples, "//format_real(grid%step, 4)//", is "// &
            format_real(grid%ratio, 3)//" standard deviations of the cleaned series: "//share//", and no test of "// &
            "normality means anything; a finer range of the converter would show the sensor's noise")
      end associate
   end subroutine warn_coarse

end module gyroakf_pipeline_channel_distribution
