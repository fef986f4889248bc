! SPDX-License-Identifier: MIT
!> Many files: each is processed independently, one after the other, then all are summarized.
module gyroakf_app_many
   use, intrinsic :: iso_fortran_env, only : error_unit
   use gyroakf_error, only : error_type, exit_code, status
   use gyroakf_pipeline, only : pipeline_result_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_summary, only : summarise, summarise_failure, summary_row_type
   use gyroakf_app_check, only : check_existing, is_result
   use gyroakf_app_config, only : analysis_config, inspect_config, reading_config
   use gyroakf_app_file_list, only : read_list
   use gyroakf_app_folders, only : name_folders, summary_files
   use gyroakf_app_interrupt, only : guard_files, release_files
   use gyroakf_app_job, only : analyze, inspect
   use gyroakf_app_progress_bar, only : bar_type, clear_bar
   use gyroakf_app_reading, only : with_path
   use gyroakf_app_summary, only : write_summary
   use gyroakf_app_words, only : usage_error
   implicit none (type, external)
   private
   public :: work_on_many

contains

   !> Processes all files of a command line and of its list.
   subroutine work_on_many(config, bar, code, error)
      !> Its `paths` and `list`
      class(reading_config), intent(in) :: config
      !> Progress of the file in work
      type(bar_type), intent(inout) :: bar
      !> The highest exit status of all files
      integer, intent(out) :: code
      !> What prevents all of them: usage, io, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(reading_config), allocatable :: job
      type(text_type), allocatable :: paths(:), folders(:)
      type(summary_row_type), allocatable :: rows(:)
      integer :: i

      code = 0
      allocate (job, source=config)
      call gather_files(job, paths, folders, error)
      if (allocated(error)) return
      allocate (rows(size(paths)))
      do i = 1, size(rows)
         call work_on_one(job, paths(i)%text, folders(i)%text, bar, rows(i), error)
         call clear_bar(bar)
         if (allocated(error)) return
         code = max(code, rows(i)%code)
         if (rows(i)%code /= 0) write (error_unit, "(a)") "gyroakf: error: "//rows(i)%message
      end do
      call guard_files()
      call write_summary(config, rows, error)
      call release_files()
   end subroutine work_on_many

   !> One file; its failure is in its row.
   subroutine work_on_one(config, path, folder, bar, row, error)
      class(reading_config), intent(in) :: config
      character(*), intent(in) :: path, folder
      type(bar_type), intent(inout) :: bar
      type(summary_row_type), intent(out) :: row
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      class(reading_config), allocatable :: job
      type(record_type) :: record
      type(pipeline_result_type) :: result

      allocate (job, source=config)
      call prepare_one(job, path, folder)
      select type (job)
      type is (inspect_config)
         call inspect(job, bar, record, error)
         if (.not. allocated(error)) call summarise(job%command, path, folder, record, row)
      type is (analysis_config)
         call analyze(job, bar, record, result, error)
         if (.not. allocated(error)) call summarise(job%command, path, folder, record, row, result)
      end select
      if (.not. allocated(error)) return
      if (error%code == status%cancelled) return
      call summarise_failure(config%command, path, "", exit_code(error%code), with_path(path, error%message), row)
      deallocate (error)
   end subroutine work_on_one

   !> The files and their folders.
   subroutine gather_files(config, paths, folders, error)
      !> Its `paths` are moved out
      class(reading_config), intent(inout) :: config
      !> The files, and the folders of their results, "" where none are written: [number of files]
      type(text_type), allocatable, intent(out) :: paths(:), folders(:)
      !> usage, io, parse
      type(error_type), allocatable, intent(out) :: error
      class(reading_config), allocatable :: job
      integer :: i, j
      logical :: forbidden

      call move_alloc(config%paths, paths)
      if (allocated(config%list)) then
         call read_list(config%list, paths, error)
         if (allocated(error)) return
      end if
      if (.not. allocated(config%out)) then
         allocate (folders(size(paths)))
         do i = 1, size(paths)
            folders(i)%text = ""
         end do
         return
      end if
      do while (len(config%out) > 1 .and. index(config%out, "/", back=.true.) == len(config%out))
         config%out = config%out(:len(config%out) - 1)
      end do
      call name_folders(paths, folders)
      do i = 1, size(paths)
         folders(i)%text = config%out//"/"//folders(i)%text
         forbidden = is_result(folders(i)%text, paths(i)%text)
         do j = 1, size(summary_files)
            if (paths(i)%text == config%out//"/"//trim(summary_files(j))) forbidden = .true.
         end do
         if (forbidden) call usage_error(error, "--out would overwrite the recording '"//paths(i)%text//"'")
         if (allocated(error)) return
         allocate (job, source=config)
         call prepare_one(job, paths(i)%text, folders(i)%text)
         call check_existing(job, error)
         if (allocated(error)) return
         deallocate (job)
      end do
   end subroutine gather_files

   !> The configuration of one file alone.
   subroutine prepare_one(config, path, folder)
      class(reading_config), intent(inout) :: config
      character(*), intent(in) :: path, folder

      config%path = path
      config%quiet = .true.
      if (allocated(config%json)) deallocate (config%json)
      if (allocated(config%list)) deallocate (config%list)
      if (allocated(config%options_file)) deallocate (config%options_file)
      if (allocated(config%out)) config%out = folder
      select type (config)
      type is (analysis_config)
         if (allocated(config%kalibr)) config%kalibr = folder//"/"//config%kalibr
         if (allocated(config%latex)) config%latex = folder//"/"//config%latex
      end select
   end subroutine prepare_one

end module gyroakf_app_many
