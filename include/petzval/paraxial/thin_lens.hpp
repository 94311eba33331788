// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"

/// The thin lens in closed form, safe at infinity and next to the focus. Lengths in mm.
namespace petzval::inline v0 {

/// Blur diameter (circle of confusion) c = D f |U - Uf| / (U (Uf - f)) of a thin lens of focal length f and diameter D
/// focused at Uf, for a subject at U. Distances count from the lens; both may be infinite. Within 4 eps, also at
/// infinity, for Uf next to f and for U next to Uf. Throws Error unless U > 0, Uf > f > 0 and D >= 0.
/// Source: Wu et al. 2010, equation 1.
PETZVAL_API double thin_lens_blur_diameter(double focal_length, double diameter, double subject, double focused);

/// Distance from the focal point to the image of a subject at U: V - f = f (f / (U - f)), 0 for infinity. Within 4 eps.
/// Throws Error unless U > f > 0.
PETZVAL_API double thin_lens_extension(double focal_length, double subject);

/// The inverse: the distance U = f + f (f / e) from the lens of the subject in focus on a film e behind the focal
/// point; infinite for e = 0. Within 4 eps. Throws Error unless e >= 0 and f > 0.
PETZVAL_API double thin_lens_subject(double focal_length, double extension);

/// Distance from the lens to the film if film and subject are T apart: the smaller V = 2 f T / (T + sqrt(T (T - 4 f)))
/// of the two, and f for infinity. Within 8 eps for T >= 4.001 f; nearer to 4 f the condition of the root, T / (T - 4
/// f), adds to that. Throws Error unless T >= 4 f > 0.
PETZVAL_API double thin_lens_film_distance(double focal_length, double subject_to_film);

}  // namespace petzval::inline v0
