! SPDX-License-Identifier: MIT
!> Where binary numbers are in a file, and blocks of their rows, read and converted.
module gyroakf_io_binary_block
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_loc, c_ptr
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_element, only : convert_elements, drop_infinite, element_name, element_type, &
      field_type, is_native, swap_elements
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_source, only : has_places, read_block, read_piece, source_type
   use gyroakf_io_table, only : table_type
   implicit none (type, external)
   private
   public :: binary_type, fill_rows, place_of, refuse_rest, take_bytes, skip_bytes

   !> Where the numbers of a file are
   type :: binary_type
      !> How a number is stored
      type(element_type) :: element
      !> Of elements that are rows of fields: where the numbers are; else unallocated: [column]
      type(field_type), allocatable :: field(:)
      !> Elements of every row
      integer(int64) :: columns = 1
      !> Rows, -1: up to the end of the pipe
      integer(int64) :: rows = -1
      !> Several columns, column after column instead of row after row
      logical :: by_columns = .false.
      !> The first byte of the numbers, from 0
      integer(int64) :: first = 0
      !> Rows that were read
      integer(int64) :: row = 0
      !> Bytes of a source that were read ahead, and the last of them that was used
      integer(int8), allocatable :: head(:)
      integer(int64) :: used = 0
      !> Integers that lost digits
      integer(int64) :: rounded = 0
   end type binary_type

   !> Bytes that are converted at once: they stay in the cache
   integer(int64), parameter :: block_bytes = 262144
   !> Bytes for which it pays to wake other threads
   integer(int64), parameter :: worth_threads = 4194304

contains

   !> Bytes that are behind it.
   pure integer(int64) function place_of(binary)
      type(binary_type), intent(in) :: binary

      place_of = binary%first + binary%row*binary%columns*binary%element%bytes
   end function place_of

   !> Reads rows behind others: by position several blocks at a time, else one after the other.
   subroutine fill_rows(binary, source, table, value, before, rows, got, error)
      !> Its place stays; integers that lose digits are counted
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      type(table_type), intent(in) :: table
      !> [row, stored column]
      real(dp), intent(inout), contiguous :: value(:, :)
      !> Rows that are there, and how many are wanted
      integer(int64), intent(in) :: before, rows
      !> Rows; fewer only where the file ends
      integer(int64), intent(out) :: got
      !> io, parse
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: column(:)                            ! that each stored column holds
      logical :: in_order
      integer(int64) :: block_rows, blocks, k, from, to, rounded, missing, short
      integer :: tasks, piece, j, code, worst

      allocate (column(table%layout%stored))
      do j = 1, size(column)
         column(j) = findloc(table%layout%slot, j, dim=1)
      end do
      in_order = .not. has_places(source)
      tasks = 1
      if (binary%by_columns) tasks = merge(int(binary%columns), size(column), in_order)
      block_rows = block_bytes/binary%element%bytes
      if (.not. binary%by_columns) block_rows = block_rows/binary%columns
      if (is_native(binary%element) .and. (binary%by_columns .or. &
         binary%columns == 1)) block_rows = 4*block_rows
      block_rows = max(1_int64, block_rows)
      blocks = (rows + block_rows - 1)/block_rows
      missing = 0
      rounded = 0
      worst = status%ok
      !$omp parallel do schedule(dynamic) private(from, to, piece, short, code) &
      !$omp& reduction(+:rounded) reduction(max:missing, worst) &
      !$omp& if (.not. in_order .and. rows*size(column)*8 > worth_threads)
      do k = 0, blocks*tasks - 1
         if (in_order .and. (missing > 0 .or. allocated(error))) cycle
         from = before + 1 + modulo(k, blocks)*block_rows
         to = min(before + rows, from + block_rows - 1)
         piece = merge(1 + int(k/blocks), 0, binary%by_columns)
         if (in_order .and. binary%by_columns) piece = merge(table%layout%slot(piece), -1, &
            table%layout%slot(piece) > 0)
         call read_part(binary, source, column, piece, before, from, to, value, rounded, short, &
            code, error)
         worst = max(worst, code)
         if (short > 0) missing = max(missing, before + rows - (to - short))
      end do
      !$omp end parallel do
      binary%rounded = binary%rounded + rounded
      got = rows - missing
      if (worst == status%io) call fatal_error(error, status%io, table%name// &
         ": the system refused to read row "//integer_text(binary%row + got + 1)//new_line("a")// &
         "check the disk, or copy the file")
      if (worst == status%no_memory) call fatal_error(error, status%no_memory, &
         "no memory for a block of "//table%name)
   end subroutine fill_rows

   !> Reads some rows, or those of one column where there is a piece; leaves them out where it is
   !> below 0. Numbers of a file that need no conversion go straight into their place.
   subroutine read_part(binary, source, column, piece, before, from, to, value, rounded, short, &
      code, error)
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      integer, intent(in) :: column(:), piece
      integer(int64), intent(in) :: before, from, to
      real(dp), intent(inout), contiguous, target :: value(:, :)
      integer(int64), intent(inout) :: rounded
      integer(int64), intent(out) :: short
      !> ok, io where the system refuses, no_memory
      integer, intent(out) :: code
      type(error_type), allocatable, intent(inout) :: error
      integer(int64), allocatable, target :: buffer(:)
      integer(int8), pointer, contiguous :: bytes(:)
      integer(int64) :: row_bytes, offset, got, n
      integer :: stat
      logical :: direct, failed

      n = to - from + 1
      short = n
      row_bytes = binary%element%bytes
      offset = binary%first
      if (piece > 0) offset = offset + (column(piece) - 1)*max(binary%rows, 0_int64)*row_bytes
      if (piece == 0) row_bytes = row_bytes*binary%columns
      offset = offset + (binary%row + from - before - 1)*row_bytes
      direct = has_places(source) .and. is_native(binary%element) .and. row_bytes == 8
      if (direct) then
         call c_f_pointer(c_loc(value(from, max(piece, 1))), bytes, [n*row_bytes])
      else
         allocate (buffer((n*row_bytes + 7)/8), stat=stat)
         code = merge(status%no_memory, status%ok, stat /= 0)
         if (stat /= 0) return
         call c_f_pointer(c_loc(buffer), bytes, [n*row_bytes])
      end if
      failed = .false.
      if (has_places(source)) then
         call read_piece(source, offset, bytes, got, failed)
      else
         call take_bytes(binary, source, bytes, got, error)
         if (mod(got, row_bytes) /= 0 .and. .not. allocated(error)) call refuse_rest(binary, &
            source%name, binary%row + from - before - 1 + got/row_bytes, modulo(got, row_bytes), &
            error)
      end if
      code = merge(status%io, status%ok, failed)
      got = got/row_bytes
      short = n - got
      if (direct) then
         call drop_infinite(value(from:from + got - 1, max(piece, 1)))
      else if (piece >= 0) then
         call spread_rows(binary, c_loc(buffer), column, piece, from, from + got - 1, value, &
            rounded)
      end if
   end subroutine read_part

   subroutine spread_rows(binary, address, column, piece, from, to, value, rounded)
      type(binary_type), intent(in) :: binary
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: column(:), piece
      integer(int64), intent(in) :: from, to
      real(dp), intent(inout), contiguous :: value(:, :)
      integer(int64), intent(inout) :: rounded
      integer(int64) :: width
      integer :: j

      if (allocated(binary%field)) then
         do j = 1, size(column)
            call take_field(address, binary%element%bytes, binary%field(column(j)), &
               value(from:to, j), rounded)
         end do
         return
      end if
      width = merge(1_int64, binary%columns, piece > 0)
      call swap_elements(address, (to - from + 1)*width, binary%element)
      do j = max(piece, 1), merge(piece, size(column), piece > 0)
         call convert_elements(address, binary%element, merge(1_int64, int(column(j), int64), &
            piece > 0), width, value(from:to, j), rounded)
      end do
   end subroutine spread_rows

   !> Converts one field of each row of so many bytes.
   subroutine take_field(address, row_bytes, field, value, rounded)
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: row_bytes
      type(field_type), intent(in) :: field
      real(dp), intent(inout), contiguous :: value(:)
      integer(int64), intent(inout) :: rounded
      integer(int64), target :: packed(1024)
      integer(int8), pointer, contiguous :: row(:, :), number(:, :)
      integer(int64) :: i, n, before

      call c_f_pointer(address, row, [int(row_bytes, int64), size(value, kind=int64)])
      call c_f_pointer(c_loc(packed), number, [int(field%bytes, int64), size(packed, kind=int64)])
      do before = 0, size(value, kind=int64) - 1, size(packed, kind=int64)
         n = min(size(packed, kind=int64), size(value, kind=int64) - before)
         do i = 1, n
            number(:, i) = row(field%offset + 1:field%offset + field%bytes, before + i)
         end do
         call swap_elements(c_loc(packed), n, field%element_type)
         call convert_elements(c_loc(packed), field%element_type, 1_int64, 1_int64, &
            value(before + 1:before + n), rounded)
      end do
   end subroutine take_field

   !> The error for numbers that end within a row.
   subroutine refuse_rest(binary, name, rows, rest, error)
      type(binary_type), intent(in) :: binary
      character(*), intent(in) :: name
      integer(int64), intent(in) :: rows, rest
      !> Allocated: parse
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: row_bytes

      row_bytes = binary%columns*binary%element%bytes
      call fatal_error(error, status%parse, name//": byte "// &
         integer_text(binary%first + rows*row_bytes)//": "//integer_text(rest)// &
         " bytes are left after "//integer_text(rows)//" rows of "//integer_text(row_bytes)// &
         " bytes ("//integer_text(binary%columns)//" x "//trim(element_name(binary%element))// &
         ")"//new_line("a")//"check type, `channels` and `skip`, or whether the file was cut off")
   end subroutine refuse_rest

   !> The next bytes of a source, those read ahead first.
   subroutine take_bytes(binary, source, buffer, got, error)
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      integer(int8), intent(inout), contiguous :: buffer(:)
      !> Bytes; fewer only where the source ends
      integer(int64), intent(out) :: got
      !> Allocated where reading fails: io
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: more

      got = 0
      if (allocated(binary%head)) then
         got = min(size(buffer, kind=int64), size(binary%head, kind=int64) - binary%used)
         buffer(:got) = binary%head(binary%used + 1:binary%used + got)
         binary%used = binary%used + got
      end if
      if (got == size(buffer, kind=int64)) return
      call read_block(source, buffer(got + 1:), more, error)
      if (.not. allocated(error)) got = got + more
   end subroutine take_bytes

   !> Leaves out bytes of a source.
   subroutine skip_bytes(binary, source, count, error)
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      !> How many; fewer where the source ends
      integer(int64), intent(in) :: count
      !> Allocated where reading fails: io
      type(error_type), allocatable, intent(out) :: error
      integer(int8) :: buffer(4096)
      integer(int64) :: left, got

      left = count
      do while (left > 0)
         call take_bytes(binary, source, buffer(:min(left, 4096_int64)), got, error)
         if (allocated(error) .or. got == 0) return
         left = left - got
      end do
   end subroutine skip_bytes

end module gyroakf_io_binary_block
