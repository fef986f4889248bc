! SPDX-License-Identifier: MIT
!> Monte Carlo of the degrees of freedom and limits that a fitted mixture gives to every kind of deviation, and of the deviations of
!> records with missing samples.
!>
!>     ./run.sh [RECORDS [SAMPLES [Q N B K R [LOST [GAP]]]]]
!>
!> Defaults: 400 records of 5000 samples, sample interval 1, Q N B K R = 0 1 0.1 0.005 0; of the records with missing samples a
!> share
!> LOST = 0.05 is lost at random and a stretch of GAP = 0.1 of the record from 40 % on. The columns: degrees of freedom of
!> the true mixture, those of the scatter of the variances, their ratio, share of the 68.3 % limits that hold the mean; with missing
!> samples the mean variance against that of complete records, and the same columns.
program allan_edf
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, give_mixture_limits, int64, int8, &
      & longest_factor, next_uniform, noise_model_type, random_type, record_type, seed_random, simulate_options, simulate_record, &
      & statistic_names
   implicit none (type, external)

   integer(int64), parameter :: factors(5) = [1_int64, 4_int64, 30_int64, 300_int64, 1000_int64]
   type(simulate_options) :: truth
   type(noise_model_type) :: model
   real(dp), allocatable :: variance(:, :, :, :), limit(:, :, :, :, :)
   real(dp) :: edf(size(factors), size(statistic_names), 2), lost, gap
   character(40) :: word
   integer :: records, i

   records = 400
   truth%samples = 5000
   truth%rate_hz = 1
   truth%unit = "deg/s"
   truth%coefficient = [0.0_dp, 1.0_dp, 0.1_dp, 0.005_dp, 0.0_dp]
   lost = 0.05_dp
   gap = 0.1_dp
   do i = 1, command_argument_count()
      call get_command_argument(i, word)
      select case (i)
      case (1); read (word, *) records
      case (2); read (word, *) truth%samples
      case (3:7); read (word, *) truth%coefficient(i - 2)
      case (8); read (word, *) lost
      case default; read (word, *) gap
      end select
   end do
   model%squares(:5) = truth%coefficient**2
   allocate (variance(records, size(factors), size(statistic_names), 2), source=0.0_dp)
   allocate (limit(2, records, size(factors), size(statistic_names), 2), source=0.0_dp)
   !$omp parallel do schedule(dynamic)
   do i = 1, records
      call one_record(i)
   end do
   !$omp end parallel do
   call print_table()

contains

   !> Simulates a record, computes its curves without and with missing samples.
   subroutine one_record(number)
      !> Its number, which is its seed
      integer, intent(in) :: number

      type(simulate_options) :: options
      type(record_type) :: record
      type(error_type), allocatable :: failure
      type(random_type) :: random
      integer(int8) :: valid(truth%samples)
      real(dp) :: u
      integer(int64) :: k
      integer :: kind

      options = truth
      options%seed = number
      call simulate_record(options, record, failure)
      if (allocated(failure)) call stop_with(failure)
      call seed_random(random, 1000000 + int(number, int64))
      do k = 1, truth%samples
         call next_uniform(random, u)
         valid(k) = merge(0_int8, 1_int8, u < lost)
      end do
      valid(4*truth%samples/10 + 1:4*truth%samples/10 + nint(gap*truth%samples)) = 0
      do kind = 1, size(statistic_names)
         call one_curve(number, kind, 1, record%value(:, 1), spread(1_int8, 1, int(truth%samples)))
         call one_curve(number, kind, 2, record%value(:, 1), valid)
      end do
   end subroutine one_record

   !> One curve.
   subroutine one_curve(number, kind, set, rate, valid)
      !> Record, statistic, 1 complete or 2 with missing samples
      integer, intent(in) :: number, kind, set
      !> The record
      real(dp), intent(in) :: rate(:)
      integer(int8), intent(in) :: valid(:)

      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(error_type), allocatable :: failure
      integer :: i, j

      options%kind = statistic_names(kind)
      options%taus = "1,4,30,300,1000"
      call compute_allan(rate, 1.0_dp, options, curve, failure, valid)
      if (allocated(failure)) call stop_with(failure)
      call give_mixture_limits(curve, model)
      do i = 1, size(factors)
         j = findloc(curve%m, factors(i), dim=1)
         if (j == 0) cycle
         variance(number, i, kind, set) = curve%deviation(j)**2
         limit(:, number, i, kind, set) = [curve%lower(j), curve%upper(j)]**2
         if (number == 1) edf(i, kind, set) = curve%edf(j)
      end do
   end subroutine one_curve

   subroutine stop_with(failure)
      !> What failed
      type(error_type), intent(in) :: failure

      write (error_unit, "(a)") failure%message
      stop 1, quiet=.true.
   end subroutine stop_with

   !> Prints a line per kind and averaging time.
   subroutine print_table()
      real(dp) :: mean(2), scatter(2)
      integer :: kind, i, set

      write (output_unit, "(2(a, i0), a, f5.3, a, f5.3)") "records ", records, ", samples ", truth%samples, ", lost ", lost, &
         & ", gap ", gap
      write (output_unit, "(a)") "kind       m |       edf   scatter  ratio  hold % |  ratio     +-"// &
         & "       edf   scatter  ratio  hold %"
      do kind = 1, size(statistic_names)
         do i = 1, size(factors)
            if (factors(i) > longest_factor(statistic_names(kind), truth%samples)) cycle
            if (any(variance(:, i, kind, :) <= 0)) cycle
            mean = sum(variance(:, i, kind, :), dim=1)/records
            do set = 1, 2
               scatter(set) = 2*mean(set)**2*(records - 1)/sum((variance(:, i, kind, set) - mean(set))**2)
            end do
            write (output_unit, "(a6, i6, a, 2f10.2, f7.3, f8.1, a, f8.4, f7.4, 2f10.2, f7.3, f8.1)") statistic_names(kind), &
               & factors(i), " |", edf(i, kind, 1), scatter(1), edf(i, kind, 1)/scatter(1), &
               & holding(limit(:, :, i, kind, 1), mean(1)), &
               & " |", mean(2)/mean(1), &
               & sqrt(sum((variance(:, i, kind, 2)/mean(2) - variance(:, i, kind, 1)/mean(1))**2))/records, edf(i, kind, 2), &
               & scatter(2), edf(i, kind, 2)/scatter(2), &
               & holding(limit(:, :, i, kind, 2), mean(1))
         end do
      end do
   end subroutine print_table

   !> Share of the limits of a set that hold a variance, in percent.
   pure real(dp) function holding(limits, value)
      !> Lower and upper: [2, records]
      real(dp), intent(in) :: limits(:, :)
      !> The variance
      real(dp), intent(in) :: value

      holding = 100*count(limits(1, :) <= value .and. limits(2, :) >= value)/real(records, dp)
   end function holding

end program allan_edf
