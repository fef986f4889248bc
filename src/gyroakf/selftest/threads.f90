! SPDX-License-Identifier: MIT
!> The main job on one thread and on several: the same numbers.
module gyroakf_selftest_threads
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_threads, only : set_thread_count, thread_count
   use gyroakf_pipeline, only : channel_result_type, pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_record, only : record_type
   use gyroakf_simulate_record, only : paper_preset, simulate_options, simulate_record
   use gyroakf_selftest_types, only : selftest_type, begin_group, add_check, add_failure
   implicit none (type, external)
   private
   public :: check_threads

   !> Sums are taken in another order: rounding
   real(dp), parameter :: rounding = 1.0e-12_dp
   !> Rooms of a channel whose numbers are compared
   character(18), parameter :: rooms(5) = [character(18) :: "moments, cleaning", "tests", "AR model", "filters", "Allan analysis"]

contains

   !> Runs the same record twice.
   subroutine check_threads(result)
      !> The checks are added
      type(selftest_type), intent(inout) :: result
      type(simulate_options) :: simulation
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: one, many
      type(error_type), allocatable :: error
      character(40) :: group
      integer :: threads, more

      threads = thread_count()
      more = max(2, threads)
      write (group, '("1 thread and ", i0)') more
      call begin_group(result, trim(group))
      simulation = paper_preset(7_int64)
      simulation%samples = 40000
      simulation%coefficient(4) = 1.0e-4_dp
      simulation%missing = 0.002_dp
      deallocate (simulation%trend)
      call simulate_record(simulation, record, error)
      call set_thread_count(1)
      if (.not. allocated(error)) call run_pipeline(record, options, one, error)
      call set_thread_count(more)
      if (.not. allocated(error)) call run_pipeline(record, options, many, error)
      call set_thread_count(threads)
      if (allocated(error)) then
         call add_failure(result, "the main job", error)
         return
      end if
      if (is_whole(one%channel(1)) .and. is_whole(many%channel(1))) then
         call compare(result, one%channel(1), many%channel(1))
      else
         call add_check(result, "the main job, all rooms", 1.0_dp, 0.0_dp, 0.0_dp)
      end if
   end subroutine check_threads

   !> Every room that is compared has done its work.
   pure logical function is_whole(channel)
      type(channel_result_type), intent(in) :: channel

      associate (has => channel%available)
         is_whole = all([has%preprocess, has%adf, has%kpss, has%jarque_bera, has%ljung_box, &
            & has%anderson_darling, has%periodicity, has%spectrum, has%ar, has%kf, has%akf, &
            & has%drift, has%drift_kf, has%drift_akf, has%drift_smoother, &
            & channel%allan(1)%available])
      end associate
   end function is_whole

   !> The largest relative difference of every room.
   subroutine compare(result, one, many)
      type(selftest_type), intent(inout) :: result
      type(channel_result_type), intent(in) :: one, many
      real(dp), allocatable :: a(:), b(:)
      real(dp) :: largest
      integer :: room, i

      do room = 1, size(rooms)
         call gather(one, room, a)
         call gather(many, room, b)
         call add_check(result, trim(rooms(room))//": numbers", real(size(a), dp), real(size(b), dp), 0.0_dp)
         if (size(a) /= size(b)) cycle
         largest = 0.0_dp
         do i = 1, size(a)
            largest = max(largest, abs(a(i) - b(i))/max(abs(a(i)), tiny(largest)))
         end do
         call add_check(result, trim(rooms(room))//": difference", 0.0_dp, largest, rounding)
      end do
   end subroutine compare

   !> The numbers of a room.
   subroutine gather(channel, room, x)
      type(channel_result_type), intent(in) :: channel
      integer, intent(in) :: room
      real(dp), allocatable, intent(out) :: x(:)
      integer :: i

      select case (room)
      case (1)
         x = [channel%raw%mean, channel%raw%variance, channel%cleaned%mean, channel%cleaned%variance, channel%cleaned%skewness, &
            & channel%cleaned%kurtosis, real(channel%clean%removed, dp), channel%clean%trend%legendre]
      case (2)
         x = [channel%adf%statistic, channel%adf%level, channel%adf%noise_variance, real(channel%adf%lag, dp), &
            & channel%kpss%statistic, channel%jarque_bera%statistic, channel%ljung_box%statistic, &
            & channel%anderson_darling%statistic, channel%periodicity%fisher%statistic, &
            & channel%spectrum%density]
      case (3)
         x = [channel%ar%coefficient, channel%ar%std_error, channel%ar%noise_variance, channel%ar%residual_ljung_box%statistic, &
            & channel%ar%table%aic]
      case (4)
         x = [channel%kf%variance, channel%akf%variance, channel%akf%q, channel%akf%r, channel%kf%nis_mean, &
            & channel%drift%model%phi, channel%drift%model%q, channel%drift%model%r, channel%drift_kf%variance, &
            & channel%drift_akf%variance, channel%drift_akf%r, channel%drift_smoother%variance, channel%compensated%variance]
      case default
         x = [channel%allan(1)%curve%deviation, channel%allan(1)%curve%lower]
         do i = 1, size(channel%allan)
            if (channel%allan(i)%fitted) x = [x, channel%allan(i)%noise%coefficient%value, channel%allan(i)%noise%chi2_reduced]
         end do
      end select
   end subroutine gather

end module gyroakf_selftest_threads
