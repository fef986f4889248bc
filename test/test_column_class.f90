! SPDX-License-Identifier: MIT
!> What columns measure, by their names, and the units in names.
module test_column_class
   use gyroakf_column_class, only : class_names, class_of, find_unit, is_unit, unit_fits, column_class
   use gyroakf_units, only : unit_type
   use expectations, only : test, error, check
   implicit none (type, external)
   private
   public :: suite_column_class

contains

   subroutine suite_column_class()
      call test("classes", test_classes)
      call test("units-in-names", test_units_in_names)
      call test("units", test_units)
      call test("fitting-units", test_fitting)
   end subroutine suite_column_class

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

   subroutine test_units()
      call check(error, is_unit("deg/s") .and. is_unit("us") .and. is_unit("degC") .and. is_unit("uT") .and. is_unit("LSB") .and. &
                 is_unit("hPa") .and. is_unit(" m/s^2 "), "units")
      call check(error, .not. (is_unit("0") .or. is_unit("12") .or. is_unit("x") .or. is_unit("") .or. is_unit("-0700") .or. &
                               is_unit("left") .or. is_unit("i")), "no units")
   end subroutine test_units

   subroutine test_fitting()
      type(unit_type) :: unit

      call find_unit("gx", "deg/s", unit)
      call check(error, unit_fits(column_class%rate, unit) .and. unit_fits(column_class%unknown, unit) .and. .not. &
                 unit_fits(column_class%acceleration, unit) .and. .not. unit_fits(column_class%magnetic, unit), "a rate")
      call find_unit("ax", "g", unit)
      call check(error, unit_fits(column_class%acceleration, unit) .and. .not. unit_fits(column_class%rate, unit), "acceleration")
   end subroutine test_fitting

end module test_column_class
