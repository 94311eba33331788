// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil/pupil_plane.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval {

/// A disc in the pupil plane with its centre at shift * film point.
struct PupilDisc {
  double shift = 0;
  double radius = 0;  ///< mm
};

/// A round rim that clips pupils and moves opposite to the film point, in units of the pupil radius on the axis.
struct PupilRim {
  double ratio = 1;         ///< radius of the rim
  double shift_per_mm = 0;  ///< displacement per mm on the film
};

/// The image of an iris in the pupil plane, in the sections along x and y; equal sections for a lens of revolution.
struct PupilImage {
  Vec2<double> shift{0, 0};   ///< the centre lies at shift * film point
  Vec2<double> radius{0, 0};  ///< semi-axes of the image of the stop's rim, mm
};

/// A tilted film in pupil coordinates.
///
/// A film point is identified by its virtual film point v: its projection onto the upright film, through the centre of
/// the pupil plane. The number 1 + excess is the distance of the upright film from the pupil plane divided by the
/// distance of the film point. The ray from the film point through q in the pupil plane meets the upright film at v -
/// excess q. excess is slope . v without travel, and (slope . v - t) / (1 + t) after travel by the fraction t of the
/// upright film's distance.
struct FilmTilt {
  double slope_x = 0, slope_y = 0;        ///< 1/mm
  double min_excess = 0, max_excess = 0;  ///< range of excess on the film, at all times
  double radius = 0;                      ///< distance of the farthest virtual film point from the axis, mm
  double travel = 0;                      ///< t at the end of the travel, which covers all values from 0
};

/// A sample of a pupil: position in the pupil plane (mm) and area (mm^2), the inverse of the density. The mean of the
/// areas is the area of the pupil. Area 0: there is no sample.
struct PupilSample {
  double x = 0, y = 0, area = 0;
};

/// The polygons of a FilmPupilTable as plain numbers, for programs that do not link petzval. lib/docs/camera_table.md
/// describes the lists.
struct FilmPupilArrays {
  int dimensions = 1;  ///< 1: rows over the distance from the axis; 2: cells of the quadrant x, y >= 0
  float reach = 0;     ///< mm; film points farther from the axis have no pupil
  float rows_per_mm = 0;
  std::size_t rows = 0, columns = 1;
  std::vector<float> half_widths;  ///< [row] mm; the last entry is the end of the last row
  std::vector<float> nodes;        ///< [wavelength][node] node_size numbers
  std::size_t node_size = 0;
  std::vector<float> stops;  ///< [wavelength][node] stop_size numbers; empty if the iris clips no polygon
  std::size_t stop_size = 0;
  float iris_area = 0;      ///< in squares of the semi-diameter
  std::vector<float> iris;  ///< empty: a disc
};

/// The pupils of all points of a film, for sampling: a table per compiled wavelength, or a closed form.
///
/// A pupil is the region of the pupil plane through which a film point sees the scene. In a table it is a polygon of 64
/// corners, less a central obscuration, and moves continuously with the film point. Its 64 sectors get equal numbers of
/// samples, uniform in each sector; their areas differ by less than 1 % for most lenses. If a film point sees the
/// complete iris with blades, samples are uniform on the iris. Immutable, cheap to copy, thread-safe.
///
/// Accuracy: a wavelength in nm has the pupils of the nearest compiled wavelength. Pupils of enclosing() contain the
/// rays up to midway between compiled wavelengths; at a spacing of 150 nm, 0.1 to 1.5 % more samples are lost
/// (tests/pupil_table/any_wavelength_test.cpp). Pupils of equal_area() are off by up to 0.5 % in irradiance (fisheye:
/// 0.6 %) with eight wavelengths over 400 to 700 nm. Closed forms are interpolated within 1e-4.
///
/// Limitations: the tables of lenses with cylinders leave out no obscuration.
class PETZVAL_API FilmPupilTable {
 public:
  /// Copies. Moves also copy, so that a FilmPupilTable is never empty.
  FilmPupilTable(const FilmPupilTable&) = default;
  FilmPupilTable& operator=(const FilmPupilTable&) = default;

  /// Polygons that contain the pupils (exit_pupil_boundary()) and little else; their rays still have to be traced.
  ///
  /// @param lens         the lens with its film
  /// @param film_radius  distance of the farthest film point from the axis (mm); at least 0
  /// @param threads      at least 1; they share the wavelengths, and the table is the same for every number
  /// @throws Error       if the film lies in the plane of the last vertex, film_radius is negative or not finite, or
  ///                     threads is less than 1
  ///
  /// Accuracy: at most 1e-5 of the pupils' area is missed (tests/pupil_table/film_pupil_table_test.cpp: every lens of
  /// data/ wide open over its declared field, some stopped down; film_cells_test.cpp: a lens with cylinders from wide
  /// open to f/64). With a bladed iris, at least 97.5 % of the samples pass (bladed_pupils_test.cpp: double Gauss,
  /// Tessar and fisheye of data/, 5 to 9 blades, f/2.87 to f/16). More samples are lost with very small stops: half at
  /// f/1e5, most at f/1e6.
  static FilmPupilTable enclosing(const Lens& lens, double film_radius, int threads = 1);

  /// Polygons with the area of the pupils and nearly their shape, for models without rims (polynomials, two discs).
  ///
  /// @throws Error if enclosing() does
  ///
  /// Limitations: a pupil divided by an obscuration (catadioptrics beyond their field) becomes a connected region of
  /// about the same area.
  static FilmPupilTable equal_area(const Lens& lens, double film_radius, int threads = 1);

  /// Equal-area polygons for the overlap of discs. (A single disc has a closed form: of_iris().)
  ///
  /// @param space               film and pupil plane
  /// @param discs               one list of discs per wavelength, 1 to 65535 lists
  /// @param film_radius         distance of the farthest film point from the axis (mm); at least 0
  /// @param primary_wavelength  position of the default wavelength
  /// @param wavelengths_nm      the wavelengths (nm), for samples by nm; or empty
  /// @throws Error              if the planes coincide; if a radius is negative; if a list is empty; if a number is
  ///                            infinite, NaN or beyond 1e15; if the primary wavelength has no list; if wavelengths_nm
  ///                            are not positive, repeat (within 1e-6 nm) or differ in number from the lists
  static FilmPupilTable of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                 double film_radius, std::size_t primary_wavelength = 0,
                                 std::span<const double> wavelengths_nm = {});

  /// Pupils in the shape of an overlap of discs, scaled about their middles to the projected_solid_angle() of this
  /// table. The result has no stop (with_stop()).
  ///
  /// @throws Error if of_discs() rejects the discs, or the number of lists differs from the number of wavelengths
  FilmPupilTable with_discs(std::span<const std::vector<PupilDisc>> discs) const;

  /// The pupils clipped by a rim (cat's eyes); the irradiance falls with the area.
  ///
  /// @throws Error if the ratio is not positive, a number is not finite, the rim moves by more than 1e6 radii over the
  ///               film, or the lens has cylinders or a central obscuration
  ///
  /// Accuracy: if the rim moves by at most 5 radii over the film, areas are within 2 % of the unclipped pupil's area
  /// (tests/pupil_table/rim_test.cpp); nearly closed pupils may have area 0.
  FilmPupilTable clipped_by_rim(const PupilRim& rim) const;
  /// True if a rim has clipped the pupils.
  bool is_clipped() const noexcept;
  /// The unclipped pupils.
  FilmPupilTable unclipped() const;

  /// The pupils with the stop of the lens: the iris clips them, and stop_points() is available. Pupils in closed form
  /// stay unchanged. enclosing() and equal_area() call with_stop() for an iris with blades.
  ///
  /// @throws Error if the lens has no stop with a semi_diameter
  FilmPupilTable with_stop(const Lens& lens, int threads = 1) const;
  bool knows_stop() const noexcept;
  /// The pupils of the round stop, clipped by neither rim nor blades; the result does not know the stop.
  FilmPupilTable with_round_stop() const;

  /// Pupils in closed form: images of an iris, one per wavelength. iris: as it appears in the pupil plane.
  ///
  /// @throws Error if of_discs() does for these parameters, or blades, roundness or rotation are out of range
  static FilmPupilTable of_iris(const TwoPlanes& space, const Iris& iris, std::span<const PupilImage> images,
                                double film_radius, std::size_t primary_wavelength = 0,
                                std::span<const double> wavelengths_nm = {});

  /// The pupils of a tilted film, by virtual film points.
  ///
  /// They contain all rays of this table that meet the tilted film, and few others; for an iris with blades, the rays
  /// of the round stop. Pupils of of_iris() stay in closed form if the film does not travel. The film_radius of this
  /// table must include all points at which the rays meet the upright film.
  ///
  /// @param tilt     the tilted film
  /// @param threads  at least 1; they share the wavelengths, and the table is the same for every number
  /// @throws Error   if tilt.radius is negative or not finite, or threads is less than 1
  ///
  /// Accuracy: at most 1e-5 of the area is missed (tests/camera/tilted_exposure_test.cpp), unless enclosing() misses
  /// more. With a ball lens 10 mm in diameter and a tilt of 8 degrees, 2e-3 is missed on a film of 3 x 2 mm, and 2e-4
  /// on 0.6 x 0.45 mm at f/8.
  FilmPupilTable for_tilted_film(const FilmTilt& tilt, int threads = 1) const;

  /// The planes of the film points and the samples.
  const TwoPlanes& space() const noexcept;
  double film_radius() const noexcept;
  /// Distance from the axis beyond which film points have no pupil; at most film_radius() (mm).
  double lit_radius() const noexcept;
  std::size_t wavelengths() const noexcept;
  /// True if there are samples at a wavelength: a position of the table, or nm within the range of its wavelengths.
  bool covers(Wavelength wavelength) const noexcept;
  /// Position of the lens's primary wavelength, the default of all calls.
  std::size_t primary_wavelength() const noexcept;

  /// Samples the pupil of a film point, for u and v in [0, 1] (clamped).
  ///
  /// u runs around the middle, from the lens's +y (for points of an iris with blades: from its first corner), so that
  /// samples of neighbouring film points are neighbours; v runs outwards. The area is 0 if the film point is outside
  /// lit_radius(), a number is not finite, or the wavelength is not covered.
  PupilSample sample(const FilmPoint& film, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// Samples N pupils, float or double. x and y may be u and v.
  template <class T>
  void sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
              const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept;

  /// Area of the pupil of a film point (mm^2); 0 as in `sample`. For an iris with blades, a mean over samples.
  double area(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Projected solid angle of the pupil, seen from the film point (sr), within 1e-4; 0 as in `sample`. Multiplied by
  /// the squared index behind the lens, it is the irradiance of the film for a scene of radiance 1.
  double projected_solid_angle(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Middle of the pupil's polygon, or centre of the central obscuration; (0, 0) without a pupil.
  Vec2<double> middle(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Area of the pupil for the round stop, without blades (mm^2).
  double polygon_area(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Area of a sample at a point of the pupil plane (mm^2); 0 outside the pupil.
  double sample_area(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;
  template <class T>
  void sample_areas(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                    T* areas) const noexcept;
  /// Scale of the iris (1 or slightly more) if the samples of a film point are uniform on the iris; otherwise 0. Then u
  /// and v determine the stop point.
  double sampled_iris_scale(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Intersections of N rays with the stop, in semi-diameters, float or double; for pupils made by with_stop().
  ///
  /// Accuracy: 0.1 to 2 %.
  template <class T>
  void stop_points(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths, T* x,
                   T* y) const noexcept;
  /// True if a point of the pupil plane belongs to the pupil of a film point.
  bool contains(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;

  /// The inverse of sample(): u and v of a point of the pupil plane. v is above 1 outside the pupil; in a central
  /// obscuration, v has its value at the inner edge of the obscuration.
  Vec2<double> position(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;

  /// contains() for N rays, float or double; `within` gets 0 or 1.
  template <class T>
  void contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                std::uint8_t* within) const noexcept;
  /// Clearances of N rays in their pupils: 1 in the middle, 0 at the edge, down to -1 outside and in the obscuration.
  ///
  /// Continuous over film and pupil points; 1 or -1 for pupils in closed form. Fast if successive rays differ little.
  void clearances(std::size_t count, const TwoPlaneRays<const double>& lines, Wavelength wavelength,
                  double* clearances) const noexcept;

  /// @throws Error if the pupils have a closed form instead of polygons
  FilmPupilArrays arrays() const;

  /// Derivatives of the x and y of a sample by film x and film y, at a constant offset from the middle of the pupil.
  /// (Constant u and v would be useless for filters: polygons rotate about the axis with the film point, and their
  /// sides are not round.)
  struct Derivatives {
    Vec2<double> by_film_x{0, 0}, by_film_y{0, 0};
  };
  Derivatives derivatives(const FilmPoint& film, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// A sample and its derivatives.
  PupilSample sample(const FilmPoint& film, double u, double v, Wavelength wavelength, Derivatives& by) const noexcept;

 private:
  struct Data;
  template <class Value>
  double mean_over_samples(const FilmPoint& film, Wavelength wavelength, const Value& value) const;
  static FilmPupilTable traced(const Lens& lens, double film_radius, bool enclosing, int threads);
  explicit FilmPupilTable(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval
