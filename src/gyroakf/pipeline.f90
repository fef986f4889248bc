! SPDX-License-Identifier: MIT
!> The main job as a library call: a record in, results out; prints nothing.
!>
!>     type(pipeline_options) :: options
!>     call read_record("gyro.txt", reader_options(), record, error)
!>     call run_pipeline(record, options, result, error)
!>
!> For each channel: moments as read; outliers and trend removed; stationarity, normality and
!> whiteness of what is left; the AR model; Allan curves and coefficients as read and cleaned; the
!> paper's Kalman and adaptive Kalman filters and the curves of their outputs; the drift identified
!> from the record itself. Results do not depend on the number of threads.
module gyroakf_pipeline
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type, unit_of
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader, only : reader_options
   use gyroakf_pipeline_result, only : channel_result_type, new_channels, pipeline_options, &
      pipeline_result_type, stage
   use gyroakf_pipeline_channel, only : run_channel
   use gyroakf_pipeline_channel_job, only : channel_progress_type, job_type
   use gyroakf_pipeline_channel_tests, only : longest_part, longest_segment
   use gyroakf_pipeline_truth, only : check_truth, take_truth
   use gyroakf_pipeline_warnings, only : note_error
   implicit none (type, external)
   private
   public :: pipeline_options, pipeline_result_type, channel_result_type, stage, check_truth
   public :: apply_preset, run_pipeline, estimate_memory, minimum_samples

   !> A shorter record is an error
   integer(int64), parameter :: minimum_samples = 10_int64
   !> Errors that end one channel but not the others: its numbers alone can be their cause, as long
   !> as another channel can be done with the same options
   integer, parameter :: of_channel(2) = [status%invalid_argument, status%not_supported]

contains

   !> Sets the chain of a preset; the user's own options are put in after it.
   !>
   !> "default" leaves the options as they are; "paper" is Yi et al.: Pauta's 3 sigma until nothing
   !> is beyond it, a cubic trend, AIC over AR(1..3) by Yule-Walker (order 0, a white series, is
   !> compared too), a Kalman filter with R = Var(z), Sage-Husa on Q and R with b = 0.98 and no
   !> gate. Both filters start from Q = sigma_a^2, R = P = Var(z), x = 0 (see
   !> [[gyroakf_filter_design]]).
   subroutine apply_preset(name, options, error)
      !> "default" or "paper"
      character(*), intent(in) :: name
      !> Changed
      type(pipeline_options), intent(inout) :: options
      !> `invalid_argument`: no such preset
      type(error_type), allocatable, intent(out) :: error

      select case (name)
      case ("default")
      case ("paper")
         options%clean%method = "pauta"
         options%clean%threshold = 3.0_dp
         options%clean%degree = 3
         options%clean%max_passes = 20
         options%test_cleaned = .true.
         options%ar%method = "yw"
         options%ar%criterion = "aic"
         options%ar%max_order = 3
         options%ar%order = -1
         options%design%akf = "paper"
         options%design%r_factor = 1.0_dp
         options%design%forgetting = 0.98_dp
         options%design%estimate = " "
         options%design%huber = 0.0_dp
      case default
         call fatal_error(error, status%invalid_argument, 'there is no preset "'//name// &
            '"; there are default and paper')
         return
      end select
      options%preset = name
   end subroutine apply_preset

   !> Estimates the bytes per sample beside the record itself: for the channel being processed, for
   !> every channel, and for so many samples of it at most.
   pure subroutine estimate_memory(options, reader)
      !> What to do
      type(pipeline_options), intent(in) :: options
      !> `work_bytes`, `channel_bytes`, `part_bytes` and `part_samples` are set
      type(reader_options), intent(inout) :: reader

      reader%part_bytes = 0
      reader%part_samples = longest_part
      if (options%do_tests .and. options%welch_segment > 0.0_dp) then
         reader%part_bytes = 112      ! of a segment: window, transforms, sums, densities
         reader%part_samples = longest_segment
      else if (options%do_tests .and. .not. options%do_allan) then
         reader%part_bytes = 12       ! periodogram: beside what the program itself is allowed
      end if
      associate (work => reader%work_bytes)
         ! not at the same time: residuals of the AR model; integral and count of missing samples of
         ! the Allan deviation; white noise of each sample, for the smoother
         work = 0
         if (options%do_filter) work = 8
         if (options%do_allan) work = 12
         if ((options%do_ar .or. options%do_filter) .and. options%ar%method == "burg") work = 16
         if (options%clean%degree >= 0 .or. options%clean%method /= "none") then
            work = work + 9                                ! the cleaned series, its marks
         else if (options%do_filter) then
            work = work + 8                                ! the series without its mean
         end if
         if (options%do_filter) work = work + 8            ! the filtered series
      end associate
      reader%channel_bytes = 0
      if (options%keep_series) reader%channel_bytes = 57   ! seven series, marks of the cleaned one
   end subroutine estimate_memory

   !> Does the whole job for every channel of a record.
   subroutine run_pipeline(record, options, result, error, progress, truth)
      !> As `read_record` or `simulate_record` made it; not modified
      type(record_type), intent(in), target :: record
      !> What to do; the defaults are those of the program
      type(pipeline_options), intent(in) :: options
      !> One entry per channel
      type(pipeline_result_type), intent(out) :: result
      !> `too_few_samples`: fewer than [[gyroakf_pipeline:minimum_samples]]; no_memory; cancelled;
      !> invalid_argument, not_supported where no channel can be done, as an option is then wrong. A
      !> stage that fails for one channel is no error, nor is one of several channels that cannot be
      !> done to the end: see `channel%unavailable`
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional, target :: progress
      !> The true drift on the same grid, as `simulate_record` gives it: every filter gets its RMSE
      !> against it
      type(record_type), intent(in), optional, target :: truth
      type(channel_progress_type), target :: named
      type(job_type) :: job
      type(error_type), allocatable :: first
      integer :: channel, channels, failures, stat

      if (.not. allocated(record%value)) then
         call fatal_error(error, status%too_few_samples, "the record is empty")
         return
      end if
      if (size(record%value, 1, kind=int64) < minimum_samples) then
         call fatal_error(error, status%too_few_samples, "samples in the record: "// &
            integer_text(size(record%value, 1, kind=int64))//"; at least 10 are needed")
         return
      end if
      if (present(truth)) call check_truth(truth, record, error)
      if (allocated(error)) return
      result%duration = real(size(record%value, 1, kind=int64), dp)*record%sample_interval
      channels = size(record%value, 2)
      call new_channels(result, channels, stat)
      call check_memory(stat, "the results of the channels", error)
      if (allocated(error)) return
      job%options = options
      job%step = record%sample_interval
      job%rate_known = record%rate_known
      if (present(progress)) job%progress => progress
      if (present(progress) .and. channels > 1) then
         named%listener => progress
         job%progress => named
      end if
      failures = 0
      do channel = 1, channels
         result%channel(channel)%name = "channel"
         if (allocated(record%channel)) result%channel(channel)%name = record%channel(channel)%text
         named%name = result%channel(channel)%name
         job%unit = unit_of(record, channel)
         if (present(truth) .and. options%do_filter) call take_truth(truth, channel, job)
         job%x => record%value(:, channel)
         if (allocated(record%present)) job%recorded => record%present(:, channel)
         call run_channel(job, result%channel(channel), error)
         if (allocated(error)) then
            if (all(error%code /= of_channel)) return
            failures = failures + 1
            if (failures == 1) first = error
            call note_error(result%channel(channel)%unavailable, "the rest of the analysis", error)
            if (options%keep_series) call keep_input(record, channel, result%channel(channel))
         end if
      end do
      if (failures == channels) call move_alloc(first, error)
   end subroutine run_pipeline

   !> What is written as series where a channel could not be done to the end: its samples.
   subroutine keep_input(record, channel, result)
      type(record_type), intent(in) :: record
      integer, intent(in) :: channel
      type(channel_result_type), intent(inout) :: result

      if (.not. allocated(result%series_cleaned)) result%series_cleaned = record%value(:, channel)
      if (allocated(result%series_present) .or. .not. allocated(record%present)) return
      result%series_present = record%present(:, channel)
   end subroutine keep_input

end module gyroakf_pipeline
