! SPDX-License-Identifier: MIT
!> C: a filter of the program, made for a series. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_design
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int64_t, c_double
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_sample_interval, error_type, fatal_error, status
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_pipeline, only : minimum_samples
   use gyroakf_pipeline_channel, only : run_channel
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type, new_channels
   use gyroakf_record, only : record_type
   use gyroakf_c_api_c_filter, only : new_handle, hand_over
   use gyroakf_c_api_c_run, only : run_options_c, read_options
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, check_place, take_text, open_series
   implicit none (type, external)
   private
   public :: gyroakf_filter_identify, kinds

   !> Which filters there are
   character(*), parameter :: kinds(4) = [character(9) :: "kf", "akf", "drift_kf", "drift_akf"]

contains

   !> `gyroakf_filter_identify`
   integer(c_int) function gyroakf_filter_identify(kind, x, n, dt, opt, out, mean, err) bind(C, name="gyroakf_filter_identify")
      type(c_ptr), intent(in), value :: kind, x
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(run_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      real(c_double), intent(inout), optional :: mean
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(pipeline_options) :: options
      type(filter_type), pointer :: handle
      type(error_type), allocatable :: error
      real(dp) :: level

      call enter_library(c)
      call new_handle(handle, error, out)
      call check_place(present(mean), "mean", error)
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      if (.not. allocated(error)) call take_text(kind, options%design_only, error)
      if (.not. allocated(error)) call check_arguments(options%design_only, dt, error)
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call design(c, dt, options, handle, level, error)
      if (.not. allocated(error)) mean = level
      call hand_over(handle, error, out)
      gyroakf_filter_identify = leave_library(c, error, err)
   end function gyroakf_filter_identify

   !> The kind must be one, the interval a positive number.
   subroutine check_arguments(kind, dt, error)
      character(*), intent(in) :: kind
      real(dp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      if (all(kind /= kinds)) then
         call fatal_error(error, status%invalid_argument, 'there is no filter of kind "'//trim(kind)// &
                          '"; there are kf, akf, drift_kf and drift_akf')
      else
         call check_sample_interval(dt, error)
      end if
   end subroutine check_arguments

   !> The analysis of the series as far as the filter takes it.
   subroutine design(c, dt, options, handle, mean, error)
      type(call_type), intent(inout) :: c
      real(dp), intent(in) :: dt
      type(pipeline_options), intent(inout) :: options
      type(filter_type), intent(inout) :: handle
      real(dp), intent(out) :: mean
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: stat

      mean = 0
      options%do_tests = .false.
      options%do_allan = .false.
      options%do_filter = .true.
      record%sample_interval = dt
      record%rate_known = .true.
      if (size(c%x, kind=int64) < minimum_samples) then
         call fatal_error(error, status%too_few_samples, "10 samples at least are needed")
         return
      end if
      call new_channels(result, 1, stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the analysis of the series")
         return
      end if
      associate (channel => result%channel(1))
         channel%name = "the series"
         call run_channel(record, c%x, options, channel, error, c%valid, c%callback)
         if (allocated(error)) return
         if (allocated(channel%designed)) then
            handle = channel%designed
            mean = channel%designed_mean
         else if (channel%first_failure /= status%ok) then
            call fatal_error(error, channel%first_failure, channel%unavailable(1)%text)
         else
            call fatal_error(error, status%invalid_argument, "the series has no drift that a filter could follow")
         end if
      end associate
   end subroutine design

end module gyroakf_c_api_c_design
