! SPDX-License-Identifier: MIT
!> Recordings in blocks: the samples, marks and audit must be those of the recording that is read as a whole.
module test_record_stream
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_reader, only : read_record
   use gyroakf_io_record_stream, only : begin_record_stream, end_record_stream, next_record_block, record_stream_type
   use gyroakf_io_record_summary, only : summarise_record
   use gyroakf_io_recording, only : base_bytes, bytes_needed, close_recording, hold_rows, open_recording, reader_options, &
      next_rows, recording_type
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline, run_streamed
   use gyroakf_record, only : record_type, sample_count
   use scratch_file, only : remove_file, scratch_path
   implicit none (type, external)
   private
   public :: collect_record_stream

   !> Rows: more than a chunk of 65536 and what is looked at again behind it
   integer, parameter :: rows = 75000

contains

   !> Names the tests.
   subroutine collect_record_stream(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("plain", test_plain), &
         new_unittest("missing", test_missing), &
         new_unittest("lost-samples", test_lost), &
         new_unittest("stamps", test_stamps), &
         new_unittest("beat", test_beat), &
         new_unittest("repeated-rows", test_repeats), &
         new_unittest("mixed", test_mixed), &
         new_unittest("increments", test_increments), &
         new_unittest("angles", test_angles), &
         new_unittest("part", test_part), &
         new_unittest("blank-column", test_blank), &
         new_unittest("rows-held-before", test_held), &
         new_unittest("rows-in-parts", test_parts), &
         new_unittest("memory", test_memory), &
         new_unittest("memory-advice", test_advice), &
         new_unittest("step-at-the-border", test_border), &
         new_unittest("summary", test_summary), &
         new_unittest("tiny-values", test_tiny), &
         new_unittest("one-row", test_one_row), &
         new_unittest("analysis", test_analysis), &
         new_unittest("analysis-refused", test_refused)]
   end subroutine collect_record_stream

   !> A made-up value, different in every row and column.
   pure real(dp) function made_up(i, column)
      integer, intent(in) :: i, column

      made_up = sin(real(i, dp)*real(i, dp)*0.37_dp + column) + column
   end function made_up

   !> Writes a file of made-up rows.
   subroutine write_rows(head, columns, first_column, count_rows)
      !> Lines above the rows, "" for none
      character(*), intent(in) :: head
      !> Columns of values
      integer, intent(in) :: columns
      !> "none"; "stamps": even; "lost", "beat": some left out; "odd": some equal or set back; "mixed": gaps, a burst, repeated
      !> rows, an equal stamp, a change of the rate; "gaps"; "blank"
      character(*), intent(in) :: first_column
      integer, intent(in) :: count_rows
      integer :: unit, i, j, copy
      real(dp) :: t, lost

      lost = 0.0_dp
      open (newunit=unit, file=scratch_path("stream.txt"), status="replace", action="write")
      if (head /= "") write (unit, "(a)") head
      do i = 1, count_rows
         t = 0.01_dp*i
         select case (first_column)
         case ("lost")
            if (any(modulo(i, 10007) == [5, 6]) .or. (i > 61300 .and. i < 61303)) cycle
            write (unit, "(f12.2, ',')", advance="no") t
         case ("beat")
            if (modulo(i, 30001) == 20000) cycle
            write (unit, "(f12.2, ',')", advance="no") t
         case ("odd")
            if (modulo(i, 30011) == 7) t = t - 0.01_dp
            if (modulo(i, 40013) == 9) t = t - 0.015_dp
            write (unit, "(f12.3, ',')", advance="no") t
         case ("mixed")
            if (modulo(i, 9973) == 500) lost = lost + 0.03_dp
            t = t - 0.002_dp*max(i - 63000, 0) + lost
            if (i >= 61430 .and. i < 61450) t = 614.5_dp + lost + 0.0001_dp*(i - 61450)
            if (i == 200) t = t - 0.01_dp
            if (modulo(i, 20011) == 77 .or. i == 61441 .or. i == 65536) then
               write (unit, "(f12.4, ',', *(f0.8, :, ','))") t, (made_up(i, j), j=1, columns)
            end if
            write (unit, "(f12.4, ',')", advance="no") t
         case ("stamps", "twice 1", "thrice1"); write (unit, "(f12.2, ',')", advance="no") t
         case ("gaps")
            if (modulo(i, 7919) == 3) then
               write (unit, "(a)") "nan,1"
               cycle
            end if
         case ("blank"); write (unit, "(',')", advance="no")
         case default
         end select
         write (unit, "(*(f0.8, :, ','))") (made_up(i, j), j=1, columns)
         do copy = 2, copies(first_column, i)
            write (unit, "(f12.2, *(',', f0.8))") t, (made_up(i, j), j=1, columns)
         end do
      end do
      close (unit)
   end subroutine write_rows

   !> How often a row is written: rows around the border of two windows several times, the border falling on each of the copies.
   pure integer function copies(kind, i)
      !> "twice ", "thrice", others once; the number behind it shifts the border
      character(*), intent(in) :: kind
      integer, intent(in) :: i
      integer :: j

      copies = 1
      if (len(kind) < 7) return
      if (.not. any(i == [(101*j, j=1, iachar(kind(7:7)) - 48)]) .and. (i < 61200 .or. i > 61700)) return
      if (kind(:6) == "twice ") copies = 2
      if (kind(:6) == "thrice") copies = 3
   end function copies

   !> Reads the file as a whole and in blocks, and fails unless both are alike; the file is removed.
   subroutine compare(error, options, whole, streamed, memory, alike)
      type(error_type), allocatable, intent(out) :: error
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: whole, streamed
      !> Rows are held up to this many bytes before
      integer(int64), intent(in), optional :: memory
      !> False: only read both; true: only compare the samples; absent: compare the summaries, too
      logical, intent(in), optional :: alike
      type(recording_type) :: recording
      type(record_stream_type) :: stream
      type(record_type) :: block
      type(gyro_error), allocatable :: failed
      type(reader_options) :: limited
      integer(int64) :: at, n

      limited = options
      call read_record(scratch_path("stream.txt"), options, whole, failed)
      if (.not. allocated(failed)) then
         if (present(memory)) limited%memory = memory
         call open_recording(scratch_path("stream.txt"), limited, recording, failed)
      end if
      if (present(memory) .and. .not. allocated(failed)) then
         recording%expected_rows = 0
         call hold_rows(recording, failed)
      end if
      if (.not. allocated(failed)) call begin_record_stream(recording, stream)
      at = 0
      do while (.not. allocated(failed))
         call next_record_block(recording, stream, block, failed)
         if (allocated(failed) .or. stream%done) exit
         if (present(alike)) then
            if (.not. alike) cycle
         end if
         n = size(block%value, 1, kind=int64)
         call check_block(error, block, whole, at)
         if (allocated(error)) return
         at = at + n
      end do
      if (.not. allocated(failed)) call end_record_stream(recording, stream, streamed, failed)
      call close_recording(recording)
      call remove_file(scratch_path("stream.txt"))
      if (allocated(failed)) then
         call check(error, .false., failed%message)
         return
      end if
      if (present(alike)) return
      call check(error, at, size(whole%value, 1, kind=int64), "number of samples")
      if (allocated(error)) return
      call check_summary(error, streamed, whole)
   end subroutine compare

   !> Fails unless the block is the part of the whole behind `at` samples.
   subroutine check_block(error, block, whole, at)
      type(error_type), allocatable, intent(out) :: error
      type(record_type), intent(in) :: block, whole
      integer(int64), intent(in) :: at
      integer(int64) :: n
      integer :: there, expected

      n = size(block%value, 1, kind=int64)
      call check(error, at + n <= size(whole%value, 1, kind=int64), "too many samples")
      if (allocated(error) .or. n == 0 .or. size(block%value, 2) /= size(whole%value, 2)) return
      there = int(n)*size(block%value, 2)
      expected = there
      if (allocated(block%present)) there = sum(int(block%present))
      if (allocated(whole%present)) expected = sum(int(whole%present(at + 1:at + n, :)))
      call check(error, there, expected, "samples that are present")
      if (allocated(error)) return
      call check(error, maxval(abs(block%value - whole%value(at + 1:at + n, :))) <= 1.0e-9_dp, "values")
   end subroutine check_block

   !> Fails unless rate, units, counts and warnings are alike.
   subroutine check_summary(error, streamed, whole)
      type(error_type), allocatable, intent(out) :: error
      type(record_type), intent(in) :: streamed, whole
      integer :: i

      call check(error, sample_count(streamed), sample_count(whole), "number of samples told")
      if (allocated(error)) return
      call check(error, abs(streamed%sample_interval/whole%sample_interval - 1) <= 1.0e-9_dp, "interval")
      if (allocated(error)) return
      call check(error, streamed%unit%name, whole%unit%name, "unit")
      if (allocated(error)) return
      call check(error, streamed%audit%missing, whole%audit%missing, "missing")
      if (allocated(error)) return
      call check(error, streamed%audit%gaps, whole%audit%gaps, "gaps")
      if (allocated(error)) return
      call check(error, streamed%audit%duplicates, whole%audit%duplicates, "duplicates")
      if (allocated(error)) return
      call check(error, streamed%audit%backward_steps, whole%audit%backward_steps, "backward steps")
      if (allocated(error)) return
      call check(error, all(streamed%audit%line_of_first == whole%audit%line_of_first), "lines")
      if (allocated(error)) return
      call check(error, all(abs(streamed%audit%minimum - whole%audit%minimum) <= 1.0e-9_dp) .and. &
         all(abs(streamed%audit%maximum - whole%audit%maximum) <= 1.0e-9_dp), "extremes")
      if (allocated(error)) return
      call check(error, all(abs(streamed%audit%quantisation - whole%audit%quantisation) <= &
                            1.0e-12_dp*whole%audit%quantisation), "smallest step")
      if (allocated(error)) return
      call check(error, size(streamed%channel), size(whole%channel), "channels")
      if (allocated(error)) return
      call check(error, allocated(streamed%warnings) .eqv. allocated(whole%warnings), "warnings")
      if (allocated(error) .or. .not. allocated(whole%warnings)) return
      do i = 1, min(size(whole%warnings), size(streamed%warnings))
         call check(error, streamed%warnings(i)%text, whole%warnings(i)%text)
         if (allocated(error)) return
      end do
   end subroutine check_summary

   subroutine test_plain(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("# rate_hz: 50"//new_line("a")//"# unit: deg/s", 2, "none", rows)
      call compare(error, reader_options(), whole, streamed)
   end subroutine test_plain

   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("gx,gy", 2, "gaps", rows)
      call compare(error, reader_options(rate_hz=10.0_dp), whole, streamed)
      if (allocated(error)) return
      call check(error, streamed%audit%missing > 5)
   end subroutine test_missing

   subroutine test_lost(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      ! rows that were not written, two of them at the edge of the first window
      call write_rows("time_s,gx", 1, "lost", rows)
      call compare(error, reader_options(), whole, streamed)
      if (allocated(error)) return
      call check(error, streamed%audit%gaps, 9_int64)
   end subroutine test_lost

   subroutine test_stamps(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("time_s,gx", 1, "odd", rows)
      call compare(error, reader_options(), whole, streamed)
      if (allocated(error)) return
      call check(error, streamed%audit%duplicates > 2 .and. streamed%audit%backward_steps > 1)
   end subroutine test_stamps

   subroutine test_beat(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      ! single rows left out at even distances, as a clock does that counts in the interval: not filled
      call write_rows("time_s,gx", 1, "beat", rows)
      call compare(error, reader_options(time_column="none"), whole, streamed)
      if (allocated(error)) return
      call write_rows("time_s,gx", 1, "beat", 2*rows)
      call compare(error, reader_options(), whole, streamed, alike=.false.)
      if (allocated(error)) return
      call check(error, streamed%audit%gaps, whole%audit%gaps)
   end subroutine test_beat

   !> Rows that repeat the one above are left out, wherever the border of two windows falls.
   subroutine test_repeats(error)
      type(error_type), allocatable, intent(out) :: error
      character(7), parameter :: kinds(2) = ["twice 1", "thrice1"]
      type(record_type) :: whole, streamed
      integer :: k

      do k = 1, size(kinds)
         call write_rows("time_s,gx,gy", 2, kinds(k), rows)
         call compare(error, reader_options(), whole, streamed)
         if (.not. allocated(error)) call check(error, sample_count(streamed), int(rows, int64), "samples, "//kinds(k))
         if (.not. allocated(error)) call check(error, streamed%audit%repeated, whole%audit%repeated, "repeated rows")
         if (.not. allocated(error)) call check(error, streamed%audit%line_of_repeat, whole%audit%line_of_repeat, "their line")
         if (.not. allocated(error)) call check(error, streamed%audit%duplicates, 0_int64, "equal stamps")
         if (.not. allocated(error)) call check(error, streamed%audit%stamp_rate, 100.0_dp, thr=1.0e-6_dp)
         if (allocated(error)) return
      end do
   end subroutine test_repeats

   !> Gaps, a burst, repeated rows and a change of the rate where windows meet are found as in memory, with their lines.
   subroutine test_mixed(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("time_s,gx", 1, "mixed", 2*rows)
      call compare(error, reader_options(), whole, streamed, alike=.true.)
      if (allocated(error)) return
      call check(error, streamed%audit%gaps, whole%audit%gaps)
      if (allocated(error)) return
      call check(error, all(whole%audit%line_of_first == streamed%audit%line_of_first))
      if (allocated(error)) return
      call check(error, whole%audit%repeated == 10 .and. streamed%audit%repeated == 10, "repeated rows")
      if (allocated(error)) return
      call check(error, whole%audit%line_of_repeat == 79 .and. streamed%audit%line_of_repeat == 79, "their first line")
      if (allocated(error)) return
      call check(error, whole%audit%bursts == 1 .and. streamed%audit%bursts == 1, "bursts")
      if (allocated(error)) return
      call check(error, streamed%audit%longest_burst, whole%audit%longest_burst)
      if (allocated(error)) return
      call check(error, streamed%audit%line_of_burst, whole%audit%line_of_burst)
      if (allocated(error)) return
      call check(error, whole%audit%rate_changes == 1 .and. streamed%audit%rate_changes == 1, "rates")
      if (allocated(error)) return
      call check(error, streamed%audit%line_of_change, whole%audit%line_of_change)
      if (allocated(error)) return
      call check(error, abs(streamed%audit%rate_first/whole%audit%rate_first - 1.0_dp) < 1.0e-5_dp, "first half")
      if (allocated(error)) return
      call check(error, abs(streamed%audit%rate_second/whole%audit%rate_second - 1.0_dp) < 1.0e-5_dp, "second half")
   end subroutine test_mixed

   subroutine test_increments(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("# unit: deg"//new_line("a")//"time_s,gx", 1, "stamps", rows)
      call compare(error, reader_options(input="increment", scale=2.0_dp), whole, streamed)
      if (allocated(error)) return
      call check(error, streamed%unit%name, "deg/s")
   end subroutine test_increments

   subroutine test_angles(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("gx,gy", 2, "gaps", rows)
      call compare(error, reader_options(input="angle", rate_hz=100.0_dp), whole, streamed)
   end subroutine test_angles

   subroutine test_part(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("gx,gy", 2, "gaps", rows)
      call compare(error, reader_options(rate_hz=100.0_dp, from=600.0_dp, to=733.0_dp), whole, streamed)
      if (allocated(error)) return
      call check(error, sample_count(streamed), 13300_int64)
   end subroutine test_part

   subroutine test_blank(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("gx,gy,gz", 2, "blank", rows)
      call compare(error, reader_options(rate_hz=100.0_dp), whole, streamed)
      if (allocated(error)) return
      call check(error, size(streamed%channel), 2)
   end subroutine test_blank

   subroutine test_held(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      ! some 40,000 rows are in memory before it is too full
      call write_rows("time_s,gx", 1, "lost", rows)
      call compare(error, reader_options(), whole, streamed, base_bytes + 40000*17)
   end subroutine test_held

   subroutine test_memory(error)
      type(error_type), allocatable, intent(out) :: error
      type(recording_type) :: recording
      type(reader_options) :: options
      type(record_type) :: record
      type(gyro_error), allocatable :: failed

      call write_rows("gx,gy", 2, "none", 5000)
      options%work_bytes = 12
      options%memory = base_bytes + 30*5001
      call read_record(scratch_path("stream.txt"), options, record, failed)
      call check(error, .not. allocated(failed), "refused although it fits")
      options%memory = base_bytes + 30*4900
      if (.not. allocated(error)) call read_record(scratch_path("stream.txt"), options, record, failed)
      if (.not. allocated(error)) call check(error, allocated(failed), "read although it does not fit")
      if (.not. allocated(error)) call check(error, failed%code, status%no_memory)
      if (.not. allocated(error)) call open_recording(scratch_path("stream.txt"), options, recording, failed)
      call close_recording(recording)
      call remove_file(scratch_path("stream.txt"))
      if (allocated(error)) return
      call check(error, abs(recording%expected_rows - 5000) < 10, "rows by the file's size")
      if (allocated(error)) return
      call check(error, bytes_needed(recording, 1000_int64), base_bytes + 30000)
   end subroutine test_memory

   subroutine test_advice(error)
      type(error_type), allocatable, intent(out) :: error
      type(reader_options) :: options
      type(record_type) :: record
      type(gyro_error), allocatable :: failed

      call write_rows("gx,gy", 2, "none", 5000)
      options%memory = base_bytes + 1000
      options%memory_found = .true.
      call read_record(scratch_path("stream.txt"), options, record, failed)
      call remove_file(scratch_path("stream.txt"))
      call check(error, allocated(failed), "read although it does not fit")
      if (allocated(error)) return
      call check(error, index(failed%message, "24 MB of memory can be had") > 0, failed%message)
      if (allocated(error)) return
      call check(error, index(failed%message, "insist with --memory SIZE; take one channel at a time with --column") > 0, &
                 failed%message)
   end subroutine test_advice

   subroutine test_border(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed
      integer :: unit, i

      ! the smallest step lies between two blocks
      open (newunit=unit, file=scratch_path("stream.txt"), status="replace", action="write")
      do i = 1, 70000
         write (unit, "(f0.2)") real(i, dp) - merge(0.75_dp, 0.0_dp, i == 65537)
      end do
      close (unit)
      call compare(error, reader_options(), whole, streamed)
      if (allocated(error)) return
      call check(error, abs(streamed%audit%quantisation(1) - 0.25_dp) <= 1.0e-9_dp)
   end subroutine test_border

   subroutine test_summary(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed
      type(reader_options) :: options
      type(gyro_error), allocatable :: failed

      ! where the samples fit they are there; where they do not, only what was found
      call write_rows("time_s,gx", 1, "lost", rows)
      call summarise_record(scratch_path("stream.txt"), options, whole, failed)
      options%memory = base_bytes + 1000
      if (.not. allocated(failed)) call summarise_record(scratch_path("stream.txt"), options, streamed, failed)
      call remove_file(scratch_path("stream.txt"))
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, size(whole%value, 1) > rows - 100 .and. .not. whole%streamed)
      if (allocated(error)) return
      call check(error, size(streamed%value, 1) == 0 .and. streamed%streamed)
      if (.not. allocated(error)) call check_summary(error, streamed, whole)
   end subroutine test_summary

   !> Values whose squares vanish are refused alike, whether the record fits or is streamed.
   subroutine test_tiny(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(reader_options) :: options
      type(gyro_error), allocatable :: failed
      integer :: unit, i, k

      open (newunit=unit, file=scratch_path("stream.txt"), status="replace", action="write")
      write (unit, "(i0, 'e-150')") (modulo(i*i, 7), i=1, rows)
      close (unit)
      do k = 1, 2
         if (k == 2) options%memory = base_bytes + 1000
         call summarise_record(scratch_path("stream.txt"), options, record, failed)
         call check(error, allocated(failed))
         if (allocated(error)) exit
         call check(error, failed%code, status%non_finite)
         if (.not. allocated(error)) call check(error, index(failed%message, "--scale") > 0, failed%message)
         if (allocated(error)) exit
      end do
      call remove_file(scratch_path("stream.txt"))
   end subroutine test_tiny

   subroutine test_one_row(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed

      call write_rows("t,gx", 1, "stamps", 1)
      call compare(error, reader_options(rate_hz=1.0_dp), whole, streamed)
   end subroutine test_one_row

   !> Rows are read until there are enough of them, and at the end `whole` tells.
   subroutine test_parts(error)
      type(error_type), allocatable, intent(out) :: error
      type(recording_type) :: recording
      type(gyro_error), allocatable :: failed

      call write_rows("# rate_hz: 10", 1, "none", rows)
      call open_recording(scratch_path("stream.txt"), reader_options(), recording, failed)
      if (.not. allocated(failed)) call next_rows(recording, 10_int64, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, recording%table%rows >= 10 .and. recording%table%rows < rows .and. .not. recording%table%whole)
      if (allocated(error)) return
      call next_rows(recording, huge(1_int64), failed)
      call check(error, .not. allocated(failed) .and. recording%table%whole)
      if (allocated(error)) return
      call check(error, recording%table%rows, int(rows, int64))
      call close_recording(recording)
      call remove_file(scratch_path("stream.txt"))
   end subroutine test_parts

   !> The analysis of the file in blocks.
   subroutine analyse_file(options, record, result, failed)
      type(pipeline_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(pipeline_result_type), intent(out) :: result
      type(gyro_error), allocatable, intent(out) :: failed
      type(recording_type) :: recording
      type(reader_options) :: reader

      reader%memory = base_bytes + 8000000
      call open_recording(scratch_path("stream.txt"), reader, recording, failed)
      if (.not. allocated(failed)) call run_streamed(recording, options, record, result, failed)
      call close_recording(recording)
   end subroutine analyse_file

   subroutine test_analysis(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: whole, streamed
      type(pipeline_options) :: options
      type(pipeline_result_type) :: a, b
      type(gyro_error), allocatable :: failed

      ! increments and their rate from the stamps; curve, coefficients and moments as of the whole record
      options%do_tests = .false.
      options%do_ar = .false.
      options%do_filter = .false.
      options%clean%method = "none"
      options%clean%degree = -1
      call write_rows("time_s,gx [deg/s]", 1, "lost", rows)
      call analyse_file(options, streamed, a, failed)
      if (.not. allocated(failed)) call read_record(scratch_path("stream.txt"), reader_options(), whole, failed)
      call remove_file(scratch_path("stream.txt"))
      if (.not. allocated(failed)) call run_pipeline(whole, options, b, failed)
      call check(error, .not. allocated(failed), "failed")
      if (allocated(error)) return
      associate (x => a%channel(1), y => b%channel(1))
         call check(error, abs(x%raw%mean - y%raw%mean) + abs(x%raw%std - y%raw%std) <= 1.0e-12_dp, "moments")
         if (allocated(error)) return
         call check(error, x%allan(1)%curve%streamed .and. .not. y%allan(1)%curve%streamed, "mode")
         if (allocated(error)) return
         call check(error, all(abs(x%allan(1)%curve%deviation(:6)/y%allan(1)%curve%deviation(:6) - 1) <= 1.0e-11_dp), "curve")
         if (allocated(error)) return
         call check(error, abs(x%allan(1)%noise%coefficient(2)%value/y%allan(1)%noise%coefficient(2)%value - 1) <= 0.01_dp, "N")
      end associate
   end subroutine test_analysis

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: streamed
      type(pipeline_options) :: options
      type(pipeline_result_type) :: a
      type(gyro_error), allocatable :: failed

      ! the main job cleans: that needs the whole record
      call write_rows("gx", 1, "none", 100)
      call analyse_file(options, streamed, a, failed)
      call remove_file(scratch_path("stream.txt"))
      call check(error, allocated(failed), "cleaned in blocks")
      if (allocated(error)) return
      call check(error, index(failed%message, "--detrend") > 0, failed%message)
   end subroutine test_refused

end module test_record_stream
