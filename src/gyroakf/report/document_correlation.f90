! SPDX-License-Identifier: MIT
!> The tests of stationarity and whiteness in the JSON document.
module gyroakf_report_document_correlation
   use gyroakf_stats_whiteness, only : ljung_box_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_json, only : json_type, open_object, close_object, put_member, put_null
   implicit none (type, external)
   private
   public :: put_kpss, put_ljung_box

contains

   !> "kpss": p_bound says whether p is below, at or above p_value, which the table bounds.
   subroutine put_kpss(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel
      character(1), parameter :: bound(-1:1) = ["<", "=", ">"]

      if (.not. channel%available%kpss) then
         call put_null(json, "kpss")
         return
      end if
      call open_object(json, "kpss")
      call put_member(json, "statistic", channel%kpss%statistic)
      call put_member(json, "p_value", channel%kpss%p_value)
      call put_member(json, "lags", channel%kpss%lags)
      call put_member(json, "regression", trim(channel%kpss%regression))
      call put_member(json, "p_bound", bound(channel%kpss%p_bound))
      call put_member(json, "p_asymptotic", channel%kpss%p_asymptotic)
      call put_member(json, "rule", trim(channel%kpss%rule))
      call put_member(json, "observations", channel%kpss%observations)
      call open_object(json, "critical")
      call put_member(json, "1%", channel%kpss%critical(4))
      call put_member(json, "2.5%", channel%kpss%critical(3))
      call put_member(json, "5%", channel%kpss%critical(2))
      call put_member(json, "10%", channel%kpss%critical(1))
      call close_object(json)
      call put_member(json, "stationary", channel%kpss%stationary)
      call put_member(json, "long_run_variance", channel%kpss%long_run_variance)
      call put_member(json, "drift", channel%kpss%drift)
      call close_object(json)
   end subroutine put_kpss

   !> A Ljung-Box test.
   subroutine put_ljung_box(json, key, test, available)
      !> The document
      type(json_type), intent(inout) :: json
      !> Its key
      character(*), intent(in) :: key
      !> The test
      type(ljung_box_type), intent(in) :: test
      !> Null where it was not made
      logical, intent(in) :: available

      if (.not. available) then
         call put_null(json, key)
         return
      end if
      call open_object(json, key)
      call put_member(json, "statistic", test%statistic)
      call put_member(json, "p_value", test%p_value)
      call put_member(json, "lags", test%lags)
      call put_member(json, "largest_rho", test%largest_rho)
      call put_member(json, "largest_lag", test%largest_lag)
      call close_object(json)
   end subroutine put_ljung_box

end module gyroakf_report_document_correlation
