// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/film_pupil_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/dual.hpp"
#include "film_pupil_data.hpp"
#include "petzval/core/error.hpp"
#include "pupil/line_extents.hpp"
#include "pupil_kernel.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;
using kernel::Dual;

template <class V, class Grid>
CellOf<typename Grid::Chart, V> cell_at(const Grid& grid, const V& x, const V& y, std::int32_t wavelength) noexcept {
  return grid.chart.find(x, y, wavelength >= 0, std::max(wavelength, 0) * grid.chart.nodes());
}

/// The polygon of one film point.
template <class Grid>
struct PolygonAt {
  const Grid& grid;
  CellOf<typename Grid::Chart, double> cell;

  PolygonAt(const Grid& g, const FilmPoint& film, std::int32_t wavelength) noexcept
      : grid(g), cell(cell_at(g, film.x, film.y, wavelength)) {}
  Point<double> middle() const noexcept { return middle_of<double>(grid, cell); }
  Point<double> corner(std::int32_t k) const noexcept { return corner_of<double>(grid, cell, k); }
  Sector<double> sector(std::int32_t k) const noexcept {
    return grid.obscured ? sector_of<true, double>(grid, cell, k) : sector_of<false, double>(grid, cell, k);
  }
  double area() const noexcept {
    const auto sectors = [this](std::size_t k) { return sector(static_cast<std::int32_t>(k)); };
    return cell.known ? PolygonSampler(sectors).area() : 0;
  }
  bool samples_iris() const noexcept {
    return grid.stop.nodes && pupil_table_detail::samples_iris<double>(grid, cell) > 0;
  }
  Point<double> to_grid(double x, double y) const noexcept {
    return Grid::Chart::to_grid(cell, Point<double>{x, y}) - middle();
  }
  /// Clearance as in FilmPupilTable::clearances() of a position relative to the middle.
  /// @param facing on input, the first sector to try; on output, the sector that faces the position
  double clearance(const Point<double>& q, std::int32_t& facing) const noexcept {
    Sector<double> own = sector(facing);
    if (!own.faces(q)) {
      const auto sectors = [this](std::size_t k) { return sector(static_cast<std::int32_t>(k)); };
      const auto first = sector_before(q, [this](std::int32_t k) { return corner(k); });
      const std::size_t found = sector_facing(q, sectors, static_cast<std::size_t>(first));
      if (found == polygon_corners) return -1;
      facing = static_cast<std::int32_t>(found);
      own = sector(facing);
    }
    constexpr double farthest = 1e150;  // its square is finite
    const double radius = std::min(own.relative_radius(q), farthest), squared = radius * radius;
    double least = 1 - squared;
    if (own.obscured > 0) {
      const double inner = own.obscured_from - squared, outer = squared - own.obscured_from - own.obscured;
      least = std::min(least, std::max(inner, outer));
    }
    return least < 0 ? least / (1 - least) : least;
  }
};

/// Derivatives of the middle of a polygon by its film point.
template <class Grid>
FilmPupilTable::Derivatives motion_of_middle(const Grid& grid, const FilmPoint& film,
                                             std::int32_t wavelength) noexcept {
  FilmPoint at = film;
  if constexpr (Grid::Chart::cell_nodes == 2) {
    // Near the axis, quotients by the distance would be inaccurate: take the motion at the end of the first row.
    const double r = std::hypot(film.x, film.y), row = (1 - 1e-9) / grid.chart.rows_per_mm;
    if (r < row && row <= grid.chart.reach)
      at = r > 0 ? FilmPoint{film.x / r * row, film.y / r * row} : FilmPoint{0, row};
  }
  if (Grid::Chart::cell_nodes == 2 && !(at.x * at.x + at.y * at.y > axis_r2<double>)) return {};  // a tiny film
  const auto cell = cell_at(grid, Dual(at.x, 0), Dual(at.y, 1), wavelength);
  const Point<Dual> middle = Grid::Chart::to_film(cell, middle_of<Dual>(grid, cell));
  return {{middle.x.v.x, middle.y.v.x}, {middle.x.v.y, middle.y.v.y}};
}

}  // namespace

const TwoPlanes& FilmPupilTable::space() const noexcept { return data_->space; }
double FilmPupilTable::film_radius() const noexcept { return data_->film_radius; }
double FilmPupilTable::lit_radius() const noexcept { return data_->reach(); }
std::size_t FilmPupilTable::wavelengths() const noexcept { return data_->wavelengths; }
std::size_t FilmPupilTable::primary_wavelength() const noexcept { return data_->primary; }
bool FilmPupilTable::covers(Wavelength wavelength) const noexcept {
  return data_->position(wavelength) < data_->wavelengths;
}
bool FilmPupilTable::knows_stop() const noexcept { return data_->stop != nullptr; }

FilmPupilArrays FilmPupilTable::arrays() const {
  if (data_->images) throw Error("pupils: arrays: the pupils have a closed form; must be polygons");
  FilmPupilArrays result;
  result.dimensions = data_->of_revolution() ? 1 : 2;
  result.rows = data_->points.rows(), result.columns = std::max<std::size_t>(data_->points.columns, 1);
  if (!data_->of_revolution()) result.half_widths = std::get<1>(data_->half_widths);
  result.node_size = static_cast<std::size_t>(data_->obscured ? NodeLayout::size : NodeLayout::obscured);
  const std::vector<float>& numbers = std::get<1>(data_->numbers);
  for (auto node = numbers.begin(); node != numbers.end(); node += NodeLayout::size) {
    result.nodes.insert(result.nodes.end(), node, node + static_cast<std::ptrdiff_t>(result.node_size));
  }
  data_->with_grid<float>([&](const auto& grid) {
    result.reach = grid.chart.reach, result.rows_per_mm = grid.chart.rows_per_mm;
    if (!data_->stop) return;
    result.stops = std::get<1>(data_->stop->numbers);
    result.stop_size = StopLayout<std::decay_t<decltype(grid.chart)>::map_terms>::size;
    const auto& iris = grid.stop.iris;
    result.iris_area = grid.stop.area;
    const auto add = [&](const float* from, std::size_t count) {
      result.iris.insert(result.iris.end(), from, from + count);
    };
    constexpr std::size_t terms = iris_detail::edge_terms<float>;
    if (iris.count > 0) add(iris.across, terms), add(iris.along, terms), add(iris.turns, 2 * iris.count);
    if (iris.count > 0) add(iris.edges, 4 * iris.count);
  });
  return result;
}

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->sample(film, u, v, wavelength);
  return data_->with_grid<double>([&](const auto& grid) -> PupilSample {
    const PolygonAt polygon(grid, film, data_->known(wavelength));
    if (!polygon.cell.known || !std::isfinite(u + v)) return {};
    const auto [x, y, area] =
        polygon.samples_iris() ? in_iris<double>(grid, polygon.cell, u, v)
                               : with_kind(grid, [&](auto obscured, auto stopped) {
                                   return in_polygon<obscured.value, stopped.value, double>(grid, polygon.cell, u, v);
                                 });
    return {x, y, area};
  });
}

template <class T>
void FilmPupilTable::sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
                            const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept {
  data_->run<T>(count, {film_x, film_y, u, v}, wavelengths, std::array{x, y, areas},
                [](const auto& loops) { return loops.sample; });
}

double FilmPupilTable::polygon_area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->area_of_stop(film, wavelength);
  return data_->with_grid<double>(
      [&](const auto& grid) { return PolygonAt(grid, film, data_->known(wavelength)).area(); });
}

double FilmPupilTable::area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->area(film, wavelength);
  return data_->stop ? mean_over_samples(film, wavelength, [](const PupilSample&) { return 1.0; })
                     : polygon_area(film, wavelength);
}

double FilmPupilTable::projected_solid_angle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  const auto value = [&](const PupilSample& s) { return solid_angle_at(space(), film, s.x, s.y); };
  return space().depth() * space().depth() * mean_over_samples(film, wavelength, value);
}

template <class Value>
double FilmPupilTable::mean_over_samples(const FilmPoint& film, Wavelength wavelength, const Value& value) const {
  // One sample for each sector. If an iris clips the polygon, areas change fast with u.
  constexpr int sectors = static_cast<int>(polygon_corners);
  return pupil_table_detail::mean_over_samples(data_->stop ? 2 * sectors : sectors, [&](double u, double v) {
    const PupilSample s = sample(film, u, v, wavelength);
    return s.area > 0 ? s.area * value(s) : 0;
  });
}

Vec2<double> FilmPupilTable::middle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->middle(film, wavelength);
  return data_->with_grid<double>([&](const auto& grid) -> Vec2<double> {
    const PolygonAt polygon(grid, film, data_->known(wavelength));
    if (!polygon.cell.known) return {0, 0};
    const Point<double> middle = grid.chart.to_film(polygon.cell, polygon.middle());
    return {middle.x, middle.y};
  });
}

double FilmPupilTable::sample_area(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->sample_area(film, x, y, wavelength);
  return data_->with_grid<double>([&](const auto& grid) {
    const PolygonAt polygon(grid, film, data_->known(wavelength));
    if (!polygon.cell.known || !std::isfinite(x + y)) return 0.0;
    if (polygon.samples_iris()) return area_in_iris<double>(grid, polygon.cell, {x, y});
    return with_kind(grid, [&](auto obscured, auto stopped) {
      return locate<obscured.value, stopped.value, double>(grid, polygon.cell, {x, y}).area;
    });
  });
}

bool FilmPupilTable::contains(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  return sample_area(film, x, y, wavelength) > 0;
}

template <class T>
void FilmPupilTable::sample_areas(std::size_t count, const TwoPlaneRays<const T>& lines,
                                  const RayWavelengths& wavelengths, T* areas) const noexcept {
  if (count == 1) {
    areas[0] = static_cast<T>(
        sample_area({lines.film_x[0], lines.film_y[0]}, lines.pupil_x[0], lines.pupil_y[0], wavelengths.at(0)));
    return;
  }
  data_->run<T>(count, {lines.film_x, lines.film_y, lines.pupil_x, lines.pupil_y}, wavelengths, std::array{areas},
                [](const auto& loops) { return loops.areas; });
}

template <class T>
void FilmPupilTable::contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                              std::uint8_t* within) const noexcept {
  constexpr std::size_t block = 256;
  std::array<T, block> areas;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    sample_areas(n, lines.from(begin), wavelengths.from(begin), areas.data());
    for (std::size_t i = 0; i < n; ++i) within[begin + i] = areas[i] > 0;
  }
}

template <class T>
void FilmPupilTable::stop_points(std::size_t count, const TwoPlaneRays<const T>& lines,
                                 const RayWavelengths& wavelengths, T* x, T* y) const noexcept {
  data_->run<T>(count, {lines.film_x, lines.film_y, lines.pupil_x, lines.pupil_y}, wavelengths, std::array{x, y},
                [](const auto& loops) { return loops.stop_points; });
}

double FilmPupilTable::sampled_iris_scale(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (!data_->stop) return 0;
  return data_->with_grid<double>([&](const auto& grid) {
    const PolygonAt polygon(grid, film, data_->known(wavelength));
    return polygon.cell.known && polygon.samples_iris() ? stop_at<double>(grid, polygon.cell).scale() : 0.0;
  });
}

void FilmPupilTable::clearances(std::size_t count, const TwoPlaneRays<const double>& lines, Wavelength wavelength,
                                double* clearances) const noexcept {
  if (data_->images) {
    for (std::size_t i = 0; i < count; ++i) {
      clearances[i] = pupil_detail::clearance_of(
          contains({lines.film_x[i], lines.film_y[i]}, lines.pupil_x[i], lines.pupil_y[i], wavelength));
    }
    return;
  }
  const std::int32_t position = data_->known(wavelength);
  data_->with_grid<double>([&](const auto& grid) {
    std::int32_t sector = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const PolygonAt polygon(grid, {lines.film_x[i], lines.film_y[i]}, position);
      const Point<double> q = polygon.to_grid(lines.pupil_x[i], lines.pupil_y[i]);
      clearances[i] = polygon.cell.known ? polygon.clearance(q, sector) : -1;
    }
  });
}

Vec2<double> FilmPupilTable::position(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->position(film, x, y, wavelength);
  return data_->with_grid<double>([&](const auto& grid) -> Vec2<double> {
    const PolygonAt polygon(grid, film, data_->known(wavelength));
    const auto& cell = polygon.cell;
    if (!cell.known) return {0, 2};
    if (polygon.samples_iris()) {
      const auto p = stop_point<double>(grid, cell, stop_at<double>(grid, cell), {x, y});
      return data_->stop->shape.position(p.x, p.y);
    }
    return with_kind(grid, [&](auto obscured, auto stopped) -> Vec2<double> {
      const auto at = locate<obscured.value, stopped.value, double>(grid, cell, {x, y});
      const Sector<double>& sector = at.line.sector;
      if (!at.faced) return {0, 2};
      const auto [first, last] = at.part;
      const double own = sector.fraction_within(at.squared_radius);
      const double v = !stopped.value ? own : last > first && own >= first ? (own - first) / (last - first) : 2;
      return {grid.chart.u_of(cell, (at.line.k + at.line.along) / static_cast<double>(polygon_corners)), v};
    });
  });
}

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength,
                                   Derivatives& by) const noexcept {
  const PupilSample result = sample(film, u, v, wavelength);
  by = {};
  if (const auto& images = data_->images) {
    by = images->derivatives(film, result, wavelength);
  } else if (result.area > 0) {
    data_->with_grid<double>([&](const auto& grid) { by = motion_of_middle(grid, film, data_->known(wavelength)); });
  }
  return result;
}

FilmPupilTable::Derivatives FilmPupilTable::derivatives(const FilmPoint& film, double u, double v,
                                                        Wavelength wavelength) const noexcept {
  Derivatives by;
  sample(film, u, v, wavelength, by);
  return by;
}

#define PETZVAL_FILM_PUPILS(T)                                                                                         \
  template PETZVAL_API void FilmPupilTable::contains(std::size_t, const TwoPlaneRays<const T>&, const RayWavelengths&, \
                                                     std::uint8_t*) const noexcept;                                    \
  template PETZVAL_API void FilmPupilTable::sample_areas(std::size_t, const TwoPlaneRays<const T>&,                    \
                                                         const RayWavelengths&, T*) const noexcept;                    \
  template PETZVAL_API void FilmPupilTable::stop_points(std::size_t, const TwoPlaneRays<const T>&,                     \
                                                        const RayWavelengths&, T*, T*) const noexcept;                 \
  template PETZVAL_API void FilmPupilTable::sample(std::size_t, const T*, const T*, const T*, const T*,                \
                                                   const RayWavelengths&, T*, T*, T*) const noexcept;
PETZVAL_FILM_PUPILS(float)
PETZVAL_FILM_PUPILS(double)
#undef PETZVAL_FILM_PUPILS

}  // namespace petzval
