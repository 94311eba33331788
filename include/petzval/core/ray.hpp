// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// A direction counts as a unit vector d if | d . d - 1 | is less than this; others lose their ray. Directions that
/// were normalised in float are within 4e-7. Exact rays correct the length; the other models leave the error in the
/// result.
inline constexpr double unit_direction_tolerance = 1e-3;

/// A ray in the lens frame: millimetres, right-handed, origin at the vertex of the first surface, light from
/// scene to film travels towards +z.
template <class T>
struct Ray {
  Vec3<T> origin{0, 0, 0};
  Vec3<T> direction{0, 0, 1};  ///< unit vector (unit_direction_tolerance)
};

/// Rays as a structure of arrays: N values each, lens frame, unit directions (unit_direction_tolerance).
template <class T>
struct RayArrays {
  T* x = nullptr;
  T* y = nullptr;
  T* z = nullptr;
  T* dx = nullptr;
  T* dy = nullptr;
  T* dz = nullptr;
};

/// Direction of travel through the lens. It decides the order of surfaces and indices and the root of each
/// intersection; the sign of the ray's z component does not (a fisheye accepts rays that run towards -z).
enum class Travel : std::uint8_t { to_film, to_scene };

/// The result of tracing a ray. Every fate except `transmitted` is a loss, at the surface reported with it.
enum class RayFate : std::uint8_t {
  transmitted,        ///< passed the last surface asked for
  missed_surface,     ///< meets the surface nowhere, or on its far sheet alone; in trace() also an invalid ray
  totally_reflected,  ///< beyond the critical angle
  vignetted,          ///< outside the clear aperture (of an asphere: of its description) or in the central obscuration
  no_convergence,     ///< the iteration for an asphere did not converge
  outside_fit,        ///< outside the domain of a fitted model of the lens
  outside_film,       ///< starts or ends outside the film of a camera
  invalid,            ///< of cameras: numbers that are not finite, or no unit direction (unit_direction_tolerance)
  outside_spectrum,   ///< of cameras: a wavelength outside the compiled range (CameraOptions::clamp_wavelengths)
};

/// The fate as the programs print it: "transmitted", "missed_surface", ...
PETZVAL_API std::string_view name(RayFate fate) noexcept;

/// A traced ray.
///
/// origin is the hit on the last surface reached, direction the direction behind it (in front of it if the ray was lost
/// there). A ray lost as missed_surface or no_convergence did not reach the surface that lost it: its origin is the hit
/// on the surface before, or the origin given if there is none. Always finite. surface counts from 0: the last surface
/// passed if transmitted, else the one that lost the ray.
template <class T>
struct TracedRay {
  Ray<T> ray;
  RayFate fate = RayFate::transmitted;
  int surface = -1;

  bool transmitted() const noexcept { return fate == RayFate::transmitted; }
};

}  // namespace petzval
