// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/ray_bundle.hpp"

namespace petzval {

/// A blur of exact rays on a film.
struct BundleBlur {
  FilmPoint centroid;
  double rms_radius = 0;      ///< mm, on the film about the centroid
  double largest_radius = 0;  ///< mm, on the film about the centroid
  /// The diameter of the uniform disc of the same RMS radius, 2 sqrt(2) rms_radius; negative where the rays meet behind
  /// the film, as signed_blur(), unless defocus makes less than a tenth of it.
  double signed_diameter = 0;
};
/// Nothing for an empty bundle, and where a ray runs along the film. Throws Error for a film without a place, and for a
/// bundle without slopes.
PETZVAL_API std::optional<BundleBlur> blur_on(const RayBundle& bundle, const Film& film);

/// Sends bundles from scene points through a lens: set up once for a lens and a film (milliseconds), then some
/// microseconds a point. Immutable, cheap to copy, free to share between threads.
///
/// One wavelength: the central one. Rays are spread evenly over the pupil as the point sees it. RMS radii are those of
/// endlessly many within 1.5 % for 256 rays and 1 % for 1024 out of focus; on the sharpest film, for nine of ten points
/// of the lenses of data/lenses, within 2 % for 256, 1.5 % for 1024 and 0.4 % for 4096, and within 7, 5 and 2 % for all
/// (tests/focus/image_rays_test.cpp; lenses of revolution, with cylinders it may be a fifth). The largest radius is
/// that of the rays there are, up to 40 % less than that of the pupil's edge.
class PETZVAL_API ImageRays {
 public:
  /// Copies. Moves copy too, so that no ImageRays is ever empty.
  ImageRays(const ImageRays&) = default;
  ImageRays& operator=(const ImageRays&) = default;

  /// film_radius: mm, of the farthest film point that matters: what lies beyond that has no bundles. rays: to send of
  /// each point, at least 16; half of them or more get through (but where it is less than a 16th of what a lens
  /// without symmetry of revolution may see). Throws Error where thick_lens and FilmPupilTable::enclosing do.
  ImageRays(const Lens& lens, double film_radius, std::size_t rays = 256);

  const Lens& lens() const noexcept;
  /// Cardinal points and pupils, of the same wavelength.
  const IdealLens& ideal() const noexcept;
  /// Empty for a place that the lens does not see.
  RayBundle bundle(const ScenePoint& place) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval
