! SPDX-License-Identifier: MIT
!> Tests of Fisher's test. Statistics and probabilities of the series of series_library (1000 samples) were computed in arithmetic
!> of 60 digits and rounded once.
module test_fisher
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_fisher, only : fisher_type, test_fisher_g, fisher_tail
   use series_library, only : reference_series, reference_names
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_fisher

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> p is (1 - g)^499: rounding of g alone, and of the 1000 terms of the transform, comes 500 times as large in it
   real(dp), parameter :: tail_tolerance = 2.0e-11_dp
   !> g, k, p in the order of reference_names
   real(dp), parameter :: g_of(11) = [0.013809472937182887_dp, 0.012270718263949308_dp, 0.011542101900675752_dp, &
      & 0.49857650300115314_dp, 0.02863998866263411_dp, 0.19984909707854234_dp, 0.044440596009068946_dp, &
      & 0.1461233864422029_dp, 0.027578191209619428_dp, 0.02863998866194383_dp, 0.03877625181803853_dp]
   integer, parameter :: k_of(11) = [199, 308, 491, 1, 14, 6, 76, 1, 6, 14, 50]
   real(dp), parameter :: p_of(11) = [0.39489632455981305_dp, 0.6712890227237649_dp, 0.8035634195853781_dp, &
      & 2.512070822783145e-147_dp, 0.00025906813099331997_dp, 3.0040459471601866e-46_dp, 7.352425025717103e-08_dp, &
      & 3.4109065362093496e-32_dp, 0.00044634587630545437_dp, 0.00025906813108499447_dp, 1.3953958968515186e-06_dp]

contains

   subroutine suite_fisher()
      call test("reference", test_reference)
      call test("long", test_long)
      call test("tail_sum", test_tail_sum)
      call test("tail_published", test_tail_published)
      call test("tail_extremes", test_tail_extremes)
      call test("invariance", test_invariance)
      call test("reversed", test_reversed)
      call test("missing", test_missing)
      call test("uniform_p", test_uniform_p)
      call test("failures", test_failures)
   end subroutine suite_fisher

   !> Statistic, ordinate and probability of the eleven series.
   subroutine test_reference()
      type(fisher_type) :: f
      integer :: i

      do i = 1, size(reference_names)
         call test_fisher_g(reference_series(trim(reference_names(i)), 1000), f, problem)
         if (went_wrong(problem, trim(reference_names(i)))) return
         call check(error, f%statistic, g_of(i), thr=tolerance*g_of(i), more=trim(reference_names(i)))
         call check(error, int(f%ordinate), k_of(i), more=trim(reference_names(i)))
         call check(error, f%p_value, p_of(i), thr=tail_tolerance*p_of(i), more=trim(reference_names(i)))
         call check(error, f%log_p_value, log(p_of(i)), thr=tail_tolerance*max(1.0_dp, -log(p_of(i))))
      end do
      call check(error, int(f%ordinates), 499)
      call check(error, f%frequency, 0.05_dp, thr=tolerance)
   end subroutine test_reference

   !> 12000 samples.
   subroutine test_long()
      type(fisher_type) :: f

      call test_fisher_g(reference_series("unif", 12000), f, problem)
      call check(error, f%statistic, 0.0013707465865103576_dp, thr=tolerance)
      call check(error, int(f%ordinate), 3963)
      call check(error, f%p_value, 0.801715625136554_dp, thr=tail_tolerance)
      call test_fisher_g(reference_series("sine", 12000), f, problem)
      call check(error, f%statistic, 0.047564375035466525_dp, thr=tolerance)
      call check(error, f%p_value/6.826468563413286e-124_dp, 1.0_dp, thr=1.0e-10_dp)
   end subroutine test_long

   !> The alternating sum with its binomials, term by term, where m is small.
   subroutine test_tail_sum()
      real(dp) :: g, p, log_p, direct, binomial
      integer :: m, i, j

      do m = 2, 20
         do i = 1, 9
            g = 1.0_dp/real(m, dp) + 0.1_dp*real(i, dp)*(1.0_dp - 1.0_dp/real(m, dp))
            direct = 0.0_dp
            binomial = 1.0_dp
            do j = 1, m
               binomial = binomial*real(m - j + 1, dp)/real(j, dp)
               if (1.0_dp - j*g <= 0.0_dp) exit
               direct = direct - (-1)**j*binomial*(1.0_dp - j*g)**(m - 1)
            end do
            call fisher_tail(g, 1.0_dp - g, int(m, int64), p, log_p)
            call check(error, p, direct, thr=1.0e-12_dp*direct + 1.0e-14_dp)
            call check(error, exp(log_p), p, thr=1.0e-13_dp)
         end do
      end do
   end subroutine test_tail_sum

   !> Fisher's table (1929) of g at 5 % and 1 %.
   subroutine test_tail_published()
      real(dp), parameter :: five(3) = [0.68377_dp, 0.44495_dp, 0.13135_dp], one(2) = [0.78853_dp, 0.53584_dp]
      integer(int64), parameter :: m(3) = [5_int64, 10_int64, 50_int64]
      real(dp) :: p, log_p
      integer :: i

      do i = 1, 3
         call fisher_tail(five(i), 1.0_dp - five(i), m(i), p, log_p)
         call check(error, p, 0.05_dp, thr=2.0e-5_dp)
         if (i > size(one)) cycle
         call fisher_tail(one(i), 1.0_dp - one(i), m(i), p, log_p)
         call check(error, p, 0.01_dp, thr=2.0e-5_dp)
      end do
   end subroutine test_tail_published

   !> One ordinate, all power in one, p that underflows, p near 1.
   subroutine test_tail_extremes()
      real(dp) :: p, log_p

      call fisher_tail(1.0_dp, 0.0_dp, 1_int64, p, log_p)
      call check(error, p, 1.0_dp)
      call fisher_tail(1.0_dp, 0.0_dp, 10_int64, p, log_p)
      call check(error, p <= 0.0_dp .and. log_p < -1.0e300_dp)
      call fisher_tail(0.5_dp, 0.5_dp, 5000_int64, p, log_p)
      call check(error, p <= 0.0_dp)
      call check(error, log_p, log(5000.0_dp) - 4999*log(2.0_dp), thr=1.0e-9_dp)
      ! on either side of the change from the sum to the Poisson probability: lambda = 16.9 and 17.1, m = 50000
      call fisher_tail(1.598e-4_dp, 1.0_dp - 1.598e-4_dp, 50000_int64, p, log_p)
      call check(error, p, 1.0_dp, thr=2.0e-7_dp)
      call fisher_tail(1.0e-5_dp, 1.0_dp - 1.0e-5_dp, 50000_int64, p, log_p)
      call check(error, p, 1.0_dp)
   end subroutine test_tail_extremes

   !> An offset of 1e6 under a signal of 1e-3, and a scale, change nothing.
   subroutine test_invariance()
      type(fisher_type) :: a, b
      real(dp), allocatable :: x(:)

      x = reference_series("ar1", 997)             ! a prime length
      call test_fisher_g(x, a, problem)
      call test_fisher_g(1.0e6_dp + 1.0e-3_dp*x, b, problem)
      call check(error, b%statistic, a%statistic, thr=1.0e-7_dp*a%statistic)
      call check(error, int(b%ordinate), int(a%ordinate))
      call test_fisher_g(1.0e-200_dp*x, b, problem)
      call check(error, b%statistic, a%statistic, thr=1.0e-14_dp)
      call test_fisher_g(1.0e200_dp*x, b, problem)
      call check(error, b%statistic, a%statistic, thr=1.0e-14_dp)
   end subroutine test_invariance

   !> The periodogram does not know the direction of time.
   subroutine test_reversed()
      type(fisher_type) :: a, b
      real(dp), allocatable :: x(:)

      x = reference_series("wn", 1001)
      call test_fisher_g(x, a, problem)
      call test_fisher_g(x(1001:1:-1), b, problem)
      call check(error, b%statistic, a%statistic, thr=1.0e-13_dp)
      call check(error, b%p_value, a%p_value, thr=1.0e-11_dp)
   end subroutine test_reversed

   !> A sinusoid is found through a third of missing samples, whose values do not matter.
   subroutine test_missing()
      type(fisher_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(1000)
      integer :: i

      x = reference_series("sine", 1000)
      valid = [(merge(0_int8, 1_int8, mod(i*i, 7) == 2), i=1, 1000)]
      call test_fisher_g(x, a, problem, valid)
      call check(error, int(a%ordinate), 50)
      call check(error, a%p_value < 1.0e-3_dp)
      where (valid == 0_int8) x = 1.0e5_dp
      call test_fisher_g(x, b, problem, valid)
      call check(error, b%statistic, a%statistic, thr=0.0_dp)
      valid = 1_int8
      call test_fisher_g(reference_series("wn", 1000), a, problem, valid)
      call check(error, a%statistic, g_of(1), thr=tolerance)
   end subroutine test_missing

   !> 60 pieces of white noise: p is below 0.1 in about 6 of them.
   subroutine test_uniform_p()
      type(fisher_type) :: f
      real(dp), allocatable :: x(:)
      integer :: i, below, half

      x = reference_series("wn_bm", 12000)
      below = 0
      half = 0
      do i = 0, 59
         call test_fisher_g(x(200*i + 1:200*i + 200), f, problem)
         if (f%p_value < 0.1_dp) below = below + 1
         if (f%p_value < 0.5_dp) half = half + 1
      end do
      call check(error, below >= 1 .and. below <= 14)            ! the binomial's 99.9 % limits
      call check(error, half >= 17 .and. half <= 43)
   end subroutine test_uniform_p

   !> Too short, constant, all but two missing.
   subroutine test_failures()
      type(fisher_type) :: f
      real(dp) :: x(6)

      x = 0.1_dp
      call test_fisher_g(x, f, problem)
      call check_refused(problem, status%constant_input)
      x(3) = 0.2_dp
      call test_fisher_g(x(2:3), f, problem)
      call check_refused(problem, status%too_few_samples)
      call test_fisher_g(x, f, problem, [1_int8, 0_int8, 1_int8, 0_int8, 0_int8, 0_int8])
      call check_refused(problem, status%too_few_samples)
      call test_fisher_g(x(2:4), f, problem)
      if (went_wrong(problem, "three samples")) return
      call check(error, f%p_value, 1.0_dp)
   end subroutine test_failures

end module test_fisher
