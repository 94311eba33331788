// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"

namespace viewer {

/// A line of a drawing: z to the right and y up (lens frame, mm).
using Polyline = std::vector<petzval::Vec2<float>>;

/// A section of a lens through its axis, as lines.
struct Section {
  std::vector<Polyline> surfaces;  ///< and the edges of elements
  std::vector<Polyline> stop, film, rays;
  petzval::Vec2<float> least{0, 0}, most{0, 0};  ///< of everything but rays
};

/// The lines of a lens. film: drawn with its tilt.
Section section_of(const petzval::Lens& lens, const petzval::Film& film);

/// The rays of a film point through the lens of a camera, seen from the side; empty for first-order models.
std::vector<Polyline> rays_through(const petzval::Camera& camera, const petzval::FilmPoint& point);

/// The area of a plane in the scene that a film point sees, as an image.
struct Bokeh {
  int pixels = 0;
  std::vector<float> values;  ///< pixels x pixels, largest 1
  double width_px = 0;        ///< width of the image, in pixels of the picture
};

/// The bokeh of a pixel at a distance from the entrance pupil (mm), in a picture with focal_px pixels per unit of
/// slope.
Bokeh bokeh_of(const petzval::Camera& camera, const petzval::Vec2<double>& raster, double depth_mm, double focal_px);

}  // namespace viewer
