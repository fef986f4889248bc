! SPDX-License-Identifier: MIT
!> Values of options: from text to numbers and words, with a message that says what would be right.
module gyroakf_app_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_number, only : parse_number, number
   use gyroakf_io_place, only : integer_text
   use gyroakf_spelling, only : replace_all
   use gyroakf_app_option, only : takes_value
   use gyroakf_app_option_table, only : option_type
   implicit none (type, external)
   private
   public :: value_type, convert_value, value_error, not_wired, is_word

   !> A value
   type :: value_type
      !> As it was given
      character(:), allocatable :: text
      !> Of the kinds real, positive, share; 0 where a word stands for it
      real(dp) :: number = 0.0_dp
      !> Of the kinds natural, count and size (bytes); -1 where a word stands for it
      integer(int64) :: count = 0
      !> Of the kinds reals and positives
      real(dp), allocatable :: list(:)
   end type value_type

contains

   !> Converts by the option's kind.
   subroutine convert_value(option, text, value, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> As it was given, "" of a flag
      character(*), intent(in) :: text
      !> What it means
      type(value_type), intent(out) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      value%text = text
      if (.not. takes_value(option)) return
      if (text == "") then
         call value_error(option, "the value is empty", error)
         return
      end if
      select case (option%kind)
      case ("choices", "reals", "positives"); call convert_list(option, text, value%list, error)
      case ("choice", "real", "positive", "share")
         call convert_part(option, text, value%number, error)
      case ("natural", "count"); call convert_count(option, text, value%count, error)
      case ("size"); call convert_size(option, text, value%count, error)
      case default                          ! text
      end select
   end subroutine convert_value

   !> Numbers separated by commas, or words, which become 0.
   subroutine convert_list(option, text, list, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      real(dp), allocatable, intent(out) :: list(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: from, to

      allocate (list(0))
      from = 1
      do while (from <= len(text) + 1)
         to = from + index(text(from:)//",", ",") - 2
         list = [list, 0.0_dp]
         call convert_part(option, text(from:to), list(size(list)), error)
         if (allocated(error)) return
         from = to + 2
      end do
   end subroutine convert_list

   !> A value that the option cannot take.
   subroutine value_error(option, what, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> What is wrong with the value
      character(*), intent(in) :: what
      !> usage
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%usage, &
         "option '"//trim(option%name)//" "//trim(option%value)//"': "//what)
   end subroutine value_error

   !> A row of the table that no setting knows: a defect of the program.
   subroutine not_wired(option, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> internal
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%internal, &
         "option '"//trim(option%name)//"' has no effect; please report this")
   end subroutine not_wired

   !> Whether a word is one of several separated by |.
   pure logical function is_word(word, words)
      !> The word
      character(*), intent(in) :: word
      !> The words
      character(*), intent(in) :: words

      is_word = index("|"//trim(words)//"|", "|"//word//"|") > 0 .and. index(word, "|") == 0
   end function is_word

   !> Whether one of the words that may stand for a number was given.
   pure logical function stands_for_number(option, text)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text

      stands_for_number = is_word(text, option%value) .and. &
         verify(text, "abcdefghijklmnopqrstuvwxyz") == 0
   end function stands_for_number

   !> A finite number in the range of the option, or one of its words, which becomes 0.
   subroutine convert_part(option, text, x, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      real(dp), intent(out) :: x
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words, problem
      integer :: found, last

      x = 0.0_dp
      if (stands_for_number(option, text)) return
      problem = ""
      found = number%ok
      if (option%kind(:6) /= "choice") call parse_number(text, x, found)
      if (option%kind(:6) == "choice") then
         if (.not. is_word(text, option%value)) problem = "not one of these"
      else if (found == number%overflow) then
         problem = "too large for a number"
      else if (found /= number%ok) then
         problem = "not a number"
         last = index(option%value, "|", back=.true.)
         if (last > 0 .and. option%kind == "positive") then
            words = option%value(:last - 1)
            call replace_all(words, "|", ", ")
            problem = "neither "//words//" nor a positive number"
         end if
      else if (option%kind(:8) == "positive" .and. x <= 0) then
         problem = "not larger than 0"
      else if (option%kind == "share" .and. (x <= 0 .or. x > 1)) then
         problem = "not larger than 0 and at most 1"
      else if (x < option%lower .or. x > option%upper) then
         problem = "not from "//format_real(option%lower, 6)//" to "//format_real(option%upper, 6)
      end if
      if (problem == "") return
      call value_error(option, "'"//text//"' is "//problem, error)
   end subroutine convert_part

   !> A whole number in the range of the option, not negative; of the kind count not 0.
   subroutine convert_count(option, text, n, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      integer(int64), intent(out) :: n
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: range
      integer(int64) :: least
      integer :: stat

      n = -1
      if (stands_for_number(option, text)) return
      stat = 1
      if (verify(text, "0123456789") == 0 .and. len(text) <= 18) read (text, "(i18)", iostat=stat) n
      least = merge(1_int64, 0_int64, option%kind == "count")
      range = " of at most 18 digits, "//integer_text(least)//" or more"
      if (option%upper < huge(option%upper)) range = " from "//integer_text(least)//" to "// &
         integer_text(int(option%upper, int64))
      if (stat == 0 .and. n >= least .and. real(n, dp) <= option%upper) return
      call value_error(option, "'"//text//"' is not a whole number"//range, error)
   end subroutine convert_count

   !> Bytes: 500MB, 2GB, 1.5G, 300MiB, or their number.
   subroutine convert_size(option, text, bytes, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      integer(int64), intent(out) :: bytes
      type(error_type), allocatable, intent(out) :: error
      character(3), parameter :: units(14) = [character(3) :: "", "B", "k", "kB", "KiB", "M", &
         "MB", "MiB", "G", "GB", "GiB", "T", "TB", "TiB"]
      real(dp), parameter :: bytes_of(14) = [1.0_dp, 1.0_dp, 1e3_dp, 1e3_dp, 1024.0_dp, 1e6_dp, &
         1e6_dp, 1024.0_dp**2, 1e9_dp, 1e9_dp, 1024.0_dp**3, 1e12_dp, 1e12_dp, 1024.0_dp**4]
      real(dp) :: x
      integer :: last, found, unit

      bytes = 0
      x = 0.0_dp
      last = scan(text, "0123456789.", back=.true.)
      found = -1
      unit = 0
      if (last > 0) then
         call parse_number(text(:last), x, found)
         unit = findloc(units, text(last + 1:), dim=1)
      end if
      if (found /= number%ok .or. unit == 0) then
         call value_error(option, "'"//text//"' is not a size such as 500MB or 2GB", error)
      else if (x*bytes_of(unit) < option%lower) then
         call value_error(option, "'"//text//"' is too small, at least "// &
            format_real(option%lower/1e6_dp, 6)//"MB", error)
      else
         bytes = int(min(x*bytes_of(unit), 1.0e18_dp), int64)
      end if
   end subroutine convert_size

end module gyroakf_app_value
