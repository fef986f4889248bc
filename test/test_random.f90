! SPDX-License-Identifier: MIT
!> The random numbers: published outputs, streams, distributions.
module test_random
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_random, only : random_type, seed_random, next_bits, next_uniform, next_normal, fill_normal
   implicit none (type, external)
   private
   public :: suite_random

   !> Draws of the distribution tests. Their bounds are 4.5 standard deviations, and the seeds are fixed.
   integer, parameter :: draws = 200000

contains

   subroutine suite_random()
      call test("xoshiro-outputs", test_xoshiro)
      call test("splitmix-seeding", test_seeding)
      call test("repeatable", test_repeatable)
      call test("streams-differ", test_streams)
      call test("uniform-distribution", test_uniform)
      call test("normal-distribution", test_normal)
      call test("normal-is-polar", test_polar)
      call test("fill-is-next", test_fill)
   end subroutine suite_random

   !> The authors' C code, state {1, 2, 3, 4}: 2D00, 0, 5A007080 (hexadecimal), ...
   subroutine test_xoshiro()
      type(random_type) :: random
      integer(int64), parameter :: expected(4) = [int(z'2d00', int64), 0_int64, int(z'5a007080', int64), &
         & int(z'10e0000000009d80', int64)]
      integer(int64) :: bits
      integer :: i

      random%state = [1_int64, 2_int64, 3_int64, 4_int64]
      do i = 1, size(expected)
         call next_bits(random, bits)
         call check(error, bits, expected(i))
      end do
   end subroutine test_xoshiro

   !> splitmix64 of seed 1234567 begins 6457827717110365317 (its authors); the state and the first output that follow,
   !> a negative seed, and stream 1, which is the state times the transition matrix to the power 2**128
   !> (the matrix squared 128 times over GF(2), another algorithm than the jump).
   subroutine test_seeding()
      type(random_type) :: random
      integer(int64) :: bits

      call seed_random(random, 1234567_int64)
      call check(error, random%state(1), 6457827717110365317_int64)
      call check(error, all(random%state == [bits_of("599ed017fb08fc85"), bits_of("2c73f08458540fa5"), &
         & bits_of("883ebce5a3f27c77"), bits_of("3fbef740e9177b3f")]))
      call next_bits(random, bits)
      call check(error, bits, bits_of("30a3a1c363600467"))
      call seed_random(random, -5_int64)
      call next_bits(random, bits)
      call check(error, bits, bits_of("7a01d79fc1d93784"))
      call seed_random(random, 1234567_int64, stream=1)
      call check(error, all(random%state == [bits_of("b0c1657c7fa2f8ea"), bits_of("ef80e66a5aff8c10"), &
         & bits_of("1b472eb403a52467"), bits_of("2b95ff655a7e630f")]))
   end subroutine test_seeding

   subroutine test_repeatable()
      type(random_type) :: random, again
      real(dp) :: x(101), y(101)

      call seed_random(random, 7_int64, stream=3)
      call seed_random(again, 7_int64, stream=3)
      call fill_normal(random, x)
      call fill_normal(again, y)
      call check(error, all(abs(x - y) <= 0))
      call seed_random(again, 8_int64, stream=3)
      call fill_normal(again, y)
      call check(error, all(abs(x - y) > 0), "another seed, other numbers")
   end subroutine test_repeatable

   !> Normals of different streams, and the same stream shifted, are uncorrelated.
   subroutine test_streams()
      type(random_type) :: random
      real(dp), allocatable :: x(:, :)
      real(dp) :: bound
      integer :: i, j

      allocate (x(draws, 0:3))
      do i = 0, 3
         call seed_random(random, 2_int64, stream=i)
         call fill_normal(random, x(:, i))
      end do
      bound = 4.5_dp/sqrt(real(draws, dp))
      do i = 0, 3
         do j = 0, i - 1
            call check(error, abs(dot_product(x(:, i), x(:, j)))/draws < bound)
         end do
         call check(error, abs(dot_product(x(2:, i), x(:draws - 1, i)))/draws < bound)
      end do
   end subroutine test_streams

   !> Range, mean 1/2, variance 1/12, and a chi-square of 16 cells (15 degrees of freedom, 1e-5 quantile 47.2).
   subroutine test_uniform()
      type(random_type) :: random
      real(dp) :: u, total, square, n, chi_square
      integer :: i, cell(0:15)

      call seed_random(random, 3_int64)
      total = 0
      square = 0
      cell = 0
      do i = 1, draws
         call next_uniform(random, u)
         call check(error, u > 0 .and. u < 1)
         total = total + (u - 0.5_dp)
         square = square + (u - 0.5_dp)**2
         cell(int(16*u)) = cell(int(16*u)) + 1
      end do
      n = draws
      chi_square = sum((cell - n/16)**2)*16/n
      call check(error, abs(total)/n < 4.5_dp*sqrt(1/(12*n)), "mean")
      call check(error, abs(square/n - 1/12.0_dp) < 4.5_dp*sqrt(1/(180*n)), "variance")
      call check(error, chi_square < 47.2_dp, "cells")
   end subroutine test_uniform

   !> Moments 1 to 4 (variances 1/n, 2/n, 15/n, 96/n) and the shares beyond 1, 2, 3 and 4.
   subroutine test_normal()
      type(random_type) :: random
      real(dp), allocatable :: x(:)
      real(dp) :: n, p
      real(dp), parameter :: moment(4) = [0, 1, 0, 3], spread(4) = [1, 2, 15, 96]
      integer :: k

      allocate (x(draws))
      n = draws
      call seed_random(random, 4_int64)
      call fill_normal(random, x)
      do k = 1, 4
         call check(error, abs(sum(x**k)/n - moment(k)) < 4.5_dp*sqrt(spread(k)/n), "moment")
         p = erfc(k/sqrt(2.0_dp))
         call check(error, abs(count(abs(x) > k) - n*p) < 4.5_dp*sqrt(n*p), "tail")
      end do
   end subroutine test_normal

   !> The variates are those of the polar method with the compiler's own logarithm, to a few units of the last place.
   subroutine test_polar()
      type(random_type) :: random, copy
      real(dp) :: a, b, s, g(2)
      integer :: i

      call seed_random(random, 5_int64)
      do i = 1, 5000
         copy = random
         call next_normal(random, g(1))
         call next_normal(random, g(2))
         do
            call next_uniform(copy, a)
            call next_uniform(copy, b)
            s = (2*a - 1)**2 + (2*b - 1)**2
            if (s < 1) exit
         end do
         call check(error, g(1), (2*a - 1)*sqrt(-2*log(s)/s), thr=8*epsilon(1.0_dp), rel=.true.)
         call check(error, g(2), (2*b - 1)*sqrt(-2*log(s)/s), thr=8*epsilon(1.0_dp), rel=.true.)
      end do
   end subroutine test_polar

   subroutine test_fill()
      type(random_type) :: random, again
      real(dp) :: x(7), g
      integer :: i

      call seed_random(random, 6_int64)
      again = random
      call fill_normal(random, x(:3))
      call fill_normal(random, x(4:))
      do i = 1, 7
         call next_normal(again, g)
         call check(error, abs(x(i) - g) <= 0)
      end do
   end subroutine test_fill

   !> The 64 bits that 16 hexadecimal digits write
   pure integer(int64) function bits_of(text)
      character(16), intent(in) :: text
      integer :: i

      bits_of = 0
      do i = 1, 16
         bits_of = ior(shiftl(bits_of, 4), int(index("0123456789abcdef", text(i:i)) - 1, int64))
      end do
   end function bits_of

end module test_random
