! SPDX-License-Identifier: MIT
!> The tests of stationarity and whiteness in the JSON document.
module gyroakf_report_document_correlation
   use gyroakf_stats_whiteness, only : ljung_box_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_verdicts, only : rejection_text, whiteness_text
   implicit none (type, external)
   private
   public :: put_kpss, put_ljung_box

contains

   !> "kpss": p_bound says whether p is below, at or above p_value, which the table bounds.
   subroutine put_kpss(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel
      character(1), parameter :: bound(-1:1) = ["<", "=", ">"]

      if (.not. channel%available%kpss) then
         call out%absent("kpss")
         return
      end if
      call out%open("kpss", "KPSS")
      call out%remark(rejection_text("level stationarity", .not. channel%kpss%stationary))
      call out%put("statistic", channel%kpss%statistic)
      call out%put("p_value", channel%kpss%p_value, title="p "//bound(channel%kpss%p_bound))
      call out%put("lags", channel%kpss%lags)
      call out%put("regression", trim(channel%kpss%regression))
      call out%put("p_bound", bound(channel%kpss%p_bound), shown=.false.)
      call out%put("p_asymptotic", channel%kpss%p_asymptotic)
      call out%put("rule", trim(channel%kpss%rule))
      call out%put("observations", channel%kpss%observations)
      call out%open("critical", "critical values")
      call out%put("1%", channel%kpss%critical(4))
      call out%put("2.5%", channel%kpss%critical(3))
      call out%put("5%", channel%kpss%critical(2))
      call out%put("10%", channel%kpss%critical(1))
      call out%close()
      call out%put("stationary", channel%kpss%stationary, shown=.false.)
      call out%put("long_run_variance", channel%kpss%long_run_variance)
      call out%put("drift", channel%kpss%drift)
      call out%close()
   end subroutine put_kpss

   !> A Ljung-Box test.
   subroutine put_ljung_box(out, key, title, test, available)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> Its key, and what a text calls it
      character(*), intent(in) :: key, title
      !> The test
      type(ljung_box_type), intent(in) :: test
      !> Null where it was not made
      logical, intent(in) :: available

      if (.not. available) then
         call out%absent(key)
         return
      end if
      call out%open(key, title)
      call out%remark(whiteness_text(test))
      call out%put("statistic", test%statistic)
      call out%put("p_value", test%p_value)
      call out%put("lags", test%lags)
      call out%put("largest_rho", test%largest_rho, title="largest |rho|")
      call out%put("largest_lag", test%largest_lag, title="at lag")
      call out%close()
   end subroutine put_ljung_box

end module gyroakf_report_document_correlation
