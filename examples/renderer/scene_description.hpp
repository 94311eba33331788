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

/// A small renderer with lenses as cameras; not part of the library.
namespace renderer {

/// Colour in linear Rec. 709.
using Rgb = glm::vec3;

/// Fraction of light that a surface scatters back, 0 to 1 in each channel.
struct Albedo {
  struct Checker {
    Rgb other{0, 0, 0};
    float size_mm = 10;  ///< edge of the axis-aligned cubes, one centred at the origin
  };

  Rgb colour{0.5f, 0.5f, 0.5f};
  std::optional<Checker> checker{};
  /// Replaces colour and checker; mapped to the texture coordinates and repeated. (0, 0) is the lower left corner.
  std::shared_ptr<const petzval::RgbImage> image{};
};

/// A Lambertian surface.
struct Diffuse {
  Albedo albedo{};
};
struct Mirror {
  Rgb reflectance{0.9f, 0.9f, 0.9f};
};
/// A rough metal. Roughness is the alpha of GGX, 0.01 to 1.
struct Rough {
  Rgb reflectance{0.9f, 0.9f, 0.9f};  ///< of its facets at normal incidence
  float roughness = 0.2f;
};
/// A transparent dielectric; smooth if its roughness is 0.
struct Glass {
  float ior = 1.5f;
  float roughness = 0;
};
/// A diffuse surface below a rough clear coat of index 1.5, like lacquered wood.
struct Varnish {
  Albedo albedo{};
  float roughness = 0.1f;
};
using Material = std::variant<Diffuse, Mirror, Rough, Glass, Varnish>;

struct Sphere {
  glm::vec3 centre{0, 0, 0};
  float radius = 1;
};
/// A parallelogram whose front, which emits, faces along edge_u x edge_v.
struct Quad {
  glm::vec3 corner{0, 0, 0}, edge_u{1, 0, 0}, edge_v{0, 1, 0};
};
/// Triangles, counter-clockwise seen from the front, which emits.
struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<glm::vec3> normals{};  ///< one per position, or empty for flat triangles
  std::vector<glm::vec2> uvs{};      ///< one per position, or empty
};
using Shape = std::variant<Sphere, Quad, Mesh>;

/// An object in the world, which is right-handed, y up, mm.
struct Object {
  std::string name;  ///< for messages: "scene.json: objects[3]"
  Shape shape;
  Material material = Diffuse{};
  Rgb emission{0, 0, 0};  ///< radiance
};

/// The environment: the radiance `colour`, or an image over the sphere of directions times `colour`. The centre of the
/// image is in direction -z, its upper edge up, its left and right edges behind.
struct Sky {
  Rgb colour{0, 0, 0};
  std::shared_ptr<const petzval::RgbImage> image{};
};

/// The camera: the centre of the entrance pupil is at `position` and the axis passes through `look_at`. The pupil is
/// taken at the primary wavelength; for an object-space telecentric lens the first vertex replaces it.
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
