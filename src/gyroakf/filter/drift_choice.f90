! SPDX-License-Identifier: MIT
!> Which of the fitted models is taken, and which of its processes are drift.
!>
!> AIC compares the models; what is drift is what is slower than a limit. Something slow is found
!> where the best model is better than the best one without anything slow, white noise alone among
!> them, by 8 of AIC, and its process is larger than its standard error. Of 300 records of white
!> noise (2000 samples) one passes, of 300 of AR(1) noise with phi = 0.41 none, of 300 of AR(1)
!> noise with phi = 0.6 in as much white noise none (`bench/filter_truth/run.sh alarms`).
!>
!> Source: Akaike, IEEE Trans. Autom. Control 19 (1974) 716-723; Self & Liang, J. Am. Stat. Assoc.
!> 82 (1987) 605-610 (the edge).
module gyroakf_filter_drift_choice
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_components, only : component_model_type, most_components
   use gyroakf_filter_drift_fit, only : drift_candidate_type, drift_fit_type, is_slow
   implicit none (type, external)
   private
   public :: drift_identification_options, drift_identification_type, choose_model, set_model, &
      state_numbers, aic_margin

   !> What is asked for
   type :: drift_identification_options
      !> Correlation time in samples from which a process counts as drift, > 0
      real(dp) :: drift_samples = 5.0_dp
      !> Samples that the likelihood uses at most, >= 50
      integer(int64) :: most = 131072
   end type drift_identification_options

   !> What was found; u is the unit of the series
   type :: drift_identification_type
      !> Something in the record is slower than the limit
      logical :: found = .false.
      !> All processes, fast ones too, and white noise r: AR(1) processes first, a random walk last;
      !> no process where the series is white
      type(component_model_type) :: model
      !> Which of them count as drift
      logical :: slow(most_components) = .false.
      !> "walk", "ar1", "walk+ar1", "white": whether there is a random walk, whether there are AR(1)
      !> processes (one or two)
      character(8) :: name = "white"
      !> Standard errors of phi, q and r, 0 where they are not known
      type(component_model_type) :: std_error
      logical :: errors_known = .false.
      !> Of the slowest AR(1) process that counts as drift, samples; 0: a random walk alone, or
      !> nothing
      real(dp) :: correlation_samples = 0.0_dp
      !> Standard deviation of the slow AR(1) processes, u; of a random walk alone that of a step, u
      !> per root of a sample
      real(dp) :: drift_std = 0.0_dp
      !> Of the white noise, u
      real(dp) :: white_std = 0.0_dp
      !> All that were fitted to the part, and which of them was chosen; 0: white noise, or a model
      !> from block means
      type(drift_candidate_type), allocatable :: candidate(:)
      integer :: chosen = 0
      !> Used by the likelihood (the middle of the record), of the record
      integer(int64) :: samples = 0, of_samples = 0
      !> Samples a mean of those block means that the processes slower than two of them come
      !> from; 1: no block means
      integer(int64) :: block = 1
      !> Of the model on the samples of the fit, as AIC counts it
      real(dp) :: log_likelihood = 0.0_dp
   end type drift_identification_type

   !> Decrease of AIC from the best model without drift that speaks for one
   real(dp), parameter :: aic_margin = 8.0_dp

contains

   !> The best candidate, or the best without drift where that is no worse.
   subroutine choose_model(fit, limit, identification)
      type(drift_fit_type), intent(in) :: fit
      !> Correlation time in samples
      real(dp), intent(in) :: limit
      type(drift_identification_type), intent(inout) :: identification
      logical, allocatable :: slow(:)
      real(dp) :: plain
      integer :: fast, k

      plain = fit%white_aic
      fast = 0
      do k = 1, size(fit%candidate)
         associate (model => fit%candidate(k)%model)
            if (any(is_slow(model%phi(:model%count), limit))) cycle
         end associate
         if (.not. fit%candidate(k)%aic < plain) cycle
         plain = fit%candidate(k)%aic
         fast = k
      end do
      associate (best => fit%candidate(fit%best))
         slow = is_slow(best%model%phi(:best%model%count), limit)
         slow = slow .and. best%model%q(:size(slow)) > 0.0_dp
         if (best%errors_known) slow = slow .and. &
                                       best%model%q(:size(slow)) > best%std_error%q(:size(slow))
         identification%found = any(slow) .and. best%aic < plain - aic_margin
      end associate
      identification%chosen = merge(fit%best, fast, identification%found)
      if (identification%chosen == 0) then
         identification%model%r = fit%variance
         identification%std_error%r = fit%variance*sqrt(2.0_dp/real(fit%measurements, dp))
         identification%errors_known = .true.
         identification%log_likelihood = 2.0_dp - 0.5_dp*fit%white_aic
         return
      end if
      associate (chosen => fit%candidate(identification%chosen))
         identification%model = chosen%model
         identification%name = chosen%name
         identification%std_error = chosen%std_error
         identification%errors_known = chosen%errors_known
         identification%log_likelihood = chosen%parameters - 0.5_dp*chosen%aic
         identification%slow(:chosen%model%count) = &
            is_slow(chosen%model%phi(:chosen%model%count), limit)
      end associate
   end subroutine choose_model

   !> Takes a model from elsewhere.
   pure subroutine set_model(model, limit, identification)
      type(component_model_type), intent(in) :: model
      !> Correlation time in samples from which a process is drift
      real(dp), intent(in) :: limit
      type(drift_identification_type), intent(inout) :: identification
      logical :: walk, other

      identification%model = model
      identification%chosen = 0
      identification%slow = .false.
      identification%slow(:model%count) = is_slow(model%phi(:model%count), limit)
      identification%found = any(identification%slow)
      walk = any(model%phi(:model%count) >= 1.0_dp)
      other = any(model%phi(:model%count) < 1.0_dp)
      identification%name = "white"
      if (walk) identification%name = "walk"
      if (other) identification%name = "ar1"
      if (walk .and. other) identification%name = "walk+ar1"
   end subroutine set_model

   !> The numbers that a reader looks for.
   subroutine state_numbers(identification)
      type(drift_identification_type), intent(inout) :: identification
      real(dp) :: variance
      integer :: i

      variance = 0.0_dp
      associate (model => identification%model)
         identification%white_std = sqrt(model%r)
         do i = 1, model%count
            if (.not. identification%slow(i) .or. model%phi(i) >= 1.0_dp) cycle
            variance = variance + model%q(i)/((1.0_dp - model%phi(i))*(1.0_dp + model%phi(i)))
            identification%correlation_samples = &
               max(identification%correlation_samples, -1.0_dp/log(model%phi(i)))
         end do
         if (identification%correlation_samples <= 0.0_dp) variance = &
            sum(model%q, mask=identification%slow)
      end associate
      identification%drift_std = sqrt(variance)
   end subroutine state_numbers

end module gyroakf_filter_drift_choice
