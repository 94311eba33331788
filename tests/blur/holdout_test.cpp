// SPDX-License-Identifier: Apache-2.0
// Holdouts and volumes of deep images. The laws: parts add up to the whole, and slices to their volume.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/blur/lens_rays.hpp"

namespace holdout_test {

using petzval::testing::expect_error;

using namespace petzval;
using Rgba = std::array<double, 4>;

constexpr float infinity = std::numeric_limits<float>::infinity(), none = std::numeric_limits<float>::quiet_NaN();

FragmentLists one_pixel(std::vector<FragmentLists::Fragment> f) { return {1, 1, {0, f.size()}, std::move(f)}; }

/// The lists of two images as one image.
FragmentLists merged(const FragmentLists& a, const FragmentLists& b) {
  FragmentLists all{a.columns, a.rows, {0}, {}};
  for (std::size_t i = 0; i + 1 < a.offsets.size(); ++i) {
    for (const FragmentLists* of : {&a, &b})
      for (std::size_t k = of->offsets[i]; k < of->offsets[i + 1]; ++k) all.fragments.push_back(of->fragments[k]);
    all.offsets.push_back(all.fragments.size());
  }
  return all;
}

/// A pixel composited; its fragments are from near to far and do not overlap.
Rgba composite(const FragmentLists& lists, std::size_t pixel = 0) {
  Rgba sum{};
  for (std::size_t i = lists.offsets[pixel]; i < lists.offsets[pixel + 1]; ++i) {
    const auto& f = lists.fragments[i];
    const float values[] = {f.red, f.green, f.blue, f.alpha};
    const double through = 1 - sum[3];
    for (std::size_t c = 0; c < 4; ++c) sum[c] += through * static_cast<double>(values[c]);
  }
  return sum;
}

/// Surfaces and volumes of 96 x 64 pixels, also at equal depths, within the bias and at infinity.
FragmentLists scene(unsigned seed, bool opaque = false) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> number(0, 1);
  FragmentLists lists{96, 64, {0}, {}};
  for (int i = 0; i < 96 * 64; ++i) {
    for (float count = 5 * number(engine), z = 1000; count > 1; --count) {
      z *= count < 2 && number(engine) < 0.2f ? infinity : count > 4 ? 1.5f : 1 + 0.5f * number(engine);
      const float a = opaque || number(engine) < 0.1f ? 1 : 0.6f * number(engine),
                  back = number(engine) < 0.3f ? 2 * z : 0;
      lists.fragments.push_back({z, a * number(engine), a * number(engine), a, a, back});
    }
    lists.offsets.push_back(lists.fragments.size());
  }
  return lists;
}

LensRays rays_of(double radius, double shift = 0) {
  return LensRays::thin(layer_camera(96, 64, 0.26),
                        {.radius_mm = radius, .inverse_focus = 1 / 2000.0, .colour_shift = {shift, 0, -shift}},
                        vogel_points(61), {.nearest_mm = 1000});
}
BlurredImage blurred(const FragmentLists& lists, const FragmentLists& holdout, const LensRays& rays, int layers,
                     double highlights_above = 0) {
  LayerSet set;
  set.peel_fragments(lists, plan_peel(rays, 900, infinity).bias, layers, holdout);
  return gather(set, rays, {.highlights_above = highlights_above});
}
/// Largest difference of the sum of two pictures and a third picture.
double excess(const BlurredImage& a, const BlurredImage& b, const BlurredImage& whole) {
  double most = 0;
  for (std::size_t i = 0; i < whole.rgba.size(); ++i)
    most = std::max<double>(most, std::abs(a.rgba[i] + b.rgba[i] - whole.rgba[i]));
  return most;
}

TEST(Holdout, PartsAddUpToTheWhole) {
  for (const bool opaque : {false, true}) {
    const FragmentLists a = scene(1, opaque), b = scene(2, opaque), all = merged(a, b);
    for (const LensRays& rays : {rays_of(30), rays_of(30, 1e-5), rays_of(0)}) {
      for (const int layers : {3, 12}) {
        const BlurredImage held_b = blurred(b, a, rays, layers), whole = blurred(all, {}, rays, layers);
        EXPECT_LT(excess(blurred(a, b, rays, layers), held_b, whole), 1e-4) << rays.largest_slope() << ' ' << layers;
        EXPECT_GT(excess(blurred(a, {}, rays, layers), held_b, whole), 0.1);
      }
    }
  }
}

TEST(Holdout, SmallLightsAddUpToTheWhole) {
  FragmentLists a{96, 64, std::vector<std::size_t>(96 * 64 + 1), {{1000, 900, 900, 900, 1}}}, b = a;
  std::fill(a.offsets.begin() + 20 * 96 + 30, a.offsets.end(), 1), b.fragments[0].depth_mm = 1050;
  std::fill(b.offsets.begin() + 26 * 96 + 34, b.offsets.end(), 1);
  const BlurredImage held_a = blurred(a, b, rays_of(60), 2, 1), whole = blurred(merged(a, b), {}, rays_of(60), 2, 1);
  EXPECT_EQ(held_a.highlight_count + 1, whole.highlight_count);
  EXPECT_LT(excess(held_a, blurred(b, a, rays_of(60), 2, 1), whole), 1e-4);
}

TEST(Holdout, FlatListsAddUpToTheWhole) {
  const FragmentLists a = scene(5), b = scene(6), held_a = hold_out(a, b), held_b = hold_out(b, a),
                      whole = hold_out(merged(a, b), {});
  const BlurredImage pinhole = blurred(a, b, rays_of(0), 4);
  for (std::size_t i = 0; i < 96 * 64; ++i) {
    const Rgba of_a = composite(held_a, i), of_b = composite(held_b, i), of_all = composite(whole, i);
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_NEAR(of_a[c] + of_b[c], of_all[c], 2e-6);
      EXPECT_NEAR(of_a[c], pinhole.rgba[4 * i + c], 1e-4);
    }
  }
  const FragmentLists wall = one_pixel({{2000, 1, 1, 1, 1}});
  EXPECT_EQ(composite(hold_out(wall, one_pixel({{1000, 5, 5, 5, 0.25f}}))), (Rgba{0.75, 0.75, 0.75, 0.75}));
  EXPECT_EQ(composite(hold_out(wall, wall)), (Rgba{0.5, 0.5, 0.5, 0.5}));  // equal depths are mixed
}

TEST(Holdout, BadInputIsRefused) {
  LayerSet layers;
  const FragmentLists good = one_pixel({{1000, 1, 1, 1, 1}}), wide{2, 1, {0, 1, 1}, good.fragments},
                      broken{1, 1, {0, 2}, good.fragments}, red = one_pixel({{1000, none, 1, 1, 1}}),
                      clear = one_pixel({{1000, 1, 1, 1, none}});
  const auto refused = [&](const FragmentLists& lists, const FragmentLists& holdout, const char* where,
                           const char* word) {
    layers.peel_fragments(good, 0, 2, good);
    expect_error([&] { layers.peel_fragments(lists, 0, 2, holdout); }, {where, word});
    EXPECT_EQ(layers.count(), 1);  // the lists are checked first
    expect_error([&] { hold_out(lists, holdout); }, {where, word});
  };
  refused(good, wide, "holdout", "size"), refused(good, broken, "holdout", "offsets");
  refused(broken, {}, "fragments", "offsets"), refused(FragmentLists{}, {}, "fragments", "size");
  refused(red, {}, "fragments", "colour"), refused(clear, {}, "fragments", "alpha");
  refused(good, one_pixel({{1000, 1, 1, 1, 1.5f}}), "holdout", "alpha");
  // Samples without a depth are no surfaces, and colours of a holdout are not used.
  const auto bad = one_pixel({{none, 0, 0, 0, 1}, {-5, 0, 0, 0, 1}, {0, 0, 0, 0, 1}, {9000, none, 0, 0, 1, none}});
  EXPECT_EQ(composite(hold_out(good, bad)), (Rgba{1, 1, 1, 1}));
}

TEST(Volumes, PinholeSeesTheirTotal) {
  std::vector<FragmentLists> images{one_pixel({})};
  for (int i = 0; i < 20; ++i) images[0].fragments.push_back({1000 + 100.0f * static_cast<float>(i), 0.1f, 0, 0, 0.2f});
  images[0].offsets[1] = 20;
  for (const float alpha : {0.02f, 0.5f, 0.999f})
    images.push_back(one_pixel({{1000, alpha / 3, 0.2f, 0, alpha, 5000}}));
  for (const FragmentLists& image : images) {
    for (const double bias : {0.0, 1e-6, 1e-4, 3e-4, 1.0}) {
      for (const int layers : {1, 4, 64}) {
        LayerSet set;
        set.peel_fragments(image, bias, layers);
        for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(composite(set.fragments())[c], composite(image)[c], 1e-4);
        if (bias != 1e-4 || image.fragments.size() > 1) continue;
        EXPECT_EQ(set.count(), std::min(layers, 7));  // 8e-4 / mm from front to back
      }
    }
  }
}

TEST(Volumes, SplitTwiceEqualsSplitOnce) {
  // The law of Beer and Lambert: a volume and its parts in proportion to their lengths, with a pane at some depth.
  const float ends[] = {1000, 1250, 1300, 2800, 3000};
  const FragmentLists whole = one_pixel({{1000, 0.4f, 0, 0.8f, 0.8f, 3000}});
  FragmentLists split = one_pixel({});
  for (std::size_t i = 0; i < 4; ++i) {
    const float a = 1 - std::pow(0.2f, (ends[i + 1] - ends[i]) / 2000);
    split.fragments.push_back({ends[i], 0.5f * a, 0, a, a, ends[i + 1]}), split.offsets[1] = i + 1;
  }
  for (const float depth : {1100.0f, 1300.0f, 2900.0f, 4000.0f}) {
    const FragmentLists pane = one_pixel({{depth, 0, 0, 0, 0.7f}});
    const Rgba once = composite(hold_out(whole, pane)), twice = composite(hold_out(split, pane));
    const double in_front = 1 - std::pow(0.2, std::min(depth - 1000.0, 2000.0) / 2000);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(once[c], twice[c], 1e-6);
    EXPECT_NEAR(once[3], in_front + 0.3 * (0.8 - in_front), 1e-6);
    EXPECT_NEAR(once[0], 0.5 * once[3], 1e-6);
  }
}

TEST(Volumes, ThicknessesAddUpInOverlaps) {
  const FragmentLists::Fragment red{1000, 0.5f, 0, 0, 0.5f, 2000}, blue{1000, 0, 0, 0.75f, 0.75f, 2000};
  for (const FragmentLists& lists : {one_pixel({red, blue}), one_pixel({blue, red})}) {
    const Rgba seen = composite(hold_out(lists, {}));
    EXPECT_NEAR(seen[3], 0.875, 1e-6);
    EXPECT_NEAR(seen[0], 0.875 / 3, 1e-6);  // ln 2 of ln 8
  }
  const FragmentLists shifted = hold_out(one_pixel({red, {1500, 0, 0, 0.75f, 0.75f, 2500}}), {});
  ASSERT_EQ(shifted.fragments.size(), 3u);
  EXPECT_EQ(shifted.fragments[1].back_mm, 2000);
  EXPECT_NEAR(shifted.fragments[1].alpha, 1 - std::sqrt(0.125), 1e-6);
  // Without end, solid, or with its back in front: a surface.
  for (const auto& [alpha, back] : {std::pair{0.5f, infinity}, {1.0f, 2000.0f}, {0.5f, 900.0f}, {0.5f, none}})
    EXPECT_EQ(hold_out(one_pixel({{1000, 0, 0, 0, alpha, back}}), {}).fragments[0].back_mm, 1000);
}

}  // namespace holdout_test
