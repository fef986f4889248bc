! SPDX-License-Identifier: MIT
!> Sums of squared second differences of phase averages: the work of the modified Allan variance of
!> a record without gaps ([[gyroakf_allan_averaged_difference]] cuts it into chains).
!>
!> $$ z_j = \sum_{i=j}^{j+m-1} (x_{i+2m} - 2 x_{i+m} + x_i), \quad
!>    z_{j+1} = z_j + x_{j+3m} - 3 x_{j+2m} + 3 x_{j+m} - x_j $$
!>
!> A term costs one step of the recursion, whatever m; four chains of it run side by side.
module gyroakf_allan_phase_average
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: add_terms

   !> Steps of a chain that are prepared together
   integer(int64), parameter :: buffer_length = 256

contains

   !> Sum of z(j)**2 over some neighboring terms.
   pure subroutine add_terms(phase, m, first, terms, total)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factor, first term, number of terms
      integer(int64), intent(in) :: m, first, terms
      !> The sum, 0 without terms
      real(dp), intent(out) :: total

      integer(int64) :: j, quarter
      real(dp) :: z, rest

      total = 0
      if (terms <= 0) return
      quarter = terms/4
      if (quarter >= m) then
         call four_chains(phase, m, first, quarter, total, z)
      else
         quarter = 0
         z = first_average(phase, m, first)
         total = z**2
      end if
      rest = 0
      do j = first + max(4*quarter, 1_int64), first + terms - 1
         z = z + ((phase(j - 1 + 3*m) - phase(j - 1)) - 3*(phase(j - 1 + 2*m) - phase(j - 1 + m)))
         rest = rest + z**2
      end do
      total = total + rest
   end subroutine add_terms

   !> Four chains of the recursion side by side.
   pure subroutine four_chains(phase, m, first, length, total, z)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, first
      !> Terms of a chain, >= 1
      integer(int64), intent(in) :: length
      real(dp), intent(out) :: total, z

      real(dp) :: d(buffer_length, 4), z1, z2, z3, z4, s1, s2, s3, s4
      integer(int64) :: j, i, steps
      integer :: chain

      z1 = first_average(phase, m, first)
      z2 = first_average(phase, m, first + length)
      z3 = first_average(phase, m, first + 2*length)
      z4 = first_average(phase, m, first + 3*length)
      s1 = z1**2
      s2 = z2**2
      s3 = z3**2
      s4 = z4**2
      do j = 0, length - 2, buffer_length
         steps = min(buffer_length, length - 1 - j)
         do chain = 1, 4
            call third_differences(phase, m, first + (chain - 1)*length + j, d(:steps, chain))
         end do
         do i = 1, steps
            z1 = z1 + d(i, 1)
            z2 = z2 + d(i, 2)
            z3 = z3 + d(i, 3)
            z4 = z4 + d(i, 4)
            s1 = s1 + z1**2
            s2 = s2 + z2**2
            s3 = s3 + z3**2
            s4 = s4 + z4**2
         end do
      end do
      total = (s1 + s2) + (s3 + s4)
      z = z4
   end subroutine four_chains

   !> The steps of the recursion from neighboring places on.
   pure subroutine third_differences(phase, m, first, d)
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factor, and the first place
      integer(int64), intent(in) :: m, first
      real(dp), intent(out), contiguous :: d(:)

      integer(int64) :: i

      !$omp simd
      do i = 1, size(d, kind=int64)
         d(i) = (phase(first + i - 1 + 3*m) - phase(first + i - 1)) &
            & - 3*(phase(first + i - 1 + 2*m) - phase(first + i - 1 + m))
      end do
   end subroutine third_differences

   !> z(j) as the sum that defines it.
   pure real(dp) function first_average(phase, m, j) result(z)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, j
      integer(int64) :: i

      z = 0
      !$omp simd reduction(+:z)
      do i = j, j + m - 1
         z = z + ((phase(i + 2*m) - phase(i + m)) - (phase(i + m) - phase(i)))
      end do
   end function first_average

end module gyroakf_allan_phase_average
