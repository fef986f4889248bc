! SPDX-License-Identifier: MIT
!> Rows of text read by several threads: the same as by one, and as line by line; files that change
!> while they are read; the store of their chunks.
module test_text_rows
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use expectations, only : unmet, failed => problem, test, error, check, check_refused, &
      & went_wrong
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_source, only : close_source
   use gyroakf_io_lines, only : line_of, lines_type, open_lines
   use gyroakf_io_store, only : count_rows, store_type, add_chunk, take_columns
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_first_row, only : begin_table
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text_rows, only : read_rows
   use scratch_file, only : remove_file, scratch_path, write_bytes
   implicit none (type, external)
   private
   public :: suite_text_rows, suite_store

   character(1), parameter :: nl = new_line("a")
   !> Kinds of lines, one of which is drawn for each line of [[odd_content]]
   character(*), parameter :: kinds(12) = [character(24) :: "1.25,-3", "-0.5 2e3", " 7; 8", "nan,4", "5,NA", "# comment", "", &
                                           "'1',""2""", ",3", "x 3", "1 2 3", "1.00000000000000001,2"]
   !> What these lines hold; huge for missing
   real(dp), parameter :: gone = huge(1.0_dp)
   real(dp), parameter :: held(2, 12) = reshape([1.25_dp, -3.0_dp, -0.5_dp, 2000.0_dp, 7.0_dp, 8.0_dp, gone, 4.0_dp, 5.0_dp, gone, &
      0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 2.0_dp, gone, 3.0_dp, gone, gone, gone, gone, 1.0_dp, 2.0_dp], [2, 12])

contains

   subroutine suite_text_rows()
      call test("every-kind-of-line", test_every_kind)
      call test("returns-only", test_returns)
      call test("first-problem", test_first_problem)
      call test("blank-lines", test_blank_lines)
      call test("semicolon-first", test_semicolon_first)
      call test("many-columns", test_many_columns)
      call test("line-of-megabytes", test_huge_line)
      call test("few-rows-at-a-time", test_few_rows)
      call test("file-that-grows", test_growing)
      call test("file-that-shrinks", test_shrinking)
   end subroutine suite_text_rows

   subroutine suite_store()
      call test("many-pages", test_pages)
      call test("single-chunk", test_single)
   end subroutine suite_store

   !> Many lines of every kind, in an order drawn by a generator; begins with a plain one.
   subroutine odd_content(lines, ending, content, kind)
      integer, intent(in) :: lines
      character(*), intent(in) :: ending
      character(:), allocatable, intent(out) :: content
      integer, allocatable, intent(out) :: kind(:)
      integer(int64) :: state
      integer :: i, at

      allocate (character(26*lines) :: content)
      allocate (kind(lines))
      state = 4711
      at = 0
      do i = 1, lines
         state = mod(state*48271_int64, 2147483647_int64)
         kind(i) = 1 + int(mod(state/1000, 12_int64))
         if (i == 1) kind(i) = 1
         if (i > lines/2 .and. i < lines/2 + 20000) kind(i) = 1
         content(at + 1:at + len_trim(kinds(kind(i))) + len(ending)) = trim(kinds(kind(i)))//ending
         at = at + len_trim(kinds(kind(i))) + len(ending)
      end do
      content = content(:at)
   end subroutine odd_content

   !> Opens a file and reads what stands above its rows.
   subroutine begin(lines, path, options, table, failed)
      type(lines_type), intent(out) :: lines
      character(*), intent(in) :: path
      type(reader_options), intent(in) :: options
      type(table_type), intent(out) :: table
      type(gyro_error), allocatable, intent(out) :: failed

      call open_lines(lines, path, failed)
      if (.not. allocated(failed)) call begin_table(lines, options, table, failed)
   end subroutine begin

   !> Reads a content with a number of threads.
   subroutine read_with(content, threads, table, failed)
      character(*), intent(in) :: content
      integer, intent(in) :: threads
      type(table_type), intent(out) :: table
      type(gyro_error), allocatable, intent(out) :: failed
      type(lines_type) :: lines
      type(reader_options) :: options
      integer :: usual

      usual = thread_count()
      call set_thread_count(threads)
      options%bad_lines_missing = index(content, "strict") == 0
      call write_bytes(scratch_path("rows.txt"), content)
      options%input = "rate"
      call begin(lines, scratch_path("rows.txt"), options, table, failed)
      if (.not. allocated(failed)) call read_rows(lines, huge(1_int64), table, failed)
      call close_source(lines%source)
      call remove_file(scratch_path("rows.txt"))
      call set_thread_count(usual)
   end subroutine read_with

   !> A stored value by its row.
   real(dp) function stored(table, row, column)
      type(table_type), intent(in) :: table
      integer(int64), intent(in) :: row
      integer, intent(in) :: column
      integer(int64) :: before
      integer :: i

      before = 0
      stored = 0.0_dp
      do i = 1, table%store%count
         if (row <= before + table%store%chunk(i)%rows) then
            stored = table%store%chunk(i)%value(row - before, column)
            return
         end if
         before = before + table%store%chunk(i)%rows
      end do
   end function stored

   !> Compares a table with the lines that were written.
   subroutine compare(table, kind)
      type(table_type), intent(in) :: table
      integer, intent(in) :: kind(:)
      integer(int64) :: row
      integer :: i, j

      call check(error, table%bad_lines, count(kind == 10 .or. kind == 11, kind=int64), "bad lines")
      call check(error, table%first_bad_line, int(findloc(kind == 10 .or. kind == 11, .true., 1), int64), "first bad line")
      row = 0
      do i = 1, size(kind)
         if (allocated(error)) return
         if (kind(i) == 6 .or. kind(i) == 7) cycle
         row = row + 1
         if (mod(i, 97) == 0 .or. i > size(kind) - 9) call check(error, line_of(table%map, row), int(i, int64), "line of a row")
         do j = 1, 2
            if (same(stored(table, row, j), held(j, kind(i)))) cycle
            call check(error, .false., "a line '"//trim(kinds(kind(i)))//"' was read wrong")
            return
         end do
      end do
      if (.not. allocated(error)) call check(error, count_rows(table%store), row, "rows")
   end subroutine compare

   !> True for the same number, or NaN for one that is gone.
   logical function same(x, y)
      real(dp), intent(in) :: x, y

      same = ieee_is_nan(x) .eqv. y >= gone
      if (same .and. y < gone) same = abs(x - y) <= 0.0_dp
   end function same

   !> A million lines of every kind: line by line what was written, for any number of threads.
   subroutine test_every_kind()
      type(table_type) :: table
      character(:), allocatable :: content
      integer, allocatable :: kind(:)
      integer :: threads

      call odd_content(300000, nl, content, kind)
      do threads = 1, 3
         call read_with(content, threads, table, failed)
         if (went_wrong(failed)) return
         call compare(table, kind)
      end do
   end subroutine test_every_kind

   !> The same with the line ends of old systems, and with both characters.
   subroutine test_returns()
      type(table_type) :: table
      character(:), allocatable :: content
      integer, allocatable :: kind(:)

      call odd_content(150000, achar(13), content, kind)
      call read_with(content, 2, table, failed)
      if (went_wrong(failed)) return
      call compare(table, kind)
      call odd_content(150000, achar(13)//nl, content, kind)
      call read_with(content, 2, table, failed)
      if (went_wrong(failed)) return
      call compare(table, kind)
   end subroutine test_returns

   !> Of several lines that cannot be read the first one is reported, wherever the others are.
   subroutine test_first_problem()
      integer, parameter :: lines = 400000
      type(table_type) :: table
      character(:), allocatable :: content
      integer :: at

      content = "# strict"//nl//repeat("0.125 4"//nl, lines)
      at = lines
      do while (at > 10)
         content(8 + 8*at:8 + 8*at) = "x"
         call read_with(content, 2, table, failed)
         if (unmet(allocated(failed))) return
         call check(error, index(failed%message, place(at + 1)//": 'x' is not a number") > 0, failed%message)
         at = at/3
      end do
   end subroutine test_first_problem

   !> ":12:7" for line 12.
   pure function place(line) result(text)
      integer, intent(in) :: line
      character(16) :: written
      character(:), allocatable :: text

      write (written, "(a, i0, a)") ":", line, ":7"
      text = trim(written)
   end function place

   !> A line that begins with a semicolon is a row without its first number where semicolons part the columns, else a comment.
   subroutine test_semicolon_first()
      character(*), parameter :: content(5) = [character(24) :: "1;2"//nl//";4"//nl//"5;6", "a;b"//nl//";4"//nl//"5;6", &
         "1;2"//nl//"; 4 volts"//nl//"5;6", "1 2"//nl//"; 3 4"//nl//"5 6", "1,2"//nl//";4"//nl//"5,6"]
      integer(int64), parameter :: rows(5) = [3_int64, 2_int64, 2_int64, 2_int64, 2_int64]
      integer(int64), parameter :: short(5) = [2_int64, 1_int64, 0_int64, 0_int64, 0_int64]
      type(table_type) :: table
      integer :: i

      do i = 1, size(content)
         call read_with(trim(content(i)), 1, table, failed)
         if (went_wrong(failed)) return
         if (unmet(count_rows(table%store), rows(i), trim(content(i)))) return
         call check(error, same(stored(table, rows(i), 2), 6.0_dp))
         if (short(i) == 0) cycle
         call check(error, same(stored(table, short(i), 1), gone) .and. same(stored(table, short(i), 2), 4.0_dp), trim(content(i)))
      end do
   end subroutine test_semicolon_first

   !> A million blank lines in the midst take one entry in the map of lines.
   subroutine test_blank_lines()
      type(table_type) :: table

      call read_with("1 2"//nl//repeat(nl, 1000000)//"3 4"//nl//"5 6", 2, table, failed)
      if (went_wrong(failed)) return
      call check(error, count_rows(table%store), 3_int64)
      call check(error, line_of(table%map, 2_int64), 1000002_int64)
      call check(error, line_of(table%map, 3_int64), 1000003_int64)
      call check(error, table%map%count <= 2)
   end subroutine test_blank_lines

   !> Rows longer than a piece; ten thousand columns.
   subroutine test_many_columns()
      integer, parameter :: columns = 10000
      type(table_type) :: table
      character(20*columns) :: line
      integer :: j

      do j = 1, columns
         write (line(20*j - 19:20*j), "(i17, 3x)") j
      end do
      call read_with(repeat(line//nl, 20), 2, table, failed)
      if (went_wrong(failed)) return
      call check(error, count_rows(table%store), 20_int64)
      do j = 1, columns
         call check(error, abs(stored(table, 1_int64, j) - j) + abs(stored(table, 20_int64, j) - j) <= 0.0_dp)
      end do
   end subroutine test_many_columns

   !> A line of 15 MB, longer than any block, is read; one of 25 MB is refused.
   subroutine test_huge_line()
      type(table_type) :: table

      call read_with("1 2"//nl//"3"//repeat(" ", 25000000)//"4"//nl//"5 6", 2, table, failed)
      if (unmet(allocated(failed))) return
      call check(error, index(failed%message, ":2:1: a line of more than 16 MB") > 0)
      call read_with("1 2"//nl//"3"//repeat(" ", 15000000)//"4"//nl//"5 6", 2, table, failed)
      if (went_wrong(failed)) return
      call check(error, count_rows(table%store), 3_int64)
      call check(error, abs(stored(table, 2_int64, 2) - 4) + abs(stored(table, 3_int64, 2) - 6) <= 0.0_dp)
   end subroutine test_huge_line

   !> Rows can be asked for in parts; what is not asked for stays in the file.
   subroutine test_few_rows()
      type(table_type) :: table
      type(lines_type) :: lines
      type(reader_options) :: options
      integer(int64) :: rows
      integer :: calls

      call write_bytes(scratch_path("parts.txt"), repeat("1.5"//nl, 1000000))
      options%input = "rate"
      call begin(lines, scratch_path("parts.txt"), options, table, failed)
      rows = 0
      do calls = 1, 1000
         call read_rows(lines, 1000_int64, table, failed)
         if (allocated(failed) .or. count_rows(table%store) == 0) exit
         rows = rows + count_rows(table%store)
         table%store = store_type()
      end do
      call close_source(lines%source)
      call remove_file(scratch_path("parts.txt"))
      if (unmet(.not. allocated(failed) .and. table%whole)) return
      call check(error, rows, 1000000_int64)
      call check(error, calls > 5)
   end subroutine test_few_rows

   !> Opens a file, appends to it or writes it anew, reads it.
   subroutine read_changed(before, after, anew, table, failed)
      character(*), intent(in) :: before, after
      logical, intent(in) :: anew
      type(table_type), intent(out) :: table
      type(gyro_error), allocatable, intent(out) :: failed
      type(lines_type) :: lines
      type(reader_options) :: options
      integer :: unit

      call write_bytes(scratch_path("changed.txt"), before)
      options%input = "rate"
      call begin(lines, scratch_path("changed.txt"), options, table, failed)
      if (anew) call write_bytes(scratch_path("changed.txt"), after)
      if (.not. anew) then
         open (newunit=unit, file=scratch_path("changed.txt"), access="stream", form="unformatted", status="old", action="write", &
               position="append")
         write (unit) after
         close (unit)
      end if
      if (.not. allocated(failed)) call read_rows(lines, huge(1_int64), table, failed)
      call close_source(lines%source)
      call remove_file(scratch_path("changed.txt"))
   end subroutine read_changed

   !> A file is read to the length that it had, and to the end of the line that this cuts.
   subroutine test_growing()
      integer, parameter :: lines = 300000
      type(table_type) :: table

      call read_changed(repeat("1.5"//nl, lines), "2.5"//nl//"3.5"//nl, .false., table, failed)
      if (went_wrong(failed)) return
      call check(error, count_rows(table%store), int(lines, int64))
      call read_changed(repeat("1.5"//nl, lines)//"2", ".5"//nl//"3.5"//nl, .false., table, failed)
      if (went_wrong(failed)) return
      call check(error, count_rows(table%store), int(lines + 1, int64))
      call check(error, abs(stored(table, int(lines + 1, int64), 1) - 2.5_dp) <= 0.0_dp)
   end subroutine test_growing

   !> A file that was cut is refused: what was cut cannot be known.
   subroutine test_shrinking()
      type(table_type) :: table

      call read_changed(repeat("1.5"//nl, 600000), repeat("1.5"//nl, 400000), .true., table, failed)
      call check_refused(failed, status%io)
      call check(error, index(failed%message, ": the file became shorter while it was read: 1600000 of 2400000 bytes") > 0)
   end subroutine test_shrinking

   !> Appends a chunk of three columns, k, -k and k + 0.5 in row k of the store; some rows stay free.
   subroutine fill_chunk(store, rows)
      type(store_type), intent(inout) :: store
      integer(int64), intent(in) :: rows
      integer(int64) :: before, i
      integer :: failed

      before = count_rows(store)
      call add_chunk(store, rows + 3, 3, failed)
      if (failed /= 0) return
      associate (chunk => store%chunk(store%count))
         do i = 1, rows
            chunk%value(i, :) = real(before + i, dp)*[1.0_dp, -1.0_dp, 1.0_dp] + [0.0_dp, 0.0_dp, 0.5_dp]
         end do
         chunk%rows = rows
      end associate
   end subroutine fill_chunk

   !> Chunks of several large pages, and smaller ones; a column that is wanted twice, and one that is the time, too.
   subroutine test_pages()
      type(store_type) :: store
      real(dp), allocatable :: value(:, :), stamps(:)
      integer(int64) :: i, n
      integer :: failed

      call fill_chunk(store, 700001_int64)
      call fill_chunk(store, 5_int64)
      call fill_chunk(store, 262144_int64)
      n = count_rows(store)
      call take_columns(store, 2, [3, 1, 2, 3], value, stamps, failed)
      call check(error, failed == 0 .and. count_rows(store) == 0 .and. n == 962150)
      if (unmet(all(shape(value, int64) == [n, 4_int64]) .and. size(stamps, kind=int64) == n)) return
      do i = 1, n
         if (all(abs(value(i, :) - real(i, dp)*[1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp] - [0.5_dp, 0.0_dp, 0.0_dp, 0.5_dp]) <= 0.0_dp) &
             .and. abs(stamps(i) + real(i, dp)) <= 0.0_dp) cycle
         call check(error, .false., "a row is not what it was")
         return
      end do
   end subroutine test_pages

   !> A chunk that is not full is copied, too.
   subroutine test_single()
      type(store_type) :: store
      real(dp), allocatable :: value(:, :), stamps(:)
      integer :: failed

      call fill_chunk(store, 4_int64)
      call take_columns(store, 0, [2], value, stamps, failed)
      if (unmet(failed == 0 .and. size(value) == 4 .and. size(stamps) == 0)) return
      call check(error, all(abs(value(:, 1) + [1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp]) <= 0.0_dp))
   end subroutine test_single

end module test_text_rows
