! SPDX-License-Identifier: MIT
!> The tables of a channel for a paper: tests, Table I (AR models), Table II (filters), Table III
!> (noise coefficients).
module gyroakf_report_tables
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_input, only : unit_name
   use gyroakf_report_text_filters, only : make_filter_table
   use gyroakf_report_text_layout, only : count_text, fixed, number, p_value_text, scientific
   use gyroakf_report_text_noise, only : make_comparison
   use gyroakf_report_text_table, only : add_row, new_table, set_exacts, table_type
   use gyroakf_report_verdicts, only : level
   implicit none (type, external)
   private
   public :: make_tables, make_tests_table, has_tests, kpss_p_text, bare, make_ar_table, upper_case

contains

   !> Describes the tables that a channel has, in the order of the paper.
   subroutine make_tables(record, channel, tables)
      !> The channel alone, for its unit
      type(record_type), intent(in) :: record
      !> Filled as far as it is available
      type(channel_result_type), intent(in) :: channel
      !> [at most 4]
      type(table_type), allocatable, intent(out) :: tables(:)
      logical :: wanted(4)
      integer :: n, kind

      associate (is => channel%available)
         wanted = [has_tests(channel), is%ar, &
                   is%kf .or. is%akf .or. is%drift_kf .or. is%drift_akf, &
                   any(channel%allan%fitted)]
      end associate
      allocate (tables(count(wanted)))
      n = 0
      do kind = 1, size(wanted)
         if (.not. wanted(kind)) cycle
         n = n + 1
         select case (kind)
         case (1); call make_tests_table(channel, tables(n))
         case (2); call make_ar_table(record, channel, tables(n))
         case (3); call make_filter_table(record, channel, tables(n))
         case default; call make_comparison(record, channel, tables(n))
         end select
      end do
   end subroutine make_tables

   !> One test at least has a result.
   pure logical function has_tests(channel)
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      associate (is => channel%available)
         has_tests = is%adf .or. is%kpss .or. is%jarque_bera .or. is%anderson_darling .or. is%ljung_box
      end associate
   end function has_tests

   !> A row for each test: what it takes for granted, its statistic, and whether it rejects that at
   !> 5 %.
   subroutine make_tests_table(channel, table)
      !> [[has_tests]]
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table

      call new_table(table, 1, 6, left=2)
      table%name = "tests"
      table%caption = "Tests of the "//trim(channel%tested)
      table%note = "Critical values and rejections are those of a significance of 5 %."
      call add_row(table, "test", "null hypothesis;statistic;critical;p;rejected")
      associate (is => channel%available, adf => channel%adf, kpss => channel%kpss)
         if (is%adf) call add_test("augmented Dickey-Fuller", "unit root", adf%statistic, &
                                   adf%p_value, &
                                   number(adf%critical(2), 4))
         if (is%kpss) call add_row(table, "KPSS", "stationary;"//number(kpss%statistic, 4)//";"// &
            number(kpss%critical(2), 4)//";"//kpss_p_text(channel)//";"// &
            trim(merge("no ", "yes", kpss%stationary)))
         if (is%jarque_bera) call add_test("Jarque-Bera", "normal", channel%jarque_bera%statistic, &
                                           channel%jarque_bera%p_value, "")
         if (is%anderson_darling) call add_test("Anderson-Darling", "normal", &
                                                channel%anderson_darling%modified, &
                                                channel%anderson_darling%p_value, "")
         if (is%ljung_box) call add_test("Ljung-Box", "white", channel%ljung_box%statistic, &
                                         channel%ljung_box%p_value, "")
      end associate

   contains

      subroutine add_test(name, hypothesis, statistic, p, critical)
         character(*), intent(in) :: name, hypothesis, critical
         real(dp), intent(in) :: statistic, p

         call add_row(table, name, hypothesis//";"//number(statistic, 4)//";"//critical//";"// &
                      bare(p)//";"// &
                      trim(merge("yes", "no ", p < level)))
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

      call new_table(table, size(channel%ar%table) + 1, 8, left=0)
      table%name = "ar"
      table%number = "I"
      table%caption = "AR models ("//method_name(channel%ar%method)//", n = "// &
         count_text(channel%ar%compared_rows)//", variances in ("//unit_name(record)// &
         ")^2); * is the order chosen by "//upper_case(trim(channel%ar%criterion))
      call add_row(table, "order", "variance;AIC;AICc;BIC;HQIC;FPE;AIC/n")
      do i = lbound(channel%ar%table, 1), ubound(channel%ar%table, 1)
         associate (line => channel%ar%table(i))
            call add_row(table, merge("* ", "  ", line%order == channel%ar%order)// &
                         count_text(int(line%order, int64)), &
                         scientific(line%noise_variance, 5)//";"//criterion(line%aic)//";"// &
                            criterion(line%aicc)//";"// &
                         criterion(line%bic)//";"//criterion(line%hqic)//";"//scientific(line%fpe, &
                            5)//";"// &
                         fixed(line%aic_per_observation, 6))
            call set_exacts(table, 2, "ar.table."//count_text(int(i - lbound(channel%ar%table, 1), &
               int64))//".", &
                            [character(19) :: "noise_variance", "aic", "aicc", "bic", "hqic", &
                             "fpe", &
                             "aic_per_observation"], [line%noise_variance, line%aic, line%aicc, &
                                                      line%bic, &
                             line%hqic, line%fpe, line%aic_per_observation])
         end associate
      end do
   end subroutine make_ar_table

   !> Decimals down to what a difference has to have, limited by the width of a column.
   pure function criterion(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text

      text = fixed(value, count(abs(value) < [1e5_dp, 1e6_dp]))
      if (.not. ieee_is_finite(value)) text = "-"
   end function criterion

   pure function method_name(method) result(name)
      character(*), intent(in) :: method
      character(:), allocatable :: name

      select case (method)
      case ("yw"); name = "Yule-Walker"
      case ("burg"); name = "Burg"
      case ("ols"); name = "least squares"
      case default; name = trim(method)
      end select
   end function method_name

   !> aic -> AIC, aicc -> AICc.
   pure function upper_case(key) result(name)
      !> As the options have it
      character(*), intent(in) :: key
      character(:), allocatable :: name

      select case (key)
      case ("aicc"); name = "AICc"
      case ("aic"); name = "AIC"
      case ("bic"); name = "BIC"
      case ("hqic"); name = "HQIC"
      case ("fpe"); name = "FPE"
      case default; name = key
      end select
   end function upper_case

end module gyroakf_report_tables
