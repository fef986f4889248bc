! SPDX-License-Identifier: MIT
!> How near every filter of a channel comes to its true drift, where that is known.
module gyroakf_pipeline_truth_result
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_score, only : score_type
   implicit none (type, external)
   private
   public :: truth_result_type, method_score_type, most_methods, score_of

   !> Most methods that are compared
   integer, parameter :: most_methods = 16

   !> The score of one method
   type :: method_score_type
      !> "none", "trend", "kf", "akf", "drift_kf", ...: as in the JSON document
      character(20) :: name = ""
      !> It uses samples after the one it estimates
      logical :: offline = .false.
      !> phi by which its estimate was carried on from sample to sample
      real(dp) :: decay = 1.0_dp
      type(score_type) :: score
   end type method_score_type

   !> The scores of a channel, and what they are made with
   type :: truth_result_type
      !> The true drift was given
      logical :: known = .false.
      !> The trend and this mean were taken off
      logical :: reduced = .false.
      real(dp) :: mean = 0.0_dp
      !> Methods in the order in which they ran: the first `count`
      integer :: count = 0
      type(method_score_type) :: method(most_methods)
      !> Unit of the errors of the angle: "deg" of a gyroscope, "m/s" of an accelerometer, else "input*s" or "input*sample"
      character(12) :: angle_unit = "input*sample"
      !> What the unit of the record times its time is in it
      real(dp) :: angle_factor = 1.0_dp
      !> Samples of the moving averages; 0: there are none
      integer(int64) :: average_samples = 0
      !> The true drift less what was removed before the filters (trend, mean), in the unit of the record: [n]; gone after the work
      real(dp), allocatable :: drift(:)
      !> 1 where it is known; unallocated: everywhere
      integer(int8), allocatable :: present(:)
   end type truth_result_type

contains

   !> Number of a method, 0 where it was not scored.
   pure integer function score_of(truth, name) result(i)
      !> The scores
      type(truth_result_type), intent(in) :: truth
      !> As in the JSON document
      character(*), intent(in) :: name

      do i = truth%count, 1, -1
         if (truth%method(i)%name == name) return
      end do
      i = 0
   end function score_of

end module gyroakf_pipeline_truth_result
