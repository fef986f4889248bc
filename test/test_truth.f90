! SPDX-License-Identifier: MIT
!> The main job where the true drift is known.
module test_truth
   use expectations, only : unmet, gyro => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_stats_trend, only : evaluate_trend
   use gyroakf_error, only : status
   use gyroakf_record, only : record_type
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use gyroakf_units, only : parse_unit
   implicit none (type, external)
   private
   public :: suite_truth

contains

   subroutine suite_truth()
      call test("rmse-of-outputs", test_outputs)
      call test("units", test_units)
      call test("gaps", test_gaps)
      call test("refused", test_refused)
   end subroutine suite_truth

   !> A record with drift, trend, outliers and losses, and its truth.
   subroutine make(record, truth)
      type(record_type), intent(out) :: record, truth
      type(simulate_options) :: options

      options%samples = 4000
      options%coefficient(2) = 0.009_dp
      options%ar = [0.978_dp]
      options%ar_variance = 1.0e-4_dp
      options%trend = [0.5_dp, 2.0e-5_dp]
      options%missing = 0.02_dp
      call simulate_record(options, record, gyro, truth)
   end subroutine make

   !> Only the filters, of the record as it is or cleaned.
   type(pipeline_options) function filters_only(degree) result(options)
      integer, intent(in) :: degree

      options%do_tests = .false.
      options%do_allan = .false.
      options%clean%degree = degree
      options%clean%method = "none"
   end function filters_only

   !> The RMSE of each filter is that of its output with the trend and the mean that were removed before it,
   !> over the samples that are present; the true drift does not outlive the filters.
   subroutine test_outputs()
      type(record_type) :: record, truth
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      real(dp) :: trend(4000)
      integer :: degree
      integer(int64) :: k

      call make(record, truth)
      do degree = -1, 3, 4
         options = filters_only(degree)
         options%keep_series = .true.
         call run_pipeline(record, options, result, gyro, truth=truth)
         if (went_wrong(gyro)) return
         associate (c => result%channel(1), present => record%present(:, 1) == 1_int8)
            trend = 0
            if (degree >= 0) trend = [(evaluate_trend(c%clean%trend, k), k=0, 3999)]
            if (unmet(c%kf_figures%rmse_samples, count(present, kind=int64))) return
            call same(c%kf_figures%rmse, trend + c%cleaned%mean + c%series_kf, present)
            call same(c%akf_figures%rmse, trend + c%cleaned%mean + c%series_akf, present)
            call same(c%drift_kf_figures%rmse, c%series_drift_kf, present)
            call same(c%drift_akf_figures%rmse, c%series_drift_akf, present)
            call same(c%drift_smoother_figures%rmse, c%series_drift, present)
            call check(error, c%drift_smoother_figures%rmse < 0.95_dp*c%drift_kf_figures%rmse)
            call check(error, c%drift_kf_figures%rmse < c%kf_figures%rmse)
         end associate
         if (allocated(error)) return
      end do
      call run_pipeline(record, filters_only(-1), result, gyro)
      call check(error, result%channel(1)%kf_figures%rmse_samples, 0_int64)

   contains

      subroutine same(rmse, estimate, present)
         !> Stated; the estimate with all that was removed; which samples count
         real(dp), intent(in) :: rmse, estimate(:)
         logical, intent(in) :: present(:)
         real(dp) :: expected

         expected = sqrt(sum((estimate - truth%value(:, 1))**2, mask=present)/count(present))
         call check(error, rmse, expected, thr=1.0e-9_dp, rel=.true.)
      end subroutine same

   end subroutine test_outputs

   !> A truth in another unit is converted.
   subroutine test_units()
      type(record_type) :: record, truth
      type(pipeline_result_type) :: first, second

      call make(record, truth)
      call run_pipeline(record, filters_only(-1), first, gyro, truth=truth)
      call parse_unit("deg/h", truth%unit, gyro)
      truth%value = 3600*truth%value
      call run_pipeline(record, filters_only(-1), second, gyro, truth=truth)
      if (went_wrong(gyro)) return
      call same(1.0_dp)
      call parse_unit("deg/h", record%unit, gyro)
      record%value = 3600*record%value
      call run_pipeline(record, filters_only(-1), second, gyro, truth=truth)
      if (went_wrong(gyro)) return
      call same(3600.0_dp)

   contains

      subroutine same(factor)
         !> Unit of the first over that of the second
         real(dp), intent(in) :: factor

         call check(error, second%channel(1)%kf_figures%rmse, factor*first%channel(1)%kf_figures%rmse, thr=1.0e-9_dp, &
                    rel=.true.)
      end subroutine same

   end subroutine test_units

   !> Samples whose true drift is missing do not count.
   subroutine test_gaps()
      type(record_type) :: record, truth
      type(pipeline_result_type) :: result

      call make(record, truth)
      allocate (truth%present(4000, 1), source=1_int8)
      truth%present(1001:2000, 1) = 0_int8
      truth%value(1001:2000, 1) = 1.0e6_dp
      call run_pipeline(record, filters_only(0), result, gyro, truth=truth)
      if (went_wrong(gyro)) return
      associate (figures => result%channel(1)%kf_figures)
         call check(error, figures%rmse_samples, count(record%present*truth%present == 1_int8, kind=int64))
         call check(error, figures%rmse < 0.03_dp)
      end associate
   end subroutine test_gaps

   !> A truth that does not fit.
   subroutine test_refused()
      type(record_type) :: record, truth, wrong
      type(pipeline_result_type) :: result

      call make(record, truth)
      wrong = truth
      wrong%value = truth%value(:3999, :)
      call run_pipeline(record, filters_only(-1), result, gyro, truth=wrong)
      call expect("3999 samples, the record 4000")
      wrong = truth
      wrong%sample_interval = 0.1_dp
      call run_pipeline(record, filters_only(-1), result, gyro, truth=wrong)
      call expect("samples a second")
      wrong = truth
      call parse_unit("m/s^2", wrong%unit, gyro)
      call run_pipeline(record, filters_only(-1), result, gyro, truth=wrong)
      call expect("the record in deg/s")

   contains

      subroutine expect(fragment)
         character(*), intent(in) :: fragment

         call check_refused(gyro, status%invalid_argument)
         call check(error, index(gyro%message, fragment) > 0, gyro%message)
      end subroutine expect

   end subroutine test_refused

end module test_truth
