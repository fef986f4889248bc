! SPDX-License-Identifier: MIT
!> Distribution of the Dickey-Fuller statistic: MacKinnon's response surfaces.
!>
!> Sources: critical values J. G. MacKinnon, Queen's Economics Department working paper 1227 (2010);
!> p-values J. G. MacKinnon, J. Bus. Econ. Stat. 12 (1994) 167-176. Both for one series.
module gyroakf_series_mackinnon
   use gyroakf_kinds, only : dp, int64
   use gyroakf_special, only : normal_cdf
   implicit none (type, external)
   private
   public :: regression_number, critical_values, p_value

   !> Critical values at 1 %, 5 %, 10 %: powers 0 .. 3 of 1/T, for n, c, ct, ctt
   real(dp), parameter :: critical(0:3, 3, 4) = reshape([ &
      & -2.56574_dp, -2.2358_dp, -3.627_dp, 0.0_dp, &
      & -1.94100_dp, -0.2686_dp, -3.365_dp, 31.223_dp, &
      & -1.61682_dp, 0.2656_dp, -2.714_dp, 25.364_dp, &
      & -3.43035_dp, -6.5393_dp, -16.786_dp, -79.433_dp, &
      & -2.86154_dp, -2.8903_dp, -4.234_dp, -40.040_dp, &
      & -2.56677_dp, -1.5384_dp, -2.809_dp, 0.0_dp, &
      & -3.95877_dp, -9.0531_dp, -28.428_dp, -134.155_dp, &
      & -3.41049_dp, -4.3904_dp, -9.036_dp, -45.374_dp, &
      & -3.12705_dp, -2.5856_dp, -3.925_dp, -22.380_dp, &
      & -4.37113_dp, -11.5882_dp, -35.819_dp, -334.047_dp, &
      & -3.83239_dp, -5.9057_dp, -12.490_dp, -118.284_dp, &
      & -3.55326_dp, -3.6596_dp, -5.293_dp, -63.559_dp], [4, 3, 4])
   !> Below the first p is 0, up to the second the small-p polynomial holds, above the third p is 1
   real(dp), parameter :: bound(3, 4) = reshape([ &
      & -19.04_dp, -1.04_dp, huge(1.0_dp), &
      & -18.83_dp, -1.61_dp, 2.74_dp, &
      & -16.18_dp, -2.89_dp, 0.70_dp, &
      & -17.17_dp, -3.21_dp, 0.54_dp], [3, 4])
   real(dp), parameter :: small_p(0:2, 4) = reshape([ &
      & 0.6344_dp, 1.2378_dp, 0.032496_dp, &
      & 2.1659_dp, 1.4412_dp, 0.038269_dp, &
      & 3.2512_dp, 1.6047_dp, 0.049588_dp, &
      & 4.0003_dp, 1.6580_dp, 0.048288_dp], [3, 4])
   real(dp), parameter :: large_p(0:3, 4) = reshape([ &
      & 0.4797_dp, 0.93557_dp, -0.06999_dp, 0.033066_dp, &
      & 1.7339_dp, 0.93202_dp, -0.12745_dp, -0.010368_dp, &
      & 2.5261_dp, 0.61654_dp, -0.37956_dp, -0.060285_dp, &
      & 3.0778_dp, 0.49529_dp, -0.41477_dp, -0.059359_dp], [4, 4])

contains

   !> 1 n, 2 c, 3 ct, 4 ctt: one more than the number of deterministic terms; 0 unknown.
   pure integer function regression_number(regression)
      !> n, c, ct or ctt
      character(*), intent(in) :: regression
      character(3), parameter :: names(4) = [character(3) :: "n", "c", "ct", "ctt"]

      regression_number = findloc(names == regression, .true., 1)
   end function regression_number

   !> Critical values at 1 %, 5 %, 10 % for T rows, $$b_0 + b_1/T + b_2/T^2 + b_3/T^3$$
   pure function critical_values(regression, observations) result(values)
      !> 1 .. 4, see regression_number
      integer, intent(in) :: regression
      !> Rows of the regression, T >= 1
      integer(int64), intent(in) :: observations
      real(dp) :: values(3), u

      u = 1.0_dp/real(observations, dp)
      values = critical(0, :, regression) + u*(critical(1, :, regression) &
         & + u*(critical(2, :, regression) + u*critical(3, :, regression)))
   end function critical_values

   !> Asymptotic probability of a smaller statistic under the unit root, Phi of a polynomial in it.
   pure real(dp) function p_value(statistic, regression)
      !> The statistic
      real(dp), intent(in) :: statistic
      !> 1 .. 4, see regression_number
      integer, intent(in) :: regression
      real(dp) :: t

      t = statistic
      if (t > bound(3, regression)) then
         p_value = 1.0_dp
      else if (t < bound(1, regression)) then
         p_value = 0.0_dp
      else if (t <= bound(2, regression)) then
         p_value = normal_cdf(small_p(0, regression) + t*(small_p(1, regression) &
            & + t*small_p(2, regression)))
      else
         p_value = normal_cdf(large_p(0, regression) + t*(large_p(1, regression) &
            & + t*(large_p(2, regression) + t*large_p(3, regression))))
      end if
   end function p_value

end module gyroakf_series_mackinnon
