! SPDX-License-Identifier: MIT
!> The time of a recording: the unit of its stamps, its rate and who said so, and whether a column may be a time.
module gyroakf_io_clock
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_columns, only : label_of
   use gyroakf_io_date, only : stamp_kind
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_row_problem, only : kind_of
   use gyroakf_io_stamps, only : infer_scale, named_scale
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, record_type
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : time_scale
   implicit none (type, external)
   private
   public :: drop_absurd, find_scale, is_clock, set_rate

contains

   !> The unit of the stamps and the first of them.
   subroutine find_scale(options, table, stamps, record, scale, origin)
      !> For the rate
      type(reader_options), intent(in) :: options
      !> For names, units and the header's rate
      type(table_type), intent(in) :: table
      !> As read
      real(dp), intent(in), contiguous :: stamps(:)
      !> Gets a warning where the unit is guessed
      type(record_type), intent(inout) :: record
      !> Seconds in the unit of the stamps
      real(dp), intent(out) :: scale
      !> The first stamp
      real(dp), intent(out) :: origin
      real(dp) :: given
      logical :: sure
      integer(int64) :: i
      integer :: kind

      scale = 0.0_dp
      kind = kind_of(table%layout, table%time)
      if (kind /= stamp_kind%number .and. kind /= stamp_kind%long) then
         scale = 1.0_dp
      else if (allocated(options%time_unit)) then
         scale = time_scale(lower(options%time_unit))
      else if (table%names%known) then
         scale = named_scale(table%names%name(table%time)%text, table%names%unit(table%time)%text)
      end if
      if (scale <= 0.0_dp) then
         given = merge(options%rate_hz, table%header%rate_hz, options%rate_hz > 0.0_dp)
         call infer_scale(stamps, given, scale, sure, real(table%layout%origin, dp))
         if (.not. sure) call add_text(record%warnings, "the time in "//label_of(table%names, table%time)// &
            " names no unit and is taken as "//unit_word(scale)//" by its step; --time-unit "//unit_word(scale)// &
            " or a name such as time_"//unit_word(scale)//" settles it")
      end if
      do i = 1, size(stamps, kind=int64)
         if (.not. ieee_is_nan(stamps(i))) exit
      end do
      origin = 0.0_dp
      if (i <= size(stamps, kind=int64)) origin = stamps(i)
   end subroutine find_scale

   !> True where the time is a time of day, without a date, which begins again at midnight.
   pure logical function is_clock(table)
      !> With a time column
      type(table_type), intent(in) :: table

      is_clock = kind_of(table%layout, table%time) == stamp_kind%clock
      if (is_clock) is_clock = count(table%layout%slot == table%layout%slot(table%time)) == 1
   end function is_clock

   !> What is too large for a time, and for products of times, is missing; what is too small for their quotients is 0.
   pure subroutine drop_absurd(stamps)
      !> As read
      real(dp), intent(inout), contiguous :: stamps(:)
      real(dp), parameter :: largest_stamp = 1.0e30_dp, smallest_stamp = 1.0e-30_dp
      integer(int64) :: i

      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         if (abs(stamps(i)) > largest_stamp) then
            stamps(i) = ieee_value(1.0_dp, ieee_quiet_nan)
         else if (abs(stamps(i)) < smallest_stamp) then
            stamps(i) = 0.0_dp
         end if
      end do
   end subroutine drop_absurd

   !> The word for a unit of time.
   pure function unit_word(scale) result(word)
      real(dp), intent(in) :: scale
      character(1 + count([scale < 0.5_dp])) :: word

      word = "s"
      if (scale < 0.5_dp) word = "ms"
      if (scale < 0.5e-3_dp) word = "us"
      if (scale < 0.5e-6_dp) word = "ns"
   end function unit_word

   !> The rate: an option, else the stamps, else the header; stamps that contradict the header by more than 1 % do not count.
   subroutine set_rate(options, table, record, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: rate, stamped
      logical :: differ

      rate = 0.0_dp
      record%rate_source = "none"
      stamped = record%audit%stamp_rate
      if (options%rate_hz > 0.0_dp) then
         rate = options%rate_hz
         record%rate_source = "option"
      else if (table%header%rate_hz > 0.0_dp) then
         rate = table%header%rate_hz
         record%rate_source = "header"
      end if
      differ = .false.
      if (rate > 0.0_dp .and. stamped > 0.0_dp) differ = abs(stamped - rate) > 0.01_dp*rate
      if (differ) call add_text(record%warnings, "the rate "//format_real(rate, 6)//" Hz of the "//record%rate_source// &
         " and the time stamps' "//format_real(stamped, 6)//" Hz differ; the "//record%rate_source//"'s is used")
      if (stamped > 0.0_dp .and. record%rate_source /= "option" .and. .not. differ) then
         rate = stamped
         record%rate_source = "timestamps"
      end if
      record%rate_known = rate > 0.0_dp
      if (record%rate_known) record%sample_interval = 1.0_dp/rate
      if (record%rate_known) return
      if (options%input /= "rate") call fatal_error(error, status%invalid_argument, "--input "//options%input// &
         " needs the rate, and "//table%name//" does not tell it: give --rate HZ or --dt S, or --time-column")
      if (options%from > 0.0_dp .or. options%to < huge(1.0_dp)) call fatal_error(error, status%invalid_argument, &
         "--from and --to need the rate, and "//table%name//" does not tell it: give --rate HZ or --dt S, or --time-column")
   end subroutine set_rate

end module gyroakf_io_clock
