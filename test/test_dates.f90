! SPDX-License-Identifier: MIT
!> Dates and times of day: their forms, their precision, what is refused; decimal commas.
module test_dates
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_io_date, only : day_number, scan_stamp, stamp_kind
   use gyroakf_io_stamp_field, only : is_day_first, kind_of_field
   use gyroakf_io_reader, only : reader_options
   use gyroakf_io_commas, only : decimal_fields, seconds_comma
   use gyroakf_io_stamps, only : unwrap_days
   use gyroakf_record, only : record_type
   use scratch_file, only : read_content
   implicit none (type, external)
   private
   public :: suite_dates

   character(1), parameter :: nl = new_line("a"), tab = achar(9)

contains

   subroutine suite_dates()
      call test("days", test_days)
      call test("kinds", test_kinds)
      call test("moments", test_moments)
      call test("zones", test_zones)
      call test("nanoseconds", test_nanoseconds)
      call test("refused", test_refused)
      call test("day-first", test_day_first)
      call test("midnight", test_midnight)
      call test("columns", test_columns)
      call test("odd-rows", test_odd_rows)
      call test("long-stamps", test_long)
      call test("decimal-fields", test_decimal_fields)
      call test("seconds-comma", test_seconds_comma)
      call test("decimal-commas", test_commas)
   end subroutine suite_dates

   !> A text as bytes with line feeds behind it.
   function bytes_of(text) result(bytes)
      character(*), intent(in) :: text
      integer(int8) :: bytes(len(text) + 16)
      integer :: i

      bytes = 10_int8
      do i = 1, len(text)
         bytes(i) = int(iachar(text(i:i)), int8)
      end do
   end function bytes_of

   !> Seconds of a stamp from the beginning of 2026-05-01; -1 where it is none or something is left over.
   real(dp) function seconds(text, kind)
      character(*), intent(in) :: text
      integer, intent(in) :: kind
      integer(int64) :: at
      logical :: found

      at = 1
      call scan_stamp(bytes_of(text), at, kind, day_number(2026, 5, 1), seconds, found)
      if (.not. found .or. at /= len(text) + 1) seconds = -1.0_dp
   end function seconds

   !> The kind of a whole text.
   integer function kind_of(text)
      character(*), intent(in) :: text

      kind_of = kind_of_field(bytes_of(text), 1_int64, len(text, int64))
   end function kind_of

   !> Days known from elsewhere: the epoch, a leap day, the day that MJD 60000 is (2023-02-25, 60000 - 40587).
   subroutine test_days()
      integer :: year

      call check(error, day_number(1970, 1, 1), 0_int64)
      call check(error, day_number(2023, 2, 25), 60000_int64 - 40587_int64)
      call check(error, day_number(2000, 3, 1) - day_number(2000, 2, 28), 2_int64)
      call check(error, day_number(1900, 3, 1) - day_number(1900, 2, 28), 1_int64)
      do year = 1601, 2400
         if (day_number(year, 12, 31) + 1 /= day_number(year + 1, 1, 1)) exit
      end do
      call check(error, year, 2401)
   end subroutine test_days

   subroutine test_kinds()
      character(32), parameter :: text(17) = [character(32) :: "2026-05-01T12:00:00.5Z", "2026/5/1", "12:00", "9:05:07.25", &
         "2026-05-01", "01.05.2026", "1777636800123456789", "1777636800.123456789", "12.5", "2026", "1.05.26", "20260501", &
         "20260501120000020", "20260501_120000.020", "12-00-00_020", "12-00-00", "14463792000000000"]
      integer, parameter :: kind(17) = [stamp_kind%moment, stamp_kind%date, stamp_kind%clock, stamp_kind%clock, stamp_kind%date, &
         stamp_kind%date, stamp_kind%long, stamp_kind%long, stamp_kind%number, stamp_kind%number, stamp_kind%number, &
         stamp_kind%number, stamp_kind%moment, stamp_kind%moment, stamp_kind%clock, stamp_kind%number, stamp_kind%long]
      integer :: i

      do i = 1, size(text)
         call check(error, kind_of(trim(text(i))), kind(i), more=trim(text(i)))
      end do
   end subroutine test_kinds

   subroutine test_moments()
      character(32), parameter :: text(13) = [character(32) :: "20260501120000000", "20260501_120000.000", &
         "20260501T120000Z", "2026-05-01_12-00-00_000", "2026-05-01T12:00:00", "2026/05/01T12:00", "2026-5-1 12:00:00", &
         """2026-05-01 12:00:00,0""", "2026-05-01t12:00:00.000Z", "2026.05.01   12:00:00", "01.05.2026 12:00:00", &
         "2026-05-01 12:00", "2026-04-30T36:00:00"]
      integer :: i

      do i = 1, 12
         call check(error, seconds(trim(text(i)), stamp_kind%moment), 43200.0_dp, thr=0.0_dp, more=trim(text(i)))
      end do
      call check(error, seconds(trim(text(13)), stamp_kind%moment), -1.0_dp, more="36 hours")
      call check(error, seconds("2026-05-02T23:59:60", stamp_kind%moment), 172800.0_dp, thr=0.0_dp, more="leap second")
   end subroutine test_moments

   subroutine test_zones()
      character(32), parameter :: text(5) = [character(32) :: "2026-05-01T14:00:00+02:00", "2026-05-01T12:30+0030", &
         "2026-05-01 06:30:00.0-05:30", "2026-05-02T01:00:00+13", "2026-05-01T12:00:00-00:00"]
      integer :: i

      do i = 1, size(text)
         call check(error, seconds(trim(text(i)), stamp_kind%moment), 43200.0_dp, thr=0.0_dp, more=trim(text(i)))
      end do
   end subroutine test_zones

   !> Within the first day half a unit in the last place is 7.3 ps.
   subroutine test_nanoseconds()
      real(dp), parameter :: half_unit = 7.3e-12_dp

      call check(error, seconds("2026-05-01T23:59:59.123456789Z", stamp_kind%moment), 86399.123456789_dp, thr=half_unit)
      call check(error, seconds("2026-05-01T00:00:00.000000001", stamp_kind%moment), 1.0e-9_dp, thr=1.0e-24_dp)
      call check(error, seconds("2026-05-01T00:00:00.0000000010000000009999", stamp_kind%moment), 1.0e-9_dp, thr=1.0e-17_dp)
   end subroutine test_nanoseconds

   subroutine test_refused()
      character(32), parameter :: text(18) = [character(32) :: "2026-13-01T00:00", "2026-02-29", "2026-00-10", "2026-05-32", &
         "2026-05/01", "2026-05-01T25:00", "2026-05-01T12:60", "2026-05-01T12:00:61", "2026-05-01T", "2026-05-01T12:0", &
         "26-05-01", "2026-05-01T12:00+2", "01/05/2026", "2026-05-01T12:00:00,5", &
         "20261301120000", "18260501120000", "20260501126000", "20260501_1200"]
      integer :: i

      do i = 1, size(text)
         call check(error, seconds(trim(text(i)), stamp_kind%moment), -1.0_dp, more=trim(text(i)))
      end do
   end subroutine test_refused

   subroutine test_day_first()
      character(12), parameter :: text(6) = [character(12) :: "01/05/2026", "1-5-26", "2026/05/01", "1/5", "-1-5-26", "12.5"]
      logical, parameter :: first(6) = [.true., .true., .false., .false., .false., .false.]
      integer :: i

      do i = 1, size(text)
         call check(error, is_day_first(bytes_of(trim(text(i))), 1_int64, len_trim(text(i), int64)) .eqv. first(i), &
                    trim(text(i)))
      end do
      call expect_error("time,gx"//nl//"05/01/2026 12:00:00,1"//nl, "may have the day or the month first")
   end subroutine test_day_first

   !> Three midnights, a stamp out of order at one of them.
   subroutine test_midnight()
      real(dp) :: t(9)

      t = [86398.0_dp, 86399.5_dp, 0.5_dp, 86399.75_dp, 1.0_dp, 40000.0_dp, 60000.0_dp, 10.0_dp, 20.0_dp]
      call unwrap_days(t)
      call check(error, all(abs(t - [86398.0_dp, 86399.5_dp, 86400.5_dp, 86399.75_dp, 86401.0_dp, 126400.0_dp, 146400.0_dp, &
                                     172810.0_dp, 172820.0_dp]) < 1e-9_dp))
   end subroutine test_midnight

   !> Reads four rows: 2 Hz, the values 1 to 4, whatever the columns look like.
   subroutine expect_rows(content, channels, options)
      character(*), intent(in) :: content
      integer, intent(in) :: channels
      type(reader_options), intent(in), optional :: options
      type(reader_options) :: given
      type(record_type) :: record

      if (present(options)) given = options
      call read_content(content, "dates.csv", given, record, failed)
      if (allocated(failed)) call check(error, .false., content//": "//failed%message)
      if (allocated(error)) return
      if (unmet(size(record%value, 2), channels, more=content)) return
      if (unmet(size(record%value, 1), 4, more=content)) return
      call check(error, 1.0_dp/record%sample_interval, 2.0_dp, thr=1.0e-9_dp, more=content)
      call check(error, all(abs(record%value(:, channels) - [1.5_dp, 2.5_dp, 3.5_dp, 4.5_dp]) < 1e-12_dp), content)
   end subroutine expect_rows

   !> The message holds a text.
   subroutine expect_error(content, fragment)
      character(*), intent(in) :: content, fragment
      type(record_type) :: record

      call read_content(content, "dates.csv", reader_options(), record, failed)
      if (unmet(allocated(failed), content)) return
      call check(error, index(failed%message, fragment) > 0, failed%message)
   end subroutine expect_error

   subroutine test_columns()
      character(26), parameter :: t(4) = [character(26) :: "2026-05-01 23:59:59.250", "2026-05-01 23:59:59.750", &
                                          "2026-05-02 00:00:00.250", "2026-05-02 00:00:00.750"]
      character(4), parameter :: x(4) = ["1.5 ", "2.5 ", "3.5 ", "4.5 "]
      character(:), allocatable :: row(:)
      integer :: k, i

      allocate (character(200) :: row(6))
      row = ""
      row(1) = "time,gx"//nl
      row(4) = "date,time,gx"//nl
      row(5) = "time date gx"//nl
      do i = 1, 4
         row(1) = trim(row(1))//trim(t(i))//","//trim(x(i))//nl
         row(2) = trim(row(2))//t(i)(:10)//"T"//trim(t(i)(12:))//"Z "//trim(x(i))//nl
         row(3) = trim(row(3))//trim(t(i))//" "//trim(x(i))//nl
         row(4) = trim(row(4))//t(i)(:10)//","//trim(t(i)(12:))//", "//trim(x(i))//nl
         row(5) = trim(row(5))//trim(t(i)(12:))//tab//t(i)(:10)//tab//trim(x(i))//nl
         row(6) = trim(row(6))//""""//trim(t(i)(12:))//""","//trim(x(i))//nl
      end do
      do k = 1, 6
         call expect_rows(trim(row(k)), 1)
      end do
   end subroutine test_columns

   !> Blank stamps, comments behind a row, a number where a date was.
   subroutine test_odd_rows()
      call expect_rows("time,gx"//nl//"2026-05-01 12:00:00,1.5 # first"//nl//",2.5"//nl//"2026-05-01 12:00:01,3.5"//nl// &
                       """2026-05-01 12:00:01.500"",4.5"//nl, 1)
      call expect_rows("date;time;gx"//nl//"2026-05-01;12:00:00;1.5"//nl//"2026-05-01;;2.5"//nl// &
                       "2026-05-01;12:00:01;3.5"//nl//"2026-05-01;12:00:01.5;4.5"//nl//"2026-05-01;nan;5.5"//nl, 1)
      call expect_error("2026-05-01T12:00:00,1"//nl//"2026-05-01T12:00:61,2"//nl, "is not a date as in the first row")
      call expect_error("12:00:00,1"//nl//"noon,2"//nl, "is not a time of day as in the first row")
      call expect_error("1,1"//nl//"12:00,2"//nl, "the first row has a number in this column")
      call expect_error("time"//nl//"12:00"//nl//"12:01"//nl, "there is no column besides the time")
   end subroutine test_odd_rows

   !> Nanoseconds since 1970: a double alone has steps of 256 of them.
   subroutine test_long()
      type(record_type) :: record

      call read_content("stamp,gx"//nl//"1777636800123456701,1"//nl//"1777636800123456802,2"//nl// &
         & "1777636800123456903,3"//nl//"1777636800123457004,4"//nl, "long.csv", reader_options(), &
         & record, failed)
      if (went_wrong(failed, "read")) return
      call check(error, record%sample_interval, 101.0e-9_dp, thr=1.0e-12_dp, rel=.true.)
      call check(error, record%audit%jitter_max < 1.0e-15_dp, "even")
   end subroutine test_long

   subroutine test_decimal_fields()
      character(40), parameter :: text(16) = [character(40) :: "1,5;2,3", "1,5 2,3  3", "1,5;;2,3;", "01.05.2026 12:00:00,5;1,5", &
         "1,5", "1,2,3", "1.5;2,3", "1,5; ,3", "1.234,5;2", "1, 2", "-1,5e-3;NaN", "1,5"//tab//"2", &
         "2026-05-01 12:00:00,5", "2026-05-01 12:00:00.25,5", "2026.05.01T12:00:00,000Z;-3,25;1", "1.2.3,5;2"]
      integer, parameter :: fields(16) = [2, 3, 3, 2, 1, 0, 0, 0, 0, 0, 2, 2, 0, 0, 3, 0]
      integer :: i

      do i = 1, size(text)
         call check(error, decimal_fields(bytes_of(trim(text(i))), 1_int64, len_trim(text(i), int64)), fields(i), &
                    more=trim(text(i)))
      end do
   end subroutine test_decimal_fields

   subroutine test_seconds_comma()
      character(40), parameter :: text(8) = [character(40) :: "12:00:00,123 1.5", "12:00:00,123456;1.5", "12:00:00,123,1.5", &
         "12:00:00,0.5", "12:00:00,12;1.5", "12:00:00,123", "12:00:00,123+02:00;1.5", "12:00:00,123Z,1.5"]
      logical, parameter :: decimal(8) = [.true., .true., .false., .false., .false., .false., .true., .false.]
      integer :: i

      do i = 1, size(text)
         call check(error, seconds_comma(bytes_of(trim(text(i))), 1_int64, len_trim(text(i), int64)) .eqv. decimal(i), &
                    trim(text(i)))
      end do
   end subroutine test_seconds_comma

   !> Read where it is sure or said, else refused, never split.
   subroutine test_commas()
      type(reader_options) :: options

      options%rate_hz = 2.0_dp
      call expect_rows("1,25;1,5"//nl//"2;2,5"//nl//"0,5;3,5"//nl//"1;4,5"//nl, 2, options)
      call expect_rows("1,25 1,5"//nl//"2 2,5"//nl//"0,5 3,5"//nl//"1,0 4,5"//nl, 2, options)
      options%decimal_comma = .true.
      call expect_rows("1,5"//nl//"2,5"//nl//"3,5"//nl//"4,5"//nl, 1, options)
      call expect_error("1,5;2,3"//nl//"1.5;2.3"//nl, "this looks like a decimal comma")
      call expect_error("a;b;c"//nl//"1,5;2,3"//nl, "this looks like a decimal comma")
   end subroutine test_commas

end module test_dates
