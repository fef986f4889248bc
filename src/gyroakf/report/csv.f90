! SPDX-License-Identifier: MIT
!> Tables for other programs: a head line, a line per row, `nan` where something is missing.
!> series.csv: the series before and after, or as binary rows; the results.
module gyroakf_report_csv
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_units, only : term_names
   use gyroakf_io_columns_writer, only : column_type, put_rows, row_layout_type
   use gyroakf_io_writer, only : put, put_line, put_real, writer_type
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_ar_model, only : ar_spectrum
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage, stage_names
   use gyroakf_report_text_layout, only : if_known
   implicit none (type, external)
   private
   public :: write_series, series_output_type, write_table, quoted

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

   !> Intervals between 0 and the Nyquist frequency in ar_spectrum.csv
   integer, parameter :: frequency_steps = 1024

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

   !> One of the tables below.
   !>
   !> - allan.csv: a line per channel, series and tau; deviations in the unit of the input
   !> - coefficients.csv: a line per channel, series and term; the reduction stands with akf
   !> - correlation.csv: a line per channel and lag: autocorrelation, partial autocorrelation (nan
   !>   where it does not exist), the 95 % limit of white noise and Bartlett's, Ljung-Box over the
   !>   lags so far with its p, present pairs
   !> - spectrum.csv: a line per channel and frequency of Welch's spectrum of the cleaned series:
   !>   frequency in Hz (cycles per sample without a rate), two-sided density with its limits and
   !>   one-sided density in the unit of the input squared over that of the frequency, degrees of
   !>   freedom
   !> - ar_spectrum.csv: the two-sided density of each channel's model from 0 to the Nyquist
   !>   frequency, in the unit of the record squared times s; cycles a sample and samples where no
   !>   rate is known. A model that is not stationary has none
   subroutine write_table(writer, table, result, interval)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Name of its file
      character(*), intent(in) :: table
      type(pipeline_result_type), intent(in), target :: result
      !> Sample interval, s; 1 without a rate
      real(dp), intent(in) :: interval
      type(channel_result_type), pointer :: channel
      character(:), allocatable :: name, head
      real(dp) :: frequency(0:frequency_steps)
      integer, allocatable :: lag(:)
      integer :: c, i, n

      select case (table)
      case ("allan.csv"); head = "series,kind,tau,deviation,lower,upper,edf,terms,model"
      case ("coefficients.csv")
         head = "series,term,value,std_error,upper_limit_95,detected,unit,reduction_percent,"// &
            "read_off,value_si,std_error_si,upper_limit_95_si,unit_si,definition,state"
      case ("correlation.csv"); head = "lag,acf,pacf,limit,ljung_box,p_value,bartlett_limit,pairs"
      case ("spectrum.csv"); head = "frequency,density_two_sided,lower,upper,density_one_sided,edf"
      case default; head = "frequency,density"
      end select
      call put_line(writer, "channel,"//head)
      frequency = [(real(i, dp), i=0, frequency_steps)]/(2.0_dp*real(frequency_steps, dp)*interval)
      do c = 1, size(result%channel)
         channel => result%channel(c)
         name = quoted(channel%name)
         associate (is => channel%available, welch => channel%spectrum, &
                    correlation => channel%correlation)
            select case (table)
            case ("allan.csv"); call put_curves()
            case ("coefficients.csv"); call put_coefficients()
            case ("correlation.csv")
               if (.not. is%correlation) cycle
               n = correlation%lags
               lag = [(i, i=1, n)]
               call add_rows(name, [real(lag, dp), correlation%acf(lag), &
                                    where_known(correlation%pacf(lag), &
                                                lag <= correlation%partial_lags), &
                                    correlation%limit(lag), correlation%ljung_box(lag), &
                                    correlation%ljung_box_p(lag), correlation%bartlett(lag), &
                                    real(correlation%pairs(lag), dp)], 8)
            case ("spectrum.csv")
               if (.not. is%spectrum) cycle
               call add_rows(name, [welch%frequency, welch%density, welch%lower, welch%upper, &
                                    welch%one_sided, welch%edf], 6)
            case default
               if (.not. (is%ar .and. channel%ar%stationary)) cycle
               call add_rows(name, [frequency, (ar_spectrum(channel%ar, frequency(i), interval), &
                                                i=0, frequency_steps)], 2)
            end select
         end associate
      end do

   contains

      !> Numbers with a comma in front of each; 15 digits keep those of a file that has as many.
      subroutine put_numbers(values)
         real(dp), intent(in) :: values(:)
         integer :: i

         do i = 1, size(values)
            call put(writer, ",")
            call put_real(writer, values(i), merge(10, 15, table == "spectrum.csv"))
         end do
      end subroutine put_numbers

      !> Lines of names and numbers.
      subroutine add_rows(names, values, columns)
         character(*), intent(in) :: names
         !> Column after column
         real(dp), intent(in) :: values(:)
         integer, intent(in) :: columns
         integer :: i

         do i = 1, size(values)/columns
            call put(writer, names)
            call put_numbers(values(i::size(values)/columns))
            call put_line(writer, "")
         end do
      end subroutine add_rows

      !> The curves of every series, with the model where one was fitted; it is not positive where
      !> the fit says nothing.
      subroutine put_curves()
         real(dp), allocatable :: model(:)
         integer :: which

         do which = stage%input, stage%compensated
            associate (allan => channel%allan(which))
               if (.not. allan%available) cycle
               model = 0*allan%curve%tau
               if (allan%fitted) model = allan%noise%model
               call put_curve(which, allan%curve, model)
               if (.not. allocated(allan%other)) cycle
               do i = 1, size(allan%other)
                  if (.not. allocated(allan%other(i)%tau)) cycle
                  call put_curve(which, allan%other(i), 0*allan%other(i)%tau)
               end do
            end associate
         end do
      end subroutine put_curves

      subroutine put_curve(which, curve, model)
         integer, intent(in) :: which
         type(allan_curve_type), intent(in) :: curve
         real(dp), intent(in) :: model(:)

         call add_rows(name//","//trim(stage_names(which))//","//trim(curve%kind), &
                       [curve%tau, curve%deviation, curve%lower, curve%upper, curve%edf, &
                        real(curve%terms, dp), where_known(model, model > 0.0_dp)], 7)
      end subroutine put_curve

      !> The terms of every series.
      subroutine put_coefficients()
         integer :: which

         do which = stage%input, stage%compensated
            associate (allan => channel%allan(which), term => channel%allan(which)%stated%term)
               if (.not. allan%fitted) cycle
               do i = 1, size(term)
                  call put(writer, name//","//trim(stage_names(which))//","//term_names(i))
                  call put_numbers(where_known([term(i)%value, term(i)%std_error, &
                                                term(i)%upper_limit], term(i)%fitted))
                  call put(writer, ","//trim(merge("true ", "false", term(i)%detected))//","// &
                           quoted(term(i)%unit))
                  call put_numbers(where_known( &
                                   [channel%reduction_percent(i), allan%read_off%value(i)], &
                                   [which == stage%akf .and. channel%reduction_known(i), &
                                    allan%read_off%found(i)]))
                  call put_numbers(where_known([term(i)%value_si, term(i)%std_error_si, &
                                                term(i)%upper_limit_si], &
                                               term(i)%fitted .and. allan%stated%in_units))
                  call put_line(writer, ","//quoted(term(i)%unit_si)//","// &
                                quoted(term(i)%definition)//","//trim(term(i)%state))
               end do
            end associate
         end do
      end subroutine put_coefficients

   end subroutine write_table

   !> A value, NaN where it is not known.
   elemental real(dp) function where_known(value, known)
      real(dp), intent(in) :: value
      logical, intent(in) :: known

      where_known = ieee_value(value, ieee_quiet_nan)
      if (known) where_known = value
   end function where_known

end module gyroakf_report_csv
