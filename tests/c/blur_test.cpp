// SPDX-License-Identifier: Apache-2.0
// Lens blur of the C interface.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "handles.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/petzval.h"
#include "petzval/pupil/apertures.hpp"

namespace c_blur_test {

using namespace petzval::testing;

constexpr int columns = 150, rows = 100;
constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

/// Boards of glass in front of a wall with lights, as two layers with an overscan and as deep samples.
struct CBlur : testing::Test {
  static constexpr int over = 20, wide = columns + 2 * over, high = rows + 2 * over;
  CameraHandle camera;
  RaysHandle rays;
  BlurHandle blur;
  std::vector<float> rgba[2], depth_mm[2];
  std::vector<std::array<float, 5>> samples;  // depth, red, green, blue, alpha
  std::vector<std::size_t> offsets{0};

  CBlur() {
    for (int i = 0; i < wide * high; ++i) {
      const int x = i % wide, y = i / wide;
      const float light = x % 37 == 3 && y % 29 == 4 ? 500.0f : 0.2f + 0.1f * static_cast<float>(x % 7);
      const std::array<float, 5> board{900, 0.3f, 0.2f, 0.01f * static_cast<float>(y), 0.5f},
          wall{5000, light, 1, 0.1f, 1}, empty{y % 2 == 0 ? nan : -1.0f, 9, 9, 9, 9};
      const bool both = (x / 30 + y / 20) % 2 == 0;
      for (const auto& [layer, f] : {std::pair{0, both ? board : wall}, std::pair{1, both ? wall : empty}}) {
        rgba[layer].insert(rgba[layer].end(), f.begin() + 1, f.end()), depth_mm[layer].push_back(f[0]);
        samples.push_back(f);
      }
      offsets.push_back(samples.size());
    }
    const LensHandle lens = read_lens();
    EXPECT_EQ(petzval_lens_set_focus(lens.get(), 2000, PETZVAL_FROM_FRONT_VERTEX), PETZVAL_OK);
    petzval_film film = petzval_film_init();
    film.columns = columns, film.rows = rows;
    camera = create_camera(lens, &film);
    petzval_lens_rays_options options = petzval_lens_rays_options_init();
    options.count = 40;
    petzval_lens_rays* made = nullptr;
    EXPECT_EQ(petzval_lens_rays_create(camera.get(), &options, &made), PETZVAL_OK) << petzval_message();
    rays.reset(made);
    petzval_blur* memory = nullptr;
    EXPECT_EQ(petzval_blur_create(&memory), PETZVAL_OK);
    blur.reset(memory);
  }
  LayersHandle layers(std::size_t count) const {
    const float *const colours[]{rgba[0].data(), rgba[1].data()}, *const depths[]{depth_mm[0].data(),
                                                                                  depth_mm[1].data()};
    petzval_layers* made = nullptr;
    EXPECT_EQ(count > 0 ? petzval_layers_create(wide, high, count, colours, depths, &made)
                        : petzval_layers_create_deep(wide, high, offsets.data(), samples[0].data(), samples.size(),
                                                     1e-4, 2, &made),
              PETZVAL_OK);
    return LayersHandle(made);
  }
  /// Gathers and checks that the memory is written if and only if the status is PETZVAL_OK.
  petzval_status gather(const petzval_layers* scene, const petzval_gather_options& options,
                        std::ptrdiff_t row_bytes = 16 * columns) const {
    const std::vector<float> before(4 * columns * rows, -7);
    std::vector<float> picture = before, missed = before;
    const petzval_status status =
        petzval_gather(scene, rays.get(), &options, blur.get(), picture.data(), row_bytes, missed.data());
    EXPECT_EQ(picture == before, status != PETZVAL_OK) << status;
    EXPECT_EQ(missed == before, status != PETZVAL_OK) << status;
    return status;
  }
};

TEST_F(CBlur, PicturesEqualThoseOfTheLibrary) {
  const petzval::Camera own(petzval::with_focus(petzval::compile(petzval::read_prescription(double_gauss)), 2000),
                            {.columns = columns, .rows = rows});
  const auto same_rays = petzval::LensRays::of(own, petzval::layer_camera(own), petzval::vogel_points(40));
  petzval::FragmentLists lists{.columns = wide, .rows = high, .offsets = offsets, .fragments = {}};
  for (const auto& f : samples) lists.fragments.push_back({f[0], f[1], f[2], f[3], f[4]});
  const petzval::LayerImage images[]{{wide, high, rgba[0], depth_mm[0]}, {wide, high, rgba[1], depth_mm[1]}};
  for (const std::size_t count : {0u, 1u, 2u}) {
    petzval::LayerSet same;
    if (count == 0) same.peel_fragments(lists, 1e-4, 2);
    if (count > 0) same.set(std::span(images).first(count));
    const petzval::BlurredImage expected = petzval::gather(same, same_rays);
    EXPECT_GT(expected.highlight_count, 0u);
    std::vector<float> picture(4 * columns * rows), missed(columns * rows);
    float* const last_row = &picture[4 * columns * (rows - 1)];  // the lowest row first
    ASSERT_EQ(
        petzval_gather(layers(count).get(), rays.get(), nullptr, blur.get(), last_row, -16 * columns, missed.data()),
        PETZVAL_OK);
    EXPECT_EQ(missed, expected.missed);
    for (std::ptrdiff_t y = 0; y < rows; ++y) {
      const float* const row = &expected.rgba[static_cast<std::size_t>(4 * columns * y)];
      EXPECT_TRUE(std::equal(row, row + 4 * columns, last_row - 4 * columns * y)) << count << ' ' << y;
    }
  }
  petzval_lens_rays_info info = petzval_lens_rays_info_init();
  ASSERT_EQ(petzval_lens_rays_get_info(rays.get(), 900, infinity, &info), PETZVAL_OK);
  const petzval::PeelPlan plan = petzval::plan_peel(same_rays, 900, infinity);
  EXPECT_EQ(info.overscan, plan.camera.overscan);
  EXPECT_EQ(info.bias, plan.bias);
  EXPECT_LE(info.reach_px, info.offset_px);
}

TEST_F(CBlur, CancelledGathersWriteNothing) {
  struct Calls {
    int made = 0, until = 0;
    double last = 0;
  } calls;
  petzval_gather_options options = petzval_gather_options_init();
  options.user = &calls;
  options.progress = [](double done, void* user) {
    auto& own = *static_cast<Calls*>(user);
    EXPECT_TRUE(done >= own.last && done <= 1) << done;
    own.last = done;
    return std::int32_t{++own.made == own.until};
  };
  const LayersHandle scene = layers(2);
  for (const int until : {1, 2, 30, 0}) {
    calls = {0, until, 0}, options.threads = until == 2 ? 2 : 1;
    EXPECT_EQ(gather(scene.get(), options), until > 0 ? PETZVAL_CANCELLED : PETZVAL_OK);
    EXPECT_TRUE(until == 0 ? calls.last == 1 : calls.made == until);
  }
}

TEST_F(CBlur, BadInputsGiveAStatusAndWriteNothing) {
  const LayersHandle scene = layers(1);
  const petzval_gather_options plain = petzval_gather_options_init();
  EXPECT_EQ(gather(nullptr, plain), PETZVAL_BAD_HANDLE);
  EXPECT_EQ(gather(reinterpret_cast<const petzval_layers*>(rays.get()), plain), PETZVAL_BAD_HANDLE);
  for (const int bytes : {0, 16 * columns - 4, 16 * columns + 2, 4 - 16 * columns}) {
    EXPECT_EQ(gather(scene.get(), plain, bytes), PETZVAL_BAD_ARGUMENT) << bytes;
  }
  const auto status_of = [&](auto change) {
    petzval_gather_options options = plain;
    change(options);
    return gather(scene.get(), options);
  };
  EXPECT_EQ(status_of([](auto& o) { o.left = columns - 5, o.columns = 6, o.rows = 1; }), PETZVAL_REFUSED);
  EXPECT_EQ(status_of([](auto& o) { o.top = -1, o.columns = 6, o.rows = 6; }), PETZVAL_REFUSED);
  EXPECT_EQ(status_of([](auto& o) { o.highlights_above = nan; }), PETZVAL_REFUSED);
  EXPECT_EQ(status_of([](auto& o) { o.size = 3; }), PETZVAL_BAD_ARGUMENT);

  petzval_layers* made = nullptr;
  const auto is_made = [&](const petzval_status status) {
    EXPECT_EQ(status == PETZVAL_OK, made != nullptr);
    petzval_layers_free(made);
    return status == PETZVAL_OK;
  };
  const auto two_layers = [&](float depth, float alpha, float second) {
    const std::array<float, 4> colour{1, 1, 1, alpha};
    const float *const colours[]{colour.data(), colour.data()}, *const depths[]{&depth, &second};
    return is_made(petzval_layers_create(1, 1, 2, colours, depths, &made));
  };
  EXPECT_TRUE(two_layers(2000, 0.5f, infinity));
  EXPECT_FALSE(two_layers(2000, 1.01f, 3000));
  EXPECT_FALSE(two_layers(2000, nan, 3000));
  EXPECT_FALSE(two_layers(3500, 1, 3000));  // not in order
  for (const float empty : {nan, 0.0f, -4.0f, -infinity}) EXPECT_TRUE(two_layers(2000, 1, empty)) << empty;
  const std::size_t one[]{0, 1}, nine[]{0, 9};
  const std::array<float, 5> good{2000, 1, 1, 1, 1}, bright{2000, 1, 1, 1, 1.5f};
  const auto deep = [&](const std::size_t* offsets_of, const std::array<float, 5>* of, double bias = 0, int most = 1) {
    return is_made(petzval_layers_create_deep(1, 1, offsets_of, of ? of->data() : nullptr, 1, bias, most, &made));
  };
  EXPECT_TRUE(deep(one, &good));
  EXPECT_FALSE(deep(nullptr, &good) || deep(one, nullptr) || deep(nine, &good) || deep(one, &bright));
  EXPECT_FALSE(deep(one, &good, nan) || deep(one, &good, 0, 65));
  EXPECT_FALSE(is_made(petzval_layers_create(-1, 1, 1, nullptr, nullptr, &made)));
  petzval_lens_rays* none = nullptr;
  petzval_lens_rays_options three = petzval_lens_rays_options_init();
  three.set_count = 3;
  EXPECT_EQ(petzval_lens_rays_create(camera.get(), &three, &none), PETZVAL_REFUSED);
  petzval_lens_rays_info info = petzval_lens_rays_info_init();
  EXPECT_EQ(petzval_lens_rays_get_info(rays.get(), nan, 9, &info), PETZVAL_REFUSED);
}

}  // namespace c_blur_test
