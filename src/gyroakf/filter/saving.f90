! SPDX-License-Identifier: MIT
!> A filter put away and taken up again: it continues as if it had never stopped, to the last bit.
!>
!> What is kept: what the filter was made of (coefficients, variances, options), and what its steps
!> have changed since. What follows from the former (bounds, steady gain) is computed again by
!> [[new_filter]] or [[new_drift_filter]], which test it too. The form is words of 64 bits: eight
!> letters, version, number of words, checksum of the words behind it, whether it is a drift filter,
!> then the numbers as they are in memory. Words of a machine with another order of bytes are
!> refused by the first of them.
module gyroakf_filter_saving
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_filter_checksum, only : checksum
   use gyroakf_filter_creation, only : new_filter
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_filter_types, only : drift_filter_type, filter_type
   implicit none (type, external)
   private
   public :: save_filter, restore_filter, reset_filter

   !> First words: "GYROAKFF", version, words, checksum
   integer(int64), parameter :: first_word = transfer("GYROAKFF", 0_int64), version = 4
   integer, parameter :: header = 4
   !> Largest state: as new_filter
   integer(int64), parameter :: largest_order = 1000

   !> Words on their way to or from a filter
   type :: box_type
      integer(int64), allocatable :: word(:)
      !> Words used so far
      integer(int64) :: at = header
      !> Words are written; else they are read
      logical :: writing = .false.
      !> Something read is no number, or there is not enough of it
      logical :: bad = .false.
   end type box_type

   !> A number, or numbers, to the box or out of it
   interface exchange
      module procedure exchange_real, exchange_reals, exchange_matrix, exchange_integer, &
         exchange_long, exchange_logical, exchange_text
   end interface exchange

contains

   !> The words that a filter is made of.
   subroutine save_filter(filter, word, error)
      !> Made by new_filter or new_drift_filter
      class(filter_type), intent(in) :: filter
      !> Its words: [42 + p (p + 4)], of n processes [71 + n]
      integer(int64), allocatable, intent(out) :: word(:)
      !> invalid_argument (a filter that was never made), no_memory
      type(error_type), allocatable, intent(out) :: error
      class(filter_type), allocatable :: copy
      type(drift_filter_type) :: drift
      type(box_type) :: box
      logical :: of_drift
      integer :: stat

      if (filter%order < 1) then
         call fatal_error(error, status%invalid_argument, &
            "a filter that was never made cannot be saved")
         return
      end if
      box%writing = .true.
      allocate (copy, source=filter, stat=stat)
      if (stat == 0) allocate (box%word(80 + filter%order*(filter%order + 4_int64)), stat=stat)
      call check_memory(stat, "the state of a filter", error)
      if (allocated(error)) return
      of_drift = same_type_as(filter, drift)
      call exchange(box, of_drift)
      call exchange_making(box, copy)
      call exchange_state(box, copy)
      word = box%word(:box%at)
      word(:header) = [first_word, version, box%at, checksum(word(header + 1:))]
   end subroutine save_filter

   !> The filter of some words.
   subroutine restore_filter(word, filter, error)
      !> From save_filter
      integer(int64), intent(in) :: word(:)
      !> The filter, of the type that was saved
      class(filter_type), allocatable, intent(out) :: filter
      !> `parse`: these are no words of a filter, of another version or byte order, cut short, or
      !> damaged; what making a filter can give
      type(error_type), allocatable, intent(out) :: error
      logical :: of_drift
      integer :: stat
      character(100) :: reason
      type(box_type) :: box

      reason = ""
      if (size(word, kind=int64) <= header) then
         reason = "these bytes are too few for the state of a filter"
      else if (word(1) /= first_word) then
         reason = "these bytes are not the state of a filter, or of a machine of another byte order"
      else if (word(2) /= version) then
         reason = "the state of a filter was saved by another version of the library"
      else if (word(3) /= size(word, kind=int64)) then
         reason = "the state of a filter is cut short or has something behind it"
      else if (word(4) /= checksum(word(header + 1:))) then
         reason = "the state of a filter is damaged: its checksum differs"
      end if
      if (reason /= "") then
         call fatal_error(error, status%parse, trim(reason))
         return
      end if
      box%word = word
      of_drift = .false.
      call exchange(box, of_drift)
      if (of_drift) then
         allocate (drift_filter_type :: filter, stat=stat)
      else
         allocate (filter_type :: filter, stat=stat)
      end if
      call check_memory(stat, "a filter", error)
      if (allocated(error)) return
      call exchange_making(box, filter)
      if (.not. box%bad) call reset_filter(filter, error)
      if (.not. (box%bad .or. allocated(error))) call exchange_state(box, filter)
      if (box%bad .or. (box%at /= size(word, kind=int64) .and. .not. allocated(error))) then
         call fatal_error(error, status%parse, "the state of a filter holds what no filter has")
      end if
      if (allocated(error)) deallocate (filter)
   end subroutine restore_filter

   !> The filter as it was when it was made: no step, not frozen.
   subroutine reset_filter(filter, error)
      !> Made by new_filter or new_drift_filter
      class(filter_type), intent(inout) :: filter
      !> invalid_argument (a filter that was never made); no_memory; the filter is then as it was
      type(error_type), allocatable, intent(out) :: error
      type(filter_type) :: fresh
      type(drift_filter_type) :: fresh_drift
      real(dp), allocatable :: p(:, :)

      if (filter%order < 1) then
         call fatal_error(error, status%invalid_argument, &
            "a filter that was never made cannot be reset")
         return
      end if
      select type (filter)
      type is (drift_filter_type)
         call new_drift_filter(fresh_drift, filter%model, filter%slow(:filter%model%count), &
            filter%options, error)
         if (.not. allocated(error)) filter = fresh_drift
      type is (filter_type)
         call new_filter(fresh, filter%phi, filter%asked_q, filter%asked_r, filter%options, error)
         if (allocated(error)) return
         call move_alloc(fresh%p, p)                        ! not copied: it may be large
         filter = fresh
         call move_alloc(p, filter%p)
      end select
   end subroutine reset_filter

   !> What a filter was made of.
   subroutine exchange_making(box, filter)
      type(box_type), intent(inout) :: box
      class(filter_type), intent(inout) :: filter
      integer :: i

      call exchange(box, filter%order)
      if (filter%order < 1 .or. filter%order > largest_order) box%bad = .true.
      if (box%bad) return
      if (.not. box%writing) allocate (filter%phi(filter%order), source=0.0_dp)
      call exchange(box, filter%phi)
      select type (filter)
      type is (filter_type)
         call exchange(box, filter%asked_q)
         call exchange(box, filter%asked_r)
      type is (drift_filter_type)
         call exchange(box, filter%model%count)
         if (filter%model%count < 1 .or. filter%model%count > size(filter%slow) &
            .or. filter%order /= 1) box%bad = .true.
         call exchange(box, filter%model%phi)
         call exchange(box, filter%model%q)
         call exchange(box, filter%model%r)
         do i = 1, size(filter%slow)
            call exchange(box, filter%slow(i))
         end do
      end select
      associate (options => filter%options)
         call exchange(box, options%estimate_process_mean)
         call exchange(box, options%estimate_measurement_mean)
         call exchange(box, options%estimate_process_variance)
         call exchange(box, options%estimate_measurement_variance)
         call exchange(box, options%allow_unobservable)
         call exchange(box, options%forgetting)
         call exchange(box, options%measurement_form)
         call exchange(box, options%burn_in)
         call exchange(box, options%huber)
         call exchange(box, options%r_scale)
         call exchange(box, options%initial_variance)
         call exchange(box, options%q_lower)
         call exchange(box, options%q_upper)
         call exchange(box, options%r_lower)
         call exchange(box, options%r_upper)
      end associate
   end subroutine exchange_making

   !> What its steps change.
   subroutine exchange_state(box, filter)
      type(box_type), intent(inout) :: box
      class(filter_type), intent(inout) :: filter

      call exchange(box, filter%x)
      call exchange(box, filter%p)
      call exchange(box, filter%gain)
      call exchange(box, filter%gain_sum)
      call exchange(box, filter%q)
      call exchange(box, filter%r)
      call exchange(box, filter%q_mean)
      call exchange(box, filter%r_mean)
      call exchange(box, filter%innovation)
      call exchange(box, filter%innovation_variance)
      call exchange(box, filter%frozen)
      call exchange(box, filter%steps)
      call exchange(box, filter%clamped)
      call exchange(box, filter%gated)
      call exchange(box, filter%measurements)
      call exchange(box, filter%q_at_floor)
      call exchange(box, filter%r_at_floor)
      call exchange(box, filter%gain_measurements)
      call exchange(box, filter%wait)
      call exchange(box, filter%weight)
      call exchange(box, filter%weight_updates)
      call exchange(box, filter%run)
      call exchange(box, filter%settled)
      select type (filter)
      type is (drift_filter_type)
         call exchange(box, filter%state%x)
         call exchange(box, filter%state%p)
         call exchange(box, filter%state%gain)
         call exchange(box, filter%state%started)
         if (.not. (filter%state%started .or. filter%state%walk > 0)) box%bad = .true.
      end select
   end subroutine exchange_state

   !> A number of 64 bits.
   subroutine exchange_long(box, value)
      type(box_type), intent(inout) :: box
      integer(int64), intent(inout) :: value

      box%at = box%at + 1
      if (box%writing) then
         box%word(box%at) = value
      else if (box%at > size(box%word, kind=int64)) then
         box%bad = .true.
      else
         value = box%word(box%at)
      end if
   end subroutine exchange_long

   subroutine exchange_real(box, value)
      type(box_type), intent(inout) :: box
      real(dp), intent(inout) :: value
      integer(int64) :: word

      word = transfer(value, word)
      call exchange_long(box, word)
      value = transfer(word, value)
      if (.not. (box%writing .or. ieee_is_finite(value))) then
         box%bad = .true.
         value = 0.0_dp
      end if
   end subroutine exchange_real

   subroutine exchange_reals(box, value)
      type(box_type), intent(inout) :: box
      real(dp), intent(inout) :: value(:)
      integer :: i

      do i = 1, size(value)
         call exchange_real(box, value(i))
      end do
   end subroutine exchange_reals

   subroutine exchange_matrix(box, value)
      type(box_type), intent(inout) :: box
      real(dp), intent(inout) :: value(:, :)
      integer :: i

      do i = 1, size(value, 2)
         call exchange_reals(box, value(:, i))
      end do
   end subroutine exchange_matrix

   subroutine exchange_integer(box, value)
      type(box_type), intent(inout) :: box
      integer, intent(inout) :: value
      integer(int64) :: word

      word = value
      call exchange_long(box, word)
      if (word <= huge(value) .and. word >= -huge(value) - 1_int64) then
         value = int(word)
      else
         box%bad = .true.
      end if
   end subroutine exchange_integer

   subroutine exchange_logical(box, value)
      type(box_type), intent(inout) :: box
      logical, intent(inout) :: value
      integer(int64) :: word

      word = merge(1_int64, 0_int64, value)
      call exchange_long(box, word)
      value = word == 1
      box%bad = box%bad .or. word < 0 .or. word > 1
   end subroutine exchange_logical

   subroutine exchange_text(box, value)
      type(box_type), intent(inout) :: box
      character(8), intent(inout) :: value
      integer(int64) :: word

      word = transfer(value, word)
      call exchange_long(box, word)
      value = transfer(word, value)
   end subroutine exchange_text

end module gyroakf_filter_saving
