! SPDX-License-Identifier: MIT
!> Tests of the averaging factors, and of the equivalent degrees of freedom: these were computed for
!> 1001 phases by an independent implementation of Greenhall & Riley (2003).
module test_allan_grid
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_allan_grid, only : averaging_factors
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong, &
      & check_refused
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits, greenhall_edf
   implicit none (type, external)
   private
   public :: suite_allan_grid, suite_allan_freedom

   !> Phases
   integer(int64), parameter :: phases = 1001
   !> Seven printed digits
   real(dp), parameter :: printed = 1.0e-6_dp

contains

   subroutine suite_allan_grid()
      call test("factors", test_factors)
      call test("huge_record", test_huge_record)
      call test("failures", test_failures)
   end subroutine suite_allan_grid

   subroutine suite_allan_freedom()
      call test("overlapping", test_overlapping)
      call test("other_statistics", test_other_statistics)
      call test("white_phase_short", test_white_phase_short)
      call test("branches_meet", test_branches_meet)
      call test("range", test_range)
      call test("limits", test_limits)
   end subroutine suite_allan_freedom

   !> Fails unless the factors are the expected ones.
   subroutine expect(taus, samples, interval, expected)
      character(*), intent(in) :: taus
      integer, intent(in) :: samples
      real(dp), intent(in) :: interval
      integer, intent(in) :: expected(:)
      integer(int64), allocatable :: m(:)

      call averaging_factors(taus, int(samples, int64), interval, m, failure)
      if (went_wrong(failure, taus//" failed")) return
      if (unmet(size(m), size(expected), taus//": number of factors")) return
      call check(error, all(m == expected), taus//": a factor differs")
   end subroutine expect

   subroutine test_factors()
      call expect("octave", 2, 1.0_dp, [1])
      call expect("octave", 15, 1.0_dp, [1, 2, 4])
      call expect("octave", 16, 1.0_dp, [1, 2, 4, 8])
      call expect("decade", 199, 1.0_dp, [1, 2, 5, 10, 20, 50])
      call expect("decade", 200, 1.0_dp, [1, 2, 5, 10, 20, 50, 100])
      call expect("log:1", 2000, 1.0_dp, [1, 10, 100, 1000])
      call expect("log:5", 100, 1.0_dp, [1, 2, 3, 4, 6, 10, 16, 25, 40])
      call expect("all", 9, 1.0_dp, [1, 2, 3, 4])
      call expect("1,0.1, 10,1,0.14,1e3", 1000, 0.1_dp, [1, 10, 100])
      call expect("0.2", 4, 0.1_dp, [2])
   end subroutine test_factors

   subroutine test_huge_record()
      integer(int64), allocatable :: m(:)

      call averaging_factors("octave", huge(0_int64), 1.0_dp, m, failure)
      if (unmet(size(m), 62)) return
      call averaging_factors("decade", huge(0_int64), 1.0_dp, m, failure)
      if (unmet(m(size(m)) == 2_int64*10_int64**18)) return
      call averaging_factors("log:10", huge(0_int64), 1.0_dp, m, failure)
      call check(error, all(m(2:) > m(:size(m) - 1)))
   end subroutine test_huge_record

   subroutine test_failures()
      character(*), parameter :: bad(*) = [character(8) :: "octaves", "log:", "log:0", "log:-3", "log:1001", "1,,2", "1;2", &
         & "", "1,nan", "0.01", "-1", "1e999", "1-2", "1e", ".", "+", "2e+-3"]
      integer(int64), allocatable :: m(:)
      integer :: i

      do i = 1, size(bad)
         call averaging_factors(trim(bad(i)), 100_int64, 0.1_dp, m, failure)
         call check_refused(failure, status%invalid_argument)
      end do
      call averaging_factors("octave", 1_int64, 0.1_dp, m, failure)
      call check(error, failure%code, status%too_few_samples)
      call averaging_factors("100,200", 100_int64, 0.1_dp, m, failure)
      call check(error, failure%code, status%too_few_samples)
   end subroutine test_failures

   !> Fails unless the degrees of freedom agree.
   subroutine expect_freedom(m, alpha, difference, modified, overlapped, expected)
      integer, intent(in) :: m, alpha, difference
      logical, intent(in) :: modified, overlapped
      real(dp), intent(in) :: expected
      real(dp) :: edf
      character(80) :: text

      edf = greenhall_edf(phases, int(m, int64), alpha, difference, modified, overlapped)
      write (text, '("m ", i0, " alpha ", i0, ": ", f0.5, " is not ", f0.5)') m, alpha, edf, expected
      call check(error, abs(edf - expected) <= max(printed*expected, 5.0e-5_dp), trim(text))
   end subroutine expect_freedom

   subroutine test_overlapping()
      integer, parameter :: m(3) = [1, 10, 100], alpha(4) = [0, -1, -2, 2]
      real(dp), parameter :: expected(3, 4) = reshape([782.0303_dp, 135.0714_dp, 12.8149_dp, 895.2474_dp, 114.6687_dp, &
         & 9.9480_dp, 762.2905_dp, 91.0384_dp, 7.7537_dp, 514.0361_dp, 507.1731_dp, 440.2065_dp], [3, 4])
      integer :: i, j

      do j = 1, 4
         do i = 1, 3
            call expect_freedom(m(i), alpha(j), 2, .false., .true., expected(i, j))
         end do
      end do
   end subroutine test_overlapping

   subroutine test_other_statistics()
      integer, parameter :: m(3) = [1, 10, 100]
      real(dp), parameter :: modified(3) = [782.0303_dp, 94.6343_dp, 7.4165_dp]
      real(dp), parameter :: hadamard(3) = [608.5487_dp, 113.6989_dp, 9.9228_dp]
      real(dp), parameter :: plain(3) = [782.0303_dp, 66.9876_dp, 6.2308_dp]
      integer :: i

      do i = 1, 3
         call expect_freedom(m(i), 0, 2, .true., .true., modified(i))
         call expect_freedom(m(i), 0, 3, .false., .true., hadamard(i))
         call expect_freedom(m(i), 0, 2, .false., .false., plain(i))
      end do
   end subroutine test_other_statistics

   subroutine test_white_phase_short()
      ! m = 500 has one estimate, which has one degree of freedom; two estimates of m = 499.5 would be all but equal
      call expect_freedom(500, 2, 2, .false., .true., 1.0_dp)
      ! m = 400: 201 estimates, r about one half: independent phases, so 201
      call expect_freedom(400, 2, 2, .false., .true., 201.0_dp)
      ! m = 300: 401 estimates, those m apart share a phase: a correlation of -4/6, whose square counts
      call expect_freedom(300, 2, 2, .false., .true., 401/(1 + 2*(1 - 300/401.0_dp)*(4/6.0_dp)**2))
   end subroutine test_white_phase_short

   subroutine test_branches_meet()
      ! the direct sum up to m = 33, the table beyond; the sum takes a phase as a mean over one interval, which costs
      ! 3 % of the degrees of freedom at m = 33
      integer :: alpha
      real(dp) :: product(2)

      do alpha = -2, 0
         product(1) = 33*greenhall_edf(100001_int64, 33_int64, alpha, 2, .false., .true.)
         product(2) = 34*greenhall_edf(100001_int64, 34_int64, alpha, 2, .false., .true.)
         call check(error, product(2), product(1), thr=0.035_dp, rel=.true.)
      end do
   end subroutine test_branches_meet

   subroutine test_range()
      integer :: alpha
      integer(int64) :: m
      real(dp) :: edf

      call check(error, greenhall_edf(10_int64, 5_int64, 0, 2, .false., .true.), 0.0_dp, "too short")
      do alpha = -3, 3
         m = 1
         do while (2*m <= phases - 1)
            edf = greenhall_edf(phases, m, alpha, 2, .false., .true.)
            call check(error, edf > 0.9_dp .and. edf <= real(phases - 2*m, dp)*1.001_dp, "between one and the terms")
            m = 2*m
         end do
      end do
   end subroutine test_range

   subroutine test_limits()
      real(dp) :: lower(3), upper(3)

      ! chi-square with 10 degrees of freedom: quantiles 3.247 and 20.48 (2.5 %, 97.5 %), from any table
      call chi_square_limits(2.0_dp, 10.0_dp, 0.95_dp, lower(1), upper(1))
      call check(error, lower(1), 2*sqrt(10/20.483177350807385_dp), thr=1.0e-10_dp, rel=.true.)
      call check(error, upper(1), 2*sqrt(10/3.2469727802368405_dp), thr=1.0e-10_dp, rel=.true.)
      ! the seam at a million degrees of freedom
      call chi_square_limits(1.0_dp, [0.999999e6_dp, 1.000001e6_dp, 1.0e12_dp], 0.95_dp, lower, upper)
      call check(error, 1 - lower(2), 1 - lower(1), thr=1.0e-4_dp, rel=.true.)
      call check(error, upper(3) - lower(3), 2*1.959963984540054_dp/sqrt(2.0e12_dp), thr=1.0e-6_dp, rel=.true.)
   end subroutine test_limits

end module test_allan_grid
