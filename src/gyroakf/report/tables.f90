! SPDX-License-Identifier: MIT
!> The tables of a channel for a paper: tests, Table I (AR models), Table II (filters), Table III (noise coefficients).
module gyroakf_report_tables
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_text_filters, only : make_filter_table
   use gyroakf_report_models, only : make_ar_table
   use gyroakf_report_text_noise, only : make_comparison
   use gyroakf_report_text_table, only : table_type
   use gyroakf_report_tests_table, only : has_tests, make_tests_table
   implicit none (type, external)
   private
   public :: make_tables, flat_text

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
      integer :: n

      wanted = [has_tests(channel), channel%available%ar, channel%available%kf .or. channel%available%akf .or. &
                channel%available%drift_kf .or. channel%available%drift_akf, any(channel%allan%fitted)]
      allocate (tables(count(wanted)))
      n = 0
      if (wanted(1)) then
         n = n + 1
         call make_tests_table(channel, tables(n))
      end if
      if (wanted(2)) then
         n = n + 1
         call make_ar_table(record, channel, tables(n))
      end if
      if (wanted(3)) then
         n = n + 1
         call make_filter_table(record, channel, tables(n))
      end if
      if (wanted(4)) then
         n = n + 1
         call make_comparison(record, channel, tables(n))
      end if
   end subroutine make_tables

   !> The lines of a cell in one: an uncertainty behind its value, the parts of a unit together.
   pure function flat_text(text) result(line)
      !> Of a cell
      character(*), intent(in) :: text
      character(:), allocatable :: line
      integer :: i

      line = ""
      do i = 1, len(text)
         if (text(i:i) /= new_line("a")) then
            line = line//text(i:i)
         else if (scan(text(min(i + 1, len(text)):min(i + 1, len(text))), "*/") == 0) then
            line = line//" "
         end if
      end do
      line = trim(adjustl(line))
   end function flat_text

end module gyroakf_report_tables
