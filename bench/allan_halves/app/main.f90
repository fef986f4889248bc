! SPDX-License-Identifier: MIT
!> Monte Carlo of the comparison of a record's halves: how often it says that they differ.
!>
!>     ./run.sh [RECORDS [SAMPLES]]
!>
!> Defaults: 1000 records of 20000 samples at 10 Hz. The false alarms (no change) should be near the level; then records whose
!> second half is louder by 2 and 5 %, and records with a tenth of the samples lost.
program allan_halves
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compare_halves, compute_allan, dp, error_type, fit_noise, halves_options, &
      & halves_type, noise_options, noise_type, record_type, simulate_options, simulate_record
   implicit none (type, external)

   type :: case_type
      character(40) :: name = ""
      !> Q N B K R in deg/h and s
      real(dp) :: coefficient(5) = 0.0_dp
      !> Of an AR(1) term, its standard deviation 10 times that
      real(dp) :: phi = 0.0_dp
      !> Gain of the second half, and share of samples lost
      real(dp) :: gain = 1.0_dp, lost = 0.0_dp
      !> Power of the size of each sample: 2 has an excess kurtosis of 8.7, 0.5 one of -0.9
      real(dp) :: power = 1.0_dp
   end type case_type

   type(case_type), parameter :: cases(*) = [ &
      case_type("white", [0.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      case_type("white, flicker, walk", [0.0_dp, 18.0_dp, 6.0_dp, 0.3_dp, 0.0_dp]), &
      case_type("flicker", [0.0_dp, 0.0_dp, 6.0_dp, 0.0_dp, 0.0_dp]), &
      case_type("quantization, white, walk", [5.0_dp, 18.0_dp, 0.0_dp, 1.0_dp, 0.0_dp]), &
      case_type("white, flicker, walk; 10 % lost", [0.0_dp, 18.0_dp, 6.0_dp, 0.3_dp, 0.0_dp], 0.0_dp, 1.0_dp, 0.1_dp), &
      case_type("AR(1) 0.4", [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 0.4_dp), &
      case_type("AR(1) 0.99 and white", [0.0_dp, 3.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 0.99_dp), &
      case_type("white, heavy tails", [0.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 0.0_dp, 1.0_dp, 0.0_dp, 2.0_dp), &
      case_type("white, light tails", [0.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 0.0_dp, 1.0_dp, 0.0_dp, 0.5_dp), &
      case_type("white, second half +2 %", [0.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 0.0_dp, 1.02_dp), &
      case_type("white, second half +5 %", [0.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 0.0_dp, 1.05_dp)]
   character(40) :: word
   integer :: records, samples, i

   records = 1000
   samples = 20000
   do i = 1, command_argument_count()
      call get_command_argument(i, word)
      if (i == 1) read (word, *) records
      if (i == 2) read (word, *) samples
   end do
   write (output_unit, "(i0, a, i0, a)") records, " records of ", samples, " samples: share below each level, in %"
   write (output_unit, "(a40, 5a9)") "", "10 %", "5 %", "1 %", "0.1 %", "any tau"
   do i = 1, size(cases)
      call one_case(cases(i))
   end do

contains

   !> A line of the table.
   subroutine one_case(what)
      !> The noise
      type(case_type), intent(in) :: what

      real(dp), parameter :: level(4) = [0.1_dp, 0.05_dp, 0.01_dp, 0.001_dp]
      real(dp), allocatable :: p_value(:)
      logical, allocatable :: single(:)
      integer :: i

      allocate (p_value(records), single(records))
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(what, i, p_value(i), single(i))
      end do
      !$omp end parallel do
      write (output_unit, "(a40, 5f9.1)") what%name, (100*real(count(p_value < level(i)), dp)/records, i=1, 4), &
         & 100*real(count(single), dp)/records
   end subroutine one_case

   !> Simulates, fits and compares one record.
   subroutine one_record(what, number, p_value, single)
      !> The noise
      type(case_type), intent(in) :: what
      !> Its number, which is its seed
      integer, intent(in) :: number
      !> Of the comparison
      real(dp), intent(out) :: p_value
      !> A single ratio is beyond its limits of 95 %, shared among the averaging times
      logical, intent(out) :: single

      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(halves_type) :: halves
      type(error_type), allocatable :: failure

      options%samples = samples
      options%rate_hz = 10
      options%unit = "deg/h"
      options%coefficient = what%coefficient
      options%missing = what%lost
      options%seed = number
      if (what%phi > 0) then
         options%ar = [what%phi]
         options%ar_variance = 100.0_dp
      end if
      call simulate_record(options, record, failure)
      if (allocated(failure)) call give_up(failure)
      record%value = sign(abs(record%value)**what%power, record%value)
      record%value(samples/2 + 1:, 1) = what%gain*record%value(samples/2 + 1:, 1)
      if (allocated(record%present)) then
         call compute_allan(record%value(:, 1), 0.1_dp, allan_options(), curve, failure, record%present(:, 1))
      else
         call compute_allan(record%value(:, 1), 0.1_dp, allan_options(), curve, failure)
      end if
      if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
      if (allocated(failure)) then
         write (error_unit, "(2a, i0, 2a)") trim(what%name), ", record ", number, ": ", failure%message
         p_value = 2
         single = .false.
         return
      end if
      if (allocated(record%present)) then
         call compare_halves(record%value(:, 1), 0.1_dp, noise, halves_options(), halves, failure, record%present(:, 1))
      else
         call compare_halves(record%value(:, 1), 0.1_dp, noise, halves_options(), halves, failure)
      end if
      if (allocated(failure)) call give_up(failure)
      p_value = halves%p_value
      single = maxval(abs(halves%score)) > 2.9_dp
   end subroutine one_record

   !> Ends the program.
   subroutine give_up(failure)
      !> What went wrong
      type(error_type), intent(in) :: failure

      write (error_unit, "(a)") failure%message
      stop 1, quiet=.true.
   end subroutine give_up

end program allan_halves
