! SPDX-License-Identifier: MIT
!> Records of known noise, and their fits.
module noise_fit_runs
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use allan_series, only : flicker_of, normal_series, walk_of
   use expectations, only : failure => problem, went_wrong
   implicit none (type, external)
   private
   public :: not_fitted, mixed_record, correlated

contains

   !> Fits a record; on failure of the library the test fails.
   logical function not_fitted(rate, interval, options, curve, noise, valid)
      !> The record
      real(dp), intent(in), contiguous :: rate(:)
      real(dp), intent(in) :: interval
      type(noise_options), intent(in) :: options
      !> Results
      type(allan_curve_type), intent(out) :: curve
      type(noise_type), intent(out) :: noise
      !> Missing samples
      integer(int8), intent(in), optional :: valid(:)

      type(allan_options) :: grid

      if (present(valid)) then
         call compute_allan(rate, interval, grid, curve, failure, valid)
      else
         call compute_allan(rate, interval, grid, curve, failure)
      end if
      if (.not. allocated(failure)) call fit_noise(curve, options, noise, failure)
      not_fitted = went_wrong(failure)
   end function not_fitted

   !> N = 1, B = 0.1, K = 0.01 at unit interval.
   function mixed_record(n) result(rate)
      !> Samples
      integer, intent(in) :: n
      real(dp) :: rate(n)

      rate = normal_series(int(n, int64), 582047321_int64) + 0.1_dp*flicker_of(normal_series(int(n, int64), 1190275313_int64)) &
         & + 0.01_dp*walk_of(normal_series(int(n, int64), 90721183_int64), normal_series(int(n, int64), 1733921041_int64))
   end function mixed_record

   !> AR(1) of unit driving noise.
   function correlated(n, phi, seed) result(rate)
      integer, intent(in) :: n
      real(dp), intent(in) :: phi
      integer(int64), intent(in) :: seed
      real(dp) :: rate(n)
      integer :: i

      rate = normal_series(int(n, int64), seed)
      do i = 2, n
         rate(i) = phi*rate(i - 1) + rate(i)
      end do
   end function correlated
end module noise_fit_runs
