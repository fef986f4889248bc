! SPDX-License-Identifier: MIT
!> The part of a report that tells whether the noise changed during the record.
module gyroakf_report_changes
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_allan_dynamic, only : dynamic_type
   use gyroakf_allan_halves, only : halves_type
   use gyroakf_pipeline_result, only : channel_result_type, stage
   use gyroakf_report_layout, only : put_heading, put_item, put_paragraph, number, p_value_text, plural, count_text
   use gyroakf_report_table, only : table_type, new_table, set_cell, put_table
   use gyroakf_report_input, only : unit_name
   implicit none (type, external)
   private
   public :: put_changes

   !> Averaging times that are told one by one
   integer, parameter :: told_max = 3
   !> Averaging times and segments that a table shows at most
   integer, parameter :: columns_max = 6, rows_max = 24
   !> A change of the deviation by less is small
   real(dp), parameter :: small_change = 0.03_dp

contains

   !> The comparison of the halves, and the dynamic deviation.
   subroutine put_changes(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit of time
      type(record_type), intent(in) :: record
      !> Its results
      type(channel_result_type), intent(in) :: channel

      if (.not. (channel%available%halves .or. channel%available%dynamic)) return
      call put_heading(writer, "Change of the noise during the record")
      if (channel%available%halves) call put_halves(writer, record, channel)
      if (channel%available%dynamic) call put_dynamic(writer, record, channel)
   end subroutine put_changes

   !> The comparison of the halves.
   subroutine put_halves(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      text = halves_text(channel%halves, trim(merge(" s      ", " samples", record%rate_known)))
      if (channel%halves%changed .and. (channel%clean%method == "none" .or. .not. channel%available%preprocess)) then
         text = text//"; outliers in one half do that too (--outliers auto marks them)"
      end if
      call put_item(writer, "Halves", text)
   end subroutine put_halves

   !> A table of the deviation at some averaging times: a row a segment, the whole record below.
   subroutine put_dynamic(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      type(table_type) :: table
      integer, allocatable :: column(:), row(:)
      integer :: i, j

      associate (dynamic => channel%dynamic)
         call spread_out(count(maxval(dynamic%edf, dim=2) >= 2 .or. dynamic%tau <= dynamic%tau(1)), columns_max, column)
         call spread_out(size(dynamic%start), rows_max, row)
         call put_paragraph(writer, dynamic_title(record, dynamic, size(row)), 2)
         call new_table(table, size(row) + 2, size(column) + 1)
         call set_cell(table, 1, 1, "from \ tau")
         do i = 1, size(column)
            call set_cell(table, 1, i + 1, number(dynamic%tau(column(i)), 4))
            do j = 1, size(row)
               call set_cell(table, j + 1, i + 1, "-")
               if (dynamic%terms(column(i), row(j)) > 0) call set_cell(table, j + 1, i + 1, &
                  number(dynamic%deviation(column(i), row(j)), 4))
            end do
            call set_cell(table, size(row) + 2, i + 1, whole_text(channel, dynamic%m(column(i))))
         end do
         do j = 1, size(row)
            call set_cell(table, j + 1, 1, number(dynamic%start(row(j)), 6))
         end do
         call set_cell(table, size(row) + 2, 1, "all")
         call put_table(writer, table, 0)
      end associate
   end subroutine put_dynamic

   !> What the table shows.
   pure function dynamic_title(record, dynamic, rows) result(text)
      type(record_type), intent(in) :: record
      type(dynamic_type), intent(in) :: dynamic
      integer, intent(in) :: rows
      character(:), allocatable :: text

      text = "Dynamic deviation: oadev in "//unit_name(record)//" of "// &
             plural(size(dynamic%start, kind=int64), "segment")//" of "//number(dynamic%segment, 6)// &
             trim(merge(" s      ", " samples", record%rate_known))//", by beginning of the segment and averaging time"
      if (rows < size(dynamic%start)) text = text//" ("//count_text(int(rows, int64))//" of them are"//" shown)"
   end function dynamic_title

   !> Deviation of the whole record at an averaging factor, where its curve has it.
   pure function whole_text(channel, m) result(text)
      type(channel_result_type), intent(in) :: channel
      integer(int64), intent(in) :: m
      character(:), allocatable :: text
      integer :: i

      text = "-"
      if (.not. allocated(channel%allan(stage%input)%curve%m)) return
      i = findloc(channel%allan(stage%input)%curve%m, m, dim=1)
      if (i > 0) text = number(channel%allan(stage%input)%curve%deviation(i), 4)
   end function whole_text

   !> Numbers from 1 to n, all of them or `most` evenly spread ones, the first and the last included.
   pure subroutine spread_out(n, most, place)
      integer, intent(in) :: n, most
      integer, allocatable, intent(out) :: place(:)
      integer :: i

      if (n <= most) then
         place = [(i, i=1, n)]
      else
         place = [(1 + nint(real(n - 1, dp)*real(i - 1, dp)/real(most - 1, dp)), i=1, most)]
      end if
   end subroutine spread_out

   !> What the comparison of the halves says.
   pure function halves_text(halves, time) result(text)
      !> The comparison
      type(halves_type), intent(in) :: halves
      !> Unit of time, a blank before it
      character(*), intent(in) :: time
      character(:), allocatable :: text
      logical, allocatable :: left(:)
      integer :: i, told

      text = "chi-square "//number(halves%statistic, 4)//" with "//plural(int(halves%freedom, int64), "degree")// &
             " of freedom, "//p_value_text(halves%p_value)
      if (.not. halves%changed) then
         text = "no difference is found between the Allan curves of the first and the second half: "//text
         return
      end if
      text = "the second half has another Allan curve than the first: "//text
      left = halves%differs
      do told = 1, told_max
         if (.not. any(left)) exit
         i = maxloc(abs(halves%score), dim=1, mask=left)
         left(i) = .false.
         text = text//"; "//change_text(halves, i, time, told == 1)
      end do
      if (any(left)) text = text//"; and at "//plural(count(left, kind=int64), "more averaging time")
      if (.not. any(halves%differs)) text = text//"; at no single averaging time is the difference significant"
      if (maxval(abs(halves%ratio - 1), mask=halves%differs .or. .not. any(halves%differs)) < small_change) then
         text = text//". A small change, seen because the record is long"
      else
         text = text//". The coefficients are those of a mean of both"
      end if
   end function halves_text

   !> "the deviation at tau = 2 s rose by 12 % (95 % limits of the ratio 1.08 and 1.16)".
   pure function change_text(halves, i, time, complete) result(text)
      !> The comparison
      type(halves_type), intent(in) :: halves
      !> Which averaging time
      integer, intent(in) :: i
      !> Unit of time
      character(*), intent(in) :: time
      !> Say all of it
      logical, intent(in) :: complete
      character(:), allocatable :: text

      text = "at tau = "//number(halves%tau(i), 4)//time//" it "//amount_text(halves%ratio(i))
      if (complete) text = "the deviation at tau = "//number(halves%tau(i), 4)//time//" "//amount_text(halves%ratio(i))// &
                           " ("//number(100*halves%confidence, 3)//" % limits of the ratio "// &
                           number(halves%lower(i), 3)//" and "//number(halves%upper(i), 3)//")"
   end function change_text

   !> "rose by 12 %", "rose to 2.5 times", "fell by 99.7 %".
   pure function amount_text(ratio) result(text)
      !> Second over first, > 0
      real(dp), intent(in) :: ratio
      character(:), allocatable :: text

      if (ratio >= 1.995_dp) then
         text = "rose to "//number(ratio, 3)//" times"
      else if (ratio > 1) then
         text = "rose by "//number(100*(ratio - 1), 2)//" %"
      else
         text = "fell by "//number(100*(1 - ratio), merge(4, 2, ratio < 0.005_dp))//" %"
      end if
   end function amount_text

end module gyroakf_report_changes
