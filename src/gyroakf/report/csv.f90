! SPDX-License-Identifier: MIT
!> series.csv: the series before and after as a table for other programs, or as binary rows; and the
!> CSV renderer of a description: its members in a line, of a list how many values it has.
module gyroakf_report_csv
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_io_columns_writer, only : column_type, put_rows, row_layout_type
   use gyroakf_io_writer, only : format_real, put, put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type
   use gyroakf_report_description, only : description_type, unknown_type
   use gyroakf_report_text_layout, only : count_text, if_known
   implicit none (type, external)
   private
   public :: write_series, series_output_type, csv_row_type, quoted

   !> How the series are written
   type :: series_output_type
      !> "csv", "npy" (NumPy's, float64, a row per sample) or "f64" (the same without a header)
      character(3) :: form = "csv"
      !> Significant digits in csv; 0: as few as read back to the same numbers
      integer :: digits = 0
   end type series_output_type

   !> Columns of a channel in series.csv
   character(11), parameter :: series_names(8) = [character(11) :: "raw", "cleaned", "kf", "akf", &
      "drift", "compensated", "drift_kf", "drift_akf"]

   !> Enough for every number of a file that was written with 15 digits
   integer, parameter :: digits = 15

   !> Every member takes a column, known or not, which its title names, or else its key
   type, extends(description_type) :: csv_row_type
      !> Names and values
      character(:), allocatable :: head, line
   contains
      procedure :: begin
      procedure :: close => close_group
      procedure :: value => put_value
      procedure :: values => put_values
   end type csv_row_type

contains

   !> series.csv: time and the columns of `series_names`, a line per sample; or the same columns as
   !> binary rows.
   !>
   !> Several channels stand side by side, `gx_raw, gx_cleaned, ..., gx_drift_akf, gy_raw, ...`.
   !> Time is in s from the first sample, the sample's number from 0 where no rate is known.
   !> `cleaned` is nan where an outlier was removed; the filters bridge what is missing. kf and akf
   !> are those of the cleaned series without its mean. `drift` is the smoothed drift of the record
   !> as read, its level included, `compensated` is raw less drift; both, and drift_kf and
   !> drift_akf, are nan throughout where there is no drift.
   subroutine write_series(writer, record, result, output, error, progress)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> As read
      type(record_type), intent(in), target :: record
      !> With the series kept
      type(pipeline_result_type), intent(in), target :: result
      !> Form and digits
      type(series_output_type), intent(in) :: output
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback, in samples
      class(progress_type), intent(inout), optional :: progress
      type(column_type), target :: columns(1 + size(series_names)*size(result%channel))
      type(column_type), pointer :: of(:)
      type(channel_result_type), pointer :: channel
      type(row_layout_type) :: layout
      integer :: c, i

      columns%digits = output%digits
      columns(1) = column_type(step=record%sample_interval, digits=15)
      layout%form = "text"
      if (output%form /= "csv") layout%form = output%form
      layout%stage = "writing series."//output%form
      if (layout%form == "text") call put(writer, "time")
      do c = 1, size(result%channel)
         of => columns(2 + (c - 1)*size(series_names):1 + c*size(series_names))
         channel => result%channel(c)
         do i = 1, merge(size(series_names), 0, layout%form == "text")
            call put(writer, ","//quoted( &
                     if_known(size(result%channel) > 1, channel%name//"_")//trim(series_names(i))))
         end do
         of(1)%value => record%value(:, c)
         if (allocated(record%present)) of(1)%present => record%present(:, c)
         of(2)%present => of(1)%present
         of(6)%present => of(1)%present
         if (allocated(channel%series_present)) of(2)%present => channel%series_present
         call set(2, channel%series_cleaned)
         if (channel%available%kf) call set(3, channel%series_kf)
         if (channel%available%akf) call set(4, channel%series_akf)
         call set(5, channel%series_drift)
         call set(6, channel%series_compensated)
         call set(7, channel%series_drift_kf)
         call set(8, channel%series_drift_akf)
      end do
      if (layout%form == "text") call put_line(writer, "")
      call put_rows(writer, columns, size(record%value, 1, kind=int64), layout, error, progress)

   contains

      !> One column, nan throughout where the series is absent.
      subroutine set(i, series)
         integer, intent(in) :: i
         real(dp), intent(in), target, contiguous, optional :: series(:)

         if (present(series)) of(i)%value => series
      end subroutine set

   end subroutine write_series

   !> A field of text, in quotes where it needs them; one that a spreadsheet would take for a
   !> formula begins with an apostrophe.
   pure function quoted(text) result(field)
      !> Any
      character(*), intent(in) :: text
      character(:), allocatable :: field
      integer :: i

      field = text
      if (scan(text(:min(1, len(text))), "=+-@") == 1) field = "'"//text
      if (scan(text, ',"'//new_line("a")//achar(13)) == 0) return
      field = '"'//field(:len(field) - len(text))
      do i = 1, len(text)
         if (text(i:i) == '"') field = field//'"'
         field = field//text(i:i)
      end do
      field = field//'"'
   end function quoted

   !> A line has no groups.
   subroutine begin(self, key, list)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list

      self%complete = self%complete .or. key == "" .or. list
   end subroutine begin

   subroutine close_group(self)
      class(csv_row_type), intent(inout) :: self

      self%complete = .true.
   end subroutine close_group

   subroutine put_value(self, key, value)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value
      character(:), allocatable :: text, name

      if (.not. self%member%shown) return
      text = ""
      select type (value)
      type is (real(dp)); text = format_real(value, digits)
      type is (integer); text = count_text(int(value, int64))
      type is (integer(int64)); text = count_text(value)
      type is (logical); text = trim(merge("true ", "false", value))
      type is (character(*)); text = quoted(value)
      type is (unknown_type); if (value%number) text = "nan"
      end select
      name = key
      if (allocated(self%member%title)) name = self%member%title
      if (allocated(self%line)) then
         name = self%head//","//name
         text = self%line//","//text
      end if
      call move_alloc(name, self%head)
      call move_alloc(text, self%line)
   end subroutine put_value

   !> Of a list, how many values it has.
   subroutine put_values(self, key, value)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)

      call put_value(self, key, size(value))
   end subroutine put_values

end module gyroakf_report_csv
