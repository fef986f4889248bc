! SPDX-License-Identifier: MIT
!> The drift of a record: what is found, what is not, and how well.
module test_drift_identification
   use expectations, only : unmet, failed => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use progress_watch, only : watch_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_blocks, only : model_of_means, process_of_samples
   use gyroakf_filter_drift_identification, only : drift_identification_options, drift_identification_type, identify_drift_model
   use filter_library, only : add_walk, fill_noise, make_series, paper_phi
   implicit none (type, external)
   private
   public :: suite_drift_identification

contains

   subroutine suite_drift_identification()
      call test("ar1", test_ar1)
      call test("within-errors", test_within_errors)
      call test("walk-errors", test_walk_errors)
      call test("white", test_white)
      call test("fast-noise", test_fast_noise)
      call test("limit", test_limit)
      call test("gaps", test_gaps)
      call test("invariance", test_invariance)
      call test("beyond-part", test_beyond_part)
      call test("means", test_means)
      call test("cancelled", test_cancelled)
      call test("refused", test_refused)
   end subroutine suite_drift_identification

   !> Case C1 of the comparison.
   subroutine test_ar1()
      type(drift_identification_type) :: found
      real(dp) :: z(12000)

      call make_series(31, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z)
      call identify_drift_model(z, drift_identification_options(), found, failed)
      if (went_wrong(failed)) return
      call check(error, found%found .and. found%slow(1) .and. found%name == "ar1" .and. found%errors_known)
      if (unmet(found%block == 1 .and. size(found%candidate) == 3)) return
      call check(error, found%correlation_samples, -1/log(found%model%phi(1)), thr=1.0e-12_dp, rel=.true.)
      call check(error, found%white_std**2, 4.2e-4_dp, thr=4*found%std_error%r)
      call check(error, found%drift_std**2, found%model%q(1)/(1 - found%model%phi(1)**2), thr=1.0e-12_dp, rel=.true.)
      call check(error, found%samples == 12000_int64 .and. found%of_samples == 12000_int64)
   end subroutine test_ar1

   !> Walk, AR(1), both: every number within four of its errors, for three seeds each.
   subroutine test_within_errors()
      type(drift_identification_type) :: found
      type(component_model_type) :: truth
      character(8), parameter :: names(3) = [character(8) :: "walk", "ar1", "walk+ar1"]
      real(dp) :: z(8000)
      integer :: kind, seed, n

      do kind = 1, 3
         do seed = 1, 3
            truth = component_model_type(r=1.0_dp)
            call make_series(100*kind + seed, 0.9_dp, merge(0.0_dp, 0.6_dp, kind == 1), 1.0_dp, z)
            if (kind /= 2) call add_walk(50000 + 100*kind + seed, 0.03_dp, z)
            call identify_drift_model(z, drift_identification_options(), found, failed)
            if (unmet(.not. allocated(failed) .and. found%found .and. found%errors_known)) return
            n = found%model%count
            associate (fit => found%candidate(kind))
               call check(error, fit%name, names(kind))
               n = fit%model%count
               if (kind /= 1) truth%phi(1) = 0.9_dp
               if (kind /= 1) truth%q(1) = 0.6_dp*0.19_dp
               if (kind /= 2) truth%phi(n) = 1.0_dp
               if (kind /= 2) truth%q(n) = 9.0e-4_dp
               call check(error, all(abs(fit%model%phi(:n) - truth%phi(:n)) <= 4*fit%std_error%phi(:n)))
               call check(error, all(abs(fit%model%q(:n) - truth%q(:n)) <= 4*fit%std_error%q(:n)))
               call check(error, abs(fit%model%r - truth%r) <= 4*fit%std_error%r)
            end associate
            if (allocated(error)) return
            call check(error, found%chosen == kind .or. found%candidate(found%chosen)%aic < found%candidate(kind)%aic)
         end do
      end do
   end subroutine test_within_errors

   !> Twenty random walks: squared deviations over squared errors are chi-square of 20 degrees, within four deviations, in ln q.
   subroutine test_walk_errors()
      type(drift_identification_type) :: found
      real(dp) :: z(1500), total(2)
      integer :: seed

      total = 0.0_dp
      do seed = 1, 20
         call fill_noise(500 + seed, z)
         call add_walk(50500 + seed, 0.1_dp, z)
         call identify_drift_model(z, drift_identification_options(), found, failed)
         if (unmet(.not. allocated(failed) .and. found%found .and. found%slow(found%model%count))) return
         associate (fit => found%candidate(1))
            total(1) = total(1) + (log(fit%model%q(1)/0.01_dp)*fit%model%q(1)/fit%std_error%q(1))**2
            total(2) = total(2) + ((fit%model%r - 1)/fit%std_error%r)**2
         end associate
      end do
      call check(error, all(abs(total - 20) <= 4*sqrt(40.0_dp)))
   end subroutine test_walk_errors

   !> Thirty records of white noise: nothing is found (one alarm in three hundred is usual).
   subroutine test_white()
      type(drift_identification_type) :: found
      real(dp) :: z(1000)
      integer :: seed

      do seed = 1, 30
         call fill_noise(3000 + seed, z)
         call identify_drift_model(z, drift_identification_options(), found, failed)
         if (unmet(.not. (allocated(failed) .or. found%found .or. any(found%slow)))) return
         call check(error, found%drift_std <= 0.0_dp .and. abs(found%white_std - 1) < 0.3_dp)
         if (found%chosen == 0) call check(error, found%errors_known .and. abs(found%model%r - 1) < 5*found%std_error%r .and. &
                                           found%std_error%r < 2*sqrt(2.0_dp/size(z)), "the error of white noise alone")
         if (allocated(error)) return
      end do
   end subroutine test_white

   !> The paper's noise is fast: no drift. With a cubic in it (C0 of the comparison) the walk follows that, the noise stays noise.
   subroutine test_fast_noise()
      type(drift_identification_type) :: found
      real(dp) :: z(12000), t
      integer :: i

      call make_series(61, paper_phi, 5.2e-4_dp, 0.0_dp, z)
      call identify_drift_model(z, drift_identification_options(), found, failed)
      if (unmet(.not. allocated(failed) .and. .not. found%found)) return
      do i = 1, size(z)
         t = (i - 6000)/6000.0_dp
         z(i) = z(i) + 0.02_dp*(t**3 - 0.5_dp*t)
      end do
      call identify_drift_model(z, drift_identification_options(), found, failed)
      if (unmet(.not. allocated(failed) .and. found%found)) return
      call check(error, found%name, "walk+ar1")
      call check(error, found%slow(2) .and. .not. found%slow(1))
      call check(error, found%model%phi(1), paper_phi, thr=0.1_dp)
   end subroutine test_fast_noise

   !> A process of 5.6 samples is drift for a limit of 5, none for one of 8; a walk is at any.
   subroutine test_limit()
      type(drift_identification_type) :: found
      real(dp) :: z(20000)

      call make_series(71, exp(-1/5.6_dp), 2.0_dp, 1.0_dp, z)
      call identify_drift_model(z, drift_identification_options(drift_samples=5.0_dp), found, failed)
      call check(error, found%found .and. found%slow(1))
      call identify_drift_model(z, drift_identification_options(drift_samples=8.0_dp), found, failed)
      call check(error, .not. found%found .and. found%model%count == 1)
      call check(error, abs(found%model%phi(1) - exp(-1/5.6_dp)) <= 4*found%std_error%phi(1))
      call add_walk(50071, 0.05_dp, z)
      call identify_drift_model(z, drift_identification_options(drift_samples=1.0e6_dp), found, failed)
      call check(error, found%found .and. found%name == "walk+ar1" .and. all(found%slow(:2) .eqv. [.false., .true.]))
      call check(error, found%drift_std, sqrt(found%model%q(2)), thr=1.0e-12_dp, rel=.true.)
   end subroutine test_limit

   !> A tenth of the samples is missing.
   subroutine test_gaps()
      type(drift_identification_type) :: found
      real(dp) :: z(8000), u(8000)
      integer(int8) :: here(8000)

      call make_series(37, 0.95_dp, 1.0_dp, 1.0_dp, z)
      call fill_noise(38, u)
      here = 1_int8
      where (u > 1.28_dp)
         here = 0_int8
         z = 1.0e9_dp
      end where
      call identify_drift_model(z, drift_identification_options(), found, failed, here)
      if (unmet(.not. allocated(failed) .and. found%found)) return
      associate (fit => found%candidate(2))
         call check(error, abs(fit%model%phi(1) - 0.95_dp) <= 4*fit%std_error%phi(1))
         call check(error, abs(fit%model%r - 1) <= 4*fit%std_error%r)
      end associate
   end subroutine test_gaps

   !> Scale and offset.
   subroutine test_invariance()
      type(drift_identification_type) :: found, other
      real(dp), parameter :: scale = 3.0e-5_dp
      real(dp) :: z(4000)

      call make_series(36, 0.97_dp, 1.0_dp, 1.0_dp, z)
      call identify_drift_model(z, drift_identification_options(), found, failed)
      z = scale*z - 1.0e-4_dp
      call identify_drift_model(z, drift_identification_options(), other, failed)
      call check(error, other%name, found%name)
      call check(error, other%model%phi(1), found%model%phi(1), thr=1.0e-7_dp, rel=.true.)
      call check(error, other%model%q(1), scale**2*found%model%q(1), thr=1.0e-7_dp, rel=.true.)
      call check(error, other%model%r, scale**2*found%model%r, thr=1.0e-7_dp, rel=.true.)
      call check(error, other%std_error%q(1), scale**2*found%std_error%q(1), thr=1.0e-6_dp, rel=.true.)
   end subroutine test_invariance

   !> A drift of 4,000 samples' correlation in white noise that a part of 2,000 cannot tell from a constant, beside one of 10.
   subroutine test_beyond_part()
      type(drift_identification_type) :: found
      real(dp), allocatable :: z(:), slow(:)

      allocate (z(150000), slow(150000))
      call make_series(81, exp(-0.1_dp), 0.5_dp, 1.0_dp, z)
      call make_series(82, exp(-1/4000.0_dp), 0.05_dp, 0.0_dp, slow)
      z = z + slow
      call identify_drift_model(z, drift_identification_options(most=2000_int64), found, failed)
      if (unmet(.not. allocated(failed) .and. found%found .and. found%samples == 2000_int64)) return
      call check(error, found%block == 16_int64 .and. all(found%slow(:found%model%count)))
      associate (model => found%model, last => found%model%count)
         call check(error, abs(model%q(last) - 0.05_dp*(1 - exp(-0.5e-3_dp))) <= 4*found%std_error%q(last))
         call check(error, abs(model%phi(1) - exp(-0.1_dp)) <= 4*found%std_error%phi(1))
         call check(error, abs(model%r - 1) <= 4*found%std_error%r)
      end associate
   end subroutine test_beyond_part

   !> Covariances of means, summed over the samples of two blocks, are those of the model of the means; and back.
   subroutine test_means()
      type(component_model_type) :: model, means
      integer(int64), parameter :: m = 16
      real(dp) :: sums(0:2), phi, q
      integer :: i, j, lag

      model%count = 1
      model%phi(1) = 0.95_dp
      model%q(1) = 0.0975_dp
      model%r = 30.0_dp
      sums = 0.0_dp
      do lag = 0, 2
         do j = 1, int(m)
            do i = 1, int(m)
               sums(lag) = sums(lag) + model%phi(1)**abs(lag*int(m) + i - j)/real(m, dp)**2
            end do
         end do
      end do
      call model_of_means(model, m, means)
      associate (variance => means%q(1)/(1 - means%phi(1)**2))
         call check(error, variance + means%r, sums(0) + model%r/m, thr=1.0e-12_dp, rel=.true.)
         call check(error, variance*means%phi(1), sums(1), thr=1.0e-12_dp, rel=.true.)
         call check(error, variance*means%phi(1)**2, sums(2), thr=1.0e-12_dp, rel=.true.)
      end associate
      call process_of_samples(means%phi(1), means%q(1), m, phi, q)
      call check(error, phi, model%phi(1), thr=1.0e-12_dp, rel=.true.)
      call check(error, q, model%q(1), thr=1.0e-12_dp, rel=.true.)
      ! steps of a walk from mean to mean: variance m q (2 + 1/m^2)/3 + 2 r/m, covariance with the next m q (1 - 1/m^2)/6 - r/m
      model%phi(1) = 1.0_dp
      model%q(1) = 0.5_dp
      call model_of_means(model, m, means)
      call check(error, means%q(1) + 2*means%r, 8*(2 + 1/256.0_dp)/3 + 60.0_dp/16, thr=1.0e-12_dp, rel=.true.)
      call check(error, -means%r, 8*(1 - 1/256.0_dp)/6 - 30.0_dp/16, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_means

   !> A cancellation takes effect at the next evaluation.
   subroutine test_cancelled()
      type(drift_identification_type) :: found
      type(watch_type) :: watch
      real(dp) :: z(2000)

      call make_series(95, 0.9_dp, 1.0_dp, 1.0_dp, z)
      watch%last_call = 30
      call identify_drift_model(z, drift_identification_options(), found, failed, progress=watch)
      call check_refused(failed, status%cancelled)
      call check(error, watch%calls, 30)
      watch = watch_type()
      call identify_drift_model(z, drift_identification_options(), found, failed, progress=watch)
      call check(error, .not. allocated(failed) .and. watch%ordered .and. &
         & watch%stage == "identifying")
   end subroutine test_cancelled

   subroutine test_refused()
      type(drift_identification_type) :: found
      real(dp) :: z(60)

      call fill_noise(5, z)
      call identify_drift_model(z(:40), drift_identification_options(), found, failed)
      call check_refused(failed, status%too_few_samples)
      call identify_drift_model(z, drift_identification_options(drift_samples=0.0_dp), found, failed)
      call check_refused(failed, status%invalid_argument)
      call identify_drift_model(z, drift_identification_options(most=49_int64), found, failed)
      call check_refused(failed, status%invalid_argument)
      z = 3.0_dp
      call identify_drift_model(z, drift_identification_options(), found, failed)
      call check_refused(failed, status%constant_input)
   end subroutine test_refused

end module test_drift_identification
