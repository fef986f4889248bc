! SPDX-License-Identifier: MIT
!> Reads a JSON text (RFC 8259, strict) into a flat list of paths, looks values up.
!>
!> The path of a member is that of its parent, "/", and its key or its number from 0: "/channels/0/ar/order".
module json_reader
   use gyroakf_kinds, only : int64
   use gyroakf_io_place, only : integer_text
   use gyroakf_utf8, only : sequence_length
   implicit none (type, external)
   private
   public :: json_item, read_json, json_at, json_real, json_text_at, file_text

   !> One value
   type :: json_item
      !> "" is the root
      character(:), allocatable :: path
      !> "{" or "[" of an object or an array; the token itself otherwise, a text with its quotes and escapes
      character(:), allocatable :: text
   end type json_item

   !> Progress of the parser
   type :: parser_type
      type(json_item), allocatable :: item(:)
      integer :: items = 0
      !> The next character
      integer :: at = 1
      logical :: valid = .true.
   end type parser_type

   character(*), parameter :: white = " "//achar(9)//achar(13)//new_line("a")
   !> Deeper nesting is refused
   integer, parameter :: max_depth = 64

contains

   !> Reads a text; `valid` is false where it is not JSON, `items` is empty then.
   subroutine read_json(text, items, valid)
      character(*), intent(in) :: text
      type(json_item), allocatable, intent(out) :: items(:)
      logical, intent(out) :: valid
      type(parser_type) :: parser

      allocate (parser%item(256))
      call read_value(text, "", 1, parser)
      if (parser%valid) call skip_white(text, parser)
      valid = parser%valid .and. parser%at > len(text)
      if (.not. valid) parser%items = 0
      call resize(parser%item, parser%items, parser%items)
      call move_alloc(parser%item, items)
   end subroutine read_json

   !> A value and all that is in it.
   recursive subroutine read_value(text, path, depth, parser)
      character(*), intent(in) :: text, path
      integer, intent(in) :: depth
      type(parser_type), intent(inout) :: parser
      character(1) :: first
      integer :: from

      call skip_white(text, parser)
      if (parser%at > len(text)) then
         parser%valid = .false.
         return
      end if
      first = text(parser%at:parser%at)
      if (first == "{" .or. first == "[") then
         if (depth > max_depth) parser%valid = .false.
         if (.not. parser%valid) return
         call add_item(parser, path, first)
         call read_members(text, path, depth, first == "{", parser)
         return
      end if
      from = parser%at
      if (first == '"') then
         call read_string(text, parser)
      else
         call read_word(text, parser)
      end if
      if (parser%valid) call add_item(parser, path, text(from:parser%at - 1))
   end subroutine read_value

   !> What stands between brackets.
   recursive subroutine read_members(text, path, depth, is_object, parser)
      character(*), intent(in) :: text, path
      integer, intent(in) :: depth
      logical, intent(in) :: is_object
      type(parser_type), intent(inout) :: parser
      character(:), allocatable :: key
      character(1) :: closing
      integer :: member

      closing = merge("}", "]", is_object)
      parser%at = parser%at + 1
      if (next_is(text, closing, parser)) return
      member = 0
      do
         key = integer_text(int(member, int64))
         if (is_object) call read_key(text, key, parser)
         if (parser%valid) call read_value(text, path//"/"//key, depth + 1, parser)
         if (.not. parser%valid) return
         if (next_is(text, closing, parser)) return
         if (.not. next_is(text, ",", parser)) exit
         member = member + 1
      end do
      parser%valid = .false.
   end subroutine read_members

   !> The name of a member and its colon.
   subroutine read_key(text, key, parser)
      character(*), intent(in) :: text
      character(:), allocatable, intent(out) :: key
      type(parser_type), intent(inout) :: parser
      integer :: from

      call skip_white(text, parser)
      key = ""
      from = parser%at
      if (from <= len(text)) key = text(from:from)
      if (key /= '"') then
         parser%valid = .false.
         return
      end if
      call read_string(text, parser)
      if (.not. parser%valid) return
      key = text(from + 1:parser%at - 2)
      if (.not. next_is(text, ":", parser)) parser%valid = .false.
   end subroutine read_key

   !> A text in quotes.
   subroutine read_string(text, parser)
      character(*), intent(in) :: text
      type(parser_type), intent(inout) :: parser
      integer :: length

      parser%at = parser%at + 1
      do while (parser%at <= len(text))
         if (text(parser%at:parser%at) == '"') then
            parser%at = parser%at + 1
            return
         end if
         length = sequence_length(text(parser%at:min(len(text), parser%at + 3)))
         if (text(parser%at:parser%at) == "\") then
            length = escape_length(text(parser%at:min(len(text), parser%at + 5)))
         else if (iachar(text(parser%at:parser%at)) < 32) then
            length = 0
         end if
         parser%valid = length > 0
         if (.not. parser%valid) return
         parser%at = parser%at + length
      end do
      parser%valid = .false.
   end subroutine read_string

   !> Length of an escape, 0 where it is none.
   pure integer function escape_length(text)
      !> Begins with a backslash
      character(*), intent(in) :: text

      escape_length = 0
      if (len(text) < 2) return
      if (scan(text(2:2), '"\/bfnrt') > 0) escape_length = 2
      if (text(2:2) /= "u" .or. len(text) < 6) return
      if (verify(text(3:6), "0123456789abcdefABCDEF") == 0) escape_length = 6
   end function escape_length

   !> A number, true, false or null.
   subroutine read_word(text, parser)
      character(*), intent(in) :: text
      type(parser_type), intent(inout) :: parser
      integer :: length

      length = scan(text(parser%at:), "{}[],:"""//white) - 1
      if (length < 0) length = len(text) - parser%at + 1
      associate (word => text(parser%at:parser%at + length - 1))
         parser%valid = is_number(word) .or. any(word == [character(5) :: "true", "false", "null"])
      end associate
      parser%at = parser%at + length
   end subroutine read_word

   !> A number as JSON writes it: -1.5e-7, not 01, +1, 1. or .5.
   pure logical function is_number(word)
      character(*), intent(in) :: word
      character(*), parameter :: digits = "0123456789"
      integer :: at, n

      is_number = .false.
      at = 1
      if (index(word, "-") == 1) at = 2
      n = verify(word(at:)//" ", digits) - 1
      if (n == 0) return
      if (n > 1 .and. word(at:at) == "0") return
      at = at + n
      if (index(word(at:), ".") == 1) then
         n = verify(word(at + 1:)//" ", digits) - 1
         if (n == 0) return
         at = at + 1 + n
      end if
      if (scan(word(at:), "eE") == 1) then
         at = at + 1
         if (scan(word(at:), "+-") == 1) at = at + 1
         n = verify(word(at:)//" ", digits) - 1
         if (n == 0) return
         at = at + n
      end if
      is_number = at > len(word)
   end function is_number

   !> Whether a character comes next; if so it is passed.
   logical function next_is(text, wanted, parser)
      character(*), intent(in) :: text
      character(1), intent(in) :: wanted
      type(parser_type), intent(inout) :: parser

      call skip_white(text, parser)
      next_is = .false.
      if (parser%at > len(text)) return
      next_is = text(parser%at:parser%at) == wanted
      if (next_is) parser%at = parser%at + 1
   end function next_is

   !> Passes white space.
   pure subroutine skip_white(text, parser)
      character(*), intent(in) :: text
      type(parser_type), intent(inout) :: parser

      do while (parser%at <= len(text))
         if (scan(text(parser%at:parser%at), white) == 0) return
         parser%at = parser%at + 1
      end do
   end subroutine skip_white

   !> Appends a value.
   subroutine add_item(parser, path, token)
      type(parser_type), intent(inout) :: parser
      character(*), intent(in) :: path, token

      if (parser%items == size(parser%item)) call resize(parser%item, parser%items, 2*parser%items)
      parser%items = parser%items + 1
      parser%item(parser%items)%path = path
      parser%item(parser%items)%text = token
   end subroutine add_item

   !> Changes the length of a list and keeps its first n values.
   subroutine resize(items, n, length)
      type(json_item), allocatable, intent(inout) :: items(:)
      integer, intent(in) :: n, length
      type(json_item), allocatable :: longer(:)
      integer :: i

      allocate (longer(length))
      do i = 1, n
         call move_alloc(items(i)%path, longer(i)%path)
         call move_alloc(items(i)%text, longer(i)%text)
      end do
      call move_alloc(longer, items)
   end subroutine resize

   !> Index of a path, 0 where it is not there.
   pure integer function json_at(items, path)
      !> A document
      type(json_item), intent(in) :: items(:)
      !> "/input/path"
      character(*), intent(in) :: path

      do json_at = 1, size(items)
         if (len(items(json_at)%path) /= len(path)) cycle
         if (items(json_at)%path == path) return
      end do
      json_at = 0
   end function json_at

   !> The token at a path, "" where there is none.
   function json_text_at(items, path) result(text)
      type(json_item), intent(in) :: items(:)
      character(*), intent(in) :: path
      character(:), allocatable :: text
      integer :: i

      text = ""
      i = json_at(items, path)
      if (i > 0) text = items(i)%text
   end function json_text_at

   !> The number at a path, -huge where there is none.
   real(kind(1.0d0)) function json_real(items, path)
      type(json_item), intent(in) :: items(:)
      character(*), intent(in) :: path
      character(:), allocatable :: text
      integer :: stat

      json_real = -huge(json_real)
      text = json_text_at(items, path)
      read (text, *, iostat=stat) json_real
      if (stat /= 0) json_real = -huge(json_real)
   end function json_real

   !> The whole content of a file, "" where it cannot be read.
   function file_text(path) result(text)
      character(*), intent(in) :: path
      character(:), allocatable :: text
      integer :: unit, length, stat

      text = ""
      inquire (file=path, size=length)
      if (length <= 0) return
      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", action="read", iostat=stat)
      if (stat /= 0) return
      deallocate (text)
      allocate (character(length) :: text)
      read (unit, iostat=stat) text
      if (stat /= 0) text = ""
      close (unit)
   end function file_text

end module json_reader
