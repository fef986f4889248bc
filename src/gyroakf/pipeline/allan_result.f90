! SPDX-License-Identifier: MIT
!> Allan curves of a channel and what is stated of them: noise coefficients in the units of the
!> report and in SI.
module gyroakf_pipeline_allan_result
   use gyroakf_kinds, only : dp
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_noise_fit, only : coefficient_type, noise_type
   use gyroakf_allan_read_off, only : read_off_type
   implicit none (type, external)
   private
   public :: allan_result_type, stated_noise_type, stated_coefficient_type, stated_read_off_type
   public :: stage, stage_names, not_described

   !> What is said of a curve that the noise terms do not follow
   character(*), parameter :: not_described = "no run of octaves follows a sum of Q, N, B, K "// &
      "and R: the coefficients are "//"withheld. The values read off the curve hold where it "// &
      "has their slope"

   !> The series that an Allan curve is computed of, in the order of `channel%allan`
   type :: stage_enum
      !> The record as read, with its outliers
      integer :: input = 1
      !> The record as read without its outliers, where there are some
      integer :: outliers_removed = 2
      !> Without outliers and trend; as read where neither was removed
      integer :: cleaned = 3
      !> Output of the Kalman filter of the paper
      integer :: kf = 4
      !> Output of the adaptive filter of the paper
      integer :: akf = 5
      !> The record as read less its smoothed drift
      integer :: compensated = 6
   end type stage_enum

   !> Reached as `stage%cleaned`
   type(stage_enum), parameter :: stage = stage_enum()

   !> Names of the stages, as in the JSON document
   character(16), parameter :: stage_names(6) = [character(16) :: "input", "outliers_removed", &
      "cleaned", "kf", "akf", "compensated"]

   !> One noise coefficient in the unit it is stated in
   type, extends(coefficient_type) :: stated_coefficient_type
      !> "deg/sqrt(h)"; "deg/s*sqrt(sample)" without a rate, "input*sqrt(s)" without a unit
      character(:), allocatable :: unit
      !> The same in SI; 0 and "" where rate or unit is not known
      real(dp) :: value_si = 0.0_dp, std_error_si = 0.0_dp, upper_limit_si = 0.0_dp
      !> "rad/sqrt(s)"
      character(:), allocatable :: unit_si
      !> What it is the coefficient of: "sigma^2 = N^2/tau, two-sided density N^2"
      character(:), allocatable :: definition
   end type stated_coefficient_type

   !> The five coefficients as they are stated
   type :: stated_noise_type
      !> Q N B K R
      type(stated_coefficient_type) :: term(5)
      !> N without quantization, and the step of the samples in standard deviations of the noise
      type(stated_coefficient_type) :: unquantized
      real(dp) :: lsb_ratio = 0.0_dp
      !> The unit and the rate are known: `density` means something
      logical :: in_units = .false.
      !> N as a density with its error and limit, also in SI: two-sided, one-sided
      type(stated_coefficient_type) :: density(2)
   end type stated_noise_type

   !> What the curve alone says by the classical rules, in the units of the coefficients; the lowest
   !> deviation in that of B, its averaging time in s (samples without a rate)
   type, extends(read_off_type) :: stated_read_off_type
      !> There is a lowest deviation
      logical :: known = .false.
   end type stated_read_off_type

   !> Curve and coefficients of one series
   type :: allan_result_type
      !> The curve is there
      logical :: available = .false.
      !> The coefficients are there
      logical :: fitted = .false.
      type(allan_curve_type) :: curve
      !> Further kinds, as far as they could be computed; unallocated where none was asked for
      type(allan_curve_type), allocatable :: other(:)
      type(noise_type) :: noise
      type(stated_noise_type) :: stated
      !> What is read off the curve, in the unit of the input and s, and the same in the units of
      !> the coefficients
      type(read_off_type) :: read
      type(stated_read_off_type) :: read_off
   end type allan_result_type

end module gyroakf_pipeline_allan_result
