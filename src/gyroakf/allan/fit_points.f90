! SPDX-License-Identifier: MIT
!> What a noise fit is asked for, and the points of the curve that it looks at.
module gyroakf_allan_fit_points
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_deviations, only : allan_curve_type, terms_share
   use gyroakf_allan_fit_problem, only : problem_type
   use gyroakf_allan_noise_model, only : column_count, term_count, term_letters
   implicit none (type, external)
   private
   public :: noise_options, choose_terms, choose_points

   !> What to fit
   type :: noise_options
      !> "auto": Q N B K R, a Markov process and a sinusoid only where these do not describe the curve, and without the first points
      !> where a filter bends them. Or letters of the terms, in any order: QNBKR, M Markov process, S sinusoid
      character(8) :: terms = "auto"
      !> Shortest and longest averaging time that the fit looks at, s
      real(dp) :: tau_min = 0.0_dp, tau_max = huge(1.0_dp)
      !> Reserved for limits of the coefficients; those of the curve have the curve's own
      real(dp) :: confidence = 0.683_dp
      !> "log": logarithms of the variances, their bias removed; "linear": the variances
      character(6) :: method = "log"
      !> With "auto": a Markov process and a sinusoid may be tried
      logical :: further_terms = .true.
   end type noise_options

   !> Points of a fit at most; a denser curve is thinned evenly in the logarithm
   integer, parameter :: points_max = 40

contains

   !> Reads the letters of the terms.
   subroutine choose_terms(options, offered, automatic, error)
      !> Options
      type(noise_options), intent(in) :: options
      !> Which terms are fitted, Q N B K R M S
      logical, intent(out) :: offered(column_count)
      !> Further terms may be tried, and points left out
      logical, intent(out) :: automatic
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      integer :: i

      automatic = options%terms == "auto"
      offered = [(i <= term_count, i=1, column_count)]
      if (options%method /= "log" .and. options%method /= "linear") then
         call fatal_error(error, status%invalid_argument, "fit method '"//trim(options%method)//"': there are log and linear")
      else if (automatic) then
         return
      else if (verify(trim(options%terms), term_letters) > 0 .or. options%terms == " ") then
         call fatal_error(error, status%invalid_argument, "terms '"//trim(options%terms)//"': auto, or letters of "//term_letters)
      else
         offered = [(index(options%terms, term_letters(i:i)) > 0, i=1, column_count)]
      end if
   end subroutine choose_terms

   !> Takes the averaging times in the range, at most points_max of them.
   subroutine choose_points(curve, options, problem, error)
      !> The curve
      type(allan_curve_type), intent(in) :: curve
      !> Options
      type(noise_options), intent(in) :: options
      !> Its points are set
      type(problem_type), intent(inout) :: problem
      !> invalid_argument, too_few_samples, constant_input
      type(error_type), allocatable, intent(out) :: error

      real(dp), allocatable :: share(:)
      integer, allocatable :: place(:)
      integer :: i, unknowns
      character(160) :: text

      if (curve%kind /= "oadev") then
         call fatal_error(error, status%invalid_argument, "the noise terms are fitted to a curve of kind oadev, this one is "// &
            & trim(curve%kind))
      else if (.not. (ieee_is_finite(options%tau_min) .and. ieee_is_finite(options%tau_max))) then
         call fatal_error(error, status%invalid_argument, "the range of averaging times of the fit must be finite")
      else if (.not. (allocated(curve%deviation) .and. allocated(curve%edf) .and. allocated(curve%terms))) then
         call fatal_error(error, status%invalid_argument, "the Allan curve is empty")
      end if
      if (allocated(error)) return
      place = pack([(i, i=1, size(curve%m))], curve%tau >= options%tau_min*(1 - 1e-9_dp) &
         & .and. curve%tau <= options%tau_max)
      unknowns = count(problem%offered) + count(problem%offered(term_count + 1:))
      if (size(place) < unknowns) then
         write (text, "(a, i0, a, i0)") "a fit of ", unknowns, &
            & " unknowns needs as many averaging times, there are ", size(place)
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      call thin(curve%m, place)
      if (any(curve%deviation(place) <= tiny(1.0_dp))) then
         call fatal_error(error, status%constant_input, "an Allan deviation is zero: the record does not vary")
         return
      end if
      problem%samples = curve%samples
      problem%m = curve%m(place)
      problem%scale = curve%deviation(place(1))**2
      problem%variance = (curve%deviation(place)/curve%deviation(place(1)))**2
      problem%edf = curve%edf(place)
      share = terms_share(curve)
      problem%complete = share(place)
   end subroutine choose_points

   !> Keeps at most points_max places, evenly in the logarithm of the averaging factor.
   pure subroutine thin(m, place)
      !> Averaging factors, ascending
      integer(int64), intent(in) :: m(:)
      !> Places in it, ascending; thinned on return
      integer, allocatable, intent(inout) :: place(:)

      integer :: kept(points_max), count, i
      real(dp) :: step, next

      if (size(place) <= points_max) return
      step = log(real(m(place(size(place))), dp)/real(m(place(1)), dp))/(points_max - 1)
      count = 0
      next = log(real(m(place(1)), dp))
      do i = 1, size(place)
         if (log(real(m(place(i)), dp)) < next - 1e-9_dp .or. count == points_max) cycle
         count = count + 1
         kept(count) = place(i)
         next = max(next + step, log(real(m(place(i)), dp)) + 0.5_dp*step)
      end do
      kept(count) = place(size(place))                      ! the longest one stays
      place = kept(:count)
   end subroutine thin

end module gyroakf_allan_fit_points
