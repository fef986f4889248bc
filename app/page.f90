! SPDX-License-Identifier: MIT
!> report.html, the last file of `--out`: with the figures that are there, or with some that are drawn for it alone.
module gyroakf_app_page
   use gyroakf_error, only : error_type
   use gyroakf_io_system, only : c_getpid
   use gyroakf_io_writer, only : commit_writer, open_writer, writer_type
   use gyroakf_pipeline, only : pipeline_result_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_figures, only : figure_folder, write_figures
   use gyroakf_report_html_page, only : drawings_type, page_about_type, write_page
   use gyroakf_report_summary, only : summarise, summary_row_type
   use gyroakf_app_config, only : analysis_config
   use gyroakf_app_gnuplot, only : check_gnuplot, draw_figures, remove_figures
   implicit none (type, external)
   private
   public :: make_page

contains

   !> Writes the page; where no figures can be drawn it says how to have them.
   subroutine make_page(config, record, result, error)
      !> Its `out` is there, with the figures that were asked for
      type(analysis_config), intent(in) :: config
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> io
      type(error_type), allocatable, intent(out) :: error
      type(drawings_type) :: drawings
      type(text_type), allocatable :: figures(:)
      character(:), allocatable :: folder
      character(12) :: process
      logical :: kept

      kept = .false.
      if (allocated(config%plot)) kept = config%plot == "svg"
      if (kept) then
         drawings%folder = config%out//"/"//figure_folder
      else if (config%no_figures) then
         drawings%missing = "Without figures, as --plot none asks for."
      else
         write (process, "(i0)") c_getpid()
         folder = config%out//"/report.html.part"//trim(process)//".d"
         call draw_aside(config, folder, record, result, figures, drawings)
      end if
      call put_page(config, record, result, drawings, error)
      if (allocated(figures)) call remove_figures(folder, "svg", figures)
   end subroutine make_page

   !> Figures for the page alone: without a word where they cannot be drawn.
   subroutine draw_aside(config, folder, record, result, figures, drawings)
      type(analysis_config), intent(in) :: config
      character(*), intent(in) :: folder
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      !> To be removed afterwards; unallocated where nothing was written
      type(text_type), allocatable, intent(out) :: figures(:)
      type(drawings_type), intent(inout) :: drawings
      type(error_type), allocatable :: error

      call check_gnuplot(error)
      if (allocated(error)) then
         drawings%missing = "No figures: gnuplot was not found when this page was made. Install it (apt install gnuplot-nox, "// &
                            "dnf install gnuplot, brew install gnuplot) and run the command below again."
         return
      end if
      call write_figures(folder, "svg", record, config%pipeline, result, figures, error)
      if (.not. allocated(error)) call draw_figures(folder, "svg", figures, error)
      if (allocated(error)) then
         drawings%missing = "No figures: gnuplot did not draw them. --plot svg tells what it says."
      else
         drawings%folder = folder
      end if
   end subroutine draw_aside

   !> The file.
   subroutine put_page(config, record, result, drawings, error)
      type(analysis_config), intent(in) :: config
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(drawings_type), intent(inout) :: drawings
      type(error_type), allocatable, intent(out) :: error
      type(page_about_type) :: about
      type(summary_row_type) :: row
      type(writer_type) :: writer

      about%command_line = config%command_line
      about%number = config%number
      call summarise(config%command, config%path, config%out, record, row, result)
      call open_writer(writer, config%out//"/report.html", error)
      if (allocated(error)) return
      call write_page(writer, about, config%command, record, result, row, drawings)
      call commit_writer(writer, error)
   end subroutine put_page

end module gyroakf_app_page
