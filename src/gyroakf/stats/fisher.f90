! SPDX-License-Identifier: MIT
!> Fisher's test for a hidden periodicity: the periodogram's largest ordinate over their sum.
!>
!> The null hypothesis is white noise: a series with correlation is whitened first
!> ([[gyroakf_ar_periodicity]]), or the test finds its correlation.
module gyroakf_stats_fisher
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_special, only : log1p
   use gyroakf_fft_real, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward
   use gyroakf_chunks, only : block_length
   use gyroakf_stats_extremes, only : scan_extremes
   implicit none (type, external)
   private
   public :: fisher_type, test_fisher_g, fisher_tail

   !> Result of the test
   type :: fisher_type
      !> g: share of the largest ordinate in the sum of all
      real(dp) :: statistic = 0.0_dp
      !> Share of the largest ordinate and its larger neighbor, >= 0.81 for a pure sinusoid
      real(dp) :: peak = 0.0_dp
      !> Probability of a larger g in white noise; its logarithm (-huge where g is 1)
      real(dp) :: p_value = 1.0_dp, log_p_value = 0.0_dp
      !> Frequency of the largest ordinate, cycles per sample, and its number k: f = k/n
      real(dp) :: frequency = 0.0_dp
      integer(int64) :: ordinate = 0
      !> Number of ordinates m and of samples n
      integer(int64) :: ordinates = 0, samples = 0
   end type fisher_type

   !> The sum would cancel from this expected number of larger ordinates on: Poisson there
   real(dp), parameter :: poisson_from = 17.0_dp
   !> Samples less one between two reports of progress: a power of two less one
   integer(int64), parameter :: report_mask = 1048575_int64
   !> exp(x) is zero below
   real(dp), parameter :: least_exponent = -708.0_dp

contains

   !> Fisher's test of a series.
   !>
   !> $$g = \max_k I_k / \sum_{k=1}^{m} I_k, \quad I_k = |\sum_t (x_t - \bar x) e^{-2\pi i kt/n}|^2,
   !> \quad m = \lfloor (n-1)/2 \rfloor$$ at the exact length n, without zero padding, without
   !> frequency 0 and the highest. With missing samples the sums go over the present ones: the
   !> ordinates of white noise are then a little correlated, and p is approximate. Source: R. A.
   !> Fisher, Tests of significance in harmonic analysis, Proc. R. Soc. A 125 (1929) 54-59.
   subroutine test_fisher_g(x, result, error, valid, progress)
      !> Series: [n], n >= 3; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> The test
      type(fisher_type), intent(out) :: result
      !> too_few_samples, constant_input, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(real_fft_plan_type) :: plan
      real(dp), allocatable :: centered(:)
      complex(dp), allocatable :: spectrum(:)
      integer(int64) :: n
      integer :: stat

      n = size(x, kind=int64)
      call center_and_scale(x, centered, error, valid, progress)
      if (allocated(error)) return
      allocate (spectrum(0:n/2), stat=stat)
      call check_memory(stat, "the spectrum of the series", error)
      if (allocated(error)) return
      call new_real_fft_plan(plan, n, error, progress)
      if (.not. allocated(error)) call real_fft_forward(plan, centered, spectrum, error, progress)
      if (.not. allocated(error)) call report_progress("Fourier transform", n, n, error, progress)
      if (.not. allocated(error)) call fisher_of_spectrum(spectrum, n, result, error)
   end subroutine test_fisher_g

   !> Samples less their mean, times a power of two: the largest is 1/2 .. 1; 0 where missing.
   subroutine center_and_scale(x, centered, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), allocatable, intent(out) :: centered(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: lowest, highest, step, mean
      integer(int64) :: n, i, number
      integer :: stat, power, size_of_all
      character(100) :: text

      n = size(x, kind=int64)
      call scan_extremes(x, lowest, highest, step, valid)
      number = n
      if (present(valid)) number = count(valid /= 0_int8, kind=int64)
      if (number < 3) then
         write (text, '("a periodogram needs at least 3 samples, there are ", i0)') number
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      else if (.not. highest > lowest) then
         call fatal_error(error, status%constant_input, &
            & "the series is constant, there is nothing periodic in it")
         return
      end if
      allocate (centered(0:n - 1), stat=stat)
      call check_memory(stat, "a copy of the series", error)
      if (allocated(error)) return
      size_of_all = exponent(max(abs(lowest), abs(highest)))
      lowest = scale(lowest, -size_of_all)
      power = exponent(scale(highest, -size_of_all) - lowest)
      do i = 0, n - 1
         if (iand(i, report_mask) == 0) call report_progress("Fourier transform", 0_int64, n, &
            & error, progress)
         if (allocated(error)) return
         centered(i) = 0.0_dp
         if (present(valid)) then
            if (valid(i + 1) == 0_int8) cycle
         end if
         centered(i) = scale(scale(x(i + 1), -size_of_all) - lowest, -power)
      end do
      mean = 0.0_dp
      do i = 0, n - 1, block_length
         mean = mean + sum(centered(i:min(i + block_length, n) - 1))
      end do
      mean = mean/real(number, dp)
      centered = centered - mean
      if (.not. present(valid)) return
      where (valid == 0_int8) centered = 0.0_dp
   end subroutine center_and_scale

   !> Fisher's test from the Fourier transform of the series.
   subroutine fisher_of_spectrum(spectrum, n, result, error)
      complex(dp), intent(in), contiguous :: spectrum(0:)
      integer(int64), intent(in) :: n
      type(fisher_type), intent(out) :: result
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: largest, total, rest, power
      integer(int64) :: k

      result%samples = n
      result%ordinates = (n - 1)/2
      largest = -1.0_dp
      rest = 0.0_dp                      ! of all but the largest: 1 - g without cancellation
      do k = 1, result%ordinates
         power = squared_modulus(spectrum(k))
         if (power > largest) then
            if (k > 1) rest = rest + largest
            largest = power
            result%ordinate = k
         else
            rest = rest + power
         end if
      end do
      total = rest + largest
      if (.not. total > 0.0_dp) call fatal_error(error, status%constant_input, &
         & "the series has no power between frequency 0 and the highest")
      if (allocated(error)) return
      result%statistic = largest/total
      power = 0.0_dp
      k = result%ordinate
      if (k > 1) power = squared_modulus(spectrum(k - 1))
      if (k < result%ordinates) power = max(power, squared_modulus(spectrum(k + 1)))
      result%peak = (largest + power)/total
      result%frequency = real(result%ordinate, dp)/real(n, dp)
      call fisher_tail(result%statistic, rest/total, result%ordinates, result%p_value, &
         & result%log_p_value)
   end subroutine fisher_of_spectrum

   pure real(dp) function squared_modulus(z)
      complex(dp), intent(in) :: z

      squared_modulus = real(z, dp)**2 + aimag(z)**2
   end function squared_modulus

   !> Probability of a larger g among m ordinates of white noise.
   !>
   !> $$p = \sum_{j=1}^{\lfloor 1/g \rfloor} (-1)^{j-1} \binom{m}{j} (1 - jg)^{m-1},$$ by the ratio
   !> of successive terms; where the first term, the expected number of larger ordinates, is above
   !> 17, p is 1 - exp(-that), right to 1e-7. Else the relative error is about m g/(1 - g) epsilon.
   pure subroutine fisher_tail(g, rest, m, p, log_p)
      !> Share of the largest ordinate, 1/m .. 1, and 1 - g, given apart to keep its digits
      real(dp), intent(in) :: g, rest
      !> Number of ordinates, >= 1
      integer(int64), intent(in) :: m
      !> Probability; 0 where it underflows
      real(dp), intent(out) :: p
      !> Its logarithm; -huge where g is 1
      real(dp), intent(out) :: log_p
      real(dp) :: expected, term, left
      integer(int64) :: j

      p = 1.0_dp
      log_p = 0.0_dp
      if (m <= 1) return
      p = 0.0_dp
      log_p = -huge(log_p)
      if (.not. rest > 0.0_dp) return
      if (g < 0.5_dp) then                         ! ln(1 - g) from what has the digits
         log_p = log1p(-g)
      else
         log_p = log(rest)
      end if
      log_p = log(real(m, dp)) + real(m - 1, dp)*log_p
      if (log_p < least_exponent) return
      expected = exp(log_p)
      if (expected > poisson_from) then
         p = 1.0_dp - exp(-min(expected, 700.0_dp))
         log_p = log1p(-exp(-min(expected, 700.0_dp)))
         return
      end if
      term = expected
      left = rest                                  ! 1 - j g
      do j = 1, m
         p = p + term
         left = left - g
         if (.not. left > 0.0_dp) exit
         term = -term*(real(m - j, dp)/real(j + 1, dp)) &
            & *exp(real(m - 1, dp)*log1p(max(-g/(left + g), epsilon(g) - 1.0_dp)))
         if (abs(term) < 1.0e-18_dp*abs(p)) exit
      end do
      p = min(max(p, 0.0_dp), 1.0_dp)
      log_p = -huge(log_p)
      if (p > 0.0_dp) log_p = log(p)
   end subroutine fisher_tail

end module gyroakf_stats_fisher
