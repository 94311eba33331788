// SPDX-License-Identifier: Apache-2.0
// How tables of pupils are made.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/text.hpp"
#include "film_grid.hpp"
#include "film_polygons.hpp"
#include "film_pupil_data.hpp"
#include "iris/iris_shape.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "repeated_wavelength.hpp"
#include "rim_cut.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

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

/// Throws Error for what no table is made of. count: of the wavelengths.
void check_table(const TwoPlanes& space, double film_radius, std::size_t count, std::size_t primary,
                 std::span<const double> wavelengths_nm) {
  const std::string where = "pupil table: ";
  if (!std::isfinite(space.depth()) || space.depth() == 0) {
    throw Error(where + "the film lies at z = " + to_text(space.film_z) + " and the plane of the pupil at " +
                to_text(space.pupil_z) + " mm, wanted two places");
  }
  check_film_radius("pupil table", film_radius);
  constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();  // RayWavelengths::each
  if (count < 1 || count > most) {
    throw Error(where + "it has " + std::to_string(count) + " wavelengths, wanted 1 to " + std::to_string(most));
  }
  if (primary >= count) {
    throw Error(where + "primary_wavelength is " + std::to_string(primary) + ", wanted one of " +
                std::to_string(count));
  }
  if (wavelengths_nm.empty()) return;
  if (wavelengths_nm.size() != count) {
    throw Error(where + "wavelengths_nm has " + std::to_string(wavelengths_nm.size()) + " numbers, wanted " +
                std::to_string(count) + " or none");
  }
  for (const double nm : wavelengths_nm) {
    if (!(nm > 0 && std::isfinite(nm))) throw Error(where + "a wavelength is " + to_text(nm) + " nm, wanted a length");
  }
  if (const auto repeated = repeated_wavelength(wavelengths_nm)) {
    throw Error(where + "wavelength " + std::to_string(*repeated) + " is " + to_text(wavelengths_nm[*repeated]) +
                " nm, that of another one, wanted each once");
  }
}

/// Throws Error for an outline in the plane of the pupil that is no disc or has no place. Areas and places of larger
/// numbers would overflow in float.
void check_outline(std::size_t wavelength, double shift, double radius) {
  constexpr double largest = 1e15;
  if (std::abs(shift) <= largest && radius >= 0 && radius <= largest) return;
  throw Error("pupil table: wavelength " + std::to_string(wavelength) + ": a pupil has the shift " + to_text(shift) +
              " and the radius " + to_text(radius) + " mm, wanted numbers up to " + to_text(largest) +
              " and no negative radius");
}

void check_discs(std::span<const std::vector<PupilDisc>> discs) {
  for (std::size_t w = 0; w < discs.size(); ++w) {
    if (discs[w].empty()) {
      throw Error("pupil table: wavelength " + std::to_string(w) + " has no disc, wanted one or more");
    }
    for (const auto& [shift, radius] : discs[w]) check_outline(w, shift, radius);
  }
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
  check_table(space, film_radius, discs.size(), primary_wavelength, wavelengths_nm);
  check_discs(discs);
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
  if (discs.size() != wavelengths()) {
    throw Error("pupil table: found discs of " + std::to_string(discs.size()) + " wavelengths, wanted those of " +
                std::to_string(wavelengths()));
  }
  check_discs(discs);
  const FilmPupilTable round = of_round_stop();
  auto data = data_->alike();
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
  constexpr double farthest = 1e6;  // beyond it, float does not tell the places of a pupil apart
  if (!(std::abs(rim.radii_per_mm) * lit_radius() <= farthest)) {
    throw Error("pupils: the rim moves by " + to_text(std::abs(rim.radii_per_mm) * lit_radius()) +
                " radii over the film, wanted at most " + to_text(farthest));
  }
  auto data = data_->alike();
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
  check_table(space, film_radius, images.size(), primary_wavelength, wavelengths_nm);
  for (std::size_t w = 0; w < images.size(); ++w) {
    const auto& [shift, radius] = images[w];
    check_outline(w, shift.x, radius.x);
    check_outline(w, shift.y, radius.y);
  }
  auto data = std::make_shared<Data>();
  data->space = space;
  data->film_radius = film_radius;
  data->wavelengths = images.size();
  data->primary = primary_wavelength;
  data->compiled = lens_detail::CompiledWavelengths(wavelengths_nm);
  data->images.emplace(iris, images, film_radius, primary_wavelength, data->compiled);
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::for_tilted_film(const FilmTilt& tilt, int threads) const {
  check_film_radius("tilted film", tilt.radius);
  if (threads < 1) throw Error("tilted film: threads is " + std::to_string(threads) + ", wanted 1 or more");
  auto data = std::make_shared<Data>();
  if (data_->images && tilt.travel == 0) {
    *data = *data_;
    data->film_radius = tilt.radius;
    data->images = data_->images->tilted(tilt);
    return FilmPupilTable(std::move(data));
  }
  // Edges of blades are alike neither all around nor at mirror images.
  if (data_->bladed() || (data_->images && !data_->images->round()))
    return of_round_stop().for_tilted_film(tilt, threads);
  data->space = data_->space;
  data->primary = data_->primary;
  data->compiled = data_->compiled;
  data->film_radius = tilt.radius;
  if (data_->cells || (data_->images && !data_->images->of_revolution())) {
    data->wavelengths = wavelengths();
    const FilmGrid grid = disc_grid(tilt.radius);
    data->cells.emplace(grid, tilt.radius, data->primary);
    std::vector<std::vector<PupilPolygon>> polygons(wavelengths());
    parallel_for(wavelengths(), 1, threads,
                 [&](std::size_t w, std::size_t) { polygons[w] = tilted_grid_polygons(*this, tilt, grid, w); });
    for (const auto& own : polygons) data->cells->add(own);
    return FilmPupilTable(std::move(data));
  }
  std::vector<FilmPupils> pupils;
  for (std::size_t w = 0; w < wavelengths(); ++w) pupils.push_back(tilted_film_pupils(*this, tilt, w));
  const auto [lit_radius, polygons] = film_polygons(tilt.radius, PolygonFit::enclosing, pupils, threads);
  data->lit_radius = lit_radius;
  for (const auto& own : polygons) data->add(own);
  return FilmPupilTable(std::move(data));
}

}  // namespace petzval
