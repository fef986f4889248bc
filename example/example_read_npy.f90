! SPDX-License-Identifier: MIT
!> NumPy's array in memory: integers of an angle counter that begins again at 65536 become rates. Raw numbers without NumPy's
!> header are read with `options%format = "i16"` and `options%channels`.
program example_read_npy
   use gyroakf, only : dp, int8, int16, error_type, reader_options, read_record, record_type
   implicit none (type, external)
   character(*), parameter :: header = "{'descr': '<u2', 'fortran_order': False, 'shape': (6,)}"
   integer(int16), parameter :: counts(6) = [65500, 65520, 4, 24, 44, 64] - [65536, 65536, 0, 0, 0, 0]
   type(error_type), allocatable :: error
   type(reader_options) :: options
   type(record_type) :: record
   integer(int8), allocatable, target :: bytes(:)
   character(:), allocatable :: head

   head = header//repeat(" ", 128 - 10 - len(header) - 1)//new_line("a")
   head = achar(147)//"NUMPY"//achar(1)//achar(0)//achar(118)//achar(0)//head
   allocate (bytes(len(head) + 12))
   bytes(:len(head)) = transfer(head, bytes, len(head))
   bytes(len(head) + 1:) = transfer(counts, bytes, 12)           ! this machine is little endian
   options%bytes => bytes
   options%rate_hz = 100.0_dp
   options%input = "angle"                                       ! wraps at 65536 by itself: the file says 16 bits without sign
   options%unit = "deg"
   options%scale = 0.001_dp
   call read_record("counter.npy", options, record, error)
   if (allocated(error)) error stop error%message
   print "(4a)", record%format, ", ", record%stored_type, ", in "//record%unit%name
   print "(*(f0.3, 1x))", record%value(:, 1)
end program example_read_npy
