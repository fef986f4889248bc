! SPDX-License-Identifier: MIT
!> Figures and result files of a run: axes, ticks, pixels, what each figure holds; no file of an earlier run is left.
module test_figures
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_positive_inf, ieee_quiet_nan, ieee_value
   use expectations, only : unmet, failed => problem, test, error, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_pipeline_result, only : stage
   use gyroakf_io_writer, only : make_directory, writer_type
   use gyroakf_record, only : add_text, record_type, text_type
   use gyroakf_report_figures, only : build_figures, max_blocks, named_figure_type
   use gyroakf_report_files, only : foreign_result, result_files, write_results
   use gyroakf_report_svg, only : figure_type, has_points, write_svg
   use gyroakf_report_svg_series, only : series_type
   use gyroakf_report_axis, only : axis_type, find_ticks, is_inside, is_shown, position, scale_axis, set_range, tick_type
   use gyroakf_units, only : parse_unit
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use report_fixture, only : begin_text, end_text
   use scratch_file, only : file_exists, read_bytes, remove_file, remove_folder, scratch_path, write_bytes
   implicit none (type, external)
   private
   public :: suite_figures

contains

   subroutine suite_figures()
      call test("axis", test_axis)
      call test("ticks", test_ticks)
      call test("svg", test_svg)
      call test("slopes", test_slopes)
      call test("run", test_run)
      call test("long", test_long)
      call test("channels", test_channels)
      call test("what-there-is", test_some)
      call test("no-folder", test_no_folder)
      call test("result-files", test_results)
   end subroutine suite_figures

   !> A run over channels of white noise and a random walk, with lost samples and three outliers; everything is kept.
   subroutine make_run(names, record, options, result)
      character(*), intent(in) :: names(:)
      type(record_type), intent(out) :: record
      type(pipeline_options), intent(out) :: options
      type(pipeline_result_type), intent(out) :: result
      type(simulate_options) :: noise
      type(record_type) :: one
      integer :: c

      noise%samples = 1500
      noise%rate_hz = 5
      noise%coefficient(2) = 0.01_dp
      noise%coefficient(4) = 2.0e-3_dp
      noise%missing = 0.01_dp
      noise%outliers = 3
      noise%outlier_size = 20
      do c = 1, size(names)
         noise%seed = c
         call simulate_record(noise, one, failed)
         if (c == 1) then
            record = one
            deallocate (record%value, record%present, record%channel)
            allocate (record%value(noise%samples, size(names)), record%present(noise%samples, size(names)))
            allocate (record%channel(size(names)))
         end if
         record%value(:, c) = one%value(:, 1)
         record%present(:, c) = one%present(:, 1)
         record%channel(c)%text = trim(names(c))
      end do
      options%keep_series = .true.
      call run_pipeline(record, options, result, failed)
   end subroutine make_run

   !> The figures of a run as documents; none where their names are not these.
   subroutine take_figures(record, result, names, text)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      !> Without folder and ending, in their order, separated by blanks
      character(*), intent(in) :: names
      type(text_type), allocatable, intent(out) :: text(:)
      type(named_figure_type), allocatable :: figures(:)
      type(writer_type) :: writer
      character(:), allocatable :: found
      integer :: i

      call build_figures(record, result, figures)
      found = ""
      allocate (text(size(figures)))
      do i = 1, size(figures)
         found = found//" "//figures(i)%name(9:len(figures(i)%name) - 4)
         call begin_text(writer)
         call write_svg(writer, figures(i)%figure, .true.)
         call end_text(writer, text(i)%text)
      end do
      if (found /= " "//names) text = text(:0)
   end subroutine take_figures

   !> How often a text holds another.
   pure integer function occurrences(text, part)
      character(*), intent(in) :: text, part
      integer :: at, next

      occurrences = 0
      at = 1
      do
         next = index(text(at:), part)
         if (next == 0) return
         occurrences = occurrences + 1
         at = at + next
      end do
   end function occurrences

   !> Values to pixels, forward and beyond the ends; what cannot be shown; a range without extent.
   subroutine test_axis()
      type(axis_type) :: axis

      axis%from = 100.0_dp
      axis%to = 300.0_dp
      call set_range(axis, -1.0_dp, 3.0_dp, 0.0_dp)
      call check(error, all(abs(position(axis, [-1.0_dp, 0.0_dp, 3.0_dp, 5.0_dp]) - [100, 150, 300, 400]) < 1.0e-9_dp), "linear")
      call check(error, all(is_inside(axis, [-1.0_dp, 3.0_dp])) .and. .not. any(is_inside(axis, [-1.1_dp, 3.1_dp])), "ends")
      call set_range(axis, 5.0_dp, 5.0_dp, 0.0_dp)
      call check(error, axis%last > 5.0_dp .and. axis%first < 5.0_dp .and. is_inside(axis, 5.0_dp), "one value")
      call set_range(axis, 0.0_dp, 0.0_dp, 0.04_dp)
      call check(error, axis%last > axis%first, "zeros alone")
      axis%logarithmic = .true.
      call set_range(axis, 0.01_dp, 100.0_dp, 0.0_dp)
      call check(error, all(abs(position(axis, [0.01_dp, 0.1_dp, 100.0_dp]) - [100, 150, 300]) < 1.0e-9_dp), "logarithmic")
      call check(error, .not. any(is_shown(axis, [0.0_dp, -1.0_dp, 1.0e300_dp, ieee_value(0.0_dp, ieee_quiet_nan), &
                                                  ieee_value(0.0_dp, ieee_positive_inf)])), "not shown")
      axis = scale_axis(axis, 3600.0_dp)
      call check(error, position(axis, 360.0_dp), 150.0_dp, thr=1.0e-9_dp, more="the second axis")
      call set_range(axis, 2.0_dp, 3.0_dp, 0.0_dp)
      call check(error, axis%last - axis%first, 1.0_dp, thr=1.0e-9_dp, more="less than a decade")
   end subroutine test_axis

   !> Values and labels of ticks.
   subroutine test_ticks()
      type(axis_type) :: axis

      axis = axis_type(.false., -0.25_dp, 0.25_dp, 0.0_dp, 300.0_dp)
      call expect(50.0_dp, "-0.2 -0.1 0 0.1 0.2")
      axis = axis_type(.false., 0.0_dp, 2400.0_dp, 0.0_dp, 300.0_dp)
      call expect(60.0_dp, "0 500 1000 1500 2000")
      axis = axis_type(.false., 9.7999_dp, 9.8011_dp, 0.0_dp, 300.0_dp)
      call expect(100.0_dp, "9.8 9.8005 9.801")
      axis = axis_type(.true., -1.5_dp, 2.2_dp, 0.0_dp, 300.0_dp)
      call expect(60.0_dp, "0.1 1 10 100")
      call expect(100.0_dp, "1 100")
      axis = axis_type(.true., -0.1_dp, 1.2_dp, 0.0_dp, 300.0_dp)
      call expect(60.0_dp, "1 2 5 10")

   contains

      !> The labels of an axis.
      subroutine expect(spacing, labels)
         real(dp), intent(in) :: spacing
         character(*), intent(in) :: labels
         type(tick_type), allocatable :: tick(:)
         character(:), allocatable :: text
         integer :: i

         if (allocated(error)) return
         call find_ticks(axis, spacing, tick)
         text = ""
         do i = 1, size(tick)
            if (tick(i)%label /= "") text = text//" "//trim(tick(i)%label)
         end do
         call check(error, text, " "//labels)
      end subroutine expect

   end subroutine test_ticks

   !> Points at their pixels, lines broken and points left out where a value cannot be shown, names that stay texts.
   subroutine test_svg()
      type(figure_type) :: figure
      type(writer_type) :: writer
      character(:), allocatable :: text
      real(dp) :: nan

      nan = ieee_value(0.0_dp, ieee_quiet_nan)
      call check(error, .not. has_points(figure), "an empty figure")
      figure%title = "<a & b>"
      figure%caption = "c"
      figure%x_label = "x"
      figure%y_label = "y"
      allocate (figure%series(3))
      figure%series(1)%x = [nan]
      figure%series(1)%y = [1.0_dp]
      call check(error, .not. has_points(figure), "nothing but NaN")
      figure%series(2) = series_type(label="<g>", style="line", color=3, x=[0.0_dp, 1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], &
                                     y=[0.0_dp, 1.0_dp, nan, 1.0_dp, 0.0_dp])
      figure%series(3) = series_type(style="points", x=[2.0_dp, nan], y=[0.0_dp, 0.5_dp], lower=[nan, 0.0_dp], &
                                     upper=[1.0_dp, 1.0_dp], hollow=[.true., .false.])
      call begin_text(writer)
      call write_svg(writer, figure, .true.)
      call end_text(writer, text)
      call check(error, has_points(figure) .and. index(text, "<?xml") == 1 .and. index(text, "</svg>") > 0, "a document")
      call check(error, index(text, ">&lt;a &amp; b&gt;</text>") > 0 .and. index(text, ">&lt;g&gt;</text>") > 0, "escaped names")
      call check(error, index(text, "<path d=""M84 356.5L222 69.48M498 69.48L636 356.5""/>") > 0, "the line: "//text)
      call check(error, index(text, "<path class=""hollow"" data-i=""1"" d=""M356.2 356.5a") > 0, "the point")
      call check(error, index(text, """bar""") == 0 .and. index(text, "data-i=""2""") == 0 .and. index(text, "NaN") == 0, &
                 "what cannot be shown")
      call check(error, index(text, "class=""series line c3"" data-series=""2""") > 0 .and. &
                 index(text, "class=""key line c3"" data-series=""2""") > 0, "the legend's series")
   end subroutine test_svg

   !> The slopes stand in a corner without points, as steep as in the figure; a second axis; nothing in a full frame.
   subroutine test_slopes()
      type(figure_type) :: figure
      type(writer_type) :: writer
      character(:), allocatable :: text

      figure%title = "t"
      figure%caption = "c"
      figure%x_label = "x"
      figure%y_label = "y"
      figure%right_label = "deg/h"
      figure%right_factor = 3600.0_dp
      figure%logarithmic = .true.
      allocate (figure%series(1))
      figure%series(1) = series_type(style="both", x=[1.0_dp, 100.0_dp, 1.0e4_dp], y=[100.0_dp, 10.0_dp, 1.0_dp])
      call begin_text(writer)
      call write_svg(writer, figure, .false.)
      call end_text(writer, text)
      call check(error, index(text, "<path d=""M96 322.2L156 292.5""/>") > 0 .and. index(text, ">-1/2</text>") > 0, text)
      call check(error, index(text, ">deg/h</text>") > 0 .and. index(text, ">1e+05</text>") > 0, "the second axis")
      call check(error, index(text, "<?xml") == 0 .and. index(text, "<style>") == 0 .and. index(text, "xmlns") == 0, "in a page")
      figure%series(1)%x = [1.2_dp, 1.2_dp, 8.0e3_dp, 8.0e3_dp]
      figure%series(1)%y = [100.0_dp, 1.0_dp, 100.0_dp, 1.0_dp]
      call begin_text(writer)
      call write_svg(writer, figure, .false.)
      call end_text(writer, text)
      call check(error, index(text, ">-1/2</text>"), 0)
   end subroutine test_slopes

   !> Figures of a run: the model, every averaging time, the terms with their numbers, filters, outliers, drift.
   subroutine test_run()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: text(:)

      call make_run(["gx"], record, options, result)
      call take_figures(record, result, "allan series filters", text)
      if (unmet(size(text), 3, "the figures of one channel and no others")) return
      associate (c => result%channel(1))
         call check(error, occurrences(text(1)%text, " data-i=") == size(c%allan(stage%input)%curve%tau) + 3, &
                    "a point for every averaging time, two in the legend, the minimum")
         if (allocated(error)) return
         call expect(1, ">fitted model</text>")
         call expect(1, ">N = ")
         call expect(1, ">lowest reliable ")
         call expect(1, ">AKF output</text>")
         call expect(1, "class=""bar""")
         call expect(2, ">drift (smoother)</text>")
         if (.not. allocated(error)) call check(error, occurrences(text(2)%text, " data-i="), 1 + int(c%clean%removed), "outliers")
         call expect(3, ">cleaned</text>")
         call expect(3, ">KF</text>")
         call expect(3, ">AKF</text>")
         c%allan%noise%described = .false.
         c%drift_doubt = "the innovations are not white"
         call take_figures(record, result, "allan series filters", text)
         call check(error, index(text(1)%text, "fitted model") + index(text(1)%text, "class=""hollow""") == 0, "a model that fails")
         if (.not. allocated(error)) call check(error, index(text(2)%text, ">drift (smoother)</text>"), 0)
      end associate

   contains

      !> A figure holds a text, and nothing that is no number.
      subroutine expect(which, part)
         integer, intent(in) :: which
         character(*), intent(in) :: part

         if (allocated(error)) return
         call check(error, index(text(which)%text, part) > 0, "no "//part)
         call check(error, index(text(which)%text, "NaN") + index(text(which)%text, "Inf"), 0)
      end subroutine expect

   end subroutine test_run

   !> A long series keeps its peaks and has a bounded number of points.
   subroutine test_long()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(named_figure_type), allocatable :: figures(:)
      integer, parameter :: n = 100000

      allocate (record%value(n, 1), record%present(n, 1), result%channel(1))
      allocate (result%channel(1)%allan(6))
      record%value = 0.5_dp
      record%value(77777, 1) = 8.0_dp
      record%value(500:999, 1) = -9.0_dp
      record%present = 1_int8
      record%present(500:999, 1) = 0_int8
      result%channel(1)%name = "gx"
      call build_figures(record, result, figures)
      associate (series => figures(1)%figure%series(1))
         if (unmet(size(series%y) <= 2*max_blocks .and. count(.not. ieee_is_finite(series%y)) >= 1, "points")) return
         call check(error, any(abs(series%x - 77776.0_dp) < 0.5_dp), "the peak's place")
         call check(error, maxval(series%y, mask=ieee_is_finite(series%y)), 8.0_dp, more="the peak")
         call check(error, minval(series%y, mask=ieee_is_finite(series%y)), 0.5_dp, more="a missing sample")
      end associate
   end subroutine test_long

   !> Several channels: names that every file system takes and tells apart, all of them in the overlay of their unit.
   subroutine test_channels()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: text(:)
      integer :: i

      call make_run(["Gx  ", "gX  ", "it's"], record, options, result)
      result%channel(3)%name = "it's/c"
      call take_figures(record, result, "overlay-gx-1 allan-gx-1 series-gx-1 filters-gx-1 allan-gx-2 series-gx-2 filters-gx-2 "// &
                        "allan-it_s_c series-it_s_c filters-it_s_c", text)
      if (unmet(size(text), 10, "the figures and no others")) return
      do i = 1, size(text)
         call check(error, index(text(i)%text, "</svg>") > 0)
      end do
      call check(error, index(text(1)%text, ">Gx</text>") > 0 .and. index(text(1)%text, ">gX</text>") > 0 .and. &
                 index(text(1)%text, ">it&#39;s/c</text>") > 0, "every channel in the overlay")
      allocate (record%channel_unit(3))
      record%channel_unit(1:2) = record%unit
      call parse_unit("m/s^2", record%channel_unit(3), failed)
      call take_figures(record, result, "overlay-gx-1 allan-gx-1 series-gx-1 filters-gx-1 allan-gx-2 series-gx-2 filters-gx-2 "// &
                        "allan-it_s_c series-it_s_c filters-it_s_c", text)
      call check(error, size(text) == 10 .and. occurrences(text(1)%text, "class=""series both") == 2, "the unit of an overlay")
   end subroutine test_channels

   !> No figure of what was not kept or not computed.
   subroutine test_some()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: text(:)

      call make_run(["gx"], record, options, result)
      associate (c => result%channel(1))
         c%allan%available = .false.
         deallocate (c%series_kf, c%series_akf)
      end associate
      call take_figures(record, result, "series", text)
      if (unmet(size(text), 1, "the record alone")) return
      call check(error, index(text(1)%text, ">record</text>") > 0)
   end subroutine test_some

   !> A folder that cannot be made is an error.
   subroutine test_no_folder()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      character(:), allocatable :: folder
      integer :: unit

      folder = scratch_path("file")
      open (newunit=unit, file=folder, status="replace")
      close (unit)
      allocate (result%channel(0))
      call write_results(folder, "run", record, options, result, failed)
      call check(error, allocated(failed), "results in a file")
      call remove_file(folder)
   end subroutine test_no_folder

   !> All files of a run; a later one that writes fewer leaves none of before; nothing appears where one cannot be written.
   subroutine test_results()
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      character(:), allocatable :: folder
      character(20), parameter :: figures(4) = [character(20) :: "figures/allan.svg", "figures/series.svg", &
                                                "figures/filters.svg", "figures/allan-old.svg"]
      integer :: i

      call make_run(["gx"], record, options, result)
      folder = scratch_path("results")
      call check(error, foreign_result(folder) == "", "files of a folder that is not there")
      call make_directory(folder//"/figures/filters.svg", failed)
      call write_results(folder, "run", record, options, result, failed)
      call check(error, allocated(failed), "a folder in the place of the last figure")
      call remove_folder(folder//"/figures/filters.svg")
      if (allocated(failed)) deallocate (failed)
      call check_files("")
      call write_results(folder, "run", record, options, result, failed)
      call check_files("series.csv allan.csv coefficients.csv ar_spectrum.csv correlation.csv spectrum.csv "// &
                       "report.txt results.json report.html figures/allan.svg figures/series.svg figures/filters.svg")
      if (.not. allocated(error)) call check(error, foreign_result(folder) == "", "files of a run are recognized")
      call write_bytes(folder//"/figures/allan-old.svg", read_bytes(folder//"/figures/allan.svg"))
      options%keep_series = .false.
      options%do_ar = .false.
      options%do_tests = .false.
      result%channel(1)%available%correlation = .false.
      deallocate (result%channel(1)%series_kf, result%channel(1)%series_akf)
      call write_results(folder, "allan", record, options, result, failed)
      call check_files("allan.csv coefficients.csv report.txt results.json report.html figures/allan.svg figures/series.svg")
      call write_bytes(folder//"/figures/allan-old.svg", "<svg/>")
      if (.not. allocated(error)) call check(error, foreign_result(folder) == folder//"/figures/allan-old.svg", "another figure")
      call remove_file(folder//"/figures/allan-old.svg")
      call remove_file(folder//"/results.json")
      if (.not. allocated(error)) call check(error, foreign_result(folder) == folder//"/report.txt", &
                                             "a report without its document")
      do i = 1, size(result_files)
         call remove_file(folder//"/"//trim(result_files(i)))
      end do
      do i = 1, size(figures)
         call remove_file(folder//"/"//trim(figures(i)))
      end do
      call remove_folder(folder//"/figures")
      call remove_folder(folder)

   contains

      !> The folder holds these files and no others.
      subroutine check_files(names)
         character(*), intent(in) :: names
         character(:), allocatable :: name
         integer :: k

         if (.not. allocated(error)) call check(error, .not. allocated(failed), "the files of a run")
         do k = 1, size(result_files) + size(figures)
            if (allocated(error)) return
            if (k <= size(result_files)) name = trim(result_files(k))
            if (k > size(result_files)) name = trim(figures(k - size(result_files)))
            call check(error, file_exists(folder//"/"//name) .eqv. index(" "//names//" ", " "//name//" ") > 0, name)
         end do
      end subroutine check_files

   end subroutine test_results

end module test_figures
