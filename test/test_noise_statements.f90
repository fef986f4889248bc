! SPDX-License-Identifier: MIT
!> Tests of what a noise fit states of filtered, gapped, short and coarsely quantized records.
module test_noise_statements
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use allan_series, only : normal_series, uniform_series, walk_of, correlated, not_fitted, &
      & mixed_record
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_noise_statements

contains

   subroutine suite_noise_statements()
      call test("gaps", test_gaps)
      call test("scattered_losses", test_scattered_losses)
      call test("periodic_losses", test_periodic_losses)
      call test("walk_or_ramp", test_walk_or_ramp)
      call test("filtered", test_filtered)
      call test("end_excluded", test_end_excluded)
      call test("not_described", test_not_described)
      call test("own_range", test_own_range)
      call test("short_records", test_short_records)
      call test("quantized", test_quantized)
      call test("quantized_without_N", test_quantized_without_n)
   end subroutine suite_noise_statements

   subroutine test_gaps()
      ! 0.3 % and 5 % of the samples lost at random leave every coefficient within one standard error
      integer, parameter :: n = 20000
      real(dp), parameter :: share(2) = [0.003_dp, 0.05_dp]
      type(allan_curve_type) :: curve
      type(noise_options) :: options
      type(noise_type) :: whole, part
      integer(int8) :: valid(n)
      real(dp) :: rate(n)
      integer :: i, j

      options%terms = "NBK"
      rate = mixed_record(n)
      if (not_fitted(rate, 1.0_dp, options, curve, whole)) return
      do i = 1, 2
         valid = merge(0_int8, 1_int8, uniform_series(int(n, int64), 271828_int64) < share(i))
         if (not_fitted(merge(rate, 1.0e9_dp, valid == 1), 1.0_dp, options, curve, part, valid)) return
         do j = 2, 4
            call check(error, abs(part%coefficient(j)%value - whole%coefficient(j)%value) < whole%coefficient(j)%std_error, &
               & "a coefficient moved")
         end do
      end do
   end subroutine test_gaps

   subroutine test_scattered_losses()
      ! 100 records that lose 10 % at random: N is unbiased, and its stated error that of the records within 25 %
      integer, parameter :: records = 100, n = 4000
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: value(records), stated, deviation
      integer :: i

      stated = 0
      do i = 1, records
         if (not_fitted(normal_series(int(n, int64), int(i*7777, int64)), 1.0_dp, noise_options(), curve, noise, &
            & merge(0_int8, 1_int8, uniform_series(int(n, int64), int(i*271828, int64)) < 0.1_dp))) return
         value(i) = noise%coefficient(2)%value
         stated = stated + noise%coefficient(2)%std_error/records
      end do
      deviation = sqrt(sum((value - sum(value)/records)**2)/(records - 1))
      call check(error, abs(sum(value)/records - 1) < 4*deviation/sqrt(real(records, dp)), "a bias")
      call check(error, stated/deviation, 1.0_dp, thr=0.25_dp)
   end subroutine test_scattered_losses

   subroutine test_periodic_losses()
      ! every 3rd to 20th sample lost: all octaves stay, N is right; complete windows alone, where asked for
      integer, parameter :: n = 65536
      type(allan_curve_type) :: curve
      type(allan_options) :: strict
      type(noise_type) :: noise
      integer(int8) :: valid(n)
      integer :: every, i

      do every = 3, 20
         valid = [(merge(0_int8, 1_int8, mod(i, every) == 0), i=1, n)]
         if (not_fitted(normal_series(int(n, int64), 4242_int64), 1.0_dp, noise_options(), curve, noise, valid)) return
         associate (c => noise%coefficient(2))
            call check(error, noise%points == 15 .and. c%detected .and. abs(c%value - 1) < 3*c%std_error .and. &
               & c%std_error < 0.005_dp, "N")
         end associate
         if (allocated(error)) return
      end do
      strict%min_coverage = 1.0_dp
      call compute_allan(normal_series(int(n, int64), 4242_int64), 1.0_dp, strict, curve, failure, valid)
      call check(error, .not. allocated(failure) .and. maxval(curve%m) == 8, "windows of more than 9 samples")
   end subroutine test_periodic_losses

   subroutine test_walk_or_ramp()
      ! random walks whose last octaves rise like a ramp: a ramp free of noise does not fit them, so R moves like a random walk,
      ! and the errors of N stay as they are
      integer, parameter :: seeds(2) = [285, 2337], samples = 10000
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp) :: g(3*samples)
      integer :: i

      do i = 1, size(seeds)
         g = normal_series(size(g, kind=int64), int(7919*seeds(i), int64))
         if (not_fitted(g(:samples) + 0.02_dp*walk_of(g(samples + 1:2*samples), g(2*samples + 1:)), 1.0_dp, &
            & noise_options(), curve, noise)) return
         call check(error, noise%squares(5) > 0 .and. .not. noise%errors_increased, "the errors are increased")
      end do
   end subroutine test_walk_or_ramp

   subroutine test_filtered()
      ! an AR(1) with phi = 0.5 is white of N = 1/(1 - phi) = 2 to long times; the first points are bent down
      type(allan_curve_type) :: before, curve
      type(noise_type) :: noise
      real(dp) :: rate(50000)

      rate = correlated(50000, 0.5_dp, 8_int64)
      call compute_allan(rate, 1.0_dp, allan_options(), before, failure)
      if (went_wrong(failure, "the curve")) return
      curve = before
      call fit_noise(curve, noise_options(), noise, failure)
      if (unmet(.not. allocated(failure) .and. noise%left_out > 0 .and. noise%described, "points are excluded")) return
      call check(error, all(curve%edf(:noise%left_out) <= before%edf(:noise%left_out)), "no narrower limits where excluded")
      call check(error, noise%tau_first, real(2**noise%left_out, dp), thr=1.0e-12_dp)
      associate (n => noise%coefficient(2))
         call check(error, abs(n%value - 2) < 3*n%std_error .and. n%std_error < 0.04_dp, "N of long times")
      end associate
      call check(error, noise%coefficient(1)%state == "withheld" .and. .not. any(noise%coefficient([3, 4, 5])%detected), &
         & "no other term, and nothing of Q")
   end subroutine test_filtered

   subroutine test_end_excluded()
      ! a slow cycle that no term follows: the run ends before it, N stands, B, K and R are withheld
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      integer :: i

      if (not_fitted(normal_series(50000_int64, 31_int64) + [(0.5_dp*sin(6.283185307179586_dp*i/5000), i=1, 50000)], &
         & 1.0_dp, noise_options(), curve, noise)) return
      call check(error, noise%described .and. noise%cut_off > 0 .and. noise%left_out == 0, "the end is excluded")
      call check(error, all(noise%coefficient(4:)%state == "withheld") .and. noise%coefficient(3)%state /= "value", "K and R")
      associate (n => noise%coefficient(2))
         call check(error, n%detected .and. abs(n%value - 1) < 4*n%std_error, "N")
      end associate
   end subroutine test_end_excluded

   subroutine test_not_described()
      ! slow Markov noise alone: its curve rises, turns and falls, and no five octaves are a sum of the terms
      type(allan_curve_type) :: before, curve
      type(noise_type) :: noise
      real(dp) :: rate(200000)

      rate = correlated(200000, 0.98_dp, 9_int64)
      call compute_allan(rate, 1.0_dp, allan_options(), before, failure)
      curve = before
      if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
      if (unmet(.not. allocated(failure) .and. .not. noise%described, "nothing describes it")) return
      call check(error, all(noise%coefficient%state == "withheld") .and. .not. any(noise%coefficient%fitted), "all is withheld")
      call check(error, all(abs(curve%edf - before%edf) <= 0) .and. all(noise%model <= 0), "the curve stays as it was")
   end subroutine test_not_described

   subroutine test_own_range()
      ! points of the user are fitted whatever they look like, and the goodness of the fit says it
      type(allan_curve_type) :: curve
      type(noise_type) :: noise

      if (not_fitted(correlated(50000, 0.5_dp, 8_int64), 1.0_dp, noise_options("QNBKR"), curve, noise)) return
      call check(error, noise%left_out == 0 .and. noise%chi2_probability < 1.0e-6_dp .and. noise%floor > 0.01_dp, "a bad fit")
      if (not_fitted(correlated(50000, 0.5_dp, 8_int64), 1.0_dp, noise_options(tau_min=30.0_dp, tau_max=600.0_dp), &
         & curve, noise)) return
      call check(error, abs(noise%tau_first - 32) <= 0 .and. abs(noise%tau_last - 512) <= 0 .and. noise%points == 5, "the range")
      call check(error, abs(noise%coefficient(2)%value - 2) < 4*noise%coefficient(2)%std_error, "N of the range")
   end subroutine test_own_range

   subroutine test_short_records()
      ! fewer than six octaves: N alone, from 2 samples on
      integer, parameter :: lengths(5) = [2, 3, 7, 40, 127]
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      integer :: i

      do i = 1, size(lengths)
         if (not_fitted(3*normal_series(int(lengths(i), int64), 77_int64), 1.0_dp, noise_options(), curve, noise)) return
         associate (n => noise%coefficient(2))
            call check(error, n%detected .and. abs(n%value - 3) < 4*n%std_error .and. &
               & all(noise%coefficient([1, 3, 4, 5])%state == "withheld"), "N alone")
         end associate
         if (allocated(error)) return
      end do
   end subroutine test_short_records

   subroutine test_quantized()
      ! steps of 0.05, 1, 2 and 4 standard deviations: of no account; N without quantization is that before rounding; withheld
      real(dp), parameter :: lsb(4) = [0.05_dp, 1.0_dp, 1.9_dp, 4.0_dp]
      character(8), parameter :: state(4) = [character(8) :: "", "value", "value", "withheld"]
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      integer :: i

      do i = 1, size(lsb)
         if (not_fitted(lsb(i)*anint((normal_series(50000_int64, 5_int64) + 0.3_dp)/lsb(i)), 1.0_dp, &
            & noise_options(lsb=lsb(i)), curve, noise)) return
         call check(error, noise%unquantized%state, trim(state(i)))
         associate (n => noise%coefficient(2), u => noise%unquantized)
            call check(error, n%state == "value" .and. noise%lsb_ratio > 0.9_dp*lsb(i) .and. (i == 4 .or. &
               & noise%lsb_ratio < 1.1_dp*lsb(i)), "N as quantized, and the step in standard deviations")
            if (u%state /= "value") cycle
            call check(error, abs(u%value - 1) < 3*u%std_error .and. u%std_error > n%std_error .and. u%fitted, "N before rounding")
            call check(error, u%value**2 + lsb(i)**2/12, n%value**2, thr=1.0e-12_dp)
         end associate
         if (allocated(error)) return
      end do
   end subroutine test_quantized

   subroutine test_quantized_without_n()
      ! where N is withheld N without quantization is withheld
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(dp), parameter :: lsb = 1.0_dp

      if (not_fitted(lsb*anint(correlated(200000, 0.98_dp, 9_int64)/lsb), 1.0_dp, noise_options(lsb=lsb), curve, noise)) return
      call check(error, noise%coefficient(2)%state == "withheld" .and. noise%unquantized%state == "" .and. &
         & .not. noise%unquantized%fitted, "N without quantization")
   end subroutine test_quantized_without_n

end module test_noise_statements
