! SPDX-License-Identifier: MIT
!> The JSON document of schema 1, as `doc/schema.json` states it: the contract for programs.
!>
!> Every key is always there; null: not requested, not computed by its stage, or not implemented
!> yet.
module gyroakf_report_document
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, text_type, add_text, view_channel, sample_count
   use gyroakf_units, only : quantity
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type, channel_result_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_json, only : json_type
   use gyroakf_report_document_distribution, only : put_preprocess
   use gyroakf_report_document_allan, only : put_allan, put_coefficients
   use gyroakf_report_document_tests, only : put_ar, put_tests, put_verdict
   use gyroakf_report_document_filters, only : put_drift, put_filters
   implicit none (type, external)
   private
   public :: write_document, put_document, gather_warnings

contains

   !> Writes the whole document.
   subroutine write_document(writer, record, result, command_line)
      !> Open
      type(writer_type), intent(inout), target :: writer
      type(record_type), intent(in) :: record
      !> What came out; absent: "channels" is empty
      type(pipeline_result_type), intent(in), optional :: result
      !> As it would be typed; absent: "command_line" is null
      character(*), intent(in), optional :: command_line
      type(json_type) :: json

      json%writer => writer
      call put_document(json, record, result, command_line)
   end subroutine write_document

   !> Makes the whole document.
   subroutine put_document(out, record, result, command_line)
      !> The renderer, empty
      class(description_type), intent(inout) :: out
      !> As those of [[write_document]]
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in), optional :: result
      character(*), intent(in), optional :: command_line
      type(record_type) :: view
      integer :: c

      call out%open("")
      call out%put("schema", 1)               ! keys are never renamed within a schema
      call out%put("program", "gyroakf")
      call out%put("version", release_string)
      call out%put("command_line", command_line)
      call put_input(out, record, result)
      call out%open("channels", list=.true.)
      do c = 1, channels_of(result)
         call view_channel(record, c, view)
         call put_channel(out, view, result%channel(c))
      end do
      call out%close()
      call out%close()
   end subroutine put_document

   !> The member "input".
   subroutine put_input(out, record, result)
      class(description_type), intent(inout) :: out
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in), optional :: result
      type(text_type), allocatable :: warnings(:)

      call gather_warnings(record, warnings, result)
      call out%open("input")
      call out%put("path", record%path)
      call out%put("format", record%format)
      call out%put("samples", sample_count(record))
      call out%put("rate_hz", 1.0_dp/record%sample_interval, record%rate_known)
      call out%put("rate_source", record%rate_source)
      call out%put("unit", record%unit%name, record%unit%quantity /= quantity%unknown)
      call out%put("unit_source", record%unit_source)
      call out%put("channels", record%channel)
      call out%put("missing", record%audit%missing)
      call out%put("gaps", record%audit%gaps)
      call out%put("duplicates", record%audit%duplicates)
      call out%put("jitter_max_s", record%audit%jitter_max, record%audit%has_stamps)
      call out%put("bad_lines", record%audit%bad_lines)
      call out%put("warnings", warnings)
      call gather_warnings(record, warnings, result, notes=.true.)
      call out%put("notes", warnings)
      call out%put("stored_type", record%stored_type)
      associate (audit => record%audit)
         call out%put("backward_steps", audit%backward_steps)
         call out%put("repeated_rows", audit%repeated)
         call out%put("bursts", audit%bursts)
         call out%put("longest_burst", audit%longest_burst)
         call out%put("rate_changes", audit%rate_changes)
         call out%put("rate_change_line", audit%line_of_change)
         call out%put("rate_before_hz", audit%rate_before)
         call out%put("rate_after_hz", audit%rate_after)
         call out%put("rate_first_half_hz", audit%rate_first)
         call out%put("rate_second_half_hz", audit%rate_second)
         call out%put("clock_resolution_s", audit%resolution)
         call out%put("jitter_rms_s", audit%jitter_rms)
         call out%open("resample")
         if (allocated(record%resample)) call out%put("method", record%resample)
         if (.not. allocated(record%resample)) call out%put("method", "index")
         call out%put("empty_slots", audit%empty_slots)
         call out%put("dropped", audit%dropped)
         call out%put("largest_shift_s", audit%largest_shift)
         call out%put("white_noise_variance", audit%white_noise)
         call out%close()
      end associate
      call out%close()
   end subroutine put_input

   !> One element of "channels".
   subroutine put_channel(out, record, channel)
      class(description_type), intent(inout) :: out
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel

      call out%open("")
      call out%put("name", channel%name)
      call out%put("unit", record%unit%name, record%unit%quantity /= quantity%unknown)
      call out%open("raw")
      call out%put("mean", channel%raw%mean)
      call out%put("variance", channel%raw%variance)
      call out%put("std", channel%raw%std)
      call out%put("min", channel%raw%minimum)
      call out%put("max", channel%raw%maximum)
      call out%close()
      call put_preprocess(out, channel)
      call put_verdict(out, record, channel)
      call put_tests(out, channel)
      call put_ar(out, channel)
      call put_filters(out, channel)
      call put_drift(out, channel)
      call put_allan(out, channel)
      call put_coefficients(out, channel)
      call out%close()
   end subroutine put_channel

   !> How many channels came out.
   pure integer function channels_of(result)
      type(pipeline_result_type), intent(in), optional :: result

      channels_of = 0
      if (.not. present(result)) return
      if (allocated(result%channel)) channels_of = size(result%channel)
   end function channels_of

   !> Warnings of the record, then of the channels, with the name of the channel.
   subroutine gather_warnings(record, warnings, result, notes)
      type(record_type), intent(in) :: record
      !> One sentence each
      type(text_type), allocatable, intent(out) :: warnings(:)
      type(pipeline_result_type), intent(in), optional :: result
      !> Present: they are the notes instead
      logical, intent(in), optional :: notes
      integer :: c

      allocate (warnings(0))
      call add_list(record%warnings, "")
      do c = 1, channels_of(result)
         associate (channel => result%channel(c))
            call add_list(channel%warnings, channel%name//": ")
            call add_list(channel%unavailable, channel%name//": not available: ")
         end associate
      end do

   contains

      subroutine add_list(list, prefix)
         type(text_type), intent(in), optional :: list(:)
         character(*), intent(in) :: prefix
         integer :: i

         if (.not. present(list)) return
         do i = 1, size(list)
            if (list(i)%note .eqv. present(notes)) call add_text(warnings, prefix//list(i)%text)
         end do
      end subroutine add_list

   end subroutine gather_warnings

end module gyroakf_report_document
