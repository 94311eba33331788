// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/pupil_plane.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval {

/// A disc in the plane of the pupil whose centre moves with the film point: it lies at shift times that point.
struct PupilDisc {
  double shift = 0;
  double radius = 0;  ///< mm
};

/// A rim that cuts pupils, in their radii on the axis: a disc that moves against the film point, as one does that
/// stands between the pupil and the film.
struct PupilRim {
  double ratio = 1;         ///< its radius
  double radii_per_mm = 0;  ///< of the film
};

/// The image of an iris in the plane of the pupil, in the sections along x and y: its centre lies at shift times the
/// film point, and the rim of the stop appears with these semi-axes. Of a lens of revolution both sections are alike.
struct PupilImage {
  Vec2<double> shift{0, 0};
  Vec2<double> radius{0, 0};  ///< mm
};

/// A tilted film in pupil coordinates. Each point is identified by its virtual film point v: its projection, through
/// the centre of the pupil's plane, onto the upright film. The ray from the point through q in the plane of the pupil
/// meets the upright film in v - nearer q; 1 + nearer is the ratio of the upright film's distance from the pupil's
/// plane to the point's. nearer is slope . v, or where the film has travelled along the axis, by travel times the
/// upright film's distance, (slope . v - travel) / (1 + travel).
struct FilmTilt {
  double slope_x = 0, slope_y = 0;  ///< 1/mm
  double low = 0, high = 0;         ///< range of nearer on the film, at all times
  double radius = 0;                ///< of the farthest virtual film point, mm
  double travel = 0;                ///< in all; the film is everywhere on the way
};

/// A sample of a pupil: its place in the plane of the pupil, mm, and the area that it stands for, mm^2: its density is
/// 1 / area. Uniform samples have the whole area of the pupil. Area 0: nothing to sample.
struct PupilSample {
  double x = 0, y = 0, area = 0;
};

/// A FilmPupilTable as plain numbers, for another processor.
struct FilmPupilArrays {
  /// Images of an iris, or polygons in the cells of a grid: by the distance from the axis (polar: of a lens of
  /// revolution) or over both axes of the film (quadrant: of a lens with cylinders).
  enum class Kind : std::uint8_t { polar, images, quadrant };
  Kind kind = Kind::polar;
  double film_radius = 0;  ///< mm; film points beyond see nothing
  /// Images: [wavelength] shift x, shift y, radius x, radius y, area (see PupilImage). Polygons: [wavelength][row]
  /// [column] the cells of film points between y = height row / rows and the next row. Polar: film points lie on +y and
  /// polygons turn with them; values are linear in the fraction t of the way between rows, given by 1, t. Quadrant:
  /// film points x, y >= 0; the other quadrants are mirror images. Values are linear in t along a row of length
  /// half_widths, from one column to the next, and in s from row to row: 1, t, s, st. With n = 2 or 4
  /// numbers a value, and m = 4 or 9 terms of an area (by 1, t, t^2, t^3, or by 1, t, t^2, s, st, st^2, s^2, s^2 t, s^2
  /// t^2):
  ///
  ///     0, n            x and y of the middle
  ///     2n              area, mm^2
  ///     2n + m + (2n + m) k  corner k from the middle: x, y; area before it (k = 0 ... 64)
  ///     528 + 4k        polar: begin and width of the obscured part of sector k, in squared ways from the middle (0)
  ///     to
  ///                     the outer edge (1)
  std::vector<float> pupils;
  std::size_t rows = 0, columns = 1;
  double height = 0;               ///< mm
  std::vector<float> half_widths;  ///< [row] mm; the last line at the end
  /// Empty: a disc. Or for the edges of blades, in radii: across [edge_terms] and along [edge_terms], then [blade] sine
  /// and cosine of the angle from +y towards +x of the direction to the edge's middle. The point of the edge that has
  /// the part (1 + q) / 2 of its sector's area before it lies q across(t) across that direction, clockwise, and
  /// along(t) along it; t = 2 q^2 - 1, and both are polynomials in t.
  std::vector<float> iris;
  /// Empty: the iris cuts no polygon. Or for each cell of `pupils`:
  ///
  ///     0               1: samples are points of the iris, 0: of what the iris leaves of the polygon
  ///     1               scale of the iris
  ///     2 + n k         place in the pupil by the stop point (x, y), term k, with r = x^2 + y^2: of y 1, y, x^2, y^2,
  ///                     x^2 y, y^3, r^2, r y^2, r^2 y, of x over x 1, y, x^2, y^2, r y, r^2 (polar); of x, then of y
  ///                     1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3 (quadrant)
  ///     2 + 15 n (polar), 2 + 20 n (quadrant)  x and y of the stop points of the middle and of the corners 0 ... 64
  std::vector<float> stop;

  static constexpr std::size_t image_size = 5, polar_size = 784, quadrant_size = 1122, corners = 64, edge_terms = 8;
  static constexpr std::size_t polar_stop_size = 296, quadrant_stop_size = 610;
};

/// The pupils of every point of a film: the parts of the plane behind the lens through which the points see the scene,
/// as a table over the film, one for each compiled wavelength, or in closed form.
///
/// A pupil of a table is a polygon of 64 corners about a middle, less a central obscuration where the lens has one.
/// Corners and middles are interpolated between 33 distances from the axis (65, where areas are the light), or, of a
/// lens with cylinders, bilinearly between 9 x 9 film points in a quadrant, so that the pupil, and with it the sample
/// for a given u and v, moves continuously with the film point. Areas are exact for the interpolated polygon. The
/// tables of lenses with cylinders leave out no obscuration.
///
/// An iris with blades needs with_stop(), which enclosing() and equal_area() call by themselves. Film points that see
/// all of it have samples that are uniform on the iris: polynomials of third to fifth order, interpolated as polygons
/// are, map them to the pupil, and areas change with the sample. At film points with vignetting, samples are uniform on
/// the part of the polygon inside the iris. Samples jump between the two kinds of film points; estimates do not.
///
/// A wavelength in nm has the pupils of the nearest compiled one. Those of enclosing() contain the rays of wavelengths
/// up to the middles between compiled ones, for 0.1 to 1.5 % more samples that are lost where these are 150 nm apart
/// (tests/pupil_table/any_wavelength_test.cpp). Those of equal_area() step in the middles: with eight wavelengths of
/// 400 to 700 nm their light is off by up to 0.5 % there, of a fisheye 0.6 % (tests/camera/any_wavelength_test.cpp).
/// Pupils in closed form are interpolated, within 1e-4.
///
/// Immutable, cheap to copy, free to share between threads.
class PETZVAL_API FilmPupilTable {
 public:
  /// Copies. Moves copy too, so that no FilmPupilTable is ever empty.
  FilmPupilTable(const FilmPupilTable&) = default;
  FilmPupilTable& operator=(const FilmPupilTable&) = default;

  /// Polygons that contain every ray that the lens passes and few others; rays still have to be traced. At most 1e-5 of
  /// the pupils' area is missed (tests/pupil_table/film_pupil_table_test.cpp: every lens of data/ wide open over its
  /// declared field, some of them stopped down; film_cells_test.cpp: a lens with cylinders from wide open to f/64).
  /// Pupils are those of exit_pupil_boundary(). Behind tiny stops, whose images move over the film by more than their
  /// size, pupils hold more than the rays that pass: half of the samples are lost at about f/1e5, most at f/1e6.
  ///
  /// With a bladed iris, at least 97.5 % of the samples pass on the double Gauss, the Tessar and a fisheye of data/
  /// (tests/pupil_table/bladed_pupils_test.cpp: 5 to 9 blades from f/2.87 to f/16).
  ///
  /// film_radius: of the farthest film point, mm, >= 0. The film is that of the lens. Throws Error for a film in the
  /// plane of the last vertex, for a film_radius that is negative or not finite, and for less than one thread.
  /// threads: they share the wavelengths; the table does not depend on them.
  static FilmPupilTable enclosing(const Lens& lens, double film_radius, int threads = 1);

  /// Polygons that have the area of the pupils and nearly their shape, for models without rims: an outline with one
  /// obscuration. That is not enough for pupils that an obscuration divides (catadioptrics beyond their field): they
  /// are described as one part of about that area. So do the models that use these pupils, polynomials and two discs;
  /// exact ones do not. Throws Error as enclosing() does.
  static FilmPupilTable equal_area(const Lens& lens, double film_radius, int threads = 1);

  /// The same for the overlap of some discs, one list for each wavelength. One disc alone has a closed form: of_iris().
  /// wavelengths_nm: the wavelengths; without them there are no samples by nm. Throws Error for planes in one place, a
  /// film_radius or a disc's radius that is negative, a list without discs, and numbers that are not finite or beyond
  /// 1e15; for other than 1 to 65535 lists, as many as rays have positions for; for a primary_wavelength without a
  /// list; and for wavelengths_nm that are not positive, stand there twice (within 1e-6 nm) or are not one for each
  /// list.
  static FilmPupilTable of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                 double film_radius, std::size_t primary_wavelength = 0,
                                 std::span<const double> wavelengths_nm = {});

  /// The same film and planes, and pupils that have the shape of an overlap of discs, one list for each wavelength, and
  /// let through as much light as these do: about their middles they are scaled to the same projected_solid_angle().
  /// They know no stop (with_stop()). Throws Error for other discs than
  /// of_discs() takes, and other than one list for each wavelength of these pupils.
  FilmPupilTable reshaped(std::span<const std::vector<PupilDisc>> discs) const;

  /// What a rim leaves of these pupils: cat's eyes that an artist asks for. Their light falls with their area. Where
  /// the rim moves by 5 radii or less over the film, areas are off by 2 % of the whole pupil's or less
  /// (tests/pupil_table/rim_test.cpp), and may be 0 where eyes nearly close. Throws Error for a ratio that is not
  /// positive, numbers that are not finite, a rim that moves by more than 1e6 radii over the film, and the pupils of a
  /// lens with cylinders or a central obscuration.
  FilmPupilTable cut_by_rim(const PupilRim& rim) const;
  /// Whether a rim has cut them, and the pupils before that.
  bool cut() const noexcept;
  FilmPupilTable whole() const;

  /// The same pupils with the stop of the lens: its iris cuts them, and stop_points() works. Pupils in closed form are
  /// returned unchanged. Throws Error for a lens without a stop that has a semi_diameter. threads: as
  /// in enclosing().
  FilmPupilTable with_stop(const Lens& lens, int threads = 1) const;
  bool knows_stop() const noexcept;
  /// The pupils of the whole stop, of which nothing else is known; of others, the table itself.
  FilmPupilTable of_round_stop() const;

  /// Pupils in closed form: images of an iris, one for each wavelength. iris: as the plane of the pupil shows it.
  /// Throws Error as of_discs() does, and for blades, roundness or rotation out of range.
  static FilmPupilTable of_iris(const TwoPlanes& space, const Iris& iris, std::span<const PupilImage> images,
                                double film_radius, std::size_t primary_wavelength = 0,
                                std::span<const double> wavelengths_nm = {});

  /// The pupils of a tilted film, by virtual film points; those of of_iris() are exact for one that does not travel.
  /// An iris with blades does not cut them: they are the round stop's. They contain every ray of this table that meets
  /// the film, and few others: one pupil for each distance of the virtual film point from the axis, or with cylinders
  /// for each point and its mirror images, holds the pupils of all points there. At most 1e-5 of their area is missed
  /// (tests/camera/tilted_exposure_test.cpp), except where enclosing() misses more: of a ball lens 10 mm across, tilted
  /// by 8 degrees, 2e-3 on a film of 3 x 2 mm, 2e-4 on one of 0.6 x 0.45 mm at f/8. This table's film_radius must reach
  /// to all points where its rays meet the upright film. Throws Error for a radius that is negative or not finite, and
  /// for less than one thread. threads: they share the wavelengths; the table does not depend on them.
  FilmPupilTable for_tilted_film(const FilmTilt& tilt, int threads = 1) const;

  /// The planes that film points and samples lie in.
  const TwoPlanes& space() const noexcept;
  double film_radius() const noexcept;
  /// Film points farther from the axis get no light, as far as is known: film_radius() or less.
  double lit_radius() const noexcept;
  std::size_t wavelengths() const noexcept;
  /// Whether there are samples at a wavelength: by a position, or by nm within the range of the wavelengths.
  bool covers(Wavelength wavelength) const noexcept;
  /// Position of the lens's primary wavelength, the default of all calls.
  std::size_t primary_wavelength() const noexcept;

  /// A uniform sample of the pupil of a film point, for u and v in [0, 1] (clamped). u runs around the middle, from the
  /// lens's +y, so that samples of neighbouring points are neighbours, of the points of an iris with blades from its
  /// first corner; v runs outwards. Area 0 for points outside the
  /// film's radius, numbers that are not finite and wavelengths that the table does not cover.
  PupilSample sample(const FilmPoint& film, double u, double v, Wavelength wavelength = {}) const noexcept;
  /// The same for many: film_x, film_y, u, v, x, y and areas: N each; x and y may be u and v. Float or double.
  template <class T>
  void sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
              const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept;

  /// Area of the pupil of a film point, mm^2; 0 as in `sample`. Behind an iris with blades it is a sum over samples.
  double area(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// The projected solid angle in which a film point sees its pupil, sr, within 1e-4 of it; 0 as in `sample`. Times the
  /// square of the index behind the lens it is the irradiance of the film for a scene of radiance 1.
  double projected_solid_angle(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// The middle of its polygon; the centre of the central obscuration where there is one. (0, 0) without a pupil.
  Vec2<double> middle(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// The area that the whole stop would give it, whatever its blades leave.
  double polygon_area(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// The area of a sample at a place; 0 outside the pupil.
  double sample_area(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;
  template <class T>
  void sample_areas(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                    T* areas) const noexcept;
  /// The scale of the iris (1 or slightly more) if the samples of a film point are uniform on the iris, so that u and v
  /// determine the stop point; otherwise 0.
  double drawn_iris_scale(const FilmPoint& film, Wavelength wavelength = {}) const noexcept;
  /// Intersections of rays with the stop, in semi-diameters, within 0.1 to 2 %, for pupils made by with_stop().
  /// Float or double, N.
  template <class T>
  void stop_points(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths, T* x,
                   T* y) const noexcept;
  /// Whether a place in the plane of the pupil belongs to the pupil of a film point.
  bool contains(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;

  /// The u and v whose sample is a place in the pupil of a film point; v is above 1 outside, and where an obscuration
  /// lies that of its inner edge.
  Vec2<double> position(const FilmPoint& film, double x, double y, Wavelength wavelength = {}) const noexcept;

  /// contains() for many rays. within: N, 0 or 1. Float or double.
  template <class T>
  void contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                std::uint8_t* within) const noexcept;
  /// How far within the pupils the places of some rays lie: from 1 in the middle to 0 at the edge, and on to -1 outside
  /// and in the obscuration. Continuous over film points and places that the pupil faces; of pupils in closed form 1 or
  /// -1. clearances: N. Fast where successive rays differ little.
  void clearances(std::size_t count, const TwoPlaneRays<const double>& lines, Wavelength wavelength,
                  double* clearances) const noexcept;

  FilmPupilArrays arrays() const;

  /// Derivatives of a sample's (x, y) by film x and by film y, at constant u and v.
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
