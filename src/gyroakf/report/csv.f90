! SPDX-License-Identifier: MIT
!> Results as tables for other programs: comma-separated, one head line, `nan` where something is missing.
module gyroakf_report_csv
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_units, only : term_names
   use gyroakf_io_columns_writer, only : begin_rows, column_type, put_rows, row_layout_type, set_even
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_pipeline_result, only : pipeline_result_type, channel_result_type, stated_coefficient_type, stage, stage_names
   use gyroakf_report_text_layout, only : count_text
   implicit none (type, external)
   private
   public :: write_series, write_allan, write_coefficients, series_output_type, quoted

   !> How the series are written
   type :: series_output_type
      !> "csv", "npy" (NumPy's, float64, a row per sample) or "f64" (the same without a header)
      character(3) :: form = "csv"
      !> Significant digits in csv; 0: as few as read back to the same numbers
      integer :: digits = 0
   end type series_output_type

   !> Columns of a channel in series.csv
   character(11), parameter :: series_names(8) = [character(11) :: "raw", "cleaned", "kf", "akf", "drift", "compensated", &
                                                  "drift_kf", "drift_akf"]

   !> Enough for every number of a file that was written with 15 digits
   integer, parameter :: digits = 15

contains

   !> series.csv: time and the columns of `series_names`, a line per sample; or the same columns as binary rows.
   !>
   !> Several channels stand side by side, `gx_raw, gx_cleaned, ..., gx_drift_akf, gy_raw, ...`. Time is in s from the first
   !> sample, the sample's number from 0 where no rate is known. `cleaned` is nan where an outlier was removed; the filters
   !> bridge what is missing. kf and akf are those of the cleaned series without its mean. `drift` is the smoothed drift of the
   !> record as read, its level included, `compensated` is raw less drift; both, and drift_kf and drift_akf, are nan throughout
   !> where there is no drift.
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
      type(column_type) :: columns(1 + size(series_names)*size(result%channel))
      type(row_layout_type) :: layout
      integer(int64) :: n
      integer :: c

      n = size(record%value, 1, kind=int64)
      columns%digits = output%digits
      call set_even(columns(1), 0_int64, record%sample_interval)
      do c = 1, size(result%channel)
         call set_columns(columns(2 + (c - 1)*size(series_names):1 + c*size(series_names)), record, result%channel(c), c)
      end do
      layout%form = "text"
      if (output%form /= "csv") layout%form = output%form
      layout%stage = "writing series."//output%form
      if (layout%form == "text") call put_heads(writer, result)
      call begin_rows(writer, size(columns), n, layout)
      call put_rows(writer, columns, 1_int64, n, layout, error, progress)
   end subroutine write_series

   !> The line of names.
   subroutine put_heads(writer, result)
      type(writer_type), intent(inout) :: writer
      type(pipeline_result_type), intent(in) :: result
      character(:), allocatable :: prefix
      integer :: c, i

      call put(writer, "time")
      do c = 1, size(result%channel)
         prefix = ""
         if (size(result%channel) > 1) prefix = result%channel(c)%name//"_"
         do i = 1, size(series_names)
            call put(writer, ","//quoted(prefix//trim(series_names(i))))
         end do
      end do
      call put_line(writer, "")
   end subroutine put_heads

   !> One channel's columns; what was not computed stays nan.
   subroutine set_columns(columns, record, channel, c)
      !> In the order of the names
      type(column_type), intent(inout) :: columns(:)
      type(record_type), intent(in), target :: record
      type(channel_result_type), intent(in), target :: channel
      integer, intent(in) :: c

      columns(1)%value => record%value(:, c)
      if (allocated(record%present)) columns(1)%present => record%present(:, c)
      if (allocated(channel%series_cleaned)) columns(2)%value => channel%series_cleaned
      columns(2)%present => columns(1)%present
      if (allocated(channel%series_present)) columns(2)%present => channel%series_present
      if (allocated(channel%series_kf) .and. channel%available%kf) columns(3)%value => channel%series_kf
      if (allocated(channel%series_akf) .and. channel%available%akf) columns(4)%value => channel%series_akf
      if (allocated(channel%series_drift)) columns(5)%value => channel%series_drift
      if (allocated(channel%series_compensated)) columns(6)%value => channel%series_compensated
      columns(6)%present => columns(1)%present
      if (allocated(channel%series_drift_kf)) columns(7)%value => channel%series_drift_kf
      if (allocated(channel%series_drift_akf)) columns(8)%value => channel%series_drift_akf
   end subroutine set_columns

   subroutine put_value(writer, value, known)
      type(writer_type), intent(inout) :: writer
      real(dp), intent(in) :: value
      logical, intent(in) :: known

      if (known) then
         call put(writer, ",")
         call put_real(writer, value, digits)
      else
         call put(writer, ",nan")
      end if
   end subroutine put_value

   !> allan.csv: a line per channel, series and tau; deviations in the unit of the input.
   subroutine write_allan(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Curves
      type(pipeline_result_type), intent(in) :: result
      integer :: c, which, i

      call put_line(writer, "channel,series,kind,tau,deviation,lower,upper,edf,terms,model")
      do c = 1, size(result%channel)
         do which = stage%input, stage%compensated
            associate (allan => result%channel(c)%allan(which))
               if (.not. allan%available) cycle
               do i = 1, size(allan%curve%tau)
                  call put(writer, quoted(result%channel(c)%name)//","//trim(stage_names(which))//","//trim(allan%curve%kind))
                  call put_value(writer, allan%curve%tau(i), .true.)
                  call put_value(writer, allan%curve%deviation(i), .true.)
                  call put_value(writer, allan%curve%lower(i), .true.)
                  call put_value(writer, allan%curve%upper(i), .true.)
                  call put_value(writer, allan%curve%edf(i), .true.)
                  call put(writer, ","//count_text(allan%curve%terms(i)))
                  if (allan%fitted) then
                     call put_value(writer, allan%noise%model(i), allan%noise%model(i) > 0.0_dp)
                  else
                     call put(writer, ",nan")
                  end if
                  call put_line(writer, "")
               end do
               if (.not. allocated(allan%other)) cycle
               do i = 1, size(allan%other)
                  call write_curve(writer, quoted(result%channel(c)%name)//","//trim(stage_names(which)), allan%other(i))
               end do
            end associate
         end do
      end do
   end subroutine write_allan

   !> The lines of a curve without a model.
   subroutine write_curve(writer, names, curve)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Channel and series
      character(*), intent(in) :: names
      !> Nothing is written where it could not be computed
      type(allan_curve_type), intent(in) :: curve
      integer :: i

      if (.not. allocated(curve%tau)) return
      do i = 1, size(curve%tau)
         call put(writer, names//","//trim(curve%kind))
         call put_value(writer, curve%tau(i), .true.)
         call put_value(writer, curve%deviation(i), .true.)
         call put_value(writer, curve%lower(i), .true.)
         call put_value(writer, curve%upper(i), .true.)
         call put_value(writer, curve%edf(i), .true.)
         call put_line(writer, ","//count_text(curve%terms(i))//",nan")
      end do
   end subroutine write_curve

   !> coefficients.csv: a line per channel, series and term; the reduction stands with akf.
   subroutine write_coefficients(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Coefficients
      type(pipeline_result_type), intent(in) :: result
      integer :: c, which, term

      call put_line(writer, "channel,series,term,value,std_error,upper_limit_95,detected,unit,reduction_percent,read_off,"// &
                    "value_si,std_error_si,upper_limit_95_si,unit_si,definition,state")
      do c = 1, size(result%channel)
         do which = stage%input, stage%compensated
            associate (channel => result%channel(c), allan => result%channel(c)%allan(which))
               if (.not. allan%fitted) cycle
               do term = 1, 5
                  call put_coefficient(writer, channel, which, term_names(term), allan%stated%term(term), term)
                  call put_line(writer, "")
               end do
            end associate
         end do
      end do
   end subroutine write_coefficients

   !> The columns of a coefficient.
   subroutine put_coefficient(writer, channel, which, name, stated, term)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      !> Component of [[gyroakf_pipeline_result:stage]]
      integer, intent(in) :: which
      !> Letter of the term
      character(*), intent(in) :: name
      type(stated_coefficient_type), intent(in) :: stated
      !> 1 .. 5
      integer, intent(in) :: term
      logical :: reduced, read

      associate (allan => channel%allan(which))
         reduced = which == stage%akf .and. channel%reduction_known(term)
         read = allan%read_off%found(term)
         call put(writer, quoted(channel%name)//","//trim(stage_names(which))//","//name)
         call put_value(writer, stated%value, stated%fitted)
         call put_value(writer, stated%std_error, stated%fitted)
         call put_value(writer, stated%upper_limit, stated%fitted)
         call put(writer, ","//trim(merge("true ", "false", stated%detected))//","//quoted(stated%unit))
         call put_value(writer, channel%reduction_percent(term), reduced)
         call put_value(writer, allan%read_off%value(term), read)
         call put_value(writer, stated%value_si, stated%fitted .and. allan%stated%in_units)
         call put_value(writer, stated%std_error_si, stated%fitted .and. allan%stated%in_units)
         call put_value(writer, stated%upper_limit_si, stated%fitted .and. allan%stated%in_units)
         call put(writer, ","//quoted(stated%unit_si)//","//quoted(stated%definition)//","//trim(stated%state))
      end associate
   end subroutine put_coefficient

   !> A field of text, in quotes where it needs them.
   pure function quoted(text) result(field)
      !> Any
      character(*), intent(in) :: text
      character(:), allocatable :: field
      integer :: i

      field = text
      if (scan(text, ',"'//new_line("a")//achar(13)) == 0) return
      field = '"'
      do i = 1, len(text)
         if (text(i:i) == '"') field = field//'"'
         field = field//text(i:i)
      end do
      field = field//'"'
   end function quoted

end module gyroakf_report_csv
