// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// Tolerance of unit vectors: a ray is lost unless its direction d has |dot(d, d) - 1| below this value.
///
/// A direction that was normalised in float is within 4e-7. Exact rays correct the length; the other ray models leave
/// the error in the result.
inline constexpr double unit_direction_tolerance = 1e-3;

/// A ray in the lens frame.
///
/// The lens frame is right-handed and in mm, with its origin at the vertex of the first surface. Light from the scene
/// to the film travels towards +z.
template <class T>
struct Ray {
  Vec3<T> origin{0, 0, 0};
  Vec3<T> direction{0, 0, 1};  ///< unit vector (unit_direction_tolerance)
};

/// Rays as a structure of arrays: N values each, lens frame (mm), unit directions (unit_direction_tolerance).
template <class T>
struct RayArrays {
  T* x = nullptr;
  T* y = nullptr;
  T* z = nullptr;
  T* dx = nullptr;
  T* dy = nullptr;
  T* dz = nullptr;

  /// The rays from a position on.
  RayArrays from(std::size_t ray) const noexcept { return {x + ray, y + ray, z + ray, dx + ray, dy + ray, dz + ray}; }
};

/// Direction of travel through the lens.
///
/// It determines the order of surfaces and indices and the root of each
/// intersection. The sign of the ray's z component does not: a fisheye accepts rays that run towards -z.
enum class Travel : std::uint8_t { to_film, to_scene };

/// The result of tracing a ray. Every fate except `transmitted` is a loss.
enum class RayFate : std::uint8_t {
  transmitted,        ///< passed the last surface of the request
  missed_surface,     ///< does not meet the surface, or only its far sheet; in trace() also an invalid ray
  totally_reflected,  ///< beyond the critical angle
  vignetted,          ///< outside the clear aperture (or the defined area of an asphere), or in the central obscuration
  no_convergence,     ///< the iteration for an asphere did not converge
  outside_fit,        ///< outside the domain of a fitted model of the lens
  outside_film,       ///< starts or ends outside the film of a camera
  invalid,            ///< cameras: a number is not finite, or the direction is no unit vector
  outside_spectrum,   ///< cameras: wavelength outside the compiled range (CameraOptions::clamp_wavelengths)
};

/// The name of a fate: "transmitted", "missed_surface", ...
PETZVAL_API std::string_view name(RayFate fate) noexcept;

/// A traced ray. All its values are finite.
///
/// ray.origin is the intersection with the last surface that the ray reached. ray.direction is the direction after that
/// surface, or before that surface if the ray was lost at it. A ray lost as missed_surface or no_convergence did not
/// reach its last surface: ray.origin is the intersection with the surface before, or the given origin at the first
/// surface.
template <class T>
struct TracedRay {
  Ray<T> ray;
  RayFate fate = RayFate::transmitted;
  int surface = -1;  ///< from 0: the last surface passed if transmitted, else the surface where the ray was lost

  bool transmitted() const noexcept { return fate == RayFate::transmitted; }
};

}  // namespace petzval
