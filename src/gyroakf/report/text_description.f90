! SPDX-License-Identifier: MIT
!> The text renderer of a description, for a terminal and a page: the outermost groups have a
!> heading, the groups and lists in them a labeled line each, "not white: statistic 2570,
!> p < 1e-20, lags 20", each element of a list a line of its own.
module gyroakf_report_text_description
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_record, only : text_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_text_layout, only : count_text, fixed, if_known, number, p_value_text, &
      put_heading, put_item, put_paragraph, rounded
   implicit none (type, external)
   private
   public :: text_description_type

   !> Longer lists of numbers stand in JSON and CSV only
   integer, parameter :: longest_list = 8
   !> Groups may be nested this deep
   integer, parameter :: max_depth = 16

   !> The line so far
   type, extends(description_type) :: text_description_type
      private
      type(writer_type), pointer :: writer => null()
      integer :: depth = 0
      !> Keys of groups that are not shown
      character(8), allocatable, public :: skip(:)
      !> What keys that end with _s are in: "samples" where no rate is known
      character(7), public :: time_unit = "s"
      !> Groups that are not shown begin below this depth
      integer :: hidden = max_depth
      logical :: list(0:max_depth) = .false.
      !> Length of the line before a group in it
      integer :: start(max_depth) = 0
      !> Of the group at depth 1, until its first line is written
      character(:), allocatable :: heading
      character(:), allocatable :: label, line
   contains
      !> Sets where the text goes, `attach(writer)`
      procedure :: attach
      procedure :: begin
      procedure :: close => close_group
      procedure :: value => put_value
      procedure :: values => put_values
   end type text_description_type

contains

   subroutine attach(self, writer)
      class(text_description_type), intent(inout) :: self
      !> Open; outlives the renderer
      type(writer_type), intent(inout), target :: writer

      self%writer => writer
      self%for_people = .true.
   end subroutine attach

   subroutine begin(self, key, list)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list
      character(:), allocatable :: title, unit
      logical :: shown

      call find_title(self, key, title, shown, unit)
      if (allocated(self%skip)) shown = shown .and. .not. any(self%skip == key)
      if (self%depth == 1 .or. list) call end_line(self)
      self%depth = self%depth + 1
      self%list(self%depth) = list
      if (self%depth > self%hidden) return
      if (.not. shown) then
         self%hidden = self%depth - 1
      else if (self%depth == 1) then
         self%heading = capitalized(title)
         self%label = ""
         self%line = ""
      else if (self%depth == 2 .or. list) then
         self%label = capitalized(title)
      else if (self%list(self%depth - 1)) then
         call end_line(self)
      else
         self%start(self%depth) = len(self%line)
         call add(self, title//" (")
      end if
   end subroutine begin

   !> Writes the line of a group; one in a line ends with its parenthesis, and is nothing where
   !> nothing of it is shown.
   subroutine close_group(self)
      class(text_description_type), intent(inout) :: self

      if (self%depth <= 2 .or. any(self%list(self%depth - 1:self%depth))) then
         call end_line(self)
      else if (self%depth <= self%hidden) then
         self%line = self%line//")"
         if (ends_with(self%line, "()")) self%line = self%line(:self%start(self%depth))
      end if
      if (self%depth == 2 .or. self%list(self%depth)) self%label = ""
      self%list(self%depth) = .false.
      self%depth = self%depth - 1
      if (self%depth <= self%hidden) self%hidden = max_depth
   end subroutine close_group

   !> A number rounded to its error; two decimals where a criterion or a likelihood needs them.
   subroutine put_value(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value
      character(:), allocatable :: title, unit, number_text
      logical :: shown

      call find_title(self, key, title, shown, unit)
      if (.not. shown) return
      select type (value)
      type is (real(dp))
         number_text = rounded(value, self%member%std_error)
         if (abs(value) >= 1e3_dp .and. abs(value) < 1e8_dp .and. &
             .not. self%member%std_error > 0.0_dp) number_text = fixed(value, 2)
         title = title//" "//number_text//unit
         if (key == "p_value" .and. .not. allocated(self%member%title)) title = p_value_text(value)
      type is (integer); title = title//" "//count_text(int(value, int64))
      type is (integer(int64)); title = title//" "//count_text(value)
      type is (logical); if (.not. value) title = "not "//title
      type is (character(*))
         if (key == "") then
            if (self%depth == 1) then
               call end_line(self)
               self%line = value
               call end_line(self)
            else if (self%line == "" .or. ends_with(self%line, "(")) then
               self%line = self%line//value//":"
            else
               self%line = self%line//"; "//value
            end if
            return
         end if
         title = title//" "//value
      end select
      call add(self, trim(adjustl(title)))
   end subroutine put_value

   subroutine put_values(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)
      character(:), allocatable :: title, unit
      logical :: shown
      integer :: i

      call find_title(self, key, title, shown, unit)
      if (.not. shown .or. size(value) == 0) return
      select type (value)
      type is (real(dp))
         if (size(value) > longest_list) return
         do i = 1, size(value)
            if (allocated(self%member%std_errors)) then
               title = title//if_known(i > 1, "; ", " ")// &
                  rounded(value(i), self%member%std_errors(i))
            else
               title = title//" "//number(value(i), 6)
            end if
         end do
      type is (text_type)
         do i = 1, size(value)
            title = title//if_known(i > 1, ";")//" "//value(i)%text
         end do
      end select
      call add(self, title)
   end subroutine put_values

   !> What a member is called, whether it is shown, and its unit: " s" of "tau_s".
   subroutine find_title(self, key, title, shown, unit)
      class(text_description_type), intent(in) :: self
      character(*), intent(in) :: key
      character(:), allocatable, intent(out) :: title
      logical, intent(out) :: shown
      character(:), allocatable, intent(out) :: unit
      character(7) :: name
      integer :: i

      title = key
      i = index(key, "_", back=.true.)
      select case (key(i + 1:))
      case ("s"); name = self%time_unit
      case ("hz"); name = "Hz"
      case ("percent"); name = "%"
      case default; name = ""
      end select
      if (name /= "") title = key(:i - 1)
      unit = if_known(name /= "", " "//trim(name))
      if (allocated(self%member%unit)) unit = " "//self%member%unit
      do i = 1, len(title)
         if (title(i:i) == "_") title(i:i) = " "
      end do
      if (allocated(self%member%title)) title = self%member%title
      shown = self%member%shown .and. self%depth <= self%hidden
   end subroutine find_title

   !> Appends words to the line.
   subroutine add(self, text)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: text

      if (ends_with(self%line, ":")) then
         self%line = self%line//" "
      else if (self%line /= "" .and. .not. ends_with(self%line, "(")) then
         self%line = self%line//", "
      end if
      self%line = self%line//text
   end subroutine add

   !> Whether a text ends with some characters.
   pure logical function ends_with(text, ending)
      character(*), intent(in) :: text, ending

      ends_with = text(max(1, len(text) - len(ending) + 1):) == ending .and. len(text) > 0
   end function ends_with

   !> Writes the line, before it the heading that is waiting.
   subroutine end_line(self)
      class(text_description_type), intent(inout) :: self
      logical :: in_list

      if (self%line == "" .or. self%depth > self%hidden) return
      in_list = any(self%list(2:self%depth))
      ! a remark alone
      if (ends_with(self%line, ":")) self%line = self%line(:len(self%line) - 1)
      if (allocated(self%heading)) then
         call put_heading(self%writer, self%heading)
         deallocate (self%heading)
      end if
      if (self%label == "" .and. .not. in_list) then
         call put_paragraph(self%writer, self%line)
      else
         call put_item(self%writer, self%label, self%line)
      end if
      if (in_list) self%label = ""
      self%line = ""
   end subroutine end_line

   !> With a capital letter in front.
   pure function capitalized(text) result(name)
      character(*), intent(in) :: text
      character(len(text)) :: name

      name = text
      if (len(text) == 0) return
      if (text(1:1) >= "a" .and. text(1:1) <= "z") name(1:1) = achar(iachar(text(1:1)) - 32)
   end function capitalized

end module gyroakf_report_text_description
