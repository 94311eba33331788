// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/film_pupil_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/dual.hpp"
#include "film_pupil_data.hpp"
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
  FilmPupilArrays result;
  result.film_radius = lit_radius();
  if (const auto& images = data_->images) {
    images->put(result);
    return result;
  }
  result.kind = data_->dimensions == 1 ? FilmPupilArrays::Kind::polar : FilmPupilArrays::Kind::quadrant;
  result.pupils = data_->cells_single;
  result.rows = data_->rows, result.columns = data_->columns;
  result.height = data_->height;
  result.half_widths = data_->half_widths_single;
  if (data_->stop) {
    result.stop = data_->stop->cells_single;
    put_iris(data_->stop->shape, result);
  }
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
  by = {};
  if (const auto& images = data_->images) {
    const PupilSample result = images->sample(film, u, v, wavelength);
    by = images->derivatives(film, result, wavelength);
    return result;
  }
  // The direction of the film point is undefined on the axis: use a point close to the axis.
  const double axis_step = 1e-4 * data_->film_radius;
  if (data_->dimensions == 1 && std::hypot(film.x, film.y) < axis_step) {
    sample({0, axis_step}, u, v, wavelength, by);
    return sample(film, u, v, wavelength);
  }
  using kernel::Dual;
  Dual x, y, area;
  data_->with_grid<double>([&](const auto& grid, const auto& loops) {
    loops.one_with_derivatives(grid, Dual(film.x, 0), Dual(film.y, 1), Dual(u), Dual(v), data_->known(wavelength), x, y,
                               area);
  });
  if (area.a > 0) by = {{x.v[0], y.v[0]}, {x.v[1], y.v[1]}};
  return {x.a, y.a, area.a};
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
