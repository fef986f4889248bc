! SPDX-License-Identifier: MIT
!> Files of binary numbers: where these are, how many, and their rows, interleaved (all columns of a
!> row together) or column after column.
!>
!> A regular file is read by position, in blocks that several threads take and convert; doubles of
!> one column go straight into their place. What comes through a pipe is read in order.
module gyroakf_io_binary
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_binary_block, only : binary_type, fill_rows, place_of, refuse_rest, skip_bytes, &
      take_bytes
   use gyroakf_io_element, only : element_name, element_type
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_npy, only : npy_header_type, read_npy_header, spell_shape
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_source, only : has_places, open_source, source_type
   use gyroakf_io_store, only : add_chunk, chunk_rows, count_rows
   use gyroakf_io_table, only : begin_numbers, table_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : add_text
   implicit none (type, external)
   private
   public :: binary_type, begin_raw, begin_npy, read_binary_rows

   !> Rows of a chunk that is copied later, so as not to hold all twice; values where from a pipe
   integer(int64), parameter :: part_rows = 1048576
   !> Values between two reports of progress
   integer(int64), parameter :: slice_values = 8388608

contains

   !> Opens a file of nothing but numbers.
   subroutine begin_raw(source, path, options, channels, element, binary, table, error)
      !> To be closed by [[close_source]], after a failure too
      type(source_type), intent(out) :: source
      character(*), intent(in) :: path
      !> What is wanted; `skip` counts bytes
      type(reader_options), intent(in) :: options
      integer(int64), intent(in) :: channels
      type(element_type), intent(in) :: element
      type(binary_type), intent(out) :: binary
      type(table_type), intent(out) :: table
      !> Allocated on failure: io, parse, invalid_argument
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: row_bytes, rest

      call open_source(source, path, error, options%bytes)
      if (allocated(error)) return
      binary%element = element
      binary%columns = channels
      binary%first = options%skip
      call begin_numbers(source%name, channels, options, table, error)
      if (allocated(error)) return
      row_bytes = channels*element%bytes
      if (scan(element%kind, "iu") > 0) table%integer_bits = 8*element%bytes
      if (source%length > 0) then
         rest = source%length - options%skip
         if (rest <= 0) call fatal_error(error, status%parse, source%name// &
            ": `skip` leaves nothing: the file has "//integer_text(source%length)//" bytes")
         if (allocated(error)) return
         binary%rows = rest/row_bytes
         rest = rest - binary%rows*row_bytes
         if (rest > 0) call refuse_rest(binary, source%name, binary%rows, rest, error)
         if (allocated(error)) return
      end if
      if (.not. has_places(source)) call skip_bytes(binary, source, options%skip, error)
   end subroutine begin_raw

   !> Opens an array of NumPy.
   subroutine begin_npy(lines, options, binary, table, error)
      type(lines_type), intent(in) :: lines
      type(reader_options), intent(in) :: options
      type(binary_type), intent(out) :: binary
      type(table_type), intent(out) :: table
      !> Allocated on failure: io, parse, invalid_argument, not_supported
      type(error_type), allocatable, intent(out) :: error
      type(npy_header_type) :: header
      character(:), allocatable :: shape
      integer(int64) :: count
      logical :: turned

      count = min(lines%filled, lines%source%delivered)
      call read_npy_header(lines%bytes(:count), lines%source%name, header, error)
      if (allocated(error)) return
      binary%element = header%element
      binary%by_columns = header%by_columns
      binary%first = header%first
      binary%rows = header%shape(1)
      binary%columns = header%shape(2)
      turned = binary%rows >= 1 .and. binary%rows < binary%columns  ! the longer side is the time
      if (turned) then
         binary%rows = header%shape(2)
         binary%columns = header%shape(1)
         binary%by_columns = .not. binary%by_columns
      end if
      turned = turned .and. binary%columns > 1
      binary%by_columns = binary%by_columns .and. binary%columns > 1
      call spell_shape(header%shape(1), merge(header%shape(2), 0_int64, header%rank > 1), shape)
      call check_size(lines%source, header, shape, error)
      if (allocated(error)) return
      if (allocated(header%field)) then
         call move_alloc(header%field, binary%field)
         call begin_numbers(lines%source%name, size(binary%field, kind=int64), options, table, &
            error, header%names)
      else
         call begin_numbers(lines%source%name, binary%columns, options, table, error)
      end if
      if (allocated(error)) return
      if (scan(header%element%kind, "iu") > 0) table%integer_bits = 8*header%element%bytes
      if (turned) call add_text(table%warnings, "the array's shape is "//shape// &
         ": the longer side is taken for the time, its "//integer_text(binary%columns)// &
         " rows for the channels; save array.T to have it beyond doubt")
      if (has_places(lines%source)) return
      if (lines%bytes(header%first) /= 10_int8) call fatal_error(error, status%parse, table%name// &
         ": byte "//integer_text(header%first - 1)//": the header does not end with a line feed"// &
         new_line("a")//"save it again with numpy.save")
      if (allocated(error)) return
      binary%head = lines%bytes(header%first + 1:count)
   end subroutine begin_npy

   subroutine check_size(source, header, shape, error)
      type(source_type), intent(in) :: source
      type(npy_header_type), intent(in) :: header
      character(*), intent(in) :: shape
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: bytes
      character(:), allocatable :: promise

      if (any(header%shape < 1)) call fatal_error(error, status%too_few_samples, source%name// &
         ": the array is empty, shape "//shape)
      if (allocated(error)) return
      promise = "the header's shape "//shape//" of "//trim(element_name(header%element))
      if (header%shape(1) > &
          (huge(1_int64) - header%first)/header%shape(2)/header%element%bytes) then
         call fatal_error(error, status%parse, source%name//": "//promise// &
            " is larger than any file"//new_line("a")//"save it again with numpy.save")
         return
      end if
      if (source%length <= 0) return
      bytes = header%first + header%shape(1)*header%shape(2)*header%element%bytes
      if (source%length < bytes) then
         call fatal_error(error, status%parse, source%name//": byte "// &
            integer_text(source%length)//": the file ends here, "//promise//" needs "// &
            integer_text(bytes - source%length)//" bytes more"//new_line("a")// &
            "it was cut off: copy it again")
      else if (source%length > bytes) then
         call fatal_error(error, status%parse, source%name//": byte "//integer_text(bytes)//": "// &
            promise//" ends here, and "//integer_text(source%length - bytes)//" bytes follow"// &
            new_line("a")//"give a file that holds one array")
      end if
   end subroutine check_size

   !> Reads rows into the store until it has as many as wanted, or a few more, or there are no more.
   subroutine read_binary_rows(binary, source, most, table, error, progress)
      !> Its place in the file moves on
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: rows, held
      integer :: failed

      do while (.not. table%whole .and. .not. allocated(error))
         held = count_rows(table%store)
         if (held >= most) return
         rows = max(chunk_rows, most - held)
         if (has_places(source) .and. table%layout%stored > size(table%chosen)) then
            rows = min(rows, part_rows)
         else if (.not. (has_places(source) .or. binary%by_columns)) then
            rows = max(1_int64, min(chunk_rows, part_rows/table%layout%stored))
         end if
         if (binary%rows >= 0) rows = min(rows, binary%rows - binary%row)
         if (binary%by_columns .and. .not. has_places(source) .and. rows < binary%rows) then
            call fatal_error(error, status%no_memory, table%name//": columns that "// &
               "come one after the other, compressed or through a pipe, have to be held as a "// &
               "whole"//new_line("a")//"give the uncompressed file by its name")
            return
         end if
         call add_chunk(table%store, rows, table%layout%stored, failed)
         if (failed /= 0) call fatal_error(error, status%no_memory, table%name// &
            ": no memory for "//integer_text(rows)//" rows")
         if (.not. allocated(error)) call fill_chunk(binary, source, table, error, progress)
      end do
   end subroutine read_binary_rows

   !> Fills the last chunk; behind the last row bytes that follow in a pipe are an error.
   subroutine fill_chunk(binary, source, table, error, progress)
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int8) :: more(1)
      integer(int64) :: got, rows, slice

      associate (chunk => table%store%chunk(table%store%count))
         rows = size(chunk%value, 1, kind=int64)
         slice = rows
         if (present(progress)) slice = max(chunk_rows, slice_values/size(chunk%value, 2))
         if (.not. has_places(source)) slice = rows
         do while (chunk%rows < rows)
            call report_progress("reading", place_of(binary), source%length, error, progress)
            if (allocated(error)) return
            slice = min(slice, rows - chunk%rows)
            call fill_rows(binary, source, table, chunk%value, chunk%rows, slice, got, error)
            if (allocated(error)) return
            chunk%rows = chunk%rows + got
            binary%row = binary%row + got
            table%rows = table%rows + got
            table%whole = got < slice
            if (table%whole) exit
         end do
      end associate
      if (binary%rows >= 0) then
         if (table%whole) call fatal_error(error, status%parse, table%name// &
            ": the file ends after "//integer_text(binary%row)//" of "// &
            integer_text(binary%rows)//" rows"//new_line("a")// &
            "it was cut off, or it changed while it was read")
         table%whole = binary%row == binary%rows
      end if
      if (.not. table%whole .or. allocated(error)) return
      if (table%rows == 0) call fatal_error(error, status%parse, table%name// &
         ": the file is empty"//new_line("a")//"check what should have written it")
      if (allocated(error)) return
      if (binary%rounded > 0) call add_text(table%warnings, integer_text(binary%rounded)// &
         " of the "//trim(element_name(binary%element))// &
         " values are beyond 2^53 and were rounded to 16 digits")
      if (has_places(source) .or. binary%rows < 0) return
      call take_bytes(binary, source, more, got, error)
      if (allocated(error) .or. got == 0) return
      call fatal_error(error, status%parse, table%name//": byte "// &
         integer_text(place_of(binary))//": bytes follow the array of "// &
         integer_text(binary%rows)//" rows that the header promises"//new_line("a")// &
         "give a file that holds one array")
   end subroutine fill_chunk

end module gyroakf_io_binary
