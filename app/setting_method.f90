! SPDX-License-Identifier: MIT
!> Options of the method: cleaning, tests, AR model, filters, Allan analysis.
module gyroakf_app_setting_method
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_noise_fit, only : noise_options
   use gyroakf_filter_design, only : design_options
   use gyroakf_preprocess_local_outliers, only : largest_half_width
   use gyroakf_pipeline, only : pipeline_options
   use gyroakf_app_option, only : option_type
   use gyroakf_app_value, only : value_type, value_error, not_wired, convert_list, is_word
   implicit none (type, external)
   private
   public :: set_method, check_method

   !> Largest AR order and number of lags that can be asked for
   integer(int64), parameter :: most_lags = 1000
   !> Most rounds of the search for outliers
   integer, parameter :: most_rounds = 1000
   !> Maximum number of lags of an autocorrelation, and bandwidth of the KPSS test
   integer, parameter :: max_correlation_lags = 4096, max_bandwidth = 100000

contains

   !> Applies an option of one of the groups "clean", "tests", "ar", "filter", "allan".
   subroutine set_method(pipeline, option, value, error)
      !> What is changed
      type(pipeline_options), intent(inout) :: pipeline
      !> Row of the table
      type(option_type), intent(in) :: option
      !> Its value
      type(value_type), intent(in) :: value
      !> usage
      type(error_type), allocatable, intent(out) :: error

      select case (option%group)
      case ("clean", "tests"); call set_series(pipeline, option, value, error)
      case ("ar", "filter"); call set_model(pipeline, option, value, error)
      case ("allan"); call set_allan(pipeline, option, value, error)
      case default                          ! no option of the method
      end select
   end subroutine set_method

   !> What is wrong with the options as a whole.
   subroutine check_method(pipeline, threshold_given, rounds_given, window_given, error)
      !> All options
      type(pipeline_options), intent(in) :: pipeline
      !> --outlier-threshold, --outlier-rounds, --outlier-window were given
      logical, intent(in) :: threshold_given, rounds_given, window_given
      !> usage
      type(error_type), allocatable, intent(out) :: error

      if (threshold_given .and. pipeline%clean%method == "none") then
         call fatal_error(error, status%usage, "--outlier-threshold without --outliers: no outliers are looked for")
      else if (rounds_given .and. pipeline%clean%method == "none") then
         call fatal_error(error, status%usage, "--outlier-rounds without --outliers: no outliers are looked for")
      else if (window_given .and. pipeline%clean%method /= "hampel") then
         call fatal_error(error, status%usage, "--outlier-window goes with --outliers hampel: the other rules have no window")
      else if (pipeline%ar%order > pipeline%ar%max_order) then
         call fatal_error(error, status%usage, "--order is larger than --max-order")
      else if (pipeline%noise%tau_min >= pipeline%noise%tau_max) then
         call fatal_error(error, status%usage, "--fit-tau-min is not below --fit-tau-max: nothing would be fitted")
      end if
   end subroutine check_method

   !> Cleaning and tests.
   subroutine set_series(pipeline, option, value, error)
      type(pipeline_options), intent(inout) :: pipeline
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--outliers"); pipeline%clean%method = value%text
      case ("--outlier-threshold"); pipeline%clean%threshold = value%number
      case ("--outlier-rounds"); call set_small(option, value%text, "", most_rounds, pipeline%clean%max_passes, error)
      case ("--outlier-window"); call set_small(option, value%text, "", largest_half_width, pipeline%clean%half_width, error)
      case ("--detrend"); call set_small(option, value%text, "none", 9, pipeline%clean%degree, error)
      case ("--adf-regression"); pipeline%adf%regression = value%text
      case ("--adf-lags"); call set_small(option, value%text, "auto", int(most_lags), pipeline%adf%lags, error)
      case ("--adf-criterion"); pipeline%adf%criterion = value%text
      case ("--adf-max-lags"); call set_small(option, value%text, "auto", int(most_lags), pipeline%adf%max_lags, error)
      case ("--adf-table"); pipeline%adf%table = .true.
      case ("--kpss-regression"); pipeline%kpss%regression = value%text
      case ("--kpss-lags"); call set_bandwidth(option, value%text, pipeline%kpss%lags, error)
      case ("--lags"); call set_small(option, value%text, "", max_correlation_lags, pipeline%correlation_lags, error)
      case ("--welch-segment"); call set_segment(pipeline, option, value%text, error)
      case default; call not_wired(option, error)
      end select
   end subroutine set_series

   !> Bandwidth of the KPSS test.
   subroutine set_bandwidth(option, text, lags, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      integer(int64), intent(inout) :: lags
      type(error_type), allocatable, intent(out) :: error
      integer :: wanted

      wanted = -1
      call set_small(option, text, "auto", max_bandwidth, wanted, error)
      if (.not. allocated(error)) lags = int(wanted, int64)
   end subroutine set_bandwidth

   !> Length of the segments of Welch's spectrum, or auto.
   subroutine set_segment(pipeline, option, text, error)
      type(pipeline_options), intent(inout) :: pipeline
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: seconds(:)

      pipeline%welch_segment = 0.0_dp
      if (text == "auto") return
      call convert_list(option, text, seconds, error)
      if (allocated(error)) return
      if (size(seconds) == 1) pipeline%welch_segment = seconds(1)
      if (.not. pipeline%welch_segment > 0.0_dp) call value_error(option, "'"//text//"' is not a number larger than 0", error)
   end subroutine set_segment

   !> AR model and filters.
   subroutine set_model(pipeline, option, value, error)
      type(pipeline_options), intent(inout) :: pipeline
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--ar-method"); pipeline%ar%method = value%text
      case ("--ar-criterion"); pipeline%ar%criterion = value%text
      case ("--max-order"); call set_small(option, value%text, "", int(most_lags), pipeline%ar%max_order, error)
      case ("--order"); call set_small(option, value%text, "", int(most_lags), pipeline%ar%order, error)
         pipeline%ar%max_order = max(pipeline%ar%max_order, pipeline%ar%order)
      case ("--akf"); pipeline%design%akf = value%text
      case ("--forgetting"); pipeline%design%forgetting = value%number
         pipeline%drift%forgetting = value%number
      case ("--drift-tau"); pipeline%drift_tau = value%number
      case ("--estimate"); call set_estimate(pipeline%design, option, value%text, error)
      case ("--r-factor"); pipeline%design%r_factor = value%number
      case default; call not_wired(option, error)
      end select
   end subroutine set_model

   !> Allan curve and its fit.
   subroutine set_allan(pipeline, option, value, error)
      type(pipeline_options), intent(inout) :: pipeline
      type(option_type), intent(in) :: option
      type(value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      select case (option%name)
      case ("--kinds"); call set_kinds(pipeline, value%text)
      case ("--taus"); call check_taus(option, value%text, error)
         pipeline%allan%taus = value%text
      case ("--confidence")
         pipeline%allan%confidence = value%number
         if (value%number >= 1) call value_error(option, "limits that always hold are infinite", error)
      case ("--min-coverage"); pipeline%allan%min_coverage = value%number
      case ("--terms"); call set_terms(pipeline%noise, option, value%text, error)
      case ("--fit-tau-min"); pipeline%noise%tau_min = value%number
      case ("--fit-tau-max"); pipeline%noise%tau_max = value%number
      case default; call not_wired(option, error)
      end select
   end subroutine set_allan

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

   !> A small whole number from 0, or a word that means -1.
   subroutine set_small(option, text, word, largest, number, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text, word
      integer, intent(in) :: largest
      integer, intent(inout) :: number
      type(error_type), allocatable, intent(out) :: error
      character(8) :: limit
      integer :: given

      given = -1
      if (text == word .and. word /= "") then
         number = -1
         return
      end if
      if (len(text) <= 6 .and. verify(text, "0123456789") == 0) read (text, "(i6)") given
      if (given >= 0 .and. given <= largest) then
         number = given
         return
      end if
      write (limit, "(i0)") largest
      call value_error(option, "'"//text//"' is not a whole number from 0 to "//trim(limit), error)
   end subroutine set_small

   !> Any of q, r, Q, R, with or without commas.
   subroutine set_estimate(design, option, text, error)
      type(design_options), intent(inout) :: design
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      design%estimate = ""
      do i = 1, len(text)
         if (text(i:i) == ",") cycle
         if (verify(text(i:i), "qrQR") /= 0 .or. index(design%estimate, text(i:i)) > 0) then
            call value_error(option, "'"//text//"' does not name each of q, r, Q, R at most once", error)
            return
         end if
         design%estimate = trim(design%estimate)//text(i:i)
      end do
   end subroutine set_estimate

   !> auto, or some of Q N B K R, in that order whatever the order of the letters.
   subroutine set_terms(noise, option, text, error)
      type(noise_options), intent(inout) :: noise
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: letters = "QNBKR"
      integer :: i

      noise%terms = "auto"
      if (text == "auto") return
      if (verify(text, letters) /= 0) then
         call value_error(option, "'"//text//"' has other letters than Q N B K R", error)
         return
      end if
      noise%terms = ""
      do i = 1, len(letters)
         if (index(text, letters(i:i)) > 0) noise%terms = trim(noise%terms)//letters(i:i)
      end do
   end subroutine set_terms

   !> octave, decade, all, log:N or seconds.
   subroutine check_taus(option, text, error)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: seconds(:)
      integer :: per_decade

      if (is_word(text, "octave|decade|all")) return
      if (index(text, "log:") == 1) then
         call set_small(option, text(5:), "", 10000, per_decade, error)
         if (allocated(error)) return
         if (per_decade == 0) call value_error(option, "log:0 has no averaging times", error)
         return
      end if
      if (verify(text(1:1), "0123456789.+-") /= 0) then
         call value_error(option, "'"//text//"' is not one of these", error)
         return
      end if
      call convert_list(option, text, seconds, error)
      if (allocated(error)) return
      if (any(seconds <= 0)) call value_error(option, "averaging times are larger than 0", error)
   end subroutine check_taus

end module gyroakf_app_setting_method
