! SPDX-License-Identifier: MIT
!> Kalibr's imu.yaml: which number of which axis, limits, sensors that are not there, what is refused.
module test_kalibr
   use expectations, only : unmet, failed => problem, test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_coefficients, only : state_noise
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_record, only : record_type
   use gyroakf_report_kalibr, only : check_kalibr, write_kalibr
   use gyroakf_units, only : parse_unit, unit_type
   use report_fixture, only : make_record, make_result, begin_text, end_text
   implicit none (type, external)
   private
   public :: suite_kalibr

   character(1), parameter :: lf = new_line("a")
   !> What is written, the file or the message, and its status
   type(record_type) :: record
   type(pipeline_result_type) :: result
   character(:), allocatable :: text
   integer :: code

contains

   subroutine suite_kalibr()
      call test("gyroscope-alone", test_gyroscope)
      call test("six-axes", test_six_axes)
      call test("accelerometer-alone", test_accelerometer)
      call test("unknown-channel", test_unknown_channel)
      call test("rates", test_rates)
      call test("refused", test_refused)
      call test("not-fitted", test_not_fitted)
   end subroutine suite_kalibr

   !> gx gy gz in deg/s, ax ay az in mg: N of the i-th is i in these units, K of gy is detected and 0.5, its limit is 1;
   !> the others' limit is 0.1 i.
   subroutine make_six(record, result)
      type(record_type), intent(out) :: record
      type(pipeline_result_type), intent(out) :: result
      type(pipeline_result_type) :: one
      character(2), parameter :: name(6) = ["gx", "gy", "gz", "ax", "ay", "az"]
      integer :: c

      call make_record(record, .true.)
      call make_result(record, one)
      deallocate (record%channel, record%value)
      allocate (record%channel(6), record%value(12, 6), record%channel_unit(6), result%channel(6))
      record%value(:, :) = 0
      record%unit = unit_type()
      result%duration = one%duration
      do c = 1, 6
         record%channel(c)%text = name(c)
         call parse_unit(trim(merge("deg/s", "mg   ", c <= 3)), record%channel_unit(c), failed)
         result%channel(c) = one%channel(1)
         result%channel(c)%name = name(c)
         associate (allan => result%channel(c)%allan(stage%input))
            allan%noise%coefficient(2)%value = c
            allan%noise%coefficient(2)%std_error = 0.01_dp
            allan%noise%coefficient(4)%upper_limit = 0.1_dp*c
            if (c == 2) then
               allan%noise%coefficient(4)%value = 0.5_dp
               allan%noise%coefficient(4)%upper_limit = 1
               allan%noise%coefficient(4)%detected = .true.
            end if
            call state_noise(allan%noise, .true., record%channel_unit(c), allan%stated)
         end associate
      end do
   end subroutine make_six

   !> The file, or the error's message.
   subroutine written()
      type(writer_type) :: writer
      character(:), allocatable :: content

      call begin_text(writer)
      call write_kalibr(writer, record, result, failed)
      call end_text(writer, content)
      code = status%ok
      text = content
      if (.not. allocated(failed)) return
      code = failed%code
      text = failed%message
      if (len(content) > 0) text = "written although refused: "//content
   end subroutine written

   !> N = 0.0158 deg/sqrt(s) = 2.7576e-4 rad/s/sqrt(Hz); K's limit 3e-3 deg/s^1.5 = 5.2360e-5.
   subroutine test_gyroscope()
      character(112), parameter :: lines(8) = [character(112) :: "rostopic: /imu0  # put your topic here", &
         "update_rate: 5.0  # Hz", "#accelerometer_noise_density:  # m/s^2/sqrt(Hz)", &
         "#accelerometer_random_walk:  # m/s^3/sqrt(Hz)", &
         "gyroscope_noise_density: 2.7576e-04  # rad/s/sqrt(Hz), N of gx", "#   gx: 2.7576e-04 +/- 3.5e-06", &
         "gyroscope_random_walk: 5.2360e-05  # rad/s^2/sqrt(Hz), K of gx is not detectable: its 95 % upper limit", &
         "#   gx: not detectable, below 5.2360e-05 (95 %)"]
      integer :: i

      call make_record(record, .true.)
      call make_result(record, result)
      call written()
      do i = 1, size(lines)
         call check(error, index(text, lf//trim(lines(i))//lf) > 0, trim(lines(i))//" is not in "//text)
      end do
   end subroutine test_gyroscope

   !> The largest axis of each sensor; a value or a limit, whichever the axis has.
   subroutine test_six_axes()
      character(112), parameter :: lines(6) = [character(112) :: &
         "gyroscope_noise_density: 5.2360e-02  # rad/s/sqrt(Hz), N of gz", &
         "gyroscope_random_walk: 8.7266e-03  # rad/s^2/sqrt(Hz), K of gy", "#   gy: 8.7266e-03 +/- 0.0e+00", &
         "#   gz: not detectable, below 5.2360e-03 (95 %)", &
         "accelerometer_noise_density: 5.8840e-02  # m/s^2/sqrt(Hz), N of az", &
         "accelerometer_random_walk: 5.8840e-03  # m/s^3/sqrt(Hz), K of az is not detectable: its 95 % upper limit"]
      integer :: i

      call make_six(record, result)
      call written()
      do i = 1, size(lines)
         call check(error, index(text, lf//trim(lines(i))//lf) > 0, trim(lines(i))//" is not in "//text)
      end do
      call check(error, index(text, ": 0.0000e+00") == 0, "a zero: "//text)
   end subroutine test_six_axes

   subroutine test_accelerometer()
      call make_record(record, .true.)
      call make_result(record, result)
      record%unit%quantity = 2
      call written()
      call check(error, index(text, lf//"#gyroscope_random_walk:  # rad/s^2/sqrt(Hz)"//lf) > 0 .and. &
                 index(text, lf//"accelerometer_noise_density: 2.7576e-04") > 0, text)
   end subroutine test_accelerometer

   !> A column without a unit (a temperature) is left out and named.
   subroutine test_unknown_channel()
      call make_six(record, result)
      record%channel_unit(3) = unit_type()
      result%channel(3)%allan(stage%input)%fitted = .false.
      result%channel(1)%allan(stage%input)%noise%described = .false.
      call written()
      call check(error, index(text, lf//"# gx: no run of octaves follows") > 0, text)
      call check(error, index(text, lf//"# not used: gz, its unit is not known"//lf) > 0, text)
      call check(error, index(text, lf//"gyroscope_noise_density: 3.4907e-02  # rad/s/sqrt(Hz), N of gy"//lf) > 0, text)
   end subroutine test_unknown_channel

   !> YAML 1.1 takes 1e6 for a text: rates are written as numbers.
   subroutine test_rates()
      real(dp), parameter :: rate(4) = [200.0_dp, 99.98412_dp, 2.0e7_dp, 1.0e-5_dp]
      character(14), parameter :: expected(4) = [character(14) :: "200.0", "99.98412", "2.000000e+07", "1.000000e-05"]
      integer :: i

      call make_record(record, .true.)
      call make_result(record, result)
      do i = 1, size(rate)
         record%sample_interval = 1/rate(i)
         call written()
         call check(error, index(text, lf//"update_rate: "//trim(expected(i))//"  # Hz"//lf) > 0, text)
      end do
   end subroutine test_rates

   !> Without a rate or a unit nothing is written, and the message says which option helps.
   subroutine test_refused()
      call make_record(record, .false.)
      call make_result(record, result)
      call written()
      call check(error, code == status%invalid_argument .and. index(text, "give --rate HZ or --dt S") > 0, text)
      record%rate_known = .true.
      call check_kalibr(record, failed)
      if (unmet(allocated(failed))) return
      call check(error, index(failed%message, "give --unit rad/s") > 0, failed%message)
   end subroutine test_refused

   !> A term that was left out of the fit has no number, and neither has a channel without a fit.
   subroutine test_not_fitted()
      call make_record(record, .true.)
      call make_result(record, result)
      result%channel(1)%allan(stage%input)%stated%term(4)%fitted = .false.
      call written()
      call check(error, code == status%invalid_argument .and. index(text, "K of 'gx' was not fitted") > 0, text)
      result%channel(1)%allan(stage%input)%fitted = .false.
      call written()
      call check(error, code == status%constant_input .and. index(text, "'gx' has no coefficients") > 0, text)
   end subroutine test_not_fitted

end module test_kalibr
