! SPDX-License-Identifier: MIT
!> The statistics of the Allan family: names, how many terms each has, and their degrees of freedom.
!>
!> | name | statistic | terms of n rates | longest m |
!> |---|---|---|---|
!> | `adev` | Allan, adjacent windows | floor(n/m) - 1 | n/2 |
!> | `oadev` | Allan, overlapping | n - 2m + 1 | n/2 |
!> | `mdev` | modified Allan | n - 3m + 2 | (n + 1)/3 |
!> | `tdev` | time deviation, tau mdev / sqrt 3 | as `mdev` | as `mdev` |
!> | `hdev` | Hadamard, adjacent windows | floor(n/m) - 2 | n/3 |
!> | `ohdev` | Hadamard, overlapping | n - 3m + 1 | n/3 |
!> | `totdev` | total | n - 1 | n/2 |
!>
!> Source: W. J. Riley, D. A. Howe, "Handbook of frequency stability analysis", NIST SP 1065 (2008),
!> section 5.2.
module gyroakf_allan_statistic
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_spelling, only : nearest_word
   use gyroakf_allan_degrees_of_freedom, only : greenhall_edf
   implicit none (type, external)
   private
   public :: statistic_names, check_statistic, longest_factor, term_count, difference_order, &
      & variance_divisor, statistic_edf

   !> All of them
   character(6), parameter :: statistic_names(7) = ["adev  ", "oadev ", "mdev  ", "tdev  ", &
      & "hdev  ", "ohdev ", "totdev"]

contains

   !> Rejects the name of a statistic that there is not.
   subroutine check_statistic(kind, error)
      !> Its name
      character(*), intent(in) :: kind
      !> not_supported, with the known names and the one that may be meant
      type(error_type), allocatable, intent(out) :: error

      character(:), allocatable :: text
      integer :: i, near

      if (any(statistic_names == kind)) return
      text = "deviation kind '"//trim(kind)//"' is not known; there are "
      do i = 1, size(statistic_names)
         if (i > 1) text = text//", "
         text = text//trim(statistic_names(i))
      end do
      near = nearest_word(kind, statistic_names)
      if (near > 0) text = text//"; did you mean "//trim(statistic_names(near))//"?"
      call fatal_error(error, status%not_supported, text)
   end subroutine check_statistic

   !> Longest averaging factor that has a term, 0 if there is none.
   pure integer(int64) function longest_factor(kind, samples)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Rate samples
      integer(int64), intent(in) :: samples

      select case (kind)
      case ("mdev", "tdev")
         longest_factor = (samples + 1)/3
      case ("hdev", "ohdev")
         longest_factor = samples/3
      case default
         longest_factor = samples/2
      end select
   end function longest_factor

   !> Terms of a complete record.
   elemental integer(int64) function term_count(kind, samples, m)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Rate samples
      integer(int64), intent(in) :: samples
      !> Averaging factor, 1 .. longest_factor
      integer(int64), intent(in) :: m

      select case (kind)
      case ("adev")
         term_count = samples/m - 1
      case ("mdev", "tdev")
         term_count = samples - 3*m + 2
      case ("hdev")
         term_count = samples/m - 2
      case ("ohdev")
         term_count = samples - 3*m + 1
      case ("totdev")
         term_count = samples - 1
      case default
         term_count = samples - 2*m + 1
      end select
   end function term_count

   !> Order of the difference of the phase: 3 for the Hadamard variances, else 2.
   pure integer function difference_order(kind)
      !> A known statistic
      character(*), intent(in) :: kind

      difference_order = 2
      if (kind == "hdev" .or. kind == "ohdev") difference_order = 3
   end function difference_order

   !> What the mean square of the differences of the phase (in units of rate times sample) is
   !> divided by.
   elemental real(dp) function variance_divisor(kind, m)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Averaging factor
      integer(int64), intent(in) :: m

      real(dp) :: length

      length = real(m, dp)
      select case (kind)
      case ("mdev", "tdev")
         variance_divisor = 2*length**4
      case ("hdev", "ohdev")
         variance_divisor = 6*length**2
      case default
         variance_divisor = 2*length**2
      end select
   end function variance_divisor

   !> Equivalent degrees of freedom for power-law noise.
   !>
   !> The differences are of [[greenhall_edf]]. Of the total variance
   !> $$ \nu = b T/\tau - c $$
   !> with (b, c) = (1.50, 0), (1.17, 0.22), (0.93, 0.36) for white, flicker and random-walk rate
   !> noise (NIST SP 1065, section 5.4.1); for phase noise it is taken as that of the overlapping
   !> Allan variance. The formula is meant for long averaging times: for independent rates it is
   !> 126 % too large at m = 1 (where the total variance is the overlapping one), 14 % at m = 3,
   !> 1 % at m = 16, and it is kept because published limits rest on it.
   pure real(dp) function statistic_edf(kind, phases, m, alpha) result(edf)
      !> A known statistic
      character(*), intent(in) :: kind
      !> Phase points: one more than rate samples
      integer(int64), intent(in) :: phases
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Noise exponent, 2 .. -4
      integer, intent(in) :: alpha

      real(dp), parameter :: b(-2:0) = [0.93_dp, 1.17_dp, 1.50_dp], &
         & c(-2:0) = [0.36_dp, 0.22_dp, 0.0_dp]
      logical :: modified, overlapping

      modified = kind == "mdev" .or. kind == "tdev"
      overlapping = kind /= "adev" .and. kind /= "hdev"
      if (kind == "totdev" .and. alpha <= 0) then
         edf = b(max(alpha, -2))*real(phases, dp)/real(m, dp) - c(max(alpha, -2))
      else
         edf = greenhall_edf(phases, m, alpha, difference_order(kind), modified, overlapping)
      end if
   end function statistic_edf

end module gyroakf_allan_statistic
