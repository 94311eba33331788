// SPDX-License-Identifier: Apache-2.0
#include "film_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>

#include "core/low_discrepancy.hpp"
#include "core/meet_plane.hpp"
#include "film_lines.hpp"
#include "pupil/aim.hpp"
#include "pupil/boundary_search.hpp"

namespace petzval::inline v0::pupil_table_detail {
namespace {

using pupil_detail::PupilGuess;
using pupil_detail::SearchOrder;

constexpr std::size_t grid_steps = 8;        // between the nodes of an axis
constexpr std::size_t grid_directions = 64;  // of the regions that polygons are made of

/// Finds the pupils of film points that stand in rows.
class PupilFinder {
 public:
  PupilFinder(const Lens& lens, const TwoPlanes& space, std::vector<FilmPoint> points, std::size_t row,
              std::size_t directions, std::size_t wavelength)
      : lens_(lens),
        space_(space),
        points_(std::move(points)),
        row_(row),
        directions_(directions),
        wavelength_(wavelength),
        guesses_(first_order_guesses(lens, space, points_, wavelength)),
        passing_(traced_lines(lens, space, points_, wavelength)) {
    aim();
  }

  std::vector<PupilRegion> operator()() {
    const auto order =
        row_ == 1 ? SearchOrder::rows(points_.size(), 1) : SearchOrder::grid(points_.size() / row_, row_);
    std::vector<PupilRegion> pupils = pupil_detail::find_regions(guesses_, order, directions_, false, passing_);
    // Where the chief ray is lost, light may pass beside it: as beside the pupil of a neighbour, else anywhere.
    if (std::all_of(pupils.begin(), pupils.end(), [](const PupilRegion& p) { return p.empty(); })) {
      std::vector<std::uint32_t> ends;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (i % row_ == 0 || i % row_ == row_ - 1) ends.push_back(static_cast<std::uint32_t>(i));
      }
      std::vector<Box> boxes;
      for (const std::uint32_t i : ends) {
        const PupilGuess& g = guesses_[i];
        const double half = (g.high - g.low) / 2;
        boxes.push_back({g.x, g.low + half, half, half});
      }
      look_again(pupils, ends, boxes, 64);
    }
    std::vector<bool> looked(points_.size(), false);
    for (bool found = true; found;) {
      std::vector<std::uint32_t> dark;
      std::vector<Box> boxes;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (looked[i] || !pupils[i].empty()) continue;
        const auto beside = lit_neighbour(pupils, i);
        if (!beside) continue;
        looked[i] = true;
        dark.push_back(static_cast<std::uint32_t>(i));
        boxes.push_back(*beside);
      }
      found = look_again(pupils, dark, boxes, 24);
    }
    return pupils;
  }

 private:
  struct Box {
    double x, y, half_x, half_y;
  };

  /// Where the rays to the centre and the rim of the stop cross the plane. Aiming takes longer than rays: from some
  /// points of each row, as many as are looked for in full.
  void aim() {
    struct Aimed {
      double x, y, radius;
    };
    const auto aimed_at = [&](const FilmPoint& film) -> std::optional<Aimed> {
      const PupilPlane plane = PupilPlane::of_film(lens_, film);
      const auto place = [&](const StopPoint& target) -> std::optional<Vec2<double>> {
        const AimedRay aimed = pupil_detail::aim(lens_, plane, target, wavelength_);
        if (!aimed) return {};
        const Vec3<double> p = core_detail::meet_plane(aimed.ray, space_.pupil_z);
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
    for (std::size_t begin = 0; begin < points_.size(); begin += row_) {
      std::optional<Aimed> before;
      std::size_t at_before = 0;
      for (std::size_t i = 0; i < row_; ++i) {
        if (i % apart != 0 && i + 1 != row_) continue;
        const auto now = aimed_at(points_[begin + i]);
        const std::size_t steps = std::max<std::size_t>(i - at_before, 1);
        for (std::size_t j = i == 0 ? 0 : at_before + 1; now && j <= i; ++j) {
          const double t = before ? static_cast<double>(j - at_before) / static_cast<double>(steps) : 1;
          const Aimed& from = before ? *before : *now;
          PupilGuess& g = guesses_[begin + j];
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
  }

  /// Where to look beside the pupil of a neighbour: where that moves to, and as far as it reaches.
  std::optional<Box> lit_neighbour(const std::vector<PupilRegion>& pupils, std::size_t i) const {
    const std::size_t column = i % row_;
    const auto lit = [&](std::size_t at) { return at < pupils.size() && !pupils[at].empty(); };
    const auto beside = [&](std::size_t near, std::size_t far, bool has_far) {
      const PupilRegion& p = pupils[near];
      Vec2<double> middle = p.middle;
      if (has_far && lit(far)) middle = middle + (p.middle - pupils[far].middle);
      constexpr double room = 1.6;
      return Box{middle.x, middle.y, room * p.half_axes.x, room * p.half_axes.y};
    };
    if (column > 0 && lit(i - 1)) return beside(i - 1, i - 2, column > 1);
    if (i >= row_ && lit(i - row_)) return beside(i - row_, i - 2 * row_, i >= 2 * row_);
    if (column + 1 < row_ && lit(i + 1)) return beside(i + 1, i + 2, column + 2 < row_);
    if (lit(i + row_)) return beside(i + row_, i + 2 * row_, true);
    return {};
  }

  /// Tests places all over the boxes of some points and finds the pupils of those where anything passes.
  bool look_again(std::vector<PupilRegion>& pupils, const std::vector<std::uint32_t>& which,
                  const std::vector<Box>& boxes, int side) {
    std::vector<std::uint32_t> points;
    std::vector<double> x, y;
    for (std::size_t j = 0; j < which.size(); ++j) {
      for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
          points.push_back(which[j]);
          x.push_back(boxes[j].x + boxes[j].half_x * ((2 * column + 1.0) / side - 1));
          y.push_back(boxes[j].y + boxes[j].half_y * ((2 * row + 1.0) / side - 1));
        }
      }
    }
    std::vector<std::uint8_t> passes(x.size());
    if (!x.empty()) passing_(x.size(), points.data(), x.data(), y.data(), passes.data());
    std::vector<std::uint32_t> lit;
    std::vector<PupilGuess> guesses;
    for (std::size_t j = 0; j < which.size(); ++j) {
      const std::size_t begin = j * static_cast<std::size_t>(side * side), end = begin + side * side;
      double sum_x = 0, sum_y = 0;
      int count = 0;
      for (std::size_t i = begin; i < end; ++i) {
        if (passes[i]) sum_x += x[i], sum_y += y[i], ++count;
      }
      if (count == 0) continue;
      // The place that passes and lies nearest to the middle of all of them.
      std::size_t best = end;
      const auto away = [&](std::size_t i) { return std::hypot(x[i] - sum_x / count, y[i] - sum_y / count); };
      for (std::size_t i = begin; i < end; ++i) {
        if (passes[i] && (best == end || away(i) < away(best))) best = i;
      }
      PupilGuess guess = guesses_[which[j]];
      guess.x = x[best], guess.y = y[best];
      guess.radius = std::max(boxes[j].half_x, boxes[j].half_y);
      guess.near = 2 * boxes[j].half_y;
      lit.push_back(which[j]);
      guesses.push_back(guess);
    }
    if (lit.empty()) return false;
    const pupil_detail::PassingPlaces of_lit = [&](std::size_t count, const std::uint32_t* index, const double* px,
                                                   const double* py, std::uint8_t* through) {
      points.resize(count);
      for (std::size_t i = 0; i < count; ++i) points[i] = lit[index[i]];
      passing_(count, points.data(), px, py, through);
    };
    const auto found =
        pupil_detail::find_regions(guesses, SearchOrder::rows(guesses.size(), 1), directions_, false, of_lit);
    for (std::size_t i = 0; i < lit.size(); ++i) pupils[lit[i]] = found[i];
    return true;
  }

  const Lens& lens_;
  TwoPlanes space_;
  std::vector<FilmPoint> points_;
  std::size_t row_, directions_, wavelength_;
  std::vector<PupilGuess> guesses_;
  pupil_detail::PassingPlaces passing_;
};

/// Which of some film points get light at any wavelength.
std::vector<bool> lit_points(const Lens& lens, const TwoPlanes& space, const std::vector<FilmPoint>& points) {
  std::vector<bool> lit(points.size(), false);
  constexpr std::size_t few_directions = 4;
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    const auto pupils = PupilFinder(lens, space, points, 1, few_directions, w)();
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

/// Corner k at -x.
std::size_t across_x(std::size_t k) noexcept { return (polygon_corners - k) % polygon_corners; }
/// Corner k at -y.
std::size_t across_y(std::size_t k) noexcept { return (polygon_corners / 2 + polygon_corners - k) % polygon_corners; }

/// Makes the corners alike at x and -x, or at y and -y: of each two the outer one counts.
void mirror(PupilPolygon& polygon, bool x) noexcept {
  polygon.middle[x ? 0 : 1] = 0;
  const PupilPolygon own = polygon;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const Vec2<double>&here = own.corners[k], &there = own.corners[x ? across_x(k) : across_y(k)];
    const Vec2<double> mirrored{x ? -there.x : there.x, x ? there.y : -there.y};
    const double in = here.x * here.x + here.y * here.y, out = mirrored.x * mirrored.x + mirrored.y * mirrored.y;
    if (out > in) polygon.corners[k] = mirrored;
  }
}

void mirror_at_axes(std::span<PupilPolygon> polygons, const FilmGrid& grid) noexcept {
  for (std::size_t j = 0; j <= grid.columns; ++j) mirror(polygons[j], false);
  for (std::size_t i = 0; i <= grid.rows(); ++i) mirror(polygons[i * (grid.columns + 1)], true);
}

/// Traces rays just outside the interpolated polygons of points all over a grid, and expands polygons where one passes.
void expand_to_probes(std::span<PupilPolygon> polygons, const Lens& lens, const TwoPlanes& space, const FilmGrid& grid,
                      std::size_t wavelength) {
  constexpr std::size_t probes = 16384;
  constexpr int rounds = 4;
  struct Probe {
    PolygonWeights at;
    std::size_t sector;
    Point<double> middle, edge;  // edge: from the middle
  };
  const core_detail::Kronecker<3> uniform;
  std::vector<std::uint32_t> which;
  std::vector<double> x, y;
  std::vector<std::uint8_t> passes;
  for (int round = 0; round < rounds; ++round) {
    std::vector<FilmPoint> points;
    std::vector<Probe> all;
    for (std::size_t p = 0; p < probes; ++p) {
      const auto [down, across, around] = uniform(static_cast<std::size_t>(round) * probes + p);
      const double row = down * static_cast<double>(grid.rows()), column = across * static_cast<double>(grid.columns);
      const auto i = std::min(static_cast<std::size_t>(row), grid.rows() - 1);
      const auto j = std::min(static_cast<std::size_t>(column), grid.columns - 1);
      const double s = row - static_cast<double>(i), t = column - static_cast<double>(j);
      const double width = (1 - s) * grid.half_widths[i] + s * grid.half_widths[i + 1];
      points.push_back({width * across, grid.height * down});
      const std::size_t node = i * (grid.columns + 1) + j, above = node + grid.columns + 1;
      Probe probe{
          {{node, node + 1, above, above + 1}, {(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t}}, 0, {}, {}};
      const double along = around * polygon_corners;
      probe.sector = std::min(static_cast<std::size_t>(along), polygon_corners - 1);
      for (std::size_t k = 0; k < probe.at.polygons.size(); ++k) {
        const PupilPolygon& polygon = polygons[probe.at.polygons[k]];
        const double weight = probe.at.weights[k];
        const Sector<double> sector = polygon.sector(probe.sector);
        const Point<double> middle{polygon.middle.x, polygon.middle.y};
        probe.middle = probe.middle + weight * middle;
        probe.edge = probe.edge + weight * sector.at(1, along - static_cast<double>(probe.sector));
      }
      all.push_back(probe);
    }
    const pupil_detail::PassingPlaces passing = traced_lines(lens, space, std::move(points), wavelength);
    // Steps outwards, of those that still pass.
    std::vector<double> scales(probes, 1);
    std::vector<std::uint32_t> open(probes);
    std::iota(open.begin(), open.end(), 0u);
    for (const double way : {1.00001, 1.002, 1.006, 1.015, 1.04, 1.1, 1.25, 1.6}) {
      x.clear(), y.clear();
      for (const std::uint32_t p : open) {
        x.push_back(all[p].middle.x + way * all[p].edge.x);
        y.push_back(all[p].middle.y + way * all[p].edge.y);
      }
      passes.resize(open.size());
      if (open.empty()) break;
      passing(open.size(), open.data(), x.data(), y.data(), passes.data());
      std::size_t left = 0;
      for (std::size_t i = 0; i < open.size(); ++i) {
        if (!passes[i]) continue;
        scales[open[i]] = 1 + 1.5 * (way - 1) + 0.002;
        open[left++] = open[i];
      }
      open.resize(left);
    }
    std::vector<std::array<double, polygon_corners>> larger(polygons.size());
    for (auto& scale : larger) scale.fill(1);
    bool any = false;
    for (std::size_t p = 0; p < probes; ++p) {
      if (scales[p] == 1) continue;
      any = true;
      for (std::size_t k = 0; k < 4; ++k) {
        if (all[p].at.weights[k] == 0) continue;
        for (const std::size_t corner : {all[p].sector, (all[p].sector + 1) % polygon_corners}) {
          double& scale = larger[all[p].at.polygons[k]][corner];
          scale = std::max(scale, scales[p]);
        }
      }
    }
    if (!any) return;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
      for (std::size_t k = 0; k < polygon_corners; ++k) polygons[p].corners[k] *= larger[p][k];
    }
  }
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
  const std::vector<PupilRegion> pupils =
      PupilFinder(lens, space, std::move(points), columns, grid_directions, wavelength)();

  std::vector<PupilPolygon> polygons(grid.nodes());
  std::vector<bool> known(grid.nodes(), false);
  const auto node = [&](std::size_t i, std::size_t j) { return i * (grid.columns + 1) + j; };
  for (std::size_t i = 0; i < rows; i += 2) {
    for (std::size_t j = 0; j < columns; j += 2) {
      // Where the light ends beside a node, a pupil of the points between continues to it.
      const PupilRegion* lit = nullptr;
      for (const auto& [up, right] :
           {std::pair{0, 0}, {0, -1}, {-1, 0}, {-1, -1}, {0, 1}, {1, 0}, {-1, 1}, {1, -1}, {1, 1}}) {
        const std::size_t row = i + static_cast<std::size_t>(up), column = j + static_cast<std::size_t>(right);
        if (row >= rows || column >= columns || pupils[row * columns + column].empty()) continue;
        lit = &pupils[row * columns + column];
        break;
      }
      if (!lit) continue;
      PupilPolygon& polygon = polygons[node(i / 2, j / 2)];
      polygon = polygon_of(*lit, fit, CornerSteps::even_in_halves);
      known[node(i / 2, j / 2)] = true;
      const double area = polygon.area();
      polygon.obscured.fill(0), polygon.obscured_from.fill(0);
      if (fit == PolygonFit::enclosing) continue;
      const double scale = lit == &pupils[i * columns + j] && area > 0 ? std::sqrt(area / polygon.area()) : 0;
      for (auto& corner : polygon.corners) corner *= scale;
    }
  }
  mirror_at_axes(polygons, grid);
  if (fit == PolygonFit::equal_area) return polygons;
  std::vector<InterpolationCheck> checks;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const std::size_t low = node(i / 2, j / 2), up = node((i + 1) / 2, j / 2);
      const std::size_t right = j % 2;
      checks.push_back({&pupils[i * columns + j], {{low, low + right, up, up + right}, {0.25, 0.25, 0.25, 0.25}}});
    }
  }
  expand_to_cover(polygons, checks);
  expand_to_probes(polygons, lens, space, grid, wavelength);
  mirror_at_axes(polygons, grid);
  return polygons;
}

PupilPolygon hull(const std::vector<PupilPolygon>& polygons) {
  std::vector<Point<double>> places;
  for (const PupilPolygon& polygon : polygons) {
    if (!(polygon.area() > 0)) continue;
    for (const auto& corner : polygon.corners) {
      places.push_back({polygon.middle.x + corner.x, polygon.middle.y + corner.y});
    }
  }
  if (places.empty()) return {};
  // Their convex hull, from the lowest x on: on the way there above, on the way back below.
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  std::vector<Point<double>> edge;
  const auto go = [&](auto begin, auto end) {
    const std::size_t first = edge.size();
    for (auto p = begin; p != end; ++p) {
      while (edge.size() > first + 1 && turn(edge.back() - edge[edge.size() - 2], *p - edge.back()) <= 0)
        edge.pop_back();
      edge.push_back(*p);
    }
    edge.pop_back();
  };
  go(places.begin(), places.end());
  go(places.rbegin(), places.rend());
  PupilRegion region{.directions = 128};
  const auto [left, right] = std::minmax_element(edge.begin(), edge.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [low, high] = std::minmax_element(edge.begin(), edge.end(), [](auto& a, auto& b) { return a.y < b.y; });
  region.middle = {(left->x + right->x) / 2, (low->y + high->y) / 2};
  region.half_axes = {(right->x - left->x) / 2, (high->y - low->y) / 2};
  const Point<double> middle{region.middle.x, region.middle.y};
  for (std::size_t k = 0; k < region.directions; ++k) {
    const Vec2<double> unit = region.unit(k) * region.half_axes;
    const Point<double> ray{unit.x, unit.y};
    for (std::size_t i = 0; i < edge.size(); ++i) {
      const Point<double> a = edge[i] - middle, b = edge[(i + 1) % edge.size()] - middle;
      if (!(turn(a, ray) >= 0 && turn(ray, b) > 0)) continue;
      const double radius = turn(a, b) / (turn(a, ray) + turn(ray, b));
      const Vec2<double> rim = region.at(k, radius);
      region.spans.push_back({k, 0, radius, {region.middle.x, region.middle.y}, {rim.x, rim.y}});
      break;
    }
  }
  PupilPolygon polygon = polygon_of(region, PolygonFit::enclosing);
  // Corners of the hull between two directions.
  double way = 1;
  for (const auto& p : edge) way = std::max(way, polygon.way_to(p.x, p.y));
  polygon.widen(way);
  return polygon;
}

}  // namespace petzval::inline v0::pupil_table_detail
