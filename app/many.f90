! SPDX-License-Identifier: MIT
!> Many files: each is processed independently, one after the other, then all are summarized: into
!> the folder of `--out`, the file of `--json`, and to standard output.
module gyroakf_app_many
   use, intrinsic :: iso_fortran_env, only : error_unit
   use gyroakf_utf8, only : make_readable
   use gyroakf_error, only : error_type, exit_code, status
   use gyroakf_io_writer, only : commit_writer, complete_writer, make_directory, open_writer, &
      writer_type
   use gyroakf_pipeline, only : pipeline_result_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_summary, only : summarize, summary_row_type, write_summary_csv, &
      write_summary_json, write_summary_table
   use gyroakf_app_check, only : check_existing, is_result
   use gyroakf_app_config, only : config_type
   use gyroakf_app_file_list, only : name_folders, read_list, summary_files
   use gyroakf_app_job, only : do_job
   use gyroakf_app_option, only : name_options
   use gyroakf_app_progress_bar, only : bar_type, clear_bar
   use gyroakf_app_reading, only : with_path
   use gyroakf_app_system, only : end_writers, guard_files, open_report
   use gyroakf_app_words, only : usage_error
   implicit none (type, external)
   private
   public :: work_on_many

contains

   !> Processes all files of a command line and of its list.
   subroutine work_on_many(config, bar, code, error)
      !> Its `paths` and `list`
      type(config_type), intent(in) :: config
      !> Progress of the file in work
      type(bar_type), intent(inout) :: bar
      !> The highest exit status of all files
      integer, intent(out) :: code
      !> What prevents all of them: usage, io, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(text_type), allocatable :: paths(:), folders(:)
      type(summary_row_type), allocatable :: rows(:)
      type(config_type) :: job
      integer :: i

      code = 0
      call gather_files(config, paths, folders, error)
      if (allocated(error)) return
      allocate (rows(size(paths)))
      do i = 1, size(rows)
         call prepare_job(config, paths(i)%text, folders(i)%text, job)
         call work_on_one(job, bar, rows(i), error)
         call clear_bar(bar)
         if (allocated(error)) return
         code = max(code, rows(i)%code)
         if (rows(i)%code == 0) cycle
         call make_readable(rows(i)%message, lines=.true.)
         write (error_unit, "(a)") "gyroakf: error: "//rows(i)%message
      end do
      call guard_files(.true.)
      call write_files(config, rows, error)
      call guard_files(.false.)
      if (.not. allocated(error)) call print_summary(config, rows, error)
   end subroutine work_on_many

   !> One file; its failure is in its row.
   subroutine work_on_one(job, bar, row, error)
      type(config_type), intent(in) :: job
      type(bar_type), intent(inout) :: bar
      type(summary_row_type), intent(out) :: row
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, unread
      type(pipeline_result_type) :: result

      call do_job(job, bar, record, result, error)
      if (.not. allocated(error)) then
         if (job%command == "inspect") then
            call summarize(job%command, job%path, job%out, record, row)
         else
            call summarize(job%command, job%path, job%out, record, row, result)
         end if
         return
      end if
      if (error%code == status%cancelled) return
      call name_options(error%message)
      call summarize(job%command, job%path, "", unread, row, code=exit_code(error%code), &
                     message=with_path(job%path, error%message))
      deallocate (error)
   end subroutine work_on_one

   subroutine gather_files(config, paths, folders, error)
      type(config_type), intent(in) :: config
      !> The files, and the folders of their results, "" where none are written: [number of files]
      type(text_type), allocatable, intent(out) :: paths(:), folders(:)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: out
      type(config_type) :: job
      integer :: i

      paths = config%paths
      if (config%list /= "") call read_list(config%list, paths, error)
      if (allocated(error)) return
      call name_folders(paths, folders)
      out = config%out(:min(len(config%out), max(1, verify(config%out, "/", back=.true.))))
      do i = 1, size(paths)
         if (out == "") then
            folders(i)%text = ""
            cycle
         end if
         folders(i)%text = out//"/"//folders(i)%text
         if (is_result(folders(i)%text, paths(i)%text) .or. &
             any(paths(i)%text == out//"/"//summary_files)) then
            call usage_error(error, "--out would overwrite the recording '"//paths(i)%text//"'")
         else
            call prepare_job(config, paths(i)%text, folders(i)%text, job)
            call check_existing(job, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine gather_files

   subroutine prepare_job(config, path, folder, job)
      type(config_type), intent(in) :: config
      character(*), intent(in) :: path, folder
      type(config_type), intent(out) :: job

      job = config
      job%path = path
      job%paths = config%paths(:0)
      job%list = ""
      job%options_file = ""
      job%quiet = .true.
      job%out = folder
      job%file(1)%text = ""
      if (job%file(2)%text /= "") job%file(2)%text = folder//"/"//job%file(2)%text
   end subroutine prepare_job

   subroutine print_summary(config, rows, error)
      type(config_type), intent(in) :: config
      type(summary_row_type), intent(in) :: rows(:)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      logical :: as_json

      as_json = config%file(1)%text == "-"
      if (config%quiet .and. .not. as_json) return
      call open_report(writer, config%color, config%ascii, error)
      if (allocated(error)) return
      if (as_json) call write_summary_json(writer, config%command, rows)
      if (.not. as_json) call write_summary_table(writer, rows)
      call commit_writer(writer, error)
   end subroutine print_summary

   !> The summary's files: all are complete before the first one appears.
   subroutine write_files(config, rows, error)
      type(config_type), intent(in) :: config
      type(summary_row_type), intent(in) :: rows(:)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer(3)
      type(text_type) :: path(3)
      integer :: i

      path(1)%text = config%out//"/"//trim(summary_files(1))
      path(2)%text = config%out//"/"//trim(summary_files(2))
      path(3)%text = config%file(1)%text
      if (config%out /= "") call make_directory(config%out, error)
      do i = merge(3, 1, config%out == ""), size(writer)
         if (allocated(error) .or. any(path(i)%text == ["-", " "])) cycle
         call open_writer(writer(i), path(i)%text, error)
         if (allocated(error)) cycle
         if (i == 1) call write_summary_csv(writer(i), rows)
         if (i > 1) call write_summary_json(writer(i), config%command, rows)
         call complete_writer(writer(i), error)
      end do
      call end_writers(writer, error)
   end subroutine write_files

end module gyroakf_app_many
