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

   !> Of the samples that a fit uses the orders are compared on one in so many; where samples are missing on fewer by the second
   integer(int64), parameter :: compared_share = 32, gap_share = 4

contains

   !> Fits all orders on one part of the series and chooses.
   subroutine choose_orders(series, hint, options, model, scale, error, progress)
      !> The series, centred and divided by `scale`
      type(arma_series_type), intent(in) :: series
      !> What is known of it
      type(arma_hint_type), intent(in) :: hint
      !> Orders on offer, criterion
      type(arma_options), intent(in) :: options
      !> Gets orders and table
      type(arma_model_type), intent(inout) :: model
      !> Of the series
      real(dp), intent(in) :: scale
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(arma_optimum_type), allocatable :: optimum(:)
      type(arma_objective_type) :: part
      real(dp) :: samples
      integer(int64) :: length
      integer :: i, lines, best

      length = max(options%max_samples/compared_share, 1000_int64)
      if (allocated(series%valid)) length = max(length/gap_share, 1000_int64)
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
      call tell_progress("ARMA orders", 0_int64, model%length, error, progress)
      if (allocated(error)) return
      !$omp parallel do default(shared) schedule(dynamic) if (samples > 1.0e3_dp)
      do i = lines, 1, -1
         call maximise_likelihood(part%series, hint, optimum(i)%p, optimum(i)%q, optimum(i))
      end do
      !$omp end parallel do
      allocate (model%table(lines))
      do i = 1, lines
         call learn_from_smaller(part, optimum, i)
         model%table(i) = arma_criteria(optimum(i)%p, optimum(i)%q, log_likelihood(optimum(i)%value, samples, scale), &
                                        variance_of(part, optimum(i))*scale**2, int(samples, int64))
         model%table(i)%usable = optimum(i)%converged .and. allocated(optimum(i)%parameter)
         if (model%table(i)%usable) model%table(i)%usable = &
            all(1.0_dp - tanh(abs(optimum(i)%parameter(optimum(i)%p + 1:optimum(i)%p + optimum(i)%q))) > 2.0_dp/samples)
      end do
      best = best_line(model%table, criterion_number(trim(options%criterion)))
      model%p = model%table(best)%p
      model%q = model%table(best)%q
   end subroutine choose_orders

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
               if (p > options%max_p .or. q > options%max_q) cycle
               if ((options%p >= 0 .and. p /= options%p) .or. (options%q >= 0 .and. q /= options%q)) cycle
               i = i + 1
               if (pass == 1) cycle
               optimum(i)%p = p
               optimum(i)%q = q
            end do
         end do
         if (pass == 1) allocate (optimum(i))
      end do
   end subroutine list_orders

   !> A model is never less likely than one that it contains: where it seems so, it is searched from there.
   subroutine learn_from_smaller(part, optimum, i)
      type(arma_objective_type), intent(inout) :: part
      type(arma_optimum_type), intent(inout) :: optimum(:)
      integer, intent(in) :: i
      real(dp) :: start(optimum(i)%p + optimum(i)%q + 1)
      integer :: j, p

      part%p = optimum(i)%p
      part%q = optimum(i)%q
      do j = 1, i - 1
         p = optimum(j)%p
         if (optimum(i)%p - p + optimum(i)%q - optimum(j)%q /= 1 .or. abs(optimum(i)%p - p) > 1) cycle
         if (optimum(j)%value >= optimum(i)%value .or. .not. allocated(optimum(j)%parameter)) cycle
         start(:) = 0.0_dp
         start(:p) = optimum(j)%parameter(:p)
         start(part%p + 1:part%p + optimum(j)%q) = optimum(j)%parameter(p + 1:p + optimum(j)%q)
         start(size(start)) = optimum(j)%parameter(size(optimum(j)%parameter))
         call improve(part, start, optimum(i))
      end do
   end subroutine learn_from_smaller

   !> sigma^2 at a maximum.
   real(dp) function variance_of(part, optimum) result(variance)
      type(arma_objective_type), intent(in) :: part
      type(arma_optimum_type), intent(in) :: optimum
      type(arma_sums_type) :: sums
      real(dp) :: phi(optimum%p), theta(optimum%q), jacobian(optimum%p + optimum%q + 1, optimum%p + optimum%q + 1)
      logical :: stationary

      variance = 0.0_dp
      if (.not. allocated(optimum%parameter)) return
      call split_free(optimum%parameter, phi, theta, jacobian)
      call sum_innovations(part%series, phi, theta, optimum%parameter(size(optimum%parameter)), sums, stationary, .false.)
      if (stationary) variance = sums%square/real(sums%count, dp)
   end function variance_of

end module gyroakf_ar_arma_orders
