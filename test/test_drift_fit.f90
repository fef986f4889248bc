! SPDX-License-Identifier: MIT
!> Drift models by maximum likelihood: parameters within their errors, invariance, failures.
module test_drift_fit
   use expectations, only : unmet, failed => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_fit, only : drift_fit_type, fit_drift, is_slow
   use gyroakf_filter_likelihood, only : component_likelihood
   use filter_library, only : add_walk, fill_noise, make_series
   implicit none (type, external)
   private
   public :: suite_drift_fit

   !> Slope of ln L for each standard error that rounding may leave at its top
   real(dp), parameter :: top = 1.0e-6_dp

contains

   subroutine suite_drift_fit()
      call test("ar1", test_ar1)
      call test("walk", test_walk)
      call test("both", test_both)
      call test("errors", test_errors)
      call test("likelihood", test_value)
      call test("invariance", test_invariance)
      call test("nested", test_nested)
      call test("nothing", test_nothing)
      call test("ridge", test_ridge)
      call test("quantized", test_quantized)
      call test("reversal", test_reversal)
      call test("short-reversal", test_short_reversal)
      call test("gaps", test_gaps)
      call test("long", test_long)
      call test("slow", test_slow)
      call test("refused", test_refused)
   end subroutine suite_drift_fit

   !> A random walk in white noise of these standard deviations.
   subroutine make_walk(seed, step, white, z)
      integer, intent(in) :: seed
      real(dp), intent(in) :: step, white
      real(dp), intent(out), contiguous :: z(:)

      call fill_noise(seed + 50000, z)
      z = white*z
      call add_walk(seed, step, z)
   end subroutine make_walk

   !> Number of the candidate of a name, 0 where there is none.
   integer function number_of(fit, name)
      type(drift_fit_type), intent(in) :: fit
      character(*), intent(in) :: name

      do number_of = size(fit%candidate), 1, -1
         if (fit%candidate(number_of)%name == name) exit
      end do
   end function number_of

   !> Case C1 of the comparison: the best model is AR(1), its numbers lie within four standard errors.
   subroutine test_ar1()
      type(drift_fit_type) :: fit
      real(dp) :: z(12000)

      call make_series(31, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z)
      call fit_drift(z, fit, failed)
      if (went_wrong(failed)) return
      call check(error, trim(fit%candidate(fit%best)%name), "ar1")
      associate (best => fit%candidate(fit%best))
         call check(error, best%converged .and. best%errors_known .and. best%parameters == 4)
         call check(error, abs(best%model%phi(1) - 0.98_dp) <= 4*best%std_error%phi(1))
         call check(error, abs(best%model%q(1) - 3.96e-6_dp) <= 4*best%std_error%q(1))
         call check(error, abs(best%model%r - 4.2e-4_dp) <= 4*best%std_error%r)
         call check(error, steepest(z - fit%mean, best%model, best%std_error) <= top, "not the top")
      end associate
   end subroutine test_ar1

   !> Steepest slope of the log-likelihood, the standard error of each parameter being its unit: central differences over 2e-3.
   real(dp) function steepest(z, model, std_error)
      real(dp), intent(in) :: z(:)
      type(component_model_type), intent(in) :: model, std_error
      real(dp), parameter :: h = 1.0e-3_dp
      type(component_model_type) :: moved
      real(dp) :: value(2)
      integer :: i, k, side

      steepest = 0
      do i = 1, model%count
         do k = 1, merge(3, 2, i == 1)
            do side = 1, 2
               moved = model
               select case (k)
               case (1); moved%phi(i) = model%phi(i) + merge(h, -h, side == 1)*std_error%phi(i)
               case (2); moved%q(i) = model%q(i) + merge(h, -h, side == 1)*std_error%q(i)
               case default; moved%r = model%r + merge(h, -h, side == 1)*std_error%r
               end select
               call component_likelihood(moved, z, value(side), failed)
            end do
            steepest = max(steepest, abs(value(1) - value(2))/(2*h))
         end do
      end do
   end function steepest

   !> No model ends below one that it contains, but for the diffuse start of the random walk:
   !> $$ \ln (\mathbf 1^T \Sigma^{-1} \mathbf 1) - \ln 2\pi $$
   !> Small, slow drifts in much white noise and fast noise of either sign, where the likelihood has several tops.
   subroutine test_nested()
      real(dp), parameter :: phi(4) = [0.998_dp, 0.9999_dp, -0.11_dp, 0.4_dp], part(4) = [0.03_dp, 0.02_dp, 1.0_dp, 1.0_dp]
      real(dp), parameter :: dropped = 0.06_dp              ! three variances that make no difference to ln L
      type(drift_fit_type) :: fit
      real(dp) :: z(6000), slow(6000), one(6000), value, base, start
      integer :: seed, case

      one = 1
      do case = 1, size(phi)
         do seed = 1, 3
            call make_series(700 + seed, phi(case), part(case), merge(1.0_dp, 0.0_dp, case < 3), z)
            call make_walk(800 + seed, merge(1.0e-3_dp, 0.0_dp, case == 1), 0.0_dp, slow)
            call fit_drift(z + slow, fit, failed)
            if (went_wrong(failed)) return
            associate (walk => fit%candidate(1), ar => fit%candidate(2), both => fit%candidate(3))
               call component_likelihood(ar%model, one*sqrt(fit%variance), value, failed)
               call component_likelihood(ar%model, 0*one, base, failed)
               start = log(2*(base - value)) - log(8*atan(1.0_dp))
               call check(error, both%aic - 8 <= ar%aic - 8 + start + dropped, "both end below AR(1)")
               call check(error, both%aic - 8 <= walk%aic - 4 + dropped, "both end below the walk")
            end associate
         end do
      end do
   end subroutine test_nested

   !> AR(1) noise without white noise: what the likelihood does not tell from 0 is 0, in any unit, and the others have errors.
   subroutine test_nothing()
      real(dp), parameter :: units(3) = [1.0e-8_dp, 1.0_dp, 1.0e8_dp]
      type(drift_fit_type) :: fit
      real(dp) :: z(3000)
      integer :: seed, i, zeros

      zeros = 0
      do seed = 1, 6
         call make_series(900 + seed, 0.4_dp, 1.0_dp, 0.0_dp, z)
         do i = 1, size(units)
            call fit_drift(units(i)*z, fit, failed)
            if (went_wrong(failed)) return
            associate (ar => fit%candidate(number_of(fit, "ar1")))
               call check(error, .not. ar%model%r > 0 .or. ar%model%r > 1.0e-6_dp*units(i)**2, "a variance next to nothing")
               if (ar%model%r > 0) cycle
               zeros = zeros + 1
               call check(error, ar%errors_known .and. .not. ar%std_error%r > 0)
               call check(error, abs(ar%model%phi(1) - 0.4_dp) <= 4*ar%std_error%phi(1))
               call check(error, abs(ar%std_error%phi(1)/sqrt(0.84_dp/3000) - 1) <= 0.1_dp, "not the error of AR(1) alone")
            end associate
         end do
      end do
      call check(error, mod(zeros, size(units)) == 0 .and. zeros >= 2*size(units), "never nothing, or not in every unit")
   end subroutine test_nothing

   !> A slow, small drift in much white noise: the likelihood of AR(1) is a ridge, on which a search goes on to the top, where it is
   !> flat in every direction; the true model lies below it by what chi-square of three allows.
   subroutine test_ridge()
      type(drift_fit_type) :: fit
      type(component_model_type) :: near
      real(dp) :: z(12000), value
      integer :: seed, k

      do seed = 1, 3
         call make_series(960 + seed, 0.9994_dp, 4.0e-3_dp, 1.0_dp, z)
         call fit_drift(z, fit, failed)
         if (went_wrong(failed)) return
         associate (found => fit%candidate(number_of(fit, "ar1")))
            call check(error, found%errors_known, "no errors")
            do k = -1, 1, 2                               ! along the ridge: the drift's variance stays
               near = found%model
               near%phi(1) = 1 - (1 - near%phi(1))*(1 + 0.2_dp*k)
               near%q(1) = near%q(1)*(1 - near%phi(1)**2)/(1 - found%model%phi(1)**2)
               call component_likelihood(near, z - fit%mean, value, failed)
               call check(error, value < found%log_likelihood, "not the top")
            end do
         end associate
      end do
   end subroutine test_ridge

   !> Rounded to steps as large as the noise less the angle that is carried on, as a counter of angle does: the noise has a negative
   !> correlation, and the model of both processes finds it beside the walk.
   subroutine test_quantized()
      type(drift_fit_type) :: fit
      real(dp) :: z(6000), angle
      integer :: seed, k

      do seed = 1, 3
         call make_walk(980 + seed, 0.05_dp, 0.2_dp, z)
         angle = 0.0_dp
         do k = 1, size(z)
            angle = angle + z(k)
            z(k) = anint(angle)
            angle = angle - z(k)
         end do
         call fit_drift(z, fit, failed)
         if (went_wrong(failed)) return
         call check(error, trim(fit%candidate(fit%best)%name), "walk+ar1")
         associate (best => fit%candidate(fit%best))
            call check(error, best%model%phi(1) < -0.3_dp)
            ! the noise is near to AR(1), not that
            call check(error, best%model%q(2), 0.0025_dp, thr=0.5_dp, rel=.true.)
         end associate
      end do
   end subroutine test_quantized

   subroutine test_walk()
      type(drift_fit_type) :: fit
      real(dp) :: z(8000)

      call make_walk(32, 0.01_dp, 1.0_dp, z)
      call fit_drift(z, fit, failed)
      if (went_wrong(failed)) return
      associate (walk => fit%candidate(number_of(fit, "walk")))
         call check(error, walk%converged .and. walk%parameters == 2)
         call check(error, abs(walk%model%q(1) - 1.0e-4_dp) <= 4*walk%std_error%q(1))
         call check(error, abs(walk%model%r - 1.0_dp) <= 4*walk%std_error%r)
         call check(error, steepest(z - fit%mean, walk%model, walk%std_error) <= top, "not the top")
         ! a term too many gains chi-square of two degrees of freedom: beyond 14 once in a thousand
         call check(error, walk%log_likelihood > fit%candidate(number_of(fit, "walk+ar1"))%log_likelihood - 7)
      end associate
   end subroutine test_walk

   subroutine test_both()
      type(drift_fit_type) :: fit
      real(dp) :: z(20000), slow(20000)

      call make_series(33, 0.9_dp, 0.5_dp, 1.0_dp, z)
      call make_walk(34, 0.02_dp, 0.0_dp, slow)
      call fit_drift(z + slow, fit, failed)
      if (went_wrong(failed)) return
      call check(error, trim(fit%candidate(fit%best)%name), "walk+ar1")
      associate (best => fit%candidate(fit%best))
         call check(error, abs(best%model%phi(1) - 0.9_dp) <= 4*best%std_error%phi(1))
         call check(error, abs(best%model%q(1) - 0.095_dp) <= 4*best%std_error%q(1))
         call check(error, abs(best%model%q(2) - 4.0e-4_dp) <= 4*best%std_error%q(2))
         call check(error, abs(best%model%r - 1.0_dp) <= 4*best%std_error%r)
         call check(error, steepest(z + slow - fit%mean, best%model, best%std_error) <= top, "not the top")
      end associate
   end subroutine test_both

   !> Twenty records: the squared deviations in units of the stated errors are chi-square of 20 degrees, within four deviations.
   subroutine test_errors()
      type(drift_fit_type) :: fit
      real(dp) :: z(1500), total(3)
      integer :: seed, k

      total = 0.0_dp
      do seed = 1, 20
         call make_series(400 + seed, 0.9_dp, 1.0_dp, 1.0_dp, z)
         call fit_drift(z, fit, failed)
         if (went_wrong(failed)) return
         associate (found => fit%candidate(number_of(fit, "ar1")))
            total = total + ([found%model%phi(1) - 0.9_dp, found%model%q(1) - 0.19_dp, found%model%r - 1.0_dp]/ &
                             [found%std_error%phi(1), found%std_error%q(1), found%std_error%r])**2
         end associate
      end do
      do k = 1, 3
         call check(error, abs(total(k) - 20) <= 4*sqrt(40.0_dp))
      end do
   end subroutine test_errors

   !> The stated likelihood is that of the stated model, and beyond that of the true one.
   subroutine test_value()
      type(drift_fit_type) :: fit
      type(component_model_type) :: truth
      real(dp) :: z(4000), value

      call make_series(35, 0.95_dp, 2.0_dp, 3.0_dp, z)
      call fit_drift(z, fit, failed)
      associate (found => fit%candidate(number_of(fit, "ar1")))
         call component_likelihood(found%model, z - fit%mean, value, failed)
         call check(error, found%log_likelihood, value, thr=1.0e-10_dp, rel=.true.)
         truth%count = 1
         truth%phi(1) = 0.95_dp
         truth%q(1) = 2*0.0975_dp
         truth%r = 3.0_dp
         call component_likelihood(truth, z - fit%mean, value, failed)
         call check(error, found%log_likelihood > value)
      end associate
   end subroutine test_value

   !> Scale and offset.
   subroutine test_invariance()
      type(drift_fit_type) :: fit, other
      real(dp) :: z(3000)
      integer :: k

      call make_series(36, 0.9_dp, 1.0_dp, 1.0_dp, z)
      call fit_drift(z, fit, failed)
      call fit_drift(1.0e-3_dp*z + 1.0e3_dp, other, failed)
      if (unmet(size(fit%candidate) == size(other%candidate))) return
      call check(error, other%best, fit%best, "another model in another unit")
      call check(error, other%candidate(2)%aic - other%candidate(1)%aic, fit%candidate(2)%aic - fit%candidate(1)%aic, &
         & thr=1.0e-4_dp)
      do k = 1, 2                                        ! a third one may have no more than a flat top
         ! the offset takes six of the digits, the top of the likelihood is flat within the root of what is left
         call check(error, other%candidate(k)%model%r, 1.0e-6_dp*fit%candidate(k)%model%r, thr=1.0e-6_dp, rel=.true.)
         call check(error, other%candidate(k)%model%q(1), 1.0e-6_dp*fit%candidate(k)%model%q(1), thr=1.0e-5_dp, rel=.true.)
      end do
   end subroutine test_invariance

   !> Backwards in time the likelihood is the same, all its sums are formed in another order: where the search ends and what
   !> it says of the errors does not depend on rounding.
   subroutine test_reversal()
      real(dp), parameter :: rounding = 1.0e-11_dp
      type(drift_fit_type) :: fit, other
      real(dp) :: z(6000), slow(6000), back(6000)
      integer :: k

      call make_series(45, 0.9_dp, 0.3_dp, 1.0_dp, z)
      call make_walk(46, 2.0e-3_dp, 0.0_dp, slow)
      z = z + slow
      call fit_drift(z, fit, failed)
      back = z(size(z):1:-1)
      call fit_drift(back, other, failed)
      if (unmet(size(fit%candidate) == 3 .and. size(other%candidate) == 3 .and. fit%best == other%best)) return
      do k = 1, 3
         associate (one => fit%candidate(k), two => other%candidate(k))
            call check(error, one%errors_known .and. two%errors_known, trim(one%name)//": no errors")
            call check(error, distance(one%model, two%model) < rounding, trim(one%name)//": the model")
            call check(error, distance(one%std_error, two%std_error) < rounding, trim(one%name)//": its errors")
         end associate
      end do
   end subroutine test_reversal

   !> The likelihood of few samples is no parabola, and what the search leaves is more than rounding: its last steps are Newton's.
   subroutine test_short_reversal()
      real(dp), parameter :: rounding = 1.0e-12_dp
      integer, parameter :: records = 10, samples(2) = [100, 300]
      type(drift_fit_type) :: fit, other
      real(dp), allocatable :: z(:), slow(:), back(:)
      integer :: i, j, k

      do i = 1, size(samples)
         allocate (z(samples(i)), slow(samples(i)))
         do j = 1, records
            call make_series(60 + j, 0.9_dp, 0.3_dp, 1.0_dp, z)
            call make_walk(80 + j, 0.01_dp, 0.0_dp, slow)
            z = z + slow
            call fit_drift(z, fit, failed)
            back = z(size(z):1:-1)
            call fit_drift(back, other, failed)
            call check(error, size(fit%candidate), size(other%candidate))
            do k = 1, size(fit%candidate)
               if (allocated(error)) return
               if (.not. fit%candidate(k)%errors_known) cycle
               call check(error, distance(fit%candidate(k)%model, other%candidate(k)%model) < rounding, fit%candidate(k)%name)
            end do
            if (allocated(error)) return
         end do
         deallocate (z, slow)
      end do
   end subroutine test_short_reversal

   !> Largest difference of the numbers of two models, over the numbers.
   pure real(dp) function distance(one, two)
      type(component_model_type), intent(in) :: one, two
      real(dp) :: a(2*one%count + 1), b(2*one%count + 1)

      a = [one%phi(:one%count), one%q(:one%count), one%r]
      b = [two%phi(:one%count), two%q(:one%count), two%r]
      distance = maxval(abs(a - b)/max(abs(a), tiny(a)))
   end function distance

   !> A tenth of the samples is missing, with nonsense in their place.
   subroutine test_gaps()
      type(drift_fit_type) :: fit
      real(dp) :: z(12000), u(12000)
      integer(int8) :: here(12000)

      call make_series(37, 0.95_dp, 1.0_dp, 1.0_dp, z)
      call fill_noise(38, u)
      here = 1_int8
      where (u > 1.28_dp)
         here = 0_int8
         z = 0.0_dp
      end where
      call fit_drift(z, fit, failed, here)
      if (went_wrong(failed)) return
      associate (found => fit%candidate(number_of(fit, "ar1")))
         call check(error, abs(found%model%phi(1) - 0.95_dp) <= 4*found%std_error%phi(1))
         call check(error, abs(found%model%r - 1.0_dp) <= 4*found%std_error%r)
      end associate
   end subroutine test_gaps

   !> Of a long record the middle.
   subroutine test_long()
      type(drift_fit_type) :: fit
      real(dp) :: z(3002)

      call make_series(39, 0.9_dp, 1.0_dp, 1.0_dp, z)
      z([1, 3002]) = 1.0e6_dp
      call fit_drift(z, fit, failed, most=3000_int64)
      call check(error, fit%samples == 3000_int64 .and. fit%first == 2_int64)
      associate (found => fit%candidate(number_of(fit, "ar1")))
         call check(error, found%model%r, 1.0_dp, thr=4*found%std_error%r)
      end associate
   end subroutine test_long

   subroutine test_slow()
      real(dp), parameter :: phi(3) = [0.8_dp, 1.0_dp, -0.99_dp]

      call check(error, all(is_slow(phi, 5.0_dp) .eqv. [.false., .true., .false.]))
      call check(error, all(is_slow(phi, 4.0_dp) .eqv. [.true., .true., .false.]))
   end subroutine test_slow

   subroutine test_refused()
      type(drift_fit_type) :: fit
      real(dp) :: z(60)

      call fill_noise(40, z)
      call fit_drift(z(:49), fit, failed)
      call check_refused(failed, status%too_few_samples)
      z = 3.0_dp
      call fit_drift(z, fit, failed)
      call check_refused(failed, status%constant_input)
   end subroutine test_refused

end module test_drift_fit
