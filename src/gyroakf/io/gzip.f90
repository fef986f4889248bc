! SPDX-License-Identifier: MIT
!> Decompression of gzip data by zlib: one member or several in a row, length and checksum verified.
module gyroakf_io_gzip
   use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_int, c_loc, c_long, c_null_char, &
      c_null_funptr, c_null_ptr, c_ptr, c_sizeof
   use gyroakf_error, only : status
   use gyroakf_kinds, only : int8, int64
   implicit none (type, external)
   private
   public :: inflater_type, is_gzip, inflate_bytes, inflate_end

   !> `z_stream` of zlib.h; without memory functions those of the C library are used
   type, bind(C) :: z_stream
      type(c_ptr) :: next_in = c_null_ptr
      integer(c_int) :: avail_in = 0
      integer(c_long) :: total_in = 0
      type(c_ptr) :: next_out = c_null_ptr
      integer(c_int) :: avail_out = 0
      integer(c_long) :: total_out = 0
      type(c_ptr) :: message = c_null_ptr, state = c_null_ptr
      type(c_funptr) :: allocate = c_null_funptr, free = c_null_funptr
      type(c_ptr) :: opaque = c_null_ptr
      integer(c_int) :: data_type = 0
      integer(c_long) :: adler = 0, reserved = 0
   end type z_stream

   !> State of a decompression; zlib keeps its address, so it must not be copied
   type :: inflater_type
      type(z_stream) :: stream
      !> Buffer of compressed bytes
      integer(int8), allocatable :: input(:)
      !> True before the first member and behind each
      logical :: between_members = .true.
   end type inflater_type

   !> Of zlib.h: return codes, no flushing, the largest window with gzip headers only
   integer(c_int), parameter :: z_ok = 0, z_stream_end = 1, z_mem_error = -4, z_buf_error = -5
   integer(c_int), parameter :: z_no_flush = 0, gzip_window = 15 + 16
   !> Bytes that zlib writes in one call at most: it counts them in 32 bits
   integer(int64), parameter :: most_written = 2_int64**30

   interface
      integer(c_int) function inflate_init(stream, window, version, bytes) &
         bind(C, name="inflateInit2_")
         import :: c_char, c_int, z_stream
         implicit none (type, external)
         type(z_stream), intent(inout) :: stream
         integer(c_int), intent(in), value :: window, bytes
         character(kind=c_char), intent(in) :: version(*)
      end function inflate_init

      integer(c_int) function inflate(stream, flush) bind(C, name="inflate")
         import :: c_int, z_stream
         implicit none (type, external)
         type(z_stream), intent(inout) :: stream
         integer(c_int), intent(in), value :: flush
      end function inflate

      integer(c_int) function inflate_end(stream) bind(C, name="inflateEnd")
         import :: c_int, z_stream
         implicit none (type, external)
         type(z_stream), intent(inout) :: stream
      end function inflate_end
   end interface

contains

   !> True for the first bytes of gzip data: signature, method deflate, no reserved flag.
   pure logical function is_gzip(bytes)
      !> Four bytes; fewer are no gzip data
      integer(int8), intent(in) :: bytes(:)

      is_gzip = .false.
      if (size(bytes) < 4) return
      is_gzip = all(bytes(:3) == [31_int8, -117_int8, 8_int8]) .and. iand(bytes(4), -32_int8) == 0
   end function is_gzip

   !> Decompresses until the compressed bytes at hand are used up or `buffer` is full.
   subroutine inflate_bytes(inflater, fresh, buffer, got, whole, code, problem)
      !> Where no bytes are at hand, the compressed data have ended
      type(inflater_type), intent(inout), target :: inflater
      !> Number of new bytes in `input`, 0 unless those before are consumed
      integer(int64), intent(in) :: fresh
      integer(int8), intent(inout), contiguous, target :: buffer(:)
      integer(int64), intent(out) :: got
      !> True where the last member is complete and nothing follows
      logical, intent(out) :: whole
      !> ok, parse where the data are damaged or end early, no_memory
      integer, intent(out) :: code
      !> What is wrong, blank where nothing is
      character(*), intent(out) :: problem
      integer(c_int) :: answer, writable

      if (fresh > 0) inflater%stream%next_in = c_loc(inflater%input)
      if (fresh > 0) inflater%stream%avail_in = int(fresh, c_int)
      got = 0
      code = status%ok
      problem = ""
      whole = inflater%between_members .and. inflater%stream%avail_in == 0
      if (whole) return
      answer = z_ok
      if (inflater%between_members) then
         answer = inflate_end(inflater%stream)
         answer = inflate_init(inflater%stream, gzip_window, "1"//c_null_char, &
                               int(c_sizeof(inflater%stream), c_int))
      end if
      if (answer == z_ok) then
         writable = int(min(size(buffer, kind=int64), most_written), c_int)
         inflater%stream%next_out = c_loc(buffer)
         inflater%stream%avail_out = writable
         answer = inflate(inflater%stream, z_no_flush)
         got = writable - inflater%stream%avail_out
      end if
      inflater%between_members = answer == z_stream_end
      if (any(answer == [z_ok, z_stream_end])) return
      code = merge(status%no_memory, status%parse, answer == z_mem_error)
      problem = "the compressed data are damaged"
      if (answer == z_buf_error) problem = "the compressed data end early"
      if (answer == z_mem_error) problem = "no memory to decompress it"
   end subroutine inflate_bytes

end module gyroakf_io_gzip
