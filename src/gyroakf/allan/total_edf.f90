! SPDX-License-Identifier: MIT
!> Equivalent degrees of freedom of the total variance in a noise mixture.
!>
!> It is the mean square of the second differences z_k of the phase, of which those whose windows reach over an end of the record
!> see its mirror image:
!>
!> $$ z_j = x_{j+m} - 2 x_j + 2 x_0 - x_{m-j}, \quad j = 1 \ldots m - 1 $$
!>
!> and likewise at the other end. With the covariances R_kl and means mu_k of all of them, of Gaussian noise,
!>
!> $$ \nu = \frac{2 \left( \sum_k (R_{kk} + \mu_k^2) \right)^2}{\sum_{k,l} \left(2 R_{kl}^2 + 4 \mu_k \mu_l R_{kl} \right)} $$
!>
!> The sum is formed for a record of the same length in averaging times whose phase is taken at m/32 samples (at
!> each where m is at most 32): the ratio of the two variances hardly depends on that. Pairs of terms far apart are left out.
!> The differences in the middle are a stationary series, so that only the first m rows of the matrix are formed one by one: the
!> cost depends on neither the length of the record nor m.
!> Source of the statistic: C. A. Greenhall, D. A. Howe, D. B. Percival, IEEE Trans. UFFC 46 (1999) 1183-1191.
module gyroakf_allan_total_edf
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_noise_model, only : noise_model_type, term_quantisation, term_ramp
   use gyroakf_allan_phase_covariance, only : phase_covariance
   implicit none (type, external)
   private
   public :: total_degrees_of_freedom

   !> Steps of an averaging time at most, and steps over which terms are taken as correlated: at least 10 averaging times
   integer, parameter :: steps_max = 32, reach = 320

   !> The record that stands for the true one
   type :: coarse_type
      !> Steps of an averaging time and of the record
      integer :: m = 1
      integer(int64) :: n = 2
      !> Samples of a step
      real(dp) :: step = 1.0_dp
      !> Variance of quantisation noise, and square of the ramp in units of the step
      real(dp) :: quantisation = 0.0_dp, ramp = 0.0_dp
      !> True terms for each step, of those in the middle and at an end
      real(dp) :: middle = 1.0_dp, edge = 1.0_dp
      !> Generalised autocovariance of the phase at multiples of the step
      real(dp) :: s(0:reach + 2*steps_max) = 0.0_dp
   end type coarse_type

   !> A term: its places in the phase, in steps, and their weights
   type :: term_type
      integer :: points = 3
      integer :: place(4) = 0
      real(dp) :: weight(4) = [1.0_dp, -2.0_dp, 1.0_dp, 0.0_dp]
      !> Its mean for a ramp of 1
      real(dp) :: mean = 0.0_dp
   end type term_type

contains

   !> Degrees of freedom of the total variance of a complete record.
   pure real(dp) function total_degrees_of_freedom(samples, m, model) result(edf)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factor, 1 .. samples/2
      integer(int64), intent(in) :: m
      !> The mixture; of the sinusoid nothing is known here; without any noise the result is 0
      type(noise_model_type), intent(in) :: model

      type(coarse_type) :: c
      real(dp) :: power, spread
      integer :: k

      c = coarse_record(samples, m, model)
      call add_middle(c, power, spread)
      do k = 1, c%m - 1                                     ! the other end is the mirror image
         call add_row(c, k, power, spread)
      end do
      edf = 0
      if (spread > 0) edf = 2*power**2/spread
   end function total_degrees_of_freedom

   !> A record of the same length in averaging times.
   pure function coarse_record(samples, m, model) result(c)
      !> Rate samples in the record, and averaging factor
      integer(int64), intent(in) :: samples, m
      !> The mixture
      type(noise_model_type), intent(in) :: model
      type(coarse_type) :: c

      integer :: i

      c%m = int(min(m, int(steps_max, int64)))
      c%step = real(m, dp)/c%m
      c%n = max(2_int64*c%m, nint(real(samples, dp)/c%step, int64))
      c%quantisation = model%squares(term_quantisation)
      c%ramp = model%squares(term_ramp)*c%step**4
      c%middle = real(samples - 2*m + 1, dp)/real(c%n - 2*c%m + 1, dp)
      if (m > 1) c%edge = real(m - 1, dp)/real(c%m - 1, dp)
      do i = 0, ubound(c%s, 1)
         c%s(i) = phase_covariance(model, i*c%step)
      end do
   end function coarse_record

   !> Sums over the terms that do not see the ends.
   pure subroutine add_middle(c, power, spread)
      !> The record
      type(coarse_type), intent(in) :: c
      !> Sum of R_kk + mu_k^2
      real(dp), intent(out) :: power
      !> Sum of 2 R_kl^2 + 4 mu_k mu_l R_kl
      real(dp), intent(out) :: spread

      type(term_type) :: first
      real(dp) :: terms, r, spike
      integer :: lag

      terms = real(c%n - 2*c%m + 1, dp)
      first = term_at(c, c%m)
      call covariance(c, first, first, r, spike)
      power = terms*(r + c%middle/c%step*spike + c%ramp*first%mean**2)
      spread = 0
      do lag = 0, int(min(c%n - 2*c%m, int(reach, int64)))
         call covariance(c, first, term_at(c, c%m + lag), r, spike)
         spread = spread + merge(1, 2, lag == 0)*(terms - lag)*summand(r, spike, c%middle/c%step**2, &
            & c%ramp*first%mean**2)
      end do
   end subroutine add_middle

   !> Adds what a term at the beginning and its mirror image at the end of the record contribute.
   pure subroutine add_row(c, k, power, spread)
      !> The record
      type(coarse_type), intent(in) :: c
      !> Centre of the term, 1 .. m - 1
      integer, intent(in) :: k
      !> Sums to add to
      real(dp), intent(inout) :: power, spread

      type(term_type) :: here, there
      real(dp) :: r, spike
      integer :: l

      here = term_at(c, k)
      call covariance(c, here, here, r, spike)
      power = power + 2*(r + c%edge/c%step*spike + c%ramp*here%mean**2)
      do l = 1, int(min(c%n - 1, int(reach, int64)))
         there = term_at(c, l)
         call covariance(c, here, there, r, spike)
         ! the middle has the pair in two of its rows, the two ends each in their own
         spread = spread + merge(4, 2, l >= c%m .and. l <= c%n - c%m)*summand(r, spike, c%edge/c%step**2, &
            & c%ramp*here%mean*there%mean)
      end do
   end subroutine add_row

   !> A term of the total variance.
   pure function term_at(c, k) result(term)
      !> The record
      type(coarse_type), intent(in) :: c
      !> Its centre, 1 .. n - 1
      integer, intent(in) :: k
      type(term_type) :: term

      !> So that sums of two places fit into an integer
      integer(int64), parameter :: longest = 2_int64**30 - 1
      integer :: j, n

      n = int(min(c%n, longest))
      term%mean = real(c%m, dp)**2
      if (k >= c%m .and. k <= n - c%m) then
         term%place(:3) = [k - c%m, k, k + c%m]
         return
      end if
      j = min(k, n - k)
      term%points = 4
      term%place = [j + c%m, j, 0, c%m - j]
      term%weight = [1.0_dp, -2.0_dp, 2.0_dp, -1.0_dp]
      term%mean = real(2*j*c%m - j**2, dp)
      if (k < c%m) return
      term%place = n - term%place
   end function term_at

   !> Covariance of two terms: the smooth part, and that of quantisation noise.
   pure subroutine covariance(c, a, b, smooth, spike)
      !> The record
      type(coarse_type), intent(in) :: c
      !> The terms
      type(term_type), intent(in) :: a, b
      !> The parts
      real(dp), intent(out) :: smooth, spike

      integer :: i, j
      real(dp) :: product

      smooth = 0
      spike = 0
      do j = 1, b%points
         do i = 1, a%points
            product = a%weight(i)*b%weight(j)
            smooth = smooth + product*c%s(abs(a%place(i) - b%place(j)))
            if (a%place(i) /= b%place(j)) cycle
            if (i == 3 .and. j == 3 .and. min(a%points, b%points) == 4) then
               smooth = smooth + product*c%quantisation*c%edge/c%step   ! the end of the record, which all terms near it share
            else
               spike = spike + product*c%quantisation
            end if
         end do
      end do
   end subroutine covariance

   !> 2 R^2 + 4 mu_k mu_l R.
   pure real(dp) function summand(smooth, spike, share, means)
      !> The parts of R
      real(dp), intent(in) :: smooth, spike
      !> Share of the pairs of terms in which the phases of the spike meet
      real(dp), intent(in) :: share
      !> mu_k mu_l
      real(dp), intent(in) :: means

      summand = 2*smooth**2 + 4*means*smooth + share*spike*(2*spike + 4*smooth + 4*means)
   end function summand

end module gyroakf_allan_total_edf
