/* SPDX-License-Identifier: MIT */
/*
 * gyroakf: random errors of gyroscopes, characterized and compensated. The C interface.
 *
 * Rules that hold for every function
 *
 * - A function that can fail returns GYROAKF_OK (0) or another value of enum gyroakf_status. Its last argument may be
 *   NULL; otherwise it is filled in either case: code, and a message in UTF-8 that says what is wrong (empty if nothing),
 *   with the members of options that it is about in grave accents.
 * - Nothing prints, stops the program, throws, or keeps state of its own. Every function may be called by several threads at the
 *   same time, each with a stack of 64 kB or more; a handle is for one thread at a time, but where it is const in all of them.
 *   Some functions hold a lock of OpenMP for moments, gyroakf_filter_step none. A forked child computes with one thread.
 * - const double * arrays hold evenly spaced samples; NaN marks a missing sample, an infinite value is an error unless
 *   its function says otherwise. No pointer of the caller is kept after the return, and nothing is changed behind a const.
 * - NULL for options means their defaults. Otherwise call the _init function of the struct first: it also writes
 *   struct_size, the version of the struct that the program was compiled with. Of an earlier version
 *   the members that it had are read, the others have their defaults; the size of a later version gives GYROAKF_NOT_SUPPORTED, any
 *   other GYROAKF_INVALID_ARGUMENT. Strings may be NULL: the default.
 * - A NULL where an array, a handle or a result is needed, a count <= 0, a number out of its range and an array of doubles at an
 *   address that is no multiple of 8 give GYROAKF_INVALID_ARGUMENT. A result that would overflow gives GYROAKF_NON_FINITE.
 * - After a failure results are not written, unless a function says otherwise. Results do not overlap each other or an input,
 *   unless a function says that they may: arrays that do, by a single byte, give GYROAKF_INVALID_ARGUMENT.
 * - Handles come from _new (recordings from _read and _parse, too) and go to _free, which accepts NULL. *out is NULL where
 *   these fail.
 * - The floating-point environment of the program - traps, direction of rounding, flushing of tiny numbers to zero, exception
 *   flags - is set aside on entry and is there again after the return: results do not depend on it. (Where it is the usual one
 *   gyroakf_filter_step leaves it in place, and may raise FE_INEXACT and FE_UNDERFLOW.) Threads of OpenMP that the program itself
 *   has started and changed are not looked after.
 * - The library works in the unit u of its input; times are in seconds.
 */
#ifndef GYROAKF_H
#define GYROAKF_H

#include <stddef.h>
#include <stdint.h>

#define GYROAKF_VERSION_MAJOR 0
#define GYROAKF_VERSION_MINOR 1
#define GYROAKF_VERSION_PATCH 0
#define GYROAKF_VERSION_STRING "0.1.0"
#define GYROAKF_VERSION (10000 * GYROAKF_VERSION_MAJOR + 100 * GYROAKF_VERSION_MINOR + GYROAKF_VERSION_PATCH)

#ifndef GYROAKF_API
#define GYROAKF_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------ status and release */

/* What a function returns. The numbers never change; new ones come at the end. */
enum gyroakf_status {
  GYROAKF_OK = 0,
  GYROAKF_INVALID_ARGUMENT = 1, /* an argument is out of its documented range */
  GYROAKF_TOO_FEW_SAMPLES = 2,  /* the series is too short for what was asked */
  GYROAKF_IO = 3,               /* a file cannot be opened, read or written */
  GYROAKF_PARSE = 4,            /* a file's content cannot be understood */
  GYROAKF_CONSTANT_INPUT = 5,   /* the series has no variance */
  GYROAKF_SINGULAR = 6,         /* a matrix is singular or a fit is perfect */
  GYROAKF_NOT_CONVERGED = 7,    /* an iteration did not converge */
  GYROAKF_UNSTABLE = 8,         /* a model is not stationary */
  GYROAKF_NON_FINITE = 9,       /* a value is infinite (or NaN where that is not allowed) */
  GYROAKF_NO_MEMORY = 10,       /* memory could not be allocated, or a size overflows */
  GYROAKF_NOT_SUPPORTED = 11,   /* a feature that this build does not have */
  GYROAKF_CANCELLED = 12,       /* the caller's callback asked to stop */
  GYROAKF_INTERNAL = 13,        /* a defect of the library */
  GYROAKF_USAGE = 14            /* (of the command line only) */
};

/* What went wrong. The caller owns it; there is nothing to free. */
typedef struct gyroakf_error {
  int32_t code;      /* enum gyroakf_status */
  char message[256]; /* always terminated; cut at a whole character where it would be longer */
} gyroakf_error;

/*
 * Progress callback, invoked several times a second on the calling thread while it waits; never concurrently.
 *   user   progress_user of the options
 *   stage  what is being done, as "reading"; valid during the call
 *   done   so much of total: bytes or samples
 *   total  0 where it is not known
 * Returns 0 to go on. Otherwise the long call frees what it holds and returns GYROAKF_CANCELLED; *out is then NULL, and other results
 * are not written. It may call the library, not with a handle that the long call works on; it must not longjmp or throw. The floating-point
 * environment is the default one meanwhile; what it changes of that does not last.
 */
typedef int32_t (*gyroakf_progress_fn)(void *user, const char *stage, int64_t done, int64_t total);

/*
 * A function whose name ends in _watched is the one above it with progress (NULL: no callback) and progress_user,
 * which is handed to it, before err. Others that may take long have both in their options.
 */

/* 10000*major + 100*minor + patch of the library that is linked; compare with GYROAKF_VERSION. */
GYROAKF_API int gyroakf_version(void);

/* "major.minor.patch"; static storage. */
GYROAKF_API const char *gyroakf_version_string(void);

/* A short text for a status, "unknown status" for a number that is none; static storage. */
GYROAKF_API const char *gyroakf_status_string(int status);

/* -------------------------------------------------------------------------------------------------------- recordings */

/* A recording: channels of evenly spaced samples, and what is known about them. */
typedef struct gyroakf_record gyroakf_record;

typedef struct gyroakf_reader_options {
  size_t struct_size;
  const char *format;        /* "auto" (default): by the content; "text", "npy", or raw numbers: "f64", "i16be", ... */
  const char *columns;       /* numbers from 1 or names, as "2" or "gx,gy"; NULL (default): all but the time column */
  const char *time_column;   /* number or name; "none": there is none; NULL (default): found by its name */
  int64_t skip;              /* lines of text, or bytes of raw numbers, that are left out at the start, >= 0; 0 */
  int32_t bad_lines_missing; /* 1: lines that cannot be read are missing samples; 0 (default): an error */
  const char *input;         /* "rate" (default), "increment" (angle per sample) or "angle"; rates are made of these */
  const char *unit;          /* of the values after scale: "deg/s", or one for each channel, separated by commas; NULL
                                (default): from the file, or unknown */
  double scale;              /* every value is multiplied by it, not 0; 1 */
  double rate_hz;            /* Hz; 0 (default): from the time stamps or the header */
  double from, to;           /* the part from <= time < to is kept, s from the start; 0, DBL_MAX */
  int64_t memory;            /* bytes that the process may use, else GYROAKF_NO_MEMORY; 0 (default): no limit */
  const char *resample;      /* how samples get their place: "index" (default), "nearest" or "linear" */
  const char *wrap;          /* where angles wrap, in units of the file: a number, "auto" (default) or "none" */
  int64_t channels;          /* raw numbers: columns, interleaved, >= 0; 0 (default): 1 */
  int32_t decimal_comma;     /* 1: every comma in the file is a decimal comma; 0 */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_reader_options;

GYROAKF_API void gyroakf_reader_options_init(gyroakf_reader_options *opt);

/*
 * Reads a recording.
 *   path  UTF-8; "-" is standard input
 *   out   the recording; free it with gyroakf_record_free
 * What the file says about rate, unit and columns is used, an option overrides it. GYROAKF_IO: the file cannot be
 * read; GYROAKF_PARSE: the message begins with FILE:LINE:COLUMN. Nothing but the file is touched.
 */
GYROAKF_API int gyroakf_record_read(const char *path, const gyroakf_reader_options *opt, gyroakf_record **out,
                                    gyroakf_error *err);

/*
 * The same for the content of a file that lies in memory.
 *   bytes  [n] as in the file; they are not needed any more after the return
 *   n      1 .. 2^47
 * Messages call it "<memory>".
 */
GYROAKF_API int gyroakf_record_parse(const void *bytes, int64_t n, const gyroakf_reader_options *opt, gyroakf_record **out,
                                     gyroakf_error *err);

/*
 * A recording of arrays of the caller, which are copied: for gyroakf_run.
 *   values    [channels][n] pointers to the samples of each channel; NaN: missing. GYROAKF_NON_FINITE: a value is infinite or beyond
 *             1e60 in magnitude
 *   channels  1 .. 100000
 *   n         samples of each channel, >= 1
 *   dt        sample interval, s, 1e-100 .. 1e100
 *   names     [channels], UTF-8; NULL, or a NULL of them: "column1", "column2", ...
 *   unit      as of gyroakf_reader_options: "deg/s", or one for each channel, separated by commas; NULL: unknown
 *   out       the recording; free it with gyroakf_record_free
 */
GYROAKF_API int gyroakf_record_new(const double *const *values, int32_t channels, int64_t n, double dt, const char *const *names,
                                   const char *unit, gyroakf_record **out, gyroakf_error *err);
GYROAKF_API int gyroakf_record_new_watched(const double *const *values, int32_t channels, int64_t n, double dt,
                                           const char *const *names, const char *unit, gyroakf_record **out,
                                           gyroakf_progress_fn progress, void *progress_user, gyroakf_error *err);

/* Samples of each channel, missing ones included; 0 for NULL. */
GYROAKF_API int64_t gyroakf_record_samples(const gyroakf_record *r);

/* Channels; 0 for NULL. In the functions below a channel counts from 0, and NULL comes back where there is no such one. */
GYROAKF_API int32_t gyroakf_record_channels(const gyroakf_record *r);

/* [samples] of a channel, in its unit, NaN where missing; all arrays and texts of a recording live as long as it does. */
GYROAKF_API const double *gyroakf_record_values(const gyroakf_record *r, int32_t channel);

/* [samples] 1 where the sample is present, 0 where it is missing; NULL where nothing is missing in any channel. */
GYROAKF_API const int8_t *gyroakf_record_present(const gyroakf_record *r, int32_t channel);

/* The name of a channel; "columnN" with the column of the file, from 1, where it has none. */
GYROAKF_API const char *gyroakf_record_name(const gyroakf_record *r, int32_t channel);

/* The unit of a channel, as "deg/s"; "" where it is unknown. */
GYROAKF_API const char *gyroakf_record_unit(const gyroakf_record *r, int32_t channel);

/* What a value times it is in rad/s, m/s^2 or rad; 0 where the unit is unknown or there is no such channel. */
GYROAKF_API double gyroakf_record_to_si(const gyroakf_record *r, int32_t channel);

/* s; 1 where the rate is unknown; 0 for NULL. */
GYROAKF_API double gyroakf_record_sample_interval(const gyroakf_record *r);

/* Where the rate is from: "option", "header", "timestamps", or "none" where it is unknown; NULL for NULL. */
GYROAKF_API const char *gyroakf_record_rate_source(const gyroakf_record *r);

/* As what the content was read: "text", "npy", or as "f64le"; NULL for NULL. */
GYROAKF_API const char *gyroakf_record_format(const gyroakf_record *r);

/* What the user should know, one sentence each, i from 0; 0 and NULL where there is nothing. */
GYROAKF_API int32_t gyroakf_record_warnings(const gyroakf_record *r);
GYROAKF_API const char *gyroakf_record_warning(const gyroakf_record *r, int32_t i);

typedef struct gyroakf_audit {
  size_t struct_size;          /* sizeof(gyroakf_audit), written by the caller */
  int64_t samples;             /* per channel, missing ones included */
  int64_t missing;             /* summed over the channels */
  int64_t bad_lines;           /* that could not be read and were taken as missing samples */
  int32_t has_stamps;          /* 1: there is a time column; without one the numbers below are 0 */
  double stamp_rate;           /* of the time stamps, Hz */
  double jitter_max;           /* largest distance of a time stamp from the even grid, s */
  int64_t gaps;                /* places where samples were lost */
  int64_t jumps;               /* those of them that are too long to be filled with missing samples */
  int64_t beats;               /* double steps at even distances, not counted as gaps */
  int64_t duplicates;          /* time stamps equal to the one before */
  int64_t backward_steps;      /* time stamps smaller than the one before */
  int64_t first_duplicate;     /* its line in the file, 0 where there is none */
  int64_t first_backward_step; /* the same */
  int64_t first_gap;           /* the same */
} gyroakf_audit;

/* What was found while reading. GYROAKF_INVALID_ARGUMENT: NULL, or struct_size is not that of this library. */
GYROAKF_API int gyroakf_record_audit(const gyroakf_record *r, gyroakf_audit *out);

GYROAKF_API void gyroakf_record_free(gyroakf_record *r);

/* -------------------------------------------------------------------------------------------------------- simulation */

/* Units as of the coefficients below, of u; no term, outlier or loss by default. */
typedef struct gyroakf_simulate_options {
  size_t struct_size;
  const char *preset;     /* "paper": 12000 samples at 5 Hz, only the seed is yours; NULL (default): what follows */
  int64_t samples;        /* >= 1; 12000 */
  int64_t seed;           /* any; the same seed gives the same numbers on every machine; 1140 */
  double rate_hz;         /* Hz, > 0; 5 */
  const char *unit;       /* u; NULL (default): "deg/s" */
  double q, n, b, k, r;   /* coefficients: u s, u sqrt(s), u, u/sqrt(s), u/s; >= 0, r of either sign */
  double ar_phi;          /* an AR(1) process of this coefficient, -1 < phi < 1, */
  double ar_variance;     /* and this stationary variance, u^2, >= 0 */
  double offset;          /* u */
  double outlier_size;    /* mean size of the outliers in standard deviations of the noise, >= 0 */
  int64_t outliers;       /* how many, 0 .. samples */
  double lsb;             /* step that values are rounded to, u, >= 0; 0: none */
  double missing;         /* share of the samples that are lost, 0 <= missing < 1 */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_simulate_options;

GYROAKF_API void gyroakf_simulate_options_init(gyroakf_simulate_options *opt);

/* A recording of one channel, "gx", with known noise; free it with gyroakf_record_free. opt must not be NULL. */
GYROAKF_API int gyroakf_simulate(const gyroakf_simulate_options *opt, gyroakf_record **out, gyroakf_error *err);

/* ----------------------------------------------------------------------------------------------------- the whole job */

/* What the program's command run finds out, as the JSON document that its --json writes (doc/schema.json). */
typedef struct gyroakf_result gyroakf_result;

typedef struct gyroakf_run_options {
  size_t struct_size;
  const char *preset;            /* "default" (also NULL), "paper": the paper's chain */
  int32_t tests, ar, filters, allan; /* 0: without this part; 1 */
  gyroakf_progress_fn progress;  /* progress callback, may cancel; NULL (default): none */
  void *progress_user;           /* handed to it; NULL */
} gyroakf_run_options;

GYROAKF_API void gyroakf_run_options_init(gyroakf_run_options *opt);

/*
 * Tests, models, filters and Allan deviation of every channel of a recording, which is not changed.
 *   out  the result; free it with gyroakf_result_free
 * A part that fails for a channel is null in the document, and "unavailable" says why. Where samples are missing the recording is
 * copied.
 */
GYROAKF_API int gyroakf_run(const gyroakf_record *r, const gyroakf_run_options *opt, gyroakf_result **out, gyroakf_error *err);

/* The document, UTF-8; it lives as long as the result. NULL for NULL. */
GYROAKF_API const char *gyroakf_result_json(const gyroakf_result *result);

GYROAKF_API void gyroakf_result_free(gyroakf_result *result);

/* --------------------------------------------------------------------------------------------------- Allan deviation */

/* A deviation curve: deviation, confidence limits and degrees of freedom over the averaging time. */
typedef struct gyroakf_allan gyroakf_allan;

typedef struct gyroakf_allan_options {
  size_t struct_size;
  const char *kind;    /* "oadev" (default, overlapping Allan), "adev", "mdev", "tdev", "hdev", "ohdev", "totdev" */
  const char *taus;    /* "octave" (default), "decade", "log:N" (N per decade), "all", or "0.5,1,2" in s */
  double confidence;   /* probability between the limits, 0 < c < 1; 0.683 */
  double min_coverage; /* share of a window that must be present, 0 < s <= 1; 0.9 */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_allan_options;

GYROAKF_API void gyroakf_allan_options_init(gyroakf_allan_options *opt);

/*
 * Deviation curve of a rate record.
 *   rate  [n] rates (means over their intervals), unit u
 *   n     samples, >= 2
 *   dt    sample interval, s, 1e-100 .. 1e100
 *   out   the curve; free it with gyroakf_allan_free
 * Limits and degrees of freedom are those of the noise type that is identified at each averaging time, until gyroakf_allan_fit has
 * fitted the curve. Cost O(n) for each averaging time; memory 8 bytes a sample.
 */
GYROAKF_API int gyroakf_allan_new(const double *rate, int64_t n, double dt, const gyroakf_allan_options *opt,
                                  gyroakf_allan **out, gyroakf_error *err);

/* Points of the curve; 0 for NULL. */
GYROAKF_API int64_t gyroakf_allan_size(const gyroakf_allan *a);

/* Arrays of gyroakf_allan_size values, ascending in tau; they live as long as the curve. NULL for NULL. */
GYROAKF_API const double *gyroakf_allan_tau(const gyroakf_allan *a);       /* averaging time, s */
GYROAKF_API const double *gyroakf_allan_deviation(const gyroakf_allan *a); /* unit u; tdev: u s */
GYROAKF_API const double *gyroakf_allan_lower(const gyroakf_allan *a);     /* lower confidence limit */
GYROAKF_API const double *gyroakf_allan_upper(const gyroakf_allan *a);     /* upper confidence limit */
GYROAKF_API const double *gyroakf_allan_edf(const gyroakf_allan *a);       /* equivalent degrees of freedom */

GYROAKF_API void gyroakf_allan_free(gyroakf_allan *a);

/* ------------------------------------------------------------------------------------------------ noise coefficients */

typedef struct gyroakf_fit_options {
  size_t struct_size;
  const char *terms; /* "auto" (default), or letters of "QNBKR": then all points in the range are fitted */
  double tau_min;    /* s, points below are left out; 0 */
  double tau_max;    /* s, points above are left out; DBL_MAX */
  double lsb;        /* step that the samples are rounded to, in the unit of the rate; 0 (default): none */
} gyroakf_fit_options;

GYROAKF_API void gyroakf_fit_options_init(gyroakf_fit_options *opt);

typedef struct gyroakf_coefficient {
  double value;       /* never negative; 0 where the term is not in the fit */
  double std_error;   /* standard error, 0 where the term is not in the fit */
  double upper_limit; /* one-sided; holds in at least 95 % of records */
  int32_t detected;   /* 1: state the value; 0: state the upper limit */
  int32_t fitted;     /* 1: there is a value or a limit; 0: the term was not asked for, or is withheld */
} gyroakf_coefficient;

/* Model: sigma^2 = 3 Q^2/tau^2 + N^2/tau + (2 ln 2/pi) B^2 + K^2 tau/3 + R^2 tau^2/2; two-sided PSDs.
 * The units are those for a rate in rad/s. */
typedef struct gyroakf_noise {
  gyroakf_coefficient q; /* quantization, rad */
  gyroakf_coefficient n; /* angle random walk, rad/sqrt(s) */
  gyroakf_coefficient b; /* bias instability, rad/s */
  gyroakf_coefficient k; /* rate random walk, rad/s^1.5 */
  gyroakf_coefficient r; /* ramp, rad/s^2 */
  double chi2_reduced;   /* of the chosen terms; about 1 where they describe the curve */
  int32_t points;        /* octaves of the curve that were fitted */
  int32_t left_out;      /* octaves before them that "auto" excluded: a filter in the sensor bends the curve there */
  int32_t cut_off;       /* octaves after them that "auto" excluded */
  int32_t described;     /* 0: no run of octaves follows the terms, and all coefficients are withheld */
  double tau_first;      /* first and last averaging time fitted, s */
  double tau_last;
  double chi2_probability; /* chance of a chi-square as large or larger */
  double floor;          /* relative departure of the variances from the terms, 0 where chance explains it */
  double kurtosis;       /* excess kurtosis of the white noise per sample, 0 where it is not significant */
  gyroakf_coefficient n_unquantized; /* sqrt(n^2 - lsb^2 dt/12); fitted 0 where lsb is of no account, or above 2 deviations */
  double lsb_ratio;      /* lsb over the standard deviation of the noise; DBL_MAX: no noise beside rounding */
} gyroakf_noise;

/*
 * Noise coefficients of a curve of kind "oadev": generalized least squares with non-negative terms at the octaves 1, 2, 4, ...
 * samples up to a quarter of the record, whatever averaging times the curve has. The curve is not changed. "auto" fits the
 * longest run of octaves that q n b k r describe and chooses among them. A coefficient has a value (detected 1), a limit
 * (detected 0), or is withheld (fitted 0): the record does not determine it.
 */
GYROAKF_API int gyroakf_noise_fit(const gyroakf_allan *a, const gyroakf_fit_options *opt, gyroakf_noise *out,
                                  gyroakf_error *err);

/*
 * The same; and the curve gets the limits and degrees of freedom of the noise that was fitted, which the program states, where there
 * is a description (described 1).
 */
GYROAKF_API int gyroakf_allan_fit(gyroakf_allan *a, const gyroakf_fit_options *opt, gyroakf_noise *out, gyroakf_error *err);

/* ---------------------------------------------------------------------------------------------------------- outliers */

typedef struct gyroakf_outlier_options {
  size_t struct_size;
  const char *method; /* "auto" (default), "pauta", "mad", "hampel", "none" */
  double threshold;   /* in standard deviations; 0 (default): the method's own */
  int32_t rounds;     /* at most, >= 1; 20; 1 is a single pass */
  int32_t half_width; /* hampel: samples on either side, 1 .. 100000; 25 */
  int32_t degree;     /* of the trend that the outliers are about, -1 (their mean or median) .. 9; 3 */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_outlier_options;

GYROAKF_API void gyroakf_outlier_options_init(gyroakf_outlier_options *opt);

typedef struct gyroakf_outliers {
  int64_t removed;           /* outliers */
  double expected;           /* so many the rule marks of as much white normal noise, on average */
  double threshold;          /* that was used, in standard deviations */
  double mean, variance;     /* of what is left, less its trend */
  double corrected_variance; /* of normal noise before its tails were cut off; 0 with hampel */
  int32_t rounds;            /* that were made */
  int32_t converged;         /* 1: the last one changed nothing */
} gyroakf_outliers;

/*
 * Marks the outliers of a series.
 *   x       [n], not modified
 *   inlier  [n] of the caller: 1 inlier, 0 outlier or missing
 *   out     NULL where the figures are not wanted
 */
GYROAKF_API int gyroakf_mark_outliers(const double *x, int64_t n, const gyroakf_outlier_options *opt, int8_t *inlier,
                                      gyroakf_outliers *out, gyroakf_error *err);

/*
 * The series without its outliers and its trend, as the program analyzes it: method "none" removes the trend alone, degree -1 the
 * outliers alone. The trend of degree 0 is the mean.
 *   x        [n], not modified
 *   cleaned  [n] of the caller: NaN where x is missing or an outlier
 *   out      NULL where the figures are not wanted
 */
GYROAKF_API int gyroakf_clean(const double *x, int64_t n, const gyroakf_outlier_options *opt, double *cleaned,
                              gyroakf_outliers *out, gyroakf_error *err);

/* ------------------------------------------------------------------------------------------------------ stationarity */

typedef struct gyroakf_adf_options {
  size_t struct_size;
  const char *regression; /* "n", "c" (default), "ct", "ctt": nothing, constant, trend, quadratic trend */
  int32_t lags;           /* -1 (default): chosen by the criterion */
  int32_t max_lags;       /* -1 (default): ceil(12 (n/100)^(1/4)) */
  const char *criterion;  /* "aic" (default), "bic", "t" */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_adf_options;

GYROAKF_API void gyroakf_adf_options_init(gyroakf_adf_options *opt);

typedef struct gyroakf_adf {
  double statistic;     /* the series is stationary at 5 % where it is below critical[1] */
  double p_value;       /* of the unit root, MacKinnon */
  double critical[3];   /* at 1 %, 5 %, 10 % */
  int32_t lag;          /* lags in the regression */
  int64_t observations; /* in the regression */
} gyroakf_adf;

/* Augmented Dickey-Fuller test of a series x [n]. Its null hypothesis is a unit root: the series is not stationary. */
GYROAKF_API int gyroakf_adf_test(const double *x, int64_t n, const gyroakf_adf_options *opt, gyroakf_adf *out,
                                 gyroakf_error *err);

typedef struct gyroakf_kpss_options {
  size_t struct_size;
  const char *regression; /* "c" (default), "ct": stationary about a level, about a line */
  const char *rule;       /* "auto" (default): Hobijn, Franses and Ooms; "legacy": floor(12 (n/100)^(1/4)) */
  int64_t lags;           /* bandwidth; -1 (default): by the rule */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_kpss_options;

GYROAKF_API void gyroakf_kpss_options_init(gyroakf_kpss_options *opt);

typedef struct gyroakf_kpss {
  double statistic;         /* the series is not stationary at 5 % where it is above critical[1] */
  double p_value;           /* of stationarity, interpolated in the published table; 0.01 and 0.10 at its ends */
  double p_asymptotic;      /* exact for a long series */
  double critical[4];       /* at 10 %, 5 %, 2.5 %, 1 % */
  double variance;          /* of the residuals */
  double long_run_variance; /* of the residuals */
  double drift;             /* height of the line ("ct": parabola) that drifts as much, in the unit of x */
  int64_t lags;             /* bandwidth */
  int64_t observations;     /* samples present */
  int32_t p_bound;          /* -1: p is below p_value, 0: it is p_value, 1: it is above */
} gyroakf_kpss;

/* KPSS test of a series x [n]. Its null hypothesis is that the series is stationary. */
GYROAKF_API int gyroakf_kpss_test(const double *x, int64_t n, const gyroakf_kpss_options *opt, gyroakf_kpss *out,
                                  gyroakf_error *err);

/* ---------------------------------------------------------------------------------------------------------- AR model */

typedef struct gyroakf_ar_options {
  size_t struct_size;
  const char *method;    /* "yw" (default): Yule-Walker; "burg"; "ols": least squares with intercept, whose
                            model may be not stationary */
  const char *criterion; /* "aic" (default), "aicc", "bic", "hqic", "fpe" */
  int32_t order;         /* -1 (default): chosen by the criterion; otherwise 0 .. max_order */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_ar_options;

GYROAKF_API void gyroakf_ar_options_init(gyroakf_ar_options *opt);

/*
 * Autoregressive model x_k - mean = sum phi_i (x_{k-i} - mean) + a_k.
 *   x               [n] series, unit u
 *   max_order       largest order that is compared, 0 .. 1000
 *   order           the order chosen, 0 .. max_order
 *   phi             [max_order] coefficients, the first *order of them; the rest are 0. NULL only if max_order is 0
 *   noise_variance  of a, u^2; may be NULL
 *   mean            of the series, u; may be NULL
 * On failure nothing but err is written.
 */
GYROAKF_API int gyroakf_ar_fit(const double *x, int64_t n, const gyroakf_ar_options *opt, int32_t max_order,
                               int32_t *order, double *phi, double *noise_variance, double *mean, gyroakf_error *err);

/* ------------------------------------------------------------------------------------------------------------ filter */

/* A Kalman filter of an AR(p) state, or of a drift (gyroakf_drift_filter_new), in white noise; fixed or adaptive (Sage-Husa). */
typedef struct gyroakf_filter gyroakf_filter;

typedef struct gyroakf_filter_options {
  size_t struct_size;
  int32_t estimate_process_mean;         /* 1: adapt the mean q of the process noise; 0 */
  int32_t estimate_measurement_mean;     /* 1: adapt the mean r of the measurement noise; 0 */
  int32_t estimate_process_variance;     /* 1: adapt its variance Q; 0 */
  int32_t estimate_measurement_variance; /* 1: adapt its variance R; 0 */
  double forgetting;                     /* factor b of the adaptation, 0 < b <= 1; 0.98 */
  const char *measurement_form;          /* how R follows: "residual" (default), "exact", "biased", "paper" */
  int32_t burn_in;                       /* measurements without adaptation; -1: until the gain has settled; 0 */
  double huber;                          /* innovations beyond so many deviations count less, 0.001 .. 1e6; 0 (default):
                                            no gate */
  double r_scale;                        /* what the bounds of R are multiples of (half the variance of the
                                            differences of z is good); 0 (default): r */
  double initial_variance;               /* variance of the state at the start; 0 (default): the stationary one */
  double q_lower, q_upper;               /* bounds of Q, multiples of q; 1e-3, 1e3 */
  double r_lower, r_upper;               /* bounds of R, multiples of r_scale; 1e-2, 1e2 */
  int32_t allow_unobservable;            /* 1: q and r may be adapted both, though a constant offset may be in either; 0: refused */
} gyroakf_filter_options;

GYROAKF_API void gyroakf_filter_options_init(gyroakf_filter_options *opt);

/*
 * A filter for z_k = x_k + v_k, x_k = sum phi_i x_{k-i} + w_k. The state has the mean zero: give it samples less their mean.
 *   p     order, 0 .. 1000; the time grows as p^2, as that of a step does (1000: some tenths of a second, some milliseconds)
 *   phi   [p] coefficients of a stationary model (NULL if p is 0)
 *   q, r  variances of w and v, u^2, >= 0, not both 0
 * The state starts at zero. GYROAKF_UNSTABLE: the model is not stationary.
 */
GYROAKF_API int gyroakf_filter_new(int32_t p, const double *phi, double q, double r, const gyroakf_filter_options *opt,
                                   gyroakf_filter **out, gyroakf_error *err);

/*
 * The filter that the program makes for a series (gyroakf_run, the command run): its model is identified, its start, its bounds and
 * scales are set.
 *   kind  "kf", "akf": the paper's Kalman and adaptive Kalman filter of the AR model of the cleaned series, which take that
 *         (gyroakf_clean with its defaults); "drift_kf", "drift_akf": those of the drift, which take the series with its trend
 *   x     [n] series, u, n >= 10; NaN: missing
 *   dt    sample interval, s, 1e-100 .. 1e100
 *   opt   preset, progress and progress_user count; may be NULL
 *   out   the filter before its first step; goes to gyroakf_filter_free
 *   mean  what the filter takes is a sample less this mean
 * GYROAKF_INVALID_ARGUMENT: no such kind, or the series has no drift. Others as those of the analysis: GYROAKF_TOO_FEW_SAMPLES,
 * GYROAKF_CONSTANT_INPUT, GYROAKF_SINGULAR, GYROAKF_UNSTABLE, GYROAKF_NOT_CONVERGED. Memory: 33 bytes a sample.
 */
GYROAKF_API int gyroakf_filter_identify(const char *kind, const double *x, int64_t n, double dt, const gyroakf_run_options *opt,
                                      gyroakf_filter **out, double *mean, gyroakf_error *err);

/*
 * One step in real time: takes the measurement z, writes the estimate to *x. No allocation, no lock, a bounded time.
 * A z that is NaN, infinite or beyond 1e149 is no measurement: the estimate is the prediction, and the status is GYROAKF_OK.
 * GYROAKF_NON_FINITE: the estimate overflows; *x is not written, and the filter is of no use until gyroakf_filter_reset.
 */
GYROAKF_API int gyroakf_filter_step(gyroakf_filter *f, double z, double *x);

/* frozen != 0: no adaptation from here on (while the sensor rotates); 0: again. The state goes on either way. */
GYROAKF_API int gyroakf_filter_freeze(gyroakf_filter *f, int32_t frozen);

/*
 * n steps: z [n] to x [n], the same numbers as step by step. x may be z itself; otherwise they do not overlap. A long series may be
 * given in parts, as the filter goes on where it was. After GYROAKF_NON_FINITE (as of a step) x may hold anything.
 */
GYROAKF_API int gyroakf_filter_run(gyroakf_filter *f, const double *z, int64_t n, double *x, gyroakf_error *err);

/*
 * The same, with a progress callback. After GYROAKF_CANCELLED the first values of x are the estimates of the steps that
 * were made (gyroakf_filter_get returns their number), and the filter continues from there.
 */
GYROAKF_API int gyroakf_filter_run_watched(gyroakf_filter *f, const double *z, int64_t n, double *x, gyroakf_progress_fn progress,
                                           void *progress_user, gyroakf_error *err);

typedef struct gyroakf_filter_state {
  double x;                   /* estimate */
  double p;                   /* its variance */
  double gain;                /* of the last measurement */
  double innovation;          /* of the last measurement */
  double innovation_variance; /* as the filter expected it */
  double q_mean, r_mean;      /* means q and r that the next step uses */
  double q, r;                /* variances Q and R that the next step uses */
  int64_t steps;              /* made so far, missing measurements included */
} gyroakf_filter_state;

/* What the filter holds after its last step. GYROAKF_NON_FINITE: a number of it overflows; *out is not written. */
GYROAKF_API int gyroakf_filter_get(const gyroakf_filter *f, gyroakf_filter_state *out);

GYROAKF_API void gyroakf_filter_free(gyroakf_filter *f);

/* The filter as it was made: no step, not frozen. Real-time threads keep away meanwhile: it allocates. */
GYROAKF_API int gyroakf_filter_reset(gyroakf_filter *f, gyroakf_error *err);

/*
 * The whole state of a filter as bytes, for a file or another process: the filter that gyroakf_filter_restore makes of them
 * continues with the same numbers to the last bit. They hold a version, their length and a checksum; the order of bytes is that
 * of the machine.
 *   bytes     [capacity] the caller's; NULL: nothing but *size is written
 *   capacity  bytes there are; too few: GYROAKF_INVALID_ARGUMENT, *size says how many it takes, bytes are not touched
 *   size      bytes written, or needed
 */
GYROAKF_API int gyroakf_filter_save(const gyroakf_filter *f, void *bytes, int64_t capacity, int64_t *size, gyroakf_error *err);

/*
 * The filter of bytes [size] that gyroakf_filter_save wrote; goes to gyroakf_filter_free. GYROAKF_PARSE: the bytes are none of a
 * filter, of another version of their form, of a machine with another order of bytes, cut short or damaged (the message says which).
 */
GYROAKF_API int gyroakf_filter_restore(const void *bytes, int64_t size, gyroakf_filter **out, gyroakf_error *err);

/* ------------------------------------------------------------------------------------------------------------- drift */

/*
 * Drift and noise: x_{i,k} = phi_i x_{i,k-1} + w_{i,k}, z_k = sum x_{i,k} + v_k, Var(w_i) = q_i, Var(v) = r. The drift is the sum
 * of the processes with slow != 0; the others are noise with a memory.
 */
typedef struct gyroakf_drift_model {
  size_t struct_size;
  int32_t count;   /* processes, 1 .. 3; 0: white noise alone, which gyroakf_drift_identify may find */
  double phi[3];   /* [count] -1 < phi < 1; one of them may be 1, a random walk */
  double q[3];     /* [count] u^2, >= 0 */
  double r;        /* u^2, >= 0 */
  int32_t slow[3]; /* [count] 1: part of the drift; 0 */
} gyroakf_drift_model;

/* No process, r = 0. */
GYROAKF_API void gyroakf_drift_model_init(gyroakf_drift_model *model);

typedef struct gyroakf_drift_options {
  size_t struct_size;
  double drift_samples; /* correlation time in samples from which a process counts as drift, > 0; 5 */
  int64_t most_samples; /* samples that the likelihood uses at most, >= 50; 131072 */
  gyroakf_progress_fn progress; /* progress callback, may cancel; NULL (default): none */
  void *progress_user;          /* handed to it; NULL */
} gyroakf_drift_options;

GYROAKF_API void gyroakf_drift_options_init(gyroakf_drift_options *opt);

/*
 * The drift and the white noise of a record, identified from the record itself: random walk, AR(1), or both, by exact Gaussian
 * likelihood on the middle of the record, with block means of the whole of it for drifts that are slower (a second at most for
 * the default part, some milliseconds per million samples for the rest).
 *   z      [n] series, u, n >= 50; any offset; NaN: missing
 *   opt    may be NULL
 *   model  initialized by gyroakf_drift_model_init; where none of its processes is slow, no drift was found
 * On failure nothing but err is written. GYROAKF_TOO_FEW_SAMPLES, GYROAKF_CONSTANT_INPUT, GYROAKF_NON_FINITE, GYROAKF_NO_MEMORY,
 * GYROAKF_NOT_CONVERGED (no model has a likelihood with a maximum).
 */
GYROAKF_API int gyroakf_drift_identify(const double *z, int64_t n, const gyroakf_drift_options *opt, gyroakf_drift_model *model,
                                       gyroakf_error *err);

/*
 * A filter whose estimate is the drift: every gyroakf_filter_ function works on it; x, p and gain of its state are those of the
 * drift, q the sum of its variances. One process at least must be slow.
 *   opt  as gyroakf_filter_new, but only R can be adapted (estimate_measurement_variance, with "residual", "exact" or "biased");
 *        forgetting 0.995, huber 2.5 and burn_in -1 are good there
 */
GYROAKF_API int gyroakf_drift_filter_new(const gyroakf_drift_model *model, const gyroakf_filter_options *opt, gyroakf_filter **out,
                                         gyroakf_error *err);

/*
 * The drift of a whole record from the samples before and behind (fixed-interval smoother), also where samples are missing.
 *   z         [n] series, u; NaN: missing; one at least is there
 *   drift     [n] gets the drift
 *   variance  [n] gets the variance of its error under the model, which flicker noise (B without K in a noise fit) does not
 *             follow: there it is too small; may be NULL
 *   opt       NULL, or estimate_measurement_variance 0: the white noise is r throughout. 1: its variance is followed through the
 *             record by the adaptive filter with these options, forwards and backwards, before the record is smoothed
 * On failure, but that of refused arguments, drift and variance may hold anything. Memory: some sqrt(n) states; with
 * estimate_measurement_variance 8 n bytes more.
 */
GYROAKF_API int gyroakf_drift_smooth(const gyroakf_drift_model *model, const double *z, int64_t n, double *drift, double *variance,
                                     const gyroakf_filter_options *opt, gyroakf_error *err);
GYROAKF_API int gyroakf_drift_smooth_watched(const gyroakf_drift_model *model, const double *z, int64_t n, double *drift,
                                             double *variance, const gyroakf_filter_options *opt, gyroakf_progress_fn progress,
                                             void *progress_user, gyroakf_error *err);

#ifdef __cplusplus
}
#endif

#endif /* GYROAKF_H */
