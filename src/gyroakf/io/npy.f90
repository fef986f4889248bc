! SPDX-License-Identifier: MIT
!> The header of NumPy's array files.
!>
!> A file is (see `numpy.lib.format`): six bytes of magic, two of version, the length of the header
!> (2 bytes in version 1, 4 in 2 and 3, little endian), the header, the numbers. The header is a
!> dictionary of Python, `{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 3), }`, filled up
!> so that the numbers begin at a multiple of 64 bytes. Of a structured array `descr` lists the
!> fields, `[('t', '<f8'), ('gx', '<f4'), ('', '|V4')]`, the last one padding.
module gyroakf_io_npy
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_columns, only : column_names_type, take_name
   use gyroakf_io_element, only : element_type, field_type, host_big_endian
   use gyroakf_io_npy_cursor, only : ahead, cursor_type, expect, read_string, refuse, unsuitable
   use gyroakf_io_place, only : integer_text, shown_bytes
   use gyroakf_io_text, only : bytes_text, text_bytes
   use gyroakf_record, only : add_text
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: npy_magic, make_npy_header, spell_shape, npy_header_type, read_npy_header

   !> The first six bytes
   character(6), parameter :: npy_magic = char(147)//"NUMPY"
   !> The numbers begin at a multiple of it
   integer, parameter :: npy_alignment = 64
   !> Most characters of a header; that of a plain array has some 120
   integer(int64), parameter :: most_header = 65536

   !> What a header says
   type :: npy_header_type
      !> How the numbers are stored
      type(element_type) :: element
      !> Of a structured array: its fields and their names
      type(field_type), allocatable :: field(:)
      type(column_names_type) :: names
      !> Columns are stored one after the other
      logical :: by_columns = .false.
      !> 1 or 2, and the lengths
      integer :: rank = 0
      integer(int64) :: shape(2) = 1
      !> Bytes before the numbers
      integer(int64) :: first = 0
   end type npy_header_type

contains

   !> Magic, version 1.0 and header of an array of doubles: all bytes before the numbers.
   pure subroutine make_npy_header(rows, columns, by_columns, header)
      !> Its shape; 0 columns: one dimension
      integer(int64), intent(in) :: rows, columns
      !> Columns are stored one after the other
      logical, intent(in) :: by_columns
      character(:), allocatable, intent(out) :: header
      character(:), allocatable :: text, shape
      integer :: length

      call spell_shape(rows, columns, shape)
      text = "{'descr': '"//merge(">", "<", host_big_endian())//"f8', 'fortran_order': "// &
             trim(merge("True ", "False", by_columns))//", 'shape': "//shape//", }"
      length = len(text) + 1 + modulo(-(len(text) + len(npy_magic) + 5), npy_alignment)
      text = text//repeat(" ", length - len(text) - 1)//achar(10)
      header = npy_magic//achar(1)//achar(0)//achar(modulo(length, 256))//achar(length/256)//text
   end subroutine make_npy_header

   !> "(1000, 3)", "(1000,)".
   pure subroutine spell_shape(rows, columns, text)
      !> As those of [[make_npy_header]]
      integer(int64), intent(in) :: rows, columns
      character(:), allocatable, intent(out) :: text

      text = "("//integer_text(rows)//","
      if (columns > 0) text = text//" "//integer_text(columns)
      text = text//")"
   end subroutine spell_shape

   !> Reads magic, version and header.
   subroutine read_npy_header(bytes, name, header, error)
      !> The first bytes of the file; 66,000 are always enough
      integer(int8), intent(in), contiguous :: bytes(:)
      character(*), intent(in) :: name
      type(npy_header_type), intent(out) :: header
      !> parse; not_supported: a type that holds no plain numbers, more than two dimensions
      type(error_type), allocatable, intent(out) :: error
      type(cursor_type) :: cursor
      integer(int64) :: length, start, count
      integer :: version, i

      cursor%name = name
      count = size(bytes, kind=int64)
      start = 10
      length = 0
      if (count >= start) then
         version = iand(int(bytes(7)), 255)
         if (version < 1 .or. version > 3 .or. bytes(8) /= 0) then
            call fatal_error(error, status%not_supported, name//": byte 6: version "// &
               integer_text(int(version, int64))//"."//integer_text(iand(int(bytes(8), int64), &
               255_int64))//" of NumPy's format is not known; known are 1.0, 2.0, 3.0"// &
               new_line("a")//"save it again with numpy.save")
            return
         end if
         start = merge(10, 12, version == 1)
         do i = merge(int(start), 0, count >= start), 9, -1
            length = 256*length + iand(int(bytes(i)), 255)
         end do
         if (length > most_header) then
            call fatal_error(error, status%parse, name//": byte 8: the header's length "// &
               integer_text(length)//" is not that of a plain array"//new_line("a")// &
               "save the columns with numpy.save as an array of numbers")
            return
         end if
      end if
      header%first = start + length
      if (header%first > count) then
         call fatal_error(error, status%parse, name//": byte "//integer_text(count)// &
            ": the file ends within the header of NumPy's format"//new_line("a")// &
            "it was cut off: copy it again")
         return
      end if
      cursor%text = bytes_text(bytes, start + 1, header%first)
      cursor%before = start
      call read_dictionary(cursor, header)
      call move_alloc(cursor%error, error)
   end subroutine read_npy_header

   !> {'descr': ..., 'fortran_order': ..., 'shape': ...}: the three keys in any order, each once.
   subroutine read_dictionary(cursor, header)
      type(cursor_type), intent(inout) :: cursor
      type(npy_header_type), intent(inout) :: header
      character(:), allocatable :: key, word
      logical :: seen(3), this(3)

      seen(:) = .false.
      call expect(cursor, "{")
      do while (.not. allocated(cursor%error))
         if (ahead(cursor) == "}") exit
         call read_string(cursor, key)
         call expect(cursor, ":")
         this = [character(13) :: "descr", "fortran_order", "shape"] == key
         if (.not. any(this)) call refuse(cursor, "'"//shown_bytes(text_bytes(key), 1_int64, &
            min(40_int64, len(key, int64)))//"' is none of descr, fortran_order, shape")
         if (any(this .and. seen)) call refuse(cursor, "a key stands twice")
         if (this(1)) call read_descr(cursor, header)
         if (this(2)) then
            header%by_columns = ahead(cursor) == "T"
            word = trim(merge("True ", "False", header%by_columns))
            if (index(cursor%text(cursor%at:), word) /= 1) call refuse(cursor, &
               "fortran_order is neither True nor False")
            cursor%at = cursor%at + len(word)
         end if
         if (this(3)) call read_shape(cursor, header)
         seen = seen .or. this
         if (ahead(cursor) /= ",") exit
         cursor%at = cursor%at + 1
      end do
      call expect(cursor, "}")
      if (.not. all(seen)) call refuse(cursor, "descr, fortran_order or shape is not there")
      if (ahead(cursor) /= "") call refuse(cursor, "more follows")
      if (allocated(header%field) .and. header%rank > 1) call unsuitable(cursor, &
         "the array's type is structured, and it has 2 dimensions", &
         "save one row for each sample: array.ravel()")
   end subroutine read_dictionary

   !> (), (1000,) or (1000, 3); a long integer of Python 2 ends with L.
   subroutine read_shape(cursor, header)
      type(cursor_type), intent(inout) :: cursor
      type(npy_header_type), intent(inout) :: header
      integer(int64) :: length, longest
      integer :: digits, axis

      longest = -1
      axis = 0
      call expect(cursor, "(")
      do while (.not. allocated(cursor%error))
         if (ahead(cursor) == ")") exit
         digits = verify(cursor%text(cursor%at:)//" ", "0123456789") - 1
         if (digits < 1 .or. digits > 18) then
            call refuse(cursor, "a length of the shape is expected")
            return
         end if
         read (cursor%text(cursor%at:cursor%at + digits - 1), *) length
         header%rank = header%rank + 1
         if (header%rank <= 2) header%shape(header%rank) = length
         if (length > longest) axis = header%rank - 1
         longest = max(longest, length)
         cursor%at = cursor%at + digits
         if (ahead(cursor) == "L") cursor%at = cursor%at + 1
         if (ahead(cursor) /= ",") exit
         cursor%at = cursor%at + 1
      end do
      call expect(cursor, ")")
      if (header%rank == 0) call unsuitable(cursor, "the array is a single number, shape ()", &
         "save the whole series")
      if (header%rank > 2) call unsuitable(cursor, "the array has "// &
         integer_text(int(header%rank, int64))//" dimensions", "one row for each sample, where "// &
         "the longest axis is the time: python3 -c ""import numpy; numpy.save('rows.npy', "// &
         "numpy.moveaxis(numpy.load('"//cursor%name//"'), "//integer_text(int(axis, int64))// &
         ", 0).reshape("//integer_text(longest)//", -1))""")
   end subroutine read_shape

   !> The type of every number, '<f8', or the fields of a structured one.
   subroutine read_descr(cursor, header)
      type(cursor_type), intent(inout) :: cursor
      type(npy_header_type), intent(inout) :: header
      character(:), allocatable :: descr, what, advice
      logical :: known

      if (ahead(cursor) == "[") then
         call read_fields(cursor, header)
         return
      end if
      call read_string(cursor, descr)
      call parse_type(descr, header%element, known)
      if (known) return
      if (scan(descr, "<>=|") == 1) descr = descr(2:)
      advice = "save numbers: python3 -c ""import numpy; numpy.save('numbers.npy', "// &
         "numpy.stack(numpy.load('"//cursor%name//"', allow_pickle=True)).astype('f8'))"""
      select case (descr(:min(1, len(descr))))
      case ("f", "g"); what = " is a long double, which differs from machine to machine"
      case ("c"); what = " is complex"
         advice = "save array.real and array.imag as columns"
      case ("O"); what = " is object: Python objects, no plain numbers"
      case ("S", "U", "a"); what = " is text"
      case ("V"); what = " is raw"
      case ("M", "m"); what = " is a date or a time"
         advice = "save seconds: (array - array[0])/numpy.timedelta64(1, 's')"
      case default; what = " is not known"
      end select
      if (index(descr, "O") /= 1) what = " '"// &
         shown_bytes(text_bytes(descr), 1_int64, min(40_int64, len(descr, int64)))//"'"//what
      call unsuitable(cursor, "the array's type"//what, advice)
   end subroutine read_descr

   !> [('t', '<f8'), ('', '|V4')]: names and types; without a name it is padding.
   subroutine read_fields(cursor, header)
      type(cursor_type), intent(inout) :: cursor
      type(npy_header_type), intent(inout) :: header
      character(:), allocatable :: name, descr, word, unit
      type(field_type) :: field
      logical :: known
      integer :: bytes

      if (allocated(cursor%error)) return
      header%element = element_type(kind="V", bytes=0, big_endian=host_big_endian())
      allocate (header%field(0))
      header%names%known = .true.
      do while (.not. allocated(cursor%error))
         cursor%at = cursor%at + 1
         if (ahead(cursor) == "]") exit
         call expect(cursor, "(")
         name = ""
         descr = ""
         known = ahead(cursor) /= "("                                ! else a title and a name
         if (known) call read_string(cursor, name)
         if (known) call make_readable(name)
         if (known) call expect(cursor, ",")
         if (known) known = ahead(cursor) /= "["
         if (known) call read_string(cursor, descr)
         if (known) known = ahead(cursor) == ")"
         bytes = 0
         if (known .and. name == "" .and. index(descr, "|V") == 1) then
            known = len(descr) < 8 .and. verify(descr(3:)//"x", "0123456789") == len(descr) - 1
            if (known) read (descr(3:), *) bytes
         else if (known) then
            call parse_type(descr, field%element_type, known)
            field%offset = header%element%bytes
            bytes = field%bytes
            header%field = [header%field, field]
            call take_name(name, word, unit)
            call add_text(header%names%name, word)
            call add_text(header%names%unit, unit)
         end if
         if (.not. known) call unsuitable(cursor, &
            "the array's type is structured, and not all of its fields are numbers", &
            "save a table of numbers: python3 -c ""import numpy; a = numpy.load('"//cursor%name// &
            "'); numpy.save('rows.npy', a[['NAME', 'NAME']])"" with the names of its numbers")
         header%element%bytes = header%element%bytes + bytes
         call expect(cursor, ")")
         if (ahead(cursor) /= ",") exit
      end do
      call expect(cursor, "]")
      if (size(header%field) == 0) call refuse(cursor, "a structured type without fields is given")
   end subroutine read_fields

   !> '<f8': order, kind, bytes.
   pure subroutine parse_type(word, element, known)
      character(*), intent(in) :: word
      type(element_type), intent(out) :: element
      logical, intent(out) :: known
      integer :: first

      first = merge(2, 1, scan(word, "<>=|") == 1)
      element%big_endian = host_big_endian()
      if (first == 2) element%big_endian = word(1:1) == ">" .or. &
         (element%big_endian .and. word(1:1) /= "<")
      known = .true.
      select case (word(first:))
      case ("f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "b1")
         element%kind = word(first:first)
         element%bytes = iachar(word(first + 1:first + 1)) - 48
      case ("?", "b", "B")
         element%kind = merge("i", merge("u", "b", word(first:) == "B"), word(first:) == "b")
         element%bytes = 1
      case default; known = .false.
      end select
   end subroutine parse_type

end module gyroakf_io_npy
