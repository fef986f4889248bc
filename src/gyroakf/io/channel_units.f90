! SPDX-License-Identifier: MIT
!> The units of a record's channels: from an option, else the header, else the names of columns.
!>
!> One unit for all is the usual case; a file with gyroscopes and accelerometers has several.
module gyroakf_io_channel_units
   use gyroakf_column_class, only : class_names, column_class, find_unit, unit_fits
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, record_type
   use gyroakf_units, only : is_integral, parse_units, quantity, recognize_unit, unit_type
   implicit none (type, external)
   private
   public :: set_units

contains

   !> Fills the record's unit, or its channels' where they differ, and who gave them.
   subroutine set_units(given, input, table, record, error)
      !> From an option: one unit, or one for each channel separated by commas; "" for none
      character(*), intent(in) :: given
      !> "rate", "increment" or "angle"
      character(*), intent(in) :: input
      type(table_type), intent(in) :: table
      !> Its channels are named; `unit`, `channel_unit`, `unit_source` are filled
      type(record_type), intent(inout) :: record
      !> invalid_argument: unknown units, of another quantity, of an angle for a rate, or too few
      type(error_type), allocatable, intent(out) :: error
      type(unit_type), allocatable :: unit(:)
      integer :: j

      allocate (unit(size(record%channel)))
      record%unit%name = ""
      record%unit_source = merge("option", "header", given /= "")
      call units_of_header(table, record, unit)
      if (all(unit%quantity == quantity%unknown)) call units_of_names(input, table, unit)
      do j = 1, size(unit)
         if (given /= "") then
            if ((input == "rate") .eqv. is_integral(unit(j))) unit(j) = unit_type()
         else if (input == "rate" .and. unit(j)%quantity == quantity%velocity) then
            unit(j) = unit_type()
         end if
      end do
      if (given /= "") call units_of_option(given, table, record, unit, error)
      if (allocated(error)) return
      do j = 1, size(unit)
         if (unit(j)%quantity == quantity%unknown) cycle
         call check_quantity(unit(j), input, record, error)
         if (allocated(error) .or. record%unit_source == "none") return
      end do
      if (all(unit%quantity == quantity%unknown)) then
         record%unit_source = "none"
         return
      end if
      do j = 1, size(unit)
         if (unit(j)%quantity == quantity%unknown) unit(j)%name = ""
      end do
      if (all([(unit(j)%name == unit(1)%name, j=2, size(unit))])) then
         record%unit = unit(1)
      else
         call move_alloc(unit, record%channel_unit)
      end if
   end subroutine set_units

   !> Class of the column that a channel was; unknown where it was an array of the caller.
   pure integer function class_of_channel(table, j)
      type(table_type), intent(in) :: table
      integer, intent(in) :: j

      class_of_channel = column_class%unknown
      if (allocated(table%class)) class_of_channel = table%class(table%chosen(j))
   end function class_of_channel

   !> One for all channels whose quantity it may be, or one for each.
   subroutine units_of_option(given, table, record, unit, error)
      character(*), intent(in) :: given
      type(table_type), intent(in) :: table
      type(record_type), intent(in) :: record
      type(unit_type), intent(inout) :: unit(:)
      type(error_type), allocatable, intent(out) :: error
      type(unit_type), allocatable :: list(:)
      character(:), allocatable :: names
      logical, allocatable :: fits(:)
      integer :: j, refused

      call parse_units(given, list, error)
      if (allocated(error)) return
      if (size(list) > 1 .and. size(list) /= size(unit)) then
         names = ""
         do j = 1, min(size(unit), 12)
            names = names//" "//record%channel(j)%text
         end do
         if (size(unit) > 12) names = names//" ..."
         call fatal_error(error, status%invalid_argument, "`unit` names "// &
            integer_text(size(list))//" units, but the number of channels is "// &
            integer_text(size(unit))//" ("//names(2:)// &
            "): give one unit for all of them, or one for each")
         return
      end if
      fits = [(unit_fits(class_of_channel(table, j), list(min(j, size(list)))), j=1, size(unit))]
      refused = findloc(fits, .false., dim=1)
      if (size(list) == 1 .and. any(fits)) refused = 0
      if (refused > 0) call fatal_error(error, status%invalid_argument, "the unit "// &
         list(refused)%name//" does not fit '"//record%channel(refused)%text// &
         "', by its name or unit in the file a column of class "// &
         trim(class_names(class_of_channel(table, refused)))//": give `columns` or another `unit`")
      if (allocated(error)) return
      do j = 1, size(unit)
         if (fits(j)) unit(j) = list(min(j, size(list)))
      end do
   end subroutine units_of_option

   !> The header's unit, or its list of units: one for each column, with or without the time's.
   subroutine units_of_header(table, record, unit)
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record
      type(unit_type), intent(inout) :: unit(:)
      integer :: j, column, listed

      listed = 0
      if (allocated(table%header%units)) listed = size(table%header%units)
      if (listed == 0) then
         do j = 1, size(unit)
            if (unit_fits(class_of_channel(table, j), table%header%unit)) unit(j) = &
               table%header%unit
         end do
         if (all(unit%quantity == quantity%unknown)) unit(:) = table%header%unit
         return
      end if
      if (listed /= table%layout%columns .and. &
         (listed /= table%layout%columns - 1 .or. table%time == 0)) then
         call add_text(record%warnings, "the header lists "//integer_text(listed)//" units, "// &
            "the file has "//integer_text(table%layout%columns)//" columns; they are ignored")
         return
      end if
      do j = 1, size(unit)
         column = table%chosen(j)
         if (listed < table%layout%columns .and. table%time < column) column = column - 1
         call recognize_unit(table%header%units(column)%text, unit(j))
      end do
   end subroutine units_of_header

   !> The units that stand in brackets behind the names of the columns, or at the end of the names.
   subroutine units_of_names(input, table, unit)
      character(*), intent(in) :: input
      type(table_type), intent(in) :: table
      type(unit_type), intent(inout) :: unit(:)
      integer :: j

      if (.not. table%names%known) return
      do j = 1, size(unit)
         associate (column => table%chosen(j))
            call find_unit(table%names%name(column)%text, table%names%unit(column)%text, unit(j))
            if (.not. unit_fits(table%class(column), unit(j))) unit(j) = unit_type()
            if (len(table%names%unit(column)%text) == 0 .and. &
               ((input == "rate") .eqv. is_integral(unit(j)))) unit(j) = unit_type()
         end associate
      end do
   end subroutine units_of_names

   !> A unit of the other kind, angle or rate: an error from an option, a warning from the file.
   subroutine check_quantity(unit, input, record, error)
      type(unit_type), intent(in) :: unit
      character(*), intent(in) :: input
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      logical :: angles

      angles = input /= "rate"
      if (angles .eqv. is_integral(unit)) return
      if (record%unit_source == "header") then
         call add_text(record%warnings, "the header's unit "//unit%name// &
            " does not fit `input` "// &
            trim(merge("increment or angle", "rate              ", angles))//" and is ignored")
         record%unit_source = "none"
      else if (angles) then
         call fatal_error(error, status%invalid_argument, "`input` "//input// &
            " needs the unit of an angle (deg, rad, arcsec), not "//unit%name// &
            "; increments of a velocity have m/s")
      else
         call fatal_error(error, status%invalid_argument, "the unit "//unit%name//" is that of "// &
            trim(merge("a velocity", "an angle  ", unit%quantity == quantity%velocity))// &
            ": give `input` increment or `input` angle, or the unit of a rate")
      end if
   end subroutine check_quantity

end module gyroakf_io_channel_units
