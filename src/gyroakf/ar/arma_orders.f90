! SPDX-License-Identifier: MIT
!> The orders of an ARMA model: all are fitted to one part of the series and compared by a criterion.
module gyroakf_ar_arma_orders
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_threads, only : thread_count
   use gyroakf_ar_criteria, only : criterion_number
   use gyroakf_ar_arma_state, only : arma_sums_type, most
   use gyroakf_ar_arma_filter, only : arma_series_type, sum_innovations
   use gyroakf_ar_arma_likelihood, only : arma_objective_type, split_free
   use gyroakf_ar_arma_fit, only : arma_hint_type, arma_optimum_type, maximise_likelihood, improve, part_of
   use gyroakf_filter_progress_share, only : progress_share_type
   use gyroakf_ar_arma_result, only : arma_options, arma_model_type, arma_criteria, best_line
   implicit none (type, external)
   private
   public :: choose_orders

   !> Of the samples that a fit may use at most the orders are compared on one in so many at most
   integer(int64), parameter :: compared_share = 4
   !> From this length of the part on one order at a time is fitted, so that each of its evaluations can be told
   integer(int64), parameter :: told_alone = 65536
   !> A difference of ln L that changes no choice
   real(dp), parameter :: no_matter = 1.0e-2_dp

contains

   !> Fits all orders on one part of the series and chooses.
   subroutine choose_orders(series, hint, options, most_samples, model, scale, chosen, error, progress)
      !> The series, centred and divided by `scale`
      type(arma_series_type), intent(in) :: series
      !> What is known of it
      type(arma_hint_type), intent(in) :: hint
      !> Orders on offer, criterion
      type(arma_options), intent(in) :: options
      !> Samples that the fit may use
      integer(int64), intent(in) :: most_samples
      !> Gets orders and table
      type(arma_model_type), intent(inout) :: model
      !> Of the series
      real(dp), intent(in) :: scale
      !> Free parameters of the choice: [p + q + 1]
      real(dp), allocatable, intent(out) :: chosen(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional, target :: progress
      type(arma_optimum_type), allocatable :: optimum(:)
      type(arma_objective_type) :: part
      class(progress_type), pointer :: listener
      real(dp), allocatable :: variance(:)
      real(dp) :: samples
      integer(int64) :: length
      integer :: i, lines, best, first, last, group

      listener => null()
      length = max(most_samples/compared_share, 1000_int64)
      call part_of(series, min(length, size(series%y, kind=int64)), part%series, error)
      if (allocated(error)) return
      model%compared_length = size(part%series%y, kind=int64)
      samples = real(model%compared_length, dp)
      if (allocated(part%series%valid)) samples = real(count(part%series%valid /= 0_int8, kind=int64), dp)
      call list_orders(options, optimum)
      lines = size(optimum)
      allocate (model%table(lines), variance(lines))
      group = lines
      if (present(progress)) group = thread_count()
      if (present(progress) .and. model%compared_length > told_alone) then
         listener => progress
         group = 1
      end if
      do last = lines, 1, -group
         call tell_progress("ARMA orders", ((lines - last)*model%length)/(2*lines), model%length, error, progress)
         if (.not. allocated(error)) call fit_orders(part%series, hint, optimum(max(last - group + 1, 1):last), listener, error)
         if (allocated(error)) return
      end do
      last = 0
      do while (last < lines)                ! models of the same p + q do not contain each other
         first = last + 1
         do while (last < lines)
            if (optimum(last + 1)%p + optimum(last + 1)%q > optimum(first)%p + optimum(first)%q) exit
            last = last + 1
         end do
         call tell_progress("ARMA orders", model%length/2 + (model%length*first)/(2*lines), model%length, error, progress)
         if (.not. allocated(error)) call improve_orders(part%series, optimum(:last), first, listener, variance, error)
         if (allocated(error)) return
      end do
      do i = 1, lines
         model%table(i) = arma_criteria(optimum(i)%p, optimum(i)%q, log_likelihood(optimum(i)%value, samples, scale), &
                                        variance(i)*scale**2, int(samples, int64))
         model%table(i)%usable = usable(optimum(i), samples)
      end do
      best = best_line(model%table, criterion_number(trim(options%criterion)))
      model%p = model%table(best)%p
      model%q = model%table(best)%q
      if (allocated(optimum(best)%parameter)) chosen = optimum(best)%parameter
   end subroutine choose_orders

   !> Fits some orders, each in a thread of its own.
   subroutine fit_orders(series, hint, optimum, listener, error)
      !> The part
      type(arma_series_type), intent(in) :: series
      !> What is known of it
      type(arma_hint_type), intent(in) :: hint
      !> Their orders are set
      type(arma_optimum_type), intent(inout) :: optimum(:)
      !> Told of every evaluation where it is associated; one thread then
      class(progress_type), pointer, intent(in) :: listener
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: failed
      integer :: i, p, q

      !$omp parallel do default(shared) private(p, q, failed) schedule(dynamic) &
      !$omp& if (size(series%y, kind=int64) > 1000 .and. .not. associated(listener))
      do i = size(optimum), 1, -1
         p = optimum(i)%p
         q = optimum(i)%q
         call maximise_likelihood(series, hint, p, q, optimum(i), .true., listener, failed)
         if (allocated(failed)) call move_alloc(failed, error)       ! only where one thread is told
      end do
      !$omp end parallel do
   end subroutine fit_orders

   !> Searches again what a smaller model is better than, and finds sigma^2.
   subroutine improve_orders(series, optimum, first, listener, variance, error)
      !> The part
      type(arma_series_type), intent(in) :: series
      !> Maxima, p + q growing
      type(arma_optimum_type), intent(inout) :: optimum(:)
      !> From this one on; those before are smaller
      integer, intent(in) :: first
      !> As of fit_orders
      class(progress_type), pointer, intent(in) :: listener
      !> sigma^2 of these
      real(dp), intent(inout) :: variance(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: failed
      integer :: i

      !$omp parallel do default(shared) private(failed) schedule(dynamic) &
      !$omp& if (size(series%y, kind=int64) > 1000 .and. .not. associated(listener))
      do i = first, size(optimum)
         call learn_from_smaller(series, optimum(:first - 1), listener, optimum(i), variance(i), failed)
         if (allocated(failed)) call move_alloc(failed, error)       ! only where one thread is told
      end do
      !$omp end parallel do
   end subroutine improve_orders

   !> The search ended at a maximum, away from the edge of the invertible models.
   pure logical function usable(optimum, samples)
      type(arma_optimum_type), intent(in) :: optimum
      real(dp), intent(in) :: samples

      usable = allocated(optimum%parameter) .and. optimum%converged
      if (.not. usable .or. optimum%q == 0) return
      usable = 1.0_dp - tanh(maxval(abs(optimum%parameter(optimum%p + 1:optimum%p + optimum%q)))) > 2.0_dp/samples
   end function usable

   !> ln L of the objective's value.
   pure real(dp) function log_likelihood(value, samples, scale)
      real(dp), intent(in) :: value, samples, scale

      log_likelihood = -samples*(value + 0.5_dp*(1.0_dp + log(2.0_dp*acos(-1.0_dp))) + log(scale))
   end function log_likelihood

   !> The orders to compare, p + q growing.
   subroutine list_orders(options, optimum)
      type(arma_options), intent(in) :: options
      type(arma_optimum_type), allocatable, intent(out) :: optimum(:)
      integer :: sum_of_orders, p, q, i, pass

      do pass = 1, 2
         i = 0
         do sum_of_orders = 0, 2*most
            do p = 0, sum_of_orders
               q = sum_of_orders - p
               if (.not. (is_asked_for(p, options%p, options%max_p) .and. is_asked_for(q, options%q, options%max_q))) cycle
               i = i + 1
               if (pass == 1) cycle
               optimum(i)%p = p
               optimum(i)%q = q
            end do
         end do
         if (pass == 1) allocate (optimum(i))
      end do
   end subroutine list_orders

   !> An order is the one that is given, whatever the largest; where none is given it is at most the largest.
   pure logical function is_asked_for(order, given, largest)
      !> 0 ..
      integer, intent(in) :: order
      !> -1: none
      integer, intent(in) :: given
      integer, intent(in) :: largest

      is_asked_for = order == given .or. (given < 0 .and. order <= largest)
   end function is_asked_for

   !> A model is never less likely than one that it contains: where it seems so, it is searched from there.
   subroutine learn_from_smaller(series, smaller, listener, optimum, variance, error)
      !> The part
      type(arma_series_type), intent(in) :: series
      !> Maxima of models with a smaller p + q
      type(arma_optimum_type), intent(in) :: smaller(:)
      !> As of fit_orders
      class(progress_type), pointer, intent(in) :: listener
      !> Gets better, or stays
      type(arma_optimum_type), intent(inout) :: optimum
      !> sigma^2
      real(dp), intent(out) :: variance
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(arma_objective_type) :: objective
      real(dp) :: start(optimum%p + optimum%q + 1)
      integer :: j, p, q

      objective%p = optimum%p
      objective%q = optimum%q
      objective%share%whole => listener
      do j = 1, size(smaller)
         p = smaller(j)%p
         q = smaller(j)%q
         if (optimum%p - p + optimum%q - q /= 1 .or. abs(optimum%p - p) > 1) cycle
         if (.not. allocated(smaller(j)%parameter)) cycle
         if (smaller(j)%value >= optimum%value - no_matter/real(size(series%y, kind=int64), dp)) cycle
         start(:) = 0.0_dp
         start(:p) = smaller(j)%parameter(:p)
         start(optimum%p + 1:optimum%p + q) = smaller(j)%parameter(p + 1:p + q)
         start(size(start)) = smaller(j)%parameter(p + q + 1)
         if (.not. allocated(objective%series%y)) call part_of(series, size(series%y, kind=int64), &
            & objective%series, objective%cancelled)
         if (allocated(objective%cancelled)) exit
         call improve(objective, start, optimum, .true.)
      end do
      call find_variance(series, objective%share, optimum, variance, objective%cancelled)
      if (allocated(objective%cancelled)) call move_alloc(objective%cancelled, error)
   end subroutine learn_from_smaller

   !> sigma^2 at a maximum.
   subroutine find_variance(series, share, optimum, variance, cancelled)
      type(arma_series_type), intent(in) :: series
      type(progress_share_type), intent(inout) :: share
      type(arma_optimum_type), intent(in) :: optimum
      real(dp), intent(out) :: variance
      !> Nothing is done where it is allocated already
      type(error_type), allocatable, intent(inout) :: cancelled
      type(arma_sums_type) :: sums
      real(dp) :: phi(optimum%p), theta(optimum%q), jacobian(optimum%p + optimum%q + 1, optimum%p + optimum%q + 1)
      logical :: stationary

      variance = 0.0_dp
      if (.not. allocated(optimum%parameter) .or. allocated(cancelled)) return
      call split_free(optimum%parameter, phi, theta, jacobian)
      call sum_innovations(series, phi, theta, optimum%parameter(size(optimum%parameter)), sums, stationary, .false., &
         & progress=share, cancelled=cancelled)
      if (stationary) variance = sums%square/real(sums%count, dp)
   end subroutine find_variance

end module gyroakf_ar_arma_orders
