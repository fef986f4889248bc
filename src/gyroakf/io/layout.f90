! SPDX-License-Identifier: MIT
!> What the rows of a table look like, and what may be wrong with one.
module gyroakf_io_layout
   use gyroakf_kinds, only : dp, int64, int8
   implicit none (type, external)
   private
   public :: layout_type, problem_type

   !> Which columns a file has, and which of them are kept
   type :: layout_type
      !> Columns of every row
      integer :: columns = 0
      !> Columns that are kept
      integer :: stored = 0
      !> Where a column is kept, 0 where it is not: [column]
      integer, allocatable :: slot(:)
      !> The last column may be left away: the first row ended with a separator
      logical :: last_optional = .false.
      !> Columns of dates and times of day: one of the components of stamp_kind, negative where it
      !> is added to what another column of the same slot gave: [column]
      integer, allocatable :: kind(:)
      !> Stamps are counted from this day or whole number
      integer(int64) :: origin = 0
      !> The column that is a date and a time of day with blanks between them, 0 where there is none
      integer :: joined = 0
      !> What commas are, see [[gyroakf_io_commas]]: 0 where they part columns
      integer :: commas = 0
      !> The line of the names: where it is met again it is no row; unallocated where there is none
      integer(int8), allocatable :: heading(:)
      !> Only rows are read that hold this in this column, 0 for all rows
      integer :: where_column = 0
      integer(int8), allocatable :: where_value(:)
      !> The value as a number, NaN where it is none
      real(dp) :: where_number = 0.0_dp
      !> Other rows are wrong: a column of words distinguishes records of several kinds
      logical :: strict = .false.
      !> Rows hold labels or brackets, see [[gyroakf_io_marks]]; only those of the first row are
      !> read, others are wrong, or left out
      logical :: marked = .false., where_label = .false.
      integer(int64) :: skeleton = 0
      !> Lines that cannot be read count as missing samples instead of being an error
      logical :: bad_lines_missing = .false.
      !> Semicolons part the columns: a line that begins with one may be a row
      logical :: semicolons = .false.
   end type layout_type

   !> What is wrong with a row
   type :: problem_type
      !> False where nothing is
      logical :: found = .false.
      !> The byte
      integer(int64) :: at = 0
      !> What is wrong, and what to do; unallocated where texts are not requested
      character(:), allocatable :: what, advice
   end type problem_type

end module gyroakf_io_layout
