// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/image/image.hpp"
#include "point_scene.hpp"

namespace examples {

/// Signed blur diameters over an upright picture, rows from the top. NaN: no light.
struct BlurMap {
  int width = 0, height = 0;
  std::vector<double> diameter_mm;
};

/// The film with square pixels, given the number of pixels along its longer side.
petzval::Film with_pixels(petzval::Film film, int longer_side = 1080);

/// The blur at each pixel of the film, by the ideal lens or, if `exact` is not null, by exact rays. It is computed at
/// every 8th pixel and interpolated. The result does not depend on the number of threads.
BlurMap blur_map(const petzval::Film& film, const PointScene& scene, const petzval::IdealLens& lens,
                 const petzval::Lens* exact, int threads);

/// Upper end of a colour scale: the smallest 1, 2 or 5 times a power of ten that 99 % of the pixels do not exceed.
double scale_of(std::span<const BlurMap> maps);

/// A focus point in the picture.
struct MarkedPoint {
  std::optional<petzval::FilmPoint> where;
  double blur_mm = 0;  ///< NaN: unknown
  bool used = true;
};

struct BlurSheet {
  std::string title = {}, subtitle = {};
  std::vector<std::string> notes = {};  ///< lines at the foot
  double scale_mm = 0;                  ///< blur shown in the deepest colours
  double sharp_mm = 0;                  ///< blur along the thin contour lines
  std::vector<MarkedPoint> points = {};
};

/// The map in colour with its scale, points and captions. Blue: nearer than the plane of focus; red: beyond it; white:
/// sharp; grey: no light.
petzval::Rgb8Image draw_blur_sheet(const BlurMap& map, const petzval::Film& film, const BlurSheet& sheet);

}  // namespace examples
