! SPDX-License-Identifier: MIT
!> How near an estimate of the drift comes to the true drift, which simulations and reference sensors know.
!>
!> With the error e = estimate - truth of the samples that count, and windows of m samples, m the integer nearest T/t0, side by side
!> from the first sample on (they do not overlap; a rest shorter than a window is left out; no windows where m is 0):
!> $$ \mathrm{bias} = \bar e, \quad \mathrm{RMSE} = \sqrt{\overline{e^2}}, \quad
!>    \theta_w = t_0 \sum_{k \in w} e_k, \quad
!>    \vartheta_w = t_0 \sum_{j=1}^{m} (\phi^j \hat x_w - b_{w,j}), \quad \mathrm{attitude} = \sqrt{\overline{\theta_w^2}} $$
!> Two errors of the angle after the time T follow. Compensated: the rate is corrected by the estimate as it runs; the angle gains
!> theta_w. Predicted: nothing is measured any more once the window begins (the vehicle turns), the last estimate before it is
!> carried on by the model, x phi^j (held, where phi = 1), against the true drift b; the angle gains vartheta_w. A window counts
!> where at least nine tenths of its samples do; its sum is then that of those, over their share.
module gyroakf_filter_score
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_measurement, only : is_sample
   implicit none (type, external)
   private
   public :: score_type, score_estimate, score_times

   !> Times after which the error of the angle is told, s
   real(dp), parameter :: score_times(3) = [10.0_dp, 60.0_dp, 300.0_dp]
   !> Share of a window's samples that must count
   real(dp), parameter :: least_share = 0.9_dp
   !> Share of an estimate below which nothing of it is carried on: no subnormal numbers in long windows
   real(dp), parameter :: vanished = 1.0e-30_dp

   !> The score of an estimate, in the unit u of the series and seconds
   type :: score_type
      !> Samples that count
      integer(int64) :: samples = 0
      !> Root of the mean square, mean of the error, u
      real(dp) :: rmse = 0.0_dp, bias = 0.0_dp
      !> The times, s
      real(dp) :: attitude_seconds(3) = score_times
      !> Root mean square error of the angle after them, compensated as the estimate runs, u s; 0 without a window
      real(dp) :: attitude_error(3) = 0.0_dp
      !> Windows that count
      integer(int64) :: attitude_windows(3) = 0
      !> The same where the last estimate before the window is carried on, u s
      real(dp) :: predicted_error(3) = 0.0_dp
      !> Windows that count: one less, none begins the series
      integer(int64) :: predicted_windows(3) = 0
   end type score_type

contains

   !> Scores an estimate against the truth.
   subroutine score_estimate(estimate, truth, sample_interval, score, error, valid, decay)
      !> Estimate of the drift: [n], n >= 1
      real(dp), intent(in), contiguous :: estimate(:)
      !> The true drift, same unit: [n]; NaN in either counts as missing
      real(dp), intent(in), contiguous :: truth(:)
      !> t0 in s, > 0
      real(dp), intent(in) :: sample_interval
      !> The score
      type(score_type), intent(out) :: score
      !> invalid_argument (lengths, interval, decay), too_few_samples (no sample counts)
      type(error_type), allocatable, intent(out) :: error
      !> 1 where a sample counts, 0 where it does not: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> phi by which an estimate is carried on from sample to sample, 0 .. 1; 1 (held) if absent
      real(dp), intent(in), optional :: decay
      integer(int64) :: n, k
      integer :: i
      real(dp) :: phi, total, squares, e
      logical :: same

      n = size(truth, kind=int64)
      same = size(estimate, kind=int64) == n
      if (present(valid)) same = same .and. size(valid, kind=int64) == n
      phi = 1.0_dp
      if (present(decay)) phi = decay
      call check(same, sample_interval, phi, error)
      if (allocated(error)) return
      total = 0.0_dp
      squares = 0.0_dp
      do k = 1, n
         if (.not. counts(estimate, truth, k, valid)) cycle
         e = estimate(k) - truth(k)
         score%samples = score%samples + 1
         total = total + e
         squares = squares + e*e
      end do
      if (score%samples == 0) then
         call fatal_error(error, status%too_few_samples, "an estimate is scored where its truth is known, and no sample is")
         return
      end if
      score%bias = total/real(score%samples, dp)
      score%rmse = sqrt(squares/real(score%samples, dp))
      do i = 1, size(score_times)
         call score_windows(estimate, truth, sample_interval, phi, i, score, valid)
      end do
   end subroutine score_estimate

   !> Refuses what cannot be scored.
   subroutine check(same, sample_interval, phi, error)
      !> The series have one length
      logical, intent(in) :: same
      real(dp), intent(in) :: sample_interval, phi
      type(error_type), allocatable, intent(out) :: error
      logical :: good

      if (.not. same) then
         call fatal_error(error, status%invalid_argument, "an estimate, its truth and the mask must have one length")
         return
      end if
      good = is_sample(sample_interval) .and. is_sample(phi)
      if (good) good = sample_interval > 0.0_dp .and. phi >= 0.0_dp .and. phi <= 1.0_dp
      if (.not. good) call fatal_error(error, status%invalid_argument, &
                                       "a score needs a sample interval > 0 and a decay of 0 .. 1")
   end subroutine check

   !> Whether a sample counts.
   pure logical function counts(estimate, truth, k, valid)
      real(dp), intent(in), contiguous :: estimate(:), truth(:)
      integer(int64), intent(in) :: k
      integer(int8), intent(in), optional :: valid(:)

      counts = is_sample(estimate(k)) .and. is_sample(truth(k))
      if (present(valid)) counts = counts .and. valid(k) /= 0_int8
   end function counts

   !> The errors of the angle after one of the times.
   pure subroutine score_windows(estimate, truth, t0, phi, i, score, valid)
      real(dp), intent(in), contiguous :: estimate(:), truth(:)
      real(dp), intent(in) :: t0, phi
      !> Number of the time
      integer, intent(in) :: i
      !> Its errors and windows are set
      type(score_type), intent(inout) :: score
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n, m, from, k, known
      real(dp) :: left, drift, carried, ahead, weight, least, running, predicted

      n = size(truth, kind=int64)
      if (score_times(i) > real(n, dp)*t0) return              ! no window; the count of its samples may not even fit
      m = nint(score_times(i)/t0, int64)
      if (m < 1) return
      least = least_share*real(m, dp)
      running = 0.0_dp
      predicted = 0.0_dp
      do from = 1, n - m + 1, m
         known = 0
         left = 0.0_dp
         drift = 0.0_dp
         ahead = 0.0_dp
         weight = 1.0_dp
         do k = from, from + m - 1
            weight = weight*phi
            if (weight < vanished) weight = 0.0_dp
            if (.not. counts(estimate, truth, k, valid)) cycle
            known = known + 1
            left = left + (estimate(k) - truth(k))
            drift = drift + truth(k)
            ahead = ahead + weight
         end do
         if (known == 0 .or. real(known, dp) < least) cycle
         score%attitude_windows(i) = score%attitude_windows(i) + 1
         running = running + (left*(t0*real(m, dp)/real(known, dp)))**2
         if (from == 1) cycle
         if (.not. counts(estimate, truth, from - 1, valid)) cycle
         carried = estimate(from - 1)*ahead - drift
         score%predicted_windows(i) = score%predicted_windows(i) + 1
         predicted = predicted + (carried*(t0*real(m, dp)/real(known, dp)))**2
      end do
      if (score%attitude_windows(i) > 0) score%attitude_error(i) = sqrt(running/real(score%attitude_windows(i), dp))
      if (score%predicted_windows(i) > 0) score%predicted_error(i) = sqrt(predicted/real(score%predicted_windows(i), dp))
   end subroutine score_windows

end module gyroakf_filter_score
