// SPDX-License-Identifier: Apache-2.0
#include "film_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>

#include "core/meet_plane.hpp"
#include "film_lines.hpp"
#include "grid_pupils.hpp"
#include "pupil/aim.hpp"
#include "pupil/boundary_search.hpp"

namespace petzval::inline v0::pupil_table_detail {
namespace {

using pupil_detail::PupilGuess;

constexpr std::size_t grid_steps = 8;        // between the nodes of an axis
constexpr std::size_t grid_directions = 64;  // of the regions that polygons are made of

/// Where the rays to the centre and the rim of the stop cross the plane. Aiming takes longer than rays: from some
/// points of each row, as many as are looked for in full.
std::vector<PupilGuess> aimed_guesses(const Lens& lens, const TwoPlanes& space, std::span<const FilmPoint> points,
                                      std::size_t row, std::size_t wavelength) {
  std::vector<PupilGuess> guesses = first_order_guesses(lens, space, points, wavelength);
  struct Aimed {
    double x, y, radius;
  };
  const auto aimed_at = [&](const FilmPoint& film) -> std::optional<Aimed> {
    const PupilPlane plane = PupilPlane::of_film(lens, film);
    const auto place = [&](const StopPoint& target) -> std::optional<Vec2<double>> {
      const AimedRay aimed = pupil_detail::aim(lens, plane, target, wavelength);
      if (!aimed) return {};
      const Vec3<double> p = core_detail::meet_plane(aimed.ray, space.pupil_z);
      return std::isfinite(p.x + p.y) ? std::optional(Vec2<double>{p.x, p.y}) : std::nullopt;
    };
    const auto centre = place({});
    if (!centre) return {};
    double radius = 0;
    for (const StopPoint rim : {StopPoint{1, 0}, StopPoint{0, 1}}) {
      if (const auto p = place(rim)) radius = std::max(radius, std::hypot(p->x - centre->x, p->y - centre->y));
    }
    return Aimed{centre->x, centre->y, radius};
  };
  constexpr std::size_t apart = 16;
  for (std::size_t begin = 0; begin < points.size(); begin += row) {
    std::optional<Aimed> before;
    std::size_t at_before = 0;
    for (std::size_t i = 0; i < row; ++i) {
      if (i % apart != 0 && i + 1 != row) continue;
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

/// The pupils of film points in rows.
std::vector<PupilRegion> film_pupils(const Lens& lens, const TwoPlanes& space, const std::vector<FilmPoint>& points,
                                     std::size_t row, std::size_t directions, std::size_t wavelength) {
  const auto guesses = aimed_guesses(lens, space, points, row, wavelength);
  return grid_pupils({guesses, row}, directions, traced_lines(lens, space, points, wavelength));
}

/// Which of some film points get light at any wavelength.
std::vector<bool> lit_points(const Lens& lens, const TwoPlanes& space, const std::vector<FilmPoint>& points) {
  std::vector<bool> lit(points.size(), false);
  constexpr std::size_t few_directions = 4;
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    const auto pupils = film_pupils(lens, space, points, 1, few_directions, w);
    for (std::size_t i = 0; i < points.size(); ++i) lit[i] = lit[i] || !pupils[i].empty();
  }
  return lit;
}

/// How far the light reaches on some lines from (0, y) towards +x, or along +y, each within a 2^-8 part.
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

void mirror_at_axes(std::span<PupilPolygon> polygons, const FilmGrid& grid) noexcept {
  for (std::size_t j = 0; j <= grid.columns; ++j) mirror(polygons[j], false);
  for (std::size_t i = 0; i <= grid.rows(); ++i) mirror(polygons[i * (grid.columns + 1)], true);
}

/// Probes film points all over a grid by traced rays.
void expand_to_traced_probes(std::span<PupilPolygon> polygons, const Lens& lens, const TwoPlanes& space,
                             const FilmGrid& grid, std::size_t wavelength) {
  struct Cell {
    std::size_t i, j;
    double s, t;
  };
  const auto cell_of = [&](const std::array<double, 4>& place) {
    const double row = place[0] * static_cast<double>(grid.rows()),
                 column = place[1] * static_cast<double>(grid.columns);
    const auto i = std::min(static_cast<std::size_t>(row), grid.rows() - 1);
    const auto j = std::min(static_cast<std::size_t>(column), grid.columns - 1);
    return Cell{i, j, row - static_cast<double>(i), column - static_cast<double>(j)};
  };
  const auto weights = [&](const std::array<double, 4>& place) -> PolygonWeights {
    const auto [i, j, s, t] = cell_of(place);
    const std::size_t node = i * (grid.columns + 1) + j, above = node + grid.columns + 1;
    return {{node, node + 1, above, above + 1}, {(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t}};
  };
  const auto at_probes = [&](std::span<const std::array<double, 4>> places, std::span<const std::uint32_t> which,
                             const double* x, const double* y, double* clearances) {
    std::vector<FilmPoint> points;
    std::vector<std::uint32_t> index(which.size());
    std::iota(index.begin(), index.end(), 0u);
    for (const std::uint32_t p : which) {
      const auto [i, j, s, t] = cell_of(places[p]);
      const double width = (1 - s) * grid.half_widths[i] + s * grid.half_widths[i + 1];
      points.push_back({width * places[p][1], grid.height * places[p][0]});
    }
    traced_lines(lens, space, std::move(points), wavelength)(which.size(), index.data(), x, y, clearances);
  };
  constexpr std::size_t probes = 16384;
  expand_to_probes(polygons, probes, weights, at_probes);
}

}  // namespace

FilmGrid film_grid(const Lens& lens, const TwoPlanes& space, double film_radius) {
  FilmGrid grid;
  grid.columns = grid_steps;
  grid.height = lit_lengths(lens, space, {0}, {film_radius}, false)[0];
  // Rows at half steps: the straight lines between the ends of whole ones enclose those too.
  constexpr std::size_t half_steps = 2 * grid_steps;
  std::vector<double> heights, widths;
  for (std::size_t i = 0; i <= half_steps; ++i) {
    const double y = grid.height * static_cast<double>(i) / half_steps;
    heights.push_back(y);
    widths.push_back(std::sqrt(std::max(film_radius * film_radius - y * y, 0.0)));
  }
  widths = lit_lengths(lens, space, heights, widths, true);
  for (std::size_t i = 0; i <= half_steps; i += 2) grid.half_widths.push_back(widths[i]);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < grid.rows(); ++i) {
      double &before = grid.half_widths[i], &after = grid.half_widths[i + 1];
      // An arc reaches over the chords to its middle by a quarter as much.
      const double chord = (before + after) / 2, beyond = 1.35 * std::max(widths[2 * i + 1] - chord, 0.0);
      before += beyond, after += beyond;
    }
  }
  return grid;
}

std::vector<PupilPolygon> grid_polygons(const Lens& lens, const TwoPlanes& space, const FilmGrid& grid, PolygonFit fit,
                                        std::size_t wavelength) {
  // The nodes and the points halfway between.
  const std::size_t columns = 2 * grid.columns + 1, rows = 2 * grid.rows() + 1;
  std::vector<FilmPoint> points;
  for (std::size_t i = 0; i < rows; ++i) {
    const double width = (grid.half_widths[i / 2] + grid.half_widths[(i + 1) / 2]) / 2;
    for (std::size_t j = 0; j < columns; ++j) {
      points.push_back({width * static_cast<double>(j) / static_cast<double>(columns - 1),
                        grid.height * static_cast<double>(i) / static_cast<double>(rows - 1)});
    }
  }
  const std::vector<PupilRegion> pupils = film_pupils(lens, space, points, columns, grid_directions, wavelength);
  std::vector<PupilPolygon> polygons = node_polygons(pupils, columns, fit);
  mirror_at_axes(polygons, grid);
  if (fit == PolygonFit::equal_area) return polygons;
  const auto node = [&](std::size_t i, std::size_t j) { return i * (grid.columns + 1) + j; };
  std::vector<InterpolationCheck> checks;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const std::size_t low = node(i / 2, j / 2), up = node((i + 1) / 2, j / 2);
      const std::size_t right = j % 2;
      checks.push_back({&pupils[i * columns + j], {{low, low + right, up, up + right}, {0.25, 0.25, 0.25, 0.25}}});
    }
  }
  expand_to_cover(polygons, checks);
  expand_to_traced_probes(polygons, lens, space, grid, wavelength);
  mirror_at_axes(polygons, grid);
  return polygons;
}

}  // namespace petzval::inline v0::pupil_table_detail
