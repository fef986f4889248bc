! SPDX-License-Identifier: MIT
!> The true drift that --truth names: written by simulate, read by run and filter.
module gyroakf_app_truth
   use gyroakf_error, only : error_type, status
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_pipeline, only : check_truth
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_app_config, only : analysis_config
   implicit none (type, external)
   private
   public :: read_truth

contains

   !> Reads the true drift and checks that it fits the record.
   !>
   !> It is on the record's grid: --rate, --dt, --from and --to hold for it too. Its unit is that of its header, else the record's.
   subroutine read_truth(config, record, truth, error, progress)
      !> Its `truth` is allocated
      type(analysis_config), intent(in) :: config
      !> What is filtered
      type(record_type), intent(in) :: record
      !> The true drift
      type(record_type), intent(out) :: truth
      !> As of [[read_record]]; data: it does not fit
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout) :: progress
      type(reader_options) :: reader

      reader%rate_hz = config%reader%rate_hz
      reader%from = config%reader%from
      reader%to = config%reader%to
      reader%memory = config%reader%memory
      call read_record(config%truth, reader, truth, error, progress)
      if (.not. allocated(error)) call check_truth(truth, record, error)
      if (.not. allocated(error)) return
      if (error%code == status%invalid_argument) error%message = config%truth//": "//error%message
   end subroutine read_truth

end module gyroakf_app_truth
