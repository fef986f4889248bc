! SPDX-License-Identifier: MIT
!> The words of a command line, whatever they come from.
!>
!> The parser in [[gyroakf_app_cli]] sees an [[argument_list]] only; the process is one source of it:
!>
!>     call read_arguments(process_source(), list, error)
module gyroakf_app_argument
   use, intrinsic :: iso_fortran_env, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : text_type
   implicit none (type, external)
   private
   public :: argument_list, argument_source, process_source, read_arguments

   !> The words, in order, without the program's name
   type :: argument_list
      !> [count]
      type(text_type), allocatable :: item(:)
   end type argument_list

   !> Where words come from
   type, abstract :: argument_source
   contains
      !> How many there are
      procedure(count_words), deferred :: count
      !> The i-th of them
      procedure(get_word), deferred :: get
   end type argument_source

   abstract interface
      !> How many words the source has
      integer function count_words(self)
         import :: argument_source
         implicit none (type, external)
         !> The source
         class(argument_source), intent(in) :: self
      end function count_words

      !> The i-th word, 1 <= i <= count
      subroutine get_word(self, i, word)
         import :: argument_source
         implicit none (type, external)
         !> The source
         class(argument_source), intent(in) :: self
         !> Its number
         integer, intent(in) :: i
         !> The word, as it was given
         character(:), allocatable, intent(out) :: word
      end subroutine get_word
   end interface

   !> The command line of this process
   type, extends(argument_source) :: process_source
   contains
      procedure :: count => count_process_words
      procedure :: get => get_process_word
   end type process_source

contains

   !> All words of a source.
   subroutine read_arguments(source, list, error)
      !> Where they come from
      class(argument_source), intent(in) :: source
      !> The words
      type(argument_list), intent(out) :: list
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer :: i, stat

      allocate (list%item(source%count()), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the command line")
         return
      end if
      do i = 1, size(list%item)
         call source%get(i, list%item(i)%text)
      end do
   end subroutine read_arguments

   !> Number of words after the program's name.
   integer function count_process_words(self)
      !> This process
      class(process_source), intent(in) :: self

      associate (unused => self)
      end associate
      count_process_words = command_argument_count()
   end function count_process_words

   !> One word of the process, trailing blanks included.
   subroutine get_process_word(self, i, word)
      !> This process
      class(process_source), intent(in) :: self
      !> 1 <= i <= count
      integer, intent(in) :: i
      !> The word
      character(:), allocatable, intent(out) :: word
      integer :: length

      associate (unused => self)
      end associate
      call get_command_argument(i, length=length)
      allocate (character(length) :: word)
      if (length > 0) call get_command_argument(i, word)
   end subroutine get_process_word

end module gyroakf_app_argument
