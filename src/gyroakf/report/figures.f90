! SPDX-License-Identifier: MIT
!> The figures of a result, for a page and as SVG files in DIR/figures; those that a folder holds.
!>
!>     call build_figures(record, result, figures)
!>     call write_svg(writer, figures(1)%figure, .true.)
module gyroakf_report_figures
   use, intrinsic :: iso_c_binding, only : c_char, c_null_char, c_size_t
   use gyroakf_kinds, only : int64
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_figure_allan, only : build_allan_figure, build_overlay
   use gyroakf_report_figure_series, only : build_series_figure
   use gyroakf_report_svg, only : figure_type, has_points
   use gyroakf_spelling, only : lower
   use gyroakf_report_text_layout, only : count_text, if_known
   implicit none (type, external)
   private
   public :: named_figure_type, build_figures, find_figures, figure_folder, name_length

   !> Below the folder of the results
   character(*), parameter :: figure_folder = "figures"
   !> Longest name of a file below the folder of the results
   integer, parameter :: name_length = len(figure_folder) + 256
   !> In the order of a report; the first one is that of several channels
   character(7), parameter :: figure_kinds(4) = &
      [character(7) :: "overlay", "allan", "series", "filters"]

   !> A figure and its file
   type :: named_figure_type
      !> Below the folder of the results: figures/KIND.svg, of several channels
      !> figures/KIND-CHANNEL.svg
      character(:), allocatable :: name
      !> overlay, allan, series, filters
      character(7) :: kind = ""
      !> Number of the channel; an overlay belongs to the first channel of a unit
      integer :: channel = 0
      type(figure_type) :: figure
   end type named_figure_type

   interface
      !> Names of a folder with an ending, each with a slash behind it, as far as the buffer holds
      !> them; the length of all
      integer(c_size_t) function list_files(folder, ending, names, capacity) &
         bind(C, name="gyroakf_host_list_files")
         import :: c_char, c_size_t
         implicit none (type, external)
         !> End with a NUL
         character(kind=c_char), intent(in) :: folder(*), ending(*)
         character(kind=c_char), intent(inout) :: names(*)
         integer(c_size_t), intent(in), value :: capacity
      end function list_files
   end interface

contains

   !> Builds all figures that the result has.
   subroutine build_figures(record, result, figures)
      !> With its samples
      type(record_type), intent(in) :: record
      !> What came out; filtered series are drawn where they were kept
      type(pipeline_result_type), intent(in) :: result
      !> Those that have points, channel by channel; may be none
      type(named_figure_type), allocatable, intent(out) :: figures(:)
      type(named_figure_type), allocatable :: built(:)
      type(record_type) :: view
      character(:), allocatable :: suffix
      integer :: c, i, n

      allocate (built(1 + size(figure_kinds)*size(result%channel)))
      n = 1
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         ! where two names are alike their number stands behind them
         suffix = if_known(size(result%channel) > 1, "-"//plain(result%channel(c)%name))
         if (count([(plain(result%channel(i)%name) == plain(result%channel(c)%name), &
                     i=1, size(result%channel))]) > 1) suffix = suffix//"-"//count_text(int(c, &
                                                                                            int64))
         do i = 1, size(figure_kinds)
            associate (channel => result%channel(c), figure => built(n)%figure)
               select case (figure_kinds(i))
               case ("overlay"); call build_overlay(record, result, c, figure)
               case ("allan"); call build_allan_figure(view, channel, figure)
               case default
                  call build_series_figure(record, c, channel, figure_kinds(i) == "filters", figure)
               end select
               if (.not. has_points(figure)) cycle
            end associate
            built(n)%kind = figure_kinds(i)
            built(n)%channel = c
            built(n)%name = figure_folder//"/"//trim(figure_kinds(i))//suffix//".svg"
            n = n + 1
         end do
      end do
      allocate (figures(n - 1), source=built(:n - 1))
   end subroutine build_figures

   !> The files of a folder of results that have names of figures.
   subroutine find_figures(directory, names)
      !> May be missing
      character(*), intent(in) :: directory
      !> Below it: [number of files]
      character(name_length), allocatable, intent(out) :: names(:)
      character(:), allocatable :: folder, list
      integer(c_size_t) :: used
      integer :: pass, first, last

      folder = directory//"/"//figure_folder//c_null_char
      list = ""
      do pass = 1, 2                                       ! the length of all names, the names
         used = list_files(folder, ".svg"//c_null_char, list, len(list, c_size_t))
         if (pass == 1) list = repeat("/", int(used))
      end do
      allocate (names(0))
      first = 1
      do while (first < len(list))
         last = first + index(list(first:), "/") - 2
         if (any(figure_kinds == list(first:first + scan(list(first:last), "-.") - 2))) then
            names = [character(name_length) :: names, figure_folder//"/"//list(first:last)]
         end if
         first = last + 2
      end do
   end subroutine find_figures

   !> A name in letters that every file system takes: letters, digits, - and _; all else becomes _.
   !> File systems that do not tell A from a are why it is in lower case.
   pure function plain(name) result(text)
      character(*), intent(in) :: name
      character(len(name)) :: text
      integer :: i

      text = lower(name)
      do i = 1, len(name)
         if (verify(text(i:i), "abcdefghijklmnopqrstuvwxyz0123456789-_") > 0) text(i:i) = "_"
      end do
   end function plain

end module gyroakf_report_figures
