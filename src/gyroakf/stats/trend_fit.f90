! SPDX-License-Identifier: MIT
!> Polynomial trend of a series.
!>
!> The fit is made in the polynomials that are orthonormal on the samples themselves (discrete
!> Chebyshev or Gram polynomials), where the normal equations are the unit matrix as long as nothing
!> is missing, and it is repeated on its own residuals. It is stated in Legendre polynomials and in
!> powers of the sample index. Memory: some blocks, nothing of the record's length.
!> Source: Abramowitz & Stegun 22.17 and 8.9; the paper's equation (10) is the form in powers.
module gyroakf_stats_trend_fit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_progress, only : progress_type
   use gyroakf_lapack, only : dpotrf, dpotrs
   use gyroakf_stats_trend, only : trend_type, largest_degree, set_powers
   implicit none (type, external)
   private
   public :: fit_trend

   !> The orthonormal basis on the samples from the first to the last present one
   type :: basis_type
      integer :: degree = 0
      !> 0-based index of the first sample, number of samples
      integer(int64) :: first = 0, samples = 0
      !> t q(k) = a(k+1) q(k+1) + a(k) q(k-1), a(0) = 0
      real(dp) :: a(0:largest_degree) = 0.0_dp
   end type basis_type

   !> Sums over the present samples: (x - shift - sum_k c_k q_k) q_j, [0:degree]; then, at first,
   !> q_j q_k, j <= k, over the present or over the missing samples, [(0:degree)^2]
   type, extends(chunk_sums_type) :: projection_type
      type(basis_type) :: basis
      !> Subtracted first; coefficients so far
      real(dp) :: shift = 0.0_dp, c(0:largest_degree) = 0.0_dp
      !> Whether the second are summed, and of which samples: those whose presence is this
      logical :: squares = .false., wanted = .false.
   contains
      procedure :: add => add_projections
   end type projection_type

contains

   !> Least-squares polynomial of the present samples.
   !>
   !> Minimizes $$\sum_i (x_i - \sum_{k \le d} c_k q_k(t_i))^2$$ by Cholesky factorisation of the
   !> normal equations (LAPACK dpotrf), then again on the residuals. Relative error 1e-14.
   subroutine fit_trend(x, degree, trend, error, valid, progress)
      !> Series: [n], any unit u, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Degree, -1 .. 9; -1 gives the trend 0
      integer, intent(in) :: degree
      !> The polynomial, in u
      type(trend_type), intent(out) :: trend
      !> invalid_argument, too_few_samples (below degree + 1), singular, non_finite, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(basis_type) :: basis
      type(projection_type) :: projection
      real(dp), allocatable :: total(:), step(:), factor(:, :)
      integer(int64) :: missing
      integer :: pass, info, k

      trend%samples = size(x, kind=int64)
      call set_basis(size(x, kind=int64), degree, basis, error, valid)
      if (allocated(error) .or. degree < 0) return
      allocate (total((degree + 1)*(degree + 2)), step(0:degree), factor(0:degree, 0:degree))
      projection%basis = basis
      projection%shift = x(basis%first + 1)
      if (present(valid)) then
         missing = count(valid(basis%first + 1:basis%first + basis%samples) == 0_int8, kind=int64)
         projection%squares = missing > 0
         projection%wanted = 2*missing > basis%samples
      end if
      do pass = 1, 2
         call sum_chunks(projection, x, basis%samples, "fitting the trend", total, error, valid, &
            & progress)
         if (allocated(error)) return
         total = total/real(basis%samples, dp)
         step = total(:degree + 1)
         if (.not. all(ieee_is_finite(step))) call fatal_error(error, status%non_finite, &
            & "the series has a value that is not finite")
         if (allocated(error)) return
         if (pass == 1) then
            factor(:, :) = reshape(total(degree + 2:), shape(factor))
            if (.not. projection%wanted) then       ! the unit matrix less the sum over the missing
               factor = -factor
               do k = 0, degree
                  factor(k, k) = 1.0_dp + factor(k, k)
               end do
            end if
            call dpotrf("U", degree + 1, factor, degree + 1, info)
            projection%squares = .false.
         end if
         if (info /= 0) exit
         call dpotrs("U", degree + 1, 1, factor, degree + 1, step, degree + 1, info)
         projection%c(:degree) = projection%c(:degree) + step
      end do
      if (info /= 0) call fatal_error(error, status%singular, &
         & "the gaps leave the trend undetermined; a lower degree may do")
      if (allocated(error)) return
      trend%degree = degree
      call convert(basis, projection%c, projection%shift, trend)
   end subroutine fit_trend

   !> Checks the arguments, finds the first and the last present sample and sets the recursion
   !> $$a_k = \frac{k}{m-1}\sqrt{\frac{m^2-k^2}{4k^2-1}}$$ of the basis on m samples.
   subroutine set_basis(n, degree, basis, error, valid)
      integer(int64), intent(in) :: n
      integer, intent(in) :: degree
      type(basis_type), intent(out) :: basis
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: last, found
      real(dp) :: m, k2
      integer :: k
      character(120) :: text

      if (degree < -1 .or. degree > largest_degree) then
         write (text, "(2(a, i0))") "the degree of the trend must be -1 .. ", largest_degree, &
            & ", it is ", degree
         call fatal_error(error, status%invalid_argument, trim(text))
         return
      end if
      last = n - 1
      found = n
      if (present(valid)) then
         if (size(valid, kind=int64) /= n) call fatal_error(error, status%invalid_argument, &
            & "the mask and the series differ in length")
         if (allocated(error)) return
         found = count(valid /= 0_int8, kind=int64)
         do while (found > 0)
            if (valid(basis%first + 1) /= 0_int8) exit
            basis%first = basis%first + 1
         end do
         do while (found > 0)
            if (valid(last + 1) /= 0_int8) exit
            last = last - 1
         end do
      end if
      if (degree < 0) return
      if (found < int(degree, int64) + 1) then
         write (text, "(3(a, i0), a)") "a trend of degree ", degree, " needs ", degree + 1, &
            & " samples, ", found, " are present"
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      basis%degree = degree
      basis%samples = last - basis%first + 1
      m = real(basis%samples, dp)
      do k = 1, degree
         k2 = real(4*k*k - 1, dp)
         basis%a(k) = real(k, dp)/(m - 1.0_dp)*sqrt((m - real(k, dp))*(m + real(k, dp))/k2)
      end do
   end subroutine set_basis

   !> The basis at some successive samples.
   pure subroutine evaluate_basis(basis, first, q)
      type(basis_type), intent(in) :: basis
      integer(int64), intent(in) :: first
      real(dp), intent(out) :: q(:, 0:)
      real(dp) :: scale, t
      integer :: i, k

      q(:, 0) = 1.0_dp
      if (basis%degree < 1) return
      scale = 1.0_dp/real(basis%samples - 1, dp)
      do i = 1, size(q, 1)
         t = real(2*(first + i - 1) - (basis%samples - 1), dp)*scale
         q(i, 1) = t/basis%a(1)
      end do
      do k = 2, basis%degree
         do i = 1, size(q, 1)
            q(i, k) = (basis%a(1)*q(i, 1)*q(i, k - 1) - basis%a(k - 1)*q(i, k - 2))/basis%a(k)
         end do
      end do
   end subroutine evaluate_basis

   !> The sums of a chunk of the span.
   subroutine add_projections(self, x, n, chunk, total, stat, valid)
      class(projection_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: q(:, :)
      real(dp) :: y(block_length), product
      integer(int64) :: begin, place
      integer :: i, k, m

      allocate (q(block_length, 0:self%basis%degree), stat=stat)
      if (stat /= 0) return
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         place = self%basis%first + begin - 1
         call evaluate_basis(self%basis, begin - 1, q(:m, :))
         do i = 1, m
            y(i) = x(place + i) - self%shift
         end do
         do k = 0, self%basis%degree
            y(:m) = y(:m) - self%c(k)*q(:m, k)
         end do
         if (present(valid)) call drop_missing(self, valid(place + 1:place + m), q(:m, :), y(:m), &
            & total)
         do k = 0, self%basis%degree
            product = 0.0_dp
            !$omp simd reduction(+:product)
            do i = 1, m
               product = product + y(i)*q(i, k)
            end do
            total(k + 1) = total(k + 1) + product
         end do
      end do
   end subroutine add_projections

   !> Takes the missing samples out, and adds the products of the basis.
   pure subroutine drop_missing(self, valid, q, y, total)
      class(projection_type), intent(in) :: self
      integer(int8), intent(in) :: valid(:)
      real(dp), intent(in) :: q(:, 0:)
      real(dp), intent(inout) :: y(:), total(:)
      integer :: i, k, base

      do i = 1, size(y)
         if (valid(i) == 0_int8) y(i) = 0.0_dp
         if (.not. self%squares .or. ((valid(i) /= 0_int8) .neqv. self%wanted)) cycle
         do k = 0, self%basis%degree
            base = (k + 1)*(self%basis%degree + 1)
            total(base + 1:base + 1 + k) = total(base + 1:base + 1 + k) + q(i, :k)*q(i, k)
         end do
      end do
   end subroutine drop_missing

   !> States a polynomial of the basis in Legendre polynomials over the record and in powers.
   subroutine convert(basis, c, shift, trend)
      type(basis_type), intent(in) :: basis
      real(dp), intent(in) :: c(0:), shift
      type(trend_type), intent(inout) :: trend
      real(dp) :: q(0:largest_degree + 1, -1:largest_degree), r(0:largest_degree + 1), alpha, beta
      integer :: j, k, d

      d = basis%degree
      q = 0.0_dp
      q(0, 0) = 1.0_dp
      if (d > 0) then
         alpha = real(trend%samples - 1, dp)/real(basis%samples - 1, dp)
         beta = real(trend%samples - basis%samples - 2*basis%first, dp)/real(basis%samples - 1, dp)
         do k = 1, d
            r = 0.0_dp                  ! t q(k-1), by t P_j = ((j+1) P_(j+1) + j P_(j-1))/(2j+1)
            do j = 0, largest_degree
               r(j + 1) = q(j, k - 1)*real(j + 1, dp)/real(2*j + 1, dp)
            end do
            do j = 1, largest_degree + 1
               r(j - 1) = r(j - 1) + q(j, k - 1)*real(j, dp)/real(2*j + 1, dp)
            end do
            q(:, k) = (alpha*r + beta*q(:, k - 1) - basis%a(k - 1)*q(:, k - 2))/basis%a(k)
         end do
      end if
      allocate (trend%legendre(0:d), trend%power(0:d))
      trend%legendre = 0.0_dp
      do k = d, 0, -1
         trend%legendre = trend%legendre + c(k)*q(:d, k)
      end do
      trend%remainder = trend%legendre(0)
      trend%legendre(0) = shift + trend%remainder
      trend%remainder = (shift - trend%legendre(0)) + trend%remainder
      call set_powers(trend)
   end subroutine convert

end module gyroakf_stats_trend_fit
