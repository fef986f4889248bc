! SPDX-License-Identifier: MIT
!> Tests of the histogram with the fitted normal distribution.
module test_histogram
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_histogram, only : histogram_options, histogram_type, compute_histogram
   use gyroakf_stats_bin_counts, only : find_quartiles
   use series_library, only : reference_series
   use expectations, only : check
   use testdrive, only : error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_histogram

   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine collect_histogram(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("by_hand", test_by_hand), &
         & new_unittest("width", test_width), &
         & new_unittest("normal", test_normal), &
         & new_unittest("quartiles", test_quartiles), &
         & new_unittest("outliers", test_outliers), &
         & new_unittest("no_comb", test_no_comb), &
         & new_unittest("no_comb_trend", test_no_comb_trend), &
         & new_unittest("coarse", test_coarse), &
         & new_unittest("bounded", test_bounded), &
         & new_unittest("missing", test_missing), &
         & new_unittest("offset_scale", test_offset_scale), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_histogram

   !> A histogram with the moments of the series; no bins where it fails.
   subroutine run(x, histogram, valid, step, bins)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The histogram
      type(histogram_type), intent(out) :: histogram
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Grid
      real(dp), intent(in), optional :: step
      !> Largest number
      integer, intent(in), optional :: bins
      type(histogram_options) :: options
      type(moments_type) :: moments
      type(gyro_error), allocatable :: problem

      if (present(step)) options%step = step
      if (present(bins)) options%most_bins = bins
      call compute_moments(x, moments, valid)
      call compute_histogram(x, moments, options, histogram, problem, valid)
      if (allocated(problem)) allocate (histogram%count(0))
   end subroutine run

   !> Levels 0 1 1 2 2 2 3 3 4 with a step of 1: edges at -0.5, 0.5, ...; quartiles 1 and 3 ask for 2*2/9^(1/3) = 1.9, two steps.
   subroutine test_by_hand(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h

      call run([0.0_dp, 1.0_dp, 1.0_dp, 2.0_dp, 2.0_dp, 2.0_dp, 3.0_dp, 3.0_dp, 4.0_dp], h, step=1.0_dp)
      call check(error, h%steps == 2_int64 .and. size(h%count) == 3, "three bins of two steps")
      if (allocated(error)) return
      call check(error, all(h%count == [3_int64, 5_int64, 1_int64]), "counts")
      call check(error, maxval(abs(h%edge - [-0.5_dp, 1.5_dp, 3.5_dp, 5.5_dp])), 0.0_dp, thr=tolerance)
      call check(error, h%density(2), 5.0_dp/18.0_dp, thr=tolerance)
      call check(error, h%expected_below + sum(h%expected) + h%expected_above, 9.0_dp, thr=tolerance)
      call check(error, h%normal_density(2), exp(-0.5_dp*(0.5_dp/h%std)**2)/(sqrt(8.0_dp*atan(1.0_dp))*h%std), thr=tolerance)
   end subroutine test_by_hand

   !> Quartiles of 1 .. 1000 are 250 and 750, within a cell: 2*500/10 = 100.
   subroutine test_width(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h
      integer :: i

      call run([(real(mod(7*i, 1000), dp), i=1, 1000)], h)
      call check(error, h%width, 100.0_dp, thr=1.0_dp)
      call check(error, sum(h%count) == 1000_int64 .and. h%below == 0_int64 .and. h%above == 0_int64, "all samples are in bins")
      call check(error, .not. h%limited .and. h%steps == 0_int64, "neither limited nor on a grid")
   end subroutine test_width

   !> Normal samples: chi-square of the bins that expect 20 or more is near their number.
   subroutine test_normal(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h
      real(dp) :: chi2
      integer :: used

      call run(reference_series("wn_bm", 100000), h)
      used = count(h%expected > 20.0_dp)
      chi2 = sum((real(h%count, dp) - h%expected)**2/h%expected, mask=h%expected > 20.0_dp)
      call check(error, abs(chi2 - real(used, dp)) < 4.0_dp*sqrt(2.0_dp*real(used, dp)), "chi-square of a normal series")
      call check(error, used > 80, "as many bins as Freedman and Diaconis ask for")
      call check(error, maxval(abs(h%density - h%normal_density)) < 0.02_dp, "densities")
   end subroutine test_normal

   !> Quartiles of uniform samples, and of the same with two outliers of 1e9 that leave them in one cell.
   subroutine test_quartiles(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: x(:)
      real(dp) :: q(2), far(2)
      type(gyro_error), allocatable :: problem

      x = reference_series("unif", 10000)
      call find_quartiles(x, minval(x), maxval(x), 0.0_dp, q, problem)
      call check(error, abs(q(1) - 0.25_dp) < 0.02_dp .and. abs(q(2) - 0.75_dp) < 0.02_dp, "quartiles")
      call check(error, count(x < q(1)) - 2500, 0, "rank of the first")
      x(5) = -1.0e9_dp
      x(6) = 1.0e9_dp
      call find_quartiles(x, minval(x), maxval(x), 0.0_dp, far, problem)
      call check(error, maxval(abs(far - q)), 0.0_dp, thr=0.5_dp/64.0_dp)
   end subroutine test_quartiles

   !> Far samples are counted in the end bins.
   subroutine test_outliers(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h
      real(dp), allocatable :: x(:)

      x = reference_series("wn", 10000)
      x(1:3) = [-50.0_dp, 80.0_dp, 90.0_dp]
      call run(x, h)
      call check(error, h%below == 1_int64 .and. h%above == 2_int64, "outside")
      call check(error, sum(h%count) == 9997_int64, "inside")
      call check(error, h%edge(size(h%count)) < 10.0_dp, "bins do not reach the outliers")
   end subroutine test_outliers

   !> A step of 0.15 standard deviations, where bins of the width asked for would hold 0, 1 or 2 levels by turns.
   subroutine test_no_comb(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h, comb
      real(dp), allocatable :: x(:)

      x = 0.15_dp*anint(reference_series("wn_bm", 20000)/0.15_dp)
      call run(x, h, step=0.15_dp)
      call check(error, roughness(h) < 2.0_dp, "a comb")
      call check(error, h%width, 0.15_dp*real(h%steps, dp), thr=tolerance)
      call run(x, comb)
      call check(error, roughness(comb) > 10.0_dp, "no comb without the step: the test shows nothing")
   end subroutine test_no_comb

   !> Chi-square a bin, of the bins that expect 20 or more.
   real(dp) function roughness(h)
      !> Histogram
      type(histogram_type), intent(in) :: h

      roughness = sum((real(h%count, dp) - h%expected)**2/h%expected, mask=h%expected > 20.0_dp)/ &
         & real(count(h%expected > 20.0_dp), dp)
   end function roughness

   !> The samples are off the grid since a trend was removed: whole steps still do.
   subroutine test_no_comb_trend(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h
      real(dp), allocatable :: x(:)
      integer :: i

      x = [(3.0e-5_dp*real(i, dp), i=1, 20000)]
      x = 0.15_dp*anint((reference_series("wn_bm", 20000) + x)/0.15_dp) - x
      call run(x, h, step=0.15_dp)
      call check(error, roughness(h) < 2.0_dp, "a comb")
   end subroutine test_no_comb_trend

   !> One level holds more than half of the samples: a bin for each level.
   subroutine test_coarse(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h

      call run(2.0_dp*anint(reference_series("wn_bm", 5000)/2.0_dp), h, step=2.0_dp)
      call check(error, h%steps == 1_int64 .and. size(h%count) <= 5, "a bin for each level")
      if (allocated(error)) return
      call check(error, maxval(h%count) > 2500_int64, "the middle level")
      call check(error, sum(h%count) + h%below + h%above == 5000_int64, "all samples")
   end subroutine test_coarse

   !> Never more bins than allowed, with and without a grid.
   subroutine test_bounded(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: h
      real(dp), allocatable :: x(:)
      integer :: bins

      x = 0.001_dp*anint(1000.0_dp*reference_series("wn", 20000))
      do bins = 2, 40
         call run(x, h, bins=bins)
         call check(error, size(h%count) <= bins .and. size(h%count) > 0 .and. h%limited, "without a grid")
         if (allocated(error)) return
         call check(error, sum(h%count) == 20000_int64, "all samples without a grid")
         call run(x, h, step=0.001_dp, bins=bins)
         call check(error, size(h%count) <= bins .and. h%limited .and. sum(h%count) == 20000_int64, "on a grid")
         if (allocated(error)) return
      end do
   end subroutine test_bounded

   !> Missing samples count as if they were not there.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(5000)
      integer :: i

      x = reference_series("wn", 5000)
      valid = [(merge(0_int8, 1_int8, mod(i*i, 7) == 2), i=1, 5000)]
      call run(pack(x, valid == 1_int8), a)
      where (valid == 0_int8) x = 1.0e30_dp
      call run(x, b, valid)
      call check(error, size(a%count) == size(b%count), "bins")
      if (allocated(error)) return
      call check(error, all(a%count == b%count) .and. a%samples == b%samples, "counts")
      call check(error, maxval(abs(a%edge - b%edge)), 0.0_dp, thr=tolerance)
   end subroutine test_missing

   !> Powers of two are exact, and so is the offset for multiples of 1/1024.
   subroutine test_offset_scale(error)
      type(error_type), allocatable, intent(out) :: error
      type(histogram_type) :: a, b
      real(dp), allocatable :: x(:)
      real(dp), parameter :: step = 2.0_dp**(-10)

      x = anint(1024.0_dp*reference_series("ar2", 5000))/1024.0_dp
      call run(x, a, step=step)
      call run((x + 1048576.0_dp)*2.0_dp**(-60), b, step=step*2.0_dp**(-60))
      call check(error, size(a%count) == size(b%count), "bins")
      if (allocated(error)) return
      call check(error, all(a%count == b%count), "counts")
      call check(error, maxval(abs(a%expected - b%expected)), 0.0_dp, thr=1.0e-6_dp)
   end subroutine test_offset_scale

   !> A constant series, one sample, one bin, a negative step.
   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: x(3) = [1.0_dp, 2.0_dp, 4.0_dp]

      call expect([0.1_dp, 0.1_dp, 0.1_dp], histogram_options(), status%constant_input, error)
      if (allocated(error)) return
      call expect(x(:1), histogram_options(), status%too_few_samples, error)
      if (allocated(error)) return
      call expect(x, histogram_options(most_bins=1), status%invalid_argument, error)
      if (allocated(error)) return
      call expect(x, histogram_options(most_bins=huge(1)), status%invalid_argument, error)
      if (allocated(error)) return
      call expect(x, histogram_options(step=-1.0_dp), status%invalid_argument, error)
   end subroutine test_failures

   !> Expects a failure.
   subroutine expect(x, options, code, error)
      real(dp), intent(in), contiguous :: x(:)
      type(histogram_options), intent(in) :: options
      integer, intent(in) :: code
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments
      type(histogram_type) :: h
      type(gyro_error), allocatable :: problem

      call compute_moments(x, moments)
      call compute_histogram(x, moments, options, h, problem)
      call check(error, allocated(problem), "no failure")
      if (allocated(error)) return
      call check(error, problem%code, code)
   end subroutine expect

end module test_histogram
