! SPDX-License-Identifier: MIT
!> The CSV renderer of a description: its members in a line, and the names of the columns; of a
!> list how many values it has.
module gyroakf_report_csv_row
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : format_real
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_description, only : description_type, unknown_type
   use gyroakf_report_text_layout, only : count_text
   implicit none (type, external)
   private
   public :: csv_row_type

   !> Enough for every number of a file that was written with 15 digits
   integer, parameter :: digits = 15

   !> Every member takes a column, known or not, which its title names, or else its key
   type, extends(description_type) :: csv_row_type
      !> Names and values
      character(:), allocatable :: head, line
   contains
      procedure :: begin
      procedure :: close => close_group
      procedure :: value => put_value
      procedure :: values => put_values
   end type csv_row_type

contains

   !> A line has no groups.
   subroutine begin(self, key, list)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list

      self%complete = self%complete .or. key == "" .or. list
   end subroutine begin

   subroutine close_group(self)
      class(csv_row_type), intent(inout) :: self

      self%complete = .true.
   end subroutine close_group

   subroutine put_value(self, key, value)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value
      character(:), allocatable :: text, name

      if (.not. self%member%shown) return
      text = ""
      select type (value)
      type is (real(dp)); text = format_real(value, digits)
      type is (integer); text = count_text(int(value, int64))
      type is (integer(int64)); text = count_text(value)
      type is (logical); text = trim(merge("true ", "false", value))
      type is (character(*)); text = quoted(value)
      type is (unknown_type); if (value%number) text = "nan"
      end select
      name = key
      if (allocated(self%member%title)) name = self%member%title
      if (allocated(self%line)) then
         self%head = self%head//","//name
         self%line = self%line//","//text
      else
         self%head = name
         self%line = text
      end if
   end subroutine put_value

   !> Of a list, how many values it has.
   subroutine put_values(self, key, value)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)

      call put_value(self, key, size(value))
   end subroutine put_values

end module gyroakf_report_csv_row
