! SPDX-License-Identifier: MIT
!> Options of simulate: the terms of the record.
module gyroakf_app_setting_record
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_number, only : parse_number, number
   use gyroakf_simulate_simulate_record, only : simulate_options
   use gyroakf_units, only : term_names
   use gyroakf_app_config, only : simulate_config
   use gyroakf_app_option, only : option_type
   use gyroakf_app_setting_input, only : check_unit
   use gyroakf_app_value, only : value_type, value_error, not_wired, convert_list
   implicit none (type, external)
   private
   public :: set_record, check_record

contains

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
      case ("--lowpass", "--resonance"); call set_filter(option, value%text, record, error)
      case ("--lsb"); record%lsb = value%number
      case ("--missing"); record%missing = value%number
         if (value%number < 0 .or. value%number > 0.9_dp) call value_error(option, "'"//value%text//"' is not from 0 to 0.9", error)
      case default; call not_wired(option, error)
      end select
   end subroutine set_term

   !> HZ[,ORDER] of the low-pass filter, HZ,Q of the resonance; the library judges their ranges.
   subroutine set_filter(option, text, record, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(simulate_options), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      type(option_type) :: positive
      real(dp), allocatable :: list(:)

      positive = option
      positive%kind = "positive"
      call convert_list(positive, text, list, error)
      if (allocated(error)) return
      if (option%name == "--resonance" .and. size(list) == 2) then
         record%resonance_hz = list(1)
         record%resonance_q = list(2)
      else if (option%name == "--lowpass" .and. size(list) <= 2) then
         record%lowpass_hz = list(1)
         list = [list, 1.0_dp]                          ! the order where none is given
         record%lowpass_order = findloc([1.0_dp, 2.0_dp], list(2), dim=1)
      else
         call value_error(option, "'"//text//"' has the wrong number of parts", error)
      end if
   end subroutine set_filter

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
