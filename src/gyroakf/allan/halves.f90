! SPDX-License-Identifier: MIT
!> Whether the two halves of a record have the same Allan curve: is its noise the same at the end as
!> at the beginning?
!>
!>     type(halves_type) :: halves
!>     call fit_noise(curve, noise_options(), noise, error)
!>     call compare_halves(rate, sample_interval, noise, halves_options(), halves, error)
!>
!> With the overlapping Allan variances of the first and of the last n/2 samples,
!>
!> $$ d_i = \ln\frac{\hat\sigma^2_2(\tau_i)}{\hat\sigma^2_1(\tau_i)} - (b_{2i} - b_{1i}), \quad
!>    b = \psi(\nu/2) - \ln(\nu/2) $$
!>
!> has the expectation 0 if they are the same. Its covariance is the sum of those of the halves
!> (which are independent but for their common border): the analytic covariance of the fitted
!> mixture, [[mixture_covariances]], for n/2 samples, of logarithms (nu/2 psi'(nu/2) on the diagonal
!> instead of 1), divided by the share that gaps leave of the degrees of freedom. One statistic for
!> all averaging times is d' C^-1 d in the space of the eigenvectors that carry information
!> (neighboring averaging times say almost the same); it is chi-square. Averaging times with few
!> degrees of freedom are left out.
!>
!> Noise that is not Gaussian scatters otherwise: the innovations' excess kurtosis kappa adds
!> kappa/(n/2) to the covariance of every two relative variances of a linear process (Bartlett's
!> formula). It is taken as twice that of the second differences of the phase at one sample (the
!> mean of both halves), which is exact for white noise of the rate or of the phase. Outliers in one
!> half then do not pass for a change.
!>
!> The ratio of the deviations, exp(d/2), says how large a change is: in a long record the least one
!> is significant.
module gyroakf_allan_halves
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_error, only : check_sample_interval, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_special, only : chi_square_survival, digamma, normal_quantile, trigamma
   use gyroakf_allan_difference_kurtosis, only : find_kurtosis
   use gyroakf_allan_fit_covariance, only : covariance_basis, covariance_basis_type, &
      & mixture_covariances
   use gyroakf_allan_variances, only : allan_variances
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_lapack, only : dsyev
   use gyroakf_allan_noise_fit, only : noise_type
   use gyroakf_allan_noise_model, only : model_variance, term_count
   use gyroakf_allan_phase, only : integrate_rate
   implicit none (type, external)
   private
   public :: halves_options, halves_type, compare_halves

   !> What is compared
   type :: halves_options
      !> Averaging times, as in [[allan_options]]; "octave" also when unallocated
      character(:), allocatable :: taus
      !> Probability between the limits of each ratio, > 0, < 1; its complement is the level of the
      !> test
      real(dp) :: confidence = 0.95_dp
      !> Share of a window that must be present, > 0, <= 1
      real(dp) :: min_coverage = 0.9_dp
      !> Degrees of freedom that a variance of each half must have, >= 1
      real(dp) :: least_edf = 10.0_dp
   end type halves_options

   !> The comparison; arrays have one element per averaging time, ascending
   type :: halves_type
      !> Chi-square of all averaging times together, its degrees of freedom, and the probability of
      !> a larger one
      real(dp) :: statistic = 0.0_dp
      integer :: freedom = 0
      real(dp) :: p_value = 1.0_dp
      !> Averaging times, s
      real(dp), allocatable :: tau(:)
      !> Deviation of the second half over that of the first, with limits
      real(dp), allocatable :: ratio(:), lower(:), upper(:)
      !> Logarithm of the ratio over its standard error
      real(dp), allocatable :: score(:)
      !> The curves differ: p_value is below 1 - confidence
      logical :: changed = .false.
      !> Probability between the limits of a ratio
      real(dp) :: confidence = 0.95_dp
   end type halves_type

   !> Averaging times that enter the statistic at most
   integer, parameter :: points_max = 80
   !> Excess kurtosis of uniform noise
   real(dp), parameter :: kurtosis_least = -1.2_dp
   !> Eigenvalues of the correlation matrix below this share of the largest one are below the
   !> accuracy of the covariance
   real(dp), parameter :: eigenvalue_share = 1e-3_dp
   !> A half whose variance is a smaller share of the other's is constant but for rounding
   real(dp), parameter :: constant_share = 1e-20_dp

contains

   !> Compares the Allan curves of the two halves of a record.
   !>
   !> Cost: three passes for the integral, and what the Allan variances of the record cost; memory 8
   !> bytes a sample, 12 where some are missing.
   subroutine compare_halves(rate, sample_interval, noise, options, halves, error, valid, progress)
      !> Rate samples, evenly spaced: [n], n >= 8; NaN and infinity count as missing
      real(dp), intent(in), contiguous :: rate(:)
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> Coefficients of the whole record, from [[fit_noise]]: they give the covariance of the
      !> variances
      type(noise_type), intent(in) :: noise
      !> Averaging times, confidence
      type(halves_options), intent(in) :: options
      !> The comparison
      type(halves_type), intent(out) :: halves
      !> invalid_argument, too_few_samples (no averaging time has the degrees of freedom),
      !> constant_input, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]; all present if absent
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      real(dp), allocatable :: phase(:), variance(:, :), share(:, :)
      real(dp) :: kurtosis(2)
      integer(int32), allocatable :: missing(:)
      integer(int64), allocatable :: m(:)
      integer(int64) :: n, half
      integer :: i
      character(:), allocatable :: taus

      n = size(rate, kind=int64)
      half = n/2
      call check_arguments(half, sample_interval, noise, options, error)
      taus = "octave"
      if (allocated(options%taus)) taus = options%taus
      if (.not. allocated(error)) call averaging_factors(taus, half, sample_interval, m, error)
      if (allocated(error)) return
      if (size(m) > points_max) call fatal_error(error, status%invalid_argument, &
         & "the halves of a record are compared at no more than 80 averaging times")
      if (.not. allocated(error)) call integrate_rate(rate, phase, missing, error, valid, progress)
      if (.not. allocated(error)) call report_progress("comparing the halves", 0_int64, n, error, &
         & progress)
      if (allocated(error)) return
      allocate (variance(size(m), 2), share(size(m), 2))
      do i = 1, 2
         call measure_half(phase, missing, merge(0_int64, n - half, i == 1), half, m, &
            & options%min_coverage, variance(:, i), share(:, i), kurtosis(i), error, progress)
         if (.not. allocated(error)) call report_progress("comparing the halves", i*half, n, &
            & error, progress)
         if (allocated(error)) return
      end do
      if (any(minval(share, dim=2) > 0 &
         & .and. minval(variance, dim=2) <= max(constant_share*maxval(variance, dim=2), &
         & tiny(1.0_dp)))) then
         call fatal_error(error, status%constant_input, &
            & "an Allan deviation is zero: a half of the record does not vary")
         return
      end if
      halves%confidence = options%confidence
      call compare_variances(half, sample_interval, m, variance, share, noise%squares, &
         & sum(kurtosis)/2, options, halves, error)
   end subroutine compare_halves

   !> Variances of a half, and the excess kurtosis of its innovations, at least that of uniform
   !> noise. A second difference does not see where the integral began nor which mean was taken
   !> out: a part of the record needs no integral of its own.
   subroutine measure_half(phase, missing, first, length, m, min_coverage, variance, share, &
      & kurtosis, error, progress)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), allocatable, intent(in) :: missing(:)
      !> First phase of the half, and its samples
      integer(int64), intent(in) :: first, length
      integer(int64), intent(in) :: m(:)
      real(dp), intent(in) :: min_coverage
      real(dp), intent(out) :: variance(:), share(:), kurtosis
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: terms(size(m))
      real(dp) :: found(1)

      associate (part => phase(first:first + length))
         if (allocated(missing)) then
            call allan_variances("oadev", part, m, min_coverage, variance, terms, share, error, &
               & missing(first:first + length), progress)
            if (.not. allocated(error)) call find_kurtosis(part, [1_int64], variance(:1), found, &
               & missing(first:first + length))
         else
            call allan_variances("oadev", part, m, min_coverage, variance, terms, share, error, &
               & progress=progress)
            if (.not. allocated(error)) call find_kurtosis(part, [1_int64], variance(:1), found)
         end if
      end associate
      kurtosis = kurtosis_least
      if (.not. allocated(error)) kurtosis = max(found(1), kurtosis_least)
   end subroutine measure_half

   !> Rejects what is out of range.
   subroutine check_arguments(half, sample_interval, noise, options, error)
      integer(int64), intent(in) :: half
      real(dp), intent(in) :: sample_interval
      type(noise_type), intent(in) :: noise
      type(halves_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error

      call check_sample_interval(sample_interval, error)
      if (allocated(error)) return
      if (.not. (options%confidence > 0 .and. options%confidence < 1)) then
         call fatal_error(error, status%invalid_argument, "the confidence must lie between 0 and 1")
      else if (.not. (options%min_coverage > 0 .and. options%min_coverage <= 1)) then
         call fatal_error(error, status%invalid_argument, &
            & "the coverage of a window must be above 0 and at most 1")
      else if (.not. (options%least_edf >= 1 .and. options%least_edf < huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, &
            & "the least degrees of freedom must be 1 or more")
      else if (.not. any(noise%squares > 0)) then
         call fatal_error(error, status%invalid_argument, &
            & "the noise coefficients are not fitted: all of them are 0")
      else if (half < 4) then
         call fatal_error(error, status%too_few_samples, &
            & "two halves to be compared need at least 8 samples")
      end if
   end subroutine check_arguments

   !> The ratios, and the statistic of all of them.
   subroutine compare_variances(half, sample_interval, m, variance, share, model, kurtosis, &
      & options, halves, error)
      integer(int64), intent(in) :: half
      real(dp), intent(in) :: sample_interval
      integer(int64), intent(in) :: m(:)
      !> Variances, and shares of their degrees of freedom that gaps leave: [k, 2]
      real(dp), intent(in) :: variance(:, :), share(:, :), model(term_count), kurtosis
      type(halves_options), intent(in) :: options
      type(halves_type), intent(inout) :: halves
      type(error_type), allocatable, intent(out) :: error

      real(dp), dimension(size(m), 2) :: edf, factor
      real(dp) :: covariance(size(m), size(m))
      real(dp), allocatable :: change(:), axes(:, :), deviation(:), kept(:, :)
      integer, allocatable :: place(:)
      real(dp) :: wide
      integer :: i

      call relative_covariance(half, m, model, covariance)
      covariance = covariance + kurtosis/real(half, dp)
      do i = 1, size(m)
         edf(i, :) = 2*share(i, :)/covariance(i, i)
      end do
      place = pack([(i, i=1, size(m))], minval(edf, dim=2) >= options%least_edf)
      if (size(place) == 0) then
         call fatal_error(error, status%too_few_samples, &
            & "the halves of the record are too short to be compared, miss too many samples, "// &
            & "or are dominated by a few large values")
         return
      end if
      edf = edf/2
      change = log(variance(place, 2)/variance(place, 1)) &
         & - (digamma(edf(place, 2)) - log(edf(place, 2))) &
         & + (digamma(edf(place, 1)) - log(edf(place, 1)))
      ! from the relative covariance of one half to that of the difference of the logarithms of both
      factor = 0
      where (edf > 0) factor = sqrt(edf*trigamma(edf)/share)
      do i = 1, size(m)
         covariance(:, i) = covariance(:, i)*(factor(:, 1)*factor(i, 1) + factor(:, 2)*factor(i, 2))
      end do
      kept = covariance(place, place)
      deviation = [(sqrt(kept(i, i)), i=1, size(place))]
      call find_axes(kept, deviation, axes)
      halves%freedom = size(axes, 1)
      halves%statistic = sum(matmul(axes, change)**2)
      if (halves%freedom > 0) halves%p_value = chi_square_survival(halves%statistic, &
         & real(halves%freedom, dp))
      wide = normal_quantile((1 + options%confidence)/2)
      halves%changed = halves%p_value < 1 - options%confidence
      halves%tau = real(m(place), dp)*sample_interval
      halves%ratio = exp(change/2)
      halves%score = change/deviation
      halves%lower = exp((change - wide*deviation)/2)
      halves%upper = exp((change + wide*deviation)/2)
   end subroutine compare_variances

   !> Covariance of the variances of half a record, relative to the model.
   subroutine relative_covariance(half, m, model, covariance)
      integer(int64), intent(in) :: half, m(:)
      real(dp), intent(in) :: model(term_count)
      real(dp), intent(out) :: covariance(:, :)
      type(covariance_basis_type) :: basis
      real(dp) :: squares(term_count), variance(size(m))
      integer :: i

      squares = scale(model, -exponent(maxval(model)))      ! products of small squares vanish
      basis = covariance_basis(half, m)
      covariance = mixture_covariances(basis, squares)
      variance = [(model_variance(squares, real(m(i), dp)), i=1, size(m))]
      do i = 1, size(m)
         covariance(:, i) = covariance(:, i)/(variance*variance(i))
      end do
   end subroutine relative_covariance

   !> Combinations of correlated points that are independent and of variance 1.
   subroutine find_axes(covariance, deviation, axes)
      real(dp), intent(in) :: covariance(:, :), deviation(:)
      !> One in each row: [kept, points]
      real(dp), allocatable, intent(out) :: axes(:, :)
      real(dp) :: vector(size(deviation), size(deviation)), value(size(deviation)), &
         & work(64*size(deviation) + 64)
      integer :: i, n, kept, info

      n = size(deviation)
      do i = 1, n
         vector(:, i) = covariance(:, i)/(deviation*deviation(i))
      end do
      call dsyev("V", "U", n, vector, n, value, work, size(work), info)
      kept = 0
      if (info == 0) kept = count(value > eigenvalue_share*value(n))
      allocate (axes(kept, n))
      do i = 1, kept                                        ! the last ones: dsyev sorts upwards
         axes(i, :) = vector(:, n - kept + i)/(deviation*sqrt(value(n - kept + i)))
      end do
   end subroutine find_axes

end module gyroakf_allan_halves
