! SPDX-License-Identifier: MIT
!> Coefficients as they are stated: in the usual unit, in SI, N as both densities, each with its convention.
module test_conventions
   use expectations, only : failed => problem, test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_coefficient_units, only : coefficient_definition
   use gyroakf_units, only : unit_type, parse_unit
   use gyroakf_allan_noise_fit, only : noise_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_coefficients, only : state_noise
   use gyroakf_pipeline_result, only : pipeline_result_type, stated_noise_type, stage
   use gyroakf_record, only : record_type
   use gyroakf_report_document_allan, only : put_noise
   use gyroakf_report_text_description, only : text_description_type
   use report_fixture, only : make_record, make_result, begin_text, end_text
   implicit none (type, external)
   private
   public :: suite_conventions

   !> A few roundings
   real(dp), parameter :: thr = 8*epsilon(1.0_dp)

contains

   subroutine suite_conventions()
      call test("rate", test_rate)
      call test("acceleration", test_acceleration)
      call test("densities", test_densities)
      call test("nothing-known", test_nothing_known)
      call test("definitions-hold", test_definitions)
      call test("text", test_text)
      call test("text-nothing-known", test_text_nothing_known)
   end subroutine suite_conventions

   !> Five coefficients of 1 in the unit of the record and seconds, errors 0.5, limits 2.
   subroutine state_ones(unit_name, stated, rate_known)
      character(*), intent(in) :: unit_name
      type(stated_noise_type), intent(out) :: stated
      logical, intent(in) :: rate_known
      type(noise_type) :: noise
      type(unit_type) :: unit

      noise%coefficient%value = 1
      noise%coefficient%std_error = 0.5_dp
      noise%coefficient%upper_limit = 2
      noise%coefficient%detected = .true.
      noise%coefficient%fitted = .true.
      if (unit_name /= "") call parse_unit(unit_name, unit, failed)
      call state_noise(noise, rate_known, unit, stated)
   end subroutine state_ones

   !> All ones of a record in one unit: stated values, SI values, SI units.
   subroutine check_ones(unit_name, expected, si, si_name)
      character(*), intent(in) :: unit_name, si_name(5)
      real(dp), intent(in) :: expected(5), si
      type(stated_noise_type) :: stated
      integer :: i

      call state_ones(unit_name, stated, .true.)
      do i = 1, 5
         call check(error, stated%term(i)%value, expected(i), thr=thr, rel=.true.)
         call check(error, stated%term(i)%value_si, si, thr=thr, rel=.true.)
         call check(error, stated%term(i)%std_error_si, si/2, thr=thr, rel=.true.)
         call check(error, stated%term(i)%upper_limit_si, 2*si, thr=thr, rel=.true.)
         call check(error, stated%term(i)%unit_si, trim(si_name(i)))
      end do
   end subroutine check_ones

   !> Of deg/h: Q deg/h s = arcsec, N (deg/h) sqrt(s) = 1/60 deg/sqrt(h), B deg/h, K (deg/h)/sqrt(s) = 60 deg/h^1.5, R 3600.
   subroutine test_rate()
      character(11), parameter :: si_name(5) = [character(11) :: "rad", "rad/sqrt(s)", "rad/s", "rad/s^1.5", "rad/s^2"]

      call check_ones("deg/h", [1.0_dp, 1/60.0_dp, 1.0_dp, 60.0_dp, 3600.0_dp], acos(-1.0_dp)/648000, si_name)
      call check_ones("rad/s", [206264.80624709636_dp, 3437.746770784939_dp, 206264.80624709636_dp, &
                                       12375888.374825781_dp, 742553302.4895469_dp], 1.0_dp, si_name)
   end subroutine test_rate

   subroutine test_acceleration()
      character(11), parameter :: si_name(5) = [character(11) :: "m/s", "m/s/sqrt(s)", "m/s^2", "m/s^2.5", "m/s^3"]
      real(dp), parameter :: g = 9.80665_dp

      call check_ones("mg", [g*1.0e-3_dp, 0.06_dp*g, 1.0e3_dp, 6.0e4_dp, 3.6e6_dp], g*1.0e-3_dp, si_name)
      call check_ones("m/s^2", [1.0_dp, 60.0_dp, 1/9.80665e-6_dp, 60/9.80665e-6_dp, 3600/9.80665e-6_dp], 1.0_dp, si_name)
   end subroutine test_acceleration

   !> Of N = 1 (deg/s) sqrt(s): 1 and sqrt(2) deg/s/sqrt(Hz).
   subroutine test_densities()
      type(stated_noise_type) :: stated
      real(dp), parameter :: root(2) = [1.0_dp, 1.4142135623730951_dp]
      integer :: i

      call state_ones("deg/s", stated, .true.)
      do i = 1, 2
         associate (density => stated%density(i))
            call check(error, density%value, root(i), thr=thr, rel=.true.)
            call check(error, density%upper_limit_si, 2*root(i)*acos(-1.0_dp)/180, thr=thr, rel=.true.)
            call check(error, density%unit//" "//density%unit_si, "deg/s/sqrt(Hz) rad/s/sqrt(Hz)")
         end associate
      end do
      call state_ones("mg", stated, .true.)
      call check(error, stated%density(1)%value, 1000.0_dp, thr=thr, rel=.true.)
      call check(error, stated%density(1)%unit//" "//stated%density(1)%unit_si, "ug/sqrt(Hz) m/s^2/sqrt(Hz)")
   end subroutine test_densities

   !> Without a rate or a unit nothing is in SI, and no density is stated.
   subroutine test_nothing_known()
      type(stated_noise_type) :: stated
      character(5), parameter :: name(2) = [character(5) :: "deg/s", ""]
      integer :: i

      do i = 1, 2
         call state_ones(trim(name(i)), stated, i == 2)
         call check(error, .not. stated%in_units .and. stated%term(2)%unit_si == "" .and. .not. stated%density(1)%fitted)
         call check(error, abs(stated%term(2)%value_si) < tiny(1.0_dp) .and. stated%term(2)%definition /= "")
      end do
   end subroutine test_nothing_known

   !> The factor that B's definition prints: sqrt(2 ln 2/pi) = 0.664.
   subroutine test_definitions()
      character(:), allocatable :: text
      character(5) :: factor

      write (factor, "(f5.3)") sqrt(2*log(2.0_dp)/acos(-1.0_dp))
      text = coefficient_definition(3)
      call check(error, index(text, "= ("//factor//" B)^2") > 0, text)
   end subroutine test_definitions

   !> Golden text: N = 0.2*0.0158 deg/sqrt(s) = 5.515e-5 rad/sqrt(s); B is not detected in the AKF's output, its limit
   !> 3e-3*0.2 deg/s.
   subroutine test_text()
      character(80), parameter :: lines(6) = [character(80) :: &
         "  N               = 0.1896 +/- 0.0024 deg/sqrt(h), SI: 5.515e-05 +/- 7e-07", &
         "  B               < 2.16 deg/h, SI: < 1.047e-05 rad/s, definition sigma^2 = (2", &
         "                  ln 2/pi) B^2 = (0.664 B)^2", &
         "  R               definition sigma^2 = R^2 tau^2/2", &
         "                  one sided (= 0.004469 +/- 0.000057 deg/s/sqrt(Hz), SI:", &
         "                  7.8e-05 +/- 9.9e-07 rad/s/sqrt(Hz), definition one-sided:"]
      character(:), allocatable :: text
      integer :: i

      call noise_text(.true., stage%akf, text)
      do i = 1, size(lines)
         call check(error, index(text, new_line("a")//trim(lines(i))//new_line("a")) > 0, text)
      end do
   end subroutine test_text

   !> Without rate and unit nothing is stated in SI, and N is no density.
   subroutine test_text_nothing_known()
      character(:), allocatable :: text

      call noise_text(.false., stage%input, text)
      call check(error, index(text, "N               = 0.01580 +/- 0.00020 input unit*sqrt(sample), definition") > 0, text)
      call check(error, index(text, "SI") + index(text, "Density") == 0, text)
   end subroutine test_text_nothing_known

   !> The coefficients of a series as a report has them.
   subroutine noise_text(known, which, text)
      !> Rate and unit are known
      logical, intent(in) :: known
      integer, intent(in) :: which
      character(:), allocatable, intent(out) :: text
      type(text_description_type) :: out
      type(writer_type), target :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result

      call make_record(record, known)
      call make_result(record, result)
      call begin_text(writer)
      call out%attach(writer)
      call put_noise(out, "", "Noise coefficients", result%channel(1)%allan(which))
      call end_text(writer, text)
   end subroutine noise_text

end module test_conventions
