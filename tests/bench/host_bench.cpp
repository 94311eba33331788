// SPDX-License-Identifier: Apache-2.0
// Cost of the calls of a host that asks ray by ray, through the C interface, on one thread: the least of interleaved
// rounds. Prints the tables of examples/hosts/README.md.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "petzval/petzval.h"

namespace {

constexpr std::size_t samples = 4096;
constexpr int rounds = 40;
const std::string lens_file = std::string(PETZVAL_BENCH_DATA) + "/lenses/double_gauss_100mm_f2.0.json";

void check(petzval_status status) {
  if (status == PETZVAL_OK) return;
  std::fprintf(stderr, "%s\n", petzval_message());
  std::exit(1);
}
double now_ns() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

petzval_lens* read_lens(std::size_t wavelengths) {
  std::vector<double> nm;
  for (std::size_t i = 0; i < wavelengths && wavelengths > 1; ++i) {
    nm.push_back(400 + 300.0 * static_cast<double>(i) / static_cast<double>(wavelengths - 1));
  }
  petzval_lens_options options = petzval_lens_options_init();
  options.wavelengths_nm = nm.data(), options.wavelength_count = nm.size();
  petzval_lens* lens = nullptr;
  check(petzval_lens_read(lens_file.c_str(), &options, &lens));
  check(petzval_lens_set_focus(lens, 2000, PETZVAL_FROM_FRONT_VERTEX));
  return lens;
}

petzval_camera* camera_of(const petzval_lens* lens, const char* model, bool tables = true, bool range = false) {
  petzval_camera_options options = petzval_camera_options_init();
  options.model = model, options.importance_tables = tables;
  options.frame = PETZVAL_FRAME_PBRT, options.origin = PETZVAL_FROM_FILM;
  if (range) options.near_mm = 800, options.far_mm = std::numeric_limits<double>::infinity();
  petzval_camera* camera = nullptr;
  check(petzval_camera_create(lens, nullptr, &options, &camera));
  return camera;
}

struct Call {
  const char* name;
  std::function<void(const petzval_camera*, std::size_t)> make;
};

void print_calls() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<petzval_sample> at(samples);
  std::vector<double> points;
  for (petzval_sample& s : at) {
    s = {1920 * uniform(random), 1280 * uniform(random), uniform(random), uniform(random), 0, 0};
    for (const double side : {0.3, 0.2}) points.push_back(side * (uniform(random) - 0.5));
    points.push_back(1.7);
  }
  const std::vector<const char*> models{"thin", "thick", "polynomial_7", "exact_float", "exact_double"};
  std::vector<petzval_camera*> cameras;
  petzval_lens* const lens = read_lens(4);
  for (const char* const model : models) cameras.push_back(camera_of(lens, model));
  std::vector<double> origins(3 * samples), directions(3 * samples);
  for (std::size_t i = 0; i < samples; ++i) {
    petzval_ray ray;
    check(petzval_camera_sample(cameras.back(), &at[i], &ray));
    for (std::size_t k = 0; k < 3; ++k) origins[3 * i + k] = ray.origin[k], directions[3 * i + k] = -ray.direction[k];
  }
  petzval_ray ray;
  petzval_ray_differential differential;
  petzval_importance importance;
  petzval_connection connection;
  const double nm[4] = {430, 520, 590, 680};
  petzval_path_wavelength path[4];
  const std::vector<Call> calls{
      {"sample", [&](auto* c, std::size_t i) { petzval_camera_sample(c, &at[i], &ray); }},
      {"sample_differential",
       [&](auto* c, std::size_t i) { petzval_camera_sample_differential(c, &at[i], &differential); }},
      {"importance",
       [&](auto* c, std::size_t i) {
         petzval_camera_importance(c, 1, &origins[3 * i], &directions[3 * i], nullptr, nullptr, &importance);
       }},
      {"connect",
       [&](auto* c, std::size_t i) {
         petzval_camera_connect(c, 1, &points[3 * i], &at[i].pupil_u, &at[i].pupil_v, nullptr, nullptr, &connection);
       }},
      {"sample_path, 4 wavelengths",
       [&](auto* c, std::size_t i) { petzval_camera_sample_path(c, &at[i], 4, nm, &ray, path); }}};
  std::printf("\n| ns per call |");
  for (const char* const model : models) std::printf(" %s |", model);
  std::printf("\n|---|");
  for (std::size_t m = 0; m < models.size(); ++m) std::printf("---:|");
  for (const Call& call : calls) {
    std::vector<double> least(models.size(), std::numeric_limits<double>::infinity());
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t m = 0; m < models.size(); ++m) {
        const double start = now_ns();
        for (std::size_t i = 0; i < samples; ++i) call.make(cameras[m], i);
        least[m] = std::min(least[m], (now_ns() - start) / samples);
      }
    }
    std::printf("\n| %s |", call.name);
    for (const double ns : least) std::printf(" %.0f |", ns);
  }
  std::printf("\n");
  for (petzval_camera* camera : cameras) petzval_camera_free(camera);
  petzval_lens_free(lens);
}

double least_ms(const std::function<void(int)>& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds / 4; ++round) {
    const double start = now_ns();
    work(round);
    least = std::min(least, (now_ns() - start) * 1e-6);
  }
  return least;
}

void print_setups() {
  std::printf("\n| ms, exact_float | 1 wavelength | 8 wavelengths |\n|---|---:|---:|\n");
  petzval_lens* const lenses[] = {read_lens(1), read_lens(8)};
  petzval_camera* const moving[] = {camera_of(lenses[0], "exact_float", true, true),
                                    camera_of(lenses[1], "exact_float", true, true)};
  const auto row = [&](const char* name, const std::function<void(int lens, int round)>& work) {
    std::printf("| %s |", name);
    for (int l = 0; l < 2; ++l) std::printf(" %.2f |", least_ms([&](int round) { work(l, round); }));
    std::printf("\n");
  };
  row("camera without tables of the scene side",
      [&](int l, int) { petzval_camera_free(camera_of(lenses[l], "exact_float", false)); });
  row("camera with them", [&](int l, int) { petzval_camera_free(camera_of(lenses[l], "exact_float")); });
  row("camera with a range of focus",
      [&](int l, int) { petzval_camera_free(camera_of(lenses[l], "exact_float", true, true)); });
  row("petzval_lens_set_focus", [&](int l, int round) {
    check(petzval_lens_set_focus(lenses[l], 1000 + 100 * round, PETZVAL_FROM_FRONT_VERTEX));
  });
  row("petzval_camera_set_focus",
      [&](int l, int round) { check(petzval_camera_set_focus(moving[l], 1000 + 100 * round, 1000 + 100 * round)); });
  std::string text;
  row("petzval_camera_write", [&](int l, int) {
    std::size_t length = 0;
    check(petzval_camera_write(moving[l], nullptr, 0, &length));
    text.resize(length);
    check(petzval_camera_write(moving[l], text.data(), length, nullptr));
  });
  petzval_camera* const fixed[] = {camera_of(lenses[0], "exact_float", false),
                                   camera_of(lenses[1], "exact_float", false)};
  row("petzval_camera_read, without tables of the scene side", [&](int l, int) {
    std::size_t length = 0;
    check(petzval_camera_write(fixed[l], nullptr, 0, &length));
    text.resize(length);
    check(petzval_camera_write(fixed[l], text.data(), length, nullptr));
    petzval_camera* again = nullptr;
    check(petzval_camera_read(text.data(), length, &again));
    petzval_camera_free(again);
  });
  for (int l = 0; l < 2; ++l) {
    petzval_camera_free(moving[l]), petzval_camera_free(fixed[l]), petzval_lens_free(lenses[l]);
  }
}

}  // namespace

int main() {
  print_calls();
  print_setups();
}
