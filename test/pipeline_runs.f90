! SPDX-License-Identifier: MIT
!> Records, and the main job over them, for its tests.
module pipeline_runs
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, paper_seed
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, channel_result_type, run_pipeline
   implicit none (type, external)
   private
   public :: paper_record, walking_record, run, says, variance

contains

   !> The record of the paper.
   subroutine paper_record(record)
      type(record_type), intent(out) :: record
      type(gyro_error), allocatable :: failed

      call simulate_record(paper_preset(paper_seed), record, failed)
   end subroutine paper_record

   !> Runs with the defaults of the program; false where that failed.
   logical function run(record, result, options)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(out) :: result
      type(pipeline_options), intent(in), optional :: options
      type(gyro_error), allocatable :: failed
      type(pipeline_options) :: defaults

      if (present(options)) defaults = options
      call run_pipeline(record, defaults, result, failed)
      run = .not. allocated(failed)
   end function run

   !> A record of a random walk and white noise, on a level of 3, with lost samples.
   subroutine walking_record(record)
      type(record_type), intent(out) :: record
      type(simulate_options) :: options
      type(gyro_error), allocatable :: failed

      options%samples = 20000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%coefficient(4) = 2.0e-3_dp
      options%offset = 3.0_dp
      options%missing = 0.01_dp
      call simulate_record(options, record, failed)
   end subroutine walking_record

   !> Whether one of the warnings holds a text.
   logical function says(channel, text)
      type(channel_result_type), intent(in) :: channel
      character(*), intent(in) :: text
      integer :: i

      says = .false.
      if (.not. allocated(channel%warnings)) return
      do i = 1, size(channel%warnings)
         says = says .or. index(channel%warnings(i)%text, text) > 0
      end do
   end function says

   pure real(dp) function variance(x)
      real(dp), intent(in) :: x(:)

      variance = sum((x - sum(x)/size(x))**2)/(size(x) - 1)
   end function variance

end module pipeline_runs
