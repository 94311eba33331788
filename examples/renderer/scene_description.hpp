// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "petzval/image/image.hpp"

/// A small renderer that sees its scenes through lenses, not a part of the library.
namespace renderer {

/// Linear Rec. 709.
using Rgb = glm::vec3;

/// The share of light that a surface scatters back, 0 to 1 in each channel.
struct Albedo {
  struct Checker {
    Rgb other{0, 0, 0};
    float size_mm = 10;  ///< edge of its cubes, along the axes of the world; the middle of one is the origin
  };

  Rgb colour{0.5f, 0.5f, 0.5f};
  std::optional<Checker> checker{};
  /// Instead of both, over the texture coordinates, repeated; (0, 0) is its lower left corner.
  std::shared_ptr<const petzval::RgbImage> image{};
};

/// Lambert's surface.
struct Diffuse {
  Albedo albedo{};
};
struct Mirror {
  Rgb reflectance{0.9f, 0.9f, 0.9f};
};
/// A rough metal. Roughness is that of GGX (its alpha), 0.01 to 1.
struct Rough {
  Rgb reflectance{0.9f, 0.9f, 0.9f};  ///< of light that meets its facets head-on
  float roughness = 0.2f;
};
/// A dielectric that light passes; of roughness 0 it is smooth.
struct Glass {
  float ior = 1.5f;
  float roughness = 0;
};
/// A diffuse surface below a rough clear coat of index 1.5, as of lacquered wood.
struct Varnish {
  Albedo albedo{};
  float roughness = 0.1f;
};
using Material = std::variant<Diffuse, Mirror, Rough, Glass, Varnish>;

struct Sphere {
  glm::vec3 centre{0, 0, 0};
  float radius = 1;
};
/// A parallelogram; it looks, and emits, along edge_u x edge_v.
struct Quad {
  glm::vec3 corner{0, 0, 0}, edge_u{1, 0, 0}, edge_v{0, 1, 0};
};
/// Triangles, counter-clockwise seen from the side that they look to and emit to.
struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<glm::vec3> normals{};  ///< of the positions, or empty: flat triangles
  std::vector<glm::vec2> uvs{};      ///< of the positions, or empty
};
using Shape = std::variant<Sphere, Quad, Mesh>;

/// World: right-handed, y up, mm.
struct Object {
  std::string name;  ///< for messages: "scene.json: objects[3]"
  Shape shape;
  Material material = Diffuse{};
  Rgb emission{0, 0, 0};  ///< radiance
};

/// What lies beyond all objects: the radiance `colour`, or an image over the sphere of directions, its middle in
/// direction -z, its upper edge up, its left edge and its right edge behind, times `colour`.
struct Sky {
  Rgb colour{0, 0, 0};
  std::shared_ptr<const petzval::RgbImage> image{};
};

/// Where the camera is: the middle of its entrance pupil (at the primary wavelength, for a lens that is telecentric
/// there its first vertex) at `position`, its axis through `look_at`.
struct Pose {
  glm::dvec3 position{0, 0, 0}, look_at{0, 0, -1}, up{0, 1, 0};
};

struct SceneDescription {
  std::string name{};
  std::vector<Object> objects{};
  Sky sky{};
  Pose pose{};
};

}  // namespace renderer
