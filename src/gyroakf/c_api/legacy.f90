! SPDX-License-Identifier: MIT
!> FORTRAN 77: Allan deviation, noise coefficients, unit-root test, AR model. The arguments are described in c_api/README.md.
!>
!> Names of six letters with an underscore behind them in the object, arguments by reference, INFO last: 0 good, -i argument i is
!> bad, > 0 a failure (the numbers of `enum gyroakf_status`).
module gyroakf_c_api_legacy
   use, intrinsic :: iso_c_binding, only : c_int32_t, c_int64_t, c_double, c_loc
   use gyroakf_error, only : error_type
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan
   use gyroakf_allan_noise_fit, only : noise_options, noise_type, fit_noise
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_c_api_c_support, only : host_type, series_type, enter_library, leave_library, open_series, close_series
   implicit none (type, external)
   private
   public :: gyadev, gynfit, gyadft, gyarft

   !> KIND of GYADEV from 1 on
   character(6), parameter :: kinds(7) = ["oadev ", "adev  ", "mdev  ", "tdev  ", "hdev  ", "ohdev ", "totdev"]

   !> METHOD of GYARFT from 1 on
   character(4), parameter :: methods(3) = ["yw  ", "burg", "ols "]

   !> Largest order
   integer, parameter :: largest_order = 1000

contains

   !> CALL GYADEV(N, X, DT, KIND, MAXT, NT, TAU, DEV, DLO, DHI, EDF, INFO)
   subroutine gyadev(n, x, dt, kind, maxt, nt, tau, dev, dlo, dhi, edf, info) bind(C, name="gyadev_")
      integer(c_int32_t), intent(in) :: n, kind, maxt
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(in) :: dt
      integer(c_int32_t), intent(out) :: nt
      real(c_double), intent(inout) :: tau(*), dev(*), dlo(*), dhi(*), edf(*)
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      type(series_type) :: series
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(error_type), allocatable :: error

      info = 0
      nt = 0
      if (n < 2) info = -1
      if (info == 0 .and. (kind < 1 .or. kind > size(kinds))) info = -4
      if (info /= 0) return
      call enter_library(host)
      options%kind = kinds(kind)
      call open_series(c_loc(x(1)), int(n, c_int64_t), series, error)
      if (.not. allocated(error)) call compute_allan(series%x, dt, options, curve, error, series%valid)
      call close_series(series)
      if (.not. allocated(error)) then
         nt = size(curve%tau)
         if (nt > maxt) then
            info = -5
         else
            tau(:nt) = curve%tau
            dev(:nt) = curve%deviation
            dlo(:nt) = curve%lower
            dhi(:nt) = curve%upper
            edf(:nt) = curve%edf
         end if
      end if
      info = info + leave_library(host, error)
   end subroutine gyadev

   !> CALL GYNFIT(N, X, DT, COEF, SE, UPPER, IDET, CHI2, INFO)
   subroutine gynfit(n, x, dt, coef, se, upper, idet, chi2, info) bind(C, name="gynfit_")
      integer(c_int32_t), intent(in) :: n
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(in) :: dt
      real(c_double), intent(inout) :: coef(5), se(5), upper(5), chi2
      integer(c_int32_t), intent(inout) :: idet(5)
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      type(series_type) :: series
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: error

      info = 0
      if (n < 2) info = -1
      if (info /= 0) return
      call enter_library(host)
      call open_series(c_loc(x(1)), int(n, c_int64_t), series, error)
      if (.not. allocated(error)) call compute_allan(series%x, dt, allan_options(), curve, error, series%valid)
      call close_series(series)
      if (.not. allocated(error)) call fit_noise(curve, noise_options(), noise, error)
      if (.not. allocated(error)) then
         coef = noise%coefficient%value
         se = noise%coefficient%std_error
         upper = noise%coefficient%upper_limit
         idet = merge(1_c_int32_t, merge(0_c_int32_t, -1_c_int32_t, noise%coefficient%fitted), noise%coefficient%detected)
         chi2 = noise%chi2_reduced
      end if
      info = leave_library(host, error)
   end subroutine gynfit

   !> CALL GYADFT(N, X, MAXLAG, STAT, PVAL, CRIT, LAG, INFO)
   subroutine gyadft(n, x, maxlag, stat, pval, crit, lag, info) bind(C, name="gyadft_")
      integer(c_int32_t), intent(in) :: n, maxlag
      real(c_double), intent(in), target :: x(*)
      real(c_double), intent(inout) :: stat, pval, crit(3)
      integer(c_int32_t), intent(inout) :: lag
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      type(series_type) :: series
      type(adf_options) :: options
      type(adf_type) :: result
      type(error_type), allocatable :: error

      info = 0
      if (n < 1) info = -1
      if (info == 0 .and. maxlag < -1) info = -3
      if (info /= 0) return
      call enter_library(host)
      options%max_lags = maxlag
      call open_series(c_loc(x(1)), int(n, c_int64_t), series, error)
      if (.not. allocated(error)) call test_adf(series%x, options, result, error, series%valid)
      call close_series(series)
      if (.not. allocated(error)) then
         stat = result%statistic
         pval = result%p_value
         crit = result%critical
         lag = int(result%lag, c_int32_t)
      end if
      info = leave_library(host, error)
   end subroutine gyadft

   !> CALL GYARFT(N, X, METHOD, MAXP, IP, PHI, VAR, XMEAN, INFO)
   subroutine gyarft(n, x, method, maxp, ip, phi, var, xmean, info) bind(C, name="gyarft_")
      integer(c_int32_t), intent(in) :: n, method, maxp
      real(c_double), intent(in), target :: x(*)
      integer(c_int32_t), intent(inout) :: ip
      real(c_double), intent(inout) :: phi(*), var, xmean
      integer(c_int32_t), intent(out) :: info
      type(host_type) :: host
      type(series_type) :: series
      type(ar_options) :: options
      type(ar_model_type) :: model
      type(error_type), allocatable :: error

      info = 0
      if (n < 1) info = -1
      if (info == 0 .and. (method < 1 .or. method > size(methods))) info = -3
      if (info == 0 .and. (maxp < 0 .or. maxp > largest_order)) info = -4
      if (info /= 0) return
      call enter_library(host)
      options%method = methods(method)
      options%max_order = maxp
      call open_series(c_loc(x(1)), int(n, c_int64_t), series, error)
      if (.not. allocated(error)) call fit_ar(series%x, options, model, error, series%valid)
      call close_series(series)
      if (.not. allocated(error)) then
         ip = int(model%order, c_int32_t)
         phi(:maxp) = 0
         phi(:model%order) = model%coefficient
         var = model%noise_variance
         xmean = model%mean
      end if
      info = leave_library(host, error)
   end subroutine gyarft

end module gyroakf_c_api_legacy
