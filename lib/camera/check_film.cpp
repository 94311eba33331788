// SPDX-License-Identifier: Apache-2.0
#include "check_film.hpp"

#include <cmath>
#include <string>

#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"

namespace petzval::detail {

void check_film(const Lens& lens, const Film& film) {
  const std::string where = lens.name() + ": film: ";
  const auto refuse = [&](const std::string& found_and_wanted) { throw Error(where + found_and_wanted); };
  if (!(film.width_mm > 0 && film.height_mm > 0 && std::isnormal(film.area_mm2()))) {
    refuse("it is " + number(film.width_mm) + " by " + number(film.height_mm) +
           " mm, wanted positive lengths and an area that is a number");
  }
  if (film.columns <= 0 || film.rows <= 0) {
    refuse("it has " + std::to_string(film.columns) + " by " + std::to_string(film.rows) + " pixels, wanted some");
  }
  if (!(std::isfinite(film.centre_x_mm) && std::isfinite(film.centre_y_mm))) {
    refuse("its centre is (" + number(film.centre_x_mm) + ", " + number(film.centre_y_mm) + ") mm, wanted a place");
  }
  if (film.tilt_rad != 0 || film.swing_rad != 0) {
    refuse("it is tilted by " + number(film.tilt_rad) + " and " + number(film.swing_rad) +
           " rad, wanted one perpendicular to the axis");
  }
}

}  // namespace petzval::detail
