! SPDX-License-Identifier: MIT
!> FORTRAN 77: the filter, its state in an array of the caller. The arguments are described in c_api/README.md.
module gyroakf_c_api_legacy_filter
   use, intrinsic :: iso_c_binding, only : c_int, c_int32_t, c_double
   use gyroakf_error, only : error_type
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter
   use gyroakf_filter_packed, only : packed_length, pack_filter, is_packed, step_packed, freeze_packed, packed_numbers
   use gyroakf_c_api_c_support, only : host_type, enter_library, leave_library, begin_step, end_step
   implicit none (type, external)
   private
   public :: gyfini, gyfstp, gyfrun, gyfget, gyffrz

   !> Largest state
   integer, parameter :: largest_order = 1000

contains

   !> CALL GYFINI(IP, PHI, Q, R, IADAPT, B, WORK, LWORK, INFO): begins a filter.
   subroutine gyfini(ip, phi, q, r, iadapt, b, work, lwork, info) bind(C, name="gyfini_")
      integer(c_int32_t), intent(in) :: ip, iadapt(4), lwork
      real(c_double), intent(in) :: phi(*), q, r, b
      real(c_double), intent(inout) :: work(*)
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      type(filter_options) :: options
      type(filter_type) :: filter
      type(error_type), allocatable :: error

      info = 0
      if (ip < 0 .or. ip > largest_order) info = -1
      if (info /= 0) return
      if (lwork == -1) then
         work(1) = real(packed_length(max(1, ip)), c_double)
         return
      end if
      if (lwork < packed_length(max(1, ip))) info = -8
      if (info /= 0) return
      call enter_library(host)
      options%estimate_process_mean = iadapt(1) /= 0
      options%estimate_measurement_mean = iadapt(2) /= 0
      options%allow_unobservable = .true.                  ! who asks for q and r by number means both
      options%estimate_process_variance = iadapt(3) /= 0
      options%estimate_measurement_variance = iadapt(4) /= 0
      options%forgetting = b
      call new_filter(filter, phi(:ip), q, r, options, error)
      if (.not. allocated(error)) call pack_filter(filter, work(:packed_length(filter%order)))
      info = leave_library(host, error)
   end subroutine gyfini

   !> CALL GYFSTP(WORK, Z, X, INFO): one step.
   subroutine gyfstp(work, z, x, info) bind(C, name="gyfstp_")
      real(c_double), intent(inout) :: work(*)
      real(c_double), intent(in) :: z
      real(c_double), intent(out) :: x
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      integer(c_int) :: changed

      info = 0
      changed = begin_step(host%environment)
      if (is_packed(work(:2))) then
         call step_packed(work(:packed_length(nint(work(2)))), z, x)
      else
         info = -1
         x = z
      end if
      if (changed /= 0) call end_step(host%environment)
   end subroutine gyfstp

   !> CALL GYFRUN(WORK, N, Z, X, INFO): N steps; X may be Z.
   subroutine gyfrun(work, n, z, x, info) bind(C, name="gyfrun_")
      real(c_double), intent(inout) :: work(*)
      integer(c_int32_t), intent(in) :: n
      real(c_double), intent(in) :: z(*)
      real(c_double), intent(inout) :: x(*)
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      real(c_double) :: estimate
      integer(c_int) :: changed
      integer(c_int32_t) :: i

      info = 0
      if (n < 0) info = -2
      changed = begin_step(host%environment)
      if (.not. is_packed(work(:2))) info = -1
      if (info == 0) then
         do i = 1, n
            call step_packed(work(:packed_length(nint(work(2)))), z(i), estimate)
            x(i) = estimate
         end do
      end if
      if (changed /= 0) call end_step(host%environment)
   end subroutine gyfrun

   !> CALL GYFGET(WORK, STATE, INFO): what the filter holds after its last step.
   subroutine gyfget(work, state, info) bind(C, name="gyfget_")
      real(c_double), intent(in) :: work(*)
      real(c_double), intent(out) :: state(9)
      integer(c_int32_t), intent(out) :: info

      info = -1
      state = 0
      if (.not. is_packed(work(:2))) return
      info = 0
      call packed_numbers(work(:packed_length(nint(work(2)))), state)
   end subroutine gyfget

   !> CALL GYFFRZ(WORK, IFRZ, INFO): no adaptation from here on (IFRZ not 0), or again (0).
   subroutine gyffrz(work, ifrz, info) bind(C, name="gyffrz_")
      real(c_double), intent(inout) :: work(*)
      integer(c_int32_t), intent(in) :: ifrz
      integer(c_int32_t), intent(out) :: info

      info = -1
      if (.not. is_packed(work(:2))) return
      info = 0
      call freeze_packed(work(:packed_length(nint(work(2)))), ifrz /= 0)
   end subroutine gyffrz

end module gyroakf_c_api_legacy_filter
