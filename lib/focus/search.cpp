// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "root.hpp"

namespace petzval::inline v0::focus_detail {
namespace {

using enum FocusStatus;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Of a place found at a flat extremum, where half the digits decide.
constexpr double flat = 1e-9;

}  // namespace

Search::Search(const FocusModel& model)
    : model_(model), c_(model.conjugates()), cap_(4 * c_.nearness_of_infinite_film()) {
  if (const auto image = model.image(-infinity)) infinite_film_ = image->film_z;
}

double Search::subject_at(double nearness) const noexcept { return nearness > 0 ? c_.subject_at(nearness) : -infinity; }

/// None where there is no image, next to the front of the lens above all.
std::optional<double> Search::film(double nearness) const {
  if (!(nearness > 0)) return infinite_film_;
  const auto image = model_.image_at(nearness);
  return image ? std::optional(image->film_z) : std::nullopt;
}

/// The film on the subjects' scale. A virtual image is that of a subject too near, and a real one anywhere else that of
/// one too far, unless the lens has virtual images of distant subjects too, inside itself; then the place decides.
double Search::film_nearness(double film_z) const noexcept {
  const double nearness = c_.nearness_of_film(film_z), infinite = c_.nearness_of_infinite_film();
  if (!c_.real(*infinite_film_)) return nearness < -infinite / 2 ? cap_ : std::min(nearness, cap_);
  if (!c_.real(film_z)) return cap_;
  return nearness > infinite ? -cap_ : std::max(nearness, -cap_);
}

/// From film to subject; infinite where there is no real image.
double Search::separation(double nearness) const {
  const auto film_z = film(nearness);
  return film_z && c_.real(*film_z) ? *film_z - subject_at(nearness) : infinity;
}

/// The subject with a film farther out than that of infinity; none where the limit comes first.
std::optional<double> Search::nearness_for(double wanted) const {
  const auto excess = [&](double nearness) {
    const auto film_z = film(nearness);
    return (film_z ? film_nearness(*film_z) : cap_) - wanted;
  };
  const auto root_between = [&](double low, double high) {
    const double nearness = root(excess, low, high);
    const bool found = std::abs(excess(nearness)) < flat * cap_;  // and no jump where images end
    return found ? std::optional(nearness) : std::nullopt;
  };
  // The paraxial subject is near; beside it the film moves as it does there.
  const double vertex = c_.nearness_of_vertex();
  double low = 0, high = std::clamp(wanted, 0.0, vertex / 2);
  for (int i = 0; i < 20; ++i) {
    const double missing = -excess(high);
    if (missing <= 0) {
      if (const auto nearness = root_between(low, high)) return nearness;
      break;
    }
    low = high;
    high = std::min(high + 2 * missing, (high + vertex) / 2);
  }
  const double last = limit();
  return excess(last) >= 0 ? root_between(0, last) : std::nullopt;
}

FocusSolution Search::at(FocusStatus status, double nearness) const {
  const double subject_z = subject_at(nearness), film_z = film(nearness).value();
  return {status, film_z, subject_z, c_.distance(subject_z, film_z)};
}

/// Where the film is farthest out.
double Search::limit() const {
  const double paraxial = c_.nearness_of_infinite_film();
  const auto film_out = [&](double nearness) {
    const auto film_z = film(nearness);
    return film_z && c_.real(*film_z) ? c_.nearness_of_film(*film_z) : -infinity;
  };
  const double vertex = c_.nearness_of_vertex();
  return highest(film_out, 0, std::min(4 * paraxial, vertex), flat * vertex);
}

/// Where distances from the film turn, near the paraxial turning point.
double Search::turning_point() const {
  const double start = c_.nearness(c_.subject_z(nearest_p(c_)));
  return highest([&](double nearness) { return -separation(nearness); }, start / 4,
                 std::min(4 * start, c_.nearness_of_vertex()), flat * start);
}

FocusSolution Search::nearest() const {
  if (!infinite_film_) return {.status = no_rays};
  const bool turns = c_.origin == DistanceOrigin::film && c_.product > 0;
  if (c_.origin == DistanceOrigin::film && !turns) return focus_from_film(0);  // behind a mirror: where they meet
  const double nearness = turns ? turning_point() : limit();
  if (std::isinf(separation(nearness))) return no_focus(c_);
  FocusSolution result = at(solved, nearness);
  if (!turns && film_nearness(result.film_z) > (1 - 1e-6) * c_.nearness_of_infinite_film()) {
    result.film_z = c_.sense * infinity;
    result.distance = c_.distance(result.subject_z, result.film_z);
  }
  return result;
}

FocusSolution Search::too_near() const {
  FocusSolution result = nearest();
  if (result) result.status = unreachable;
  return result;
}

/// Of a lens that focuses distant subjects inside itself: the one whose image lies on its last vertex.
FocusSolution Search::farthest() const {
  const auto nearness = nearness_for(film_nearness(c_.last_z));
  return nearness ? at(unreachable, *nearness) : no_focus(c_);
}

FocusSolution Search::focus(double distance) const {
  if (!infinite_film_) return {.status = no_rays};
  if (c_.origin == DistanceOrigin::film && std::isfinite(distance)) return focus_from_film(distance);
  const double subject_z = std::isinf(distance) ? -infinity : c_.origin_z - distance;
  if (!(subject_z < 0)) return too_near();
  const auto image = model_.image(subject_z);
  if (!image) return {.status = no_rays};
  const double film_z = image->film_z, nearness = c_.nearness(subject_z);
  if (!c_.real(film_z)) return film_nearness(film_z) < c_.nearness_of_infinite_film() ? farthest() : too_near();

  // Next to the limit the film may have turned back already.
  if (nearness > c_.nearness_of_infinite_film() / 16) {
    const auto before = film(nearness * (1 - 1e-7));
    if (before && c_.nearness_of_film(*before) > c_.nearness_of_film(film_z)) return too_near();
  }
  return {solved, film_z, subject_z, distance};
}

FocusSolution Search::focus_from_film(double distance) const {
  double low = 0;
  if (!c_.real(*infinite_film_)) {
    const FocusSolution far = farthest();
    if (std::isinf(far.subject_z) || distance > far.distance) return far;
    low = c_.nearness(far.subject_z);
  }

  // The separation falls from there to its turning point; behind a single mirror it falls without end.
  double high = c_.nearness_of_infinite_film();
  if (c_.product > 0) {
    high = c_.nearness(c_.subject_z(nearest_p(c_)));
    if (separation(high) > distance) {
      high = turning_point();
      const double least = separation(high);
      if (std::isinf(least)) return no_focus(c_);
      if (least > distance) return at(unreachable, high);
    }
  }
  // A subject is too far where it lies beyond the one at the distance from its film.
  const auto excess = [&](double nearness) {
    const auto film_z = film(nearness);
    return film_z && c_.real(*film_z) ? nearness - c_.nearness(*film_z - distance) : high;
  };
  const double film_z = film(root(excess, low, high)).value();
  return {solved, film_z, film_z - distance, distance};
}

FocusSolution Search::subject(double film_z) const {
  if (!infinite_film_) return {.status = no_rays};
  if (*infinite_film_ == film_z && c_.real(film_z)) return {solved, film_z, -infinity, infinity};
  if (!c_.real(*infinite_film_)) {
    if (!c_.real(film_z)) return farthest();
  } else if (!c_.real(film_z) || c_.nearness_of_film(film_z) < c_.nearness_of_film(*infinite_film_)) {
    return {unreachable, *infinite_film_, -infinity, infinity};
  }
  const auto nearness = nearness_for(film_nearness(film_z));
  if (!nearness) return too_near();
  const double subject_z = subject_at(*nearness);
  return {solved, film_z, subject_z, c_.distance(subject_z, film_z)};
}

}  // namespace petzval::inline v0::focus_detail
