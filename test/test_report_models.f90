! SPDX-License-Identifier: MIT
!> Reports on filters against the true drift: made-up numbers, and where each of them stands.
module test_report_models
   use testdrive, only : check, error_type, new_unittest, unittest_type
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, pipeline_result_type
   use gyroakf_record, only : record_type
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
         new_unittest("truth", test_truth), &
         new_unittest("truth-document", test_truth_document)]
   end subroutine collect_report_models

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
