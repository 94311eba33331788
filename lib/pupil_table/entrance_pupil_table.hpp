// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/core/vec.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// A line from a scene point into the lens.
struct EntranceSample {
  Vec3<double> place{0, 0, 0};      ///< lens frame, mm: where the line passes the pupil
  Vec3<double> direction{0, 0, 1};  ///< unit, from the point to the place
  double distance = 0;              ///< between them, mm
  double pdf = 0;                   ///< of the direction at the point, 1/sr; 0: the point does not see the pupil
};

/// Lines of the film's space as rays that leave the lens towards the scene: N of each.
using TwoPlaneRaysToScene = std::function<void(std::size_t count, const TwoPlaneRays<const double>& lines,
                                               std::size_t wavelength, const RayArrays<double>& rays, RayFate* fates)>;

/// What leaves the lens, for each wavelength, of lines that are spread over a film and its pupils, edges included:
/// those to build an EntrancePupilTable from. All azimuths of the film, or +y alone where they are alike.
PETZVAL_API std::vector<std::vector<Ray<double>>> leaving_rays(const FilmPupilTable& pupils, bool azimuths_alike,
                                                               const TwoPlaneRaysToScene& to_scene);

/// What decides where a pupil ends.
enum class ClippedBy : std::uint8_t {
  apertures,  ///< what rays do: lines tell of it only from within
  samples     ///< the lines, as in models of a lens that have no rims
};

/// Which of N rays of the scene get through: passes[i] for each, at a wavelength.
using ScenePassing = std::function<void(std::size_t count, const RayArrays<const double>& rays, std::size_t wavelength,
                                        std::uint8_t* passes)>;

/// What the points of a scene see of a lens's pupil, as a table over field and reciprocal distance, one for each
/// wavelength.
///
/// A point is told by its distance from the pupil's centre and the angle (its field) between the line there and the
/// axis; the pupil it sees lies in the plane across that line, so that 90 degrees and more are like any other field.
/// Pupils are stars of 64 corners, interpolated; they contain all that passes and a little more. Points nearer to the
/// lens than the table goes, and all points of lenses without symmetry of revolution, get a cone about a ball that all
/// lines meet. Either way every ray that passes can be drawn: estimates have no bias.
///
/// Immutable, cheap to copy, free to share between threads.
class PETZVAL_API EntrancePupilTable {
 public:
  /// lines: leaving_rays(). They say how far fields reach and where to look.
  EntrancePupilTable(const Lens& lens, std::span<const std::vector<Ray<double>>> lines, const ScenePassing& passing,
                     ClippedBy ends = ClippedBy::apertures);

  /// Whether a point lies where the lens may see it, finite and not behind its first surface.
  bool in_front(const Vec3<double>& point) const noexcept;

  /// A line from a point (lens frame, mm) for u and v in [0, 1]. Nothing (pdf 0) for a point that is not in front of
  /// the lens or beyond all fields, numbers that are not finite, and wavelengths that are not in the map.
  EntranceSample sample(const Vec3<double>& point, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// The same for many of one point, sooner than one by one. u, v, samples: N each.
  void sample(const Vec3<double>& point, std::size_t count, const double* u, const double* v, Wavelength wavelength,
              EntranceSample* samples) const noexcept;

  /// The density with which `sample` gives a direction, 1/sr.
  double pdf(const Vec3<double>& point, const Vec3<double>& direction, Wavelength wavelength = {}) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// Whether exact rays get through a lens, which has to outlive this.
PETZVAL_API ScenePassing traced_passing(const Lens& lens);

/// What the scene sees of a lens by exact rays. pupils: of its film, covering.
PETZVAL_API EntrancePupilTable traced_entrances(const Lens& lens, const FilmPupilTable& pupils);

}  // namespace petzval::inline v0
