// SPDX-License-Identifier: Apache-2.0
// Film and scene hold the same light. With the radiance L divided by the square of the index (as every weight here
// takes it), it is the same all along a ray, and so is the etendue n^2 cos dA dw of a pencil about it. Hence
//
//     mean over the film of (n'^2 L cos dw) = 1/A integral n'^2 cos L dw dA = integral (n^2 / A) L cos' dA' dw',
//
// n' behind the lens and n before it: We = n^2 / A for every ray that arrives, whatever the film lies in.
//
// A film sample has the density p_film p_pupil in film point and place in the pupil's plane. Over that plane, seen
// under the angle t from len away, dw = cos t dA_pupil / len^2 with cos t = |depth| / len, so that it has the density
// p_film p_pupil len^4 / depth^2 in cos dA dw at the film, and n^2 / n'^2 times that in cos' dA' dw' of the scene. We
// divided by it is the weight of the film sample: reciprocity.
//
// Where the film is tilted or has travelled, its sample's density is that of the upright line over
// TiltedPlane::weight().
//
// Models of first order are linear in slopes and conserve the area of heights and slopes instead; in cos dA dw they
// lack (cos t / cos t')^4, t' the angle of the ray in the scene. It belongs to both, for theirs to be the weights that
// their film samples have.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "camera_data.hpp"
#include "make_model.hpp"
#include "petzval/camera/polynomial_model.hpp"
#include "pupil_table/scene_grid.hpp"
#include "scene_side.hpp"
#include "tilted_pinhole.hpp"

namespace petzval {
namespace camera_detail {
namespace {

constexpr double pi = std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

double squared(double x) noexcept { return x * x; }

bool unit_length(const Vec3<double>& direction) noexcept {
  return std::abs(glm::dot(direction, direction) - 1) < unit_direction_tolerance;
}

bool finite(const Vec3<double>& v) noexcept { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// The rays that leave a model for the scene.
std::vector<std::vector<Ray<double>>> leaving_rays_of(const Lens& lens, const AnyRayModel& model) {
  return leaving_rays(model.pupils(), lens.rotationally_symmetric(),
                      [&](std::size_t count, const TwoPlaneRays<const double>& lines, std::size_t wavelength,
                          const RayArrays<double>& rays,
                          RayFate* fates) { model.to_scene(count, lines, {.all = wavelength}, rays, fates); });
}

/// Whether a model passes rays of the scene, wherever they meet the film's plane.
ScenePassing passing(const AnyRayModel& model) {
  return
      [&model](std::size_t count, const RayArrays<const double>& rays, std::size_t wavelength, std::uint8_t* passes) {
        const FilmPupilTable& pupils = model.pupils();
        std::array<std::vector<double>, 4> line;
        for (auto& values : line) values.resize(count);
        std::vector<RayFate> fates(count);
        model.to_film(count, rays, {.all = wavelength},
                      {line[0].data(), line[1].data(), line[2].data(), line[3].data()}, fates.data());
        for (std::size_t i = 0; i < count; ++i) {
          // Points beside the film see the pupil of its edge.
          const double radius = std::hypot(line[0][i], line[1][i]);
          const double part = radius > pupils.film_radius() ? pupils.film_radius() / radius : 1;
          passes[i] = fates[i] == RayFate::transmitted &&
                      (model.clips_at_apertures() ||
                       pupils.contains({part * line[0][i], part * line[1][i]}, line[2][i], line[3][i], wavelength));
        }
      };
}

/// The pupils that points of the scene see. Rays count wherever they meet the film's plane: pupils would end abruptly
/// with the film.
EntrancePupilTable entrance_of(const Lens& lens, const AnyRayModel& model) {
  const bool exact = model.kind() == ModelKind::exact_float || model.kind() == ModelKind::exact_double;
  if (exact) return traced_entrances(lens, model.pupils());
  if (model.kind().is_first_order() && !lens.iris().round()) {  // whose pupils the round stop's enclose
    const Lens round = with_iris(lens, {});
    return entrance_of(round, make_model(model.kind(), round, model.pupils().film_radius()));
  }
  if (const auto* polynomial = model.as<PolynomialModel>(); polynomial && !lens.iris().round()) {
    return entrance_of(with_iris(lens, {}), PolynomialModel(polynomial->polynomial(), model.pupils().of_round_stop()));
  }
  // A pinhole only needs to know what lies in front of the lens.
  if (model.pinhole()) {
    return EntrancePupilTable(lens, std::vector<std::vector<Ray<double>>>(model.pupils().wavelengths()), {});
  }
  return EntrancePupilTable(lens, leaving_rays_of(lens, model),
                            model.kind().is_polynomial() ? traced_passing(lens) : passing(model),
                            model.clips_at_apertures() ? ClippedBy::apertures : ClippedBy::samples);
}

/// The pupil that a point so far away sees is that of infinity within rounding, mm.
constexpr double far = 1e12;

/// The point of a ray's line from which nothing is lost on the way to the lens, however far it comes.
Vec3<double> nearest_to_lens(const Ray<double>& ray) noexcept {
  return ray.origin - ray.direction * glm::dot(ray.origin, ray.direction);
}

/// The area of the entrance pupil that a pinhole's pupil on the axis is the image of, mm^2. Film and pupil points are
/// linear in height and slope of a ray at the entrance pupil; of a film point on the axis, so is the height in the
/// pupil point.
double pinhole_entrance_area(const AnyRayModel& model, double entrance_z, std::size_t wavelength) noexcept {
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
  return model.pupils().whole().area({}, wavelength) * squared(height_by_pupil);
}

}  // namespace

SceneSide::SceneSide(const LensFacts& facts, const Film& film, std::optional<TiltedFilm> tilted, const Front& front,
                     const LocalFocus& focus, const AnyRayModel& model, double radius,
                     const WavelengthFacts& wavelengths, const PupilWeights& weights)
    : film_(film),
      tilted_(std::move(tilted)),
      upright_radius_(radius),
      pdf_film_(1 / film.area_mm2()),
      space_(model.pupils().space()),
      front_(front),
      focus_(focus),
      wavelengths_(wavelengths),
      weights_(weights),
      pupils_(weights.pupils().value_or(model.pupils())),
      in_nm_(facts.lens().wavelengths_nm()),
      primary_(model.pupils().primary_wavelength()),
      entrance_(focus ? focus.entrances(facts.lens(), model) : entrance_of(facts.lens(), model)) {
  const Lens& lens = facts.lens();
  if (model.kind() == ModelKind::exact_float || model.kind() == ModelKind::exact_double) traced_ = lens;
  if (model.pinhole() && pupils_.cut()) {
    whole_ = tilted_ ? TiltedFilm(film, pupils_.whole()).pupils() : pupils_.whole();
  }
  std::vector<std::array<double, 3>> values;
  for (std::size_t w = 0; w < wavelengths.count(); ++w) {
    const double n = lens.index(0, w), n_film = lens.index(lens.surface_count(), w), etendue = squared(n / n_film);
    const Pupil entrance = facts.pupils(w).entrance;
    const double across = has_cylinders(lens) ? pupils(lens, w, Meridian::x).entrance.diameter : entrance.diameter;
    const double found =
        model.pinhole() ? pinhole_entrance_area(model, entrance.z, w) : pi / 4 * across * entrance.diameter;
    // Nothing passes a pupil whose density has no number.
    const double area = found >= std::numeric_limits<double>::min() ? found : 0;
    compiled_.push_back(
        {{.we = etendue * wavelengths.scale(w) / film.area_mm2(),
          .density = etendue / film.area_mm2() / squared(space_.depth()),
          .entrance_z = entrance.z,
          .entrance_area = area},
         ChiefRayTable(facts, model, upright_radius_, w, focus ? std::optional(focus.middle(w)) : std::nullopt)});
    values.push_back({etendue, entrance.z, area});
  }
  between_ = {in_nm_, values};
}

const SceneSide::Compiled& SceneSide::nearest(Wavelength wavelength) const noexcept {
  const auto nm = wavelength.in_nm();
  return compiled_[nm ? in_nm_.nearest(*nm) : wavelength.position(primary_)];
}

SceneSide::Facts SceneSide::facts_at(Wavelength wavelength) const noexcept {
  const Compiled& beside = nearest(wavelength);
  const auto nm = wavelength.in_nm();
  if (!nm) return beside;
  const auto [etendue, entrance_z, area] = between_(*nm);
  // A pupil at infinity has no place between others.
  const bool placed = std::isfinite(entrance_z) && std::isfinite(area) && beside.entrance_area > 0;
  return {.we = etendue * wavelengths_.scale(wavelength) / film_.area_mm2(),
          .density = etendue / film_.area_mm2() / squared(space_.depth()),
          .entrance_z = placed ? entrance_z : beside.entrance_z,
          .entrance_area = placed ? area : beside.entrance_area};
}

bool SceneSide::valid(const Ray<double>& ray, Wavelength wavelength) const noexcept {
  return wavelengths_.covers(wavelength) && finite(ray.origin) && unit_length(ray.direction);
}

SceneSide::Arrival SceneSide::arrive(const AnyRayModel& model, const Ray<double>& ray, Wavelength wavelength,
                                     double time) const noexcept {
  Arrival result;
  if (!valid(ray, wavelength)) {
    result.fate = refused(wavelength);
    return result;
  }
  Ray<double> arrives{nearest_to_lens(ray), ray.direction};
  if (focus_) {
    const LocalFocus::Straight straight = focus_.straighten(arrives, wavelength, plane(time));
    result.fate = RayFate::vignetted;
    if (!(straight.spread > 0)) return result;
    arrives = straight.ray, result.spread = straight.spread;
  }
  const auto& [o, d] = arrives;
  const TwoPlaneRays<double> line{&result.upright.x, &result.upright.y, &result.pupil.x, &result.pupil.y};
  model.to_film(1, {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, {.all = wavelength}, line, &result.fate);
  return result;
}

std::optional<TiltedPlane> SceneSide::plane(double time) const noexcept {
  if (!tilted_) return {};
  return tilted_->plane(time);
}

std::optional<SceneSide::OnFilm> SceneSide::on_film(const FilmPoint& upright, const FilmPoint& pupil,
                                                    const std::optional<TiltedPlane>& plane) const noexcept {
  if (!plane) return OnFilm{upright, upright};
  const auto point = plane->virtual_point_of({upright.x, upright.y, pupil.x, pupil.y});
  if (!point) return {};
  return OnFilm{plane->point(*point), *point};
}

Importance SceneSide::met_by(const Arrival& arrival, const std::optional<OnFilm>& met) const noexcept {
  Importance result{.fate = arrival.fate};
  if (arrival.fate != RayFate::transmitted) return result;
  if (met) {
    result.film = met->point;
    result.raster = film_.raster(met->point);
  }
  if (!met || !film_.contains(met->point)) result.fate = RayFate::outside_film;
  return result;
}

void SceneSide::weigh(Importance& result, const AnyRayModel& model, const Arrival& arrival, double facing,
                      double cosine, double area, const Facts& at) const noexcept {
  const auto& [fate, upright, pupil, spread] = arrival;
  const double depth2 = squared(space_.depth());
  const double length2 = squared(pupil.x - upright.x) + squared(pupil.y - upright.y) + depth2;
  const double slopes = model.linear_in_slopes() ? squared(depth2 / (length2 * squared(cosine))) : 1;
  result.we = at.we * slopes / spread;
  result.pdf_film = pdf_film_;
  result.pdf_pupil = area > 0 ? 1 / area : 0;
  // A pupil at infinity has no place; all of the density is the direction's.
  result.pdf_position = std::isfinite(at.entrance_area) ? 1 / at.entrance_area : 1;
  result.pdf_direction =
      at.density * squared(length2) / facing * slopes / spread * result.pdf_pupil / result.pdf_position;
}

Importance SceneSide::importance(const AnyRayModel& model, const Ray<double>& ray, Wavelength wavelength,
                                 double time) const noexcept {
  // No ray meets a point but one that was aimed at it.
  if (model.pinhole()) return {.fate = valid(ray, wavelength) ? RayFate::vignetted : refused(wavelength)};
  return arrived(model, arrive(model, ray, wavelength, time), ray.direction.z, wavelength, time);
}

void SceneSide::importance(const AnyRayModel& model, std::size_t count, const RayArrays<const double>& rays,
                           const RayWavelengths& wavelengths, const double* times, Importance* found) const noexcept {
  constexpr std::size_t block = 64;
  const auto ray_at = [&](std::size_t i) -> Ray<double> {
    return {{rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
  };
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    std::array<std::array<double, block>, 10> columns;
    auto& [x, y, z, dx, dy, dz, film_x, film_y, pupil_x, pupil_y] = columns;
    bool side_by_side = !model.pinhole() && !focus_;
    for (std::size_t i = 0; i < n; ++i) {
      const Ray<double> ray = ray_at(begin + i);
      side_by_side = side_by_side && valid(ray, wavelengths.at(begin + i));
      const Vec3<double> near = nearest_to_lens(ray);
      x[i] = near.x, y[i] = near.y, z[i] = near.z;
      dx[i] = ray.direction.x, dy[i] = ray.direction.y, dz[i] = ray.direction.z;
    }
    const auto time = [&](std::size_t i) { return times ? times[begin + i] : 0; };
    if (!side_by_side) {
      for (std::size_t i = 0; i < n; ++i) {
        found[begin + i] = importance(model, ray_at(begin + i), wavelengths.at(begin + i), time(i));
      }
      continue;
    }
    std::array<RayFate, block> fates;
    model.to_film(n, {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}, wavelengths.from(begin),
                  {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()}, fates.data());
    std::array<double, block> areas;
    if (!tilted_) {
      pupils_.sample_areas<double>(n, {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()},
                                   wavelengths.from(begin), areas.data());
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Arrival arrival{fates[i], {film_x[i], film_y[i]}, {pupil_x[i], pupil_y[i]}};
      found[begin + i] =
          arrived(model, arrival, dz[i], wavelengths.at(begin + i), time(i), tilted_ ? nullptr : &areas[i]);
    }
  }
}

Importance SceneSide::arrived(const AnyRayModel& model, const Arrival& arrival, double cosine, Wavelength wavelength,
                              double time, const double* upright_area) const noexcept {
  const FilmPoint &upright = arrival.upright, &pupil = arrival.pupil;
  const auto placed = plane(time);
  const auto met = on_film(upright, pupil, placed);
  Importance result = met_by(arrival, met);
  if (result.fate != RayFate::transmitted) return result;
  const Facts at = facts_at(wavelength);
  // Film points send no rays through other zones of the surfaces, as of a ball lens.
  const FilmPupilTable& sampled = tilted_ ? tilted_->pupils() : pupils_;
  const double area =
      upright_area ? *upright_area : sampled.sample_area(met->virtual_point, pupil.x, pupil.y, wavelength);
  const bool passes = !tilted_ || !decide(pupils_, model) || pupils_.contains(upright, pupil.x, pupil.y, wavelength);
  if (at.entrance_area == 0 || !(area > 0) || !passes) {
    result.fate = RayFate::vignetted;
    return result;
  }
  weigh(result, model, arrival, placed ? placed->weight(met->virtual_point, pupil) : 1, cosine, area, at);
  if (!weights_) return result;
  const double density = weights_.density(sampled.position(met->virtual_point, pupil.x, pupil.y, wavelength));
  result.we *= weights_.of_line({upright.x, upright.y, pupil.x, pupil.y}, wavelength);
  result.pdf_pupil *= density, result.pdf_direction *= density;
  if (!(result.we > 0)) result.fate = RayFate::vignetted;
  return result;
}

ImportanceSample SceneSide::sample_importance(const AnyRayModel& model, const Vec3<double>& point, double u, double v,
                                              Wavelength wavelength, double time) const noexcept {
  if (!wavelengths_.covers(wavelength) || !finite(point)) return {.importance = {.fate = refused(wavelength)}};
  if (model.pinhole()) return through_pinhole(model, point, u, v, wavelength, time);
  const EntranceSample s = entrance_.sample(point, u, v, wavelength);
  if (!(s.pdf > 0)) return {};
  ImportanceSample result = connection(s.place, s.direction, s.distance, s.pdf);
  result.importance = importance(model, {s.place, s.direction}, wavelength, time);
  return result;
}

void SceneSide::sample_importance(const AnyRayModel& model, std::size_t count, const Vec3<double>* points,
                                  const double* u, const double* v, const RayWavelengths& wavelengths,
                                  const double* times, ImportanceSample* found) const noexcept {
  constexpr std::size_t block = 64;
  if (model.pinhole()) {
    for (std::size_t i = 0; i < count; ++i) {
      found[i] = sample_importance(model, points[i], u[i], v[i], wavelengths.at(i), times ? times[i] : 0);
    }
    return;
  }
  std::array<std::array<double, block>, 8> columns;
  auto& [x, y, z, dx, dy, dz, distance, pdf] = columns;
  std::array<Importance, block> importances;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    const RayWavelengths own = wavelengths.from(begin);
    // Rays of points without a connection are valid too.
    entrance_.sample(n, points + begin, u + begin, v + begin, own,
                     {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data(), distance.data(), pdf.data()});
    importance(model, n, {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}, own,
               times ? times + begin : nullptr, importances.data());
    for (std::size_t i = 0; i < n; ++i) {
      ImportanceSample& sample = found[begin + i];
      const Vec3<double>& point = points[begin + i];
      if (!(pdf[i] > 0)) {
        const bool known = wavelengths_.covers(own.at(i)) && finite(point);
        sample = known ? ImportanceSample{} : ImportanceSample{.importance = {.fate = refused(own.at(i))}};
        continue;
      }
      sample = connection({x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}, distance[i], pdf[i]);
      sample.importance = importances[i];
    }
  }
}

ImportanceSample SceneSide::sample_distant(const AnyRayModel& model, const Vec3<double>& direction, double u, double v,
                                           Wavelength wavelength, double time) const noexcept {
  if (!wavelengths_.covers(wavelength) || !unit_length(direction)) {
    return {.importance = {.fate = refused(wavelength)}};
  }
  ImportanceSample result;
  const Vec3<double> point = direction * -far;
  if (model.pinhole()) {
    const ImportanceSample s = through_pinhole(model, point, u, v, wavelength, time);
    result = connection({0, 0, facts_at(wavelength).entrance_z}, direction, infinity, s.pdf / squared(far));
    result.importance = s.importance;
    return result;
  }
  const EntranceSample s = entrance_.sample(point, u, v, wavelength);
  if (!(s.pdf > 0)) return result;
  result = connection(s.place, direction, infinity, s.pdf / squared(far));
  result.importance = importance(model, {s.place, direction}, wavelength, time);
  return result;
}

ImportanceSample SceneSide::connection(const Vec3<double>& place, const Vec3<double>& direction, double distance,
                                       double pdf) const noexcept {
  const double way = std::min(way_to_front(front_, {place, -direction}), distance);
  return {direction, distance - way, place - direction * way, pdf, {}};
}

ImportanceSample SceneSide::through_pinhole(const AnyRayModel& model, const Vec3<double>& point, double u, double v,
                                            Wavelength wavelength, double time) const noexcept {
  ImportanceSample result;
  if (!wavelengths_.covers(wavelength) || !entrance_.in_front(point)) return result;
  const Facts at = facts_at(wavelength);
  const Vec3<double> pupil{0, 0, at.entrance_z}, to = pupil - point;
  const double distance = glm::length(to);
  if (!std::isfinite(distance) || !std::isfinite(at.entrance_area) || !(at.entrance_area > 0 && to.z > 0))
    return result;
  // The weights are those of all the thick lens's pupil, and so are the places in it that the film sees it through.
  const Vec3<double> direction = to / distance;
  result = connection(pupil, direction, distance, squared(distance) / (at.entrance_area * direction.z));
  Arrival arrival = arrive(model, {pupil, result.direction}, wavelength, time);
  const auto placed = plane(time);
  const auto met = on_film(arrival.upright, arrival.pupil, placed);
  Importance& seen = result.importance = met_by(arrival, met);
  if (seen.fate != RayFate::transmitted) return result;
  const FilmPupilTable& pupils = tilted_ ? tilted_->pupils() : pupils_;
  const auto drawn = weights_.draw(u, v);
  const PupilSample s = pupils.sample(met->virtual_point, drawn.u, drawn.v, wavelength);
  const FilmPoint place{s.x, s.y};
  double spread = 1, facing = 1;
  bool passes = s.area > 0;
  if (placed) {
    // Lines through the place spread over the film otherwise than those of the pinhole do.
    spread = part_by_place(*placed, place) / part_by_place(*placed, arrival.pupil);
    facing = placed->weight(met->virtual_point, place);
    const TwoPlaneRay line = placed->upright(met->virtual_point, place);
    arrival.upright = {line.film_x, line.film_y};
    passes = passes && spread > 0 &&
             (model.clips_at_apertures() || pupils_.contains(arrival.upright, place.x, place.y, wavelength));
  }
  arrival.pupil = place;
  if (!passes) {
    seen.fate = RayFate::vignetted;
    return result;
  }
  // A rim leaves a part of the entrance pupil too.
  Facts left = at;
  if (whole_) {
    // Tilted films sample the round stop, of whose rays the iris clips some.
    const double sampled = tilted_ ? s.area : pupils.polygon_area(met->virtual_point, wavelength);
    const double all =
        tilted_ ? whole_->area(met->virtual_point, wavelength) : whole_->polygon_area(met->virtual_point, wavelength);
    const double part = sampled / all;
    left.entrance_area *= part;
    result.pdf /= part;
  }
  weigh(seen, model, arrival, facing, result.direction.z, s.area, left);
  seen.we *= spread, seen.pdf_direction *= spread;
  if (weights_) {
    const TwoPlaneRay line{arrival.upright.x, arrival.upright.y, place.x, place.y};
    seen.we *= weights_.of_sample(drawn.u, drawn.v, line, wavelength) / drawn.density;
    seen.pdf_pupil *= drawn.density, seen.pdf_direction *= drawn.density;
  }
  return result;
}

double SceneSide::pdf(const AnyRayModel& model, const Vec3<double>& point, const Vec3<double>& direction,
                      Wavelength wavelength) const noexcept {
  const Ray<double> ray{point, direction};
  return model.pinhole() || !valid(ray, wavelength) ? 0 : entrance_.pdf(point, ray, wavelength);
}

double SceneSide::pdf_distant(const AnyRayModel& model, const Ray<double>& ray, Wavelength wavelength) const noexcept {
  if (model.pinhole() || !valid(ray, wavelength)) return 0;
  return entrance_.pdf(ray.direction * -far, ray, wavelength) / squared(far);
}

}  // namespace camera_detail

Importance Camera::importance(const Ray<double>& ray, Wavelength wavelength, double time) const {
  return data_->scene().importance(data_->model, ray, data_->resolved(wavelength), time);
}

void Camera::importance(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                        Importance* found, const double* times) const {
  data_->in_range(count, wavelengths, [&](std::size_t begin, std::size_t n, const RayWavelengths& own) {
    const auto from = [begin](const double* column) { return column + begin; };
    data_->scene().importance(data_->model, n,
                              {from(rays.x), from(rays.y), from(rays.z), from(rays.dx), from(rays.dy), from(rays.dz)},
                              own, times ? times + begin : nullptr, found + begin);
  });
}

ImportanceSample Camera::sample_importance(const Vec3<double>& point, double u, double v, Wavelength wavelength,
                                           double time) const {
  return data_->scene().sample_importance(data_->model, point, u, v, data_->resolved(wavelength), time);
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
