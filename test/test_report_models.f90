! SPDX-License-Identifier: MIT
!> What reports say of ARMA models and of filters beside the true drift: made-up numbers, and where each of them stands.
module test_report_models
   use testdrive, only : check, error_type, new_unittest, unittest_type
   use gyroakf_kinds, only : dp, int64
   use gyroakf_ar_arma_result, only : arma_criteria
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, pipeline_result_type
   use gyroakf_record, only : add_text, record_type
   use gyroakf_report_document, only : write_document
   use gyroakf_report_text, only : write_report
   use json_reader, only : check_schema, file_text, json_item, json_real, json_text_at, read_json
   use report_fixture, only : begin_text, end_text, make_record, make_result
   implicit none (type, external)
   private
   public :: collect_report_models

   character(*), parameter :: channel_path = "/channels/0"

contains

   !> Names the tests.
   subroutine collect_report_models(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("arma", test_arma), &
         new_unittest("arma-without-errors", test_arma_bare), &
         new_unittest("arma-document", test_arma_document), &
         new_unittest("truth", test_truth), &
         new_unittest("truth-document", test_truth_document)]
   end subroutine collect_report_models

   !> ARMA(1,1), chosen among three, the same as a drift of 50 s in white noise.
   subroutine fill_arma(channel)
      type(channel_result_type), intent(inout) :: channel

      channel%available%arma = .true.
      channel%arma_time = 50.3_dp
      channel%arma_time_error = 4.9_dp
      associate (model => channel%arma)
         model%p = 1
         model%q = 1
         model%phi = [0.9805_dp]
         model%phi_error = [0.0019_dp]
         model%theta = [-0.875_dp]
         model%theta_error = [0.0048_dp]
         model%mean = 0.25_dp
         model%mean_error = 0.0125_dp
         model%noise_variance = 1.5e-4_dp
         model%errors_known = .true.
         model%converged = .true.
         model%partial = .true.
         model%samples = 11
         model%first = 2
         model%length = 11
         model%compared_length = 9
         model%table = arma_criteria([0, 1, 1], [1, 0, 1], [100.5_dp, 120.25_dp, 130.75_dp], [4.0e-4_dp, 2.0e-4_dp, 1.5e-4_dp], &
                                     9_int64)
         model%table(1)%usable = .false.
         model%fit = arma_criteria(1, 1, 131.5_dp, 1.5e-4_dp, 11_int64)
         model%residual_ljung_box%lags = 20
         model%residual_ljung_box%statistic = 17.5_dp
         model%residual_ljung_box%p_value = 0.62_dp
         model%drift%found = .true.
         model%drift%drift_std = 0.125_dp
         model%drift%drift_error = 0.0041_dp
         model%drift%white_std = 0.0625_dp
         model%drift%white_error = 0.0023_dp
         call add_text(model%warnings, "the record is short for this model")
      end associate
   end subroutine fill_arma

   !> Two methods; of the longest time there is no window, nothing is predicted by the second.
   subroutine fill_truth(channel)
      type(channel_result_type), intent(inout) :: channel

      associate (truth => channel%truth)
         truth%known = .true.
         truth%count = 2
         truth%angle_unit = "deg"
         truth%average_samples = 1234
         truth%method(1)%name = "none"
         truth%method(2)%name = "drift_smoother"
         truth%method(2)%offline = .true.
         truth%method(:2)%decay = [1.0_dp, 0.5_dp]
         truth%method(:2)%score%rmse = [0.0625_dp, 0.03125_dp]
         truth%method(:2)%score%bias = [0.5_dp, -0.25_dp]
         truth%method(:2)%score%samples = [11_int64, 12_int64]
         truth%method(1)%score%attitude_error = [0.75_dp, 1.5_dp, 0.0_dp]
         truth%method(1)%score%attitude_windows = [40_int64, 7_int64, 0_int64]
         truth%method(1)%score%predicted_error = [2.25_dp, 4.5_dp, 0.0_dp]
         truth%method(1)%score%predicted_windows = [39_int64, 6_int64, 0_int64]
         truth%method(2)%score%attitude_error = [0.375_dp, 0.875_dp, 0.0_dp]
         truth%method(2)%score%attitude_windows = [40_int64, 7_int64, 0_int64]
      end associate
   end subroutine fill_truth

   !> The report in one line: line ends and rows of blanks are one blank.
   subroutine report_line(record, result, line)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      character(:), allocatable, intent(out) :: line
      type(writer_type) :: writer
      character(:), allocatable :: text
      integer :: i

      call begin_text(writer)
      call write_report(writer, "run", record, pipeline_options(), result)
      call end_text(writer, text)
      line = ""
      do i = 1, len(text)
         if (text(i:i) /= " " .and. text(i:i) /= new_line("a")) then
            line = line//text(i:i)
         else if (line(max(1, len(line)):) /= " ") then
            line = line//" "
         end if
      end do
   end subroutine report_line

   !> Every fragment stands in the line.
   subroutine check_fragments(line, fragments, error)
      character(*), intent(in) :: line, fragments(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(fragments)
         call check(error, index(line, trim(fragments(i))) > 0, "missing: "//trim(fragments(i)))
         if (allocated(error)) return
      end do
   end subroutine check_fragments

   !> The document of a result; its parts have what the schema says.
   subroutine make_document(record, result, items, error)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(json_item), allocatable, intent(out) :: items(:)
      type(error_type), allocatable, intent(out) :: error
      type(json_item), allocatable :: schema(:)
      type(writer_type) :: writer
      character(:), allocatable :: text, wrong
      logical :: valid

      call begin_text(writer)
      call write_document(writer, record, result)
      call end_text(writer, text)
      call read_json(text, items, valid)
      call check(error, valid, "the document is no JSON")
      if (allocated(error)) return
      call read_json(file_text("doc/schema.json"), schema, valid)
      wrong = ""
      call check_schema(schema, "", items, "", wrong)
      call check(error, wrong, "")
   end subroutine make_document

   !> The numbers at these places of a part of the document.
   subroutine check_numbers(items, part, places, values, error)
      type(json_item), intent(in) :: items(:)
      character(*), intent(in) :: part, places(:)
      real(dp), intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(places)
         call check(error, json_real(items, channel_path//part//trim(places(i))), values(i), thr=1.0e-14_dp, rel=.true., &
                    message=part//trim(places(i)))
         if (allocated(error)) return
      end do
   end subroutine check_numbers

   !> Orders, coefficients with errors, whiteness, the drift that it is, warnings.
   subroutine test_arma(error)
      type(error_type), allocatable, intent(out) :: error
      character(140), parameter :: fragments(9) = [character(140) :: &
         "ARMA model by exact likelihood: 11 samples in the middle of the series", &
         " 0 1 4.00000e-04 100.50 -195.00 -194.41 left out", &
         " * 1 1 1.50000e-04 130.75 -253.50 -252.71 ", &
         "* is chosen by BIC, compared on the middle 9 samples left out: a root of the MA polynomial", &
         "phi_1 = 0.9805 +/- 0.0019, theta_1 = -0.875 +/- 0.0048, noise variance 1.50000e-04; mean 0.25 +/- 0.013", &
         "ln L = 131.50, AIC -255.00, BIC -253.41", "Residuals Ljung-Box 17.5 over 20 lags, p = 0.62", &
         "an AR(1) of correlation time 50.3 +/- 4.9 s and standard deviation 0.125 +/- 0.0041 deg/s in white noise of standard "// &
         "deviation 0.0625 +/-", "Warning the record is short for this model"]
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: line

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_arma(result%channel(1))
      call report_line(record, result, line)
      call check_fragments(line, fragments, error)
   end subroutine test_arma

   !> Errors that are not known are not there, neither is a table of given orders or a drift that it is not; without a rate the
   !> time is in samples.
   subroutine test_arma_bare(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: line

      call make_record(record, .false.)
      call make_result(record, result)
      call fill_arma(result%channel(1))
      result%channel(1)%arma%errors_known = .false.
      result%channel(1)%arma%partial = .false.
      result%channel(1)%arma%drift%white_std = 0.0_dp
      deallocate (result%channel(1)%arma%table)
      call report_line(record, result, line)
      call check_fragments(line, [character(100) :: &
                                  "exact likelihood: 11 samples ARMA(1,1) phi_1 = 0.9805, theta_1 = -0.875, noise", &
                                  "an AR(1) of correlation time 50.3 samples and standard deviation 0.125 Warning"], error)
      if (allocated(error)) return
      call check(error, index(line, "is chosen by BIC, compared") == 0, "orders that were not compared")
      if (allocated(error)) return
      result%channel(1)%arma%drift%found = .false.
      call report_line(record, result, line)
      call check(error, index(line, "the same as an AR(1)") == 0, "a drift that it is not")
   end subroutine test_arma_bare

   subroutine test_arma_document(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(json_item), allocatable :: items(:)

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_arma(result%channel(1))
      call make_document(record, result, items, error)
      if (allocated(error)) return
      call check_numbers(items, "/arma", [character(40) :: "/p", "/q", "/phi/0", "/phi_std_errors/0", "/theta/0", &
                         "/theta_std_errors/0", "/mean", "/mean_std_error", "/noise_variance", "/log_likelihood", "/first_sample", &
                         "/compared_length", "/table/1/log_likelihood", "/residual_ljung_box/p_value"], &
                         [1.0_dp, 1.0_dp, 0.9805_dp, 0.0019_dp, -0.875_dp, 0.0048_dp, 0.25_dp, 0.0125_dp, 1.5e-4_dp, 131.5_dp, &
                          2.0_dp, 9.0_dp, 120.25_dp, 0.62_dp], error)
      if (allocated(error)) return
      call check(error, json_text_at(items, channel_path//"/arma/table/0/usable"), "false")
      if (allocated(error)) return
      result%channel(1)%arma%errors_known = .false.
      result%channel(1)%arma%drift%found = .false.
      call make_document(record, result, items, error)
      if (allocated(error)) return
      call check(error, json_text_at(items, channel_path//"/arma/phi_std_errors")// &
                 json_text_at(items, channel_path//"/arma/mean_std_error")// &
                 json_text_at(items, channel_path//"/arma/drift"), "nullnullnull")
   end subroutine test_arma_document

   !> A line a method; a dash where no window is; what later samples are used by; nothing without a truth.
   subroutine test_truth(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: line

      call make_record(record, .true.)
      call make_result(record, result)
      call report_line(record, result, line)
      call check(error, index(line, "Against the true drift") == 0, "a truth that is not known")
      if (allocated(error)) return
      call fill_truth(result%channel(1))
      call report_line(record, result, line)
      call check_fragments(line, [character(100) :: "Against the true drift", "RMSE 10 s 60 s 300 s +10 s +60 s +300 s", &
         "as it is 0.0625 0.75 1.5 - 2.25 4.5 - drift smoother * 0.03125 0.375 0.875 - - - -", &
         "RMSE in deg/s over 11 samples", "error of the angle in deg after that time, over 40, 7 and 0 windows", &
         "averages are over 1234 samples"], error)
      if (allocated(error)) return
      call make_record(record, .false.)
      call report_line(record, result, line)
      call check_fragments(line, [character(100) :: "RMSE 10 samples 60 samples", "RMSE in units of the input over"], error)
   end subroutine test_truth

   subroutine test_truth_document(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(json_item), allocatable :: items(:)

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_truth(result%channel(1))
      call make_document(record, result, items, error)
      if (allocated(error)) return
      call check_numbers(items, "/truth", [character(48) :: "/average_samples", "/methods/0/rmse", "/methods/1/rmse", &
                         "/methods/1/bias", "/methods/1/decay", "/methods/1/samples", "/methods/0/attitude/1/after_s", &
                         "/methods/0/attitude/1/compensated", "/methods/0/attitude/1/predicted", &
                         "/methods/0/attitude/1/predicted_windows"], &
                         [1234.0_dp, 0.0625_dp, 0.03125_dp, -0.25_dp, 0.5_dp, 12.0_dp, 60.0_dp, 1.5_dp, 4.5_dp, 6.0_dp], error)
      if (allocated(error)) return
      call check(error, json_text_at(items, channel_path//"/truth/methods/0/attitude/2/compensated")// &
                 json_text_at(items, channel_path//"/truth/methods/1/attitude/0/predicted"), "nullnull")
      if (allocated(error)) return
      call check(error, json_text_at(items, channel_path//"/truth/methods/1/name")// &
                 json_text_at(items, channel_path//"/truth/methods/1/offline"), """drift_smoother""true")
   end subroutine test_truth_document

end module test_report_models
