! SPDX-License-Identifier: MIT
!> Linear convolution of two real series through the Fourier transform.
module gyroakf_fft_convolution
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_fft_lengths, only : smooth_length, max_length
   use gyroakf_fft_real, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward, &
      real_fft_backward
   implicit none (type, external)
   private
   public :: convolve

contains

   !> The first values of the linear convolution of two series.
   !>
   !> $$ c_k = \sum_{j=0}^{k} a_j b_{k-j}, \quad k = 0 \ldots n_c - 1, $$
   !> values outside a and b being zero. Cost O(n log n), n = min(n_a, n_c) + min(n_b, n_c). The
   !> error of every value is a few epsilon of the product of the two series' norms.
   subroutine convolve(a, b, c, error, progress)
      !> First series: [na], na >= 1
      real(dp), intent(in), contiguous :: a(:)
      !> Second series: [nb], nb >= 1
      real(dp), intent(in), contiguous :: b(:)
      !> Convolution: [nc], 1 <= nc <= na + nb - 1; what is beyond is not formed
      real(dp), intent(out), contiguous :: c(:)
      !> invalid_argument: an empty series, or c longer than the convolution; no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(real_fft_plan_type) :: plan
      real(dp), allocatable :: padded(:)
      complex(dp), allocatable :: spectrum(:), other(:)
      integer(int64) :: na, nb, nc, n, k
      integer :: stat

      nc = size(c, kind=int64)
      na = min(size(a, kind=int64), nc)
      nb = min(size(b, kind=int64), nc)
      if (min(na, nb) < 1 .or. nc > size(a, kind=int64) + size(b, kind=int64) - 1 .or. &
         nc > max_length/4) then
         call fatal_error(error, status%invalid_argument, &
            "convolution: lengths must be 1 .. na + nb - 1")
         return
      end if
      n = 2*smooth_length((na + nb)/2)
      allocate (padded(n), stat=stat)
      if (stat == 0) allocate (spectrum(n/2 + 1), stat=stat)
      if (stat == 0) allocate (other(n/2 + 1), stat=stat)
      call check_memory(stat, "a convolution", error)
      if (allocated(error)) return
      call new_real_fft_plan(plan, n, error, progress)
      if (allocated(error)) return
      padded(:na) = a(:na)
      call report_progress("convolution", 0_int64, n, error, progress)
      if (allocated(error)) return
      padded(na + 1:) = 0
      call real_fft_forward(plan, padded, spectrum, error, progress)
      if (.not. allocated(error)) call report_progress("convolution", n/4, n, error, progress)
      if (allocated(error)) return
      padded(:nb) = b(:nb)
      padded(nb + 1:) = 0
      call real_fft_forward(plan, padded, other, error, progress)
      if (.not. allocated(error)) call report_progress("convolution", n/2, n, error, progress)
      if (allocated(error)) return
      do k = 1, n/2 + 1
         spectrum(k) = spectrum(k)*other(k)
      end do
      call real_fft_backward(plan, spectrum, padded, error, progress)
      if (.not. allocated(error)) call report_progress("convolution", n, n, error, progress)
      if (.not. allocated(error)) c(:) = padded(:nc)
   end subroutine convolve

end module gyroakf_fft_convolution
