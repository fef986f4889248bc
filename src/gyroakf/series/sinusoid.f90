! SPDX-License-Identifier: MIT
!> A sinusoid in a series: least squares for amplitude, phase and frequency; its removal.
!>
!> The phase of a sample is taken modulo a turn at the beginning of each block and carried on inside it by a table, so that it is as
!> good at the end of a long series as at its beginning. Sums go by fixed parts of the series: they do not depend on the threads.
module gyroakf_series_sinusoid
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last, chunk_group
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_lapack, only : dposv
   implicit none (type, external)
   private
   public :: sinusoid_type, fit_sinusoid, remove_sinusoid

   !> $$c \cos 2\pi f t + s \sin 2\pi f t, \quad t = 0, 1, \ldots$$ from the first sample on
   type :: sinusoid_type
      !> Cycles per sample
      real(dp) :: frequency = 0.0_dp
      !> In the unit of the series
      real(dp) :: cosine = 0.0_dp, sine = 0.0_dp
      !> Constant that was fitted beside it
      real(dp) :: constant = 0.0_dp
      !> Present samples that it was fitted to
      real(dp) :: samples = 0.0_dp
   end type sinusoid_type

   real(dp), parameter :: turn = 6.28318530717958647693_dp
   !> Columns of the regression: 1, cos, sin, t cos, t sin, and the series
   integer, parameter :: columns = 6
   integer, parameter :: most_steps = 12
   !> A step of the frequency below this part of an ordinate ends the search
   real(dp), parameter :: small_step = 1.0e-7_dp

contains

   !> Fits a sinusoid, its frequency included.
   !>
   !> At a frequency f the series is regressed on 1, cos, sin, t cos, t sin; the coefficients p, q of the last two tell the step
   !> to the least squares' frequency, $$\delta\omega = (p s - q c)/(c^2 + s^2).$$
   !> Source: the linearised problem of B. G. Quinn & E. J. Hannan, The Estimation and Tracking of Frequency (2001), 3.2.
   subroutine fit_sinusoid(x, start, sinusoid, found, error, valid, progress)
      !> Series: [n], n >= 16; finite, 0 where missing
      real(dp), intent(in), contiguous :: x(:)
      !> Frequency to begin with, within one ordinate (1/n) of the line, cycles per sample
      real(dp), intent(in) :: start
      !> The sinusoid
      type(sinusoid_type), intent(out) :: sinusoid
      !> False: the regression is singular, or leads away from the start; the sinusoid is 0 then
      logical, intent(out) :: found
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: solution(columns - 1), samples, step, reach, half
      integer :: i

      sinusoid%frequency = start
      reach = 1.0_dp/real(size(x, kind=int64), dp)
      half = 0.5_dp*real(size(x, kind=int64), dp)
      do i = 1, most_steps
         call regress(x, sinusoid%frequency, .true., solution, samples, found, error, valid, progress)
         if (.not. found) exit
         step = (solution(4)*solution(3) - solution(5)*solution(2))/max(solution(2)**2 + solution(3)**2, tiny(step))/half/turn
         step = min(max(step, -0.5_dp*reach), 0.5_dp*reach)
         sinusoid%frequency = sinusoid%frequency + step
         found = abs(sinusoid%frequency - start) <= 1.5_dp*reach
         if (.not. found .or. abs(step) <= small_step*reach) exit
      end do
      if (found) call regress(x, sinusoid%frequency, .false., solution, samples, found, error, valid, progress)
      if (.not. found) return
      sinusoid%constant = solution(1)
      sinusoid%cosine = solution(2)
      sinusoid%sine = solution(3)
      sinusoid%samples = samples
   end subroutine fit_sinusoid

   !> Least squares of the series on 1, cos, sin and, with `slopes`, t cos and t sin, t from -1 to 1.
   subroutine regress(x, frequency, slopes, solution, samples, found, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: frequency
      logical, intent(in) :: slopes
      !> Coefficients; those of the slopes are 0 without them
      real(dp), intent(out) :: solution(columns - 1)
      !> Present samples
      real(dp), intent(out) :: samples
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> The columns are independent
      logical, intent(out) :: found
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: part(columns, columns, chunk_count(size(x, kind=int64))), gram(columns, columns)
      real(dp) :: cosine(0:block_length - 1), sine(0:block_length - 1)
      integer(int64) :: n, first, last
      integer :: chunk, used, info, from, group

      n = size(x, kind=int64)
      found = .false.
      solution = 0.0_dp
      samples = 0.0_dp
      call tabulate(frequency, cosine, sine)
      group = chunk_group(size(part, 3), present(progress))
      do from = 1, size(part, 3), group
         call tell_progress("fitting a line", chunk_first(n, from) - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel do default(none) shared(x, valid, n, frequency, cosine, sine, part, from, group) private(first, last) &
         !$omp& schedule(static) if (n >= threads_from)
         do chunk = from, min(from + group - 1, size(part, 3))
            first = chunk_first(n, chunk)
            last = chunk_last(n, chunk)
            if (present(valid)) then
               call add_chunk(x(first:last), first - 1, n, frequency, cosine, sine, part(:, :, chunk), valid(first:last))
            else
               call add_chunk(x(first:last), first - 1, n, frequency, cosine, sine, part(:, :, chunk))
            end if
         end do
      end do
      gram = 0.0_dp
      do chunk = 1, chunk_count(n)
         gram = gram + part(:, :, chunk)
      end do
      samples = gram(1, 1)
      used = merge(columns - 1, 3, slopes)
      solution(:used) = gram(:used, columns)
      call dposv("U", used, 1, gram, columns, solution, columns - 1, info)
      found = info == 0
   end subroutine regress

   !> Products of the columns over a part of the series, upper triangle.
   pure subroutine add_chunk(x, before, n, frequency, cosine, sine, gram, valid)
      !> The part, and how many samples are before it
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: before, n
      real(dp), intent(in) :: frequency
      !> cos and sin of the phases inside a block: [0:block_length-1]
      real(dp), intent(in) :: cosine(0:), sine(0:)
      real(dp), intent(out) :: gram(columns, columns)
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: column(block_length, columns)
      integer(int64) :: first, length, i
      integer :: a, b
      real(dp) :: middle

      gram = 0.0_dp
      middle = 0.5_dp*real(n - 1, dp)
      do first = 1, size(x, kind=int64), block_length
         length = min(block_length, size(x, kind=int64) - first + 1)
         call turn_block(frequency, before + first - 1, length, cosine, sine, column(:, 2), column(:, 3))
         column(:length, 1) = 1.0_dp
         if (present(valid)) then
            do i = 1, length
               if (valid(first + i - 1) == 0_int8) column(i, :3) = 0.0_dp
            end do
         end if
         do i = 1, length
            column(i, 6) = x(first + i - 1)*column(i, 1)
            column(i, 4) = (real(before + first + i - 2, dp) - middle)/(middle + 0.5_dp)
            column(i, 5) = column(i, 4)*column(i, 3)
            column(i, 4) = column(i, 4)*column(i, 2)
         end do
         do b = 1, columns
            do a = 1, b
               gram(a, b) = gram(a, b) + inner(column(:length, a), column(:length, b))
            end do
         end do
      end do
   end subroutine add_chunk

   pure real(dp) function inner(a, b)
      real(dp), intent(in), contiguous :: a(:), b(:)
      integer :: i

      inner = 0.0_dp
      !$omp simd reduction(+:inner)
      do i = 1, size(a)
         inner = inner + a(i)*b(i)
      end do
   end function inner

   !> cos and sin of 2 pi f j, j = 0 .. block_length-1.
   pure subroutine tabulate(frequency, cosine, sine)
      real(dp), intent(in) :: frequency
      real(dp), intent(out) :: cosine(0:), sine(0:)
      integer(int64) :: j

      do j = 0, size(cosine, kind=int64) - 1
         cosine(j) = cos(turn*part_of_turn(frequency, j))
         sine(j) = sin(turn*part_of_turn(frequency, j))
      end do
   end subroutine tabulate

   !> cos and sin of a block that begins after `before` samples.
   pure subroutine turn_block(frequency, before, length, cosine, sine, block_cosine, block_sine)
      real(dp), intent(in) :: frequency
      integer(int64), intent(in) :: before, length
      real(dp), intent(in) :: cosine(0:), sine(0:)
      real(dp), intent(inout), contiguous :: block_cosine(:), block_sine(:)
      real(dp) :: c, s
      integer(int64) :: j

      c = cos(turn*part_of_turn(frequency, before))
      s = sin(turn*part_of_turn(frequency, before))
      do j = 1, length
         block_cosine(j) = c*cosine(j - 1) - s*sine(j - 1)
         block_sine(j) = s*cosine(j - 1) + c*sine(j - 1)
      end do
   end subroutine turn_block

   !> f t less whole turns, f split so that the product with its upper part is exact.
   pure real(dp) function part_of_turn(frequency, t) result(part)
      real(dp), intent(in) :: frequency
      integer(int64), intent(in) :: t
      real(dp) :: upper, rest

      upper = real(int(scale(frequency, 22), int64), dp)       ! f 2**22 < 2**22, times t < 2**41
      rest = frequency - scale(upper, -22)
      part = scale(real(mod(int(upper, int64)*t, 4194304_int64), dp), -22) + rest*real(t, dp)
      part = part - anint(part)
   end function part_of_turn

   !> Takes a sinusoid and its constant away; what is missing stays as it is.
   subroutine remove_sinusoid(x, sinusoid, valid)
      !> Series: [n]
      real(dp), intent(inout), contiguous :: x(:)
      !> From [[fit_sinusoid]]
      type(sinusoid_type), intent(in) :: sinusoid
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: cosine(0:block_length - 1), sine(0:block_length - 1), c(block_length), s(block_length)
      integer(int64) :: n, first, length, i

      n = size(x, kind=int64)
      call tabulate(sinusoid%frequency, cosine, sine)
      !$omp parallel do default(none) shared(x, valid, n, sinusoid, cosine, sine) private(length, i, c, s) &
      !$omp& schedule(static) if (n >= threads_from)
      do first = 1, n, block_length
         length = min(block_length, n - first + 1)
         call turn_block(sinusoid%frequency, first - 1, length, cosine, sine, c, s)
         do i = 1, length
            if (present(valid)) then
               if (valid(first + i - 1) == 0_int8) cycle
            end if
            x(first + i - 1) = x(first + i - 1) - (sinusoid%constant + (sinusoid%cosine*c(i) + sinusoid%sine*s(i)))
         end do
      end do
   end subroutine remove_sinusoid

end module gyroakf_series_sinusoid
