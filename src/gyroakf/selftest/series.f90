! SPDX-License-Identifier: MIT
!> Series that published and exact values refer to, made by a recurrence of integers: the same bits everywhere.
!>
!> The minimal standard generator n_0 = 1234567890, n_(i+1) = 16807 n_i mod 2147483647. Its first thousand numbers over the modulus
!> are the test series of W. J. Riley and D. A. Howe, NIST SP 1065 (2008), section 12.4; less their mean and integrated they are the
!> phases PHASE.DAT of Stable32. Sums of twelve less six are nearly normal.
module gyroakf_selftest_series
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: nbs_short, nbs_long, phase_of, near_normal, recursion

   integer(int64), parameter :: first_state = 1234567890_int64, multiplier = 16807_int64, modulus = 2147483647_int64
   !> The nine rates of NIST SP 1065, table 30
   real(dp), parameter :: nbs_short(9) = [892.0_dp, 809.0_dp, 823.0_dp, 798.0_dp, 671.0_dp, 644.0_dp, 883.0_dp, 903.0_dp, 677.0_dp]

contains

   !> The series of a thousand rates of NIST SP 1065, and its continuation.
   pure subroutine nbs_long(rate)
      !> [n]
      real(dp), intent(out) :: rate(:)
      integer(int64) :: state
      integer :: i

      state = first_state
      do i = 1, size(rate)
         rate(i) = real(state, dp)/real(modulus, dp)
         state = mod(multiplier*state, modulus)
      end do
   end subroutine nbs_long

   !> The phases of rates less their mean, at unit interval.
   pure subroutine phase_of(rate, phase)
      !> [n]
      real(dp), intent(in) :: rate(:)
      !> From 0: [n + 1]
      real(dp), intent(out) :: phase(:)
      real(dp) :: mean
      integer :: i

      mean = sum(rate)/size(rate)
      phase(1) = 0.0_dp
      do i = 1, size(rate)
         phase(i + 1) = phase(i) + (rate(i) - mean)
      end do
   end subroutine phase_of

   !> Sums of twelve numbers less six: mean 0, variance 1.
   pure subroutine near_normal(e)
      !> [n]
      real(dp), intent(out) :: e(:)
      integer(int64) :: state, total
      integer :: t, j

      state = first_state
      do t = 1, size(e)
         total = 0
         do j = 1, 12
            total = total + state
            state = mod(multiplier*state, modulus)
         end do
         e(t) = real(total, dp)/real(modulus, dp) - 6.0_dp
      end do
   end subroutine near_normal

   !> $$ y_t = (e_t + a y_{t-1}) + b y_{t-2} $$ from 0, in this order of operations.
   pure subroutine recursion(e, a, b, y)
      !> Input: [n]
      real(dp), intent(in) :: e(:)
      !> Coefficients
      real(dp), intent(in) :: a, b
      !> [n]
      real(dp), intent(out) :: y(:)
      real(dp) :: before, before2
      integer :: t

      before = 0.0_dp
      before2 = 0.0_dp
      do t = 1, size(e)
         y(t) = (e(t) + a*before) + b*before2
         before2 = before
         before = y(t)
      end do
   end subroutine recursion

end module gyroakf_selftest_series
