! SPDX-License-Identifier: MIT
!> Tests of the statistics of the Allan family.
!>
!> NBS14: NIST SP 1065, section 12.4 (printed to seven digits); the values with 16 digits were computed from
!> the same series in rational arithmetic. PHASE.DAT: results of Stable32 1.60 for the integral of the same series.
module test_allan_statistics
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : unmet, failure => problem, test, error, check, agree, went_wrong, check_refused
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan, compute_allan_from_phase
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_statistic, only : longest_factor, statistic_edf, statistic_names, term_count
   use allan_series, only : no_curve, nbs14_long, nbs14_short, normal_series
   implicit none (type, external)
   private
   public :: suite_allan_statistics

   !> Sixteen digits of reference, rounding of a thousand additions
   real(dp), parameter :: exact = 1.0e-12_dp

contains

   subroutine suite_allan_statistics()
      call test("nbs14_short", test_nbs14_short)
      call test("nbs14_long_printed", test_nbs14_printed)
      call test("nbs14_long_exact", test_nbs14_exact)
      call test("phase_dat", test_phase_dat)
      call test("known_freedom", test_known_freedom)
      call test("direct_sums", test_direct_sums)
      call test("long_chains", test_long_chains)
      call test("phase_input", test_phase_input)
      call test("few_phases", test_few_phases)
      call test("ramp", test_ramp)
      call test("sinusoid", test_sinusoid)
      call test("white_noise", test_white_noise)
      call test("random_run", test_random_run)
      call test("offset", test_offset)
      call test("threads", test_threads)
      call test("gaps_direct_sum", test_gaps_direct_sum)
      call test("gaps_white", test_gaps_white)
      call test("shortest", test_shortest)
      call test("unknown_kind", test_unknown_kind)
      call test("failures", test_failures)
   end subroutine suite_allan_statistics

   subroutine test_nbs14_short()
      ! tdev follows from mdev: tau/sqrt(3)
      real(dp), parameter :: expected(2, 7) = reshape([91.22944974074983_dp, 115.8082107048834_dp, 91.22944974074983_dp, &
         & 85.95286983768101_dp, 91.22944974074983_dp, 74.78849343314785_dp, 52.67134736584335_dp, 86.35831363182895_dp, &
         & 70.80607318585038_dp, 116.7979915637822_dp, 70.80607318585038_dp, 85.61487166374776_dp, &
         & 91.22944974074983_dp, 93.90379052519658_dp], [2, 7])
      character(*), parameter :: printed(2, 7) = reshape(["91.22945", "115.8082", "91.22945", "85.95287", "91.22945", &
         & "74.78849", "52.67135", "86.35831", "70.80607", "116.7980", "70.80607", "85.61487", "91.22945", "93.90379"], [2, 7])
      integer(int64), parameter :: terms(2, 7) = reshape([8, 3, 8, 6, 8, 5, 8, 5, 7, 2, 7, 4, 8, 8], [2, 7])
      type(allan_curve_type) :: curve
      character(8) :: text
      integer :: i, kind

      do kind = 1, size(statistic_names)
         if (no_curve(statistic_names(kind), nbs14_short(), "1,2", curve)) return
         call agree(curve%deviation, expected(:, kind), exact, &
            & statistic_names(kind))
         do i = 1, 2
            write (text, merge("(f8.4)", "(f8.5)", curve%deviation(i) >= 100)) curve%deviation(i)
            call check(error, text, printed(i, kind), statistic_names(kind))
         end do
         call check(error, all(curve%terms == terms(:, kind)) .and. curve%kind == statistic_names(kind), "terms and kind")
      end do
   end subroutine test_nbs14_short

   subroutine test_nbs14_printed()
      character(*), parameter :: printed(3, 7) = reshape([ &
         & "2.922319E-01", "9.965736E-02", "3.897804E-02", "2.922319E-01", "9.159953E-02", "3.241343E-02", &
         & "2.922319E-01", "6.172376E-02", "2.170921E-02", "1.687202E-01", "3.563623E-01", "1.253382E+00", &
         & "2.943883E-01", "1.052754E-01", "3.910861E-02", "2.943883E-01", "9.581083E-02", "3.237638E-02", &
         & "2.922319E-01", "9.134743E-02", "3.406530E-02"], [3, 7])
      type(allan_curve_type) :: curve
      character(12) :: text
      integer :: i, kind

      ! hdev at m = 100 is printed 3.910860E-02, in rational arithmetic it is 3.91086056E-02
      do kind = 1, size(statistic_names)
         if (no_curve(statistic_names(kind), nbs14_long(), "1,10,100", curve)) return
         do i = 1, 3
            write (text, "(es12.6)") curve%deviation(i)
            call check(error, text, printed(i, kind), statistic_names(kind))
         end do
      end do
   end subroutine test_nbs14_printed

   subroutine test_nbs14_exact()
      character(6), parameter :: kinds(6) = ["adev  ", "oadev ", "mdev  ", "hdev  ", "ohdev ", "totdev"]
      real(dp), parameter :: expected(3, 6) = reshape([ &
         & 0.2922318781067592_dp, 0.09965736063174786_dp, 0.03897804330802650_dp, &
         & 0.2922318781067592_dp, 0.09159953420118654_dp, 0.03241343026056984_dp, &
         & 0.2922318781067592_dp, 0.06172376382452217_dp, 0.02170920913694241_dp, &
         & 0.2943883291241320_dp, 0.1052754194012834_dp, 0.03910860559748536_dp, &
         & 0.2943883291241320_dp, 0.09581083173251592_dp, 0.03237638252760933_dp, &
         & 0.2922318781067592_dp, 0.09134743261700619_dp, 0.03406530252182642_dp], [3, 6])
      type(allan_curve_type) :: curve
      integer :: kind

      do kind = 1, size(kinds)
         if (no_curve(kinds(kind), nbs14_long(), "1,10,100", curve)) return
         call agree(curve%deviation, expected(:, kind), exact, kinds(kind))
      end do
   end subroutine test_nbs14_exact

   !> Compares with rows of terms, lower limit, deviation, upper limit (68.3 %, white noise); five printed digits, and limits
   !> that the program computes to 6e-4.
   subroutine compare_rows(kind, taus, rows)
      character(*), intent(in) :: kind, taus
      !> The printed table: [4, averaging times]
      real(dp), intent(in) :: rows(:, :)

      type(allan_curve_type) :: curve

      if (no_curve(kind, nbs14_long(), taus, curve)) return
      call check(error, all(curve%alpha == 0), "the noise is white")
      call agree(real(curve%terms, dp), rows(1, :), 0.0_dp, "terms")
      call agree(curve%deviation, rows(3, :), 5.0e-5_dp, "deviation")
      call agree(curve%lower, rows(2, :), 1.0e-3_dp, "lower limit")
      call agree(curve%upper, rows(4, :), 1.0e-3_dp, "upper limit")
   end subroutine compare_rows

   subroutine test_phase_dat()
      call compare_rows("adev", "2,4,8,16,32,64,128", reshape([ &
         & 499.0_dp, 0.19787_dp, 0.20510_dp, 0.21319_dp, 249.0_dp, 0.14201_dp, 0.14943_dp, 0.15815_dp, &
         & 124.0_dp, 0.10254_dp, 0.11013_dp, 0.11971_dp, 61.0_dp, 0.056510_dp, 0.062381_dp, 0.070567_dp, &
         & 30.0_dp, 0.049153_dp, 0.056233_dp, 0.067635_dp, 14.0_dp, 0.027109_dp, 0.032550_dp, 0.043537_dp, &
         & 6.0_dp, 0.026481_dp, 0.033855_dp, 0.055744_dp], [4, 7]))
      call compare_rows("oadev", "1,2,4,8,16,32,64,128", reshape([ &
         & 999.0_dp, 0.28515_dp, 0.29223_dp, 0.29987_dp, 997.0_dp, 0.19520_dp, 0.20102_dp, 0.20738_dp, &
         & 993.0_dp, 0.13931_dp, 0.14479_dp, 0.15098_dp, 985.0_dp, 0.10038_dp, 0.10570_dp, 0.11198_dp, &
         & 969.0_dp, 0.057696_dp, 0.061915_dp, 0.067217_dp, 937.0_dp, 0.043654_dp, 0.048082_dp, 0.054202_dp, &
         & 873.0_dp, 0.031755_dp, 0.036237_dp, 0.043377_dp, 745.0_dp, 0.023045_dp, 0.027674_dp, 0.037027_dp], [4, 8]))
      call compare_rows("mdev", "2,4,8,16,32,64,128", reshape([ &
         & 996.0_dp, 0.15336_dp, 0.15821_dp, 0.16355_dp, 990.0_dp, 0.10322_dp, 0.10780_dp, 0.11304_dp, &
         & 978.0_dp, 0.069840_dp, 0.074192_dp, 0.079481_dp, 954.0_dp, 0.038022_dp, 0.041376_dp, 0.045809_dp, &
         & 906.0_dp, 0.030466_dp, 0.034255_dp, 0.039933_dp, 810.0_dp, 0.023687_dp, 0.027871_dp, 0.035511_dp, &
         & 618.0_dp, 0.014874_dp, 0.018669_dp, 0.028584_dp], [4, 7]))
      call compare_rows("hdev", "2,4,8,16,32,64,128", reshape([ &
         & 498.0_dp, 0.19887_dp, 0.20716_dp, 0.21659_dp, 248.0_dp, 0.14054_dp, 0.14890_dp, 0.15896_dp, &
         & 123.0_dp, 0.10744_dp, 0.11649_dp, 0.12829_dp, 60.0_dp, 0.053296_dp, 0.059589_dp, 0.068811_dp, &
         & 29.0_dp, 0.046987_dp, 0.054697_dp, 0.068092_dp, 13.0_dp, 0.024870_dp, 0.030569_dp, 0.043652_dp, &
         & 5.0_dp, 0.028841_dp, 0.038060_dp, 0.073807_dp], [4, 7]))
      call compare_rows("ohdev", "1,2,4,8,16,32,64,128", reshape([ &
         & 998.0_dp, 0.28635_dp, 0.29439_dp, 0.30315_dp, 995.0_dp, 0.19491_dp, 0.20125_dp, 0.20825_dp, &
         & 989.0_dp, 0.13777_dp, 0.14368_dp, 0.15043_dp, 977.0_dp, 0.10388_dp, 0.10987_dp, 0.11704_dp, &
         & 953.0_dp, 0.056173_dp, 0.060638_dp, 0.066369_dp, 905.0_dp, 0.040664_dp, 0.045095_dp, 0.051382_dp, &
         & 809.0_dp, 0.029271_dp, 0.033824_dp, 0.041477_dp, 617.0_dp, 0.023761_dp, 0.029147_dp, 0.041367_dp], [4, 8]))
      call compare_rows("totdev", "1,2,4,8,16,32,64,128,256", reshape([ &
         & 999.0_dp, 0.28707_dp, 0.29223_dp, 0.29768_dp, 999.0_dp, 0.19592_dp, 0.20089_dp, 0.20625_dp, &
         & 999.0_dp, 0.13947_dp, 0.14444_dp, 0.14998_dp, 999.0_dp, 0.10039_dp, 0.10540_dp, 0.11126_dp, &
         & 999.0_dp, 0.057732_dp, 0.061788_dp, 0.066839_dp, 999.0_dp, 0.044255_dp, 0.048580_dp, 0.054484_dp, &
         & 999.0_dp, 0.031639_dp, 0.035905_dp, 0.042546_dp, 999.0_dp, 0.026406_dp, 0.031259_dp, 0.040383_dp, &
         & 999.0_dp, 0.010734_dp, 0.013369_dp, 0.019924_dp], [4, 9]))
   end subroutine test_phase_dat

   subroutine test_known_freedom()
      ! the algorithm of Greenhall & Riley 2003 worked out for 1001 phases; total variance: NIST SP 1065, section 5.4.1
      integer(int64), parameter :: n = 1001
      real(dp) :: found(8)

      found(1:3) = [statistic_edf("mdev", n, 1_int64, 0), statistic_edf("tdev", n, 10_int64, 0), &
         & statistic_edf("mdev", n, 100_int64, 0)]
      found(4:6) = [statistic_edf("ohdev", n, 10_int64, 0), statistic_edf("adev", n, 10_int64, 0), &
         & statistic_edf("adev", n, 100_int64, 0)]
      found(7:8) = [statistic_edf("totdev", n, 100_int64, -1), statistic_edf("totdev", n, 100_int64, -2)]
      call agree(found, [782.0303_dp, 94.6343_dp, 7.4165_dp, 113.6989_dp, 66.9876_dp, 6.2308_dp, 11.4917_dp, &
         & 8.9493_dp], 1.0e-5_dp, "edf")
   end subroutine test_known_freedom

   !> The definition of a variance, sum by sum, from the phase x(1:).
   pure real(dp) function definition(kind, x, m) result(deviation)
      character(*), intent(in) :: kind
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: m

      real(dp), allocatable :: y(:)
      real(dp) :: total, z
      integer :: n, k, i, terms, step

      n = size(x)
      allocate (y(2 - n:2*n - 1))                          ! continued by odd reflection
      y(1:n) = x
      do k = 1, n - 1
         y(1 - k) = 2*x(1) - x(1 + k)
         y(n + k) = 2*x(n) - x(n - k)
      end do
      step = merge(m, 1, kind == "adev" .or. kind == "hdev")
      total = 0
      terms = 0
      do k = merge(2, 1, kind == "totdev"), n - 1, step
         z = 0
         select case (kind)
         case ("totdev")
            z = y(k - m) - 2*y(k) + y(k + m)
         case ("mdev")
            if (k > n - 3*m + 1) exit
            do i = k, k + m - 1
               z = z + (x(i + 2*m) - 2*x(i + m) + x(i))/m
            end do
         case ("hdev", "ohdev")
            if (k > n - 3*m) exit
            z = (x(k + 3*m) - 3*x(k + 2*m) + 3*x(k + m) - x(k))/sqrt(3.0_dp)
         case default
            if (k > n - 2*m) exit
            z = x(k + 2*m) - 2*x(k + m) + x(k)
         end select
         total = total + z**2
         terms = terms + 1
      end do
      deviation = sqrt(total/(2.0_dp*real(m, dp)**2*terms))
   end function definition

   subroutine test_direct_sums()
      ! every averaging factor of short records, even and odd lengths; the definitions in full
      character(6), parameter :: kinds(6) = ["adev  ", "oadev ", "mdev  ", "hdev  ", "ohdev ", "totdev"]
      type(allan_curve_type) :: curve
      real(dp), allocatable :: rate(:), phase(:), expected(:)
      integer :: kind, n, i

      do n = 20, 31
         rate = normal_series(int(n, int64), 12345_int64)
         allocate (phase(n + 1))
         phase(1) = 0
         do i = 1, n
            phase(i + 1) = phase(i) + rate(i)
         end do
         do kind = 1, size(kinds)
            if (no_curve(kinds(kind), rate, "all", curve)) return
            if (unmet(size(curve%m), int(longest_factor(kinds(kind), int(n, int64))), "number of factors")) return
            expected = [(definition(trim(kinds(kind)), phase, i), i=1, size(curve%m))]
            call agree(curve%deviation, expected, 1.0e-11_dp, kinds(kind))
         end do
         deallocate (phase)
      end do
   end subroutine test_direct_sums

   subroutine test_long_chains()
      ! several stretches, chains and blocks: sums over windows of the phase from its own prefix sum
      integer, parameter :: n = 200001, factors(5) = [3, 4096, 5000, 12000, 66001]
      type(allan_curve_type) :: curve
      real(dp), allocatable :: rate(:), x(:), p(:)
      real(dp) :: expected(5)
      integer :: i, m

      rate = normal_series(int(n, int64), 555_int64)
      rate = rate - sum(rate)/n
      allocate (x(0:n), p(-1:n))
      x(0) = 0
      do i = 1, n
         x(i) = x(i - 1) + rate(i)
      end do
      p(-1) = 0
      do i = 0, n
         p(i) = p(i - 1) + x(i)
      end do
      do i = 1, 5
         m = factors(i)
         expected(i) = sqrt(sum((p(3*m - 1:n) - 3*p(2*m - 1:n - m) + 3*p(m - 1:n - 2*m) - p(-1:n - 3*m))**2) &
            & /(2*real(m, dp)**4*(n - 3*m + 2)))
      end do
      if (no_curve("mdev", rate, "3,4096,5000,12000,66001", curve)) return
      call agree(curve%deviation, expected, 1.0e-9_dp, "mdev")
      do i = 1, 5
         m = factors(i)
         expected(i) = sqrt(sum((x(3*m:n) - 3*x(2*m:n - m) + 3*x(m:n - 2*m) - x(0:n - 3*m))**2) &
            & /(6*real(m, dp)**2*(n - 3*m + 1)))
      end do
      if (no_curve("ohdev", rate, "3,4096,5000,12000,66001", curve)) return
      call agree(curve%deviation, expected, 1.0e-11_dp, "ohdev")
   end subroutine test_long_chains

   subroutine test_phase_input()
      ! the integral of a rate, with an offset and a steady rate that do not matter
      integer, parameter :: n = 5000
      real(dp), parameter :: interval = 0.01_dp
      type(allan_curve_type) :: from_rate, from_phase
      type(allan_options) :: options
      real(dp) :: rate(n), phase(n + 1)
      integer :: i, kind

      rate = normal_series(int(n, int64), 8_int64)
      phase(1) = 7
      do i = 1, n
         phase(i + 1) = phase(i) + interval*(rate(i) + 3)
      end do
      do kind = 1, size(statistic_names)
         options%kind = statistic_names(kind)
         call compute_allan(rate, interval, options, from_rate, failure)
         if (went_wrong(failure)) return
         call compute_allan_from_phase(phase, interval, options, from_phase, failure)
         if (went_wrong(failure)) return
         call agree(from_phase%deviation, from_rate%deviation, 1.0e-10_dp, statistic_names(kind))
         call agree(from_phase%edf, from_rate%edf, exact, "edf")
         call check(error, all(from_phase%terms == from_rate%terms) .and. from_phase%samples == n, "terms")
      end do
   end subroutine test_phase_input

   subroutine test_few_phases()
      ! long records, of whose integral only some phases are kept, against the whole integral: a length of whole stretches
      ! and more, grids with and without factors before the step, windows that reach over the end of a stretch
      character(*), parameter :: grids(5) = [character(24) :: "octave", "decade", "48,96,960", &
         & "7,13,50,64,640,128000", "5000,10000"]
      type(allan_curve_type) :: from_rate, from_phase
      type(allan_options) :: options
      real(dp), allocatable :: rate(:), phase(:)
      integer(int64) :: i, n
      integer :: kind, grid

      do n = 31*32768, 31*32768 + 777, 777
         rate = normal_series(n, 4711_int64)
         if (allocated(phase)) deallocate (phase)
         allocate (phase(0:n))
         phase(0) = 0
         do i = 1, n
            phase(i) = phase(i - 1) + rate(i)
         end do
         do kind = 1, 2
            options%kind = merge("adev", "hdev", kind == 1)
            do grid = 1, size(grids)
               options%taus = trim(grids(grid))
               call compute_allan(rate, 1.0_dp, options, from_rate, failure)
               if (went_wrong(failure)) return
               call compute_allan_from_phase(phase, 1.0_dp, options, from_phase, failure)
               if (went_wrong(failure)) return
               call agree(from_rate%deviation, from_phase%deviation, exact, options%kind//options%taus)
               call agree(from_rate%edf, from_phase%edf, exact, "edf")
               call check(error, all(from_rate%terms == from_phase%terms), "terms")
            end do
         end do
      end do
   end subroutine test_few_phases

   subroutine test_ramp()
      ! rate = R t: R tau/sqrt(2) for the Allan deviations (modified too), nothing for the Hadamard ones
      character(5), parameter :: kinds(5) = ["adev ", "oadev", "mdev ", "hdev ", "ohdev"]
      real(dp), parameter :: slope = 0.25_dp
      type(allan_curve_type) :: curve
      real(dp) :: rate(1000)
      integer :: i, kind

      rate = [(slope*real(i, dp), i=1, size(rate))]
      do kind = 1, size(kinds)
         if (no_curve(kinds(kind), rate, "log:5", curve)) return
         if (kind <= 3) call agree(curve%deviation, slope*curve%tau/sqrt(2.0_dp), exact, kinds(kind))
         if (kind > 3) call check(error, all(curve%deviation <= 1.0e-12_dp), kinds(kind)//" of a ramp is not 0")
      end do
   end subroutine test_ramp

   subroutine test_sinusoid()
      ! rate = A sin(omega i + phase) over whole periods: its window mean is A s, s = sin(m omega/2)/(m sin(omega/2)), and a
      ! first difference of step m multiplies by 2 sin(m omega/2); half the square of each is the mean
      integer, parameter :: n = 64000, m(4) = [1, 3, 10, 32]
      real(dp), parameter :: omega = 6.283185307179586_dp/64, amplitude = 3.0_dp
      type(allan_curve_type) :: curve
      real(dp) :: rate(n), shape(4), step(4)
      integer :: i

      rate = [(amplitude*sin(omega*i + 0.3_dp), i=1, n)]
      shape = amplitude*abs(sin(m*omega/2))/(m*sin(omega/2))/sqrt(2.0_dp)
      step = 2*abs(sin(m*omega/2))
      if (no_curve("oadev", rate, "1,3,10,32", curve)) return
      call agree(curve%deviation, shape*step/sqrt(2.0_dp), 5.0e-4_dp, "oadev")
      if (no_curve("ohdev", rate, "1,3,10,32", curve)) return
      call agree(curve%deviation, shape*step**2/sqrt(6.0_dp), 5.0e-4_dp, "ohdev")
      if (no_curve("mdev", rate, "1,3,10,32", curve)) return
      call agree(curve%deviation, &
         & shape*step/sqrt(2.0_dp)*abs(sin(m*omega/2))/(m*sin(omega/2)), 5.0e-4_dp, "mdev")
   end subroutine test_sinusoid

   subroutine test_white_noise()
      ! expectations of unit white noise: 1/m of every one but mdev, (m**2 + 1)/(2 m**3) of that; and the stated degrees of
      ! freedom against the scatter of the variances
      integer, parameter :: n = 1000, runs = 400, m(3) = [1, 4, 32]
      type(allan_curve_type) :: curve
      real(dp) :: first(3), second(3), edf(3), variance(3), expected(3), x(n*runs)
      integer :: run, kind

      x = normal_series(size(x, kind=int64), 20202_int64)
      do kind = 1, size(statistic_names)
         first = 0
         second = 0
         do run = 1, runs
            if (no_curve(statistic_names(kind), x((run - 1)*n + 1:run*n), "1,4,32", curve)) return
            variance = curve%deviation**2
            first = first + variance/runs
            second = second + variance**2/runs
         end do
         expected = 1/real(m, dp)
         if (any(statistic_names(kind) == ["mdev", "tdev"])) expected = real(m**2 + 1, dp)/(2*real(m, dp)**3)
         if (statistic_names(kind) == "tdev") expected = expected*real(m, dp)**2/3
         edf = [(statistic_edf(statistic_names(kind), n + 1_int64, int(m(run), int64), 0), run=1, 3)]
         ! five standard errors of the mean, and of the scatter (sqrt(2/runs), heavier tails at few degrees of freedom)
         call check(error, all(abs(first/expected - 1) < 5*sqrt(2/(edf*runs))), statistic_names(kind)//": mean")
         ! the published edf of the total variance is one for long times; at m = 1 it is twice that of oadev, which it equals there
         if (statistic_names(kind) == "totdev") edf(1) = statistic_edf("oadev", n + 1_int64, 1_int64, 0)
         call agree(2*first**2/(second - first**2), edf, 0.25_dp, statistic_names(kind)//": edf")
      end do
   end subroutine test_white_noise

   subroutine test_random_run()
      ! the rate integrated twice: the Hadamard variance identifies f**-4, the Allan variance stops at f**-2
      type(allan_curve_type) :: curve
      real(dp) :: rate(20000)
      integer :: i, pass

      rate = normal_series(20000_int64, 60606_int64)
      do pass = 1, 2
         do i = 2, size(rate)
            rate(i) = rate(i) + rate(i - 1)
         end do
      end do
      if (no_curve("ohdev", rate, "4,16,64", curve)) return
      call check(error, all(curve%alpha == -4), "random run")
      if (no_curve("oadev", rate, "4,16,64", curve)) return
      call check(error, all(curve%alpha == -2), "the lowest exponent of the Allan variance")
   end subroutine test_random_run

   subroutine test_offset()
      ! the same rounded input with and without an offset of a million standard deviations
      integer, parameter :: n = 50000
      type(allan_curve_type) :: plain, shifted
      real(dp) :: rate(n), moved(n)
      integer :: kind

      moved = normal_series(int(n, int64), 4343_int64) + 1.0e6_dp
      rate = moved - 1.0e6_dp
      do kind = 1, size(statistic_names)
         if (no_curve(statistic_names(kind), rate, "octave", plain)) return
         if (no_curve(statistic_names(kind), moved, "octave", shifted)) return
         call agree(shifted%deviation, plain%deviation, 1.0e-11_dp, statistic_names(kind))
      end do
   end subroutine test_offset

   subroutine test_threads()
      integer(int64), parameter :: n = 1100000
      type(allan_curve_type) :: one, two
      real(dp), allocatable :: rate(:)
      integer(int8), allocatable :: valid(:)
      integer :: threads, kind

      allocate (rate, source=normal_series(n, 99_int64))
      allocate (valid(n), source=1_int8)
      valid(1000:n:777) = 0
      threads = thread_count()
      do kind = 1, size(statistic_names)
         call set_thread_count(1)
         if (no_curve(statistic_names(kind), rate, "octave", one)) exit
         call set_thread_count(2)
         if (no_curve(statistic_names(kind), rate, "octave", two)) exit
         call agree(two%deviation, one%deviation, 0.0_dp, statistic_names(kind))
         call set_thread_count(1)
         if (no_curve(statistic_names(kind), rate, "log:1", one, valid)) exit
         call set_thread_count(2)
         if (no_curve(statistic_names(kind), rate, "log:1", two, valid)) exit
         call agree(two%deviation, one%deviation, 0.0_dp, statistic_names(kind)//", gaps")
      end do
      call set_thread_count(threads)
   end subroutine test_threads

   subroutine test_gaps_direct_sum()
      ! windows of 4 must be complete: plain means over the terms without a missing sample
      integer, parameter :: n = 5000, m = 4, lost(7) = [1, 700, 701, 702, 2048, 2049, 4990]
      character(5), parameter :: kinds(4) = ["adev ", "oadev", "hdev ", "ohdev"]
      type(allan_curve_type) :: curve
      integer(int8) :: valid(n)
      real(dp) :: rate(n), total, z
      integer :: k, terms, kind, windows

      rate = normal_series(int(n, int64), 31_int64)
      valid = 1
      valid(lost) = 0
      rate(lost) = 1.0e30_dp
      do kind = 1, 4
         windows = merge(2, 3, kind <= 2)
         if (no_curve(kinds(kind), rate, "4", curve, valid)) return
         total = 0
         terms = 0
         do k = 1, n - windows*m + 1, merge(m, 1, kind == 1 .or. kind == 3)
            if (any(valid(k:k + windows*m - 1) == 0)) cycle
            z = sum(rate(k + m:k + 2*m - 1)) - sum(rate(k:k + m - 1))
            if (kind > 2) z = sum(rate(k + 2*m:k + 3*m - 1)) - sum(rate(k + m:k + 2*m - 1)) - z
            total = total + z**2
            terms = terms + 1
         end do
         call check(error, curve%terms(1) == terms, "terms")
         call agree(curve%deviation, [sqrt(total/(merge(2, 6, kind <= 2)*real(m, dp)**2*terms))], exact, kinds(kind))
      end do
   end subroutine test_gaps_direct_sum

   subroutine test_gaps_white()
      ! 5 % lost: without the correction the variance is 5 % too large at long times
      integer, parameter :: n = 100000, runs = 4
      character(5), parameter :: kinds(3) = ["adev ", "oadev", "ohdev"]
      type(allan_curve_type) :: curve, whole
      real(dp) :: rate(n), ratio(3, 3)
      integer(int8) :: valid(n)
      integer :: run, kind

      ratio = 0
      do run = 1, runs
         rate = normal_series(int(n, int64), int(2000 + run, int64))
         valid = merge(0_int8, 1_int8, abs(normal_series(int(n, int64), int(71*run, int64))) < 0.05_dp*1.2533_dp)
         do kind = 1, 3
            if (no_curve(kinds(kind), rate, "10,40,100", whole)) return
            if (no_curve(kinds(kind), rate, "10,40,100", curve, valid)) return
            ratio(:, kind) = ratio(:, kind) + (curve%deviation/whole%deviation)**2/runs
         end do
      end do
      do kind = 1, 3
         call agree(ratio(:, kind), [1.0_dp, 1.0_dp, 1.0_dp], merge(0.025_dp, 0.015_dp, kind == 1), &
            & kinds(kind)//", variance with and without gaps")
      end do
   end subroutine test_gaps_white

   subroutine test_shortest()
      ! the shortest record of each kind has one term
      type(allan_curve_type) :: curve
      type(allan_options) :: options
      integer :: kind, n

      do kind = 1, size(statistic_names)
         n = merge(3, 2, any(statistic_names(kind) == ["hdev ", "ohdev"]))
         if (no_curve(statistic_names(kind), nbs14_short(), "octave", curve)) return
         options%kind = statistic_names(kind)
         options%taus = "1"
         call compute_allan([1.0_dp, 3.0_dp, 0.0_dp], 1.0_dp, options, curve, failure)
         if (went_wrong(failure, statistic_names(kind))) return
         call check(error, curve%terms(1) == term_count(statistic_names(kind), 3_int64, 1_int64) .and. curve%edf(1) > 0, "terms")
         call compute_allan([1.0_dp, 3.0_dp], 1.0_dp, options, curve, failure)
         if (unmet(allocated(failure) .eqv. n == 3, statistic_names(kind)//" of two samples")) return
         if (n == 2) call agree(curve%deviation, [sqrt(merge(2/3.0_dp, 2.0_dp, options%kind == "tdev"))], exact, "two")
         if (n == 3) call check(error, failure%code, status%too_few_samples)
         if (allocated(error)) return
      end do
   end subroutine test_shortest

   subroutine test_unknown_kind()
      type(allan_curve_type) :: curve
      type(allan_options) :: options

      options%kind = "ohdve"
      call compute_allan(nbs14_short(), 1.0_dp, options, curve, failure)
      call check(error, failure%code, status%not_supported)
      call check(error, failure%message, "deviation kind 'ohdve' is not known; there are adev, oadev, mdev, tdev, hdev, "// &
         & "ohdev, totdev; did you mean ohdev?")
      options%kind = "xyzzy"
      call compute_allan_from_phase(nbs14_short(), 1.0_dp, options, curve, failure)
      call check(error, failure%message, "deviation kind 'xyzzy' is not known; there are adev, oadev, mdev, tdev, hdev, "// &
         & "ohdev, totdev")
   end subroutine test_unknown_kind

   subroutine test_failures()
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: phase(10)

      phase = 1
      call compute_allan_from_phase(phase(:2), 1.0_dp, allan_options(), curve, failure)
      if (unmet(failure%code, status%too_few_samples, "two phases")) return
      call compute_allan_from_phase(phase(:0), 1.0_dp, allan_options(), curve, failure)
      if (unmet(failure%code, status%too_few_samples, "no phase")) return
      phase(3) = ieee_value(phase(1), ieee_quiet_nan)
      call compute_allan_from_phase(phase, 1.0_dp, allan_options(), curve, failure)
      if (unmet(failure%code, status%non_finite, "a lost phase")) return
      if (no_curve("mdev", nbs14_long(), "octave", curve)) return
      call fit_noise(curve, noise_options(), noise, failure)
      call check_refused(failure, status%invalid_argument)
   end subroutine test_failures

end module test_allan_statistics
