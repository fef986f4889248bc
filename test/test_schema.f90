! SPDX-License-Identifier: MIT
!> doc/schema.json is what the descriptions of the results say.
module test_schema
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_report_document, only : put_document
   use json_reader, only : file_text, read_json
   use report_fixture, only : fill_drift, make_record, make_result
   use schema_writer, only : schema_type, write_schema
   implicit none (type, external)
   private
   public :: suite_schema

contains

   subroutine suite_schema()
      call test("document", test_document)
      call test("small", test_small)
   end subroutine suite_schema

   !> Documents in which everything is known, nothing is, and there are no channels; one with what is not allocated.
   subroutine test_document()
      type(schema_type) :: out
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text, wrong
      logical :: valid
      integer :: unit

      call read_json(file_text("doc/schema.json"), out%old, valid)
      call check(error, valid, "doc/schema.json is read from the root of the repository")
      call make_record(record, .true.)
      call make_result(record, result)
      call fill_drift(record, result%channel(1))
      deallocate (result%channel(1)%clean%trend%power)
      call put_document(out, record, result)
      result%channel(1)%clean%trend%power = [0.0_dp]
      record%stored_type = "float64"
      associate (channel => result%channel(1))
         channel%clean%half_width = 1
         channel%clean%motion = reshape([1, 2], [2, 1])
         channel%adf%lag_chosen = .true.
         channel%verdict%trend%shape = "ramp"
         channel%verdict%drifts = .true.
         channel%drift_doubt = "a reason"
         allocate (channel%ar%root(1))
         channel%ar%residual_normality%kurtosis = 3
         channel%allan(stage%input)%other = [channel%allan(stage%input)%curve]
         channel%allan(stage%input)%noise%tau = [1.0_dp]
         channel%allan(stage%input)%noise%residual = [1.0_dp]
      end associate
      call put_document(out, record, result, "gyroakf run")
      deallocate (record%path, record%format, record%rate_source, record%unit_source, record%stored_type)
      deallocate (result%channel)
      allocate (result%channel(1))
      allocate (result%channel(1)%allan(6))
      result%channel(1)%name = "gx"
      call put_document(out, record, result)
      call put_document(out, record)
      call write_schema(out, text, wrong)
      if (text == file_text("doc/schema.json")) return
      open (newunit=unit, file="build/schema.json", access="stream", form="unformatted", status="replace")
      write (unit) text
      close (unit)
      call check(error, wrong, "", "no sentence, or no value in a document, for "//wrong)
      call check(error, .false., "doc/schema.json is not what the descriptions say: cp build/schema.json doc/schema.json")
   end subroutine test_document

   !> What is new has no sentence; types and what may be null come from the description.
   subroutine test_small()
      type(schema_type) :: out
      character(:), allocatable :: text, wrong
      logical :: valid

      call read_json('{"properties":{"a":{"description":"A","enum":["x",null]},"b":{"type":"string"}}}', out%old, valid)
      call out%open("")
      call out%put("a", "x", .true.)
      call out%put("b", 1.0_dp)
      call out%close()
      call write_schema(out, text, wrong)
      call check(error, wrong, "/properties/b")
      call check(error, text, '{"type": "object",'//new_line("a")//'  "required": ["a", "b"],'//new_line("a")// &
                 '  "properties": {'//new_line("a")// &
                 '    "a": {"type": ["string", "null"], "enum": ["x", null], "description": "A"},'//new_line("a")// &
                 '    "b": {"type": ["number", "null"]}'//new_line("a")//"  }}"//new_line("a"))
   end subroutine test_small

end module test_schema
