/* SPDX-License-Identifier: MIT */
/*
 * gyroakf from C++17: gyroakf.h with handles that free themselves, exceptions, containers, and callbacks that may throw. Header
 * only, and nothing is computed here. What a function does, units and ranges are said in gyroakf.h at its namesake.
 *
 *     std::vector<double> rate = ...;
 *     gyroakf::allan curve(rate, 0.01);                          // 0.01 s between the samples
 *     gyroakf::noise noise = gyroakf::fit_noise(curve);
 *     std::cout << noise.n.value << " +- " << noise.n.std_error;
 *
 * - A failure throws gyroakf::error: code() is the status, what() the message. Memory that C++ cannot get is std::bad_alloc.
 * - Classes own a handle: they move, and do not copy. Moved from they are empty: sizes are 0, arrays and texts empty, what can fail
 *   fails with GYROAKF_INVALID_ARGUMENT. A const object may be used by several threads at a time, as the handle.
 * - Series are anything with data() and size(): std::vector, std::array, std::span, arrays of C, or {pointer, size}.
 * - Options are the structs of C, initialised: gyroakf::allan_options opt; opt.kind = "mdev". Their texts must live until the call.
 * - A progress function returns true to go on, false to stop (the call then throws GYROAKF_CANCELLED); an exception in it stops the
 *   call and comes out of it.
 */
#ifndef GYROAKF_HPP
#define GYROAKF_HPP

#include <gyroakf.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace gyroakf {

/* What went wrong. */
class error : public std::runtime_error {
 public:
  error(int code, const char *message)
      : std::runtime_error(message[0] != '\0' ? message : gyroakf_status_string(code)), code_(code) {}
  int code() const noexcept { return code_; } /* enum gyroakf_status */

 private:
  int code_;
};

/* Told how far a long call is: stage, done, total (0: not known). Returns true to go on. */
using progress = std::function<bool(const char *stage, std::int64_t done, std::int64_t total)>;

/* An array that belongs to somebody else, read only. Those that objects return live as long as the object. */
template <class T>
class view {
 public:
  using value_type = T;
  constexpr view() noexcept = default;
  template <class N, class = std::enable_if_t<std::is_integral_v<N>>>
  constexpr view(const T *data, N size) noexcept : data_(data), size_(std::max<std::int64_t>(static_cast<std::int64_t>(size), 0)) {}
  template <class C, class = std::enable_if_t<std::is_convertible_v<decltype(std::data(std::declval<const C &>())), const T *>>>
  constexpr view(const C &c) : view(std::data(c), std::size(c)) {}

  constexpr const T *data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return static_cast<std::size_t>(size_); }
  constexpr std::int64_t count() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr const T *begin() const noexcept { return data_; }
  constexpr const T *end() const noexcept { return data_ + size_; }
  constexpr const T &operator[](std::size_t i) const noexcept { return data_[i]; }
  std::vector<T> to_vector() const { return std::vector<T>(begin(), end()); }

 private:
  const T *data_ = nullptr;
  std::int64_t size_ = 0;
};

using series = view<double>;

/* ------------------------------------------------------------------------------------- options and results: those of C */

struct reader_options : gyroakf_reader_options {
  reader_options() { gyroakf_reader_options_init(this); }
};
struct simulate_options : gyroakf_simulate_options {
  simulate_options() { gyroakf_simulate_options_init(this); }
};
struct run_options : gyroakf_run_options {
  run_options() { gyroakf_run_options_init(this); }
};
struct allan_options : gyroakf_allan_options {
  allan_options() { gyroakf_allan_options_init(this); }
};
struct fit_options : gyroakf_fit_options {
  fit_options() { gyroakf_fit_options_init(this); }
};
struct outlier_options : gyroakf_outlier_options {
  outlier_options() { gyroakf_outlier_options_init(this); }
};
struct adf_options : gyroakf_adf_options {
  adf_options() { gyroakf_adf_options_init(this); }
};
struct kpss_options : gyroakf_kpss_options {
  kpss_options() { gyroakf_kpss_options_init(this); }
};
struct ar_options : gyroakf_ar_options {
  ar_options() { gyroakf_ar_options_init(this); }
};
struct filter_options : gyroakf_filter_options {
  filter_options() { gyroakf_filter_options_init(this); }
};
struct drift_options : gyroakf_drift_options {
  drift_options() { gyroakf_drift_options_init(this); }
};
struct drift_model : gyroakf_drift_model {
  drift_model() { gyroakf_drift_model_init(this); }
};

using audit = gyroakf_audit;
using coefficient = gyroakf_coefficient;
using noise = gyroakf_noise;
using adf = gyroakf_adf;
using adf_coefficient = gyroakf_adf_coefficient;
using kpss = gyroakf_kpss;
using whiteness = gyroakf_whiteness;
using fisher = gyroakf_fisher;
using filter_state = gyroakf_filter_state;

/* ----------------------------------------------------------------------------------------------------------- inner parts */

namespace detail {

template <auto Free>
struct deleter {
  template <class T>
  void operator()(T *handle) const noexcept {
    Free(handle);
  }
};
template <class T, auto Free>
using handle = std::unique_ptr<T, deleter<Free>>;

inline void check(int status, const gyroakf_error &err) {
  if (status != GYROAKF_OK) throw error(status, err.message);
}

/* A text of a handle; NULL comes where there is no such one. */
inline std::string text(const char *t) {
  if (t == nullptr) throw error(GYROAKF_INVALID_ARGUMENT, "there is no such channel or text");
  return t;
}

/* Stands between the library and a progress function for one call. */
class listener {
 public:
  template <class Options>
  listener(Options &opt, const progress &function) : function_(function) {
    if (!function_) return;
    opt.progress = &listener::tell;
    opt.progress_user = this;
  }
  listener(const listener &) = delete;
  listener &operator=(const listener &) = delete;

  void check(int status, const gyroakf_error &err) const {
    if (thrown_) std::rethrow_exception(thrown_);
    detail::check(status, err);
  }

 private:
  static std::int32_t tell(void *user, const char *stage, std::int64_t done, std::int64_t total) noexcept {
    listener &self = *static_cast<listener *>(user);
    try {
      return self.function_(stage, done, total) ? 0 : 1;
    } catch (...) { /* no exception passes through the library */
      self.thrown_ = std::current_exception();
      return 1;
    }
  }

  const progress &function_;
  std::exception_ptr thrown_;
};

/* A progress function as C takes it where there are no options. */
struct watch {
  gyroakf_progress_fn progress = nullptr;
  void *progress_user = nullptr;
};

} // namespace detail

/* Of the library that is linked; GYROAKF_VERSION is that of the header. */
inline int version() noexcept { return gyroakf_version(); }
inline std::string_view version_string() noexcept { return gyroakf_version_string(); }

/* -------------------------------------------------------------------------------------------------------- recordings */

class recording {
 public:
  explicit recording(gyroakf_record *owned) noexcept : handle_(owned) {}

  static recording read(const std::string &path, gyroakf_reader_options opt = reader_options(), const progress &f = {}) {
    detail::listener listener(opt, f);
    gyroakf_error err;
    gyroakf_record *out = nullptr;
    const int status = gyroakf_record_read(path.c_str(), &opt, &out, &err);
    recording r(out);
    listener.check(status, err);
    return r;
  }
  /* Of samples in memory, which are copied: a series for each channel, all as long. names may be empty, unit nullptr. */
  static recording of(view<series> channels, double dt, view<std::string> names = {}, const char *unit = nullptr,
                      const progress &f = {}) {
    std::vector<const double *> values;
    std::vector<const char *> words;
    for (const series &channel : channels) {
      if (channel.size() != channels[0].size()) throw error(GYROAKF_INVALID_ARGUMENT, "the channels differ in length");
      values.push_back(channel.data());
    }
    if (!names.empty() && names.size() != channels.size()) throw error(GYROAKF_INVALID_ARGUMENT, "there is a name for every channel");
    for (const std::string &name : names) words.push_back(name.c_str());
    detail::watch watch;
    detail::listener listener(watch, f);
    gyroakf_error err;
    gyroakf_record *out = nullptr;
    const auto number = static_cast<std::int32_t>(std::min<std::int64_t>(channels.count(), std::numeric_limits<std::int32_t>::max()));
    const int status = gyroakf_record_new_watched(values.data(), number, channels.empty() ? 0 : channels[0].count(), dt,
                                                  names.empty() ? nullptr : words.data(), unit, &out, watch.progress,
                                                  watch.progress_user, &err);
    recording r(out);
    listener.check(status, err);
    return r;
  }
  /* What a file would hold. */
  static recording parse(std::string_view bytes, gyroakf_reader_options opt = reader_options(), const progress &f = {}) {
    detail::listener listener(opt, f);
    gyroakf_error err;
    gyroakf_record *out = nullptr;
    const int status = gyroakf_record_parse(bytes.data(), static_cast<std::int64_t>(bytes.size()), &opt, &out, &err);
    recording r(out);
    listener.check(status, err);
    return r;
  }

  std::int64_t samples() const noexcept { return gyroakf_record_samples(get()); }
  std::int32_t channels() const noexcept { return gyroakf_record_channels(get()); }
  /* Channels count from 0; of one that is not there these throw. */
  series values(std::int32_t channel) const {
    const double *values = gyroakf_record_values(get(), channel);
    if (values == nullptr) throw error(GYROAKF_INVALID_ARGUMENT, "there is no such channel");
    return {values, samples()};
  }
  /* Empty where nothing is missing in any channel. */
  view<std::int8_t> present(std::int32_t channel) const noexcept {
    const std::int8_t *present = gyroakf_record_present(get(), channel);
    return {present, present == nullptr ? 0 : samples()};
  }
  std::string name(std::int32_t channel) const { return detail::text(gyroakf_record_name(get(), channel)); }
  std::string unit(std::int32_t channel) const { return detail::text(gyroakf_record_unit(get(), channel)); }
  double to_si(std::int32_t channel) const noexcept { return gyroakf_record_to_si(get(), channel); }
  double sample_interval() const noexcept { return gyroakf_record_sample_interval(get()); }
  std::string rate_source() const { return detail::text(gyroakf_record_rate_source(get())); }
  std::string format() const { return detail::text(gyroakf_record_format(get())); }
  std::vector<std::string> warnings() const {
    std::vector<std::string> all;
    for (std::int32_t i = 0; i < gyroakf_record_warnings(get()); i++) all.push_back(detail::text(gyroakf_record_warning(get(), i)));
    return all;
  }
  gyroakf::audit audit() const {
    gyroakf::audit out{};
    out.struct_size = sizeof out;
    const int status = gyroakf_record_audit(get(), &out);
    if (status != GYROAKF_OK) throw error(status, "there is no recording");
    return out;
  }

  const gyroakf_record *get() const noexcept { return handle_.get(); }

 private:
  detail::handle<gyroakf_record, gyroakf_record_free> handle_;
};

inline recording simulate(gyroakf_simulate_options opt, const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  gyroakf_record *out = nullptr;
  const int status = gyroakf_simulate(&opt, &out, &err);
  recording r(out);
  listener.check(status, err);
  return r;
}

/* The whole job; returns its JSON document. */
inline std::string run(const recording &r, gyroakf_run_options opt = run_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  gyroakf_result *out = nullptr;
  const int status = gyroakf_run(r.get(), &opt, &out, &err);
  const detail::handle<gyroakf_result, gyroakf_result_free> result(out);
  listener.check(status, err);
  return detail::text(gyroakf_result_json(out));
}

/* --------------------------------------------------------------------------------------------------- Allan deviation */

class allan {
 public:
  explicit allan(gyroakf_allan *owned) noexcept : handle_(owned) {}
  allan(series rate, double dt, gyroakf_allan_options opt = allan_options(), const progress &f = {}) {
    detail::listener listener(opt, f);
    gyroakf_error err;
    gyroakf_allan *out = nullptr;
    const int status = gyroakf_allan_new(rate.data(), rate.count(), dt, &opt, &out, &err);
    handle_.reset(out);
    listener.check(status, err);
  }

  std::size_t size() const noexcept { return static_cast<std::size_t>(gyroakf_allan_size(get())); }
  series tau() const noexcept { return {gyroakf_allan_tau(get()), size()}; }
  series deviation() const noexcept { return {gyroakf_allan_deviation(get()), size()}; }
  series lower() const noexcept { return {gyroakf_allan_lower(get()), size()}; }
  series upper() const noexcept { return {gyroakf_allan_upper(get()), size()}; }
  series edf() const noexcept { return {gyroakf_allan_edf(get()), size()}; }

  const gyroakf_allan *get() const noexcept { return handle_.get(); }

 private:
  detail::handle<gyroakf_allan, gyroakf_allan_free> handle_;
};

inline noise fit_noise(const allan &curve, const gyroakf_fit_options &opt = fit_options()) {
  gyroakf_error err;
  noise out;
  detail::check(gyroakf_noise_fit(curve.get(), &opt, &out, &err), err);
  return out;
}

struct noise_covariance : gyroakf_noise {
  std::array<double, 25> covariance{}; /* [5 i + j] of q n b k r */
};

inline noise_covariance fit_noise_covariance(const allan &curve, const gyroakf_fit_options &opt = fit_options()) {
  gyroakf_error err;
  noise_covariance out{};
  detail::check(gyroakf_noise_covariance(curve.get(), &opt, &out, out.covariance.data(), &err), err);
  return out;
}

/* ---------------------------------------------------------------------------------------------------------- outliers */

struct outliers : gyroakf_outliers {
  std::vector<std::int8_t> inlier; /* 1 inlier, 0 outlier or missing */
};

inline outliers mark_outliers(series x, gyroakf_outlier_options opt = outlier_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  outliers out{};
  out.inlier.resize(x.size());
  listener.check(gyroakf_mark_outliers(x.data(), x.count(), &opt, out.inlier.data(), &out, &err), err);
  return out;
}

/* ------------------------------------------------------------------------------------------------------ stationarity */

inline adf adf_test(series x, gyroakf_adf_options opt = adf_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  adf out;
  listener.check(gyroakf_adf_test(x.data(), x.count(), &opt, &out, &err), err);
  return out;
}

inline std::vector<adf_coefficient> adf_coefficients(series x, gyroakf_adf_options opt = adf_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  std::int32_t rows = 0;
  std::vector<adf_coefficient> table(16); /* enough for most; otherwise once more */
  const auto fill = [&] {
    listener.check(gyroakf_adf_coefficients(x.data(), x.count(), &opt, static_cast<std::int32_t>(table.size()), table.data(), &rows,
                                            &err),
                   err);
  };
  fill();
  const bool short_of_rows = table.size() < static_cast<std::size_t>(rows);
  table.resize(static_cast<std::size_t>(rows));
  if (short_of_rows) fill();
  return table;
}

inline kpss kpss_test(series x, gyroakf_kpss_options opt = kpss_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  kpss out;
  listener.check(gyroakf_kpss_test(x.data(), x.count(), &opt, &out, &err), err);
  return out;
}

/* -------------------------------------------------------------------------------------------------------- correlation */

struct correlogram {
  std::vector<double> acf, pacf, limit; /* [lags + 1] */
};

inline correlogram autocorrelation(series x, std::int32_t lags, const progress &f = {}) {
  detail::watch watch;
  detail::listener listener(watch, f);
  gyroakf_error err;
  correlogram out;
  if (lags >= 1 && lags < x.count()) { /* otherwise the library refuses */
    out.acf.resize(static_cast<std::size_t>(lags) + 1);
    out.pacf = out.limit = out.acf;
  }
  listener.check(gyroakf_autocorrelation_watched(x.data(), x.count(), lags, out.acf.data(), out.pacf.data(), out.limit.data(),
                                                 watch.progress, watch.progress_user, &err),
                 err);
  return out;
}

inline whiteness ljung_box(series x, std::int32_t lags, std::int32_t fitted = 0, const progress &f = {}) {
  detail::watch watch;
  detail::listener listener(watch, f);
  gyroakf_error err;
  whiteness out;
  listener.check(gyroakf_ljung_box_watched(x.data(), x.count(), lags, fitted, &out, watch.progress, watch.progress_user, &err), err);
  return out;
}

/* --------------------------------------------------------------------------------------------------------- histogram */

class histogram {
 public:
  explicit histogram(gyroakf_histogram *owned) noexcept : handle_(owned) {}
  explicit histogram(series x, std::int32_t most_bins = 0, const progress &f = {}) {
    detail::watch watch;
    detail::listener listener(watch, f);
    gyroakf_error err;
    gyroakf_histogram *out = nullptr;
    listener.check(
        gyroakf_histogram_new_watched(x.data(), x.count(), most_bins, &out, watch.progress, watch.progress_user, &err), err);
    handle_.reset(out);
  }

  std::size_t bins() const noexcept { return static_cast<std::size_t>(gyroakf_histogram_bins(get())); }
  series edges() const noexcept { return {gyroakf_histogram_edges(get()), bins() == 0 ? 0 : bins() + 1}; }
  view<std::int64_t> counts() const noexcept { return {gyroakf_histogram_counts(get()), bins()}; }
  series expected() const noexcept { return {gyroakf_histogram_expected(get()), bins()}; }
  std::int64_t below() const noexcept { return outside().first; }
  std::int64_t above() const noexcept { return outside().second; }

  const gyroakf_histogram *get() const noexcept { return handle_.get(); }

 private:
  std::pair<std::int64_t, std::int64_t> outside() const noexcept {
    std::int64_t below = 0, above = 0;
    gyroakf_histogram_outside(get(), &below, &above);
    return {below, above};
  }
  detail::handle<gyroakf_histogram, gyroakf_histogram_free> handle_;
};

/* ------------------------------------------------------------------------------------------------------- periodicity */

inline fisher fisher_g(series x, const progress &f = {}) {
  detail::watch watch;
  detail::listener listener(watch, f);
  gyroakf_error err;
  fisher out;
  listener.check(gyroakf_fisher_g_watched(x.data(), x.count(), &out, watch.progress, watch.progress_user, &err), err);
  return out;
}

struct spectrum {
  std::vector<double> frequency, density;
  double degrees_of_freedom = 0;
};

inline spectrum welch_spectrum(series x, double dt, std::int64_t segment = 0, const progress &f = {}) {
  detail::watch watch;
  detail::listener listener(watch, f);
  gyroakf_error err;
  spectrum out;
  out.frequency.resize(static_cast<std::size_t>(gyroakf_welch_size(x.count(), segment)));
  out.density = out.frequency;
  listener.check(gyroakf_welch_spectrum_watched(x.data(), x.count(), dt, segment, out.frequency.data(), out.density.data(),
                                                &out.degrees_of_freedom, watch.progress, watch.progress_user, &err),
                 err);
  return out;
}

/* ---------------------------------------------------------------------------------------------------------- AR models */

struct ar_model {
  std::vector<double> phi; /* [order] */
  double noise_variance = 0, mean = 0;
};

inline ar_model fit_ar(series x, std::int32_t max_order, gyroakf_ar_options opt = ar_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  ar_model out;
  std::int32_t order = 0;
  out.phi.resize(static_cast<std::size_t>(std::clamp(max_order, 0, 1000)));
  listener.check(gyroakf_ar_fit(x.data(), x.count(), &opt, max_order, &order, out.phi.data(), &out.noise_variance, &out.mean, &err),
                 err);
  out.phi.resize(static_cast<std::size_t>(order));
  return out;
}

/* --------------------------------------------------------------------------------------------------- drift and filter */

/* Where no process is slow, no drift was found. */
inline drift_model identify_drift(series z, gyroakf_drift_options opt = drift_options(), const progress &f = {}) {
  detail::listener listener(opt, f);
  gyroakf_error err;
  drift_model out;
  listener.check(gyroakf_drift_identify(z.data(), z.count(), &opt, &out, &err), err);
  return out;
}

struct drift {
  std::vector<double> value, variance; /* [n] and the variance of its error */
};

inline drift smooth_drift(const gyroakf_drift_model &model, series z, const gyroakf_filter_options &opt = filter_options(),
                          const progress &f = {}) {
  detail::watch watch;
  detail::listener listener(watch, f);
  gyroakf_error err;
  drift out;
  out.value.resize(z.size());
  out.variance.resize(z.size());
  listener.check(gyroakf_drift_smooth_watched(&model, z.data(), z.count(), out.value.data(), out.variance.data(), &opt,
                                              watch.progress, watch.progress_user, &err),
                 err);
  return out;
}

class filter {
 public:
  explicit filter(gyroakf_filter *owned) noexcept : handle_(owned) {}
  /* Of an AR(p) state. */
  filter(series phi, double q, double r, const gyroakf_filter_options &opt = filter_options()) {
    gyroakf_error err;
    gyroakf_filter *out = nullptr;
    const auto p = static_cast<std::int32_t>(std::min<std::int64_t>(phi.count(), std::numeric_limits<std::int32_t>::max()));
    detail::check(gyroakf_filter_new(p, phi.data(), q, r, &opt, &out, &err), err);
    handle_.reset(out);
  }
  /* Of the drift. */
  explicit filter(const gyroakf_drift_model &model, const gyroakf_filter_options &opt = filter_options()) {
    gyroakf_error err;
    gyroakf_filter *out = nullptr;
    detail::check(gyroakf_drift_filter_new(&model, &opt, &out, &err), err);
    handle_.reset(out);
  }
  static filter restore(view<std::byte> bytes) {
    gyroakf_error err;
    gyroakf_filter *out = nullptr;
    detail::check(gyroakf_filter_restore(bytes.data(), bytes.count(), &out, &err), err);
    return filter(out);
  }

  /* One measurement, NaN: none; returns the estimate. For real time: no allocation, no lock. */
  double step(double z) {
    double x;
    const int status = gyroakf_filter_step(get(), z, &x);
    if (status == GYROAKF_NON_FINITE) throw error(status, "the estimate overflows");
    if (status != GYROAKF_OK) throw error(status, "there is no filter");
    return x;
  }
  /* x [size of z] may be z itself. */
  void run(series z, double *x, const progress &f = {}) {
    detail::watch watch;
    detail::listener listener(watch, f);
    gyroakf_error err;
    listener.check(gyroakf_filter_run_watched(get(), z.data(), z.count(), x, watch.progress, watch.progress_user, &err), err);
  }
  std::vector<double> run(series z, const progress &f = {}) {
    std::vector<double> x(z.size());
    run(z, x.data(), f);
    return x;
  }
  void freeze(bool frozen = true) {
    const int status = gyroakf_filter_freeze(get(), frozen ? 1 : 0);
    if (status != GYROAKF_OK) throw error(status, "there is no filter");
  }
  void reset() {
    gyroakf_error err;
    detail::check(gyroakf_filter_reset(get(), &err), err);
  }
  std::vector<std::byte> save() const {
    gyroakf_error err;
    std::int64_t size = 0;
    detail::check(gyroakf_filter_save(get(), nullptr, 0, &size, &err), err);
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    detail::check(gyroakf_filter_save(get(), bytes.data(), size, &size, &err), err);
    return bytes;
  }
  filter_state state() const {
    filter_state out;
    const int status = gyroakf_filter_get(get(), &out);
    if (status == GYROAKF_NON_FINITE) throw error(status, "a number of the filter overflows");
    if (status != GYROAKF_OK) throw error(status, "there is no filter");
    return out;
  }

  gyroakf_filter *get() noexcept { return handle_.get(); }
  const gyroakf_filter *get() const noexcept { return handle_.get(); }

 private:
  detail::handle<gyroakf_filter, gyroakf_filter_free> handle_;
};

} // namespace gyroakf

#endif /* GYROAKF_HPP */
