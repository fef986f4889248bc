! SPDX-License-Identifier: MIT
!> Tests of a unit root and of stationarity: how often they reject at 5 %, where the null hypothesis holds and where it does not.
!>
!>     ./run.sh unit_root [SERIES]
!>
!> Series i of every process has the seed i. The processes are x_k = phi x_(k-1) + w_k, stationary from the start; with phi = 1
!> from 0.
program unit_root
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : adf_options, adf_type, dp, error_type, int64, kpss_options, kpss_type, random_type, seed_random, &
      & test_adf, test_kpss
   use monte_carlo_table, only : argument_or, first_order, fixed, percent
   implicit none (type, external)

   integer, parameter :: columns = 9
   real(dp), parameter :: phi(*) = [1.0_dp, 0.95_dp, 0.9_dp, 0.5_dp, 0.0_dp], five_percent = 0.05_dp
   integer(int64), parameter :: samples(*) = [100_int64, 1000_int64]

   integer :: records, i, j

   records = argument_or(10000)
   write (output_unit, "(i0, a)") records, " series each; rejected at 5 %:"
   write (output_unit, "(/, a)") "| n | phi | ADF c, AIC | p < 0.05 | c, BIC | c, t | c, 0 lags | ct, AIC | n, AIC | " &
      & //"KPSS c | KPSS ct |"
   write (output_unit, "(*(a))") ("|--:", j=1, columns + 2), "|"
   do i = 1, size(samples)
      do j = 1, size(phi)
         call study(samples(i), phi(j), records)
      end do
   end do

contains

   !> A row of the table.
   subroutine study(n, phi, records)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: phi
      integer, intent(in) :: records
      logical, allocatable :: rejected(:, :)
      integer :: i

      allocate (rejected(records, columns))
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_series(n, phi, i, rejected(i, :))
      end do
      !$omp end parallel do
      write (output_unit, "(a, i0, a, f4.2, *(2a))") "| ", n, " | ", phi, (" |", fixed(percent(rejected(:, i)), 1), i=1, columns), &
         & " |"
   end subroutine study

   !> A series and the verdict of every test.
   subroutine one_series(n, phi, number, rejected)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: phi
      !> Its number, which is its seed
      integer, intent(in) :: number
      !> [columns]
      logical, intent(out) :: rejected(:)
      type(random_type) :: random
      type(adf_type) :: adf
      real(dp) :: x(n)

      call seed_random(random, int(number, int64))
      call first_order(random, phi, 1.0_dp, x)
      call ask_adf(x, adf_options(), adf)
      rejected(1) = adf%stationary
      rejected(2) = adf%p_value < five_percent
      call ask_adf(x, adf_options(criterion="bic"), adf)
      rejected(3) = adf%stationary
      call ask_adf(x, adf_options(criterion="t"), adf)
      rejected(4) = adf%stationary
      call ask_adf(x, adf_options(lags=0), adf)
      rejected(5) = adf%stationary
      call ask_adf(x, adf_options(regression="ct"), adf)
      rejected(6) = adf%stationary
      call ask_adf(x, adf_options(regression="n"), adf)
      rejected(7) = adf%stationary
      call ask_kpss(x, rejected(8:))
   end subroutine one_series

   !> The augmented Dickey-Fuller test.
   subroutine ask_adf(x, options, adf)
      real(dp), intent(in), contiguous :: x(:)
      type(adf_options), intent(in) :: options
      type(adf_type), intent(out) :: adf
      type(error_type), allocatable :: failure

      call test_adf(x, options, adf, failure)
      call check(failure)
   end subroutine ask_adf

   !> The KPSS test with a constant and with a line.
   subroutine ask_kpss(x, rejected)
      real(dp), intent(in), contiguous :: x(:)
      !> [2]
      logical, intent(out) :: rejected(:)
      type(kpss_type) :: kpss
      type(error_type), allocatable :: failure
      character(2), parameter :: regression(2) = ["c ", "ct"]
      integer :: k

      do k = 1, 2
         call test_kpss(x, kpss_options(regression=regression(k)), kpss, failure)
         call check(failure)
         rejected(k) = .not. kpss%stationary
      end do
   end subroutine ask_kpss

   !> Ends the program where a test failed.
   subroutine check(failure)
      type(error_type), allocatable, intent(in) :: failure

      if (.not. allocated(failure)) return
      write (error_unit, "(a)") failure%message
      error stop
   end subroutine check

end program unit_root
