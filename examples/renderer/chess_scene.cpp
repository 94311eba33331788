// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cctype>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "renderer/built_in_scenes.hpp"
#include "renderer/chess_pieces.hpp"
#include "renderer/solids.hpp"

namespace renderer {
namespace {

constexpr float square = 40;
/// Centre of the board: cubes of the checker are centred at multiples of their edge.
constexpr glm::vec3 middle{square / 2, 0, square / 2};

constexpr Rgb boxwood{0.74f, 0.60f, 0.40f}, ebony{0.045f, 0.032f, 0.028f};

std::optional<ChessPiece> piece_of(char letter) {
  switch (std::tolower(static_cast<unsigned char>(letter))) {
    case 'p': return ChessPiece::pawn;
    case 'r': return ChessPiece::rook;
    case 'n': return ChessPiece::knight;
    case 'b': return ChessPiece::bishop;
    case 'q': return ChessPiece::queen;
    case 'k': return ChessPiece::king;
    default: return {};
  }
}

/// Places the pieces of a position in Forsyth-Edwards notation: rows from the far side, digits for empty squares,
/// capitals for white.
void set_up(SceneDescription& scene, std::string_view position) {
  int column = 0, row = 0;
  for (const char letter : position) {
    if (letter == '/') {
      column = 0, ++row;
    } else if (const auto piece = piece_of(letter)) {
      const bool white = std::isupper(static_cast<unsigned char>(letter));
      const auto steps = [](int i) { return square * (static_cast<float>(i) - 3.5f); };
      // Rotated slightly, as if placed by hand; knights and the bar of the king's cross are oblique to the opponent.
      const float turn_deg = (white ? 40.0f : -155.0f) + static_cast<float>(column * 31 % 17);
      Mesh mesh = placed(chess_piece(*piece), middle + glm::vec3{steps(column), 0, steps(row)}, turn_deg);
      scene.objects.push_back({std::string("piece ") + letter, std::move(mesh),
                               Varnish{{.colour = white ? boxwood : ebony}, white ? 0.12f : 0.08f}});
      ++column;
    } else {
      column += letter - '0';
    }
  }
}

/// A square lamp that faces a point.
Object panel(const char* name, const glm::vec3& centre, const glm::vec3& towards, float width, const Rgb& emission) {
  const glm::vec3 facing = glm::normalize(towards - centre);
  const glm::vec3 v = width * glm::normalize(glm::cross(glm::vec3{1, 0, 0}, facing)), u = glm::cross(v, facing);
  return {name, Quad{centre - (u + v) * 0.5f, u, v}, Diffuse{{.colour = {0, 0, 0}}}, emission};
}

}  // namespace

SceneDescription chess_scene() {
  SceneDescription scene{.name = "chess", .sky = {.colour = {0.055f, 0.065f, 0.085f}}};

  // Seen across a corner of the board, 950 mm from its centre.
  constexpr double azimuth = 28 * std::numbers::pi / 180, elevation = 12 * std::numbers::pi / 180;
  const glm::dvec3 target = glm::dvec3(middle) + glm::dvec3{10, 26, 0};
  const glm::dvec3 back{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                        std::cos(azimuth) * std::cos(elevation)};
  scene.pose = {.position = target + 950.0 * back, .look_at = target};

  const Varnish squares{{.colour = {0.66f, 0.52f, 0.34f}, .checker = Albedo::Checker{{0.15f, 0.07f, 0.035f}, square}},
                        0.15f};
  constexpr float half = 4 * square, border = 22;
  scene.objects.push_back(
      {"squares", Quad{middle + glm::vec3{-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}}, squares});
  const glm::vec3 reach{half + border, 0, half + border};
  scene.objects.push_back({"board", box(middle - reach - glm::vec3{0, 20, 0}, middle + reach - glm::vec3{0, 0.5f, 0}),
                           Varnish{{.colour = {0.10f, 0.045f, 0.025f}}, 0.2f}});
  scene.objects.push_back({"table", box(middle + glm::vec3{-700, -60, -400}, middle + glm::vec3{700, -20, 700}),
                           Varnish{{.colour = {0.055f, 0.05f, 0.045f}}, 0.3f}});
  set_up(scene, "3r2k1/pp3ppp/2n1b3/3qp3/8/2N1PN2/PPQ2PPP/3R2K1");

  scene.objects.push_back(panel("window", middle + glm::vec3{-700, 900, 300}, middle, 500, {27, 25, 22.5f}));
  scene.objects.push_back(panel("rim light", middle + glm::vec3{550, 500, -800}, middle, 250, {16, 18, 21}));

  // Lamps in the dark behind the table: tangents right and up of the axis, and distance.
  struct Lamp {
    double right, up, distance;
    Rgb emission;
  };
  constexpr Rgb warm{52, 33, 15}, red{48, 9, 5}, cold{20, 29, 46};
  constexpr std::array lamps{
      Lamp{-0.150, 0.088, 2300, warm}, Lamp{-0.105, 0.072, 3100, warm}, Lamp{-0.070, 0.096, 2700, cold},
      Lamp{-0.028, 0.078, 3500, warm}, Lamp{0.012, 0.094, 2500, red},   Lamp{0.055, 0.074, 3300, warm},
      Lamp{0.088, 0.097, 2900, warm},  Lamp{0.125, 0.080, 3600, cold},  Lamp{0.158, 0.092, 2600, warm}};
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3{0, 1, 0}, back)), up = glm::cross(back, right);
  for (const Lamp& lamp : lamps) {
    const glm::dvec3 centre = scene.pose.position + lamp.distance * (lamp.right * right + lamp.up * up - back);
    scene.objects.push_back({"lamp", Sphere{centre, 8}, Diffuse{{.colour = {0, 0, 0}}}, lamp.emission});
  }
  return scene;
}

}  // namespace renderer
