// SPDX-License-Identifier: Apache-2.0
#include "film_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>

#include "core/meet_plane.hpp"
#include "film_lines.hpp"
#include "grid_pupils.hpp"
#include "pupil/aim.hpp"
#include "pupil/boundary_search.hpp"
#include "virtual_film_point.hpp"

namespace petzval::pupil_table_detail {
namespace {

using pupil_detail::PupilGuess;

constexpr std::size_t grid_steps = 8;  // steps between the nodes of an axis
constexpr std::size_t probes = 16384;
constexpr std::size_t grid_directions = 64;  // directions of the regions from which polygons are made

/// Predictions from rays aimed at the centre and the rim of the stop. Aiming is slow: in each row, only about as many
/// points are aimed as are searched in full, and predictions between them are interpolated.
std::vector<PupilGuess> aimed_guesses(const Lens& lens, const TwoPlanes& space, std::span<const FilmPoint> points,
                                      std::size_t row, std::size_t wavelength) {
  std::vector<PupilGuess> guesses = first_order_guesses(lens, space, points, wavelength);
  struct Aimed {
    double x, y, radius;
  };
  const auto aimed_at = [&](const FilmPoint& film) -> std::optional<Aimed> {
    const PupilPlane plane = PupilPlane::of_film(lens, film);
    const auto position = [&](const Vec2<double>& target) -> std::optional<Vec2<double>> {
      const AimedRay aimed = pupil_detail::aim(lens, plane, target, wavelength);
      if (!aimed) return {};
      const Vec3<double> p = core_detail::meet_plane(aimed.ray, space.pupil_z);
      return std::isfinite(p.x + p.y) ? std::optional(Vec2<double>{p.x, p.y}) : std::nullopt;
    };
    const auto centre = position({});
    if (!centre) return {};
    double radius = 0;
    for (const Vec2<double> rim : {Vec2<double>{1, 0}, Vec2<double>{0, 1}}) {
      if (const auto p = position(rim)) radius = std::max(radius, std::hypot(p->x - centre->x, p->y - centre->y));
    }
    return Aimed{centre->x, centre->y, radius};
  };
  constexpr std::size_t row_step = 16;
  for (std::size_t begin = 0; begin < points.size(); begin += row) {
    std::optional<Aimed> before;
    std::size_t at_before = 0;
    for (std::size_t i = 0; i < row; ++i) {
      if (i % row_step != 0 && i + 1 != row) continue;
      const auto now = aimed_at(points[begin + i]);
      const std::size_t steps = std::max<std::size_t>(i - at_before, 1);
      for (std::size_t j = i == 0 ? 0 : at_before + 1; now && j <= i; ++j) {
        const double t = before ? static_cast<double>(j - at_before) / static_cast<double>(steps) : 1;
        const Aimed& from = before ? *before : *now;
        PupilGuess& g = guesses[begin + j];
        g.x = from.x + t * (now->x - from.x);
        g.y = from.y + t * (now->y - from.y);
        if (!(now->radius > 0)) continue;
        g.radius = now->radius;
        g.near = 4 * now->radius;
      }
      before = now;
      at_before = i;
    }
  }
  return guesses;
}

/// Pupils of film points in rows.
std::vector<PupilRegion> film_pupils(const Lens& lens, const TwoPlanes& space, const std::vector<FilmPoint>& points,
                                     std::size_t row, std::size_t directions, std::size_t wavelength) {
  const auto guesses = aimed_guesses(lens, space, points, row, wavelength);
  return grid_pupils({guesses, row}, directions, traced_lines(lens, space, points, wavelength));
}

/// True for each film point that rays reach at any wavelength.
std::vector<bool> lit_points(const Lens& lens, const TwoPlanes& space, const std::vector<FilmPoint>& points) {
  std::vector<bool> lit(points.size(), false);
  constexpr std::size_t coarse_directions = 4;
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    const auto pupils = film_pupils(lens, space, points, 1, coarse_directions, w);
    for (std::size_t i = 0; i < points.size(); ++i) lit[i] = lit[i] || !pupils[i].empty();
  }
  return lit;
}

/// Lengths of the lines from (0, y) towards +x, or from (x, 0) towards +y, up to the last film point that rays reach;
/// exact to 2^-8 of the line.
std::vector<double> lit_lengths(const Lens& lens, const TwoPlanes& space, const std::vector<double>& heights,
                                const std::vector<double>& lengths, bool along_x) {
  const auto point = [&](std::size_t line, double along) {
    return along_x ? FilmPoint{along, heights[line]} : FilmPoint{heights[line], along};
  };
  std::vector<FilmPoint> ends;
  for (std::size_t i = 0; i < heights.size(); ++i) ends.push_back(point(i, lengths[i]));
  const std::vector<bool> lit = lit_points(lens, space, ends);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (!lit[i]) open.push_back(i);
  }
  std::vector<double> result = lengths, low(heights.size(), 0);
  for (int round = 0; round < 8 && !open.empty(); ++round) {
    std::vector<FilmPoint> middles;
    for (const std::size_t i : open) middles.push_back(point(i, (low[i] + result[i]) / 2));
    const std::vector<bool> bright = lit_points(lens, space, middles);
    for (std::size_t j = 0; j < open.size(); ++j) {
      const std::size_t i = open[j];
      (bright[j] ? low[i] : result[i]) = (low[i] + result[i]) / 2;
    }
  }
  return result;
}

constexpr std::size_t half_steps = 2 * grid_steps;

/// Half the chord lengths of a disc, at half steps of the rows up to a height.
std::vector<double> half_chords(double radius, double height) {
  std::vector<double> widths;
  for (std::size_t i = 0; i <= half_steps; ++i) {
    const double y = height * static_cast<double>(i) / half_steps;
    widths.push_back(std::sqrt(std::max(radius * radius - y * y, 0.0)));
  }
  return widths;
}

/// The grid whose rows, connected by straight lines, enclose a convex area.
/// @param widths half widths of the area, at half steps of the rows
FilmGrid grid_within(double height, const std::vector<double>& widths) {
  FilmGrid grid;
  grid.columns = grid_steps;
  grid.height = height;
  for (std::size_t i = 0; i <= half_steps; i += 2) grid.half_widths.push_back(widths[i]);
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

/// The nodes of a grid and the points halfway between, in rows of 2 columns + 1.
std::vector<FilmPoint> points_of(const FilmGrid& grid) {
  const std::size_t columns = 2 * grid.columns + 1, rows = 2 * grid.rows() + 1;
  std::vector<FilmPoint> points;
  for (std::size_t i = 0; i < rows; ++i) {
    const double width = (grid.half_widths[i / 2] + grid.half_widths[(i + 1) / 2]) / 2;
    for (std::size_t j = 0; j < columns; ++j) {
      points.push_back({width * static_cast<double>(j) / static_cast<double>(columns - 1),
                        grid.height * static_cast<double>(i) / static_cast<double>(rows - 1)});
    }
  }
  return points;
}

/// Weights of the nodes at a point of points_of().
PolygonWeights weights_of_point(const FilmGrid& grid, std::size_t point) noexcept {
  const std::size_t i = point / (2 * grid.columns + 1), j = point % (2 * grid.columns + 1), right = j % 2;
  const std::size_t low = i / 2 * (grid.columns + 1) + j / 2, up = (i + 1) / 2 * (grid.columns + 1) + j / 2;
  return {{low, low + right, up, up + right}, {0.25, 0.25, 0.25, 0.25}};
}

/// A probe in a grid, as fractions of the height and of the row width.
struct ProbedPoint {
  FilmPoint film;
  PolygonWeights weights;

  ProbedPoint(const FilmGrid& grid, double down, double across) noexcept {
    const double row = down * static_cast<double>(grid.rows()), column = across * static_cast<double>(grid.columns);
    const auto i = std::min(static_cast<std::size_t>(row), grid.rows() - 1);
    const auto j = std::min(static_cast<std::size_t>(column), grid.columns - 1);
    const double s = row - static_cast<double>(i), t = column - static_cast<double>(j);
    film = {((1 - s) * grid.half_widths[i] + s * grid.half_widths[i + 1]) * across, grid.height * down};
    const std::size_t node = i * (grid.columns + 1) + j, above = node + grid.columns + 1;
    weights = {{node, node + 1, above, above + 1}, {(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t}};
  }
};

void mirror_at_axes(std::span<PupilPolygon> polygons, const FilmGrid& grid) noexcept {
  for (std::size_t j = 0; j <= grid.columns; ++j) mirror(polygons[j], false);
  for (std::size_t i = 0; i <= grid.rows(); ++i) mirror(polygons[i * (grid.columns + 1)], true);
}

/// Expands polygons to traced rays at probes in all parts of a grid.
void expand_to_traced_probes(std::span<PupilPolygon> polygons, const Lens& lens, const TwoPlanes& space,
                             const FilmGrid& grid, std::size_t wavelength) {
  const auto weights = [&](const std::array<double, 4>& at) { return ProbedPoint(grid, at[0], at[1]).weights; };
  const auto at_probes = [&](std::span<const std::array<double, 4>> positions, std::span<const std::uint32_t> which,
                             const double* x, const double* y, double* clearances) {
    std::vector<FilmPoint> points;
    std::vector<std::uint32_t> index(which.size());
    std::iota(index.begin(), index.end(), 0u);
    for (const std::uint32_t p : which) points.push_back(ProbedPoint(grid, positions[p][0], positions[p][1]).film);
    traced_lines(lens, space, std::move(points), wavelength)(which.size(), index.data(), x, y, clearances);
  };
  expand_to_probes(polygons, probes, weights, at_probes);
}

/// Range of `excess` (FilmTilt) over the film points that belong to a virtual film point or its mirror images.
struct ExcessRange {
  double low, high;

  ExcessRange(const FilmTilt& tilt, const FilmPoint& film) noexcept {
    const double along = std::abs(tilt.slope_x) * film.x + std::abs(tilt.slope_y) * film.y;
    const auto at_end = [&](double value) { return (value - tilt.travel) / (1 + tilt.travel); };
    low = std::clamp(std::min(-along, at_end(-along)), tilt.min_excess, tilt.max_excess);
    high = std::clamp(std::max(along, at_end(along)), tilt.min_excess, tilt.max_excess);
  }
  double at(double fraction) const noexcept { return low + fraction * (high - low); }
};

}  // namespace

FilmGrid disc_grid(double film_radius) { return grid_within(film_radius, half_chords(film_radius, film_radius)); }

FilmGrid film_grid(const Lens& lens, const TwoPlanes& space, double film_radius) {
  const double height = lit_lengths(lens, space, {0}, {film_radius}, false)[0];
  std::vector<double> heights;
  for (std::size_t i = 0; i <= half_steps; ++i) heights.push_back(height * static_cast<double>(i) / half_steps);
  return grid_within(height, lit_lengths(lens, space, heights, half_chords(film_radius, height), true));
}

std::vector<PupilPolygon> grid_polygons(const Lens& lens, const TwoPlanes& space, const FilmGrid& grid, PolygonFit fit,
                                        std::size_t wavelength) {
  const std::size_t columns = 2 * grid.columns + 1;
  const std::vector<FilmPoint> points = points_of(grid);
  const std::vector<PupilRegion> pupils = film_pupils(lens, space, points, columns, grid_directions, wavelength);
  std::vector<PupilPolygon> polygons = node_polygons(pupils, columns, fit);
  mirror_at_axes(polygons, grid);
  if (fit == PolygonFit::equal_area) return polygons;
  std::vector<InterpolationCheck> checks;
  for (std::size_t p = 0; p < pupils.size(); ++p) checks.push_back({&pupils[p], weights_of_point(grid, p)});
  expand_to_cover(polygons, checks);
  expand_to_traced_probes(polygons, lens, space, grid, wavelength);
  mirror_at_axes(polygons, grid);
  return polygons;
}

std::vector<PupilPolygon> tilted_grid_polygons(const FilmPupilTable& upright, const FilmTilt& tilt,
                                               const FilmGrid& grid, std::size_t wavelength) {
  // Pupils for several values of `excess` at each point. The middle value is the first, because its pupil is the least
  // likely to be empty.
  const std::size_t columns = 2 * grid.columns + 1;
  const std::vector<FilmPoint> points = points_of(grid);
  constexpr std::array fractions{0.5, 0.0, 0.25, 0.75, 1.0};
  std::vector<std::vector<PupilRegion>> pupils;
  for (const double fraction : fractions) {
    std::vector<VirtualFilmPoint> seen;
    std::vector<PupilGuess> guesses;
    for (const FilmPoint& point : points) {
      seen.push_back({point, ExcessRange(tilt, point).at(fraction)});
      // Start from the pupil of the upright film; if it is empty, move the film point towards the axis.
      Vec2<double> position{0, 0};
      double area = 0;
      for (int round = 0; round < 4; ++round) {
        FilmPoint at = seen.back().on_upright(position.x, position.y);
        for (int step = 0; step < 32 && !(area = upright.area(at, wavelength)); ++step) at = {0.95 * at.x, 0.95 * at.y};
        position = upright.middle(at, wavelength);
      }
      const double radius = std::sqrt(area / std::numbers::pi), near = 3 * radius, far = 12 * radius;
      guesses.push_back({position.x, position.y - far, position.y + far, radius, position.y, near});
    }
    pupils.push_back(grid_pupils(
        {guesses, columns}, grid_directions,
        [&](std::size_t count, const std::uint32_t* which, const double* x, const double* y, double* clearances) {
          const auto from = [&](std::size_t i) { return seen[which[i]]; };
          upright_clearances(upright, wavelength, count, from, x, y, clearances);
        }));
  }
  std::vector<PupilPolygon> polygons = node_polygons(pupils.front(), columns, PolygonFit::enclosing);
  std::vector<InterpolationCheck> checks;
  for (const auto& own : pupils) {
    for (std::size_t p = 0; p < own.size(); ++p) checks.push_back({&own[p], weights_of_point(grid, p)});
  }
  mirror_at_axes(polygons, grid);
  expand_to_cover(polygons, checks);
  expand_to_probes(
      polygons, probes, [&](const std::array<double, 4>& at) { return ProbedPoint(grid, at[0], at[1]).weights; },
      [&](std::span<const std::array<double, 4>> at, std::span<const std::uint32_t> which, const double* x,
          const double* y, double* clearances) {
        const auto from = [&](std::size_t i) {
          const std::array<double, 4>& position = at[which[i]];
          const FilmPoint point = ProbedPoint(grid, position[0], position[1]).film;
          return VirtualFilmPoint{point, ExcessRange(tilt, point).at(position[2])};
        };
        upright_clearances(upright, wavelength, which.size(), from, x, y, clearances);
      });
  mirror_at_axes(polygons, grid);
  return polygons;
}

}  // namespace petzval::pupil_table_detail
