! SPDX-License-Identifier: MIT
!> The course of a filter for a picture: of every stretch of the series its lowest and highest normalised innovation, and the lowest
!> and highest R. A long series has as many stretches as a short one, and no peak of the innovations is lost.
module gyroakf_filter_trace
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: trace_type, start_trace, trace_innovations, trace_variance, most_stretches, variance_step

   !> Stretches of a long series
   integer(int64), parameter :: most_stretches = 1500
   !> R is looked at after so many samples at most; it changes within about 1/(1 - b), 50 samples or more
   integer(int64), parameter :: variance_step = 32

   !> One quantity: the samples, numbered from 1, where each stretch has its lowest and its highest value, 0 where it has none
   type :: extremes_type
      !> [2, stretches]
      integer(int64), allocatable :: at(:, :)
      real(dp), allocatable :: value(:, :)
   end type extremes_type

   !> What is kept
   type :: trace_type
      !> Samples of a stretch; 0: nothing was kept
      integer(int64) :: stretch = 0
      !> Innovations over their standard deviations
      type(extremes_type) :: innovation
      !> Variance R of the measurement noise, at the ends of stretches and every `variance_step` samples in between
      type(extremes_type) :: variance
   end type trace_type

contains

   !> Ready for a series of so many samples.
   pure subroutine start_trace(trace, samples, stat)
      !> Empty afterwards
      type(trace_type), intent(out) :: trace
      !> At least 1
      integer(int64), intent(in) :: samples
      !> Not 0: no memory
      integer, intent(out) :: stat
      integer(int64) :: stretches

      trace%stretch = (samples + most_stretches - 1)/most_stretches
      stretches = (samples + trace%stretch - 1)/trace%stretch
      call make_room(trace%innovation, stretches, stat)
      if (stat == 0) call make_room(trace%variance, stretches, stat)
   end subroutine start_trace

   !> So many stretches without a value.
   pure subroutine make_room(extremes, stretches, stat)
      type(extremes_type), intent(inout) :: extremes
      integer(int64), intent(in) :: stretches
      integer, intent(out) :: stat

      allocate (extremes%at(2, stretches), stat=stat)
      if (stat == 0) allocate (extremes%value(2, stretches), stat=stat)
      if (stat /= 0) return
      extremes%at = 0
      extremes%value = 0.0_dp
   end subroutine make_room

   !> Adds the next innovations.
   pure subroutine trace_innovations(trace, before, innovation, here)
      !> Started
      type(trace_type), intent(inout) :: trace
      !> Samples before these
      integer(int64), intent(in) :: before
      !> Over their standard deviations, [n]
      real(dp), intent(in), contiguous :: innovation(:)
      !> 1 where there is one, [n]
      integer(int8), intent(in), contiguous :: here(:)
      integer :: k

      do k = 1, size(innovation)
         if (here(k) /= 0_int8) call widen(trace%innovation, (before + k - 1)/trace%stretch + 1, before + k, innovation(k))
      end do
   end subroutine trace_innovations

   !> Adds R after a sample.
   pure subroutine trace_variance(trace, sample, r)
      !> Started
      type(trace_type), intent(inout) :: trace
      !> Its number from 1
      integer(int64), intent(in) :: sample
      !> R there
      real(dp), intent(in) :: r

      call widen(trace%variance, (sample - 1)/trace%stretch + 1, sample, r)
   end subroutine trace_variance

   !> Takes a value into the extremes of its stretch.
   pure subroutine widen(extremes, stretch, sample, value)
      type(extremes_type), intent(inout) :: extremes
      integer(int64), intent(in) :: stretch, sample
      real(dp), intent(in) :: value

      if (stretch > size(extremes%at, 2, kind=int64)) return
      if (extremes%at(1, stretch) == 0) then
         extremes%at(:, stretch) = sample
         extremes%value(:, stretch) = value
      else if (value < extremes%value(1, stretch)) then
         extremes%at(1, stretch) = sample
         extremes%value(1, stretch) = value
      else if (value > extremes%value(2, stretch)) then
         extremes%at(2, stretch) = sample
         extremes%value(2, stretch) = value
      end if
   end subroutine widen

end module gyroakf_filter_trace
