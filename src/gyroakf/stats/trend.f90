! SPDX-License-Identifier: MIT
!> Polynomial trend of a series.
!>
!> The fit is made in the polynomials that are orthonormal on the samples themselves (discrete
!> Chebyshev or Gram polynomials), where the normal equations are the unit matrix as long as nothing
!> is missing, and it is repeated on its own residuals. It is stated in Legendre polynomials and in
!> powers of the sample index. Memory: some blocks, nothing of the record's length.
!> Source: Abramowitz & Stegun 22.17 and 8.9; the paper's equation (10) is the form in powers.
module gyroakf_stats_trend
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_last, chunk_group
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_lapack, only : dpotrf, dpotrs
   implicit none (type, external)
   private
   public :: trend_type, fit_trend, remove_trend, detach_trend, subtract_trend, evaluate_trend, largest_degree

   !> Largest degree that fit_trend accepts
   integer, parameter :: largest_degree = 9
   !> Samples whose basis is held at once: 80 kB at the largest degree
   integer(int64), parameter :: stretch = 1024

   !> A polynomial over the samples 0 .. samples - 1
   type :: trend_type
      !> Degree; -1: no trend, 0 everywhere
      integer :: degree = -1
      !> Samples of the record that it was fitted to
      integer(int64) :: samples = 0
      !> Coefficients of the Legendre polynomials in 2 i/(n-1) - 1, i = 0 .. n-1: [0:degree]
      real(dp), allocatable :: legendre(:)
      !> Coefficients of the powers of the sample index i: [0:degree]
      real(dp), allocatable :: power(:)
      !> What the constant lost when it was rounded to legendre(0): a large offset costs no digits
      real(dp) :: remainder = 0.0_dp
   end type trend_type

   !> The orthonormal basis on the samples from the first to the last present one
   type :: basis_type
      integer :: degree = 0
      !> 0-based index of the first sample, number of samples
      integer(int64) :: first = 0, samples = 0
      !> t q(k) = a(k+1) q(k+1) + a(k) q(k-1), a(0) = 0
      real(dp) :: a(0:largest_degree) = 0.0_dp
   end type basis_type

contains

   !> Least-squares polynomial of the present samples.
   !>
   !> Minimises $$\sum_i (x_i - \sum_{k \le d} c_k q_k(t_i))^2$$ by Cholesky factorisation of the normal equations
   !> (LAPACK dpotrf), then again on the residuals. Relative error about 1e-14 of the polynomial.
   subroutine fit_trend(x, degree, trend, error, valid, progress)
      !> Series: [n], any unit u, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Degree, -1 .. 9; -1 gives the trend 0
      integer, intent(in) :: degree
      !> The polynomial, in u
      type(trend_type), intent(out) :: trend
      !> invalid_argument, too_few_samples (degree + 1 must be present), singular, non_finite, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(basis_type) :: basis
      real(dp) :: c(0:largest_degree), step(0:largest_degree), factor(0:largest_degree, 0:largest_degree), shift
      integer :: pass, info

      trend%samples = size(x, kind=int64)
      call set_basis(size(x, kind=int64), degree, basis, error, valid)
      if (allocated(error) .or. degree < 0) return
      shift = x(basis%first + 1)
      call normal_matrix(basis, factor, valid)
      call dpotrf("U", degree + 1, factor, largest_degree + 1, info)
      c = 0.0_dp
      do pass = 1, 2
         if (info /= 0) exit
         call project(x, basis, shift, c, step, error, valid, progress)
         if (allocated(error)) return
         if (.not. all(ieee_is_finite(step(:degree)))) then
            call fatal_error(error, status%non_finite, "the series has a value that is not finite")
            return
         end if
         call dpotrs("U", degree + 1, 1, factor, largest_degree + 1, step, largest_degree + 1, info)
         c = c + step
      end do
      if (info /= 0) then
         call fatal_error(error, status%singular, "the gaps leave the trend undetermined; a lower degree may do")
         return
      end if
      trend%degree = degree
      call convert(basis, c, shift, trend)
   end subroutine fit_trend

   !> Checks the arguments, finds the first and the last present sample and sets the recursion
   !> $$a_k = \frac{k}{m-1}\sqrt{\frac{m^2-k^2}{4k^2-1}}$$ of the basis on m samples.
   subroutine set_basis(n, degree, basis, error, valid)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Degree
      integer, intent(in) :: degree
      !> The basis
      type(basis_type), intent(out) :: basis
      !> invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: last, found
      real(dp) :: m
      integer :: k
      character(120) :: text

      if (degree < -1 .or. degree > largest_degree) then
         write (text, '("the degree of the trend must be -1 .. ", i0, ", it is ", i0)') largest_degree, degree
         call fatal_error(error, status%invalid_argument, trim(text))
         return
      end if
      call find_span(n, basis%first, last, found, error, valid)
      if (allocated(error) .or. degree < 0) return
      if (found < int(degree, int64) + 1) then
         write (text, '("a trend of degree ", i0, " needs ", i0, " samples, ", i0, " are present")') degree, degree + 1, found
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      basis%degree = degree
      basis%samples = last - basis%first + 1
      m = real(basis%samples, dp)
      do k = 1, degree
         basis%a(k) = real(k, dp)/(m - 1.0_dp)*sqrt((m - real(k, dp))*(m + real(k, dp))/real(4*k*k - 1, dp))
      end do
   end subroutine set_basis

   !> First and last present sample, 0-based, and their number.
   subroutine find_span(n, first, last, found, error, valid)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> The two, and how many are present
      integer(int64), intent(out) :: first, last, found
      !> invalid_argument where the mask has another length
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      first = 0
      last = n - 1
      found = n
      if (.not. present(valid)) return
      if (size(valid, kind=int64) /= n) then
         call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
         return
      end if
      found = count(valid /= 0_int8, kind=int64)
      if (found < 1) return
      do while (valid(first + 1) == 0_int8)
         first = first + 1
      end do
      do while (valid(last + 1) == 0_int8)
         last = last - 1
      end do
   end subroutine find_span

   !> The basis at some successive samples.
   pure subroutine evaluate_basis(basis, first, q)
      !> The basis
      type(basis_type), intent(in) :: basis
      !> Number of the first of the samples within the span, 0-based
      integer(int64), intent(in) :: first
      !> Values: [samples, 0:degree]
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

   !> Projections of the residuals, (1/m) sum (x - shift - sum_k c_k q_k) q_j over the present samples.
   subroutine project(x, basis, shift, c, projection, error, valid, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The basis
      type(basis_type), intent(in) :: basis
      !> Subtracted first
      real(dp), intent(in) :: shift
      !> Coefficients so far
      real(dp), intent(in) :: c(0:)
      !> Projections
      real(dp), intent(out) :: projection(0:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: part(0:largest_degree, chunk_count(basis%samples))
      integer :: chunks, group, from

      chunks = chunk_count(basis%samples)
      group = chunk_group(chunks, present(progress))
      part = 0.0_dp
      projection = 0.0_dp
      do from = 1, chunks, group
         call tell_progress("fitting the trend", chunk_first(basis%samples, from) - 1, basis%samples, error, progress)
         if (allocated(error)) return
         call project_chunks(x, basis, shift, c, from, min(from + group - 1, chunks), part, valid)
      end do
      projection = sum(part, 2)/real(basis%samples, dp)
   end subroutine project

   !> The sums of some chunks, shared by the threads.
   subroutine project_chunks(x, basis, shift, c, from, to, part, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The basis
      type(basis_type), intent(in) :: basis
      !> Subtracted first
      real(dp), intent(in) :: shift
      !> Coefficients so far
      real(dp), intent(in) :: c(0:)
      !> The chunks
      integer, intent(in) :: from, to
      !> Their sums are added to
      real(dp), intent(inout) :: part(0:, :)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: q(stretch, 0:basis%degree), y(stretch), total
      integer(int64) :: first, length
      integer :: chunk, i, k

      !$omp parallel do if (basis%samples >= threads_from) default(shared) schedule(dynamic) &
      !$omp& private(q, y, first, length, total, i, k)
      do chunk = from, to
         do first = chunk_first(basis%samples, chunk), chunk_last(basis%samples, chunk), stretch
            length = min(stretch, chunk_last(basis%samples, chunk) - first + 1)
            call evaluate_basis(basis, first - 1, q(:length, :))
            do i = 1, int(length)
               y(i) = x(basis%first + first + i - 1) - shift
            end do
            do k = 0, basis%degree
               y(:length) = y(:length) - c(k)*q(:length, k)
            end do
            if (present(valid)) then
               do i = 1, int(length)
                  if (valid(basis%first + first + i - 1) == 0_int8) y(i) = 0.0_dp
               end do
            end if
            do k = 0, basis%degree
               total = 0.0_dp
               !$omp simd reduction(+:total)
               do i = 1, int(length)
                  total = total + y(i)*q(i, k)
               end do
               part(k, chunk) = part(k, chunk) + total
            end do
         end do
      end do
      !$omp end parallel do
   end subroutine project_chunks

   !> (1/m) sum q_j q_k over the present samples: the unit matrix less the sum over the missing ones,
   !> or the sum itself where more than half is missing.
   subroutine normal_matrix(basis, matrix, valid)
      !> The basis
      type(basis_type), intent(in) :: basis
      !> The matrix, upper triangle
      real(dp), intent(out) :: matrix(0:, 0:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: part(:, :, :)
      integer(int64) :: missing
      integer :: k

      matrix = 0.0_dp
      do k = 0, basis%degree
         matrix(k, k) = 1.0_dp
      end do
      if (.not. present(valid)) return
      missing = count(valid(basis%first + 1:basis%first + basis%samples) == 0_int8, kind=int64)
      if (missing == 0) return
      allocate (part(0:basis%degree, 0:basis%degree, chunk_count(basis%samples)))
      if (2*missing <= basis%samples) then
         call sum_squares(basis, valid, .false., part)
         matrix(:basis%degree, :basis%degree) = matrix(:basis%degree, :basis%degree) - sum(part, 3)/real(basis%samples, dp)
      else
         call sum_squares(basis, valid, .true., part)
         matrix(:basis%degree, :basis%degree) = sum(part, 3)/real(basis%samples, dp)
      end if
   end subroutine normal_matrix

   !> Sums of q_j q_k over the present or over the missing samples of every chunk.
   subroutine sum_squares(basis, valid, wanted, part)
      !> The basis
      type(basis_type), intent(in) :: basis
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in) :: valid(:)
      !> .true.: the present ones
      logical, intent(in) :: wanted
      !> The sums, upper triangle: [0:degree, 0:degree, chunk]
      real(dp), intent(out) :: part(0:, 0:, :)
      real(dp) :: q(1, 0:basis%degree)
      integer(int64) :: i
      integer :: chunk, k

      part = 0.0_dp
      !$omp parallel do if (basis%samples >= threads_from) default(shared) private(q, i, k) schedule(dynamic)
      do chunk = 1, size(part, 3)
         do i = chunk_first(basis%samples, chunk), chunk_last(basis%samples, chunk)
            if ((valid(basis%first + i) /= 0_int8) .neqv. wanted) cycle
            call evaluate_basis(basis, i - 1, q)
            do k = 0, basis%degree
               part(:k, k, chunk) = part(:k, k, chunk) + q(1, :k)*q(1, k)
            end do
         end do
      end do
      !$omp end parallel do
   end subroutine sum_squares

   !> States a polynomial of the basis in Legendre polynomials over the record and in powers.
   subroutine convert(basis, c, shift, trend)
      !> The basis
      type(basis_type), intent(in) :: basis
      !> Coefficients of the basis
      real(dp), intent(in) :: c(0:)
      !> Constant that was subtracted
      real(dp), intent(in) :: shift
      !> Degree and samples are set; the coefficients are filled
      type(trend_type), intent(inout) :: trend
      real(dp) :: q(0:largest_degree + 1, -1:largest_degree), alpha, beta
      integer :: k, d

      d = basis%degree
      q = 0.0_dp
      q(0, 0) = 1.0_dp
      if (d > 0) then
         alpha = real(trend%samples - 1, dp)/real(basis%samples - 1, dp)
         beta = real(trend%samples - basis%samples - 2*basis%first, dp)/real(basis%samples - 1, dp)
         do k = 1, d
            q(:, k) = (alpha*times_argument(q(:, k - 1)) + beta*q(:, k - 1) - basis%a(k - 1)*q(:, k - 2))/basis%a(k)
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
      call to_powers(trend)
   end subroutine convert

   !> Legendre coefficients of t p(t): t P_j = ((j+1) P_(j+1) + j P_(j-1))/(2j+1).
   pure function times_argument(p) result(r)
      !> Legendre coefficients of p, the last one 0: [0:d]
      real(dp), intent(in) :: p(0:)
      real(dp) :: r(0:size(p) - 1)
      integer :: j

      r = 0.0_dp
      do j = 0, size(p) - 2
         r(j + 1) = p(j)*real(j + 1, dp)/real(2*j + 1, dp)
      end do
      do j = 1, size(p) - 1
         r(j - 1) = r(j - 1) + p(j)*real(j, dp)/real(2*j + 1, dp)
      end do
   end function times_argument

   !> P_j(2s - 1) = sum_l (-1)^(j+l) C(j, l) C(j+l, l) s^l with s = i/(n-1).
   subroutine to_powers(trend)
      !> Legendre coefficients are set; the powers are filled
      type(trend_type), intent(inout) :: trend
      real(dp) :: term, width
      integer :: j, l

      width = real(max(trend%samples - 1, 1_int64), dp)
      trend%power = 0.0_dp
      do j = trend%degree, 0, -1
         term = merge(1.0_dp, -1.0_dp, mod(j, 2) == 0)*trend%legendre(j)
         do l = 0, j
            trend%power(l) = trend%power(l) + term
            term = -term*real((j - l)*(j + l + 1), dp)/real((l + 1)*(l + 1), dp)/width
         end do
      end do
   end subroutine to_powers

   !> Value of the trend at a sample.
   elemental real(dp) function evaluate_trend(trend, index)
      !> The polynomial
      type(trend_type), intent(in) :: trend
      !> Index of the sample, 0-based; any value, beyond the record it is an extrapolation
      integer(int64), intent(in) :: index
      real(dp) :: t, b, b1, b2
      integer :: k

      evaluate_trend = 0.0_dp
      if (trend%degree < 0) return
      t = real(2*index - (trend%samples - 1), dp)/real(max(trend%samples - 1, 1_int64), dp)
      b1 = 0.0_dp
      b2 = 0.0_dp
      do k = trend%degree, 1, -1
         b = trend%legendre(k) + real(2*k + 1, dp)/real(k + 1, dp)*t*b1 - real(k + 1, dp)/real(k + 2, dp)*b2
         b2 = b1
         b1 = b
      end do
      evaluate_trend = trend%legendre(0) + (t*b1 - 0.5_dp*b2 + trend%remainder)
   end function evaluate_trend

   !> Subtracts the trend from the whole series, in place; threaded.
   subroutine remove_trend(trend, x)
      !> The polynomial; its degree -1 leaves x as it is
      type(trend_type), intent(in) :: trend
      !> Series that begins at sample 0: [n]
      real(dp), intent(inout), contiguous :: x(:)
      integer(int64) :: n, first, last
      integer :: chunk

      n = size(x, kind=int64)
      if (trend%degree < 0) return
      !$omp parallel do if (n >= threads_from) default(shared) private(first, last) schedule(static)
      do chunk = 1, chunk_count(n)
         do first = chunk_first(n, chunk), chunk_last(n, chunk), stretch
            last = min(first + stretch - 1, chunk_last(n, chunk))
            call subtract_trend(trend, first - 1, x(first:last))
         end do
      end do
      !$omp end parallel do
   end subroutine remove_trend

   !> The series less the trend, in another array; threaded.
   subroutine detach_trend(trend, x, rest)
      !> The polynomial; its degree -1 is 0 everywhere
      type(trend_type), intent(in) :: trend
      !> Series that begins at sample 0: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Series less trend: [n]
      real(dp), intent(inout), contiguous :: rest(:)
      integer(int64) :: n, first, last, i
      integer :: chunk

      n = size(x, kind=int64)
      !$omp parallel do if (n >= threads_from) default(shared) private(first, last, i) schedule(static)
      do chunk = 1, chunk_count(n)
         do first = chunk_first(n, chunk), chunk_last(n, chunk), stretch
            last = min(first + stretch - 1, chunk_last(n, chunk))
            do i = first, last
               rest(i) = x(i)
            end do
            call subtract_trend(trend, first - 1, rest(first:last))
         end do
      end do
      !$omp end parallel do
   end subroutine detach_trend

   !> Subtracts the trend from some successive samples: the constant first, then the rest, by
   !> Clenshaw's recursion.
   pure subroutine subtract_trend(trend, first, y)
      !> The polynomial
      type(trend_type), intent(in) :: trend
      !> 0-based index of the first of the samples
      integer(int64), intent(in) :: first
      !> The samples: [any number; short stretches are best]
      real(dp), intent(inout), contiguous :: y(:)
      real(dp) :: t, b, b1, b2, scale, up(largest_degree), down(largest_degree)
      integer :: i, k

      if (trend%degree < 0) return
      scale = 1.0_dp/real(max(trend%samples - 1, 1_int64), dp)
      do k = 1, trend%degree
         up(k) = real(2*k + 1, dp)/real(k + 1, dp)
         down(k) = real(k + 1, dp)/real(k + 2, dp)
      end do
      !$omp simd private(t, b, b1, b2, k)
      do i = 1, size(y)
         t = real(2*(first + i - 1) - (trend%samples - 1), dp)*scale
         b1 = 0.0_dp
         b2 = 0.0_dp
         do k = trend%degree, 1, -1
            b = trend%legendre(k) + up(k)*t*b1 - down(k)*b2
            b2 = b1
            b1 = b
         end do
         y(i) = (y(i) - trend%legendre(0)) - (t*b1 - 0.5_dp*b2 + trend%remainder)
      end do
   end subroutine subtract_trend

end module gyroakf_stats_trend
