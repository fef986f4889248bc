! SPDX-License-Identifier: MIT
!> Which noise terms a curve asks for, whether they describe it, and up to where a term could hide.
!>
!> The variances are made nearly normal by the cube root (E. B. Wilson, M. M. Hilferty, PNAS 17, 1931),
!>
!> $$ e_i = 3 \left( (\hat\sigma^2_i/\sigma^2_{model,i})^{1/3} - 1 + \frac{2}{9 \nu_i} \right), $$
!>
!> and independent by the eigenvectors of their correlation matrix whose eigenvalues are above 1e-3 of the largest. With the
!> full covariance such a fit reaches the Cramer-Rao bound of white and quantisation noise, so no test of
!> the curve is sharper. Of all sets S of the offered terms that one is chosen for which
!>
!> $$ \chi^2(S) + \lambda |S| $$
!>
!> is least: a term stays if it lowers chi-square by more than lambda. The covariance is that of the
!> chosen mixture itself; choice and covariance are renewed until they agree.
module gyroakf_allan_term_selection
   use gyroakf_kinds, only : dp
   use gyroakf_special, only : chi_square_survival, digamma
   use gyroakf_lapack, only : dposv
   use gyroakf_allan_fit_problem, only : model_at, move_parameters, offered_terms, prepare_basis, problem_type, &
      & relative_columns, relative_covariance, tangents_of, trigamma
   use gyroakf_allan_noise_model, only : column_count, noise_model_type
   use gyroakf_allan_whitening, only : whitening
   implicit none (type, external)
   private
   public :: selection_type, select_terms, upper_limit_of, acceptable, normal_residuals, error_among, detection_size

   !> Chosen terms and how well they fit
   type :: selection_type
      !> The mixture of the chosen terms, by the generalised fit
      type(noise_model_type) :: model
      !> Which terms were chosen
      logical :: chosen(column_count) = .false.
      !> Least chi-square and its degrees of freedom
      real(dp) :: chi_square = 0.0_dp
      integer :: freedom = 0
      !> Probability of a chi-square as large or larger; 1 where no freedom is left
      real(dp) :: probability = 1.0_dp
   end type selection_type

   !> Normal equations of the whitened problem
   type :: normal_type
      !> Terms, and those whose parameter is an unknown too: columns in this order
      integer, allocatable :: term(:), tangent(:)
      !> A'A, A'y, y'y for columns of length 1, and their lengths
      real(dp), allocatable :: square(:, :), right(:), length(:)
      real(dp) :: total = 0.0_dp
      !> Chi-square of the mixture itself
      real(dp) :: chi_square = 0.0_dp
      !> Independent combinations of the points
      integer :: kept = 0
   end type normal_type

   !> Rounds of choice and covariance, and relative change of the model at which they agree
   integer, parameter :: rounds_max = 12
   real(dp), parameter :: agreed = 1e-4_dp
   !> Greatest and least variance of a point's own relative scatter: half a degree of freedom, and a ramp alone
   real(dp), parameter :: own_most = 4.0_dp, own_least = 2e-15_dp
   !> A model is wrong where chi-square is as large by chance in fewer than one of so many records
   real(dp), parameter :: chance_least = 1e-4_dp
   !> Standard normal quantile of 95 %, and what of it remains of a limit that a chance low may not undercut (one standard error)
   real(dp), parameter :: normal_95 = 1.6448536269514722_dp, sensitivity = 0.6448536269514722_dp
   !> How often the limit is looked for at twice the value
   integer, parameter :: doublings = 30
   !> Relative precision of a limit
   real(dp), parameter :: limit_precision = 1e-3_dp

contains

   !> Chooses the terms.
   !>
   !> A curve that no mixture describes can lead from one choice to another for ever, each the best where things are linear at the
   !> last. Of the mixtures met that one is taken then whose own chi-square and price are least.
   subroutine select_terms(problem, start, selection)
      !> Points and terms; its basis is renewed where a correlation time moves
      type(problem_type), intent(inout) :: problem
      !> A mixture near the curve
      type(noise_model_type), intent(in) :: start
      !> The choice
      type(selection_type), intent(out) :: selection

      type(normal_type) :: normal
      type(noise_model_type) :: before
      type(selection_type) :: best
      logical :: same
      integer :: round
      real(dp) :: cost, least

      selection%model = start
      least = huge(1.0_dp)
      do round = 1, rounds_max
         before = selection%model
         call prepare_basis(problem, before)
         call normal_equations(problem, before, normal)
         cost = normal%chi_square + problem%price*unknowns_of(normal, before)
         if (cost < least .and. any(before%squares > 0)) then
            least = cost
            best = selection_type(before, before%squares > 0, normal%chi_square, normal%kept - unknowns_of(normal, before))
         end if
         same = .true.
         call choose_set(problem, normal, before, selection, same)
         if (same .and. maxval(abs(model_at(problem, selection%model)/model_at(problem, before) - 1)) < agreed) exit
      end do
      if (round > rounds_max .and. least < huge(1.0_dp)) selection = best
      selection%probability = 1
      if (selection%freedom > 0) then
         selection%probability = chi_square_survival(selection%chi_square, real(selection%freedom, dp))
      end if
   end subroutine select_terms

   !> Unknowns of a mixture: its squares, and the parameters that go with them.
   pure integer function unknowns_of(normal, model)
      !> Its equations
      type(normal_type), intent(in) :: normal
      !> The mixture
      type(noise_model_type), intent(in) :: model

      unknowns_of = count(model%squares > 0) + size(normal%tangent)
   end function unknowns_of

   !> Standard errors that a square must have to be chosen in 95 % of records.
   pure real(dp) function detection_size(price)
      !> What a term must lower chi-square by
      real(dp), intent(in) :: price

      detection_size = sqrt(price) + normal_95
   end function detection_size

   !> Whether a chi-square may be chance.
   pure logical function acceptable(selection)
      !> The choice
      type(selection_type), intent(in) :: selection

      acceptable = selection%probability >= chance_least
   end function acceptable

   !> Cube-root residuals of the points over their standard deviations.
   function normal_residuals(problem, model) result(residual)
      !> Points, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The mixture
      type(noise_model_type), intent(in) :: model
      real(dp) :: residual(size(problem%m))

      real(dp) :: covariance(size(problem%m), size(problem%m))
      integer :: i

      call near_normal(problem, model, residual, covariance)
      residual = residual/[(sqrt(covariance(i, i)), i=1, size(residual))]
   end function normal_residuals

   !> The nearly normal residuals of the variances relative to the model, and their covariance.
   !>
   !> A misfit is one of the logarithms, of either sign: no chi-square of few degrees of freedom, whose skewness would be put right
   !> with it. With a misfit the residuals are therefore logarithms, only the bias of the points' own scatter removed.
   subroutine near_normal(problem, model, residual, covariance)
      !> Points, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> Residuals: [points]
      real(dp), intent(out) :: residual(:)
      !> Their covariance: [points, points]
      real(dp), intent(out) :: covariance(:, :)

      real(dp) :: own(size(residual)), factor(size(residual))
      integer :: i

      call relative_covariance(problem, model, covariance)
      own = [(min(covariance(i, i) - problem%misfit, own_most), i=1, size(residual))]
      residual = problem%variance/model_at(problem, model)
      if (problem%misfit <= 0) then
         residual = 3*(residual**(1/3.0_dp) - 1 + own/9)
         return
      end if
      own = max(own, own_least)
      residual = log(residual) - digamma(1/own) - log(own)
      factor = sqrt(trigamma(1/own)/own)                    ! the logarithm spreads more where nu is small
      do i = 1, size(factor)
         covariance(:, i) = covariance(:, i)*factor*factor(i)
      end do
   end subroutine near_normal

   !> Whitens the points at a model and forms the normal equations.
   subroutine normal_equations(problem, model, normal)
      !> Points and terms, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The mixture at which everything is linear
      type(noise_model_type), intent(in) :: model
      !> The equations
      type(normal_type), intent(out) :: normal

      real(dp), allocatable :: columns(:, :), axes(:, :), white(:, :)
      real(dp) :: reference(size(problem%m)), residual(size(problem%m)), target(size(problem%m))
      real(dp) :: covariance(size(problem%m), size(problem%m))
      integer :: i, j, p

      reference = model_at(problem, model)
      call near_normal(problem, model, residual, covariance)
      normal%term = offered_terms(problem)
      normal%tangent = tangents_of(problem, model)
      call relative_columns(problem, model, reference, normal%term, normal%tangent, columns)
      call whitening(covariance, axes)
      p = size(columns, 2)
      normal%kept = size(axes, 1)
      target(:normal%kept) = matmul(axes, residual + 1)
      white = matmul(axes, columns)
      allocate (normal%length(p), normal%square(p, p), normal%right(p))
      do j = 1, p
         normal%length(j) = max(norm2(white(:, j)), tiny(1.0_dp))
         white(:, j) = white(:, j)/normal%length(j)
         normal%right(j) = dot_product(white(:, j), target(:normal%kept))
         do i = 1, j
            normal%square(i, j) = dot_product(white(:, i), white(:, j))
            normal%square(j, i) = normal%square(i, j)
         end do
      end do
      normal%total = sum(target(:normal%kept)**2)
      normal%chi_square = sum(matmul(axes, residual)**2)
   end subroutine normal_equations

   !> The set of terms that is worth its price, and its mixture.
   subroutine choose_set(problem, normal, before, selection, same)
      !> For the price
      type(problem_type), intent(in) :: problem
      !> Normal equations
      type(normal_type), intent(in) :: normal
      !> The mixture at which they hold
      type(noise_model_type), intent(in) :: before
      !> The choice, renewed
      type(selection_type), intent(inout) :: selection
      !> The choice is that of before
      logical, intent(out) :: same

      real(dp) :: x(size(normal%right)), cost, least
      logical :: used(size(normal%right)), chosen(column_count), fits
      integer :: set, n

      n = size(normal%term)
      least = huge(1.0_dp)
      chosen = selection%chosen
      do set = 1, 2**n - 1
         used = columns_of(normal, set)
         if (count(used) > normal%kept) cycle
         call solve_set(normal, used, x, cost, fits)
         if (.not. fits) cycle
         if (any(x(:n) <= 0 .and. used(:n))) cycle         ! the best without the negative one is another set
         if (cost + problem%price*count(used) >= least) cycle
         least = cost + problem%price*count(used)
         selection%chi_square = max(cost, 0.0_dp)
         selection%freedom = normal%kept - count(used)
         selection%chosen = .false.
         selection%chosen(pack(normal%term, used(:n))) = .true.
         selection%model%squares = 0
         selection%model%squares(normal%term) = merge(x(:n)/normal%length(:n), 0.0_dp, used(:n))
         call move_parameters(selection%model, normal%tangent, x(n + 1:)/normal%length(n + 1:), before)
      end do
      same = all(chosen .eqv. selection%chosen)
      if (least < huge(1.0_dp)) return
      selection%model = before                              ! every set has a negative square: nothing describes the curve
      selection%chosen = .false.
      selection%chi_square = normal%total
      selection%freedom = normal%kept
   end subroutine choose_set

   !> Columns of a set of terms: with a term its tangent.
   pure function columns_of(normal, set) result(used)
      !> Normal equations
      type(normal_type), intent(in) :: normal
      !> Bits of the terms
      integer, intent(in) :: set
      logical :: used(size(normal%right))

      integer :: j, n

      n = size(normal%term)
      used = .false.
      do j = 1, n
         used(j) = btest(set, j - 1)
      end do
      do j = 1, size(normal%tangent)
         used(n + j) = any(normal%term == normal%tangent(j) .and. used(:n))
      end do
   end function columns_of

   !> Least squares in some of the columns.
   subroutine solve_set(normal, used, x, cost, fits)
      !> Normal equations
      type(normal_type), intent(in) :: normal
      !> Which columns
      logical, intent(in) :: used(:)
      !> Solution, 0 elsewhere
      real(dp), intent(out) :: x(:)
      !> Sum of the squared residuals
      real(dp), intent(out) :: cost
      !> False if the columns are not independent
      logical, intent(out) :: fits

      real(dp) :: part(count(used), count(used)), right(count(used), 1)
      integer :: place(count(used)), j, info

      x = 0
      cost = normal%total
      fits = .true.
      if (.not. any(used)) return
      place = pack([(j, j=1, size(used))], used)
      part = normal%square(place, place)
      right(:, 1) = normal%right(place)
      call dposv("U", size(place), 1, part, size(place), right, size(place), info)
      fits = info == 0
      if (.not. fits) return
      x(place) = right(:, 1)
      cost = normal%total - dot_product(right(:, 1), normal%right(place))
   end subroutine solve_set

   !> One-sided 95 % limit of a square: the value that the curve undercuts in one of twenty records.
   !>
   !> For a value h the others are fitted, and the covariance is that of this mixture; z(h) is what the curve asks h to be
   !> larger by,
   !> in standard errors. The limit is where z = -1.645; for a term that was not chosen it is not below what one standard error of
   !> bad luck would give (a chance low is no better knowledge).
   real(dp) function upper_limit_of(problem, model, term, step) result(limit)
      !> Points and terms, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The chosen mixture
      type(noise_model_type), intent(in) :: model
      !> The term
      integer, intent(in) :: term
      !> About how far the limit may be above the square, > 0
      real(dp), intent(in) :: step

      type(noise_model_type) :: mixture
      real(dp) :: low, high, z_low, z_high, z, error, least
      integer :: round

      mixture = model
      low = model%squares(term)
      call score(problem, term, low, mixture, z_low, error)
      least = 0
      if (low <= 0) least = sensitivity*error
      limit = max(low, least)
      if (z_low <= -normal_95) return
      high = low + max(step, error)
      do round = 1, doublings
         call score(problem, term, high, mixture, z_high, error)
         if (z_high < -normal_95) exit
         low = high
         z_low = z_high
         high = 2*high
      end do
      limit = low
      if (z_high >= -normal_95) return                      ! one degree of freedom or less: the curve sets no limit
      do round = 1, 40                                      ! regula falsi (Illinois)
         if (high - low <= limit_precision*high) exit
         limit = low + (high - low)*(z_low + normal_95)/(z_low - z_high)
         limit = max(low + 0.01_dp*(high - low), min(high - 0.01_dp*(high - low), limit))
         call score(problem, term, limit, mixture, z, error)
         if (abs(z + normal_95) < limit_precision) exit
         if (z > -normal_95) then
            low = limit
            z_low = z
            z_high = (z_high - normal_95)/2
         else
            high = limit
            z_high = z
            z_low = (z_low - normal_95)/2
         end if
      end do
      limit = max(limit, least)
   end function upper_limit_of

   !> Standard error of the square of a term among those of a mixture, by the generalised fit.
   real(dp) function error_among(problem, model, term) result(error)
      !> Averaging factors, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The mixture; squares of 0 are not fitted
      type(noise_model_type), intent(in) :: model
      !> The term
      integer, intent(in) :: term

      type(normal_type) :: normal
      real(dp) :: x(column_count + 2), z

      call normal_equations(problem, model, normal)
      x = 0
      call conditional_score(normal, findloc(normal%term, term, dim=1), x(:size(normal%right)), &
         & [model%squares(normal%term) > 0 .and. normal%term /= term, spread(.true., 1, size(normal%tangent))], z, error)
      error = error/normal%length(findloc(normal%term, term, dim=1))
   end function error_among

   !> What the curve asks a square to be larger by, in standard errors, the other terms fitted.
   subroutine score(problem, term, value, mixture, z, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> The term
      integer, intent(in) :: term
      !> The value of its square, >= 0
      real(dp), intent(in) :: value
      !> A mixture near it; the fitted one
      type(noise_model_type), intent(inout) :: mixture
      !> Standard errors
      real(dp), intent(out) :: z
      !> Standard error of the square
      real(dp), intent(out) :: error

      integer, parameter :: rounds = 3
      type(normal_type) :: normal
      type(noise_model_type) :: before
      real(dp), allocatable :: x(:)
      logical, allocatable :: used(:)
      integer :: round, k, n

      do round = 1, rounds
         mixture%squares(term) = value
         call normal_equations(problem, mixture, normal)
         k = findloc(normal%term, term, dim=1)
         call fit_others(normal, k, value*normal%length(k), x, used)
         n = size(normal%term)
         mixture%squares(normal%term) = x(:n)/normal%length(:n)
         before = mixture
         call move_parameters(mixture, normal%tangent, x(n + 1:)/normal%length(n + 1:), before)
      end do
      call conditional_score(normal, k, x, used, z, error)
      error = error/normal%length(k)
   end subroutine score

   !> The best set of the other terms for a fixed value of one.
   subroutine fit_others(normal, k, fixed, x, used)
      !> Normal equations
      type(normal_type), intent(in) :: normal
      !> The column whose value is fixed, and the value
      integer, intent(in) :: k
      real(dp), intent(in) :: fixed
      !> Solution with it
      real(dp), allocatable, intent(out) :: x(:)
      !> The columns that are not zero, without the fixed one
      logical, allocatable, intent(out) :: used(:)

      type(normal_type) :: rest
      real(dp) :: trial(size(normal%right)), cost, least
      logical :: set_used(size(normal%right)), fits
      integer :: set, n

      n = size(normal%term)
      rest = normal
      rest%right = normal%right - fixed*normal%square(:, k)
      rest%total = 0
      least = huge(1.0_dp)
      allocate (x(size(trial)), used(size(trial)))
      x = 0
      used = .false.
      do set = 0, 2**n - 1
         if (btest(set, k - 1)) cycle
         set_used = columns_of(normal, set)
         if (count(set_used) >= normal%kept) cycle
         call solve_set(rest, set_used, trial, cost, fits)
         if (.not. fits) cycle
         if (any(trial(:n) <= 0 .and. set_used(:n)) .or. cost >= least) cycle
         least = cost
         x = trial
         used = set_used
      end do
      x(k) = fixed
   end subroutine fit_others

   !> The score of a column against the residual, the other columns that are in use taken out of it.
   subroutine conditional_score(normal, k, x, used, z, error)
      !> Normal equations
      type(normal_type), intent(in) :: normal
      !> The column
      integer, intent(in) :: k
      !> The solution
      real(dp), intent(in) :: x(:)
      !> Other columns that are free
      logical, intent(in) :: used(:)
      !> Score in standard errors
      real(dp), intent(out) :: z
      !> Standard error of the column's unknown
      real(dp), intent(out) :: error

      type(normal_type) :: column
      real(dp) :: share(size(x)), cost, gradient(size(x))
      logical :: fits

      gradient = normal%right - matmul(normal%square, x)
      column = normal
      column%right = normal%square(:, k)
      column%total = normal%square(k, k)
      call solve_set(column, used, share, cost, fits)
      cost = max(cost, 1e-12_dp)                            ! squared length of what is left of the column
      z = (gradient(k) - dot_product(share, gradient))/sqrt(cost)
      error = 1/sqrt(cost)
   end subroutine conditional_score

end module gyroakf_allan_term_selection
