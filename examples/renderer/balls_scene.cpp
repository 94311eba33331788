// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdlib>
#include <string>

#include "renderer/built_in_scenes.hpp"
#include "renderer/solids.hpp"

namespace renderer {

SceneDescription balls_scene() {
  SceneDescription scene{.name = "balls", .sky = {.colour = {0.02f, 0.022f, 0.026f}}};

  // A convex mirror of radius r images a distant lamp r/2 in front of its centre: here the highlights are 1050 mm away.
  // The balls are metal, because a varnish reflects only 1/20 of the light and its blurred highlights would be lost in
  // the light of the table. The spacing keeps the blur discs of an f/1.35 lens (18 mm at 800 mm) apart and weakens the
  // mutual reflections of the balls.
  constexpr float radius = 9, spacing = 25, highlights_z = -1050;
  constexpr std::array metals{Rgb{0.88f, 0.88f, 0.90f}, Rgb{0.90f, 0.70f, 0.40f}, Rgb{0.90f, 0.58f, 0.46f}};
  for (int i = -6; i <= 6; ++i) {
    const glm::vec3 centre{spacing * static_cast<float>(i), 0, highlights_z - radius / 2};
    const Rgb metal = metals[static_cast<std::size_t>(std::abs(i)) % metals.size()];
    scene.objects.push_back({"ball " + std::to_string(i), Sphere{centre, radius}, Rough{metal, 0.02f}});
  }

  // The table ends in front of the balls, otherwise it would hide the lower part of the lens from the balls.
  const Diffuse felt{{.colour = {0.015f, 0.017f, 0.021f}}};
  scene.objects.push_back({"table", box({-1500, -600, -1500}, {1500, -radius, -950}), felt});
  scene.objects.push_back({"backdrop", Quad{{-1500, -radius, -1500}, {3000, 0, 0}, {0, 1500, 0}}, felt});

  // Behind and above the camera, so that the highlight of each ball is near its centre. Out of focus the highlights
  // have radiances of 0.5 to 3.
  scene.objects.push_back({"lamp", Sphere{{0, 700, 500}, 240}, Diffuse{{.colour = {0, 0, 0}}}, {132, 132, 132}});
  return scene;
}

}  // namespace renderer
