! SPDX-License-Identifier: MIT
!> What a column measures, by the words of its name and by its unit.
module gyroakf_column_class
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_name_words, only : ends_with, has_beginning, has_word, join_name, split_name
   use gyroakf_record, only : text_type
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : parse_unit, quantity, time_scale, unit_type
   implicit none (type, external)
   private
   public :: column_class, class_names, class_of, is_unit, find_unit, unit_fits, split_name
   public :: is_time_name, may_hold_time, is_counter_name, is_temperature_name, opening_bracket, noteless_length

   !> What a column measures, reached as `column_class%rate`
   type :: column_class_enum
      integer :: unknown = 0
      !> Angular rate: a gyroscope
      integer :: rate = 1
      integer :: acceleration = 2
      integer :: magnetic = 3
      integer :: temperature = 4
      integer :: time = 5
      integer :: counter = 6
      !> Status, error count, number of a sensor
      integer :: flag = 7
      integer :: quaternion = 8
      !> Position, or its rate of change
      integer :: position = 9
      !> Attitude, or increments of an angle
      integer :: angle = 10
      !> Statistics, pressure, voltage
      integer :: other = 11
      integer :: text = 12
   end type column_class_enum

   !> All classes
   type(column_class_enum), parameter :: column_class = column_class_enum()

   !> For people: [class]
   character(14), parameter :: class_names(0:12) = [character(14) :: "unknown", "angular rate", "acceleration", &
      "magnetic field", "temperature", "time", "counter", "flag", "quaternion", "position", "angle", "other", "text"]

   character(12), parameter :: statistics(27) = [character(12) :: "covariance", "cov", "bias", "offset", "std", "stddev", &
      "variance", "var", "sigma", "norm", "absolute", "abs", "total", "integral", "inc", "dt", "hz", "sampling", "gain", &
      "scale", "calibration", "noise", "setpoint", "cutoff", "target", "desired", "threshold"]
   character(9), parameter :: flags(19) = [character(9) :: "status", "flag", "flags", "valid", "invalid", "health", &
      "healthy", "ok", "error", "errors", "err", "mode", "state", "enabled", "accuracy", "quality", "clipping", "clip", &
      "saturated"]
   character(8), parameter :: counters(19) = [character(8) :: "counter", "count", "cnt", "seq", "sequence", "index", &
      "idx", "sample", "samples", "frame", "packet", "row", "line", "nr", "no", "number", "id", "n", "#"]
   character(5), parameter :: rate_axes(14) = [character(5) :: "gx", "gy", "gz", "wx", "wy", "wz", "gyx", "gyy", "gyz", &
      "omx", "omy", "omz", "gyr", "g"]
   character(5), parameter :: acceleration_axes(10) = [character(5) :: "ax", "ay", "az", "gfx", "gfy", "gfz", "fx", "fy", &
      "fz", "a"]
   character(5), parameter :: magnetic_axes(8) = [character(5) :: "mx", "my", "mz", "bx", "by", "bz", "hx", "m"]
   character(5), parameter :: quaternion_axes(7) = [character(5) :: "qw", "qx", "qy", "qz", "q", "mat", "dcm"]
   character(8), parameter :: temperature_units(8) = [character(8) :: "degc", "deg c", "c", "celsius", "kelvin", "k", &
      "degf", char(194)//char(176)//"c"]
   character(7), parameter :: magnetic_units(14) = [character(7) :: "ut", "mt", "nt", "tesla", "gauss", "mgauss", "ga", &
      "mga", char(194)//char(181)//"t", char(206)//char(188)//"t", "utesla", "mtesla", "microt", "ugauss"]
   character(10), parameter :: other_units(28) = [character(10) :: "hpa", "kpa", "pa", "mbar", "bar", "v", "mv", "ma", &
      "%", "m", "km", "cm", "mm", "ft", "hz", "khz", "lsb", "count", "counts", "raw", "digit", "digits", "adc", "-", "km/h", &
      "lx", "no_units", "local_flux"]

contains

   !> The class of a column.
   pure integer function class_of(name, unit) result(found)
      !> As the file names it, without its unit, and the unit; "" where there is none
      character(*), intent(in) :: name, unit
      type(text_type), allocatable :: word(:)
      character(:), allocatable :: joined
      type(unit_type) :: known

      call split_name(name, word)
      call join_name(word, joined)
      call find_unit(name, unit, known)
      found = column_class%unknown
      if (is_temperature_unit(unit)) then
         found = column_class%temperature
      else if (has_word(word, ["calib"]) .and. .not. has_word(word, ["x", "y", "z"])) then
         found = column_class%flag
      else if (is_time_name(name, unit)) then
         found = column_class%time
      else if (has_word(word, flags) .or. has_beginning(word, ["clip", "satu"])) then
         found = column_class%flag
      else if (is_counter_name(name)) then
         found = column_class%counter
      else if (is_temperature_name(name, unit)) then
         found = column_class%temperature
      else if (has_word(word, statistics)) then
         found = column_class%other
      else if (any(magnetic_units == lower(unit)) .or. is_magnetic(word, joined)) then
         found = column_class%magnetic
      else if (known%quantity == quantity%angular_rate) then
         found = column_class%rate
      else if (known%quantity == quantity%acceleration) then
         found = column_class%acceleration
      else
         found = class_of_words(word, joined)
         if (found == column_class%unknown .and. known%quantity == quantity%angle) found = column_class%angle
         if (found == column_class%unknown .and. (known%quantity == quantity%velocity .or. &
            any(["m ", "km", "cm", "mm", "ft"] == lower(unit)))) found = column_class%position
      end if
   end function class_of

   !> The class by words alone.
   pure integer function class_of_words(word, joined) result(found)
      type(text_type), intent(in) :: word(:)
      character(*), intent(in) :: joined
      character(8), parameter :: turning(5) = [character(8) :: "angular", "ang", "rotation", "rot", "body"]
      character(8), parameter :: speeds(6) = [character(8) :: "velocity", "vel", "rate", "rates", "speed", "omega"]
      logical :: turns, accelerates

      found = column_class%unknown
      turns = has_word(word, speeds) .and. (has_word(word, turning) .or. is_angle(word))
      turns = turns .or. has_beginning(word, ["gyr   ", "omega ", "angvel"]) .or. any(rate_axes == joined)
      turns = turns .or. has_word(word, ["rate   ", "rates  ", "rotrate"]) .or. has_word(word, rate_axes(:12))
      turns = turns .or. ends_with(joined, "rotation") .or. (is_angle(word) .and. ends_with(joined, "speed"))
      turns = turns .or. (is_angle(word) .and. ends_with(joined, "rate"))
      accelerates = has_beginning(word, ["acc     ", "lacc    ", "gravity ", "specific"]) .or. any(acceleration_axes == joined)
      accelerates = accelerates .or. has_word(word, acceleration_axes(:6)) .or. has_word(word, ["force ", "gforce", "xl    "])
      if (has_beginning(word, ["quat   ", "orienta", "rotvec "]) .or. any(quaternion_axes == joined)) then
         found = column_class%quaternion
      else if (has_word(word, quaternion_axes) .or. (has_word(word, turning) .and. has_word(word, ["vector"]))) then
         found = column_class%quaternion
      else if (accelerates .and. has_word(word, ["angular"])) then
         found = column_class%other
      else if (turns .and. .not. (accelerates .and. has_word(word, ["rate"]))) then
         found = column_class%rate
      else if (accelerates) then
         found = column_class%acceleration
      else if (is_angle(word)) then
         found = column_class%angle
      else if (has_beginning(word, [character(4) :: "lat", "lon", "lng", "alti", "heig", "posi", "velo", "spee", "gps", &
                                    "gnss", "ecef", "loca", "hdop", "nort", "east"]) &
               .or. has_word(word, [character(4) :: "alt", "pos", "vel", "vn", "ve", "vd", "vx", "vy", "vz", "sats"])) then
         found = column_class%position
      else if (has_beginning(word, [character(4) :: "pres", "baro", "humi", "ligh", "lux", "prox", "volt", "batt", "curr", &
                                    "soun", "enco"])) then
         found = column_class%other
      end if
   end function class_of_words

   !> True for the words of a magnetic field.
   pure logical function is_magnetic(word, joined)
      type(text_type), intent(in) :: word(:)
      character(*), intent(in) :: joined

      is_magnetic = has_beginning(word, ["magn ", "compa", "micro"]) .or. has_word(word, ["mag"]) .or. any(magnetic_axes == joined)
      is_magnetic = is_magnetic .and. .not. has_word(word, ["magnitude"])
      is_magnetic = is_magnetic .or. has_word(word, magnetic_axes(:6))
      if (.not. is_magnetic) is_magnetic = has_beginning(word, ["magx", "magy", "magz"])
   end function is_magnetic

   !> True for the words of an attitude or of an increment of an angle.
   pure logical function is_angle(word)
      type(text_type), intent(in) :: word(:)

      is_angle = has_beginning(word, [character(4) :: "ang", "roll", "pitc", "yaw", "head", "azim", "atti", "eule", "phi", &
                                      "psi", "thet"])
   end function is_angle

   !> The unit of a column's values: what stood in brackets, else the last words of its name, before
   !> an axis or an index: gz_dps, gyro_x_rad_s, wx_deg_per_s, accelerometer_m_s2[0]; unknown where
   !> these are none.
   pure subroutine find_unit(name, unit, found)
      !> As those of [[class_of]]
      character(*), intent(in) :: name, unit
      !> Of any quantity
      type(unit_type), intent(out) :: found
      type(text_type), allocatable :: word(:)
      character(:), allocatable :: text
      integer :: last, k

      if (len(unit) > 0) then
         if (.not. any(magnetic_units == lower(unit))) call parse_quietly(unit, found)
         return
      end if
      call split_name(name(:noteless_length(name)), word)
      do last = size(word), 2, -1
         if (verify(word(last)%text, "0123456789") > 0 .and. all(["x     ", "y     ", "z     ", "column"] /= word(last)%text)) exit
      end do
      do k = min(4, last - 1), 1, -1
         call join_unit(word(last - k + 1:last), text)
         call parse_quietly(text, found)
         if (k == 1 .and. any(["g  ", "mg ", "ug "] == word(last)%text)) then
            call join_name(word(:last - 1), text)
            if (class_of_words(word(:last - 1), text) /= column_class%acceleration &
                .or. index(name, "/") > 0) found = unit_type()
         end if
         if (found%quantity /= quantity%unknown) return
      end do
   end subroutine find_unit

   !> "rad_s", "rad_per_s" and "m_s2" as units: "rad/s", "m/s2".
   pure subroutine join_unit(word, text)
      type(text_type), intent(in) :: word(:)
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = word(1)%text
      do i = 2, size(word)
         if (word(i)%text /= "per") text = text//"/"//word(i)%text
      end do
   end subroutine join_unit

   !> The unit that a text names, of an unknown quantity where it names none.
   pure subroutine parse_quietly(text, unit)
      character(*), intent(in) :: text
      type(unit_type), intent(out) :: unit
      type(error_type), allocatable :: failed

      call parse_unit(text, unit, failed)
      if (allocated(failed)) unit = unit_type()
   end subroutine parse_quietly

   !> Where the bracket opens that closes at the end of a text; 0 where none does.
   pure integer function opening_bracket(text) result(at)
      !> Without blanks at its end
      character(*), intent(in) :: text
      integer :: depth

      depth = 0
      do at = len(text), 1, -1
         if (scan(text(at:at), "])") > 0) depth = depth + 1
         if (scan(text(at:at), "[(") > 0) depth = depth - 1
         if (depth <= 0) exit
      end do
      if (at == len(text)) at = 0
   end function opening_bracket

   !> Length of a name or unit without what stands in brackets at its end and is no unit: "gyro deg/s" of "gyro deg/s (LSB 1/131)".
   pure integer function noteless_length(text) result(length)
      !> As the file has it
      character(*), intent(in) :: text
      integer :: at

      length = len_trim(text)
      do
         at = opening_bracket(text(:length))
         if (at < 2) return
         if (is_unit(text(at + 1:length - 1))) return
         length = len_trim(text(:at - 1))
      end do
   end function noteless_length

   !> True for a text that is a unit of anything; a whole number or an axis is none.
   pure logical function is_unit(text)
      !> What stands in brackets, or in a row of units
      character(*), intent(in) :: text
      type(unit_type) :: unit
      character(:), allocatable :: word

      word = trim(adjustl(lower(text)))
      call parse_quietly(word, unit)
      is_unit = unit%quantity /= quantity%unknown .or. time_scale(word) > 0.0_dp .or. is_temperature_unit(word)
      is_unit = is_unit .or. any(magnetic_units == word) .or. any(other_units == word)
      is_unit = is_unit .and. len(word) > 0
   end function is_unit

   !> True where a unit may be that of a class: where the class is not known, or its quantity is the same.
   pure logical function unit_fits(class, unit)
      !> One of the components of [[gyroakf_column_class:column_class]]
      integer, intent(in) :: class
      !> Known
      type(unit_type), intent(in) :: unit

      select case (unit%quantity)
      case (quantity%angular_rate, quantity%angle)
         unit_fits = any(class == [column_class%rate, column_class%angle])
      case (quantity%acceleration, quantity%velocity)
         unit_fits = any(class == [column_class%acceleration, column_class%position])
      case default
         unit_fits = .false.
      end select
      unit_fits = unit_fits .or. any(class == [column_class%unknown, column_class%other])
   end function unit_fits

   !> False for the names of what rises evenly too, but is no time: angles, rates, positions.
   pure logical function may_hold_time(name, unit)
      !> As those of [[class_of]]
      character(*), intent(in) :: name, unit

      may_hold_time = any(class_of(name, "") == [column_class%unknown, column_class%time, column_class%counter])
      if (is_unit(unit)) may_hold_time = may_hold_time .and. time_scale(lower(unit)) > 0.0_dp
   end function may_hold_time

   !> True for the names that mean a time: t, time_ms, Timestamp [us], TimeUS, SampleTimeFine,
   !> gps_tow_s, epoch, Elapsed Time, UTC.
   !>
   !> One of its words, parted by signs or by capitals, means a time, and none that it is a
   !> duration, an error or a state. `T` is a temperature, unless its unit is that of a time.
   pure logical function is_time_name(name, unit)
      !> Without brackets
      character(*), intent(in) :: name
      !> What stood in brackets; "" (also if absent) where nothing did
      character(*), intent(in), optional :: unit
      character(7), parameter :: times(17) = [character(7) :: "time", "times", "stamp", "stamps", &
         "tstamp", "ts", "tow", "itow", "gpst", "epoch", "epoc", "utc", "unix", "clock", "elapsed", &
         "zeit", "uhrzeit"]
      character(12), parameter :: units(12) = [character(12) :: "sec", "secs", "seconds", "millis", &
         "milliseconds", "micros", &
         "microseconds", "nanos", "nanoseconds", "usec", "msec", "nsec"]
      character(8), parameter :: others(21) = [character(8) :: "delta", "dt", "diff", "step", &
         "interval", "period", "constant", "sync", "status", "valid", "quality", "accuracy", "error", &
         "err", "offset", "drift", "bias", "exposure", "latency", "delay", "per"]
      type(text_type), allocatable :: word(:)
      logical :: known_unit
      integer :: i

      is_time_name = .false.
      known_unit = .false.
      if (present(unit)) then
         if (is_temperature_unit(unit)) return
         known_unit = time_scale(lower(unit)) > 0.0_dp
      end if
      call split_name(name, word)
      if (size(word) == 0) return
      if (word(1)%text == "t") then
         is_time_name = size(word) == 1 .and. (name /= "T" .or. known_unit)
         if (size(word) == 2) is_time_name = time_scale(word(2)%text) > 0.0_dp
         return
      end if
      is_time_name = any(units == word(1)%text)
      do i = 1, size(word)
         associate (text => word(i)%text)
            if (any(others == text(:min(len(text), 8)))) then
               is_time_name = .false.
               return
            end if
            is_time_name = is_time_name .or. any(times == text) .or. ends_with(text, "time") .or. &
                           ends_with(text, "stamp") .or. index(text, "timestamp") == 1
         end associate
      end do
   end function is_time_name

   !> True for a temperature: temp, Temperature, gyro_temp, tempC, T, or a unit that is one.
   pure logical function is_temperature_name(name, unit)
      !> Without brackets, and what stood in them
      character(*), intent(in) :: name, unit
      type(text_type), allocatable :: word(:)
      integer :: i

      is_temperature_name = is_temperature_unit(unit)
      if (name == "T") is_temperature_name = .not. time_scale(lower(unit)) > 0.0_dp
      call split_name(name, word)
      do i = 1, size(word)
         associate (text => word(i)%text)
            if (index(text, "temperature") > 0) is_temperature_name = .true.
            if (index(text, "temp") == 1 .and. verify(text(min(5, len(text) + 1):), "0123456789cfk") == 0) then
               is_temperature_name = .true.
            end if
         end associate
      end do
   end function is_temperature_name

   !> True for a unit of temperature.
   pure logical function is_temperature_unit(unit)
      character(*), intent(in) :: unit

      is_temperature_unit = any(temperature_units == lower(unit)) .or. lower(unit) == char(194)//char(176)//" c"
   end function is_temperature_unit

   !> True for a name that means a count of rows: counter, count, seq, index, sample, frame,
   !> packet_id, ...
   pure logical function is_counter_name(name)
      !> Without brackets
      character(*), intent(in) :: name
      type(text_type), allocatable :: word(:)

      call split_name(name, word)
      is_counter_name = .false.
      if (size(word) > 0) is_counter_name = any(counters == word(size(word))%text)
      if (size(word) > 1) is_counter_name = is_counter_name .and. word(size(word))%text /= "n"
      if (size(word) == 1) is_counter_name = is_counter_name .or. ends_with(word(1)%text, "counter")
   end function is_counter_name

end module gyroakf_column_class
