! SPDX-License-Identifier: MIT
!> Order statistics in linear time without a copy of the series.
!>
!> In a long series a sample of 65,536 gives two bounds of the median; one pass counts what is below and gathers
!> the some percent between. Where it misleads, or in a short series, and among what was gathered:
!>
!> The bits of a double, read as an integer with the sign folded in, are ordered like the numbers.
!> Six passes count the 11-bit digits of these keys, from the highest down, each among the samples
!> that share the digits found before. Ties and outliers cost nothing; counts are integers, so the
!> result does not depend on the threads.
module gyroakf_select
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last
   implicit none (type, external)
   private
   public :: find_median, find_deviation

   integer, parameter :: digit_bits = 11, digits = 6
   !> Length from which a sample pays, its size, and the share of the series that may lie in its bracket
   integer(int64), parameter :: sampled_from = 500000, sample_size = 65536, gathered_share = 16
   !> Bit of the sign alone
   integer(int64), parameter :: sign_bit = ishft(1_int64, 63)

contains

   !> Median of the present samples; the mean of the two middle ones for an even number.
   subroutine find_median(x, median, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> The median
      real(dp), intent(out) :: median
      !> too_few_samples where nothing is present, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      call middle(x, 0.0_dp, .false., median, error, valid)
   end subroutine find_median

   !> Median of |x - centre| over the present samples.
   subroutine find_deviation(x, centre, deviation, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Usually the median
      real(dp), intent(in) :: centre
      !> The median absolute deviation
      real(dp), intent(out) :: deviation
      !> too_few_samples where nothing is present, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      call middle(x, centre, .true., deviation, error, valid)
   end subroutine find_deviation

   !> The middle of x - centre or of its absolute value.
   subroutine middle(x, centre, absolute, value, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> The median
      real(dp), intent(out) :: value
      !> too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: found, rank
      real(dp) :: next
      logical :: done

      value = 0.0_dp
      found = size(x, kind=int64)
      if (present(valid)) found = count(valid /= 0_int8, kind=int64)
      if (found < 1) then
         call fatal_error(error, status%too_few_samples, "no sample is present, there is no median")
         return
      end if
      rank = (found + 1)/2
      done = .false.
      if (found >= sampled_from) call find_by_sample(x, centre, absolute, found, rank, value, next, done, error, valid)
      if (.not. done .and. .not. allocated(error)) call find_rank(x, centre, absolute, rank, value, next, error, valid)
      if (allocated(error) .or. mod(found, 2_int64) == 1) return
      value = 0.5_dp*value + 0.5_dp*next
   end subroutine middle

   !> A number by its rank, and the one of the next rank, digit by digit.
   subroutine find_rank(x, centre, absolute, rank, value, next, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> Rank among the present samples, 1 the smallest
      integer(int64), intent(in) :: rank
      !> The two; the second is `huge` where there is none
      real(dp), intent(out) :: value, next
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64), allocatable :: histogram(:)
      integer(int64) :: rest, key, digit
      integer :: d

      rest = rank
      key = 0
      value = 0.0_dp
      next = 0.0_dp
      do d = 1, digits
         call count_digits(x, centre, absolute, d, key, histogram, error, valid)
         if (allocated(error)) return
         do digit = 0, size(histogram, kind=int64) - 1
            if (rest <= histogram(digit)) exit
            rest = rest - histogram(digit)
         end do
         key = ior(ishft(key, digit_bits), digit)
      end do
      value = value_of(key)
      next = value
      if (rest == histogram(digit)) next = next_above(x, centre, absolute, value, valid)
   end subroutine find_rank

   !> The same by a sample: between which numbers the rank lies follows from some thousand of them, one pass counts what is below
   !> and gathers what is between, and the rank is found among these.
   subroutine find_by_sample(x, centre, absolute, found, rank, value, next, done, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> Present samples, and the rank among them
      integer(int64), intent(in) :: found, rank
      !> The number of this rank, and of the next
      real(dp), intent(out) :: value, next
      !> .false.: the sample was misleading, or there are too many ties
      logical, intent(out) :: done
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: between(:)
      real(dp) :: low, high
      integer(int64) :: below, inside
      integer :: stat

      done = .false.
      value = 0.0_dp
      next = 0.0_dp
      call find_bracket(x, centre, absolute, real(rank, dp)/real(found, dp), low, high, error, valid)
      if (allocated(error)) return
      allocate (between(found/gathered_share), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the middle of the series")
         return
      end if
      call gather(x, centre, absolute, low, high, below, inside, between, valid)
      if (rank <= below .or. rank > below + inside .or. inside > size(between, kind=int64)) return
      call find_rank(between(:inside), 0.0_dp, .false., rank - below, value, next, error)
      if (allocated(error)) return
      if (rank == below + inside) next = next_above(x, centre, absolute, value, valid)
      done = .true.
   end subroutine find_by_sample

   !> Two numbers between which a quantile almost surely lies: six standard errors of a sample's quantile on either side.
   subroutine find_bracket(x, centre, absolute, quantile, low, high, error, valid)
      !> Series: [n], n >= 1
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> Share of the samples below
      real(dp), intent(in) :: quantile
      !> The two
      real(dp), intent(out) :: low, high
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: drawn(:)
      real(dp) :: ignored, margin
      integer(int64) :: i, stride, n, count
      integer :: stat

      n = size(x, kind=int64)
      stride = n/sample_size
      low = -huge(low)
      high = huge(high)
      allocate (drawn(sample_size), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for a sample of a series")
         return
      end if
      count = 0
      do i = 0, sample_size - 1
         associate (place => i*stride + mod(i*7919_int64, stride) + 1)      ! no multiples of one period
            if (present(valid)) then
               if (valid(place) == 0_int8) cycle
            end if
            count = count + 1
            drawn(count) = (x(place) - centre) + 0.0_dp
         end associate
         if (absolute) drawn(count) = abs(drawn(count))
      end do
      if (count < sample_size/16) return
      margin = 6.0_dp*0.5_dp*sqrt(real(count, dp))
      i = max(1_int64, int(quantile*real(count, dp) - margin, int64))
      call find_rank(drawn(:count), 0.0_dp, .false., i, low, ignored, error)
      if (allocated(error)) return
      i = min(count, int(quantile*real(count, dp) + margin, int64) + 1)
      call find_rank(drawn(:count), 0.0_dp, .false., i, high, ignored, error)
   end subroutine find_bracket

   !> Counts the numbers below two bounds and between them, and copies the latter in any order.
   subroutine gather(x, centre, absolute, low, high, below, inside, between, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> The bounds, both inside
      real(dp), intent(in) :: low, high
      !> Numbers < low, and low .. high
      integer(int64), intent(out) :: below, inside
      !> The latter, as many as fit
      real(dp), intent(inout), contiguous :: between(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: kept(block_length)
      integer(int64) :: n, first, last, place
      integer :: chunk, count

      n = size(x, kind=int64)
      below = 0
      inside = 0
      !$omp parallel do default(shared) private(kept, first, last, place, count, chunk) reduction(+:below) schedule(dynamic)
      do chunk = 1, chunk_count(n)
         do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
            last = min(first + block_length - 1, chunk_last(n, chunk))
            if (present(valid)) then
               call gather_block(x(first:last), centre, absolute, low, high, below, kept, count, valid(first:last))
            else
               call gather_block(x(first:last), centre, absolute, low, high, below, kept, count)
            end if
            !$omp atomic capture
            place = inside
            inside = inside + count
            !$omp end atomic
            if (place + count <= size(between, kind=int64)) between(place + 1:place + count) = kept(:count)
         end do
      end do
      !$omp end parallel do
   end subroutine gather

   !> The same of a block, without branches that depend on the numbers.
   pure subroutine gather_block(x, centre, absolute, low, high, below, kept, count, valid)
      !> Block: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> The bounds, both inside
      real(dp), intent(in) :: low, high
      !> Numbers < low, counted on
      integer(int64), intent(inout) :: below
      !> Those between: [block_length]
      real(dp), intent(inout) :: kept(:)
      !> How many
      integer, intent(out) :: count
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: y(block_length)
      integer :: i, n, less

      n = 0
      do i = 1, size(x)
         y(n + 1) = (x(i) - centre) + 0.0_dp
         if (present(valid)) then
            n = n + merge(1, 0, valid(i) /= 0_int8)
         else
            n = n + 1
         end if
      end do
      if (absolute) y(:n) = abs(y(:n))
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

   !> Ordered integer of a number, as unsigned.
   elemental integer(int64) function key_of(x)
      !> Finite
      real(dp), intent(in) :: x

      key_of = transfer(x, key_of)
      key_of = merge(not(key_of), ieor(key_of, sign_bit), key_of < 0)
   end function key_of

   !> The number of a key.
   elemental real(dp) function value_of(key)
      !> What key_of gave
      integer(int64), intent(in) :: key

      value_of = transfer(merge(ieor(key, sign_bit), not(key), key < 0), value_of)
   end function value_of

   !> Counts a digit among the samples whose higher digits are known.
   subroutine count_digits(x, centre, absolute, digit, prefix, histogram, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> Which digit, 1 the highest
      integer, intent(in) :: digit
      !> The higher digits
      integer(int64), intent(in) :: prefix
      !> Counts: [0:2047]
      integer(int64), allocatable, intent(out) :: histogram(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64), allocatable :: mine(:)
      integer(int64), parameter :: most = ishft(1_int64, digit_bits) - 1
      integer(int64) :: n
      integer :: chunk, stat, bad

      n = size(x, kind=int64)
      stat = 0
      allocate (histogram(0:most), stat=bad)
      if (bad == 0) then
         histogram = 0
         !$omp parallel if (n >= threads_from) default(shared) private(mine, bad)
         allocate (mine(0:most), stat=bad)
         if (bad == 0) mine = 0
         !$omp do schedule(static)
         do chunk = 1, chunk_count(n)
            if (bad == 0) call count_chunk(x, centre, absolute, digit, prefix, chunk, mine, valid)
         end do
         !$omp end do
         !$omp critical (gyroakf_select_histogram)
         if (bad == 0) histogram = histogram + mine
         stat = stat + abs(bad)
         !$omp end critical (gyroakf_select_histogram)
         !$omp end parallel
      end if
      if (bad + stat /= 0) call fatal_error(error, status%no_memory, "no memory for the counts of the median")
   end subroutine count_digits

   !> Counts a digit within a chunk.
   pure subroutine count_chunk(x, centre, absolute, digit, prefix, chunk, histogram, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> Which digit, the higher ones, which chunk
      integer, intent(in) :: digit, chunk
      integer(int64), intent(in) :: prefix
      !> Counts, added to: [0:2047]
      integer(int64), intent(inout) :: histogram(0:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, key
      integer :: low
      real(dp) :: value

      low = digit_bits*(digits - digit)
      do i = chunk_first(size(x, kind=int64), chunk), chunk_last(size(x, kind=int64), chunk)
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         value = (x(i) - centre) + 0.0_dp  ! -0 becomes 0
         if (absolute) value = abs(value)
         key = ishft(key_of(value), -low)
         if (digit > 1) then
            if (ishft(key, -digit_bits) /= prefix) cycle
         end if
         key = iand(key, ishft(1_int64, digit_bits) - 1)
         histogram(key) = histogram(key) + 1
      end do
   end subroutine count_chunk

   !> Smallest of the numbers above a bound, `huge` where there is none.
   real(dp) function next_above(x, centre, absolute, bound, valid) result(next)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> The bound
      real(dp), intent(in) :: bound
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: value
      integer(int64) :: i, n

      n = size(x, kind=int64)
      next = huge(next)
      !$omp parallel do if (n >= threads_from) default(shared) private(value) reduction(min:next) schedule(static)
      do i = 1, n
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         value = x(i) - centre
         if (absolute) value = abs(value)
         if (value > bound) next = min(next, value)
      end do
      !$omp end parallel do
   end function next_above

end module gyroakf_select
