! SPDX-License-Identifier: MIT
!> A record written as the text file that the readers understand: header keys, then a line for every sample.
module gyroakf_io_record_writer
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type, text_type
   use gyroakf_units, only : unit_type, quantity
   use gyroakf_io_writer, only : writer_type, open_writer, put, put_line, put_real, commit_writer
   implicit none (type, external)
   private
   public :: write_record

contains

   !> Writes a record: the given lines and the keys `rate_hz`, `unit` (where known) and `columns`, each behind "# ", then
   !> the samples, channels separated by a blank, "nan" where missing. The file appears whole or not at all.
   subroutine write_record(path, record, header, digits, error)
      !> The file; "-" is standard output
      character(*), intent(in) :: path
      !> The record
      type(record_type), intent(in) :: record
      !> Lines to begin with, without "# ": where the record comes from
      type(text_type), intent(in) :: header(:)
      !> Significant digits, 1 .. 17; 0: as few as read back to the same numbers
      integer, intent(in) :: digits
      !> invalid_argument: digits; io: the file cannot be written
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      integer(int64) :: i

      if (digits < 0 .or. digits > 17) then
         call fatal_error(error, status%invalid_argument, "a record is written with 0 .. 17 significant digits")
         return
      end if
      call open_writer(writer, path, error)
      if (allocated(error)) return
      call put_header(writer, record, header)
      do i = 1, size(record%value, 1, kind=int64)
         call put_sample(writer, record, i, digits)
      end do
      call commit_writer(writer, error)
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
            call put(writer, " "//unit_word(record%channel_unit(i)))
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

   !> The unit's name, "-" where it is not known.
   pure function unit_word(unit) result(word)
      type(unit_type), intent(in) :: unit
      character(:), allocatable :: word

      word = "-"
      if (unit%quantity /= quantity%unknown) word = unit%name
   end function unit_word

   !> One line of samples
   subroutine put_sample(writer, record, i, digits)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      integer(int64), intent(in) :: i
      integer, intent(in) :: digits
      integer :: k
      logical :: here

      do k = 1, size(record%value, 2)
         if (k > 1) call put(writer, " ")
         here = .true.
         if (allocated(record%present)) here = record%present(i, k) == 1
         if (here) then
            call put_real(writer, record%value(i, k), digits)
         else
            call put(writer, "nan")
         end if
      end do
      call put_line(writer, "")
   end subroutine put_sample

end module gyroakf_io_record_writer
