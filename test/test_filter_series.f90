! SPDX-License-Identifier: MIT
!> Tests of a filter over a whole series and of its diagnostics.
module test_filter_series
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter, run_filter
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   use filter_library, only : fill_noise, make_series, paper_phi
   use expectations, only : unmet, failure => problem, test, error, check, check_refused
   implicit none (type, external)
   private
   public :: suite_filter_series

   !> The same sums in another order
   real(dp), parameter :: rounding = 1.0e-12_dp

contains

   subroutine suite_filter_series()
      call test("diagnostics_direct", test_direct)
      call test("diagnostics_with_gaps", test_gaps)
      call test("paper_kalman_filter", test_paper)
      call test("right_model_is_silent", test_right_model)
      call test("wrong_model_is_named", test_wrong_model)
      call test("adaptation_is_named", test_adaptation)
      call test("gate_is_named", test_gate)
      call test("collapse_is_named", test_collapse)
      call test("white_model_is_named", test_white)
      call test("refused", test_refused)
   end subroutine suite_filter_series

   !> Every number against the whole series at once; longer than two blocks
   subroutine test_direct()
      type(filter_type) :: filter, other
      type(filter_result_type) :: result
      type(ljung_box_type) :: whiteness
      real(dp) :: z(10001), x(10001), y(10001), nu(10001), mean

      call make_series(72, 0.9_dp, 1.0_dp, 3.0_dp, z)
      call new_filter(filter, [0.8_dp, 0.1_dp], 0.2_dp, 2.0_dp, filter_options(), failure)
      other = filter
      call filter_series(filter, z, x, result, failure)
      call run_filter(other, z, y, normalized_innovation=nu)
      call check(error, maxval(abs(x - y)), 0.0_dp)
      mean = sum(x)/size(x)
      call check(error, result%mean, mean, thr=rounding)
      call check(error, result%variance, sum((x - mean)**2)/10000, thr=rounding, rel=.true.)
      call check(error, result%nis_mean, sum(nu**2)/size(nu), thr=rounding, rel=.true.)
      if (allocated(error)) return
      call test_ljung_box(nu, 20, 0, whiteness, failure)
      call check(error, result%ljung_box%statistic, whiteness%statistic, thr=1.0e-10_dp, rel=.true.)
      call check(error, result%gain, filter%gain(1), thr=rounding)
      call check(error, result%steps, 10001_int64)
   end subroutine test_direct

   !> Missing by mask and by NaN give one result, that of the present samples
   subroutine test_gaps()
      type(filter_type) :: filter, other
      type(filter_result_type) :: result, by_nan
      type(ljung_box_type) :: whiteness
      real(dp) :: z(6000), x(6000), nu(6000), mean
      integer(int8) :: valid(6000)
      integer :: k

      call make_series(73, 0.9_dp, 1.0_dp, 3.0_dp, z)
      valid = [(int(merge(0, 1, mod(k*k, 7) == 4), int8), k=1, 6000)]
      call new_filter(filter, [0.9_dp], 0.19_dp, 3.0_dp, filter_options(), failure)
      other = filter
      call run_filter(other, z, x, valid, nu)
      other = filter
      call filter_series(filter, z, x, result, failure, valid)
      where (valid == 0_int8) z = ieee_value(1.0_dp, ieee_quiet_nan)
      call filter_series(other, z, x, by_nan, failure)
      call check(error, result%variance, by_nan%variance)
      mean = sum(x, valid == 1_int8)/count(valid == 1_int8)
      call check(error, result%mean, mean, thr=rounding)
      call check(error, result%nis_mean, sum(nu**2)/count(valid == 1_int8), thr=rounding, rel=.true.)
      call test_ljung_box(nu, 20, 0, whiteness, failure, valid)
      call check(error, result%ljung_box%statistic, whiteness%statistic, thr=1.0e-10_dp, rel=.true.)
   end subroutine test_gaps

   !> The paper's filter: 60.7 % of a rotation passes, NIS 0.46, with a warning
   subroutine test_paper()
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(12000), x(12000)

      call make_series(74, paper_phi, 5.24e-4_dp, 0.0_dp, z)
      call new_filter(filter, [paper_phi], 5.24e-4_dp*(1 - paper_phi**2), 5.24e-4_dp, filter_options(), failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, result%dc_gain, 0.607205610250273_dp, thr=1.0e-12_dp)
      call check(error, result%nis_mean, 0.46_dp, thr=0.03_dp)
      call check(error, result%variance, 1.491e-4_dp, thr=0.06_dp, rel=.true.)
      call check(error, has(result, "keeps 60.7 %"), "the DC gain is not named")
      call check(error, has(result, "variances that the filter states"), "the NIS is not named")
      call check(error, size(result%estimate), 0)
   end subroutine test_paper

   !> Whether a warning holds this text
   pure logical function has(result, text)
      type(filter_result_type), intent(in) :: result
      character(*), intent(in) :: text
      integer :: i

      has = .false.
      do i = 1, size(result%warnings)
         has = has .or. index(result%warnings(i)%text, text) > 0
      end do
   end function has

   !> The model of the series: NIS 1, white, only the attenuation is named
   subroutine test_right_model()
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(20000), x(20000)

      call make_series(75, 0.98_dp, 1.0_dp, 4.0_dp, z)
      call new_filter(filter, [0.98_dp], 0.0396_dp, 4.0_dp, filter_options(), failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, result%nis_mean, 1.0_dp, thr=0.03_dp)
      call check(error, result%ljung_box%largest_rho < 0.03_dp, "the innovations are not white")
      if (unmet(size(result%warnings), 1)) return
      call check(error, has(result, "constant true rotation"), "the attenuation is not named")
   end subroutine test_right_model

   !> A slow drift filtered as a fast one
   subroutine test_wrong_model()
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(20000), x(20000)

      call make_series(76, 0.999_dp, 1.0_dp, 1.0_dp, z)
      call new_filter(filter, [0.3_dp], 1.0_dp, 1.0_dp, filter_options(), failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, has(result, "not white"), "whiteness is not judged")
   end subroutine test_wrong_model

   !> Q and R, q and r; R towards zero; what an adapted mean does to a constant rotation
   subroutine test_adaptation()
      type(filter_type) :: filter
      type(filter_options) :: options
      type(filter_result_type) :: result
      real(dp) :: z(20000), x(20000)

      call make_series(77, paper_phi, 1.0_dp, 0.0_dp, z)
      options%estimate_measurement_variance = .true.
      call new_filter(filter, [paper_phi], 0.83_dp, 1.0_dp, options, failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, has(result, "R has fallen towards zero") .and. result%forgetting > 0.97_dp, "R -> 0 is not named")
      options%estimate_process_variance = .true.
      options%estimate_process_mean = .true.
      options%estimate_measurement_mean = .true.
      call new_filter(filter, [paper_phi], 0.83_dp, 1.0_dp, options, failure)
      call check_refused(failure, status%invalid_argument)
      options%allow_unobservable = .true.
      call new_filter(filter, [paper_phi], 0.83_dp, 1.0_dp, options, failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, has(result, "Q and R are both") .and. has(result, "q and r are both"), "not identifiable, and not said")
      call check(error, result%estimate(1)%text//result%estimate(2)%text//result%estimate(3)%text//result%estimate(4)%text, "qrQR")
      call check(error, result%dc_gain, result%gain/(result%gain + 1 - paper_phi), thr=rounding)
   end subroutine test_adaptation

   !> A tenth of the samples far out
   subroutine test_gate()
      type(filter_type) :: filter
      type(filter_options) :: options
      type(filter_result_type) :: result
      real(dp) :: z(5000), x(5000)

      call make_series(78, 0.9_dp, 1.0_dp, 1.0_dp, z)
      z(::10) = z(::10) + 20
      options%huber = 2.5_dp
      call new_filter(filter, [0.9_dp], 0.19_dp, 1.0_dp, options, failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, result%gated > 500_int64, "the gate does not act")
      call check(error, has(result, "the gate acted at 1"), "the gate is not named")
   end subroutine test_gate

   !> Bounds that let Q go: the gain collapses, and the bound is named
   subroutine test_collapse()
      type(filter_type) :: filter
      type(filter_options) :: options
      type(filter_result_type) :: result
      real(dp) :: z(20000), x(20000)

      call fill_noise(79, z)
      options%estimate_process_variance = .true.
      options%forgetting = 0.9_dp
      options%q_lower = 1.0e-9_dp
      call new_filter(filter, [0.5_dp], 10.0_dp, 30.0_dp, options, failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, has(result, "collapsed"), "the collapse is not named")
      options%q_lower = 1.0e-1_dp
      call new_filter(filter, [0.5_dp], 10.0_dp, 30.0_dp, options, failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, has(result, "held at a bound"), "the bound is not named")
   end subroutine test_collapse

   subroutine test_white()
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(500), x(500), none(0)

      call fill_noise(80, z)
      call new_filter(filter, none, 1.0_dp, 1.0_dp, filter_options(), failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, result%gain, 0.5_dp)
      call check(error, has(result, "nothing to predict"), "a white model is not named")
   end subroutine test_white

   subroutine test_refused()
      type(filter_type) :: filter, never_made
      type(filter_result_type) :: result
      real(dp) :: z(100), x(100)
      integer(int8) :: valid(100)

      call fill_noise(81, z)
      call new_filter(filter, [0.5_dp], 1.0_dp, 1.0_dp, filter_options(), failure)
      call filter_series(filter, z(:29), x(:29), result, failure)
      call check_refused(failure, status%too_few_samples)
      valid = 0_int8
      call filter_series(filter, z, x, result, failure, valid)
      if (unmet(allocated(failure), "no sample is there")) return
      call filter_series(filter, z, x(:99), result, failure)
      call check_refused(failure, status%invalid_argument)
      call filter_series(never_made, z, x, result, failure)
      call check(error, allocated(failure), "the filter was not made")
   end subroutine test_refused
end module test_filter_series
