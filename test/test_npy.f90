! SPDX-License-Identifier: MIT
!> NumPy's array files: every type, byte order and layout against exact values, headers that lie.
module test_npy
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_io_npy, only : make_npy_header, npy_magic
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_record, only : record_type
   use scratch_file, only : read_content
   implicit none (type, external)
   private
   public :: suite_npy

contains

   subroutine suite_npy()
      call test("floats", test_floats)
      call test("integers", test_integers)
      call test("versions", test_versions)
      call test("orders", test_orders)
      call test("longer-side", test_longer_side)
      call test("spellings", test_spellings)
      call test("missing", test_missing)
      call test("rounded", test_rounded)
      call test("unsuitable", test_unsuitable)
      call test("broken-headers", test_broken)
      call test("every-length", test_every_length)
      call test("every-byte", test_every_byte)
      call test("own-header", test_own_header)
      call test("columns", test_columns)
      call test("large", test_large)
      call test("structured", test_structured)
      call test("structured-broken", test_structured_broken)
   end subroutine suite_npy

   !> Bytes of an integer, the lowest first or last.
   pure function stored(value, bytes, big) result(text)
      integer(int64), intent(in) :: value
      integer, intent(in) :: bytes
      logical, intent(in) :: big
      character(bytes) :: text
      integer :: i, place

      do i = 1, bytes
         place = merge(bytes + 1 - i, i, big)
         text(place:place) = achar(int(ibits(value, 8*(i - 1), 8)))
      end do
   end function stored

   !> A file of version 1.0 with this dictionary.
   pure function npy(dictionary, content) result(text)
      character(*), intent(in) :: dictionary, content
      character(:), allocatable :: text

      text = npy_magic//achar(1)//achar(0)//stored(len(dictionary, int64) + 1, 2, .false.)//dictionary//achar(10)//content
   end function npy

   !> A dictionary of usual form.
   pure function dictionary(descr, by_columns, shape) result(text)
      character(*), intent(in) :: descr, shape
      logical, intent(in) :: by_columns
      character(:), allocatable :: text

      text = "{'descr': '"//descr//"', 'fortran_order': "//trim(merge("True ", "False", by_columns))//", 'shape': "// &
         shape//", }"
   end function dictionary

   !> Reads these bytes as a file, with default options.
   subroutine read_array(content, record)
      character(*), intent(in) :: content
      type(record_type), intent(out) :: record

      call read_content(content, "array.npy", reader_options(), record, failed)
   end subroutine read_array

   !> The values that were read are exactly these.
   subroutine check_values(content, expected, type_name)
      character(*), intent(in) :: content
      real(dp), intent(in) :: expected(:)
      character(*), intent(in) :: type_name
      type(record_type) :: record

      call read_array(content, record)
      if (went_wrong(failed, type_name//" is not read")) return
      call check(error, record%format//", "//record%stored_type, "npy, "//type_name)
      if (unmet(size(record%value), size(expected))) return
      call check(error, all(abs(record%value(:, 1) - expected) <= 0.0_dp), type_name//" has other values")
   end subroutine check_values

   !> f2, f4, f8 in both orders: 1.5, -2, 0, 65504 (the largest of half precision), its smallest, a third rounded.
   subroutine test_floats()
      integer(int64), parameter :: two(6) = [15872, 49152, 0, 31743, 1, 13653]
      integer(int64), parameter :: four(6) = [1069547520_int64, 3221225472_int64, 0_int64, 1199562752_int64, 864026624_int64, &
                                              1051369472_int64]
      integer(int64), parameter :: eight(6) = [int(z"3FF8000000000000", int64), -4611686018427387904_int64, 0_int64, &
         int(z"40EFFC0000000000", int64), int(z"3E70000000000000", int64), int(z"3FD5540000000000", int64)]
      real(dp), parameter :: value(6) = [1.5_dp, -2.0_dp, 0.0_dp, 65504.0_dp, 2.0_dp**(-24), 1365.0_dp/4096]
      character(:), allocatable :: content(:)
      integer :: k, i
      logical :: big

      do k = 0, 1
         big = k == 1
         allocate (character(48) :: content(3))
         content = ""
         do i = 1, 6
            content(1)(2*i - 1:2*i) = stored(two(i), 2, big)
            content(2)(4*i - 3:4*i) = stored(four(i), 4, big)
            content(3)(8*i - 7:8*i) = stored(eight(i), 8, big)
         end do
         do i = 1, 3
            call check_values(npy(dictionary(merge(">", "<", big)//"f"//achar(48 + 2**i), &
               & .false., "(6,)"), content(i)(:6*2**i)), value, "float"//trim(merge("16", &
               & merge("32", "64", i == 2), i == 1)) //trim(merge(" big endian", "           ", &
               & big)))
         end do
         deallocate (content)
      end do
   end subroutine test_floats

   !> i1 to i8, u1 to u8, b1 in both orders, with the ends of their ranges.
   subroutine test_integers()
      character(:), allocatable :: content, descr, name
      real(dp) :: half
      integer(int64) :: pattern(4)
      integer :: k, bytes, j

      do k = 0, 1
         do j = 0, 3
            bytes = 2**j
            half = 2.0_dp**(8*bytes - 1)
            pattern = [1_int64, -1_int64, 100_int64, ishft(1_int64, 8*bytes - 1)]
            content = stored(pattern(1), bytes, k == 1)//stored(pattern(2), bytes, k == 1)//stored(pattern(3), bytes, k == 1) &
                      //stored(pattern(4), bytes, k == 1)
            descr = merge(">", "<", k == 1)//"i"//achar(48 + bytes)
            name = "int"//trim(adjustl(text_of(8*bytes)))//trim(merge(" big endian", "           ", k == 1 .and. bytes > 1))
            call check_values(npy(dictionary(descr, .false., "(4,)"), content), [1.0_dp, -1.0_dp, &
               & 100.0_dp, -half], name)
            descr(2:2) = "u"
            call check_values(npy(dictionary(descr, .false., "(4,)"), content), [1.0_dp, &
               & 2*half - merge(1.0_dp, 0.0_dp, bytes < 8), 100.0_dp, half], "u"//name)
         end do
      end do
      call check_values(npy(dictionary("|b1", .false., "(3,)"), char(1)//char(0)//char(1)), &
         & [1.0_dp, 0.0_dp, 1.0_dp], "bool")
   end subroutine test_integers

   !> A small number.
   pure function text_of(i) result(text)
      integer, intent(in) :: i
      character(4) :: text

      write (text, "(i0)") i
   end function text_of

   !> Versions 1, 2 and 3; 4 is refused.
   subroutine test_versions()
      character(*), parameter :: says = "{'descr': '|i1', 'fortran_order': False, 'shape': (3,), }"
      type(record_type) :: record
      integer :: version

      call check_values(npy(says, achar(3)//achar(2)//achar(1)), [3.0_dp, 2.0_dp, 1.0_dp], "int8")
      do version = 2, 3
         call check_values(npy_magic//achar(version)//achar(0)//stored(len(says, int64), 4, &
            & .false.)//says//achar(3)//achar(2)//achar(1), [3.0_dp, 2.0_dp, 1.0_dp], "int8")
      end do
      call read_array(npy_magic//achar(4)//achar(0)//stored(len(says, int64), 4, .false.)//says// &
         & "abc", record)
      if (unmet(allocated(failed))) return
      call check(error, failed%code == status%not_supported .and. index(failed%message, "version 4.0") > 0, failed%message)
   end subroutine test_versions

   !> Rows together or columns together.
   subroutine test_orders()
      type(record_type) :: record
      integer :: k

      do k = 0, 1
         call read_array(npy(dictionary("|u1", k == 1, "(3, 2)"), merge("cfadbe", "cabfde", &
            & k == 0)), record)
         if (went_wrong(failed)) return
         call check(error, all(nint(record%value) == reshape([99, 97, 98, 102, 100, 101], [3, 2])), "order "//text_of(k))
         if (unmet(.not. allocated(record%warnings), "a warning")) return
      end do
   end subroutine test_orders

   !> More columns than rows: the longer side is the time, with a warning; of a single row without one.
   subroutine test_longer_side()
      type(record_type) :: record
      integer :: k

      do k = 0, 1
         call read_array(npy(dictionary("|u1", k == 1, "(2, 3)"), merge("adbecf", "abcdef", &
            & k == 1)), record)
         if (went_wrong(failed)) return
         call check(error, all(nint(record%value) == reshape([97, 98, 99, 100, 101, 102], [3, 2])), "order "//text_of(k))
         call check(error, index(record%warnings(1)%text, "(2, 3)") > 0 .and. index(record%warnings(1)%text, "longer side") > 0)
      end do
      call read_array(npy(dictionary("|u1", .false., "(1, 3)"), "abc"), record)
      if (unmet(.not. allocated(failed) .and. .not. allocated(record%warnings))) return
      call check(error, all(nint(record%value(:, 1)) == [97, 98, 99]))
   end subroutine test_longer_side

   !> The dictionary in other spellings of Python.
   subroutine test_spellings()
      character(80) :: says(5)
      integer :: i

      says(1) = '{"shape": (3,), "fortran_order": False, "descr": "|i1"}'
      says(2) = "  {'descr' : 'i1','fortran_order':False,'shape':(3)}  "
      says(3) = "{'descr': '=i1', 'fortran_order': True, 'shape': (3L,), }"
      says(4) = "{'fortran_order': True, 'descr': 'b', 'shape': ( 3 , ) , }"
      says(5) = "{'shape': (3, 1), 'descr': '>i1', 'fortran_order': False}"
      do i = 1, size(says)
         call check_values(npy(says(i), achar(3)//achar(2)//achar(1)), [3.0_dp, 2.0_dp, 1.0_dp], &
            & "int8")
      end do
   end subroutine test_spellings

   !> NaN, signaling ones too, and infinities are missing samples.
   subroutine test_missing()
      type(record_type) :: record
      character(:), allocatable :: content
      integer :: k

      do k = 1, 3
         select case (k)
         case (1); content = npy(dictionary("<f8", .false., "(4,)"), stored(int(z"7FF0000000000001", int64), 8, .false.)// &
            stored(int(z"7FF8000000000000", int64), 8, .false.)//stored(int(z"7FF0000000000000", int64), 8, .false.)// &
            stored(int(z"3FF0000000000000", int64), 8, .false.))
         case (2); content = npy(dictionary(">f4", .false., "(4,)"), stored(int(z"7F800001", int64), 4, .true.)// &
            stored(int(z"7FC00000", int64), 4, .true.)//stored(int(z"FF800000", int64), 4, .true.)// &
            stored(int(z"3F800000", int64), 4, .true.))
         case default; content = npy(dictionary("<f2", .false., "(4,)"), stored(int(z"7C01", int64), 2, .false.)// &
            stored(int(z"7E00", int64), 2, .false.)//stored(int(z"FC00", int64), 2, .false.)//stored(int(z"3C00", int64), &
               2, .false.))
         end select
         call read_array(content, record)
         if (went_wrong(failed)) return
         call check(error, record%audit%missing, 3_int64)
         call check(error, all(record%present(:, 1) == [0, 0, 0, 1]) .and. abs(record%value(4, 1) - 1) <= 0.0_dp)
      end do
   end subroutine test_missing

   !> A warning of integers beyond 2^53, none of those at it.
   subroutine test_rounded()
      type(record_type) :: record
      integer(int64), parameter :: edge = 9007199254740992_int64

      call read_array(npy(dictionary("<i8", .false., "(3,)"), stored(edge, 8, .false.)// &
         & stored(-edge, 8, .false.)//stored(0_int64, 8, .false.)), record)
      if (unmet(.not. allocated(failed) .and. .not. allocated(record%warnings))) return
      call read_array(npy(dictionary("<i8", .false., "(3,)"), stored(edge + 1, 8, .false.)// &
         & stored(-edge - 1, 8, .false.)//stored(0_int64, 8, .false.)), record)
      if (unmet(.not. allocated(failed) .and. allocated(record%warnings))) return
      call check(error, index(record%warnings(1)%text, "2 of the int64 values are beyond 2^53") > 0)
   end subroutine test_rounded

   !> Arrays that are no table of numbers: the message names the type and what to do.
   subroutine test_unsuitable()
      character(32), parameter :: descr(13) = [character(32) :: "'<f16'", "'<g'", "'<c16'", "'|O'", "'|S5'", "'<U3'", "'|V8'", &
         "'<M8[us]'", "'<m8[s]'", "'<q9'", "[('a', '<f8'), ('b', 'S2')]", "''", "'<f3'"]
      character(12), parameter :: fragment(13) = [character(12) :: "long double", "long double", "complex", "object", "text", &
         "text", "raw", "date", "date", "not known", "structured", "not known", "long double"]
      integer :: i

      do i = 1, size(descr)
         call check_refusal(npy("{'descr': "//trim(descr(i))// &
            & ", 'fortran_order': False, 'shape': (1,), }", "12345678"), trim(fragment(i)))
      end do
      call check_refusal(npy(dictionary("<f8", .false., "()"), "12345678"), "single number")
      call check_refusal(npy(dictionary("<f8", .false., "(1, 1, 1)"), "12345678"), "3 dimensions")
      call check_refusal(npy(dictionary("<f8", .false., "(2, 3, 4, 1)"), "12345678"), &
         & ", 2, 0).reshape(4, -1))")
      call check_refusal(npy(dictionary("<f8", .false., "(0,)"), ""), "empty")
      call check_refusal(npy(dictionary("<f8", .false., "(3, 0)"), ""), "empty")
   end subroutine test_unsuitable

   !> A file that has to be refused with this in the message.
   subroutine check_refusal(content, fragment)
      character(*), intent(in) :: content, fragment
      type(record_type) :: record

      call read_array(content, record)
      if (unmet(allocated(failed), "not refused: "//fragment)) return
      call check(error, index(failed%message, fragment) > 0 .and. index(failed%message, &
         new_line("a")) > 0 .or. fragment == "empty", &
                 fragment//" is not in: "//failed%message)
   end subroutine check_refusal

   !> Headers that cannot be understood, or that promise another length: the message holds the byte.
   subroutine test_broken()
      character(90), parameter :: says(13) = [character(90) :: "", "{", "{'descr'", "{'descr': '<f8'}", &
         "{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (1,)}", &
         "{'descr': '<f8', 'fortran_order': 0, 'shape': (1,)}", "{'descr': '<f8', 'fortran_order': False, 'shape': 1}", &
         "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}", &
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), 'x': 1}", &
         "{'descr': '<f8', 'fortran_order': False, 'shape': (1,)} x", &
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1 1)}", &
         "{'descr: <f8, 'fortran_order': False, 'shape': (1,)}", "{'descr': '<f8', 'fortran_order': False, 'shape': (1.5,)}"]
      integer :: i

      do i = 1, size(says)
         call check_refusal(npy(trim(says(i)), "12345678"), "byte ")
      end do
      call check_refusal(npy(dictionary("<f8", .false., "(2,)"), "12345678"), &
         & "byte 76: the file ends here, the header's "//"shape (2,) of float64 needs 8 bytes more")
      call check_refusal(npy(dictionary("<f8", .false., "(1,)"), "123456789"), &
         & "byte 76: the header's shape (1,) of "//"float64 ends here, and 1 bytes follow")
      call check_refusal(npy(dictionary("<f8", .false., &
         & "(999999999999999999, 999999999999999999)"), "12345678"), "larger")
   end subroutine test_broken

   !> Cut off at any byte, a file is refused.
   subroutine test_every_length()
      character(:), allocatable :: whole
      type(record_type) :: record
      integer :: n

      whole = npy(dictionary("<f8", .false., "(3, 2)"), repeat("12345678", 6))
      do n = 0, len(whole) - 1
         call read_array(whole(:n), record)
         if (unmet(allocated(failed), "not refused at byte "//text_of(n))) return
      end do
      call read_array(whole, record)
      call check(error, .not. allocated(failed))
   end subroutine test_every_length

   !> With any bit of the header changed, a file is read or refused, never more than its bytes.
   subroutine test_every_byte()
      call change_bits(npy(dictionary("<f8", .false., "(3, 2)"), repeat(achar(0), 48)), 48)
   end subroutine test_every_byte

   !> Reads a file with each bit before its last bytes changed.
   subroutine change_bits(whole, last)
      character(*), intent(in) :: whole
      integer, intent(in) :: last
      character(len(whole)) :: changed
      type(record_type) :: record
      integer :: n, bit

      do n = 1, len(whole) - last
         do bit = 0, 7
            changed = whole
            changed(n:n) = achar(ieor(iachar(whole(n:n)), 2**bit))
            call read_array(changed, record)
            if (allocated(failed)) cycle
            if (unmet(size(record%value) <= last, "byte "//text_of(n))) return
         end do
      end do
   end subroutine change_bits

   !> The header that this library writes is one that it reads, and the numbers begin at a multiple of 64.
   subroutine test_own_header()
      type(record_type) :: record
      character(:), allocatable :: header
      integer(int64) :: columns
      integer :: order

      do columns = 0, 2
         do order = 0, 1
            call make_npy_header(3_int64, columns, order == 1, header)
            call check(error, modulo(len(header), 64), 0)
            call read_array(header//repeat(achar(0), int(24*max(1_int64, columns))), record)
            if (went_wrong(failed)) return
            call check(error, all(shape(record%value) == [3, max(1, int(columns))]))
         end do
      end do
   end subroutine test_own_header

   !> Columns and the time by number.
   subroutine test_columns()
      type(reader_options) :: options
      type(record_type) :: record
      integer :: k

      options%columns = "3,2"
      options%time_column = "1"
      options%unit = "deg/s"
      do k = 0, 1
         call read_content(npy(dictionary("|u1", k == 1, "(3, 3)"), merge("adgbehcfi", &
            & "abcdefghi", k == 0)), "array.npy", options, record, failed)
         if (went_wrong(failed)) return
         call check(error, all(nint(record%value) == reshape([103, 104, 105, 100, 101, 102], [3, 2])))
         call check(error, record%rate_source == "timestamps" .and. abs(record%sample_interval - 1) <= 0.0_dp)
      end do
      options%columns = "gx"
      call read_content(npy(dictionary("|u1", .false., "(3, 3)"), "abcdefghi"), "array.npy", &
         & options, record, failed)
      if (unmet(allocated(failed))) return
      call check(error, index(failed%message, "give numbers") > 0, failed%message)
   end subroutine test_columns

   !> More than a block and more than one thread's share, in both layouts; the last row of a column is its own.
   subroutine test_large()
      integer, parameter :: rows = 300001
      character(:), allocatable :: content
      type(record_type) :: record
      integer :: i, j, k, at

      allocate (character(6*rows) :: content)
      do k = 0, 1
         do j = 1, 3
            do i = 1, rows
               at = merge(3*(i - 1) + j, (j - 1)*rows + i, k == 0)
               content(2*at - 1:2*at) = stored(int(modulo(i*j + 7*modulo(i, 3), 30011), int64), 2, .true.)
            end do
         end do
         call read_array(npy(dictionary(">i2", k == 1, "(300001, 3)"), content), record)
         if (went_wrong(failed)) return
         do j = 1, 3
            call check(error, all(nint(record%value(:, j)) == [(modulo(i*j + 7*modulo(i, 3), 30011), i=1, rows)]), &
                       "column "//text_of(j))
         end do
      end do
   end subroutine test_large

   !> Fields of several types, orders and paddings become named columns, by position and in order.
   subroutine test_structured()
      character(*), parameter :: says = "[('time_s', '<f8'), ('gx [deg/s]', '>f4'), ('', '|V3'), ('gy [deg/s]', '<i2')]"
      integer, parameter :: rows = 70000
      type(reader_options) :: options
      type(record_type) :: record
      character(:), allocatable :: content, row
      integer :: i, k

      allocate (character(17*rows) :: content)
      do i = 1, rows
         row = stored(transfer(0.5_dp*i, 1_int64), 8, .false.)//stored(int(transfer(real(i), 1), int64), 4, .true.)
         content(17*i - 16:17*i) = row//"xyz"//stored(int(-modulo(i, 30000), int64), 2, .false.)
      end do
      content = npy("{'descr': "//says//", 'fortran_order': False, 'shape': (70000,), }", content)
      do k = 0, 1
         if (k == 0) call read_content(content, "array.npy", options, record, failed)
         if (k == 1) then
            allocate (options%bytes(len(content)))
            options%bytes = transfer(content, options%bytes)
            call read_record("memory", options, record, failed)
            deallocate (options%bytes)
         end if
         if (went_wrong(failed)) return
         call check(error, record%stored_type, "structured")
         call check(error, record%channel(1)%text//" "//record%channel(2)%text//" "//record%unit%name, "gx gy deg/s")
         call check(error, record%rate_source == "timestamps" .and. abs(record%sample_interval - 0.5_dp) < 1.0e-12_dp)
         call check(error, all(nint(record%value(:, 1)) == [(i, i=1, rows)]))
         call check(error, all(nint(record%value(:, 2)) == [(-modulo(i, 30000), i=1, rows)]))
         if (allocated(error)) return
      end do
   end subroutine test_structured

   !> What is no list of plain fields, and any bit changed.
   subroutine test_structured_broken()
      character(*), parameter :: before = "{'descr': ", behind = ", 'fortran_order': False, 'shape': (2,)}"
      character(40), parameter :: says(6) = [character(40) :: "[('a', '<f8', (2,))]", "[('a', [('b', '<f8')])]", &
         "[(('title', 'a'), '<f8')]", "[('', '|V-5'), ('a', '<f8')]", "[]", "[('a', '<f8'"]
      integer :: i

      do i = 1, size(says)
         call check_refusal(npy(before//trim(says(i))//behind, repeat("x", 16)), "structured")
         if (i == 4) call check_refusal(npy(before//"[('a', '<f8')], 'shape': (1, 2), 'fortran_order': True}", &
                                                   repeat("x", 16)), "2 dimensions")
      end do
      call change_bits(npy(before//"[('a', '<f4'), ('', '|V4'), ('b', '<f8')]"//behind, &
         & repeat(achar(0), 32)), 32)
   end subroutine test_structured_broken

end module test_npy
