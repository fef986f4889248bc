! SPDX-License-Identifier: MIT
!> The Levinson-Durbin recursion: AR models of every order from one set of autocovariances.
!>
!> Burg's method makes the same step with reflection coefficients from residuals.
module gyroakf_ar_levinson
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: solve_levinson

contains

   !> Solves the Yule-Walker equations for the orders 1 .. p.
   !>
   !> $$k_m = \Big(r_m - \sum_{j<m} \phi_{m-1,j} r_{m-j}\Big)/s_{m-1}, \quad \phi_{m,m} = k_m, \quad
   !>   \phi_{m,j} = \phi_{m-1,j} - k_m \phi_{m-1,m-j}, \quad s_m = s_{m-1}(1 - k_m^2)$$
   !> with s_0 = r_0. O(p^2). With positive definite autocovariances (biased, without gaps) |k_m| <
   !> 1 and every model is stationary. Source: Durbin, Rev. Int. Stat. Inst. 28 (1960) 233-244.
   subroutine solve_levinson(r, phi, variance, error)
      !> Autocovariances, finite: [0:p], p >= 0
      real(dp), intent(in) :: r(0:)
      !> Coefficients: [p, p]; column m holds the AR(m) model in its rows 1 .. m, 0 below
      real(dp), allocatable, intent(out) :: phi(:, :)
      !> Innovation variances s_0 .. s_p: [0:p]
      real(dp), allocatable, intent(out) :: variance(:)
      !> constant_input (r(0) <= 0), singular (an s_m <= 0: perfect prediction, or gaps made the
      !> autocovariances indefinite), non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: reflection
      character(160) :: text
      integer :: p, m, before, stat

      p = ubound(r, 1)
      allocate (variance(0:p), stat=stat)
      if (stat == 0) allocate (phi(p, p), stat=stat)
      call check_memory(stat, "the AR coefficients of every order", error)
      if (allocated(error)) return
      phi = 0.0_dp
      variance = 0.0_dp
      if (.not. all(ieee_is_finite(r))) then
         call fatal_error(error, status%non_finite, "an autocovariance is not finite")
         return
      else if (r(0) <= 0.0_dp) then
         call fatal_error(error, status%constant_input, &
            & "the series has no variance, no AR model describes it")
         return
      end if
      variance(0) = r(0)
      do m = 1, p
         before = max(m - 1, 1)
         reflection = (r(m) - dot_product(phi(:m - 1, before), r(m - 1:1:-1)))/variance(m - 1)
         phi(:m - 1, m) = phi(:m - 1, before) - reflection*phi(m - 1:1:-1, before)
         phi(m, m) = reflection
         variance(m) = variance(m - 1)*((1.0_dp - reflection)*(1.0_dp + reflection))
         if (variance(m) <= epsilon(r)*r(0)) then
            write (text, "(a, i0, 2(a, es10.3))") "the Yule-Walker equations are singular at " &
               & //"order ", m, ": variance ", variance(m), " of ", r(0)
            call fatal_error(error, status%singular, trim(text))
            return
         end if
      end do
   end subroutine solve_levinson

end module gyroakf_ar_levinson
