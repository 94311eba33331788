// SPDX-License-Identifier: Apache-2.0
#include "film_polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "film_lines.hpp"

namespace petzval::inline v0::pupil_table_detail {

PupilsAt traced_pupils(const Lens& lens, const TwoPlanes& space, std::size_t wavelength) {
  return [&lens, space, wavelength](std::span<const double> heights) {
    std::vector<FilmPoint> points;
    for (const double height : heights) points.push_back({0, height});
    const std::vector<pupil_detail::PupilGuess> guesses = first_order_guesses(lens, space, points, wavelength);
    return pupil_detail::find_regions(guesses, pupil_detail::SearchOrder::rows(guesses.size(), guesses.size()),
                                      region_directions, true, traced_lines(lens, space, points, wavelength),
                                      [&](std::uint32_t i) { return places_seen(lens, space, points[i]); });
  };
}

double lit_radius(double film_radius, const PupilsAt& pupils_at) {
  // The index of the last of some heights at which a pupil, of any row, has light; their number where none has.
  const auto last_lit = [&](const std::vector<double>& heights) {
    const std::vector<PupilRegion> pupils = pupils_at(heights);
    std::size_t last = heights.size();
    for (std::size_t i = 0; i < pupils.size(); ++i) {
      const std::size_t at = i % heights.size();
      if (!pupils[i].empty() && (last == heights.size() || at > last)) last = at;
    }
    return last;
  };
  if (last_lit({film_radius}) == 0) return film_radius;
  double low = 0, high = film_radius;
  for (int round = 0; round < 4; ++round) {
    constexpr int parts = 16;
    std::vector<double> heights;
    for (int i = 0; i < parts; ++i) heights.push_back(low + (high - low) * i / parts);
    const std::size_t at = last_lit(heights);
    if (at == heights.size()) return film_radius;
    low = heights[at];
    if (at + 1 < heights.size()) high = heights[at + 1];
  }
  return high;
}

std::vector<PupilPolygon> film_polygons(double film_radius, PolygonFit fit, const PupilsAt& pupils_at) {
  // Heights by film_strips, and between them where interpolated polygons are to enclose pupils.
  const std::size_t parts = fit == PolygonFit::enclosing ? 2 : 1;
  std::vector<double> heights;
  for (std::size_t i = 0; i <= parts * film_strips; ++i) {
    heights.push_back(film_radius * static_cast<double>(i) / static_cast<double>(parts * film_strips));
  }
  const std::vector<PupilRegion> pupils = pupils_at(heights);
  const auto first_lit = [&](std::size_t height) -> const PupilRegion* {
    for (std::size_t i = height; i < pupils.size(); i += heights.size()) {
      if (!pupils[i].empty()) return &pupils[i];
    }
    return nullptr;
  };
  std::vector<PupilPolygon> polygons(film_strips + 1);
  for (std::size_t i = 0; i <= film_strips; ++i) {
    const std::size_t at = parts * i;
    if (const PupilRegion* lit = first_lit(at)) {
      polygons[i] = polygon_of(*lit, fit);
      continue;
    }
    // The light ends within a strip: an enclosing pupil continues to its end, one of equal area shrinks to a point.
    for (const std::size_t beside : {at - 1, at + 1, at - 2, at + 2}) {
      const PupilRegion* lit = beside < heights.size() ? first_lit(beside) : nullptr;
      if (!lit) continue;
      polygons[i] = polygon_of(*lit, fit);
      if (fit == PolygonFit::equal_area) polygons[i].corners = {};
      break;
    }
  }
  if (fit == PolygonFit::equal_area) return polygons;
  std::vector<InterpolationCheck> checks;
  const auto check = [&](const PupilRegion& pupil, double strip) {
    const auto i = static_cast<std::size_t>(strip);
    const double t = strip - static_cast<double>(i);
    checks.push_back({&pupil, {{i, std::min(i + 1, film_strips), 0, 0}, {1 - t, t, 0, 0}}});
  };
  for (std::size_t j = 0; j < pupils.size(); ++j) check(pupils[j], static_cast<double>(j % heights.size()) / 2);
  // Where the light ends pupils shrink fast.
  std::vector<PupilRegion> shrinking;
  if (pupils.back().empty()) {
    constexpr std::size_t steps = 16;
    std::vector<double> last;
    for (std::size_t i = 1; i < steps; ++i) {
      last.push_back(film_radius * (1 - static_cast<double>(i) / (steps * film_strips)));
    }
    shrinking = pupils_at(last);
    for (std::size_t i = 0; i < shrinking.size(); ++i) {
      check(shrinking[i], static_cast<double>(film_strips) - static_cast<double>(i % last.size() + 1) / steps);
    }
  }
  expand_to_cover(polygons, checks);
  return polygons;
}

std::vector<PupilPolygon> disc_polygons(std::span<const PupilDisc> discs, double film_radius) {
  std::vector<PupilPolygon> polygons;
  for (std::size_t i = 0; i <= film_strips; ++i) {
    const double height = film_radius * static_cast<double>(i) / film_strips;
    // All discs overlap where the one that ends first does.
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const PupilDisc& disc : discs) {
      low = std::max(low, disc.shift * height - disc.radius);
      high = std::min(high, disc.shift * height + disc.radius);
    }
    PupilRegion overlap{.directions = region_directions};
    if (low < high) {
      overlap.middle = {0, (low + high) / 2};
      // The nearest of the places where a line from the middle leaves a disc.
      const auto leaves = [&](double x, double y) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const PupilDisc& disc : discs) {
          const double from_centre = overlap.middle[1] - disc.shift * height, square = x * x + y * y;
          const double b = y * from_centre, c = disc.radius * disc.radius - from_centre * from_centre;
          nearest = std::min(nearest, (std::sqrt(b * b + square * c) - b) / square);
        }
        return nearest;
      };
      overlap.half_axes = {leaves(1, 0), (high - low) / 2};
      for (std::size_t k = 0; k < overlap.directions; ++k) {
        const Vec2<double> p = overlap.unit(k);
        const double radius = leaves(overlap.half_axes[0] * p.x, overlap.half_axes[1] * p.y);
        const auto rim = overlap.at(k, radius);
        overlap.spans.push_back({k, 0, radius, {overlap.middle[0], overlap.middle[1]}, {rim[0], rim[1]}});
      }
    }
    polygons.push_back(polygon_of(overlap, PolygonFit::equal_area));
  }
  return polygons;
}

}  // namespace petzval::inline v0::pupil_table_detail
