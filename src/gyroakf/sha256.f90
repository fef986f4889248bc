! SPDX-License-Identifier: MIT
!> SHA-256 of bytes that come in pieces: what `sha256sum` prints.
!>
!>     type(sha256_type) :: hash
!>     call add_bytes(hash, bytes)              ! any number of times
!>     call finish_sha256(hash, digest)         ! 64 hexadecimal digits
!>
!> Source: FIPS 180-4, sections 4.1.2, 4.2.2, 5.1.1, 5.3.3, 6.2.2. Words of 32 bits are held in integers of 64, so that no sum
!> overflows; a rotation is a shift of the word written twice, side by side.
module gyroakf_sha256
   use gyroakf_kinds, only : int8, int64
   implicit none (type, external)
   private
   public :: sha256_type, add_bytes, finish_sha256

   !> Bytes of a block, words of the schedule
   integer, parameter :: block_bytes = 64, rounds = 64
   !> The lower 32 bits
   integer(int64), parameter :: low = int(z"ffffffff", int64)

   !> The first 32 bits of the fractional parts of the square roots of the first 8 primes
   integer(int64), parameter :: start(8) = [integer(int64) :: &
      int(z"6a09e667", int64), int(z"bb67ae85", int64), int(z"3c6ef372", int64), int(z"a54ff53a", int64), &
      int(z"510e527f", int64), int(z"9b05688c", int64), int(z"1f83d9ab", int64), int(z"5be0cd19", int64)]

   !> Of the cube roots of the first 64 primes
   integer(int64), parameter :: k(rounds) = [integer(int64) :: &
      int(z"428a2f98", int64), int(z"71374491", int64), int(z"b5c0fbcf", int64), int(z"e9b5dba5", int64), &
      int(z"3956c25b", int64), int(z"59f111f1", int64), int(z"923f82a4", int64), int(z"ab1c5ed5", int64), &
      int(z"d807aa98", int64), int(z"12835b01", int64), int(z"243185be", int64), int(z"550c7dc3", int64), &
      int(z"72be5d74", int64), int(z"80deb1fe", int64), int(z"9bdc06a7", int64), int(z"c19bf174", int64), &
      int(z"e49b69c1", int64), int(z"efbe4786", int64), int(z"0fc19dc6", int64), int(z"240ca1cc", int64), &
      int(z"2de92c6f", int64), int(z"4a7484aa", int64), int(z"5cb0a9dc", int64), int(z"76f988da", int64), &
      int(z"983e5152", int64), int(z"a831c66d", int64), int(z"b00327c8", int64), int(z"bf597fc7", int64), &
      int(z"c6e00bf3", int64), int(z"d5a79147", int64), int(z"06ca6351", int64), int(z"14292967", int64), &
      int(z"27b70a85", int64), int(z"2e1b2138", int64), int(z"4d2c6dfc", int64), int(z"53380d13", int64), &
      int(z"650a7354", int64), int(z"766a0abb", int64), int(z"81c2c92e", int64), int(z"92722c85", int64), &
      int(z"a2bfe8a1", int64), int(z"a81a664b", int64), int(z"c24b8b70", int64), int(z"c76c51a3", int64), &
      int(z"d192e819", int64), int(z"d6990624", int64), int(z"f40e3585", int64), int(z"106aa070", int64), &
      int(z"19a4c116", int64), int(z"1e376c08", int64), int(z"2748774c", int64), int(z"34b0bcb5", int64), &
      int(z"391c0cb3", int64), int(z"4ed8aa4a", int64), int(z"5b9cca4f", int64), int(z"682e6ff3", int64), &
      int(z"748f82ee", int64), int(z"78a5636f", int64), int(z"84c87814", int64), int(z"8cc70208", int64), &
      int(z"90befffa", int64), int(z"a4506ceb", int64), int(z"bef9a3f7", int64), int(z"c67178f2", int64)]

   !> A hash that is being made
   type :: sha256_type
      private
      integer(int64) :: state(8) = start
      !> Bytes so far, and those of them that fill no block yet
      integer(int64) :: length = 0
      integer(int8) :: rest(block_bytes) = 0_int8
   end type sha256_type

contains

   !> Takes more bytes.
   pure subroutine add_bytes(hash, bytes)
      !> The hash
      type(sha256_type), intent(inout) :: hash
      !> [n] any number of them, also none
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64) :: at, n
      integer :: held, taken

      n = size(bytes, kind=int64)
      held = int(mod(hash%length, int(block_bytes, int64)))
      hash%length = hash%length + n
      at = 0
      if (held > 0) then
         taken = int(min(int(block_bytes - held, int64), n))
         hash%rest(held + 1:held + taken) = bytes(:taken)
         at = taken
         if (held + taken < block_bytes) return
         call take_block(hash%state, hash%rest)
      end if
      do while (n - at >= block_bytes)
         call take_block(hash%state, bytes(at + 1:at + block_bytes))
         at = at + block_bytes
      end do
      hash%rest(:n - at) = bytes(at + 1:)
   end subroutine add_bytes

   !> Ends the hash.
   pure subroutine finish_sha256(hash, digest)
      !> Of no use afterwards
      type(sha256_type), intent(inout) :: hash
      !> Hexadecimal digits, lower case
      character(64), intent(out) :: digest
      character(*), parameter :: digits = "0123456789abcdef"
      integer(int8) :: padding(2*block_bytes)
      integer(int64) :: bits
      integer :: n, i, nibble

      bits = 8*hash%length
      n = block_bytes - int(mod(hash%length, int(block_bytes, int64)))
      if (n < 9) n = n + block_bytes                    ! one byte 1000 0000, zeros, the number of bits in 8 bytes
      padding = 0_int8
      padding(1) = byte_of(128_int64)
      do i = 0, 7
         padding(n - i) = byte_of(ibits(bits, 8*i, 8))
      end do
      call add_bytes(hash, padding(:n))
      do i = 1, 64
         nibble = int(ibits(hash%state(shiftr(i + 7, 3)), 28 - 4*mod(i - 1, 8), 4))
         digest(i:i) = digits(nibble + 1:nibble + 1)
      end do
   end subroutine finish_sha256

   !> One block of 64 bytes.
   pure subroutine take_block(state, bytes)
      integer(int64), intent(inout) :: state(8)
      integer(int8), intent(in) :: bytes(block_bytes)
      integer(int64) :: w(rounds), a, b, c, d, e, f, g, h, t, u, v
      integer :: i

      do i = 1, 16
         w(i) = ior(ior(shiftl(unsigned(bytes(4*i - 3)), 24), shiftl(unsigned(bytes(4*i - 2)), 16)), &
                    ior(shiftl(unsigned(bytes(4*i - 1)), 8), unsigned(bytes(4*i))))
      end do
      do i = 17, rounds
         u = twice(w(i - 15))
         v = twice(w(i - 2))
         t = iand(ieor(ieor(shiftr(u, 7), shiftr(u, 18)), shiftr(w(i - 15), 3)), low)
         t = t + iand(ieor(ieor(shiftr(v, 17), shiftr(v, 19)), shiftr(w(i - 2), 10)), low)
         w(i) = iand(w(i - 16) + w(i - 7) + t, low)
      end do
      a = state(1); b = state(2); c = state(3); d = state(4)
      e = state(5); f = state(6); g = state(7); h = state(8)
      do i = 1, rounds, 8
         call one_round(a, b, c, d, e, f, g, h, k(i) + w(i))
         call one_round(h, a, b, c, d, e, f, g, k(i + 1) + w(i + 1))
         call one_round(g, h, a, b, c, d, e, f, k(i + 2) + w(i + 2))
         call one_round(f, g, h, a, b, c, d, e, k(i + 3) + w(i + 3))
         call one_round(e, f, g, h, a, b, c, d, k(i + 4) + w(i + 4))
         call one_round(d, e, f, g, h, a, b, c, k(i + 5) + w(i + 5))
         call one_round(c, d, e, f, g, h, a, b, k(i + 6) + w(i + 6))
         call one_round(b, c, d, e, f, g, h, a, k(i + 7) + w(i + 7))
      end do
      state = iand(state + [a, b, c, d, e, f, g, h], low)
   end subroutine take_block

   !> One round; the words then go by the names of their neighbours.
   pure subroutine one_round(a, b, c, d, e, f, g, h, kw)
      integer(int64), intent(in) :: a, b, c, e, f, g
      integer(int64), intent(inout) :: d, h
      !> Constant and word of the schedule
      integer(int64), intent(in) :: kw
      integer(int64) :: t, u, v

      u = twice(e)
      v = twice(a)
      t = h + kw + ieor(iand(e, ieor(f, g)), g) + iand(ieor(ieor(shiftr(u, 6), shiftr(u, 11)), shiftr(u, 25)), low)
      d = iand(d + t, low)
      h = iand(t + ior(iand(a, b), iand(c, ior(a, b))) + iand(ieor(ieor(shiftr(v, 2), shiftr(v, 13)), shiftr(v, 22)), low), low)
   end subroutine one_round

   !> A word written twice, side by side: its lower 32 bits shifted right by n are the word rotated by n.
   elemental integer(int64) function twice(word)
      integer(int64), intent(in) :: word

      twice = ior(word, shiftl(word, 32))
   end function twice

   !> A byte from 0 to 255.
   elemental integer(int64) function unsigned(byte)
      integer(int8), intent(in) :: byte

      unsigned = iand(int(byte, int64), 255_int64)
   end function unsigned

   !> The byte of a number from 0 to 255.
   elemental integer(int8) function byte_of(number)
      integer(int64), intent(in) :: number

      byte_of = int(number - merge(256_int64, 0_int64, number > 127), int8)
   end function byte_of

end module gyroakf_sha256
