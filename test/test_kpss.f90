! SPDX-License-Identifier: MIT
!> Tests of the KPSS test. The statistics were computed in exact arithmetic from the doubles of the
!> series (series_library, 1000 samples each) and rounded once; the probabilities of the Brownian bridges
!> with 30 digits.
module test_kpss
   use expectations, only : problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_series_kpss, only : kpss_options, kpss_type, kpss_of => test_kpss
   use gyroakf_stats_bridge, only : bridge_survival
   use series_library, only : reference_series, reference_names
   implicit none (type, external)
   private
   public :: suite_kpss

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> Bandwidths of the statistics: the last is the automatic one
   integer(int64), parameter :: lags_of(5) = [0_int64, 7_int64, 21_int64, 22_int64, -1_int64]
   !> The automatic bandwidths, c and ct
   integer(int64), parameter :: automatic(11, 2) = reshape([integer(int64) :: &
      & 7, 3, 4, 19, 14, 19, 10, 15, 15, 14, 0, 7, 4, 4, 19, 14, 19, 10, 7, 14, 14, 0], [11, 2])
   !> By bandwidth, series and regression
   real(dp), parameter :: statistic_of(5, 11, 2) = reshape([ &
      & 0.026794521298885574_dp, 0.02874116848154657_dp, 0.03536731904484474_dp, 0.03587619670967482_dp, &
      & 0.02874116848154657_dp, 0.2962850445742264_dp, 0.32401742933674893_dp, 0.3310124746626855_dp, 0.33198855529115084_dp, &
      & 0.2994717405961442_dp, 0.04663082207634264_dp, 0.04907365976258218_dp, 0.054625386597614005_dp, 0.05391922746174333_dp, &
      & 0.047138307155853224_dp, 69.63674979566954_dp, 8.908746182179357_dp, 3.3576522899709955_dp, 3.2197180876915477_dp, &
      & 3.6749962525187274_dp, 0.14811791154254075_dp, 0.04318484921395195_dp, 0.03997785942204078_dp, 0.040187727295214457_dp, &
      & 0.03995536733960086_dp, 7.969407794333728_dp, 1.0790162362975326_dp, 0.44435331637254216_dp, 0.42859959255243313_dp, &
      & 0.4806387907674048_dp, 0.07677402566561523_dp, 0.02788450648406138_dp, 0.035070658013114694_dp, &
      & 0.035545695813701775_dp, 0.031164948579082623_dp, 25.68193061407348_dp, 9.351143145900389_dp, 4.2217441858588876_dp, &
      & 4.064796262535584_dp, 5.519515586812491_dp, 4.285244357034303_dp, 1.1710678100487226_dp, 0.9428933505759984_dp, &
      & 0.9379795107474846_dp, 0.9945085126738492_dp, 0.14811791153183174_dp, 0.04318484921095284_dp, 0.039977859419042576_dp, &
      & 0.04018772729218682_dp, 0.03995536733679043_dp, 0.02816602507198725_dp, 0.02627860822779051_dp, 0.0387539570807959_dp, &
      & 0.03894012883256394_dp, 0.02816602507198725_dp, 0.02513094076487102_dp, 0.026957904546339_dp, 0.03318694361619902_dp, &
      & 0.03366585433702653_dp, 0.026957904546339_dp, 0.10670172079469084_dp, 0.11858113517767202_dp, 0.12487664343419186_dp, &
      & 0.12550228631943144_dp, 0.10966088048490527_dp, 0.04231668393218308_dp, 0.044541031406692286_dp, &
      & 0.049592598924685594_dp, 0.04895268218236825_dp, 0.04278206256973636_dp, 10.156264024486646_dp, 1.337582945233533_dp, &
      & 0.5275802847677626_dp, 0.5074269494759569_dp, 0.5739503971100055_dp, 0.14015312599817295_dp, 0.04086439761341628_dp, &
      & 0.037845750710064206_dp, 0.03804590551352046_dp, 0.03781483941823974_dp, 3.702392172365275_dp, 0.5028339880066328_dp, &
      & 0.20832568567957543_dp, 0.20101957128440365_dp, 0.22515520673770922_dp, 0.0724503990753197_dp, 0.02631453684873047_dp, &
      & 0.033109094503617126_dp, 0.03355886510206201_dp, 0.029411526728218024_dp, 0.02513094076487103_dp, &
      & 0.026957904546339003_dp, 0.033186943616199026_dp, 0.033665854337026534_dp, 0.026957904546339003_dp, &
      & 0.3734556346127155_dp, 0.10751012876667389_dp, 0.09657344054273773_dp, 0.09685780510144357_dp, 0.09799054429751565_dp, &
      & 0.14015312602433014_dp, 0.04086439762114978_dp, 0.03784575071694571_dp, 0.03804590552041895_dp, 0.03781483942533356_dp, &
      & 0.02271721229147859_dp, 0.021198211949645145_dp, 0.03129575216637463_dp, 0.03144936777495356_dp, 0.02271721229147859_dp], &
      & [5, 11, 2])

contains

   subroutine suite_kpss()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("longer_series", test_longer_series)
      call test("bridge", test_bridge)
      call test("table", test_table)
      call test("offset_scale", test_offset_scale)
      call test("small_signal", test_small_signal)
      call test("windows", test_windows)
      call test("missing", test_missing)
      call test("drift", test_drift)
      call test("failures", test_failures)
   end subroutine suite_kpss

   !> 1 2 4: residuals -4/3 -1/3 5/3, S = -4/3 -5/3 0; sum S^2 = 41/9, g_0 = 14/9, g_1 = -1/27.
   subroutine test_by_hand()
      type(kpss_type) :: kpss

      call kpss_of([1.0_dp, 2.0_dp, 4.0_dp], kpss_options(lags=1_int64), kpss, problem)
      if (went_wrong(problem)) return
      call check(error, kpss%statistic, 41.0_dp/81.0_dp/(14.0_dp/9.0_dp - 1.0_dp/27.0_dp), thr=tolerance, rel=.true.)
      call check(error, kpss%long_run_variance, 14.0_dp/9.0_dp - 1.0_dp/27.0_dp, thr=tolerance, rel=.true.)
      call check(error, kpss%observations == 3 .and. kpss%lags == 1 .and. kpss%rule == "fixed", "what was used")
   end subroutine test_by_hand

   !> Eleven series, five bandwidths, both regressions.
   subroutine test_reference()
      type(kpss_type) :: kpss
      real(dp), allocatable :: x(:)
      character(2), parameter :: regression(2) = ["c ", "ct"]
      integer :: i, j, k

      do k = 1, 2
         do i = 1, size(reference_names)
            x = reference_series(trim(reference_names(i)), 1000)
            do j = 1, size(lags_of)
               call kpss_of(x, kpss_options(regression=regression(k), lags=lags_of(j)), kpss, problem)
               if (went_wrong(problem)) return
               call check(error, kpss%statistic, statistic_of(j, i, k), reference_names(i), thr=tolerance, rel=.true.)
            end do
            call check(error, kpss%lags, automatic(i, k), "bandwidth of "//reference_names(i))
         end do
      end do
   end subroutine test_reference

   !> 12000 samples, Hobijn's bandwidth; 21 lags by the old rule.
   subroutine test_longer_series()
      type(kpss_type) :: kpss

      call kpss_of(reference_series("unif", 12000), kpss_options(), kpss, problem)
      call check(error, kpss%statistic, 0.027056728119838287_dp, thr=tolerance, rel=.true.)
      call check(error, kpss%lags, 10_int64)
      call kpss_of(reference_series("sine", 12000), kpss_options(), kpss, problem)
      call check(error, kpss%statistic, 0.3258666091239446_dp, thr=tolerance, rel=.true.)
      call check(error, kpss%lags, 21_int64)
      call kpss_of(reference_series("wn", 1000), kpss_options(rule="legacy"), kpss, problem)
      call check(error, kpss%lags == 21_int64 .and. kpss%rule == "legacy", "the old rule")
      call check(error, kpss%statistic, statistic_of(3, 1, 1), thr=tolerance, rel=.true.)
   end subroutine test_longer_series

   !> Against 30 digits; 0.46136 and its kin are the quantiles of Anderson & Darling.
   subroutine test_bridge()
      real(dp), parameter :: x(8, 2) = reshape([0.02_dp, 0.1_dp, 0.34730_dp, 0.46136_dp, 0.74346_dp, 1.16786_dp, 3.0_dp, &
         & 10.0_dp, 0.01_dp, 0.05_dp, 0.119_dp, 0.146_dp, 0.176_dp, 0.216_dp, 1.0_dp, 10.0_dp], [8, 2])
      real(dp), parameter :: p(8, 2) = reshape([0.99699938569839812_dp, 0.58487343840679491_dp, 0.10000308279019988_dp, &
         & 0.050000383132651276_dp, 0.0099999619154553671_dp, 0.00099999091487455655_dp, 7.5677434593160199e-8_dp, &
         & 4.1789410928852881e-23_dp, 0.99991200710530016_dp, 0.57294348142088933_dp, 0.10054297156241218_dp, &
         & 0.052302044522146102_dp, 0.025863310346827728_dp, 0.010399732423861539_dp, 8.7551472464078749e-10_dp, &
         & 1.9351465709271196e-87_dp], [8, 2])
      integer :: i, k

      do k = 1, 2
         do i = 1, 8
            call check(error, bridge_survival(x(i, k), k), p(i, k), thr=tolerance, rel=.true.)
         end do
         call check(error, bridge_survival(-1.0_dp, k), 1.0_dp)
         call check(error, bridge_survival(0.0101_dp, k) <= bridge_survival(0.0_dp, k), "it rises")
      end do
   end subroutine test_bridge

   !> Interpolation within the table, and the bounds at its ends.
   subroutine test_table()
      type(kpss_type) :: kpss

      call kpss_of(reference_series("ar1_99", 1000), kpss_options(), kpss, problem)
      call check(error, kpss%p_value, 0.0460272993767108_dp, thr=tolerance, rel=.true.)
      call check(error, kpss%p_bound == 0 .and. .not. kpss%stationary, "verdict")
      call kpss_of(reference_series("ar1_99", 1000), kpss_options(regression="ct", lags=22_int64), kpss, problem)
      call check(error, kpss%p_value, 0.01561766076834859_dp, thr=tolerance, rel=.true.)
      call kpss_of(reference_series("rw", 1000), kpss_options(), kpss, problem)
      call check(error, kpss%p_bound == -1 .and. kpss%p_value <= 0.01_dp .and. kpss%p_asymptotic < 1.0e-8_dp, "below")
      call kpss_of(reference_series("wn", 1000), kpss_options(), kpss, problem)
      call check(error, kpss%p_bound == 1 .and. kpss%p_value >= 0.10_dp .and. kpss%stationary, "above")
      call check(error, kpss%p_asymptotic > 0.97_dp .and. kpss%p_asymptotic < 0.99_dp, "probability")
   end subroutine test_table

   !> An offset of 2^30 and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024.
   subroutine test_offset_scale()
      type(kpss_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar1", 1000))/1024.0_dp
      call kpss_of(x, kpss_options(), a, problem)
      call kpss_of(2.0_dp**(-50)*(x + 2.0_dp**30), kpss_options(), b, problem)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, b%lags, a%lags)
      call check(error, b%drift*2.0_dp**50, a%drift, thr=tolerance, rel=.true.)
      call kpss_of(x, kpss_options(regression="ct"), a, problem)
      call kpss_of(-2.0_dp**(-50)*(x + 2.0_dp**30), kpss_options(regression="ct"), b, problem)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
   end subroutine test_offset_scale

   !> A signal of 1e-3 on 1e6 keeps seven digits: its samples have no more.
   subroutine test_small_signal()
      type(kpss_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: k
      character(2), parameter :: regression(2) = ["c ", "ct"]

      x = reference_series("ar1", 1000)
      do k = 1, 2
         call kpss_of(x, kpss_options(regression=regression(k)), a, problem)
         call kpss_of(1.0e6_dp + 1.0e-3_dp*x, kpss_options(regression=regression(k)), b, problem)
         call check(error, b%statistic, a%statistic, thr=1.0e-7_dp, rel=.true.)
         call check(error, b%lags, a%lags)
      end do
   end subroutine test_small_signal

   !> Many lags, over blocks and threads, against the plain sums.
   subroutine test_windows()
      integer(int64), parameter :: lags(4) = [50_int64, 4095_int64, 5000_int64, 69999_int64]
      type(kpss_type) :: kpss
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i

      x = reference_series("ar1", 70000)
      allocate (valid(size(x)))
      valid = 1_int8
      do i = 1, size(lags)
         call kpss_of(x, kpss_options(lags=lags(i)), kpss, problem)
         if (lags(i) < 6000) then
            call check(error, kpss%statistic, plain(x, int(lags(i)), valid), thr=1.0e-11_dp, rel=.true.)
         else
            call check(error, kpss%statistic > 0.0_dp .and. .not. allocated(problem), "as many lags as samples")
         end if
         if (allocated(error)) return
      end do
   end subroutine test_windows

   !> Gaps: the plain sums over present samples and pairs; half of all samples, a leading gap.
   subroutine test_missing()
      integer(int64), parameter :: lags(3) = [0_int64, 6_int64, 40_int64]
      type(kpss_type) :: kpss, whole
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i

      x = reference_series("ar1", 3000)
      allocate (valid(size(x)))
      valid = 1_int8
      call kpss_of(x, kpss_options(), whole, problem)
      call kpss_of(x, kpss_options(), kpss, problem, valid)
      call check(error, kpss%statistic, whole%statistic, thr=tolerance, rel=.true.)
      do i = 1, size(x)
         if (mod(i*i, 7) < 3 .or. i < 200) valid(i) = 0_int8
      end do
      where (valid == 0_int8) x = 1.0e9_dp
      do i = 1, size(lags)
         call kpss_of(x, kpss_options(lags=lags(i)), kpss, problem, valid)
         call check(error, kpss%statistic, plain(x, int(lags(i)), valid), thr=tolerance, rel=.true.)
         call check(error, kpss%observations, count(valid /= 0_int8, kind=int64))
      end do
   end subroutine test_missing

   !> The statistic about a level as its definition says, with arrays.
   pure real(dp) function plain(x, lags, valid) result(statistic)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: lags
      integer(int8), intent(in) :: valid(:)
      real(dp) :: e(size(x)), run, squares, variance, n
      integer :: i

      n = real(count(valid /= 0_int8), dp)
      e = x - sum(x, mask=valid /= 0_int8)/n
      e = e - sum(e, mask=valid /= 0_int8)/n
      where (valid == 0_int8) e = 0.0_dp
      run = 0.0_dp
      squares = 0.0_dp
      do i = 1, size(x)
         run = run + e(i)
         if (valid(i) /= 0_int8) squares = squares + run**2
      end do
      variance = dot_product(e, e)
      do i = 1, lags
         variance = variance + 2.0_dp*(1.0_dp - real(i, dp)/real(lags + 1, dp))*dot_product(e(i + 1:), e(:size(x) - i))
      end do
      statistic = squares/n/variance
   end function plain

   !> The size of the effect is the height of a line, and of a parabola about a line; n does not matter.
   subroutine test_drift()
      type(kpss_type) :: kpss
      real(dp) :: t(20001)
      integer :: i

      t = [(real(i, dp)/20000.0_dp, i = 0, 20000)]
      call kpss_of(7.0_dp + 3.0_dp*t, kpss_options(), kpss, problem)
      call check(error, kpss%drift, 3.0_dp, thr=1.0e-3_dp)
      call kpss_of(7.0_dp + 3.0_dp*t + 2.0_dp*t**2, kpss_options(regression="ct"), kpss, problem)
      call check(error, kpss%drift, 0.5_dp, thr=1.0e-3_dp)
   end subroutine test_drift

   !> What cannot be tested.
   subroutine test_failures()
      real(dp) :: x(30)
      integer(int8) :: valid(30)
      integer :: i

      x = 5.3_dp
      call expect(x, kpss_options(), status%constant_input)
      x = [(1.0e6_dp + 0.1_dp*real(i, dp), i = 1, 30)]
      call expect(x, kpss_options(regression="ct"), status%constant_input)
      call expect(x(:2), kpss_options(), status%too_few_samples)
      call expect(x, kpss_options(lags=30_int64), status%too_few_samples)
      call expect(x, kpss_options(regression="n"), status%invalid_argument)
      call expect(x, kpss_options(rule="long"), status%invalid_argument)
      call expect(x, kpss_options(lags=-2_int64), status%invalid_argument)
      valid = 0_int8
      valid(3:4) = 1_int8
      call expect(x, kpss_options(), status%too_few_samples,  valid)
      valid = 0_int8
      call expect(x, kpss_options(), status%too_few_samples,  valid)
      call expect(x, kpss_options(), status%invalid_argument,  valid(:29))
   end subroutine test_failures

   !> The call fails with this code.
   subroutine expect(x, options, code,  valid)
      real(dp), intent(in), contiguous :: x(:)
      type(kpss_options), intent(in) :: options
      integer, intent(in) :: code
      integer(int8), intent(in), optional :: valid(:)
      type(kpss_type) :: kpss

      call kpss_of(x, options, kpss, problem, valid)
      call check_refused(problem, code)
   end subroutine expect

end module test_kpss
