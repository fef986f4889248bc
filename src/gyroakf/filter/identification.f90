! SPDX-License-Identifier: MIT
!> Drift plus white noise, identified from the autocovariances of a record: a starting point of the maximum likelihood search.
!>
!> The model: z_k = b_k + v_k, b_k = phi b_{k-1} + w_k, so that r_0 = D + R and r_k = D phi^k. White noise, and
!> any noise that is fast beside the drift, only enters r_0: D and phi come from the lags >= 1, R is what is left.
!> Slow drifts are sought in block means of 4, 16, 64, ... samples, whose autocovariances are, for l >= 1,
!> $$ D\,\phi^{m l} \left(\frac{1 - \phi^m}{m (1 - \phi)}\right)^2 \phi^{-(m - 1)} $$
module gyroakf_filter_identification
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_filter_exponential_fit, only : exponential_type, fit_exponential
   implicit none (type, external)
   private
   public :: drift_model_type, identify_drift, block_means

   !> Lags fitted
   integer, parameter :: most_lags = 96
   !> Fewest samples, and fewest block means
   integer(int64), parameter :: fewest_samples = 50, fewest_blocks = 400
   !> Samples used of a huge record
   integer(int64), parameter :: most_samples = 4194304
   !> Samples of a block mean: a power of it
   integer(int64), parameter :: widening = 4
   !> Decrease of chi-square that speaks for a drift (five standard deviations)
   real(dp), parameter :: evident = 25.0_dp
   !> Correlation times, in blocks, that block means resolve
   real(dp), parameter :: shortest_in_blocks = 2.0_dp
   !> A drift slower than so many samples by default
   real(dp), parameter :: usual_minimum = 5.0_dp

   !> AR(1) drift plus white noise
   type :: drift_model_type
      !> Coefficient, per sample
      real(dp) :: phi = 0
      !> Variance of the drift's driving noise
      real(dp) :: process_variance = 0
      !> Variance D of the drift
      real(dp) :: drift_variance = 0
      !> Variance R of the white noise
      real(dp) :: measurement_variance = 0
      !> Correlation time in samples, -1/ln(phi)
      real(dp) :: correlation_samples = 0
      !> False if there is no drift of that kind in the series (white, or faster than the limit); the numbers then
      !> are those of the fastest component, as far as there is one
      logical :: found = .false.
      !> Samples that were used: all, or the middle part of a huge record
      integer(int64) :: samples = 0
   end type drift_model_type

contains

   !> Identifies drift AR(1) + white by least squares on the autocovariances.
   subroutine identify_drift(x, model, error, valid, minimum_samples)
      !> Series, [n], n >= 50; of more than 4,194,304 samples the middle ones are used
      real(dp), intent(in), contiguous :: x(:)
      !> What was found
      type(drift_model_type), intent(out) :: model
      !> too_few_samples, constant_input, no_memory; those of compute_autocovariance
      type(error_type), allocatable, intent(out) :: error
      !> 1 where a sample is present, 0 where it is missing, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Correlation time in samples from which a component counts as drift, > 0; 5 if absent
      real(dp), intent(in), optional :: minimum_samples
      type(drift_model_type) :: candidate
      real(dp) :: r0, limit
      integer(int64) :: first, m, n
      logical :: enough

      limit = usual_minimum
      if (present(minimum_samples)) limit = minimum_samples
      n = min(size(x, kind=int64), most_samples)
      first = (size(x, kind=int64) - n)/2
      if (n < fewest_samples) then
         call fatal_error(error, status%too_few_samples, "the identification of a drift needs at least 50 samples")
         return
      end if
      r0 = 0.0_dp
      m = 1
      do
         if (present(valid)) then
            call identify_at_width(x(first + 1:first + n), m, r0, candidate, enough, error, valid(first + 1:first + n))
         else
            call identify_at_width(x(first + 1:first + n), m, r0, candidate, enough, error)
         end if
         if (allocated(error)) return
         candidate%found = enough .and. candidate%correlation_samples >= limit
         if (m == 1 .or. candidate%found) model = candidate
         if (model%found .and. model%correlation_samples <= 0.5_dp*real(most_lags*m, dp)) return
         if (n/(widening*m) < fewest_blocks) return
         m = widening*m
      end do
   end subroutine identify_drift

   !> The model that the means of m samples show.
   subroutine identify_at_width(x, m, r0, model, enough, error, valid)
      !> Series, [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Samples a mean
      integer(int64), intent(in) :: m
      !> Variance of the series, set where m is 1
      real(dp), intent(inout) :: r0
      !> The model
      type(drift_model_type), intent(out) :: model
      !> Whether there is evidence for a drift at this width
      logical, intent(out) :: enough
      !> constant_input, no_memory; those of compute_autocovariance
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing, [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: means(:), r(:)
      integer(int8), allocatable :: present_means(:)

      enough = .false.
      if (present(valid)) then
         call block_means(x, m, means, present_means, error, valid)
      else
         call block_means(x, m, means, present_means, error)
      end if
      if (allocated(error)) return
      call autocovariances(means, present_means, r, error)
      if (allocated(error)) return
      if (m == 1) r0 = r(0)
      if (r0 > 0.0_dp) then
         call fit_blocks(r, size(means, kind=int64), m, r0, model, enough)
         model%samples = size(x, kind=int64)
      else
         call fatal_error(error, status%constant_input, "a series without variance has no drift")
      end if
   end subroutine identify_at_width

   !> Means of m successive samples; missing where more than half of them are.
   subroutine block_means(x, m, means, present_means, error, valid)
      !> Series, [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Samples a block
      integer(int64), intent(in) :: m
      !> [n/m]
      real(dp), allocatable, intent(out) :: means(:)
      !> [n/m], allocated only where one is missing
      integer(int8), allocatable, intent(out) :: present_means(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing, [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: count, i, k, n
      real(dp) :: total
      integer :: stat

      n = size(x, kind=int64)/m
      allocate (means(n), stat=stat)
      if (stat == 0 .and. present(valid)) allocate (present_means(n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the block means of a series")
         return
      end if
      do i = 1, n
         total = 0.0_dp
         count = m
         if (present(valid)) then
            count = 0
            do k = (i - 1)*m + 1, i*m
               if (valid(k) == 0_int8) cycle
               total = total + x(k)
               count = count + 1
            end do
            present_means(i) = merge(1_int8, 0_int8, 2*count >= m)
         else
            do k = (i - 1)*m + 1, i*m
               total = total + x(k)
            end do
         end if
         means(i) = 0.0_dp
         if (2*count >= m) means(i) = total/real(count, dp)
      end do
      if (.not. allocated(present_means)) return
      if (all(present_means /= 0_int8)) deallocate (present_means)
   end subroutine block_means

   !> Autocovariances up to 96 lags, a quarter of the series at most.
   subroutine autocovariances(x, here, r, error)
      !> Series, [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Its presence, or not allocated
      integer(int8), allocatable, intent(in) :: here(:)
      !> [0:L]
      real(dp), allocatable, intent(out) :: r(:)
      !> As compute_autocovariance
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: mean
      integer :: lags

      lags = int(min(int(most_lags, int64), size(x, kind=int64)/4))
      if (allocated(here)) then
         call compute_autocovariance(x, lags, mean, r, error, here)
      else
         call compute_autocovariance(x, lags, mean, r, error)
      end if
   end subroutine autocovariances

   !> The model of the samples from the autocovariances of the block means.
   subroutine fit_blocks(r, blocks, m, r0, model, enough)
      !> Autocovariances of the means, [0:L]
      real(dp), intent(in) :: r(0:)
      !> Number of means, and samples in each
      integer(int64), intent(in) :: blocks, m
      !> Variance of the series
      real(dp), intent(in) :: r0
      !> The model, `found` not set
      type(drift_model_type), intent(out) :: model
      !> Whether there is evidence for it at this width
      logical, intent(out) :: enough
      type(exponential_type) :: fit
      real(dp) :: time, share, width

      model%measurement_variance = r0
      enough = .false.
      if (.not. r(0) > 0.0_dp) return
      call fit_exponential(r, real(blocks, dp), fit)
      enough = fit%evidence > evident .and. fit%amplitude > 0.0_dp
      if (.not. enough) return
      width = real(m, dp)
      time = -1.0_dp/log(fit%ratio)
      if (m > 1 .and. time < shortest_in_blocks) enough = .false.
      time = time*width
      ! (1 - phi^m)/(m (1 - phi)) phi^(-(m-1)/2) = sinh(m/2t)/(m sinh(1/2t))
      share = (sinh(0.5_dp*width/time)/(width*sinh(0.5_dp/time)))**2
      model%correlation_samples = time
      model%phi = exp(-1.0_dp/time)
      model%drift_variance = min(fit%amplitude/share, r0)
      model%measurement_variance = r0 - model%drift_variance
      model%process_variance = model%drift_variance*(1.0_dp - model%phi)*(1.0_dp + model%phi)
   end subroutine fit_blocks
end module gyroakf_filter_identification
