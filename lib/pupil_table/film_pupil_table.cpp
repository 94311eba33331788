// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil_table/film_pupil_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/dual.hpp"
#include "film_pupil_data.hpp"
#include "pupil/line_extents.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;
using L = StripLayout;

}  // namespace

const TwoPlanes& FilmPupilTable::space() const noexcept { return data_->space; }
double FilmPupilTable::film_radius() const noexcept { return data_->film_radius; }
double FilmPupilTable::lit_radius() const noexcept {
  const bool everywhere = data_->images || (data_->cells && !data_->bladed());
  return everywhere ? film_radius() : data_->lit_radius;
}
std::size_t FilmPupilTable::wavelengths() const noexcept { return data_->wavelengths; }
std::size_t FilmPupilTable::primary_wavelength() const noexcept { return data_->primary; }
bool FilmPupilTable::covers(Wavelength wavelength) const noexcept {
  return data_->position(wavelength) < data_->wavelengths;
}

FilmPupilArrays FilmPupilTable::arrays() const {
  static_assert(L::size == FilmPupilArrays::strip_size && L::obscured == 528 && L::sectors == 8);
  FilmPupilArrays result;
  result.film_radius = lit_radius();
  if (const auto& images = data_->images) {
    images->put(result);
  } else if (const auto& cells = data_->cells) {
    cells->put(result);
  } else {
    result.pupils = data_->single;
    result.strips = data_->strips_each;
  }
  return result;
}

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->sample(film, u, v, wavelength);
  const std::size_t position = data_->position(wavelength);
  const std::int32_t known = position < data_->wavelengths ? static_cast<std::int32_t>(position) : -1;
  const auto& [strips, cells, bladed, find_nearest] = pupil_table_detail::film_pupil_table();
  if (!data_->cells) return strips.one(data_->table<double>(), film.x, film.y, u, v, known);
  return data_->bladed() ? bladed.one(data_->cells->bladed_table<double>(), film.x, film.y, u, v, known)
                         : cells.one(data_->cells->table<double>(), film.x, film.y, u, v, known);
}

template <class T>
void FilmPupilTable::sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
                            const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept {
  if (wavelengths.in_nm() && !data_->images) {
    data_->by_nearest(count, wavelengths, [&](std::size_t o, std::size_t n, const RayWavelengths& nearest) {
      sample(n, film_x + o, film_y + o, u + o, v + o, nearest, x + o, y + o, areas + o);
    });
    return;
  }
  if (data_->images) {
    data_->images->sample(count, film_x, film_y, u, v, wavelengths, x, y, areas);
    return;
  }
  const auto& [strips, cells, bladed, find_nearest] = pupil_table_detail::film_pupil_table();
  const auto run = [&](const auto& loops, const auto& table) {
    if constexpr (sizeof(T) == sizeof(float)) {
      loops.single(table, count, film_x, film_y, u, v, wavelengths, x, y, areas);
    } else {
      loops.twice(table, count, film_x, film_y, u, v, wavelengths, x, y, areas);
    }
  };
  if (data_->bladed()) {
    run(bladed, data_->cells->bladed_table<T>());
  } else if (data_->cells) {
    run(cells, data_->cells->table<T>());
  } else {
    run(strips, data_->table<T>());
  }
}

double FilmPupilTable::area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->area(film, wavelength);
  if (const auto& cells = data_->cells) return cells->area(film, data_->position(wavelength));
  const auto found = data_->find(film, wavelength);
  return found.strip ? std::max(found.polygon().area_before(polygon_corners), 0.0) : 0;
}

double FilmPupilTable::projected_solid_angle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  const double own = area(film, wavelength);
  if (!(own > 0)) return 0;
  return solid_angle(space(), film, own, [&](double u, double v) {
    const PupilSample s = sample(film, u, v, wavelength);
    return Vec2<double>{s.x, s.y};
  });
}

Vec2<double> FilmPupilTable::middle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->middle(film, wavelength);
  if (const auto& cells = data_->cells) return cells->middle(film, data_->position(wavelength));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return {0, 0};
  const double y = strip[L::middle_y] + t * strip[L::middle_y + 1];
  return {sine * y, cosine * y};
}

bool FilmPupilTable::contains(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->contains(film, x, y, wavelength);
  if (const auto& cells = data_->cells) return cells->contains(film, x, y, data_->position(wavelength));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return false;
  const InStrip<double> polygon{strip, t};
  return contains_place(polygon, Point<double>{cosine * x - sine * y, sine * x + cosine * y} - polygon.middle());
}

void FilmPupilTable::clearances(std::size_t count, const TwoPlaneRays<const double>& lines, Wavelength wavelength,
                                double* clearances) const noexcept {
  const std::size_t position = data_->position(wavelength);
  std::size_t sector = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint film{lines.film_x[i], lines.film_y[i]};
    const double x = lines.pupil_x[i], y = lines.pupil_y[i];
    if (data_->images) {
      clearances[i] = pupil_detail::clearance_of(contains(film, x, y, wavelength));
    } else if (data_->cells) {
      clearances[i] = data_->cells->clearance(film, x, y, position, sector);
    } else if (const auto [strip, t, cosine, sine] = data_->find(film, position); strip) {
      const InStrip<double> polygon{strip, t};
      const Point<double> place{cosine * x - sine * y, sine * x + cosine * y};
      clearances[i] = clearance_of_place(polygon, place - polygon.middle(), sector);
    } else {
      clearances[i] = -1;
    }
  }
}

Vec2<double> FilmPupilTable::position(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->position(film, x, y, wavelength);
  if (const auto& cells = data_->cells) return cells->position(film, x, y, data_->position(wavelength));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return {0, 2};
  const InStrip<double> polygon{strip, t};
  const auto [share, v] =
      position_of_place(polygon, Point<double>{cosine * x - sine * y, sine * x + cosine * y} - polygon.middle());
  const double u = share + turn_of(sine, cosine);
  return {u - std::floor(u), v};
}

template <class T>
void FilmPupilTable::contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                              std::uint8_t* within) const noexcept {
  if (wavelengths.in_nm() && !data_->images) {
    data_->by_nearest(count, wavelengths, [&](std::size_t o, std::size_t n, const RayWavelengths& nearest) {
      contains(n, lines.from(o), nearest, within + o);
    });
    return;
  }
  if (data_->images) {
    data_->images->contains(count, lines, wavelengths, within);
    return;
  }
  const auto& [film_x, film_y, x, y] = lines;
  constexpr std::size_t few = 4;
  if (count < few) {
    for (std::size_t i = 0; i < count; ++i) {
      within[i] = contains(FilmPoint{film_x[i], film_y[i]}, x[i], y[i], wavelengths.position(i, data_->primary));
    }
    return;
  }
  const auto& [strips, cells, bladed, find_nearest] = pupil_table_detail::film_pupil_table();
  const auto run = [&, film_x = film_x, film_y = film_y, x = x, y = y](const auto& loops, const auto& table) {
    if constexpr (sizeof(T) == sizeof(float)) {
      loops.contains_single(table, count, film_x, film_y, x, y, wavelengths, within);
    } else {
      loops.contains_twice(table, count, film_x, film_y, x, y, wavelengths, within);
    }
  };
  if (data_->bladed()) {
    run(bladed, data_->cells->bladed_table<T>());
  } else if (data_->cells) {
    run(cells, data_->cells->table<T>());
  } else {
    run(strips, data_->table<T>());
  }
}

FilmPupilTable::Derivatives FilmPupilTable::derivatives(const FilmPoint& film, double u, double v,
                                                        Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->derivatives(film, u, v, wavelength);
  if (const auto& cells = data_->cells) return cells->derivatives(film, u, v, data_->position(wavelength));
  using kernel::Dual;
  if (data_->strips_per_mm == 0) return {};
  // On the axis the directions around it meet: beside it is near enough.
  const double beside = 1e-4 * data_->film_radius;
  const bool on_axis = std::hypot(film.x, film.y) < beside;
  const FilmPoint at = on_axis ? FilmPoint{0, beside} : film;
  const auto found = data_->find(at, wavelength);
  if (!found.strip || !(u - u == 0 && v - v == 0)) return {};
  u = std::clamp(u, 0.0, 1.0);
  v = std::clamp(v, 0.0, 1.0);
  const Dual x(at.x, 0), y(at.y, 1);
  const Dual r = sqrt(x * x + y * y);
  Dual t = r * data_->strips_per_mm;
  t.a = found.t;
  const Dual cosine = y / r, sine = x / r;
  Dual share(u);
  share -= turn_of(sine, cosine);
  if (share.a < 0) share += 1.0;
  if (share.a >= 1) share -= 1.0;
  const double whole = found.polygon().area_before(polygon_corners);
  if (!(whole > 0)) return {};
  const std::size_t k = sector_with(found.polygon(), share.a * whole);
  const InStrip<Dual> polygon{found.strip, t};
  const auto [px, py] = polygon.middle() + sample_place(polygon, k, share, v);
  const Dual qx = cosine * px + sine * py, qy = cosine * py - sine * px;
  return {{qx.v[0], qy.v[0]}, {qx.v[1], qy.v[1]}};
}

template PETZVAL_API void FilmPupilTable::contains(std::size_t, const TwoPlaneRays<const float>&, const RayWavelengths&,
                                                   std::uint8_t*) const noexcept;
template PETZVAL_API void FilmPupilTable::contains(std::size_t, const TwoPlaneRays<const double>&,
                                                   const RayWavelengths&, std::uint8_t*) const noexcept;
template PETZVAL_API void FilmPupilTable::sample(std::size_t, const float*, const float*, const float*, const float*,
                                                 const RayWavelengths&, float*, float*, float*) const noexcept;
template PETZVAL_API void FilmPupilTable::sample(std::size_t, const double*, const double*, const double*,
                                                 const double*, const RayWavelengths&, double*, double*,
                                                 double*) const noexcept;

}  // namespace petzval
