! SPDX-License-Identifier: MIT
!> The value that an option has in a checked job, given or by default: the way back of `app/setting_*.f90`.
!>
!> A value is written as JSON has it, which [[gyroakf_app_config_value]] reads too. Given again, it makes the same job.
module gyroakf_app_effective
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader, only : reader_options
   use gyroakf_pipeline, only : pipeline_options
   use gyroakf_report_json, only : quote_json
   use gyroakf_app_config, only : analysis_config, cli_config, reading_config
   implicit none (type, external)
   private
   public :: effective_value

   character(*), parameter :: nothing = "null"

contains

   !> The value of an option: null where it is not given and there is no default, or none that could be given.
   subroutine effective_value(config, name, value)
      !> A job
      class(cli_config), intent(in) :: config
      !> With its dashes
      character(*), intent(in) :: name
      !> A number, a text in quotes, true, false, null
      character(:), allocatable, intent(out) :: value

      value = nothing
      select case (name)
      case ("--quiet"); value = logical_value(config%quiet)
      case ("--force"); value = logical_value(config%force)
      case ("--progress"); value = text_value(trim(config%progress))
      case ("--threads"); value = count_value(int(config%threads, int64))
      case default
         select type (config)
         class is (reading_config)
            call value_of_reading(config, name, value)
         end select
         if (value /= nothing) return
         select type (config)
         type is (analysis_config)
            call value_of_output(config, name, value)
            if (value == nothing) call value_of_series(config%pipeline, name, value)
            if (value == nothing) call value_of_model(config%pipeline, name, value)
            if (value == nothing) call value_of_allan(config%pipeline, name, value)
         end select
      end select
   end subroutine effective_value

   !> Of the group "input", and the files common to all commands.
   subroutine value_of_reading(config, name, value)
      class(reading_config), intent(in) :: config
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: value

      associate (reader => config%reader)
         select case (name)
         case ("--rate"); value = positive_value(reader%rate_hz)
         case ("--unit"); value = text_value(reader%unit)
         case ("--input"); value = text_value(reader%input, "rate")
         case ("--wrap"); value = text_value(reader%wrap, "auto")
         case ("--resample"); value = text_value(reader%resample, "index")
         case ("--scale"); value = real_value(reader%scale)
         case ("--column"); value = text_value(reader%columns)
         case ("--time-column"); value = text_value(reader%time_column)
         case ("--format"); value = text_value(reader%format, "auto")
         case ("--channels"); value = count_value(reader%channels)
         case ("--dataset"); value = text_value(reader%dataset)
         case ("--skip"); value = integer_text(reader%skip)
         case ("--from"); value = real_value(reader%from)
         case ("--to"); if (reader%to < huge(reader%to)) value = real_value(reader%to)
         case ("--decimal-comma"); value = logical_value(reader%decimal_comma)
         case ("--bad-lines"); value = text_value(trim(merge("missing", "error  ", reader%bad_lines_missing)))
         case ("--memory"); if (.not. reader%memory_found) value = count_value(reader%memory)
         case ("--out"); value = text_value(config%out)
         case ("--json"); value = text_value(config%json)
         case ("--list"); value = text_value(config%list)
         case ("--color"); value = text_value(trim(config%colour))
         case ("--ascii"); value = logical_value(config%ascii)
         case default                          ! of another group
         end select
      end associate
   end subroutine value_of_reading

   !> Of the groups "preset" and "output".
   subroutine value_of_output(config, name, value)
      type(analysis_config), intent(in) :: config
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: value

      select case (name)
      case ("--preset"); if (config%pipeline%preset /= "default") value = text_value(trim(config%pipeline%preset))
      case ("--kalibr"); value = text_value(config%kalibr)
      case ("--markdown"); value = text_value(config%markdown)
      case ("--latex"); value = text_value(config%latex)
      case ("--chart"); value = text_value(trim(merge("on ", "off", config%chart)))
      case ("--plot"); value = text_value(config%plot)
      case ("--truth"); value = text_value(config%truth)
      case ("--series-format"); value = text_value(trim(config%series%form))
      case ("--digits"); value = integer_text(int(config%series%digits, int64))
      case default                          ! of another group
      end select
   end subroutine value_of_output

   !> Of the groups "clean" and "tests".
   subroutine value_of_series(pipeline, name, value)
      type(pipeline_options), intent(in) :: pipeline
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: value
      logical :: marks

      marks = pipeline%clean%method /= "none"
      select case (name)
      case ("--outliers"); value = text_value(trim(pipeline%clean%method))
      case ("--outlier-threshold"); if (marks) value = positive_value(pipeline%clean%threshold)
      case ("--outlier-rounds"); if (marks) value = integer_text(int(pipeline%clean%max_passes, int64))
      case ("--outlier-window")
         if (pipeline%clean%method == "hampel") value = integer_text(int(pipeline%clean%half_width, int64))
      case ("--detrend"); value = small_value(pipeline%clean%degree, "none")
      case ("--adf-regression"); value = text_value(trim(pipeline%adf%regression))
      case ("--adf-lags"); value = small_value(pipeline%adf%lags, "auto")
      case ("--adf-criterion"); value = text_value(trim(pipeline%adf%criterion))
      case ("--adf-max-lags"); value = small_value(pipeline%adf%max_lags, "auto")
      case ("--adf-table"); value = logical_value(pipeline%adf%table)
      case ("--kpss-regression"); value = text_value(trim(pipeline%kpss%regression))
      case ("--kpss-lags"); value = small_value(int(pipeline%kpss%lags), "auto")
      case ("--lags"); value = count_value(int(pipeline%correlation_lags, int64))
      case ("--welch-segment"); value = positive_value(pipeline%welch_segment, "auto")
      case default                          ! of another group
      end select
   end subroutine value_of_series

   !> Of the groups "ar" and "filter".
   subroutine value_of_model(pipeline, name, value)
      type(pipeline_options), intent(in) :: pipeline
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: value

      select case (name)
      case ("--ar-method"); value = text_value(trim(pipeline%ar%method))
      case ("--ar-criterion"); value = text_value(trim(pipeline%ar%criterion))
      case ("--max-order"); value = integer_text(int(pipeline%ar%max_order, int64))
      case ("--order"); if (pipeline%ar%order >= 0) value = integer_text(int(pipeline%ar%order, int64))
      case ("--akf"); value = text_value(trim(pipeline%design%akf))
      case ("--forgetting")                    ! one number means that of both families
         if (.not. abs(pipeline%design%forgetting - pipeline%drift%forgetting) > 0.0_dp) then
           value = real_value(pipeline%design%forgetting)
         end if
      case ("--estimate")
         value = text_value(trim(pipeline%design%estimate))
         if (pipeline%design%estimate == " ") value = text_value(trim(merge("R ", "QR", pipeline%design%akf == "robust")))
      case ("--r-factor"); value = real_value(pipeline%design%r_factor)
      case ("--drift-tau"); value = positive_value(pipeline%drift_tau)
      case default                          ! of another group
      end select
   end subroutine value_of_model

   !> Of the group "allan".
   subroutine value_of_allan(pipeline, name, value)
      type(pipeline_options), intent(in) :: pipeline
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: value

      select case (name)
      case ("--kinds")
         value = text_value("oadev")
         if (allocated(pipeline%other_kinds)) value = text_value("oadev,"//pipeline%other_kinds)
      case ("--taus"); value = text_value(pipeline%allan%taus, "octave")
      case ("--confidence"); value = real_value(pipeline%allan%confidence)
      case ("--min-coverage"); value = real_value(pipeline%allan%min_coverage)
      case ("--terms"); value = text_value(trim(pipeline%noise%terms))
      case ("--fit-tau-min"); value = positive_value(pipeline%noise%tau_min)
      case ("--fit-tau-max"); if (pipeline%noise%tau_max < huge(1.0_dp)) value = real_value(pipeline%noise%tau_max)
      case default                          ! of another group
      end select
   end subroutine value_of_allan

   !> A text in quotes; where it is unallocated its default, or null.
   function text_value(text, usual) result(value)
      character(*), intent(in), optional :: text
      character(*), intent(in), optional :: usual
      character(:), allocatable :: value

      value = nothing
      if (present(text)) then
         call quote_json(text, value)
      else if (present(usual)) then
         call quote_json(usual, value)
      end if
   end function text_value

   pure function logical_value(flag) result(value)
      logical, intent(in) :: flag
      character(:), allocatable :: value

      value = trim(merge("true ", "false", flag))
   end function logical_value

   !> The number that reads back to the same bits.
   pure function real_value(x) result(value)
      real(dp), intent(in) :: x
      character(:), allocatable :: value

      value = format_real(x, 0)
   end function real_value

   !> 0 stands for what nobody gave: a word, or null.
   function positive_value(x, usual) result(value)
      real(dp), intent(in) :: x
      character(*), intent(in), optional :: usual
      character(:), allocatable :: value

      value = text_value(usual)
      if (x > 0.0_dp) value = real_value(x)
   end function positive_value

   pure function count_value(n) result(value)
      integer(int64), intent(in) :: n
      character(:), allocatable :: value

      value = nothing
      if (n > 0) value = integer_text(n)
   end function count_value

   !> Below 0 stands for a word.
   function small_value(n, word) result(value)
      integer, intent(in) :: n
      character(*), intent(in) :: word
      character(:), allocatable :: value

      value = text_value(word)
      if (n >= 0) value = integer_text(int(n, int64))
   end function small_value

end module gyroakf_app_effective
