! SPDX-License-Identifier: MIT
!> Lines taken apart, decimal commas, foreign content, messages with a caret.
module test_text
   use expectations, only : placed => problem, test, error, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_commas, only : decimal_comma
   use gyroakf_io_columns, only : column_names_type
   use gyroakf_io_format, only : content_type, recognize_content
   use gyroakf_io_labels, only : name_fields
   use gyroakf_io_marks, only : find_marks, marks_type
   use gyroakf_io_place, only : place_error
   use gyroakf_column_class, only : class_of, column_class, is_time_name
   use gyroakf_io_stamps, only : infer_scale, named_scale
   use gyroakf_io_text, only : bytes_text, fields_type, is_no_row, split, split_line, text_bytes
   implicit none (type, external)
   private
   public :: suite_text

   character(1), parameter :: tab = achar(9), nl = new_line("a")

contains

   subroutine suite_text()
      call test("split-mixed", test_split_mixed)
      call test("split-tabs-names", test_split_tabs)
      call test("labels", test_labels)
      call test("comments", test_comments)
      call test("decimal-comma", test_decimal_comma)
      call test("foreign-content", test_foreign)
      call test("caret", test_caret)
      call test("caret-utf8", test_caret_utf8)
      call test("caret-long-line", test_caret_long)
      call test("time-names", test_time_names)
      call test("time-units", test_time_units)
      call test("time-units-inferred", test_inferred)
   end subroutine suite_text

   !> A text as bytes with line feeds behind it.
   function bytes_of(text) result(bytes)
      character(*), intent(in) :: text
      integer(int8) :: bytes(len(text) + 16)

      bytes = 10_int8
      bytes(:len(text)) = text_bytes(text)
   end function bytes_of

   !> The names and units that a row with marks gives its fields, between bars.
   function names_of(text) result(joined)
      character(*), intent(in) :: text
      character(:), allocatable :: joined
      integer(int8) :: line(len(text))
      type(marks_type) :: marks
      type(fields_type) :: fields
      type(column_names_type) :: names
      integer :: array, i

      line = text_bytes(text)
      call find_marks(line, 1_int64, size(line, kind=int64), .true., marks)
      call split_line(line, 1_int64, size(line, kind=int64), split%mixed, fields)
      call name_fields(text_bytes(text), 1_int64, fields, names, array)
      joined = "|"
      if (.not. names%known) return
      do i = 1, size(names%name)
         joined = joined//names%name(i)%text
         if (len(names%unit(i)%text) > 0) joined = joined//" "//names%unit(i)%text
         joined = joined//"|"
      end do
   end function names_of

   !> Labels before the first value, in groups and lists: the first field has none before it.
   subroutine test_labels()
      character(40), parameter :: line(9) = [character(40) :: "gx=1, gy=2", "g: 1 2 3", "g: [1, 2, 3]", "[1, 2, 3] [4, 5, 6]", &
         "{""gyro"": {""x"": 1, ""y"": 2}, ""t"": 3}", "{""g"": [1, 2], ""a"": [3, 4]}", "gx: 1 dps gy: 2 dps", "[1] g=2", &
         "t=[1], g=[2, 3]"]
      character(40), parameter :: named(9) = [character(40) :: "|gx|gy|", "|g[0]|g[1]|g[2]|", "|g[0]|g[1]|g[2]|", "|", &
         "|gyro x|gyro y|t|", "|g[0]|g[1]|a[0]|a[1]|", "|gx dps|gy dps||", "||g|", "|t|g[0]|g[1]|"]
      integer :: i

      do i = 1, size(line)
         call check(error, names_of(trim(line(i))), trim(named(i)), trim(line(i)))
      end do
   end subroutine test_labels

   !> The fields between bars, "<" behind them where the line ends with a separator.
   function parts(text, way) result(joined)
      character(*), intent(in) :: text
      integer, intent(in) :: way
      character(:), allocatable :: joined
      type(fields_type) :: fields
      integer :: i

      call split_line(bytes_of(text), 1_int64, len(text, int64), way, fields)
      joined = "|"
      do i = 1, fields%count
         joined = joined//bytes_text(bytes_of(text), fields%first(i), fields%last(i))//"|"
      end do
      if (fields%trailing) joined = joined//"<"
      if (fields%open_quote > 0) joined = joined//"?"
   end function parts

   subroutine test_split_mixed()
      character(24), parameter :: line(14) = [character(24) :: "1 2", "  1   2  ", "1,2", "1 , 2", "1;2", "1,,2", ",1", "1,2,", &
         "1, ,2,", '"a b",2', "'x',""y""", "1 2 # note", "1 2 // note", """open"]
      character(24), parameter :: expected(14) = [character(24) :: "|1|2|", "|1|2|", "|1|2|", "|1|2|", "|1|2|", "|1||2|", "||1|", &
         "|1|2||<", "|1||2||<", "|a b|2|", "|x|y|", "|1|2|", "|1|2|", "|open|?"]
      integer :: i

      do i = 1, size(line)
         call check(error, parts(trim(line(i)), split%mixed), trim(expected(i)), more=line(i))
      end do
      call check(error, parts("1"//tab//tab//"2"//achar(13), split%mixed), "|1|2|")
   end subroutine test_split_mixed

   subroutine test_split_tabs()
      call check(error, parts("1"//tab//tab//"2"//tab, split%tabs), "|1||2||<")
      call check(error, parts("1 2"//tab//"3", split%tabs), "|1|2|3|")
      call check(error, parts(" gyro x , ""gyro y"";z ", split%names), "|gyro x|gyro y|z|")
   end subroutine test_split_tabs

   subroutine test_comments()
      character(8), parameter :: yes(6) = [character(8) :: "# a", "  % a", "; a", "// a", ";1;2", ""]
      character(8), parameter :: no(4) = [character(8) :: "1 # a", "/ a", "-1", "a"]
      integer :: i

      do i = 1, size(yes)
         call check(error, is_no_row(bytes_of(yes(i)), 1_int64, 8_int64), yes(i))
      end do
      do i = 1, size(no)
         call check(error,.not. is_no_row(bytes_of(no(i)), 1_int64, 8_int64), "taken: "//no(i))
      end do
   end subroutine test_comments

   subroutine test_decimal_comma()
      character(16), parameter :: line(16) = [character(16) :: "1,5;2,3", "1,5 2,3", "0;0,5", "-1,5e-3; 2,0e1", "1,05", "-0,5", &
         "1,2", "1,2,3", "1.5,2.5", "1.5;2,5", "1, 2; 3, 4", "1,2,3;4", "1;2;3", """1,5"";2", "10,20", ""]
      integer, parameter :: expected(16) = [2, 2, 4, 3, 2, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
      integer :: i

      do i = 1, size(line)
         call check(error, int(decimal_comma(bytes_of(line(i)), 1_int64, len_trim(line(i), int64))), expected(i), more=line(i))
      end do
   end subroutine test_decimal_comma

   subroutine test_foreign()
      call check_content("1 2"//achar(0)//"3", "a.txt", "foreign", "binary")
      call check_content("BZh91AY", "a.txt", "foreign", "compressed by bzip2")
      call check_content(char(255)//char(254)//"1"//achar(0), "a.txt", "foreign", "text in UTF-16")
      call check_content(repeat("1.5 2"//nl, 30)//achar(27), "a.txt", "text", "")
      call check_content("1.5 "//achar(1)//achar(2)//" 3", "a.txt", "foreign", "binary")
      call check_content(repeat("1"//achar(0)//nl//achar(0), 30), "a.txt", "foreign", &
                         "text in UTF-16 without a byte-order mark")
      call check_content(repeat("1.5"//nl, 30)//repeat(achar(0), 4), "a.txt", "foreign", &
                         "text with 4 NUL bytes, as a logger leaves them that lost its power")
      call check_content("MATLAB 7.3 MAT-file"//repeat(" ", 493)//char(137)//"HDF"//char(13)//nl//char(26)//nl, &
                         "a.mat", "foreign", "an HDF5 file (.h5, MATLAB 7.3)")
      call check_content(char(147)//"NUMPY"//char(1)//char(0), "a.txt", "npy", "")
      call check_content(char(255)//char(254)//"x", "a.i16be", "binary", "")
      call check_content("1.5"//nl, "a.f64", "text", "")
   end subroutine test_foreign

   !> What a file's first bytes and its name tell.
   subroutine check_content(bytes, name, kind, what)
      character(*), intent(in) :: bytes, name, kind, what
      type(content_type) :: content

      call recognize_content(bytes_of(bytes), name, content)
      call check(error, trim(content%kind), kind)
      if (allocated(error) .or. len(what) == 0) return
      call check(error, content%what, what)
   end subroutine check_content

   subroutine test_caret()
      call place_error(placed, "a.txt", 7_int64, bytes_of("1"//tab//"x2 3"), 1_int64, 6_int64, 3_int64, "bad", "mend it")
      call check(error, placed%message, &
                 "a.txt:7:3: bad"//nl//"1 x2 3"//nl//"  ^"//nl//"mend it")
      call place_error(placed, "a", 1_int64, bytes_of("1 2"), 1_int64, 3_int64, 4_int64, "short", "do")
      call check(error, placed%message, &
                 "a:1:4: short"//nl//"1 2"//nl//"   ^"//nl//"do")
   end subroutine test_caret

   subroutine test_caret_utf8()
      character(*), parameter :: degree = char(194)//char(176)

      call place_error(placed, "a", 1_int64, bytes_of("5"//degree//" x"), 1_int64, 5_int64, 5_int64, "bad", "do")
      call check(error, placed%message, &
                 "a:1:4: bad"//nl//"5"//degree//" x"//nl//"   ^"//nl//"do")
      call place_error(placed, "a", 1_int64, bytes_of(char(176)//" x"//achar(7)), 1_int64, 4_int64, 3_int64, "bad", "do")
      call check(error, placed%message, &
                 "a:1:3: bad"//nl//"? x?"//nl//"  ^"//nl//"do")
   end subroutine test_caret_utf8

   subroutine test_caret_long()
      character(:), allocatable :: line, message, shown, caret
      integer :: first, second, third

      line = repeat("0123456789", 50)
      line(251:251) = "x"
      call place_error(placed, "a", 1_int64, bytes_of(line), 1_int64, 500_int64, 251_int64, "bad", "do")
      message = placed%message
      first = index(message, nl)
      second = first + index(message(first + 1:), nl)
      third = second + index(message(second + 1:), nl)
      shown = message(first + 1:second - 1)
      caret = message(second + 1:third - 1)
      call check(error, message(:first - 1), "a:1:251: bad")
      call check(error, len(shown) <= 102 .and. shown(:3) == "..." .and. shown(len(shown) - 2:) == "...", shown)
      call check(error, shown(len(caret):len(caret)), "x")
   end subroutine test_caret_long

   subroutine test_time_names()
      character(18), parameter :: yes(42) = [character(18) :: "t", "T_ms", "time", "Timestamp", "time_s", "time_ms", "t_us", &
         "sensor_timestamp", "gps_time", "header.stamp", "seconds", "Time ns", "TimeUS", "timeus", "TIME_US", "time_usec", &
         "SampleTimeFine", "sampletimefine", "gps_tow_s", "tow", "iTOW", "GPS TOW", "gpstime", "GPSTime", "epoch", "epoc", &
         "Elapsed Time", "Time stamp", "loggingTime", "SystemTime", "UTC", "utc_time", "timestamp_sample", "ts", &
         "unix_time", "System Time", "micros", "Millis", "seconds_elapsed", "elapsed", "Uhrzeit", "acc_timestamp"]
      character(16), parameter :: no(20) = [character(16) :: "gx", "temp", "tx", "ts1", "rate_s", "", "temperature", "T", &
         "delta_time", "time_step", "timestamp_valid", "gx_deg_sec", "exposure_time", "time_constant", "gyro_x", "Timer", &
         "UTC offset", "T_x", "rad_per_sec", "sync_time"]
      integer :: i

      do i = 1, size(yes)
         call check(error, is_time_name(trim(yes(i)), ""), yes(i))
      end do
      do i = 1, size(no)
         call check(error,.not. is_time_name(trim(no(i)), ""), "taken: "//no(i))
      end do
      call check(error, is_time_name("T", "s") .and. .not. is_time_name("T", "degC") .and. .not. is_time_name("t", "degC"), "T")
      associate (class => column_class%temperature)
         call check(error, all([class_of("T", ""), class_of("T", "degC"), class_of("GyroTemp", ""), &
            class_of("tempC", "")] == class) .and. all([class_of("T", "s"), class_of("tempo", ""), &
            class_of("t", "")] /= class), "temperatures")
      end associate
      associate (class => column_class%counter)
         call check(error, all([class_of("Packet Counter", ""), class_of("header.seq", ""), class_of("n", ""), &
            class_of("PacketCounter", "")] == class) .and. class_of("gx", "") /= class, "counters")
      end associate
   end subroutine test_time_names

   subroutine test_time_units()
      call check(error, named_scale("time_ms", "", 0.0_dp), 1.0e-3_dp)
      call check(error, named_scale("Time", "us", 0.0_dp), 1.0e-6_dp)
      call check(error, named_scale("t_ns", "", 0.0_dp), 1.0e-9_dp)
      call check(error, named_scale("seconds", "", 0.0_dp), 1.0_dp)
      call check(error, named_scale("time", "deg", 0.0_dp), 0.0_dp)
      call check(error, named_scale("TimeUS", "", 0.0_dp), 1.0e-6_dp)
      call check(error, named_scale("SampleTimeFine", "", 100.0_dp), 1.0e-4_dp)
      call check(error, named_scale("SampleTimeFine", "", 16667.0_dp), 1.0e-6_dp)
      call check(error, named_scale("gps_tow_s", "", 0.0_dp) + named_scale("t", "100us", 0.0_dp), &
                 1.0001_dp, thr=1.0e-12_dp)
      call check(error, named_scale("epoc", "ms", 0.0_dp) + named_scale("t", "min", 0.0_dp) &
                 + named_scale("t", "12", 0.0_dp), 60.001_dp, thr=1.0e-12_dp)
   end subroutine test_time_units

   subroutine test_inferred()
      !> First stamp, step, rate that was given, unit expected
      real(dp), parameter :: table(4, 9) = reshape([ &
         0.0_dp, 0.01_dp, 0.0_dp, 1.0_dp, 0.0_dp, 10.0_dp, 0.0_dp, 1.0e-3_dp, 0.0_dp, 5000.0_dp, 0.0_dp, 1.0e-6_dp, &
         0.0_dp, 1.0e7_dp, 0.0_dp, 1.0e-9_dp, 1.7e9_dp, 1.0_dp, 0.0_dp, 1.0_dp, 1.7e12_dp, 1.0_dp, 0.0_dp, 1.0e-3_dp, &
         1.7e18_dp, 1.0e7_dp, 0.0_dp, 1.0e-9_dp, 0.0_dp, 1000.0_dp, 1.0_dp, 1.0e-3_dp, 0.0_dp, 125.0_dp, 8000.0_dp, 1.0e-6_dp], &
         [4, 9])
      integer :: i, k
      real(dp) :: t(5), scale
      logical :: sure

      do i = 1, size(table, 2)
         do k = 1, 5
            t(k) = table(1, i) + table(2, i)*(k - 1)
         end do
         call infer_scale(t, table(3, i), scale, sure)
         call check(error, scale, table(4, i), more=achar(48 + i))
      end do
   end subroutine test_inferred

end module test_text
