! SPDX-License-Identifier: MIT
!> The filters of a channel against its true drift, where that is known: of a simulation, of a reference sensor.
!>
!>     call take_truth(truth, record, channel, result%truth, error)       ! once, in the unit of the record
!>     call reduce_truth(result)                                         ! less the trend and the mean that the filters do not see
!>     call score_output("kf", x, interval, result%truth, error, valid)  ! after each filter
!>
!> A filter estimates the drift of the series that it is given, from which the trend and the mean were removed; they are part of the
!> drift. Taken off the truth too, they leave the error the same.
module gyroakf_pipeline_truth
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type
   use gyroakf_units, only : quantity, unit_type
   use gyroakf_preprocess_trend, only : subtract_trend
   use gyroakf_filter_score, only : score_estimate
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_pipeline_truth_result, only : most_methods, truth_result_type
   implicit none (type, external)
   private
   public :: check_truth, take_truth, reduce_truth, restore_truth, score_output

   !> Relative difference of two rates that are the same
   real(dp), parameter :: same_rate = 1.0e-6_dp

contains

   !> Whether a truth fits a record: samples, channels, rate, kinds of units.
   subroutine check_truth(truth, record, error)
      !> The true drift, as a record
      type(record_type), intent(in) :: truth
      !> What is filtered
      type(record_type), intent(in) :: record
      !> invalid_argument, with what differs
      type(error_type), allocatable, intent(out) :: error
      character(160) :: text
      integer :: c

      if (.not. allocated(truth%value)) then
         call fatal_error(error, status%invalid_argument, "the true drift is empty")
         return
      end if
      if (size(truth%value, 1, kind=int64) /= size(record%value, 1, kind=int64)) then
         write (text, '("the true drift has ", i0, " samples, the record ", i0, ": they must be on one grid")') &
            size(truth%value, 1, kind=int64), size(record%value, 1, kind=int64)
         call fatal_error(error, status%invalid_argument, trim(text))
         return
      else if (size(truth%value, 2) /= size(record%value, 2)) then
         write (text, '("the true drift has ", i0, " channels, the record ", i0)') size(truth%value, 2), size(record%value, 2)
         call fatal_error(error, status%invalid_argument, trim(text))
         return
      else if (truth%rate_known .and. record%rate_known) then
         if (abs(truth%sample_interval - record%sample_interval) > same_rate*record%sample_interval) then
            write (text, '("the true drift has ", g0.7, " samples a second, the record ", g0.7)') &
               1.0_dp/truth%sample_interval, 1.0_dp/record%sample_interval
            call fatal_error(error, status%invalid_argument, trim(text))
            return
         end if
      end if
      do c = 1, size(record%value, 2)
         call check_units(unit_of(truth, c), unit_of(record, c), error)
         if (allocated(error)) return
      end do
   end subroutine check_truth

   !> Refuses units of different quantities; an unknown unit is that of the other.
   subroutine check_units(truth, record, error)
      type(unit_type), intent(in) :: truth, record
      type(error_type), allocatable, intent(out) :: error

      if (truth%quantity == quantity%unknown .or. record%quantity == truth%quantity) return
      if (record%quantity == quantity%unknown) then
         call fatal_error(error, status%invalid_argument, "the true drift is in "//truth%name// &
                          ", and the unit of the record is not known: give it")
      else
         call fatal_error(error, status%invalid_argument, "the true drift is in "//truth%name//", the record in "//record%name)
      end if
   end subroutine check_units

   !> The truth of one channel, in the unit of the record.
   subroutine take_truth(truth, record, channel, result, error)
      !> Checked
      type(record_type), intent(in) :: truth
      type(record_type), intent(in) :: record
      !> Number of the channel
      integer, intent(in) :: channel
      !> Its drift is set
      type(truth_result_type), intent(out) :: result
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      type(unit_type) :: from, to
      real(dp) :: factor
      integer :: failed

      allocate (result%drift(size(truth%value, 1, kind=int64)), stat=failed)
      if (failed == 0 .and. allocated(truth%present)) then
         allocate (result%present, source=truth%present(:, channel), stat=failed)
      end if
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the true drift")
         return
      end if
      from = unit_of(truth, channel)
      to = unit_of(record, channel)
      factor = 1.0_dp
      if (from%quantity /= quantity%unknown) factor = from%to_si/to%to_si
      result%drift(:) = factor*truth%value(:, channel)
      if (record%rate_known) call set_angle(to, result)
      result%known = .true.
   end subroutine take_truth

   !> What the errors of the angle are told in.
   pure subroutine set_angle(unit, result)
      !> Of the record, whose rate is known
      type(unit_type), intent(in) :: unit
      type(truth_result_type), intent(inout) :: result
      real(dp), parameter :: degrees = 57.295779513082320877_dp

      result%angle_unit = "input*s"
      if (unit%quantity == quantity%angular_rate) then
         result%angle_unit = "deg"
         result%angle_factor = degrees*unit%to_si
      else if (unit%quantity == quantity%acceleration) then
         result%angle_unit = "m/s"
         result%angle_factor = unit%to_si
      end if
   end subroutine set_angle

   !> Unit of a channel.
   pure type(unit_type) function unit_of(record, channel)
      type(record_type), intent(in) :: record
      integer, intent(in) :: channel

      unit_of = record%unit
      if (allocated(record%channel_unit)) unit_of = record%channel_unit(channel)
   end function unit_of

   !> Takes off the truth what was removed from the series before the filters.
   subroutine reduce_truth(mean, channel)
      !> What was subtracted behind the trend
      real(dp), intent(in) :: mean
      !> Its truth changes
      type(channel_result_type), intent(inout) :: channel
      integer(int64), parameter :: stretch = 4096
      integer(int64) :: from, to

      if (.not. channel%truth%known) return
      if (channel%available%preprocess .and. channel%clean%trend%degree >= 0) then
         do from = 1, size(channel%truth%drift, kind=int64), stretch
            to = min(from + stretch - 1, size(channel%truth%drift, kind=int64))
            call subtract_trend(channel%clean%trend, from - 1, channel%truth%drift(from:to))
         end do
      end if
      if (abs(mean) > 0.0_dp) channel%truth%drift(:) = channel%truth%drift - mean
      channel%truth%mean = mean
      channel%truth%reduced = .true.
   end subroutine reduce_truth

   !> Puts back what [[reduce_truth]] took, and takes off the mean of another series: the drift's filters see the trend.
   subroutine restore_truth(level, channel)
      !> Mean of the series that is filtered now
      real(dp), intent(in) :: level
      !> Its truth changes
      type(channel_result_type), intent(inout) :: channel
      integer(int64), parameter :: stretch = 4096
      integer(int64) :: from, to

      if (.not. channel%truth%known) return
      if (channel%truth%reduced .and. channel%available%preprocess .and. channel%clean%trend%degree >= 0) then
         channel%truth%drift(:) = -channel%truth%drift                ! -(-d - t) = d + t
         do from = 1, size(channel%truth%drift, kind=int64), stretch
            to = min(from + stretch - 1, size(channel%truth%drift, kind=int64))
            call subtract_trend(channel%clean%trend, from - 1, channel%truth%drift(from:to))
         end do
         channel%truth%drift(:) = -channel%truth%drift
      end if
      channel%truth%drift(:) = channel%truth%drift + (channel%truth%mean - level)
      channel%truth%reduced = .false.
      channel%truth%mean = 0.0_dp
   end subroutine restore_truth

   !> Scores the output of a filter; nothing happens where the truth is not known.
   subroutine score_output(name, x, sample_interval, truth, error, valid, decay, offline)
      !> As in the JSON document
      character(*), intent(in) :: name
      !> Its estimate of the drift of the series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> s
      real(dp), intent(in) :: sample_interval
      !> Gets a method more
      type(truth_result_type), intent(inout) :: truth
      !> no_memory; a truth without a present sample is no error, it scores nothing
      type(error_type), allocatable, intent(out) :: error
      !> 1 where a sample was measured: [n]; only they count, or all that are known where it is absent
      integer(int8), intent(in), optional :: valid(:)
      !> phi by which the estimate is carried on, 1 if absent
      real(dp), intent(in), optional :: decay
      !> It uses later samples
      logical, intent(in), optional :: offline
      integer(int8), allocatable :: counts(:)
      integer :: failed

      if (.not. truth%known .or. truth%count == most_methods) return
      associate (next => truth%method(truth%count + 1))
         next%name = name
         if (present(offline)) next%offline = offline
         if (present(decay)) next%decay = decay
         if (allocated(truth%present) .and. present(valid)) then
            allocate (counts(size(x, kind=int64)), stat=failed)
            if (failed /= 0) then
               call fatal_error(error, status%no_memory, "no memory for the marks of the true drift")
               return
            end if
            counts(:) = truth%present*valid
            call score_estimate(x, truth%drift, sample_interval, next%score, error, counts, next%decay)
         else if (allocated(truth%present)) then
            call score_estimate(x, truth%drift, sample_interval, next%score, error, truth%present, next%decay)
         else if (present(valid)) then
            call score_estimate(x, truth%drift, sample_interval, next%score, error, valid, next%decay)
         else
            call score_estimate(x, truth%drift, sample_interval, next%score, error, decay=next%decay)
         end if
      end associate
      if (allocated(error)) deallocate (error)
      associate (score => truth%method(truth%count + 1)%score)
         score%attitude_error(:) = truth%angle_factor*score%attitude_error
         score%predicted_error(:) = truth%angle_factor*score%predicted_error
      end associate
      if (truth%method(truth%count + 1)%score%samples > 0) truth%count = truth%count + 1
   end subroutine score_output

end module gyroakf_pipeline_truth
