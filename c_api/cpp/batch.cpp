/* SPDX-License-Identifier: MIT */
/*
 * N, B and K of every channel of every recording, one line each.
 *
 *     batch [--rate HZ] FILE...     HZ where a file does not tell its rate
 *
 * What fails is said in its line, the others go on; the exit code is then 1.
 */
#include <gyroakf.hpp>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

/* A coefficient with its standard error, or what it is below with 95 % confidence. */
std::string stated(const gyroakf::coefficient &c) {
  char text[40];
  if (c.detected) {
    std::snprintf(text, sizeof text, "%.3g +- %.1g", c.value, c.std_error);
  } else {
    std::snprintf(text, sizeof text, "< %.2g", c.upper_limit);
  }
  return text;
}

void characterise(const char *path, const gyroakf::reader_options &options) {
  const auto record = gyroakf::recording::read(path, options);
  for (int i = 0; i < record.channels(); i++) {
    const gyroakf::allan curve(record.values(i), record.sample_interval());
    const auto noise = gyroakf::fit_noise(curve);
    std::printf("%-32s %-8s %-6s %18s %18s %18s\n", path, record.name(i).c_str(), record.unit(i).c_str(), stated(noise.n).c_str(),
                stated(noise.b).c_str(), stated(noise.k).c_str());
  }
}

} // namespace

int main(int argc, char **argv) {
  gyroakf::reader_options options;
  int failed = 0, first = 1;
  if (argc > 2 && std::string(argv[1]) == "--rate") {
    options.rate_hz = std::strtod(argv[2], nullptr);
    first = 3;
  }
  if (first >= argc) {
    std::fprintf(stderr, "usage: batch [--rate HZ] FILE...\n");
    return 2;
  }
  std::printf("%-32s %-8s %-6s %18s %18s %18s\n", "recording", "channel", "unit u", "N, u rt(s)", "B, u", "K, u/rt(s)");
  for (int i = first; i < argc; i++) {
    try {
      characterise(argv[i], options);
    } catch (const gyroakf::error &e) {
      std::fprintf(stderr, "batch: %s (%s)\n", e.what(), gyroakf_status_string(e.code()));
      failed = 1;
    }
  }
  return failed;
}
