// SPDX-License-Identifier: Apache-2.0
#include "check_rectangle.hpp"

#include <cmath>
#include <numbers>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::core_detail {

void check_rectangle(const std::string& where, const Film& film) {
  const auto refuse = [&](const std::string& found_and_wanted) { throw Error(where + ": " + found_and_wanted); };
  constexpr double longest = 1e9;  // mm; densities of rays on larger ones overflow
  if (!(film.width_mm > 0 && film.height_mm > 0 && std::isnormal(film.area_mm2()) && film.width_mm <= longest &&
        film.height_mm <= longest)) {
    refuse("it is " + to_text(film.width_mm) + " by " + to_text(film.height_mm) +
           " mm, wanted positive lengths up to " + to_text(longest) + " mm and an area that is a number");
  }
  if (film.columns <= 0 || film.rows <= 0) {
    refuse("it has " + std::to_string(film.columns) + " by " + std::to_string(film.rows) +
           " pixels, wanted one or more each way");
  }
  if (!(film.margin_mm >= 0 && film.margin_mm <= longest)) {
    refuse("its margin is " + to_text(film.margin_mm) + " mm, wanted one of 0 to " + to_text(longest) + " mm");
  }
  if (film.z_mm && !(std::abs(*film.z_mm) <= longest)) {
    refuse("it is at z = " + to_text(*film.z_mm) + " mm, wanted it within " + to_text(longest) + " mm");
  }
  if (!(std::abs(film.travel_mm) <= longest)) {
    refuse("it travels " + to_text(film.travel_mm) + " mm, wanted a way of up to " + to_text(longest) + " mm");
  }
  if (!(std::abs(film.shift_x_mm) <= longest && std::abs(film.shift_y_mm) <= longest)) {
    refuse("its centre is (" + to_text(film.shift_x_mm) + ", " + to_text(film.shift_y_mm) +
           ") mm, wanted numbers of up to " + to_text(longest) + " mm");
  }
  constexpr double quarter_turn = std::numbers::pi / 2;
  if (!(std::abs(film.tilt_rad) < quarter_turn && std::abs(film.swing_rad) < quarter_turn)) {
    refuse("it is tilted by " + to_text(film.tilt_rad) + " and " + to_text(film.swing_rad) +
           " rad, wanted less than a quarter turn");
  }
}

}  // namespace petzval::core_detail
