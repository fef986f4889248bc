! SPDX-License-Identifier: MIT
!> Columns of numbers, as text or binary, at the speed of memory rather than formatted output.
!>
!>     type(column_type) :: columns(2)
!>     columns(1) = column_type(step=0.01_dp, digits=15)              ! time: 0, 0.01, ...
!>     columns(2)%value => x
!>     call put_rows(writer, columns, n, layout, error)
!>
!> Pieces of a few thousand rows are turned into text by several threads and written in order, so
!> that the file does not depend on their number. A record is written as a file that the readers
!> understand: text with header keys, .npy, bare numbers.
module gyroakf_io_columns_writer
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_threads, only : thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_io_decimal, only : longest_real, real_to_text
   use gyroakf_io_npy, only : make_npy_header
   use gyroakf_io_writer, only : commit_writer, discard_writer, open_writer, put, put_line, &
      put_real, put_reals, writer_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_units, only : quantity
   implicit none (type, external)
   private
   public :: column_type, row_layout_type, put_rows, form_of, write_record

   !> One column: an array, an even grid, or nothing (nan in every row)
   type :: column_type
      !> [row]; not associated: the grid, or nothing
      real(dp), pointer, contiguous :: value(:) => null()
      !> 1 where present, 0 where nan is written; [row]; not associated: all present
      integer(int8), pointer, contiguous :: present(:) => null()
      !> Value of row i is (i - 1)*step where it is > 0
      real(dp) :: step = 0.0_dp
      !> Significant digits; 0: as few as read back to the same number
      integer :: digits = 0
   end type column_type

   !> How the rows are written
   type :: row_layout_type
      !> Between the numbers of a line
      character(1) :: separator = ","
      !> "text", or float64 in the machine's order, row after row: bare ("f64") or NumPy's ("npy")
      character(4) :: form = "text"
      !> For the progress
      character(32) :: stage = "writing"
   end type row_layout_type

   !> Rows that were turned into text
   type :: piece_type
      !> Filled up to a place
      character(:), allocatable :: text
      integer :: used = 0
   end type piece_type

   !> Characters of the longest number, with what follows it
   integer(int64), parameter :: widest = 25
   !> Characters, roughly, that a thread turns out at once
   integer(int64), parameter :: piece_size = 131072

contains

   !> The form that a file's name asks for: "npy" and "f64" by .npy and .f64, else "text".
   pure function form_of(path) result(form)
      character(*), intent(in) :: path
      character(4) :: form

      form = "text"
      if (len(path) < 5) return
      if (path(len(path) - 3:) == ".npy") form = "npy"
      if (path(len(path) - 3:) == ".f64") form = "f64"
   end function form_of

   !> Writes rows, behind their header where they are not text.
   subroutine put_rows(writer, columns, rows, layout, error, progress)
      !> Open; a write error is returned when it is completed
      type(writer_type), intent(inout) :: writer
      !> From left to right; arrays begin with row 1
      type(column_type), intent(in) :: columns(:)
      integer(int64), intent(in) :: rows
      type(row_layout_type), intent(in) :: layout
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback, in rows
      class(progress_type), intent(inout), optional :: progress
      type(piece_type), allocatable :: piece(:)
      character(:), allocatable :: header
      integer(int64) :: piece_rows, length, at
      integer :: k, pieces, failed

      if (layout%form == "npy") then
         call make_npy_header(rows, merge(size(columns, kind=int64), 0_int64, size(columns) > 1), &
            .false., header)
         call put(writer, header)
      end if
      piece_rows = max(1_int64, min(rows, piece_size/(widest*max(1, size(columns)))))
      length = merge(0_int64, piece_rows*widest*size(columns) + longest_real, layout%form /= "text")
      pieces = 16*thread_count()
      allocate (piece(pieces))
      do k = 1, pieces
         allocate (character(length) :: piece(k)%text, stat=failed)
         call check_memory(failed, "writing "//writer%path, error)
         if (allocated(error)) return
      end do
      do at = 1, rows, piece_rows*pieces
         if (layout%form /= "text") then
            call put_binary(writer, columns, at, min(rows, at + piece_rows*pieces - 1))
         else
            !$omp parallel do schedule(dynamic)
            do k = 1, pieces
               call spell_rows(columns, at + (k - 1)*piece_rows, min(rows, at + k*piece_rows - 1), &
                  layout%separator, piece(k)%text, piece(k)%used)
            end do
            do k = 1, pieces
               call put(writer, piece(k)%text(:piece(k)%used))
            end do
         end if
         if (writer%failed) return
         call report_progress(trim(layout%stage), at - 1, rows, error, progress)
         if (allocated(error)) return
      end do
   end subroutine put_rows

   subroutine spell_rows(columns, first, last, separator, text, used)
      type(column_type), intent(in) :: columns(:)
      integer(int64), intent(in) :: first, last
      character(1), intent(in) :: separator
      character(*), intent(inout) :: text
      integer, intent(out) :: used
      integer(int64) :: i
      integer :: j, length

      used = 0
      do i = first, last
         do j = 1, size(columns)
            call real_to_text(value_of(columns(j), i), columns(j)%digits, &
               text(used + 1:used + longest_real), length)
            used = used + length + 1
            text(used:used) = separator
         end do
         text(used:used) = new_line("a")
      end do
   end subroutine spell_rows

   !> Rows as numbers; a single array goes as it lies in memory.
   subroutine put_binary(writer, columns, first, last)
      type(writer_type), intent(inout) :: writer
      type(column_type), intent(in) :: columns(:)
      integer(int64), intent(in) :: first, last
      real(dp) :: block(size(columns)*min(last - first + 1, 4096_int64))
      integer(int64) :: at, to, i
      integer :: j, wide

      wide = size(columns)
      if (wide == 1 .and. is_whole(columns(1))) then
         call put_reals(writer, columns(1)%value(first:last))
         return
      end if
      do at = first, last, 4096
         to = min(last, at + 4095)
         do j = 1, wide
            if (is_whole(columns(j))) then
               block(j:wide*(to - at + 1):wide) = columns(j)%value(at:to)
            else
               do i = at, to
                  block(j + wide*(i - at)) = value_of(columns(j), i)
               end do
            end if
         end do
         call put_reals(writer, block(:wide*(to - at + 1)))
      end do
   end subroutine put_binary

   pure logical function is_whole(column)
      type(column_type), intent(in) :: column

      is_whole = associated(column%value) .and. .not. associated(column%present)
   end function is_whole

   !> The value in a row, nan where there is none.
   pure real(dp) function value_of(column, row) result(value)
      type(column_type), intent(in) :: column
      integer(int64), intent(in) :: row

      value = ieee_value(value, ieee_quiet_nan)
      if (column%step > 0.0_dp) value = real(row - 1, dp)*column%step
      if (.not. associated(column%value)) return
      if (associated(column%present)) then
         if (column%present(row) == 0) return
      end if
      value = column%value(row)
   end function value_of

   !> Writes a record; the file appears whole or not at all.
   !>
   !> As text: the given lines and the keys `rate_hz`, `unit` (where known) and `columns`, each
   !> behind "# ", then the samples, channels separated by a blank, "nan" where missing. A path that
   !> ends in `.npy` or `.f64` gets the samples alone.
   subroutine write_record(path, record, header, digits, error, progress)
      !> The file; "-" is standard output
      character(*), intent(in) :: path
      type(record_type), intent(in), target :: record
      !> Lines to begin with, without "# ": where the record comes from
      type(text_type), intent(in) :: header(:)
      !> Significant digits, 1 .. 17; 0: as few as read back to the same numbers
      integer, intent(in) :: digits
      !> invalid_argument: digits; io: the file cannot be written; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback, in samples
      class(progress_type), intent(inout), optional :: progress
      type(writer_type) :: writer
      type(row_layout_type) :: layout
      type(column_type) :: columns(size(record%value, 2))
      integer :: j

      if (digits < 0 .or. digits > 17) then
         call fatal_error(error, status%invalid_argument, &
            "a record is written with 0 .. 17 significant digits")
         return
      end if
      do j = 1, size(columns)
         columns(j)%value => record%value(:, j)
         if (allocated(record%present)) columns(j)%present => record%present(:, j)
         columns(j)%digits = digits
      end do
      layout%separator = " "
      layout%form = form_of(path)
      call open_writer(writer, path, error)
      if (allocated(error)) return
      if (layout%form == "text") call put_header(writer, record, header)
      call put_rows(writer, columns, size(record%value, 1, kind=int64), layout, error, progress)
      if (allocated(error)) then
         call discard_writer(writer)
      else
         call commit_writer(writer, error)
      end if
   end subroutine write_record

   subroutine put_header(writer, record, header)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(text_type), intent(in) :: header(:)
      integer :: i

      do i = 1, size(header)
         call put_line(writer, "# "//header(i)%text)
      end do
      if (record%rate_known) then
         call put(writer, "# rate_hz: ")
         call put_real(writer, 1/record%sample_interval, 15)
         call put_line(writer, "")
      end if
      if (allocated(record%unit%name)) then
         if (record%unit%name /= "") call put_line(writer, "# unit: "//record%unit%name)
      end if
      if (allocated(record%channel_unit)) then
         call put(writer, "# units:")
         do i = 1, size(record%channel_unit)
            if (record%channel_unit(i)%quantity == quantity%unknown) call put(writer, " -")
            if (record%channel_unit(i)%quantity /= quantity%unknown) call put(writer, " "// &
               record%channel_unit(i)%name)
         end do
         call put_line(writer, "")
      end if
      if (.not. allocated(record%channel)) return
      call put(writer, "# columns:")
      do i = 1, size(record%channel)
         call put(writer, " "//record%channel(i)%text)
      end do
      call put_line(writer, "")
   end subroutine put_header

end module gyroakf_io_columns_writer
