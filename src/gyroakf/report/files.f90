! SPDX-License-Identifier: MIT
!> The result files of `--out DIR`: all are written aside first and renamed when the last one is complete.
module gyroakf_report_files
   use gyroakf_error, only : error_type
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type, open_writer, complete_writer, commit_writer, discard_writer, make_directory
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_report_text, only : write_report
   use gyroakf_report_document, only : write_document
   use gyroakf_report_csv, only : write_series, write_allan, write_coefficients, write_dynamic
   implicit none (type, external)
   private
   public :: write_results, result_files

   !> In the order in which they are written
   character(16), parameter :: result_files(6) = [character(16) :: "series.csv", "allan.csv", "coefficients.csv", &
                                                  "dynamic.csv", "report.txt", "results.json"]

contains

   !> Writes series.csv (where the series were kept), allan.csv and coefficients.csv (where there are curves), dynamic.csv
   !> (where it was asked for), report.txt and results.json.
   subroutine write_results(directory, command, record, options, result, error)
      !> Made where it does not exist
      character(*), intent(in) :: directory
      !> Which report: run, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> io: a file cannot be written; no file of an earlier run is touched then, unless a rename failed
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer(size(result_files))
      logical :: wanted(size(result_files))
      integer :: i

      call make_directory(directory, error)
      if (allocated(error)) return
      wanted = [options%keep_series .and. .not. record%streamed, options%do_allan, options%do_allan, &
                options%do_allan .and. options%dynamic_segments > 0, .true., .true.]
      do i = 1, size(result_files)
         if (wanted(i)) call open_writer(writer(i), directory//"/"//trim(result_files(i)), error)
         if (allocated(error)) then
            call discard_all(writer, wanted, i - 1)
            return
         end if
         if (wanted(i)) call write_file(writer(i), i, command, record, options, result)
         if (wanted(i)) call complete_writer(writer(i), error)
         if (allocated(error)) then
            call discard_all(writer, wanted, i)
            return
         end if
      end do
      do i = 1, size(result_files)
         if (wanted(i)) call commit_writer(writer(i), error)
         if (.not. allocated(error)) cycle
         call discard_all(writer, wanted, size(result_files))
         return
      end do
   end subroutine write_results

   !> Content of one file.
   subroutine write_file(writer, which, command, record, options, result)
      type(writer_type), intent(inout) :: writer
      integer, intent(in) :: which
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(pipeline_options), intent(in) :: options
      type(pipeline_result_type), intent(in) :: result

      select case (which)
      case (1); call write_series(writer, record, result)
      case (2); call write_allan(writer, result)
      case (3); call write_coefficients(writer, result)
      case (4); call write_dynamic(writer, result)
      case (5); call write_report(writer, command, record, options, result)
      case default; call write_document(writer, record, result)
      end select
   end subroutine write_file

   !> Forgets the files that were begun.
   subroutine discard_all(writer, wanted, last)
      type(writer_type), intent(inout) :: writer(:)
      logical, intent(in) :: wanted(:)
      integer, intent(in) :: last
      integer :: i

      do i = 1, last
         if (wanted(i)) call discard_writer(writer(i))
      end do
   end subroutine discard_all

end module gyroakf_report_files
