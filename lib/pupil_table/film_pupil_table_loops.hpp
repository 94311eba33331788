// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/sector.hpp"

namespace petzval::inline v0::pupil_table_detail {

/// The polygons between two distances from the axis, as polynomials of the fraction t of the way, in one row of numbers
/// that loops gather from: what is used together lies together. Corners are relative to the middle.
struct StripLayout {
  static constexpr std::size_t middle_y = 0;  ///< y, y by t; x is 0
  static constexpr std::size_t whole = 4;     ///< area by powers of t
  static constexpr std::size_t sectors =
      8;  ///< [65] first corner x, y, x by t, y by t; area of the sectors before by powers of t
  static constexpr std::size_t sector = 8;                                           ///< numbers of one
  static constexpr std::size_t obscured = sectors + sector * (polygon_corners + 1);  ///< [64] begin, width, these by t
  static constexpr std::size_t size = obscured + 4 * polygon_corners;
};

/// The strips of all wavelengths, borrowed.
template <class R>
struct StripTable {
  const R* strips = nullptr;  ///< [wavelength * count + strip] StripLayout
  std::size_t count = 0, wavelengths = 0, primary = 0;
  R lit_radius = 0, strips_per_mm = 0;
  bool turned = true;     ///< the polygons are those of film points on +y and turn with the point
  bool obscured = false;  ///< at least one sector has an obscuration
  int corrections = 0;    ///< by how many sectors equal shares may miss the right one; 0: by half a one
};

namespace {

/// The angle of a direction from +y to +x, of its sine and cosine, as a part of the whole turn (|turn| <= 1/2), within
/// 6e-8: u counts from +y of the film's frame, not from the direction of the film point, so that near the axis the
/// samples of neighbours are neighbours. One polynomial for all scalars, derivatives included.
template <class T>
inline T turn_of(const T& sine, const T& cosine) noexcept {
  const T across = sine < T(0) ? T(-sine) : sine, along = cosine < T(0) ? T(-cosine) : cosine;
  const bool steep = across > along;
  const T a = steep ? along : across;
  const T s = a * a;
  // asin(a) / 2 pi within an eighth of a turn, by least squares of the largest error, 1/8 at its end.
  T turn =
      a *
      (T(0.15915393812486814) +
       s * (T(0.0265771964583) +
            s * (T(0.0111934983367) + s * (T(0.0116048821993) + s * (T(-0.0077339762488) + s * T(0.0181935231706))))));
  turn = steep ? T(T(0.25) - turn) : turn;
  turn = cosine < T(0) ? T(T(0.5) - turn) : turn;
  return sine < T(0) ? T(-turn) : turn;
}

}  // namespace

struct FilmPupilLoops {
  using Float = void (*)(const StripTable<float>&, std::size_t, const float*, const float*, const float*, const float*,
                         const RayWavelengths&, float*, float*, float*) noexcept;
  using Double = void (*)(const StripTable<double>&, std::size_t, const double*, const double*, const double*,
                          const double*, const RayWavelengths&, double*, double*, double*) noexcept;
  template <class R>
  using Contains = void (*)(const StripTable<R>&, std::size_t, const R* film_x, const R* film_y, const R* x, const R* y,
                            const RayWavelengths&, std::uint8_t* within) noexcept;
  Float single;
  Double twice;
  Contains<float> contains_single;
  Contains<double> contains_twice;
};

PETZVAL_WIDEST(FilmPupilLoops, film_pupil_table)

}  // namespace petzval::inline v0::pupil_table_detail
