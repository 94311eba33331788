// SPDX-License-Identifier: Apache-2.0
#include "layers/lit_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/geometry.hpp"
#include "renderer/sky_light.hpp"

namespace {

using petzval::testing::expect_error;

using namespace lens_blur;
using petzval::LayerCamera;
using petzval::LayerRay;
using petzval::LayerSet;
using petzval::LensRays;
using petzval::RgbImage;
using renderer::Rgb;
using renderer::SceneDescription;

constexpr double infinity = std::numeric_limits<double>::infinity();
const Rgb sky{0.25f, 0.5f, 1};

/// A material that emits one colour and reflects nothing.
renderer::Object lamp(renderer::Shape shape, const Rgb& colour) {
  return {"lamp", std::move(shape), renderer::Diffuse{{.colour = {0, 0, 0}}}, colour};
}

/// Emitting triangles of all sizes, and reference intersections by the formula of Moeller and Trumbore (1997). They lie
/// in front of the default pose: x to the right, y up, depth -z.
struct Soup {
  struct Triangle {
    glm::dvec3 a, b, c;
    Rgb colour;
  };
  struct Hit {
    double depth;
    Rgb colour;
  };
  std::vector<Triangle> triangles;

  /// Uniform in inverse depth from 1 / nearest to 1 / farthest, with about `deep` triangles behind each other.
  Soup(unsigned seed, int count, double deep, double nearest, double farthest, double tangent) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> number(0, 1);
    const double size = 2 * tangent * std::sqrt(deep / (0.3 * count));
    for (int i = 0; i < count; ++i) {
      const double w = 1 / farthest + number(engine) * (1 / nearest - 1 / farthest);
      const double x = (2 * number(engine) - 1) * tangent, y = (2 * number(engine) - 1) * tangent;
      const auto corner = [&] {
        // Tilted, with all corners beyond the nearest depth.
        const double depth = 1 / std::clamp(w * (1 + 0.1 * (number(engine) - 0.5)), 1 / farthest, 1 / nearest);
        return depth * glm::dvec3{x + size * (2 * number(engine) - 1), y + size * (2 * number(engine) - 1), -1};
      };
      const glm::dvec3 a = corner(), b = corner(), c = corner();
      triangles.push_back({a, b, c, {static_cast<float>(i % 16) / 16, static_cast<float>(i / 16 % 16) / 16, 2}});
    }
  }

  SceneDescription scene() const {
    SceneDescription result{.name = "soup", .sky = {.colour = sky}, .pose = {}};
    for (const auto& [a, b, c, colour] : triangles)
      result.objects.push_back(lamp(renderer::Mesh{{a, b, c}, {{0, 1, 2}}}, colour));
    return result;
  }

  /// Hits from near to far, without the sky. from, run: in the space of LayerCamera; run.z = 1.
  std::vector<Hit> hits(const glm::dvec3& from, const glm::dvec3& run) const {
    const glm::dvec3 turned{run.x, run.y, -run.z}, start{from.x, from.y, -from.z};
    std::vector<Hit> found;
    for (const auto& [a, b, c, colour] : triangles) {
      const glm::dvec3 e1 = b - a, e2 = c - a, p = glm::cross(turned, e2), q = glm::cross(start - a, e1);
      const double det = glm::dot(e1, p), u = glm::dot(start - a, p) / det, v = glm::dot(turned, q) / det,
                   t = glm::dot(e2, q) / det;
      if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) found.push_back({t, colour});
    }
    std::ranges::sort(found, {}, &Hit::depth);
    return found;
  }
};

/// Directions of the pixels of an image with overscan.
glm::dvec3 run_of(const LayerCamera& camera, double column, double row) {
  return {(column + 0.5 - camera.overscan - camera.axis.x) / camera.focal_px,
          -(row + 0.5 - camera.overscan - camera.axis.y) / camera.focal_px, 1};
}

bool alike(const Rgb& a, const Rgb& b, float tolerance = 1e-5f) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}) <= tolerance;
}
Rgb colour_of(const LayerSet& layers, int layer, std::size_t pixel) {
  return {layers.rgba(layer, pixel)[0], layers.rgba(layer, pixel)[1], layers.rgba(layer, pixel)[2]};
}
Rgb colour_of(const RgbImage& image, int x, int y) {
  return {image.pixel(x, y)[0], image.pixel(x, y)[1], image.pixel(x, y)[2]};
}
/// Number of pixels that differ between two images by more than rounding.
int different(const RgbImage& a, const RgbImage& b, float tolerance) {
  int count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) count += !alike(colour_of(a, x, y), colour_of(b, x, y), tolerance);
  }
  return count;
}

/// The centre of the image of Lee, Eisemann and Seidel (2010): 800 x 600 pixels, vertical field of view 30 degrees.
LayerCamera crop_of_paper(int columns, int rows) {
  LayerCamera camera = petzval::layer_camera(800, 600, petzval::radians(30.0));
  camera.columns = columns, camera.rows = rows, camera.axis = {columns / 2.0, rows / 2.0};
  return camera;
}

TEST(LitScene, IsSeenFromItsPose) {
  // The camera looks along +x; one lamp is to its right (+z) and above, another 3 m ahead.
  SceneDescription scene{.name = "two", .sky = {.colour = sky}, .pose = {}};
  scene.pose = {.position = {100, 50, 20}, .look_at = {200, 50, 20}};
  scene.objects = {lamp(renderer::Quad{{3100, 250, 270}, {0, 100, 0}, {0, 0, 100}}, {1, 0, 0}),
                   lamp(renderer::Quad{{3100, 0, -30}, {0, 100, 0}, {0, 0, 100}}, {0, 1, 0})};
  const LayerCamera camera = petzval::layer_camera(90, 60, petzval::radians(30.0));
  const LitScene lit(scene);
  LayerSet layers;
  layers.peel({.camera = camera, .bias = 1e-6}, 4, lit.peel(camera, 1));
  ASSERT_EQ(layers.count(), 2);  // lamps and sky

  const auto pixel_at = [&](double right, double up) {
    const petzval::Vec2<double> at = camera.raster({right, up, 3000});
    return static_cast<std::size_t>(at.y) * 90 + static_cast<std::size_t>(at.x);
  };
  const std::size_t right_lamp = pixel_at(300, 250), middle_lamp = pixel_at(0, 0), beside = pixel_at(-300, 250);
  EXPECT_TRUE(alike(colour_of(layers, 0, right_lamp), {1, 0, 0}));
  EXPECT_TRUE(alike(colour_of(layers, 0, middle_lamp), {0, 1, 0}));
  EXPECT_TRUE(alike(colour_of(layers, 0, beside), sky));
  EXPECT_NEAR(layers.inverse_depth(0)[right_lamp] * 3000, 1, 1e-6);  // along the axis
  EXPECT_EQ(layers.inverse_depth(0)[beside], 0);
  EXPECT_LT(layers.inverse_depth(1)[beside], 0);  // empty behind the sky
  EXPECT_EQ(layers.inverse_depth(1)[right_lamp], 0);
  EXPECT_TRUE(alike(colour_of(layers, 1, right_lamp), sky));
  EXPECT_NEAR(lit.nearest_mm(camera, 1), 3000, 0.01);
}

TEST(LitScene, ShowsTheSkyOfEachDirection) {
  // One pixel for each quarter of the horizon: ahead (-z), right, behind, left.
  auto image = std::make_shared<RgbImage>(4, 1);
  for (int i = 0; i < 4; ++i) image->pixel(i, 0)[0] = static_cast<float>(i + 1);
  SceneDescription scene{.name = "sky", .sky = {.colour = {1, 1, 1}, .image = image}, .pose = {}};
  const LayerCamera camera = petzval::layer_camera(9, 9, petzval::radians(10.0));
  const double turn[][3] = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  float sum = 0;
  for (const auto& [x, y, z] : turn) {
    scene.pose.look_at = {x, y, z};
    const LitScene lit(scene);
    const RgbImage seen = lit.reference(LensRays::thin(camera, {.radius_mm = 0}, petzval::vogel_points(1)), 1);
    const float expected = renderer::SkyLight(scene.sky).radiance(-glm::normalize(glm::vec3(scene.pose.look_at))).x;
    EXPECT_EQ(seen.pixel(4, 4)[0], expected);
    sum += expected;
  }
  EXPECT_EQ(sum, 10);  // all four
}

TEST(LitScene, LayersEqualThinnedSurfaces) {
  const LayerCamera picture = crop_of_paper(40, 30);
  const LensRays rays = LensRays::thin(picture, {.radius_mm = 9, .inverse_focus = 1 / 5000.0},
                                       petzval::vogel_points(100), {.nearest_mm = 1000});
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Soup soup(seed, 200, 10, 1000, 30000, 0.03);
    const LitScene lit(soup.scene());
    const petzval::PeelPlan plan = petzval::plan_peel(rays, 1000, infinity);
    LayerSet peeled, thinned;
    peeled.peel(plan, 16, lit.peel(plan.camera, 2));

    petzval::FragmentLists all{
        .columns = plan.camera.layer_columns(), .rows = plan.camera.layer_rows(), .offsets = {0}, .fragments = {}};
    for (int row = 0; row < all.rows; ++row) {
      for (int column = 0; column < all.columns; ++column) {
        std::vector<Soup::Hit> hits = soup.hits({0, 0, 0}, run_of(plan.camera, column, row));
        hits.push_back({infinity, sky});
        for (const auto& [depth, c] : hits) all.fragments.push_back({static_cast<float>(depth), c.x, c.y, c.z, 1});
        all.offsets.push_back(all.fragments.size());
      }
    }
    thinned.peel_fragments(all, plan.bias, 16);
    ASSERT_EQ(peeled.count(), thinned.count());
    EXPECT_GE(peeled.count(), 6);

    // At edges, and for surfaces exactly at the bias, rounding decides.
    std::size_t same = 0, pixels = 0;
    for (int layer = 0; layer < peeled.count(); ++layer) {
      for (std::size_t i = 0; i < peeled.inverse_depth(layer).size(); ++i) {
        const float a = peeled.inverse_depth(layer)[i], b = thinned.inverse_depth(layer)[i];
        const bool empty = a < 0 && b < 0;
        same += empty || (std::abs(a - b) < 1e-6f * b + 1e-12f &&
                          alike(colour_of(peeled, layer, i), colour_of(thinned, layer, i)));
        ++pixels;
      }
    }
    EXPECT_GE(static_cast<double>(same), 0.999 * static_cast<double>(pixels)) << "seed " << seed;
  }
}

TEST(LitScene, NeverNeedsMoreThanTenLayersThroughTheLensOfThePaper) {
  // From 1 m to 100 m there are 10.05 offsets of the bias, a bound for the layers of any scene.
  const LayerCamera picture = crop_of_paper(48, 36);
  const LensRays rays = LensRays::thin(picture, {.radius_mm = 9, .inverse_focus = 1 / 5000.0},
                                       petzval::vogel_points(100), {.nearest_mm = 1000});
  const petzval::PeelPlan plan = petzval::plan_peel(rays, 1000, 1e5);
  EXPECT_LE(plan.most_layers, 10);
  int most = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Soup soup(seed, 600, 5.0 * seed, 1000, 1e5, 0.04);
    SceneDescription scene = soup.scene();
    // A wall hides the sky.
    scene.objects.push_back(lamp(renderer::Quad{{-2e4f, -2e4f, -1e5f}, {4e4f, 0, 0}, {0, 4e4f, 0}}, {0, 1, 1}));
    const LitScene lit(scene);
    LayerSet layers;
    layers.peel(plan, 16, lit.peel(plan.camera, 2));
    EXPECT_LE(layers.count(), 10) << "seed " << seed;
    most = std::max(most, layers.count());
    // The layers are sufficient: no ray finds a hole.
    const petzval::BlurredImage blurred = petzval::gather(layers, rays, {.threads = 2, .highlights_above = 0});
    EXPECT_LE(static_cast<double>(blurred.missed_count), 1e-4 * static_cast<double>(blurred.ray_count));
  }
  EXPECT_GE(most, 8);
}

TEST(LitScene, IntegratesLampsOverPixels) {
  // A lamp between the centres of four pixels, alone and half hidden by a board just in front of it.
  const LayerCamera camera = crop_of_paper(12, 10);
  for (const float radius_px : {0.1f, 0.4f, 1.3f, 4.0f}) {
    for (const bool hidden : {false, true}) {
      constexpr float away = 20000;
      const float mm = away / static_cast<float>(camera.focal_px);
      const glm::vec3 centre{0.03f * mm, -0.02f * mm, -away};
      SceneDescription scene{.name = "lamp", .sky = {.colour = {0, 0, 0}}, .pose = {}};
      scene.objects.push_back(lamp(renderer::Sphere{centre, radius_px * mm}, {100, 50, 25}));
      if (hidden) {
        scene.objects.push_back(
            lamp(renderer::Quad{centre + mm * glm::vec3{-9, -9, 9}, {9 * mm, 0, 0}, {0, 18 * mm, 0}}, {0, 0, 0}));
      }
      const LitScene lit(scene);
      LayerSet layers;
      layers.peel({.camera = camera, .bias = 1e-4}, 4, lit.peel(camera, 2, 1e-4));
      double light = 0;
      for (std::size_t i = 0; i < 120; ++i) light += layers.rgba(0, i)[1];
      const double area = std::numbers::pi * radius_px * radius_px * (hidden ? 0.5 : 1);
      EXPECT_NEAR(light / (50 * area), 1, hidden ? 0.06 : 1e-3) << radius_px << ' ' << hidden;
    }
  }
}

TEST(References, PinholeEqualsTheFirstLayer) {
  const LayerCamera camera = crop_of_paper(51, 38);  // not multiples of the packet size
  const LitScene lit(Soup(7, 300, 4, 1000, 10000, 0.04).scene());
  LayerSet layers;
  layers.peel({.camera = camera, .bias = 1}, 1, lit.peel(camera, 1));
  const RgbImage seen = lit.reference(LensRays::thin(camera, {.radius_mm = 0}, petzval::vogel_points(3)), 1);
  int same = 0;
  for (int y = 0; y < camera.rows; ++y) {
    for (int x = 0; x < camera.columns; ++x)
      same += alike(colour_of(seen, x, y), colour_of(layers, 0, static_cast<std::size_t>(y * camera.columns + x)));
  }
  EXPECT_GE(same, 51 * 38 * 0.998);
}

/// Rays of a custom lens with custom weights.
LensRays own_rays(const LayerCamera& camera, int channels) {
  const petzval::LensRays::Source source = [=](int channel, const petzval::Vec2<double>& raster,
                                               std::span<const petzval::PupilPoint> points, std::span<LayerRay> found) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double turn = 2 * std::numbers::pi * points[i].u, radius = 40 * std::sqrt(points[i].v) * camera.focal_px;
      const petzval::Vec2<double> slope{radius * std::cos(turn), radius * std::sin(turn)};
      const double focus = 1 / 3000.0 + 2e-6 * raster.x + (channels == 3 ? 1e-5 * channel : 0);
      found[i] = {raster - slope * focus, slope, 0.5 + points[i].u};
    }
  };
  return LensRays(camera, petzval::vogel_points(9), channels, source, {.nearest_mm = 1000});
}

/// The reference image by the plain formula.
RgbImage plain_reference(const Soup& soup, const LensRays& rays) {
  const LayerCamera& camera = rays.camera();
  RgbImage picture(camera.columns, camera.rows);
  std::vector<LayerRay> found(rays.count());
  for (int y = 0; y < camera.rows; ++y) {
    for (int x = 0; x < camera.columns; ++x) {
      for (int c = 0; c < 3; ++c) {
        rays.exact_rays_at(rays.channels() == 3 ? c : 0, x, y, found);
        double sum = 0;
        for (const LayerRay& ray : found) {
          const petzval::Vec2<double> run = (ray.position - camera.axis) / camera.focal_px,
                                      from = ray.slope / camera.focal_px;
          const std::vector<Soup::Hit> hits = soup.hits({from.x, -from.y, 0}, {run.x, -run.y, 1});
          sum += ray.weight * static_cast<double>((hits.empty() ? sky : hits[0].colour)[c]);
        }
        picture.pixel(x, y)[c] = static_cast<float>(sum / static_cast<double>(found.size()));
      }
    }
  }
  return picture;
}

class ReferencesOf : public ::testing::TestWithParam<int> {};

TEST_P(ReferencesOf, AnyRaysEqualTheMeanOverTriangles) {
  const LayerCamera camera = crop_of_paper(25, 18);
  const Soup soup(3, 150, 4, 1000, 10000, 0.03);
  const LensRays rays = GetParam() > 0 ? own_rays(camera, GetParam())
                                       : LensRays::thin(camera, {.radius_mm = 40, .inverse_focus = 1 / 3000.0},
                                                        petzval::vogel_points(9), {.nearest_mm = 1000});
  ASSERT_EQ(rays.shift_invariant(), GetParam() == 0);
  // A ray that passes an edge within rounding may differ.
  EXPECT_LE(different(LitScene(soup.scene()).reference(rays, 2), plain_reference(soup, rays), 1e-4f), 3);
}

std::string name_of(int channels) { return channels == 0 ? "AThinLens" : channels == 1 ? "OneColour" : "ThreeColours"; }
INSTANTIATE_TEST_SUITE_P(References, ReferencesOf, ::testing::Values(0, 1, 3),
                         [](const auto& channels) { return name_of(channels.param); });

TEST(References, IndependentOfThreads) {
  const LayerCamera camera = crop_of_paper(40, 30);
  const LitScene lit(Soup(5, 200, 6, 1000, 10000, 0.03).scene());
  const LensRays rays = own_rays(camera, 3);
  EXPECT_EQ(lit.reference(rays, 1).pixels, lit.reference(rays, 3).pixels);
}

TEST(LitScene, MovesItsCamera) {
  // Moving the camera to the right equals moving the scene to the left.
  const LayerCamera camera = crop_of_paper(40, 30);
  const Soup soup(9, 200, 4, 1000, 10000, 0.04);
  Soup moved = soup;
  for (auto& [a, b, c, colour] : moved.triangles) {
    for (glm::dvec3* corner : {&a, &b, &c}) *corner -= glm::dvec3{30, -20, -50};
  }
  LitScene lit(soup.scene());
  const LitScene other(moved.scene());
  lit.move_to({30, -20, 50});
  const LensRays rays = own_rays(camera, 1);
  EXPECT_LE(different(lit.reference(rays, 2), other.reference(rays, 2), 1e-4f), 3);
  LayerSet a, b;
  const petzval::PeelPlan plan{.camera = camera, .bias = 1e-4};
  a.peel(plan, 4, lit.peel(camera, 1)), b.peel(plan, 4, other.peel(camera, 1));
  int same = 0;
  for (std::size_t i = 0; i < 1200; ++i) same += std::abs(a.inverse_depth(1)[i] - b.inverse_depth(1)[i]) <= 1e-8f;
  EXPECT_GE(same, 1190);
}

TEST(LitScene, IsBrighterTowardsTheSun) {
  // Diffuse emission is independent of the viewing direction.
  const auto seen = [](const glm::vec3& u, const glm::vec3& v) {
    SceneDescription scene{.name = "square", .sky = {.colour = {0.5f, 0.5f, 0.5f}}, .pose = {}};
    scene.objects.push_back({"square", renderer::Quad{glm::vec3{0, 0, -2000} - 0.5f * (u + v), u, v}});
    const LayerCamera camera = petzval::layer_camera(3, 3, petzval::radians(0.01));
    return LitScene(scene)
        .reference(LensRays::thin(camera, {.radius_mm = 0}, petzval::vogel_points(1)), 1)
        .pixel(1, 1)[0];
  };
  const float towards = seen({100, 0, 0}, {0, 100, 0}), left = seen({100, 0, 100}, {0, 100, 0}),
              right = seen({100, 0, -100}, {0, 100, 0});
  EXPECT_GT(towards, 0.05f);
  EXPECT_LT(towards, 1);
  EXPECT_NE(left, right);
}

TEST(LitScene, RefusesInvalidScenes) {
  SceneDescription scene{.name = "flawed", .pose = {}};
  scene.objects.push_back({"ghost", renderer::Mesh{}});
  expect_error([&] { LitScene lit(scene); }, {"ghost"});
  scene.objects.clear();
  scene.pose.look_at = scene.pose.position;
  expect_error([&] { LitScene lit(scene); }, {"pose"});
}

}  // namespace
