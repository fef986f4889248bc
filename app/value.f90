! SPDX-License-Identifier: MIT
!> Values of options: from text to numbers and words, with a message that says what would be right.
module gyroakf_app_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_number, only : parse_number, number
   use gyroakf_app_option, only : option_type, suggest_word, takes_value
   implicit none (type, external)
   private
   public :: value_type, convert_value, convert_list, value_error, not_wired, is_word

   !> A value
   type :: value_type
      !> As it was given
      character(:), allocatable :: text
      !> Of the kinds real, positive, share
      real(dp) :: number = 0.0_dp
      !> Of the kinds natural and count
      integer(int64) :: count = 0
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
      case ("choice"); call check_choice(option, text, error)
      case ("choices"); call check_choices(option, text, error)
      case ("real", "positive", "share"); call convert_real(option, text, value%number, error)
      case ("natural", "count"); call convert_count(option, text, value%count, error)
      case default                          ! text
      end select
   end subroutine convert_value

   !> Numbers separated by commas.
   subroutine convert_list(option, text, list, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> As it was given
      character(*), intent(in) :: text
      !> [number of commas + 1]
      real(dp), allocatable, intent(out) :: list(:)
      !> usage
      type(error_type), allocatable, intent(out) :: error
      integer :: i, from, to

      allocate (list(1 + count_of(text, ",")))
      from = 1
      do i = 1, size(list)
         to = from + index(text(from:)//",", ",") - 2
         call convert_real(option, text(from:to), list(i), error)
         if (allocated(error)) return
         from = to + 2
      end do
   end subroutine convert_list

   !> A value that the option cannot take.
   subroutine value_error(option, what, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> What is wrong
      character(*), intent(in) :: what
      !> usage
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%usage, "option '"//trim(option%name)//" "//trim(option%value)//"': "//what)
   end subroutine value_error

   !> A row of the table that no setting knows: a defect of the program.
   subroutine not_wired(option, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> internal
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%internal, "option '"//trim(option%name)//"' has no effect; please report this")
   end subroutine not_wired

   !> Whether a word is one of several separated by |.
   pure logical function is_word(word, words)
      !> The word
      character(*), intent(in) :: word
      !> The words
      character(*), intent(in) :: words

      is_word = index("|"//trim(words)//"|", "|"//word//"|") > 0 .and. index(word, "|") == 0
   end function is_word

   !> One of the option's words.
   subroutine check_choice(option, text, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error

      if (.not. is_word(text, option%value)) call value_error(option, "'"//text//"' is not one of these", error)
   end subroutine check_choice

   !> Some of the option's words, separated by commas.
   subroutine check_choices(option, text, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      integer :: i, from, to

      from = 1
      do i = 1, 1 + count_of(text, ",")
         to = from + index(text(from:)//",", ",") - 2
         call check_choice(option, text(from:to), error)
         if (allocated(error)) return
         from = to + 2
      end do
   end subroutine check_choices

   !> A finite number in the range of the option's kind.
   subroutine convert_real(option, text, x, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      real(dp), intent(out) :: x
      type(error_type), allocatable, intent(out) :: error
      integer :: found

      call parse_number(text, x, found)
      if (found == number%overflow) then
         call value_error(option, "'"//text//"' is too large for a number", error)
      else if (found /= number%ok) then
         call value_error(option, "'"//text//"' is not a number", error)
      else if (option%kind == "positive" .and. x <= 0) then
         call value_error(option, "'"//text//"' is not larger than 0", error)
      else if (option%kind == "share" .and. (x <= 0 .or. x > 1)) then
         call value_error(option, "'"//text//"' is not larger than 0 and at most 1", error)
      end if
   end subroutine convert_real

   !> A whole number, not negative; of the kind count not 0.
   subroutine convert_count(option, text, n, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      integer(int64), intent(out) :: n
      type(error_type), allocatable, intent(out) :: error
      integer :: stat

      n = 0
      stat = 1
      if (verify(text, "0123456789") == 0 .and. len(text) <= 18) read (text, "(i18)", iostat=stat) n
      if (stat /= 0) then
         call value_error(option, "'"//text//"' is not a whole number of at most 18 digits, 0 or more", error)
      else if (option%kind == "count" .and. n == 0) then
         call value_error(option, "it is at least 1", error)
      end if
   end subroutine convert_count

   !> How often a character occurs.
   pure integer function count_of(text, character)
      character(*), intent(in) :: text
      character(1), intent(in) :: character
      integer :: i

      count_of = 0
      do i = 1, len(text)
         if (text(i:i) == character) count_of = count_of + 1
      end do
   end function count_of

end module gyroakf_app_value
