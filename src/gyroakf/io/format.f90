! SPDX-License-Identifier: MIT
!> What a file looks like before it is read: text or something else.
!>
!> The content decides; bytes without a signature are what the name ends in (`.f64`, `.i16be`).
module gyroakf_io_format
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_element, only : element_type, parse_element
   use gyroakf_io_npy, only : npy_magic
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_text, only : bytes_text
   use gyroakf_spelling, only : lower, replace_all
   implicit none (type, external)
   private
   public :: content_type, recognize_content

   !> What a file holds
   type :: content_type
      !> "text", "npy", "binary" (by the name) or "foreign"
      character(7) :: kind = "text"
      !> Of "binary"
      type(element_type) :: element
      !> Of the name, in lower case, without the point
      character(:), allocatable :: ending
      !> Of "foreign": what it is, as in "compressed by zstd", and what to do
      character(:), allocatable :: what, advice
      !> Position of the byte that decided it, from 1
      integer(int64) :: at = 1
   end type content_type

   !> How a kind of file begins
   type :: magic_type
      character(20) :: bytes = ""
      integer :: length = 0
      !> What it is, what to do; FILE stands for its name
      character(64) :: what = ""
      character(560) :: advice = ""
   end type magic_type

   !> What helps with most others
   character(*), parameter :: to_text = &
      "turn it into text or .npy: one row for each sample, one column for each channel"
   character(*), parameter :: utf_16 = &
      "turn it into UTF-8: iconv -f UTF-16 -t UTF-8 FILE | gyroakf run -"
   character(*), parameter :: utf_32 = &
      "turn it into UTF-8: iconv -f UTF-32 -t UTF-8 FILE | gyroakf run -"

   !> What converts tables of Arrow and Excel, around the name of the reading function
   character(*), parameter :: with_pandas = "python3 -c ""import pandas; pandas.read_"
   character(*), parameter :: to_csv = "('FILE').to_csv('x.csv', index=False)"""
   !> What reads recordings of ROS, PX4 and ArduPilot, before the name of the package's extra
   character(*), parameter :: with_python = &
      "python3 -m gyroakf run FILE (the Python package of gyroakf, with its extra "

   !> May also follow a user block of 512, 1024, 2048, ... bytes, as in MATLAB 7.3
   character(*), parameter :: hdf5_magic = char(137)//"HDF"//char(13)//char(10)//char(26)//char(10)

   !> Kinds that are not read, and what turns them into something that is
   type(magic_type), parameter :: magics(*) = &
      [magic_type(hdf5_magic, len(hdf5_magic), "an HDF5 file (.h5, MATLAB 7.3)", &
      "python3 -c ""import h5py, numpy; numpy.save('x.npy', h5py.File('FILE')['NAME'][()])""; "// &
      "dataset names: python3 -c ""import h5py; h5py.File('FILE').visit(print)"""), &
      magic_type(char(40)//char(181)//char(47)//char(253), 4, "compressed by zstd", &
      "zstd -dc FILE | gyroakf run -"), magic_type(char(253)//"7zXZ"//char(0), 6, "compressed "// &
      "by xz", "xz -dc FILE | gyroakf run -"), magic_type("BZh", 3, "compressed by bzip2", &
      "bzip2 -dc FILE | gyroakf run -"), magic_type(char(4)//char(34)//char(77)//char(24), 4, &
      "compressed by lz4", "lz4 -dc FILE | gyroakf run -"), magic_type("7z"//char(188)// &
      char(175)//char(39)//char(28), 6, "a 7-Zip archive", "7z x -so FILE | gyroakf run -"), &
      magic_type("PK"//char(3)//char(4), 4, "a zip archive: .xlsx, .npz or .zip", ".xlsx: "// &
      with_pandas//"excel"//to_csv//"; .npz, .zip: unzip -p FILE NAME-IN-IT | gyroakf run -; "// &
      "names in it: unzip -l FILE"), magic_type(char(208)//char(207)//char(17)//char(224), 4, &
      "an Excel workbook (.xls)", with_pandas//"excel"//to_csv), magic_type(char(255)//char(254)// &
      char(0)//char(0), 4, "text in UTF-32", utf_32), magic_type(char(255)//char(254), 2, &
      "text in UTF-16", utf_16), magic_type(char(254)//char(255), 2, "text in UTF-16", utf_16), &
      magic_type("MATLAB 5.0 MAT-file", 19, "a MATLAB file of level 5", "python3 -c ""import "// &
      "numpy, scipy.io as s; numpy.save('x.npy', s.loadmat('FILE')['NAME'])""; variable names: "// &
      "python3 -c ""import scipy.io as s; print(s.whosmat('FILE'))"""), &
      magic_type("PAR1", 4, "a Parquet file", with_python//"parquet)"), &
      magic_type("ARROW1", 6, "an Arrow file", with_pandas//"feather"//to_csv), magic_type("FEA1", &
      4, "a Feather file", with_pandas//"feather"//to_csv), magic_type("#ROSBAG V", 9, &
      "a ROS bag (ROS 1)", with_python//"ros)"), magic_type(char(137)//"MCAP0", 6, "an MCAP "// &
      "file (ROS 2)", with_python//"ros)"), magic_type("SQLite format 3", 15, "an SQLite "// &
      "database (.db3 of ROS 2)", with_python//"ros)"), magic_type("ULog"//char(1)//char(18)//"5", &
      7, "a ULog file (PX4)", with_python//"ulog)"), magic_type(char(163)//char(149)//char(128), &
      3, "a DataFlash log (ArduPilot)", with_python//"dataflash)"), magic_type(char(181)//"b", 2, &
      "a log of a u-blox receiver", to_text), magic_type("MDF     ", 8, "an MDF file", to_text), &
      magic_type("TDSm", 4, "a TDMS file (LabVIEW)", to_text), magic_type("RIFF", 4, &
      "a RIFF file (WAV)", "leave its header out: `format` i16, `skip` 44, with `channels` N"), &
      magic_type(char(128)//char(4)//char(149), 3, "a pickle of Python", "numpy.save('x.npy', "// &
      "x)"), magic_type(char(137)//"PNG", 4, "a picture (PNG)", "give the file with the numbers"), &
      magic_type(char(255)//char(216)//char(255), 3, "a picture (JPEG)", "give the file with "// &
      "the numbers"), magic_type("%PDF", 4, "a PDF document", "give the file with the numbers"), &
      magic_type(char(127)//"ELF", 4, "a program", "give the file with the numbers")]

   character(*), parameter :: binary_advice = &
      "say what it holds: `format` f64, f32, i16, i32, u8, ..., with be behind it for big "// &
      "endian; `channels` for interleaved columns, `skip` for a header of so many bytes"

contains

   !> What the first block of a file holds.
   subroutine recognize_content(bytes, name, content)
      !> The first bytes: some thousands, or all there are
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Of the file: its end counts where the content alone does not tell
      character(*), intent(in) :: name
      type(content_type), intent(out) :: content
      integer(int64) :: controls, nulls, i
      integer :: found, point_at
      logical :: by_name

      content%kind = "text"
      point_at = index(name, ".", back=.true.)
      content%ending = ""
      if (point_at > index(name, "/", back=.true.)) content%ending = lower(name(point_at + 1:))
      call parse_element(content%ending, content%element, by_name)
      if (begins(bytes, 0_int64, npy_magic)) content%kind = "npy"
      if (content%kind == "npy") return
      found = magic_of(bytes)
      if (by_name .and. magics(max(found, 1))%length < 4) found = 0
      if (found > 0) then
         content%kind = "foreign"
         content%what = trim(magics(found)%what)
         call name_file(trim(magics(found)%advice), name, content%advice)
         return
      end if
      if (by_name) then
         content%kind = merge("text  ", "binary", all((bytes >= 32 .and. bytes < 127) .or. &
                                                              (bytes >= 9 .and. bytes <= 13)))
         return
      end if
      nulls = count(bytes == 0, kind=int64)
      controls = 0
      do i = size(bytes, kind=int64), 1, -1
         if (bytes(i) < 0 .or. bytes(i) > 31 .or. (bytes(i) >= 9 .and. bytes(i) <= 13)) cycle
         controls = controls + 1
         content%at = i
      end do
      if (nulls == 0 .and. 20*controls <= size(bytes, kind=int64)) return
      content%kind = "foreign"
      content%what = "binary"
      content%advice = binary_advice
      if (nulls == controls) call explain_nulls(bytes, name, nulls, content)
   end subroutine recognize_content

   !> Bytes that are 0 and no other control characters: UTF-16 without its mark, or text with holes.
   subroutine explain_nulls(bytes, name, nulls, content)
      integer(int8), intent(in), contiguous :: bytes(:)
      character(*), intent(in) :: name
      integer(int64), intent(in) :: nulls
      type(content_type), intent(inout) :: content
      integer(int64) :: even, digits, others

      even = count(bytes(1::2) == 0, kind=int64)
      digits = count(bytes >= 43 .and. bytes <= 57, kind=int64)  ! signs, points, separators, too
      others = size(bytes, kind=int64) - nulls
      if (any(bytes < 0) .or. 4*digits < others) return
      if (3*nulls > 2*others .and. (20*even < nulls .or. 20*(nulls - even) < nulls)) then
         content%what = "text in UTF-16 without a byte-order mark"
         call name_file("turn it into UTF-8: iconv -f UTF-16"//merge("LE", "BE", &
            20*even < nulls)//" -t UTF-8 FILE | gyroakf run -", name, content%advice)
      else if (any(bytes == 10) .or. any(bytes == 13)) then
         content%what = "text with "//integer_text(nulls)// &
            " NUL bytes, as a logger leaves them that lost its power"
         call name_file("leave them out: tr -d '\000' < FILE | gyroakf run -", name, content%advice)
      end if
   end subroutine explain_nulls

   !> The kind of file that begins so, as a place in `magics`; 0 for none.
   pure integer function magic_of(bytes) result(found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64) :: at

      do found = 1, size(magics)
         if (begins(bytes, 0_int64, magics(found)%bytes(:magics(found)%length))) return
      end do
      found = 0
      at = 512
      do while (at < size(bytes, kind=int64) .and. found == 0)
         if (begins(bytes, at, hdf5_magic)) found = findloc(magics%bytes == hdf5_magic, .true., &
            dim=1)
         at = 2*at
      end do
   end function magic_of

   pure logical function begins(bytes, offset, text)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: offset
      character(*), intent(in) :: text

      begins = .false.
      if (size(bytes, kind=int64) < offset + len(text)) return
      begins = bytes_text(bytes, offset + 1, offset + len(text)) == text
   end function begins

   !> A command with the file's name in the place of FILE; "FILE |" is "|" on standard input.
   pure subroutine name_file(advice, name, text)
      character(*), intent(in) :: advice, name
      character(:), allocatable, intent(out) :: text

      text = advice
      if (index(name, "<") == 1) then
         call replace_all(text, " FILE |", " |")
      else
         call replace_all(text, "FILE", name)
      end if
   end subroutine name_file

end module gyroakf_io_format
