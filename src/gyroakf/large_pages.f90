! SPDX-License-Identifier: MIT
!> Advice to the operating system about arrays of the length of a record.
!>
!> Memory that was just allocated is handed out page by page, at the first touch of each. With pages
!> of 4 KiB this takes longer than filling the array. Linux has pages of 2 MiB for those who ask
!> (`/sys/kernel/mm/transparent_hugepage/enabled` is `madvise` as a rule); other systems do not know
!> the advice, and refuse it.
module gyroakf_large_pages
   use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_loc, c_ptr, c_size_t
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: prefer_large_pages, values_before_page, release_pages, page_values

   !> Bytes of a large page
   integer(c_intptr_t), parameter :: page_bytes = 2097152
   !> The same in values
   integer(int64), parameter :: page_values = page_bytes/8
   !> MADV_HUGEPAGE, of Linux, and MADV_DONTNEED, the same everywhere
   integer(c_int), parameter :: huge_page_advice = 14, release_advice = 4

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

   !> Asks for large pages under an array that is about to be filled; no value changes.
   subroutine prefer_large_pages(array)
      !> Any length; those shorter than a page are left alone
      real(dp), intent(inout), contiguous, target :: array(:)

      if (8*size(array, kind=c_intptr_t) >= 2*page_bytes) call advise(array, huge_page_advice)
   end subroutine prefer_large_pages

   !> Gives the memory of an array back before it is deallocated, as far as it covers whole large
   !> pages: what is in it is lost, and it may be neither read nor written afterwards. Memory that
   !> is first touched next is then likely to be this one, at no cost.
   subroutine release_pages(array)
      !> Any length; about to be deallocated
      real(dp), intent(inout), contiguous, target :: array(:)

      if (8*size(array, kind=c_intptr_t) >= page_bytes) call advise(array, release_advice)
   end subroutine release_pages

   !> So many values of an array come before its first large page.
   integer(int64) function values_before_page(array) result(values)
      !> Any length
      real(dp), intent(in), contiguous, target :: array(:)
      integer(c_intptr_t) :: first

      first = transfer(c_loc(array), first)
      values = min(modulo(-first, page_bytes)/8, size(array, kind=int64))
   end function values_before_page

   !> Gives advice about the whole large pages of an array.
   subroutine advise(array, advice)
      real(dp), intent(inout), contiguous, target :: array(:)
      integer(c_int), intent(in) :: advice
      integer(c_intptr_t) :: first, bytes
      integer(c_int) :: ignored

      first = transfer(c_loc(array), first)
      bytes = 8*size(array, kind=c_intptr_t) - modulo(-first, page_bytes)
      first = first + modulo(-first, page_bytes)
      bytes = bytes - modulo(bytes, page_bytes)
      if (bytes > 0) ignored = c_madvise(transfer(first, c_loc(array)), int(bytes, c_size_t), &
         advice)
   end subroutine advise

end module gyroakf_large_pages
