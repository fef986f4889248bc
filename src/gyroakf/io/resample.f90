! SPDX-License-Identifier: MIT
!> Samples are put on the even grid by their time stamps, where the user asked for it.
!>
!> `nearest` moves each sample to the slot of the grid that is nearest to its stamp; no value
!> changes. `linear` interpolates between the two samples around each instant of the grid. That
!> averages: with \(w\) the phase of the instant between its neighbors, white noise keeps
!> \(f = \overline{w^2 + (1-w)^2}\) of its variance (2/3 where the phases are uniform), neighbors
!> are correlated by \((1-f)/2\), and where the phase drifts slowly the Allan variance of \(m\)
!> samples becomes
!> $$\sigma^2(m\tau_0) = \frac{N^2}{m\tau_0}\left(1 - \frac{3(1-f)}{2m}\right),$$
!> at long times unchanged, at the first one half.
module gyroakf_io_resample
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_shape, only : wrapped
   use gyroakf_record, only : add_text, record_type
   implicit none (type, external)
   private
   public :: resample

   !> Longer intervals than so many steps are not interpolated
   real(dp), parameter :: widest_step = 1.5_dp
   !> Of a step: rounding of stamps
   real(dp), parameter :: rounding = 1.0e-6_dp
   !> Slots for one sample
   integer(int64), parameter :: most_slots = 11

contains

   !> Puts the samples on the grid of the record's interval.
   subroutine resample(t, way, wrap, record, error)
      !> Stamps of the rows, s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> "nearest" or "linear"
      character(*), intent(in) :: way
      !> Where angles begin again, in units of the file, 0: nowhere
      real(dp), intent(in) :: wrap
      !> NaN marks what is missing; `value` becomes that of the slots
      type(record_type), intent(inout) :: record
      !> Allocated on failure: invalid_argument, no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: value(:, :)
      real(dp) :: length, phase, lost
      integer(int64) :: slots
      integer :: failed

      length = (maxval(t) - minval(t))/record%sample_interval
      if (length > real(most_slots*max(size(t, kind=int64), 10000_int64), dp)) then
         call fatal_error(error, status%invalid_argument, "`resample` "//way//" would make "// &
            format_real(length, 4)//" samples of "//integer_text(size(t, kind=int64))// &
            ": the rate of "//format_real(1.0_dp/record%sample_interval, 6)// &
            " Hz does not fit the time stamps")
         return
      end if
      phase = 0.0_dp
      slots = 1 + int((maxval(t) - t(1))/record%sample_interval + rounding, int64)
      if (way == "nearest") then
         phase = usual_phase(t, record%sample_interval)
         slots = 1 + nint(maxval(t)/record%sample_interval - phase, int64) - &
            nint(minval(t)/record%sample_interval - phase, int64)
      end if
      allocate (value(slots, size(record%value, 2)), stat=failed)
      call check_memory(failed, "resampling onto "//integer_text(slots)//" samples", error)
      if (allocated(error)) return
      if (way == "nearest") then
         call place(t, phase, record, value)
      else
         call interpolate(t, wrap, record, value)
      end if
      call move_alloc(value, record%value)
      record%resample = way
      lost = 1.0_dp - record%audit%white_noise
      if (way == "linear" .and. lost >= 1.0e-3_dp) call add_text(record%warnings, &
         "linear interpolation averages neighbors: white noise "// &
         "keeps "//format_real(record%audit%white_noise, 3)//" of its variance (2/3 where the "// &
         "stamps lie anywhere between the instants of the grid) and neighbors are correlated; "// &
         "its Allan variance at m samples is low by about "//format_real(1.5_dp*lost, 2)//"/m, "// &
         "AR models and tests of whiteness see the filter; `resample` nearest changes no value")
   end subroutine resample

   !> Where most stamps lie between two instants of a grid that begins at 0: the circular mean, in
   !> steps from -0.5 to 0.5; that of the first stamp where they lie everywhere.
   pure real(dp) function usual_phase(t, step) result(phase)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: step
      real(dp), parameter :: turn = 6.283185307179586_dp
      real(dp) :: angle, along, across
      integer(int64) :: i

      along = 0.0_dp
      across = 0.0_dp
      do i = 1, size(t, kind=int64)
         angle = (t(i) - t(1))/step
         angle = turn*(angle - anint(angle))
         along = along + cos(angle)
         across = across + sin(angle)
      end do
      phase = 0.0_dp
      if (hypot(along, across) > 0.2_dp*real(size(t), dp)) phase = atan2(across, along)/turn
      phase = phase + t(1)/step
   end function usual_phase

   !> The values of the slots, NaN where there is none; of two in one slot the first stays.
   subroutine place(t, phase, record, value)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: phase
      type(record_type), intent(inout) :: record
      real(dp), intent(out), contiguous :: value(:, :)
      logical, allocatable :: filled(:)
      real(dp) :: rate, shift
      integer(int64) :: i, k, first

      rate = 1.0_dp/record%sample_interval
      first = nint(minval(t)/record%sample_interval - phase, int64)
      allocate (filled(size(value, 1, kind=int64)), source=.false.)
      value(:, :) = ieee_value(1.0_dp, ieee_quiet_nan)
      shift = 0.0_dp
      do i = 1, size(t, kind=int64)
         k = nint(t(i)/record%sample_interval - phase, int64)
         if (filled(k - first + 1)) then
            record%audit%dropped = record%audit%dropped + 1
            cycle
         end if
         filled(k - first + 1) = .true.
         value(k - first + 1, :) = record%value(i, :)
         shift = max(shift, abs(t(i)*rate - phase - real(k, dp)))
      end do
      record%audit%largest_shift = shift*record%sample_interval
      record%audit%empty_slots = count(.not. filled, kind=int64)
   end subroutine place

   !> The values at the instants of the grid; rows whose stamp does not rise are dropped.
   subroutine interpolate(t, wrap, record, value)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: wrap
      type(record_type), intent(inout) :: record
      real(dp), intent(out), contiguous :: value(:, :)
      real(dp) :: step, widest, w, kept
      integer(int64) :: i, before, k, slots
      integer :: j

      step = record%sample_interval
      widest = widest_step*(1.0_dp + rounding)* &
         max(step, 1.0_dp/max(record%audit%stamp_rate, 1.0e-30_dp))
      slots = size(value, 1, kind=int64)
      value(1, :) = record%value(1, :)
      kept = 1.0_dp
      before = 1
      k = 1
      do i = 2, size(t, kind=int64)
         if (t(i) <= t(before)) then
            record%audit%dropped = record%audit%dropped + 1
            cycle
         end if
         do while (k < slots)
            w = ((real(k, dp)*step - (t(before) - t(1))))/(t(i) - t(before))
            if ((w - 1.0_dp)*(t(i) - t(before)) > rounding*step) exit
            k = k + 1
            if (w*(t(i) - t(before)) <= rounding*step) w = 0.0_dp
            if ((1.0_dp - w)*(t(i) - t(before)) <= rounding*step) w = 1.0_dp
            if (w > 0.0_dp .and. w < 1.0_dp .and. t(i) - t(before) > widest) then
               record%audit%empty_slots = record%audit%empty_slots + 1
               value(k, :) = ieee_value(1.0_dp, ieee_quiet_nan)
               cycle
            end if
            kept = kept + w*w + (1.0_dp - w)**2
            do j = 1, size(value, 2)
               value(k, j) = between(record%value(before, j), record%value(i, j), w, wrap)
            end do
         end do
         before = i
      end do
      record%audit%white_noise = kept/real(max(1_int64, slots - record%audit%empty_slots), dp)
   end subroutine interpolate

   !> The value between two samples; NaN where one that it needs is missing.
   pure real(dp) function between(a, b, w, wrap)
      real(dp), intent(in) :: a, b, w, wrap

      if (w <= 0.0_dp) then
         between = a
      else if (w >= 1.0_dp) then
         between = b
      else if (ieee_is_nan(a) .or. ieee_is_nan(b)) then
         between = ieee_value(1.0_dp, ieee_quiet_nan)
      else if (wrap > 0.0_dp) then
         between = a + w*wrapped(b - a, wrap)
      else
         between = (1.0_dp - w)*a + w*b
      end if
   end function between

end module gyroakf_io_resample
