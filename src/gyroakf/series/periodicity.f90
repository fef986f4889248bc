! SPDX-License-Identifier: MIT
!> What is periodic in a series that is correlated: Fisher's g and the strongest lines, both of the whitened series.
!>
!> On correlated data Fisher's test finds the correlation, and drift leaks over the whole periodogram: an AR model whitens the
!> series first. Gains and shares of the lines are stated for the series before.
module gyroakf_series_periodicity
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_series_moments, only : moments_type, compute_moments
   use gyroakf_series_fisher, only : fisher_type
   use gyroakf_series_lines, only : line_options, line_type, find_lines
   use gyroakf_series_sinusoid, only : sinusoid_type, remove_sinusoid
   implicit none (type, external)
   private
   public :: periodicity_options, periodicity_type, analyse_periodicity, whiten_series, even_length

   !> From this length on the transform is made of a length with small prime factors only
   integer(int64), parameter :: trimmed_from = 65536_int64
   !> A line with more of the variance bends the AR model; lines are sought in whitened series so many times at most
   real(dp), parameter :: strong_share = 0.01_dp
   integer, parameter :: most_rounds = 2
   !> Samples less one between two reports of progress: a power of two less one
   integer(int64), parameter :: told_samples = 131071_int64

   !> How it is looked for
   type :: periodicity_options
      !> The lines
      type(line_options) :: lines
      !> The model that whitens, where none is given
      type(ar_options) :: ar
      !> At most so many samples, from the middle of the series, are looked at; 0: all
      integer(int64) :: longest = 0
   end type periodicity_options

   !> What was found
   type :: periodicity_type
      !> Fisher's test of the whitened series; its frequency is in cycles per sample
      type(fisher_type) :: fisher
      !> By frequency, in the unit of the series; of length 0 where there is none
      type(line_type), allocatable :: line(:)
      !> Order of the AR model that whitened; 0: the series was taken as it is
      integer :: order = 0
      !> First sample looked at, counted from 1, and how many: whitened values, missing ones included
      integer(int64) :: first = 1, samples = 0
      !> Lines were sought: there are samples enough, and the options want them
      logical :: searched = .false.
      !> Samples of the series, missing ones included
      integer(int64) :: total = 0
   end type periodicity_type

contains

   !> Whitens a series, tests it for a periodicity and looks for its lines.
   !>
   !> A series of 65536 values or more loses its last ones (and an odd one its last) down to a length with the prime factors
   !> 2, 3, 5, 7, 11, 13 only, some parts in a thousand at most.
   !>
   !> Lines are sought in the series as it is first. Where one has more than 1 % of the variance, the AR model is fitted to what the
   !> lines leave instead of the given one: that of a strong line would take its surroundings for a part of it.
   subroutine analyse_periodicity(x, dt, options, result, error, valid, model, progress)
      !> Series: [n], n >= 32 more than the order; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval > 0; 1: frequencies in cycles per sample
      real(dp), intent(in) :: dt
      !> How
      type(periodicity_options), intent(in) :: options
      !> What was found
      type(periodicity_type), intent(out) :: result
      !> As of [[find_lines]] and, without a model, of [[fit_ar]]
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> An AR model of the series
      type(ar_model_type), intent(in), optional :: model
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(ar_model_type) :: white, used
      type(moments_type) :: moments
      real(dp), allocatable :: rest(:)
      logical :: found
      integer :: round

      call tell_progress("looking for lines", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call compute_moments(x, moments, valid)
      allocate (white%coefficient(0))
      white%mean = moments%mean
      call look(x, dt, options, moments%variance, white, result, error, valid, progress)
      if (allocated(error)) return
      do round = 1, most_rounds
         if (any(result%line%share > strong_share)) then
            call take_lines(x, dt, result, rest, error, progress)
            if (.not. allocated(error)) call model_of_rest(rest, options%ar, result, used, found, error, valid, progress)
            if (allocated(error) .or. .not. found) return
         else if (round > 1) then
            return
         else if (present(model)) then
            used = model
         else
            call fit_ar(x, options%ar, used, error, valid, progress=progress)
            if (allocated(error)) then
               if (error%code == status%singular) deallocate (error)      ! gaps can do that: the series as it is must do
               return
            end if
         end if
         call look(x, dt, options, moments%variance, used, result, error, valid, progress)
         if (allocated(error)) return
      end do
   end subroutine analyse_periodicity

   !> Lines and Fisher's test with one model.
   subroutine look(x, dt, options, variance, model, result, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: dt
      type(periodicity_options), intent(in) :: options
      !> Of the series
      real(dp), intent(in) :: variance
      type(ar_model_type), intent(in) :: model
      type(periodicity_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: white(:)
      integer(int8), allocatable :: here(:)

      call cut_middle(size(x, kind=int64), model%order, options%longest, result)
      call whiten_part(x, model, result, white, here, error, valid, progress)
      if (allocated(error)) return
      if (allocated(here)) then
         call find_lines(white, dt, options%lines, result%line, error, here, model%coefficient, variance, result%fisher, progress)
      else
         call find_lines(white, dt, options%lines, result%line, error, phi=model%coefficient, variance=variance, &
                         fisher=result%fisher, progress=progress)
      end if
      result%searched = options%lines%most > 0
   end subroutine look

   !> The part that was looked at without its lines.
   subroutine take_lines(x, dt, result, rest, error, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: dt
      type(periodicity_type), intent(in) :: result
      !> [samples]; not allocated where there is no memory for it
      real(dp), allocatable, intent(out) :: rest(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(sinusoid_type) :: sinusoid
      integer :: i, stat

      allocate (rest(result%samples), stat=stat)
      if (stat /= 0) return
      rest(:) = x(result%first:result%first + result%samples - 1)
      do i = 1, size(result%line)
         call tell_progress("looking for lines", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         sinusoid%frequency = result%line(i)%frequency*dt
         sinusoid%cosine = result%line(i)%cosine
         sinusoid%sine = result%line(i)%sine
         call remove_sinusoid(rest, sinusoid)
      end do
   end subroutine take_lines

   !> The AR model of what the lines leave; false where there is none, and the old one stays.
   subroutine model_of_rest(rest, options, part, model, found, error, valid, progress)
      real(dp), allocatable, intent(in) :: rest(:)
      type(ar_options), intent(in) :: options
      type(periodicity_type), intent(in) :: part
      type(ar_model_type), intent(inout) :: model
      logical, intent(out) :: found
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(ar_model_type) :: fresh

      found = .false.
      if (.not. allocated(rest)) return
      if (present(valid)) then
         call fit_ar(rest, options, fresh, error, valid(part%first:part%first + part%samples - 1), progress=progress)
      else
         call fit_ar(rest, options, fresh, error, progress=progress)
      end if
      found = .not. allocated(error)
      if (found) then
         model = fresh
      else if (error%code /= status%cancelled) then
         deallocate (error)
      end if
   end subroutine model_of_rest

   !> Where the part begins whose residuals are looked at, and how many they are.
   pure subroutine cut_middle(n, order, longest, result)
      integer(int64), intent(in) :: n
      integer, intent(in) :: order
      integer(int64), intent(in) :: longest
      type(periodicity_type), intent(inout) :: result

      result%order = order
      result%total = n
      result%samples = max(n - int(order, int64), 0_int64)
      if (longest > 0) result%samples = min(result%samples, longest)
      if (result%samples >= trimmed_from) result%samples = even_length(result%samples)
      result%first = (n - order - result%samples)/2 + int(order, int64) + 1
   end subroutine cut_middle

   !> The largest even number that is not above n and has no other prime factors than 2, 3, 5, 7, 11, 13.
   pure integer(int64) function even_length(n) result(length)
      !> >= 2
      integer(int64), intent(in) :: n
      integer(int64), parameter :: prime(6) = [2_int64, 3_int64, 5_int64, 7_int64, 11_int64, 13_int64]
      integer(int64) :: rest
      integer :: i

      length = n - mod(n, 2_int64)
      do while (length > 2)
         rest = length
         do i = 1, size(prime)
            do while (mod(rest, prime(i)) == 0)
               rest = rest/prime(i)
            end do
         end do
         if (rest == 1) exit
         length = length - 2
      end do
   end function even_length

   !> Residuals of the part.
   subroutine whiten_part(x, model, part, white, here, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(ar_model_type), intent(in) :: model
      type(periodicity_type), intent(in) :: part
      !> Residuals: [samples]
      real(dp), allocatable, intent(out) :: white(:)
      !> Which are there; only with `valid`
      integer(int8), allocatable, intent(out) :: here(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: from, to

      from = part%first - part%order
      to = part%first + part%samples - 1
      if (present(valid)) then
         call whiten_series(x(from:to), model%mean, model%coefficient, white, here, error, valid(from:to), progress)
      else
         call whiten_series(x(from:to), model%mean, model%coefficient, white, here, error, progress=progress)
      end if
   end subroutine whiten_part

   !> Residuals of an AR model, $$e_t = (x_t - m) - \sum_j \phi_j (x_{t-j} - m), \quad t = p + 1 \ldots n;$$ one is missing where
   !> any of its p + 1 samples is.
   subroutine whiten_series(x, mean, phi, white, here, error, valid, progress)
      !> Series: [n], n > p; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean m and its AR coefficients: [p]
      real(dp), intent(in) :: mean
      real(dp), intent(in) :: phi(:)
      !> Residuals: [n - p]; 0 where missing
      real(dp), allocatable, intent(out) :: white(:)
      !> 1 present, 0 missing: [n - p]; allocated only with `valid`
      integer(int8), allocatable, intent(out) :: here(:)
      !> too_few_samples, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: t, count_white
      integer :: j, p, stat
      real(dp) :: total

      p = size(phi)
      count_white = size(x, kind=int64) - p
      if (count_white < 1) then
         call fatal_error(error, status%too_few_samples, "the series is not longer than the order of its AR model")
         return
      end if
      allocate (white(count_white), stat=stat)
      if (stat == 0 .and. present(valid)) allocate (here(count_white), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the whitened series")
         return
      end if
      do t = 1, count_white
         if (iand(t, told_samples) == 0) call tell_progress("whitening", t, count_white, error, progress)
         if (allocated(error)) return
         total = x(t + p) - mean
         do j = 1, p
            total = total - phi(j)*(x(t + p - j) - mean)
         end do
         white(t) = total
      end do
      if (.not. present(valid)) return
      do t = 1, count_white
         if (iand(t, told_samples) == 0) call tell_progress("whitening", t, count_white, error, progress)
         if (allocated(error)) return
         here(t) = minval(valid(t:t + p))
         if (here(t) == 0_int8) white(t) = 0.0_dp
      end do
   end subroutine whiten_series

end module gyroakf_series_periodicity
