! SPDX-License-Identifier: MIT
!> The texts of `--help`, `--version`, `--citation`, of a bare call and of the manual page (`--man`,
!> in roff); the options in them come from [[gyroakf_app_option]].
module gyroakf_app_help
   use gyroakf_app_option, only : belongs_to, commands_of, explained, option_names
   use gyroakf_app_option_table, only : all_names, commands, groups, option_type, options
   use gyroakf_release, only : release_string
   use gyroakf_spelling, only : replace_all
   implicit none (type, external)
   private
   public :: program_help, command_help, usage_text, citation_text, manual_text

   character(*), parameter :: nl = new_line("a")

   !> Column at which the explanations begin, and the last one that is written on
   integer, parameter :: first_column = 31, last_column = 98

   !> What stands in the help and in the manual page
   character(*), parameter :: about = "gyroscope noise: Allan variance, AR models, adaptive "// &
      "Kalman filters"
   character(*), parameter :: usage = "gyroakf [COMMAND] FILE... [OPTIONS]"
   character(*), parameter :: usage_notes = "FILE may be - (standard input); -- ends the "// &
      "options. Several files, or --list FILE: each is processed independently, then all are "// &
      "summarized; exit code: the highest of all files."
   character(*), parameter :: run_is_default = "Without a COMMAND gyroakf does the whole job (run)."
   character(*), parameter :: reading_notes = "Begin with gyroakf inspect FILE. "// &
      "Text and NumPy's .npy are recognized by their content; both may be compressed by gzip; "// &
      "zstd comes through a pipe. A header in the file (# rate_hz: 5, # unit: deg/h, "// &
      "# columns: t gx gy gz) is used; "// &
      "an option overrides it. Without a rate or a unit, results are per sample and in input units."
   character(*), parameter :: exit_codes = &
      "Exit codes: 0 done; 1 wrong usage; 2 the data or a file; 3 a numerical failure; 130 Ctrl-C."

   !> What `--citation` names
   character(150), parameter :: references(4) = [character(150) :: &
      "Yi et al., Random Errors Compensation method of Autoregressive Adaptive Kalman Filter "// &
      "based on MEMS Gyroscope.", &
      "W. J. Riley and D. A. Howe, Handbook of Frequency Stability Analysis, NIST SP 1065 "// &
      "(2008).", &
      "IEEE Std 952, Specification Format Guide and Test Procedure for Single-Axis "// &
      "Interferometric Fiber Optic Gyros, annex C.", &
      "A. P. Sage and G. W. Husa, Adaptive filtering with unknown prior statistics, Joint "// &
      "Automatic Control Conference (1969)."]

   !> Commands and examples of them
   character(92), parameter :: examples(2, 29) = reshape([character(92) :: &
      "run", "gyroakf log.csv --rate 100 --unit deg/s", &
      "run", "gyroakf run log.csv --column gx,gy,gz --time-column t --unit deg/s --out results", &
      "run", "gyroakf run mems.txt --preset paper --json - > results.json", &
      "run", "gyroakf run day/*.csv --rate 100 --unit deg/s --out results", &
      "run", "zstd -dc log.csv.zst | gyroakf run - --rate 100 --unit deg/s --out results", &
      "inspect", "gyroakf inspect log.csv", &
      "inspect", "gyroakf inspect log.csv --column gx,gy,gz --time-column time_ms --json -", &
      "inspect", "gyroakf inspect imu.bin --format i16be --channels 6 --skip 512 --rate 200", &
      "inspect", "gyroakf inspect counter.npy --input angle --unit deg --scale 0.01 --rate 100", &
      "inspect", &
        "gyroakf inspect increments.dat --input increment --unit arcsec --scale 0.1 --rate 100", &
      "allan", "gyroakf allan log.csv --rate 100 --unit deg/s", &
      "allan", "gyroakf allan log.csv.gz --rate 200 --unit rad/s --taus log:20 --json -", &
      "allan", &
        "gyroakf allan log.csv --terms NBK --fit-tau-min 0.1 --fit-tau-max 1000 --out results", &
      "allan", "gyroakf allan log.csv --kinds mdev,ohdev --out results", &
      "allan", "find day -name '*.csv' | gyroakf allan --list - --rate 100 --out results", &
      "allan", &
        "gyroakf allan imu.csv --unit rad/s,rad/s,rad/s,m/s^2,m/s^2,m/s^2 --kalibr imu.yaml", &
      "tests", "gyroakf tests log.csv --outliers auto --detrend 3", &
      "tests", "gyroakf tests log.csv --adf-regression ct --adf-lags 4 --adf-table", &
      "ar", "gyroakf ar log.csv --outliers auto --detrend 3 --ar-criterion bic", &
      "filter", "gyroakf filter log.csv --outliers auto --detrend 3 --order 1 --out results", &
      "filter", "gyroakf filter log.csv --akf robust --forgetting 0.995", &
      "filter", "gyroakf filter log.csv --rate 1000 --out results --series-format npy", &
      "simulate", "gyroakf simulate --preset paper --output mems.txt", &
      "simulate", "gyroakf simulate --preset adis16405 --warmup 0.01,600 --output adis16405.npy", &
      "simulate", &
        "gyroakf simulate --samples 360000 --rate 100 --coefficients N=0.005,B=0.001 --seed 7", &
      "simulate", &
        "gyroakf simulate --rate 10 --coefficients N=0.005 --ar 0.99 --ar-variance 1e-4", &
      "simulate", &
        "gyroakf simulate --ar 0.7,-0.2 --ar-variance 1e-4 --missing 0.003 | gyroakf run -", &
      "simulate", &
        "gyroakf simulate --samples 1000000 --rate 100 --coefficients N=0.005 --output still.npy", &
      "selftest", "gyroakf selftest"], [2, 29])

contains

   !> What `--citation` prints.
   function citation_text() result(text)
      character(:), allocatable :: text

      text = "gyroakf "//release_string// &
         ": random errors of gyroscopes, characterized and compensated."//nl//nl//"The method:"// &
         nl//wrapped(trim(references(1)), 3)//"The Allan deviation and its uncertainty:"//nl// &
         wrapped(trim(references(2)), 3)//wrapped(trim(references(3)), 3)// &
         "The adaptive filter:"//nl//wrapped(trim(references(4)), 3)
   end function citation_text

   !> What a bare `gyroakf` prints.
   function usage_text() result(text)
      character(:), allocatable :: text

      text = "gyroakf "//release_string//": "//about//nl//"Usage: "//usage//nl// &
         "  gyroakf inspect log.csv"//nl//"  gyroakf allan log.csv --rate 100 --unit deg/s"//nl// &
         "  gyroakf log.csv --rate 100 --unit deg/s --out results"//nl// &
         "Commands and options: gyroakf help"
   end function usage_text

   !> What `gyroakf --help` and `gyroakf --help=all` print.
   function program_help(whole) result(text)
      !> All options, not only the most used
      logical, intent(in) :: whole
      character(:), allocatable :: text
      integer :: i

      text = "gyroakf "//release_string//": "//about//nl//nl//"Usage: "//usage//nl// &
         wrapped(usage_notes, 8)//nl//"Commands"//nl
      do i = 1, size(commands, 2)
         text = text//"  "//all_names(i)//"  "//trim(commands(2, i))//nl
      end do
      text = text//nl//run_is_default//nl// &
         sections(trim(merge("any     ", "frequent", whole)))//nl//"Examples"//nl
      do i = 1, size(examples, 2)
         if (any(examples(1, :i - 1) == examples(1, i))) cycle
         text = text//"  "//trim(examples(2, i))//nl
      end do
      text = text//nl//wrapped(reading_notes, 1)//exit_codes//nl// &
         "More options: gyroakf help COMMAND shows those of a command, gyroakf --help=all "// &
         "shows all."//nl
   end function program_help

   !> What `gyroakf COMMAND --help` prints.
   function command_help(command) result(text)
      !> A known command
      character(*), intent(in) :: command
      character(:), allocatable :: text
      integer :: i

      text = "gyroakf "//command//": "// &
         trim(commands(2, findloc(all_names, command, dim=1)))//nl//nl//"Usage: gyroakf "//command
      if (command /= "simulate" .and. command /= "selftest") text = text//" FILE..."
      text = text//" [OPTIONS]"//nl//sections(command)//nl//"Examples"//nl
      do i = 1, size(examples, 2)
         if (examples(1, i) == command) text = text//"  "//trim(examples(2, i))//nl
      end do
   end function command_help

   !> The titles and their options, as far as a command knows them.
   function sections(command) result(text)
      !> A command; "any" for all options, "frequent" for the most used
      character(*), intent(in) :: command
      character(:), allocatable :: text, lines
      integer :: i, j
      logical :: shown

      text = ""
      do i = 1, size(groups)
         lines = ""
         do j = 1, size(options)
            shown = command == "any" .or. (command == "frequent" .and. options(j)%frequent) .or. &
               belongs_to(options(j), command)
            if (options(j)%group /= groups(i)%name .or. .not. shown) cycle
            lines = lines//option_lines(options(j))
         end do
         if (lines /= "") text = text//nl//trim(groups(i)%title)//nl//lines
      end do
   end function sections

   !> The lines of one option: name and value, then what it does, wrapped.
   function option_lines(option) result(text)
      type(option_type), intent(in) :: option
      character(:), allocatable :: text, line

      line = "  "//option_names(option)//" "//trim(option%value)
      text = ""
      if (len_trim(line) > first_column - 3) then
         text = trim(line)//nl
         line = ""
      end if
      text = text//wrapped(explained(option), first_column, line)
   end function option_lines

   !> A text in lines that begin at a column and end at [[last_column]].
   function wrapped(text, column, begun) result(lines)
      character(*), intent(in) :: text
      !> Where the lines begin, 1 at the margin
      integer, intent(in) :: column
      !> What stands in the first line already, shorter than that
      character(*), intent(in), optional :: begun
      character(:), allocatable :: lines, line, rest
      integer :: cut, width

      width = last_column - column + 1
      lines = ""
      line = ""
      if (present(begun)) line = begun
      rest = text
      do while (len(rest) > 0)
         line = line//repeat(" ", max(0, column - 1 - len(line)))
         cut = len(rest)
         if (cut > width) cut = index(rest(:width + 1), " ", back=.true.) - 1
         lines = lines//line//rest(:cut)//nl
         rest = trim(adjustl(rest(cut + 1:)))
         line = ""
      end do
   end function wrapped

   !> What `--man` prints.
   function manual_text() result(text)
      character(:), allocatable :: text
      integer :: i, j

      text = '.TH GYROAKF 1 "" "gyroakf '//release_string//'" "User Commands"'//nl// &
         ".SH NAME"//nl//"gyroakf \- "//roff(about)//nl//".SH SYNOPSIS"//nl//".B gyroakf"//nl// &
         "[\fICOMMAND\fR] \fIFILE\fR... [\fIOPTIONS\fR]"//nl//".SH DESCRIPTION"//nl// &
         roff(usage_notes)//nl//".PP"//nl//roff(reading_notes)//nl//".SH COMMANDS"//nl
      do i = 1, size(commands, 2)
         text = text//".TP"//nl//".B "//trim(commands(1, i))//nl//roff(trim(commands(2, i)))//nl
      end do
      text = text//".PP"//nl//roff(run_is_default)//nl//".SH OPTIONS"//nl
      do i = 1, size(groups)
         text = text//".SS "//roff(trim(groups(i)%title))//nl
         do j = 1, size(options)
            if (options(j)%group == groups(i)%name) text = text//manual_entry(options(j))
         end do
      end do
      text = text//".SH EXAMPLES"//nl//".nf"//nl
      do i = 1, size(examples, 2)
         text = text//roff(trim(examples(2, i)))//nl
      end do
      text = text//".fi"//nl//".SH EXIT STATUS"//nl//roff(exit_codes)//nl//".SH REFERENCES"//nl
      do i = 1, size(references)
         if (i > 1) text = text//".PP"//nl
         text = text//roff(trim(references(i)))//nl
      end do
   end function manual_text

   function manual_entry(option) result(text)
      type(option_type), intent(in) :: option
      character(:), allocatable :: text

      text = ".TP"//nl//"\fB"//roff(option_names(option))//"\fR"
      if (option%value /= "") text = text//" \fI"//roff(trim(option%value))//"\fR"
      text = text//nl//roff(explained(option))//nl//".br"//nl//"Commands: "// &
         trim(commands_of(option))//"."//nl
   end function manual_entry

   !> A text as roff takes it literally: backslashes and hyphens escaped, no line that begins like a
   !> request.
   function roff(text) result(escaped)
      character(*), intent(in) :: text
      character(:), allocatable :: escaped

      escaped = text
      call replace_all(escaped, "\", "\e")
      call replace_all(escaped, "-", "\-")
      if (scan(text(:min(1, len(text))), ".'") > 0) escaped = "\&"//escaped
   end function roff

end module gyroakf_app_help
