! SPDX-License-Identifier: MIT
!> Advice to the operating system about arrays of the length of a record.
!>
!> Memory that was just allocated is handed out page by page, at the first touch of each. With pages of 4 KiB this takes longer
!> than filling the array. Linux has pages of 2 MiB for those who ask (`/sys/kernel/mm/transparent_hugepage/enabled` is
!> `madvise` as a rule); other systems do not know the advice, and refuse it.
module gyroakf_large_pages
   use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_loc, c_ptr, c_size_t
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: prefer_large_pages

   !> Bytes of a large page
   integer(c_intptr_t), parameter :: page_bytes = 2097152
   !> Linux: MADV_HUGEPAGE
   integer(c_int), parameter :: huge_page_advice = 14

   interface
      !> 4.3BSD and all its heirs; 0 if the advice is taken
      function c_madvise(address, length, advice) result(failed) bind(C, name="madvise")
         import :: c_int, c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value :: address
         integer(c_size_t), value :: length
         integer(c_int), value :: advice
         integer(c_int) :: failed
      end function c_madvise
   end interface

contains

   !> Asks for large pages under an array that is about to be filled; it changes no value, and nothing depends on the answer.
   subroutine prefer_large_pages(array)
      !> Any length; those shorter than a page are left alone
      real(dp), intent(inout), contiguous, target :: array(:)

      integer(c_intptr_t) :: first, bytes
      integer(c_int) :: ignored

      bytes = 8*size(array, kind=c_intptr_t)
      if (bytes < 2*page_bytes) return
      first = transfer(c_loc(array), first)
      bytes = bytes - modulo(-first, page_bytes)
      first = first + modulo(-first, page_bytes)
      ignored = c_madvise(transfer(first, c_loc(array)), int(bytes - modulo(bytes, page_bytes), c_size_t), huge_page_advice)
   end subroutine prefer_large_pages

end module gyroakf_large_pages
