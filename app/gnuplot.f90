! SPDX-License-Identifier: MIT
!> Figures by gnuplot, a program that is looked for when it is wanted.
module gyroakf_app_gnuplot
   use, intrinsic :: iso_c_binding, only : c_null_char
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_system, only : c_rename, c_rmdir, c_unlink
   use gyroakf_record, only : text_type
   use gyroakf_app_words, only : shell_quoted
   implicit none (type, external)
   private
   public :: check_gnuplot, draw_figures, remove_figures

   character(*), parameter :: nl = new_line("a")

contains

   !> Says how to get gnuplot where it is not there.
   subroutine check_gnuplot(error)
      !> io
      type(error_type), allocatable, intent(out) :: error
      integer :: code, failed

      call execute_command_line("command -v gnuplot >/dev/null 2>&1", exitstat=code, cmdstat=failed)
      if (failed == 0 .and. code == 0) return
      call fatal_error(error, status%io, "--plot needs gnuplot, which is not found"//nl// &
                       "install it: apt install gnuplot-nox (Debian, Ubuntu), dnf install gnuplot (Fedora), brew install gnuplot")
   end subroutine check_gnuplot

   !> Runs the scripts; a figure appears whole or not at all.
   subroutine draw_figures(folder, form, figures, error)
      !> Of the scripts
      character(*), intent(in) :: folder
      !> Ending of the figures
      character(*), intent(in) :: form
      !> Names of the scripts, [n]
      type(text_type), intent(in) :: figures(:)
      !> io: gnuplot fails, in its words
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: name, part
      integer :: i, code, failed

      do i = 1, size(figures)
         name = figures(i)%text//"."//form
         part = name//".part"
         call execute_command_line("cd -- "//shell_quoted(folder)//" && gnuplot -e ""figure='"//part//"'"" "// &
                                   figures(i)%text//".gp >gnuplot.log 2>&1", exitstat=code, cmdstat=failed)
         if (failed == 0 .and. code == 0) then
            code = c_rename(folder//"/"//part//c_null_char, folder//"/"//name//c_null_char)
            if (code == 0) cycle
         end if
         call fatal_error(error, status%io, folder//"/"//figures(i)%text//".gp: gnuplot makes no figure of it"//nl// &
                          first_line(folder//"/gnuplot.log"))
         code = c_unlink(folder//"/"//part//c_null_char)
         return
      end do
      code = c_unlink(folder//"/gnuplot.log"//c_null_char)
   end subroutine draw_figures

   !> Removes figures that were drawn for something else, their scripts, their data, and the folder, which holds nothing else.
   subroutine remove_figures(folder, form, figures)
      !> Of the scripts
      character(*), intent(in) :: folder
      !> Ending of the figures
      character(*), intent(in) :: form
      !> Names of the scripts, [n]
      type(text_type), intent(in) :: figures(:)
      integer :: i, code

      do i = 1, size(figures)
         associate (name => folder//"/"//figures(i)%text//".")
            code = c_unlink(name//"gp"//c_null_char)
            code = c_unlink(name//"dat"//c_null_char)
            code = c_unlink(name//form//c_null_char)
         end associate
      end do
      code = c_unlink(folder//"/gnuplot.log"//c_null_char)
      code = c_rmdir(folder//c_null_char)
   end subroutine remove_figures

   !> What gnuplot said, its first line that is not empty.
   function first_line(path) result(line)
      character(*), intent(in) :: path
      character(:), allocatable :: line
      character(300) :: text
      integer :: unit, failed

      line = "see gnuplot.log there"
      open (newunit=unit, file=path, status="old", action="read", iostat=failed)
      if (failed /= 0) return
      do
         read (unit, "(a)", iostat=failed) text
         if (failed /= 0) exit
         if (text == "" .or. verify(text, " ^") == 0) cycle
         line = trim(adjustl(text))
      end do
      close (unit)
   end function first_line

end module gyroakf_app_gnuplot
