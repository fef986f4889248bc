! SPDX-License-Identifier: MIT
!> Axes of a figure or a chart, linear or logarithmic: values to places (pixels, dots), ticks and
!> their labels.
module gyroakf_report_axis
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_report_text_layout, only : number
   implicit none (type, external)
   private
   public :: axis_type, tick_type, set_range, scale_axis, is_shown, is_inside, position, find_ticks

   !> An axis between two pixels
   type :: axis_type
      logical :: logarithmic = .false.
      !> Values at the ends; of a logarithmic axis their decimal logarithms, last > first
      real(dp) :: first = 0.0_dp, last = 1.0_dp
      !> Pixels of the ends
      real(dp) :: from = 0.0_dp, to = 100.0_dp
   end type axis_type

   !> A tick
   type :: tick_type
      real(dp) :: value = 0.0_dp
      !> "" of a mere line of the grid
      character(16) :: label = ""
   end type tick_type

   !> Magnitudes that are drawn; shortest linear range as a share of the values, and logarithmic
   !> range in decades
   real(dp), parameter :: smallest = 1.0e-290_dp, largest = 1.0e290_dp, &
      least_share = 1.0e-9_dp, least_decades = 1.0_dp

contains

   !> Whether an axis can show a value: finite, of a usual magnitude, positive on a logarithmic
   !> axis.
   elemental logical function is_shown(axis, value)
      !> Its kind alone counts
      type(axis_type), intent(in) :: axis
      !> Any, NaN included
      real(dp), intent(in) :: value

      is_shown = .false.
      if (.not. ieee_is_finite(value)) return
      is_shown = abs(value) < largest
      if (axis%logarithmic .and. is_shown) is_shown = value > smallest
   end function is_shown

   !> Sets the ends of an axis to a range of values with a margin on both sides.
   pure subroutine set_range(axis, low, high, margin)
      !> Kind and pixels stay
      type(axis_type), intent(inout) :: axis
      !> Both can be shown, high >= low
      real(dp), intent(in) :: low, high
      !> Share of the range, >= 0
      real(dp), intent(in) :: margin
      real(dp) :: missing

      axis%first = low
      axis%last = high
      missing = least_share*max(abs(low), abs(high)) - (high - low)
      if (axis%logarithmic) then
         axis%first = log10(low)
         axis%last = log10(high)
         missing = least_decades - (axis%last - axis%first)
      else if (.not. high > low) then
         missing = max(0.1_dp*abs(high), smallest)
      end if
      missing = max(0.0_dp, missing)/2 + margin*(axis%last - axis%first)
      axis%first = axis%first - missing
      axis%last = axis%last + missing
   end subroutine set_range

   !> The same axis in another unit.
   pure type(axis_type) function scale_axis(axis, factor)
      !> Of the first unit
      type(axis_type), intent(in) :: axis
      !> Values in the other unit over those in the first, > 0
      real(dp), intent(in) :: factor

      scale_axis = axis
      if (axis%logarithmic) then
         scale_axis%first = axis%first + log10(factor)
         scale_axis%last = axis%last + log10(factor)
      else
         scale_axis%first = axis%first*factor
         scale_axis%last = axis%last*factor
      end if
   end function scale_axis

   !> Pixel of a value; beyond the ends where the value is.
   elemental real(dp) function position(axis, value)
      !> With its range
      type(axis_type), intent(in) :: axis
      !> One that can be shown
      real(dp), intent(in) :: value
      real(dp) :: x

      x = value
      if (axis%logarithmic) x = log10(value)
      position = axis%from + (axis%to - axis%from)*((x - axis%first)/(axis%last - axis%first))
   end function position

   !> Whether a value can be shown and lies between the ends.
   elemental logical function is_inside(axis, value)
      !> With its range
      type(axis_type), intent(in) :: axis
      !> Any, NaN included
      real(dp), intent(in) :: value
      real(dp) :: x

      is_inside = is_shown(axis, value)
      if (.not. is_inside) return
      x = value
      if (axis%logarithmic) x = log10(value)
      is_inside = x >= axis%first .and. x <= axis%last
   end function is_inside

   !> Ticks in steps of 1, 2 or 5 times a power of ten; of a logarithmic axis decades, and the
   !> lines between them.
   pure subroutine find_ticks(axis, spacing, tick)
      !> With its range
      type(axis_type), intent(in) :: axis
      !> Pixels that a label takes along the axis, > 0
      real(dp), intent(in) :: spacing
      !> Ascending
      type(tick_type), allocatable, intent(out) :: tick(:)
      real(dp) :: step, high
      integer(int64) :: k, first
      integer :: digits

      if (axis%logarithmic) then
         call find_decades(axis, spacing, tick)
         return
      end if
      step = round_step((axis%last - axis%first)/max(2.0_dp, abs(axis%to - axis%from)/spacing))
      first = ceiling(axis%first/step, int64)
      high = max(abs(axis%first), abs(axis%last))
      digits = max(1, min(15, 1 + floor(log10(high/step) + 0.7_dp)))
      if (high < 1.0e6_dp) digits = max(digits, 1 + floor(log10(high)))
      allocate (tick(max(0_int64, floor(axis%last/step, int64) - first + 1)))
      do k = 1, size(tick, kind=int64)
         tick(k)%value = step*real(first + k - 1, dp)
         tick(k)%label = number(tick(k)%value, digits)
      end do
   end subroutine find_ticks

   !> Decades of a logarithmic axis with 2 to 9 times each where these are not too many.
   pure subroutine find_decades(axis, spacing, tick)
      type(axis_type), intent(in) :: axis
      real(dp), intent(in) :: spacing
      type(tick_type), allocatable, intent(out) :: tick(:)
      type(tick_type), allocatable :: all_ticks(:)
      real(dp) :: decades, value
      integer :: decade, k, n, every, digits
      logical :: few, labeled

      decades = axis%last - axis%first
      every = max(1, ceiling(spacing*decades/abs(axis%to - axis%from)))
      few = decades < 2.0_dp
      n = 0
      allocate (all_ticks(9*(floor(axis%last) - floor(axis%first) + 1)))
      do decade = floor(axis%first), floor(axis%last)
         do k = 1, merge(9, 1, decades < 8.0_dp)
            value = real(k, dp)*10.0_dp**decade
            if (.not. is_inside(axis, value)) cycle
            n = n + 1
            all_ticks(n)%value = value
            labeled = few .and. (k == 2 .or. k == 5)
            if (k == 1) labeled = modulo(decade, every) == 0
            digits = merge(6, 1, value >= 1.0_dp .and. value < 99999.0_dp)
            if (labeled) all_ticks(n)%label = number(value, digits)
         end do
      end do
      allocate (tick(n), source=all_ticks(:n))
   end subroutine find_decades

   !> The next larger one of 1, 2, 5 times a power of ten.
   pure real(dp) function round_step(step)
      real(dp), intent(in) :: step
      real(dp) :: decade

      decade = 10.0_dp**floor(log10(step))
      round_step = 10.0_dp*decade
      if (step <= 5.0_dp*decade) round_step = 5.0_dp*decade
      if (step <= 2.0_dp*decade) round_step = 2.0_dp*decade
      if (step <= decade) round_step = decade
   end function round_step

end module gyroakf_report_axis
