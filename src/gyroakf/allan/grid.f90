! SPDX-License-Identifier: MIT
!> The averaging factors m of an Allan analysis, from the text of the option `--taus`.
!>
!> | text | averaging factors, all with 1 <= m <= n/2 |
!> |---|---|
!> | `octave` | 1, 2, 4, 8 ... |
!> | `decade` | 1, 2, 5, 10, 20, 50 ... (1, 2, 5 in every decade) |
!> | `log:N` | N evenly spaced in every decade of m, rounded to integers, each once |
!> | `all` | every m |
!> | `0.1,1,10` | averaging times in seconds, rounded to the nearest multiple of the sample interval |
module gyroakf_allan_grid
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: averaging_factors

   !> The largest N of `log:N`
   integer, parameter :: per_decade_max = 1000

contains

   !> Averaging factors, ascending, each once, 1 <= m <= samples/2.
   subroutine averaging_factors(taus, samples, sample_interval, m, error)
      !> `octave`, `decade`, `log:N` (1 <= N <= 1000), `all`, or seconds separated by commas; of the listed
      !> ones those longer than half the record are left out, and one that is less than half a sample is an error
      character(*), intent(in) :: taus
      !> Rate samples in the record, >= 2
      integer(int64), intent(in) :: samples
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> The factors: [at least 1]
      integer(int64), allocatable, intent(out) :: m(:)
      !> invalid_argument (unknown text), too_few_samples (no factor fits), no_memory
      type(error_type), allocatable, intent(out) :: error

      integer :: per_decade

      if (samples < 2) then
         call fatal_error(error, status%too_few_samples, "an Allan deviation needs at least 2 samples, got "// &
            & trim(text_int(samples)))
         return
      end if
      select case (taus)
      case ("octave")
         call powers_of_two(samples/2, m)
      case ("decade")
         call one_two_five(samples/2, m)
      case ("all")
         call every_factor(samples/2, m, error)
      case default
         if (index(taus, "log:") == 1) then
            call read_per_decade(taus(5:), per_decade, error)
            if (.not. allocated(error)) call logarithmic(samples/2, per_decade, m)
         else
            call from_seconds(taus, samples/2, sample_interval, m, error)
         end if
      end select
   end subroutine averaging_factors

   !> 1, 2, 4 ... up to the limit.
   pure subroutine powers_of_two(limit, m)
      !> Largest factor, >= 1
      integer(int64), intent(in) :: limit
      !> The factors
      integer(int64), allocatable, intent(out) :: m(:)

      integer :: i, count

      count = int(bit_size(limit)) - leadz(limit)
      allocate (m(count))
      do i = 1, count
         m(i) = 2_int64**(i - 1)
      end do
   end subroutine powers_of_two

   !> 1, 2, 5, 10, 20 ... up to the limit.
   pure subroutine one_two_five(limit, m)
      !> Largest factor, >= 1
      integer(int64), intent(in) :: limit
      !> The factors
      integer(int64), allocatable, intent(out) :: m(:)

      integer(int64), parameter :: step(3) = [1_int64, 2_int64, 5_int64]
      integer(int64) :: value(3*19)
      integer :: i, count

      count = 0
      do i = 0, size(value) - 1
         value(i + 1) = step(1 + mod(i, 3))*10_int64**(i/3)
         if (value(i + 1) > limit) exit
         count = i + 1
      end do
      m = value(:count)
   end subroutine one_two_five

   !> Every factor up to the limit.
   subroutine every_factor(limit, m, error)
      !> Largest factor, >= 1
      integer(int64), intent(in) :: limit
      !> The factors
      integer(int64), allocatable, intent(out) :: m(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64) :: i
      integer :: stat

      allocate (m(limit), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for "//trim(text_int(limit))//" averaging factors")
         return
      end if
      do i = 1, limit
         m(i) = i
      end do
   end subroutine every_factor

   !> Nearest integers to 10**(i/per_decade), each once, up to the limit.
   pure subroutine logarithmic(limit, per_decade, m)
      !> Largest factor, >= 1
      integer(int64), intent(in) :: limit
      !> Points per decade
      integer, intent(in) :: per_decade
      !> The factors
      integer(int64), allocatable, intent(out) :: m(:)

      integer(int64), allocatable :: value(:)
      integer(int64) :: next
      integer :: i, count

      allocate (value(19*per_decade))
      count = 0
      do i = 0, size(value) - 1
         next = nint(10.0_dp**(real(i, dp)/per_decade), int64)
         if (next > limit) exit
         if (count > 0) then
            if (next == value(count)) cycle
         end if
         count = count + 1
         value(count) = next
      end do
      m = value(:count)
   end subroutine logarithmic

   !> Reads the N of `log:N`.
   subroutine read_per_decade(text, per_decade, error)
      !> What stands after the colon
      character(*), intent(in) :: text
      !> The number
      integer, intent(out) :: per_decade
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      integer :: stat

      per_decade = 0
      stat = 1
      if (len(text) > 0 .and. len(text) <= 4 .and. verify(text, "0123456789") == 0) read (text, "(i4)", iostat=stat) per_decade
      if (stat /= 0 .or. per_decade < 1 .or. per_decade > per_decade_max) then
         call fatal_error(error, status%invalid_argument, &
            & "taus 'log:"//text//"': the points per decade are a whole number from 1 to 1000")
      end if
   end subroutine read_per_decade

   !> Factors from a list of averaging times.
   subroutine from_seconds(text, limit, sample_interval, m, error)
      !> Seconds, separated by commas
      character(*), intent(in) :: text
      !> Largest factor, >= 1
      integer(int64), intent(in) :: limit
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> The factors
      integer(int64), allocatable, intent(out) :: m(:)
      !> invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error

      integer(int64), allocatable :: value(:)
      real(dp) :: tau
      integer :: first, last, count

      allocate (value(len(text) + 1))
      count = 0
      first = 1
      do while (first <= len(text) + 1)
         last = index(text(first:), ",") + first - 2
         if (last < first - 1) last = len(text)
         call read_seconds(text(first:last), sample_interval, tau, error)
         if (allocated(error)) return
         if (tau/sample_interval < real(limit, dp) + 0.5_dp) then
            count = count + 1
            value(count) = nint(tau/sample_interval, int64)
         end if
         first = last + 2
      end do
      if (count == 0) then
         call fatal_error(error, status%too_few_samples, "taus '"//text//"': all of them are longer than half the record")
         return
      end if
      call sort_unique(value(:count), m)
   end subroutine from_seconds

   !> Reads one averaging time.
   subroutine read_seconds(text, sample_interval, tau, error)
      !> Digits with an optional point and exponent
      character(*), intent(in) :: text
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> Seconds, at least half a sample interval
      real(dp), intent(out) :: tau
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      character(:), allocatable :: word
      integer :: stat

      word = trim(adjustl(text))
      tau = 0
      stat = 1
      if (plain_number(word)) read (word, "(f40.0)", iostat=stat) tau
      if (stat /= 0) then
         call fatal_error(error, status%invalid_argument, "taus: '"//word//"' is not a number of seconds"// &
            & " (octave, decade, log:N, all, or seconds separated by commas)")
      else if (tau < 0.5_dp*sample_interval) then
         call fatal_error(error, status%invalid_argument, "taus: '"//word//"' s is less than half a sample interval")
      end if
   end subroutine read_seconds

   !> Digits with a point, and an exponent of at most two digits: nothing that overflows on conversion.
   pure logical function plain_number(word)
      !> One word
      character(*), intent(in) :: word

      integer :: mark

      mark = scan(word, "eEdD")
      if (mark == 0) mark = len(word) + 1
      plain_number = mark > 1 .and. len(word) <= 40 .and. verify(word(:mark - 1), "0123456789.+") == 0
      if (plain_number) plain_number = scan(word(2:mark - 1), "+") == 0 .and. scan(word(:mark - 1), "0123456789") > 0
      if (plain_number .and. mark < len(word)) then
         plain_number = verify(word(mark + 1:), "0123456789+-") == 0 .and. scan(word(mark + 2:), "+-") == 0 &
            & .and. len(word) - mark - scan(word(mark + 1:mark + 1), "+-") <= 2
      end if
      if (mark == len(word)) plain_number = .false.
   end function plain_number

   !> Ascending, each value once.
   pure subroutine sort_unique(value, m)
      !> A short list
      integer(int64), intent(in) :: value(:)
      !> The result
      integer(int64), allocatable, intent(out) :: m(:)

      integer(int64) :: sorted(size(value)), next
      integer :: i, j, count

      count = 0
      do i = 1, size(value)
         next = value(i)
         if (any(sorted(:count) == next)) cycle
         do j = count, 1, -1
            if (sorted(j) < next) exit
            sorted(j + 1) = sorted(j)
         end do
         sorted(j + 1) = next
         count = count + 1
      end do
      m = sorted(:count)
   end subroutine sort_unique

   !> A whole number as text.
   pure function text_int(value) result(text)
      !> The number
      integer(int64), intent(in) :: value
      character(20) :: text

      write (text, "(i0)") value
   end function text_int

end module gyroakf_allan_grid
