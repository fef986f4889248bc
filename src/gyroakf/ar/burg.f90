! SPDX-License-Identifier: MIT
!> AR models of every order by Burg's recursion.
!>
!> Two ways to the same reflection coefficients:
!>
!> - the lattice holds forward and backward residuals, 16 bytes a sample, and passes over them once an order: a block is
!>   updated and multiplied for the next order while it is in the cache;
!> - a long series without gaps needs its autocovariances alone: the sums of an order are quadratic forms of them, less the
!>   products at the two ends, which is exact. Rounding grows with (sum |a_j|)^2 r_0/s, known on the way: where it could
!>   reach the 12th digit the lattice is taken.
module gyroakf_ar_burg
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_burg_lattice, only : burg_lattice_type, begin_lattice, next_order
   implicit none (type, external)
   private
   public :: burg_type, compute_burg

   !> Autocovariances serve from so many samples, and so many an order, on, and up to this growth of rounding
   integer(int64), parameter :: long_series = 20000, samples_an_order = 100
   real(dp), parameter :: most_growth = 1000.0_dp

   !> Models of the orders 0 .. p
   type :: burg_type
      !> Reflection coefficients: [p]
      real(dp), allocatable :: reflection(:)
      !> Coefficients: [p, p]; column m holds the AR(m) model in its rows 1 .. m, 0 below
      real(dp), allocatable :: phi(:, :)
      !> Variances of the noise by Levinson's recursion, r_0 prod (1 - k^2): [0:p]
      real(dp), allocatable :: variance(:)
      !> Mean squares of the forward and backward residuals: [0:p]
      real(dp), allocatable :: residual_variance(:)
      !> Pairs of a forward and a backward residual of each order: [0:p]
      integer(int64), allocatable :: rows(:)
      !> Autocovariances that the model of order p has: [0:p]
      real(dp), allocatable :: r(:)
   end type burg_type

contains

   !> Burg's recursion over a series about its mean.
   !>
   !> $$k_m = \frac{2\sum_t f_{m-1}(t) b_{m-1}(t-1)}{\sum_t f_{m-1}(t)^2 + b_{m-1}(t-1)^2}, \quad
   !> f_m(t) = f_{m-1}(t) - k_m b_{m-1}(t-1), \quad b_m(t) = b_{m-1}(t-1) - k_m f_{m-1}(t)$$
   !> over t = m .. n-1, from f_0 = b_0 = x; always stationary. With gaps the sums go over the t of every stretch that is long
   !> enough, with one k_m for all: de Waele & Broersen, IEEE Trans. Signal Process. 48 (2000) 2876-2880. Source: Burg, Maximum
   !> entropy spectral analysis, 37th SEG meeting (1967); the quadratic forms: Vos, A fast implementation of Burg's method (2013).
   subroutine compute_burg(x, shift, rest, order, burg, error, valid, r, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean, in two parts that are subtracted in turn
      real(dp), intent(in) :: shift, rest
      !> Largest order p, 0 .. n-1
      integer, intent(in) :: order
      !> The models
      type(burg_type), intent(out) :: burg
      !> constant_input, singular (perfect prediction), too_few_samples (the gaps leave no row), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Biased autocovariances, for whoever has them: [0:order]; without them, and with gaps, the lattice is taken
      real(dp), intent(in), optional :: r(0:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: n
      integer :: stat
      logical :: done

      n = size(x, kind=int64)
      allocate (burg%phi(order, order), stat=stat)
      if (stat == 0) allocate (burg%reflection(order), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the AR coefficients of every order")
         return
      end if
      allocate (burg%variance(0:order), burg%residual_variance(0:order), burg%rows(0:order), burg%r(0:order))
      burg%phi = 0.0_dp
      burg%reflection = 0.0_dp
      done = .false.
      if (present(r) .and. .not. present(valid) .and. n >= long_series .and. n >= samples_an_order*order) then
         call by_autocovariances(x, shift, rest, r(0:order), burg, done, error)
         if (allocated(error)) return
      end if
      if (.not. done) call by_lattice(x, shift, rest, burg, error, valid, progress)
   end subroutine compute_burg

   !> Order by order over stored residuals.
   subroutine by_lattice(x, shift, rest, burg, error, valid, progress)
      !> Series and its mean
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> The models
      type(burg_type), intent(inout) :: burg
      !> As of [[compute_burg]]
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(burg_lattice_type) :: lattice
      real(dp) :: reflection, cross, power
      integer :: m

      call begin_lattice(x, shift, rest, lattice, error, valid, progress)
      if (allocated(error)) return
      call begin_orders(burg, lattice%power/real(lattice%samples, dp), lattice%samples, error)
      if (allocated(error)) return
      lattice%orders = size(burg%reflection)
      do m = 1, size(burg%reflection)
         reflection = 0.0_dp
         if (m > 1) reflection = burg%reflection(m - 1)
         call next_order(lattice, reflection, cross, power, error, valid, progress)
         if (.not. allocated(error)) call add_order(burg, m, cross, power, lattice%rows, error)
         if (allocated(error)) return
      end do
   end subroutine by_lattice

   !> Order 0.
   subroutine begin_orders(burg, r0, samples, error)
      !> The models
      type(burg_type), intent(inout) :: burg
      !> Variance of the series, divisor n
      real(dp), intent(in) :: r0
      !> Present samples
      integer(int64), intent(in) :: samples
      !> constant_input
      type(error_type), allocatable, intent(out) :: error

      burg%variance(0) = r0
      burg%residual_variance(0) = r0
      burg%rows(0) = samples
      burg%r(0) = r0
      if (.not. r0 > 0.0_dp) then
         call fatal_error(error, status%constant_input, "the series has no variance, no AR model describes it")
      end if
   end subroutine begin_orders

   !> The next order from the sums of its residuals.
   subroutine add_order(burg, m, cross, power, rows, error)
      !> The models up to order m-1
      type(burg_type), intent(inout) :: burg
      !> Order
      integer, intent(in) :: m
      !> sum f b, sum f^2 + b^2
      real(dp), intent(in) :: cross, power
      !> How many pairs
      integer(int64), intent(in) :: rows
      !> too_few_samples, singular
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: k
      integer :: j
      character(160) :: text

      if (rows < 1) then
         write (text, '("the gaps leave no ", i0, " samples in a row for AR(", i0, ")")') m + 1, m
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      k = 0.0_dp
      if (power > 0.0_dp) k = 2.0_dp*cross/power
      burg%reflection(m) = k
      burg%r(m) = k*burg%variance(m - 1)
      do j = 1, m - 1
         burg%r(m) = burg%r(m) + burg%phi(j, m - 1)*burg%r(m - j)
         burg%phi(j, m) = burg%phi(j, m - 1) - k*burg%phi(m - j, m - 1)
      end do
      burg%phi(m, m) = k
      burg%variance(m) = burg%variance(m - 1)*((1.0_dp - k)*(1.0_dp + k))
      burg%residual_variance(m) = power*((1.0_dp - k)*(1.0_dp + k))/(2.0_dp*real(rows, dp))
      burg%rows(m) = rows
      if (.not. (power > 0.0_dp .and. burg%variance(m) > epsilon(k)*burg%variance(0))) then
         write (text, '("Burg''s recursion predicts the series exactly at order ", i0, ": variance ", es10.3, " of ", es10.3)') &
            & m, max(burg%variance(m), 0.0_dp), burg%variance(0)
         call fatal_error(error, status%singular, trim(text))
      end if
   end subroutine add_order

   !> One pass for all orders, where rounding allows.
   subroutine by_autocovariances(x, shift, rest, r, burg, done, error)
      !> Series and its mean
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> Its autocovariances
      real(dp), intent(in) :: r(0:)
      !> The models
      type(burg_type), intent(inout) :: burg
      !> .false.: the lattice is needed
      logical, intent(out) :: done
      !> As of [[compute_burg]]
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: s(0:size(burg%reflection)), a(0:size(burg%reflection)), cross, power
      integer(int64) :: n
      integer :: m, p

      n = size(x, kind=int64)
      p = size(burg%reflection)
      done = .false.
      call begin_orders(burg, r(0), n, error)
      if (allocated(error)) return
      s = r*real(n, dp)
      a(0) = 1.0_dp
      do m = 1, p
         if (m > 1) a(1:m - 1) = -burg%phi(:m - 1, m - 1)
         call quadratic_forms(x, shift, rest, s, a(0:m - 1), m, cross, power)
         if (.not. sum(abs(a(0:m - 1)))**2*s(0) < most_growth*power) return
         call add_order(burg, m, cross, power, n - m, error)
         if (allocated(error)) then
            deallocate (error)
            return
         end if
      end do
      done = .true.
   end subroutine by_autocovariances

   !> sum f b and sum f^2 + b^2 of the residuals of order m-1.
   !>
   !> f_(m-1)(t) = sum_i a_i x_(t-i), b_(m-1)(t-1) = sum_i a_i x_(t-m+i), t = m .. n-1. Over all t that there are both powers
   !> and the cross product are sums of a_i a_j S_|..|; the t < m and t >= n that the series does not have are sums over its ends.
   subroutine quadratic_forms(x, shift, rest, s, a, m, cross, power)
      !> Series and its mean
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> sum x_t x_(t-k) over the t that exist: [0:p]
      real(dp), intent(in) :: s(0:)
      !> Prediction error filter of order m-1: [0:m-1], a(0) = 1
      integer, intent(in) :: m
      real(dp), intent(in) :: a(0:m - 1)
      !> The sums
      real(dp), intent(out) :: cross, power
      real(dp) :: head(0:m - 1), tail(0:m - 1), f, b
      integer(int64) :: n
      integer :: i, j, t

      n = size(x, kind=int64)
      head = (x(1:m) - shift) - rest
      tail = (x(n:n - m + 1:-1) - shift) - rest
      cross = 0.0_dp
      power = 0.0_dp
      do j = 0, m - 1
         do i = 0, m - 1
            cross = cross + a(i)*a(j)*s(abs(m - j - i))
            power = power + 2.0_dp*a(i)*a(j)*s(abs(i - j))
         end do
      end do
      do t = 0, m - 1                    ! rows before the first and after the last one, x being 0 outside
         f = dot_product(a(0:t), head(t:0:-1))
         b = dot_product(a(m - t:m - 1), head(0:t - 1))
         power = power - f*f - b*b
         cross = cross - f*b
         f = dot_product(a(m - t:m - 1), tail(0:t - 1))
         b = dot_product(a(0:t), tail(t:0:-1))
         power = power - f*f - b*b
         cross = cross - f*b
      end do
   end subroutine quadratic_forms

end module gyroakf_ar_burg
