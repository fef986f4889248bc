! SPDX-License-Identifier: MIT
!> Results described once: groups of named values with units and standard errors, that JSON and the
!> text of a report render.
!>
!>     call out%open("adf", "Dickey-Fuller")                         ! "adf": {
!>     call out%put("p_value", 0.03_dp)                              ! "p_value": 0.03
!>     call out%put("rmse", rmse, known=samples > 0, unit="deg/s")   ! null where it is not known
!>     call out%put("path", record%path)                             ! null where it is unallocated
!>     call out%close()                                              ! }
!>
!> A text shows the title; where none is given, the key in words. What is not `shown` stands in JSON
!> only, a remark in texts only.
module gyroakf_report_description
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : text_type
   implicit none (type, external)
   private
   public :: description_type, unknown_type

   !> How people see a member
   type :: member_type
      !> Unallocated where there is none
      character(:), allocatable :: title, unit
      !> Not positive: not known
      real(dp) :: std_error = 0.0_dp
      !> Of each value of a list
      real(dp), allocatable :: std_errors(:)
      logical :: shown = .true.
      !> A description says of what it depends whether it is known
      logical :: may_be_null = .false.
   end type member_type

   !> The value of what is not known
   type :: unknown_type
      logical :: number = .false.
   end type unknown_type

   !> A renderer
   type, abstract :: description_type
      !> The one that is being put
      type(member_type) :: member
      !> It shows remarks, and nothing of what is not known
      logical :: for_people = .false.
      !> It shows the members of a group that is not known, too
      logical :: complete = .false.
   contains
      !> Begins a group of members, or a list of values or groups without keys,
      !> `open(key, title, shown, list)`; the key is "" at the root and in a list
      procedure, non_overridable :: open => open_group
      !> Ends the group or list that was begun last
      procedure(end_group), deferred :: close
      !> Begins a group that may be missing, `opens(key, known, title, shown, list)`: a member
      !> without a value where it is not known
      procedure, non_overridable :: opens
      !> A sentence for people, `remark(text)`: a verdict on the values that follow, or what to mind
      !> about those before
      procedure, non_overridable :: remark
      !> One member, `put(key, value, known, ...)`: what is not known, or a single value that is
      !> absent or unallocated, is null in JSON and nothing in a text
      generic :: put => put_value, put_values
      !> A list of texts, empty where it is unallocated, `put_texts(key, texts, title)`
      procedure, non_overridable :: put_texts
      procedure, private, non_overridable :: put_value, put_values
      procedure(begin_group), deferred :: begin
      procedure(render_value), deferred :: value
      procedure(render_values), deferred :: values
   end type description_type

   abstract interface
      subroutine begin_group(self, key, list)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         logical, intent(in) :: list
      end subroutine begin_group

      subroutine end_group(self)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
      end subroutine end_group

      subroutine render_value(self, key, value)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         !> "" of a remark
         character(*), intent(in) :: key
         !> Real of double precision, integer, logical, text, or `unknown_type`
         class(*), intent(in) :: value
      end subroutine render_value

      subroutine render_values(self, key, value)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         !> Reals of double precision, or texts (`text_type`)
         class(*), intent(in) :: value(:)
      end subroutine render_values
   end interface

contains

   !> Notes how the next member is shown.
   pure subroutine set_member(member, title, unit, std_error, std_errors, shown, known)
      type(member_type), intent(out) :: member
      character(*), intent(in), optional :: title, unit
      real(dp), intent(in), optional :: std_error, std_errors(:)
      logical, intent(in), optional :: shown, known

      if (present(title)) member%title = title
      if (present(unit)) member%unit = unit
      if (present(std_error)) member%std_error = std_error
      if (present(std_errors)) member%std_errors = std_errors
      if (present(shown)) member%shown = shown
      member%may_be_null = present(known)
   end subroutine set_member

   subroutine open_group(self, key, title, shown, list, known)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      character(*), intent(in), optional :: title
      logical, intent(in), optional :: shown, list, known

      call set_member(self%member, title, shown=shown, known=known)
      call self%begin(key, present(list))
   end subroutine open_group

   !> Whether the group is begun.
   logical function opens(self, key, known, title, shown, list)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: known
      character(*), intent(in), optional :: title
      logical, intent(in), optional :: shown, list

      opens = known .or. self%complete
      if (opens) call self%open(key, title, shown, list, known)
      if (.not. opens) call self%put(key)
   end function opens

   subroutine remark(self, text)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: text

      call set_member(self%member)
      if (self%for_people .and. text /= "") call self%value("", trim(text))
   end subroutine remark

   subroutine put_value(self, key, value, known, unit, std_error, title, shown)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in), optional :: value
      logical, intent(in), optional :: known, shown
      character(*), intent(in), optional :: unit, title
      real(dp), intent(in), optional :: std_error
      type(unknown_type) :: nothing
      logical :: given

      call set_member(self%member, title, unit, std_error, shown=shown, known=known)
      given = present(value)
      if (given) then
         select type (value)
         type is (character(*))
         type is (logical)
         class default; nothing%number = .true.
         end select
         if (present(known)) given = known
      end if
      if (given) call self%value(key, value)
      if (.not. (given .or. self%for_people)) call self%value(key, nothing)
   end subroutine put_value

   subroutine put_values(self, key, value, known, std_errors, title, shown)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)
      logical, intent(in), optional :: known, shown
      real(dp), intent(in), optional :: std_errors(:)
      character(*), intent(in), optional :: title
      logical :: given

      given = .true.
      if (present(known)) given = known
      call set_member(self%member, title, std_errors=std_errors, shown=shown, known=known)
      if (given) call self%values(key, value)
      if (.not. given) call self%put(key)
   end subroutine put_values

   subroutine put_texts(self, key, texts, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      type(text_type), intent(in), optional :: texts(:)
      character(*), intent(in), optional :: title
      type(text_type) :: nothing(0)

      if (present(texts)) call self%put(key, texts, title=title)
      if (.not. present(texts)) call self%put(key, nothing)
   end subroutine put_texts

end module gyroakf_report_description
