! SPDX-License-Identifier: MIT
!> Names of the result folders of many files: each file's own without its extension, -2, -3 ... where that is taken.
module gyroakf_app_folders
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : text_type
   use gyroakf_report_files, only : document_mark
   implicit none (type, external)
   private
   public :: summary_files, summary_marks, name_folders

   !> What stands beside the folders, and how it is recognized
   character(12), parameter :: summary_files(2) = [character(12) :: "summary.csv", "summary.json"]
   character(23), parameter :: summary_marks(2) = [character(23) :: "path,folder,exit_code", document_mark]

   !> Names that are taken, found by a hash of theirs
   type :: name_table
      !> [power of two] unallocated where free
      type(text_type), allocatable :: name(:)
      !> Largest number that was tried behind the name
      integer, allocatable :: last(:)
   end type name_table

contains

   !> One name for each path, in their order, no two the same.
   subroutine name_folders(paths, names)
      !> As they were given; "-" is standard input
      type(text_type), intent(in) :: paths(:)
      !> Without a slash: [size(paths)]
      type(text_type), allocatable, intent(out) :: names(:)
      type(name_table) :: taken
      character(12) :: digits
      integer :: i, slot, base, capacity

      capacity = 64
      do while (capacity < 4*size(paths))
         capacity = 2*capacity
      end do
      allocate (taken%name(capacity), taken%last(capacity), names(size(paths)))
      taken%last = 1
      do i = 1, size(summary_files)
         slot = slot_of(taken, trim(summary_files(i)))
         taken%name(slot)%text = trim(summary_files(i))
      end do
      do i = 1, size(paths)
         names(i)%text = base_name(paths(i)%text)
         base = slot_of(taken, names(i)%text)
         slot = base
         do while (allocated(taken%name(slot)%text))
            taken%last(base) = taken%last(base) + 1
            write (digits, "(i0)") taken%last(base)
            names(i)%text = base_name(paths(i)%text)//"-"//trim(digits)
            slot = slot_of(taken, names(i)%text)
         end do
         taken%name(slot)%text = names(i)%text
      end do
   end subroutine name_folders

   !> Where a name stands, or the free place where it would.
   pure integer function slot_of(taken, name) result(slot)
      type(name_table), intent(in) :: taken
      character(*), intent(in) :: name
      integer(int64) :: hash
      integer :: i

      hash = 5381
      do i = 1, len(name)
         hash = modulo(33*hash + iachar(name(i:i)), 4294967296_int64)
      end do
      slot = int(modulo(hash, size(taken%name, kind=int64))) + 1
      do while (allocated(taken%name(slot)%text))
         if (taken%name(slot)%text == name .and. len(taken%name(slot)%text) == len(name)) return
         slot = modulo(slot, size(taken%name)) + 1
      end do
   end function slot_of

   !> "b" of "a/b.txt", "stdin" of "-".
   pure function base_name(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name
      integer :: dot

      name = path(index(path, "/", back=.true.) + 1:)
      if (path == "-") name = "stdin"
      dot = index(name, ".", back=.true.)
      if (dot > 1) name = name(:dot - 1)
      if (name == "" .or. verify(name, ".") == 0) name = "file"
   end function base_name

end module gyroakf_app_folders
