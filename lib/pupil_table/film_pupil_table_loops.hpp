// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/loop_math.hpp"
#include "core/simd.hpp"
#include "core/widest.hpp"
#include "lens/wavelength_rows.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "pupil_table/sector.hpp"

namespace petzval::pupil_table_detail {

/// Squared distances from the axis, mm^2, up to which film points count as on it: smaller ones have too few digits for
/// a direction.
template <class R>
inline constexpr R axis_r2 = std::numeric_limits<R>::min() / std::numeric_limits<R>::epsilon();

/// The polygons between two distances from the axis, as polynomials of the fraction t of the way, in one row of numbers
/// that loops gather from: what is used together lies together. Corners are relative to the middle.
struct StripLayout {
  static constexpr std::size_t middle_y = 0;  ///< y, y by t; x is 0
  static constexpr std::size_t whole = 4;     ///< area by powers of t
  static constexpr std::size_t sectors =
      8;  ///< [65] first corner x, y, x by t, y by t; area of the sectors before by powers of t
  static constexpr std::size_t sector = 8, area = 4;                                 ///< numbers of one
  static constexpr std::size_t obscured = sectors + sector * (polygon_corners + 1);  ///< [64] begin, width, these by t
  static constexpr std::size_t size = obscured + 4 * polygon_corners;
};

/// The strips of all wavelengths, borrowed. Their polygons are those of film points on +y and turn with the point.
template <class R>
struct StripTable {
  using Layout = StripLayout;
  const R* strips = nullptr;  ///< [wavelength * count + strip] StripLayout
  std::size_t count = 0, wavelengths = 0, primary = 0;
  R lit_radius = 0, strips_per_mm = 0;
  bool obscured = false;  ///< at least one sector has an obscuration
  int corrections = 0;    ///< by how many sectors equal shares may miss the right one; 0: by half a one
};

/// The polygons within a cell of a grid over the film, bilinear in the fractions s of the way from its first row to
/// its second and t along a row: numbers by 1, t, s and st. Areas are products of two such, by 1, t, t^2, s, st, st^2,
/// s^2, s^2 t and s^2 t^2. Without obscurations.
struct CellLayout {
  static constexpr std::size_t middle_x = 0, middle_y = 4;
  static constexpr std::size_t whole = 8;     ///< area
  static constexpr std::size_t sectors = 17;  ///< [65] first corner x, y, relative to the middle; area before
  static constexpr std::size_t sector = 17, area = 8;
  static constexpr std::size_t size = sectors + sector * (polygon_corners + 1);
};

/// The cells of all wavelengths, borrowed. They cover the quadrant x, y >= 0 of the film; the pupils of the others are
/// its mirror images. Corner 0 lies towards +y of the middle, corner 32 towards -y.
template <class R>
struct CellTable {
  using Layout = CellLayout;
  const R* cells = nullptr;        ///< [(wavelength * rows + row) * columns + column] CellLayout
  const R* half_widths = nullptr;  ///< [rows + 1] x at which rows end, mm
  std::size_t rows = 0, columns = 0, wavelengths = 0, primary = 0;
  R film_radius = 0, rows_per_mm = 0;
  int corrections = 0;  ///< as in StripTable
};

/// As CellLayout; s and t are fractions of the way between two distances from the axis and between two azimuths.
struct BladedLayout : CellLayout {
  static constexpr std::size_t guide = CellLayout::size;  ///< [17] in sectors, where k / 16 of the area end, nearly
  static constexpr std::size_t guide_steps = 16;
  static constexpr std::size_t size = guide + guide_steps + 1;
  static constexpr std::size_t fold = 6;  ///< numbers of one: see BladedTable
};

/// The cells of a lens of revolution with a bladed iris, of all wavelengths, borrowed. They cover the film from the
/// direction of a blade's corner, as +y, to that of the next edge's middle; in a film turned or mirrored about the axis
/// so that the corner is another one pupils are alike.
template <class R>
struct BladedTable {
  using Layout = BladedLayout;
  const R* cells = nullptr;  ///< [(wavelength * rows + row) * columns + column] CellLayout; middles lie on the
                             ///< direction of the film point, at middle_y
  const R* folds = nullptr;  ///< [2 blade + mirrored] the matrix, by rows, from the table's film to the lens's, then
                             ///< the table's corner that is the iris's first one, and -1 where u runs backwards, or 1
  std::size_t rows = 0, columns = 0, wavelengths = 0, primary = 0;
  std::size_t corners = 0;        ///< of the polygons: as many for each blade; the others are like corner 0
  R blades = 0, first_blade = 0;  ///< how many, and the turn from the first corner to +y, 0 to `blades`
  R lit_radius = 0, rows_per_mm = 0;
  int corrections = 0;  ///< as in StripTable
};

namespace {

/// The angle of a direction from +y to +x, of its sine and cosine, as a part of the whole turn (|turn| <= 1/2), within
/// 6e-8: u counts from +y of the film's frame, not from the direction of the film point, so that near the axis the
/// samples of neighbours are neighbours. One polynomial for all scalars, derivatives included.
template <class T>
PETZVAL_INLINE T turn_of(const T& sine, const T& cosine) noexcept {
  // In forms without branches, which nobody could predict.
  using core_detail::sign_of, std::abs;
  const T across = abs(sine), along = abs(cosine), a = along < across ? along : across;
  const T s = a * a;
  // asin(a) / 2 pi within an eighth of a turn, by least squares of the largest error, 1/8 at its end.
  const T s2 = s * s;
  const T first = T(0.15915393812486814) + s * T(0.0265771964583);
  const T second = T(0.0111934983367) + s * T(0.0116048821993);
  const T third = T(-0.0077339762488) + s * T(0.0181935231706);
  T turn = a * (first + s2 * (second + s2 * third));
  const T octant = sign_of(T(along - across)), half = sign_of(cosine);
  turn = T(0.125) * (T(1) - octant) + octant * turn;
  turn = T(0.25) * (T(1) - half) + half * turn;
  return sign_of(sine) * turn;
}

/// Where a share of the area is expected to end, in sectors that have equal areas in each of two halves. right: the
/// share of the first half.
template <class T>
inline T sectors_in_halves(T share, T right) noexcept {
  // Without branches: within the half in which the share ends, and after the other.
  const T in_left = share < right ? T(0) : T(1);
  const T begin = in_left * right, own = right + in_left * (T(1) - T(2) * right);
  return T(polygon_corners) / T(2) * (in_left + (share - begin) / (own > T(0) ? own : T(1)));
}

}  // namespace

struct FilmPupilLoops {
  template <class Table, class R>
  using Sample = void (*)(const Table&, std::size_t, const R* film_x, const R* film_y, const R* u, const R* v,
                          const RayWavelengths&, R* x, R* y, R* areas) noexcept;
  template <class Table, class R>
  using Contains = void (*)(const Table&, std::size_t, const R* film_x, const R* film_y, const R* x, const R* y,
                            const RayWavelengths&, std::uint8_t* within) noexcept;
  /// Of one kind of table.
  template <template <class> class Table>
  struct Of {
    Sample<Table<float>, float> single;
    Sample<Table<double>, double> twice;
    Contains<Table<float>, float> contains_single;
    Contains<Table<double>, double> contains_twice;
    /// One sample. wavelength: -1 for one that does not exist.
    PupilSample (*one)(const Table<double>&, double film_x, double film_y, double u, double v,
                       std::int32_t wavelength) noexcept;
  };
  Of<StripTable> strips;
  Of<CellTable> cells;
  Of<BladedTable> bladed;
  void (*find_nearest)(const lens_detail::NearestPosition&, std::size_t, const float* nm,
                       std::uint16_t* positions) noexcept;
};

PETZVAL_WIDEST(FilmPupilLoops, film_pupil_table)

}  // namespace petzval::pupil_table_detail
