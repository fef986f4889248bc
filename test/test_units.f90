! SPDX-License-Identifier: MIT
!> Units: every spelling, exact factors, messages; what columns measure, by their names and the units
!> in them.
module test_units
   use expectations, only : failed => problem, test, error, check, check_refused
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_spelling, only : lower, replace_all, nearest_word, edit_distance
   use gyroakf_coefficient_units, only : coefficient_unit, coefficient_unit_type, density_unit
   use gyroakf_units, only : angle_to_rate_unit, parse_unit, quantity, unit_type
   use gyroakf_column_class, only : class_names, class_of, find_unit, is_unit, unit_fits, &
      & column_class
   implicit none (type, external)
   private
   public :: suite_units, suite_column_class

   !> One rounding of pi and one of the quotient
   real(dp), parameter :: thr = 4*epsilon(1.0_dp)

contains

   subroutine suite_units()
      call test("factors", test_factors)
      call test("spellings", test_spellings)
      call test("unknown", test_unknown)
      call test("angle-to-rate", test_angle_to_rate)
      call test("coefficients-rate", test_coefficients_rate)
      call test("coefficients-acceleration", test_coefficients_acceleration)
      call test("coefficients-unknown", test_coefficients_unknown)
      call test("acceleration-factors", test_acceleration_factors)
      call test("densities", test_densities)
      call test("spelling", test_spelling)
   end subroutine suite_units

   subroutine suite_column_class()
      call test("classes", test_classes)
      call test("units-in-names", test_units_in_names)
      call test("units", test_is_unit)
      call test("fitting-units", test_fitting)
   end subroutine suite_column_class

   !> The factor to SI of a text, -1 where it is refused.
   real(dp) function factor(text)
      character(*), intent(in) :: text
      type(unit_type) :: unit

      call parse_unit(text, unit, failed)
      factor = unit%to_si
      if (allocated(failed)) factor = -1.0_dp
   end function factor

   !> The canonical name and the quantity of a text as "name quantity", "?" where it is refused.
   function canonical(text) result(name)
      character(*), intent(in) :: text
      character(:), allocatable :: name
      type(unit_type) :: unit

      call parse_unit(text, unit, failed)
      name = "?"
      if (.not. allocated(failed)) name = unit%name//" "//achar(48 + unit%quantity)
   end function canonical

   subroutine test_factors()
      character(8), parameter :: name(9) = [character(8) :: "deg/s", "deg/h", "mdps", "rad/s", "mrad/s", "rpm", "arcsec", "g", "mg"]
      !> pi/180, pi/648000, pi/180000, ..., 2 pi/60, pi/648000
      real(dp), parameter :: expected(9) = [0.017453292519943295_dp, 4.84813681109536e-6_dp, 1.7453292519943296e-5_dp, 1.0_dp, &
                                            1.0e-3_dp, 0.10471975511965977_dp, 4.84813681109536e-6_dp, 9.80665_dp, 9.80665e-3_dp]
      integer :: i

      do i = 1, size(name)
         call check(error, factor(trim(name(i))), expected(i), thr=thr, rel=.true., more=trim(name(i)))
      end do
   end subroutine test_factors

   subroutine test_spellings()
      character(20), parameter :: same(2, 18) = reshape([character(20) :: &
         "dps", "deg/s 1", "DEG/S", "deg/s 1", "degrees per second", "deg/s 1", "[deg/s]", "deg/s 1", "deg s^-1", "deg/s 1", &
         "deg/sec", "deg/s 1", "degps", "deg/s 1", "dph", "deg/h 1", "deg/hr", "deg/h 1", "mdeg/s", "mdps 1", &
         "rad*s**-1", "rad/s 1", &
         "m/s2", "m/s^2 2", "m/s/s", "m/s^2 2", "m s^-2", "m/s^2 2", "arcseconds", "arcsec 3", "degrees", "deg 3", &
         " rad ", "rad 3", "rev/min", "rpm 1"], [2, 18])
      integer :: i

      do i = 1, size(same, 2)
         call check(error, canonical(trim(same(1, i))), trim(same(2, i)), more=trim(same(1, i)))
      end do
      call check(error, canonical(char(194)//char(176)//"/s"), "deg/s 1")
      call check(error, canonical("m/s"//char(194)//char(178)), "m/s^2 2")
   end subroutine test_spellings

   subroutine test_unknown()
      type(unit_type) :: unit
      character(8), parameter :: bad(7) = [character(8) :: "", "volt", "deg/ss", "deg/s/h", "/s", "deg/", "m/h"]
      integer :: i

      do i = 1, size(bad)
         call parse_unit(trim(bad(i)), unit, failed)
         call check_refused(failed, status%invalid_argument)
      end do
      call parse_unit("deg/ss", unit, failed)
      call check(error, index(failed%message, "unknown unit 'deg/ss', perhaps deg/s; known are deg/s, deg/h") == 1, failed%message)
   end subroutine test_unknown

   subroutine test_angle_to_rate()
      type(unit_type) :: unit, rate

      call parse_unit("arcsec", unit, failed)
      rate = angle_to_rate_unit(unit)
      call check(error, rate%name//achar(48 + rate%quantity), "arcsec/s1")
      call check(error, rate%to_si, factor("deg/h"), thr=0.0_dp)
      call parse_unit("g", unit, failed)
      rate = angle_to_rate_unit(unit)
      call check(error, rate%name, "g")
      call check(error, canonical("arcsec/s"), "arcsec/s 1")
      call parse_unit("cm/s", unit, failed)
      rate = angle_to_rate_unit(unit)
      call check(error, canonical("cm/s")//" "//rate%name//achar(48 + rate%quantity), "cm/s 4 cm/s^22")
      call check(error, rate%to_si, factor("cm/s^2"), thr=0.0_dp)
   end subroutine test_angle_to_rate

   subroutine test_coefficients_rate()
      type(unit_type) :: unit
      type(coefficient_unit_type) :: u
      character(11), parameter :: name(5) = [character(11) :: "arcsec", "deg/sqrt(h)", "deg/h", "deg/h^1.5", "deg/h^2"]
      !> 648000/pi, 10800/pi, 648000/pi, 38.88e6/pi, 2332.8e6/pi
      real(dp), parameter :: from_si(5) = [206264.80624709636_dp, 3437.746770784939_dp, 206264.80624709636_dp, &
                                           12375888.374825781_dp, 742553302.4895469_dp]
      integer :: i

      call parse_unit("deg/s", unit, failed)
      do i = 1, 5
         u = coefficient_unit(unit, i)
         call check(error, u%name, trim(name(i)))
         call check(error, u%from_si, from_si(i), thr=thr, rel=.true.)
      end do
   end subroutine test_coefficients_rate

   !> 1 ug = 9.80665e-6 m/s^2 exactly; 1 h = 3600 s, its root 60 sqrt(s). Powers of sqrt(s) in SI: m/s, m/s/s^0.5, m/s^2, ...
   subroutine test_coefficients_acceleration()
      type(unit_type) :: unit
      type(coefficient_unit_type) :: u
      character(11), parameter :: name(5) = [character(11) :: "m/s", "m/s/sqrt(h)", "ug", "ug/sqrt(h)", "ug/h"]
      character(11), parameter :: si_name(5) = [character(11) :: "m/s", "m/s/sqrt(s)", "m/s^2", "m/s^2.5", "m/s^3"]
      !> Of one in SI
      real(dp), parameter :: expected(5) = [1.0_dp, 60.0_dp, 1/9.80665e-6_dp, 60/9.80665e-6_dp, 3600/9.80665e-6_dp]
      integer :: term

      call parse_unit("mg", unit, failed)
      do term = 1, 5
         u = coefficient_unit(unit, term)
         call check(error, u%name//" "//u%si_name, trim(name(term))//" "//trim(si_name(term)))
         call check(error, u%from_si, expected(term), thr=thr, rel=.true.)
      end do
   end subroutine test_coefficients_acceleration

   !> One acceleration in every unit of one: 1 g = 1000 mg = 1e6 ug = 9.80665 m/s^2 = 980665 mgal.
   subroutine test_acceleration_factors()
      character(8), parameter :: name(8) = [character(8) :: "g", "mg", "ug", "m/s^2", "mm/s^2", "cm/s^2", "mGal", "ft/s^2"]
      real(dp), parameter :: of_one_g(8) = [1.0_dp, 1.0e3_dp, 1.0e6_dp, 9.80665_dp, 9806.65_dp, 980.665_dp, 980665.0_dp, &
                                            9.80665_dp/0.3048_dp]
      integer :: i

      do i = 1, size(name)
         call check(error, factor(trim(name(i)))*of_one_g(i), 9.80665_dp, thr=thr, rel=.true., more=trim(name(i)))
         call check(error, index(canonical(trim(name(i))), " 2") > 0, "no acceleration: "//name(i))
      end do
   end subroutine test_acceleration_factors

   subroutine test_densities()
      type(unit_type) :: unit
      type(coefficient_unit_type) :: u

      call parse_unit("deg/h", unit, failed)
      u = density_unit(unit)
      call check(error, u%name, "deg/s/sqrt(Hz)")
      ! 36 deg/h/sqrt(Hz) = 0.01 deg/s/sqrt(Hz)
      call check(error, 36*unit%to_si*u%from_si, 0.01_dp, thr=thr, rel=.true.)
      call parse_unit("mg", unit, failed)
      u = density_unit(unit)
      call check(error, u%name == "ug/sqrt(Hz)" .and. abs(unit%to_si*u%from_si - 1000) < 1.0e-9_dp)
      unit = unit_type()
      u = density_unit(unit)
      call check(error, u%name == "input unit/sqrt(Hz)" .and. abs(u%from_si - 1) < thr)
   end subroutine test_densities

   subroutine test_coefficients_unknown()
      type(unit_type) :: unit
      type(coefficient_unit_type) :: u

      u = coefficient_unit(unit, 2)
      call check(error, u%name//", "//u%si_name, "input unit*sqrt(s), input unit*sqrt(s)")
      call check(error, u%from_si, 1.0_dp)
      call parse_unit("deg/s", unit, failed)
      u = coefficient_unit(unit, 5, per_sample=.true.)
      call check(error, u%name, "deg/s/sample")
      call check(error, u%from_si*unit%to_si, 1.0_dp, thr=thr)
   end subroutine test_coefficients_unknown

   subroutine test_spelling()
      character(6), parameter :: known(3) = [character(6) :: "--rate", "--unit", "--out"]
      character(:), allocatable :: text

      call check(error, edit_distance("kitten", "sitting"), 3)
      call check(error, edit_distance("rtae", "rate"), 1)
      call check(error, edit_distance("", "ab"), 2)
      call check(error, nearest_word("--UNTI", known), 2)
      call check(error, nearest_word("column", known), 0)
      text = "a**b**"
      call replace_all(text, "**", "^")
      call check(error, text//lower("AbZ1"), "a^b^abz1")
   end subroutine test_spelling

   !> Names of loggers, with the class of each list.
   subroutine test_classes()
      call expect(column_class%rate, "gx,Gyr_X,gyro_rad[0],GyroX(2),g(1),wx,omega_z,.angular_velocity.x,rotationRateX,"// &
                  "yaw rate,G_Y,gyroRotationX,wx_rad_per_s,gz_dps,rollspeed")
      if (.not. allocated(error)) call expect(column_class%acceleration, "ax,Acc_X,accelerometer_m_s2[1],gFx,a_z,"// &
         "linear_acceleration.y,specific_force_x,acc_x_mg,userAccelerationX,gravity x")
      if (.not. allocated(error)) call expect(column_class%magnetic, "mag_x,Bx,magX,Magnetic field y,M_Z,compass")
      if (.not. allocated(error)) call expect(column_class%temperature, "temp,T,gyro_temp,IMU Temperature,tempC")
      if (.not. allocated(error)) call expect(column_class%time, "t,TimeUS,gps_tow_s,acc_timestamp,Elapsed Time")
      if (.not. allocated(error)) call expect(column_class%counter, "PacketCounter,seq,sample,.header.seq")
      if (.not. allocated(error)) call expect(column_class%flag, "status,gyro_clipping,StatusWord,error_flags,acc_valid")
      if (.not. allocated(error)) call expect(column_class%quaternion, "Quat_q0,qw,q_x,.orientation.w,q2")
      if (.not. allocated(error)) call expect(column_class%position, "lat,Longitude,altitude,pos_x,vel_n,Speed")
      if (.not. allocated(error)) call expect(column_class%angle, "roll,Pitch,heading,attitude_y,delta_angle[0]")
      if (.not. allocated(error)) call expect(column_class%other, &
         "gyro_bias_x,.angular_velocity_covariance_0,pressure,battery_v,gyro_integral_dt,GHz,angular_acceleration_x")
      if (.not. allocated(error)) call expect(column_class%unknown, "x,I,foo,column 3,value")
   end subroutine test_classes

   !> Every name of a comma list has the class.
   subroutine expect(class, list)
      integer, intent(in) :: class
      character(*), intent(in) :: list
      integer :: from, to

      from = 1
      do while (from <= len(list))
         to = index(list(from:)//",", ",") + from - 2
         call check(error, trim(class_names(class_of(list(from:to), ""))), trim(class_names(class)), more=list(from:to))
         from = to + 2
      end do
   end subroutine expect

   !> Units at the end of names, before an axis or an index, and of brackets.
   subroutine test_units_in_names()
      character(20), parameter :: names(17) = [character(20) :: "gz_dps", "GyroX_mdps", "gx_rad_s", "gx_radps", "gx_deg_per_s", &
         "gyro_deg_s_x", "acc_m_s2[0]", "ax_m_per_s2", "acc_g_x", "wx_deg_h", "gx_degps", "gx_rad_per_sec", "gyro_rad[0]", "x_g", &
         "gx", "dps", "mag_x_ut"]
      character(8), parameter :: units(17) = [character(8) :: "deg/s", "mdps", "rad/s", "rad/s", "deg/s", "deg/s", "m/s^2", &
         "m/s^2", "g", "deg/h", "deg/s", "rad/s", "rad", "", "", "", ""]
      type(unit_type) :: unit
      integer :: i

      do i = 1, size(names)
         call find_unit(trim(names(i)), "", unit)
         if (.not. allocated(unit%name)) unit%name = ""
         call check(error, unit%name, trim(units(i)), more=names(i))
      end do
      call check(error, class_of("x-axis", "deg/s") == column_class%rate .and. class_of("x", "m/s^2") == column_class%acceleration &
                 .and. class_of("x", "uT") == column_class%magnetic, "brackets")
      call check(error, class_of("roll", "deg/s") == column_class%rate, "a rate by its unit")
   end subroutine test_units_in_names

   subroutine test_is_unit()
      call check(error, is_unit("deg/s") .and. is_unit("us") .and. is_unit("degC") .and. is_unit("uT") .and. is_unit("LSB") .and. &
                 is_unit("hPa") .and. is_unit(" m/s^2 "), "units")
      call check(error, .not. (is_unit("0") .or. is_unit("12") .or. is_unit("x") .or. is_unit("") .or. is_unit("-0700") .or. &
                               is_unit("left") .or. is_unit("i")), "no units")
   end subroutine test_is_unit

   subroutine test_fitting()
      type(unit_type) :: unit

      call find_unit("gx", "deg/s", unit)
      call check(error, unit_fits(column_class%rate, unit) .and. unit_fits(column_class%unknown, unit) .and. .not. &
                 unit_fits(column_class%acceleration, unit) .and. .not. unit_fits(column_class%magnetic, unit), "a rate")
      call find_unit("ax", "g", unit)
      call check(error, unit_fits(column_class%acceleration, unit) .and. .not. unit_fits(column_class%rate, unit), "acceleration")
   end subroutine test_fitting

end module test_units
