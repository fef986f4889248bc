! SPDX-License-Identifier: MIT
!> The streamed Allan deviation against the exact one, on many simulated records.
!>
!>     ./run.sh [RECORDS [SAMPLES]]
!>
!> The share of the degrees of freedom that is kept is 1/(1 + var(streamed - exact)/var(exact)), of the squared deviations over
!> the records (what is lost adds to the exact estimate, uncorrelated with it); beside it stands what `sampling_efficiency`
!> says. Then the time of both.
program allan_stream
   use gyroakf, only : allan_curve_type, allan_options, allan_stream_type, begin_allan_stream, compute_allan, dp, error_type, &
      & feed_allan_stream, finish_allan_stream, int64, record_type, sampling_efficiency, simulate_options, simulate_record
   implicit none (type, external)

   integer, parameter :: starts(4) = [4, 8, 16, 32]
   integer(int64) :: samples
   integer :: records

   records = 400
   samples = 100000
   call read_arguments()
   call one_noise("white rate noise", 2, 0)
   call one_noise("flicker", 3, -1)
   call one_noise("random walk", 4, -2)
   call one_noise("quantisation", 1, 2)
   call time_both(20000000_int64)

contains

   !> Numbers of records and of samples.
   subroutine read_arguments()
      character(20) :: word

      if (command_argument_count() > 0) then
         call get_command_argument(1, word)
         read (word, *) records
      end if
      if (command_argument_count() > 1) then
         call get_command_argument(2, word)
         read (word, *) samples
      end if
   end subroutine read_arguments

   !> The table of one noise.
   subroutine one_noise(name, term, alpha)
      !> Its name
      character(*), intent(in) :: name
      !> Its place among Q N B K R, and its exponent
      integer, intent(in) :: term, alpha

      real(dp), allocatable :: value(:, :, :)
      integer(int64), allocatable :: m(:)
      real(dp) :: kept, told
      integer :: i, j, s

      m = [(2_int64**i, i=6, 12)]
      allocate (value(records, size(m), 0:size(starts)))
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(i, term, value(i, :, :))
      end do
      !$omp end parallel do
      print "(/, a, *(6x, a, i0, 6x, :))", "      m", ("S = ", starts(s), s=1, size(starts))
      print "(2a)", name, ": kept in simulated records (and as told)"
      do j = 1, size(m)
         write (*, "(i7)", advance="no") m(j)
         do s = 1, size(starts)
            kept = 1/(1 + spread_of(value(:, j, s) - value(:, j, 0))/spread_of(value(:, j, 0)))
            told = sampling_efficiency(m(j), max(1_int64, m(j)/starts(s)), alpha)
            write (*, "(f9.4, ' (', f6.4, ')')", advance="no") kept, told
         end do
         print *
      end do
   end subroutine one_noise

   !> Squared deviations of one record: exact, and streamed with each S.
   subroutine one_record(number, term, value)
      !> Its number, which is its seed
      integer, intent(in) :: number
      !> Its noise
      integer, intent(in) :: term
      !> [averaging time, exact and each S]
      real(dp), intent(out) :: value(:, 0:)

      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_options) :: grid
      type(allan_curve_type) :: curve
      type(allan_stream_type) :: stream
      type(error_type), allocatable :: failure
      integer :: s

      options%samples = samples
      options%rate_hz = 1
      options%seed = number
      options%coefficient(term) = 1
      grid%taus = "64,128,256,512,1024,2048,4096"
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) call compute_allan(record%value(:, 1), 1.0_dp, grid, curve, failure)
      if (allocated(failure)) error stop failure%message
      value(:, 0) = curve%deviation**2
      do s = 1, size(starts)
         call begin_allan_stream(stream, 1.0_dp, grid, failure, starts=starts(s))
         if (.not. allocated(failure)) call feed_allan_stream(stream, record%value(:, 1), failure)
         if (.not. allocated(failure)) call finish_allan_stream(stream, curve, failure)
         if (allocated(failure)) error stop failure%message
         value(:, s) = curve%deviation**2
      end do
   end subroutine one_record

   !> Variance of a sample.
   pure real(dp) function spread_of(x)
      real(dp), intent(in) :: x(:)

      spread_of = sum((x - sum(x)/size(x))**2)/(size(x) - 1)
   end function spread_of

   !> Time per sample, octave averaging times.
   subroutine time_both(n)
      !> Samples
      integer(int64), intent(in) :: n

      type(allan_curve_type) :: curve
      type(allan_stream_type) :: stream
      type(error_type), allocatable :: failure
      type(simulate_options) :: options
      type(record_type) :: record
      integer(int64) :: start, middle, finish, rate, i

      options%samples = n
      options%coefficient(2) = 1
      call simulate_record(options, record, failure)
      if (allocated(failure)) error stop failure%message
      call system_clock(start, rate)
      call compute_allan(record%value(:, 1), 1.0_dp, allan_options(), curve, failure)
      call system_clock(middle)
      call begin_allan_stream(stream, 1.0_dp, allan_options(), failure)
      do i = 1, n, 65536
         call feed_allan_stream(stream, record%value(i:min(n, i + 65535), 1), failure)
      end do
      call finish_allan_stream(stream, curve, failure)
      call system_clock(finish)
      print "(/, a, f6.2, a, f6.2, a)", "exact ", 1e9_dp*real(middle - start, dp)/rate/n, " ns a sample, streamed ", &
         & 1e9_dp*real(finish - middle, dp)/rate/n, " ns a sample"
   end subroutine time_both

end program allan_stream
