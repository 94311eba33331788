// SPDX-License-Identifier: Apache-2.0
#include "check_rectangle.hpp"

#include <cmath>
#include <numbers>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::core_detail {

void check_rectangle(const std::string& where, const Film& film) {
  const auto refuse = [&](const std::string& value_and_rule) { throw Error(where + ": " + value_and_rule); };
  constexpr double longest = 1e9;  // mm; densities of rays on larger films overflow
  if (!(film.width_mm > 0 && film.height_mm > 0 && std::isnormal(film.area_mm2()) && film.width_mm <= longest &&
        film.height_mm <= longest)) {
    refuse("width_mm, height_mm = " + to_text(film.width_mm) + ", " + to_text(film.height_mm) +
           "; both must be positive and at most " + to_text(longest) + " mm, and their product a normal number");
  }
  if (film.columns <= 0 || film.rows <= 0) {
    refuse("columns, rows = " + std::to_string(film.columns) + ", " + std::to_string(film.rows) +
           "; both must be at least 1");
  }
  if (!(film.margin_mm >= 0 && film.margin_mm <= longest)) {
    refuse("margin_mm = " + to_text(film.margin_mm) + "; must be 0 to " + to_text(longest) + " mm");
  }
  if (film.z_mm && !(std::abs(*film.z_mm) <= longest)) {
    refuse("z_mm = " + to_text(*film.z_mm) + "; must be at most " + to_text(longest) + " mm in absolute value");
  }
  if (!(std::abs(film.travel_mm) <= longest)) {
    refuse("travel_mm = " + to_text(film.travel_mm) + "; must be at most " + to_text(longest) +
           " mm in absolute value");
  }
  if (!(std::abs(film.shift_x_mm) <= longest && std::abs(film.shift_y_mm) <= longest)) {
    refuse("shift_x_mm, shift_y_mm = " + to_text(film.shift_x_mm) + ", " + to_text(film.shift_y_mm) +
           "; both must be at most " + to_text(longest) + " mm in absolute value");
  }
  constexpr double quarter_turn = std::numbers::pi / 2;
  if (!(std::abs(film.tilt_rad) < quarter_turn && std::abs(film.swing_rad) < quarter_turn)) {
    refuse("tilt_rad, swing_rad = " + to_text(film.tilt_rad) + ", " + to_text(film.swing_rad) +
           "; both must be below a quarter turn (pi/2) in absolute value");
  }
}

}  // namespace petzval::core_detail
