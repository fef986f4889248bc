! SPDX-License-Identifier: MIT
!> Progress is told, and a caller who cancels gets the error.
module test_progress
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong, check_refused
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : paper_preset, paper_seed, simulate_options, simulate_record
   implicit none (type, external)
   private
   public :: suite_progress

   !> Notes what it is told, and cancels when all is done
   type, extends(progress_type) :: witness_type
      character(:), allocatable :: stage
      integer(int64) :: calls = 0, done = -1, total = -1
   contains
      procedure :: advance => note
   end type witness_type

   !> Cancels at one of its calls
   type, extends(progress_type) :: quitter_type
      integer :: calls = 0, last = huge(1)
      !> Every call was in the range of its total
      logical :: in_range = .true.
      !> The last one
      character(:), allocatable :: stage
   contains
      procedure :: advance => quit
   end type quitter_type

contains

   subroutine suite_progress()
      call test("told_and_cancelled", told_and_cancelled)
      call test("nobody_listens", nobody_listens)
      call test("job_is_the_same", job_is_the_same)
      call test("job_is_cancelled", job_is_cancelled)
      call test("channels_are_named", channels_are_named)
   end subroutine suite_progress

   subroutine note(self, stage, done, total, cancel)
      class(witness_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      self%stage = stage
      self%calls = self%calls + 1
      self%done = done
      self%total = total
      cancel = done == total
   end subroutine note

   subroutine told_and_cancelled()
      type(witness_type) :: witness

      call report_progress("reading", 3_int64, 4_int64, failed, witness)
      if (went_wrong(failed, "nobody cancelled")) return
      call report_progress("reading", 4_int64, 4_int64, failed, witness)
      call check_refused(failed, status%cancelled)
      call check(error, failed%message, "cancelled while reading")
      call check(error, witness%stage == "reading" .and. witness%calls == 2 .and. witness%done == 4 .and. witness%total == 4)
   end subroutine told_and_cancelled

   subroutine nobody_listens()
      call report_progress("reading", 4_int64, 4_int64, failed)
      call check(error, .not. allocated(failed))
   end subroutine nobody_listens

   subroutine quit(self, stage, done, total, cancel)
      class(quitter_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      self%calls = self%calls + 1
      self%stage = stage
      self%in_range = self%in_range .and. len(stage) > 0 .and. done >= 0 .and. (done <= total .or. total == 0)
      cancel = self%calls >= self%last
   end subroutine quit

   !> Whoever looks on changes nothing.
   subroutine job_is_the_same()
      type(record_type) :: record
      type(pipeline_result_type) :: alone, watched
      type(quitter_type) :: quitter

      call simulate_record(paper_preset(paper_seed), record, failed)
      call run_pipeline(record, pipeline_options(), alone, failed)
      call run_pipeline(record, pipeline_options(), watched, failed, quitter)
      if (went_wrong(failed)) return
      call check(error, quitter%calls >= 12, "every stage is told")
      call check(error, quitter%in_range, "more is done than there is")
      call check(error, all(abs(alone%channel(1)%allan(5)%curve%deviation - watched%channel(1)%allan(5)%curve%deviation) <= 0.0_dp))
   end subroutine job_is_the_same

   !> A stage names its channel where there are several.
   subroutine channels_are_named()
      type(record_type) :: one, record
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(quitter_type) :: quitter

      call simulate_record(paper_preset(paper_seed), one, failed)
      record = one
      deallocate (record%value, record%channel)
      allocate (record%value(size(one%value, 1), 2), record%channel(2))
      record%value(:, 1) = one%value(:, 1)
      record%value(:, 2) = one%value(:, 1)
      record%channel(1)%text = "gx"
      record%channel(2)%text = "gy"
      options%do_allan = .false.
      call run_pipeline(record, options, result, failed, quitter)
      call check(error, .not. allocated(failed) .and. quitter%stage == "smoothing gy", quitter%stage)
   end subroutine channels_are_named

   !> At whichever call.
   subroutine job_is_cancelled()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(quitter_type) :: quitter
      integer :: last

      call simulate_record(paper_preset(paper_seed), record, failed)
      do last = 1, 12
         quitter%calls = 0
         quitter%last = last
         call run_pipeline(record, pipeline_options(), result, failed, quitter)
         if (unmet(allocated(failed), "the cancellation is lost")) return
         call check(error, failed%code == status%cancelled .and. quitter%calls == last, "it goes on after the cancellation")
      end do
   end subroutine job_is_cancelled

end module test_progress
