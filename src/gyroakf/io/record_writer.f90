! SPDX-License-Identifier: MIT
!> A record written as the text file that the readers understand: header keys, then a line for every sample.
module gyroakf_io_record_writer
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type, text_type
   implicit none (type, external)
   private
   public :: write_record

   character(1), parameter :: newline = achar(10)

   !> Where the text goes: gathered in blocks
   type :: sink_type
      integer :: unit = -1, used = 0, stat = 0
      character(65536) :: block
      character(256) :: message = ""
   end type sink_type

contains

   !> Writes a record: the given lines and the keys `rate_hz`, `unit` (where known) and `columns`, each behind "# ", then
   !> the samples, channels separated by a blank, "nan" where missing.
   subroutine write_record(path, record, header, digits, error)
      !> The file
      character(*), intent(in) :: path
      !> The record
      type(record_type), intent(in) :: record
      !> Lines to begin with, without "# ": where the record comes from
      type(text_type), intent(in) :: header(:)
      !> Significant digits, 1 .. 17
      integer, intent(in) :: digits
      !> invalid_argument: digits; io: the file cannot be written
      type(error_type), allocatable, intent(out) :: error
      type(sink_type) :: sink
      integer(int64) :: i
      integer :: stat

      if (digits < 1 .or. digits > 17) then
         call fatal_error(error, status%invalid_argument, "a record is written with 1 .. 17 significant digits")
         return
      end if
      open (newunit=sink%unit, file=path, access="stream", form="unformatted", status="replace", action="write", &
         & iostat=stat, iomsg=sink%message)
      sink%stat = stat
      if (stat == 0) then
         call put_header(sink, record, header, digits)
         do i = 1, size(record%value, 1, kind=int64)
            call put_sample(sink, record, i, digits)
         end do
         call empty(sink)
         close (sink%unit)
      end if
      if (sink%stat /= 0) call fatal_error(error, status%io, path//": cannot be written: "//trim(sink%message))
   end subroutine write_record

   !> The lines that begin with "# "
   subroutine put_header(sink, record, header, digits)
      type(sink_type), intent(inout) :: sink
      type(record_type), intent(in) :: record
      type(text_type), intent(in) :: header(:)
      integer, intent(in) :: digits
      integer :: i

      do i = 1, size(header)
         call put(sink, "# "//header(i)%text//newline)
      end do
      if (record%rate_known) call put(sink, "# rate_hz: "//plain(1/record%sample_interval, digits)//newline)
      if (allocated(record%unit%name)) then
         if (record%unit%name /= "") call put(sink, "# unit: "//record%unit%name//newline)
      end if
      if (.not. allocated(record%channel)) return
      call put(sink, "# columns:")
      do i = 1, size(record%channel)
         call put(sink, " "//record%channel(i)%text)
      end do
      call put(sink, newline)
   end subroutine put_header

   !> One line of samples
   subroutine put_sample(sink, record, i, digits)
      type(sink_type), intent(inout) :: sink
      type(record_type), intent(in) :: record
      integer(int64), intent(in) :: i
      integer, intent(in) :: digits
      integer :: k
      logical :: here

      do k = 1, size(record%value, 2)
         if (k > 1) call put(sink, " ")
         here = .true.
         if (allocated(record%present)) here = record%present(i, k) == 1
         if (here) then
            call put(sink, plain(record%value(i, k), digits))
         else
            call put(sink, "nan")
         end if
      end do
      call put(sink, newline)
   end subroutine put_sample

   !> A finite number as C's "%.<digits>g" writes it: no blanks, no trailing zeros.
   pure function plain(value, digits) result(text)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      character(:), allocatable :: text
      character(40) :: raw
      character(12) :: edit
      integer :: e, last, power

      write (edit, "(a, i0, a)") "(es40.", digits - 1, "e4)"
      write (raw, edit) abs(value)
      raw = adjustl(raw)
      e = index(raw, "E")
      read (raw(e + 1:), *) power
      last = e - 1
      text = raw(1:1)//raw(3:last)                     ! the digits
      last = max(1, verify(text, "0", back=.true.))
      if (power < -4 .or. power >= digits) then
         write (edit, "(sp, i0.2)") power
         if (last > 1) then
            text = text(1:1)//"."//text(2:last)//"e"//trim(edit)
         else
            text = text(1:1)//"e"//trim(edit)
         end if
      else if (power < 0) then
         text = "0."//repeat("0", -power - 1)//text(:last)
      else if (last > power + 1) then
         text = text(:power + 1)//"."//text(power + 2:last)
      else
         text = text(:power + 1)
      end if
      if (value < 0) text = "-"//text
   end function plain

   subroutine put(sink, text)
      type(sink_type), intent(inout) :: sink
      character(*), intent(in) :: text

      if (sink%used + len(text) > len(sink%block)) call empty(sink)
      if (len(text) > len(sink%block)) then
         call write_out(sink, text)
         return
      end if
      sink%block(sink%used + 1:sink%used + len(text)) = text
      sink%used = sink%used + len(text)
   end subroutine put

   subroutine empty(sink)
      type(sink_type), intent(inout) :: sink

      call write_out(sink, sink%block(:sink%used))
      sink%used = 0
   end subroutine empty

   !> Writes unless an earlier write failed.
   subroutine write_out(sink, text)
      type(sink_type), intent(inout) :: sink
      character(*), intent(in) :: text
      integer :: stat

      if (sink%stat /= 0 .or. len(text) == 0) return
      write (sink%unit, iostat=stat, iomsg=sink%message) text
      if (stat /= 0) sink%stat = stat
   end subroutine write_out

end module gyroakf_io_record_writer
