! SPDX-License-Identifier: MIT
!> A row of the summary as one text, to be sent from one process to another: fields with their lengths in front.
module gyroakf_app_row_text
   use gyroakf_error, only : status
   use gyroakf_report_summary, only : summary_row_type
   implicit none (type, external)
   private
   public :: row_to_text, row_from_text

   !> Digits of a length
   integer, parameter :: head = 12

contains

   !> Packs a row.
   subroutine row_to_text(row, problem, text)
      !> The row
      type(summary_row_type), intent(in) :: row
      !> Component of `status`
      integer, intent(in) :: problem
      !> Everything
      character(:), allocatable, intent(out) :: text
      integer :: i, j

      text = count_field(problem)//count_field(row%code)//field(row%path)//field(row%folder)//field(row%message)//field(row%csv)// &
         & field(row%json)//count_field(size(row%cell, 1))//count_field(size(row%cell, 2))
      do j = 1, size(row%cell, 2)
         do i = 1, size(row%cell, 1)
            text = text//field(row%cell(i, j)%text)
         end do
      end do
   end subroutine row_to_text

   !> Unpacks it.
   subroutine row_from_text(text, row, problem)
      !> Of [[row_to_text]]
      character(*), intent(in) :: text
      !> The row
      type(summary_row_type), intent(out) :: row
      !> Component of `status`
      integer, intent(out) :: problem
      integer :: at, rows, columns, i, j

      at = 1
      call next_count(text, at, problem)
      call next_count(text, at, row%code)
      call next_field(text, at, row%path)
      call next_field(text, at, row%folder)
      call next_field(text, at, row%message)
      call next_field(text, at, row%csv)
      call next_field(text, at, row%json)
      call next_count(text, at, rows)
      call next_count(text, at, columns)
      allocate (row%cell(rows, columns))
      do j = 1, columns
         do i = 1, rows
            call next_field(text, at, row%cell(i, j)%text)
         end do
      end do
   end subroutine row_from_text

   !> A number of fixed width.
   function count_field(n) result(text)
      integer, intent(in) :: n
      character(head) :: text

      write (text, "(i12)") n
   end function count_field

   !> A text with its length.
   function field(text) result(packed)
      character(*), intent(in) :: text
      character(:), allocatable :: packed

      packed = count_field(len(text))//text
   end function field

   !> Takes a number.
   subroutine next_count(text, at, n)
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      integer, intent(out) :: n
      integer :: stat

      read (text(at:at + head - 1), "(i12)", iostat=stat) n
      if (stat /= 0) n = status%internal
      at = at + head
   end subroutine next_count

   !> Takes a text.
   subroutine next_field(text, at, part)
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      character(:), allocatable, intent(out) :: part
      integer :: length

      call next_count(text, at, length)
      part = text(at:at + length - 1)
      at = at + length
   end subroutine next_field

end module gyroakf_app_row_text
