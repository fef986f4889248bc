! SPDX-License-Identifier: MIT
!> Losses among regular stamps: a long step behind which the lag, elapsed time * rate - count, stays higher.
module gyroakf_io_regular_losses
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type, sort
   use gyroakf_io_losses, only : add_gap, gap_type
   implicit none (type, external)
   private
   public :: find_gaps, is_beat, is_comb

   !> Window of the lags, samples; after a long step it is longer, up to most_window
   integer(int64), parameter :: window = 64, most_window = 20000

contains

   !> Finds where samples of regular stamps were lost: a long step behind which the lag stays higher.
   !>
   !> A loss is no longer than the step of the stamps there, and than the rise of the lag.
   subroutine find_gaps(t, interval, gaps)
      real(dp), intent(in), contiguous :: t(:)
      !> s from sample to sample
      real(dp), intent(in) :: interval
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: i, n, since, after
      real(dp) :: rise, rate, step
      real(dp), parameter :: enough = 0.75_dp

      n = size(t, kind=int64)
      rate = 1.0_dp/interval
      since = 1
      do i = 2, n
         step = (t(i) - t(i - 1))*rate
         if (step < 2.0_dp*enough) cycle
         rise = step - 1.0_dp
         if (rise < enough .or. .not. even_around(t, i, max(i - window, since), min(i + window, n), interval)) then
            after = min(i - 1 + max(window, int(min(4.0_dp*step, real(most_window, dp)), int64)), n)
            rise = middle_lag(t, rate, i, after) - middle_lag(t, rate, max(i - window, since), i - 1)
         end if
         if (rise < enough) cycle
         if (falls_back(t, rate, i, rise)) cycle
         since = i
         call add_gap(gaps, i, max(1_int64, min(whole(rise), whole(step) - 1)))
      end do
   end subroutine find_gaps

   !> The nearest whole number, as far as there is one.
   pure integer(int64) function whole(x)
      real(dp), intent(in) :: x

      whole = nint(min(x, 1.0e15_dp), int64)
   end function whole

   !> True where all steps but that before sample i are near the interval.
   pure logical function even_around(t, i, first, last, interval)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: i, first, last
      real(dp), intent(in) :: interval
      integer(int64) :: k

      even_around = .false.
      do k = first + 1, last
         if (k /= i .and. abs(t(k) - t(k - 1) - interval) > 0.3_dp*interval) return
      end do
      even_around = abs(t(last) - t(i) - real(last - i, dp)*interval) <= 0.3_dp*interval .and. &
                    abs(t(i - 1) - t(first) - real(i - 1 - first, dp)*interval) <= 0.3_dp*interval
   end function even_around

   !> True where the lag has lost half of a rise again after 512, 1024 or 2048 samples.
   pure logical function falls_back(t, rate, i, rise)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: rate, rise
      integer(int64), intent(in) :: i
      integer(int64) :: ahead
      integer :: k

      falls_back = .false.
      ahead = 512
      do k = 1, 3
         if (i + ahead > size(t, kind=int64)) return
         if ((t(i + ahead) - t(i - 1))*rate - real(ahead + 1, dp) < 0.5_dp*rise - 0.25_dp) falls_back = .true.
         ahead = 2*ahead
      end do
   end function falls_back

   !> True where the double steps of single samples are the beat of the samples with a clock that counts in more than half of
   !> their interval, or cannot be told from it: at even distances, or so few (0.03 %) that a clock explains them.
   pure logical function is_beat(gaps, cadence, n)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      integer(int64), intent(in) :: n
      real(dp), parameter :: usual_drift = 3.0e-4_dp
      integer(int64) :: distance
      integer :: k, alike

      is_beat = .false.
      if (gaps%count == 0 .or. cadence%resolution < 0.5_dp*cadence%step) return
      if (any(gaps%length(:gaps%count) > 1)) return
      if (gaps%count < 4) then
         is_beat = real(gaps%count, dp) < usual_drift*real(n, dp)
         return
      end if
      distance = (gaps%before(gaps%count) - gaps%before(1))/(gaps%count - 1)
      alike = 0
      do k = 2, gaps%count
         if (abs(gaps%before(k) - gaps%before(k - 1) - distance) <= max(2_int64, distance/10)) alike = alike + 1
      end do
      is_beat = 10*alike >= 9*(gaps%count - 1)
   end function is_beat

   !> True where half of the double steps are at even distances: beats of a coarse clock and losses among them.
   pure logical function is_comb(gaps, cadence)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      integer(int64) :: distance
      integer :: k, j, alike, most

      is_comb = .false.
      if (count(gaps%length(:gaps%count) == 1) < 8 .or. cadence%resolution < 0.5_dp*cadence%step) return
      most = 0
      do j = 2, min(gaps%count, 12)
         distance = gaps%before(j) - gaps%before(j - 1)
         if (distance < 50) cycle
         alike = 0
         do k = 2, gaps%count
            if (gaps%length(k) /= 1) cycle
            if (abs(gaps%before(k) - gaps%before(k - 1) - distance) <= max(2_int64, distance/10)) alike = alike + 1
         end do
         most = max(most, alike)
      end do
      is_comb = 2*most >= gaps%count - 1
   end function is_comb

   !> Median of the lag t*rate - index over a range (every k-th of a long one).
   real(dp) function middle_lag(t, rate, from, to)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: rate
      integer(int64), intent(in) :: from, to
      real(dp) :: lag(2*window)
      integer(int64) :: i, stride
      integer :: k

      stride = 1 + (to - from)/size(lag)
      k = 0
      do i = from, to, stride
         k = k + 1
         lag(k) = (t(i) - t(1))*rate - real(i, dp)
      end do
      call sort(lag(:k))
      middle_lag = lag((k + 1)/2)
   end function middle_lag

end module gyroakf_io_regular_losses
