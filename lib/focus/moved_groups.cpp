// SPDX-License-Identifier: Apache-2.0
#include "moved_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "solver.hpp"

namespace petzval::focus_detail {

Lens with_moved_groups(const Lens& lens, double distance, const FocusOptions& options) {
  const double first = lens.focus_positions().front().inverse_distance;
  const double last = lens.focus_positions().back().inverse_distance;
  const double spare = last - first, least = first - spare, most = last + spare;

  FocusSolution solution;
  const auto at = [&](double inverse_distance) {
    Lens moved = with_groups_at(lens, inverse_distance);
    solution = solve_focus(moved, distance, options);
    return moved;
  };
  const auto nearest = [&] {
    const Lens moved = with_groups_at(lens, last);
    return solve_subject(moved, moved.film_z(), options).distance;
  };
  const auto refuse = [&](const std::string& why) -> Error {
    return Error(lens.name() + ": a subject at " + to_text(distance) +
                 " mm cannot be focused by moving groups: " + why + "; the distance must be about " +
                 to_text(nearest(), 6) + " mm or more" + hint_of_units(distance));
  };

  // The error of the film position is nearly linear in the inverse distance of the group positions. The secant method
  // stops at the rounding error of the film position.
  double x = std::clamp(1 / distance, first, last), x_before = x;
  double error = 0, error_before = 0;
  for (int step = 0; step < 40; ++step) {
    const Lens moved = at(x);
    if (!solution) throw refuse("the lens forms no real image");
    error = solution.film_z - moved.film_z();
    const double rounding = 8 * std::numeric_limits<double>::epsilon() * std::abs(moved.film_z());
    if (std::abs(error) <= rounding) return moved;
    if (step > 3 && std::abs(error) < 1e-9 && std::abs(error) >= std::abs(error_before)) return moved;
    double next = step == 0 ? x + 1e-3 * (x > first ? first - last : last - first)
                            : x - error * (x - x_before) / (error - error_before);
    if (!std::isfinite(next)) throw refuse("the film of the subject does not move with the groups");
    if (next == x) return moved;
    if ((next > most && x == most) || (next < least && x == least)) throw refuse("the groups cannot move far enough");
    x_before = x, error_before = error;
    x = std::clamp(next, least, most);
  }
  throw refuse("the search for their positions does not converge");
}

}  // namespace petzval::focus_detail
