! SPDX-License-Identifier: MIT
!> Degrees of freedom and confidence limits of any curve of the Allan family from the fitted noise mixture.
!>
!>     call compute_allan(rate, 0.1_dp, allan_options(), curve, error)
!>     call fit_noise(curve, noise_options(), noise, error)
!>     call compute_allan(rate, 0.1_dp, allan_options(kind="mdev"), modified, error)
!>     call give_mixture_limits(modified, noise)
!>
!> [[compute_allan]] gives each curve the degrees of freedom of the power law that it identifies at each averaging time; these
!> are the ones of the mixture that the overlapping Allan deviation was fitted with ([[mixture_degrees_of_freedom]]).
module gyroakf_allan_mixture_limits
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_deviations, only : allan_curve_type, terms_share
   use gyroakf_allan_mixture_edf, only : mixture_degrees_of_freedom
   use gyroakf_allan_fit_statement, only : noise_type
   use gyroakf_allan_noise_model, only : noise_model_type
   implicit none (type, external)
   private
   public :: give_mixture_limits

   !> Averaging times whose degrees of freedom are computed; between those of a denser curve they are interpolated
   integer, parameter :: places_max = 160

   !> From the result of a fit, or from a mixture for a sample interval of 1
   interface give_mixture_limits
      module procedure limits_of_noise, limits_of_model
   end interface give_mixture_limits

contains

   !> Replaces edf, lower and upper by those of the fitted mixture.
   subroutine limits_of_noise(curve, noise)
      !> From [[compute_allan]], of any kind; nothing is done to an empty one
      type(allan_curve_type), intent(inout) :: curve
      !> From [[fit_noise]], in the same units
      type(noise_type), intent(in) :: noise

      integer(int64) :: first

      first = 0
      if (noise%left_out > 0) first = nint(noise%tau_first/noise%sample_interval, int64)
      if (noise%misfit > 0) first = huge(first)
      if (allocated(curve%m)) call limits_of_model(curve, noise%mixture, first)
   end subroutine limits_of_noise

   !> The same from a mixture.
   subroutine limits_of_model(curve, model, first)
      !> From [[compute_allan]], of any kind; nothing is done to an empty one
      type(allan_curve_type), intent(inout) :: curve
      !> For a sample interval of 1; without any noise nothing is done
      type(noise_model_type), intent(in) :: model
      !> Averaging factor from which on the mixture describes the record; degrees of freedom may only fall before it
      integer(int64), intent(in), optional :: first

      real(dp), allocatable :: lag(:), known(:), share(:)
      real(dp) :: edf
      integer, allocatable :: place(:)
      integer :: i

      if (.not. allocated(curve%m) .or. all(model%squares <= 0)) return
      place = spread_places(curve%m)
      allocate (lag(size(place)), known(size(place)))
      do i = 1, size(place)
         lag(i) = log(real(curve%m(place(i)), dp))
         known(i) = log(mixture_degrees_of_freedom(curve%kind, curve%samples, curve%m(place(i)), model))
      end do
      share = terms_share(curve)
      do i = 1, size(curve%m)
         edf = exp(between(lag, known, log(real(curve%m(i), dp))))*share(i)
         if (present(first)) then
            if (curve%m(i) < first) edf = min(edf, curve%edf(i))
         end if
         curve%edf(i) = edf
      end do
      call chi_square_limits(curve%deviation, curve%edf, curve%confidence, curve%lower, curve%upper)
   end subroutine limits_of_model

   !> All places of a curve, or some evenly in the logarithm, with the first and the last.
   pure function spread_places(m) result(place)
      !> Averaging factors, ascending
      integer(int64), intent(in) :: m(:)
      integer, allocatable :: place(:)

      real(dp) :: step
      integer :: kept(places_max), i, count

      if (size(m) <= places_max) then
         place = [(i, i=1, size(m))]
         return
      end if
      step = log(real(m(size(m)), dp)/real(m(1), dp))/(places_max - 1)
      count = 1
      kept(1) = 1
      do i = 2, size(m) - 1
         if (count == places_max - 1) exit
         if (log(real(m(i), dp)/real(m(kept(count)), dp)) < step) cycle
         count = count + 1
         kept(count) = i
      end do
      kept(count + 1) = size(m)
      place = kept(:count + 1)
   end function spread_places

   !> Linear interpolation, constant outside.
   pure real(dp) function between(x, y, at)
      !> Ascending places and values there
      real(dp), intent(in) :: x(:), y(:)
      !> Where
      real(dp), intent(in) :: at

      integer :: low, high, middle

      low = 1
      high = size(x)
      do while (high - low > 1)
         middle = (low + high)/2
         if (x(middle) <= at) then
            low = middle
         else
            high = middle
         end if
      end do
      between = y(low)
      if (high > low) between = y(low) + max(0.0_dp, min(1.0_dp, (at - x(low))/(x(high) - x(low))))*(y(high) - y(low))
   end function between

end module gyroakf_allan_mixture_limits
