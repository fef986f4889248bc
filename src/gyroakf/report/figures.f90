! SPDX-License-Identifier: MIT
!> The figures of a result, for a page and as SVG files in DIR/figures.
!>
!>     call write_figures("results/figures", record, result, error)
module gyroakf_report_figures
   use gyroakf_error, only : error_type
   use gyroakf_io_writer, only : commit_writer, make_directory, open_writer, remove_file, &
      writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_figure_allan, only : build_allan_figure, build_overlay
   use gyroakf_report_figure_series, only : build_filter_figure, build_record_figure
   use gyroakf_report_input, only : unit_name
   use gyroakf_report_svg, only : figure_type, has_points, write_svg
   implicit none (type, external)
   private
   public :: write_figures, build_figure, figure_folder, figure_kinds

   !> Below the folder of the results
   character(*), parameter :: figure_folder = "figures"
   !> In the order of a report; the first one is that of several channels
   character(7), parameter :: figure_kinds(4) = &
      [character(7) :: "overlay", "allan", "series", "filters"]

contains

   !> Writes all figures that the result has: KIND.svg, of several channels KIND-CHANNEL.svg;
   !> others of these names are
   !> removed.
   subroutine write_figures(folder, record, result, error)
      !> Made where it does not exist: [[gyroakf_report_figures:figure_folder]] in that of
      !> [[write_results]], or another
      character(*), intent(in) :: folder
      !> With its samples
      type(record_type), intent(in) :: record
      !> What came out; filtered series are drawn where they were kept
      type(pipeline_result_type), intent(in) :: result
      !> io, no_memory
      type(error_type), allocatable, intent(out) :: error
      type(figure_type) :: figure
      type(writer_type) :: writer
      character(:), allocatable :: path
      integer :: c, i

      call make_directory(folder, error)
      if (allocated(error)) return
      do c = 1, size(result%channel)
         do i = 1, size(figure_kinds)
            call build_figure(trim(figure_kinds(i)), record, result, c, figure)
            path = folder//"/"//trim(figure_kinds(i))//suffix_of(result, c)//".svg"
            if (.not. has_points(figure)) then
               call remove_file(path)                      ! of an earlier run
               cycle
            end if
            call open_writer(writer, path, error)
            if (allocated(error)) return
            call write_svg(writer, figure, .true.)
            call commit_writer(writer, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine write_figures

   !> Builds a figure of a channel; without series where the channel has none of the kind.
   subroutine build_figure(kind, record, result, c, figure)
      !> One of [[gyroakf_report_figures:figure_kinds]]; the overlay belongs to the first channel
      !> of a unit
      character(*), intent(in) :: kind
      !> With its samples
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Number of the channel
      integer, intent(in) :: c
      !> For [[write_svg]] where [[has_points]] holds
      type(figure_type), intent(out) :: figure
      type(record_type) :: view

      call view_channel(record, c, view)
      associate (channel => result%channel(c))
         select case (kind)
         case ("overlay"); call build_overlay(record, result, c, figure)
         case ("allan")
            if (channel%allan(stage%input)%available) call build_allan_figure(view, channel, figure)
         case ("series")
            if (allocated(record%value)) then
               call build_record_figure(record, c, channel, unit_name(view), figure)
            end if
         case default
            if (allocated(channel%series_kf) .or. allocated(channel%series_akf)) then
               call build_filter_figure(record, channel, unit_name(view), figure)
            end if
         end select
      end associate
   end subroutine build_figure

   !> "" of a single channel, else "-" and its name in letters that every file system takes, with
   !> its number where two are alike.
   function suffix_of(result, c) result(suffix)
      type(pipeline_result_type), intent(in) :: result
      integer, intent(in) :: c
      character(:), allocatable :: suffix
      character(12) :: digits
      integer :: i

      suffix = ""
      if (size(result%channel) == 1) return
      suffix = "-"//plain(result%channel(c)%name)
      do i = 1, size(result%channel)
         if (i == c .or. plain(result%channel(i)%name) /= plain(result%channel(c)%name)) cycle
         write (digits, "(i0)") c
         suffix = suffix//"-"//trim(digits)
         return
      end do
   end function suffix_of

   !> Letters, digits, - and _; all else becomes _. File systems that do not tell A from a are why
   !> it is in lower case.
   pure function plain(name) result(text)
      character(*), intent(in) :: name
      character(len(name)) :: text
      character(*), parameter :: upper = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", lower = "abcdefghijklmnopqrstuvwxyz"
      integer :: i, at

      do i = 1, len(name)
         text(i:i) = name(i:i)
         at = index(upper, text(i:i))
         if (at > 0) text(i:i) = lower(at:at)
         if (verify(text(i:i), lower//"0123456789-_") > 0) text(i:i) = "_"
      end do
   end function plain

end module gyroakf_report_figures
