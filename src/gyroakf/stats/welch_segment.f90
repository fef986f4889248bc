! SPDX-License-Identifier: MIT
!> Windows, and the periodograms of the segments of a series.
module gyroakf_stats_welch_segment
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_fft_real, only : real_fft_plan_type, real_fft_forward
   use gyroakf_stats_moments, only : first_present
   implicit none (type, external)
   private
   public :: segment_type, make_window, add_segments

   !> What a segment is
   type :: segment_type
      !> Samples of a segment, and from one to the next
      integer(int64) :: length = 0, step = 0
      !> Its mean is subtracted
      logical :: detrend = .true.
      !> Least share that must be present
      real(dp) :: min_coverage = 0.5_dp
      !> [0:length-1]
      real(dp), allocatable :: window(:)
   end type segment_type

   !> Samples of a window less one between two reports of progress: a power of two less one
   integer(int64), parameter :: report_mask = 1048575_int64

contains

   !> A window for spectra, in its periodic form: the next value would be the first again.
   subroutine make_window(name, window, error, progress)
      !> hann, hamming, blackman; any other is rectangular
      character(*), intent(in) :: name
      !> Values: [0:L-1]
      real(dp), intent(out) :: window(0:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), parameter :: turn = 6.28318530717958647693_dp
      real(dp) :: c
      integer(int64) :: t, n

      n = size(window, kind=int64)
      do t = 0, n - 1
         if (iand(t + 1, report_mask) == 0) call report_progress("spectrum", 0_int64, 0_int64, &
            & error, progress)
         if (allocated(error)) return
         c = cos(turn*(real(t, dp)/real(n, dp)))
         select case (name)
         case ("hann"); window(t) = 0.5_dp - 0.5_dp*c
         case ("hamming"); window(t) = 0.54_dp - 0.46_dp*c
         case ("blackman"); window(t) = 0.42_dp - 0.5_dp*c + 0.08_dp*(2.0_dp*c*c - 1.0_dp)
         case default; window(t) = 1.0_dp
         end select
      end do
   end subroutine make_window

   !> Adds the periodograms of segments over the sum of the squares of the window.
   subroutine add_segments(x, part, plan, from, to, total, share, error, valid, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> What a segment is
      type(segment_type), intent(in) :: part
      !> Of its length
      type(real_fft_plan_type), intent(in) :: plan
      !> Number of the first and of the last segment, from 1 on
      integer(int64), intent(in) :: from, to
      !> Sum of the periodograms: [0:length/2]
      real(dp), intent(inout), contiguous :: total(0:)
      !> Weight of each, 0 where too much is missing: [to - from + 1]
      real(dp), intent(out) :: share(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: segment(:)
      complex(dp), allocatable :: spectrum(:)
      real(dp) :: energy, factor
      integer(int64) :: i, first, last, k
      integer :: stat

      share = 0.0_dp
      allocate (segment(0:part%length - 1), stat=stat)
      if (stat == 0) allocate (spectrum(0:part%length/2), stat=stat)
      call check_memory(stat, "a segment of the spectrum", error)
      if (allocated(error)) return
      energy = sum(part%window**2)
      do i = from, to
         first = (i - 1)*part%step + 1
         call report_progress("spectrum", i - 1, 0_int64, error, progress)
         if (allocated(error)) return
         last = first + part%length - 1
         if (present(valid)) then
            call cut(x(first:last), part, energy, segment, share(i - from + 1), error, &
               & valid(first:last), progress)
         else
            call cut(x(first:last), part, energy, segment, share(i - from + 1), error, &
               & progress=progress)
         end if
         if (allocated(error)) return
         if (share(i - from + 1) <= 0.0_dp) cycle
         call real_fft_forward(plan, segment, spectrum, error, progress)
         if (.not. allocated(error)) call report_progress("spectrum", i, 0_int64, error, progress)
         if (allocated(error)) return
         factor = 1.0_dp/energy                     ! the share over the energy that is present
         do k = 0, part%length/2
            total(k) = total(k) + factor*(real(spectrum(k), dp)**2 + aimag(spectrum(k))**2)
         end do
      end do
   end subroutine add_segments

   !> A segment without its mean, times the window, 0 where missing; and the share of it that is
   !> present, 0 where that is too little. Its first sample is subtracted before the mean is formed:
   !> the mean of large values would be rounded to a unit in their last place.
   subroutine cut(x, part, energy, segment, share, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(segment_type), intent(in) :: part
      real(dp), intent(in) :: energy
      real(dp), intent(out), contiguous :: segment(0:)
      real(dp), intent(out) :: share
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: origin, mean
      integer(int64) :: t, begin, finish, here

      origin = 0.0_dp
      mean = 0.0_dp
      if (part%detrend) origin = first_present(x, valid)
      share = 0.0_dp
      here = 0
      do begin = 0, part%length - 1, report_mask + 1
         if (begin > 0) call report_progress("spectrum", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         finish = min(begin + report_mask, part%length - 1)
         segment(begin:finish) = x(begin + 1:finish + 1) - origin
         if (present(valid)) then
            where (valid(begin + 1:finish + 1) == 0_int8) segment(begin:finish) = 0.0_dp
            share = share + sum(part%window(begin:finish)**2, mask=valid(begin + 1:finish + 1) /= 0)
            here = here + count(valid(begin + 1:finish + 1) /= 0_int8, kind=int64)
         end if
         if (part%detrend) mean = mean + sum(segment(begin:finish))
      end do
      share = share/energy
      if (.not. present(valid)) share = 1.0_dp
      if (.not. present(valid)) here = part%length
      if (share < part%min_coverage) share = 0.0_dp
      if (share <= 0.0_dp) return
      mean = mean/real(here, dp)
      do begin = 0, part%length - 1, report_mask + 1
         if (begin > 0) call report_progress("spectrum", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         finish = min(begin + report_mask, part%length - 1)
         do t = begin, finish
            segment(t) = part%window(t)*(segment(t) - mean)
         end do
         if (.not. present(valid)) cycle
         where (valid(begin + 1:finish + 1) == 0_int8) segment(begin:finish) = 0.0_dp
      end do
   end subroutine cut

end module gyroakf_stats_welch_segment
