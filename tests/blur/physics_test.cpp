// SPDX-License-Identifier: Apache-2.0
// Laws of optics for blurred images, independent of the algorithm.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "../data_lenses.hpp"
#include "blur/gather_method.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"

namespace physics_test {

using namespace petzval;

/// Layers of one plane across the axis, textured by raster position.
template <class Light>
LayerSet plane(const PeelPlan& plan, float depth, const Light& light) {
  LayerSet layers;
  layers.peel(plan, 1, [&](int, std::span<const float>, const LayerPlanes& out) {
    const int columns = plan.camera.layer_columns();
    for (std::size_t i = 0; i < out.red.size(); ++i) {
      const int column = static_cast<int>(i) % columns - plan.camera.overscan,
                row = static_cast<int>(i) / columns - plan.camera.overscan;
      out.inverse_depth[i] = 1 / depth;
      out.red[i] = out.green[i] = out.blue[i] = light(column, row);
    }
    return out.red.size();
  });
  return layers;
}

class Planes : public ::testing::TestWithParam<double> {};

TEST_P(Planes, EqualConvolutionsWithThePointImage) {
  constexpr double pixel = 0.075;
  const Film film{.width_mm = 96 * pixel, .height_mm = 64 * pixel, .columns = 96, .rows = 64};
  const Lens lens =
      with_focus(petzval::testing::data_lens("double_gauss_52mm_f1.8"), 2000, {.origin = DistanceOrigin::front_vertex});
  const Camera camera(lens, film, {.model = ModelKind::exact_float, .normalisation = Normalisation::unity_on_axis});
  const LensRays rays = LensRays::of(camera, layer_camera(camera), vogel_points(3000), {}, {.nearest_mm = 900});
  const double from_vertex = GetParam(), depth = from_vertex + layer_origin_z(camera);
  const auto light = [](int column, int row) {
    return static_cast<float>(0.5 + 0.25 * std::sin(0.9 * column) + 0.25 * std::cos(0.6 * row + 0.3 * column));
  };
  const LayerSet layers = plane(plan_peel(rays, 0.9 * depth, 1e6), static_cast<float>(depth), light);
  const BlurredImage picture = gather(layers, rays);

  constexpr int size = 41;
  const Psf psf = point_image(lens, {.z = -from_vertex},
                              {.pixels = size, .half_width_mm = size * pixel / 2, .centre = Vec2<double>{0, 0}});
  double sum = 0;
  for (const auto count : psf.counts) sum += static_cast<double>(count);
  double worst = 0, spread = 0;
  for (int row = 24; row < 40; ++row) {
    for (int column = 40; column < 56; ++column) {
      double wanted = 0;
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          wanted += static_cast<double>(psf.counts[static_cast<std::size_t>(y * size + x)]) / sum *
                    static_cast<double>(light(column + x - size / 2, row + y - size / 2));
        }
      }
      const double found = picture.rgba[static_cast<std::size_t>(4 * (row * 96 + column))];
      worst = std::max(worst, std::abs(found - wanted)), spread = std::max(spread, std::abs(wanted - 0.5));
    }
  }
  // Rays and points of the PSF are rounded to pixels; the plane deviates from its mean by 0.5.
  EXPECT_LT(worst, 0.025);
  EXPECT_GT(spread, 0.02);  // contrast remains
}
INSTANTIATE_TEST_SUITE_P(Depths, Planes, ::testing::Values(1300.0, 1600.0, 2000.0, 4000.0));

TEST(HalfPlanes, OcclusionEqualsTheAnalyticEdge) {
  // A dark half plane at 1 m in front of a light wall in focus at 2 m: the fraction of the pupil that sees past the
  // edge.
  const LayerCamera camera = layer_camera(120, 90, radians(10));
  const LensRays rays =
      LensRays::thin(camera, {.radius_mm = 30, .inverse_focus = 1 / 2000.0}, vogel_points(2000), {.nearest_mm = 900});
  const PeelPlan plan = plan_peel(rays, 900, 3000);
  LayerSet layers;
  layers.peel(plan, 2, [&](int layer, std::span<const float>, const LayerPlanes& out) {
    const int columns = plan.camera.layer_columns();
    for (std::size_t i = 0; i < out.red.size(); ++i) {
      const bool dark = static_cast<int>(i) % columns < plan.camera.overscan + 60;
      if (layer == 1 && !dark) continue;
      const bool wall = layer == 1 || !dark;
      out.inverse_depth[i] = wall ? 1 / 2000.0f : 1 / 1000.0f;
      out.red[i] = wall ? 1.0f : 0.0f;
    }
    return out.red.size();
  });
  const BlurredImage picture = gather(layers, rays);
  const double radius = 30 * (1 / 1000.0 - 1 / 2000.0) * camera.focal_px;
  ASSERT_GT(radius, 7);
  for (int column = 30; column < 90; ++column) {
    const double s = std::clamp((column + 0.5 - 60) / radius, -1.0, 1.0);
    const double wanted = 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi;
    EXPECT_NEAR(picture.rgba[static_cast<std::size_t>(4 * (45 * 120 + column))], wanted, 0.04) << column;
  }
}

TEST(Points, FarBehindFocusCoverTheirCircleOfConfusion) {
  const LayerCamera camera = layer_camera(160, 120, radians(10));
  for (const double radius_mm : {20.0, 50.0}) {
    const LensRays rays = LensRays::thin(camera, {.radius_mm = radius_mm, .inverse_focus = 1 / 2000.0},
                                         vogel_points(64), {.nearest_mm = 900});
    const auto point = [](int column, int row) { return column == 80 && row == 60 ? 1e4f : 0.0f; };
    const BlurredImage picture = gather(plane(plan_peel(rays, 1900, 1e7), 1e6f, point), rays);
    const double radius = radius_mm * (1 / 2000.0 - 1e-6) * camera.focal_px, area = std::numbers::pi * radius * radius;
    int covered = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      covered += picture.rgba[i] > 0.5f * 1e4f / static_cast<float>(area);
    EXPECT_NEAR(covered, area, 0.03 * area + 2 * radius) << radius_mm;
  }
}

/// A grey pixel at an inverse depth in front of a black wall. Much nearer and farther surfaces in corners make sure
/// that the pixel is neither the nearest nor the farthest surface.
LayerSet grey_pixel(const PeelPlan& plan, double inverse_depth, double wall) {
  const int columns = plan.camera.layer_columns(), rows = plan.camera.layer_rows();
  const int middle = columns / 2, centre = rows / 2;
  FragmentLists lists{.columns = columns, .rows = rows, .offsets = {0}, .fragments = {}};
  const auto depth = [](double w) { return static_cast<float>(1 / w); };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (row == 0 && column == 0) lists.fragments.push_back({depth(1.5 * inverse_depth), 0, 0, 0, 1});
      if (row == centre && column == middle) lists.fragments.push_back({depth(inverse_depth), 0.5f, 0.5f, 0.5f, 1});
      lists.fragments.push_back({depth(row == 0 && column == 1 ? 0.5 * wall : wall), 0, 0, 0, 1});
      lists.offsets.push_back(lists.fragments.size());
    }
  }
  LayerSet layers;
  layers.peel_fragments(lists, plan.bias, 4);
  return layers;
}

/// The total light of an image and the radius of the disc with its second moments.
struct Disc {
  double radius = 0, light = 0;
};
Disc disc_of(const BlurredImage& picture) {
  double light = 0, x = 0, y = 0, squares = 0;
  const auto sum = [&](auto&& visit) {
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.columns; ++column) {
        visit(column, row,
              static_cast<double>(picture.rgba[static_cast<std::size_t>(4 * (row * picture.columns + column))]));
      }
    }
  };
  sum([&](int column, int row, double value) { light += value, x += value * column, y += value * row; });
  x /= light, y /= light;
  sum([&](int column, int row, double value) {
    squares += value * ((column - x) * (column - x) + (row - y) * (row - y));
  });
  return {std::sqrt(2 * squares / light), light};
}

// Rays land in whole pixels: along the main direction of a ray the position on the disc is rounded, across it the
// position of each step. The mean squares of the errors are 1/12 and (1 + 4 / pi - 1) / 12 px^2.
TEST(Points, HaveTheRadiusOfTheirCircleOfConfusion) {
  constexpr double pi = std::numbers::pi, focus = 1 / 1000.0, rounding = 2 * (1 / 12.0 + 4 / (12 * pi));
  const LayerCamera camera = layer_camera(60, 44, radians(10));
  const LensRays rays =
      LensRays::thin(camera, {.radius_mm = 25, .inverse_focus = focus}, vogel_points(2000), {.nearest_mm = 250});
  const double px = 25 * camera.focal_px;  // change of the radius per 1/mm of defocus
  for (const double wanted : {7.81, 3.35, -3.35, -5.2}) {
    const double w = focus + wanted / px;
    ASSERT_GT(w, 0);
    const PeelPlan plan = plan_peel(rays, 0.5 / w, 1e7);
    const LayerSet layers = grey_pixel(plan, w, 0.5 * w);
    double fast = 0;
    for (const bool by_blocks : {true, false}) {
      const Disc disc = disc_of(blur_detail::gather(layers, rays, {.highlights_above = 0}, {by_blocks}));
      const double radius = std::sqrt(disc.radius * disc.radius - rounding);
      EXPECT_NEAR(radius, std::abs(wanted), 0.03) << by_blocks << ' ' << wanted;
      EXPECT_NEAR(disc.light, 0.5, 0.01) << by_blocks << ' ' << wanted;
      if (by_blocks) fast = disc.radius;
      EXPECT_NEAR(disc.radius, fast, 0.02) << by_blocks << ' ' << wanted;
    }
  }
}

TEST(Points, HaveTheRadiusOfTheirCircleOfConfusionAsHighlights) {
  constexpr double focus = 1 / 1000.0, rounding = 4 / 12.0;
  const LayerCamera camera = layer_camera(90, 70, radians(10));
  const LensRays rays =
      LensRays::thin(camera, {.radius_mm = 25, .inverse_focus = focus}, vogel_points(16), {.nearest_mm = 250});
  for (const double wanted : {9.2, 11.7, 13.77, 27.54}) {
    const double w = focus + wanted / (25 * camera.focal_px);
    const PeelPlan plan = plan_peel(rays, 0.5 / w, 1e7);
    const BlurredImage picture = gather(grey_pixel(plan, w, 0.5 * w), rays, {.highlights_above = 0.1});
    ASSERT_EQ(picture.highlight_count, 1u);
    const Disc disc = disc_of(picture);
    EXPECT_NEAR(std::sqrt(disc.radius * disc.radius - rounding), wanted, 0.02);
    EXPECT_NEAR(disc.light, 0.5, 0.005);
  }
}

}  // namespace physics_test
