! SPDX-License-Identifier: MIT
!> Names of columns in a comment, as `rostopic echo -p` (`%time,field.x`) and numpy's `savetxt` (`# t gx gy`) write them.
module gyroakf_io_comment_names
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : is_time_name
   use gyroakf_io_columns, only : column_names_type, names_way, read_names
   use gyroakf_io_text, only : last_visible, split
   implicit none (type, external)
   private
   public :: suppose_names

contains

   !> Takes a comment for names of columns: words between commas, semicolons or tabs, or a time and words between blanks.
   !>
   !> Whether they are names is decided later, by the number of columns.
   subroutine suppose_names(bytes, first, last, line, supposed)
      !> Holds the line at first:last; a line feed is behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> Number of the line
      integer(int64), intent(in) :: line
      !> Left alone where the comment is no list of words, or has a colon or an equals sign
      type(column_names_type), intent(inout) :: supposed
      type(column_names_type) :: names
      integer(int64) :: from, to
      integer :: i

      if (any(bytes(first:last) == iachar(":") .or. bytes(first:last) == iachar("="))) return
      from = first
      do while (from <= last)
         if (scan(achar(iand(int(bytes(from)), 127)), "#%;/! "//achar(9)) == 0) exit
         from = from + 1
      end do
      to = last_visible(bytes, from, last)
      if (to < from) return
      call read_names(bytes, from, to, line, names)
      if (.not. names%known) return
      if (size(names%name) < 2) return
      if (names_way(bytes, from, to) == split%mixed .and. .not. is_time_name(names%name(1)%text)) return
      do i = 1, size(names%name)
         if (len(names%name(i)%text) == 0) cycle
         if (scan(names%name(i)%text(1:1), "+-0123456789") > 0) return
         if (names%name(i)%text(1:1) == "." .and. scan(names%name(i)%text, "0123456789") == 2) return
      end do
      supposed = names
   end subroutine suppose_names

end module gyroakf_io_comment_names
