// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "renderer/built_in_scenes.hpp"
#include "renderer/chess_pieces.hpp"
#include "renderer/solids.hpp"

namespace renderer {

SceneDescription table_scene() {
  SceneDescription scene{.name = "table", .sky = {.colour = {0.028f, 0.031f, 0.04f}}};

  // The table is round, so that the corners of the picture look past it into the dark.
  constexpr float radius = 165;
  constexpr std::array profile{ProfilePoint{0, -8}, ProfilePoint{radius - 3, -8, 0.4f}, ProfilePoint{radius, -4, 0.4f},
                               ProfilePoint{radius - 2, 0}, ProfilePoint{0, 0}};
  scene.objects.push_back(
      {"table", lathe(profile, 160),
       Varnish{{.colour = {0.58f, 0.44f, 0.28f}, .checker = Albedo::Checker{{0.30f, 0.17f, 0.09f}, 22}}, 0.2f}});

  // Pawns and balls in rows across the table.
  constexpr std::array colours{Rgb{0.62f, 0.08f, 0.05f}, Rgb{0.80f, 0.70f, 0.50f}, Rgb{0.05f, 0.22f, 0.40f},
                               Rgb{0.75f, 0.42f, 0.06f}, Rgb{0.06f, 0.30f, 0.14f}};
  constexpr float across = 44, along = 50, ball = 11;
  for (int row = -2; row <= 2; ++row) {
    for (int column = -3; column <= 3; ++column) {
      const glm::vec3 foot{across * (static_cast<float>(column) + (row % 2 == 0 ? 0.0f : 0.5f)), 0,
                           along * static_cast<float>(row)};
      if (glm::length(foot) > radius - 20) continue;
      const Varnish paint{{.colour = colours[static_cast<std::size_t>(2 * row + column + 12) % colours.size()]}, 0.06f};
      if ((row + column) % 2 == 0) {
        scene.objects.push_back({"pawn", placed(chess_piece(ChessPiece::pawn), foot), paint});
      } else {
        scene.objects.push_back({"ball", Sphere{foot + glm::vec3{0, ball, 0}, ball}, paint});
      }
    }
  }

  constexpr double azimuth = 14 * std::numbers::pi / 180, elevation = 28 * std::numbers::pi / 180;
  const glm::dvec3 target{0, 8, 0};
  const glm::dvec3 back{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                        std::cos(azimuth) * std::cos(elevation)};
  scene.pose = {.position = target + 980.0 * back, .look_at = target};

  const Diffuse black{{.colour = {0, 0, 0}}};
  scene.objects.push_back({"key light", Sphere{{-650, 900, 150}, 170}, black, {62, 57, 50}});
  scene.objects.push_back({"rim light", Sphere{{500, 420, -800}, 110}, black, {34, 40, 50}});

  // Lamps far behind: tangents right and up of the axis, and distance.
  struct Lamp {
    double right, up, distance;
    Rgb emission;
  };
  constexpr Rgb warm{60, 36, 15}, red{52, 10, 5}, cold{22, 32, 52};
  constexpr std::array lamps{
      Lamp{-0.141, 0.088, 2600, warm}, Lamp{-0.103, 0.091, 3300, cold},  Lamp{-0.056, 0.084, 2900, warm},
      Lamp{-0.010, 0.091, 2500, red},  Lamp{0.040, 0.085, 3200, warm},   Lamp{0.092, 0.091, 2700, cold},
      Lamp{0.140, 0.087, 3000, warm},  Lamp{-0.140, -0.087, 2800, cold}, Lamp{-0.095, -0.090, 3100, warm},
      Lamp{0.098, -0.090, 2600, warm}, Lamp{0.141, -0.086, 3100, cold},  Lamp{-0.145, 0.044, 3500, red},
      Lamp{0.146, 0.041, 3300, red}};
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3{0, 1, 0}, back)), up = glm::cross(back, right);
  for (const Lamp& lamp : lamps) {
    const glm::dvec3 centre = scene.pose.position + lamp.distance * (lamp.right * right + lamp.up * up - back);
    scene.objects.push_back({"lamp", Sphere{centre, 8}, black, lamp.emission});
  }
  return scene;
}

}  // namespace renderer
