/* SPDX-License-Identifier: MIT */
/* gyroakf.hpp: the same numbers as from C, exceptions, owners, progress. ci/cpp.sh builds and runs it. */
#include <gyroakf.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#if __cplusplus >= 202002L
#include <span>
#endif

namespace {

int passed = 0, failed = 0;

void check(bool good, const char *what) {
  if (good) {
    passed++;
  } else {
    failed++;
    std::printf("FAILED: %s\n", what);
  }
}

template <class F>
void fails(int code, F f, const char *what) {
  try {
    f();
    check(false, what);
  } catch (const gyroakf::error &e) {
    check(e.code() == code && std::strlen(e.what()) > 0, what);
  }
}

template <class T>
bool same(gyroakf::view<T> a, gyroakf::view<T> b) {
  return a.size() > 0 && a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool same(const std::vector<double> &a, const double *b) {
  return !a.empty() && std::memcmp(a.data(), b, a.size() * sizeof(double)) == 0;
}

constexpr int n = 3000;
constexpr double dt = 0.01;
gyroakf_error err;

gyroakf::recording simulated() {
  gyroakf::simulate_options opt;
  opt.samples = n;
  opt.rate_hz = 1 / dt;
  opt.n = 0.01;
  opt.ar_phi = 0.99;
  opt.ar_variance = 0.01;
  opt.seed = 3;
  return gyroakf::simulate(opt);
}

void test_views(const std::vector<double> &x) {
  const std::array<double, 3> three{1, 2, 3};
  const double plain[] = {1, 2, 3};
  const gyroakf::series s = three;
  check(s.size() == 3 && s[2] == 3 && s.end() - s.begin() == 3 && s.to_vector() == std::vector<double>({1, 2, 3}), "a view");
  check(gyroakf::series(plain).size() == 3 && gyroakf::series({plain, 2}).size() == 2, "a view of a plain array");
  check(gyroakf::series().empty() && gyroakf::series({plain, -1}).empty(), "an empty view");
#ifdef __cpp_lib_span
  check(gyroakf::series(std::span(x).first(7)).size() == 7 && gyroakf::series(std::span<const double>(x)).data() == x.data(),
        "a view of a span");
  check(std::span<const double>(s).size() == 3, "a span of a view");
#else
  check(gyroakf::series({x.data(), 7u}).size() == 7, "a view of a pointer and a size");
#endif
}

void test_allan(const std::vector<double> &x) {
  for (const char *kind : {"oadev", "adev", "mdev", "tdev", "hdev", "ohdev", "totdev"}) {
    gyroakf::allan_options opt;
    opt.kind = kind;
    const gyroakf::allan curve(x, dt, opt);
    gyroakf_allan *c = nullptr;
    check(gyroakf_allan_new(x.data(), n, dt, &opt, &c, &err) == GYROAKF_OK, kind);
    const auto size = gyroakf_allan_size(c);
    check(same(curve.tau(), {gyroakf_allan_tau(c), size}) && same(curve.deviation(), {gyroakf_allan_deviation(c), size}) &&
              same(curve.lower(), {gyroakf_allan_lower(c), size}) && same(curve.upper(), {gyroakf_allan_upper(c), size}) &&
              same(curve.edf(), {gyroakf_allan_edf(c), size}),
          kind);
    gyroakf_allan_free(c);
  }
  const gyroakf::allan curve(x, dt);
  gyroakf_noise noise;
  check(gyroakf_noise_fit(curve.get(), nullptr, &noise, &err) == GYROAKF_OK, "a fit");
  const gyroakf::noise fit = gyroakf::fit_noise(curve);
  check(fit.n.value == noise.n.value && fit.n.std_error == noise.n.std_error && fit.b.upper_limit == noise.b.upper_limit &&
            fit.chi2_reduced == noise.chi2_reduced,
        "the same fit");
  double covariance[25];
  check(gyroakf_noise_covariance(curve.get(), nullptr, nullptr, covariance, &err) == GYROAKF_OK, "a covariance");
  const auto full = gyroakf::fit_noise_covariance(curve);
  check(full.n.value == noise.n.value && std::memcmp(full.covariance.data(), covariance, sizeof covariance) == 0 &&
            std::fabs(covariance[6] / (noise.n.std_error * noise.n.std_error) - 1) < 1e-12,
        "the same covariance");
  gyroakf::fit_options terms;
  terms.terms = "XYZ";
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::fit_noise(curve, terms); }, "unknown terms");
  fails(GYROAKF_TOO_FEW_SAMPLES, [&] { gyroakf::fit_noise(gyroakf::allan({x.data(), 5}, dt)); }, "five samples");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::allan({x.data(), 0}, dt); }, "no samples");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::allan(x, -1); }, "a negative interval");
  std::vector<double> infinite(100, 1.0);
  infinite[50] = std::numeric_limits<double>::infinity();
  fails(GYROAKF_NON_FINITE, [&] { gyroakf::allan(infinite, dt); }, "an infinite value");
}

void test_series(const std::vector<double> &x) {
  gyroakf_adf adf;
  gyroakf_adf_test(x.data(), n, nullptr, &adf, &err);
  const auto unit_root = gyroakf::adf_test(x);
  check(unit_root.statistic == adf.statistic && unit_root.lag == adf.lag, "ADF");
  gyroakf::adf_options lags;
  lags.lags = 30;
  const auto table = gyroakf::adf_coefficients(x, lags);
  check(table.size() == 32 && std::string(table[31].name) == "lag 30" && gyroakf::adf_coefficients(x).size() < 32,
        "coefficients of ADF, more of them than usual");
  gyroakf_kpss kpss;
  gyroakf_kpss_test(x.data(), n, nullptr, &kpss, &err);
  check(gyroakf::kpss_test(x).statistic == kpss.statistic, "KPSS");

  double acf[11], pacf[11], limit[11];
  gyroakf_autocorrelation(x.data(), n, 10, acf, pacf, limit, &err);
  const auto correlogram = gyroakf::autocorrelation(x, 10);
  check(correlogram.acf.size() == 11 && same(correlogram.acf, acf) && same(correlogram.pacf, pacf) && same(correlogram.limit, limit),
        "autocorrelation");
  for (const int bad : {-1, 0, n}) fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::autocorrelation(x, bad); }, "bad lags");
  gyroakf_whiteness white;
  gyroakf_ljung_box(x.data(), n, 20, 0, &white, &err);
  check(gyroakf::ljung_box(x, 20).statistic == white.statistic, "Ljung-Box");

  const gyroakf::histogram h(x);
  std::int64_t sum = h.below() + h.above();
  for (const auto count : h.counts()) sum += count;
  check(sum == n && h.edges().size() == h.bins() + 1 && h.expected().size() == h.bins(), "a histogram");

  gyroakf_fisher fisher;
  gyroakf_fisher_g(x.data(), n, &fisher, &err);
  check(gyroakf::fisher_g(x).statistic == fisher.statistic, "Fisher's g");
  const auto size = gyroakf_welch_size(n, 256);
  std::vector<double> density(static_cast<std::size_t>(size));
  gyroakf_welch_spectrum(x.data(), n, dt, 256, nullptr, density.data(), nullptr, &err);
  const auto spectrum = gyroakf::welch_spectrum(x, dt, 256);
  check(same(spectrum.density, density.data()) && spectrum.frequency.size() == density.size() && spectrum.degrees_of_freedom > 10 &&
            spectrum.frequency.back() == 0.5 / dt,
        "a spectrum");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::welch_spectrum(x, dt, -5); }, "a segment of -5");

  std::vector<double> outlier = x;
  outlier[77] += 1000;
  const auto marks = gyroakf::mark_outliers(outlier);
  check(marks.removed >= 1 && marks.inlier.size() == x.size() && marks.inlier[77] == 0 && marks.inlier[78] == 1, "an outlier");
}

void test_models(const std::vector<double> &x) {
  double phi[10], variance, mean;
  std::int32_t order;
  gyroakf_ar_fit(x.data(), n, nullptr, 10, &order, phi, &variance, &mean, &err);
  const auto ar = gyroakf::fit_ar(x, 10);
  check(ar.phi.size() == static_cast<std::size_t>(order) && same(ar.phi, phi) && ar.noise_variance == variance && ar.mean == mean,
        "an AR model");
  check(gyroakf::fit_ar(x, 0).phi.empty(), "AR(0)");
  for (const int bad : {-1, 1001, 2147483647})
    fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::fit_ar(x, bad); }, "a bad order");
}

void test_filters(const std::vector<double> &x) {
  const std::vector<double> phi{0.6, 0.2};
  gyroakf::filter_options opt;
  opt.estimate_measurement_variance = 1;
  gyroakf_filter *c = nullptr;
  std::vector<double> expected(x.size());
  gyroakf_filter_new(2, phi.data(), 0.1, 0.2, &opt, &c, &err);
  gyroakf_filter_run(c, x.data(), n, expected.data(), &err);
  gyroakf_filter_free(c);

  gyroakf::filter f(phi, 0.1, 0.2, opt);
  check(same(f.run(x), expected.data()) && f.state().steps == n, "a filter");
  f.reset();
  std::vector<double> in_place = x;
  f.run({x.data(), 1000}, in_place.data());
  const auto bytes = f.save();
  gyroakf::filter restored = gyroakf::filter::restore(bytes);
  for (std::size_t i = 1000; i < x.size(); i++) in_place[i] = restored.step(x[i]);
  check(same(in_place, expected.data()), "a filter saved, restored and stepped");
  f.freeze();
  const double before = f.state().r;
  f.step(100);
  check(f.state().r == before, "a frozen filter");
  fails(GYROAKF_UNSTABLE, [] { gyroakf::filter(std::array<double, 1>{1.5}, 1, 1); }, "an unstable model");
  const gyroakf::progress stop = [](const char *, std::int64_t, std::int64_t) { return false; };
  const std::size_t some = 500;
  const gyroakf::series part(x.data(), some);
  const gyroakf::filter_options plain;
  gyroakf::drift_model walk;
  walk.count = walk.slow[0] = 1;
  walk.phi[0] = walk.q[0] = walk.r = 0.5;
  fails(GYROAKF_CANCELLED, [&] { f.run(part, in_place.data(), stop); }, "a cancelled filter");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::smooth_drift(walk, part, plain, stop); }, "a cancelled smoother");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::autocorrelation(part, 5, stop); }, "a cancelled correlation");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::ljung_box(part, 5, 0, stop); }, "a cancelled Ljung-Box test");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::histogram(part, 0, stop); }, "a cancelled histogram");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::fisher_g(part, stop); }, "a cancelled Fisher test");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::welch_spectrum(part, 1, 0, stop); }, "a cancelled spectrum");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::kpss_test(part, gyroakf::kpss_options(), stop); }, "a cancelled KPSS test");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::fit_ar(part, 3, gyroakf::ar_options(), stop); }, "a cancelled AR model");
  fails(GYROAKF_CANCELLED, [&] { gyroakf::mark_outliers(part, gyroakf::outlier_options(), stop); }, "cancelled marks");
  gyroakf::simulate_options made;
  made.n = 1;
  fails(GYROAKF_CANCELLED, [&] { gyroakf::simulate(made, stop); }, "a cancelled simulation");
  fails(77, [&] { gyroakf::kpss_test(part, gyroakf::kpss_options(), [](const char *, std::int64_t, std::int64_t) -> bool { throw gyroakf::error(77, "mine"); }); },
        "an exception of the progress comes out");
  fails(GYROAKF_PARSE, [&] { gyroakf::filter::restore({bytes.data(), bytes.size() - 1}); }, "bytes cut short");

  const auto model = gyroakf::identify_drift(x);
  gyroakf::drift_model again;
  gyroakf_drift_identify(x.data(), n, nullptr, &again, &err);
  check(model.count > 0 && model.slow[0] == 1 && model.phi[0] == again.phi[0] && model.r == again.r, "a drift is identified");
  gyroakf_drift_smooth(&again, x.data(), n, expected.data(), nullptr, nullptr, &err);
  const auto drift = gyroakf::smooth_drift(model, x);
  check(same(drift.value, expected.data()) && drift.variance.size() == x.size() && drift.variance[5] > 0, "a drift is smoothed");
  gyroakf::filter drift_filter(model);
  check(drift_filter.run(x).size() == x.size() && drift_filter.state().steps == n, "a drift filter");
  fails(GYROAKF_INVALID_ARGUMENT, [] { gyroakf::filter{gyroakf::drift_model()}; }, "a filter of no process");
}

void test_recordings() {
  const auto r = gyroakf::recording::parse("# rate_hz: 50\ngx gy\n1 2\n3 nan\n5 6\n");
  check(r.samples() == 3 && r.channels() == 2 && r.values(0)[2] == 5 && r.sample_interval() == 0.02, "a recording");
  check(r.name(1) == "gy" && r.unit(0).empty() && r.to_si(0) == 0 && r.format() == "text" && r.rate_source() == "header", "its texts");
  check(r.present(1).size() == 3 && r.present(1)[1] == 0 && r.audit().missing == 1, "a missing sample");
  check(simulated().present(0).empty(), "nothing is missing");
  const std::vector<double> first{1, 2, 3}, second{4, std::numeric_limits<double>::quiet_NaN(), 6};
  const std::array<gyroakf::series, 2> channels{first, second};
  const std::vector<std::string> names{"a", "b"};
  const auto of = gyroakf::recording::of(channels, 0.5, names, "deg/s,m/s^2");
  check(of.samples() == 3 && of.channels() == 2 && of.values(1)[2] == 6 && of.present(1)[1] == 0 && of.name(1) == "b" &&
            of.unit(1) == "m/s^2" && of.sample_interval() == 0.5,
        "a recording of arrays");
  check(gyroakf::recording::of(gyroakf::view<gyroakf::series>(channels.data(), 1), 1).name(0) == "column1", "without names");
  const std::array<gyroakf::series, 2> uneven{first, {second.data(), 2}};
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::recording::of(uneven, 1); }, "channels of different lengths");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::recording::of({}, 1); }, "no channel");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { r.values(2); }, "no channel 2");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { r.name(-1); }, "no channel -1");
  fails(GYROAKF_PARSE, [] { gyroakf::recording::parse("1\nx\n"); }, "a bad line");
  fails(GYROAKF_INVALID_ARGUMENT, [] { gyroakf::recording::parse({}); }, "no bytes");
  fails(GYROAKF_IO, [] { gyroakf::recording::read("no such file"); }, "no such file");
  const auto file = gyroakf::recording::read("example/data/mems_gyro_x.txt");
  check(file.samples() == 12000 && file.unit(0) == "deg/s" && file.warnings().empty(), "a file");

  gyroakf::run_options parts;
  parts.filters = parts.allan = 0;
  const std::string json = gyroakf::run(simulated(), parts);
  check(json.front() == '{' && json.find("\"adf\": {") != std::string::npos && json.substr(json.size() - 2) == "}\n", "the whole job");
  fails(GYROAKF_TOO_FEW_SAMPLES, [&] { gyroakf::run(r); }, "three samples are too few");
}

void test_owners(const std::vector<double> &x) {
  static_assert(!std::is_copy_constructible_v<gyroakf::allan> && !std::is_copy_assignable_v<gyroakf::recording>);
  static_assert(std::is_nothrow_move_constructible_v<gyroakf::filter> && std::is_nothrow_move_assignable_v<gyroakf::histogram>);
  gyroakf::allan a(x, dt);
  const double *tau = a.tau().data();
  gyroakf::allan b = std::move(a);
  check(b.tau().data() == tau && a.get() == nullptr && a.size() == 0 && a.tau().empty(), "moved from is empty");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { gyroakf::fit_noise(a); }, "no fit of what was moved from");
  a = std::move(b);
  check(a.size() > 0 && b.get() == nullptr, "moved back");
  gyroakf::filter f(std::vector<double>{0.5}, 1, 1), g = std::move(f);
  fails(GYROAKF_INVALID_ARGUMENT, [&] { f.step(1); }, "no step");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { f.state(); }, "no state");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { f.save(); }, "nothing to save");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { f.freeze(); }, "nothing to freeze");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { f.reset(); }, "nothing to reset");
  check(g.step(1) > 0, "the filter goes on where it went");
  gyroakf::recording r = simulated(), s = std::move(r);
  check(r.samples() == 0 && r.channels() == 0 && r.warnings().empty() && s.samples() == n, "no recording");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { r.audit(); }, "nothing to audit");
  fails(GYROAKF_INVALID_ARGUMENT, [&] { r.format(); }, "no format");
  gyroakf::histogram h(x), i = std::move(h);
  check(h.bins() == 0 && h.edges().empty() && h.below() == 0 && i.bins() > 1, "no histogram");
}

/* One round of everything that owns a handle, and of every way out of it. */
void round_of_owners(const std::vector<double> &x) {
  const gyroakf::recording r = simulated();
  gyroakf::allan a(r.values(0), dt);
  a = gyroakf::allan(x, dt);
  const gyroakf::histogram h(x);
  gyroakf::filter f(std::vector<double>{0.5}, 1, 1);
  f = gyroakf::filter::restore(f.save());
  gyroakf::run_options none;
  none.tests = none.ar = none.filters = none.allan = 0;
  gyroakf::run(r, none);
  for (const auto stop : {false, true}) {
    try {
      gyroakf::allan(x, dt, gyroakf::allan_options(), [&](const char *, std::int64_t, std::int64_t) {
        if (stop) throw 1;
        return false;
      });
    } catch (...) {
    }
  }
}

void test_memory(const std::vector<double> &x) {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33) && !defined(__SANITIZE_ADDRESS__)
  constexpr int rounds = 40;
  const auto used = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };
  for (int i = 0; i < 10; i++) round_of_owners(x);
  const auto before = used();
  for (int i = 0; i < rounds; i++) round_of_owners(x);
  check(used() < before + 16 * rounds, "nothing is left behind"); /* the smallest block takes 32 bytes */
#else
  round_of_owners(x);
#endif
}

void test_progress() {
  const std::vector<double> x = [] {
    std::vector<double> made(300000);
    std::uint32_t seed = 1;
    for (double &v : made) v = static_cast<double>((seed = seed * 1664525u + 1013904223u) >> 8) / 16777216.0;
    return made;
  }();
  gyroakf::allan_options opt;
  opt.taus = "log:10";
  int calls = 0;
  std::string stage;
  bool sensible = true;
  const gyroakf::allan curve(x, dt, opt, [&](const char *s, std::int64_t done, std::int64_t total) {
    stage = s;
    sensible = sensible && done >= 0 && (total == 0 || done <= total);
    calls++;
    return true;
  });
  check(calls > 0 && sensible && stage.size() > 3, "progress is told");
  check(same(curve.deviation(), gyroakf::allan(x, dt, opt).deviation()), "it changes nothing");

  calls = 0;
  const gyroakf::progress stop = [&](const char *, std::int64_t, std::int64_t) { return ++calls < 1; };
  struct own {
    int number;
  };
  const gyroakf::progress raise = [](const char *, std::int64_t, std::int64_t) -> bool { throw own{42}; };
  const auto cancelled = [&](auto call, const char *what) {
    calls = 0;
    fails(GYROAKF_CANCELLED, [&] { call(stop); }, what);
    check(calls == 1, what);
    try {
      call(raise);
      check(false, what);
    } catch (const own &e) {
      check(e.number == 42, what);
    }
  };
  std::string text;
  for (int i = 0; i < 200000; i++) text += "1.25\n";
  cancelled([&](auto &f) { gyroakf::allan(x, dt, gyroakf::allan_options(), f); }, "Allan deviation cancelled");
  cancelled([&](auto &f) { gyroakf::adf_test(x, gyroakf::adf_options(), f); }, "ADF cancelled");
  cancelled([&](auto &f) { gyroakf::adf_coefficients(x, gyroakf::adf_options(), f); }, "coefficients of ADF cancelled");
  cancelled([&](auto &f) { gyroakf::identify_drift(x, gyroakf::drift_options(), f); }, "the drift cancelled");
  cancelled([&](auto &f) { gyroakf::recording::parse(text, gyroakf::reader_options(), f); }, "parsing cancelled");
  cancelled([&](auto &f) { gyroakf::run(simulated(), gyroakf::run_options(), f); }, "the whole job cancelled");
  cancelled([&](auto &f) { gyroakf::recording::read("example/data/mems_gyro_x.txt", gyroakf::reader_options(), f); },
            "reading cancelled");
}

} // namespace

int main() {
  const gyroakf::recording r = simulated();
  const std::vector<double> x = r.values(0).to_vector();
  check(gyroakf::version() == GYROAKF_VERSION && gyroakf::version_string() == GYROAKF_VERSION_STRING, "version");
  check(std::string(gyroakf::error(GYROAKF_IO, "").what()) == gyroakf_status_string(GYROAKF_IO), "an error without a message");
  test_views(x);
  test_allan(x);
  test_series(x);
  test_models(x);
  test_filters(x);
  test_recordings();
  test_owners(x);
  test_memory(x);
  test_progress();
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 ? 0 : 1;
}
