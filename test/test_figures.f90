! SPDX-License-Identifier: MIT
!> Figures and result files of a run: every script finds its data, the data are the result's numbers, no file of before is left.
module test_figures
   use testdrive, only : check, error_type, new_unittest, unittest_type
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_pipeline_result, only : stage
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_figures, only : figure_formats, figure_kinds, write_figures
   use gyroakf_report_files, only : foreign_file, result_files, result_marks, write_results
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use scratch_file, only : file_exists, read_bytes, remove_file, remove_folder, scratch_path
   implicit none (type, external)
   private
   public :: collect_figures

   character(1), parameter :: lf = new_line("a")

contains

   !> Names the tests.
   subroutine collect_figures(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("scripts-and-data", test_scripts), &
         new_unittest("numbers", test_numbers), &
         new_unittest("channels", test_channels), &
         new_unittest("what-there-is", test_some), &
         new_unittest("no-folder", test_no_folder), &
         new_unittest("result-files", test_results)]
   end subroutine collect_figures

   !> A run over channels of white noise and a random walk, with lost samples and three outliers; everything is kept.
   subroutine make_run(names, record, options, result)
      character(*), intent(in) :: names(:)
      type(record_type), intent(out) :: record
      type(pipeline_options), intent(out) :: options
      type(pipeline_result_type), intent(out) :: result
      type(simulate_options) :: noise
      type(record_type) :: one
      type(gyro_error), allocatable :: failed
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

   !> Removes the figures of a folder, and the folder.
   subroutine remove_figures(folder, figures)
      character(*), intent(in) :: folder
      type(text_type), intent(in) :: figures(:)
      integer :: i

      do i = 1, size(figures)
         call remove_file(folder//"/"//figures(i)%text//".gp")
         call remove_file(folder//"/"//figures(i)%text//".dat")
      end do
      call remove_folder(folder)
   end subroutine remove_figures

   !> The lines of a block of a data file; all without a name. "" where there is none.
   subroutine take_block(text, name, lines)
      character(*), intent(in) :: text, name
      character(:), allocatable, intent(out) :: lines
      integer :: first, length

      lines = ""
      first = 1
      if (name /= "") then
         first = index(lf//text, lf//"# "//name//lf)
         if (first == 0) return
         first = first + len("# "//name) + 1
      end if
      length = index(text(first:)//lf//lf//lf, lf//lf//lf)
      lines = text(first:min(len(text), first + length - 1))
   end subroutine take_block

   !> Numbers of a column of a block.
   subroutine take_column(lines, column, values)
      character(*), intent(in) :: lines
      integer, intent(in) :: column
      real(dp), allocatable, intent(out) :: values(:)
      real(dp) :: row(8)
      integer :: first, last, failed

      allocate (values(0))
      first = 1
      do while (first <= len(lines))
         last = first + index(lines(first:)//lf, lf) - 2
         row = huge(1.0_dp)
         if (last >= first) then
            read (lines(first:last), *, iostat=failed) row(:column)
            if (failed == 0) values = [values, row(column)]
         end if
         first = last + 2
      end do
   end subroutine take_column

   !> Of every "'FILE' index 'NAME' using 1:2" of a script: the file is there, the block has lines, these have the columns.
   subroutine check_script(folder, name, error)
      character(*), intent(in) :: folder, name
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: script, file, rest, block, lines
      real(dp), allocatable :: values(:)
      integer :: at, next, plots, column

      script = read_bytes(folder//"/"//name//".gp")
      file = ""
      plots = 0
      do
         at = scan(script, lf)
         if (at == 0) exit
         rest = script(:at - 1)
         script = script(at + 1:)
         next = index(rest, "'")
         if (next == 0 .or. (index(rest, "plot '") /= 1 .and. index(rest, "     '") /= 1)) cycle
         rest = rest(next + 1:)
         if (rest(1:1) /= "'") file = folder//"/"//rest(:index(rest, "'") - 1)
         call check(error, file_exists(file), name//": no "//file)
         if (allocated(error)) return
         block = ""
         if (index(rest, " index '") > 0) block = rest(index(rest, " index '") + 8:)
         if (block /= "") block = block(:index(block, "'") - 1)
         column = 2
         if (index(rest, "using 1:") > 0) column = ichar(rest(index(rest, "using 1:") + 8:)) - ichar("0")
         if (index(rest, "using 1:3:4") > 0) column = 4
         call take_block(read_bytes(file), block, lines)
         call take_column(lines, column, values)
         call check(error, size(values) > 0, name//": no column "//achar(column + ichar("0"))//" of '"//block//"'")
         if (allocated(error)) return
         plots = plots + 1
      end do
      call check(error, plots > 0, name//": draws nothing")
   end subroutine check_script

   !> A run has all figures, in every format, and each finds what it draws.
   subroutine test_scripts(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: figures(:)
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: folder, script
      integer :: f, i

      call make_run(["gx"], record, options, result)
      folder = scratch_path("figures")
      do f = 1, size(figure_formats)
         call write_figures(folder//"/plots", figure_formats(f), record, options, result, figures, failed)
         call check(error, .not. allocated(failed) .and. size(figures) == size(figure_kinds), "figures of a whole run")
         do i = 1, size(figures)
            if (allocated(error)) exit
            call check(error, figures(i)%text == trim(figure_kinds(i)), "order and names of the figures")
            if (.not. allocated(error)) call check_script(folder//"/plots", figures(i)%text, error)
            if (allocated(error)) exit
            script = read_bytes(folder//"/plots/"//figures(i)%text//".gp")
            call check(error, index(script, "figure = '"//figures(i)%text//"."//figure_formats(f)//"'") > 0 .and. &
                       index(script, "set terminal "//figure_formats(f)) > 0, "format "//figure_formats(f))
         end do
         call remove_figures(folder//"/plots", figures)
         if (allocated(error)) exit
      end do
      call remove_folder(folder)
   end subroutine test_scripts

   !> What is drawn is what came out.
   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: figures(:)
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: folder

      call make_run(["gx"], record, options, result)
      folder = scratch_path("figures")
      call write_figures(folder, "svg", record, options, result, figures, failed)
      associate (c => result%channel(1), curve => result%channel(1)%allan(stage%input)%curve)
         call compare("allan", "input", 1, curve%tau)
         call compare("allan", "input", 2, curve%deviation)
         call compare("allan", "input", 3, curve%lower)
         call compare("allan", "input", 4, curve%upper)
         call compare("allan", "akf", 2, c%allan(stage%akf)%curve%deviation)
         call compare("series", "raw", 2, pack(record%value(:, 1), record%present(:, 1) /= 0_int8))
         call compare("series", "cleaned", 2, pack(c%series_cleaned, c%series_present /= 0_int8))
         call compare("series", "drift", 2, c%series_drift)
         call compare("series", "outliers", 2, pack(record%value(:, 1), record%present(:, 1) /= 0_int8 .and. &
                                                   c%series_present == 0_int8))
         call compare("histogram", "", 2, c%histogram%density)
         call compare("histogram", "", 4, c%histogram%normal_density)
         call compare("correlation", "autocorrelation", 2, c%correlation%acf(1:c%correlation%lags))
         call compare("correlation", "partial", 2, c%correlation%pacf(1:c%correlation%partial_lags))
         call compare("residuals", "autocorrelation", 2, c%ar%residual_correlation%acf(1:c%ar%residual_correlation%lags))
         call compare("spectrum", "welch", 2, pack(c%spectrum%density, c%spectrum%frequency > 0))
         if (.not. allocated(error)) call check(error, c%clean%removed >= 3, "the outliers were not found")
      end associate
      call remove_figures(folder, figures)

   contains

      !> A column of the data of a figure against the numbers it should have, which have ten digits there.
      subroutine compare(name, block, column, expected)
         character(*), intent(in) :: name, block
         integer, intent(in) :: column
         real(dp), intent(in) :: expected(:)
         character(:), allocatable :: lines
         real(dp), allocatable :: values(:)

         if (allocated(error)) return
         call take_block(read_bytes(folder//"/"//name//".dat"), block, lines)
         call take_column(lines, column, values)
         call check(error, size(values) == size(expected) .and. size(values) > 0, name//" "//block//": other lines")
         if (allocated(error)) return
         call check(error, all(abs(values - expected) <= 1.0e-9_dp*abs(expected)), name//" "//block//": other numbers")
      end subroutine compare

   end subroutine test_numbers

   !> Several channels have a figure each, named in letters that every file system takes and tells apart.
   subroutine test_channels(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: figures(:)
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: folder
      character(8), parameter :: ending(3) = [character(8) :: "-gx-1", "-gx-2", "-it_s_c"]
      integer :: c, i

      call make_run(["Gx  ", "gX  ", "it's" ], record, options, result)
      result%channel(3)%name = "it's/c"
      folder = scratch_path("figures")
      call write_figures(folder, "svg", record, options, result, figures, failed)
      call check(error, size(figures) == 3*size(figure_kinds), "a figure of each channel")
      do c = 1, 3
         do i = 1, size(figure_kinds)
            if (allocated(error)) exit
            associate (name => figures((c - 1)*size(figure_kinds) + i)%text)
               call check(error, name == trim(figure_kinds(i))//trim(ending(c)), "the name "//name)
               if (.not. allocated(error)) call check_script(folder, name, error)
            end associate
         end do
      end do
      if (.not. allocated(error)) call check(error, index(read_bytes(folder//"/allan-it_s_c.gp"), "of it''s/c'") > 0, &
                                             "a quote in a title")
      call remove_figures(folder, figures)
   end subroutine test_channels

   !> No figure of what was not kept or not computed.
   subroutine test_some(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: figures(:)
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: folder
      integer :: i

      call make_run(["gx"], record, options, result)
      folder = scratch_path("figures")
      options%keep_series = .false.
      call write_figures(folder, "svg", record, options, result, figures, failed)
      call check(error, all([(figures(i)%text /= "series" .and. figures(i)%text /= "filters", i=1, size(figures))]), &
                 "series that were not kept")
      if (.not. allocated(error)) call check(error, size(figures) == size(figure_kinds) - 2, "all others")
      call remove_figures(folder, figures)
      if (allocated(error)) return
      associate (c => result%channel(1))
         c%allan(stage%outliers_removed:)%available = .false.
         c%available%akf = .false.
         c%available%drift_akf = .false.
         c%available%ar = .false.
         c%available%histogram = .false.
         c%available%correlation = .false.
         c%available%spectrum = .false.
      end associate
      call write_figures(folder, "svg", record, options, result, figures, failed)
      call check(error, size(figures) == 1, "one curve alone")
      if (.not. allocated(error)) call check(error, figures(1)%text == "allan", "the curve of the record")
      if (.not. allocated(error)) call check_script(folder, "allan", error)
      call remove_figures(folder, figures)
   end subroutine test_some

   !> A folder that cannot be made is an error of both.
   subroutine test_no_folder(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(text_type), allocatable :: figures(:)
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: folder
      integer :: unit

      folder = scratch_path("file")
      open (newunit=unit, file=folder, status="replace")
      close (unit)
      allocate (result%channel(0))
      call write_figures(folder, "svg", record, options, result, figures, failed)
      call check(error, allocated(failed), "figures in a file")
      if (.not. allocated(error)) then
         call write_results(folder, "run", record, options, result, failed)
         call check(error, allocated(failed), "results in a file")
      end if
      call remove_file(folder)
   end subroutine test_no_folder

   !> All files of a run; a later one that writes fewer leaves none of before.
   subroutine test_results(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: folder
      integer :: i

      call make_run(["gx"], record, options, result)
      folder = scratch_path("results")
      call check(error, foreign_file(folder, result_files, result_marks) == "", "files of a folder that is not there")
      if (allocated(error)) return
      call write_results(folder, "run", record, options, result, failed)
      call check_files("series.csv allan.csv coefficients.csv ar_spectrum.csv correlation.csv histogram.csv spectrum.csv "// &
                       "report.txt results.json")
      if (.not. allocated(error)) call check(error, foreign_file(folder, result_files, result_marks) == "", &
                                             "files of a run are recognized")
      options%keep_series = .false.
      options%do_ar = .false.
      options%do_tests = .false.
      result%channel(1)%available%correlation = .false.
      call write_results(folder, "allan", record, options, result, failed)
      call check_files("allan.csv coefficients.csv report.txt results.json")
      call remove_file(folder//"/results.json")
      if (.not. allocated(error)) call check(error, foreign_file(folder, result_files, result_marks) == folder//"/report.txt", &
                                             "a report without its document")
      do i = 1, size(result_files)
         call remove_file(folder//"/"//trim(result_files(i)))
      end do
      call remove_folder(folder)

   contains

      !> The folder holds these files and no others.
      subroutine check_files(names)
         character(*), intent(in) :: names
         character(:), allocatable :: name
         integer :: k

         if (.not. allocated(error)) call check(error, .not. allocated(failed), "the files of a run")
         do k = 1, size(result_files)
            if (allocated(error)) return
            name = trim(result_files(k))
            call check(error, file_exists(folder//"/"//name) .eqv. index(" "//names//" ", " "//name//" ") > 0, name)
         end do
      end subroutine check_files

   end subroutine test_results

end module test_figures
