! SPDX-License-Identifier: MIT
!> Stand-ins of real recordings for `simulate --preset`: rate, length, noise, filter and LSB as found in them.
module gyroakf_app_sensor
   implicit none (type, external)
   private
   public :: sensor_options

   !> A preset
   type :: sensor_type
      !> Its name, a word of --preset
      character(12) :: name = ""
      !> Options of simulate, each with its value, separated by single blanks
      character(160) :: options = ""
   end type sensor_type

   !> ADIS16405, gyroscope and accelerometer; Xsens MTi-G, gyroscope, and DOT; a navigation-grade ring laser on a base
   !> that is disturbed for 600 s; MPU6050. N and B are 2.48 deg/sqrt(h), 38 deg/h; 0.2 m/s/sqrt(h), 0.2 mg;
   !> 1.82 deg/sqrt(h); 0.365 deg/sqrt(h), 5 deg/h; 0.005 deg/sqrt(h); 0.755 deg/sqrt(h), 16.1 deg/h.
   type(sensor_type), parameter :: sensors(*) = [ &
      sensor_type("adis16405", "--rate 100 --samples 1000000 --coefficients N=0.041333,B=0.010556 --resonance 20,3 --lsb 0.05"), &
      sensor_type("adis16405-xl", "--rate 100 --samples 1000000 --unit g --coefficients N=3.4e-4,B=2e-4 "// &
                  "--markov 2e-3,0.2,3e-4,60 --lsb 3.33e-3"), &
      sensor_type("mti-g", "--rate 100 --samples 500000 --unit rad/s --coefficients N=5.3e-4 --tails mixture "// &
                  "--contamination 0.00036,31"), &
      sensor_type("xsens-dot", "--rate 120 --samples 14400 --coefficients N=0.0060833,B=0.0013889 --lowpass 15"), &
      sensor_type("ring-laser", "--rate 100 --samples 184718 --unit deg/h --coefficients Q=0.29,N=0.3 "// &
                  "--vibration 55,2.5,0.02 --motion 70,400,0.3,600"), &
      sensor_type("mpu6050", "--rate 99.32 --samples 65067 --coefficients N=0.012583,B=0.0044722 "// &
                  "--vibration 0.087,31.4,0.1 --lsb 0.0076336")]

contains

   !> The options of a preset, with a blank behind each word; "" of an unknown name.
   function sensor_options(name) result(options)
      !> The name
      character(*), intent(in) :: name
      character(:), allocatable :: options
      integer :: i

      options = ""
      do i = 1, size(sensors)
         if (sensors(i)%name == name) options = trim(sensors(i)%options)//" "
      end do
   end function sensor_options

end module gyroakf_app_sensor
