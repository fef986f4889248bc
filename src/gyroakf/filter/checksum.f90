! SPDX-License-Identifier: MIT
!> A checksum of words of 64 bits: it mixes their halves as FNV-1a does bytes (Fowler, Noll & Vo),
!> with 32 bits of state for each half of the result: no product overflows.
module gyroakf_filter_checksum
   use gyroakf_kinds, only : int64
   implicit none (type, external)
   private
   public :: checksum

contains

   !> Of some words.
   pure integer(int64) function checksum(word)
      !> The words
      integer(int64), intent(in) :: word(:)
      integer(int64), parameter :: low = 4294967295_int64
      integer(int64) :: half(2), state(2), k
      integer :: i

      state = [2166136261_int64, 2246822519_int64]
      do k = 1, size(word, kind=int64)
         half = [iand(word(k), low), iand(shiftr(word(k), 32), low)]
         do i = 1, 2
            state(i) = ieor(state(i), half(i))
            ! times the prime 2^24 + 403: the product modulo 2^32 from two that stay below 2^63
            state(i) = iand(shiftl(iand(state(i), 255_int64), 24) + 403_int64*state(i), low)
         end do
         state = [ieor(state(1), shiftr(state(2), 7)), ieor(state(2), shiftr(state(1), 9))]
      end do
      checksum = ior(shiftl(iand(state(1), 2147483647_int64), 32), state(2))
   end function checksum

end module gyroakf_filter_checksum
