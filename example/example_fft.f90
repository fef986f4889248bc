! SPDX-License-Identifier: MIT
!> The spectrum of a sinusoid of period 97 samples in 970 (a length with a large prime factor).
program example_fft
   implicit none (type, external)

   call spectrum_of_sinusoid()

contains

   subroutine spectrum_of_sinusoid()
      use gyroakf, only : dp, int64, error_type
      use gyroakf_fft_real, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward
      integer(int64), parameter :: n = 970
      type(real_fft_plan_type) :: plan
      type(error_type), allocatable :: error
      real(dp) :: x(n)
      complex(dp) :: spectrum(0:n/2)
      integer(int64) :: i

      x = [(cos(2*acos(-1.0_dp)*i/97), i=0, n - 1)]
      call new_real_fft_plan(plan, n, error)
      if (allocated(error)) error stop error%message
      call real_fft_forward(plan, x, spectrum, error)
      if (allocated(error)) error stop error%message
      print "(a, i0, a, f0.6)", "largest line: ", maxloc(abs(spectrum), 1) - 1, " cycles, amplitude ", 2*maxval(abs(spectrum))/n
   end subroutine spectrum_of_sinusoid

end program example_fft
