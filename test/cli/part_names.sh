# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Names of columns, what they measure, which of them are analyzed, and rows of several sensors.

plain() { tr -s ' \n' ' ' <out >words; holds "$1" "$2" words; }
# table HEADER COLUMNS [SCALE]: rows of noise behind a time of 100 Hz
table() { awk -v head="$1" -v n="$2" 'BEGIN { print head; for (i = 0; i < 300; i++) { s = sprintf("%.2f", i*0.01)
   for (k = 1; k <= n; k++) s = s "," sprintf("%.5f", sin(i*i + k)); print s } }'; }

# an index belongs to the name, a unit does not
table 't,gyro_rad[0],gyro_rad[1],gyro_rad[2]' 3 >index.csv
good "an index in brackets" inspect index.csv --json -
holds "stays in the name" '"channels": ["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"]' out
good "and chooses the column" inspect index.csv --column 'gyro_rad[2]' --json -
holds "the third" '"channels": ["gyro_rad[2]"]' out
bad "no other axis is suggested" 2 "there is no column 'gyro_rad[3]'; the file has" inspect index.csv --column 'gyro_rad[3]'
bad "a spelling is" 2 "perhaps 'gyro_rad[1]'" inspect index.csv --column 'gyr_rad[1]'
table 't,a [g],a [m/s^2]' 2 >two_units.csv
good "equal names of two units" inspect two_units.csv --json -
holds "keep them" '"channels": ["a [g]", "a [m/s^2]"]' out
good "a name with its unit" inspect two_units.csv --column 'a [g]'
table 't,gx,gx,gz' 3 >equal.csv
bad "equal names" 2 "names of columns are equal: 'gx' in columns 2, 3" inspect equal.csv
good "by number" inspect equal.csv --column 3,4 --json -
holds "they are told apart" '"channels": ["gx (column 3)", "gz"]' out

# units at the end of a name
for pair in gz_dps=deg/s gz_mdps=mdps gx_rad_s=rad/s gx_radps=rad/s wz_deg_per_s=deg/s gyro_dps_x=deg/s ax_m_s2=m/s^2 acc_x_mg=mg; do
   table "t,${pair%=*}" 1 >unit.csv
   good "the name ${pair%=*}" allan unit.csv --json -
   holds "its unit" "\"unit\": \"${pair#*=}\"" out
done

# what stands above the rows
{ printf 'A log of 2026, by hand\n'; table 't,gx,gy' 2; } >title.csv
good "a title" inspect title.csv --json -
holds "names below it" '"channels": ["gx", "gy"]' out
table 't,gx,gy' 2 | tr , ';' | sed '1s/.*/time;gyro [deg\/s];\n;x;y/' >groups.csv
good "groups of columns" inspect groups.csv
plain "names of both lines" "2 channels: gyro x, gyro y"
plain "their unit" "Unit deg/s"
table 't,gx,gy' 2 | sed '1s/.*/t,gx,gy\ns,deg\/s,deg\/s/' >units.csv
good "a row of units" inspect units.csv
plain "is read" "Unit deg/s"
table 't;gx;gy' 2 | tr , ';' | sed '1s/.*/;t;gx;gy;/' >ends.csv
good "a header between separators" inspect ends.csv --json -
holds "names are not shifted" '"channels": ["gx", "gy"]' out
table '.stamp,.angular_velocity.x,.angular_velocity.y' 2 >dots.csv
good "names that begin with a point" inspect dots.csv --json -
holds "are names" '"channels": [".angular_velocity.x", ".angular_velocity.y"]' out

# classes
table 'time_s,acc_x,acc_y,gyro_x,gyro_y,mag_x,temp,quat_w,lat,status,extra' 10 >imu.csv
good "an inertial sensor" inspect imu.csv --unit rad/s
plain "gyroscopes first" "4 channels: gyro_x, gyro_y, acc_x, acc_y"
plain "a unit for its quantity" "Units rad/s for gyro_x, gyro_y; not known for acc_x, acc_y"
plain "the others in one line" "columns not analyzed: 6 mag_x (magnetic field); 7 temp (temperature); 8 quat_w (quaternion); 9 lat \
(position); 10 status (flag); 11 extra (unknown); --column reads them"
plain "the table" "column name class unit minimum maximum step use 1 time_s time - 0 2.99 0.01 time"
plain "what is not analyzed" "6 mag_x magnetic field - -"
good "kalibr" allan imu.csv --unit rad/s --terms NK --kalibr imu.yaml
holds "no accelerometer in rad/s" "#accelerometer_noise_density:" imu.yaml
bad "a unit of another quantity" 2 "does not fit 'acc_x'" allan imu.csv --column acc_x --unit rad/s
bad "in a list, too" 2 "does not fit 'acc_x'" allan imu.csv --column gyro_x,acc_x --unit rad/s,deg/s

# two sensors in one table
awk 'BEGIN { print "TimeUS,I,GyrX"; for (i = 0; i < 600; i++) printf "%d,%d,%.5f\n", int(i/2)*2500, i%2, sin(i*i) + i%2*100 }' >two.csv
bad "two sensors" 2 "column 'I' alternates between 2 values while the time stamps repeat: 2 sensors in one table" inspect two.csv
holds "are named" "options that read it: --where I=0; --where I=1" err
good "one of them" inspect two.csv --where I=1 --json one.json
plain "its rate" "Rate 400 Hz (from the time stamps)"
plain "its samples" "300 in 1 channel: GyrX"
plain "its lines" "0 duplicates"
sed 's/,0,/,left,/; s/,1,/,right,/' two.csv >named.csv
good "sensors with names" inspect named.csv --where I=right
plain "the right one" "3 GyrX angular rate - 99"
bad "no such column" 2 "there is no column 'J'" inspect two.csv --where J=1
bad "no such value" 2 "no row agrees with I=7" inspect two.csv --where I=7
bad "no condition" 2 "COLUMN=VALUE" inspect two.csv --where I
