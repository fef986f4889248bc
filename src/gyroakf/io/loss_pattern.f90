! SPDX-License-Identifier: MIT
!> The pattern of losses among regular stamps: lost samples, or the beat with a coarse clock.
module gyroakf_io_loss_pattern
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_io_losses, only : find_losses, gap_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: explain_losses

   !> Losses at even distances of so many samples or more are the beat of a clock that counts in
   !> nearly the interval, unless all distances are equal and only the rate with losses is round
   integer(int64), parameter :: longest_period = 50

   !> What losses look like. Scattered, or none: samples were lost. Periodic, mostly single samples
   !> at exactly even distances: every k-th was lost, or the clock counts in the interval. Beating,
   !> at nearly even distances: the samples and a clock that counts in more than half of the
   !> interval. A comb has such beats, and losses among them
   integer, parameter :: scattered = 0, periodic = 1, beating = 2, comb = 3

contains

   !> Decides whether losses at even distances are losses or the beat of the samples with a coarse
   !> clock: those at exactly even distances below 50 samples are losses, others are not, unless the
   !> given rate is nearer to that of the other explanation.
   subroutine explain_losses(t, cadence, given, gaps, audit)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> Of the stamps
      type(cadence_type), intent(in) :: cadence
      !> Sample rate that was given, Hz, 0 for none
      real(dp), intent(in) :: given
      !> Losses of single samples; fewer where they are none
      type(gap_type), intent(inout) :: gaps
      !> Its beats and the other rate are set
      type(audit_type), intent(inout) :: audit
      real(dp) :: grid_rate, beat_rate
      integer(int64) :: distance
      integer :: found
      logical :: beat

      call loss_pattern(gaps, cadence, size(t, kind=int64), found, distance)
      if (found == scattered) return
      grid_rate = 1.0_dp/cadence%step
      if (found == comb) then
         call find_losses(t, cadence, .false., gaps)
         return
      end if
      beat = found == beating
      beat_rate = grid_rate*real(distance, dp)/real(distance + 1, dp)
      if (beat) beat_rate = real(size(t) - 1, dp)/(t(size(t)) - t(1))
      if (given > 0.0_dp) beat = abs(given - beat_rate) < abs(given - grid_rate)
      if (given <= 0.0_dp) audit%other_rate = merge(grid_rate, beat_rate, beat)
      if (.not. beat) return
      audit%beats = audit%beats + gaps%count
      gaps%count = 0
   end subroutine explain_losses

   !> What the losses look like; lost samples where no beat is possible, with a fine clock.
   pure subroutine loss_pattern(gaps, cadence, n, found, distance)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      integer(int64), intent(in) :: n
      integer, intent(out) :: found
      !> Samples from loss to loss where most are alike, 0 where none are
      integer(int64), intent(out) :: distance
      !> A clock that runs so much fast or slow explains up to three double steps, several at even
      !> distances from each other and no farther from the ends
      real(dp), parameter :: usual_drift = 3.0e-4_dp
      integer(int64) :: between(max(gaps%count - 1, 0))
      real(dp) :: usual
      integer :: k, m, equal, beside, alike

      found = scattered
      distance = 0
      m = gaps%count - 1
      if (m < 0 .or. cadence%resolution < 0.5_dp*cadence%step) return
      between(:) = gaps%before(2:gaps%count) - gaps%before(:m)
      if (m < 3) then
         if (any(gaps%length(:gaps%count) > 1)) return
         if (m > 0) distance = maxval(between)
         if (m > 0 .and. (10*minval(between) < 9*distance .or. 10*max(gaps%before(1), &
                          n - gaps%before(gaps%count)) > 11*distance)) return
         if (m > 0) found = periodic
         if (real(gaps%count, dp) < usual_drift*real(n, dp)) found = beating
         return
      end if
      equal = 0
      do k = 1, min(m, 12)
         alike = count(between == between(k))
         if (alike <= equal) cycle
         equal = alike
         distance = between(k)
      end do
      beside = count(abs(between - distance) == 1)
      usual = real(gaps%before(gaps%count) - gaps%before(1), dp)/real(m, dp)
      alike = count(abs(real(between, dp) - usual) <= max(1.0_dp, 0.1_dp*usual))
      if (2*count(gaps%length(:gaps%count) == 1) < gaps%count) return
      if (2*equal >= m .and. 2*beside <= m - equal .and. distance < longest_period) then
         found = periodic
      else if (equal == m .and. m >= 20 .and. is_round(1.0_dp/cadence%step) .and. &
               .not. is_round(real(distance, dp)/(real(distance + 1, dp)*cadence%step))) then
         found = periodic
      else if (10*alike >= 9*m .and. all(gaps%length(:gaps%count) == 1)) then
         found = beating
      else if (m >= 8 .and. 2*count(abs(between - distance) <= max(2_int64, &
         distance/10)) >= m .and. distance >= longest_period) then
         found = comb
      end if
   end subroutine loss_pattern

   !> True for a rate of three digits.
   pure logical function is_round(rate)
      real(dp), intent(in) :: rate
      real(dp) :: digits

      digits = rate*10.0_dp**(2 - floor(log10(rate)))
      is_round = abs(digits - anint(digits)) <= 1.0e-5_dp*digits
   end function is_round

end module gyroakf_io_loss_pattern
