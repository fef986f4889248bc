! SPDX-License-Identifier: MIT
!> The members of a channel in the JSON document.
module gyroakf_report_document_parts
   use gyroakf_kinds, only : dp
   use gyroakf_units, only : term_names
   use gyroakf_io_writer, only : writer_type
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_halves, only : halves_type
   use gyroakf_pipeline_result, only : channel_result_type, allan_result_type, stated_read_off_type, stage, stage_names
   use gyroakf_report_document_ar, only : put_ar_members
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null, flush_json
   use gyroakf_report_document_distribution, only : put_distribution
   use gyroakf_report_document_periodicity, only : put_fisher, put_welch
   use gyroakf_report_document_stated, only : put_stated, put_densities, put_known, put_description, put_unquantized
   use gyroakf_report_document_adf, only : put_adf_regression
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_document_correlation, only : put_kpss, put_ljung_box
   implicit none (type, external)
   private
   public :: put_verdict, put_tests, put_ar, put_allan, put_coefficients

contains

   !> "verdict": null where none was looked for.
   subroutine put_verdict(json, record, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> For the units
      type(record_type), intent(in) :: record
      !> One channel
      type(channel_result_type), intent(in) :: channel
      type(text_type), allocatable :: reasons(:)

      if (.not. channel%verdict%wanted) then
         call put_null(json, "verdict")
         return
      end if
      allocate (reasons(0))
      if (allocated(channel%verdict%reasons)) reasons = channel%verdict%reasons
      associate (verdict => channel%verdict)
         call open_object(json, "verdict")
         if (verdict%stationary .or. verdict%drifts) then
            call put_member(json, "stationary", verdict%stationary)
         else
            call put_null(json, "stationary")
         end if
         call put_member(json, "drift", trim(verdict%drift))
         if (verdict%trend%shape == "") then
            call put_null(json, "trend")
         else
            call open_object(json, "trend")
            call put_member(json, "shape", trim(merge("ramp   ", "warm_up", verdict%trend%shape == "ramp")))
            call put_member(json, "size", verdict%trend%size)
            call put_member(json, "std_error", verdict%trend%std_error)
            call put_known(json, "time_constant_s", verdict%trend%time_constant*record%sample_interval, &
                           verdict%trend%shape /= "ramp" .and. record%rate_known)
            call put_member(json, "gain", verdict%trend%gain)
            call close_object(json)
         end if
         call put_member(json, "reasons", reasons)
         call close_object(json)
      end associate
   end subroutine put_verdict

   !> "tests".
   subroutine put_tests(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel

      call open_object(json, "tests")
      call put_member(json, "series", trim(channel%tested))
      call put_adf(json, channel)
      call put_kpss(json, channel)
      if (channel%available%jarque_bera) then
         call open_object(json, "jarque_bera")
         call put_member(json, "statistic", channel%jarque_bera%statistic)
         call put_member(json, "p_value", channel%jarque_bera%p_value)
         call put_member(json, "skewness", channel%jarque_bera%skewness)
         call put_member(json, "kurtosis", channel%jarque_bera%kurtosis)
         call put_member(json, "skewness_std_error", channel%jarque_bera%skewness_error)
         call put_member(json, "kurtosis_std_error", channel%jarque_bera%kurtosis_error)
         call close_object(json)
      else
         call put_null(json, "jarque_bera")
      end if
      call put_ljung_box(json, "ljung_box", channel%ljung_box, channel%available%ljung_box)
      call put_fisher(json, channel)
      call put_distribution(json, channel)
      call put_welch(json, channel)
      call close_object(json)
   end subroutine put_tests

   !> "adf".
   subroutine put_adf(json, channel)
      type(json_type), intent(inout) :: json
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%adf) then
         call put_null(json, "adf")
         return
      end if
      call open_object(json, "adf")
      call put_member(json, "statistic", channel%adf%statistic)
      call put_member(json, "p_value", channel%adf%p_value)
      call put_member(json, "lag", channel%adf%lag)
      call put_member(json, "observations", channel%adf%observations)
      call put_member(json, "regression", trim(channel%adf%regression))
      call open_object(json, "critical")
      call put_member(json, "1%", channel%adf%critical(1))
      call put_member(json, "5%", channel%adf%critical(2))
      call put_member(json, "10%", channel%adf%critical(3))
      call close_object(json)
      call put_member(json, "stationary", channel%adf%stationary)
      call put_adf_regression(json, channel%adf)
      call close_object(json)
   end subroutine put_adf

   !> "ar".
   subroutine put_ar(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%available%ar) then
         call put_null(json, "ar")
         return
      end if
      call open_object(json, "ar")
      call put_member(json, "method", trim(channel%ar%method))
      call put_member(json, "criterion", trim(channel%ar%criterion))
      call put_member(json, "order", channel%ar%order)
      call put_member(json, "coefficients", channel%ar%coefficient)
      call put_member(json, "std_errors", channel%ar%std_error)
      call put_member(json, "noise_variance", channel%ar%noise_variance)
      call put_member(json, "mean", channel%ar%mean)
      call open_array(json, "table")
      do i = lbound(channel%ar%table, 1), ubound(channel%ar%table, 1)
         call open_object(json)
         call put_member(json, "order", channel%ar%table(i)%order)
         call put_member(json, "noise_variance", channel%ar%table(i)%noise_variance)
         call put_member(json, "aic", channel%ar%table(i)%aic)
         call put_member(json, "aicc", channel%ar%table(i)%aicc)
         call put_member(json, "bic", channel%ar%table(i)%bic)
         call put_member(json, "hqic", channel%ar%table(i)%hqic)
         call put_member(json, "fpe", channel%ar%table(i)%fpe)
         call put_member(json, "aic_per_observation", channel%ar%table(i)%aic_per_observation)
         call close_object(json)
      end do
      call close_array(json)
      call put_ljung_box(json, "residual_ljung_box", channel%ar%residual_ljung_box, channel%ar%residual_ljung_box%lags > 0)
      call put_ar_members(json, channel%ar)
      call close_object(json)
   end subroutine put_ar

   !> "allan".
   subroutine put_allan(json, writer, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> Takes what is written, curve by curve
      type(writer_type), intent(inout) :: writer
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: which

      call open_object(json, "allan")
      do which = stage%input, stage%compensated
         associate (allan => channel%allan(which))
            if (.not. allan%available) then
               call put_null(json, trim(stage_names(which)))
               cycle
            end if
            call open_object(json, trim(stage_names(which)))
            call put_curve(json, allan%curve)
            if (allocated(allan%other)) then
               call put_other_kinds(json, allan%other)
            else
               call put_null(json, "other_kinds")
            end if
            call close_object(json)
            call flush_json(json, writer)
         end associate
      end do
      if (channel%available%halves) then
         call put_halves(json, channel%halves)
      else
         call put_null(json, "halves")
      end if
      call close_object(json)
   end subroutine put_allan

   !> "halves": the second half of the record against the first.
   subroutine put_halves(json, halves)
      !> The document
      type(json_type), intent(inout) :: json
      !> The comparison
      type(halves_type), intent(in) :: halves

      call open_object(json, "halves")
      call put_member(json, "statistic", halves%statistic)
      call put_member(json, "freedom", halves%freedom)
      call put_member(json, "p_value", halves%p_value)
      call put_member(json, "tau_s", halves%tau)
      call put_member(json, "ratio", halves%ratio)
      call put_member(json, "lower", halves%lower)
      call put_member(json, "upper", halves%upper)
      call close_object(json)
   end subroutine put_halves

   !> Members of a curve.
   subroutine put_curve(json, curve)
      !> The document
      type(json_type), intent(inout) :: json
      !> The curve
      type(allan_curve_type), intent(in) :: curve

      call put_member(json, "kind", trim(curve%kind))
      call put_member(json, "tau_s", curve%tau)
      call put_member(json, "deviation", curve%deviation)
      call put_member(json, "lower", curve%lower)
      call put_member(json, "upper", curve%upper)
      call put_member(json, "edf", curve%edf)
      call put_member(json, "terms", curve%terms)
   end subroutine put_curve

   !> "other_kinds": the curves of the further kinds, each under its name.
   subroutine put_other_kinds(json, curves)
      !> The document
      type(json_type), intent(inout) :: json
      !> The curves; those that could not be computed are left out
      type(allan_curve_type), intent(in) :: curves(:)
      integer :: i

      call open_object(json, "other_kinds")
      do i = 1, size(curves)
         if (.not. allocated(curves(i)%tau)) cycle
         call open_object(json, trim(curves(i)%kind))
         call put_curve(json, curves(i))
         call put_null(json, "other_kinds")
         call close_object(json)
      end do
      call close_object(json)
   end subroutine put_other_kinds

   !> "coefficients".
   subroutine put_coefficients(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: which, term

      call open_object(json, "coefficients")
      do which = stage%input, stage%compensated
         call put_noise(json, trim(stage_names(which)), channel%allan(which))
      end do
      call open_object(json, "reduction_percent")
      do term = 1, 5
         if (channel%reduction_known(term)) then
            call put_member(json, term_names(term), channel%reduction_percent(term))
         else
            call put_null(json, term_names(term))
         end if
      end do
      call close_object(json)
      call close_object(json)
   end subroutine put_coefficients

   !> The coefficients of one series; the numbers of a term that was not fitted are null.
   subroutine put_noise(json, key, allan)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      type(allan_result_type), intent(in) :: allan
      integer :: term

      if (.not. allan%fitted) then
         call put_null(json, key)
         return
      end if
      call open_object(json, key)
      do term = 1, 5
         call put_stated(json, term_names(term), allan%stated%term(term), allan%stated%in_units)
      end do
      call put_unquantized(json, allan%stated)
      call put_member(json, "chi2_reduced", allan%noise%chi2_reduced)
      call put_read_off(json, allan%read_off)
      call put_densities(json, allan%stated)
      call put_description(json, allan%noise)
      call close_object(json)
   end subroutine put_noise

   !> "read_off": what the curve alone says, null where there is no segment.
   subroutine put_read_off(json, read_off)
      type(json_type), intent(inout) :: json
      type(stated_read_off_type), intent(in) :: read_off
      integer :: term

      call open_object(json, "read_off")
      do term = 1, 5
         call put_known(json, term_names(term), read_off%value(term), read_off%found(term))
      end do
      call put_known(json, "minimum", read_off%minimum, read_off%known)
      call put_known(json, "minimum_tau_s", read_off%minimum_tau, read_off%known)
      call put_member(json, "falling", read_off%falling)
      call close_object(json)
   end subroutine put_read_off

end module gyroakf_report_document_parts
