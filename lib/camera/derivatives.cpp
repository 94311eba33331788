// SPDX-License-Identifier: Apache-2.0
// Rays with their derivatives by two parameters: each model once more, over dual numbers.

#include <cmath>
#include <optional>

#include "core/dual.hpp"
#include "core/kernel_vec.hpp"
#include "exact_model.hpp"
#include "paraxial_model.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/sequential.hpp"

namespace petzval::camera_detail {
namespace {

using kernel::Dual;
using Vec = kernel::Vec<Dual>;

struct Line {
  Dual film_x, film_y, pupil_x, pupil_y;
};

Line line_of(const TwoPlaneRayDerivatives& d) noexcept {
  const auto jet = [&](double TwoPlaneRay::*part) {
    Dual x(d.line.*part);
    x.v[0] = d.by_u.*part;
    x.v[1] = d.by_v.*part;
    return x;
  };
  return {jet(&TwoPlaneRay::film_x), jet(&TwoPlaneRay::film_y), jet(&TwoPlaneRay::pupil_x), jet(&TwoPlaneRay::pupil_y)};
}

RayDerivatives derivatives_of(const Vec& origin, const Vec& direction) noexcept {
  const auto part = [](const Vec& v, int k) { return Vec3<double>(v.x.v[k], v.y.v[k], v.z.v[k]); };
  const auto value = [](const Vec& v) { return Vec3<double>(v.x.a, v.y.a, v.z.a); };
  return {RayFate::transmitted,
          {value(origin), value(direction)},
          {part(origin, 0), part(direction, 0)},
          {part(origin, 1), part(direction, 1)}};
}

RayArrays<double> arrays_of(Ray<double>& ray) noexcept {
  auto& [o, d] = ray;
  return {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z};
}
RayArrays<const double> arrays_of(const Ray<double>& ray) noexcept {
  const auto& [o, d] = ray;
  return {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z};
}

/// A ray and its derivatives behind the lens, at any wavelength; nothing for a lost one.
std::optional<RayDerivatives> traced(const Lens& lens, const RayDerivatives& start, Wavelength wavelength) noexcept {
  RayDerivatives end;
  const auto& [fate, ray, by_u, by_v] = start;
  trace_differentials<double>(lens, 1, arrays_of(ray), {arrays_of(by_u), arrays_of(by_v)}, arrays_of(end.ray),
                              {arrays_of(end.by_u), arrays_of(end.by_v)}, &end.fate, nullptr,
                              {.travel = Travel::to_scene, .wavelengths = {wavelength}});
  if (end.fate != RayFate::transmitted) return {};
  return end;
}

}  // namespace

template <class R>
RayDerivatives ExactModel<R>::to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept {
  const TwoPlanes& space = pupils_.space();
  const auto [film_x, film_y, pupil_x, pupil_y] = line_of(line);
  const double depth = space.depth();
  const Dual x = pupil_x - film_x, y = pupil_y - film_y;
  const Dual per_length = towards_ / sqrt(x * x + y * y + depth * depth);
  const Vec origin{pupil_x, pupil_y, Dual(space.pupil_z)};
  const Vec direction{x * per_length, y * per_length, depth * per_length};
  RayDerivatives start = derivatives_of(origin, direction);
  start.by_u = start.by_v = {{0, 0, 0}, {0, 0, 0}};
  start.fate = RayFate::missed_surface;
  if (wavelength.in_nm()) return traced(lens_, derivatives_of(origin, direction), wavelength).value_or(start);
  const std::size_t position = lens_.position(wavelength);
  if (position >= lens_.wavelengths_nm().size()) return start;
  const auto end = kernel::trace(kernel::view<double>(lens_), origin, direction,
                                 {.travel = Travel::to_scene, .wavelength = position});
  start.fate = end.fate;
  return end.fate == RayFate::transmitted ? derivatives_of(end.origin, end.direction) : start;
}

template PETZVAL_API RayDerivatives ExactModel<float>::to_scene(const TwoPlaneRayDerivatives&,
                                                                Wavelength) const noexcept;
template PETZVAL_API RayDerivatives ExactModel<double>::to_scene(const TwoPlaneRayDerivatives&,
                                                                 Wavelength) const noexcept;

RayDerivatives ParaxialModel::to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept {
  SectionMaps own;
  const SectionMaps* const map = map_at(wavelength, own);
  if (!map) return {RayFate::missed_surface};
  const auto [film_x, film_y, pupil_x, pupil_y] = line_of(line);
  const auto& [mx, my] = *map;
  const Dual slope_x = mx.c * film_x + mx.d * pupil_x, slope_y = my.c * film_y + my.d * pupil_y;
  const Dual down = -1.0 / sqrt(slope_x * slope_x + slope_y * slope_y + 1.0);
  return derivatives_of({mx.a * film_x + mx.b * pupil_x, my.a * film_y + my.b * pupil_y, Dual(z_)},
                        {slope_x * down, slope_y * down, down});
}

}  // namespace petzval::camera_detail
