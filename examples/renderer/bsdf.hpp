// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/frame.hpp"
#include "renderer/path_colours.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// What a path carries away from its first end: radiance from a lamp is seen from the lens, power goes out from the
/// lamp.
enum class Carries : std::uint8_t { radiance, power };

/// How a surface scatters light between two directions away from it, both in the world and of unit length.
///
/// Surfaces scatter on both sides; glass is inside where its normal points away from.
/// Sources: Walter et al., Microfacet models for refraction through rough surfaces, 2007 (GGX); Heitz, Sampling the GGX
/// distribution of visible normals, 2018; Schlick's Fresnel term for metals. Below a varnish light is scattered as
/// Lambert has it, inside the coat too.
class Bsdf {
 public:
  /// wo: towards where the path came from.
  Bsdf(const SurfacePoint& point, const glm::vec3& wo, const PathColours& colours) noexcept;

  /// A mirror, or smooth glass: there is nothing to be evaluated.
  bool specular() const noexcept { return specular_; }
  /// The share of paths that go on: the largest reflectance in RGB, which wavelengths and directions leave as it is.
  double goes_on() const noexcept { return goes_on_; }

  /// The BSDF times the cosine at the surface of the direction wi, as an estimator wants it: of power, with the
  /// correction for interpolated normals. Source: Veach, Robust Monte Carlo methods for light transport simulation,
  /// 1997, section 5.3.
  Lanes times_cosine(const glm::vec3& wi, Carries carries) const noexcept;
  /// The density of sampling wi for wo, and wo for wi, 1/sr.
  double pdf(const glm::vec3& wi) const noexcept;
  double pdf_reverse(const glm::vec3& wi) const noexcept;

  struct Sample {
    glm::vec3 wi{0, 0, 1};
    Lanes weight{0};  ///< times_cosine() / pdf
    double pdf = 0, pdf_reverse = 0;
    bool specular = false;
  };
  std::optional<Sample> sample(float choice, float u, float v, Carries carries) const noexcept;

 private:
  Lanes value(const glm::vec3& o, const glm::vec3& i, Carries carries) const noexcept;
  double density(const glm::vec3& o, const glm::vec3& i) const noexcept;
  std::optional<Sample> sample_specular(float choice, Carries carries) const noexcept;
  /// What normals other than the surface's own change for power.
  float correction(const glm::vec3& wi, Carries carries) const noexcept;
  bool same_side(const glm::vec3& wi) const noexcept;
  double coat_share(const glm::vec3& o) const noexcept;

  const Material& material_;
  glm::vec3 normal_;  ///< of the surface
  glm::vec3 wo_, o_;  ///< in the world, and about the shading normal
  Frame frame_;
  Lanes colour_{1};  ///< albedo or reflectance
  float alpha_ = 0;
  double goes_on_ = 1;
  bool specular_ = false, through_ = false;
};

}  // namespace renderer
