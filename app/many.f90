! SPDX-License-Identifier: MIT
!> Many files: each is worked on as if it were alone, some of them side by side, then all are summed up.
!>
!> A file's results do not depend on the others: a process has its share of the memory, and a file that does not fit into the share
!> is worked on later with all of it.
module gyroakf_app_many
   use, intrinsic :: iso_fortran_env, only : error_unit
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, exit_code, fatal_error, status
   use gyroakf_io_recording, only : base_bytes
   use gyroakf_pipeline, only : pipeline_result_type
   use gyroakf_io_writer, only : is_file
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_files, only : existing_result
   use gyroakf_report_summary, only : summarise, summarise_failure, summary_row_type
   use gyroakf_app_check, only : is_result, keep_file
   use gyroakf_app_config, only : analysis_config, inspect_config, reading_config
   use gyroakf_app_file_list, only : read_list
   use gyroakf_app_folders, only : name_folders, summary_files
   use gyroakf_app_interrupt, only : guard_files, release_files
   use gyroakf_app_job, only : analyse, inspect
   use gyroakf_app_pool, only : answer_type, run_pool, task_type
   use gyroakf_app_progress_bar, only : bar_type, clear_bar, start_bar
   use gyroakf_app_reading, only : find_bound, with_path
   use gyroakf_app_row_text, only : row_from_text, row_to_text
   use gyroakf_app_summary, only : write_summary
   use gyroakf_app_words, only : usage_error
   implicit none (type, external)
   private
   public :: work_on_many

   !> All files
   type, extends(task_type) :: files_type
      !> What is wanted of each
      class(reading_config), allocatable :: config
      !> The files, and the folders of their results, "" where none are written: [number of files]
      type(text_type), allocatable :: paths(:), folders(:)
      !> Of each process
      integer :: threads = 1
   contains
      procedure :: perform => work_on_one
   end type files_type

   !> A process that has less memory than this spends it on itself
   integer(int64), parameter :: least_share = 2*base_bytes

contains

   !> Works on all files of a command line and of its list.
   subroutine work_on_many(config, bar, code, error)
      !> Its `paths` and `list`
      class(reading_config), intent(in) :: config
      !> Told how many files are done
      type(bar_type), intent(inout) :: bar
      !> The largest of the codes that the files alone would end with
      integer, intent(out) :: code
      !> What hinders all of them: usage, io, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(files_type) :: files
      type(summary_row_type), allocatable :: rows(:)
      integer :: i

      code = 0
      allocate (files%config, source=config)
      call gather_files(files, error)
      if (allocated(error)) return
      allocate (rows(size(files%paths)))
      call guard_files()
      call work_side_by_side(files, rows, bar, error)
      call clear_bar(bar)
      if (allocated(error)) return
      do i = 1, size(rows)
         code = max(code, rows(i)%code)
         if (rows(i)%code /= 0) write (error_unit, "(a)") "gyroakf: error: "//rows(i)%message
      end do
      call write_summary(config, rows, error)
      call release_files()
   end subroutine work_on_many

   !> The files and their folders.
   subroutine gather_files(files, error)
      type(files_type), intent(inout) :: files
      !> usage, io, parse
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j
      logical :: forbidden

      call move_alloc(files%config%paths, files%paths)
      if (allocated(files%config%list)) then
         call read_list(files%config%list, files%paths, error)
         if (allocated(error)) return
      end if
      if (.not. allocated(files%config%out)) then
         allocate (files%folders(size(files%paths)))
         do i = 1, size(files%paths)
            files%folders(i)%text = ""
         end do
         return
      end if
      do while (len(files%config%out) > 1 .and. index(files%config%out, "/", back=.true.) == len(files%config%out))
         files%config%out = files%config%out(:len(files%config%out) - 1)
      end do
      call name_folders(files%paths, files%folders)
      do i = 1, size(files%paths)
         files%folders(i)%text = files%config%out//"/"//files%folders(i)%text
         forbidden = is_result(files%folders(i)%text, files%paths(i)%text)
         do j = 1, size(summary_files)
            if (files%paths(i)%text == files%config%out//"/"//trim(summary_files(j))) forbidden = .true.
         end do
         if (forbidden) call usage_error(error, "--out would overwrite the recording '"//files%paths(i)%text//"'")
         if (.not. (forbidden .or. files%config%force)) call keep_file(existing_result(files%folders(i)%text), error)
         if (allocated(error)) return
      end do
      if (files%config%force) return
      do j = 1, size(summary_files)
         if (is_file(files%config%out//"/"//trim(summary_files(j)))) then
            call keep_file(files%config%out//"/"//trim(summary_files(j)), error)
            return
         end if
      end do
   end subroutine gather_files

   !> First all files with a share of the memory each, then alone those that need more.
   subroutine work_side_by_side(files, rows, bar, error)
      type(files_type), intent(inout) :: files
      type(summary_row_type), intent(inout) :: rows(:)
      type(bar_type), intent(inout) :: bar
      !> cancelled, no_memory
      type(error_type), allocatable, intent(out) :: error
      type(answer_type), allocatable :: answers(:)
      logical, allocatable :: later(:)
      integer :: threads, processes, i
      integer(int64) :: memory, done
      logical :: shared

      threads = files%config%threads
      if (threads == 0) threads = thread_count()
      call find_bound(files%config%reader)
      memory = files%config%reader%memory
      processes = min(threads, size(rows))
      if (memory > 0) processes = int(min(int(processes, int64), max(1_int64, memory/least_share)))
      allocate (answers(size(rows)), later(size(rows)))
      later = .false.
      done = 0
      files%threads = max(1, threads/processes)
      shared = memory > 0 .and. processes > 1
      if (shared) then
         files%config%reader%memory = memory/processes
         do i = 1, size(rows)
            later(i) = files%paths(i)%text == "-"              ! it can be read once
         end do
      end if
      call run_pool(files, pack([(i, i=1, size(rows))], .not. later), processes, answers, bar, done, size(rows, kind=int64), error)
      if (allocated(error)) return
      do i = 1, size(rows)
         if (later(i)) cycle
         call take_row(files, i, answers(i), rows(i), later(i))
         later(i) = later(i) .and. shared
      end do
      if (.not. any(later)) return
      done = count(.not. later)
      files%threads = threads
      files%config%reader%memory = memory
      call run_pool(files, pack([(i, i=1, size(rows))], later), 1, answers, bar, done, size(rows, kind=int64), error)
      if (allocated(error)) return
      do i = 1, size(rows)
         if (later(i)) call take_row(files, i, answers(i), rows(i), later(i))
      end do
   end subroutine work_side_by_side

   !> What a process said of a file, or how it ended.
   subroutine take_row(files, number, answer, row, too_large)
      type(files_type), intent(in) :: files
      integer, intent(in) :: number
      type(answer_type), intent(inout) :: answer
      type(summary_row_type), intent(inout) :: row
      !> It did not fit into the memory
      logical, intent(out) :: too_large
      character(:), allocatable :: reason
      character(12) :: digits
      integer :: problem

      too_large = .false.
      if (allocated(answer%text)) then
         call row_from_text(answer%text, row, problem)
         too_large = problem == status%no_memory
         deallocate (answer%text)
         return
      end if
      reason = ": the process that worked on it "
      if (answer%signal /= 0) then
         write (digits, "(i0)") answer%signal
         reason = reason//"was ended by signal "//trim(digits)
         if (answer%signal == 9) reason = reason//": was the memory full?"
      else
         write (digits, "(i0)") answer%code
         reason = reason//"ended without a result, with exit code "//trim(digits)
      end if
      call summarise_failure(files%config%command, files%paths(number)%text, "", 3, files%paths(number)%text//reason, row)
   end subroutine take_row

   !> The whole life of a process: one file as if it were alone.
   subroutine work_on_one(self, number, text)
      !> All files
      class(files_type), intent(inout) :: self
      !> Which
      integer, intent(in) :: number
      !> Its row of the summary
      character(:), allocatable, intent(out) :: text
      type(error_type), allocatable :: error
      type(summary_row_type) :: row
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(bar_type) :: bar

      call set_thread_count(self%threads)
      call start_bar(bar, "off")
      associate (path => self%paths(number)%text, folder => self%folders(number)%text, command => self%config%command)
         call prepare_one(self%config, path, folder, number)
         select type (config => self%config)
         type is (inspect_config)
            call inspect(config, bar, record, error)
            if (.not. allocated(error)) call summarise(command, path, folder, record, row)
         type is (analysis_config)
            call analyse(config, bar, record, result, error)
            if (.not. allocated(error)) call summarise(command, path, folder, record, row, result)
         end select
         if (allocated(error)) then
            call summarise_failure(command, path, "", exit_code(error%code), with_path(path, error%message), row)
            call row_to_text(row, error%code, text)
         else
            call row_to_text(row, status%ok, text)
         end if
      end associate
   end subroutine work_on_one

   !> The configuration of one file alone.
   subroutine prepare_one(config, path, folder, number)
      class(reading_config), intent(inout) :: config
      character(*), intent(in) :: path, folder
      integer, intent(in) :: number

      config%path = path
      config%number = number
      config%quiet = .true.
      if (allocated(config%json)) deallocate (config%json)
      if (allocated(config%list)) deallocate (config%list)
      if (allocated(config%out)) config%out = folder
      select type (config)
      type is (analysis_config)
         if (allocated(config%kalibr)) config%kalibr = folder//"/"//config%kalibr
         if (allocated(config%latex)) config%latex = folder//"/"//config%latex
      end select
   end subroutine prepare_one

end module gyroakf_app_many
