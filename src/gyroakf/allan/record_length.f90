! SPDX-License-Identifier: MIT
!> How long a record must be to show a noise term.
!>
!>     call record_to_see(noise, curve%samples, 4, (0.5_dp*limit)**2, times_as_long)
!>
!> A term is chosen in 95 % of records where its square is so many standard errors ([[detection_size]]) of the generalised fit
!> ([[gyroakf_allan_term_selection]]). The error at another length follows from the analytic covariance of the
!> fitted mixture with the term in it; no record is simulated.
module gyroakf_allan_record_length
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_fit_problem, only : model_at, prepare_basis, problem_type
   use gyroakf_allan_fit_statement, only : noise_type
   use gyroakf_allan_noise_model, only : noise_model_type
   use gyroakf_allan_term_selection, only : detection_size, error_among
   implicit none (type, external)
   private
   public :: record_to_see, never

   !> So many times the record and more is never
   real(dp), parameter :: never = 1.0e4_dp
   !> Steps of the search for a length that is enough, and how often the place between two steps is looked at
   real(dp), parameter :: stride = 10.0_dp
   integer, parameter :: refinements = 1

contains

   !> How many times as long as the record another one must be.
   subroutine record_to_see(noise, samples, term, square, times_as_long)
      !> From [[fit_noise]]
      type(noise_type), intent(in) :: noise
      !> Samples of the record
      integer(int64), intent(in) :: samples
      !> 1 .. 5 for Q N B K R
      integer, intent(in) :: term
      !> Square of the coefficient that is to be seen, for a sample interval of 1, > 0
      real(dp), intent(in) :: square
      !> Factor, at least 1; `never` where it is that or more
      real(dp), intent(out) :: times_as_long

      type(noise_model_type) :: model
      real(dp) :: low, middle, high, at_low, at_middle, at_high
      integer :: round

      model = noise%mixture
      model%squares(term) = square
      low = 0                                               ! logarithms of lengths, and of sizes in standard errors there
      at_low = lack(low)
      times_as_long = 1
      if (at_low <= 0) return
      times_as_long = never
      do
         high = min(low + log(stride), log(never))
         at_high = lack(high)
         if (at_high <= 0) exit
         if (high >= log(never)*(1 - 1e-9_dp)) return
         low = high
         at_low = at_high
      end do
      do round = 1, refinements
         middle = low + (high - low)*at_low/(at_low - at_high)
         at_middle = lack(middle)
         if (at_middle > 0) then
            low = middle
            at_low = at_middle
         else
            high = middle
            at_high = at_middle
         end if
      end do
      times_as_long = exp(low + (high - low)*at_low/(at_low - at_high))

   contains

      !> By what the term misses the size that is seen, as a logarithm.
      real(dp) function lack(length)
         real(dp), intent(in) :: length

         lack = log(detection_size(noise%price)*error_at(noise, exp(length), samples, model, term)/square)
      end function lack

   end subroutine record_to_see

   !> Standard error of a square among those of a mixture in a longer record.
   !>
   !> It lacks as large a share of its terms as the record, its fit begins at the same averaging time and ends at the same share of
   !> its length, and misses the mixture by as much.
   real(dp) function error_at(noise, times, samples, model, term) result(error)
      !> The fit of the record
      type(noise_type), intent(in) :: noise
      !> How many times as long
      real(dp), intent(in) :: times
      !> Samples of the record
      integer(int64), intent(in) :: samples
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> The term
      integer, intent(in) :: term

      type(problem_type) :: problem
      integer(int64) :: first
      real(dp) :: longest
      integer :: i, octaves

      first = max(1_int64, nint(noise%tau_first/noise%sample_interval, int64))
      longest = times*min(noise%tau_last/noise%sample_interval, real(samples, dp)/3)
      octaves = max(0, int(log(max(1.0_dp, longest/real(first, dp)))/log(2.0_dp)))
      problem%samples = nint(times*real(samples, dp), int64)
      problem%m = [(first*2_int64**i, i=0, octaves)]
      allocate (problem%complete(octaves + 1))
      problem%complete = noise%share
      problem%misfit = noise%misfit**2
      problem%offered = model%squares > 0
      problem%variance = model_at(problem, model)
      call prepare_basis(problem, model)
      error = error_among(problem, model, term)
   end function error_at

end module gyroakf_allan_record_length
