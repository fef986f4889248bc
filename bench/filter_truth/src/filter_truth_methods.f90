! SPDX-License-Identifier: MIT
!> What is compared: each method makes a drift out of a record that it has never seen, and knows nothing but the record.
module filter_truth_methods
   use, intrinsic :: iso_fortran_env, only : error_unit
   use gyroakf, only : ar_model_type, ar_options, clean_options, clean_series, clean_type, component_model_type, design_akf, &
      & design_kf, design_options, dp, error_type, evaluate_trend, filter_options, filter_result_type, filter_series, &
      & drift_filter_type, filter_type, fit_ar, identify_drift_model, int64, drift_identification_options, &
      & drift_identification_type, new_drift_filter, smooth_adaptive, smooth_drift
   use filter_truth_innovation_window, only : filter_innovation_window, innovation_window_options
   use filter_truth_variational_bayes, only : filter_variational_bayes, variational_options
   use gyroakf_kinds, only : int8
   use gyroakf_stats_differences, only : difference_variance
   implicit none (type, external)
   private
   public :: method_names, methods, is_causal, is_filter, judged_type, prepared_type, prepare, run_method, drift_akf_options

   !> Rows of the tables: the last ones see the whole record before they say anything of its first sample
   integer, parameter :: methods = 10, causal_methods = 7, filters = 5
   character(32), parameter :: method_names(methods) = [character(32) :: "paper KF", "paper AKF", "AR(p), R only, robust", &
      & "drift_kf", "drift_akf", "innovation window of 100", "variational Bayes, 0.98", "cubic trend", "smoother, plain", &
      & "drift_smoother (two passes)"]

   !> What a filter says of itself
   type :: judged_type
      real(dp) :: nis = 0, rho = 0, p_value = 1
   end type judged_type

   !> A record as every method receives it
   type :: prepared_type
      !> Less its mean; cleaned of trend and outliers
      real(dp), allocatable :: z(:), cleaned(:)
      !> 1 present, 0 outlier
      integer(int8), allocatable :: here(:)
      real(dp) :: mean = 0
      !> The cubic, [n]
      real(dp), allocatable :: trend(:)
      type(ar_model_type) :: ar
      type(drift_identification_type) :: drift
      type(error_type), allocatable :: no_drift
   end type prepared_type

contains

   !> Whether a method uses nothing that comes later, its model apart.
   elemental logical function is_causal(method)
      integer, intent(in) :: method

      is_causal = method <= causal_methods
   end function is_causal

   !> Whether it tells its innovations.
   elemental logical function is_filter(method)
      integer, intent(in) :: method

      is_filter = method <= filters
   end function is_filter

   !> Outliers, trend, AR(p) by AIC, drift model.
   subroutine prepare(z, record)
      real(dp), intent(in), contiguous :: z(:)
      type(prepared_type), intent(out) :: record
      type(clean_type) :: removed
      type(error_type), allocatable :: error
      integer(int64) :: k

      call clean_series(z, clean_options(), record%cleaned, record%here, removed, error)
      if (allocated(error)) error stop error%message
      if (.not. allocated(record%here)) allocate (record%here(size(z)), source=1_int8)
      record%trend = [(evaluate_trend(removed%trend, k), k=0, size(z) - 1)]
      record%mean = sum(z, mask=record%here /= 0)/count(record%here /= 0)
      record%z = z - record%mean
      call fit_ar(record%cleaned, ar_options(), record%ar, error, record%here)
      if (allocated(error)) error stop error%message
      call identify_drift_model(record%z, drift_identification_options(), record%drift, record%no_drift, record%here)
   end subroutine prepare

   !> The drift that a method finds; where it fails the mean of the record, and the message goes to standard error.
   subroutine run_method(method, record, x, judged)
      integer, intent(in) :: method
      type(prepared_type), intent(in) :: record
      !> [n]
      real(dp), intent(out), contiguous :: x(:)
      type(judged_type), intent(out) :: judged
      type(error_type), allocatable :: error

      select case (method_names(method))
      case ("cubic trend"); x = record%trend
      case ("paper KF", "paper AKF", "AR(p), R only, robust"); call run_paper(method, record, x, judged, error)
      case default
         if (record%drift%found) then
            call run_drift(method, record, x, judged, error)
         else
            x = 0.0_dp
         end if
         x = x + record%mean
      end select
      if (.not. allocated(error)) return
      write (error_unit, "(3a)") trim(method_names(method)), ": ", error%message
      x = record%mean
   end subroutine run_method

   !> The paper's family, on the cleaned series; the cubic comes back afterwards.
   subroutine run_paper(method, record, x, judged, error)
      integer, intent(in) :: method
      type(prepared_type), intent(in) :: record
      real(dp), intent(out), contiguous :: x(:)
      type(judged_type), intent(inout) :: judged
      type(error_type), allocatable, intent(out) :: error
      type(filter_type) :: filter
      type(design_options) :: options

      select case (method_names(method))
      case ("paper KF")
         call design_kf(record%ar, options, filter, error)
      case default
         if (method_names(method) /= "paper AKF") options%akf = "robust"
         call design_akf(record%ar, difference_variance(record%cleaned, record%here), options, filter, error)
      end select
      if (.not. allocated(error)) call run_filter_on(filter, record%cleaned, record%here, x, judged, error)
      x = x + record%trend
   end subroutine run_paper

   !> The drift's family.
   subroutine run_drift(method, record, x, judged, error)
      integer, intent(in) :: method
      type(prepared_type), intent(in) :: record
      real(dp), intent(out), contiguous :: x(:)
      type(judged_type), intent(inout) :: judged
      type(error_type), allocatable, intent(out) :: error
      type(drift_filter_type) :: filter
      type(filter_options) :: options

      associate (model => record%drift%model, slow => record%drift%slow(:record%drift%model%count))
         if (index(method_names(method), "akf") + index(method_names(method), "two passes") > 0) then
            options = drift_akf_options(record)
         end if
         select case (method_names(method))
         case ("smoother, plain")
            call smooth_drift(model, slow, record%z, x, error, record%here)
         case ("drift_smoother (two passes)")
            call smooth_adaptive(model, slow, options, record%z, x, error, record%here)
         case ("innovation window of 100")
            call filter_innovation_window(model, slow, innovation_window_options(r_scale=0.5_dp*difference_variance(record%z, &
                                          record%here)), record%z, x, error, record%here)
         case ("variational Bayes, 0.98")
            call filter_variational_bayes(model, slow, variational_options(), record%z, x, error, record%here)
         case default
            call new_drift_filter(filter, model, slow, options, error)
            if (.not. allocated(error)) call run_filter_on(filter, record%z, record%here, x, judged, error)
         end select
      end associate
   end subroutine run_drift

   !> Options of drift_akf: R only, by residuals.
   function drift_akf_options(record) result(options)
      type(prepared_type), intent(in) :: record
      type(filter_options) :: options

      options%estimate_measurement_variance = .true.
      options%forgetting = 0.995_dp
      options%huber = 2.5_dp
      options%burn_in = -1
      options%r_scale = 0.5_dp*difference_variance(record%z, record%here)
   end function drift_akf_options

   !> The filter over the series, and what its innovations say.
   subroutine run_filter_on(filter, z, here, x, judged, error)
      class(filter_type), intent(inout) :: filter
      real(dp), intent(in), contiguous :: z(:)
      integer(int8), intent(in), contiguous :: here(:)
      real(dp), intent(out), contiguous :: x(:)
      type(judged_type), intent(out) :: judged
      type(error_type), allocatable, intent(out) :: error
      type(filter_result_type) :: result

      call filter_series(filter, z, x, result, error, here)
      if (allocated(error)) return
      judged = judged_type(result%nis_mean, result%ljung_box%largest_rho, result%ljung_box%p_value)
   end subroutine run_filter_on
end module filter_truth_methods
