! SPDX-License-Identifier: MIT
!> The level of the noise around each ordinate of a periodogram, whatever lines stand on it.
!>
!> The ordinates are taken in bands; in each the mean of those below five times the level is taken, which a few lines do not
!> enter, and set right for what noise loses by that. Between the middles of the bands the level is drawn straight in logarithms.
!> The bands are as narrow as an octave at low frequencies, so that the red noise of drift is followed.
module gyroakf_series_noise_floor
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   implicit none (type, external)
   private
   public :: noise_floor_type, find_noise_floor, level_of, freedom_of

   !> Level of the noise by bands
   type :: noise_floor_type
      !> Middle of each band (geometric), in ordinates; level there; ordinates that it is the mean of
      real(dp), allocatable :: middle(:), level(:), used(:)
      !> First ordinate of each band, and one behind the last: [bands + 1]
      integer(int64), allocatable :: first(:)
      !> The lowest of the levels
      real(dp) :: lowest = 0.0_dp
   end type noise_floor_type

   !> Ordinates of the first bands, and of the widest
   integer(int64), parameter :: narrowest = 8_int64, widest = 512_int64
   !> A band is at most this part of all ordinates
   integer(int64), parameter :: least_bands = 8_int64
   !> Ordinates above so many times the level are left out; the mean of exponential numbers below it, 1 - c/(exp(c) - 1)
   real(dp), parameter :: cut = 5.0_dp, mean_below = 0.96608140_dp
   !> Median of the exponential distribution
   real(dp), parameter :: median = 0.69314718055994531_dp
   !> Steps of the iteration
   integer, parameter :: steps = 6

   !> Bands between two reports of progress
   integer(int64), parameter :: told_bands = 1024

contains

   !> The level of the noise in a periodogram.
   subroutine find_noise_floor(power, taken, floor, error, progress)
      !> Ordinates, >= 0: [m], m >= 8
      real(dp), intent(in), contiguous :: power(:)
      !> 1: not looked at, for it belongs to a line that is known: [m]
      integer(int8), intent(in), contiguous :: taken(:)
      !> The level
      type(noise_floor_type), intent(out) :: floor
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: band(widest + widest/2 + 1)
      integer(int64) :: b, bands, k
      integer :: n

      call cut_bands(size(power, kind=int64), floor%first)
      bands = size(floor%first, kind=int64) - 1
      allocate (floor%middle(bands), floor%level(bands), floor%used(bands))
      do b = 1, bands
         if (mod(b, told_bands) == 0) call tell_progress("looking for lines", b, bands, error, progress)
         if (allocated(error)) return
         floor%middle(b) = sqrt(real(floor%first(b), dp)*real(floor%first(b + 1) - 1, dp))
         n = 0
         do k = floor%first(b), floor%first(b + 1) - 1
            if (taken(k) /= 0_int8) cycle
            n = n + 1
            band(n) = power(k)
         end do
         call find_level(band(:n), floor%level(b), floor%used(b))
      end do
      call fill_empty(floor)
      floor%lowest = minval(floor%level)
   end subroutine find_noise_floor

   !> First ordinates of the bands: 8, 8, 16, 32, ... ordinates until they are as wide as may be.
   pure subroutine cut_bands(m, first)
      integer(int64), intent(in) :: m
      integer(int64), allocatable, intent(out) :: first(:)
      integer(int64) :: widths, at, bands, pass

      widths = max(narrowest, min(widest, m/least_bands))
      do pass = 1, 2
         bands = 0
         at = 1
         do while (at <= m)
            bands = bands + 1
            if (pass == 2) first(bands) = at
            at = at + min(max(at - 1, narrowest), widths)
            if (m - at + 1 < widths/2) at = m + 1      ! a short rest joins the last band
         end do
         if (pass == 1) allocate (first(bands + 1))
      end do
      first(bands + 1) = m + 1
   end subroutine cut_bands

   !> The mean of the ordinates below five times itself, and how many they are.
   pure subroutine find_level(power, level, used)
      real(dp), intent(in) :: power(:)
      real(dp), intent(out) :: level, used
      real(dp) :: before
      integer :: i, below

      level = 0.0_dp
      used = 0.0_dp
      if (size(power) < 3) return
      level = middle_value(power)/median
      do i = 1, steps
         before = level
         below = count(power < cut*before)
         if (below == 0) exit
         used = real(below, dp)
         level = sum(power, power < cut*before)/used/mean_below
         if (abs(level - before) <= 1.0e-3_dp*level) exit
      end do
   end subroutine find_level

   !> Median of a few numbers: bisected by counting.
   pure real(dp) function middle_value(values) result(middle)
      real(dp), intent(in) :: values(:)
      real(dp) :: low, high
      integer :: i

      low = minval(values)
      high = maxval(values)
      do i = 1, 60
         middle = 0.5_dp*low + 0.5_dp*high
         if (low > 0.0_dp) middle = sqrt(low)*sqrt(high)
         if (2*count(values <= middle) >= size(values)) then
            high = middle
         else
            low = middle
         end if
         if (high <= 1.01_dp*low) exit
      end do
      middle = high
   end function middle_value

   !> A band without ordinates takes the level of its neighbour.
   pure subroutine fill_empty(floor)
      type(noise_floor_type), intent(inout) :: floor
      integer :: b

      do b = 2, size(floor%level)
         if (floor%used(b) > 0.0_dp) cycle
         floor%level(b) = floor%level(b - 1)
         floor%used(b) = floor%used(b - 1)
      end do
      do b = size(floor%level) - 1, 1, -1
         if (floor%used(b) > 0.0_dp) cycle
         floor%level(b) = floor%level(b + 1)
         floor%used(b) = floor%used(b + 1)
      end do
   end subroutine fill_empty

   !> Level of the noise near one ordinate.
   pure real(dp) function level_of(floor, k)
      !> From [[find_noise_floor]]
      type(noise_floor_type), intent(in) :: floor
      !> Ordinate, may lie between two
      real(dp), intent(in) :: k

      level_of = between(floor, band_before(floor, k), k)
   end function level_of

   !> Ordinates that the level near one is the mean of, the fewer of two bands.
   pure real(dp) function freedom_of(floor, k)
      !> From [[find_noise_floor]]
      type(noise_floor_type), intent(in) :: floor
      !> Ordinate, may lie between two
      real(dp), intent(in) :: k
      integer :: b

      b = band_before(floor, k)
      freedom_of = max(min(floor%used(max(b, 1)), floor%used(min(b + 1, size(floor%used)))), 1.0_dp)
   end function freedom_of

   !> The last band whose middle is not above k, 0 where there is none; bisected.
   pure integer function band_before(floor, k) result(low)
      type(noise_floor_type), intent(in) :: floor
      real(dp), intent(in) :: k
      integer :: high, b

      low = 0
      high = size(floor%middle) + 1
      do while (high - low > 1)
         b = (low + high)/2
         if (floor%middle(b) <= k) then
            low = b
         else
            high = b
         end if
      end do
   end function band_before

   !> Straight in logarithms from middle b to the next.
   pure real(dp) function between(floor, b, k) result(level)
      type(noise_floor_type), intent(in) :: floor
      integer, intent(in) :: b
      real(dp), intent(in) :: k
      integer :: bands
      real(dp) :: share

      bands = size(floor%level)
      level = floor%level(min(max(b, 1), bands))
      if (b < 1 .or. b >= bands) return
      if (.not. (floor%level(b) > 0.0_dp .and. floor%level(b + 1) > 0.0_dp)) return
      share = log(k/floor%middle(b))/log(floor%middle(b + 1)/floor%middle(b))
      level = floor%level(b)*(floor%level(b + 1)/floor%level(b))**share
   end function between

end module gyroakf_series_noise_floor
