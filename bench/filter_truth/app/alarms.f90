! SPDX-License-Identifier: MIT
!> How often a drift is found in records that have none: nothing in them is slower than five samples.
!>
!>     ./run.sh alarms [RECORDS]
program alarms
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf, only : dp, drift_identification_options, drift_identification_type, error_type, identify_drift_model, record_type, &
      simulate_options, simulate_record
   use filter_truth_figures, only : table_head, table_row
   implicit none (type, external)

   integer, parameter :: samples = 2000
   !> AR(1) coefficient of the noise, its variance, that of the white noise beside it
   real(dp), parameter :: cases(3, 3) = reshape([0.0_dp, 0.0_dp, 1.0_dp, 0.41_dp, 1.0_dp, 0.0_dp, 0.6_dp, 1.0_dp, 1.0_dp], [3, 3])
   character(40), parameter :: names(3) = [character(40) :: "white noise", "AR(1) noise, phi = 0.41", &
                                           "AR(1) noise, phi = 0.6, as much white"]
   integer :: records, k, s, found
   character(20) :: word
   character(12) :: cell(1)

   records = 300
   if (command_argument_count() > 0) call get_command_argument(1, word)
   if (command_argument_count() > 0) read (word, *) records
   write (output_unit, "(a, i0, a, i0, a, /)") "Records in which a drift is found that is not there, of ", records, " of ", &
      samples, " samples:"
   call table_head("noise", [character(20) :: "records with a drift"])
   do k = 1, size(names)
      found = 0
      do s = 1, records
         if (passes(cases(:, k), s)) found = found + 1
      end do
      write (cell(1), "(i0)") found
      call table_row(trim(names(k)), cell)
   end do

contains

   !> A drift is found in a record of noise.
   logical function passes(noise, seed)
      !> Coefficient and variance of the AR(1) process, variance of the white noise
      real(dp), intent(in) :: noise(3)
      integer, intent(in) :: seed
      type(simulate_options) :: options
      type(record_type) :: record
      type(drift_identification_type) :: identification
      type(error_type), allocatable :: error

      options%samples = samples
      options%rate_hz = 1.0_dp
      options%seed = seed
      options%coefficient(2) = sqrt(noise(3))
      if (noise(2) > 0.0_dp) then
         options%ar = [noise(1)]
         options%ar_variance = noise(2)
      end if
      call simulate_record(options, record, error)
      if (.not. allocated(error)) call identify_drift_model(record%value(:, 1), drift_identification_options(), &
                                                            identification, error)
      if (allocated(error)) error stop error%message
      passes = identification%found
   end function passes
end program alarms
