// SPDX-License-Identifier: Apache-2.0
// Makers of pupil tables.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/text.hpp"
#include "film_polygons.hpp"
#include "film_pupil_data.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

/// Scales a polygon until its projected solid angle at its film point equals `target_solid_angle`.
void scale_to_light(PupilPolygon& polygon, const TwoPlanes& space, const FilmPoint& film, double target_solid_angle) {
  // The solid angle is nearly proportional to the squared scale.
  for (int round = 0; round < 3; ++round) {
    const PolygonSampler sampler([&](std::size_t k) { return polygon.sector(k); });
    const auto solid_angle = [&](double u, double v) {
      const Point<double> p = sampler(u, v);
      return solid_angle_at(space, film, polygon.middle.x + p.x, polygon.middle.y + p.y);
    };
    const double own =
        sampler.area() * (space.depth() * space.depth()) * pupil_table_detail::mean_over_samples(16, solid_angle);
    const double scale = own > 0 ? std::sqrt(target_solid_angle / own) : 0;
    for (auto& corner : polygon.corners) corner = {scale * corner[0], scale * corner[1]};
  }
}

/// The disc that contains the axial pupil and moves with the film point as pupils near the axis do.
/// @param off_axis pupil of the film point at `height`
PupilDisc disc_around(const PupilPolygon& on_axis, const PupilPolygon& off_axis, double height) noexcept {
  double radius = 0;
  for (const auto& corner : on_axis.corners) radius = std::max(radius, std::hypot(corner.x, corner.y));
  return {height > 0 ? (off_axis.middle.y - on_axis.middle.y) / height : 0, radius};
}

/// Expands the pupils of each wavelength to contain the pupils up to halfway to the adjacent wavelengths.
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

void check_film_radius(const std::string& where, double film_radius) {
  if (film_radius >= 0 && std::isfinite(film_radius)) return;
  throw Error(where + ": film: radius = " + to_text(film_radius) + " mm; must be finite and at least 0");
}

/// @throws Error  if no table can be made of the arguments; count: number of wavelengths
void check_table(const TwoPlanes& space, double film_radius, std::size_t count, std::size_t primary,
                 std::span<const double> wavelengths_nm) {
  const std::string where = "pupil table: ";
  if (!std::isfinite(space.depth()) || space.depth() == 0) {
    throw Error(where + "film_z = " + to_text(space.film_z) + " and pupil_z = " + to_text(space.pupil_z) +
                " mm; must differ");
  }
  check_film_radius("pupil table", film_radius);
  constexpr std::size_t max_wavelengths = std::numeric_limits<std::uint16_t>::max();  // RayWavelengths::each
  if (count < 1 || count > max_wavelengths) {
    throw Error(where + "it has " + std::to_string(count) + " wavelengths; must have 1 to " +
                std::to_string(max_wavelengths));
  }
  if (primary >= count) {
    throw Error(where + "primary_wavelength = " + std::to_string(primary) + "; must be below " + std::to_string(count));
  }
  if (wavelengths_nm.empty()) return;
  if (wavelengths_nm.size() != count) {
    throw Error(where + "wavelengths_nm has " + std::to_string(wavelengths_nm.size()) + " numbers; must have " +
                std::to_string(count) + " or be empty");
  }
  for (const double nm : wavelengths_nm) {
    if (!(nm > 0 && std::isfinite(nm)))
      throw Error(where + "wavelength = " + to_text(nm) + " nm; must be finite and above 0");
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t w) { return wavelengths_nm[w]; });
  for (std::size_t i = 1; i < count; ++i) {
    constexpr double tolerance_nm = 1e-6;  // of compile()
    if (wavelengths_nm[order[i]] - wavelengths_nm[order[i - 1]] > tolerance_nm) continue;
    const std::size_t repeated = std::max(order[i - 1], order[i]);
    throw Error(where + "wavelength " + std::to_string(repeated) + " = " + to_text(wavelengths_nm[repeated]) +
                " nm; must differ from all others");
  }
}

/// @throws Error  if the outline in the pupil plane is not a finite disc; larger numbers overflow in float
void check_outline(std::size_t wavelength, double shift, double radius) {
  constexpr double largest = 1e15;
  if (std::abs(shift) <= largest && radius >= 0 && radius <= largest) return;
  throw Error("pupil table: wavelength " + std::to_string(wavelength) + ": shift = " + to_text(shift) +
              ", radius = " + to_text(radius) + " mm; both must be at most " + to_text(largest) +
              " in absolute value, and the radius not negative");
}

void check_discs(std::span<const std::vector<PupilDisc>> discs) {
  for (std::size_t w = 0; w < discs.size(); ++w) {
    if (discs[w].empty()) {
      throw Error("pupil table: wavelength " + std::to_string(w) + " has no disc; must have one or more");
    }
    for (const auto& [shift, radius] : discs[w]) check_outline(w, shift, radius);
  }
}

}  // namespace

FilmPupilTable FilmPupilTable::traced(const Lens& lens, double film_radius, bool enclosing, int threads) {
  const PolygonFit fit = enclosing ? PolygonFit::enclosing : PolygonFit::equal_area;
  check_film_radius(lens.name(), film_radius);
  const Data data{two_planes(lens), film_radius, lens.primary_wavelength(),
                  lens_detail::CompiledWavelengths(lens.wavelengths_nm()), enclosing};
  FilmPolygons pupils = traced_polygons(with_iris(lens, {}), data.space, film_radius, fit, threads);
  if (enclosing) expand_to_neighbours(data.compiled, pupils.by_wavelength);
  const FilmPupilTable table = data.with(pupils);
  return lens.iris().round() ? table : table.with_stop(lens, threads);
}

FilmPupilTable FilmPupilTable::enclosing(const Lens& lens, double film_radius, int threads) {
  return traced(lens, film_radius, true, threads);
}

FilmPupilTable FilmPupilTable::equal_area(const Lens& lens, double film_radius, int threads) {
  return traced(lens, film_radius, false, threads);
}

FilmPupilTable FilmPupilTable::with_stop(const Lens& lens, int threads) const {
  if (data_->images) return *this;
  if (!lens.stop() || !std::isfinite(lens.surfaces()[*lens.stop()].semi_diameter)) {
    throw Error(lens.name() + ": pupils: the lens has no stop with a semi_diameter; it must have one");
  }
  return data_->with_stop(lens.iris(), traced_stop(lens, space()), threads);
}

FilmPupilTable FilmPupilTable::of_discs(const TwoPlanes& space, std::span<const std::vector<PupilDisc>> discs,
                                        double film_radius, std::size_t primary_wavelength,
                                        std::span<const double> wavelengths_nm) {
  check_table(space, film_radius, discs.size(), primary_wavelength, wavelengths_nm);
  check_discs(discs);
  const Data data{space, film_radius, primary_wavelength, lens_detail::CompiledWavelengths(wavelengths_nm)};
  return data.with(disc_polygons(discs, film_radius));
}

FilmPupilTable FilmPupilTable::with_round_stop() const {
  if (data_->unclipped) return unclipped().with_round_stop();
  auto data = std::make_shared<Data>(*data_);
  data->stop = nullptr;
  if (data->images) data->images = data->images->with_round_stop();
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::with_discs(std::span<const std::vector<PupilDisc>> discs) const {
  if (discs.size() != wavelengths()) {
    throw Error("pupil table: discs has " + std::to_string(discs.size()) + " wavelengths; must have " +
                std::to_string(wavelengths()));
  }
  check_discs(discs);
  FilmPolygons pupils = disc_polygons(discs, lit_radius());
  for (std::size_t w = 0; w < discs.size(); ++w) {
    for (std::size_t i = 0; i < pupils.by_wavelength[w].size(); ++i) {
      const FilmPoint film = pupils.grid.node(i);
      scale_to_light(pupils.by_wavelength[w][i], space(), film, projected_solid_angle(film, w));
    }
  }
  return data_->with(pupils);
}

FilmPupilTable FilmPupilTable::clipped_by_rim(const PupilRim& rim) const {
  const auto& images = data_->images;
  if (!data_->of_revolution() || (images && !images->of_revolution()) || data_->obscured) {
    throw Error(
        "pupils: the lens has cylinders or a central obscuration; must be a lens of revolution without "
        "obscurations if a rim clips its pupils");
  }
  if (!(rim.ratio > 0 && std::isfinite(rim.ratio)) || !std::isfinite(rim.shift_per_mm)) {
    throw Error("pupils: rim: ratio = " + to_text(rim.ratio) + ", shift_per_mm = " + to_text(rim.shift_per_mm) +
                "; both must be finite, and the ratio above 0");
  }
  constexpr double farthest = 1e6;  // float cannot resolve a pupil beyond this distance
  if (!(std::abs(rim.shift_per_mm) * lit_radius() <= farthest)) {
    throw Error("pupils: the rim moves by " + to_text(std::abs(rim.shift_per_mm) * lit_radius()) +
                " radii over the film; must be at most " + to_text(farthest));
  }
  FilmPolygons pupils{data_->points, {}};
  std::vector<std::vector<PupilDisc>> discs;
  for (std::size_t w = 0; w < wavelengths(); ++w) {
    const PupilDisc pupil =
        images ? images->disc(w) : disc_around(data_->node(w, 0), data_->node(w, 1), data_->points.node(1).y);
    const PupilDisc disc{pupil.shift - rim.shift_per_mm * pupil.radius, rim.ratio * pupil.radius};
    discs.push_back({pupil, disc});
    std::vector<PupilPolygon>& polygons = pupils.by_wavelength.emplace_back();
    for (std::size_t i = 0; !images && i < data_->nodes(); ++i) {
      polygons.push_back(clipped_by_disc(data_->node(w, i), disc.shift * data_->points.node(i).y, disc.radius));
    }
  }
  auto data = data_->filled(images ? disc_polygons(discs, lit_radius()) : pupils);
  data->unclipped = data_;
  if (const auto& stop = data_->stop) return data->with_stop(stop->shape.iris(), stop->stop_of);
  if (!images || images->round()) return FilmPupilTable(std::move(data));
  const StopOf stop_of = [own = *images](const FilmPoint& film, const Vec2<double>& position,
                                         std::size_t w) -> std::optional<Vec2<double>> {
    const auto [shift, radius] = own.disc(w);
    return Vec2<double>{(position.x - shift * film.x) / radius, (position.y - shift * film.y) / radius};
  };
  return data->with_stop(images->iris(), stop_of);
}

FilmPupilTable FilmPupilTable::unclipped() const { return FilmPupilTable(data_->unclipped ? data_->unclipped : data_); }
bool FilmPupilTable::is_clipped() const noexcept { return data_->unclipped != nullptr; }

FilmPupilTable FilmPupilTable::of_iris(const TwoPlanes& space, const Iris& iris, std::span<const PupilImage> images,
                                       double film_radius, std::size_t primary_wavelength,
                                       std::span<const double> wavelengths_nm) {
  check_table(space, film_radius, images.size(), primary_wavelength, wavelengths_nm);
  for (std::size_t w = 0; w < images.size(); ++w) {
    const auto& [shift, radius] = images[w];
    check_outline(w, shift.x, radius.x);
    check_outline(w, shift.y, radius.y);
  }
  const lens_detail::CompiledWavelengths compiled(wavelengths_nm);
  auto data = std::make_shared<Data>(Data{space, film_radius, primary_wavelength, compiled, false, images.size()});
  data->images.emplace(iris, images, film_radius, primary_wavelength, compiled);
  return FilmPupilTable(std::move(data));
}

FilmPupilTable FilmPupilTable::for_tilted_film(const FilmTilt& tilt, int threads) const {
  check_film_radius("tilted film", tilt.radius);
  if (threads < 1) throw Error("tilted film: threads = " + std::to_string(threads) + "; must be at least 1");
  if (data_->images && tilt.travel == 0) {
    auto data = std::make_shared<Data>(*data_);
    data->film_radius = tilt.radius;
    data->images = data_->images->tilted(tilt);
    return FilmPupilTable(std::move(data));
  }
  // Blades break the rotational and mirror symmetry: samples are taken from the round stop, and the iris clips the
  // rays.
  if (data_->stop || (data_->images && !data_->images->round()))
    return with_round_stop().for_tilted_film(tilt, threads);
  const bool of_revolution = data_->images ? data_->images->of_revolution() : data_->of_revolution();
  const Data data{space(), tilt.radius, data_->primary, data_->compiled};
  return data.with(tilted_polygons(*this, of_revolution, tilt, threads));
}

std::shared_ptr<FilmPupilTable::Data> FilmPupilTable::Data::filled(const FilmPolygons& pupils) const {
  auto data = std::make_shared<Data>(Data{space, film_radius, primary, compiled, enclosing});
  data->wavelengths = pupils.by_wavelength.size();
  data->points = pupils.grid;
  std::vector<double> of_nodes;
  for (const auto& own : pupils.by_wavelength) {
    for (const PupilPolygon& polygon : own) {
      polygon.append_to(of_nodes);
      data->obscured = data->obscured || polygon.is_obscured();
    }
  }
  data->numbers = in_both(std::move(of_nodes));
  data->half_widths = in_both(pupils.grid.half_widths);
  return data;
}

}  // namespace petzval
