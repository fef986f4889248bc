! SPDX-License-Identifier: MIT
!> The JSON document of schema 1, as `doc/schema.json` states it: the contract for programs.
!>
!> Every key is always there; null: not requested, not computed by its stage, or not implemented yet.
module gyroakf_report_document
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, text_type, add_text, view_channel, sample_count
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type, channel_result_type
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null, flush_json
   use gyroakf_report_document_preprocess, only : put_preprocess
   use gyroakf_report_document_parts, only : put_verdict, put_tests, put_ar, put_allan, put_coefficients
   use gyroakf_report_document_filters, only : put_drift, put_filters
   implicit none (type, external)
   private
   public :: write_document, put_document, gather_warnings, schema_number

   !> Keys are never renamed within a schema
   integer, parameter :: schema_number = 1

contains

   !> Writes the whole document.
   subroutine write_document(writer, record, result, command_line)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out; absent: "channels" is empty
      type(pipeline_result_type), intent(in), optional :: result
      !> As it would be typed; absent: "command_line" is null
      character(*), intent(in), optional :: command_line
      type(json_type) :: json

      call put_document(json, writer, record, result, command_line)
      call flush_json(json, writer)
   end subroutine write_document

   !> Makes the whole document.
   subroutine put_document(json, writer, record, result, command_line)
      !> Empty
      type(json_type), intent(inout) :: json
      !> Takes parts of it now and then; where it is not open all of it is in `json` in the end
      type(writer_type), intent(inout) :: writer
      !> As those of [[write_document]]
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in), optional :: result
      character(*), intent(in), optional :: command_line
      type(record_type) :: view
      integer :: c

      call open_object(json)
      call put_member(json, "schema", schema_number)
      call put_member(json, "program", "gyroakf")
      call put_member(json, "version", release_string)
      if (present(command_line)) then
         call put_member(json, "command_line", command_line)
      else
         call put_null(json, "command_line")
      end if
      call put_input(json, record, result)
      call open_array(json, "channels")
      if (present(result)) then
         if (allocated(result%channel)) then
            do c = 1, size(result%channel)
               call view_channel(record, c, view)
               call put_channel(json, writer, view, result%channel(c))
            end do
         end if
      end if
      call close_array(json)
      call close_object(json)
   end subroutine put_document

   !> The member "input".
   subroutine put_input(json, record, result)
      type(json_type), intent(inout) :: json
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in), optional :: result
      type(text_type), allocatable :: warnings(:)

      call gather_warnings(record, warnings, result)
      call open_object(json, "input")
      call put_text_or_null(json, "path", record%path)
      call put_text_or_null(json, "format", record%format)
      call put_member(json, "samples", sample_count(record))
      if (record%rate_known) then
         call put_member(json, "rate_hz", 1.0_dp/record%sample_interval)
      else
         call put_null(json, "rate_hz")
      end if
      call put_text_or_null(json, "rate_source", record%rate_source)
      call put_text_or_null(json, "unit", record%unit%name)
      call put_text_or_null(json, "unit_source", record%unit_source)
      call put_member(json, "channels", record%channel)
      call put_member(json, "missing", record%audit%missing)
      call put_member(json, "gaps", record%audit%gaps)
      call put_member(json, "duplicates", record%audit%duplicates)
      if (record%audit%has_stamps) then
         call put_member(json, "jitter_max_s", record%audit%jitter_max)
      else
         call put_null(json, "jitter_max_s")
      end if
      call put_member(json, "bad_lines", record%audit%bad_lines)
      call put_member(json, "warnings", warnings)
      call gather_warnings(record, warnings, result, notes=.true.)
      call put_member(json, "notes", warnings)
      call put_text_or_null(json, "stored_type", record%stored_type)
      call put_stamps(json, record)
      call close_object(json)
   end subroutine put_input

   !> What the time stamps show beyond gaps; zeros without stamps.
   subroutine put_stamps(json, record)
      type(json_type), intent(inout) :: json
      type(record_type), intent(in) :: record

      associate (audit => record%audit)
         call put_member(json, "backward_steps", audit%backward_steps)
         call put_member(json, "repeated_rows", audit%repeated)
         call put_member(json, "bursts", audit%bursts)
         call put_member(json, "longest_burst", audit%longest_burst)
         call put_member(json, "rate_changes", audit%rate_changes)
         call put_member(json, "rate_change_line", audit%line_of_change)
         call put_member(json, "rate_before_hz", audit%rate_before)
         call put_member(json, "rate_after_hz", audit%rate_after)
         call put_member(json, "rate_first_half_hz", audit%rate_first)
         call put_member(json, "rate_second_half_hz", audit%rate_second)
         call put_member(json, "clock_resolution_s", audit%resolution)
         call put_member(json, "jitter_rms_s", audit%jitter_rms)
         call open_object(json, "resample")
         if (allocated(record%resample)) then
            call put_member(json, "method", record%resample)
         else
            call put_member(json, "method", "index")
         end if
         call put_member(json, "empty_slots", audit%empty_slots)
         call put_member(json, "dropped", audit%dropped)
         call put_member(json, "largest_shift_s", audit%largest_shift)
         call put_member(json, "white_noise_variance", audit%white_noise)
         call close_object(json)
      end associate
   end subroutine put_stamps

   !> One element of "channels".
   subroutine put_channel(json, writer, record, channel)
      type(json_type), intent(inout) :: json
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel

      call open_object(json)
      call put_member(json, "name", channel%name)
      call put_text_or_null(json, "unit", record%unit%name)
      call open_object(json, "raw")
      call put_member(json, "mean", channel%raw%mean)
      call put_member(json, "variance", channel%raw%variance)
      call put_member(json, "std", channel%raw%std)
      call put_member(json, "min", channel%raw%minimum)
      call put_member(json, "max", channel%raw%maximum)
      call close_object(json)
      call put_preprocess(json, channel)
      call put_verdict(json, record, channel)
      call put_tests(json, channel)
      call put_ar(json, channel)
      call put_filters(json, channel)
      call put_drift(json, channel)
      call flush_json(json, writer)
      call put_allan(json, writer, channel)
      call put_coefficients(json, channel)
      call close_object(json)
      call flush_json(json, writer)
   end subroutine put_channel

   !> Warnings of the record, then of the channels, with the channel's name where there are several.
   pure subroutine gather_warnings(record, warnings, result, notes)
      !> What was read
      type(record_type), intent(in) :: record
      !> One sentence each
      type(text_type), allocatable, intent(out) :: warnings(:)
      !> What came out
      type(pipeline_result_type), intent(in), optional :: result
      !> They are the notes instead (default: warnings)
      logical, intent(in), optional :: notes
      logical :: note
      integer :: c

      note = .false.
      if (present(notes)) note = notes
      allocate (warnings(0))
      call add_list(warnings, record%warnings, "", note)
      if (.not. present(result)) return
      if (.not. allocated(result%channel)) return
      do c = 1, size(result%channel)
         call add_list(warnings, result%channel(c)%warnings, result%channel(c)%name//": ", note)
         call add_list(warnings, result%channel(c)%unavailable, result%channel(c)%name//": not available: ", note)
      end do
   end subroutine gather_warnings

   !> Appends the warnings of a list, or its notes, to a list.
   pure subroutine add_list(warnings, list, prefix, note)
      type(text_type), allocatable, intent(inout) :: warnings(:)
      type(text_type), allocatable, intent(in) :: list(:)
      character(*), intent(in) :: prefix
      logical, intent(in) :: note
      integer :: i

      if (.not. allocated(list)) return
      do i = 1, size(list)
         if (list(i)%note .eqv. note) call add_text(warnings, prefix//list(i)%text)
      end do
   end subroutine add_list

   !> A text, null where it is unallocated or empty.
   subroutine put_text_or_null(json, key, text)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      character(:), allocatable, intent(in) :: text

      if (allocated(text)) then
         if (len(text) > 0) then
            call put_member(json, key, text)
            return
         end if
      end if
      call put_null(json, key)
   end subroutine put_text_or_null

end module gyroakf_report_document
