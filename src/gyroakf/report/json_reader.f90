! SPDX-License-Identifier: MIT
!> Reads a JSON text into a flat list of paths; strict (RFC 8259), with line and column of what is wrong.
!>
!> The path of a member is that of its parent, "/", and its key or its number from 0: "/channels/0/ar/order".
module gyroakf_report_json_reader
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_place, only : integer_text
   use gyroakf_utf8, only : sequence_length, text_width
   implicit none (type, external)
   private
   public :: json_item, read_json, find_item, text_of

   !> One value
   type :: json_item
      !> "" is the root
      character(:), allocatable :: path
      !> "{" or "[" of an object or an array; the token itself otherwise, a text with its quotes and escapes
      character(:), allocatable :: text
      !> Where it begins, from 1
      integer :: line = 0
   end type json_item

   !> A text that is being read
   type :: parser_type
      type(json_item), allocatable :: item(:)
      integer :: items = 0
      !> The next character; that of the problem where there is one
      integer :: at = 1
      !> Its line
      integer :: line = 1
      character(:), allocatable :: problem
   end type parser_type

   character(1), parameter :: nl = new_line("a")
   character(*), parameter :: white = " "//achar(9)//achar(13)//nl
   !> Deeper nesting is refused
   integer, parameter :: deepest = 64

contains

   !> Reads a whole text.
   subroutine read_json(text, items, error)
      !> UTF-8
      character(*), intent(in) :: text
      !> In the order of the text
      type(json_item), allocatable, intent(out) :: items(:)
      !> parse: "LINE:COLUMN: what is wrong"; the column counts characters from 1
      type(error_type), allocatable, intent(out) :: error
      type(parser_type) :: parser

      allocate (parser%item(256))
      parser%problem = ""
      call read_value(text, "", 1, parser)
      if (parser%problem == "") then
         call skip_white(text, parser)
         if (parser%at <= len(text)) parser%problem = "something follows the end of the document"
      end if
      if (parser%problem /= "") then
         call fatal_error(error, status%parse, place_of(text, parser%at)//": "//parser%problem)
         return
      end if
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
         parser%problem = "the document ends where a value should be"
         return
      end if
      first = text(parser%at:parser%at)
      if (first == "{" .or. first == "[") then
         if (depth > deepest) parser%problem = "nested too deep"
         if (parser%problem /= "") return
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
      if (parser%problem == "") call add_item(parser, path, text(from:parser%at - 1))
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
         if (parser%problem == "") call read_value(text, path//"/"//key, depth + 1, parser)
         if (parser%problem /= "") return
         if (next_is(text, closing, parser)) return
         if (.not. next_is(text, ",", parser)) exit
         member = member + 1
      end do
      parser%problem = "',' or '"//closing//"' is missing"
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
         parser%problem = "the name of a member in quotes is missing"
         return
      end if
      call read_string(text, parser)
      if (parser%problem /= "") return
      key = text(from + 1:parser%at - 2)
      if (.not. next_is(text, ":", parser)) parser%problem = "':' is missing"
   end subroutine read_key

   !> A text in quotes.
   subroutine read_string(text, parser)
      character(*), intent(in) :: text
      type(parser_type), intent(inout) :: parser
      integer :: begin, length

      begin = parser%at
      parser%at = begin + 1
      do while (parser%at <= len(text))
         if (text(parser%at:parser%at) == '"') then
            parser%at = parser%at + 1
            return
         end if
         length = sequence_length(text(parser%at:min(len(text), parser%at + 3)))
         if (text(parser%at:parser%at) == "\") then
            length = escape_length(text(parser%at:min(len(text), parser%at + 5)))
            if (length == 0) parser%problem = "an escape that JSON does not know"
         else if (length == 0) then
            parser%problem = "a byte that is not UTF-8"
         else if (iachar(text(parser%at:parser%at)) < 32) then
            parser%problem = "a control character in a text"
         end if
         if (parser%problem /= "") return
         parser%at = parser%at + length
      end do
      parser%at = begin
      parser%problem = "the quotes are not closed"
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
         if (is_number(word) .or. any(word == [character(5) :: "true", "false", "null"])) then
            parser%at = parser%at + length
         else
            parser%problem = "a value is missing or is none of JSON's"
         end if
      end associate
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

   pure subroutine skip_white(text, parser)
      character(*), intent(in) :: text
      type(parser_type), intent(inout) :: parser

      do while (parser%at <= len(text))
         if (scan(text(parser%at:parser%at), white) == 0) return
         if (text(parser%at:parser%at) == nl) parser%line = parser%line + 1
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
      parser%item(parser%items)%line = parser%line
   end subroutine add_item

   subroutine resize(items, n, length)
      type(json_item), allocatable, intent(inout) :: items(:)
      integer, intent(in) :: n, length
      type(json_item), allocatable :: longer(:)
      integer :: i

      allocate (longer(length))
      do i = 1, n
         call move_alloc(items(i)%path, longer(i)%path)
         call move_alloc(items(i)%text, longer(i)%text)
         longer(i)%line = items(i)%line
      end do
      call move_alloc(longer, items)
   end subroutine resize

   !> "LINE:COLUMN" of a place.
   function place_of(text, at) result(place)
      character(*), intent(in) :: text
      integer, intent(in) :: at
      character(:), allocatable :: place
      integer :: i, line, from

      line = 1
      from = 1
      do i = 1, min(at - 1, len(text))
         if (text(i:i) /= nl) cycle
         line = line + 1
         from = i + 1
      end do
      place = integer_text(int(line, int64))//":"//integer_text(int(text_width(text(from:at - 1)) + 1, int64))
   end function place_of

   !> Index of a path, 0 where it is not there.
   pure integer function find_item(items, path)
      !> A document
      type(json_item), intent(in) :: items(:)
      !> "/input/path"
      character(*), intent(in) :: path

      do find_item = 1, size(items)
         if (len(items(find_item)%path) /= len(path)) cycle
         if (items(find_item)%path == path) return
      end do
      find_item = 0
   end function find_item

   !> A text without its quotes and escapes; another token as it is.
   pure subroutine text_of(token, text)
      !> Of an item
      character(*), intent(in) :: token
      !> UTF-8
      character(:), allocatable, intent(out) :: text
      character(*), parameter :: letters = '"\/bfnrt', meant = '"\/'//achar(8)//achar(12)//nl//achar(13)//achar(9)
      integer :: at, code, place, stat

      text = token
      if (index(token, '"') /= 1) return
      text = ""
      at = 2
      do while (at < len(token))
         if (token(at:at) /= "\") then
            text = text//token(at:at)
            at = at + 1
            cycle
         end if
         place = index(letters, token(at + 1:at + 1))
         if (place > 0) then
            text = text//meant(place:place)
            at = at + 2
         else
            read (token(at + 2:at + 5), "(z4)", iostat=stat) code
            if (stat /= 0) code = int(z"fffd")
            text = text//utf8_of(code)
            at = at + 6
         end if
      end do
   end subroutine text_of

   !> A character of the basic plane in UTF-8; half of a pair is U+FFFD.
   pure function utf8_of(code) result(bytes)
      integer, intent(in) :: code
      character(:), allocatable :: bytes
      integer :: point

      point = code
      if (point >= int(z"d800") .and. point <= int(z"dfff")) point = int(z"fffd")
      if (point < 128) then
         bytes = achar(point)
      else if (point < 2048) then
         bytes = char(192 + point/64)//char(128 + mod(point, 64))
      else
         bytes = char(224 + point/4096)//char(128 + mod(point/64, 64))//char(128 + mod(point, 64))
      end if
   end function utf8_of

end module gyroakf_report_json_reader
