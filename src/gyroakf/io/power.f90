! SPDX-License-Identifier: MIT
!> Powers of ten to 63 bits, exactly truncated: what most numbers are read with.
!>
!> The compiler computes them, as products of those of [[gyroakf_io_wide_power]].
module gyroakf_io_power
   use gyroakf_kinds, only : int64
   use gyroakf_io_wide_power, only : int128, ten, word
   implicit none (type, external)
   private
   public :: power

   integer :: a, b

   !> 10^0 to 10^17, with the highest bit moved to the place of 2^61
   integer(int64), parameter :: fine(0:17) = [(shiftl(ten(b), leadz(ten(b)) - 2), b=0, 17)]

   !> 10^(18 a + b): the first 124 bits of 10^(18 a), of which the last 62 count for their upper half only, times 10^b
   integer(int128), parameter :: product(-306:305) = &
      [((int(word(1, a), int128)*fine(b) + shiftr(int(word(2, a), int128)*fine(b), 62), b=0, 17), a=-17, 16)]

   !> 10^-306 to 10^305: 10^k is between power and power + 1, times 2^(floor(log2(10^k)) - 62); power is in [2^62, 2^63)
   integer(int64), parameter :: power(-306:305) = [(int(shiftr(product(a), 65 - leadz(product(a))), int64), a=-306, 305)]

end module gyroakf_io_power
