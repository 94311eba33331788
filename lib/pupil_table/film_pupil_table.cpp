// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil_table/film_pupil_table.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/quadrature.hpp"
#include "core/text.hpp"
#include "film_polygons.hpp"
#include "film_pupil_table_loops.hpp"
#include "iris_images.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0 {
namespace {

using namespace pupil_table_detail;
using L = StripLayout;

/// A strip from the polygons at its sides.
std::array<double, L::size> strip_between(const PupilPolygon& p, const PupilPolygon& q) {
  std::array<double, L::size> strip;
  const auto put = [&](std::size_t at, const Point<double>& from, const Point<double>& change) {
    strip[at] = from.x, strip[at + 1] = from.y, strip[at + 2] = change.x, strip[at + 3] = change.y;
  };
  strip[L::middle_y] = p.middle[1], strip[L::middle_y + 1] = q.middle[1] - p.middle[1];
  std::array<double, 4> before{0, 0, 0, 0};
  for (std::size_t k = 0; k <= polygon_corners; ++k) {
    const Sector<double> from = p.sector(k % polygon_corners), to = q.sector(k % polygon_corners);
    const Point<double> a_change = to.a - from.a, b_change = to.b - from.b;
    put(L::sectors + L::sector * k, from.a, a_change);
    std::copy(before.begin(), before.end(), &strip[L::sectors + L::sector * k + 4]);
    if (k == polygon_corners) break;
    put(L::obscured + 4 * k, {from.obscured_from, from.obscured},
        {to.obscured_from - from.obscured_from, to.obscured - from.obscured});
    // Half of turn(a + t a', b + t b'), times what is not obscured.
    const double c[3] = {turn(from.a, from.b) / 2, (turn(from.a, b_change) + turn(a_change, from.b)) / 2,
                         turn(a_change, b_change) / 2};
    const double left = 1 - from.obscured, change = from.obscured - to.obscured;
    before[0] += c[0] * left;
    before[1] += c[1] * left + c[0] * change;
    before[2] += c[2] * left + c[1] * change;
    before[3] += c[2] * change;
  }
  std::copy(before.begin(), before.end(), &strip[L::whole]);
  return strip;
}

/// Area before a sector at the fraction t of a strip; `polygon_corners`: the whole.
template <class T>
T area_before(const double* strip, std::size_t sector, const T& t) {
  const double* f = strip + L::sectors + L::sector * sector + 4;
  return f[0] + t * (f[1] + t * (f[2] + t * f[3]));
}

/// A pair of numbers at the fraction t.
template <class T>
Point<T> along_strip(const double* from, const T& t) {
  return {from[0] + t * from[2], from[1] + t * from[3]};
}

template <class T>
Sector<T> sector_at(const double* strip, std::size_t k, const T& t) {
  const Point<T> obscured = along_strip(strip + L::obscured + 4 * k, t);
  return {along_strip(strip + L::sectors + L::sector * k, t), along_strip(strip + L::sectors + L::sector * (k + 1), t),
          obscured.x, obscured.y};
}

/// The sector in which a sample lies. area: before it.
std::size_t sector_with(const double* strip, double t, double area) {
  return sector_of_area(area, [&](std::size_t k) { return area_before(strip, k, t); });
}

/// The place of a sample for film points on +y at the fraction t of a strip, in the sector k.
template <class T>
Point<T> place(const double* strip, std::size_t k, const T& t, const T& u, double v) {
  using std::sqrt;
  const Sector<T> sector = sector_at(strip, k, t);
  T along = (area_before(strip, polygon_corners, t) * u - area_before(strip, k, t)) / sector.area();
  if (!(along <= 1.0)) along = T(1.0);
  const T squared = sector.squared_way(T(v));
  const Point<T> p = sector.at(squared > 0.0 ? T(sqrt(squared)) : T(0.0), along);  // no derivative in the middle
  return {p.x, strip[L::middle_y] + t * strip[L::middle_y + 1] + p.y};
}

}  // namespace

struct FilmPupilTable::Data {
  TwoPlanes space;
  double film_radius = 0;
  std::size_t wavelengths = 0, primary = 0;
  std::optional<IrisImages> images;  // instead of strips
  double lit_radius = 0;             // to which the strips reach: beyond it is dark
  std::size_t strips_each = 0;
  bool turned = true, obscured = false;
  int corrections = 0;
  std::vector<double> twice;  // strips by StripLayout
  std::vector<float> single;

  /// Adds a wavelength. Without symmetry there is one polygon.
  void add(const std::vector<PupilPolygon>& polygons) {
    ++wavelengths;
    strips_each = std::max<std::size_t>(polygons.size() - 1, 1);
    for (std::size_t i = 0; i < strips_each; ++i) {
      const PupilPolygon &a = polygons[i], &b = polygons[std::min(i + 1, polygons.size() - 1)];
      const auto strip = strip_between(a, b);
      twice.insert(twice.end(), strip.begin(), strip.end());
      for (const double value : strip) single.push_back(static_cast<float>(value));
      for (std::size_t k = 0; k < polygon_corners; ++k) obscured = obscured || a.obscured[k] > 0 || b.obscured[k] > 0;
      count_corrections(strip.data());
    }
  }

  void count_corrections(const double* strip) {
    for (int step = 0; step <= 8; ++step) {
      const double t = step / 8.0, whole = area_before(strip, polygon_corners, t);
      if (!(whole > 0)) continue;
      for (std::size_t k = 0; k < polygon_corners; ++k) {
        const double off = std::abs(area_before(strip, k, t) / whole * polygon_corners - static_cast<double>(k));
        if (off > 0.49) corrections = std::max(corrections, std::min(static_cast<int>(std::ceil(off)), 64));
      }
    }
  }

  /// 0 for a film of the axis alone; a smaller one than 1e-30 mm counts as that, so that this is finite in float too.
  double strips_per_mm() const noexcept {
    constexpr double smallest = 1e-30;
    return lit_radius > smallest ? static_cast<double>(strips_each) / lit_radius : 0;
  }

  template <class R>
  StripTable<R> table() const noexcept {
    StripTable<R> result;
    if constexpr (sizeof(R) == sizeof(float)) {
      result.strips = single.data();
    } else {
      result.strips = twice.data();
    }
    result.count = strips_each;
    result.wavelengths = wavelengths;
    result.primary = primary;
    // The corner itself, rounded, still belongs to the film.
    result.lit_radius = static_cast<R>(lit_radius * (1 + 1e-6));
    result.strips_per_mm = static_cast<R>(strips_per_mm());
    result.turned = turned;
    result.obscured = obscured;
    result.corrections = corrections;
    return result;
  }

  /// Where a film point stands in the table.
  struct Place {
    const double* strip = nullptr;  // null: nowhere
    double t = 0, cosine = 1, sine = 0;
  };
  Place find(const FilmPoint& film, Wavelength at_wavelength) const noexcept {
    const std::size_t wavelength = at_wavelength.position(primary);
    const double r = std::sqrt(film.x * film.x + film.y * film.y);
    if (!(r <= lit_radius * (1 + 1e-6)) || wavelength >= wavelengths) return {};
    const double at = r * strips_per_mm();
    const std::size_t strip = std::min(static_cast<std::size_t>(at), strips_each - 1);
    const bool turn = turned && r > 0;
    return {&twice[(wavelength * strips_each + strip) * L::size], at - static_cast<double>(strip),
            turn ? film.y / r : 1, turn ? film.x / r : 0};
  }

  /// u, from the film point's own direction.
  double share(const Place& place, double u) const noexcept {
    if (!turned) return u;
    const double from = u - turn_of(place.sine, place.cosine);
    return from < 0 ? from + 1 : from < 1 ? from : from - 1;
  }
};

namespace {

/// The projected solid angle of a pupil from uniform samples of it: place_at(u, v).
template <class PlaceAt>
double solid_angle(const TwoPlanes& space, const FilmPoint& film, double area, const PlaceAt& place_at) noexcept {
  constexpr int around = 16;
  static const auto outwards = core_detail::gauss_legendre<4>();
  const double depth2 = space.depth() * space.depth();
  double sum = 0;
  for (int k = 0; k < around; ++k) {
    for (const auto& [v, weight] : outwards) {
      const Vec2<double> place = place_at((k + 0.5) / around, v);
      const double dx = place.x - film.x, dy = place.y - film.y, length2 = dx * dx + dy * dy + depth2;
      sum += weight / (length2 * length2);
    }
  }
  return area * depth2 * sum / around;
}

void check_film_radius(const std::string& where, double film_radius) {
  if (film_radius >= 0 && std::isfinite(film_radius)) return;
  throw Error(where + ": film: its radius is " + to_text(film_radius) + " mm, wanted a finite one, 0 or more");
}

}  // namespace

FilmPupilTable FilmPupilTable::traced(const Lens& lens, double film_radius, bool enclosing) {
  const PolygonFit fit = enclosing ? PolygonFit::enclosing : PolygonFit::equal_area;
  check_film_radius(lens.name(), film_radius);
  auto data = std::make_shared<Data>();
  data->space = two_planes(lens);
  data->film_radius = film_radius;
  data->primary = lens.primary_wavelength();
  data->turned = lens.rotationally_symmetric();
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  data->lit_radius = data->turned ? 0 : film_radius;
  for (std::size_t w = 0; w < wavelengths && data->lit_radius < film_radius; ++w) {
    const double lit = lit_radius(film_radius, traced_pupils(lens, data->space, w));
    data->lit_radius = std::max(data->lit_radius, lit);
  }
  for (std::size_t w = 0; w < wavelengths; ++w) {
    if (data->turned) {
      data->add(film_polygons(data->lit_radius, fit, traced_pupils(lens, data->space, w)));
    } else {
      data->add({{polygon_for_all(lens, data->space, film_radius, w)}});
    }
  }
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::enclosing(const Lens& lens, double film_radius) {
  // Whatever its shape, the iris lies within the round stop: the pupils of that enclose its own.
  return traced(with_iris(lens, {}), film_radius, true);
}

FilmPupilTable FilmPupilTable::equal_area(const Lens& lens, double film_radius) {
  if (!lens.rotationally_symmetric()) {
    throw Error(
        lens.name() +
        ": pupils: the lens has cylinders or an iris with edges, wanted one of revolution for pupils by distance "
        "alone");
  }
  return traced(lens, film_radius, false);
}

FilmPupilTable FilmPupilTable::of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                        double film_radius, std::size_t primary_wavelength) {
  check_film_radius("pupil table", film_radius);
  auto data = std::make_shared<Data>();
  data->primary = primary_wavelength;
  data->space = space;
  data->film_radius = data->lit_radius = film_radius;
  for (const std::vector<PupilDisc>& set : discs) data->add(disc_polygons(set, film_radius));
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::reshaped(std::span<const std::vector<PupilDisc>> discs) const {
  auto data = std::make_shared<Data>();
  data->space = data_->space;
  data->film_radius = data->lit_radius = film_radius();
  data->primary = primary_wavelength();
  for (std::size_t w = 0; w < discs.size(); ++w) {
    std::vector<PupilPolygon> polygons = disc_polygons(discs[w], film_radius());
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const FilmPoint film{0, film_radius() * static_cast<double>(i) / film_strips};
      const double wanted = projected_solid_angle(film, w);
      // The solid angle grows with the square of the scale, nearly.
      for (int round = 0; round < 3; ++round) {
        const PolygonSampler sampler(polygons[i]);
        const double own = solid_angle(space(), film, sampler.area(), sampler);
        const double scale = own > 0 ? std::sqrt(wanted / own) : 0;
        for (auto& corner : polygons[i].corners) corner = {scale * corner[0], scale * corner[1]};
      }
    }
    data->add(polygons);
  }
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::of_iris(const TwoPlanes& space, const Iris& iris, std::span<const PupilDisc> images,
                                       double film_radius, std::size_t primary_wavelength) {
  check_film_radius("pupil table", film_radius);
  auto data = std::make_shared<Data>();
  data->space = space;
  data->film_radius = film_radius;
  data->wavelengths = images.size();
  data->primary = primary_wavelength;
  data->images.emplace(iris, images, film_radius, primary_wavelength);
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::for_tilted_film(const FilmTilt& tilt) const {
  check_film_radius("tilted film", tilt.radius);
  auto data = std::make_shared<Data>();
  if (data_->images && tilt.travel == 0) {
    *data = *data_;
    data->film_radius = tilt.radius;
    data->images = data_->images->tilted(tilt);
    return FilmPupilTable(std::move(data));
  }
  if (!data_->turned) {  // the one pupil holds all lines
    *data = *data_;
    data->film_radius = data->lit_radius = tilt.radius;
    return FilmPupilTable(std::move(data));
  }
  data->space = data_->space;
  data->primary = data_->primary;
  data->film_radius = tilt.radius;
  for (std::size_t w = 0; w < wavelengths() && data->lit_radius < tilt.radius; ++w) {
    const double lit = lit_radius(tilt.radius, tilted_film_pupils(*this, tilt, w));
    data->lit_radius = std::max(data->lit_radius, lit);
  }
  for (std::size_t w = 0; w < wavelengths(); ++w) {
    data->add(film_polygons(data->lit_radius, PolygonFit::enclosing, tilted_film_pupils(*this, tilt, w)));
  }
  return FilmPupilTable(std::move(data));
}

const TwoPlanes& FilmPupilTable::space() const noexcept { return data_->space; }
double FilmPupilTable::film_radius() const noexcept { return data_->film_radius; }
std::size_t FilmPupilTable::wavelengths() const noexcept { return data_->wavelengths; }
std::size_t FilmPupilTable::primary_wavelength() const noexcept { return data_->primary; }

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->sample(film, u, v, wavelength.position(data_->primary));
  const auto found = data_->find(film, wavelength);
  if (!found.strip || !(u - u == 0 && v - v == 0)) return {};
  const double whole = area_before(found.strip, polygon_corners, found.t);
  if (!(whole > 0)) return {};
  const double share = data_->share(found, std::clamp(u, 0.0, 1.0));
  const std::size_t k = sector_with(found.strip, found.t, share * whole);
  const auto [x, y] = place(found.strip, k, found.t, share, std::clamp(v, 0.0, 1.0));
  return {found.cosine * x + found.sine * y, found.cosine * y - found.sine * x, whole};
}

template <class T>
void FilmPupilTable::sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
                            const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept {
  if (data_->images) {
    data_->images->sample(count, film_x, film_y, u, v, wavelengths, x, y, areas);
    return;
  }
  const auto& loops = pupil_table_detail::film_pupil_table();
  if constexpr (sizeof(T) == sizeof(float)) {
    loops.single(data_->table<T>(), count, film_x, film_y, u, v, wavelengths, x, y, areas);
  } else {
    loops.twice(data_->table<T>(), count, film_x, film_y, u, v, wavelengths, x, y, areas);
  }
}

double FilmPupilTable::area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->area(film, wavelength.position(data_->primary));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return 0;
  return std::max(area_before(strip, polygon_corners, t), 0.0);
}

double FilmPupilTable::projected_solid_angle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  return solid_angle(space(), film, area(film, wavelength), [&](double u, double v) {
    const PupilSample s = sample(film, u, v, wavelength);
    return Vec2<double>{s.x, s.y};
  });
}

Vec2<double> FilmPupilTable::middle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->middle(film, wavelength.position(data_->primary));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return {0, 0};
  const double y = strip[L::middle_y] + t * strip[L::middle_y + 1];
  return {sine * y, cosine * y};
}

bool FilmPupilTable::contains(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->contains(film, x, y, wavelength.position(data_->primary));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return false;
  const Point<double> q{cosine * x - sine * y, sine * x + cosine * y - strip[L::middle_y] - t * strip[L::middle_y + 1]};
  const auto sectors = [strip = strip, t = t](std::size_t k) { return sector_at(strip, k, t); };
  const std::size_t k = sector_facing(q, sectors);
  if (k == polygon_corners) return false;
  const Sector<double> sector = sectors(k);
  const double way = sector.way_to(q), squared = way * way;
  return squared <= 1 && !sector.obscures(squared);
}

template <class T>
void FilmPupilTable::contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                              std::uint8_t* within) const noexcept {
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
  const auto& loops = pupil_table_detail::film_pupil_table();
  if constexpr (sizeof(T) == sizeof(float)) {
    loops.contains_single(data_->table<T>(), count, film_x, film_y, x, y, wavelengths, within);
  } else {
    loops.contains_twice(data_->table<T>(), count, film_x, film_y, x, y, wavelengths, within);
  }
}

FilmPupilTable::Derivatives FilmPupilTable::derivatives(const FilmPoint& film, double u, double v,
                                                        Wavelength wavelength) const noexcept {
  if (const auto& images = data_->images) return images->derivatives(film, u, v, wavelength.position(data_->primary));
  using Jet = ceres::Jet<double, 2>;
  if (data_->strips_per_mm() == 0) return {};
  // On the axis the directions around it meet: beside it is near enough.
  const double beside = 1e-4 * data_->film_radius;
  const bool on_axis = std::hypot(film.x, film.y) < beside;
  const FilmPoint at = on_axis ? FilmPoint{0, beside} : film;
  const auto found = data_->find(at, wavelength);
  if (!found.strip || !(u - u == 0 && v - v == 0)) return {};
  u = std::clamp(u, 0.0, 1.0);
  v = std::clamp(v, 0.0, 1.0);
  const Jet x(at.x, 0), y(at.y, 1);
  const bool turn = data_->turned;
  const Jet r = sqrt(x * x + y * y);
  Jet t = r * data_->strips_per_mm();
  t.a = found.t;
  const Jet cosine = turn ? y / r : Jet(1), sine = turn ? x / r : Jet(0);
  Jet share(u);
  if (turn) {
    share -= turn_of(sine, cosine);
    if (share.a < 0) share += 1.0;
    if (share.a >= 1) share -= 1.0;
  }
  const double whole = area_before(found.strip, polygon_corners, t.a);
  if (!(whole > 0)) return {};
  const std::size_t k = sector_with(found.strip, t.a, share.a * whole);
  const auto [px, py] = place(found.strip, k, t, share, v);
  const Jet qx = cosine * px + sine * py, qy = cosine * py - sine * px;
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

}  // namespace petzval::inline v0
