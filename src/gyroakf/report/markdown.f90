! SPDX-License-Identifier: MIT
!> The tables of [[gyroakf_report_tables]] in Markdown, as GitHub shows it.
module gyroakf_report_markdown
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_sign, only : to_unicode
   use gyroakf_report_table, only : table_type
   use gyroakf_report_tables, only : flat_text, make_tables
   implicit none (type, external)
   private
   public :: write_markdown, markdown_text

contains

   !> A section for each channel.
   subroutine write_markdown(writer, record, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      type(table_type), allocatable :: tables(:)
      type(record_type) :: view
      integer :: c, i

      call put_line(writer, "# Random errors of "//markdown_text(path_of(record), verbatim=.true.))
      call put_line(writer, "")
      call put_line(writer, "Made by gyroakf "//release_string//".")
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         call make_tables(view, result%channel(c), tables)
         call put_line(writer, "")
         call put_line(writer, "## Channel "//markdown_text(result%channel(c)%name, verbatim=.true.))
         do i = 1, size(tables)
            call put_markdown(writer, tables(i))
         end do
      end do
   end subroutine write_markdown

   !> The file's name.
   pure function path_of(record) result(path)
      type(record_type), intent(in) :: record
      character(:), allocatable :: path

      path = "a record in memory"
      if (allocated(record%path)) path = record%path
      if (path == "-") path = "standard input"
   end function path_of

   !> One table: caption, cells, note.
   subroutine put_markdown(writer, table)
      type(writer_type), intent(inout) :: writer
      type(table_type), intent(in) :: table
      integer :: i, j

      call put_line(writer, "")
      if (table%number == "") call put_line(writer, "**"//markdown_text(table%caption)//"**")
      if (table%number /= "") call put_line(writer, "**Table "//table%number//".** "//markdown_text(table%caption))
      call put_line(writer, "")
      call put(writer, "|")
      do j = 1, size(table%cell, 2)
         call put(writer, " "//head_text(table, j)//" |")
      end do
      call put_line(writer, "")
      do j = 1, size(table%cell, 2)
         call put(writer, trim(merge("|:--", "|--:", j <= table%left)))
      end do
      call put_line(writer, "|")
      do i = table%head + 1, size(table%cell, 1)
         call put(writer, "|")
         do j = 1, size(table%cell, 2)
            call put(writer, " "//markdown_text(table%cell(i, j)%text)//" |")
         end do
         call put_line(writer, "")
      end do
      if (table%note == "") return
      call put_line(writer, "")
      call put_line(writer, markdown_text(table%note))
   end subroutine put_markdown

   !> "mean, deg/s": Markdown has one line for the head.
   pure function head_text(table, column) result(text)
      type(table_type), intent(in) :: table
      integer, intent(in) :: column
      character(:), allocatable :: text
      integer :: i

      text = markdown_text(table%cell(1, column)%text)
      do i = 2, table%head
         if (table%cell(i, column)%text /= "") text = text//", "//markdown_text(table%cell(i, column)%text)
      end do
   end function head_text

   !> Signs in UTF-8, everything that means something in Markdown escaped.
   pure function markdown_text(text, verbatim) result(escaped)
      !> Of a table
      character(*), intent(in) :: text
      !> A user's: no signs in it
      logical, intent(in), optional :: verbatim
      character(:), allocatable :: escaped, shown
      integer :: i

      shown = flat_text(text)
      if (.not. present(verbatim)) shown = to_unicode(shown)
      escaped = ""
      do i = 1, len(shown)
         if (scan(shown(i:i), "\`*_{}[]<>|#~&") > 0) escaped = escaped//"\"
         if (iachar(shown(i:i)) < 32) then
            escaped = escaped//"?"
         else
            escaped = escaped//shown(i:i)
         end if
      end do
   end function markdown_text

end module gyroakf_report_markdown
