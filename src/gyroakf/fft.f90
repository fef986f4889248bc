! SPDX-License-Identifier: MIT
!> Fourier transforms: the whole interface under one name; this module holds no code.
!>
!> | what | where |
!> |---|---|
!> | complex data of any length | [[gyroakf_fft_plan]] |
!> | real data of any length, half the spectrum | [[gyroakf_fft_real]] |
!> | linear convolution | [[gyroakf_fft_convolution]] |
module gyroakf_fft
   use gyroakf_fft_lengths, only : smooth_length
   use gyroakf_fft_plan, only : fft_plan_type, new_fft_plan, fft_forward, fft_backward
   use gyroakf_fft_real, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward, &
      real_fft_backward
   use gyroakf_fft_convolution, only : convolve
   implicit none (type, external)
   private
   public :: fft_plan_type, new_fft_plan, fft_forward, fft_backward, smooth_length
   public :: real_fft_plan_type, new_real_fft_plan, real_fft_forward, real_fft_backward
   public :: convolve
end module gyroakf_fft
