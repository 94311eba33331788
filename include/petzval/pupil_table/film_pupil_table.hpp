// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/field_point.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::inline v0 {

/// A disc in the plane of the pupil whose centre moves with the film point: it lies at shift times that point.
struct PupilDisc {
  double shift = 0;
  double radius = 0;  ///< mm
};

/// A film that leans, as pupils see it. A point of it is told by its key: where the line from the point to the middle
/// of the pupil's plane meets the plane of the upright film. The point's line through q in the plane of the pupil meets
/// that of the upright film in key - (slope . key) q, whatever the film's place along the key's line: 1 + slope . key
/// is by how much nearer to the pupil's plane it stands than the upright film.
struct FilmTilt {
  double slope_x = 0, slope_y = 0;  ///< 1/mm
  double low = 0, high = 0;         ///< of slope . key on the film
  double radius = 0;                ///< of the farthest key, mm
};

/// A sample of a pupil: its place in the plane of the pupil and the pupil's whole area, mm and mm^2. Samples are spread
/// evenly, so that their density is 1 / area. Area 0: nothing to sample, the place is (0, 0).
struct PupilSample {
  double x = 0, y = 0, area = 0;
};

/// The pupils of every point of a film: the parts of the plane behind the lens through which the points see the scene,
/// as a table over the distance from the axis, one for each compiled wavelength.
///
/// A pupil is a star of 64 corners about a middle (or a ring of such stars, where the lens has a hole). Corners and
/// middles are interpolated between 65 distances, so that the pupil, and with it the sample for a given u and v, moves
/// continuously with the film point: a picture has no rings. Areas are exact for the interpolated star.
/// Lenses without symmetry of revolution have one pupil for all points, which contains all of theirs.
///
/// Immutable, cheap to copy, free to share between threads.
class PETZVAL_API FilmPupilTable {
 public:
  /// Contains every ray that the lens passes and little else; rays still have to be traced. Of the pupils' area at most
  /// 1e-5 is missed (tests/pupil/film_pupil_table_test.cpp: every lens of data/ wide open over its declared field, some
  /// of them stopped down), but where a pupil falls apart into more than two pieces along a line: a ball lens stopped
  /// down or far off the axis, catadioptrics beyond their field. film_radius: of the farthest film point, mm, >= 0. The
  /// film is the lens's. Throws Error for a film in the plane of the last vertex and for a film_radius that is negative
  /// or not finite.
  static FilmPupilTable enclosing(const Lens& lens, double film_radius);

  /// The pupils themselves, as well as stars of the same area can have their shape, for models without rims.
  static FilmPupilTable equal_area(const Lens& lens, double film_radius);

  /// What lies within all of some discs (one list for each wavelength), as well as stars of the same area can have it.
  static FilmPupilTable of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                 double film_radius, std::size_t primary_wavelength = 0);

  /// The pupils of a film that leans, by keys in place of film points: they contain every line that meets the film and
  /// is one of this map's (whose film_radius they must not exceed), and as few more as one pupil for each distance of
  /// the key from the axis can: of several points at that distance, along one line, it holds the pupils of all. Of
  /// their area at most 1e-5 is missed (tests/camera/tilted_exposure_test.cpp), but where `covering` misses more: of a
  /// ball lens 10 mm across, tilted by 8 degrees, 2e-3 on a film of 3 x 2 mm, 2e-4 on one of 0.6 x 0.45 mm at f/8.
  /// Throws Error for a radius that is negative or not finite.
  FilmPupilTable for_tilted_film(const FilmTilt& tilt) const;

  /// The planes that film points and samples lie in.
  const TwoPlanes& space() const noexcept;
  double film_radius() const noexcept;
  std::size_t wavelengths() const noexcept;
  /// Position of the lens's primary wavelength, the default of all calls.
  std::size_t primary_wavelength() const noexcept;

  /// The pupil of a film point, evenly, for u and v in [0, 1] (clamped); u runs around the middle
  /// (from the lens's +y, so that samples of neighbouring points are neighbours), v outwards. Nothing
  /// for points outside the film's radius, numbers that are not finite and wavelengths that are not in the map.
  PupilSample sample(const FilmPoint& film, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// The same for many: film_x, film_y, u, v, x, y and areas: N each; x and y may be u and v. Float or double.
  template <class T>
  void sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
              const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept;

  /// Area of the pupil of a film point, mm^2; 0 as in `sample`.
  double area(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Its middle: where the star's rays begin; the centre of the hole where there is one.
  std::array<double, 2> middle(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Whether a place in the plane of the pupil belongs to the pupil of a film point.
  bool contains(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;

  /// The same for many lines: within: N, 0 or 1. Float or double.
  template <class T>
  void contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                std::uint8_t* within) const noexcept;

  /// How the sample moves with the film point, u and v held: derivatives of (x, y) by film x and by film y.
  struct Derivatives {
    std::array<double, 2> by_film_x{0, 0}, by_film_y{0, 0};
  };
  Derivatives derivatives(const FilmPoint& film, double u, double v, Wavelength wavelength = {}) const noexcept;

 private:
  struct Data;
  static FilmPupilTable traced(const Lens& lens, double film_radius, bool covering);
  explicit FilmPupilTable(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::inline v0
