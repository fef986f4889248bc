! SPDX-License-Identifier: MIT
!> Options of simulate: the terms of the record, and stand-ins of real recordings.
module gyroakf_app_simulation
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_io_number, only : parse_number, number
   use gyroakf_simulate_simulate_record, only : simulate_options, paper_preset
   use gyroakf_units, only : term_names
   use gyroakf_app_option, only : find_option
   use gyroakf_app_option_table, only : option_type, options
   use gyroakf_app_value, only : value_type, value_error, not_wired, convert_value
   implicit none (type, external)
   private
   public :: set_sensor, set_record

   !> A preset
   type :: sensor_type
      !> Its name, a word of --preset
      character(12) :: name = ""
      !> Options of simulate, each with its value, separated by single blanks
      character(160) :: options = ""
   end type sensor_type

   !> ADIS16405, gyroscope and accelerometer; Xsens MTi-G, gyroscope, and DOT; a navigation-grade
   !> ring laser on a base that is disturbed for 600 s; MPU6050: rate, length, noise, filter and LSB
   !> as found in their recordings. N and B are 2.48 deg/sqrt(h), 38 deg/h; 0.2 m/s/sqrt(h), 0.2 mg;
   !> 1.82 deg/sqrt(h); 0.365 deg/sqrt(h), 5 deg/h; 0.005 deg/sqrt(h); 0.755 deg/sqrt(h), 16.1
   !> deg/h.
   type(sensor_type), parameter :: sensors(*) = [ &
      sensor_type("adis16405", "--rate 100 --samples 1000000 --coefficients "// &
         "N=0.041333,B=0.010556 --resonance 20,3 --lsb 0.05"), &
      sensor_type("adis16405-xl", "--rate 100 --samples 1000000 --unit g --coefficients "// &
         "N=3.4e-4,B=2e-4 --markov 2e-3,0.2,3e-4,60 --lsb 3.33e-3"), &
      sensor_type("mti-g", "--rate 100 --samples 500000 --unit rad/s --coefficients N=5.3e-4 "// &
         "--tails mixture --contamination 0.00036,31"), &
      sensor_type("xsens-dot", "--rate 120 --samples 14400 --coefficients "// &
         "N=0.0060833,B=0.0013889 --lowpass 15"), &
      sensor_type("ring-laser", "--rate 100 --samples 184718 --unit deg/h --coefficients "// &
         "Q=0.29,N=0.3 --vibration 55,2.5,0.02 --motion 70,400,0.3,600"), &
      sensor_type("mpu6050", "--rate 99.32 --samples 65067 --coefficients "// &
         "N=0.012583,B=0.0044722 --vibration 0.087,31.4,0.1 --lsb 0.0076336")]

contains

   !> Applies --preset: the paper's record, or the options of a sensor.
   subroutine set_sensor(record, name, error)
      !> What is changed
      type(simulate_options), intent(inout) :: record
      !> A word of --preset
      character(*), intent(in) :: name
      !> usage
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words
      type(option_type) :: option
      type(value_type) :: value
      integer :: blank, sensor

      if (name == "paper") then
         record = paper_preset(record%seed)
         return
      end if
      sensor = findloc(sensors%name == name, .true., dim=1)
      words = trim(sensors(sensor)%options)//" "
      do while (words /= "" .and. .not. allocated(error))
         blank = index(words, " ")
         option = options(find_option(words(:blank - 1), "simulate"))
         words = words(blank + 1:)
         blank = index(words, " ")
         call convert_value(option, words(:blank - 1), value, error)
         if (.not. allocated(error)) call set_record(record, option, value, error)
         words = words(blank + 1:)
      end do
   end subroutine set_sensor

   !> Applies an option of the group "record" but --preset and those of files.
   subroutine set_record(record, option, value, error)
      !> What is changed
      type(simulate_options), intent(inout) :: record
      !> Row of the table
      type(option_type), intent(in) :: option
      !> Its value
      type(value_type), intent(in) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--samples"); record%samples = value%count
      case ("--rate"); record%rate_hz = value%number
      case ("--dt"); record%rate_hz = 1/value%number
      case ("--unit"); record%unit = value%text
      case ("--seed"); record%seed = value%count
      case ("--coefficients"); call set_coefficients(option, value%text, record%coefficient, error)
      case ("--ar"); record%ar = value%list
      case ("--ar-variance"); record%ar_variance = value%number
      case ("--trend"); record%trend = value%list
      case ("--offset"); record%offset = value%number
      case ("--outlier-count"); record%outliers = value%count
      case ("--outlier-size"); record%outlier_size = value%number
      case ("--tails"); record%tails = value%text
      case ("--lsb"); record%lsb = value%number
      case ("--missing"); record%missing = value%number
      case default; call set_parts(option, value, record, error)
      end select
   end subroutine set_record

   !> Options of several numbers; the library judges their ranges.
   subroutine set_parts(option, value, record, error)
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(simulate_options), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: part(4)                               ! 0 where a part is not given
      integer :: n
      logical :: fits

      n = 0
      if (allocated(value%list)) n = size(value%list)
      part = 0.0_dp
      if (n > 0) part(:min(n, 4)) = value%list(:min(n, 4))
      fits = n == 2
      select case (option%name)
      case ("--resonance"); record%resonance_hz = part(1)
         record%resonance_q = part(2)
      case ("--lowpass"); fits = n <= 2
         record%lowpass_hz = part(1)
         record%lowpass_order = findloc([1.0_dp, 2.0_dp], merge(part(2), 1.0_dp, n > 1), dim=1)
      case ("--contamination"); record%contamination = part(:2)
      case ("--warmup"); record%warm_up = part(:2)
      case ("--motion"); fits = n == 3 .or. n == 4
         record%motion = part
      case ("--markov"); fits = mod(n, 2) == 0
         record%markov = value%list
      case ("--vibration"); fits = mod(n, 3) == 0
         record%vibration = value%list
      case default; call not_wired(option, error)
         return
      end select
      if (fits) return
      call value_error(option, "'"//value%text//"' has the wrong number of parts", error)
   end subroutine set_parts

   !> Q=1e-3,N=0.02: any of the five, each once.
   subroutine set_coefficients(option, text, coefficient, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      real(dp), intent(inout) :: coefficient(5)
      type(error_type), allocatable, intent(out) :: error
      logical :: given(5), ok
      integer :: from, to, term, found

      given = .false.
      from = 1
      do while (from <= len(text) + 1)
         to = from + index(text(from:)//",", ",") - 2
         term = 0
         if (to > from) term = findloc(term_names, text(from:from), dim=1)
         ok = term > 0
         if (ok) ok = text(from + 1:from + 1) == "=" .and. .not. given(term)
         if (ok) then
            call parse_number(text(from + 2:to), coefficient(term), found)
            ok = found == number%ok .and. (coefficient(term) >= 0 .or. term_names(term) == "R")
         end if
         if (.not. ok) then
            call value_error(option, "'"//text(from:to)// &
               "' is not a term given once, with its value (negative only for R)", error)
            return
         end if
         given(term) = .true.
         from = to + 2
      end do
   end subroutine set_coefficients

end module gyroakf_app_simulation
