! SPDX-License-Identifier: MIT
!> Bytes of a file, of standard input, of a FIFO or of the caller's memory, in blocks.
!>
!> Regular files are read by the system's `pread`, by several threads at a time, up to the length
!> that they had when they were opened; where that cut a line, to the end of this line. A file that
!> becomes shorter meanwhile is an error. Anything that may deliver in pieces (`-`, FIFOs, devices)
!> is read by `read` until there is no more. Reads that a signal interrupts are resumed. gzip data
!> are recognized by their first bytes, wherever they come from, and decompressed in order; their
!> length is unknown.
module gyroakf_io_source
   use, intrinsic :: iso_c_binding, only : c_int, c_loc, c_long, c_null_char, c_short, c_size_t
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_gzip, only : inflate_bytes, inflate_end, inflater_type, is_gzip
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_system, only : c_close, c_open, c_poll, c_read, poll_type, move_bytes
   implicit none (type, external)
   private
   public :: source_type, open_source, read_block, read_piece, source_left, has_places, &
      close_source, is_directory, find_reason

   !> An open source of bytes
   type :: source_type
      !> For messages: the path, or `<stdin>`
      character(:), allocatable :: name
      !> -1 where it is closed
      integer(c_int) :: descriptor = -1
      !> Of the caller, where there is no file
      integer(int8), pointer, contiguous :: bytes(:) => null()
      !> Bytes of a regular file or of the caller's, 0 where that is not known
      integer(int64) :: length = 0
      !> Bytes delivered so far
      integer(int64) :: delivered = 0
      !> Compressed bytes of the caller that were read
      integer(int64) :: stored = 0
      !> First bytes of what is no regular file, read to recognize gzip, and how many were delivered
      integer(int8) :: ahead(4) = 0
      integer(int64) :: ahead_count = 0, ahead_used = 0
      !> Where the content is decompressed
      type(inflater_type), pointer :: inflater => null()
   end type source_type

   !> A read that fails is tried again so often: after a signal, or of a non-blocking descriptor
   integer, parameter :: most_tries = 1000
   !> Compressed bytes that are read at once, and bytes that a thread reads
   integer, parameter :: input_size = 131072
   integer(int64), parameter :: piece_size = 131072

contains

   !> True where the path is a directory.
   logical function is_directory(path)
      character(*), intent(in) :: path

      inquire (file=path//"/.", exist=is_directory)
      is_directory = is_directory .and. len(path) > 0
   end function is_directory

   !> Opens a source.
   subroutine open_source(source, path, error, bytes)
      !> To be closed by [[close_source]]
      type(source_type), intent(out) :: source
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      !> Allocated where it cannot be opened: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Where associated: the content, kept until the source is closed; the path is then a name
      integer(int8), pointer, contiguous, intent(in), optional :: bytes(:)
      character(:), allocatable :: reason
      logical :: exists

      source%name = path
      if (present(bytes)) source%bytes => bytes
      if (associated(source%bytes)) then
         source%length = size(source%bytes, kind=int64)
      else if (path == "-") then
         source%name = "<stdin>"
         source%descriptor = 0
      else if (is_directory(path)) then
         call fatal_error(error, status%io, path//": is a directory"//new_line("a")// &
            "give the file in it that holds the record")
      else
         inquire (file=path, exist=exists, size=source%length)
         source%length = max(source%length, 0_int64)
         if (exists) source%descriptor = c_open(path//c_null_char, 0_c_int)
         if (.not. exists) then
            call fatal_error(error, status%io, path//": no such file"//new_line("a")// &
               "check the path; - reads standard input")
         else if (source%descriptor < 0) then
            call find_reason(path, "read", reason)
            call fatal_error(error, status%io, path//": cannot be opened: "//reason// &
               new_line("a")//"check the file's permissions")
         end if
      end if
      if (.not. allocated(error)) call find_gzip(source, error)
   end subroutine open_source

   !> Why a file cannot be opened, in the words of the system.
   subroutine find_reason(path, action, reason)
      character(*), intent(in) :: path
      !> "read" or "write"; what can be written is deleted again
      character(*), intent(in) :: action
      character(:), allocatable, intent(out) :: reason
      character(len(path) + 256) :: message
      integer :: unit, failed

      message = "unknown reason"
      open (newunit=unit, file=path, access="stream", form="unformatted", action=action, &
            status=merge("old    ", "replace", action == "read"), iostat=failed, iomsg=message)
      if (failed == 0) close (unit, status=merge("keep  ", "delete", action == "read"))
      if (failed == 0) message = "unknown reason"
      reason = trim(adjustl(message(index(message, ": ", back=.true.) + 1:)))
   end subroutine find_reason

   subroutine find_gzip(source, error)
      type(source_type), intent(inout) :: source
      type(error_type), allocatable, intent(out) :: error
      integer(int8) :: first(size(source%ahead))
      integer(int64) :: got
      integer :: lacking
      logical :: failed

      if (has_places(source)) then
         call read_piece(source, 0_int64, first, got, failed)
      else
         call read_pieces(source, first, got, failed)
         source%ahead = first
         source%ahead_count = got
      end if
      if (.not. is_gzip(first(:got))) return
      source%length = 0
      allocate (source%inflater, stat=lacking)
      if (lacking == 0) allocate (source%inflater%input(input_size), stat=lacking)
      if (lacking == 0) return
      call close_source(source)
      call fatal_error(error, status%no_memory, source%name//": no memory to decompress it")
   end subroutine find_gzip

   !> True where any place can be read at any time: regular files and the caller's, uncompressed.
   pure logical function has_places(source)
      type(source_type), intent(in) :: source

      has_places = (source%length > 0 .or. associated(source%bytes)) .and. &
         .not. associated(source%inflater)
   end function has_places

   !> Bytes that are to come at most.
   pure integer(int64) function source_left(source)
      type(source_type), intent(in) :: source

      source_left = huge(source_left)
      if (has_places(source)) source_left = max(0_int64, source%length - source%delivered)
   end function source_left

   !> Reads until `buffer` is full or the source ends.
   subroutine read_block(source, buffer, got, error)
      type(source_type), intent(inout) :: source
      integer(int8), intent(inout), contiguous, target :: buffer(:)
      !> Bytes read; fewer than `buffer` holds only at the end of the source
      integer(int64), intent(out) :: got
      !> io; parse: compressed data are damaged or end early; no_memory to decompress them
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: k, n, to, came
      logical :: failed, refused

      failed = .false.
      if (associated(source%inflater)) then
         call read_compressed(source, buffer, got, failed, error)
      else if (has_places(source)) then
         n = min(size(buffer, kind=int64), source_left(source))
         got = n
         !$omp parallel do schedule(dynamic) private(to, came, refused) reduction(min:got) &
         !$omp& reduction(.or.:failed) if(n > 4*piece_size)
         do k = 0, n - 1, piece_size
            to = min(k + piece_size, n)
            call read_piece(source, source%delivered + k, buffer(k + 1:to), came, refused)
            failed = failed .or. refused
            if (came < to - k) got = min(got, k + came)
         end do
         !$omp end parallel do
      else
         call read_pieces(source, buffer, got, failed)
      end if
      if (failed) call fatal_error(error, status%io, source%name//": cannot be read")
      source%delivered = source%delivered + got
   end subroutine read_block

   !> Decompresses until `buffer` is full or the compressed data end.
   subroutine read_compressed(source, buffer, got, failed, error)
      type(source_type), intent(inout) :: source
      integer(int8), intent(inout), contiguous, target :: buffer(:)
      integer(int64), intent(out) :: got
      logical, intent(out) :: failed
      type(error_type), allocatable, intent(out) :: error
      character(160) :: problem
      integer(int64) :: fresh, came
      integer :: code
      logical :: whole

      got = 0
      failed = .false.
      whole = .false.
      do while (got < size(buffer, kind=int64) .and. .not. whole)
         fresh = 0
         if (source%inflater%stream%avail_in == 0) call read_pieces(source, source%inflater%input, &
            fresh, failed)
         if (failed) return
         call inflate_bytes(source%inflater, fresh, buffer(got + 1:), came, whole, code, problem)
         got = got + came
         if (code == status%ok) cycle
         problem = trim(problem)//" after "//integer_text(source%delivered + got)// &
            " decompressed bytes"
         if (code == status%parse) problem = trim(problem)//new_line("a")// &
            "copy the file again; gzip -t tests it"
         call fatal_error(error, code, source%name//": "//trim(problem))
         return
      end do
   end subroutine read_compressed

   !> Reads at a place; several threads may do so at a time.
   subroutine read_piece(source, offset, buffer, got, failed)
      type(source_type), intent(in) :: source
      !> Bytes before the first that is read
      integer(int64), intent(in) :: offset
      integer(int8), intent(inout), contiguous, target :: buffer(:)
      !> Bytes read; fewer than `buffer` holds only at the end of the file
      integer(int64), intent(out) :: got
      logical, intent(out) :: failed

      failed = .false.
      if (associated(source%bytes)) then
         got = max(0_int64, min(size(buffer, kind=int64), size(source%bytes, kind=int64) - offset))
         buffer(:got) = source%bytes(offset + 1:offset + got)
      else
         call move_bytes(source%descriptor, c_loc(buffer), size(buffer, kind=int64), got, failed, &
            offset)
      end if
   end subroutine read_piece

   !> A block of something that may deliver in pieces, or of the caller's compressed bytes.
   subroutine read_pieces(source, buffer, got, failed)
      type(source_type), intent(inout) :: source
      integer(int8), intent(inout), contiguous, target :: buffer(:)
      integer(int64), intent(out) :: got
      logical, intent(out) :: failed
      integer(c_long) :: piece
      type(poll_type) :: waiting(1)
      integer(c_int) :: ready
      integer :: tries

      if (associated(source%bytes)) then
         call read_piece(source, source%stored, buffer, got, failed)
         source%stored = source%stored + got
         return
      end if
      got = min(size(buffer, kind=int64), source%ahead_count - source%ahead_used)
      buffer(:got) = source%ahead(source%ahead_used + 1:source%ahead_used + got)
      source%ahead_used = source%ahead_used + got
      failed = .false.
      tries = 0
      do while (got < size(buffer, kind=int64))
         piece = c_read(source%descriptor, c_loc(buffer(got + 1)), size(buffer, kind=c_size_t) - &
            int(got, c_size_t))
         if (piece == 0) exit
         if (piece > 0) then
            got = got + piece
            tries = 0
            cycle
         end if
         tries = tries + 1
         failed = tries > most_tries
         if (failed) return
         waiting(1)%descriptor = source%descriptor
         waiting(1)%events = 1_c_short
         waiting(1)%happened = 0_c_short
         ready = c_poll(waiting, 1_c_long, -1_c_int)
      end do
   end subroutine read_pieces

   !> Closes the source; harmless where it is closed, and standard input stays open.
   subroutine close_source(source)
      type(source_type), intent(inout) :: source
      integer(c_int) :: ignored

      if (source%descriptor > 0) ignored = c_close(source%descriptor)
      source%descriptor = -1
      nullify (source%bytes)
      if (.not. associated(source%inflater)) return
      ignored = inflate_end(source%inflater%stream)
      deallocate (source%inflater)
   end subroutine close_source

end module gyroakf_io_source
