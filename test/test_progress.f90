! SPDX-License-Identifier: MIT
!> Progress is reported, and a caller that cancels gets the error; the line that shows it.
module test_progress
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong, &
      & check_refused
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_progress, only : report_progress
   use progress_watch, only : watch_type
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : paper_preset, paper_seed, simulate_options, &
      & simulate_record
   use gyroakf_progress_text, only : amount_text, duration_text, progress_line
   implicit none (type, external)
   private
   public :: suite_progress, suite_progress_text

contains

   subroutine suite_progress()
      call test("reported_and_cancelled", reported_and_cancelled)
      call test("no_callback", no_callback)
      call test("job_is_the_same", job_is_the_same)
      call test("job_is_cancelled", job_is_cancelled)
      call test("channels_are_named", channels_are_named)
   end subroutine suite_progress

   subroutine suite_progress_text()
      call test("known_total", known_total)
      call test("unknown_total", unknown_total)
      call test("files_are_counted", files_are_counted)
      call test("narrow_terminals", narrow_terminals)
      call test("odd_numbers", odd_numbers)
      call test("amounts", amounts)
      call test("durations", durations)
   end subroutine suite_progress_text

   subroutine reported_and_cancelled()
      type(watch_type) :: watch

      watch%last_call = 2
      call report_progress("reading", 3_int64, 4_int64, failed, watch)
      if (went_wrong(failed, "not cancelled")) return
      call report_progress("reading", 4_int64, 4_int64, failed, watch)
      call check_refused(failed, status%cancelled)
      call check(error, failed%message, "cancelled while reading")
      call check(error, watch%stage == "reading" .and. watch%calls == 2 .and. watch%done == 4 .and. &
         & watch%total == 4)
   end subroutine reported_and_cancelled

   subroutine no_callback()
      call report_progress("reading", 4_int64, 4_int64, failed)
      call check(error, .not. allocated(failed))
   end subroutine no_callback

   !> A callback changes no result.
   subroutine job_is_the_same()
      type(record_type) :: record
      type(pipeline_result_type) :: alone, watched
      type(watch_type) :: watch

      call simulate_record(paper_preset(paper_seed), record, failed)
      call run_pipeline(record, pipeline_options(), alone, failed)
      call run_pipeline(record, pipeline_options(), watched, failed, watch)
      if (went_wrong(failed)) return
      call check(error, watch%calls >= 12, "every stage is reported")
      call check(error, watch%in_range, "more is done than there is")
      call check(error, all(abs(alone%channel(1)%allan(5)%curve%deviation - watched%channel(1)%allan(5)%curve%deviation) <= 0.0_dp))
   end subroutine job_is_the_same

   !> A stage names its channel where there are several.
   subroutine channels_are_named()
      type(record_type) :: one, record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(watch_type) :: watch

      call simulate_record(paper_preset(paper_seed), one, failed)
      record = one
      deallocate (record%value, record%channel)
      allocate (record%value(size(one%value, 1), 2), record%channel(2))
      record%value(:, 1) = one%value(:, 1)
      record%value(:, 2) = one%value(:, 1)
      record%channel(1)%text = "gx"
      record%channel(2)%text = "gy"
      options%do_allan = .false.
      call run_pipeline(record, options, result, failed, watch)
      call check(error, .not. allocated(failed) .and. watch%stage == "smoothing gy", watch%stage)
   end subroutine channels_are_named

   !> At whichever call.
   subroutine job_is_cancelled()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(watch_type) :: watch
      integer :: last

      call simulate_record(paper_preset(paper_seed), record, failed)
      do last = 1, 12
         watch%calls = 0
         watch%last_call = last
         call run_pipeline(record, pipeline_options(), result, failed, watch)
         if (unmet(allocated(failed), "the cancellation is lost")) return
         call check(error, failed%code == status%cancelled .and. watch%calls == last, &
            & "it goes on after the cancellation")
      end do
   end subroutine job_is_cancelled

   subroutine known_total()
      call check(error, progress_line("reading", 250000000_int64, 1000000000_int64, 1.0_dp, 79), &
                 "reading  [#####...............]   25 %  250 MB/s  0:03 left")
      call check(error, progress_line("filtering", 0_int64, 1000_int64, 0.0_dp, 79), &
                 "filtering  [....................]    0 %")
      call check(error, progress_line("filtering", 1000_int64, 1000_int64, 2.0_dp, 79), &
                 "filtering  [####################]  100 %  500 samples/s  0:00 left")
   end subroutine known_total

   subroutine unknown_total()
      call check(error, progress_line("reading", 1234567890_int64, 0_int64, 4.0_dp, 79), "reading  1.23 GB  309 MB/s")
      call check(error, progress_line("completing the record", 0_int64, 0_int64, 4.0_dp, 79), "completing the record")
   end subroutine unknown_total

   subroutine files_are_counted()
      call check(error, progress_line("files", 12_int64, 300_int64, 6.0_dp, 79), &
                 "files  [....................]    4 %  12 of 300  2 files/s  2:24 left")
   end subroutine files_are_counted

   subroutine narrow_terminals()
      call check(error, progress_line("reading", 1_int64, 2_int64, 1.0_dp, 40), "reading   50 %  1 B/s  0:01 left")
      call check(error, progress_line("reading", 1_int64, 2_int64, 1.0_dp, 10), "reading   ")
      call check(error, len(progress_line(repeat("x", 200), 1_int64, 2_int64, 1.0_dp, 79)), 79)
   end subroutine narrow_terminals

   subroutine odd_numbers()
      call check(error, progress_line("reading", 30_int64, 20_int64, 1.0_dp, 50), "reading  100 %  30 B/s  0:00 left", &
                 "a file that grew")
      call check(error, progress_line("reading", -5_int64, 20_int64, 1.0_dp, 50), "reading    0 %", "less than nothing")
      call check(error, len(progress_line("files", huge(1_int64), huge(1_int64), 1.0e-3_dp, 79)) <= 79, "the largest numbers")
   end subroutine odd_numbers

   subroutine amounts()
      call check(error, amount_text(999.0_dp, "B"), "999 B")
      call check(error, amount_text(999.6_dp, "B"), "1.00 kB")
      call check(error, amount_text(12345.0_dp, "samples"), "12.3 ksamples")
      call check(error, amount_text(9.996e6_dp, "samples"), "10.0 Msamples")
      call check(error, amount_text(123.4e6_dp, "B"), "123 MB")
      call check(error, amount_text(0.25_dp, "files"), "0.25 files")
      call check(error, amount_text(1.0e30_dp, "B"), "1000000000 PB", "no overflow")
   end subroutine amounts

   subroutine durations()
      call check(error, duration_text(0.0_dp), "0:00")
      call check(error, duration_text(6.1_dp), "0:07", "rounded up")
      call check(error, duration_text(754.0_dp), "12:34")
      call check(error, duration_text(3723.0_dp), "1:02:03")
      call check(error, duration_text(1.0e12_dp), "> 99 h")
   end subroutine durations

end module test_progress
