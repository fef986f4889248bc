! SPDX-License-Identifier: MIT
!> The figures of a result as gnuplot scripts in DIR/plots, each with the numbers that it draws.
!>
!>     call write_figures("results/plots", "svg", record, options, result, figures, error)
!>     ! in results/plots, for each of figures%text: gnuplot NAME.gp makes NAME.svg
module gyroakf_report_figures
   use gyroakf_error, only : error_type
   use gyroakf_io_writer, only : commit_writer, make_directory, open_writer, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, pipeline_result_type, stage
   use gyroakf_record, only : add_text, record_type, text_type, view_channel
   use gyroakf_report_figure_allan, only : write_allan_data, write_allan_figure, write_stages_figure
   use gyroakf_report_figure_innovations, only : write_innovations_data, write_innovations_figure
   use gyroakf_report_figure_script, only : figure_formats
   use gyroakf_report_figure_series, only : write_filters_figure, write_series_data, write_series_figure
   use gyroakf_report_figure_statistics, only : write_correlation_data, write_correlation_figure, write_histogram_data, &
      write_histogram_figure, write_spectrum_data, write_spectrum_figure
   use gyroakf_report_input, only : unit_name
   implicit none (type, external)
   private
   public :: write_figures, figure_formats, figure_folder, figure_kinds, figure_name

   !> Below the folder of the results
   character(*), parameter :: figure_folder = "plots"
   !> In the order of a report
   character(12), parameter :: figure_kinds(9) = [character(12) :: "series", "allan", "before_after", "filters", "innovations", &
                                           "histogram", "correlation", "residuals", "spectrum"]

contains

   !> Writes the scripts of all figures that the result has, and what they draw that no csv file holds.
   subroutine write_figures(folder, form, record, options, result, figures, error)
      !> Made where it does not exist: [[gyroakf_report_figures:figure_folder]] in that of [[write_results]], or another
      character(*), intent(in) :: folder
      !> One of [[gyroakf_report_figure_script:figure_formats]]
      character(*), intent(in) :: form
      !> What was read; series are drawn where they were kept
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Names of the figures, without ending: [n]
      type(text_type), allocatable, intent(out) :: figures(:)
      !> io, no_memory
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: name
      integer :: c, i

      allocate (figures(0))
      call make_directory(folder, error)
      if (allocated(error)) return
      do c = 1, size(result%channel)
         do i = 1, size(figure_kinds)
            if (.not. has_figure(trim(figure_kinds(i)), options, result%channel(c))) cycle
            name = figure_name(trim(figure_kinds(i)), result, c)
            call write_script(folder//"/", trim(figure_kinds(i)), name, form, record, result, c, error)
            if (allocated(error)) return
            call add_text(figures, name)
         end do
      end do
   end subroutine write_figures

   !> Whether a channel has what a figure shows.
   pure logical function has_figure(kind, options, channel)
      character(*), intent(in) :: kind
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(in) :: channel

      select case (kind)
      case ("series"); has_figure = options%keep_series .and. allocated(channel%series_cleaned)
      case ("filters"); has_figure = options%keep_series .and. allocated(channel%series_cleaned) &
                                     .and. (channel%available%kf .or. channel%available%akf)
      case ("innovations"); has_figure = channel%available%akf .or. channel%available%drift_akf
      case ("residuals"); has_figure = channel%available%ar .and. channel%ar%residual_correlation%lags > 0
      case ("allan"); has_figure = channel%allan(stage%input)%available
      case ("before_after"); has_figure = count(channel%allan%available) > 1
      case ("histogram"); has_figure = channel%available%histogram
      case ("correlation"); has_figure = channel%available%correlation
      case default; has_figure = channel%available%spectrum
      end select
   end function has_figure

   !> One script, and its data where it has data of its own.
   subroutine write_script(folder, kind, name, form, record, result, c, error)
      character(*), intent(in) :: folder, kind, name, form
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      !> Number of the channel
      integer, intent(in) :: c
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(record_type) :: view
      character(:), allocatable :: suffix, time, unit

      call view_channel(record, c, view)
      unit = unit_name(view)
      time = "samples"
      if (record%rate_known) time = "s"
      call open_writer(writer, folder//name//".gp", error)
      if (allocated(error)) return
      suffix = suffix_of(result, c)
      associate (channel => result%channel(c))
         select case (kind)
         case ("series"); call write_series_figure(writer, name, form, channel, time, unit)
         case ("filters"); call write_filters_figure(writer, name, form, channel, "series"//suffix, time, unit)
         case ("allan"); call write_allan_figure(writer, name, form, channel, time, unit)
         case ("before_after"); call write_stages_figure(writer, name, form, channel, "allan"//suffix, time, unit)
         case ("histogram"); call write_histogram_figure(writer, name, form, channel, unit)
         case ("innovations"); call write_innovations_figure(writer, name, form, channel, time, unit)
         case ("correlation"); call write_correlation_figure(writer, name, form, channel%name//", "//trim(channel%tested))
         case ("residuals"); call write_correlation_figure(writer, name, form, "the residuals of the AR model of "//channel%name)
         case default; call write_spectrum_figure(writer, name, form, channel, unit)
         end select
      end associate
      call commit_writer(writer, error)
      if (allocated(error) .or. any(kind == [character(12) :: "filters", "before_after"])) return
      call open_writer(writer, folder//name//".dat", error)
      if (allocated(error)) return
      call write_data(writer, kind, record, c, result%channel(c))
      call commit_writer(writer, error)
   end subroutine write_script

   !> What a figure draws.
   subroutine write_data(writer, kind, record, c, channel)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: kind
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      type(channel_result_type), intent(in) :: channel

      select case (kind)
      case ("series"); call write_series_data(writer, record, c, channel)
      case ("allan"); call write_allan_data(writer, channel)
      case ("histogram"); call write_histogram_data(writer, channel%histogram)
      case ("innovations"); call write_innovations_data(writer, channel, record%sample_interval)
      case ("correlation"); call write_correlation_data(writer, channel%correlation)
      case ("residuals"); call write_correlation_data(writer, channel%ar%residual_correlation)
      case default; call write_spectrum_data(writer, channel, record%sample_interval)
      end select
   end subroutine write_data

   !> The figure of a channel, without ending.
   function figure_name(kind, result, c) result(name)
      !> One of [[gyroakf_report_figures:figure_kinds]]
      character(*), intent(in) :: kind
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Number of the channel
      integer, intent(in) :: c
      character(:), allocatable :: name

      name = kind//suffix_of(result, c)
   end function figure_name

   !> "" of a single channel, else "-" and its name in letters that every file system takes, with its number where two are alike.
   function suffix_of(result, c) result(suffix)
      type(pipeline_result_type), intent(in) :: result
      integer, intent(in) :: c
      character(:), allocatable :: suffix
      character(12) :: digits
      integer :: i

      suffix = ""
      if (size(result%channel) == 1) return
      suffix = "-"//plain(result%channel(c)%name)
      do i = 1, size(result%channel)
         if (i == c .or. plain(result%channel(i)%name) /= plain(result%channel(c)%name)) cycle
         write (digits, "(i0)") c
         suffix = suffix//"-"//trim(digits)
         return
      end do
   end function suffix_of

   !> Letters, digits, - and _; all else becomes _. File systems that do not tell A from a are why it is in lower case.
   pure function plain(name) result(text)
      character(*), intent(in) :: name
      character(len(name)) :: text
      character(*), parameter :: upper = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", lower = "abcdefghijklmnopqrstuvwxyz"
      integer :: i, at

      do i = 1, len(name)
         text(i:i) = name(i:i)
         at = index(upper, text(i:i))
         if (at > 0) text(i:i) = lower(at:at)
         if (verify(text(i:i), lower//"0123456789-_") > 0) text(i:i) = "_"
      end do
   end function plain

end module gyroakf_report_figures
