! SPDX-License-Identifier: MIT
!> FORTRAN 77: the series without its outliers and trend, and the filters of the program, which the
!> library keeps; IH(2) holds them. The arguments are described in c_api/README.md; INFO as in
!> [[gyroakf_c_api_legacy(module)]].
module gyroakf_c_api_legacy_filters
   use, intrinsic :: iso_c_binding, only : c_int32_t, c_int64_t, c_char, c_double, c_loc, &
      & c_null_char, c_null_ptr, c_ptr
   use gyroakf_c_api_c_design, only : gyroakf_filter_identify, kinds
   use gyroakf_c_api_c_filter, only : gyroakf_filter_free, gyroakf_filter_freeze, &
      & gyroakf_filter_step
   use gyroakf_c_api_c_outliers, only : gyroakf_clean, gyroakf_outlier_options_init, &
      & outlier_options_c, outliers_c
   use gyroakf_c_api_legacy, only : first_bad
   implicit none (type, external)
   private
   public :: gyclen, gyfdes, gyhstp, gyhfrz, gyhfre

contains

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
      character(len(kinds) + 1, kind=c_char), target :: name
      type(c_ptr) :: handle

      ih = 0
      info = first_bad([n < 1, .false., .false., kind < 1 .or. kind > size(kinds)])
      if (info /= 0) return
      name = trim(kinds(kind))//c_null_char
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

end module gyroakf_c_api_legacy_filters
