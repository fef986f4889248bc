! SPDX-License-Identifier: MIT
!> The JSON writer: nesting, digits, escapes; UTF-8.
module test_json
   use expectations, only : unmet, test, error, check
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan, ieee_positive_inf, ieee_negative_inf
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : text_type
   use gyroakf_report_json, only : json_type, json_text, quote_json
   use gyroakf_utf8, only : text_width, sequence_length
   use json_reader, only : json_item, read_json, json_text_at, json_real
   implicit none (type, external)
   private
   public :: suite_json

   character(1), parameter :: lf = new_line("a")

contains

   subroutine suite_json()
      call test("nesting", test_nesting)
      call test("empty", test_empty)
      call test("digits", test_digits)
      call test("not-finite", test_not_finite)
      call test("escapes", test_escapes)
      call test("utf8-invalid", test_utf8_invalid)
      call test("utf8-width", test_utf8_width)
      call test("large", test_large)
   end subroutine suite_json

   subroutine test_nesting()
      type(json_type) :: json
      type(text_type) :: names(2)

      names(1)%text = "gx"
      names(2)%text = "gy"
      call json%open("")
      call json%put("schema", 1)
      call json%open("list", list=.true.)
      call json%open("")
      call json%put("yes", .true.)
      call json%put("nothing")
      call json%close()
      call json%put("", 12000_int64)
      call json%close()
      call json%put("names", names)
      call json%put("x", [0.5_dp, -2.0_dp])
      call json%close()
      call check(error, json_text(json), "{"//lf//'  "schema": 1,'//lf//'  "list": ['//lf//"    {"//lf//'      "yes": true,'//lf// &
                 '      "nothing": null'//lf//"    },"//lf//"    12000"//lf//"  ],"//lf//'  "names": ["gx", "gy"],'//lf// &
                 '  "x": [0.5, -2]'//lf//"}"//lf)
   end subroutine test_nesting

   subroutine test_empty()
      type(json_type) :: json
      real(dp) :: nothing(0)

      call check(error, json_text(json), "")
      call json%open("")
      call json%open("a")
      call json%close()
      call json%open("b", list=.true.)
      call json%close()
      call json%put("c", nothing)
      call json%close()
      call check(error, json_text(json), "{"//lf//'  "a": {},'//lf//'  "b": [],'//lf//'  "c": []'//lf//"}"//lf)
   end subroutine test_empty

   !> 17 digits give the same bits back.
   subroutine test_digits()
      real(dp), parameter :: x(7) = [0.1_dp, 1.0_dp/3, -5.24e-4_dp, huge(1.0_dp), tiny(1.0_dp), 2.0_dp**(-1074), 12345678901.5_dp]
      type(json_type) :: json
      type(json_item), allocatable :: items(:)
      character(4) :: path
      logical :: valid
      integer :: i

      call json%open("")
      call json%put("x", x)
      call json%close()
      call read_json(json_text(json), items, valid)
      call check(error, valid)
      do i = 1, size(x)
         write (path, "(a, i0)") "/x/", i - 1
         call check(error, transfer(json_real(items, trim(path)), 0_int64) == transfer(x(i), 0_int64), "bits of "//path)
      end do
   end subroutine test_digits

   subroutine test_not_finite()
      type(json_type) :: json
      type(json_item), allocatable :: items(:)
      logical :: valid

      call json%open("")
      call json%put("x", [ieee_value(1.0_dp, ieee_quiet_nan), ieee_value(1.0_dp, ieee_positive_inf), &
                                  ieee_value(1.0_dp, ieee_negative_inf), 1.0_dp])
      call json%put("y", ieee_value(1.0_dp, ieee_quiet_nan))
      call json%close()
      call read_json(json_text(json), items, valid)
      call check(error, valid .and. json_text_at(items, "/x/0") == "null" .and. json_text_at(items, "/x/1") == "null" .and. &
                 json_text_at(items, "/x/2") == "null" .and. json_text_at(items, "/x/3") == "1" .and. &
                 json_text_at(items, "/y") == "null")
   end subroutine test_not_finite

   subroutine test_escapes()
      character(*), parameter :: degree = char(194)//char(176)
      character(:), allocatable :: quoted

      call quote_json('a"b\c', quoted)
      call check(error, quoted, '"a\"b\\c"')
      call quote_json(achar(10)//achar(9)//achar(0)//achar(127), quoted)
      call check(error, quoted, '"\u000a\u0009\u0000\u007f"')
      call quote_json(degree//"/s", quoted)
      call check(error, quoted, '"'//degree//'/s"')
   end subroutine test_escapes

   !> Overlong, surrogate, beyond U+10FFFF, cut short, a lonely continuation.
   subroutine test_utf8_invalid()
      character(:), allocatable :: quoted

      call quote_json("a"//char(176)//"b", quoted)
      call check(error, quoted, '"a\ufffdb"')
      call check(error, all([sequence_length(char(192)//char(128)), sequence_length(char(224)//char(159)//char(191)), &
                             sequence_length(char(237)//char(160)//char(128)), &
                             sequence_length(char(240)//char(143)//char(191)//char(191)), &
                             sequence_length(char(244)//char(144)//char(128)//char(128)), &
                             sequence_length(char(226)//char(130)), sequence_length(char(255))] == 0))
      call check(error, all([sequence_length("a"), sequence_length(char(194)//char(176)), &
                             sequence_length(char(226)//char(130)//char(172)//"x"), &
                             sequence_length(char(240)//char(159)//char(152)//char(128))] == [1, 2, 3, 4]))
   end subroutine test_utf8_invalid

   subroutine test_utf8_width()
      call check(error, text_width(char(207)//char(129)//"x"//char(226)//char(130)//char(172)), 3)
      call check(error, text_width(""), 0)
   end subroutine test_utf8_width

   !> The buffer grows and keeps what it holds.
   subroutine test_large()
      type(json_type) :: json
      type(json_item), allocatable :: items(:)
      logical :: valid
      integer :: i

      call json%open("", list=.true.)
      do i = 1, 3000
         call json%put("", i)
      end do
      call json%close()
      call read_json(json_text(json), items, valid)
      if (unmet(valid .and. size(items) == 3001)) return
      call check(error, json_text_at(items, "/2999"), "3000")
   end subroutine test_large

end module test_json
