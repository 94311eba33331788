// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "petzval/core/film.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval::testing {

/// A ball lens with the stop at its centre, which does not bend chief rays. A plate behind the ball is met at the field
/// angle, which gives distortion in closed form.
struct BallAndPlate {
  double plate_mm = 0;
  static constexpr double radius_mm = 10, index = 1.5, plate_index = 1.8, to_plate_mm = 2, to_film_mm = 3;

  Lens lens() const {
    Prescription p;
    p.name = "ball and plate";
    p.surfaces = {{.radius = radius_mm, .thickness = radius_mm, .medium = {.nd = index}, .semi_diameter = 9.9},
                  {.thickness = radius_mm, .medium = {.nd = index}, .semi_diameter = 0.5, .stop = true},
                  {.radius = -radius_mm, .thickness = to_plate_mm, .semi_diameter = 9.9},
                  {.thickness = plate_mm, .medium = {.nd = plate_mm > 0 ? plate_index : 1}, .semi_diameter = 60},
                  {.thickness = to_film_mm, .semi_diameter = 60}};
    return compile(p);
  }
  /// Distance from the centre of the ball to the film, without the plate.
  double in_air_mm() const { return radius_mm + to_plate_mm + to_film_mm; }
  double focal_length_mm() const { return in_air_mm() + plate_mm / plate_index; }
  /// Height of the chief ray of a field on the film, by Snell's law.
  double height_mm(double tangent) const {
    const double sine = tangent / std::sqrt(1 + tangent * tangent) / plate_index;
    return tangent * in_air_mm() + plate_mm * sine / std::sqrt(1 - sine * sine);
  }
};

/// A 3:2 film with few pixels.
inline Film small_film(double width_mm) {
  return {.width_mm = width_mm, .height_mm = width_mm / 1.5, .columns = 480, .rows = 320};
}

}  // namespace petzval::testing
