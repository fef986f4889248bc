! SPDX-License-Identifier: MIT
!> Reports on filters against the true drift: made-up numbers, and where each of them stands.
module test_report_models
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, pipeline_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_document, only : write_document
   use gyroakf_report_text_report, only : write_report
   use json_reader, only : check_schema, file_text, json_item, json_real, json_text_at, read_json
   use report_fixture, only : begin_text, end_text, make_record, make_result
   implicit none (type, external)
   private
   public :: suite_report_models

   character(*), parameter :: channel_path = "/channels/0"

contains

   subroutine suite_report_models()
      call test("truth", test_truth)
      call test("truth-document", test_truth_document)
   end subroutine suite_report_models

   !> RMSE of two filters.
   subroutine fill_rmse(channel)
      type(channel_result_type), intent(inout) :: channel

      channel%kf_figures%rmse = 0.0625_dp
      channel%kf_figures%rmse_samples = 11
      channel%drift_smoother_figures%rmse = 0.03125_dp
      channel%drift_smoother_figures%rmse_samples = 12
   end subroutine fill_rmse

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
   subroutine check_fragments(line, fragments)
      character(*), intent(in) :: line, fragments(:)
      integer :: i

      do i = 1, size(fragments)
         call check(error, index(line, trim(fragments(i))) > 0, "missing: "//trim(fragments(i)))
      end do
   end subroutine check_fragments

   !> The document of a result; its parts have what the schema says.
   subroutine make_document(record, result, items)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(json_item), allocatable, intent(out) :: items(:)
      type(json_item), allocatable :: schema(:)
      type(writer_type) :: writer
      character(:), allocatable :: text, wrong
      logical :: valid

      call begin_text(writer)
      call write_document(writer, record, result)
      call end_text(writer, text)
      call read_json(text, items, valid)
      call check(error, valid, "the document is no JSON")
      call read_json(file_text("doc/schema.json"), schema, valid)
      wrong = ""
      call check_schema(schema, "", items, "", wrong)
      call check(error, wrong, "")
   end subroutine make_document

   !> The numbers at these places of a part of the document.
   subroutine check_numbers(items, part, places, values)
      type(json_item), intent(in) :: items(:)
      character(*), intent(in) :: part, places(:)
      real(dp), intent(in) :: values(:)
      integer :: i

      do i = 1, size(places)
         call check(error, json_real(items, channel_path//part//trim(places(i))), values(i), thr=1.0e-14_dp, rel=.true., &
                    message=part//trim(places(i)))
      end do
   end subroutine check_numbers

   !> A row for each filter; nothing where the true drift is not known.
   subroutine test_truth()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: line

      call make_record(record, .true.)
      call make_result(record, result)
      call report_line(record, result, line)
      call check(error, index(line, "rmse") == 0, "a truth that is not known")
      call fill_rmse(result%channel(1))
      call report_line(record, result, line)
      call check_fragments(line, [character(100) :: " samples 0.0625"])
   end subroutine test_truth

   !> The same in the document; null where it is not known.
   subroutine test_truth_document()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(json_item), allocatable :: items(:)

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_rmse(result%channel(1))
      call make_document(record, result, items)
      if (allocated(error)) return
      call check_numbers(items, "/filters", [character(48) :: "/kf/rmse"], [0.0625_dp])
      call check(error, json_text_at(items, channel_path//"/filters/akf/rmse"), "null")
   end subroutine test_truth_document

end module test_report_models
