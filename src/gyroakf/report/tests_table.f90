! SPDX-License-Identifier: MIT
!> The tests of a series as a table, for papers; the report of a terminal says the same in sentences.
module gyroakf_report_tests_table
   use gyroakf_kinds, only : dp
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_text_layout, only : number, p_value_text
   use gyroakf_report_text_table, only : table_type, new_table, set_cell, set_row
   use gyroakf_report_verdicts, only : level
   implicit none (type, external)
   private
   public :: make_tests_table, has_tests, kpss_p_text, bare

contains

   !> One test at least has a result.
   pure logical function has_tests(channel)
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      has_tests = test_count(channel) > 0
   end function has_tests

   !> Tests with a result.
   pure integer function test_count(channel)
      type(channel_result_type), intent(in) :: channel

      associate (is => channel%available)
         test_count = count([is%adf, is%kpss, is%jarque_bera, is%anderson_darling, is%ljung_box])
      end associate
   end function test_count

   !> A row for each test: what it takes for granted, its statistic, and whether it rejects that at 5 %.
   subroutine make_tests_table(channel, table)
      !> [[has_tests]]
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table
      integer :: row

      call new_table(table, 1 + test_count(channel), 6, left=2)
      table%name = "tests"
      table%caption = "Tests of the "//trim(channel%tested)
      table%note = "Critical values and rejections are those of a significance of 5 %."
      call set_row(table, 1, [character(15) :: "test", "null hypothesis", "statistic", "critical", "p", "rejected"])
      row = 1
      associate (is => channel%available)
         if (is%adf) call add_test(table, row, "augmented Dickey-Fuller", "unit root", channel%adf%statistic, &
                                   p_value_text(channel%adf%p_value), .not. channel%adf%p_value >= level, channel%adf%critical(2))
         if (is%kpss) call add_test(table, row, "KPSS", "stationary", channel%kpss%statistic, kpss_p_text(channel), &
                                    .not. channel%kpss%stationary, channel%kpss%critical(2))
         if (is%jarque_bera) call add_test(table, row, "Jarque-Bera", "normal", channel%jarque_bera%statistic, &
            p_value_text(channel%jarque_bera%p_value), channel%jarque_bera%p_value < level)
         if (is%anderson_darling) call add_test(table, row, "Anderson-Darling", "normal", channel%anderson_darling%modified, &
            p_value_text(channel%anderson_darling%p_value), channel%anderson_darling%p_value < level)
         if (is%ljung_box) call add_test(table, row, "Ljung-Box", "white", channel%ljung_box%statistic, &
                                         p_value_text(channel%ljung_box%p_value), channel%ljung_box%p_value < level)
      end associate
   end subroutine make_tests_table

   !> Beyond its table the probability is known as a bound.
   pure function kpss_p_text(channel) result(text)
      !> With its KPSS test
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      select case (channel%kpss%p_bound)
      case (-1); text = "p < 0.01"
      case (1); text = "p > 0.10"
      case default; text = p_value_text(channel%kpss%p_value)
      end select
   end function kpss_p_text

   !> "0.03", "< 0.01" of "p = 0.03", "p < 0.01".
   pure function bare(p) result(text)
      !> With its "p"
      character(*), intent(in) :: p
      character(:), allocatable :: text

      text = p(3:)
      if (text(:2) == "= ") text = text(3:)
   end function bare

   !> One row.
   pure subroutine add_test(table, row, name, hypothesis, statistic, p, rejected, critical)
      type(table_type), intent(inout) :: table
      !> The last one that is filled
      integer, intent(inout) :: row
      character(*), intent(in) :: name, hypothesis
      real(dp), intent(in) :: statistic
      !> "p = 0.03", "p < 0.01"
      character(*), intent(in) :: p
      logical, intent(in) :: rejected
      real(dp), intent(in), optional :: critical

      row = row + 1
      call set_cell(table, row, 1, name)
      call set_cell(table, row, 2, hypothesis)
      call set_cell(table, row, 3, number(statistic, 4))
      if (present(critical)) call set_cell(table, row, 4, number(critical, 4))
      call set_cell(table, row, 5, bare(p))
      call set_cell(table, row, 6, trim(merge("yes", "no ", rejected)))
   end subroutine add_test

end module gyroakf_report_tests_table
