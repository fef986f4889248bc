! SPDX-License-Identifier: MIT
!> Squared differences of the means of two or three adjacent windows, at any stride, with or without missing samples.
!>
!> Two windows: w2 - w1 (Allan); three: w3 - 2 w2 + w1 (Hadamard). Partial sums belong to fixed stretches of terms:
!> the result does not depend on the number of threads.
module gyroakf_allan_window_difference
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_allan_second_difference, only : gap_sums_type
   implicit none (type, external)
   private
   public :: sum_separate_differences, sum_gapped_windows

   !> Terms of a stretch, and stretches that run in a batch
   integer(int64), parameter :: stretch_length = 65536
   integer(int64), parameter :: batch = 64
   !> Terms below which one thread is quicker
   integer(int64), parameter :: parallel_from = 500000

contains

   !> For each m the sum over k = 0, m, 2m ... of the squared difference of the phase.
   subroutine sum_separate_differences(phase, m, order, sums, error, progress)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/order: [any number]
      integer(int64), intent(in) :: m(:)
      !> Order of the difference, 2 or 3
      integer, intent(in) :: order
      !> The sums: [size(m)]
      real(dp), intent(out) :: sums(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      real(dp) :: part(batch)
      integer(int64) :: n, terms, from, stretches, s
      integer :: i

      n = ubound(phase, 1, kind=int64)
      do i = 1, size(m)
         terms = n/m(i) - order + 1
         sums(i) = 0
         do from = 0, terms - 1, batch*stretch_length
            call tell_progress("Allan deviation", n*(i - 1) + from*m(i), n*size(m), error, progress)
            if (allocated(error)) return
            stretches = min(batch, (terms - from + stretch_length - 1)/stretch_length)
            !$omp parallel do schedule(static) if (terms >= parallel_from)
            do s = 1, stretches
               part(s) = separate_squares(phase, m(i), order, from + (s - 1)*stretch_length, &
                  & min(from + s*stretch_length, terms) - 1)
            end do
            !$omp end parallel do
            sums(i) = sums(i) + sum(part(:stretches))
         end do
      end do
   end subroutine sum_separate_differences

   !> Some neighboring terms.
   pure real(dp) function separate_squares(phase, m, order, first, last) result(total)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Order of the difference, 2 or 3
      integer, intent(in) :: order
      !> First and last term, from 0
      integer(int64), intent(in) :: first, last

      integer(int64) :: k

      total = 0
      if (order == 2) then
         !$omp simd reduction(+:total)
         do k = first*m, last*m, m
            total = total + ((phase(k + 2*m) - phase(k + m)) - (phase(k + m) - phase(k)))**2
         end do
      else
         !$omp simd reduction(+:total)
         do k = first*m, last*m, m
            total = total + ((phase(k + 3*m) - phase(k)) - 3*(phase(k + 2*m) - phase(k + m)))**2
         end do
      end if
   end function separate_squares

   !> The same for a record with missing samples: means of the present samples, at stride 1 or m.
   subroutine sum_gapped_windows(phase, missing, m, order, overlapping, coverage, sums, error, progress)
      !> Phase, to which missing samples added nothing: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors, 1 <= m <= n/order: [any number]
      integer(int64), intent(in) :: m(:)
      !> Windows, 2 or 3
      integer, intent(in) :: order
      !> Stride 1, else m
      logical, intent(in) :: overlapping
      !> Share of a window that must be present, > 0, <= 1: [size(m)]
      real(dp), intent(in) :: coverage(:)
      !> The sums: [size(m)]; the inflation is the sum of 1/c_1 + 1/c_2 - 2/m, or of 1/c_1 + 4/c_2 + 1/c_3 - 6/m
      type(gap_sums_type), intent(out) :: sums(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(gap_sums_type) :: part(batch)
      integer(int64) :: n, terms, from, stretches, s, stride
      integer :: i

      n = ubound(phase, 1, kind=int64)
      do i = 1, size(m)
         stride = merge(1_int64, m(i), overlapping)
         terms = (n - order*m(i))/stride + 1
         do from = 0, terms - 1, batch*stretch_length
            call tell_progress("Allan deviation", n*(i - 1) + from*stride, n*size(m), error, progress)
            if (allocated(error)) return
            stretches = min(batch, (terms - from + stretch_length - 1)/stretch_length)
            !$omp parallel do schedule(static) if (terms >= parallel_from)
            do s = 1, stretches
               call gapped_terms(phase, missing, m(i), order, stride, coverage(i), from + (s - 1)*stretch_length, &
                  & min(from + s*stretch_length, terms) - 1, part(s))
            end do
            !$omp end parallel do
            sums(i)%squares = sums(i)%squares + sum(part(:stretches)%squares)
            sums(i)%inflation = sums(i)%inflation + sum(part(:stretches)%inflation)
            sums(i)%terms = sums(i)%terms + sum(part(:stretches)%terms)
         end do
      end do
   end subroutine sum_gapped_windows

   !> Some neighboring terms of a record with gaps.
   pure subroutine gapped_terms(phase, missing, m, order, stride, coverage, first, last, sums)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Windows, 2 or 3
      integer, intent(in) :: order
      !> Samples from term to term
      integer(int64), intent(in) :: stride
      !> Share of a window that must be present
      real(dp), intent(in) :: coverage
      !> First and last term, from 0
      integer(int64), intent(in) :: first, last
      !> The sums
      type(gap_sums_type), intent(out) :: sums

      real(dp), parameter :: weights(3, 2:3) = reshape([-1.0_dp, 1.0_dp, 0.0_dp, 1.0_dp, -2.0_dp, 1.0_dp], [3, 2])
      real(dp) :: z, inverse, there
      integer(int64) :: t, k, allowed, lost
      integer :: w

      allowed = min(int((1 - coverage)*real(m, dp) + 1e-9_dp, int64), m - 1)
      do t = first, last
         z = 0
         inverse = 0
         do w = 1, order
            k = t*stride + (w - 1)*m
            lost = missing(k + m) - missing(k)
            if (lost > allowed) exit
            there = real(m - lost, dp)
            z = z + weights(w, order)*(phase(k + m) - phase(k))/there
            inverse = inverse + weights(w, order)**2*(1/there - 1/real(m, dp))
         end do
         if (w <= order) cycle
         sums%squares = sums%squares + z**2
         sums%inflation = sums%inflation + inverse
         sums%terms = sums%terms + 1
      end do
   end subroutine gapped_terms

end module gyroakf_allan_window_difference
