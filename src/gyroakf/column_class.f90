! SPDX-License-Identifier: MIT
!> What a column measures, by the words of its name and by its unit.
module gyroakf_column_class
   use gyroakf_kinds, only : dp
   use gyroakf_name_words, only : drop_digits, ends_with, has_beginning, has_word, is_counter, &
      is_one_of, is_temperature, is_temperature_unit, is_time_name, join_words, split_name
   use gyroakf_spelling, only : lower, replace_all
   use gyroakf_units, only : quantity, recognize_unit, time_scale, unit_type
   implicit none (type, external)
   private
   public :: column_class, class_names, class_of, is_unit, find_unit, unit_fits
   public :: is_time_name, may_hold_time, opening_bracket, noteless_length

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
   character(14), parameter :: class_names(0:12) = [character(14) :: "unknown", "angular rate", &
      "acceleration", "magnetic field", "temperature", "time", "counter", "flag", "quaternion", &
      "position", "angle", "other", "text"]

   character(*), parameter :: statistics = "covariance cov bias offset std stddev variance var "// &
      "sigma norm absolute abs total integral inc dt hz sampling gain scale calibration noise "// &
      "setpoint cutoff target desired threshold"
   character(*), parameter :: flags = "status flag flags valid invalid health healthy ok error "// &
      "errors err mode state enabled accuracy quality clipping clip saturated"
   !> Words among others; alone further ones mean the same
   character(*), parameter :: rate_axes = "gx gy gz wx wy wz gyx gyy gyz omx omy omz"
   character(*), parameter :: acceleration_axes = "ax ay az gfx gfy gfz"
   character(*), parameter :: magnetic_axes = "mx my mz bx by bz"
   character(*), parameter :: quaternion_axes = "qw qx qy qz q mat dcm"
   character(*), parameter :: magnetic_units = "ut mt nt tesla gauss mgauss ga mga utesla "// &
      "mtesla microt ugauss "//char(194)//char(181)//"t "//char(206)//char(188)//"t"
   character(*), parameter :: other_units = "hpa kpa pa mbar bar v mv ma % m km cm mm ft hz "// &
      "khz lsb count counts raw digit digits adc - km/h lx no_units local_flux"

contains

   !> The class of a column.
   pure integer function class_of(name, unit) result(found)
      !> As the file names it, without its unit, and the unit; "" where there is none
      character(*), intent(in) :: name, unit
      character(:), allocatable :: words, joined
      type(unit_type) :: known
      logical :: counter, temperature

      call split_name(name, words)
      call join_words(words, joined)
      counter = is_counter(words)
      temperature = is_temperature(words, name, unit)
      call drop_digits(words)
      call find_unit(name, unit, known)
      found = column_class%unknown
      if (is_temperature_unit(unit)) then
         found = column_class%temperature
      else if (has_word(words, "calib") .and. .not. has_word(words, "x y z")) then
         found = column_class%flag
      else if (is_time_name(name, unit)) then
         found = column_class%time
      else if (has_word(words, flags) .or. has_beginning(words, "clip satu")) then
         found = column_class%flag
      else if (counter) then
         found = column_class%counter
      else if (temperature) then
         found = column_class%temperature
      else if (has_word(words, statistics)) then
         found = column_class%other
      else if (is_one_of(lower(unit), magnetic_units) .or. is_magnetic(words, joined)) then
         found = column_class%magnetic
      else if (known%quantity == quantity%angular_rate) then
         found = column_class%rate
      else if (known%quantity == quantity%acceleration) then
         found = column_class%acceleration
      else
         found = class_of_words(words, joined)
         if (found == column_class%unknown .and. known%quantity == quantity%angle) found = &
            column_class%angle
         if (found == column_class%unknown .and. (known%quantity == quantity%velocity .or. &
            is_one_of(lower(unit), "m km cm mm ft"))) found = column_class%position
      end if
   end function class_of

   pure integer function class_of_words(words, joined) result(found)
      character(*), intent(in) :: words, joined
      character(*), parameter :: turning = "angular ang rotation rot body"
      logical :: turns, accelerates

      found = column_class%unknown
      turns = has_word(words, "velocity vel rate rates speed omega") .and. &
              (has_word(words, turning) .or. is_angle(words))
      turns = turns .or. has_word(words, "rate rates rotrate "//rate_axes) .or. &
         has_beginning(words, "gyr omega angvel") .or. is_one_of(joined, rate_axes//" gyr g") .or. &
         ends_with(joined, "rotation") .or. &
         (is_angle(words) .and. (ends_with(joined, "speed") .or. ends_with(joined, "rate")))
      accelerates = has_word(words, "force gforce xl "//acceleration_axes) &
                    .or. has_beginning(words, "acc lacc gravity specific") &
                    .or. is_one_of(joined, acceleration_axes//" fx fy fz a")
      if (has_beginning(words, "quat orienta rotvec") .or. is_one_of(joined, quaternion_axes) .or. &
         has_word(words, quaternion_axes) .or. &
         (has_word(words, turning) .and. has_word(words, "vector"))) then
         found = column_class%quaternion
      else if (accelerates .and. has_word(words, "angular")) then
         found = column_class%other
      else if (turns .and. .not. (accelerates .and. has_word(words, "rate"))) then
         found = column_class%rate
      else if (accelerates) then
         found = column_class%acceleration
      else if (is_angle(words)) then
         found = column_class%angle
      else if (has_word(words, "alt pos vel vn ve vd vx vy vz sats") .or. has_beginning(words, &
         "lat lon lng alti heig posi velo spee gps gnss ecef loca hdop nort east")) then
         found = column_class%position
      else if (has_beginning(words, "pres baro humi ligh lux prox volt batt curr soun enco")) then
         found = column_class%other
      end if
   end function class_of_words

   pure logical function is_magnetic(words, joined)
      character(*), intent(in) :: words, joined

      is_magnetic = has_word(words, "mag") .or. has_beginning(words, "magn compa micro") &
                    .or. is_one_of(joined, magnetic_axes//" hx m")
      is_magnetic = (is_magnetic .and. .not. has_word(words, "magnitude")) &
                    .or. has_word(words, magnetic_axes) .or. has_beginning(words, "magx magy magz")
   end function is_magnetic

   !> True for the words of an attitude or of an increment of an angle.
   pure logical function is_angle(words)
      character(*), intent(in) :: words

      is_angle = has_beginning(words, "ang roll pitc yaw head azim atti eule phi psi thet")
   end function is_angle

   !> The unit of a column's values: what stood in brackets, else the last words of the name before
   !> an axis: gz_dps, gyro_x_rad_s, wx_deg_per_s, accelerometer_m_s2[0].
   pure subroutine find_unit(name, unit, found)
      character(*), intent(in) :: name, unit
      type(unit_type), intent(out) :: found
      character(:), allocatable :: words, text
      integer :: last, start(4), k

      if (len(unit) > 0) then
         if (.not. is_one_of(lower(unit), magnetic_units)) call recognize_unit(unit, found)
         return
      end if
      call split_name(name(:noteless_length(name)), words)
      last = len(words)
      do
         start(1) = index(words(:last - 1), " ", back=.true.)
         if (start(1) <= 1) return
         associate (word => words(start(1) + 1:last - 1))
            if (verify(word, "0123456789") > 0 .and. .not. is_one_of(word, "x y z column")) exit
         end associate
         last = start(1)
      end do
      do k = 2, 4
         start(k) = index(words(:max(start(k - 1) - 1, 0)), " ", back=.true.)
      end do
      do k = count(start > 1), 1, -1
         text = words(start(k) + 1:last)
         call replace_all(text, " per ", " ")
         text = trim(text)
         call replace_all(text, " ", "/")
         call recognize_unit(text, found)
         if (k == 1 .and. is_one_of(text, "g mg ug")) then
            words = words(:start(1))
            call join_words(words, text)
            call drop_digits(words)
            if (class_of_words(words, text) /= column_class%acceleration .or. &
               index(name, "/") > 0) found = unit_type()
         end if
         if (found%quantity /= quantity%unknown) return
      end do
   end subroutine find_unit

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

   !> Length of a name or unit without a note in brackets at its end, as "gyro deg/s (LSB 1/131)".
   pure integer function noteless_length(text) result(length)
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
      call recognize_unit(word, unit)
      is_unit = unit%quantity /= quantity%unknown .or. time_scale(word) > 0.0_dp .or. &
         is_temperature_unit(word) .or. is_one_of(word, magnetic_units//" "//other_units)
   end function is_unit

   !> True where a unit may be that of a class: the class is not known, or its quantity is the same.
   pure logical function unit_fits(class, unit)
      !> One of the components of [[gyroakf_column_class:column_class]]
      integer, intent(in) :: class
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
      character(*), intent(in) :: name, unit

      may_hold_time = &
         any(class_of(name, "") == [column_class%unknown, column_class%time, column_class%counter])
      if (is_unit(unit)) may_hold_time = may_hold_time .and. time_scale(lower(unit)) > 0.0_dp
   end function may_hold_time

end module gyroakf_column_class
