! SPDX-License-Identifier: MIT
!> Results described once: groups of named values with units and standard errors, that JSON and the text of a report render.
!>
!>     call out%open("adf", "Dickey-Fuller")                         ! "adf": {
!>     call out%put("p_value", 0.03_dp)                              ! "p_value": 0.03
!>     call out%put("rmse", rmse, known=samples > 0, unit="deg/s")   ! null where it is not known
!>     call out%close()                                              ! }
!>
!> A text shows the title; where none is given, the key in words. What has the title "" stands in JSON only.
module gyroakf_report_description
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : text_type
   implicit none (type, external)
   private
   public :: description_type

   !> A renderer
   type, abstract :: description_type
      !> Of the member that is being put; a text unallocated and an error of zero where it has none
      character(:), allocatable :: title, unit
      real(dp) :: std_error = 0.0_dp
   contains
      !> Begins a group of members, `open(key, title)`; the key is "" at the root and in a list
      procedure, non_overridable :: open => open_group
      !> Begins a list of values or groups without keys, `open_list(key, title)`
      procedure, non_overridable :: open_list
      !> Ends the group or list that was begun last
      procedure(end_group), deferred :: close
      !> A member without a value, `absent(key)`
      procedure(put_word), deferred :: absent
      !> One member, `put(key, value, known, ...)`; no value where it is not known (default: it is)
      generic :: put => put_real, put_integer, put_int64, put_logical, put_text, put_reals, put_int64s, put_texts
      !> A text, or no value where it is unallocated or empty, `put_known_text(key, text)`
      procedure, non_overridable :: put_known_text
      procedure, non_overridable :: put_real, put_integer, put_int64, put_logical, put_text, put_reals, put_texts
      procedure, private, non_overridable :: describe
      procedure(begin_group), deferred :: begin
      procedure(render_number), deferred :: number
      procedure(render_count), deferred :: count
      procedure(render_flag), deferred :: flag
      procedure(render_text), deferred :: text
      procedure(render_numbers), deferred :: numbers
      procedure(render_texts), deferred :: texts
      procedure(render_counts), deferred :: put_int64s
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

      subroutine put_word(self, key)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
      end subroutine put_word

      subroutine render_number(self, key, value)
         import :: description_type, dp
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         real(dp), intent(in) :: value
      end subroutine render_number

      subroutine render_count(self, key, value)
         import :: description_type, int64
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         integer(int64), intent(in) :: value
      end subroutine render_count

      subroutine render_flag(self, key, value)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         logical, intent(in) :: value
      end subroutine render_flag

      subroutine render_text(self, key, value)
         import :: description_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key, value
      end subroutine render_text

      subroutine render_numbers(self, key, value)
         import :: description_type, dp
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         real(dp), intent(in) :: value(:)
      end subroutine render_numbers

      subroutine render_counts(self, key, value)
         import :: description_type, int64
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         integer(int64), intent(in) :: value(:)
      end subroutine render_counts

      subroutine render_texts(self, key, value)
         import :: description_type, text_type
         implicit none (type, external)
         class(description_type), intent(inout) :: self
         character(*), intent(in) :: key
         type(text_type), intent(in) :: value(:)
      end subroutine render_texts
   end interface

contains

   !> Notes how the next member is shown to people.
   subroutine describe(self, title, unit, std_error)
      class(description_type), intent(inout) :: self
      character(*), intent(in), optional :: title, unit
      !> Not positive: not known
      real(dp), intent(in), optional :: std_error

      if (allocated(self%title)) deallocate (self%title)
      if (allocated(self%unit)) deallocate (self%unit)
      self%std_error = 0.0_dp
      if (present(title)) self%title = title
      if (present(unit)) self%unit = unit
      if (present(std_error)) self%std_error = std_error
   end subroutine describe

   !> The default is true.
   pure logical function is_known(known)
      logical, intent(in), optional :: known

      is_known = .true.
      if (present(known)) is_known = known
   end function is_known

   subroutine open_group(self, key, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      character(*), intent(in), optional :: title

      call self%describe(title)
      call self%begin(key, .false.)
   end subroutine open_group

   subroutine open_list(self, key, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      character(*), intent(in), optional :: title

      call self%describe(title)
      call self%begin(key, .true.)
   end subroutine open_list

   subroutine put_real(self, key, value, known, unit, std_error, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      real(dp), intent(in) :: value
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: unit
      real(dp), intent(in), optional :: std_error
      character(*), intent(in), optional :: title

      call self%describe(title, unit, std_error)
      if (is_known(known)) then
         call self%number(key, value)
      else
         call self%absent(key)
      end if
   end subroutine put_real

   subroutine put_integer(self, key, value, known, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      integer, intent(in) :: value
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: title

      call self%put_int64(key, int(value, int64), known, title)
   end subroutine put_integer

   subroutine put_int64(self, key, value, known, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      integer(int64), intent(in) :: value
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: title

      call self%describe(title)
      if (is_known(known)) then
         call self%count(key, value)
      else
         call self%absent(key)
      end if
   end subroutine put_int64

   subroutine put_logical(self, key, value, known, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: value
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: title

      call self%describe(title)
      if (is_known(known)) then
         call self%flag(key, value)
      else
         call self%absent(key)
      end if
   end subroutine put_logical

   subroutine put_text(self, key, value, known, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key, value
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: title

      call self%describe(title)
      if (is_known(known)) then
         call self%text(key, value)
      else
         call self%absent(key)
      end if
   end subroutine put_text

   subroutine put_known_text(self, key, value, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      character(:), allocatable, intent(in) :: value
      character(*), intent(in), optional :: title

      call self%describe(title)
      if (allocated(value)) then
         if (len(value) > 0) then
            call self%text(key, value)
            return
         end if
      end if
      call self%absent(key)
   end subroutine put_known_text

   subroutine put_reals(self, key, value, known, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      real(dp), intent(in) :: value(:)
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: title

      call self%describe(title)
      if (is_known(known)) then
         call self%numbers(key, value)
      else
         call self%absent(key)
      end if
   end subroutine put_reals

   subroutine put_texts(self, key, value, known, title)
      class(description_type), intent(inout) :: self
      character(*), intent(in) :: key
      type(text_type), intent(in) :: value(:)
      logical, intent(in), optional :: known
      character(*), intent(in), optional :: title

      call self%describe(title)
      if (is_known(known)) then
         call self%texts(key, value)
      else
         call self%absent(key)
      end if
   end subroutine put_texts

end module gyroakf_report_description
