/* SPDX-License-Identifier: MIT */
/*
 * Angle random walk of every channel of a recording, with handles that are owned by std::unique_ptr.
 *
 *     owner [FILE]     default example/data/mems_gyro_x.txt
 */
#include <gyroakf.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

struct free_handle {
  void operator()(gyroakf_record *record) const { gyroakf_record_free(record); }
  void operator()(gyroakf_allan *curve) const { gyroakf_allan_free(curve); }
};
template <typename handle> using owner = std::unique_ptr<handle, free_handle>;

static owner<gyroakf_record> read_record(const char *path) {
  gyroakf_record *record = nullptr;
  gyroakf_error err;
  if (gyroakf_record_read(path, nullptr, &record, &err)) throw std::runtime_error(err.message);
  return owner<gyroakf_record>(record);
}

static gyroakf_noise fit_noise(const gyroakf_record *record, int32_t channel) {
  gyroakf_allan *curve = nullptr;
  gyroakf_noise noise;
  gyroakf_error err;
  int status = gyroakf_allan_new(gyroakf_record_values(record, channel), gyroakf_record_samples(record),
                                 gyroakf_record_sample_interval(record), nullptr, &curve, &err);
  const owner<gyroakf_allan> owned(curve);
  if (!status) status = gyroakf_noise_fit(owned.get(), nullptr, &noise, &err);
  if (status) throw std::runtime_error(err.message);
  return noise;
}

int main(int argc, char **argv) {
  try {
    const auto record = read_record(argc > 1 ? argv[1] : "example/data/mems_gyro_x.txt");
    for (int32_t i = 0; i < gyroakf_record_channels(record.get()); i++) {
      const auto noise = fit_noise(record.get(), i);
      std::printf("%s: N = %.4g %s sqrt(s)\n", gyroakf_record_name(record.get(), i), noise.n.value, gyroakf_record_unit(record.get(), i));
    }
  } catch (const std::exception &e) {
    std::fprintf(stderr, "owner: %s\n", e.what());
    return 1;
  }
  return 0;
}
