! SPDX-License-Identifier: MIT
!> The disturbances of a simulated record: trend, warm-up, motion, outliers, rounding, losses.
module gyroakf_simulate_disturbance
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_random, only : random_type, next_uniform
   implicit none (type, external)
   private
   public :: add_polynomial, add_warm_up, add_motion, add_outliers, lose_samples

contains

   !> Adds a polynomial in the sample index i = first .. first + n-1.
   pure subroutine add_polynomial(x, coefficient, first)
      !> Series: [n]
      real(dp), intent(inout), contiguous :: x(:)
      !> Coefficients of the powers of i, unit of x: [0:degree]
      real(dp), intent(in) :: coefficient(0:)
      !> Index of x(1), of either sign
      integer(int64), intent(in) :: first
      integer(int64) :: i
      integer :: k
      real(dp) :: value

      do i = 1, size(x, kind=int64)
         value = 0
         do k = ubound(coefficient, 1), 0, -1
            value = value*real(first + i - 1, dp) + coefficient(k)
         end do
         x(i) = x(i) + value
      end do
   end subroutine add_polynomial

   !> Adds a warm-up: \(A e^{-t/T}\) from the sample of index 0 on, the constant A before it.
   pure subroutine add_warm_up(x, amplitude, samples, first)
      !> Series: [n]
      real(dp), intent(inout), contiguous :: x(:)
      !> A, unit of x, of either sign
      real(dp), intent(in) :: amplitude
      !> Time constant T in samples, > 0
      real(dp), intent(in) :: samples
      !> Index of x(1), of either sign
      integer(int64), intent(in) :: first
      integer(int64) :: i

      do i = 1, size(x, kind=int64)
         x(i) = x(i) + amplitude*exp(-max(first + i - 1, 0_int64)/samples)
      end do
   end subroutine add_warm_up

   !> Adds bursts of motion: half sines of one length and height, of random sign, at random places.
   pure subroutine add_motion(x, number, height, samples, random)
      !> Series that the bursts lie in, wholly if it is long enough: [n]; overlaps are added
      real(dp), intent(inout), contiguous :: x(:)
      !> How many, >= 0
      integer(int64), intent(in) :: number
      !> Height, unit of x
      real(dp), intent(in) :: height
      !> Length in samples, > 0
      real(dp), intent(in) :: samples
      !> Where places and signs come from
      type(random_type), intent(inout) :: random
      real(dp), parameter :: pi = 3.14159265358979323846_dp
      integer(int64) :: i, k, place, length
      real(dp) :: u, v

      length = ceiling(min(samples, real(size(x, kind=int64), dp)), int64)
      do k = 1, number
         call next_uniform(random, u)
         call next_uniform(random, v)
         place = int(u*(size(x, kind=int64) - length + 1), int64)
         do i = 1, length
            x(place + i) = x(place + i) + sign(height, v - 0.5_dp)*sin(pi*(i - 0.5_dp)/samples)
         end do
      end do
   end subroutine add_motion

   !> Adds outliers at distinct random places, of random sign, uniform about their mean size.
   !>
   !> The places are drawn by Floyd's method: every set of places is equally likely.
   subroutine add_outliers(x, number, size_in_deviations, spread, random, error)
      !> Series: [n]; its standard deviation about its mean is the measure of the sizes
      real(dp), intent(inout), contiguous :: x(:)
      !> How many, 0 .. n
      integer(int64), intent(in) :: number
      !> Mean size in standard deviations of x, >= 0
      real(dp), intent(in) :: size_in_deviations
      !> Largest relative distance of a size from the mean size
      real(dp), intent(in) :: spread
      !> Where places, signs and sizes come from
      type(random_type), intent(inout) :: random
      !> invalid_argument: x is constant, its standard deviation measures nothing; no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int8), allocatable :: taken(:)
      integer(int64) :: n, last, place
      integer :: stat
      real(dp) :: mean, deviation, u

      n = size(x, kind=int64)
      mean = x(1) + sum(x - x(1))/n
      deviation = sqrt(sum((x - mean)**2)/max(n - 1, 1_int64))
      if (.not. deviation > 0) then
         call fatal_error(error, status%invalid_argument, &
            & "outliers are measured in standard deviations of the noise, and this record has none")
         return
      end if
      allocate (taken(n), source=0_int8, stat=stat)
      call check_memory(stat, "the places of the outliers", error)
      if (allocated(error)) return
      do last = n - number + 1, n
         call next_uniform(random, u)
         place = min(1 + int(u*last, int64), last)
         if (taken(place) == 1) place = last
         taken(place) = 1
         call next_uniform(random, u)
         ! u < 1/2 and u > 1/2 give the signs, its rest 0 .. 1/2 the size
         x(place) = x(place) + &
            sign(size_in_deviations*deviation*(1 - spread + 4*spread*mod(u, 0.5_dp)), u - 0.5_dp)
      end do
   end subroutine add_outliers

   !> Loses every sample with the same probability, independently.
   pure subroutine lose_samples(x, share, random, present)
      !> Series: [n]; 0 where lost
      real(dp), intent(inout), contiguous :: x(:)
      !> Probability, 0 .. 1
      real(dp), intent(in) :: share
      !> Where the decisions come from
      type(random_type), intent(inout) :: random
      !> 1 present, 0 lost: [n]
      integer(int8), intent(out), contiguous :: present(:)
      integer(int64) :: i
      real(dp) :: u

      do i = 1, size(x, kind=int64)
         call next_uniform(random, u)
         present(i) = 1
         if (u < share) then
            present(i) = 0
            x(i) = 0
         end if
      end do
   end subroutine lose_samples

end module gyroakf_simulate_disturbance
