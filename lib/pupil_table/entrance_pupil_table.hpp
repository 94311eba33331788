// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval {
namespace pupil_table_detail {
struct EntranceRays;
}

/// A ray from a scene point into the lens.
struct EntranceSample {
  Vec3<double> origin{0, 0, 0};     ///< intersection of the ray with the pupil plane, lens frame, mm
  Vec3<double> direction{0, 0, 1};  ///< unit vector from the scene point to `origin`
  double distance = 0;              ///< from the scene point to `origin`, mm
  double pdf = 0;                   ///< density of the direction, 1/sr; 0 if the point does not see the pupil
};

/// Maps N image-space rays to rays that leave the lens towards the scene. Called from several threads.
using TwoPlaneRaysToScene = std::function<void(std::size_t count, const TwoPlaneRays<const double>& lines,
                                               std::size_t wavelength, const RayArrays<double>& rays, RayFate* fates)>;

/// Rays that leave the lens towards the scene, for each wavelength: samples of the pupils of a film, including points
/// on their boundaries. An EntrancePupilTable is made from these rays.
///
/// @param equal_azimuths  true if film points on +y are representative of all azimuths
PETZVAL_API std::vector<std::vector<Ray<double>>> leaving_rays(const FilmPupilTable& pupils, bool equal_azimuths,
                                                               const TwoPlaneRaysToScene& to_scene, int threads = 1);

/// Tests N rays from the scene at a wavelength; passes[i] is 1 if ray i passes the lens. Called from several threads.
using ScenePassing = std::function<void(std::size_t count, const RayArrays<const double>& rays, std::size_t wavelength,
                                        std::uint8_t* passes)>;

/// An EntrancePupilTable as plain numbers, for programs that do not link petzval. lib/docs/camera_table.md describes
/// the lists.
struct EntrancePupilArrays {
  int dimensions = 2;  ///< 2: reciprocal distance and field; 3: with two angles
  float centre_z = 0, steepest = 0, front_half = 0;
  std::vector<float> balls, widest, nodes;  ///< by wavelength
  std::size_t node_size = 0;
};

/// Entrance pupils of all scene points: a table over field and reciprocal distance for each wavelength.
///
/// A point has a distance from the pupil centre and a field: the angle between the axis and the line to the centre. Its
/// pupil lies in the plane perpendicular to this line, so that fields of 90 degrees and more need no special case.
/// Pupils are interpolated polygons of 64 corners that contain every ray that passes and few others. All sectors get
/// the same number of samples, uniform within a sector. For points that are too near to the lens for the table, samples
/// fill a cone around a ball that all rays meet. Every ray that passes can be sampled: estimates are unbiased.
///
/// Immutable, cheap to copy, thread-safe.
class PETZVAL_API EntrancePupilTable {
 public:
  /// @param rays leaving_rays(); they determine the largest fields and the positions of pupils
  EntrancePupilTable(const Lens& lens, std::span<const std::vector<Ray<double>>> rays, const ScenePassing& passing,
                     int threads = 1);

  /// True if a point is finite and not behind the first surface of the lens.
  bool in_front(const Vec3<double>& point) const noexcept;

  /// A ray from a point (lens frame, mm) for u and v in [0, 1]. pdf = 0 if the point is not in front of the lens or
  /// outside all fields, if a number is not finite, or if the wavelength is not in the table.
  EntranceSample sample(const Vec3<double>& point, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// Samples N points; equal to single samples.
  void sample(std::size_t count, const Vec3<double>* points, const double* u, const double* v,
              const RayWavelengths& wavelengths, const pupil_table_detail::EntranceRays& rays) const noexcept;
  /// Samples N rays of one point, uniform over its pupil in the plane that faces the point; pdf is the density of
  /// spread(), not of sample().
  /// @param u, v, samples arrays of length N
  void spread(const Vec3<double>& point, std::size_t count, const double* u, const double* v, Wavelength wavelength,
              EntranceSample* samples) const noexcept;

  /// Density of sample() for the direction of a ray at a point, 1/sr. The origin of the ray is any position on its
  /// line. The line must pass through the point, unless the point is so far away that its rays are parallel.
  double pdf(const Vec3<double>& point, const Ray<double>& ray, Wavelength wavelength = {}) const noexcept;

  EntrancePupilArrays arrays() const;

 private:
  struct Data;

  std::shared_ptr<const Data> data_;
};

/// Tests by tracing if rays pass a lens. The lens must outlive the result.
PETZVAL_API ScenePassing traced_passing(const Lens& lens);

/// Makes the table of a lens from traced rays.
/// @param pupils FilmPupilTable::enclosing() of the film
PETZVAL_API EntrancePupilTable traced_entrances(const Lens& lens, const FilmPupilTable& pupils, int threads = 1);

}  // namespace petzval
