! SPDX-License-Identifier: MIT
!> The audit of time stamps: what is a gap and what is not.
module test_audit
   use expectations, only : unmet, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_io_audit, only : audit_stamps, gap_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_left_out_rows, only : leave_rows_out, place_with
   use gyroakf_io_reader, only : reader_options
   use gyroakf_io_standstill, only : find_still
   use gyroakf_record, only : audit_type, record_type
   use scratch_file, only : read_content
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   implicit none (type, external)
   private
   public :: suite_audit

   !> Samples of the series
   integer, parameter :: n = 4000
   !> Their interval, s
   real(dp), parameter :: dt = 0.01_dp

   !> Of the last audit, which then found nothing
   type(gyro_error), allocatable :: failed

contains

   subroutine suite_audit()
      call test("even", test_even)
      call test("jitter", test_jitter)
      call test("late-delivery", test_late)
      call test("gaps", test_gaps)
      call test("bursts", test_bursts)
      call test("bursts-with-loss", test_burst_loss)
      call test("coarse-clock", test_coarse)
      call test("clock-beat", test_beat)
      call test("duplicates", test_duplicates)
      call test("clock-set-back", test_set_back)
      call test("clock-set-forward", test_set_forward)
      call test("missing-stamps", test_missing_stamps)
      call test("gap-in-a-file", test_gap_in_file)
      call test("repeated-rows-and-gap", test_repeated_rows)
      call test("lines", test_lines)
      call test("still", test_still)
   end subroutine suite_audit

   !> Even stamps.
   function even() result(t)
      real(dp) :: t(n)
      integer :: i

      t = [(dt*(i - 1), i=1, n)]
   end function even

   !> Noise in -1 to 1, the same in every run.
   real(dp) function noise(i)
      integer, intent(in) :: i

      noise = 2.0_dp*modulo(real(i, dp)*0.6180339887498949_dp + real(i, dp)**2*0.3819660112501051_dp, 1.0_dp) - 1.0_dp
   end function noise

   !> Stamps of samples that are handed over ten at a time, up to 0.4 s late now and then.
   function bursts() result(t)
      real(dp) :: t(n)
      integer :: i, group

      do i = 1, n
         group = (i + 9)/10
         t(i) = 0.1_dp*group + 0.001_dp*mod(i - 1, 10) + 0.003_dp*noise(group)
         if (mod(group, 37) < 4 .and. group > 37) t(i) = 0.1_dp*(37*(group/37) + 4) + 0.001_dp*mod(i - 1, 10) &
                                                         + 0.012_dp*mod(group, 37)
      end do
   end function bursts

   !> Audits; the rate has to be 100 Hz within a relative difference.
   subroutine expect(t, gaps_expected, lost, tolerance, audit)
      real(dp), intent(inout), contiguous :: t(:)
      integer, intent(in) :: gaps_expected, lost
      real(dp), intent(in) :: tolerance
      type(audit_type), intent(out) :: audit
      type(gap_type) :: gaps

      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count, gaps_expected, more="gaps")
      call check(error, int(sum(gaps%length(:gaps%count))), lost, more="lost")
      call check(error, audit%stamp_rate, 1.0_dp/dt, thr=tolerance, rel=.true., more="rate")
   end subroutine expect

   subroutine test_even()
      type(audit_type) :: audit
      real(dp) :: t(n)

      t = even()
      call expect(t, 0, 0, 1.0e-13_dp, audit)
      call check(error, audit%jitter_max < 1.0e-12_dp .and. audit%duplicates == 0 .and. audit%backward_steps == 0, "even")
   end subroutine test_even

   !> Up to 45 % of the interval; the ends of the record say the rate to 0.9/n.
   subroutine test_jitter()
      type(audit_type) :: audit
      real(dp) :: t(n)
      integer :: i

      t = even() + 0.45_dp*dt*[(noise(i), i=1, n)]
      call expect(t, 0, 0, 1.0_dp/n, audit)
      call check(error, audit%jitter_max > 0.4_dp*dt .and. audit%jitter_max < 1.5_dp*dt, "jitter")
   end subroutine test_jitter

   !> Eight samples that arrive together, after the last of them was due.
   subroutine test_late()
      type(audit_type) :: audit
      real(dp) :: t(n)
      integer :: k

      t = even()
      do k = 1, 5
         t(700*k:700*k + 7) = t(700*k + 7) + 1.0e-4_dp*[0, 1, 2, 3, 4, 5, 6, 7]
      end do
      call expect(t, 0, 0, 1.0e-13_dp, audit)
      call check(error, audit%jitter_max, 7*dt, thr=1.0e-10_dp)
   end subroutine test_late

   !> Losses at about even distances. With jitter the steps there are longer or shorter, and what is
   !> lost is rounded, not cut; at 45 % no single step shows a loss, but the level of the lag. One
   !> in twenty lost leaves fewer than 97 % of the steps even.
   subroutine test_gaps()
      real(dp), parameter :: jitter(5) = [0.2_dp, 0.2_dp, 0.45_dp, 0.05_dp, 0.0_dp]
      integer, parameter :: gaps(5) = [1, 8, 4, 79, 199], distance(5) = [1000, 430, 900, 50, 20]
      integer, parameter :: length(5) = [5, 5, 5, 1, 1], period(5) = [1, 1, 1, 40, 17]
      type(audit_type) :: audit
      real(dp) :: t(n)
      integer :: i, k, first

      do i = 1, size(gaps)
         t = even() + jitter(i)*dt*[(noise(k), k=1, n)]
         do k = 1, gaps(i)
            first = distance(i)*k + mod(7*k, period(i))
            t(first:) = t(first:) + length(i)*dt
         end do
         call expect(t, gaps(i), gaps(i)*length(i), merge(1.0_dp/n, 1.0e-12_dp, jitter(i) > 0), &
            & audit)
         if (i == 1) call check(error, audit%line_of_first(3), 1000_int64)
      end do
   end subroutine test_gaps

   !> The record may end with a burst that is 0.4 s late.
   subroutine test_bursts()
      type(audit_type) :: audit
      real(dp) :: t(n)

      t = bursts()
      call expect(t, 0, 0, 0.4_dp/(n*dt), audit)
      call check(error, audit%jitter_max > 0.1_dp, "jitter")
   end subroutine test_bursts

   !> Three seconds lost between bursts: 300 samples, up to the ten of a burst.
   subroutine test_burst_loss()
      type(audit_type) :: audit
      type(gap_type) :: gaps
      real(dp) :: t(n)

      t = bursts()
      t(2001:) = t(2001:) + 3.0_dp
      call audit_stamps(t, audit, gaps, failed)
      call check(error, gaps%count, 1)
      call check(error, abs(gaps%length(1) - 300_int64) <= 10 .and. gaps%before(1) == 2001, &
                 "lost "//format_real(real(gaps%length(1), dp), 9))
      call check(error, audit%stamp_rate, 100.0_dp, thr=0.01_dp, rel=.true.)
   end subroutine test_burst_loss

   !> A clock of 15.6 ms at 100 Hz: equal stamps, no gap.
   subroutine test_coarse()
      type(audit_type) :: audit
      real(dp) :: t(n)

      t = aint(even()/0.0156_dp)*0.0156_dp
      call expect(t, 0, 0, 2.0_dp/n, audit)
      call check(error, audit%duplicates > n/4, "duplicates")
   end subroutine test_coarse

   !> A clock that counts in nearly the sample interval: a step of two now and then is its beat with the samples, no loss.
   subroutine test_beat()
      type(audit_type) :: audit
      real(dp), parameter :: clock(3) = [0.00953_dp, 0.0099_dp, 0.00999_dp]
      real(dp) :: t(n)
      integer :: i

      do i = 1, 3
         t = anint(even()/clock(i))*clock(i)
         call expect(t, 0, 0, 1.0_dp/n, audit)
         t = aint(even()/(2*dt - clock(i)))*(2*dt - clock(i))
         call expect(t, 0, 0, 1.0_dp/n, audit)
      end do
   end subroutine test_beat

   subroutine test_duplicates()
      type(audit_type) :: audit
      real(dp) :: t(n)

      t = even()
      t(500) = t(499)
      t(900) = t(899) - 0.3_dp*dt
      call expect(t, 0, 0, 1.0e-13_dp, audit)
      call check(error, audit%duplicates == 1 .and. audit%backward_steps == 1, "counts")
      call check(error, all(audit%line_of_first == [500_int64, 900_int64, 0_int64]), "places")
   end subroutine test_duplicates

   !> A counter that starts anew: the record goes on by one sample.
   subroutine test_set_back()
      type(audit_type) :: audit
      real(dp) :: t(n)

      t = even()
      t(2001:) = t(2001:) - t(2001)
      call expect(t, 0, 0, 1.0e-12_dp, audit)
      call check(error, audit%backward_steps, 1_int64)
   end subroutine test_set_back

   !> Fifty years are not filled with samples.
   subroutine test_set_forward()
      type(audit_type) :: audit
      real(dp) :: t(n)

      t = even()
      t(2001:) = t(2001:) + 1.6e9_dp
      call expect(t, 0, 0, 1.0e-6_dp, audit)
      call check(error, audit%gaps, 1_int64)
   end subroutine test_set_forward

   !> Rows without a time fill the places that are free between their neighbors, and are left out elsewhere; no stamp is invented.
   subroutine test_missing_stamps()
      type(audit_type) :: audit
      type(gyro_error), allocatable :: failed
      real(dp), allocatable :: t(:), value(:, :)
      integer(int64), allocatable :: dropped(:)
      integer(int64) :: i

      t = even()
      allocate (value(n, 1))
      value(:, 1) = [(real(i, dp), i=1, n)]
      t([1, 2, 100, 101, 102, n]) = ieee_value(1.0_dp, ieee_quiet_nan)
      t(500:) = t(500:) - dt
      t(500) = ieee_value(1.0_dp, ieee_quiet_nan)
      call leave_rows_out(t, value, audit, dropped, failed)
      if (unmet(.not. allocated(failed) .and. audit%untimed == 4 .and. audit%line_of_untimed == 1, "counts")) return
      if (unmet(all(dropped == [1, 2, 500, n]) .and. size(t) == n - 4 .and. size(value, 1) == n - 4, "rows")) return
      call check(error, place_with(dropped, 498_int64, 1_int64), 501_int64)
      call expect(t, 0, 0, 1.0e-12_dp, audit)
      call check(error, audit%duplicates + audit%backward_steps, 0_int64)
   end subroutine test_missing_stamps

   !> The samples that were lost get their place.
   subroutine test_gap_in_file()
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      character(16*100) :: content
      integer :: i

      do i = 1, 100
         write (content(16*i - 15:16*i), "(f8.2, i7, a)") 0.01_dp*merge(i, i + 3, i <= 60), i, new_line("a")
      end do
      call read_content("t gx"//new_line("a")//content, "gap.txt", reader_options(), record, failed)
      call check(error, record%audit%samples == 103 .and. record%audit%missing == 3 .and. record%audit%gaps == 1, "counts")
      call check(error, all(record%present(61:63, 1) == 0) .and. sum(int(record%present)) == 100, "marks")
      call check(error, abs(record%value(60, 1) - 60) <= 0.0_dp .and. abs(record%value(64, 1) - 61) <= 0.0_dp, "values")
      call check(error, record%audit%line_of_first(3), 62_int64)
   end subroutine test_gap_in_file

   !> Rows written twice are left out, and a gap behind them stays where it is.
   subroutine test_repeated_rows()
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      character(16*402) :: content
      integer :: i, row

      row = 0
      do i = 1, 400
         row = row + 1
         write (content(16*row - 15:16*row), "(f8.2, i7, a)") 0.01_dp*merge(i, i + 3, i <= 200), i, new_line("a")
         if (mod(i, 90) /= 0 .or. i > 180) cycle
         row = row + 1
         content(16*row - 15:16*row) = content(16*row - 31:16*row - 16)
      end do
      call read_content("t gx"//new_line("a")//content, "repeated.txt", reader_options(), record, &
         & failed)
      if (went_wrong(failed, "read")) return
      call check(error, record%audit%repeated == 2 .and. record%audit%missing == 3 .and. record%audit%gaps == 1, "counts")
      call check(error, all(record%present(201:203, 1) == 0) .and. sum(int(record%present)) == 400, "marks")
      call check(error, abs(record%value(200, 1) - 200) <= 0.0_dp .and. abs(record%value(204, 1) - 201) <= 0.0_dp, "values")
      call check(error, record%audit%line_of_first(3), 204_int64)
   end subroutine test_repeated_rows

   !> Lines are counted with header, comments and blank lines.
   subroutine test_lines()
      type(record_type) :: record
      type(gyro_error), allocatable :: failed
      character(1), parameter :: nl = new_line("a")

      call read_content("# c"//nl//"t_s gx"//nl//"0 1"//nl//nl//"1 1"//nl//"# d"//nl//"# e"//nl// &
                       "1 2"//nl//"2 3"//nl//"1.5 4"//nl, "lines.txt", reader_options(), record, &
                          & failed)
      call check(error, all(record%audit%line_of_first == [8_int64, 10_int64, 0_int64]), "lines")
   end subroutine test_lines

   !> A stretch without a change is found at the end and within; not where a coarse or slow sensor
   !> repeats its values, where one channel goes on, where samples are missing, or nothing changes.
   subroutine test_still()
      real(dp) :: value(n, 2)
      integer(int8), allocatable :: marks(:, :)
      integer :: i

      value = reshape([(noise(i), i=1, 2*n)], [n, 2])
      call check(error, place_of(value, marks), 0_int64)
      value(n - 199:, :) = 0
      call check(error, place_of(value, marks), n - 199_int64)
      allocate (marks(n, 2), source=1_int8)
      marks(n - 199:, :) = 0
      call check(error, place_of(value, marks), 0_int64, more="missing")
      deallocate (marks)
      value(n - 199:, 2) = [(noise(i), i=1, 200)]
      call check(error, place_of(value, marks), 0_int64, more="one channel")
      value(1001:1019, :) = 0.5_dp
      call check(error, place_of(value, marks), 0_int64, more="short")
      value(1001:1200, :) = 0.5_dp
      call check(error, place_of(value, marks), 1001_int64, more="within")
      value(2001:2120, :) = 0.25_dp
      call check(error, place_of(value, marks), 0_int64, more="twice")
      value(:, 1) = anint([(noise(i), i=1, n)])
      call check(error, place_of(value(:, :1), marks), 0_int64, more="coarse")
      value(:, 1) = [(real(i/100, dp), i=1, n)]
      call check(error, place_of(value(:, :1), marks), 0_int64, more="slow")
      value = 1
      call check(error, place_of(value, marks), 0_int64, more="constant")
   end subroutine test_still

   !> First sample of the stretch, 0 where there is none.
   integer(int64) function place_of(value, marks)
      real(dp), intent(in), contiguous :: value(:, :)
      integer(int8), allocatable, intent(in) :: marks(:, :)
      integer(int64) :: still(2)

      call find_still(value, marks, still)
      place_of = still(1)
   end function place_of

end module test_audit
