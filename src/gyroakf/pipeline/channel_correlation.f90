! SPDX-License-Identifier: MIT
!> Tests of one channel that look at its correlation: KPSS, autocorrelation and whiteness.
module gyroakf_pipeline_channel_correlation
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_stats_autocovariance, only : autocovariance_type, compute_autocovariance
   use gyroakf_series_kpss, only : test_kpss
   use gyroakf_stats_whiteness, only : ljung_box_of
   use gyroakf_stats_correlation, only : correlation_of
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: run_stationarity, run_correlation, correlation_lags

contains

   !> KPSS test.
   subroutine run_stationarity(z, options, channel, error, valid, progress)
      !> The series: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> `kpss` is filled, or its failure noted
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call test_kpss(z, options%kpss, channel%kpss, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%kpss = .not. allocated(error)
      call note_failure(channel, "KPSS test", error)
   end subroutine run_stationarity

   !> Autocorrelation and Ljung-Box test of a series.
   subroutine run_correlation(z, options, channel, error, valid, shared, progress)
      !> The series: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> `correlation` and `ljung_box` are filled, or failures noted
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Autocovariances that are there already; taken where they reach far enough
      type(autocovariance_type), intent(in), optional :: shared
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean
      integer :: lags

      lags = correlation_lags(options, size(z, kind=int64))
      if (present(shared)) then
         if (allocated(shared%r)) then
            if (ubound(shared%r, 1) >= lags) then
               if (present(valid)) then
                  call correlate(shared%r(0:lags), size(z, kind=int64), channel, error, shared%pairs(0:lags))
               else
                  call correlate(shared%r(0:lags), size(z, kind=int64), channel, error)
               end if
               return
            end if
         end if
      end if
      call compute_autocovariance(z, lags, mean, r, error, valid, pairs, progress)
      if (is_fatal(error)) return
      if (allocated(error)) then
         call note_failure(channel, "Ljung-Box test", error)
      else if (present(valid)) then
         call correlate(r, size(z, kind=int64), channel, error, pairs)
      else
         call correlate(r, size(z, kind=int64), channel, error)
      end if
   end subroutine run_correlation

   !> Number of lags: as asked, less than the samples; by itself a fifth of the samples at most.
   pure integer function correlation_lags(options, n) result(lags)
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> Samples of the series
      integer(int64), intent(in) :: n

      lags = int(min(int(options%ljung_box_lags, int64), max(1_int64, n/5)))
      if (options%correlation_lags > 0) lags = int(min(int(options%correlation_lags, int64), n - 1))
   end function correlation_lags

   !> The same from autocovariances that were accumulated elsewhere.
   subroutine correlate(r, n, channel, error, pairs)
      !> Biased autocovariances: [0:h], h >= 1
      real(dp), intent(in), contiguous :: r(0:)
      !> Samples of the series, > h
      integer(int64), intent(in) :: n
      !> `correlation` and `ljung_box` are filled, or failures noted
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error
      !> Present pairs: [0:h]
      integer(int64), intent(in), optional :: pairs(0:)

      call ljung_box_of(r, n, 0, channel%ljung_box, error, pairs)
      channel%available%ljung_box = .not. allocated(error)
      if (.not. allocated(error)) call correlation_of(r, n, 0, channel%correlation, error, pairs)
      if (is_fatal(error)) return
      channel%available%correlation = .not. allocated(error)
      call note_failure(channel, "Ljung-Box test", error)
   end subroutine correlate

end module gyroakf_pipeline_channel_correlation
