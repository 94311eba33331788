// SPDX-License-Identifier: Apache-2.0
#include "film_polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/meet_plane.hpp"
#include "film_lines.hpp"
#include "lens/without_obscurations.hpp"
#include "petzval/core/parallel.hpp"
#include "pupil/aim.hpp"

namespace petzval::pupil_table_detail {

namespace {

/// Intersection of the chief ray of a film point with the pupil plane.
std::optional<Vec2<double>> chief_position(const Lens& lens, const TwoPlanes& space, const FilmPoint& film,
                                           std::size_t wavelength) {
  const AimedRay chief = pupil_detail::aim(lens, PupilPlane::of_film(lens, film), {}, wavelength);
  if (!chief || !chief.end.transmitted()) return {};
  const auto position = core_detail::meet_plane(chief.ray, space.pupil_z);
  if (!std::isfinite(position.x) || !std::isfinite(position.y)) return {};
  return Vec2<double>{position.x, position.y};
}

}  // namespace

FilmPupils traced_pupils(const Lens& lens, const TwoPlanes& space, std::size_t wavelength) {
  const auto surfaces = lens.surfaces();
  const auto obscures = [](const LensSurface& s) { return s.obscuration_semi_diameter > 0; };
  const bool obscured = std::any_of(surfaces.begin(), surfaces.end(), obscures);
  const Lens open = obscured ? without_obscurations(lens) : lens;
  // Calls find(guesses, clearances, points) for the points at some heights.
  const auto search = [open, space, wavelength](std::span<const double> heights, const auto& find) {
    std::vector<FilmPoint> points;
    for (const double height : heights) points.push_back({0, height});
    std::vector<pupil_detail::PupilGuess> guesses = first_order_guesses(open, space, points, wavelength);
    for (std::size_t i = 0; i < points.size(); ++i) {
      // Aberrations move the image of a tiny stop by more than the size of the image.
      constexpr double tiny_stop_ratio = 1e-3;
      pupil_detail::PupilGuess& guess = guesses[i];
      if (guess.radius > tiny_stop_ratio * (guess.high - guess.low)) continue;
      if (const auto chief = chief_position(open, space, points[i], wavelength)) guess.y = chief->y;
    }
    return find(guesses, traced_lines(open, space, points, wavelength), points);
  };
  const auto regions = [&lens, open, obscured, space, wavelength](const auto& guesses, const auto& clearances,
                                                                  const std::vector<FilmPoint>& points) {
    const pupil_detail::ConnectedPupils connected{
        [&](std::uint32_t i) { return chief_position(open, space, points[i], wavelength); },
        obscured ? traced_lines(lens, space, points, wavelength) : pupil_detail::PositionClearances{}};
    const auto order = pupil_detail::SearchOrder::rows(guesses.size(), guesses.size());
    return pupil_detail::find_regions(guesses, order, region_directions, true, clearances, &connected);
  };
  return {[=](std::span<const double> heights) { return search(heights, regions); },
          [=](std::span<const double> heights) {
            return search(heights, [](const auto& guesses, const auto& clearances, const auto&) {
              return pupil_detail::lit_points(guesses, clearances);
            });
          }};
}

namespace {

/// Height up to which rays reach the film at a wavelength, at most film_radius; 0 if no rays reach the film.
double lit_radius(double film_radius, const FilmPupils& pupils) {
  const auto lit_at = [&](double height) { return bool{pupils.lit(std::array{height})[0]}; };
  if (lit_at(film_radius)) return film_radius;
  // Search from the edge inwards: for a lit ring, the outer edge counts.
  constexpr int intervals = 16;
  for (int i = intervals; --i >= 0;) {
    double low = film_radius * i / intervals, high = film_radius * (i + 1) / intervals;
    if (!lit_at(low)) continue;
    for (constexpr double relative_tolerance = 1e-4; high - low > relative_tolerance * high;) {
      const double middle = (low + high) / 2;
      (lit_at(middle) ? low : high) = middle;
    }
    return high;
  }
  return 0;
}

/// The polygons of one wavelength.
std::vector<PupilPolygon> polygons_of(double lit_radius, PolygonFit fit, const FilmPupils& film) {
  // Heights at the nodes and, if interpolated polygons must enclose pupils, halfway between.
  const std::size_t strips = film_strips(fit), steps_per_strip = fit == PolygonFit::enclosing ? 2 : 1;
  std::vector<double> heights;
  for (std::size_t i = 0; i <= steps_per_strip * strips; ++i) {
    heights.push_back(lit_radius * static_cast<double>(i) / static_cast<double>(steps_per_strip * strips));
  }
  const std::vector<PupilRegion> pupils = film.at(heights);
  const auto first_lit = [&](std::size_t height) -> const PupilRegion* {
    for (std::size_t i = height; i < pupils.size(); i += heights.size()) {
      if (!pupils[i].empty()) return &pupils[i];
    }
    return nullptr;
  };
  std::vector<PupilPolygon> polygons(strips + 1);
  std::vector<const PupilRegion*> shown(strips + 1);  // the pupils from which the polygons were made
  for (std::size_t i = 0; i <= strips; ++i) {
    const std::size_t at = steps_per_strip * i;
    shown[i] = first_lit(at);
    if (shown[i]) {
      polygons[i] = polygon_of(*shown[i], fit);
      continue;
    }
    // The pupil becomes empty between this node and a neighbour: an enclosing polygon continues to this node, a polygon
    // of equal area shrinks to a point.
    for (const std::size_t neighbour : {at - 1, at + 1, at - 2, at + 2}) {
      const PupilRegion* lit = neighbour < heights.size() ? first_lit(neighbour) : nullptr;
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
    checks.push_back({&pupil, {{i, std::min(i + 1, strips), 0, 0}, {1 - t, t, 0, 0}}});
  };
  for (std::size_t j = 0; j < pupils.size(); ++j) {
    const std::size_t at = j % heights.size();
    if (at % 2 == 1 || &pupils[j] != shown[at / 2]) check(pupils[j], static_cast<double>(at) / 2);
  }
  // Pupils shrink fast near the last height with light: check more heights.
  std::vector<PupilRegion> shrinking;
  if (pupils.back().empty()) {
    constexpr std::size_t steps = 16;
    std::vector<double> last;
    for (std::size_t i = 1; i < steps; ++i) {
      last.push_back(lit_radius * (1 - static_cast<double>(i) / (steps * strips)));
    }
    shrinking = film.at(last);
    for (std::size_t i = 0; i < shrinking.size(); ++i) {
      check(shrinking[i], static_cast<double>(strips) - static_cast<double>(i % last.size() + 1) / steps);
    }
  }
  expand_to_cover(polygons, checks);
  return polygons;
}

}  // namespace

FilmPolygons film_polygons(double film_radius, PolygonFit fit, std::span<const FilmPupils> pupils, int threads) {
  double lit = 0;
  for (std::size_t w = 0; w < pupils.size() && lit < film_radius; ++w) {
    lit = std::max(lit, lit_radius(film_radius, pupils[w]));
  }
  FilmPolygons result{lit > 0 ? lit : film_radius, std::vector<std::vector<PupilPolygon>>(pupils.size())};
  parallel_for(pupils.size(), 1, threads, [&](std::size_t w, std::size_t) {
    result.by_wavelength[w] = polygons_of(result.lit_radius, fit, pupils[w]);
  });
  return result;
}

std::vector<PupilPolygon> disc_polygons(std::span<const PupilDisc> discs, double film_radius) {
  constexpr std::size_t strips = film_strips(PolygonFit::equal_area);
  std::vector<PupilPolygon> polygons;
  for (std::size_t i = 0; i <= strips; ++i) {
    const double height = film_radius * static_cast<double>(i) / strips;
    // The overlap ends where the first of the discs ends.
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const PupilDisc& disc : discs) {
      low = std::max(low, disc.shift * height - disc.radius);
      high = std::min(high, disc.shift * height + disc.radius);
    }
    PupilPolygon& overlap = polygons.emplace_back();
    if (!(low < high)) continue;
    const Vec2<double> middle{0, (low + high) / 2};
    // Fraction of d at which a line outwards from the middle leaves the first disc.
    overlap = polygon_within(middle, (high - low) / 2, [&](const Vec2<double>& d) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const PupilDisc& disc : discs) {
        const double from_centre = middle.y - disc.shift * height, square = d.x * d.x + d.y * d.y;
        const double b = d.y * from_centre, c = disc.radius * disc.radius - from_centre * from_centre;
        nearest = std::min(nearest, (std::sqrt(b * b + square * c) - b) / square);
      }
      return nearest;
    });
  }
  return polygons;
}

}  // namespace petzval::pupil_table_detail
