! SPDX-License-Identifier: MIT
!> Discrete Fourier transform of complex data of any length.
!>
!> Lengths whose prime factors are at most 13 take mixed-radix passes ([[gyroakf_fft_butterfly]]); any other length is
!> written as a convolution of such a length (Bluestein), so that a prime length costs O(n log n) too. A plan is read
!> only once made: any number of threads may use one plan at the same time.
!>
!>     call new_fft_plan(plan, n, error)
!>     call fft_forward(plan, x, error)       ! x(0:n-1) -> its spectrum, in place
!>     call fft_backward(plan, x, error)      ! and back: the identity, 1/n included
!>
!> Source: C. Van Loan, Computational Frameworks for the FFT (SIAM, 1992); L. Bluestein, A linear filtering approach
!> to the computation of the discrete Fourier transform, IEEE Trans. Audio Electroacoust. 18 (1970) 451.
module gyroakf_fft_plan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_fft_butterfly, only : apply_radix
   implicit none (type, external)
   private
   public :: fft_plan_type, new_fft_plan, fft_forward, fft_backward, smooth_length, unit_root, max_length, report_mask

   !> Largest prime factor that has its own pass
   integer, parameter :: largest_radix = 13

   !> Longest transform: products of two indices still fit 64 bits
   integer(int64), parameter :: max_length = 2_int64**40

   !> Points less one between two calls of the progress: a power of two less one
   integer(int64), parameter :: report_mask = 1048575_int64

   !> What a transform of one length needs
   type :: fft_plan_type
      !> Length of the transform
      integer(int64) :: length = 0
      !> Length of the mixed-radix transform inside: `length`, or the padded one of Bluestein's convolution
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
         call fatal_error(error, status%invalid_argument, "length of a Fourier transform must be 1 .. 2**40")
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
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the tables of a Fourier transform")
         return
      end if
      do j = 0, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", j, plan%inner, error, progress)
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
         call fatal_error(error, status%invalid_argument, "series and plan of a Fourier transform differ in length")
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
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for the work space of a Fourier transform")
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
      integer(int64) :: j

      do j = 0, size(x, kind=int64) - 1
         x(j) = conjg(x(j))
      end do
      call fft_forward(plan, x, error, progress)
      if (allocated(error)) return
      do j = 0, plan%length - 1
         x(j) = conjg(x(j))/plan%length
      end do
   end subroutine fft_backward

   !> Smallest length >= n whose prime factors are 2, 3 and 5.
   pure integer(int64) function smooth_length(n)
      !> 1 .. 2**41
      integer(int64), intent(in) :: n
      integer(int64) :: p5, p35

      smooth_length = 1
      do while (smooth_length < n)
         smooth_length = 2*smooth_length
      end do
      p5 = 1
      do while (p5 < smooth_length)
         p35 = p5
         do while (p35 < smooth_length)
            smooth_length = min(smooth_length, doubled_to(p35, n))
            p35 = 3*p35
         end do
         p5 = 5*p5
      end do
   end function smooth_length

   !> The root of unity exp(2 pi i j/n), from an angle of at most an eighth of a turn, so that it is right to the last bit
   !> or one beside it, and exactly symmetric.
   elemental complex(dp) function unit_root(j, n)
      !> Index 0 .. n-1
      integer(int64), intent(in) :: j
      !> Length 1 .. 2**41
      integer(int64), intent(in) :: n
      real(dp), parameter :: turn = 6.28318530717958647693_dp
      integer(int64) :: octant, rest
      real(dp) :: angle, c, s

      ! 8 j = octant n + rest; in odd octants the angle is measured back from the next multiple of 1/8
      octant = (8*j)/n
      rest = 8*j - octant*n
      if (mod(octant, 2_int64) == 1) rest = n - rest
      angle = turn*(real(rest, dp)/real(8*n, dp))
      c = cos(angle)
      s = sin(angle)
      select case (int(octant))
      case (0); unit_root = cmplx(c, s, dp)
      case (1); unit_root = cmplx(s, c, dp)
      case (2); unit_root = cmplx(-s, c, dp)
      case (3); unit_root = cmplx(-c, s, dp)
      case (4); unit_root = cmplx(-c, -s, dp)
      case (5); unit_root = cmplx(-s, -c, dp)
      case (6); unit_root = cmplx(s, -c, dp)
      case default; unit_root = cmplx(c, -s, dp)
      end select
   end function unit_root

   !> p times the power of two that reaches n
   pure integer(int64) function doubled_to(p, n)
      integer(int64), intent(in) :: p, n

      doubled_to = p
      do while (doubled_to < n)
         doubled_to = 2*doubled_to
      end do
   end function doubled_to

   !> The radices of a length, fours first; not allocated when a prime factor is too large.
   pure subroutine factorise(length, radix)
      integer(int64), intent(in) :: length
      integer, allocatable, intent(out) :: radix(:)
      integer, parameter :: candidates(7) = [4, 2, 3, 5, 7, 11, largest_radix]
      integer :: found(64), i, n
      integer(int64) :: rest

      n = 0
      rest = length
      do i = 1, size(candidates)
         do while (mod(rest, int(candidates(i), int64)) == 0)
            n = n + 1
            found(n) = candidates(i)
            rest = rest/candidates(i)
         end do
      end do
      if (rest == 1) then
         allocate (radix(n))
         radix(:) = found(:n)
      end if
   end subroutine factorise

   !> The mixed-radix transform, in place with a work array.
   subroutine transform(plan, x, work, error, progress)
      type(fft_plan_type), intent(in) :: plan
      complex(dp), intent(inout), contiguous :: x(0:)
      complex(dp), intent(inout), contiguous :: work(0:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer :: i
      integer(int64) :: done, left, piece, pieces
      logical :: in_work

      pieces = 1
      if (present(progress)) pieces = max(plan%inner/(report_mask + 1), 1_int64)
      done = 1
      in_work = .false.
      do i = 1, size(plan%radix)
         left = plan%inner/(done*plan%radix(i))
         do piece = 0, pieces - 1
            if (plan%inner > report_mask) call report_progress("Fourier transform", &
               & (i - 1)*plan%inner + (plan%inner/pieces)*piece, size(plan%radix)*plan%inner, error, progress)
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
      if (plan%inner > report_mask) call report_progress("Fourier transform", size(plan%radix)*plan%inner, &
         & size(plan%radix)*plan%inner, error, progress)
      if (.not. in_work) return
      do piece = 0, plan%inner - 1
         if (iand(piece + 1, report_mask) == 0) call report_progress("Fourier transform", size(plan%radix)*plan%inner, &
            & size(plan%radix)*plan%inner, error, progress)
         if (allocated(error)) return
         x(piece) = work(piece)
      end do
   end subroutine transform

   !> Bluestein's tables: the chirp and the spectrum of its conjugate, wrapped round the inner length.
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
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the tables of a Fourier transform")
         return
      end if
      do j = 0, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", 0_int64, plan%length, error, progress)
         if (allocated(error)) return
         plan%filter(j) = 0
      end do
      square = 0                                   ! j**2 modulo 2 n
      do j = 0, plan%length - 1
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", j, plan%length, error, progress)
         if (allocated(error)) return
         plan%chirp(j) = conjg(unit_root(square, 2*plan%length))
         plan%filter(j) = conjg(plan%chirp(j))
         if (j > 0) plan%filter(plan%inner - j) = plan%filter(j)
         square = mod(square + 2*j + 1, 2*plan%length)
      end do
      call transform(plan, plan%filter, work, error, progress)
   end subroutine prepare_chirp

   !> Bluestein: X_k = chirp_k sum_j (x_j chirp_j) conjg(chirp_{k-j}), a convolution of the inner length.
   subroutine transform_chirp(plan, x, work, stat, error, progress)
      type(fft_plan_type), intent(in) :: plan
      complex(dp), intent(inout), contiguous :: x(0:)
      complex(dp), intent(inout), contiguous :: work(0:)
      integer, intent(out) :: stat
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: a(:)
      integer(int64) :: j

      allocate (a(0:plan%inner - 1), stat=stat)
      if (stat /= 0) return
      do j = 0, plan%length - 1
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", j, plan%length, error, progress)
         if (allocated(error)) return
         a(j) = x(j)*plan%chirp(j)
      end do
      do j = plan%length, plan%inner - 1            ! memory touched for the first time, which may take a while
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", 0_int64, plan%length, error, progress)
         if (allocated(error)) return
         a(j) = 0
      end do
      call transform(plan, a, work, error, progress)
      if (allocated(error)) return
      do j = 0, plan%inner - 1
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", j, plan%inner, error, progress)
         if (allocated(error)) return
         a(j) = conjg(a(j)*plan%filter(j))
      end do
      call transform(plan, a, work, error, progress)
      if (allocated(error)) return
      do j = 0, plan%length - 1
         if (iand(j, report_mask) == 0) call report_progress("Fourier transform", j, plan%length, error, progress)
         if (allocated(error)) return
         x(j) = plan%chirp(j)*conjg(a(j))/plan%inner
      end do
      deallocate (a)                               ! which takes a while
      if (plan%inner > report_mask) call report_progress("Fourier transform", plan%length, plan%length, error, progress)
   end subroutine transform_chirp

end module gyroakf_fft_plan
