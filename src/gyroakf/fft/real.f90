! SPDX-License-Identifier: MIT
!> Discrete Fourier transform of real data: half the spectrum, half the work.
!>
!> An even length is taken as n/2 complex points and unpacked, an odd one as a complex series.
!>
!>     call new_real_fft_plan(plan, n, error)
!>     call real_fft_forward(plan, x, spectrum, error)     ! x(0:n-1) -> spectrum(0:n/2)
!>     call real_fft_backward(plan, spectrum, x, error)    ! and back: the identity
!>
!> Source: C. Van Loan, Computational Frameworks for the FFT (SIAM, 1992), sec. 4.3.
module gyroakf_fft_real
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_fft_lengths, only : unit_root
   use gyroakf_fft_plan, only : fft_plan_type, new_fft_plan, fft_forward, fft_backward, &
      report_mask, report_points
   implicit none (type, external)
   private
   public :: real_fft_plan_type, new_real_fft_plan, real_fft_forward, real_fft_backward

   !> What a real transform of one length needs; read only once made
   type :: real_fft_plan_type
      !> Length of the real series
      integer(int64) :: length = 0
      !> Transform of length/2 points (even length) or of length points (odd)
      type(fft_plan_type) :: complex
      !> exp(-2 pi i k/length): [0:length/2]; only for an even length
      complex(dp), allocatable :: twiddle(:)
   end type real_fft_plan_type

contains

   !> Prepares real transforms of one length.
   subroutine new_real_fft_plan(plan, length, error, progress)
      !> The plan
      type(real_fft_plan_type), intent(out) :: plan
      !> Number of points, 1 .. 2**40, of any factorisation
      integer(int64), intent(in) :: length
      !> invalid_argument: length out of range; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: k
      integer :: stat

      plan%length = length
      if (mod(length, 2_int64) == 1) then
         call new_fft_plan(plan%complex, length, error, progress)
         return
      end if
      call new_fft_plan(plan%complex, length/2, error, progress)
      if (allocated(error)) return
      allocate (plan%twiddle(0:length/2), stat=stat)
      call check_memory(stat, "the tables of a Fourier transform", error)
      if (allocated(error)) return
      do k = 0, length/2
         if (iand(k, report_mask) == 0) call report_points(k, length/2, error, progress)
         if (allocated(error)) return
         plan%twiddle(k) = conjg(unit_root(k, length))
      end do
   end subroutine new_real_fft_plan

   !> Spectrum of a real series, from frequency 0 to the highest.
   !>
   !> $$ X_k = \sum_{j=0}^{n-1} x_j e^{-2\pi i jk/n}, \quad k = 0 \ldots \lfloor n/2 \rfloor; \quad
   !>    X_{n-k} = X_k^* $$
   subroutine real_fft_forward(plan, x, spectrum, error, progress)
      !> Plan of the length of x
      type(real_fft_plan_type), intent(in) :: plan
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(0:)
      !> Spectrum: [n/2 + 1], the quotient rounded down
      complex(dp), intent(out), contiguous :: spectrum(0:)
      !> invalid_argument: lengths that do not fit the plan; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: full(:)
      integer(int64) :: k, half
      integer :: stat

      half = plan%length/2
      call check_lengths(plan, size(x, kind=int64), size(spectrum, kind=int64), error)
      if (allocated(error)) return
      if (.not. allocated(plan%twiddle)) then
         allocate (full(0:plan%length - 1), stat=stat)
         call check_memory(stat, "the work space of a Fourier transform", error)
         if (allocated(error)) return
         do k = 0, plan%length - 1
            if (iand(k + 1, report_mask) == 0) call report_points(k, plan%length, error, progress)
            if (allocated(error)) return
            full(k) = x(k)
         end do
         call fft_forward(plan%complex, full, error, progress)
         if (.not. allocated(error) .and. half > report_mask) call report_points(half, half, &
            error, progress)
         if (allocated(error)) return
         spectrum(:) = full(:half)
         return
      end if
      do k = 0, half - 1
         if (iand(k + 1, report_mask) == 0) call report_points(k, half, error, progress)
         if (allocated(error)) return
         spectrum(k) = cmplx(x(2*k), x(2*k + 1), dp)
      end do
      call fft_forward(plan%complex, spectrum(:half - 1), error, progress)
      if (.not. allocated(error) .and. &
         half > report_mask) call report_points(half, half, error, progress)
      if (.not. allocated(error)) call unpack_spectrum(plan, spectrum, error, progress)
   end subroutine real_fft_forward

   !> Series of a half spectrum: the inverse of [[real_fft_forward]]. The imaginary parts of the
   !> first value and, for an even length, of the last are ignored (they are zero for a real
   !> series).
   subroutine real_fft_backward(plan, spectrum, x, error, progress)
      !> Plan of the length of x
      type(real_fft_plan_type), intent(in) :: plan
      !> Spectrum: [n/2 + 1]; used as work space, its values are lost
      complex(dp), intent(inout), contiguous :: spectrum(0:)
      !> Series: [n]
      real(dp), intent(out), contiguous :: x(0:)
      !> invalid_argument: lengths that do not fit the plan; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: full(:)
      integer(int64) :: k, half
      integer :: stat

      half = plan%length/2
      call check_lengths(plan, size(x, kind=int64), size(spectrum, kind=int64), error)
      if (allocated(error)) return
      if (.not. allocated(plan%twiddle)) then
         allocate (full(0:plan%length - 1), stat=stat)
         call check_memory(stat, "the work space of a Fourier transform", error)
         if (allocated(error)) return
         full(0) = real(spectrum(0), dp)
         do k = 1, half
            full(k) = spectrum(k)
            full(plan%length - k) = conjg(spectrum(k))
         end do
         call fft_backward(plan%complex, full, error, progress)
         x(:) = real(full, dp)
         return
      end if
      call pack_spectrum(plan, spectrum)
      if (half > report_mask) call report_points(0_int64, half, error, progress)
      if (allocated(error)) return
      call fft_backward(plan%complex, spectrum(:half - 1), error, progress)
      if (allocated(error)) return
      do k = 0, half - 1
         x(2*k) = real(spectrum(k), dp)
         x(2*k + 1) = aimag(spectrum(k))
      end do
   end subroutine real_fft_backward

   !> From Z, the spectrum of even + i odd samples: (Z_k + Z*_{h-k})/2 - i w_k (Z_k - Z*_{h-k})/2.
   subroutine unpack_spectrum(plan, z, error, progress)
      type(real_fft_plan_type), intent(in) :: plan
      complex(dp), intent(inout), contiguous :: z(0:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: k, half
      complex(dp) :: even, odd, first

      half = plan%length/2
      first = z(0)
      z(0) = real(first, dp) + aimag(first)
      z(half) = real(first, dp) - aimag(first)
      do k = 1, half/2
         if (iand(k, report_mask) == 0) call report_points(half, half, error, progress)
         if (allocated(error)) return
         even = 0.5_dp*(z(k) + conjg(z(half - k)))
         odd = 0.5_dp*(z(k) - conjg(z(half - k)))
         odd = plan%twiddle(k)*cmplx(aimag(odd), -real(odd, dp), dp)
         z(k) = even + odd
         z(half - k) = conjg(even - odd)
      end do
   end subroutine unpack_spectrum

   !> The inverse of unpack_spectrum.
   pure subroutine pack_spectrum(plan, z)
      type(real_fft_plan_type), intent(in) :: plan
      complex(dp), intent(inout), contiguous :: z(0:)
      integer(int64) :: k, half
      complex(dp) :: even, odd

      half = plan%length/2
      z(0) = 0.5_dp*cmplx(real(z(0) + z(half), dp), real(z(0) - z(half), dp), dp)
      do k = 1, half/2
         even = 0.5_dp*(z(k) + conjg(z(half - k)))
         odd = 0.5_dp*conjg(plan%twiddle(k))*(z(k) - conjg(z(half - k)))
         odd = cmplx(-aimag(odd), real(odd, dp), dp)
         z(k) = even + odd
         z(half - k) = conjg(even - odd)
      end do
   end subroutine pack_spectrum

   !> The arrays must have the plan's lengths.
   subroutine check_lengths(plan, samples, frequencies, error)
      type(real_fft_plan_type), intent(in) :: plan
      integer(int64), intent(in) :: samples, frequencies
      type(error_type), allocatable, intent(out) :: error

      if (plan%length < 1 .or. samples /= plan%length .or. frequencies /= plan%length/2 + 1) then
         call fatal_error(error, status%invalid_argument, &
            "series, spectrum and plan of a Fourier transform differ in length")
      end if
   end subroutine check_lengths

end module gyroakf_fft_real
