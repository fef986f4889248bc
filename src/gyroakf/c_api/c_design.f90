! SPDX-License-Identifier: MIT
!> The C interface to a filter of the program, made for a series. What the function promises is
!> said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_design
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int64_t, c_double
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, check_sample_interval, error_type, fatal_error, status
   use gyroakf_pipeline, only : minimum_samples
   use gyroakf_pipeline_channel, only : run_channel
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type, new_channels
   use gyroakf_c_api_c_filter, only : handle_type, new_handle, hand_over
   use gyroakf_c_api_c_run, only : run_options_c, read_options
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, take_text, open_series
   implicit none (type, external)
   private
   public :: gyroakf_filter_identify, kinds

   !> Which filters there are
   character(*), parameter :: kinds(4) = [character(9) :: "kf", "akf", "drift_kf", "drift_akf"]

contains

   integer(c_int) function gyroakf_filter_identify(kind, x, n, dt, opt, out, mean, err) bind(C)
      type(c_ptr), intent(in), value :: kind, x
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(run_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      real(c_double), intent(inout), optional :: mean
      type(error_c), intent(out), optional :: err
      type(call_type), target :: c
      type(pipeline_options) :: options
      type(handle_type), pointer :: handle
      real(dp) :: level

      call enter_library(c)
      call new_handle(handle, c%error, out)
      call check_place(present(mean), "mean", c%error)
      call read_options(options, c, opt)
      call take_kind(kind, options%design_only, c%error)
      if (ok(c)) call check_sample_interval(dt, c%error)
      call open_series(x, n, c)
      if (ok(c)) call design(c, dt, options, handle, level)
      if (ok(c)) mean = level
      call hand_over(handle, c%error, out)
      gyroakf_filter_identify = leave_library(c, err)
   end function gyroakf_filter_identify

   !> The kind of a filter.
   subroutine take_kind(kind, name, error)
      type(c_ptr), intent(in) :: kind
      character(*), intent(inout) :: name
      type(error_type), allocatable, intent(inout) :: error

      call take_text(kind, name, error)
      if (allocated(error) .or. any(name == kinds)) return
      call fatal_error(error, status%invalid_argument, 'there is no filter of kind "'// &
         & trim(name)//'"; there are kf, akf, drift_kf and drift_akf')
   end subroutine take_kind

   !> The analysis of the series as far as the filter takes it.
   subroutine design(c, dt, options, handle, mean)
      type(call_type), intent(inout), target :: c
      real(dp), intent(in) :: dt
      type(pipeline_options), intent(in) :: options
      type(handle_type), intent(inout) :: handle
      real(dp), intent(out) :: mean
      type(job_type) :: job
      type(pipeline_result_type) :: result
      integer :: stat

      mean = 0
      job%options = options
      job%options%do_tests = .false.
      job%options%do_allan = .false.
      job%options%do_filter = .true.
      job%step = dt
      job%rate_known = .true.
      job%x => c%x
      if (allocated(c%valid)) job%recorded => c%valid
      job%progress => c%callback
      if (size(c%x, kind=int64) < minimum_samples) then
         call fatal_error(c%error, status%too_few_samples, "10 samples at least are needed")
         return
      end if
      call new_channels(result, 1, stat)
      call check_memory(stat, "the analysis of the series", c%error)
      if (allocated(c%error)) return
      associate (channel => result%channel(1))
         channel%name = "the series"
         call run_channel(job, channel, c%error)
         if (allocated(c%error)) return
         if (allocated(channel%designed)) then
            call move_alloc(channel%designed, handle%filter)
            mean = channel%designed_mean
         else if (allocated(channel%unavailable)) then
            call fatal_error(c%error, channel%unavailable(1)%code, channel%unavailable(1)%text)
         else
            call fatal_error(c%error, status%invalid_argument, &
               & "the series has no drift that a filter could follow")
         end if
      end associate
   end subroutine design

end module gyroakf_c_api_c_design
