// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/paraxial/first_order.hpp"

namespace petzval {

/// A ray-transfer (ABCD) matrix.
///
/// It acts on (y, n u): the height (mm) and the slope times the signed index, which is negative while light runs
/// backwards after a mirror. Its determinant is 1. The same type also holds maps between other pairs of ray
/// coordinates, with any determinant: height and slope, or the points in which a ray meets two planes.
struct RayMatrix {
  double a = 1, b = 0, c = 0, d = 1;  ///< b in mm, c in 1/mm

  /// The matrix of `*this` followed by `next`.
  constexpr RayMatrix then(const RayMatrix& next) const noexcept {
    return {next.a * a + next.b * c, next.a * b + next.b * d, next.c * a + next.d * c, next.c * b + next.d * d};
  }
  constexpr RayMatrix inverse() const noexcept {
    const double determinant = a * d - b * c;
    return {d / determinant, -b / determinant, -c / determinant, a / determinant};
  }
  /// The matrix that acts on height and slope instead, for a section between media of signed index n_in and n_out.
  constexpr RayMatrix on_slopes(double n_in, double n_out) const noexcept {
    return {a, b * n_in, c / n_out, d * n_in / n_out};
  }
  /// Optical power of the section, -c (1/mm).
  constexpr double power() const noexcept { return -c; }
};

/// The matrix of the surfaces from `first` to `last - 1`.
///
/// It leads from the vertex of the first of these surfaces, before refraction, to the vertex of the last, after
/// refraction. Each surface acts by its curvature at the vertex, including aspheric terms of order 2. A cylinder acts
/// in one meridian only.
///
/// @param lens        the lens
/// @param first       the first surface, from 0
/// @param last        one past the last surface; larger values mean the rest of the lens
/// @param wavelength  the wavelength
/// @param meridian    the meridian
PETZVAL_API RayMatrix ray_matrix(const Lens& lens, std::size_t first, std::size_t last, Wavelength wavelength = {},
                                 Meridian meridian = Meridian::y);

/// The matrix from the first vertex to the vertex of `surface`, both before refraction.
PETZVAL_API RayMatrix ray_matrix_to(const Lens& lens, std::size_t surface, Wavelength wavelength = {},
                                    Meridian meridian = Meridian::y);
/// The result of ray_matrix_to() for every surface, in linear time.
PETZVAL_API std::vector<RayMatrix> ray_matrices_to(const Lens& lens, Wavelength wavelength = {},
                                                   Meridian meridian = Meridian::y);

}  // namespace petzval
