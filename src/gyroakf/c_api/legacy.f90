! SPDX-License-Identifier: MIT
!> FORTRAN 77: Allan deviation, noise coefficients, unit-root test, AR model; the filter with its
!> state in an array of the caller; the series without its outliers and trend, and the filters of
!> the program, which the library keeps (IH(2) holds them). The arguments are described in
!> c_api/README.md.
!>
!> Names of six letters with an underscore behind them in the object, arguments by reference, INFO
!> last: 0 good, -i argument i is bad, > 0 a failure (the numbers of `enum gyroakf_status`).
module gyroakf_c_api_legacy
   use, intrinsic :: iso_c_binding, only : c_int, c_int32_t, c_int64_t, c_char, c_double, c_loc, &
      & c_null_char, c_null_ptr, c_ptr
   use gyroakf_error, only : error_type
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan
   use gyroakf_allan_noise_fit, only : noise_options, noise_type, fit_noise
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter
   use gyroakf_filter_packed, only : packed_length, pack_filter, is_packed, step_packed, &
      & freeze_packed, packed_numbers
   use gyroakf_c_api_c_design, only : gyroakf_filter_identify, identified => kinds
   use gyroakf_c_api_c_filter, only : gyroakf_filter_free, gyroakf_filter_freeze, &
      & gyroakf_filter_step
   use gyroakf_c_api_c_host, only : begin_step, end_step
   use gyroakf_c_api_c_outliers, only : gyroakf_clean, gyroakf_outlier_options_init, &
      & outlier_options_c, outliers_c
   use gyroakf_c_api_c_series, only : adf_c, adf_options_c, gyroakf_adf_options_init, &
      & gyroakf_adf_test, ar_options_c, gyroakf_ar_fit, gyroakf_ar_options_init
   use gyroakf_c_api_c_support, only : call_type, enter_library, leave_library, ok, open_series
   implicit none (type, external)
   private
   public :: gyadev, gynfit, gyadft, gyarft, gyfini, gyfstp, gyfrun, gyfget, gyffrz
   public :: gyclen, gyfdes, gyhstp, gyhfrz, gyhfre

   !> KIND of GYADEV from 1 on
   character(6), parameter :: kinds(7) = [character(6) :: "oadev", "adev", "mdev", "tdev", "hdev", &
      & "ohdev", "totdev"]

   !> METHOD of GYARFT from 1 on
   character(5, c_char), parameter :: methods(3) = [character(5, c_char) :: &
      & "yw"//c_null_char, "burg"//c_null_char, "ols"//c_null_char]

   !> Largest order
   integer, parameter :: largest_order = 1000

contains

   !> CALL GYADEV(N, X, DT, KIND, MAXT, NT, TAU, DEV, DLO, DHI, EDF, INFO)
   subroutine gyadev(n, x, dt, kind, maxt, nt, tau, dev, dlo, dhi, edf, info) &
      & bind(C, name="gyadev_")
      integer(c_int32_t), intent(in) :: n, kind, maxt
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(in) :: dt
      integer(c_int32_t), intent(out) :: nt
      real(c_double), intent(inout) :: tau(*), dev(*), dlo(*), dhi(*), edf(*)
      integer(c_int32_t), intent(out) :: info
      type(call_type) :: c
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: unfitted

      nt = 0
      info = first_bad([n < 2, .false., .false., kind < 1 .or. kind > size(kinds)])
      if (info /= 0) return
      call enter_library(c)
      options%kind = kinds(kind)
      call find_curve(n, x, dt, options, curve, c)
      if (ok(c) .and. curve%kind == "oadev") call fit_noise(curve, noise_options(), noise, unfitted)
      if (ok(c)) call copy_curve(curve, maxt, nt, tau, dev, dlo, dhi, edf, info)
      info = info + leave_library(c)
   end subroutine gyadev

   subroutine find_curve(n, x, dt, options, curve, c)
      integer(c_int32_t), intent(in) :: n
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(in) :: dt
      type(allan_options), intent(in) :: options
      type(allan_curve_type), intent(out) :: curve
      type(call_type), intent(inout) :: c

      call open_series(c_loc(x), int(n, c_int64_t), c)
      if (ok(c)) call compute_allan(c%x, dt, options, curve, c%error, c%valid)
   end subroutine find_curve

   subroutine copy_curve(curve, maxt, nt, tau, dev, dlo, dhi, edf, info)
      type(allan_curve_type), intent(in) :: curve
      integer(c_int32_t), intent(in) :: maxt
      integer(c_int32_t), intent(out) :: nt
      real(c_double), intent(inout) :: tau(*), dev(*), dlo(*), dhi(*), edf(*)
      !> -5 where they are more than `maxt`
      integer(c_int32_t), intent(inout) :: info

      nt = size(curve%tau)
      if (nt > maxt) info = -5
      if (info /= 0) return
      tau(:nt) = curve%tau
      dev(:nt) = curve%deviation
      dlo(:nt) = curve%lower
      dhi(:nt) = curve%upper
      edf(:nt) = curve%edf
   end subroutine copy_curve

   !> CALL GYNFIT(N, X, DT, COEF, SE, UPPER, IDET, CHI2, INFO)
   subroutine gynfit(n, x, dt, coef, se, upper, idet, chi2, info) bind(C, name="gynfit_")
      integer(c_int32_t), intent(in) :: n
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(in) :: dt
      real(c_double), intent(inout) :: coef(5), se(5), upper(5), chi2
      integer(c_int32_t), intent(inout) :: idet(5)
      integer(c_int32_t), intent(out) :: info
      type(call_type) :: c
      type(allan_curve_type) :: curve
      type(noise_type) :: noise

      info = first_bad([n < 2])
      if (info /= 0) return
      call enter_library(c)
      call find_curve(n, x, dt, allan_options(), curve, c)
      if (ok(c)) call fit_noise(curve, noise_options(), noise, c%error)
      if (ok(c)) then
         coef = noise%coefficient%value
         se = noise%coefficient%std_error
         upper = noise%coefficient%upper_limit
         idet = merge(1, merge(0, -1, noise%coefficient%fitted), noise%coefficient%detected)
         chi2 = noise%chi2_reduced
      end if
      info = leave_library(c)
   end subroutine gynfit

   !> CALL GYADFT(N, X, MAXLAG, STAT, PVAL, CRIT, LAG, INFO)
   subroutine gyadft(n, x, maxlag, stat, pval, crit, lag, info) bind(C, name="gyadft_")
      integer(c_int32_t), intent(in) :: n, maxlag
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(inout) :: stat, pval, crit(3)
      integer(c_int32_t), intent(inout) :: lag
      integer(c_int32_t), intent(out) :: info
      type(adf_options_c) :: options
      type(adf_c) :: result

      info = first_bad([n < 1, .false., maxlag < -1])
      if (info /= 0) return
      call gyroakf_adf_options_init(options)
      options%max_lags = maxlag
      info = gyroakf_adf_test(c_loc(x), int(n, c_int64_t), options, result)
      if (info /= 0) return
      stat = result%statistic
      pval = result%p_value
      crit = result%critical
      lag = result%lag
   end subroutine gyadft

   !> CALL GYARFT(N, X, METHOD, MAXP, IP, PHI, VAR, XMEAN, INFO)
   subroutine gyarft(n, x, method, maxp, ip, phi, var, xmean, info) bind(C, name="gyarft_")
      integer(c_int32_t), intent(in) :: n, method, maxp
      real(c_double), intent(in), target :: x(*)
      integer(c_int32_t), intent(inout) :: ip
      real(c_double), intent(inout), target :: phi(*)
      real(c_double), intent(inout) :: var, xmean
      integer(c_int32_t), intent(out) :: info
      character(len(methods), c_char), target :: name
      type(ar_options_c) :: options

      info = first_bad([n < 1, .false., method < 1 .or. method > size(methods), &
         & maxp < 0 .or. maxp > largest_order])
      if (info /= 0) return
      name = methods(method)
      call gyroakf_ar_options_init(options)
      options%method = c_loc(name)
      info = gyroakf_ar_fit(c_loc(x), int(n, c_int64_t), options, maxp, ip, c_loc(phi), var, xmean)
   end subroutine gyarft

   !> CALL GYFINI(IP, PHI, Q, R, IADAPT, B, WORK, LWORK, INFO): begins a filter.
   subroutine gyfini(ip, phi, q, r, iadapt, b, work, lwork, info) bind(C, name="gyfini_")
      integer(c_int32_t), intent(in) :: ip, iadapt(4), lwork
      real(c_double), intent(in) :: phi(*), q, r, b
      real(c_double), intent(inout) :: work(*)
      integer(c_int32_t), intent(out) :: info
      type(call_type) :: c
      type(filter_options) :: options
      type(filter_type) :: filter

      info = first_bad([ip < 0 .or. ip > largest_order])
      if (info /= 0) return
      if (lwork == -1) then
         work(1) = real(packed_length(max(1, ip)), c_double)
         return
      end if
      if (lwork < packed_length(max(1, ip))) info = -8
      if (info /= 0) return
      call enter_library(c)
      options = filter_options(iadapt(1) /= 0, iadapt(2) /= 0, iadapt(3) /= 0, iadapt(4) /= 0, b, &
         & allow_unobservable=.true.)               ! who asks for q and r by number means both
      call new_filter(filter, phi(:ip), q, r, options, c%error)
      if (ok(c)) call pack_filter(filter, work(:packed_length(filter%order)))
      info = leave_library(c)
   end subroutine gyfini

   !> CALL GYFSTP(WORK, Z, X, INFO): one step.
   subroutine gyfstp(work, z, x, info) bind(C, name="gyfstp_")
      real(c_double), intent(inout) :: work(*)
      real(c_double), intent(in) :: z
      real(c_double), intent(out) :: x
      integer(c_int32_t), intent(out) :: info
      integer(c_int64_t) :: environment(64)
      integer(c_int) :: changed

      info = 0
      changed = begin_step(environment)
      if (is_packed(work(:2))) then
         call step_packed(work(:packed_length(nint(work(2)))), z, x)
      else
         info = -1
         x = z
      end if
      if (changed /= 0) call end_step(environment)
   end subroutine gyfstp

   !> CALL GYFRUN(WORK, N, Z, X, INFO): N steps; X may be Z.
   subroutine gyfrun(work, n, z, x, info) bind(C, name="gyfrun_")
      real(c_double), intent(inout) :: work(*)
      integer(c_int32_t), intent(in) :: n
      real(c_double), intent(in) :: z(*)
      real(c_double), intent(inout) :: x(*)
      integer(c_int32_t), intent(out) :: info
      integer(c_int64_t) :: environment(64)
      real(c_double) :: estimate
      integer(c_int) :: changed
      integer(c_int32_t) :: i

      changed = begin_step(environment)
      info = first_bad([.not. is_packed(work(:2)), n < 0])
      if (info == 0) then
         do i = 1, n
            call step_packed(work(:packed_length(nint(work(2)))), z(i), estimate)
            x(i) = estimate
         end do
      end if
      if (changed /= 0) call end_step(environment)
   end subroutine gyfrun

   !> CALL GYFGET(WORK, STATE, INFO): what the filter holds after its last step.
   subroutine gyfget(work, state, info) bind(C, name="gyfget_")
      real(c_double), intent(in) :: work(*)
      real(c_double), intent(out) :: state(9)
      integer(c_int32_t), intent(out) :: info

      state = 0
      info = first_bad([.not. is_packed(work(:2))])
      if (info == 0) call packed_numbers(work(:packed_length(nint(work(2)))), state)
   end subroutine gyfget

   !> CALL GYFFRZ(WORK, IFRZ, INFO): no adaptation from here on (IFRZ not 0), or again (0).
   subroutine gyffrz(work, ifrz, info) bind(C, name="gyffrz_")
      real(c_double), intent(inout) :: work(*)
      integer(c_int32_t), intent(in) :: ifrz
      integer(c_int32_t), intent(out) :: info

      info = first_bad([.not. is_packed(work(:2))])
      if (info == 0) call freeze_packed(work(:packed_length(nint(work(2)))), ifrz /= 0)
   end subroutine gyffrz

   !> CALL GYCLEN(N, X, IDEG, Z, NREM, INFO)
   subroutine gyclen(n, x, ideg, z, nrem, info) bind(C, name="gyclen_")
      integer(c_int32_t), intent(in) :: n, ideg
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(inout), target :: z(*)
      integer(c_int32_t), intent(inout) :: nrem
      integer(c_int32_t), intent(out) :: info
      type(outlier_options_c) :: options
      type(outliers_c) :: figures

      info = first_bad([n < 1, .false., ideg < -1 .or. ideg > 9])
      if (info /= 0) return
      call gyroakf_outlier_options_init(options)
      options%degree = ideg
      info = gyroakf_clean(c_loc(x), int(n, c_int64_t), options, c_loc(z), figures)
      if (info == 0) nrem = int(figures%removed, c_int32_t)
   end subroutine gyclen

   !> CALL GYFDES(N, X, DT, KIND, XMEAN, IH, INFO)
   subroutine gyfdes(n, x, dt, kind, xmean, ih, info) bind(C, name="gyfdes_")
      integer(c_int32_t), intent(in) :: n, kind
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(in) :: dt
      real(c_double), intent(inout) :: xmean
      integer(c_int32_t), intent(out) :: ih(2), info
      character(len(identified) + 1, kind=c_char), target :: name
      type(c_ptr) :: handle

      ih = 0
      info = first_bad([n < 1, .false., .false., kind < 1 .or. kind > size(identified)])
      if (info /= 0) return
      name = trim(identified(kind))//c_null_char
      info = gyroakf_filter_identify(c_loc(name), c_loc(x), int(n, c_int64_t), dt, out=handle, &
         & mean=xmean)
      ih = transfer(handle, ih)
   end subroutine gyfdes

   !> CALL GYHSTP(IH, Z, X, INFO): one step.
   subroutine gyhstp(ih, z, x, info) bind(C, name="gyhstp_")
      integer(c_int32_t), intent(in) :: ih(2)
      real(c_double), intent(in) :: z
      real(c_double), intent(inout) :: x
      integer(c_int32_t), intent(out) :: info

      info = gyroakf_filter_step(transfer(ih, c_null_ptr), z, x)
      if (all(ih == 0)) info = -1
   end subroutine gyhstp

   !> CALL GYHFRZ(IH, IFRZ, INFO): no adaptation from here on (IFRZ not 0), or again (0).
   subroutine gyhfrz(ih, ifrz, info) bind(C, name="gyhfrz_")
      integer(c_int32_t), intent(in) :: ih(2), ifrz
      integer(c_int32_t), intent(out) :: info

      info = gyroakf_filter_freeze(transfer(ih, c_null_ptr), ifrz)
      if (all(ih == 0)) info = -1
   end subroutine gyhfrz

   !> CALL GYHFRE(IH): the filter is no more.
   subroutine gyhfre(ih) bind(C, name="gyhfre_")
      integer(c_int32_t), intent(inout) :: ih(2)

      call gyroakf_filter_free(transfer(ih, c_null_ptr))
      ih = 0
   end subroutine gyhfre

   !> INFO of the first bad argument, 0 where none is.
   pure integer(c_int32_t) function first_bad(bad)
      logical, intent(in) :: bad(:)

      first_bad = -findloc(bad, .true., dim=1)
   end function first_bad

end module gyroakf_c_api_legacy
