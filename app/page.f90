! SPDX-License-Identifier: MIT
!> The last files of `--out`: the figures, and report.html with the same ones.
module gyroakf_app_page
   use gyroakf_error, only : error_type
   use gyroakf_io_writer, only : commit_writer, open_writer, writer_type
   use gyroakf_pipeline, only : pipeline_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_figures, only : figure_folder, write_figures
   use gyroakf_report_html_page, only : page_about_type, write_page
   use gyroakf_report_summary, only : summarise, summary_row_type
   use gyroakf_app_config, only : analysis_config
   implicit none (type, external)
   private
   public :: make_page

contains

   !> Writes the figures and the page.
   subroutine make_page(config, record, result, error)
      !> Its `out` is there
      type(analysis_config), intent(in) :: config
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> io, no_memory
      type(error_type), allocatable, intent(out) :: error
      type(page_about_type) :: about
      type(summary_row_type) :: row
      type(writer_type) :: writer

      call write_figures(config%out//"/"//figure_folder, record, result, error)
      if (allocated(error)) return
      about%command_line = config%command_line
      about%number = config%number
      call summarise(config%command, config%path, config%out, record, row, result)
      call open_writer(writer, config%out//"/report.html", error)
      if (allocated(error)) return
      call write_page(writer, about, config%command, record, result, row)
      call commit_writer(writer, error)
   end subroutine make_page

end module gyroakf_app_page
