! SPDX-License-Identifier: MIT
!> Coefficients of the noise terms: bias, errors, what their intervals and limits cover.
!>
!>     ./run.sh coefficients [RECORDS]
!>
!> Record i of every mix has the seed i. The fit is the program's default: octave averaging times, all terms on offer.
program coefficients
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fit_noise, int64, noise_options, &
      & noise_type, record_type, simulate_options, simulate_record
   use monte_carlo_table, only : argument_or, estimate_head, estimate_row, fixed, percent
   implicit none (type, external)

   !> A noise whose truth is known; sample interval 1 s
   type :: mix_type
      character(28) :: name
      integer(int64) :: samples
      !> Q N B K R
      real(dp) :: coefficient(5)
   end type mix_type

   !> Of one record: values, errors, limits
   type :: outcome_type
      real(dp) :: value(5) = 0.0_dp, error(5) = 0.0_dp, limit(5) = 0.0_dp
      logical :: detected(5) = .false.
   end type outcome_type

   type(mix_type), parameter :: mixes(*) = [ &
      & mix_type("white", 16384_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("quantised", 16384_int64, [1.0_dp, 0.2_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("flicker", 32768_int64, [0.0_dp, 1.0_dp, 0.2_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("walk", 32768_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.01_dp, 0.0_dp]), &
      & mix_type("ramp", 16384_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 3.0e-5_dp]), &
      & mix_type("three", 131072_int64, [0.0_dp, 1.0_dp, 0.1_dp, 0.002_dp, 0.0_dp]), &
      & mix_type("faint", 16384_int64, [0.0_dp, 1.0_dp, 0.05_dp, 0.002_dp, 0.0_dp])]
   character(1), parameter :: letter(5) = ["Q", "N", "B", "K", "R"]

   integer :: records, i

   records = argument_or(5000)
   do i = 1, size(mixes)
      call study(mixes(i), records)
   end do

contains

   !> A mix.
   subroutine study(mix, records)
      type(mix_type), intent(in) :: mix
      integer, intent(in) :: records
      type(outcome_type) :: outcome(records)
      integer :: i

      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(mix, i, outcome(i))
      end do
      !$omp end parallel do
      call print_table(mix, outcome)
   end subroutine study

   !> A record of a mix.
   subroutine one_record(mix, number, outcome)
      type(mix_type), intent(in) :: mix
      !> Its number, which is its seed
      integer, intent(in) :: number
      type(outcome_type), intent(out) :: outcome
      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: failure

      options%samples = mix%samples
      options%rate_hz = 1
      options%coefficient = mix%coefficient
      options%seed = number
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) call compute_allan(record%value(:, 1), 1.0_dp, allan_options(), curve, failure)
      if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
      if (allocated(failure)) then
         write (error_unit, "(2a, i0, 2a)") trim(mix%name), ", record ", number, ": ", failure%message
         error stop
      end if
      outcome%value = noise%coefficient%value
      outcome%error = noise%coefficient%std_error
      outcome%limit = noise%coefficient%upper_limit
      outcome%detected = noise%coefficient%detected
   end subroutine one_record

   !> A row for every term of the mix: its intervals where it is detected, its limits in all records and where it is not detected;
   !> then how often a term is detected that is not there.
   subroutine print_table(mix, outcome)
      type(mix_type), intent(in) :: mix
      type(outcome_type), intent(in) :: outcome(:)
      character(80) :: further
      integer :: j

      write (output_unit, "(/, 2a, i0, a, i0, a)") trim(mix%name), ": ", size(outcome), " records of ", mix%samples, " samples"
      call estimate_head("detected % | limit >= truth % | the same, not detected |")
      do j = 1, 5
         if (mix%coefficient(j) <= 0) cycle
         associate (found => outcome%detected(j))
            further = fixed(percent(found), 1)//" |"//fixed(percent(outcome%limit(j) >= mix%coefficient(j)), 1)//" |"// &
               & missed(pack(outcome%limit(j) >= mix%coefficient(j), .not. found))//" |"
            call estimate_row(letter(j), mix%coefficient(j), pack(outcome%value(j), found), pack(outcome%error(j), found), &
               & trim(further))
         end associate
      end do
      write (output_unit, "(/, a, *(a, a, a))") "Not there, but detected (%):", &
         & (" ", letter(j), fixed(percent(outcome%detected(j) .and. mix%coefficient(j) <= 0), 1), j=1, 5)
   end subroutine print_table

   !> Share of limits that hold where the term is not detected, "-" where that is too rare to say.
   function missed(holds) result(text)
      logical, intent(in) :: holds(:)
      character(8) :: text

      text = "-"
      if (size(holds) >= 100) text = fixed(percent(holds), 1)
   end function missed

end program coefficients
