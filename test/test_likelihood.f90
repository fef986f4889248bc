! SPDX-License-Identifier: MIT
!> The likelihood of drift models against dense Gaussians, and its gradient.
module test_likelihood
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : unmet, failed => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   use filter_library, only : dense_likelihood, fill_noise, make_series
   implicit none (type, external)
   private
   public :: suite_likelihood

   !> Rounding of a dense Cholesky factorisation of 50 samples
   real(dp), parameter :: dense = 1.0e-11_dp

contains

   subroutine suite_likelihood()
      call test("dense", test_dense)
      call test("gradient", test_gradient)
      call test("steady", test_steady)
      call test("maximum", test_maximum)
      call test("scale", test_scale)
      call test("refused", test_refused)
   end subroutine suite_likelihood

   !> Random walk, AR(1) and white noise.
   pure type(component_model_type) function mixture(walk)
      logical, intent(in) :: walk

      mixture%count = 2
      mixture%phi(:2) = [0.6_dp, 0.95_dp]
      mixture%q(:2) = [0.3_dp, 0.05_dp]
      mixture%r = 0.8_dp
      if (.not. walk) return
      mixture%count = 3
      mixture%phi(3) = 1.0_dp
      mixture%q(3) = 0.02_dp
   end function mixture

   !> Normal numbers.
   function normal_series(n, seed) result(z)
      integer(int64), intent(in) :: n
      integer, intent(in) :: seed
      real(dp) :: z(n)

      call fill_noise(seed, z)
   end function normal_series

   !> Compares filter and factorisation.
   subroutine compare(model, z, here)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in), contiguous :: z(:)
      logical, intent(in) :: here(:)
      real(dp) :: value

      call component_likelihood(model, z, value, failed, int(merge(1, 0, here), int8))
      if (went_wrong(failed)) return
      call check(error, value, dense_likelihood(model, z, here), thr=dense, rel=.true.)
   end subroutine compare

   !> One to three processes, samples missing, also before the first measurement; a filter that
   !> needs thousands of samples to come to rest is not taken as being there after some hundred.
   subroutine test_dense()
      type(component_model_type) :: model
      logical :: here(400)

      here = .true.
      model = component_model_type(1, [0.9_dp, 0.0_dp, 0.0_dp], [0.4_dp, 0.0_dp, 0.0_dp], 1.5_dp)
      call compare(model, normal_series(50_int64, 3), here(:50))
      call compare(mixture(.false.), normal_series(50_int64, 4), here(:50))
      call compare(mixture(.true.), 7.0_dp + normal_series(50_int64, 5), here(:50))
      model = mixture(.true.)
      model%q(3) = 1.0e-6_dp
      call compare(model, normal_series(400_int64, 15), here)
      here([2, 3, 17, 30, 31, 32, 50]) = .false.
      call compare(mixture(.true.), normal_series(50_int64, 6), here(:50))
      call compare(mixture(.false.), normal_series(50_int64, 6), here(:50))
      here(:50) = .true.
      here(:9) = .false.
      call compare(mixture(.true.), normal_series(50_int64, 8), here(:50))
   end subroutine test_dense

   !> Against central differences, with gaps and a random walk.
   subroutine test_gradient()
      type(component_model_type) :: model, near
      real(dp) :: z(400), gradient(7), value, above, below, h
      integer :: m

      model = mixture(.true.)
      z = normal_series(400_int64, 9)
      z([5, 60, 61]) = ieee_value(1.0_dp, ieee_quiet_nan)
      call component_likelihood(model, z, value, failed, gradient=gradient)
      if (unmet(.not. allocated(failed) .and. abs(gradient(3)) <= 0.0_dp)) return
      do m = 1, 7
         if (m == 3) cycle
         h = 1.0e-6_dp
         near = moved(model, m, h)
         call component_likelihood(near, z, above, failed)
         near = moved(model, m, -h)
         call component_likelihood(near, z, below, failed)
         call check(error, gradient(m), (above - below)/(2*h), thr=1.0e-5_dp, rel=.true.)
      end do
   end subroutine test_gradient

   !> The model with a parameter moved.
   pure type(component_model_type) function moved(model, m, by)
      type(component_model_type), intent(in) :: model
      integer, intent(in) :: m
      real(dp), intent(in) :: by

      moved = model
      if (m <= 3) then
         moved%phi(m) = moved%phi(m) + by
      else if (m <= 6) then
         moved%q(m - 3) = moved%q(m - 3) + by
      else
         moved%r = moved%r + by
      end if
   end function moved

   !> The steady gain changes nothing: the likelihood is the sum of those of windows too short to settle, given what is before them.
   subroutine test_steady()
      type(component_model_type) :: model
      real(dp), allocatable :: z(:)
      real(dp) :: whole, parts, piece, gradient(3)
      integer :: k

      model%count = 1
      model%phi(1) = 0.7_dp
      model%q(1) = 0.5_dp
      model%r = 1.0_dp
      z = normal_series(20000_int64, 10)
      call component_likelihood(model, z, whole, failed, gradient=gradient)
      if (went_wrong(failed)) return
      parts = 0.0_dp
      do k = 0, 199                                        ! what is more than 40 samples back counts 0.4^40
         call component_likelihood(model, z(max(1, 100*k - 39):100*k + 100), piece, failed)
         parts = parts + piece
         if (k == 0) cycle
         call component_likelihood(model, z(100*k - 39:100*k), piece, failed)
         parts = parts - piece
      end do
      call check(error, whole, parts, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_steady

   !> The true parameters of a long series are likelier than others by far more than chance (half a chi-square a parameter).
   subroutine test_maximum()
      type(component_model_type) :: model
      real(dp) :: z(50000), value, other

      call make_series(11, 0.9_dp, 1.0_dp, 1.0_dp, z)
      model%count = 1
      model%phi(1) = 0.9_dp
      model%q(1) = 0.19_dp
      model%r = 1.0_dp
      call component_likelihood(model, z, value, failed)
      model%phi(1) = 0.85_dp
      call component_likelihood(model, z, other, failed)
      call check(error, value > other + 10)
      model%phi(1) = 0.9_dp
      model%r = 1.2_dp
      call component_likelihood(model, z, other, failed)
      call check(error, value > other + 10)
   end subroutine test_maximum

   !> Values and standard deviations times s: ln L less n ln s, less one where the first sets the level.
   subroutine test_scale()
      type(component_model_type) :: model
      real(dp) :: z(300), value, scaled
      real(dp), parameter :: s = 3.0e-4_dp

      z = normal_series(300_int64, 13)
      model = mixture(.true.)
      call component_likelihood(model, z, value, failed)
      model%q = s*s*model%q
      model%r = s*s*model%r
      call component_likelihood(model, s*(z + 1.0e4_dp), scaled, failed)
      ! the offset costs the digits that 1e4 has before the point
      call check(error, scaled + 299*log(s), value, thr=1.0e-10_dp, rel=.true.)
   end subroutine test_scale

   subroutine test_refused()
      type(component_model_type) :: model
      real(dp) :: z(10), value

      z = normal_series(10_int64, 14)
      call component_likelihood(model, z, value, failed)
      call check_refused(failed, status%invalid_argument)
      model = mixture(.true.)
      model%phi(1) = 1.0_dp
      call component_likelihood(model, z, value, failed)
      call check_refused(failed, status%invalid_argument)
      model%phi(1) = -1.2_dp
      call component_likelihood(model, z, value, failed)
      call check_refused(failed, status%unstable)
      model = mixture(.true.)
      call component_likelihood(model, z(:1), value, failed)
      call check_refused(failed, status%too_few_samples)
      model%r = ieee_value(1.0_dp, ieee_quiet_nan)
      call component_likelihood(model, z, value, failed)
      call check_refused(failed, status%non_finite)
   end subroutine test_refused

end module test_likelihood
