// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "conjugates.hpp"
#include "least_blur.hpp"
#include "petzval/core/bisect.hpp"

namespace petzval::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Status = FocusSolution::Status;

/// The search of solve_min_rms: a subject is described by p, its distance from the paraxial front focal point.
class Search {
 public:
  Search(const Lens& lens, const Conjugates& start, std::size_t wavelength)
      : start_(start), least_blur_(lens, wavelength) {}

  FocusSolution from_vertex(double distance) const {
    const auto film = least_blur_(-distance);
    if (!film) return {.status = Status::no_rays};
    if (real(*film)) return {Status::solved, *film, -distance, 0};

    // Outwards, then inwards, to a distance that can be focused, and back to the last that can.
    const auto reachable = [&](double d) { return film_for(-d).has_value(); };
    const double asked = std::min(distance, 0x1p40 * std::sqrt(std::abs(start_.product)));
    for (const double factor : {2.0, 0.5}) {
      double without = asked;
      for (int i = 0; i < 60; ++i) {
        const double with = without * factor;
        if (reachable(with)) {
          const double limit = last_with(with, without, reachable);
          return {Status::unreachable, film_for(-limit).value(), -limit, limit};
        }
        without = with;
      }
    }
    return {Status::unreachable, start_.sense * infinity, -infinity, infinity};
  }

  FocusSolution from_film(double distance) const {
    if (std::isinf(distance)) return from_vertex(distance);
    if (!least_blur_(-infinity)) return {.status = Status::no_rays};

    const double low = lower_end(distance);
    const double separation_at_low = separation(low);
    if (std::isinf(separation_at_low)) return {Status::unreachable, start_.sense * infinity, -infinity, infinity};
    if (separation_at_low > distance) return limit(low);

    double high = 2 * low;
    while (separation(high) < distance) high *= 2;
    if (std::isinf(separation(high))) {
      // A lens that focuses distant subjects inside itself.
      high = last_with(low, high, [&](double p) { return std::isfinite(separation(p)); });
      if (separation(high) < distance) return limit(high);
    }
    const double p = last_with(low, high, [&](double q) { return separation(q) <= distance; });
    const double film_z = film_for(start_.subject_z(p)).value();
    return {Status::solved, film_z, film_z - distance, 0};
  }

 private:
  bool real(double film_z) const { return std::isfinite(film_z) && (film_z - start_.last_z) * start_.sense > 0; }

  std::optional<double> film_for(double subject_z) const {
    const auto film = subject_z < 0 ? least_blur_(subject_z) : std::nullopt;
    return film && real(*film) ? film : std::nullopt;
  }

  /// From film to subject; infinite where there is no real image.
  double separation(double p) const {
    const double subject_z = start_.subject_z(p);
    const auto film = film_for(subject_z);
    return film ? *film - subject_z : infinity;
  }

  FocusSolution limit(double p) const {
    const double subject_z = start_.subject_z(p), film_z = film_for(subject_z).value();
    return {Status::unreachable, film_z, subject_z, film_z - subject_z};
  }

  /// A p from which on the separation grows, and at which it is below the one wanted if there is any such p.
  double lower_end(double distance) const {
    if (start_.product < 0) {
      // After one mirror the separation falls without end towards the focal point.
      double p = std::sqrt(-start_.product);
      for (int i = 0; i < 60 && separation(p) > distance; ++i) p /= 2;
      return p;
    }
    const double turning = nearest_p(start_, DistanceOrigin::film);
    if (separation(turning) <= distance) return turning;
    // Golden section: the turning point of the exact rays lies near the paraxial one.
    constexpr double golden = 0.6180339887498949;
    double from = turning / 4, to = 4 * turning;
    double a = to - golden * (to - from), b = from + golden * (to - from);
    double at_a = separation(a), at_b = separation(b);
    while (to - from > 1e-9 * turning) {
      if (at_a <= at_b && std::isfinite(at_a)) {
        to = b, b = a, at_b = at_a;
        a = to - golden * (to - from), at_a = separation(a);
      } else {
        from = a, a = b, at_a = at_b;
        b = from + golden * (to - from), at_b = separation(b);
      }
    }
    return at_a <= at_b ? a : b;
  }

  const Conjugates& start_;
  LeastBlur least_blur_;
};

}  // namespace

FocusSolution solve_min_rms(const Lens& lens, const Conjugates& start, double distance, DistanceOrigin origin,
                            std::size_t wavelength) {
  const Search search(lens, start, wavelength);
  return origin == DistanceOrigin::film ? search.from_film(distance) : search.from_vertex(distance);
}

}  // namespace petzval::detail
