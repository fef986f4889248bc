! SPDX-License-Identifier: MIT
!> Equivalent degrees of freedom of any statistic of the Allan family in a noise mixture.
!>
!> A statistic is the mean square of T differences z_k of the phase. With their autocovariance R(u) and mean mu (a ramp's, which
!> the Hadamard variances do not see), Gaussian noise gives
!>
!> $$ \nu = \frac{2\, \mathrm{E}^2}{\mathrm{Var}} =
!>    \frac{2\, T^2 (R(0) + \mu^2)^2}{\sum_{|j| < T} (T - |j|) \left(2 R(j h)^2 + 4 \mu^2 R(j h)\right)} $$
!>
!> with h = m for windows that do not overlap, else 1. R is a difference of the generalised autocovariance of the phase: of the
!> fourth order (Allan), the sixth (Hadamard), or the sixth of its running sums (modified). It is smooth between the
!> multiples of m; sums over many lags are Gauss quadrature between these, finer towards them, so that the cost does not depend
!> on the length of the record. No type of noise is identified: where one term rules, these are the degrees of freedom of
!> Greenhall & Riley (2003). A sinusoid adds to E its power P in z, and to the denominator 4 P T times the spectrum of z at its
!> frequency. The total variance: [[gyroakf_allan_total_edf]].
module gyroakf_allan_mixture_edf
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_noise_model, only : noise_model_type, term_flicker, term_markov, term_quantisation, term_ramp, &
      & term_sinusoid, term_walk, term_white, unit_model
   use gyroakf_allan_phase_covariance, only : phase_covariance, sum_covariance
   use gyroakf_allan_statistic, only : difference_order, term_count
   use gyroakf_allan_total_edf, only : total_degrees_of_freedom
   use gyroakf_allan_quadrature, only : node, node_count, weight
   implicit none (type, external)
   private
   public :: mixture_degrees_of_freedom

   !> Lags that are summed one by one
   integer(int64), parameter :: direct_max = 3072
   !> Lags of windows that do not overlap
   integer(int64), parameter :: separate_max = 64
   !> Ends of the parts of a segment of length m, and of the tail, in units of m and of the longest lag with a kink
   real(dp), parameter :: part(0:6) = [0.0_dp, 0.0625_dp, 0.25_dp, 0.5_dp, 0.75_dp, 0.9375_dp, 1.0_dp]
   real(dp), parameter :: tail(0:6) = [1.0_dp, 1.0625_dp, 1.25_dp, 2.0_dp, 4.0_dp, 8.0_dp, 20.0_dp]
   !> Most degrees of freedom that are told apart
   real(dp), parameter :: edf_most = 1e15_dp
   real(dp), parameter :: pi = 3.141592653589793_dp

   !> A difference of the phase
   type :: difference_type
      !> The mixture
      type(noise_model_type) :: model
      !> Averaging factor
      real(dp) :: m = 1.0_dp
      !> Number of terms T
      real(dp) :: terms = 1.0_dp
      !> Square of the mean of z
      real(dp) :: mean_square = 0.0_dp
      !> Weights of lags u, u +- m, u +- 2m, u +- 3m
      real(dp) :: weights(0:3) = 0.0_dp
      !> Of the running sums of the phase
      logical :: sums = .false.
   end type difference_type

contains

   !> Degrees of freedom of a statistic of a complete record.
   pure real(dp) function mixture_degrees_of_freedom(kind, samples, m, model) result(edf)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factor, 1 .. longest_factor
      integer(int64), intent(in) :: m
      !> The mixture; without any noise the result is 1e15
      type(noise_model_type), intent(in) :: model

      type(difference_type) :: z
      integer(int64) :: stride

      z = difference_of(kind, samples, m, unit_model(model))
      stride = merge(m, 1_int64, kind == "adev" .or. kind == "hdev")
      edf = freedom(z, stride, .true., difference_order(kind))
      if (kind == "totdev" .and. edf < edf_most) then
         edf = total_degrees_of_freedom(samples, m, unit_model(model))*edf/freedom(z, stride, .false., 2)
      end if
   end function mixture_degrees_of_freedom

   !> Degrees of freedom of the mean square of a difference.
   pure real(dp) function freedom(z, stride, sinusoid, order) result(edf)
      !> The difference
      type(difference_type), intent(in) :: z
      !> Samples from term to term
      integer(int64), intent(in) :: stride
      !> The sinusoid counts
      logical, intent(in) :: sinusoid
      !> Order of the difference of the phase
      integer, intent(in) :: order

      real(dp) :: variance, power, spectrum

      power = 0
      spectrum = 0
      if (sinusoid) call add_sinusoid(z, order, power, spectrum)
      variance = sum_over_lags(z, stride) + 4*power*spectrum*z%terms/real(stride, dp)
      edf = edf_most
      if (variance > 0) edf = min(edf, 2*z%terms**2*(total_covariance(z, 0_int64) + z%mean_square + power)**2/variance)
   end function freedom

   !> The difference that a statistic squares; of totdev that of oadev.
   pure function difference_of(kind, samples, m, model) result(z)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Rate samples in the record, and averaging factor
      integer(int64), intent(in) :: samples, m
      !> The mixture
      type(noise_model_type), intent(in) :: model
      type(difference_type) :: z

      z%model = model
      z%m = real(m, dp)
      z%terms = real(merge(term_count("oadev", samples, m), term_count(kind, samples, m), kind == "totdev"), dp)
      z%sums = (kind == "mdev" .or. kind == "tdev") .and. m > 1
      if (z%sums) then
         z%weights = [-20.0_dp, 15.0_dp, -6.0_dp, 1.0_dp]/z%m**2
      else if (difference_order(kind) == 3) then
         z%weights = [20.0_dp, -15.0_dp, 6.0_dp, -1.0_dp]
      else
         z%weights = [6.0_dp, -4.0_dp, 1.0_dp, 0.0_dp]
      end if
      if (difference_order(kind) == 2) z%mean_square = model%squares(term_ramp)*z%m**4
   end function difference_of

   !> Sum over all lags, of both signs, of (T - |j|)(2 R^2 + 4 mu^2 R).
   pure real(dp) function sum_over_lags(z, stride) result(total)
      !> The difference
      type(difference_type), intent(in) :: z
      !> Samples from term to term
      integer(int64), intent(in) :: stride

      integer(int64) :: j, last
      integer :: i, kinks
      real(dp) :: from

      kinks = merge(3, 2, abs(z%weights(3)) > 0)
      last = int(z%terms, int64) - 1
      if (stride > 1) then
         last = min(last, separate_max)
      else
         last = min(last, int(z%m*kinks*tail(6), int64))
      end if
      if (last <= direct_max) then
         total = z%terms*summand(z, total_covariance(z, 0_int64))
         do j = 1, last
            total = total + 2*(z%terms - real(j, dp))*summand(z, total_covariance(z, j*stride))
         end do
         return
      end if
      total = 0
      do i = 0, kinks - 1
         call add_parts(z, z%m*(i + part), total)
      end do
      call add_parts(z, z%m*kinks*tail, total)
      if (z%sums) return
      do i = 0, kinks                                       ! quantisation noise shows where phases meet
         from = 2*z%terms - 2*i*z%m
         if (i == 0) from = z%terms
         if (from <= 0) exit
         total = total + from*(summand(z, total_covariance(z, int(i*z%m, int64))) - summand(z, covariance(z, i*z%m)))
      end do
   end function sum_over_lags

   !> Adds quadratures over neighbouring parts of the lags.
   pure subroutine add_parts(z, ends, total)
      !> The difference
      type(difference_type), intent(in) :: z
      !> Where the parts end
      real(dp), intent(in) :: ends(0:)
      !> The sum to add to
      real(dp), intent(inout) :: total

      real(dp) :: length, u
      integer :: i, k

      do i = 1, ubound(ends, 1)
         length = min(ends(i), z%terms) - ends(i - 1)
         if (length <= 0) return
         do k = 1, node_count
            u = ends(i - 1) + node(k)*length
            total = total + 2*weight(k)*length*(z%terms - u)*summand(z, covariance(z, u))
         end do
      end do
   end subroutine add_parts

   !> 2 R^2 + 4 mu^2 R.
   pure real(dp) function summand(z, r)
      !> The difference, for its mean
      type(difference_type), intent(in) :: z
      !> R
      real(dp), intent(in) :: r

      summand = r*(2*r + 4*z%mean_square)
   end function summand

   !> R with quantisation noise.
   pure real(dp) function total_covariance(z, lag) result(r)
      !> The difference
      type(difference_type), intent(in) :: z
      !> Lag in samples, >= 0
      integer(int64), intent(in) :: lag

      integer(int64) :: m

      r = covariance(z, real(lag, dp))
      m = int(z%m, int64)
      if (z%sums .or. mod(lag, m) /= 0 .or. lag > 3*m) return
      r = r + z%model%squares(term_quantisation)*z%weights(lag/m)
   end function total_covariance

   !> R, of unmodified differences without quantisation noise.
   pure real(dp) function covariance(z, u) result(r)
      !> The difference
      type(difference_type), intent(in) :: z
      !> Lag in samples
      real(dp), intent(in) :: u

      integer :: i

      r = 0
      do i = -3, 3
         if (abs(z%weights(abs(i))) <= 0) cycle
         if (z%sums) then
            r = r + z%weights(abs(i))*sum_covariance(z%model, u + i*z%m)
         else
            r = r + z%weights(abs(i))*phase_covariance(z%model, u + i*z%m)
         end if
      end do
   end function covariance

   !> Power of the sinusoid in z, and spectrum of z at its frequency.
   pure subroutine add_sinusoid(z, order, power, spectrum)
      !> The difference
      type(difference_type), intent(in) :: z
      !> Order of the difference of the phase
      integer, intent(in) :: order
      !> Mean square of the sinusoid's part
      real(dp), intent(out) :: power
      !> Two-sided spectrum of the noise, per cycle per sample
      real(dp), intent(out) :: spectrum

      real(dp) :: f, gain, p

      power = 0
      spectrum = 0
      if (z%model%squares(term_sinusoid) <= 0) return
      f = z%model%frequency
      gain = (sin(pi*f*z%m)/sin(pi*f))**2*(2*sin(pi*f*z%m))**(2*order - 2)
      if (z%sums) gain = gain*(sin(pi*f*z%m)/(z%m*sin(pi*f)))**2
      power = z%model%squares(term_sinusoid)/2*gain
      p = exp(-1/z%model%correlation_time)
      spectrum = gain*(z%model%squares(term_quantisation)*(2*sin(pi*f))**2 + z%model%squares(term_white) &
         & + z%model%squares(term_flicker)/(2*pi*f) + z%model%squares(term_walk)/(2*pi*f)**2 &
         & + z%model%squares(term_markov)*(1 - p**2)/((1 - p)**2 + 4*p*sin(pi*f)**2))
   end subroutine add_sinusoid

end module gyroakf_allan_mixture_edf
