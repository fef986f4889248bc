! SPDX-License-Identifier: MIT
!> Lengths that are transformed in few steps, and the roots of unity.
module gyroakf_fft_lengths
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: smooth_length, factorise, unit_root, max_length

   !> Largest prime factor that has its own pass
   integer, parameter :: largest_radix = 13

   !> Longest transform: products of two indices still fit 64 bits
   integer(int64), parameter :: max_length = 2_int64**40

contains

   !> Smallest length >= n whose prime factors are 2, 3 and 5.
   pure integer(int64) function smooth_length(n)
      !> 1 .. 2**41
      integer(int64), intent(in) :: n
      integer(int64) :: p5, p35

      smooth_length = huge(n)
      p5 = 1
      do while (p5 < smooth_length)
         p35 = p5
         do while (p35 < smooth_length)
            ! times the power of two that reaches n
            smooth_length = min(smooth_length, shiftl(p35, bit_size(n) - leadz((n - 1)/p35)))
            p35 = 3*p35
         end do
         p5 = 5*p5
      end do
   end function smooth_length

   !> The root of unity exp(2 pi i j/n), from an angle of at most an eighth of a turn, so that it is
   !> right to the last bit or one beside it, and exactly symmetric.
   elemental complex(dp) function unit_root(j, n)
      !> Index 0 .. n-1
      integer(int64), intent(in) :: j
      !> Length 1 .. 2**41
      integer(int64), intent(in) :: n
      real(dp), parameter :: turn = 6.28318530717958647693_dp
      integer(int64) :: octant, rest
      real(dp) :: angle, c, s

      ! 8 j = octant n + rest; in odd octants the angle is measured back from the next one
      octant = (8*j)/n
      rest = 8*j - octant*n
      if (mod(octant, 2_int64) == 1) rest = n - rest
      angle = turn*(real(rest, dp)/real(8*n, dp))
      c = cos(angle)
      s = sin(angle)
      select case (int(octant))
      case (0); unit_root = cmplx(c, s, dp)
      case (1); unit_root = cmplx(s, c, dp)
      case (2); unit_root = cmplx(-s, c, dp)
      case (3); unit_root = cmplx(-c, s, dp)
      case (4); unit_root = cmplx(-c, -s, dp)
      case (5); unit_root = cmplx(-s, -c, dp)
      case (6); unit_root = cmplx(s, -c, dp)
      case default; unit_root = cmplx(c, -s, dp)
      end select
   end function unit_root

   !> The radices of a length, fours first; not allocated when a prime factor is too large.
   pure subroutine factorise(length, radix)
      !> At least 1
      integer(int64), intent(in) :: length
      !> Their product is the length
      integer, allocatable, intent(out) :: radix(:)
      integer, parameter :: candidates(7) = [4, 2, 3, 5, 7, 11, largest_radix]
      integer :: found(64), i, n
      integer(int64) :: rest

      n = 0
      rest = length
      do i = 1, size(candidates)
         do while (mod(rest, int(candidates(i), int64)) == 0)
            n = n + 1
            found(n) = candidates(i)
            rest = rest/candidates(i)
         end do
      end do
      if (rest == 1) then
         allocate (radix(n))
         radix(:) = found(:n)
      end if
   end subroutine factorise

end module gyroakf_fft_lengths
