! SPDX-License-Identifier: MIT
!> The largest likelihood of one ARMA(p, q) model of one series.
!>
!> The likelihood of a mixed model may have several maxima, and a ridge where roots of both polynomials nearly cancel, as those of a
!> slow drift under much white noise do. So the search begins at several places: the regression of Hannan and Rissanen, the AR
!> model, the drift that the autocovariances of block means show, and where it is given, a smaller model. On a long series all
!> of them are tried on a part of it first. Each search begins with a step of scoring: the inverse of the information matrix
!> is the first inverse Hessian.
module gyroakf_ar_arma_fit
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_quasi_newton, only : minimise, minimise_options, minimum_type
   use gyroakf_ar_arma_transform, only : free_of, shrink
   use gyroakf_ar_arma_start, only : regress_on_past, drift_as_arma
   use gyroakf_ar_arma_filter, only : arma_series_type
   use gyroakf_ar_arma_likelihood, only : arma_objective_type, start_inverse
   implicit none (type, external)
   private
   public :: arma_hint_type, arma_optimum_type, maximise_likelihood, improve, part_of

   !> Where all starts are tried first, of a series at least twice as long
   integer(int64), parameter :: trial_length = 16384

   !> A gain of ln L that is worth no further step: the coefficients are within 5e-5 of their standard errors, and as the method
   !> converges faster than linearly, better; where orders are compared, or starts on a part, 1 % of the standard errors will do
   real(dp), parameter :: evident = 1.0e-9_dp, rough = 1.0e-4_dp
   !> Most steps of a search, and of one on a part
   integer, parameter :: most_steps = 60, most_rough_steps = 25

   !> What is known of the series before
   type :: arma_hint_type
      !> Autocovariances of the scaled series: [0:long_order + 3]
      real(dp), allocatable :: r(:)
      !> Present samples
      real(dp) :: samples = 0.0_dp
      !> Coefficient and variances of a drift, where there is one
      real(dp) :: drift_phi = 0.0_dp, drift_variance = 0.0_dp, white_variance = 0.0_dp
   end type arma_hint_type

   !> The maximum
   type :: arma_optimum_type
      !> Orders; unallocated parameters: there is none
      integer :: p = 0, q = 0
      !> Free parameters and mean: [p + q + 1]
      real(dp), allocatable :: parameter(:)
      !> -ln L/n without constants
      real(dp) :: value = huge(1.0_dp)
      !> The gradient is small
      logical :: converged = .false.
      !> Work of the searches
      integer :: iterations = 0, evaluations = 0
   end type arma_optimum_type

contains

   !> Largest likelihood of orders p and q.
   subroutine maximise_likelihood(series, hint, p, q, optimum, quick, listener, error, first)
      !> The series, centred and scaled
      type(arma_series_type), intent(in) :: series
      !> What is known of it
      type(arma_hint_type), intent(in) :: hint
      !> Orders, 0 .. 3
      integer, intent(in) :: p, q
      !> The maximum
      type(arma_optimum_type), intent(out) :: optimum
      !> A search from the best start alone, and not to the last digit: good enough to compare orders
      logical, intent(in) :: quick
      !> Told how far it is, may cancel; not associated: nobody
      class(progress_type), pointer, intent(in) :: listener
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Free parameters of a maximum of a part of the series: [p + q + 1]; it is one of the starts, and one search is enough
      real(dp), intent(in), optional :: first(:)
      type(arma_objective_type) :: objective
      type(arma_optimum_type) :: best
      real(dp) :: start(p + q + 1, 4)
      integer :: i, starts
      logical :: long

      optimum%p = p
      optimum%q = q
      objective%p = p
      objective%q = q
      objective%share%whole => listener
      call gather_starts(hint, p, q, start, starts)
      long = size(series%y, kind=int64) >= 2*trial_length
      if (present(first)) then
         best%parameter = first
      else if (long) then
         call part_of(series, trial_length, objective%series, error)
         if (allocated(error)) return
         if (quick) then
            call take_best(objective, start, starts, best)
            if (allocated(best%parameter)) start(:, 1) = best%parameter
         end if
         do i = 1, merge(1, starts, quick)
            call improve(objective, start(:, i), best, .true.)
         end do
         optimum%iterations = best%iterations
         optimum%evaluations = best%evaluations
      end if
      call part_of(series, size(series%y, kind=int64), objective%series, error)
      if (allocated(error)) return
      if (long .or. quick .or. present(first)) then
         call take_best(objective, start, starts, best)
         optimum%evaluations = optimum%evaluations + starts
         if (allocated(best%parameter)) call improve(objective, best%parameter, optimum, quick)
      else
         do i = 1, starts
            call improve(objective, start(:, i), optimum, quick)
         end do
      end if
      if (allocated(objective%cancelled)) call move_alloc(objective%cancelled, error)
   end subroutine maximise_likelihood

   !> Of the best of a part and the starts, the one that the whole series likes best.
   subroutine take_best(objective, start, starts, best)
      type(arma_objective_type), intent(inout) :: objective
      real(dp), intent(in) :: start(:, :)
      integer, intent(in) :: starts
      type(arma_optimum_type), intent(inout) :: best
      real(dp) :: value, lowest, gradient(size(start, 1))
      logical :: feasible
      integer :: i

      lowest = huge(1.0_dp)
      if (allocated(best%parameter)) then
         call objective%evaluate(best%parameter, value, gradient, feasible)
         if (feasible) lowest = value
      end if
      do i = 1, starts
         call objective%evaluate(start(:, i), value, gradient, feasible)
         if (.not. feasible) cycle
         if (value >= lowest) cycle
         lowest = value
         best%parameter = start(:, i)
      end do
   end subroutine take_best

   !> Searches from a start; keeps what is better than before.
   subroutine improve(objective, start, optimum, quick)
      !> The likelihood
      type(arma_objective_type), intent(inout) :: objective
      !> Free parameters
      real(dp), intent(in) :: start(:)
      !> The best so far
      type(arma_optimum_type), intent(inout) :: optimum
      !> Not to the last digit
      logical, intent(in) :: quick
      type(minimise_options) :: how
      type(minimum_type) :: minimum
      type(error_type), allocatable :: error
      real(dp) :: inverse(size(start), size(start))
      logical :: known

      call start_inverse(objective, start, inverse, known)
      optimum%evaluations = optimum%evaluations + 1
      how%max_iterations = merge(most_rough_steps, most_steps, quick)
      how%decrease_tolerance = merge(rough, evident, quick)/real(size(objective%series%y, kind=int64), dp)
      how%decrease_tolerance = max(how%decrease_tolerance, 1.0e-14_dp)
      if (known) then
         call minimise(objective, start, how, minimum, error, inverse)
      else
         call minimise(objective, start, how, minimum, error)
      end if
      if (allocated(error)) return
      optimum%iterations = optimum%iterations + minimum%iterations
      optimum%evaluations = optimum%evaluations + minimum%evaluations
      if (allocated(optimum%parameter) .and. minimum%value >= optimum%value) return
      optimum%parameter = minimum%parameter
      optimum%value = minimum%value
      optimum%converged = minimum%converged
   end subroutine improve

   !> The starts, as free parameters.
   subroutine gather_starts(hint, p, q, start, starts)
      type(arma_hint_type), intent(in) :: hint
      integer, intent(in) :: p, q
      real(dp), intent(out) :: start(:, :)
      integer, intent(out) :: starts
      real(dp) :: phi(p), theta(q)

      starts = 0
      start(:, :) = 0.0_dp
      call regress_on_past(hint%r, hint%samples, phi, theta)
      call add(phi, theta, start, starts)
      if (p > 0 .and. q > 0) then
         theta(:) = 0.0_dp
         call regress_on_past(hint%r, hint%samples, phi, theta(:0))
         call add(phi, theta, start, starts)
         if (hint%drift_phi > 0.0_dp .and. hint%drift_variance > 0.0_dp) then
            phi(:) = 0.0_dp
            theta(:) = 0.0_dp
            phi(1) = hint%drift_phi
            theta(1) = drift_as_arma(hint%drift_phi, hint%drift_variance, hint%white_variance)
            call add(phi, theta, start, starts)
         end if
      end if
   end subroutine gather_starts

   !> One start, drawn inside where it is not stationary and invertible.
   subroutine add(phi, theta, start, starts)
      real(dp), intent(inout) :: phi(:), theta(:)
      real(dp), intent(inout) :: start(:, :)
      integer, intent(inout) :: starts
      logical :: inside

      starts = starts + 1
      call shrink(phi)
      call free_of(phi, start(:size(phi), starts), inside)
      theta(:) = -theta
      call shrink(theta)
      call free_of(theta, start(size(phi) + 1:size(phi) + size(theta), starts), inside)
      theta(:) = -theta
   end subroutine add

   !> The middle of a series.
   subroutine part_of(series, length, part, error)
      !> The series
      type(arma_series_type), intent(in) :: series
      !> Samples, at most those of the series
      integer(int64), intent(in) :: length
      !> Its middle
      type(arma_series_type), intent(out) :: part
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: first
      integer :: stat

      first = (size(series%y, kind=int64) - length)/2
      allocate (part%y(length), stat=stat)
      if (stat == 0 .and. allocated(series%valid)) allocate (part%valid(length), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the part of the series that an ARMA model is fitted to")
         return
      end if
      part%y(:) = series%y(first + 1:first + length)
      if (allocated(series%valid)) part%valid(:) = series%valid(first + 1:first + length)
   end subroutine part_of

end module gyroakf_ar_arma_fit
