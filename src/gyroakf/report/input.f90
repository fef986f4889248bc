! SPDX-License-Identifier: MIT
!> What was read and what was assumed about it.
module gyroakf_report_input
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : audit_type, record_type, sample_count, view_channel
   use gyroakf_units, only : quantity
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type
   use gyroakf_report_text_layout, only : count_text, if_known, number, percent, plural, &
      put_heading, put_item, put_title
   use gyroakf_report_text_table, only : add_row, new_table, put_table, table_type
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: report_inspect, put_input, has_unit, unit_name, time_unit, text_or

contains

   !> What was read, and nothing else.
   subroutine report_inspect(writer, record)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      integer :: i

      call put_title(writer, "gyroakf "//release_string//": what the file holds")
      call put_input(writer, record)
      if (allocated(record%warnings)) then
         do i = 1, size(record%warnings)
            call put_item(writer, if_known(record%warnings(i)%note, "Note", "Warning"), &
                          record%warnings(i)%text, verbatim=.true.)
         end do
      end if
      if (allocated(record%column)) call put_columns(writer, record)
   end subroutine report_inspect

   !> File, samples, rate, unit, what is missing, what the time stamps show; or only the first of
   !> these in two lines.
   subroutine put_input(writer, record, brief)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      !> Present: in two lines
      logical, intent(in), optional :: brief
      character(:), allocatable :: path, names, text, missing, share
      integer(int64) :: samples, values
      integer :: i

      path = text_or(record%path, "(in memory)")
      samples = sample_count(record)
      values = samples*size(record%value, 2)
      names = ""
      if (allocated(record%channel)) then
         do i = 1, size(record%channel)
            names = names//if_known(i > 1, ", ")//record%channel(i)%text
         end do
      end if
      associate (audit => record%audit)
         missing = plural(audit%missing, "value")
         share = " ("//percent(real(audit%missing, dp)/real(max(1_int64, values), dp))//")"
         if (present(brief)) then
            text = if_known(audit%missing > 0, missing//share//" missing", "none missing")// &
               if_known(audit%gaps > 0, " in "//plural(audit%gaps, "gap"))
            call put_item(writer, "Record", path//": "//plural(samples, "sample")// &
                          if_known(record%rate_known, ", "//rate_text(record))//", "//text, &
                          verbatim=.true.)
            if (.not. record%rate_known) call put_item(writer, "Rate", rate_text(record))
            if (allocated(record%channel_unit) .or. .not. has_unit(record)) then
               call put_units()
            else
               call put_item(writer, "Channels", names//" in "//unit_name(record)// &
                             source(record%unit_source), verbatim=.true.)
            end if
            return
         end if
         call put_heading(writer, "Input", "-")
         text = text_or(record%format, "no format")
         if (text == "npy") text = text//", "//text_or(record%stored_type, "")
         call put_item(writer, "File", path//" ("//text//")", verbatim=.true.)
         call put_item(writer, "Samples", count_text(samples)//" in "// &
                       plural(size(record%value, 2, kind=int64), "channel")//": "//names, &
                       verbatim=.true.)
         call put_item(writer, "Rate", rate_text(record))
         call put_units()
         call put_item(writer, "Missing", missing// &
                       if_known(audit%missing > 0, " of "//count_text(values)//share)//", "// &
                       plural(audit%gaps, "gap")//if_known(audit%bad_lines > 0, &
                       ", "//plural(audit%bad_lines, "line")//" that could not be read"))
         if (audit%has_stamps) call put_stamps(writer, audit)
         if (allocated(record%resample)) call put_resample(audit)
      end associate

   contains

      !> The units, or what would give them.
      subroutine put_units()
         if (allocated(record%channel_unit)) then
            call put_item(writer, "Units", channel_units_text(record)//source(record%unit_source), &
                          verbatim=.true.)
         else if (has_unit(record)) then
            call put_item(writer, "Unit", unit_name(record)//source(record%unit_source))
         else
            call put_item(writer, "Unit", "not known: results are in input units; --unit deg/s "// &
                          "(or rad/s, deg/h, ...) gives the usual ones")
         end if
      end subroutine put_units

      !> How the stamps placed the samples.
      subroutine put_resample(audit)
         type(audit_type), intent(in) :: audit

         select case (record%resample)
         case ("nearest")
            call put_item(writer, "Resampled", "each sample on the slot of its stamp, moved by "// &
                          "up to "//number(audit%largest_shift, 3)//" s; "// &
                          plural(audit%empty_slots, "empty slot")//" (missing), "// &
                          plural(audit%dropped, "sample")//" dropped from taken slots")
         case ("linear")
            call put_item(writer, "Resampled", "by linear interpolation, which leaves "// &
                          number(audit%white_noise, 3)//" of the variance of white noise; "// &
                          plural(audit%empty_slots, "slot")//" in long intervals (missing), "// &
                          plural(audit%dropped, "sample")//" of equal or earlier stamp dropped")
         case default
         end select
      end subroutine put_resample

   end subroutine put_input

   !> "5 Hz (as the file says); 2400 s (40 min)", or what would give the rate.
   pure function rate_text(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text
      real(dp) :: seconds

      text = "not known: times are in samples, and results per sample; --rate HZ (or --dt S) "// &
         "gives seconds and the usual units"
      if (.not. record%rate_known) return
      seconds = real(sample_count(record), dp)*record%sample_interval
      text = number(1.0_dp/record%sample_interval, 7)//" Hz"//source(record%rate_source)//"; "// &
             number(seconds, 7)//" s"
      if (seconds >= 7200.0_dp) text = text//" ("//number(seconds/3600.0_dp, 4)//" h)"
      if (seconds >= 120.0_dp .and. seconds < 7200.0_dp) text = text//" ("// &
         number(seconds/60.0_dp, 4)//" min)"
   end function rate_text

   !> "rad/s for gx, gy, gz; m/s^2 for ax, ay, az": channels of one unit that stand together.
   pure function channel_units_text(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text, unit, before
      integer :: i

      text = ""
      before = ""
      do i = 1, size(record%channel_unit)
         unit = text_or(record%channel_unit(i)%name, "not known")
         if (unit == before) then
            text = text//", "
         else
            text = text//if_known(i > 1, "; ")//unit//" for "
         end if
         text = text//record%channel(i)%text
         before = unit
      end do
   end function channel_units_text

   !> What the time stamps show.
   subroutine put_stamps(writer, audit)
      type(writer_type), intent(inout) :: writer
      type(audit_type), intent(in) :: audit
      character(*), parameter :: kinds(3) = [character(13) :: "duplicate", "backward step", "gap"]
      character(:), allocatable :: text
      integer :: i

      call put_item(writer, "Time stamps", "mean rate "//number(audit%stamp_rate, 7)// &
                    " Hz, largest distance from an even grid "//number(audit%jitter_max, 3)// &
                    " s (usual "//number(audit%jitter_rms, 2)//" s), "// &
                    plural(audit%duplicates, "duplicate")//", "// &
                    plural(audit%backward_steps, "backward step"))
      if (.not. allocated(audit%line_of_first)) return
      text = ""
      do i = 1, 3
         if (audit%line_of_first(i) > 0) text = text//", "//trim(kinds(i))//": line "// &
            count_text(audit%line_of_first(i))
      end do
      if (text /= "") call put_item(writer, "", "the first"//text(2:))
      text = if_known(audit%resolution > 0.0_dp, "; counts in "//number(audit%resolution, 4)// &
                      " s or less")// &
             if_known(audit%rate_first > 0.0_dp, "; "//number(audit%rate_first, 7)// &
                      " Hz in the first half, "//number(audit%rate_second, 7)// &
                      " Hz in the second")// &
             if_known(audit%repeated > 0, "; "//plural(audit%repeated, "repeated row")// &
                      ", the first in line "//count_text(audit%line_of_repeat))// &
             if_known(audit%bursts > 0, "; "//plural(audit%bursts, "burst")//" of up to "// &
                      plural(audit%longest_burst, "sample")//", the first in line "// &
                      count_text(audit%line_of_burst))
      if (text /= "") call put_item(writer, "Clock", text(3:))
   end subroutine put_stamps

   !> All columns of the file: class, unit, range and smallest step in that unit, and what is done
   !> with them.
   subroutine put_columns(writer, record)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(table_type) :: table
      type(record_type) :: view
      character(:), allocatable :: unit, purpose
      real(dp) :: range(3)
      integer :: i, c

      call put_heading(writer, "Columns", "-")
      call new_table(table, 8, left=4)
      call add_row(table, "column", "name", "class", "unit", "minimum", "maximum", "step", "use")
      do i = 1, size(record%column)
         associate (column => record%column(i))
            c = column%channel
            range = [column%minimum, column%maximum, column%step]
            unit = text_or(column%unit, "-")
            purpose = if_known(column%is_time, "time", "not analyzed")
            if (c > 0) then
               range = [record%audit%minimum(c), record%audit%maximum(c), &
                        record%audit%quantization(c)]
               call view_channel(record, c, view)
               unit = text_or(view%unit%name, unit)
               purpose = "analyzed"
            end if
            call add_row(table, count_text(int(i, int64)), text_or(column%name, "-"), &
                         column%class, unit, number(range(1), 6), number(range(2), 6), &
                         number(range(3), 4), purpose)
         end associate
      end do
      call put_table(writer, table, verbatim=.true.)
   end subroutine put_columns

   !> Somebody gave a unit.
   pure logical function has_unit(record)
      type(record_type), intent(in) :: record

      has_unit = record%unit%quantity /= quantity%unknown .and. allocated(record%unit%name)
   end function has_unit

   !> The unit's name, "input units" where none is known.
   pure function unit_name(record) result(name)
      type(record_type), intent(in) :: record
      character(:), allocatable :: name

      name = "input units"
      if (has_unit(record)) name = record%unit%name
   end function unit_name

   !> Unit of averaging times: "s", or "samples" where no rate is known.
   pure function time_unit(record) result(name)
      type(record_type), intent(in) :: record
      character(:), allocatable :: name

      name = "samples"
      if (record%rate_known) name = "s"
   end function time_unit

   !> Who said so.
   pure function source(name) result(text)
      character(*), intent(in), optional :: name
      character(:), allocatable :: text

      select case (text_or(name, ""))
      case ("option"); text = " (as the option says)"
      case ("header"); text = " (as the file says)"
      case ("timestamps"); text = " (from the time stamps)"
      case default; text = ""
      end select
   end function source

   !> The text as it can be shown, or another one where it is unallocated or empty.
   pure function text_or(text, other) result(chosen)
      !> Any bytes
      character(*), intent(in), optional :: text
      character(*), intent(in) :: other
      character(:), allocatable :: chosen

      chosen = other
      if (.not. present(text)) return
      if (len(text) == 0) return
      chosen = text
      call make_readable(chosen)
   end function text_or

end module gyroakf_report_input
