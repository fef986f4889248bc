! SPDX-License-Identifier: MIT
!> Exact Gaussian likelihood of a drift model, and its gradient.
!>
!> $$ \ln L = -\tfrac12 \sum_k \Big( \ln 2\pi + \ln S_k + e_k^2/S_k \Big) $$
!> over the measurements, without the first where there is a random walk (diffuse likelihood: what
!> the others tell of the parameters once the first has set the level).
!>
!> Each stretch of n samples without a gap is filtered with the steady gain
!> ([[gyroakf_filter_steady_filter]]). What is known less of the state before it than the steady
!> covariance says is a shift d, of covariance D, of that state; integrated over d the stretch has
!> $$ -2 \ln L = n \ln 2\pi S + \tfrac1S \sum e_k^2 + \ln \det (I + G D) - b^T \hat d, \quad
!>    \hat d = (D^{-1} + G)^{-1} b, \quad G = \tfrac1S \sum g_k g_k^T, \quad
!>    b = \tfrac1S \sum g_k e_k $$
!> and the state behind it is that of the filter plus $ L^n \hat d $. Of a random walk that is not
!> known d is flat: no $ D^{-1} $.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.2, 7.3;
!> Rosenberg, Ann. Econ. Soc. Meas. 2 (1973) 399-428 (the shift of the start).
module gyroakf_filter_likelihood
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_filter_components, only : component_model_type, most_components, &
      check_components, exponent_mask, exponent_limit
   use gyroakf_filter_derivatives, only : last_lane, product_of, quotient, logarithm, multiply, &
      raise, solve
   use gyroakf_filter_steady_filter, only : steady_filter_type, stretch_type, make_steady_filter, &
      run_stretch
   implicit none (type, external)
   private
   public :: component_likelihood

   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
   !> Samples between two looks at g, and between two reports of progress
   integer(int64), parameter :: look_samples = 64, report_samples = 262144

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
      !> invalid_argument, non_finite, unstable; too_few_samples (none that counts); not_converged,
      !> singular (its steady gain); no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> By phi of every process (0 for a random walk), q of every process (0 for a random walk
      !> without steps), r: [2 count + 1]
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
      if (.not. allocated(error)) call make_steady_filter(model, filter, error)
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
         stretch = stretch_type(x=known%x)
         stretch%g(0, :filter%n) = 1.0_dp
         last = k
         do while (last < size(z, kind=int64))
            if (.not. is_here(last + 1)) exit
            last = last + 1
         end do
         if (known%flat > 0) level = sum(z(k:last))/real(last - k + 1, dp)
         do while (k <= last)
            if (k > reported) then
               call report_progress("identifying", k - 1, size(z, kind=int64), error, progress)
               if (allocated(error)) return
               reported = k + report_samples - 1
            end if
            next = min(last, merge(reported, k + look_samples - 1, stretch%vanished))
            call run_stretch(filter, z(k:next), level, stretch)
            k = next + 1
         end do
         measurements = measurements + stretch%samples - merge(1, 0, known%flat > 0)
         call join(filter, stretch, known, deviance)
      end do
      if (measurements < 1) then
         call fatal_error(error, status%too_few_samples, &
            "the likelihood of a drift model needs more samples")
         return
      end if
      value = -0.5_dp*(real(measurements, dp)*log_two_pi + deviance(0))
      if (present(gradient)) gradient(:2*model%count + 1) = -0.5_dp*deviance(1:2*model%count + 1)

   contains

      !> Whether there is a measurement.
      logical function is_here(at)
         integer(int64), intent(in) :: at

         ! is_sample, inline
         is_here = iand(shiftr(transfer(z(at), 0_int64), 52), exponent_mask) < exponent_limit
         if (present(valid)) is_here = is_here .and. valid(at) /= 0_int8
      end function is_here
   end subroutine component_likelihood

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

      ! nothing was measured: the others are stationary
      if (known%flat > 0) return
      do k = 1, samples
         do j = 1, filter%n
            known%x(:, j) = product_of(filter%phi(:, j), known%x(:, j))
            do i = 1, filter%n
               known%p(:, i, j) = &
                  product_of(filter%phi(:, i), product_of(filter%phi(:, j), known%p(:, i, j)))
            end do
            known%p(:, j, j) = known%p(:, j, j) + filter%q(:, j)
         end do
      end do
   end subroutine predict_gap

   !> Adds a stretch to the likelihood: the shift of its start is estimated and integrated out.
   pure subroutine join(filter, stretch, known, deviance)
      type(steady_filter_type), intent(in) :: filter
      type(stretch_type), intent(in) :: stretch
      !> Before the stretch; behind it afterwards
      type(known_type), intent(inout) :: known
      !> -2 ln L without its ln 2 pi
      real(dp), intent(inout) :: deviance(0:last_lane)
      real(dp), dimension(0:last_lane, most_components, most_components) :: gram, system, shift, &
         power
      real(dp), dimension(0:last_lane, most_components) :: b
      real(dp) :: term(0:last_lane)
      integer :: i, j, n

      n = filter%n
      term = 2.0_dp*stretch%squares
      term(0) = stretch%squares(0)
      deviance = deviance + real(stretch%samples, dp)*logarithm(filter%s) + quotient(term, filter%s)
      gram = stretch%gram
      gram(0, :, :) = 0.5_dp*gram(0, :, :)
      b = stretch%b
      b(0, :) = 0.5_dp*b(0, :)
      do j = 1, n
         b(:, j) = quotient(b(:, j), filter%s)
         do i = 1, n
            gram(:, i, j) = quotient(gram(:, i, j), filter%s)
         end do
      end do
      shift = known%p - filter%p                           ! D, or in a flat direction 1
      if (known%flat > 0) then
         shift(:, known%flat, :) = 0.0_dp
         shift(:, :, known%flat) = 0.0_dp
         shift(0, known%flat, known%flat) = 1.0_dp
      end if
      call multiply(n, shift, gram, system)                ! less I the transpose of I + G D
      do j = 1, n
         if (j /= known%flat) system(0, j, j) = system(0, j, j) + 1.0_dp
      end do
      call solve(n, system, shift, deviance)               ! gives (D^-1 + G)^-1, which is symmetric
      do j = 1, n
         do i = 1, n
            deviance = deviance - product_of(b(:, i), product_of(shift(:, i, j), b(:, j)))
         end do
      end do
      known%x = stretch%x
      known%p = filter%p
      known%flat = 0
      if (stretch%vanished) return
      call raise(n, filter%l, stretch%samples, power)
      call multiply(n, power, shift, system)
      do j = 1, n
         do i = 1, n
            known%x(:, i) = known%x(:, i) + product_of(system(:, i, j), b(:, j))
         end do
      end do
      call multiply(n, system, reshape(power, shape(power), order=[1, 3, 2]), shift)
      known%p = known%p + shift
   end subroutine join

end module gyroakf_filter_likelihood
