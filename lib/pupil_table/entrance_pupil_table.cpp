// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/entrance_pupil_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "entrance_grid.hpp"
#include "lens/between_wavelengths.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/pupil_plane.hpp"
#include "polygon_place.hpp"
#include "pupil/boundary_search.hpp"
#include "pupil/face.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

constexpr double pi = std::numbers::pi;
/// Cells of the table: in field, from the axis to the last; in reciprocal distance, from infinity to the nearest.
constexpr std::size_t field_steps = 12, distance_steps = 2;
constexpr std::size_t fields = field_steps + 1, distances = distance_steps + 1;

/// Bounds of the places where the rays of one node and its neighbours cross its plane.
struct Bounds {
  double low = 0, high = 0, across = 0;
  bool any = false;

  void take(double x, double y) noexcept {
    low = any ? std::min(low, y) : y;
    high = any ? std::max(high, y) : y;
    across = std::max(across, std::abs(x));
    any = true;
  }
};

double squared(double x) noexcept { return x * x; }

/// The solid angle of a cone about a ball of some radius, seen from some distance; from within, all directions.
double cone(double radius, double distance) noexcept {
  if (!(distance > radius)) return 4 * pi;
  const double sine2 = squared(radius / distance);
  return 2 * pi * sine2 / (1 + std::sqrt(1 - sine2));  // 1 - cosine, without cancellation
}

/// The polygon between some nodes of a table, worked out where it is asked for.
template <class T>
struct BetweenNodes {
  std::array<const PupilPolygon*, 4> nodes{};
  std::array<T, 4> weights{};
  std::size_t count = 0;

  template <class Of>
  Point<T> mean(const Of& of) const {
    Point<T> sum;
    for (std::size_t j = 0; j < count; ++j) sum = sum + weights[j] * of(*nodes[j]);
    return sum;
  }
  Point<T> middle() const {
    return mean([](const PupilPolygon& p) { return Point<T>{p.middle[0], p.middle[1]}; });
  }
  Point<T> corner(std::int32_t k) const {
    return mean([i = static_cast<std::size_t>(k) % polygon_corners](const PupilPolygon& p) {
      return Point<T>{p.corners[i][0], p.corners[i][1]};
    });
  }
  Sector<T> sector(std::int32_t k) const {
    const auto i = static_cast<std::size_t>(k);
    const Point<T> obscured = mean([i](const PupilPolygon& p) { return Point<T>{p.obscured_from[i], p.obscured[i]}; });
    return {corner(k), corner(k + 1), obscured.x, obscured.y};
  }
};

/// The share of samples that each sector of a polygon gets, over its area. Sectors have nearly the same one, and are
/// taken alike: samples need not know the whole.
double density_in(const Sector<double>& sector) noexcept {
  const double area = sector.area();
  return area > 0 ? 1 / (static_cast<double>(polygon_corners) * area) : 0;
}

/// Where a sample of a polygon lies along it, and the density of samples there, 1/mm^2.
struct Drawn {
  Sector<double> sector;
  double along = 0, density = 0;
};

/// Sectors taken alike.
struct SectorsAlike {
  const BetweenNodes<double>& polygon;

  explicit SectorsAlike(const BetweenNodes<double>& p) noexcept : polygon(p) {}
  Drawn operator()(double u) const noexcept {
    const double place = u * polygon_corners;
    const std::size_t k = std::min(static_cast<std::size_t>(place), polygon_corners - 1);
    const Sector<double> sector = polygon.sector(static_cast<std::int32_t>(k));
    return {sector, place - static_cast<double>(k), density_in(sector)};
  }
};

/// Sectors by their area: samples are uniform over the whole.
struct SectorsByArea {
  std::array<Sector<double>, polygon_corners> sectors;
  std::array<double, polygon_corners + 1> before{};

  explicit SectorsByArea(const BetweenNodes<double>& polygon) noexcept {
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      sectors[k] = polygon.sector(static_cast<std::int32_t>(k));
      before[k + 1] = before[k] + std::max(sectors[k].area(), 0.0);
    }
  }
  Drawn operator()(double u) const noexcept {
    const double whole = before[polygon_corners], area = u * whole;
    if (!(whole > 0)) return {};
    const std::size_t k = sector_of_area(area, [this](std::size_t i) { return before[i]; });
    const double own = before[k + 1] - before[k];
    return {sectors[k], own > 0 ? std::clamp((area - before[k]) / own, 0.0, 1.0) : 0, 1 / whole};
  }
};

/// Instead of a polygon where nothing passes any more: between it and the last one, which has `before` others before
/// it, the pupil ends and moves on as it did, and faster.
PupilPolygon beyond(const PupilPolygon* polygon, std::size_t before) noexcept {
  constexpr double room = 1.2;
  PupilPolygon result = polygon[-1];
  if (before > 1) {
    for (int i : {0, 1}) result.middle[i] += polygon[-1].middle[i] - polygon[-2].middle[i];
  }
  result.widen(room);
  return result;
}

/// Whether a pupil is a ring about its middle.
bool is_ring(const PupilPolygon& polygon) noexcept {
  const auto& [middle, corners, from, width] = polygon;
  return *std::max_element(from.begin(), from.end()) == 0 && *std::min_element(width.begin(), width.end()) > 0;
}

}  // namespace

struct EntrancePupilTable::Data {
  /// One wavelength.
  struct Table {
    std::array<double, distances> widest{};  // field of the last node, rad
    std::vector<PupilPolygon> polygons;      // [distance][field]; empty: cones only
    std::optional<EntranceGrid> grid;        // instead of polygons, of a lens with cylinders
    double ball = 0;                         // radius about the centre, mm; 0: nothing passes
  };
  Lens lens;
  Vec3<double> centre{0, 0, 0};
  double front_half = 0, steepest = 0;  // steepest: largest reciprocal distance of the table, 1/mm
  std::vector<Table> tables;
  std::size_t primary = 0;
  lens_detail::CompiledWavelengths compiled;

  explicit Data(const Lens& l) : lens(l) {}

  bool in_front(const Vec3<double>& point) const noexcept {
    constexpr double farthest = 1e100;  // mm: squares of distances must be numbers
    const auto near_enough = [](double x) { return std::abs(x) <= farthest; };
    if (!near_enough(point.x) || !near_enough(point.y) || !near_enough(point.z)) return false;
    const double r = std::hypot(point.x, point.y);
    // Beside the front element fields of more than 90 degrees see past it.
    return r > front_half || point.z < sag(lens, 0, point.x, point.y);
  }

  Bearing bearing_of(const Ray<double>& ray, double reciprocal_radius) const noexcept {
    return Bearing(centre, ray, reciprocal_radius);
  }
  /// The plane of the pupil that a point sees.
  PupilPlane plane_facing(const Bearing& bearing, double reciprocal_distance) const noexcept {
    return PupilPlane::facing(centre, bearing.field, bearing.azimuth, reciprocal_distance);
  }
  double widest_of(const std::vector<Ray<double>>& rays, double reciprocal_radius) const noexcept {
    double widest = 0;
    for (const Ray<double>& ray : rays) widest = std::max(widest, bearing_of(ray, reciprocal_radius).field);
    return widest;
  }

  /// From a place on the axis to the farthest of some rays.
  double farthest(const std::vector<Ray<double>>& rays, double z) const noexcept;
  /// The place on the axis with the least ball that all rays meet.
  double least_ball(std::span<const std::vector<Ray<double>>> rays, double first, double last) const noexcept;
  /// Makes the pupils of each wavelength contain those of wavelengths up to the middles between it and its neighbours.
  void expand_to_neighbours();
  void fill(Table& table, const std::vector<Ray<double>>& rays, std::size_t wavelength, const ScenePassing& passing,
            ClippedBy clipped_by) const;

  /// The nodes about a field at a distance and their weights; nothing for a field beyond the table.
  std::optional<PolygonWeights> weights_of(const Table& table, double field, double reciprocal) const noexcept {
    const double row = reciprocal / steepest * distance_steps;
    const auto i = std::min(static_cast<std::size_t>(row), distance_steps - 1);
    const double down = row - static_cast<double>(i);
    const double last = table.widest[i] + down * (table.widest[i + 1] - table.widest[i]);
    const double column = field / last * field_steps;
    if (!(column <= field_steps)) return {};
    const auto j = std::min(static_cast<std::size_t>(column), field_steps - 1);
    const double right = column - static_cast<double>(j);
    const std::size_t node = i * fields + j;
    return PolygonWeights{{node, node + 1, node + fields, node + fields + 1},
                          {(1 - down) * (1 - right), (1 - down) * right, down * (1 - right), down * right}};
  }
  /// The pupil of a point, empty for a field beyond the table.
  PupilPolygon polygon_at(const Table& table, double field, double reciprocal) const noexcept {
    const auto at = weights_of(table, field, reciprocal);
    return at ? interpolated(table.polygons, *at) : PupilPolygon{};
  }
  /// The pupil of a point, in the quadrant of its bearing with a grid. Nothing beyond the table. own: where it is kept.
  BetweenNodes<double> pupil_at(const Table& table, const Bearing& bearing, double reciprocal, Wavelength wavelength,
                                std::optional<PupilPolygon>& own) const noexcept {
    BetweenNodes<double> result;
    if (table.grid) {
      own = polygon_of_grid(table, bearing, reciprocal, wavelength);
      result.nodes[0] = &*own, result.weights[0] = 1, result.count = 1;
    } else if (const auto at = weights_of(table, bearing.field, reciprocal)) {
      for (result.count = 0; result.count < 4; ++result.count) {
        result.nodes[result.count] = &table.polygons[at->polygons[result.count]];
        result.weights[result.count] = at->weights[result.count];
      }
    }
    return result;
  }
  PupilPolygon polygon_of_grid(const Table& table, const Bearing& bearing, double reciprocal,
                               Wavelength wavelength) const noexcept {
    PupilPolygon polygon = table.grid->polygon(bearing, reciprocal);
    if (!wavelength.in_nm()) return polygon;
    // Polygons of grids are no larger than those of their own wavelengths.
    for (std::size_t r = 0; r < compiled.count(); ++r) {
      if (&tables[compiled.position(r)] != &table) continue;
      for (const std::size_t beside : {r - 1, r + 1}) {
        const Table* const other = beside < compiled.count() ? &tables[compiled.position(beside)] : nullptr;
        if (other && other->grid) expand_towards(polygon, other->grid->polygon(bearing, reciprocal));
      }
    }
    return polygon;
  }

  /// The table to use for a point, its place seen from the centre; none where nothing can be seen.
  const Table* table_for(const Vec3<double>& point, Wavelength at) const noexcept {
    const auto nm = at.in_nm();
    const std::size_t wavelength = nm ? compiled.nearest(*nm) : at.position(primary);
    if (!(wavelength < tables.size()) || !(tables[wavelength].ball > 0)) return nullptr;
    return in_front(point) ? &tables[wavelength] : nullptr;
  }
  bool covers(const Table& table, double distance) const noexcept {
    return (!table.polygons.empty() || table.grid) && steepest * distance >= 1;
  }
};

double EntrancePupilTable::Data::farthest(const std::vector<Ray<double>>& rays, double z) const noexcept {
  double farthest = 0;
  for (const Ray<double>& ray : rays) {
    farthest = std::max(farthest, glm::length(glm::cross(ray.origin - Vec3<double>{0, 0, z}, ray.direction)));
  }
  return farthest;
}

double EntrancePupilTable::Data::least_ball(std::span<const std::vector<Ray<double>>> rays, double first,
                                            double last) const noexcept {
  const auto radius = [&](double z) {
    double largest = 0;
    for (const auto& own : rays) largest = std::max(largest, farthest(own, z));
    return largest;
  };
  // The distance from a line is convex along the axis, and so is the largest of them.
  for (int i = 0; i < 24; ++i) {
    const double a = first + (last - first) / 3, b = last - (last - first) / 3;
    if (radius(a) < radius(b)) {
      last = b;
    } else {
      first = a;
    }
  }
  return (first + last) / 2;
}

void EntrancePupilTable::Data::expand_to_neighbours() {
  const std::vector<Table> own = tables;
  const auto expand = [&](std::size_t w, const Table& other) {
    Table& table = tables[w];
    if (table.polygons.empty() || other.polygons.empty()) return;
    for (std::size_t i = 0; i < distances; ++i) {
      for (std::size_t j = 0; j < fields; ++j) {
        // Of the same field, or the other's last.
        const double field = std::min(table.widest[i] * static_cast<double>(j) / field_steps, other.widest[i]);
        const double reciprocal = steepest * static_cast<double>(i) / distance_steps;
        expand_towards(table.polygons[i * fields + j], polygon_at(other, field, reciprocal));
      }
    }
  };
  for (std::size_t r = 0; r + 1 < compiled.count(); ++r) {
    const std::size_t w = compiled.position(r), next = compiled.position(r + 1);
    expand(w, own[next]);
    expand(next, own[w]);
  }
}

void EntrancePupilTable::Data::fill(Table& table, const std::vector<Ray<double>>& rays, std::size_t wavelength,
                                    const ScenePassing& passing, ClippedBy clipped_by) const {
  // The nodes, and places half way between them to look whether means of nodes contain what they should.
  constexpr std::size_t rows = 2 * distance_steps + 1, columns = 2 * field_steps + 1;
  const auto reciprocal_of = [&](std::size_t row) { return steepest * static_cast<double>(row) / (rows - 1); };

  // How far fields reach at each distance; the rays leave room between them.
  constexpr double between_rays = 1.05, on_axis = 1e-6;
  std::array<double, rows> widest{};
  for (std::size_t row = 0; row < rows; ++row) {
    widest[row] = std::min(between_rays * widest_of(rays, reciprocal_of(row)) + on_axis, pi);
  }
  for (std::size_t row = 1; row < rows; row += 2) {
    const double lacking = widest[row] - (widest[row - 1] + widest[row + 1]) / 2;
    if (lacking > 0) widest[row - 1] += lacking, widest[row + 1] += lacking;
  }
  for (std::size_t row = 1; row < rows; row += 2) widest[row] = (widest[row - 1] + widest[row + 1]) / 2;
  for (std::size_t i = 0; i < distances; ++i) table.widest[i] = widest[2 * i];

  // Where to look for the pupil of a field: about what the rays take of its plane at the distance at which those of a
  // film point are most nearly of one field.
  const auto sharpest = static_cast<std::size_t>(std::min_element(widest.begin(), widest.end()) - widest.begin());
  std::vector<Bounds> bounds(columns);
  for (const Ray<double>& ray : rays) {
    const Bearing bearing = bearing_of(ray, reciprocal_of(sharpest));
    const Vec2<double> place = plane_facing(bearing, 0).meet(ray);
    const auto nearest = static_cast<std::size_t>(std::lround(bearing.field / widest[sharpest] * (columns - 1)));
    for (std::size_t j = nearest - std::min<std::size_t>(nearest, 2); j <= std::min(nearest + 2, columns - 1); ++j) {
      bounds[j].take(place.x, place.y);
    }
  }
  // The axis may be dark.
  const auto lit = std::find_if(bounds.begin(), bounds.end(), [](const Bounds& b) { return b.any; });
  std::fill(bounds.begin(), lit, *lit);
  double room = 0, across = 0;
  for (std::size_t j = 0; j < columns; ++j) {
    if (!bounds[j].any) bounds[j] = bounds[j - 1];
    room = std::max(room, (bounds[j].high - bounds[j].low) / 2);
    across = std::max(across, bounds[j].across);
  }
  std::vector<pupil_detail::PupilGuess> guesses;  // rows x columns
  std::vector<PupilPlane> planes;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t j = 0; j < columns; ++j) {
      const double field = widest[row] * static_cast<double>(j) / (columns - 1);
      const double known = std::min(field / widest[sharpest], 1.0) * (columns - 1);
      const Bounds& b = bounds[static_cast<std::size_t>(std::lround(known))];
      guesses.push_back({0, b.low - room, b.high + room, std::max(across, room)});
      planes.push_back(PupilPlane::facing(centre, field, {0, 1}, reciprocal_of(row)));
    }
  }

  constexpr std::size_t directions = 32;
  RayClearances clearances_of(passing, wavelength);
  const auto passes = [&](std::size_t count, const std::uint32_t* which, const double* x, const double* y,
                          double* clearances) {
    clearances_of(
        count, [&](std::size_t r) { return planes[which[r]].ray(x[r], y[r]); }, clearances);
  };
  const auto pupils = pupil_detail::find_regions(guesses, pupil_detail::SearchOrder::rows(guesses.size(), columns),
                                                 directions, true, passes);

  const auto node = [](std::size_t place) { return place / columns / 2 * fields + place % columns / 2; };
  table.polygons.resize(distances * fields);
  std::vector<InterpolationCheck> checks;
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    const std::size_t row = p / columns, column = p % columns, at = node(p);
    if (row % 2 == 0 && column % 2 == 0) {
      PupilPolygon& polygon = table.polygons[at];
      polygon = pupils[p].empty() && at % fields > 0 ? beyond(&polygon, at % fields)
                                                     : polygon_of(pupils[p], PolygonFit::enclosing);
    } else {
      const std::size_t down = row % 2 * fields, right = column % 2;
      checks.push_back({&pupils[p], {{at, at + right, at + down, at + down + right}, {0.25, 0.25, 0.25, 0.25}}});
    }
  }
  expand_to_cover(table.polygons, checks);
  constexpr double elsewhere = 1.008;  // in cells, away from the places looked at
  for (PupilPolygon& polygon : table.polygons) polygon.widen(elsewhere);
  // An obscuration is worth leaving out that all pupils have around their middles. Others move and are clipped sooner
  // than a few places show.
  const bool rings = std::all_of(table.polygons.begin(), table.polygons.end(), is_ring);
  if (!rings) {
    for (PupilPolygon& polygon : table.polygons) polygon.obscured.fill(0);
  }

  // Where pupils dwindle, in the last fields, their boundaries bend more than a few places show: the sampled rays
  // themselves do, and do everywhere where nothing else clips a pupil.
  const bool all = rings || clipped_by == ClippedBy::samples;
  constexpr double about_rays = 1.08, last_fields = 0.75, in_obscurations = 0.8;
  for (std::size_t row = 0; row < rows; ++row) {
    const double reciprocal = reciprocal_of(row);
    for (const Ray<double>& ray : rays) {
      const Bearing bearing = bearing_of(ray, reciprocal);
      if (!all && bearing.field < last_fields * widest[row]) continue;
      const Vec2<double> place = plane_facing(bearing, reciprocal).meet(ray);
      const PolygonWeights at = weights_of(table, bearing.field, reciprocal).value_or(PolygonWeights{});
      const double way = interpolated(table.polygons, at).way_to(place.x, place.y);
      if (std::isinf(way)) {  // a pupil that no polygon about a middle describes
        table.polygons.clear();
        return;
      }
      for (std::size_t j = 0; j < at.polygons.size(); ++j) {
        if (at.weights[j] == 0) continue;
        PupilPolygon& polygon = table.polygons[at.polygons[j]];
        if (way < 0) {
          for (double& width : polygon.obscured) width *= in_obscurations;
        } else if (about_rays * way > 1) {
          polygon.widen(about_rays * way);
        }
      }
    }
  }
}

EntrancePupilTable::EntrancePupilTable(const Lens& lens, std::span<const std::vector<Ray<double>>> rays,
                                       const ScenePassing& passing, ClippedBy clipped_by) {
  auto data = std::make_shared<Data>(lens);
  data->primary = lens.primary_wavelength();
  data->compiled = lens_detail::CompiledWavelengths(lens.wavelengths_nm());
  const Pupil entrance = pupils(lens, lens.primary_wavelength()).entrance;
  const pupil_detail::Face face = pupil_detail::face_of(lens, 0, entrance);
  data->front_half = face.half;
  // Any centre does; fields look best from the pupil's. It must not lie before the lens, where points may be, nor so
  // far behind that all of them are alike.
  const double length = std::abs(lens.surfaces().back().vertex_z) + face.half;
  const double first = face.z_min, last = face.z_max + 4 * length;
  data->centre.z = std::clamp(entrance.z, first, last);
  if (!lens.rotationally_symmetric()) data->centre.z = data->least_ball(rays, first, last);
  double reach = std::hypot(face.half, data->centre.z - face.z_min);
  for (const auto& own : rays) {
    data->tables.emplace_back();
    const double between_rays = lens.rotationally_symmetric() ? 1.15 : 1.2;
    data->tables.back().ball = between_rays * data->farthest(own, data->centre.z);
    reach = std::max(reach, data->tables.back().ball);
  }
  // With cylinders the pupils of near points move too fast for few nodes.
  data->steepest = (lens.rotationally_symmetric() ? 0.8 : 0.25) / reach;
  // Where the film sees a point through a small part of the pupil only, fields lose their meaning.
  for (const auto& own : rays) {
    constexpr double no_field = 1e-6;
    const double farthest = data->widest_of(own, 0) + no_field;
    while (data->widest_of(own, data->steepest) > 1.5 * farthest) data->steepest *= 0.7;
  }
  for (std::size_t w = 0; w < rays.size(); ++w) {
    Data::Table& table = data->tables[w];
    if (!(table.ball > 0)) continue;
    if (lens.rotationally_symmetric()) {
      data->fill(table, rays[w], w, passing, clipped_by);
    } else {
      table.grid.emplace(data->centre, data->steepest, rays[w], w, passing);
      if (table.grid->empty()) table.grid.reset();
    }
  }
  if (data->compiled.count() == data->tables.size()) data->expand_to_neighbours();
  data_ = std::move(data);
}

bool EntrancePupilTable::in_front(const Vec3<double>& point) const noexcept { return data_->in_front(point); }

template <class Pupil>
void EntrancePupilTable::draw(const Vec3<double>& point, std::size_t count, const double* u, const double* v,
                              Wavelength wavelength, EntranceSample* samples) const noexcept {
  std::fill_n(samples, count, EntranceSample{.place = data_->centre});
  const Data::Table* table = data_->table_for(point, wavelength);
  if (!table) return;
  const Vec3<double> from_centre = point - data_->centre;
  const double distance = glm::length(from_centre);
  const Bearing bearing(from_centre / distance);
  const PupilPlane plane = data_->plane_facing(bearing, 1 / distance);

  if (data_->covers(*table, distance)) {
    std::optional<PupilPolygon> own;
    const auto polygon = data_->pupil_at(*table, bearing, 1 / distance, wavelength, own);
    const Pupil pupil(polygon);
    const Point<double> middle = polygon.middle();
    for (std::size_t i = 0; i < count; ++i) {
      if (!std::isfinite(u[i]) || !std::isfinite(v[i])) continue;
      const auto [sector, along, density] = pupil(std::clamp(u[i], 0.0, 1.0));
      if (!(density > 0)) continue;
      const double way = std::sqrt(sector.squared_way(std::clamp(v[i], 0.0, 1.0)));
      const Point<double> at = middle + sector.at(way, along);
      const Vec2<double> place{at.x, at.y}, p = table->grid ? bearing.from_quadrant(place) : place;
      const Ray<double> ray = plane.ray(p.x, p.y);
      const double far = std::sqrt(squared(distance) + squared(p.x) + squared(p.y));
      samples[i] = {ray.origin, ray.direction, far, squared(far) * (far / distance) * density};
    }
    return;
  }
  const double solid = cone(table->ball, distance);
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(u[i]) || !std::isfinite(v[i])) continue;
    const double less = std::clamp(v[i], 0.0, 1.0) * solid / (2 * pi);
    const double sine = std::sqrt(less * (2 - less)), angle = 2 * pi * u[i];
    const Vec3<double> across = plane.at(sine * std::cos(angle), sine * std::sin(angle)) - plane.centre();
    const Vec3<double> direction = plane.towards() * (less - 1) + across;
    const double far = std::max(distance * (1 - less), 0.0);
    samples[i] = {point + direction * far, direction, far, 1 / solid};
  }
}

EntranceSample EntrancePupilTable::sample(const Vec3<double>& point, double u, double v,
                                          Wavelength wavelength) const noexcept {
  EntranceSample result;
  draw<SectorsAlike>(point, 1, &u, &v, wavelength, &result);
  return result;
}

void EntrancePupilTable::spread(const Vec3<double>& point, std::size_t count, const double* u, const double* v,
                                Wavelength wavelength, EntranceSample* samples) const noexcept {
  draw<SectorsByArea>(point, count, u, v, wavelength, samples);
}

double EntrancePupilTable::pdf(const Vec3<double>& point, const Ray<double>& ray,
                               Wavelength wavelength) const noexcept {
  const Data::Table* table = data_->table_for(point, wavelength);
  if (!table) return 0;
  const Vec3<double> from_centre = point - data_->centre;
  const double distance = glm::length(from_centre);
  const Bearing bearing(from_centre / distance);
  const PupilPlane plane = data_->plane_facing(bearing, 1 / distance);
  const double cosine = -glm::dot(ray.direction, plane.towards());
  if (data_->covers(*table, distance)) {
    if (!(cosine > 0)) return 0;
    const Vec2<double> met = plane.meet(ray), place = table->grid ? bearing.in_quadrant(met) : met;
    std::optional<PupilPolygon> own;
    const auto pupil = data_->pupil_at(*table, bearing, 1 / distance, wavelength, own);
    const Point<double> q = Point<double>{place.x, place.y} - pupil.middle();
    const std::size_t k = sector_towards(pupil, q);
    if (k == polygon_corners) return 0;
    const Sector<double> sector = pupil.sector(static_cast<std::int32_t>(k));
    const double way = squared(sector.way_to(q));
    if (way > 1 || sector.obscures(way)) return 0;
    return squared(distance) * density_in(sector) / (cosine * squared(cosine));
  }
  const double solid = cone(table->ball, distance);
  constexpr double rounding = 1e-15;  // of the cosine
  return 1 - cosine <= solid / (2 * pi) * (1 + 1e-12) + rounding ? 1 / solid : 0;
}

}  // namespace petzval
