// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "blur/gather_method.hpp"
#include "flood.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"

namespace petzval::flood {
namespace {

constexpr int side = 32;
constexpr float infinity = std::numeric_limits<float>::infinity();

/// Up to four surfaces per pixel at any distance beyond 500 mm, and a background.
FragmentLists random_lists(const LayerCamera& camera, bool even, bool opaque, Case& at) {
  FragmentLists lists{.columns = camera.layer_columns(), .rows = camera.layer_rows(), .offsets = {0}, .fragments = {}};
  for (int i = 0; i < lists.columns * lists.rows; ++i) {
    const int surfaces = 1 + static_cast<int>(at.between(0, 4));
    for (int k = 0; k < surfaces; ++k) {
      const bool last = k + 1 == surfaces;
      const auto depth = last ? infinity : static_cast<float>(500 * std::exp2(at.between(0, 6)));
      const float alpha = last || opaque ? 1 : static_cast<float>(at.between(0, 1));
      const auto colour = [&] { return even ? 0.5f * alpha : alpha * static_cast<float>(at.between(0, 1)); };
      const float red = colour(), green = colour(), blue = colour();
      lists.fragments.push_back({depth, red, green, blue, alpha});
    }
    lists.offsets.push_back(lists.fragments.size());
  }
  return lists;
}

}  // namespace

Counts gathers(Case& at) {
  Counts counts;
  fuzz::Bytes bytes = at.bytes();
  const bool even = bytes.one_in(4), opaque = bytes.one_in(2), turned = bytes.one_in(3);
  const int kind = bytes.byte();
  try {
    const LayerCamera camera = layer_camera(side, side, at.between(0.2, 1.2));
    const auto points = vogel_points(bytes.count(1, 60));
    ThinLens lens{.radius_mm = at.between(0, 60), .inverse_focus = at.between(0, 1 / 500.0)};
    if (kind & 1) lens.iris = {.blades = bytes.count(3, 9), .roundness = bytes.between(-1, 1)};
    if (turned) {
      lens.focus = [focus = lens.inverse_focus](const Vec2<double>& raster) {
        return FocusAt{focus * (0.5 + raster.y / side), 1};
      };
    }
    const LensRays rays = LensRays::thin(camera, lens, points, {.nearest_mm = 500});
    const PeelPlan plan = plan_peel(rays, 500, infinity);
    if (plan.camera.overscan > 200) return counts;
    LayerSet layers;
    layers.peel_fragments(random_lists(plan.camera, even, opaque, at), plan.bias, bytes.count(1, 6));
    const BlurredImage picture =
        blur_detail::gather(layers, rays, {.highlights_above = 0}, {.limit_steps = (kind & 2) == 0});
    float least = infinity, most = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
      const float value = picture.rgba[i];
      counts.fail_unless(std::isfinite(value), "a picture is finite");
      if (i % 4 == 3) continue;
      least = std::min(least, value), most = std::max(most, value);
    }
    counts.fail_unless(least >= 0 && most <= 1 + 1e-4f, "a picture is no brighter than its layers");
    if (even && opaque) {
      counts.fail_unless(std::abs(least - 0.5f) < 1e-4f && std::abs(most - 0.5f) < 1e-4f,
                         "uniform layers stay uniform");
      counts.measure("even colours", std::max(0.5f - least, most - 0.5f));
    }
    counts.kinds["pixels"] += picture.missed.size();
    counts.kinds["rays"] += picture.ray_count;
    counts.kinds["rays that met no known surface"] += picture.missed_count;
    counts.done += picture.missed.size();
  } catch (const Error&) {
    ++counts.kinds["(layers refused)"];
  }
  return counts;
}

}  // namespace petzval::flood
