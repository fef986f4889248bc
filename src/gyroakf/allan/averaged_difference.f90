! SPDX-License-Identifier: MIT
!> Squared differences of phase averages, with or without missing samples: the work of the modified
!> Allan variance.
!>
!> The second difference of the phase averages is the difference of two means of the rate, whose
!> weights form triangles T(s) = s for s = 1 .. m, 2m - s for s = m .. 2m - 1, the second m samples
!> after the first. With p = 1 where a sample is there and 0 where it is missing, both are taken
!> over the samples that are there:
!>
!> $$ z_j = \frac{\sum_s T(s)\, p_{j+m+s}\, w_{j+m+s}}{D_{j+m}} -
!>    \frac{\sum_s T(s)\, p_{j+s}\, w_{j+s}}{D_j}, \quad
!>    D_j = \sum_s T(s)\, p_{j+s} $$
!>
!> (D = m^2 in a complete record). White noise of variance 1 gives z the variance
!>
!> $$ V_j = \frac{E_j}{D_j^2} + \frac{E_{j+m}}{D_{j+m}^2} - \frac{2 F_j}{D_j D_{j+m}}, \quad
!>    E_j = \sum_s T(s)^2 p_{j+s}, \quad
!>    F_j = \sum_{s=1}^{m} s (m - s)\, p_{j+m+s} $$
!>
!> and (m^2 + 1)/m^3 in a complete record; the sum of the differences is what [[allan_variances]]
!> takes out. D, E and F follow from the number of missing samples in the three windows of m samples
!> and its first two moments about their beginnings, which go from term to term by recursion, as the
!> sums of the rate do: a term costs the same whatever m. Without gaps the kernel is
!> [[gyroakf_allan_phase_average]].
module gyroakf_allan_averaged_difference
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_threads, only : thread_count
   use gyroakf_allan_phase_average, only : add_terms
   use gyroakf_allan_window_difference, only : add_sums, window_sums_type
   implicit none (type, external)
   private
   public :: sum_phase_averages

   !> Terms of a chain at least: of a record without gaps, of one with gaps
   integer(int64), parameter :: chain_least = 65536, gapped_least = 32768
   !> Terms times factors below which one thread is quicker
   integer(int64), parameter :: parallel_from = 1000000

   !> Neighboring terms that a recursion runs over
   type :: chain_type
      !> Place of their averaging factor
      integer :: factor = 0
      !> The first of them, and how many
      integer(int64) :: begin = 0, terms = 0
   end type chain_type

   !> What goes from term to term
   type :: state_type
      !> Sums of the rate, weighted by the triangles
      real(dp) :: first = 0.0_dp, second = 0.0_dp
      !> Missing samples in each window: their number, and the sums of their places and squared
      !> places, counted from 1
      real(dp) :: lost(3) = 0.0_dp, place(3) = 0.0_dp, square(3) = 0.0_dp
   end type state_type

contains

   !> For each m the sums over j = 0 .. n - 3m + 1.
   !>
   !> The recursions restart at fixed places: no rounding error runs along, and no bit depends on
   !> the number of threads. Chains at the same place follow each other: they use the same block of
   !> the record while it is in the cache.
   subroutine sum_phase_averages(phase, m, sums, error, missing, coverage, progress)
      !> Phase, to which missing samples added nothing: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= (n + 1)/3: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums: [size(m)]; with `missing` of differences of means, and the inflation is the sum
      !> of V - (m^2 + 1)/m^3; without, of differences of sums
      type(window_sums_type), intent(out) :: sums(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Missing samples so far: [0:n]; none are missing if absent
      integer(int32), intent(in), contiguous, optional :: missing(0:)
      !> Share of the weight of each triangle that must be present, > 0, <= 1: [size(m)]
      real(dp), intent(in), optional :: coverage(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(window_sums_type), allocatable :: part(:)
      type(chain_type), allocatable :: chain(:)
      integer(int64) :: terms, total, item, from, to, group, done, all_terms
      integer :: i, stat

      terms = ubound(phase, 1, kind=int64) + 2
      if (present(missing)) then
         call list_chains(terms - 3*m, max(gapped_least, 2*m), chain, stat)
      else
         call list_chains(terms - 3*m, max(chain_least, 8*m), chain, stat)
      end if
      if (stat == 0) allocate (part(size(chain, kind=int64)), stat=stat)
      call check_memory(stat, "the partial sums of the modified Allan variance", error)
      if (allocated(error)) return
      total = size(chain, kind=int64)
      group = max(total, 1_int64)
      if (present(progress)) group = 8*thread_count()
      all_terms = sum(chain%terms)
      done = 0
      do from = 1, total, group
         to = min(from + group - 1, total)
         call report_progress("Allan deviation", done, all_terms, error, progress)
         if (allocated(error)) return
         done = done + sum(chain(from:to)%terms)
         !$omp parallel do schedule(dynamic) private(i) if (terms*size(m) >= parallel_from)
         do item = from, to
            i = chain(item)%factor
            if (present(missing)) then
               call add_gapped_chain(phase, missing, m(i), coverage(i), chain(item)%begin, &
                  & chain(item)%terms, part(item))
            else
               call add_terms(phase, m(i), chain(item)%begin, chain(item)%terms, part(item)%squares)
            end if
         end do
         !$omp end parallel do
      end do
      do item = 1, total
         call add_sums(part(item), sums(chain(item)%factor))
      end do
   end subroutine sum_phase_averages

   !> Cuts the terms of each factor into chains, in the order of their places.
   pure subroutine list_chains(terms, length, chain, stat)
      !> Terms of each factor, and of its chains at most
      integer(int64), intent(in) :: terms(:), length(:)
      type(chain_type), allocatable, intent(out) :: chain(:)
      integer, intent(out) :: stat
      integer(int64) :: item, first, begin, step
      integer :: i

      allocate (chain(sum((terms - 1)/length + 1)), stat=stat)
      if (stat /= 0) return
      item = 0
      step = minval(length)
      do first = 0, maxval(terms) - 1, step
         do i = 1, size(terms)
            begin = (first + length(i) - 1)/length(i)*length(i)
            if (begin >= min(first + step, terms(i))) cycle
            item = item + 1
            chain(item) = chain_type(i, begin, min(length(i), terms(i) - begin))
         end do
      end do
   end subroutine list_chains

   !> Some neighboring terms.
   pure subroutine add_gapped_chain(phase, missing, m, coverage, first, terms, sums)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), intent(in), contiguous :: missing(0:)
      integer(int64), intent(in) :: m
      real(dp), intent(in) :: coverage
      integer(int64), intent(in) :: first, terms
      type(window_sums_type), intent(out) :: sums

      type(state_type) :: state
      real(dp) :: allowed, whole
      integer(int64) :: j
      logical :: complete

      whole = real(m, dp)**2
      allowed = min(real(int((1 - coverage)*whole + 1e-9_dp, int64), dp), whole - 1)
      state = first_state(phase, missing, m, first)
      do j = first, first + terms - 1
         complete = missing(j + 3*m - 1) == missing(j)
         if (complete) then
            sums%squares = sums%squares + ((state%second - state%first)/whole)**2
            sums%terms = sums%terms + 1
         else
            call add_gapped_term(state, real(m, dp), allowed, sums)
         end if
         if (j < first + terms - 1) call advance(phase, missing, m, j, complete, state)
      end do
   end subroutine add_gapped_chain

   !> The state at a term, from sums over its windows.
   pure function first_state(phase, missing, m, j) result(state)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), intent(in), contiguous :: missing(0:)
      integer(int64), intent(in) :: m, j
      type(state_type) :: state
      real(dp) :: lost
      integer(int64) :: i, s, b
      integer :: w

      do i = j, j + m - 1
         state%first = state%first + (phase(i + m) - phase(i))
         state%second = state%second + (phase(i + 2*m) - phase(i + m))
      end do
      do w = 1, 3
         b = j + (w - 1)*m
         do s = 1, min(m, ubound(missing, 1, kind=int64) - b)
            lost = real(missing(b + s) - missing(b + s - 1), dp)
            state%lost(w) = state%lost(w) + lost
            state%place(w) = state%place(w) + lost*real(s, dp)
            state%square(w) = state%square(w) + lost*real(s, dp)**2
         end do
      end do
   end function first_state

   !> From term j to term j + 1.
   pure subroutine advance(phase, missing, m, j, complete, state)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factor, and the term that was
      integer(int64), intent(in) :: m, j
      !> Nothing is missing up to j + 3m - 1
      logical, intent(in) :: complete
      type(state_type), intent(inout) :: state

      real(dp) :: new(3), length
      integer(int64) :: n

      state%first = state%first + ((phase(j + 2*m) - phase(j + m)) - (phase(j + m) - phase(j)))
      state%second = state%second &
         & + ((phase(j + 3*m) - phase(j + 2*m)) - (phase(j + 2*m) - phase(j + m)))
      n = ubound(missing, 1, kind=int64)
      if (complete .and. missing(min(j + 3*m + 1, n)) == missing(j + 3*m - 1)) return
      length = real(m, dp)
      new(1) = real(missing(j + m + 1) - missing(j + m), dp)
      new(2) = real(missing(j + 2*m + 1) - missing(j + 2*m), dp)
      new(3) = 0
      if (j + 3*m < n) new(3) = real(missing(j + 3*m + 1) - missing(j + 3*m), dp)
      state%square = state%square - 2*state%place + state%lost + length**2*new
      state%place = state%place - state%lost + length*new
      state%lost(1) = real(missing(j + 1 + m) - missing(j + 1), dp)
      state%lost(2) = real(missing(j + 1 + 2*m) - missing(j + 1 + m), dp)
      state%lost(3) = real(missing(min(j + 1 + 3*m, n)) - missing(j + 1 + 2*m), dp)
      where (state%lost <= 0)                               ! no rounding is carried on
         state%place = 0
         state%square = 0
      end where
   end subroutine advance

   !> Adds a term some of whose samples are missing, if its triangles are complete enough.
   pure subroutine add_gapped_term(state, m, allowed, sums)
      type(state_type), intent(in) :: state
      real(dp), intent(in) :: m
      !> Weight that a triangle may lack, < m^2
      real(dp), intent(in) :: allowed
      type(window_sums_type), intent(inout) :: sums

      real(dp) :: lack1, lack2, d1, d2, e1, e2, f, whole

      lack1 = state%place(1) + m*state%lost(2) - state%place(2)
      lack2 = state%place(2) + m*state%lost(3) - state%place(3)
      if (max(lack1, lack2) > allowed + 0.5_dp) return
      d1 = m**2 - lack1
      d2 = m**2 - lack2
      whole = m*(2*m**2 + 1)/3
      e1 = whole - (state%square(1) + m**2*state%lost(2) - 2*m*state%place(2) + state%square(2))
      e2 = whole - (state%square(2) + m**2*state%lost(3) - 2*m*state%place(3) + state%square(3))
      f = m*(m**2 - 1)/6 - (m*state%place(2) - state%square(2))
      sums%squares = sums%squares + (state%second/d2 - state%first/d1)**2
      sums%inflation = sums%inflation + (e1/d1**2 + e2/d2**2 - 2*f/(d1*d2) - (m**2 + 1)/m**3)
      sums%terms = sums%terms + 1
   end subroutine add_gapped_term

end module gyroakf_allan_averaged_difference
