// SPDX-License-Identifier: Apache-2.0
#include "film_polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/meet_plane.hpp"
#include "lens/without_obscurations.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "pupil/aim.hpp"
#include "pupil/surface_box.hpp"
#include "trace/clearances.hpp"

namespace petzval::pupil_table_detail {
namespace {

using pupil_detail::PositionClearances;
using pupil_detail::PupilGuess;

/// Clearances of rays from film points through positions in the pupil plane. The lens must outlive the result.
PositionClearances traced_lines(const Lens& lens, const TwoPlanes& space, FilmPupils::Points points,
                                std::size_t wavelength) {
  const double towards = towards_scene(lens, space);
  return [&lens, space, towards, wavelength, own = std::vector(points.begin(), points.end()),
          memory = std::array<std::vector<double>, 6>{}](std::size_t count, const std::uint32_t* which, const double* x,
                                                         const double* y, double* clearances) mutable {
    // Blocks fit into the cache.
    constexpr std::size_t block = 1024;
    for (auto& a : memory) a.resize(std::min(count, block));
    const auto at = [&](std::size_t k) { return memory[k].data(); };
    const double depth = space.depth();
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t size = std::min(block, count - begin);
      for (std::size_t i = 0; i < size; ++i) {
        const FilmPoint& film = own[which[begin + i]].film;
        const double px = x[begin + i], py = y[begin + i], dx = px - film.x, dy = py - film.y;
        const double per_length = towards / std::sqrt(dx * dx + dy * dy + depth * depth);
        memory[0][i] = px, memory[1][i] = py, memory[2][i] = space.pupil_z;
        memory[3][i] = dx * per_length, memory[4][i] = dy * per_length, memory[5][i] = depth * per_length;
      }
      trace_detail::clearances<double>(lens, size, {at(0), at(1), at(2), at(3), at(4), at(5)}, clearances + begin,
                                       {.travel = Travel::to_scene, .wavelengths = {wavelength}});
    }
  };
}

/// Intersection of the chief ray of a film point with the pupil plane.
std::optional<Vec2<double>> chief_position(const Lens& lens, const TwoPlanes& space, const FilmPoint& film,
                                           std::size_t wavelength) {
  const AimedRay chief = pupil_detail::aim(lens, PupilPlane::of_film(lens, film), {}, wavelength);
  if (!chief || !chief.end.transmitted()) return {};
  const auto position = core_detail::meet_plane(chief.ray, space.pupil_z);
  if (!std::isfinite(position.x) || !std::isfinite(position.y)) return {};
  return Vec2<double>{position.x, position.y};
}

/// Predictions of the pupils of film points. The last surface, which all rays pass, limits the size of a pupil.
std::vector<PupilGuess> traced_guesses(const Lens& lens, const TwoPlanes& space, FilmPupils::Points points,
                                       std::size_t wavelength) {
  const Pupils paraxial = petzval::pupils(lens, wavelength);
  const std::size_t last = lens.surface_count() - 1;
  const double last_z = lens.surfaces()[last].vertex_z;
  const pupil_detail::SurfaceBox box = pupil_detail::surface_box(lens, last, paraxial.entrance);
  const auto seen = [&](double film, double at, double z) {  // projects to the pupil plane
    return film + (at - film) * space.depth() / (z - space.film_z);
  };
  double radius = std::isfinite(paraxial.exit.z) && paraxial.exit.z != space.film_z
                      ? std::abs(seen(0, paraxial.exit.diameter / 2, paraxial.exit.z))
                      : 0;
  const bool somewhere = radius > 0;
  if (!somewhere) radius = std::abs(seen(0, box.half, last_z)) / 8;
  const bool ring = has_obscurations(lens);
  std::vector<PupilGuess> result;
  for (const auto& [p, layer] : points) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double z : {box.z_min, box.z_max, last_z}) {
      // A face at the film would be seen at any angle; a face beyond the film counts as close to the film.
      const double least = 0.02 * std::abs(space.film_z - last_z);
      const double from_film = z - space.film_z;
      const double at = space.film_z + std::copysign(std::max(std::abs(from_film), least), last_z - space.film_z);
      for (const double edge : {-box.half, box.half}) {
        low = std::min(low, seen(p.y, edge, at));
        high = std::max(high, seen(p.y, edge, at));
      }
    }
    const double across = lens.rotationally_symmetric() ? 0 : seen(p.x, 0, last_z), margin = 0.05 * (high - low);
    const double y = seen(p.y, 0, somewhere ? paraxial.exit.z : last_z);
    constexpr double radii = 16;
    result.push_back({across, low - margin, high + margin, radius, y, radii * radius, ring});
    PupilGuess& guess = result.back();
    // Aberrations move the image of a tiny stop by more than the size of the image, and first order does not describe
    // cylinders.
    constexpr double tiny_stop_ratio = 1e-3;
    if (lens.rotationally_symmetric() && radius > tiny_stop_ratio * (guess.high - guess.low)) continue;
    if (const auto chief = chief_position(lens, space, p, wavelength)) guess.x = chief->x, guess.y = chief->y;
  }
  return result;
}

/// True for each point with light at a wavelength.
std::vector<bool> lit_points(const FilmPupils& pupils, FilmPupils::Points points, std::size_t wavelength) {
  const auto guesses = pupils.guesses(points, wavelength);
  const auto clearances = pupils.clearances(points, wavelength);
  if (pupils.of_revolution) return pupil_detail::lit_points(guesses, clearances);
  return lit_in_plane(guesses, clearances);
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

/// Distance from the middle of the polygon to its edge in a direction; 0 if no sector faces the direction.
double reach(const PupilPolygon& polygon, const Vec2<double>& d) {
  const auto sectors = [&](std::size_t k) { return polygon.sector(k); };
  // On the line to a corner, rounding may exclude the direction from both adjacent sectors.
  for (const double aside : {0.0, 1e-9}) {
    const Point<double> q{d.x + aside * d.y, d.y - aside * d.x};
    const std::size_t found = sector_facing(q, sectors);
    if (found != polygon_corners) return 1 / polygon.sector(found).relative_radius(q);
  }
  return 0;
}

/// Fraction of d at which the line along d, from a point at a height above the centre of a disc, leaves the disc.
double leaves_disc(double height, double radius, const Vec2<double>& d) {
  const double square = d.x * d.x + d.y * d.y, along = d.y * height;
  return (std::sqrt(along * along + square * (radius * radius - height * height)) - along) / square;
}

/// The overlap of some discs for a film point on +y.
PupilPolygon overlap_of(std::span<const PupilDisc> discs, double height) {
  // The overlap ends where the first of the discs ends.
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const PupilDisc& disc : discs) {
    low = std::max(low, disc.shift * height - disc.radius);
    high = std::min(high, disc.shift * height + disc.radius);
  }
  if (!(low < high)) return {};
  const Vec2<double> middle{0, (low + high) / 2};
  // Fraction of d at which a line outwards from the middle leaves the first disc.
  return polygon_within(middle, (high - low) / 2, [&](const Vec2<double>& d) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const PupilDisc& disc : discs) {
      nearest = std::min(nearest, leaves_disc(middle.y - disc.shift * height, disc.radius, d));
    }
    return nearest;
  });
}

/// Tests which film points rays reach at any wavelength.
using LitPoints = std::function<std::vector<bool>(const std::vector<FilmPoint>& points)>;

constexpr std::size_t grid_steps = 8;  // steps between the nodes of an axis

/// Lengths of lines up to the last film point that rays reach, at most `lengths`; 0 for a dark line.
/// @param point function; point(line, length) is the film point at the end of a line of this length
template <class PointAt>
std::vector<double> lit_lengths(const LitPoints& lit, const std::vector<double>& lengths, const PointAt& point) {
  // Marks of one line: dark ends, then steps from the end inwards. For a lit ring, the outer edge counts.
  constexpr int steps = 16;
  std::vector<double> low(lengths.size(), 0), high = lengths;
  std::vector<std::size_t> open;
  const auto test = [&](const auto& length) {
    std::vector<FilmPoint> points;
    for (const std::size_t line : open) points.push_back(point(line, length(line)));
    return lit(points);
  };
  for (std::size_t line = 0; line < lengths.size(); ++line) open.push_back(line);
  std::vector<std::size_t> dark;
  const auto bright_ends = test([&](std::size_t line) { return high[line]; });
  for (const std::size_t line : open) {
    if (!bright_ends[line]) dark.push_back(line);
  }
  std::vector<std::size_t> edges;
  for (int i = steps - 1; i >= 0; --i) {
    open = dark;
    dark.clear();
    if (open.empty()) break;
    const auto length = [&](std::size_t line) { return lengths[line] * i / steps; };
    const auto bright = test(length);
    for (std::size_t j = 0; j < open.size(); ++j) {
      (bright[j] ? low : high)[open[j]] = length(open[j]);
      (bright[j] ? edges : dark).push_back(open[j]);
    }
  }
  for (open = edges; !open.empty();) {
    const auto middle = [&](std::size_t line) { return (low[line] + high[line]) / 2; };
    const auto bright = test(middle);
    for (std::size_t j = 0; j < open.size(); ++j) (bright[j] ? low : high)[open[j]] = middle(open[j]);
    constexpr double relative_tolerance = 1e-4;
    std::erase_if(open, [&](std::size_t line) { return high[line] - low[line] <= relative_tolerance * high[line]; });
  }
  return high;
}

/// Grid from the axis to the last lit point.
FilmGrid lit_radial_grid(const LitPoints& lit, double film_radius, std::size_t strips) {
  const auto on_y = [](std::size_t, double y) { return FilmPoint{0, y}; };
  const double reach = lit_lengths(lit, {film_radius}, on_y)[0];
  return radial_grid(reach > 0 ? reach : film_radius, strips);
}

/// Grid over the lit part of a quadrant.
FilmGrid quadrant_grid(const LitPoints& lit, double film_radius) {
  FilmGrid grid = lit_radial_grid(lit, film_radius, grid_steps);
  grid.columns = grid_steps;
  // Half widths of the lit area, at half steps of the rows.
  constexpr std::size_t half_steps = 2 * grid_steps;
  const auto y_of = [&](std::size_t i) { return grid.height * static_cast<double>(i) / half_steps; };
  std::vector<double> widths;
  for (std::size_t i = 0; i <= half_steps; ++i) {
    widths.push_back(std::sqrt(std::max(film_radius * film_radius - y_of(i) * y_of(i), 0.0)));
  }
  widths = lit_lengths(lit, widths, [&](std::size_t i, double x) { return FilmPoint{x, y_of(i)}; });
  // Straight lines between the rows enclose the area, which is convex.
  for (std::size_t i = 0; i <= grid_steps; ++i) grid.half_widths[i] = widths[2 * i];
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < grid.rows(); ++i) {
      double &before = grid.half_widths[i], &after = grid.half_widths[i + 1];
      // A chord over half of an arc has a quarter of the sagitta of the whole arc.
      const double chord = (before + after) / 2, overshoot = 1.35 * std::max(widths[2 * i + 1] - chord, 0.0);
      before += overshoot, after += overshoot;
    }
  }
  return grid;
}

}  // namespace

FilmPoint FilmGrid::point(const ChartPoint& at) const noexcept {
  const double row = at[1] * static_cast<double>(rows());
  const auto i = std::min(static_cast<std::size_t>(row), rows() - 1);
  const double s = row - static_cast<double>(i);
  return {((1 - s) * half_widths[i] + s * half_widths[i + 1]) * at[2], height * at[1]};
}

FilmPolygons film_polygons(const FilmPupils& pupils, double film_radius, PolygonFit fit, int threads) {
  const LitPoints lit = [&](const std::vector<FilmPoint>& points) {
    std::vector<bool> result(points.size(), false);
    for (std::size_t i = 0; i < pupils.wavelengths * pupils.layers; ++i) {
      const std::size_t w = i / pupils.layers, last = pupils.layers - 1;
      std::vector<FilmPupils::Point> film;
      for (const FilmPoint& point : points) {
        film.push_back({point, last > 0 ? static_cast<double>(i % pupils.layers) / static_cast<double>(last) : 0.5});
      }
      const std::vector<bool> own = lit_points(pupils, film, w);
      std::transform(own.begin(), own.end(), result.begin(), result.begin(), std::logical_or<>());
    }
    return result;
  };
  FilmPolygons result{
      pupils.of_revolution ? lit_radial_grid(lit, film_radius, film_strips(fit)) : quadrant_grid(lit, film_radius), {}};
  result.by_wavelength.resize(pupils.wavelengths);
  parallel_for(pupils.wavelengths, 1, threads, [&](std::size_t w, std::size_t) {
    result.by_wavelength[w] = node_polygons(film_chart(pupils, result.grid, fit, w), fit);
  });
  return result;
}

FilmPolygons traced_polygons(const Lens& lens, const TwoPlanes& space, double film_radius, PolygonFit fit,
                             int threads) {
  const bool of_revolution = lens.rotationally_symmetric();
  const bool obscured = of_revolution && has_obscurations(lens);
  const Lens open = obscured ? without_obscurations(lens) : lens;
  FilmPupils pupils{.of_revolution = of_revolution, .wavelengths = lens.wavelengths_nm().size()};
  pupils.guesses = [&](FilmPupils::Points points, std::size_t w) { return traced_guesses(open, space, points, w); };
  pupils.clearances = [&](FilmPupils::Points points, std::size_t w) { return traced_lines(open, space, points, w); };
  const auto connected = [&](FilmPupils::Points points, std::size_t w) {
    return pupil_detail::ConnectedPupils{[&, w, own = std::vector(points.begin(), points.end())](std::uint32_t i) {
                                           return chief_position(open, space, own[i].film, w);
                                         },
                                         obscured ? traced_lines(lens, space, points, w) : PositionClearances{}};
  };
  if (of_revolution) pupils.connected = connected;
  return film_polygons(pupils, film_radius, fit, threads);
}

FilmPolygons disc_polygons(std::span<const std::vector<PupilDisc>> discs, double film_radius) {
  FilmPolygons result{radial_grid(film_radius, film_strips(PolygonFit::equal_area)), {}};
  for (const std::vector<PupilDisc>& own : discs) {
    std::vector<PupilPolygon>& polygons = result.by_wavelength.emplace_back();
    for (std::size_t i = 0; i <= result.grid.rows(); ++i) {
      polygons.push_back(overlap_of(own, result.grid.node(i).y));
    }
  }
  return result;
}

PupilPolygon clipped_by_disc(const PupilPolygon& polygon, double centre, double radius) {
  constexpr Vec2<double> towards{0, 1};
  // Common interval of polygon and disc along y through the middle.
  const double from_middle = centre - polygon.middle.y;
  const double low = std::max(-reach(polygon, -towards), from_middle - radius);
  const double high = std::min(reach(polygon, towards), from_middle + radius);
  const double step = low < high ? (low + high) / 2 : from_middle;
  PupilPolygon about_middle = polygon;
  about_middle.middle = {0, polygon.middle.y + step};
  for (auto& corner : about_middle.corners) corner -= step * towards;
  if (!(low < high)) return {.middle = about_middle.middle};
  return polygon_within(about_middle.middle, (high - low) / 2, [&](const Vec2<double>& d) {
    return std::min(reach(about_middle, d), leaves_disc(step - from_middle, radius, d));
  });
}

}  // namespace petzval::pupil_table_detail
