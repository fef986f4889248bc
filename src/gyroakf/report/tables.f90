! SPDX-License-Identifier: MIT
!> The tables of a channel: tests, Table I (AR models), Table II (filters), Table III (noise
!> coefficients).
module gyroakf_report_tables
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_pipeline_result, only : allan_result_type, channel_result_type, &
      filter_figures_type, stage
   use gyroakf_record, only : record_type
   use gyroakf_report_input, only : has_unit, unit_name
   use gyroakf_report_text_layout, only : count_text, fixed, if_known, number, p_value_text, &
      percent, scientific
   use gyroakf_report_text_table, only : add_cell, add_row, new_table, table_type
   use gyroakf_report_verdicts, only : level, whiteness_word
   use gyroakf_units, only : quantity
   implicit none (type, external)
   private
   public :: make_tests_table, kpss_p_text, bare, make_ar_table, make_filter_table, full_name, &
      make_comparison

contains

   !> A row for each test that has a result: what it takes for granted, its statistic, and whether
   !> it rejects that at 5 %.
   subroutine make_tests_table(channel, table)
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table

      call new_table(table, 6, left=2)
      table%caption = "Tests of the "//trim(channel%tested)
      table%note = "Critical values and rejections are those of a significance of 5 %."
      call add_row(table, "test", "null hypothesis", "statistic", "critical", "p", "rejected")
      associate (is => channel%available, adf => channel%adf, kpss => channel%kpss, &
                 jarque_bera => channel%jarque_bera, anderson => channel%anderson_darling, &
                 ljung_box => channel%ljung_box)
         if (is%adf) call add_test("augmented Dickey-Fuller", "unit root", adf%statistic, &
                                   bare(adf%p_value), adf%p_value < level, adf%critical(2))
         if (is%kpss) call add_test("KPSS", "stationary", kpss%statistic, kpss_p_text(channel), &
                                    .not. kpss%stationary, kpss%critical(2))
         if (is%jarque_bera) call add_test("Jarque-Bera", "normal", jarque_bera%statistic, &
                                           bare(jarque_bera%p_value), jarque_bera%p_value < level)
         if (is%anderson_darling) call add_test("Anderson-Darling", "normal", anderson%modified, &
                                                bare(anderson%p_value), anderson%p_value < level)
         if (is%ljung_box) call add_test("Ljung-Box", "white", ljung_box%statistic, &
                                         bare(ljung_box%p_value), ljung_box%p_value < level)
      end associate

   contains

      subroutine add_test(name, hypothesis, statistic, p, rejected, critical)
         character(*), intent(in) :: name, hypothesis, p
         real(dp), intent(in) :: statistic
         logical, intent(in) :: rejected
         real(dp), intent(in), optional :: critical
         character(:), allocatable :: limit

         limit = ""
         if (present(critical)) limit = number(critical, 4)
         call add_row(table, name, hypothesis, number(statistic, 4), limit, p, &
                      if_known(rejected, "yes", "no"))
      end subroutine add_test

   end subroutine make_tests_table

   !> Beyond its table the probability is known as a bound.
   pure function kpss_p_text(channel) result(text)
      !> With its KPSS test
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      select case (channel%kpss%p_bound)
      case (-1); text = "< 0.01"
      case (1); text = "> 0.10"
      case default; text = bare(channel%kpss%p_value)
      end select
   end function kpss_p_text

   !> "0.03", "< 1e-20".
   pure function bare(p) result(text)
      !> Probability
      real(dp), intent(in) :: p
      character(:), allocatable :: text

      text = p_value_text(p)
      text = text(3:)
      if (text(:2) == "= ") text = text(3:)
   end function bare

   !> Table I: a row for each order, with every criterion.
   subroutine make_ar_table(record, channel, table)
      !> For the unit
      type(record_type), intent(in) :: record
      !> `ar` is available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table
      integer :: i

      call new_table(table, 8, left=0)
      table%number = "I"
      table%caption = "AR models ("//full_name(channel%ar%method)//", n = "// &
         count_text(channel%ar%compared_rows)//", variances in ("//unit_name(record)// &
         ")^2); * is the order chosen by "//full_name(channel%ar%criterion)
      call add_row(table, "order", "variance", "AIC", "AICc", "BIC", "HQIC", "FPE", "AIC/n")
      do i = lbound(channel%ar%table, 1), ubound(channel%ar%table, 1)
         associate (line => channel%ar%table(i))
            call add_row(table, merge("* ", "  ", line%order == channel%ar%order)// &
                         count_text(int(line%order, int64)), &
                         scientific(line%noise_variance, 5), criterion(line%aic), &
                         criterion(line%aicc), criterion(line%bic), criterion(line%hqic), &
                         scientific(line%fpe, 5), fixed(line%aic_per_observation, 6))
         end associate
      end do
   end subroutine make_ar_table

   !> Decimals down to what a difference has to have, limited by the width of a column.
   pure function criterion(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text

      text = fixed(value, count(abs(value) < [1e5_dp, 1e6_dp]))
   end function criterion

   !> What an option has as a key: "yw" is Yule-Walker, "aicc" AICc.
   pure function full_name(key) result(name)
      !> Method or criterion of the AR model
      character(*), intent(in) :: key
      character(:), allocatable :: name

      select case (key)
      case ("yw"); name = "Yule-Walker"
      case ("burg"); name = "Burg"
      case ("ols"); name = "least squares"
      case ("aicc"); name = "AICc"
      case ("aic"); name = "AIC"
      case ("bic"); name = "BIC"
      case ("hqic"); name = "HQIC"
      case ("fpe"); name = "FPE"
      case default; name = trim(key)
      end select
   end function full_name

   !> Table II: a row for each series and for each filter of both families.
   subroutine make_filter_table(record, channel, table)
      !> For the unit
      type(record_type), intent(in) :: record
      !> Filters are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table
      character(:), allocatable :: text

      call new_table(table, 9, head=merge(2, 1, has_unit(record)))
      table%number = "II"
      table%caption = "Before and after the filters"
      if (.not. has_unit(record)) table%caption = table%caption//", in input units"
      call add_row(table, "", "mean", "variance", "ratio", "gain", "DC gain", "NIS", "|rho|", &
                   "innov.")
      if (has_unit(record)) call add_row(table, "", unit_name(record), &
                                         "("//unit_name(record)//")^2")
      associate (is => channel%available)
         call add_series("raw", channel%raw%mean, channel%raw%variance)
         call add_series("cleaned", channel%cleaned%mean, channel%cleaned%variance, "100 %")
         if (is%kf) call add_filter("KF (paper)", channel%kf, channel%kf_figures)
         if (is%akf) call add_filter("AKF (paper)", channel%akf, channel%akf_figures)
         if (channel%drift%found .and. is%preprocess) call add_series("no outliers", &
            channel%level%mean, channel%level%variance, "100 %")
         if (is%drift_kf) call add_filter("drift KF", channel%drift_kf, channel%drift_kf_figures)
         if (is%drift_akf) call add_filter("drift AKF", channel%drift_akf, &
                                           channel%drift_akf_figures)
         if (is%drift_smoother) then
            call add_filter("smoother", channel%drift_smoother, channel%drift_smoother_figures)
            call add_series("compensated", channel%compensated%mean, &
                            channel%compensated%variance, percent(channel%compensated_ratio))
            call add_cell(table, "")
            call add_cell(table, fixed(channel%drift_smoother_figures%lost_percent/100, 4))
         end if
         text = "ratio: variance over that of the series above that is filtered. gain: mean of "// &
            "the last third. DC gain: share of a constant rotation passed. NIS: mean squared "// &
            "normalized innovation, 1 where Q and R describe the innovations"
         if (is%kf .and. channel%kf%nis_high > 0.0_dp) text = text//" (95 % of such filters "// &
            "within "//fixed(channel%kf%nis_low, 3)//" to "//fixed(channel%kf%nis_high, 3)//")"
         text = text//". |rho|: largest autocorrelation of the innovations."
         if (is%drift_kf .or. is%drift_akf) text = text//" The paper's filters give out the "// &
            "whole signal, smoothed; the drift filters the drift alone, to be subtracted, and "// &
            "a rotation passes into it: estimate it at rest, only predict it in motion."// &
            if_known(channel%drift%found .and. is%preprocess, " They see the raw record "// &
                     "without its outliers; its trend is drift to them.")
         if (is%drift_smoother) text = text//" compensated: the record less its smoothed "// &
            "drift. In-sample: the drift was taken from the same record, before and after "// &
            "each sample; no filter in use does as well."
         table%note = text
      end associate

   contains

      !> A series; further cells may follow.
      subroutine add_series(name, mean, variance, share)
         character(*), intent(in) :: name
         real(dp), intent(in) :: mean, variance
         character(*), intent(in), optional :: share

         call add_row(table, name, scientific(mean, 4), scientific(variance, 5), share)
      end subroutine add_series

      !> A filter; a smoother has no innovations.
      subroutine add_filter(name, filter, figures)
         character(*), intent(in) :: name
         type(filter_result_type), intent(in) :: filter
         type(filter_figures_type), intent(in) :: figures
         logical :: measured

         measured = filter%nis_high > 0.0_dp
         call add_series(name, filter%mean, filter%variance, percent(figures%variance_ratio))
         call add_cell(table, if_known(measured, number(filter%gain, 2)))
         call add_cell(table, fixed(filter%dc_gain, 4))
         if (.not. measured) return
         call add_cell(table, fixed(filter%nis_mean, 3))
         call add_cell(table, number(filter%ljung_box%largest_rho, 2))
         call add_cell(table, trim(whiteness_word(filter%ljung_box)))
      end subroutine add_filter

   end subroutine make_filter_table

   !> Table III: a row for each series, a column for each term.
   subroutine make_comparison(record, channel, table)
      !> For the names of the terms
      type(record_type), intent(in) :: record
      !> Curves and coefficients as far as they are available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table
      character(11), parameter :: series(6) = [character(11) :: "raw", "no outliers", "cleaned", &
                                               "KF", "AKF", "compensated"]
      character(:), allocatable :: walks
      integer :: term, which, i

      call new_table(table, 6, head=2)
      table%number = "III"
      table%caption = "Noise coefficients from the Allan deviation"
      select case (record%unit%quantity)
      case (quantity%angular_rate); walks = "N angle random walk, B bias instability, K rate"
      case (quantity%acceleration); walks = "N velocity random walk, B bias instability, K"
      case default; walks = "N white noise, B bias instability, K rate"
      end select
      table%note = "Q quantization, "//walks//" random walk, R ramp. +/-: one standard error; "// &
         "<: not detected, one-sided 95 % limit."
      call add_row(table, "", "Q", "N", "B", "K", "R")
      call add_row(table, "")
      which = findloc(channel%allan%fitted, .true., dim=1)
      do term = 1, 5
         if (which == 0) exit
         associate (unit => channel%allan(which)%stated%term(term)%unit)
            i = 0                                          ! a wide unit has two lines
            if (len(unit) > 12) i = max(0, scan(unit, "*/", back=.true.) - 1)
            call add_cell(table, unit(:i)//if_known(i > 0, new_line("a"))//unit(i + 1:))
         end associate
      end do
      do which = stage%input, stage%compensated
         if (.not. channel%allan(which)%available) cycle
         if (which == stage%cleaned .and. .not. channel%available%cleaned) cycle
         call add_row(table, trim(series(which)))
         do term = 1, 5
            call add_cell(table, compared_text(channel%allan(which), term))
         end do
      end do
      associate (left => channel%allan(stage%compensated))
         if (left%fitted) table%note = table%note//" compensated: in-sample, from the first "// &
            count_text(int(left%noise%points, int64))//" octaves."
      end associate
      if (.not. any(channel%reduction_known .or. channel%reduction_at_least > 0.0_dp)) return
      table%note = table%note//" reduction: from cleaned to AKF."
      call add_row(table, "reduction")
      do term = 1, 5
         if (channel%reduction_known(term)) then
            call add_cell(table, number(channel%reduction_percent(term), 3)//" %")
         else
            call add_cell(table, if_known(channel%reduction_at_least(term) > 0.0_dp, "> "// &
                                          number(channel%reduction_at_least(term), 3)//" %", "-"))
         end if
      end do
   end subroutine make_comparison

   !> The value and under it its error, or the limit.
   pure function compared_text(allan, term) result(text)
      type(allan_result_type), intent(in) :: allan
      integer, intent(in) :: term
      character(:), allocatable :: text

      text = "-"
      associate (stated => allan%stated%term(term))
         if (allan%fitted .and. stated%state == "withheld") text = "withheld"
         if (.not. (allan%fitted .and. stated%fitted)) return
         if (stated%detected) text = number(stated%value, 4)//new_line("a")//"+/- "// &
            number(stated%std_error, 2)
         if (.not. stated%detected) text = "< "//number(stated%upper_limit, 3)
      end associate
   end function compared_text

end module gyroakf_report_tables
