! SPDX-License-Identifier: MIT
!> The table of all options and commands: parsing, ranges, `--help`, the manual page, completion,
!> files of options and the suggestions for misspelt names are made from it.
!>
!> A new option is a row here and a case in [[gyroakf_app_settings]] or [[gyroakf_app_simulation]].
module gyroakf_app_option_table
   use gyroakf_kinds, only : dp
   use gyroakf_preprocess_local_outliers, only : largest_half_width
   implicit none (type, external)
   private
   public :: option_type, options, commands, all_names, command_names, groups

   !> One row
   type :: option_type
      !> With its dashes
      character(20) :: name = ""
      !> What stands for its value in the help; of "choice" and "choices" the words, separated by |
      character(64) :: value = ""
      !> flag: no value; all: no value, or =all; text; choice: one of the words; choices: some of
      !> them, separated by commas; real; positive; share: 0 < x <= 1; natural: 0, 1, ...;
      !> count: 1, 2, ...; reals, positives: numbers separated by commas; size: bytes. Where words
      !> in lower case stand before |, they may be given instead of a number
      character(9) :: kind = "flag"
      !> Under which title of the help it stands; no file of options has those of the group common
      character(6) :: group = "common"
      !> What it does
      character(190) :: help = ""
      !> The commands that know it, where they are not those of the group
      character(51) :: commands = ""
      !> Short form with its dash, "" for none
      character(2) :: short = ""
      !> Shown by `gyroakf --help`, which leaves the others to `--help=all`
      logical :: frequent = .false.
      !> Range of a number, both ends in it; the upper one stands in the help
      real(dp) :: lower = -huge(1.0_dp), upper = huge(1.0_dp)
      !> The library's argument that it sets, where that is not its name with underscores
      character(18) :: argument = ""
   end type option_type

   !> A title of the help
   type :: group_type
      character(6) :: name = ""
      character(28) :: title = ""
      !> Those that know its options
      character(51) :: commands = ""
   end type group_type

   !> Name and purpose of the commands, in the order of the help; the first one needs no name
   character(90), parameter :: commands(2, 10) = reshape([character(90) :: &
      "run", &
      "the whole job: clean, test, model, filter, Allan analysis before and after (default)", &
      "inspect", "what the file holds: format, columns, rate, gaps, jitter, repeats, range, step", &
      "allan", &
      "deviation with limits, coefficients Q N B K R with errors, change during the record", &
      "tests", "stationarity, normality, quantization, whiteness, periodicity of the series", &
      "ar", "order table by every criterion, coefficients with standard errors, residuals", &
      "filter", "Kalman filter and adaptive Kalman filter: filtered series and diagnostics", &
      "simulate", "a record with known noise: Q N B K R, AR terms, trend, outliers, seed", &
      "selftest", "verify this build against published vectors and exact values", &
      "help", "this text; gyroakf help COMMAND: that of a command", &
      "version", "the version"], [2, 10])

   !> Their names, and those of the commands with options: without help and version, which stand
   !> for --help and --version
   character(8), parameter :: all_names(*) = commands(1, :)(:8)
   character(8), parameter :: command_names(*) = all_names(:size(all_names) - 2)

   character(*), parameter :: analyzing = "run allan tests ar filter"
   character(*), parameter :: reading = "run inspect allan tests ar filter"
   character(*), parameter :: any_command = reading//" simulate selftest"

   !> In the order of the help
   type(group_type), parameter :: groups(*) = [ &
      group_type("input", "Reading", reading), &
      group_type("preset", "Preset", "run"), &
      group_type("clean", "Cleaning", analyzing), &
      group_type("tests", "Tests", "run tests"), &
      group_type("ar", "AR model", "run ar filter"), &
      group_type("filter", "Filters", "run filter"), &
      group_type("allan", "Allan analysis", "run allan"), &
      group_type("record", "The simulated record", "simulate"), &
      group_type("output", "Results", reading), &
      group_type("work", "Files, threads, memory", reading), &
      group_type("common", "Common", any_command)]

   !> Largest AR order and number of lags of a regression
   real(dp), parameter :: most_lags = 1000.0_dp
   !> More threads than this are a slip of the finger
   real(dp), parameter :: most_threads = 4096.0_dp

   type(option_type), parameter :: input_options(*) = [ &
      option_type("--rate", "HZ", "positive", "input", &
         "sample rate; overrides header and time stamps", frequent=.true., argument="rate_hz"), &
      option_type("--dt", "S", "positive", "input", "sample interval, instead of --rate"), &
      option_type("--unit", "UNIT[,...]", "text", "input", "unit of the values: rad/s, deg/s, "// &
         "deg/h, mdps, m/s^2, g, mg, ...; of the angle (rad, deg, arcsec) with --input "// &
         "increment or angle; a list has one unit for each channel", frequent=.true.), &
      option_type("--input", "rate|increment|angle", "choice", "input", "what the values are: "// &
         "rates (default), angle increments per sample, or accumulated angles"), &
      option_type("--wrap", "auto|none|VALUE", "positive", "input", &
         "where the angles of --input angle begin again, in units of the file, as 65536 or "// &
         "360; auto (default): the range of the integers of a binary file"), &
      option_type("--resample", "index|nearest|linear", "choice", "input", &
         "how samples get their place: by their index at the mean rate (default), on the slot "// &
         "of the grid nearest to their time stamp, or interpolated onto the grid by the stamps"), &
      option_type("--scale", "F", "real", "input", "multiply every value by F"), &
      option_type("--column", "N|NAME[,...]", "text", "input", &
         "columns to read (default: all but the time)", frequent=.true., argument="columns"), &
      option_type("--time-column", "N|NAME|none", "text", "input", "column of the time stamps "// &
         "(default: found by its name, else by its even rise)", frequent=.true.), &
      option_type("--time-unit", "UNIT", "text", "input", "unit of the time column: s, ms, us, "// &
         "ns, min, h, or a multiple such as 100us (default: by its name, else by its values)"), &
      option_type("--format", "auto|text|csv|npy|f64|f32|i16|...", "text", "input", &
         "how the file is written (default auto: by its content); raw numbers: f32 f64 i8 i16 "// &
         "i32 i64 u8 u16 u32, with be behind it where they are big endian: i16be"), &
      option_type("--channels", "N", "count", "input", &
         "columns of raw numbers, interleaved (default 1)"), &
      option_type("--skip", "N", "natural", "input", &
         "leave out the first N lines of a text, or the first N bytes before raw numbers"), &
      option_type("--where", "COLUMN=VALUE", "text", "input", "read only the rows that hold "// &
         "VALUE in that column, as of one of several sensors in a file"), &
      option_type("--from", "S", "real", "input", "begin S seconds after the first sample", &
         frequent=.true.), &
      option_type("--to", "S", "positive", "input", "end S seconds after the first sample", &
         frequent=.true.), &
      option_type("--decimal-comma", "", "flag", "input", &
         "every comma in the file is a decimal comma, as in 1,5; recognized by itself where "// &
         "semicolons, tabs or blanks part the columns"), &
      option_type("--bad-lines", "error|missing", "choice", "input", "a line that cannot be "// &
         "read is an error (default), or marked missing and counted", argument="bad_lines_missing")]

   type(option_type), parameter :: series_options(*) = [ &
      option_type("--preset", "paper", "choice", "preset", "the paper's chain to the letter: 3 "// &
         "sigma, cubic trend, AIC over AR(1..3), b = 0.98; other options change it"), &
      option_type("--outliers", "none|auto|pauta|mad|hampel", "choice", "clean", &
         "mark outliers missing; auto: Pauta's rule with the threshold for the record's "// &
         "length, robust (default in run, else none); hampel: in a moving window"), &
      option_type("--outlier-threshold", "K", "positive", "clean", "threshold in standard "// &
         "deviations (default: pauta, hampel 3; mad 4.5; auto by the length)"), &
      option_type("--outlier-rounds", "N", "count", "clean", "most rounds (default 20); 1: a "// &
         "single pass over the samples, as the textbook has it", upper=1000.0_dp), &
      option_type("--outlier-window", "K", "count", "clean", &
         "hampel compares a sample with K on either side (default 25); 3 marks 4.8 % of clean "// &
         "noise, 10 1.4 %, 25 0.7 %, 100 0.4 %", upper=real(largest_half_width, dp)), &
      option_type("--detrend", "none|DEGREE", "natural", "clean", &
         "remove a polynomial trend of this degree (default: 3 in run, else none)", upper=9.0_dp), &
      option_type("--adf-regression", "n|c|ct|ctt", "choice", "tests", &
         "terms of the ADF regression: none, constant (default), trend, quadratic trend"), &
      option_type("--adf-lags", "auto|N", "natural", "tests", &
         "lags of the ADF regression (default auto: chosen)", upper=most_lags), &
      option_type("--adf-criterion", "aic|bic|t", "choice", "tests", &
         "what chooses the lags (default aic)"), &
      option_type("--adf-max-lags", "auto|N", "natural", "tests", &
         "lags to choose from (default auto: 12 (n/100)^(1/4))", upper=most_lags), &
      option_type("--adf-table", "", "flag", "tests", &
         "show the coefficients of the ADF regression with their standard errors"), &
      option_type("--kpss-regression", "c|ct", "choice", "tests", "what the KPSS test takes "// &
         "the series to be stationary about: a level (default) or a line"), &
      option_type("--kpss-lags", "auto|N", "natural", "tests", &
         "bandwidth of the KPSS test (default auto: from the correlation)", upper=100000.0_dp), &
      option_type("--lags", "N", "count", "tests", "lags of the autocorrelation "// &
         "(correlation.csv) and of the test of whiteness (default 20)", upper=4096.0_dp), &
      option_type("--welch-segment", "auto|S", "positive", "tests", &
         "segments of Welch's spectrum in seconds (default auto: a power of two samples of "// &
         "which 8 fit, at most 16384)"), &
      option_type("--ar-method", "yw|burg|ols", "choice", "ar", "Yule-Walker by the Levinson "// &
         "recursion (default), Burg's recursion, or least squares with intercept"), &
      option_type("--ar-criterion", "aic|aicc|bic|hqic|fpe", "choice", "ar", &
         "what chooses the order (default aic)"), &
      option_type("--max-order", "N", "natural", "ar", &
         "largest order compared (default: 12 in ar, else 3)", upper=most_lags), &
      option_type("--order", "N", "natural", "ar", "take this order", upper=most_lags), &
      option_type("--akf", "paper|robust", "choice", "filter", "the adaptive filter: the "// &
         "paper's Sage-Husa on Q and R (default), or on R only in residual form"), &
      option_type("--forgetting", "B", "share", "filter", "forgetting factor b of the adaptive "// &
         "filters (default 0.98; 0.995 for those of the drift)"), &
      option_type("--estimate", "q,r,Q,R", "text", "filter", "what the adaptive filter of "// &
         "--akf adapts: means q and r, variances Q and R (default Q,R; robust: R)"), &
      option_type("--r-factor", "F", "positive", "filter", &
         "R of the Kalman filter is F times the variance of the series (default 1)"), &
      option_type("--drift-tau", "S", "positive", "filter", &
         "what is slower than this counts as drift (default: the larger of 5 samples and 1 s)"), &
      option_type("--kinds", "oadev|adev|mdev|tdev|hdev|ohdev|totdev", "choices", "allan", &
         "further kinds of deviation, separated by commas; the terms are fitted to oadev, "// &
         "which is always there"), &
      option_type("--taus", "octave|decade|log:N|all|LIST", "text", "allan", &
         "averaging times (default octave); log:N has N a decade, LIST is seconds separated by "// &
         "commas"), &
      option_type("--confidence", "P", "share", "allan", &
         "probability between the limits of the deviations (default 0.683)"), &
      option_type("--min-coverage", "P", "share", "allan", "share of a window that must be "// &
         "present where samples are missing (default 0.9; 1: all of it)"), &
      option_type("--terms", "auto|QNBKR", "text", "allan", &
         "terms of the fit, e.g. NBK, at all averaging times in its range (default auto: those "// &
         "of QNBKR that the curve asks for, at the longest run of octaves that they describe)"), &
      option_type("--fit-tau-min", "S", "positive", "allan", &
         "the fit begins at this averaging time (default: the first)", argument="tau_min"), &
      option_type("--fit-tau-max", "S", "positive", "allan", &
         "the fit ends at this averaging time (default: the last)", argument="tau_max")]

   type(option_type), parameter :: record_options(*) = [ &
      option_type("--preset", "paper|adis16405|adis16405-xl|mti-g|xsens-dot|ring-laser|mpu6050", &
         "choice", "record", "the paper's record: 12000 samples at 5 Hz, AR(1), cubic trend, "// &
         "12 outliers; or a stand-in of a sensor's recording; other options change it"), &
      option_type("--samples", "N", "count", "record", "number of samples (default 12000)"), &
      option_type("--rate", "HZ", "positive", "record", "sample rate (default 5)"), &
      option_type("--dt", "S", "positive", "record", "sample interval, instead of --rate"), &
      option_type("--unit", "UNIT", "text", "record", "unit of the values (default deg/s)"), &
      option_type("--seed", "N", "natural", "record", &
         "seed of the random numbers (default 1140)"), &
      option_type("--coefficients", "Q=..,N=..,B=..,K=..,R=..", "text", "record", &
         "noise terms in the output unit u and seconds: Q in u s, N in u sqrt(s), B in u, K in "// &
         "u/sqrt(s), R in u/s"), &
      option_type("--tails", "normal|laplace|t5|mixture", "choice", "record", &
         "distribution of the white noise N at the same variance: normal (default), Laplace, "// &
         "Student's t with 5 degrees of freedom, two normal distributions of standard "// &
         "deviations 1:8"), &
      option_type("--ar", "PHI[,...]", "reals", "record", "coefficients of an AR(p) term"), &
      option_type("--ar-variance", "V", "positive", "record", "variance of the AR(p) term"), &
      option_type("--markov", "SIGMA,T[,...]", "positives", "record", "first-order "// &
         "Gauss-Markov processes: standard deviation and correlation time in s of each"), &
      option_type("--vibration", "AMPLITUDE,HZ,WIDTH[,...]", "positives", "record", &
         "vibration lines: narrow-band noise with the power of a sine of that amplitude, "// &
         "frequency and width at half the power in Hz"), &
      option_type("--warmup", "A,S", "reals", "record", "warm-up A exp(-t/S)"), &
      option_type("--motion", "NUMBER,SIZE,S[,END]", "positives", "record", &
         "half sines of height SIZE and length S seconds, of random sign, at random places "// &
         "(before END seconds)"), &
      option_type("--trend", "C0[,C1,...]", "reals", "record", &
         "trend, in powers of the sample index 0, 1, ..."), &
      option_type("--offset", "X", "real", "record", "constant rate"), &
      option_type("--outlier-count", "N", "natural", "record", "number of outliers"), &
      option_type("--outlier-size", "K", "real", "record", &
         "their size in standard deviations of the rest"), &
      option_type("--contamination", "SHARE,SIGMA", "positives", "record", &
         "outliers in this share of the samples, of 4 to SIGMA standard deviations of the rest"), &
      option_type("--lowpass", "HZ[,ORDER]", "positives", "record", &
         "Butterworth low-pass filter of order 1 (default) or 2 on everything but outliers, "// &
         "rounding and losses, which come after it"), &
      option_type("--resonance", "HZ,Q", "positives", "record", "mechanical resonance, as a "// &
         "low-pass section of second order with quality factor Q, 0.5 to 100"), &
      option_type("--lsb", "STEP", "positive", "record", "round the values to multiples of STEP"), &
      option_type("--missing", "P", "real", "record", "share of the samples lost at random", &
         lower=0.0_dp, upper=0.9_dp), &
      option_type("--output", "FILE", "text", "record", &
         "write FILE instead of standard output; FILE.npy and FILE.f64 are binary"), &
      option_type("--truth", "FILE", "text", "record", &
         "write the true drift too: all but quantization and white noise (Q, N), vibration, "// &
         "motion, outliers, rounding and losses; filtered as the record")]

   type(option_type), parameter :: common_options(*) = [ &
      option_type("--out", "DIR", "text", "output", "write the results as files into DIR, "// &
         "report.html among them; of many files into a folder each", short="-o", frequent=.true.), &
      option_type("--json", "FILE", "text", "output", "write the results (of many files the "// &
         "summary) as JSON; - is standard output", frequent=.true.), &
      option_type("--kalibr", "FILE", "text", "output", "write N and K as Kalibr's imu.yaml: "// &
         "SI, of each sensor the largest axis; needs rate and unit; of many files into the "// &
         "folder of each", commands="run allan", frequent=.true.), &
      option_type("--series-format", "csv|npy|f64", "choice", "output", "how --out writes the "// &
         "series: series.csv (default), series.npy or series.f64 (float64, a row per sample: "// &
         "time, and of each channel raw, cleaned, kf, akf)", commands="run filter"), &
      option_type("--digits", "N", "natural", "output", &
         "significant digits of series and records as text (default 0: as few as read back to "// &
         "the same number)", commands="run filter simulate"), &
      option_type("--truth", "FILE", "text", "output", "the true drift (simulate --truth, a "// &
         "reference sensor) on the record's grid: RMSE of every filter", commands="run filter"), &
      option_type("--chart", "on|off", "choice", "output", "draw the Allan deviation in "// &
         "characters in the report (default on)", commands="run allan"), &
      option_type("--color", "auto|always|never", "choice", "output", "colors in the report "// &
         "on standard output; auto (default): on a terminal, unless NO_COLOR is set"), &
      option_type("--ascii", "", "flag", "output", &
         "the report on standard output in ASCII (default where the locale is not UTF-8)"), &
      option_type("--details", "", "flag", "output", "print every table, test and model "// &
         "(default: one screen)", commands=analyzing, frequent=.true.), &
      option_type("--force", "", "flag", "output", "overwrite existing files that are no "// &
         "results of gyroakf; without it they are kept", commands=any_command), &
      option_type("--quiet", "", "flag", "output", "print no report", &
         commands=reading//" selftest", short="-q", frequent=.true.), &
      option_type("--list", "FILE", "text", "work", &
         "work on the files named in FILE too, one a line; - is standard input"), &
      option_type("--threads", "N", "count", "work", "number of threads (default: all)", &
         commands=any_command, upper=most_threads), &
      option_type("--memory", "SIZE", "size", "work", &
         "memory that may be used, 28MB or more, as 500MB or 2GB (default: 0.95 of what is "// &
         "free); a recording that needs more is refused", lower=28e6_dp), &
      option_type("--progress", "auto|on|off", "choice", "work", "how far long work is, on "// &
         "standard error; auto (default): on a terminal, after a second", commands=any_command), &
      option_type("--config", "FILE", "text", "common", &
         "take options from FILE, name = value a line; those of the command line come on top"), &
      option_type("--write-config", "FILE", "text", "common", "write all options into FILE, "// &
         "those that are not given as comments; without a recording nothing else is done"), &
      option_type("--help", "", "all", "common", "the most used options, or all of a command; "// &
         "--help=all: all options", short="-h", frequent=.true.), &
      option_type("--version", "", "flag", "common", "the version", short="-V", frequent=.true.), &
      option_type("--citation", "", "flag", "common", "what to cite"), &
      option_type("--man", "", "flag", "common", "the manual page, for man -l -"), &
      option_type("--completion", "bash|zsh|fish", "choice", "common", &
         "a script that completes commands, options and their words")]
   !> All options
   type(option_type), parameter :: options(*) = [input_options, series_options, record_options, &
      common_options]

end module gyroakf_app_option_table
