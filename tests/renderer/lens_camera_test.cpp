// SPDX-License-Identifier: Apache-2.0
#include "renderer/lens_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

#include "../data_lenses.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "renderer/frame.hpp"

namespace renderer {
namespace {

using petzval::ModelKind;

const petzval::Film film{.width_mm = 36, .height_mm = 24, .columns = 36, .rows = 24};

LensCamera camera(const petzval::Lens& lens, ModelKind model) { return {{lens, film, {.model = model}}, {}}; }

petzval::Lens double_gauss() {
  return petzval::with_focus(petzval::testing::data_lens("double_gauss_100mm_f2_28deg"), 1000);
}

TEST(LensCamera, DensitiesOfLightFromAfarIntegrateToOne) {
  for (const ModelKind model : petzval::models()) {
    if (model == ModelKind::pinhole) continue;  // no random ray meets a pinhole
    const LensCamera lens = camera(double_gauss(), model);
    for (const glm::vec3 travel : {glm::vec3{0, 0, 1}, glm::normalize(glm::vec3{-0.1f, 0.06f, 1})}) {
      // Points on a disc around the front of the lens, perpendicular to the light.
      const Frame frame(travel);
      constexpr float radius = 60;
      constexpr std::uint32_t count = 1u << 15;
      double sum = 0, connected = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto s = petzval::owen_sobol(i, 7);
        const auto u = static_cast<float>(s.x), v = static_cast<float>(s.y);
        const glm::vec3 place = lens.front() + frame.to_world({radius * on_disc(u, v), -200});
        sum += lens.pdf_distant_connection({place, travel}, {}) * std::numbers::pi * radius * radius / count;
        connected += lens.connect_distant(travel, u, v, {}).pdf > 0;
      }
      EXPECT_NEAR(sum, 1, 0.01) << petzval::name(model) << ' ' << travel.x;
      EXPECT_NEAR(connected / count, 1, 0.01) << petzval::name(model) << ' ' << travel.x;
    }
  }
}

TEST(LensCamera, BlursOfAThinLensHaveTheirClosedForm) {
  // c = |U - Uf| f D / (U (Uf - f)) with distances from the lens. Film samples give position, diameter and focus of the
  // lens, which connections must reproduce.
  const petzval::Lens real = double_gauss();
  const LensCamera lens = camera(real, ModelKind::thin);
  constexpr std::uint32_t count = 4096;
  LensCamera::Batch batch;
  batch.resize(count + 1, false);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto s = petzval::owen_sobol(i, 11);
    batch.raster_x[i] = 18, batch.raster_y[i] = 12;
    batch.u[i] = static_cast<float>(s.x), batch.v[i] = static_cast<float>(s.y);
  }
  batch.raster_x[count] = 28, batch.raster_y[count] = 12;
  batch.u[count] = 0.25f, batch.v[count] = 0;  // the centre of the pupil
  lens.sample(batch);
  const auto slope = [](const WorldRay& ray) { return static_cast<double>(ray.direction.x / ray.direction.z); };
  const auto axis_z = [&](const WorldRay& ray) {
    return static_cast<double>(ray.origin.z) - ray.origin.x / slope(ray);
  };
  const double lens_z = axis_z(batch.rays[count]);
  double radius = 0, focus_z = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const WorldRay& ray = batch.rays[i];
    const double x = ray.origin.x + slope(ray) * (lens_z - ray.origin.z);
    if (x > radius) radius = x, focus_z = axis_z(ray);
  }
  EXPECT_NEAR(focus_z, static_cast<double>(lens.front().z) - 1000, 10);
  const double f = petzval::first_order(real).effective_focal_length, Uf = lens_z - focus_z;
  for (const double mm : {500.0, 700.0, 900.0, 1100.0, 2000.0, 10000.0}) {
    const glm::vec3 light = lens.front() - glm::vec3{0, 0, mm};
    double least = 1e9, most = -1e9;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto seen = lens.connect(light, batch.u[i], batch.v[i], {});
      if (!seen) continue;
      least = std::min(least, seen.importance.film.x), most = std::max(most, seen.importance.film.x);
    }
    const double U = lens_z - light.z, wanted = std::abs(U - Uf) * f * 2 * radius / (U * (Uf - f));
    EXPECT_NEAR((most - least) / wanted, 1, 0.01) << mm;
  }
}

TEST(LensCamera, ExposureFollowsTheStop) {
  const petzval::Lens open = petzval::testing::data_lens("double_gauss_100mm_f2_28deg");
  for (const double f_number : {petzval::real_f_number(open), 2.8, 4.0, 8.0}) {
    const petzval::Lens lens = petzval::with_focus(petzval::with_f_number(open, f_number), 1000);
    for (const ModelKind model : petzval::models()) {
      const LensCamera c = camera(lens, model);
      LensCamera::Batch batch;
      constexpr std::uint32_t count = 1u << 10;
      batch.resize(count, false);
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto s = petzval::owen_sobol(i, 3);
        batch.raster_x[i] = 18, batch.raster_y[i] = 12;
        batch.u[i] = static_cast<float>(s.x), batch.v[i] = static_cast<float>(s.y);
      }
      c.sample(batch);
      double mean = 0;
      for (const float weight : batch.weights) mean += static_cast<double>(weight) / count;
      EXPECT_NEAR(mean / petzval::film_irradiance(lens, {0, 0}), 1, 0.02) << petzval::name(model) << " f/" << f_number;
    }
  }
}

}  // namespace
}  // namespace renderer
