! SPDX-License-Identifier: MIT
!> The error that every procedure that can fail returns in its argument `error`, the last required
!> one.
!>
!>     type(error_type), allocatable :: error
!>     call do_something(x, error)
!>     if (allocated(error)) ...           ! error%code, error%message
!>
!> The codes are part of the C interface (`enum gyroakf_status`): not renumbered, new at the end.
module gyroakf_error
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: error_type, fatal_error, check_memory, check_sample_interval
   public :: status, status_texts, exit_code

   !> What went wrong
   type :: error_type
      !> One of the components of [[gyroakf_error:status]]
      integer :: code = 0
      !> For humans, with the numbers in it; several lines where a place in a file is shown
      character(:), allocatable :: message
   end type error_type

   !> The codes, reached as `status%parse`
   type :: status_enum
      !> Done
      integer :: ok = 0
      !> An argument is out of its documented range
      integer :: invalid_argument = 1
      !> The series is too short for what was asked
      integer :: too_few_samples = 2
      !> A file cannot be opened, read or written
      integer :: io = 3
      !> A file's content cannot be understood
      integer :: parse = 4
      !> The series has no variance
      integer :: constant_input = 5
      !> A matrix is singular or a fit is perfect
      integer :: singular = 6
      !> An iteration did not converge
      integer :: not_converged = 7
      !> A model is not stationary
      integer :: unstable = 8
      !> A value is NaN or infinite where that is not allowed
      integer :: non_finite = 9
      !> Memory could not be allocated, or a size overflows
      integer :: no_memory = 10
      !> A format or a feature that this build does not have
      integer :: not_supported = 11
      !> The caller's callback asked to stop
      integer :: cancelled = 12
      !> A defect of the library found by its self-test: an exit code, returned by no procedure
      integer :: internal = 13
      !> The command line is wrong: the program's. No procedure of the library returns it
      integer :: usage = 14
   end type status_enum

   !> All codes
   type(status_enum), parameter :: status = status_enum()

   !> Their texts, in the order of the numbers
   character(38), parameter :: status_texts(0:14) = [character(38) :: &
      & "ok", &
      & "invalid argument", &
      & "too few samples", &
      & "file cannot be opened, read or written", &
      & "file content not understood", &
      & "series has no variance", &
      & "singular problem", &
      & "iteration did not converge", &
      & "model not stationary", &
      & "value not finite", &
      & "out of memory", &
      & "not supported by this build", &
      & "cancelled by the caller", &
      & "internal error", &
      & "wrong usage"]

contains

   !> Fills the error.
   pure subroutine fatal_error(error, code, message)
      !> The error of the caller, allocated here
      type(error_type), allocatable, intent(out) :: error
      !> One of the components of [[gyroakf_error:status]]
      integer, intent(in) :: code
      !> What is wrong and what to do
      character(*), intent(in) :: message

      allocate (error)
      error%code = code
      error%message = message
   end subroutine fatal_error

   !> The error `no_memory` where an allocation failed.
   pure subroutine check_memory(stat, what, error)
      !> Of the statement `allocate`
      integer, intent(in) :: stat
      !> What the memory is for
      character(*), intent(in) :: what
      !> no_memory; else it stays as it is
      type(error_type), allocatable, intent(inout) :: error

      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for "//what)
   end subroutine check_memory

   !> Refuses a sample interval whose cube or inverse cube is no number: outside 1e-100 .. 1e100 s.
   pure subroutine check_sample_interval(dt, error)
      !> Seconds; NaN is refused
      real(dp), intent(in) :: dt
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      if (ieee_is_finite(dt)) then
         if (dt >= 1e-100_dp .and. dt <= 1e100_dp) return
      end if
      call fatal_error(error, status%invalid_argument, &
         "the sample interval (dt) must lie between 1e-100 and 1e100 s")
   end subroutine check_sample_interval

   !> The exit code of a program that stops with this error: 1 usage, 2 data or file, 3 numerical.
   pure integer function exit_code(code)
      !> A component of [[gyroakf_error:status]]
      integer, intent(in) :: code

      select case (code)
      case (status%ok); exit_code = 0
      case (status%usage); exit_code = 1
      case (status%singular, status%not_converged, status%unstable, status%internal); exit_code = 3
      case default; exit_code = 2
      end select
   end function exit_code

end module gyroakf_error
