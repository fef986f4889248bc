! SPDX-License-Identifier: MIT
!> The power-law noise of a record that streams by: the method of [[identify_noise]] from running sums.
!>
!> Of the means u_j of adjacent windows, and of their first and second differences, the sums of u, u^2, u_j u_(j+1) and, for
!> the straight line that is removed from the means, of j u are kept: a fixed number of sums whatever the length of the record.
module gyroakf_allan_stream_lags
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: lag_sums_type, add_window, break_windows, identify_from_sums

   !> Means that an identification needs
   real(dp), parameter :: means_min = 30.0_dp
   !> Differences at most
   integer, parameter :: differences_max = 2

   !> Sums over the windows of one averaging factor; index: number of differences
   type :: lag_sums_type
      !> The last value of each order, and whether it is there
      real(dp) :: last(0:differences_max) = 0.0_dp
      logical :: there(0:differences_max) = .false.
      !> Number of values, sum, sum of squares
      real(dp), dimension(0:differences_max) :: count = 0.0_dp, first = 0.0_dp, square = 0.0_dp
      !> Number of neighbouring pairs, sum of both members, sum of products
      real(dp), dimension(0:differences_max) :: pairs = 0.0_dp, pair = 0.0_dp, product = 0.0_dp
      !> Of the means: sums of j, j^2 and j u; over pairs of 2j + 1, j(j + 1) and (j + 1) u_j + j u_(j+1)
      real(dp) :: t = 0.0_dp, tt = 0.0_dp, tu = 0.0_dp, pair_t = 0.0_dp, pair_tt = 0.0_dp, pair_tu = 0.0_dp
   end type lag_sums_type

contains

   !> Adds the mean of the next window.
   pure subroutine add_window(sums, j, u, complete)
      !> What is added to
      type(lag_sums_type), intent(inout) :: sums
      !> Number of the window
      integer(int64), intent(in) :: j
      !> Its mean, less a constant that is the same for all
      real(dp), intent(in) :: u
      !> The window is complete enough to count
      logical, intent(in) :: complete

      real(dp) :: value, before, t
      logical :: there, had
      integer :: d

      value = u
      there = complete
      t = real(j, dp)
      if (there) then
         sums%t = sums%t + t
         sums%tt = sums%tt + t*t
         sums%tu = sums%tu + t*u
         if (sums%there(0)) then
            sums%pair_t = sums%pair_t + (2*t - 1)
            sums%pair_tt = sums%pair_tt + t*(t - 1)
            sums%pair_tu = sums%pair_tu + (t*sums%last(0) + (t - 1)*u)
         end if
      end if
      do d = 0, differences_max
         before = sums%last(d)
         had = sums%there(d)
         if (there) then
            sums%count(d) = sums%count(d) + 1
            sums%first(d) = sums%first(d) + value
            sums%square(d) = sums%square(d) + value**2
            if (had) then
               sums%pairs(d) = sums%pairs(d) + 1
               sums%pair(d) = sums%pair(d) + (before + value)
               sums%product(d) = sums%product(d) + before*value
            end if
         end if
         sums%last(d) = value
         sums%there(d) = there
         there = there .and. had
         value = value - before
      end do
   end subroutine add_window

   !> The next window does not follow the last one.
   pure subroutine break_windows(sums)
      !> Its last values are forgotten
      type(lag_sums_type), intent(inout) :: sums

      sums%there = .false.
   end subroutine break_windows

   !> The exponent; left alone where there are too few windows or nothing varies.
   pure subroutine identify_from_sums(sums, alpha)
      !> All windows of one averaging factor
      type(lag_sums_type), intent(in) :: sums
      !> 2 .. -2
      integer, intent(inout) :: alpha

      real(dp) :: squares, products, r, rho
      integer :: d

      if (sums%count(0) < means_min) return
      rho = 0
      do d = 0, differences_max
         if (sums%count(d) < means_min - differences_max) return
         call centred(sums, d, squares, products)
         if (squares <= 0) return
         r = min(max(products/squares, -0.9_dp), 0.9_dp)
         rho = r/(1 + r)
         if (rho < 0.25_dp .or. d == differences_max) exit
      end do
      alpha = min(max(-nint(2*rho) - 2*d, 2 - 2*differences_max), 2)
   end subroutine identify_from_sums

   !> Sums of squares and of lagged products about the straight line (the means) or about their mean (the differences).
   pure subroutine centred(sums, d, squares, products)
      !> All windows
      type(lag_sums_type), intent(in) :: sums
      !> Number of differences
      integer, intent(in) :: d
      !> The two sums
      real(dp), intent(out) :: squares, products

      real(dp) :: a, b, bottom

      a = sums%first(d)/sums%count(d)
      b = 0
      if (d == 0) then
         bottom = sums%tt - sums%t**2/sums%count(0)
         if (bottom > 0) b = (sums%tu - sums%t*a)/bottom
         a = a - b*sums%t/sums%count(0)
      end if
      squares = sums%square(d) - 2*a*sums%first(d) + sums%count(d)*a**2
      products = sums%product(d) - a*sums%pair(d) + sums%pairs(d)*a**2
      if (d > 0) return
      squares = squares - 2*b*sums%tu + 2*a*b*sums%t + b**2*sums%tt
      products = products - b*sums%pair_tu + a*b*sums%pair_t + b**2*sums%pair_tt
   end subroutine centred

end module gyroakf_allan_stream_lags
