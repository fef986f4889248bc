! SPDX-License-Identifier: MIT
!> Where the values of options go: a case for every row of [[gyroakf_app_option]], by its group.
module gyroakf_app_settings
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_io_element, only : element_type, parse_element
   use gyroakf_io_reader, only : reader_options
   use gyroakf_pipeline, only : apply_preset, pipeline_options
   use gyroakf_units, only : unit_type, parse_units
   use gyroakf_app_config, only : config_type
   use gyroakf_app_option, only : suggest_word
   use gyroakf_app_option_table, only : option_type
   use gyroakf_app_simulation, only : set_record, set_sensor
   use gyroakf_app_value, only : value_type, convert_value, is_word, not_wired, value_error
   implicit none (type, external)
   private
   public :: apply_option

contains

   !> Applies an option that the command of the configuration knows.
   subroutine apply_option(config, option, text, error)
      !> What is changed
      type(config_type), intent(inout) :: config
      !> Row of the table
      type(option_type), intent(in) :: option
      !> Its value as it was given
      character(*), intent(in) :: text
      !> usage
      type(error_type), allocatable, intent(out) :: error
      type(value_type) :: value
      type(error_type), allocatable :: unknown
      type(unit_type), allocatable :: unit(:)

      call convert_value(option, text, value, error)
      if (allocated(error)) return
      select case (option%group)
      case ("input"); call set_input(config%reader, option, value, error)
      case ("preset"); call apply_preset(text, config%pipeline, error)
      case ("clean", "tests", "ar", "filter", "allan")
         call set_method(config%pipeline, option, value, error)
      case default; call set_common(config, option, value, error)
      end select
      if (option%name == "--unit") call parse_units(text, unit, unknown)
      if (allocated(unknown)) call value_error(option, unknown%message, error)
   end subroutine apply_option

   subroutine set_input(reader, option, value, error)
      type(reader_options), intent(inout) :: reader
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--rate"); reader%rate_hz = value%number
      case ("--dt"); reader%rate_hz = 1/value%number
      case ("--unit"); reader%unit = value%text
      case ("--input"); reader%input = value%text
      case ("--scale"); reader%scale = value%number
         if (.not. abs(value%number) > 0) call value_error(option, "0 leaves nothing", error)
      case ("--column"); reader%columns = value%text
      case ("--time-column"); reader%time_column = value%text
      case ("--time-unit"); reader%time_unit = value%text
      case ("--format"); reader%format = value%text
         call check_format(option, value%text, error)
      case ("--channels"); reader%channels = value%count
      case ("--skip"); reader%skip = value%count
      case ("--where"); reader%where = value%text
      case ("--from"); reader%from = value%number
         if (value%number < 0) call value_error(option, "'"//value%text// &
            "' is before the first sample", error)
      case ("--to"); reader%to = value%number
      case ("--wrap"); reader%wrap = value%text
      case ("--resample"); reader%resample = value%text
      case ("--decimal-comma"); reader%decimal_comma = .true.
      case ("--bad-lines"); reader%bad_lines_missing = value%text == "missing"
      case default; call not_wired(option, error)
      end select
   end subroutine set_input

   !> One of the formats; the other words are those of [[parse_element]].
   subroutine check_format(option, text, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      character(4), parameter :: words(15) = [character(4) :: "auto", "text", "csv", "npy", "f16", &
         "f32", "f64", "i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"]
      character(:), allocatable :: near
      type(element_type) :: element
      logical :: raw

      call parse_element(text, element, raw)
      if (raw .or. any(words(:4) == text)) return
      near = suggest_word(text, words)
      if (len(near) > 0) near = ", perhaps '"//near//"'"
      call value_error(option, "'"//text//"' is none of auto, text, csv, npy, f32, f64, i8, "// &
         "i16, i32, i64, u8, u16, u32, which may have le or be behind them"//near, error)
   end subroutine check_format

   subroutine set_method(pipeline, option, value, error)
      type(pipeline_options), intent(inout) :: pipeline
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error
      integer :: given, i

      select case (option%name)
      case ("--outliers"); pipeline%clean%method = value%text
      case ("--outlier-threshold"); pipeline%clean%threshold = value%number
      case ("--outlier-rounds"); pipeline%clean%max_passes = int(value%count)
      case ("--outlier-window"); pipeline%clean%half_width = int(value%count)
      case ("--detrend"); pipeline%clean%degree = int(value%count)
      case ("--adf-regression"); pipeline%adf%regression = value%text
      case ("--adf-lags"); pipeline%adf%lags = int(value%count)
      case ("--adf-criterion"); pipeline%adf%criterion = value%text
      case ("--adf-max-lags"); pipeline%adf%max_lags = int(value%count)
      case ("--adf-table"); pipeline%adf%table = .true.
      case ("--kpss-regression"); pipeline%kpss%regression = value%text
      case ("--kpss-lags"); pipeline%kpss%lags = value%count
      case ("--lags"); pipeline%correlation_lags = int(value%count)
      case ("--welch-segment"); pipeline%welch_segment = value%number
      case ("--ar-method"); pipeline%ar%method = value%text
      case ("--ar-criterion"); pipeline%ar%criterion = value%text
      case ("--max-order"); pipeline%ar%max_order = int(value%count)
      case ("--order"); pipeline%ar%order = int(value%count)
         pipeline%ar%max_order = max(pipeline%ar%max_order, pipeline%ar%order)
      case ("--akf"); pipeline%design%akf = value%text
      case ("--forgetting"); pipeline%design%forgetting = value%number
         pipeline%drift%forgetting = value%number
      case ("--drift-tau"); pipeline%drift_tau = value%number
      case ("--estimate"); pipeline%design%estimate = letters_in(value%text, "qrQR")
         given = count([(value%text(i:i) /= ",", i=1, len(value%text))])
         if (verify(value%text, "qrQR,") > 0 .or. given /= len_trim(pipeline%design%estimate)) then
            call value_error(option, "'"//value%text// &
               "' does not name each of q, r, Q, R at most once", error)
         end if
      case ("--r-factor"); pipeline%design%r_factor = value%number
      case ("--kinds"); call set_kinds(pipeline, value%text)
      case ("--taus"); pipeline%allan%taus = value%text
         call check_taus(option, value%text, error)
      case ("--confidence"); pipeline%allan%confidence = value%number
         if (value%number >= 1) then
            call value_error(option, "limits that always hold are infinite", error)
         end if
      case ("--min-coverage"); pipeline%allan%min_coverage = value%number
      case ("--terms"); pipeline%noise%terms = letters_in(value%text, "QNBKR")
         if (value%text == "auto") then
            pipeline%noise%terms = "auto"
         else if (verify(value%text, "QNBKR") > 0) then
            call value_error(option, "'"//value%text//"' has other letters than Q N B K R", error)
         end if
      case ("--fit-tau-min"); pipeline%noise%tau_min = value%number
      case ("--fit-tau-max"); pipeline%noise%tau_max = value%number
      case default; call not_wired(option, error)
      end select
   end subroutine set_method

   !> Kinds of deviation beside oadev, each once.
   subroutine set_kinds(pipeline, text)
      type(pipeline_options), intent(inout) :: pipeline
      character(*), intent(in) :: text
      character(:), allocatable :: kinds
      integer :: from, to

      kinds = ",oadev,"
      from = 1
      do while (from <= len(text))
         to = from + index(text(from:)//",", ",") - 2
         if (index(kinds, ","//text(from:to)//",") == 0) kinds = kinds//text(from:to)//","
         from = to + 2
      end do
      if (kinds /= ",oadev,") pipeline%other_kinds = kinds(8:len(kinds) - 1)
   end subroutine set_kinds

   !> The letters of a text, in the order of a set.
   pure function letters_in(text, set) result(letters)
      character(*), intent(in) :: text, set
      character(len(set)) :: letters
      integer :: i

      letters = ""
      do i = 1, len(set)
         if (index(text, set(i:i)) > 0) letters = trim(letters)//set(i:i)
      end do
   end function letters_in

   !> octave, decade, all, log:N or seconds.
   subroutine check_taus(option, text, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      type(option_type) :: part
      type(value_type) :: value

      part = option
      if (is_word(text, "octave|decade|all")) return
      if (index(text, "log:") == 1) then
         part%kind = "natural"
         part%upper = 10000.0_dp
         call convert_value(part, text(5:), value, error)
         if (value%count /= 0 .or. allocated(error)) return
         call value_error(option, "log:0 has no averaging times", error)
      else if (verify(text(1:1), "0123456789.+-") /= 0) then
         call value_error(option, "'"//text//"' is not one of these", error)
      else
         part%kind = "reals"
         call convert_value(part, text, value, error)
         if (allocated(error)) return
         if (all(value%list > 0)) return
         call value_error(option, "averaging times are larger than 0", error)
      end if
   end subroutine check_taus

   subroutine set_common(config, option, value, error)
      type(config_type), intent(inout) :: config
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--config", "--write-config")                 ! of the words as a whole, see app/cli.f90
      case ("--quiet"); config%quiet = .true.
      case ("--progress"); config%progress = value%text
      case ("--force"); config%force = .true.
      case ("--digits"); config%series%digits = int(value%count)
         if (value%count > 17) call value_error(option, "'"//value%text// &
            "' is more than the 17 digits that a number has", error)
      case ("--series-format"); config%series%form = value%text
      case ("--threads"); config%threads = int(value%count)
      case ("--json"); config%file(1)%text = value%text
      case ("--kalibr"); config%file(2)%text = value%text
      case ("--out"); config%out = value%text
      case ("--output"); config%output = value%text
      case ("--truth"); config%truth = value%text
      case ("--list"); config%list = value%text
      case ("--memory"); config%reader%memory = value%count
      case ("--chart"); config%chart = value%text == "on"
      case ("--details"); config%details = .true.
      case ("--color"); config%color = value%text
      case ("--ascii"); config%ascii = .true.
      case ("--preset"); call set_sensor(config%record, value%text, error)
         if (value%text == "paper") config%series%digits = 9
      case default; call set_record(config%record, option, value, error)
      end select
      if (value%text == "-" .and. any(option%name == ["--truth ", "--kalibr"])) then
         call value_error(option, "it needs the name of a file", error)
      end if
   end subroutine set_common

end module gyroakf_app_settings
