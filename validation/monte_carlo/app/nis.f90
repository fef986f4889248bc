! SPDX-License-Identifier: MIT
!> Filters and smoother with the true model: are innovations and errors as large as they say?
!>
!>     ./run.sh nis [RECORDS]
!>
!> Record i of every model has the seed i. Each figure should be near its nominal value: the squared innovations over their stated
!> variance 1 on average, 95 % of the records within the band that the library states, 5 % of the tests of whiteness rejected; the
!> squared errors to the true drift over their stated variance 1 on average, 95 % of the errors within 1.96 stated deviations.
program nis
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : component_model_type, dp, error_type, fill_normal, filter_options, filter_result_type, filter_series, &
      & drift_filter_type, filter_type, int64, new_drift_filter, new_filter, random_type, seed_random, smooth_drift
   use monte_carlo_table, only : argument_or, first_order, fixed, percent
   implicit none (type, external)

   integer(int64), parameter :: samples = 2000
   real(dp), parameter :: two_sided = 1.959963984540054_dp, five_percent = 0.05_dp

   !> Of one record: mean squared innovation; it lies in the band; whiteness rejected; error of filter (last sample) and smoother
   !> (middle) over its stated deviation
   type :: outcome_type
      real(dp) :: nis = 0.0_dp, filter = 0.0_dp, smoother = 0.0_dp
      logical :: within = .false., colored = .false.
   end type outcome_type

   integer :: records

   records = argument_or(5000)
   write (output_unit, "(i0, a, i0, a)") records, " records of ", samples, " samples each"
   write (output_unit, "(/, a)") "| model | mean squared innovation | +- | in the band % | colored % | filter: squared error | " &
      & //"in 95 % | smoother: squared error | in 95 % |"
   write (output_unit, "(a)") "|---|--:|--:|--:|--:|--:|--:|--:|--:|"
   call study("AR(1) 0.41 in noise of its variance", component_model_type(1, [0.41_dp, 0.0_dp, 0.0_dp], &
      & [1 - 0.41_dp**2, 0.0_dp, 0.0_dp], 1.0_dp))
   call study("AR(1) 0.98 in white noise", component_model_type(1, [0.98_dp, 0.0_dp, 0.0_dp], &
      & [1.0e-4_dp*(1 - 0.98_dp**2), 0.0_dp, 0.0_dp], 4.2e-4_dp))
   call study("random walk in white noise", component_model_type(1, [1.0_dp, 0.0_dp, 0.0_dp], &
      & [1.0e-6_dp, 0.0_dp, 0.0_dp], 4.2e-4_dp))
   call study("AR(1) and random walk in white noise", component_model_type(2, [0.98_dp, 1.0_dp, 0.0_dp], &
      & [1.0e-4_dp*(1 - 0.98_dp**2), 1.0e-7_dp, 0.0_dp], 4.2e-4_dp))

contains

   !> A row of the table.
   subroutine study(name, model)
      character(*), intent(in) :: name
      type(component_model_type), intent(in) :: model
      type(outcome_type), allocatable :: outcome(:)
      real(dp) :: mean
      integer :: i

      allocate (outcome(records))
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(model, i, outcome(i))
      end do
      !$omp end parallel do
      mean = sum(outcome%nis)/records
      write (output_unit, "(*(a))") "| ", name, " |", fixed(mean, 4), " |", &
         & fixed(sqrt(sum((outcome%nis - mean)**2)/(records - 1.0_dp)/records), 4), " |", fixed(percent(outcome%within), 1), " |", &
         & fixed(percent(outcome%colored), 1), " |", fixed(sum(outcome%filter**2)/records, 3), " |", &
         & fixed(percent(abs(outcome%filter) <= two_sided), 1), " |", fixed(sum(outcome%smoother**2)/records, 3), " |", &
         & fixed(percent(abs(outcome%smoother) <= two_sided), 1), " |"
   end subroutine study

   !> A record, filtered and smoothed with its own model.
   subroutine one_record(model, number, outcome)
      type(component_model_type), intent(in) :: model
      !> Its number, which is its seed
      integer, intent(in) :: number
      type(outcome_type), intent(out) :: outcome
      type(random_type) :: random
      type(filter_type) :: of_series
      type(drift_filter_type) :: of_drift
      class(filter_type), allocatable :: filter
      type(filter_result_type) :: result
      type(error_type), allocatable :: failure
      real(dp), dimension(samples) :: truth, part, z, estimate, variance
      logical :: slow(model%count)
      integer :: k

      call seed_random(random, int(number, int64))
      truth = 0.0_dp
      do k = 1, model%count
         call first_order(random, model%phi(k), model%q(k), part)
         truth = truth + part
      end do
      call fill_normal(random, z)
      z = truth + sqrt(model%r)*z
      slow = .true.
      if (model%count == 1 .and. model%phi(1) < 0.5_dp) then
         call new_filter(of_series, model%phi(:1), model%q(1), model%r, filter_options(), failure)
         allocate (filter, source=of_series)
      else
         call new_drift_filter(of_drift, model, slow, filter_options(), failure)
         allocate (filter, source=of_drift)
      end if
      if (.not. allocated(failure)) call filter_series(filter, z, estimate, result, failure)
      if (.not. allocated(failure)) then
         outcome%nis = result%nis_mean
         outcome%within = result%nis_mean >= result%nis_low .and. result%nis_mean <= result%nis_high
         outcome%colored = result%ljung_box%p_value < five_percent
         outcome%filter = (estimate(samples) - truth(samples))/sqrt(filter%p(1, 1))
         variance = 0.0_dp
         call smooth_drift(model, slow, z, estimate, failure, variance=variance)
      end if
      if (allocated(failure)) then
         write (error_unit, "(a, i0, 2a)") "record ", number, ": ", failure%message
         error stop
      end if
      outcome%smoother = (estimate(samples/2) - truth(samples/2))/sqrt(variance(samples/2))
   end subroutine one_record

end program nis
