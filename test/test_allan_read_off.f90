! SPDX-License-Identifier: MIT
!> Tests of the coefficients that are read off a curve.
module test_allan_read_off
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_model, only : model_variance
   use gyroakf_allan_read_off, only : read_off, read_off_type
   use allan_series, only : flicker_of, nbs14_long, normal_series, walk_of
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_allan_read_off

contains

   subroutine suite_allan_read_off()
      call test("single_terms", test_single_terms)
      call test("weights", test_weights)
      call test("mixture", test_mixture)
      call test("bend_is_no_segment", test_bend)
      call test("every_grid", test_every_grid)
      call test("nbs14", test_nbs14)
      call test("simulated", test_simulated)
      call test("minimum", test_minimum)
      call test("scale", test_scale)
      call test("failures", test_failures)
   end subroutine suite_allan_read_off

   !> A curve without scatter: m = 2^(k/per_octave), one sample in 0.01 s, white noise's degrees of freedom.
   subroutine noiseless(squares, per_octave, curve)
      real(dp), intent(in) :: squares(5)
      integer, intent(in) :: per_octave
      type(allan_curve_type), intent(out) :: curve
      integer :: i

      curve%samples = 2_int64**24
      curve%tau = [(0.01_dp*2.0_dp**(real(i, dp)/per_octave), i=0, 23*per_octave)]
      allocate (curve%deviation(size(curve%tau)), curve%edf(size(curve%tau)))
      do i = 1, size(curve%tau)
         curve%deviation(i) = sqrt(model_variance(squares, curve%tau(i)))
         curve%edf(i) = 1.5_dp*0.01_dp*real(curve%samples, dp)/curve%tau(i)
      end do
   end subroutine noiseless

   !> Of a single term nothing but that term is there, and it is exact.
   subroutine test_single_terms()
      type(allan_curve_type) :: curve
      type(read_off_type) :: read
      real(dp) :: squares(5)
      integer :: term

      do term = 1, 5
         squares = 0
         squares(term) = 2.5_dp**2
         call noiseless(squares, 1, curve)
         call read_off(curve, read, failed)
         if (unmet(.not. allocated(failed) .and. count(read%found) == 1 .and. read%found(term))) return
         call check(error, read%value(term), 2.5_dp, thr=2.5e-13_dp)
      end do
   end subroutine test_single_terms

   !> Points beside their line count by their degrees of freedom: the mean of the logarithms is weighted with them.
   subroutine test_weights()
      real(dp), parameter :: beside(5) = [0.004_dp, -0.002_dp, 0.001_dp, 0.003_dp, -0.004_dp]      ! decades
      real(dp), parameter :: edf(5) = [1600.0_dp, 800.0_dp, 400.0_dp, 200.0_dp, 100.0_dp]
      type(allan_curve_type) :: curve
      type(read_off_type) :: read

      curve%samples = 3200
      curve%tau = [1.0_dp, 2.0_dp, 4.0_dp, 8.0_dp, 16.0_dp]
      curve%deviation = 0.3_dp/sqrt(curve%tau)*10**beside
      curve%edf = edf
      call read_off(curve, read, failed)
      if (unmet(.not. allocated(failed) .and. read%found(2) .and. read%to_tau(2) > 15.0_dp)) return
      call check(error, read%value(2), 0.3_dp*10**(sum(edf*beside)/sum(edf)), thr=1e-14_dp, rel=.true.)
   end subroutine test_weights

   !> Terms far apart: each is read, never below the truth, and above it by little: where a neighbor bends the
   !> slope by 0.1, it has raised the deviation by 12 %, and K has a neighbor on both sides.
   subroutine test_mixture()
      real(dp), parameter :: truth(5) = [1e-2_dp, 1.0_dp, 0.1_dp, 1e-4_dp, 1e-8_dp]
      type(allan_curve_type) :: curve
      type(read_off_type) :: read
      integer :: i

      call noiseless(truth**2, 3, curve)
      curve%tau = [(1e-5_dp*10.0_dp**(0.1_dp*i), i=0, 160)]
      deallocate (curve%deviation)
      allocate (curve%deviation(161))
      curve%edf = curve%tau*0 + 1000
      do i = 1, 161
         curve%deviation(i) = sqrt(model_variance(truth**2, curve%tau(i)))
      end do
      call read_off(curve, read, failed)
      call check(error, all(read%found))
      call check(error, all(read%value >= truth .and. read%value <= 1.2_dp*truth))
      call check(error, all(read%from_tau < read%to_tau) .and. all(read%from_tau(2:) > read%to_tau(:4)))
   end subroutine test_mixture

   !> Q and K without N and B between them: the curve passes the slopes -1/2 and 0 within a tenth of a decade.
   subroutine test_bend()
      type(allan_curve_type) :: curve
      type(read_off_type) :: read

      call noiseless([1.0_dp, 0.0_dp, 0.0_dp, 1e-4_dp, 0.0_dp], 8, curve)
      call read_off(curve, read, failed)
      call check(error, all(read%found .eqv. [.true., .false., .false., .true., .false.]))
   end subroutine test_bend

   !> The grid hardly matters.
   subroutine test_every_grid()
      real(dp), parameter :: squares(5) = [0.0_dp, 1.0_dp, 0.4_dp, 2e-3_dp, 0.0_dp]
      type(allan_curve_type) :: curve
      type(read_off_type) :: read, fine

      call noiseless(squares, 1, curve)
      call read_off(curve, read, failed)
      call noiseless(squares, 20, curve)
      call read_off(curve, fine, failed)
      call check(error, all(read%found .eqv. fine%found) .and. count(fine%found) == 3)
      call check(error, maxval(abs(read%value(2:4)/fine%value(2:4) - 1)), 0.0_dp, thr=0.05_dp)
   end subroutine test_every_grid

   !> White noise of variance 1/12: N = 0.2887, nothing else; each point is read with 4 % scatter or less.
   subroutine test_nbs14()
      type(allan_curve_type) :: curve
      type(read_off_type) :: read

      call compute_allan(nbs14_long(), 1.0_dp, allan_options(), curve, failed)
      if (.not. allocated(failed)) call read_off(curve, read, failed)
      if (went_wrong(failed)) return
      call check(error, all(read%found .eqv. [.false., .true., .false., .false., .false.]))
      call check(error, read%value(2), sqrt(1/12.0_dp), thr=0.04_dp*sqrt(1/12.0_dp))
      call check(error, read%falling .and. read%minimum_tau > read%to_tau(2)/2)
   end subroutine test_nbs14

   !> White, flicker and random walk of 2^14 samples: all three are read, within 25 % (their lines raise each other).
   subroutine test_simulated()
      integer(int64), parameter :: n = 16384
      real(dp), parameter :: truth(2:4) = [1.0_dp, 0.3_dp, 4e-3_dp]
      type(allan_curve_type) :: curve
      type(read_off_type) :: read
      real(dp), allocatable :: x(:)

      x = truth(2)*normal_series(n, 5_int64) + truth(3)*flicker_of(normal_series(n, 6_int64)) &
         & + truth(4)*walk_of(normal_series(n, 7_int64), normal_series(n, 8_int64))
      call compute_allan(x, 1.0_dp, allan_options(), curve, failed)
      if (.not. allocated(failed)) call read_off(curve, read, failed)
      if (unmet(.not. allocated(failed) .and. all(read%found(2:3)) .and. .not. any(read%found([1, 5])))) return
      call check(error, maxval(abs(read%value(2:3)/truth(2:3) - 1)), 0.0_dp, thr=0.25_dp)
   end subroutine test_simulated

   !> The lowest point with enough degrees of freedom, not the lowest of all.
   subroutine test_minimum()
      type(allan_curve_type) :: curve
      type(read_off_type) :: read

      call noiseless([0.0_dp, 1.0_dp, 0.0_dp, 3.0_dp, 0.0_dp], 1, curve)     ! sqrt(1/tau + tau): lowest near 1
      curve%deviation(24) = 1e-3_dp
      curve%edf(24) = 1.5_dp
      call read_off(curve, read, failed)
      call check(error, read%minimum_tau, 1.28_dp, thr=1e-12_dp)
      call check(error, read%minimum, sqrt(1/1.28_dp + 1.28_dp), thr=1e-12_dp)
      call check(error, .not. read%falling)
      curve%edf = 1
      call read_off(curve, read, failed)
      call check(error, .not. allocated(failed) .and. .not. any(read%found) .and. read%minimum <= 0)
   end subroutine test_minimum

   !> Other units of the rate and of the time.
   subroutine test_scale()
      real(dp), parameter :: squares(5) = [0.0_dp, 1.0_dp, 0.4_dp, 2e-3_dp, 0.0_dp]
      real(dp), parameter :: power(5) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp]
      type(allan_curve_type) :: curve
      type(read_off_type) :: read, scaled

      call noiseless(squares, 2, curve)
      call read_off(curve, read, failed)
      curve%deviation = 3*curve%deviation
      curve%tau = 60*curve%tau
      call read_off(curve, scaled, failed)
      call check(error, all(read%found .eqv. scaled%found) .and. count(read%found) == 3)
      call check(error, maxval(abs(scaled%value - 3*60**power*read%value)/(3*60**power)), 0.0_dp, thr=1e-12_dp)
      call check(error, scaled%minimum, 3*read%minimum, thr=1e-12_dp)
   end subroutine test_scale

   subroutine test_failures()
      type(allan_curve_type) :: curve, empty
      type(read_off_type) :: read

      call noiseless([1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp], 1, curve)
      curve%kind = "mdev"
      call read_off(curve, read, failed)
      call check(error, failed%code, status%invalid_argument)
      call read_off(empty, read, failed)
      call check(error, failed%code, status%invalid_argument)
   end subroutine test_failures

end module test_allan_read_off
