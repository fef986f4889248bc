! SPDX-License-Identifier: MIT
!> Looks into a JSON text by paths, and compares a document with a schema: for tests only.
module json_reader
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_report_json_reader, only : json_item, read_items => read_json, json_at => find_item
   implicit none (type, external)
   private
   public :: json_item, read_json, json_at, json_real, json_text_at, check_schema, file_text

contains

   !> Reads a text; `valid` is false where it is not JSON.
   subroutine read_json(text, items, valid)
      character(*), intent(in) :: text
      type(json_item), allocatable, intent(out) :: items(:)
      logical, intent(out) :: valid
      type(gyro_error), allocatable :: error

      call read_items(text, items, error)
      valid = .not. allocated(error)
      if (.not. valid) allocate (items(0))
   end subroutine read_json

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
