// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "../data_lenses.hpp"
#include "petzval/focus/focus.hpp"
#include "renderer/render.hpp"
#include "support/wu2010.hpp"

namespace renderer {
namespace {

PictureSums picture(const Scene& scene, const LensCamera& lens, Integrator integrator, std::uint64_t seed) {
  static const PathColourSource colours(ColourMode::d);
  PictureSums sums(lens.film().columns, lens.film().rows);
  std::vector<std::size_t> tiles(sums.tiles());
  std::iota(tiles.begin(), tiles.end(), std::size_t{0});
  const UnitTracer tracer(scene, lens, colours, integrator, seed);
  render(tracer, sums, tiles, {.samples = 64, .seconds = {}}, 1, [] {});
  return sums;
}

double difference(const Estimate& a, const Estimate& b) {  // in standard errors
  return std::abs(a.mean - b.mean) / std::hypot(a.standard_error, b.standard_error);
}

TEST(Integrators, AgreeThroughWusLenses) {
  SceneDescription d;
  d.objects.push_back({"wall", Quad{{-600, -600, -1150}, {1200, 0, 0}, {0, 1200, 0}}, Diffuse{}});
  d.objects.push_back({"ball", Sphere{{-40, 0, -900}, 40}, Diffuse{}});
  d.objects.push_back({"lamp", Quad{{-300, 500, -700}, {0, 0, -400}, {600, 0, 0}}, Diffuse{}, Rgb(6)});
  d.objects.push_back({"light", Sphere{{70, 30, -1050}, 8}, Diffuse{}, Rgb(10)});
  const Scene scene(std::move(d));
  int tiles = 0, beyond = 0;
  for (const examples::WuRow& row : examples::wu_rows()) {
    const petzval::Lens lens = petzval::with_focus(petzval::testing::data_lens(row.lens), examples::wu_light_mm);
    const petzval::Film film{.width_mm = 36, .height_mm = 24, .columns = 96, .rows = 64};
    const LensCamera camera({lens, film, {.normalisation = petzval::Normalisation::unity_on_axis}}, {});
    const PictureSums path = picture(scene, camera, Integrator::path, 1);
    for (const Integrator other : {Integrator::light, Integrator::bidirectional}) {
      const PictureSums sums = picture(scene, camera, other, 2);
      const Estimate a = path.mean()[1], b = sums.mean()[1];
      EXPECT_GT(a.mean, 0.01) << row.lens;
      EXPECT_NEAR(a.mean, b.mean, 0.001 * a.mean + 3 * std::hypot(a.standard_error, b.standard_error))
          << row.lens << ' ' << static_cast<int>(other);
      for (std::size_t t = 0; t < sums.tiles(); ++t) {
        const double errors = difference(path.luminance(t), sums.luminance(t));
        ++tiles, beyond += !(errors <= 3);
        EXPECT_LT(errors, 6) << row.lens << ' ' << static_cast<int>(other) << " tile " << t;
      }
    }
  }
  // Errors come from 16 rounds each: Student's t with 15 degrees of freedom exceeds 3 in 0.9 % of the tiles.
  const double chance = 0.009 * tiles;
  RecordProperty("tiles", tiles);
  RecordProperty("beyond", beyond);
  EXPECT_LE(beyond, chance + 3 * std::sqrt(chance)) << "of " << tiles;
}

}  // namespace
}  // namespace renderer
