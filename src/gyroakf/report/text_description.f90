! SPDX-License-Identifier: MIT
!> The text renderer of a description, for a terminal and a page: the outermost groups have a heading, the groups in them a
!> labeled line each, "statistic 2570, p < 1e-20, lags 20".
module gyroakf_report_text_description
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_record, only : text_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_text_layout, only : count_text, fixed, number, p_value_text, put_heading, put_item, put_paragraph, rounded
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
      !> Where the text goes
      type(writer_type), pointer, public :: writer => null()
      integer :: depth = 0
      !> Keys of groups that are not shown
      character(8), allocatable, public :: skip(:)
      !> Groups that are not shown begin below this depth
      integer :: hidden = max_depth
      logical :: list(0:max_depth) = .false.
      !> Length of the line before a group in it
      integer :: start(max_depth) = 0
      !> Of the group at depth 1, until its first line is written
      character(:), allocatable :: heading
      character(:), allocatable :: label, line
   contains
      procedure :: begin
      procedure :: close => close_group
      procedure :: absent
      procedure :: number => put_number
      procedure :: count => put_count
      procedure :: flag
      procedure :: text => put_words
      procedure :: numbers
      procedure :: texts
   end type text_description_type

contains

   !> A heading at depth 1, a line at depth 2 and for each element of a list there, words in the line below.
   subroutine begin(self, key, list)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list
      character(:), allocatable :: title

      call title_of(self, key, title)
      if (allocated(self%skip)) then
         if (any(self%skip == key)) title = ""
      end if
      if (self%depth == 1) call end_line(self)
      self%depth = self%depth + 1
      self%list(self%depth) = list
      if (self%depth > self%hidden) return
      if (title == "" .and. key /= "") then
         self%hidden = self%depth - 1
      else if (self%depth == 1) then
         self%heading = capitalized(title)
         self%label = ""
         self%line = ""
      else if (self%depth == 2) then
         self%label = capitalized(title)
      else if (self%list(self%depth - 1)) then
         call end_line(self)
      else
         self%start(self%depth) = len(self%line)
         call add(self, title//" (")
      end if
   end subroutine begin

   !> Writes the line of a group.
   subroutine close_group(self)
      class(text_description_type), intent(inout) :: self

      if (self%depth <= 2 .or. self%list(max(self%depth - 1, 0))) then
         call end_line(self)
      else if (self%depth <= self%hidden) then
         if (self%line(max(1, len(self%line)):) == "(") then
            self%line = self%line(:self%start(self%depth))
         else
            self%line = self%line//")"
         end if
      end if
      if (self%depth == 2) then
         self%label = ""
         self%list(2) = .false.
      end if
      self%depth = self%depth - 1
      if (self%depth <= self%hidden) self%hidden = max_depth
   end subroutine close_group

   !> Nothing: what is not known is left out.
   subroutine absent(self, key)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key

      if (len(key) > 0 .and. allocated(self%title)) deallocate (self%title)
   end subroutine absent

   subroutine put_number(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      real(dp), intent(in) :: value
      character(:), allocatable :: title, unit

      call title_of(self, key, title)
      if (title == "" .and. key /= "") return
      unit = unit_of(key)
      if (allocated(self%unit)) unit = " "//self%unit
      if (key == "p_value" .and. .not. allocated(self%title)) then
         call add(self, p_value_text(value))
      else
         call add(self, trim(title//" "//value_text(value, self%std_error))//unit)
      end if
   end subroutine put_number

   subroutine put_count(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      integer(int64), intent(in) :: value
      character(:), allocatable :: title

      call title_of(self, key, title)
      if (title /= "") call add(self, title//" "//count_text(value))
   end subroutine put_count

   !> "stationary", "not stationary".
   subroutine flag(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: value
      character(:), allocatable :: title

      call title_of(self, key, title)
      if (title /= "") call add(self, trim(merge("    ", "not ", value))//repeat(" ", merge(0, 1, value))//title)
   end subroutine flag

   subroutine put_words(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key, value
      character(:), allocatable :: title

      call title_of(self, key, title)
      if (title /= "" .or. key == "") call add(self, trim(title//" "//value))
   end subroutine put_words

   subroutine numbers(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      real(dp), intent(in) :: value(:)
      character(:), allocatable :: title
      integer :: i

      call title_of(self, key, title)
      if (title == "" .or. size(value) == 0 .or. size(value) > longest_list) return
      do i = 1, size(value)
         title = title//" "//number(value(i), 6)
      end do
      call add(self, title)
   end subroutine numbers

   subroutine texts(self, key, value)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: key
      type(text_type), intent(in) :: value(:)
      character(:), allocatable :: title
      integer :: i

      call title_of(self, key, title)
      if (title == "" .or. size(value) == 0) return
      do i = 1, size(value)
         if (i > 1) title = title//";"
         title = title//" "//value(i)%text
      end do
      call add(self, title)
   end subroutine texts

   !> What a member is called, "" where it is not shown.
   subroutine title_of(self, key, title)
      class(text_description_type), intent(in) :: self
      character(*), intent(in) :: key
      character(:), allocatable, intent(out) :: title
      integer :: i

      title = key
      i = index(key, "_", back=.true.)
      if (unit_of(key) /= "") title = key(:i - 1)
      do i = 1, len(title)
         if (title(i:i) == "_") title(i:i) = " "
      end do
      if (allocated(self%title)) title = self%title
      if (self%depth > self%hidden) title = ""
   end subroutine title_of

   !> " s" of "tau_s".
   pure function unit_of(key) result(unit)
      character(*), intent(in) :: key
      character(:), allocatable :: unit

      select case (key(index(key, "_", back=.true.) + 1:))
      case ("s"); unit = " s"
      case ("hz"); unit = " Hz"
      case ("percent"); unit = " %"
      case default; unit = ""
      end select
   end function unit_of

   !> Appends words to the line.
   subroutine add(self, text)
      class(text_description_type), intent(inout) :: self
      character(*), intent(in) :: text

      if (self%depth > self%hidden) return
      if (self%line == "") then
         self%line = text
      else if (self%line(len(self%line):) == "(") then
         self%line = self%line//text
      else
         self%line = self%line//", "//text
      end if
   end subroutine add

   !> Writes the line, before it the heading that is waiting.
   subroutine end_line(self)
      class(text_description_type), intent(inout) :: self

      if (self%line == "" .or. self%depth > self%hidden) return
      if (allocated(self%heading)) then
         call put_heading(self%writer, self%heading)
         deallocate (self%heading)
      end if
      if (self%label == "" .and. .not. self%list(2)) then
         call put_paragraph(self%writer, self%line, 2)
      else
         call put_item(self%writer, self%label, self%line)
      end if
      if (self%list(2)) self%label = ""
      self%line = ""
   end subroutine end_line

   !> Rounded to the error; two decimals where a criterion or a likelihood needs them.
   pure function value_text(value, std_error) result(text)
      real(dp), intent(in) :: value, std_error
      character(:), allocatable :: text

      if (abs(value) >= 1e3_dp .and. abs(value) < 1e8_dp .and. .not. std_error > 0.0_dp) then
         text = fixed(value, 2)
      else
         text = rounded(value, std_error)
      end if
   end function value_text

   !> With a capital letter in front.
   pure function capitalized(text) result(name)
      character(*), intent(in) :: text
      character(len(text)) :: name

      name = text
      if (len(text) == 0) return
      if (text(1:1) >= "a" .and. text(1:1) <= "z") name(1:1) = achar(iachar(text(1:1)) - 32)
   end function capitalized

end module gyroakf_report_text_description
