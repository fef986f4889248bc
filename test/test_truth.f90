! SPDX-License-Identifier: MIT
!> The main job where the true drift is known.
module test_truth
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_record, only : record_type
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_pipeline_truth_result, only : score_of
   use gyroakf_simulate_record, only : simulate_options, simulate_record
   use gyroakf_units, only : parse_unit
   implicit none (type, external)
   private
   public :: collect_truth

contains

   subroutine collect_truth(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("removed-is-drift", test_removed), &
         new_unittest("polynomial", test_polynomial), &
         new_unittest("units", test_units), &
         new_unittest("gaps", test_gaps), &
         new_unittest("no-white-noise", test_no_white_noise), &
         new_unittest("refused", test_refused)]
   end subroutine collect_truth

   !> A record with drift, trend, outliers and losses, and its truth.
   subroutine make(record, truth)
      type(record_type), intent(out) :: record, truth
      type(simulate_options) :: options
      type(gyro_error), allocatable :: gyro

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

   !> Trend and mean that are taken out before the filters are part of the drift: without a filter the error is record - truth, over
   !> the samples that are there.
   subroutine test_removed(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, truth
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: gyro
      real(dp) :: expected
      integer :: degree

      call make(record, truth)
      expected = sqrt(sum((record%value - truth%value)**2, mask=record%present == 1_int8)/count(record%present == 1_int8))
      do degree = -1, 3, 4
         call run_pipeline(record, filters_only(degree), result, gyro, truth=truth)
         call check(error, .not. allocated(gyro))
         if (allocated(error)) return
         associate (scores => result%channel(1)%truth)
            call check(error, scores%method(score_of(scores, "none"))%score%rmse, expected, thr=1.0e-12_dp)
            if (allocated(error)) return
            call check(error, scores%method(score_of(scores, "none"))%score%samples, count(record%present == 1_int8, kind=int64))
            if (allocated(error)) return
            call check(error, min(score_of(scores, "kf"), score_of(scores, "drift_kf"), score_of(scores, "moving_average")) > 0)
            if (allocated(error)) return
            call check(error, scores%method(score_of(scores, "drift_kf"))%score%rmse < 0.8_dp*expected)
            if (allocated(error)) return
            call check(error, .not. allocated(scores%drift))
         end associate
         if (allocated(error)) return
      end do
      call run_pipeline(record, filters_only(-1), result, gyro)
      call check(error, .not. result%channel(1)%truth%known)
   end subroutine test_removed

   !> A steep parabola in record and truth: with a polynomial under the drift the filters are as near to the truth as without the
   !> parabola, and what they give has it; drift and what is left are the record. Without it the drift has to follow the parabola.
   subroutine test_polynomial(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: names(5) = [character(17) :: "drift_kf", "drift_akf", "drift_smoother", "innovation_window", &
                                             "variational_bayes"]
      type(record_type) :: record, truth
      type(pipeline_result_type) :: plain, with, without
      type(pipeline_options) :: options
      type(gyro_error), allocatable :: gyro
      real(dp) :: parabola(4000)
      integer :: k

      call make(record, truth)
      options = filters_only(-1)
      options%keep_series = .true.
      options%identification%degree = 2
      call run_pipeline(record, options, plain, gyro, truth=truth)
      parabola = [(20*(k/4000.0_dp)**2, k=1, 4000)]
      record%value(:, 1) = record%value(:, 1) + parabola
      truth%value(:, 1) = truth%value(:, 1) + parabola
      call run_pipeline(record, options, with, gyro, truth=truth)
      options%identification%degree = 0
      if (.not. allocated(gyro)) call run_pipeline(record, options, without, gyro, truth=truth)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      do k = 1, size(names)
         call check(error, rmse(with, names(k)), rmse(plain, names(k)), thr=1.0e-3_dp, rel=.true.)
         if (allocated(error)) return
      end do
      call check(error, rmse(without, "drift_smoother") > 1.05_dp*rmse(with, "drift_smoother"), "no worse without the polynomial")
      if (allocated(error)) return
      associate (c => with%channel(1), here => record%present(:, 1) == 1_int8)
         call check(error, maxval(abs(c%series_drift + c%series_compensated - record%value(:, 1)), mask=here) < 1.0e-12_dp)
         if (allocated(error)) return
         call check(error, sqrt(sum((c%series_drift_kf - truth%value(:, 1))**2, mask=here)/count(here)), &
                    rmse(with, "drift_kf"), thr=1.0e-9_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, variance_of(pack(c%series_drift_akf, here)), c%drift_akf%variance, thr=1.0e-9_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, c%drift_smoother_figures%variance_ratio, c%drift_smoother%variance/c%level%variance, thr=1.0e-12_dp)
         if (allocated(error)) return
         call check(error, c%drift_akf_figures%variance_ratio > 0.99_dp .and. c%compensated_ratio < 0.01_dp, "what is drift")
      end associate

   contains

      real(dp) function rmse(result, name)
         type(pipeline_result_type), intent(in) :: result
         character(*), intent(in) :: name

         rmse = result%channel(1)%truth%method(score_of(result%channel(1)%truth, name))%score%rmse
      end function rmse

      pure real(dp) function variance_of(x)
         real(dp), intent(in) :: x(:)

         variance_of = sum((x - sum(x)/size(x))**2)/(size(x) - 1)
      end function variance_of
   end subroutine test_polynomial

   !> A truth in another unit is converted; the angle of a gyroscope is in degrees, whatever its unit.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, truth
      type(pipeline_result_type) :: first, second
      type(gyro_error), allocatable :: gyro

      call make(record, truth)
      call run_pipeline(record, filters_only(-1), first, gyro, truth=truth)
      call parse_unit("deg/h", truth%unit, gyro)
      truth%value = 3600*truth%value
      call run_pipeline(record, filters_only(-1), second, gyro, truth=truth)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call same(1.0_dp)
      if (allocated(error)) return
      call parse_unit("deg/h", record%unit, gyro)
      record%value = 3600*record%value
      call run_pipeline(record, filters_only(-1), second, gyro, truth=truth)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call same(3600.0_dp)

   contains

      subroutine same(factor)
         !> Unit of the first over that of the second
         real(dp), intent(in) :: factor

         associate (a => first%channel(1)%truth%method(1)%score, b => second%channel(1)%truth%method(1)%score)
            call check(error, b%rmse, factor*a%rmse, thr=1.0e-9_dp, rel=.true.)
            if (allocated(error)) return
            call check(error, maxval(abs(b%attitude_error - a%attitude_error)) < 1.0e-9_dp)
         end associate
         if (allocated(error)) return
         call check(error, trim(second%channel(1)%truth%angle_unit) == "deg")
      end subroutine same
   end subroutine test_units

   !> Where the truth is missing nothing is scored.
   subroutine test_gaps(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, truth
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: gyro

      call make(record, truth)
      allocate (truth%present(4000, 1), source=1_int8)
      truth%present(1001:2000, 1) = 0_int8
      truth%value(1001:2000, 1) = 1.0e6_dp
      call run_pipeline(record, filters_only(0), result, gyro, truth=truth)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      associate (score => result%channel(1)%truth%method(1)%score)
         call check(error, score%samples, count(record%present*truth%present == 1_int8, kind=int64))
         if (allocated(error)) return
         call check(error, score%rmse < 0.03_dp)
      end associate
   end subroutine test_gaps

   !> A filter that needs white noise is left out of the comparison where the model has none; the job goes on.
   subroutine test_no_white_noise(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, truth
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      type(simulate_options) :: walk
      type(gyro_error), allocatable :: gyro

      walk%samples = 2000
      walk%coefficient = 0.0_dp
      walk%coefficient(4) = 0.01_dp
      call simulate_record(walk, record, gyro, truth)
      options = filters_only(-1)
      options%identification%source = "allan"
      call run_pipeline(record, options, result, gyro, truth=truth)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      associate (channel => result%channel(1))
         call check(error, .not. channel%drift%model%r > 0.0_dp, "the Allan deviation shows white noise")
         if (allocated(error)) return
         call check(error, score_of(channel%truth, "variational_bayes"), 0)
         if (allocated(error)) return
         call check(error, min(score_of(channel%truth, "drift_kf"), score_of(channel%truth, "innovation_window")) > 0)
      end associate
   end subroutine test_no_white_noise

   !> A truth that does not fit.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, truth, wrong
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: gyro

      call make(record, truth)
      wrong = truth
      wrong%value = truth%value(:3999, :)
      call run_pipeline(record, filters_only(-1), result, gyro, truth=wrong)
      call expect("3999 samples, the record 4000")
      if (allocated(error)) return
      wrong = truth
      wrong%sample_interval = 0.1_dp
      call run_pipeline(record, filters_only(-1), result, gyro, truth=wrong)
      call expect("samples a second")
      if (allocated(error)) return
      wrong = truth
      call parse_unit("m/s^2", wrong%unit, gyro)
      call run_pipeline(record, filters_only(-1), result, gyro, truth=wrong)
      call expect("the record in deg/s")

   contains

      subroutine expect(fragment)
         character(*), intent(in) :: fragment

         call check_refused(error, gyro, status%invalid_argument)
         if (allocated(error)) return
         call check(error, index(gyro%message, fragment) > 0, gyro%message)
      end subroutine expect
   end subroutine test_refused

end module test_truth
