! SPDX-License-Identifier: MIT
!> The tables of [[gyroakf_report_tables]] in LaTeX, to be taken into a paper by \input; booktabs is
!> all that they need.
module gyroakf_report_latex
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_text_layout, only : count_text, if_known
   use gyroakf_report_sign, only : find_power, find_root, find_sign, signs
   use gyroakf_report_text_table, only : table_type
   use gyroakf_report_tables, only : make_tables
   implicit none (type, external)
   private
   public :: write_latex, latex_text, flat_text, latex_mark

   !> Begins the file
   character(*), parameter :: latex_mark = "% Made by gyroakf "

   character(*), parameter :: digits = "0123456789"

contains

   !> The tables of all channels.
   subroutine write_latex(writer, record, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      type(table_type), allocatable :: tables(:)
      type(record_type) :: view
      integer :: c, i

      call put_line(writer, latex_mark//release_string//". In the preamble: \usepackage{booktabs}")
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         call make_tables(view, result%channel(c), tables)
         do i = 1, size(tables)
            call put_latex(writer, tables(i), result%channel(c)%name, &
                           "tab:gyroakf-"//count_text(int(c, int64))//"-"//tables(i)%name)
         end do
      end do
   end subroutine write_latex

   !> One table as a float.
   subroutine put_latex(writer, table, channel, label)
      type(writer_type), intent(inout) :: writer
      type(table_type), intent(in) :: table
      character(*), intent(in) :: channel, label
      character(:), allocatable :: line
      integer :: i, j, columns

      columns = size(table%cell, 2)
      call put_line(writer, "")
      call put_line(writer, "\begin{table}")
      call put_line(writer, "  \centering")
      call put_line(writer, "  \caption{"//latex_text(table%caption)//"; channel "// &
                    latex_text(channel, verbatim=.true.)//"}")
      call put_line(writer, "  \label{"//label//"}")
      call put_line(writer, if_known(columns <= 6, "  \footnotesize\setlength{\tabcolsep}{4pt}", &
                                     "  \scriptsize\setlength{\tabcolsep}{3pt}"))
      call put_line(writer, "  \begin{tabular}{"//repeat("l", table%left)// &
                    repeat("r", columns - table%left)//"}")
      call put_line(writer, "    \toprule")
      do i = 1, size(table%cell, 1)
         line = "    "
         do j = 1, columns
            line = line//if_known(j > 1, " & ")//latex_text(table%cell(i, j)%text)
         end do
         call put_line(writer, line//" \\")
         if (i == table%head) call put_line(writer, "    \midrule")
      end do
      call put_line(writer, "    \bottomrule")
      call put_line(writer, "  \end{tabular}")
      if (table%note /= "") call put_line(writer, "  \par\smallskip\parbox{0.9\linewidth}{"// &
                                          latex_text(table%note)//"}")
      call put_line(writer, "\end{table}")
   end subroutine put_latex

   !> Signs and numbers as mathematics, everything that means something in LaTeX escaped.
   pure function latex_text(text, verbatim) result(escaped)
      !> Of a table
      character(*), intent(in) :: text
      !> A user's: no signs in it
      logical, intent(in), optional :: verbatim
      character(:), allocatable :: escaped, flat, piece
      integer :: i, last

      flat = flat_text(text)
      escaped = ""
      if (flat == "-" .and. .not. present(verbatim)) flat = "--"
      i = 1
      do while (i <= len(flat))
         last = 0
         if (.not. present(verbatim)) call take_sign(flat, i, piece, last)
         if (last == 0) then
            call take_byte(flat(i:i), piece)
            if (flat(i:i) == "-" .and. i > 1) then    ! no dash is made of the hyphens of an option
               if (flat(i - 1:i - 1) == "-" .and. flat /= "--") piece = "{}-"
            end if
            last = i
         end if
         escaped = escaped//piece
         i = last + 1
      end do
   end function latex_text

   !> The lines of a cell in one: an uncertainty behind its value, the parts of a unit together.
   pure function flat_text(text) result(line)
      !> Of a cell
      character(*), intent(in) :: text
      character(:), allocatable :: line
      integer :: i

      line = ""
      do i = 1, len(text)
         if (text(i:i) /= new_line("a")) then
            line = line//text(i:i)
         else if (scan(text(min(i + 1, len(text)):min(i + 1, len(text))), "*/") == 0) then
            line = line//" "
         end if
      end do
      line = trim(adjustl(line))
   end function flat_text

   !> What begins at a byte and is mathematics: `last` is its last byte, 0 where there is none.
   pure subroutine take_sign(text, i, piece, last)
      character(*), intent(in) :: text
      integer, intent(in) :: i
      character(:), allocatable, intent(out) :: piece
      integer, intent(out) :: last
      integer :: row

      row = find_sign(text, i)
      if (row > 0) then
         piece = "$"//trim(signs(row)%latex)//"$"
         last = i + len_trim(signs(row)%ascii) - 1
         return
      end if
      last = find_root(text, i)
      if (last > 0) then
         piece = "$\sqrt{\mathrm{"//text(i + 5:last - 1)//"}}$"
         return
      end if
      last = find_power(text, i)
      if (last > 0) then
         piece = "$^{"//text(i + 1:last)//"}$"
         return
      end if
      call take_exponent(text, i, piece, last)
      if (last > 0 .or. .not. is_minus(text, i)) return
      piece = "$-$"
      last = i
   end subroutine take_sign

   !> "e-04" behind a digit is a power of ten, "e+00" nothing.
   pure subroutine take_exponent(text, i, piece, last)
      character(*), intent(in) :: text
      integer, intent(in) :: i
      character(:), allocatable, intent(inout) :: piece
      integer, intent(out) :: last
      character(12) :: power
      integer :: value, stat

      last = 0
      if (i < 2 .or. i + 2 > len(text)) return
      if (text(i:i) /= "e" .or. scan(text(i - 1:i - 1), digits) == 0 .or. &
          scan(text(i + 1:i + 1), "+-") == 0 .or. scan(text(i + 2:i + 2), digits) == 0) return
      last = i + verify(text(i + 2:)//" ", digits)
      read (text(i + 1:last), *, iostat=stat) value
      if (stat /= 0) last = 0
      if (last == 0) return
      write (power, "(i0)") value
      piece = if_known(value /= 0, "$\times10^{"//trim(power)//"}$")
   end subroutine take_exponent

   !> A hyphen that is the sign of a number.
   pure logical function is_minus(text, i)
      character(*), intent(in) :: text
      integer, intent(in) :: i

      is_minus = .false.
      if (text(i:i) /= "-" .or. i == len(text)) return
      if (scan(text(i + 1:i + 1), digits) == 0) return
      is_minus = i == 1
      if (i > 1) is_minus = scan(text(i - 1:i - 1), " (") > 0
   end function is_minus

   !> One byte.
   pure subroutine take_byte(byte, piece)
      character(1), intent(in) :: byte
      character(:), allocatable, intent(out) :: piece

      select case (byte)
      case ("&", "%", "$", "#", "_", "{", "}"); piece = "\"//byte
      case ("<", ">", "|"); piece = "$"//byte//"$"
      case ("\"); piece = "\textbackslash{}"
      case ("~"); piece = "\textasciitilde{}"
      case ("^"); piece = "\textasciicircum{}"
      case default
         piece = byte
         if (iachar(byte) < 32) piece = "?"
      end select
   end subroutine take_byte

end module gyroakf_report_latex
