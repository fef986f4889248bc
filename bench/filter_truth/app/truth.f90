! SPDX-License-Identifier: MIT
!> The filters beside the truth: error over the oracle's, moving averages of any length, whiteness of the innovations.
!>
!>     ./run.sh truth [SEEDS]
program truth
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf, only : dp
   use filter_truth_cases, only : case_names, make_world, samples, world_type
   use filter_truth_figures, only : median, moving_averages, quantile, root_mean_square, table_head, table_row
   use filter_truth_methods, only : is_causal, is_filter, judged_type, method_names, methods, prepare, prepared_type, run_method
   use filter_truth_oracle, only : ask_oracle
   implicit none (type, external)

   integer, parameter :: cases = size(case_names)
   !> Lengths of the moving averages: 1 to a quarter of the record, each 1.15 times the one before
   integer, parameter :: most_lengths = 80
   !> Cases whose oracle has an error that one may be compared with
   integer, parameter :: first_compared = 3
   !> Autocorrelation of the innovations that a good model does not leave
   real(dp), parameter :: colored = 0.1_dp

   real(dp), allocatable :: error(:, :, :), oracle(:, :, :), average(:, :, :, :)
   type(judged_type), allocatable :: judged(:, :, :)
   integer :: length(most_lengths), lengths, seeds, c, s
   character(20) :: word

   seeds = 100
   if (command_argument_count() > 0) call get_command_argument(1, word)
   if (command_argument_count() > 0) read (word, *) seeds
   call choose_lengths()
   allocate (error(seeds, cases, methods), oracle(seeds, cases, 2), average(seeds, cases, lengths, 2))
   allocate (judged(seeds, cases, methods))
   !$omp parallel do schedule(dynamic) collapse(2)
   do s = 1, seeds
      do c = 1, cases
         call measure(s, c)
      end do
   end do
   !$omp end parallel do
   write (output_unit, "(i0, a, i0, a)") seeds, " records of ", samples, " samples for each case."
   call show_errors()
   call show_ratios()
   call show_averages()
   call show_innovations()

contains

   !> Geometric, integers, none twice.
   subroutine choose_lengths()
      integer :: next

      lengths = 0
      next = 1
      do while (next <= samples/4)
         lengths = lengths + 1
         length(lengths) = next
         next = max(next + 1, nint(1.15_dp*next))
      end do
   end subroutine choose_lengths

   !> All methods on a record.
   subroutine measure(seed, place)
      integer, intent(in) :: seed, place
      type(world_type) :: world
      type(prepared_type) :: record
      real(dp), allocatable :: x(:), y(:)
      integer :: k

      allocate (x(samples), y(samples))
      call make_world(trim(case_names(place)), seed, samples, world)
      call ask_oracle(world, x, y)
      oracle(seed, place, 1) = root_mean_square(x, world%truth)
      oracle(seed, place, 2) = root_mean_square(y, world%truth)
      call prepare(world%z, record)
      do k = 1, methods
         call run_method(k, record, x, judged(seed, place, k))
         error(seed, place, k) = root_mean_square(x, world%truth)
      end do
      do k = 1, lengths
         call moving_averages(world%z, record%here, length(k), x, y)
         average(seed, place, k, 1) = root_mean_square(x, world%truth)
         average(seed, place, k, 2) = root_mean_square(y, world%truth)
      end do
   end subroutine measure

   !> Errors in 1e-3 deg/s.
   subroutine show_errors()
      character(12) :: cells(cases)
      integer :: k, place, side

      write (output_unit, "(/, a, /)") "Median RMSE to the true drift, 1e-3 deg/s:"
      call table_head("", case_names)
      do side = 1, 2
         do k = 1, methods
            if (is_causal(k) .neqv. side == 1) cycle
            do place = 1, cases
               cells(place) = decimal(1.0e3_dp*median(error(:, place, k)), 2)
            end do
            call table_row(method_names(k), cells)
         end do
         do place = 1, cases
            k = best_length(place, side)
            cells(place) = decimal(1.0e3_dp*median(average(:, place, k, side)), 2)
         end do
         call table_row(trim(merge("best causal moving average  ", "best centered moving average", side == 1)), cells)
         do place = 1, cases
            cells(place) = decimal(1.0e3_dp*median(oracle(:, place, side)), 2)
         end do
         call table_row(merge("oracle, filter  ", "oracle, smoother", side == 1), cells)
      end do
   end subroutine show_errors

   !> Errors over the oracle's.
   subroutine show_ratios()
      character(24) :: cells(first_compared:cases)
      real(dp), allocatable :: ratio(:)
      integer :: k, place, side

      write (output_unit, "(/, a, /)") "RMSE over the oracle's (filters over its filter, the others over its smoother), median " &
         //"[95 % of the records are below]:"
      call table_head("", case_names(first_compared:))
      do k = 1, methods
         side = merge(1, 2, is_causal(k))
         do place = first_compared, cases
            ratio = error(:, place, k)/oracle(:, place, side)
            cells(place) = trim(decimal(median(ratio), 3))//" ["//trim(decimal(quantile(ratio, 0.95_dp), 2))//"]"
         end do
         call table_row(method_names(k), cells)
      end do
   end subroutine show_ratios

   !> Lengths of the best moving averages, and whether the filters beat them and the cubic.
   subroutine show_averages()
      character(12) :: cells(cases)
      real(dp) :: least, cubic
      integer :: k, place, side, trend

      trend = findloc(method_names, "cubic trend", 1)
      write (output_unit, "(/, a, /)") "Median RMSE over that of the best moving average (of any length) or the cubic, whichever " &
         //"is less; the length of that average in samples:"
      call table_head("", case_names)
      do side = 1, 2
         do place = 1, cases
            write (cells(place), "(i0)") length(best_length(place, side))
         end do
         call table_row(trim(merge("length of the causal average  ", "length of the centered average", side == 1)), cells)
         do k = 1, methods
            if ((is_causal(k) .neqv. side == 1) .or. k == trend) cycle
            do place = 1, cases
               cubic = median(error(:, place, trend))
               least = min(cubic, median(average(:, place, best_length(place, side), side)))
               cells(place) = decimal(median(error(:, place, k))/least, 2)
            end do
            call table_row(method_names(k), cells)
         end do
      end do
   end subroutine show_averages

   !> NIS and whiteness.
   subroutine show_innovations()
      character(24) :: cells(cases)
      real(dp) :: rho
      integer :: k, place

      write (output_unit, "(/, a, f4.2, a, /)") "Innovations: mean NIS; largest |rho| within 20 lags, **not white** above ", &
         & colored, "; p of Ljung and Box in brackets (medians):"
      call table_head("", case_names)
      do k = 1, methods
         if (.not. is_filter(k)) cycle
         do place = 1, cases
            cells(place) = "no drift"
            if (median(judged(:, place, k)%nis) <= 0.0_dp) cycle
            rho = median(judged(:, place, k)%rho)
            cells(place) = trim(decimal(median(judged(:, place, k)%nis), 2))//"; "// &
               & trim(merge("**", "  ", rho > colored))//trim(decimal(rho, 3))//trim(merge("**", "  ", rho > colored))// &
               & " ("//trim(probability(median(judged(:, place, k)%p_value)))//")"
         end do
         call table_row(method_names(k), cells)
      end do
   end subroutine show_innovations

   !> The length of the least median error.
   integer function best_length(place, side)
      integer, intent(in) :: place, side
      real(dp) :: found(lengths)
      integer :: k

      do k = 1, lengths
         found(k) = median(average(:, place, k, side))
      end do
      best_length = minloc(found, 1)
   end function best_length

   !> A number with so many decimals.
   character(12) function decimal(value, digits)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      character(12) :: form

      write (form, "(a, i0, a)") "(f12.", digits, ")"
      write (decimal, form) value
      decimal = adjustl(decimal)
   end function decimal

   !> A probability, as far as one wants to know it.
   character(12) function probability(value)
      real(dp), intent(in) :: value

      probability = "<0.001"
      if (value >= 0.001_dp) probability = decimal(value, 3)
   end function probability
end program truth
