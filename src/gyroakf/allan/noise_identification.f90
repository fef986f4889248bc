! SPDX-License-Identifier: MIT
!> The power-law noise that dominates at an averaging time, by the lag-1 autocorrelation.
!>
!> The rate is averaged over windows of m samples and a straight line is removed. With the lag-1
!> autocorrelation r of these means, rho = r/(1 + r); while rho >= 1/4 the means are differenced (at
!> most as often as the variance does the phase: Allan 2, Hadamard 3), and alpha = -2 rho - 2 d with
!> the number of differences d, rounded.
!> Source: W. J. Riley, C. A. Greenhall, "Power law noise identification using the lag 1
!> autocorrelation", Proc. 18th EFTF (2004). It needs 30 means; beyond that the last identified
!> noise is carried on.
module gyroakf_allan_noise_identification
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_allan_variances, only : window_coverage
   implicit none (type, external)
   private
   public :: identify_noise, means_max

   !> Means that an identification needs
   integer(int64), parameter :: means_min = 30
   !> Means that it looks at, from the middle of the record
   integer(int64), parameter :: means_max = 16384
   !> No exponent
   integer, parameter :: unknown = huge(1)
   !> Records shorter than this are not worth a second thread
   integer(int64), parameter :: parallel_from = 200000

contains

   !> Noise exponent alpha (spectrum of the rate ~ f**alpha, 2 .. -2, -4 with three differences) for
   !> each averaging factor.
   subroutine identify_noise(phase, m, min_coverage, alpha, error, missing, differences)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, ascending
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present, but for scattered losses ([[window_coverage]])
      real(dp), intent(in) :: min_coverage
      !> The exponents: [size(m)]; 0 until one could be identified
      integer, intent(out) :: alpha(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Missing samples so far: [0:n]; none if absent
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      !> Differences at most: 2 (if absent) or 3
      integer, intent(in), optional :: differences

      real(dp), allocatable :: coverage(:)
      integer :: i, most, last, stat, failed

      allocate (coverage(size(m)), stat=stat)
      call check_memory(stat, "the averaging times of a noise identification", error)
      if (allocated(error)) return
      coverage = min_coverage
      if (present(missing)) call window_coverage(missing, m, min_coverage, coverage)
      most = 2
      if (present(differences)) most = differences
      failed = 0
      !$omp parallel do schedule(dynamic) if (ubound(phase, 1, kind=int64) >= parallel_from) &
      !$omp & private(stat) reduction(max: failed)
      do i = 1, size(m)
         ! an absent array is not passed on from inside a parallel region
         if (present(missing)) then
            call identify_one(phase, m(i), coverage(i), most, alpha(i), stat, missing)
         else
            call identify_one(phase, m(i), coverage(i), most, alpha(i), stat)
         end if
         failed = max(failed, abs(stat))
      end do
      !$omp end parallel do
      call check_memory(failed, "the means of a noise identification", error)
      last = 0
      do i = 1, size(m)
         if (alpha(i) == unknown) alpha(i) = last
         last = alpha(i)
      end do
   end subroutine identify_noise

   !> The exponent for one averaging factor.
   pure subroutine identify_one(phase, m, coverage, differences_max, alpha, stat, missing)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m
      real(dp), intent(in) :: coverage
      integer, intent(in) :: differences_max
      !> The exponent; unknown where there are too few windows or nothing varies
      integer, intent(out) :: alpha
      integer, intent(out) :: stat
      integer(int32), intent(in), optional :: missing(0:)

      real(dp), allocatable :: mean(:)
      logical, allocatable :: use_it(:)
      real(dp) :: r, rho
      integer(int64) :: means, d, j
      logical :: varies

      alpha = unknown
      stat = 0
      means = min(ubound(phase, 1, kind=int64)/m, means_max)
      if (means < means_min) return
      rho = 0
      allocate (mean(means), stat=stat)
      if (stat == 0) allocate (use_it(means), stat=stat)
      if (stat /= 0) return
      call window_means(phase, m, coverage, mean(:means), use_it(:means), missing)
      if (count(use_it(:means)) < means_min) return
      call remove_line(mean(:means), use_it(:means))
      do d = 0, differences_max
         call lag_one(mean(:means - d), use_it(:means - d), means_min - differences_max, r, varies)
         if (.not. varies) return
         rho = r/(1 + r)
         if (rho < 0.25_dp) exit
         if (d == differences_max) exit
         do j = 1, means - d - 1
            mean(j) = mean(j + 1) - mean(j)
            use_it(j) = use_it(j) .and. use_it(j + 1)
         end do
      end do
      alpha = min(max(-nint(2*rho) - 2*int(d), 2 - 2*differences_max), 2)
   end subroutine identify_one

   !> Means of adjacent windows around the middle of the record.
   pure subroutine window_means(phase, m, coverage, mean, use_it, missing)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m
      real(dp), intent(in) :: coverage
      real(dp), intent(out) :: mean(:)
      logical, intent(out) :: use_it(:)
      integer(int32), intent(in), optional :: missing(0:)

      integer(int64) :: j, k, there, first

      first = (ubound(phase, 1, kind=int64) - m*size(mean, kind=int64))/2
      do j = 1, size(mean, kind=int64)
         k = first + (j - 1)*m
         there = m
         if (present(missing)) there = m - (missing(k + m) - missing(k))
         use_it(j) = real(there, dp) >= coverage*real(m, dp) - 1e-9_dp .and. there > 0
         mean(j) = 0
         if (use_it(j)) mean(j) = (phase(k + m) - phase(k))/real(there, dp)
      end do
   end subroutine window_means

   !> Removes the least-squares straight line.
   pure subroutine remove_line(y, use_it)
      real(dp), intent(inout) :: y(:)
      logical, intent(in) :: use_it(:)

      real(dp) :: count_y, mean_y, mean_t, slope_top, slope_bottom, t
      integer(int64) :: j

      count_y = real(count(use_it), dp)
      mean_y = sum(y, mask=use_it)/count_y
      mean_t = 0
      do j = 1, size(y, kind=int64)
         if (use_it(j)) mean_t = mean_t + real(j, dp)/count_y
      end do
      slope_top = 0
      slope_bottom = 0
      do j = 1, size(y, kind=int64)
         if (.not. use_it(j)) cycle
         t = real(j, dp) - mean_t
         slope_top = slope_top + t*(y(j) - mean_y)
         slope_bottom = slope_bottom + t*t
      end do
      do j = 1, size(y, kind=int64)
         if (use_it(j)) y(j) = y(j) - mean_y - (real(j, dp) - mean_t)*slope_top/slope_bottom
      end do
   end subroutine remove_line

   !> Lag-1 autocorrelation over neighboring pairs.
   pure subroutine lag_one(y, use_it, least, r, varies)
      real(dp), intent(in) :: y(:)
      logical, intent(in) :: use_it(:)
      integer(int64), intent(in) :: least
      !> The autocorrelation, > -1 and < 1
      real(dp), intent(out) :: r
      logical, intent(out) :: varies

      real(dp) :: mean, products, squares
      integer(int64) :: j, n

      r = 0
      n = size(y, kind=int64)
      varies = count(use_it) >= least
      if (.not. varies) return
      mean = sum(y, mask=use_it)/real(count(use_it), dp)
      squares = sum((y - mean)**2, mask=use_it)
      products = 0
      do j = 1, n - 1
         if (use_it(j) .and. use_it(j + 1)) products = products + (y(j) - mean)*(y(j + 1) - mean)
      end do
      varies = squares > 0
      if (varies) r = min(max(products/squares, -0.9_dp), 0.9_dp)
   end subroutine lag_one

end module gyroakf_allan_noise_identification
