! SPDX-License-Identifier: MIT
!> The Allan deviation in characters: where its points are, what the axes say, and records that hardly have a curve.
module test_chart
   use expectations, only : unmet, test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : text_type
   use gyroakf_report_chart, only : chart_columns, chart_rows, draw_chart
   use gyroakf_utf8, only : text_width
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   implicit none (type, external)
   private
   public :: suite_chart

   !> Characters before the area
   integer, parameter :: margin = 12

contains

   subroutine suite_chart()
      call test("places", test_places)
      call test("model", test_model)
      call test("limits", test_limits)
      call test("slopes", test_slopes)
      call test("axes", test_axes)
      call test("one-point", test_one)
      call test("equal", test_equal)
      call test("not-drawn", test_not_drawn)
      call test("nothing", test_nothing)
      call test("unicode", test_unicode)
      call test("extremes", test_extremes)
   end subroutine suite_chart

   !> The character at a place of the area, from 1; blank behind the end of a line.
   character(1) function at(lines, column, row)
      type(text_type), intent(in) :: lines(:)
      integer, intent(in) :: column, row

      at = " "
      if (len(lines(row)%text) >= margin + column) at = lines(row)%text(margin + column:margin + column)
   end function at

   !> How often a character is in the area.
   integer function how_often(lines, sign)
      type(text_type), intent(in) :: lines(:)
      character(1), intent(in) :: sign
      integer :: column, row

      how_often = 0
      do row = 1, chart_rows
         do column = 1, chart_columns
            if (at(lines, column, row) == sign) how_often = how_often + 1
         end do
      end do
   end function how_often

   !> Four decades of time and two of the deviation, slope -1/2: the points are on a straight line. The height is 2.1 decades with
   !> its margins; 0.05 of them, 1.5 of 63 dots, above the first point: dot 2, the first row.
   subroutine test_places()
      real(dp), parameter :: tau(5) = [1.0_dp, 10.0_dp, 100.0_dp, 1000.0_dp, 10000.0_dp]
      type(text_type), allocatable :: lines(:)
      integer :: i, row

      call draw_chart(tau, tau**(-0.5_dp), 0.99_dp*tau**(-0.5_dp), 1.01_dp*tau**(-0.5_dp), .false., lines)
      if (unmet(size(lines), chart_rows + 2)) return
      call check(error, how_often(lines, "o"), 5)
      do i = 0, 4
         if (allocated(error)) return
         row = 1 + nint(63.0_dp*(0.05_dp + 0.5_dp*real(i, dp))/2.1_dp)/4
         call check(error, at(lines, 1 + nint(123.0_dp*real(i, dp)/4.0_dp)/2, row), "o")
      end do
   end subroutine test_places

   !> A model through the points is drawn in every column between them, never above or below its neighbors' rows.
   subroutine test_model()
      real(dp), parameter :: tau(3) = [1.0_dp, 10.0_dp, 1000.0_dp]
      type(text_type), allocatable :: lines(:)
      integer :: column, row, expected

      call draw_chart(tau, [1.0_dp, 0.1_dp, 0.001_dp], [1.0_dp, 0.1_dp, 0.001_dp], [1.0_dp, 0.1_dp, 0.001_dp], .false., lines, &
                      model=[1.0_dp, 0.1_dp, 0.001_dp])
      do column = 2, chart_columns - 1
         expected = 1 + nint(63.0_dp*(0.05_dp + 3.0_dp*(real(column, dp) - 0.5_dp)/real(chart_columns, dp))/3.1_dp)/4
         do row = 1, chart_rows
            if (scan(at(lines, column, row), ".o") > 0 .and. abs(row - expected) <= 1) exit
         end do
         call check(error, row <= chart_rows, "no model in a column")
      end do
      call draw_chart(tau, tau, tau, tau, .false., lines, model=[1.0e-9_dp, 1.0e-9_dp, 1.0e-9_dp])
      call check(error, count([(scan(lines(row)%text, "."), row=1, chart_rows)] > 0) <= 7, "a model outside is not drawn")
   end subroutine test_model

   !> The limits are a bar through their point, cut at the borders.
   subroutine test_limits()
      type(text_type), allocatable :: lines(:)
      integer :: row

      call draw_chart([1.0_dp, 10.0_dp], [1.0_dp, 1.0_dp], [1.0_dp, 0.1_dp], [1.0_dp, 100.0_dp], .false., lines)
      do row = 1, chart_rows
         call check(error, scan(at(lines, chart_columns, row), "|o") > 0)
      end do
      call check(error, how_often(lines, "o") == 2 .and. at(lines, 1, chart_rows/2 + 1) == "o")
   end subroutine test_limits

   !> The three slopes stand in a corner that is free: +1/2 above 0 above -1/2. Where none is free they are left out.
   subroutine test_slopes()
      real(dp), parameter :: tau(5) = [1.0_dp, 10.0_dp, 100.0_dp, 1000.0_dp, 10000.0_dp]
      real(dp) :: crowded(0:199), level(0:199)
      type(text_type), allocatable :: lines(:)
      integer :: i, place(3)
      character(4), parameter :: names(3) = ["+1/2", " 0  ", "-1/2"]

      call draw_chart(tau, 1/sqrt(tau), 1/sqrt(tau), 1/sqrt(tau), .false., lines)
      do i = 1, chart_rows
         if (index(lines(i)%text, "+1/2") > 0) place(1) = i
         if (index(lines(i)%text, "0", back=.true.) > 60) place(2) = i
         if (index(lines(i)%text, "-1/2") > 0) place(3) = i
      end do
      call check(error, place(1) < place(2) .and. place(2) < place(3), names(1))
      call check(error, index(lines(place(1))%text, "+1/2") == index(lines(place(3))%text, "-1/2"))
      do i = 0, 199
         crowded(i) = 10.0_dp**(real(i, dp)/50)
         level(i) = 10.0_dp**(2*modulo(real(i, dp)*0.618_dp, 1.0_dp))
      end do
      call draw_chart(crowded, level, level, level, .false., lines)
      do i = 1, chart_rows
         call check(error, index(lines(i)%text, "1/2"), 0)
      end do
   end subroutine test_slopes

   !> Ticks at the decades, with 2 and 5 between them where an axis has no two decades.
   subroutine test_axes()
      real(dp), parameter :: tau(3) = [1.0_dp, 10.0_dp, 100.0_dp]
      type(text_type), allocatable :: lines(:)
      integer :: i

      call draw_chart(tau, 0.03_dp*[1.0_dp, 1.1_dp, 1.2_dp], tau, tau, .false., lines)
      call check(error, lines(chart_rows + 2)%text, repeat(" ", margin)//"1"//repeat(" ", 29)//"10"//repeat(" ", 27)//"100")
      call check(error, index(lines(chart_rows + 1)%text, "           ++---") == 1 .and. &
                 count([(lines(chart_rows + 1)%text(i:i) == "+", i=1, len(lines(chart_rows + 1)%text))]) == 4)
      do i = 1, chart_rows
         if (index(lines(i)%text, " 0.02 +") > 0) exit
      end do
      call check(error, i <= chart_rows, "no tick at 0.02")
   end subroutine test_axes

   subroutine test_one()
      type(text_type), allocatable :: lines(:)

      call draw_chart([0.2_dp], [0.01_dp], [0.009_dp], [0.011_dp], .false., lines, model=[0.01_dp])
      call check(error, size(lines) == chart_rows + 2 .and. how_often(lines, "o") == 1)
   end subroutine test_one

   !> Equal deviations are a level line in the middle.
   subroutine test_equal()
      type(text_type), allocatable :: lines(:)
      real(dp), parameter :: tau(3) = [1.0_dp, 2.0_dp, 4.0_dp], one(3) = 1.0_dp

      call draw_chart(tau, one, one, one, .false., lines)
      call check(error, scan(lines(chart_rows/2 + 1)%text, "o") > 0 .and. how_often(lines, "o") == 3)
   end subroutine test_equal

   !> Zero, negative, missing: the others are drawn as if alone.
   subroutine test_not_drawn()
      type(text_type), allocatable :: lines(:), alone(:)
      real(dp) :: nan
      integer :: i

      nan = ieee_value(nan, ieee_quiet_nan)
      call draw_chart([0.0_dp, 1.0_dp, 2.0_dp, 100.0_dp, 200.0_dp], [1.0_dp, 3.0_dp, nan, 0.5_dp, 0.0_dp], &
                      [1.0_dp, nan, nan, 0.0_dp, 0.0_dp], [1.0_dp, nan, nan, 0.6_dp, 0.0_dp], .false., lines, &
                      model=[nan, 3.0_dp, nan, 0.5_dp, nan])
      call draw_chart([1.0_dp, 100.0_dp], [3.0_dp, 0.5_dp], [nan, nan], [nan, nan], .false., alone)
      call check(error, size(lines), size(alone))
      do i = 1, size(alone)
         if (allocated(error)) return
         call check(error, lines(i)%text, alone(i)%text)
      end do
   end subroutine test_not_drawn

   subroutine test_nothing()
      type(text_type), allocatable :: lines(:)
      real(dp) :: none(0)

      call draw_chart(none, none, none, none, .false., lines)
      if (unmet(size(lines), 0)) return
      call draw_chart([1.0_dp], [0.0_dp], [0.0_dp], [0.0_dp], .true., lines)
      call check(error, size(lines), 0)
   end subroutine test_nothing

   !> The same picture in both: as wide, dots where ASCII has a dot. ASCII has no byte beyond 127.
   subroutine test_unicode()
      real(dp), parameter :: tau(4) = [1.0_dp, 4.0_dp, 16.0_dp, 64.0_dp]
      type(text_type), allocatable :: lines(:), plain(:)
      integer :: i, j

      call draw_chart(tau, 1/tau, 0.9_dp/tau, 1.3_dp/tau, .true., lines, model=1/tau)
      call draw_chart(tau, 1/tau, 0.9_dp/tau, 1.3_dp/tau, .false., plain, model=1/tau)
      do i = 1, size(lines)
         call check(error, text_width(lines(i)%text), len(plain(i)%text))
         do j = 1, len(plain(i)%text)
            call check(error, iachar(plain(i)%text(j:j)) < 128)
         end do
      end do
      call check(error, index(lines(chart_rows + 1)%text, "└") > 0 .and. index(lines(1)%text, " 1 ┤o") > 0, lines(1)%text)
   end subroutine test_unicode

   !> The smallest and the largest numbers that are shown.
   subroutine test_extremes()
      type(text_type), allocatable :: lines(:)
      real(dp), parameter :: small = 1.0e-289_dp, large = 1.0e289_dp
      integer :: i

      call draw_chart([small, large], [large, small], [large, small], [large, large], .false., lines, model=[large, small])
      call check(error, how_often(lines, "o"), 2)
      do i = 1, size(lines)
         if (allocated(error)) return
         call check(error, len(lines(i)%text) <= margin + chart_columns)
      end do
   end subroutine test_extremes

end module test_chart
