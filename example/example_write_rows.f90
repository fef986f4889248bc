! SPDX-License-Identifier: MIT
!> Columns of numbers as text, with as few digits as read back to the same numbers; here on standard output.
program example_write_rows
   use gyroakf, only : dp, int8, int64, error_type, writer_type, open_writer, put_line, commit_writer
   use gyroakf_io_columns_writer, only : column_type, row_layout_type, put_rows
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(writer_type) :: writer
   type(column_type) :: columns(2)
   real(dp), target :: rate(4)
   integer(int8), target :: present(4)

   rate = [0.1_dp, 0.1_dp + 0.2_dp, 1.0e-9_dp, -2.0_dp]
   present = [1_int8, 1_int8, 0_int8, 1_int8]
   columns(1) = column_type(step=0.01_dp, digits=15)
   columns(2)%value => rate
   columns(2)%present => present
   call open_writer(writer, "-", error)                          ! a name makes a file that appears whole or not at all
   if (allocated(error)) error stop error%message
   call put_line(writer, "t,gx")
   call put_rows(writer, columns, size(rate, kind=int64), row_layout_type(), error)     ! form="npy": a NumPy file
   if (.not. allocated(error)) call commit_writer(writer, error)
   if (allocated(error)) error stop error%message
end program example_write_rows
