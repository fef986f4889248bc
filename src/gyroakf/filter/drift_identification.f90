! SPDX-License-Identifier: MIT
!> The drift of a record and its white noise, identified from the record itself.
!>
!>     call identify_drift_model(z, drift_identification_options(), identification, error)
!>     if (identification%found) call new_drift_filter(filter, identification%model, &
!>        identification%slow(:identification%model%count), options, error)
!>
!> The candidates of [[fit_drift]] (random walk, AR(1), both, each with white noise) are fitted to
!> the middle part of the record and compared ([[gyroakf_filter_drift_choice]]). A drift whose
!> correlation time is beyond that part is sought in block means of the whole record, of a power of
!> four samples each, at most 32,768 of them: their model is of the same kind
!> ([[gyroakf_filter_drift_blocks]]). Where the means have a model with processes slower than two
!> blocks that is better by 8 of AIC than what the model of the part says of them, those processes
!> take the place of all that are as slow in the part's model; faster ones and the white noise
!> remain.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.3, 7.4.
module gyroakf_filter_drift_identification
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_blocks, only : block_means, model_of_means, process_of_samples
   use gyroakf_filter_drift_choice, only : choose_model, drift_identification_options, &
      drift_identification_type, aic_margin, set_model, state_numbers
   use gyroakf_filter_drift_fit, only : drift_fit_type, fit_drift, is_slow
   use gyroakf_filter_likelihood, only : component_likelihood
   use gyroakf_filter_drift_objective, only : progress_share_type
   implicit none (type, external)
   private
   public :: drift_identification_options, drift_identification_type, identify_drift_model

   !> Blocks a correlation time that block means resolve
   real(dp), parameter :: resolved_blocks = 2.0_dp
   !> Share of the time that the part takes where there are block means too
   real(dp), parameter :: part_share = 0.8_dp
   !> Maximum number of block means; their width is a power of `widening`
   integer(int64), parameter :: most_means = 32768, widening = 4

contains

   !> Identifies the drift of a series.
   subroutine identify_drift_model(z, options, identification, error, valid, progress)
      !> Series, [n], n >= 50, any offset
      real(dp), intent(in), contiguous :: z(:)
      !> The limit, the part
      type(drift_identification_options), intent(in) :: options
      !> What was found
      type(drift_identification_type), intent(out) :: identification
      !> invalid_argument (options), too_few_samples, constant_input, non_finite (variances that
      !> overflow), no_memory, not_converged, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional, target :: progress
      type(drift_fit_type) :: fit
      type(progress_share_type) :: share
      integer(int64) :: length

      call check_options(options, error)
      if (allocated(error)) return
      if (present(progress)) share%whole => progress
      length = size(z, kind=int64)
      share%total = length
      if (length > options%most) share%share = part_share
      call fit_drift(z, fit, error, valid, options%most, share)
      if (allocated(error)) return
      call choose_model(fit, options%drift_samples, identification)
      call move_alloc(fit%candidate, identification%candidate)
      if (length > fit%samples) call identify_from_means(z, fit, options%drift_samples, share, &
         & identification, error, valid)
      if (allocated(error)) return
      identification%samples = fit%samples
      identification%of_samples = length
      if (.not. ieee_is_finite(identification%model%r)) then
         call fatal_error(error, status%non_finite, &
            "the samples are too large: the variances of the drift are not finite numbers")
         return
      end if
      call state_numbers(identification)
   end subroutine identify_drift_model

   !> Refuses options out of range.
   subroutine check_options(options, error)
      type(drift_identification_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error

      if (.not. (options%drift_samples > 0.0_dp .and. options%drift_samples <= huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, &
            "the correlation time from which a process is drift must be positive")
      else if (options%most < 50) then
         call fatal_error(error, status%invalid_argument, &
            "the likelihood of a drift model needs a part of at least 50 samples")
      end if
   end subroutine check_options

   !> Looks in block means of a record that is longer than the part for what is slower than the part
   !> shows.
   subroutine identify_from_means(z, fit, limit, share, identification, error, valid)
      real(dp), intent(in), contiguous :: z(:)
      type(drift_fit_type), intent(in) :: fit
      real(dp), intent(in) :: limit
      !> Of the part's progress; that of the means afterwards
      type(progress_share_type), intent(inout) :: share
      !> Of the part; gets the slow processes of the means
      type(drift_identification_type), intent(inout) :: identification
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(drift_identification_type) :: slow
      type(drift_fit_type) :: coarse
      type(component_model_type) :: model, expected
      type(error_type), allocatable :: failed
      real(dp), allocatable :: means(:)
      integer(int8), allocatable :: present_means(:)
      integer(int64) :: width
      real(dp) :: value

      width = widening
      do while (size(z, kind=int64)/width > most_means)
         width = widening*width
      end do
      call block_means(z, width, means, present_means, error, valid)
      if (allocated(error)) return
      share%before = part_share
      share%share = 1.0_dp - part_share
      call fit_drift(means, coarse, failed, present_means, progress=share)
      if (allocated(failed)) then
         if (any(failed%code == [status%cancelled, status%no_memory])) call move_alloc(failed, &
            error)
         return                                     ! too few means: the part says it all
      end if
      call choose_model(coarse, resolved_blocks, slow)
      if (.not. slow%found) return
      call model_of_means(identification%model, width, expected)
      call likelihood_of(expected, means, coarse, value, failed, present_means)
      if (.not. allocated(failed) .and. value >= slow%log_likelihood - 0.5_dp*aic_margin) return
      call take_means(slow, width, identification, model)
      call set_model(model, limit, identification)
      identification%block = width
      call likelihood_of(model, z, fit, identification%log_likelihood, failed, valid)
   end subroutine identify_from_means

   !> The processes of the part that are faster than two blocks, those of the means that are not,
   !> the white noise of the part.
   subroutine take_means(slow, m, identification, model)
      type(drift_identification_type), intent(in) :: slow
      integer(int64), intent(in) :: m
      !> Of the part; its standard errors become those of the new model
      type(drift_identification_type), intent(inout) :: identification
      type(component_model_type), intent(out) :: model
      type(component_model_type) :: std_error
      integer :: i

      model%r = identification%model%r
      std_error%r = identification%std_error%r
      do i = 1, identification%model%count
         if (is_slow(identification%model%phi(i), resolved_blocks*real(m, dp))) cycle
         model%count = model%count + 1
         model%phi(model%count) = identification%model%phi(i)
         model%q(model%count) = identification%model%q(i)
         std_error%phi(model%count) = identification%std_error%phi(i)
         std_error%q(model%count) = identification%std_error%q(i)
      end do
      do i = 1, slow%model%count
         if (.not. slow%slow(i)) cycle
         if (.not. slow%model%q(i) > 0.0_dp) cycle       ! not there, or a constant
         model%count = model%count + 1
         associate (phi => model%phi(model%count), q => model%q(model%count))
            call process_of_samples(slow%model%phi(i), slow%model%q(i), m, phi, q)
            ! the scale of q hardly depends on phi where that is near 1
            std_error%phi(model%count) = slow%std_error%phi(i)*phi/(real(m, dp)*slow%model%phi(i))
            std_error%q(model%count) = slow%std_error%q(i)*q/slow%model%q(i)
         end associate
      end do
      std_error%count = model%count
      identification%std_error = std_error
      identification%errors_known = identification%errors_known .and. slow%errors_known
   end subroutine take_means

   !> Log-likelihood of a model on the samples of a fit, as AIC counts it.
   subroutine likelihood_of(model, z, fit, value, error, valid)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in), contiguous :: z(:)
      !> Which part it used, its mean and variance
      type(drift_fit_type), intent(in) :: fit
      real(dp), intent(out) :: value
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
      type(component_model_type) :: scaled
      real(dp), allocatable :: part(:)
      real(dp) :: scale
      integer :: stat

      value = 0.0_dp
      if (model%count == 0) then
         if (.not. model%r > 0.0_dp) return
         value = -0.5_dp*real(fit%measurements, dp)*(log_two_pi + log(model%r) &
            + fit%variance/model%r)
         return
      end if
      allocate (part(fit%samples), stat=stat)
      call check_memory(stat, "the part of a series that a drift is identified from", error)
      if (allocated(error)) return
      part(:) = z(fit%first:fit%first + fit%samples - 1)
      scale = sqrt(fit%variance)
      part(:) = (part - fit%mean)/scale
      scaled = model
      scaled%q = model%q/scale/scale
      scaled%r = model%r/scale/scale
      if (present(valid)) then
         call component_likelihood(scaled, part, value, error, &
            valid(fit%first:fit%first + fit%samples - 1))
      else
         call component_likelihood(scaled, part, value, error)
      end if
      value = value - real(fit%measurements, dp)*log(scale)
   end subroutine likelihood_of

end module gyroakf_filter_drift_identification
