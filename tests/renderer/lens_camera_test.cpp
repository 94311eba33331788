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
    if (model == ModelKind::pinhole) continue;  // no ray meets it by chance
    const LensCamera lens = camera(double_gauss(), model);
    for (const glm::vec3 travel : {glm::vec3{0, 0, 1}, glm::normalize(glm::vec3{-0.1f, 0.06f, 1})}) {
      // Places on a disc across the light, about the front of the lens.
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
