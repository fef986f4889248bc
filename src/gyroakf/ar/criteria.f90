! SPDX-License-Identifier: MIT
!> Criteria that compare AR models of several orders.
!>
!> With s2 the innovation variance of order p, n samples and k = p + 1 parameters of the mean
!> (coefficients and mean value), $$\ln L = -\frac n2(\ln 2\pi + \ln s^2 + 1):$$
!>
!> | criterion | form |
!> |---|---|
!> | AIC  | -2 ln L + 2 (k + 1) |
!> | AICc | -2 ln L + 2 (k + 1) n/(n - k - 2) |
!> | BIC  | -2 ln L + (k + 1) ln n |
!> | HQIC | -2 ln L + 2 (k + 1) ln ln n |
!> | FPE  | s2 (n + k)/(n - k) |
!> | AIC per observation | 1 + ln 2 pi + ln s2 + 2 p/n |
!>
!> k + 1 counts the innovation variance, as statsmodels' AutoReg does; every order uses the same n,
!> so that differences are comparable with any other convention. The last line is the form of the
!> paper's Table I, which counts the coefficients alone. Sources: Akaike, IEEE Trans. Autom. Control
!> 19 (1974) 716-723; Hurvich & Tsai, Biometrika 76 (1989) 297-307; Schwarz, Ann. Stat. 6 (1978)
!> 461-464; Hannan & Quinn, J. R. Stat. Soc. B 41 (1979) 190-195.
module gyroakf_ar_criteria
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: ar_order_type, order_criteria, criterion_number, best_order

   !> A line of the order table
   type :: ar_order_type
      !> Order p
      integer :: order = 0
      !> Innovation variance s2
      real(dp) :: noise_variance = 0.0_dp
      !> Criteria; the smaller the better
      real(dp) :: aic = 0.0_dp, aicc = 0.0_dp, bic = 0.0_dp, hqic = 0.0_dp, fpe = 0.0_dp
      !> AIC per observation, as in the paper
      real(dp) :: aic_per_observation = 0.0_dp
   end type ar_order_type

   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp

contains

   !> All criteria of one order.
   elemental type(ar_order_type) function order_criteria(order, noise_variance, n) result(line)
      !> Order p >= 0
      integer, intent(in) :: order
      !> Innovation variance > 0
      real(dp), intent(in) :: noise_variance
      !> Samples, > p + 3
      integer(int64), intent(in) :: n
      real(dp) :: m, k, minus_two_l

      m = real(n, dp)
      k = real(order + 1, dp)
      minus_two_l = m*(log_two_pi + log(noise_variance) + 1.0_dp)
      line%order = order
      line%noise_variance = noise_variance
      line%aic = minus_two_l + 2.0_dp*(k + 1.0_dp)
      line%aicc = minus_two_l + 2.0_dp*(k + 1.0_dp)*(m/(m - k - 2.0_dp))
      line%bic = minus_two_l + (k + 1.0_dp)*log(m)
      line%hqic = minus_two_l + 2.0_dp*(k + 1.0_dp)*log(log(m))
      line%fpe = noise_variance*((m + k)/(m - k))
      line%aic_per_observation = 1.0_dp + log_two_pi + log(noise_variance) &
         & + 2.0_dp*real(order, dp)/m
   end function order_criteria

   !> 1 aic, 2 aicc, 3 bic, 4 hqic, 5 fpe; 0 unknown.
   pure integer function criterion_number(criterion)
      !> Its name
      character(*), intent(in) :: criterion

      select case (criterion)
      case ("aic"); criterion_number = 1
      case ("aicc"); criterion_number = 2
      case ("bic"); criterion_number = 3
      case ("hqic"); criterion_number = 4
      case ("fpe"); criterion_number = 5
      case default; criterion_number = 0
      end select
   end function criterion_number

   !> Order with the smallest value, the smaller one where two agree.
   pure integer function best_order(table, criterion)
      !> Orders 0, 1, ...
      type(ar_order_type), intent(in) :: table(:)
      !> 1 .. 5, see criterion_number
      integer, intent(in) :: criterion
      real(dp) :: value(size(table))

      select case (criterion)
      case (1); value = table%aic
      case (2); value = table%aicc
      case (3); value = table%bic
      case (4); value = table%hqic
      case default; value = table%fpe
      end select
      best_order = table(minloc(value, dim=1))%order
   end function best_order

end module gyroakf_ar_criteria
