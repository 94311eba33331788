// SPDX-License-Identifier: Apache-2.0
#include "aim.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <string>

#include "core/bisect.hpp"
#include "core/dual.hpp"
#include "petzval/core/error.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "surface_box.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace {

using kernel::Dual;
using kernel::Vec;

/// The unknown: transverse components of the unit direction in which a ray leaves the stop, towards the side of the
/// point.
using Slope = Vec2<double>;

/// A ray behind the stop and the lens. The error is the sine of the angle between `direction` and the direction to the
/// point: its components in the meridian of the point (along) and perpendicular to the meridian (across).
template <class T>
struct Departure {
  Vec<T> origin, direction, target_direction;
  T along, across;
};

/// Solves for the rays of one scene or film point at one wavelength. Lengths at the stop are in mm in this class.
class Aimer {
 public:
  Aimer(const Lens& lens, const PupilPlane& plane, std::size_t wavelength)
      : lens_(lens), plane_(plane), wavelength_(wavelength) {
    const Pupils p = pupils(lens, wavelength);
    stop_ = p.stop;
    // Rays to the film leave the stop in the direction of light; rays to the scene leave in the opposite direction.
    departure_ = {.wavelength = wavelength, .apertures = false};
    arrival_ = {.travel = plane.travel(), .wavelength = wavelength, .apertures = false};
    if (plane.travel() == Travel::to_film) {
      from_stop_ = -lens.light_direction(stop_);
      at_point_ = -1;
      departure_.travel = Travel::to_scene;
      departure_.last = stop_;
      arrival_.last = stop_ + 1;
    } else {
      from_stop_ = lens.light_direction(stop_ + 1);
      at_point_ = lens.light_direction(lens.surface_count());
      departure_.travel = Travel::to_film;
      departure_.first = stop_ + 1;
      arrival_.first = stop_;
    }

    const Vec3<double>& towards = plane.towards();
    const double across = std::hypot(towards.x, towards.y);
    outwards_ = across > 0 ? Slope{towards.x / across, towards.y / across} : Slope{0, 1};
    lateral_ = {outwards_.y, -outwards_.x, 0};
    meridian_ = glm::cross(lateral_, towards);
    // With a stop of radius 0, a target counts as met within rounding.
    acceptance_ = 1e-6 * std::max(unit(), 1e-3 * pupil_detail::half_height(lens, 0, p.entrance));
    if (const auto axis = differentiated({}, {})) mirrored_ = mirrored(*axis);
  }

  /// The unit of a Vec2<double>, mm: the semi-diameter of the stop, or 1 if the stop has no rim.
  double unit() const noexcept {
    const double semi_diameter = lens_.surfaces()[stop_].semi_diameter;
    return semi_diameter > 0 && std::isfinite(semi_diameter) ? semi_diameter : 1;
  }

  AimedRay operator()(const Vec2<double>& target) const noexcept {
    const Vec2<double> stop_point{target.x * unit(), target.y * unit()};
    const auto slope = solve(stop_point);
    return slope ? tested(stop_point, *slope) : AimedRay{};
  }

 private:
  template <class T>
  std::optional<Departure<T>> leave(const Vec2<double>& from, const T& x, const T& y) const noexcept {
    using std::sqrt;
    const T squared = T(1) - x * x - y * y;
    const double z = lens_.surfaces()[stop_].vertex_z + sag(lens_, stop_, from.x, from.y);
    if (!(squared > 0.0) || !std::isfinite(z)) return {};
    const auto end = kernel::trace(kernel::view<double>(lens_), Vec<T>{T(from.x), T(from.y), T(z)},
                                   Vec<T>{x, y, T(sqrt(squared) * from_stop_)}, departure_);
    if (end.fate != RayFate::transmitted) return {};

    const auto vector = [](const Vec3<double>& v) { return Vec<T>{T(v.x), T(v.y), T(v.z)}; };
    Vec<T> target_direction =
        vector(plane_.towards()) - (end.origin - vector(plane_.centre())) * T(plane_.reciprocal_distance());
    const T length = sqrt(dot(target_direction, target_direction));
    target_direction = target_direction * T((plane_.reciprocal_distance() < 0 ? -1.0 : 1.0) / length);
    const Vec<T>& d = end.direction;
    const Vec<T> turn{d.y * target_direction.z - d.z * target_direction.y,
                      d.z * target_direction.x - d.x * target_direction.z,
                      d.x * target_direction.y - d.y * target_direction.x};
    return Departure<T>{end.origin, d, target_direction, dot(turn, vector(lateral_)), dot(turn, vector(meridian_))};
  }

  std::optional<Slope> solve(const Vec2<double>& target) const noexcept {
    const Vec2<double> centre{};
    // Within 45 degrees of the axis Newton's iteration converges from the axial ray.
    const bool narrow = plane_.towards().z * at_point_ > std::numbers::sqrt2 / 2;
    auto chief = narrow ? newton(centre, Slope{}) : std::nullopt;
    if (!chief) {
      if (const auto edge = bracket(centre)) chief = newton(centre, *edge);
    }
    if (target.x == 0 && target.y == 0) return chief;
    if (chief) {
      if (const auto slope = newton(target, *chief)) return slope;
      auto slope = chief;
      constexpr int steps = 16;
      for (int i = 1; slope && i <= steps; ++i) {
        slope = newton({target.x * i / steps, target.y * i / steps}, *slope);
      }
      if (slope) return slope;
    }
    const auto edge = bracket(target);
    return edge ? newton(target, *edge) : std::nullopt;
  }

  std::optional<Departure<Dual>> differentiated(const Vec2<double>& from, const Slope& s) const noexcept {
    return leave(from, Dual(s.x, 0), Dual(s.y, 1));
  }

  /// True if directions at the stop and directions in object space rotate in opposite senses.
  static bool mirrored(const Departure<Dual>& ray) noexcept {
    const Vec<Dual> e = ray.direction - ray.target_direction;
    const auto component = [&](int i) { return Vec<double>{e.x.v[i], e.y.v[i], e.z.v[i]}; };
    const Vec<double> a = component(0), b = component(1);
    const Vec<double> d{ray.direction.x.a, ray.direction.y.a, ray.direction.z.a};
    return dot(Vec<double>{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}, d) < 0;
  }

  /// Damped Newton iteration: every step reduces the error and keeps the ray inside the lens. Surfaces far outside
  /// their rims can bend a ray back to the same angle; such a ray is mirrored (see mirrored()) and rejected.
  std::optional<Slope> newton(const Vec2<double>& from, Slope slope) const noexcept {
    constexpr double rounding = 1e-15, max_miss = 1e-9;
    const auto at = [&](const Slope& s) { return differentiated(from, s); };
    const auto miss = [](const Departure<Dual>& d) {
      const bool away = !(dot(d.direction, d.target_direction) > 0.0);
      return away ? 2.0 : std::hypot(d.along.a, d.across.a);
    };
    auto now = at(slope);
    if (!now) return {};
    for (int iteration = 0; iteration < 40 && miss(*now) > rounding; ++iteration) {
      const Dual &f = now->along, &g = now->across;
      const double d = f.v[0] * g.v[1] - f.v[1] * g.v[0];
      Slope step{(f.v[1] * g.a - f.a * g.v[1]) / d, (f.a * g.v[0] - f.v[0] * g.a) / d};
      if (!std::isfinite(step.x) || !std::isfinite(step.y)) return {};
      bool improved = false;
      for (int halving = 0; halving < 12 && !improved; ++halving, step = step * 0.5) {
        const auto next = at(slope + step);
        improved = next && miss(*next) < miss(*now);
        if (improved) slope = slope + step, now = next;
      }
      if (!improved) break;
    }
    return miss(*now) < max_miss && mirrored(*now) == mirrored_ ? std::optional(slope) : std::nullopt;
  }

  /// The largest slope in the meridian of the field for which the ray from a point on the stop leaves the lens at a
  /// smaller angle to the axis than the angle of the scene or film point. The angle grows with the slope until the ray
  /// misses a surface; a miss counts as too large an angle.
  std::optional<Slope> bracket(const Vec2<double>& from) const noexcept {
    // Angle of the point minus angle of the ray, rad.
    const auto missing_angle = [&](double slope) {
      const auto d = leave(from, outwards_.x * slope, outwards_.y * slope);
      const auto angle = [&](const Vec<double>& v) {
        return std::atan2(v.x * outwards_.x + v.y * outwards_.y, v.z * at_point_);
      };
      return d ? angle(d->target_direction) - angle(d->direction) : -1;
    };
    const double middle = missing_angle(0), off_axis = missing_angle(1e-4);
    if (!(middle > 0)) return {};
    const double sign = off_axis < middle ? 1 : -1;
    constexpr int steps = 32;
    constexpr double tolerance = 1e-9;  // Newton's iteration takes over
    double low = 0, at_low = middle;
    for (int i = 1; i <= steps; ++i) {
      const double high = sign * i / steps, at_high = missing_angle(high);
      if (at_high < 0) {
        const double slope = core_detail::last_above(low, at_low, high, at_high, tolerance, missing_angle);
        return Slope{outwards_.x * slope, outwards_.y * slope};
      }
      low = high, at_low = at_high;
    }
    return {};
  }

  /// Reverses the ray and traces it in its own direction of travel.
  AimedRay tested(const Vec2<double>& target, const Slope& slope) const noexcept {
    const auto out = leave(target, slope.x, slope.y);
    if (!out) return {};
    // The origin is the point of the ray nearest to the centre of the pupil. The intersection with the pupil plane of a
    // ray of a steep field is far away, with rounding errors that are large compared with a small stop.
    const Vec3<double> exit = kernel::to_public(out->origin), backwards = kernel::to_public(out->direction);
    const Vec3<double> start = exit + backwards * glm::dot(plane_.centre() - exit, backwards);
    AimedRay result;
    result.ray = {start, plane_.direction_at(start)};

    const auto hit = kernel::trace(kernel::view<double>(lens_), kernel::to_kernel(result.ray.origin),
                                   kernel::to_kernel(result.ray.direction), arrival_);
    const bool met = hit.surface == static_cast<int>(stop_) &&
                     (hit.fate == RayFate::transmitted || hit.fate == RayFate::totally_reflected);
    result.residual = std::hypot(hit.origin.x - target.x, hit.origin.y - target.y) / unit();
    if (!met || !(result.residual * unit() < acceptance_)) return {};

    TraceOptions options{.travel = plane_.travel(), .wavelength = wavelength_};
    result.end = trace(lens_, result.ray, options);
    result.status = AimStatus::converged;
    if (!result.end.transmitted()) {
      result.status = AimStatus::vignetted;
      result.surface = result.end.surface;
      options.apertures = false;
      result.end = trace(lens_, result.ray, options);
    }
    return result;
  }

  const Lens& lens_;
  const PupilPlane& plane_;
  std::size_t wavelength_, stop_ = 0;
  double from_stop_, at_point_;               // sense along z of rays towards the point
  kernel::SurfaceRange departure_, arrival_;  // from the stop to the point; from the point to the stop
  Slope outwards_;                            // unit vector across the axis, towards the point
  Vec3<double> lateral_, meridian_;           // unit vectors across the line to the point; the second in the meridian
  double acceptance_;                         // largest accepted distance from the target on the stop, mm
  bool mirrored_ = false;                     // value of mirrored() on the axis
};

}  // namespace

std::string_view name(AimStatus status) noexcept {
  switch (status) {
    case AimStatus::converged: return "converged";
    case AimStatus::vignetted: return "vignetted";
    case AimStatus::outside_film: return "outside_film";
    case AimStatus::no_ray: return "no_ray";
  }
  return "unknown";
}

AimedRay pupil_detail::aim(const Lens& lens, const PupilPlane& plane, const Vec2<double>& target,
                           Wavelength wavelength) {
  return Aimer(lens, plane, lens.wavelength_index(wavelength))(target);
}

AimedRay aim(const Lens& lens, const FieldPoint& point, const Vec2<double>& target, Wavelength wavelength) {
  return pupil_detail::aim(lens, PupilPlane(lens, point), target, wavelength);
}

AimedRay chief_ray(const Lens& lens, const FieldPoint& point, Wavelength wavelength) {
  return aim(lens, point, {}, wavelength);
}

}  // namespace petzval
