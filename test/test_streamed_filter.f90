! SPDX-License-Identifier: MIT
!> Tests of the filters over a recording that goes by in blocks: gyroakf_pipeline_streamed_filter, gyroakf_ar_lag_stream, the sums
!> of gyroakf_series_differences, gyroakf_filter_block_stream. What they give is what the record in memory gives.
module test_streamed_filter
   use testdrive, only : check, error_type, new_unittest, unittest_type
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : fatal_error, gyro_error => error_type, status
   use gyroakf_ar_autocovariance, only : compute_autocovariance, residual_autocovariance
   use gyroakf_ar_lag_stream, only : begin_lag_stream, feed_lag_stream, finish_lag_stream, lag_stream_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_series, only : filter_result_type
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_io_recording, only : base_bytes, close_recording, open_recording, recording_type
   use gyroakf_io_scratch, only : close_scratch, open_scratch, read_scratch, scratch_type, write_scratch
   use gyroakf_pipeline, only : channel_result_type, filter_streamed, pipeline_options, pipeline_result_type, run_pipeline, &
      series_sink_type
   use gyroakf_record, only : record_type, sample_count
   use gyroakf_series_differences, only : difference_stream_type, difference_variance, feed_differences, variance_of_differences
   use scratch_file, only : remove_file, scratch_path
   implicit none (type, external)
   private
   public :: collect_streamed_filter

   !> Relative agreement that is asked for
   real(dp), parameter :: close = 1.0e-12_dp
   integer, parameter :: rows = 70000

   !> Compares the series with those in memory, sample by sample
   type, extends(series_sink_type) :: comparer_type
      type(record_type) :: record
      type(pipeline_result_type) :: result
      real(dp) :: largest = 0.0_dp
      integer(int64) :: next = 0
      logical :: odd = .false., refuses = .false.
   contains
      procedure :: take
   end type comparer_type

   !> That of what a filter says: coefficients that agree to `close` are divided by 1 - phi on their way into gains and variances
   real(dp), parameter :: in_parts = 1.0e-11_dp

contains

   !> Names the tests.
   subroutine collect_streamed_filter(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("lags", test_lags), &
         new_unittest("lags-of-residuals", test_residuals), &
         new_unittest("lags-of-a-constant", test_constant_lags), &
         new_unittest("differences", test_differences), &
         new_unittest("two-channels", test_two), &
         new_unittest("missing", test_missing), &
         new_unittest("increments", test_increments), &
         new_unittest("part", test_part), &
         new_unittest("robust", test_robust), &
         new_unittest("fixed-order", test_fixed_order), &
         new_unittest("slow-drift", test_slow), &
         new_unittest("scratch-file", test_scratch), &
         new_unittest("no-scratch-file", test_no_scratch), &
         new_unittest("constant", test_constant), &
         new_unittest("refused", test_refused), &
         new_unittest("sink-fails", test_sink_fails)]
   end subroutine collect_streamed_filter

   !> A correlated series with an offset, and a mask with gaps.
   subroutine make_series(x, valid)
      real(dp), intent(out) :: x(:)
      integer(int8), intent(out) :: valid(:)
      integer :: i

      x(1) = 3.0_dp
      do i = 2, size(x)
         x(i) = 3.0_dp + 0.6_dp*(x(i - 1) - 3.0_dp) + sin(real(i, dp)*real(i, dp)*0.37_dp)
      end do
      valid = 1_int8
      do i = 1, size(x)
         if (modulo(i, 97) == 5 .or. i < 4 .or. (i > 5000 .and. i < 5100)) valid(i) = 0_int8
      end do
   end subroutine make_series

   subroutine test_lags(error)
      type(error_type), allocatable, intent(out) :: error
      type(lag_stream_type) :: stream
      type(gyro_error), allocatable :: failed
      real(dp) :: x(20000), mean, streamed_mean
      integer(int8) :: valid(20000)
      real(dp), allocatable :: r(:), streamed(:)
      integer(int64), allocatable :: pairs(:), streamed_pairs(:)
      integer :: from, step, masked

      call make_series(x, valid)
      do masked = 0, 1
         if (masked == 0) call compute_autocovariance(x, 12, mean, r, failed, pairs=pairs)
         if (masked == 1) call compute_autocovariance(x, 12, mean, r, failed, valid, pairs)
         call begin_lag_stream(stream, 12, failed)
         from = 1
         step = 1
         do while (from <= size(x))                       ! parts of 1, 2, 4, ... samples
            if (masked == 0) call feed_lag_stream(stream, x(from:min(from + step - 1, size(x))))
            if (masked == 1) call feed_lag_stream(stream, x(from:min(from + step - 1, size(x))), &
                                                  valid(from:min(from + step - 1, size(x))))
            from = from + step
            step = 2*step
         end do
         call finish_lag_stream(stream, streamed_mean, streamed, streamed_pairs)
         call check(error, abs(streamed_mean/mean - 1) <= close, "mean")
         if (.not. allocated(error)) call check(error, all(pairs == streamed_pairs), "pairs")
         if (.not. allocated(error)) call check(error, all(abs(streamed - r) <= close*r(0)), "autocovariances")
         if (allocated(error)) return
      end do
   end subroutine test_lags

   subroutine test_residuals(error)
      type(error_type), allocatable, intent(out) :: error
      type(lag_stream_type) :: stream
      type(gyro_error), allocatable :: failed
      real(dp), parameter :: phi(3) = [0.5_dp, 0.1_dp, -0.05_dp]
      real(dp) :: x(20000), mean
      integer(int8) :: valid(20000)
      real(dp), allocatable :: r(:), streamed(:)
      integer(int64), allocatable :: pairs(:), streamed_pairs(:)
      integer(int64) :: samples

      call make_series(x, valid)
      call residual_autocovariance(x, 3.1_dp, phi, 20, r, failed, valid, pairs)
      call begin_lag_stream(stream, 20, failed, phi, 3.1_dp)
      call feed_lag_stream(stream, x(:2), valid(:2))
      call feed_lag_stream(stream, x(3:9000), valid(3:9000))
      call feed_lag_stream(stream, x(9001:), valid(9001:))
      call finish_lag_stream(stream, mean, streamed, streamed_pairs, samples)
      call check(error, samples, 19997_int64)
      if (.not. allocated(error)) call check(error, all(pairs == streamed_pairs), "pairs")
      if (.not. allocated(error)) call check(error, all(abs(streamed - r) <= close*r(0)), "autocovariances")
   end subroutine test_residuals

   subroutine test_constant_lags(error)
      type(error_type), allocatable, intent(out) :: error
      type(lag_stream_type) :: stream
      type(gyro_error), allocatable :: failed
      real(dp) :: x(9999), mean
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)

      x = 0.1_dp
      call begin_lag_stream(stream, 2, failed)
      call feed_lag_stream(stream, x)
      call feed_lag_stream(stream, x)
      call finish_lag_stream(stream, mean, r, pairs)
      call check(error, .not. abs(r(0)) > 0.0_dp, "a constant has no variance, to the last bit")
      if (.not. allocated(error)) call begin_lag_stream(stream, -1, failed)
      if (.not. allocated(error)) call check(error, allocated(failed), "negative lag")
   end subroutine test_constant_lags

   subroutine test_differences(error)
      type(error_type), allocatable, intent(out) :: error
      type(difference_stream_type) :: stream, masked
      real(dp) :: x(20000)
      integer(int8) :: valid(20000)
      integer :: i

      call make_series(x, valid)
      do i = 1, 20000, 1250
         call feed_differences(stream, x(i:i + 1249))
         call feed_differences(masked, x(i:i + 1249), valid(i:i + 1249))
      end do
      call check(error, abs(variance_of_differences(stream)/difference_variance(x) - 1) <= close, "all")
      if (.not. allocated(error)) call check(error, abs(variance_of_differences(masked)/difference_variance(x, valid) - 1) <= &
                                             close, "with gaps")
   end subroutine test_differences

   !> Compares the next samples.
   subroutine take(self, block, part, before, samples, error)
      class(comparer_type), intent(inout) :: self
      type(record_type), intent(in) :: block
      type(pipeline_result_type), intent(in) :: part
      integer(int64), intent(in) :: before, samples
      type(gyro_error), allocatable, intent(out) :: error
      integer(int64) :: n
      integer :: c

      n = size(block%value, 1, kind=int64)
      self%odd = self%odd .or. before /= self%next .or. samples /= sample_count(self%record)
      self%next = before + n
      if (self%refuses) call fatal_error(error, status%io, "enough")
      if (self%odd .or. self%next > samples) return
      do c = 1, size(part%channel)
         self%odd = self%odd .or. block%channel(c)%text /= self%record%channel(c)%text
         associate (whole => self%result%channel(c), now => part%channel(c))
            self%odd = self%odd .or. (whole%available%kf .neqv. now%available%kf)
            call compare_series(self%record%value(before + 1:before + n, c), block%value(:, c), self%largest)
            call compare_series(whole%series_cleaned(before + 1:before + n), now%series_cleaned, self%largest)
            if (.not. now%available%kf) cycle
            call compare_series(whole%series_kf(before + 1:before + n), now%series_kf, self%largest)
            call compare_series(whole%series_akf(before + 1:before + n), now%series_akf, self%largest)
            self%odd = self%odd .or. (allocated(now%series_drift_kf) .neqv. allocated(whole%series_drift_kf))
            if (self%odd .or. .not. allocated(now%series_drift_kf)) cycle
            call compare_series(whole%series_drift_kf(before + 1:before + n), now%series_drift_kf, self%largest)
            call compare_series(whole%series_drift_akf(before + 1:before + n), now%series_drift_akf, self%largest)
            self%odd = self%odd .or. .not. (allocated(now%series_drift) .and. allocated(now%series_compensated))
            if (self%odd) cycle
            call compare_series(whole%series_drift(before + 1:before + n), now%series_drift, self%largest)
            call compare_series(whole%series_compensated(before + 1:before + n), now%series_compensated, self%largest)
         end associate
      end do
   end subroutine take

   !> The largest difference.
   pure subroutine compare_series(a, b, largest)
      real(dp), intent(in) :: a(:), b(:)
      real(dp), intent(inout) :: largest

      largest = max(largest, maxval(abs(a - b)))
   end subroutine compare_series

   !> Writes rows: stamps with lost ones, and one or two correlated columns with an offset.
   subroutine write_rows(head, stamped, columns, gaps)
      character(*), intent(in) :: head
      logical, intent(in) :: stamped, gaps
      integer, intent(in) :: columns
      integer :: unit, i, j
      real(dp) :: x(columns)

      x = 0.0_dp
      open (newunit=unit, file=scratch_path("filter.txt"), status="replace", action="write")
      write (unit, "(a)") head
      do i = 1, rows
         do j = 1, columns
            x(j) = 0.7_dp*x(j) + sin(real(i, dp)*real(i, dp)*0.37_dp + j) + 1.0e-5_dp*i
         end do
         if (stamped .and. modulo(i, 10007) == 5) cycle
         if (stamped) write (unit, "(f0.3, ',')", advance="no") 0.01_dp*i + 1.0e-9_dp*i*i
         if (gaps .and. modulo(i, 7919) == 3) then
            write (unit, "(*(a, :, ','))") ("nan", j=1, columns)
         else
            write (unit, "(*(f0.6, :, ','))") (x(j) + 10*j, j=1, columns)
         end if
      end do
      close (unit)
   end subroutine write_rows

   !> Filters only.
   pure type(pipeline_options) function filters_only() result(options)
      options%do_tests = .false.
      options%do_allan = .false.
      options%clean%method = "none"
      options%clean%degree = -1
      options%keep_series = .true.
   end function filters_only

   !> Filters the file in memory and in blocks and fails unless both are alike; the file is removed.
   subroutine compare(error, reader, options, least_block)
      type(error_type), allocatable, intent(out) :: error
      type(reader_options), intent(in) :: reader
      type(pipeline_options), intent(in) :: options
      !> The drift comes from means of as many samples at least
      integer(int64), intent(in), optional :: least_block
      type(comparer_type) :: sink
      type(recording_type) :: recording
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed
      type(reader_options) :: limited
      integer :: c

      call read_record(scratch_path("filter.txt"), reader, sink%record, failed)
      if (.not. allocated(failed)) call run_pipeline(sink%record, options, sink%result, failed)
      limited = reader
      limited%memory = base_bytes + 12000000
      if (.not. allocated(failed)) call open_recording(scratch_path("filter.txt"), limited, recording, failed)
      if (.not. allocated(failed)) call filter_streamed(recording, options, record, result, failed, sink, &
                                                            scratch=directory_of(scratch_path("filter.txt")))
      call close_recording(recording)
      call remove_file(scratch_path("filter.txt"))
      if (allocated(failed)) then
         call check(error, .false., failed%message)
         return
      end if
      call check(error, record%audit%samples, size(sink%record%value, 1, kind=int64), "samples")
      if (.not. allocated(error)) call check(error, .not. sink%odd .and. sink%next == record%audit%samples, "series")
      if (.not. allocated(error)) call check(error, sink%largest <= 1.0e-10_dp, "values of the series")
      if (.not. allocated(error)) call check(error, size(result%channel), size(sink%result%channel), "channels")
      do c = 1, size(result%channel)
         if (.not. allocated(error)) call compare_channel(error, c, result, sink%result)
         if (allocated(error)) return
         if (present(least_block)) call check(error, result%channel(c)%drift%block >= least_block, "block means are not used")
      end do
   end subroutine compare

   !> Model, figures and warnings of a channel.
   subroutine compare_channel(error, c, streamed, whole)
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in) :: c
      type(pipeline_result_type), intent(in) :: streamed, whole
      integer :: i

      associate (a => streamed%channel(c), b => whole%channel(c))
         call check(error, alike(a%raw%mean, b%raw%mean) .and. alike(a%raw%variance, b%raw%variance), "moments")
         if (.not. allocated(error)) call check(error, a%ar%order, b%ar%order, "order")
         if (allocated(error)) return
         call check(error, all(abs(a%ar%coefficient - b%ar%coefficient) <= close) .and. alike(a%ar%mean, b%ar%mean) .and. &
                    alike(a%ar%noise_variance, b%ar%noise_variance) .and. all(abs(a%ar%std_error - b%ar%std_error) <= close), "AR")
         if (.not. allocated(error)) call check(error, alike(a%ar%residual_ljung_box%statistic, &
            b%ar%residual_ljung_box%statistic) .and. a%ar%residual_ljung_box%lags == b%ar%residual_ljung_box%lags, "residuals")
         if (.not. allocated(error)) call compare_filter(error, a%kf, b%kf)
         if (.not. allocated(error)) call compare_filter(error, a%akf, b%akf)
         if (.not. allocated(error)) call check(error, (a%available%drift .eqv. b%available%drift) .and. &
            (a%drift%found .eqv. b%drift%found) .and. alike(a%drift_time, b%drift_time), "drift")
         if (.not. allocated(error)) call check(error, a%drift%block == b%drift%block .and. &
            a%drift%samples == b%drift%samples .and. a%drift%of_samples == b%drift%of_samples, "what the drift was found in")
         if (.not. allocated(error)) call compare_model(error, a%drift%model, b%drift%model)
         if (.not. allocated(error)) call compare_filter(error, a%drift_kf, b%drift_kf)
         if (.not. allocated(error)) call compare_filter(error, a%drift_akf, b%drift_akf)
         if (.not. allocated(error)) call check(error, a%available%drift_smoother .eqv. b%available%drift_smoother, "smoother")
         if (.not. allocated(error)) call compare_filter(error, a%drift_smoother, b%drift_smoother)
         if (.not. allocated(error)) call check(error, alike(a%compensated_ratio, b%compensated_ratio) .and. &
            abs(a%compensated%mean - b%compensated%mean) <= in_parts*sqrt(b%compensated%variance) .and. &
            a%compensated%count == b%compensated%count .and. &
            alike(a%drift_smoother_figures%lost_percent, b%drift_smoother_figures%lost_percent), "without the drift")
         if (.not. allocated(error)) call check(error, alike(a%kf_figures%variance_ratio, b%kf_figures%variance_ratio) .and. &
            alike(a%akf_figures%raw_variance_ratio, b%akf_figures%raw_variance_ratio) .and. &
            alike(a%predictable_percent, b%predictable_percent), "figures")
         if (.not. allocated(error)) call check(error, allocated(a%warnings) .eqv. allocated(b%warnings), "warnings")
         if (allocated(error) .or. .not. allocated(b%warnings)) return
         call check(error, size(a%warnings), size(b%warnings), "number of warnings")
         do i = 1, size(b%warnings)
            if (.not. allocated(error)) call check(error, a%warnings(i)%text, b%warnings(i)%text)
         end do
      end associate
   end subroutine compare_channel

   !> Diagnostics of a filter.
   subroutine compare_filter(error, a, b)
      type(error_type), allocatable, intent(out) :: error
      type(filter_result_type), intent(in) :: a, b
      logical :: same

      ! the mean of what has none is what rounding leaves of the deviations
      same = abs(a%mean - b%mean) <= in_parts*sqrt(b%variance) .and. alike(a%variance, b%variance) .and. &
             alike(a%gain, b%gain) .and. alike(a%dc_gain, b%dc_gain) .and. alike(a%q, b%q) .and. alike(a%r, b%r) .and. &
             alike(a%nis_mean, b%nis_mean)
      call check(error, same, "measures of a filter")
      if (allocated(error)) return
      same = alike(a%ljung_box%statistic, b%ljung_box%statistic) .and. a%steps == b%steps .and. a%clamped == b%clamped .and. &
             a%gated == b%gated
      call check(error, same, "innovations and counts of a filter")
   end subroutine compare_filter

   !> The directory of a path.
   pure function directory_of(path) result(directory)
      character(*), intent(in) :: path
      character(:), allocatable :: directory

      directory = "."
      if (index(path, "/") > 0) directory = path(:index(path, "/", back=.true.) - 1)
   end function directory_of

   !> The same processes and white noise, to `in_parts`: coefficients near 1 by their distance from it.
   subroutine compare_model(error, a, b)
      type(error_type), allocatable, intent(out) :: error
      type(component_model_type), intent(in) :: a, b
      real(dp) :: worst
      integer :: i

      call check(error, a%count, b%count, "processes of the drift")
      if (allocated(error)) return
      worst = relative(a%r, b%r)
      do i = 1, a%count
         worst = max(worst, relative(1.0_dp - a%phi(i), 1.0_dp - b%phi(i)), relative(a%q(i), b%q(i)))
      end do
      call check(error, worst <= in_parts, "the drift's model, streamed and in memory")
   end subroutine compare_model

   !> Distance of two numbers over the second, 0 where both are 0.
   pure real(dp) function relative(a, b)
      real(dp), intent(in) :: a, b

      relative = abs(a - b)
      if (relative > 0.0_dp) relative = relative/max(abs(b), tiny(b))
   end function relative

   !> Equal but for rounding.
   pure logical function alike(a, b)
      real(dp), intent(in) :: a, b

      alike = abs(a - b) <= in_parts*max(abs(a), abs(b), 1.0e-3_dp)
   end function alike

   subroutine test_two(error)
      type(error_type), allocatable, intent(out) :: error

      call write_rows("# rate_hz: 100", .false., 2, .false.)
      call compare(error, reader_options(), filters_only())
   end subroutine test_two

   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error

      call write_rows("gx,gy", .false., 2, .true.)
      call compare(error, reader_options(rate_hz=50.0_dp), filters_only())
   end subroutine test_missing

   subroutine test_increments(error)
      type(error_type), allocatable, intent(out) :: error

      ! the rate of the first window is not that of the whole
      call write_rows("time_s,gx", .true., 1, .false.)
      call compare(error, reader_options(input="increment"), filters_only())
   end subroutine test_increments

   subroutine test_part(error)
      type(error_type), allocatable, intent(out) :: error

      ! the first window's rate would cut the part elsewhere
      call write_rows("time_s,gx", .true., 1, .true.)
      call compare(error, reader_options(from=100.0_dp, to=651.0_dp), filters_only())
   end subroutine test_part

   subroutine test_robust(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_options) :: options

      options = filters_only()
      options%design%akf = "robust"
      call write_rows("gx", .false., 1, .true.)
      call compare(error, reader_options(), options)
   end subroutine test_robust

   !> A random walk that the part does not show: the means of blocks of the whole record do, those of 16 samples here, for there are
   !> more than 32,768 of four; samples are missing, and whole blocks.
   subroutine test_slow(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: n = 150000
      type(pipeline_options) :: options
      real(dp) :: level, noise
      integer :: i, unit
      integer(int64) :: state

      level = 1.0_dp
      state = 12345_int64
      open (newunit=unit, file=scratch_path("filter.txt"), status="replace", action="write")
      write (unit, "(a)") "# rate_hz: 100"
      do i = 1, n
         call draw(state, noise)
         level = level + 1.0e-3_dp*noise
         call draw(state, noise)
         if (modulo(i, 50) == 7 .or. (i > 70000 .and. i < 70100)) then
            write (unit, "(a)") "nan"
         else
            write (unit, "(es22.15)") level + noise
         end if
      end do
      close (unit)
      options = filters_only()
      options%identification%most = 2000_int64
      call compare(error, reader_options(), options, 16_int64)
   end subroutine test_slow

   !> The next of a sequence of numbers between -0.5 and 0.5.
   pure subroutine draw(state, number)
      integer(int64), intent(inout) :: state
      real(dp), intent(out) :: number

      state = modulo(16807_int64*state, 2147483647_int64)
      number = real(state, dp)/2147483647.0_dp - 0.5_dp
   end subroutine draw

   subroutine test_fixed_order(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_options) :: options

      options = filters_only()
      options%ar%order = 2
      options%ar%max_order = 1
      call write_rows("gx", .false., 1, .false.)
      call compare(error, reader_options(), options)
   end subroutine test_fixed_order

   !> What is written anywhere in a scratch file is read back; nothing behind its end, nothing once it is closed.
   subroutine test_scratch(error)
      type(error_type), allocatable, intent(out) :: error
      type(scratch_type) :: scratch
      type(gyro_error), allocatable :: failed
      real(dp) :: read(5)

      call open_scratch(scratch, directory_of(scratch_path("filter.txt")), failed)
      if (.not. allocated(failed)) call write_scratch(scratch, 100000_int64, [1.0_dp, -2.0_dp, huge(1.0_dp)], failed)
      if (.not. allocated(failed)) call write_scratch(scratch, 99999_int64, [0.1_dp, 7.0_dp], failed)
      if (.not. allocated(failed)) call write_scratch(scratch, 5_int64, [real(dp) ::], failed)
      if (.not. allocated(failed)) call read_scratch(scratch, 99998_int64, read, failed)
      call check(error, .not. allocated(failed), "written and read")
      if (allocated(error)) return
      call check(error, all(transfer(read, [1_int64]) == transfer([0.0_dp, 0.1_dp, 7.0_dp, -2.0_dp, huge(1.0_dp)], [1_int64])))
      if (.not. allocated(error)) call read_scratch(scratch, 99999_int64, read, failed)
      if (.not. allocated(error)) call check(error, allocated(failed), "behind the end")
      if (.not. allocated(error)) call check(error, failed%code, status%io)
      call close_scratch(scratch)
      call close_scratch(scratch)
      if (.not. allocated(error)) call write_scratch(scratch, 0_int64, read, failed)
      if (.not. allocated(error)) call check(error, allocated(failed), "closed")
   end subroutine test_scratch

   !> A scratch file that cannot be made costs the smoother, and says why; so does none at all.
   subroutine test_no_scratch(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      type(gyro_error), allocatable :: failed

      call write_rows("# rate_hz: 100", .false., 1, .false.)
      options = filters_only()
      options%identification%most = 2000_int64
      call filter_file(base_bytes + 12000000, options, result, failed, scratch=scratch_path("filter.txt")//"/none")
      call check(error, .not. allocated(failed))
      if (.not. allocated(error)) call check_told(result%channel(1), "/none: a scratch file cannot be made there")
      if (.not. allocated(error)) call filter_file(base_bytes + 12000000, options, result, failed)
      if (.not. allocated(error)) call check_told(result%channel(1), "needs a scratch file")
      call remove_file(scratch_path("filter.txt"))

   contains

      !> The drift's filters are there, the smoother is not.
      subroutine check_told(channel, why)
         type(channel_result_type), intent(in) :: channel
         character(*), intent(in) :: why

         call check(error, channel%available%drift_akf .and. .not. channel%available%drift_smoother, "what is available")
         if (.not. allocated(error)) call check(error, size(channel%unavailable), 1)
         if (.not. allocated(error)) call check(error, index(channel%unavailable(1)%text, why) > 0, channel%unavailable(1)%text)
      end subroutine check_told

   end subroutine test_no_scratch

   !> Filters the file in blocks.
   subroutine filter_file(memory, options, result, failed, sink, scratch)
      integer(int64), intent(in) :: memory
      type(pipeline_options), intent(in) :: options
      type(pipeline_result_type), intent(out) :: result
      type(gyro_error), allocatable, intent(out) :: failed
      class(series_sink_type), intent(inout), optional :: sink
      !> Directory of a scratch file
      character(*), intent(in), optional :: scratch
      type(recording_type) :: recording
      type(record_type) :: record
      type(reader_options) :: reader

      reader%memory = memory
      call open_recording(scratch_path("filter.txt"), reader, recording, failed)
      if (.not. allocated(failed)) call filter_streamed(recording, options, record, result, failed, sink, scratch=scratch)
      call close_recording(recording)
   end subroutine filter_file

   subroutine test_constant(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_result_type) :: result
      type(gyro_error), allocatable :: failed
      integer :: unit, i

      open (newunit=unit, file=scratch_path("filter.txt"), status="replace", action="write")
      do i = 1, 1000
         write (unit, "(a)") "0.1"
      end do
      close (unit)
      call filter_file(base_bytes + 8000000, filters_only(), result, failed)
      call remove_file(scratch_path("filter.txt"))
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, .not. (result%channel(1)%available%ar .or. result%channel(1)%available%kf))
      if (.not. allocated(error)) call check(error, index(result%channel(1)%unavailable(1)%text, "AR model: ") == 1)
   end subroutine test_constant

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_result_type) :: result
      type(pipeline_options) :: options
      type(gyro_error), allocatable :: failed

      call write_rows("gx", .false., 1, .false.)
      options = filters_only()
      options%clean%method = "auto"
      call filter_file(base_bytes + 8000000, options, result, failed)
      call check(error, allocated(failed))
      if (.not. allocated(error)) call check(error, index(failed%message, "--outliers") > 0, failed%message)
      if (.not. allocated(error)) call filter_file(base_bytes + 1000, filters_only(), result, failed)
      if (.not. allocated(error)) call check(error, allocated(failed))
      if (.not. allocated(error)) call check(error, index(failed%message, "to stream it takes 28 MB") > 0, failed%message)
      call remove_file(scratch_path("filter.txt"))
   end subroutine test_refused

   subroutine test_sink_fails(error)
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_result_type) :: result
      type(comparer_type) :: sink
      type(gyro_error), allocatable :: failed

      call write_rows("gx", .false., 1, .false.)
      sink%refuses = .true.
      sink%odd = .true.
      call filter_file(base_bytes + 8000000, filters_only(), result, failed, sink)
      call remove_file(scratch_path("filter.txt"))
      call check(error, allocated(failed))
      if (.not. allocated(error)) call check(error, failed%code, status%io)
   end subroutine test_sink_fails

end module test_streamed_filter
