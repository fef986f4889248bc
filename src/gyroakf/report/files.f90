! SPDX-License-Identifier: MIT
!> The result files of `--out DIR`: all are written aside first and renamed when the last one is
!> complete.
module gyroakf_report_files
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type, open_writer, complete_writer, commit_writer, &
      discard_writer, is_file, make_directory, remove_file
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_report_text_report, only : write_report
   use gyroakf_report_document, only : write_document
   use gyroakf_report_figures, only : build_figures, figure_folder, find_figures, name_length, &
      named_figure_type
   use gyroakf_report_html_page, only : write_page
   use gyroakf_report_svg, only : svg_mark, write_svg
   use gyroakf_report_csv, only : series_output_type, write_series, write_table
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   implicit none (type, external)
   private
   public :: write_results, remove_others, result_files, foreign_result, foreign_file, is_marked, &
      series_output_type, after_dots, is_same_file

   !> In the order in which they are written; one of the first three
   character(16), parameter :: result_files(11) = [character(16) :: "series.csv", "series.npy", &
      "series.f64", "allan.csv", "coefficients.csv", "ar_spectrum.csv", "correlation.csv", &
      "spectrum.csv", "report.txt", "results.json", "report.html"]

   !> Stands in every JSON document of gyroakf
   character(*), parameter, public :: document_mark = new_line("a")//'  "program": "gyroakf"'

   !> What stands in the result files; of those without a mark, in results.json, which has the
   !> command line
   character(23), parameter :: result_marks(11) = [character(23) :: "drift_akf", &
      "--series-format", "--series-format", "channel,series,kind,tau", "channel,series,term", &
      "channel,frequency", "channel,lag", "channel,frequency", document_mark, document_mark, &
      'content="gyroakf ']
   character(10), parameter :: unmarked(3) = ["series.npy", "series.f64", "report.txt"]

   interface
      !> Whether two paths lead to one file; the first may be "-"
      function same_file(a, b) result(same) bind(C, name="gyroakf_host_same_file")
         import :: c_char, c_int
         implicit none (type, external)
         !> Both end with a NUL
         character(kind=c_char), intent(in) :: a(*), b(*)
         integer(c_int) :: same
      end function same_file
   end interface

contains

   !> The first result file or figure in a directory that is not recognized as written by gyroakf,
   !> "" where there is none.
   function foreign_result(directory) result(path)
      !> May be missing
      character(*), intent(in) :: directory
      character(:), allocatable :: path
      character(name_length), allocatable :: names(:), marks(:)

      call list_results(directory, names, marks)
      path = foreign_file(directory, names, marks)
   end function foreign_result

   !> Names of the result files, and of the figures that are there, with the mark of each.
   subroutine list_results(directory, names, marks)
      character(*), intent(in) :: directory
      character(name_length), allocatable, intent(out) :: names(:), marks(:)
      character(name_length), allocatable :: figures(:)

      call find_figures(directory, figures)
      names = [[character(name_length) :: result_files], figures]
      allocate (marks(size(names)))
      marks = svg_mark
      marks(:size(result_marks)) = result_marks
   end subroutine list_results

   !> The first file of a set in a directory that is not recognized as written by gyroakf, "" where
   !> there is none.
   function foreign_file(directory, names, marks) result(path)
      !> May be missing
      character(*), intent(in) :: directory
      !> Of the files, and what stands in each: [number of files]
      character(*), intent(in) :: names(:), marks(:)
      character(:), allocatable :: path, marked
      integer :: i

      do i = 1, size(names)
         path = directory//"/"//trim(names(i))
         marked = path
         if (any(names(i) == unmarked)) marked = directory//"/results.json"
         if (is_file(path) .and. .not. is_marked(marked, trim(marks(i)))) return
      end do
      path = ""
   end function foreign_file

   !> Whether a mark of gyroakf stands in the first 256 KiB of a file.
   logical function is_marked(path, mark)
      !> A regular file, and the mark
      character(*), intent(in) :: path, mark
      character(:), allocatable :: head
      integer(int64) :: length
      integer :: unit, failed

      is_marked = .false.
      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
            action="read", iostat=failed)
      if (failed /= 0) return
      inquire (unit=unit, size=length)
      allocate (character(min(length, 262144_int64)) :: head)
      read (unit, iostat=failed) head
      is_marked = failed == 0 .and. index(head, mark) > 0
      close (unit)
   end function is_marked

   !> Removes the results of an earlier run that a new one does not replace, so that no old numbers
   !> stand beside new ones.
   subroutine remove_others(directory, written)
      !> Of the results
      character(*), intent(in) :: directory
      !> Names of the files that the run writes
      character(*), intent(in) :: written(:)
      character(name_length), allocatable :: names(:), marks(:)
      integer :: i

      call list_results(directory, names, marks)
      do i = 1, size(names)
         if (any(written == names(i))) cycle
         if (foreign_file(directory, names(i:i), marks(i:i)) /= "") cycle
         call remove_file(directory//"/"//trim(names(i)))
      end do
   end subroutine remove_others

   !> Writes the series (where they were kept), allan.csv and coefficients.csv (where there are
   !> curves), ar_spectrum.csv (where there are AR models), correlation.csv and spectrum.csv (where
   !> there are tests), report.txt, results.json, report.html and the figures; all appear when the
   !> last one is complete. Those that an earlier run left and this one does not write are removed.
   subroutine write_results(directory, command, record, options, result, error, output, progress, &
                            command_line, chart)
      !> Made where it does not exist
      character(*), intent(in) :: directory
      !> Which report: run, allan, tests, ar, filter
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      type(pipeline_result_type), intent(in) :: result
      !> io if a file cannot be written; no file of an earlier run is touched then, unless a rename
      !> failed; no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Form of the series; series.csv if absent
      type(series_output_type), intent(in), optional :: output
      !> Progress callback, while the series are written
      class(progress_type), intent(inout), optional :: progress
      !> As it would be typed, for results.json and report.html
      character(*), intent(in), optional :: command_line
      !> Draw the Allan deviations in report.txt (default: yes)
      logical, intent(in), optional :: chart
      type(named_figure_type), allocatable :: figures(:)
      type(writer_type), allocatable :: writer(:)
      type(series_output_type) :: series
      logical :: wanted(size(result_files))
      character(name_length), allocatable :: names(:)
      integer :: i, n

      if (present(output)) series = output
      call build_figures(record, result, figures)
      call make_directory(directory, error)
      if (allocated(error)) return
      if (size(figures) > 0) call make_directory(directory//"/"//figure_folder, error)
      if (allocated(error)) return
      wanted(:3) = options%keep_series .and. [character(3) :: "csv", "npy", "f64"] == series%form
      wanted(4:) = [options%do_allan, options%do_allan, options%do_ar, &
                    any(result%channel%available%correlation), &
                    options%do_tests .and. any(result%channel%available%spectrum), &
                    .true., .true., .true.]
      n = count(wanted)
      allocate (names(n + size(figures)), writer(n + size(figures)))
      names(:n) = pack(result_files, wanted)
      do i = 1, size(names)
         if (i > n) names(i) = figures(i - n)%name
         call open_writer(writer(i), directory//"/"//trim(names(i)), error)
         if (allocated(error)) exit
         select case (names(i))
         case ("report.txt"); call write_report(writer(i), command, record, options, result, chart)
         case ("results.json"); call write_document(writer(i), record, result, command_line)
         case ("report.html")
            call write_page(writer(i), command, record, result, figures, command_line)
         case ("series.csv", "series.npy", "series.f64")
            call write_series(writer(i), record, result, series, error, progress)
         case default
            if (i > n) call write_svg(writer(i), figures(i - n)%figure, .true.)
            if (i <= n) call write_table(writer(i), trim(names(i)), result, record%sample_interval)
         end select
         if (.not. allocated(error)) call complete_writer(writer(i), error)
         if (allocated(error)) exit
         deallocate (writer(i)%buffer)
      end do
      if (.not. allocated(error)) call remove_others(directory, names)
      do i = 1, size(names)
         if (.not. allocated(error)) call commit_writer(writer(i), error)
         if (allocated(error)) call discard_writer(writer(i))
      end do
   end subroutine write_results

   !> Whether two paths name the same file, which need not be there, or lead to the same.
   logical function is_same_file(a, b)
      !> Any path, "-" for what is on standard input, "" for none
      character(*), intent(in) :: a
      !> Any path
      character(*), intent(in) :: b

      is_same_file = .false.
      if (a == "" .or. b == "") return
      is_same_file = a(after_dots(a):) == b(after_dots(b):)
      if (is_same_file .or. b == "-") return
      is_same_file = same_file(a//c_null_char, b//c_null_char) /= 0
   end function is_same_file

   !> Where a path begins behind "./" in front.
   pure integer function after_dots(path) result(first)
      !> Any path
      character(*), intent(in) :: path

      first = 1
      do while (index(path(first:), "./") == 1)
         first = first + 2
      end do
   end function after_dots

end module gyroakf_report_files
