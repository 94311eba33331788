// SPDX-License-Identifier: Apache-2.0
#include "bladed_polygons.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/least_squares.hpp"
#include "iris/iris_edges.hpp"
#include "iris/iris_shape.hpp"
#include "lens/lens_view.hpp"
#include "trace/sequential.hpp"

namespace petzval::pupil_table_detail {
namespace {

using Place = Vec2<double>;

/// The products of powers of x and y that are even in x, by order; over x, those that are odd.
template <std::size_t terms>
std::array<double, terms> products(double x, double y) noexcept {
  const double xx = x * x, yy = y * y;
  const std::array<double, 12> all{1,       y,       xx,      yy,          xx * y,      yy * y,
                                   xx * xx, xx * yy, yy * yy, xx * xx * y, xx * yy * y, yy * yy * y};
  std::array<double, terms> result;
  std::copy_n(all.begin(), terms, result.begin());
  return result;
}

template <std::size_t terms>
double sum(const std::array<double, terms>& coefficients, const std::array<double, 12>& of) noexcept {
  double result = 0;
  for (std::size_t i = 0; i < terms; ++i) result += coefficients[i] * of[i];
  return result;
}

/// Least squares: coefficients of products(x, y), times x if odd, for values at points.
template <std::size_t terms>
std::array<double, terms> fitted(std::span<const Place> at, std::span<const double> values, bool odd) {
  const auto count = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd rows(count, terms);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Place& p = at[static_cast<std::size_t>(i)];
    const auto all = products<terms>(p.x, p.y);
    for (std::size_t j = 0; j < terms; ++j) rows(i, static_cast<Eigen::Index>(j)) = (odd ? p.x : 1.0) * all[j];
  }
  const Eigen::VectorXd solution = core_detail::least_squares(rows, Eigen::VectorXd::Map(values.data(), count));
  std::array<double, terms> result;
  std::copy_n(solution.begin(), terms, result.begin());
  return result;
}

}  // namespace

StopMap::StopMap(const Lens& lens, const TwoPlanes& space, double height, const PupilPolygon& pupil,
                 std::size_t wavelength) {
  double farthest = 0;
  for (const auto& corner : pupil.corners) farthest = std::max(farthest, std::hypot(corner[0], corner[1]));
  if (!(farthest > 0)) return;
  radius_ = farthest, base_ = pupil.middle.y;
  const auto& view = kernel::view<double>(lens);
  const std::size_t stop = *lens.stop();
  const double semi_diameter = lens.surfaces()[stop].semi_diameter, towards = towards_scene(lens, space);
  std::vector<Place> places, stops;
  const auto add = [&](const Place& p) {
    const kernel::Vec<double> from{p.x, pupil.middle.y + p.y, space.pupil_z};
    const double dx = from.x, dy = from.y - height, dz = space.depth();
    const double per_length = towards / std::sqrt(dx * dx + dy * dy + dz * dz);
    const auto ray = kernel::trace<double>(
        view, from, {per_length * dx, per_length * dy, per_length * dz},
        {.travel = Travel::to_scene, .wavelength = wavelength, .apertures = false, .first = stop});
    if (ray.fate != RayFate::transmitted) return;
    places.push_back({p.x / radius_, p.y / radius_});
    stops.push_back({ray.origin.x / semi_diameter, ray.origin.y / semi_diameter});
  };
  add({0, 0});
  // As many distances from the middle as tell all polynomials apart where the pupil is a disc.
  for (std::size_t k = 0; k <= polygon_corners / 2; k += 2) {
    for (const double way : k % 4 == 0 ? std::array{0.99, 0.65} : std::array{0.85, 0.4}) {
      add({way * pupil.corners[k][0], way * pupil.corners[k][1]});
    }
  }
  constexpr std::size_t least = 24;
  if (places.size() < least) return;
  std::vector<double> x, y;
  const auto split = [&](const std::vector<Place>& from) {
    x.clear(), y.clear();
    for (const Place& p : from) x.push_back(p.x), y.push_back(p.y);
  };
  split(stops);
  to_stop_ = {fitted<12>(places, y, false), fitted<9>(places, x, true)};
  split(places);
  from_stop_ = {fitted<6>(stops, y, false), fitted<4>(stops, x, true)};
  known_ = true;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place p = this->stop(radius_ * places[i]);
    const double error = std::hypot(p.x - stops[i].x, p.y - stops[i].y);
    known_ = known_ && error <= 0.1;
    error_ = std::max(error_, error);
  }
}

Vec2<double> StopMap::stop(const Vec2<double>& place) const noexcept {
  const double x = place.x / radius_, y = (place.y + middle_) / radius_;
  const auto of = products<12>(x, y);
  return {x * sum(to_stop_.x, of), sum(to_stop_.y, of)};
}

Vec2<double> StopMap::place(const Vec2<double>& stop) const noexcept {
  const auto of = products<12>(stop.x, stop.y);
  return {radius_ * stop.x * sum(from_stop_.x, of), radius_ * sum(from_stop_.y, of) - middle_};
}

BladedGrid::BladedGrid(const Iris& shape, double radius, std::size_t polygons)
    : iris(shape), film_radius(radius), rows((polygons - 1) / 2) {
  const auto blades = static_cast<std::size_t>(shape.blades);
  constexpr std::size_t around = 20;  // columns in half a turn
  columns = (around + blades - 1) / blades;
  corners = polygon_corners / blades * blades;
}

std::array<double, 2> BladedGrid::node(std::size_t i) const noexcept {
  const auto part = [](std::size_t k, std::size_t of) { return static_cast<double>(k) / static_cast<double>(of); };
  return {film_radius * part(i / (columns + 1), rows),
          std::numbers::pi / iris.blades * part(i % (columns + 1), columns)};
}

namespace {

/// Turns from +y towards +x.
struct Turn {
  double cosine = 1, sine = 0;

  explicit Turn(double angle) noexcept : cosine(std::cos(angle)), sine(std::sin(angle)) {}
  Place forward(const Place& p) const noexcept { return {p.x * cosine + p.y * sine, p.y * cosine - p.x * sine}; }
  Place back(const Place& p) const noexcept { return {p.x * cosine - p.y * sine, p.y * cosine + p.x * sine}; }
};

/// The iris with its first corner on +y.
struct Blades {
  std::vector<kernel::StopEdge<double>> edges;  // in semi-diameters
  std::vector<Place> rim;                       // the corners of polygons

  explicit Blades(const BladedGrid& grid) {
    Iris iris = grid.iris;
    iris.rotation_rad = 0;
    for (const auto& [nx, ny, bend, distance] : iris_detail::edges(iris)) edges.push_back({nx, ny, bend, distance});
    const iris_detail::IrisShape shape(iris);
    for (std::size_t k = 0; k < grid.corners; ++k) {
      rim.push_back(shape.sample(static_cast<double>(k) / static_cast<double>(grid.corners), 1));
    }
  }
};

/// The pupil of a film point that is turned from a blade's corner: what the iris leaves of that of the round stop.
/// Places in the frame of the iris, from the middle.
class CutPupil {
 public:
  /// round, map: of the film point on +y; next: another map, for a point halfway to that of the other. margin: by which
  /// the iris is larger, in semi-diameters.
  CutPupil(const Blades& blades, const PupilPolygon& round, const StopMap& map, const StopMap& next, double angle,
           double margin)
      : blades_(blades), round_(round), map_(map), next_(next), turn_(angle), margin_(margin) {
    constexpr double least = 0.02;
    middle_room_ = map.known() && next.known() ? room({0, 0}) : 0;
    cut_ = middle_room_ >= least;
  }

  /// Towards the points of the iris's rim; where it is not known, evenly.
  std::vector<Place> directions() const {
    std::vector<Place> result;
    for (const Place& p : blades_.rim) result.push_back(turn_.forward(map_.place(turn_.back(p))));
    bool in_order = cut_;
    for (std::size_t k = 0; in_order && k < result.size(); ++k) {
      const Place &a = result[k], &b = result[(k + 1) % result.size()];
      in_order = b.x * a.y - a.x * b.y > 0;
    }
    return in_order ? result : blades_.rim;
  }

  /// How far outwards the edge lies, as a multiple of the way to a place.
  double scale_to_edge(const Place& p) const noexcept {
    const double outer = scale_to_round(p);
    if (!cut_ || !(outer < std::numeric_limits<double>::infinity())) return outer;
    // Between the middle, where there is room, and the edge of the round pupil. Illinois's method: an end that stays
    // counts half as much.
    double low = 0, high = outer, at_low = middle_room_, at_high = 0, scale = std::min(outer, 1.0);
    const double first = room(scale * p);
    if (first < 0) {
      high = scale, at_high = first;
    } else {
      if (scale < outer) at_high = room(outer * p);
      if (at_high >= 0) return outer;
      low = scale, at_low = first;
    }
    constexpr double close = 1e-6;
    int side = 0;  // which of them stayed
    for (int i = 0; i < 20; ++i) {
      scale = low + (high - low) * at_low / (at_low - at_high);
      const double here = room(scale * p);
      if (std::abs(here) < close) break;
      if (here >= 0) {
        low = scale, at_low = here;
        if (side > 0) at_high /= 2;
        side = 1;
      } else {
        high = scale, at_high = here;
        if (side < 0) at_low /= 2;
        side = -1;
      }
    }
    return scale;
  }
  bool contains(const Place& p) const noexcept { return scale_to_round(p) >= 1 && (!cut_ || room(p) >= 0); }

 private:
  /// The least distance inwards from an edge.
  double room(const Place& p) const noexcept {
    const Place film = turn_.back(p);
    const Place at = turn_.forward(&map_ == &next_ ? map_.stop(film) : 0.5 * (map_.stop(film) + next_.stop(film)));
    double least = std::numeric_limits<double>::infinity();
    for (const auto& edge : blades_.edges) least = std::min(least, kernel::room_at(edge, at.x, at.y));
    return least + margin_;
  }
  double scale_to_round(const Place& p) const noexcept {
    const Place film = turn_.back(p);
    const auto sectors = [this](std::size_t k) { return round_.sector(k); };
    // On the line to a corner both sectors beside it may miss the place by rounding.
    for (const double aside : {0.0, 1e-9}) {
      const Point<double> q{film.x + aside * film.y, film.y - aside * film.x};
      const std::size_t found = sector_facing(q, sectors, facing_);
      if (found == polygon_corners) continue;
      facing_ = found;
      return 1 / round_.sector(found).way_to(q);
    }
    return std::numeric_limits<double>::infinity();
  }

  const Blades& blades_;
  const PupilPolygon& round_;
  const StopMap &map_, &next_;
  Turn turn_;
  double margin_;
  double middle_room_ = 0;
  bool cut_ = false;
  mutable std::size_t facing_ = 0;
};

/// The middle of the round pupil, or as far from it towards the middle of the iris as it is well within.
void move_middle(PupilPolygon& round, StopMap& map) {
  const Place centre = map.place({0, 0});
  round.obscured.fill(0), round.obscured_from.fill(0);
  const double way = round.way_to(round.middle.x, round.middle.y + centre.y);
  if (!(way > 0 && way < std::numeric_limits<double>::infinity())) return;
  constexpr double farthest = 0.8;
  const double by = centre.y * std::min(1.0, farthest / way);
  round.middle.y += by;
  for (auto& corner : round.corners) corner[1] -= by;
  map.count_from(round.middle.y);
}

PupilPolygon polygon_of_cut(const CutPupil& pupil, const PupilPolygon& round, std::size_t corners, PolygonFit fit) {
  PupilPolygon polygon;
  polygon.middle = round.middle;
  if (!(round.area() > 0)) return polygon;
  const auto edge = [&](const Place& p) {
    const double scale = pupil.scale_to_edge(p);
    return scale < std::numeric_limits<double>::infinity() ? scale * p : Place{0, 0};
  };
  const std::vector<Place> directions = pupil.directions();
  for (std::size_t k = 0; k < corners; ++k) polygon.corners[k] = edge(directions[k]);
  std::fill(polygon.corners.begin() + static_cast<std::ptrdiff_t>(corners), polygon.corners.end(), polygon.corners[0]);
  if (fit == PolygonFit::enclosing) return polygon;
  // To the area between the directions too.
  constexpr std::size_t steps = 4;
  double area = 0;
  Place before = polygon.corners[0];
  for (std::size_t i = 1; i <= steps * corners; ++i) {
    const std::size_t k = (i - 1) / steps;
    const double part = static_cast<double>(i - steps * k) / steps;
    const Place &a = polygon.corners[k], &b = polygon.corners[(k + 1) % polygon_corners];
    const Place p = part == 1 ? b : edge(a + part * (b - a));
    area += (p.x * before.y - before.x * p.y) / 2;
    before = p;
  }
  const double scale = std::sqrt(area / polygon.area());
  for (auto& corner : polygon.corners) corner *= scale;
  return polygon;
}

using Scales = std::array<double, polygon_corners>;

/// Makes the scales of nodes alike where the film is folded: at both ends of a row, and all around the axis.
void make_alike(const BladedGrid& grid, std::vector<Scales>& scales) {
  const std::size_t corners = grid.corners, each = corners / static_cast<std::size_t>(grid.iris.blades);
  const std::size_t nodes = grid.columns + 1;
  for (std::size_t i = 0; i <= grid.rows; ++i) {
    const auto alike = [&](std::size_t j, std::size_t mirror) {
      Scales& scale = scales[i * nodes + j];
      for (std::size_t k = 0; k < corners; ++k) {
        const std::size_t other = (corners + mirror - k) % corners;
        scale[k] = scale[other] = std::max(scale[k], scale[other]);
      }
    };
    alike(0, 0);
    alike(grid.columns, each);
  }
  Scales axial;
  axial.fill(1);
  for (std::size_t j = 0; j < nodes; ++j) {
    for (std::size_t k = 0; k < corners; ++k) {
      for (const std::size_t own : {k % each, (each - k % each) % each}) {
        axial[own] = std::max(axial[own], scales[j][k]);
      }
    }
  }
  for (std::size_t j = 0; j < nodes; ++j) {
    for (std::size_t k = 0; k < corners; ++k) scales[j][k] = axial[k % each];
  }
}

}  // namespace

std::vector<PupilPolygon> bladed_polygons(const BladedGrid& grid, std::span<const PupilPolygon> polygons,
                                          std::vector<StopMap> maps, PolygonFit fit) {
  const bool enclosing = fit == PolygonFit::enclosing;
  const Blades blades(grid);
  std::vector<PupilPolygon> round(polygons.begin(), polygons.end());
  for (std::size_t i = 0; i < round.size(); ++i) {
    maps[i].count_from(round[i].middle.y);
    if (maps[i].known()) move_middle(round[i], maps[i]);
  }
  const double half_angle = std::numbers::pi / grid.iris.blades, step = half_angle / static_cast<double>(grid.columns);
  const auto cut = [&](const PupilPolygon& pupil, std::size_t i, std::size_t next, double column) {
    constexpr double always = 2e-4;
    const double margin = enclosing ? 2 * std::max(maps[i].error(), maps[next].error()) + always : 0;
    return CutPupil(blades, pupil, maps[i], maps[next], column * step, margin);
  };
  const std::size_t nodes = grid.columns + 1, corners = grid.corners;
  std::vector<PupilPolygon> result;
  for (std::size_t i = 0; i <= grid.rows; ++i) {
    for (std::size_t j = 0; j < nodes; ++j) {
      result.push_back(
          polygon_of_cut(cut(round[2 * i], 2 * i, 2 * i, static_cast<double>(j)), round[2 * i], corners, fit));
    }
  }
  if (!enclosing) return result;

  // Between corners, rows and columns. Where much is missing, again.
  std::vector<std::array<std::size_t, 2>> open, missing;  // quarters of rows and half columns
  for (std::size_t i = 0; i <= 4 * grid.rows; ++i) {
    // Between two of the given pupils where they change fast.
    const double area = round[i / 2].area(), next = round[(i + 1) / 2].area();
    constexpr double fast = 0.03;
    if (!(area > 0 && next > 0) || (i % 2 == 1 && std::abs(next - area) < fast * area)) continue;
    for (std::size_t j = 0; j <= 2 * grid.columns; ++j) open.push_back({i, j});
  }
  constexpr int most_rounds = 4;
  for (int tries = 0; tries < most_rounds && !open.empty(); ++tries) {
    std::vector<Scales> scales(result.size());
    for (auto& scale : scales) scale.fill(1);
    missing.clear();
    for (const auto& [i, j] : open) {
      const std::size_t row = std::min(i / 4, grid.rows - 1), column = std::min(j / 2, grid.columns - 1);
      const double up = static_cast<double>(i - 4 * row) / 4, along_row = static_cast<double>(j - 2 * column) / 2;
      const std::size_t low = row * nodes + column, high = low + nodes;
      const PolygonWeights at{{low, low + 1, high, high + 1},
                              {(1 - up) * (1 - along_row), (1 - up) * along_row, up * (1 - along_row), up * along_row}};
      const bool at_node = i % 4 == 0 && j % 2 == 0;
      const PupilPolygon between = interpolated(result, at);
      const PupilPolygon own_round = interpolated(round, {{i / 2, (i + 1) / 2}, {0.5, 0.5}});
      const CutPupil pupil = cut(own_round, i / 2, (i + 1) / 2, static_cast<double>(j) / 2);
      // As seen from the middle of the point's own pupil.
      const Turn turn(static_cast<double>(j) / 2 * step);
      const Place offset = turn.forward({0, between.middle.y - own_round.middle.y});
      double largest = 1;
      for (std::size_t k = 0; k < corners; ++k) {
        const Sector<double> sector = between.sector(k);
        for (const double along : {0.0, 0.5}) {
          if (at_node && along == 0) continue;
          const Point<double> edge = sector.at(1, along);
          const Place p{edge.x + offset.x, edge.y + offset.y};
          if (!pupil.contains(p)) continue;
          constexpr double beyond = 1.4, always = 2e-4;
          const double wanted = 1 + beyond * (pupil.scale_to_edge(p) - 1) + always;
          if (!(wanted < std::numeric_limits<double>::infinity())) continue;
          largest = std::max(largest, wanted);
          for (std::size_t own = 0; own < 4; ++own) {
            if (at.weights[own] == 0) continue;
            for (const std::size_t corner : {k, (k + 1) % corners}) {
              double& scale = scales[at.polygons[own]][corner];
              scale = std::max(scale, wanted);
            }
          }
        }
      }
      constexpr double much = 1.02;
      if (largest > much) missing.push_back({i, j});
    }
    make_alike(grid, scales);
    for (std::size_t p = 0; p < result.size(); ++p) {
      for (std::size_t k = 0; k < polygon_corners; ++k) result[p].corners[k] *= scales[p][k < corners ? k : 0];
    }
    open = missing;
  }
  return result;
}

}  // namespace petzval::pupil_table_detail
