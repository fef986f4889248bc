! SPDX-License-Identifier: MIT
!> The section of a report on changes of the noise during the record.
module gyroakf_report_text_changes
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_allan_halves, only : halves_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_text_layout, only : put_heading, put_item, number, p_value_text, plural
   implicit none (type, external)
   private
   public :: put_changes

   !> Maximum number of averaging times that are listed individually
   integer, parameter :: max_listed = 3
   !> A change of the deviation by less is small
   real(dp), parameter :: small_change = 0.03_dp

contains

   !> The comparison of the halves.
   subroutine put_changes(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit of time
      type(record_type), intent(in) :: record
      !> Its results
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      if (.not. channel%available%halves) return
      call put_heading(writer, "Change of the noise during the record")
      text = halves_text(channel%halves, trim(merge(" s      ", " samples", record%rate_known)))
      if (channel%halves%changed .and. (channel%clean%method == "none" .or. .not. channel%available%preprocess)) then
         text = text//"; outliers in one half do that too (--outliers auto marks them)"
      end if
      call put_item(writer, "Halves", text)
   end subroutine put_changes

   !> What the comparison of the halves says.
   pure function halves_text(halves, time) result(text)
      !> The comparison
      type(halves_type), intent(in) :: halves
      !> Unit of time, a blank before it
      character(*), intent(in) :: time
      character(:), allocatable :: text
      logical, allocatable :: left(:)
      integer :: i, listed

      text = "chi-square "//number(halves%statistic, 4)//" with "//plural(int(halves%freedom, int64), "degree")// &
             " of freedom, "//p_value_text(halves%p_value)
      if (.not. halves%changed) then
         text = "no difference is found between the Allan curves of the first and the second half: "//text
         return
      end if
      text = "the second half has another Allan curve than the first: "//text
      left = halves%differs
      do listed = 1, max_listed
         if (.not. any(left)) exit
         i = maxloc(abs(halves%score), dim=1, mask=left)
         left(i) = .false.
         text = text//"; "//change_text(halves, i, time, listed == 1)
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

end module gyroakf_report_text_changes
