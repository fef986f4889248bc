! SPDX-License-Identifier: MIT
!> How far a call is, as one line for a terminal:
!>
!>     reading  [#########...........]  46 %  312 MB/s  0:12 left
!>     reading  1.23 GB  312 MB/s
!>
!> The second where the whole is not known. Amounts: bytes while reading, files, else samples.
module gyroakf_progress_text
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: progress_line, amount_text, duration_text

   !> Signs of the bar between its brackets
   integer, parameter :: bar_width = 20
   !> Rates and remaining times are said after so many seconds
   real(dp), parameter :: settled = 0.05_dp

contains

   !> The line, at most so wide.
   pure function progress_line(stage, done, total, seconds, width) result(line)
      !> What is being done; ASCII is counted right
      character(*), intent(in) :: stage
      !> So much of `total`
      integer(int64), intent(in) :: done
      !> 0 where it is not known; the stage alone where `done` is 0 too
      integer(int64), intent(in) :: total
      !> Since the stage began
      real(dp), intent(in) :: seconds
      !> Of the terminal, in characters; the bar is left out below 60, the rest is cut
      integer, intent(in) :: width
      character(:), allocatable :: line, unit
      character(60) :: numbers
      real(dp) :: rate, share
      integer :: filled

      unit = "samples"
      if (index(stage, "reading") == 1) unit = "B"
      if (stage == "files") unit = "files"
      line = trim(stage)
      rate = 0.0_dp
      if (seconds >= settled) rate = real(max(done, 0_int64), dp)/seconds
      if (total > 0) then
         share = min(1.0_dp, real(max(done, 0_int64), dp)/real(total, dp))
         filled = int(share*bar_width)
         if (width >= 60) line = line//"  ["//repeat("#", filled)// &
            repeat(".", bar_width - filled)//"]"
         write (numbers, "(2x, i3, ' %  ', i0, ' of ', i0)") int(100.0_dp*share), done, total
         if (unit /= "files") numbers = numbers(:7)
         line = line//trim(numbers)
      else if (done > 0) then
         line = line//"  "//amount_text(real(done, dp), unit)
      end if
      if (rate > 0.0_dp) line = line//"  "//amount_text(rate, unit)//"/s"
      if (rate > 0.0_dp .and. total > 0) line = line//"  "// &
         duration_text(real(max(total - done, 0_int64), dp)/rate)//" left"
      if (len(line) > width) line = line(:max(0, width))
   end function progress_line

   !> 1.23 GB, 45.6 Msamples, 7 files: three digits and the unit.
   pure function amount_text(amount, unit) result(text)
      !> >= 0, finite
      real(dp), intent(in) :: amount
      !> "B", "samples", "files"
      character(*), intent(in) :: unit
      character(:), allocatable :: text
      character(1), parameter :: prefix(0:5) = [" ", "k", "M", "G", "T", "P"]
      character(16) :: digits
      real(dp) :: x
      integer :: i

      x = amount
      do i = 0, ubound(prefix, 1) - 1
         if (x < 999.5_dp .or. unit == "files") exit
         x = x/1000.0_dp
      end do
      if (x >= 99.95_dp .or. abs(x - anint(x)) < 1.0e-9_dp) then
         write (digits, "(i0)") nint(min(x, 1.0e9_dp))
      else if (x >= 9.995_dp) then
         write (digits, "(f5.1)") x
      else
         write (digits, "(f4.2)") x
      end if
      text = trim(adjustl(digits))//" "//trim(prefix(i))//unit
   end function amount_text

   !> 0:07, 12:34, 1:02:03; "> 99 h" where it is longer.
   pure function duration_text(seconds) result(text)
      !> >= 0, finite
      real(dp), intent(in) :: seconds
      character(:), allocatable :: text
      character(16) :: digits
      integer :: whole_seconds

      if (seconds > 99.0_dp*3600.0_dp) then
         text = "> 99 h"
         return
      end if
      whole_seconds = ceiling(seconds)
      if (whole_seconds >= 3600) then
         write (digits, "(i0, ':', i2.2, ':', i2.2)") whole_seconds/3600, &
            mod(whole_seconds/60, 60), mod(whole_seconds, 60)
      else
         write (digits, "(i0, ':', i2.2)") whole_seconds/60, mod(whole_seconds, 60)
      end if
      text = trim(digits)
   end function duration_text

end module gyroakf_progress_text
