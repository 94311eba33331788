// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "root.hpp"

namespace petzval::focus_detail {
namespace {

using enum FocusStatus;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Accuracy of a position at a flat extremum: half of the digits.
constexpr double flat_tolerance = 1e-9;

}  // namespace

Search::Search(const FocusSolver& solver)
    : solver_(solver), c_(solver.conjugates()), cap_(4 * c_.vergence_of_infinite_film()) {
  if (const auto image = solver.image(-infinity)) infinite_film_ = image->film_z;
}

double Search::subject_at(double vergence) const noexcept { return vergence > 0 ? c_.subject_at(vergence) : -infinity; }

/// nullopt if there is no image, for example next to the front of the lens.
std::optional<double> Search::film(double vergence) const {
  if (!(vergence > 0)) return infinite_film_;
  const auto image = solver_.image_at(vergence);
  return image ? std::optional(image->film_z) : std::nullopt;
}

/// The vergence of the subject that belongs to a film, limited to cap_. A virtual image counts as a subject that is too
/// near (cap_); a real image with a vergence above vergence_of_infinite_film counts as a subject that is too far
/// (-cap_). If the lens images distant subjects inside itself, only the vergence is used.
double Search::film_vergence(double film_z) const noexcept {
  const double vergence = c_.vergence_of_film(film_z), infinite = c_.vergence_of_infinite_film();
  if (!c_.real(*infinite_film_)) return vergence < -infinite / 2 ? cap_ : std::min(vergence, cap_);
  if (!c_.real(film_z)) return cap_;
  return vergence > infinite ? -cap_ : std::max(vergence, -cap_);
}

/// Distance from subject to film; infinite if there is no real image.
double Search::separation(double vergence) const {
  const auto film_z = film(vergence);
  return film_z && c_.real(*film_z) ? *film_z - subject_at(vergence) : infinity;
}

/// The subject of a film that is farther from the lens than the film for infinity; nullopt beyond the limit.
std::optional<double> Search::vergence_for(double target) const {
  const auto excess = [&](double vergence) {
    const auto film_z = film(vergence);
    return (film_z ? film_vergence(*film_z) : cap_) - target;
  };
  const auto root_between = [&](double low, double high) {
    const double vergence = root(excess, low, high);
    const bool found = std::abs(excess(vergence)) < flat_tolerance * cap_;  // excludes jumps at which images end
    return found ? std::optional(vergence) : std::nullopt;
  };
  // The paraxial subject is close to the exact subject, and the films of both move by nearly equal amounts.
  const double vertex = c_.vergence_of_vertex();
  double low = 0, high = std::clamp(target, 0.0, vertex / 2);
  for (int i = 0; i < 20; ++i) {
    const double missing = -excess(high);
    if (missing <= 0) {
      if (const auto vergence = root_between(low, high)) return vergence;
      break;
    }
    low = high;
    high = std::min(high + 2 * missing, (high + vertex) / 2);
  }
  const double last = limit();
  return excess(last) >= 0 ? root_between(0, last) : std::nullopt;
}

FocusSolution Search::at(FocusStatus status, double vergence) const {
  const double subject_z = subject_at(vergence);
  const auto film_z = film(vergence);
  if (!film_z) return no_focus(c_);
  return {status, *film_z, subject_z, c_.distance(subject_z, *film_z)};
}

/// The vergence at which the film is farthest from the lens.
double Search::limit() const {
  const auto film_out = [&](double vergence) {
    const auto film_z = film(vergence);
    return film_z && c_.real(*film_z) ? c_.vergence_of_film(*film_z) : -infinity;
  };
  const double vertex = c_.vergence_of_vertex();
  return highest(film_out, 0, std::min(cap_, vertex), flat_tolerance * vertex);
}

/// The vergence at which the distance between subject and film is least, close to the paraxial turning point.
double Search::turning_point() const {
  const double start = c_.vergence(c_.subject_z(nearest_p(c_)));
  return highest([&](double vergence) { return -separation(vergence); }, start / 4,
                 std::min(4 * start, c_.vergence_of_vertex()), flat_tolerance * start);
}

FocusSolution Search::nearest() const {
  if (!infinite_film_) return {.status = no_rays};
  const bool turns = c_.origin == DistanceOrigin::film && c_.lens.product() > 0;
  if (c_.origin == DistanceOrigin::film && !turns)
    return focus_from_film(0);  // behind a mirror, subject and film coincide
  const double vergence = turns ? turning_point() : limit();
  if (std::isinf(separation(vergence))) return no_focus(c_);
  FocusSolution result = at(solved, vergence);
  if (!turns && film_vergence(result.film_z) > (1 - 1e-6) * c_.vergence_of_infinite_film()) {
    result.film_z = c_.direction * infinity;
    result.distance = c_.distance(result.subject_z, result.film_z);
  }
  return result;
}

FocusSolution Search::too_near() const {
  FocusSolution result = nearest();
  if (result) result.status = unreachable;
  return result;
}

/// For a lens that focuses distant subjects inside itself: the subject whose image lies at the last vertex.
FocusSolution Search::farthest() const {
  const auto vergence = vergence_for(film_vergence(c_.lens.rear_z));
  return vergence ? at(unreachable, *vergence) : no_focus(c_);
}

FocusSolution Search::focus(double distance) const {
  if (!infinite_film_) return {.status = no_rays};
  if (c_.origin == DistanceOrigin::film && std::isfinite(distance)) return focus_from_film(distance);
  const double subject_z = std::isinf(distance) ? -infinity : c_.origin_z - distance;
  if (!(subject_z < 0)) return too_near();
  const double vergence = c_.vergence(subject_z);
  // Points close to the front of the lens may not see the pupil.
  const bool near = vergence > c_.vergence_of_infinite_film();
  const auto image = near ? solver_.image_seen(subject_z) : solver_.image(subject_z);
  if (!image) return near ? too_near() : FocusSolution{.status = no_rays};
  const double film_z = image->film_z;
  if (!c_.real(film_z)) return film_vergence(film_z) < c_.vergence_of_infinite_film() ? farthest() : too_near();

  // Close to the limit, the film may already move back towards the lens.
  if (vergence > c_.vergence_of_infinite_film() / 16) {
    const auto before = film(vergence * (1 - 1e-7));
    if (before && c_.vergence_of_film(*before) > c_.vergence_of_film(film_z)) return too_near();
  }
  return {solved, film_z, subject_z, distance};
}

FocusSolution Search::focus_from_film(double distance) const {
  double low = 0;
  if (!c_.real(*infinite_film_)) {
    const FocusSolution far = farthest();
    if (std::isinf(far.subject_z) || distance > far.distance) return far;
    low = c_.vergence(far.subject_z);
  }

  // The separation decreases from this vergence to the turning point; behind a single mirror there is no turning point.
  double high = c_.vergence_of_infinite_film();
  if (c_.lens.product() > 0) {
    high = c_.vergence(c_.subject_z(nearest_p(c_)));
    if (separation(high) > distance) {
      high = turning_point();
      const double least = separation(high);
      if (std::isinf(least)) return no_focus(c_);
      if (least > distance) return at(unreachable, high);
    }
  }
  // Negative if the subject lies beyond the point at `distance` from its film.
  const auto excess = [&](double vergence) {
    const auto film_z = film(vergence);
    return film_z && c_.real(*film_z) ? vergence - c_.vergence(*film_z - distance) : high;
  };
  const auto film_z = film(root(excess, low, high));
  if (!film_z) return no_focus(c_);
  return {solved, *film_z, *film_z - distance, distance};
}

FocusSolution Search::subject(double film_z) const {
  if (!infinite_film_) return {.status = no_rays};
  if (*infinite_film_ == film_z && c_.real(film_z)) return {solved, film_z, -infinity, infinity};
  if (!c_.real(*infinite_film_)) {
    if (!c_.real(film_z)) return farthest();
  } else if (!c_.real(film_z) || c_.vergence_of_film(film_z) < c_.vergence_of_film(*infinite_film_)) {
    return {unreachable, *infinite_film_, -infinity, infinity};
  }
  const auto vergence = vergence_for(film_vergence(film_z));
  if (!vergence) return too_near();
  const double subject_z = subject_at(*vergence);
  return {solved, film_z, subject_z, c_.distance(subject_z, film_z)};
}

}  // namespace petzval::focus_detail
