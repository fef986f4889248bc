! SPDX-License-Identifier: MIT
!> The orders of an ARMA model: all are fitted to one part of the series and compared by a criterion.
module gyroakf_ar_arma_orders
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_ar_criteria, only : criterion_number
   use gyroakf_ar_arma_state, only : arma_sums_type, most
   use gyroakf_ar_arma_filter, only : arma_series_type, sum_innovations
   use gyroakf_ar_arma_likelihood, only : arma_objective_type, split_free
   use gyroakf_ar_arma_fit, only : arma_hint_type, arma_optimum_type, maximise_likelihood, improve, part_of
   use gyroakf_ar_arma_result, only : arma_options, arma_model_type, arma_criteria, best_line
   implicit none (type, external)
   private
   public :: choose_orders

   !> Of the samples that a fit may use at most the orders are compared on one in so many at most
   integer(int64), parameter :: compared_share = 4
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
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(arma_optimum_type), allocatable :: optimum(:)
      type(arma_objective_type) :: part
      real(dp), allocatable :: variance(:)
      real(dp) :: samples
      integer(int64) :: length
      integer :: i, lines, best, first, last, p, q

      length = max(most_samples/compared_share, 1000_int64)
      if (size(series%y, kind=int64) > length) then
         call part_of(series, length, part%series)
      else
         part%series = series
      end if
      model%compared_length = size(part%series%y, kind=int64)
      samples = real(model%compared_length, dp)
      if (allocated(part%series%valid)) samples = real(count(part%series%valid /= 0_int8, kind=int64), dp)
      call list_orders(options, optimum)
      lines = size(optimum)
      allocate (model%table(lines), variance(lines))
      call tell_progress("ARMA orders", 0_int64, model%length, error, progress)
      if (allocated(error)) return
      !$omp parallel do default(shared) private(p, q) schedule(dynamic) if (samples > 1.0e3_dp)
      do i = lines, 1, -1
         p = optimum(i)%p
         q = optimum(i)%q
         call maximise_likelihood(part%series, hint, p, q, optimum(i), .true.)
      end do
      !$omp end parallel do
      last = 0
      do while (last < lines)                ! models of the same p + q do not contain each other
         first = last + 1
         do while (last < lines)
            if (optimum(last + 1)%p + optimum(last + 1)%q > optimum(first)%p + optimum(first)%q) exit
            last = last + 1
         end do
         call tell_progress("ARMA orders", model%length*first/(4*lines), model%length, error, progress)
         if (allocated(error)) return
         !$omp parallel do default(shared) schedule(dynamic) if (samples > 1.0e3_dp)
         do i = first, last
            call learn_from_smaller(part%series, optimum(:first - 1), optimum(i))
            variance(i) = variance_of(part%series, optimum(i))
         end do
         !$omp end parallel do
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
   subroutine learn_from_smaller(series, smaller, optimum)
      !> The part
      type(arma_series_type), intent(in) :: series
      !> Maxima of models with a smaller p + q
      type(arma_optimum_type), intent(in) :: smaller(:)
      !> Gets better, or stays
      type(arma_optimum_type), intent(inout) :: optimum
      type(arma_objective_type) :: objective
      real(dp) :: start(optimum%p + optimum%q + 1)
      integer :: j, p, q

      objective%p = optimum%p
      objective%q = optimum%q
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
         if (.not. allocated(objective%series%y)) objective%series = series
         call improve(objective, start, optimum, .true.)
      end do
   end subroutine learn_from_smaller

   !> sigma^2 at a maximum.
   real(dp) function variance_of(series, optimum) result(variance)
      type(arma_series_type), intent(in) :: series
      type(arma_optimum_type), intent(in) :: optimum
      type(arma_sums_type) :: sums
      real(dp) :: phi(optimum%p), theta(optimum%q), jacobian(optimum%p + optimum%q + 1, optimum%p + optimum%q + 1)
      logical :: stationary

      variance = 0.0_dp
      if (.not. allocated(optimum%parameter)) return
      call split_free(optimum%parameter, phi, theta, jacobian)
      call sum_innovations(series, phi, theta, optimum%parameter(size(optimum%parameter)), sums, stationary, .false.)
      if (stationary) variance = sums%square/real(sums%count, dp)
   end function variance_of

end module gyroakf_ar_arma_orders
