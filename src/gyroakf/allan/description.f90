! SPDX-License-Identifier: MIT
!> Which description of a curve holds: the five terms, a Markov process or a sinusoid with them, or the curve without its
!> first points.
!>
!> The further terms are tried where chi-square refuses the five. A low-pass filter in the sensor bends the
!> first points down; where the curve is a sum of the terms without them they are left out. (A Markov
!> process faster than three samples is taken for such a filter: it is white noise to every longer time.)
module gyroakf_allan_description
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_lapack, only : dgels
   use gyroakf_allan_fit_problem, only : first_guess, half_freedom, model_at, prepare_basis, problem_type, set_parameter, &
      & without_first
   use gyroakf_allan_noise_model, only : column_count, model_shape, noise_model_type, term_markov, term_quantisation, &
      & term_sinusoid, term_white
   use gyroakf_allan_term_selection, only : acceptable, select_terms, selection_type
   implicit none (type, external)
   private
   public :: description_type, describe_curve

   !> A description
   type :: description_type
      !> Its points and terms
      type(problem_type) :: problem
      !> The chosen terms
      type(selection_type) :: selection
      !> First points that are not described
      integer :: left_out = 0
   end type description_type

   !> Longest averaging factor that may be left out, and points that remain at least
   integer(int64), parameter :: left_out_max = 4096
   integer, parameter :: remaining_min = 6
   !> Chance of chi-square at least where points are left out, and what of its standard deviation the first point that stays may
   !> be bent by
   real(dp), parameter :: chance_after = 0.05_dp, bend_felt = 0.5_dp
   !> Shortfalls below this need not be in order
   real(dp), parameter :: shortfall_scatter = 0.1_dp
   !> Correlation time, in samples, below which a Markov process is a filter
   real(dp), parameter :: filter_time = 3.0_dp
   !> What a term must lower chi-square by where points are left out: how many was found by looking at the curve, too
   real(dp), parameter :: price_after = 8.0_dp
   !> What a further term, found by a search for its parameter, must lower chi-square by
   real(dp), parameter :: price_further = 16.0_dp
   !> A further term that does not make the description acceptable must lower chi-square by this factor to be kept
   real(dp), parameter :: worth = 3.0_dp
   !> Least cycles of a sinusoid in the longest averaging time: slower ones look like a ramp
   real(dp), parameter :: frequency_least = 0.25_dp
   !> Values of a parameter to an octave, and rounds that look closer
   integer, parameter :: times_per_octave = 3, frequencies_per_octave = 16, zooms = 3, zoom_points = 8

contains

   !> Finds the description.
   subroutine describe_curve(problem, automatic, extended, description, error)
      !> Points, and terms that are offered
      type(problem_type), intent(in) :: problem
      !> Points may be left out
      logical, intent(in) :: automatic
      !> A Markov process and a sinusoid may be tried, too
      logical, intent(in) :: extended
      !> The description
      type(description_type), intent(out) :: description
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      type(description_type) :: markov, sinusoid, other

      description%problem = problem
      call attempt(description, error)
      if (allocated(error) .or. .not. automatic .or. acceptable(description%selection)) return
      call attempt_with(problem, [term_markov], markov, error)
      if (allocated(error)) return
      if (extended .and. holds(markov, term_markov, description) .and. .not. filters(markov)) then
         description = markov
         return
      end if
      if (extended) then
         call attempt_with(description%problem, [term_sinusoid], sinusoid, error)      ! with its basis
         if (allocated(error)) return
         if (holds(sinusoid, term_sinusoid, description)) then
            description = sinusoid
            return
         end if
      end if
      if (holds(markov, term_markov, description) .and. filters(markov)) then
         call leave_out_bend(description, markov%selection%model, other)
      end if
      if (other%left_out == 0) call leave_out_points(description, other)
      if (other%left_out > 0) description = other
      if (other%left_out > 0 .or. .not. extended) return
      call keep_better(markov, term_markov, description)
      call keep_better(sinusoid, term_sinusoid, description)
      if (acceptable(description%selection)) return
      call attempt_with(problem, [term_markov, term_sinusoid], other, error)
      if (.not. allocated(error)) call keep_better(other, term_sinusoid, description)
   end subroutine describe_curve

   !> Whether a Markov process is so fast that it is a filter of white noise.
   pure logical function filters(description)
      !> The description
      type(description_type), intent(in) :: description

      filters = description%selection%model%correlation_time < filter_time
   end function filters

   !> Chooses among the offered terms and further ones.
   subroutine attempt_with(problem, further, description, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Further terms
      integer, intent(in) :: further(:)
      !> The description
      type(description_type), intent(out) :: description
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      description%problem = problem
      description%problem%offered(further) = .true.
      call attempt(description, error)
   end subroutine attempt_with

   !> Whether a description with a further term is acceptable, has that term and is much better than without.
   pure logical function holds(description, term, without)
      !> The description
      type(description_type), intent(in) :: description
      !> The term
      integer, intent(in) :: term
      !> The description without the term
      type(description_type), intent(in) :: without

      holds = acceptable(description%selection) .and. has(description, term) .and. &
         & description%selection%chi_square < without%selection%chi_square - price_further
   end function holds

   !> Whether a further term was chosen, with a parameter that the curve can show.
   pure logical function has(description, term)
      !> The description
      type(description_type), intent(in) :: description
      !> The term
      integer, intent(in) :: term

      has = description%selection%chosen(term)
      if (term == term_sinusoid) has = has .and. description%selection%model%frequency* &
         & real(description%problem%m(size(description%problem%m)), dp) > frequency_least
   end function has

   !> Takes a description with a further term if it is worth it.
   pure subroutine keep_better(other, term, description)
      !> The other one
      type(description_type), intent(in) :: other
      !> Its further term
      integer, intent(in) :: term
      !> The best so far
      type(description_type), intent(inout) :: description

      if (.not. has(other, term)) return
      if (acceptable(other%selection) .or. other%selection%chi_square*worth < description%selection%chi_square) then
         description = other
      end if
   end subroutine keep_better

   !> Chooses among the offered terms, from the best start for those with a parameter.
   subroutine attempt(description, error)
      !> Its problem says what is offered; its selection is set
      type(description_type), intent(inout) :: description
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      type(noise_model_type) :: start
      integer :: term, round

      associate (problem => description%problem)
         do round = 1, merge(2, 1, all(problem%offered([term_markov, term_sinusoid])))
            do term = term_markov, term_sinusoid
               if (problem%offered(term)) call scan(problem, term, start)
            end do
         end do
         call first_guess(problem, start, error)
         if (allocated(error)) return
         call prepare_basis(problem, start)
         call select_terms(problem, start, description%selection)
      end associate
   end subroutine attempt

   !> The parameter with which a term takes most from what the others leave of the curve.
   subroutine scan(problem, term, model)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Markov process or sinusoid
      integer, intent(in) :: term
      !> Its parameter is set
      type(noise_model_type), intent(inout) :: model

      real(dp) :: shortest, longest, step, best
      integer :: i, values, round

      longest = real(problem%m(size(problem%m)), dp)
      shortest = merge(0.5_dp, frequency_least/longest, term == term_markov)
      if (term == term_sinusoid) longest = 0.49_dp
      step = log(2.0_dp)/merge(times_per_octave, frequencies_per_octave, term == term_markov)
      values = 1 + int(log(longest/shortest)/step)
      best = best_of(problem, term, model, [(min(shortest*exp(i*step), longest), i=0, values)])
      do round = 1, zooms
         step = step/zoom_points
         best = best_of(problem, term, model, [(best*exp(i*step), i=-zoom_points, zoom_points)])
      end do
      call set_parameter(model, term, best)
   end subroutine scan

   !> Of some values of a parameter that one with which the term explains most.
   !>
   !> Weighted least squares in the other terms' columns, signs free; what is left of the term's column is compared with what is
   !> left of the curve.
   real(dp) function best_of(problem, term, model, values) result(best)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Markov process or sinusoid
      integer, intent(in) :: term
      !> For the parameter of the other further term
      type(noise_model_type), intent(in) :: model
      !> The values
      real(dp), intent(in) :: values(:)

      type(noise_model_type) :: trial
      real(dp) :: weight(size(problem%m)), right(size(problem%m), size(values) + 1), work(64*(size(values) + column_count) + 64)
      real(dp), allocatable :: design(:, :)
      real(dp) :: gain(size(values)), product
      integer :: i, p, n, info
      logical :: others(column_count)

      others = problem%offered
      others(term) = .false.
      p = count(others)
      n = size(problem%m)
      weight = sqrt(problem%edf/2)/problem%variance
      trial = model
      design = reshape([(weight*model_shape(trial, i, real(problem%m, dp)), i=1, column_count)], [n, column_count])
      design = design(:, pack([(i, i=1, column_count)], others))
      do i = 1, p
         design(:, i) = design(:, i)/norm2(design(:, i))
      end do
      right(:, 1) = weight*problem%variance
      do i = 1, size(values)
         call set_parameter(trial, term, values(i))
         right(:, i + 1) = weight*model_shape(trial, term, real(problem%m, dp))
         right(:, i + 1) = right(:, i + 1)/max(norm2(right(:, i + 1)), tiny(1.0_dp))
      end do
      best = values(1)
      if (p >= n) return
      info = 0
      if (p > 0) call dgels("N", n, p, size(values) + 1, design, n, right, n, work, size(work), info)
      if (info /= 0) return                                 ! (without columns dgels would clear what is right of them)
      do i = 1, size(values)                                ! the last rows are what is orthogonal to the columns
         product = dot_product(right(p + 1:, 1), right(p + 1:, i + 1))
         gain(i) = sign(product**2, product)/max(sum(right(p + 1:, i + 1)**2), 1e-20_dp)
      end do
      best = values(maxloc(gain, dim=1))
   end function best_of

   !> Leaves out the points that a filter bends, a Markov process faster than three samples that describes the curve.
   subroutine leave_out_bend(whole, filter, description)
      !> The description that does not hold
      type(description_type), intent(in) :: whole
      !> The mixture with the Markov process
      type(noise_model_type), intent(in) :: filter
      !> With `left_out` > 0 where the rest is described
      type(description_type), intent(out) :: description

      type(description_type) :: trial
      type(noise_model_type) :: unbent
      type(error_type), allocatable :: error
      real(dp), dimension(size(whole%problem%m)) :: shortfall
      real(dp) :: p
      integer :: left_out

      p = exp(-1/filter%correlation_time)
      unbent = filter                                       ! to long times the process is white
      unbent%squares(term_markov) = 0
      unbent%squares(term_white) = filter%squares(term_white) + filter%squares(term_markov)*(1 + p)/(1 - p)
      shortfall = 1 - model_at(whole%problem, filter)/model_at(whole%problem, unbent)
      left_out = count(shortfall >= bend_felt/sqrt(half_freedom(whole%problem, unbent)))
      left_out = min(left_out, size(shortfall) - remaining_min)
      if (left_out < 1) return
      call attempt_without(whole, left_out, trial, error)
      if (.not. allocated(error) .and. acceptable(trial%selection)) description = trial
   end subroutine leave_out_bend

   !> Chooses among the terms without the first points; quantisation noise, which lives there, is not offered.
   subroutine attempt_without(whole, left_out, description, error)
      !> With all points
      type(description_type), intent(in) :: whole
      !> Points that are left out
      integer, intent(in) :: left_out
      !> Without them
      type(description_type), intent(out) :: description
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      description%problem = without_first(whole%problem, left_out)
      description%problem%offered(term_quantisation) = .false.
      description%problem%price = price_after
      description%left_out = left_out
      call attempt(description, error)
   end subroutine attempt_without

   !> Leaves out the first points as long as the rest is no sum of the terms, or still feels the bend.
   !>
   !> What a filter takes from the variance falls as 1/m of it (its memory is finite): the share c/m is read off the points left
   !> out, and must be below half a standard deviation of the first point that stays.
   subroutine leave_out_points(whole, description)
      !> The description that does not hold
      type(description_type), intent(in) :: whole
      !> With `left_out` > 0 where the rest is described and the curve lies below it at every point left out
      type(description_type), intent(out) :: description

      type(description_type) :: trial
      type(error_type), allocatable :: error
      real(dp) :: shortfall(size(whole%problem%m)), half(size(whole%problem%m))
      integer :: left_out

      do left_out = 1, size(whole%problem%m) - remaining_min
         if (whole%problem%m(left_out) > left_out_max) exit
         call attempt_without(whole, left_out, trial, error)
         if (allocated(error)) exit
         if (trial%selection%probability < chance_after .or. trial%selection%freedom < 2) cycle
         shortfall = 1 - whole%problem%variance/model_at(whole%problem, trial%selection%model)
         if (.not. bent_by_filter(shortfall(:left_out))) cycle
         description = trial
         half(left_out + 1:) = half_freedom(trial%problem, trial%selection%model)
         if (maxval(shortfall(:left_out)*whole%problem%m(:left_out))/whole%problem%m(left_out + 1) &
            & < bend_felt/sqrt(half(left_out + 1))) exit
      end do
   end subroutine leave_out_points

   !> Whether points fall short of a model as behind a low-pass filter: all of them, less and less, at last by less than half.
   pure logical function bent_by_filter(shortfall)
      !> Share that each point lacks, from the shortest averaging time on
      real(dp), intent(in) :: shortfall(:)

      integer :: n

      n = size(shortfall)
      bent_by_filter = all(shortfall > 0) .and. shortfall(n) < 0.5_dp &
         & .and. all(shortfall(2:) < max(shortfall(:n - 1), shortfall_scatter))
   end function bent_by_filter

end module gyroakf_allan_description
