! SPDX-License-Identifier: MIT
!> Options that say how the recording is read, and those common to all commands.
module gyroakf_app_setting_input
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_element, only : element_type, parse_element
   use gyroakf_io_number, only : number, parse_number
   use gyroakf_io_reader, only : reader_options
   use gyroakf_units, only : unit_type, is_integral, parse_unit, parse_units, quantity
   use gyroakf_app_config, only : cli_config, reading_config, analysis_config, simulate_config
   use gyroakf_app_option, only : option_type, suggest_word
   use gyroakf_app_value, only : value_type, value_error, not_wired
   implicit none (type, external)
   private
   public :: set_input, check_input, set_common, check_unit

   !> More threads than this are a slip of the finger
   integer(int64), parameter :: most_threads = 4096
   !> The program itself and a small recording
   integer(int64), parameter :: least_memory = 28000000

contains

   !> Applies an option of the group "input".
   subroutine set_input(reader, option, value, error)
      !> What is changed
      type(reader_options), intent(inout) :: reader
      !> Row of the table
      type(option_type), intent(in) :: option
      !> Its value
      type(value_type), intent(in) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--rate"); reader%rate_hz = value%number
      case ("--dt"); reader%rate_hz = 1/value%number
      case ("--unit"); call check_units(option, value%text, error)
         reader%unit = value%text
      case ("--input"); reader%input = value%text
      case ("--scale"); reader%scale = value%number
         if (.not. abs(value%number) > 0) call value_error(option, "0 leaves nothing", error)
      case ("--column"); reader%columns = value%text
      case ("--time-column"); reader%time_column = value%text
      case ("--time-unit"); reader%time_unit = value%text
      case ("--format"); call set_format(reader, option, value%text, error)
      case ("--channels"); reader%channels = value%count
      case ("--skip"); reader%skip = value%count
      case ("--where"); reader%where = value%text
      case ("--from"); reader%from = value%number
         if (value%number < 0) call value_error(option, "'"//value%text//"' is before the first sample", error)
      case ("--to"); reader%to = value%number
      case ("--wrap"); call set_wrap(reader, option, value%text, error)
      case ("--resample"); reader%resample = value%text
      case ("--decimal-comma"); reader%decimal_comma = .true.
      case ("--bad-lines"); reader%bad_lines_missing = value%text == "missing"
      case default; call not_wired(option, error)
      end select
   end subroutine set_input

   !> One of the formats; the other words are those of [[parse_element]].
   subroutine set_format(reader, option, text, error)
      type(reader_options), intent(inout) :: reader
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      character(4), parameter :: words(15) = [character(4) :: "auto", "text", "csv", "npy", "f16", &
         "f32", "f64", "i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"]
      character(:), allocatable :: near
      type(element_type) :: element
      logical :: raw

      reader%format = text
      call parse_element(text, element, raw)
      if (raw .or. any(words(:4) == text)) return
      near = suggest_word(text, words)
      if (len(near) > 0) near = ", perhaps '"//near//"'"
      call value_error(option, "'"//text// &
         "' is none of auto, text, csv, npy, f32, f64, i8, i16, i32, i64, u8, u16, u32, "// &
                       "which may have le or be behind them"//near, error)
   end subroutine set_format

   !> auto, none or a positive number.
   subroutine set_wrap(reader, option, text, error)
      type(reader_options), intent(inout) :: reader
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      !> usage
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x
      integer :: found

      reader%wrap = text
      if (text == "auto" .or. text == "none") return
      call parse_number(text, x, found)
      if (found /= number%ok .or. x <= 0.0_dp) call value_error(option, &
         "'"//text//"' is neither auto, none nor a positive number", error)
   end subroutine set_wrap

   !> What is wrong with the options of a group as a whole.
   subroutine check_input(reader, error)
      !> All options of the group
      type(reader_options), intent(in) :: reader
      !> usage
      type(error_type), allocatable, intent(out) :: error
      type(unit_type), allocatable :: unit(:)
      logical :: angles
      integer :: i

      if (reader%from >= reader%to) then
         call fatal_error(error, status%usage, "--from is not before --to: nothing would be left")
         return
      end if
      if (.not. allocated(reader%unit)) return
      call parse_units(reader%unit, unit, error)
      if (allocated(error)) return
      angles = .false.
      if (allocated(reader%input)) angles = reader%input /= "rate"
      do i = 1, size(unit)
         if (angles .eqv. is_integral(unit(i))) cycle
         if (angles) then
            call fatal_error(error, status%usage, "with --input "//reader%input// &
               " the unit is that of the angle: rad, deg, "// &
                             "arcsec, or of the velocity: m/s, not '"//unit(i)%name//"'")
         else
            call fatal_error(error, status%usage, "'"//unit(i)%name//"' is the unit of "// &
               trim(merge("a velocity", "an angle  ", unit(i)%quantity == quantity%velocity))//": say --input increment or "// &
                             "--input angle, or name the unit of a rate")
         end if
         return
      end do
   end subroutine check_input

   !> An unknown unit is a usage error.
   subroutine check_unit(option, text, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> The unit as it was given
      character(*), intent(in) :: text
      !> usage
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: unknown
      type(unit_type) :: unit

      call parse_unit(text, unit, unknown)
      if (allocated(unknown)) call value_error(option, unknown%message, error)
   end subroutine check_unit

   !> The same for a list of units.
   subroutine check_units(option, text, error)
      !> Row of the table
      type(option_type), intent(in) :: option
      !> The units as they were given, separated by commas
      character(*), intent(in) :: text
      !> usage
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: unknown
      type(unit_type), allocatable :: unit(:)

      call parse_units(text, unit, unknown)
      if (allocated(unknown)) call value_error(option, unknown%message, error)
   end subroutine check_units

   !> Applies an option of the group "common".
   subroutine set_common(config, option, value, error)
      !> What is changed
      class(cli_config), intent(inout) :: config
      !> Row of the table
      type(option_type), intent(in) :: option
      !> Its value
      type(value_type), intent(in) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--config", "--write-config")                             ! of the words as a whole, see gyroakf_app_cli
      case ("--quiet"); config%quiet = .true.
      case ("--progress"); config%progress = value%text
      case ("--force"); config%force = .true.
      case ("--digits"); call set_digits(config, option, value, error)
      case ("--series-format")
         select type (config)
         type is (analysis_config)
            config%series%form = value%text
         end select
      case ("--threads")
         config%threads = int(min(value%count, most_threads))
         if (value%count > most_threads) call value_error(option, "'"//value%text//"' is more than 4096", error)
      case ("--json")
         select type (config)
         class is (reading_config)
            config%json = value%text
         end select
      case ("--out")
         select type (config)
         class is (reading_config)
            config%out = value%text
         end select
      case ("--list")
         select type (config)
         class is (reading_config)
            config%list = value%text
         end select
      case ("--memory")
         select type (config)
         class is (reading_config)
            call set_memory(config%reader, option, value%text, error)
         end select
      case ("--kalibr")
         select type (config)
         type is (analysis_config)
            config%kalibr = value%text
            if (value%text == "-") call value_error(option, "it needs the name of a file", error)
         end select
      case ("--latex", "--chart", "--details")
         select type (config)
         type is (analysis_config)
            if (option%name == "--latex") config%latex = value%text
            if (option%name == "--details") config%details = .true.
            if (option%name == "--chart") config%chart = value%text == "on"
         end select
      case ("--color", "--ascii")
         select type (config)
         class is (reading_config)
            if (option%name == "--color") config%colour = value%text
            if (option%name == "--ascii") config%ascii = .true.
         end select
      case ("--truth")
         select type (config)
         type is (analysis_config)
            config%truth = value%text
            if (value%text == "-") call value_error(option, "it needs the name of a file", error)
         end select
      case default; call not_wired(option, error)
      end select
   end subroutine set_common

   !> Digits of the numbers in text.
   subroutine set_digits(config, option, value, error)
      class(cli_config), intent(inout) :: config
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      if (value%count > 17) then
         call value_error(option, "'"//value%text//"' is more than the 17 digits that a number has", error)
         return
      end if
      select type (config)
      type is (analysis_config)
         config%series%digits = int(value%count)
      type is (simulate_config)
         config%digits = int(value%count)
      end select
   end subroutine set_digits

   !> 500MB, 2GB, 1.5G, 300MiB, or a number of bytes.
   subroutine set_memory(reader, option, text, error)
      !> Its memory is set
      type(reader_options), intent(inout) :: reader
      !> Row of the table
      type(option_type), intent(in) :: option
      !> The size as it was given
      character(*), intent(in) :: text
      !> usage
      type(error_type), allocatable, intent(out) :: error
      character(3), parameter :: units(14) = [character(3) :: "", "B", "k", "kB", "KiB", "M", "MB", "MiB", "G", "GB", "GiB", &
                                             "T", "TB", "TiB"]
      real(dp), parameter :: bytes(14) = [1.0_dp, 1.0_dp, 1e3_dp, 1e3_dp, 1024.0_dp, 1e6_dp, 1e6_dp, 1024.0_dp**2, 1e9_dp, &
         1e9_dp, &
                                          1024.0_dp**3, 1e12_dp, 1e12_dp, 1024.0_dp**4]
      real(dp) :: x
      integer :: last, found, unit

      last = scan(text, "0123456789.", back=.true.)
      found = -1
      unit = 0
      if (last > 0) then
         call parse_number(text(:last), x, found)
         unit = findloc(units, text(last + 1:), dim=1)
      end if
      if (found /= number%ok .or. unit == 0) then
         call value_error(option, "'"//text//"' is not a size such as 500MB or 2GB", error)
         return
      end if
      x = x*bytes(unit)
      if (x < real(least_memory, dp)) then
         call value_error(option, "'"//text//"' is too small, at least 28MB", error)
      else
         reader%memory = int(min(x, 1.0e18_dp), int64)
      end if
   end subroutine set_memory

end module gyroakf_app_setting_input
