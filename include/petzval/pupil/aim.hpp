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

/// How the search for a ray ended.
enum class AimStatus : std::uint8_t {
  converged,  ///< the ray goes through the point of the stop aimed at, and through the whole lens
  vignetted,  ///< the ray goes through that point of the stop, but ends at a surface of the lens
  no_ray,     ///< no ray from the scene point reaches that point of the stop
};

/// "converged", "vignetted" or "no_ray".
PETZVAL_API std::string_view name(AimStatus status) noexcept;

/// A place on the aperture stop in units of its semi-diameter: (0, 0) the centre, the unit circle its rim.
struct StopPoint {
  double x = 0, y = 0;
};

/// A ray from a scene point through a given place on the stop. Every ray except no_ray was traced through the lens.
struct AimedRay {
  AimStatus status = AimStatus::no_ray;
  int surface = -1;         ///< vignetted: the surface that ends the ray
  Ray<double> ray{};        ///< in object space, from its point nearest to the centre of the PupilPlane
  TracedRay<double> end{};  ///< behind the lens, clear apertures ignored; its fate where it is lost all the same
  /// Distance of the traced ray from the place aimed at on the stop, in stop semi-diameters.
  double residual = std::numeric_limits<double>::infinity();

  explicit operator bool() const noexcept { return status != AimStatus::no_ray; }
};

/// Aims a ray of a scene point at a place on the stop.
///
/// The search runs backwards, from the stop to the scene, which wide lenses need: the direction at the stop is
/// bracketed in the meridian of the field (a ray that misses a surface on its way counts as too steep) and refined by
/// Newton's iteration on exact derivatives; rays away from the centre start from the direction of the chief ray. Clear
/// apertures are tested last. Without a marked stop the surface that limits the axial beam takes its place
/// (pupils().stop). A stop of radius 0 has only its centre.
///
/// Accuracy: residual <= 1e-12 (tests/pupil/aim_test.cpp: every lens of data/ to its declared edge, 110 degrees, near
/// and far objects, f/22; at f/64, where the front of a fisheye is 300 times as large as its stop, 3e-12); 1e-7 of rays
/// that graze a surface far outside its rim, and of a billionth of the lens where the stop is smaller than a thousandth
/// of it. Throws Error where PupilPlane does, where nothing limits the beam, and for a wavelength that was not
/// compiled.
PETZVAL_API AimedRay aim(const Lens& lens, const FieldPoint& point, const StopPoint& target,
                         Wavelength wavelength = {});

/// The chief ray: aimed at the centre of the stop.
PETZVAL_API AimedRay chief_ray(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {});

}  // namespace petzval
