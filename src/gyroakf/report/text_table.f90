! SPDX-License-Identifier: MIT
!> A table: one description, from which the report of a terminal and a page are made.
module gyroakf_report_text_table
   use gyroakf_record, only : text_type
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_report_html_markup, only : html_table
   use gyroakf_report_text_layout, only : pad_left, pad_right, put_heading, put_paragraph, &
      report_width, to_unicode
   use gyroakf_utf8, only : text_width
   implicit none (type, external)
   private
   public :: table_type, new_table, add_row, add_cell, put_table, put_numbered, cell_line, &
      column_widths

   !> Rows and columns of text with what a paper prints about them. Read freely, filled by the
   !> subroutines below.
   type :: table_type
      !> [rows, columns] the head's rows first; a line feed in a cell begins a second line, as that
      !> of an uncertainty. The texts are ASCII with the names of signs
      !> ([[gyroakf_report_number_text]]), names that a user gave are UTF-8
      type(text_type), allocatable :: cell(:, :)
      !> Rows of the head: the first one names the columns, a second one has their units
      integer :: head = 1
      !> Columns that are text, to the left; the others are numbers, to the right
      integer :: left = 1
      !> "I", "II", "III" as in the paper, or ""
      character(:), allocatable :: number
      !> What the table shows, without a full stop
      character(:), allocatable :: caption
      !> What its columns mean, in whole sentences, or ""
      character(:), allocatable :: note
      !> Cells of the last row that are filled
      integer :: filled = 0
   end type table_type

   !> Characters of a column that is text; what is longer loses its end
   integer, parameter :: widest_text = 44

contains

   !> An empty table.
   pure subroutine new_table(table, columns, head, left)
      type(table_type), intent(out) :: table
      !> All columns
      integer, intent(in) :: columns
      !> Rows of the head (default 1), columns that are text (default 1)
      integer, intent(in), optional :: head, left

      allocate (table%cell(0, columns))
      if (present(head)) table%head = head
      if (present(left)) table%left = left
      table%number = ""
      table%caption = ""
      table%note = ""
   end subroutine new_table

   !> Adds a row; the cells that are not given are empty.
   pure subroutine add_row(table, cell_1, cell_2, cell_3, cell_4, cell_5, cell_6, cell_7, cell_8, &
                           cell_9)
      type(table_type), intent(inout) :: table
      !> From the first column on; UTF-8
      character(*), intent(in), optional :: cell_1, cell_2, cell_3, cell_4, cell_5, cell_6, &
                                            cell_7, cell_8, cell_9
      type(text_type), allocatable :: longer(:, :)
      integer :: n, j

      n = size(table%cell, 1)
      allocate (longer(n + 1, size(table%cell, 2)))
      longer(:n, :) = table%cell
      do j = 1, size(longer, 2)
         longer(n + 1, j)%text = ""
      end do
      call move_alloc(longer, table%cell)
      table%filled = 0
      call add_cell(table, cell_1)
      call add_cell(table, cell_2)
      call add_cell(table, cell_3)
      call add_cell(table, cell_4)
      call add_cell(table, cell_5)
      call add_cell(table, cell_6)
      call add_cell(table, cell_7)
      call add_cell(table, cell_8)
      call add_cell(table, cell_9)
   end subroutine add_row

   !> Fills the next cell of the last row.
   pure subroutine add_cell(table, text)
      type(table_type), intent(inout) :: table
      !> UTF-8; absent: nothing is done
      character(*), intent(in), optional :: text

      if (.not. present(text)) return
      table%filled = table%filled + 1
      table%cell(size(table%cell, 1), table%filled)%text = text
   end subroutine add_cell

   !> One of the two lines of a cell, "" where it has one alone.
   pure function cell_line(text, number) result(line)
      !> Of the cell
      character(*), intent(in) :: text
      !> 1 or 2
      integer, intent(in) :: number
      character(:), allocatable :: line
      integer :: feed

      feed = index(text//new_line("a"), new_line("a"))
      line = text(:feed - 1)
      if (number == 2) line = text(min(feed + 1, len(text) + 1):)
   end function cell_line

   !> Writes the table: columns as wide as they need to be, two blanks between them, or one where it
   !> would else be too wide. What is still wider than a line goes on below, the columns of text
   !> repeated.
   subroutine put_table(writer, table, verbatim)
      type(writer_type), intent(inout) :: writer
      !> Filled
      type(table_type), intent(in) :: table
      !> The texts are the user's: they are shown as they are
      logical, intent(in), optional :: verbatim
      type(table_type) :: shown
      integer, allocatable :: width(:)
      integer :: gap, first, last, i, j

      shown = table
      do j = 1, merge(size(shown%cell, 2), 0, writer%unicode .and. .not. present(verbatim))
         do i = 1, size(shown%cell, 1)
            if (j == 1 .and. i > shown%head .and. shown%left > 0) exit          ! names of a user
            shown%cell(i, j)%text = to_unicode(table%cell(i, j)%text)
         end do
      end do
      if (writer%markup%on) then
         call html_table(writer, shown%cell, shown%head, shown%left)
         return
      end if
      call column_widths(shown, width)
      if (total(1, size(width), 1) > report_width) then
         do j = 1, shown%left
            do i = 1, size(shown%cell, 1)
               associate (text => shown%cell(i, j)%text)
                  if (text_width(text) <= widest_text) cycle
                  last = len(text)
                  do while (text_width(text(:last)) > widest_text - 3)
                     last = last - 1
                  end do
               end associate
               shown%cell(i, j)%text = shown%cell(i, j)%text(:last)//"..."
            end do
         end do
         call column_widths(shown, width)
      end if
      gap = merge(1, 2, total(1, size(width), 2) > report_width .and. &
                  total(1, size(width), 1) <= report_width)
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
      type(writer_type), intent(inout) :: writer
      !> With its texts; without a number where that is ""
      type(table_type), intent(in) :: table

      if (table%number == "") call put_heading(writer, table%caption)
      if (table%number /= "") call put_heading(writer, "Table "//table%number//". "//table%caption)
      call put_table(writer, table)
      if (len(table%note) > 0) call put_paragraph(writer, table%note)
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
            do line = 1, 2
               width(j) = max(width(j), text_width(cell_line(table%cell(i, j)%text, line)))
            end do
         end do
      end do
   end subroutine column_widths

   !> The columns of text, and some of the others.
   subroutine put_columns(writer, table, width, gap, first, last)
      type(writer_type), intent(inout) :: writer
      type(table_type), intent(in) :: table
      integer, intent(in) :: width(:), gap, first, last
      character(:), allocatable :: line, text
      integer :: i, j, k

      do i = 1, size(table%cell, 1)
         do k = 1, 2
            if (k == 2 .and. .not. any([(index(table%cell(i, j)%text, new_line("a")) > 0, &
                                         j=1, size(width))])) exit
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
