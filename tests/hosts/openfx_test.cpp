// SPDX-License-Identifier: Apache-2.0
// The node of examples/hosts/openfx in a stand-in host that renders tiles in random order on several threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "hosts/openfx/blur_node.hpp"

namespace {

using namespace openfx_blur;

constexpr int columns = 150, rows = 100;
constexpr Rect whole{0, 0, columns, rows};

/// A source that ends 7 pixels beyond the project, with rows from the lowest up.
class StandIn : public Host {
 public:
  static constexpr Rect source{-7, -7, columns + 7, rows + 7};
  Rect bounds = source;  ///< of the images that the host returns
  std::vector<float> rgba, depth;
  std::atomic<int> fetched = 0, aborts_after = 1 << 30;
  std::atomic<bool> released = true;
  std::string last_message;

  StandIn() {
    for (int y = source.y1; y < source.y2; ++y) {
      for (int x = source.x1; x < source.x2; ++x) {
        const float light =
            (x + 700) % 41 == 5 && (y + 700) % 23 == 9 ? 200.0f : 0.1f * static_cast<float>((x * y & 7));
        rgba.insert(rgba.end(), {light, light, 0.5f, 1});
        depth.push_back(((x + 70) / 25 + (y + 70) / 20) % 2 == 0 ? 0.9f : 4.0f);
      }
    }
  }
  Image image(Clip clip, double, const Rect&) override {
    ++fetched, released = false;
    const int channels = clip == Clip::colour ? 4 : 1;
    return {reinterpret_cast<char*>((clip == Clip::colour ? rgba : depth).data()),
            4 * channels * (source.x2 - source.x1), bounds};
  }
  void release(const Image&) override { released = true; }
  bool abort() override { return --aborts_after < 0; }
  void progress(double done) override { EXPECT_TRUE(done >= 0 && done <= 1); }
  void message(const std::string& text) override { last_message = text; }
  int threads() override { return 2; }
};

Parameters parameters(bool highlights = true) {
  Parameters p;
  p.lens = std::string(PETZVAL_TEST_DATA) + "/lenses/double_gauss_100mm_f2.0.json";
  p.nearest_mm = 900, p.farthest_mm = 4000, p.mm_per_unit = 1000, p.columns = columns, p.rows = rows, p.rays = 30;
  p.highlights = highlights;
  return p;
}

/// Memory of a host for the tile or the picture, with a margin in which nothing may be written.
struct Output {
  std::vector<float> pixels = std::vector<float>(4 * (columns + 6) * (rows + 6), -7);
  Image image() { return {reinterpret_cast<char*>(pixels.data()), 16 * (columns + 6), grown(whole, 3)}; }
};

TEST(OpenFxNode, TilesInRandomOrderHaveTheBitsOfTheWhole) {
  StandIn host;
  BlurNode node(host);
  ASSERT_EQ(node.set(parameters()), Status::ok) << host.last_message;
  Output one, tiled;
  ASSERT_EQ(node.render(1, whole, one.image()), Status::ok) << host.last_message;
  EXPECT_EQ(one.pixels.front(), -7);
  std::vector<Rect> tiles;
  for (int y = 0; y < rows; y += 32) {
    for (int x = 0; x < columns; x += 32) tiles.push_back({x, y, std::min(x + 32, columns), std::min(y + 32, rows)});
  }
  std::shuffle(tiles.begin(), tiles.end(), std::mt19937(3));
  std::vector<std::thread> renders;
  std::atomic<std::size_t> next = 0;
  const int before = host.fetched;
  for (int t = 0; t < 3; ++t) {
    renders.emplace_back([&] {
      for (std::size_t i; (i = next++) < tiles.size();) EXPECT_EQ(node.render(2, tiles[i], tiled.image()), Status::ok);
    });
  }
  for (std::thread& render : renders) render.join();
  EXPECT_TRUE(one.pixels == tiled.pixels);
  EXPECT_EQ(host.fetched, before + 2);  // the layers of a frame are shared
  EXPECT_TRUE(host.released);
}

TEST(OpenFxNode, PixelsOutsideTheRegionOfInterestChangeNoBit) {
  const Rect tile{64, 32, 96, 64};
  for (const bool highlights : {false, true}) {
    StandIn host;
    BlurNode node(host);
    ASSERT_EQ(node.set(parameters(highlights)), Status::ok);
    const Rect look = node.region_of_interest(tile);
    EXPECT_TRUE(look.x1 > StandIn::source.x1 && look.x2 < StandIn::source.x2);  // there are pixels outside
    Output before, after;
    node.render(1, tile, before.image());
    for (int grow : {0, 6}) {  // pixels within the region do change the tile
      std::size_t i = 0;
      for (int y = host.source.y1; y < host.source.y2; ++y) {
        for (int x = host.source.x1; x < host.source.x2; ++x, ++i) {
          const Rect pixel{x, y, x + 1, y + 1};
          if (contains(grown(grow == 0 ? look : tile, -grow), pixel)) continue;
          host.rgba[4 * i] += 0.5f, host.depth[i] = host.depth[i] == 4 ? 0.9f : 4.0f;
          if (i % 31 == 0) host.rgba[4 * i] = 900;
        }
      }
      node.render(2 + grow, tile, after.image());
      EXPECT_EQ(before.pixels == after.pixels, grow == 0) << highlights;
    }
  }
}

TEST(OpenFxNode, KeepsThePlainPictureAtEveryFNumber) {
  StandIn host;
  std::fill(host.rgba.begin(), host.rgba.end(), 1.0f);
  for (const double f_number : {2.8, 8.0}) {
    BlurNode node(host);
    Parameters p = parameters();
    p.f_number = f_number;
    ASSERT_EQ(node.set(p), Status::ok) << host.last_message;
    Output output;
    ASSERT_EQ(node.render(1, whole, output.image()), Status::ok) << host.last_message;
    const std::size_t middle = 4 * (static_cast<std::size_t>(rows / 2 + 3) * (columns + 6) + columns / 2 + 3);
    EXPECT_NEAR(output.pixels[middle], 1, 0.03);
    EXPECT_NEAR(output.pixels[middle + 3], 1, 1e-3);
  }
}

TEST(OpenFxNode, AbortedAndRefusedTilesWriteNothing) {
  StandIn host;
  BlurNode node(host);
  Parameters p = parameters();
  ASSERT_EQ(node.set(p), Status::ok);
  p.lens = "missing.json";
  EXPECT_EQ(node.set(p), Status::failed);
  EXPECT_NE(host.last_message.find("missing.json"), std::string::npos);
  Output output;
  const std::vector<float> untouched = output.pixels;
  for (const int calls : {0, 1, 2, 5}) {
    host.aborts_after = calls;
    EXPECT_EQ(node.render(1, whole, output.image()), Status::ok) << host.last_message;
    EXPECT_TRUE(output.pixels == untouched) << calls;
  }
  host.aborts_after = 1 << 30;
  for (const Rect& tile : {Rect{-1, 0, 9, 9}, Rect{140, 90, 151, 99}, Rect{5, 5, 5, 9}, Rect{9, 9, 5, 5}}) {
    EXPECT_EQ(node.render(1, tile, output.image()), Status::failed);
  }
  for (const double unit : {0.0, -1.0, std::nan("")}) {
    p = parameters(), p.mm_per_unit = unit;
    EXPECT_EQ(node.set(p), Status::failed) << unit;
  }
  p = parameters(), p.rows = 0;
  EXPECT_EQ(node.set(p), Status::failed);
  host.bounds.x2 = host.bounds.x1;
  EXPECT_EQ(node.render(3, whole, output.image()), Status::failed);
  host.bounds = StandIn::source;
  host.rgba[3] = 1.5f;  // alpha
  EXPECT_EQ(node.render(2, whole, output.image()), Status::failed);
  EXPECT_NE(host.last_message.find("alpha"), std::string::npos);
  EXPECT_TRUE(output.pixels == untouched);
}

}  // namespace
