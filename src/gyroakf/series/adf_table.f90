! SPDX-License-Identifier: MIT
!> Coefficients of a Dickey-Fuller regression of the samples, with their standard errors.
!>
!> The regression is made on the series less its trend T and on powers of a scaled time. In the
!> user's terms it is $$\Delta x_t = \alpha_0 + \alpha_1 s + \alpha_2 s^2 + \rho x_{t-1} + \sum_j
!> b_j \Delta x_{t-j} + e_t$$ with the time s = 1, 2, ... counted in samples from the first row that
!> a record without gaps has (s = t - lags, t the 0-based index of the sample). rho and b_j are the
!> same in both; the alpha are linear functions of all coefficients and T.
module gyroakf_series_adf_table
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dtrtrs
   use gyroakf_stats_trend, only : trend_type
   implicit none (type, external)
   private
   public :: adf_coefficient_type, coefficient_table

   !> One coefficient
   type :: adf_coefficient_type
      !> "constant", "time", "time^2", "level", "lag 1", "lag 2", ...
      character(12) :: name = ""
      !> Estimate, in the unit of the series for constant and times, else without one
      real(dp) :: value = 0.0_dp
      !> Its standard error, with N - k in the residual variance
      real(dp) :: std_error = 0.0_dp
      !> value/std_error; of "level" the statistic of the test, which has no Student distribution
      real(dp) :: t = 0.0_dp
   end type adf_coefficient_type

   character(12), parameter :: power_names(3) = [character(12) :: "constant", "time", "time^2"]

contains

   !> The table: deterministic terms, level, lags.
   subroutine coefficient_table(r, scale, terms, lags, rows, n, trend, table)
      !> Factor of the scaled columns: powers of the time, lags, level, difference
      real(dp), intent(in) :: r(:, :)
      !> Lengths of the columns
      real(dp), intent(in) :: scale(:)
      !> Deterministic terms 0 .. 3, lags
      integer, intent(in) :: terms, lags
      !> Rows of the regression, length of the series
      integer(int64), intent(in) :: rows, n
      !> Subtracted from the series, degree at most 2
      type(trend_type), intent(in) :: trend
      !> [terms + 1 + lags]
      type(adf_coefficient_type), allocatable, intent(out) :: table(:)
      real(dp), allocatable :: beta(:, :), form(:, :), map(:, :)
      real(dp) :: constant(3), sigma
      integer :: i, k, info

      k = terms + lags + 1
      sigma = r(k + 1, k + 1)*scale(k + 1)/sqrt(real(rows, dp) - real(k, dp))
      allocate (beta(k, 1), form(k, k), map(k, k), table(k))
      beta(:, 1) = r(:k, k + 1)*scale(k + 1)
      call dtrtrs("U", "N", "N", k, 1, r, size(r, 1), beta, k, info)
      beta(:, 1) = beta(:, 1)/scale(:k)
      call linear_forms(terms, lags, n, trend, map, constant)
      form = 0.0_dp
      do i = 1, k
         form(:, i) = map(:, i)/scale(:k)
      end do
      call dtrtrs("U", "T", "N", k, k, r, size(r, 1), form, k, info)
      do i = 1, k
         if (i <= terms) table(i)%name = power_names(i)
         if (i == terms + 1) table(i)%name = "level"
         if (i > terms + 1) write (table(i)%name, "(a, i0)") "lag ", i - terms - 1
         table(i)%value = dot_product(map(:, i), beta(:, 1))
         if (i <= terms) table(i)%value = table(i)%value + constant(i)
         table(i)%std_error = sigma*norm2(form(:, i))
         table(i)%t = table(i)%value/table(i)%std_error
      end do
   end subroutine coefficient_table

   !> Each coefficient of the table as a linear function of those of the regression.
   pure subroutine linear_forms(terms, lags, n, trend, map, constant)
      integer, intent(in) :: terms, lags
      integer(int64), intent(in) :: n
      type(trend_type), intent(in) :: trend
      !> Factors of powers of the time, lags, level; a column for each row of the table
      real(dp), intent(out) :: map(:, :)
      real(dp), intent(out) :: constant(3)
      real(dp) :: c, d, power(3, 3)
      integer :: j, level

      level = terms + lags + 1
      map = 0.0_dp
      map(level, terms + 1) = 1.0_dp
      do j = 1, lags
         map(terms + j, terms + 1 + j) = 1.0_dp
      end do
      constant = 0.0_dp
      if (terms == 0) return
      c = 2.0_dp/real(n, dp)
      d = real(2*int(lags, int64) - n, dp)/real(n, dp)
      power = reshape([1.0_dp, 0.0_dp, 0.0_dp, d, c, 0.0_dp, d*d, 2.0_dp*c*d, c*c], [3, 3])
      map(:terms, :terms) = transpose(power(:terms, :terms))
      constant = difference_of(trend, int(lags, int64))
      power(:, 1) = value_of(trend, int(lags - 1, int64))
      map(level, :terms) = -power(:terms, 1)
      do j = 1, lags
         power(:, 1) = difference_of(trend, int(lags - j, int64))
         map(terms + j, :terms) = -power(:terms, 1)
      end do
   end subroutine linear_forms

   !> Powers of s in T(s + shift).
   pure function value_of(trend, shift) result(power)
      type(trend_type), intent(in) :: trend
      integer(int64), intent(in) :: shift
      real(dp) :: power(3), a(0:2), c, d

      call scaled(trend, shift, a, c, d)
      power = [a(0) - 0.5_dp*a(2) + a(1)*d + 1.5_dp*a(2)*d*d + trend%remainder, &
         & a(1)*c + 3.0_dp*a(2)*c*d, 1.5_dp*a(2)*c*c]
   end function value_of

   !> Powers of s in T(s + shift) - T(s + shift - 1).
   pure function difference_of(trend, shift) result(power)
      type(trend_type), intent(in) :: trend
      integer(int64), intent(in) :: shift
      real(dp) :: power(3), a(0:2), c, d

      call scaled(trend, shift, a, c, d)
      power = [a(1)*c + 3.0_dp*a(2)*c*d - 1.5_dp*a(2)*c*c, 3.0_dp*a(2)*c*c, 0.0_dp]
   end function difference_of

   !> Coefficients of the Legendre polynomials, and c, d of their argument c s + d.
   pure subroutine scaled(trend, shift, a, c, d)
      type(trend_type), intent(in) :: trend
      integer(int64), intent(in) :: shift
      real(dp), intent(out) :: a(0:2), c, d
      integer :: k

      a = 0.0_dp
      do k = 0, min(trend%degree, 2)
         a(k) = trend%legendre(k)
      end do
      c = 2.0_dp/real(max(trend%samples - 1, 1_int64), dp)
      d = real(2*shift - (trend%samples - 1), dp)/real(max(trend%samples - 1, 1_int64), dp)
   end subroutine scaled

end module gyroakf_series_adf_table
