! SPDX-License-Identifier: MIT
!> A table: one description, from which the report of a terminal ([[put_table]]), LaTeX and HTML
!> are made.
module gyroakf_report_text_table
   use gyroakf_record, only : text_type
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_report_html_markup, only : html_table
   use gyroakf_report_text_layout, only : pad_left, pad_right, put_heading, put_paragraph, &
      report_width
   use gyroakf_report_sign, only : to_unicode
   use gyroakf_utf8, only : is_continuation, text_width
   implicit none (type, external)
   private
   public :: table_type, new_table, add_row, set_cell, put_table, put_numbered, cell_lines, &
      cell_line, column_widths

   !> Rows and columns of text with what a paper prints about them. Read freely, filled by the
   !> subroutines below.
   type :: table_type
      !> [rows, columns] the head's rows first; a line feed in a cell begins a second line, as that
      !> of an uncertainty. The texts are ASCII with the names of signs ([[gyroakf_report_sign]]),
      !> names that a user gave are UTF-8
      type(text_type), allocatable :: cell(:, :)
      !> Rows of the head: the first one names the columns, a second one has their units
      integer :: head = 1
      !> Columns that are text, to the left; the others are numbers, to the right
      integer :: left = 1
      !> A word that no other table of a channel has; "" where the table stands in the report of a
      !> terminal alone
      character(:), allocatable :: name
      !> "I", "II", "III" as in the paper, or ""
      character(:), allocatable :: number
      !> What the table shows, without a full stop
      character(:), allocatable :: caption
      !> What its columns mean, in whole sentences, or ""
      character(:), allocatable :: note
      !> The row that was added last
      integer :: filled = 0
   end type table_type

   !> Characters of a column that is text; what is longer loses its end
   integer, parameter :: widest_text = 44

contains

   !> An empty table.
   pure subroutine new_table(table, rows, columns, head, left)
      !> The table
      type(table_type), intent(out) :: table
      !> The head included; [[add_row]] adds further ones
      integer, intent(in) :: rows
      !> All columns
      integer, intent(in) :: columns
      !> Rows of the head (default 1), columns that are text (default 1)
      integer, intent(in), optional :: head, left
      integer :: i, j

      allocate (table%cell(rows, columns))
      do j = 1, columns
         do i = 1, rows
            table%cell(i, j)%text = ""
         end do
      end do
      if (present(head)) table%head = head
      if (present(left)) table%left = left
      table%name = ""
      table%number = ""
      table%caption = ""
      table%note = ""
   end subroutine new_table

   !> Fills one cell.
   pure subroutine set_cell(table, row, column, text)
      !> The table
      type(table_type), intent(inout) :: table
      !> From 1
      integer, intent(in) :: row, column
      !> UTF-8
      character(*), intent(in) :: text

      table%cell(row, column)%text = text
   end subroutine set_cell

   !> Fills the next row, which makes the table longer where it has no place.
   pure subroutine add_row(table, name, cells)
      !> The table
      type(table_type), intent(inout) :: table
      !> The first cell
      character(*), intent(in) :: name
      !> The others with a semicolon between two of them; those that it does not have are empty
      character(*), intent(in) :: cells
      type(table_type) :: longer
      integer :: first, length, j, n

      n = table%filled
      if (n == size(table%cell, 1)) then
         call new_table(longer, n + 1, size(table%cell, 2))
         longer%cell(:n, :) = table%cell
         call move_alloc(longer%cell, table%cell)
      end if
      table%filled = n + 1
      table%cell(n + 1, 1)%text = name
      first = 1
      do j = 2, size(table%cell, 2)
         length = index(cells(first:)//";", ";") - 1
         table%cell(n + 1, j)%text = cells(first:first + length - 1)
         first = first + length + 1
      end do
   end subroutine add_row

   !> Lines of a cell.
   pure integer function cell_lines(text)
      !> Of the cell
      character(*), intent(in) :: text
      integer :: i

      cell_lines = 1
      do i = 1, len(text)
         if (text(i:i) == new_line("a")) cell_lines = cell_lines + 1
      end do
   end function cell_lines

   !> One line of a cell, "" behind the last one.
   pure function cell_line(text, number) result(line)
      !> Of the cell
      character(*), intent(in) :: text
      !> From 1
      integer, intent(in) :: number
      character(:), allocatable :: line
      integer :: first, i

      line = ""
      first = 1
      do i = 2, number
         if (index(text(first:), new_line("a")) == 0) return
         first = first + index(text(first:), new_line("a"))
      end do
      line = text(first:)
      i = index(line, new_line("a"))
      if (i > 0) line = line(:i - 1)
   end function cell_line

   !> Writes the table: columns as wide as they need to be, two blanks between them, or one where it
   !> would else be too wide. What is still wider than a line goes on below, the columns of text
   !> repeated.
   subroutine put_table(writer, table, verbatim)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Filled
      type(table_type), intent(in) :: table
      !> The texts are the user's: they are shown as they are
      logical, intent(in), optional :: verbatim
      type(table_type) :: shown
      integer, allocatable :: width(:)
      integer :: gap, first, last, i, j

      shown = table
      if (writer%unicode .and. .not. present(verbatim)) then
         do j = 1, size(shown%cell, 2)
            do i = 1, size(shown%cell, 1)
               shown%cell(i, j)%text = to_unicode(table%cell(i, j)%text)
            end do
         end do
      end if
      if (writer%markup%on) then
         call html_table(writer, shown%cell, shown%head, shown%left)
         return
      end if
      call column_widths(shown, width)
      if (total(1, size(width), 1) > report_width) then
         call shorten(shown)
         call column_widths(shown, width)
      end if
      gap = 2
      if (total(1, size(width), 2) > report_width .and. &
          total(1, size(width), 1) <= report_width) gap = 1
      last = shown%left
      do
         first = last + 1
         last = size(width)
         do while (last > first .and. total(first, last, gap) > report_width)
            last = last - 1
         end do
         call put_columns(writer, shown, width, gap, first, last)
         if (last >= size(width)) return
         call put_line(writer, "")
      end do

   contains

      !> Characters of a line: the columns of text, and some of the others.
      integer function total(first, last, gap)
         integer, intent(in) :: first, last, gap
         integer :: j

         total = 2 - gap
         do j = 1, last
            if (j <= shown%left .or. j >= first) total = total + width(j) + gap
         end do
      end function total

   end subroutine put_table

   !> Writes the table below its number and caption, and the note under it.
   subroutine put_numbered(writer, table)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> With its texts; without a number where that is ""
      type(table_type), intent(in) :: table

      if (table%number == "") call put_heading(writer, table%caption)
      if (table%number /= "") call put_heading(writer, "Table "//table%number//". "//table%caption)
      call put_table(writer, table)
      if (len(table%note) > 0) call put_paragraph(writer, table%note, 2)
   end subroutine put_numbered

   !> Characters of every column.
   pure subroutine column_widths(table, width)
      !> Filled
      type(table_type), intent(in) :: table
      !> [columns] of the longest line of a cell
      integer, allocatable, intent(out) :: width(:)
      integer :: i, j, line

      allocate (width(size(table%cell, 2)))
      width = 0
      do j = 1, size(width)
         do i = 1, size(table%cell, 1)
            do line = 1, cell_lines(table%cell(i, j)%text)
               width(j) = max(width(j), text_width(cell_line(table%cell(i, j)%text, line)))
            end do
         end do
      end do
   end subroutine column_widths

   !> The columns of text without what is too long.
   pure subroutine shorten(table)
      type(table_type), intent(inout) :: table
      integer :: i, j, last, characters

      do j = 1, table%left
         do i = 1, size(table%cell, 1)
            associate (text => table%cell(i, j)%text)
               if (text_width(text) <= widest_text .or. cell_lines(text) > 1) cycle
               characters = 0
               do last = 1, len(text)
                  if (.not. is_continuation(text(last:last))) characters = characters + 1
                  if (characters > widest_text - 3) exit
               end do
            end associate
            table%cell(i, j)%text = table%cell(i, j)%text(:last - 1)//"..."
         end do
      end do
   end subroutine shorten

   !> The columns of text, and some of the others.
   subroutine put_columns(writer, table, width, gap, first, last)
      type(writer_type), intent(inout) :: writer
      type(table_type), intent(in) :: table
      integer, intent(in) :: width(:), gap, first, last
      character(:), allocatable :: line, text
      integer :: i, j, k, lines

      do i = 1, size(table%cell, 1)
         lines = 1
         do j = 1, size(width)
            lines = max(lines, cell_lines(table%cell(i, j)%text))
         end do
         do k = 1, lines
            line = ""
            do j = 1, last
               if (j > table%left .and. j < first) cycle
               text = cell_line(table%cell(i, j)%text, k)
               line = line//repeat(" ", merge(2, gap, j == 1))
               if (j <= table%left) line = line//pad_right(text, width(j))
               if (j > table%left) line = line//pad_left(text, width(j))
            end do
            call put_line(writer, trim(line))
         end do
      end do
   end subroutine put_columns

end module gyroakf_report_text_table
