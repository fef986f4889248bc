! SPDX-License-Identifier: MIT
!> A line on standard error that says how far the work is, and the way by which an interrupt ends
!> it.
!>
!> Drawn at most ten times a second, on a terminal only after a second of work, and taken away at
!> the end. It is drawn with a carriage return and blanks alone, which every terminal understands.
module gyroakf_app_progress_bar
   use, intrinsic :: iso_c_binding, only : c_int
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_progress_text, only : progress_line
   use gyroakf_app_system, only : bar_is_shown, c_isatty, interrupted, write_bytes
   implicit none (type, external)
   private
   public :: bar_type, start_bar, clear_bar

   !> Seconds before the first drawing, and between two of them
   real(dp), parameter :: first_after = 1.0_dp, again_after = 0.1_dp

   !> The bar
   type, extends(progress_type) :: bar_type
      private
      !> Whether it is drawn at all, and at once
      logical :: visible = .false., at_once = .false.
      !> Characters of a line of the terminal, of what is on it
      integer :: width = 80, drawn = 0
      !> Clock: begin of everything, of the stage, last drawing
      integer(int64) :: began = 0, stage_began = 0, last = 0, per_second = 1
      character(80) :: stage = ""
   contains
      procedure :: advance => draw
   end type bar_type

contains

   !> The work begins.
   subroutine start_bar(bar, mode)
      !> Ended by [[clear_bar]]
      type(bar_type), intent(out) :: bar
      !> "auto": where standard error is a terminal, "on", "off"
      character(*), intent(in) :: mode

      call system_clock(bar%began, bar%per_second)
      bar%at_once = mode == "on"
      if (.not. bar%at_once) bar%last = bar%began
      bar%visible = bar%at_once
      if (mode == "auto") bar%visible = c_isatty(2_c_int) == 1
      if (bar%visible) bar%width = terminal_width()
   end subroutine start_bar

   !> COLUMNS, at most 80 (default); one less, so that no terminal begins a new line.
   integer function terminal_width() result(width)
      character(8) :: text
      integer :: stat, columns

      columns = 0
      call get_environment_variable("COLUMNS", text, status=stat)
      if (stat == 0 .and. verify(text, "0123456789 ") == 0) read (text, *, iostat=stat) columns
      width = merge(min(columns, 80), 80, stat == 0 .and. columns > 0) - 1
   end function terminal_width

   !> Draws, where it is time to; an interrupt cancels the work.
   subroutine draw(self, stage, done, total, cancel)
      class(bar_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel
      integer(int64) :: now
      real(dp) :: per_second
      character(:), allocatable :: line

      cancel = interrupted()
      if (.not. self%visible) return
      call system_clock(now)
      if (self%stage /= stage) then
         self%stage = stage
         self%stage_began = now
      end if
      per_second = real(self%per_second, dp)
      if (.not. self%at_once .and. real(now - self%began, dp) < first_after*per_second) return
      if (real(now - self%last, dp) < again_after*per_second) return
      self%last = now
      call bar_is_shown(.true.)
      line = progress_line(trim(stage), done, total, real(now - self%stage_began, dp)/per_second, &
                           self%width)
      call write_bytes(2_c_int, achar(13)//line//repeat(" ", max(0, self%drawn - len(line))))
      self%drawn = len(line)
   end subroutine draw

   !> Takes the bar away: what is written next begins on a free line.
   subroutine clear_bar(bar)
      !> Drawn again by the next call of `advance`
      type(bar_type), intent(inout) :: bar

      if (bar%drawn > 0) call write_bytes(2_c_int, achar(13)//repeat(" ", bar%drawn)//achar(13))
      bar%drawn = 0
      call bar_is_shown(.false.)
   end subroutine clear_bar

end module gyroakf_app_progress_bar
