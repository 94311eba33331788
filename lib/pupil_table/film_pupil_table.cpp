// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/film_pupil_table.hpp"

#include <algorithm>
#include <cmath>

#include "film_pupil_data.hpp"
#include "petzval/core/error.hpp"
#include "polygon_blocks.hpp"
#include "polygon_clearance.hpp"
#include "pupil/line_extents.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

template <int dimensions>
std::pair<CellPosition<double>, CellPolygon<dimensions, true, double, double>> find(
    const PolygonGrid<dimensions, double>& grid, const FilmPoint& film, std::int32_t wavelength) noexcept {
  const CellPosition<double> at = cell_position(grid, film.x, film.y, 1, wavelength);
  return {at, {grid.cells, at.cell * CellLayout<dimensions>::size, at.t, at.s}};
}

/// Derivatives of the middle of a polygon by its film point.
FilmPupilTable::Derivatives motion_of_middle(const PolygonGrid<1, double>& grid, const FilmPoint& film,
                                             std::int32_t wavelength) noexcept {
  const auto [at, polygon] = find(grid, film, wavelength);
  const double r = std::hypot(film.x, film.y);
  const double along = grid.cells[polygon.begin + CellLayout<1>::middle + 3] * grid.rows_per_mm;
  // In the first row the quotient would be inaccurate near the axis.
  const double across = r * grid.rows_per_mm >= 1 ? polygon.middle().y / r : along;
  const double mixed = (along - across) * at.sine * at.cosine;
  return {{along * at.sine * at.sine + across * at.cosine * at.cosine, mixed},
          {mixed, along * at.cosine * at.cosine + across * at.sine * at.sine}};
}
FilmPupilTable::Derivatives motion_of_middle(const PolygonGrid<2, double>& grid, const FilmPoint& film,
                                             std::int32_t wavelength) noexcept {
  const auto found = find(grid, film, wavelength);
  const CellPosition<double>& at = found.first;
  const std::int32_t begin = found.second.begin;
  const std::int32_t row = at.cell / grid.columns % grid.rows, column = at.cell % grid.columns;
  const double* const half = grid.half_widths + row;
  const double change = half[1] - half[0], width = half[0] + at.s * change, columns = grid.columns;
  const double t_by_x = width > 0 ? columns / width : 0;
  const double t_by_y = width > 0 ? -(column + at.t) * change * grid.rows_per_mm / width : 0;
  const auto by = [&](std::int32_t axis) {
    const double* const value = grid.cells + begin + CellLayout<2>::middle + 4 * axis;
    const double by_t = value[1] + at.s * value[3], by_s = value[2] + at.t * value[3];
    return Vec2<double>{by_t * t_by_x, by_s * grid.rows_per_mm + by_t * t_by_y};
  };
  const Vec2<double> x = by(0), y = by(1);
  const double sign = at.sine * at.cosine;
  return {{x.x, sign * y.x}, {sign * x.y, y.y}};
}

}  // namespace

const TwoPlanes& FilmPupilTable::space() const noexcept { return data_->space; }
double FilmPupilTable::film_radius() const noexcept { return data_->film_radius; }
double FilmPupilTable::lit_radius() const noexcept { return data_->images ? film_radius() : data_->reach; }
std::size_t FilmPupilTable::wavelengths() const noexcept { return data_->wavelengths; }
std::size_t FilmPupilTable::primary_wavelength() const noexcept { return data_->primary; }
bool FilmPupilTable::covers(Wavelength wavelength) const noexcept {
  return data_->position(wavelength) < data_->wavelengths;
}
bool FilmPupilTable::knows_stop() const noexcept { return data_->stop != nullptr; }

FilmPupilArrays FilmPupilTable::arrays() const {
  if (data_->images) throw Error("pupils: arrays: the pupils have a closed form; must be polygons");
  FilmPupilArrays result;
  const auto put = [&](const auto& grid) {
    using Layout = CellLayout<std::decay_t<decltype(grid)>::dimensions>;
    result.reach = grid.reach, result.rows_per_mm = grid.rows_per_mm;
    result.obscured = grid.obscured, result.corrections = grid.corrections;
    result.cell_size = grid.obscured ? Layout::size : Layout::obscured;
    for (std::size_t begin = 0; begin < data_->cells_single.size(); begin += Layout::size) {
      const auto cell = data_->cells_single.begin() + static_cast<std::ptrdiff_t>(begin);
      result.cells.insert(result.cells.end(), cell, cell + static_cast<std::ptrdiff_t>(result.cell_size));
    }
    if (!data_->stop) return;
    result.stops = data_->stop->cells_single;
    result.stop_size = StopLayout<std::decay_t<decltype(grid)>::dimensions>::size;
    const auto& iris = grid.stop.iris;
    result.iris_area = grid.stop.area;
    const auto add = [&](const float* from, std::size_t count) {
      result.iris.insert(result.iris.end(), from, from + count);
    };
    constexpr std::size_t terms = iris_detail::edge_terms<float>;
    if (iris.count > 0) add(iris.across, terms), add(iris.along, terms), add(iris.turns, 2 * iris.count);
    if (iris.count > 0) add(iris.edges, 4 * iris.count);
  };
  data_->dimensions == 1 ? put(data_->grid<1, float>()) : put(data_->grid<2, float>());
  result.dimensions = data_->dimensions;
  result.rows = data_->rows, result.columns = data_->columns;
  result.half_widths = data_->half_widths_single;
  return result;
}

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->sample(film, u, v, wavelength);
  PupilSample result;
  data_->with_grid<double>([&](const auto& grid, const auto&) {
    sample_loops<std::decay_t<decltype(grid)>::dimensions>().one(grid, film.x, film.y, u, v, data_->known(wavelength),
                                                                 result.x, result.y, result.area);
  });
  return result;
}

template <class T>
void FilmPupilTable::sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
                            const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept {
  if (data_->images) {
    data_->images->sample(count, film_x, film_y, u, v, wavelengths, x, y, areas);
    return;
  }
  data_->by_position(count, wavelengths, [&](std::size_t o, std::size_t n, const RayWavelengths& known) {
    data_->with_grid<T>([&](const auto& grid, const auto&) {
      const auto& loops = sample_loops<std::decay_t<decltype(grid)>::dimensions>().template of<T>();
      loops.sample(grid, n, film_x + o, film_y + o, u + o, v + o, known, x + o, y + o, areas + o);
    });
  });
}

double FilmPupilTable::polygon_area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->area_of_stop(film, wavelength);
  return data_->with_grid<double>([&](const auto& grid, const auto&) {
    const auto [at, polygon] = find(grid, film, data_->known(wavelength));
    return at.known ? std::max(polygon.total_area(), 0.0) : 0.0;
  });
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
  // If an iris clips the polygon, areas change fast with u.
  return pupil_table_detail::mean_over_samples(data_->stop ? 128 : 16, [&](double u, double v) {
    const PupilSample s = sample(film, u, v, wavelength);
    return s.area > 0 ? s.area * value(s) : 0;
  });
}

Vec2<double> FilmPupilTable::middle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->middle(film, wavelength);
  return data_->with_grid<double>([&](const auto& grid, const auto&) -> Vec2<double> {
    const auto [at, polygon] = find(grid, film, data_->known(wavelength));
    if (!at.known) return {0, 0};
    constexpr int dimensions = std::decay_t<decltype(grid)>::dimensions;
    const Point<double> middle = to_film<dimensions>(at.cosine, at.sine, polygon.middle());
    return {middle.x, middle.y};
  });
}

double FilmPupilTable::sample_area(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) {
    return images->contains(film, x, y, wavelength) ? images->area(film, wavelength) : 0;
  }
  return data_->with_grid<double>([&](const auto& grid, const auto& loops) {
    return loops.area_of_one(grid, film.x, film.y, x, y, data_->known(wavelength));
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
  if (data_->images) {
    data_->images->sample_areas(count, lines, wavelengths, areas);
    return;
  }
  data_->by_position(count, wavelengths, [&](std::size_t o, std::size_t n, const RayWavelengths& known) {
    data_->with_grid<T>([&](const auto& grid, const auto&) {
      const auto [film_x, film_y, x, y] = lines.from(o);
      const auto& loops = sample_loops<std::decay_t<decltype(grid)>::dimensions>().template of<T>();
      loops.areas(grid, n, film_x, film_y, x, y, known, areas + o);
    });
  });
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
  data_->by_position(count, wavelengths, [&](std::size_t o, std::size_t n, const RayWavelengths& known) {
    data_->with_grid<T>([&](const auto& grid, const auto& loops) {
      const auto [film_x, film_y, pupil_x, pupil_y] = lines.from(o);
      loops.template of<T>().stop_points(grid, n, film_x, film_y, pupil_x, pupil_y, known, x + o, y + o);
    });
  });
}

double FilmPupilTable::sampled_iris_scale(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (!data_->stop) return 0;
  return data_->with_grid<double>([&](const auto& grid, const auto&) {
    using S = StopLayout<std::decay_t<decltype(grid)>::dimensions>;
    const auto [at, polygon] = find(grid, film, data_->known(wavelength));
    const double* stop = grid.stop.cells + at.cell * S::size;
    return at.known && stop[S::samples_iris] > 0 ? stop[S::scale] : 0.0;
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
  data_->with_grid<double>([&](const auto& grid, const auto&) {
    constexpr int dimensions = std::decay_t<decltype(grid)>::dimensions;
    std::size_t sector = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [at, polygon] = find(grid, {lines.film_x[i], lines.film_y[i]}, position);
      const Point<double> in_grid =
          to_grid<dimensions>(at.cosine, at.sine, Point<double>{lines.pupil_x[i], lines.pupil_y[i]});
      clearances[i] = at.known ? clearance_at(polygon, in_grid - polygon.middle(), sector) : -1;
    }
  });
}

Vec2<double> FilmPupilTable::position(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->position(film, x, y, wavelength);
  return data_->with_grid<double>([&](const auto& grid, const auto& loops) -> Vec2<double> {
    constexpr int dimensions = std::decay_t<decltype(grid)>::dimensions;
    using S = StopLayout<dimensions>;
    const std::int32_t known = data_->known(wavelength);
    const auto [at, polygon] = find(grid, film, known);
    const double total_area = polygon.total_area();
    if (!at.known || !(total_area > 0)) return {0, 2};
    const double* stop = grid.stop.cells ? grid.stop.cells + at.cell * S::size : nullptr;
    if (stop && stop[S::samples_iris] > 0) {
      double stop_x = 0, stop_y = 0;
      loops.template of<double>().stop_points(grid, 1, &film.x, &film.y, &x, &y, {static_cast<std::size_t>(known)},
                                              &stop_x, &stop_y);
      return data_->stop->shape.position(stop_x / stop[S::scale], stop_y / stop[S::scale]);
    }
    const Point<double> q = to_grid<dimensions>(at.cosine, at.sine, Point<double>{x, y}) - polygon.middle();
    const std::size_t k = sector_towards(polygon, q);
    if (k == polygon_corners) return {0, 2};
    const Sector<double> sector = polygon.sector(static_cast<std::int32_t>(k));
    const double along = sector.along_to(q), radius = sector.relative_radius(q);
    const double fraction = (polygon.area_before(static_cast<std::int32_t>(k)) + along * sector.area()) / total_area;
    double v = sector.fraction_within(radius * radius);
    if (stop) {
      const Point<double> edge = sector.at(1, along);
      const CellPositions<1, double> positions{{at.t}, {at.s}, {at.cosine}, {at.sine}, {1}, {at.cell}};
      Lines<1, double> line{{static_cast<std::int32_t>(k)}, {along}, {edge.x}, {edge.y}, {0}, {1}};
      clip_by_iris<1>(grid, positions, line);
      const double first = sector.fraction_within(line.from[0] * line.from[0]);
      const double last = sector.fraction_within(line.to[0] * line.to[0]);
      v = last > first && v >= first ? (v - first) / (last - first) : 2;
    }
    return {polygon.u_of(fraction, total_area, at.cosine, at.sine), v};
  });
}

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength,
                                   Derivatives& by) const noexcept {
  const PupilSample result = sample(film, u, v, wavelength);
  by = {};
  if (const auto& images = data_->images) {
    by = images->derivatives(film, result, wavelength);
  } else if (result.area > 0) {
    data_->with_grid<double>(
        [&](const auto& grid, const auto&) { by = motion_of_middle(grid, film, data_->known(wavelength)); });
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
