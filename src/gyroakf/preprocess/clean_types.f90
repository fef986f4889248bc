! SPDX-License-Identifier: MIT
!> Options and result of the cleaning.
module gyroakf_preprocess_clean_types
   use gyroakf_kinds, only : dp, int64
   use gyroakf_stats_trend, only : trend_type
   implicit none (type, external)
   private
   public :: clean_options, clean_type

   !> What is removed
   type :: clean_options
      !> Degree of the trend, -1 .. 9; -1 keeps it, outliers are then those about the mean or median
      integer :: degree = 3
      !> Outliers: none, auto, pauta, mad, hampel (see gyroakf_preprocess_outlier_rules)
      character(6) :: method = "auto"
      !> Threshold in standard deviations, > 0; 0: the method's own
      real(dp) :: threshold = 0.0_dp
      !> Most rounds, >= 1; 1: what is marked by a single pass over all samples
      integer :: max_passes = 20
      !> Of hampel: samples on either side that a sample is compared with, 1 .. 100,000
      integer :: half_width = 25
   end type clean_options

   !> What was removed, in the unit u of the series
   type :: clean_type
      !> Method used
      character(6) :: method = "none"
      !> Threshold used (in the last round), in standard deviations; 0 with none
      real(dp) :: threshold = 0.0_dp
      !> Rounds; the last one changed nothing where converged
      integer :: passes = 0
      !> Outliers marked
      integer(int64) :: removed = 0
      !> Outliers over the samples that were present before
      real(dp) :: fraction = 0.0_dp
      !> Their 1-based indices, ascending: [removed]
      integer(int64), allocatable :: outlier(:)
      !> The trend that was subtracted
      type(trend_type) :: trend
      !> Mean of the cleaned series, u
      real(dp) :: mean = 0.0_dp
      !> Its variance with divisor count - 1, u^2
      real(dp) :: variance = 0.0_dp
      !> .false.: the marks still changed in the last round
      logical :: converged = .true.
      !> Samples that the rule marks on average of white normal noise of this length
      real(dp) :: expected = 0.0_dp
      !> The variance of normal noise that the cleaned series was cut from, u^2: the variance over
      !> the share that cutting leaves of it (see gyroakf_preprocess_truncation); a statement,
      !> nothing uses it. 0 where it is not known (hampel)
      real(dp) :: corrected_variance = 0.0_dp
      !> Samples on either side, with hampel; else 0
      integer :: half_width = 0
      !> With auto: first and last sample of each stretch of motion, which is left: [2, stretches]
      integer(int64), allocatable :: motion(:, :)
   end type clean_type

end module gyroakf_preprocess_clean_types
