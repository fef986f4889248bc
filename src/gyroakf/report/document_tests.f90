! SPDX-License-Identifier: MIT
!> Verdict, tests and AR model of a channel, described.
module gyroakf_report_document_tests
   use gyroakf_kinds, only : dp
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_document_distribution, only : put_distribution, put_fisher, put_welch
   use gyroakf_report_verdicts, only : correlation_caution, normality_text, rejection_text, &
      verdict_text, whiteness_text
   use gyroakf_series_adf, only : adf_type
   use gyroakf_stats_whiteness, only : ljung_box_type
   implicit none (type, external)
   private
   public :: put_verdict, put_tests, put_ljung_box, put_ar

contains

   !> "verdict": null where none was looked for.
   subroutine put_verdict(out, record, channel)
      class(description_type), intent(inout) :: out
      !> For the units
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel

      if (.not. out%opens("verdict", channel%verdict%wanted, "Verdict")) return
      associate (verdict => channel%verdict, trend => channel%verdict%trend)
         call out%remark(verdict_text(channel))
         call out%put("stationary", verdict%stationary, verdict%stationary .or. verdict%drifts, &
                      shown=.false.)
         call out%put("drift", trim(verdict%drift), shown=.false.)
         if (out%opens("trend", trend%shape /= "")) then
            call out%put("shape", trim(merge("ramp   ", "warm_up", trend%shape == "ramp")))
            call out%put("size", trend%size, std_error=trend%std_error)
            call out%put("std_error", trend%std_error, shown=.false.)
            call out%put("time_constant_s", trend%time_constant*record%sample_interval, &
                         trend%shape /= "ramp" .and. record%rate_known)
            call out%put("gain", trend%gain)
            call out%close()
         end if
         call out%put_texts("reasons", verdict%reasons)
         call out%close()
      end associate
   end subroutine put_verdict

   !> "tests".
   subroutine put_tests(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      character(1), parameter :: bound(-1:1) = ["<", "=", ">"]

      call out%open("tests", "Tests")
      call out%put("series", trim(channel%tested), title="of the")
      if (out%opens("adf", channel%available%adf, "ADF")) call put_adf(out, channel%adf)
      if (out%opens("kpss", channel%available%kpss, "KPSS")) then
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
      end if
      if (out%opens("jarque_bera", channel%available%jarque_bera, "Jarque-Bera")) then
         associate (test => channel%jarque_bera)
            call out%remark(normality_text(channel))
            call out%put("statistic", test%statistic)
            call out%put("p_value", test%p_value)
            call out%put("skewness", test%skewness, std_error=test%skewness_error)
            call out%put("kurtosis", test%kurtosis, std_error=test%kurtosis_error)
            call out%put("skewness_std_error", test%skewness_error, shown=.false.)
            call out%put("kurtosis_std_error", test%kurtosis_error, shown=.false.)
            call out%remark(correlation_caution(channel))
            call out%close()
         end associate
      end if
      call put_ljung_box(out, "ljung_box", "Ljung-Box", channel%ljung_box, &
                         channel%available%ljung_box)
      call put_fisher(out, channel)
      call put_distribution(out, channel)
      call put_welch(out, channel)
      call out%close()
   end subroutine put_tests

   !> The members of "adf", the coefficients of the regression where they were asked for.
   subroutine put_adf(out, adf)
      class(description_type), intent(inout) :: out
      type(adf_type), intent(in) :: adf
      integer :: i

      call out%remark(rejection_text("unit root", adf%stationary))
      call out%put("statistic", adf%statistic)
      call out%put("p_value", adf%p_value)
      call out%put("lag", adf%lag)
      call out%put("observations", adf%observations)
      call out%put("regression", trim(adf%regression))
      call out%open("critical", "critical values")
      call out%put("1%", adf%critical(1))
      call out%put("5%", adf%critical(2))
      call out%put("10%", adf%critical(3))
      call out%close()
      call out%put("stationary", adf%stationary, shown=.false.)
      call out%put("criterion", trim(adf%criterion), adf%lag_chosen)
      call out%put("criterion_value", adf%criterion_value, adf%lag_chosen, shown=.false.)
      call out%put("max_lags", adf%max_lags)
      call out%put("wanted_lags", adf%wanted_lags, shown=.false.)
      call out%put("level", adf%level)
      call out%put("noise_variance", adf%noise_variance)
      if (out%opens("table", allocated(adf%table), "Regression", list=.true.)) then
         do i = 1, size(adf%table)
            call out%open("")
            call out%put("name", trim(adf%table(i)%name), title="coefficient")
            call out%put("value", adf%table(i)%value, std_error=adf%table(i)%std_error)
            call out%put("std_error", adf%table(i)%std_error, shown=.false.)
            call out%put("t", adf%table(i)%t)
            call out%close()
         end do
         call out%close()
      end if
      call out%close()
   end subroutine put_adf

   !> A Ljung-Box test.
   subroutine put_ljung_box(out, key, title, test, available)
      class(description_type), intent(inout) :: out
      !> Its key, and what a text calls it
      character(*), intent(in) :: key, title
      !> The test
      type(ljung_box_type), intent(in) :: test
      !> Null where it was not made
      logical, intent(in) :: available

      if (.not. out%opens(key, available, title)) return
      call out%remark(whiteness_text(test))
      call out%put("statistic", test%statistic)
      call out%put("p_value", test%p_value)
      call out%put("lags", test%lags)
      call out%put("largest_rho", test%largest_rho, title="largest |rho|")
      call out%put("largest_lag", test%largest_lag, title="at lag")
      call out%close()
   end subroutine put_ljung_box

   !> "ar".
   subroutine put_ar(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. out%opens("ar", channel%available%ar, "AR model")) return
      associate (model => channel%ar)
         call out%put("method", trim(model%method))
         call out%put("criterion", trim(model%criterion))
         call out%put("order", model%order)
         call out%put("coefficients", model%coefficient, std_errors=model%std_error)
         call out%put("std_errors", model%std_error, shown=.false.)
         call out%put("noise_variance", model%noise_variance)
         call out%put("mean", model%mean, shown=.false.)
         call out%open("table", shown=.false., list=.true.)
         do i = lbound(model%table, 1), ubound(model%table, 1)
            call out%open("")
            call out%put("order", model%table(i)%order)
            call out%put("noise_variance", model%table(i)%noise_variance)
            call out%put("aic", model%table(i)%aic)
            call out%put("aicc", model%table(i)%aicc)
            call out%put("bic", model%table(i)%bic)
            call out%put("hqic", model%table(i)%hqic)
            call out%put("fpe", model%table(i)%fpe)
            call out%put("aic_per_observation", model%table(i)%aic_per_observation)
            call out%close()
         end do
         call out%close()
         call put_ljung_box(out, "residual_ljung_box", "Residuals", model%residual_ljung_box, &
                            model%residual_ljung_box%lags > 0)
         call out%put("stationary", model%stationary, shown=.not. model%stationary)
         call out%open("roots", "Roots", list=.true.)
         do i = 1, merge(model%order, 0, allocated(model%root))
            call out%open("")
            call out%put("real", model%root(i)%real_part)
            call out%put("imaginary", model%root(i)%imaginary_part)
            call out%put("modulus", model%root(i)%modulus)
            call out%put("frequency", model%root(i)%frequency)
            call out%put("time_constant_samples", model%root(i)%time_constant)
            call out%put("damping", model%root(i)%damping)
            call out%close()
         end do
         call out%close()
         call out%put("rows", model%rows, shown=.false.)
         call out%put("compared_rows", model%compared_rows, shown=.false.)
         call out%put("intercept", model%intercept, std_error=model%intercept_std_error, &
                      shown=model%method == "ols")
         call out%put("intercept_std_error", model%intercept_std_error, model%method == "ols", &
                      shown=.false.)
         call out%put("unbiased_variance", model%unbiased_variance, shown=.false.)
         call out%put("residual_variance", model%residual_variance, shown=.false.)
         if (out%opens("residual_normality", model%residual_normality%kurtosis > 0.0_dp, &
                       "Jarque-Bera")) then
            call out%put("statistic", model%residual_normality%statistic)
            call out%put("p_value", model%residual_normality%p_value)
            call out%put("skewness", model%residual_normality%skewness)
            call out%put("kurtosis", model%residual_normality%kurtosis)
            call out%close()
         end if
         call out%close()
      end associate
   end subroutine put_ar

end module gyroakf_report_document_tests
