// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// A scene point by its field angle, seen from the centre of the paraxial entrance pupil.
///
/// A field of +10 degrees lies towards +y; a lens with an inverted image forms its image at negative y. The entrance
/// pupil is taken at the primary wavelength in the meridian y, so that a point is the same for every wavelength. At
/// fields of 90 degrees and more, the plane of a point at a finite distance lies behind the pupil.
struct FieldPoint {
  double field_rad = 0;    ///< angle from the axis, within 180 degrees
  double z = 0;            ///< plane of the point, lens frame, mm; -inf: infinity
  double azimuth_rad = 0;  ///< from +y towards +x
};

/// The position of a scene point, or the direction towards it if it is at infinity.
///
/// @throws Error  if the field is beyond 180 degrees or not finite; if the entrance pupil is at infinity (an
///                object-space telecentric lens has no field angles); if the point is not in front of the lens: in the
///                plane of the entrance pupil, in or behind the first surface, or in a plane that the line of the field
///                misses
PETZVAL_API ScenePoint scene_point(const Lens& lens, const FieldPoint& point);

/// Result of the search for a ray, or for the film point of a chief ray.
enum class AimStatus : std::uint8_t {
  converged,     ///< the ray passes the target on the stop and the whole lens
  vignetted,     ///< the ray passes the target on the stop, but is blocked by a surface
  outside_film,  ///< cameras: the chief ray meets the film plane outside the film
  no_ray,        ///< no ray from the scene point reaches the target on the stop, or the film plane
};

/// "converged", "vignetted", "outside_film" or "no_ray".
PETZVAL_API std::string_view name(AimStatus status) noexcept;

/// A ray from a scene point to a target on the stop, traced through the lens unless the status is no_ray.
struct AimedRay {
  AimStatus status = AimStatus::no_ray;
  int surface = -1;         ///< vignetted: the surface that blocks the ray
  Ray<double> ray{};        ///< in object space; the origin is near the centre of the entrance pupil
  TracedRay<double> end{};  ///< behind the lens, traced without clear apertures
  /// Distance of the traced ray from the target on the stop, in stop semi-diameters.
  double residual = std::numeric_limits<double>::infinity();

  explicit operator bool() const noexcept { return status != AimStatus::no_ray; }
};

/// Aims a ray from a scene point at a target on the stop.
///
/// Rays are traced from the stop to the scene, as wide lenses need. The direction at the stop is bracketed in the
/// meridian of the field and refined by Newton's iteration with exact derivatives. Without a marked stop, the surface
/// that limits the axial beam is the stop (pupils().stop). A stop of radius 0 consists of its centre.
///
/// @param lens        the lens
/// @param point       the scene point
/// @param target      position on the stop in units of its semi-diameter: (0, 0) is the centre, the unit circle the rim
/// @param wavelength  a compiled wavelength
/// @throws Error  if scene_point() does, if no surface limits the beam, or if the wavelength is not compiled
///
/// Accuracy: residual <= 1e-12; at f/64, with a fisheye whose front is 300 times as large as its stop, 3e-12
/// (tests/pupil/aim_test.cpp: every lens of data/ to its declared edge, 110 degrees, near and far objects, f/22). Rays
/// that graze a surface far outside its rim: 1e-7. If the stop is smaller than a thousandth of the lens: 1e-9 of the
/// lens.
PETZVAL_API AimedRay aim(const Lens& lens, const FieldPoint& point, const Vec2<double>& target,
                         Wavelength wavelength = {});

/// The chief ray of a scene point: aims at the centre of the stop.
PETZVAL_API AimedRay chief_ray(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {});

}  // namespace petzval
