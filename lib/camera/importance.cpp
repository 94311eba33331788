// SPDX-License-Identifier: Apache-2.0
// Importance is defined by reciprocity: the integral over the film equals the integral over the scene. Let L be the
// radiance divided by the squared refractive index, as in all weights of this library. L is constant along a ray, and
// the etendue n^2 cos dA dw of a pencil is constant as well. Hence
//
//     mean over the film of (n'^2 L cos dw) = 1/A integral n'^2 cos L dw dA = integral (n^2 / A) L cos' dA' dw',
//
// with n' behind the lens and n in front of it: We = n^2 / A for every ray that reaches the film, for any medium at the
// film.
//
// A film sample has the density p_film p_pupil in film point and pupil position. Let len be the distance between both
// and t the angle between ray and axis, cos t = |depth| / len. Then dw = cos t dA_pupil / len^2. The sample has the
// density p_film p_pupil len^4 / depth^2 in cos dA dw at the film, and n^2 / n'^2 times this density in cos' dA' dw' of
// the scene. We divided by the scene density is the weight of the film sample.
//
// For a tilted or moved film, the density is the density of the upright line divided by TiltedPlane::weight().
//
// First-order models are linear in slopes and conserve the area of heights and slopes instead. In cos dA dw they lack
// the factor (cos t / cos t')^4, where t' is the angle of the ray in the scene. We and the density both get this
// factor, so that We divided by the density remains the weight of the film sample.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <type_traits>

#include "camera/polynomial_model.hpp"
#include "camera_data.hpp"
#include "camera_steps.hpp"
#include "core/meet_plane.hpp"
#include "make_model.hpp"
#include "paraxial_model.hpp"
#include "petzval/core/parallel.hpp"
#include "pupil_table/scene_grid.hpp"
#include "scene_side.hpp"

namespace petzval {
namespace camera_detail {
namespace {

constexpr double pi = std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity(), largest = std::numeric_limits<double>::max();

double squared(double x) noexcept { return x * x; }

bool unit_length(const Vec3<double>& direction) noexcept {
  return std::abs(glm::dot(direction, direction) - 1) < unit_direction_tolerance;
}

bool finite(const Vec3<double>& v) noexcept { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// True if the origin is finite and the direction a unit vector.
bool sound(const Ray<double>& ray) noexcept { return finite(ray.origin) && unit_length(ray.direction); }

/// Calls body(size, begin, count) for consecutive blocks of N rays; size: a constant, 1 for a single ray.
template <class Body>
void in_blocks(std::size_t count, const Body& body) noexcept {
  using Block = std::integral_constant<std::size_t, 64>;
  std::size_t begin = 0;
  for (; begin + 1 < count; begin += Block()) body(Block(), begin, std::min<std::size_t>(Block(), count - begin));
  if (begin < count) body(std::integral_constant<std::size_t, 1>(), begin, 1);
}

/// A connection to a position in the lens. `front_distance` is the distance from the front of the lens to the position;
/// the distance and the end of the shadow ray are reduced by it.
ImportanceSample connected(const Vec3<double>& position, const Vec3<double>& direction, double distance,
                           double front_distance, double pdf) noexcept {
  return {direction, distance - front_distance, position - direction * front_distance, pdf, {}};
}

/// Rays of a model in the scene, for each wavelength.
std::vector<std::vector<Ray<double>>> leaving_rays_of(const Lens& lens, const RayModel& model, int threads) {
  return leaving_rays(
      model.pupils(), lens.rotationally_symmetric(),
      [&](std::size_t count, const TwoPlaneRays<const double>& lines, std::size_t wavelength,
          const RayArrays<double>& rays,
          RayFate* fates) { model.to_scene(count, lines, {.all = wavelength}, rays, fates); },
      threads);
}

/// Tests if a model passes rays of the scene; rays may meet the film plane outside the film.
ScenePassing passing(const RayModel& model) {
  return
      [&model](std::size_t count, const RayArrays<const double>& rays, std::size_t wavelength, std::uint8_t* passes) {
        const FilmPupilTable& pupils = model.pupils();
        std::array<std::vector<double>, 4> line;
        for (auto& values : line) values.resize(count);
        std::vector<RayFate> fates(count);
        model.to_film(count, rays, {.all = wavelength},
                      {line[0].data(), line[1].data(), line[2].data(), line[3].data()}, fates.data());
        for (std::size_t i = 0; i < count; ++i) {
          // Points outside the film are assigned the pupil of the edge of the film.
          const double radius = std::hypot(line[0][i], line[1][i]);
          const double fraction = radius > pupils.film_radius() ? pupils.film_radius() / radius : 1;
          passes[i] = fates[i] == RayFate::transmitted &&
                      (model.clips_at_apertures() || pupils.contains({fraction * line[0][i], fraction * line[1][i]},
                                                                     line[2][i], line[3][i], wavelength));
        }
      };
}

/// The entrance pupils of scene points. They include rays that meet the film plane outside the film; otherwise pupils
/// would end abruptly at the edge of the film.
EntrancePupilTable entrance_of(const Lens& lens, const RayModel& model, int threads) {
  if (model.kind().is_exact()) return traced_entrances(lens, model.pupils(), threads);
  if (model.kind().is_first_order() && !lens.iris().round()) {  // the pupils of a round stop enclose the others
    const Lens round = with_iris(lens, {});
    const double radius = model.pupils().film_radius();
    return entrance_of(round, *make_model(model.kind(), round, radius, 1, {}, model.first_order()->paraxial_focus()),
                       threads);
  }
  if (const RayPolynomial* const polynomial = model.polynomial(); polynomial && !lens.iris().round()) {
    return entrance_of(with_iris(lens, {}), PolynomialModel(*polynomial, model.pupils().with_round_stop()), threads);
  }
  // A pinhole needs no rays, only the front of the lens.
  if (model.pinhole()) {
    return EntrancePupilTable(lens, std::vector<std::vector<Ray<double>>>(model.pupils().wavelengths()), {});
  }
  return EntrancePupilTable(lens, leaving_rays_of(lens, model, threads),
                            model.kind().is_polynomial() ? traced_passing(lens) : passing(model), threads);
}

/// Distance from which the pupil equals the pupil at infinity up to rounding, mm.
constexpr double infinite_distance_mm = 1e12;

/// The point of a ray's line nearest to the vertex; it keeps the precision of rays from distant origins.
Vec3<double> nearest_to_lens(const Ray<double>& ray) noexcept {
  return ray.origin - ray.direction * glm::dot(ray.origin, ray.direction);
}

/// Proportional to chief_scale() of a film point, as a function of the position at which a pinhole's ray passes the
/// pupil plane.
double depth_ratio_at(const TiltedPlane& plane, const FilmPoint& position) noexcept {
  return 1 + plane.travel - (plane.slope_x * position.x + plane.slope_y * position.y);
}

/// Area of the entrance pupil whose image is the pupil of a pinhole on the axis, mm^2. Film point and pupil position
/// are linear in height and slope of a ray at the entrance pupil. For a film point on the axis, the height is therefore
/// linear in the pupil position.
double pinhole_entrance_area(const RayModel& model, double entrance_z, std::size_t wavelength) noexcept {
  const auto image = [&](double height, double slope) {
    const double z = 1 / std::hypot(slope, 1.0), direction = slope * z, zero = 0;
    double film_x = 0, film_y = 0, pupil_x = 0, pupil_y = 0;
    RayFate fate = RayFate::missed_surface;
    model.to_film(1, {&height, &zero, &entrance_z, &direction, &zero, &z}, {.all = wavelength},
                  {&film_x, &film_y, &pupil_x, &pupil_y}, &fate);
    return std::array{film_x, pupil_x};
  };
  const auto [film_by_height, pupil_by_height] = image(1, 0);
  const auto [film_by_slope, pupil_by_slope] = image(0, 1);
  const double height_by_pupil = film_by_slope / (pupil_by_height * film_by_slope - pupil_by_slope * film_by_height);
  return model.pupils().unclipped().area({}, wavelength) * squared(height_by_pupil);
}

}  // namespace

SceneSide::SceneSide(const LensFacts& facts, const Film& film, std::optional<TiltedFilm> tilted, const Front& front,
                     const LocalFocus& focus, const RayModel& model, double radius, const WavelengthFacts& wavelengths,
                     const PupilWeights& weights, const Transmission& transmission, int threads)
    : film_(film),
      tilted_(std::move(tilted)),
      upright_radius_(radius),
      pdf_film_(1 / film.area_mm2()),
      bounds_(core_detail::bounds_of<double>(film)),
      space_(model.pupils().space()),
      front_(front),
      focus_(focus),
      wavelengths_(wavelengths),
      weights_(weights),
      transmission_(transmission),
      pupils_(weights.pupils().value_or(model.pupils())),
      in_nm_(facts.lens().wavelengths_nm()),
      primary_(model.pupils().primary_wavelength()),
      entrance_(focus ? focus.entrances(facts.lens(), model, threads) : entrance_of(facts.lens(), model, threads)) {
  const Lens& lens = facts.lens();
  if (model.kind().is_exact()) traced_ = lens;
  if (model.pinhole() && pupils_.is_clipped()) {
    unclipped_ = tilted_ ? TiltedFilm(film, pupils_.unclipped()).pupils() : pupils_.unclipped();
  }
  std::vector<std::optional<ChiefRayTable>> chiefs(wavelengths.count());
  parallel_for(wavelengths.count(), 1, threads, [&](std::size_t w, std::size_t) {
    chiefs[w].emplace(facts, model, upright_radius_, w, focus ? std::optional(focus.middle(w)) : std::nullopt);
  });
  std::vector<std::array<double, 3>> values;
  for (std::size_t w = 0; w < wavelengths.count(); ++w) {
    const double n = lens.index(0, w), n_film = lens.index(lens.surface_count(), w), etendue = squared(n / n_film);
    const Pupil entrance = facts.pupils(w).entrance;
    const double across = has_cylinders(lens) ? pupils(lens, w, Meridian::x).entrance.diameter : entrance.diameter;
    const double found =
        model.pinhole() ? pinhole_entrance_area(model, entrance.z, w) : pi / 4 * across * entrance.diameter;
    // If the area is below the smallest normal number, 1 / area is not finite: vignette all rays.
    const double area = found >= std::numeric_limits<double>::min() ? found : 0;
    compiled_.push_back({{.we = etendue * wavelengths.scale(w) / film.area_mm2(),
                          .density = etendue / film.area_mm2() / squared(space_.depth()),
                          .entrance_z = entrance.z,
                          .entrance_area = area},
                         *std::move(chiefs[w])});
    values.push_back({etendue, entrance.z, area});
  }
  between_ = {in_nm_, values};
}

const SceneSide::Compiled& SceneSide::nearest(Wavelength wavelength) const noexcept {
  const auto nm = wavelength.in_nm();
  return compiled_[nm ? in_nm_.nearest(*nm) : wavelength.index(primary_)];
}

SceneSide::Facts SceneSide::facts_at(Wavelength wavelength) const noexcept {
  const Compiled& neighbour = nearest(wavelength);
  const auto nm = wavelength.in_nm();
  if (!nm) return neighbour;
  const auto [etendue, entrance_z, area] = between_(*nm);
  // Positions cannot be interpolated if a pupil lies at infinity.
  const bool placed = std::isfinite(entrance_z) && std::isfinite(area) && neighbour.entrance_area > 0;
  return {.we = etendue * wavelengths_.scale(wavelength) / film_.area_mm2(),
          .density = etendue / film_.area_mm2() / squared(space_.depth()),
          .entrance_z = placed ? entrance_z : neighbour.entrance_z,
          .entrance_area = placed ? area : neighbour.entrance_area};
}

bool SceneSide::valid(const Ray<double>& ray, Wavelength wavelength) const noexcept {
  return wavelengths_.covers(wavelength) && sound(ray);
}

std::optional<TiltedPlane> SceneSide::plane(double time) const noexcept {
  if (!tilted_) return {};
  return tilted_->plane(time);
}

std::optional<SceneSide::OnFilm> SceneSide::meet_film(const TwoPlaneRay& ray,
                                                      const std::optional<TiltedPlane>& plane) noexcept {
  if (!plane) return OnFilm{{ray.film_x, ray.film_y}, {ray.film_x, ray.film_y}};
  const auto point = plane->virtual_point_of(ray);
  if (!point) return {};
  return OnFilm{plane->point(*point), *point};
}

template <std::size_t block>
void SceneSide::arrive(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
                       const RayWavelengths& wavelengths, const double* times, Arrivals<block>& found) const noexcept {
  std::array<double, block> x, y, z, dx, dy, dz;
  std::array<RayFate, block> refusals;
  const auto put = [&](std::size_t i, const Ray<double>& ray) {
    x[i] = ray.origin.x, y[i] = ray.origin.y, z[i] = ray.origin.z;
    dx[i] = ray.direction.x, dy[i] = ray.direction.y, dz[i] = ray.direction.z;
  };
  const bool shared = wavelengths.shared();
  const bool all_covered = shared && wavelengths_.covers(wavelengths.all);
  for (std::size_t i = 0; i < count; ++i) {
    const Ray<double> ray = core_detail::ray_at(rays, i);
    const bool covered = shared ? all_covered : wavelengths_.covers(wavelengths.at(i));
    const bool usable = covered && sound(ray);
    refusals[i] = usable ? RayFate::transmitted : refused(wavelengths.at(i));
    found.cosine[i] = ray.direction.z, found.spread[i] = found.facing[i] = 1;
    put(i, usable ? Ray<double>{nearest_to_lens(ray), ray.direction} : Ray<double>{{0, 0, 0}, {0, 0, 1}});
  }
  for (std::size_t i = 0; i < count && focus_; ++i) {
    if (refusals[i] != RayFate::transmitted) continue;
    const Ray<double> ray{{x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}};
    const auto straight = focus_.straighten(ray, wavelengths.at(i), plane(times ? times[i] : 0));
    if (straight.spread > 0) {
      found.spread[i] = straight.spread;
      put(i, straight.ray);
    } else {
      refusals[i] = RayFate::vignetted;
    }
  }
  const RayArrays<const double> straight{x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()};
  model.to_film(count, straight, wavelengths, found.lines(), found.fates.data(), transmission_.light(),
                found.transmittance.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (refusals[i] != RayFate::transmitted) found.fates[i] = refusals[i];
    found.met_x[i] = found.virtual_x[i] = found.upright_x[i];
    found.met_y[i] = found.virtual_y[i] = found.upright_y[i];
  }
  for (std::size_t i = 0; i < count && tilted_; ++i) {
    const auto placed = plane(times ? times[i] : 0);
    const FilmPoint pupil{found.pupil_x[i], found.pupil_y[i]};
    // A ray that misses the film plane is outside the film.
    const auto [met, virtual_point] = meet_film({found.upright_x[i], found.upright_y[i], pupil.x, pupil.y}, placed)
                                          .value_or(OnFilm{{infinity, infinity}, {0, 0}});
    found.met_x[i] = met.x, found.met_y[i] = met.y;
    found.virtual_x[i] = virtual_point.x, found.virtual_y[i] = virtual_point.y;
    found.facing[i] = placed->weight(virtual_point, pupil);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const bool misses = !on_film(bounds_, found.met_x[i], found.met_y[i]);
    if (misses && found.fates[i] == RayFate::transmitted) found.fates[i] = RayFate::outside_film;
  }
}

template <std::size_t block>
void SceneSide::weigh(const RayModel& model, std::size_t count, const RayWavelengths& wavelengths,
                      const Arrivals<block>& arrivals, const double* areas, Importance* found) const noexcept {
  std::array<double, block> we, density, entrance_area, pdf_pupil, pdf_position, pdf_direction;
  const bool shared = wavelengths.shared();
  const Facts all = shared && wavelengths_.covers(wavelengths.all) ? facts_at(wavelengths.all) : Facts{};
  for (std::size_t i = 0; i < count; ++i) {
    const Facts own = shared || !arrivals.lit(i) ? all : facts_at(wavelengths.at(i));
    we[i] = own.we, density[i] = own.density, entrance_area[i] = own.entrance_area;
  }
  if (transmission_) {
    std::array<double, block> transmittances = arrivals.transmittance;
    transmission_.fill<double>(count, arrivals.upright_lines(), wavelengths, transmittances.data());
    for (std::size_t i = 0; i < count; ++i) we[i] *= transmittances[i];
  }
  const double depth2 = squared(space_.depth());
  const bool linear = model.linear_in_slopes();
  for (std::size_t i = 0; i < count; ++i) {
    const double length2 = squared(arrivals.pupil_x[i] - arrivals.upright_x[i]) +
                           squared(arrivals.pupil_y[i] - arrivals.upright_y[i]) + depth2;
    const double slope = depth2 / (length2 * squared(arrivals.cosine[i]));
    const double slopes = (linear ? squared(slope) : 1) / arrivals.spread[i];
    const double position = entrance_area[i] <= largest ? 1 / entrance_area[i] : 1;
    we[i] *= slopes;
    pdf_pupil[i] = areas[i] > 0 ? 1 / areas[i] : 0;
    // A pupil at infinity has no position: the direction carries all of the density.
    pdf_position[i] = position;
    pdf_direction[i] = density[i] * squared(length2) / arrivals.facing[i] * slopes * pdf_pupil[i] / position;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Importance& result = found[i] = {.fate = arrivals.fates[i]};
    const FilmPoint film{arrivals.met_x[i], arrivals.met_y[i]};
    const bool meets = result.fate == RayFate::transmitted || result.fate == RayFate::outside_film;
    if (meets && film.x < infinity) result.film = film, result.raster = film_.raster(film);
    if (result.fate != RayFate::transmitted) continue;
    if (entrance_area[i] == 0 || !(areas[i] > 0) || (transmission_ && !(we[i] > 0))) {
      result.fate = RayFate::vignetted;
      continue;
    }
    result.we = we[i], result.pdf_film = pdf_film_, result.pdf_pupil = pdf_pupil[i];
    result.pdf_position = pdf_position[i], result.pdf_direction = pdf_direction[i];
  }
}

void SceneSide::importance(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
                           const RayWavelengths& wavelengths, const double* times, Importance* found) const noexcept {
  in_blocks(count, [&](auto size, std::size_t begin, std::size_t n) {
    importance_block<decltype(size)::value>(model, n, rays.from(begin), wavelengths.from(begin),
                                            times ? times + begin : nullptr, found + begin);
  });
}

template <std::size_t block>
void SceneSide::importance_block(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
                                 const RayWavelengths& wavelengths, const double* times,
                                 Importance* found) const noexcept {
  // Only connections meet the pinhole: a given ray has probability 0.
  if (model.pinhole()) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool usable = valid(core_detail::ray_at(rays, i), wavelengths.at(i));
      found[i] = {.fate = usable ? RayFate::vignetted : refused(wavelengths.at(i))};
    }
    return;
  }
  Arrivals<block> arrivals;
  arrive(model, count, rays, wavelengths, times, arrivals);
  // Rays may arrive outside the sampled pupil, through other zones of the surfaces (for example of a ball lens): their
  // area is 0.
  const FilmPupilTable& sampled = tilted_ ? tilted_->pupils() : pupils_;
  std::array<double, block> areas;
  sampled.sample_areas<double>(count, arrivals.virtual_lines(), wavelengths, areas.data());
  if (tilted_ && decide(pupils_, model)) {
    std::array<std::uint8_t, block> passes;
    pupils_.contains<double>(count, arrivals.upright_lines(), wavelengths, passes.data());
    for (std::size_t i = 0; i < count; ++i) areas[i] = passes[i] ? areas[i] : 0;
  }
  weigh(model, count, wavelengths, arrivals, areas.data(), found);
  for (std::size_t i = 0; i < count && weights_; ++i) {
    Importance& result = found[i];
    if (result.fate != RayFate::transmitted) continue;
    const FilmPoint virtual_point{arrivals.virtual_x[i], arrivals.virtual_y[i]};
    const FilmPoint pupil{arrivals.pupil_x[i], arrivals.pupil_y[i]};
    const double density = weights_.density(sampled.position(virtual_point, pupil.x, pupil.y, wavelengths.at(i)));
    result.we *= weights_.of_line({arrivals.upright_x[i], arrivals.upright_y[i], pupil.x, pupil.y}, wavelengths.at(i));
    result.pdf_pupil *= density, result.pdf_direction *= density;
    if (!(result.we > 0)) result.fate = RayFate::vignetted;
  }
}

void SceneSide::sample_importance(const RayModel& model, std::size_t count, const Vec3<double>* points, const double* u,
                                  const double* v, const RayWavelengths& wavelengths, const double* times,
                                  ImportanceSample* found) const noexcept {
  if (model.pinhole()) {
    for (std::size_t i = 0; i < count; ++i) {
      found[i] = through_pinhole(model, points[i], u[i], v[i], wavelengths.at(i), times ? times[i] : 0);
    }
    return;
  }
  in_blocks(count, [&](auto size, std::size_t begin, std::size_t n) {
    connect<decltype(size)::value>(model, n, points + begin, u + begin, v + begin, wavelengths.from(begin),
                                   times ? times + begin : nullptr, found + begin);
  });
}

template <std::size_t block>
void SceneSide::connect(const RayModel& model, std::size_t count, const Vec3<double>* points, const double* u,
                        const double* v, const RayWavelengths& wavelengths, const double* times,
                        ImportanceSample* found) const noexcept {
  std::array<double, block> x, y, z, dx, dy, dz, distance, pdf, front_distance;
  std::array<Importance, block> importances;
  // Points without a connection also get valid rays, with pdf = 0.
  entrance_.sample(count, points, u, v, wavelengths,
                   {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data(), distance.data(), pdf.data()});
  importance_block<block>(model, count, {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}, wavelengths,
                          times, importances.data());
  for (std::size_t i = 0; i < count; ++i) {
    const double to_front =
        distance_to_front(front_.curvature, x[i], y[i], z[i] - front_.vertex_z, -dx[i], -dy[i], -dz[i]);
    front_distance[i] = to_front < distance[i] ? to_front : distance[i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (pdf[i] > 0) {
      found[i] = connected({x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}, distance[i], front_distance[i], pdf[i]);
      found[i].importance = importances[i];
    } else {
      const bool known = wavelengths_.covers(wavelengths.at(i)) && finite(points[i]);
      found[i] = {};
      if (!known) found[i].importance.fate = refused(wavelengths.at(i));
    }
  }
}

ImportanceSample SceneSide::sample_distant(const RayModel& model, const Vec3<double>& direction, double u, double v,
                                           Wavelength wavelength, double time) const noexcept {
  if (!wavelengths_.covers(wavelength) || !unit_length(direction)) {
    return {.importance = {.fate = refused(wavelength)}};
  }
  ImportanceSample result;
  const Vec3<double> point = direction * -infinite_distance_mm;
  if (model.pinhole()) {
    const ImportanceSample s = through_pinhole(model, point, u, v, wavelength, time);
    result =
        connection({0, 0, facts_at(wavelength).entrance_z}, direction, infinity, s.pdf / squared(infinite_distance_mm));
    result.importance = s.importance;
    return result;
  }
  const EntranceSample s = entrance_.sample(point, u, v, wavelength);
  if (!(s.pdf > 0)) return result;
  result = connection(s.origin, direction, infinity, s.pdf / squared(infinite_distance_mm));
  const auto& [o, d] = Ray<double>{s.origin, direction};
  importance(model, 1, {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, {.all = wavelength}, &time, &result.importance);
  return result;
}

ImportanceSample SceneSide::connection(const Vec3<double>& position, const Vec3<double>& direction, double distance,
                                       double pdf) const noexcept {
  const double to_front = distance_to_front(front_.curvature, position.x, position.y, position.z - front_.vertex_z,
                                            -direction.x, -direction.y, -direction.z);
  return connected(position, direction, distance, std::min(to_front, distance), pdf);
}

ImportanceSample SceneSide::through_pinhole(const RayModel& model, const Vec3<double>& point, double u, double v,
                                            Wavelength wavelength, double time) const noexcept {
  ImportanceSample result;
  if (!wavelengths_.covers(wavelength) || !finite(point)) return {.importance = {.fate = refused(wavelength)}};
  if (!entrance_.in_front(point)) return result;
  const Facts at = facts_at(wavelength);
  const Vec3<double> pupil{0, 0, at.entrance_z}, to = pupil - point;
  const double distance = glm::length(to);
  if (!std::isfinite(distance) || !std::isfinite(at.entrance_area) || !(at.entrance_area > 0 && to.z > 0))
    return result;
  // Weights and pupil positions represent the complete pupil of the thick lens.
  const Vec3<double> direction = to / distance;
  result = connection(pupil, direction, distance, squared(distance) / (at.entrance_area * direction.z));
  Arrivals<1> arrival;
  arrive(model, 1, {&pupil.x, &pupil.y, &pupil.z, &direction.x, &direction.y, &direction.z}, {.all = wavelength}, &time,
         arrival);
  const auto drawn = weights_.draw(u, v);
  const FilmPupilTable& pupils = tilted_ ? tilted_->pupils() : pupils_;
  const FilmPoint met{arrival.virtual_x[0], arrival.virtual_y[0]};
  const PupilSample s = pupils.sample(met, drawn.u, drawn.v, wavelength);
  const FilmPoint position{s.x, s.y};
  double spread = 1, area = s.area;
  if (const auto placed = plane(time); placed && arrival.lit(0)) {
    // Film points of rays through this pupil position are spaced differently on the tilted film than film points of
    // rays through the pinhole.
    spread = depth_ratio_at(*placed, position) / depth_ratio_at(*placed, {arrival.pupil_x[0], arrival.pupil_y[0]});
    arrival.facing[0] = placed->weight(met, position);
    const TwoPlaneRay line = placed->upright(met, position);
    arrival.upright_x[0] = line.film_x, arrival.upright_y[0] = line.film_y;
    const bool clipped = !model.clips_at_apertures() &&
                         !pupils_.contains({line.film_x, line.film_y}, position.x, position.y, wavelength);
    if (clipped || !(spread > 0)) area = 0;
  }
  arrival.pupil_x[0] = position.x, arrival.pupil_y[0] = position.y;
  Importance& seen = result.importance;
  weigh(model, 1, {.all = wavelength}, arrival, &area, &seen);
  if (seen.fate != RayFate::transmitted) return result;
  // A rim clips the entrance pupil by the same fraction as the exit pupil.
  if (unclipped_) {
    // Tilted films sample the round stop, and the iris clips some of these rays.
    const double sampled = tilted_ ? s.area : pupils.polygon_area(met, wavelength);
    const double all = tilted_ ? unclipped_->area(met, wavelength) : unclipped_->polygon_area(met, wavelength);
    const double fraction = sampled / all;
    result.pdf /= fraction, seen.pdf_position /= fraction, seen.pdf_direction *= fraction;
  }
  seen.we *= spread, seen.pdf_direction *= spread;
  if (weights_) {
    const TwoPlaneRay line{arrival.upright_x[0], arrival.upright_y[0], position.x, position.y};
    seen.we *= weights_.of_sample(drawn.u, drawn.v, line, wavelength) / drawn.density;
    seen.pdf_pupil *= drawn.density, seen.pdf_direction *= drawn.density;
  }
  return result;
}

double SceneSide::pdf(const RayModel& model, const Vec3<double>& point, const Vec3<double>& direction,
                      Wavelength wavelength) const noexcept {
  const Ray<double> ray{point, direction};
  return model.pinhole() || !valid(ray, wavelength) ? 0 : entrance_.pdf(point, ray, wavelength);
}

double SceneSide::pdf_distant(const RayModel& model, const Ray<double>& ray, Wavelength wavelength) const noexcept {
  if (model.pinhole() || !valid(ray, wavelength)) return 0;
  return entrance_.pdf(ray.direction * -infinite_distance_mm, ray, wavelength) / squared(infinite_distance_mm);
}

}  // namespace camera_detail

CameraRay Camera::sample_path(const CameraSample& given, std::span<const double> nm, PathWavelength* found) const {
  CameraSample hero = given;
  hero.wavelength = nm.empty() ? Wavelength() : Wavelength::nm(nm.front());
  const CameraRay ray = sample(hero);
  constexpr std::size_t block = 16;
  std::array<std::array<double, block>, 7> rays;  // the same ray at each wavelength, as a batch
  const Vec3<double> origin = ray.ray.origin, direction = -ray.ray.direction;
  for (std::size_t k = 0; k < 3; ++k) {
    rays[k].fill(origin[static_cast<int>(k)]), rays[k + 3].fill(direction[static_cast<int>(k)]);
  }
  rays[6].fill(given.time);
  double density = 0;
  for (std::size_t begin = 0; begin < nm.size(); begin += block) {
    const std::size_t n = std::min(block, nm.size() - begin);
    std::array<float, block> own;
    std::array<Importance, block> results;
    std::ranges::transform(nm.subspan(begin, n), own.begin(), [](double value) { return static_cast<float>(value); });
    if (ray) {
      importance(n, {rays[0].data(), rays[1].data(), rays[2].data(), rays[3].data(), rays[4].data(), rays[5].data()},
                 {.each_nm = own.data()}, results.data(), rays[6].data());
    }
    for (std::size_t i = 0; i < n; ++i) {
      PathWavelength& one = found[begin + i];
      one = {.raster = film().raster(given.film), .fate = ray ? results[i].fate : ray.fate};
      if (!ray || !results[i]) continue;
      one = {results[i].raster, results[i].we, results[i].pdf_position * results[i].pdf_direction, results[i].fate};
      density += one.density / static_cast<double>(nm.size());
    }
  }
  const bool pinhole = data_->model.pinhole();
  for (std::size_t i = 0; ray && i < nm.size(); ++i) {
    if (pinhole) found[i].weight = ray.weight, found[i].fate = ray.fate;
    if (!pinhole) found[i].weight = density > 0 ? found[i].weight / density : 0;
  }
  return ray;
}

Importance Camera::importance(const Ray<double>& ray, Wavelength wavelength, double time) const {
  const auto& [o, d] = ray;
  Importance found;
  data_->scene().importance(data_->model, 1, {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, {.all = data_->resolved(wavelength)},
                            &time, &found);
  return found;
}

void Camera::importance(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                        Importance* found, const double* times) const {
  data_->in_range(count, wavelengths, [&](std::size_t begin, std::size_t n, const RayWavelengths& own) {
    data_->scene().importance(data_->model, n, rays.from(begin), own, times ? times + begin : nullptr, found + begin);
  });
}

ImportanceSample Camera::sample_importance(const Vec3<double>& point, double u, double v, Wavelength wavelength,
                                           double time) const {
  ImportanceSample found;
  data_->scene().sample_importance(data_->model, 1, &point, &u, &v, {.all = data_->resolved(wavelength)}, &time,
                                   &found);
  return found;
}

void Camera::sample_importance(std::size_t count, const Vec3<double>* points, const double* u, const double* v,
                               const RayWavelengths& wavelengths, ImportanceSample* found, const double* times) const {
  data_->in_range(count, wavelengths, [&](std::size_t begin, std::size_t n, const RayWavelengths& own) {
    data_->scene().sample_importance(data_->model, n, points + begin, u + begin, v + begin, own,
                                     times ? times + begin : nullptr, found + begin);
  });
}

ImportanceSample Camera::sample_distant_importance(const Vec3<double>& direction, double u, double v,
                                                   Wavelength wavelength, double time) const {
  return data_->scene().sample_distant(data_->model, direction, u, v, data_->resolved(wavelength), time);
}

double Camera::pdf_importance(const Vec3<double>& point, const Vec3<double>& direction, Wavelength wavelength) const {
  return data_->scene().pdf(data_->model, point, direction, data_->resolved(wavelength));
}

double Camera::pdf_distant_importance(const Ray<double>& ray, Wavelength wavelength) const {
  return data_->scene().pdf_distant(data_->model, ray, data_->resolved(wavelength));
}

Projection Camera::project(const Vec3<double>& point, Wavelength wavelength, double time) const {
  return data_->scene().project(data_->model, point, data_->resolved(wavelength), time);
}

}  // namespace petzval
