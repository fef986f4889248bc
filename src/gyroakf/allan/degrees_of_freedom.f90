! SPDX-License-Identifier: MIT
!> Equivalent degrees of freedom (edf) of Allan-family variances, and confidence limits from them.
!>
!> An estimate with edf degrees of freedom is distributed like its expectation times
!> chi-square(edf)/edf. The algorithm is that of C. A. Greenhall, W. J. Riley, "Uncertainty of
!> stability variances based on finite differences", Proc. 35th PTTI Meeting (2003), complete, with
!> the short cases of white phase noise. Notation of the paper: difference d (1 first differences, 2
!> Allan, 3 Hadamard), filter factor F, stride factor S, number of estimates M', number of terms J,
!> r = M'/S; lags are in units of m.
module gyroakf_allan_degrees_of_freedom
   use gyroakf_kinds, only : dp, int64
   use gyroakf_special, only : chi_square_quantile, normal_quantile
   implicit none (type, external)
   private
   public :: greenhall_edf, chi_square_limits

   !> Terms of a basic sum that are added one by one
   integer(int64), parameter :: terms_max = 100
   !> Degrees of freedom between which the chi-square quantile is called
   real(dp), parameter :: edf_min = 0.1_dp, edf_max = 1e6_dp
   !> Filter factor that stands for infinity
   real(dp), parameter :: unlimited = 0.0_dp
   !> Table 3 of the paper: b0, b1 of flicker phase noise for each difference
   real(dp), parameter :: table3(2, 3) = &
      & reshape([6.0_dp, 4.0_dp, 15.23_dp, 12.0_dp, 47.8_dp, 40.0_dp], [2, 3])

contains

   !> Equivalent degrees of freedom of a variance of finite differences, 0 where the record is too
   !> short.
   pure real(dp) function greenhall_edf(phases, m, alpha, difference, modified, &
      & overlapped) result(edf)
      !> Phase points: one more than rate samples
      integer(int64), intent(in) :: phases
      !> Averaging factor, >= 1
      integer(int64), intent(in) :: m
      !> Exponent of the power-law noise of the rate, spectrum ~ f**alpha: 2 white phase
      !> (quantization), 1 flicker phase, 0 white rate, -1 flicker, -2 random walk; moved to the
      !> nearest value the difference can handle, 2 .. 2 - 2 d
      integer, intent(in) :: alpha
      !> Order of the difference: 1, 2 (Allan) or 3 (Hadamard)
      integer, intent(in) :: difference
      !> Modified (phase averages) or not
      logical, intent(in) :: modified
      !> Overlapping windows or not
      logical, intent(in) :: overlapped

      integer(int64) :: stride, estimates, length
      real(dp) :: scale
      integer :: a, d

      d = min(max(difference, 1), 3)
      a = min(max(alpha, 2 - 2*d), 2)
      length = m*d + merge(m, 1_int64, modified)
      stride = merge(m, 1_int64, overlapped)
      edf = 0
      if (phases < length) return
      if (overlapped) then
         estimates = 1 + phases - length
      else
         estimates = 1 + (phases - length)/m
      end if
      if (modified) then
         edf = edf_filtered(estimates, stride, 1.0_dp, 1.0_dp, a, d, table1(a, d))
      else if (a <= 0) then
         edf = edf_filtered(estimates, stride, &
            & merge(real(m, dp), unlimited, m*(d + 1) <= terms_max), unlimited, a, d, table2(a, d))
      else if (a == 1) then
         scale = table3(1, d) + table3(2, d)*log(real(m, dp))
         edf = edf_filtered(estimates, stride, real(m, dp), unlimited, a, d, table2(a, d), scale)
      else
         edf = edf_white_phase(estimates, stride, d)
      end if
   end function greenhall_edf

   !> Cases 1 to 3 of the paper: modified variances, and unmodified ones with alpha <= 1.
   pure real(dp) function edf_filtered(estimates, stride, filter, filter_long, alpha, d, table, &
      & scale) result(edf)
      integer(int64), intent(in) :: estimates, stride
      !> Filter factor F of the direct sum, and of the scaled one
      real(dp), intent(in) :: filter, filter_long
      integer, intent(in) :: alpha, d
      real(dp), intent(in) :: table(2)
      !> b0 + b1 ln m of flicker phase noise
      real(dp), intent(in), optional :: scale
      real(dp) :: r, s, top
      integer(int64) :: terms

      terms = min(estimates, (d + 1)*stride)
      r = real(estimates, dp)/real(stride, dp)
      if (terms <= terms_max) then
         s = real(estimates, dp)
         edf = s*structure_z(0.0_dp, filter, alpha, d)**2/basic_sum(terms, s, &
            & real(stride, dp), filter, alpha, d)
      else if (r > d + 1) then
         edf = r/(table(1) - table(2)/r)
         if (present(scale)) edf = scale**2*edf
      else
         s = real(terms_max, dp)
         top = structure_z(0.0_dp, filter_long, alpha, d)**2
         if (present(scale)) top = scale**2
         edf = s*top/basic_sum(terms_max, s, s/r, filter_long, alpha, d)
      end if
   end function edf_filtered

   !> Case 4: white phase noise, unmodified.
   pure real(dp) function edf_white_phase(estimates, stride, d) result(edf)
      integer(int64), intent(in) :: estimates, stride
      integer, intent(in) :: d
      real(dp) :: r, total
      integer :: k

      r = real(estimates, dp)/real(stride, dp)
      if (r > d) then
         edf = real(estimates, dp)/(binomial(4*d, 2*d)/binomial(2*d, d)**2 - 0.5_dp*d/r)
         return
      end if
      total = 1
      do k = 1, ceiling(r) - 1
         total = total + 2*(1 - k/r)*(binomial(2*d, d - k)/binomial(2*d, d))**2
      end do
      edf = real(estimates, dp)/total
   end function edf_white_phase

   !> Sum of the squared correlations of the estimates, times structure_z(0)**2.
   pure real(dp) function basic_sum(terms, estimates, stride, filter, alpha, d) result(total)
      integer(int64), intent(in) :: terms
      real(dp), intent(in) :: estimates, stride, filter
      integer, intent(in) :: alpha, d
      integer(int64) :: j

      total = structure_z(0.0_dp, filter, alpha, d)**2 &
         & + (1 - real(terms, dp)/estimates) &
         & *structure_z(real(terms, dp)/stride, filter, alpha, d)**2
      do j = 1, terms - 1
         total = total + 2*(1 - real(j, dp)/estimates)*structure_z(real(j, dp)/stride, filter, &
            & alpha, d)**2
      end do
   end function basic_sum

   !> Generalised autocovariance of the d-th difference of the filtered phase.
   pure real(dp) function structure_z(t, filter, alpha, d) result(s)
      real(dp), intent(in) :: t, filter
      integer, intent(in) :: alpha, d
      integer :: k

      s = binomial(2*d, d)*structure_x(t, filter, alpha)
      do k = 1, d
         s = s + (-1)**k*binomial(2*d, d - k)*(structure_x(t - k, filter, alpha) &
            & + structure_x(t + k, filter, alpha))
      end do
   end function structure_z

   !> The same of the filtered phase.
   pure real(dp) function structure_x(t, filter, alpha) result(s)
      real(dp), intent(in) :: t, filter
      integer, intent(in) :: alpha

      if (filter <= unlimited) then
         s = structure_w(t, alpha + 2)
      else
         s = filter**2*(2*structure_w(t, alpha) - structure_w(t - 1/filter, alpha) &
            & - structure_w(t + 1/filter, alpha))
      end if
   end function structure_x

   !> The same of pure power-law noise, up to a factor.
   pure real(dp) function structure_w(t, alpha) result(s)
      real(dp), intent(in) :: t
      !> Exponent, even: |t|**(3 - alpha), odd: t**(3 - alpha) ln|t|
      integer, intent(in) :: alpha

      real(dp) :: lag

      lag = abs(t)
      s = 0
      if (lag <= 0) return
      s = lag**(3 - alpha)
      if (mod(alpha, 2) /= 0) s = s*log(lag)
      if (modulo(alpha, 4) >= 2) s = -s
   end function structure_w

   !> Binomial coefficient of small numbers.
   pure real(dp) function binomial(n, k)
      integer, intent(in) :: n, k
      integer :: i

      binomial = 1
      do i = 1, k
         binomial = binomial*(n - k + i)/i
      end do
   end function binomial

   !> Table 1 of the paper: a0, a1 of modified variances.
   pure function table1(alpha, d) result(a)
      integer, intent(in) :: alpha, d
      real(dp) :: a(2), t(2, 3)

      t = 0
      select case (alpha)
      case (2); t = reshape([2/3.0_dp, 1/3.0_dp, 7/9.0_dp, 1/2.0_dp, 22/25.0_dp, 2/3.0_dp], [2, 3])
      case (1); t = reshape([0.840_dp, 0.345_dp, 0.997_dp, 0.616_dp, 1.141_dp, 0.843_dp], [2, 3])
      case (0); t = reshape([1.079_dp, 0.368_dp, 1.033_dp, 0.607_dp, 1.184_dp, 0.848_dp], [2, 3])
      case (-1); t(:, 2:) = reshape([1.048_dp, 0.534_dp, 1.180_dp, 0.816_dp], [2, 2])
      case (-2); t(:, 2:) = reshape([1.302_dp, 0.535_dp, 1.175_dp, 0.777_dp], [2, 2])
      case (-3); t(:, 3) = [1.194_dp, 0.703_dp]
      case default; t(:, 3) = [1.489_dp, 0.702_dp]
      end select
      a = t(:, d)
   end function table1

   !> Table 2: unmodified variances.
   pure function table2(alpha, d) result(a)
      integer, intent(in) :: alpha, d
      real(dp) :: a(2), t(2, 3)

      t = 0
      select case (alpha)
      case (1); t = reshape([78.6_dp, 25.2_dp, 790.0_dp, 410.0_dp, 9950.0_dp, 6520.0_dp], [2, 3])
      case (0); t = reshape([2/3.0_dp, 1/6.0_dp, 2/3.0_dp, 1/3.0_dp, 7/9.0_dp, 1/2.0_dp], [2, 3])
      case (-1); t(:, 2:) = reshape([0.852_dp, 0.375_dp, 0.997_dp, 0.617_dp], [2, 2])
      case (-2); t(:, 2:) = reshape([1.079_dp, 0.368_dp, 1.033_dp, 0.607_dp], [2, 2])
      case (-3); t(:, 3) = [1.053_dp, 0.553_dp]
      case default; t(:, 3) = [1.302_dp, 0.535_dp]
      end select
      a = t(:, d)
   end function table2

   !> Two-sided confidence limits of a deviation.
   !>
   !> $$ \sigma \sqrt{\nu / \chi^2_{(1 \pm c)/2}(\nu)} $$
   !> Source: Riley & Howe, NIST SP 1065 (2008), section 5.3.
   elemental subroutine chi_square_limits(deviation, edf, confidence, lower, upper)
      !> The estimate
      real(dp), intent(in) :: deviation
      !> Its equivalent degrees of freedom; below 0.1 taken as 0.1
      real(dp), intent(in) :: edf
      !> Probability between the limits, > 0, < 1
      real(dp), intent(in) :: confidence
      !> The limits
      real(dp), intent(out) :: lower, upper

      real(dp) :: half

      half = (1 + confidence)/2
      lower = deviation/sqrt(scaled_quantile(half, max(edf, edf_min)))
      upper = deviation/sqrt(scaled_quantile(1 - half, max(edf, edf_min)))
   end subroutine chi_square_limits

   !> Quantile of chi-square divided by its degrees of freedom.
   pure real(dp) function scaled_quantile(p, edf) result(q)
      real(dp), intent(in) :: p
      !> Degrees of freedom; from 1e6 on by the cube of a normal variable (Wilson & Hilferty 1931,
      !> exact to 1e-10 there)
      real(dp), intent(in) :: edf

      if (edf < edf_max) then
         q = chi_square_quantile(p, edf)/edf
      else
         q = (1 - 2/(9*edf) + normal_quantile(p)*sqrt(2/(9*edf)))**3
      end if
      q = max(q, tiny(1.0_dp))
   end function scaled_quantile

end module gyroakf_allan_degrees_of_freedom
