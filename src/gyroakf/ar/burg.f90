! SPDX-License-Identifier: MIT
!> AR models of every order by Burg's recursion: a lattice of forward and backward residuals.
!>
!> The residuals take 16 bytes a sample and one pass an order. b_m(t) is held in the place t - m. A
!> step from order m-1 to m then changes f and b in place, element by element; a block is updated
!> and summed for the next order while it is in the cache. A residual that has no partner, at the
!> ends of a stretch without gaps, is set to 0 before it is summed: sums go over everything.
module gyroakf_ar_burg
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_chunks, only : chunk_count, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_stats_lagged_products, only : detrended_block
   use gyroakf_stats_trend, only : trend_type
   implicit none (type, external)
   private
   public :: burg_type, compute_burg

   !> Samples of a block: f and b of it, 16 kB
   integer(int64), parameter :: block = 1024

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

   !> Residuals of order m, and the sums that the next one needs
   type, extends(chunk_sums_type) :: lattice_type
      !> Mean of the series
      type(trend_type) :: level
      !> m; -1 before the first order
      integer :: order = -1
      !> k_m, from order 1 on
      real(dp) :: reflection = 0.0_dp
      !> f_m(t) in t, b_m(t) in t - m; 0 where a stretch has none or its partner is missing: [n]
      real(dp), allocatable :: f(:), b(:)
   contains
      procedure :: add => add_order
   end type lattice_type

contains

   !> Burg's recursion over a series about its mean.
   !>
   !> $$k_m = \frac{2\sum_t f_{m-1}(t) b_{m-1}(t-1)}{\sum_t f_{m-1}(t)^2 + b_{m-1}(t-1)^2}, \quad
   !> f_m(t) = f_{m-1}(t) - k_m b_{m-1}(t-1), \quad b_m(t) = b_{m-1}(t-1) - k_m f_{m-1}(t)$$ over
   !> t = m .. n-1, from f_0 = b_0 = x; always stationary. With gaps the sums go over all stretches
   !> that are long enough: de Waele & Broersen, IEEE Trans. Signal Process. 48 (2000)
   !> 2876-2880. Source: Burg, Maximum entropy spectral analysis, 37th SEG meeting (1967).
   subroutine compute_burg(x, level, order, burg, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean
      type(trend_type), intent(in) :: level
      !> Largest order p, 0 .. n-1
      integer, intent(in) :: order
      !> The models
      type(burg_type), intent(out) :: burg
      !> constant_input, singular (perfect prediction), too_few_samples (no row), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(lattice_type) :: lattice
      real(dp) :: total(3)
      integer(int64) :: n, begin
      integer :: m, chunk, stat

      n = size(x, kind=int64)
      allocate (burg%reflection(order), stat=stat)
      if (stat == 0) allocate (burg%variance(0:order), stat=stat)
      if (stat == 0) allocate (burg%residual_variance(0:order), stat=stat)
      if (stat == 0) allocate (burg%rows(0:order), stat=stat)
      if (stat == 0) allocate (burg%r(0:order), stat=stat)
      if (stat == 0) allocate (burg%phi(order, order), stat=stat)
      if (stat == 0) allocate (lattice%f(n), stat=stat)
      if (stat == 0) allocate (lattice%b(n), stat=stat)
      call check_memory(stat, "the residuals of Burg's recursion, 16 bytes a sample", error)
      if (allocated(error)) return
      burg%phi = 0.0_dp
      burg%reflection = 0.0_dp
      lattice%level = level
      call sum_chunks(lattice, x, n, "AR model", total, error, valid, progress, [1, order + 1])
      if (allocated(error)) return
      burg%r(0) = total(2)/total(3)
      burg%variance(0) = burg%r(0)
      burg%residual_variance(0) = burg%r(0)
      burg%rows(0) = nint(total(3), int64)
      if (.not. burg%r(0) > 0.0_dp) call fatal_error(error, status%constant_input, &
         & "the series has no variance, no AR model describes it")
      do m = 1, order
         if (allocated(error)) return
         lattice%order = m - 1
         call sum_chunks(lattice, x, n, "AR model", total, error, valid, progress, &
            & [m + 1, order + 1])
         if (allocated(error)) return
         do chunk = 2, chunk_count(n)       ! first samples: their partners are in the chunk before
            begin = chunk_first(n, chunk)
            if (begin > m) call add_products(lattice%f(begin:begin), &
               & lattice%b(begin - m:begin - m), total)
         end do
         call take_order(burg, m, total, error)
         lattice%reflection = burg%reflection(m)
      end do
   end subroutine compute_burg

   !> The next order from the sums of its residuals: sum f_m(t) b_m(t-1), sum f_m(t)^2 + b_m(t-1)^2
   !> where both are, and their number.
   subroutine take_order(burg, m, total, error)
      type(burg_type), intent(inout) :: burg
      integer, intent(in) :: m
      real(dp), intent(in) :: total(3)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: k, power
      character(160) :: text

      power = total(2)
      burg%rows(m) = nint(total(3), int64)
      if (burg%rows(m) < 1) then
         write (text, '("the gaps leave no ", i0, " samples in a row for AR(", i0, ")")') m + 1, m
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      k = 0.0_dp
      if (power > 0.0_dp) k = 2.0_dp*total(1)/power
      burg%reflection(m) = k
      associate (phi => burg%phi(:, max(m - 1, 1)))
         burg%r(m) = k*burg%variance(m - 1) + dot_product(phi(:m - 1), burg%r(m - 1:1:-1))
         burg%phi(:m - 1, m) = phi(:m - 1) - k*phi(m - 1:1:-1)
      end associate
      burg%phi(m, m) = k
      burg%variance(m) = burg%variance(m - 1)*((1.0_dp - k)*(1.0_dp + k))
      burg%residual_variance(m) = power*((1.0_dp - k)*(1.0_dp + k))/(2.0_dp*total(3))
      if (.not. (power > 0.0_dp .and. burg%variance(m) > epsilon(k)*burg%variance(0))) then
         write (text, "(a, i0, 2(a, es10.3))") &
            & "Burg's recursion predicts the series exactly at order ", m, ": variance ", &
            & max(burg%variance(m), 0.0_dp), " of ", burg%variance(0)
         call fatal_error(error, status%singular, trim(text))
      end if
   end subroutine take_order

   !> Loads a chunk, or steps to the order in it; sums all but the first sample's part.
   subroutine add_order(self, x, n, chunk, total, stat, valid)
      class(lattice_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: first, last, begin, start, finish, m

      stat = 0
      first = chunk_first(n, chunk)
      last = chunk_last(n, chunk)
      m = self%order
      if (m < 0) then
         call detrended_block(x, self%level, first, self%f(first:last), self%b(first:last), valid)
         total(3) = sum(self%b(first:last))
         self%b(first:last) = self%f(first:last)
         total(2) = dot_product(self%f(first:last), self%f(first:last))
         return
      end if
      begin = max(first, m + 1)
      do start = begin, last, block
         finish = min(start + block - 1, last)
         if (m > 0) call step(self%reflection, self%f(start:finish), self%b(start - m:finish - m))
         if (present(valid)) then
            call drop_partnerless(self, start, finish, total(3), valid)
         else
            total(3) = total(3) + real(finish - max(start, m + 2) + 1, dp)
         end if
         if (start > begin) then
            call add_products(self%f(start:finish), self%b(start - m - 1:finish - m - 1), total)
         else
            call add_products(self%f(start + 1:finish), self%b(start - m:finish - m - 1), total)
         end if
      end do
   end subroutine add_order

   !> Residuals of a block of the next order.
   pure subroutine step(k, f, b)
      real(dp), intent(in) :: k
      real(dp), intent(inout), contiguous :: f(:), b(:)
      real(dp) :: forward
      integer :: i

      !$omp simd private(forward)
      do i = 1, size(f)
         forward = f(i)
         f(i) = forward - k*b(i)
         b(i) = b(i) - k*forward
      end do
   end subroutine step

   !> Adds sum f b and sum f^2 + b^2.
   pure subroutine add_products(f, b, total)
      real(dp), intent(in), contiguous :: f(:), b(:)
      real(dp), intent(inout) :: total(:)
      real(dp) :: cross, power
      integer :: i

      cross = 0.0_dp
      power = 0.0_dp
      !$omp simd reduction(+:cross, power)
      do i = 1, size(f)
         cross = cross + f(i)*b(i)
         power = power + (f(i)*f(i) + b(i)*b(i))
      end do
      total(1) = total(1) + cross
      total(2) = total(2) + power
   end subroutine add_products

   !> Sets the first f and the last b of every stretch to 0, counts the rows that have both.
   pure subroutine drop_partnerless(lattice, first, last, rows, valid)
      class(lattice_type), intent(inout) :: lattice
      integer(int64), intent(in) :: first, last
      real(dp), intent(inout) :: rows
      integer(int8), intent(in) :: valid(:)
      integer(int64) :: t, run, m

      m = lattice%order
      run = 0
      do t = first - 1, max(1_int64, first - m - 1), -1
         if (valid(t) == 0_int8) exit
         run = run + 1
      end do
      do t = first, last
         run = run + 1
         if (valid(t) == 0_int8) run = 0
         if (run == m + 1) lattice%f(t) = 0.0_dp
         if (run > m + 1) rows = rows + 1.0_dp
         if (t == size(valid, kind=int64)) cycle
         if (valid(t + 1) == 0_int8) lattice%b(t - m) = 0.0_dp
      end do
   end subroutine drop_partnerless

end module gyroakf_ar_burg
