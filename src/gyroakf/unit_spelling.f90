! SPDX-License-Identifier: MIT
!> Spellings of units: what somebody wrote becomes the plain form that [[gyroakf_units]] knows.
module gyroakf_unit_spelling
   use gyroakf_spelling, only : lower, replace_all
   implicit none (type, external)
   private
   public :: make_plain, take_meaning

   !> Pairs of what is written and what is meant
   character(12), parameter :: spellings(2, 43) = reshape([character(12) :: "degree", "deg", &
      "degrees", "deg", "degs", "deg", "radian", "rad", "radians", "rad", "rads", "rad", &
      "arcsecond", "arcsec", "arcseconds", "arcsec", "asec", "arcsec", "arcs", "arcsec", '"', &
      "arcsec", "arcminute", "arcmin", "arcminutes", "arcmin", "revolution", "rev", "revolutions", &
      "rev", "turn", "rev", "turns", "rev", "millidegree", "mdeg", "millidegrees", "mdeg", &
      "millirad", "mrad", "microrad", "urad", "dps", "deg/s", "mdps", "mdeg/s", "udps", "udeg/s", &
      "dph", "deg/h", "rps", "rev/s", "rpm", "rev/min", "degps", "deg/s", "degph", "deg/h", &
      "radps", "rad/s", "mradps", "mrad/s", "m/s2", "m/s^2", "m/s/s", "m/s^2", "mps2", "m/s^2", &
      "ms2", "m/s^2", "g-force", "g", "cm/s2", "cm/s^2", "mm/s2", "mm/s^2", "ft/s2", "ft/s^2", &
      "gn", "g", "milli-g", "mg", "micro-g", "ug", "gal", "cm/s^2"], [2, 43])

   !> Signs, in UTF-8 and in Latin-1, and what they become; they are replaced in this order
   character(5), parameter :: signs(2, 13) = reshape([character(5) :: char(194)//char(176), "deg", &
      char(194)//char(186), "deg", char(194)//char(178), "^2", char(194)//char(181), "u", &
      char(206)//char(188), "u", char(194)//char(183), "", char(226)//char(129)//char(187)// &
      char(194)//char(185), "^-1", char(226)//char(129)//char(187)//"^2", "^-2", char(176), "deg", &
      char(178), "^2", char(181), "u", "**", "^", "*", ""], [2, 13])

contains

   !> Lower case, no blanks, brackets or signs beyond ASCII, `/s` for `per s` and `s^-1`.
   pure subroutine make_plain(plain)
      character(:), allocatable, intent(inout) :: plain
      character(*), parameter :: dropped = " _[]()"//achar(9)
      integer :: i

      plain = lower(plain)
      do i = 1, size(signs, 2)
         call replace_all(plain, trim(signs(1, i)), trim(signs(2, i)))
      end do
      do i = 1, len(dropped)
         call replace_all(plain, dropped(i:i), "")
      end do
      call replace_all(plain, "per", "/")
      call invert_power(plain, "-1", "")
      call invert_power(plain, "-2", "^2")
   end subroutine make_plain

   !> `rads^-1` and `rads-1` become `rad/s`.
   pure subroutine invert_power(text, power, positive)
      character(:), allocatable, intent(inout) :: text
      character(*), intent(in) :: power, positive
      integer :: n

      n = len(text) - len(power)
      if (n < 2) return
      if (text(n + 1:) /= power) return
      if (text(n:n) == "^") n = n - 1
      if (n < 2) return
      if (index("sh", text(n:n)) > 0) text = text(:n - 1)//"/"//text(n:n)//positive
   end subroutine invert_power

   !> Takes what a text means where it is one of the spellings.
   pure subroutine take_meaning(text)
      !> In plain form
      character(:), allocatable, intent(inout) :: text
      integer :: at

      at = findloc(spellings(1, :) == text, .true., dim=1)
      if (at > 0) text = trim(spellings(2, at))
   end subroutine take_meaning

end module gyroakf_unit_spelling
