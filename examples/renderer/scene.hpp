// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "renderer/scene_description.hpp"

namespace renderer {

/// A point of a surface.
struct SurfacePoint {
  glm::vec3 position{0, 0, 0};
  glm::vec3 normal{0, 0, 1};   ///< unit geometric normal, outwards
  glm::vec3 shading{0, 0, 1};  ///< unit shading normal, interpolated between the vertices of a mesh
  glm::vec2 uv{0, 0};
  const Object* object = nullptr;
  float reach = 0;  ///< offset of ray origins that avoids a second hit by rounding, mm
};

/// A point where light begins: on a lamp or in the sky.
struct LightPoint {
  std::optional<SurfacePoint> surface;  ///< nullopt: in the sky
  glm::vec3 travel{0, 0, 0};            ///< direction of light from the sky
  Rgb radiance{0, 0, 0};
  double pdf = 0;  ///< density of the point on all lamps, 1/mm^2, or of the direction, 1/sr

  explicit operator bool() const noexcept { return pdf > 0; }
};

/// The scene for tracing, with its lights. Immutable and thread-safe.
class Scene {
 public:
  /// @throws petzval::Error if an object has no area
  explicit Scene(SceneDescription description);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const SceneDescription& description() const noexcept;

  /// The first surface on a ray. Directions have unit length, here and below.
  std::optional<SurfacePoint> meet(const glm::vec3& origin, const glm::vec3& direction) const noexcept;
  /// The origin of a ray that leaves a surface.
  static glm::vec3 leave(const SurfacePoint& from, const glm::vec3& direction) noexcept;
  /// True if no object is between a surface and a point, a surface, or the sky.
  bool sees(const SurfacePoint& from, const glm::vec3& to) const noexcept;
  bool sees(const SurfacePoint& from, const SurfacePoint& to) const noexcept;
  bool sees_sky(const glm::vec3& from, const glm::vec3& direction) const noexcept;

  bool has_light() const noexcept;
  /// A point where light begins, sampled by power; empty without lamps and sky.
  LightPoint sample_light(float pick, float u, float v) const noexcept;
  /// Densities of sample_light() for a lamp point and for a direction of travel from the sky.
  double pdf_light(const SurfacePoint& lamp) const noexcept;
  double pdf_sky(const glm::vec3& travel) const noexcept;
  /// Radiance of the sky, by direction of travel.
  Rgb sky(const glm::vec3& travel) const noexcept;
  /// Radiance that a surface emits in a direction away from it.
  static Rgb emission(const SurfacePoint& lamp, const glm::vec3& away) noexcept;
  /// A disc across the direction of travel that admits the sky's light to all objects: a point by u and v, and the
  /// area, which is the same for all directions.
  glm::vec3 sky_entry(const glm::vec3& travel, float u, float v) const noexcept;
  double sky_entry_area() const noexcept;

  /// The opaque solid that encloses a point: a sphere, or a mesh seen from behind. Null if no single solid does.
  const Object* around(const glm::vec3& point) const noexcept;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace renderer
