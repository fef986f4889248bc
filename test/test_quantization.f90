! SPDX-License-Identifier: MIT
!> Tests of the search for a step.
module test_quantization
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_quantization, only : quantization_type, find_quantization
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use series_library, only : reference_series
   use expectations, only : problem, test, error, check, check_refused
   implicit none (type, external)
   private
   public :: suite_quantization

contains

   subroutine suite_quantization()
      call test("by_hand", test_by_hand)
      call test("converter", test_converter)
      call test("odd_step", test_odd_step)
      call test("no_step", test_no_step)
      call test("sheppard", test_sheppard)
      call test("missing", test_missing)
      call test("offset_scale", test_offset_scale)
      call test("failures", test_failures)
   end subroutine suite_quantization

   !> The grid of a series, compared with its own standard deviation.
   subroutine run(x, grid, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(quantization_type), intent(out) :: grid
      integer(int8), intent(in), optional :: valid(:)
      type(moments_type) :: moments

      call compute_moments(x, moments, valid)
      call find_quantization(x, moments%std, grid, problem, valid)
      if (allocated(problem)) grid%levels = -1
   end subroutine run

   !> 0 2 2 6: a step of 2 on 3 of 4 levels, standard deviation sqrt(19/3).
   subroutine test_by_hand()
      type(quantization_type) :: grid

      call run([0.0_dp, 2.0_dp, 2.0_dp, 6.0_dp], grid)
      call check(error, grid%quantized .and. grid%levels == 3_int64, "quantized on 3 levels")
      call check(error, grid%step, 2.0_dp, thr=1.0e-15_dp)
      call check(error, grid%ratio, 2.0_dp/sqrt(19.0_dp/3.0_dp), thr=1.0e-15_dp)
      call check(error, grid%variance_share, 1.0_dp/19.0_dp, thr=1.0e-15_dp)
      call check(error, grid%corrected_std, sqrt(6.0_dp), thr=1.0e-14_dp)
   end subroutine test_by_hand

   !> Counts times a scale that is no binary number, 131 LSB per deg/s, on an offset of 1e4 steps.
   subroutine test_converter()
      type(quantization_type) :: grid

      call run((10000.0_dp + anint(20.0_dp*reference_series("wn", 70000)))/131.0_dp, grid)
      call check(error, grid%quantized, "not recognized")
      call check(error, grid%step, 1.0_dp/131.0_dp, thr=1.0e-12_dp, rel=.true.)
      call check(error, grid%ratio, 0.05_dp, thr=0.02_dp, rel=.true.)
      call check(error, grid%levels > 120_int64 .and. grid%levels < 200_int64, "levels")
   end subroutine test_converter

   !> 24 bits: recognized, levels not counted.
   subroutine test_odd_step()
      type(quantization_type) :: grid

      call run([0.1_dp*anint(1.0e6_dp*reference_series("wn", 5000)), 0.1_dp, 0.2_dp], grid)
      call check(error, grid%quantized .and. grid%levels == 0_int64, "recognized, levels not counted")
      call check(error, grid%step, 0.1_dp, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_odd_step

   !> Real numbers, one of them off the grid, a constant.
   subroutine test_no_step()
      type(quantization_type) :: grid
      real(dp), allocatable :: x(:)

      call run(reference_series("wn", 5000), grid)
      call check(error, .not. grid%quantized .and. grid%step <= 0.0_dp, "real numbers have no step")
      x = anint(20.0_dp*reference_series("wn", 5000))
      x(4000) = x(4000) + 0.5_dp
      call run(x, grid)
      call check(error, .not. grid%quantized, "one sample is off the grid")
      x = 3.0_dp
      call run(x, grid)
      call check(error, .not. grid%quantized .and. grid%levels == 0_int64, "a constant has no step")
   end subroutine test_no_step

   !> Normal samples rounded to one standard deviation: the correction finds it again, within the scatter of 70,000 samples.
   subroutine test_sheppard()
      type(quantization_type) :: grid
      type(moments_type) :: moments
      real(dp), allocatable :: x(:)

      x = reference_series("wn_bm", 70000)
      call compute_moments(x, moments)
      call run(anint(x), grid)
      call check(error, grid%corrected_std, moments%std, thr=3.0e-3_dp, rel=.true.)
      call check(error, grid%variance_share, 1.0_dp/13.0_dp, thr=0.01_dp, rel=.true.)
   end subroutine test_sheppard

   !> Missing samples need not stand on the grid.
   subroutine test_missing()
      type(quantization_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(5000)
      integer :: i

      x = anint(20.0_dp*reference_series("wn", 5000))
      valid = [(merge(0_int8, 1_int8, mod(i*i, 7) == 2), i=1, 5000)]
      call run(pack(x, valid == 1_int8), a)
      where (valid == 0_int8) x = 0.123_dp
      call run(x, b, valid)
      call check(error, b%quantized .and. b%levels == a%levels, "levels")
      call check(error, b%ratio, a%ratio, thr=1.0e-13_dp, rel=.true.)
   end subroutine test_missing

   !> 1e6 + 1e-3 x, the scale no power of two.
   subroutine test_offset_scale()
      type(quantization_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(20.0_dp*reference_series("ar1", 5000))
      call run(x, a)
      call run(1.0e6_dp + 1.0e-3_dp*x, b)
      call check(error, b%quantized .and. b%levels == a%levels, "levels")
      call check(error, b%step, 1.0e-3_dp*a%step, thr=1.0e-8_dp, rel=.true.)
      call check(error, b%ratio, a%ratio, thr=1.0e-7_dp, rel=.true.)
   end subroutine test_offset_scale

   !> A negative standard deviation.
   subroutine test_failures()
      type(quantization_type) :: grid

      call find_quantization([1.0_dp, 2.0_dp], -1.0_dp, grid, problem)
      call check_refused(problem, status%invalid_argument)
   end subroutine test_failures

end module test_quantization
