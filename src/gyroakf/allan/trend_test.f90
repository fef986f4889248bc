! SPDX-License-Identifier: MIT
!> A ramp or a warm-up under noise.
!>
!> The record is averaged in 128 blocks. The differences z of successive means are noise of
!> covariance C, a mixture of N, B and K, plus the trend. With the likelihood of normal noise,
!>
!> $$ -2 \ln L =
!>    n \ln \left( z' C^{-1} z - \frac{(s' C^{-1} z)^2}{s' C^{-1} s} \right) + \ln |C|, $$
!>
!> s the differences of the trend's block means, the gain of a trend is the rise of 2 ln L over
!> noise alone; the mixture is free on both sides, so that a trend has to describe the record better
!> than a random walk does. z is stationary: C is a Toeplitz matrix, and the recursion of Levinson
!> and Durbin gives its inverse and determinant. Tried are a straight line and exp(-t/T) with 19 T
!> from two blocks to the record.
module gyroakf_allan_trend_test
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_allan_fit_covariance, only : lag_covariances
   implicit none (type, external)
   private
   public :: trend_test_options, record_trend_type, block_count, block_means, find_trend, &
      & trend_means, trend_values

   !> Thresholds
   type :: trend_test_options
      !> Gain from which on a ramp is a ramp, and a warm-up is a warm-up, which also has to gain so
      !> much more than a ramp: without a trend a ramp gains less in 99 % of records of white and
      !> flicker noise (10 under a faint random walk)
      real(dp) :: ramp_gain = 6.0_dp, warm_up_gain = 12.0_dp, curved_margin = 6.0_dp
   end type trend_test_options

   !> A trend, in the unit of the record and samples
   type :: record_trend_type
      !> "ramp", "warm-up", or "" where there is none
      character(7) :: shape = ""
      !> Rise of 2 ln L by the trend that gains most, also where it is not enough
      real(dp) :: gain = 0.0_dp
      !> Change over the record of a ramp, or difference to the end value at the first sample of a
      !> warm-up; its standard error; time constant of a warm-up
      real(dp) :: size = 0.0_dp, std_error = 0.0_dp, time_constant = 0.0_dp
   end type record_trend_type

   !> Blocks of a record, their differences, time constants tried, weights of B and K beside N in a
   !> mixture: 0 and 2^-7 to 2^7
   integer, parameter :: block_count = 128, differences = block_count - 1, scale_count = 19, &
      & weight_count = 16
   !> Mixtures with white noise, of B and K without it, and K alone; time constants about the best
   !> one, and half their range in ln T
   integer, parameter :: mixture_count = weight_count**2 + weight_count + 1, fine_count = 21
   real(dp), parameter :: fine_range = 0.25_dp

contains

   !> Means of the 128 blocks of a record, in a straight line over blocks without a sample.
   pure subroutine block_means(x, mean, enough, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> [128]
      real(dp), intent(out) :: mean(block_count)
      !> Every block has four samples' length, and more than half of them a sample
      logical, intent(out) :: enough
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: length, first, last
      integer :: i, before, behind
      logical :: known(block_count)

      length = size(x, kind=int64)/block_count
      mean(:) = 0
      enough = length >= 4
      if (.not. enough) return
      known(:) = .true.
      do i = 1, block_count
         first = (i - 1)*length + 1
         last = i*length
         if (present(valid)) then
            known(i) = any(valid(first:last) == 1)
            if (known(i)) mean(i) = sum(x(first:last), mask=valid(first:last) == 1) &
               & /count(valid(first:last) == 1, kind=int64)
         else
            mean(i) = sum(x(first:last))/real(length, dp)
         end if
      end do
      enough = 2*count(known) > block_count
      if (.not. enough) return
      do i = 1, block_count
         if (known(i)) cycle
         before = findloc(known(:i), .true., dim=1, back=.true.)
         behind = i - 1 + findloc(known(i:), .true., dim=1)
         if (before == 0) before = behind
         if (behind == i - 1) behind = before
         mean(i) = mean(before) + (mean(behind) - mean(before)) &
            & *real(i - before, dp)/real(max(1, behind - before), dp)
      end do
   end subroutine block_means

   !> Finds a trend in the means of the blocks.
   subroutine find_trend(mean, samples, options, trend, error)
      !> Of [[block_means]]
      real(dp), intent(in) :: mean(block_count)
      !> Length of the record
      integer(int64), intent(in) :: samples
      type(trend_test_options), intent(in) :: options
      !> The trend, if one gains enough; none where all means are equal
      type(record_trend_type), intent(out) :: trend
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: series(:, :), cost(:, :)
      !> Autocovariances of the differences of block means of N, B and K, over their variances
      real(dp) :: term(0:differences - 1, 3), gain(scale_count + 1)
      integer :: k, shape, mixture, stat, failed(mixture_count)

      allocate (series(0:scale_count + 1, differences), stat=stat)
      if (stat == 0) allocate (cost(0:scale_count + 1, mixture_count), stat=stat)
      call check_memory(stat, "the search for a trend", error)
      if (allocated(error)) return
      series(0, :) = steps_of(mean)
      if (maxval(abs(series(0, :))) <= 0.0_dp) return
      series(0, :) = series(0, :)/maxval(abs(series(0, :)))
      series(1, :) = 1
      do k = 1, scale_count
         series(k + 1, :) = exp(-[(real(shape, dp), shape=0, differences - 1)]/scale_of(k))
      end do
      term = lag_covariances(1.0_dp, 1.0_dp, [(real(k, dp), k=0, differences - 1)])
      term = term/spread(term(0, :), 1, differences)
      !$omp parallel do schedule(static)
      do k = 1, mixture_count
         call find_costs(mixture_covariance(term, k), series, cost(:, k), failed(k))
      end do
      !$omp end parallel do
      call check_memory(maxval(abs(failed)), "the search for a trend", error)
      if (allocated(error)) return
      gain = minval(cost(0, :)) - minval(cost(1:, :), dim=2)
      shape = 1 + maxloc(gain(2:), dim=1)
      if (gain(1) > gain(shape) - options%curved_margin) shape = 1
      trend%gain = gain(shape)
      if (gain(shape) < merge(options%ramp_gain, options%warm_up_gain, shape == 1)) return
      mixture = minloc(cost(shape, :), dim=1)
      trend%shape = merge("ramp   ", "warm-up", shape == 1)
      call measure_trend(mean, samples, mixture_covariance(term, mixture), shape - 1, trend, error)
   end subroutine find_trend

   !> A time constant, in blocks.
   elemental real(dp) function scale_of(k)
      integer, intent(in) :: k

      scale_of = 2*(block_count/2.0_dp)**(real(k - 1, dp)/(scale_count - 1))
   end function scale_of

   !> Autocovariances of a mixture: of all three terms, of B and K, and of K alone.
   pure function mixture_covariance(term, mixture) result(covariance)
      real(dp), intent(in) :: term(0:, :)
      integer, intent(in) :: mixture
      real(dp) :: covariance(0:differences - 1), weight(0:weight_count - 1)
      integer :: i

      weight = [0.0_dp, (2.0_dp**i, i=-7, 7)]
      if (mixture <= weight_count**2) then
         covariance = term(:, 1) + weight((mixture - 1)/weight_count)*term(:, 2) + &
            & weight(modulo(mixture - 1, weight_count))*term(:, 3)
      else if (mixture < mixture_count) then
         covariance = term(:, 2) + weight(mixture - weight_count**2 - 1)*term(:, 3)
      else
         covariance = term(:, 3)
      end if
   end function mixture_covariance

   !> -2 ln L, but for a constant, of the first series without a trend and with the others as trend.
   pure subroutine find_costs(covariance, series, cost, stat)
      !> Autocovariances from lag 0 on; the series: [series, time]
      real(dp), intent(in) :: covariance(0:), series(0:, :)
      real(dp), intent(out) :: cost(0:)
      integer, intent(out) :: stat
      real(dp), allocatable :: white(:, :)
      real(dp) :: log_determinant, squares

      allocate (white(0:size(series, 1) - 1, size(series, 2)), stat=stat)
      if (stat /= 0) return
      call whiten(covariance, series, white, log_determinant)
      squares = sum(white(0, :)**2)
      cost = squares - matmul(white, white(0, :))**2/sum(white**2, dim=2)
      cost(0) = squares
      cost = size(series, 2)*log(max(cost, tiny(1.0_dp))) + log_determinant
   end subroutine find_costs

   !> Independent innovations of variance 1 of series that have the same autocovariances, by
   !> Levinson and Durbin.
   pure subroutine whiten(covariance, series, white, log_determinant)
      !> From lag 0 on; [series, time]
      real(dp), intent(in) :: covariance(0:), series(:, :)
      real(dp), intent(out) :: white(:, :), log_determinant
      real(dp) :: phi(size(series, 2)), variance, reflection
      integer :: t, j

      variance = covariance(0)
      log_determinant = log(variance)
      white(:, 1) = series(:, 1)/sqrt(variance)
      do t = 1, size(series, 2) - 1
         reflection = (covariance(t) - dot_product(phi(:t - 1), covariance(t - 1:1:-1)))/variance
         phi(:t - 1) = phi(:t - 1) - reflection*phi(t - 1:1:-1)
         phi(t) = reflection
         variance = variance*(1 - reflection**2)
         log_determinant = log_determinant + log(variance)
         white(:, t + 1) = series(:, t + 1)
         do j = 1, t
            white(:, t + 1) = white(:, t + 1) - phi(j)*series(:, t + 1 - j)
         end do
         white(:, t + 1) = white(:, t + 1)/sqrt(variance)
      end do
   end subroutine whiten

   !> Size, error and time constant by generalized least squares.
   subroutine measure_trend(mean, samples, covariance, scale, trend, error)
      real(dp), intent(in) :: mean(block_count)
      integer(int64), intent(in) :: samples
      real(dp), intent(in) :: covariance(0:)
      !> Number of the time constant that gained most; 0 of a ramp
      integer, intent(in) :: scale
      type(record_trend_type), intent(inout) :: trend
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: log_time(fine_count), cost(0:fine_count), bend
      real(dp), allocatable :: series(:, :)
      real(dp), dimension(3, differences) :: fitted, white
      !> Of ln T, for the derivative
      real(dp), parameter :: step = 1.0e-4_dp
      real(dp) :: gram(2, 2), variance, log_determinant
      integer :: i, best, stat

      if (scale > 0) then
         log_time = log(scale_of(scale)*real(samples/block_count, dp)) + &
            & fine_range*[(2.0_dp*(i - 1)/(fine_count - 1) - 1, i=1, fine_count)]
         allocate (series(0:fine_count, differences), stat=stat)
         call check_memory(stat, "the search for a trend", error)
         if (allocated(error)) return
         series(0, :) = steps_of(mean)
         do i = 1, fine_count
            series(i, :) = steps_of(unit_means(trend%shape, exp(log_time(i)), samples))
         end do
         call find_costs(covariance, series, cost, stat)
         call check_memory(stat, "the search for a trend", error)
         if (allocated(error)) return
         best = min(max(minloc(cost(1:), dim=1), 2), fine_count - 1)
         bend = cost(best - 1) - 2*cost(best) + cost(best + 1)
         trend%time_constant = log_time(best)
         if (bend > 0) trend%time_constant = trend%time_constant &
            & + 0.5_dp*(log_time(2) - log_time(1))*(cost(best - 1) - cost(best + 1))/bend
         trend%time_constant = exp(min(max(trend%time_constant, log_time(1)), log_time(fine_count)))
      end if
      fitted(1, :) = steps_of(mean)
      fitted(2, :) = steps_of(unit_means(trend%shape, trend%time_constant, samples))
      fitted(3, :) = (steps_of(unit_means(trend%shape, trend%time_constant*exp(step), samples)) &
         & - steps_of(unit_means(trend%shape, trend%time_constant*exp(-step), samples)))/(2*step)
      call whiten(covariance, fitted, white, log_determinant)
      gram = matmul(white(2:, :), transpose(white(2:, :)))
      trend%size = dot_product(white(2, :), white(1, :))/gram(1, 1)
      variance = sum((white(1, :) - trend%size*white(2, :))**2)/differences
      if (scale > 0) gram(1, 1) = gram(1, 1) - gram(1, 2)**2/gram(2, 2)
      trend%std_error = sqrt(variance/gram(1, 1))
   end subroutine measure_trend

   !> Means of the 128 blocks of a trend of size 1.
   pure function unit_means(shape, time_constant, samples) result(mean)
      character(*), intent(in) :: shape
      real(dp), intent(in) :: time_constant
      integer(int64), intent(in) :: samples
      real(dp) :: mean(block_count), length, half
      integer :: i

      length = real(samples/block_count, dp)
      mean = 0.5_dp*[(2*i*length + length - 1, i=0, block_count - 1)]
      if (shape == "ramp") then
         mean = mean/real(samples, dp)
      else
         half = 0.5_dp/time_constant
         mean = exp(-2*half*mean)*sinh(half*length)/(length*sinh(half))
      end if
   end function unit_means

   !> Differences of successive values.
   pure function steps_of(x) result(step)
      real(dp), intent(in) :: x(:)
      real(dp) :: step(size(x) - 1)

      step = x(2:) - x(:size(x) - 1)
   end function steps_of

   !> Means of the 128 blocks of a trend.
   pure function trend_means(trend, samples) result(mean)
      type(record_trend_type), intent(in) :: trend
      !> Length of the record
      integer(int64), intent(in) :: samples
      real(dp) :: mean(block_count)

      mean = 0
      if (trend%shape /= "") mean = trend%size*unit_means(trend%shape, trend%time_constant, samples)
   end function trend_means

   !> The values of a trend at some samples; the mean of a ramp is not 0.
   elemental real(dp) function trend_values(trend, samples, i) result(value)
      type(record_trend_type), intent(in) :: trend
      !> Length of the record; a sample, from 1
      integer(int64), intent(in) :: samples, i

      select case (trend%shape)
      case ("ramp"); value = trend%size*real(i - 1, dp)/real(samples, dp)
      case ("warm-up"); value = trend%size*exp(-real(i - 1, dp)/trend%time_constant)
      case default; value = 0
      end select
   end function trend_values

end module gyroakf_allan_trend_test
