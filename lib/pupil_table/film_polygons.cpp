// SPDX-License-Identifier: Apache-2.0
#include "film_polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
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

std::vector<pupil_detail::PupilGuess> traced_guesses(const Lens& lens, const TwoPlanes& space,
                                                     std::span<const FilmPoint> points, std::size_t wavelength) {
  std::vector<pupil_detail::PupilGuess> guesses = first_order_guesses(lens, space, points, wavelength);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Aberrations move the image of a tiny stop by more than the size of the image, and first order does not describe
    // cylinders.
    constexpr double tiny_stop_ratio = 1e-3;
    pupil_detail::PupilGuess& guess = guesses[i];
    if (lens.rotationally_symmetric() && guess.radius > tiny_stop_ratio * (guess.high - guess.low)) continue;
    if (const auto chief = chief_position(lens, space, points[i], wavelength)) guess.x = chief->x, guess.y = chief->y;
  }
  return guesses;
}

PupilChart film_chart(const FilmPupils& pupils, const FilmGrid& grid, PolygonFit fit, std::size_t wavelength) {
  // Polygons of equal area are interpolated between nodes without a check.
  const std::size_t half_steps = fit == PolygonFit::enclosing ? 2 : 1;
  PupilChart chart{.nodes = {{0, grid.rows(), grid.columns}},
                   .points = {{pupils.layers - 1, half_steps * grid.rows(), half_steps * grid.columns}},
                   .quadrant = !pupils.of_revolution,
                   .directions = pupils.of_revolution ? 128u : 64u,
                   .probed = !pupils.of_revolution};
  const auto with_film = [&grid, wavelength](const auto& f) {
    return [&grid, &f, wavelength](PupilChart::Points points) {
      std::vector<FilmPupils::Point> film;
      for (const ChartPoint& point : points) film.push_back({grid.point(point), point[0]});
      return f(film, wavelength);
    };
  };
  chart.guesses = with_film(pupils.guesses);
  chart.clearances = with_film(pupils.clearances);
  if (pupils.connected) chart.connected = with_film(pupils.connected);
  return chart;
}

}  // namespace

FilmPolygons film_polygons(const FilmPupils& pupils, double film_radius, PolygonFit fit, int threads) {
  const LitPoints lit = [&](const std::vector<FilmPoint>& points) {
    std::vector<bool> result(points.size(), false);
    for (std::size_t i = 0; i < pupils.wavelengths * pupils.layers; ++i) {
      const std::size_t w = i / pupils.layers, last = pupils.layers - 1;
      std::vector<FilmPupils::Point> film;
      for (const FilmPoint& point : points) {
        film.push_back({point, last > 0 ? static_cast<double>(i % pupils.layers) / static_cast<double>(last) : 0.5});
      }
      const auto own = pupil_detail::lit_points(pupils.guesses(film, w), pupils.clearances(film, w));
      std::transform(own.begin(), own.end(), result.begin(), result.begin(), std::logical_or<>());
    }
    return result;
  };
  FilmPolygons result{
      pupils.of_revolution ? radial_grid(lit, film_radius, film_strips(fit)) : quadrant_grid(lit, film_radius), {}};
  result.by_wavelength.resize(pupils.wavelengths);
  parallel_for(pupils.wavelengths, 1, threads, [&](std::size_t w, std::size_t) {
    result.by_wavelength[w] = node_polygons(film_chart(pupils, result.grid, fit, w), fit);
  });
  return result;
}

FilmPolygons traced_polygons(const Lens& lens, const TwoPlanes& space, double film_radius, PolygonFit fit,
                             int threads) {
  const auto surfaces = lens.surfaces();
  const bool of_revolution = lens.rotationally_symmetric();
  const bool obscured = of_revolution && std::any_of(surfaces.begin(), surfaces.end(), [](const LensSurface& s) {
                          return s.obscuration_semi_diameter > 0;
                        });
  const Lens open = obscured ? without_obscurations(lens) : lens;
  const auto film_points = [](FilmPupils::Points points) {
    std::vector<FilmPoint> film;
    for (const auto& point : points) film.push_back(point.film);
    return film;
  };
  FilmPupils pupils{.of_revolution = of_revolution, .wavelengths = lens.wavelengths_nm().size()};
  pupils.guesses = [&](FilmPupils::Points points, std::size_t w) {
    return traced_guesses(open, space, film_points(points), w);
  };
  pupils.clearances = [&](FilmPupils::Points points, std::size_t w) {
    return traced_lines(open, space, film_points(points), w);
  };
  const auto connected = [&](FilmPupils::Points points, std::size_t w) {
    return pupil_detail::ConnectedPupils{
        [&, w, film = film_points(points)](std::uint32_t i) { return chief_position(open, space, film[i], w); },
        obscured ? traced_lines(lens, space, film_points(points), w) : pupil_detail::PositionClearances{}};
  };
  if (of_revolution) pupils.connected = connected;
  return film_polygons(pupils, film_radius, fit, threads);
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
