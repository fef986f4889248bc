! SPDX-License-Identifier: MIT
!> The filters of the two families, made from a model: starts, bounds and scales in one place.
!>
!> The paper's family takes the AR(p) model of the series itself as the state and adds measurement
!> noise to it: `design_kf`, `design_akf`. The recommended family takes drift plus white noise as
!> identified from the record: `design_drift_kf`, `design_drift_akf`, with the model of
!> `identify_drift_model` (random walk, AR(1), both).
module gyroakf_filter_design
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_ar_roots, only : largest_modulus
   use gyroakf_filter_creation, only : shorten_burn_in
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_drift_identification, only : drift_identification_type
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, filter_type, new_filter
   implicit none (type, external)
   private
   public :: design_options, design_kf, design_akf
   public :: drift_options, design_drift_kf, design_drift_akf, adaptive_drift

   !> Bounds of Q in the paper's form, multiples of sigma_a^2. The form rests near 0.16 sigma_a^2 on
   !> an AR(1) series, so they act only on series of another kind.
   real(dp), parameter :: paper_q_bounds(2) = [0.02_dp, 10.0_dp]
   !> Its bounds of R: multiples of half the variance of the differences, and of the variance of the
   !> series
   real(dp), parameter :: paper_r_lower = 0.05_dp, paper_r_upper = 10.0_dp
   !> Bounds of R in the robust form, multiples of half the variance of the differences
   real(dp), parameter :: robust_r_bounds(2) = [0.01_dp, 100.0_dp]
   !> Gate of the robust form
   real(dp), parameter :: robust_huber = 2.5_dp

   !> The paper's family
   type :: design_options
      !> Form of the adaptive filter: "paper" or "robust"
      character(8) :: akf = "paper"
      !> R of the fixed filter over the variance of the series
      real(dp) :: r_factor = 1.0_dp
      !> Forgetting factor b of the adaptive filter
      real(dp) :: forgetting = 0.98_dp
      !> What it adapts: any subset of q, r, Q, R; "none"; blank: QR in the paper's form, R in the
      !> robust one
      character(4) :: estimate = " "
      !> Gate in standard deviations; 0: the form's own (paper: none, robust: 2.5)
      real(dp) :: huber = 0.0_dp
   end type design_options

   !> The recommended family
   type :: drift_options
      !> Forgetting factor b
      real(dp) :: forgetting = 0.995_dp
      !> Gate in standard deviations, 0: none
      real(dp) :: huber = 2.5_dp
   end type drift_options

contains

   !> The paper's fixed filter: Q the noise variance of the model, R = r_factor Var(z), the state
   !> stationary.
   !>
   !> A model of order 0 (white series) gives the filter with one zero coefficient, the limit of a
   !> small coefficient: x = K z, with K = 1/2 at r_factor 1.
   subroutine design_kf(model, options, filter, error)
      !> AR model of the series, as fit_ar makes it
      type(ar_model_type), intent(in) :: model
      !> r_factor > 0 is used
      type(design_options), intent(in) :: options
      !> The filter
      type(filter_type), intent(out) :: filter
      !> `constant_input`: the series has no variance; `unstable`: the model is not stationary, as
      !> least squares may give it; `invalid_argument`: r_factor; those of new_filter
      type(error_type), allocatable, intent(out) :: error
      type(filter_options) :: plain

      call check_model(model, error)
      if (allocated(error)) return
      if (.not. options%r_factor > 0.0_dp) then
         call fatal_error(error, status%invalid_argument, "the factor of R must be above zero")
         return
      end if
      call new_filter(filter, model%coefficient, model%noise_variance, &
         options%r_factor*model%variance, plain, error)
   end subroutine design_kf

   !> The paper's adaptive filter, or the robust form in its place.
   !>
   !> paper: Sage-Husa with the printed posterior in eq. (22), from Q = sigma_a^2, R = P = Var(z),
   !> x = 0. robust: R only, by residuals, burn-in, Huber's gate, from the same start with the
   !> stationary covariance.
   subroutine design_akf(model, difference_variance, options, filter, error)
      !> AR model of the series, as fit_ar makes it
      type(ar_model_type), intent(in) :: model
      !> Variance of the series' differences: half of it is the scale of R's bounds; 0: the model's
      !> own
      real(dp), intent(in) :: difference_variance
      !> Form, forgetting factor, what is adapted, gate
      type(design_options), intent(in) :: options
      !> The filter
      type(filter_type), intent(out) :: filter
      !> constant_input; unstable: the model is not stationary; invalid_argument: form, a letter of
      !> `estimate`; those of new_filter
      type(error_type), allocatable, intent(out) :: error
      type(filter_options) :: adaptive

      call check_model(model, error)
      if (allocated(error)) return
      adaptive%forgetting = options%forgetting
      adaptive%huber = options%huber
      adaptive%r_scale = 0.5_dp*difference_variance
      if (.not. difference_variance > 0.0_dp) adaptive%r_scale = model%variance
      select case (options%akf)
      case ("paper")
         adaptive%measurement_form = "paper"
         adaptive%initial_variance = model%variance
         adaptive%q_lower = paper_q_bounds(1)
         adaptive%q_upper = paper_q_bounds(2)
         adaptive%r_lower = paper_r_lower
         adaptive%r_upper = max(paper_r_lower, paper_r_upper*model%variance/adaptive%r_scale)
         call set_estimate(options%estimate, "QR", adaptive, error)
      case ("robust")
         adaptive%burn_in = -1
         adaptive%r_lower = robust_r_bounds(1)
         adaptive%r_upper = robust_r_bounds(2)
         if (.not. options%huber > 0.0_dp) adaptive%huber = robust_huber
         call set_estimate(options%estimate, "R", adaptive, error)
      case default
         call fatal_error(error, status%invalid_argument, "unknown form of the adaptive filter: " &
            //trim(options%akf)//" (paper, robust)")
      end select
      if (allocated(error)) return
      call new_filter(filter, model%coefficient, model%noise_variance, model%variance, adaptive, &
         error)
      if (allocated(error)) return
      call shorten_burn_in(filter, model%samples)
   end subroutine design_akf

   !> The fixed filter of drift plus white noise, with the identified values.
   subroutine design_drift_kf(drift, filter, error)
      !> As identify_drift_model found it
      type(drift_identification_type), intent(in) :: drift
      !> The filter; its output is the sum of the slow processes
      type(drift_filter_type), intent(out) :: filter
      !> `invalid_argument`: no drift was found; those of new_drift_filter
      type(error_type), allocatable, intent(out) :: error
      type(filter_options) :: plain

      call check_found(drift, error)
      if (allocated(error)) return
      call new_drift_filter(filter, drift%model, drift%slow(:drift%model%count), plain, error)
   end subroutine design_drift_kf

   !> The adaptive filter of drift plus white noise: R only, by residuals, burn-in, Huber's gate.
   !>
   !> The bounds of R hang on half the variance of the differences, never on the R it starts from: a
   !> wrong start is forgotten.
   subroutine design_drift_akf(drift, difference_variance, options, filter, error)
      !> As identify_drift_model found it
      type(drift_identification_type), intent(in) :: drift
      !> Variance of the series' differences; 0: that of the model
      real(dp), intent(in) :: difference_variance
      !> Forgetting factor and gate
      type(drift_options), intent(in) :: options
      !> The filter; its output is the sum of the slow processes
      type(drift_filter_type), intent(out) :: filter
      !> `invalid_argument`: no drift was found; those of new_drift_filter
      type(error_type), allocatable, intent(out) :: error

      call check_found(drift, error)
      if (allocated(error)) return
      call new_drift_filter(filter, drift%model, drift%slow(:drift%model%count), &
                            adaptive_drift(options, 0.5_dp*difference_variance), error)
      if (.not. allocated(error)) call shorten_burn_in(filter%filter_type, drift%of_samples)
   end subroutine design_drift_akf

   !> What an adaptive drift filter does; the smoother from both sides (`smooth_adaptive`) takes the
   !> same.
   pure function adaptive_drift(options, scale) result(adaptive)
      !> Forgetting factor and gate
      type(drift_options), intent(in) :: options
      !> Half the variance of the differences; 0: that of the model
      real(dp), intent(in) :: scale
      type(filter_options) :: adaptive

      adaptive%estimate_measurement_variance = .true.
      adaptive%forgetting = options%forgetting
      adaptive%huber = options%huber
      adaptive%burn_in = -1
      adaptive%r_scale = scale
      adaptive%r_lower = robust_r_bounds(1)
      adaptive%r_upper = robust_r_bounds(2)
   end function adaptive_drift

   !> Whether a series stands behind the model, and one that is stationary.
   subroutine check_model(model, error)
      type(ar_model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: largest
      character(24) :: digits
      logical :: stable

      if (.not. allocated(model%coefficient)) then
         call fatal_error(error, status%invalid_argument, &
            "a filter is designed from a fitted AR model; this one is empty")
      else if (.not. model%variance > 0.0_dp) then
         call fatal_error(error, status%constant_input, "a series without variance has no filter")
      end if
      if (allocated(error)) return
      stable = model%stationary
      if (size(model%coefficient) == 1) stable = stable .and. abs(model%coefficient(1)) < 1.0_dp
      if (stable) return
      largest = ""
      if (allocated(model%root)) then
         write (digits, "(f0.6)") largest_modulus(model%root)
         largest = ", its largest root has the modulus "//trim(digits)
      end if
      call fatal_error(error, status%unstable, "the AR model ("//trim(model%method) &
         //") is not stationary"//largest//": a filter of it would diverge; " &
         //"the methods yw and burg give stationary models")
   end subroutine check_model

   !> Whether a drift was identified.
   subroutine check_found(drift, error)
      type(drift_identification_type), intent(in) :: drift
      type(error_type), allocatable, intent(out) :: error

      if (.not. drift%found) call fatal_error(error, status%invalid_argument, &
         "no drift slower than the limit was identified: there is nothing to filter")
   end subroutine check_found

   !> Flags from letters.
   subroutine set_estimate(letters, usual, options, error)
      !> Letters of q, r, Q, R, in any order; "none"; blank
      character(*), intent(in) :: letters
      character(*), intent(in) :: usual
      type(filter_options), intent(inout) :: options
      type(error_type), allocatable, intent(out) :: error
      character(len(letters) + len(usual)) :: chosen
      integer :: i

      chosen = letters
      if (letters == " ") chosen = usual
      if (letters == "none") return
      ! who names q and r wants both; the warnings say what that means
      options%allow_unobservable = .true.
      do i = 1, len_trim(chosen)
         select case (chosen(i:i))
         case ("q"); options%estimate_process_mean = .true.
         case ("r"); options%estimate_measurement_mean = .true.
         case ("Q"); options%estimate_process_variance = .true.
         case ("R"); options%estimate_measurement_variance = .true.
         case (" ")
         case default
            call fatal_error(error, status%invalid_argument, &
               "an adaptive filter estimates any of q, r, Q, R, not '"//chosen(i:i)//"'")
            return
         end select
      end do
   end subroutine set_estimate
end module gyroakf_filter_design
