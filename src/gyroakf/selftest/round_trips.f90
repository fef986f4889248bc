! SPDX-License-Identifier: MIT
!> Records with known noise, identified again: every coefficient within four of the standard errors that the library states for it.
!>
!> The records come from fixed seeds, so that the outcome does not depend on luck.
module gyroakf_selftest_round_trips
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use gyroakf_filter_drift_identification, only : drift_identification_options, drift_identification_type, identify_drift_model
   use gyroakf_record, only : record_type
   use gyroakf_simulate_record, only : simulate_options, simulate_record
   use gyroakf_selftest_types, only : selftest_type, begin_group, add_check, add_failure
   implicit none (type, external)
   private
   public :: check_round_trips

   !> Standard errors that an estimate may be off by: chance does it in one of sixteen thousand
   real(dp), parameter :: errors_allowed = 4.0_dp
   !> Samples a second
   real(dp), parameter :: rate_hz = 10.0_dp
   character(5), parameter :: letters = "QNBKR"

contains

   !> All of them.
   subroutine check_round_trips(result)
      !> The checks are added
      type(selftest_type), intent(inout) :: result

      call begin_group(result, "simulated and identified")
      call check_noise(result, [0.05_dp, 0.01_dp, 0.0_dp, 0.0_dp, 0.0_dp], 100000_int64, 11_int64)
      call check_noise(result, [0.0_dp, 0.01_dp, 0.0_dp, 0.0_dp, 0.0_dp], 100000_int64, 12_int64)
      call check_noise(result, [0.0_dp, 0.01_dp, 0.005_dp, 0.0_dp, 0.0_dp], 200000_int64, 13_int64)
      call check_noise(result, [0.0_dp, 0.01_dp, 0.0_dp, 0.001_dp, 0.0_dp], 100000_int64, 14_int64)
      call check_noise(result, [0.0_dp, 0.01_dp, 0.0_dp, 0.0_dp, 1.0e-5_dp], 100000_int64, 15_int64)
      call check_ar(result)
      call check_drift(result)
   end subroutine check_round_trips

   !> Noise terms through the Allan deviation.
   subroutine check_noise(result, coefficient, samples, seed)
      type(selftest_type), intent(inout) :: result
      !> Q N B K R, 0: it is not there
      real(dp), intent(in) :: coefficient(5)
      integer(int64), intent(in) :: samples, seed
      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: error
      character(5) :: terms
      integer :: term

      terms = ""
      do term = 1, 5
         if (coefficient(term) > 0.0_dp) terms = trim(terms)//letters(term:term)
      end do
      options%samples = samples
      options%seed = seed
      options%rate_hz = rate_hz
      options%coefficient = coefficient
      call simulate_record(options, record, error)
      if (.not. allocated(error)) call compute_allan(record%value(:, 1), 1.0_dp/rate_hz, allan_options(), curve, error)
      if (.not. allocated(error)) call fit_noise(curve, noise_options(), noise, error)
      if (allocated(error)) then
         call add_failure(result, trim(terms)//" identified", error)
         return
      end if
      do term = 1, 5
         call check_term(result, trim(terms), term, coefficient(term), noise)
      end do
   end subroutine check_noise

   !> A term that is there is detected and has its value; one that is not is not detected.
   subroutine check_term(result, terms, term, coefficient, noise)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: terms
      integer, intent(in) :: term
      real(dp), intent(in) :: coefficient
      type(noise_type), intent(in) :: noise
      character(1) :: letter

      letter = letters(term:term)
      associate (found => noise%coefficient(term))
         if (coefficient > 0.0_dp .and. found%detected) then
            call add_check(result, letter//" of a record of "//terms, coefficient, found%value, errors_allowed*found%std_error)
         else if (coefficient > 0.0_dp) then
            call add_check(result, letter//" of a record of "//terms//", detected", 1.0_dp, 0.0_dp, 0.0_dp)
         else if (found%detected) then
            call add_check(result, letter//" of a record of "//terms//", invented", 0.0_dp, found%value, 0.0_dp)
         end if
      end associate
   end subroutine check_term

   !> An AR(2) process: coefficients, their number and the variance of what drives it.
   subroutine check_ar(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: phi(2) = [0.7_dp, -0.2_dp], variance = 1.0e-4_dp
      type(simulate_options) :: options
      type(record_type) :: record
      type(ar_options) :: ar
      type(ar_model_type) :: model
      type(error_type), allocatable :: error
      real(dp) :: driving

      options%samples = 50000
      options%seed = 21
      options%ar = phi
      options%ar_variance = variance
      call simulate_record(options, record, error)
      ar%criterion = "bic"
      ar%max_order = 6
      if (.not. allocated(error)) call fit_ar(record%value(:, 1), ar, model, error)
      if (allocated(error)) then
         call add_failure(result, "AR(2) identified", error)
         return
      end if
      call add_check(result, "order of AR(2) by BIC", 2.0_dp, real(model%order, dp), 0.0_dp)
      if (model%order /= 2) return
      call add_check(result, "AR(2), first coefficient", phi(1), model%coefficient(1), errors_allowed*model%std_error(1))
      call add_check(result, "AR(2), second coefficient", phi(2), model%coefficient(2), errors_allowed*model%std_error(2))
      ! r(0) (1 - phi_2) ((1 + phi_2)^2 ... as a product of 1 - k^2 over the reflection coefficients
      driving = variance*(1.0_dp - (phi(1)/(1.0_dp - phi(2)))**2)*(1.0_dp - phi(2)**2)
      call add_check(result, "AR(2), variance of its noise", driving, model%noise_variance, &
                     errors_allowed*driving*sqrt(2.0_dp/real(options%samples, dp)))
   end subroutine check_ar

   !> A drift in white noise by its likelihood: a Markov process, and a random walk.
   subroutine check_drift(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: n = 0.01_dp, phi = 0.99_dp, variance = 4.0e-4_dp, k = 0.005_dp
      type(simulate_options) :: options
      type(drift_identification_type) :: found

      options%samples = 30000
      options%seed = 31
      options%rate_hz = rate_hz
      options%coefficient(2) = n
      options%ar = [phi]
      options%ar_variance = variance
      if (identified(result, options, "ar1", found)) then
         call add_check(result, "Markov drift, its coefficient", phi, found%model%phi(1), errors_allowed*found%std_error%phi(1))
         call add_check(result, "Markov drift, what drives it", variance*(1.0_dp - phi**2), found%model%q(1), &
                        errors_allowed*found%std_error%q(1))
         call add_check(result, "Markov drift, its white noise", n**2*rate_hz, found%model%r, errors_allowed*found%std_error%r)
      end if
      deallocate (options%ar)
      options%ar_variance = 0.0_dp
      options%coefficient(4) = k
      options%seed = 32
      if (identified(result, options, "walk", found)) then
         call add_check(result, "random walk, its steps", k**2/rate_hz, found%model%q(1), errors_allowed*found%std_error%q(1))
         ! a rate is the mean over its interval: next to N^2/t0 that adds less than a thousandth
         call add_check(result, "random walk, its white noise", n**2*rate_hz, found%model%r, errors_allowed*found%std_error%r)
      end if
   end subroutine check_drift

   !> Identifies the drift of a simulated record; a check that failed where another kind of drift was found.
   logical function identified(result, options, name, found)
      type(selftest_type), intent(inout) :: result
      type(simulate_options), intent(in) :: options
      !> What should be found
      character(*), intent(in) :: name
      type(drift_identification_type), intent(out) :: found
      type(record_type) :: record
      type(error_type), allocatable :: error

      identified = .false.
      call simulate_record(options, record, error)
      if (.not. allocated(error)) then
         call identify_drift_model(record%value(:, 1), drift_identification_options(), found, error)
      end if
      if (allocated(error)) then
         call add_failure(result, name//" identified", error)
         return
      end if
      identified = found%found .and. found%name == name .and. found%errors_known
      if (.not. identified) call add_check(result, name//", the kind of drift", 1.0_dp, 0.0_dp, 0.0_dp)
   end function identified

end module gyroakf_selftest_round_trips
