! SPDX-License-Identifier: MIT
!> A record gets its shape: a place for lost samples, marks for missing ones, rates of angles.
module gyroakf_io_shape
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_io_audit, only : gap_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_stats_extremes, only : all_sound
   use gyroakf_io_number, only : parse_number
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, record_type
   use gyroakf_units, only : angle_to_rate_unit
   implicit none (type, external)
   private
   public :: fill_gaps, mark_missing, make_rates, cut, wrap_of, wrapped, warn_of_wraps, &
      largest_value, refuse_tiny

   !> A rate beyond it is an error: the fourth powers of the statistics would overflow
   real(dp), parameter :: largest_value = 1.0e60_dp
   !> Where no value of a channel is larger, and one is not 0: their squares would vanish
   real(dp), parameter :: least_value = 1.0e-140_dp

contains

   !> Inserts the lost samples, as NaN for now.
   subroutine fill_gaps(gaps, record, error)
      !> Where samples were lost
      type(gap_type), intent(in) :: gaps
      !> `value` grows
      type(record_type), intent(inout) :: record
      !> Allocated on failure: no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: longer(:, :)
      integer(int64) :: n, lost, at, from
      integer :: failed, k
      real(dp) :: nan

      if (gaps%count == 0) return
      n = size(record%value, 1, kind=int64)
      lost = sum(gaps%length(:gaps%count))
      allocate (longer(n + lost, size(record%value, 2)), stat=failed)
      call check_memory(failed, integer_text(lost)//" missing samples in the gaps", error)
      if (allocated(error)) return
      nan = ieee_value(nan, ieee_quiet_nan)
      at = 0
      from = 1
      do k = 1, gaps%count
         longer(at + 1:at + gaps%before(k) - from, :) = record%value(from:gaps%before(k) - 1, :)
         at = at + gaps%before(k) - from
         longer(at + 1:at + gaps%length(k), :) = nan
         at = at + gaps%length(k)
         from = gaps%before(k)
      end do
      longer(at + 1:, :) = record%value(from:, :)
      call move_alloc(longer, record%value)
   end subroutine fill_gaps

   !> NaN becomes 0 and a mark in `present`, which exists only where something is missing.
   subroutine mark_missing(record, largest, error, progress)
      !> NaN marks what is missing
      type(record_type), intent(inout) :: record
      !> Larger values are an error
      real(dp), intent(in) :: largest
      !> Allocated on failure: no_memory, non_finite, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: i
      integer :: j, failed

      do j = 1, size(record%value, 2)
         call report_progress("completing the record", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         if (all_sound(record%value(:, j), largest)) cycle
         do i = 1, size(record%value, 1, kind=int64)
            if (.not. ieee_is_nan(record%value(i, j))) then
               if (abs(record%value(i, j)) <= largest) cycle
               call fatal_error(error, status%non_finite, "sample "//integer_text(i)//" of '"// &
                  record%channel(j)%text//"' is "//format_real(record%value(i, j), 6)// &
                  "; at most "//format_real(largest, 3)//" can be analyzed")
               return
            end if
            if (.not. allocated(record%present)) then
               allocate (record%present(size(record%value, 1, kind=int64), size(record%value, 2)), &
                  stat=failed)
               call check_memory(failed, "the marks of missing samples", error)
               if (allocated(error)) return
               record%present = 1_int8
            end if
            record%present(i, j) = 0_int8
            record%value(i, j) = 0.0_dp
         end do
      end do
   end subroutine mark_missing

   !> Refuses a channel whose values are so small that their squares are no numbers.
   pure subroutine refuse_tiny(record, error)
      !> Rates; the audit knows their extremes
      type(record_type), intent(in) :: record
      !> Allocated on failure: non_finite
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: largest
      integer :: j

      do j = 1, size(record%channel)
         largest = max(-record%audit%minimum(j), record%audit%maximum(j))
         if (largest <= 0.0_dp .or. largest >= least_value) cycle
         call fatal_error(error, status%non_finite, "no value of '"//record%channel(j)%text// &
            "' is larger than "//format_real(largest, 3)//"; the largest must be "// &
            format_real(least_value, 3)// &
            " at least to be analyzed: multiply them by a constant (`scale`)")
         return
      end do
   end subroutine refuse_tiny

   !> Scales, and turns increments or angles into rates.
   subroutine make_rates(record, input, scale, error, wrap)
      !> Holds what the file holds; afterwards rates
      type(record_type), intent(inout) :: record
      !> "rate", "increment" or "angle"
      character(*), intent(in) :: input
      !> Every value is multiplied by it
      real(dp), intent(in) :: scale
      !> Allocated on failure: too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Where angles begin again, in units of the file; 0: they do not
      real(dp), intent(in) :: wrap
      real(dp) :: factor
      integer :: j

      factor = scale
      if (input /= "rate") then
         factor = scale/record%sample_interval
         record%unit = angle_to_rate_unit(record%unit)
         if (allocated(record%channel_unit)) then
            do j = 1, size(record%channel_unit)
               record%channel_unit(j) = angle_to_rate_unit(record%channel_unit(j))
            end do
         end if
      end if
      if (input == "angle") call difference(record, wrap, error)
      if (allocated(error) .or. abs(factor - 1.0_dp) <= 0.0_dp) return
      do j = 1, size(record%value, 2)
         record%value(:, j) = record%value(:, j)*factor
      end do
   end subroutine make_rates

   !> A difference of angles brought into (-modulus/2, modulus/2]; as it is where the modulus is 0.
   pure elemental real(dp) function wrapped(change, modulus)
      !> In units of the file
      real(dp), intent(in) :: change, modulus

      wrapped = change
      if (modulus <= 0.0_dp .or. (change > -0.5_dp*modulus .and. change <= 0.5_dp*modulus)) return
      wrapped = modulo(change, modulus)
      if (wrapped > 0.5_dp*modulus) wrapped = wrapped - modulus
   end function wrapped

   !> Where angles begin again: by the option, else the range of the file's integers; 0: nowhere.
   pure real(dp) function wrap_of(options, table)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      character(:), allocatable :: word
      integer :: found

      wrap_of = 0.0_dp
      word = "auto"
      if (allocated(options%wrap)) word = options%wrap
      if (word == "auto") then
         if (table%integer_bits > 0 .and. table%integer_bits < 64) wrap_of = &
            2.0_dp**table%integer_bits
      else if (word /= "none") then
         call parse_number(word, wrap_of, found)
      end if
   end function wrap_of

   !> Warns of angles that jump like a wrapping counter, where no wrap was given.
   subroutine warn_of_wraps(record)
      !> Angles, before they are differenced
      type(record_type), intent(inout) :: record
      real(dp), parameter :: usual(10) = [6.283185307179586_dp, 256.0_dp, 360.0_dp, 4096.0_dp, &
         16384.0_dp, 32768.0_dp, 65536.0_dp, 16777216.0_dp, 2147483648.0_dp, 4294967296.0_dp]
      real(dp) :: largest, other, change
      integer(int64) :: i, times
      integer :: j, k

      do j = 1, size(record%value, 2)
         largest = 0.0_dp
         do i = 2, size(record%value, 1, kind=int64)
            largest = max(largest, change_at(record, i, j))
         end do
         k = findloc(usual >= largest, .true., dim=1)
         if (k == 0 .or. largest <= 0.0_dp) cycle
         if (largest < 0.75_dp*usual(k)) cycle
         other = 0.0_dp
         times = 0
         do i = 2, size(record%value, 1, kind=int64)
            change = change_at(record, i, j)
            if (change >= 0.75_dp*usual(k)) times = times + 1
            if (change < 0.75_dp*usual(k)) other = max(other, change)
         end do
         if (other > 0.25_dp*usual(k)) cycle
         call add_text(record%warnings, "the angle in "//record%channel(j)%text// &
            " jumps by nearly "//format_real(usual(k), 10)// &
            trim(merge(" (2^n)", "      ", k == 2 .or. k > 3))//" in "//integer_text(times)// &
            trim(merge(" place ", " places", times == 1))//", as a counter does that begins "// &
            "again; `wrap` "//format_real(usual(k), 16)//" undoes it")
      end do
   end subroutine warn_of_wraps

   !> How much a sample differs from the one before; 0 where one of them is missing.
   pure real(dp) function change_at(record, i, j) result(change)
      type(record_type), intent(in) :: record
      integer(int64), intent(in) :: i
      integer, intent(in) :: j

      change = abs(record%value(i, j) - record%value(i - 1, j))
      if (.not. allocated(record%present)) return
      if (record%present(i, j)*record%present(i - 1, j) == 0) change = 0.0_dp
   end function change_at

   !> n angles become n - 1 differences; one is missing where one of its two angles is.
   subroutine difference(record, modulus, error)
      type(record_type), intent(inout) :: record
      real(dp), intent(in) :: modulus
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: i, n
      integer :: j

      n = size(record%value, 1, kind=int64)
      if (n < 2) call fatal_error(error, status%too_few_samples, &
         "`input` angle needs at least 2 samples, got "//integer_text(n))
      if (allocated(error)) return
      do j = 1, size(record%value, 2)
         do i = 1, n - 1
            record%value(i, j) = wrapped(record%value(i + 1, j) - record%value(i, j), modulus)
            if (.not. allocated(record%present)) cycle
            record%present(i, j) = record%present(i, j)*record%present(i + 1, j)
            if (record%present(i, j) == 0) record%value(i, j) = 0.0_dp
         end do
      end do
      call keep_rows(record, 1_int64, n - 1, error)
   end subroutine difference

   !> Keeps the part that was asked for.
   subroutine cut(record, from, to, error)
      !> Of any length; afterwards the part from <= time < to
      type(record_type), intent(inout) :: record
      !> s from the start
      real(dp), intent(in) :: from, to
      !> Allocated where nothing is left: too_few_samples; or no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: first, last, n
      real(dp) :: length

      if (from <= 0.0_dp .and. to >= huge(1.0_dp)) return
      n = size(record%value, 1, kind=int64)
      length = real(n, dp)*record%sample_interval
      if (from >= length) call fatal_error(error, status%too_few_samples, "the record ends at "// &
         format_real(length, 6)//" s, before `from` "//format_real(from, 6))
      if (allocated(error)) return
      first = 1 + ceiling(from/record%sample_interval - 1.0e-6_dp, int64)
      last = n
      if (to < length) last = ceiling(to/record%sample_interval - 1.0e-6_dp, int64)
      if (first > last) call fatal_error(error, status%too_few_samples, &
         "no sample lies between `from` and `to`")
      if (allocated(error)) return
      call keep_rows(record, first, last, error)
   end subroutine cut

   subroutine keep_rows(record, first, last, error)
      type(record_type), intent(inout) :: record
      integer(int64), intent(in) :: first, last
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: value(:, :)
      integer(int8), allocatable :: present(:, :)
      integer :: failed

      allocate (value(last - first + 1, size(record%value, 2)), stat=failed)
      if (failed == 0) then
         value(:, :) = record%value(first:last, :)
         call move_alloc(value, record%value)
         if (.not. allocated(record%present)) return
         allocate (present(last - first + 1, size(record%value, 2)), stat=failed)
      end if
      call check_memory(failed, "a part of the record", error)
      if (allocated(error)) return
      present(:, :) = record%present(first:last, :)
      call move_alloc(present, record%present)
      if (all(record%present == 1_int8)) deallocate (record%present)
   end subroutine keep_rows

end module gyroakf_io_shape
