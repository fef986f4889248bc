! SPDX-License-Identifier: MIT
!> The averaging factors m of an Allan analysis, from the text of the option `--taus`.
!>
!> | text | averaging factors, all with 1 <= m <= n/2 |
!> |---|---|
!> | `octave` | 1, 2, 4, 8 ... |
!> | `decade` | 1, 2, 5, 10, 20, 50 ... (1, 2, 5 in every decade) |
!> | `log:N` | N evenly spaced in every decade of m, rounded to integers, each once |
!> | `all` | every m |
!> | `0.1,1,10` | averaging times, s, rounded to the nearest multiple of the sample interval |
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
      !> `octave`, `decade`, `log:N` (1 <= N <= 1000), `all`, or seconds separated by commas; of the
      !> listed ones those longer than half the record are left out, and one that is less than half
      !> a sample is an error
      character(*), intent(in) :: taus
      !> Rate samples in the record, >= 2
      integer(int64), intent(in) :: samples
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> The factors: [at least 1]
      integer(int64), allocatable, intent(out) :: m(:)
      !> invalid_argument (unknown text), too_few_samples (no factor fits), no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64) :: i, one_two_five(57)
      integer :: per_decade, stat
      character(20) :: text

      if (samples < 2) then
         write (text, "(i0)") samples
         call fatal_error(error, status%too_few_samples, &
            & "an Allan deviation needs at least 2 samples, got "//trim(text))
         return
      end if
      select case (taus)
      case ("octave")
         m = [(2_int64**i, i=0, bit_size(samples) - leadz(samples/2) - 1)]
      case ("decade")
         one_two_five = [([1_int64, 2_int64, 5_int64]*10_int64**i, i=0, 18)]
         m = pack(one_two_five, one_two_five <= samples/2)
      case ("all")
         allocate (m(samples/2), stat=stat)
         if (stat /= 0) then
            write (text, "(i0)") samples/2
            call fatal_error(error, status%no_memory, &
               & "no memory for "//trim(text)//" averaging factors")
            return
         end if
         do i = 1, samples/2
            m(i) = i
         end do
      case default
         if (index(taus, "log:") == 1) then
            call read_per_decade(taus(5:), per_decade, error)
            if (.not. allocated(error)) call logarithmic(samples/2, per_decade, m)
         else
            call from_seconds(taus, samples/2, sample_interval, m, error)
         end if
      end select
   end subroutine averaging_factors

   !> Nearest integers to 10**(i/per_decade), each once, up to the limit.
   pure subroutine logarithmic(limit, per_decade, m)
      integer(int64), intent(in) :: limit
      integer, intent(in) :: per_decade
      integer(int64), allocatable, intent(out) :: m(:)
      integer(int64), allocatable :: value(:)
      integer :: i

      allocate (value(19*per_decade))
      do i = 1, size(value)
         value(i) = nint(10.0_dp**min(real(i - 1, dp)/per_decade, 18.9_dp), int64)
      end do
      m = pack(value, value <= limit .and. value /= [0_int64, value(:size(value) - 1)])
   end subroutine logarithmic

   !> Reads the N of `log:N`.
   subroutine read_per_decade(text, per_decade, error)
      !> What stands after the colon
      character(*), intent(in) :: text
      integer, intent(out) :: per_decade
      type(error_type), allocatable, intent(out) :: error

      integer :: stat

      per_decade = 0
      stat = 1
      if (len(text) > 0 .and. len(text) <= 4 .and. verify(text, "0123456789") == 0) then
         read (text, "(i4)", iostat=stat) per_decade
      end if
      if (stat /= 0 .or. per_decade < 1 .or. per_decade > per_decade_max) then
         call fatal_error(error, status%invalid_argument, &
            & "taus 'log:"//text//"': the points per decade are a whole number from 1 to 1000")
      end if
   end subroutine read_per_decade

   !> Factors from a list of averaging times.
   subroutine from_seconds(text, limit, sample_interval, m, error)
      character(*), intent(in) :: text
      integer(int64), intent(in) :: limit
      real(dp), intent(in) :: sample_interval
      integer(int64), allocatable, intent(out) :: m(:)
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
         call fatal_error(error, status%too_few_samples, "taus '"//text &
            & //"': all of them are longer than half the record")
         return
      end if
      call sort_unique(value(:count), m)
   end subroutine from_seconds

   !> Reads one averaging time.
   subroutine read_seconds(text, sample_interval, tau, error)
      !> Digits with an optional point and exponent
      character(*), intent(in) :: text
      real(dp), intent(in) :: sample_interval
      !> Seconds, at least half a sample interval
      real(dp), intent(out) :: tau
      type(error_type), allocatable, intent(out) :: error

      character(:), allocatable :: word
      integer :: stat

      word = trim(adjustl(text))
      tau = 0
      stat = 1
      if (plain_number(word)) read (word, "(f40.0)", iostat=stat) tau
      if (stat /= 0) then
         call fatal_error(error, status%invalid_argument, "taus: '"//word &
            & //"' is not a number of seconds" &
            & //" (octave, decade, log:N, all, or seconds separated by commas)")
      else if (tau < 0.5_dp*sample_interval) then
         call fatal_error(error, status%invalid_argument, "taus: '"//word &
            & //"' s is less than half a sample interval")
      end if
   end subroutine read_seconds

   !> Digits with a point, and an exponent of at most two digits: nothing that overflows on
   !> conversion.
   pure logical function plain_number(word)
      character(*), intent(in) :: word
      integer :: mark

      mark = scan(word, "eEdD")
      if (mark == 0) mark = len(word) + 1
      plain_number = mark > 1 .and. len(word) <= 40 &
         & .and. verify(word(:mark - 1), "0123456789.+") == 0
      if (plain_number) plain_number = scan(word(2:mark - 1), "+") == 0 &
         & .and. scan(word(:mark - 1), "0123456789") > 0
      if (plain_number .and. mark < len(word)) then
         plain_number = verify(word(mark + 1:), "0123456789+-") == 0 &
            & .and. scan(word(mark + 2:), "+-") == 0 .and. len(word) - mark &
            & - scan(word(mark + 1:mark + 1), "+-") <= 2
      end if
      if (mark == len(word)) plain_number = .false.
   end function plain_number

   !> Ascending, each value once.
   pure subroutine sort_unique(value, m)
      integer(int64), intent(in) :: value(:)
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

end module gyroakf_allan_grid
