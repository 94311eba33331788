// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "petzval/core/film.hpp"
#include "point_scene.hpp"

namespace examples {

/// Signed blur diameters (mm) of the pixels of an upright picture, rows from the top. NaN: no light.
using BlurMap = std::vector<double>;

/// The film with square pixels, given the number of pixels along its longer side.
petzval::Film with_pixels(petzval::Film film, int longer_side);

/// The blur at each pixel of the film, by the ideal lens or, if `exact` is not null, by exact rays. The
/// result does not depend on the number of threads.
BlurMap blur_map(const petzval::Film& film, const PointScene& scene, const petzval::IdealLens& lens,
                 const petzval::Lens* exact, int threads);

/// Upper end of a colour scale: the smallest 1, 2 or 5 times a power of ten that 99 % of the pixels do not exceed.
double scale_of(std::span<const BlurMap> maps);

}  // namespace examples
