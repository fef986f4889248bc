! SPDX-License-Identifier: MIT
!> Options of simulate: the terms of the record.
module gyroakf_app_setting_record
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_number, only : parse_number, number
   use gyroakf_simulate_simulate_record, only : simulate_options, paper_preset
   use gyroakf_units, only : term_names
   use gyroakf_app_config, only : simulate_config
   use gyroakf_app_option, only : option_type, options, find_option
   use gyroakf_app_sensor, only : sensor_options
   use gyroakf_app_setting_input, only : check_unit
   use gyroakf_app_value, only : value_type, value_error, not_wired, convert_value, convert_list
   implicit none (type, external)
   private
   public :: set_preset, set_record, check_record

contains

   !> Applies --preset of simulate: the paper's record, or the options of a sensor.
   subroutine set_preset(config, option, name, error)
      !> What is changed
      type(simulate_config), intent(inout) :: config
      !> The row of --preset
      type(option_type), intent(in) :: option
      !> One of its words
      character(*), intent(in) :: name
      !> usage
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words
      type(option_type) :: next
      type(value_type) :: value
      integer :: blank

      if (name == "paper") then
         config%record = paper_preset(config%record%seed)
         config%digits = 9
         return
      end if
      words = sensor_options(name)
      if (words == "") call not_wired(option, error)
      do while (words /= "" .and. .not. allocated(error))
         blank = index(words, " ")
         next = options(find_option(words(:blank - 1), "simulate"))
         words = words(blank + 1:)
         blank = index(words, " ")
         call convert_value(next, words(:blank - 1), value, error)
         if (.not. allocated(error)) call set_record(config, next, value, error)
         words = words(blank + 1:)
      end do
   end subroutine set_preset

   !> Applies an option of the group "record" but --preset.
   subroutine set_record(config, option, value, error)
      !> What is changed
      type(simulate_config), intent(inout) :: config
      !> Row of the table
      type(option_type), intent(in) :: option
      !> Its value
      type(value_type), intent(in) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--samples"); config%record%samples = value%count
      case ("--rate"); config%record%rate_hz = value%number
      case ("--dt"); config%record%rate_hz = 1/value%number
      case ("--unit"); call check_unit(option, value%text, error)
         config%record%unit = value%text
      case ("--seed"); config%record%seed = value%count
      case ("--output"); config%output = value%text
      case ("--truth"); config%truth = value%text
         if (value%text == "-") call value_error(option, "it needs the name of a file", error)
      case default; call set_term(config%record, option, value, error)
      end select
   end subroutine set_record

   !> Applies an option that adds something to the record.
   subroutine set_term(record, option, value, error)
      type(simulate_options), intent(inout) :: record
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--coefficients"); call set_coefficients(option, value%text, record%coefficient, error)
      case ("--ar"); call convert_list(option, value%text, record%ar, error)
      case ("--ar-variance"); record%ar_variance = value%number
      case ("--trend"); call convert_list(option, value%text, record%trend, error)
      case ("--offset"); record%offset = value%number
      case ("--outlier-count"); record%outliers = value%count
      case ("--outlier-size"); record%outlier_size = value%number
      case ("--tails"); record%tails = value%text
      case ("--lowpass", "--resonance", "--contamination", "--warmup", "--motion", "--markov", "--vibration")
         call set_parts(option, value%text, record, error)
      case ("--lsb"); record%lsb = value%number
      case ("--missing"); record%missing = value%number
         if (value%number < 0 .or. value%number > 0.9_dp) call value_error(option, "'"//value%text//"' is not from 0 to 0.9", error)
      case default; call not_wired(option, error)
      end select
   end subroutine set_term

   !> Options of several numbers, all positive but the amplitude of a warm-up; the library judges their ranges.
   subroutine set_parts(option, text, record, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(simulate_options), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      type(option_type) :: positive
      real(dp), allocatable :: list(:)
      integer :: n
      logical :: fits

      positive = option
      if (option%name /= "--warmup") positive%kind = "positive"
      call convert_list(positive, text, list, error)
      if (allocated(error)) return
      n = size(list)
      list = [list, 0.0_dp, 0.0_dp, 0.0_dp]             ! for the parts that are not given
      select case (option%name)
      case ("--resonance"); fits = n == 2
         record%resonance_hz = list(1)
         record%resonance_q = list(2)
      case ("--lowpass"); fits = n <= 2
         record%lowpass_hz = list(1)
         record%lowpass_order = findloc([1.0_dp, 2.0_dp], merge(list(2), 1.0_dp, n > 1), dim=1)
      case ("--contamination"); fits = n == 2
         record%contamination = list(:2)
      case ("--warmup"); fits = n == 2
         record%warm_up = list(:2)
      case ("--motion"); fits = n == 3 .or. n == 4
         record%motion = list(:4)
      case ("--markov"); fits = mod(n, 2) == 0
         record%markov = list(:n)
      case default; fits = mod(n, 3) == 0
         record%vibration = list(:n)
      end select
      if (.not. fits) call value_error(option, "'"//text//"' has the wrong number of parts", error)
   end subroutine set_parts

   !> What is wrong with the options as a whole.
   subroutine check_record(record, error)
      !> All options
      type(simulate_options), intent(in) :: record
      !> usage
      type(error_type), allocatable, intent(out) :: error
      logical :: has_ar, has_variance, has_size

      has_ar = allocated(record%ar)
      has_variance = record%ar_variance > 0
      has_size = abs(record%outlier_size) > 0
      if (has_ar .neqv. has_variance) then
         call fatal_error(error, status%usage, "--ar and --ar-variance go together")
      else if ((record%outliers > 0) .neqv. has_size) then
         call fatal_error(error, status%usage, "--outlier-count and --outlier-size go together")
      end if
   end subroutine check_record

   !> Q=1e-3,N=0.02: any of the five, each once.
   subroutine set_coefficients(option, text, coefficient, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      real(dp), intent(inout) :: coefficient(5)
      type(error_type), allocatable, intent(out) :: error
      logical :: given(5), ok
      integer :: from, to, term, found

      given = .false.
      from = 1
      do while (from <= len(text) + 1)
         to = from + index(text(from:)//",", ",") - 2
         term = 0
         if (to > from) term = findloc(term_names, text(from:from), dim=1)
         ok = term > 0
         if (ok) ok = text(from + 1:from + 1) == "=" .and. .not. given(term)
         if (ok) then
            call parse_number(text(from + 2:to), coefficient(term), found)
            ok = found == number%ok .and. (coefficient(term) >= 0 .or. term_names(term) == "R")
         end if
         if (.not. ok) then
            call value_error(option, "'"//text(from:to)//"' is not a term given once, with its value (negative only for R)", error)
            return
         end if
         given(term) = .true.
         from = to + 2
      end do
   end subroutine set_coefficients

end module gyroakf_app_setting_record
