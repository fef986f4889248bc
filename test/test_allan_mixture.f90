! SPDX-License-Identifier: MIT
!> Tests of the degrees of freedom and limits of a noise mixture, against the sums that define them, against the power laws of
!> Greenhall & Riley (2003) and against the scatter of simulated records.
module test_allan_mixture
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_allan_covariance, only : covariance_basis_type, mixture_freedom, new_covariance_basis
   use gyroakf_allan_degrees_of_freedom, only : greenhall_edf
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_mixture_edf, only : mixture_degrees_of_freedom
   use gyroakf_allan_mixture_limits, only : give_mixture_limits
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : column_count, noise_model_type, term_flicker, term_quantisation, term_walk, term_white
   use gyroakf_allan_phase_covariance, only : phase_covariance
   use gyroakf_allan_statistic, only : longest_factor, statistic_names, term_count
   use allan_series, only : normal_series, walk_of
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_mixture

   !> Pi
   real(dp), parameter :: pi = 3.141592653589793_dp

contains

   !> The tests of this suite.
   subroutine collect_allan_mixture(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("by_definition", test_definition), &
         & new_unittest("total_coarse", test_total_coarse), &
         & new_unittest("quadrature", test_quadrature), &
         & new_unittest("long_record", test_long_record), &
         & new_unittest("power_laws", test_power_laws), &
         & new_unittest("overlapping_allan", test_overlapping), &
         & new_unittest("sinusoid", test_sinusoid), &
         & new_unittest("scatter", test_scatter), &
         & new_unittest("limits", test_limits), &
         & new_unittest("total_at_short_times", test_total_short), &
         & new_unittest("dense_curve", test_dense), &
         & new_unittest("nothing", test_nothing)]
   end subroutine collect_allan_mixture

   !> A mixture.
   pure function mixture(squares, time, frequency) result(model)
      !> Q^2 N^2 B^2 K^2 R^2, Markov, sinusoid
      real(dp), intent(in) :: squares(column_count)
      !> Correlation time and frequency
      real(dp), intent(in), optional :: time, frequency
      type(noise_model_type) :: model

      model%squares = squares
      if (present(time)) model%correlation_time = time
      if (present(frequency)) model%frequency = frequency
   end function mixture

   !> Weights of the phase x(0:n) in term k of a statistic; a phase beyond an end is that of the reflection.
   pure function weights_of(kind, n, m, k) result(w)
      !> Statistic
      character(*), intent(in) :: kind
      !> Samples, averaging factor, term from 1
      integer, intent(in) :: n, m, k
      real(dp) :: w(0:n)

      integer :: p, i

      w = 0
      select case (kind)
      case ("adev", "oadev", "totdev")
         p = merge((k - 1)*m, merge(k - m, k - 1, kind == "totdev"), kind == "adev")
         do i = 0, 2
            call put(p + i*m, real([1, -2, 1], dp))
         end do
      case ("hdev", "ohdev")
         p = merge((k - 1)*m, k - 1, kind == "hdev")
         w([p, p + m, p + 2*m, p + 3*m]) = [1, -3, 3, -1]
      case default
         do p = k - 1, k + m - 2
            w([p, p + m, p + 2*m]) = w([p, p + m, p + 2*m]) + real([1, -2, 1], dp)/m
         end do
      end select

   contains

      !> Adds a weight at a place, or at its mirror image.
      pure subroutine put(place, weight)
         integer, intent(in) :: place
         real(dp), intent(in) :: weight(0:)

         integer :: mirror, last

         mirror = place
         if (place >= 0 .and. place <= n) then
            w(place) = w(place) + weight(i)
            return
         end if
         last = merge(0, n, place < 0)
         mirror = 2*last - place
         w(last) = w(last) + 2*weight(i)
         w(mirror) = w(mirror) - weight(i)
      end subroutine put

   end function weights_of

   !> Degrees of freedom from the covariance matrix of all terms.
   pure real(dp) function edf_by_definition(kind, n, m, model) result(edf)
      !> Statistic
      character(*), intent(in) :: kind
      !> Samples, averaging factor
      integer, intent(in) :: n, m
      !> The mixture, its sinusoid with any phase
      type(noise_model_type), intent(in) :: model

      real(dp), allocatable :: w(:, :), c(:, :), r(:, :), mean(:, :)
      integer :: i, k

      allocate (w(0:n, term_count(kind, int(n, int64), int(m, int64))), c(0:n, 0:n), mean(0:n, 3))
      do k = 1, size(w, 2)
         w(:, k) = weights_of(kind, n, m, k)
      end do
      do i = 0, n
         c(:, i) = phase_covariance(model, real([(k - i, k=0, n)], dp))
         c(i, i) = c(i, i) + model%squares(term_quantisation)
         mean(i, 1) = sqrt(model%squares(5))*real(i, dp)**2/2
         mean(i, 2:3) = sqrt(model%squares(7)/2)*[cos(2*pi*model%frequency*i), sin(2*pi*model%frequency*i)] &
            & /(2*sin(pi*model%frequency))
      end do
      r = matmul(transpose(w), matmul(c, w))
      mean = matmul(transpose(w), mean)
      edf = 2*(sum([(r(k, k), k=1, size(r, 1))]) + sum(mean**2))**2/(2*sum(r**2) + 4*sum(mean*matmul(r, mean)))
   end function edf_by_definition

   subroutine agree(error, found, expected, tolerance, kind, m)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> Numbers to compare, relative tolerance
      real(dp), intent(in) :: found, expected, tolerance
      !> What was asked
      character(*), intent(in) :: kind
      integer, intent(in) :: m

      character(100) :: text

      write (text, "(2a, i0, 2(a, f0.5))") kind, " m ", m, ": ", found, " is not ", expected
      call check(error, abs(found/expected - 1) <= tolerance, trim(text))
   end subroutine agree

   subroutine test_definition(error)
      type(error_type), allocatable, intent(out) :: error

      ! every kind, every term: exact (but for lags above 40 m) beside the flicker noise of mdev at few samples (0.6 %) and its
      ! tail in totdev (0.01 %)
      integer, parameter :: n = 150, m(5) = [1, 2, 7, 32, 50]
      type(noise_model_type) :: model
      integer :: i, kind, case
      real(dp), parameter :: squares(column_count, 4) = reshape([1.0_dp, 0.3_dp, 0.0_dp, 1.0e-3_dp, 1.0e-6_dp, 0.5_dp, 0.0_dp, &
         & 0.0_dp, 1.0_dp, 0.3_dp, 1.0e-4_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
         & 0.1_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0e-5_dp, 1.0_dp, 0.0_dp], [column_count, 4])

      do case = 1, 4
         model = mixture(squares(:, case), time=12.0_dp)
         do kind = 1, size(statistic_names)
            do i = 1, size(m)
               if (m(i) > longest_factor(statistic_names(kind), int(n, int64))) cycle
               if (m(i) > 32 .and. statistic_names(kind) == "totdev") cycle
               call agree(error, mixture_degrees_of_freedom(statistic_names(kind), int(n, int64), int(m(i), int64), model), &
                  & edf_by_definition(statistic_names(kind), n, m(i), model), &
                  & merge(merge(6.0e-3_dp, 2.0e-4_dp, m(i) == 2), 1.0e-6_dp, squares(term_flicker, case) > 0), &
                  & statistic_names(kind), m(i))
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_definition

   subroutine test_total_coarse(error)
      type(error_type), allocatable, intent(out) :: error

      ! m above 32: the phase at m/32 samples; quantisation noise alone is the worst
      integer, parameter :: n = 300, m(3) = [50, 97, 150]
      type(noise_model_type) :: model
      real(dp) :: tolerance
      integer :: i, term

      do term = 1, 6
         model = noise_model_type()
         model%squares(term) = 1
         if (term == 5) model%squares(term_white:term_walk) = [1.0_dp, 0.3_dp, 1.0e-4_dp]
         if (term == 5) model%squares(5) = 1.0e-6_dp
         model%correlation_time = 20
         tolerance = merge(0.02_dp, 3.0e-3_dp, term == term_quantisation)
         do i = 1, size(m)
            call agree(error, mixture_degrees_of_freedom("totdev", int(n, int64), int(m(i), int64), model), &
               & edf_by_definition("totdev", n, m(i), model), tolerance, "totdev", m(i))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_total_coarse

   subroutine test_quadrature(error)
      type(error_type), allocatable, intent(out) :: error

      ! the sum over 20,001 lags, term by term, against quadrature between the kinks
      integer, parameter :: n = 29000, m = 3000
      real(dp), parameter :: squares(column_count) = [300.0_dp, 1.0_dp, 1.0e-3_dp, 1.0e-7_dp, 0.0_dp, 1.0e-3_dp, 0.0_dp]
      real(dp), parameter :: time(3) = [5.0_dp, 400.0_dp, 9000.0_dp], weight(0:3) = [20.0_dp, -15.0_dp, 6.0_dp, -1.0_dp]
      type(noise_model_type) :: model
      real(dp), allocatable :: r(:), s(:)
      integer :: i, k, terms

      terms = n - 3*m + 1
      allocate (r(0:terms - 1), s(-3*m:terms + 3*m))
      do i = 1, size(time)
         model = mixture(squares, time(i))
         s = phase_covariance(model, real([(k, k=lbound(s, 1), ubound(s, 1))], dp))
         s(0) = s(0) + squares(term_quantisation)
         do k = 0, terms - 1
            r(k) = weight(0)*s(k) + weight(1)*(s(k - m) + s(k + m)) + weight(2)*(s(k - 2*m) + s(k + 2*m)) &
               & + weight(3)*(s(k - 3*m) + s(k + 3*m))
         end do
         call agree(error, mixture_degrees_of_freedom("ohdev", int(n, int64), int(m, int64), model), &
            & (terms*r(0))**2/(terms*r(0)**2 + 2*sum(real([(terms - k, k=1, terms - 1)], dp)*r(1:)**2)), 2.0e-3_dp, "ohdev", m)
         if (allocated(error)) return
      end do
   end subroutine test_quadrature

   subroutine test_long_record(error)
      type(error_type), allocatable, intent(out) :: error

      ! degrees of freedom grow as the record: 10,000 and 1,000,000 samples at the same averaging times, where the way of the sum
      ! changes (m about 50 and 77) too
      integer(int64), parameter :: m(6) = [1_int64, 2_int64, 20_int64, 51_int64, 52_int64, 77_int64]
      type(noise_model_type) :: model
      real(dp) :: short, long, terms
      integer :: i, kind

      model = mixture([1.0_dp, 1.0_dp, 1.0e-2_dp, 1.0e-5_dp, 0.0_dp, 0.1_dp, 0.0_dp], 30.0_dp)
      do kind = 1, size(statistic_names)
         do i = 1, size(m)
            short = mixture_degrees_of_freedom(statistic_names(kind), 10000_int64, m(i), model)
            long = mixture_degrees_of_freedom(statistic_names(kind), 1000000_int64, m(i), model)
            terms = real(term_count(statistic_names(kind), 10000_int64, m(i)), dp) &
               & /real(term_count(statistic_names(kind), 1000000_int64, m(i)), dp)
            call agree(error, short, long*terms, 0.015_dp, statistic_names(kind), int(m(i)))
            if (allocated(error)) return
         end do
         ! neighbours on both sides of the change
         call agree(error, mixture_degrees_of_freedom(statistic_names(kind), 10000_int64, m(4), model)*51, &
            & mixture_degrees_of_freedom(statistic_names(kind), 10000_int64, m(5), model)*52, 0.008_dp, statistic_names(kind), 51)
         if (allocated(error)) return
      end do
   end subroutine test_long_record

   subroutine test_power_laws(error)
      type(error_type), allocatable, intent(out) :: error

      ! one term alone, long times; the tables of the paper hold to about 1 %
      integer(int64), parameter :: n = 100000, m = 2000
      integer, parameter :: term(4) = [term_quantisation, term_white, term_flicker, term_walk], alpha(4) = [2, 0, -1, -2]
      character(5), parameter :: kinds(5) = ["adev ", "oadev", "mdev ", "hdev ", "ohdev"]
      real(dp), parameter :: b(2:4) = [1.50_dp, 1.17_dp, 0.93_dp], c(2:4) = [0.0_dp, 0.22_dp, 0.36_dp]
      type(noise_model_type) :: model
      real(dp) :: edf(5)
      integer :: i, k

      do i = 1, 4
         model = noise_model_type()
         model%squares(term(i)) = 1
         edf = [greenhall_edf(n + 1, m, alpha(i), 2, .false., .false.), greenhall_edf(n + 1, m, alpha(i), 2, .false., .true.), &
            & greenhall_edf(n + 1, m, alpha(i), 2, .true., .true.), greenhall_edf(n + 1, m, alpha(i), 3, .false., .false.), &
            & greenhall_edf(n + 1, m, alpha(i), 3, .false., .true.)]
         do k = 1, 5
            call agree(error, mixture_degrees_of_freedom(kinds(k), n, m, model), edf(k), 0.012_dp, kinds(k), int(m))
            if (allocated(error)) return
         end do
         if (i == 1) cycle
         ! published for the total variance, T/tau = 50, coefficients of three digits
         call agree(error, mixture_degrees_of_freedom("totdev", n, m, model), b(i)*50 - c(i), 0.012_dp, "totdev", int(m))
         if (allocated(error)) return
      end do
   end subroutine test_power_laws

   subroutine test_overlapping(error)
      type(error_type), allocatable, intent(out) :: error

      ! two ways to the degrees of freedom of the overlapping Allan variance
      real(dp), parameter :: squares(column_count) = [2.0_dp, 1.0_dp, 1.0e-2_dp, 1.0e-5_dp, 1.0e-12_dp, 0.1_dp, 1.0e-3_dp]
      integer(int64), parameter :: n = 200000, m(5) = [1_int64, 10_int64, 300_int64, 8000_int64, 66000_int64]
      type(noise_model_type) :: model
      type(covariance_basis_type) :: basis
      real(dp) :: freedom(5)
      integer :: i

      model = mixture(squares, 100.0_dp, 0.01_dp)
      call new_covariance_basis(n, m, basis, model%correlation_time)
      freedom = mixture_freedom(basis, model)
      do i = 1, size(m)
         call agree(error, mixture_degrees_of_freedom("oadev", n, m(i), model), freedom(i), 0.01_dp, &
            & "oadev", int(m(i)))
         if (allocated(error)) return
      end do
   end subroutine test_overlapping

   subroutine test_sinusoid(error)
      type(error_type), allocatable, intent(out) :: error

      ! noise and a sinusoid of many periods: spectrum instead of the double sum
      integer, parameter :: n = 400, m(3) = [3, 12, 35]
      character(5), parameter :: kinds(3) = ["oadev", "mdev ", "ohdev"]
      type(noise_model_type) :: model
      integer :: i, kind

      model = mixture([0.1_dp, 1.0_dp, 0.0_dp, 1.0e-3_dp, 0.0_dp, 0.0_dp, 2.0_dp], frequency=0.041_dp)
      do kind = 1, 3
         do i = 1, size(m)
            call agree(error, mixture_degrees_of_freedom(trim(kinds(kind)), int(n, int64), int(m(i), int64), model), &
               & edf_by_definition(trim(kinds(kind)), n, m(i), model), 0.05_dp, kinds(kind), m(i))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_sinusoid

   subroutine test_scatter(error)
      type(error_type), allocatable, intent(out) :: error

      ! white noise and a random walk that meet at m = 8: scatter of the variances of 600 records
      integer, parameter :: n = 600, runs = 600, m(3) = [1, 8, 64]
      type(allan_curve_type) :: curve
      type(allan_options) :: options
      type(gyro_error), allocatable :: failure
      type(noise_model_type) :: model
      real(dp) :: first(3), second(3), x(n*runs)
      integer :: run, kind, i

      model = mixture([0.0_dp, 1.0_dp, 0.0_dp, 0.05_dp, 0.0_dp, 0.0_dp, 0.0_dp])
      x = normal_series(size(x, kind=int64), 4711_int64)
      do run = 1, runs
         associate (part => x((run - 1)*n + 1:run*n))
            part = part + sqrt(0.05_dp)*walk_of(normal_series(int(n, int64), int(90000 + run, int64)), &
               & normal_series(int(n, int64), int(50000 + run, int64)))
         end associate
      end do
      options%taus = "1,8,64"
      do kind = 1, size(statistic_names)
         options%kind = statistic_names(kind)
         first = 0
         second = 0
         do run = 1, runs
            call compute_allan(x((run - 1)*n + 1:run*n), 1.0_dp, options, curve, failure)
            first = first + curve%deviation**2/runs
            second = second + curve%deviation**4/runs
         end do
         do i = 1, 3
            ! four standard errors of a variance: sqrt(2/600), more at few degrees of freedom
            call agree(error, mixture_degrees_of_freedom(statistic_names(kind), int(n, int64), int(m(i), int64), model), &
               & 2*first(i)**2/(second(i) - first(i)**2), 0.24_dp, statistic_names(kind), m(i))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_scatter

   !> Curves of two kinds of a record, and its fit.
   subroutine fitted(error, kind, taus, curve, other, noise)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> Statistic and grid
      character(*), intent(in) :: kind, taus
      !> oadev, with the limits of the fit; the other kind, as it was computed
      type(allan_curve_type), intent(out) :: curve, other
      type(noise_type), intent(out) :: noise

      type(allan_options) :: options
      type(gyro_error), allocatable :: failure
      real(dp) :: rate(20000)

      rate = normal_series(20000_int64, 12_int64) + 0.01_dp*walk_of(normal_series(20000_int64, 5_int64), &
         & normal_series(20000_int64, 6_int64))
      options%taus = taus
      call compute_allan(rate, 0.01_dp, options, curve, failure)
      options%kind = kind
      if (.not. allocated(failure)) call compute_allan(rate, 0.01_dp, options, other, failure)
      if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
      call check(error,.not. allocated(failure), "no curve or no fit")
   end subroutine fitted

   subroutine test_limits(error)
      type(error_type), allocatable, intent(out) :: error

      ! the sample interval is in the coefficients: oadev gets what the fit gave it; a misfit never raises the degrees of freedom
      type(allan_curve_type) :: curve, other, before
      type(noise_type) :: noise

      call fitted(error, "oadev", "octave", curve, other, noise)
      if (allocated(error)) return
      before = other
      call give_mixture_limits(other, noise)
      call check(error, all(abs(other%edf/curve%edf - 1) < 0.01_dp), "edf of oadev")
      if (allocated(error)) return
      call check(error, all(abs(other%upper/curve%upper - 1) < 0.01_dp .and. abs(other%lower/curve%lower - 1) < 0.01_dp), "limits")
      if (allocated(error)) return
      call check(error, any(abs(other%edf/before%edf - 1) > 0.02_dp), "the limits are not new")
      if (allocated(error)) return
      noise%misfit = 0.1_dp
      other = before
      call give_mixture_limits(other, noise)
      call check(error, all(other%edf <= before%edf), "a misfit raised the degrees of freedom")
   end subroutine test_limits

   subroutine test_total_short(error)
      type(error_type), allocatable, intent(out) :: error

      ! at m = 1 the total variance is the overlapping Allan variance; the published formula is for long times
      type(allan_curve_type) :: curve, other
      type(noise_type) :: noise

      call fitted(error, "totdev", "octave", curve, other, noise)
      if (allocated(error)) return
      call check(error, other%edf(1) > 1.5_dp*curve%edf(1), "the published formula has changed")
      if (allocated(error)) return
      call give_mixture_limits(other, noise)
      call check(error, other%edf(1), curve%edf(1), thr=1.0e-3_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, all(other%edf > curve%edf*0.999_dp) .and. other%edf(size(other%edf)) > 1.3_dp*curve%edf(size(curve%edf)), &
         & "the total deviation knows more at long times")
   end subroutine test_total_short

   subroutine test_dense(error)
      type(error_type), allocatable, intent(out) :: error

      ! thousands of averaging times: interpolated between 160
      type(allan_curve_type) :: curve, other
      type(noise_type) :: noise
      type(noise_model_type) :: model
      integer :: i

      call fitted(error, "mdev", "all", curve, other, noise)
      if (allocated(error)) return
      call give_mixture_limits(other, noise)
      model = noise%mixture
      do i = 1, size(other%m), 411
         call agree(error, other%edf(i), mixture_degrees_of_freedom("mdev", 20000_int64, other%m(i), model), 0.01_dp, "mdev", i)
         if (allocated(error)) return
      end do
   end subroutine test_dense

   subroutine test_nothing(error)
      type(error_type), allocatable, intent(out) :: error

      ! an empty curve, and a mixture of nothing
      type(allan_curve_type) :: curve
      type(noise_model_type) :: model

      call give_mixture_limits(curve, noise_type())
      call check(error,.not. allocated(curve%edf), "a curve out of nothing")
      if (allocated(error)) return
      call check(error, mixture_degrees_of_freedom("mdev", 1000_int64, 10_int64, model) >= 1.0e15_dp, "no noise, no scatter")
      if (allocated(error)) return
      call check(error, mixture_degrees_of_freedom("totdev", 1000_int64, 10_int64, model) >= 1.0e15_dp, "no noise, no scatter")
   end subroutine test_nothing

end module test_allan_mixture
