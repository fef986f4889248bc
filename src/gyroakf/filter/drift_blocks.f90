! SPDX-License-Identifier: MIT
!> Block means of a drift in white noise are a drift in white noise: the models of samples and of
!> means of m samples.
!>
!> A random walk of steps q becomes one of steps m q, an AR(1) process of coefficient phi one of
!> coefficient phi^m; what is left is white. With D the variance of the AR(1) process, for any lag
!> l >= 1,
!> $$ \gamma_l = D\,s^2 \phi^{ml}, \quad s = \frac{\sinh(m/2T)}{m\,\sinh(1/2T)}, \quad
!>    T = -1/\ln\phi, \quad \gamma_0 = D\,V = \frac{D}{m} \left( \frac{1+\phi}{1-\phi}
!>    - \frac{2 \phi (1 - \phi^m)}{m (1-\phi)^2} \right) $$
!> and the white noise of the means is
!> $$ R' = \frac{r}{m} + \sum_i D_i (V_i - s_i^2) - \frac{q}{6} \left( m - \frac1m \right) $$
!> where a process much faster than a block enters with D V alone.
!>
!> Source: Working, Econometrica 28 (1960) 916-918, for the random walk; the others are sums of
!> geometric series.
module gyroakf_filter_drift_blocks
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_filter_components, only : component_model_type
   implicit none (type, external)
   private
   public :: block_means, model_of_means, process_of_samples

   !> Blocks a correlation time below which a process is white in the means: its correlation from
   !> mean to mean is below e^-20
   real(dp), parameter :: white_below = 0.05_dp

contains

   !> Means of m successive samples; missing where more than half of them are.
   subroutine block_means(x, m, means, present_means, error, valid)
      !> Series, [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Samples a block
      integer(int64), intent(in) :: m
      !> [n/m]
      real(dp), allocatable, intent(out) :: means(:)
      !> [n/m], allocated only where one is missing
      integer(int8), allocatable, intent(out) :: present_means(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing, [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: count_present, i, n
      real(dp) :: total
      integer :: stat

      n = size(x, kind=int64)/m
      allocate (means(n), stat=stat)
      if (stat == 0 .and. present(valid)) allocate (present_means(n), stat=stat)
      call check_memory(stat, "the block means of a series", error)
      if (allocated(error)) return
      do i = 1, n
         associate (block => x((i - 1)*m + 1:i*m))
            count_present = m
            if (present(valid)) then
               associate (here => valid((i - 1)*m + 1:i*m) /= 0_int8)
                  count_present = count(here, kind=int64)
                  total = sum(block, mask=here)
               end associate
               present_means(i) = merge(1_int8, 0_int8, 2*count_present >= m)
            else
               total = sum(block)
            end if
         end associate
         means(i) = 0.0_dp
         if (2*count_present >= m) means(i) = total/real(count_present, dp)
      end do
      if (.not. allocated(present_means)) return
      if (all(present_means /= 0_int8)) deallocate (present_means)
   end subroutine block_means

   !> The model of the means of m samples.
   pure subroutine model_of_means(model, m, means)
      !> Of the samples
      type(component_model_type), intent(in) :: model
      !> Samples a mean, >= 1
      integer(int64), intent(in) :: m
      !> Processes that are white in the means are not among its own; r is 0 where the exact white
      !> noise is negative
      type(component_model_type), intent(out) :: means
      real(dp) :: phi, width, variance, share, white
      integer :: i

      width = real(m, dp)
      white = model%r/width
      do i = 1, model%count
         phi = model%phi(i)
         if (phi >= 1.0_dp) then
            white = white - model%q(i)*(width - 1.0_dp/width)/6.0_dp
            call add(means, 1.0_dp, width*model%q(i))
            cycle
         end if
         variance = model%q(i)/((1.0_dp - phi)*(1.0_dp + phi))
         white = white &
            + variance*((1.0_dp + phi)/(1.0_dp - phi) &
            - 2.0_dp*phi*(1.0_dp - phi**m)/(width*(1.0_dp - phi)**2))/width
         if (phi <= 0.0_dp) cycle
         if (-1.0_dp/log(phi) < white_below*width) cycle
         share = share_of_means(phi, m)
         white = white - variance*share**2
         call add(means, phi**m, variance*share**2*(1.0_dp - phi**m)*(1.0_dp + phi**m))
      end do
      means%r = max(white, 0.0_dp)
   end subroutine model_of_means

   !> The process of the samples from that of their means.
   pure subroutine process_of_samples(phi_means, q_means, m, phi, q)
      !> Of the means: 0 < phi <= 1
      real(dp), intent(in) :: phi_means, q_means
      !> Samples a mean
      integer(int64), intent(in) :: m
      !> Of the samples
      real(dp), intent(out) :: phi, q

      if (phi_means >= 1.0_dp) then
         phi = 1.0_dp
         q = q_means/real(m, dp)
         return
      end if
      phi = exp(log(phi_means)/real(m, dp))
      q = q_means/((1.0_dp - phi_means)*(1.0_dp + phi_means))*(1.0_dp - phi)*(1.0_dp &
         + phi)/share_of_means(phi, m)**2
   end subroutine process_of_samples

   !> The root of what the covariance of the means at a lag is over that of the samples between
   !> the middles of the blocks.
   pure real(dp) function share_of_means(phi, m) result(share)
      real(dp), intent(in) :: phi
      integer(int64), intent(in) :: m
      real(dp) :: half

      half = -0.5_dp*log(phi)
      share = sinh(half*real(m, dp))/(real(m, dp)*sinh(half))
   end function share_of_means

   !> Adds a process.
   pure subroutine add(model, phi, q)
      type(component_model_type), intent(inout) :: model
      real(dp), intent(in) :: phi, q

      model%count = model%count + 1
      model%phi(model%count) = phi
      model%q(model%count) = q
   end subroutine add

end module gyroakf_filter_drift_blocks
