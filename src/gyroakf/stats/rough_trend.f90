! SPDX-License-Identifier: MIT
!> A polynomial near the trend of a series, without a pass over it.
!>
!> A regression that has the powers of the time among its columns does not feel what polynomial is taken off before, but its
!> sums of products lose the digits of whatever is left of the trend. Some thousand samples tell enough of it.
module gyroakf_stats_rough_trend
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_trend, only : trend_type, fit_trend
   implicit none (type, external)
   private
   public :: rough_trend

   !> Samples that are looked at, and from how many on it is fewer than all
   integer(int64), parameter :: looked_at = 4096, all_up_to = 8192

contains

   !> Least-squares polynomial of every m-th sample: of all of them up to 8192, else of about 4096; of all where those are missing.
   subroutine rough_trend(x, degree, trend, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Degree, -1 .. 9; -1 gives the trend 0
      integer, intent(in) :: degree
      !> The polynomial; its coefficients of powers are not set where not all samples were looked at
      type(trend_type), intent(out) :: trend
      !> As of [[fit_trend]]
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: some(:)
      integer(int8), allocatable :: here(:)
      integer(int64) :: n, stride, count, i
      integer :: stat

      n = size(x, kind=int64)
      if (n > all_up_to .and. degree >= 0) then
         stride = n/looked_at
         count = (n - 1)/stride + 1
         allocate (some(count), stat=stat)
         if (stat == 0) allocate (here(count), stat=stat)
         if (stat /= 0) then
            call fatal_error(error, status%no_memory, "no memory for a part of a series")
            return
         end if
         do i = 1, count
            some(i) = x((i - 1)*stride + 1)
            here(i) = 1_int8
            if (present(valid)) here(i) = valid((i - 1)*stride + 1)
         end do
         call fit_trend(some, degree, trend, error, here)
         if (.not. allocated(error)) then
            trend%samples = (count - 1)*stride + 1
            trend%power(:) = 0.0_dp
            return
         end if
         deallocate (error)
      end if
      call fit_trend(x, degree, trend, error, valid)
   end subroutine rough_trend

end module gyroakf_stats_rough_trend
