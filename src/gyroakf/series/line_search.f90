! SPDX-License-Identifier: MIT
!> The periodogram in which lines are sought: its largest ordinate against the noise around, and how far a line reaches.
!>
!> Ordinates half way between two of the transform are taken from their difference, $$|X_k - X_{k+1}|^2/2,$$ which a line in the
!> middle loses little of and which has the same distribution in noise.
module gyroakf_series_line_search
   use, intrinsic :: iso_c_binding, only : c_double
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_series_noise_floor, only : noise_floor_type, find_noise_floor, level_of, freedom_of
   implicit none (type, external)
   private
   public :: search_type, begin_search, look_at, find_largest, find_extent, forbid, log_any

   !> Periods that a line has at least in the series; and ordinates that it keeps from half the sample rate
   integer(int64), parameter :: fewest_periods = 5_int64, from_end = 2_int64
   !> An ordinate below so many times the noise is no line, whatever the length
   real(dp), parameter :: least_ratio = 6.0_dp
   !> Ordinates on either side that belong to every line
   integer(int64), parameter :: guard = 2_int64
   !> A line goes on while the next so many ordinates have this mean over the noise
   integer(int64), parameter :: run = 9_int64
   real(dp), parameter :: goes_on = 2.0_dp
   !> What a sinusoid leaves in its five ordinates is more than noise above this mean
   real(dp), parameter :: left_over = 3.0_dp
   !> A line is at most this part of all ordinates
   integer(int64), parameter :: widest_part = 16_int64

   !> What has less than this part of the power of the largest ordinate at all is rounding
   real(dp), parameter :: rounding = 1.0e-18_dp

   !> The periodogram of what is left
   type :: search_type
      !> Samples n and ordinates m
      integer(int64) :: samples = 0, ordinates = 0
      !> Ordinates: [m]
      real(dp), allocatable :: power(:)
      !> 1: belongs to a line that was found: [m]
      integer(int8), allocatable :: taken(:)
      !> Noise
      type(noise_floor_type) :: floor
      !> Smaller ordinates are rounding
      real(dp) :: negligible = 0.0_dp
   end type search_type

   interface
      !> ln(1 + x) of the C library, accurate for small x
      pure function log1p(x) bind(c, name="log1p")
         import :: c_double
         implicit none (type, external)
         real(c_double), intent(in), value :: x
         real(c_double) :: log1p
      end function log1p
   end interface

   !> Ordinates less one between two reports of progress: a power of two less one
   integer(int64), parameter :: told_ordinates = 131071_int64

contains

   !> Prepares for a series of n samples.
   subroutine begin_search(search, n, error)
      !> Fresh afterwards
      type(search_type), intent(out) :: search
      !> >= 32
      integer(int64), intent(in) :: n
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer :: stat

      search%samples = n
      search%ordinates = (n - 1)/2
      allocate (search%power(search%ordinates), stat=stat)
      if (stat == 0) allocate (search%taken(search%ordinates), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the periodogram")
         return
      end if
      search%taken = 0_int8
   end subroutine begin_search

   !> Takes a spectrum: ordinates, and the noise around them.
   subroutine look_at(search, spectrum, error, progress)
      !> Of the beginning
      type(search_type), intent(inout) :: search
      !> Fourier transform of the series: [0:n/2]
      complex(dp), intent(in), contiguous :: spectrum(0:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: k

      do k = 1, search%ordinates
         search%power(k) = real(spectrum(k), dp)**2 + aimag(spectrum(k))**2
      end do
      search%negligible = max(search%negligible, rounding*maxval(search%power))
      call find_noise_floor(search%power, search%taken, search%floor, error, progress)
   end subroutine look_at

   !> The ordinate that noise explains worst.
   subroutine find_largest(search, spectrum, place, ratio, log_p, error, progress)
      !> After [[look_at]]
      type(search_type), intent(in) :: search
      !> The same
      complex(dp), intent(in), contiguous :: spectrum(0:)
      !> Its number, k or k + 1/2; 0: none is above the noise
      real(dp), intent(out) :: place
      !> Over the level of the noise
      real(dp), intent(out) :: ratio
      !> Logarithm of the probability that noise has as large a one anywhere
      real(dp), intent(out) :: log_p
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: k, last
      real(dp) :: best, half

      place = 0.0_dp
      ratio = 0.0_dp
      log_p = 0.0_dp
      best = 0.0_dp
      last = search%ordinates - from_end
      do k = fewest_periods, last
         if (iand(k, told_ordinates) == 0) call tell_progress("looking for lines", k, last, error, progress)
         if (allocated(error)) return
         if (search%taken(k) /= 0_int8) cycle
         call compare(search, search%power(k), real(k, dp), place, ratio, best)
         if (k == last .or. search%taken(k + 1) /= 0_int8) cycle
         half = 0.5_dp*((real(spectrum(k), dp) - real(spectrum(k + 1), dp))**2 + (aimag(spectrum(k)) - aimag(spectrum(k + 1)))**2)
         call compare(search, half, real(k, dp) + 0.5_dp, place, ratio, best)
      end do
      log_p = log_any(best, real(max(2*(last - fewest_periods) + 1, 1_int64), dp))
   end subroutine find_largest

   !> Takes an ordinate where it is less probable than the best so far.
   pure subroutine compare(search, power, at, place, ratio, best)
      type(search_type), intent(in) :: search
      real(dp), intent(in) :: power, at
      real(dp), intent(inout) :: place, ratio
      !> Logarithm of the probability that noise alone is as large there
      real(dp), intent(inout) :: best
      real(dp) :: level, freedom, over, log_one

      if (power < least_ratio*search%floor%lowest .or. power <= search%negligible) return
      level = max(level_of(search%floor, at), search%negligible*1.0e-30_dp)
      if (power < least_ratio*level) return
      freedom = freedom_of(search%floor, at)
      over = power/level
      log_one = -freedom*log1p(over/freedom)
      if (log_one >= best) return
      best = log_one
      place = at
      ratio = over
   end subroutine compare

   !> Logarithm of 1 - (1 - p)^m, the probability that one of m happens.
   pure real(dp) function log_any(log_p, m)
      !> Logarithm of p, <= 0
      real(dp), intent(in) :: log_p
      !> Number, >= 1
      real(dp), intent(in) :: m
      real(dp) :: log_none

      log_any = min(log_p + log(m), 0.0_dp)
      if (log_any < -20.0_dp .or. .not. log_p < 0.0_dp) return
      log_none = m*log1p(-exp(log_p))
      if (log_none > -700.0_dp) log_any = log(max(1.0_dp - exp(log_none), tiny(m)))
      if (log_none <= -700.0_dp) log_any = 0.0_dp
   end function log_any

   !> An ordinate and its neighbour that no sinusoid explains are not looked at again.
   pure subroutine forbid(search, place)
      !> Its `taken` changes
      type(search_type), intent(inout) :: search
      !> k or k + 1/2
      real(dp), intent(in) :: place

      search%taken(floor(place)) = 1_int8
      search%taken(ceiling(place)) = 1_int8
   end subroutine forbid

   !> How far a line reaches that was subtracted: its ordinates are not looked at again.
   pure subroutine find_extent(search, place, noise, excess, width, steady)
      !> Of what is left
      type(search_type), intent(inout) :: search
      !> Frequency in ordinates
      real(dp), intent(in) :: place
      !> Level of the noise there
      real(dp), intent(out) :: noise
      !> Sum of the ordinates above the noise, where the line is not steady; else 0
      real(dp), intent(out) :: excess
      !> Width in ordinates; 1 where steady
      real(dp), intent(out) :: width
      !> The sinusoid left nothing
      logical, intent(out) :: steady
      integer(int64) :: from, to, k, m

      m = search%ordinates
      noise = level_of(search%floor, place)
      from = max(nint(place, int64) - guard, 1_int64)
      to = min(nint(place, int64) + guard, m)
      steady = sum(search%power(from:to)) <= left_over*noise*real(to - from + 1, dp)
      excess = 0.0_dp
      width = 1.0_dp
      if (.not. steady) then
         do while (to < m .and. to - from < m/widest_part)
            if (mean_over(search, to + 1, min(to + run, m)) <= goes_on) exit
            to = to + 1
         end do
         do while (from > 1 .and. to - from < m/widest_part)
            if (mean_over(search, max(from - run, 1_int64), from - 1) <= goes_on) exit
            from = from - 1
         end do
         do k = from, to
            excess = excess + search%power(k) - level_of(search%floor, real(k, dp))
         end do
         excess = max(excess, 0.0_dp)
         width = real(to - from + 1, dp)
      end if
      search%taken(from:to) = 1_int8
   end subroutine find_extent

   !> Mean of some ordinates over the noise.
   pure real(dp) function mean_over(search, from, to)
      type(search_type), intent(in) :: search
      integer(int64), intent(in) :: from, to

      mean_over = sum(search%power(from:to))/real(to - from + 1, dp) &
                  /max(level_of(search%floor, 0.5_dp*real(from + to, dp)), tiny(mean_over))
   end function mean_over

end module gyroakf_series_line_search
