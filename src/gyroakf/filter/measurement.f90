! SPDX-License-Identifier: MIT
!> What counts as a measurement.
module gyroakf_filter_measurement
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: is_sample, exponent_mask, exponent_limit

   !> The bits of the exponent, shifted to the right, and the exponent from which on a square may
   !> overflow
   integer(int64), parameter :: exponent_mask = 2047_int64, exponent_limit = 1023_int64 + 495_int64

contains

   !> Whether a value is a measurement: finite and below 1e149 in magnitude, so that its square is
   !> finite too.
   !>
   !> By the exponent's bits: a NaN meets no comparison, so nothing traps.
   elemental logical function is_sample(z)
      !> The value
      real(dp), intent(in) :: z

      is_sample = iand(shiftr(transfer(z, 0_int64), 52), exponent_mask) < exponent_limit
   end function is_sample
end module gyroakf_filter_measurement
