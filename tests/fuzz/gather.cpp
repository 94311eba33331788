// SPDX-License-Identifier: Apache-2.0
// Small images of any layers through any rays: finite, and close to the reference.
#include "blur/gather_method.hpp"

#include <algorithm>
#include <vector>

#include "../blur/reference_gather.hpp"
#include "bytes.hpp"
#include "laws.hpp"

namespace {

using namespace petzval;

constexpr float infinity = std::numeric_limits<float>::infinity();

FragmentLists wild_lists(fuzz::Bytes& bytes, int columns, int rows, bool tame) {
  FragmentLists lists{.columns = columns, .rows = rows, .offsets = {0}, .fragments = {}};
  const auto number = [&](double least, double most) {
    return static_cast<float>(tame ? bytes.between(least, most) : bytes.number(least, most));
  };
  const bool opaque = bytes.one_in(2);
  for (int i = 0; i < columns * rows; ++i) {
    for (int k = bytes.count(0, 3); k > 0; --k) {
      const bool sky = bytes.byte() < 16;
      lists.fragments.push_back({sky ? infinity : number(500, 5000), number(0, 2), number(0, 2), number(0, 2),
                                 opaque ? 1 : number(0, 1), bytes.one_in(4) ? number(400, 9000) : 0});
    }
    lists.offsets.push_back(lists.fragments.size());
  }
  return lists;
}

/// A thin lens, or random lines for every point and position.
LensRays wild_rays(fuzz::Bytes& bytes, const LayerCamera& camera, bool tame) {
  const int sets = bytes.one_in(8) ? 4 : 1, kind = bytes.count(0, 3);
  const int count = sets * bytes.count(1, 6);
  const auto points = vogel_points(count, bytes.between(0, 1));
  const LensRaysOptions options{.nearest_mm = 400, .set_count = sets};
  const auto number = [&](double least, double most) {
    return tame ? bytes.between(least, most) : bytes.number(least, most);
  };
  if (kind < 3) {
    ThinLens lens{.radius_mm = number(0, 60), .inverse_focus = number(0, 1 / 500.0)};
    if (kind == 2) lens.iris = {.blades = bytes.count(3, 9), .roundness = number(-1, 1)};
    return LensRays::thin(camera, lens, points, options);
  }
  const double slope = number(-2000, 2000), turn = number(-30, 30), weight = number(0, 1);
  const double least = weight < 0.25 ? 0 : 1;  // 0 gives nearly dark pixels
  return LensRays(
      camera, points, 1,
      [=](int, const Vec2<double>& raster, std::span<const PupilPoint> at, std::span<LayerRay> found) {
        for (std::size_t i = 0; i < at.size(); ++i) {
          found[i].position = raster + Vec2<double>{0.0137, 0.0291};  // off the borders of pixels
          found[i].slope = {slope * at[i].u + turn * raster.y, slope * at[i].v - turn * raster.x};
          found[i].weight = least + weight * at[i].v;
        }
      },
      options);
}

/// Mean difference of two images. Bounded images are compared without the pixels whose rays met no surface, because the
/// guessed colours of these pixels depend on the bounds.
double mean_difference(const BlurredImage& a, const BlurredImage& b, bool bounded) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (bounded && b.missed[i / 4] > 0) continue;
    sum += std::abs(double(a.rgba[i]) - double(b.rgba[i]));
  }
  return sum / static_cast<double>(a.rgba.size());
}

void check(const BlurredImage& picture, bool tame) {
  for (const float share : picture.missed)
    fuzz::require(share >= 0 && share <= 1.001f, "the fraction of missed rays is from 0 to 1");
  if (!tame) return;
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    fuzz::require(std::isfinite(picture.rgba[i]), "a picture of finite colours is finite");
    if (i % 4 == 3) fuzz::require(picture.rgba[i] >= 0 && picture.rgba[i] <= 1.001f, "alpha is from 0 to 1");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const bool tame = !bytes.one_in(4);
    const int columns = bytes.count(1, 9), rows = bytes.count(1, 9);
    const LayerCamera camera = layer_camera(columns, rows, bytes.between(0.3, 1.2));
    const LensRays rays = wild_rays(bytes, camera, tame);
    const PeelPlan plan = plan_peel(rays, 450, infinity);
    if (plan.camera.overscan > 40) return;  // larger images do not test more
    LayerSet layers;
    const FragmentLists lists = wild_lists(bytes, plan.camera.layer_columns(), plan.camera.layer_rows(), tame);
    const double bias = bytes.one_in(2) ? plan.bias : 0;
    const bool held_out = bytes.one_in(4);
    layers.peel_fragments(lists, bias, bytes.count(1, 4),
                          held_out ? wild_lists(bytes, lists.columns, lists.rows, tame) : FragmentLists{});
    const blur_detail::GatherMethod way{bytes.one_in(2), !bytes.one_in(4)};
    const GatherOptions options{.highlights_above = bytes.one_in(4) ? 1.0 : 0.0};
    const BlurredImage picture = blur_detail::gather(layers, rays, options, way);
    check(picture, tame);
    if (!tame || held_out || options.highlights_above > 0 || layers.count() == 0) return;
    fuzz::require(mean_difference(picture, testing::reference_gather(layers, rays), way.limit_steps) < 0.1,
                  "a picture equals the reference");
  });
  return 0;
}
