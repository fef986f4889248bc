! SPDX-License-Identifier: MIT
!> The manual page, in roff: `gyroakf --man`. Every text in it is that of `--help`.
module gyroakf_app_manual
   use gyroakf_app_help, only : about, usage_notes, run_is_default, reading_notes, exit_codes, examples, references
   use gyroakf_app_option, only : option_type, options, commands, group_titles, option_names
   use gyroakf_release, only : release_string
   implicit none (type, external)
   private
   public :: manual_text

   character(*), parameter :: nl = new_line("a")

contains

   !> The whole page.
   function manual_text() result(text)
      character(:), allocatable :: text
      integer :: i

      text = '.TH GYROAKF 1 "" "gyroakf '//release_string//'" "User Commands"'//nl// &
         ".SH NAME"//nl//"gyroakf \- "//roff(about)//nl// &
         ".SH SYNOPSIS"//nl//".B gyroakf"//nl//"[\fICOMMAND\fR] \fIFILE\fR... [\fIOPTIONS\fR]"//nl// &
         ".SH DESCRIPTION"//nl//roff(usage_notes)//nl//".PP"//nl//roff(reading_notes)//nl//".SH COMMANDS"//nl
      do i = 1, size(commands)
         text = text//".TP"//nl//".B "//trim(commands(i)%name)//nl//roff(trim(commands(i)%purpose))//nl
      end do
      text = text//".PP"//nl//roff(run_is_default)//nl//".SH OPTIONS"//nl
      do i = 1, size(group_titles, 2)
         text = text//group_of(i)
      end do
      text = text//".SH EXAMPLES"//nl//".nf"//nl
      do i = 1, size(examples, 2)
         text = text//roff(trim(examples(2, i)))//nl
      end do
      text = text//".fi"//nl//".SH EXIT STATUS"//nl//roff(exit_codes)//nl//".SH REFERENCES"//nl
      do i = 1, size(references)
         if (i > 1) text = text//".PP"//nl
         text = text//roff(trim(references(i)))//nl
      end do
   end function manual_text

   !> The options of a group under its title; "" where it has none.
   function group_of(group) result(text)
      !> Its place in the table
      integer, intent(in) :: group
      character(:), allocatable :: text
      integer :: i

      text = ""
      do i = 1, size(options)
         if (options(i)%group /= group_titles(1, group)) cycle
         text = text//".TP"//nl//"\fB"//roff(option_names(options(i)))//"\fR"
         if (options(i)%value /= "") text = text//" \fI"//roff(trim(options(i)%value))//"\fR"
         text = text//nl//roff(trim(options(i)%help))//nl//".br"//nl//"Commands: "//trim(options(i)%commands)//"."//nl
      end do
      if (text /= "") text = ".SS "//roff(trim(group_titles(2, group)))//nl//text
   end function group_of

   !> A text as roff takes it literally: backslashes and hyphens escaped, no line that begins like a request.
   function roff(text) result(escaped)
      character(*), intent(in) :: text
      character(:), allocatable :: escaped
      integer :: i

      escaped = ""
      if (scan(text(:min(1, len(text))), ".'") > 0) escaped = "\&"
      do i = 1, len(text)
         select case (text(i:i))
         case ("\"); escaped = escaped//"\e"
         case ("-"); escaped = escaped//"\-"
         case default; escaped = escaped//text(i:i)
         end select
      end do
   end function roff

end module gyroakf_app_manual
