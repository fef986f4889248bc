! SPDX-License-Identifier: MIT
!> Autocovariances that a pass over the series makes on the way, for all who need them: the Ljung-Box test, the
!> autocorrelations, AR models.
!>
!>     call plan_autocovariance(shared, max_lag, moments%mean, moments%remainder)
!>     call test_adf(x, options, result, error, valid, shared=shared)      ! a pass that fills it
!>     call need_autocovariance(x, shared, error, valid)                   ! a pass of its own where that did not happen
!>     call ljung_box_of(shared%r(0:20), n, 0, test, error, shared%pairs(0:20))
!>
!> The mean is known before, from the moments.
module gyroakf_stats_shared_autocovariance
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last
   use gyroakf_stats_residual_block, only : residual_block
   use gyroakf_stats_lagged_products, only : add_lagged_products
   implicit none (type, external)
   private
   public :: autocovariance_type, plan_autocovariance, need_autocovariance
   public :: lag_buffer_type, open_lag_buffer, add_lag_block, close_autocovariance

   !> As [[gyroakf_stats_autocovariance:compute_autocovariance]] gives them
   type :: autocovariance_type
      !> Largest lag, -1: nothing is asked for
      integer :: max_lag = -1
      !> Mean of the present samples and what it lost when it was rounded
      real(dp) :: mean = 0.0_dp, remainder = 0.0_dp
      !> Length of the series
      integer(int64) :: samples = 0
      !> Biased autocovariances, [0:max_lag]; not allocated until a pass has filled them
      real(dp), allocatable :: r(:)
      !> Present pairs at each lag: [0:max_lag]
      integer(int64), allocatable :: pairs(:)
   end type autocovariance_type

   !> A block of the series without its mean, and its past
   type :: lag_buffer_type
      !> Values and presence (1 or 0): [1-max_lag:length]
      real(dp), allocatable :: value(:), here(:)
   end type lag_buffer_type

contains

   !> Says what is wanted.
   pure subroutine plan_autocovariance(shared, max_lag, mean, remainder)
      !> Nothing is filled
      type(autocovariance_type), intent(out) :: shared
      !> Largest lag, >= 0; less than the length of the series
      integer, intent(in) :: max_lag
      !> Mean of the present samples and what it lost when it was rounded
      real(dp), intent(in) :: mean, remainder

      shared%max_lag = max_lag
      shared%mean = mean
      shared%remainder = remainder
   end subroutine plan_autocovariance

   !> Fills what no pass has filled before; one pass.
   subroutine need_autocovariance(x, shared, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Planned before; remains as it is where it is filled
      type(autocovariance_type), intent(inout) :: shared
      !> invalid_argument (nothing planned, size of valid), too_few_samples, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: products(:, :), number(:, :)
      type(lag_buffer_type) :: buffer
      integer(int64) :: n, first
      integer :: chunk, bad

      if (allocated(shared%r)) return
      n = size(x, kind=int64)
      call check_plan(n, shared, error, valid)
      if (allocated(error)) return
      allocate (products(0:shared%max_lag, chunk_count(n)), stat=bad)
      if (bad == 0) allocate (number(0:shared%max_lag, chunk_count(n)), stat=bad)
      if (bad /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the lagged sums")
         return
      end if
      products = 0.0_dp
      number = 0.0_dp
      !$omp parallel do if (n >= threads_from) default(shared) private(buffer, first) schedule(dynamic)
      do chunk = 1, chunk_count(n)
         call open_lag_buffer(buffer, shared%max_lag)
         do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
            call add_lag_block(x, shared, first, min(first + block_length - 1, chunk_last(n, chunk)), buffer, &
               & products(:, chunk), number(:, chunk), valid)
         end do
         deallocate (buffer%value, buffer%here)
      end do
      !$omp end parallel do
      call close_autocovariance(shared, n, sum(products, 2), sum(number, 2))
   end subroutine need_autocovariance

   !> Refuses a plan that does not fit the series.
   subroutine check_plan(n, shared, error, valid)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> The plan
      type(autocovariance_type), intent(in) :: shared
      !> invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text

      if (shared%max_lag < 0) then
         call fatal_error(error, status%invalid_argument, "no autocovariances are asked for")
      else if (n <= int(shared%max_lag, int64)) then
         write (text, '("lag ", i0, " needs at least ", i0, " samples, there are ", i0)') shared%max_lag, &
            & int(shared%max_lag, int64) + 1, n
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (present(valid)) then
         if (size(valid, kind=int64) /= n) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
         end if
      end if
   end subroutine check_plan

   !> Allocates a buffer for blocks of [[gyroakf_chunks:block_length]] samples.
   pure subroutine open_lag_buffer(buffer, max_lag)
      !> Allocated
      type(lag_buffer_type), intent(inout) :: buffer
      !> Largest lag
      integer, intent(in) :: max_lag

      allocate (buffer%value(1 - max_lag:block_length), buffer%here(1 - max_lag:block_length))
   end subroutine open_lag_buffer

   !> Adds the products of the samples of a block with themselves and their past.
   pure subroutine add_lag_block(x, shared, first, last, buffer, products, number, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The plan
      type(autocovariance_type), intent(in) :: shared
      !> 1-based first and last sample of the block, at most [[gyroakf_chunks:block_length]] of them
      integer(int64), intent(in) :: first, last
      !> Of [[open_lag_buffer]]
      type(lag_buffer_type), intent(inout) :: buffer
      !> Sums of products: [0:max_lag]
      real(dp), intent(inout), contiguous :: products(0:)
      !> Pairs: [0:max_lag]
      real(dp), intent(inout), contiguous :: number(0:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: no_phi(0)
      integer(int64) :: begin
      integer :: m, k

      begin = first - shared%max_lag
      m = int(last - first) + 1
      call residual_block(x, shared%mean, no_phi, shared%remainder, begin, buffer%value(:m), buffer%here(:m), valid)
      call add_lagged_products(buffer%value(1:), buffer%value, m, shared%max_lag, products)
      if (begin >= 1 .and. .not. present(valid)) then
         number = number + real(m, dp)
      else if (.not. present(valid)) then
         do k = 0, shared%max_lag
            number(k) = number(k) + real(max(0_int64, last - max(first, int(k, int64) + 1) + 1), dp)
         end do
      else
         call add_lagged_products(buffer%here(1:), buffer%here, m, shared%max_lag, number)
      end if
   end subroutine add_lag_block

   !> Autocovariances from the sums.
   subroutine close_autocovariance(shared, n, products, number)
      !> Filled
      type(autocovariance_type), intent(inout) :: shared
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Sums of products and pairs: [0:max_lag]
      real(dp), intent(in) :: products(0:), number(0:)
      integer :: k

      shared%samples = n
      allocate (shared%r(0:shared%max_lag), shared%pairs(0:shared%max_lag))
      do k = 0, shared%max_lag
         shared%r(k) = products(k)
         if (number(k) > 0.0_dp) shared%r(k) = products(k)*((real(n, dp) - real(k, dp))/number(k))/real(n, dp)
         shared%pairs(k) = nint(number(k), int64)
      end do
   end subroutine close_autocovariance

end module gyroakf_stats_shared_autocovariance
