! SPDX-License-Identifier: MIT
!> The main job over records that drift: the model, its filters, what is left, what is stated of them.
module test_pipeline_drift
   use expectations, only : unmet, failed => problem, test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, stage
   use pipeline_runs, only : paper_record, run, variance, walking_record
   implicit none (type, external)
   private
   public :: suite_pipeline_drift

contains

   subroutine suite_pipeline_drift()
      call test("drift", test_drift)
      call test("walk-stated", test_walk_stated)
      call test("compensated", test_compensated)
      call test("stated-figures", test_stated_figures)
      call test("drift-options", test_drift_options)
   end subroutine suite_pipeline_drift

   !> A drift under white noise is found, with its correlation time: AR(1) of 0.99 at 10 Hz is 9.95 s.
   subroutine test_drift()
      type(simulate_options) :: options
      type(record_type) :: record
      type(pipeline_result_type) :: result

      options%samples = 20000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%ar = [0.99_dp]
      options%ar_variance = 4.0e-4_dp
      call simulate_record(options, record, failed)
      call check(error, run(record, result))
      associate (c => result%channel(1))
         call check(error, c%drift%found .and. c%available%drift_kf .and. c%available%drift_akf)
         call check(error, c%drift_tau, 1.0_dp)
         call check(error, c%drift_time, 9.95_dp, thr=4.0_dp)
         call check(error, abs(c%drift%white_std - 0.01_dp*sqrt(10.0_dp)) < 4*c%white_std_error .and. c%white_std_error < 1.0e-3_dp)
         call check(error, c%drift_process(1)%slow .and. .not. c%drift_process(1)%walk .and. &
                    abs(c%drift_process(1)%time - 9.95_dp) < 4*c%drift_process(1)%time_error, "the process as stated")
         call check(error, c%drift_process(1)%time_error > 0.1_dp .and. c%drift_process(1)%time_error < 4.0_dp, "its error")
         call check(error, abs(c%drift_process(1)%std - 0.02_dp) < 0.006_dp, "its standard deviation")
         associate (model => c%drift%model)
            call check(error, c%drift%name == "ar1" .and. abs(c%drift_smoother%dc_gain - model%q(1)/(model%q(1) &
                       + model%r*(1 - model%phi(1))**2)) < 1.0e-12_dp, "the share of the spectrum at frequency 0")
         end associate
         call check(error, c%drift_kf%nis_mean > c%drift_kf%nis_low .and. c%drift_kf%nis_mean < c%drift_kf%nis_high)
      end associate
   end subroutine test_drift

   !> K of the drift model is stated beside a random walk; not beside flicker, whose approximation it is, nor where innovations are
   !> not white.
   subroutine test_walk_stated()
      !> N, B, K, a vibration
      real(dp), parameter :: truth(4, 3) = reshape([0.3_dp, 0.0_dp, 0.02_dp, 0.0_dp, 0.3_dp, 0.1_dp, 0.0_dp, 0.0_dp, &
                                                    0.05_dp, 0.02_dp, 0.02_dp, 2.0_dp], [4, 3])
      type(simulate_options) :: options
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: i

      options%samples = 30000
      options%rate_hz = 10
      do i = 1, 3
         options%coefficient(2:4) = truth(:3, i)
         if (truth(4, i) > 0) options%vibration = [truth(4, i), 2.3_dp, 0.02_dp]
         call simulate_record(options, record, failed)
         call check(error, run(record, result), "it fails")
         associate (c => result%channel(1))
            if (unmet(allocated(c%drift_process) .and. (i == 2 .or. c%drift%found), c%verdict%drift)) return
            call check(error, any(c%drift_process%k%detected) .eqv. i == 1, "stated")
            if (unmet(allocated(c%drift_doubt) .or. i < 3, "doubt")) return
            if (i == 1) call check(error, .not. allocated(c%drift_doubt))
            if (allocated(error)) return
         end associate
      end do
   end subroutine test_walk_stated

   !> Shares of variances, and the correlation time of a process.
   subroutine test_stated_figures()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(simulate_options) :: options

      options%samples = 6000
      options%rate_hz = 10
      options%coefficient(2) = 0.01_dp
      options%ar = [0.98_dp]
      options%ar_variance = 1.0e-4_dp
      call simulate_record(options, record, failed)
      call check(error, run(record, result), "the job fails")
      associate (c => result%channel(1))
         call check(error, c%kf_figures%variance_ratio, c%kf%variance/c%cleaned%variance, thr=1.0e-14_dp, rel=.true.)
         if (unmet(c%drift%found .and. size(c%drift_process) == 1, "one process")) return
         call check(error, .not. c%drift_process(1)%walk, "a correlated process")
         call check(error, c%drift_process(1)%time, -0.1_dp/log(c%drift%model%phi(1)), thr=1.0e-14_dp, rel=.true.)
      end associate
   end subroutine test_stated_figures

   !> What is left without the smoothed drift: raw is drift and compensated; the white noise of 0.0316; no random walk any more.
   subroutine test_compensated()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options

      call walking_record(record)
      options%keep_series = .true.
      options%clean%degree = 3
      call check(error, run(record, result, options))
      associate (c => result%channel(1), raw => record%value(:, 1))
         call check(error, c%available%drift_smoother .and. any(c%drift_process%walk .and. c%drift_process%slow))
         call check(error, maxval(abs(c%series_drift + c%series_compensated - raw), mask=c%series_present /= 0) < 1.0e-13_dp)
         call check(error, c%compensated%std, 0.0316_dp, thr=0.0008_dp)
         call check(error, variance(pack(c%series_compensated, c%series_present /= 0)), c%compensated%variance, thr=1.0e-10_dp, &
                    rel=.true.)
         call check(error, variance(pack(c%series_drift, c%series_present /= 0)), c%drift_smoother%variance, thr=1.0e-10_dp, &
                    rel=.true.)
         call check(error, variance(pack(c%series_drift_akf, c%series_present /= 0)), c%drift_akf%variance, thr=1.0e-8_dp, &
                    rel=.true.)
         call check(error, abs(c%compensated%mean) < 1.0e-4_dp .and. abs(c%drift_kf%mean - c%level%mean) < 0.01_dp, "the level")
         call check(error, c%drift_smoother%dc_gain, 1.0_dp)
         associate (before => c%allan(stage%input), after => c%allan(stage%compensated), n => size(c%allan(stage%input)%curve%tau))
            call check(error, after%stated%term(2)%value, before%stated%term(2)%value, thr=0.03_dp, rel=.true.)
            call check(error, after%curve%deviation(n - 2) < 0.05_dp*before%curve%deviation(n - 2), "long averaging times")
         end associate
         associate (before => c%allan(stage%input)%stated%term(4), after => c%allan(stage%compensated)%stated%term(4))
            call check(error, before%detected .and. .not. after%detected, "the random walk")
            associate (walk => c%drift_process(size(c%drift_process)))
               call check(error, abs(walk%k%value - before%value) < 4*(walk%k%std_error + before%std_error), "K of the two")
               call check(error, walk%k%unit, before%unit)
            end associate
         end associate
      end associate
   end subroutine test_compensated

   !> The limit of what is drift.
   subroutine test_drift_options()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options

      call paper_record(record)
      options%drift_tau = 0.1_dp
      call check(error, run(record, result, options))
      associate (c => result%channel(1))
         call check(error, c%drift%found .and. c%drift_time < 1.0_dp .and. c%drift_time > 0.1_dp, "0.22 s is drift where asked for")
      end associate
      if (allocated(error)) return
      options%drift_tau = 1.0e300_dp
      record%sample_interval = 1.0e-10_dp
      call check(error, run(record, result, options))
      call check(error, any(result%channel(1)%drift%slow) .eqv. any(result%channel(1)%drift_process%walk), "only a walk is as slow")
   end subroutine test_drift_options

end module test_pipeline_drift
