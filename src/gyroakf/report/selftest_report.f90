! SPDX-License-Identifier: MIT
!> The self-test as a table.
module gyroakf_report_selftest_report
   use gyroakf_kinds, only : int64
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_release, only : release_string
   use gyroakf_report_text_layout, only : count_text, pad_left, pad_right, scientific
   use gyroakf_selftest, only : selftest_type
   implicit none (type, external)
   private
   public :: report_selftest, selftest_sum

contains

   !> A line per check, and the sum.
   subroutine report_selftest(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of [[run_selftest]]
      type(selftest_type), intent(in) :: result
      integer :: i

      call put_line(writer, "gyroakf "//release_string//": self-test")
      call put_line(writer, "")
      call put_line(writer, "  "//pad_right("", 48)//"expected          got")
      do i = 1, size(result%check)
         associate (check => result%check(i))
            call put_line(writer, "  "//pad_right(trim(check%group)//", "//trim(check%name), 43)// &
               pad_left(scientific(check%expected, 7), 13)// &
               pad_left(scientific(check%got, 7), 13)//"  "// &
               trim(merge("ok    ", "FAILED", check%passed)))
            if (check%problem /= "") call put_line(writer, "    "//trim(check%problem))
         end associate
      end do
      call put_line(writer, "")
      call put_line(writer, selftest_sum(result))
   end subroutine report_selftest

   !> "31 checks, all agree", "31 checks, 2 FAILED".
   pure function selftest_sum(result) result(text)
      !> Of [[run_selftest]]
      type(selftest_type), intent(in) :: result
      character(:), allocatable :: text

      text = count_text(size(result%check, kind=int64))//" checks, "
      if (result%failed == 0) text = text//"all agree"
      if (result%failed > 0) text = text//count_text(int(result%failed, int64))//" FAILED"
   end function selftest_sum

end module gyroakf_report_selftest_report
