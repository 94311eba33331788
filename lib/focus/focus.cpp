// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/focus.hpp"

#include <cmath>
#include <string>

#include "core/text.hpp"
#include "moved_groups.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "solver.hpp"

namespace petzval {

std::string_view name(FocusCriterion criterion) noexcept {
  switch (criterion) {
    case FocusCriterion::thin: return "thin";
    case FocusCriterion::paraxial: return "paraxial";
    case FocusCriterion::min_rms: return "min_rms";
    case FocusCriterion::min_max: return "min_max";
  }
  return "unknown";
}

std::string_view name(DistanceOrigin origin) noexcept {
  switch (origin) {
    case DistanceOrigin::front_vertex: return "front_vertex";
    case DistanceOrigin::film: return "film";
    case DistanceOrigin::entrance_pupil: return "entrance_pupil";
    case DistanceOrigin::front_principal: return "front_principal";
  }
  return "unknown";
}

std::string_view name(FocusStatus status) noexcept {
  switch (status) {
    case FocusStatus::solved: return "solved";
    case FocusStatus::least_tilt: return "least_tilt";
    case FocusStatus::limited: return "limited";
    case FocusStatus::unreachable: return "unreachable";
    case FocusStatus::no_rays: return "no_rays";
    case FocusStatus::afocal: return "afocal";
    case FocusStatus::too_blurred: return "too_blurred";
    case FocusStatus::no_targets: return "no_targets";
    case FocusStatus::not_converged: return "not_converged";
  }
  return "unknown";
}

double origin_z(const Lens& lens, DistanceOrigin origin) {
  using enum DistanceOrigin;
  switch (origin) {
    case film: return lens.film_z();
    case entrance_pupil: return focus_detail::entrance_pupil_z(lens, {}, main_meridian(lens));
    case front_principal: {
      const FirstOrder data = first_order(lens, {}, main_meridian(lens));
      if (data.afocal) throw Error(lens.name() + ": afocal; must have a focal length for a front principal plane");
      return data.front_principal_z;
    }
    case front_vertex: break;
  }
  return 0;
}

FocusSolution solve_focus(const Lens& lens, double distance, const FocusOptions& options) {
  focus_detail::check_distance(lens, distance);
  const focus_detail::FocusSolver solver(lens, options);
  return solver.afocal() ? FocusSolution{.status = FocusStatus::afocal} : solver.focus(distance);
}

FocusSolution solve_subject(const Lens& lens, double film_z, const FocusOptions& options) {
  focus_detail::check_film(lens, film_z);
  const focus_detail::FocusSolver solver(lens, options);
  return solver.afocal() ? FocusSolution{.status = FocusStatus::afocal} : solver.subject(film_z);
}

FocusSolution nearest_focus(const Lens& lens, const FocusOptions& options) {
  const focus_detail::FocusSolver solver(lens, options);
  return solver.afocal() ? FocusSolution{.status = FocusStatus::afocal} : solver.nearest();
}

Lens with_focus(const Lens& lens, double distance, const FocusOptions& options) {
  if (!lens.focus_positions().empty()) return focus_detail::with_moved_groups(lens, distance, options);
  const FocusSolution solution = solve_focus(lens, distance, options);
  if (solution) return with_film(lens, solution.film_z);

  const auto origin_text = [&] {
    switch (options.origin) {
      case DistanceOrigin::film: return "film";
      case DistanceOrigin::entrance_pupil: return "entrance pupil";
      case DistanceOrigin::front_principal: return "front principal plane";
      default: return "front vertex";
    }
  };
  const std::string subject = lens.name() + ": a subject " + to_text(distance) + " mm from the " + origin_text() +
                              " cannot be focused (" + std::string(name(options.criterion)) + ")";
  switch (solution.status) {
    case FocusStatus::no_rays: throw Error(subject + ": no ray gets through the lens");
    case FocusStatus::afocal: throw Error(subject + ": the lens is afocal");
    default: break;
  }
  const double nearest = solution.distance;
  if (std::isinf(nearest)) throw Error(subject + ": the lens forms no real image at any distance");
  throw Error(subject + "; the distance must be " + (distance <= nearest ? "more than " : "at most ") +
              to_text(nearest, 9) + " mm" + (distance <= nearest ? focus_detail::hint_of_units(distance) : ""));
}

}  // namespace petzval
