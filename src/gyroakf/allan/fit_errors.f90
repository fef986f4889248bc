! SPDX-License-Identifier: MIT
!> Standard errors of a noise fit, and how its estimates correlate.
!>
!> They are those of estimates drawn with the full covariance of the variances and with the bounds of the fit
!> ([[gyroakf_allan_fit_uncertainty]]).
module gyroakf_allan_fit_errors
   use gyroakf_kinds, only : dp
   use gyroakf_allan_fit_problem, only : half_freedom, model_at, offered_terms, problem_type, relative_columns, &
      & relative_covariance, tangents_of, trigamma
   use gyroakf_allan_fit_uncertainty, only : draw_estimates, sandwich_covariance
   use gyroakf_allan_noise_model, only : column_count, noise_model_type, term_markov
   implicit none (type, external)
   private
   public :: fit_errors_type, errors_of, free_errors_of

   !> Errors of the unknowns of a fit, in samples; 0 for terms that are not offered
   type :: fit_errors_type
      !> Of the coefficients (of the Markov process: sqrt(2 variance/time))
      real(dp) :: coefficient(column_count) = 0.0_dp
      !> Of the squares where every unknown may be of either sign
      real(dp) :: square(column_count) = 0.0_dp
      !> Of the logarithms of the correlation time and the frequency
      real(dp) :: parameter(column_count) = 0.0_dp
      !> Of the coefficients: 1 on the diagonal
      real(dp) :: correlation(column_count, column_count) = 0.0_dp
   end type fit_errors_type

   !> A weighted linear fit
   type :: linear_type
      !> Terms, and those whose parameter is an unknown too: columns in this order
      integer, allocatable :: term(:), tangent(:)
      !> Columns of length 1 and their lengths: [points, unknowns], [unknowns]
      real(dp), allocatable :: design(:, :), length(:)
      !> Weights and covariance of the points: [points], [points, points]
      real(dp), allocatable :: weight(:), covariance(:, :)
      !> Covariance of the unknowns of columns of length 1: [unknowns, unknowns]
      real(dp), allocatable :: squares(:, :)
   end type linear_type

contains

   !> Errors of a fit.
   subroutine errors_of(problem, linear, chosen, fitted, errors, converged)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> The variances were fitted, not their logarithms
      logical, intent(in) :: linear
      !> The mixture that is taken as true, and the fitted one
      type(noise_model_type), intent(in) :: chosen, fitted
      !> The errors
      type(fit_errors_type), intent(out) :: errors
      !> False if the columns are not independent
      logical, intent(out) :: converged

      type(linear_type) :: near
      real(dp), allocatable :: centre(:), estimates(:, :), unbounded(:, :)
      logical :: inside
      integer :: j, n

      call linearise(problem, linear, chosen, fitted, near, converged)
      if (.not. converged) return
      associate (term => near%term, tangent => near%tangent, length => near%length)
         n = size(term)
         do j = 1, n
            errors%square(term(j)) = free_error(near, j)
         end do
         allocate (centre(size(length)))
         centre = 0
         centre(:n) = merge(1.0_dp, 0.5_dp, chosen%squares(term) > 0)*fitted%squares(term)*length(:n)
         call draw_estimates(near%design, near%weight, near%covariance, centre, size(tangent), estimates, unbounded)
         converged = size(estimates, 2) > 0
         if (.not. converged) return
         inside = all(abs(estimates(:n, :) - unbounded(:n, :)) <= 0)
         if (inside) then
            errors%correlation(term, term) = correlation_of(near%squares(:n, :n))
         else
            errors%correlation(term, term) = correlation_of(covariance_of(sqrt(max(estimates(:n, :), 0.0_dp))))
         end if
         do j = 1, n
            associate (free => errors%square(term(j))*length(j))
               if (inside .and. centre(j) > 0) then
                  errors%coefficient(term(j)) = free/(2*sqrt(centre(j)*length(j)))
               else                                         ! the scatter of the draws themselves falls out
                  errors%coefficient(term(j)) = scatter(sqrt(max(estimates(j, :), 0.0_dp)/length(j)))*free/scatter(unbounded(j, :))
               end if
            end associate
         end do
         do j = 1, size(tangent)
            errors%parameter(tangent(j)) = free_error(near, n + j)
            if (tangent(j) == term_markov) errors%coefficient(term_markov) = scatter(sqrt(2/fitted%correlation_time* &
               & max(estimates(findloc(term, term_markov, dim=1), :), 0.0_dp)/length(findloc(term, term_markov, dim=1)))* &
               & exp(-max(-2.0_dp, min(2.0_dp, estimates(n + j, :)/length(n + j)/2))))
         end do
      end associate
   end subroutine errors_of

   !> Errors of the squares where every unknown may be of either sign.
   subroutine free_errors_of(problem, linear, chosen, fitted, free, converged)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> The variances were fitted, not their logarithms
      logical, intent(in) :: linear
      !> The mixture that is taken as true, and the fitted one
      type(noise_model_type), intent(in) :: chosen, fitted
      !> The errors, 0 for terms that are not offered
      real(dp), intent(out) :: free(column_count)
      !> False if the columns are not independent
      logical, intent(out) :: converged

      type(linear_type) :: near
      integer :: j

      free = 0
      call linearise(problem, linear, chosen, fitted, near, converged)
      if (.not. converged) return
      do j = 1, size(near%term)
         free(near%term(j)) = free_error(near, j)
      end do
   end subroutine free_errors_of

   !> A fit as a weighted linear one near its result.
   subroutine linearise(problem, linear, chosen, fitted, near, converged)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> The variances were fitted, not their logarithms
      logical, intent(in) :: linear
      !> For the weights, and the fitted mixture
      type(noise_model_type), intent(in) :: chosen, fitted
      !> The linear fit
      type(linear_type), intent(out) :: near
      !> False if the columns are not independent
      logical, intent(out) :: converged

      real(dp), dimension(size(problem%m)) :: half, factor
      integer :: j, n, p

      near%term = offered_terms(problem)
      near%tangent = tangents_of(problem, fitted)
      call relative_columns(problem, fitted, model_at(problem, fitted), near%term, near%tangent, near%design)
      near%weight = 1/(1/half_freedom(problem, chosen) + problem%misfit)
      n = size(near%weight)
      p = size(near%design, 2)
      allocate (near%covariance(n, n), near%length(p), near%squares(p, p))
      call relative_covariance(problem, fitted, near%covariance)
      if (.not. linear) then                                ! the logarithm spreads more where nu is small
         half = half_freedom(problem, fitted)
         factor = sqrt(half*trigamma(half))
         do j = 1, n
            near%covariance(:, j) = near%covariance(:, j)*factor*factor(j)
         end do
      end if
      do j = 1, p
         near%length(j) = norm2(sqrt(near%weight)*near%design(:, j))
         near%design(:, j) = near%design(:, j)/near%length(j)
      end do
      call sandwich_covariance(near%design, near%weight, near%covariance, near%squares, converged)
   end subroutine linearise

   !> Error of an unknown of either sign.
   pure real(dp) function free_error(near, j)
      !> The linear fit
      type(linear_type), intent(in) :: near
      !> Its column
      integer, intent(in) :: j

      free_error = sqrt(max(near%squares(j, j), 0.0_dp))/near%length(j)
   end function free_error

   !> Covariance of draws, but for a factor.
   pure function covariance_of(draws) result(covariance)
      !> [unknowns, draws]
      real(dp), intent(in) :: draws(:, :)
      real(dp) :: covariance(size(draws, 1), size(draws, 1))

      real(dp) :: distance(size(draws, 1), size(draws, 2))

      distance = draws - spread(sum(draws, dim=2)/size(draws, 2), 2, size(draws, 2))
      covariance = matmul(distance, transpose(distance))
   end function covariance_of

   !> A covariance as correlation; what does not vary correlates with nothing.
   pure function correlation_of(covariance) result(correlation)
      !> [unknowns, unknowns]
      real(dp), intent(in) :: covariance(:, :)
      real(dp) :: correlation(size(covariance, 1), size(covariance, 1))

      integer :: i, j

      correlation = 0
      do j = 1, size(covariance, 1)
         correlation(j, j) = 1
         do i = 1, j - 1
            if (.not. (covariance(i, i) > 0 .and. covariance(j, j) > 0)) cycle
            correlation(i, j) = covariance(i, j)/(sqrt(covariance(i, i))*sqrt(covariance(j, j)))
            correlation(j, i) = correlation(i, j)
         end do
      end do
   end function correlation_of

   !> Standard deviation.
   pure real(dp) function scatter(values)
      !> The values
      real(dp), intent(in) :: values(:)

      scatter = sqrt(sum((values - sum(values)/size(values))**2)/(size(values) - 1))
   end function scatter

end module gyroakf_allan_fit_errors
