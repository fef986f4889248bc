! SPDX-License-Identifier: MIT
!> Nine kinds of records whose drift is known, with the state space that they were made by.
!>
!> All are at 5 Hz in deg/s and have the cubic of the paper's record, whose 12000 samples are the usual length:
!>
!> | case | noise | truth |
!> |---|---|---|
!> | C0a | the paper's: AR(1), phi 0.409975, variance 5.24e-4, and 12 outliers | the cubic |
!> | C0b | the same | the cubic and the AR(1) |
!> | C1 | AR(1), phi 0.98, variance 1e-4; white noise of variance 4.2e-4 | the cubic and the AR(1) |
!> | C2 | flicker B 0.003 deg/s; walk K 2e-4 deg/s/sqrt(s); that white noise | all but the white noise |
!> | C3 | AR(2), phi 1.6, -0.64, variance 1e-4; that white noise | the cubic and the AR(2) |
!> | C4 | C1, the variance of the white noise 9 times as large in the middle third | as C1 |
!> | C5 | walk of q = 1.68e-7 a sample and six steps of 0.03 deg/s; that white noise | all but the white noise |
!> | C6 | C2 with 1 % outliers of 4 to 20 standard deviations | as C2 |
!> | C7 | C1, the variance that drives the AR(1) 25 times as large in the middle third | as C1 |
module filter_truth_cases
   use gyroakf, only : dp, error_type, fill_normal, int64, next_normal, next_uniform, &
      & paper_preset, paper_seed, random_type, seed_random, simulate_options
   use gyroakf_simulate_noise, only : add_autoregressive, add_flicker
   use gyroakf_simulate_disturbance, only : add_outliers, add_polynomial
   implicit none (type, external)
   private
   public :: world_type, make_world, case_names, samples, sample_interval

   character(3), parameter :: case_names(9) = ["C0a", "C0b", "C1 ", "C2 ", "C3 ", "C4 ", "C5 ", "C6 ", "C7 "]
   integer, parameter :: samples = 12000
   real(dp), parameter :: sample_interval = 0.2_dp, white_variance = 4.2e-4_dp, drift_variance = 1.0e-4_dp, drift_phi = 0.98_dp
   real(dp), parameter :: fast_phi(2) = [1.6_dp, -0.64_dp], flicker = 3.0e-3_dp, rate_walk = 2.0e-4_dp
   real(dp), parameter :: walk_q = 4.0e-4_dp*white_variance, step_size = 0.03_dp
   !> Flicker noise for the oracle: Markov processes of equal variance, their times 0.1 s and four times longer each
   integer, parameter :: markovs = 9
   real(dp), parameter :: markov_ratio = 4.0_dp, shortest_markov = 0.1_dp, pi = 3.14159265358979323846_dp
   !> Variance of a random walk before the record
   real(dp), parameter :: unknown = 1.0e-2_dp
   !> Streams of the generator
   integer, parameter :: of_white = 1, of_drift = 2, of_flicker = 3, of_outliers = 4, of_steps = 5

   !> A record, its truth, and the model that it was made by
   type :: world_type
      character(3) :: name = ""
      !> Record, its true drift, the cubic alone; [n]
      real(dp), allocatable :: z(:), truth(:), trend(:)
      logical, allocatable :: outlier(:)
      !> x' = transition x + w, z = sum(x, seen) + trend + v; Var(w) = q factor, on the first state jump beside; Var(v) = r
      real(dp), allocatable :: transition(:, :), q(:), prior(:, :), factor(:), jump(:), r(:)
      logical, allocatable :: seen(:)
   end type world_type

contains

   !> Makes the record of a case.
   subroutine make_world(name, seed, n, world)
      !> One of `case_names`
      character(*), intent(in) :: name
      !> Seed; each part of the noise has a stream of its own, so cases share what they have in common
      integer, intent(in) :: seed
      !> Samples
      integer, intent(in) :: n
      type(world_type), intent(out) :: world
      type(simulate_options) :: paper
      real(dp), allocatable :: drift(:), white(:)

      paper = paper_preset(paper_seed)
      world%name = name
      allocate (world%z(n), world%truth(n), world%trend(n), drift(n), white(n), world%jump(n), source=0.0_dp)
      allocate (world%factor(n), source=1.0_dp)
      allocate (world%r(n), source=white_variance)
      allocate (world%outlier(n), source=.false.)
      call add_polynomial(world%trend, paper%trend, 0_int64)
      associate (middle => world%factor(n/3 + 1:2*n/3), middle_r => world%r(n/3 + 1:2*n/3))
         if (name == "C7") middle = 25.0_dp
         if (name == "C4") middle_r = 9.0_dp*white_variance
      end associate
      select case (name)
      case ("C0a", "C0b")
         call make_autoregressive(paper%ar, paper%ar_variance, seed, drift, world)
         world%r = 0.0_dp
      case ("C1", "C4", "C7"); call make_autoregressive([drift_phi], drift_variance, seed, drift, world)
      case ("C3"); call make_autoregressive(fast_phi, drift_variance, seed, drift, world)
      case ("C2", "C6"); call make_flicker(seed, drift, world)
      case ("C5"); call make_steps(seed, drift, world)
      case default; error stop "there is no such case"
      end select
      call fill_of(seed, of_white, white)
      world%z = drift + sqrt(world%r)*white
      call spoil(name, seed, paper, world)
      world%truth = world%trend + drift
      if (name == "C0a") world%truth = world%trend
      world%z = world%z + world%trend
   end subroutine make_world

   !> Standard normal numbers of a stream.
   subroutine fill_of(seed, stream, g)
      integer, intent(in) :: seed, stream
      real(dp), intent(out), contiguous :: g(:)
      type(random_type) :: random

      call seed_random(random, int(seed, kind(random%state)), stream)
      call fill_normal(random, g)
   end subroutine fill_of

   !> An AR(1) or AR(2) process; its driving noise has the variance factors of the world.
   subroutine make_autoregressive(phi, variance, seed, drift, world)
      real(dp), intent(in) :: phi(:), variance
      integer, intent(in) :: seed
      real(dp), intent(out), contiguous :: drift(:)
      type(world_type), intent(inout) :: world
      type(random_type) :: random
      type(error_type), allocatable :: error
      real(dp) :: rho, g
      integer :: k, p

      p = size(phi)
      rho = phi(1)
      if (p == 2) rho = phi(1)/(1.0_dp - phi(2))
      allocate (world%transition(p, p), world%prior(p, p), world%q(p), source=0.0_dp)
      allocate (world%seen(p), source=.false.)
      world%seen(1) = .true.
      world%transition(1, :) = phi
      world%prior = variance
      world%q(1) = variance*(1.0_dp - rho**2)
      if (p == 2) then
         world%q(1) = world%q(1)*(1.0_dp - phi(2)**2)
         world%transition(2, 1) = 1.0_dp
         world%prior(2, 1) = rho*variance
         world%prior(1, 2) = rho*variance
      end if
      call seed_random(random, int(seed, kind(random%state)), of_drift)
      drift = 0.0_dp
      if (all(world%factor < 2.0_dp)) then
         call add_autoregressive(drift, phi, variance, random, error)
         if (allocated(error)) error stop error%message
         return
      end if
      call next_normal(random, g)
      drift(1) = sqrt(variance)*g
      do k = 2, size(drift)
         call next_normal(random, g)
         drift(k) = phi(1)*drift(k - 1) + sqrt(world%q(1)*world%factor(k))*g
      end do
   end subroutine make_autoregressive

   !> Flicker noise and a random walk.
   subroutine make_flicker(seed, drift, world)
      integer, intent(in) :: seed
      real(dp), intent(out), contiguous :: drift(:)
      type(world_type), intent(inout) :: world
      type(random_type) :: random
      type(error_type), allocatable :: error
      real(dp) :: phi, variance, w
      real(dp), allocatable :: g(:)
      integer :: k

      allocate (g(size(drift)))
      call fill_of(seed, of_drift, g)
      w = 0.0_dp
      do k = 1, size(world%z)
         w = w + rate_walk*sqrt(sample_interval)*g(k)
         drift(k) = w
      end do
      call seed_random(random, int(seed, kind(random%state)), of_flicker)
      call add_flicker(drift, flicker, random, error)
      if (allocated(error)) error stop error%message
      allocate (world%transition(markovs + 1, markovs + 1), world%prior(markovs + 1, markovs + 1), world%q(markovs + 1), &
                source=0.0_dp)
      allocate (world%seen(markovs + 1), source=.true.)
      variance = flicker**2*log(markov_ratio)/pi
      do k = 1, markovs
         phi = exp(-sample_interval/(shortest_markov*markov_ratio**(k - 1)))
         world%transition(k, k) = phi
         world%prior(k, k) = variance
         world%q(k) = variance*(1.0_dp - phi**2)
      end do
      world%transition(k, k) = 1.0_dp
      world%prior(k, k) = unknown
      world%q(k) = rate_walk**2*sample_interval
   end subroutine make_flicker

   !> A random walk and six steps.
   subroutine make_steps(seed, drift, world)
      integer, intent(in) :: seed
      real(dp), intent(out), contiguous :: drift(:)
      type(world_type), intent(inout) :: world
      type(random_type) :: random
      real(dp) :: u, level
      real(dp), allocatable :: g(:), jump(:)
      integer :: k, place

      allocate (g(size(drift)))
      allocate (jump(size(drift)), source=0.0_dp)
      call seed_random(random, int(seed, kind(random%state)), of_steps)
      do k = 1, 6
         call next_uniform(random, u)
         place = 1 + int((k - 1 + u)*size(drift)/6)
         call next_uniform(random, u)
         jump(place) = sign(step_size, u - 0.5_dp)
      end do
      call fill_of(seed, of_drift, g)
      level = 0.0_dp
      do k = 1, size(world%z)
         level = level + sqrt(walk_q)*g(k) + jump(k)
         drift(k) = level
      end do
      allocate (world%transition(1, 1), source=1.0_dp)
      allocate (world%prior(1, 1), source=unknown)
      allocate (world%q(1), source=walk_q)
      allocate (world%seen(1), source=.true.)
      world%jump = jump**2
   end subroutine make_steps

   !> Outliers on the record without its cubic, and where they are.
   subroutine spoil(name, seed, paper, world)
      character(*), intent(in) :: name
      integer, intent(in) :: seed
      type(simulate_options), intent(in) :: paper
      type(world_type), intent(inout) :: world
      type(random_type) :: random
      type(error_type), allocatable :: error
      real(dp), allocatable :: before(:)
      real(dp) :: u
      integer :: k

      call seed_random(random, int(seed, kind(random%state)), of_outliers)
      select case (name)
      case ("C0a", "C0b")
         before = world%z
         call add_outliers(world%z, paper%outliers, paper%outlier_size, 0.25_dp, random, error)
         if (allocated(error)) error stop error%message
         world%outlier = abs(world%z - before) > 0.0_dp
      case ("C6")
         do k = 1, size(world%z)
            call next_uniform(random, u)
            world%outlier(k) = u < 0.01_dp
            if (.not. world%outlier(k)) cycle
            call next_uniform(random, u)               ! its halves give the signs, the rest 0 .. 1/2 the size
            world%z(k) = world%z(k) + sign(sqrt(white_variance)*(4.0_dp + 32.0_dp*mod(u, 0.5_dp)), u - 0.5_dp)
         end do
      case default                                     ! the others have none
      end select
   end subroutine spoil
end module filter_truth_cases
