! SPDX-License-Identifier: MIT
!> Kalibr's imu.yaml: white noise and random walk of the gyroscope and of the accelerometer, in SI
!> and continuous time.
!>
!> Kalibr's noise density is N of \( \sigma^2 = N^2/\tau \), the root of the two-sided density; its
!> random walk is K of \( \sigma^2 = K^2 \tau/3 \). It wants one number for a sensor: the largest of
!> the axes, each axis with its value, or with its 95 % limit where the value is not detectable;
!> never 0. The axes stand in comments.
!> Source: the wiki of ethz-asl/kalibr, "IMU Noise Model" and "Yaml formats".
module gyroakf_report_kalibr
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type, sample_count
   use gyroakf_release, only : release_string
   use gyroakf_units, only : quantity, term_names
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_pipeline_result, only : pipeline_result_type, stated_coefficient_type, &
      not_described, stage
   use gyroakf_report_html_markup, only : put_lines
   use gyroakf_report_input, only : text_or
   use gyroakf_report_text_layout, only : scientific, number, count_text, if_known
   implicit none (type, external)
   private
   public :: check_kalibr, write_kalibr, kalibr_mark

   !> Stands in the file until its topic is filled in by hand
   character(*), parameter :: kalibr_mark = "rostopic: /imu0  # put your topic here"

   !> Places of N and K among Q N B K R
   integer, parameter :: white = 2, walk = 4
   character(1), parameter :: lf = new_line("a")

contains

   !> Whether a record can give the file: its rate is known, and the unit of at least one channel.
   subroutine check_kalibr(record, error)
      !> As read
      type(record_type), intent(in) :: record
      !> `invalid_argument`: the rate or every unit is missing; the message says which option gives
      !> it
      type(error_type), allocatable, intent(out) :: error

      if (.not. record%rate_known) then
         call fatal_error(error, status%invalid_argument, "Kalibr's file needs the rate, and "// &
            record%path//" does not tell it: give --rate HZ or --dt S")
      else if (.not. any(quantities(record) == quantity%angular_rate .or. &
                         quantities(record) == quantity%acceleration)) then
         call fatal_error(error, status%invalid_argument, "Kalibr's file needs the unit, and "// &
            record%path//" does not tell it: give --unit rad/s (or deg/s, m/s^2, g, ...), or a "// &
            "list with one for each channel")
      end if
   end subroutine check_kalibr

   !> Writes the file. A sensor that the record does not hold is a comment that asks for its
   !> numbers.
   subroutine write_kalibr(writer, record, result, error)
      !> Open
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      !> With the coefficients of the series as read
      type(pipeline_result_type), intent(in) :: result
      !> As that of [[check_kalibr]]; or a channel has no N or no K
      type(error_type), allocatable, intent(out) :: error
      integer :: measured(size(result%channel))
      character(:), allocatable :: rate

      call check_kalibr(record, error)
      measured = quantities(record)
      if (.not. allocated(error)) call check_coefficients()
      if (allocated(error)) return
      call put_line(writer, "# Noise of an inertial sensor for Kalibr (imu.yaml), by gyroakf "// &
         release_string)
      call put_line(writer, "# from "//text_or(record%path, "")//": "// &
         count_text(sample_count(record))//" samples, "//number(result%duration, 6)//" s")
      call put_lines(writer, [character(97) :: "#", "# SI units, continuous time. "// &
         "noise_density is N of the Allan variance N^2/tau, the root of the", "# two-sided "// &
         "density (not sqrt(2) N); random_walk is K of K^2 tau/3. One number for a sensor: the", &
         "# largest of its axes, taken at the 95 % upper limit where an axis shows no value.", &
         "# They are those of the sensor as it was recorded, at rest; Kalibr's documentation "// &
         "advises larger", "# ones for a low-cost sensor in motion.", "", kalibr_mark])
      rate = number(1.0_dp/record%sample_interval, 7)      ! a real number for YAML: never "1e6"
      if (scan(rate, "eE") > 0) rate = scientific(1.0_dp/record%sample_interval, 7)
      call put_line(writer, "update_rate: "//rate//if_known(scan(rate, ".") == 0, ".0")//"  # Hz")
      call put_sensor(quantity%acceleration, "accelerometer", "m/s^2", "m/s^3", "m/s^2 or g")
      call put_sensor(quantity%angular_rate, "gyroscope", "rad/s", "rad/s^2", "rad/s or deg/s")
      call put_remarks()

   contains

      !> Every channel that is used has N and K, or at least their limits.
      subroutine check_coefficients()
         character(*), parameter :: needs = "Kalibr's file needs N and K, and "
         character(:), allocatable :: reason
         integer :: c, term

         do c = 1, size(measured)
            if (measured(c) == quantity%unknown .or. allocated(error)) cycle
            associate (channel => result%channel(c), allan => result%channel(c)%allan(stage%input))
               term = merge(white, walk, strength(allan%stated%term(white)) <= 0.0_dp)
               if (.not. allan%fitted) then
                  reason = ""
                  if (allocated(channel%unavailable)) reason = ": "//channel%unavailable(1)%text
                  call fatal_error(error, status%constant_input, needs//"'"//channel%name// &
                                   "' has no coefficients"//reason)
               else if (strength(allan%stated%term(term)) <= 0.0_dp) then
                  call fatal_error(error, status%invalid_argument, &
                                   needs//term_names(term)//" of '"//channel%name//"' was not "// &
                                   "fitted: --terms has to name N and K, or be left out")
               end if
            end associate
         end do
      end subroutine check_coefficients

      !> The two lines of a sensor, and its axes below each.
      subroutine put_sensor(what, sensor, density_unit, walk_unit, asked)
         integer, intent(in) :: what
         character(*), intent(in) :: sensor, density_unit, walk_unit, asked

         call put_line(writer, "")
         if (all(measured /= what)) call put_line(writer, "# The record has no channel in "// &
            asked//": fill in the "//sensor//"'s numbers.")
         call put_number(what, white, sensor//"_noise_density", density_unit//"/sqrt(Hz)")
         call put_number(what, walk, sensor//"_random_walk", walk_unit//"/sqrt(Hz)")
      end subroutine put_sensor

      !> The largest of the axes, then each of them; without an axis a line to be filled in.
      subroutine put_number(what, term, key, unit)
         integer, intent(in) :: what, term
         character(*), intent(in) :: key, unit
         character(:), allocatable :: text
         type(stated_coefficient_type) :: stated(size(measured))
         logical :: of(size(measured))
         integer :: c, largest

         of = measured == what
         if (.not. any(of)) then
            call put_line(writer, "#"//key//":  # "//unit)
            return
         end if
         do c = 1, size(of)
            stated(c) = result%channel(c)%allan(stage%input)%stated%term(term)
         end do
         largest = maxloc(strength(stated), dim=1, mask=of)
         call put_line(writer, key//": "//scientific(strength(stated(largest)), 5)//"  # "// &
                       unit//", "//term_names(term)//" of "// &
                       text_or(result%channel(largest)%name, "")// &
                       if_known(.not. stated(largest)%detected, &
                                " is not detectable: its 95 % upper limit"))
         do c = 1, size(of)
            if (.not. of(c)) cycle
            text = "not detectable, below "//scientific(stated(c)%upper_limit_si, 5)//" (95 %)"
            if (stated(c)%detected) text = scientific(stated(c)%value_si, 5)//" +/- "// &
               scientific(stated(c)%std_error_si, 2)
            call put_line(writer, "#   "//text_or(result%channel(c)%name, "")//": "//text)
         end do
      end subroutine put_number

      !> Channels whose unit is not known, and those whose Allan deviation the terms do not
      !> describe.
      subroutine put_remarks()
         character(:), allocatable :: name
         integer :: c

         do c = 1, size(measured)
            name = text_or(result%channel(c)%name, "")
            associate (allan => result%channel(c)%allan(stage%input))
               if (measured(c) == quantity%unknown) then
                  call put_line(writer, lf//"# not used: "//name//", its unit is not known")
               else if (allan%fitted .and. .not. allan%noise%described) then
                  call put_line(writer, lf//"# "//name//": "//not_described// &
                                "; --fit-tau-min and --fit-tau-max fit a range")
               end if
            end associate
         end do
      end subroutine put_remarks

   end subroutine write_kalibr

   !> What stands for an axis: its value, or its limit where it has none; 0 where the term was not
   !> fitted.
   elemental real(dp) function strength(stated)
      type(stated_coefficient_type), intent(in) :: stated

      strength = 0.0_dp
      if (.not. stated%fitted) return
      strength = merge(stated%value_si, stated%upper_limit_si, stated%detected)
   end function strength

   !> What the channels measure.
   pure function quantities(record) result(what)
      type(record_type), intent(in) :: record
      integer :: what(size(record%value, 2))

      what = record%unit%quantity
      if (allocated(record%channel_unit)) what = record%channel_unit%quantity
   end function quantities

end module gyroakf_report_kalibr
