! SPDX-License-Identifier: MIT
!> The figures of a result, for a page and as SVG files in DIR/figures; those that a folder holds.
!>
!> A long series is drawn by the lowest and the highest sample of each block: no peak is lost, and
!> the figure of a long record is as small as that of a short one.
!>
!>     call build_figures(record, result, figures)
!>     call write_svg(writer, figures(1)%figure, .true.)
module gyroakf_report_figures
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only : c_char, c_null_char, c_size_t
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_figure_allan, only : build_allan_figure, build_overlay
   use gyroakf_report_input, only : time_unit, unit_name
   use gyroakf_report_number_text, only : count_text, if_known, to_unicode
   use gyroakf_report_svg, only : figure_type, has_points
   use gyroakf_report_svg_series, only : series_type
   use gyroakf_spelling, only : lower
   use gyroakf_stats_trend, only : evaluate_trend
   implicit none (type, external)
   private
   public :: named_figure_type, build_figures, find_figures, figure_folder, name_length, max_blocks

   !> Below the folder of the results
   character(*), parameter :: figure_folder = "figures"
   !> Longest name of a file below the folder of the results
   integer, parameter :: name_length = len(figure_folder) + 256
   !> Blocks of a long series, points of a trend, outliers
   integer(int64), parameter :: max_blocks = 550, trend_points = 200, max_outliers = 300
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
      integer :: c, i, n, alike

      allocate (built(1 + size(figure_kinds)*size(result%channel)))
      n = 1
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         ! where two names are alike their number stands behind them
         suffix = if_known(size(result%channel) > 1, "-"//plain(result%channel(c)%name))
         alike = count([(plain(result%channel(i)%name) == plain(result%channel(c)%name), &
                         i=1, size(result%channel))])
         if (alike > 1) suffix = suffix//"-"//count_text(int(c, int64))
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

   !> The record with its outliers, its trend and its drift; or the cleaned series and the outputs
   !> of the filters. Without series where there are no samples, or where no output was kept.
   subroutine build_series_figure(record, number, channel, filtered, figure)
      !> With its samples, or without
      type(record_type), intent(in), target :: record
      !> Of the channel in it
      integer, intent(in) :: number
      !> Trend, drift and outliers are drawn where they are known, a drift that no model describes
      !> is not
      type(channel_result_type), intent(in) :: channel
      !> The outputs of the filters, not the record
      logical, intent(in) :: filtered
      !> Ready to be written
      type(figure_type), intent(out) :: figure
      integer(int8), pointer :: marks(:)
      type(record_type) :: view
      integer(int64) :: i, k(trend_points)

      if (filtered .and. .not. (allocated(channel%series_kf) .or. &
                                allocated(channel%series_akf))) return
      if (.not. (filtered .or. allocated(record%value))) return
      call view_channel(record, number, view)
      figure%title = channel%name//", record"
      if (filtered) figure%title = channel%name//", cleaned and filtered"
      figure%x_label = "time, "//time_unit(record)
      figure%y_label = to_unicode(unit_name(view))
      figure%caption = "Lowest and highest sample of each block of a long record."
      allocate (figure%series(4))
      if (filtered) then
         call set_series(1, "cleaned", -1, channel%series_cleaned, channel%series_present)
         call set_series(2, "KF", 2, channel%series_kf, channel%series_present)
         call set_series(3, "AKF", 1, channel%series_akf, channel%series_present)
         return
      end if
      marks => null()
      if (allocated(record%present)) marks => record%present(:, number)
      call set_series(1, "record", -1, record%value(:, number), marks)
      if (allocated(channel%series_present)) call set_outliers(record%value(:, number), &
                                                               channel%series_present, marks)
      ! the trend that was removed
      if (channel%clean%trend%degree >= 1) then
         k = [(((i - 1)*(size(record%value, 1, kind=int64) - 1))/(trend_points - 1), i=1, &
               trend_points)]
         figure%series(3)%label = "trend"
         figure%series(3)%color = 1
         figure%series(3)%x = real(k, dp)*record%sample_interval
         figure%series(3)%y = [(evaluate_trend(channel%clean%trend, k(i)), i=1, trend_points)]
      end if
      if (.not. allocated(channel%drift_doubt)) then
         call set_series(4, "drift (smoother)", 2, channel%series_drift)
      end if

   contains

      !> Every sample of a short series, lowest and highest sample of each block of a long one; NaN
      !> where a block has none.
      subroutine set_series(i, label, color, values, marks)
         integer, intent(in) :: i, color
         character(*), intent(in) :: label
         !> Absent: nothing is drawn
         real(dp), intent(in), contiguous, optional :: values(:)
         !> 1 present, 0 missing: [n]; all are present if absent
         integer(int8), intent(in), optional :: marks(:)
         integer(int64) :: n, length, first, last, points, ends(2), k
         logical, allocatable :: there(:)

         if (.not. present(values)) return
         n = size(values, kind=int64)
         length = 1
         if (n > 2*max_blocks) length = (n + max_blocks - 1)/max_blocks
         associate (series => figure%series(i))
            series%label = label
            series%color = color
            allocate (series%x(2*((n + length - 1)/length)))
            allocate (series%y, mold=series%x)
            points = 0
            do first = 1, n, length
               last = min(n, first + length - 1)
               there = [(is_present(k, marks), k=first, last)]
               ends = [minloc(values(first:last), 1, there, kind=int64), &
                       maxloc(values(first:last), 1, there, kind=int64)]      ! 0 of an empty block
               ends = first - 1 + [minval(ends), maxval(ends)]
               do k = 1, merge(1, 2, ends(1) == ends(2))
                  points = points + 1
                  series%x(points) = real(ends(k) - 1, dp)*record%sample_interval
                  series%y(points) = ieee_value(0.0_dp, ieee_quiet_nan)
                  if (ends(k) >= first) series%y(points) = values(ends(k))
               end do
            end do
            series%x = series%x(:points)
            series%y = series%y(:points)
         end associate
      end subroutine set_series

      !> The first outliers: samples of the record that the cleaned series does not have.
      subroutine set_outliers(values, kept, marks)
         real(dp), intent(in) :: values(:)
         !> 1 where the cleaned series, and where the record has a sample: [n]; everywhere if absent
         integer(int8), intent(in) :: kept(:)
         integer(int8), intent(in), optional :: marks(:)
         integer(int64) :: found(max_outliers), k
         integer :: n

         n = 0
         do k = 1, size(kept, kind=int64)
            if (kept(k) /= 0_int8 .or. n == max_outliers) cycle
            if (.not. is_present(k, marks)) cycle
            n = n + 1
            found(n) = k
         end do
         if (n == 0) return
         figure%series(2) = series_type("outliers", "points", 4, &
                                        real(found(:n) - 1, dp)*record%sample_interval, &
                                        values(found(:n)))
      end subroutine set_outliers

   end subroutine build_series_figure

   !> A sample is there.
   pure logical function is_present(k, marks)
      integer(int64), intent(in) :: k
      integer(int8), intent(in), optional :: marks(:)

      is_present = .true.
      if (present(marks)) is_present = marks(k) /= 0_int8
   end function is_present

   !> The files of a folder of results that have names of figures.
   subroutine find_figures(directory, names)
      !> May be missing
      character(*), intent(in) :: directory
      !> Below it: [number of files]
      character(name_length), allocatable, intent(out) :: names(:)
      character(:), allocatable :: folder, list
      integer :: pass, first, last

      folder = directory//"/"//figure_folder//c_null_char
      list = ""
      do pass = 1, 2                                       ! the length of all names, the names
         first = int(list_files(folder, ".svg"//c_null_char, list, len(list, c_size_t)))
         if (pass == 1) list = repeat("/", first)
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
