! SPDX-License-Identifier: MIT
!> Tests of the modified, time and total deviation of records with missing samples, against the sums that define them.
module test_allan_gaps
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_averaged_difference, only : sum_phase_averages
   use gyroakf_allan_reflection, only : add_reflections, complete_weight
   use gyroakf_allan_phase_difference, only : sum_phase_differences
   use gyroakf_allan_window_difference, only : window_sums_type, sum_windows
   use allan_series, only : normal_series, uniform_series, walk_of
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_allan_gaps

   !> Rounding of the sums of a few hundred terms
   real(dp), parameter :: exact = 1.0e-11_dp
   !> How samples are lost: 1 %, 5 % at random, a gap of 10 %
   integer, parameter :: patterns = 3

contains

   subroutine suite_allan_gaps()
      call test("average_by_definition", test_average_definition)
      call test("reflection_by_definition", test_reflection_definition)
      call test("nothing_missing", test_nothing_missing)
      call test("white_noise", test_white)
      call test("random_walk", test_walk)
      call test("long_gap", test_long_gap)
      call test("strict", test_strict)
      call test("time_deviation", test_time_deviation)
   end subroutine suite_allan_gaps

   !> 1 present, 0 missing.
   pure function presence(n, pattern) result(valid)
      integer, intent(in) :: n
      !> Which, 1 .. patterns
      integer, intent(in) :: pattern
      integer(int8) :: valid(n)

      valid = 1
      select case (pattern)
      case (1); valid = merge(0_int8, 1_int8, uniform_series(int(n, int64), 555_int64) < 0.01_dp)
      case (2); valid = merge(0_int8, 1_int8, uniform_series(int(n, int64), 777_int64) < 0.05_dp)
      case default; valid(4*n/10:5*n/10 - 1) = 0
      end select
   end function presence

   !> Phase and count of the missing samples as the library's sums take them.
   pure subroutine integrate(rate, valid, phase, missing)
      real(dp), intent(in) :: rate(:)
      integer(int8), intent(in) :: valid(:)
      !> Results: [0:n]
      real(dp), intent(out) :: phase(0:)
      integer(int32), intent(out) :: missing(0:)

      integer :: k

      phase(0) = 0
      missing(0) = 0
      do k = 1, size(rate)
         phase(k) = phase(k - 1) + merge(rate(k), 0.0_dp, valid(k) /= 0)
         missing(k) = missing(k - 1) + merge(0_int32, 1_int32, valid(k) /= 0)
      end do
   end subroutine integrate

   !> Adds the square of the difference of two weighted means of the present samples, and what white noise adds to it.
   pure subroutine add_difference(rate, valid, weight, coverage, sums, white)
      real(dp), intent(in) :: rate(:)
      integer(int8), intent(in) :: valid(:)
      !> Weights of the first and the second mean: [n, 2]
      real(dp), intent(in) :: weight(:, :)
      !> Share of the weights that must be there
      real(dp), intent(in) :: coverage
      type(window_sums_type), intent(inout) :: sums
      !> Sum over the samples of the squared weights of the difference, less those of the complete record
      real(dp), intent(inout) :: white

      real(dp), dimension(size(rate)) :: there, all_there
      real(dp) :: full(2), w(2)

      full = sum(weight, dim=1)
      w = matmul(real(valid, dp), weight)
      if (any(w < coverage*full - 1.0e-6_dp)) return
      there = real(valid, dp)*(weight(:, 2)/w(2) - weight(:, 1)/w(1))
      all_there = weight(:, 2)/full(2) - weight(:, 1)/full(1)
      sums%squares = sums%squares + sum(there*rate)**2
      sums%terms = sums%terms + 1
      sums%weight = sums%weight + sum(all_there**2)*full(1)/2
      white = white + sum(there**2) - sum(all_there**2)
   end subroutine add_difference

   subroutine compare(found, expected, white, label)
      type(window_sums_type), intent(in) :: found, expected
      !> Inflation by the definition
      real(dp), intent(in) :: white
      character(*), intent(in) :: label

      call check(error, found%terms == expected%terms, label//": terms")
      call check(error, found%squares, expected%squares, thr=exact, rel=.true.)
      call check(error, abs(found%inflation - white) <= exact*real(max(found%terms, 1_int64), dp), label//": inflation")
   end subroutine compare

   subroutine test_average_definition()
      ! triangles of weights, every term by its own sums; 133 terms remain of m = 89
      integer, parameter :: n = 398, m(4) = [1, 7, 30, 89]
      type(window_sums_type) :: found(4), expected
      real(dp) :: rate(n), phase(0:n), weight(n, 2), white
      integer(int32) :: missing(0:n)
      integer :: pattern, i, j, s

      rate = normal_series(int(n, int64), 31_int64)
      do pattern = 1, patterns
         call integrate(rate, presence(n, pattern), phase, missing)
         call sum_phase_averages(phase, int(m, int64), found, failure, missing, spread(0.85_dp, 1, size(m)))
         do i = 1, size(m)
            expected = window_sums_type()
            white = 0
            do j = 0, n - 3*m(i) + 1
               weight = 0
               do s = 1, 2*m(i) - 1
                  weight(j + s, 1) = min(s, 2*m(i) - s)
                  weight(j + m(i) + s, 2) = min(s, 2*m(i) - s)
               end do
               call add_difference(rate, presence(n, pattern), weight, 0.85_dp, expected, white)
            end do
            call compare(found(i), expected, white, "mdev")
         end do
      end do
   end subroutine test_average_definition

   subroutine test_reflection_definition()
      ! a sample that the mirror shows twice has twice the weight
      integer, parameter :: n = 398, m(4) = [1, 7, 30, 190]
      type(window_sums_type) :: found(4), expected
      real(dp) :: rate(n), phase(0:n), weight(n, 2), white
      integer(int32) :: missing(0:n)
      integer :: pattern, i, k, s, w, place

      rate = normal_series(int(n, int64), 31_int64)
      do pattern = 1, patterns
         call integrate(rate, presence(n, pattern), phase, missing)
         call sum_windows(phase, int(m, int64), 2, .true., found, failure, missing, &
            & spread(0.85_dp, 1, size(m)))
         call add_reflections(phase, int(m, int64), found, failure, missing, spread(0.85_dp, 1, size(m)))
         do i = 1, size(m)
            expected = window_sums_type()
            white = 0
            do k = 1, n - 1
               weight = 0
               do s = 1 - m(i), m(i)
                  w = merge(1, 2, s <= 0)
                  place = k + s
                  if (place < 1) place = 1 - place
                  if (place > n) place = 2*n + 1 - place
                  weight(place, w) = weight(place, w) + 1
               end do
               call add_difference(rate, presence(n, pattern), weight, 0.85_dp, expected, white)
            end do
            call compare(found(i), expected, white, "totdev")
            call check(error, abs(found(i)%weight - expected%weight) <= exact*n, "totdev: expectations of complete terms")
         end do
      end do
   end subroutine test_reflection_definition

   subroutine test_nothing_missing()
      ! a coverage of one in a record of which all is there: the plain sums
      integer, parameter :: n = 100000
      integer(int64), parameter :: m(5) = [1_int64, 3_int64, 100_int64, 5000_int64, 33333_int64]
      type(window_sums_type) :: found(5), plain(5)
      real(dp), allocatable :: rate(:), phase(:)
      integer(int32), allocatable :: missing(:)
      integer :: i

      allocate (rate, source=normal_series(int(n, int64), 4_int64))
      allocate (phase(0:n), missing(0:n))
      call integrate(rate, spread(1_int8, 1, n), phase, missing)
      call sum_phase_averages(phase, m, found, failure, missing, spread(1.0_dp, 1, size(m)))
      call sum_phase_averages(phase, m, plain, failure)
      call check(error, all(abs(found%squares*real(m, dp)**4/plain%squares - 1) < 1.0e-12_dp), "mdev")
      call check(error, all(abs(found%inflation) <= 0) .and. all(found%terms == n - 3*m + 2), "mdev: terms")
      call sum_windows(phase, m, 2, .true., found, failure, missing, spread(1.0_dp, 1, size(m)))
      call add_reflections(phase, m, found, failure, missing, spread(1.0_dp, 1, size(m)))
      call sum_phase_differences(phase, m, 2, plain%squares, failure)
      call add_reflections(phase, m, plain, failure)
      call check(error, all(abs(found%squares*real(m, dp)**2/plain%squares - 1) < 1.0e-12_dp), "totdev")
      call check(error, all(found%terms == n - 1), "totdev: terms")
      call check(error, all(abs([(complete_weight(int(n, int64), m(i)), i=1, 5)] - found%weight) < 1.0e-8_dp), "totdev: weight")
   end subroutine test_nothing_missing

   !> Mean ratio of the variances with gaps to those of the complete record, over some records.
   subroutine mean_ratio(kind, walk, pattern, runs, ratio)
      character(*), intent(in) :: kind
      !> Random walk, else white noise
      logical, intent(in) :: walk
      !> Of the missing samples
      integer, intent(in) :: pattern, runs
      !> At m = 1, 10, 40, 100: sums of the ones over sums of the others
      real(dp), intent(out) :: ratio(4)

      integer, parameter :: n = 20000
      type(allan_curve_type) :: curve, whole
      type(allan_options) :: options
      real(dp) :: rate(n), top(4), bottom(4)
      integer :: run

      options%kind = kind
      options%taus = "1,10,40,100"
      top = 0
      bottom = 0
      do run = 1, runs
         rate = normal_series(int(n, int64), int(2000 + 17*run, int64))
         if (walk) rate = walk_of(rate, normal_series(int(n, int64), int(77777 + run, int64)))
         call compute_allan(rate, 1.0_dp, options, whole, failure)
         where (presence(n, pattern) == 0) rate = ieee_value(1.0_dp, ieee_quiet_nan)
         if (.not. allocated(failure)) call compute_allan(rate, 1.0_dp, options, curve, failure)
         if (went_wrong(failure, "no curve of "//kind)) return
         top = top + curve%deviation**2
         bottom = bottom + whole%deviation**2
      end do
      ratio = top/bottom
   end subroutine mean_ratio

   subroutine test_white()
      ! unbiased: four standard errors of the ratio, whose squared deviation is about the lost share of 2/edf; without the
      ! correction
      ! 5 % at random would add 5 %
      character(6), parameter :: kinds(2) = ["mdev  ", "totdev"]
      real(dp), parameter :: lost(patterns) = [0.02_dp, 0.10_dp, 0.12_dp]
      integer, parameter :: runs = 8, n = 20000
      real(dp) :: ratio(4), allowed(4)
      integer :: pattern, kind

      do kind = 1, 2
         do pattern = 1, patterns
            call mean_ratio(kinds(kind), .false., pattern, runs, ratio)
            if (allocated(error)) return
            allowed = 4*sqrt(lost(pattern)*2*[1, 10, 40, 100]/(0.7_dp*n*runs))
            call check(error, all(abs(ratio - 1) < allowed), kinds(kind)//": white noise with gaps is biased")
         end do
      end do
   end subroutine test_white

   subroutine test_walk()
      ! a random walk: within 1 % where samples are lost at random (they leave the mean of a window all but as it is); a
      ! gap takes a tenth of the terms, which moves the ratio as white noise's
      character(6), parameter :: kinds(2) = ["mdev  ", "totdev"]
      integer, parameter :: runs = 4, n = 20000
      real(dp) :: ratio(4)
      integer :: pattern, kind

      do kind = 1, 2
         do pattern = 1, patterns
            call mean_ratio(kinds(kind), .true., pattern, runs, ratio)
            if (allocated(error)) return
            if (pattern < 3) then
               call check(error, all(abs(ratio - 1) < [0.03_dp, 0.01_dp, 0.01_dp, 0.01_dp]), kinds(kind)//": random walk")
            else
               call check(error, all(abs(ratio - 1) < 4*sqrt(0.24_dp*[1, 10, 40, 100]/(0.9_dp*n*runs))), kinds(kind)//": gap")
            end if
            if (allocated(error)) return
         end do
      end do
   end subroutine test_walk

   subroutine test_long_gap()
      ! a gap of 10 % takes most terms of a long averaging time, and those near the ends have small expectations: unbiased all the
      ! same in white noise (m = 1000: five standard errors of 200 records with four degrees of freedom), left out at m = 1500
      integer, parameter :: n = 5000, runs = 200
      type(allan_curve_type) :: curve
      type(allan_options) :: options
      real(dp) :: rate(n), mean
      integer :: run

      options%kind = "totdev"
      options%taus = "1000,1500"
      mean = 0
      do run = 1, runs
         rate = normal_series(int(n, int64), int(313*run, int64))
         where (presence(n, 3) == 0) rate = ieee_value(1.0_dp, ieee_quiet_nan)
         call compute_allan(rate, 1.0_dp, options, curve, failure)
         if (unmet(size(curve%m) == 1, "there is a point at m = 1500")) return
         mean = mean + 1000*curve%deviation(1)**2/runs
      end do
      call check(error, abs(mean - 1) < 5*sqrt(2/(4.0_dp*runs)), "white noise with a long gap is biased")
   end subroutine test_long_gap

   subroutine test_strict()
      ! coverage 1: only terms that touch no missing sample; sample 500 of 1000, m = 10: of 972 terms 29 go
      type(allan_curve_type) :: curve
      type(allan_options) :: options
      real(dp) :: rate(1000)

      rate = normal_series(1000_int64, 8_int64)
      rate(500) = ieee_value(1.0_dp, ieee_quiet_nan)
      options%min_coverage = 1
      options%taus = "10"
      options%kind = "mdev"
      call compute_allan(rate, 1.0_dp, options, curve, failure)
      call check(error, curve%terms(1) == 972 - 29, "mdev: terms")
      options%kind = "totdev"
      call compute_allan(rate, 1.0_dp, options, curve, failure)
      call check(error, curve%terms(1) == 999 - 20, "totdev: terms")
      rate(50::150) = rate(500)
      options%kind = "oadev"
      options%taus = "1,10,100"
      call compute_allan(rate, 1.0_dp, options, curve, failure)
      call check(error, size(curve%m) == 2 .and. size(curve%left_out) == 1 .and. all(curve%left_out == 100), "left out")
   end subroutine test_strict

   subroutine test_time_deviation()
      ! tau/sqrt(3) times mdev, also with gaps
      type(allan_curve_type) :: modified, time
      type(allan_options) :: options
      real(dp) :: rate(2000)

      rate = normal_series(2000_int64, 8_int64)
      where (presence(2000, 2) == 0) rate = ieee_value(1.0_dp, ieee_quiet_nan)
      options%kind = "mdev"
      call compute_allan(rate, 0.5_dp, options, modified, failure)
      options%kind = "tdev"
      if (.not. allocated(failure)) call compute_allan(rate, 0.5_dp, options, time, failure)
      if (went_wrong(failure, "a curve is missing")) return
      call check(error, all(abs(time%deviation/(modified%tau*modified%deviation/sqrt(3.0_dp)) - 1) < exact), "tdev")
   end subroutine test_time_deviation

end module test_allan_gaps
