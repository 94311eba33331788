// SPDX-License-Identifier: Apache-2.0
// Let X be a film point, H the height of a ray in the plane of the entrance pupil, and u = U(X) + w(X) H its slope in
// this plane. The bent ray has the height H' = s(X) H and the slope u' = U(X) + w'(X, |H|) H'. With A = dU/dX, an area
// of (X, H) is mapped by the model to |A| (1 + w_X . A^-1 H) times this area of heights and slopes (H, u), and by the
// bent rays to s^2 |A| (1 + w'_X . A^-1 H') times this area, with w'_X at the same H'. The quotient of both factors is
// the spread of the bent rays: the density of film samples in the scene is the density of the model divided by the
// spread. If 1 + w'_X . A^-1 H' falls to 0, the rays of neighbouring film points coincide.
//
// For a ray of the scene, H' and u' are given. Its film point is the point whose chief ray has the slope u' - t H' and
// whose focus w' is t. This is one equation for t: t - w' = 0 at that film point. The derivative of t - w' with respect
// to t is 1 + w'_X . A^-1 H'.
#include "local_focus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "camera/moving_least_squares.hpp"
#include "camera_loops.hpp"
#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "focus/root.hpp"
#include "focus/targets.hpp"
#include "lens/between_wavelengths.hpp"
#include "make_model.hpp"
#include "paraxial/ray_matrix.hpp"
#include "paraxial_model.hpp"
#include "petzval/core/error.hpp"

namespace petzval::camera_detail {
namespace {

using focus_detail::pupil_scale;

using kernel::Dual;

/// Limits of film offsets, relative to the distance of the film from the pupil.
constexpr double nearest_offset = -0.9, farthest_offset = 9;

/// Film offsets divided by the distance of the film from the pupil plane.
camera_detail::MovingLeastSquares offsets_of(const std::string& where, const std::vector<FilmOffset>& offsets,
                                             const Film& film, double film_from_pupil) {
  std::vector<camera_detail::WeighedValue> points;
  for (const auto& [film_point, offset, weight] : offsets)
    points.push_back({film_point, offset / film_from_pupil, weight});
  constexpr double beta = 3;
  camera_detail::MovingLeastSquares surface(where + "film offsets: ", points, std::sqrt(film.area_mm2()),
                                            SurfaceKind::affine, beta);
  if (!(surface.least() > nearest_offset && surface.most() < farthest_offset)) {
    throw Error(where + "film offsets: the surface reaches from " + to_text(surface.least() * film_from_pupil) +
                " to " + to_text(surface.most() * film_from_pupil) +
                " mm; must leave the film between a tenth and ten times its distance from the pupil, " +
                to_text(std::abs(film_from_pupil)) + " mm");
  }
  return surface;
}

template <class T>
EntranceMaps<T> in_type(const EntranceMaps<double>& maps) noexcept {
  const auto number = [](double value) { return static_cast<T>(value); };
  return {number(maps.z), number(maps.a),           number(maps.b),      number(maps.c),
          number(maps.d), number(maps.chief_slope), number(maps.radius), number(maps.from_surface)};
}

template <class T>
FocusRules<T> in_type(const FocusRules<double>& rules) {
  FocusRules<T> result{in_type<T>(rules.primary), rules.by_surface, rules.by_offset, static_cast<T>(rules.power), {}};
  result.spline.knots = rules.spline.knots;
  result.spline.first = static_cast<T>(rules.spline.first), result.spline.square = static_cast<T>(rules.spline.square);
  for (std::size_t i = 0; i < rules.spline.knots; ++i) {
    result.spline.at[i] = static_cast<T>(rules.spline.at[i]);
    result.spline.cube[i] = static_cast<T>(rules.spline.cube[i]);
  }
  return result;
}

/// Zero of a function that grows with a slope of about 1: by the secant method, or by bisection if the secants do not
/// converge, as on steep surfaces.
/// @param scale typical size of the argument
double zero_of(const auto& f, double scale) {
  const double settled = 1e-13 * scale;
  double before = 0, at_before = f(before), t = -at_before;
  for (int i = 0; i < 8; ++i) {
    const double at_t = f(t);
    if (std::abs(at_t) <= settled) return t;
    const double step = at_t * (t - before) / (at_t - at_before);
    if (!(std::abs(step) < scale)) break;
    before = t, at_before = at_t;
    t -= step;
  }
  // Doubles the interval until it contains the zero, which exists because the focus is bounded.
  double low = -scale, high = scale;
  for (int i = 0; i < 64 && f(low) > 0; ++i) low *= 2;
  for (int i = 0; i < 64 && f(high) < 0; ++i) high *= 2;
  return focus_detail::root(f, low, high);
}

/// A dual number with the derivatives with respect to film x and y.
Dual jet(double value, const Vec2<double>& by) noexcept { return {value, {by.x, by.y}}; }

}  // namespace

EntranceMaps<double> entrance_maps(const RayMatrix& map, double z, double middle, double radius) noexcept {
  const double slope = map.c + map.d * middle;
  const double away = -(map.a + map.b * middle) / slope;  // distance to the point where chief rays meet the axis
  const double b = map.b + map.d * away;
  return {.z = z + away,
          .a = -b * middle,
          .b = b,
          .c = map.c,
          .d = map.d,
          .chief_slope = slope,
          .radius = std::abs(b) * radius};
}

struct LocalFocus::Data {
  /// Data of a wavelength.
  struct At {
    EntranceMaps<double> maps;
    double dispersion = 1;
    double middle = 0;  // position of the image of the stop divided by the film point
  };

  std::shared_ptr<const RayModel> model;
  Film film;
  std::optional<FocalSurface> surface;
  std::optional<camera_detail::MovingLeastSquares> offsets = {};
  FocusRules<double> rules = {};
  FocusRules<float> rules_in_float = {};
  std::vector<At> compiled = {};
  std::size_t primary = 0;
  lens_detail::BetweenWavelengths<3> between = {};  // middle, radius and dispersion

  const ParaxialModel& first_order() const noexcept { return *model->first_order(); }

  /// Data of a wavelength whose image of the stop has the given radius and is centred at `middle` times the film point.
  At at(const SectionMaps& maps, double middle, double radius, double dispersion) const noexcept {
    EntranceMaps<double> found = entrance_maps(maps.y, first_order().z(), middle, radius);
    if (surface) found.from_surface = found.z - surface->origin_z();
    return {found, dispersion, middle};
  }
  /// The film point whose chief ray has a given slope, and its TiltedPlane::distance_excess(); nullopt if the chief ray
  /// does not meet the front of the film.
  struct Seen {
    FilmPoint film_point;
    double excess = 0;
  };
  std::optional<Seen> seen(const At& at, const Vec2<double>& slope,
                           const std::optional<TiltedPlane>& plane) const noexcept {
    const FilmPoint upright{slope.x / at.maps.chief_slope, slope.y / at.maps.chief_slope};
    if (!plane) return Seen{upright};
    const auto point = plane->virtual_point_of({upright.x, upright.y, at.middle * upright.x, at.middle * upright.y});
    if (!point) return {};
    return Seen{plane->point(*point), plane->distance_excess(*point)};
  }
  /// Change of the film point for a step of its chief ray's slope.
  Vec2<double> moved(const At& at, const Vec2<double>& slope, const Vec2<double>& step,
                     const std::optional<TiltedPlane>& plane) const noexcept {
    if (!plane) return step / at.maps.chief_slope;
    const double small = 1e-5 / std::max(glm::length(step), std::numeric_limits<double>::min());
    const auto before = seen(at, slope - step * small, plane), behind = seen(at, slope + step * small, plane);
    if (!before || !behind) return {0, 0};
    return Vec2<double>{behind->film_point.x - before->film_point.x, behind->film_point.y - before->film_point.y} /
           (2 * small);
  }
  /// nullopt if the wavelength is not covered.
  std::optional<At> at(Wavelength wavelength) const noexcept {
    if (const auto nm = wavelength.in_nm()) {
      const auto maps = first_order().maps(wavelength);
      if (!maps) return {};
      const auto [middle, radius, dispersion] = between(*nm);
      return at(*maps, middle, radius, dispersion);
    }
    const std::size_t position = wavelength.index(primary);
    return position < compiled.size() ? std::optional(compiled[position]) : std::nullopt;
  }

  FilmPointFocus<double> point(const FilmPoint& film_point, double excess) const noexcept {
    FilmPointFocus<double> result{excess, 0, 0, 1};
    if (surface) {
      const auto values = surface->at(film_point);
      result.surface = values.inverse_distance, result.scale = pupil_scale(values.extent_stops);
    }
    if (offsets) result.offset = offsets->at(film_point);
    return result;
  }
  FilmPointFocus<Dual> point(const FilmPoint& film_point, const Dual& excess) const noexcept {
    FilmPointFocus<Dual> result{excess, Dual(0.0), Dual(0.0), Dual(1.0)};
    if (surface) {
      const auto at_point = surface->slopes(film_point);
      result.surface = jet(at_point.values.inverse_distance, at_point.inverse_distance);
      const double scale = pupil_scale(at_point.values.extent_stops);
      result.scale = jet(scale, at_point.extent_stops * (-std::log(2.0) / 2 * scale));
    }
    if (offsets) {
      result.offset = jet(offsets->at(film_point), offsets->slopes(film_point));
    }
    return result;
  }
};

LocalFocus::LocalFocus(const LensFacts& facts, const Film& film, const std::shared_ptr<const RayModel>& model,
                       const std::optional<FocalSurface>& surface, const ExpressiveLens& expressive) {
  const Lens& lens = facts.lens();
  const std::string where = lens.name() + ": camera: ";
  if (!surface && expressive.empty()) return;
  if (!model->kind().is_first_order()) {
    throw Error(where + "model = " + std::string(name(model->kind())) +
                "; must be pinhole, thin, thin_two_disc or thick for a focal surface or an expressive lens");
  }
  if (has_cylinders(lens)) {
    throw Error(where +
                "the lens has cylinders; must be a lens of revolution for a focal surface or an expressive lens");
  }
  const std::size_t wavelengths = facts.wavelengths(), strengths = expressive.dispersion.size();
  if (strengths > 1 && strengths != wavelengths) {
    throw Error(where + "dispersion has " + std::to_string(strengths) + " numbers; must have 1, or one for each of " +
                std::to_string(wavelengths) + " wavelengths");
  }
  for (const double strength : expressive.dispersion) {
    if (std::abs(strength) <= 1e6) continue;
    throw Error(where + "dispersion = " + to_text(strength) + "; must be -1e6 to 1e6");
  }
  Data data{model, film, surface};
  data.primary = lens.primary_wavelength();
  data.rules.spline = power_spline(where, expressive.power);
  const TwoPlanes& space = model->pupils().space();
  if (!expressive.film_offsets.empty()) data.offsets = offsets_of(where, expressive.film_offsets, film, -space.depth());
  if (model->pinhole()) return;

  const IrisImages images = iris_images(model->kind(), facts);
  std::vector<std::array<double, 3>> values;
  for (std::size_t w = 0; w < wavelengths; ++w) {
    const double strength = strengths == 0 ? 1 : expressive.dispersion[strengths > 1 ? w : 0];
    const auto& [shift, radius] = images.images[w];
    data.compiled.push_back(data.at(data.first_order().maps()[w], shift.y, radius.y, strength));
    values.push_back({shift.y, radius.y, strength});
    const EntranceMaps<double>& maps = data.compiled.back().maps;
    if (!std::isfinite(maps.z)) {
      throw Error(where +
                  "the entrance pupil is at infinity; must be at a finite distance for a focal surface or an "
                  "expressive lens");
    }
    constexpr double min_distance_ratio = 0.05;
    const auto reaches = [&](double inverse) { return 1 + inverse * maps.from_surface >= min_distance_ratio; };
    if (surface && !(reaches(surface->nearest()) && reaches(surface->farthest()))) {
      throw Error(where + "the focal surface has 1 / distance from " + to_text(surface->farthest()) + " to " +
                  to_text(surface->nearest()) + " / mm; must be in front of the pupil of " +
                  std::string(name(model->kind())) + ", which is at z = " + to_text(maps.z) + " mm");
    }
  }
  data.between = {lens_detail::CompiledWavelengths(lens.wavelengths_nm()), values};
  data.rules.primary = data.compiled[data.primary].maps;
  data.rules.by_surface = surface && surface->fixes_distance(), data.rules.by_offset = data.offsets.has_value();
  data.rules.power = 1 / facts.first_order(data.primary).effective_focal_length;
  data.rules_in_float = in_type<float>(data.rules);
  data_ = std::make_shared<const Data>(std::move(data));
}

template <class T>
void LocalFocus::bend(std::size_t count, const T* film_x, const T* film_y, const T* excess,
                      const RayWavelengths& wavelengths, const RayArrays<T>& rays) const noexcept {
  const Data& data = *data_;
  const auto loop = camera_loops().of<T>().bend;
  const FocusRules<T>* rules = nullptr;
  if constexpr (std::is_same_v<T, float>) {
    rules = &data.rules_in_float;
  } else {
    rules = &data.rules;
  }
  const T z = static_cast<T>(data.first_order().z());
  for (std::size_t begin = 0; begin < count; begin += bend_block) {
    const std::size_t n = std::min(bend_block, count - begin);
    alignas(64) std::array<T, bend_block> none{}, surface, offset, scale;
    const T* const x = film_x + begin;
    const T* const y = film_y + begin;
    scale.fill(T(1));
    if (data.surface) {
      data.surface->at(n, x, y, surface.data(), scale.data());
      for (std::size_t i = 0; i < n; ++i) scale[i] = pupil_scale(scale[i]);
    }
    if (data.offsets) data.offsets->at(n, x, y, offset.data());
    const auto run = [&](std::size_t from, std::size_t to, const Data::At& at) {
      loop(*rules, in_type<T>(at.maps), static_cast<T>(at.dispersion), z, to - from,
           {(excess ? excess + begin : none.data()) + from, (data.surface ? surface : none).data() + from,
            (data.offsets ? offset : none).data() + from, scale.data() + from},
           {rays.x + begin + from, rays.y + begin + from, rays.z + begin + from, rays.dx + begin + from,
            rays.dy + begin + from, rays.dz + begin + from});
    };
    if (wavelengths.shared()) {
      if (const auto at = data.at(wavelengths.all)) run(0, n, *at);
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (const auto at = data.at(wavelengths.at(begin + i))) run(i, i + 1, *at);
    }
  }
}
template void LocalFocus::bend(std::size_t, const float*, const float*, const float*, const RayWavelengths&,
                               const RayArrays<float>&) const noexcept;
template void LocalFocus::bend(std::size_t, const double*, const double*, const double*, const RayWavelengths&,
                               const RayArrays<double>&) const noexcept;

void LocalFocus::bend(const FilmPoint& film, double excess, Wavelength wavelength, Ray<double>& ray) const noexcept {
  const Data& data = *data_;
  const auto at = data.at(wavelength);
  if (!at) return;
  const auto point = data.point(film, excess);
  auto& [o, d] = ray;
  camera_loops().twice.bend(data.rules, at->maps, at->dispersion, data.first_order().z(), 1,
                            {&point.excess, &point.surface, &point.offset, &point.scale},
                            {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z});
}

void LocalFocus::bend(const FilmPoint& film, const Dual& excess, Wavelength wavelength,
                      RayOf<Dual>& ray) const noexcept {
  const Data& data = *data_;
  const auto at = data.at(wavelength);
  if (!at) return;
  const double z = data.first_order().z();
  const auto point = data.point(film, excess);
  const Dual radius = radius_of(at->maps, point, at_entrance(at->maps, z, ray));
  const Dual by_radius = beyond_one(data.rules.spline, radius) * data.rules.power;
  bend_ray(data.rules, at->maps, at->dispersion, z, point, by_radius, ray);
}

LocalFocus::Straight LocalFocus::straighten(const Ray<double>& ray, Wavelength wavelength,
                                            const std::optional<TiltedPlane>& plane) const noexcept {
  const Data& data = *data_;
  const auto at = data.at(wavelength);
  if (!at || !(ray.direction.z > 0)) return {};
  const auto [x, y, slope_x, slope_y] = core_detail::slope_ray(ray, at->maps.z);
  const Vec2<double> height{x, y}, slope{slope_x, slope_y};
  if (!(glm::length(height) + glm::length(slope) < 1e12)) return {};

  // Focus at the film point whose chief ray has the slope that belongs to t.
  const double by_radius = data.rules.power * beyond_one(data.rules.spline, glm::length(height) / at->maps.radius);
  const auto asked = [&](double t) -> std::optional<double> {
    const auto from = data.seen(*at, slope - height * t, plane);
    if (!from) return {};
    const auto point = data.point(from->film_point, from->excess);
    return focus_of(data.rules, at->maps, at->dispersion, point).asked + by_radius;
  };
  const double start = data.rules.primary.d / data.rules.primary.b;
  const auto residual = [&](double t) { return t - asked(start + t).value_or(start) + start; };
  const double t = start + zero_of(residual, std::abs(data.rules.power));

  const Vec2<double> chief = slope - height * t;
  const auto from = data.seen(*at, chief, plane);
  if (!from) return {};
  const Dual excess(from->excess, plane ? plane->distance_excess_at(from->film_point).v : kernel::Gradient());
  const FilmPointFocus<Dual> point = data.point(from->film_point, excess);
  const auto focus = focus_of(data.rules, at->maps, at->dispersion, point);
  const double scale = point.scale.a;
  const Vec2<double> straight = height / scale;
  const auto spread = [&](const Dual& in_focus, const Vec2<double>& at_height) {
    const Vec2<double> by = data.moved(*at, chief, at_height, plane);
    return 1 + in_focus.v[0] * by.x + in_focus.v[1] * by.y;
  };
  const double wider = scale * scale * spread(focus.asked, height) / spread(focus.own, straight);
  if (!(wider > 0 && std::isfinite(wider))) return {};
  const Vec2<double> u = chief + straight * focus.own.a;
  const Vec3<double> direction = glm::normalize(Vec3<double>{u.x, u.y, 1});
  return {{{straight.x, straight.y, at->maps.z}, direction}, wider};
}

double LocalFocus::steepness(const std::optional<TiltedPlane>& plane, FilmPoint* steepest) const noexcept {
  double result = 0;
  const Data& data = *data_;
  const Data::At& at = data.compiled[data.primary];
  constexpr int columns = 96, rows = 64;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double right = double(column) / columns - 0.5, up = double(row) / rows - 0.5;
      const FilmPoint film_point{data.film.shift_x_mm + right * data.film.width_mm,
                                 data.film.shift_y_mm + up * data.film.height_mm};
      const TiltedPlane upright, &lies = plane ? *plane : upright;
      const FilmPoint from_pupil = lies.virtual_point(film_point);
      const double scale = chief_scale(lies.distance_excess(from_pupil), at.middle);
      const Vec2<double> chief = Vec2<double>{from_pupil.x, from_pupil.y} * (scale * at.maps.chief_slope);
      const FilmPointFocus<Dual> point = data.point(film_point, lies.distance_excess_at(film_point));
      const auto [own, asked] = focus_of(data.rules, at.maps, at.dispersion, point);
      const double rim = at.maps.radius * point.scale.a;
      const Vec2<double> x = data.moved(at, chief, {rim, 0}, plane), y = data.moved(at, chief, {0, rim}, plane);
      const Vec2<double> steep{asked.v[0] * x.x + asked.v[1] * x.y, asked.v[0] * y.x + asked.v[1] * y.y};
      if (!(glm::length(steep) > result)) continue;
      result = glm::length(steep);
      if (steepest) *steepest = film_point;
    }
  }
  return result;
}

EntrancePupilTable LocalFocus::entrances(const Lens& lens, const RayModel& model, int threads) const {
  const Data& data = *data_;
  const double widest = data.surface ? pupil_scale(data.surface->least_extent()) : 1;
  double least_power = 0, most_power = 0;
  constexpr int steps = 64;
  for (int i = 0; i <= steps; ++i) {
    const double power = data.rules.power * beyond_one(data.rules.spline, double(i) / steps);
    least_power = std::min(least_power, power), most_power = std::max(most_power, power);
  }
  std::vector<double> radii(data.compiled.size(), 0);
  // Rays of all pupils, enlarged by the largest extent, to the nearest and to the farthest focus: they have the largest
  // fields.
  const auto to_focus = [&](bool near) {
    const FilmPointFocus<double> point{0,
                                       data.surface ? (near ? data.surface->nearest() : data.surface->farthest()) : 0,
                                       data.offsets ? (near ? data.offsets->most() : data.offsets->least()) : 0, 1};
    return leaving_rays(model.pupils(), lens.rotationally_symmetric(),
                        [&](std::size_t count, const TwoPlaneRays<const double>& lines, std::size_t wavelength,
                            const RayArrays<double>& rays, RayFate* fates) {
                          model.to_scene(count, lines, {.all = wavelength}, rays, fates);
                          const Data::At& at = data.compiled[wavelength];
                          const auto [own, asked] = focus_of(data.rules, at.maps, at.dispersion, point);
                          const double in_focus = asked + (near ? most_power : least_power);
                          for (std::size_t i = 0; i < count; ++i) {
                            const auto line = core_detail::slope_ray(core_detail::ray_at(rays, i), at.maps.z);
                            const Vec2<double> height{line.x, line.y}, slope{line.slope_x, line.slope_y};
                            radii[wavelength] = std::max(radii[wavelength], glm::length(height));
                            const Vec2<double> u = slope + height * (in_focus * widest - own);
                            const Vec3<double> direction = -glm::normalize(Vec3<double>{u.x, u.y, 1});
                            rays.x[i] = height.x * widest, rays.y[i] = height.y * widest, rays.z[i] = at.maps.z;
                            rays.dx[i] = direction.x, rays.dy[i] = direction.y, rays.dz[i] = direction.z;
                          }
                        });
  };
  auto rays = to_focus(true);
  const auto far = to_focus(false);
  for (std::size_t w = 0; w < rays.size(); ++w) rays[w].insert(rays[w].end(), far[w].begin(), far[w].end());
  constexpr double rounding = 1e-9;
  return EntrancePupilTable(
      lens, rays,
      [&](std::size_t count, const RayArrays<const double>& from, std::size_t wavelength, std::uint8_t* passes) {
        for (std::size_t i = 0; i < count; ++i) {
          const double z = data.compiled[wavelength].maps.z;
          const auto line = core_detail::slope_ray(core_detail::ray_at(from, i), z);
          passes[i] = from.dz[i] > 0 && std::hypot(line.x, line.y) <= radii[wavelength] * widest * (1 + rounding);
        }
      },
      threads);
}

double LocalFocus::middle(std::size_t wavelength) const noexcept { return data_->compiled[wavelength].middle; }

}  // namespace petzval::camera_detail
