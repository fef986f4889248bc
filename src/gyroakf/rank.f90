! SPDX-License-Identifier: MIT
!> A number of a series by its rank, without a copy of the series.
!>
!> The bits of a double, read as an integer with the sign folded in, are ordered like the numbers.
!> Six passes count the 11-bit digits of these keys, from the highest down, each among the samples
!> that share the digits found before. Ties and outliers cost nothing; counts are integers, so the
!> result does not depend on the threads.
module gyroakf_rank
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_last
   implicit none (type, external)
   private
   public :: numbers_type, find_rank, next_above

   integer, parameter :: digit_bits = 11, digits = 6
   integer(int64), parameter :: largest_digit = ishft(1_int64, digit_bits) - 1
   !> Bit of the sign alone
   integer(int64), parameter :: sign_bit = ishft(1_int64, 63)

   !> The numbers x - center or |x - center|
   type :: numbers_type
      !> Finite: [n]
      real(dp), pointer, contiguous :: x(:)
      real(dp) :: center = 0.0_dp
      logical :: absolute = .false.
      !> 1 present, 0 missing: [n]; not associated where all are present
      integer(int8), pointer :: valid(:) => null()
   end type numbers_type

contains

   !> A number by its rank, and the one of the next rank (`huge`: none), digit by digit.
   subroutine find_rank(numbers, rank, value, next, error)
      !> At least one is present
      type(numbers_type), intent(in) :: numbers
      !> Among those that are present, 1 the smallest
      integer(int64), intent(in) :: rank
      !> The number of this rank, and of the next
      real(dp), intent(out) :: value, next
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64), allocatable :: histogram(:)
      integer(int64) :: rest, key, digit
      integer :: d

      rest = rank
      key = 0
      value = 0.0_dp
      next = 0.0_dp
      do d = 1, digits
         call count_digits(numbers, d, key, histogram, error)
         if (allocated(error)) return
         do digit = 0, largest_digit
            if (rest <= histogram(digit)) exit
            rest = rest - histogram(digit)
         end do
         key = ior(ishft(key, digit_bits), digit)
      end do
      value = value_of(key)
      next = value
      if (rest == histogram(digit)) next = next_above(numbers, value)
   end subroutine find_rank

   !> Ordered integer of a finite number, as unsigned.
   elemental integer(int64) function key_of(x)
      real(dp), intent(in) :: x

      key_of = transfer(x, key_of)
      key_of = merge(not(key_of), ieor(key_of, sign_bit), key_of < 0)
   end function key_of

   !> The number of a key.
   elemental real(dp) function value_of(key)
      integer(int64), intent(in) :: key

      value_of = transfer(merge(ieor(key, sign_bit), not(key), key < 0), value_of)
   end function value_of

   !> Counts a digit, 1 the highest, among the numbers whose higher digits are known: [0:2047].
   subroutine count_digits(numbers, digit, prefix, histogram, error)
      type(numbers_type), intent(in) :: numbers
      integer, intent(in) :: digit
      integer(int64), intent(in) :: prefix
      integer(int64), allocatable, intent(out) :: histogram(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), allocatable :: mine(:)
      integer(int64) :: n
      integer :: chunk, stat, bad

      n = size(numbers%x, kind=int64)
      stat = 0
      allocate (histogram(0:largest_digit), stat=bad)
      if (bad == 0) then
         histogram = 0
         !$omp parallel if (n >= threads_from) default(shared) private(mine, bad)
         allocate (mine(0:largest_digit), stat=bad)
         if (bad == 0) mine = 0
         !$omp do schedule(static)
         do chunk = 1, chunk_count(n)
            if (bad == 0) call count_chunk(numbers, digit, prefix, chunk, mine)
         end do
         !$omp end do
         !$omp critical (gyroakf_select_histogram)
         if (bad == 0) histogram = histogram + mine
         stat = stat + abs(bad)
         !$omp end critical (gyroakf_select_histogram)
         !$omp end parallel
      end if
      call check_memory(bad + stat, "the counts of the median", error)
   end subroutine count_digits

   !> The same within a chunk, added to what is counted.
   pure subroutine count_chunk(numbers, digit, prefix, chunk, histogram)
      type(numbers_type), intent(in) :: numbers
      integer, intent(in) :: digit, chunk
      integer(int64), intent(in) :: prefix
      integer(int64), intent(inout) :: histogram(0:)
      integer(int64) :: i, key
      integer :: low
      real(dp) :: value

      low = digit_bits*(digits - digit)
      associate (x => numbers%x)
         do i = chunk_first(size(x, kind=int64), chunk), chunk_last(size(x, kind=int64), chunk)
            if (associated(numbers%valid)) then
               if (numbers%valid(i) == 0_int8) cycle
            end if
            value = (x(i) - numbers%center) + 0.0_dp  ! -0 becomes 0
            if (numbers%absolute) value = abs(value)
            key = ishft(key_of(value), -low)
            if (digit > 1) then
               if (ishft(key, -digit_bits) /= prefix) cycle
            end if
            key = iand(key, largest_digit)
            histogram(key) = histogram(key) + 1
         end do
      end associate
   end subroutine count_chunk

   !> Smallest of the numbers above a bound, `huge` where there is none.
   real(dp) function next_above(numbers, bound) result(next)
      !> Any
      type(numbers_type), intent(in) :: numbers
      !> Any
      real(dp), intent(in) :: bound
      real(dp) :: value
      integer(int64) :: i, n

      n = size(numbers%x, kind=int64)
      next = huge(next)
      !$omp parallel do if (n >= threads_from) default(shared) private(value) reduction(min:next) &
      !$omp& schedule(static)
      do i = 1, n
         if (associated(numbers%valid)) then
            if (numbers%valid(i) == 0_int8) cycle
         end if
         value = numbers%x(i) - numbers%center
         if (numbers%absolute) value = abs(value)
         if (value > bound) next = min(next, value)
      end do
      !$omp end parallel do
   end function next_above

end module gyroakf_rank
