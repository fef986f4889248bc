! SPDX-License-Identifier: MIT
!> Filters put away and taken up again.
module test_filter_saving
   use expectations, only : failed => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, filter_type, freeze_filter, new_filter, run_filter
   use gyroakf_filter_design, only : design_drift_akf, drift_options
   use gyroakf_filter_drift_identification, only : drift_identification_type
   use gyroakf_filter_checksum, only : checksum
   use gyroakf_filter_saving, only : reset_filter, restore_filter, save_filter
   use filter_library, only : fill_noise
   implicit none (type, external)
   private
   public :: suite_filter_saving

   !> Kinds of filters: make_kind
   integer, parameter :: kinds = 7

contains

   subroutine suite_filter_saving()
      call test("continues", test_continues)
      call test("reset", test_reset)
      call test("short-record", test_short_record)
      call test("damaged", test_damaged)
      call test("refused", test_refused)
   end subroutine suite_filter_saving

   !> Fixed and adaptive AR(p) filters, drift filters of one to three processes.
   subroutine make_kind(kind, filter)
      integer, intent(in) :: kind
      class(filter_type), allocatable, intent(out) :: filter
      type(filter_type) :: of_series
      type(drift_filter_type) :: of_drift
      type(filter_options) :: options
      type(component_model_type) :: model

      if (kind > 1) options%estimate_measurement_variance = .true.
      if (kind > 1) options%huber = 2.5_dp
      if (kind > 4) options%burn_in = -1
      if (kind > 5) options%burn_in = -huge(1) - 1
      select case (kind)
      case (1); call new_filter(of_series, [0.9_dp], 1.0_dp, 2.0_dp, options, failed)
      case (2)
         options%estimate_process_variance = .true.
         options%estimate_process_mean = .true.
         call new_filter(of_series, [0.9_dp], 1.0_dp, 2.0_dp, options, failed)
      case (3); call new_filter(of_series, [0.5_dp, 0.3_dp, -0.2_dp], 1.0_dp, 2.0_dp, options, failed)
      case (4); call new_filter(of_series, [real(dp) ::], 1.0_dp, 2.0_dp, options, failed)
      case default
         model = component_model_type(kind - 4, [0.98_dp, 1.0_dp, 0.0_dp], [0.01_dp, 1.0e-3_dp, 0.0_dp], 1.0_dp)
         if (kind == 7) model%phi(2:) = [0.5_dp, 1.0_dp]
         if (kind == 7) model%q(2:) = [0.2_dp, 1.0e-3_dp]
         call new_drift_filter(of_drift, model, spread(.true., 1, kind - 4), options, failed)
      end select
      if (allocated(failed)) error stop failed%code
      if (kind < 5) allocate (filter, source=of_series)
      if (kind >= 5) allocate (filter, source=of_drift)
   end subroutine make_kind

   !> Saved after so many samples, before the first one too: the rest is the same to the last bit.
   subroutine test_continues()
      class(filter_type), allocatable :: filter, other
      integer, parameter :: moments(5) = [0, 1, 17, 300, 2500]
      integer(int64), allocatable :: word(:), again(:)
      real(dp) :: z(3000), x(3000), y(3000)
      integer :: kind, k, m

      call fill_noise(11, z)
      z(200:210) = 9.0_dp                             ! gated, then a shift of the level
      do kind = 1, kinds
         do k = 1, size(moments)
            m = moments(k)
            call make_kind(kind, filter)
            call run_filter(filter, z(:m), x(:m))
            call freeze_filter(filter, m == 300)
            call save_filter(filter, word, failed)
            if (went_wrong(failed)) return
            call check(error, size(word), merge(67 + kind, 42 + filter%order*(filter%order + 4), kind > 4), "words")
            call restore_filter(word, other, failed)
            if (went_wrong(failed)) return
            call run_filter(filter, z(m + 1:), x(m + 1:))
            call run_filter(other, z(m + 1:), y(m + 1:))
            call check(error, all(transfer(x(m + 1:), word) == transfer(y(m + 1:), word)))
            call save_filter(filter, word, failed)
            call save_filter(other, again, failed)
            call check(error, all(word == again), "another state at the end")
         end do
      end do
   end subroutine test_continues

   !> As it was made.
   subroutine test_reset()
      class(filter_type), allocatable :: filter
      real(dp) :: z(1000), x(1000), y(1000)
      integer(int64), allocatable :: word(:), again(:)
      integer :: kind

      call fill_noise(12, z)
      do kind = 1, kinds
         call make_kind(kind, filter)
         call save_filter(filter, word, failed)
         call run_filter(filter, z, x)
         call freeze_filter(filter, .true.)
         call reset_filter(filter, failed)
         if (went_wrong(failed)) return
         call save_filter(filter, again, failed)
         call check(error, all(word == again))
         call run_filter(filter, z, y)
         call check(error, all(transfer(x, word) == transfer(y, word)))
      end do
   end subroutine test_reset

   !> The burn-in that the length of a record has shortened is part of the making.
   subroutine test_short_record()
      type(drift_filter_type) :: filter
      class(filter_type), allocatable :: other
      type(drift_identification_type) :: drift
      integer(int64), allocatable :: word(:)
      real(dp) :: z(100), x(100), y(100)

      drift%found = .true.
      drift%of_samples = 100
      drift%model%count = 1
      drift%model%phi(1) = 0.98_dp
      drift%model%q(1) = 4.0e-6_dp
      drift%model%r = 4.2e-4_dp
      drift%slow(1) = .true.
      call design_drift_akf(drift, 8.0e-4_dp, drift_options(), filter, failed)
      if (went_wrong(failed)) return
      call save_filter(filter, word, failed)
      call restore_filter(word, other, failed)
      call reset_filter(other, failed)
      if (went_wrong(failed)) return
      call check(error, other%wait, 10)
      call fill_noise(13, z)
      call run_filter(filter, z, x)
      call run_filter(other, z, y)
      call check(error, all(transfer(x, word) == transfer(y, word)))
   end subroutine test_short_record

   !> Every bit of the words counts; words cut short or added too.
   subroutine test_damaged()
      class(filter_type), allocatable :: filter, other
      integer(int64), allocatable :: word(:), bad(:)
      real(dp) :: z(100), x(100)
      integer :: k, bit

      call fill_noise(13, z)
      call make_kind(7, filter)
      call run_filter(filter, z, x)
      call save_filter(filter, word, failed)
      do k = 1, size(word)
         do bit = 0, 63
            bad = word
            bad(k) = ieor(bad(k), shiftl(1_int64, bit))
            call restore_filter(bad, other, failed)
            call check_refused(failed, status%parse)
         end do
         call restore_filter(word(:k - 1), other, failed)
         call check_refused(failed, status%parse)
      end do
      call restore_filter([word, 0_int64], other, failed)
      call check_refused(failed, status%parse)
      bad = word
      bad(6:7) = word([7, 6])
      call restore_filter(bad, other, failed)
      call check_refused(failed, status%parse)
      bad = word
      bad(5) = 0                                      ! as a filter of an AR state
      bad(4) = checksum(bad(5:))
      call restore_filter(bad, other, failed)
      call check_refused(failed, status%parse)
   end subroutine test_damaged

   !> What was never made.
   subroutine test_refused()
      type(filter_type) :: filter
      integer(int64), allocatable :: word(:)

      call save_filter(filter, word, failed)
      call check_refused(failed, status%invalid_argument)
      call reset_filter(filter, failed)
      call check_refused(failed, status%invalid_argument)
   end subroutine test_refused

end module test_filter_saving
