// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// What "in focus" means.
enum class FocusCriterion {
  thin,      ///< thin lens of the same focal length: both principal planes where the rear one is
  paraxial,  ///< thick lens: the cardinal points
  min_rms,   ///< exact: least RMS radius of the blur of the axial bundle through the whole aperture
};

/// From where a subject distance is measured, towards the scene (positive, may be infinite).
enum class DistanceOrigin { front_vertex, film };

PETZVAL_API std::string_view name(FocusCriterion criterion) noexcept;

/// Result of a focus solver.
struct FocusSolution {
  enum class Status {
    solved,
    unreachable,  ///< no real image behind the lens: the subject at or inside the front focus, or too near the film
    no_rays,      ///< exact criterion: nothing gets through
    afocal,       ///< the lens has no focal length
  };
  Status status = Status::solved;
  double film_z = 0;     ///< lens frame, mm; when unreachable, for `nearest_distance` (infinite at the front focus)
  double subject_z = 0;  ///< lens frame, mm; -inf at infinity; when unreachable, for `nearest_distance`
  double nearest_distance = 0;  ///< when unreachable: the nearest distance that can be focused, or the limit of
                                ///< those; same origin; infinite where the lens forms no real image of anything
  explicit operator bool() const noexcept { return status == Status::solved; }
};

/// Film position that brings an axial subject into focus (the lens stays, the film moves).
///
/// distance_mm: > 0 or +inf, from `origin`. Where two film positions serve one distance from the film, the one nearer
/// to the rear focus is given. A lens with cylinders is focused in its main meridian, by min_rms over all azimuths.
/// min_rms takes the position of least RMS radius in closed form from one bundle through whatever passes every rim,
/// equally by area of the entrance pupil; it must lie behind the last vertex. Throws Error for NaN or a distance that
/// is not positive, and for min_rms of a lens with nothing to limit the beam. Accuracy: paraxial and thin within
/// rounding; the nearest distance of min_rms within 1e-8.
PETZVAL_API FocusSolution solve_focus(const Lens& lens, double distance_mm,
                                      FocusCriterion criterion = FocusCriterion::paraxial,
                                      DistanceOrigin origin = DistanceOrigin::front_vertex, std::size_t wavelength = 0);

/// The lens with its film where solve_focus puts it. Throws Error, naming the nearest distance, where there is no
/// focus.
PETZVAL_API Lens with_focus(const Lens& lens, double distance_mm, FocusCriterion criterion = FocusCriterion::paraxial,
                            DistanceOrigin origin = DistanceOrigin::front_vertex, std::size_t wavelength = 0);

/// Blur diameter c = D f |U - Uf| / (U (Uf - f)) of a thin lens of focal length f and diameter D focused at Uf for a
/// subject at U, distances from the lens, either may be infinite. Safe at infinity, next to f, and for U next to Uf:
/// within 4 eps. Throws Error unless U > 0 and Uf > f > 0 and D >= 0. Source: Wu et al. 2010, equation 1.
PETZVAL_API double thin_lens_blur_diameter(double focal_length, double diameter, double subject, double focused);

/// How far behind the focal point a thin lens images a subject at U: V - f = f (f / (U - f)), 0 at infinity, within 4
/// eps. Throws Error unless U > f > 0.
PETZVAL_API double thin_lens_extension(double focal_length, double subject);

}  // namespace petzval
