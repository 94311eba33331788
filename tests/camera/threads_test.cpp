// SPDX-License-Identifier: Apache-2.0
// Threads that use one camera at the same time get the results of a single thread. Built with -fsanitize=thread, the
// tests also find races that do not change results.
#include <gtest/gtest.h>

#include <barrier>
#include <thread>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "camera_samples.hpp"

namespace petzval {
namespace threads_test {

/// Results of all queries of the camera.
std::vector<double> answers(const Camera& camera) {
  std::vector<double> numbers;
  const auto say = [&](const Ray<double>& ray) {
    for (const auto& v : {ray.origin, ray.direction}) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  };
  auto samples = testing::random_samples<float>(camera.film(), 1000);
  samples.run(camera);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    say(samples.ray(i));
    numbers.insert(numbers.end(), {samples.weights[i], static_cast<double>(samples.fates[i])});
  }
  for (std::size_t i = 0; i < 100; ++i) {
    const CameraRayDifferential d = camera.sample_differential(samples.one(i));
    say(camera.sample(samples.one(i)).ray);
    say(d.by_film_x);
    say(d.by_film_y);
    const Vec3<double> point = d.sample.ray.origin + 2000.0 * d.sample.ray.direction;
    const Importance we = camera.importance({point, -d.sample.ray.direction});
    const ImportanceSample sample = camera.sample_importance(point, 0.3, 0.7);
    const Projection seen = camera.project(point);
    numbers.insert(numbers.end(), {we.we, we.film.x, sample.pdf, sample.importance.we, seen.film.x, seen.film.y});
  }
  return numbers;
}

void expect_shared(const Lens& lens, const Film& film) {
  for (const ModelKind model :
       {ModelKind::thin_two_disc, ModelKind::polynomial(5), ModelKind::exact_float, ModelKind::exact_double}) {
    const Camera camera(lens, film, {.model = model});
    const std::vector<double> alone = answers(camera);
    constexpr int count = 16;
    std::vector<std::vector<double>> found(count);
    std::barrier start(count);
    std::vector<std::thread> threads;
    for (auto& numbers : found) {
      threads.emplace_back([&camera, &start, &numbers] {
        const Camera own = camera;  // copies share their tables
        start.arrive_and_wait();
        numbers = answers(own);
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const auto& numbers : found) EXPECT_EQ(numbers, alone) << name(model);
  }
}

TEST(Camera, ThreadsMayShareACamera) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  expect_shared(lens, {});
  expect_shared(lens, {.tilt_rad = 0.1, .swing_rad = 0.05});
}

// Setup distributes the wavelengths over threads.
TEST(Camera, SetUpIndependentOfThreads) {
  for (const auto& [id, film] : {std::pair{"double_gauss_100mm_f2_28deg", Film{}},
                                 {"double_gauss_100mm_f2_28deg", Film{.tilt_rad = 0.1}},
                                 {"anamorphic_60mm_2x", Film{.width_mm = 20, .height_mm = 14}},
                                 {"anamorphic_60mm_2x", Film{.width_mm = 20, .height_mm = 14, .swing_rad = 0.1}}}) {
    Prescription p = testing::data_prescription(id);
    const Lens lens = compile(p, std::vector<double>{480, 540, 620}, {.missing_glass = MissingGlass::abbe});
    for (const ModelKind model : {ModelKind::polynomial(3), ModelKind::exact_float}) {
      if (model == ModelKind::polynomial(3) && !lens.rotationally_symmetric()) continue;
      const std::vector<double> alone = answers({lens, film, {.model = model}});
      for (const int threads : {2, 8}) {
        EXPECT_EQ(answers({lens, film, {.model = model, .threads = threads, .importance_tables = true}}), alone)
            << id << ' ' << name(model);
      }
      testing::expect_error([&, &film = film] { Camera(lens, film, {.model = model, .threads = 0}); }, {"threads", 0});
    }
  }
}

}  // namespace threads_test
}  // namespace petzval
