! SPDX-License-Identifier: MIT
!> Files that appear whole or not at all: written aside in the same directory as NAME.partPROCESS,
!> then renamed. What a process that was killed left aside is removed when the file is begun again.
!>
!>     call open_writer(writer, "allan.csv", error)
!>     call put_line(writer, "tau,deviation")        ! any number of these; failures are kept
!>     call commit_writer(writer, error)             ! ... and reported here, where the file appears
module gyroakf_io_writer
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_null_char
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_decimal, only : format_real, longest_real, real_to_text
   use gyroakf_io_source, only : find_reason, is_directory
   use gyroakf_io_system, only : c_close, c_creat, c_getpid, c_mkdir, c_rename, c_unlink, move_bytes
   implicit none (type, external)
   private
   public :: writer_type, markup_type, open_writer, put, put_line, put_real, put_reals
   public :: complete_writer, commit_writer, discard_writer, format_real
   public :: make_directory, is_file, remove_file

   !> Of a report that is written as a page: what stands open in it (see
   !> [[gyroakf_report_html_markup]])
   type :: markup_type
      !> The report is a page; else it is plain text
      logical :: on = .false.
      !> The list that is open: "dl", "ul", "" for none
      character(2) :: list = ""
      !> Level of the headings with a line under them; the others are one deeper
      integer :: level = 2
      !> The last heading, which names the tables below it
      character(:), allocatable :: heading
   end type markup_type

   !> A file that is being written
   type :: writer_type
      !> Where it appears; "-" is standard output
      character(:), allocatable :: path
      !> Where it is written; the same as `path` for what is no regular file
      character(:), allocatable :: aside
      !> The system's descriptor, -1 where nothing is open
      integer(c_int) :: unit = -1
      !> What was not yet written
      character(:, kind=c_char), allocatable :: buffer
      integer :: used = 0
      !> True after the first write that failed
      logical :: failed = .false.
      !> True where all is written and only the renaming is left
      logical :: complete = .false.
      !> A report goes to a terminal that shows UTF-8, colors; of no meaning to the writer itself
      logical :: unicode = .false., color = .false.
      !> A report goes into a page
      type(markup_type) :: markup
   end type writer_type

   interface
      !> Removes path.partN of all processes N that are no more
      subroutine remove_leftovers(path) bind(C, name="gyroakf_host_remove_leftovers")
         import :: c_char
         implicit none (type, external)
         !> Ends with a NUL
         character(kind=c_char), intent(in) :: path(*)
      end subroutine remove_leftovers

      !> Not 0 for a device or a FIFO, which must not be replaced by a file
      integer(c_int) function is_special(path) bind(C, name="gyroakf_host_is_special")
         import :: c_char, c_int
         implicit none (type, external)
         !> Ends with a NUL
         character(kind=c_char), intent(in) :: path(*)
      end function is_special
   end interface

   !> Characters written at once
   integer, parameter :: buffer_size = 262144

contains

   !> Begins a file.
   subroutine open_writer(writer, path, error)
      !> To be ended by [[commit_writer]] or [[discard_writer]]
      type(writer_type), intent(out) :: writer
      !> Where the file shall appear; "-" is standard output. Devices and FIFOs are written directly
      character(*), intent(in) :: path
      !> Allocated where nothing can be written there: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      character(12) :: process
      character(:), allocatable :: reason
      integer :: failed

      writer%path = path
      writer%aside = path
      allocate (character(buffer_size) :: writer%buffer, stat=failed)
      call check_memory(failed, "writing "//path, error)
      if (allocated(error)) return
      if (path == "-") then
         writer%unit = 1
         return
      end if
      if (is_directory(path)) then
         call fatal_error(error, status%io, path//": is a directory, not a file to write")
         return
      end if
      write (process, "(i0)") c_getpid()
      if (is_special(path//c_null_char) == 0) then
         writer%aside = path//".part"//trim(process)
         call remove_leftovers(path//c_null_char)
      end if
      writer%unit = c_creat(writer%aside//c_null_char, int(o'666', c_int))
      if (writer%unit >= 0) return
      call find_reason(writer%aside, "write", reason)
      call fatal_error(error, status%io, path//": cannot be written: "//reason)
   end subroutine open_writer

   !> Writes a text; a failure is kept for [[commit_writer]].
   subroutine put(writer, text)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: text
      integer :: from, piece

      from = 1
      do while (from <= len(text) .and. writer%unit >= 0)
         piece = min(len(text) - from + 1, buffer_size - writer%used)
         writer%buffer(writer%used + 1:writer%used + piece) = text(from:from + piece - 1)
         writer%used = writer%used + piece
         from = from + piece
         if (writer%used == buffer_size) call flush_buffer(writer)
      end do
   end subroutine put

   !> Writes a text and a line feed.
   subroutine put_line(writer, text)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: text

      call put(writer, text)
      call put(writer, new_line("a"))
   end subroutine put_line

   !> Writes a number as [[format_real]] gives it, without allocating.
   subroutine put_real(writer, value, digits)
      type(writer_type), intent(inout) :: writer
      real(dp), intent(in) :: value
      !> 1 to 17; 0: as few as read back to the same number
      integer, intent(in) :: digits
      integer :: length

      if (writer%unit < 0) return
      if (writer%used + longest_real >= buffer_size) call flush_buffer(writer)
      call real_to_text(value, digits, writer%buffer(writer%used + 1:writer%used + longest_real), &
         length)
      writer%used = writer%used + length
   end subroutine put_real

   !> Writes numbers as the bytes that they are.
   subroutine put_reals(writer, values)
      type(writer_type), intent(inout) :: writer
      real(dp), intent(in), contiguous, target :: values(:)
      integer(int64) :: moved

      if (writer%unit < 0 .or. size(values) == 0) return
      call flush_buffer(writer)
      if (.not. writer%failed) call move_bytes(writer%unit, c_loc(values), &
         8*size(values, kind=int64), moved, writer%failed)
   end subroutine put_reals

   subroutine flush_buffer(writer)
      type(writer_type), intent(inout), target :: writer
      integer(int64) :: moved

      if (writer%used > 0 .and. .not. writer%failed) then
         call move_bytes(writer%unit, c_loc(writer%buffer), int(writer%used, int64), moved, &
            writer%failed)
      end if
      writer%used = 0
   end subroutine flush_buffer

   !> Writes the rest and closes the file, which does not appear yet: where several files belong
   !> together, all are completed before the first one is committed.
   subroutine complete_writer(writer, error)
      !> Nothing more can be written; to be ended by [[commit_writer]] or [[discard_writer]]
      type(writer_type), intent(inout) :: writer
      !> io where something could not be written (a full disk, a closed pipe); nothing is left of it
      type(error_type), allocatable, intent(out) :: error

      if (writer%unit < 0) return
      call flush_buffer(writer)
      if (writer%unit > 1) writer%failed = c_close(writer%unit) /= 0 .or. writer%failed
      writer%unit = -1
      writer%complete = .not. writer%failed
      if (writer%failed) call remove_failed(writer, error)
   end subroutine complete_writer

   !> Writes the rest and lets the file appear.
   subroutine commit_writer(writer, error)
      type(writer_type), intent(inout) :: writer
      !> io where something could not be written (a full disk, a closed pipe); no file appears
      type(error_type), allocatable, intent(out) :: error

      call complete_writer(writer, error)
      if (.not. writer%complete) return
      writer%complete = .false.
      if (writer%aside /= writer%path) then
         writer%failed = c_rename(writer%aside//c_null_char, writer%path//c_null_char) /= 0
      end if
      if (writer%failed) call remove_failed(writer, error)
   end subroutine commit_writer

   !> Removes what was written aside and says why.
   subroutine remove_failed(writer, error)
      type(writer_type), intent(in) :: writer
      type(error_type), allocatable, intent(out) :: error

      if (writer%aside /= writer%path) call remove_file(writer%aside)
      if (writer%path == "-") then
         call fatal_error(error, status%io, &
            "standard output cannot be written: the disk is full or the reader has gone")
      else
         call fatal_error(error, status%io, writer%path//": cannot be written: is the disk full?")
      end if
   end subroutine remove_failed

   !> Gives the file up: nothing appears. Harmless after [[commit_writer]].
   subroutine discard_writer(writer)
      type(writer_type), intent(inout) :: writer
      integer(c_int) :: ignored

      if (writer%unit < 0 .and. .not. writer%complete) return
      if (writer%unit > 1) ignored = c_close(writer%unit)
      writer%unit = -1
      writer%complete = .false.
      if (writer%aside /= writer%path) call remove_file(writer%aside)
   end subroutine discard_writer

   !> True where a regular file is there, which a new one would replace.
   logical function is_file(path)
      character(*), intent(in) :: path

      inquire (file=path, exist=is_file)
      if (is_file) is_file = .not. is_directory(path) .and. is_special(path//c_null_char) == 0
   end function is_file

   !> Removes a file; content where there is none.
   subroutine remove_file(path)
      character(*), intent(in) :: path
      integer(c_int) :: ignored

      ignored = c_unlink(path//c_null_char)
   end subroutine remove_file

   !> Makes a directory and those above it; content where it is there already.
   subroutine make_directory(path, error)
      character(*), intent(in) :: path
      !> Allocated where it is not there afterwards: io
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: ignored
      integer :: i

      ! one call: gfortran passes the mode of a second one by reference
      do i = 2, len(path) + 1
         if (i <= len(path) .and. index(path(i:), "/") /= 1) cycle
         ignored = c_mkdir(path(:i - 1)//c_null_char, int(o'777', c_int))
      end do
      if (is_directory(path)) return
      call fatal_error(error, status%io, path//": the directory cannot be made")
   end subroutine make_directory

end module gyroakf_io_writer
