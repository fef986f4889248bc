! SPDX-License-Identifier: MIT
!> What the self-test found: a list of checks, each with what was expected, what came out and how far they may be apart.
!>
!>     call begin_group(result, "closed forms")
!>     call add_check(result, "gain of the Kalman filter", 0.25_dp, gain, 1.0e-12_dp)
!>
!> A check whose value could not be computed is a failed one, with the reason.
module gyroakf_selftest_types
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   implicit none (type, external)
   private
   public :: selftest_check_type, selftest_type, begin_group, add_check, add_worst, add_failure, within_tolerance

   !> One comparison
   type :: selftest_check_type
      !> What it belongs to, and what is compared
      character(32) :: group = ""
      character(32) :: name = ""
      !> The value that is right, the one that came out, and how far they may be apart
      real(dp) :: expected = 0.0_dp, got = 0.0_dp, tolerance = 0.0_dp
      !> A value came out; if not, `problem` says why
      logical :: known = .true.
      !> They are no farther apart
      logical :: passed = .false.
      character(160) :: problem = ""
   end type selftest_check_type

   !> All of them
   type :: selftest_type
      !> In the order in which they were made: the first `count`
      type(selftest_check_type), allocatable :: check(:)
      integer :: count = 0
      !> Those that did not pass
      integer :: failed = 0
      !> The group of the next check
      character(32) :: group = ""
   end type selftest_type

contains

   !> Names the group of the checks that follow.
   subroutine begin_group(result, group)
      !> The list
      type(selftest_type), intent(inout) :: result
      !> At most 32 characters
      character(*), intent(in) :: group

      result%group = group
   end subroutine begin_group

   !> Compares two numbers.
   subroutine add_check(result, name, expected, got, tolerance)
      !> The list
      type(selftest_type), intent(inout) :: result
      !> At most 31 characters; 29 keep the table within 80 columns
      character(*), intent(in) :: name
      !> The value that is right, and the one that came out
      real(dp), intent(in) :: expected, got
      !> How far they may be apart, in their unit; 0: they are the same number
      real(dp), intent(in) :: tolerance
      type(selftest_check_type) :: check

      check%group = result%group
      check%name = name
      check%expected = expected
      check%got = got
      check%tolerance = tolerance
      check%passed = within_tolerance(expected, got, tolerance)
      call append(result, check)
   end subroutine add_check

   !> Compares lists of numbers and keeps the pair that is farthest apart, by the tolerance of each.
   subroutine add_worst(result, name, expected, got, tolerance)
      !> The list
      type(selftest_type), intent(inout) :: result
      !> At most 31 characters; 29 keep the table within 80 columns
      character(*), intent(in) :: name
      !> The values that are right: [n], n >= 1
      real(dp), intent(in) :: expected(:)
      !> Those that came out: [n]; another number of them is a failure
      real(dp), intent(in) :: got(:)
      !> Relative to each value that is right
      real(dp), intent(in) :: tolerance
      real(dp) :: excess, largest
      integer :: i, worst

      if (size(got) /= size(expected)) then
         call add_check(result, name//": how many", real(size(expected), dp), real(size(got), dp), 0.0_dp)
         return
      end if
      worst = 1
      largest = -1.0_dp
      do i = 1, size(expected)
         if (.not. ieee_is_finite(got(i))) then
            worst = i
            exit
         end if
         excess = abs(got(i) - expected(i))/max(abs(expected(i)), tiny(excess))
         if (excess <= largest) cycle
         largest = excess
         worst = i
      end do
      call add_check(result, name, expected(worst), got(worst), tolerance*abs(expected(worst)))
   end subroutine add_worst

   !> A value that should have come out, and did not.
   subroutine add_failure(result, name, error)
      !> The list
      type(selftest_type), intent(inout) :: result
      !> At most 31 characters; 29 keep the table within 80 columns
      character(*), intent(in) :: name
      !> Why
      type(error_type), intent(in) :: error
      type(selftest_check_type) :: check

      check%group = result%group
      check%name = name
      check%known = .false.
      check%problem = error%message
      call append(result, check)
   end subroutine add_failure

   !> Whether two numbers are no farther apart; what is not finite is not.
   elemental logical function within_tolerance(expected, got, tolerance)
      !> The value that is right, the one that came out, how far they may be apart
      real(dp), intent(in) :: expected, got, tolerance

      within_tolerance = ieee_is_finite(got)
      if (within_tolerance) within_tolerance = abs(got - expected) <= tolerance
   end function within_tolerance

   !> Puts a check at the end of the list.
   subroutine append(result, check)
      type(selftest_type), intent(inout) :: result
      type(selftest_check_type), intent(in) :: check
      type(selftest_check_type), allocatable :: longer(:)

      if (.not. allocated(result%check)) allocate (result%check(128))
      if (result%count == size(result%check)) then
         allocate (longer(2*result%count))
         longer(:result%count) = result%check
         call move_alloc(longer, result%check)
      end if
      result%count = result%count + 1
      result%check(result%count) = check
      if (.not. check%passed) result%failed = result%failed + 1
   end subroutine append

end module gyroakf_selftest_types
