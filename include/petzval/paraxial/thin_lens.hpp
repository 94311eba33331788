// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"

/// The thin lens in closed form, safe at infinity and next to the focus. Lengths in mm.
namespace petzval::inline v0 {

/// Blur diameter c = D f |U - Uf| / (U (Uf - f)) of a thin lens of focal length f and diameter D focused at Uf for a
/// subject at U, distances from the lens, either may be infinite. Safe at infinity, next to f, and for U next to Uf:
/// within 4 eps. Throws Error unless U > 0 and Uf > f > 0 and D >= 0. Source: Wu et al. 2010, equation 1.
PETZVAL_API double thin_lens_blur_diameter(double focal_length, double diameter, double subject, double focused);

/// How far behind the focal point a thin lens images a subject at U: V - f = f (f / (U - f)), 0 at infinity, within 4
/// eps. Throws Error unless U > f > 0.
PETZVAL_API double thin_lens_extension(double focal_length, double subject);

/// The inverse: the distance U = f + f (f / e) from the lens of what a film e behind the focal point has in focus;
/// infinite for e = 0. Within 4 eps. Throws Error unless e >= 0 and f > 0.
PETZVAL_API double thin_lens_subject(double focal_length, double extension);

/// Lens to film where film and subject are T apart: the smaller V = 2 f T / (T + sqrt(T (T - 4 f))) of two, f at
/// infinity. Within 8 eps of the result for T >= 4.001 f; nearer to 4 f the root's own condition, T / (T - 4 f), comes
/// in. Throws Error unless T >= 4 f > 0.
PETZVAL_API double thin_lens_film_distance(double focal_length, double subject_to_film);

}  // namespace petzval::inline v0
