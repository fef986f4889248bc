! SPDX-License-Identifier: MIT
!> Tests of the AR models and their criteria. The reference values were computed in exact arithmetic
!> from the doubles of the series (series_library, 1000 samples each) and rounded once.
module test_ar
   use expectations, only : unmet, problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_ar_ar_types, only : ar_order_type, best_order, criterion_number, order_criteria
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use series_library, only : reference_series, reference_names
   implicit none (type, external)
   private
   public :: suite_ar

   real(dp), parameter :: tolerance = 1.0e-12_dp
   real(dp), parameter :: log_two_pi = 1.8378770664093454836_dp
   !> AR(4) coefficients in the order of reference_names
   real(dp), parameter :: phi_of(4,11) = reshape([ &
      & 0.014031865371987869_dp, -0.01696405311967785_dp, 0.024724305676162142_dp, -0.070684453036034_dp, &
      & -0.01883106407305559_dp, 0.03694890226454784_dp, -0.03378714113332833_dp, -0.009915401759923986_dp, &
      & -0.026072361007196093_dp, 0.017087589526449152_dp, -0.001554635555260534_dp, 0.03072604039575598_dp, &
      & 1.0025128110895654_dp, -0.028204086151826846_dp, 0.04217804219921374_dp, -0.0254937868087086_dp, &
      & 0.7093401118762808_dp, -0.025395087432703044_dp, 0.035544369426706905_dp, -0.07275282057418453_dp, &
      & 0.99499585541266_dp, -0.03003989134979369_dp, 0.044511843420024975_dp, -0.04076922295350688_dp, &
      & 1.2083325695060736_dp, -0.5277185544985515_dp, 0.047778498264502325_dp, -0.06085193543110148_dp, &
      & 0.1657790821380841_dp, 0.13523142388895354_dp, 0.17566893329043276_dp, 0.07928396269951754_dp, &
      & 0.7202276590036978_dp, -0.022293583499174638_dp, 0.038684281654896166_dp, -0.06235416752179739_dp, &
      & 0.7093401119057335_dp, -0.025395087474750555_dp, 0.03554436939447533_dp, -0.07275282051907968_dp, &
      & 0.048787379869141174_dp, 0.01221372604674299_dp, 0.046175075232779715_dp, -0.0601191610505398_dp], [4, 11])
   !> n ln s2 + 2 p + 2 for the orders 1 .. 6: differs from our AIC by n (1 + ln 2 pi) + 2
   real(dp), parameter :: aic_of(6,11) = reshape([ &
      & -52.31151078610661_dp, -50.55360703692699_dp, -49.12266968676223_dp, -52.131484784590754_dp, &
      & -50.55404444866993_dp, -50.293045993265295_dp, 42.54035221203752_dp, 43.15184135586016_dp, &
      & 44.021992827238115_dp, 45.92367280192212_dp, 45.46190635874407_dp, 45.28586316396803_dp, &
      & -2484.0649824148973_dp, -2482.378003374956_dp, -2480.3835633756785_dp, -2479.3280988673164_dp, &
      & -2479.6269494380103_dp, -2477.8481875975153_dp, 248.90781269675506_dp, 250.79029611708458_dp, &
      & 252.513667586148_dp, 253.86352312218202_dp, 253.94439431440344_dp, 255.94432013592683_dp, &
      & -52.5417201212365_dp, -51.7783651431768_dp, -50.039143910193346_dp, -53.34617421835038_dp, &
      & -51.78015656308722_dp, -54.69259192956211_dp, -56.23048012650686_dp, -54.852216433291254_dp, &
      & -52.86784439540896_dp, -52.53135680549762_dp, -53.583094327790135_dp, -52.50839841948794_dp, &
      & 276.2261611373327_dp, -50.164732963900086_dp, -48.83300221692868_dp, -50.54283318378885_dp, &
      & -48.544499102676276_dp, -54.27396995164019_dp, 174.28530366675793_dp, 140.29139749692726_dp, &
      & 105.5209415037262_dp, 101.21515501440584_dp, 78.3360226514247_dp, 74.16326784361652_dp, &
      & -42.78083638591237_dp, -41.43075511861705_dp, -39.46980852740173_dp, -41.36542881982841_dp, &
      & -40.35499917983621_dp, -41.97151862305853_dp, -13868.052278143203_dp, -13867.288923167776_dp, &
      & -13865.549701934637_dp, -13868.856732234733_dp, -13867.290714579729_dp, -13870.203149950446_dp, &
      & -15.675225146870533_dp, -13.858863353215861_dp, -13.744101739551517_dp, -15.364962677130036_dp, &
      & -13.835680400053043_dp, -14.423024969334335_dp], [6, 11])
   !> n ln s2 + p ln n: differs from our BIC by n (1 + ln 2 pi) + 2 ln n
   real(dp), parameter :: bic_of(6,11) = reshape([ &
      & -49.40375550712447_dp, -42.73809647896272_dp, -36.39940384981582_dp, -34.500463668662206_dp, &
      & -28.015268053759243_dp, -22.846514319372474_dp, 45.448107491019655_dp, 50.96735191382443_dp, &
      & 56.745258664184526_dp, 63.55469391785067_dp, 68.00068275365476_dp, 72.73239483786085_dp, &
      & -2481.157227135915_dp, -2474.5624928169914_dp, -2467.660297538732_dp, -2461.697077751388_dp, &
      & -2457.0881730430997_dp, -2450.4016559236225_dp, 251.8155679757372_dp, 258.6058066750488_dp, &
      & 265.2369334230944_dp, 271.49454423811056_dp, 276.4831707093141_dp, 283.39085180981965_dp, &
      & -49.633964842254365_dp, -43.962854585212526_dp, -37.315878073246935_dp, -35.71515310242183_dp, &
      & -29.241380168176534_dp, -27.24606025566929_dp, -53.322724847524725_dp, -47.03670587532698_dp, &
      & -40.14457855846255_dp, -34.900335689569076_dp, -31.04431793287945_dp, -25.06186674559512_dp, &
      & 279.1339164163149_dp, -42.34922240593581_dp, -36.10973637998227_dp, -32.9118120678603_dp, &
      & -26.005722707765592_dp, -26.827438277747365_dp, 177.19305894574006_dp, 148.10690805489153_dp, &
      & 118.24420734067262_dp, 118.84617613033438_dp, 100.87479904633538_dp, 101.60979951750934_dp, &
      & -39.873081106930236_dp, -33.615244560652776_dp, -26.746542690455318_dp, -23.734407703899862_dp, &
      & -17.816222784925525_dp, -14.524986949165708_dp, -13865.14452286422_dp, -13859.473412609814_dp, &
      & -13852.82643609769_dp, -13851.225711118805_dp, -13844.751938184818_dp, -13842.756618276553_dp, &
      & -12.767469867888396_dp, -6.043352795251587_dp, -1.0208359026051057_dp, 2.266058438798512_dp, &
      & 8.703095994857643_dp, 13.023506704558487_dp], [6, 11])
   !> Innovation variance of order 4
   real(dp), parameter :: variance_of(11) = [ &
      & 0.939759314616287_dp, 1.0365767244744093_dp, 0.08296569259471666_dp, 1.2761701508862233_dp, &
      & 0.9386184919194541_dp, 0.939383606282617_dp, 0.9412534512728729_dp, 1.0955046832298097_dp, &
      & 0.9499314747608804_dp, 9.386184918705444e-7_dp, 0.9749540252584518_dp]

contains

   subroutine suite_ar()
      call test("paper_table_1", test_paper_table_1)
      call test("criteria_by_hand", test_criteria_by_hand)
      call test("best_order", test_best_order)
      call test("reference", test_reference)
      call test("standard_errors", test_standard_errors)
      call test("choice", test_choice)
      call test("offset_scale", test_offset_scale)
      call test("residuals", test_residuals)
      call test("missing", test_missing)
      call test("order_zero", test_order_zero)
      call test("failures", test_failures)
   end subroutine suite_ar

   !> The paper's record: variance 5.24e-4, AR(1) with 0.409975, 12 000 samples. Per observation -4.9000,
   !> -4.8998, -4.8997 for the orders 1, 2, 3 (the paper prints -4.8930 for the first).
   subroutine test_paper_table_1()
      type(ar_order_type) :: line
      real(dp), parameter :: expected(3) = [-4.9000_dp, -4.8998_dp, -4.8997_dp]
      integer :: p

      do p = 1, 3
         line = order_criteria(p, 5.24e-4_dp*(1.0_dp - 0.409975_dp**2), 12000_int64)
         call check(error, line%aic_per_observation, expected(p), thr=5.0e-5_dp)
      end do
   end subroutine test_paper_table_1

   !> s2 = 1, n = 100, p = 2: k = 3, -2 ln L = 100 (1 + ln 2 pi).
   subroutine test_criteria_by_hand()
      type(ar_order_type) :: line
      real(dp) :: l

      line = order_criteria(2, 1.0_dp, 100_int64)
      l = 100.0_dp*(1.0_dp + log_two_pi)
      call check(error, line%aic, l + 8.0_dp, thr=tolerance, rel=.true.)
      call check(error, line%aicc, l + 800.0_dp/95.0_dp, thr=tolerance, rel=.true.)
      call check(error, line%bic, l + 4.0_dp*log(100.0_dp), thr=tolerance, rel=.true.)
      call check(error, line%hqic, l + 8.0_dp*log(log(100.0_dp)), thr=tolerance, rel=.true.)
      call check(error, line%fpe, 103.0_dp/97.0_dp, thr=tolerance)
      call check(error, line%aic_per_observation, 1.0_dp + log_two_pi + 0.04_dp, thr=tolerance)
   end subroutine test_criteria_by_hand

   !> The smallest value wins, of equal ones the smaller order.
   subroutine test_best_order()
      character(4), parameter :: name(5) = [character(4) :: "aic", "aicc", "bic", "hqic", "fpe"]
      type(ar_order_type) :: table(4)
      integer :: i

      table = order_criteria([0, 1, 2, 3], [2.0_dp, 1.0_dp, 1.0_dp, 0.995_dp], 100_int64)
      do i = 1, 5
         call check(error, criterion_number(trim(name(i))), i)
         call check(error, best_order(table, i), 1)
      end do
      table(3)%aic = table(2)%aic
      call check(error, best_order(table, 1), 1)
   end subroutine test_best_order

   !> Coefficients, variance and criteria of the eleven series.
   subroutine test_reference()
      type(ar_model_type) :: model
      real(dp) :: shift
      integer :: i

      shift = 1000.0_dp*(1.0_dp + log_two_pi)
      do i = 1, size(reference_names)
         call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(order=4, max_order=6), model, problem)
         if (went_wrong(problem, reference_names(i))) return
         call check(error, maxval(abs(model%coefficient - phi_of(:, i))), 0.0_dp, reference_names(i), thr=tolerance)
         call check(error, model%noise_variance, variance_of(i), reference_names(i), thr=tolerance, rel=.true.)
         call check(error, maxval(abs(model%table(2:)%aic - aic_of(:, i) - shift - 2.0_dp)), 0.0_dp, &
            & reference_names(i), thr=1.0e-8_dp)
         call check(error, maxval(abs(model%table(2:)%bic - bic_of(:, i) - shift - 2.0_dp*log(1000.0_dp))), 0.0_dp, &
            & reference_names(i), thr=1.0e-8_dp)
      end do
   end subroutine test_reference

   !> AR(1): sqrt((1 - phi^2)/n); AR(2): both sqrt((1 - phi_2^2)/n).
   subroutine test_standard_errors()
      type(ar_model_type) :: model

      call fit_ar(reference_series("ar1", 1000), ar_options(order=1), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%std_error(1), sqrt((1.0_dp - model%coefficient(1)**2)/1000.0_dp), thr=tolerance)
      call fit_ar(reference_series("ar2", 1000), ar_options(order=2), model, problem)
      call check(error, maxval(abs(model%std_error - sqrt((1.0_dp - model%coefficient(2)**2)/1000.0_dp))), 0.0_dp, thr=tolerance)
   end subroutine test_standard_errors

   !> BIC finds the orders 1 and 2; AIC goes to the largest order of 6, and says so.
   subroutine test_choice()
      type(ar_model_type) :: model
      integer :: i

      do i = 1, 2
         call fit_ar(reference_series(merge("ar1", "ar2", i == 1), 1000), ar_options(criterion="bic", max_order=6), model, problem)
         if (went_wrong(problem)) return
         call check(error, model%order, i)
         call check(error, .not. model%largest_order_chosen, "BIC did not choose the largest")
         call fit_ar(reference_series(merge("ar1", "ar2", i == 1), 1000), ar_options(max_order=6), model, problem)
         call check(error, model%order == 6 .and. model%largest_order_chosen, "AIC chooses 6 of 6")
      end do
      call check(error, size(model%table) == 7 .and. model%table(1)%order == 0, "the table begins with order 0")
   end subroutine test_choice

   !> Offset 2^40 and scale 2^-50, exact for multiples of 1/1024.
   subroutine test_offset_scale()
      type(ar_model_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 6000))/1024.0_dp
      call fit_ar(x, ar_options(max_order=5), a, problem)
      call fit_ar((x + 2.0_dp**40)*2.0_dp**(-50), ar_options(max_order=5), b, problem)
      if (went_wrong(problem)) return
      call check(error, a%order, b%order)
      call check(error, maxval(abs(a%coefficient - b%coefficient)), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(a%std_error - b%std_error)), 0.0_dp, thr=tolerance)
      call check(error, b%noise_variance*2.0_dp**100, a%noise_variance, thr=tolerance, rel=.true.)
      call check(error, b%residual_ljung_box%statistic, a%residual_ljung_box%statistic, thr=1.0e-10_dp, rel=.true.)
   end subroutine test_offset_scale

   !> White with the right order, not with one too small; 20 lags, order subtracted.
   subroutine test_residuals()
      type(ar_model_type) :: model

      call fit_ar(reference_series("ar2", 5000), ar_options(order=2), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%residual_ljung_box%lags == 20 .and. model%residual_ljung_box%fitted == 2, "degrees of freedom")
      call check(error, model%residual_ljung_box%p_value > 0.01_dp, "residuals of AR(2) are white")
      call fit_ar(reference_series("ar2", 5000), ar_options(order=1), model, problem)
      call check(error, model%residual_ljung_box%p_value < 1.0e-10_dp, "residuals of AR(1) are not")
      call fit_ar(reference_series("ar2", 5000), ar_options(order=30), model, problem)
      call check(error, model%residual_ljung_box%lags, 50)
   end subroutine test_residuals

   !> 5 % and 40 % lost: phi within three standard errors of the whole series' (more as samples go).
   subroutine test_missing()
      type(ar_model_type) :: whole, model
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i

      x = reference_series("ar2", 20000)
      call fit_ar(x, ar_options(order=2), whole, problem)
      do i = 1, 2
         valid = merge(0_int8, 1_int8, cshift(reference_series("unif", 20000), 10000) < merge(0.05_dp, 0.4_dp, i == 1))
         where (valid == 0_int8) x = 1.0e7_dp
         call fit_ar(x, ar_options(order=2), model, problem, valid)
         if (went_wrong(problem)) return
         call check(error, all(abs(model%coefficient - whole%coefficient) < 3.0_dp*model%std_error), "coefficients")
         call check(error, model%std_error(1)/whole%std_error(1), merge(1.0_dp/0.95_dp, 1.0_dp/0.6_dp, i == 1), &
            & "standard errors grow with the pairs that are lost", thr=0.02_dp, rel=.true.)
         call check(error, model%samples == count(valid == 1_int8, kind=int64), "samples")
         call check(error, model%residual_ljung_box%p_value > 0.001_dp, "residuals")
      end do
   end subroutine test_missing

   !> Order 0: the mean and the variance.
   subroutine test_order_zero()
      type(ar_model_type) :: model

      call fit_ar([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], ar_options(order=0, max_order=0), model, problem)
      if (went_wrong(problem)) return
      if (unmet(size(model%coefficient) + size(model%std_error), 0)) return
      call check(error, model%noise_variance, 1.25_dp, thr=tolerance)
      call check(error, model%mean, 2.5_dp, thr=tolerance)
      call check(error, .not. model%largest_order_chosen, "there was nothing to choose")
   end subroutine test_order_zero

   !> Each error; the only pair of neighbors that gaps leave can be worth more than the variance.
   subroutine test_failures()
      real(dp) :: x(30)
      integer(int8) :: valid(30)
      integer :: i

      x = reference_series("wn", 30)
      valid = 0_int8
      valid(1:5) = 1_int8
      call refused(x, ar_options(method="best"), status%invalid_argument)
      call refused(x, ar_options(criterion="best"), status%invalid_argument)
      call refused(x, ar_options(max_order=-1), status%invalid_argument)
      call refused(x, ar_options(max_order=27), status%too_few_samples)
      call refused(x, ar_options(max_order=2), status%too_few_samples, valid)
      x = 0.1_dp
      call refused(x, ar_options(), status%constant_input)
      x = 0.0_dp
      x(1:2) = 10.0_dp
      valid = [(int(1 - mod(i, 2), int8), i=1, 30)]
      valid(1) = 1_int8
      call refused(x, ar_options(), status%singular, valid)
      x = reference_series("wn", 30)
      valid(1) = 0_int8                                                ! every other sample: no pair at an odd lag
      call refused(x, ar_options(order=2), status%too_few_samples, valid)
   end subroutine test_failures

   !> Fails unless the fit is refused with the code.
   subroutine refused(x, options, code, valid)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Options
      type(ar_options), intent(in) :: options
      !> Expected
      integer, intent(in) :: code
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      type(ar_model_type) :: model

      call fit_ar(x, options, model, problem, valid)
      call check_refused(problem, code)
   end subroutine refused

end module test_ar
