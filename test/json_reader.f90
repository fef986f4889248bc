! SPDX-License-Identifier: MIT
!> Reads a JSON text into a flat list of paths, and compares a document with a schema: for tests only.
!>
!> The path of a member is that of its parent, "/", and its key or its number from 0: "/channels/0/ar/order".
module json_reader
   implicit none (type, external)
   private
   public :: json_item, read_json, json_at, json_real, json_text_at, check_schema, file_text

   !> One value; `text` is "{" or "[" for an object or an array, the token otherwise
   type :: json_item
      character(:), allocatable :: path, text
   end type json_item

contains

   !> Reads a text; `valid` is false where it is not JSON.
   subroutine read_json(text, items, valid)
      character(*), intent(in) :: text
      type(json_item), allocatable, intent(out) :: items(:)
      logical, intent(out) :: valid
      integer :: position, n

      allocate (items(64))
      n = 0
      position = 1
      valid = .true.
      call read_value(text, position, "", items, n, valid)
      call skip_blanks(text, position)
      valid = valid .and. position > len(text)
      call resize(items, n, n)
   end subroutine read_json

   recursive subroutine read_value(text, position, path, items, n, valid)
      character(*), intent(in) :: text, path
      integer, intent(inout) :: position, n
      type(json_item), allocatable, intent(inout) :: items(:)
      logical, intent(inout) :: valid
      character(:), allocatable :: token, key
      character(12) :: digits
      integer :: member
      logical :: is_object

      call next_token(text, position, token)
      valid = valid .and. len(token) > 0
      if (.not. valid) return
      call add_item(items, n, path, token)
      if (token /= "{" .and. token /= "[") then
         valid = is_scalar(token)
         return
      end if
      is_object = token == "{"
      member = 0
      do
         call peek_token(text, position, token)
         if (member == 0 .and. token == merge("}", "]", is_object)) exit
         write (digits, "(i0)") member
         key = trim(digits)
         if (is_object) then
            call next_token(text, position, token)
            valid = valid .and. len(token) > 2 .and. token(1:1) == '"'
            if (.not. valid) return
            key = token(2:len(token) - 1)
            call next_token(text, position, token)
            valid = token == ":"
         end if
         if (valid) call read_value(text, position, path//"/"//key, items, n, valid)
         if (.not. valid) return
         member = member + 1
         call peek_token(text, position, token)
         if (token /= ",") exit
         call next_token(text, position, token)
      end do
      call next_token(text, position, token)
      valid = valid .and. token == merge("}", "]", is_object)
   end subroutine read_value

   !> A number, a string or a literal of JSON.
   pure logical function is_scalar(token)
      character(*), intent(in) :: token
      integer :: digit, i

      is_scalar = token == "null" .or. token == "true" .or. token == "false" .or. token(1:1) == '"'
      if (is_scalar) return
      i = merge(2, 1, token(1:1) == "-")
      if (i > len(token)) return
      digit = verify(token(i:)//" ", "0123456789")
      is_scalar = digit > 1 .and. verify(token, "0123456789.eE+-") == 0 .and. &
                  (digit == 2 .or. token(i:i) /= "0") .and. scan(token(len(token):), "0123456789") == 1
   end function is_scalar

   subroutine peek_token(text, position, token)
      character(*), intent(in) :: text
      integer, intent(in) :: position
      character(:), allocatable, intent(out) :: token
      integer :: after

      after = position
      call next_token(text, after, token)
   end subroutine peek_token

   subroutine next_token(text, position, token)
      character(*), intent(in) :: text
      integer, intent(inout) :: position
      character(:), allocatable, intent(out) :: token
      integer :: last

      call skip_blanks(text, position)
      token = ""
      if (position > len(text)) return
      last = position
      if (text(position:position) == '"') then
         do
            last = last + 1
            if (last > len(text)) return
            if (text(last:last) == "\") then
               last = last + 1
            else if (text(last:last) == '"') then
               exit
            end if
         end do
      else if (scan(text(position:position), "{}[],:") == 0) then
         do while (last < len(text))
            if (scan(text(last + 1:last + 1), "{}[],: "//new_line("a")) > 0) exit
            last = last + 1
         end do
      end if
      token = text(position:last)
      position = last + 1
   end subroutine next_token

   subroutine skip_blanks(text, position)
      character(*), intent(in) :: text
      integer, intent(inout) :: position

      do while (position <= len(text))
         if (scan(text(position:position), " "//new_line("a")//achar(13)) == 0) return
         position = position + 1
      end do
   end subroutine skip_blanks

   subroutine add_item(items, n, path, text)
      type(json_item), allocatable, intent(inout) :: items(:)
      integer, intent(inout) :: n
      character(*), intent(in) :: path, text

      if (n == size(items)) call resize(items, n, 2*n)
      n = n + 1
      items(n)%path = path
      items(n)%text = text
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
      end do
      call move_alloc(longer, items)
   end subroutine resize

   !> Index of a path, 0 where it is not there.
   pure integer function json_at(items, path)
      type(json_item), intent(in) :: items(:)
      character(*), intent(in) :: path

      do json_at = 1, size(items)
         if (len(items(json_at)%path) == len(path)) then
            if (items(json_at)%path == path) return
         end if
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

   !> Compares the document at a path with the schema at a path: types, no key more and no key less; `wrong` is "" where
   !> they agree.
   recursive subroutine check_schema(schema, schema_path, document, path, wrong)
      type(json_item), intent(in) :: schema(:), document(:)
      character(*), intent(in) :: schema_path, path
      character(:), allocatable, intent(inout) :: wrong
      character(:), allocatable :: rule, text, key, part
      integer :: i

      if (len(wrong) > 0) return
      rule = json_text_at(schema, schema_path//"/$ref")
      if (len(rule) > 0) then
         call check_schema(schema, rule(3:len(rule) - 1), document, path, wrong)
         return
      end if
      text = json_text_at(document, path)
      if (.not. allows(schema, schema_path//"/type", text)) wrong = path//": "//text
      part = merge("/properties", "/items     ", text == "{")
      do i = 1, size(document)
         if (.not. is_child(document(i)%path, path)) cycle
         key = document(i)%path(len(path) + 1:)
         if (text == "[") key = ""
         if (json_at(schema, schema_path//trim(part)//key) == 0) wrong = document(i)%path//" is not in the schema"
         call check_schema(schema, schema_path//trim(part)//key, document, document(i)%path, wrong)
      end do
      do i = 1, size(schema)
         if (text /= "{" .or. .not. is_child(schema(i)%path, schema_path//"/properties")) cycle
         key = schema(i)%path(len(schema_path//"/properties") + 1:)
         if (json_at(document, path//key) == 0) wrong = path//key//" is not in the document"
      end do
   end subroutine check_schema

   !> The path is one step below the parent.
   pure logical function is_child(path, parent)
      character(*), intent(in) :: path, parent

      is_child = .false.
      if (len(path) <= len(parent) + 1) return
      if (path(:len(parent)) /= parent .or. path(len(parent) + 1:len(parent) + 1) /= "/") return
      is_child = index(path(len(parent) + 2:), "/") == 0
   end function is_child

   !> The type at a path of the schema allows a token.
   logical function allows(schema, path, token)
      type(json_item), intent(in) :: schema(:)
      character(*), intent(in) :: path, token
      character(:), allocatable :: name
      integer :: i

      select case (token(1:1))
      case ("{"); name = '"object"'
      case ("["); name = '"array"'
      case ('"'); name = '"string"'
      case ("n"); name = '"null"'
      case ("t", "f"); name = '"boolean"'
      case default; name = '"number"'
      end select
      allows = .false.
      do i = 1, size(schema)
         if (schema(i)%path /= path .and. .not. is_child(schema(i)%path, path)) cycle
         if (schema(i)%text == name) allows = .true.
         if (name == '"number"' .and. schema(i)%text == '"integer"' .and. scan(token, ".eE") == 0) allows = .true.
      end do
   end function allows

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
