! SPDX-License-Identifier: MIT
!> What the Allan kernel and the text parser move, beside what the memory gives: `roofline SAMPLES TEXT-FILE`, one and two
!> threads, medians of five, all in turn.
!>
!> The memory: a read pass over SAMPLES doubles, and the triad a = b + s c (24 bytes an element, and 8 for the line of a that is
!> read before it is written). The file: its bytes copied by stream reading, from the page cache.
!>
!> The Allan deviation of n samples at octave averaging times moves, where nothing is kept in the caches from pass to pass, 8 bytes
!> for the sums of the blocks, 8 + 8 + 8 for the integral (rate, phase, the line of the phase before it is written), 8 for all
!> factors up to 32768 together, and 8 for every four octaves above. Reading text moves each byte three times (page cache, buffer,
!> the line before it is written) and 16 bytes a sample.
program roofline
   use, intrinsic :: iso_fortran_env, only : error_unit, int8, output_unit
   use omp_lib, only : omp_get_wtime, omp_set_num_threads
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fill_normal, int64, random_type, &
      & read_record, reader_options, record_type, seed_random
   implicit none (type, external)

   integer, parameter :: rounds = 5, measures = 5
   integer, parameter :: read_pass = 1, triad = 2, allan = 3, copy = 4, parse = 5
   integer(int64), parameter :: short_max = 32768
   character(*), parameter :: name(measures) = [character(24) :: "read pass", "triad", "Allan deviation, octaves", &
      & "bytes of the text copied", "text into a record"]

   call main()

contains

   !> Measures, prints a table for one and for two threads.
   subroutine main()
      real(dp), allocatable :: x(:), y(:), z(:)
      type(random_type) :: random
      character(1024) :: word, path
      integer(int64) :: n, bytes, lines
      real(dp) :: seconds(rounds, measures), moved(measures), total
      integer :: threads, i, unit

      call get_command_argument(1, word)
      read (word, *) n
      call get_command_argument(2, path)
      allocate (x(n), y(n), z(n))
      call seed_random(random, 1_int64)
      call fill_normal(random, x)
      y(:) = x
      z(:) = x
      open (newunit=unit, file=trim(path), access="stream", form="unformatted", action="read", status="old")
      inquire (unit=unit, size=bytes)
      close (unit)
      total = 0.0_dp
      do threads = 1, 2
         call omp_set_num_threads(threads)
         do i = 1, rounds
            call take_times(trim(path), x, y, z, seconds(i, :), lines, total)
         end do
         moved = [8*real(n, dp), 32*real(n, dp), real(n, dp)*(40 + 8*((octaves_above(n) + 3)/4)), 3*real(bytes, dp), &
            & 3*real(bytes, dp) + 16*real(lines, dp)]
         call print_table(threads, seconds, moved)
      end do
      if (total < -huge(total)) write (output_unit, "(a)") "the sums are needed"
   end subroutine main

   !> Each once.
   subroutine take_times(path, x, y, z, seconds, lines, total)
      character(*), intent(in) :: path
      !> The record, and two series of its length
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(inout), contiguous :: y(:), z(:)
      !> Seconds: [measures]
      real(dp), intent(out) :: seconds(:)
      !> Samples of the text
      integer(int64), intent(out) :: lines
      !> Something of every result
      real(dp), intent(inout) :: total

      type(allan_curve_type) :: curve
      type(record_type) :: record
      type(error_type), allocatable :: error
      real(dp) :: start

      start = omp_get_wtime()
      total = total + sum_of(x)
      seconds(read_pass) = omp_get_wtime() - start
      start = omp_get_wtime()
      call add_scaled(x, y, z)
      seconds(triad) = omp_get_wtime() - start
      start = omp_get_wtime()
      call compute_allan(x, 1.0_dp, allan_options(), curve, error)
      seconds(allan) = omp_get_wtime() - start
      if (allocated(error)) call stop_with(error)
      start = omp_get_wtime()
      total = total + copied(path)
      seconds(copy) = omp_get_wtime() - start
      start = omp_get_wtime()
      call read_record(path, reader_options(), record, error)
      seconds(parse) = omp_get_wtime() - start
      if (allocated(error)) call stop_with(error)
      lines = record%audit%samples
      total = total + z(1) + curve%deviation(1)
   end subroutine take_times

   !> Sum of all values, in four chains.
   real(dp) function sum_of(x)
      real(dp), intent(in), contiguous :: x(:)

      integer(int64) :: i, quarter
      real(dp) :: s1, s2, s3, s4

      quarter = size(x, kind=int64)/4
      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      !$omp parallel do simd reduction(+:s1, s2, s3, s4)
      do i = 1, quarter
         s1 = s1 + x(i)
         s2 = s2 + x(i + quarter)
         s3 = s3 + x(i + 2*quarter)
         s4 = s4 + x(i + 3*quarter)
      end do
      !$omp end parallel do simd
      sum_of = (s1 + s2) + (s3 + s4)
   end function sum_of

   !> z = x + 3 y
   subroutine add_scaled(x, y, z)
      real(dp), intent(in), contiguous :: x(:), y(:)
      real(dp), intent(inout), contiguous :: z(:)

      integer(int64) :: i

      !$omp parallel do simd
      do i = 1, size(x, kind=int64)
         z(i) = x(i) + 3*y(i)
      end do
      !$omp end parallel do simd
   end subroutine add_scaled

   !> Reads a file in pieces of 128 kB; its last byte.
   real(dp) function copied(path)
      character(*), intent(in) :: path

      integer(int8) :: piece(131072)
      integer(int64) :: bytes, at
      integer :: unit

      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", status="old")
      inquire (unit=unit, size=bytes)
      at = 0
      do while (at < bytes)
         read (unit) piece(:min(131072_int64, bytes - at))
         at = at + 131072
      end do
      close (unit)
      copied = real(piece(1), dp)
   end function copied

   !> Octaves above the longest of the factors that are taken together.
   pure integer function octaves_above(n)
      integer(int64), intent(in) :: n

      octaves_above = 0
      do while (short_max*2_int64**(octaves_above + 1) <= n/2)
         octaves_above = octaves_above + 1
      end do
   end function octaves_above

   !> Seconds, gigabytes a second, share of what the triad moves.
   subroutine print_table(threads, seconds, moved)
      integer, intent(in) :: threads
      !> [rounds, measures]
      real(dp), intent(in) :: seconds(:, :)
      !> Bytes: [measures]
      real(dp), intent(in) :: moved(:)

      real(dp) :: rate(measures), most
      integer :: i

      rate = [(1.0e-9_dp*moved(i)/median(seconds(:, i)), i=1, measures)]
      most = maxval(rate([read_pass, triad]))
      write (output_unit, "(i0, a)") threads, " thread(s)                     seconds    GB/s  share of the memory's bandwidth"
      do i = 1, measures
         write (output_unit, "(2x, a, f12.4, f8.2, f8.0, a)") name(i), median(seconds(:, i)), rate(i), 100*rate(i)/most, " %"
      end do
      write (output_unit, "(a, i0, a, f6.2, a)") "figure: memory's bandwidth, GB/s, ", threads, " thread(s) |", most, " | -"
      write (output_unit, "(a, i0, a, f6.0, a)") "figure: Allan deviation, share of the memory's bandwidth, %, ", threads, &
         & " thread(s) |", 100*rate(allan)/most, " | -"
      write (output_unit, "(a, i0, a, f6.0, a)") "figure: text into a record, share of the memory's bandwidth, %, ", threads, &
         & " thread(s) |", 100*rate(parse)/most, " | -"
   end subroutine print_table

   !> The middle one.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(rounds)

      integer :: j

      median = x(1)
      do j = 1, rounds
         if (count(x < x(j)) <= rounds/2 .and. count(x <= x(j)) > rounds/2) median = x(j)
      end do
   end function median

   subroutine stop_with(error)
      type(error_type), intent(in) :: error

      write (error_unit, "(a)") error%message
      stop 1, quiet=.true.
   end subroutine stop_with

end program roofline
