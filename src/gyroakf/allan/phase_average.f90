! SPDX-License-Identifier: MIT
!> Sums of squared second differences of phase averages: the work of the modified Allan variance.
!>
!> $$ z_j = \sum_{i=j}^{j+m-1} (x_{i+2m} - 2 x_{i+m} + x_i), \quad
!>    z_{j+1} = z_j + x_{j+3m} - 3 x_{j+2m} + 3 x_{j+m} - x_j $$
!>
!> A term costs one step of the recursion, whatever m. The recursion restarts at fixed places (so
!> that no rounding error runs along, and that no bit depends on the number of threads), four chains
!> of it run side by side, and short averaging factors share a stretch of the record while it is in
!> the cache.
module gyroakf_allan_phase_average
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_threads, only : thread_count
   implicit none (type, external)
   private
   public :: sum_phase_averages, chain_type, list_chains, no_memory_text

   !> Terms of a stretch, and the longest factor that shares stretches
   integer(int64), parameter :: stretch_length = 65536, short_max = 4096
   !> Length of the chains of a longer factor, in averaging times
   integer(int64), parameter :: chain_length = 2
   !> Steps of a chain that are prepared together
   integer(int64), parameter :: buffer_length = 256
   !> Terms times factors below which one thread is quicker
   integer(int64), parameter :: parallel_from = 1000000

   character(*), parameter :: no_memory_text = &
      & "no memory for the partial sums of the modified Allan variance"

   !> Neighboring terms that a recursion runs over
   type :: chain_type
      !> Place of their averaging factor
      integer :: factor = 0
      !> The first of them, and how many
      integer(int64) :: begin = 0, terms = 0
   end type chain_type

contains

   !> For each m the sum over j = 0 .. n - 3m + 1 of z(j)**2.
   subroutine sum_phase_averages(phase, m, sums, error, progress)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, ascending, 1 <= m <= (n + 1)/3: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums: [size(m)]
      real(dp), intent(out) :: sums(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      integer(int64) :: n
      integer :: short

      n = ubound(phase, 1, kind=int64)
      short = count(m <= short_max)
      call sum_short(phase, m(:short), sums(:short), n*size(m), error, progress)
      if (.not. allocated(error)) call sum_long(phase, m(short + 1:), sums(short + 1:), n*short, &
         & n*size(m), error, progress)
   end subroutine sum_phase_averages

   !> Factors that share stretches.
   subroutine sum_short(phase, m, sums, whole, error, progress)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m(:)
      real(dp), intent(out) :: sums(:)
      !> Terms of all factors, these and others
      integer(int64), intent(in) :: whole
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      real(dp), allocatable :: part(:, :)
      integer(int64) :: terms, stretches, s, first, from, group
      integer :: i, stat

      terms = ubound(phase, 1, kind=int64) + 2
      stretches = (terms + stretch_length - 1)/stretch_length
      allocate (part(size(m), stretches), stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, no_memory_text)
      if (allocated(error)) return
      group = stretches
      if (present(progress)) group = 8*thread_count()
      do from = 1, stretches, group
         call report_progress("Allan deviation", min(whole, (from - 1)*stretch_length*size(m)), &
            & whole, error, progress)
         if (allocated(error)) return
         !$omp parallel do schedule(dynamic) private(i, first) if (terms*size(m) >= parallel_from)
         do s = from, min(stretches, from + group - 1)
            first = (s - 1)*stretch_length
            do i = 1, size(m)
               call add_terms(phase, m(i), first, min(stretch_length, terms - 3*m(i) - first), &
                  & part(i, s))
            end do
         end do
         !$omp end parallel do
      end do
      do i = 1, size(m)
         sums(i) = sum(part(i, :))
      end do
   end subroutine sum_short

   !> Factors that have the record to themselves, cut so that the starts of the chains cost less
   !> than the chains.
   subroutine sum_long(phase, m, sums, done, whole, error, progress)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m(:)
      real(dp), intent(out) :: sums(:)
      !> Terms of the factors before, of all
      integer(int64), intent(in) :: done, whole
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      type(chain_type), allocatable :: chain(:)
      real(dp), allocatable :: part(:)
      integer(int64) :: terms, total, item, from, group
      integer :: stat

      sums = 0
      terms = ubound(phase, 1, kind=int64) + 2
      call list_chains(terms - 3*m, 4*chain_length*m, chain, stat)
      if (stat == 0) allocate (part(size(chain, kind=int64)), stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, no_memory_text)
      if (allocated(error)) return
      total = size(chain, kind=int64)
      group = max(total, 1_int64)
      if (present(progress)) group = thread_count()
      do from = total, 1, -group
         call report_progress("Allan deviation", done + (whole - done)/total*(total - from), &
            & whole, error, progress)
         if (allocated(error)) return
         !$omp parallel do schedule(dynamic) if (terms*size(m) >= parallel_from)
         do item = from, max(from - group + 1, 1_int64), -1
            call add_terms(phase, m(chain(item)%factor), chain(item)%begin, chain(item)%terms, &
               & part(item))
         end do
         !$omp end parallel do
      end do
      do item = 1, total
         associate (i => chain(item)%factor)
            sums(i) = sums(i) + part(item)
         end associate
      end do
   end subroutine sum_long

   !> Cuts the terms of each factor into chains.
   pure subroutine list_chains(terms, length, chain, stat)
      !> Terms of each factor, and of its chains at most
      integer(int64), intent(in) :: terms(:), length(:)
      !> Those of the first factor, of the second ...
      type(chain_type), allocatable, intent(out) :: chain(:)
      !> Not 0 where there is no memory
      integer, intent(out) :: stat
      integer(int64) :: item, begin
      integer :: i

      allocate (chain(sum((terms - 1)/length + 1)), stat=stat)
      if (stat /= 0) return
      item = 0
      do i = 1, size(terms)
         do begin = 0, terms(i) - 1, length(i)
            item = item + 1
            chain(item) = chain_type(i, begin, min(length(i), terms(i) - begin))
         end do
      end do
   end subroutine list_chains

   !> Sum of z(j)**2 over some neighboring terms.
   pure subroutine add_terms(phase, m, first, terms, total)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, first, terms
      !> The sum, 0 without terms
      real(dp), intent(out) :: total

      integer(int64) :: j, quarter
      real(dp) :: z, rest

      total = 0
      if (terms <= 0) return
      quarter = terms/4
      if (quarter >= m) then
         call four_chains(phase, m, first, quarter, total, z)
      else
         quarter = 0
         z = first_average(phase, m, first)
         total = z**2
      end if
      rest = 0
      do j = first + max(4*quarter, 1_int64), first + terms - 1
         z = z + third_difference(phase, m, j - 1)
         rest = rest + z**2
      end do
      total = total + rest
   end subroutine add_terms

   !> Four chains of the recursion side by side.
   pure subroutine four_chains(phase, m, first, length, total, z)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, first
      !> Terms of a chain, >= 1
      integer(int64), intent(in) :: length
      real(dp), intent(out) :: total, z

      real(dp) :: d(buffer_length, 4), z1, z2, z3, z4, s1, s2, s3, s4
      integer(int64) :: j, i, steps
      integer :: chain

      z1 = first_average(phase, m, first)
      z2 = first_average(phase, m, first + length)
      z3 = first_average(phase, m, first + 2*length)
      z4 = first_average(phase, m, first + 3*length)
      s1 = z1**2
      s2 = z2**2
      s3 = z3**2
      s4 = z4**2
      do j = 0, length - 2, buffer_length
         steps = min(buffer_length, length - 1 - j)
         do chain = 1, 4
            call third_differences(phase, m, first + (chain - 1)*length + j, d(:steps, chain))
         end do
         do i = 1, steps
            z1 = z1 + d(i, 1)
            z2 = z2 + d(i, 2)
            z3 = z3 + d(i, 3)
            z4 = z4 + d(i, 4)
            s1 = s1 + z1**2
            s2 = s2 + z2**2
            s3 = s3 + z3**2
            s4 = s4 + z4**2
         end do
      end do
      total = (s1 + s2) + (s3 + s4)
      z = z4
   end subroutine four_chains

   !> The steps of the recursion from neighboring places on.
   pure subroutine third_differences(phase, m, first, d)
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factor, and the first place
      integer(int64), intent(in) :: m, first
      real(dp), intent(out), contiguous :: d(:)

      integer(int64) :: i

      !$omp simd
      do i = 1, size(d, kind=int64)
         d(i) = (phase(first + i - 1 + 3*m) - phase(first + i - 1)) &
            & - 3*(phase(first + i - 1 + 2*m) - phase(first + i - 1 + m))
      end do
   end subroutine third_differences

   !> x(j+3m) - 3 x(j+2m) + 3 x(j+m) - x(j).
   pure real(dp) function third_difference(phase, m, j)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, j

      third_difference = (phase(j + 3*m) - phase(j)) - 3*(phase(j + 2*m) - phase(j + m))
   end function third_difference

   !> z(j) as the sum that defines it.
   pure real(dp) function first_average(phase, m, j) result(z)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m, j
      integer(int64) :: i

      z = 0
      !$omp simd reduction(+:z)
      do i = j, j + m - 1
         z = z + ((phase(i + 2*m) - phase(i + m)) - (phase(i + m) - phase(i)))
      end do
   end function first_average

end module gyroakf_allan_phase_average
