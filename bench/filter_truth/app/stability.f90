! SPDX-License-Identifier: MIT
!> How the adaptive filters bear wrong priors: runs that fail (S <= 0 or a number that is none), and runs that collapse.
!>
!>     ./run.sh stability [SEEDS [SAMPLES [ONE_IN [scalar|order|drift|SET]]]]         SET: a set of q, r, Q, R, as qrQR
!>
!> Q0, R0 and P0 are 1e-3, 0.1, 10 and 1000 times the right ones, never right: 64 priors; b is 0.95, 0.98, 0.995, 0.999. Every form
!> with every set of q, r, Q, R, without and with Huber's gate at 2.5. ONE_IN = m: each seed meets only every m-th combination.
program stability
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: iso_fortran_env, only : int64, output_unit
   use gyroakf, only : ar_model_type, ar_options, component_model_type, dp, drift_filter_type, error_type, filter_options, &
      & filter_type, fit_ar, new_drift_filter, new_filter, run_filter
   use gyroakf_stats_differences, only : difference_variance
   use filter_truth_cases, only : make_world, world_type
   use filter_truth_figures, only : table_head, table_row
   implicit none (type, external)

   real(dp), parameter :: wrong(4) = [1.0e-3_dp, 0.1_dp, 10.0_dp, 1000.0_dp], memory(4) = [0.95_dp, 0.98_dp, 0.995_dp, 0.999_dp]
   character(3), parameter :: places(4) = ["C0a", "C1 ", "C4 ", "C5 "]
   character(8), parameter :: forms(4) = [character(8) :: "residual", "exact", "biased", "paper"]
   character(4), parameter :: sets(15) = [character(4) :: "q", "r", "qr", "Q", "qQ", "rQ", "qrQ", &
      & "R", "qR", "rR", "QR", "qrR", "qQR", "rQR", "qrQR"]
   !> Mean gain of the last third below which a filter has collapsed; output over input beyond which it has gone astray
   real(dp), parameter :: collapsed = 1.0e-3_dp, astray = 2.0_dp

   !> What a series is filtered with: the right priors
   type :: prior_type
      real(dp), allocatable :: z(:), phi(:)
      real(dp) :: q = 0, r = 0, p = 0, r_scale = 0, variance = 0
   end type prior_type

   !> Counts of runs
   type :: count_type
      integer(int64) :: runs = 0, failed = 0, collapsed = 0, astray = 0
   end type count_type

   type(prior_type), allocatable :: known(:)
   integer :: seeds, samples, one_in, p
   character(20) :: word
   character(8) :: part

   seeds = 100
   samples = 3000
   one_in = 1
   if (command_argument_count() > 0) call get_command_argument(1, word)
   if (command_argument_count() > 0) read (word, *) seeds
   if (command_argument_count() > 1) call get_command_argument(2, word)
   if (command_argument_count() > 1) read (word, *) samples
   if (command_argument_count() > 2) call get_command_argument(3, word)
   if (command_argument_count() > 2) read (word, *) one_in
   part = "all"
   if (command_argument_count() > 3) call get_command_argument(4, part)
   write (output_unit, "(5(i0, a))") seeds, " seeds, ", size(wrong)**3, " priors, ", size(memory), " values of b, one in ", &
      & one_in, " of these, records of ", samples, " samples."
   if (part == "all" .or. part == "scalar" .or. any(sets == part)) call sweep_scalar()
   if (part == "all" .or. part == "order") then
      write (output_unit, "(/, a, /)") "AR(p) as Yule and Walker fit it to C3, the right R0 taken as Var(z):"
      call table_head("p, adapted, form", [character(24) :: "runs", "failed", "collapsed, %", "astray, %"])
      do p = 1, 6
         call sweep_order(p)
      end do
   end if
   if (part == "all" .or. part == "drift") call sweep_drift()

contains

   !> One coefficient: every variant.
   subroutine sweep_scalar()
      type(count_type) :: counts(2, size(places)), total
      character(24) :: cells(6)
      integer :: f, i, k, gate

      write (output_unit, "(/, 2a, /)") "One coefficient. In each column the share of runs, in %, that collapse (mean gain of ", &
         & "the last third below 0.001), without and with the gate; astray: Var(output) > 2 Var(input)."
      call table_head("adapted, form", [character(24) :: "runs", "failed", (trim(places(k))//" collapsed", k=1, size(places)), &
                                        "astray"])
      do i = 1, size(sets)
         if (any(sets == part) .and. sets(i) /= part) cycle
         do f = 1, size(forms)
            if (f > 1 .and. index(sets(i), "R") == 0) exit
            counts = count_type()
            do k = 1, size(places)
               call take_records(places(k))
               do gate = 1, 2
                  call sweep(sets(i), forms(f), merge(2.5_dp, 0.0_dp, gate == 2), counts(gate, k))
               end do
            end do
            total%runs = sum(counts%runs)
            total%failed = sum(counts%failed)
            write (cells(1), "(i0)") total%runs
            write (cells(2), "(i0)") total%failed
            do k = 1, size(places)
               cells(2 + k) = trim(number(percent(counts(1, k)%collapsed, counts(1, k)%runs)))//" / "// &
                  & number(percent(counts(2, k)%collapsed, counts(2, k)%runs))
            end do
            call table_row(trim(sets(i))//merge(" "//forms(f), repeat(" ", 9), index(sets(i), "R") > 0), &
                           [cells, number(percent(sum(counts%astray), total%runs))])
         end do
      end do
   end subroutine sweep_scalar

   !> The drift filters: R adapted, one or two processes.
   subroutine sweep_drift()
      character(8), parameter :: models(2) = [character(8) :: "one", "walk+ar1"]
      type(count_type) :: counts(2, size(places)), total
      character(24) :: cells(6)
      integer :: f, gate, k, m

      write (output_unit, "(/, a, /)") "Drift filters, R adapted; the process of the case alone, or an AR(1) and a random walk:"
      call table_head("processes, form", [character(24) :: "runs", "failed", (trim(places(k))//" collapsed", k=1, size(places)), &
                                          "astray"])
      do m = 1, size(models)
         do f = 1, 3
            counts = count_type()
            do k = 1, size(places)
               call take_records(places(k))
               do gate = 1, 2
                  call sweep("R", forms(f), merge(2.5_dp, 0.0_dp, gate == 2), counts(gate, k), models(m))
               end do
            end do
            total%runs = sum(counts%runs)
            total%failed = sum(counts%failed)
            write (cells(1), "(i0)") total%runs
            write (cells(2), "(i0)") total%failed
            do k = 1, size(places)
               cells(2 + k) = trim(number(percent(counts(1, k)%collapsed, counts(1, k)%runs)))//" / "// &
                  & number(percent(counts(2, k)%collapsed, counts(2, k)%runs))
            end do
            call table_row(trim(models(m))//", "//forms(f), [cells, number(percent(sum(counts%astray), total%runs))])
         end do
      end do
   end subroutine sweep_drift

   !> The AR(p) filter of some variants.
   subroutine sweep_order(order)
      integer, intent(in) :: order
      character(8), parameter :: variant(2, 6) = reshape([character(8) :: "R", "residual", "R", "exact", "QR", "exact", &
         & "QR", "paper", "qrQR", "exact", "qrQR", "paper"], [2, 6])
      type(count_type) :: counts
      character(24) :: cells(4)
      character(1) :: digit
      integer :: i, gate

      call take_records("C3", order)
      do i = 1, size(variant, 2)
         counts = count_type()
         do gate = 1, 2
            call sweep(trim(variant(1, i)), variant(2, i), merge(2.5_dp, 0.0_dp, gate == 2), counts)
         end do
         write (digit, "(i1)") order
         write (cells(1), "(i0)") counts%runs
         write (cells(2), "(i0)") counts%failed
         cells(3) = number(percent(counts%collapsed, counts%runs))
         cells(4) = number(percent(counts%astray, counts%runs))
         call table_row(digit//", "//trim(variant(1, i))//", "//trim(variant(2, i)), cells)
      end do
   end subroutine sweep_order

   !> Records of a case, and what is right for them.
   subroutine take_records(place, order)
      character(*), intent(in) :: place
      !> Of the AR model that is fitted
      integer, intent(in), optional :: order
      type(world_type) :: world
      type(ar_model_type) :: model
      type(error_type), allocatable :: error
      character(3), save :: now = ""
      integer :: s

      if (place == now .and. .not. present(order)) return
      now = place
      if (allocated(known)) deallocate (known)
      allocate (known(seeds))
      do s = 1, seeds
         call make_world(place, s, samples, world)
         associate (here => known(s))
            here%z = world%z - sum(world%z)/samples
            here%variance = sum(here%z**2)/(samples - 1)
            here%r_scale = 0.5_dp*difference_variance(here%z)
            here%phi = world%transition(1, :)
            here%q = world%q(1)
            here%r = world%r(1)
            here%p = 100.0_dp*here%variance
            if (abs(here%phi(1)) < 1.0_dp) here%p = world%prior(1, 1)
            if (here%r <= 0.0_dp) here%r = world%prior(1, 1)
            if (present(order)) then
               call fit_ar(here%z, ar_options(order=order, max_order=order), model, error)
               if (allocated(error)) error stop error%message
               here%phi = model%coefficient
               here%q = model%noise_variance
               here%r = model%variance
               here%p = model%variance
            end if
         end associate
      end do
   end subroutine take_records

   !> All priors and memories, in the records at hand.
   subroutine sweep(letters, form, huber, counts, drift)
      character(*), intent(in) :: letters, form
      real(dp), intent(in) :: huber
      type(count_type), intent(inout) :: counts
      !> A drift filter of these processes; absent: the filter of the AR state
      character(*), intent(in), optional :: drift
      type(filter_options) :: options
      real(dp) :: factor(3)
      integer :: b, prior, s

      options%estimate_process_mean = index(letters, "q") > 0
      options%estimate_measurement_mean = index(letters, "r") > 0
      options%estimate_process_variance = index(letters, "Q") > 0
      options%estimate_measurement_variance = index(letters, "R") > 0
      options%allow_unobservable = .true.
      options%measurement_form = form
      options%huber = huber
      do s = 1, seeds
         do prior = 0, size(wrong)**3 - 1
            factor = wrong(1 + [modulo(prior, 4), modulo(prior/4, 4), prior/16])
            do b = 1, size(memory)
               if (modulo(s + prior + b, one_in) /= 0) cycle
               options%forgetting = memory(b)
               call run_one(known(s), factor, options, counts, drift)
            end do
         end do
      end do
   end subroutine sweep

   !> One run.
   subroutine run_one(known, factor, options, counts, drift)
      type(prior_type), intent(in) :: known
      !> On Q0, R0, P0
      real(dp), intent(in) :: factor(3)
      type(filter_options), intent(in) :: options
      type(count_type), intent(inout) :: counts
      character(*), intent(in), optional :: drift
      type(filter_options) :: here
      type(filter_type) :: of_series
      type(drift_filter_type) :: of_drift
      class(filter_type), allocatable :: filter
      type(error_type), allocatable :: error
      real(dp), allocatable, save :: x(:), e(:)
      real(dp) :: mean
      integer :: third

      if (.not. allocated(x)) allocate (x(samples), e(samples))
      here = options
      here%r_scale = known%r_scale
      here%initial_variance = factor(3)*known%p
      counts%runs = counts%runs + 1
      if (present(drift)) then
         call new_drift_filter(of_drift, drift_model(known, factor, drift), spread(.true., 1, merge(1, 2, drift == "one")), here, &
                               error)
         allocate (filter, source=of_drift)
      else
         call new_filter(of_series, known%phi, factor(1)*known%q, factor(2)*known%r, here, error)
         allocate (filter, source=of_series)
      end if
      if (allocated(error)) error stop error%message
      third = samples - samples/3
      call run_filter(filter, known%z(:third), x(:third), normalized_innovation=e(:third))
      filter%gain_sum = 0.0_dp
      filter%gain_measurements = 0
      call run_filter(filter, known%z(third + 1:), x(third + 1:), normalized_innovation=e(third + 1:))
      if (.not. (all(ieee_is_finite(x)) .and. all(ieee_is_finite(e)))) then
         counts%failed = counts%failed + 1
         return
      end if
      if (filter%gain_sum(1) < collapsed*real(filter%gain_measurements, dp)) counts%collapsed = counts%collapsed + 1
      mean = sum(x)/samples
      if (sum((x - mean)**2) > astray*known%variance*samples) counts%astray = counts%astray + 1
   end subroutine run_one

   !> The process of the case, or an AR(1) and a random walk, with wrong variances.
   pure type(component_model_type) function drift_model(known, factor, drift) result(model)
      type(prior_type), intent(in) :: known
      real(dp), intent(in) :: factor(3)
      character(*), intent(in) :: drift

      model%count = 1
      model%phi(1) = known%phi(1)
      model%q(1) = factor(1)*known%q
      model%r = factor(2)*known%r
      if (drift == "one") return
      model%count = 2
      model%phi(1) = min(model%phi(1), 0.98_dp)
      model%phi(2) = 1.0_dp
      model%q(2) = 0.1_dp*model%q(1)
   end function drift_model

   !> Hundredths.
   pure real(dp) function percent(part, whole)
      integer(int64), intent(in) :: part, whole

      percent = 100.0_dp*real(part, dp)/real(max(1_int64, whole), dp)
   end function percent

   !> A number, at most 100, with a decimal, and a zero before it where there is nothing else.
   character(24) function number(value)
      real(dp), intent(in) :: value

      write (number, "(f5.1)") value
      number = adjustl(number)
   end function number
end program stability
