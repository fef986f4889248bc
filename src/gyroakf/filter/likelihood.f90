! SPDX-License-Identifier: MIT
!> Exact Gaussian likelihood of a drift model, and its gradient.
!>
!> $$ \ln L = -\tfrac12 \sum_k \Big( \ln 2\pi + \ln S_k + e_k^2/S_k \Big) $$
!> over the measurements, without the first where there is a random walk (diffuse likelihood: what
!> the others tell of the parameters once the first has set the level).
!>
!> The filter has its steady gain K from the start, in each stretch without a gap: what the state
!> before the stretch is known less than to the steady covariance P, a shift d of variance D, changes
!> the innovations to e_k - g_k' d with $ g_k = (L')^{k-1} \mathbf 1, L = \Phi (I - K \mathbf 1^T) $.
!> Integrated over d the stretch of n samples has
!> $$ -2 \ln L = n \ln 2\pi S + \tfrac1S \sum e_k^2 + \ln \det (I + G D) - b^T (D^{-1} + G)^{-1} b,
!>    \quad G = \tfrac1S \sum g_k g_k^T, \quad b = \tfrac1S \sum g_k e_k $$
!> and that the state behind it is what the filter says plus $ L^n (D^{-1} + G)^{-1} b $. A random
!> walk that is not known has a flat d: D^{-1} = 0. A step costs O(n^2), that of g_k until it has
!> vanished too.
!>
!> Each number stands with its derivatives by all parameters in a vector, the value first.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.2, 7.3;
!> Rosenberg, Ann. Econ. Soc. Meas. 2 (1973) 399-428 (the shift of the start).
module gyroakf_filter_likelihood
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_filter_components, only : component_model_type, most_components, check_components
   use gyroakf_filter_drift_steady, only : steady_covariance
   use gyroakf_filter_measurement, only : exponent_mask, exponent_limit
   implicit none (type, external)
   private
   public :: component_likelihood

   !> Of the value and its derivatives by phi and q of every process and r: 0, 1 .. n, n + 1 .. 2 n, 2 n + 1
   integer, parameter :: last_lane = 2*most_components + 1
   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
   !> Samples between two looks at g, which below `vanished` is rounding
   integer(int64), parameter :: look_samples = 64
   real(dp), parameter :: vanished = 1.0e-18_dp
   !> Samples between two reports of progress
   integer(int64), parameter :: report_samples = 262144

   !> The filter with its steady gain
   type :: steady_filter_type
      integer :: n = 0
      !> Coefficients and variances of the driving noises
      real(dp), dimension(0:last_lane, most_components) :: phi = 0.0_dp, q = 0.0_dp
      !> Covariance of the prediction, variance of the innovation
      real(dp) :: p(0:last_lane, most_components, most_components) = 0.0_dp, s(0:last_lane) = 0.0_dp
      !> L, and Phi K
      real(dp) :: l(0:last_lane, most_components, most_components) = 0.0_dp
      real(dp) :: gain(0:last_lane, most_components) = 0.0_dp
   end type steady_filter_type

   !> Samples without a gap between
   type :: stretch_type
      integer(int64) :: samples = 0
      !> Prediction of the next sample, and the next g
      real(dp), dimension(0:last_lane, most_components) :: x = 0.0_dp, g = 0.0_dp
      logical :: vanished = .false.
      !> Sums, not yet divided by S: of the value's lane e e and g e and g g, of the others half of
      !> the derivatives of e e, and the derivatives of g e and g g
      real(dp) :: squares(0:last_lane) = 0.0_dp, b(0:last_lane, most_components) = 0.0_dp
      real(dp) :: gram(0:last_lane, most_components, most_components) = 0.0_dp
   end type stretch_type

   !> What is known of the next sample's state
   type :: known_type
      real(dp) :: x(0:last_lane, most_components) = 0.0_dp
      real(dp) :: p(0:last_lane, most_components, most_components) = 0.0_dp
      !> The random walk that is not known; 0: none
      integer :: flat = 0
   end type known_type

contains

   !> Log-likelihood of a series under a model.
   subroutine component_likelihood(model, z, value, error, valid, gradient, progress)
      !> Checked here
      type(component_model_type), intent(in) :: model
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> The natural logarithm
      real(dp), intent(out) :: value
      !> invalid_argument, non_finite, unstable; too_few_samples (none that counts); not_converged, singular (its steady gain);
      !> no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> By phi of every process (0 for a random walk), q of every process (0 for a random walk without
      !> steps), r: [2 count + 1]
      real(dp), intent(out), optional :: gradient(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(steady_filter_type) :: filter
      type(stretch_type) :: stretch
      type(known_type) :: known
      real(dp) :: deviance(0:last_lane), level
      integer(int64) :: k, first, last, next, reported, measurements

      value = 0.0_dp
      if (present(gradient)) gradient = 0.0_dp
      call check_components(model, error)
      if (.not. allocated(error)) call make_filter(model, filter, error)
      if (allocated(error)) return
      call begin(model, filter, known)
      deviance = 0.0_dp
      level = 0.0_dp
      measurements = 0
      reported = 0
      k = 1
      do
         first = k
         do while (k <= size(z, kind=int64))
            if (is_here(k)) exit
            k = k + 1
         end do
         if (k > size(z, kind=int64)) exit
         call predict_gap(filter, k - first, known)
         if (known%flat > 0) level = z(k)
         stretch = stretch_type(x=known%x)
         stretch%g(0, :filter%n) = 1.0_dp
         last = k
         do while (last < size(z, kind=int64))
            if (.not. is_here(last + 1)) exit
            last = last + 1
         end do
         do while (k <= last)
            if (k > reported) then
               call report_progress("identifying", k - 1, size(z, kind=int64), error, progress)
               if (allocated(error)) return
               reported = k + report_samples - 1
            end if
            next = min(last, merge(reported, k + look_samples - 1, stretch%vanished))
            call run(filter, z(k:next), level, stretch)
            k = next + 1
         end do
         measurements = measurements + stretch%samples - merge(1, 0, known%flat > 0)
         call join(filter, stretch, known, deviance)
      end do
      if (measurements < 1) then
         call fatal_error(error, status%too_few_samples, "the likelihood of a drift model needs more samples")
         return
      end if
      value = -0.5_dp*(real(measurements, dp)*log_two_pi + deviance(0))
      if (present(gradient)) gradient(:2*model%count + 1) = -0.5_dp*deviance(1:2*model%count + 1)

   contains

      !> Whether there is a measurement.
      logical function is_here(at)
         integer(int64), intent(in) :: at

         is_here = iand(shiftr(transfer(z(at), 0_int64), 52), exponent_mask) < exponent_limit    ! is_sample, inline
         if (present(valid)) is_here = is_here .and. valid(at) /= 0_int8
      end function is_here
   end subroutine component_likelihood

   !> The steady filter, and its derivatives: those of P solve $ P' = L P' L^T + R $, by doubling.
   subroutine make_filter(model, filter, error)
      type(component_model_type), intent(in) :: model
      type(steady_filter_type), intent(out) :: filter
      !> As steady_covariance
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: most_doublings = 64
      real(dp), dimension(most_components, most_components) :: p, l
      real(dp), dimension(0:last_lane, most_components, most_components) :: rest, half
      real(dp) :: gain(most_components), share(most_components), s
      integer :: i, j, n, round

      call steady_covariance(model, p, error)
      if (allocated(error)) return
      n = model%count
      filter%n = n
      share = sum(p, 1)
      s = model%r + sum(share)
      gain = share/s
      rest = 0.0_dp
      l = 0.0_dp
      do j = 1, n
         filter%phi(0, j) = model%phi(j)
         filter%phi(j, j) = merge(0.0_dp, 1.0_dp, model%phi(j) >= 1.0_dp)
         filter%q(0, j) = model%q(j)
         filter%q(n + j, j) = merge(0.0_dp, 1.0_dp, model%phi(j) >= 1.0_dp .and. .not. model%q(j) > 0.0_dp)
      end do
      do j = 1, n
         do i = 1, n
            l(i, j) = model%phi(i)*(merge(1.0_dp, 0.0_dp, i == j) - gain(i))
            rest(:, i, j) = (p(i, j) - gain(i)*share(j))* &
                            (model%phi(i)*filter%phi(:, j) + filter%phi(:, i)*model%phi(j))
            rest(0, i, j) = 0.0_dp
            rest(2*n + 1, i, j) = model%phi(i)*gain(i)*model%phi(j)*gain(j)
         end do
         rest(n + j, j, j) = rest(n + j, j, j) + filter%q(n + j, j)
      end do
      do round = 1, most_doublings
         do j = 1, n
            do i = 1, n
               half(:, i, j) = matmul(rest(:, i, :n), l(j, :n))
            end do
         end do
         do j = 1, n
            do i = 1, n
               rest(:, i, j) = rest(:, i, j) + matmul(half(:, :n, j), l(i, :n))
            end do
         end do
         if (maxval(abs(l)) < 1.0e-9_dp) exit
         l = matmul(l, l)
      end do
      rest(0, :, :) = p
      filter%p = rest
      filter%s = sum(sum(rest, 3), 2)
      filter%s(0) = s
      filter%s(2*n + 1) = filter%s(2*n + 1) + 1.0_dp
      do i = 1, n
         filter%gain(:, i) = product_of(filter%phi(:, i), quotient(sum(rest(:, :, i), 2), filter%s))
         do j = 1, n
            filter%l(:, i, j) = merge(1.0_dp, 0.0_dp, i == j)*filter%phi(:, i) - filter%gain(:, i)
         end do
      end do
   end subroutine make_filter

   !> Before the first sample: stationary; a random walk is not known.
   pure subroutine begin(model, filter, known)
      type(component_model_type), intent(in) :: model
      type(steady_filter_type), intent(in) :: filter
      type(known_type), intent(out) :: known
      real(dp) :: rest(0:last_lane)
      integer :: i

      do i = 1, model%count
         if (model%phi(i) >= 1.0_dp) then
            known%flat = i
         else
            rest = -2.0_dp*model%phi(i)*filter%phi(:, i)
            rest(0) = (1.0_dp - model%phi(i))*(1.0_dp + model%phi(i))
            known%p(:, i, i) = quotient(filter%q(:, i), rest)
         end if
      end do
   end subroutine begin

   !> Prediction over missing samples.
   pure subroutine predict_gap(filter, samples, known)
      type(steady_filter_type), intent(in) :: filter
      integer(int64), intent(in) :: samples
      type(known_type), intent(inout) :: known
      integer(int64) :: k
      integer :: i, j

      if (known%flat > 0) return                           ! nothing was measured: the others are stationary
      do k = 1, samples
         do j = 1, filter%n
            known%x(:, j) = product_of(filter%phi(:, j), known%x(:, j))
            do i = 1, filter%n
               known%p(:, i, j) = product_of(filter%phi(:, i), product_of(filter%phi(:, j), known%p(:, i, j)))
            end do
            known%p(:, j, j) = known%p(:, j, j) + filter%q(:, j)
         end do
      end do
   end subroutine predict_gap

   !> The filter over some samples of a stretch.
   pure subroutine run(filter, z, level, stretch)
      type(steady_filter_type), intent(in) :: filter
      real(dp), intent(in), contiguous :: z(:)
      !> Subtracted from them
      real(dp), intent(in) :: level
      type(stretch_type), intent(inout) :: stretch

      if (stretch%vanished) then
         select case (filter%n)
         case (1)
            call run_steady(1, filter%l, filter%gain, z, level, stretch)
         case (2)
            call run_steady(2, filter%l, filter%gain, z, level, stretch)
         case default
            call run_steady(3, filter%l, filter%gain, z, level, stretch)
         end select
      else
         select case (filter%n)
         case (1)
            call run_shifted(1, filter%l, filter%gain, z, level, stretch)
         case (2)
            call run_shifted(2, filter%l, filter%gain, z, level, stretch)
         case default
            call run_shifted(3, filter%l, filter%gain, z, level, stretch)
         end select
         stretch%vanished = maxval(abs(stretch%g(0, :))) < vanished
      end if
      stretch%samples = stretch%samples + size(z, kind=int64)
   end subroutine run

   !> Hot: a step is $ e = z - \mathbf 1^T x, x \leftarrow L x + \Phi K z $. The values v run ahead of the vectors.
   pure subroutine run_steady(n, l, gain, z, level, stretch)
      !> Known where it is called: the loops over processes are unrolled
      integer, value :: n
      real(dp), intent(in) :: l(0:last_lane, most_components, most_components), gain(0:last_lane, most_components)
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: level
      type(stretch_type), intent(inout) :: stretch
      real(dp) :: x(0:last_lane, most_components), next(0:last_lane, most_components)
      real(dp) :: slope(0:last_lane, most_components, most_components), squares(0:last_lane)
      real(dp) :: v(most_components), w(most_components), y, e, total
      integer(int64) :: k
      integer :: i, j, m

      slope = l
      slope(0, :, :) = 0.0_dp
      x = stretch%x
      v = x(0, :)
      squares = stretch%squares
      total = squares(0)
      do k = 1, size(z, kind=int64)
         y = z(k) - level
         e = y - sum(v(:n))
         total = total + e*e
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               squares(m) = squares(m) - e*x(m, i)
               next(m, i) = gain(m, i)*y
            end do
            w(i) = gain(0, i)*y
            do j = 1, n
               !$omp simd
               do m = 0, last_lane
                  next(m, i) = next(m, i) + slope(m, i, j)*v(j)
               end do
            end do
            do j = 1, n
               !$omp simd
               do m = 0, last_lane
                  next(m, i) = next(m, i) + l(0, i, j)*x(m, j)
               end do
               w(i) = w(i) + l(0, i, j)*v(j)
            end do
         end do
         x(:, :n) = next(:, :n)
         v(:n) = w(:n)
      end do
      stretch%x = x
      stretch%squares = squares
      stretch%squares(0) = total
   end subroutine run_steady

   !> Hot: the same, with the sums of what a shift of the start does.
   pure subroutine run_shifted(n, l, gain, z, level, stretch)
      integer, value :: n
      real(dp), intent(in) :: l(0:last_lane, most_components, most_components), gain(0:last_lane, most_components)
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: level
      type(stretch_type), intent(inout) :: stretch
      integer :: i, j, m
      real(dp), dimension(0:last_lane, most_components) :: x, g, b, next, next_g
      real(dp), dimension(0:last_lane, most_components, most_components) :: slope, gram
      real(dp), parameter :: unit(0:last_lane) = [1.0_dp, (0.0_dp, m=1, last_lane)]
      real(dp) :: e(0:last_lane), squares(0:last_lane)
      real(dp) :: v(most_components), w(most_components), y, value
      integer(int64) :: k

      slope = l
      slope(0, :, :) = 0.0_dp
      x = stretch%x
      g = stretch%g
      b = stretch%b
      gram = stretch%gram
      v = x(0, :)
      squares = stretch%squares
      do k = 1, size(z, kind=int64)
         y = z(k) - level
         value = y - sum(v(:n))
         e = unit*y
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               e(m) = e(m) - x(m, i)
            end do
         end do
         !$omp simd
         do m = 0, last_lane
            squares(m) = squares(m) + value*e(m)
         end do
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               b(m, i) = b(m, i) + (value*g(m, i) + g(0, i)*e(m))
               next(m, i) = gain(m, i)*y
               next_g(m, i) = 0.0_dp
            end do
            w(i) = gain(0, i)*y
            do j = 1, n
               !$omp simd
               do m = 0, last_lane
                  next(m, i) = next(m, i) + slope(m, i, j)*v(j)
                  next_g(m, i) = next_g(m, i) + g(0, j)*slope(m, j, i)
                  gram(m, j, i) = gram(m, j, i) + (g(0, j)*g(m, i) + g(0, i)*g(m, j))
               end do
            end do
            do j = 1, n
               !$omp simd
               do m = 0, last_lane
                  next(m, i) = next(m, i) + l(0, i, j)*x(m, j)
                  next_g(m, i) = next_g(m, i) + g(m, j)*l(0, j, i)
               end do
               w(i) = w(i) + l(0, i, j)*v(j)
            end do
         end do
         x(:, :n) = next(:, :n)
         g(:, :n) = next_g(:, :n)
         v(:n) = w(:n)
      end do
      stretch%x = x
      stretch%g = g
      stretch%b = b
      stretch%gram = gram
      stretch%squares = squares
   end subroutine run_shifted

   !> Adds a stretch to the likelihood: the shift of its start is estimated and integrated out.
   pure subroutine join(filter, stretch, known, deviance)
      type(steady_filter_type), intent(in) :: filter
      type(stretch_type), intent(in) :: stretch
      !> Before the stretch; behind it afterwards
      type(known_type), intent(inout) :: known
      !> -2 ln L without its ln 2 pi
      real(dp), intent(inout) :: deviance(0:last_lane)
      real(dp), dimension(0:last_lane, most_components, most_components) :: gram, before, system, shift, power
      real(dp), dimension(0:last_lane, most_components) :: b
      real(dp) :: term(0:last_lane)
      integer :: i, j, n

      n = filter%n
      term = 2.0_dp*stretch%squares
      term(0) = stretch%squares(0)
      deviance = deviance + real(stretch%samples, dp)*logarithm(filter%s) + quotient(term, filter%s)
      b = 0.0_dp
      before = known%p - filter%p
      if (known%flat > 0) then
         before(:, known%flat, :) = 0.0_dp
         before(:, :, known%flat) = 0.0_dp
         before(0, known%flat, known%flat) = 1.0_dp
      end if
      do j = 1, n
         term = stretch%b(:, j)
         term(0) = 0.5_dp*term(0)
         b(:, j) = quotient(term, filter%s)
         do i = 1, n
            term = stretch%gram(:, i, j)
            term(0) = 0.5_dp*term(0)
            gram(:, i, j) = quotient(term, filter%s)
         end do
      end do
      call multiply(n, before, gram, system)               ! the transpose of I + G D
      do j = 1, n
         if (j /= known%flat) system(0, j, j) = system(0, j, j) + 1.0_dp
      end do
      shift = before                                       ! symmetric, as what it becomes: (D^-1 + G)^-1
      call solve(n, system, shift, deviance)
      known%x = stretch%x
      known%p = filter%p
      known%flat = 0
      do i = 1, n
         do j = 1, n
            deviance = deviance - product_of(b(:, i), product_of(shift(:, i, j), b(:, j)))
         end do
      end do
      if (stretch%vanished) return
      call raise(n, filter%l, stretch%samples, power)
      call multiply(n, power, shift, system)
      do i = 1, n
         do j = 1, n
            known%x(:, i) = known%x(:, i) + product_of(system(:, i, j), b(:, j))
         end do
      end do
      call multiply(n, system, reshape(power, shape(power), order=[1, 3, 2]), shift)
      known%p = known%p + shift
   end subroutine join

   !> a b
   pure subroutine multiply(n, a, b, c)
      integer, intent(in) :: n
      real(dp), dimension(0:last_lane, most_components, most_components), intent(in) :: a, b
      real(dp), dimension(0:last_lane, most_components, most_components), intent(out) :: c
      integer :: i, j, k

      c = 0.0_dp
      do j = 1, n
         do k = 1, n
            do i = 1, n
               c(:, i, j) = c(:, i, j) + product_of(a(:, i, k), b(:, k, j))
            end do
         end do
      end do
   end subroutine multiply

   !> A power of a matrix.
   pure subroutine raise(n, a, exponent, power)
      integer, intent(in) :: n
      real(dp), intent(in) :: a(0:last_lane, most_components, most_components)
      !> >= 1
      integer(int64), intent(in) :: exponent
      real(dp), intent(out) :: power(0:last_lane, most_components, most_components)
      real(dp), dimension(0:last_lane, most_components, most_components) :: square, product
      integer(int64) :: rest
      integer :: i

      power = 0.0_dp
      do i = 1, n
         power(0, i, i) = 1.0_dp
      end do
      square = a
      rest = exponent
      do
         if (mod(rest, 2_int64) == 1) then
            call multiply(n, power, square, product)
            power = product
         end if
         rest = rest/2
         if (rest == 0) exit
         call multiply(n, square, square, product)
         square = product
      end do
   end subroutine raise

   !> Solves a x = b by elimination and adds ln |det a|.
   pure subroutine solve(n, a, b, log_determinant)
      integer, intent(in) :: n
      !> Spent afterwards
      real(dp), intent(inout) :: a(0:last_lane, most_components, most_components)
      !> The solution afterwards
      real(dp), intent(inout) :: b(0:last_lane, most_components, most_components)
      real(dp), intent(inout) :: log_determinant(0:last_lane)
      real(dp) :: factor(0:last_lane)
      integer :: i, j, k

      do k = 1, n
         i = k - 1 + maxloc(abs(a(0, k:n, k)), 1)
         if (i /= k) then
            a(:, [i, k], :) = a(:, [k, i], :)
            b(:, [i, k], :) = b(:, [k, i], :)
         end if
         log_determinant = log_determinant + logarithm(a(:, k, k))
         do i = 1, n
            if (i == k) cycle
            factor = quotient(a(:, i, k), a(:, k, k))
            do j = 1, n
               a(:, i, j) = a(:, i, j) - product_of(factor, a(:, k, j))
               b(:, i, j) = b(:, i, j) - product_of(factor, b(:, k, j))
            end do
         end do
      end do
      do k = 1, n
         do j = 1, n
            b(:, k, j) = quotient(b(:, k, j), a(:, k, k))
         end do
      end do
   end subroutine solve

   !> a b
   pure function product_of(a, b) result(c)
      real(dp), intent(in) :: a(0:last_lane), b(0:last_lane)
      real(dp) :: c(0:last_lane)

      c = a(0)*b + b(0)*a
      c(0) = a(0)*b(0)
   end function product_of

   !> a/b
   pure function quotient(a, b) result(c)
      real(dp), intent(in) :: a(0:last_lane), b(0:last_lane)
      real(dp) :: c(0:last_lane)

      c = (a - (a(0)/b(0))*b)/b(0)
      c(0) = a(0)/b(0)
   end function quotient

   !> ln |a|
   pure function logarithm(a) result(c)
      real(dp), intent(in) :: a(0:last_lane)
      real(dp) :: c(0:last_lane)

      c = a/a(0)
      c(0) = log(abs(a(0)))
   end function logarithm

end module gyroakf_filter_likelihood
