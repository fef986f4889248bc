! SPDX-License-Identifier: MIT
!> Coefficients of the noise terms: bias, errors, what their intervals and limits cover.
!>
!>     ./run.sh coefficients [RECORDS]
!>
!> Record i of every mix has the seed i. It is fitted twice: as the program does by default, octave averaging times, all terms
!> on offer; and, what --terms does, with the terms alone that are there. A record with 1/f noise is simulated at four times
!> the rate and averaged: fractional differences have an Allan variance of (2/pi) B^2 at one sample where the model has (2 ln
!> 2/pi) B^2, and what is more counts as white noise; of averages of four samples it is a ninth.
program coefficients
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fit_noise, int64, noise_options, &
      & noise_type, record_type, simulate_options, simulate_record
   use monte_carlo_table, only : argument_or, estimate_head, estimate_row, fixed, percent
   implicit none (type, external)

   !> A noise whose truth is known; sample interval 1 s
   type :: mix_type
      !> Its terms
      character(5) :: name
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
      & mix_type("N", 16384_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("QN", 16384_int64, [1.0_dp, 0.2_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("NB", 32768_int64, [0.0_dp, 1.0_dp, 0.2_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("NK", 32768_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.01_dp, 0.0_dp]), &
      & mix_type("NR", 16384_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 3.0e-5_dp]), &
      & mix_type("NBK", 16384_int64, [0.0_dp, 1.0_dp, 0.05_dp, 0.002_dp, 0.0_dp])]
   character(1), parameter :: letter(5) = ["Q", "N", "B", "K", "R"]

   !> Samples simulated for one of a record with 1/f noise
   integer, parameter :: averaged = 4

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
      type(outcome_type) :: outcome(2, records)
      integer :: i

      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(mix, i, outcome(:, i))
      end do
      !$omp end parallel do
      write (output_unit, "(/, 2a, i0, a, i0, a)") trim(mix%name), ": ", records, " records of ", mix%samples, " samples"
      call estimate_head("detected % | limit >= truth % | the same, not detected |")
      call print_rows(mix, "", outcome(1, :))
      call print_rows(mix, ", its terms alone", outcome(2, :))
      write (output_unit, "(/, a, *(a, a, a))") "Not there, but detected (%):", &
         & (" ", letter(i), fixed(percent(outcome(1, :)%detected(i) .and. mix%coefficient(i) <= 0), 1), i=1, 5)
      flush (output_unit)
   end subroutine study

   !> A record of a mix, fitted twice.
   subroutine one_record(mix, number, outcome)
      type(mix_type), intent(in) :: mix
      !> Its number, which is its seed
      integer, intent(in) :: number
      !> All terms on offer, its terms alone
      type(outcome_type), intent(out) :: outcome(:)
      type(simulate_options) :: options
      type(noise_options) :: how
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: failure
      real(dp), allocatable :: value(:)
      integer :: i, times

      times = merge(averaged, 1, mix%coefficient(3) > 0)
      options%samples = times*mix%samples
      options%rate_hz = times
      options%coefficient = mix%coefficient
      options%seed = number
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) then
         value = sum(reshape(record%value(:, 1), [times, int(mix%samples)]), dim=1)/times
         call compute_allan(value, 1.0_dp, allan_options(), curve, failure)
      end if
      do i = 1, 2
         if (i == 2) how%terms = trim(mix%name)
         if (.not. allocated(failure)) call fit_noise(curve, how, noise, failure)
         if (allocated(failure)) then
            write (error_unit, "(2a, i0, 2a)") trim(mix%name), ", record ", number, ": ", failure%message
            error stop
         end if
         outcome(i)%value = noise%coefficient%value
         outcome(i)%error = noise%coefficient%std_error
         outcome(i)%limit = noise%coefficient%upper_limit
         outcome(i)%detected = noise%coefficient%detected
      end do
   end subroutine one_record

   !> A row for every term of the mix: its intervals where it is detected, its limits in all records and where it is not detected.
   subroutine print_rows(mix, title, outcome)
      type(mix_type), intent(in) :: mix
      character(*), intent(in) :: title
      type(outcome_type), intent(in) :: outcome(:)
      character(80) :: further
      integer :: j

      do j = 1, 5
         if (mix%coefficient(j) <= 0) cycle
         associate (found => outcome%detected(j))
            further = fixed(percent(found), 1)//" |"//fixed(percent(outcome%limit(j) >= mix%coefficient(j)), 1)//" |"// &
               & missed(pack(outcome%limit(j) >= mix%coefficient(j), .not. found))//" |"
            call estimate_row(letter(j)//title, mix%coefficient(j), pack(outcome%value(j), found), &
               & pack(outcome%error(j), found), trim(further))
         end associate
      end do
   end subroutine print_rows

   !> Share of limits that hold where the term is not detected, "-" where that is too rare to say.
   function missed(holds) result(text)
      logical, intent(in) :: holds(:)
      character(8) :: text

      text = "-"
      if (size(holds) >= 100) text = fixed(percent(holds), 1)
   end function missed

end program coefficients
