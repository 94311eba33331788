// SPDX-License-Identifier: Apache-2.0
#include "paraxial_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "best_focus.hpp"
#include "camera_loops.hpp"
#include "camera_steps.hpp"
#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "iris/iris_edges.hpp"
#include "make_model.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/sector.hpp"
#include "two_disc_fit.hpp"

namespace petzval::camera_detail {

namespace {

constexpr double farthest = 1e12;  // mm, for lines
constexpr double largest = 1e18;   // for rays before normalisation; its square is finite in float

/// Map from film and pupil point to position and slope in the plane of the first vertex, in front of the lens.
RayMatrix to_scene_map(const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space, Meridian section,
                       bool paraxial_focus) {
  const StopMaps maps = stop_maps(facts, wavelength, space, section);
  const double power = paraxial_focus ? 0 : best_focus_power(facts, wavelength, maps, section);
  return maps.from_film.then({1, 0, power, 1}).then(maps.to_front);
}

/// Maps of a model; rays of a pinhole pass the middle of the pupil.
SectionMaps seen_by(ModelKind model, const SectionMaps& maps, double middle) noexcept {
  if (model != ModelKind::pinhole) return maps;
  const auto through = [middle](const RayMatrix& map) -> RayMatrix {
    return {map.a + map.b * middle, 0, map.c + map.d * middle, 0};
  };
  return {through(maps.x), through(maps.y)};
}

SectionMaps maps_of(const std::array<double, 8>& numbers) noexcept {
  const auto& [xa, xb, xc, xd, ya, yb, yc, yd] = numbers;
  return {{xa, xb, xc, xd}, {ya, yb, yc, yd}};
}

/// Maps at a compiled wavelength, or at a wavelength in nm, written to `own`; null if the wavelength is not covered.
const SectionMaps* at_wavelength(Wavelength at, std::size_t primary, const std::vector<SectionMaps>& compiled,
                                 const lens_detail::BetweenWavelengths<8>& between, SectionMaps& own) noexcept {
  if (const auto nm = at.in_nm()) {
    if (!between.covers(*nm)) return nullptr;
    own = maps_of(between(*nm));
    return &own;
  }
  const std::size_t position = at.index(primary);
  return position < compiled.size() ? &compiled[position] : nullptr;
}

/// Image of the stop in the pupil plane for a film point; its centre is at `shift` times the film point.
struct StopImage {
  double shift = 0;
  double size = 0;  ///< relative to the stop; negative if inverted
};

/// @param height first row of a map from film and pupil point to the height in the stop or in an image of the stop
/// @param scale factor from this height to the height in the stop
StopImage image_of(const Lens& lens, const RayMatrix& height, double scale, const char* where) {
  if (height.b == 0) {
    throw Error(lens.name() + ": the film lies in " + where + "; must be elsewhere for a first-order model");
  }
  return {-height.a / height.b, 1 / (height.b * scale)};
}

StopImage thick_image(const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space, Meridian section) {
  return image_of(facts.lens(), stop_maps(facts, wavelength, space, section).from_film, 1, "the image of the stop");
}

/// Image for the thin model: the entrance pupil, placed in the rear principal plane.
StopImage thin_image(const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space, Meridian section) {
  const Lens& lens = facts.lens();
  const double z = first_order(lens, wavelength, section).rear_principal_z;
  const double stop_over_image = ray_matrix_to(lens, facts.pupils(wavelength).stop, wavelength, section).a;
  return image_of(lens, line_at(space, z), stop_over_image, "the rear principal plane");
}

StopImage stop_image(ModelKind model, const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space,
                     Meridian section) {
  return model == ModelKind::thin ? thin_image(facts, wavelength, space, section)
                                  : thick_image(facts, wavelength, space, section);
}

/// Largest sum of absolute coordinates of a line for which all maps give finite rays.
/// @throws Error  if no line gives finite rays
double reach_of(const Lens& lens, const std::vector<SectionMaps>& maps) {
  constexpr double max_value = farthest * largest;
  double most = 0;
  for (const SectionMaps& map : maps) {
    for (const double number : map.numbers()) {
      if (!(std::abs(number) <= max_value)) {
        throw Error(lens.name() + ": first-order map: value = " + to_text(number) + "; must be at most " +
                    to_text(max_value) + " in absolute value");
      }
      most = std::max(most, std::abs(number));
    }
  }
  return std::min(farthest, largest / most);
}

/// @throws Error  if the lens has no model of this kind
void check(ModelKind model, const LensFacts& facts) {
  const Lens& lens = facts.lens();
  if (!model.is_first_order()) {
    throw Error(lens.name() + ": model = " + std::string(name(model)) + "; must be a first-order model");
  }
  const bool cylinders = has_cylinders(lens);
  if (cylinders && (model == ModelKind::pinhole || model == ModelKind::thin_two_disc)) {
    throw Error(lens.name() + ": the lens has cylinders; must be a lens of revolution for " + std::string(name(model)) +
                ", or use another model");
  }
  for (std::size_t w = 0; w < facts.wavelengths(); ++w) {
    if (facts.first_order(w).afocal || (cylinders && first_order(lens, w, Meridian::x).afocal)) {
      throw Error(lens.name() + ": the lens is afocal; must have a focal length for a first-order model");
    }
  }
}

FilmPupilTable two_disc_pupils(const Lens& lens, double film_radius) {
  const FilmPupilTable round = FilmPupilTable::equal_area(with_iris(lens, {}), film_radius);
  std::vector<std::vector<PupilDisc>> discs;
  for (std::size_t w = 0; w < round.wavelengths(); ++w) {
    const auto fitted = fit_two_discs(real_edges(round, w));
    discs.emplace_back(fitted.begin(), fitted.end());
  }
  const FilmPupilTable matched = round.with_discs(discs);
  return lens.iris().round() ? matched : matched.with_stop(lens);
}

/// Semi-axis along y (mm) of the image of the iris for which the film centre has the irradiance of the exact lens.
/// @param along_x ratio of the semi-axes
double axial_radius(const Lens& lens, std::size_t wavelength, const TwoPlanes& space, const Iris& iris,
                    double along_x) {
  const double n = lens.index(lens.surface_count(), wavelength);
  const double irradiance = film_irradiance(lens, {}, wavelength) / (n * n);
  // Start with a disc of projected solid angle pi sin^2; the solid angle is nearly proportional to the squared radius.
  double radius = std::abs(space.depth()) * std::sqrt(irradiance / (std::numbers::pi - irradiance) / along_x);
  for (int round = 0; round < 6 && radius > 0; ++round) {
    const PupilImage image{{0, 0}, {along_x * radius, radius}};
    radius *= std::sqrt(irradiance / FilmPupilTable::of_iris(space, iris, {&image, 1}, 0).projected_solid_angle({}));
  }
  return radius;
}

}  // namespace

IrisImages iris_images(ModelKind model, const LensFacts& facts) {
  const Lens& lens = facts.lens();
  const TwoPlanes space = two_planes(lens);
  const auto image_at = [&](std::size_t w, Meridian section) { return stop_image(model, facts, w, space, section); };
  struct Sections {
    StopImage x, y;
  };
  std::vector<Sections> seen;
  for (std::size_t w = 0; w < facts.wavelengths(); ++w) {
    const StopImage y = image_at(w, Meridian::y);
    seen.push_back({has_cylinders(lens) ? image_at(w, Meridian::x) : y, y});
  }
  const std::size_t primary = lens.primary_wavelength();
  const Iris iris = iris_detail::upside_down(lens.iris(), seen[primary].x.size < 0, seen[primary].y.size < 0);
  std::vector<PupilImage> images;
  for (std::size_t w = 0; w < facts.wavelengths(); ++w) {
    const auto& [x, y] = seen[w];
    const double along_x = has_cylinders(lens) ? std::abs(x.size / y.size) : 1;  // sizes may be infinite
    const double radius = axial_radius(lens, w, space, iris, along_x);
    images.push_back({{x.shift, y.shift}, {along_x * radius, radius}});
  }
  return {space, iris, images};
}

namespace {

FilmPupilTable pupils_of(ModelKind model, const LensFacts& facts, double film_radius) {
  check(model, facts);
  const Lens& lens = facts.lens();
  if (model == ModelKind::thin_two_disc) return two_disc_pupils(lens, film_radius);
  const auto [space, iris, images] = iris_images(model, facts);
  return FilmPupilTable::of_iris(space, iris, images, film_radius, lens.primary_wavelength(), lens.wavelengths_nm());
}

}  // namespace

ParaxialModel::ParaxialModel(ModelKind model, const LensFacts& facts, double film_radius,
                             const std::optional<PupilRim>& rim, bool paraxial_focus)
    : RayModel(model, rim ? behind(*rim, pupils_of(model, facts, film_radius), facts.lens())
                          : pupils_of(model, facts, film_radius)),
      primary_(pupils().primary_wavelength()),
      z_(facts.lens().surfaces().front().vertex_z),
      paraxial_focus_(paraxial_focus),
      equal_sections_(!has_cylinders(facts.lens())) {
  const Lens& lens = facts.lens();
  const TwoPlanes& space = pupils().space();
  if (model != ModelKind::thin_two_disc) {
    const auto upside_down = [&](Meridian section) {
      return stop_image(model, facts, primary_, space, section).size < 0;
    };
    const bool along_y = upside_down(Meridian::y);
    stop_upside_down_ = {has_cylinders(lens) ? upside_down(Meridian::x) : along_y, along_y};
  }
  std::vector<SectionMaps> thick;
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    const RayMatrix y = to_scene_map(facts, w, space, Meridian::y, paraxial_focus);
    const RayMatrix x = has_cylinders(lens) ? to_scene_map(facts, w, space, Meridian::x, paraxial_focus) : y;
    thick.push_back({x, y});
    to_film_.push_back({x.inverse(), y.inverse()});
    const double middle = model == ModelKind::pinhole ? thick_image(facts, w, space, Meridian::y).shift : 0;
    if (model == ModelKind::pinhole) pinhole_shifts_.push_back(middle);
    to_scene_.push_back(seen_by(model, {x, y}, middle));
  }
  reach_ = reach_of(lens, to_scene_);
  const lens_detail::CompiledWavelengths wavelengths(lens.wavelengths_nm());
  const auto between = [&](const std::vector<SectionMaps>& maps) -> lens_detail::BetweenWavelengths<8> {
    std::vector<std::array<double, 8>> values;
    for (const SectionMaps& map : maps) values.push_back(map.numbers());
    return {wavelengths, values};
  };
  between_ = between(to_scene_);
  of_thick_lens_ = between(thick);
}

const SectionMaps* ParaxialModel::map_at(Wavelength at, SectionMaps& own) const noexcept {
  return at_wavelength(at, primary_, to_scene_, between_, own);
}

std::optional<SectionMaps> ParaxialModel::maps(Wavelength at) const noexcept {
  SectionMaps own;
  const SectionMaps* const found = map_at(at, own);
  return found ? std::optional(*found) : std::nullopt;
}

const SectionMaps* ParaxialModel::inverse_at(Wavelength at, SectionMaps& own) const noexcept {
  const SectionMaps* const found = at_wavelength(at, primary_, to_film_, of_thick_lens_, own);
  if (found == &own) own = {own.x.inverse(), own.y.inverse()};
  return found;
}

template <class T>
ParaxialJob<T> ParaxialModel::job(const RayWavelengths& wavelengths, SectionMaps& own) const noexcept {
  return {between_.rows<T>(), equal_sections_,        map_at(wavelengths.all, own),
          static_cast<T>(z_), static_cast<T>(reach_), wavelengths};
}

void ParaxialModel::to_scene(std::size_t count, const TwoPlaneRays<const float>& lines,
                             const RayWavelengths& wavelengths, const RayArrays<float>& rays, RayFate* fates,
                             const trace_detail::LensLight*, float*) const noexcept {
  SectionMaps own;
  camera_loops().single.map(count, job<float>(wavelengths, own), lines, rays, fates);
}

void ParaxialModel::to_scene(std::size_t count, const TwoPlaneRays<const double>& lines,
                             const RayWavelengths& wavelengths, const RayArrays<double>& rays, RayFate* fates,
                             const trace_detail::LensLight*, double*) const noexcept {
  SectionMaps own;
  camera_loops().twice.map(count, job<double>(wavelengths, own), lines, rays, fates);
}

RayFate ParaxialModel::to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                                const trace_detail::LensLight*, double*) const noexcept {
  const auto one = camera_loops().map_one;
  const std::size_t position = wavelength.index(primary_);
  if (position < to_scene_.size()) return one(&to_scene_[position], z_, reach_, line, ray);
  SectionMaps own;
  return one(map_at(wavelength, own), z_, reach_, line, ray);
}

RayOf<kernel::Dual> ParaxialModel::to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                                            RayFate& fate) const noexcept {
  SectionMaps own;
  const SectionMaps* const map = map_at(wavelength, own);
  fate = map ? RayFate::transmitted : RayFate::missed_surface;
  return mapped(map ? *map : own, z_, line);
}

void ParaxialModel::to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                            const TwoPlaneRays<double>& lines, RayFate* fates, const trace_detail::LensLight*,
                            double*) const noexcept {
  const auto fill = [&](std::size_t begin, std::size_t end, const SectionMaps* map) {
    const auto [mx, my] = map ? *map : SectionMaps{};
    const auto [film_x, film_y, pupil_x, pupil_y] = lines;
    const double reach = map ? farthest : -1;
    for (std::size_t i = begin; i < end; ++i) {
      const auto [x, y, slope_x, slope_y] = core_detail::slope_ray(core_detail::ray_at(rays, i), z_);
      const bool good = rays.dz[i] > 0 && std::abs(x) + std::abs(y) + std::abs(slope_x) + std::abs(slope_y) <= reach;
      fates[i] = good ? RayFate::transmitted : RayFate::missed_surface;
      film_x[i] = good ? mx.a * x + mx.b * slope_x : 0;
      film_y[i] = good ? my.a * y + my.b * slope_y : 0;
      pupil_x[i] = good ? mx.c * x + mx.d * slope_x : 0;
      pupil_y[i] = good ? my.c * y + my.d * slope_y : 0;
    }
  };
  SectionMaps own;
  if (wavelengths.shared()) {
    fill(0, count, inverse_at(wavelengths.all, own));
    return;
  }
  for (std::size_t i = 0; i < count; ++i) fill(i, i + 1, inverse_at(wavelengths.at(i), own));
}

}  // namespace petzval::camera_detail
