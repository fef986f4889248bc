! SPDX-License-Identifier: MIT
!> The overlapping Allan deviation of a record that streams by, in memory that does not grow with its length.
!>
!>     type(allan_stream_type) :: stream
!>     call begin_allan_stream(stream, sample_interval, options, error)
!>     do ...                                              ! as long as there are blocks of samples, of any length
!>        call feed_allan_stream(stream, rate, error)
!>     end do
!>     call finish_allan_stream(stream, curve, error)
!>
!> Of an averaging factor m every s-th term is taken, s = floor(m/S) and at least 1: up to m = 2S - 1 the curve is the exact one,
!> beyond it a window holds S to 2S starting points. Neighbouring terms are so alike that for white rate noise 99.5 % of the
!> degrees of freedom remain at S = 16 and 99.9 % at S = 32, more for flicker and random walk; of quantisation noise, its terms
!> independent, s times fewer remain ([[sampling_efficiency]]; S is the stride factor of C. A. Greenhall, W. J. Riley, Proc. 35th
!> PTTI Meeting (2003)). The curve's degrees of freedom and limits allow for it.
!>
!> The mean is not known beforehand: that of the first block is taken off, and a better one each time the record has doubled.
!> No second difference depends on it; only the rounding does. Missing samples: [[gyroakf_allan_gaps]].
!> Cost: every sample once for each m < 2S, a few operations a sample for all longer ones together. Results do not
!> depend on how the record was cut into blocks.
module gyroakf_allan_stream
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_degrees_of_freedom, only : sampling_efficiency
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, assemble_curve, check_arguments
   use gyroakf_allan_gaps, only : correct_for_gaps
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_phase, only : add_compensated, non_finite_count, present_sample
   use gyroakf_allan_second_difference, only : gap_sums_type
   use gyroakf_allan_stream_factor, only : add_all_terms, add_means, add_sampled_terms, begin_factor, block_type, factor_type, &
      & skip_means, tilt_factor
   use gyroakf_allan_stream_lags, only : identify_from_sums
   implicit none (type, external)
   private
   public :: allan_stream_type, begin_allan_stream, feed_allan_stream, finish_allan_stream

   !> Samples that are worked on at once
   integer(int64), parameter :: block_length = 8192
   !> Starting points of terms in a window, where it is not told
   integer, parameter :: starts_usual = 32
   !> No record is longer
   integer(int64), parameter :: samples_max = 2_int64**52
   !> Up to this m the noise is identified in every sparse-th block only, after the first dense ones
   integer(int64), parameter :: sparse_below = 128, dense_blocks = 16, sparse = 8

   !> A record in the stream; its components are for the procedures of this module
   type :: allan_stream_type
      !> What to compute
      type(allan_options) :: options
      !> Seconds
      real(dp) :: sample_interval = 1.0_dp
      !> Averaging factors, ascending, and whether they were asked for (the others are octaves that gaps need)
      type(factor_type), allocatable :: factor(:)
      logical, allocatable :: wanted(:)
      !> Factors that have begun; those that take every term; samples of history that these need
      integer :: begun = 0, short = 0
      integer(int64) :: history = 0
      !> Samples in whole blocks, missing ones among them, when the mean is looked at again, and samples that wait
      integer(int64) :: samples = 0, missing = 0, review = 0, waiting = 0
      !> Mean that is taken off, the first that was, and whether there is one
      real(dp) :: mean = 0.0_dp, first_mean = 0.0_dp
      logical :: has_mean = .false.
      !> Phase at the end of the last block, in two parts
      real(dp) :: high = 0.0_dp, low = 0.0_dp
      !> Samples and whether they are there: history, then the block
      real(dp), allocatable :: rate(:)
      integer(int8), allocatable :: there(:)
      type(block_type) :: block
   end type allan_stream_type

contains

   !> Prepares for a record.
   subroutine begin_allan_stream(stream, sample_interval, options, error, samples, starts)
      !> Fresh afterwards
      type(allan_stream_type), intent(out) :: stream
      !> Seconds, > 0; it may be told again at the end
      real(dp), intent(in) :: sample_interval
      !> Kind (oadev), grid (not "all"), confidence, coverage
      type(allan_options), intent(in) :: options
      !> invalid_argument, not_supported (another kind, every averaging time), too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Samples that will come, where that is known: no more memory than they need
      integer(int64), intent(in), optional :: samples
      !> S, starting points of terms in a window, >= 4; 32 if absent
      integer, intent(in), optional :: starts

      integer(int64) :: length
      integer :: s

      length = samples_max
      if (present(samples)) length = samples
      s = starts_usual
      if (present(starts)) s = starts
      call check_arguments(sample_interval, options, error)
      if (allocated(error)) return
      if (s < 4) then
         call fatal_error(error, status%invalid_argument, "a window needs at least 4 starting points of terms")
      else if (options%kind /= "oadev") then
         call fatal_error(error, status%not_supported, "a record is streamed for oadev only, not for "//trim(options%kind))
      else if (allocated(options%taus)) then
         if (options%taus == "all") call fatal_error(error, status%not_supported, "every averaging time of a record needs "// &
            & "the whole of it in memory; octave, decade, log:N or a list can be streamed")
      end if
      if (allocated(error)) return
      stream%options = options
      stream%sample_interval = sample_interval
      call choose_factors(stream, length, int(s, int64), error)
      if (.not. allocated(error)) call make_room(stream, error)
   end subroutine begin_allan_stream

   !> The factors that were asked for and the octaves.
   subroutine choose_factors(stream, length, s, error)
      !> Its factors are set
      type(allan_stream_type), intent(inout) :: stream
      !> Samples at most, and starting points in a window
      integer(int64), intent(in) :: length, s
      !> invalid_argument, too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64), allocatable :: asked(:), octave(:)
      integer(int64) :: m
      integer :: i, j, k

      if (allocated(stream%options%taus)) then
         call averaging_factors(stream%options%taus, length, stream%sample_interval, asked, error)
      else
         call averaging_factors("octave", length, stream%sample_interval, asked, error)
      end if
      if (.not. allocated(error)) call averaging_factors("octave", length, 1.0_dp, octave, error)
      if (allocated(error)) return
      k = size(asked)
      do j = 1, size(octave)
         if (.not. any(asked == octave(j))) k = k + 1
      end do
      allocate (stream%factor(k), stream%wanted(k))
      i = 1
      j = 1
      do k = 1, size(stream%factor)
         m = huge(m)
         if (i <= size(asked)) m = asked(i)
         if (j <= size(octave)) m = min(m, octave(j))
         stream%wanted(k) = .false.
         if (i <= size(asked)) stream%wanted(k) = asked(i) == m
         if (stream%wanted(k)) i = i + 1
         if (j <= size(octave)) then
            if (octave(j) == m) j = j + 1
         end if
         stream%factor(k)%m = m
         stream%factor(k)%stride = max(1_int64, m/s)
         stream%factor(k)%allowed = min(int((1 - stream%options%min_coverage)*real(m, dp) + 1e-9_dp, int64), m - 1)
         if (stream%factor(k)%stride == 1) stream%short = k
      end do
   end subroutine choose_factors

   !> Memory for a block and the history that the short factors need.
   subroutine make_room(stream, error)
      !> Its factors are set
      type(allan_stream_type), intent(inout) :: stream
      !> no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64) :: h
      integer :: stat

      h = 0
      if (stream%short > 0) h = 2*stream%factor(stream%short)%m
      stream%history = h
      allocate (stream%rate(1 - h:block_length), stat=stat)
      if (stat == 0) allocate (stream%there(1 - h:block_length), stat=stat)
      if (stat == 0) allocate (stream%block%phase(block_length), stat=stat)
      if (stat == 0) allocate (stream%block%missing(block_length), stat=stat)
      if (stat == 0) allocate (stream%block%near(-h:block_length), stat=stat)
      if (stat == 0) allocate (stream%block%near_missing(-h:block_length), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for a block of the record")
         return
      end if
      stream%block%missing = 0
   end subroutine make_room

   !> Takes the next samples.
   subroutine feed_allan_stream(stream, rate, error, valid)
      !> Prepared by [[begin_allan_stream]]
      type(allan_stream_type), intent(inout) :: stream
      !> Any number of samples; NaN and infinity count as missing
      real(dp), intent(in), contiguous :: rate(:)
      !> invalid_argument (lengths differ, not prepared), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [as rate]; all present if absent
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: i, done, n, all_there

      if (present(valid)) then
         if (size(valid, kind=int64) /= size(rate, kind=int64)) then
            call fatal_error(error, status%invalid_argument, "rate and valid have different lengths")
            return
         end if
      end if
      if (.not. allocated(stream%rate)) then
         call fatal_error(error, status%invalid_argument, "the stream has not begun, or is finished")
         return
      end if
      done = 0
      do while (done < size(rate, kind=int64))
         n = min(block_length - stream%waiting, size(rate, kind=int64) - done)
         if (is_complete(rate, done + 1, done + n, valid)) then
            stream%rate(stream%waiting + 1:stream%waiting + n) = rate(done + 1:done + n)
            stream%there(stream%waiting + 1:stream%waiting + n) = 1
            all_there = n
         else
            all_there = 0
         end if
         do i = all_there + 1, n
            stream%rate(stream%waiting + i) = 0
            stream%there(stream%waiting + i) = 0
            if (.not. present_sample(rate, done + i, valid)) cycle
            stream%rate(stream%waiting + i) = rate(done + i)
            stream%there(stream%waiting + i) = 1
         end do
         done = done + n
         stream%waiting = stream%waiting + n
         if (stream%waiting == block_length) call take_block(stream, error)
         if (allocated(error)) return
      end do
   end subroutine feed_allan_stream

   !> Whether every sample of a range is present and finite.
   pure logical function is_complete(rate, first, last, valid)
      !> The samples
      real(dp), intent(in), contiguous :: rate(:)
      !> The range
      integer(int64), intent(in) :: first, last
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)

      is_complete = non_finite_count(rate(first:last)) == 0
      if (present(valid) .and. is_complete) is_complete = all(valid(first:last) /= 0)
   end function is_complete

   !> Works on the samples that wait.
   subroutine take_block(stream, error)
      !> Their terms are added
      type(allan_stream_type), intent(inout) :: stream
      !> no_memory
      type(error_type), allocatable, intent(out) :: error

      integer :: i

      do while (stream%begun < size(stream%factor))
         i = stream%begun + 1
         if (stream%factor(i)%stride > stream%samples + block_length) exit
         call begin_factor(stream%factor(i), error)
         if (allocated(error)) return
         stream%begun = i
      end do
      call integrate_block(stream)
      do i = 1, stream%begun
         if (i <= stream%short) then
            call add_all_terms(stream%factor(i), stream%block)
         else
            call add_sampled_terms(stream%factor(i), stream%block)
         end if
         if (stream%factor(i)%m < sparse_below .and. stream%samples >= dense_blocks*block_length .and. &
            & modulo(stream%samples/block_length, sparse) /= 0) then
            call skip_means(stream%factor(i), stream%block)
         else
            call add_means(stream%factor(i), stream%block, stream%options%min_coverage)
         end if
      end do
      call leave_block(stream)
   end subroutine take_block

   !> The phase of the block, about the mean so far, and about its own with the history before it.
   subroutine integrate_block(stream)
      !> Its block is filled
      type(allan_stream_type), intent(inout) :: stream

      integer(int64) :: i, n, first, lost, there
      real(dp) :: total, own, tilt, base, y

      n = stream%waiting
      associate (block => stream%block)
         block%begin = stream%samples
         block%length = n
         block%history = min(stream%history, stream%samples)
         first = 1 - block%history
         there = sum(int(stream%there(1:n), int64))
         if (.not. stream%has_mean .and. there > 0) then
            stream%has_mean = .true.
            stream%mean = first_mean_of(stream%rate(1:n), stream%there(1:n))
            stream%first_mean = stream%mean
         end if
         block%shift = stream%mean - stream%first_mean
         block%complete = all(stream%there(first:n) == 1_int8)
         total = 0
         if (block%complete) then
            !$omp simd reduction(+:total)
            do i = 1, n
               total = total + (stream%rate(i) - stream%mean)
            end do
         else
            do i = 1, n
               total = total + (stream%rate(i) - stream%mean)*stream%there(i)
            end do
         end if
         own = stream%mean + total/real(max(there, 1_int64), dp)
         tilt = own - stream%mean
         y = 0
         lost = 0
         block%near(first - 1) = 0
         block%near_missing(first - 1) = 0
         if (block%complete) then
            do i = first, n
               y = y + (stream%rate(i) - own)
               block%near(i) = y
            end do
            block%near_missing(first:n) = 0
         else
            do i = first, n
               y = y + (stream%rate(i) - own)*stream%there(i)
               lost = lost + (1 - stream%there(i))
               block%near(i) = y
               block%near_missing(i) = lost
            end do
         end if
         base = block%near(0)
         lost = block%near_missing(0)
         do i = 1, n
            block%phase(i) = stream%high + (stream%low + ((block%near(i) - base) &
               & + tilt*real(i - (block%near_missing(i) - lost), dp)))
            block%missing(i) = stream%missing + (block%near_missing(i) - lost)
         end do
         stream%missing = block%missing(n)
         call add_compensated(stream%high, stream%low, (block%near(n) - base) + tilt*real(there, dp))
      end associate
   end subroutine integrate_block

   !> Mean of the samples that are there, about the first of them.
   pure real(dp) function first_mean_of(rate, there) result(mean)
      !> Samples, at least one of them there
      real(dp), intent(in), contiguous :: rate(:)
      !> 1 or 0
      integer(int8), intent(in), contiguous :: there(:)

      real(dp) :: reference
      integer(int64) :: i

      reference = rate(findloc(there, 1_int8, dim=1))
      mean = 0
      do i = 1, size(rate, kind=int64)
         mean = mean + (rate(i) - reference)*there(i)
      end do
      mean = reference + mean/real(count(there == 1_int8), dp)
   end function first_mean_of

   !> Keeps the history, and takes a better mean when the record has doubled.
   subroutine leave_block(stream)
      !> Ready for the next block
      type(allan_stream_type), intent(inout) :: stream

      integer(int64) :: i, n
      real(dp) :: before, slope
      integer :: k

      n = stream%waiting
      do i = 1 - stream%history, 0                      ! ascending: a short last block moves within the history
         stream%rate(i) = stream%rate(i + n)
         stream%there(i) = stream%there(i + n)
      end do
      stream%samples = stream%samples + n
      stream%waiting = 0
      if (stream%samples < stream%review .or. stream%samples == stream%missing) return
      stream%review = 2*stream%samples
      before = stream%mean
      stream%mean = before + (stream%high + stream%low)/real(stream%samples - stream%missing, dp)
      slope = stream%mean - before
      call add_compensated(stream%high, stream%low, -slope*real(stream%samples - stream%missing, dp))
      do k = 1, stream%begun
         call tilt_factor(stream%factor(k), slope)
      end do
   end subroutine leave_block

   !> The curve of all samples that were fed; the stream takes no more.
   subroutine finish_allan_stream(stream, curve, error, sample_interval)
      !> Spent afterwards
      type(allan_stream_type), intent(inout) :: stream
      !> The curve, `streamed` set; averaging times at which no term is left are not in it
      type(allan_curve_type), intent(out) :: curve
      !> invalid_argument, too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Seconds; that of the beginning if absent (a list of averaging times was rounded to multiples of that)
      real(dp), intent(in), optional :: sample_interval

      type(gap_sums_type), allocatable :: octave(:)
      type(gap_sums_type) :: sums
      real(dp), allocatable :: variance(:), share(:)
      integer(int64), allocatable :: m(:), terms(:)
      integer, allocatable :: alpha(:)
      integer :: i, points, last, steepest

      call end_of_stream(stream, points, error, sample_interval)
      if (allocated(error)) return
      allocate (variance(points), share(points), m(points), terms(points), alpha(points))
      call gather_octaves(stream, octave)
      points = 0
      last = 0
      steepest = 2                                      ! of a sum of power laws alpha never rises with tau: a late 1 or 2 is chance
      do i = 1, size(stream%factor)
         associate (factor => stream%factor(i))
            if (factor%m > stream%samples/2) exit
            if (factor%m*30 <= stream%samples) call identify_from_sums(factor%lags, last)
            steepest = min(steepest, last)
            if (.not. stream%wanted(i)) cycle
            sums = factor%sums
            sums%squares = sums%squares + factor%lost
            points = points + 1
            m(points) = factor%m
            terms(points) = sums%terms
            alpha(points) = last
            share(points) = real(sums%terms, dp)/real((stream%samples - 2*factor%m)/factor%stride + 1, dp) &
               & *sampling_efficiency(factor%m, factor%stride, steepest)
            variance(points) = 0
            if (sums%terms > 0) variance(points) = sums%squares/(2*real(sums%terms, dp))
            if (stream%missing > 0) call correct_for_gaps(sums, octave, factor%m, variance(points))
         end associate
      end do
      curve%kind = "oadev"
      curve%streamed = .true.
      call assemble_curve(stream%samples, stream%sample_interval, stream%options%confidence, m, variance, terms, curve, error, &
         & alpha, share)
   end subroutine finish_allan_stream

   !> Works on what waits, and counts the averaging times of the curve.
   subroutine end_of_stream(stream, points, error, sample_interval)
      !> Takes no more afterwards
      type(allan_stream_type), intent(inout) :: stream
      !> Averaging times, > 0
      integer, intent(out) :: points
      !> invalid_argument, too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Seconds
      real(dp), intent(in), optional :: sample_interval

      points = 0
      if (.not. allocated(stream%rate)) then
         call fatal_error(error, status%invalid_argument, "the stream has not begun, or is finished")
         return
      end if
      if (present(sample_interval)) then
         stream%sample_interval = sample_interval
         call check_arguments(sample_interval, stream%options, error)
      end if
      if (stream%waiting > 0 .and. .not. allocated(error)) call take_block(stream, error)
      if (allocated(error)) return
      deallocate (stream%rate)
      points = count(stream%wanted .and. stream%factor%m <= stream%samples/2)
      if (stream%samples == stream%missing) then
         call fatal_error(error, status%too_few_samples, "the record has no sample that is present and finite")
      else if (points == 0) then
         call fatal_error(error, status%too_few_samples, "no averaging time is short enough for this record")
      end if
   end subroutine end_of_stream

   !> Sums of m = 1, 2, 4 ... as far as they have terms.
   subroutine gather_octaves(stream, octave)
      !> Finished
      type(allan_stream_type), intent(in) :: stream
      !> Their sums
      type(gap_sums_type), allocatable, intent(out) :: octave(:)

      integer :: i, count

      count = 0
      allocate (octave(bit_size(stream%samples)))
      do i = 1, size(stream%factor)
         associate (factor => stream%factor(i))
            if (factor%m > stream%samples/2) exit
            if (popcnt(factor%m) /= 1) cycle
            count = count + 1
            octave(count) = factor%sums
            octave(count)%squares = factor%sums%squares + factor%lost
         end associate
      end do
      octave = octave(:count)
   end subroutine gather_octaves

end module gyroakf_allan_stream
