! SPDX-License-Identifier: MIT
!> Least squares with non-negative unknowns.
!>
!> The active-set method of C. L. Lawson, R. J. Hanson, "Solving Least Squares Problems" (1974), chapter 23,
!> for a few unknowns; the inner least-squares problems are LAPACK's.
module gyroakf_allan_nonnegative
   use gyroakf_kinds, only : dp
   use gyroakf_lapack, only : dgels
   implicit none (type, external)
   private
   public :: solve_nonnegative, solve_columns

contains

   !> Minimises |A x - b| subject to x >= 0.
   subroutine solve_nonnegative(a, b, x, converged)
      !> Matrix: [rows, columns], rows >= columns; columns of length about 1
      real(dp), intent(in), contiguous :: a(:, :)
      !> Right-hand side: [rows]
      real(dp), intent(in), contiguous :: b(:)
      !> Solution: [columns]
      real(dp), intent(out) :: x(:)
      !> False if the active set did not settle or a matrix was singular
      logical, intent(out) :: converged

      real(dp) :: gradient(size(x)), tolerance
      logical :: free(size(x)), tried(size(x))
      integer :: step, enter

      x = 0
      free = .false.
      tried = .false.
      tolerance = 1e-12_dp*norm2(b)
      converged = .true.
      do step = 1, 10*size(x)
         gradient = matmul(b - matmul(a, x), a)
         if (.not. any(gradient > tolerance .and. .not. (free .or. tried))) return
         enter = maxloc(gradient, dim=1, mask=.not. (free .or. tried))
         free(enter) = .true.
         call solve_free(a, b, free, x, converged)
         if (.not. converged) return
         tried = .false.
         tried(enter) = .not. free(enter)
      end do
      converged = .false.
   end subroutine solve_nonnegative

   !> Moves to the least-squares solution of the free unknowns, fixing those that reach 0 on the way.
   subroutine solve_free(a, b, free, x, converged)
      !> Matrix and right-hand side
      real(dp), intent(in), contiguous :: a(:, :), b(:)
      !> Which unknowns are free
      logical, intent(inout) :: free(:)
      !> Solution
      real(dp), intent(inout) :: x(:)
      !> False if a matrix was singular
      logical, intent(out) :: converged

      real(dp) :: goal(size(x)), share
      integer :: round, j

      converged = .true.
      do round = 1, size(x) + 1
         if (.not. any(free)) return
         call solve_columns(a, b, free, goal, converged)
         if (.not. converged) return
         if (all(goal > 0 .or. .not. free)) then
            x = goal
            return
         end if
         share = 1
         do j = 1, size(x)
            if (free(j) .and. goal(j) <= 0) share = min(share, x(j)/max(x(j) - goal(j), tiny(1.0_dp)))
         end do
         do j = 1, size(x)
            if (.not. free(j)) cycle
            if (goal(j) <= 0 .and. x(j) <= share*(x(j) - goal(j))*(1 + 1e-12_dp)) then
               free(j) = .false.
               x(j) = 0
            else
               x(j) = max(0.0_dp, x(j) + share*(goal(j) - x(j)))
            end if
         end do
      end do
   end subroutine solve_free

   !> Least squares in some of the columns; the other unknowns are 0.
   subroutine solve_columns(a, b, use_it, x, converged)
      !> Matrix: [rows, columns]
      real(dp), intent(in), contiguous :: a(:, :)
      !> Right-hand side: [rows]
      real(dp), intent(in), contiguous :: b(:)
      !> Which columns
      logical, intent(in) :: use_it(:)
      !> Solution: [columns]
      real(dp), intent(out) :: x(:)
      !> False if the columns are not independent
      logical, intent(out) :: converged

      real(dp) :: part(size(a, 1), count(use_it)), right(size(a, 1), 1), work(64*size(a, 2) + 64)
      integer :: info, j, k

      k = 0
      do j = 1, size(use_it)
         if (.not. use_it(j)) cycle
         k = k + 1
         part(:, k) = a(:, j)
      end do
      converged = k <= size(a, 1)
      x = 0
      if (.not. converged) return
      right(:, 1) = b
      call dgels("N", size(a, 1), k, 1, part, size(a, 1), right, size(a, 1), work, size(work), info)
      converged = info == 0
      if (converged) x = unpack(right(:k, 1), use_it, x)
   end subroutine solve_columns

end module gyroakf_allan_nonnegative
