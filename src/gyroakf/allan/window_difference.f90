! SPDX-License-Identifier: MIT
!> Squared differences of the means of two or three adjacent windows, at any stride, with or without
!> missing samples.
!>
!> Two windows: w2 - w1 (Allan); three: w3 - 2 w2 + w1 (Hadamard). Every averaging factor is applied
!> to a stretch of the record while it is in the cache; the stretches are fixed: the result does not
!> depend on the number of threads.
module gyroakf_allan_window_difference
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_threads, only : thread_count
   implicit none (type, external)
   private
   public :: window_sums_type, sum_windows, add_windows, add_sums, squared_differences

   !> What a record gives for one averaging factor
   type :: window_sums_type
      !> Sum of the squared differences of neighboring window means
      real(dp) :: squares = 0.0_dp
      !> Sum over the terms of 1/c_1 + 1/c_2 - 2/m, or of 1/c_1 + 4/c_2 + 1/c_3 - 6/m, c the present
      !> samples of each window
      real(dp) :: inflation = 0.0_dp
      !> Terms whose windows are complete enough
      integer(int64) :: terms = 0
      !> Total variance: their expectations in white noise, relative to that of a term that sees no
      !> end of the record
      real(dp) :: weight = 0.0_dp
   end type window_sums_type

   !> Samples of a stretch, and stretches that run in a batch
   integer(int64), parameter :: stretch_length = 65536, batch = 64
   !> Averaging factors whose sums of a batch are held at a time
   integer, parameter :: factors = 256
   !> Terms below which one thread is quicker
   integer(int64), parameter :: parallel_from = 500000
   !> Weights of the windows, of two and of three
   real(dp), parameter :: weights(3, 2:3) = &
      & reshape([-1.0_dp, 1.0_dp, 0.0_dp, 1.0_dp, -2.0_dp, 1.0_dp], [3, 2])

contains

   !> For each m the sums over k = 0, 1, 2 ... or 0, m, 2m ...
   subroutine sum_windows(phase, m, order, overlapping, sums, error, missing, coverage, progress)
      !> Phase, to which missing samples added nothing: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/order: [any number]
      integer(int64), intent(in) :: m(:)
      !> Windows, 2 or 3
      integer, intent(in) :: order
      !> Stride 1, else m
      logical, intent(in) :: overlapping
      !> The sums: [size(m)]; without gaps the squares are those of sums, not of means: m^2 times as
      !> large
      type(window_sums_type), intent(out) :: sums(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Missing samples so far: [0:n]; none are missing if absent
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      !> Share of a window that must be present, > 0, <= 1, with `missing`: [size(m)]
      real(dp), intent(in), optional :: coverage(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(window_sums_type), allocatable :: part(:, :)
      integer(int64) :: n, from, stretches, group, s, stride, first, last
      integer :: i, low, high, stat

      n = ubound(phase, 1, kind=int64)
      group = batch
      if (present(progress)) group = min(batch, int(2*thread_count(), int64))
      group = max(1_int64, min(group, (n + stretch_length - 1)/stretch_length))
      allocate (part(min(size(m), factors), group), stat=stat)
      call check_memory(stat, "the partial sums of the Allan variances", error)
      if (allocated(error)) return
      do from = 0, n - 1, group*stretch_length
         call report_progress("Allan deviation", from, n, error, progress)
         if (allocated(error)) return
         stretches = min(group, (n - from + stretch_length - 1)/stretch_length)
         do low = 1, size(m), factors
            high = min(low + factors - 1, size(m))
            !$omp parallel do schedule(dynamic) private(i, stride, first, last) &
            !$omp& if (n*size(m) >= parallel_from)
            do s = 1, stretches
               do i = low, high
                  stride = merge(1_int64, m(i), overlapping)
                  first = (from + (s - 1)*stretch_length + stride - 1)/stride*stride
                  last = min(from + s*stretch_length - 1, n - order*m(i))
                  if (present(missing)) then      ! absent ones are not passed on from here
                     call add_windows(phase, m(i), order, stride, first, last, &
                        & part(i - low + 1, s), missing, coverage(i))
                  else
                     call add_windows(phase, m(i), order, stride, first, last, part(i - low + 1, s))
                  end if
               end do
            end do
            !$omp end parallel do
            do s = 1, stretches
               call add_sums(part(:high - low + 1, s), sums(low:high))
            end do
         end do
      end do
   end subroutine sum_windows

   !> Adds the sums of some terms to those of others.
   elemental subroutine add_sums(part, total)
      !> What is added, and to what
      type(window_sums_type), intent(in) :: part
      type(window_sums_type), intent(inout) :: total

      total%squares = total%squares + part%squares
      total%inflation = total%inflation + part%inflation
      total%terms = total%terms + part%terms
      total%weight = total%weight + part%weight
   end subroutine add_sums

   !> The sums over the terms k = first, first + stride ... last.
   pure subroutine add_windows(phase, m, order, stride, first, last, sums, missing, coverage)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Windows, 2 or 3
      integer, intent(in) :: order
      !> From term to term, 1 or m; the first term; no term beyond
      integer(int64), intent(in) :: stride, first, last
      !> The sums
      type(window_sums_type), intent(out) :: sums
      !> Missing samples so far, [0:n], and share of a window that must be present
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      real(dp), intent(in), optional :: coverage

      integer(int64) :: beyond, allowed

      if (last < first) return
      beyond = last + order*m
      if (present(missing)) then
         allowed = min(int((1 - coverage)*real(m, dp) + 1e-9_dp, int64), m - 1, &
            & int(huge(0_int32), int64))
         if (stride == 1) then
            call add_gapped(m, order, int(allowed, int32), phase(first:beyond), &
               & missing(first:beyond), m, sums)
         else
            call add_gapped(m, order, int(allowed, int32), [phase(first:beyond:m)], &
               & [missing(first:beyond:m)], 1_int64, sums)
         end if
      else
         sums%terms = (last - first)/stride + 1
         if (stride == 1) then
            sums%squares = squared_differences(phase(first:beyond), m, order)
         else
            sums%squares = squared_differences([phase(first:beyond:m)], 1_int64, order)
         end if
      end if
   end subroutine add_windows

   !> Sum of the squared second or third differences of the phase.
   pure real(dp) function squared_differences(x, step, order) result(total)
      !> Phase from the first term to the end of the last
      real(dp), intent(in), contiguous :: x(:)
      !> Places from the beginning of a window to its end
      integer(int64), intent(in) :: step
      !> Order of the difference, 2 or 3
      integer, intent(in) :: order
      integer(int64) :: k

      total = 0
      if (order == 2) then
         !$omp simd reduction(+:total)
         do k = 1, size(x, kind=int64) - 2*step
            total = total + ((x(k + 2*step) - x(k + step)) - (x(k + step) - x(k)))**2
         end do
      else
         !$omp simd reduction(+:total)
         do k = 1, size(x, kind=int64) - 3*step
            total = total + ((x(k + 3*step) - x(k)) - 3*(x(k + 2*step) - x(k + step)))**2
         end do
      end if
   end function squared_differences

   !> Adds the terms whose windows lack at most `allowed` samples each; of two windows the third is
   !> empty and weighs nothing.
   pure subroutine add_gapped(m, order, allowed, x, lost, step, sums)
      integer(int64), intent(in) :: m
      integer, intent(in) :: order
      !> Missing samples that a window may have, < m
      integer(int32), intent(in) :: allowed
      !> Phase, and missing samples so far, from the first term to the end of the last
      real(dp), intent(in), contiguous :: x(:)
      integer(int32), intent(in), contiguous :: lost(:)
      !> Places from the beginning of a window to its end
      integer(int64), intent(in) :: step
      type(window_sums_type), intent(inout) :: sums

      real(dp) :: w(3), whole, n1, n2, n3, counts, i1, i2, i3, squares, inverse
      integer(int64) :: a, b, c, d
      integer(int32) :: lost1, lost2, lost3, terms

      w = weights(:, order)
      whole = real(m, dp)
      squares = 0
      inverse = 0
      terms = 0
      !$omp simd reduction(+:squares, inverse, terms) private(b, c, d, lost1, lost2, lost3) &
      !$omp& private(n1, n2, n3, counts, i1, i2, i3)
      do a = 1, size(x, kind=int64) - order*step
         b = a + step
         c = a + 2*step
         d = a + order*step
         lost1 = lost(b) - lost(a)
         lost2 = lost(c) - lost(b)
         lost3 = lost(d) - lost(c)
         counts = merge(1.0_dp, 0.0_dp, max(lost1, lost2, lost3) <= allowed)
         terms = terms + merge(1_int32, 0_int32, max(lost1, lost2, lost3) <= allowed)
         n1 = whole - min(lost1, allowed)
         n2 = whole - min(lost2, allowed)
         n3 = whole - min(lost3, allowed)
         counts = counts/(n1*n2*n3)
         i1 = w(1)*(n2*n3*counts)
         i2 = w(2)*(n1*n3*counts)
         i3 = w(3)*(n1*n2*counts)
         squares = squares + ((x(b) - x(a))*i1 + (x(c) - x(b))*i2 + (x(d) - x(c))*i3)**2
         inverse = inverse + (w(1)*i1 + w(2)*i2 + w(3)*i3)
      end do
      sums%squares = squares
      sums%inflation = inverse - real(terms, dp)*(sum(w**2)/whole)
      sums%terms = terms
   end subroutine add_gapped

end module gyroakf_allan_window_difference
