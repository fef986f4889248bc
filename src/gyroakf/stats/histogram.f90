! SPDX-License-Identifier: MIT
!> Histogram of a series with the normal distribution fitted to it.
!>
!> The width of the bins follows Freedman and Diaconis: 2 IQR n^(-1/3), or what the largest number of bins allows. Where the
!> samples stand on a grid, bins are a whole number of steps wide and their edges lie half way between two levels: every bin
!> holds equally many levels, and no comb arises. Bins reach 5 IQR beyond the quartiles at most; what is further out
!> is counted in two end bins.
module gyroakf_stats_histogram
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_special, only : normal_cdf
   use gyroakf_stats_moments, only : moments_type, first_present
   use gyroakf_stats_bin_counts, only : count_bins, find_quartiles
   implicit none (type, external)
   private
   public :: histogram_options, histogram_type, compute_histogram

   !> Samples further than this from the quartiles, in interquartile ranges, are counted in the end bins
   real(dp), parameter :: reach = 5.0_dp
   real(dp), parameter :: sqrt_two_pi = 2.5066282746310005024157652848110_dp

   !> More bins than this are a slip
   integer, parameter :: largest_most_bins = 10000000

   !> How the bins are chosen
   type :: histogram_options
      !> No more bins than these, 2 to 10,000,000, the end bins not counted
      integer :: most_bins = 256
      !> Step of the grid that the samples stand on, u; 0: none. A step of samples whose trend was removed since is good too
      real(dp) :: step = 0.0_dp
   end type histogram_options

   !> A histogram of a series in its unit u
   type :: histogram_type
      !> Width of a bin, u
      real(dp) :: width = 0.0_dp
      !> The same in steps of the grid; 0 without a grid
      integer(int64) :: steps = 0
      !> Freedman and Diaconis ask for narrower bins, more than the largest number
      logical :: limited = .false.
      !> Edges of the bins, u; a sample on an edge is in the bin above: [0:bins]
      real(dp), allocatable :: edge(:)
      !> Samples: [bins]
      integer(int64), allocatable :: count(:)
      !> Samples that the normal distribution of the same mean and standard deviation has there: [bins]
      real(dp), allocatable :: expected(:)
      !> Density of the samples, count/(samples width), 1/u: [bins]
      real(dp), allocatable :: density(:)
      !> Density of the normal distribution at the centre of the bin, 1/u: [bins]
      real(dp), allocatable :: normal_density(:)
      !> Samples below the first and not below the last edge, and what the normal distribution has there
      integer(int64) :: below = 0, above = 0
      real(dp) :: expected_below = 0.0_dp, expected_above = 0.0_dp
      !> All present samples
      integer(int64) :: samples = 0
      !> Mean and standard deviation of the normal distribution, u
      real(dp) :: mean = 0.0_dp, std = 0.0_dp
   end type histogram_type

   !> A wider range is an error: sums of edges would overflow
   real(dp), parameter :: largest_range = 1.0e300_dp

contains

   !> Histogram of the present samples.
   !>
   !> Two passes, seldom more: the quartiles by counting in 4096 cells, then the bins. Threaded; counts are integers, the result
   !> does not depend on the threads. Source: Freedman & Diaconis, Z. Wahrsch. verw. Gebiete 57 (1981) 453-476; where
   !> the quartiles are equal Scott's width 3.49 s n^(-1/3), Biometrika 66 (1979) 605-610.
   subroutine compute_histogram(x, moments, options, histogram, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Its moments, of the same present samples
      type(moments_type), intent(in) :: moments
      !> Largest number of bins, grid
      type(histogram_options), intent(in) :: options
      !> The histogram
      type(histogram_type), intent(out) :: histogram
      !> invalid_argument (most_bins, step), too_few_samples (fewer than 2), constant_input, non_finite (range), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: quartile(2), low, high
      integer :: bins

      call check_input(moments, options, error)
      if (allocated(error)) return
      call find_quartiles(x, moments%minimum, moments%maximum, 0.25_dp*options%step, quartile, error, valid)
      if (allocated(error)) return
      call choose_range(moments, quartile, low, high)
      call choose_width(moments, quartile(2) - quartile(1), high - low, options, histogram)
      if (.not. histogram%width > 0.0_dp) then
         call fatal_error(error, status%constant_input, "the series hardly varies, there is no histogram")
         return
      end if
      if (options%step > 0.0_dp) low = edge_below(low, first_present(x, valid), options%step)
      bins = int(min(aint((high - low)/histogram%width), real(options%most_bins, dp))) + 1
      if (low + histogram%width*real(bins - 1, dp) > high) bins = bins - 1
      call allocate_bins(bins, histogram, error)
      if (allocated(error)) return
      call count_bins(x, low, histogram%width, histogram%count, histogram%below, histogram%above, error, valid)
      if (allocated(error)) return
      histogram%samples = moments%count
      histogram%mean = moments%mean
      histogram%std = moments%std
      call fit_normal(low, histogram)
   end subroutine compute_histogram

   !> Allocates the bins.
   pure subroutine allocate_bins(bins, histogram, error)
      integer, intent(in) :: bins
      type(histogram_type), intent(inout) :: histogram
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer :: stat

      allocate (histogram%edge(0:bins), stat=stat)
      if (stat == 0) allocate (histogram%count(bins), stat=stat)
      if (stat == 0) allocate (histogram%expected(bins), stat=stat)
      if (stat == 0) allocate (histogram%density(bins), stat=stat)
      if (stat == 0) allocate (histogram%normal_density(bins), stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for the histogram")
   end subroutine allocate_bins

   !> Refuses what has no histogram.
   subroutine check_input(moments, options, error)
      type(moments_type), intent(in) :: moments
      type(histogram_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      character(80) :: text

      if (options%most_bins < 2 .or. options%most_bins > largest_most_bins) then
         write (text, '("a histogram of at most ", i0, " bins cannot be made; 2 to ", i0, " can")') options%most_bins, &
            largest_most_bins
         call fatal_error(error, status%invalid_argument, trim(text))
      else if (.not. options%step >= 0.0_dp) then
         call fatal_error(error, status%invalid_argument, "the step of a grid must not be negative")
      else if (moments%count < 2) then
         call fatal_error(error, status%too_few_samples, "a histogram needs at least 2 samples")
      else if (.not. (moments%std > 0.0_dp .and. moments%maximum > moments%minimum)) then
         call fatal_error(error, status%constant_input, "the series has no variance, there is no histogram")
      else if (0.5_dp*moments%maximum - 0.5_dp*moments%minimum > 0.5_dp*largest_range) then
         call fatal_error(error, status%non_finite, "the range of the series is too large for a histogram: divide it by a constant")
      end if
   end subroutine check_input

   !> What the bins cover: all samples, but not those far from the quartiles.
   pure subroutine choose_range(moments, quartile, low, high)
      type(moments_type), intent(in) :: moments
      real(dp), intent(in) :: quartile(2)
      real(dp), intent(out) :: low, high
      real(dp) :: far

      far = reach*(quartile(2) - quartile(1))
      if (far <= 0.0_dp) far = reach*moments%std
      low = max(moments%minimum, quartile(1) - far)
      high = min(moments%maximum, quartile(2) + far)
   end subroutine choose_range

   !> Width of the bins: Freedman and Diaconis', not more bins than allowed, whole steps.
   pure subroutine choose_width(moments, spread, range, options, histogram)
      type(moments_type), intent(in) :: moments
      !> Interquartile range, and what the bins cover
      real(dp), intent(in) :: spread, range
      type(histogram_options), intent(in) :: options
      !> width, steps and limited are set
      type(histogram_type), intent(inout) :: histogram
      real(dp) :: asked, narrowest, whole

      asked = 2.0_dp*spread/real(moments%count, dp)**(1.0_dp/3.0_dp)
      if (spread <= 0.0_dp) asked = 3.49_dp*moments%std/real(moments%count, dp)**(1.0_dp/3.0_dp)
      narrowest = range/(real(options%most_bins, dp) - 1.5_dp)
      histogram%limited = asked < narrowest
      histogram%width = max(asked, narrowest)
      if (.not. options%step > 0.0_dp) return
      whole = max(1.0_dp, anint(asked/options%step))
      histogram%limited = whole*options%step < narrowest
      if (histogram%limited) whole = aint(narrowest/options%step) + 1.0_dp
      histogram%width = whole*options%step
      histogram%steps = nint(min(whole, 2.0_dp**62), int64)
   end subroutine choose_width

   !> The highest edge, half a step off a level, that is not above the lowest sample.
   pure real(dp) function edge_below(low, level, step) result(edge)
      !> Lowest sample; a level of the grid; the step
      real(dp), intent(in) :: low, level, step

      edge = level + step*(anint((low - level)/step) - 0.5_dp)
   end function edge_below

   !> Edges, densities, and what the normal distribution has.
   pure subroutine fit_normal(low, histogram)
      !> First edge
      real(dp), intent(in) :: low
      !> The counts are there
      type(histogram_type), intent(inout) :: histogram
      real(dp) :: n, before, next, centre
      integer :: i, bins

      bins = size(histogram%count)
      n = real(histogram%samples, dp)
      do i = 0, bins
         histogram%edge(i) = low + histogram%width*real(i, dp)
      end do
      before = (histogram%edge(0) - histogram%mean)/histogram%std
      histogram%expected_below = n*normal_cdf(before)
      do i = 1, bins
         next = (histogram%edge(i) - histogram%mean)/histogram%std
         centre = 0.5_dp*(before + next)
         histogram%expected(i) = n*probability(before, next)
         histogram%density(i) = real(histogram%count(i), dp)/n/histogram%width
         histogram%normal_density(i) = exp(-0.5_dp*centre*centre)/sqrt_two_pi/histogram%std
         before = next
      end do
      histogram%expected_above = n*normal_cdf(-before)
   end subroutine fit_normal

   !> Probability of a standard normal deviate between a and b, without cancellation in the upper tail.
   pure real(dp) function probability(a, b)
      !> a < b
      real(dp), intent(in) :: a, b

      if (a > 0.0_dp) then
         probability = normal_cdf(-a) - normal_cdf(-b)
      else
         probability = normal_cdf(b) - normal_cdf(a)
      end if
   end function probability

end module gyroakf_stats_histogram
