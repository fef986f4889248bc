! SPDX-License-Identifier: MIT
!> What a file looks like before it is read: text or something else.
!>
!> The content decides, not the name; only bytes without a signature are what the end of the name says (`.f64`, `.i16be`).
module gyroakf_io_format
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_element, only : element_type, parse_element
   use gyroakf_io_magic, only : find_magic, magics, name_file
   use gyroakf_io_place, only : integer_text
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: content_type, recognise

   !> What a file holds
   type :: content_type
      !> "text", "npy", "binary" (by the name) or "foreign"
      character(7) :: kind = "text"
      !> Of "binary"
      type(element_type) :: element
      !> Of the name, in lower case, without the point
      character(:), allocatable :: ending
      !> Of "foreign": what it is, as in "compressed by zstd", and what to do
      character(:), allocatable :: what, advice
      !> Position of the byte that decided it, from 1
      integer(int64) :: at = 1
   end type content_type

   character(*), parameter :: binary_advice = "say what it holds: `format` f64, f32, i16, i32, u8, ..., with be behind it for "// &
      "big endian; `channels` for interleaved columns, `skip` for a header of so many bytes"

contains

   !> What the first block of a file holds.
   subroutine recognise(bytes, name, content)
      !> The first bytes: some thousands, or all there are
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Of the file: its end counts where the content alone does not tell
      character(*), intent(in) :: name
      !> What it is
      type(content_type), intent(out) :: content
      logical :: control(size(bytes, kind=int64))
      integer(int64) :: controls, nulls
      integer :: found, point_at
      logical :: by_name

      content%kind = "text"
      point_at = index(name, ".", back=.true.)
      content%ending = ""
      if (point_at > index(name, "/", back=.true.)) content%ending = lower(name(point_at + 1:))
      call parse_element(content%ending, content%element, by_name)
      call find_magic(bytes, content%kind, found)
      if (found > 0) then
         if (.not. (by_name .and. magics(found)%length < 4)) then
            content%kind = "foreign"
            content%what = trim(magics(found)%what)
            call name_file(trim(magics(found)%advice), name, content%advice)
         end if
      end if
      if (content%kind /= "text") return
      if (by_name) then
         content%kind = merge("text  ", "binary", all((bytes >= 32 .and. bytes < 127) .or. &
                                                              (bytes >= 9 .and. bytes <= 13)))
         return
      end if
      control(:) = bytes >= 0 .and. bytes <= 31 .and. (bytes < 9 .or. bytes > 13)
      controls = count(control, kind=int64)
      nulls = count(bytes == 0, kind=int64)
      if (controls > 0) content%at = findloc(control, .true., dim=1, kind=int64)
      if (nulls == 0 .and. 20*controls <= size(bytes, kind=int64)) return
      content%kind = "foreign"
      content%what = "binary"
      content%advice = binary_advice
      if (nulls == controls) call explain_nulls(bytes, name, nulls, content)
   end subroutine recognise

   !> Bytes that are 0 and no other control characters: UTF-16 without its mark, or text with holes.
   subroutine explain_nulls(bytes, name, nulls, content)
      integer(int8), intent(in), contiguous :: bytes(:)
      character(*), intent(in) :: name
      integer(int64), intent(in) :: nulls
      type(content_type), intent(inout) :: content
      integer(int64) :: even, digits, others

      even = count(bytes(1::2) == 0, kind=int64)
      digits = count(bytes >= 43 .and. bytes <= 57, kind=int64)        ! signs, points and separators, too
      others = size(bytes, kind=int64) - nulls
      if (any(bytes < 0) .or. 4*digits < others) return
      if (3*nulls > 2*others .and. (20*even < nulls .or. 20*(nulls - even) < nulls)) then
         content%what = "text in UTF-16 without a byte-order mark"
         call name_file("turn it into UTF-8: iconv -f UTF-16"//merge("LE", "BE", 20*even < nulls)// &
                        " -t UTF-8 FILE | gyroakf run -", name, content%advice)
      else if (any(bytes == 10) .or. any(bytes == 13)) then
         content%what = "text with "//integer_text(nulls)//" NUL bytes, as a logger leaves them that lost its power"
         call name_file("leave them out: tr -d '\000' < FILE | gyroakf run -", name, content%advice)
      end if
   end subroutine explain_nulls

end module gyroakf_io_format
