! SPDX-License-Identifier: MIT
!> Figures of a channel's statistics: histogram, autocorrelation, spectrum, and the data that they draw.
module gyroakf_report_figure_statistics
   use gyroakf_kinds, only : dp
   use gyroakf_ar_spectrum, only : ar_spectrum
   use gyroakf_io_writer, only : writer_type, format_real, put_line
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_figure_script, only : add_curve, begin_block, begin_script, black, blue, end_block, end_plot, grey, orange, &
      put_axes, put_numbers
   use gyroakf_stats_correlation, only : correlation_type
   use gyroakf_stats_histogram, only : histogram_type
   implicit none (type, external)
   private
   public :: write_histogram_figure, write_correlation_figure, write_spectrum_figure
   public :: write_histogram_data, write_correlation_data, write_spectrum_data

contains

   !> Density of the samples and of the normal distribution of their mean and variance.
   subroutine write_histogram_figure(writer, name, form, channel, unit)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of the figure; its format
      character(*), intent(in) :: name, form
      !> With a histogram
      type(channel_result_type), intent(in) :: channel
      !> Of the rate
      character(*), intent(in) :: unit
      integer :: curves

      call begin_script(writer, name, form, "Distribution of "//channel%name//", "//trim(channel%tested), .false.)
      call put_axes(writer, "rate, "//unit, "density, 1/("//unit//")", "")
      call put_line(writer, "set yrange [0:*]")
      curves = 0
      call add_curve(writer, curves, "'"//name//".dat' using 1:2:3", &
                     "boxes fs solid 0.35 noborder lc rgb "//blue, "samples")
      call add_curve(writer, curves, "'' using 1:4", "lines lw 2 lc rgb "//orange, "normal")
      call end_plot(writer, curves)
   end subroutine write_histogram_figure

   !> Autocorrelation with the limits of white noise.
   subroutine write_correlation_figure(writer, name, form, what)
      !> As of write_histogram_figure
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name, form
      !> Whose correlation it is
      character(*), intent(in) :: what
      integer :: curves

      call begin_script(writer, name, form, "Autocorrelation of "//what, .false.)
      call put_axes(writer, "lag, samples", "autocorrelation", "")
      call put_line(writer, "set xrange [0:*]")
      curves = 0
      call add_curve(writer, curves, "'"//name//".dat' index 'autocorrelation' using 1:3:4", "filledcurves fc rgb "//grey, &
                     "95 % of white noise")
      call add_curve(writer, curves, "'' index 'autocorrelation' using 1:2", "impulses lw 2.5 lc rgb "//blue, "autocorrelation")
      call add_curve(writer, curves, "'' index 'partial' using 1:2", "points pt 6 ps 0.7 lw 1.5 lc rgb "//orange, "partial")
      call end_plot(writer, curves)
   end subroutine write_correlation_figure

   !> Welch's spectrum with its limits; that of the AR model where there is one.
   subroutine write_spectrum_figure(writer, name, form, channel, unit)
      !> As of write_histogram_figure
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name, form
      type(channel_result_type), intent(in) :: channel
      character(*), intent(in) :: unit
      integer :: curves

      call begin_script(writer, name, form, "Power spectral density of "//channel%name//", cleaned", .false.)
      call put_axes(writer, "frequency, "//trim(channel%frequency_unit), "two-sided density, ("//unit//")²/"// &
                    trim(channel%frequency_unit), "xy")
      curves = 0
      call add_curve(writer, curves, "'"//name//".dat' index 'welch' using 1:3:4", "filledcurves fc rgb "//blue, &
                     format_real(100*channel%spectrum%confidence, 3)//" % limits")
      call add_curve(writer, curves, "'' index 'welch' using 1:2", "lines lw 1.5 lc rgb "//blue, "Welch")
      if (has_model(channel)) call add_curve(writer, curves, "'' index 'model' using 1:2", &
                                             "lines lw 2 dt 2 lc rgb "//black, "AR model")
      call end_plot(writer, curves)
   end subroutine write_spectrum_figure

   !> Bins: centre, density, width, normal density.
   subroutine write_histogram_data(writer, histogram)
      !> Open
      type(writer_type), intent(inout) :: writer
      type(histogram_type), intent(in) :: histogram
      integer :: i

      do i = 1, size(histogram%count)
         call put_numbers(writer, [0.5_dp*(histogram%edge(i - 1) + histogram%edge(i)), histogram%density(i), &
                                   histogram%edge(i) - histogram%edge(i - 1), histogram%normal_density(i)])
      end do
   end subroutine write_histogram_data

   !> Lags: number, autocorrelation, limit of white noise; then the partial ones.
   subroutine write_correlation_data(writer, correlation)
      !> Open
      type(writer_type), intent(inout) :: writer
      type(correlation_type), intent(in) :: correlation
      integer :: k

      call begin_block(writer, "autocorrelation")
      do k = 1, correlation%lags
         call put_numbers(writer, [real(k, dp), correlation%acf(k), -correlation%limit(k), correlation%limit(k)])
      end do
      call end_block(writer)
      call begin_block(writer, "partial")
      do k = 1, correlation%partial_lags
         call put_numbers(writer, [real(k, dp), correlation%pacf(k)])
      end do
      call end_block(writer)
   end subroutine write_correlation_data

   !> Frequencies above zero: density and its limits; then the density of the AR model.
   subroutine write_spectrum_data(writer, channel, interval)
      !> Open
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      !> Between samples, s; 1 without a rate
      real(dp), intent(in) :: interval
      integer :: k

      call begin_block(writer, "welch")
      associate (spectrum => channel%spectrum)
         do k = lbound(spectrum%frequency, 1), ubound(spectrum%frequency, 1)
            if (spectrum%frequency(k) > 0.0_dp) call put_numbers(writer, &
               [spectrum%frequency(k), spectrum%density(k), spectrum%lower(k), spectrum%upper(k)])
         end do
         call end_block(writer)
         if (.not. has_model(channel)) return
         call begin_block(writer, "model")
         do k = lbound(spectrum%frequency, 1), ubound(spectrum%frequency, 1), max(1, size(spectrum%frequency)/500)
            if (spectrum%frequency(k) > 0.0_dp) call put_numbers(writer, &
               [spectrum%frequency(k), ar_spectrum(channel%ar, spectrum%frequency(k), interval)])
         end do
      end associate
      call end_block(writer)
   end subroutine write_spectrum_data

   !> Whether an AR model is drawn: one that has a spectrum.
   pure logical function has_model(channel)
      type(channel_result_type), intent(in) :: channel

      has_model = channel%available%ar .and. channel%ar%stationary
   end function has_model

end module gyroakf_report_figure_statistics
