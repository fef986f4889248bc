! SPDX-License-Identifier: MIT
!> AR models of every order by Burg's recursion: a lattice of forward and backward residuals.
!>
!> The residuals take 16 bytes a sample and one pass an order. b_m(t) is held in the place t - m. A
!> step from order m-1 to m then changes f and b in place, element by element; a block is updated and
!> summed for the next order while it is in the cache. A residual that has no partner, at the ends of
!> a stretch without gaps, is set to 0 before it is summed: sums go over everything.
module gyroakf_ar_burg
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_last, chunk_group
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

   !> Residuals of order m
   type :: lattice_type
      !> m; -1 before the first order
      integer :: order = -1
      !> f_m(t) in t, b_m(t) in t - m; 0 where a stretch has none or its partner is missing: [n]
      real(dp), allocatable :: f(:), b(:)
      !> Orders that will be summed, for the progress
      integer :: orders = 1
      !> Present samples, pairs of the order that was summed last
      integer(int64) :: samples = 0, rows = 0
      !> sum x^2
      real(dp) :: power = 0.0_dp
   end type lattice_type

contains

   !> Burg's recursion over a series about its mean.
   !>
   !> $$k_m = \frac{2\sum_t f_{m-1}(t) b_{m-1}(t-1)}{\sum_t f_{m-1}(t)^2 + b_{m-1}(t-1)^2}, \quad
   !> f_m(t) = f_{m-1}(t) - k_m b_{m-1}(t-1), \quad b_m(t) = b_{m-1}(t-1) - k_m f_{m-1}(t)$$
   !> over t = m .. n-1, from f_0 = b_0 = x; always stationary. With gaps the sums go over the t of every stretch that is long
   !> enough, with one k_m for all: de Waele & Broersen, IEEE Trans. Signal Process. 48 (2000) 2876-2880. Source: Burg, Maximum
   !> entropy spectral analysis, 37th SEG meeting (1967).
   subroutine compute_burg(x, shift, rest, order, burg, error, valid, progress)
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
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(lattice_type) :: lattice
      real(dp) :: reflection, cross, power
      integer :: m, stat

      allocate (burg%phi(order, order), stat=stat)
      if (stat == 0) allocate (burg%reflection(order), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the AR coefficients of every order")
         return
      end if
      allocate (burg%variance(0:order), burg%residual_variance(0:order), burg%rows(0:order), burg%r(0:order))
      burg%phi = 0.0_dp
      burg%reflection = 0.0_dp
      call begin_lattice(x, shift, rest, lattice, error, valid, progress)
      if (allocated(error)) return
      call begin_orders(burg, lattice%power/real(lattice%samples, dp), lattice%samples, error)
      if (allocated(error)) return
      lattice%orders = order
      do m = 1, order
         reflection = 0.0_dp
         if (m > 1) reflection = burg%reflection(m - 1)
         call next_order(lattice, reflection, cross, power, error, valid, progress)
         if (.not. allocated(error)) call add_order(burg, m, cross, power, lattice%rows, error)
         if (allocated(error)) return
      end do
   end subroutine compute_burg

   !> Order 0.
   subroutine begin_orders(burg, r0, samples, error)
      type(burg_type), intent(inout) :: burg
      real(dp), intent(in) :: r0
      integer(int64), intent(in) :: samples
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
      type(burg_type), intent(inout) :: burg
      integer, intent(in) :: m
      !> sum f b, sum f^2 + b^2
      real(dp), intent(in) :: cross, power
      integer(int64), intent(in) :: rows
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

   !> Takes the series about its mean.
   subroutine begin_lattice(x, shift, rest, lattice, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      type(lattice_type), intent(out) :: lattice
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: part(2, chunk_count(size(x, kind=int64)))
      integer(int64) :: n
      integer :: chunk, from, group, stat

      n = size(x, kind=int64)
      allocate (lattice%f(n), stat=stat)
      if (stat == 0) allocate (lattice%b(n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the residuals of Burg's recursion, 16 bytes a sample")
         return
      end if
      group = chunk_group(chunk_count(n), present(progress))
      do from = 1, chunk_count(n), group
         call tell_progress("AR model", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         !$omp parallel do if (n >= threads_from) default(shared) schedule(dynamic)
         do chunk = from, min(from + group - 1, chunk_count(n))
            call take_chunk(x, shift, rest, chunk_first(n, chunk), chunk_last(n, chunk), lattice, part(:, chunk), valid)
         end do
         !$omp end parallel do
      end do
      lattice%power = sum(part(1, :))
      lattice%samples = nint(sum(part(2, :)), int64)
   end subroutine begin_lattice

   !> Order 0 of a chunk.
   pure subroutine take_chunk(x, shift, rest, first, last, lattice, part, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      integer(int64), intent(in) :: first, last
      type(lattice_type), intent(inout) :: lattice
      !> sum x^2, present samples
      real(dp), intent(out) :: part(2)
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: s
      integer(int64) :: i

      s = 0.0_dp
      part(2) = real(last - first + 1, dp)
      do i = first, last
         lattice%f(i) = (x(i) - shift) - rest
      end do
      if (present(valid)) then
         do i = first, last
            if (valid(i) /= 0_int8) cycle
            lattice%f(i) = 0.0_dp
            part(2) = part(2) - 1.0_dp
         end do
      end if
      do i = first, last
         lattice%b(i) = lattice%f(i)
         s = s + lattice%f(i)*lattice%f(i)
      end do
      part(1) = s
   end subroutine take_chunk

   !> Steps to the next order with its reflection coefficient and sums what the one after that needs.
   subroutine next_order(lattice, reflection, cross, power, error, valid, progress)
      !> Of order m-1 with its sums taken, or fresh; of order m with its sums taken afterwards
      type(lattice_type), intent(inout) :: lattice
      !> k_m; not used by the first call, which sums order 0
      real(dp), intent(in) :: reflection
      !> sum f_m(t) b_m(t-1) and sum f_m(t)^2 + b_m(t-1)^2 over the t where both are
      real(dp), intent(out) :: cross, power
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: part(2, chunk_count(size(lattice%f, kind=int64)))
      integer(int64) :: rows(chunk_count(size(lattice%f, kind=int64))), n, begin, m
      integer :: chunk, from, group

      cross = 0.0_dp
      power = 0.0_dp
      n = size(lattice%f, kind=int64)
      lattice%order = lattice%order + 1
      m = lattice%order
      group = chunk_group(chunk_count(n), present(progress))
      do from = 1, chunk_count(n), group
         call tell_progress("AR model", m*n + chunk_first(n, from) - 1, max(lattice%orders, 1)*n, error, progress)
         if (allocated(error)) return
         !$omp parallel do if (n >= threads_from) default(shared) schedule(dynamic)
         do chunk = from, min(from + group - 1, chunk_count(n))
            call step_chunk(lattice, reflection, chunk_first(n, chunk), chunk_last(n, chunk), part(:, chunk), rows(chunk), valid)
         end do
         !$omp end parallel do
      end do
      do chunk = 1, chunk_count(n)             ! first samples, whose partners stand in the chunk before
         begin = max(chunk_first(n, chunk), m + 2)
         if (begin /= chunk_first(n, chunk) .or. begin > n) cycle
         call add_products(lattice%f(begin:begin), lattice%b(begin - m - 1:begin - m - 1), part(:, chunk))
      end do
      cross = sum(part(1, :))
      power = sum(part(2, :))
      lattice%rows = max(0_int64, n - m - 1)
      if (present(valid)) lattice%rows = sum(rows)
   end subroutine next_order

   !> The step of a chunk, less its first sample's part in the sums.
   pure subroutine step_chunk(lattice, reflection, chunk_begin, chunk_end, part, rows, valid)
      type(lattice_type), intent(inout) :: lattice
      real(dp), intent(in) :: reflection
      integer(int64), intent(in) :: chunk_begin, chunk_end
      !> sum f b, sum f^2 + b^2
      real(dp), intent(out) :: part(2)
      !> Rows that have both, counted where samples are missing
      integer(int64), intent(out) :: rows
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: begin, first, last, m

      m = lattice%order
      part = 0.0_dp
      rows = 0
      begin = max(chunk_begin, m + 1)
      do first = begin, chunk_end, block
         last = min(first + block - 1, chunk_end)
         if (m > 0) call step(reflection, lattice%f(first:last), lattice%b(first - m:last - m))
         if (present(valid)) call drop_partnerless(lattice, first, last, rows, valid)
         if (first > begin) then
            call add_products(lattice%f(first:last), lattice%b(first - m - 1:last - m - 1), part)
         else
            call add_products(lattice%f(first + 1:last), lattice%b(first - m:last - m - 1), part)
         end if
      end do
   end subroutine step_chunk

   !> Residuals of a block of the next order.
   pure subroutine step(k, f, b)
      real(dp), intent(in) :: k
      !> f(t), b(t-1): [n]
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
      !> f(t), b(t-1): [n]
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
      type(lattice_type), intent(inout) :: lattice
      integer(int64), intent(in) :: first, last
      integer(int64), intent(inout) :: rows
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
         if (run > m + 1) rows = rows + 1
         if (t == size(valid, kind=int64)) cycle
         if (valid(t + 1) == 0_int8) lattice%b(t - m) = 0.0_dp
      end do
   end subroutine drop_partnerless

end module gyroakf_ar_burg
