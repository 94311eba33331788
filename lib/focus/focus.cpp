// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/focus.hpp"

#include <cmath>
#include <string>

#include "conjugates.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"

namespace petzval {

std::string_view name(FocusCriterion criterion) noexcept {
  switch (criterion) {
    case FocusCriterion::thin: return "thin";
    case FocusCriterion::paraxial: return "paraxial";
    case FocusCriterion::min_rms: return "min_rms";
  }
  return "unknown";
}

FocusSolution solve_focus(const Lens& lens, double distance_mm, FocusCriterion criterion, DistanceOrigin origin,
                          std::size_t wavelength) {
  if (!(distance_mm > 0)) {
    throw Error(lens.name() + ": subject distance is " + number(distance_mm) + " mm, wanted one above 0 (or infinity)");
  }
  const FirstOrder data = first_order(lens, wavelength, main_meridian(lens, wavelength));
  if (data.afocal) return {.status = FocusSolution::Status::afocal};
  const detail::Conjugates c = detail::conjugates(lens, data, criterion);
  return criterion == FocusCriterion::min_rms ? detail::solve_min_rms(lens, c, distance_mm, origin, wavelength)
                                              : detail::solve(c, distance_mm, origin);
}

Lens with_focus(const Lens& lens, double distance_mm, FocusCriterion criterion, DistanceOrigin origin,
                std::size_t wavelength) {
  const FocusSolution solution = solve_focus(lens, distance_mm, criterion, origin, wavelength);
  if (solution) return with_film(lens, solution.film_z);

  const std::string subject = lens.name() + ": a subject " + number(distance_mm) + " mm from the " +
                              (origin == DistanceOrigin::film ? "film" : "front vertex") + " cannot be focused (" +
                              std::string(name(criterion)) + ")";
  const double nearest = solution.nearest_distance;
  switch (solution.status) {
    case FocusSolution::Status::no_rays: throw Error(subject + ": no ray gets through the lens");
    case FocusSolution::Status::afocal: throw Error(subject + ": the lens is afocal");
    default: break;
  }
  if (std::isinf(nearest)) throw Error(subject + ": the lens forms no real image at any distance");
  throw Error(subject + ", wanted " + (distance_mm <= nearest ? "more than " : "at most ") + number(nearest, 9) +
              " mm");
}

}  // namespace petzval
