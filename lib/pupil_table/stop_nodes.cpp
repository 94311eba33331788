// SPDX-License-Identifier: Apache-2.0
// The stop, as seen through the pupils of a grid. For each node, polynomials of third order, with the largest terms of
// the fifth, are fitted: they map points of the stop to the positions in the pupil plane at which the film point sees
// them. At film points without vignetting they map samples of the iris to the pupil. At other film points the iris
// clips the straight lines of the polygon's samples; at the stop, such a line is nearly straight from the stop point of
// the middle to that of the edge.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "core/least_squares.hpp"
#include "film_pupil_data.hpp"
#include "lens/lens_view.hpp"
#include "petzval/core/parallel.hpp"
#include "pupil_kernel.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace pupil_table_detail {
namespace {

using Position = Point<double>;

constexpr double unlimited = 1e6;  // scale of an iris that clips no rays

/// StopLayout::map of a node, and its error in semi-diameters.
template <int terms>
struct NodeMap {
  std::array<double, terms> numbers{};
  bool known = false, samples_iris = false;
  double error = 0;       // largest error of stop(), in semi-diameters
  double line_error = 0;  // largest error of stop points on straight lines outwards
  Position middle;        // stop points of the middle and of the corners
  std::array<Position, polygon_corners> corners{};

  auto number() const noexcept {
    return [this](int k) { return numbers[static_cast<std::size_t>(k)]; };
  }
  SeenPoint<double> seen(const Position& stop) const noexcept { return seen_point<terms>(number(), stop); }
  /// The stop point whose image is `position`; nullopt if it is far from the iris.
  std::optional<Position> stop(const Position& position) const noexcept {
    const StopSolution<double> found = solve_stop_point<terms>(number(), position);
    constexpr double max_step2 = 1e-6;
    return found.step2 < max_step2 ? std::optional(found.point) : std::nullopt;
  }
};

/// Terms for the coordinate `axis` of a position (StopLayout), at a stop point.
template <int terms>
std::vector<double> products(int axis, const Position& stop) {
  const auto& [x, y] = stop;
  if (terms == 20) return {1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
  const double r = x * x + y * y;
  if (axis == 0) return {x, x * y, x * x * x, x * y * y, x * y * r, x * r * r};
  return {1, y, x * x, y * y, x * x * y, y * y * y, r * r, r * y * y, r * r * y};
}

/// A ray through the line from the middle of a polygon to a corner.
struct StopSample {
  Position position, stop;
  std::size_t corner = 0;
  double radius = 0;  ///< fraction of the line
};

template <int terms>
void fit(NodeMap<terms>& map, std::span<const StopSample> samples) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  for (const int axis : {0, 1}) {
    const std::size_t columns = products<terms>(axis, {}).size();
    Eigen::MatrixXd rows(count, static_cast<Eigen::Index>(columns));
    Eigen::VectorXd values(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const StopSample& sample = samples[static_cast<std::size_t>(i)];
      const std::vector<double> of = products<terms>(axis, sample.stop);
      for (std::size_t k = 0; k < columns; ++k) rows(i, static_cast<Eigen::Index>(k)) = of[k];
      values(i) = axis == 0 ? sample.position.x : sample.position.y;
    }
    const Eigen::VectorXd solution = core_detail::least_squares(rows, values);
    const std::size_t first = terms == 20 ? (axis == 0 ? 0 : 10) : (axis == 0 ? 9 : 0);
    std::copy_n(solution.begin(), columns, map.numbers.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

Position corner(const PupilPolygon& polygon, std::size_t k) {
  return {polygon.corners[k % polygon_corners].x, polygon.corners[k % polygon_corners].y};
}

/// Calls take() for rays through points between the middle of a polygon and its corners, at the given fractions of the
/// distance.
template <class Take>
void for_rays(const PupilPolygon& polygon, std::size_t step, std::span<const double> radii, const Take& take) {
  for (std::size_t k = 0, i = 0; k < polygon_corners; k += step, ++i) {
    const double radius = radii[i % radii.size()];
    take(k, radius, Position{polygon.middle.x, polygon.middle.y} + radius * corner(polygon, k));
  }
}

double distance(const Position& a, const Position& b) { return std::hypot(a.x - b.x, a.y - b.y); }

template <int terms>
NodeMap<terms> fit_node_map(const StopOf& stop_of, const FilmPoint& film, const PupilPolygon& polygon,
                            std::size_t wavelength) {
  NodeMap<terms> map;
  std::vector<StopSample> samples;
  const auto take = [&](std::size_t k, double radius, const Position& position) {
    const auto stop = stop_of(film, {position.x, position.y}, wavelength);
    if (stop) samples.push_back({position, {stop->x, stop->y}, k, radius});
  };
  take(0, 0, {polygon.middle.x, polygon.middle.y});
  // Enough distances from the middle to determine all terms, even for a circular pupil.
  constexpr std::array radii{0.99, 0.85, 0.65, 0.4};
  for_rays(polygon, 2, radii, take);
  constexpr std::size_t min_samples = 24;
  if (samples.size() < min_samples) return map;
  fit<terms>(map, samples);
  const auto middle = map.stop({polygon.middle.x, polygon.middle.y});
  if (!middle) return map;
  map.middle = *middle;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const auto stop = map.stop(Position{polygon.middle.x, polygon.middle.y} + corner(polygon, k));
    if (!stop) return map;
    map.corners[k] = *stop;
  }
  for (const auto& [position, met, k, radius] : samples) {
    const auto stop = map.stop(position);
    if (!stop) return map;
    map.error = std::max(map.error, distance(*stop, met));
    map.line_error = std::max(map.line_error, distance(map.middle + radius * (map.corners[k] - map.middle), met));
  }
  constexpr double max_error = 0.03;
  map.known = map.error <= max_error;
  return map;
}

/// True if the image of the iris lies within the polygon. If `enclosing`, the image may exceed the polygon slightly.
template <int terms>
bool whole_iris_within(const NodeMap<terms>& map, const PupilPolygon& polygon, const iris_detail::IrisShape& shape,
                       bool enclosing) {
  constexpr int azimuths = 48;
  constexpr double rim_fraction = 0.97;  // fraction of the area
  const auto sectors = [&](std::size_t k) { return polygon.sector(k); };
  std::size_t facing = 0;
  int within = 0, all = 0;
  // Film points of a lens of revolution see the iris at any rotation.
  const int turns = terms == 15 && !shape.round() ? 2 : 1;
  for (int turned = 0; turned < turns; ++turned) {
    const double angle = turned * std::numbers::pi / std::max(shape.iris().blades, 1);
    for (int i = 0; i < azimuths; ++i, ++all) {
      const Vec2<double> p = shape.sample((i + 0.5) / azimuths, rim_fraction);
      const double cosine = std::cos(angle), sine = std::sin(angle);
      const Position stop{cosine * p.x - sine * p.y, sine * p.x + cosine * p.y};
      const Position q = map.seen(stop).position - Position{polygon.middle.x, polygon.middle.y};
      const std::size_t found = sector_facing(q, sectors, facing);
      if (found == polygon_corners) continue;
      facing = found;
      within += polygon.sector(found).relative_radius(q) <= 1;
    }
  }
  constexpr double min_inside_fraction = 0.95;
  return enclosing ? within >= min_inside_fraction * all : within == all;
}

/// Error of the stop points at the centre of a cell.
template <int terms>
double error_in_middle(const StopOf& stop_of, const FilmPoint& film, const PupilPolygon& polygon,
                       const NodeMap<terms>& map, std::size_t wavelength) {
  double error = 0;
  constexpr std::array radii{0.97, 0.8};
  for_rays(polygon, 4, radii, [&](std::size_t, double, const Position& position) {
    const auto stop = stop_of(film, {position.x, position.y}, wavelength);
    if (!stop) return;
    if (const auto found = map.stop(position)) error = std::max(error, distance(*found, {stop->x, stop->y}));
  });
  return error;
}

/// Mean of the terms of several maps; the other members stay unset.
template <int terms>
NodeMap<terms> mean_of(std::span<const NodeMap<terms>* const> maps) {
  NodeMap<terms> mean;
  const double radius = 1 / static_cast<double>(maps.size());
  for (const auto* map : maps) {
    for (std::size_t k = 0; k < mean.numbers.size(); ++k) mean.numbers[k] += radius * map->numbers[k];
  }
  return mean;
}

/// Largest change of stop points up to halfway to the next wavelength.
template <int terms>
double change_of(const NodeMap<terms>& map, const NodeMap<terms>& next, const PupilPolygon& polygon) {
  constexpr double step_fraction = 0.6;  // fraction of the step, with a margin for nonlinear changes
  constexpr std::array radii{0.95};
  double change = 0;
  for_rays(polygon, 8, radii, [&](std::size_t, double, const Position& position) {
    const auto a = map.stop(position), b = next.stop(position);
    if (a && b) change = std::max(change, step_fraction * distance(*a, *b));
  });
  return change;
}

/// Adds the numbers of a node (StopLayout).
template <int terms>
void put_node(std::vector<double>& to, const NodeMap<terms>& map, bool samples_iris, double scale) {
  using L = StopLayout<terms>;
  std::vector<double> node(L::size);
  const auto number = [&node](std::int32_t k) -> double& { return node[static_cast<std::size_t>(k)]; };
  number(L::scale) = scale;
  if (scale == unlimited) {  // stop points far outside the rim
    for (const std::int32_t k : terms == 15 ? std::array{1, 9} : std::array{1, 12}) number(L::map + k) = 1;
  } else {
    number(L::samples_iris) = samples_iris ? 1 : 0;
    std::copy(map.numbers.begin(), map.numbers.end(), node.begin() + L::map);
    number(L::middle) = map.middle.x, number(L::middle + 1) = map.middle.y;
    for (std::int32_t k = 0; k <= static_cast<std::int32_t>(polygon_corners); ++k) {
      const Position& corner = map.corners[static_cast<std::size_t>(k) % polygon_corners];
      number(L::corners + 2 * k) = corner.x, number(L::corners + 2 * k + 1) = corner.y;
    }
  }
  to.insert(to.end(), node.begin(), node.end());
}

/// Scale of the iris with which no ray of a cell is missed.
/// @param points, polygons, maps the nodes of the wavelength
/// @param cell           the nodes of the cell
template <int terms>
double scale_in_cell(const StopOf& stop_of, std::span<const FilmPoint> points, std::span<const PupilPolygon> polygons,
                     std::span<const NodeMap<terms>> maps, std::span<const std::size_t> cell, bool samples_iris,
                     std::size_t wavelength) {
  PolygonWeights weights;
  std::vector<const NodeMap<terms>*> at;
  FilmPoint middle;
  const double part = 1 / static_cast<double>(cell.size());
  for (std::size_t k = 0; k < cell.size(); ++k) {
    weights.polygons[k] = cell[k], weights.weights[k] = part;
    at.push_back(&maps[cell[k]]);
    middle.x += part * points[cell[k]].x, middle.y += part * points[cell[k]].y;
  }
  double error = error_in_middle(stop_of, middle, interpolated(polygons, weights), mean_of<terms>(at), wavelength);
  // Fraction of the line error that remains after the second pass of clipping.
  constexpr double remaining_fraction = 0.1;
  double of_lines = 0;
  for (const auto* map : at) {
    error = std::max(error, map->error);
    of_lines = std::max(of_lines, samples_iris ? 0 : remaining_fraction * map->line_error);
  }
  // Margin for rays between the tested rays; it grows with the error of the map.
  constexpr double linear_margin = 1.25, quadratic_margin = 100, min_margin = 2e-4;
  return 1 + (linear_margin + quadratic_margin * error) * error + of_lines + min_margin;
}

/// The numbers of all wavelengths. Data: FilmPupilTable::Data.
template <int terms, class Data>
std::vector<double> stop_numbers(const Data& data, const iris_detail::IrisShape& shape, const StopOf& stop_of,
                                 int threads) {
  std::vector<FilmPoint> points;
  for (std::size_t i = 0; i < data.nodes(); ++i) points.push_back(data.points.node(i));
  std::vector<std::vector<PupilPolygon>> polygons(data.wavelengths);
  std::vector<std::vector<NodeMap<terms>>> maps(data.wavelengths);
  parallel_for(data.wavelengths, 1, threads, [&](std::size_t w, std::size_t) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      PupilPolygon& polygon = polygons[w].emplace_back(data.node(w, i));
      polygon.obscured_from.fill(0), polygon.obscured.fill(0);
      auto& map = maps[w].emplace_back(fit_node_map<terms>(stop_of, points[i], polygon, w));
      // A node without a pupil uses the map of the previous node.
      if (!map.known && i > 0 && terms == 15 && !(polygon.area() > 0)) map = maps[w][i - 1];
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      auto& map = maps[w][i];
      map.samples_iris = map.known && !data.obscured && whole_iris_within(map, polygons[w][i], shape, data.enclosing);
    }
  });
  if (data.enclosing) {
    for (std::size_t r = 0; r + 1 < data.compiled.count(); ++r) {
      const std::size_t w = data.compiled.position(r), next = data.compiled.position(r + 1);
      for (std::size_t i = 0; i < points.size(); ++i) {
        auto &a = maps[w][i], &b = maps[next][i];
        if (!a.known || !b.known) continue;
        const double change = change_of(a, b, polygons[w][i]);
        a.error += change, b.error += change;
      }
    }
  }
  const std::size_t across = data.points.columns + 1;
  std::vector<std::vector<double>> by_wavelength(data.wavelengths);
  parallel_for(data.wavelengths, 1, threads, [&](std::size_t w, std::size_t) {
    // The scale of a node is the largest scale of the cells that share the node.
    std::vector<double> scales(points.size(), 1);
    std::vector<bool> of_iris(points.size(), false);
    for (std::size_t row = 0; row < data.points.rows(); ++row) {
      for (std::size_t column = 0; column < std::max<std::size_t>(data.points.columns, 1); ++column) {
        const std::size_t first = row * across + column;
        std::vector<std::size_t> cell{first, first + 1};
        if (!data.of_revolution()) cell.insert(cell.end(), {first + across, first + across + 1});
        const auto all = [&](bool NodeMap<terms>::*member) {
          return std::all_of(cell.begin(), cell.end(), [&](std::size_t i) { return maps[w][i].*member; });
        };
        if (!all(&NodeMap<terms>::known)) continue;
        of_iris[first] = all(&NodeMap<terms>::samples_iris);
        if (!data.enclosing) continue;
        const double scale = scale_in_cell<terms>(stop_of, points, polygons[w], maps[w], cell, of_iris[first], w);
        for (const std::size_t i : cell) scales[i] = std::max(scales[i], scale);
      }
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& map = maps[w][i];
      put_node(by_wavelength[w], map, of_iris[i], map.known ? scales[i] : unlimited);
    }
  });
  std::vector<double> result;
  for (const auto& numbers : by_wavelength) result.insert(result.end(), numbers.begin(), numbers.end());
  return result;
}

}  // namespace

StopOf traced_stop(const Lens& lens, const TwoPlanes& space) {
  const std::size_t stop = *lens.stop();
  const double semi_diameter = lens.surfaces()[stop].semi_diameter, towards = towards_scene(lens, space);
  return
      [=](const FilmPoint& film, const Vec2<double>& position, std::size_t wavelength) -> std::optional<Vec2<double>> {
        const double dx = position.x - film.x, dy = position.y - film.y, dz = space.depth();
        const double per_length = towards / std::sqrt(dx * dx + dy * dy + dz * dz);
        const auto ray = kernel::trace<double>(
            kernel::view<double>(lens), {position.x, position.y, space.pupil_z},
            {per_length * dx, per_length * dy, per_length * dz},
            {.travel = Travel::to_scene, .wavelength = wavelength, .apertures = false, .first = stop});
        if (ray.fate != RayFate::transmitted) return {};
        return Vec2<double>{ray.origin.x / semi_diameter, ray.origin.y / semi_diameter};
      };
}

}  // namespace pupil_table_detail

FilmPupilTable FilmPupilTable::Data::with_stop(const Iris& iris, const pupil_table_detail::StopOf& stop_of,
                                               int threads) const {
  using namespace pupil_table_detail;
  const iris_detail::IrisShape shape(iris);
  const auto make = of_revolution() ? stop_numbers<15, Data> : stop_numbers<20, Data>;
  auto result = std::make_shared<Data>(*this);
  result->stop =
      std::make_shared<const StopNodes>(StopNodes{shape, stop_of, in_both(make(*this, shape, stop_of, threads))});
  return FilmPupilTable(std::move(result));
}

}  // namespace petzval
