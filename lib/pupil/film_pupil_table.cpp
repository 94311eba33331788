// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/film_pupil_table.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "film_polygons.hpp"
#include "film_pupil_table_loops.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "petzval/pupil/pupil_polygon.hpp"

namespace petzval::inline v0 {
namespace {

using pupil_detail::polygon_corners;
using pupil_detail::PupilPolygon;
using pupil_detail::StripTable;
using L = pupil_detail::StripLayout;

/// A strip from the stars at its sides.
std::array<double, L::size> strip_between(const PupilPolygon& a, const PupilPolygon& b) {
  std::array<double, L::size> strip;
  const auto put = [&](std::size_t at, const std::array<double, 2>& from, const std::array<double, 2>& to) {
    strip[at] = from[0], strip[at + 1] = from[1];
    strip[at + 2] = to[0] - from[0], strip[at + 3] = to[1] - from[1];
  };
  strip[L::middle_y] = a.middle[1], strip[L::middle_y + 1] = b.middle[1] - a.middle[1];
  std::array<double, 4> before{0, 0, 0, 0};
  for (std::size_t k = 0; k <= polygon_corners; ++k) {
    const std::size_t at = k % polygon_corners, next = (k + 1) % polygon_corners;
    put(L::sectors + L::sector * k, a.corners[at], b.corners[at]);
    std::copy(before.begin(), before.end(), &strip[L::sectors + L::sector * k + 4]);
    if (k == polygon_corners) break;
    const double gap[] = {a.gap_from[k], a.gap[k], b.gap_from[k] - a.gap_from[k], b.gap[k] - a.gap[k]};
    std::copy(std::begin(gap), std::end(gap), &strip[L::gaps + 4 * k]);
    // Half of (p + t dp) x (q + t dq), times what the gap leaves.
    const auto turn = [](double px, double py, double qx, double qy) { return qx * py - px * qy; };
    const auto &p = a.corners[at], &q = a.corners[next];
    const double dpx = b.corners[at][0] - p[0], dpy = b.corners[at][1] - p[1];
    const double dqx = b.corners[next][0] - q[0], dqy = b.corners[next][1] - q[1];
    const double c[3] = {turn(p[0], p[1], q[0], q[1]) / 2,
                         (turn(p[0], p[1], dqx, dqy) + turn(dpx, dpy, q[0], q[1])) / 2, turn(dpx, dpy, dqx, dqy) / 2};
    const double left = 1 - a.gap[k], change = a.gap[k] - b.gap[k];
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

/// Place and change by t, at t.
template <class T>
std::array<T, 2> along_strip(const double* from, const T& t) {
  return {from[0] + t * from[2], from[1] + t * from[3]};
}

/// The sector in which the area before a sample lies.
std::size_t sector_with(const double* strip, double t, double area) {
  const double whole = area_before(strip, polygon_corners, t);
  auto k = static_cast<std::size_t>(std::clamp(area / whole, 0.0, 1.0) * polygon_corners);
  k = std::min(k, polygon_corners - 1);
  while (k > 0 && area < area_before(strip, k, t)) --k;
  while (k + 1 < polygon_corners && area >= area_before(strip, k + 1, t)) ++k;
  return k;
}

/// The sample's place for film points on +y at the fraction t of a strip, in the sector k.
template <class T>
std::array<T, 2> place(const double* strip, std::size_t k, const T& t, const T& u, double v) {
  using std::sqrt;
  const auto [ax, ay] = along_strip(strip + L::sectors + L::sector * k, t);
  const auto [bx, by] = along_strip(strip + L::sectors + L::sector * (k + 1), t);
  const T my = strip[L::middle_y] + t * strip[L::middle_y + 1];
  const auto [gap_from, gap] = along_strip(strip + L::gaps + 4 * k, t);
  const T own = 0.5 * (bx * ay - ax * by) * (1.0 - gap);
  T along = (area_before(strip, polygon_corners, t) * u - area_before(strip, k, t)) / own;
  if (!(along <= 1.0)) along = T(1.0);
  const T within = (1.0 - gap) * v;
  const T squared = within < gap_from ? within : T(within + gap);
  const T out = squared > 0.0 ? T(sqrt(squared)) : T(0.0);  // the middle itself has no derivative
  return {out * (ax + along * (bx - ax)), my + out * (ay + along * (by - ay))};
}

}  // namespace

struct FilmPupilTable::Data {
  TwoPlanes space;
  double film_radius = 0;
  double lit_radius = 0;  // to which the strips reach: beyond it is dark
  std::size_t wavelengths = 0, primary = 0, strips_each = 0;
  bool turned = true, gapped = false;
  int corrections = 0;
  std::vector<double> twice;  // strips by StripLayout
  std::vector<float> single;

  /// Adds a wavelength. Without symmetry there is one star.
  void add(const std::vector<PupilPolygon>& stars) {
    ++wavelengths;
    strips_each = std::max<std::size_t>(stars.size() - 1, 1);
    for (std::size_t i = 0; i < strips_each; ++i) {
      const PupilPolygon &a = stars[i], &b = stars[std::min(i + 1, stars.size() - 1)];
      const auto strip = strip_between(a, b);
      twice.insert(twice.end(), strip.begin(), strip.end());
      for (const double value : strip) single.push_back(static_cast<float>(value));
      for (std::size_t k = 0; k < polygon_corners; ++k) gapped = gapped || a.gap[k] > 0 || b.gap[k] > 0;
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

  double strips_per_mm() const noexcept { return lit_radius > 0 ? static_cast<double>(strips_each) / lit_radius : 0; }

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
    result.gapped = gapped;
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
    const double from = u - pupil_detail::turn_of(place.sine, place.cosine);
    return from < 0 ? from + 1 : from < 1 ? from : from - 1;
  }
};

namespace {

void check_film_radius(const std::string& where, double film_radius) {
  if (film_radius >= 0 && std::isfinite(film_radius)) return;
  throw Error(where + ": film: its radius is " + number(film_radius) + " mm, wanted a finite one, 0 or more");
}

}  // namespace

FilmPupilTable FilmPupilTable::traced(const Lens& lens, double film_radius, bool covering) {
  check_film_radius(lens.name(), film_radius);
  auto data = std::make_shared<Data>();
  data->space = two_planes(lens);
  data->film_radius = film_radius;
  data->primary = lens.primary_wavelength();
  data->turned = lens.rotationally_symmetric();
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  data->lit_radius = data->turned ? 0 : film_radius;
  for (std::size_t w = 0; w < wavelengths && data->lit_radius < film_radius; ++w) {
    const double lit = pupil_detail::lit_radius(film_radius, pupil_detail::traced_edges(lens, data->space, w));
    data->lit_radius = std::max(data->lit_radius, lit);
  }
  for (std::size_t w = 0; w < wavelengths; ++w) {
    if (data->turned) {
      data->add(
          pupil_detail::film_polygons(data->lit_radius, covering, pupil_detail::traced_edges(lens, data->space, w)));
    } else {
      data->add({{pupil_detail::star_for_all(lens, data->space, film_radius, w)}});
    }
  }
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::enclosing(const Lens& lens, double film_radius) {
  return traced(lens, film_radius, true);
}

FilmPupilTable FilmPupilTable::equal_area(const Lens& lens, double film_radius) {
  if (!lens.rotationally_symmetric()) {
    throw Error(lens.name() +
                ": pupils: the lens has cylinders, wanted one of revolution for pupils by distance alone");
  }
  return traced(lens, film_radius, false);
}

FilmPupilTable FilmPupilTable::of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                        double film_radius, std::size_t primary_wavelength) {
  check_film_radius("pupil map", film_radius);
  auto data = std::make_shared<Data>();
  data->primary = primary_wavelength;
  data->space = space;
  data->film_radius = data->lit_radius = film_radius;
  for (const std::vector<PupilDisc>& set : discs) data->add(pupil_detail::disc_stars(set, film_radius));
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::leaning(const FilmTilt& lean) const {
  check_film_radius("leaning film", lean.radius);
  auto data = std::make_shared<Data>();
  if (!data_->turned) {  // the one pupil holds all lines
    *data = *data_;
    data->film_radius = data->lit_radius = lean.radius;
    return FilmPupilTable(std::move(data));
  }
  data->space = data_->space;
  data->primary = data_->primary;
  data->film_radius = lean.radius;
  for (std::size_t w = 0; w < wavelengths() && data->lit_radius < lean.radius; ++w) {
    const double lit = pupil_detail::lit_radius(lean.radius, pupil_detail::leaning_edges(*this, lean, w));
    data->lit_radius = std::max(data->lit_radius, lit);
  }
  for (std::size_t w = 0; w < wavelengths(); ++w) {
    data->add(pupil_detail::film_polygons(data->lit_radius, true, pupil_detail::leaning_edges(*this, lean, w)));
  }
  return FilmPupilTable(std::move(data));
}

const TwoPlanes& FilmPupilTable::space() const noexcept { return data_->space; }
double FilmPupilTable::film_radius() const noexcept { return data_->film_radius; }
std::size_t FilmPupilTable::wavelengths() const noexcept { return data_->wavelengths; }
std::size_t FilmPupilTable::primary_wavelength() const noexcept { return data_->primary; }

PupilSample FilmPupilTable::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
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
  // A few are done before a block has begun.
  constexpr std::size_t few = 8;
  if (count < few) {
    for (std::size_t i = 0; i < count; ++i) {
      const PupilSample s =
          sample(FilmPoint{film_x[i], film_y[i]}, u[i], v[i], wavelengths.position(i, data_->primary));
      x[i] = static_cast<T>(s.x), y[i] = static_cast<T>(s.y), areas[i] = static_cast<T>(s.area);
    }
    return;
  }
  const auto& loops = pupil_detail::film_pupil_table();
  if constexpr (sizeof(T) == sizeof(float)) {
    loops.single(data_->table<T>(), count, film_x, film_y, u, v, wavelengths, x, y, areas);
  } else {
    loops.twice(data_->table<T>(), count, film_x, film_y, u, v, wavelengths, x, y, areas);
  }
}

double FilmPupilTable::area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return 0;
  return std::max(area_before(strip, polygon_corners, t), 0.0);
}

std::array<double, 2> FilmPupilTable::middle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return {0, 0};
  const double y = strip[L::middle_y] + t * strip[L::middle_y + 1];
  return {sine * y, cosine * y};
}

bool FilmPupilTable::contains(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return false;
  const double qx = cosine * x - sine * y;
  const double qy = sine * x + cosine * y - strip[L::middle_y] - t * strip[L::middle_y + 1];
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const auto [ax, ay] = along_strip(strip + L::sectors + L::sector * k, t);
    const auto [bx, by] = along_strip(strip + L::sectors + L::sector * (k + 1), t);
    const double behind = qx * ay - ax * qy, before = bx * qy - qx * by;
    if (!(behind >= 0 && before >= 0)) continue;
    const double whole = bx * ay - ax * by;
    if (!(whole > 0)) continue;
    const auto [gap_from, gap] = along_strip(strip + L::gaps + 4 * k, t);
    const double reach = (behind + before) / whole, out = reach * reach;
    return out <= 1 && !(out >= gap_from && out < gap_from + gap);
  }
  return false;
}

template <class T>
void FilmPupilTable::contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                              std::uint8_t* within) const noexcept {
  const auto& [film_x, film_y, x, y] = lines;
  constexpr std::size_t few = 4;
  if (count < few) {
    for (std::size_t i = 0; i < count; ++i) {
      within[i] = contains(FilmPoint{film_x[i], film_y[i]}, x[i], y[i], wavelengths.position(i, data_->primary));
    }
    return;
  }
  const auto& loops = pupil_detail::film_pupil_table();
  if constexpr (sizeof(T) == sizeof(float)) {
    loops.contains_single(data_->table<T>(), count, film_x, film_y, x, y, wavelengths, within);
  } else {
    loops.contains_twice(data_->table<T>(), count, film_x, film_y, x, y, wavelengths, within);
  }
}

FilmPupilTable::Motion FilmPupilTable::motion(const FilmPoint& film, double u, double v,
                                              Wavelength wavelength) const noexcept {
  using Jet = ceres::Jet<double, 2>;
  // On the axis the directions around it meet: beside it is near enough.
  const double beside = 1e-4 * data_->film_radius;
  const bool on_axis = std::hypot(film.x, film.y) < beside;
  const FilmPoint at = on_axis ? FilmPoint{0, beside} : film;
  const auto found = data_->find(at, wavelength);
  if (!found.strip || !(u - u == 0 && v - v == 0)) return {};
  u = std::clamp(u, 0.0, 1.0);
  v = std::clamp(v, 0.0, 1.0);
  const Jet x(at.x, 0), y(at.y, 1);
  const bool turn = data_->turned && data_->film_radius > 0;
  const Jet r = sqrt(x * x + y * y);
  Jet t = r * data_->strips_per_mm();
  t.a = found.t;
  Jet share(u);
  if (turn) {
    share -= pupil_detail::turn_of(x, y);
    if (share.a < 0) share += 1.0;
    if (share.a >= 1) share -= 1.0;
  }
  const double whole = area_before(found.strip, polygon_corners, t.a);
  if (!(whole > 0)) return {};
  const std::size_t k = sector_with(found.strip, t.a, share.a * whole);
  const auto [px, py] = place(found.strip, k, t, share, v);
  const Jet cosine = turn ? y / r : Jet(1), sine = turn ? x / r : Jet(0);
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
