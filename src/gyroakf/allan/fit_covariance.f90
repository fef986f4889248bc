! SPDX-License-Identifier: MIT
!> Covariances of overlapping Allan variances of a noise mixture.
!>
!> With z_m(k) = x_{k+2m} - 2 x_{k+m} + x_k, M_m = n - 2m + 1 terms, and Gaussian noise,
!>
!> $$ \mathrm{Cov}(\hat\sigma^2_m, \hat\sigma^2_n) = \frac{1}{4 m^2 n^2 M_m M_n}
!>    \sum_u c(u) \left( 2 R_{mn}(u)^2 + 4 R^2 m^2 n^2 R_{mn}(u) \right) $$
!>
!> where R_mn(u) is the covariance of z_m and z_n whose centers are u samples apart, c(u) the number
!> of such pairs, and the second part that of a ramp of slope R. R_mn is a second difference of step
!> n of a second difference of step m of the generalized autocovariance of the phase,
!>
!> $$ s_x(t) = -\frac{N^2 |t|}{2} + \frac{B^2}{2\pi} t^2 \ln|t| + \frac{K^2 |t|^3}{12} $$
!>
!> (C. A. Greenhall, IEEE Trans. UFFC 47, 2000), with Q^2 at t = 0. It is smooth between the kinks
!> 0, n - m, m, n and n + m. The sum over u is taken term by term where these are close and by Gauss
!> quadrature elsewhere: correlations are within 0.001 of the full sum. It is bilinear in the
!> squared coefficients: sums for each two terms are computed once, the covariance of a mixture is a
!> contraction.
module gyroakf_allan_fit_covariance
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_noise_model, only : model_variance, term_count, term_ramp
   implicit none (type, external)
   private
   public :: covariance_basis_type, covariance_basis, lag_covariances, mixture_covariances, &
      & mixture_freedom

   !> Q N B K, the terms that are noise; the last three of them have a smooth R_mn
   integer, parameter :: noise_count = 4, smooth_count = 3
   !> Ends of segments; those up to the second length are summed term by term, longer ones by Gauss
   !> quadrature on 0 .. 1
   integer, parameter :: ends_max = 10, direct_max = 24, node_count = 12
   real(dp), parameter :: half_node(6) = [0.0092196828766403782_dp, 0.047941371814762601_dp, &
      & 0.11504866290284765_dp, 0.20634102285669126_dp, 0.31608425050090994_dp, &
      & 0.43738329574426554_dp]
   real(dp), parameter :: half_weight(6) = [0.023587668193255706_dp, 0.053469662997659533_dp, &
      & 0.080039164271673208_dp, 0.10158371336153287_dp, 0.11674626826917731_dp, &
      & 0.12457352290670134_dp]
   real(dp), parameter :: node(node_count) = [half_node, 1 - half_node(6:1:-1)]
   real(dp), parameter :: weight(node_count) = [half_weight, half_weight(6:1:-1)]
   !> 1/(2 pi); most degrees of freedom
   real(dp), parameter :: per_two_pi = 0.15915494309189535_dp, freedom_max = 1e15_dp

   !> What the covariances of any mixture at some averaging factors are made of
   type :: covariance_basis_type
      !> Of each pair of averaging factors: covariance per product of two squares, and with a ramp:
      !> [4, 4, k, k], [4, k, k]
      real(dp), allocatable :: product(:, :, :, :), plain(:, :, :)
   end type covariance_basis_type

contains

   !> What the covariances are made of.
   pure function covariance_basis(samples, m) result(basis)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2: [k]
      integer(int64), intent(in) :: m(:)
      type(covariance_basis_type) :: basis
      integer :: i, j

      allocate (basis%product(noise_count, noise_count, size(m), size(m)), &
         & basis%plain(noise_count, size(m), size(m)))
      do j = 1, size(m)
         do i = 1, j
            call sum_pair(samples, m(i), m(j), basis%product(:, :, i, j), basis%plain(:, i, j))
            basis%product(:, :, j, i) = basis%product(:, :, i, j)
            basis%plain(:, j, i) = basis%plain(:, i, j)
         end do
      end do
   end function covariance_basis

   !> Covariance matrix of the Allan variances of a mixture.
   pure function mixture_covariances(basis, squares) result(covariance)
      !> Of the record and its averaging factors
      type(covariance_basis_type), intent(in) :: basis
      !> Q^2 N^2 B^2 K^2 R^2 for a sample interval of 1, >= 0
      real(dp), intent(in) :: squares(term_count)
      !> The matrix: [k, k]
      real(dp) :: covariance(size(basis%plain, 2), size(basis%plain, 2))
      integer :: i, j

      do j = 1, size(covariance, 2)
         do i = 1, j
            covariance(i, j) = contracted(basis%product(:, :, i, j), basis%plain(:, i, j), squares)
            covariance(j, i) = covariance(i, j)
         end do
      end do
   end function mixture_covariances

   !> Degrees of freedom of Allan variances of a mixture: twice the squared mean over the variance.
   pure function mixture_freedom(samples, m, mixture) result(freedom)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2: [k]
      integer(int64), intent(in) :: m(:)
      !> Q^2 N^2 B^2 K^2 R^2 for a sample interval of 1; a negative square counts as 0
      real(dp), intent(in) :: mixture(term_count)
      !> At most 1e15: [k]
      real(dp) :: freedom(size(m))
      real(dp) :: product(noise_count, noise_count), plain(noise_count), squares(term_count), &
         & variance
      integer :: i

      squares = max(0.0_dp, mixture)
      do i = 1, size(m)
         call sum_pair(samples, m(i), m(i), product, plain)
         variance = contracted(product, plain, squares)
         freedom(i) = freedom_max
         if (variance > 0) then
            freedom(i) = min(freedom_max, 2*model_variance(squares, real(m(i), dp))**2/variance)
         end if
      end do
   end function mixture_freedom

   !> Covariance of a mixture from the sums of a pair.
   pure real(dp) function contracted(product, plain, squares) result(covariance)
      real(dp), intent(in) :: product(noise_count, noise_count), plain(noise_count), &
         & squares(term_count)

      covariance = squares(term_ramp)*dot_product(plain, squares(:noise_count)) + &
         & dot_product(squares(:noise_count), matmul(product, squares(:noise_count)))
   end function contracted

   !> The sums of two averaging factors.
   pure subroutine sum_pair(samples, m1, m2, product, plain)
      integer(int64), intent(in) :: samples, m1, m2
      real(dp), intent(out) :: product(noise_count, noise_count), plain(noise_count)
      real(dp) :: m, n, terms, other_terms, last, ends(ends_max)
      real(dp), dimension(ends_max*(direct_max + 1)) :: u, pairs
      real(dp) :: r(size(u), smooth_count)
      integer :: i, j, lags

      m = real(min(m1, m2), dp)
      n = real(max(m1, m2), dp)
      other_terms = real(samples, dp) - 2*m + 1
      terms = real(samples, dp) - 2*n + 1
      last = n - m + terms
      ends = [0.0_dp, min(m, n - m), max(m, n - m), n, (n + m)*[1, 2, 4, 8, 16, 32]]
      lags = 0
      do i = 1, ends_max - 1
         if (ends(i) >= last) exit
         call append_segment(ends(i), min(ends(i + 1), last), u, pairs, lags)
      end do
      pairs(:lags) = pairs(:lags)*pair_count(u(:lags), n - m, terms)
      r(:lags, :) = lag_covariances(m, n, u(:lags))
      do j = 1, smooth_count
         plain(j + 1) = dot_product(pairs(:lags), r(:lags, j))
         do i = 1, j
            product(i + 1, j + 1) = sum(pairs(:lags)*r(:lags, i)*r(:lags, j))
            product(j + 1, i + 1) = product(i + 1, j + 1)
         end do
      end do
      call add_quantization(m, n, terms, product, plain)
      product = product/(2*(m*n)**2*terms*other_terms)
      plain = plain/(terms*other_terms)
   end subroutine sum_pair

   !> Number of pairs of terms whose centers are u apart (one sign).
   elemental real(dp) function pair_count(u, shift, terms)
      real(dp), intent(in) :: u, shift, terms

      pair_count = max(0.0_dp, terms - max(0.0_dp, u - shift))
   end function pair_count

   !> Appends both signs of the lags between two whole numbers (half the terms at the ends).
   pure subroutine append_segment(first, last, u, factor, lags)
      real(dp), intent(in) :: first, last
      real(dp), intent(inout) :: u(:), factor(:)
      integer, intent(inout) :: lags
      integer :: i, steps

      if (last <= first) return
      if (last - first <= direct_max) then
         steps = nint(last - first)
         u(lags + 1:lags + steps + 1) = [(first + i, i=0, steps)]
         factor(lags + 1:lags + steps + 1) = 2
         factor([lags + 1, lags + steps + 1]) = 1
         lags = lags + steps + 1
      else
         u(lags + 1:lags + node_count) = first + node*(last - first)
         factor(lags + 1:lags + node_count) = 2*weight*(last - first)
         lags = lags + node_count
      end if
   end subroutine append_segment

   !> What quantization noise adds: R_mn has a spike at each kink.
   pure subroutine add_quantization(m, n, terms, product, plain)
      real(dp), intent(in) :: m, n, terms
      real(dp), intent(inout) :: product(noise_count, noise_count), plain(noise_count)
      real(dp), parameter :: height(5) = [4.0_dp, 1.0_dp, -2.0_dp, -2.0_dp, 1.0_dp]
      real(dp) :: place(5), spike, r(5, smooth_count), factor
      integer :: i

      place = [0.0_dp, n - m, m, n, m + n]
      r = lag_covariances(m, n, place)
      product(1, :) = 0
      plain(1) = 0
      do i = 1, 5
         if (any(abs(place(:i - 1) - place(i)) < 0.5_dp)) cycle
         spike = sum(height, mask=abs(place - place(i)) < 0.5_dp)
         factor = 2*pair_count(place(i), n - m, terms)
         ! n = m: the differences meet from both sides
         if (i == 1) then
            factor = factor/2
            if (n - m < 0.5_dp) spike = 6
         end if
         product(1, 1) = product(1, 1) + factor*spike**2
         product(1, 2:) = product(1, 2:) + factor*spike*r(i, :)
         plain(1) = plain(1) + factor*spike
      end do
      product(2:, 1) = product(1, 2:)
   end subroutine add_quantization

   !> Covariances of N, B and K, each 1, of two differences whose centers are u >= 0 apart:
   !> [distances, terms].
   pure function lag_covariances(m, n, u) result(r)
      !> Averaging factors, and distances: [distances]
      real(dp), intent(in) :: m, n, u(:)
      !> For m = n = 1 the autocovariances of differences of successive means
      real(dp) :: r(size(u), smooth_count)
      real(dp), parameter :: factor(-1:1) = [1.0_dp, -2.0_dp, 1.0_dp]
      real(dp) :: t(size(u))
      integer :: side

      r = 0
      ! each up to a constant, which the outer difference removes
      do side = -1, 1
         t = abs(u + side*n)
         r(:, 1) = r(:, 1) + factor(side)*min(0.0_dp, t - m)
         r(:, 2) = r(:, 2) + factor(side)*per_two_pi*m**2*flicker_difference(t/m)
         r(:, 3) = r(:, 3) + factor(side)*(m**2*t/2 + max(0.0_dp, m - t)**3/6)
      end do
   end function lag_covariances

   !> (s+1)^2 ln(s+1) + (s-1)^2 ln|s-1| - 2 s^2 ln s without cancellation at large s.
   elemental real(dp) function flicker_difference(s) result(g)
      real(dp), intent(in) :: s
      real(dp) :: q

      if (s > 8) then
         q = 1/s**2
         g = 2*log(s) + 3 - q*(1/6.0_dp + q*(1/30.0_dp + q*(1/84.0_dp + q/180.0_dp)))
      else
         g = (s + 1)**2*log(s + 1) + (s - 1)**2*log(max(abs(s - 1), tiny(s))) &
            & - 2*s**2*log(max(s, tiny(s)))
      end if
   end function flicker_difference

end module gyroakf_allan_fit_covariance
