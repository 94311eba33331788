// SPDX-License-Identifier: Apache-2.0
// Images of points through cameras.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace camera_image_test {

using testing::data_lens;
using testing::expect_error;

const Film film{.width_mm = 60, .height_mm = 60};
constexpr PsfOptions options{.samples = 1 << 14, .pixels = 64};

struct Light {
  const char* lens;
  double field_deg, z;
};

void PrintTo(const Light& light, std::ostream* out) { *out << light.lens << " at " << light.field_deg; }

class CameraImages : public ::testing::TestWithParam<Light> {};

// Connections of the exact camera equal traced rays.
TEST_P(CameraImages, EqualTheLens) {
  const auto& [id, field_deg, z] = GetParam();
  const Lens lens = with_focus(data_lens(id), 3000, {.origin = DistanceOrigin::front_vertex});
  const FieldPoint point{radians(field_deg), z, 0.3};
  const Psf traced = point_image(lens, point, options);
  const Psf seen = point_image(Camera(lens, film, {.model = ModelKind::exact_double}), point, options);
  ASSERT_GT(traced.mean_throughput, 0);
  EXPECT_NEAR(seen.mean_throughput / traced.mean_throughput, 1, 2e-3);
  EXPECT_NEAR(seen.size.rms_radius / traced.size.rms_radius, 1, 5e-3);
  EXPECT_NEAR(glm::length(seen.size.centroid - traced.size.centroid), 0, 5e-3 * traced.size.rms_radius);
  EXPECT_LT(seen.error, 0.1);
}

INSTANTIATE_TEST_SUITE_P(PointImage, CameraImages,
                         ::testing::Values(Light{"double_gauss_100mm_f1.35", 0, -1000},
                                           Light{"double_gauss_100mm_f1.35", 11, -1500},
                                           Light{"tessar_100mm_f2.8", 15, -INFINITY},
                                           Light{"fisheye_8mm_f2.8", 60, -2000}));

// Weights redistribute light within the blur and keep most of it.
TEST(CameraImages, HaveTheWeightsOfTheCamera) {
  const Lens lens = with_f_number(with_focus(data_lens("double_gauss_100mm_f2.0"), 3000), 5.6);
  const FieldPoint point{0, -1000};
  for (const ModelKind model :
       {ModelKind::thin, ModelKind::thin_two_disc, ModelKind::polynomial(7), ModelKind::exact_float}) {
    const auto image = [&](const BokehControls& bokeh) {
      return point_image(Camera(lens, film, {.model = model, .bokeh = bokeh}), point, options);
    };
    const Psf plain = image({}), ring = image({.weight_distribution = 12.7, .weight_strength = 0.6}),
              soft = image({.weight_distribution = -4, .weight_strength = 0.8});
    EXPECT_NEAR(ring.mean_throughput / plain.mean_throughput, 1, 0.03) << name(model);
    EXPECT_NEAR(soft.mean_throughput / plain.mean_throughput, 1, 0.02) << name(model);
    // Mean square of a disc with w(x), x = r^2: the integral of x w(x).
    const auto mean_square = [](double d, double p) {
      return d > 0 ? (1 - p) / 2 + p * (d + 1) / (d + 2) : 1 - ((1 - p) / 2 + p * (1 - d) / (2 - d));
    };
    const double plain_square = plain.size.rms_radius * plain.size.rms_radius;
    EXPECT_NEAR(ring.size.rms_radius * ring.size.rms_radius / plain_square / (2 * mean_square(12.7, 0.6)), 1, 0.02)
        << name(model);
    EXPECT_NEAR(soft.size.rms_radius * soft.size.rms_radius / plain_square / (2 * mean_square(-4, 0.8)), 1, 0.02)
        << name(model);
    // The image contains the total light exactly.
    EXPECT_EQ(std::accumulate(ring.counts.begin(), ring.counts.end(), std::uint64_t{0}), ring.transmitted[0]);
    EXPECT_NEAR(ring.throughput(0), ring.mean_throughput, 1e-12);
  }
}

TEST(CameraImages, KeepTheBoundOfTheirError) {
  const Lens lens = with_f_number(with_focus(data_lens("double_gauss_100mm_f2.0"), 3000), 5.6);
  for (const BokehControls& bokeh : {BokehControls{.weight_distribution = 12.7, .weight_strength = 0.6},
                                     BokehControls{.weight_distribution = -4, .weight_strength = 0.8}}) {
    const Camera camera(lens, film, {.model = ModelKind::thick, .bokeh = bokeh});
    const auto light = [](const Psf& image) {
      std::array<double, 64> result;
      for (int k = 0; k < 64; ++k) {
        result[static_cast<std::size_t>(k)] = image.radial_profile[static_cast<std::size_t>(k)] *
                                              image.size.max_radius * image.size.max_radius * (2 * k + 1);
      }
      return result;
    };
    PsfOptions run = options;
    run.samples = 1 << 18;
    const auto exact = light(point_image(camera, {0.05, -1000}, run));
    int broken = 0;
    run.samples = 1 << 12;
    for (run.seed = 1; run.seed <= 20; ++run.seed) {
      const Psf image = point_image(camera, {0.05, -1000}, run);
      const auto own = light(image);
      double errors = 0, squares = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        errors += (own[k] - exact[k]) * (own[k] - exact[k]), squares += exact[k] * exact[k];
      }
      broken += std::sqrt(errors / squares) > image.error;
    }
    EXPECT_LE(broken, 1);
  }
}

// The unit of a map is irrelevant.
TEST(CameraImages, CountWeightsOfAnySize) {
  const Lens lens = with_f_number(with_focus(data_lens("double_gauss_100mm_f2.0"), 3000), 5.6);
  const auto light = [&](float value) {
    BokehControls bokeh;
    bokeh.weight_map = {1, 1, {value}};
    return point_image(Camera(lens, film, {.bokeh = bokeh}), {0, -1000}, options).mean_throughput;
  };
  for (const float value : {1e-6f, 1e-3f, 1e6f}) EXPECT_NEAR(light(value) / value / light(1), 1, 1e-3) << value;
}

TEST(CameraImages, RequireIrradiance) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const Camera camera(lens, film, {.normalisation = Normalisation::unity_on_axis});
  expect_error([&] { point_image(camera, {0, -1000}, options); }, {lens.name(), "point_image", "weights"});
}

}  // namespace camera_image_test
}  // namespace petzval
