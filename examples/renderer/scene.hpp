// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "renderer/scene_description.hpp"

namespace renderer {

/// A point of a surface.
struct SurfacePoint {
  glm::vec3 position{0, 0, 0};
  glm::vec3 normal{0, 0, 1};   ///< unit, of the surface itself, outwards
  glm::vec3 shading{0, 0, 1};  ///< unit, interpolated between those of a mesh's corners
  glm::vec2 uv{0, 0};
  const Object* object = nullptr;
  float reach = 0;  ///< how far rays start from the surface, so as not to meet it again: its rounding
};

/// A place where light begins: on a lamp, or in the sky.
struct LightPoint {
  std::optional<SurfacePoint> surface;  ///< nothing: in the sky
  glm::vec3 travel{0, 0, 0};            ///< of light from the sky: its direction
  Rgb radiance{0, 0, 0};
  double pdf = 0;  ///< of the place among all lamps, 1/mm^2, or of the direction, 1/sr

  explicit operator bool() const noexcept { return pdf > 0; }
};

/// What Embree traces, and where its light comes from. Immutable, shared freely between threads.
class Scene {
 public:
  /// Throws petzval::Error for an object without area.
  explicit Scene(SceneDescription description);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const SceneDescription& description() const noexcept;

  /// The first surface on the way. The direction has unit length, here and below.
  std::optional<SurfacePoint> meet(const glm::vec3& origin, const glm::vec3& direction) const noexcept;
  /// The origin of a ray that leaves a surface.
  static glm::vec3 leave(const SurfacePoint& from, const glm::vec3& direction) noexcept;
  /// Whether nothing stands between a surface and a place, a surface, or what lies beyond all objects.
  bool sees(const SurfacePoint& from, const glm::vec3& to) const noexcept;
  bool sees(const SurfacePoint& from, const SurfacePoint& to) const noexcept;
  bool sees_sky(const glm::vec3& from, const glm::vec3& direction) const noexcept;

  bool has_light() const noexcept;
  /// A place where light begins, by power. None without lamps and sky.
  LightPoint sample_light(float pick, float u, float v) const noexcept;
  /// The density with which sample_light() gives a point of a lamp, and a direction of travel from the sky.
  double pdf_light(const SurfacePoint& lamp) const noexcept;
  double pdf_sky(const glm::vec3& travel) const noexcept;
  /// Radiance from a direction of travel.
  Rgb sky(const glm::vec3& travel) const noexcept;
  /// What a surface emits in a direction away from it.
  static Rgb emission(const SurfacePoint& lamp, const glm::vec3& away) noexcept;
  /// A disc across the direction of travel through which the sky lights all objects: its point by u and v, and its
  /// area, which is that of all directions.
  glm::vec3 sky_entry(const glm::vec3& travel, float u, float v) const noexcept;
  double sky_entry_area() const noexcept;

  /// The solid that encloses a place on all sides: a sphere, or a mesh seen from behind, that light cannot pass. Null
  /// for none.
  const Object* around(const glm::vec3& point) const noexcept;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace renderer
