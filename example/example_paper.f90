! SPDX-License-Identifier: MIT
!> Tables I, II and III of the paper beside what its own model gives in closed form and what its chain gives on a record with known
!> noise. What differs, and why, is said in doc/paper.md.
program example_paper
   use gyroakf, only : dp, error_type, record_type, paper_preset, paper_seed, simulate_record, pipeline_options, &
      pipeline_result_type, apply_preset, run_pipeline, steady_state, dc_gain, output_variance_ratio, stage
   implicit none (type, external)
   !> Of the paper: coefficient, variance of the series, samples
   real(dp), parameter :: phi = 0.409975_dp, variance = 5.24e-4_dp, samples = 12000.0_dp
   !> The multiple of that variance as R with which a fixed filter gives the paper's adaptive one
   real(dp), parameter :: r_factor = 9.84_dp
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(pipeline_options) :: options
   type(pipeline_result_type) :: paper, large_r

   call simulate_record(paper_preset(paper_seed), record, error)
   if (.not. allocated(error)) call apply_preset("paper", options, error)
   if (.not. allocated(error)) call run_pipeline(record, options, paper, error)
   options%design%r_factor = r_factor
   if (.not. allocated(error)) call run_pipeline(record, options, large_r, error)
   if (allocated(error)) error stop error%message
   call print_orders()
   call print_filters()
   call print_coefficients()

contains

   !> Table I: AIC as EViews states it, (-2 ln L + 2 p)/n = 1 + ln(2 pi) + ln(sigma_a^2) + 2 p/n
   subroutine print_orders()
      real(dp), parameter :: log_two_pi = 1.8378770664093454_dp
      real(dp) :: theory(3)
      integer :: p

      print "(a)", "Table I. AIC per observation", &
         "                           paper  closed form    simulated"
      do p = 1, 3
         theory(p) = 1 + log_two_pi + log(variance*(1 - phi**2)) + 2*p/samples
         associate (line => paper%channel(1)%ar%table(p + 1))
            if (p == 1) then
               print "(a, i0, a, f13.4, 2f13.5)", "  AR(", p, ")            ", -4.8930_dp, theory(p), line%aic_per_observation
            else
               print "(a, i0, a, a13, 2f13.5)", "  AR(", p, ")            ", "", theory(p), line%aic_per_observation
            end if
         end associate
      end do
      associate (line => paper%channel(1)%ar%table)
         print "(a, 3f13.5)", "  from AR(2) to AR(3)", 0.0017_dp, theory(3) - theory(2), &
            line(4)%aic_per_observation - line(3)%aic_per_observation
      end associate
      print "(a, f26.5)", "  at most 2/n        ", 2/samples
   end subroutine print_orders

   !> Table II: variance and mean before and after the filters, and the share of a constant rotation that passes
   subroutine print_filters()
      print "(/, a, /, a)", "Table II. Variance (deg/s)^2, DC gain, mean (deg/s)", &
         "                           paper  closed form    simulated  DC gain        mean"
      associate (as_is => paper%channel(1), other => large_r%channel(1))
         print "(a, 3es13.3, f9.4)", "  series             ", variance, variance, as_is%cleaned%variance, 1.0_dp
         print "(a, 3es13.3, f9.4, es12.2)", "  KF, R = var        ", 1.48e-4_dp, fixed_variance(1.0_dp), as_is%kf%variance, &
            as_is%kf%dc_gain, as_is%kf%mean
         print "(a, 3es13.3, f9.4, es12.2)", "  KF, R = 9.84 var   ", 6.82e-6_dp, fixed_variance(r_factor), other%kf%variance, &
            other%kf%dc_gain, other%kf%mean
         print "(a, es13.3, a13, es13.3, f9.4, es12.2)", "  Sage-Husa on Q, R  ", 6.82e-6_dp, "", as_is%akf%variance, &
            as_is%akf%dc_gain, as_is%akf%mean
      end associate
      print "(a, 13x, es13.3, 13x, f9.4)", "  mean of 25 samples ", mean_variance(25), 1.0_dp
      print "(a, es13.2)", "  KF mean, paper     ", 8.9e-7_dp
      print "(a, es13.2)", "  the DC gain's share", fixed_gain(1.0_dp)*2.74e-5_dp
   end subroutine print_filters

   !> Table III: reductions in percent; what lies beyond the filter's memory shrinks by its DC gain, N, B, K and R alike
   subroutine print_coefficients()
      character(1), parameter :: name(5) = ["Q", "N", "B", "K", "R"]
      real(dp), parameter :: printed(5) = [86.0_dp, 88.0_dp, 79.0_dp, 65.0_dp, 71.0_dp]
      integer :: i

      print "(/, a, /, a)", "Table III. Reduction of the coefficients in per cent", &
         "                           paper     1 - DC gain, R = 9.84 var    Sage-Husa, simulated"
      do i = 1, 5
         associate (channel => paper%channel(1))
            if (channel%reduction_known(i)) then
               print "(a, f13.0, f30.1, f24.1)", "  "//name(i)//"                  ", printed(i), &
                  100*(1 - fixed_gain(r_factor)), channel%reduction_percent(i)
            else if (i == 1) then
               print "(a, f13.0, 30x, a24)", "  "//name(i)//"                  ", printed(i), "not detected"
            else
               print "(a, f13.0, f30.1, a24)", "  "//name(i)//"                  ", printed(i), &
                  100*(1 - fixed_gain(r_factor)), "not detected"
            end if
         end associate
      end do
      associate (before => paper%channel(1)%allan(stage%cleaned)%stated%term(2))
         print "(a, f6.3, a, f6.3, a, f6.3)", "  N in deg/sqrt(h): printed", 0.000365_dp*3600, ", of the AR(1) process", &
            60*sqrt(variance*0.2_dp*(1 + phi)/(1 - phi)), ", fitted", before%value
      end associate
   end subroutine print_coefficients

   !> Variance of the paper's fixed filter on its own AR(1) series
   real(dp) function fixed_variance(factor)
      !> R over the variance of the series
      real(dp), intent(in) :: factor
      real(dp) :: gain(1), prior(1, 1), ratio

      call steady_state([phi], 1 - phi**2, factor, gain, prior, error)
      if (.not. allocated(error)) call output_variance_ratio([phi], gain, ratio, error)
      if (allocated(error)) error stop error%message
      fixed_variance = variance*ratio
   end function fixed_variance

   !> Variance of the mean of so many successive samples of that series
   real(dp) function mean_variance(m)
      !> Their number
      integer, intent(in) :: m

      mean_variance = variance/m*((1 + phi)/(1 - phi) - 2*phi*(1 - phi**m)/(m*(1 - phi)**2))
   end function mean_variance

   !> The DC gain of that filter
   real(dp) function fixed_gain(factor)
      !> R over the variance of the series
      real(dp), intent(in) :: factor
      real(dp) :: gain(1), prior(1, 1)

      call steady_state([phi], 1 - phi**2, factor, gain, prior, error)
      if (allocated(error)) error stop error%message
      fixed_gain = dc_gain([phi], gain)
   end function fixed_gain
end program example_paper
