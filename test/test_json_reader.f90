! SPDX-License-Identifier: MIT
!> The JSON reader: what it takes, what it refuses and where; the origin of a document written and read back.
module test_json_reader
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_report_document_origin, only : origin_type, put_origin
   use gyroakf_report_json, only : close_object, json_text, json_type, open_object
   use gyroakf_report_json_reader, only : find_item, json_item, read_json, text_of
   implicit none (type, external)
   private
   public :: collect_json_reader

   character(1), parameter :: lf = new_line("a")

contains

   !> Names the tests.
   subroutine collect_json_reader(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("paths", test_paths), &
         new_unittest("texts", test_texts), &
         new_unittest("numbers", test_numbers), &
         new_unittest("refused", test_refused), &
         new_unittest("depth", test_depth), &
         new_unittest("origin", test_origin)]
   end subroutine collect_json_reader

   !> Paths and lines of nested values.
   subroutine test_paths(error)
      type(error_type), allocatable, intent(out) :: error
      type(json_item), allocatable :: items(:)
      type(gyro_error), allocatable :: problem
      integer :: i

      call read_json(' {"a": [1,'//lf//' {"b": true}, []],'//lf//'"c d":{}}'//achar(13)//lf, items, problem)
      call check(error, .not. allocated(problem))
      if (allocated(error)) return
      call check(error, size(items), 7)
      if (allocated(error)) return
      call check(error, items(1)%path//items(1)%text, "{")
      if (allocated(error)) return
      i = find_item(items, "/a/1/b")
      call check(error, i, 5)
      if (allocated(error)) return
      call check(error, items(i)%text == "true" .and. items(i)%line == 2)
      if (allocated(error)) return
      i = find_item(items, "/c d")
      call check(error, items(i)%text == "{" .and. items(i)%line == 3)
      if (allocated(error)) return
      call check(error, find_item(items, "/c"), 0)
   end subroutine test_paths

   !> Escapes are resolved.
   subroutine test_texts(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text

      call text_of('"a\"\\\/\n\t\b\f\r\u0041\u00e4\u20AC\ud83d"', text)
      call check(error, text, 'a"\/'//lf//achar(9)//achar(8)//achar(12)//achar(13)//"A"//char(195)//char(164)// &
                 char(226)//char(130)//char(172)//char(239)//char(191)//char(189))
      if (allocated(error)) return
      call text_of("-1.5", text)
      call check(error, text, "-1.5")
   end subroutine test_texts

   !> What JSON takes for a number, and what it does not.
   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      character(8), parameter :: good(9) = [character(8) :: "0", "-0", "10", "1.25", "-0.5e-07", "1E+5", "1e5", "true", "null"]
      character(8), parameter :: wrong(14) = [character(8) :: "01", "+1", "1.", ".5", "-", "1e", "1e+", "0x10", "NaN", "Infinity", &
                                              "1 2", "tru", "True", "'a'"]
      integer :: i

      do i = 1, size(good)
         call check(error, place_of("["//trim(good(i))//"]"), "", trim(good(i)))
         if (allocated(error)) return
      end do
      do i = 1, size(wrong)
         call check(error, place_of("["//trim(wrong(i))//"]") /= "", trim(wrong(i)))
         if (allocated(error)) return
      end do
   end subroutine test_numbers

   !> The place of what is wrong.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error

      call expect("", "1:1")
      call expect("  ", "1:3")
      call expect("{} {}", "1:4")
      call expect("[1,"//lf//"]", "2:1")
      call expect("[1"//lf//" 2]", "2:2")
      call expect('{"a" 1}', "1:6")
      call expect("{a: 1}", "1:2")
      call expect('{"a": 1,}', "1:9")
      call expect('["abc', "1:2")
      call expect('["a\x"]', "1:4")
      call expect('["\u12g4"]', "1:3")
      call expect('["a'//achar(9)//'"]', "1:4")
      call expect('["'//char(255)//'"]', "1:3")
      call expect('["'//char(195)//char(164)//char(226)//char(130)//char(172)//'", x]', "1:8")      ! columns count characters
   contains
      subroutine expect(text, place)
         character(*), intent(in) :: text, place

         if (.not. allocated(error)) call check(error, place_of(text), place, text)
      end subroutine expect
   end subroutine test_refused

   !> Deep nesting ends neither the stack nor the program.
   subroutine test_depth(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, place_of(repeat("[", 64)//repeat("]", 64)), "")
      if (allocated(error)) return
      call check(error, place_of(repeat("[", 100000)), "1:65")
   end subroutine test_depth

   !> Command, options, files; a checksum that is not known is null; without a run there is none.
   subroutine test_origin(error)
      type(error_type), allocatable, intent(out) :: error
      type(origin_type) :: origin
      type(json_type) :: json, empty
      type(json_item), allocatable :: items(:)
      type(gyro_error), allocatable :: problem

      origin%command = "allan"
      allocate (origin%setting(2), origin%file(2))
      origin%setting(1)%name = "rate"
      origin%setting(1)%value = "100"
      origin%setting(1)%given = .true.
      origin%setting(2)%name = "unit"
      origin%setting(2)%value = "null"
      origin%file(1)%path = "a ""b"""
      origin%file(1)%checksum%known = .true.
      origin%file(1)%checksum%bytes = 5
      origin%file(1)%checksum%sha256 = repeat("0f", 32)
      origin%file(2)%option = "truth"
      origin%file(2)%path = "-"
      call open_object(json)
      call put_origin(json, origin)
      call close_object(json)
      call read_json(json_text(json), items, problem)
      call check(error, .not. allocated(problem))
      call expect("/origin/command", '"allan"')
      call expect("/origin/options/rate", "100")
      call expect("/origin/options/unit", "null")
      call expect("/origin/given/0", '"rate"')
      call expect("/origin/files/0/option", "null")
      call expect("/origin/files/0/path", '"a \"b\""')
      call expect("/origin/files/0/bytes", "5")
      call expect("/origin/files/0/sha256", '"'//repeat("0f", 32)//'"')
      call expect("/origin/files/1/option", '"truth"')
      call expect("/origin/files/1/bytes", "null")
      call expect("/origin/files/1/sha256", "null")
      if (allocated(error)) return
      call check(error, find_item(items, "/origin/given/1"), 0)
      if (allocated(error)) return
      call open_object(empty)
      call put_origin(empty)
      call close_object(empty)
      call read_json(json_text(empty), items, problem)
      call expect("/origin", "null")
   contains
      subroutine expect(path, token)
         character(*), intent(in) :: path, token

         if (allocated(error)) return
         call check(error, find_item(items, path) > 0, path)
         if (.not. allocated(error)) call check(error, items(find_item(items, path))%text, token)
      end subroutine expect
   end subroutine test_origin

   !> LINE:COLUMN of what is wrong with a text, "" if nothing is.
   function place_of(text) result(place)
      character(*), intent(in) :: text
      character(:), allocatable :: place
      type(json_item), allocatable :: items(:)
      type(gyro_error), allocatable :: problem

      call read_json(text, items, problem)
      place = ""
      if (allocated(problem)) place = problem%message(:index(problem%message, ": ") - 1)
   end function place_of

end module test_json_reader
