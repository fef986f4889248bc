! SPDX-License-Identifier: MIT
!> Fourier transforms against the direct sum, and their invariants.
module test_fft
   use expectations, only : failure => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_fft_convolution, only : convolve
   use gyroakf_fft_lengths, only : smooth_length
   use gyroakf_fft_plan, only : fft_plan_type, new_fft_plan, fft_forward, fft_backward
   use gyroakf_fft_real, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward, real_fft_backward
   implicit none (type, external)
   private
   public :: suite_fft

   !> Allowed error relative to the root mean square of the result, per log2(n) (at least 1): DESIGN's 1e-14 log n
   real(dp), parameter :: per_log = 1.0e-14_dp

   !> One, every radix, products of them, primes (Bluestein) and a prime times a power of two
   integer(int64), parameter :: lengths(30) = [integer(int64) :: 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 15, 16, 17, 25, 30, &
      & 32, 49, 60, 64, 97, 100, 128, 143, 210, 256, 1009, 1024, 1164]

contains

   subroutine suite_fft()
      call test("direct-sum", test_direct_sum)
      call test("round-trip", test_round_trip)
      call test("single-line", test_single_line)
      call test("parseval-long", test_parseval)
      call test("real-forward", test_real_forward)
      call test("real-backward", test_real_backward)
      call test("smooth-length", test_smooth_length)
      call test("convolution", test_convolution)
      call test("failures", test_failures)
   end subroutine suite_fft

   !> Every length against the sum of its definition, with roots of unity of exactly reduced index.
   subroutine test_direct_sum()
      complex(dp), allocatable :: x(:), expected(:)
      type(fft_plan_type) :: plan
      integer :: i

      do i = 1, size(lengths)
         call sample(lengths(i), x)
         call direct_sum(x, expected)
         call new_fft_plan(plan, lengths(i), failure)
         if (went_wrong(failure)) return
         call fft_forward(plan, x, failure)
         call check(error, distance(x, expected) <= allowed(lengths(i)), "length "//decimal(lengths(i)))
      end do
   end subroutine test_direct_sum

   subroutine test_round_trip()
      complex(dp), allocatable :: x(:), again(:)
      type(fft_plan_type) :: plan
      integer :: i

      do i = 1, size(lengths)
         call sample(lengths(i), x)
         again = x
         call new_fft_plan(plan, lengths(i), failure)
         call fft_forward(plan, again, failure)
         call fft_backward(plan, again, failure)
         if (went_wrong(failure)) return
         call check(error, distance(again, x) <= 2*allowed(lengths(i)), "length "//decimal(lengths(i)))
      end do
   end subroutine test_round_trip

   !> exp(2 pi i 5 j/n) has one line, of height n, at index 5.
   subroutine test_single_line()
      complex(dp) :: x(0:96), expected(0:96)
      type(fft_plan_type) :: plan
      integer :: j

      do j = 0, 96
         x(j) = exp(cmplx(0.0_dp, 2*acos(-1.0_dp)*mod(5*j, 97)/97, dp))
      end do
      expected = 0
      expected(5) = 97
      call new_fft_plan(plan, 97_int64, failure)
      call fft_forward(plan, x, failure)
      call check(error, distance(x, expected) <= allowed(97_int64))
   end subroutine test_single_line

   !> A long prime and a long smooth length: the energy is kept, and the round trip is exact.
   subroutine test_parseval()
      integer(int64), parameter :: long(2) = [integer(int64) :: 65537, 120000]
      complex(dp), allocatable :: x(:), again(:)
      type(fft_plan_type) :: plan
      integer :: i

      do i = 1, 2
         call sample(long(i), x)
         again = x
         call new_fft_plan(plan, long(i), failure)
         call fft_forward(plan, again, failure)
         call check(error, energy(again)/long(i), energy(x), thr=1.0e-13_dp, rel=.true.)
         call fft_backward(plan, again, failure)
         call check(error, distance(again, x) <= 2*allowed(long(i)))
      end do
   end subroutine test_parseval

   subroutine test_real_forward()
      complex(dp), allocatable :: x(:), expected(:), spectrum(:)
      type(real_fft_plan_type) :: plan
      integer :: i
      integer(int64) :: half

      do i = 1, size(lengths)
         half = lengths(i)/2
         call sample(lengths(i), x)
         x = real(x, dp)
         call direct_sum(x, expected)
         call new_real_fft_plan(plan, lengths(i), failure)
         allocate (spectrum(half + 1))
         call real_fft_forward(plan, real(x, dp), spectrum, failure)
         if (went_wrong(failure)) return
         call check(error, distance(spectrum, expected(:half + 1)) <= allowed(lengths(i)), "length "//decimal(lengths(i)))
         deallocate (spectrum)
      end do
   end subroutine test_real_forward

   subroutine test_real_backward()
      complex(dp), allocatable :: x(:), spectrum(:)
      real(dp), allocatable :: again(:)
      type(real_fft_plan_type) :: plan
      integer :: i
      integer(int64) :: n

      do i = 1, size(lengths)
         n = lengths(i)
         call sample(n, x)
         x = real(x, dp)
         call new_real_fft_plan(plan, n, failure)
         allocate (spectrum(n/2 + 1), again(n))
         call real_fft_forward(plan, real(x, dp), spectrum, failure)
         call real_fft_backward(plan, spectrum, again, failure)
         if (went_wrong(failure)) return
         call check(error, distance(cmplx(again, kind=dp), x) <= 2*allowed(lengths(i)), "length "//decimal(lengths(i)))
         deallocate (spectrum, again)
      end do
   end subroutine test_real_backward

   !> Against trial division of every number from n upwards.
   subroutine test_smooth_length()
      integer(int64) :: n, candidate, rest
      integer :: i
      integer, parameter :: primes(3) = [2, 3, 5]

      do n = 1, 2100
         candidate = n - 1
         do
            candidate = candidate + 1
            rest = candidate
            do i = 1, 3
               do while (mod(rest, int(primes(i), int64)) == 0)
                  rest = rest/primes(i)
               end do
            end do
            if (rest == 1) exit
         end do
         call check(error, smooth_length(n), candidate)
      end do
   end subroutine test_smooth_length

   !> Whole and cut convolutions against the double loop.
   subroutine test_convolution()
      integer, parameter :: na(5) = [1, 1, 7, 100, 3], nb(5) = [1, 9, 5, 64, 500], nc(5) = [1, 9, 11, 100, 502]
      complex(dp), allocatable :: a(:), b(:)
      real(dp), allocatable :: c(:), expected(:)
      integer :: i, j, k

      do i = 1, size(na)
         call sample(int(na(i), int64), a)
         call sample(int(nb(i), int64), b)
         allocate (c(nc(i)), expected(nc(i)))
         do k = 1, nc(i)
            expected(k) = sum([(real(a(j), dp)*real(b(k - j + 1), dp), j=max(1, k + 1 - nb(i)), min(k, na(i)))])
         end do
         call convolve(real(a, dp), real(b, dp), c, failure)
         if (went_wrong(failure)) return
         call check(error, maxval(abs(c - expected)) <= 1.0e-14_dp*max(1.0_dp, sqrt(energy(a)*energy(b))))
         deallocate (c, expected)
      end do
   end subroutine test_convolution

   subroutine test_failures()
      type(fft_plan_type) :: plan
      type(real_fft_plan_type) :: real_plan
      complex(dp) :: x(3), spectrum(3)
      real(dp) :: series(4), c(8)

      x = 0
      spectrum = 0
      series = 0
      call new_fft_plan(plan, 0_int64, failure)
      call expect_invalid(failure, "length 0")
      call new_fft_plan(plan, huge(1_int64), failure)
      call expect_invalid(failure, "length huge")
      call new_real_fft_plan(real_plan, -1_int64, failure)
      call expect_invalid(failure, "real length -1")
      call new_fft_plan(plan, 4_int64, failure)
      call fft_forward(plan, x, failure)
      call expect_invalid(failure, "series of another length")
      call fft_backward(plan, x, failure)
      call expect_invalid(failure, "spectrum of another length")
      call new_real_fft_plan(real_plan, 4_int64, failure)
      call real_fft_forward(real_plan, series(:3), spectrum, failure)
      call expect_invalid(failure, "real series of another length")
      call real_fft_backward(real_plan, spectrum(:2), series, failure)
      call expect_invalid(failure, "half spectrum of another length")
      call convolve(series, series(:0), c(:3), failure)
      call expect_invalid(failure, "empty series")
      call convolve(series, series, c, failure)
      call expect_invalid(failure, "more values than the convolution has")
   end subroutine test_failures

   !> Fails unless the call failed with invalid_argument; keeps an earlier failure.
   subroutine expect_invalid(failure, what)
      type(gyro_error), allocatable, intent(in) :: failure
      character(*), intent(in) :: what

      if (allocated(error)) return
      if (allocated(failure)) then
         call check(error, failure%code, status%invalid_argument, what)
      else
         call check(error, .false., "no error for "//what)
      end if
   end subroutine expect_invalid

   !> A deterministic series without symmetry, values in [-1, 1)
   subroutine sample(n, x)
      integer(int64), intent(in) :: n
      complex(dp), allocatable, intent(out) :: x(:)
      integer(int64) :: j, state

      allocate (x(n))
      state = 12345
      do j = 1, n
         state = mod(16807*state, 2147483647_int64)
         x(j) = cmplx(2*state/2147483647.0_dp - 1, 0.0_dp, dp)
         state = mod(16807*state, 2147483647_int64)
         x(j) = x(j) + cmplx(0.0_dp, 2*state/2147483647.0_dp - 1, dp)
      end do
   end subroutine sample

   !> The definition
   subroutine direct_sum(x, spectrum)
      complex(dp), intent(in) :: x(:)
      complex(dp), allocatable, intent(out) :: spectrum(:)
      complex(dp), allocatable :: root(:)
      integer :: j, k, n

      n = size(x)
      allocate (root(0:n - 1), spectrum(n))
      do j = 0, n - 1
         root(j) = exp(cmplx(0.0_dp, -2*acos(-1.0_dp)*j/n, dp))
      end do
      do k = 0, n - 1
         spectrum(k + 1) = 0
         do j = 0, n - 1
            spectrum(k + 1) = spectrum(k + 1) + x(j + 1)*root(mod(j*k, n))
         end do
      end do
   end subroutine direct_sum

   !> Root mean square difference over root mean square
   pure real(dp) function distance(x, expected)
      complex(dp), intent(in) :: x(:), expected(:)

      distance = sqrt(energy(x - expected)/energy(expected))
   end function distance

   pure real(dp) function energy(x)
      complex(dp), intent(in) :: x(:)

      energy = sum(real(x, dp)**2 + aimag(x)**2)
   end function energy

   pure real(dp) function allowed(n)
      integer(int64), intent(in) :: n

      allowed = per_log*max(1.0_dp, log(real(n, dp)))
   end function allowed

   pure function decimal(n) result(text)
      integer(int64), intent(in) :: n
      character(8) :: text

      write (text, "(i0)") n
   end function decimal
end module test_fft
