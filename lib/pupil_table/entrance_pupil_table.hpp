// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace pupil_table_detail {
struct EntranceRays;
}

/// A ray from a scene point into the lens.
struct EntranceSample {
  Vec3<double> place{0, 0, 0};      ///< lens frame, mm: where the ray crosses the plane of the pupil
  Vec3<double> direction{0, 0, 1};  ///< unit, from the point to the place
  double distance = 0;              ///< between them, mm
  double pdf = 0;                   ///< of the direction at the point, 1/sr; 0: the point does not see the pupil
};

/// Image-space rays as rays that leave the lens towards the scene: N of each. Called from several threads.
using TwoPlaneRaysToScene = std::function<void(std::size_t count, const TwoPlaneRays<const double>& lines,
                                               std::size_t wavelength, const RayArrays<double>& rays, RayFate* fates)>;

/// Rays that leave the lens, for each wavelength: those of samples of the pupils of a film, boundaries included, to
/// build an EntrancePupilTable from. azimuths_alike: film points on +y stand for all.
PETZVAL_API std::vector<std::vector<Ray<double>>> leaving_rays(const FilmPupilTable& pupils, bool azimuths_alike,
                                                               const TwoPlaneRaysToScene& to_scene, int threads = 1);

/// What clips a pupil.
enum class ClippedBy : std::uint8_t {
  apertures,  ///< Apertures clip the pupil; sampled rays only bound it from inside.
  samples     ///< The sampled rays do, as in models of a lens that have no rims.
};

/// Which of N rays from the scene pass the lens, at a wavelength: passes[i]. Called from several threads.
using ScenePassing = std::function<void(std::size_t count, const RayArrays<const double>& rays, std::size_t wavelength,
                                        std::uint8_t* passes)>;

/// The pupils of all scene points, as a table over field and reciprocal distance, one for each wavelength.
///
/// A point is identified by its distance from the pupil's centre and by its field, the angle between the axis and the
/// line to that centre. Its pupil lies in the plane perpendicular to that line, so that fields of 90 degrees and more
/// are like any other. Pupils are interpolated polygons of 64 corners that contain every ray that passes and few
/// others; all sectors get the same number of samples, uniform within each. Points nearer to the lens than the table
/// reaches get a cone about a ball that all rays meet. Every ray that passes can be sampled: estimates have no bias.
///
/// Immutable, cheap to copy, free to share between threads.
class PETZVAL_API EntrancePupilTable {
 public:
  /// rays: leaving_rays(). They show how far fields reach and where pupils are.
  EntrancePupilTable(const Lens& lens, std::span<const std::vector<Ray<double>>> rays, const ScenePassing& passing,
                     ClippedBy clipped_by = ClippedBy::apertures, int threads = 1);

  /// Whether a point lies where the lens may see it, finite and not behind its first surface.
  bool in_front(const Vec3<double>& point) const noexcept;

  /// A ray from a point (lens frame, mm) for u and v in [0, 1]. pdf 0 for a point that is not in front of the lens or
  /// beyond all fields, numbers that are not finite, and wavelengths that are not in the table.
  EntranceSample sample(const Vec3<double>& point, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// The same for N points; `rays` hold what single samples give.
  void sample(std::size_t count, const Vec3<double>* points, const double* u, const double* v,
              const RayWavelengths& wavelengths, const pupil_table_detail::EntranceRays& rays) const noexcept;
  /// Many rays of one point, uniform over its pupil in the plane that faces the point; their pdf is that of this.
  /// u, v, samples: N each.
  void spread(const Vec3<double>& point, std::size_t count, const double* u, const double* v, Wavelength wavelength,
              EntranceSample* samples) const noexcept;

  /// The density with which `sample` gives the direction of a ray at a point, 1/sr. The ray is given anywhere on its
  /// line, which passes the point, or one that is so far away that all its rays are parallel.
  double pdf(const Vec3<double>& point, const Ray<double>& ray, Wavelength wavelength = {}) const noexcept;

 private:
  struct Data;

  std::shared_ptr<const Data> data_;
};

/// Whether exact rays pass a lens, which has to outlive the result.
PETZVAL_API ScenePassing traced_passing(const Lens& lens);

/// The table of a lens by exact rays. pupils: FilmPupilTable::enclosing() of its film.
PETZVAL_API EntrancePupilTable traced_entrances(const Lens& lens, const FilmPupilTable& pupils, int threads = 1);

}  // namespace petzval
