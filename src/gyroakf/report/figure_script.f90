! SPDX-License-Identifier: MIT
!> The frame of every gnuplot script: terminal, colours, grids, and texts as gnuplot takes them.
!>
!> Colours are those of Okabe and Ito, told apart by the colour-blind; curves differ in their dashes or signs too, for print.
module gyroakf_report_figure_script
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_release, only : release_string
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: begin_script, put_axes, add_curve, end_plot, literal, begin_block, put_numbers, end_block, figure_formats
   public :: blue, orange, green, sky, purple, yellow, black, grey

   !> What --plot takes
   character(3), parameter :: figure_formats(3) = ["png", "svg", "pdf"]

   character(*), parameter :: blue = "'#0072B2'", orange = "'#D55E00'", green = "'#009E73'", sky = "'#56B4E9'", &
      purple = "'#CC79A7'", yellow = "'#E69F00'", black = "'#000000'", grey = "'#999999'"

contains

   !> A curve of a plot: the first one begins it.
   subroutine add_curve(writer, curves, what, style, title)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> So many the plot has already
      integer, intent(inout) :: curves
      !> Data and columns, or a formula
      character(*), intent(in) :: what
      !> Behind "with"
      character(*), intent(in) :: style
      !> In the key; "" for none
      character(*), intent(in) :: title

      if (curves == 0) call put(writer, "plot ")
      if (curves > 0) then
         call put_line(writer, ", \")
         call put(writer, "     ")
      end if
      call put(writer, what//" with "//style)
      if (title == "") then
         call put(writer, " notitle")
      else
         call put(writer, " title "//literal(title))
      end if
      curves = curves + 1
   end subroutine add_curve

   !> After the last curve.
   subroutine end_plot(writer, curves)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> None afterwards
      integer, intent(inout) :: curves

      call put_line(writer, "")
      curves = 0
   end subroutine end_plot

   !> Head of a script: what it is, terminal, output, style.
   subroutine begin_script(writer, name, form, title, tall)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of the figure, without ending
      character(*), intent(in) :: name
      !> One of [[gyroakf_report_figure_script:figure_formats]]
      character(*), intent(in) :: form
      !> Above the figure
      character(*), intent(in) :: title
      !> Two panels
      logical, intent(in) :: tall

      call put_line(writer, "# By gyroakf "//release_string//". In this folder, gnuplot "//name//".gp makes "//name//"."//form// &
                    "; change what you like.")
      call put_line(writer, "set encoding utf8")
      select case (form)
      case ("png"); call put_line(writer, "set terminal pngcairo size "//trim(merge("1500,1500", "1500, 930", tall))// &
                                  " font 'sans-serif,18' linewidth 1.6")
      case ("pdf"); call put_line(writer, "set terminal pdfcairo size "//trim(merge("18cm,18cm", "18cm,11cm", tall))// &
                                  " font 'sans-serif,9'")
      case default; call put_line(writer, "set terminal svg size "//trim(merge("900,900", "900,560", tall))// &
                                  " dynamic font 'sans-serif,14' background '#ffffff'")
      end select
      call put_line(writer, "if (!exists('figure')) figure = '"//name//"."//form//"'")
      call put_line(writer, "set output figure")
      call put_line(writer, "set datafile separator ','")
      call put_line(writer, "set datafile missing 'nan'")
      call put_line(writer, "set border 3 lw 1.2 lc rgb '#444444'")
      call put_line(writer, "set tics nomirror out scale 0.8")
      call put_line(writer, "set grid xtics ytics mxtics mytics lt 1 lc rgb '#cccccc' lw 0.8, lt 1 lc rgb '#ececec' lw 0.5")
      call put_line(writer, "set key outside right top Left reverse samplen 2.5 noenhanced")
      call put_line(writer, "set style fill transparent solid 0.2 noborder")
      call put_line(writer, "set title "//literal(title)//" noenhanced")
   end subroutine begin_script

   !> Names and scales of the axes.
   subroutine put_axes(writer, x, y, logarithmic)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> With their units
      character(*), intent(in) :: x, y
      !> Which axes: "xy", "x", "y", ""
      character(*), intent(in) :: logarithmic
      integer :: i

      call put_line(writer, "set xlabel "//literal(x)//" noenhanced")
      call put_line(writer, "set ylabel "//literal(y)//" noenhanced")
      if (logarithmic /= "") call put_line(writer, "set logscale "//logarithmic)
      do i = 1, len(logarithmic)
         call put_line(writer, "set format "//logarithmic(i:i)//" '10^{%T}'")
      end do
   end subroutine put_axes

   !> A text in gnuplot's single quotes.
   pure function literal(text) result(quoted)
      character(*), intent(in) :: text
      character(:), allocatable :: quoted
      integer :: i

      quoted = "'"
      do i = 1, len(text)
         if (text(i:i) == "'") quoted = quoted//"'"
         quoted = quoted//text(i:i)
      end do
      quoted = quoted//"'"
   end function literal

   !> A block of data that a script takes by its name.
   subroutine begin_block(writer, name)
      !> Open
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name

      call put_line(writer, "# "//name)
   end subroutine begin_block

   !> Two empty lines part the blocks; one without a line of data would not count, so it has none of any meaning.
   subroutine end_block(writer, columns)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Columns of that line; absent where the block has lines
      integer, intent(in), optional :: columns

      if (present(columns)) call put_line(writer, "nan"//repeat(",nan", columns - 1))
      call put_line(writer, "")
      call put_line(writer, "")
   end subroutine end_block

   !> Numbers of a line of data, separated by commas.
   subroutine put_numbers(writer, values)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What is not finite becomes nan
      real(dp), intent(in) :: values(:)
      integer :: i

      do i = 1, size(values)
         if (i > 1) call put(writer, ",")
         if (ieee_is_finite(values(i))) then
            call put_real(writer, values(i), 10)
         else
            call put(writer, "nan")
         end if
      end do
      call put_line(writer, "")
   end subroutine put_numbers

end module gyroakf_report_figure_script
