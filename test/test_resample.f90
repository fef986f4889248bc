! SPDX-License-Identifier: MIT
!> Samples put on the grid by their stamps.
module test_resample
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_io_resample, only : resample
   use gyroakf_record, only : record_type
   use scratch_file, only : remove_file, scratch_path, write_bytes
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   implicit none (type, external)
   private
   public :: suite_resample

   !> Interval of the grid, s
   real(dp), parameter :: dt = 0.01_dp

contains

   subroutine suite_resample()
      call test("nearest-jitter", test_nearest_jitter)
      call test("nearest-gap-twice", test_nearest_gap)
      call test("linear-exact", test_linear)
      call test("linear-gap-twice", test_linear_gap)
      call test("linear-missing", test_linear_missing)
      call test("linear-noise", test_linear_noise)
      call test("linear-finer", test_linear_finer)
      call test("linear-wrap", test_linear_wrap)
      call test("even", test_even)
      call test("file", test_file)
      call test("refused", test_refused)
   end subroutine suite_resample

   !> A record of one channel with a grid.
   function made(x) result(record)
      real(dp), intent(in) :: x(:)
      type(record_type) :: record

      allocate (record%value(size(x), 1))
      record%value(:, 1) = x
      record%sample_interval = dt
      record%audit%stamp_rate = 1.0_dp/dt
   end function made

   !> From -1 to 1, the same in every run.
   elemental real(dp) function noise(i)
      integer, intent(in) :: i

      noise = 2.0_dp*modulo(real(i, dp)*0.6180339887498949_dp + real(i, dp)**2*0.3819660112501051_dp, 1.0_dp) - 1.0_dp
   end function noise

   !> Every sample finds its own slot, though the first stamp is late by a third of a step.
   subroutine test_nearest_jitter()
      type(record_type) :: record
      real(dp) :: x(1000), t(1000)
      integer :: i

      x = [(real(i, dp), i=1, 1000)]
      t = [(dt*(i - 1) + 0.4_dp*dt*noise(i), i=1, 1000)]
      t(1) = 0.4_dp*dt
      record = made(x)
      call resample(t, "nearest", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      if (unmet(size(record%value), 1000)) return
      call check(error, all(abs(record%value(:, 1) - x) <= 0.0_dp), "a value moved")
      call check(error, record%audit%empty_slots + record%audit%dropped, 0_int64)
      call check(error, record%audit%largest_shift, 0.4_dp*dt, thr=0.05_dp*dt)
   end subroutine test_nearest_jitter

   !> Three slots without a sample are missing; the second sample of a slot is dropped.
   subroutine test_nearest_gap()
      type(record_type) :: record
      real(dp), parameter :: t(7) = dt*[0.0_dp, 1.1_dp, 1.3_dp, 2.0_dp, 6.05_dp, 7.0_dp, 7.9_dp]
      real(dp), parameter :: expected(9) = [1.0_dp, 2.0_dp, 4.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 5.0_dp, 6.0_dp, 7.0_dp]
      integer :: i

      record = made([(real(i, dp), i=1, 7)])
      call resample(t, "nearest", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      if (unmet(size(record%value), 9)) return
      call check(error, all(ieee_is_nan(record%value(4:6, 1))), "the empty slots are not missing")
      where (ieee_is_nan(record%value)) record%value = 0.0_dp
      call check(error, all(abs(record%value(:, 1) - expected) <= 0.0_dp), "a value is on a wrong slot")
      call check(error, record%audit%empty_slots, 3_int64)
      call check(error, record%audit%dropped, 1_int64)
   end subroutine test_nearest_gap

   !> A straight line stays one whatever the jitter.
   subroutine test_linear()
      type(record_type) :: record
      real(dp) :: t(1000)
      integer :: i

      t = [(dt*(i - 1) + 0.2_dp*dt*noise(i), i=1, 1000)]
      t(1000) = dt*999 + t(1)
      record = made(3.0_dp + 2.0_dp*(t - t(1)))
      call resample(t, "linear", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      if (unmet(size(record%value), 1000)) return
      call check(error, maxval(abs(record%value(:, 1) - [(3.0_dp + 2.0_dp*dt*(i - 1), i=1, 1000)])) < 1.0e-12_dp, "no line")
      call check(error, record%audit%empty_slots + record%audit%dropped, 0_int64)
   end subroutine test_linear

   !> Within an interval of more than 1.5 steps nothing is interpolated; equal and earlier stamps are dropped.
   subroutine test_linear_gap()
      type(record_type) :: record
      real(dp), parameter :: t(8) = dt*[0.0_dp, 1.5_dp, 1.5_dp, 2.5_dp, 2.25_dp, 5.0_dp, 6.0_dp, 7.0_dp]
      integer :: i

      record = made([(real(i, dp), i=1, 8)])
      call resample(t, "linear", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      if (unmet(size(record%value), 8)) return
      call check(error, all(ieee_is_nan(record%value(4:5, 1))), "a long interval is filled")
      call check(error, maxval(abs(record%value([1, 2, 3, 6, 7, 8], 1) - [1.0_dp, 1 + 2.0_dp/3, 3.0_dp, 6.0_dp, 7.0_dp, 8.0_dp])) &
                 < 1.0e-12_dp, "a value is wrong")
      call check(error, record%audit%empty_slots, 2_int64)
      call check(error, record%audit%dropped, 2_int64)
      call check(error, record%audit%white_noise, (5 + 5.0_dp/9 + 0.5_dp - 1)/6, thr=1.0e-12_dp)
   end subroutine test_linear_gap

   !> A missing sample makes those that need it missing.
   subroutine test_linear_missing()
      type(record_type) :: record
      integer :: i

      record = made([1.0_dp, 2.0_dp, ieee_value(1.0_dp, ieee_quiet_nan), 4.0_dp, 5.0_dp])
      call resample(dt*[0.0_dp, 1.0_dp, 2.25_dp, 3.0_dp, 4.0_dp], "linear", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      call check(error, all(ieee_is_nan(record%value(:, 1)) .eqv. [(i == 3, i=1, 5)]), "not only the third is missing")
   end subroutine test_linear_missing

   !> Phases that sweep from 0 to 1: 2/3 of the variance of white noise remains.
   subroutine test_linear_noise()
      type(record_type) :: record
      integer, parameter :: n = 20000
      real(dp) :: low, high
      integer :: i

      record = made([(noise(i), i=1, n)])
      record%value = record%value - sum(record%value)/n
      low = sum(record%value**2)/n
      call resample([(dt*(i - 1)*(1.0_dp + 1.0_dp/(n - 1)), i=1, n)], "linear", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      high = sum(record%value**2)/size(record%value)
      call check(error, record%audit%white_noise, 2.0_dp/3, thr=1.0e-3_dp)
      call check(error, high/low, 2.0_dp/3, thr=0.02_dp)
      call check(error, index(record%warnings(1)%text, "keeps 0.667 of its variance") > 0, record%warnings(1)%text)
   end subroutine test_linear_noise

   !> A rate that is higher than the samples' interpolates as well.
   subroutine test_linear_finer()
      type(record_type) :: record
      integer :: i

      record = made([(real(i, dp), i=1, 5)])
      record%audit%stamp_rate = 0.25_dp/dt
      call resample([(4*dt*(i - 1), i=1, 5)], "linear", 0.0_dp, record, failed)
      if (went_wrong(failed)) return
      call check(error, maxval(abs(record%value(:, 1) - [(1 + 0.25_dp*(i - 1), i=1, 17)])) < 1.0e-12_dp)
   end subroutine test_linear_finer

   !> Angles that begin again are interpolated the short way.
   subroutine test_linear_wrap()
      type(record_type) :: record

      record = made([359.0_dp, 1.0_dp, 3.0_dp])
      call resample(dt*[0.0_dp, 1.25_dp, 2.0_dp], "linear", 360.0_dp, record, failed)
      if (went_wrong(failed)) return
      call check(error, record%value(2, 1), 359.0_dp + 0.8_dp*2, thr=1.0e-9_dp)
   end subroutine test_linear_wrap

   !> Even stamps change nothing, to the last bit.
   subroutine test_even()
      type(record_type) :: record
      character(7), parameter :: way(2) = ["nearest", "linear "]
      integer :: i, k

      do k = 1, 2
         record = made([(noise(i), i=1, 5000)])
         call resample([(dt*(i - 1), i=1, 5000)], trim(way(k)), 0.0_dp, record, failed)
         if (went_wrong(failed)) return
         if (unmet(size(record%value), 5000)) return
         call check(error, all(abs(record%value(:, 1) - [(noise(i), i=1, 5000)]) <= 0.0_dp), way(k))
         if (unmet(.not. allocated(record%warnings), way(k))) return
      end do
   end subroutine test_even

   !> Reads a text.
   subroutine read_text(content, options, record, failed)
      character(*), intent(in) :: content
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(gyro_error), allocatable, intent(out) :: failed

      call write_bytes(scratch_path("resample.txt"), content)
      call read_record(scratch_path("resample.txt"), options, record, failed)
      call remove_file(scratch_path("resample.txt"))
   end subroutine read_text

   !> Through the reader: a repeated row goes, an empty slot is missing, the rate is the one that was given.
   subroutine test_file()
      type(record_type) :: record
      character(*), parameter :: nl = new_line("a")
      character(*), parameter :: rows = "t,gx"//nl//"0,1"//nl//"0.1,2"//nl//"0.1,2"//nl//"0.2,3"//nl//"0.4,5"//nl//"0.5,7"//nl

      call read_text(rows, reader_options(resample="nearest", rate_hz=10.0_dp), record, failed)
      if (went_wrong(failed)) return
      if (unmet(size(record%value), 6)) return
      call check(error, all(nint(record%value(:, 1)) == [1, 2, 3, 0, 5, 7]))
      call check(error, all(record%present(:, 1) == [1, 1, 1, 0, 1, 1]))
      call check(error, record%audit%repeated, 1_int64)
      call check(error, record%resample, "nearest")
      call read_text(rows, reader_options(resample="linear", rate_hz=20.0_dp), record, failed)
      if (went_wrong(failed)) return
      if (unmet(size(record%value), 11)) return
      call check(error, record%value(2, 1), 1.5_dp, thr=1.0e-12_dp)
   end subroutine test_file

   !> What cannot be resampled.
   subroutine test_refused()
      type(record_type) :: record
      character(*), parameter :: nl = new_line("a")
      character(*), parameter :: rows = "time_s,gx"//nl//"0,1"//nl//"0.1,2"//nl//"0.2,3"//nl//"0.4,5"//nl

      call read_text("1"//nl//"2"//nl//"3"//nl, reader_options(resample="linear", rate_hz=1.0_dp), record, failed)
      call check_message("`resample` linear needs time stamps", status%invalid_argument)
      call read_text("t,x"//nl//"1,2"//nl//"1,3"//nl, reader_options(resample="nearest", rate_hz=1.0_dp), record, failed)
      call check_message("needs time stamps that rise", status%invalid_argument)
      call read_text(rows, reader_options(resample="linear", input="increment", unit="rad"), record, failed)
      call check_message("would not keep the angle", status%invalid_argument)
      call read_text(rows, reader_options(resample="cubic"), record, failed)
      call check_message("known are index, nearest, linear", status%not_supported)
      call read_text(rows, reader_options(resample="nearest", rate_hz=1.0e7_dp), record, failed)
      call check_message("does not fit the time stamps", status%invalid_argument)
   contains
      subroutine check_message(text, code)
         character(*), intent(in) :: text
         integer, intent(in) :: code

         if (unmet(allocated(failed), text)) return
         call check(error, index(failed%message, text) > 0, failed%message)
         call check(error, failed%code, code)
      end subroutine check_message

   end subroutine test_refused

end module test_resample
