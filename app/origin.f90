! SPDX-License-Identifier: MIT
!> What a document tells of its run, and whether the files of a run that is repeated are those that it had.
module gyroakf_app_origin
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_checksum, only : sum_file
   use gyroakf_io_place, only : integer_text
   use gyroakf_progress, only : progress_type
   use gyroakf_report_document_origin, only : input_file_type, origin_type
   use gyroakf_app_config, only : analysis_config, reading_config
   use gyroakf_app_effective, only : effective_value
   use gyroakf_app_option, only : belongs_to, is_of_the_line, options
   implicit none (type, external)
   private
   public :: find_origin

contains

   !> Command, options and files of a job. The files are read for their checksums only where a document tells them, or where the run
   !> is a repetition.
   subroutine find_origin(config, origin, error, progress)
      !> A job of one file
      class(reading_config), intent(in) :: config
      !> For the document
      type(origin_type), intent(out) :: origin
      !> io: a file is not the one of the run that is repeated; cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout) :: progress
      integer :: i, n

      origin%command = config%command
      n = 0
      do i = 1, size(options)
         if (is_setting(i, config%command)) n = n + 1
      end do
      allocate (origin%setting(n))
      n = 0
      do i = 1, size(options)
         if (.not. is_setting(i, config%command)) cycle
         n = n + 1
         origin%setting(n)%name = trim(options(i)%name(3:))
         call effective_value(config, trim(options(i)%name), origin%setting(n)%value)
         origin%setting(n)%given = is_given(config, origin%setting(n)%name)
      end do
      call name_files(config, origin)
      if (.not. (allocated(config%json) .or. allocated(config%out) .or. allocated(config%expected))) return
      do i = 1, size(origin%file)
         call sum_file(origin%file(i)%path, origin%file(i)%checksum, error, progress)
         if (.not. allocated(error)) call check_file(config, origin%file(i), error)
         if (allocated(error)) return
      end do
   end subroutine find_origin

   !> An option that says how the command works.
   logical function is_setting(row, command)
      integer, intent(in) :: row
      character(*), intent(in) :: command

      is_setting = belongs_to(options(row), command) .and. options(row)%name /= "--dt" .and. &
                   .not. is_of_the_line(options(row)%name)
   end function is_setting

   !> Whether the user gave an option.
   pure logical function is_given(config, name)
      class(reading_config), intent(in) :: config
      character(*), intent(in) :: name
      integer :: i

      is_given = .false.
      if (.not. allocated(config%given)) return
      do i = 1, size(config%given)
         if (config%given(i)%text == name) is_given = .true.
      end do
   end function is_given

   !> The recording, and the true drift.
   subroutine name_files(config, origin)
      class(reading_config), intent(in) :: config
      type(origin_type), intent(inout) :: origin
      integer :: n

      n = 1
      select type (config)
      type is (analysis_config)
         if (allocated(config%truth)) n = 2
      end select
      allocate (origin%file(n))
      origin%file(1)%path = config%path
      select type (config)
      type is (analysis_config)
         if (n == 1) return
         origin%file(2)%option = "truth"
         origin%file(2)%path = config%truth
      end select
   end subroutine name_files

   !> A file of a run that is repeated has the checksum that it had.
   subroutine check_file(config, file, error)
      class(reading_config), intent(in) :: config
      type(input_file_type), intent(in) :: file
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: nl = new_line("a")
      character(:), allocatable :: what, advice
      integer :: i

      if (.not. allocated(config%expected)) return
      do i = 1, size(config%expected)
         if (allocated(config%expected(i)%option) .neqv. allocated(file%option)) cycle
         if (.not. file%checksum%known) then
            call fatal_error(error, status%io, file%path//": no such file"//nl//"the run that is to be repeated had it under "// &
                             "this path: go to its folder, or name the file")
            return
         end if
         associate (then => config%expected(i)%checksum, now => file%checksum)
            if (then%bytes == now%bytes .and. then%sha256 == now%sha256) return
            what = "has SHA-256 "//now%sha256//", and then "//then%sha256
            if (then%bytes /= now%bytes) what = "has "//integer_text(now%bytes)//" bytes, and then "//integer_text(then%bytes)
         end associate
         advice = "gyroakf "//config%command//" "//file%path//" --repeat ..."
         if (allocated(file%option)) advice = "--"//file%option//" "//file%path
         call fatal_error(error, status%parse, file%path//": is not the file of the run that is to be repeated: it "//what//nl// &
                          "find the file as it was, or name it to take it as it is: "//advice)
         return
      end do
   end subroutine check_file

end module gyroakf_app_origin
