! SPDX-License-Identifier: MIT
!> Reading recordings: every feature of the text format.
module test_reader
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_record, only : record_type
   use scratch_file, only : read_content
   implicit none (type, external)
   private
   public :: suite_reader

   character(1), parameter :: nl = new_line("a"), tab = achar(9), cr = achar(13)

contains

   subroutine suite_reader()
      call test("separators", test_separators)
      call test("line-ends", test_line_ends)
      call test("comments", test_comments)
      call test("missing", test_missing)
      call test("quotes", test_quotes)
      call test("blank-columns", test_blank_columns)
      call test("names", test_names)
      call test("units-of-names", test_units_of_names)
      call test("header-rate", test_header_rate)
      call test("header-unit", test_header_unit)
      call test("names-in-comment", test_names_in_comment)
      call test("channel-units", test_channel_units)
      call test("temperature", test_temperature)
      call test("channel-increments", test_channel_increments)
      call test("header-columns", test_header_columns)
      call test("choose-columns", test_choose_columns)
      call test("time-column", test_time_column)
      call test("looks-like-time", test_looks_like_time)
      call test("left-out", test_left_out)
      call test("repeated-names", test_repeated_names)
      call test("split-stamps", test_split_stamps)
      call test("units-below", test_units_below)
      call test("rates-differ", test_rates_differ)
      call test("increments", test_increments)
      call test("angles", test_angles)
      call test("part", test_part)
      call test("skip-bad-lines", test_bad_lines)
      call test("audit-of-values", test_audit_values)
      call test("survey", test_survey)
      call test("from-memory", test_memory)
      call test("long-line", test_long_line)
      call test("many-rows", test_many_rows)
   end subroutine suite_reader

   !> Reads a content; "values: first row / second row ..." with nan for missing ones, or the message of the failure.
   function shown(content, options, record) result(text)
      character(*), intent(in) :: content
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      character(:), allocatable :: text
      integer :: i, j

      call read_content(content, "reader.txt", options, record, failed)
      text = ""
      if (allocated(failed)) text = failed%message
      if (allocated(failed)) return
      do i = 1, min(size(record%value, 1), 20)
         if (i > 1) text = text//"/ "
         do j = 1, size(record%value, 2)
            if (is_present(record, i, j)) text = text//format_real(record%value(i, j), 9)//" "
            if (.not. is_present(record, i, j)) text = text//"nan "
         end do
      end do
   end function shown

   !> True for a sample that is present.
   logical function is_present(record, i, j)
      type(record_type), intent(in) :: record
      integer, intent(in) :: i, j

      is_present = .true.
      if (allocated(record%present)) is_present = record%present(i, j) == 1
   end function is_present

   !> All warnings, with bars between.
   function warned(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text
      integer :: i

      text = ""
      if (.not. allocated(record%warnings)) return
      do i = 1, size(record%warnings)
         text = text//record%warnings(i)%text//"|"
      end do
   end function warned

   !> Names of the channels, with blanks between.
   function channels(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text
      integer :: i

      text = ""
      do i = 1, size(record%channel)
         text = text//record%channel(i)%text//" "
      end do
   end function channels

   subroutine test_separators()
      type(record_type) :: record

      call check(error, shown("1.0 2,3;4"//nl//" -1.5"//tab//"2.5 , 3e0 ;4 "//nl, reader_options(), record), &
                 "1 2 3 4 / -1.5 2.5 3 4 ")
      call check(error, shown("1"//tab//"2"//tab//"3"//nl//"4"//tab//tab//"6"//nl, reader_options(), record), "1 2 3 / 4 nan 6 ")
      call check(error, shown("+1 .5 5. 1.5D-3 1d2", reader_options(), record), "1 0.5 5 0.0015 100 ")
   end subroutine test_separators

   subroutine test_line_ends()
      type(record_type) :: record
      character(3), parameter :: mark = char(239)//char(187)//char(191)

      call check(error, shown("1"//cr//nl//"2"//cr//nl, reader_options(), record), "1 / 2 ")
      call check(error, shown("1"//cr//"2"//cr//"3", reader_options(), record), "1 / 2 / 3 ")
      call check(error, shown(mark//"1"//nl//"2", reader_options(), record), "1 / 2 ")
      call check(error, shown(mark//"gx"//nl//"2", reader_options(), record)//channels(record), "2 gx ")
   end subroutine test_line_ends

   subroutine test_comments()
      type(record_type) :: record

      call check(error, shown("# a"//nl//"% b"//nl//"; c"//nl//"// d"//nl//nl//"1 # e"//nl//"# f"//nl//" "//nl//"2 // g"//nl// &
                              "3 % h"//nl, reader_options(), record), "1 / 2 / 3 ")
   end subroutine test_comments

   subroutine test_missing()
      type(record_type) :: record

      call check(error, shown("a,b"//nl//"1,nan"//nl//"NA,2"//nl//"inf,"//nl//",-Inf"//nl//"5,6"//nl, reader_options(), record), &
                 "1 nan / nan 2 / nan nan / nan nan / 5 6 ")
      call check(error, record%audit%missing == 6 .and. record%audit%samples == 5, "counted")
      call check(error, abs(record%value(2, 1)) <= 0.0_dp, "0 where missing")
      call check(error, shown("1"//nl//"2", reader_options(), record), "1 / 2 ")
      call check(error, .not. allocated(record%present), "no mask without missing samples")
   end subroutine test_missing

   !> Range and smallest step of every column, also where the first values are missing; not known where all are.
   subroutine test_survey()
      type(record_type) :: record
      type(reader_options) :: options

      options%survey = .true.
      call check(error, shown("a,b"//nl//"nan,2"//nl//"3,2"//nl//"-1,2"//nl//"-0.5,2"//nl, options, record), &
                 "nan 2 / 3 2 / -1 2 / -0.5 2 ")
      associate (a => record%column(1), b => record%column(2))
         call check(error, maxval(abs([a%minimum + 1, a%maximum - 3, a%step - 0.5_dp, b%minimum - 2, b%maximum - 2, &
                                       b%step])) <= 0.0_dp)
      end associate
      call check(error, shown("a,b"//nl//"nan,2"//nl//"nan,3"//nl, options, record), &
                 "2 / 3 ")
      call check(error, ieee_is_nan(record%column(1)%step), "a column of missing values has no step")
   end subroutine test_survey

   subroutine test_quotes()
      type(record_type) :: record

      call check(error, shown('"gx, left";"gy"'//nl//'"1.5";"-2"'//nl//'3;""'//nl, reader_options(), record), "1.5 -2 / 3 nan ")
      call check(error, channels(record), "gx, left gy ")
   end subroutine test_quotes

   subroutine test_blank_columns()
      type(record_type) :: record

      call check(error, shown("1,2,"//nl//"3,4,"//nl, reader_options(), record), "1 2 / 3 4 ")
      call check(error, warned(record), "column 3 holds no number and is left out|")
      call check(error, shown("gx,,gy"//nl//"1,,2"//nl//"3,,4,"//nl, reader_options(), record)//channels(record), &
                 "1 2 / 3 4 gx gy ")
      call check(error, shown("1,2"//nl//"3,4,"//nl//"5,6"//nl, reader_options(), record), "1 2 / 3 4 / 5 6 ")
   end subroutine test_blank_columns

   subroutine test_names()
      type(record_type) :: record

      call check(error, shown("gx gy"//nl//"1 2"//nl, reader_options(), record)//channels(record), "1 2 gx gy ")
      call check(error, shown("sep=;"//nl//"gyro x;gyro y"//nl//"1;2"//nl, reader_options(), record)//channels(record), &
                 "1 2 gyro x gyro y ")
      call check(error, shown("gyro 1, gyro 2"//nl//"1,2"//nl, reader_options(), record)//channels(record), "1 2 gyro 1 gyro 2 ")
      call check(error, shown("1 2"//nl, reader_options(), record)//channels(record), "1 2 column1 column2 ")
      call check(error, shown(",gx"//nl//"0,1.5"//nl, reader_options(), record)//channels(record)//warned(record), &
                 "1.5 gx columns not analyzed: 1 (unknown); `columns` reads them|")
   end subroutine test_names

   subroutine test_units_of_names()
      type(record_type) :: record

      call check(error, shown("t [ms],gx [deg/s],gy (dps)"//nl//"0,1,2"//nl//"10,3,4"//nl, reader_options(), record), "1 2 / 3 4 ")
      call check(error, record%unit%name//" "//record%unit_source//" "//format_real(record%sample_interval, 9), "deg/s header 0.01")
      call check(error, shown("t,gx"//nl//"us,rad/s"//nl//"0,1"//nl//"500,3"//nl, reader_options(), record), "1 / 3 ")
      call check(error, record%unit%name//" "//format_real(record%sample_interval, 9), "rad/s 0.0005")
   end subroutine test_units_of_names

   subroutine test_header_rate()
      type(record_type) :: record
      character(24), parameter :: line(8) = [character(24) :: "# rate_hz: 5", "% dt = 0.2 s", "//RATE_HZ: 5 mean (x)", &
         "; dt: 200 ms", "# rate_hz: -5", "# rate_hz: abc", "# rate hz: 5", "# dt = 200000 "//char(194)//char(181)//"s"]
      character(12), parameter :: expected(8) = [character(12) :: "0.2 header", "0.2 header", "0.2 header", "0.2 header", &
         "1 none", "1 none", "1 none", "0.2 header"]
      character(:), allocatable :: values
      integer :: i

      do i = 1, size(line)
         values = shown(trim(line(i))//nl//"1"//nl//"2"//nl, reader_options(), record)
         call check(error, format_real(record%sample_interval, 9)//" "//record%rate_source, trim(expected(i)), more=line(i))
         call check(error, (len(warned(record)) > 0) .eqv. (i == 5 .or. i == 6), warned(record))
      end do
      values = shown("# rate_hz: 5"//nl//"1", reader_options(rate_hz=100.0_dp), record)
      call check(error, format_real(record%sample_interval, 9)//" "//record%rate_source, "0.01 option")
   end subroutine test_header_rate

   subroutine test_header_unit()
      type(record_type) :: record
      type(reader_options) :: options
      character(:), allocatable :: values

      values = shown("# unit: deg/h, mean"//nl//"1", options, record)
      call check(error, record%unit%name//" "//record%unit_source, "deg/h header")
      values = shown("# unit: dogs"//nl//"1", options, record)
      call check(error, record%unit%name//record%unit_source//warned(record), &
                 "noneline 1: the header's unit 'dogs' is not known and is ignored|")
      values = shown("# units: angle increment counts, 0.1 arcsec each"//nl//"1", options, record)
      call check(error, index(warned(record), "is not known and is ignored|if the numbers are increments") > 0, warned(record))
      values = shown("# units: deg/h"//nl//"1", options, record)
      call check(error, record%unit%name//" "//record%unit_source, "deg/h header")
      options%unit = "rad/s"
      values = shown("# unit: deg/h"//nl//"1", options, record)
      call check(error, record%unit%name//" "//record%unit_source, "rad/s option")
      values = shown("# unit: dogs"//nl//"1", options, record)
      call check(error, record%unit%name//warned(record), "rad/s")
   end subroutine test_header_unit

   !> A comment whose words are as many as the columns names them: rostopic's and numpy's files have such a line.
   subroutine test_names_in_comment()
      type(record_type) :: record
      character(36), parameter :: line(8) = [character(36) :: "%time,field.x,field.y", "# t gx gy", &
         "# t [ms]; gx [dps]; gy [dps]", "# table, at rest", "# made by hand", "# 2024, table, at rest", &
         "# gx gy gz", "# rate_hz: 50, warm, at rest"]
      character(24), parameter :: expected(8) = [character(24) :: "field.x field.y", "gx gy", "gx gy", "column1 column2 column3", &
         "column1 column2 column3", "column1 column2 column3", "column1 column2 column3", "column1 column2 column3"]
      character(:), allocatable :: values
      integer :: i

      do i = 1, size(line)
         values = shown(trim(line(i))//nl//"0,1,5"//nl//"10,2,4"//nl//"20,3,5"//nl, reader_options(), record)
         call check(error, trim(channels(record)), trim(expected(i)), more=line(i))
         call check(error, (index(warned(record), "taken from line 1|") > 0) .eqv. i <= 3, warned(record))
      end do
      values = shown("# t [ms]; gx [dps]; gy [dps]"//nl//"0;1;5"//nl//"10;2;4"//nl, reader_options(), record)
      call check(error, record%unit%name//" "//format_real(record%sample_interval, 9), "deg/s 0.01")
      values = shown("# a,b,c"//nl//"t,gx,gy"//nl//"0,1,5"//nl//"10,2,4"//nl, reader_options(), record)
      call check(error, channels(record), "gx gy ", more="a line of names goes before a comment")
   end subroutine test_names_in_comment

   !> The units of the channels, with blanks between: "deg/s m/s^2 "; "? " where a channel's is not known.
   function units_of(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text
      integer :: i

      text = record%unit%name
      if (.not. allocated(record%channel_unit)) return
      do i = 1, size(record%channel_unit)
         if (record%channel_unit(i)%name == "") text = text//"? "
         if (record%channel_unit(i)%name /= "") text = text//record%channel_unit(i)%name//" "
      end do
   end function units_of

   !> A unit for each channel: from a list in the header, from the names, from an option; and what does not fit.
   subroutine test_channel_units()
      type(record_type) :: record
      type(reader_options) :: options
      character(*), parameter :: rows = nl//"0 1 2"//nl//"1 3 4"//nl//"2 5 6"
      character(*), parameter :: names = "# columns: t gx ax"//nl
      character(40), parameter :: header(8) = [character(40) :: "# units: s deg/s m/s2", "# units: deg/s, g", "# unit: dps; mg", &
         "# units: s deg/s -", "# units: s deg/s dps", "# units: deg/s", "# units: s dps g g", "# unit: deg/s as measured"]
      character(12), parameter :: expected(8) = [character(12) :: "deg/s m/s^2", "deg/s g", "deg/s mg", "deg/s ?", "deg/s", &
         "deg/s ?", "", "deg/s ?"]
      character(:), allocatable :: values
      integer :: i

      do i = 1, size(header)
         values = shown(trim(header(i))//nl//names//rows, options, record)
         call check(error, trim(units_of(record)), trim(expected(i)), more=header(i))
         call check(error, (index(warned(record), "the header lists 4 units, the file has 3") > 0) .eqv. i == 7, warned(record))
      end do
      values = shown("t gx[rad/s] humidity[percent]"//rows, options, record)
      call check(error, units_of(record)//record%unit_source, "rad/sheader")
      values = shown("# units: s deg/s g"//nl//names//rows, reader_options(columns="ax,gx"), record)
      call check(error, units_of(record), "g deg/s ")
      options%unit = "rad/s,m/s^2"
      values = shown("# unit: deg/h"//nl//names//rows, options, record)
      call check(error, units_of(record)//record%unit_source, "rad/s m/s^2 option")
      options%unit = "rad/s,rad/s,m/s^2"
      call check(error, shown(names//rows, options, record), "`unit` names 3 units, but the number of channels is 2 (gx ax): "// &
                 "give one unit for all of them, or one for each")
   end subroutine test_channel_units

   !> A temperature is left out, and said to be, unless it is asked for; where there is nothing else it is read.
   subroutine test_temperature()
      type(record_type) :: record
      character(*), parameter :: rows = nl//"0 1 20"//nl//"1 3 21"//nl//"2 5 22"
      character(:), allocatable :: values

      values = shown("t gx[rad/s] temperature[degC]"//rows, reader_options(), record)
      call check(error, channels(record)//units_of(record), "gx rad/s", more="left out")
      call check(error, index(warned(record), "columns not analyzed: 3 temperature (temperature); `columns` reads them|") == 1)
      values = shown("t gx[rad/s] temperature[degC]"//rows, reader_options(columns="temperature"), record)
      call check(error, channels(record)//values, "temperature 20 / 21 / 22 ", more="asked for")
      values = shown("t gx[rad/s] temperature[degC]"//rows, reader_options(columns="temperature,gx"), record)
      call check(error, channels(record)//units_of(record), "temperature gx ? rad/s ", more="both")
      values = shown("t temperature[degC]"//nl//"0 20"//nl//"1 21", reader_options(), record)
      call check(error, channels(record), "temperature ", more="nothing else")
      values = shown("t gx[rad/s] TAcc TGyro"//nl//"0 1 20 30"//nl//"1 3 21 31", reader_options(), record)
      call check(error, channels(record), "gx ", more="the temperature of a sensor")
   end subroutine test_temperature

   !> Increments of a unit for each channel become rates; a list of rates does not fit them.
   subroutine test_channel_increments()
      type(record_type) :: record
      type(reader_options) :: options
      character(*), parameter :: rows = "1 2"//nl//"3 4"
      character(:), allocatable :: values

      options%input = "increment"
      options%rate_hz = 10
      options%unit = "rad,m/s"
      values = shown(rows, options, record)
      call check(error, values//units_of(record), "10 20 / 30 40 rad/s m/s^2 ", more="angles and velocities")
      options%unit = "arcsec,deg"
      call check(error, shown(rows, options, record), "10 20 / 30 40 ")
      call check(error, units_of(record), "arcsec/s deg/s ")
      options%unit = "arcsec,deg/s"
      values = shown(rows, options, record)
      call check(error, values, "`input` increment needs the unit of an angle (deg, rad, "// &
                 "arcsec), not deg/s; "// &
                 "increments of a velocity have m/s")
      deallocate (options%unit)
      values = shown("# units: arcsec deg/s"//nl//rows, options, record)
      call check(error, units_of(record)//record%unit_source//warned(record), &
                 "nonethe header's unit deg/s does not fit `input` increment or angle and is ignored|")
   end subroutine test_channel_increments

   subroutine test_header_columns()
      type(record_type) :: record

      call check(error, shown("# columns: t [s] gx gy"//nl//"0 1 2"//nl//"0.5 3 4", reader_options(), record)//channels(record), &
                 "1 2 / 3 4 gx gy ")
      call check(error, record%rate_source//format_real(record%sample_interval, 9), "timestamps0.5")
      call check(error, shown("# columns: t gx"//nl//"0 1 2"//nl//"0 3 4", reader_options(), record), "0 1 2 / 0 3 4 ")
      call check(error, warned(record), "line 1: the header's columns are 2, the first row has 3; the names are ignored|")
   end subroutine test_header_columns

   subroutine test_choose_columns()
      type(record_type) :: record
      type(reader_options) :: options
      character(*), parameter :: content = "label t Gx gy"//nl//"A 0 1 2"//nl//"B 1 3 4"//nl

      options%columns = "gy, gx"
      call check(error, shown(content, options, record)//channels(record), "2 1 / 4 3 gy Gx ")
      options%columns = "3"
      call check(error, shown(content, options, record)//channels(record), "1 / 3 Gx ")
      options%columns = "t"
      call check(error, shown(content, options, record)//channels(record), "0 / 1 t ")
   end subroutine test_choose_columns

   subroutine test_time_column()
      type(record_type) :: record
      type(reader_options) :: options

      options%time_column = "1"
      call check(error, shown("0 1"//nl//"0.25 2"//nl//"0.5 3", options, record), "1 / 2 / 3 ")
      call check(error, record%audit%has_stamps .and. record%rate_source == "timestamps" .and. len(warned(record)) == 0, &
                 warned(record))
      call check(error, record%sample_interval, 0.25_dp)
      options%time_column = "none"
      call check(error, shown("t x"//nl//"0 1"//nl//"0.5 2", options, record), "1 / 2 ")
      call check(error, .not. record%rate_known, "rate from a column that is no time")
   end subroutine test_time_column

   subroutine test_looks_like_time()
      type(record_type) :: record
      character(12*30) :: rising, uneven
      integer :: i

      do i = 1, 30
         write (rising(12*i - 11:12*i), "(f5.2, i6, a)") 0.1_dp*i, modulo(7*i, 5), nl
         write (uneven(12*i - 11:12*i), "(f5.2, i6, a)") 0.1_dp*i**2/10 + 20*(i/10), modulo(7*i, 5), nl
      end do
      call check(error, len(shown(rising, reader_options(), record)) > 0 .and. record%rate_known, "rate of an even rise")
      call check(error, channels(record)//warned(record), "column2 column 1 rises evenly from row to row and is taken for the "// &
                 "time; `time_column` none forbids it|")
      call check(error, len(shown(uneven, reader_options(), record)) > 0 .and. .not. record%rate_known, "an uneven rise")
      call check(error, channels(record)//warned(record), "column1 column2 column 1 rises from row to row and looks like time; "// &
                 "it is read as a channel, `time_column` 1 takes it for the time|")
      ! beside the columns that are asked for too
      call check(error, len(shown(rising, reader_options(columns="2"), record)) > 0 .and. record%rate_known, "asked")
      call check(error, channels(record)//warned(record), "column2 column 1 rises evenly from row to row and is taken for the "// &
                 "time; `time_column` none forbids it|")
      call check(error, len(shown(uneven, reader_options(columns="2"), record)) > 0 .and. .not. record%rate_known)
      call check(error, channels(record)//warned(record), "column2 ")
      call check(error, len(shown(rising, reader_options(columns="2", rate_hz=5.0_dp), record)) > 0, "a rate")
      call check(error, channels(record)//warned(record), "column2 ")
      call check(error, shown("0 1"//nl//"0.1 2"//nl//"0.2 1"//nl, reader_options(), record)//warned(record), &
                 "0 1 / 0.1 2 / 0.2 1 ")
   end subroutine test_looks_like_time

   !> Text, temperatures, further times and repeated names are left out, with a warning.
   subroutine test_left_out()
      type(record_type) :: record
      type(reader_options) :: options
      character(*), parameter :: content = "time,seconds_elapsed,frame,gx,temp"//nl//"0.0,0.0,imu,5,20"//nl//"0.5,0.5,imu,4,20"//nl

      call check(error, shown(content, options, record), "5 / 4 ")
      call check(error, warned(record), "columns not analyzed: 2 seconds_elapsed (time); 3 frame (text); 5 temp (temperature); "// &
                 "`columns` reads them|")
      options%columns = "frame"
      call check(error, index(shown(content, options, record), "'imu' is not a number") > 0, "text as a channel")
      call check(error, shown("0 -> X: 1 Y: 2"//nl//"1 -> X: 3 Y: 4"//nl, reader_options(), record), "0 1 2 / 1 3 4 ")
      call check(error, warned(record) == "columns not analyzed: 2 (text); `columns` reads them|", &
                 warned(record))
   end subroutine test_left_out

   !> Files that were put behind one another repeat the names; other words are still an error.
   subroutine test_repeated_names()
      type(record_type) :: record

      call check(error, shown("t,gx"//nl//"0,5"//nl//"1,4"//nl//" t,gx "//nl//"2,3"//nl//"t,gx"//achar(13)//nl//"3,2"//nl, &
                              reader_options(rate_hz=1.0_dp), record), "5 / 4 / 3 / 2 ")
      call check(error, warned(record), "2 lines repeat the names of the columns, as in files that were put behind one "// &
                 "another: left out; the first is line 4|")
      call check(error, index(shown("t,gx"//nl//"0,5"//nl//"t,gy"//nl, reader_options(), record), &
                              ":3:1: 't' is not a number") > 0, "other names")
   end subroutine test_repeated_names

   !> Whole seconds and nanoseconds, or microseconds, in two columns.
   subroutine test_split_stamps()
      type(record_type) :: record
      type(reader_options) :: options

      call check(error, shown("stamp.secs,stamp.nsecs,gx"//nl//"1700000000,500000000,5"//nl//"1700000001,0,4"//nl// &
                              "1700000001,500000000,3"//nl, options, record)//warned(record), "5 / 4 / 3 ")
      call check(error, record%sample_interval, 0.5_dp)
      options%time_column = "tv_sec"
      call check(error, shown("gx tv_usec tv_sec"//nl//"5 250000 7"//nl//"4 500000 7"//nl//"3 750000 7"//nl, options, record)// &
                 warned(record), "5 / 4 / 3 ")
      call check(error, record%sample_interval, 0.25_dp)
      options%time_column = "stamp.secs"
      call check(error, index(shown("stamp.secs,stamp.nsecs,gx"//nl//"1,0,5"//nl//"1,x,4"//nl, options, record), &
                              ":3:3: 'x' is not a number") > 0, "a fraction that is none")
   end subroutine test_split_stamps

   !> A line of units below the names: in brackets, and beside units that are not known.
   subroutine test_units_below()
      type(record_type) :: record

      call check(error, shown("t,gx,p"//nl//"[s],[deg/s],[bar]"//nl//"0,5,1"//nl//"1,4,1"//nl, reader_options(columns="gx"), &
                              record)//warned(record)//record%unit%name, "5 / 4 deg/s")
      call check(error, shown("t,gx"//nl//"good,bad"//nl//"0,5"//nl, reader_options(), record)//channels(record), "5 gx ")
   end subroutine test_units_below

   subroutine test_rates_differ()
      type(record_type) :: record
      character(*), parameter :: rows = "t gx"//nl//"0 1"//nl//"0.01 2"//nl//"0.02 3"//nl
      character(:), allocatable :: values

      values = shown("# rate_hz: 90"//nl//rows, reader_options(), record)
      call check(error, warned(record), "the rate 90 Hz of the header and the time stamps' 100 Hz differ; the header's is used|")
      call check(error, record%rate_source, "header")
      values = shown("# rate_hz: 99.5"//nl//rows, reader_options(), record)
      call check(error, record%rate_source//warned(record), "timestamps")
      values = shown(rows, reader_options(rate_hz=200.0_dp), record)
      call check(error, record%rate_source == "option" .and. index(warned(record), "the rate 200 Hz of the option") == 1, &
                 warned(record))
   end subroutine test_rates_differ

   subroutine test_increments()
      type(record_type) :: record
      type(reader_options) :: options

      options = reader_options(rate_hz=100.0_dp, scale=0.1_dp)
      options%input = "increment"
      options%unit = "arcsec"
      call check(error, shown("2"//nl//"nan"//nl//"-5", options, record), "20 / nan / -50 ")
      call check(error, record%unit%name, "arcsec/s")
   end subroutine test_increments

   subroutine test_angles()
      type(record_type) :: record
      type(reader_options) :: options

      options = reader_options(rate_hz=10.0_dp)
      options%input = "angle"
      call check(error, shown("1"//nl//"2"//nl//"nan"//nl//"4"//nl//"8"//nl//"7", options, record), "10 / nan / nan / 40 / -10 ")
      call check(error, record%audit%samples, 5_int64)
   end subroutine test_angles

   subroutine test_part()
      type(record_type) :: record
      type(reader_options) :: options
      character(*), parameter :: rows = "1"//nl//"2"//nl//"3"//nl//"nan"//nl//"5"//nl

      options = reader_options(rate_hz=10.0_dp, from=0.1_dp, to=0.3_dp)
      call check(error, shown(rows, options, record), "2 / 3 ")
      if (unmet(.not. allocated(record%present) .and. record%audit%samples == 2, "nothing is missing in the part")) return
      options = reader_options(rate_hz=10.0_dp, from=0.25_dp)
      call check(error, shown(rows, options, record), "nan / 5 ")
      options = reader_options(rate_hz=10.0_dp, to=99.0_dp)
      call check(error, shown(rows, options, record), "1 / 2 / 3 / nan / 5 ")
   end subroutine test_part

   subroutine test_bad_lines()
      type(record_type) :: record
      type(reader_options) :: options

      options%bad_lines_missing = .true.
      call check(error, shown("1 2"//nl//"x 3"//nl//"4 5 6"//nl//"7 8", options, record), "1 2 / nan nan / nan nan / 7 8 ")
      call check(error, record%audit%bad_lines, 2_int64)
      call check(error, warned(record), "2 lines could not be read and count as missing; the first is line 2|")
      options = reader_options(skip=2_int64)
      call check(error, shown("device 17"//nl//"9 9 9"//nl//"1 2"//nl, options, record), "1 2 ")
   end subroutine test_bad_lines

   subroutine test_audit_values()
      type(record_type) :: record
      character(:), allocatable :: values

      values = shown("1.5 3"//nl//"1.5 3"//nl//"nan 3"//nl//"-2 3"//nl//"-1.75 3"//nl, reader_options(), record)
      call check(error, all(abs(record%audit%minimum - [-2.0_dp, 3.0_dp]) <= 0.0_dp), "minimum")
      call check(error, all(abs(record%audit%maximum - [1.5_dp, 3.0_dp]) <= 0.0_dp), "maximum")
      call check(error, all(abs(record%audit%quantization - [0.25_dp, 0.0_dp]) <= 0.0_dp), "quantization")
   end subroutine test_audit_values

   !> A comment longer than a block, then a row that is.
   subroutine test_long_line()
      type(record_type) :: record
      character(*), parameter :: content = "# "//repeat("c", 1200000)//nl//"1.5 2"//nl//"3"//repeat(" ", 700000)//"4"//nl//"5 6"

      call check(error, shown(content, reader_options(), record), "1.5 2 / 3 4 / 5 6 ")
   end subroutine test_long_line

   !> Bytes in memory are read as a file of that content is; messages use the name that was given.
   subroutine test_memory()
      type(reader_options) :: options
      type(record_type) :: record
      integer(int8), allocatable, target :: bytes(:)

      bytes = transfer("# rate_hz = 50"//nl//"1 2"//nl//"3 4", [0_int8])
      options%bytes => bytes
      call read_record("log", options, record, failed)
      if (went_wrong(failed)) return
      call check(error, abs(record%value(2, 2) - 4) + abs(record%sample_interval - 0.02_dp) <= 0.0_dp)
      bytes(18) = iachar("x", int8)
      call read_record("log", options, record, failed)
      call check(error, index(failed%message, "log:2:3: ") == 1)
      options%bytes => bytes(:0)
      call read_record("log", options, record, failed)
      call check(error, index(failed%message, "log:1:1: the file is empty") == 1)
   end subroutine test_memory

   !> More rows than a chunk has, more bytes than a block has.
   subroutine test_many_rows()
      type(record_type) :: record
      integer, parameter :: n = 150000
      character(7*n) :: content
      character(:), allocatable :: values
      integer :: i

      do i = 1, n
         write (content(7*i - 6:7*i), "(i6, a)") i, nl
      end do
      values = shown(content, reader_options(), record)
      if (unmet(record%audit%samples, int(n, int64))) return
      do i = 1, n
         if (abs(record%value(i, 1) - i) <= 0.0_dp) cycle
         call check(error, .false., "row "//format_real(real(i, dp), 9)//" is "//format_real(record%value(i, 1), 9))
         return
      end do
   end subroutine test_many_rows

end module test_reader
