! SPDX-License-Identifier: MIT
!> Tests of the Ljung-Box test. The statistics were computed in exact arithmetic from the doubles of
!> the series (series_library, 1000 samples each) and rounded once.
module test_whiteness
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box, ljung_box_of
   use series_library, only : reference_series, reference_names
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_whiteness

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> 1, 10 and 20 lags in the order of reference_names
   integer, parameter :: lags_of(3) = [1, 10, 20]
   real(dp), parameter :: statistic_of(3,11) = reshape([ &
      & 0.1394540120215431_dp, 14.79311288288673_dp, 25.35254198479461_dp, 0.42207698720593434_dp, &
      & 11.494483108101397_dp, 13.791433499381332_dp, 0.7127903200187425_dp, 10.01074383529652_dp, &
      & 21.34074490375695_dp, 985.3565119371316_dp, 9185.55233308164_dp, 17169.2404783144_dp, 473.2944872544328_dp, &
      & 797.130895252274_dp, 812.8440726338339_dp, 944.7762308581127_dp, 7307.461495611169_dp, &
      & 11600.802622627683_dp, 642.2594066669759_dp, 1074.3896230553232_dp, 1105.262463164637_dp, &
      & 71.35331231527326_dp, 585.5846825571614_dp, 1185.342613102351_dp, 495.49729282487345_dp, &
      & 887.5344894280644_dp, 899.1371737352689_dp, 473.29448725834925_dp, 797.1308952355012_dp, &
      & 812.8440726147462_dp, 2.2543422119164505_dp, 26.84206946831816_dp, 39.585056126243416_dp], [3, 11])
   !> p-values with 20 lags, exp(-Q/2) times the sum of ten terms, 40 digits
   real(dp), parameter :: p_value_of(11) = [ &
      & 0.18827502643423524_dp, 0.8409112919907766_dp, 0.3773262476364291_dp, 0.0_dp, 2.6539038312741094e-159_dp, &
      & 0.0_dp, 1.3322300934205683e-221_dp, 1.0193379456230724e-238_dp, 1.1995171418806822e-177_dp, &
      & 2.653903856043061e-159_dp, 0.005634438034208173_dp]

contains

   subroutine suite_whiteness()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("offset_scale", test_offset_scale)
      call test("missing", test_missing)
      call test("fitted", test_fitted)
      call test("failures", test_failures)
   end subroutine suite_whiteness

   !> 1 2 3 4: rho = 1/4, -3/10; Q = 4 6 (1/48 + 9/200).
   subroutine test_by_hand()
      type(ljung_box_type) :: lb

      call test_ljung_box([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], 2, 0, lb, problem)
      if (went_wrong(problem)) return
      call check(error, lb%statistic, 24.0_dp*(1.0_dp/48.0_dp + 0.045_dp), thr=tolerance)
      call check(error, lb%p_value, exp(-12.0_dp*(1.0_dp/48.0_dp + 0.045_dp)), thr=tolerance)
      call check(error, lb%largest_rho, 0.3_dp, thr=tolerance)
      call check(error, lb%lags, 2)
   end subroutine test_by_hand

   !> The eleven series; a p-value moves by Q/2 times the rounding of Q.
   subroutine test_reference()
      type(ljung_box_type) :: lb
      integer :: i, j

      do i = 1, size(reference_names)
         do j = 1, size(lags_of)
            call test_ljung_box(reference_series(trim(reference_names(i)), 1000), lags_of(j), 0, lb, problem)
            if (went_wrong(problem)) return
            call check(error, lb%statistic, statistic_of(j, i), reference_names(i), thr=tolerance, rel=.true.)
         end do
         call check(error, abs(lb%p_value - p_value_of(i)) <= tolerance*max(1.0_dp, lb%statistic)*p_value_of(i), &
            & "p-value of "//reference_names(i))
      end do
   end subroutine test_reference

   !> An offset of 2^40 and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024.
   subroutine test_offset_scale()
      type(ljung_box_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("wn", 9000))/1024.0_dp
      call test_ljung_box(x, 15, 0, a, problem)
      call test_ljung_box((x + 2.0_dp**40)*2.0_dp**(-50), 15, 0, b, problem)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, b%largest_rho, a%largest_rho, thr=tolerance, rel=.true.)
   end subroutine test_offset_scale

   !> An all-present mask changes nothing; white noise with 5 % and 40 % lost stays white, and AR(1)
   !> noise does not become it.
   subroutine test_missing()
      type(ljung_box_type) :: a, b
      real(dp), allocatable :: x(:), u(:)
      integer(int8), allocatable :: valid(:)

      x = reference_series("wn_bm", 5000)
      u = reference_series("unif", 5000)
      allocate (valid(size(x)), source=1_int8)
      call test_ljung_box(x, 20, 0, a, problem)
      call test_ljung_box(x, 20, 0, b, problem, valid)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      valid = merge(0_int8, 1_int8, cshift(u, 2500) < 0.05_dp)
      call test_ljung_box(x, 20, 0, b, problem, valid)
      call check(error, b%p_value > 0.001_dp, "5 % lost: white noise was rejected")
      valid = merge(0_int8, 1_int8, cshift(u, 2500) < 0.4_dp)
      call test_ljung_box(x, 20, 0, b, problem, valid)
      call check(error, b%p_value > 0.001_dp .and. b%statistic > 5.0_dp, "40 % lost: not chi-square with 20 degrees")
      call test_ljung_box(reference_series("ar1", 5000), 20, 0, b, problem, valid)
      call check(error, b%p_value < 1.0e-10_dp, "40 % lost: AR(1) was accepted")
   end subroutine test_missing

   !> Fitted parameters cost degrees of freedom: with 4 lags and 2 parameters p = exp(-Q/2).
   subroutine test_fitted()
      type(ljung_box_type) :: lb
      real(dp), allocatable :: r(:)
      real(dp) :: mean

      call compute_autocovariance(reference_series("wn", 1000), 4, mean, r, problem)
      call ljung_box_of(r, 1000_int64, 2, lb, problem)
      call check(error, lb%p_value, exp(-0.5_dp*lb%statistic), thr=tolerance)
      call check(error, lb%fitted, 2)
   end subroutine test_fitted

   !> Each error.
   subroutine test_failures()
      type(ljung_box_type) :: lb
      real(dp) :: x(5)

      x = 0.1_dp
      call test_ljung_box(x, 3, 3, lb, problem)
      call check_refused(problem, status%invalid_argument)
      call test_ljung_box(x, 5, 0, lb, problem)
      call check_refused(problem, status%too_few_samples)
      call test_ljung_box(x, 2, 0, lb, problem)
      call check_refused(problem, status%constant_input)
   end subroutine test_failures

end module test_whiteness
