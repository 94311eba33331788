// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::testing {

/// Seidel sums of a lens of revolution for an object at infinity: spherical aberration, coma, astigmatism, Petzval
/// and distortion, for a marginal ray that enters at height 1 and a chief ray of slope 1 through (0, 0, pupil_z).
///
/// From Welford, Aberrations of Optical Systems: A = n (y c + u), H = n (u ybar - ubar y). The sum of distortion is
/// rearranged to avoid a division by A. An asphere is its sphere plus G r^4. Indices and thicknesses are signed, which
/// covers mirrors.
struct SeidelSums {
  long double s1 = 0, s2 = 0, s3 = 0, s4 = 0, s5 = 0;
  long double image_z = 0;       ///< paraxial focus, lens frame
  long double image_nu = 0;      ///< n' u' of the marginal ray behind the lens
  long double chief_height = 0;  ///< height of the chief ray behind the lens
};

inline SeidelSums seidel_sums(const Lens& lens, long double pupil_z) {
  using L = long double;
  SeidelSums sums;
  L n = signed_index(lens, 0), y = 1, u = 0, u_chief = 1, y_chief = -pupil_z;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const LensSurface& s = lens.surfaces()[i];
    L c = s.curvature, fourth = (1 + static_cast<L>(s.conic)) * c * c * c / 8;
    for (const AsphereTerm& t : s.aspheric) {
      if (t.order == 2) c += 2 * static_cast<L>(t.coefficient);
      if (t.order == 4) fourth += t.coefficient;
    }
    const L n_out = signed_index(lens, i + 1), g = fourth - c * c * c / 8;
    const L a = n * (y * c + u), a_chief = n * (y_chief * c + u_chief);
    const L h = n * (u * y_chief - u_chief * y);
    const L u_out = a / n_out - y * c, u_chief_out = a_chief / n_out - y_chief * c;
    const L bend = u_out / n_out - u / n, step = 1 / n_out - 1 / n, square_step = 1 / (n_out * n_out) - 1 / (n * n);
    const L asphere = 8 * g * (n_out - n) * y;  // times three heights
    sums.s1 += -a * a * y * bend + asphere * y * y * y;
    sums.s2 += -a * a_chief * y * bend + asphere * y * y * y_chief;
    sums.s3 += -a_chief * a_chief * y * bend + asphere * y * y_chief * y_chief;
    sums.s4 += -h * h * c * step;
    sums.s5 += -a_chief * (a_chief * a_chief * y * square_step + c * step * y_chief * (h - a_chief * y)) +
               asphere * y_chief * y_chief * y_chief;
    n = n_out, u = u_out, u_chief = u_chief_out;
    sums.image_z = s.vertex_z - y / u;
    sums.chief_height = y_chief - y / u * u_chief;
    sums.image_nu = n * u;
    y += s.thickness * u, y_chief += s.thickness * u_chief;
  }
  return sums;
}

}  // namespace petzval::testing
