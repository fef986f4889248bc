! SPDX-License-Identifier: MIT
!> For C: the whole job with its JSON document, and simulated recordings. What each function promises is said in
!> c_api/include/gyroakf.h.
module gyroakf_c_api_c_run
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, c_double, c_size_t, c_null_char, &
      & c_null_ptr, c_null_funptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_pipeline, only : run_pipeline, apply_preset
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_document, only : put_document
   use gyroakf_report_json, only : json_type, json_text
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, paper_seed
   use gyroakf_c_api_c_progress, only : callback_type
   use gyroakf_c_api_c_record, only : record_handle, new_handle, hand_over
   use gyroakf_c_api_c_support, only : error_c, host_type, enter_library, leave_library, check_struct_size, copy_c_text, max_samples
   implicit none (type, external)
   private
   public :: gyroakf_run_options_init, gyroakf_run, gyroakf_result_json, gyroakf_result_free, gyroakf_simulate_options_init, &
      & gyroakf_simulate

   !> `gyroakf_run_options`
   type, bind(C) :: run_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: preset
      integer(c_int32_t) :: tests, ar, filters, allan
      type(c_funptr) :: progress
      type(c_ptr) :: progress_user
   end type run_options_c

   !> `gyroakf_simulate_options`
   type, bind(C) :: simulate_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: preset
      integer(c_int64_t) :: samples, seed
      real(c_double) :: rate_hz
      type(c_ptr) :: unit
      real(c_double) :: q, n, b, k, r, ar_phi, ar_variance, offset, outlier_size
      integer(c_int64_t) :: outliers
      real(c_double) :: lsb, missing
      type(c_funptr) :: progress
      type(c_ptr) :: progress_user
   end type simulate_options_c

   !> Size of these options before they had a progress function
   integer(c_size_t), parameter :: simulate_size_before = 144

   !> What `gyroakf_result *` points at
   type :: result_handle
      character(:), allocatable :: json
   end type result_handle

contains

   !> `gyroakf_run_options_init`
   subroutine gyroakf_run_options_init(opt) bind(C, name="gyroakf_run_options_init")
      type(run_options_c), intent(out), optional :: opt

      if (.not. present(opt)) return
      opt = run_options_c(c_sizeof(opt), c_null_ptr, 1, 1, 1, 1, c_null_funptr, c_null_ptr)
   end subroutine gyroakf_run_options_init

   !> `gyroakf_run`
   integer(c_int) function gyroakf_run(r, opt, out, err) bind(C, name="gyroakf_run")
      type(c_ptr), intent(in), value :: r
      type(run_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(record_handle), pointer :: record
      type(result_handle), pointer :: handle
      type(pipeline_options) :: options
      type(callback_type) :: callback
      type(error_type), allocatable :: error

      call enter_library(host)
      nullify (handle)
      if (present(out)) out = c_null_ptr
      if (.not. present(out) .or. .not. c_associated(r)) then
         call fatal_error(error, status%invalid_argument, "the recording and the place for the result (out) must not be NULL")
      else
         call read_options(options, callback, error, opt)
      end if
      if (.not. allocated(error)) then
         call c_f_pointer(r, record)
         allocate (handle)
         call run_record(record%record, options, callback, handle%json, error)
         if (allocated(error)) deallocate (handle)
      end if
      if (associated(handle)) out = c_loc(handle)
      gyroakf_run = leave_library(host, error, err)
   end function gyroakf_run

   !> The job, and its document.
   subroutine run_record(given, options, callback, json, error)
      !> Its missing values are NaN
      type(record_type), intent(in) :: given
      type(pipeline_options), intent(in) :: options
      type(callback_type), intent(inout) :: callback
      !> Ends with NUL
      character(:), allocatable, intent(out) :: json
      type(error_type), allocatable, intent(out) :: error
      type(record_type), allocatable :: record
      type(pipeline_result_type) :: result
      type(json_type) :: document
      integer :: stat

      if (allocated(given%present)) then
         allocate (record, source=given, stat=stat)
         if (stat /= 0) then
            call fatal_error(error, status%no_memory, "no memory for a copy of the recording")
            return
         end if
         where (record%present == 0_int8) record%value = 0
         call run_pipeline(record, options, result, error, callback)
      else
         call run_pipeline(given, options, result, error, callback)
      end if
      if (allocated(error)) return
      if (allocated(record)) call put_document(document, record, result)
      if (.not. allocated(record)) call put_document(document, given, result)
      json = json_text(document)//c_null_char
   end subroutine run_record

   !> `gyroakf_result_json`
   type(c_ptr) function gyroakf_result_json(result) bind(C, name="gyroakf_result_json")
      type(c_ptr), intent(in), value :: result
      type(result_handle), pointer :: handle

      gyroakf_result_json = c_null_ptr
      if (.not. c_associated(result)) return
      call c_f_pointer(result, handle)
      gyroakf_result_json = c_loc(handle%json)
   end function gyroakf_result_json

   !> `gyroakf_result_free`
   subroutine gyroakf_result_free(result) bind(C, name="gyroakf_result_free")
      type(c_ptr), intent(in), value :: result
      type(result_handle), pointer :: handle

      if (.not. c_associated(result)) return
      call c_f_pointer(result, handle)
      deallocate (handle)
   end subroutine gyroakf_result_free

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, callback, error, opt)
      type(pipeline_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(run_options_c), intent(in), optional :: opt
      character(:), allocatable :: preset

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error)
      if (allocated(error)) return
      call copy_c_text(opt%preset, "default", preset)
      call apply_preset(preset, options, error)
      options%do_tests = opt%tests /= 0
      options%do_ar = opt%ar /= 0
      options%do_filter = opt%filters /= 0
      options%do_allan = opt%allan /= 0
      callback = callback_type(opt%progress, opt%progress_user)
   end subroutine read_options

   !> `gyroakf_simulate_options_init`
   subroutine gyroakf_simulate_options_init(opt) bind(C, name="gyroakf_simulate_options_init")
      type(simulate_options_c), intent(out), optional :: opt
      type(simulate_options) :: defaults

      if (.not. present(opt)) return
      opt = simulate_options_c(c_sizeof(opt), c_null_ptr, defaults%samples, paper_seed, defaults%rate_hz, c_null_ptr, 0, 0, 0, 0, &
                               0, 0, 0, 0, 0, 0_c_int64_t, 0, 0, c_null_funptr, c_null_ptr)
   end subroutine gyroakf_simulate_options_init

   !> `gyroakf_simulate`
   integer(c_int) function gyroakf_simulate(opt, out, err) bind(C, name="gyroakf_simulate")
      type(simulate_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(record_handle), pointer :: handle
      type(simulate_options) :: options
      type(callback_type) :: callback
      type(error_type), allocatable :: error

      call enter_library(host)
      call new_handle(handle, present(opt), error, out)
      if (.not. allocated(error)) call read_simulation(opt, options, callback, error)
      if (.not. allocated(error)) call simulate_record(options, handle%record, error, progress=callback)
      call hand_over(handle, error, out)
      gyroakf_simulate = leave_library(host, error, err)
   end function gyroakf_simulate

   !> Options of C into options of the library.
   subroutine read_simulation(opt, options, callback, error)
      type(simulate_options_c), intent(in) :: opt
      type(simulate_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: preset

      call check_struct_size(opt%struct_size, c_sizeof(opt), error, simulate_size_before)
      if (allocated(error)) return
      if (opt%struct_size == c_sizeof(opt)) callback = callback_type(opt%progress, opt%progress_user)
      call copy_c_text(opt%preset, "none", preset)
      if (preset == "paper") then
         options = paper_preset(opt%seed)
         return
      else if (preset /= "none") then
         call fatal_error(error, status%invalid_argument, 'there is no preset "'//preset//'"; there are none and paper')
         return
      else if (opt%samples < 1 .or. opt%samples > max_samples) then
         call fatal_error(error, status%invalid_argument, "the number of samples must be 1 .. 2**44")
         return
      end if
      options%samples = opt%samples
      options%seed = opt%seed
      options%rate_hz = opt%rate_hz
      call copy_c_text(opt%unit, "deg/s", options%unit)
      options%coefficient = [opt%q, opt%n, opt%b, opt%k, opt%r]
      options%ar = [opt%ar_phi]
      options%ar_variance = opt%ar_variance
      options%offset = opt%offset
      options%outliers = opt%outliers
      options%outlier_size = opt%outlier_size
      options%lsb = opt%lsb
      options%missing = opt%missing
   end subroutine read_simulation

end module gyroakf_c_api_c_run
