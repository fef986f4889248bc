! SPDX-License-Identifier: MIT
!> Discrete Fourier transform of complex data of any length.
!>
!> Lengths whose prime factors are at most 13 take mixed-radix passes ([[gyroakf_fft_butterfly]]);
!> any other length is written as a convolution of such a length (Bluestein), so that a prime length
!> costs O(n log n) too. A plan is read only once made: any number of threads may use one plan at
!> the same time.
!>
!>     call new_fft_plan(plan, n, error)
!>     call fft_forward(plan, x, error)       ! x(0:n-1) -> its spectrum, in place
!>     call fft_backward(plan, x, error)      ! and back: the identity, 1/n included
!>
!> Source: C. Van Loan, Computational Frameworks for the FFT (SIAM, 1992); L. Bluestein, A linear
!> filtering approach to the computation of the discrete Fourier transform, IEEE Trans. Audio
!> Electroacoust. 18 (1970) 451.
module gyroakf_fft_plan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_fft_butterfly, only : apply_radix
   use gyroakf_fft_lengths, only : factorise, max_length, smooth_length, unit_root
   implicit none (type, external)
   private
   public :: fft_plan_type, new_fft_plan, fft_forward, fft_backward, report_mask, report_points

   !> Points less one between two calls of the progress: a power of two less one
   integer(int64), parameter :: report_mask = 1048575_int64

   !> What a transform of one length needs
   type :: fft_plan_type
      !> Length of the transform
      integer(int64) :: length = 0
      !> Length of the mixed-radix transform inside: `length`, or Bluestein's padded one
      integer(int64) :: inner = 0
      !> Radices of the inner transform, their product is `inner`
      integer, allocatable :: radix(:)
      !> exp(-2 pi i j/inner): [0:inner-1]
      complex(dp), allocatable :: twiddle(:)
      !> exp(-pi i j^2/length): [0:length-1]; only for Bluestein
      complex(dp), allocatable :: chirp(:)
      !> Spectrum of the conjugate chirp over `inner`: [0:inner-1]; only for Bluestein
      complex(dp), allocatable :: filter(:)
   end type fft_plan_type

contains

   !> Prepares transforms of one length.
   subroutine new_fft_plan(plan, length, error, progress)
      !> The plan
      type(fft_plan_type), intent(out) :: plan
      !> Number of points, 1 .. 2**40, of any factorisation
      integer(int64), intent(in) :: length
      !> invalid_argument: length out of range; no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer :: stat
      integer(int64) :: j

      if (length < 1 .or. length > max_length) then
         call fatal_error(error, status%invalid_argument, &
            "length of a Fourier transform must be 1 .. 2**40")
         return
      end if
      plan%length = length
      plan%inner = length
      call factorise(length, plan%radix)
      if (.not. allocated(plan%radix)) then
         plan%inner = smooth_length(2*length - 1)
         call factorise(plan%inner, plan%radix)
      end if
      allocate (plan%twiddle(0:plan%inner - 1), stat=stat)
      call check_memory(stat, "the tables of a Fourier transform", error)
      if (allocated(error)) return
      do j = 0, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_points(j, plan%inner, error, progress)
         if (allocated(error)) return
         plan%twiddle(j) = conjg(unit_root(j, plan%inner))
      end do
      if (plan%inner /= length) call prepare_chirp(plan, error, progress)
   end subroutine new_fft_plan

   !> Spectrum of a complex series.
   !>
   !> $$ X_k = \sum_{j=0}^{n-1} x_j e^{-2\pi i jk/n} $$
   subroutine fft_forward(plan, x, error, progress)
      !> Plan of the length of x
      type(fft_plan_type), intent(in) :: plan
      !> Series in, spectrum out: [n]
      complex(dp), intent(inout), contiguous :: x(0:)
      !> invalid_argument: another length than the plan's; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: work(:)
      integer :: stat

      if (size(x, kind=int64) /= plan%length) then
         call fatal_error(error, status%invalid_argument, &
            "series and plan of a Fourier transform differ in length")
         return
      end if
      allocate (work(0:plan%inner - 1), stat=stat)
      if (stat == 0) then
         if (allocated(plan%chirp)) then
            call transform_chirp(plan, x, work, stat, error, progress)
         else
            call transform(plan, x, work, error, progress)
         end if
      end if
      call check_memory(stat, "the work space of a Fourier transform", error)
   end subroutine fft_forward

   !> Series of a spectrum: the inverse of [[fft_forward]].
   !>
   !> $$ x_j = \frac{1}{n} \sum_{k=0}^{n-1} X_k e^{2\pi i jk/n} $$
   subroutine fft_backward(plan, x, error, progress)
      !> Plan of the length of x
      type(fft_plan_type), intent(in) :: plan
      !> Spectrum in, series out: [n]
      complex(dp), intent(inout), contiguous :: x(0:)
      !> invalid_argument: another length than the plan's; no_memory; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      x(:) = conjg(x)
      call fft_forward(plan, x, error, progress)
      if (allocated(error)) return
      x(:) = conjg(x)/plan%length
   end subroutine fft_backward

   !> Reports the progress of a transform.
   subroutine report_points(done, total, error, progress)
      !> Points that are done, and all of them
      integer(int64), intent(in) :: done, total
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call report_progress("Fourier transform", done, total, error, progress)
   end subroutine report_points

   !> The mixed-radix transform, in place with a work array.
   subroutine transform(plan, x, work, error, progress)
      type(fft_plan_type), intent(in) :: plan
      complex(dp), intent(inout), contiguous :: x(0:), work(0:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer :: i
      integer(int64) :: done, left, piece, pieces, all_points
      logical :: in_work

      pieces = 1
      if (present(progress)) pieces = max(plan%inner/(report_mask + 1), 1_int64)
      all_points = size(plan%radix)*plan%inner
      done = 1
      in_work = .false.
      do i = 1, size(plan%radix)
         left = plan%inner/(done*plan%radix(i))
         do piece = 0, pieces - 1
            if (plan%inner > report_mask) call report_points((i - 1)*plan%inner + &
               (plan%inner/pieces)*piece, all_points, error, progress)
            if (allocated(error)) return
            if (in_work) then
               call apply_radix(plan%radix(i), done, left, piece, pieces, work, x, plan%twiddle)
            else
               call apply_radix(plan%radix(i), done, left, piece, pieces, x, work, plan%twiddle)
            end if
         end do
         in_work = .not. in_work
         done = done*plan%radix(i)
      end do
      if (plan%inner > report_mask) call report_points(all_points, all_points, error, progress)
      if (.not. in_work) return
      do piece = 0, plan%inner - 1
         if (iand(piece + 1, report_mask) == 0) then
            call report_points(all_points, all_points, error, progress)
         end if
         if (allocated(error)) return
         x(piece) = work(piece)
      end do
   end subroutine transform

   !> Bluestein's tables: the chirp, the spectrum of its conjugate wrapped round the inner length.
   subroutine prepare_chirp(plan, error, progress)
      type(fft_plan_type), intent(inout) :: plan
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: work(:)
      integer(int64) :: j, square
      integer :: stat

      allocate (plan%chirp(0:plan%length - 1), stat=stat)
      if (stat == 0) allocate (plan%filter(0:plan%inner - 1), stat=stat)
      if (stat == 0) allocate (work(0:plan%inner - 1), stat=stat)
      call check_memory(stat, "the tables of a Fourier transform", error)
      if (allocated(error)) return
      do j = 0, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_points(0_int64, plan%length, error, progress)
         if (allocated(error)) return
         plan%filter(j) = 0
      end do
      square = 0                                   ! j**2 modulo 2 n
      do j = 0, plan%length - 1
         if (iand(j, report_mask) == 0) call report_points(j, plan%length, error, progress)
         if (allocated(error)) return
         plan%chirp(j) = conjg(unit_root(square, 2*plan%length))
         plan%filter(j) = conjg(plan%chirp(j))
         if (j > 0) plan%filter(plan%inner - j) = plan%filter(j)
         square = mod(square + 2*j + 1, 2*plan%length)
      end do
      call transform(plan, plan%filter, work, error, progress)
   end subroutine prepare_chirp

   !> Bluestein: X_k = chirp_k sum_j (x_j chirp_j) conjg(chirp_{k-j}), a cyclic convolution.
   subroutine transform_chirp(plan, x, work, stat, error, progress)
      type(fft_plan_type), intent(in) :: plan
      complex(dp), intent(inout), contiguous :: x(0:), work(0:)
      integer, intent(out) :: stat
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: a(:)
      integer(int64) :: j

      allocate (a(0:plan%inner - 1), stat=stat)
      if (stat /= 0) return
      do j = 0, plan%length - 1
         if (iand(j, report_mask) == 0) call report_points(j, plan%length, error, progress)
         if (allocated(error)) return
         a(j) = x(j)*plan%chirp(j)
      end do
      ! memory touched for the first time, which may take a while
      do j = plan%length, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_points(0_int64, plan%length, error, progress)
         if (allocated(error)) return
         a(j) = 0
      end do
      call transform(plan, a, work, error, progress)
      if (allocated(error)) return
      do j = 0, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_points(j, plan%inner, error, progress)
         if (allocated(error)) return
         a(j) = conjg(a(j)*plan%filter(j))
      end do
      call transform(plan, a, work, error, progress)
      if (allocated(error)) return
      do j = 0, plan%length - 1
         if (iand(j, report_mask) == 0) call report_points(j, plan%length, error, progress)
         if (allocated(error)) return
         x(j) = plan%chirp(j)*conjg(a(j))/plan%inner
      end do
      deallocate (a)                               ! which takes a while
      if (plan%inner > report_mask) call report_points(plan%length, plan%length, error, progress)
   end subroutine transform_chirp

end module gyroakf_fft_plan
