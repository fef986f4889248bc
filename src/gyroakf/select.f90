! SPDX-License-Identifier: MIT
!> Order statistics in linear time without a copy of the series.
!>
!> In a long series a sample of 65,536 gives two bounds of the median; one pass counts what is below
!> and gathers the some percent between. Among these, where the sample misleads, and in a short
!> series the digits of the numbers are counted ([[gyroakf_rank]]).
module gyroakf_select
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, chunk_count, chunk_first, chunk_last
   use gyroakf_rank, only : find_rank, next_above, numbers_type
   implicit none (type, external)
   private
   public :: find_median, find_deviation

   !> Length from which a sample pays, its size, the share of the series allowed in its bracket
   integer(int64), parameter :: sampled_from = 500000, sample_size = 65536, gathered_share = 16

contains

   !> Median of the present samples; the mean of the two middle ones for an even number.
   subroutine find_median(x, median, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous, target :: x(:)
      !> The median
      real(dp), intent(out) :: median
      !> too_few_samples where nothing is present, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional, target :: valid(:)
      type(numbers_type) :: numbers

      numbers%x => x
      if (present(valid)) numbers%valid => valid
      call find_middle(numbers, median, error)
   end subroutine find_median

   !> Median of |x - center| over the present samples.
   subroutine find_deviation(x, center, deviation, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous, target :: x(:)
      !> Usually the median
      real(dp), intent(in) :: center
      !> The median absolute deviation
      real(dp), intent(out) :: deviation
      !> too_few_samples where nothing is present, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional, target :: valid(:)
      type(numbers_type) :: numbers

      numbers%x => x
      numbers%center = center
      numbers%absolute = .true.
      if (present(valid)) numbers%valid => valid
      call find_middle(numbers, deviation, error)
   end subroutine find_deviation

   subroutine find_middle(numbers, value, error)
      type(numbers_type), intent(in) :: numbers
      real(dp), intent(out) :: value
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: found, rank
      real(dp) :: next
      logical :: done

      value = 0.0_dp
      found = size(numbers%x, kind=int64)
      if (associated(numbers%valid)) found = count(numbers%valid /= 0_int8, kind=int64)
      if (found < 1) then
         call fatal_error(error, status%too_few_samples, "no sample is present, there is no median")
         return
      end if
      rank = (found + 1)/2
      done = .false.
      if (found >= sampled_from) call find_by_sample(numbers, found, rank, value, next, done, error)
      if (.not. done .and. .not. allocated(error)) call find_rank(numbers, rank, value, next, error)
      if (allocated(error) .or. mod(found, 2_int64) == 1) return
      value = 0.5_dp*value + 0.5_dp*next
   end subroutine find_middle

   !> The same by a sample: between which numbers the rank lies follows from some thousand of them,
   !> one pass counts what is below and gathers what is between, and the rank is found among these.
   subroutine find_by_sample(numbers, found, rank, value, next, done, error)
      type(numbers_type), intent(in) :: numbers
      !> Present samples, and the rank among them
      integer(int64), intent(in) :: found, rank
      real(dp), intent(out) :: value, next
      !> .false.: the sample was misleading, or there are too many ties
      logical, intent(out) :: done
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable, target :: between(:)
      type(numbers_type) :: gathered
      real(dp) :: low, high
      integer(int64) :: below, inside
      integer :: stat

      done = .false.
      value = 0.0_dp
      next = 0.0_dp
      call find_bracket(numbers, real(rank, dp)/real(found, dp), low, high, error)
      if (allocated(error)) return
      allocate (between(found/gathered_share), stat=stat)
      call check_memory(stat, "the middle of the series", error)
      if (allocated(error)) return
      call gather(numbers, low, high, below, inside, between)
      if (rank <= below .or. rank > below + inside .or. inside > size(between, kind=int64)) return
      gathered%x => between(:inside)
      call find_rank(gathered, rank - below, value, next, error)
      if (allocated(error)) return
      if (rank == below + inside) next = next_above(numbers, value)
      done = .true.
   end subroutine find_by_sample

   !> Two numbers around a quantile: six standard errors of a sample's quantile on either side.
   subroutine find_bracket(numbers, quantile, low, high, error)
      type(numbers_type), intent(in) :: numbers
      real(dp), intent(in) :: quantile
      real(dp), intent(out) :: low, high
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable, target :: drawn(:)
      type(numbers_type) :: sample
      real(dp) :: ignored, margin
      integer(int64) :: i, stride, place, count
      integer :: stat

      stride = size(numbers%x, kind=int64)/sample_size
      low = -huge(low)
      high = huge(high)
      allocate (drawn(sample_size), stat=stat)
      call check_memory(stat, "a sample of a series", error)
      if (allocated(error)) return
      count = 0
      do i = 0, sample_size - 1
         place = i*stride + mod(i*7919_int64, stride) + 1      ! no multiples of one period
         if (associated(numbers%valid)) then
            if (numbers%valid(place) == 0_int8) cycle
         end if
         count = count + 1
         drawn(count) = (numbers%x(place) - numbers%center) + 0.0_dp
         if (numbers%absolute) drawn(count) = abs(drawn(count))
      end do
      if (count < sample_size/16) return
      margin = 6.0_dp*0.5_dp*sqrt(real(count, dp))
      sample%x => drawn(:count)
      i = max(1_int64, int(quantile*real(count, dp) - margin, int64))
      call find_rank(sample, i, low, ignored, error)
      if (allocated(error)) return
      i = min(count, int(quantile*real(count, dp) + margin, int64) + 1)
      call find_rank(sample, i, high, ignored, error)
   end subroutine find_bracket

   !> Counts the numbers below two bounds and between them, and copies the latter if they fit.
   subroutine gather(numbers, low, high, below, inside, between)
      type(numbers_type), intent(in) :: numbers
      real(dp), intent(in) :: low, high
      integer(int64), intent(out) :: below, inside
      real(dp), intent(inout), contiguous :: between(:)
      real(dp) :: kept(block_length)
      integer(int64) :: n, first, last, place
      integer :: chunk, count

      n = size(numbers%x, kind=int64)
      below = 0
      inside = 0
      !$omp parallel do default(shared) private(kept, first, last, place, count, chunk) &
      !$omp& reduction(+:below) schedule(dynamic)
      do chunk = 1, chunk_count(n)
         do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
            last = min(first + block_length - 1, chunk_last(n, chunk))
            call gather_block(numbers, first, last, low, high, below, kept, count)
            !$omp atomic capture
            place = inside
            inside = inside + count
            !$omp end atomic
            if (place + count <= size(between, kind=int64)) then
               between(place + 1:place + count) = kept(:count)
            end if
         end do
      end do
      !$omp end parallel do
   end subroutine gather

   !> The same of a block, without branches that depend on the numbers.
   pure subroutine gather_block(numbers, first, last, low, high, below, kept, count)
      type(numbers_type), intent(in) :: numbers
      integer(int64), intent(in) :: first, last
      real(dp), intent(in) :: low, high
      integer(int64), intent(inout) :: below
      real(dp), intent(inout) :: kept(:)
      integer, intent(out) :: count
      real(dp) :: y(block_length)
      integer(int64) :: place
      integer :: i, n, less

      n = 0
      do place = first, last
         y(n + 1) = (numbers%x(place) - numbers%center) + 0.0_dp
         if (associated(numbers%valid)) then
            n = n + merge(1, 0, numbers%valid(place) /= 0_int8)
         else
            n = n + 1
         end if
      end do
      if (numbers%absolute) y(:n) = abs(y(:n))
      less = 0
      !$omp simd reduction(+:less)
      do i = 1, n
         less = less + merge(1, 0, y(i) < low)
      end do
      below = below + less
      count = 0
      do i = 1, n
         kept(count + 1) = y(i)
         count = count + merge(1, 0, y(i) >= low .and. y(i) <= high)
      end do
   end subroutine gather_block

end module gyroakf_select
