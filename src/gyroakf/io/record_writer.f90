! SPDX-License-Identifier: MIT
!> A record as a file that the readers understand: text with header keys, .npy, bare numbers.
module gyroakf_io_record_writer
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type, text_type
   use gyroakf_units, only : quantity
   use gyroakf_progress, only : progress_type
   use gyroakf_io_columns_writer, only : column_type, form_of, put_rows, row_layout_type
   use gyroakf_io_writer, only : writer_type, open_writer, put, put_line, put_real, commit_writer, &
      discard_writer
   implicit none (type, external)
   private
   public :: write_record

contains

   !> Writes a record; the file appears whole or not at all.
   !>
   !> As text: the given lines and the keys `rate_hz`, `unit` (where known) and `columns`, each
   !> behind "# ", then the samples, channels separated by a blank, "nan" where missing. A path that
   !> ends in `.npy` or `.f64` gets the samples alone.
   subroutine write_record(path, record, header, digits, error, progress)
      !> The file; "-" is standard output
      character(*), intent(in) :: path
      !> The record
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

   !> The lines that begin with "# "
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

end module gyroakf_io_record_writer
