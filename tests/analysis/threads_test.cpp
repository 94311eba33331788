// SPDX-License-Identifier: Apache-2.0
// Threads that use one lens and one glass catalogue at the same time get the results of a single thread. Built with
// -fsanitize=thread, the tests also find races that do not change results.
#include <gtest/gtest.h>

#include <array>
#include <barrier>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "../data_lenses.hpp"
#include "../exports/distorting_lenses.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace threads_test {

struct Shared {
  Prescription prescription;
  GlassCatalogue glasses;
  Lens lens;
};

/// Results of the library for the lens.
std::vector<double> all_about(const Shared& shared) {
  std::vector<double> numbers;
  const auto say = [&](auto... values) { (numbers.push_back(static_cast<double>(values)), ...); };

  const auto traced = [&](const Lens& lens) {
    for (int i = -20; i <= 20; ++i) {
      const auto end = trace(lens, Ray<double>{{0.3 * i, 1.7 * i, -50}, {0, 0, 1}});
      say(end.ray.origin.x, end.ray.origin.y, end.ray.direction.y, end.fate, end.surface);
      const auto single = trace(lens, Ray<float>{{0, 1.7f * static_cast<float>(i), -50}, {0, 0, 1}});
      say(single.ray.origin.y, single.ray.direction.y);
    }
  };
  traced(shared.lens);

  const Lens own = compile(shared.prescription, std::array{450.0, d_line_nm, 650.0}, {.glasses = &shared.glasses});
  for (std::size_t wavelength = 0; wavelength < 3; ++wavelength) {
    const FirstOrder data = first_order(own, wavelength);
    say(data.effective_focal_length, data.rear_focal_z, data.petzval_sum);
  }
  const Glass* glass = shared.glasses.find("n-bk7", "schott");
  say(glass ? refractive_index(*glass, 500) : 0, shared.glasses.find("F2", 1.62) != nullptr);

  Lens changed = with_focus(with_f_number(shared.lens, 2.8), 1500);
  say(changed.film_z(), real_f_number(changed), pupils(changed).exit.diameter, lint(shared.prescription).size());
  traced(changed);
  const std::array fields{0.0, radians(8.0)};
  for (const Spot& spot : spot_diagram(changed, -1500, fields, 512).values) {
    say(spot.size.rms_radius, spot.size.max_radius, spot.chief_ray_height.value_or(0), spot.x.size());
  }
  const Psf image =
      point_image(changed, {.field_rad = fields[1], .z = -1200}, {.samples = 4096, .pixels = 32, .threads = 2});
  for (const auto count : image.counts) say(count);
  say(image.mean_throughput, image.size.rms_radius);

  try {
    changed = with_f_number(changed, 0.1);
  } catch (const Error& error) {
    say(std::string_view(error.what()).size());
  }
  return numbers;
}

/// Results of one function with this number of threads.
struct Threaded {
  const char* name;
  std::vector<double> (*results)(int threads);
};
void PrintTo(const Threaded& test, std::ostream* out) { *out << test.name; }

std::vector<double> numbers(const Psf& image) {
  std::vector<double> all(image.counts.begin(), image.counts.end());
  all.insert(all.end(), image.radial_profile.begin(), image.radial_profile.end());
  all.push_back(image.size.rms_radius);
  return all;
}

class AnyThreads : public ::testing::TestWithParam<Threaded> {};

TEST_P(AnyThreads, GiveEqualResults) {
  const auto one = GetParam().results(1);
  EXPECT_FALSE(one.empty());
  for (const int threads : {3, 5}) EXPECT_EQ(GetParam().results(threads), one) << threads;
}

INSTANTIATE_TEST_SUITE_P(
    Analysis, AnyThreads,
    ::testing::Values(
        Threaded{"point_image_of_a_lens",
                 [](int threads) {
                   const Lens lens = testing::data_lens("double_gauss_100mm_f1.35");
                   return numbers(point_image(lens, {radians(8), -1300}, {.samples = 30000, .threads = threads}));
                 }},
        Threaded{
            "point_image_of_a_camera",
            [](int threads) {
              const Lens lens = with_focus(testing::data_lens("double_gauss_100mm_f2.0"), 3000);
              const Camera camera(lens, {.width_mm = 60, .height_mm = 60}, {.bokeh = {.weight_distribution = 4}});
              return numbers(point_image(camera, {0.1, -1000}, {.samples = 1 << 14, .pixels = 64, .threads = threads}));
            }},
        Threaded{"model_error",
                 [](int threads) {
                   const Lens lens = with_focus(testing::data_lens("double_gauss_52mm_f1.8"), 3000);
                   const ModelError e = model_error(
                       lens, {}, ModelKind::polynomial(5),
                       {.depths_z = {lens.film_z() - 1500, -INFINITY}, .film_points = 64, .threads = threads});
                   return std::vector{e.all.rms_mm, e.all.max_mm, e.pupil_shape, e.exposure};
                 }},
        Threaded{"st_maps",
                 [](int threads) {
                   const Camera camera(testing::data_lens("double_gauss_100mm_f2_28deg"), testing::small_film(36));
                   const StMaps maps = st_maps(LensDistortion(camera), {}, threads);
                   std::vector<double> all(maps.undistort.s.begin(), maps.undistort.s.end());
                   all.insert(all.end(), maps.redistort.t.begin(), maps.redistort.t.end());
                   return all;
                 }}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Threads, MayShareALensAndAGlassCatalogue) {
  const Prescription prescription = testing::data_prescription("double_gauss_100mm_f1.35");
  const Shared shared{prescription, GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass"),
                      compile(prescription)};
  const std::vector<double> alone = all_about(shared);
  ASSERT_GT(alone.size(), 1500u);

  constexpr int count = 8;
  std::vector<std::vector<double>> together(count);
  {
    std::barrier start(count);
    std::vector<std::jthread> threads;
    for (auto& numbers : together) {
      threads.emplace_back([&] {
        start.arrive_and_wait();
        numbers = all_about(shared);
      });
    }
  }
  for (const auto& numbers : together) EXPECT_EQ(numbers, alone);
}

}  // namespace threads_test
}  // namespace petzval
