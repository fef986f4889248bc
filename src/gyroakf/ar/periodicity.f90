! SPDX-License-Identifier: MIT
!> Fisher's test for a hidden periodicity in a correlated series.
!>
!> In correlated data Fisher's test detects the correlation, and drift leaks into the whole
!> periodogram; therefore the residuals of an AR model are tested. A sinusoid that holds nearly all
!> of the variance is the exception: the AR model would predict it and so remove it.
module gyroakf_ar_periodicity
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_stats_fisher, only : fisher_type, test_fisher_g
   use gyroakf_stats_lagged_products, only : residual_block
   use gyroakf_stats_trend, only : trend_type, set_level
   implicit none (type, external)
   private
   public :: periodicity_options, periodicity_type, analyze_periodicity, whiten_series, even_length

   !> A shorter series is refused
   integer(int64), parameter :: min_samples = 32_int64
   !> From this length on the transform is made of a length with small prime factors only
   integer(int64), parameter :: trimmed_from = 65536_int64
   !> A sinusoid dominates where two adjacent ordinates hold this share; its least periods
   real(dp), parameter :: dominant_share = 0.75_dp
   integer(int64), parameter :: min_periods = 5_int64
   !> Samples between two reports of progress
   integer(int64), parameter :: reported = 131072_int64

   !> How the series is whitened, and how much of it is tested
   type :: periodicity_options
      !> The AR model, where none is given
      type(ar_options) :: ar
      !> At most so many samples, from the middle of the series, are tested; 0: all
      integer(int64) :: longest = 0
   end type periodicity_options

   !> Fisher's test and what it was applied to
   type :: periodicity_type
      !> The test; its frequency is in cycles per sample
      type(fisher_type) :: fisher
      !> Order of the AR model whose residuals were tested; 0: the series itself
      integer :: order = 0
      !> First sample tested, counted from 1, and their number, missing ones included
      integer(int64) :: first = 1, samples = 0
      !> Samples of the series, missing ones included
      integer(int64) :: total = 0
   end type periodicity_type

contains

   !> Fisher's test of the residuals of an AR model of the series.
   !>
   !> The series itself is tested where no AR model can be fitted to it, and where two adjacent
   !> ordinates of its periodogram hold three quarters of the power: a sinusoid of at least five
   !> periods that an AR model would predict. A series of 65536 values or more loses its last ones
   !> (and an odd one its last) down to a length with the prime factors 2, 3, 5, 7, 11, 13 only.
   subroutine analyze_periodicity(x, options, result, error, valid, model, progress)
      !> Series: [n], n >= 32 more than the order; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Model and length
      type(periodicity_options), intent(in) :: options
      !> The test
      type(periodicity_type), intent(out) :: result
      !> As of [[test_fisher_g]] and, without a model, of [[fit_ar]]
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> An AR model of the series
      type(ar_model_type), intent(in), optional :: model
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(ar_model_type) :: fitted
      real(dp) :: none(0)

      call test_residuals(x, 0.0_dp, none, options%longest, result, error, valid, progress)
      if (allocated(error)) return
      if (result%fisher%peak >= dominant_share .and. result%fisher%ordinate >= min_periods) return
      if (present(model)) then
         call test_residuals(x, model%mean, model%coefficient, options%longest, result, error, &
            & valid, progress)
         return
      end if
      call fit_ar(x, options%ar, fitted, error, valid, progress=progress)
      if (.not. allocated(error)) then
         call test_residuals(x, fitted%mean, fitted%coefficient, options%longest, result, error, &
            & valid, progress)
      else if (error%code == status%singular) then
         deallocate (error)                       ! gaps can cause it: the test of the series stands
      end if
   end subroutine analyze_periodicity

   !> Fisher's test of the residuals of an AR model; without coefficients, of the series itself.
   subroutine test_residuals(x, mean, phi, longest, result, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: mean, phi(:)
      integer(int64), intent(in) :: longest
      type(periodicity_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: white(:)
      integer(int8), allocatable :: here(:)
      integer(int64) :: first, last

      call cut_middle(size(x, kind=int64), size(phi), longest, result, error)
      if (allocated(error)) return
      first = result%first - result%order
      last = result%first + result%samples - 1
      if (present(valid)) then
         call whiten_series(x(first:last), mean, phi, white, here, error, valid(first:last), &
            & progress)
      else
         call whiten_series(x(first:last), mean, phi, white, here, error, progress=progress)
      end if
      if (.not. allocated(error)) call test_fisher_g(white, result%fisher, error, here, progress)
   end subroutine test_residuals

   !> First sample and number of the samples in the middle that are tested.
   subroutine cut_middle(n, order, longest, result, error)
      integer(int64), intent(in) :: n, longest
      integer, intent(in) :: order
      type(periodicity_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      character(100) :: text

      result%order = order
      result%total = n
      result%samples = max(n - int(order, int64), 0_int64)
      if (longest > 0) result%samples = min(result%samples, longest)
      if (result%samples >= trimmed_from) result%samples = even_length(result%samples)
      result%first = (n - order - result%samples)/2 + int(order, int64) + 1
      if (result%samples >= min_samples) return
      write (text, "(2(a, i0))") "Fisher's test needs at least ", min_samples, &
         & " samples, there are ", result%samples
      call fatal_error(error, status%too_few_samples, trim(text))
   end subroutine cut_middle

   !> The largest even number up to n with no prime factors but 2, 3, 5, 7, 11, 13.
   pure integer(int64) function even_length(n) result(length)
      !> >= 2
      integer(int64), intent(in) :: n
      integer(int64), parameter :: prime(6) = int([2, 3, 5, 7, 11, 13], int64)
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

   !> Residuals of an AR model, $$e_t = (x_t - m) - \sum_j \phi_j (x_{t-j} - m), \quad t = p + 1
   !> \ldots n;$$ one is missing where any of its p + 1 samples is.
   subroutine whiten_series(x, mean, phi, white, here, error, valid, progress)
      !> Series: [n], n > p; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean m and its AR coefficients: [p]
      real(dp), intent(in) :: mean, phi(:)
      !> Residuals: [n - p]; 0 where missing
      real(dp), allocatable, intent(out) :: white(:)
      !> 1 present, 0 missing: [n - p]; allocated only with `valid`
      integer(int8), allocatable, intent(out) :: here(:)
      !> too_few_samples, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(trend_type) :: level
      real(dp), allocatable :: flag(:)
      integer(int64) :: first, last, count_white
      integer :: p, stat

      p = size(phi)
      count_white = size(x, kind=int64) - p
      if (count_white < 1) call fatal_error(error, status%too_few_samples, &
         & "the series is not longer than the order of its AR model")
      if (allocated(error)) return
      allocate (white(count_white), stat=stat)
      if (stat == 0) allocate (flag(reported), stat=stat)
      if (stat == 0 .and. present(valid)) allocate (here(count_white), stat=stat)
      call check_memory(stat, "the residuals", error)
      if (allocated(error)) return
      call set_level(level, mean, 0.0_dp)
      do first = 1, count_white, reported
         call report_progress("whitening", first - 1, count_white, error, progress)
         last = min(first + reported - 1, count_white)
         if (.not. allocated(error)) call residual_block(x, level, phi, 0.0_dp, first + p, &
            & white(first:last), flag(:last - first + 1), stat, valid)
         call check_memory(stat, "the residuals", error)
         if (allocated(error)) return
         if (present(valid)) here(first:last) = nint(flag(:last - first + 1), int8)
      end do
   end subroutine whiten_series

end module gyroakf_ar_periodicity
