! SPDX-License-Identifier: MIT
!> Covariances of overlapping Allan variances of a noise mixture, in closed form and quadrature.
!>
!> With z_m(k) = x_{k+2m} - 2 x_{k+m} + x_k, M_m = n - 2m + 1 terms, and Gaussian noise,
!>
!> $$ \mathrm{Cov}(\hat\sigma^2_m, \hat\sigma^2_n) = \frac{1}{4 m^2 n^2 M_m M_n}
!>    \sum_{i,j} \left( 2 R_{mn}(j-i)^2 + 4 \mu_m(i) \mu_n(j) R_{mn}(j-i) \right) $$
!>
!> where R_mn is the covariance of z_m and z_n ([[gyroakf_allan_lag_covariance]]; quantisation noise adds a spike at each kink) and
!> mu_m the mean of z_m: R m^2 of the ramp, an oscillation of the sinusoid, for which the sum is the noise's spectrum at its
!> frequency.
!> As a function of the distance u of the centres R is even, and smooth between the kinks 0, n - m, m, n, n + m. The sum over
!> the lags
!> is Gauss quadrature between the kinks, or term by term where they are close: its cost does not depend on
!> the length of the record. R is linear in the squared coefficients: the sums of the products of two processes are
!> computed once ([[new_covariance_basis]]), and every mixture's covariance is a sum over them.
!> All lengths are in samples here, and so are the units of the coefficients.
module gyroakf_allan_covariance
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_lag_covariance, only : lag_covariances, lag_type, new_lag, process_count, process_flicker, process_markov
   use gyroakf_allan_noise_model, only : model_variance, noise_model_type, term_count, term_flicker, term_markov, &
      & term_quantisation, term_ramp, term_sinusoid, term_walk, term_white
   use gyroakf_allan_quadrature, only : node, node_count, weight
   implicit none (type, external)
   private
   public :: allan_covariance, allan_variance_covariances
   public :: covariance_basis_type, new_covariance_basis, mixture_covariances, mixture_freedom

   !> Noise processes: quantisation, and those of [[gyroakf_allan_lag_covariance]] in their order
   integer, parameter :: noise_count = process_count + 1
   integer, parameter :: noise_term(noise_count) = [term_quantisation, term_white, term_flicker, term_walk, term_markov]
   !> Pi
   real(dp), parameter :: pi = 3.141592653589793_dp
   !> Segments up to this length are summed term by term
   real(dp), parameter :: direct_max = 24.0_dp
   !> Kinks and further ends of segments at most
   integer, parameter :: ends_max = 40
   !> Lags in all segments at most
   integer, parameter :: lags_max = (ends_max - 1)*(nint(direct_max) + 1)

   !> Two averaging factors and the sums over their lags
   type :: pair_type
      !> Shorter and longer factor, in samples
      type(lag_type) :: lag
      !> Terms of the shorter and of the longer factor
      real(dp) :: other_terms = 1.0_dp, terms = 1.0_dp
      !> Sums over all pairs of terms of the products of the covariances of two processes, and of the covariances themselves
      real(dp) :: product(noise_count, noise_count) = 0.0_dp, plain(noise_count) = 0.0_dp
   end type pair_type

   !> What the covariances of any mixture at some averaging factors are made of
   type :: covariance_basis_type
      !> Rate samples in the record
      integer(int64) :: samples = 0
      !> There is a Markov process in it, of this correlation time in samples
      logical :: markov = .false.
      real(dp) :: correlation_time = 1.0_dp
      !> Averaging factors
      integer(int64), allocatable :: m(:)
      !> By the first and the second factor, the first not above the second: [k, k]
      type(pair_type), allocatable :: pair(:, :)
   end type covariance_basis_type

   !> Covariance of the Allan variances at two averaging factors: of the five squares, or of a model
   interface allan_covariance
      module procedure covariance_of_squares, covariance_of_model
   end interface allan_covariance

contains

   !> Computes what the covariances are made of.
   pure subroutine new_covariance_basis(samples, m, basis, correlation_time)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2, ascending: [k]
      integer(int64), intent(in) :: m(:)
      !> The basis
      type(covariance_basis_type), intent(out) :: basis
      !> Of a Markov process, > 0; without it such a process is not in it
      real(dp), intent(in), optional :: correlation_time

      logical :: wanted(process_count)
      integer :: i, j

      wanted = .true.
      wanted(process_markov) = present(correlation_time)
      basis%markov = present(correlation_time)
      if (present(correlation_time)) basis%correlation_time = correlation_time
      basis%samples = samples
      basis%m = m
      allocate (basis%pair(size(m), size(m)))
      do j = 1, size(m)
         do i = 1, j
            basis%pair(i, j) = summed_pair(samples, m(i), m(j), wanted, .true., basis%correlation_time)
         end do
      end do
   end subroutine new_covariance_basis

   !> Covariance matrix of the Allan variances of a mixture.
   pure subroutine mixture_covariances(basis, model, covariance)
      !> Of the record and its averaging factors; with the Markov process if the model has one
      type(covariance_basis_type), intent(in) :: basis
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> The matrix: [k, k]
      real(dp), intent(out) :: covariance(:, :)

      integer :: i, j

      do j = 1, size(basis%m)
         do i = 1, j
            covariance(i, j) = contracted(basis%pair(i, j), model)
            covariance(j, i) = covariance(i, j)
         end do
      end do
   end subroutine mixture_covariances

   !> Degrees of freedom of the Allan variances of a mixture, twice the squared mean over the variance.
   pure function mixture_freedom(basis, model) result(freedom)
      !> Of the record and its averaging factors
      type(covariance_basis_type), intent(in) :: basis
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> At most 1e15: [k]
      real(dp) :: freedom(size(basis%m))

      real(dp) :: variance
      integer :: i

      do i = 1, size(basis%m)
         variance = contracted(basis%pair(i, i), model)
         freedom(i) = 1e15_dp
         if (variance > 0) freedom(i) = min(freedom(i), 2*model_variance(model, real(basis%m(i), dp))**2/variance)
      end do
   end function mixture_freedom

   !> Covariance matrix of the Allan variances of the five terms.
   pure subroutine allan_variance_covariances(samples, m, squares, covariance)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2: [k]
      integer(int64), intent(in) :: m(:)
      !> Squared coefficients for a sample interval of 1: Q^2, N^2, B^2, K^2, R^2
      real(dp), intent(in) :: squares(term_count)
      !> The matrix: [k, k]
      real(dp), intent(out) :: covariance(:, :)

      integer :: i, j

      do j = 1, size(m)
         do i = 1, j
            covariance(i, j) = covariance_of_squares(samples, m(i), m(j), squares)
            covariance(j, i) = covariance(i, j)
         end do
      end do
   end subroutine allan_variance_covariances

   !> Covariance of the Allan variances at two averaging factors; the variance if they are equal.
   pure real(dp) function covariance_of_squares(samples, m1, m2, squares) result(covariance)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2
      integer(int64), intent(in) :: m1, m2
      !> Squared coefficients for a sample interval of 1
      real(dp), intent(in) :: squares(term_count)

      type(noise_model_type) :: model

      model%squares(:term_count) = squares
      covariance = covariance_of_model(samples, m1, m2, model)
   end function covariance_of_squares

   !> The same of a model.
   pure real(dp) function covariance_of_model(samples, m1, m2, model) result(covariance)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2
      integer(int64), intent(in) :: m1, m2
      !> The mixture
      type(noise_model_type), intent(in) :: model

      covariance = contracted(summed_pair(samples, m1, m2, model%squares(noise_term(2:)) > 0, &
         & model%squares(term_quantisation) > 0, model%correlation_time), model)
   end function covariance_of_model

   !> Covariance of a mixture from the sums of a pair.
   pure real(dp) function contracted(pair, model) result(covariance)
      !> The sums
      type(pair_type), intent(in) :: pair
      !> The mixture
      type(noise_model_type), intent(in) :: model

      real(dp) :: square(noise_count), area

      square = model%squares(noise_term)
      area = pair%lag%m*pair%lag%n
      covariance = 2*dot_product(square, matmul(pair%product, square))/area**2 &
         & + 4*model%squares(term_ramp)*dot_product(pair%plain, square)
      if (model%squares(term_sinusoid) > 0) covariance = covariance + oscillating_part(pair, model)/area**2
      covariance = covariance/(4*pair%terms*pair%other_terms)
   end function contracted

   !> Sum of 4 mu mu R of a sinusoid of many periods.
   pure real(dp) function oscillating_part(pair, model) result(total)
      !> The factors
      type(pair_type), intent(in) :: pair
      !> The mixture
      type(noise_model_type), intent(in) :: model

      real(dp) :: gain, spectrum, s, p

      s = sin(pi*model%frequency)**2
      p = exp(-1/model%correlation_time)
      gain = 4*(sin(pi*model%frequency*pair%lag%m)*sin(pi*model%frequency*pair%lag%n))**2/s
      spectrum = 4*s*model%squares(term_quantisation) + model%squares(term_white) + model%squares(term_flicker)/(2*sqrt(s)) + &
         & model%squares(term_walk)/(4*s) + model%squares(term_markov)*(1 - p**2)/((1 - p)**2 + 4*p*s)
      total = 2*model%squares(term_sinusoid)*gain**2*spectrum*pair%terms
   end function oscillating_part

   !> The sums of two averaging factors.
   pure function summed_pair(samples, m1, m2, wanted, quantised, correlation_time) result(pair)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors
      integer(int64), intent(in) :: m1, m2
      !> Which smooth processes, and whether quantisation
      logical, intent(in) :: wanted(process_count), quantised
      !> Of the Markov process
      real(dp), intent(in) :: correlation_time
      type(pair_type) :: pair

      real(dp) :: ends(ends_max), last, u(lags_max), pairs(lags_max)
      integer :: i, count, lags

      pair%lag = new_lag(real(m1, dp), real(m2, dp), wanted, correlation_time)
      pair%terms = real(samples - 2*max(m1, m2) + 1, dp)
      pair%other_terms = real(samples - 2*min(m1, m2) + 1, dp)
      if (any(wanted)) then
         call segment_ends(pair%lag, ends, count)
         last = pair%terms + (pair%lag%n - pair%lag%m)
         lags = 0
         do i = 1, count - 1
            if (ends(i) >= last) exit
            call append_segment(ends(i), min(ends(i + 1), last), u, pairs, lags)
         end do
         call add_lags(pair, u(:lags), pairs(:lags))
      end if
      if (quantised) call add_quantisation(pair)
   end function summed_pair

   !> Kinks of R, ascending; with long memory also places inside long segments and in the tail.
   pure subroutine segment_ends(lag, ends, count)
      !> Factors and processes
      type(lag_type), intent(in) :: lag
      !> The places, from 0
      real(dp), intent(out) :: ends(ends_max)
      !> How many
      integer, intent(out) :: count

      real(dp) :: m, n, middle, near
      integer :: i, kinks

      m = lag%m
      n = lag%n
      ends = 0
      if (lag%wanted(process_flicker) .and. n > 8*m) then
         middle = anint(sqrt(m*n/2))
         ends(2:8) = [m, middle, anint(n/2), n - middle, n - m, n, n + m]
         kinks = 8
      else
         ends(2:5) = [min(m, n - m), max(m, n - m), n, n + m]
         kinks = 5
      end if
      count = kinks
      if (any(lag%wanted([process_flicker, process_markov]))) then
         ends(count + 1:count + 3) = (n + m)*[2, 4, 16]
         count = count + 3
      end if
      if (.not. lag%wanted(process_markov)) return
      do i = 1, kinks                                       ! the exponential starts anew at each kink
         near = anint(max(2*lag%time, direct_max))
         ends(count + 1:count + 3) = max(0.0_dp, [ends(i) - near, ends(i) + near, ends(i) + 4*near])
         count = count + 3
      end do
      call sort(ends(:count))
   end subroutine segment_ends

   !> Sorts a short list upwards.
   pure subroutine sort(list)
      !> The list
      real(dp), intent(inout) :: list(:)

      integer :: i, place
      real(dp) :: least

      do i = 1, size(list) - 1
         place = i - 1 + minloc(list(i:), dim=1)
         least = list(place)
         list(place) = list(i)
         list(i) = least
      end do
   end subroutine sort

   !> Appends both signs of the lags between two places (half the terms at the places themselves).
   pure subroutine append_segment(first, last, u, factor, lags)
      !> The places, whole numbers
      real(dp), intent(in) :: first, last
      !> Lags, how often each is to be taken, and how many there are
      real(dp), intent(inout) :: u(:), factor(:)
      integer, intent(inout) :: lags

      real(dp) :: length
      integer :: i, steps

      length = last - first
      if (length <= 0) return
      if (length <= direct_max) then
         steps = nint(length)
         u(lags + 1:lags + steps + 1) = [(first + i, i=0, steps)]
         factor(lags + 1:lags + steps + 1) = 2
         factor([lags + 1, lags + steps + 1]) = 1
         lags = lags + steps + 1
      else
         u(lags + 1:lags + node_count) = first + node*length
         factor(lags + 1:lags + node_count) = 2*weight*length
         lags = lags + node_count
      end if
   end subroutine append_segment

   !> Adds what the pairs of terms at some distances give.
   pure subroutine add_lags(pair, u, factor)
      !> Its sums are added to
      type(pair_type), intent(inout) :: pair
      !> Distances, >= 0
      real(dp), intent(in) :: u(:)
      !> Multiply the numbers of pairs
      real(dp), intent(in) :: factor(:)

      real(dp) :: r(size(u), process_count), pairs(size(u)), total
      integer :: i, j, k

      r = lag_covariances(pair%lag, u)
      pairs = factor*lag_count(pair, u)
      do j = 1, process_count
         if (.not. pair%lag%wanted(j)) cycle
         pair%plain(j + 1) = dot_product(pairs, r(:, j))
         do i = 1, j
            if (.not. pair%lag%wanted(i)) cycle
            total = 0
            !$omp simd reduction(+:total)
            do k = 1, size(u)
               total = total + pairs(k)*r(k, i)*r(k, j)
            end do
            pair%product(i + 1, j + 1) = total
            pair%product(j + 1, i + 1) = total
         end do
      end do
   end subroutine add_lags

   !> Number of pairs of terms whose centres are u apart (one sign).
   elemental real(dp) function lag_count(pair, u)
      !> Factors
      type(pair_type), intent(in) :: pair
      !> Distance, >= 0
      real(dp), intent(in) :: u

      lag_count = max(0.0_dp, pair%terms - max(0.0_dp, u - (pair%lag%n - pair%lag%m)))
   end function lag_count

   !> What quantisation noise adds: R has a spike at each kink.
   pure subroutine add_quantisation(pair)
      !> Its sums are added to
      type(pair_type), intent(inout) :: pair

      real(dp), parameter :: height(5) = [4.0_dp, 1.0_dp, -2.0_dp, -2.0_dp, 1.0_dp]
      real(dp) :: place(5), spike, r(5, process_count), factor
      integer :: i

      place = [0.0_dp, pair%lag%n - pair%lag%m, pair%lag%m, pair%lag%n, pair%lag%m + pair%lag%n]
      r = lag_covariances(pair%lag, place)
      do i = 1, 5
         if (any(same_place(place(:i - 1), place(i)))) cycle
         spike = sum(height, mask=same_place(place, place(i)))
         factor = 2*lag_count(pair, place(i))
         if (i == 1) then                                   ! n = m: the differences meet from both sides
            factor = lag_count(pair, place(i))
            if (same_place(pair%lag%n, pair%lag%m)) spike = 6
         end if
         pair%product(1, 1) = pair%product(1, 1) + factor*spike**2
         pair%product(2:, 1) = pair%product(2:, 1) + factor*spike*r(i, :)
         pair%product(1, 2:) = pair%product(2:, 1)
         pair%plain(1) = pair%plain(1) + factor*spike
      end do
   end subroutine add_quantisation

   !> Whether two whole numbers are equal.
   elemental logical function same_place(a, b)
      !> The numbers
      real(dp), intent(in) :: a, b

      same_place = abs(a - b) < 0.5_dp
   end function same_place

end module gyroakf_allan_covariance
