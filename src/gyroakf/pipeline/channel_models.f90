! SPDX-License-Identifier: MIT
!> The models of one channel: the AR model and the one that the paper's filters take; the drift,
!> identified from the record as read, its processes stated in the units of the report.
module gyroakf_pipeline_channel_models
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, status
   use gyroakf_record, only : add_text
   use gyroakf_allan_noise_fit, only : coefficient_type
   use gyroakf_allan_noise_model, only : term_walk
   use gyroakf_ar_model, only : ar_options, fit_ar
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_filter_warnings, only : colored, significant
   use gyroakf_filter_drift_identification, only : drift_identification_options, &
      identify_drift_model
   use gyroakf_stats_autocovariance, only : autocovariance_type
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_coefficients, only : state_one
   use gyroakf_pipeline_result, only : channel_result_type, drift_process_type, stage
   use gyroakf_pipeline_warnings, only : note_failure, warn_model, warn_order
   implicit none (type, external)
   private
   public :: run_ar, find_drift, judge_model, smoothed_share

   !> An AR order is compared where there are so many samples for each
   integer(int64), parameter :: fewest_for_order = 4
   !> Default limits of drift: correlation time above so many samples, and so many seconds
   real(dp), parameter :: drift_samples = 5.0_dp, drift_seconds = 1.0_dp
   !> Times beyond it are all the same: no process is as slow
   real(dp), parameter :: longest_time = 1.0e200_dp

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
      call note_failure(channel%unavailable, "AR model", error, channel%available%ar)
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

   !> Identifies the drift; what is not slower than `drift_tau` is noise. A failure is noted in the
   !> channel.
   subroutine find_drift(z, job, channel, error)
      !> Record as read without its outliers, less its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> `drift` and what is stated of it are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      type(drift_identification_options) :: how

      channel%drift_tau = job%options%drift_tau
      if (channel%drift_tau <= 0.0_dp) channel%drift_tau = &
         max(drift_samples*job%step, merge(drift_seconds, 0.0_dp, job%rate_known))
      how%drift_samples = min(channel%drift_tau, longest_time)/job%step
      call identify_drift_model(z, how, channel%drift, error, job%valid, job%progress)
      call note_failure(channel%unavailable, "drift identification", error, channel%available%drift)
      if (.not. channel%available%drift) channel%drift%found = .false.
      if (channel%available%drift) call state_drift(job, channel)
   end subroutine find_drift

   !> States the model: times in s, standard deviations, the random walk as a coefficient K.
   subroutine state_drift(job, channel)
      type(job_type), intent(in) :: job
      type(channel_result_type), intent(inout) :: channel
      integer :: i

      if (allocated(channel%drift_process)) deallocate (channel%drift_process)
      associate (drift => channel%drift)
         channel%drift_time = drift%correlation_samples*job%step
         if (drift%errors_known .and. drift%white_std > 0.0_dp) channel%white_std_error = &
            0.5_dp*drift%std_error%r/drift%white_std
         allocate (channel%drift_process(drift%model%count))
         do i = 1, drift%model%count
            call state_process(drift%model, drift%std_error, i, job, channel%drift_process(i))
            channel%drift_process(i)%slow = drift%slow(i)
         end do
      end associate
   end subroutine state_drift

   !> One process:
   !> $$ T = -\frac{t_0}{\ln\phi}, \quad \mathrm{d}T = \frac{T^2}{t_0\,\phi}\,\mathrm{d}\phi,
   !>    \quad \sigma^2 = \frac{q}{1 - \phi^2} $$
   !> The random walk is also stated as the coefficient K, \( K = \sqrt{q/t_0} \), in the unit of
   !> Table III.
   subroutine state_process(model, std_error, i, job, process)
      !> The model and its standard errors, 0 where they are not known
      type(component_model_type), intent(in) :: model, std_error
      integer, intent(in) :: i
      type(job_type), intent(in) :: job
      type(drift_process_type), intent(inout) :: process
      type(coefficient_type) :: k

      associate (phi => model%phi(i), q => model%q(i), step => job%step)
         process%phi = phi
         process%walk = phi >= 1.0_dp
         if (process%walk) then
            process%std = sqrt(q)
            if (q > 0.0_dp) process%std_error = 0.5_dp*std_error%q(i)/sqrt(q)
            k%value = process%std/sqrt(step)
            k%std_error = process%std_error/sqrt(step)
            k%fitted = .true.
            k%detected = .true.
            call state_one(k, 4, job%rate_known, job%unit, process%k)
            return
         end if
         process%std = sqrt(q/((1.0_dp - phi)*(1.0_dp + phi)))
         if (.not. phi > 0.0_dp) return
         process%time = -step/log(phi)
         process%time_error = process%time**2/(step*phi)*std_error%phi(i)
      end associate
   end subroutine state_process

   !> Whether the model describes the record: its Kalman filter leaves white innovations, and the
   !> Allan deviation does not exclude its K. K is stated only then, and where the verdict does not
   !> exclude a random walk.
   pure subroutine judge_model(channel)
      !> `drift_doubt` is set, and whether K is stated
      type(channel_result_type), intent(inout) :: channel
      !> Standard errors that two K may differ
      real(dp), parameter :: most_errors = 3.0_dp
      character(:), allocatable :: doubt
      integer :: i, which

      which = merge(stage%outliers_removed, stage%input, &
                    channel%allan(stage%outliers_removed)%available)
      associate (test => channel%drift_kf%ljung_box, verdict => channel%verdict, &
                 allan => channel%allan(which)%stated%term(term_walk))
         if (channel%available%drift_kf .and. test%p_value < significant .and. &
             test%largest_rho > colored) then
            channel%drift_doubt = "the innovations of its Kalman filter are not white, with an "// &
               "autocorrelation of "//format_real(test%largest_rho, 2)
         end if
         do i = 1, size(channel%drift_process)
            if (.not. channel%drift_process(i)%walk) cycle
            associate (k => channel%drift_process(i)%k)
               doubt = ""
               if (allan%state == "limit" .and. k%value > allan%upper_limit) then
                  doubt = " is above the limit of the Allan deviation, "// &
                     format_real(allan%upper_limit, 3)
               else if (allan%state == "value" .and. channel%drift%errors_known .and. &
                        abs(k%value - allan%value) > &
                        most_errors*hypot(k%std_error, allan%std_error)) then
                  doubt = " is not that of the Allan deviation, "//format_real(allan%value, 3)
               end if
               if (doubt /= "") channel%drift_doubt = "its K = "//format_real(k%value, 3)//doubt// &
                  " "//k%unit
               k%detected = .not. allocated(channel%drift_doubt) .and. (.not. verdict%known .or. &
                  (verdict%walks .and. allan%state /= "withheld"))
            end associate
         end do
      end associate
   end subroutine judge_model

   !> Share of a constant rotation that the smoothed drift takes up: all of it with a random walk,
   !> else that of the drift in the spectrum of the model at frequency 0.
   pure real(dp) function smoothed_share(channel) result(share)
      !> A drift is found
      type(channel_result_type), intent(in) :: channel
      real(dp) :: density, all_density
      integer :: i

      share = 1.0_dp
      density = 0.0_dp
      all_density = channel%drift%model%r
      do i = 1, channel%drift%model%count
         associate (phi => channel%drift%model%phi(i), q => channel%drift%model%q(i))
            if (phi >= 1.0_dp .and. channel%drift%slow(i)) return
            if (phi >= 1.0_dp) cycle
            all_density = all_density + q/(1.0_dp - phi)**2
            if (channel%drift%slow(i)) density = density + q/(1.0_dp - phi)**2
         end associate
      end do
      if (all_density > 0.0_dp) share = density/all_density
   end function smoothed_share

end module gyroakf_pipeline_channel_models
