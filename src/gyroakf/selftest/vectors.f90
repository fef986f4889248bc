! SPDX-License-Identifier: MIT
!> Published test vectors of the Allan family.
!>
!> NBS14: W. J. Riley and D. A. Howe, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008), section 12.4, nine rates and a
!> thousand. PHASE.DAT: what Stable32 1.60 says of the phases of the same thousand rates, with limits at 68.3 %. The values of more
!> averaging times were computed from the thousand rates in rational arithmetic.
module gyroakf_selftest_vectors
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan, compute_allan_from_phase
   use gyroakf_selftest_series, only : nbs_short, nbs_long, phase_of
   use gyroakf_selftest_types, only : selftest_type, begin_group, add_check, add_worst, add_failure
   implicit none (type, external)
   private
   public :: check_vectors

   character(6), parameter :: kinds(7) = [character(6) :: "adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
   !> Values that were computed with more digits than a double has: rounding of a thousand additions
   real(dp), parameter :: exact = 1.0e-12_dp
   !> Five printed digits; limits that Stable32 computes to 6e-4
   real(dp), parameter :: printed = 5.0e-5_dp, limits = 1.0e-3_dp

contains

   !> All vectors.
   subroutine check_vectors(result)
      !> The checks are added
      type(selftest_type), intent(inout) :: result

      call begin_group(result, "NBS14, 9 rates")
      call check_short(result)
      call begin_group(result, "NBS14, 1000 rates")
      call check_long(result)
      call check_factors(result)
      call begin_group(result, "PHASE.DAT of Stable32")
      call check_phase(result)
   end subroutine check_vectors

   !> The curve of a statistic; a check that failed where there is none.
   subroutine curve_of(result, kind, rate, taus, curve, there)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: kind, taus
      real(dp), intent(in), contiguous :: rate(:)
      type(allan_curve_type), intent(out) :: curve
      logical, intent(out) :: there
      type(allan_options) :: options
      type(error_type), allocatable :: error

      options%kind = kind
      options%taus = taus
      call compute_allan(rate, 1.0_dp, options, curve, error)
      there = .not. allocated(error)
      if (allocated(error)) call add_failure(result, trim(kind), error)
   end subroutine curve_of

   !> Nine rates: the printed digits, half a unit of the last one.
   subroutine check_short(result)
      type(selftest_type), intent(inout) :: result
      ! hdev at 1 s is printed as 70.80608; in rational arithmetic it is 70.806073, as ohdev at 1 s is printed
      real(dp), parameter :: published(2, 7) = reshape([91.22945_dp, 115.8082_dp, 91.22945_dp, 85.95287_dp, 91.22945_dp, &
         & 74.78849_dp, 52.67135_dp, 86.35831_dp, 70.80607_dp, 116.7980_dp, 70.80607_dp, 85.61487_dp, 91.22945_dp, 93.90379_dp], &
         & [2, 7])
      type(allan_curve_type) :: curve
      character(40) :: name
      integer :: kind, i
      logical :: there

      do kind = 1, size(kinds)
         call curve_of(result, kinds(kind), nbs_short, "1,2", curve, there)
         if (.not. there) cycle
         do i = 1, min(2, size(curve%deviation))
            write (name, '(a, ", ", i0, " s")') trim(kinds(kind)), i
            call add_check(result, trim(name), published(i, kind), curve%deviation(i), &
                           merge(5.0e-5_dp, 5.0e-6_dp, published(i, kind) > 100.0_dp))
         end do
      end do
   end subroutine check_short

   !> A thousand rates: the printed digits, half a unit of the last one.
   subroutine check_long(result)
      type(selftest_type), intent(inout) :: result
      ! hdev at 100 s is printed as 3.910860e-02; in rational arithmetic it is 3.91086056e-02
      real(dp), parameter :: published(3, 7) = reshape([ &
         & 2.922319e-1_dp, 9.965736e-2_dp, 3.897804e-2_dp, 2.922319e-1_dp, 9.159953e-2_dp, 3.241343e-2_dp, &
         & 2.922319e-1_dp, 6.172376e-2_dp, 2.170921e-2_dp, 1.687202e-1_dp, 3.563623e-1_dp, 1.253382e+0_dp, &
         & 2.943883e-1_dp, 1.052754e-1_dp, 3.910861e-2_dp, 2.943883e-1_dp, 9.581083e-2_dp, 3.237638e-2_dp, &
         & 2.922319e-1_dp, 9.134743e-2_dp, 3.406530e-2_dp], [3, 7])
      integer, parameter :: seconds(3) = [1, 10, 100]
      type(allan_curve_type) :: curve
      real(dp) :: rate(1000), half
      character(40) :: name
      integer :: kind, i
      logical :: there

      call nbs_long(rate)
      do kind = 1, size(kinds)
         call curve_of(result, kinds(kind), rate, "1,10,100", curve, there)
         if (.not. there) cycle
         do i = 1, min(3, size(curve%deviation))
            write (name, '(a, ", ", i0, " s")') trim(kinds(kind)), seconds(i)
            half = 0.5e-6_dp*10.0_dp**floor(log10(published(i, kind)))
            call add_check(result, trim(name), published(i, kind), curve%deviation(i), half)
         end do
      end do
   end subroutine check_long

   !> The same, more averaging times, to rounding.
   subroutine check_factors(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: expected(12) = [0.2010160421709385_dp, 0.1447913072184378_dp, 0.1057038500787000_dp, &
         & 0.06191477841874487_dp, 0.04808214262128163_dp, 0.03623721298570472_dp, 0.03241343026056984_dp, 0.02767385582069448_dp, &
         & 0.01028221763903273_dp, 0.008244123626136666_dp, 0.002832505364418703_dp, 0.002158165703661819_dp]
      type(allan_curve_type) :: curve
      real(dp) :: rate(1000)
      logical :: there

      call nbs_long(rate)
      call curve_of(result, "oadev", rate, "2,4,8,16,32,64,100,128,256,333,499,500", curve, there)
      if (there) call add_worst(result, "oadev, 2 .. 500 s, worst", expected, curve%deviation, exact)
   end subroutine check_factors

   !> Deviations and limits at 2, 4, 8 .. s: of each, the worst.
   subroutine check_phase(result)
      type(selftest_type), intent(inout) :: result

      call compare(result, "adev", "2,4,8,16,32,64,128", reshape([ &
         & 0.19787_dp, 0.20510_dp, 0.21319_dp, 0.14201_dp, 0.14943_dp, 0.15815_dp, 0.10254_dp, 0.11013_dp, 0.11971_dp, &
         & 0.056510_dp, 0.062381_dp, 0.070567_dp, 0.049153_dp, 0.056233_dp, 0.067635_dp, 0.027109_dp, 0.032550_dp, &
         & 0.043537_dp, 0.026481_dp, 0.033855_dp, 0.055744_dp], [3, 7]))
      call compare(result, "oadev", "2,4,8,16,32,64,128", reshape([ &
         & 0.19520_dp, 0.20102_dp, 0.20738_dp, 0.13931_dp, 0.14479_dp, 0.15098_dp, 0.10038_dp, 0.10570_dp, 0.11198_dp, &
         & 0.057696_dp, 0.061915_dp, 0.067217_dp, 0.043654_dp, 0.048082_dp, 0.054202_dp, 0.031755_dp, 0.036237_dp, &
         & 0.043377_dp, 0.023045_dp, 0.027674_dp, 0.037027_dp], [3, 7]))
      call compare(result, "mdev", "2,4,8,16,32,64,128", reshape([ &
         & 0.15336_dp, 0.15821_dp, 0.16355_dp, 0.10322_dp, 0.10780_dp, 0.11304_dp, 0.069840_dp, 0.074192_dp, 0.079481_dp, &
         & 0.038022_dp, 0.041376_dp, 0.045809_dp, 0.030466_dp, 0.034255_dp, 0.039933_dp, 0.023687_dp, 0.027871_dp, &
         & 0.035511_dp, 0.014874_dp, 0.018669_dp, 0.028584_dp], [3, 7]))
      call compare(result, "hdev", "2,4,8,16,32,64,128", reshape([ &
         & 0.19887_dp, 0.20716_dp, 0.21659_dp, 0.14054_dp, 0.14890_dp, 0.15896_dp, 0.10744_dp, 0.11649_dp, 0.12829_dp, &
         & 0.053296_dp, 0.059589_dp, 0.068811_dp, 0.046987_dp, 0.054697_dp, 0.068092_dp, 0.024870_dp, 0.030569_dp, &
         & 0.043652_dp, 0.028841_dp, 0.038060_dp, 0.073807_dp], [3, 7]))
      call compare(result, "ohdev", "2,4,8,16,32,64,128", reshape([ &
         & 0.19491_dp, 0.20125_dp, 0.20825_dp, 0.13777_dp, 0.14368_dp, 0.15043_dp, 0.10388_dp, 0.10987_dp, 0.11704_dp, &
         & 0.056173_dp, 0.060638_dp, 0.066369_dp, 0.040664_dp, 0.045095_dp, 0.051382_dp, 0.029271_dp, 0.033824_dp, &
         & 0.041477_dp, 0.023761_dp, 0.029147_dp, 0.041367_dp], [3, 7]))
      call compare(result, "totdev", "2,4,8,16,32,64,128,256", reshape([ &
         & 0.19592_dp, 0.20089_dp, 0.20625_dp, 0.13947_dp, 0.14444_dp, 0.14998_dp, 0.10039_dp, 0.10540_dp, 0.11126_dp, &
         & 0.057732_dp, 0.061788_dp, 0.066839_dp, 0.044255_dp, 0.048580_dp, 0.054484_dp, 0.031639_dp, 0.035905_dp, &
         & 0.042546_dp, 0.026406_dp, 0.031259_dp, 0.040383_dp, 0.010734_dp, 0.013369_dp, 0.019924_dp], [3, 8]))
   end subroutine check_phase

   !> One statistic of the phases against rows of lower limit, deviation, upper limit.
   subroutine compare(result, kind, taus, rows)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: kind, taus
      !> [3, averaging times]
      real(dp), intent(in) :: rows(:, :)
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(error_type), allocatable :: error
      real(dp) :: rate(1000), phase(1001)

      call nbs_long(rate)
      call phase_of(rate, phase)
      options%kind = kind
      options%taus = taus
      call compute_allan_from_phase(phase, 1.0_dp, options, curve, error)
      if (allocated(error)) then
         call add_failure(result, kind, error)
         return
      end if
      call add_worst(result, kind//", lower limits", rows(1, :), curve%lower, limits)
      call add_worst(result, kind//", deviations", rows(2, :), curve%deviation, printed)
      call add_worst(result, kind//", upper limits", rows(3, :), curve%upper, limits)
   end subroutine compare

end module gyroakf_selftest_vectors
