! SPDX-License-Identifier: MIT
!> One pass of the mixed-radix transform: butterflies of the radices 2, 3, 4, 5 and small primes.
!>
!> Stockham's autosort form: a pass of radix r reads x[s, m, r] and writes y[s, r, m],
!> $$ y(q,k,p) = w^{pk} \sum_{j=0}^{r-1} x(q,p,j)\, e^{-2\pi i jk/r}, \quad w = e^{-2\pi i/(rm)}, $$
!> s being the product of the radices already done and n = s r m. No bit reversal is needed, and the
!> inner loop (q) is contiguous. Source: C. Van Loan, Computational Frameworks for the FFT (SIAM,
!> 1992), sec. 1.7 and 2.1.
module gyroakf_fft_butterfly
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: apply_radix

contains

   !> One forward pass of the given radix, or one of some pieces of it.
   pure subroutine apply_radix(radix, s, m, piece, pieces, x, y, twiddle)
      !> Radix r >= 2
      integer, intent(in) :: radix
      !> Product of the radices already done, and n/(s r)
      integer(int64), intent(in) :: s, m
      !> Which of how many pieces: 0 .. pieces - 1; all of them are the pass
      integer(int64), intent(in) :: piece, pieces
      !> Input: [s, m, r]
      complex(dp), intent(in) :: x(0:s*m*radix - 1)
      !> Output: [s, r, m]; another array than x
      complex(dp), intent(inout) :: y(0:s*m*radix - 1)
      !> exp(-2 pi i j/n): [n]
      complex(dp), intent(in) :: twiddle(0:s*m*radix - 1)

      ! the first and the last p, the first and the last q
      integer(int64) :: part(4)

      part = [0_int64, m - 1, 1_int64, s]
      if (m >= pieces) then
         part(1:2) = [(m*piece)/pieces, (m*(piece + 1))/pieces - 1]
      else
         part(3:4) = [(s*piece)/pieces + 1, (s*(piece + 1))/pieces]
      end if
      select case (radix)
      case (2); call radix_2(s, m, part, x, y, twiddle)
      case (3); call radix_3(s, m, part, x, y, twiddle)
      case (4); call radix_4(s, m, part, x, y, twiddle)
      case (5); call radix_5(s, m, part, x, y, twiddle)
      case default; call radix_any(radix, s, m, part, x, y, twiddle)
      end select
   end subroutine apply_radix

   pure subroutine radix_2(s, m, part, x, y, w)
      integer(int64), intent(in) :: s, m, part(4)
      complex(dp), intent(in) :: x(s, 0:m - 1, 0:1), w(0:)
      complex(dp), intent(inout) :: y(s, 0:1, 0:m - 1)
      integer(int64) :: p, q
      complex(dp) :: w1

      do p = part(1), part(2)
         w1 = w(p*s)
         do q = part(3), part(4)
            y(q, 0, p) = x(q, p, 0) + x(q, p, 1)
            y(q, 1, p) = w1*(x(q, p, 0) - x(q, p, 1))
         end do
      end do
   end subroutine radix_2

   pure subroutine radix_3(s, m, part, x, y, w)
      integer(int64), intent(in) :: s, m, part(4)
      complex(dp), intent(in) :: x(s, 0:m - 1, 0:2), w(0:)
      complex(dp), intent(inout) :: y(s, 0:2, 0:m - 1)
      real(dp), parameter :: half_root_3 = 0.86602540378443864676_dp
      integer(int64) :: p, q
      complex(dp) :: w1, w2, t, u, v

      do p = part(1), part(2)
         w1 = w(p*s)
         w2 = w(2*p*s)
         do q = part(3), part(4)
            t = x(q, p, 1) + x(q, p, 2)
            u = x(q, p, 0) - 0.5_dp*t
            v = half_root_3*minus_i(x(q, p, 1) - x(q, p, 2))
            y(q, 0, p) = x(q, p, 0) + t
            y(q, 1, p) = w1*(u + v)
            y(q, 2, p) = w2*(u - v)
         end do
      end do
   end subroutine radix_3

   pure subroutine radix_4(s, m, part, x, y, w)
      integer(int64), intent(in) :: s, m, part(4)
      complex(dp), intent(in) :: x(s, 0:m - 1, 0:3), w(0:)
      complex(dp), intent(inout) :: y(s, 0:3, 0:m - 1)
      integer(int64) :: p, q
      complex(dp) :: w1, w2, w3, a, b, c, d

      do p = part(1), part(2)
         w1 = w(p*s)
         w2 = w(2*p*s)
         w3 = w(3*p*s)
         do q = part(3), part(4)
            a = x(q, p, 0) + x(q, p, 2)
            b = x(q, p, 0) - x(q, p, 2)
            c = x(q, p, 1) + x(q, p, 3)
            d = minus_i(x(q, p, 1) - x(q, p, 3))
            y(q, 0, p) = a + c
            y(q, 1, p) = w1*(b + d)
            y(q, 2, p) = w2*(a - c)
            y(q, 3, p) = w3*(b - d)
         end do
      end do
   end subroutine radix_4

   pure subroutine radix_5(s, m, part, x, y, w)
      integer(int64), intent(in) :: s, m, part(4)
      complex(dp), intent(in) :: x(s, 0:m - 1, 0:4), w(0:)
      complex(dp), intent(inout) :: y(s, 0:4, 0:m - 1)
      ! cosines and sines of 2 pi/5 and 4 pi/5
      real(dp), parameter :: c1 = 0.30901699437494742410_dp, c2 = -0.80901699437494742410_dp
      real(dp), parameter :: s1 = 0.95105651629515357212_dp, s2 = 0.58778525229247312917_dp
      integer(int64) :: p, q
      complex(dp) :: w1, w2, w3, w4, a, b, c, d, u, v

      do p = part(1), part(2)
         w1 = w(p*s)
         w2 = w(2*p*s)
         w3 = w(3*p*s)
         w4 = w(4*p*s)
         do q = part(3), part(4)
            a = x(q, p, 1) + x(q, p, 4)
            b = x(q, p, 1) - x(q, p, 4)
            c = x(q, p, 2) + x(q, p, 3)
            d = x(q, p, 2) - x(q, p, 3)
            y(q, 0, p) = x(q, p, 0) + (a + c)
            u = x(q, p, 0) + (c1*a + c2*c)
            v = minus_i(s1*b + s2*d)
            y(q, 1, p) = w1*(u + v)
            y(q, 4, p) = w4*(u - v)
            u = x(q, p, 0) + (c2*a + c1*c)
            v = minus_i(s2*b - s1*d)
            y(q, 2, p) = w2*(u + v)
            y(q, 3, p) = w3*(u - v)
         end do
      end do
   end subroutine radix_5

   !> The direct sum over r points: for the primes 7, 11 and 13.
   pure subroutine radix_any(r, s, m, part, x, y, w)
      integer, intent(in) :: r
      integer(int64), intent(in) :: s, m, part(4)
      complex(dp), intent(in) :: x(s, 0:m - 1, 0:r - 1), w(0:)
      complex(dp), intent(inout) :: y(s, 0:r - 1, 0:m - 1)
      integer(int64) :: p, q, step
      integer :: j, k
      complex(dp) :: total

      step = s*m
      do p = part(1), part(2)
         do k = 0, r - 1
            do q = part(3), part(4)
               total = x(q, p, 0)
               do j = 1, r - 1
                  total = total + w(step*mod(j*k, r))*x(q, p, j)
               end do
               y(q, k, p) = w(p*k*s)*total
            end do
         end do
      end do
   end subroutine radix_any

   !> -i z, without a multiplication
   elemental complex(dp) function minus_i(z)
      complex(dp), intent(in) :: z

      minus_i = cmplx(aimag(z), -real(z, dp), dp)
   end function minus_i

end module gyroakf_fft_butterfly
