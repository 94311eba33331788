// SPDX-License-Identifier: Apache-2.0
// Rays of one scene point with their optical paths.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/aim.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval::analysis_detail {

/// A ray behind the lens and its optical path to an image point: up to the plane through the image point that is
/// perpendicular to the ray.
struct PathRay {
  Vec2<double> stop{0, 0};          ///< intersection with the stop, in semi-diameters of the stop
  Vec3<double> direction{0, 0, 1};  ///< unit vector behind the lens
  /// Optical path from the wavefront through the centre of the pupil plane to the plane at the image point, mm.
  double path = 0;
  double miss_squared = 0;  ///< squared distance of the ray from the image point, mm^2
  /// Intersection with the plane of the image point perpendicular to the axis, relative to the image point, mm. The
  /// derivatives of `path` by direction.x and direction.y are -n times this vector.
  Vec2<double> film{0, 0};
};

/// Computes optical paths of the rays of one point at one wavelength. Clear apertures do not matter.
///
/// The path ends at the plane wavefront of the ray through the image point. Its length does not depend on a distant
/// reference sphere, so that it keeps its digits for telecentric lenses.
class PETZVAL_API OpticalPaths {
 public:
  /// @param image  image point, lens frame, mm
  /// @throws Error under the conditions of pupils()
  OpticalPaths(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, const Vec3<double>& image);

  /// nullopt if the ray does not pass the lens, or leaves the lens away from the film.
  std::optional<PathRay> operator()(const Ray<double>& ray) const noexcept;
  std::optional<PathRay> operator()(const Vec2<double>& pupil) const noexcept {
    return (*this)(plane_.ray(pupil.x, pupil.y));
  }

  /// Refractive index behind the lens.
  double film_index() const noexcept { return indices_.back(); }

 private:
  double to_pupil(const Vec3<double>& position) const noexcept;

  Lens lens_;
  PupilPlane plane_;
  std::size_t wavelength_, stop_;
  Vec3<double> image_;
  double stop_unit_ = 1;         // mm
  std::vector<double> indices_;  // by space
};

/// Wavefront errors of the rays of one point and wavelength, relative to the sphere of wavefront().
class PETZVAL_API SphereErrors {
 public:
  /// nullopt if the chief ray does not reach the film. @throws Error under the conditions of aim()
  static std::optional<SphereErrors> of(const Lens& lens, const FieldPoint& point, std::size_t wavelength);

  const OpticalPaths& paths() const noexcept { return paths_; }
  const Vec2<double>& image() const noexcept { return image_; }
  double radius() const noexcept { return radius_; }
  /// Error in waves, positive if the wavefront is ahead of the sphere.
  double operator()(const PathRay& ray) const noexcept { return (reference_ - to_sphere(ray)) / wave_mm_; }

 private:
  SphereErrors(const OpticalPaths& paths, const Vec2<double>& image, double wave_mm)
      : paths_(paths), image_(image), wave_mm_(wave_mm) {}
  double to_sphere(const PathRay& ray) const noexcept;

  OpticalPaths paths_;
  Vec2<double> image_;
  double wave_mm_, radius_ = 0, reference_ = 0;
};

}  // namespace petzval::analysis_detail
