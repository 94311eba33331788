// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil_table/film_pupil_table.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "bladed_polygons.hpp"
#include "core/quadrature.hpp"
#include "core/text.hpp"
#include "film_cells.hpp"
#include "film_grid.hpp"
#include "film_polygons.hpp"
#include "film_pupil_table_loops.hpp"
#include "iris/iris_shape.hpp"
#include "iris_images.hpp"
#include "lens/between_wavelengths.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "polygon_place.hpp"
#include "pupil/line_extents.hpp"
#include "rim_cut.hpp"

namespace petzval::inline v0 {
namespace {

using namespace pupil_table_detail;
using L = StripLayout;

/// A strip from the polygons at its sides.
std::array<double, L::size> strip_between(const PupilPolygon& p, const PupilPolygon& q) {
  std::array<double, L::size> strip{};  // some are not used
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

}  // namespace

struct FilmPupilTable::Data {
  TwoPlanes space;
  double film_radius = 0;
  std::size_t wavelengths = 0, primary = 0;
  lens_detail::CompiledWavelengths compiled;  // for samples by nm
  std::optional<IrisImages> images;           // instead of strips
  std::optional<FilmCells> cells;             // instead of strips; of a bladed iris, strips are those of the round stop
  Iris iris;
  std::vector<std::vector<StopMap>> maps;  // of a bladed iris, by wavelength
  double lit_radius = 0;                   // to which the strips reach: beyond it is dark
  std::size_t strips_each = 0;
  double strips_per_mm = 0;
  bool obscured = false;
  int corrections = 0;
  std::vector<double> twice;  // strips by StripLayout
  std::vector<float> single;
  std::shared_ptr<const Data> whole;  // the pupils that a rim has cut; null: none has

  bool bladed() const noexcept { return cells && cells->bladed(); }

  /// Adds a wavelength.
  void add(const std::vector<PupilPolygon>& polygons) {
    ++wavelengths;
    strips_each = polygons.size() - 1;
    strips_per_mm = steps_per_mm(strips_each, lit_radius);
    for (std::size_t i = 0; i < strips_each; ++i) {
      const PupilPolygon &a = polygons[i], &b = polygons[i + 1];
      const auto strip = strip_between(a, b);
      twice.insert(twice.end(), strip.begin(), strip.end());
      for (const double value : strip) single.push_back(static_cast<float>(value));
      for (std::size_t k = 0; k < polygon_corners; ++k) obscured = obscured || a.obscured[k] > 0 || b.obscured[k] > 0;
      for (int step = 0; step <= 8; ++step) {
        corrections = std::max(corrections, corrections_of(InStrip<double>{strip.data(), step / 8.0}));
      }
    }
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
    result.strips_per_mm = static_cast<R>(strips_per_mm);
    result.obscured = obscured;
    result.corrections = corrections;
    return result;
  }

  /// The polygon at the side of a strip, as add() took it, without obscurations.
  PupilPolygon node(std::size_t wavelength, std::size_t i) const noexcept {
    const std::size_t strip = std::min(i, strips_each - 1);
    const InStrip<double> at{&twice[(wavelength * strips_each + strip) * L::size], static_cast<double>(i - strip)};
    PupilPolygon polygon;
    polygon.middle = {at.middle().x, at.middle().y};
    for (std::size_t k = 0; k < polygon_corners; ++k) polygon.corners[k] = {at.corner(k).x, at.corner(k).y};
    return polygon;
  }

  /// Where a film point stands in the table.
  struct Place {
    const double* strip = nullptr;  // null: nowhere
    double t = 0, cosine = 1, sine = 0;

    InStrip<double> polygon() const noexcept { return {strip, t}; }
  };
  /// That of the table to use; none has it for a wavelength that is not covered.
  std::size_t position(Wavelength at) const noexcept {
    const auto nm = at.in_nm();
    return !nm ? at.position(primary) : compiled.covers(*nm) ? compiled.nearest(*nm) : wavelengths;
  }
  /// Calls body(begin, count, positions) for parts of N rays whose wavelengths are in nm.
  template <class Body>
  void by_nearest(std::size_t count, const RayWavelengths& by_nm, const Body& body) const noexcept {
    if (!by_nm.each_nm) {
      body(0, count, RayWavelengths{position(by_nm.all)});
      return;
    }
    constexpr std::size_t block = 256;
    std::array<std::uint16_t, block> positions;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      pupil_table_detail::film_pupil_table().find_nearest(compiled.nearest_position(), n, by_nm.each_nm + begin,
                                                          positions.data());
      body(begin, n, RayWavelengths{.each = positions.data()});
    }
  }
  Place find(const FilmPoint& film, Wavelength at_wavelength) const noexcept {
    const std::size_t wavelength = position(at_wavelength);
    const double r = std::sqrt(film.x * film.x + film.y * film.y);
    if (!(r <= lit_radius * (1 + 1e-6)) || wavelength >= wavelengths) return {};
    const double at = r * strips_per_mm;
    const std::size_t strip = std::min(static_cast<std::size_t>(at), strips_each - 1);
    const bool turn = r > 0;
    return {&twice[(wavelength * strips_each + strip) * L::size], at - static_cast<double>(strip),
            turn ? film.y / r : 1, turn ? film.x / r : 0};
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

/// Scales a polygon until its film point sees it in a projected solid angle.
void scale_to_light(PupilPolygon& polygon, const TwoPlanes& space, const FilmPoint& film, double wanted) {
  // The solid angle grows with the square of the scale, nearly.
  for (int round = 0; round < 3; ++round) {
    const PolygonSampler sampler(polygon);
    const double own = solid_angle(space, film, sampler.area(), sampler);
    const double scale = own > 0 ? std::sqrt(wanted / own) : 0;
    for (auto& corner : polygon.corners) corner = {scale * corner[0], scale * corner[1]};
  }
}

/// The disc that moves as the pupil does near the axis and holds it there. beside: of a film point at a height.
PupilDisc disc_about(const PupilPolygon& on_axis, const PupilPolygon& beside, double height) noexcept {
  double radius = 0;
  for (const auto& corner : on_axis.corners) radius = std::max(radius, std::hypot(corner.x, corner.y));
  return {height > 0 ? (beside.middle.y - on_axis.middle.y) / height : 0, radius};
}

/// Makes the pupils of each wavelength contain those up to the middles between it and its neighbours.
void expand_to_neighbours(const lens_detail::CompiledWavelengths& compiled,
                          std::vector<std::vector<PupilPolygon>>& polygons) {
  const std::vector<std::vector<PupilPolygon>> own = polygons;
  for (std::size_t r = 0; r + 1 < compiled.count(); ++r) {
    const std::size_t w = compiled.position(r), next = compiled.position(r + 1);
    for (std::size_t i = 0; i < own[w].size(); ++i) {
      expand_towards(polygons[w][i], own[next][i]);
      expand_towards(polygons[next][i], own[w][i]);
    }
  }
}

bool obscured(const std::vector<std::vector<PupilPolygon>>& polygons) {
  for (const auto& own : polygons) {
    for (const PupilPolygon& polygon : own) {
      if (std::any_of(polygon.obscured.begin(), polygon.obscured.end(), [](double w) { return w > 0; })) return true;
    }
  }
  return false;
}

void check_film_radius(const std::string& where, double film_radius) {
  if (film_radius >= 0 && std::isfinite(film_radius)) return;
  throw Error(where + ": film: its radius is " + to_text(film_radius) + " mm, wanted a finite one, 0 or more");
}

}  // namespace

FilmPupilTable FilmPupilTable::traced(const Lens& lens, double film_radius, bool enclosing, int threads) {
  const PolygonFit fit = enclosing ? PolygonFit::enclosing : PolygonFit::equal_area;
  check_film_radius(lens.name(), film_radius);
  auto data = std::make_shared<Data>();
  data->space = two_planes(lens);
  data->film_radius = film_radius;
  data->primary = lens.primary_wavelength();
  data->compiled = lens_detail::CompiledWavelengths(lens.wavelengths_nm());
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  const Lens round = with_iris(lens, {});
  if (!round.rotationally_symmetric()) {
    data->wavelengths = wavelengths;
    const FilmGrid grid = film_grid(round, data->space, film_radius);
    data->cells.emplace(grid, film_radius, data->primary);
    std::vector<std::vector<PupilPolygon>> polygons(wavelengths);
    parallel_for(wavelengths, 1, threads,
                 [&](std::size_t w, std::size_t) { polygons[w] = grid_polygons(round, data->space, grid, fit, w); });
    if (enclosing) expand_to_neighbours(data->compiled, polygons);
    for (const auto& own : polygons) data->cells->add(own);
    return FilmPupilTable(std::move(data));
  }
  std::vector<FilmPupils> pupils;
  for (std::size_t w = 0; w < wavelengths; ++w) pupils.push_back(traced_pupils(round, data->space, w));
  auto [lit_radius, polygons] = film_polygons(film_radius, fit, pupils, threads);
  data->lit_radius = lit_radius;
  std::vector<std::vector<PupilPolygon>> bladed;
  if (!lens.iris().round() && !obscured(polygons)) {
    const BladedGrid grid(lens.iris(), lit_radius, polygons[0].size());
    data->iris = lens.iris();
    data->cells.emplace(grid, data->primary);
    data->maps.resize(wavelengths), bladed.resize(wavelengths);
    parallel_for(wavelengths, 1, threads, [&, lit = lit_radius, &polygons = polygons](std::size_t w, std::size_t) {
      for (std::size_t i = 0; i < polygons[w].size(); ++i) {
        const double height = lit * static_cast<double>(i) / static_cast<double>(polygons[w].size() - 1);
        data->maps[w].emplace_back(lens, data->space, height, polygons[w][i], w);
      }
      bladed[w] = bladed_polygons(grid, polygons[w], data->maps[w], fit);
    });
  } else if (!lens.iris().round() && !enclosing) {
    throw Error(lens.name() + ": pupils: found an iris with blades and a central obscuration, wanted a round stop");
  }
  if (enclosing) {
    expand_to_neighbours(data->compiled, polygons);
    if (!bladed.empty()) expand_to_neighbours(data->compiled, bladed);
  }
  for (const auto& own : polygons) data->add(own);
  for (const auto& own : bladed) data->cells->add(own);
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::enclosing(const Lens& lens, double film_radius, int threads) {
  return traced(lens, film_radius, true, threads);
}

FilmPupilTable FilmPupilTable::equal_area(const Lens& lens, double film_radius, int threads) {
  if (!lens.iris().round() && !with_iris(lens, {}).rotationally_symmetric()) {
    throw Error(lens.name() + ": pupils: found cylinders and an iris with blades, wanted a round stop");
  }
  return traced(lens, film_radius, false, threads);
}

FilmPupilTable FilmPupilTable::of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                        double film_radius, std::size_t primary_wavelength,
                                        std::span<const double> wavelengths_nm) {
  check_film_radius("pupil table", film_radius);
  auto data = std::make_shared<Data>();
  data->primary = primary_wavelength;
  data->compiled = lens_detail::CompiledWavelengths(wavelengths_nm);
  data->space = space;
  data->film_radius = data->lit_radius = film_radius;
  for (const std::vector<PupilDisc>& set : discs) data->add(disc_polygons(set, film_radius));
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::of_round_stop() const {
  if (data_->whole) return whole().of_round_stop();
  auto data = std::make_shared<Data>(*data_);
  if (data->bladed()) data->cells.reset();
  if (data->images) data->images = data->images->of_round_stop();
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::reshaped(std::span<const std::vector<PupilDisc>> discs) const {
  const FilmPupilTable round = of_round_stop();
  auto data = std::make_shared<Data>();
  data->space = data_->space;
  data->film_radius = film_radius();
  data->lit_radius = lit_radius();
  data->primary = primary_wavelength();
  data->compiled = data_->compiled;
  constexpr std::size_t strips = film_strips(PolygonFit::equal_area);
  const std::optional<BladedGrid> grid =
      data_->bladed() ? std::optional(BladedGrid(data_->iris, lit_radius(), strips + 1)) : std::nullopt;
  if (grid) {
    data->iris = data_->iris, data->maps = data_->maps;
    data->cells.emplace(*grid, data->primary);
  }
  for (std::size_t w = 0; w < discs.size(); ++w) {
    std::vector<PupilPolygon> polygons = disc_polygons(discs[w], lit_radius());
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const FilmPoint film{0, lit_radius() * static_cast<double>(i) / strips};
      scale_to_light(polygons[i], space(), film, round.projected_solid_angle(film, w));
    }
    data->add(polygons);
    if (!grid) continue;
    std::vector<PupilPolygon> bladed = bladed_polygons(*grid, polygons, data_->maps[w], PolygonFit::equal_area);
    for (std::size_t i = 0; i < bladed.size(); ++i) {
      // In the frame of the iris, in which the polygons are, and in that of the lens.
      const auto [radius, azimuth] = grid->node(i);
      const double turn = azimuth - data_->iris.rotation_rad;
      PupilPolygon& polygon = bladed[i];
      const double middle = polygon.middle.y;
      polygon.middle = {middle * std::sin(azimuth), middle * std::cos(azimuth)};
      scale_to_light(polygon, space(), {radius * std::sin(azimuth), radius * std::cos(azimuth)},
                     projected_solid_angle({radius * std::sin(turn), radius * std::cos(turn)}, w));
      polygon.middle = {0, middle};
    }
    data->cells->add(bladed);
  }
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::cut_by_rim(const PupilRim& rim) const {
  const auto& images = data_->images;
  if ((data_->cells && !data_->bladed()) || (images && !images->of_revolution()) || data_->obscured) {
    throw Error(
        "pupils: found cylinders or a central obscuration, wanted a lens of revolution without for a rim that "
        "cuts cat's eyes");
  }
  if (!(rim.ratio > 0 && std::isfinite(rim.ratio)) || !std::isfinite(rim.radii_per_mm)) {
    throw Error("pupils: a rim of " + to_text(rim.ratio) + " radii that moves by " + to_text(rim.radii_per_mm) +
                " of them per mm, wanted a positive radius and finite numbers");
  }
  auto data = std::make_shared<Data>();
  data->space = data_->space;
  data->film_radius = film_radius();
  data->lit_radius = lit_radius();
  data->primary = primary_wavelength();
  data->compiled = data_->compiled;
  data->whole = data_;
  constexpr std::size_t image_strips = film_strips(PolygonFit::equal_area);
  const std::size_t strips = images ? image_strips : data_->strips_each;
  const Iris iris = images ? images->iris() : data_->bladed() ? data_->iris : Iris{};
  std::optional<BladedGrid> grid;
  if (!iris.round()) {
    grid.emplace(iris, lit_radius(), strips + 1);
    data->iris = iris;
    data->cells.emplace(*grid, data->primary);
  }
  std::vector<Vec2<double>> corners;  // of an iris in closed form, its first corner on +y
  if (images && grid) {
    const iris_detail::IrisShape shape({iris.blades, iris.roundness});
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      corners.push_back(
          shape.sample(k < grid->corners ? static_cast<double>(k) / static_cast<double>(grid->corners) : 0, 1));
    }
  }
  for (std::size_t w = 0; w < wavelengths(); ++w) {
    const PupilDisc pupil =
        images ? images->disc(w)
               : disc_about(data_->node(w, 0), data_->node(w, 1), lit_radius() / static_cast<double>(strips));
    const PupilDisc disc{pupil.shift - rim.radii_per_mm * pupil.radius, rim.ratio * pupil.radius};
    std::vector<PupilPolygon> polygons;
    if (images) {
      polygons = disc_polygons(std::array{pupil, disc}, lit_radius());
    } else {
      for (std::size_t i = 0; i <= strips; ++i) {
        const double height = lit_radius() * static_cast<double>(i) / static_cast<double>(strips);
        polygons.push_back(cut_by_disc(data_->node(w, i), {0, 1}, disc.shift * height, disc.radius));
      }
    }
    data->add(polygons);
    if (!grid) continue;
    std::vector<PupilPolygon> bladed;
    for (std::size_t i = 0; i < (grid->rows + 1) * (grid->columns + 1); ++i) {
      const auto [radius, azimuth] = grid->node(i);
      PupilPolygon polygon;
      if (images) {
        polygon.middle = {0, pupil.shift * radius};
        for (std::size_t k = 0; k < polygon_corners; ++k) polygon.corners[k] = pupil.radius * corners[k];
      } else {
        polygon = data_->cells->node(w, i);
      }
      bladed.push_back(cut_by_disc(polygon, {std::sin(azimuth), std::cos(azimuth)}, disc.shift * radius, disc.radius));
    }
    data->cells->add(bladed);
  }
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::whole() const { return FilmPupilTable(data_->whole ? data_->whole : data_); }
bool FilmPupilTable::cut() const noexcept { return data_->whole != nullptr; }

FilmPupilTable FilmPupilTable::of_iris(const TwoPlanes& space, const Iris& iris, std::span<const PupilImage> images,
                                       double film_radius, std::size_t primary_wavelength,
                                       std::span<const double> wavelengths_nm) {
  check_film_radius("pupil table", film_radius);
  auto data = std::make_shared<Data>();
  data->space = space;
  data->film_radius = film_radius;
  data->wavelengths = images.size();
  data->primary = primary_wavelength;
  data->compiled = lens_detail::CompiledWavelengths(wavelengths_nm);
  data->images.emplace(iris, images, film_radius, primary_wavelength, data->compiled);
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
  // Edges of blades are alike neither all around nor at mirror images.
  if (data_->bladed() || (data_->images && !data_->images->round())) return of_round_stop().for_tilted_film(tilt);
  data->space = data_->space;
  data->primary = data_->primary;
  data->compiled = data_->compiled;
  data->film_radius = tilt.radius;
  if (data_->cells || (data_->images && !data_->images->of_revolution())) {
    data->wavelengths = wavelengths();
    const FilmGrid grid = disc_grid(tilt.radius);
    data->cells.emplace(grid, tilt.radius, data->primary);
    for (std::size_t w = 0; w < wavelengths(); ++w) {
      data->cells->add(tilted_grid_polygons(*this, tilt, grid, w));
    }
    return FilmPupilTable(std::move(data));
  }
  std::vector<FilmPupils> pupils;
  for (std::size_t w = 0; w < wavelengths(); ++w) pupils.push_back(tilted_film_pupils(*this, tilt, w));
  const auto [lit_radius, polygons] = film_polygons(tilt.radius, PolygonFit::enclosing, pupils, 1);
  data->lit_radius = lit_radius;
  for (const auto& own : polygons) data->add(own);
  return FilmPupilTable(std::move(data));
}

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
  return solid_angle(space(), film, area(film, wavelength), [&](double u, double v) {
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

double FilmPupilTable::clearance(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  if (data_->images) return pupil_detail::clearance_of(contains(film, x, y, wavelength));
  if (const auto& cells = data_->cells) return cells->clearance(film, x, y, data_->position(wavelength));
  const auto [strip, t, cosine, sine] = data_->find(film, wavelength);
  if (!strip) return -1;
  const InStrip<double> polygon{strip, t};
  return clearance_of_place(polygon, Point<double>{cosine * x - sine * y, sine * x + cosine * y} - polygon.middle());
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
  using Jet = ceres::Jet<double, 2>;
  if (data_->strips_per_mm == 0) return {};
  // On the axis the directions around it meet: beside it is near enough.
  const double beside = 1e-4 * data_->film_radius;
  const bool on_axis = std::hypot(film.x, film.y) < beside;
  const FilmPoint at = on_axis ? FilmPoint{0, beside} : film;
  const auto found = data_->find(at, wavelength);
  if (!found.strip || !(u - u == 0 && v - v == 0)) return {};
  u = std::clamp(u, 0.0, 1.0);
  v = std::clamp(v, 0.0, 1.0);
  const Jet x(at.x, 0), y(at.y, 1);
  const Jet r = sqrt(x * x + y * y);
  Jet t = r * data_->strips_per_mm;
  t.a = found.t;
  const Jet cosine = y / r, sine = x / r;
  Jet share(u);
  share -= turn_of(sine, cosine);
  if (share.a < 0) share += 1.0;
  if (share.a >= 1) share -= 1.0;
  const double whole = found.polygon().area_before(polygon_corners);
  if (!(whole > 0)) return {};
  const std::size_t k = sector_with(found.polygon(), share.a * whole);
  const InStrip<Jet> polygon{found.strip, t};
  const auto [px, py] = polygon.middle() + sample_place(polygon, k, share, v);
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
