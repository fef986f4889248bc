! SPDX-License-Identifier: MIT
!> A table of text whose columns are as wide as they need to be.
module gyroakf_report_table
   use gyroakf_record, only : text_type
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_report_layout, only : pad_left, pad_right
   use gyroakf_utf8, only : text_width
   implicit none (type, external)
   private
   public :: table_type, new_table, set_cell, put_table

   !> Rows and columns of text
   type :: table_type
      private
      type(text_type), allocatable :: cell(:, :)
   end type table_type

contains

   !> An empty table.
   pure subroutine new_table(table, rows, columns)
      !> The table
      type(table_type), intent(out) :: table
      !> The head included
      integer, intent(in) :: rows
      !> All columns
      integer, intent(in) :: columns
      integer :: i, j

      allocate (table%cell(rows, columns))
      do j = 1, columns
         do i = 1, rows
            table%cell(i, j)%text = ""
         end do
      end do
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

   !> Writes the table: the first `left` columns to the left, the others to the right, two blanks between.
   subroutine put_table(writer, table, left)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Filled
      type(table_type), intent(in) :: table
      !> Columns that are text
      integer, intent(in) :: left
      integer, allocatable :: width(:)
      character(:), allocatable :: line
      integer :: i, j

      allocate (width(size(table%cell, 2)))
      do j = 1, size(width)
         width(j) = 0
         do i = 1, size(table%cell, 1)
            width(j) = max(width(j), text_width(table%cell(i, j)%text))
         end do
      end do
      do i = 1, size(table%cell, 1)
         line = ""
         do j = 1, size(width)
            line = line//"  "
            if (j <= left) then
               line = line//pad_right(table%cell(i, j)%text, width(j))
            else
               line = line//pad_left(table%cell(i, j)%text, width(j))
            end if
         end do
         call put_line(writer, trim(line))
      end do
   end subroutine put_table

end module gyroakf_report_table
