! SPDX-License-Identifier: MIT
!> Tests of the averaging factors.
module test_allan_grid
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_allan_grid, only : averaging_factors
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_allan_grid

contains

   subroutine suite_allan_grid()
      call test("octave", test_octave)
      call test("decade", test_decade)
      call test("logarithmic", test_logarithmic)
      call test("all", test_all)
      call test("seconds", test_seconds)
      call test("huge_record", test_huge_record)
      call test("failures", test_failures)
   end subroutine suite_allan_grid

   !> Fails unless the factors are the expected ones.
   subroutine expect(taus, samples, interval, expected)
      !> What is asked
      character(*), intent(in) :: taus
      integer, intent(in) :: samples
      real(dp), intent(in) :: interval
      !> The answer
      integer, intent(in) :: expected(:)

      integer(int64), allocatable :: m(:)

      call averaging_factors(taus, int(samples, int64), interval, m, failure)
      if (went_wrong(failure, taus//" failed")) return
      if (unmet(size(m), size(expected), taus//": number of factors")) return
      call check(error, all(m == expected), taus//": a factor differs")
   end subroutine expect

   subroutine test_octave()
      call expect("octave", 2, 1.0_dp, [1])
      call expect("octave", 15, 1.0_dp, [1, 2, 4])
      call expect("octave", 16, 1.0_dp, [1, 2, 4, 8])
   end subroutine test_octave

   subroutine test_decade()
      call expect("decade", 199, 1.0_dp, [1, 2, 5, 10, 20, 50])
      call expect("decade", 200, 1.0_dp, [1, 2, 5, 10, 20, 50, 100])
   end subroutine test_decade

   subroutine test_logarithmic()
      call expect("log:1", 2000, 1.0_dp, [1, 10, 100, 1000])
      call expect("log:5", 100, 1.0_dp, [1, 2, 3, 4, 6, 10, 16, 25, 40])
   end subroutine test_logarithmic

   subroutine test_all()
      call expect("all", 9, 1.0_dp, [1, 2, 3, 4])
   end subroutine test_all

   subroutine test_seconds()
      call expect("1,0.1, 10,1,0.14,1e3", 1000, 0.1_dp, [1, 10, 100])
      call expect("0.2", 4, 0.1_dp, [2])
   end subroutine test_seconds

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

end module test_allan_grid
