! SPDX-License-Identifier: MIT
!> What comment lines say: `# rate_hz: 5`, `# dt = 0.2`, `# unit: deg/h`, `# columns: t gx gy`.
!>
!> The first number counts; a value that cannot be understood is a warning, never an error.
module gyroakf_io_header
   use gyroakf_kinds, only : dp, int64
   use gyroakf_column_class, only : noteless_length
   use gyroakf_io_columns, only : column_names_type, names_way, read_names
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_number, only : number, scan_number
   use gyroakf_io_place, only : integer_text, shown_bytes
   use gyroakf_io_text, only : bytes_text, fields_type, first_visible, last_visible, split_line
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : quantity, recognize_unit, time_scale, unit_type
   implicit none (type, external)
   private
   public :: header_type, read_comment, smallest_rate, largest_rate

   !> Hz; what lies outside is no rate (and products of times would overflow)
   real(dp), parameter :: smallest_rate = 1.0e-30_dp, largest_rate = 1.0e30_dp

   !> What the header says
   type :: header_type
      !> Hz; 0 where it says none
      real(dp) :: rate_hz = 0.0_dp
      !> Of the values; quantity unknown where it says none
      type(unit_type) :: unit
      !> Of each column, as written: [column], with or without the time's; unallocated for none
      type(text_type), allocatable :: units(:)
      !> What could not be understood of the units: of no account where the user gives one
      type(text_type), allocatable :: unit_warnings(:)
      !> From the key `columns`
      type(column_names_type) :: names
   end type header_type

contains

   !> Takes in one comment line. A rate may stand behind other keys and their values.
   subroutine read_comment(lines, header, warnings)
      type(lines_type), intent(in) :: lines
      type(header_type), intent(inout) :: header
      type(text_type), allocatable, intent(inout) :: warnings(:)
      integer(int64) :: first, from, last, mark
      character(:), allocatable :: key

      from = lines%at - 1 + verify(bytes_text(lines%bytes, lines%at, lines%to)//"x", "#%;/! "// &
         achar(9))
      first = from
      do
         do mark = from, lines%to
            if (any(lines%bytes(mark) == iachar([":", "="]))) exit
         end do
         if (mark > lines%to .or. (from == first .and. mark - from > 32)) return
         key = lower(bytes_text(lines%bytes, from, last_visible(lines%bytes, from, mark - 1)))
         key = trim(adjustl(key(scan(key, ",;", back=.true.) + 1:)))
         from = first_visible(lines%bytes, mark + 1, lines%to)
         last = last_visible(lines%bytes, from, lines%to)
         select case (key)
         case ("rate_hz", "dt", "sample rate", "sampling rate", "update rate", "data rate", &
            "data_rate", "sample_rate", "sampling_rate", "sampling frequency")
            call read_rate(lines, from, key, header, warnings)
            return
         case ("unit", "units")
            if (mark > first + 6) cycle
            call read_unit(lines, from, last, key, header)
            return
         case ("columns")
            if (from <= last) call read_names(lines%bytes, from, last, lines%number, header%names)
            return
         case default
            continue
         end select
      end do
   end subroutine read_comment

   !> Keys `rate_hz` and `dt`, in Hz and seconds unless a unit follows; where an earlier line said
   !> another rate, the later counts and a warning says so.
   subroutine read_rate(lines, first, key, header, warnings)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: first
      character(*), intent(in) :: key
      type(header_type), intent(inout) :: header
      type(text_type), allocatable, intent(inout) :: warnings(:)
      character(:), allocatable :: word
      integer(int64) :: p
      integer :: found
      real(dp) :: x, scale

      p = first
      word = ""
      x = 0.0_dp
      if (p <= lines%to) then
         call scan_number(lines%bytes, p, x, found)
         if (found /= number%ok .or. lines%bytes(p) == iachar(",")) x = 0.0_dp
         word = lower(bytes_text(lines%bytes, first_visible(lines%bytes, p, lines%to), lines%to))
         word = word(:scan(word//" ", " "//achar(9)) - 1)
      end if
      scale = time_scale(word)
      if (key == "dt" .and. scale > 0.0_dp) x = x*scale
      if (key /= "dt" .and. word == "khz") x = 1.0e3_dp*x
      if (key /= "dt" .and. scale > 0.0_dp .and. x > 0.0_dp) x = 1.0_dp/(x*scale)
      if (.not. (x >= smallest_rate .and. x <= largest_rate)) then
         call warn(lines, first, key, "is not a positive number", warnings)
         return
      end if
      if (key == "dt") x = 1.0_dp/x
      if (header%rate_hz > 0.0_dp .and. abs(header%rate_hz - x) > 1.0e-6_dp*x) then
         call add_text(warnings, "line "//integer_text(lines%number)// &
            ": the header gives a second rate, "//format_real(x, 6)//" Hz after "// &
            format_real(header%rate_hz, 6)//" Hz; the last counts, `rate_hz` overrides it")
      end if
      header%rate_hz = x
   end subroutine read_rate

   !> Key `unit`: the whole value or its first word; or a unit for each column.
   subroutine read_unit(lines, first, last, key, header)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: first, last
      character(*), intent(in) :: key
      type(header_type), intent(inout) :: header
      type(text_type), allocatable :: words(:)
      type(unit_type) :: unit
      type(unit_type), allocatable :: each(:), behind(:)             ! of the words, of their ends
      type(fields_type) :: fields
      character(:), allocatable :: value, word
      integer(int64) :: to
      integer :: i

      value = bytes_text(lines%bytes, first, last)
      value = value(:noteless_length(value))
      to = first + len(value) - 1
      call recognize_unit(value, unit)
      if (unit%quantity == quantity%unknown) then
         call split_line(lines%bytes, first, to, names_way(lines%bytes, first, to), fields)
         allocate (words(0))
         do i = 1, fields%count
            word = bytes_text(lines%bytes, fields%first(i), fields%last(i))
            if (len(word) > 0) call add_text(words, word)
         end do
         allocate (each(size(words)), behind(size(words)))
         do i = 1, size(words)
            word = words(i)%text
            call recognize_unit(word, each(i))
            call recognize_unit(word(index(word, " ", back=.true.) + 1:), behind(i))
         end do
         if (size(words) > 1 .and. any(each%quantity /= quantity%unknown) .and. &
            (all(each%quantity /= quantity%unknown) .or. key == "units")) then
            call move_alloc(words, header%units)
            header%unit = unit_type()
            return
         end if
         call recognize_unit(value(:scan(value//" ", " ,;"//achar(9)) - 1), unit)
         if (unit%quantity == quantity%unknown .and. key == "units" .and. &
            count(behind%quantity /= quantity%unknown) == 1) unit = &        ! names before units
            behind(findloc(behind%quantity /= quantity%unknown, .true., dim=1))
      end if
      if (unit%quantity == quantity%unknown) then
         call warn(lines, first, key, "is not known", header%unit_warnings)
         if (index(value, "increment") > 0) call add_text(header%unit_warnings, &
            "if the numbers are increments of an angle, say so: `input` increment, `unit` "// &
            "arcsec (deg, rad, ...), and `scale` F where a count is F of that unit")
      else
         header%unit = unit
         if (allocated(header%units)) deallocate (header%units)
      end if
   end subroutine read_unit

   subroutine warn(lines, first, key, what, warnings)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: first
      character(*), intent(in) :: key, what
      type(text_type), allocatable, intent(inout) :: warnings(:)

      call add_text(warnings, "line "//integer_text(lines%number)//": the header's "//key//" '"// &
         shown_bytes(lines%bytes, first, min(last_visible(lines%bytes, first, lines%to), &
         first + 60))//"' "//what//" and is ignored")
   end subroutine warn

end module gyroakf_io_header
