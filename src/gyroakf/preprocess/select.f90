! SPDX-License-Identifier: MIT
!> Order statistics in linear time without a copy of the series.
!>
!> The bits of a double, read as an integer with the sign folded in, are ordered like the numbers.
!> Six passes count the 11-bit digits of these keys, from the highest down, each among the samples
!> that share the digits found before. Ties and outliers cost nothing; counts are integers, so the
!> result does not depend on the threads.
module gyroakf_preprocess_select
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_last
   implicit none (type, external)
   private
   public :: find_median, find_deviation

   integer, parameter :: digit_bits = 11, digits = 6
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
      integer(int64), allocatable :: histogram(:)
      integer(int64) :: found, rank, key, digit
      integer :: d

      value = 0.0_dp
      found = size(x, kind=int64)
      if (present(valid)) found = count(valid /= 0_int8, kind=int64)
      if (found < 1) then
         call fatal_error(error, status%too_few_samples, "no sample is present, there is no median")
         return
      end if
      rank = (found + 1)/2
      key = 0
      do d = 1, digits
         call count_digits(x, centre, absolute, d, key, histogram, error, valid)
         if (allocated(error)) return
         do digit = 0, size(histogram, kind=int64) - 1
            if (rank <= histogram(digit)) exit
            rank = rank - histogram(digit)
         end do
         key = ior(ishft(key, digit_bits), digit)
      end do
      value = value_of(key)
      if (mod(found, 2_int64) == 1) return
      if (rank == histogram(digit)) value = 0.5_dp*value + 0.5_dp*next_above(x, centre, absolute, key, valid)
   end subroutine middle

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

   !> Smallest of the numbers above the one of the key.
   real(dp) function next_above(x, centre, absolute, key, valid) result(next)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted first
      real(dp), intent(in) :: centre
      !> Whether the sign is dropped
      logical, intent(in) :: absolute
      !> Key of the number
      integer(int64), intent(in) :: key
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: value, bound
      integer(int64) :: i, n

      n = size(x, kind=int64)
      bound = value_of(key)
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

end module gyroakf_preprocess_select
