! SPDX-License-Identifier: MIT
!> Warnings, what is not available, and notes of a whole result; one entry for all channels it
!> applies to.
module gyroakf_report_remarks
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_text_layout, only : fixed, if_known, plural, put_item
   implicit none (type, external)
   private
   public :: put_remarks

   !> Kinds of remarks in their order
   character(13), parameter :: warning = "Warning", missing = "Not available", note = "Note"
   character(13), parameter :: kinds(3) = [warning, missing, note]

   !> One sentence
   type :: remark_type
      character(13) :: kind = warning
      character(:), allocatable :: text
      !> Of its channels; "" for the record
      character(:), allocatable :: names
   end type remark_type

contains

   !> Warnings first, then what is not available, then the notes.
   subroutine put_remarks(writer, command, record, result, most_notes)
      type(writer_type), intent(inout) :: writer
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      !> Further ones are counted (default: all are shown)
      integer, intent(in), optional :: most_notes
      type(remark_type), allocatable :: remark(:)
      character(:), allocatable :: names, text
      integer :: i, kind, count, most

      most = huge(most)
      if (present(most_notes)) most = most_notes
      allocate (remark(0))
      if (command == "run" .or. command == "filter") then
         associate (channel => result%channel, n => size(result%channel))
            text = passed("KF", [(channel(i)%kf_figures%passed_percent, i=1, n)], &
                          [(channel(i)%available%kf, i=1, n)])// &
                   passed("AKF", [(channel(i)%akf_figures%passed_percent, i=1, n)], &
                          [(channel(i)%available%akf, i=1, n)])
         end associate
         if (text /= "") call add_remark(note, "the paper's filters pass a constant "// &
            "rotation in part (DC gain: "//text(3:)//"): their outputs are no input for "// &
            "navigation", "")
      end if
      call add_list(record%warnings, warning, "", "")
      do i = 1, size(result%channel)
         associate (channel => result%channel(i))
            call add_list(channel%warnings, warning, channel%name, "")
            call add_list(channel%drift_kf%warnings, warning, channel%name, "drift KF: ")
            call add_list(channel%drift_akf%warnings, warning, channel%name, "drift AKF: ")
            call add_list(channel%unavailable, missing, channel%name, "")
         end associate
      end do
      do kind = 1, size(kinds)
         count = 0
         do i = 1, size(remark)
            if (remark(i)%kind /= kinds(kind)) cycle
            count = count + 1
            if (remark(i)%kind == note .and. count > most) cycle
            names = if_known(size(result%channel) > 1 .and. remark(i)%names /= "", &
                             remark(i)%names//": ")
            call put_item(writer, trim(remark(i)%kind), names//remark(i)%text, verbatim=.true.)
         end do
      end do
      if (count > most) call put_item(writer, "", &                ! the notes are the last kind
         plural(int(count - most, int64), "further note")//": --details")

   contains

      !> The texts of a list; one that is there already gets the name.
      subroutine add_list(list, kind, name, prefix)
         type(text_type), intent(in), optional :: list(:)
         !> Of what is no note
         character(13), intent(in) :: kind
         character(*), intent(in) :: name, prefix
         integer :: k

         if (.not. present(list)) return
         do k = 1, size(list)
            call add_remark(merge(note, kind, list(k)%note), prefix//list(k)%text, name)
         end do
      end subroutine add_list

      !> One remark.
      subroutine add_remark(kind, text, name)
         character(13), intent(in) :: kind
         character(*), intent(in) :: text, name
         type(remark_type), allocatable :: longer(:)
         integer :: k

         do k = 1, size(remark)
            if (remark(k)%kind /= kind .or. remark(k)%text /= text) cycle
            remark(k)%names = remark(k)%names//", "//name
            return
         end do
         allocate (longer(size(remark) + 1))               ! an array constructor loses the texts
         longer(:size(remark)) = remark
         longer(size(longer)) = remark_type(kind, text, name)
         call move_alloc(longer, remark)
      end subroutine add_remark

   end subroutine put_remarks

   !> ", KF 61 %", ", AKF 17 to 50 %"; "" where no channel has the filter.
   pure function passed(name, percent, available) result(text)
      character(*), intent(in) :: name
      !> [channel]
      real(dp), intent(in) :: percent(:)
      logical, intent(in) :: available(:)
      character(:), allocatable :: text

      text = ""
      if (.not. any(available)) return
      text = fixed(minval(percent, available), 0)
      if (fixed(maxval(percent, available), 0) /= text) then
         text = text//" to "//fixed(maxval(percent, available), 0)
      end if
      text = ", "//name//" "//text//" %"
   end function passed

end module gyroakf_report_remarks
