! SPDX-License-Identifier: MIT
!> Reports: layout, what they say, the document, tables for other programs.
module test_report
   use expectations, only : failed => problem, test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : add_text, record_type
   use gyroakf_units, only : unit_type, parse_unit
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_report_text_layout, only : put_item, put_heading, report_width, fixed, scientific, p_value_text, plural, rounded
   use gyroakf_utf8, only : text_width
   use gyroakf_report_text_report, only : write_report, report_inspect
   use gyroakf_report_document, only : write_document
   use gyroakf_report_csv, only : series_output_type, write_series, write_table
   use json_reader, only : json_item, read_json, json_text_at, json_real
   use report_fixture, only : make_record, make_result, fill_drift, begin_text, end_text
   implicit none (type, external)
   private
   public :: suite_report

   character(1), parameter :: lf = new_line("a")

contains

   subroutine suite_report()
      call test("numbers", test_numbers)
      call test("document-command-line", test_command_line)
      call test("wrapping", test_wrapping)
      call test("run", test_run)
      call test("run-tables", test_run_tables)
      call test("answer", test_answer)
      call test("screen", test_screen)
      call test("periodicity", test_periodicity_text)
      call test("run-nothing-known", test_nothing_known)
      call test("width", test_width)
      call test("drift", test_drift)
      call test("halves", test_halves)
      call test("single-commands", test_single_commands)
      call test("truth", test_truth)
      call test("document-values", test_document_values)
      call test("csv", test_csv)
      call test("mixed-units", test_mixed_units)
      call test("csv-channels", test_csv_channels)
   end subroutine suite_report

   !> The text of the report of the whole job.
   subroutine run_text(command, known, text)
      character(*), intent(in) :: command
      logical, intent(in) :: known
      character(:), allocatable, intent(out) :: text
      type(record_type) :: record
      type(pipeline_result_type) :: result

      call make_record(record, known)
      call make_result(record, result)
      call report_of(command, record, result, text)
   end subroutine run_text

   !> The report of a command.
   subroutine report_of(command, record, result, text)
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      character(:), allocatable, intent(out) :: text
      type(writer_type) :: writer

      call begin_text(writer)
      call write_report(writer, command, record, pipeline_options(), result)
      call end_text(writer, text)
   end subroutine report_of

   !> The longest line, in characters.
   integer function longest_line(text)
      character(*), intent(in) :: text
      integer :: first, length

      longest_line = 0
      first = 1
      do while (first <= len(text))
         length = index(text(first:), lf) - 1
         if (length < 0) length = len(text) - first + 1
         longest_line = max(longest_line, text_width(text(first:first + length - 1)))
         first = first + length + 1
      end do
   end function longest_line

   subroutine test_numbers()
      call check(error, fixed(-0.5_dp, 2)//" "//scientific(1.4883e-4_dp, 5)//" "//scientific(1.0e-120_dp, 2)//" "// &
                 p_value_text(0.031_dp)//" "//p_value_text(0.0_dp), "-0.50 1.4883e-04 1.0e-120 p = 0.031 p < 1e-20")
      call check(error, plural(1_int64, "gap")//", "//plural(0_int64, "gap"), "1 gap, 0 gaps")
   end subroutine test_numbers

   subroutine test_wrapping()
      type(writer_type) :: writer
      character(:), allocatable :: text

      call begin_text(writer)
      call put_item(writer, "File", repeat("abc ", 30)//repeat("x", 250))
      call put_heading(writer, "Title", "=")
      call end_text(writer, text)
      call check(error, longest_line(text), report_width)
      call check(error, text(:21) == "  File            abc" .and. index(text, lf//repeat(" ", 18)//"abc") > 0)
      call check(error, index(text, lf//lf//"Title"//lf//"====="//lf) > 0)
   end subroutine test_wrapping

   !> What was read, removed, tested, and what to make of it.
   subroutine test_run()
      character(130), parameter :: fragments(16) = [character(130) :: "12 in 1 channel: gx", "5 Hz (as the file says); 2.4 s", &
         "deg/s (as the option says)", "the stamps show 5.2 Hz", &
         "Outliers method auto, threshold 4.27 sigma, passes 2, removed 1,", &
         "coefficients of i^0, i^1, ... 0.0043 -2e-06", "Verdict stationary, flicker reasons a reason", &
         "Jarque-Bera nearly normal, a small departure is seen because the record is long: statistic 1.2, p = 0.55, ", &
         "skewness 0.013 +/- 0.022, kurtosis 3.250 +/- 0.045; the samples are correlated: the p-value is too small", &
         "p = 0.067, distance", "samples 5994, stride 2", &
         "quantized, step 0.0114, step over std 0.5, variance share 0.0208, levels 17", &
         "Ljung-Box not white: statistic 2030.00, p < 1e-20, lags 20, largest |rho| 0.41, at lag 3", &
         "The model predicts 16.8 % of the variance", "2.5 % of the samples (3) were removed", "drift identification: too few"]
      character(:), allocatable :: text, flat
      integer :: i

      call run_text("run", .true., text)
      call unwrap(text, flat)
      do i = 1, size(fragments)
         call check(error, index(flat, trim(fragments(i))) > 0, "missing: "//trim(fragments(i)))
      end do
      call check(error, index(flat, "KPSS") == 0, "tests of a unit root of all samples")
      call run_text("tests", .true., text)
      call unwrap(text, flat)
      call check(error, index(flat, "ADF unit root rejected at 5 %: statistic -71.5, p") > 0 &
            .and. index(flat, "KPSS level stationarity rejected at 5 %: statistic 0.84, p < 0.01, ") > 0 &
                 .and. index(flat, "p asymptotic 0.0058") > 0 .and. index(flat, "5% 0.463, 10% 0.347), long") > 0, flat)
   end subroutine test_run

   !> Line ends and rows of blanks become one blank.
   subroutine unwrap(text, flat)
      character(*), intent(in) :: text
      character(:), allocatable, intent(out) :: flat
      character(1) :: sign
      integer :: i, n

      flat = text
      n = 0
      do i = 1, len(text)
         sign = text(i:i)
         if (sign == lf) sign = " "
         if (sign == " " .and. n > 0) then
            if (flat(n:n) == " ") cycle
         end if
         n = n + 1
         flat(n:n) = sign
      end do
      flat = flat(:n)
   end subroutine unwrap

   !> Golden lines of the three tables. N: 0.0158 deg/sqrt(s) = 0.948 deg/sqrt(h); 80 % less after the AKF. B is lost in it:
   !> limit 3e-3*0.2 of 4e-3, so more than 85 % less.
   subroutine test_run_tables()
      character(100), parameter :: lines(8) = [character(100) :: &
         "    * 1  4.3600e-04  -58801.12  0.00  0.00  0.00  0.0000e+00  -4.900012", &
         "  KF (paper)  0.000e+00 1.4908e-04 28.4 % 0.48  0.6072 0.750   0.2 colored", &
         "  AKF (paper) 0.000e+00 2.0000e-05  3.8 % 0.48  0.2100 0.750   0.2 colored", &
         "             arcsec  deg/sqrt(h)    deg/h  deg/h^1.5  deg/h^2", &
         "  raw        < 10.8        0.948     14.4      < 648        -", "                       +/- 0.012  +/- 3.6", &
         "  AKF        < 2.16       0.1896   < 2.16      < 130        -", &
         "  reduction       -         80 %   > 85 %          -        -"]
      character(:), allocatable :: text
      integer :: i

      call run_text("run", .true., text)
      do i = 1, size(lines)
         call check(error, index(text, lf//trim(lines(i))//lf) > 0, "missing: "//trim(lines(i)))
      end do
   end subroutine test_run_tables

   !> The head of the report: a row for each channel, a table for each unit, numbers rounded to their errors.
   subroutine test_answer()
      character(100), parameter :: lines(3) = [character(100) :: &
         "      deg/s      deg/sqrt(h)         deg/h  deg/h^1.5    deg/h       s", &
         "  gx  0.001  0.948 +/- 0.012  14.4 +/- 3.6      < 648       18     100", "  Noise           stationary, flicker"]
      character(:), allocatable :: text
      integer :: i

      text = rounded(2.48376_dp, 0.0169_dp)//"; "//rounded(37.61_dp, 1.94_dp)//"; "//rounded(1873.0_dp, 351.0_dp)
      call check(error, text, "2.484 +/- 0.017; 37.6 +/- 1.9; 1870 +/- 350")
      text = rounded(6.1e-4_dp, 1.6e-4_dp)//"; "//rounded(0.5_dp, 0.0_dp)//"; "//rounded(1.25e-9_dp, 1.0e-11_dp)// &
             "; "//rounded(0.0341_dp, 9.96e-5_dp)
      call check(error, text, "0.00061 +/- 0.00016; 0.5; 1.25e-09 +/- 1e-11; 0.03410 +/- 0.00010")
      call run_text("run", .true., text)
      do i = 1, size(lines)
         call check(error, index(text(:900), lf//trim(lines(i))//lf) > 0, text(:900))
      end do
   end subroutine test_answer

   !> The first screen: what was read, a row for each channel, one chart, what several channels share told once.
   subroutine test_screen()
      character(6), parameter :: commands(4) = [character(6) :: "run", "tests", "ar", "filter"]
      character(100), parameter :: fragments(7) = [character(100) :: &
         "  Record          data/gyro.txt: 12 samples, 5 Hz", "  gx  0.001  0.948 +/- 0.012  14.4 +/- 3.6", &
         "  gz  0.001  0.948 +/- 0.012  14.4 +/- 3.6", "against tau in s: x gx, z gz", &
         "  Warning         gx, gz: of both", "  Warning         gz: of one", "  Note            the paper's filters pass"]
      character(:), allocatable :: text
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result
      integer :: i, lines

      call make_record(record, .true.)
      call make_result(record, result)
      if (allocated(result%channel(1)%warnings)) deallocate (result%channel(1)%warnings)
      call add_text(result%channel(1)%warnings, "of both")
      record%value = reshape([record%value, record%value], [12, 2])
      call add_text(record%channel, "gz")
      result%channel = [result%channel, result%channel]
      result%channel(2)%name = "gz"
      call add_text(result%channel(2)%warnings, "of one")
      do i = 1, size(commands)
         call begin_text(writer)
         call write_report(writer, trim(commands(i)), record, pipeline_options(), result, commands(i) == "run", .false.)
         call end_text(writer, text)
         lines = count([(text(lines:lines) == lf, lines=1, len(text))])
         call check(error, lines < 60 .and. longest_line(text) <= report_width .and. index(text, "Channel gx") == 0, text)
         if (i == 1) then
            do lines = 1, size(fragments)
               call check(error, index(text, trim(fragments(lines))) > 0, trim(fragments(lines))//": "//text)
            end do
            call check(error, index(text, "o measured") == 0 .and. index(text, "1/2") > 0, text)
         end if
      end do
   end subroutine test_screen

   !> Fisher's test and the spectrum.
   subroutine test_periodicity_text()
      character(:), allocatable :: wrapped, text

      call run_text("run", .true., wrapped)
      call unwrap(wrapped, text)
      call check(error, index(text, "Fisher's g slow changes stand out, less than 5 periods in the record: drift, &
            &not a period: statistic 0.3, p = 0.004, frequency 1.25 Hz, applied to the residuals of AR(1)") > 0)
      call check(error, index(text, "segment samples 4, segments 4, segments left out 1, ") > 0 .and. &
                 index(text, "resolution 1.25 Hz") > 0)
   end subroutine test_periodicity_text

   !> No rate, no unit: per sample and in input units, and which options would help.
   subroutine test_nothing_known()
      character(:), allocatable :: text, flat

      call run_text("run", .false., text)
      call unwrap(text, flat)
      call check(error, index(flat, "--rate HZ (or --dt S) gives") > 0 .and. index(flat, "--unit deg/s (or") > 0)
      call check(error, index(text, "input unit     input unit  input unit") > 0 .and. &
                 index(text, "*sqrt(sample)") > 0 .and. index(text, "0.0158") > 0)
      call check(error, index(text, "deg/sqrt(h) ") == 0 .and. index(text, "deg/s/sqrt(Hz)") == 0)
      call check(error, longest_line(text) <= report_width)
   end subroutine test_nothing_known

   !> A long path, a long name, huge numbers: never wider than 80 columns.
   subroutine test_width()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text

      call make_record(record, .true.)
      record%path = repeat("/a/long/path", 20)
      record%channel(1)%text = repeat(char(194)//char(176), 120)
      call make_result(record, result)
      result%channel(1)%name = record%channel(1)%text
      result%channel(1)%ar%table%aic = -1.23456789e9_dp
      result%channel(1)%ar%table%bic = -1.23456789e9_dp
      result%channel(1)%kf%mean = -1.0e-200_dp
      call report_of("run", record, result, text)
      call check(error, longest_line(text) <= report_width)
   end subroutine test_width

   !> The comparison of the halves.
   subroutine test_halves()
      character(:), allocatable :: text, flat

      call run_text("allan", .true., text)
      call unwrap(text, flat)
      call check(error, index(flat, "Second half against the first chi-square 60, degrees of freedom 2, &
            p = 1e-13") > 0, flat)
      check_level: block
         type(record_type) :: record
         type(pipeline_result_type) :: result

         call make_record(record, .true.)
         call make_result(record, result)
         call check(error, index(flat, "stationary, flicker ") > 0 .and. index(flat, "variance changes") == 0, flat)
         result%channel(1)%halves%ratio = 0.7_dp
         call report_of("allan", record, result, text)
         call check(error, index(text, "stationary, flicker, variance changes") > 0, text)
         result%channel(1)%verdict%drift = "undescribed"
         result%channel(1)%verdict%stationary = .false.
         result%channel(1)%raw%variance = 0
         call report_of("allan", record, result, text)
         call check(error, index(text, "  constant"//lf) > 0, "the verdict on a constant")
      end block check_level
   end subroutine test_halves

   !> The shorter reports say their part and keep the width.
   subroutine test_single_commands()
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text, flat

      call make_record(record, .true.)
      call make_result(record, result)
      call begin_text(writer)
      allocate (record%column(1))
      record%column(1)%name = "gx"
      record%column(1)%class = "angular rate"
      record%column(1)%unit = ""
      record%column(1)%channel = 1
      call report_inspect(writer, record)
      call write_report(writer, "allan", record, pipeline_options(), result)
      call write_report(writer, "tests", record, pipeline_options(), result)
      call write_report(writer, "ar", record, pipeline_options(), result)
      call write_report(writer, "filter", record, pipeline_options(), result)
      call end_text(writer, text)
      call check(error, longest_line(text) <= report_width)
      call check(error, index(text, "  1       gx    angular rate") > 0 .and. index(text, "analyzed"//lf) > 0)
      call check(error, index(text, "  0.2       0.02    0.018    0.022   11     11    0.02"//lf) > 0)
      call unwrap(text, flat)
      call check(error, index(flat, "steps at a bound 7") > 0)
      call check(error, index(flat, "N = 0.948 +/- 0.012 deg/sqrt(h), SI: ") > 0 &
            .and. index(flat, "K < 648 deg/h^1.5, SI: < ") > 0, flat)
      call check(error, index(flat, "minimum 18, at tau = 100 s") > 0, flat)
   end subroutine test_single_commands

   !> Writes a document and reads it back.
   subroutine document(record, items, valid, result, command_line)
      type(record_type), intent(in) :: record
      type(json_item), allocatable, intent(out) :: items(:)
      logical, intent(out) :: valid
      type(pipeline_result_type), intent(in), optional :: result
      character(*), intent(in), optional :: command_line
      type(writer_type) :: writer
      character(:), allocatable :: text

      call begin_text(writer)
      call write_document(writer, record, result, command_line)
      call end_text(writer, text)
      call read_json(text, items, valid)
   end subroutine document

   !> The command line as it was typed; null in documents of the library.
   subroutine test_command_line()
      type(record_type) :: record
      type(json_item), allocatable :: items(:)
      logical :: valid

      call make_record(record, .true.)
      call document(record, items, valid)
      call check(error, json_text_at(items, "/command_line"), "null")
      call document(record, items, valid, command_line="gyroakf inspect 'a b'"//lf)
      call check(error, json_text_at(items, "/command_line"), '"gyroakf inspect '//"'a b'"//'\u000a"')
   end subroutine test_command_line

   !> The drift in words, beside the paper's filters; found and not found.
   subroutine test_drift()
      character(110), parameter :: fragments(16) = [character(110) :: "no outliers 4.300e-03 5.5000e-04  100 %", &
         "drift KF 0.000e+00 1.0000e-05  1.8 % 0.48  1.0000 0.750   0.2 colored", &
         "smoother 0.000e+00 1.2000e-05  1.8 %       1.0000", "compensated 1.000e-06 5.3800e-04 97.8 %       0.0000", &
         "(95 % of such filters within 0.980 to 1.020)", "a rotation passes into it: estimate it at rest, only predict it", &
         "In-sample: the drift was taken from the same record", "forgetting 0.98, adapts R", &
         "Drift model found, of processes slower than 1 s, model ", "kind ar1, not drift, correlation time 0.224 +/- 0.012 s", &
         "kind walk, drift, standard deviation 1e-05, K 4.8 +/- 1.2 deg/h^1.5", &
         "white noise 0.0050 +/- 0.0021", "maximum likelihood from 12 samples", &
         "model walk+ar1, chosen, parameters ", "AIC -58726.91, BIC -58697.34", &
         "the paper's filters pass a constant rotation in part (DC gain: KF 61 %, AKF 21 %)"]
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text, flat
      integer :: i

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_drift(record, result%channel(1))
      call report_of("run", record, result, text)
      call check(error, longest_line(text) <= report_width)
      call check(error, index(text, lf//"  compensated  < 9.72       0.8532   < 9.72      < 583        -"//lf// &
                 "                         +/- 0.011"//lf) > 0)
      call unwrap(text, flat)
      do i = 1, size(fragments)
         call unwrap(trim(fragments(i)), text)
         call check(error, index(flat, trim(text)) > 0, "missing: "//trim(fragments(i)))
      end do
      result%channel(1)%available%drift_kf = .false.
      result%channel(1)%available%drift_akf = .false.
      result%channel(1)%available%drift_smoother = .false.
      result%channel(1)%drift%found = .false.
      result%channel(1)%drift%chosen = 1
      call report_of("run", record, result, text)
      call unwrap(text, flat)
      call check(error, index(flat, "Drift model not found") > 0 .and. index(flat, "In-sample") == 0 .and. &
                 index(flat, "there is nothing that a filter could follow") > 0, flat)
   end subroutine test_drift

   !> RMSE of two filters, in the report and in the document; nothing and null where the true drift is not known.
   subroutine test_truth()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(json_item), allocatable :: items(:)
      character(:), allocatable :: text, flat
      logical :: valid

      call run_text("run", .true., text)
      call check(error, index(text, "RMSE") == 0, "a truth that is not known")
      call make_record(record, .true.)
      call make_result(record, result)
      result%channel(1)%kf_figures%rmse = 0.0625_dp
      result%channel(1)%kf_figures%rmse_samples = 11
      result%channel(1)%drift_smoother_figures%rmse_samples = 12
      call report_of("run", record, result, text)
      call unwrap(text, flat)
      call check(error, index(flat, " samples 0.0625") > 0, flat)
      call document(record, items, valid, result)
      call check(error, json_real(items, "/channels/0/filters/kf/rmse"), 0.0625_dp, thr=1.0e-14_dp, rel=.true.)
      call check(error, json_text_at(items, "/channels/0/filters/akf/rmse"), "null")
   end subroutine test_truth

   subroutine test_document_values()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(json_item), allocatable :: items(:)
      character(*), parameter :: c = "/channels/0"
      logical :: valid

      call make_record(record, .true.)
      call make_result(record, result)
      call document(record, items, valid, result)
      call check(error, json_real(items, "/input/rate_hz"), 5.0_dp)
      call check(error, json_text_at(items, "/input/warnings/1"), &
                 '"gx: 2.5 % of the samples (3) were removed as outliers, at 0.2, 0.4 s"')
      call check(error, json_real(items, c//"/preprocess/trend/coefficients/3"), 1.25e-14_dp)
      call check(error, json_text_at(items, c//"/filters/kf/forgetting")//json_text_at(items, c//"/filters/akf/estimate/1"), &
                 'null"R"')
      call check(error, json_real(items, c//"/coefficients/akf/N/value"), 0.1896_dp, thr=1.0e-12_dp)
      call check(error, json_real(items, c//"/coefficients/akf/N/value_si")*10800, 0.1896_dp*acos(-1.0_dp), thr=1.0e-12_dp)
      call check(error, json_real(items, c//"/coefficients/akf/density/one_sided/value"), 0.00316_dp*sqrt(2.0_dp), thr=1.0e-15_dp)
      call check(error, json_real(items, c//"/coefficients/reduction_percent/N"), 80.0_dp, thr=1.0e-9_dp)
      call check(error, json_real(items, c//"/tests/adf/critical/1%"), -3.43_dp, thr=1.0e-12_dp)
      call check(error, json_real(items, c//"/tests/adf/critical/10%"), -2.57_dp, thr=1.0e-12_dp)
      call check(error, json_text_at(items, c//"/coefficients/reduction_percent/B")// &
                 json_text_at(items, c//"/coefficients/akf/R/value")//json_text_at(items, c//"/allan/compensated"), "nullnullnull")
   end subroutine test_document_values

   subroutine test_csv()
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text

      call make_record(record, .true.)
      call make_result(record, result)
      result%channel(1)%name = 'a,"b"'
      call begin_text(writer)
      call write_table(writer, "allan.csv", result, record%sample_interval)
      call write_table(writer, "coefficients.csv", result, record%sample_interval)
      call end_text(writer, text)
      call check(error, index(text, "channel,series,kind,tau,deviation,lower,upper,edf,terms,model"//lf// &
                              '"a,""b""",input,oadev,0.2,0.02,0.018,0.022,11,11,0.02'//lf) == 1)
      call check(error, index(text, lf//"channel,series,term,value,std_error,upper_limit_95,detected,unit,"// &
                              "reduction_percent,read_off,value_si,std_error_si,upper_limit_95_si,unit_si,definition,"// &
                              "state"//lf) > 0)
      call check(error, index(text, '"a,""b""",akf,N,0.1896,0.0024,0.036,true,deg/sqrt(h),80,0.96,5.5') > 0)
      call check(error, index(text, ',rad/sqrt(s),"sigma^2 = N^2/tau, two-sided density N^2",value'//lf) > 0)
      call check(error, index(text, '"a,""b""",kf,R,nan,nan,nan,false,deg/h^2,nan,nan,nan,nan,nan,rad/s^2,'// &
                              "sigma^2 = R^2 tau^2/2,"//lf) > 0)
   end subroutine test_csv

   !> Gyroscopes beside accelerometers: a unit for each channel, none for the record.
   subroutine test_mixed_units()
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(json_item), allocatable :: items(:)
      character(:), allocatable :: text
      logical :: valid

      call make_record(record, .true.)
      call make_result(record, result)
      deallocate (record%channel, record%value)
      allocate (record%channel(3), record%value(12, 3), record%channel_unit(3))
      record%value(:, :) = 0
      record%channel(1)%text = "gx"
      record%channel(2)%text = "gy"
      record%channel(3)%text = "ax"
      call parse_unit("deg/s", record%channel_unit(1), failed)
      record%channel_unit(2) = record%channel_unit(1)
      call parse_unit("mg", record%channel_unit(3), failed)
      record%unit = unit_type()
      deallocate (record%audit%minimum)
      call begin_text(writer)
      call report_inspect(writer, record)
      call end_text(writer, text)
      call check(error, index(text, "deg/s for gx, gy; mg for ax (as the option says)") > 0, text)
      call document(record, items, valid, result)
      call check(error, json_text_at(items, "/input/unit")//json_text_at(items, "/channels/0/unit"), 'null"deg/s"')
   end subroutine test_mixed_units

   !> Two channels stand side by side; missing is nan, but the filters bridge it.
   subroutine test_csv_channels()
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: one, two
      character(:), allocatable :: text
      integer :: c

      call make_record(record, .true.)
      call make_result(record, one)
      record%value = reshape([record%value(:, 1), -record%value(:, 1)], [12, 2])
      allocate (two%channel(2), record%present(12, 2))
      record%present(:, :) = 1
      record%present(2, 2) = 0
      do c = 1, 2
         two%channel(c) = one%channel(1)
         two%channel(c)%series_cleaned = 2*record%value(:, c)
         two%channel(c)%series_kf = 3*record%value(:, c)
         two%channel(c)%series_drift_akf = 4*record%value(:, c)
      end do
      two%channel(2)%series_drift = 5*record%value(:, 2)
      two%channel(2)%series_compensated = 6*record%value(:, 2)
      two%channel(2)%series_drift_kf = 7*record%value(:, 2)
      two%channel(2)%name = "gy"
      two%channel(2)%series_present = record%present(:, 2)
      call begin_text(writer)
      call write_series(writer, record, two, series_output_type(), failed)
      call end_text(writer, text)
      call check(error, index(text, "time,gx_raw,gx_cleaned,gx_kf,gx_akf,gx_drift,gx_compensated,gx_drift_kf,gx_drift_akf,"// &
                              "gy_raw,gy_cleaned,gy_kf,gy_akf,gy_drift,gy_compensated,gy_drift_kf,gy_drift_akf"//lf// &
                              "0,0.25,0.5,0.75,nan,nan,nan,nan,1,-0.25,-0.5,-0.75,nan,-1.25,-1.5,-1.75,-1"//lf// &
                              "0.2,0.5,1,1.5,nan,nan,nan,nan,2,nan,nan,-1.5,nan,-2.5,nan,-3.5,-2"//lf) == 1)
   end subroutine test_csv_channels

end module test_report
