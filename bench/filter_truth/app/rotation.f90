! SPDX-License-Identifier: MIT
!> The share of a true rotation that each filter passes: a step of 1 deg/s, and a sine of 1 deg/s at 0.05 Hz.
!>
!>     ./run.sh rotation [SEEDS]
!>
!> Filters and models know the first half of the record, in which the sensor rests; the rotation fills the second half. The share
!> is what the rotation changes in the output, its mean or the amplitude of its sine, over the last two thirds of it. What a drift
!> filter passes is lost from `compensated` = record - drift. C0b, the paper's noise, has no drift to filter.
program rotation
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf, only : design_akf, design_kf, design_options, dp, drift_filter_type, error_type, filter_options, filter_type, &
      & freeze_filter, new_drift_filter, run_filter
   use gyroakf_kinds, only : int8
   use gyroakf_stats_differences, only : difference_variance
   use filter_truth_cases, only : make_world, sample_interval, samples, world_type
   use filter_truth_figures, only : median, moving_averages, table_head, table_row
   use filter_truth_methods, only : drift_akf_options, prepare, prepared_type
   implicit none (type, external)

   character(3), parameter :: places(2) = ["C0b", "C1 "]
   character(24), parameter :: rows(8) = [character(24) :: "paper KF", "paper AKF", "AKF q, r, Q, R exact", "AKF Q, R exact", &
      & "AKF R, robust", "drift_kf", "drift_akf", "moving average of 25"]
   real(dp), parameter :: turn = 8.0_dp*atan(1.0_dp), frequency = 0.05_dp
   integer, parameter :: half = samples/2
   !> Running, frozen, frozen with the measurements held back
   character(30), parameter :: modes(3) = [character(30) :: "adapting", "frozen", "frozen, no measurements"]
   real(dp), allocatable :: share(:, :, :, :, :)
   character(12) :: cells(4)
   character(20) :: word
   integer :: seeds, s, i, k, m, c

   seeds = 100
   if (command_argument_count() > 0) call get_command_argument(1, word)
   if (command_argument_count() > 0) read (word, *) seeds
   allocate (share(seeds, 2, size(modes), size(rows), size(places)))
   do i = 1, size(places)
      do s = 1, seeds
         call measure(s, i)
      end do
   end do
   write (output_unit, "(i0, a, /)") seeds, " records; median share that the output passes:"
   call table_head("", [character(30) :: "C0b step", "C0b sine", "C1 step", "C1 sine"])
   do k = 1, size(rows)
      do m = 1, size(modes)
         if (m == 2 .and. index(rows(k), "AKF") + index(rows(k), "akf") == 0) cycle
         if (m == 3 .and. index(rows(k), "drift") == 0) cycle
         do c = 1, 4
            cells(c) = "no drift"
            if (index(rows(k), "drift") > 0 .and. c < 3) cycle
            write (cells(c), "(f8.3)") median(share(:, 1 + modulo(c - 1, 2), m, k, 1 + (c - 1)/2))
         end do
         if (index(rows(k), "AKF") + index(rows(k), "akf") + index(rows(k), "drift") == 0) then
            call table_row(rows(k), cells)
         else
            call table_row(trim(rows(k))//", "//modes(m), cells)
         end if
      end do
   end do

contains

   !> All filters on one record.
   subroutine measure(seed, place)
      integer, intent(in) :: seed, place
      type(world_type) :: world
      type(prepared_type) :: rest
      class(filter_type), allocatable :: filter, now
      real(dp), allocatable :: z(:), signal(:), still(:), x(:)
      integer :: k, kind, m, t

      call make_world(trim(places(place)), seed, samples, world)
      z = world%z - world%trend
      where (world%outlier) z = 0.0_dp
      call prepare(z(:half), rest)
      allocate (signal(half), still(half), x(half))
      do k = 1, size(rows)
         if (index(rows(k), "drift") > 0 .and. place == 1) cycle
         if (index(rows(k), "average") == 0) call make_filter(trim(rows(k)), rest, filter)
         if (index(rows(k), "average") == 0) call run_filter(filter, z(:half), x)
         do kind = 1, 2
            signal = 1.0_dp
            if (kind == 2) signal = [(sin(turn*frequency*sample_interval*t), t=1, half)]
            do m = 1, size(modes)
               if (index(rows(k), "average") > 0) then
                  call average_both(z, signal, still, x)
               else
                  now = filter
                  call freeze_filter(now, m > 1)
                  call run_filter(now, z(half + 1:), still)
                  now = filter
                  call freeze_filter(now, m > 1)
                  if (m == 3) then
                     call run_filter(now, spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, half), x)
                     still = x
                  else
                     call run_filter(now, z(half + 1:) + signal, x)
                  end if
               end if
               share(seed, kind, m, k, place) = amplitude(kind, x - still)
            end do
         end do
      end do
   end subroutine measure

   !> How much of the rotation stands in the change of the output, over its last two thirds: the mean, or the amplitude of the sine.
   real(dp) function amplitude(kind, change)
      integer, intent(in) :: kind
      real(dp), intent(in) :: change(:)
      real(dp) :: angle
      complex(dp) :: total
      integer :: t

      if (kind == 1) then
         amplitude = sum(change(half/3 + 1:))/(half - half/3)
         return
      end if
      total = 0.0_dp
      do t = half/3 + 1, half                              ! 40 whole periods
         angle = turn*frequency*sample_interval*t
         total = total + change(t)*cmplx(cos(angle), sin(angle), dp)
      end do
      amplitude = 2.0_dp*abs(total)/(half - half/3)
   end function amplitude

   !> The moving average at rest and rotating.
   subroutine average_both(z, signal, still, x)
      real(dp), intent(in), contiguous :: z(:), signal(:)
      real(dp), intent(out), contiguous :: still(:), x(:)
      real(dp), allocatable :: both(:), causal(:), centered(:)
      integer(int8), allocatable :: here(:)

      allocate (causal(samples), centered(samples))
      allocate (here(samples), source=1_int8)
      call moving_averages(z, here, 25, causal, centered)
      still = causal(half + 1:)
      both = z
      both(half + 1:) = both(half + 1:) + signal
      call moving_averages(both, here, 25, causal, centered)
      x = causal(half + 1:)
   end subroutine average_both

   !> A filter made at rest.
   subroutine make_filter(name, rest, filter)
      character(*), intent(in) :: name
      type(prepared_type), intent(in) :: rest
      class(filter_type), allocatable, intent(out) :: filter
      type(filter_type) :: of_series
      type(drift_filter_type) :: of_drift
      type(error_type), allocatable :: error
      type(design_options) :: design
      type(filter_options) :: options
      real(dp) :: differences

      differences = difference_variance(rest%cleaned, rest%here)
      select case (name)
      case ("paper KF"); call design_kf(rest%ar, design, of_series, error)
      case ("paper AKF"); call design_akf(rest%ar, differences, design, of_series, error)
      case ("AKF q, r, Q, R exact", "AKF Q, R exact"); call make_exact(name, rest, differences, of_series, error)
      case ("AKF R, robust")
         design%akf = "robust"
         call design_akf(rest%ar, differences, design, of_series, error)
      case default
         if (name == "drift_akf") options = drift_akf_options(rest)
         associate (model => rest%drift%model)
            call new_drift_filter(of_drift, model, rest%drift%slow(:model%count), options, error)
         end associate
      end select
      if (allocated(error)) error stop error%message
      if (index(name, "drift") > 0) then
         allocate (filter, source=of_drift)
      else
         allocate (filter, source=of_series)
      end if
   end subroutine make_filter

   !> Sage-Husa in the exact form, within the usual bounds.
   subroutine make_exact(name, rest, differences, filter, error)
      use gyroakf, only : new_filter
      character(*), intent(in) :: name
      type(prepared_type), intent(in) :: rest
      real(dp), intent(in) :: differences
      type(filter_type), intent(out) :: filter
      type(error_type), allocatable, intent(out) :: error
      type(filter_options) :: options

      options%estimate_process_mean = index(name, "q,") > 0
      options%estimate_measurement_mean = options%estimate_process_mean
      options%allow_unobservable = .true.
      options%estimate_process_variance = .true.
      options%estimate_measurement_variance = .true.
      options%measurement_form = "exact"
      options%r_scale = 0.5_dp*differences
      call new_filter(filter, rest%ar%coefficient, rest%ar%noise_variance, rest%ar%variance, options, error)
   end subroutine make_exact
end program rotation
