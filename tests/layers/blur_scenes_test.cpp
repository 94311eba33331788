// SPDX-License-Identifier: Apache-2.0
#include "layers/blur_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <string>
#include <variant>
#include <vector>

#include "layers/lit_scene.hpp"
#include "petzval/core/geometry.hpp"

namespace {

using namespace lens_blur;

std::size_t triangles(const renderer::SceneDescription& scene) {
  std::size_t count = 0;
  for (const renderer::Object& object : scene.objects) {
    if (const auto* const mesh = std::get_if<renderer::Mesh>(&object.shape)) count += mesh->triangles.size();
  }
  return count;
}

TEST(BlurScenes, HaveTheNamesInTheHelp) {
  std::string names;
  for (const char* name : {"town", "miniature", "lights", "statues", "knot", "leaves", "street"}) {
    const auto scene = blur_scene(name);
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->name, name);
    names += (names.empty() ? "" : ", ") + scene->name;
  }
  EXPECT_EQ(names, blur_scene_names);
  EXPECT_FALSE(blur_scene("moon"));
}

struct Wanted {
  const char* name;
  std::size_t least_triangles, most_triangles;  ///< of the meshes
  double nearest_mm;                            ///< lower bound
  double near_mm;                               ///< upper bound for the nearest surface
  double deep;                                  ///< lower bound for the mean number of surfaces behind each other
};

void PrintTo(const Wanted& scene, std::ostream* out) { *out << scene.name; }

class BlurScene : public ::testing::TestWithParam<Wanted> {};

TEST_P(BlurScene, HasSurfacesInFrontOfAndBehindTheFocus) {
  const renderer::SceneDescription scene = blur_scene(GetParam().name).value();
  EXPECT_GE(triangles(scene), GetParam().least_triangles);
  EXPECT_LE(triangles(scene), GetParam().most_triangles);

  const LitScene lit(scene);
  const petzval::LayerCamera camera = petzval::layer_camera(120, 90, petzval::radians(30.0));
  const double nearest = lit.nearest_mm(camera, 2);
  EXPECT_GE(nearest, GetParam().nearest_mm);
  EXPECT_LE(nearest, GetParam().near_mm);

  // A tiny bias peels all surfaces.
  petzval::LayerSet layers;
  layers.peel({.camera = camera, .bias = 1e-8}, 64, lit.peel(camera, 2));
  const auto first = layers.inverse_depth(0);
  const auto share = [&](const auto& holds) {
    return static_cast<double>(std::ranges::count_if(first, holds)) / static_cast<double>(first.size());
  };
  EXPECT_GT(share([](float w) { return w > 1 / 4500.0f; }), 0.04);
  EXPECT_GT(share([](float w) { return w < 1 / 5500.0f; }), 0.04);

  std::size_t surfaces = 0;
  for (int layer = 0; layer < layers.count(); ++layer)
    surfaces +=
        static_cast<std::size_t>(std::ranges::count_if(layers.inverse_depth(layer), [](float w) { return w >= 0; }));
  EXPECT_GE(static_cast<double>(surfaces) / static_cast<double>(first.size()), GetParam().deep);
}

INSTANTIATE_TEST_SUITE_P(BlurScenes, BlurScene,
                         ::testing::Values(Wanted{"town", 90000, 130000, 1000, 2600, 3},
                                           Wanted{"statues", 500000, 1500000, 1000, 3500, 2},
                                           Wanted{"knot", 850000, 950000, 1000, 2600, 2},
                                           Wanted{"leaves", 240000, 240000, 1000, 2600, 12}),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST(BlurScenes, RoofsFaceUp) {
  for (const renderer::Object& object : town_scene().objects) {
    if (object.name != "roof") continue;
    const auto& mesh = std::get<renderer::Mesh>(object.shape);
    for (std::size_t i = 0; i < 4; ++i) {  // the slopes; then the gables
      const auto& [a, b, c] = mesh.triangles[i];
      EXPECT_GT(glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).y, 0);
    }
  }
}

TEST(BlurScenes, AreDeterministic) {
  const renderer::SceneDescription a = town_scene(), b = town_scene();
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const auto *const m = std::get_if<renderer::Mesh>(&a.objects[i].shape), *const n = std::get_if<renderer::Mesh>(
                                                                                &b.objects[i].shape);
    ASSERT_EQ(m == nullptr, n == nullptr);
    if (m) {
      EXPECT_EQ(m->positions, n->positions);
    }
  }
}

}  // namespace
