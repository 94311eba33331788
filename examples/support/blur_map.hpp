// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/focus/image_rays.hpp"
#include "petzval/image/image.hpp"
#include "point_scene.hpp"

namespace examples {

/// Signed diameters of blurs over an upright picture, rows from the top. NaN: no light.
struct BlurMap {
  int width = 0, height = 0;
  std::vector<double> diameter_mm;
};

/// The film with a number of square pixels along its longer side.
petzval::Film with_pixels(petzval::Film film, int longer_side = 1080);

/// A blur for each pixel of the film, by the ideal lens or (with exact) by bundles of rays, computed at every 8th pixel
/// and interpolated. The result does not depend on the number of threads.
BlurMap blur_map(const petzval::Film& film, const PointScene& scene, const petzval::IdealLens& lens,
                 const petzval::ImageRays* exact, int threads);

/// The end of a scale: 1, 2 or 5 times a power of ten that 99 % of the maps do not exceed.
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
  double scale_mm = 0;                  ///< blur of the deepest colours
  double sharp_mm = 0;                  ///< blur along the thin lines
  std::vector<MarkedPoint> points = {};
};

/// The map in colour with its scale, points and captions. Blue: nearer than the plane of focus; red: beyond it; white:
/// sharp; grey: no light.
petzval::Rgb8Image draw_blur_sheet(const BlurMap& map, const petzval::Film& film, const BlurSheet& sheet);

}  // namespace examples
