! SPDX-License-Identifier: MIT
!> doc/schema.json is what the descriptions of the results say: keys, their order, their types and what may be null.
!> Sentences and the like, and which groups stand in "$defs" ("$ref"), are those of the file that is there.
module test_schema
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_description, only : description_type, unknown_type
   use gyroakf_report_document, only : put_document
   use json_reader, only : file_text, json_at, json_item, json_text_at, read_json
   use report_fixture, only : fill_drift, make_record, make_result
   implicit none (type, external)
   private
   public :: suite_schema

   !> A place of the schema, and what was seen there
   type :: place_type
      !> As "/properties/input/properties/path"
      character(:), allocatable :: path
      !> "object", "array", "string", "number", "integer", "boolean"; "" not known
      character(7) :: kind = ""
      logical :: number = .false., may_be_null = .false.
      integer :: seen = 0, opened = 0
   end type place_type

   type, extends(description_type) :: schema_type
      type(json_item), allocatable :: old(:)
      type(place_type) :: place(999)
      integer :: places = 0
      !> Groups that are open, the first one is the root
      integer :: depth = 0, group(32) = 0
   contains
      procedure :: begin
      procedure :: close => end_group
      procedure :: value => see_value
      procedure :: values => see_values
   end type schema_type

   !> What is taken from the schema that is there, before and behind the type
   character(*), parameter :: before(3) = [character(11) :: "$schema", "title", "const"]
   character(*), parameter :: behind(3) = [character(11) :: "minimum", "enum", "description"]
   character(1), parameter :: lf = new_line("a")

contains

   subroutine suite_schema()
      call test("document", test_document)
      call test("small", test_small)
   end subroutine suite_schema

   !> Documents in which everything is known, nothing is, and there are no channels; one with what is not allocated.
   subroutine test_document()
      type(schema_type) :: out
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text, wrong
      logical :: valid
      integer :: unit

      call read_json(file_text("doc/schema.json"), out%old, valid)
      call check(error, valid, "doc/schema.json is read from the root of the repository")
      call make_record(record, .true.)
      call make_result(record, result)
      call fill_drift(record, result%channel(1))
      deallocate (result%channel(1)%clean%trend%power)
      call put_document(out, record, result)
      result%channel(1)%clean%trend%power = [0.0_dp]
      record%stored_type = "float64"
      associate (channel => result%channel(1))
         channel%clean%half_width = 1
         channel%clean%motion = reshape([1, 2], [2, 1])
         channel%adf%lag_chosen = .true.
         channel%verdict%trend%shape = "ramp"
         channel%verdict%drifts = .true.
         channel%drift_doubt = "a reason"
         allocate (channel%ar%root(1))
         channel%ar%residual_normality%kurtosis = 3
         channel%allan(stage%input)%other = [channel%allan(stage%input)%curve]
         channel%allan(stage%input)%noise%tau = [1.0_dp]
         channel%allan(stage%input)%noise%residual = [1.0_dp]
      end associate
      call put_document(out, record, result, "gyroakf run")
      deallocate (record%path, record%format, record%rate_source, record%unit_source, record%stored_type)
      deallocate (result%channel)
      allocate (result%channel(1))
      allocate (result%channel(1)%allan(6))
      result%channel(1)%name = "gx"
      call put_document(out, record, result)
      call put_document(out, record)
      call write_schema(out, text, wrong)
      if (text == file_text("doc/schema.json")) return
      open (newunit=unit, file="build/schema.json", access="stream", form="unformatted", status="replace")
      write (unit) text
      close (unit)
      call check(error, wrong, "", "no sentence, or no value in a document, for "//wrong)
      call check(error, .false., "doc/schema.json is not what the descriptions say: cp build/schema.json doc/schema.json")
   end subroutine test_document

   !> What is new has no sentence; types and what may be null come from the description.
   subroutine test_small()
      type(schema_type) :: out
      character(:), allocatable :: text, wrong
      logical :: valid

      call read_json('{"properties":{"a":{"description":"A","enum":["x",null]},"b":{"type":"string"}}}', out%old, valid)
      call out%open("")
      call out%put("a", "x", .true.)
      call out%put("b", 1.0_dp)
      call out%close()
      call write_schema(out, text, wrong)
      call check(error, wrong, "/properties/b")
      call check(error, text, '{"type": "object",'//lf//'  "required": ["a", "b"],'//lf//'  "properties": {'//lf// &
                 '    "a": {"type": ["string", "null"], "enum": ["x", null], "description": "A"},'//lf// &
                 '    "b": {"type": ["number", "null"]}'//lf//"  }}"//lf)
   end subroutine test_small

   !> Notes what was seen at a path, and where it leads.
   recursive integer function place_of(self, path, kind, may_be_null) result(i)
      class(schema_type), intent(inout) :: self
      character(*), intent(in) :: path, kind
      logical, intent(in) :: may_be_null
      character(:), allocatable :: refers

      refers = json_text_at(self%old, path//"/$ref")
      do i = 1, self%places
         if (self%place(i)%path == path) exit
      end do
      self%places = max(self%places, i)
      associate (place => self%place(i))
         place%path = path
         place%seen = place%seen + 1
         place%may_be_null = place%may_be_null .or. may_be_null
         if (kind /= "") place%kind = kind
      end associate
      if (refers /= "") i = place_of(self, refers(3:len(refers) - 1), kind, may_be_null)
   end function place_of

   !> The path of a key in the group that was opened last.
   function path_of(self, key) result(path)
      class(schema_type), intent(in) :: self
      character(*), intent(in) :: key
      character(:), allocatable :: path

      path = ""
      if (self%depth == 0) return
      associate (group => self%place(self%group(self%depth)))
         path = group%path//"/properties/"//key
         if (group%kind == "array") path = group%path//"/items"
         if (json_at(self%old, group%path//"/additionalProperties") > 0) path = group%path//"/additionalProperties"
      end associate
   end function path_of

   subroutine begin(self, key, list)
      class(schema_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list
      integer :: i

      i = place_of(self, path_of(self, key), merge("array ", "object", list), self%member%may_be_null)
      self%place(i)%opened = self%place(i)%opened + 1
      self%depth = self%depth + 1
      self%group(self%depth) = i
   end subroutine begin

   subroutine end_group(self)
      class(schema_type), intent(inout) :: self

      self%depth = self%depth - 1
   end subroutine end_group

   !> A value; a real may be NaN, and null.
   subroutine see_value(self, key, value)
      class(schema_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value
      character(7) :: kind
      logical :: number
      integer :: i

      number = .false.
      kind = ""
      select type (value)
      type is (real(dp)); kind = "number"
      type is (logical); kind = "boolean"
      type is (character(*)); kind = "string"
      type is (unknown_type); number = value%number
      class default; kind = "integer"
      end select
      i = place_of(self, path_of(self, key), kind, self%member%may_be_null .or. any(kind == ["number", "      "]))
      self%place(i)%number = self%place(i)%number .or. number
   end subroutine see_value

   subroutine see_values(self, key, value)
      class(schema_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)

      call self%begin(key, .true.)
      self%member%may_be_null = .false.
      select type (value)
      type is (real(dp)); call self%value("", 0.0_dp)
      type is (text_type); call self%value("", "")
      class default; call self%value("", 0)
      end select
      call self%close()
   end subroutine see_values

   !> The whole schema.
   subroutine write_schema(self, text, wrong)
      type(schema_type), intent(in) :: self
      character(:), allocatable, intent(out) :: text
      !> The first place without a sentence or a type, "" where there is none
      character(:), allocatable, intent(out) :: wrong

      text = ""
      wrong = ""
      call write_place(self, 1, 0, text, wrong)
      text = text//lf
   end subroutine write_schema

   !> A place: on one line, or what is in it on a line each.
   recursive subroutine write_place(self, i, depth, text, wrong)
      type(schema_type), intent(in) :: self
      integer, intent(in) :: i, depth
      character(:), allocatable, intent(inout) :: text, wrong
      character(:), allocatable :: path
      character(7) :: kind
      integer :: start, k

      path = self%place(i)%path
      associate (place => self%place(i))
         text = text//"{"
         start = len(text)
         kind = place%kind
         if (kind == "" .and. place%number) kind = "number"
         call write_facts(before)
         if (json_at(self%old, path//"/$ref") > 0) then
            call write_facts(["$ref"])
         else if (place%may_be_null) then
            call add_fact("type", '["'//trim(kind)//'", "null"]')
         else
            call add_fact("type", '"'//trim(kind)//'"')
         end if
         call write_facts(behind)
         if (json_at(self%old, path//"/$ref") == 0) then
            if (wrong == "" .and. (kind == "" .or. (json_at(self%old, path//"/description") == 0 .and. &
                index(path, "/properties/", back=.true.) > index(path, "/items", back=.true.)))) wrong = path
            do k = 1, self%places
               if (all(self%place(k)%path /= path//[character(21) :: "/items", "/additionalProperties"])) cycle
               call add_fact(self%place(k)%path(len(path) + 2:), "")
               call write_place(self, k, depth, text, wrong)
            end do
            if (wrong == "" .and. kind == "array" .and. index(text, '"items": ', back=.true.) < start) wrong = path//"/items"
            call write_children("/properties")
            if (depth == 0) call write_children("/$defs")
         end if
         text = text//"}"
      end associate

   contains

      subroutine add_fact(name, fact)
         character(*), intent(in) :: name, fact

         if (text(len(text):) /= "{") text = text//", "
         text = text//'"'//trim(name)//'": '//fact
      end subroutine add_fact

      subroutine write_facts(names)
         character(*), intent(in) :: names(:)
         character(:), allocatable :: fact, where
         integer :: n, k

         do n = 1, size(names)
            where = path//"/"//trim(names(n))
            fact = json_text_at(self%old, where)
            if (fact == "") cycle
            if (fact == "[") then
               k = json_at(self%old, where) + 1
               do while (index(self%old(k)%path, where//"/") == 1)
                  fact = fact//self%old(k)%text//", "
                  k = k + 1
               end do
               fact = fact(:len(fact) - 2)//"]"
            end if
            call add_fact(names(n), fact)
         end do
      end subroutine write_facts

      !> The names of those that are always there, and all; nothing where there are none.
      subroutine write_children(part)
         character(*), intent(in) :: part
         character(:), allocatable :: parent, required, name, indent, children
         integer :: k

         parent = path//part//"/"
         indent = lf//repeat("  ", depth + 1)
         required = ""
         children = ""
         do k = 1, self%places
            if (index(self%place(k)%path, parent) /= 1) cycle
            name = self%place(k)%path(len(parent) + 1:)
            if (index(name, "/") > 0) cycle
            if (self%place(k)%seen == self%place(i)%opened) required = required//', "'//name//'"'
            children = children//","//indent//'  "'//name//'": '
            call write_place(self, k, depth + 2, children, wrong)
         end do
         if (children == "") return
         if (part == "/properties") text = text//","//indent//'"required": ['//required(3:)//"]"
         text = text//","//indent//'"'//part(2:)//'": {'//children(2:)//indent//"}"
         if (depth > 0 .or. part == "/$defs") text = text//lf//repeat("  ", depth)
      end subroutine write_children

   end subroutine write_place

end module test_schema
