! SPDX-License-Identifier: MIT
!> The terms that the total variance adds to the overlapping Allan variance.
!>
!> The phase is continued beyond both ends by odd reflection, x(-j) = 2 x(0) - x(j) and x(n+j) = 2
!> x(n) - x(n-j). The second differences inside the record are those of the overlapping variance;
!> only the m - 1 at each end see the reflection, and they are found by index arithmetic, without
!> the extended series.
!> Source: C. A. Greenhall, D. A. Howe, D. B. Percival, "Total variance, an estimator of long-term
!> frequency stability", IEEE Trans. UFFC 46 (1999) 1183-1191.
!>
!> The reflection of the phase is a mirror image of the rate. With missing samples the mirror image
!> lacks the same ones: the window that reaches over the end holds samples twice, and its mean is
!> taken over those that are there, each as often as it occurs. A term near an end has another
!> expectation than one in the middle, in white noise 3j/m times (j < m/2) or 2 - j/m times as much,
!> which evens out over all j: where terms are lost the sum is divided by the sum of these weights,
!> not by their number.
module gyroakf_allan_reflection
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_allan_window_difference, only : add_sums, window_sums_type
   implicit none (type, external)
   private
   public :: add_reflections, complete_weight

   !> Terms of a partial sum, and how many of these run in a batch
   integer(int64), parameter :: block_length = 16384, batch = 256
   !> Terms below which one thread is quicker
   integer(int64), parameter :: parallel_from = 500000

contains

   !> Adds to the sums of squared second differences those whose center is less than m from an end;
   !> where samples are missing, differences of the means of the present samples of two windows.
   subroutine add_reflections(phase, m, sums, error, missing, coverage, progress)
      !> Phase, to which missing samples added nothing: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/2: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums to add to: [size(m)]; with `missing` the inflation is what unit white noise adds
      !> to the square of a term, else only the squares are added to
      type(window_sums_type), intent(inout) :: sums(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Missing samples so far: [0:n]; none are missing if absent
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      !> Share of a window that must be present, > 0, <= 1, with `missing`: [size(m)]
      real(dp), intent(in), optional :: coverage(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(window_sums_type) :: part(batch)
      integer(int64) :: blocks, b, first, from, to
      integer :: i

      do i = 1, size(m)
         sums(i)%weight = real(sums(i)%terms, dp)
         blocks = (m(i) + block_length - 2)/block_length
         do first = 1, blocks, batch
            call report_progress("ends of the record", sum(m(:i - 1)) + (first - 1)*block_length, &
               & sum(m), error, progress)
            if (allocated(error)) return
            !$omp parallel do schedule(static) private(from, to) if (m(i) >= parallel_from)
            do b = first, min(first + batch - 1, blocks)
               from = (b - 1)*block_length + 1
               to = min(b*block_length, m(i) - 1)
               if (present(missing)) then
                  call gapped_edges(phase, missing, m(i), coverage(i), from, to, &
                     & part(b - first + 1))
               else
                  part(b - first + 1)%squares = edge_squares(phase, m(i), from, to)
               end if
            end do
            !$omp end parallel do
            do b = 1, min(batch, blocks - first + 1)
               call add_sums(part(b), sums(i))
            end do
         end do
      end do
   end subroutine add_reflections

   !> Both ends: centers j and n - j.
   pure real(dp) function edge_squares(phase, m, first, last)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, first, last

      integer(int64) :: n, j
      real(dp) :: s1, s2, begin, finish

      n = ubound(phase, 1, kind=int64)
      begin = phase(0)
      finish = phase(n)
      s1 = 0
      s2 = 0
      !$omp simd reduction(+:s1, s2)
      do j = first, last
         s1 = s1 + ((phase(j + m) - phase(j)) - (phase(j) - begin) - (phase(m - j) - begin))**2
         s2 = s2 + ((phase(n - j - m) - phase(n - j)) - (phase(n - j) - finish) &
            & - (phase(n - m + j) - finish))**2
      end do
      edge_squares = s1 + s2
   end function edge_squares

   !> The weight of a complete record of n samples: n, less 1/m where m is odd.
   pure real(dp) function complete_weight(n, m)
      !> Samples, and averaging factor
      integer(int64), intent(in) :: n, m

      complete_weight = real(n, dp)
      if (mod(m, 2_int64) == 1) complete_weight = complete_weight - 1/real(m, dp)
   end function complete_weight

   !> Both ends: centers j and n - j.
   pure subroutine gapped_edges(phase, missing, m, coverage, first, last, sums)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), intent(in), contiguous :: missing(0:)
      integer(int64), intent(in) :: m
      real(dp), intent(in) :: coverage
      !> First and last j, within 1 .. m - 1
      integer(int64), intent(in) :: first, last
      type(window_sums_type), intent(out) :: sums

      integer(int64) :: n, j, near, far, least

      n = ubound(phase, 1, kind=int64)
      least = max(1_int64, m - int((1 - coverage)*real(m, dp) + 1e-9_dp, int64))
      do j = first, last
         near = min(j, m - j)
         far = max(j, m - j)
         call add_edge(m, j, least, (phase(j) - phase(0)) + (phase(m - j) - phase(0)), &
            & phase(j + m) - phase(j), near - (missing(near) - missing(0)), &
            & far - near - (missing(far) - missing(near)), m - (missing(j + m) - missing(j)), sums)
         call add_edge(m, j, least, (phase(n) - phase(n - j)) + (phase(n) - phase(n - m + j)), &
            & phase(n - j) - phase(n - j - m), near - (missing(n) - missing(n - near)), &
            & far - near - (missing(n - near) - missing(n - far)), &
            & m - (missing(n - j) - missing(n - j - m)), sums)
      end do
   end subroutine gapped_edges

   !> Adds a term if its two windows are complete enough.
   pure subroutine add_edge(m, j, least, outer, inner, twice, once, whole, sums)
      !> Averaging factor, distance of the center from the end, samples that a window must have
      integer(int64), intent(in) :: m, j, least
      !> Sums of the rate in the window that reaches over the end, and in the other
      real(dp), intent(in) :: outer, inner
      !> Present samples that the outer window holds twice and once, and those of the inner window
      integer(int64), intent(in) :: twice, once, whole
      type(window_sums_type), intent(inout) :: sums

      real(dp) :: c1, c2, white, complete

      if (min(2*twice + once, whole) < least) return
      c1 = real(2*twice + once, dp)
      c2 = real(whole, dp)
      if (2*j >= m) then
         complete = real(4*m - 2*j, dp)/real(m, dp)**2
         white = real(4*twice + once, dp)/c1**2 + 1/c2
      else                                ! what the outer window holds once is in the inner one too
         complete = 6*real(j, dp)/real(m, dp)**2
         white = 4*real(twice, dp)/c1**2 + real(once, dp)*(1/c1 - 1/c2)**2 &
            & + real(whole - once, dp)/c2**2
      end if
      sums%squares = sums%squares + (inner/c2 - outer/c1)**2
      sums%inflation = sums%inflation + (white - complete)
      sums%terms = sums%terms + 1
      sums%weight = sums%weight + complete*real(m, dp)/2
   end subroutine add_edge

end module gyroakf_allan_reflection
