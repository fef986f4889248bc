! SPDX-License-Identifier: MIT
!> Writes the summary of many files: into the folder of `--out`, the file of `--json`, and to standard output.
module gyroakf_app_summary
   use gyroakf_error, only : error_type
   use gyroakf_io_writer, only : commit_writer, complete_writer, discard_writer, make_directory, open_writer, writer_type
   use gyroakf_report_summary, only : summary_row_type, write_summary_csv, write_summary_json, write_summary_table
   use gyroakf_app_config, only : reading_config
   use gyroakf_app_folders, only : summary_files
   use gyroakf_app_terminal, only : adapt_writer
   implicit none (type, external)
   private
   public :: write_summary

contains

   !> The files first, standard output last.
   subroutine write_summary(config, rows, error)
      !> `out`, `json`, `quiet`
      class(reading_config), intent(in) :: config
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      !> io
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      logical :: as_json

      call write_files(config, rows, error)
      as_json = .false.
      if (allocated(config%json)) as_json = config%json == "-"
      if (allocated(error) .or. (config%quiet .and. .not. as_json)) return
      call open_writer(writer, "-", error)
      if (allocated(error)) return
      if (as_json) then
         call write_summary_json(writer, config%command, rows)
      else
         call adapt_writer(writer, config%colour, config%ascii)
         call write_summary_table(writer, config%command, rows)
      end if
      call commit_writer(writer, error)
   end subroutine write_summary

   !> All files are complete before the first one appears.
   subroutine write_files(config, rows, error)
      class(reading_config), intent(in) :: config
      type(summary_row_type), intent(in) :: rows(:)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer(3)
      integer :: i

      if (allocated(config%out)) then
         call make_directory(config%out, error)
         if (.not. allocated(error)) call open_writer(writer(1), config%out//"/"//trim(summary_files(1)), error)
         if (.not. allocated(error)) call write_summary_csv(writer(1), rows)
         if (.not. allocated(error)) call begin_json(writer(2), config%out//"/"//trim(summary_files(2)), config%command, &
                                                     rows, error)
      end if
      if (allocated(config%json) .and. .not. allocated(error)) then
         if (config%json /= "-") call begin_json(writer(3), config%json, config%command, rows, error)
      end if
      do i = 1, size(writer)
         if (.not. allocated(error)) call complete_writer(writer(i), error)
      end do
      do i = 1, size(writer)
         if (.not. allocated(error) .and. writer(i)%complete) call commit_writer(writer(i), error)
      end do
      if (.not. allocated(error)) return
      do i = 1, size(writer)
         call discard_writer(writer(i))
      end do
   end subroutine write_files

   !> The document in a file that is not yet in its place.
   subroutine begin_json(writer, path, command, rows, error)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: path, command
      type(summary_row_type), intent(in) :: rows(:)
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, path, error)
      if (.not. allocated(error)) call write_summary_json(writer, command, rows)
   end subroutine begin_json

end module gyroakf_app_summary
