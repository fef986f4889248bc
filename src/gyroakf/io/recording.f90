! SPDX-License-Identifier: MIT
!> An open recording: what stands above its rows is known, these are read as memory allows.
module gyroakf_io_recording
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_io_binary, only : begin_npy, begin_raw, binary_type, read_binary_rows
   use gyroakf_io_decimal, only : format_real, real_length
   use gyroakf_io_element, only : element_name, element_type, element_word, parse_element
   use gyroakf_io_first_row, only : begin_table
   use gyroakf_io_format, only : content_type, recognize_content
   use gyroakf_io_lines, only : lines_type, open_lines
   use gyroakf_io_place, only : integer_text, line_error
   use gyroakf_io_reader_options, only : check_options, reader_options
   use gyroakf_io_source, only : close_source
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text_rows, only : read_rows
   use gyroakf_record, only : add_text
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: reader_options, recording_type, open_recording, next_rows, hold_rows, close_recording
   public :: bytes_needed, rows_within, bytes_text, say_too_large, base_bytes

   !> An open recording
   type :: recording_type
      character(:), allocatable :: path
      !> What it turned out to be, as in "text"
      character(:), allocatable :: format
      !> How its numbers are stored, as in "float32"; "" for text
      character(:), allocatable :: stored_type
      type(reader_options) :: options
      type(lines_type) :: lines
      !> Of binary numbers
      type(binary_type) :: binary
      type(table_type) :: table
      !> Rows that its size suggests, 0 where that is not known (standard input, a FIFO)
      integer(int64) :: expected_rows = 0
   end type recording_type

   !> The program itself, its libraries and buffers
   integer(int64), parameter :: base_bytes = 24000000

   !> From here on sizes are said in GB
   integer(int64), parameter :: gigabyte = 1000000000
   !> The record: 8 bytes a value, 1 for its mark where something is missing
   integer(int64), parameter :: value_bytes = 9, stamp_bytes = 8

contains

   !> Opens a recording and reads what stands above its rows.
   subroutine open_recording(path, options, recording, error)
      character(*), intent(in) :: path
      type(reader_options), intent(in) :: options
      !> To be closed by [[close_recording]], after a failure too
      type(recording_type), intent(out) :: recording
      !> Allocated on failure: io, parse, invalid_argument, not_supported, no_memory
      type(error_type), allocatable, intent(out) :: error
      type(content_type) :: content
      type(element_type) :: element
      logical :: raw, other

      call check_options(options, error)
      if (allocated(error)) return
      recording%path = path
      recording%format = "text"
      recording%stored_type = ""
      recording%options = options
      if (.not. allocated(options%input)) recording%options%input = "rate"
      if (.not. allocated(options%unit)) recording%options%unit = ""
      if (.not. allocated(options%resample)) recording%options%resample = "index"
      if (.not. allocated(options%format)) recording%options%format = "auto"
      call parse_element(recording%options%format, element, raw)
      if (raw) then
         call begin_numbers_only(path, element, recording, error)
         return
      end if
      call open_lines(recording%lines, path, error, recording%options%bytes)
      if (allocated(error)) return
      call find_content(recording%lines, recording%options%format, content, error)
      if (.not. allocated(error)) call check_use(content%kind, recording, error)
      if (allocated(error)) return
      select case (content%kind)
      case ("npy")
         call begin_npy(recording%lines, recording%options, recording%binary, recording%table, &
            error)
         recording%format = "npy"
         recording%stored_type = trim(element_name(recording%binary%element))
         recording%expected_rows = max(0_int64, recording%binary%rows)
      case ("binary")
         call close_source(recording%lines%source)
         call begin_numbers_only(path, content%element, recording, error)
         if (.not. allocated(error)) call add_text(recording%table%warnings, "read as "// &
            trim(element_word(content%element))//", "//integer_text(recording%binary%columns)// &
            " column"//trim(merge("s", " ", recording%binary%columns > 1))//", as the name ."// &
            content%ending//" says; `format` and `channels` say it")
      case default
         call begin_table(recording%lines, recording%options, recording%table, error)
         if (allocated(error)) return
         associate (lines => recording%lines)
            if (lines%source%length > 0 .and. lines%last >= lines%at) recording%expected_rows = &
               int(real(lines%source%length, dp) &
                   *real(count(lines%bytes(lines%at:lines%last) == 10, kind=int64), dp) &
                   /real(lines%last - lines%at + 1, dp), int64)
         end associate
         call parse_element(content%ending, element, other)
         other = other .or. &
            any(content%ending == [character(4) :: "npy", "npz", "h5", "hdf5", "hdf", "mat", "bin"])
         if (other) call add_text(recording%table%warnings, &
            "the name ends in ."//content%ending//", but the content is text and is read as such")
      end select
   end subroutine open_recording

   subroutine begin_numbers_only(path, element, recording, error)
      character(*), intent(in) :: path
      type(element_type), intent(in) :: element
      type(recording_type), intent(inout) :: recording
      type(error_type), allocatable, intent(out) :: error

      call check_use("binary", recording, error)
      if (allocated(error)) return
      call begin_raw(recording%lines%source, path, recording%options, max(1_int64, &
         recording%options%channels), element, recording%binary, recording%table, error)
      recording%format = trim(element_word(element))
      recording%stored_type = trim(element_name(element))
      recording%expected_rows = max(0_int64, recording%binary%rows)
   end subroutine begin_numbers_only

   !> What the file is, if that is what was asked for.
   subroutine find_content(lines, asked, content, error)
      type(lines_type), intent(in) :: lines
      character(*), intent(in) :: asked
      type(content_type), intent(out) :: content
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what
      integer :: ending

      associate (name => lines%source%name)
         if (lines%filled == 0) call line_error(error, name, 1_int64, "the file is empty", &
            "check what should have written it")
         if (allocated(error)) return
         ending = index(lower(name)//" ", ".gz ") - 1
         call recognize_content(lines%bytes(:lines%filled), &
            name(:merge(ending, len(name), ending > 0)), content)
         if (content%kind == "foreign") then
            if (associated(lines%source%inflater)) content%advice = &
               "decompress it first (gzip -dk), then: "//content%advice
            call line_error(error, name, 1 + count(lines%bytes(:content%at) == 10, kind=int64), &
               "the content is not text but "//content%what, content%advice)
            return
         end if
         if (asked == "auto" .or. asked == content%kind .or. &
            (asked == "csv" .and. content%kind == "text")) return
         what = "text"
         if (content%kind == "npy") what = "a NumPy file"
         if (content%kind == "binary") what = "binary"
         call line_error(error, name, 1_int64, "the content is not "//asked//" but "//what, &
            "leave `format` out")
      end associate
   end subroutine find_content

   !> An option that does not apply is not passed over.
   subroutine check_use(kind, recording, error)
      character(*), intent(in) :: kind
      type(recording_type), intent(in) :: recording
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what

      if (kind == "npy" .and. recording%options%skip > 0) what = &
         "`skip` is for text (lines) and raw numbers (bytes)"
      if (kind /= "text" .and. allocated(recording%options%where)) what = "`where` is for text"
      if (kind /= "binary" .and. recording%options%channels > 0) what = &
         "`channels` is for raw numbers"
      if (allocated(what)) call fatal_error(error, status%invalid_argument, recording%path//": "// &
         what//", and this is "//trim(kind))
   end subroutine check_use

   !> Reads all rows that are asked for, or as many as the memory allows: `table%whole`. None where
   !> the file's size alone exceeds the memory. Without time stamps and with a known rate the rows
   !> beyond `options%to` are not read.
   subroutine hold_rows(recording, error, progress)
      type(recording_type), intent(inout) :: recording
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: most, wanted
      real(dp) :: rate

      rate = recording%options%rate_hz
      if (.not. rate > 0.0_dp) rate = recording%table%header%rate_hz
      wanted = huge(wanted)
      if (recording%table%time == 0 .and. rate > 0.0_dp) then
         if (recording%options%to < 1.0e15_dp/rate) then               ! angles are differenced
            wanted = ceiling(recording%options%to*rate, int64) + 2
         end if
      end if
      if (recording%expected_rows > wanted) recording%expected_rows = wanted
      most = huge(most) - 1
      if (recording%options%memory > 0) most = rows_within(recording, recording%options)
      if (recording%expected_rows > most) return
      call next_rows(recording, min(most + 1, wanted), error, progress)
      if (recording%table%rows >= wanted .and. wanted <= most) recording%table%whole = .true.
   end subroutine hold_rows

   !> Rows that fit into `options%memory`.
   pure integer(int64) function rows_within(recording, options, channels) result(rows)
      type(recording_type), intent(in) :: recording
      !> Memory, and bytes per sample
      type(reader_options), intent(in) :: options
      !> Number of channels, all that are chosen if absent
      integer, intent(in), optional :: channels

      rows = max(0_int64, options%memory - base_bytes) &
             /(bytes_needed(recording, 1_int64, options, channels) - base_bytes)
   end function rows_within

   !> Reads rows into `table%store` until it has enough or there are no more (`table%whole`).
   !>
   !> The one place that reads rows, whatever the format.
   subroutine next_rows(recording, most, error, progress)
      !> Open; its store grows
      type(recording_type), intent(inout) :: recording
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      if (recording%format == "text") then
         call read_rows(recording%lines, most, recording%table, error, progress)
      else
         call read_binary_rows(recording%binary, recording%lines%source, most, recording%table, &
            error, progress)
      end if
   end subroutine next_rows

   !> Closes the file; the rows stay.
   subroutine close_recording(recording)
      type(recording_type), intent(inout) :: recording

      call close_source(recording%lines%source)
   end subroutine close_recording

   !> Bytes that the process needs to hold so many rows and work on them.
   pure integer(int64) function bytes_needed(recording, rows, options, channels) result(bytes)
      type(recording_type), intent(in) :: recording
      integer(int64), intent(in) :: rows
      !> Bytes per sample of the job
      type(reader_options), intent(in) :: options
      !> Number of channels, all that are chosen if absent
      integer, intent(in), optional :: channels
      integer(int64) :: row_bytes, fixed, columns

      associate (table => recording%table)
         columns = size(table%chosen) - merge(1, 0, table%with_first)
         if (present(channels)) columns = channels
         row_bytes = columns*(value_bytes + options%channel_bytes) + max(options%work_bytes, &
            merge(stamp_bytes, 0_int64, table%time > 0 .or. table%with_first))
      end associate
      fixed = base_bytes + min(rows, options%part_samples)*options%part_bytes
      bytes = huge(bytes)
      if (rows < (huge(bytes) - fixed)/row_bytes) bytes = fixed + rows*row_bytes
   end function bytes_needed

   !> "FILE: about 12000000 rows need 276 MB (276000000 bytes), 100 MB of memory are allowed".
   subroutine say_too_large(recording, text)
      type(recording_type), intent(in) :: recording
      character(:), allocatable, intent(out) :: text
      integer(int64) :: rows, bytes

      rows = max(recording%expected_rows, recording%table%rows)
      if (rows > recording%table%rows) then
         text = "about "//integer_text(rows)//" rows need "
      else
         text = "more than "//integer_text(rows)//" rows need more than "
      end if
      bytes = bytes_needed(recording, rows, recording%options)
      text = recording%table%name//": "//text//bytes_text(bytes)//" ("//integer_text(bytes)// &
         " bytes), "//bytes_text(recording%options%memory)//" of memory are "// &
         trim(merge("free   ", "allowed", recording%options%memory_found))
   end subroutine say_too_large

   pure real(dp) function in_unit(bytes)
      integer(int64), intent(in) :: bytes

      in_unit = real(bytes, dp)*merge(1.0e-9_dp, 1.0e-6_dp, bytes >= gigabyte)
   end function in_unit

   !> "276 MB".
   pure function bytes_text(bytes) result(text)
      integer(int64), intent(in) :: bytes
      character(real_length(in_unit(bytes), 3) + 3) :: text

      text = format_real(in_unit(bytes), 3)//merge(" GB", " MB", bytes >= gigabyte)
   end function bytes_text

end module gyroakf_io_recording
