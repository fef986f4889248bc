! SPDX-License-Identifier: MIT
!> Warnings of a channel: failed stages and unusual results.
module gyroakf_pipeline_warnings
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, status
   use gyroakf_record, only : add_text, text_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_pipeline_result, only : channel_result_type, not_described, stage
   use gyroakf_units, only : term_names
   implicit none (type, external)
   private
   public :: job_ends, note_failure, note_error, negligible_rho
   public :: warn_outliers, warn_order, warn_model, warn_curve, warn_fit, warn_halves

   !> Errors that end the whole job, not only a stage of one channel
   integer, parameter :: job_ends(5) = [status%no_memory, status%cancelled, status%internal, &
                                        status%not_supported, status%invalid_argument]
   !> So many times of outliers are named
   integer, parameter :: named_outliers = 8, named_motions = 3
   !> More than this share removed is a warning
   real(dp), parameter :: outlier_share = 0.01_dp
   !> Residuals are called correlated at this significance, and only where an autocorrelation is as
   !> large as this: in a long record every test rejects
   real(dp), parameter :: significant = 0.01_dp, negligible_rho = 0.05_dp
   !> A change between the halves is said where it is less probable by chance, and is a warning
   !> where it is larger than this
   real(dp), parameter, public :: certain = 1e-3_dp
   real(dp), parameter :: small_change = 0.03_dp

contains

   !> Notes why an analysis has no result and clears the error; one that ends the job stays as it
   !> is.
   pure subroutine note_failure(failures, analysis, error, available)
      !> `unavailable` of the channel; gets a line
      type(text_type), allocatable, intent(inout) :: failures(:)
      !> What is missing, as a reader knows it: "ADF test"
      character(*), intent(in) :: analysis
      !> Deallocated where it does not end the job
      type(error_type), allocatable, intent(inout) :: error
      !> There was no error
      logical, intent(out), optional :: available

      if (present(available)) available = .not. allocated(error)
      if (.not. allocated(error)) return
      if (.not. any(error%code == job_ends)) call note_error(failures, analysis, error)
   end subroutine note_failure

   !> The same of any error.
   pure subroutine note_error(failures, analysis, error)
      !> As those of [[note_failure]]
      type(text_type), allocatable, intent(inout) :: failures(:)
      character(*), intent(in) :: analysis
      !> Allocated; deallocated
      type(error_type), allocatable, intent(inout) :: error

      call add_text(failures, analysis//": "//error%message)
      failures(size(failures))%code = error%code
      deallocate (error)
   end subroutine note_error

   !> Where the sensor moves, and more than 1 % of the samples removed: says when.
   pure subroutine warn_outliers(channel, step, rate_known)
      !> `clean` is filled; gets a warning
      type(channel_result_type), intent(inout) :: channel
      !> Sample interval
      real(dp), intent(in) :: step
      !> It is in seconds
      logical, intent(in) :: rate_known
      character(:), allocatable :: times
      real(dp) :: seconds
      integer(int64) :: i, last

      if (.not. channel%clean%converged .and. channel%clean%passes > 1) call add_text( &
         channel%warnings, "the search for outliers did not settle within "// &
         integer_text(int(channel%clean%passes, int64))//" rounds")
      seconds = merge(step, 0.0_dp, rate_known)
      if (allocated(channel%clean%motion)) call warn_motion(channel, seconds)
      if (channel%clean%fraction <= outlier_share) return
      times = ""
      if (allocated(channel%clean%outlier)) then
         associate (outlier => channel%clean%outlier)
            last = size(outlier, kind=int64)
            do i = 1, min(last, int(named_outliers, int64))
               call add_moment(times, outlier(i), seconds, ", ")
            end do
            if (last > named_outliers) times = times//"..., "
            if (last > named_outliers) call add_moment(times, outlier(last), seconds, ", ")
         end associate
      end if
      times = times(:max(len(times) - 2, 0))
      if (rate_known) times = "at "//times//" s"
      if (.not. rate_known) times = "samples "//times
      call add_text(channel%warnings, format_real(100*channel%clean%fraction, 3)// &
         " % of the samples ("//integer_text(channel%clean%removed)// &
         ") were removed as outliers, "//times//": look at the recording there")
   end subroutine warn_outliers

   !> Where the sensor moves.
   pure subroutine warn_motion(channel, seconds)
      type(channel_result_type), intent(inout) :: channel
      !> Sample interval, 0 where it is not known
      real(dp), intent(in) :: seconds
      character(:), allocatable :: text
      integer(int64) :: k, stretches

      stretches = size(channel%clean%motion, 2, kind=int64)
      if (stretches == 0) return
      text = ""
      do k = 1, min(stretches, int(named_motions, int64))
         text = text//", "
         call add_moment(text, channel%clean%motion(1, k), seconds, " to ")
         call add_moment(text, channel%clean%motion(2, k), seconds, "")
      end do
      if (stretches > named_motions) text = text//", ..."
      if (seconds > 0) text = "at"//text(2:)//" s"
      if (.not. seconds > 0) text = "in samples"//text(2:)
      call add_text(channel%warnings, "motion or vibration "//text//" ("// &
         integer_text(stretches)//" in all): nothing is removed there; `from` and `to` select "// &
         "a part at rest")
   end subroutine warn_motion

   !> Whether there is anything to predict, and whether fewer orders were compared than asked for.
   pure subroutine warn_order(channel, capped, most)
      !> Its AR model is filled; gets a warning
      type(channel_result_type), intent(inout) :: channel
      !> Fewer were compared
      logical, intent(in) :: capped
      !> The largest order
      integer, intent(in) :: most

      if (channel%ar%order == 0) call add_text(channel%warnings, "no autocorrelation is found "// &
         "(order 0): the paper's filters have nothing to separate, and halve whatever passes", &
         note=.true.)
      if (capped) call add_text(channel%warnings, "the record is short: AR orders up to "// &
         integer_text(int(most, int64))//" are compared", note=.true.)
   end subroutine warn_order

   !> What the tests and the model say against the use of their results.
   pure subroutine warn_model(channel)
      !> Tests are filled as far as they are available, and the AR model; gets warnings
      type(channel_result_type), intent(inout) :: channel

      associate (ar => channel%ar, test => channel%ar%residual_ljung_box)
         if (ar%largest_order_chosen) call add_text(channel%warnings, "the largest order "// &
            "compared, "//integer_text(int(ar%order, int64))//", was chosen: the series is not "// &
            "a "//"short AR process; compare BIC, raise `max_order`, or expect a drift under "// &
            "white "//"noise", note=.true.)
         if (test%lags > 0 .and. test%p_value < significant .and. &
             test%largest_rho > negligible_rho) call add_text(channel%warnings, &
            "the residuals of AR("//integer_text(int(ar%order, int64))// &
            ") are not white (an autocorrelation of "//format_real(test%largest_rho, 2)// &
            "): the model is incomplete")
      end associate
   end subroutine warn_model

   !> Averaging times that missing samples take out of the Allan curve.
   pure subroutine warn_curve(channel, step, rate_known)
      !> Gets a warning
      type(channel_result_type), intent(inout) :: channel
      !> Sample interval
      real(dp), intent(in) :: step
      !> It is in seconds
      logical, intent(in) :: rate_known
      character(:), allocatable :: text, unit
      integer :: n

      if (.not. channel%allan(stage%input)%available) return
      associate (curve => channel%allan(stage%input)%curve, &
                 left_out => channel%allan(stage%input)%curve%left_out)
         n = size(left_out)
         if (n == 0) return
         unit = " s"
         if (.not. rate_known) unit = " samples"
         text = format_real(left_out(1)*step, 6)
         if (n > 1) text = text//" to "//format_real(left_out(n)*step, 6)
         text = "missing samples leave no windows that are complete enough for the Allan "// &
            "deviation at "//integer_text(int(n, int64))//" averaging "// &
            trim(merge("time ", "times", n == 1))//", tau = "//text//unit
         if (left_out(n) > curve%m(size(curve%m))) text = text//": the curve ends at tau = "// &
            format_real(curve%tau(size(curve%tau)), 6)//unit
         call add_text(channel%warnings, text//"; `min_coverage` sets the share of a window "// &
            "that must be present", note=.true.)
      end associate
   end subroutine warn_curve

   !> Curves that the terms do not describe, or only in part.
   pure subroutine warn_fit(channel)
      !> Its Allan curve of the record as read is fitted as far as possible; gets a warning
      type(channel_result_type), intent(inout) :: channel
      character(:), allocatable :: names
      integer :: i

      if (.not. channel%allan(stage%input)%fitted) return
      associate (noise => channel%allan(stage%input)%noise, &
                 deviation => channel%allan(stage%input)%curve%deviation)
         if (minloc(deviation, dim=1) == 1 .and. maxval(deviation) > 2*deviation(1) .and. &
             noise%left_out == 0 .and. .not. noise%coefficient(2)%detected) call add_text( &
            channel%warnings, "the Allan deviation rises from its first averaging time on: "// &
            "the sensor moved, or drifts faster than its noise shows; N needs a record at rest")
         names = ""
         do i = 2, 4                                                                ! N, B, K
            if (noise%coefficient(i)%state == "withheld") names = names//", "//term_names(i)
         end do
         if (noise%described .and. names /= "") call add_text(channel%warnings, names(3:)// &
            " withheld: octaves "//integer_text(int(noise%left_out + 1, int64))//" to "// &
            integer_text(int(noise%left_out + noise%points, int64))//" of "// &
            integer_text(int(noise%left_out + noise%points + noise%cut_off, int64))// &
            ", which the fit describes, do not determine "// &
            trim(merge("it  ", "them", len(names) == 3)), note=.true.)
         if (.not. noise%described) then
            call add_text(channel%warnings, "Allan deviation: "//not_described// &
               "; `tau_min` and `tau_max` fit a range")
         else if (noise%left_out > 0) then
            call add_text(channel%warnings, "a filter in the sensor, a line or correlated "// &
               "noise "//"bends the Allan curve at its first "//integer_text(int(noise%left_out, &
               int64))//" octaves: they are excluded from the fit", note=.true.)
         end if
         if (noise%unquantized%state == "withheld") call add_text(channel%warnings, &
            "the step of the samples, "//format_real(channel%quantization%step, 4)// &
            ", is not small beside the noise: N is that of the record as quantized, "// &
            "which may be far from that of the sensor")
         if (noise%errors_increased) call add_text(channel%warnings, "the Allan deviation is "// &
            "not a sum of the fitted terms: chi-square per degree of freedom is "// &
            format_real(noise%chi2_reduced, 3)// &
            ". The errors of the coefficients are increased by its root")
      end associate
   end subroutine warn_fit

   !> The second half of the record has another Allan deviation than the first.
   pure subroutine warn_halves(channel, rate_known)
      !> With the comparison
      type(channel_result_type), intent(inout) :: channel
      !> The averaging times are in s, not in samples
      logical, intent(in) :: rate_known
      integer :: i

      if (.not. (channel%available%halves .and. channel%halves%p_value < certain)) return
      associate (halves => channel%halves)
         i = maxloc(abs(halves%score), dim=1)
         call add_text(channel%warnings, "the noise changed during the record: at tau = "// &
            format_real(halves%tau(i), 4)//trim(merge(" s      ", " samples", rate_known))// &
            " the second half has "//format_real(halves%ratio(i), 3)//" times the Allan "// &
            "deviation of the first; the coefficients are those of both together", &
            note=abs(halves%ratio(i) - 1) < small_change)
      end associate
   end subroutine warn_halves

   !> Appends the time of a sample in s, or its number.
   pure subroutine add_moment(text, index, step, behind)
      character(:), allocatable, intent(inout) :: text
      !> From 1
      integer(int64), intent(in) :: index
      !> Sample interval in s, 0 where it is not known
      real(dp), intent(in) :: step
      !> What stands behind it
      character(*), intent(in) :: behind

      if (step > 0.0_dp) then
         text = text//format_real(real(index - 1, dp)*step, 7)//behind
      else
         text = text//integer_text(index)//behind
      end if
   end subroutine add_moment

end module gyroakf_pipeline_warnings
