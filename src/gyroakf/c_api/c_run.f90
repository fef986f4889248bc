! SPDX-License-Identifier: MIT
!> For C: the whole job with its JSON document, and simulated recordings. What each function
!> promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_run
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_char, c_null_ptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_kinds, only : int8
   use gyroakf_error, only : check_memory, fatal_error, status
   use gyroakf_pipeline, only : run_pipeline, apply_preset
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_document, only : put_document
   use gyroakf_report_json, only : json_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, &
      & paper_seed
   use gyroakf_c_api_c_host, only : progress_c
   use gyroakf_c_api_c_recording, only : record_handle, new_handle, hand_over
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, copy_c_text, max_samples, open_options
   implicit none (type, external)
   private
   public :: gyroakf_run_options_init, gyroakf_run, gyroakf_result_json, gyroakf_result_free
   public :: gyroakf_simulate_options_init, gyroakf_simulate, run_options_c, read_options

   !> `gyroakf_run_options`
   type, bind(C) :: run_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: preset = c_null_ptr
      integer(c_int32_t) :: tests = 1, ar = 1, filters = 1, allan = 1
      type(progress_c) :: progress
   end type run_options_c

   !> `gyroakf_simulate_options`
   type, bind(C) :: simulate_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: preset = c_null_ptr
      integer(c_int64_t) :: samples, seed
      real(c_double) :: rate_hz
      type(c_ptr) :: unit = c_null_ptr
      real(c_double) :: q = 0, n = 0, b = 0, k = 0, r = 0
      real(c_double) :: ar_phi = 0, ar_variance = 0, offset = 0, outlier_size = 0
      integer(c_int64_t) :: outliers = 0
      real(c_double) :: lsb = 0, missing = 0
      type(progress_c) :: progress
   end type simulate_options_c

   !> What `gyroakf_result *` points at
   type :: result_handle
      character(:), allocatable :: json
   end type result_handle

contains

   subroutine gyroakf_run_options_init(opt) bind(C)
      type(run_options_c), intent(out), optional :: opt

      if (present(opt)) opt = run_options_c(c_sizeof(opt))
   end subroutine gyroakf_run_options_init

   integer(c_int) function gyroakf_run(r, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: r
      type(run_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(result_handle), pointer :: handle
      type(pipeline_options) :: options
      integer :: stat

      call enter_library(c)
      if (present(out)) out = c_null_ptr
      call check_place(present(out), "result (out)", c%error)
      call check_place(c_associated(r), "recording", c%error)
      call read_options(options, c, opt)
      if (ok(c)) then
         allocate (handle, stat=stat)
         call check_memory(stat, "a result", c%error)
         if (ok(c)) call run_record(r, options, handle%json, c)
         if (ok(c)) out = c_loc(handle)
         if (stat == 0 .and. .not. ok(c)) deallocate (handle)
      end if
      gyroakf_run = leave_library(c, err)
   end function gyroakf_run

   subroutine run_record(r, options, json, c)
      !> `gyroakf_record *`; its missing values are NaN
      type(c_ptr), intent(in) :: r
      type(pipeline_options), intent(in) :: options
      character(:), allocatable, intent(out) :: json
      type(call_type), intent(inout) :: c
      type(record_handle), pointer :: given
      type(record_type), allocatable :: record
      type(pipeline_result_type) :: result
      type(json_type) :: document
      integer :: stat

      call c_f_pointer(r, given)
      if (allocated(given%record%present)) then
         allocate (record, source=given%record, stat=stat)
         call check_memory(stat, "a copy of the recording", c%error)
         if (allocated(c%error)) return
         where (record%present == 0_int8) record%value = 0
         call run_pipeline(record, options, result, c%error, c%callback)
         if (ok(c)) call put_document(document, record, result)
      else
         call run_pipeline(given%record, options, result, c%error, c%callback)
         if (ok(c)) call put_document(document, given%record, result)
      end if
      if (allocated(c%error)) return
      stat = merge(1, 0, document%failed)
      if (stat == 0) allocate (character(document%used + 1) :: json, stat=stat)
      call check_memory(stat, "the text of the results", c%error)
      if (allocated(c%error)) return
      json(:document%used) = document%buffer(:document%used)
      json(document%used + 1:) = c_null_char
   end subroutine run_record

   type(c_ptr) function gyroakf_result_json(result) bind(C)
      type(c_ptr), intent(in), value :: result
      type(result_handle), pointer :: handle

      gyroakf_result_json = c_null_ptr
      if (.not. c_associated(result)) return
      call c_f_pointer(result, handle)
      gyroakf_result_json = c_loc(handle%json)
   end function gyroakf_result_json

   subroutine gyroakf_result_free(result) bind(C)
      type(c_ptr), intent(in), value :: result
      type(result_handle), pointer :: handle

      if (.not. c_associated(result)) return
      call c_f_pointer(result, handle)
      deallocate (handle)
   end subroutine gyroakf_result_free

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, c, opt)
      !> Of the library
      type(pipeline_options), intent(out) :: options
      !> Gets the progress function; nothing is done after an earlier error
      type(call_type), intent(inout) :: c
      !> Of C; absent for NULL
      type(run_options_c), intent(in), optional :: opt
      character(:), allocatable :: preset

      if (.not. present(opt)) return
      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (allocated(c%error)) return
      call copy_c_text(opt%preset, "default", preset)
      call apply_preset(preset, options, c%error)
      options%do_tests = opt%tests /= 0
      options%do_ar = opt%ar /= 0
      options%do_filter = opt%filters /= 0
      options%do_allan = opt%allan /= 0
   end subroutine read_options

   subroutine gyroakf_simulate_options_init(opt) bind(C)
      type(simulate_options_c), intent(out), optional :: opt
      type(simulate_options) :: defaults

      if (present(opt)) opt = simulate_options_c(c_sizeof(opt), samples=defaults%samples, &
         & seed=paper_seed, rate_hz=defaults%rate_hz)
   end subroutine gyroakf_simulate_options_init

   integer(c_int) function gyroakf_simulate(opt, out, err) bind(C)
      type(simulate_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(record_handle), pointer :: handle
      type(simulate_options) :: options

      call enter_library(c)
      call new_handle(handle, present(opt), "the options (opt) must not be NULL", c, out)
      if (ok(c)) call read_simulation(opt, options, c)
      if (ok(c)) call simulate_record(options, handle%record, c%error, progress=c%callback)
      call hand_over(handle, c, out)
      gyroakf_simulate = leave_library(c, err)
   end function gyroakf_simulate

   subroutine read_simulation(opt, options, c)
      type(simulate_options_c), intent(in) :: opt
      type(simulate_options), intent(out) :: options
      type(call_type), intent(inout) :: c
      character(:), allocatable :: preset

      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (allocated(c%error)) return
      call copy_c_text(opt%preset, "none", preset)
      if (preset == "paper") then
         options = paper_preset(opt%seed)
         return
      else if (preset /= "none") then
         call fatal_error(c%error, status%invalid_argument, 'there is no preset "'//preset// &
            & '"; there are none and paper')
         return
      else if (opt%samples < 1 .or. opt%samples > max_samples) then
         call fatal_error(c%error, status%invalid_argument, &
            & "the number of samples must be 1 .. 2**44")
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
