// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval {

/// The blur of a bundle on a film; nullopt if the bundle is empty.
///
/// Also nullopt if the rays do not all cross the film from the same side.
///
/// @throws Error if film.z_mm is not set, or if the bundle has no slopes
PETZVAL_API std::optional<ExactBlur> blur_on(const RayBundle& bundle, const Film& film);

/// Ray bundles from scene points through a lens, at the primary wavelength. Immutable, thread-safe, cheap to copy.
///
/// Setup for a lens and a film takes milliseconds, a bundle some microseconds. Rays are distributed uniformly over the
/// pupil as seen from the scene point.
class PETZVAL_API ImageRays {
 public:
  /// Copies. A move also copies, so that no ImageRays is ever empty.
  ImageRays(const ImageRays&) = default;
  ImageRays& operator=(const ImageRays&) = default;

  /// Prepares the pupils of a lens.
  ///
  /// @param lens         the lens
  /// @param film_radius  radius of the film about the axis (mm); scene points imaged farther out have empty bundles
  /// @param rays         number of rays to send from each scene point, at least 16. At least half of them pass, unless
  ///                     a lens without symmetry of revolution passes less than a 16th of the rays.
  /// @throws Error       if `rays` is below 16, or if thick_lens() or FilmPupilTable::enclosing() throws
  ImageRays(const Lens& lens, double film_radius, std::size_t rays = 256);

  const Lens& lens() const noexcept;
  /// The cardinal points and pupils at the same wavelength.
  const IdealLens& ideal() const noexcept;
  /// The bundle of a scene point behind the lens; empty if the lens does not see the point.
  RayBundle bundle(const ScenePoint& scene_point) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// The rays for points on a film and around it: at most `rays` from each point, fewer (at least 64) if all points have
/// more than 2^22.
///
/// @throws Error  if the constructor of ImageRays does
PETZVAL_API ImageRays image_rays(const Lens& lens, const Film& film, std::span<const ScenePoint> points,
                                 std::size_t rays);
PETZVAL_API ImageRays image_rays(const Lens& lens, const Film& film, std::span<const FocusTarget> targets,
                                 std::size_t rays);

/// autofocus() with rays that are set up already.
PETZVAL_API Autofocus autofocus(const ImageRays& lens, std::span<const FocusTarget> targets, const Film& film = {},
                                FocusCriterion criterion = FocusCriterion::min_rms);

}  // namespace petzval
