! SPDX-License-Identifier: MIT
!> Opens what holds no text: where its numbers are, how many, and which of them are wanted.
module gyroakf_io_opening
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_binary, only : binary_type, refuse_rest, skip_bytes
   use gyroakf_io_element, only : element_name, element_type
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_npy, only : npy_header_type, read_npy_header, spell_shape
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_source, only : open_source, source_type
   use gyroakf_io_table, only : begin_numbers, table_type
   use gyroakf_record, only : add_text
   implicit none (type, external)
   private
   public :: begin_raw, begin_npy

contains

   !> Opens a file of nothing but numbers.
   subroutine begin_raw(source, path, options, channels, element, binary, table, error)
      !> To be closed by [[close_source]], after a failure too
      type(source_type), intent(out) :: source
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      !> What is wanted; `skip` counts bytes
      type(reader_options), intent(in) :: options
      integer(int64), intent(in) :: channels
      type(element_type), intent(in) :: element
      type(binary_type), intent(out) :: binary
      !> All but the rows
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
      if (source%length > 0 .and. .not. associated(source%bytes)) binary%descriptor = &
         source%descriptor
      if (binary%descriptor < 0) call skip_bytes(binary, source, options%skip, error)
   end subroutine begin_raw

   !> Opens an array of NumPy.
   subroutine begin_npy(lines, options, binary, table, error)
      !> Open, its first block read
      type(lines_type), intent(in) :: lines
      type(reader_options), intent(in) :: options
      type(binary_type), intent(out) :: binary
      !> All but the rows
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
      if (lines%source%length > 0 .and. .not. associated(lines%source%bytes)) binary%descriptor = &
         lines%source%descriptor
      if (binary%descriptor >= 0) return
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

end module gyroakf_io_opening
