// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace petzval {

/// Result of the search for a ray.
enum class AimStatus : std::uint8_t {
  converged,  ///< the ray passes the target on the stop and the whole lens
  vignetted,  ///< the ray passes the target on the stop, but is blocked by a surface
  no_ray,     ///< no ray from the scene point reaches the target on the stop
};

/// "converged", "vignetted" or "no_ray".
PETZVAL_API std::string_view name(AimStatus status) noexcept;

/// A point of the aperture stop in units of its semi-diameter: (0, 0) is the centre, the unit circle the rim.
struct StopPoint {
  double x = 0, y = 0;
};

/// A ray from a scene point to a target on the stop, traced through the lens unless the status is no_ray.
struct AimedRay {
  AimStatus status = AimStatus::no_ray;
  int surface = -1;         ///< vignetted: the surface that blocks the ray
  Ray<double> ray{};        ///< in object space; the origin is the point nearest to the centre of the PupilPlane
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
/// @throws Error  if PupilPlane does, if no surface limits the beam, or if the wavelength is not compiled
///
/// Accuracy: residual <= 1e-12; at f/64, with a fisheye whose front is 300 times as large as its stop, 3e-12
/// (tests/pupil/aim_test.cpp: every lens of data/ to its declared edge, 110 degrees, near and far objects, f/22). Rays
/// that graze a surface far outside its rim: 1e-7. If the stop is smaller than a thousandth of the lens: 1e-9 of the
/// lens.
PETZVAL_API AimedRay aim(const Lens& lens, const FieldPoint& point, const StopPoint& target,
                         Wavelength wavelength = {});

/// The chief ray of a scene point: aims at the centre of the stop.
PETZVAL_API AimedRay chief_ray(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {});

}  // namespace petzval
