// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/frame.hpp"
#include "renderer/path_colours.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// Quantity carried by a path: radiance for paths from the lens, power for paths from a lamp.
enum class Carries : std::uint8_t { radiance, power };

/// Scattering of light by a surface between two directions that point away from it (world frame, unit length).
///
/// Surfaces scatter on both sides; the inside of glass is opposite to its normal. Below a varnish the light is
/// scattered by Lambert's law, also inside the coat.
/// Sources: Walter et al., Microfacet models for refraction through rough surfaces, 2007 (GGX); Heitz, Sampling the GGX
/// distribution of visible normals, 2018; Schlick's Fresnel term for metals.
class Bsdf {
 public:
  /// wo: direction towards the previous vertex of the path.
  Bsdf(const SurfacePoint& point, const glm::vec3& wo, const PathColours& colours) noexcept;

  /// True for a mirror or smooth glass, which cannot be evaluated, only sampled.
  bool specular() const noexcept { return specular_; }
  /// Fraction of paths that continue: the largest reflectance in RGB, independent of wavelengths and directions.
  double goes_on() const noexcept { return goes_on_; }

  /// The BSDF times the cosine of wi at the surface. For power it includes the correction for interpolated normals.
  /// Source: Veach, Robust Monte Carlo methods for light transport simulation, 1997, section 5.3.
  Lanes times_cosine(const glm::vec3& wi, Carries carries) const noexcept;
  /// Densities of sampling wi given wo, and wo given wi, 1/sr.
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
  /// Correction of power for interpolated normals.
  float correction(const glm::vec3& wi, Carries carries) const noexcept;
  bool same_side(const glm::vec3& wi) const noexcept;
  double coat_fraction(const glm::vec3& o) const noexcept;

  const Material& material_;
  glm::vec3 normal_;  ///< normal of the surface
  glm::vec3 wo_, o_;  ///< world frame, and frame of the shading normal
  Frame frame_;
  Lanes colour_{1};  ///< albedo or reflectance
  float alpha_ = 0;
  double goes_on_ = 1;
  bool specular_ = false, through_ = false;
};

}  // namespace renderer
